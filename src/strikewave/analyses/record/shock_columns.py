"""All shocks with their verdicts as a table for files."""

from __future__ import annotations

import math

from strikewave.reporting.columns import Column
from strikewave.reporting.shown_result import columns_of_mappings
from strikewave.specifications.judged_records import RecordsVerdict
from strikewave.specifications.judging import FAIL, NOT_JUDGED


def shock_columns(found: RecordsVerdict) -> list[Column]:
    """Return all shocks with their verdicts: a line each, a value and a margin for each clause, in SI."""
    by_name = dict.fromkeys(clause.clause for one in found.shocks for clause in one.found.clauses)
    rows, units = [], {"time": "s"}
    for number, shock in enumerate(found.shocks, start=1):
        row: dict[str, object] = {
            "number": number,
            "file": shock.file,
            "channel": shock.reading.channel.name,
            "blow": shock.number,
            "direction": shock.direction,
            "time": shock.pulse.time,
            "verdict": shock.found.verdict,
            "fails": ", ".join(clause.clause for clause in shock.found.clauses if clause.verdict == FAIL),
        }
        clauses = {clause.clause: clause for clause in shock.found.clauses}
        for name in by_name:
            clause = clauses.get(name)
            judged_here = clause is not None and clause.verdict != NOT_JUDGED
            for what in ("value", "margin", "uncertainty"):
                key = f"{name} {what}".replace(" value", "")
                row[key] = getattr(clause, what) if judged_here else math.nan
                units[key] = units.get(key) or (clause.unit if clause is not None else "")
        rows.append(row)
    return columns_of_mappings(rows, units)
