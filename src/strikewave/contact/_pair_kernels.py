"""Compiled impact of two free bodies under any law, as a system of the integrator in their relative motion.

State: indentation d and its rate d'. Memory: approach speed, depth to which the spot has yielded, growth of its radius.
The motion stops where the bodies part, or a damper has used up the force: nothing presses them together again.
Hysteresis takes the force away only within rounding, and the contact goes on.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.base.compiled import LEAF, called_kernel, kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import PUSHING, SLACK, SWITCHES, YIELDING, contact_force, contact_switches, is_a
from strikewave.contact._integrator import CONTINUE, STOP, STOPPED, Control, advance, evaluate
from strikewave.contact._law_kernels import (
    DAMPER,
    FORM,
    STIFFNESS,
    YIELD_LOAD,
    base_force,
    depth_at_yield,
    elastic_depth,
    flattening,
    residual,
    stored,
    unyielding,
    unyielding_force,
    yielding,
)

STATES, MEMORIES = 2, 3
"""Numbers of the state and of the memory, see above."""
FIRST_STEP = 1e-2
"""First step over the time that the largest elastic indentation takes at the approach speed. Chosen: with 0.001 or
0.1 restitution and duration are as exact (measured), since the step adapts at once."""
_DAMPER_START = 0.2
"""Share of that first step where there is a damper, whose force is not smooth at first touch (d^p, p below 1)."""
_TOWARDS_PARTING = 0.7
"""Share of the time until the bodies part, at their present rate, that a step may cover. The force is not smooth where
they part: a step across would be rejected. Chosen: from 0.5 to 0.9 neither time nor error of an impact
changes noticeably (measured)."""
_STUCK_TOGETHER = 1e-7
"""Share of the approach speed below which bodies do not part: what is left is the integrator's error, 1e-7 at the
default tolerance."""
_LONGEST = 1e9
"""Longest contact over the time that the largest elastic indentation takes at the approach speed: a damper just below
critical parts very late, and only what never parts shall run into this end."""
_PEAK_PARABOLAS, _PEAK_ROUNDING, _NARROWER = 5, 1e-12, 0.25
"""Parabolas about a force's peak, the relative gain that ends them, and how much narrower each is than the one before:
the error of a vertex falls with the third power of the width, so that five reach rounding."""
_TURN_STEPS, _TURN_BRACKET, _TURN_RATE = 60, 1e-14, 1e-13
"""Steps of the regula falsi for the turning point, and what ends them: the width of the bracket over the step, or the
rate over that of approach. The indentation is flat there: its error is the square of either."""
_HALVINGS = 60
"""Halvings of the bracket of a depth: they leave the last bits."""

(RESTITUTION, INDENTATION, FORCE, DURATION, PEAK_TIME, TURN_TIME, DEEPEST) = range(7)
"""Rows that `impacts` fills."""
ANSWERS = 7
"""Number of these rows."""
BEYOND_CLOSED_FORM = [FORM, DAMPER]
"""Places of a law that are zero where the closed form covers it, if nothing yields."""


class PairSystem(NamedTuple):
    """A contact law as a row of numbers, the reduced mass m1 m2/(m1 + m2), kg, and a time too short to matter, s."""

    law: np.ndarray
    mass: float
    instant: float


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        force, _ = contact_force(system.law, y[0], y[1], mode[0], memory[0], memory[1], memory[2])
        dy[0] = y[1]
        dy[1] = -force / system.mass

    return rates if is_a(system, PairSystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        # the force is not smooth where the bodies part: steps towards it shrink anyway
        if y[1] >= 0.0 or system.law[DAMPER] > 0.0:
            return np.inf
        until_parting = (y[0] - residual(memory[1], memory[2])) / -y[1]
        return max(_TOWARDS_PARTING * until_parting, system.instant)

    return most if is_a(system, PairSystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        out[0] = contact_force(system.law, y[0], y[1], mode[0], memory[0], memory[1], memory[2])[0]

    return fill if is_a(system, PairSystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        g[0], g[1], g[2] = 1.0, 1.0, 1.0
        contact_switches(system.law, y[0], y[1], mode[0], memory[0], memory[1], memory[2], g)

    return fill if is_a(system, PairSystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        if k == 0 or (k == 1 and system.law[DAMPER] > 0.0):  # nothing presses free bodies together again
            return STOP
        if k == 1:
            mode[0] = SLACK if mode[0] == PUSHING else PUSHING
            return CONTINUE
        if mode[0] == PUSHING:
            mode[0] = YIELDING
        else:
            mode[0], memory[1], memory[2] = PUSHING, y[0], flattening(system.law, y[0])
        return CONTINUE

    return change if is_a(system, PairSystem) else None


@kernel
def depths_at_yield(laws, out):
    """Fill the depth from which each law yields at first, m; 0 where it does not."""
    for i in range(out.size):
        out[i] = depth_at_yield(laws[i])


@kernel
def energies(laws, d, deepest, out):
    """Fill the energy that each contact stores, J."""
    for i in range(out.size):
        out[i] = stored(laws[i], d[i], deepest[i])


@kernel
def elastic_depths(laws, energy, out):
    """Fill the indentation at which the elastic base of each law holds an energy, m."""
    for i in range(out.size):
        out[i] = elastic_depth(laws[i], energy[i])


@kernel
def cushion_depths_under(laws, force, out):
    """Fill the depth at which the elastic base of each cushion bears a force, m, or goes straight on; by halving."""
    for i in range(out.size):
        low, high = 0.0, force[i] / laws[i, STIFFNESS]
        while base_force(laws[i], high) < force[i]:
            high *= 2.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if base_force(laws[i], middle) < force[i]:
                low = middle
            else:
                high = middle
        out[i] = 0.5 * (low + high)


@called_kernel
def _force_within(system, record, row, x, y):
    evaluate(record.dense[row], x, y)
    memory = record.memory[row]
    return contact_force(system.law, y[0], y[1], record.mode[row, 0], memory[0], memory[1], memory[2])[0]


@called_kernel
def _top_of_step(system, record, row, y):
    """Return the largest force within a step and where: of its ends, and of the vertex of ever narrower parabolas."""
    reach, middle = 0.5, 0.5
    low = _force_within(system, record, row, 0.0, y)
    here = _force_within(system, record, row, 0.5, y)
    high = _force_within(system, record, row, 1.0, y)
    best, at = (low, 0.0) if low > high else (high, 1.0)  # a force that only rises or falls is largest at an end
    for _ in range(_PEAK_PARABOLAS):
        bend = low - 2.0 * here + high
        if not bend < 0.0:
            break
        vertex = min(max(middle + 0.5 * reach * (low - high) / bend, 0.0), 1.0)
        force = _force_within(system, record, row, vertex, y)
        gained = force - best
        if gained > 0.0:
            best, at = force, vertex
        # a vertex beyond an end of the step gains nothing, but the peak may still lie just within
        if 0.0 < vertex < 1.0 and abs(gained) <= _PEAK_ROUNDING * best:
            break
        reach *= _NARROWER
        middle = min(max(vertex, reach), 1.0 - reach)
        low = _force_within(system, record, row, middle - reach, y)
        here = _force_within(system, record, row, middle, y)
        high = _force_within(system, record, row, middle + reach, y)
    return best, at


@called_kernel
def _largest_force(system, record, steps, y):
    """Return the largest force of a motion and its time: about the step that begins with the largest."""
    top, most = 0, -1.0
    for row in range(steps):
        force = _force_within(system, record, row, 0.0, y)
        if force > most:
            most, top = force, row
    best, when = -1.0, 0.0
    for row in range(max(top - 1, 0), min(top + 2, steps)):  # the peak lies before or after the largest begin
        force, at = _top_of_step(system, record, row, y)
        if force > best:
            best, when = force, record.time[row] + at * record.step[row]
    return best, when


@called_kernel
def _turning(record, steps, y):
    """Return the largest indentation of a motion and its time: where the rate is zero (regula falsi)."""
    for k in range(steps):
        evaluate(record.dense[k], 1.0, y)
        if y[1] > 0.0 and k < steps - 1:  # still going in at the end of the step
            continue
        low, high, v_high = 0.0, 1.0, y[1]
        evaluate(record.dense[k], 0.0, y)
        v_low, x, side = y[1], 0.0, 0
        for _ in range(_TURN_STEPS):
            if not v_low > 0.0 >= v_high:
                break
            x = (low * v_high - high * v_low) / (v_high - v_low)
            evaluate(record.dense[k], x, y)
            if high - low < _TURN_BRACKET or y[1] == 0.0:
                break
            if y[1] > 0.0:
                low, v_low = x, y[1]
                v_high *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                high, v_high = x, y[1]
                v_low *= 0.5 if side == -1 else 1.0
                side = -1
            if abs(y[1]) < _TURN_RATE * abs(record.dense[0, 1, 0] / record.step[0]):
                break
        return y[0], record.time[k] + x * record.step[k]
    return 0.0, 0.0


@called_kernel
def begin(law, speed, deepest, y, mode, memory):
    """Set a motion to first touch at an approach speed, on a spot that has yielded to a depth."""
    memory[0], memory[1] = speed, max(deepest, depth_at_yield(law))
    memory[2] = flattening(law, memory[1])
    y[0], y[1] = residual(memory[1], memory[2]), speed
    mode[0] = PUSHING


@kernel
def impacts(laws, mass, speed, deepest, tolerance, record, out):
    """Fill ``out`` (ANSWERS, N) with what comes of N impacts, each followed by the integrator; NaN where it cannot.

    ``record`` takes the steps of one impact.
    """
    y, mode, memory, scale = np.empty(STATES), np.empty(1, dtype=np.int64), np.empty(MEMORIES), np.empty(STATES)
    for i in range(mass.size):
        begin(laws[i], speed[i], deepest[i], y, mode, memory)
        depth = elastic_depth(laws[i], 0.5 * mass[i] * speed[i] ** 2)
        scale[0], scale[1] = depth, speed[i]
        period = depth / speed[i]
        first = FIRST_STEP if laws[i, DAMPER] == 0.0 else _DAMPER_START * FIRST_STEP
        system = PairSystem(laws[i], mass[i], FIRST_STEP * period)
        # no longest step: `horizon` keeps it from the parting
        control = Control(tolerance, scale, first * period, _LONGEST * period, _LONGEST * period)
        why, t, _, steps, _ = advance(system, control, 0.0, control.first_step, y, mode, memory, record, SWITCHES)
        out[:, i] = np.nan  # an impact that cannot be followed, or whose bodies do not part
        if why != STOPPED or -y[1] < _STUCK_TOGETHER * speed[i]:
            continue
        out[RESTITUTION, i], out[DURATION, i] = -y[1] / speed[i], t
        out[DEEPEST, i] = memory[1] if memory[1] > depth_at_yield(laws[i]) else 0.0
        out[INDENTATION, i], out[TURN_TIME, i] = _turning(record, steps, y)
        out[FORCE, i], out[PEAK_TIME, i] = _largest_force(system, record, steps, y)


@kernel
def spots(laws, deepest, left, flat):
    """Fill residual indentation (m) and flattening of spots that have yielded to a depth."""
    for i in range(deepest.size):
        flat[i] = flattening(laws[i], deepest[i])
        left[i] = residual(deepest[i], flat[i])


@kernel
def slopes_back(laws, d, deepest, out):
    """Fill dF/dd of contacts that are let go, N/m."""
    for i in range(out.size):
        out[i] = unyielding(laws[i], d[i], deepest[i], flattening(laws[i], deepest[i]))[1]


@kernel
def slow_forces(laws, d, deepest, out):
    """Fill the forces of contacts at rest, N: yielding where they are pressed deeper than ever before."""
    for i in range(out.size):
        before = max(deepest[i], depth_at_yield(laws[i]))
        if d[i] > before and laws[i, YIELD_LOAD] < np.inf:
            out[i] = yielding(laws[i], d[i])[0]
        else:
            out[i] = unyielding_force(laws[i], d[i], before, flattening(laws[i], before))
