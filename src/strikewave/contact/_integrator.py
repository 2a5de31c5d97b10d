"""Adaptive integration with located switches: DOP853, compiled, for any system of the protocol below.

A system is a NamedTuple of arrays. Its module teaches the five functions below to it with
``numba.extending.overload``; the compiler then picks them by the system's type:

- ``derivatives(system, t, y, mode, memory, dy)`` fills dy/dt,
- ``forces(system, t, y, mode, memory, out)`` fills the force of each link,
- ``switches(system, t, y, mode, memory, g)`` fills functions that are positive while the mode holds,
- ``horizon(system, t, y, mode, memory)`` returns the largest step worth trying, s: a step that would be rejected,
  because something that is not smooth lies ahead, is never made,
- ``switch(system, k, t, y, mode, memory)`` changes the mode when g[k] falls below zero and returns
  CONTINUE, RESTART (the motion is not smooth here: begin with a small step) or STOP.

``mode`` (integers) and ``memory`` (floats) hold what changes at switches only. A step never runs
across a switch: the switch is found on the dense output, and the step is taken anew up to it.
"""

import math
from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, inner_kernel, kernel, leaf_kernel
from strikewave.contact._dop853 import E3, E5, STAGES, A, B, C, D

CONTINUE, RESTART, STOP = 0, 1, 2
"""What a switch asks for: go on, begin with a small step, or stop."""
END, STOPPED, FULL, STUCK = 0, 1, 2, 3
"""Why `advance` came back: end reached, stopped by a switch, record full, or no step small enough."""

_SAMPLES = 4
"""Samples of the switch functions in a step. Each costs one evaluation of the dense output; a dip between two of them
is found from the parabola through three (`_dip`)."""
_DEEP_DIP = 0.25
"""A parabola whose lowest point is below this share of the least of its samples is looked at. Chosen: well above 0,
since the parabola only estimates the dip."""
_SAFETY = 0.9
"""Share of the step that the error estimate allows, as in the authors' code of DOP853 (Hairer, Norsett & Wanner 1993):
a step at the very limit would often be rejected."""
_SMALLEST, _LARGEST = 0.2, 6.0
"""Factors between which a step changes: one estimate far off must not carry the step too far. 6 is that of the authors'
code of DOP853, 0.2 that of their DOPRI5."""
_ORDER = 8.0
"""The error of a step grows with this power of the step: by it the next one is chosen."""
_IDLE_LIMIT = 100
"""Switches in a row without progress in time after which the motion is given up: as many links may switch at one
instant, but two that switch each other would do so forever."""
_EXTENDED = 16
"""Stages of a step with its dense output: 12 and the end of the step, and three more."""
_FEW_STATES = 4
"""States up to which a sum of stages runs over the stages inside: the longer loop shall be the inner one, and a step
has 12 stages, many of whose weights are zero."""
_ROOT_STEPS, _ROOT_ROUNDING = 200, 4e-16
"""Illinois steps for a switch, and the width of its bracket, as a share of the step, that ends them: two of the last
bits. Halving alone would take 52 steps, the rule takes far fewer; the cap only guards against functions with jumps."""
_NO_STEP, _NO_PROGRESS, _START = 4e-16, 2e-16, 1e-9
"""Steps over the time reached that are too small to try, and to count as progress: they are lost in the rounding of the
time. Near time 0 that of 1 ns counts, below which nothing here happens."""
_GAUSS_X, _GAUSS_W = (v / 2 for v in np.polynomial.legendre.leggauss(5))
"""Five points are exact up to degree 9: the dense output is of degree 7, and forces are nearly so."""


class Control(NamedTuple):
    """How to integrate: local error at most ``tolerance * scale`` where scale > 0; times in s."""

    tolerance: float
    scale: np.ndarray
    first_step: float
    largest_step: float
    end: float


