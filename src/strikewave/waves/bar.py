"""A stack under a load, followed by delay lines or by its spectrum to the wanted error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.texts import percent
from strikewave.contact._law_kernels import SLOWEST, STIFFNESS
from strikewave.contact.law import Contact, check_end, striking_law
from strikewave.waves import _kernels
from strikewave.waves._kernels import Extremes, Recording, RigidStriker
from strikewave.waves.layers import Stack
from strikewave.waves.load import (
    MOST_SAMPLES,
    PRESCRIBED,
    Impactor,
    Load,
    LoadPulse,
    Sampled,
    load_time,
    refuse_coarse,
    refuse_few_steps,
    refuse_samples,
    resolved_period,
    shortest_time,
)
from strikewave.waves.spectral import MOST_VALUES, Histories, SpectralStack, is_linear, refuse_nonlinear
from strikewave.waves.transit import (
    FIELD_PLACES,
    FIELD_ROWS,
    MOST_EVENTS,
    ErrorBound,
    TimeGrid,
    choose_grid,
    empty_averages,
    error_bound,
    field_nodes,
    from_within,
    grid_of,
    mean_acceleration,
    nearest_nodes,
    state_at_rest,
    tables_of,
)

Array = NDArray[np.float64]
STILL = 1e-9  # a thousand times the rounding of waves that cancel
"""Share of F/Z below which a tap stands still."""
_TINY = 1e-300  # where nothing flowed nothing is missing, and where nothing moves every change is large
"""Divisor in place of zero."""
Method = Literal["auto", "delay lines", "spectral"]


@dataclass(frozen=True)
class Tap:
    """Place at which a stack is watched: layer index and fraction of the layer from its loaded side."""

    layer: int
    position: float


@dataclass(frozen=True)
class WantedError:
    """Wanted accuracy of a run: largest errors over the largest values at the taps, or a step."""

    velocity: float = 1e-3
    acceleration: float = 1e-2
    step: float | None = None
    """Step, s, that is not refined."""
    method: Method = "auto"
    """"auto" takes delay lines, but the spectral solver where a layer loses energy or disperses."""
    period: float = math.inf
    """Shortest period of a sensor that reads the run, s, which the kept samples resolve."""


@dataclass(frozen=True)
class BarRun:
    """Run of a stack under its load.

    Attributes
    ----------
    stack : Stack
        Stack that was loaded.
    load : LoadPulse, Sampled or Impactor
        Load on the first face.
    grid : TimeGrid
        Time step, and the steps of each layer; by the spectral solver no layer is cut into steps.
    time : ndarray
        Times of the samples, s, shape (N,).
    face_force : ndarray
        Force on the first face, N, shape (N,).
    end_force : ndarray
        Force of the stack on its end, N, shape (N,).
    force : ndarray
        At the taps, N, shape (N, taps).
    velocity : ndarray
        At the taps, m/s, shape (N, taps).
    acceleration : ndarray
        At the taps, m/s^2, shape (N, taps). By delay lines it is the average about each sample, as
        `strikewave.waves.transit` says: its integral, from one sample before the first, is the change of velocity.
    mean_push : ndarray
        Force on the first face less that on the end, average about each sample, N, shape (N,).
    hung_acceleration : ndarray
        Acceleration of the masses on springs in the order of `Stack.hung`, m/s^2, shape (N, masses): the average force
        on each over it.
    bound : ErrorBound
        Largest error: from rounding the transits, and what half the step changes where springs or masses take
        part; infinite where joints open or a striker comes. By the spectral solver what half the step changes.
        Where all is bonded, that of an acceleration is the error of the average, not what an average takes off a peak.
    places : tuple of (int, float)
        Layer and fraction of each tap.
    duration : float
        Time for which it was followed, s.
    field_time : ndarray
        Times of the x-t field, s.
    field_position : ndarray
        Places of the x-t field, m from the first face.
    field_force : ndarray
        Force there, N, shape (times, places).
    field_velocity : ndarray
        Velocity there, m/s, shape (times, places).
    field_layer : ndarray
        Index of the layer of each place.
    field_least : ndarray
        Least force at the places of the field over all steps, N.
    field_greatest : ndarray
        Greatest force there, N.
    face_least : ndarray
        Least force at both faces of each layer, N, shape (layers, 2); NaN where a spectrum of many layers was not
        looked at.
    face_greatest : ndarray
        Greatest force there, N, alike.
    events : ndarray
        Openings and closings of joints: index of the joint, time (s), 1 where it opened; shape (n, 3).
    touches : ndarray
        Contacts with an impactor: begin, end, approach speed; shape (n, 3).
    impulse : float
        Impulse of the load, N s.
    end_impulse : float
        Impulse of the stack on its end, N s.
    momentum : float
        Gained by the stack, N s.
    energy_lost : float
        In the contact with an impactor, J.
    striker_speed : float
        Speed of the impactor at the end, m/s.
    deepest : float
        Deepest indentation in the contact with an impactor, m.
    """

    stack: Stack
    load: Load
    grid: TimeGrid
    time: Array = field(repr=False)
    face_force: Array = field(repr=False)
    end_force: Array = field(repr=False)
    force: Array = field(repr=False)
    velocity: Array = field(repr=False)
    acceleration: Array = field(repr=False)
    mean_push: Array = field(repr=False)
    hung_acceleration: Array = field(repr=False)
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
    face_least: Array = field(repr=False)
    face_greatest: Array = field(repr=False)
    events: Array = field(repr=False)
    touches: Array = field(repr=False)
    impulse: float
    end_impulse: float
    momentum: float
    energy_lost: float
    striker_speed: float = math.nan
    deepest: float = math.nan

    @property
    def momentum_error(self) -> float:
        """Impulses less momentum, over the impulse of the load or the momentum that the layers came with."""
        moving = sum(abs(layer.mass * layer.speed) for layer in self.stack.layers)
        flowed = max(abs(self.impulse), abs(self.end_impulse), moving, _TINY)
        return abs(self.impulse - self.end_impulse - self.momentum) / flowed

    @property
    def relative_bound(self) -> tuple[float, float]:
        """Bounds of velocity and acceleration over their largest values at the taps.

        Where all taps stand still, as at a rigid end, over those that their forces would give in one wave, F/Z.
        """
        velocity, acceleration = self.velocity, self.acceleration
        if self.force.size and not np.abs(velocity).max() > STILL * np.abs(self.waves).max():
            velocity, acceleration = self.waves, np.gradient(self.waves, self.time, axis=0)
        pairs = ((self.bound.velocity, velocity), (self.bound.acceleration, acceleration))
        largest = [(bound, float(np.abs(values).max(initial=0.0))) for bound, values in pairs]
        over_velocity, over_acceleration = (bound / most if most > 0.0 else math.inf for bound, most in largest)
        return over_velocity, over_acceleration

    @property
    def waves(self) -> Array:
        """F/Z at the taps, m/s, shape (N, taps)."""
        return self.force / np.array([self.stack.layers[layer].impedance for layer, _ in self.places])


def faces_of_hung(stack: Stack) -> list[tuple[int, float]]:
    """Return the places before and behind each mass on a spring between layers: layer, fraction of the layer."""
    return [place for k, _ in stack.hung if k < len(stack.joints) for place in ((k, 1.0), (k + 1, 0.0))]


def hung_acceleration(stack: Stack, faces: Array, end_force: Array) -> Array:
    """Return the accelerations of masses on springs, m/s^2, shape (N, masses).

    ``faces`` are the forces at `faces_of_hung`, shape (N, 2 per mass between layers): what is lost from face to face
    pushes the mass.
    """
    pushes = [faces[:, 2 * k] - faces[:, 2 * k + 1] for k in range(faces.shape[1] // 2)]
    if stack.end.kind == "oscillator":
        pushes.append(end_force)
    columns = [push / mass for push, (_, mass) in zip(pushes, stack.hung, strict=True)]
    return np.column_stack(columns) if columns else np.empty((len(end_force), 0))


# Rounding the load over a step then changes it by 0.1 % or so, and the step is halved from there.
STEPS_OF_CHANGE = 50.0
"""Steps of the first try in the shortest time in which the load changes."""
MOST_STEPS = 1_000_000  # each history would take 8 MB, and each spectrum of a place 16 MB
"""Most time steps of a run."""
MOST_WORK = 3e7  # a few seconds
"""Most layers times steps to which the step is refined for the wanted error."""
# Halvings of the spectral solver, 16 times the cost of the first; by delay lines each is aimed from the one before,
# so that an error that the third misses no step in reach holds.
_TRIES = 4
"""Tries of a step."""
_FIELD_LAYERS = 100
"""Most layers of an x-t field; each place costs a spectrum here, so that they are fewer than by delay lines."""
_FIELD_VALUES = 2e7  # of more than 100 000 steps fewer places are looked at
"""Most places times steps of an x-t field, ten seconds."""
_CELLS = 1000  # it is cut into no steps that could serve
"""Parts of a layer among which the places of a field are chosen."""
_ROUNDING = 1e-12
"""Share of a step by which a duration may miss a whole number of steps and still be one."""


def needs_spectrum(stack: Stack) -> bool:
    """Return whether a layer loses energy or disperses."""
    return any(layer.loss is not None or layer.dispersion != "none" for layer in stack.layers)


def spectrum_pays(stack: Stack, load: Load, duration: float, taps: int) -> bool:
    """Return whether the spectral solver follows a smooth load in seconds."""
    if isinstance(load, Impactor) or load.rise_time == 0.0:
        return False
    steps = 2.0 * STEPS_OF_CHANGE * duration / load_time(load)
    return steps * len(stack.layers) < 2.0 * MOST_WORK and steps < MOST_STEPS and steps * taps < MOST_SAMPLES


def refuse_spectral_layers(stack: Stack) -> None:
    """Refuse layers that delay lines cannot follow: those that lose energy or disperse."""
    for layer in stack.layers:
        if layer.loss is not None or layer.dispersion != "none":
            what = "loses energy" if layer.loss is not None else "disperses"
            raise ValueError(f"layer {layer.name} {what}, which delay lines cannot follow: take the spectral solver")


def spectral_bar(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, wanted: WantedError
) -> BarRun:
    """Follow a linear stack under its load from rest by its spectrum.

    A step that is not given is halved until halving it once more changes velocity and acceleration at the places by
    less than the wanted error, as far as `MOST_WORK` allows. The error bound of the run is that change: an estimate,
    since the error of the finer step is of second order for smooth loads, a third of it, and of first order, all of
    it, behind corners. A stack or a load that is not linear, and a run too long, raise ValueError.
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
        # the coarse run itself is off by up to twice the change: of first order behind corners
        bound = ErrorBound(2.0 * change.velocity, 2.0 * change.acceleration)
        return _bar_run(coarse, before, places, duration, bound)
    return _bar_run(fine, histories, places, duration, change)


