"""What a page shows of any result: key numbers, picture, table, notices, report; it runs in processes of the app."""

from __future__ import annotations

from typing import Any

from strikewave.base.errors import StrikewaveError
from strikewave.reporting.shown_result import ShownResult, shown_table
from strikewave.web.case.state import CaseSource
from strikewave.web.case.view import by_full_run, result_file
from strikewave.web.curves import svg_of
from strikewave.web.pages.study.found_machines import found, picked_chart


def result_view(result: ShownResult, title: str, source: CaseSource) -> dict[str, Any]:
    """Return what a page shows of a study of a case."""
    picked = picked_chart(result, source)
    heads, rows = shown_table(result)
    files: dict[str, str | bytes] = {name: text for name, text in result.tables().items() if isinstance(text, str)}
    files["report.html"] = result_file(result, "report.html")
    return {
        "by": by_full_run(result).replace("a full run", title.lower()),
        "figures": [list(row) for row in result.highlights()],
        "charts": [] if picked is None else [picked.options],
        "links": [] if picked is None else [picked.links],
        "found": found(result, source),
        "pictures": pictures(result, title),
        "tables": [(title, heads, rows, (0,))],
        "notices": [(one.severity, one.code, one.message) for one in result.notices],
        "files": files,
    }


def pictures(result: ShownResult, title: str) -> list[tuple[bytes, str]]:
    """Return the picture of a result as SVG with its caption; none where there is none."""
    try:
        figure = result.plot()
    except StrikewaveError:
        return []
    return [(svg_of(figure), title)]