class StepRecord(NamedTuple):
    """Accepted steps with their dense output, and the switches; one row a step or a switch."""

    time: np.ndarray
    step: np.ndarray
    dense: np.ndarray
    mode: np.ndarray
    memory: np.ndarray
    event_time: np.ndarray
    event: np.ndarray


def derivatives(system, t, y, mode, memory, dy):
    """Fill dy with the time derivative of the state (taught to each system's type)."""
    raise TypeError("compiled only")


def forces(system, t, y, mode, memory, out):
    """Fill out with the force of each link, N (taught to each system's type)."""
    raise TypeError("compiled only")


def switches(system, t, y, mode, memory, g):
    """Fill g with functions that are positive while the mode holds (taught to each system's type)."""
    raise TypeError("compiled only")


def horizon(system, t, y, mode, memory):
    """Return the largest step worth trying, s (taught to each system's type)."""
    raise TypeError("compiled only")


def switch(system, k, t, y, mode, memory):
    """Change the mode at switch k (taught to each system's type)."""
    raise TypeError("compiled only")


def empty_record(rows, states, modes, memories):
    """Return an unfilled record for so many steps."""
    return StepRecord(
        np.empty(rows),
        np.empty(rows),
        np.empty((rows, 8, states)),
        np.empty((rows, modes), dtype=np.int64),
        np.empty((rows, memories)),
        np.empty(rows),
        np.empty((rows, 2), dtype=np.int64),
    )


@leaf_kernel
def evaluate(dense, x, out):
    """Fill out with the dense output of one step at the fraction x of the step."""
    for i in range(out.size):
        value = dense[7, i] * x
        value = (value + dense[6, i]) * (1.0 - x)
        value = (value + dense[5, i]) * x
        value = (value + dense[4, i]) * (1.0 - x)
        value = (value + dense[3, i]) * x
        value = (value + dense[2, i]) * (1.0 - x)
        value = (value + dense[1, i]) * x
        out[i] = value + dense[0, i]


@leaf_kernel
def _weigh(weights, count, k, out):
    """Fill out with the weighted sum of the first stages; the inner loop is the longer one."""
    if out.size <= _FEW_STATES:
        for i in range(out.size):
            total = 0.0
            for j in range(count):
                total += weights[j] * k[j, i]
            out[i] = total
        return
    for i in range(out.size):
        out[i] = 0.0
    for j in range(count):
        w = weights[j]
        if w != 0.0:
            for i in range(out.size):
                out[i] += w * k[j, i]


@leaf_kernel
def _stage(system, s, t, h, y, mode, memory, work, k):
    _weigh(A[s], s, k, work)
    for i in range(y.size):
        work[i] = y[i] + h * work[i]
    derivatives(system, t + C[s] * h, work, mode, memory, k[s])


@inner_kernel
def _take_step(system, control, t, h, y, mode, memory, work, k, new):
    """Take one step into ``new`` and return its error over the tolerance."""
    for s in range(1, STAGES):
        _stage(system, s, t, h, y, mode, memory, work, k)
    _weigh(B, STAGES, k, new)
    for i in range(y.size):
        new[i] = y[i] + h * new[i]
    derivatives(system, t + h, new, mode, memory, k[STAGES])
    fifth, third, count = 0.0, 0.0, 0
    for i in range(y.size):
        if control.scale[i] <= 0.0:
            continue
        e5, e3 = 0.0, 0.0
        for j in range(STAGES + 1):
            e5 += E5[j] * k[j, i]
            e3 += E3[j] * k[j, i]
        allowed = control.tolerance * control.scale[i]
        fifth += (e5 / allowed) ** 2
        third += (e3 / allowed) ** 2
        count += 1
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return abs(h) * fifth / math.sqrt((fifth + 0.01 * third) * count)


