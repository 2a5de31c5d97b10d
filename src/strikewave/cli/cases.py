"""``strikewave cases``: the published cases that come along."""

from __future__ import annotations

from strikewave.base.json_document import head
from strikewave.reporting.terminal import Json, print_json, table


def command(json: Json = False) -> int:
    """List the published cases that come along."""
    from strikewave.cases.case import bundled_cases, load_case

    found = [load_case(name) for name in bundled_cases()]
    if json:
        listed = [{"name": c.name, "title": c.title, "source": c.source, "command": c.command} for c in found]
        print_json({**head({}), "cases": listed})
    else:
        rows = [[f"strikewave {c.command} {c.name}", c.title] for c in found]
        table("Published cases", ["to run it", "title"], rows, left=2)
    return 0
