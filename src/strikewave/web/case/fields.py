"""The quantities of a case as a page edits them: words, unit, range of the slider."""

from __future__ import annotations

import math

from strikewave.base.quantities import Range
from strikewave.base.units import DIMENSIONS, parse_quantity
from strikewave.cases.case import Case
from strikewave.cases.explained import explanations
from strikewave.reporting.numbers import round_step
from strikewave.uncertainty.draws import range_of
from strikewave.uncertainty.known import field_of, known_inputs
from strikewave.web.case.edited_field import EditedField

REACH = 2.0
"""Half widths of what is known of a field that its slider reaches to both sides: beyond what is likely, and back."""
SHARE = 0.5
"""Reach of the slider of a field of which nothing is said, as a share of its value."""
LEAST = 0.05
"""Least that a slider gives of a value above nothing, as a share: a mass or a speed of nothing is no machine."""
STEPS = 200
"""Places of a slider: as many as a hand can tell apart on it."""


def edited_fields(case: Case) -> dict[str, EditedField]:
    """Return all quantities of a case by path, with the ranges of their sliders.

    Examples
    --------
    >>> from strikewave import load_case
    >>> speed = edited_fields(load_case("li-ma-2019"))["machine.speed"]
    >>> speed.label, speed.low < 730.0 < speed.high
    ('machine speed (rpm)', True)
    """
    known = {one.path: one for one in known_inputs(case)} if case.machine is not None else {}
    words = explanations("" if case.machine is None else case.machine.kind)
    fields = {}
    for path, value in case.values().items():
        field = field_of(case, path)
        allowed = range_of(case, path)
        unit = value.typed_unit
        scale = parse_quantity(f"1 {unit}", allowed.unit, path) if unit and allowed.unit in DIMENSIONS else 1.0
        one = known.get(path)
        half = max(one.high - value.si, value.si - one.low) if one is not None else 0.5 * SHARE * abs(value.si)
        low, high = _ends(value.si, REACH * half, allowed)
        step = 1.0 if allowed.unit == "count" else round_step((high - low) / scale / STEPS)
        what = words.get(field)
        fields[path] = EditedField(
            path=path,
            what=what.what if what else path,
            how=what.how if what else "see docs",
            typed=str(value.typed),
            unit=unit,
            value=value.si / scale,
            low=math.ceil(low / scale / step) * step,
            high=math.floor(high / scale / step) * step,
            step=step,
            provenance=value.provenance,
            scale=scale,
        )
    return fields


def _ends(value: float, reach: float, allowed: Range) -> tuple[float, float]:
    """Return the ends of a slider, SI: within what is allowed, and above nothing where the value is."""
    least = max(allowed.low, LEAST * value) if value > 0.0 else allowed.low
    return max(value - reach, least), min(value + reach, allowed.high)
