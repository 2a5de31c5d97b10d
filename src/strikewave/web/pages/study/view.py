"""The page of studies: its view of a study as plain values, made in processes of the app."""

from __future__ import annotations

import os
import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import strikewave
from strikewave.base.declare import declarations
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import RUN_BROKEN, RUN_FAILED, RUN_PASSED, Verdicts, status_of
from strikewave.cases.case import Case
from strikewave.cases.files import bundled_cases
from strikewave.reporting.shown_result import ShownResult, shown_table
from strikewave.specifications.reading import asked_names
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.plan import StudyVariable
from strikewave.studies.fit.result import FitStudy
from strikewave.studies.map import X, Y
from strikewave.studies.map.cells import MapCell
from strikewave.studies.map.study import MapStudy
from strikewave.studies.scatter.study import RUNS
from strikewave.studies.search.design import DesignStudy
from strikewave.studies.search.design_report import drawn_numbers
from strikewave.studies.search.rotary import SettingsStudy
from strikewave.studies.sweep.study import SweepStudy
from strikewave.web.case_state import CaseSource, CaseState, address
from strikewave.web.case_values import PAGES_OF, full_run_label, loaded, result_file
from strikewave.web.charts import Dots, dot_chart, heat_chart, svg_of
from strikewave.web.jobs import Say
from strikewave.web.pages.study.request import KINDS, StudyRequest

MOST_RUNS = 2000
MOST_CELLS = 3600
"""Runs and cells of one study on a page: an hour's work. The command line takes more."""
MAP_POINTS = "20x20"
OTHER_FILE = re.compile(
    r"^@|(?:^|[\s:=@,;\"'])(?:[~/\\]|[A-Za-z]:[\\/])|(?:^|[:=@,;\"'])\s*\.\.|\.\.[\\/]|[\\/]\.\.|\.file\b"
)
"""Pattern of text that begins like the path of another folder, leads upwards, or is read for more lines; the two dots
of a range follow its first number."""


def study(request: StudyRequest, say: Say) -> dict[str, Any]:
    """Return a study of a case; a stopped one continues where it was, where its kind can."""
    refuse_other_files(request)
    case = loaded(request.source)
    os.chdir(request.source.folder)
    runs = None
    if text := request.line("runs"):
        runs = _whole(text)
        if not 1 <= runs <= MOST_RUNS:
            raise InputError("runs", text, f"a whole number from 1 to {MOST_RUNS}", "the command line takes more")
    store = Path(request.source.folder) / f"{request.kind}-{request.mark}"

    def progress(share: float) -> None:
        say(share, request.kind)

    result: ShownResult
    if request.kind == "fit":
        result = strikewave.fit(
            case,
            request.lines("to"),
            request.lines("free"),
            progress=lambda n, misfit: say(None, f"{n} runs, misfit {misfit:.3g}"),
        )
    elif request.kind == "sweep":
        result = strikewave.sweep(
            case, request.lines("vary"), keep=request.lines("keep"), runs=runs, store=store, progress=progress
        )
    elif request.kind == "design":
        result = strikewave.design(
            case,
            request.lines("vary"),
            request.lines("goals"),
            analysis=request.line("analysis"),
            runs=runs,
            store=store,
            progress=progress,
        )
    elif request.kind == "settings":
        interval, peak, width = (request.line(key) or None for key in ("interval", "peak", "width"))
        result = strikewave.settings(interval, peak, width, case, progress=progress)
    elif request.kind == "map":
        text = request.line("points", MAP_POINTS)
        points = _whole(text.partition("x")[0].strip()), _whole(text.partition("x")[2].strip())
        if not 4 <= points[0] * points[1] <= MOST_CELLS:
            allowed = f"two numbers such as {MAP_POINTS}, at most {MOST_CELLS} cells together"
            raise InputError("points", text, allowed)
        result = strikewave.map(case, request.line("x", X), request.line("y", Y), points=points, progress=progress)
    elif request.kind == "scatter":
        result = strikewave.scatter(case, runs=RUNS if runs is None else runs, progress=progress)
    else:
        raise InputError("study", request.kind, ", ".join(KINDS))
    say(None, "pictures and report")
    return result_view(result, request.kind.capitalize(), request.source)


def refuse_other_files(request: StudyRequest) -> None:
    """Refuse a text that names a file beside the dropped ones, which relative names mean.

    Examples
    --------
    >>> source = CaseSource("li-ma-2019", "", (), "")
    >>> refuse_other_files(StudyRequest("sweep", source, (("vary", ("machine.speed=1 m/s..2 m/s:3",)),)))
    >>> refuse_other_files(StudyRequest("fit", source, (("to", ("/etc/passwd",)),)))
    Traceback (most recent call last):
    strikewave.base.errors.InputError: to: got "/etc/passwd"; allowed: numbers, and files dropped on this page by name
    """
    for key, lines in request.texts:
        for line in lines:
            if OTHER_FILE.search(line):
                raise InputError(key, line, "numbers, and files dropped on this page by name")


