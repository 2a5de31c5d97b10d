"""Notices on a layered bar: its load, taps that no wave reached, error bounds."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.wave.build import of_the_paper, wanted
from strikewave.analyses.wave.result import WaveSolution, load_peak
from strikewave.base.constants import material
from strikewave.base.result import BALANCE_LIMIT, FAILED, INFO, Notice
from strikewave.base.texts import first_few, percent, plain
from strikewave.cases.case import Case, origin_notices
from strikewave.cases.contact_notices import (
    damping_speed_notices,
    joint_size_notices,
    joint_yield_notices,
    law_notices,
    size_notices,
    speed_notices,
    yield_notices,
)
from strikewave.cases.contact_of_case import struck_material
from strikewave.cases.materials_of_case import material_notices
from strikewave.cases.stack_of_case import sensor_notices
from strikewave.sensors.trial import SensorChannel, channel_notices, shortest_period
from strikewave.waves import BarRun, Impactor, LoadPulse, Sampled, Stack
from strikewave.waves.li_ma import too_thin
from strikewave.waves.limits import (
    MOST_NAMES,
    arrival_time,
    end_notices,
    grid_notices,
    joint_notices,
    layer_notices,
    loss_notices,
    not_reached_notices,
    rise_notices,
)

Array = NDArray[np.float64]

LOAD_OFFSET = 0.005
"""Share of its largest value with which a measured load may begin without a notice, and up to which it has not begun
(chosen: a jump of half a per cent changes peaks by less than the calibration of a sensor does)."""
LONGER = 10.0
"""A measured load that lasts so many times as long as the run is noticed (chosen: nine tenths of it are then
ignored)."""
FEWEST_SAMPLES = 12.0
"""Samples a period of a sensor's input below which its reading is noticed: averages about n of them, and straight lines
between them, take 2 (pi/n)^2/3 off a ringing, 4.6 % at 12."""


class Front(NamedTuple):
    """The steepest front: its rise, s; the largest acceleration before any filter, m/s^2; the bandwidth stated, Hz."""

    rise: float
    peak: float
    bandwidth: float


def layered_bar_notices(
    solution: WaveSolution, front: Front, extremes: tuple[Array, Array, Array], lasting: float
) -> Iterator[Notice]:
    """Yield the notices on a layered bar under a load that lasts so long, s; for the extremes see `bar_extremes`."""
    case, run, stack = solution.case, solution.run, solution.run.stack
    most, least, greatest = extremes
    yield from momentum_notices(run)
    yield from origin_notices(case)
    yield from material_notices(case)
    yield from _fast_layers(case, stack)
    yield from grid_notices(run.grid)
    yield from _file_notices(run)
    yield from _longer_load(run)
    if not front.rise > 0.0:
        message = "the load jumps: velocities jump with it, and no finite peak acceleration exists; none is quoted"
        yield Notice("discontinuous-load", message, front.rise, 0.0)
    else:
        yield from rise_notices(stack, front.rise, front.bandwidth, front.peak)
    yield from layer_notices(stack, most)
    yield from _not_reached(solution)
    yield from joint_notices(stack, least, greatest, load_peak(run))
    yield from loss_notices([dataclasses.astuple(loss) for loss in solution.losses])
    yield from end_notices(stack, lasting)
    yield from channel_notices(solution.channels, [solution.sensors], stack.mass)
    yield from _unresolved(solution.channels, float(run.time[1]))
    yield from _missed_accuracy(case, run, solution.accuracy)
    yield from _without_routes(case, run)
    yield from sensor_notices(case)
    yield from _contact_notices(case, run)
    yield from joint_size_notices(case)
    yield from joint_yield_notices(case, greatest.tolist())


def _fast_layers(case: Case, stack: Stack) -> Iterator[Notice]:
    """Report layers that meet faster than a wave runs in one of them."""
    typed = {layer.name: layer.speed.typed for layer in case.stack.layer if layer.speed is not None}
    for pair in pairwise(stack.layers):
        meeting = abs(pair[0].speed - pair[1].speed)
        slowest = min(pair, key=lambda layer: layer.bar_speed)
        if meeting > slowest.bar_speed:
            fields = " and ".join(f"stack.layer.{x.name}.speed = {typed[x.name]}" for x in pair if x.name in typed)
            message = (
                f"{fields}: {pair[0].name} and {pair[1].name} meet at {plain(meeting, 4)}\xa0m/s, faster than a "
                f"wave in {slowest.name}, {plain(slowest.bar_speed, 4)}\xa0m/s: it is a shock front, of which elastic "
                "waves do not know; look at the unit"
            )
            yield Notice("faster-than-wave", message, meeting, slowest.bar_speed)


def _file_notices(run: BarRun) -> Iterator[Notice]:
    """Yield notices on a measured load: no unit, far longer than the run, an offset at its start."""
    load = run.load
    if not isinstance(load, Sampled):
        return
    if not load.told:
        message = (
            f"the load file names no unit: taken as N and s, {plain(load.largest, 4)}\xa0N over "
            f"{plain(load.duration, 4)}\xa0s"
        )
        yield Notice("load-unit", message, load.largest, 0.0)
    if load.duration > LONGER * run.duration:
        message = (
            f"the load lasts {plain(load.duration, 4)}\xa0s, the run {plain(run.duration, 4)}\xa0s: most of it is "
            "ignored"
        )
        yield Notice("load-long", message, load.duration, run.duration)
    begins = abs(float(load.values[0]))
    if load.kind != "speed" and begins > LOAD_OFFSET * load.largest:
        message = (
            f"the load begins with {plain(begins, 4)}\xa0N, {percent(begins / load.largest, 1)} of its largest: it "
            "jumps there; subtract the baseline, and cut the record at the onset of the blow"
        )
        yield Notice("load-offset", message, begins, LOAD_OFFSET * load.largest)


def _longer_load(run: BarRun) -> Iterator[Notice]:
    """Report a load that has not ended where the run does: its whole impulse has not come by then."""
    load = run.load
    if isinstance(load, LoadPulse) and load.duration > run.duration:
        message = (
            f"the load lasts {plain(load.duration * 1e6, 4)}\xa0us and the run {plain(run.duration * 1e6, 4)}\xa0us: "
            "what is shown is the begin of the blow; raise solver.duration, or shorten load.duration"
        )
        yield Notice("load-long", message, load.duration, run.duration)
    if isinstance(load, Impactor) and run.touches.size and run.touches[-1, 1] >= run.duration:
        message = (
            f"the striker still touches at the end of the run, {plain(run.duration * 1e6, 4)}\xa0us: its impulse "
            "and rebound are not those of the whole blow; raise solver.duration"
        )
        yield Notice("contact-not-over", message, float(run.touches[-1, 1]), run.duration)


def _unresolved(channels: Sequence[SensorChannel], step: float) -> Iterator[Notice]:
    """Report sensors that ring too fast for the samples of a run, every ``step`` s."""
    for channel in channels:
        period = shortest_period([channel])
        if period < FEWEST_SAMPLES * step:
            message = (
                f"sensor {channel.sensor.name} answers up to {plain(1e-3 / period, 4)}\xa0kHz, but what it feels "
                f"is kept every {plain(step * 1e9, 4)} ns: its reading of steep fronts is low; leave solver.step out, "
                f"or take one below {plain(period / FEWEST_SAMPLES * 1e9)} ns and a shorter solver.duration"
            )
            yield Notice("sensor-unresolved", message, step, period / FEWEST_SAMPLES)


def _without_routes(case: Case, run: BarRun) -> Iterator[Notice]:
    """Report that the routes of the paper are left out: their sums over the transits of a layer would take long."""
    layers = too_thin(run.stack, run.time) if of_the_paper(case) else []
    if layers:
        message = (
            f"the routes of Li & Ma 2019 are left out: layer {layers[0]} is crossed too often for them at "
            f"{len(run.time)} instants; shorten solver.duration, or lengthen load.duration"
        )
        yield Notice("routes-left-out", message, float(len(run.time)), 0.0, severity=INFO)


def momentum_notices(run: BarRun) -> Iterator[Notice]:
    """Yield the failed check of the momentum balance of a bar, if it fails."""
    if run.momentum_error > BALANCE_LIMIT:
        message = f"the momentum balance error is {run.momentum_error:.1e}"
        yield Notice("momentum-balance", message, run.momentum_error, BALANCE_LIMIT, severity=FAILED)


def _not_reached(solution: WaveSolution) -> Iterator[Notice]:
    """Name taps, their sensors and layers that no wave reaches within the run, and taps that no whole rise reaches."""
    case, run, stack = solution.case, solution.run, solution.run.stack
    faces, (onset, peak) = _moved_faces(run), _times_of_load(run)
    if not faces:
        return
    stated = f"solver.duration = {case.solver.duration.typed}" if case.solver.duration else "the run"
    taps = []
    for k, (name, tap) in enumerate(solution.taps):
        sensors = [channel.sensor.name for channel in solution.channels if channel.tap == k]
        label = f"{name} with {'sensor' if len(sensors) == 1 else 'sensors'} {', '.join(sensors)}" if sensors else name
        taps.append((label, tap))
    yield from not_reached_notices(stack, taps, run.duration, stated, faces, onset)
    arrivals = [(name, arrival_time(stack, tap.layer, tap.position, faces)) for name, tap in taps]
    cut = [(name, time + peak) for name, time in arrivals if time + onset <= run.duration < time + peak]
    if cut:
        last = max(time for _, time in cut)
        places = first_few([f"tap {name} ({plain(time * 1e6, 4)}\xa0us)" for name, time in cut], MOST_NAMES)
        message = (
            f"{stated} ends before the top of the first pulse arrives at {places}: what is shown there is no peak; "
            f"follow it for more than {plain(last * 1e6, 4)}\xa0us"
        )
        yield Notice("peak-not-reached", message, run.duration, last)


def _moved_faces(run: BarRun) -> list[int]:
    """Return the faces at which waves begin: that of the load, and those beside which layers differ in speed."""
    speeds, end = [layer.speed for layer in run.stack.layers], run.stack.end.kind
    faces = [k + 1 for k, (one, other) in enumerate(pairwise(speeds)) if one != other]
    if isinstance(run.load, Impactor) or run.load.largest > 0.0:
        faces.insert(0, 0)
    if speeds[-1] and end != "free":
        faces.append(len(speeds))
    return faces


def _times_of_load(run: BarRun) -> tuple[float, float]:
    """Return the times at which the load begins and is largest within the run, s; twice that of a later begin.

    A face that a file moves has no peak: it keeps its speed. A striker touches at the start.
    """
    load = run.load
    if isinstance(load, Impactor):
        return 0.0, float(run.time[np.argmax(run.face_force)])
    onset = 0.0
    if isinstance(load, Sampled) and load.largest > 0.0:
        first = int(np.flatnonzero(np.abs(load.values) > LOAD_OFFSET * load.largest)[0])
        onset = float(load.time[max(first - 1, 0)])
    if load.kind == "speed":
        return onset, onset
    return onset, max(onset, float(run.time[np.argmax(np.abs(load.at(run.time)))]))


def _contact_notices(case: Case, run: BarRun) -> list[Notice]:
    """Return notices on the contact of a striker with the first face: law out of range, yield."""
    if not isinstance(run.load, Impactor) or case.striker is None or case.contact is None:
        return []
    face = struck_material(case)
    peak, speed = load_peak(run), run.load.speed
    stated = case.load.speed.typed if case.load is not None and case.load.speed is not None else f"{speed:g}\xa0m/s"
    return [
        *law_notices(case),
        *yield_notices(case.striker, case.contact, face, peak),
        *size_notices(case, peak),
        *speed_notices((material(case.striker.material), face), speed, f"load.speed = {stated}"),
        *damping_speed_notices(case.contact, [speed]),
    ]


def _missed_accuracy(case: Case, run: BarRun, accuracy: tuple[float, float]) -> list[Notice]:
    """Return a notice where the error bound is larger than wanted, or there is none."""
    asked, (velocity, acceleration) = wanted(case), accuracy
    if velocity <= asked.velocity and acceleration > asked.acceleration and case.solver.bandwidth is None:
        message = (
            f"the error bound of acceleration is {plain(acceleration, 2)} of its peak instead of "
            f"{asked.acceleration:g}: "
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
    message = f"the error bound of velocity is {plain(velocity, 2)} of its peak instead of {asked.velocity:g}: {why}"
    return [Notice("error-bound", message, velocity, asked.velocity)]
