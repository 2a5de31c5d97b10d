"""Split-Hopkinson shots that others measured, against what strikers, impulses and echoes say of them; half a minute.

    python scripts/validate/hopkinson_shots.py

Nothing is fitted. The pulse of a striker lasts 2 L/c; what enters a specimen at one face leaves it at the other; the
speed of waves in a bar follows from its echoes, and was also measured by others. Writes the table of echoes into
docs/fit-measured.md, that of the shots into docs/hopkinson.md.
"""

from __future__ import annotations

import math
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from kit import DATA, PAGE, ROOT, Comparison, keep, table, unpacked, write_into

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import real_shots
from real_shots import Shot

from strikewave.analyses.hopkinson.notices import drift_notices
from strikewave.cases.tables.hopkinson import LimitsTable
from strikewave.hopkinson import ANALYSES, equilibrium, momentum, rise_slope
from strikewave.hopkinson.echoes import calibrate_bar

FORCES = (
    "the waves of both faces are off by microseconds (docs/hopkinson.md): gauge distances or strain factors of the "
    "set-up, whose uncertainty its notes do not give; a record of the bars alone would tell them apart"
)
"""Why the impulses on the faces differ."""
SHOTS_PAGE = ROOT / "docs" / "hopkinson.md"
LIMITS = LimitsTable()
"""Those of a set-up that states none."""


def of_striker(name: str, shot: Shot, length: float) -> Comparison:
    """Return the duration of the pulse against 2 L/c, known to the rise of the pulse on either side."""
    pulses, _ = shot.reduced()
    lasts = 2.0 * length / shot.bars[0].speed
    band = (lasts - pulses.rise, lasts + pulses.rise)
    return Comparison(name, "pulse width at half height", "measured", "predicted", pulses.width, lasts, "s", band=band)


def of_impulse(name: str, shot: Shot, note: str = "") -> Comparison:
    """Return the impulse that leaves the specimen and moves it against the one that enters it."""
    found = momentum(shot.reduced()[1])
    return Comparison(
        name,
        "impulse on the first face, by the second gauge",
        "measured",
        "predicted",
        found.first,
        found.second + found.specimen,
        "N s",
        note=note,
    )


def of_speeds(folder: Path) -> list[Comparison]:
    """Return the delay by another published speed of the titanium bars, as the balance of forces finds it."""
    speeds = real_shots.ROD_SPEED, real_shots.REFLECTED_SPEED
    late = [real_shots.copper(folder, speed).reduced()[1].waves.late_balance for speed in speeds]
    expected = 2.0 * 0.381 * (1.0 / speeds[1] - 1.0 / speeds[0])
    return [
        Comparison(
            "copper, titanium bars",
            f"shift of the {wave} wave by another speed of the bar",
            "measured",
            "predicted",
            late[0][k] - late[1][k],
            expected,
            "s",
        )
        for k, wave in enumerate(("reflected", "transmitted"))
    ]


def of_echoes(folder: Path) -> tuple[list[Comparison], str]:
    """Return wave speeds and lengths of the miniature bars by their echoes, and their table."""
    rows, cells = [], []
    for channel, distance, way, skip, name in real_shots.MINI_ECHOES:
        bar, strain = real_shots.mini_bar(folder, channel, distance)
        found = calibrate_bar(strain, bar, way, skip)
        speed, length = found.speed, found.length
        half = speed.student * speed.error
        rows.append(
            Comparison(
                f"miniature bar, {name}",
                "wave speed by echoes",
                "measured",
                "predicted",
                real_shots.MINI_SPEED,
                speed.value,
                "m/s",
                band=(speed.value - half, speed.value + half),
            )
        )
        own = [f"{speed.value:.0f} ± {speed.error:.0f}", f"{real_shots.MINI_SPEED:.0f}", f"{length.value * 1e3:.1f}"]
        cells.append([name, *own, f"{found.attenuation.value:.2f} ± {found.attenuation.error:.2f}"])
    heads = ["miniature bar", "wave speed (m/s)", "stated (m/s)", "length (mm)", "attenuation (1/m)"]
    return rows, table(heads, cells)