def _refuse_steps(duration: float, step: float) -> None:
    """Refuse too many steps."""
    if duration / step > MOST_STEPS:
        raise ValueError(
            f"{duration:.3g} s at a step of {2.0 * step:.3g} s, and once more at half of it for the error, is more "
            f"than {MOST_STEPS:.0e} steps: follow a shorter time, or take a longer step"
        )


def _look(
    stack: Stack, load: LoadPulse | Sampled, places: Sequence[tuple[int, float]], duration: float, step: float
) -> tuple[SpectralStack, Histories]:
    """Return a spectrum and its histories at places."""
    spectrum = SpectralStack(stack, load, step, math.ceil(duration / step * (1.0 - _ROUNDING)) + 1)
    return spectrum, spectrum.look(places)


def _change(coarse: Histories, fine: Histories) -> ErrorBound:
    """Return the largest changes of velocities and accelerations by half the step."""
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


MOST_LAYER_STEPS = 1e7  # about half a second
"""Most layer steps of one try of a step."""
STEPS_OF_MANY_LAYERS = 1e5  # a thousand layers would get 10 000 of them else, too few for a pulse that runs through
"""Steps that a stack may take however many layers it has."""
USUAL_SAMPLES = 20_000  # more than any figure shows, and half a megabyte
"""Samples of a tap that are kept when the user gives no step."""
SHORTEST_SHARE = 1e-5  # shorter steps would cut the stack into millions
"""Shortest duration over the transit of the stack."""
# Chosen: eight times those of a linear stack, so that an error of second order is 64 times smaller.
STEPS_WITHOUT_BOUND = 400.0
"""Steps in the shortest time where no bound can refine them, with joints that open and strikers."""
LINEAR_STEPS = 50.0  # a half-sine of 50 steps loses 0.1 % between them at most, and the error bound refines from there
"""Steps of the first try, and samples kept, in the shortest time."""
TOO_THIN = 0.05
"""Change of a transit beyond which a linear stack goes to the spectral solver, which changes none."""
WORST_MISMATCH = 0.5  # beyond, a layer is shorter than two thirds of a step, and no longer the layer of the case
"""Largest change of a transit."""
FIRST_MISMATCH = 1e-4  # a tenth of the usual wanted error of a velocity
"""Change of a transit in the first try."""
EXACT_MISMATCH = 1e-12
"""Change of a transit below which it is rounding."""
AIM = 2.0  # the bound does not fall exactly as the step does
"""Factor by which the next try aims below the wanted error."""
HOPELESS = 0.5  # it falls with the step unless the acceleration jumps
"""Share of the bound of an acceleration above which no finer step helps."""
EXTREME_STEPS = 20.0  # a half-sine between two of them is 0.3 % higher at most
"""Looks at the extremes of the force in the shortest time."""
HAT_MOMENT = 1.0 / 6.0  # of a box of two where every step is kept, down to that of a hat, 1/12, where few are
"""Half the second moment of the weight that averages an acceleration, in kept steps."""
_MOST_TOUCHES = 1000  # one blow has some ten; the run follows a chatter of more all the same
"""Most contacts of an impactor that are kept."""