@inner_kernel
def _fill_dense(system, t, h, y, new, mode, memory, work, k, dense):
    # counted by the arrays: loops of known length would be unrolled, which is four times the code
    for s in range(STAGES + 1, k.shape[0]):
        _stage(system, s, t, h, y, mode, memory, work, k)
    for i in range(y.size):
        delta = new[i] - y[i]
        dense[0, i] = y[i]
        dense[1, i] = delta
        dense[2, i] = h * k[0, i] - delta
        dense[3, i] = 2.0 * delta - h * (k[STAGES, i] + k[0, i])
    for r in range(dense.shape[0] - 4):
        _weigh(D[r], k.shape[0], k, dense[4 + r])
        for i in range(y.size):
            dense[4 + r, i] *= h


@inner_kernel
def _root(system, which, t, h, dense, mode, memory, low, high, work, g):
    """Return the fraction of the step at which switch ``which`` falls through zero (Illinois rule)."""
    evaluate(dense, low, work)
    switches(system, t + low * h, work, mode, memory, g)
    g_low = g[which]
    if g_low <= 0.0:
        return low
    evaluate(dense, high, work)
    switches(system, t + high * h, work, mode, memory, g)
    g_high = g[which]
    side = 0
    for _ in range(_ROOT_STEPS):
        x = (low * g_high - high * g_low) / (g_high - g_low)
        if not low < x < high:
            x = 0.5 * (low + high)
        if high - low < _ROOT_ROUNDING or x in (low, high):
            break
        evaluate(dense, x, work)
        switches(system, t + x * h, work, mode, memory, g)
        value = g[which]
        if value > 0.0:
            low, g_low = x, value
            if side == 1:
                g_high *= 0.5
            side = 1
        else:
            high, g_high = x, value
            if side == -1:
                g_low *= 0.5
            side = -1
    return high


@inner_kernel
def _dip(system, t, h, dense, mode, memory, j, earlier, previous, now, work, g):
    """Return a switch that falls below zero and rises again between three positive samples, and where.

    Whether and where to look follows from the lowest point of the parabola through the samples.
    """
    for which in range(now.size):
        a, b, c = earlier[which], previous[which], now[which]
        curvature = a - 2.0 * b + c
        if min(a, b, c) <= 0.0 or curvature <= 0.0:
            continue
        shift = 0.5 * (a - c) / curvature
        if abs(shift) >= 1.0 or b - 0.25 * (a - c) * shift > _DEEP_DIP * min(a, b, c):
            continue
        x = (j - 1 + shift) / _SAMPLES
        evaluate(dense, x, work)
        switches(system, t + x * h, work, mode, memory, g)
        if g[which] < 0.0:
            low = (j - 2) / _SAMPLES if shift < 0.0 else (j - 1) / _SAMPLES
            return which, _root(system, which, t, h, dense, mode, memory, low, x, work, g)
    return -1, 1.0


@inner_kernel
def _first_switch(system, t, h, dense, mode, memory, before, rows, work, g):
    """Return the first switch within the step and its fraction; -1 when there is none. ``rows`` is scratch."""
    first, at = -1, 1.0
    size = before.size
    earlier, previous, now = rows[0], rows[1], rows[2]
    for which in range(size):
        earlier[which] = previous[which] = before[which]
    for j in range(1, _SAMPLES + 1):
        x = j / _SAMPLES
        evaluate(dense, x, work)
        switches(system, t + x * h, work, mode, memory, now)
        for which in range(now.size):
            if now[which] < 0.0 and (previous[which] >= 0.0 or j == 1):
                root = _root(system, which, t, h, dense, mode, memory, (j - 1) / _SAMPLES, x, work, g)
                if first < 0 or root < at:
                    first, at = which, root
        if first < 0 and j > 1:
            first, at = _dip(system, t, h, dense, mode, memory, j, earlier, previous, now, work, g)
        if first >= 0:
            return first, at
        for which in range(size):
            earlier[which], previous[which] = previous[which], now[which]
    return first, at


