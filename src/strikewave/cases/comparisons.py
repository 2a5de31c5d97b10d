"""The published numbers of a case compared with the computed ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from strikewave.base.first_few import first_few
from strikewave.base.result import INFO, Comparison, Notice
from strikewave.cases.case import DIFFERS, Case
from strikewave.cases.tables.published import Published

LISTED = 3
"""Fields that a notice names; the report names all."""


def comparisons(case: Case, computed: Callable[[Published], float | None]) -> tuple[Comparison, ...]:
    """Compare the published numbers of a case with the computed ones."""
    rows = []
    for entry in case.compared():
        value = computed(entry)
        rows.append(
            Comparison(
                quantity=entry.quantity,
                published=entry.value.si,
                measured_or_simulated=entry.origin,
                computed=value,
                difference=None if value is None else value / entry.value.si - 1.0,
                role=entry.role,
                note=entry.note,
                sensor=entry.sensor,
            )
        )
    return tuple(rows)


def origin_notices(case: Case) -> Iterator[Notice]:
    """Report what a case no longer has of the one that it comes from: published numbers, and fits."""
    changed, compared = case.changed_fields(), case.compared()
    listed = f"it differs in {first_few(changed, LISTED)}"
    if len(compared) < len(case.published) and case.compare is None:
        message = f"not compared with the published numbers of {case.source}: {listed}; compare = true shows them"
        yield Notice("not-compared", message, float(len(changed)), 0.0, severity=INFO)
    elif changed and any(entry.role == "shown" and entry.note.startswith(DIFFERS) for entry in compared):
        message = f"the published numbers belong to the case {case.source}: {listed}"
        yield Notice("changed-case", message, float(len(changed)), 0.0, severity=INFO)
    stale = case.stale_fits()
    if stale:
        paths = list(dict.fromkeys(change.path for one in stale for change in one.changed))
        fields = ", ".join(one.field for one in stale)
        message = (
            f"the fit of {fields} no longer applies: it was made under another {first_few(paths, LISTED)}; fit again, "
            "with records of both to have it for both, or take them as assumed"
        )
        yield Notice("fit-stale", message, float(len(paths)), 0.0)
