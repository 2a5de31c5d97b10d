"""The report of a result that has none of its own: key numbers, picture, table, warnings."""

from __future__ import annotations

from strikewave.base.errors import StrikewaveError
from strikewave.reporting.chapters import Summary, result_page, warnings
from strikewave.reporting.parts import Picture, Section, Table
from strikewave.reporting.shown_result import ShownResult, shown_table


def plain_page(result: ShownResult) -> str:
    """Return the report of a result as one HTML page.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> plain_page(run_case(load_case("li-ma-2019", ["feed.blows=1"]))).splitlines()[0]
    '<!doctype html>'
    """
    try:
        parts: list[Picture | Table] = [Picture(result.plot(), result.title)]
    except StrikewaveError:
        parts = []
    heads, rows = shown_table(result)
    if heads:
        parts.append(Table("The main table", heads, rows))
    summary = Summary(f"Report of {result.command}", "", result.highlights())
    return result_page(result, summary, [Section("Result", "", parts), warnings(result.notices)])
