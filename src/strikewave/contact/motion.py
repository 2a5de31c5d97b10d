"""Motions: the integrator's steps, from which states and forces at any time are sampled afterwards.

A motion is followed in stretches of some hundred steps. Of each is kept where it begins, and its steps until they take
`_KEPT_BYTES`; of a longer motion, later stretches are followed again from there where they are asked for, and come out
equal to the bit: so the memory of a motion of any length is bounded.
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact import _integrator
from strikewave.contact._integrator import FULL, STUCK, Control, StepRecord

Array = NDArray[np.float64]

FIRST_STEP = 2e-3  # its error, of the 8th power, is rounding; the step then grows sixfold at a time
"""First step over the shortest time in which a motion changes."""
_ROWS = 512  # half a blow of a machine, 1.2 MB, of which a single time is found again in some milliseconds
"""Steps of a stretch."""
_KEPT_BYTES = 256_000_000  # some hundred blows of a machine
"""Bytes of steps that are kept for good."""
_RECENT = 16  # a figure of one blow asks for several, repeatedly
"""Further stretches that are kept until others are asked for."""
_MOST_STEPS = 5_000_000  # five times those of a thousand blows; beyond, a stiffness or damping is usually wrong
"""Most steps of a motion."""
_ROUNDING = 1e-15
"""Largest difference of the times of a switch and of a step that begins or ends there, s."""
_SLACK = 1e-9
"""Share of a motion by which a time may lie outside of it through rounding; it is taken as its begin or end."""


class MotionState(NamedTuple):
    """Point of a motion: time (s), state, integer modes, and floats remembered at switches."""

    time: float
    y: Array
    mode: NDArray[np.int64]
    memory: Array

    def copy(self) -> MotionState:
        """Return the same in arrays of its own."""
        return MotionState(self.time, self.y.copy(), self.mode.copy(), self.memory.copy())


class Changes(NamedTuple):
    """Modes and memories of a motion, a row each, and the time from which a row holds, s."""

    time: Array
    mode: NDArray[np.int64]
    memory: Array


class Switched(NamedTuple):
    """Times, s, at which switches changed, and their numbers."""

    time: Array
    which: NDArray[np.int64]


class _Checkpoint(NamedTuple):
    """Begin of a stretch, and the step to try there, s."""

    state: MotionState
    step: float


class _Stretch:
    """Steps in a row with their dense output."""

    def __init__(self, system: Any, record: StepRecord, links: int) -> None:
        self.record = record
        self._system, self._links = system, links
        self._impulses: Array | None = None

    @property
    def nbytes(self) -> int:
        """Bytes that it takes."""
        return sum(array.nbytes for array in self.record) + (0 if self._impulses is None else self._impulses.nbytes)

    def impulses(self) -> Array:
        """Return the integral of each link force over each step, N s, (steps, links), by Gauss quadrature.

        It is independent of the integration of speeds: an energy or momentum balance compares both.
        """
        if self._impulses is None:
            self._impulses = np.empty((self.record.time.size, self._links))
            _integrator.impulses(self._system, self.record, self._impulses)
        return self._impulses


class Motion:
    """Motion with dense output of order 7 between located switches, from ``begin``, s, to the state ``end``.

    ``changes`` are its modes and memories over time, ``switched`` its switches in order of time, ``links`` the number
    of its link forces.
    """

    def __init__(self, system: Any, start: MotionState, control: Control, sizes: tuple[int, int]) -> None:
        self.links, self._switches = sizes
        self.system, self._control = system, control
        self.begin, self.end = start.time, start.copy()
        self.changes = Changes(np.empty(0), np.empty((0, start.mode.size), np.int64), np.empty((0, start.memory.size)))
        self.switched = Switched(np.empty(0), np.empty(0, np.int64))
        self._checkpoints: list[_Checkpoint] = []
        self._kept: list[_Stretch] = []
        self._recent: dict[int, _Stretch] = {}

    def follow(self, progress: Callable[[float], None] | None = None) -> None:
        """Integrate to the end, or to a switch that stops; see `integrate`."""
        changes, switched = [self.changes], [self.switched]
        following, status, steps, bytes_kept = _Checkpoint(self.end, self._control.first_step), FULL, 0, 0
        while status == FULL:
            checkpoint = following
            status, record, following = self._follow(checkpoint)
            t, y, *_ = self.end = following.state
            if status == STUCK or not np.all(np.isfinite(y)):
                raise IntegrationError(
                    f"the motion could not be followed beyond t = {t:.9g} s (step {following.step:.3g} s): "
                    "a stiffness, damping or mass is extreme; compare the values with the built-in cases"
                )
            switched.append(Switched(record.event_time, record.event[:, 0]))
            if record.time.size:
                after = np.unique(np.append(record.event[:, 1], 0))
                after = after[after < record.time.size]  # what changes at the end is of the next stretch
                changes.append(Changes(*(column[after] for column in (record.time, record.mode, record.memory))))
                self._checkpoints.append(checkpoint)
                stretch = _Stretch(self.system, record, self.links)
                if bytes_kept < _KEPT_BYTES:
                    self._kept.append(stretch)
                    bytes_kept += stretch.nbytes
            steps += record.time.size
            if status == FULL and steps >= _MOST_STEPS:
                raise IntegrationError(
                    f"more than {_MOST_STEPS:.0e} steps by t = {t:.4g} s of {self._control.end:.4g} s: "
                    "follow a shorter time, loosen the tolerance, or soften the stiffest spring"
                )
            if progress is not None:
                progress(t)
        self.changes = Changes(*(np.concatenate(column) for column in zip(*changes, strict=True)))
        self.switched = Switched(*(np.concatenate(column) for column in zip(*switched, strict=True)))

    @property
    def nbytes(self) -> int:
        """Bytes of all that is kept."""
        arrays = [*self.changes, *self.switched, *(part for point in self._checkpoints for part in point.state[1:])]
        return sum(part.nbytes for part in (*arrays, *self._kept, *self._recent.values()))

    def records(self) -> Iterator[StepRecord]:
        """Return the steps in order, some hundred at a time."""
        return (self._stretch(k).record for k in range(len(self._checkpoints)))

    def sample(self, times: float | Array) -> tuple[Array, Array]:
        """Return states (N, n) and link forces (N, links) at times within the motion, s, in any order.

        At a switch they are those after it. A time outside the motion raises ValueError.
        """
        instants = np.array(times, dtype=float, order="C", ndmin=1)
        slack = _SLACK * (self.end.time - self.begin)
        if not np.all((instants >= self.begin - slack) & (instants <= self.end.time + slack)):
            raise ValueError(f"times must lie within the motion, {self.begin:g} to {self.end.time:g} s")
        if np.all(instants[1:] >= instants[:-1]):
            return self._sample_in_order(instants)
        order = np.argsort(instants, kind="stable")
        states, forces = self._sample_in_order(instants[order])
        back = np.argsort(order, kind="stable")
        return states[back], forces[back]

    def impulses(self, begin: float, end: float) -> Array:
        """Return the time integral of each link force over the steps between two switches, N s."""
        total = np.zeros(self.links)
        for k in self._stretches_between(begin - _ROUNDING, end + _ROUNDING):
            stretch = self._stretch(k)
            time, step = stretch.record.time, stretch.record.step
            within = (time >= begin - _ROUNDING) & (time + step <= end + _ROUNDING)
            total += stretch.impulses()[within].sum(axis=0)
        return total

    def _follow(self, checkpoint: _Checkpoint) -> tuple[int, StepRecord, _Checkpoint]:
        """Follow a stretch from its begin; return why it ended, its steps, and the begin of the next one."""
        t, y, mode, memory = checkpoint.state.copy()
        record = _integrator.empty_record(_ROWS, y.size, mode.size, memory.size)
        status, t, h, steps, switched = _integrator.advance(
            self.system, self._control, t, checkpoint.step, y, mode, memory, record, self._switches
        )
        *columns, event_time, event = record
        filled = [column[:steps] for column in columns] + [event_time[:switched], event[:switched]]
        return status, StepRecord(*filled), _Checkpoint(MotionState(t, y, mode, memory), h)

    def _stretch(self, k: int) -> _Stretch:
        """Return a stretch: kept, or followed again."""
        if k < len(self._kept):
            return self._kept[k]
        if k not in self._recent:
            while len(self._recent) >= _RECENT:
                del self._recent[next(iter(self._recent))]
            self._recent[k] = _Stretch(self.system, self._follow(self._checkpoints[k])[1], self.links)
        return self._recent[k]

    def _stretches_between(self, begin: float, end: float) -> range:
        """Return the stretches that hold two times and what lies between."""

        def holds(time: float) -> int:
            return max(bisect.bisect_right(self._checkpoints, time, key=lambda point: point.state.time) - 1, 0)

        return range(holds(begin), holds(end) + 1)

    def _sample_in_order(self, instants: Array) -> tuple[Array, Array]:
        """Return states and link forces at times in order."""
        states, forces = np.empty((instants.size, self.end.y.size)), np.empty((instants.size, self.links))
        if not instants.size:
            return states, forces
        some = self._stretches_between(float(instants[0]), float(instants[-1]))
        begins = [self._checkpoints[k].state.time for k in some[1:]]
        edges = [0, *np.searchsorted(instants, begins), instants.size]
        for k, (first, last) in zip(some, itertools.pairwise(edges), strict=True):
            if first < last:
                part = slice(first, last)
                _integrator.sample(self.system, self._stretch(k).record, instants[part], states[part], forces[part])
        return states, forces


def integrate(
    system: Any,
    start: MotionState,
    control: Control,
    sizes: tuple[int, int],
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """Integrate a system from ``start`` to ``control.end`` or to a switch that stops it.

    ``sizes`` are the numbers of links and of switch functions; ``progress`` is called with the time reached, every
    some hundred steps.

    Raises
    ------
    ValueError
        If the end is not after the start, or not finite.
    IntegrationError
        If the step shrinks to nothing, the state is not finite, or there are too many steps.
    """
    if not start.time < control.end < math.inf:
        raise ValueError(f"the motion must end after {start.time:g} s, and end, got {control.end!r}")
    motion = Motion(system, start, control, sizes)
    motion.follow(progress)
    return motion
