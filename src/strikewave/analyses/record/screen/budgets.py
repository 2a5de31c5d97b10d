"""The uncertainties of blows by a budget."""

from __future__ import annotations

from strikewave.analyses.record.budget_chapter import budget_lines, share_table, uncertainty_table
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.tables import rows_of, short_names
from strikewave.reporting.terminal import report_table, tell


def print_budget(result: RecordResult) -> None:
    """Print the uncertainty of each blow, of a single one what it is made of, and what the budget holds."""
    names = short_names([file.path for file in result.readings])
    blows = [one for _, reading in rows_of(result.readings) for one in reading.uncertainties]
    report_table(share_table(blows[0]) if len(blows) == 1 else uncertainty_table(result, names), keys=2)
    for line in budget_lines(result):
        tell(line, "  ")
