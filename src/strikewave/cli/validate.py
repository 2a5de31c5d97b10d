"""``strikewave validate``: check a case and list its values with their provenance."""

from __future__ import annotations

from collections import Counter

from strikewave.cli.common import CaseName, Changes, Json, print_json, table
from strikewave.documents import head


def command(case: CaseName, changes: Changes = None, json: Json = False) -> int:
    """Check a case without running it; list every value and where it comes from."""
    from strikewave.build import check
    from strikewave.case import load_case
    from strikewave.quantities import PROVENANCES

    read = load_case(case, changes or ())
    check(read)
    values = read.values()
    counted = Counter[str](value.provenance for value in values.values())
    if json:
        rows = {
            path: {"value": v.si, "typed": v.typed, "provenance": v.provenance, "note": v.note}
            for path, v in values.items()
        }
        print_json({**head({"value": "SI"}), "case": read.name, "provenance": dict(counted), "values": rows})
        return 0
    shown = [[path, str(v.typed), v.provenance, v.note] for path, v in values.items()]
    table(read.title or read.name, ["field", "value", "provenance", "note"], shown, left=4)
    print("valid: " + ", ".join(f"{counted[p]} {p}" for p in PROVENANCES if counted[p]))
    return 0
