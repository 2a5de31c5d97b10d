"""A verdict on the screen: clauses where they came out worst, and every shock of several."""

from __future__ import annotations

from strikewave.analyses.record.verdicts.words import WHY_HEAD, name_of_shock, why_of_shock
from strikewave.reporting.clause_words import (
    SHOWN,
    clause_columns,
    clause_name,
    decision_words,
    value_words,
)
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.parts import NONE
from strikewave.reporting.terminal import print_rows, table, tell
from strikewave.specifications.judged_records import RecordsVerdict
from strikewave.specifications.judging import WORST_FIRST

MOST_SHOCKS = 20
"""Shocks of the table on the screen, the failed ones first; report and JSON have all."""


def print_verdict(found: RecordsVerdict, names: dict[str, str]) -> None:
    """Print the clauses, and the shocks where there are several."""
    several = len({shock.reading.channel.name for shock in found.shocks}) > 1
    many = len(found.shocks) > 1
    columns = clause_columns([clause for clause, _ in found.clauses])
    if many:
        worst = [name_of_shock(shock, names, several) for _, shock in found.clauses]
        columns.append(Column("worst", worst, priority=MORE, words=True))
    print_rows(f"By {found.specification.title}", columns)
    tell(decision_words(found.asked.rule, found.asked.holds, found.asked.not_stated))
    for clause, _ in found.clauses:
        if clause.reason:
            tell(f"{clause.clause}: {clause.reason}", "  ")
    if many:
        _print_shocks(found, names, several)


def _print_shocks(found: RecordsVerdict, names: dict[str, str], several: bool) -> None:
    shocks = sorted(found.shocks, key=lambda shock: WORST_FIRST.index(shock.found.verdict))
    by_name = list(dict.fromkeys(clause.clause for shock in shocks for clause in shock.found.clauses))
    figures = [name for name in by_name if name in ("peak", "velocity change") or name.startswith("pulse width")]
    directed = any(shock.direction for shock in shocks)
    rows = []
    for shock in shocks[:MOST_SHOCKS]:
        clauses = {clause.clause: clause for clause in shock.found.clauses}
        rows.append(
            [
                name_of_shock(shock, names, several),
                *([shock.direction or NONE] if directed else []),
                *[value_words(clauses[name]) if name in clauses else NONE for name in figures],
                SHOWN[shock.found.verdict],
                why_of_shock(shock),
            ]
        )
    columns = [*keys("shock"), *(texts("direction") if directed else []), *numerals(*map(clause_name, figures))]
    columns += [*texts("verdict"), *texts(WHY_HEAD, priority=MORE)]
    left = f", the first {MOST_SHOCKS} of {len(shocks)}" if len(shocks) > MOST_SHOCKS else ""
    table(f"Shocks, those that fail first{left}", columns, rows)
