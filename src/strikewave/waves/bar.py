"""A bar alone: a stack under a load, followed to the wanted error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._law_kernels import SLOWEST, STIFFNESS
from strikewave.contact.law import Contact, check_end, indentation_under, striking_law
from strikewave.waves import _impact_kernels, _kernels
from strikewave.waves._kernels import Extremes, Recording
from strikewave.waves.layers import Stack
from strikewave.waves.load import Impactor, Load
from strikewave.waves.transit import (
    ErrorBound,
    Grid,
    choose_grid,
    error_bound,
    field_nodes,
    grid_of,
    nearest_nodes,
    state_at_rest,
    tables_of,
)

Array = NDArray[np.float64]

MOST_LAYER_STEPS = 1e7
"""Layer steps of one try that the choice of a step may cost: about half a second."""
MOST_SAMPLES, MOST_ROWS = 20_000, 2e6
"""Samples of a tap that are kept when the step is chosen for the user, and with fast changes over long times."""
WORST_MISMATCH = 0.5
"""A step that changes a transit by more is refused."""
_TRIES = 4
RELAXATION_STEPS = 20.0
"""Relaxation times of a joint or an end that 50 steps may cover: one takes 2.5 steps at least."""
_FIELD_ROWS = 500
_MOST_TOUCHES = 1000


@dataclass(frozen=True)
class Tap:
    """Where a stack is watched: layer index and fraction of the layer from its loaded side."""

    layer: int
    position: float


@dataclass(frozen=True)
class Wanted:
    """How exact a run shall be: largest error over the largest value at the taps; or a step, s, that is kept."""

    velocity: float = 1e-3
    acceleration: float = 1e-2
    step: float | None = None


@dataclass(frozen=True)
class BarRun:
    """What a stack did under its load.

    Attributes
    ----------
    stack, load, grid : Stack, Load, Grid
        What ran.
    time : ndarray
        Times of the samples, s, shape (N,).
    face_force, end_force : ndarray
        Force on the first face and of the stack on its end, N, shape (N,).
    force, velocity, acceleration : ndarray
        At the taps, shape (N, taps). The acceleration is the central difference of the velocity over two
        steps of the grid.
    bound : ErrorBound
        Largest error: from rounding the transits, and what half the step changes where springs or masses take
        part; infinite where joints open or a striker comes.
    places, duration : tuple and float
        Layer and fraction of each tap; s.
    field_time, field_position, field_force, field_velocity : ndarray
        The x-t field: s, m from the first face, N and m/s with shape (times, places).
    field_layer : ndarray
        Index of the layer of each place.
    field_least, field_greatest : ndarray
        Least and greatest force at the places of the field over all steps, N.
    touches : ndarray
        Contacts with an impactor: begin, end, approach speed; shape (n, 3).
    impulse, end_impulse : float
        Of the load, and of the stack on its end, N s.
    momentum : float
        Gained by the stack, N s.
    energy_lost : float
        In the contact with an impactor, J.
    """

    stack: Stack
    load: Load
    grid: Grid
    time: Array = field(repr=False)
    face_force: Array = field(repr=False)
    end_force: Array = field(repr=False)
    force: Array = field(repr=False)
    velocity: Array = field(repr=False)
    acceleration: Array = field(repr=False)
    bound: ErrorBound
    places: tuple[tuple[int, float], ...]
    duration: float
    field_time: Array = field(repr=False)
    field_position: Array = field(repr=False)
    field_force: Array = field(repr=False)
    field_velocity: Array = field(repr=False)
    field_layer: NDArray[np.int64] = field(repr=False)
    field_least: Array = field(repr=False)
    field_greatest: Array = field(repr=False)
    touches: Array = field(repr=False)
    impulse: float
    end_impulse: float
    momentum: float
    energy_lost: float

    @property
    def momentum_error(self) -> float:
        """Impulses less momentum, over the impulse of the load or the momentum that the layers came with."""
        moving = sum(abs(layer.mass * layer.speed) for layer in self.stack.layers)
        flowed = max(abs(self.impulse), abs(self.end_impulse), moving, 1e-300)
        return abs(self.impulse - self.end_impulse - self.momentum) / flowed

    @property
    def relative_bound(self) -> tuple[float, float]:
        """Bounds of velocity and acceleration over their largest values at the taps."""
        largest = (float(np.abs(self.velocity).max(initial=0.0)), float(np.abs(self.acceleration).max(initial=0.0)))
        return (
            self.bound.velocity / largest[0] if largest[0] > 0.0 else math.inf,
            self.bound.acceleration / largest[1] if largest[1] > 0.0 else math.inf,
        )


def run_bar(stack: Stack, load: Load, taps: Sequence[Tap], duration: float, wanted: Wanted | None = None) -> BarRun:
    """Follow a stack under its load from rest.

    The step is the one asked for, or it is refined until the error bound keeps what is wanted, as far as
    `MOST_LAYER_STEPS` allow; the bound of the last try is reported in any case.

    Parameters
    ----------
    stack : Stack
        What is loaded at its first face.
    load : Pulse, Sampled or Impactor
        By what; time 0 is its beginning.
    taps : sequence of Tap
        Where it is watched, at least one.
    duration : float
        s.
    wanted : Wanted, optional
        Errors, or a step.

    Raises
    ------
    ValueError
        If there is no tap, one lies outside, or the duration or the step cannot be used.

    Examples
    --------
    >>> from strikewave.waves import Layer, Pulse
    >>> bar = Layer("bar", 7820.0, 211e9, 7.0686e-4, 0.07)
    >>> run = run_bar(Stack((bar,)), Pulse("rectangle", 19685.0, 1e-3), [Tap(0, 1.0)], 100e-6)
    >>> round(float(run.velocity[np.searchsorted(run.time, 20e-6), 0]), 3)
    1.371
    """
    wanted = wanted or Wanted()
    if not taps:
        raise ValueError("a run needs at least one tap")
    for tap in taps:
        if not (0 <= tap.layer < len(stack.layers) and 0.0 <= tap.position <= 1.0):
            raise ValueError(f"{tap} lies outside the stack of {len(stack.layers)} layers")
    if not 0.0 < duration < math.inf:
        raise ValueError(f"the duration must be above zero, got {duration!r} s")
    places, shortest = [(tap.layer, tap.position) for tap in taps], min(_shortest_time(stack, load), duration)
    if wanted.step is not None:
        grid = grid_of(stack, wanted.step)
        if grid.mismatch > WORST_MISMATCH:
            raise ValueError(
                f"a step of {wanted.step:g} s changes a transit by {grid.mismatch:.0%}: take one below "
                f"{0.5 * min(layer.transit for layer in stack.layers):.3g} s"
            )
        if duration / grid.step > MOST_ROWS:
            raise ValueError(
                f"a step of {wanted.step:g} s over {duration:g} s makes {duration / grid.step:.1e} samples; at most "
                f"{MOST_ROWS:.0e}: take a step above {duration / MOST_ROWS:.3g} s"
            )
        return _with_lumped_error(_run(stack, load, places, duration, grid, _Kept(1, shortest)), _Kept(1, shortest))
    smallest = duration * len(stack.layers) / MOST_LAYER_STEPS
    largest = max(shortest / 50.0, smallest)
    mismatch, before = 1e-4, math.inf
    for _ in range(_TRIES):
        grid = choose_grid(stack, mismatch, largest, smallest)
        kept = _Kept(_sampling(duration, grid.step, shortest), shortest)
        run = _run(stack, load, places, duration, grid, kept)
        over, over_rate = (
            bound / most for bound, most in zip(run.relative_bound, (wanted.velocity, wanted.acceleration), strict=True)
        )
        # behind a corner of the load the acceleration jumps: no step then bounds its error
        hopeless = over_rate > 0.5 * before
        missed = over if hopeless else max(over, over_rate)
        if missed <= 1.0 or not math.isfinite(missed) or grid.mismatch > mismatch:
            break
        if grid.mismatch < 1e-12:  # what is left is the way from the tap to the nearest node
            largest = max(grid.step / (2.0 * missed), smallest)
        else:
            mismatch = grid.mismatch / (2.0 * missed)
        before = over_rate
    return _with_lumped_error(run, kept)


@dataclass(frozen=True)
class _Kept:
    """What is kept of a run: every so many steps; the shortest time to be resolved, s."""

    every: int
    shortest: float


def _sampling(duration: float, step: float, shortest: float) -> int:
    """Return of how many steps one is kept: about `MOST_SAMPLES` in all, but 50 of them in the shortest time.

    Raises
    ------
    ValueError
        If that would be too many.
    """
    every = max(1, min(math.ceil(duration / step / MOST_SAMPLES), int(shortest / 50.0 / step)))
    if duration / step / every > MOST_ROWS:
        raise ValueError(
            f"{duration:g} s of a load or joint that changes within {shortest:.3g} s are "
            f"{duration / step / every:.1e} samples; at most {MOST_ROWS:.0e}: follow a shorter time"
        )
    return every


def _with_lumped_error(run: BarRun, kept: _Kept) -> BarRun:
    """Run again at half the step where springs or masses take part, and add twice what that changes to the bound.

    The trapezoidal rule is of second order, so that the run is off by 4/3 of the change.
    """
    stack, grid = run.stack, run.grid
    lumped = any(joint.kind != "bonded" for joint in stack.joints) or stack.end.kind in ("mass", "spring")
    if not lumped or math.isinf(run.bound.velocity):
        return run
    fine = Grid(0.5 * grid.step, tuple(2 * n for n in grid.counts), grid.mismatch)
    again = _run(stack, run.load, run.places, run.duration, fine, _Kept(2 * kept.every, kept.shortest))
    rows = min(len(run.time), len(again.time))

    def change(name: str) -> float:
        return float(np.abs(getattr(again, name)[:rows] - getattr(run, name)[:rows]).max(initial=0.0))

    velocity, acceleration = run.bound.velocity + 2.0 * change("velocity"), run.bound.acceleration
    return replace(run, bound=ErrorBound(velocity, acceleration + 2.0 * change("acceleration")))


def _shortest_time(stack: Stack, load: Load) -> float:
    """Return the shortest time, s, that 50 steps must resolve: rise of the load, relaxation of joints and end."""
    times = [stack.transit]
    if isinstance(load, Impactor):
        if load.contact is None:
            times.append(load.mass / stack.layers[0].impedance)
        else:
            times.append(_indentation_time(stack, load))
    else:
        times.append(load.rise_time or load.duration)
    z = [layer.impedance for layer in stack.layers]
    slow = []
    for joint, before, after in zip(stack.joints, z, z[1:], strict=False):
        if joint.mass > 0.0:
            slow.append(joint.mass / (before + after))
        elif math.isfinite(joint.stiffness):
            slow.append(1.0 / (joint.stiffness * (1.0 / before + 1.0 / after)))
    if stack.end.kind in ("mass", "spring"):
        slow.append(stack.end.value / z[-1] if stack.end.kind == "mass" else z[-1] / stack.end.value)
    return min([*times, *(RELAXATION_STEPS * time for time in slow)])


def _indentation_time(stack: Stack, load: Impactor) -> float:
    """Return the time in which the contact force would reach what the bar can take, Z v0, s."""
    assert load.contact is not None
    return indentation_under(load.contact, stack.layers[0].impedance * load.speed) / load.speed


def _run(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, grid: Grid, keep: _Kept
) -> BarRun:
    """Follow a stack on a grid."""
    every = keep.every
    steps = int(duration / grid.step * (1.0 + 1e-12)) + 1
    tables, state = tables_of(stack, grid), state_at_rest(stack, grid)
    before = _kernels.momentum(tables, state)
    watched = np.concatenate([[[0, 0]], [[len(stack.layers) - 1, grid.counts[-1]]], nearest_nodes(grid, places)])
    rows = (steps - 1) // every + 1
    kept = _recording(watched, every, rows)
    kept.velocity[0, :, 0] = [stack.layers[i].speed for i in watched[:, 0]]
    nodes, position = field_nodes(stack, grid)
    coarse = max(1, steps // _FIELD_ROWS)
    pictured = _recording(nodes, coarse, (steps - 1) // coarse + 1)
    often = max(1, int(keep.shortest / 20.0 / grid.step))
    extremes = Extremes(nodes, often, np.zeros(len(nodes)), np.zeros(len(nodes)))
    norms = np.zeros(6)
    lost, touches, struck = 0.0, np.empty((0, 3)), isinstance(load, Impactor)
    # one step more than is kept, so that the last acceleration has both its neighbours
    if isinstance(load, Impactor):
        table = np.zeros((_MOST_TOUCHES, 3))
        count, _, entered, through, lost, deepest = _impact_kernels.strike(
            tables, state, _law(load), load.mass, load.speed, steps + 1, (kept, pictured), extremes, norms, table
        )
        touches = table[: min(count, _MOST_TOUCHES)]
        if load.contact is not None:
            check_end(load.contact, deepest)
    else:
        history = load.at(grid.step * np.arange(steps + 1.0))
        by_speed = getattr(load, "kind", "force") == "speed"
        entered, through = _kernels.drive(tables, state, history, by_speed, (kept, pictured), extremes, norms)
    return BarRun(
        stack=stack,
        load=load,
        grid=grid,
        time=grid.step * every * np.arange(rows, dtype=np.float64),
        face_force=kept.force[:, 0],
        end_force=kept.force[:, 1],
        force=kept.force[:, 2:],
        velocity=kept.velocity[:, 2:, 1],
        acceleration=(kept.velocity[:, 2:, 2] - kept.velocity[:, 2:, 0]) / (2.0 * grid.step),
        bound=ErrorBound(math.inf, math.inf) if struck else error_bound(stack, grid, norms, places),
        places=tuple(places),
        duration=duration,
        field_time=grid.step * coarse * np.arange(pictured.force.shape[0], dtype=np.float64),
        field_position=position,
        field_force=pictured.force,
        field_velocity=pictured.velocity[:, :, 1],
        field_layer=nodes[:, 0],
        field_least=extremes.least,
        field_greatest=extremes.greatest,
        touches=touches,
        impulse=entered,
        end_impulse=through,
        momentum=_kernels.momentum(tables, state) - before,
        energy_lost=lost,
    )


def _law(load: Impactor) -> NDArray[np.float64]:
    """Return the contact law of an impactor as the kernels take it."""
    row = striking_law(load.contact or Contact(1.0, 1.0))
    row[SLOWEST] = load.slowest_approach
    if load.contact is None:
        row[STIFFNESS] = math.inf
    return row


def _recording(nodes: NDArray[np.int64], every: int, rows: int) -> Recording:
    """Return an empty recording."""
    return Recording(nodes, every, np.zeros((rows, len(nodes))), np.zeros((rows, len(nodes), 3)))