def _whole(text: str) -> int:
    """Return the whole number of a text of few digits; 0 for another text."""
    return int(text) if text.isdecimal() and len(text) < 8 else 0


def study_cases() -> list[str]:
    """Return the built-in cases, from which studies begin."""
    return bundled_cases()


def specifications() -> list[str]:
    """Return the names of the built-in specifications."""
    return asked_names()


def result_view(result: ShownResult, title: str, source: CaseSource) -> dict[str, Any]:
    """Return the view of a study of a case."""
    picked = picked_chart(result, source)
    heads, rows = shown_table(result)
    files: dict[str, str | bytes] = {name: text for name, text in result.tables().items() if isinstance(text, str)}
    files["report.html"] = result_file(result, "report.html")
    return {
        "by": full_run_label(result).replace("a full run", title.lower()),
        "figures": [list(row) for row in result.highlights()],
        "charts": [] if picked is None else [picked.options],
        "links": [] if picked is None else [picked.links],
        "found": linked_results(result, source),
        "pictures": pictures(result, title),
        "tables": [(title, heads, rows, (0,))],
        "notices": [(notice.severity, notice.code, notice.message) for notice in result.notices],
        "files": files,
    }


def pictures(result: ShownResult, title: str) -> list[tuple[bytes, str]]:
    """Return the picture of a result as SVG with its caption; none where there is none."""
    try:
        figure = result.plot()
    except StrikewaveError:
        return []
    return [(svg_of(figure), title)]


MOST_LISTED = 12
"""Results in the list: the best, or the first; a diagram has all."""
DIGITS = 4
"""Significant digits of a number in a diagram: more are below a pixel."""


MARKED = {RUN_BROKEN: "failed a check", RUN_FAILED: "could not be made"}
"""Names of marked runs, by their status."""


class PickedChart(NamedTuple):
    """A diagram, and the addresses of its points, which end with their place among these."""

    options: dict[str, Any]
    links: list[str]


class Linker:
    """Addresses of a studied case with changes.

    Examples
    --------
    >>> Linker(CaseSource("li-ma-2019", "", ("feed.blows=3",), "")).of({"machine.speed": "700 rpm"})
    '/?case=li-ma-2019&set=feed.blows%3D3&set=machine.speed%3D700+rpm'
    """

    def __init__(self, source: CaseSource) -> None:
        self._state = CaseState.of_source(source)
        self._place, _ = PAGES_OF.get(loaded(source).command, ("", ""))

    def of(self, changes: Mapping[str, str]) -> str:
        """Return the address of the case with more changes; empty where no page shows it."""
        state = self._state
        for path, value in changes.items():
            state = state.changed(path, value)
        has_page = bool(self._place) and (not state.text or state.fits_address)
        return address(self._place, state.query()) if has_page else ""

    def of_row(self, variables: Iterable[StudyVariable], row: Row) -> str:
        """Return the address of a run."""
        return self.of({variable.path: variable.shown(value) for variable, value in zip(variables, row, strict=True)})

    def of_case(self, case: Case, paths: Sequence[str]) -> str:
        """Return the address of a case that was derived from the studied one, by its values of some fields."""
        values = case.values()
        return self.of({path: str(values[path].typed) for path in paths})


def linked_results(result: Any, source: CaseSource) -> list[tuple[str, str]]:
    """Return the results of a study, the best first: each as text, with its address."""
    link = Linker(source)
    return [(text, place) for text, place in _listed(result, link) if place][:MOST_LISTED]


def _listed(result: Any, link: Linker) -> Iterator[tuple[str, str]]:
    if isinstance(result, SettingsStudy):
        for setting in result.candidates:
            values = setting.case.values()
            text = ", ".join(f"{path} = {values[path].typed}" for path in setting.chosen)
            yield _marked(text, setting.run_verdict), link.of_case(setting.case, setting.chosen)
    elif isinstance(result, FitStudy):
        values = result.case.values()
        paths = [row.field.path for row in result.parameters if row.field.path in values]
        yield ", ".join(f"{path} = {values[path].typed}" for path in paths), link.of_case(result.case, paths)
    elif isinstance(result, DesignStudy):
        for candidate in result.candidates:
            text = _marked(result.plan.at(candidate.row), candidate.verdict)
            yield text, link.of_row(result.plan.variables, candidate.row)
    elif isinstance(result, SweepStudy):
        for run, row in enumerate(result.plan.rows):
            yield _marked(result.at(run), result.verdicts.texts[run]), link.of_row(result.plan.variables, row)
    elif isinstance(result, MapStudy) and result.setting is not None:
        typed = {a.path: str(a.typed(v)) for a, v in zip(result.plan.axes, result.setting.values, strict=True)}
        yield ", ".join(f"{path} = {value}" for path, value in typed.items()), link.of(typed)


