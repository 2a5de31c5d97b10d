"""The report of a machine's run as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.machine import chapters
from strikewave.analyses.machine.stack_chapters import accuracy_section, sensor_section, stack_section
from strikewave.analyses.machine.words import summary_words
from strikewave.reporting import chapters as shared
from strikewave.reporting.bands import band_sections
from strikewave.reporting.parts import Section

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution


def report(solution: Solution, sections: Sequence[Section] = (), moving: str = "") -> str:
    """Return the report of a run as one HTML page: no script, nothing fetched, the same bytes each time.

    Parameters
    ----------
    solution : Solution
        What ran and what it gave; what is empty is said in words.
    sections : sequence of Section, optional
        Further sections, shown after the pulses in this order.
    moving : str, optional
        Name of the file beside the report that shows the machine in motion, if there is one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> page = report(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> page.splitlines()[0], "<script" in page
    ('<!doctype html>', False)
    """
    parts = [
        chapters.pulse_pictures(solution, moving),
        *stack_section(solution),
        *sensor_section(solution),
        *sections,
        chapters.blow_table(solution),
        *band_sections(solution),
        *shared.published(solution.comparisons),
        shared.warnings(solution.notices),
        chapters.setup(solution.case),
        shared.inputs(solution.case),
        *accuracy_section(solution),
        chapters.checks(solution),
    ]
    summary = shared.Summary("Report of a run", summary_words(solution), solution.highlights())
    return shared.result_page(solution, summary, parts)
