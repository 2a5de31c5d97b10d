"""``strikewave cases``: the built-in cases."""

from __future__ import annotations

from strikewave.base.json_document import head
from strikewave.cases.case import bundled_cases, load_case
from strikewave.reporting.options import Json
from strikewave.reporting.terminal import print_json, table


def command(json: Json = False) -> int:
    """List the built-in cases."""
    cases = [load_case(name) for name in bundled_cases()]
    if json:
        listed = [{"name": c.name, "title": c.title, "source": c.source, "command": c.command} for c in cases]
        print_json({**head({}), "cases": listed})
    else:
        rows = [[f"strikewave {c.command} {c.name}", c.title] for c in cases]
        table("Built-in cases", ["to run it", "title"], rows, left=2)
    return 0
