"""Run the integrator and hold what it found: a motion that can be asked for any time afterwards."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact import _integrator
from strikewave.contact._integrator import FULL, STUCK, Control, StepRecord

Array = NDArray[np.float64]

FIRST_STEP = 2e-3
"""First step over the shortest time in which a motion changes: so short that its error, of the 8th power, is rounding;
the step then grows sixfold at a time."""
_ROWS = 2048
"""Steps that are followed at once: some megabytes for a chain of a few bodies."""
_GROWTH = 8
"""How many times longer a record becomes when it is full: it is copied, and memory that is new takes as long to get as
to compute what it holds, so that this happens once in a usual run; what is not filled takes none."""
_MOST_BYTES = 1_000_000_000
"""Dense output beyond this is refused: a motion of that size takes minutes, and usually a stiffness or damping is
wrong."""
_SLACK = 1e-9
"""Share of a motion by which a time may lie outside of it: what comes from rounding is taken as its begin or end."""


class MotionState(NamedTuple):
    """Where a motion stands: time (s), state, integer modes, and floats remembered at switches."""

    time: float
    y: Array
    mode: NDArray[np.int64]
    memory: Array


class Motion:
    """A motion with dense output of order 7 between located switches.

    Attributes
    ----------
    end : MotionState
        The last state.
    record : StepRecord
        Accepted steps and switches.
    """

    def __init__(self, system: Any, record: StepRecord, end: MotionState, links: int) -> None:
        self.system = system
        self.record = record
        self.end = end
        self.links = links

    def sample(self, times: float | Array) -> tuple[Array, Array]:
        """Return states (N, n) and link forces (N, links) at times within the motion, s, in any order.

        Right at a switch the later side answers.

        Raises
        ------
        ValueError
            If a time lies outside the motion.
        """
        instants = np.array(times, dtype=float, order="C", ndmin=1)
        first, last = self.record.time[0], self.end.time
        slack = _SLACK * (last - first)
        if not np.all((instants >= first - slack) & (instants <= last + slack)):
            raise ValueError(f"times must lie within the motion, {first:g} to {last:g} s")
        states = np.empty((instants.size, self.end.y.size))
        forces = np.empty((instants.size, self.links))
        if np.all(instants[1:] >= instants[:-1]):
            _integrator.sample(self.system, self.record, instants, states, forces)
            return states, forces
        order = np.argsort(instants, kind="stable")
        _integrator.sample(self.system, self.record, instants[order], states, forces)
        back = np.argsort(order, kind="stable")
        return states[back], forces[back]

    def impulses(self) -> Array:
        """Return the time integral of each link force over each step, N s, shape (steps, links).

        Found by Gauss quadrature of the dense output, independently of the integration of speeds.
        """
        out = np.empty((self.record.time.size, self.links))
        _integrator.impulses(self.system, self.record, out)
        return out


def integrate(
    system: Any,
    start: MotionState,
    control: Control,
    sizes: tuple[int, int],
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """Integrate a system from ``start`` to ``control.end`` or to a switch that stops it.

    Parameters
    ----------
    system : NamedTuple
        A system of the integrator's protocol.
    start : MotionState
        Where it starts; left as it is.
    control : Control
        Tolerance, scales, steps and end.
    sizes : (int, int)
        Number of links and of switch functions.
    progress : callable, optional
        Called with the time reached, every few thousand steps.

    Raises
    ------
    ValueError
        If the end is not after the start, or not finite.
    IntegrationError
        If the step shrinks to nothing, the state is not finite, or the steps would take more than 1 GB.
    """
    if not start.time < control.end < math.inf:
        raise ValueError(f"the motion must end after {start.time:g} s, and end, got {control.end!r}")
    t, h = start.time, control.first_step
    y, mode, memory = start.y.copy(), start.mode.copy(), start.memory.copy()
    record, filled, switched = _integrator.empty_record(_ROWS, y.size, mode.size, memory.size), 0, 0
    status = FULL
    while status == FULL:
        if max(filled, switched) + _ROWS > record.time.size:
            longer = _integrator.empty_record(_GROWTH * record.time.size, y.size, mode.size, memory.size)
            for new, old in zip(longer, record, strict=True):
                new[: len(old)] = old
            record = longer
        part = StepRecord(*_rows(record, filled, filled + _ROWS, switched, switched + _ROWS))
        status, t, h, steps, events = _integrator.advance(system, control, t, h, y, mode, memory, part, sizes[1])
        part.event[:events, 1] += filled
        filled, switched = filled + steps, switched + events
        if status == STUCK or not np.all(np.isfinite(y)):
            raise IntegrationError(
                f"the motion could not be followed beyond t = {t:.9g} s (step {h:.3g} s): "
                "a stiffness, damping or mass is extreme; compare the values with the built-in cases"
            )
        if status == FULL and record.dense[:filled].nbytes > _MOST_BYTES:
            raise IntegrationError(
                f"more than {_MOST_BYTES / 1e9:.0f} GB of steps by t = {t:.4g} s of {control.end:.4g} s: "
                "follow a shorter time, loosen the tolerance, or soften the stiffest spring"
            )
        if progress is not None:
            progress(t)
    whole = StepRecord(*_rows(record, 0, filled, 0, switched))
    return Motion(system, whole, MotionState(t, y, mode, memory), sizes[0])


def _rows(record: StepRecord, first: int, last: int, first_switch: int, last_switch: int) -> list[Any]:
    """Return a part of a record: some of its steps, and some of its switches."""
    *steps, event_time, event = record
    return [*(one[first:last] for one in steps), *(one[first_switch:last_switch] for one in (event_time, event))]
