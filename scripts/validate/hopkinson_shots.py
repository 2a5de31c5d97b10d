"""Split-Hopkinson shots that others measured, against what strikers, impulses and echoes say of them; half a minute.

    python scripts/validate/hopkinson_shots.py

Nothing is fitted. The pulse of a striker lasts 2 L/c; what enters a specimen at one face leaves it at the other; the
speed of waves in a bar follows from its echoes, and was also measured by others. Writes the table of echoes into
docs/fit-measured.md.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from kit import DATA, PAGE, Comparison, keep, table, unpacked, write_into

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import real_shots
from real_shots import Shot

from strikewave.hopkinson import momentum
from strikewave.hopkinson.echoes import calibrate_bar

FORCES = (
    "the waves of both faces are off by microseconds (docs/hopkinson.md): gauge distances or strain factors of the "
    "set-up, whose uncertainty its notes do not give; a record of the bars alone would tell them apart"
)
"""Why the impulses on the faces differ."""


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
    write_into(PAGE, "echoes", text)
    keep("hopkinson", [*rows, *echoes])


if __name__ == "__main__":
    main()
