"""Eighty-two blows of a drop tower on felt: tower and felt fitted at once, and blows predicted before they were read.

    python scripts/validate/felt_tower.py [--data FOLDER]
    python scripts/validate/felt_tower.py --from-page

Heights, thicknesses, peaks and widths are those of Yount et al. (Dataset 14). The velocity changes by more than a
rebound can make of a free fall; three structures are fitted: a free fall, a table that elastic cords pull down, and the
same with a table that gives way too. The last predicts peak and width, as read and as filtered, at three settings of
which no blow is fitted. What it predicted of them while nobody had opened those blows stays in `WRITTEN`; they are
opened now (more_shots_series.csv), and judge it. Prints the tables, writes them into docs/fit-measured.md and the
picture beside it. Ten minutes on two cores. ``--from-page`` runs nothing: it keeps the comparisons of the table that
the page has, and holds what was written down against the blows.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections import defaultdict
from pathlib import Path

import numpy as np
from kit import DATA, IMAGES, PAGE, Comparison, cells_of, keep, table, write_into

from strikewave import FitStudy, fit, load_case
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.reporting.style import BLUE, GREEN, RED, legend_below, new_figure, quiet, save
from strikewave.studies.fit.checking import tried

Blows = dict[tuple[float, float], list[tuple[float, float]]]
"""Peak (g) and width (ms) of each blow by height and thickness (inch)."""
Band = tuple[float, float, float]
"""A predicted number, and the ends of its band."""

CASE = Path(__file__).parent / "cases" / "felt-tower.toml"
INCH = 0.0254
FELTS = {"1/16th": 0.0625, "1/8th": 0.125, "1/4th": 0.25}
"""Thickness in inch of each felt of the table."""
READ = {"as read": ("peak_g", "width_ms"), "filtered": ("peak_filtered_g", "width_filtered_ms")}
"""Columns of peak and width."""
FELT = (
    "contact.cushion.stress=10 MPa..900 GPa",
    "contact.cushion.exponent=1..6",
    "contact.cushion.retardation=0.1 us..200 us",
)
CORDS = ("machine.cord_force=10 N..20 kN", "machine.cord_stiffness=10 N/m..100 kN/m")
TABLE = ("object.frame_stiffness=0.5 GN/m..200 GN/m",)
STIFF = ("object.frame_stiffness=200 GN/m",)
LONGER = "machine.follow=2 ms"
STRUCTURES = {
    "free fall": (("machine.cord_force=1 N", "machine.cord_stiffness=1 N/m", LONGER), (*FELT, *TABLE)),
    "constant pull, table that gives way": (
        ("machine.cord_force=2 kN", "machine.cord_stiffness=1 N/m"),
        (*FELT, *CORDS[:1], *TABLE),
    ),
    "cords, stiff table": (STIFF, (*FELT, *CORDS)),
    "cords, table that gives way": ((), (*FELT, *CORDS, *TABLE)),
}
"""Settings of the case and free fields."""
BEST = "cords, table that gives way"
ASKED = ((15.5, 0.125), (19.0, 0.0625), (27.5, 0.25))
"""Height and thickness, inch, of blows that were kept apart."""
DAY = "2026-11-28"
"""On which the predictions were written down; the blows were opened after that."""
WRITTEN: dict[str, dict[tuple[float, float], tuple[Band, Band]]] = {
    "as read": {
        (15.5, 0.125): ((4741, 3909, 5574), (0.239, 0.197, 0.280)),
        (19.0, 0.0625): ((7789, 6526, 9052), (0.165, 0.137, 0.192)),
        (27.5, 0.25): ((6322, 5305, 7338), (0.294, 0.243, 0.345)),
    },
    "filtered": {
        (15.5, 0.125): ((4512, 3453, 5570), (0.270, 0.207, 0.334)),
        (19.0, 0.0625): ((7731, 5996, 9466), (0.178, 0.137, 0.219)),
        (27.5, 0.25): ((6137, 4782, 7491), (0.334, 0.256, 0.412)),
    },
}
"""Peak (g) and width (ms) of one blow and the ends of its 95 % band, as the page had them before the blows were opened.

