"""Inputs within what their case allows: where a whole side of a range is refused, the other side moves alone.

What a quantity may be can depend on others: a pad with a retardation has a restitution of 1, and no less. A range that
does not know this would make every run fail that is drawn from the refused side.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from strikewave.base.errors import StrikewaveError
from strikewave.cases.case import Case
from strikewave.uncertainty.draws import UncertainInput, drawn_case, together

STEPS = 10
"""Halvings by which the end of what is allowed is found: to a thousandth of the side of a range."""


def allowed_inputs(
    case: Case, inputs: Sequence[UncertainInput], build: Callable[[Case], object]
) -> tuple[UncertainInput, ...]:
    """Return inputs, each on the part of its range that the case allows while the others are nominal.

    Parameters
    ----------
    case : Case
        Whose inputs they are.
    inputs : sequence of UncertainInput
        What moves, and how far.
    build : callable
        Makes of a case what runs, and raises where parts of it do not go together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.analyses.machine.build import build_machine
    >>> from strikewave.uncertainty.known import known_inputs
    >>> pad = ["contact.cushion.retardation=20 us", "contact.restitution=1"]
    >>> case = load_case("iec-60068-2-27-rubber", pad)
    >>> known = known_inputs(case)
    >>> sorted({one.path for one in known} - {one.path for one in allowed_inputs(case, known, build_machine)})
    ['contact.restitution']
    """

    def goes(moved: UncertainInput, number: float) -> bool:
        columns = {one.path: np.full((1, one.count), one.value.si) for one in inputs}
        columns[moved.path][:] = number
        try:
            build(drawn_case(case, inputs, together(inputs, columns)[0].tolist()))
        except (StrikewaveError, ValueError, ArithmeticError):
            return False
        return True

    def end(one: UncertainInput, wanted: float) -> float:
        if goes(one, wanted):
            return wanted
        good, bad = one.value.si, wanted
        for _ in range(STEPS):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if goes(one, middle) else (good, middle)
        return good

    if not inputs or not goes(inputs[0], inputs[0].value.si):
        return tuple(inputs)
    kept = []
    for one in inputs:
        low, high = end(one, one.low), end(one, one.high)
        if (low, high) == (one.low, one.high):
            kept.append(one)
        elif high > low:
            reason = f"{one.reason}; as far as the case allows"
            kept.append(dataclasses.replace(one, low=low, high=high, reason=reason))
    return tuple(kept)
