"""A bar followed by its spectrum to the wanted error."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.waves.bar_run import BarRun, WantedError, faces_of_hung, hung_acceleration
from strikewave.waves.layers import Stack
from strikewave.waves.load import Impactor, Load, LoadPulse, Sampled
from strikewave.waves.spectral import MOST_VALUES, Histories, SpectralStack, refuse_nonlinear
from strikewave.waves.times import (
    MOST_SAMPLES,
    load_time,
    refuse_coarse,
    refuse_few_steps,
    refuse_samples,
    resolved_period,
)
from strikewave.waves.transit import FIELD_PLACES, FIELD_ROWS, ErrorBound, TimeGrid, field_nodes

Array = NDArray[np.float64]

STEPS_OF_CHANGE = 50.0
"""Steps of the first try in the shortest time in which the load changes: rounding the load over a step then changes it
by 0.1 % or so, and the step is halved from there."""
MOST_STEPS = 1_000_000
"""A run of more time steps is refused: each history would take 8 MB, and each spectrum of a place 16 MB."""
MOST_WORK = 3e7
"""Layers times steps up to which the step is refined for the wanted error: a few seconds."""
_TRIES = 4
"""Halvings of the step for the wanted error: 16 times the cost of the first try."""
_FIELD_LAYERS = 100
"""Layers of an x-t field; each place costs a spectrum here, so that they are fewer than by delay lines."""
_FIELD_VALUES = 2e7
"""Places times steps of an x-t field, ten seconds: of more than 100 000 steps fewer places are looked at."""
_CELLS = 1000
"""Parts of a layer among which the places of a field are chosen: it is cut into no steps that could serve."""
_ROUNDING = 1e-12
"""Share of a step by which a duration may miss a whole number of steps and still be one."""
_TINY = 1e-300
"""Stands for zero below a fraction: where nothing moves every change is too large."""


def needs_spectrum(stack: Stack) -> bool:
    """Tell whether a layer loses energy or disperses."""
    return any(layer.loss is not None or layer.dispersion != "none" for layer in stack.layers)


def spectrum_pays(stack: Stack, load: Load, duration: float, taps: int) -> bool:
    """Tell whether the spectral solver follows a smooth load in seconds."""
    if isinstance(load, Impactor) or load.rise_time == 0.0:
        return False
    steps = 2.0 * STEPS_OF_CHANGE * duration / load_time(load)
    return steps * len(stack.layers) < 2.0 * MOST_WORK and steps < MOST_STEPS and steps * taps < MOST_SAMPLES


def refuse_spectral_layers(stack: Stack) -> None:
    """Refuse layers that delay lines cannot follow.

    Raises
    ------
    ValueError
        If a layer loses energy or disperses.
    """
    for layer in stack.layers:
        if layer.loss is not None or layer.dispersion != "none":
            what = "loses energy" if layer.loss is not None else "disperses"
            raise ValueError(f"layer {layer.name} {what}, which delay lines cannot follow: take the spectral solver")


def spectral_bar(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, wanted: WantedError
) -> BarRun:
    """Follow a linear stack under its load from rest by its spectrum.

    Where no step is asked for, it is halved until halving it once more changes velocity and acceleration at the
    places by less than what is wanted, as far as `MOST_WORK` allows. The error bound of the run is that change: an
    estimate, since the error of the finer step is of second order for smooth loads, a third of it, and of first
    order, all of it, behind corners.

    Raises
    ------
    ValueError
        If the stack or the load is not linear, or the run would take too much time or memory.
    """
    refuse_nonlinear(stack, load)
    assert not isinstance(load, Impactor)
    resolved = resolved_period(wanted.period, duration, len(places), STEPS_OF_CHANGE)
    step = wanted.step or min(load_time(load), duration, resolved) / STEPS_OF_CHANGE
    refuse_few_steps(step, duration)
    refuse_coarse(load, step)
    refuse_samples(duration, 0.5 * step, len(places), "take a longer step, follow a shorter time, or take fewer taps")
    _refuse_steps(duration, 0.5 * step)
    fine, histories = _look(stack, load, places, duration, step)
    for _ in range(_TRIES):
        coarse, before = fine, histories
        step *= 0.5
        fine, histories = _look(stack, load, places, duration, step)
        change = _change(before, histories)
        over = [
            change.velocity / (wanted.velocity * _largest(histories.velocity)),
            change.acceleration / (wanted.acceleration * _largest(histories.acceleration)),
        ]
        steps = 2.0 * fine.steps
        if wanted.step or max(over) <= 1.0 or steps * len(stack.layers) > MOST_WORK or steps > MOST_STEPS:
            break
        if steps * len(places) > MOST_SAMPLES:
            break
    if wanted.step:
        bound = ErrorBound(2.0 * change.velocity, 2.0 * change.acceleration)
        return _bar_run(coarse, before, places, duration, bound)
    return _bar_run(fine, histories, places, duration, change)


def _refuse_steps(duration: float, step: float) -> None:
    """Refuse too many steps.

    Raises
    ------
    ValueError
        If there are.
    """
    if duration / step > MOST_STEPS:
        raise ValueError(
            f"{duration:.3g} s at a step of {2.0 * step:.3g} s, and once more at half of it for the error, is more "
            f"than {MOST_STEPS:.0e} steps: follow a shorter time, or take a longer step"
        )


def _look(
    stack: Stack, load: LoadPulse | Sampled, places: Sequence[tuple[int, float]], duration: float, step: float
) -> tuple[SpectralStack, Histories]:
    """Return a spectrum and what happens at places."""
    spectrum = SpectralStack(stack, load, step, math.ceil(duration / step * (1.0 - _ROUNDING)) + 1)
    return spectrum, spectrum.look(places)


def _change(coarse: Histories, fine: Histories) -> ErrorBound:
    """Return by how much half the step changed velocities and accelerations."""
    rows = min(coarse.velocity.shape[1], (fine.velocity.shape[1] + 1) // 2)
    velocity = fine.velocity[:, : 2 * rows : 2] - coarse.velocity[:, :rows]
    acceleration = fine.acceleration[:, : 2 * rows : 2] - coarse.acceleration[:, :rows]
    return ErrorBound(float(np.abs(velocity).max()), float(np.abs(acceleration).max()))


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0)) or _TINY


def _bar_run(
    spectrum: SpectralStack,
    histories: Histories,
    places: Sequence[tuple[int, float]],
    duration: float,
    bound: ErrorBound,
) -> BarRun:
    """Return the run with its x-t field."""
    stack, step = spectrum.stack, spectrum.step
    number = min(FIELD_PLACES, int(_FIELD_VALUES / spectrum.steps))
    cells = TimeGrid(step, (_CELLS,) * len(stack.layers), 0.0)
    nodes, position = field_nodes(stack, cells, min(_FIELD_LAYERS, number // 2), number)
    coarse = max(1, spectrum.steps // FIELD_ROWS)
    rows = (spectrum.steps - 1) // coarse + 1
    force, velocity = np.empty((rows, len(nodes))), np.empty((rows, len(nodes)))
    least, greatest = np.empty(len(nodes)), np.empty(len(nodes))
    batch = max(1, int(MOST_VALUES / spectrum.steps))
    for begin in range(0, len(nodes), batch):
        part = slice(begin, begin + batch)
        field = spectrum.look([(int(layer), node / _CELLS) for layer, node in nodes[part]], accelerated=False)
        force[:, part], velocity[:, part] = field.force.T[::coarse], field.velocity.T[::coarse]
        least[part], greatest[part] = field.force.min(axis=1), field.force.max(axis=1)
    face_least, face_greatest = _face_extremes(spectrum, batch)
    face, end, (entered, through, moved) = spectrum.ends()
    faces = faces_of_hung(stack)
    return BarRun(
        stack=stack,
        load=spectrum.load,
        grid=TimeGrid(step, (0,) * len(stack.layers), 0.0),
        time=step * np.arange(spectrum.steps, dtype=float),
        face_force=face,
        end_force=end,
        force=histories.force.T,
        velocity=histories.velocity.T,
        acceleration=histories.acceleration.T,
        mean_push=face - end,
        hung_acceleration=hung_acceleration(stack, spectrum.look(faces).force.T, end),
        bound=bound,
        places=tuple(places),
        duration=duration,
        field_time=step * coarse * np.arange(rows, dtype=float),
        field_position=position,
        field_force=force,
        field_velocity=velocity,
        field_layer=nodes[:, 0],
        field_least=np.minimum(least, 0.0),
        field_greatest=np.maximum(greatest, 0.0),
        face_least=face_least,
        face_greatest=face_greatest,
        events=np.empty((0, 3)),
        touches=np.empty((0, 3)),
        impulse=entered,
        end_impulse=through,
        momentum=moved,
        energy_lost=0.0,
    )


def _face_extremes(spectrum: SpectralStack, batch: int) -> tuple[Array, Array]:
    """Return least and greatest force at both faces of each layer, N; NaN where that would take long."""
    layers = len(spectrum.stack.layers)
    least, greatest = np.full(2 * layers, np.nan), np.full(2 * layers, np.nan)
    faces = [(layer, end) for layer in range(layers) for end in (0.0, 1.0)]
    if layers * layers * spectrum.steps / batch < MOST_WORK:
        for begin in range(0, len(faces), batch):
            part = slice(begin, begin + batch)
            force = spectrum.look(faces[part], accelerated=False).force
            least[part], greatest[part] = np.minimum(force.min(axis=1), 0.0), np.maximum(force.max(axis=1), 0.0)
    return least.reshape(-1, 2), greatest.reshape(-1, 2)