@kernel
def advance(system, control, t, h, y, mode, memory, record, count):
    """Integrate to ``control.end``, to a stopping switch, or until the record is full.

    ``y``, ``mode`` and ``memory`` are moved on in place. ``count`` is the number of switch functions.
    Returns why it came back (END, STOPPED, FULL, STUCK), the time, the next step to try, and how many
    steps and switches were recorded.
    """
    n = y.size
    work, new = np.empty(n), np.empty(n)
    k = np.zeros((_EXTENDED, n))
    before, g, rows = np.empty(count), np.empty(count), np.empty((3, count))
    steps, events, idle = 0, 0, 0
    derivatives(system, t, y, mode, memory, k[0])
    while t < control.end:
        if steps == record.time.size or events == record.event_time.size:
            return FULL, t, h, steps, events
        h = min(h, control.largest_step, control.end - t, horizon(system, t, y, mode, memory))
        switches(system, t, y, mode, memory, before)
        error = 0.0
        while True:
            error = _take_step(system, control, t, h, y, mode, memory, work, k, new)
            if error <= 1.0:
                break
            h *= max(_SMALLEST, _SAFETY * error ** (-1.0 / _ORDER)) if error < math.inf else _SMALLEST
            if not h > _NO_STEP * max(abs(t), _START):
                return STUCK, t, h, steps, events
        dense = record.dense[steps]
        _fill_dense(system, t, h, y, new, mode, memory, work, k, dense)
        which, fraction = _first_switch(system, t, h, dense, mode, memory, before, rows, work, g)
        growth = _LARGEST if error == 0.0 else min(_LARGEST, _SAFETY * error ** (-1.0 / _ORDER))
        taken = h
        if which >= 0:
            taken = fraction * h
            if taken > _NO_PROGRESS * max(abs(t), _START):
                _take_step(system, control, t, taken, y, mode, memory, work, k, new)
                _fill_dense(system, t, taken, y, new, mode, memory, work, k, dense)
                idle = 0
            else:
                taken = 0.0
                idle += 1
                if idle > _IDLE_LIMIT:
                    return STUCK, t, h, steps, events
        if taken > 0.0:
            record.time[steps] = t
            record.step[steps] = taken
            for i in range(mode.size):
                record.mode[steps, i] = mode[i]
            for i in range(memory.size):
                record.memory[steps, i] = memory[i]
            steps += 1
            t += taken
            for i in range(n):
                y[i] = new[i]
                k[0, i] = k[STAGES, i]
        if which < 0:
            idle = 0
            h *= max(_SMALLEST, growth)
            continue
        record.event_time[events] = t
        record.event[events, 0] = which
        record.event[events, 1] = steps
        events += 1
        code = switch(system, which, t, y, mode, memory)
        derivatives(system, t, y, mode, memory, k[0])
        if code == STOP:
            return STOPPED, t, h, steps, events
        if code == RESTART:
            h = min(h, control.first_step)
    return END, t, h, steps, events


@called_kernel
def sample(system, record, times, states, out):
    """Fill ``states`` (N, n) and ``out`` (N, links) with the motion and link forces at sorted times."""
    row = 0
    last = record.time.size - 1
    for i in range(times.size):
        while row < last and times[i] >= record.time[row + 1]:
            row += 1
        x = min(max((times[i] - record.time[row]) / record.step[row], 0.0), 1.0)
        evaluate(record.dense[row], x, states[i])
        forces(system, record.time[row] + x * record.step[row], states[i], record.mode[row], record.memory[row], out[i])


@kernel
def impulses(system, record, out):
    """Fill ``out`` (steps, links) with the time integral of each link force over each step (5-point Gauss)."""
    state = np.empty(record.dense.shape[2])
    force = np.empty(out.shape[1])
    for row in range(record.time.size):
        for link in range(out.shape[1]):
            out[row, link] = 0.0
        for x, w in zip(_GAUSS_X, _GAUSS_W):  # noqa: B905  (numba's zip knows no strict)
            evaluate(record.dense[row], 0.5 + x, state)
            t = record.time[row] + (0.5 + x) * record.step[row]
            forces(system, t, state, record.mode[row], record.memory[row], force)
            for link in range(out.shape[1]):
                out[row, link] += w * record.step[row] * force[link]
