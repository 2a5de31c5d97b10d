"""A bar alone: case in, solution out."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.wave.build import build_load, wanted
from strikewave.analyses.wave.result import BarSolution, load_peak
from strikewave.base.errors import InputError
from strikewave.base.result import LEDGER_LIMIT, Notice
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import law_notices, yield_notices
from strikewave.cases.sensors_of_case import build_channels
from strikewave.cases.stack_of_case import build_stack, build_taps, check_route, checked, need
from strikewave.sensors import read
from strikewave.sensors.channel import Channel, channel_notices, sensor_sources
from strikewave.signal.filters import stated
from strikewave.signal.pulse import front, largest, measure_pulse
from strikewave.waves import BarRun, Impactor, Pulse, Sampled, Stack, Tap, run_bar
from strikewave.waves.li_ma import ROUTES
from strikewave.waves.limits import (
    bar_extremes,
    end_notices,
    grid_notices,
    joint_notices,
    layer_notices,
    loss_notices,
    rise_in_diameters,
    rise_limits,
    rise_notices,
)
from strikewave.waves.routes import EXACT, RouteHistory, route_history, specimen_of
from strikewave.waves.setup import wave_setup

Array = NDArray[np.float64]

LOAD_OFFSET = 0.005
"""Share of its largest value with which a measured load may begin without a word."""


def run_wave(case: Case) -> BarSolution:
    """Run the stack of a case under its load.

    Raises
    ------
    InputError, InputErrors
        If the case has no stack or load, or parts of it do not fit together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> solution = run_wave(load_case("li-ma-2019-fig13-bar"))
    >>> solution.run.momentum_error < 1e-9
    True
    """
    stack, taps, channels = build_stack(case), build_taps(case), build_channels(case)
    load = build_load(case, stack)
    check_route(case, taps, channels)
    duration = need(case.solver.duration, "solver.duration", "how long to follow", 'add duration = "300 us"')
    run = checked("solver", lambda: run_bar(stack, load, [tap for _, tap in taps], duration, wanted(case)))
    bandwidth, step = case.solver.bandwidth.si if case.solver.bandwidth else math.inf, float(run.time[1])
    if not math.isinf(bandwidth) and not 1.0 / duration <= bandwidth < 0.5 / step:
        allowed = f"{1.0 / duration:.3g} to {0.5 / step:.3g} Hz: one over the duration, half the sampling rate"
        raise InputError("solver.bandwidth", f"{bandwidth:g} Hz", allowed)
    routes = _routes(stack, taps, run) if _of_the_paper(case) else {}
    carried = stack.end.value if stack.end.kind in ("mass", "oscillator") else 0.0
    rigid = (run.face_force - run.end_force) / (stack.mass - carried)
    accuracy, felt = run.relative_bound, _felt(case.solver.route, taps, run, routes)
    readings = tuple(
        checked(
            f"sensor.{sensor.name}",
            functools.partial(read, sensor, recorder, rigid if tap is None else felt[tap], step),
        )
        for sensor, tap, recorder in channels
    )
    rise = min([load_rise(run), *(front(values, step) for values in run.acceleration.T)])
    peak = largest(run.acceleration.ravel())
    run = dataclasses.replace(run, acceleration=_from_rest(run.acceleration.T, step, bandwidth).T)
    for key, wave in routes.items():
        routes[key] = wave._replace(acceleration=_from_rest(wave.acceleration, step, bandwidth))
    most, least, greatest = bar_extremes(run)
    lasting = load.duration if isinstance(load, Pulse | Sampled) else float(run.touches[:, 1].max(initial=0.0))
    solution = BarSolution(
        case=case,
        run=run,
        taps=taps,
        waves=wave_setup(stack, run.grid),
        rigid=_from_rest(rigid, step, bandwidth),
        routes=routes,
        channels=channels,
        readings=readings,
        accuracy=accuracy,
        layer_stress=tuple(float(force / layer.area) for force, layer in zip(most, stack.layers, strict=True)),
        quoted=rise > 0.0 and rise_in_diameters(stack, rise, bandwidth)[0] >= rise_limits(stack)[0],
        warnings=(),
        citations=_citations(case, stack, channels),
    )
    listed = [
        *_ledger(run),
        *grid_notices(run.grid),
        *_file_notices(run),
        *_jump(rise),
        *(rise_notices(stack, rise, bandwidth, peak) if rise > 0.0 else ()),
        *layer_notices(stack, most),
        *_not_reached(run, taps, accuracy),
        *joint_notices(stack, least, greatest, load_peak(run)),
        *loss_notices(solution.losses),
        *end_notices(stack, lasting),
        *channel_notices(channels, [solution.sensors], stack.mass),
        *_missed_accuracy(case, run, accuracy),
        *_contact_notices(case, run),
    ]
    return dataclasses.replace(solution, warnings=tuple(listed))


def _of_the_paper(case: Case) -> bool:
    """Tell whether a case is one of Li & Ma 2019, or asks for a route of theirs."""
    return case.source.startswith("li-ma-2019") or case.solver.route != EXACT


def _incident_force(run: BarRun) -> Array:
    """Return the force that goes down the first layer, as if nothing came back, N."""
    load = run.load
    if isinstance(load, Impactor) or load.kind == "force":
        return run.face_force
    scale = run.stack.layers[0].impedance if load.kind == "speed" else 1.0
    return np.asarray(scale * load.at(run.time))


def _routes(stack: Stack, taps: Sequence[tuple[str, Tap]], run: BarRun) -> dict[tuple[str, str], RouteHistory]:
    """Return what the paper's routes say of each tap in a layer between two others."""
    came = _incident_force(run)
    return {
        (name, route): route_history(stack, tap.layer, tap.position, run.time, came, route)
        for name, tap in taps
        if specimen_of(stack, tap.layer) is not None
        for route in ROUTES
    }