def of_shot(shot: Shot, striker: float = math.nan) -> dict[str, str]:
    """Return what the page tells of a shot, by what it is called there; ``striker`` its length, m, NaN if not known."""
    uneven, unclosed = LIMITS.force_misfit.si, LIMITS.momentum.si
    pulses, reduction = shot.reduced()
    waves, on, true = reduction.waves, reduction.loading, reduction.curve("3-wave").true()
    alike, missing = equilibrium(reduction), momentum(reduction).closure
    balanced = equilibrium(replace(shot, alignment="balance").reduced()[1])
    baselines = [f"{1e6 * notice.value:.2g}" for notice in drift_notices(pulses.traces, ("1", "2"))]
    expected = "-" if math.isnan(striker) else f"{2e6 * striker / shot.bars[0].speed:.1f}"
    slopes = [f"{1e-9 * rise_slope(reduction.curve(analysis), on):.3g}" for analysis in ANALYSES]
    late = [
        " / ".join(f"{1e6 * value:+.2f}".replace("-", "−") for value in (waves.late_onset[k], waves.late_balance[k]))
        for k in (0, 1)
    ]
    agree = "nowhere long" if math.isnan(alike.begin) else f"{1e6 * alike.begin:.0f} to {1e6 * alike.end:.0f} µs"
    largest = f"{1e-6 * true.stress[on].max():.0f}, {100.0 * true.strain[on].max():.1f} %"
    return {
        f"force difference over mean (limit {100.0 * uneven:.0f} %)": judged(alike.misfit, uneven),
        "the same, aligned by `balance`": judged(balanced.misfit, uneven),
        "forces agree to 5 % (share of the loading)": f"{agree} ({100.0 * alike.share:.0f} %)",
        "impulse on face 1 over face 2": f"{alike.force_ratio:.3f}",
        f"missing impulse, − excess (limit {100.0 * unclosed:.0f} %)": judged(missing, unclosed, "+"),
        "reflected late, by onset / balance (µs)": late[0],
        "transmitted late, by onset / balance (µs)": late[1],
        "baseline moves before the pulse, gauge 1, 2 (µε)": ", ".join(baselines) or "-",
        "rise of the incident pulse (µs)": f"{1e6 * pulses.rise:.1f}",
        "pulse width, 2 L/c of the striker (µs)": f"{1e6 * pulses.width:.1f}, {expected}",
        "largest true stress (MPa), strain, median rate (1/s)": f"{largest}, {np.median(true.rate[on]):.0f}",
        "slope of the rise 1-, 2-, 3-wave (GPa)": ", ".join(slopes),
        "handbook modulus (GPa)": f"{1e-9 * shot.specimen.modulus:.3g}",
    }


def judged(value: float, limit: float, sign: str = "") -> str:
    """Return a share in per cent, in bold where it is beyond its limit."""
    text = f"{100.0 * value:{sign}.3g} %".replace("-", "−")
    return f"**{text}**" if abs(value) > limit else text


def table_of_shots(lanl: Path, yao: Path) -> str:
    """Return the table of the page on Hopkinson bars."""
    striker = real_shots.COPPER_STRIKER
    shots = {
        f"Cu, c = {speed:.1f} m/s": of_shot(real_shots.copper(lanl, speed), striker)
        for speed in (real_shots.REFLECTED_SPEED, real_shots.ROD_SPEED)
    }
    shots |= {f"945 steel, shot {name[-2:]}": of_shot(real_shots.steel(yao, name)) for name in real_shots.STEEL}
    shots["PMMA, mini bars"] = of_shot(real_shots.pmma(lanl), real_shots.PMMA_STRIKER)
    rows = next(iter(shots.values()))
    return table(["", *shots], [[name, *(shot[name] for shot in shots.values())] for name in rows])


def main() -> None:
    """Reduce the shots, keep what is compared, write the table of echoes."""
    with tempfile.TemporaryDirectory() as place:
        lanl, yao = (Path(place) / name for name in ("lanl-kolsky", "steel945-shpb"))
        for folder in (lanl, yao):
            folder.mkdir()
            unpacked(DATA / folder.name, folder)
        copper, pmma = real_shots.copper(lanl), real_shots.pmma(lanl)
        rows = [
            of_striker("copper, titanium bars", copper, real_shots.COPPER_STRIKER),
            of_impulse("copper, titanium bars", copper),
            *of_speeds(lanl),
            of_striker("PMMA, miniature bars", pmma, real_shots.PMMA_STRIKER),
            of_impulse("PMMA, miniature bars", pmma, FORCES),
            *(of_impulse(f"945 steel, {name}", real_shots.steel(yao, name), FORCES) for name in real_shots.STEEL),
        ]
        echoes, text = of_echoes(lanl)
        shots = table_of_shots(lanl, yao)
    write_into(PAGE, "echoes", text)
    write_into(SHOTS_PAGE, "shots", shots)
    keep("hopkinson", [*rows, *echoes])


if __name__ == "__main__":
    main()
