"""What the reports of split Hopkinson bars have in common."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from strikewave.base.declare import GivenUnits, declarations
from strikewave.reporting import chapters
from strikewave.reporting.faces import cell_text, label_of
from strikewave.reporting.parts import Cell, Section

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.analyses.hopkinson.outcome import Outcome


def outcome_page(solution: Outcome, summary: chapters.Summary, sections: Sequence[Section]) -> str:
    """Return the page of a report: its sections, then warnings and inputs."""
    last = [chapters.warnings(solution.notices), chapters.inputs(solution.case.setup)]
    return chapters.result_page(solution, summary, [*sections, *last])


def line_of(value: Any, field: str, note: str, given: GivenUnits = MappingProxyType({})) -> list[Cell]:
    """Return a line of a table: a field of a declared value with its label, and a note."""
    return [label_of(field, declarations(type(value))[field]), cell_text(value, field, given), note]
