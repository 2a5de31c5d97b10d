"""The stack on a grid of time steps: which step, what it costs in accuracy, and the tables for the kernels.

Delay lines are exact when every transit time is a whole number of steps. Other transits are rounded:
`choose_grid` finds a step for which all of them are nearly whole at once, and `error_bound` bounds the effect of the
rounding on the result.

Accelerations are averages over all steps, in which a jump of velocity keeps its size: a difference at one fine step
grows without bound as the step gets shorter, and between kept steps it is seen or not by chance. The average of the
acceleration with the hat function of a kept step,

    a_i = integral a(t) max(0, 1 - |t - t_i|/h) dt / h = (V_{i+1/2} - V_{i-1/2})/h,

with h the kept step (s) and V the mean velocity from one kept step to the next (m/s), has the same integral as a(t) and
the same first moment: a jump keeps its size and its time. It is a(t) sampled behind a low-pass of sinc(f h)^2; where
every step is kept, it is the central difference.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.shock_quantities import EXACT_LENGTH, RATIO, STEP
from strikewave.contact._law_kernels import COLUMNS, depth_at_yield
from strikewave.contact.law import indentation_under, striking_law
from strikewave.waves import _kernels as kernels
from strikewave.waves.layers import Joint, Stack

Array = NDArray[np.float64]

MOST_NODES = 50_000_000  # its waves take 0.8 GB
"""Most nodes of a grid."""
MOST_EVENTS = 10_000  # nobody reads more of a chatter, and the run goes on
"""Most openings and closings of joints that are kept."""
# Some 16 MB a table, and 16 to 4096 steps of it, so that neither the loop nor a search that ends early costs much.
MOST_TRIED, FEWEST_AT_ONCE, MOST_AT_ONCE = 2_000_000, 16, 4096
"""Transits over steps that are compared at once."""
MOST_FIELD_LAYERS = 1000
"""Most layers of an x-t field; of more some are left out, since each takes two places at least."""
FIELD_PLACES, FIELD_ROWS = 200, 500  # as many as a picture of some hundred pixels shows
"""Places and instants of an x-t field."""


@dataclass(frozen=True)
class TimeGrid:
    """A time step and the number of steps that each layer's transit takes."""

    step: float
    """s."""
    counts: tuple[int, ...]
    """Steps of each transit, at least 1; 0 where a layer is not cut into steps."""
    mismatch: float
    """Largest relative difference between a transit used and the true one."""

    def lengths(self, stack: Stack) -> tuple[float, ...]:
        """Return the lengths that the layers have on this grid, m."""
        pairs = zip(self.counts, stack.layers, strict=True)
        return tuple(n * self.step * x.bar_speed if n else x.length for n, x in pairs)


def grid_of(stack: Stack, step: float) -> TimeGrid:
    """Return the grid of a stack for a given step, s: each transit rounded to whole steps, one at least."""
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step must be above zero, got {step!r} s")
    transits = np.array([layer.transit for layer in stack.layers])
    if transits.sum() / step > MOST_NODES:
        raise ValueError(
            f"a step of {step:.3g} s cuts the stack into {transits.sum() / step:.3g} nodes; "
            f"at most {MOST_NODES:.0e}: take a step above {transits.sum() / MOST_NODES:.3g} s"
        )
    counts = np.maximum(np.rint(transits / step), 1.0)
    return TimeGrid(step, tuple(int(n) for n in counts), float(np.max(np.abs(counts * step / transits - 1.0))))