A record of that day, never to be changed: what today's code predicts stands in its own table of the page.
"""
WHY = (
    "the operator set the height for about 5 000 g on each felt, so the blows fitted lie along one line of height and "
    "thickness (means of 5 102 to 5 708 g), and say little of the peak off it. All three settings lie off it: felt of "
    "1/8 in was not fitted at all, 19 in and 27.5 in are 31 % and 15 % above the highest blow on their felt. Thin felt "
    "was struck on two days and thick felt on a third, so felt and day are one. The band holds how the settings fitted "
    "differ from the law, not what the law lacks beyond them. To be done: predictions that say how far they go beyond "
    "what was fitted, with bands from whole felts and whole series left out"
)
"""Why what was written down misses, and what is being done."""


def read(path: Path, columns: tuple[str, str]) -> Blows:
    """Return the blows of each setting."""
    blows: Blows = defaultdict(list)
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            key = float(row["height_in"]), FELTS[row["mitigator"]]
            blows[key].append((float(row[columns[0]]), float(row[columns[1]])))
    return blows


def opened(path: Path, columns: tuple[str, str]) -> Blows:
    """Return the blows of the settings that were predicted; those on felt with tape are of others."""
    blows: Blows = {setting: [] for setting in ASKED}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            setting = float(row["height_in"]), float(row["felt_in"])
            if setting in blows and row["tape_layers"] == "0":
                blows[setting].append((float(row[columns[0]]), float(row[columns[1]])))
    return blows


def scatter(blows: Blows) -> list[float]:
    """Return the standard deviation of peak and width from blow to blow of one setting, as a share."""
    left = [(np.array(own) / np.mean(own, axis=0) - 1.0) for own in blows.values()]
    freedom = sum(len(one) - 1 for one in left)
    return [math.sqrt(sum(float(np.sum(one[:, k] ** 2)) for one in left) / freedom) for k in (0, 1)]


def at(height: float, thickness: float) -> str:
    """Return a setting as ``--to`` takes it."""
    return f"; machine.height={height} in; contact.cushion.thickness={thickness} in"


def targets(blows: Blows) -> list[str]:
    """Return peak and width of each blow, each as sure as blows repeat."""
    doubts = [100.0 * one for one in scatter(blows)]
    return [
        f"{name}={value} {unit} +- {doubt:.2f} %{at(*setting)}"
        for setting, own in blows.items()
        for blow in own
        for name, value, unit, doubt in zip(("first.rigid_peak", "first.width"), blow, ("g", "ms"), doubts, strict=True)
    ]


def fitted(name: str, blows: Blows) -> FitStudy:
    """Return a structure fitted to all blows, with predictions, in which the numbers beside them have no part."""
    changes, fields = STRUCTURES[name]
    asked = [
        f"{what}{at(*setting)}"
        for setting in ASKED
        for what in ("first.rigid_peak=5000 g +- 0.01 %", "first.width=0.2 ms +- 0.01 %")
    ]
    return fit(load_case(CASE, changes), targets(blows), fields, check_on=asked)


def means(study: FitStudy) -> list[list[str]]:
    """Return measured means and the fit, a row a setting."""
    groups: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for one, computed in zip(study.numbers, study.computed, strict=True):
        groups[one.setting][one.name].append(one.value)
        groups[one.setting][f"{one.name} fitted"] = [computed]
    rows = []
    for setting, own in sorted(groups.items(), key=lambda item: item[0].split(", ")[::-1]):
        height, thickness = (word.rpartition("=")[2] for word in setting.split(", "))
        number = {name: float(np.mean(values)) for name, values in own.items()}
        peak, width = number["first.rigid_peak"], number["first.width"]
        fall = math.sqrt(2.0 * STANDARD_GRAVITY * float(height.split()[0]) * INCH)
        cells = [height, thickness, str(len(own["first.rigid_peak"]))]
        cells += [f"{peak / STANDARD_GRAVITY:.0f}", f"{number['first.rigid_peak fitted'] / STANDARD_GRAVITY:.0f}"]
        cells += [f"{width * 1e3:.3f}", f"{number['first.width fitted'] * 1e3:.3f}"]
        rows.append([*cells, f"{2.0 * peak * width / math.pi / fall:.2f}"])
    return rows


def structures(found: dict[str, FitStudy]) -> str:
    """Return the table of structures: misfit, that of each setting by a fit to the others, values, what is open."""
    rows = []
    for name, study in found.items():
        texts = []
        for one in study.parameters:
            path = one.field.path.rpartition(".")[2].replace("_", " ")
            share = 100.0 * one.standard_error / one.value
            texts.append(f"{path} {one.field.shown(one.value, 3)} ({f'± {share:.0f} %' if one.determined else 'open'})")
        row = tried(name, study.solved)
        lacking = study.solved.problem.excess.between
        rows.append([name, f"{row.misfit:.2f}", f"{lacking:.2f}", f"{row.kept_out:.2f}", ", ".join(texts)])
    heads = ["structure", "left", "of that from setting to setting", "settings kept out", "values"]
    return table(heads, rows)


def predictions(studies: dict[str, FitStudy]) -> str:
    """Return the table of predictions of one blow each, with 95 % bands."""
    rows = []
    for k, (height, thickness) in enumerate(ASKED):
        cells = [f"{height} in on {thickness} in"]
        for study in studies.values():
            assert study.checks is not None
            peak, width = study.checks.figures[2 * k : 2 * k + 2]
            low, middle, high = (size / STANDARD_GRAVITY for size in (peak.low, peak.predicted, peak.high))
            cells.append(f"{middle:.0f} ({low:.0f} to {high:.0f})")
            cells.append(f"{width.predicted * 1e3:.3f} ({width.low * 1e3:.3f} to {width.high * 1e3:.3f})")
        rows.append(cells)
    heads = [f"{what}, {name}" for name in studies for what in ("peak (g)", "pulse width (ms)")]
    return table(["setting", *heads], rows)


def beside_blows(data: Path) -> str:
    """Return the table of what was written down beside the blows that were opened after that."""
    rows = []
    for reading in READ:
        for row in judged(data, reading):
            if row.computed is None or row.reference is None or row.miss is None or not (row.band and row.within):
                raise ValueError(f"{row.what}, {row.quantity}: nothing to compare")
            digits = 0 if row.unit == "g" else 3
            numbers = [f"{value:.{digits}f}" for value in (row.computed, *row.band, row.reference)]
            cells = [row.what.partition(" of felt")[0], f"{row.quantity} ({row.unit}), {reading}", numbers[0]]
            cells += [f"{numbers[1]} to {numbers[2]}", numbers[3], f"{100.0 * row.miss:+.1f} %"]
            rows.append([*cells, f"{row.within[0]} of {row.within[1]}"])
    heads = ["setting", "quantity", "written down", "95 % band of a blow", "mean measured", "miss", "blows in the band"]
    return table(heads, rows, 2)


def draw(blows: Blows, after: Blows, study: FitStudy, path: Path) -> None:
    """Draw the blows, the fit, the predictions, and the blows opened after them over the drop height."""
    figure = new_figure((9.0, 4.0))
    colours = dict(zip(FELTS.values(), (BLUE, GREEN, RED), strict=True))
    rows = means(study)
    for k, (axes, title) in enumerate(zip(figure.subplots(1, 2), ("peak (g)", "width (ms)"), strict=True)):
        for thickness, colour in colours.items():
            own = [(height, blow[k]) for (height, felt), all_ in blows.items() if felt == thickness for blow in all_]
            if own:
                axes.plot(
                    *zip(*own, strict=True),
                    ".",
                    color=colour,
                    alpha=0.5,
                    label=f"felt of {thickness} in" if k else None,
                )
            line = [(float(row[0].split()[0]), float(row[4 + 2 * k])) for row in rows if row[1] == f"{thickness} in"]
            if line:
                axes.plot(
                    *zip(*sorted(line), strict=True), color=colour, label="fitted" if k and thickness == 0.25 else None
                )
        assert study.checks is not None
        for number, (height, thickness) in enumerate(ASKED):
            one = study.checks.figures[2 * number + k]
            size = STANDARD_GRAVITY if k == 0 else 1e-3
            ends = [[(one.predicted - one.low) / size], [(one.high - one.predicted) / size]]
            words = f"predicted, felt of {thickness} in" if k else None
            axes.errorbar(height, one.predicted / size, ends, fmt="s", capsize=4, color=colours[thickness], label=words)
            measured = [blow[k] for blow in after[height, thickness]]
            words = "measured, opened after that" if k and thickness == 0.25 else None
            axes.plot([height] * len(measured), measured, "x", color=colours[thickness], label=words)
        axes.set_ylim(bottom=0.0)
        axes.set_xlim(12.0, 28.0)
        quiet(axes, title.partition(" ")[0].capitalize(), "drop height (in)", title)
    legend_below(figure)
    save(figure, path)


def judged(data: Path, reading: str = "as read") -> list[Comparison]:
    """Return what was written down beside the mean of the blows of each setting, and how many lie in its band."""
    blows = opened(data / "more_shots_series.csv", READ[reading])
    rows = []
    for k, (quantity, unit) in enumerate((("peak", "g"), ("pulse width", "ms"))):
        for (height, thickness), bands in WRITTEN[reading].items():
            predicted, low, high = bands[k]
            measured = [blow[k] for blow in blows[height, thickness]]
            within = sum(low <= value <= high for value in measured), len(measured)
            what = f"{height} in on {thickness} in of felt, mean of {len(measured)} blows"
            mean = float(np.mean(measured))
            rows.append(
                Comparison(
                    *(what, quantity, "measured", "predicted", mean, predicted, unit),
                    band=(low, high),
                    note=WHY,
                    written=DAY,
                    within=within,
                )
            )
    return rows


def comparisons(cells: list[list[str]]) -> list[Comparison]:
    """Return what the rows of the table compare: means of all blows of a setting, fitted at once."""
    rows = []
    for height, thickness, count, peak, own_peak, width, own_width, _ in cells:
        what = f"{height} on {thickness} of felt, mean of {count} blows"
        rows.append(Comparison(what, "peak", "measured", "fitted", float(peak), float(own_peak), "g"))
        rows.append(Comparison(what, "pulse width", "measured", "fitted", float(width), float(own_width), "ms"))
    return rows


def main() -> None:
    """Fit, predict, print and write; or keep what the page has."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=DATA / "drop-tower-felt", help="folder of shots.csv")
    parser.add_argument("--from-page", action="store_true", help="keep the comparisons of the page, run nothing")
    asked = parser.parse_args()
    if not asked.from_page:
        run(asked.data)
    write_into(PAGE, "opened blows", beside_blows(asked.data))
    keep("felt", [*judged(asked.data), *comparisons(cells_of(PAGE, "felt"))], asked.from_page)


