"""The report of a reproduced paper: every equation, figure and published number that can be computed, on one page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from typing import TYPE_CHECKING

from strikewave.cases.case import Case
from strikewave.papers.li_ma_2019.report import tables as tables
from strikewave.papers.li_ma_2019.report.figures import figure_sections, fitted_inputs, key_numbers, overview_picture
from strikewave.papers.li_ma_2019.report.studies import study_tables
from strikewave.papers.li_ma_2019.result import Reproduction
from strikewave.papers.li_ma_2019.runs import BAR, PASSING, quick_changes
from strikewave.reporting import chapters
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Cell, Code, Section, Table, Tag

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def reproduction_report(result: Reproduction) -> str:
    """Return the report as one HTML page: no script, nothing fetched."""
    sections = [
        tables.claims_section(result.findings, overview_picture(result)),
        *figure_sections(result),
        tables.numbers_section(result.numbers, result.checks),
        *tables.equation_sections(result.equations),
        tables.elements_section(result.runs.elements, study_tables(result)),
        tables.findings_section(result.findings),
        chapters.warnings(result.notices),
        _done(result),
        tables.materials_section(result.numbers),
        tables.provenance_section(result.runs.cases),
        _one_by_one(result),
    ]
    summary = chapters.Summary(
        "Report of a reproduction", reproduction_words(result), key_numbers(result), _status(result)
    )
    return chapters.result_page(result, summary, sections)


def _status(result: Reproduction) -> Tag:
    if result.broken:
        return Tag("a run failed a check, see warnings", "bad")
    if not result.runs.elements:
        return Tag("the element models were not run", "warned")
    return Tag("quick: coarse elements", "warned") if result.runs.quick else Tag("all runs, full meshes", "good")


def reproduction_words(result: Reproduction) -> str:
    """Say in words what the paper claims, and what came out: on the screen and at the head of the report."""
    verdicts = [row.verdict for row in result.equations]
    counted = listed([f"{verdicts.count(name)} {name}" for name in tables.VERDICTS if name in verdicts])
    broken = f"{result.verdicts.sentence} " if result.verdicts.words else ""
    return (
        f"{broken}The paper says that a contact law with damping gives the rigid-body pulse of a rotary shock "
        "machine, that one-dimensional waves give what a sensor reads beyond it, and that tests and LS-DYNA confirm "
        f"both. Of its {len(verdicts)} numbered equations: {counted}. What the machine was fitted to agrees by "
        "construction; what was not shows how far bodies, springs and waves of assumed dimensions come."
    )


def _done(result: Reproduction) -> Section:
    fitted = sorted(set(fitted_inputs(result)))
    text = (
        f"{len(result.runs.cases)} cases were run: the rotary machine with its object as bodies and as stacks in which "
        "waves run, a bar alone"
        + (", and finite-element models" if result.runs.elements else "; the finite-element models were left out")
        + ". Every equation was computed as printed, as corrected and exactly; every published number is set beside "
        f"what was computed. Fitted to published numbers: {listed(fitted)}."
    )
    rows: list[list[Cell]] = [[name, verdict] for name, verdict in result.runs.checked]
    return Section("What was done", text, [Table("What the checks of the runs came to", ["run", "verdict"], rows)])


def _one_by_one(result: Reproduction) -> Section:
    lines = [*(again(case, result.runs.quick) for case in result.runs.cases), _command("bar", BAR, PASSING)]
    return Section("The runs, one by one", "Each has a report of its own.", [Code("\n".join(lines))])


def again(case: Case, quick: bool = False) -> str:
    """Return the command that runs a case as it was run here.

    Examples
    --------
    >>> from strikewave import load_case
    >>> again(load_case("li-ma-2019")), again(load_case("li-ma-2019-fem-wave"), quick=True)[:75]
    ('strikewave run li-ma-2019', "strikewave fem li-ma-2019-fem-wave --set 'mesh.part.striker.size=3.75 mm' -")
    """
    return _command(case.command, case.name, quick_changes(case.name) if quick and case.mesh else ())


def _command(command: str, case: str, changes: Sequence[str] = ()) -> str:
    return " ".join(["strikewave", command, case, *(f"--set {shlex.quote(change)}" for change in changes)])


page = reproduction_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def picture(result: Reproduction) -> Figure:
    """Return how far everything that can be compared is from the published numbers."""
    return overview_picture(result).figure
