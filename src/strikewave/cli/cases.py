"""``strikewave cases``: the built-in cases."""

from __future__ import annotations

from strikewave.base.json_document import head
from strikewave.cases.case import load_case
from strikewave.cases.case_files import bundled_cases
from strikewave.reporting.layout import keys, texts
from strikewave.reporting.options.output import Shown
from strikewave.reporting.terminal import print_json, table, tell


def command(shown: Shown) -> int:
    """List the built-in cases."""
    cases = [load_case(name) for name in bundled_cases()]
    if shown.json:
        listed = [{"name": c.name, "title": c.title, "source": c.source, "command": c.command} for c in cases]
        print_json({**head({}), "cases": listed})
    else:
        rows = [[f"strikewave {c.command} {c.name}", c.title] for c in cases]
        tell(f"{len(cases)} built-in cases.")
        table("Built-in cases", [*keys("to run it"), *texts("title")], rows)
    return 0
