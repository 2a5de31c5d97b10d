"""A blow of a run as a shock to judge by a specification: its history as a sensor on the object reads it."""

from __future__ import annotations

import math

import numpy as np

from strikewave.machines import MachineRun
from strikewave.signal.pulse import crossing, refine_peak
from strikewave.specifications.judging import PulseLimits, Shock

SAMPLES = 2000
"""Samples of the duration of the ideal pulse at which a run is read: a peak lies 3e-7 above them at most."""
BESIDE = (0.5, 1.0)
"""Durations before and after the pulse that are read where a specification has no band."""
ROOM = 0.75
"""Durations that are read beyond those: as far as a band is moved over a record to find its place."""


def beside(limits: PulseLimits) -> tuple[float, float]:
    """Return the durations before and after the pulse that its judge looks at."""
    before, after = BESIDE if limits.band is None else (limits.band.before, limits.band.after)
    return max(before, limits.window[0]), max(after, limits.window[1])


def followed(limits: PulseLimits) -> float:
    """Return how long after first touch a run must be followed to be judged, s."""
    return (1.0 + beside(limits)[1] + 2.0 * ROOM) * limits.pulse.duration


def shock_about(run: MachineRun, touch: float, limits: PulseLimits) -> Shock:
    """Return the rigid-body acceleration about a first touch, s; its zero is that of a sensor, as in `Moments`."""
    duration, (before, after) = limits.pulse.duration, beside(limits)
    step = duration / SAMPLES
    first = -math.ceil((before + 1.0 + ROOM) * duration / step)
    last = min(math.ceil((2.0 + after + ROOM) * duration / step), math.floor((run.end - touch) / step))
    since = step * np.arange(first, last + 1)
    begin = float(run.spans[0].begin)
    values = run.sample(np.clip(touch + since, begin, run.end)).rigid_acceleration
    inside = (since >= 0.0) & (since <= 2.0 * duration)
    place = int(np.argmax(np.where(inside, values, -math.inf)))
    return Shock(np.asarray(values, dtype=np.float64), step, float(since[0]), place)


def peak_and_width(shock: Shock, level: float) -> tuple[float, float]:
    """Return the peak of a shock, and its width at a share of it, s; as its judge takes them."""
    _, peak = refine_peak(shock.values, shock.peak_index)
    first, last = (crossing(shock.values, shock.peak_index, level * peak, side) for side in (-1, 1))
    return peak, shock.step * (last - first)