def _felt(
    route: str, taps: Sequence[tuple[str, Tap]], run: BarRun, routes: dict[tuple[str, str], RouteHistory]
) -> list[Array]:
    """Return the acceleration that a sensor at each tap feels, by the route of the case."""
    found = []
    for k, (name, _) in enumerate(taps):
        wave = routes.get((name, route))
        found.append(run.acceleration[:, k] if wave is None else wave.acceleration)
    return found


def _from_rest(values: Array, step: float, bandwidth: float) -> Array:
    """Return histories (rows) at a bandwidth; before the load nothing accelerates."""
    if math.isinf(bandwidth):
        return values
    rest = min(math.ceil(2.0 / (bandwidth * step)), 4 * values.shape[-1])
    led = np.concatenate([np.zeros((*values.shape[:-1], rest)), values], axis=-1)
    return stated(led, step, bandwidth)[..., rest:]


def _citations(case: Case, stack: Stack, channels: Sequence[Channel]) -> tuple[str, ...]:
    origin = ("li-ma-2019",) if _of_the_paper(case) else ()
    theory = {"none": (), "love-rayleigh": ("love-1927",), "pochhammer-chree": ("graff-1975",)}[case.solver.dispersion]
    lossy = any(x.loss for x in stack.layers) or any(x.branches for x in stack.joints)
    loss = ("emmerich-korn-1987",) if lossy else ()
    return (*origin, "kolsky-1963", *theory, *loss, *sensor_sources(channels))


def load_rise(run: BarRun) -> float:
    """Return the rise of the load from 10 to 90 % of its peak, s; 0 for a jump."""
    if not isinstance(run.load, Impactor):
        return run.load.rise_time
    if run.load.contact is None:
        return 0.0
    force = np.concatenate([[0.0], run.face_force])
    return measure_pulse(force, float(run.time[1])).rise if force.max() > 0.0 else 0.0


def _jump(rise: float) -> list[Notice]:
    if rise > 0.0:
        return []
    message = "the load jumps: velocities jump with it, and no finite peak acceleration exists; none is quoted"
    return [Notice("discontinuous-load", message, rise, 0.0)]


