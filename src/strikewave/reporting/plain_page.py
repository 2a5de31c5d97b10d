"""The report of a result that has none of its own: key numbers, picture, table, warnings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from strikewave.reporting.chapters import Summary, result_page, warnings
from strikewave.reporting.parts import Picture, Section, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.base.result import Result


def plain_page(
    result: Result, numbers: Sequence[tuple[str, str]], figure: Figure | None, heads: list[str], rows: list[list[str]]
) -> str:
    """Return the report of a result as one HTML page.

    Parameters
    ----------
    result : Result
        What came of a command.
    numbers : sequence of (str, str)
        Label and value of its key numbers.
    figure : Figure or None
        Its picture.
    heads, rows : list
        Its main table; none where there are no heads.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> solution = run_case(load_case("li-ma-2019", ["feed.blows=1"]))
    >>> plain_page(solution, solution.highlights(), None, ["blow"], [["1"]]).splitlines()[0]
    '<!doctype html>'
    """
    parts: list[Picture | Table] = [] if figure is None else [Picture(figure, result.title)]
    parts += [Table("The main table", heads, rows)] if heads else []
    summary = Summary(f"Report of {result.command}", "", numbers)
    return result_page(result, summary, [Section("Result", "", parts), warnings(result.notices)])