def run(data: Path) -> None:
    """Fit, predict, print and write."""
    blows = {name: read(data / "shots.csv", columns) for name, columns in READ.items()}
    for name, own in blows.items():
        peak, width = scatter(own)
        print(
            f"{name}: blows of one setting scatter by {100 * peak:.1f} % (peak), {100 * width:.1f} % (width)",
            flush=True,
        )
    best = {name: fitted(BEST, own) for name, own in blows.items()}
    first = best["as read"]
    heads = ["height", "felt", "blows", "peak (g)", "fitted", "pulse width (ms)", "fitted", "2AT/π over √(2gh)"]
    texts = {"felt": table(heads, means(first)), "unseen blows": predictions(best)}
    for name, text in texts.items():
        print(f"\n{text}", flush=True)
        write_into(PAGE, name, text)
    after = opened(data / "more_shots_series.csv", READ["as read"])
    draw(blows["as read"], after, first, IMAGES / "fit-felt.svg")
    others = {name: fitted(name, blows["as read"]) for name in STRUCTURES if name != BEST}
    texts = {"tower": structures({**others, BEST: first}), "other towers": predictions(others)}
    for name, text in texts.items():
        print(f"\n{text}", flush=True)
        write_into(PAGE, name, text)


if __name__ == "__main__":
    main()