def _file_notices(run: BarRun) -> list[Notice]:
    """Say where a measured load may not be what it is taken for."""
    load = run.load
    if not isinstance(load, Sampled):
        return []
    found = []
    if not load.told:
        message = f"the load file names no unit: taken as N and s, {load.largest:.4g} N over {load.duration:.4g} s"
        found.append(Notice("load-unit", message, load.largest, 0.0))
    if load.duration > 10.0 * run.duration:
        message = f"the load lasts {load.duration:.4g} s, the run {run.duration:.4g} s: most of it is not followed"
        found.append(Notice("load-long", message, load.duration, run.duration))
    begins = abs(float(load.values[0]))
    if load.kind != "speed" and begins > LOAD_OFFSET * load.largest:
        message = (
            f"the load begins with {begins:.4g} N, {begins / load.largest:.1%} of its largest: it jumps there; take "
            "off its zero line, and cut away what lies before the blow"
        )
        found.append(Notice("load-offset", message, begins, LOAD_OFFSET * load.largest))
    return found


def _ledger(run: BarRun) -> list[Notice]:
    if run.momentum_error <= LEDGER_LIMIT:
        return []
    message = f"the momentum ledger misses {run.momentum_error:.1e}"
    return [Notice("momentum-ledger", message, run.momentum_error, LEDGER_LIMIT, broken=True)]


def _not_reached(run: BarRun, taps: Sequence[tuple[str, Tap]], accuracy: tuple[float, float]) -> list[Notice]:
    """Name the taps that the waves of the load do not reach within the run."""
    if isinstance(run.load, Impactor) or not math.isfinite(max(accuracy)) or any(x.speed for x in run.stack.layers):
        return []
    transits = [layer.transit for layer in run.stack.layers]
    late = [(name, sum(transits[: tap.layer]) + tap.position * transits[tap.layer]) for name, tap in taps]
    late = [(name, time) for name, time in late if time > run.duration]
    if not late:
        return []
    names = ", ".join(f"{name} ({time * 1e6:.4g} us)" for name, time in late)
    message = f"the run of {run.duration * 1e6:.4g} us ends before the wave comes to {names}"
    return [Notice("not-reached", message, run.duration, max(time for _, time in late))]


def _contact_notices(case: Case, run: BarRun) -> list[Notice]:
    """Say what the contact of a striker with the first face does beyond its law."""
    if not isinstance(run.load, Impactor) or case.striker is None or case.contact is None:
        return []
    face = case.stack.layer[0].material
    return [*law_notices(case), *yield_notices(case.striker, case.contact, face, load_peak(run))]


def _missed_accuracy(case: Case, run: BarRun, accuracy: tuple[float, float]) -> list[Notice]:
    """Say where the wanted error could not be promised."""
    asked, (velocity, acceleration) = wanted(case), accuracy
    if velocity <= asked.velocity and acceleration > asked.acceleration and case.solver.bandwidth is None:
        message = (
            f"the error bound of acceleration is {acceleration:.2g} of its peak instead of {asked.acceleration:g}: "
            "where the load has a corner it jumps, and no step bounds it; round the load, or state a solver.bandwidth"
        )
        return [Notice("error-bound", message, acceleration, asked.acceleration)]
    if velocity <= asked.velocity:
        return []
    if math.isinf(velocity):
        if not np.any(run.velocity):
            message = "nothing moves at the taps: the load is zero, or has not reached them by the end"
        else:
            message = "no error bound: a striker, joints that open, and layers with a speed are beyond its theorem"
        return [Notice("no-error-bound", message, math.inf, asked.velocity)]
    why = "the step is that of the case" if asked.step else "a finer step would take too long, or the load jumps"
    message = f"the error bound of velocity is {velocity:.2g} of its peak instead of {asked.velocity:g}: {why}"
    return [Notice("error-bound", message, velocity, asked.velocity)]
