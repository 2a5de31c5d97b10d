"""The page of machines: its view of a run as plain values, made in processes of the app."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import strikewave
from strikewave.analyses.machine.band import PULSE_TOLERANCE, quick_look
from strikewave.analyses.machine.kind import kind_of
from strikewave.analyses.machine.result import (
    INTERVAL,
    SHOWN_WIDTHS,
    Solution,
    blow_columns,
    blow_history,
    blow_results,
)
from strikewave.analyses.machine.run import run_case
from strikewave.base.compiled import is_cold
from strikewave.base.declare import declarations
from strikewave.base.result import Band
from strikewave.base.shock_quantities import ACCELERATION, FORCE, PULSE_WIDTH, RIGID_PEAK
from strikewave.base.texts import percent
from strikewave.base.units import in_unit
from strikewave.machines.blows import Blow
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import axis_unit, time_unit, with_unit
from strikewave.reporting.parts import NONE
from strikewave.studies.engine.plan import read_variable
from strikewave.studies.search.plan import load_design
from strikewave.studies.search.rotary import is_rotary
from strikewave.studies.study_file import vary_texts
from strikewave.web.case_state import CaseSource
from strikewave.web.case_values import edited_fields, full_run_label, loaded, notices_and_balance, result_file
from strikewave.web.charts import ChartLine, line_chart, points, svg_of, train_chart
from strikewave.web.jobs import Say

OF_FIRST = ("rigid_peak", "width", "velocity_change")
"""Shown numbers of the first blow."""
OF_BLOW = declarations(Blow)
FIGURES = (
    *((f"first.{name}", OF_BLOW[name].headline, OF_BLOW[name].quantity) for name in OF_FIRST),
    ("typical.rigid_peak", "rigid peak, later blows", OF_BLOW["rigid_peak"].quantity),
    ("interval", declarations(Solution)["interval"].headline, INTERVAL),
)
"""Key numbers: name, label, quantity."""
PUBLISHED = ("quantity", "origin", "role", "published", "computed", "difference")
NOTHING = "No striker touches the object: more engagement, or another arrival of the feed."
MOST_IMPORTANT = 6
"""Fields with a slider: as many as a screen shows beside the pictures."""


def warm_kernels(say: Say) -> None:
    """Run once everything that needs the kernels of machines, where the cache lacks them."""
    if is_cold("run_train"):
        source = CaseSource("li-ma-2019", "", (), "")
        look(source)
        full(source)


def look(source: CaseSource) -> dict[str, Any]:
    """Return a first look at a machine; see `strikewave.analyses.machine.band`."""
    quick = quick_look(loaded(source))
    left_out = "; bodies only, without the waves of the stack" if quick.bodies_only else ""
    engine = "the fast engine" if quick.fast else f"its bodies, local error {PULSE_TOLERANCE:.0e}"
    return {
        "by": f"a first look by {engine}{left_out}; no bands yet",
        "figures": shown_figures(blow_results(quick.blows), {}),
        "charts": [*pulse_charts(quick.since, quick.force, quick.acceleration), *train(quick.blows, {})],
        "tables": [blow_rows(quick.blows, {})],
        "nothing": NOTHING,
    }


def full(source: CaseSource, say: Say | None = None) -> dict[str, Any]:
    """Return a full run of a machine with the bands of its results."""
    stage, last = "the run", 0.0

    def progress(share: float) -> None:
        nonlocal stage, last
        if share < last:  # the second stage begins at 0 again
            stage = "the bands of its results"
        last = share
        if say is not None:
            say(share, stage)

    solution = run_case(loaded(source), progress, band=True)
    place = next((k for k, blow in enumerate(solution.blows) if blow.kind != "missed"), None)
    published = compared(solution)
    return {
        "by": full_run_label(solution),
        "figures": shown_figures(solution.figures, solution.band),
        "charts": [*pulse_charts(*_first_pulse(solution, place)), *train(solution.blows, solution.band)],
        "tables": [
            blow_rows(solution.blows, solution.band),
            *([("Compared with published values", PUBLISHED, published, (0, 1, 2))] if published else []),
        ],
        "nothing": NOTHING,
        **notices_and_balance(solution),
        "important": important(solution.band),
        "texts": {"blows.csv": solution.tables()["blows.csv"]},
    }


def files(source: CaseSource, wanted: str, say: Say | None = None) -> bytes:
    """Return a file of a full run: ``report.html``, ``report.pdf`` or ``solution.nc``."""
    case = loaded(source)
    solution = run_case(case, None if say is None else lambda share: say(share, "the run"), band=True)
    return result_file(solution, wanted)


def drawings(source: CaseSource) -> list[tuple[bytes, str]]:
    """Return the drawings of a machine as SVG with their captions; none for a kind without."""
    case = loaded(source)
    drawing = kind_of(case).drawing(case)
    return [(svg_of(part.figure), part.caption) for part in (() if drawing is None else drawing.pictures)]


def _first_pulse(solution: Solution, place: int | None) -> tuple[Any, Any, Any]:
    if place is None:
        return (np.zeros(0),) * 3
    width = solution.blows[place].width
    time, force = blow_history(solution.arrays, place, "pulse_force")
    acceleration = blow_history(solution.arrays, place, "pulse_acceleration")[1]
    shown = time <= (SHOWN_WIDTHS * width if width > 0.0 else time[-1])
    return time[shown], force[shown], acceleration[shown]


def pulse_charts(since: Any, force: Any, acceleration: Any) -> list[dict[str, Any]]:
    """Return diagrams of contact force and rigid-body acceleration of the first blow, in the units shown."""
    second, time_name = time_unit(float(np.ptp(since)) if since.size else 0.0)
    x = f"time after first touch ({time_name})"
    charts = []
    for title, values, quantity in (
        ("Contact force", force, FORCE),
        ("Rigid-body acceleration", acceleration, ACCELERATION),
    ):
        size, name = axis_unit(*quantity.units)
        lines = [ChartLine("now", points(since / second, values / size))]
        charts.append(line_chart(f"{title}, first blow", x, f"{title.lower()} ({name})", lines))
    return charts


def train(blows: Sequence[Any], bands: Mapping[str, Band]) -> list[dict[str, Any]]:
    """Return a diagram of the peaks of all blows, with the band of the later ones; none where one blow is all."""
    if len(blows) < 2:
        return []
    size, name = axis_unit(*ACCELERATION.units)
    band = bands.get("typical.rigid_peak")
    bars = [[b.index, round(b.rigid_peak / size, 2) if b.kind != "missed" else 0.0, b.kind] for b in blows]
    ends = None if band is None else [band.low / size, band.high / size]
    return [train_chart("Train of blows", name, bars, ends)]


def blow_rows(
    blows: Sequence[Any], bands: Mapping[str, Band]
) -> tuple[str, list[str], list[list[str]], tuple[int, ...]]:
    """Return the table of blows; that of a first look has fewer columns."""
    columns = blow_columns("blows", blows, bands)
    if blows and not isinstance(blows[0], Blow):
        there = {field.name for field in dataclasses.fields(blows[0])}
        fields = {column.name: column.name.replace(" ", "_") for column in columns} | {"pulse width at 10 %": "width"}
        columns = [column for column in columns if column.si == "" or fields[column.name] in there]
    rows = [list(row) for row in zip(*(column.texts() for column in columns), strict=True)]
    return "Blows", [column.head for column in columns], rows, ()


def shown_figures(figures: Mapping[str, float], bands: Mapping[str, Band]) -> list[tuple[str, str]]:
    """Return the key numbers as texts, each with its band where one is known."""
    return [
        (label, amount(quantity, figures[name], bands.get(name)))
        for name, label, quantity in FIGURES
        if name in figures
    ]


def important(bands: Mapping[str, Band]) -> list[str]:
    """Return the fields with the largest shares of the bands of the results, the largest first."""
    shares: dict[str, float] = {}
    for band in bands.values():
        for entry in band.inputs:
            shares[entry.field] = shares.get(entry.field, 0.0) + entry.share
    return sorted(shares, key=lambda path: -shares[path])[:MOST_IMPORTANT]


def compared(solution: Solution) -> list[list[str]]:
    """Return the comparison with published values as rows of texts."""
    rows = []
    for row in solution.comparisons:
        values = [with_unit(value, *row.measured.units) for value in (row.published, row.computed)]
        difference = NONE if row.difference is None else percent(row.difference, 1, "+")
        rows.append([row.quantity, row.measured_or_simulated, row.role, *values, difference])
    return rows


NOW = (
    ("interval", "interval", INTERVAL),
    ("peak", "first.rigid_peak", RIGID_PEAK),
    ("width", "first.width", PULSE_WIDTH),
)
"""Results of the blows that can be asked for: key of the form, name of the result, quantity."""
STUDY = Path(strikewave.__file__).parent / "examples" / "studies" / "equal-blows.toml"
"""Study that defines equal blows and the tried supports of the object, as shares of that of its case."""
ANY_MACHINE = re.compile(r"(%|= 0|smallest)$")
"""Ends of goals without a quantity: a force or a length is a limit of the machine of that study alone."""
RUNS = 300
"""Runs of a page: fewer than of the study, since the user waits."""


def wishes(source: CaseSource) -> dict[str, dict[str, list[str]]]:
    """Return the first texts of the forms, by study and key: the blows as they are, and the support to be varied.

    Examples
    --------
    >>> wishes(CaseSource("li-ma-2019", "", (), ""))["design"]["vary"][0]
    'object.damper=20..120 N s/m'
    """
    case = loaded(source)
    if not is_rotary(case):
        return {}
    figures = blow_results(quick_look(case).blows)
    now = {key: [f"{in_unit(figures[name], *of.units):.4g} {of.usual}"] for key, name, of in NOW if name in figures}
    study, fields, ranges = load_design(STUDY), edited_fields(case), []
    for text in vary_texts(study.file.vary):  # in proportion to the support of this case
        axis = read_variable(study.case, text).axis
        field, of_study = fields.get(axis.path), study.case.values()[axis.path].si
        if field is not None and field.value > 0.0:
            low, high = (f"{end / of_study * field.value:.4g}" for end in (axis.values[0], axis.values[-1]))
            ranges.append(f"{axis.path}={low}..{high} {field.unit}".strip())
    goals = [goal for goal in study.file.goals if ANY_MACHINE.search(goal)]
    design = {"vary": ranges, "goals": goals, "analysis": [study.file.analysis], "runs": [str(RUNS)]}
    return {"settings": now, "design": design}
