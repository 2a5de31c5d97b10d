"""A bar alone: a stack under a load, followed to the wanted error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.contact._law_kernels import SLOWEST, STIFFNESS
from strikewave.contact.law import Contact, check_end, striking_law
from strikewave.waves import _impact_kernels, _kernels
from strikewave.waves._kernels import Extremes, Recording
from strikewave.waves.averages import empty_averages, from_within, mean_acceleration
from strikewave.waves.bar_run import BarRun, Tap, WantedError, faces_of_hung, hung_acceleration
from strikewave.waves.layers import Stack
from strikewave.waves.load import PRESCRIBED, Impactor, Load
from strikewave.waves.spectral import is_linear
from strikewave.waves.spectral_bar import needs_spectrum, refuse_spectral_layers, spectral_bar, spectrum_pays
from strikewave.waves.times import (
    MOST_SAMPLES,
    refuse_coarse,
    refuse_few_steps,
    refuse_samples,
    resolved_period,
    shortest_time,
)
from strikewave.waves.transit import (
    FIELD_ROWS,
    MOST_EVENTS,
    ErrorBound,
    TimeGrid,
    choose_grid,
    error_bound,
    field_nodes,
    grid_of,
    nearest_nodes,
    state_at_rest,
    tables_of,
)

MOST_LAYER_STEPS = 1e7
"""Layer steps of one try that the choice of a step may cost: about half a second."""
STEPS_OF_MANY_LAYERS = 1e5
"""Steps that a stack may take however many layers it has: a thousand layers would get 10 000 of them else, too few for
a pulse that runs through."""
USUAL_SAMPLES = 20_000
"""Samples of a tap that are kept when the step is chosen for the user: more than any figure shows, and half a
megabyte."""
SHORTEST_SHARE = 1e-5
"""Share of the transit of the stack below which a duration is refused: its steps would cut the stack into millions."""
STEPS_WITHOUT_BOUND = 400.0
"""Steps in the shortest time where no bound can refine them: where joints open and strikers come. Chosen: eight times
those of a linear stack, so that an error of second order is 64 times smaller."""
LINEAR_STEPS = 50.0
"""Steps of the first try, and samples that are kept, in the shortest time: a half-sine of 50 steps loses 0.1 % between
them at most, and the error bound refines what is not enough."""
TOO_THIN = 0.05
"""A change of a transit beyond which a linear stack goes to the spectral solver, which changes none."""
WORST_MISMATCH = 0.5
"""A step that changes a transit by more is refused: that layer is shorter than two thirds of a step, and no longer the
one that was asked for."""
FIRST_MISMATCH = 1e-4
"""Change of a transit that the first try allows: a tenth of the usual error wanted of a velocity."""
EXACT_MISMATCH = 1e-12
"""Change of a transit below which it is rounding."""
AIM = 2.0
"""How many times below what is wanted the next try aims: the bound does not fall exactly as the step does."""
HOPELESS = 0.5
"""Share of the bound of an acceleration that must be gone after a try, or no finer step will do: it falls with the step
unless the acceleration jumps."""
EXTREME_STEPS = 20.0
"""Looks at the extremes of the force in the shortest time: a half-sine between two of them is 0.3 % higher at most."""
HAT_MOMENT = 1.0 / 6.0
"""Half the second moment of what an acceleration is averaged with, in kept steps: of a box of two where every step is
kept, down to that of a hat, 1/12, where few are."""
_TRIES = 4
"""Tries of a step: each is aimed from the one before, so that what the third does not reach no step in reach does."""
_MOST_TOUCHES = 1000
"""Contacts of an impactor that are kept: one blow has some ten; more chatter, which the run follows all the same."""
_ROUNDING = 1e-12
"""Share of a step by which a duration may miss a whole number of steps and still be one."""


def run_bar(
    stack: Stack, load: Load, taps: Sequence[Tap], duration: float, wanted: WantedError | None = None
) -> BarRun:
    """Follow a stack under its load from rest.

    The step is the one asked for, or it is refined until the error bound keeps what is wanted, as far as
    `MOST_LAYER_STEPS` allow; the bound of the last try is reported in any case. Layers that lose energy or disperse,
    layers far thinner than the others, and many layers whose transits suit no common step go to the spectral solver.
    Theory: :eq:`wave-joint`.

    Parameters
    ----------
    stack : Stack
        What is loaded at its first face.
    load : LoadPulse, Sampled or Impactor
        By what; time 0 is its beginning.
    taps : sequence of Tap
        Where it is watched, at least one.
    duration : float
        How long, s.
    wanted : WantedError, optional
        Errors, or a step.

    Returns
    -------
    BarRun
        Histories at the taps, with the error bound and what each layer became on the grid.

    Raises
    ------
    ValueError
        If there is no tap, one lies outside, the duration or the step cannot be used, or the run would take too
        much time or memory.

    Examples
    --------
    >>> from strikewave.waves import Layer, LoadPulse
    >>> bar = Layer("bar", 7820.0, 211e9, 7.0686e-4, 0.07)
    >>> run = run_bar(Stack((bar,)), LoadPulse("rectangle", 19685.0, 1e-3), [Tap(0, 1.0)], 100e-6)
    >>> round(float(run.velocity[np.searchsorted(run.time, 20e-6), 0]), 3)
    1.371
    """
    wanted = wanted or WantedError()
    if not taps:
        raise ValueError("a run needs at least one tap")
    for tap in taps:
        if not (0 <= tap.layer < len(stack.layers) and 0.0 <= tap.position <= 1.0):
            raise ValueError(f"{tap} lies outside the stack of {len(stack.layers)} layers")
    if not 0.0 < duration < math.inf:
        raise ValueError(f"the duration must be above zero, got {duration!r} s")
    if duration < SHORTEST_SHARE * stack.transit:
        raise ValueError(
            f"a duration of {duration:g} s is too short beside the transit of the stack, {stack.transit:.3g} s: take "
            f"one above {SHORTEST_SHARE * stack.transit:.3g} s"
        )
    places = [(tap.layer, tap.position) for tap in taps]
    if wanted.method == "spectral" or (wanted.method == "auto" and needs_spectrum(stack)):
        return spectral_bar(stack, load, places, duration, wanted)
    refuse_spectral_layers(stack)
    shortest = min(stack.transit, shortest_time(stack, load), duration)
    kept = min(shortest, resolved_period(wanted.period, duration, len(taps), LINEAR_STEPS))
    if wanted.step is not None:
        return _at_step(stack, load, places, duration, wanted.step, shortest)
    return _refined(stack, load, places, duration, wanted, _Shortest(shortest, kept))


class _Shortest(NamedTuple):
    """The shortest time in which the stack or its load changes, and that which the kept samples resolve, s."""

    change: float
    kept: float


def _at_step(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, step: float, shortest: float
) -> BarRun:
    """Follow a stack with the step asked for.

    Raises
    ------
    ValueError
        If the step is too long for a layer or the load, or so short that there would be too many samples.
    """
    grid = grid_of(stack, step)
    if grid.mismatch > WORST_MISMATCH:
        raise ValueError(
            f"a step of {step:g} s changes a transit by {percent(grid.mismatch, 0)}: take one below "
            f"{0.5 * min(layer.transit for layer in stack.layers):.3g} s"
        )
    refuse_few_steps(step, duration)
    if not isinstance(load, Impactor):
        refuse_coarse(load, step)
    refuse_samples(duration, step, len(places), f"take a step above {duration * len(places) / MOST_SAMPLES:.3g} s")
    sampling = _Sampling(1, shortest)
    return _with_lumped_error(_run(stack, load, places, duration, grid, sampling), sampling)


def _refined(
    stack: Stack,
    load: Load,
    places: Sequence[tuple[int, float]],
    duration: float,
    wanted: WantedError,
    shortest: _Shortest,
) -> BarRun:
    """Follow a stack with a step that is refined until the error bound keeps what is wanted."""
    smallest = duration * len(stack.layers) / max(MOST_LAYER_STEPS, STEPS_OF_MANY_LAYERS * len(stack.layers))
    linear = is_linear(stack, load)
    changing = shortest.change / (LINEAR_STEPS if linear else STEPS_WITHOUT_BOUND)
    largest = max(min(changing, shortest.kept / LINEAR_STEPS), smallest)
    mismatch, before = FIRST_MISMATCH, math.inf
    for _ in range(_TRIES):
        grid = choose_grid(stack, mismatch, largest, smallest)
        if grid.mismatch > TOO_THIN and wanted.method == "auto" and linear:
            return spectral_bar(stack, load, places, duration, wanted)
        _refuse_thin(stack, grid, duration)
        sampling = _Sampling(_every(duration, grid.step, shortest.kept, len(places)), shortest.change)
        run = _run(stack, load, places, duration, grid, sampling)
        over, over_rate = (
            bound / most for bound, most in zip(run.relative_bound, (wanted.velocity, wanted.acceleration), strict=True)
        )
        # behind a corner of the load the acceleration jumps: no step then bounds its error
        hopeless = over_rate > HOPELESS * before
        missed = over if hopeless else max(over, over_rate)
        if missed <= 1.0 or not math.isfinite(missed) or grid.mismatch > mismatch:
            break
        if grid.mismatch < EXACT_MISMATCH:  # what is left is the way from the tap to the nearest node
            largest = max(grid.step / (AIM * missed), smallest)
        else:
            mismatch = grid.mismatch / (AIM * missed)
        before = over_rate
    if over > 1.0 and wanted.method == "auto" and linear and spectrum_pays(stack, load, duration, len(places)):
        return spectral_bar(stack, load, places, duration, wanted)
    return _with_lumped_error(run, sampling)


def _refuse_thin(stack: Stack, grid: TimeGrid, duration: float) -> None:
    """Refuse layers so thin beside the others that no step in reach resolves them.

    Raises
    ------
    ValueError
        If there is one.
    """
    if grid.mismatch <= WORST_MISMATCH:
        return
    thin = min(stack.layers, key=lambda layer: layer.transit)
    raise ValueError(
        f"layer {thin.name} is too thin for delay lines beside the others: a wave crosses it in {thin.transit:.3g} s, "
        f"which over {duration:.3g} s would take {duration / thin.transit * len(stack.layers):.1e} layer steps; make "
        f"it a compliant joint of {thin.modulus * thin.area / thin.length:.4g} N/m, or a mass of {thin.mass:.4g} kg"
    )


@dataclass(frozen=True)
class _Sampling:
    """Which samples of a run are kept: every so many steps; the shortest time to be resolved, s."""

    every: int
    shortest: float


def _every(duration: float, step: float, shortest: float, taps: int) -> int:
    """Return of how many steps one is kept: `USUAL_SAMPLES` or so in all, `LINEAR_STEPS` in the shortest time.

    Raises
    ------
    ValueError
        If that would be too many.
    """
    every = max(1, min(math.ceil(duration / step / USUAL_SAMPLES), int(shortest / LINEAR_STEPS / step)))
    advice = f"a load or joint changes within {shortest:.3g} s; follow a shorter time, or take fewer taps"
    refuse_samples(duration, step * every, taps, advice)
    return every


def _with_lumped_error(run: BarRun, sampling: _Sampling) -> BarRun:
    """Run again at half the step where springs or masses take part, and add twice what that changes to the bound.

    The trapezoidal rule is of second order, so that the run is off by 4/3 of the change. An average about a sample
    differs from the acceleration there by `HAT_MOMENT` of its second difference, which counts twice too.
    """
    stack, grid = run.stack, run.grid
    lumped = any(joint.kind != "bonded" for joint in stack.joints) or stack.end.kind in ("mass", "spring", "oscillator")
    if not lumped or math.isinf(run.bound.velocity):
        return run
    fine = TimeGrid(0.5 * grid.step, tuple(2 * n for n in grid.counts), grid.mismatch)
    again = _run(stack, run.load, run.places, run.duration, fine, _Sampling(2 * sampling.every, sampling.shortest))
    rows = min(len(run.time), len(again.time))

    def change(name: str) -> float:
        return float(np.abs(getattr(again, name)[:rows] - getattr(run, name)[:rows]).max(initial=0.0))

    bend = float(np.abs(np.diff(run.acceleration, 2, axis=0)).max(initial=0.0))
    acceleration = run.bound.acceleration + 2.0 * change("acceleration") + 2.0 * HAT_MOMENT * bend
    return replace(run, bound=ErrorBound(run.bound.velocity + 2.0 * change("velocity"), acceleration))


def _run(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, grid: TimeGrid, sampling: _Sampling
) -> BarRun:
    """Follow a stack on a grid."""
    every = sampling.every
    steps = int(duration / grid.step * (1.0 + _ROUNDING)) + 1
    tables, state = tables_of(stack, grid), state_at_rest(stack, grid)
    before = _kernels.momentum(tables, state)
    ends, hung = [[0, 0], [len(stack.layers) - 1, grid.counts[-1]]], faces_of_hung(stack)
    watched = np.concatenate([ends, nearest_nodes(grid, [*places, *hung])])
    taps = slice(2, 2 + len(places))
    at_taps, pressed = watched[taps], np.delete(watched, taps, axis=0)
    rows = (steps - 1) // every + 1
    recording = _recording(watched, every, rows)
    averages = empty_averages(at_taps, pressed, every, rows)
    nodes, position = field_nodes(stack, grid)
    coarse = max(1, steps // FIELD_ROWS)
    field = _recording(nodes, coarse, (steps - 1) // coarse + 1)
    often = max(1, int(sampling.shortest / EXTREME_STEPS / grid.step))
    faces = np.array([(i, node) for i, count in enumerate(grid.counts) for node in (0, count)])
    looked_at = np.concatenate([faces, nodes])
    extremes = Extremes(looked_at, often, np.zeros(len(looked_at)), np.zeros(len(looked_at)))
    norms = np.zeros(6)
    lost, speed, deepest = 0.0, math.nan, math.nan
    touches, struck = np.empty((0, 3)), isinstance(load, Impactor)
    # to one kept step behind the last, so that its acceleration has both its neighbours
    run_steps = rows * every + 1
    if isinstance(load, Impactor):
        table = np.zeros((_MOST_TOUCHES, 3))
        count, speed, entered, through, lost, deepest = _impact_kernels.strike(
            tables,
            state,
            _law(load),
            load.mass,
            load.speed,
            run_steps,
            (recording, field),
            averages,
            extremes,
            norms,
            table,
        )
        touches = table[: min(count, _MOST_TOUCHES)]
        if load.contact is not None:
            check_end(load.contact, deepest)
    else:
        history = load.at(grid.step * np.arange(float(run_steps)))
        by = PRESCRIBED.index(load.kind)
        entered, through = _kernels.drive(tables, state, history, by, (recording, field), averages, extremes, norms)
    mean_force, still = averages.force, np.array([stack.layers[i].speed for i in at_taps[:, 0]])
    mean_force[0] = from_within(mean_force[0], np.delete(recording.force[0], taps), every)
    return BarRun(
        stack=stack,
        load=load,
        grid=grid,
        time=grid.step * every * np.arange(rows, dtype=np.float64),
        face_force=recording.force[:, 0],
        end_force=recording.force[:, 1],
        force=recording.force[:, taps],
        velocity=recording.velocity[:, taps],
        acceleration=mean_acceleration(averages.velocity, still, grid.step * every),
        mean_push=mean_force[:, 0] - mean_force[:, 1],
        hung_acceleration=hung_acceleration(stack, mean_force[:, 2:], mean_force[:, 1]),
        bound=ErrorBound(math.inf, math.inf) if struck else error_bound(stack, grid, norms, places),
        places=tuple(places),
        duration=duration,
        field_time=grid.step * coarse * np.arange(field.force.shape[0], dtype=np.float64),
        field_position=position,
        field_force=field.force,
        field_velocity=field.velocity,
        field_layer=nodes[:, 0],
        field_least=extremes.least[len(faces) :],
        field_greatest=extremes.greatest[len(faces) :],
        face_least=extremes.least[: len(faces)].reshape(-1, 2),
        face_greatest=extremes.greatest[: len(faces)].reshape(-1, 2),
        events=state.events[: min(int(state.clock[1]), MOST_EVENTS)],
        touches=touches,
        impulse=entered,
        end_impulse=through,
        momentum=_kernels.momentum(tables, state) - before,
        energy_lost=lost,
        striker_speed=speed,
        deepest=deepest,
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
    return Recording(nodes, every, np.zeros((rows, len(nodes))), np.zeros((rows, len(nodes))))