def run_bar(
    stack: Stack, load: Load, taps: Sequence[Tap], duration: float, wanted: WantedError | None = None
) -> BarRun:
    """Follow a stack under its load from rest.

    The step is the given one, or it is refined until the error bound holds the wanted error, as far as
    `MOST_LAYER_STEPS` allow; the bound of the last try is reported in any case. Layers that lose energy or disperse,
    layers far thinner than the others, and many layers whose transits suit no common step go to the spectral solver.
    Theory: :eq:`wave-joint`.

    Parameters
    ----------
    stack : Stack
        Stack that is loaded at its first face.
    load : LoadPulse, Sampled or Impactor
        Load, from time 0 on.
    taps : sequence of Tap
        Places that are watched, at least one.
    duration : float
        Length of the run, s.
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
    """Shortest time in which the stack or its load changes, and the one that the kept samples resolve, s."""

    change: float
    kept: float


def _at_step(
    stack: Stack, load: Load, places: Sequence[tuple[int, float]], duration: float, step: float, shortest: float
) -> BarRun:
    """Follow a stack with a given step; refuse one too long for a layer or the load, or with too many samples."""
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
        if grid.mismatch > WORST_MISMATCH:
            thin = min(stack.layers, key=lambda layer: layer.transit)
            raise ValueError(
                f"layer {thin.name} is too thin for delay lines beside the others: a wave crosses it in "
                f"{thin.transit:.3g} s, which over {duration:.3g} s would take "
                f"{duration / thin.transit * len(stack.layers):.1e} layer steps; make it a compliant joint of "
                f"{thin.modulus * thin.area / thin.length:.4g} N/m, or a mass of {thin.mass:.4g} kg"
            )
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
        if grid.mismatch < EXACT_MISMATCH:  # the rest is the way from the tap to the nearest node
            largest = max(grid.step / (AIM * missed), smallest)
        else:
            mismatch = grid.mismatch / (AIM * missed)
        before = over_rate
    if over > 1.0 and wanted.method == "auto" and linear and spectrum_pays(stack, load, duration, len(places)):
        return spectral_bar(stack, load, places, duration, wanted)
    return _with_lumped_error(run, sampling)


@dataclass(frozen=True)
class _Sampling:
    """Sampling of a run: steps from one kept sample to the next, and shortest time to be resolved, s."""

    every: int
    shortest: float


def _every(duration: float, step: float, shortest: float, taps: int) -> int:
    """Return the steps from one kept sample to the next: `USUAL_SAMPLES` or so, `LINEAR_STEPS` in the shortest time."""
    every = max(1, min(math.ceil(duration / step / USUAL_SAMPLES), int(shortest / LINEAR_STEPS / step)))
    advice = f"a load or joint changes within {shortest:.3g} s; follow a shorter time, or take fewer taps"
    refuse_samples(duration, step * every, taps, advice)
    return every


def _with_lumped_error(run: BarRun, sampling: _Sampling) -> BarRun:
    """Run again at half the step where springs or masses take part, and add twice the change to the bound.

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
        striker = RigidStriker(_law(load), load.mass, load.speed)
        count, speed, entered, through, lost, deepest = _kernels.strike(
            tables, state, striker, run_steps, (recording, field), averages, extremes, norms, table
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
