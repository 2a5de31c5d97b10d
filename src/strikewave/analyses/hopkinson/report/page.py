"""What the reports of split Hopkinson bars have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.reporting import chapters
from strikewave.reporting.numbers import decimals_in, shown, spelled
from strikewave.reporting.parts import Section
from strikewave.reporting.shown_units import shown_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.analyses.hopkinson.outcome import Outcome


def outcome_page(solution: Outcome, summary: chapters.Summary, sections: Sequence[Section]) -> str:
    """Return the page of a report: its sections, then warnings and inputs."""
    last = [chapters.warnings(solution.notices), chapters.inputs(solution.case.setup)]
    return chapters.result_page(solution, summary, [*sections, *last])


def time_text(value: float, decimals: int, sign: str = "") -> str:
    """Write a time in the unit shown, with the decimals that it has in microseconds."""
    return f"{shown(value, 's', 'us'):{sign}.{decimals_in('s', 'us', decimals)}f}"


def delay_words(value: float, decimals: int) -> str:
    """Write a delay with its sign and its unit."""
    return f"{time_text(value, decimals, '+')} {spelled(shown_unit('s', 'us'))}"
