"""The report of a machine's run as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.machine import chapters
from strikewave.analyses.machine.stack_chapters import sensor_section, stack_section
from strikewave.analyses.machine.words import median_interval, struck_blows, summary
from strikewave.reporting import chapters as shared
from strikewave.reporting.numbers import with_unit
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
        chapters.setup(solution.case, moving),
        shared.inputs(solution.case),
        chapters.blow_table(solution),
        chapters.pulse_pictures(solution),
        *stack_section(solution),
        *sensor_section(solution),
        *sections,
        shared.published(solution.comparisons),
        shared.warnings(solution.notices),
        chapters.checks(solution),
    ]
    head = shared.Summary("Report of a run", summary(solution), _key_numbers(solution))
    return shared.result_page(solution, head, parts)


def _key_numbers(solution: Solution) -> list[tuple[str, str]]:
    struck = struck_blows(solution)
    wanted = solution.case.feed.blows if solution.case.feed else None
    pairs = [("blows" if wanted is None else f"blows of {wanted.si:.0f} wanted", str(len(struck)))]
    if not struck:
        return pairs
    first = struck[0]
    pairs += [
        ("first peak, rigid body", with_unit(first.rigid_peak, "m/s^2", "g")),
        ("first width, at 10 % of the peak", with_unit(first.width, "s", "us")),
        ("velocity change, first blow", with_unit(first.velocity_change, "m/s", "m/s", 3)),
        ("contact force, first blow", with_unit(first.peak_force, "N", "kN", 3)),
    ]
    if solution.contact is not None and solution.contact.differ and solution.contact.band is not None:
        low, high = (with_unit(peak, "m/s^2", "g") for peak in solution.contact.band)
        pairs.append(("first peak, range of a yielding contact", f"{low} to {high}"))
    interval = median_interval(struck)
    return pairs if interval is None else [*pairs, ("interval, median", with_unit(interval, "s", "ms"))]
