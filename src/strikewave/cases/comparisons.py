"""The published numbers of a case compared with the computed ones."""

from __future__ import annotations

from collections.abc import Callable

from strikewave.base.result import Comparison
from strikewave.cases.case import Case
from strikewave.cases.tables import Published


def comparisons(case: Case, computed: Callable[[Published], float | None]) -> tuple[Comparison, ...]:
    """Compare the published numbers of a case with the computed ones; of a changed case they are only shown."""
    changed = case.changed_fields()
    aside = f"the case differs in {', '.join(changed)}" if changed else ""
    rows = []
    for entry in case.published:
        value = computed(entry)
        rows.append(
            Comparison(
                quantity=entry.quantity,
                published=entry.value.si,
                measured_or_simulated=entry.origin,
                computed=value,
                difference=None if value is None else value / entry.value.si - 1.0,
                role="shown" if changed else entry.role,
                note=aside or entry.note,
                sensor=entry.sensor,
            )
        )
    return tuple(rows)
