"""Striker bars on incident bars: what the first pulse of a split-Hopkinson record tells of striker, contact and bar.

    python scripts/validate/striker_on_bar.py [--data FOLDER]
    python scripts/validate/striker_on_bar.py --from-page

Three shots: copper of LANL HopPyBar, and two of 945 steel. The strain of the incident gauge, as a force, is fitted by a
striker bar whose contact is Hertz's (a rounded face) or linear (a rough one). Prints the table, writes it into
docs/fit-measured.md and the picture beside it. Five minutes on two cores. ``--from-page`` runs nothing: it keeps the
comparisons of the table that the page has.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

import numpy as np
from kit import DATA, IMAGES, PAGE, Comparison, cells_of, keep, table, unpacked, write_into

from strikewave import FitStudy, fit, read_record
from strikewave.cases.case import parse_case
from strikewave.hopkinson import Bridge
from strikewave.records.calibration import even
from strikewave.reporting.style import BLUE, GREEN, RED, legend_below, new_figure, quiet, save

CASE = Path(__file__).parent / "cases" / "striker-on-bar.toml"
SHOTS = {
    "copper": ("lanl-kolsky/lanl_Cu_20061201_1148HE.raw", Bridge("half", 2.061, 8.0, 200.0).strain, 1.0),
    "945 steel, shot 03": ("steel945-shpb/yao_945steel_03.xlsx", lambda values: 1e-6 * values, -1.0),
    "945 steel, shot 02": ("steel945-shpb/yao_945steel_sample02.xlsx", lambda values: 1e-6 * values, -1.0),
}
"""File, strain of its first channel, and the sign of compression."""
TITANIUM = {"material": "Ti-6Al-4V", "density": 4416.0, "modulus": 4416.0 * 4865.9**2, "diameter": 9.47e-3}
STEEL = {"material": "45 steel", "density": 7800.0, "modulus": 210e9, "diameter": 20e-3}
LENGTHS = {"copper": 0.127}
"""Length of the striker, m, where it is published."""
GUESS = 0.208
"""Another one, m: half of what a wave goes in a pulse of 80 us."""
CONTACTS = {
    "Hertz": ('kind = "contact"\nlaw = "hertz"\nradius = "1 m"', "stack.joint.striker.radius=10 mm..1000 m"),
    "linear": ('kind = "unilateral"\nstiffness = "1 GN/m"', "stack.joint.striker.stiffness=10 MN/m..1000 GN/m"),
}
"""Joint between striker and bar, and its free field."""


def case_text(shot: str, contact: str) -> str:
    """Return the case of a shot: its bars, the striker where it is known, and the contact."""
    bar = TITANIUM if shot == "copper" else STEEL
    text = CASE.read_text("utf-8").split("[[stack.layer]]")[0]
    sizes = (
        f'material = "{bar["material"]}"\ndensity = "{bar["density"]} kg/m^3"\nmodulus = "{bar["modulus"]} Pa"\n'
        f'diameter = "{bar["diameter"]} m"\n'
    )
    length = LENGTHS.get(shot, GUESS)
    text += f'[[stack.layer]]\nname = "striker"\nlength = "{length} m"\nspeed = "15 m/s"\n{sizes}\n'
    text += f'[[stack.layer]]\nname = "bar"\nlength = "1 m"\n{sizes}\n'
    text += f'[[stack.joint]]\nafter = "striker"\n{CONTACTS[contact][0]}\n\n[stack.end]\nkind = "free"\n\n'
    return text + '[[tap]]\nname = "gauge"\nlayer = "bar"\n\n[solver]\nduration = "250 us"\nstep = "200 ns"\n'


def write_force(shot: str, folder: Path, data: Path) -> Path:
    """Write the force in the incident bar of a shot, E A times its strain, compression above zero."""
    name, strain, sign = SHOTS[shot]
    bar = TITANIUM if shot == "copper" else STEEL
    found = even(read_record(unpacked_file(data / name, folder)).channel(1))[0]
    force = sign * bar["modulus"] * 0.25 * math.pi * bar["diameter"] ** 2 * strain(found.values)
    path = folder / f"{shot.replace(' ', '-').replace(',', '')}.csv"
    times = np.arange(force.size) * found.step
    np.savetxt(path, np.column_stack([times, force]), delimiter=",", header="time (s),force (N)", comments="")
    return path


def unpacked_file(path: Path, folder: Path) -> Path:
    """Return a file, or the copy of its packed form."""
    own = folder / path.parent.name
    if not own.exists():
        own.mkdir()
        unpacked(path.parent, own)
    return own / path.name


def fitted(shot: str, contact: str, record: Path) -> FitStudy:
    """Return a shot fitted with a contact."""
    case = parse_case(case_text(shot, contact), "striker-on-bar")
    return fit(case, [f"gauge.force={record}@1"], ["stack.layer.striker.speed=1 m/s..100 m/s", CONTACTS[contact][1]])


def rows_of(found: dict[tuple[str, str], FitStudy]) -> str:
    """Return the table of fits."""
    rows = []
    for (shot, contact), study in found.items():
        bar = TITANIUM if shot == "copper" else STEEL
        speed, joint = study.parameters
        wave = math.sqrt(bar["modulus"] / bar["density"])
        unit, size = ("m", 1.0) if contact == "Hertz" else ("GN/m", 1e9)
        share = study.solved.misfits[0].share
        cells = [f"{speed.value:.2f} ± {speed.standard_error:.2f}"]
        cells.append(f"{2e6 * LENGTHS.get(shot, GUESS) / wave:.2f}")
        cells += [f"{joint.value / size:.2g} ± {joint.standard_error / size:.1g} {unit}", f"{100 * share:.1f} %"]
        rows.append([shot, contact, *cells])
    heads = ["shot", "contact", "speed × gauge factor over the stated one (m/s)"]
    return table([*heads, "2L/c (µs)", "radius, or stiffness", "left, of the peak"], rows)


def draw(found: dict[tuple[str, str], FitStudy], path: Path) -> None:
    """Draw each pulse with both contacts."""
    figure = new_figure((9.0, 3.8))
    for axes, shot in zip(figure.subplots(1, len(SHOTS)), SHOTS, strict=True):
        first = shot == next(iter(SHOTS))
        for contact, colour in zip(CONTACTS, (RED, GREEN), strict=True):
            _, laid = found[shot, contact].pulses[0]
            time = (laid.time - laid.time[0]) * 1e6
            if contact == "Hertz":
                axes.plot(time, laid.measured / 1e3, color=BLUE, linewidth=1.0, label="gauge" if first else None)
            words = f"fitted, {contact}" if first else None
            axes.plot(time, laid.computed / 1e3, "--", color=colour, linewidth=1.2, label=words)
        quiet(axes, shot[0].upper() + shot[1:], "time (µs)", "force (kN)" if first else "")
    legend_below(figure)
    save(figure, path)


def comparisons(cells: list[list[str]]) -> list[Comparison]:
    """Return what the rows of the table compare: the whole pulse at the gauge, of which the speed was fitted."""
    quantity = "force at the gauge, what is left over the peak"
    return [
        Comparison(
            f"{shot}, {contact} contact", quantity, "measured", "fitted", None, None, miss=0.01 * float(left.split()[0])
        )
        for shot, contact, _, _, _, left in cells
    ]


def main() -> None:
    """Fit, print and write; or keep what the page has."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=DATA, help="folder with those of both sources")
    parser.add_argument("--from-page", action="store_true", help="keep the comparisons of the page, run nothing")
    asked = parser.parse_args()
    if not asked.from_page:
        run(asked.data)
    keep("strikers", comparisons(cells_of(PAGE, "bars")), asked.from_page)


def run(data: Path) -> None:
    """Fit, print and write."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = {}
        for shot in SHOTS:
            record = write_force(shot, folder, data)
            for contact in CONTACTS:
                found[shot, contact] = fitted(shot, contact, record)
                print(rows_of({(shot, contact): found[shot, contact]}).splitlines()[-1], flush=True)
    text = rows_of(found)
    print(f"\n{text}")
    write_into(PAGE, "bars", text)
    draw(found, IMAGES / "fit-bars.svg")


if __name__ == "__main__":
    main()