def choose_grid(stack: Stack, mismatch: float, largest: float, smallest: float) -> TimeGrid:
    """Return the coarsest grid whose transits all are whole steps to a wanted relative mismatch.

    Steps t_k/n of the shortest transit, n = 1, 2, .., are tried between ``largest`` and ``smallest``, s: a
    simultaneous rational approximation by search. Each is shifted so that the mismatch is shared evenly
    among the layers. Where none is good enough, the best one is returned; where the shortest transit is below
    ``smallest``, that step, in which thinner layers take one step.
    """
    transits = np.array([layer.transit for layer in stack.layers])
    smallest = max(smallest, transits.sum() / MOST_NODES)
    shortest = float(transits.min())
    if shortest < smallest:
        return grid_of(stack, smallest)
    first = max(1, math.ceil(shortest / largest))
    last = max(first, math.floor(shortest / smallest))
    best: TimeGrid | None = None
    several = max(FEWEST_AT_ONCE, min(MOST_AT_ONCE, MOST_TRIED // len(transits)))
    for begin in range(first, last + 1, several):
        n = np.arange(begin, min(begin + several, last + 1), dtype=float)
        steps = shortest / n
        counts = np.maximum(np.rint(transits[:, None] / steps), 1.0)
        ratios = counts * steps / transits[:, None]
        high, low = ratios.max(axis=0), ratios.min(axis=0)
        shared = 2.0 / (high + low)
        worst = high * shared - 1.0
        good = np.flatnonzero(worst <= mismatch)
        k = int(good[0]) if good.size else int(np.argmin(worst))
        if best is None or worst[k] < best.mismatch:
            best = TimeGrid(float(steps[k] * shared[k]), tuple(int(c) for c in counts[:, k]), float(worst[k]))
        if good.size:
            return best
    assert best is not None
    return best


def tables_of(stack: Stack, grid: TimeGrid) -> kernels.Tables:
    """Return the stack on a grid as the kernels take it; refuse a joint with more branches than they hold."""
    dt = grid.step
    nodes = np.array(grid.counts, dtype=np.int64) + 1
    impedance = np.array([layer.impedance for layer in stack.layers])
    joints = max(len(stack.joints), 1)
    kind = np.zeros(len(stack.joints), dtype=np.int64)
    value, branch = np.zeros((joints, kernels.JOINT_VALUES)), np.zeros((joints, kernels.MOST_BRANCHES, 2))
    law = np.zeros((joints, COLUMNS))
    for i, joint in enumerate(stack.joints):
        kind[i] = _fill_joint(joint, dt, value[i], branch[i])
        if joint.contact is not None:
            law[i] = striking_law(joint.contact)
    start = np.concatenate([[0], np.cumsum(nodes)[:-1]])
    return kernels.Tables(dt, impedance, nodes, start, kind, value, branch, law, _end_coefficients(stack, dt))


def _fill_joint(joint: Joint, dt: float, value: Array, branch: Array) -> int:
    """Fill the values and branches of a joint and return its kind."""
    value[kernels.STIFFNESS], value[kernels.DAMPING], value[kernels.PRELOAD] = (
        joint.stiffness,
        joint.damping,
        joint.preload,
    )
    if joint.contact is not None:
        value[kernels.DATUM] = indentation_under(joint.contact, joint.preload)
        return kernels.CONTACT
    if joint.mass > 0.0:
        value[kernels.RESISTANCE] = 2.0 * joint.mass / dt
        return kernels.MASS
    if joint.attached > 0.0:
        value[kernels.RESISTANCE], value[kernels.INERTIA] = 0.5 * dt * joint.stiffness, 2.0 * joint.attached / dt
        return kernels.OSCILLATOR
    if joint.unilateral:
        return kernels.UNILATERAL
    if math.isinf(joint.stiffness):
        return kernels.BONDED
    springs = [(0.5 * dt * joint.stiffness, 0.0)]
    springs += [(0.5 * dt * part.stiffness, 0.5 * dt / part.relaxation) for part in joint.branches]
    if len(springs) > kernels.MOST_BRANCHES:
        raise ValueError(f"a joint has at most {kernels.MOST_BRANCHES - 1} Maxwell branches, got {len(joint.branches)}")
    for k, (r, h) in enumerate(springs):
        branch[k] = r / (1.0 + h), (1.0 - h) / (1.0 + h)
    value[kernels.BRANCHES] = len(springs)
    value[kernels.RESISTANCE] = joint.damping + branch[:, 0].sum()
    return kernels.ELASTIC


def _end_coefficients(stack: Stack, dt: float) -> Array:
    """Return f = own a + wave P and a' = beta f + sigma R v of the end; spring, dashpot, mass of one that swings."""
    z, end = stack.layers[-1].impedance, stack.end
    if end.kind == "rigid":
        return np.array([0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    if end.kind == "oscillator":
        return np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.5 * dt * end.stiffness, end.damping, 2.0 * end.value / dt])
    resistance, beta, sigma = {
        "free": (0.0, 0.0, 0.0),
        "matched": (z, 0.0, 0.0),
        "dashpot": (end.value, 0.0, 0.0),
        "spring": (0.5 * dt * end.value, 1.0, 1.0),
        "mass": (2.0 * end.value / dt, -1.0, -1.0),
    }[end.kind]
    share = 1.0 / (1.0 + resistance / z)
    return np.array([share, 2.0 * resistance / z * share, resistance, beta, sigma, 0.0, 0.0, 0.0])


def state_at_rest(stack: Stack, grid: TimeGrid) -> kernels.WaveState:
    """Return the state before the load: no force anywhere, each layer at its own speed, gaps open.

    A mass between two layers moves with the second one, a mass at the end with the last.
    """
    nodes = np.array(grid.counts, dtype=np.int64) + 1
    z = np.repeat([layer.impedance for layer in stack.layers], nodes)
    v = np.repeat([layer.speed for layer in stack.layers], nodes)
    joints = max(len(stack.joints), 1)
    state = kernels.WaveState(
        0.5 * z * v,
        -0.5 * z * v,
        np.full(nodes.size, -1, dtype=np.int64) % nodes,
        np.zeros((joints, kernels.JOINT_STATES)),
        np.zeros((joints, kernels.MOST_BRANCHES)),
        np.zeros(2),
        np.array([-1, 0]),
        np.zeros((MOST_EVENTS, 3)),
    )
    for i, joint in enumerate(stack.joints):
        state.joint[i, 0] = -joint.gap
        if joint.mass > 0.0 or joint.attached > 0.0:
            inertia = 2.0 * (joint.mass or joint.attached) / grid.step * stack.layers[i + 1].speed
            state.joint[i, 0 if joint.mass > 0.0 else 1] = inertia
        state.joint[i, kernels.OPEN] = float(joint.gap > kernels.SEEN)
        if joint.contact is not None:
            deepest = max(depth_at_yield(striking_law(joint.contact)), indentation_under(joint.contact, joint.preload))
            state.joint[i, kernels.DEEPEST], state.joint[i, kernels.GROWTH] = deepest, 1.0
    if stack.end.kind in ("mass", "oscillator"):
        inertia = 2.0 * stack.end.value / grid.step * stack.layers[-1].speed
        state.end[:] = (-inertia, 0.0) if stack.end.kind == "mass" else (0.0, inertia)
    return state


def nearest_nodes(grid: TimeGrid, places: Sequence[tuple[int, float]]) -> NDArray[np.int64]:
    """Return (layer, node) for places given as layer index and fraction of the layer from its loaded side."""
    rows = [(layer, round(fraction * grid.counts[layer])) for layer, fraction in places]
    return np.array(rows, dtype=np.int64).reshape(-1, 2)


def field_nodes(
    stack: Stack, grid: TimeGrid, most_layers: int = MOST_FIELD_LAYERS, number: int = FIELD_PLACES
) -> tuple[NDArray[np.int64], Array]:
    """Return about so many (layer, node), evenly in time of travel, and their places from the first face, m.

    Each layer has two at least; of more layers than the most only some are looked at.
    """
    rows, places, begin, every = [], [], 0.0, math.ceil(len(stack.layers) / most_layers)
    for i, (layer, count) in enumerate(zip(stack.layers, grid.counts, strict=True)):
        if i % every and i != len(stack.layers) - 1:
            begin += layer.length
            continue
        here = max(2, round(number * layer.transit / stack.transit))
        nodes = np.unique(np.linspace(0, count, here).round().astype(np.int64))
        rows.append(np.column_stack([np.full(nodes.size, i), nodes]))
        places.append(begin + layer.length * nodes / count)
        begin += layer.length
    return np.concatenate(rows), np.concatenate(places)


@dataclass(frozen=True)
class ErrorBound:
    """Largest error that rounding the transits can cause at the taps, until the end of the run.

    Springs, masses and gaskets follow the trapezoidal rule, whose own error (second order in the step over
    their relaxation time) comes on top; bonded joints and the simple ends have none.
    """

    velocity: float
    """m/s; infinite where the theorem does not hold."""
    acceleration: float
    """m/s^2."""


def error_bound(stack: Stack, grid: TimeGrid, integrals: Array, places: Sequence[tuple[int, float]]) -> ErrorBound:
    """Return the bound of the error of velocity and acceleration at places of a stack on a grid.

    ``integrals`` are I1, I2, I3 and the largest norms |w'|, |w''|, |w'''|, as `run_bar` gathers them.

    On the grid each wave runs with a transit wrong by at most the relative mismatch d. The error e of
    the waves then obeys the exact equations with a source -d times the rate of the computed waves w.
    Bonded, compliant and lossy joints and all ends never add energy, so in the energy norm (squared: the
    integral of (P^2 + M^2)/Z over the stack)

        |e| <= d I1,   |e'| <= d I2,   |e''| <= d I3,   I_k = integral over the run of |k-th rate of w|.

    In a layer of impedance Z and transit t, Sobolev's inequality turns norms into values:
    v^2 <= (2/Z) [|e|^2/t + 2 |e| (|e'| + d |w'|)]; likewise for the acceleration with one more rate. A tap
    between nodes is read half a step away at most. The load counts as sampled at the steps: a corner in it
    is rounded over one step, and a jump makes the bound large, as it must.
    """
    if any(joint.unilateral for joint in stack.joints) or any(layer.speed for layer in stack.layers):
        return ErrorBound(math.inf, math.inf)
    d = grid.mismatch
    e0, e1, e2 = d * integrals[:3]
    w1, w2, w3 = integrals[3:]
    velocity = acceleration = 0.0
    for layer, fraction in places:
        z, transit = stack.layers[layer].impedance, stack.layers[layer].transit
        away = abs(fraction * grid.counts[layer] - round(fraction * grid.counts[layer])) * grid.step
        here = math.sqrt(2.0 / z * (e0**2 / transit + 2.0 * e0 * (e1 + d * w1)))
        rate = math.sqrt(2.0 / z * (e1**2 / transit + 2.0 * e1 * (e2 + d * w2)))
        slope = math.sqrt(2.0 / z * (w1**2 / transit + 2.0 * w1 * w2)) if away else 0.0
        bend = math.sqrt(2.0 / z * (w2**2 / transit + 2.0 * w2 * w3)) if away else 0.0
        velocity = max(velocity, here + away * slope)
        acceleration = max(acceleration, rate + away * bend)
    return ErrorBound(velocity, acceleration)


def empty_averages(taps: NDArray[np.int64], faces: NDArray[np.int64], every: int, rows: int) -> kernels.Averages:
    """Return averages about rows of kept steps before anything ran."""
    return kernels.Averages(taps, faces, every, np.zeros((rows, len(taps))), np.zeros((rows, len(faces))))


def mean_acceleration(mean_velocity: Array, before: Array, step: float) -> Array:
    """Return the average acceleration about each kept step of ``step``, s, m/s^2, shape (N, taps).

    Mean velocities go from each kept step to the next, m/s; ``before`` is the velocity before the first one. The first
    acceleration holds the jump with which a load begins: its integral counts from one kept step before.
    """
    return np.asarray(np.diff(np.vstack([before, mean_velocity]), axis=0) / step)


def from_within(average: Array, value: Array, every: int) -> Array:
    """Return the average of a force about the first or the last kept step, over the part of its hat within the run.

    ``average`` is the one that counts zero outside, N; ``value`` the force at that step. Then the trapezoidal rule over
    the kept steps gives the impulse of all steps.
    """
    return 2.0 * average - value / every


@declare.dataclass
class LayerUsed:
    """A layer as asked for and as the time step made it."""

    name: str = declare.word("what the layer is called", label="layer", column=KEY, tables="lengths stress")
    length_asked: float = declare.number(
        EXACT_LENGTH, "its length in the case", label="asked", column=MAIN, tables="lengths"
    )
    length_used: float = declare.number(
        EXACT_LENGTH, "its length by whole steps", label="used", column=MAIN, tables="lengths"
    )
    steps: int = declare.count("steps of its transit", column=MAIN, tables="lengths")


@declare.dataclass
class WaveSetup:
    """Step and layers with which the waves of a stack were followed."""

    step: float = declare.number(STEP, "time step of the waves")
    mismatch: float = declare.number(RATIO, "largest relative error of a transit time by whole steps")
    layers: tuple[LayerUsed, ...] = declare.rows(LayerUsed, "the layers as the time step makes them")


def wave_setup(stack: Stack, grid: TimeGrid) -> WaveSetup:
    """Return the setup of a stack on a grid."""
    rows = zip(stack.layers, grid.lengths(stack), grid.counts, strict=True)
    return WaveSetup(
        grid.step, grid.mismatch, tuple(LayerUsed(layer.name, layer.length, used, n) for layer, used, n in rows)
    )