def _marked(text: str, verdict: str) -> str:
    """Return the text of a run with its verdict, where it broke a limit or failed."""
    return f"{text} ({verdict})" if verdict and status_of(verdict) != RUN_PASSED else text


def picked_chart(result: Any, source: CaseSource) -> PickedChart | None:
    """Return the diagram of a study whose points lead to its machines; None where its kind has none."""
    link = Linker(source)
    if isinstance(result, DesignStudy):
        return _design_chart(result, link)
    if isinstance(result, SweepStudy):
        return _sweep_chart(result, link)
    if isinstance(result, MapStudy):
        return _map_chart(result, link)
    return None


def _design_chart(study: DesignStudy, link: Linker) -> PickedChart:
    """Return all runs over the two most important numbers, grouped by goals and verdicts."""
    names = drawn_numbers(study)
    (x, x_label), (y, y_label) = (_numbers(study, name) for name in (names if len(names) == 2 else [None, *names]))
    met = study.margins >= 0.0
    ranked = {candidate.run for candidate in study.candidates}
    marked = study.verdicts.marked
    others = [k for k in range(len(study.rows)) if k not in ranked and not marked[k]]
    groups = [
        ("a goal is missed", [k for k in others if not met[k]]),
        ("all goals met", [k for k in others if met[k]]),
        *_marked_groups(study.verdicts, ranked),
        ("ranked", sorted(ranked)),
    ]
    links = [link.of_row(study.plan.variables, row) for row in study.rows]
    return PickedChart(dot_chart("Runs by their numbers", x_label, y_label, _dots(groups, x, y)), links)


def _numbers(study: DesignStudy, name: str | None) -> tuple[Any, str]:
    """Return a number of all runs in its shown unit, with its label; their order for none."""
    if name is None:
        return np.arange(1.0, len(study.rows) + 1.0), "run"
    number = study.kept(name)
    return study.numbers[:, study.plan.evaluation.names.index(name)] / number.scale, number.label


def _sweep_chart(study: SweepStudy, link: Linker) -> PickedChart:
    """Return the first number over the first setting, by the second where there is one."""
    variables, number = study.plan.variables, study.plan.kept[0]
    first = variables[0]
    x = study.settings[:, 0] if first.words else np.asarray(first.axis.shown(study.settings[:, 0]))
    runs = range(len(study.plan.rows))
    groups: dict[str, list[int]] = {}
    for run in runs:
        name = variables[1].brief(study.plan.rows[run][1]) if len(variables) > 1 else "runs"
        groups.setdefault(name, []).append(run)
    marked = study.verdicts.marked
    listed = list(groups.items()) if len(groups) <= MOST_LISTED else [("runs", list(runs))]
    listed = [(name, [run for run in members if not marked[run]]) for name, members in listed]
    listed += _marked_groups(study.verdicts)
    links = [link.of_row(variables, row) for row in study.plan.rows]
    options = dot_chart("Runs", first.label, number.label, _dots(listed, x, study.number(number.name) / number.scale))
    return PickedChart(options, links)


def _marked_groups(verdicts: Verdicts, left_out: Container[int] = ()) -> list[tuple[str, list[int]]]:
    """Return the runs that failed a check, and those that could not be made, each where there are any."""
    groups = []
    for status, name in MARKED.items():
        runs = [run for run, own in enumerate(verdicts.statuses) if own == status and run not in left_out]
        if runs:
            groups.append((name, runs))
    return groups


def _dots(groups: Iterable[tuple[str, list[int]]], x: Any, y: Any) -> list[Dots]:
    """Return groups of runs as dots, those without a number left out; each ends with its run."""
    return [
        Dots(name, [[_short(x[k]), _short(y[k]), k] for k in runs if np.isfinite(x[k]) and np.isfinite(y[k])])
        for name, runs in groups
    ]


def _map_chart(study: MapStudy, link: Linker) -> PickedChart:
    """Return the scatter of the peaks over the first two settings, of the first panel."""
    x, y = study.plan.axes[:2]
    further = {axis.path: str(axis.typed(axis.values[0])) for axis in study.plan.axes[2:]}
    cv = 100.0 * study.field("cv")[0]
    cells: list[list[float]] = []
    links: list[str] = []
    for j, of_y in enumerate(y.values):
        for i, of_x in enumerate(x.values):
            if np.isfinite(cv[j, i]):
                cells.append([i, j, _short(cv[j, i]), len(links)])
                links.append(link.of({x.path: str(x.typed(of_x)), y.path: str(y.typed(of_y)), **further}))
    columns, rows = ([f"{float(axis.shown(value)):.3g}" for value in axis.values] for axis in (x, y))
    options = heat_chart(
        declarations(MapCell)["cv"].quantity.label, x.label, y.label, columns, rows, cells, "%", signed=False
    )
    return PickedChart(options, links)


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
