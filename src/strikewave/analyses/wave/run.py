"""A bar alone: case in, solution out, with the bands of its results."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.wave.build import build_load, of_the_paper, wanted
from strikewave.analyses.wave.notices import Front, layered_bar_notices
from strikewave.analyses.wave.result import WaveSolution
from strikewave.base.compiling import compiling_shown
from strikewave.base.errors import InputError, checked
from strikewave.base.quantities import Value
from strikewave.base.result import INFO, BandMethod, Notice
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_channels, build_stack, build_taps, check_route, need
from strikewave.reporting.bands import lacking_notices
from strikewave.sensors import Recorder, Sensor, SensorReading, read
from strikewave.sensors.trial import SensorChannel, sensor_sources
from strikewave.signal.filters import stated
from strikewave.signal.pulse import front, largest, measure_pulse
from strikewave.uncertainty.bands import LEVEL, Sample, find_bands
from strikewave.uncertainty.draws import SEED, allowed_inputs, drawn, drawn_case, latin_hypercube
from strikewave.uncertainty.input_ranges import known_inputs
from strikewave.uncertainty.runs import on_threads, why_failed
from strikewave.waves import BarRun, Impactor, LoadPulse, Sampled, Stack, Tap, run_bar
from strikewave.waves.li_ma import EXACT, ROUTES, RouteHistory, route_history, specimen_of, too_thin
from strikewave.waves.limits import bar_extremes, rise_in_diameters, rise_limits
from strikewave.waves.transit import wave_setup

Array = NDArray[np.float64]
Noticed = tuple[Front, tuple[Array, Array, Array], float]

REST_PERIODS = 2.0
"""Periods of the bandwidth for which nothing moves before the load: the filter runs both ways, and two periods before a
step its response is 0.1 % of the step (measured)."""
MOST_REST = 4
"""Samples of rest at most, over those of the run: a very low bandwidth would else fill the memory."""


@compiling_shown()
def run_wave(case: Case, period: float = math.inf) -> WaveSolution:
    """Run the stack of a case under its load.

    Parameters
    ----------
    case : Case
        With a stack and its load.
    period : float, optional
        Shortest period that samples resolve for those who look on, s, besides that of the sensors of the case.

    Returns
    -------
    WaveSolution
        Histories at the taps, with the error bound, limits of the theory and comparisons.

    Raises
    ------
    InputError
        If the case has no stack or load, or parts of it do not fit together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> solution = run_wave(load_case("li-ma-2019-fig13-bar"))
    >>> solution.run.momentum_error < 1e-9
    True
    """
    solution, noticed = _follow(case, period, ROUTES)
    return dataclasses.replace(solution, notices=tuple(layered_bar_notices(solution, *noticed)))


def followed(case: Case) -> WaveSolution:
    """Return the solution of a case by its own route alone, without notices, for studies of many runs."""
    return _follow(case, math.inf, (case.solver.route,))[0]


def bar_figures(case: Case) -> dict[str, float]:
    """Return `WaveSolution.figures` of a case."""
    return followed(case).figures


def _follow(case: Case, period: float, wanted_routes: Sequence[str]) -> tuple[WaveSolution, Noticed]:
    """Return a solution without its notices, and their front, extremes, and duration of the load, s."""
    stack, taps, channels = build_stack(case), build_taps(case), build_channels(case)
    load = build_load(case, stack)
    check_route(case, taps, channels)
    duration = need(case.solver.duration, "solver.duration", "how long to follow", 'add duration = "300 us"')
    asked = wanted(case, channels)
    asked = dataclasses.replace(asked, period=min(asked.period, period))
    run = checked("solver", lambda: run_bar(stack, load, [tap for _, tap in taps], duration, asked))
    bandwidth, step = case.solver.bandwidth.si if case.solver.bandwidth else math.inf, float(run.time[1])
    if not math.isinf(bandwidth) and not 1.0 / duration <= bandwidth < 0.5 / step:
        allowed = f"{1.0 / duration:.3g} to {0.5 / step:.3g} Hz: one over the duration, half the sampling rate"
        raise InputError("solver.bandwidth", f"{bandwidth:g} Hz", allowed)
    routes: dict[tuple[str, str], RouteHistory] = {}
    if case.solver.route != EXACT or (of_the_paper(case) and not too_thin(stack, run.time)):
        routes = checked("solver.route", lambda: _routes(stack, taps, run, wanted_routes))
    carried = stack.end.value if stack.end.kind in ("mass", "oscillator") else 0.0
    rigid = run.mean_push / (stack.mass - carried)
    accuracy, felt = run.relative_bound, _felt(case.solver.route, taps, run, routes)
    readings = tuple(
        checked(
            f"sensor.{sensor.name}",
            functools.partial(_reading, sensor, recorder, rigid if tap is None else felt[tap], step),
        )
        for sensor, tap, recorder in channels
    )
    rise = min([load_rise(run), *[front(values, step) for values in run.acceleration.T]])
    peak = largest(run.acceleration.ravel())
    run = dataclasses.replace(run, acceleration=_from_rest(run.acceleration.T, step, bandwidth).T)
    for key, wave in routes.items():
        routes[key] = wave._replace(acceleration=_from_rest(wave.acceleration, step, bandwidth))
    extremes = bar_extremes(run)
    lasting = load.duration if isinstance(load, LoadPulse | Sampled) else float(run.touches[:, 1].max(initial=0.0))
    solution = WaveSolution(
        case=case,
        run=run,
        taps=taps,
        waves=wave_setup(stack, run.grid),
        rigid=_from_rest(rigid, step, bandwidth),
        routes=routes,
        channels=channels,
        readings=readings,
        accuracy=accuracy,
        layer_stress=tuple(float(force / layer.area) for force, layer in zip(extremes[0], stack.layers, strict=True)),
        quoted=rise > 0.0 and rise_in_diameters(stack, rise, bandwidth)[0] >= rise_limits(stack)[0],
        citations=_citations(case, stack, channels),
    )
    return solution, (Front(rise, peak, bandwidth), extremes, lasting)


def _reading(sensor: Sensor, recorder: Recorder, felt: Array, step: float) -> SensorReading:
    """Return the reading of a sensor of a history that is at rest one step before its first sample.

    Where the load begins with a jump of velocity the first sample holds it, and counts from that step on.
    """
    samples = recorder.sampling_rate * step
    phase = 0.0 if math.isinf(samples) else samples % 1.0
    reading = read(sensor, recorder, np.append(0.0, felt), step, -step, phase)
    interval = step if math.isinf(recorder.sampling_rate) else 1.0 / recorder.sampling_rate
    inside = reading.time > -0.5 * interval
    return reading._replace(time=np.maximum(reading.time[inside], 0.0), values=reading.values[inside])


def _routes(
    stack: Stack, taps: Sequence[tuple[str, Tap]], run: BarRun, wanted_routes: Sequence[str]
) -> dict[tuple[str, str], RouteHistory]:
    """Return the histories by the wanted routes of the paper at each tap in a layer between two others."""
    load, incident = run.load, run.face_force
    if not isinstance(load, Impactor) and load.kind != "force":  # the force down the first layer, nothing coming back
        scale = stack.layers[0].impedance if load.kind == "speed" else 1.0
        incident = np.asarray(scale * load.at(run.time))
    return {
        (name, route): route_history(stack, tap.layer, tap.position, run.time, incident, route)
        for name, tap in taps
        if specimen_of(stack, tap.layer) is not None
        for route in ROUTES
        if route in wanted_routes
    }


def _felt(
    route: str, taps: Sequence[tuple[str, Tap]], run: BarRun, routes: dict[tuple[str, str], RouteHistory]
) -> list[Array]:
    """Return the acceleration that a sensor at each tap feels, by the route of the case."""
    histories = []
    for k, (name, _) in enumerate(taps):
        wave = routes.get((name, route))
        histories.append(run.acceleration[:, k] if wave is None else wave.acceleration)
    return histories


def _from_rest(values: Array, step: float, bandwidth: float) -> Array:
    """Return histories (rows) at a bandwidth; before the load nothing accelerates."""
    if math.isinf(bandwidth):
        return values
    rest = min(math.ceil(REST_PERIODS / (bandwidth * step)), MOST_REST * values.shape[-1])
    with_rest = np.concatenate([np.zeros((*values.shape[:-1], rest)), values], axis=-1)
    return stated(with_rest, step, bandwidth)[..., rest:]


def _citations(case: Case, stack: Stack, channels: Sequence[SensorChannel]) -> tuple[str, ...]:
    origin = ("li-ma-2019",) if of_the_paper(case) else ()
    theory = {"none": (), "love-rayleigh": ("love-1927",), "pochhammer-chree": ("graff-1975",)}[case.solver.dispersion]
    lossy = any(x.loss for x in stack.layers) or any(x.branches for x in stack.joints)
    loss = ("emmerich-korn-1987",) if lossy else ()
    return (*origin, "kolsky-1963", *theory, *loss, *sensor_sources(channels))


def _meeting_rise(stack: Stack) -> float:
    """Return 0 where layers of different speeds meet face to face, which jumps; infinite where springs lie between."""
    for joint, before, beyond in zip(stack.joints, stack.layers, stack.layers[1:], strict=False):
        hard = joint.contact is None and (math.isinf(joint.stiffness) or joint.attached > 0.0)
        if hard and before.speed != beyond.speed:
            return 0.0
    return math.inf


def load_rise(run: BarRun) -> float:
    """Return the rise of the load from 10 to 90 % of its peak, s; 0 for a jump."""
    if not isinstance(run.load, Impactor):
        return run.load.rise_time if run.load.largest > 0.0 else _meeting_rise(run.stack)
    if run.load.contact is None:
        return 0.0
    force = np.concatenate([[0.0], run.face_force])
    return measure_pulse(force, float(run.time[1])).rise if force.max() > 0.0 else 0.0


BAND_RUNS, FEWEST_BAND_RUNS = 64, 24
"""Runs of a bar, 5 to 15 ms each; of a long one as many as `BAND_WORK` allows: below the fewest there is no band."""
BAND_ERROR = 0.01
"""Error that a velocity may have, over its largest. Measured on li-ma-2019-fig13-bar: it changes no result of a run by
more than 2.4e-3, and the ends of no band by more than 5e-4; a bound of 1e-3 takes eight times as long."""
BAND_WORK = 2e9
"""Samples times layers of all runs together: some ten seconds of the solver."""
BAR_STREAM = 21  # key of the draws: any that no other draw has


def with_bands(
    solution: WaveSolution, progress: Callable[[float], None] | None = None, threads: int | None = None
) -> WaveSolution:
    """Return a solution with the band of each of its results; where the bar takes too long, with a notice alone.

    ``progress`` is called with the share done, 0 to 1; the number of threads changes no bit.
    """
    case = solution.case
    runs = min(BAND_RUNS, int(BAND_WORK / (solution.run.time.size * len(solution.run.stack.layers))))
    if runs < FEWEST_BAND_RUNS:
        message = (
            f"no band: {FEWEST_BAND_RUNS} runs of so long a bar would take minutes; shorten solver.duration, or "
            "raise solver.step"
        )
        notice = Notice("no-band", message, float(runs), float(FEWEST_BAND_RUNS), severity=INFO)
        return dataclasses.replace(solution, notices=(*solution.notices, notice))
    inputs, quick = allowed_inputs(case, known_inputs(case, _uncertain_tables(case)), _build_all), coarse_case(case)
    points = latin_hypercube(sum([row.count for row in inputs]), runs, stream=BAR_STREAM)

    def run(row: Array) -> dict[str, float]:
        return bar_figures(drawn_case(quick, inputs, row.tolist()))

    numbers = list(drawn(inputs, points))
    outcomes = on_threads(run, numbers, threads, progress)
    rows = [outcome or {} for outcome in outcomes]
    results = {name: np.array([row.get(name, math.nan) for row in rows]) for name in solution.figures}
    failed, why = outcomes.count(None), why_failed(run, numbers, outcomes)
    method = BandMethod("full runs", LEVEL, SEED, runs, failed=failed, why=why)
    bands, method = find_bands(Sample(inputs, points), results, method)
    notices = (*solution.notices, *lacking_notices(solution.figures, bands, method))
    return dataclasses.replace(solution, band=bands, band_method=method, notices=notices)


def _build_all(case: Case) -> None:
    """Build the parts of a run of a bar, so that parts that do not go together are refused."""
    build_load(case, build_stack(case))
    build_channels(case)


def coarse_case(case: Case) -> Case:
    """Return a case that may be off by `BAND_ERROR`, unless it states a time step, or a larger error."""
    stated = case.solver.error
    if case.solver.step is not None or (stated is not None and stated.si >= BAND_ERROR):
        return case
    solver = case.solver.model_copy(update={"error": Value(si=BAND_ERROR, typed=BAND_ERROR)})
    return case.model_copy(update={"solver": solver})


def _uncertain_tables(case: Case) -> tuple[str, ...]:
    """Return the tables that a bar alone depends on: the striker only where it makes the load."""
    struck = case.load is not None and case.load.shape == "contact"
    return ("stack", "load", "sensor", *(("striker", "contact") if struck else ()))
