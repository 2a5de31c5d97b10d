"""The report of a machine's run as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

from strikewave.analyses.machine import chapters
from strikewave.analyses.machine.stack_chapters import felt_words, sensor_section, stack_section
from strikewave.reporting import chapters as shared
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import NONE, Section

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution
    from strikewave.machines import Blow


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
    summary = shared.Summary("Report of a run", _summary(solution), _key_numbers(solution))
    return shared.result_page(solution, summary, parts)


def _struck(solution: Solution) -> list[Blow]:
    return [blow for blow in solution.blows if blow.kind != "missed"]


def _interval(struck: Sequence[Blow]) -> float | None:
    """Return the median time between blows, s; None for fewer than two."""
    return median(b.time - a.time for a, b in pairwise(struck)) if len(struck) > 1 else None


def _summary(solution: Solution) -> str:
    """Say in words what happened."""
    struck = _struck(solution)
    if not struck:
        missed = len(solution.blows)
        passes = f" {missed} {'striker' if missed == 1 else 'strikers'} passed without touching it." if missed else ""
        return f"No blow: no striker touched the object.{passes} There is no pulse to measure."
    first, later = struck[0], [blow for blow in struck[1:] if blow.kind in ("full", "double")]
    kinds = [blow.kind for blow in solution.blows]
    odd = [f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds) if kind != "full"]
    whole = "all full" if not odd else f"among {len(kinds)} passes {listed(odd)}"
    many = "One blow, full" if len(struck) == 1 and not odd else f"{len(struck)} blows, {whole}"
    interval = _interval(struck)
    apart = "" if interval is None else f", {with_unit(interval, 's', 'ms')} apart (median)"
    width = with_unit(first.width, "s", "us")
    wide = f"is {width} wide at 10 % of its peak" if width != NONE else "has no width"
    words = [
        f"{many}{apart}.",
        f"The first reaches a rigid-body acceleration of {with_unit(first.rigid_peak, 'm/s^2', 'g')}, {wide} and "
        f"changes the object's velocity by {with_unit(first.velocity_change, 'm/s', 'm/s', 3)}; the contact force "
        f"peaks at {with_unit(first.peak_force, 'N', 'kN', 3)}.",
    ]
    if later:
        peak, span = (median(getattr(blow, name) for blow in later) for name in ("rigid_peak", "width"))
        words.append(f"Later blows: {with_unit(peak, 'm/s^2', 'g')} and {with_unit(span, 's', 'us')} (medians).")
    words += felt_words(solution)
    return " ".join(words)


def _key_numbers(solution: Solution) -> list[tuple[str, str]]:
    struck = _struck(solution)
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
    interval = _interval(struck)
    return pairs if interval is None else [*pairs, ("interval, median", with_unit(interval, "s", "ms"))]
