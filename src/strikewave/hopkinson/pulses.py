"""The incident, the reflected and the transmitted pulse, found in the traces of two gauges.

Compression is positive. The incident pulse is the first one at its gauge. The others follow from geometry: the
reflected pulse comes to the same gauge 2 d1/c1 later, the transmitted one to the other gauge d1/c1 + d2/c2 later. Begin
and end of a pulse in a noisy trace need no threshold set by hand.

Source: N. Maeda, A method for reading and checking phase times in auto-processing system of seismic wave data, Zisin
38 (1985) 365-379: the place that splits a trace into two stretches of white noise of different variance with the least
information criterion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import MICROSECONDS, RATIO
from strikewave.base.texts import percent
from strikewave.hopkinson.bars import Bar
from strikewave.signal.pulse import crossing

Array = NDArray[np.float64]

FEWEST = 16
"""Least number of samples of a quiet head or of a pulse: a standard deviation is then known to 18 %."""
FEWEST_TO_SPLIT = 8
"""Least number of samples of a stretch that is split: two on either side, and a choice between."""
FALSE_ALARM = 0.01
"""Share of records of pure noise in which a pulse is found. Chosen: one in a hundred."""
PERSISTS = 5
"""Samples in a row that stand above a level, so that a spike of the digitizer is no pulse."""
BLOCKS = 8
"""Parts of a quiet head whose means are compared: enough to show a slow foot in the last, few enough for known
means."""
VARIANCE_ROUNDING = 1e-12
"""Share of the mean square below which a variance is rounding, as of a head of zeros."""
TINY = 1e-300
"""Smallest variance in a logarithm, where all is zero."""
MOST_ALIKE = 0.999
"""Largest correlation of neighbours: at 1 no mean of noise would be known at all."""


def split(values: Array) -> int:
    """Return the first sample of the second of two stretches whose variances differ most.

        AIC(n) = n ln var(x[:n]) + (N - n - 1) ln var(x[n:])

    Parameters
    ----------
    values : array
        Trace that holds one change, shape (N,).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x = 0.01 * rng.standard_normal(400)
    >>> x[300:] += 0.05 * np.arange(100)
    >>> abs(split(x) - 300) <= 2
    True
    """
    size = values.size
    if size < FEWEST_TO_SPLIT:
        return 0
    # an offset would cancel digits in the differences of sums of squares
    x = values - values[0]
    floor = VARIANCE_ROUNDING * float(np.mean(x**2)) + TINY
    count = np.arange(1.0, size)
    sums, squares = np.cumsum(x)[:-1], np.cumsum(x**2)[:-1]
    left = squares / count - (sums / count) ** 2
    rest = size - count
    right = (np.sum(x**2) - squares) / rest - ((np.sum(x) - sums) / rest) ** 2
    criterion = count * np.log(np.maximum(left, floor)) + (rest - 1.0) * np.log(np.maximum(right, floor))
    return int(np.argmin(criterion[2:-2])) + 3


def first_above(values: Array, level: float) -> int | None:
    """Return the first sample from which |values| stays above a level for `PERSISTS` samples; None without one."""
    above = np.abs(values) > level
    if above.size < PERSISTS:
        return None
    run = np.lib.stride_tricks.sliding_window_view(above, PERSISTS).all(axis=1)
    places = np.flatnonzero(run)
    return int(places[0]) if places.size else None


def onset(values: Array) -> int | None:
    """Return the begin of the first pulse of a trace: `split` of the samples before it reaches half the largest value.

    None where no five samples in a row reach it.

    Examples
    --------
    >>> trace = np.concatenate([np.zeros(100), np.sin(np.linspace(0, np.pi, 200)), np.zeros(50)])
    >>> onset(trace)
    101
    """
    half = first_above(values, 0.5 * largest(values))
    return None if half is None else split(values[: half + 1])


def ending(values: Array) -> int:
    """Return the end of the first pulse of a trace with one pulse and its sequel: the onset of the rest, backwards."""
    back = onset(values[::-1])
    return values.size if back is None else values.size - back


def largest(values: Array) -> float:
    """Return the largest magnitude that lasts for `PERSISTS` samples."""
    if values.size < PERSISTS:
        return math.inf
    return float(np.lib.stride_tricks.sliding_window_view(np.abs(values), PERSISTS).min(axis=1).max())


def noise_ceiling(noise: float, samples: int) -> float:
    """Return the largest value of white noise of a standard deviation in so many samples.

    sqrt(2 ln(N/p)) times the standard deviation, with p = `FALSE_ALARM`.
    """
    return noise * math.sqrt(2.0 * math.log(max(samples, 2) / FALSE_ALARM))


class Drift(NamedTuple):
    """Largest difference between the means of parts of a stretch, and the standard error of such a difference."""

    difference: float
    error: float


def drift(values: Array) -> Drift:
    """Return the largest difference of the means of `BLOCKS` equal parts of a stretch of noise, and its standard error.

        error = s sqrt(2/n (1 + r)/(1 - r))

    with s the standard deviation within the parts, n samples in each, and r the correlation of neighbours, whose powers
    stand for that of samples farther apart (noise of first order). Infinite where a part has one sample.

    Examples
    --------
    >>> still = np.random.default_rng(1).standard_normal(4000)
    >>> steady, rising = drift(still), drift(still + 1e-3 * np.arange(4000))
    >>> steady.difference < 4.0 * steady.error, rising.difference > 20.0 * rising.error
    (True, True)
    """
    size = values.size // BLOCKS
    if size < 2:
        return Drift(0.0, math.inf)
    parts = values[: size * BLOCKS].reshape(BLOCKS, size)
    means = parts.mean(axis=1)
    apart = parts - means[:, None]
    power = float(np.mean(apart**2))
    if power == 0.0:
        return Drift(float(np.ptp(means)), 0.0)
    alike = min(max(float(np.mean(apart[:, 1:] * apart[:, :-1])) / power, 0.0), MOST_ALIKE)
    return Drift(float(np.ptp(means)), math.sqrt(2.0 * power / size * (1.0 + alike) / (1.0 - alike)))


LEAD = 0.05
"""Share of the time between incident and reflected pulse by which a window begins early: a foot hidden in the noise and
the moves of an alignment must lie inside."""
HEADROOM = 2
"""Least samples of a trace over `FEWEST`: those of a quiet head and of a pulse."""
HEAD = 0.75
"""Share of the quiet head that gives baseline and noise: a slow foot may hide in the rest."""
LARGEST_STRAIN = 0.02
"""Largest strain of a trace: no bar stays elastic there, so that the unit is wrong."""
SAME_STEP = 1e-6
"""Share by which the steps of both traces may differ: over a million samples, one."""
ROUNDING = 1e-9
"""Share of a step by which a time may lie before its sample, by rounding."""
HALF = 0.5
"""Share of the height between whose crossings a pulse has its plateau and its width."""
LOW, HIGH = 0.1, 0.9
"""Shares of the plateau of the rise, the usual 10 to 90 %; below the lower one a pulse has ended."""


@dataclass(frozen=True)
class GaugeTrace:
    """The record of a gauge: strain, sampling step (s), time of the first sample (s)."""

    strain: Array = field(repr=False)
    step: float
    start: float = 0.0

    @property
    def time(self) -> Array:
        """Times of the samples, s."""
        return np.asarray(self.start + self.step * np.arange(self.strain.size))


@dataclass(frozen=True)
class Quiet:
    """A trace with its baseline at 0 and compression positive."""

    trace: GaugeTrace  # corrected
    onset: int  # first sample of the first pulse
    baseline: float  # mean of the raw samples in the first three quarters before it
    noise: float  # standard deviation of these
    polarity: int  # sign with which the raw strain was multiplied
    drift: Drift  # difference of the means over parts of these


@declare.dataclass
class Pulses:
    """The three pulses at the gauges, strains of shape (N,), all windows of one length."""

    incident: Array = field(repr=False)
    reflected: Array = field(repr=False)
    transmitted: Array = field(repr=False)
    step: float
    late: tuple[float, float, float]
    """Times by which the windows begin after the geometric arrival of the same instant, s: less than a step."""
    onset: float = declare.number(MICROSECONDS, "begin of the incident pulse at its gauge")
    end: float = declare.number(MICROSECONDS, "its end")
    rise: float = declare.number(MICROSECONDS, "its rise from 10 to 90 %")
    width: float = declare.number(MICROSECONDS, "between its half heights")
    plateau: float = declare.number(RATIO, "median strain between its half heights")
    starts: tuple[float, float, float] = declare.number(
        MICROSECONDS, "first sample of the windows of incident, reflected and transmitted pulse"
    )
    traces: tuple[Quiet, Quiet] = field(repr=False)

    @declare.computed(declare.number(RATIO, "standard deviation of the strain of both traces before their pulses"))
    def noise(self) -> tuple[float, float]:
        """Standard deviation of both traces before their pulses."""
        return self.traces[0].noise, self.traces[1].noise

    @property
    def lead(self) -> float:
        """Time from the begin of the windows to the onset, s."""
        return self.onset - self.starts[0]

    @property
    def duration(self) -> float:
        """Length of the windows, s."""
        return (self.incident.size - 1) * self.step


def quieten(trace: GaugeTrace, field_name: str) -> Quiet:
    """Take the baseline off a trace, and turn its first pulse into compression.

    Raises
    ------
    InputError
        If the trace is short, holds a value that is not finite, has no pulse above its noise, or begins in a pulse.
    """
    values = np.asarray(trace.strain, dtype=float)
    if values.ndim != 1 or values.size < HEADROOM * FEWEST:
        raise InputError(field_name, f"{values.size} samples", f"a trace of at least {HEADROOM * FEWEST} samples")
    if not np.all(np.isfinite(values)):
        bad = int(np.count_nonzero(~np.isfinite(values)))
        raise InputError(field_name, f"{bad} samples that are no numbers", "finite samples", "cut the record there")
    if not (0.0 < trace.step < np.inf and np.isfinite(trace.start)):
        raise InputError(field_name, f"a step of {trace.step!r} s", "a sampling step above zero")
    values = values - np.median(values)
    begin = onset(values)
    if begin is None or begin < FEWEST:
        hint = "record with a pre-trigger, or swap the channels if they are mixed up"
        raise InputError(field_name, f"{begin or 0} quiet samples", f"{FEWEST} quiet samples before the pulse", hint)
    head = values[: int(HEAD * begin)]
    level, noise = float(head.mean()), float(head.std())
    values = values - level
    peak = first_above(values, HALF * float(np.abs(values).max()))
    if peak is None or float(np.abs(values).max()) <= noise_ceiling(noise, values.size):
        raise InputError(field_name, "noise alone", "a pulse that stands above the noise before it")
    polarity = 1 if values[peak] > 0.0 else -1
    corrected = GaugeTrace(polarity * values, trace.step, trace.start)
    return Quiet(corrected, begin, float(np.median(trace.strain)) + level, noise, polarity, drift(head))


def find_pulses(incident: GaugeTrace, transmitted: GaugeTrace, bars: tuple[Bar, Bar]) -> Pulses:
    """Find the three pulses and cut them out in windows of one length.

    A window begins a twentieth of the time between incident and reflected pulse before its pulse, and lasts until the
    next wave can come: the reflected pulse at the incident gauge, echoes from the far ends of bars of known length, or
    the end of the record. The traces are strain of any sign, on clocks of one rate and one zero.

    Raises
    ------
    InputError
        If a trace cannot be used, the channels seem swapped, the pulses overlap, the record ends within them, or a
        strain is none of a bar.
    """
    first, second = quieten(incident, "incident trace"), quieten(transmitted, "transmitted trace")
    step = incident.step
    if abs(transmitted.step - step) > SAME_STEP * step:
        raise InputError("transmitted trace", f"a step of {transmitted.step:g} s", f"that of the incident, {step:g} s")
    begin = first.trace.start + first.onset * step
    if second.trace.start + second.onset * step < begin:
        hint = "are the two channels swapped? a wave comes to the incident gauge first"
        raise InputError("transmitted trace", "a pulse before the incident one", "a later pulse", hint)
    return _cut(first, second, bars)


def _cut(first: Quiet, second: Quiet, bars: tuple[Bar, Bar]) -> Pulses:
    """Cut the windows of the three pulses."""
    step, begin = first.trace.step, first.trace.start + first.onset * first.trace.step
    separation = 2.0 * bars[0].delay
    body = first.trace.strain[first.onset : first.onset + int(separation / step)]
    if body.size < FEWEST:
        raise InputError("bar.incident.gauge_distance", f"{bars[0].gauge_distance:g} m", "more than a few samples away")
    end = begin + ending(body) * step
    shape = _shape(body, step)
    if shape[0] > separation - shape[1]:
        got = f"an incident pulse of {shape[0] * 1e6:.4g} us"
        allowed = f"one shorter than the {separation * 1e6:.4g} us to the gauge's reflected pulse"
        hint = "the pulses overlap: move the gauge away from the specimen, or take a shorter striker"
        raise InputError("incident trace", got, allowed, hint)
    # a record may begin later than a whole lead before its pulse
    lead = min(LEAD * separation, first.onset * step)
    arrivals = (0.0, separation, bars[0].delay + bars[1].delay)
    sources = (first.trace, first.trace, second.trace)
    places = [_place(trace, begin - lead + after) for trace, after in zip(sources, arrivals, strict=True)]
    echoes = [separation, *(2.0 * (bar.length - bar.gauge_distance) / bar.speed for bar in bars)]
    left = [(trace.strain.size - 1 - k) * step for trace, (k, _) in zip(sources, places, strict=True)]
    length = min(*echoes, *left)
    if length - lead < shape[0]:
        got = f"{max(length - lead, 0.0) * 1e6:.4g} us from a pulse to the end of its window"
        hint = "the record is cut, or an echo from the far end of a bar comes too soon"
        raise InputError("record", got, f"at least the {shape[0] * 1e6:.4g} us of the incident pulse", hint)
    count = int(length / step) + 1
    came, back, on = (trace.strain[k : k + count] for trace, (k, _) in zip(sources, places, strict=True))
    for name, wave in (("incident", came), ("incident", back), ("transmitted", on)):
        _check_strain(largest(wave), name)
    starts = [trace.start + k * step for trace, (k, _) in zip(sources, places, strict=True)]
    return Pulses(
        incident=came,
        reflected=back,
        transmitted=on,
        step=step,
        starts=(starts[0], starts[1], starts[2]),
        late=(places[0][1], places[1][1], places[2][1]),
        onset=begin,
        end=max(end, begin + shape[0]),
        rise=shape[1],
        plateau=shape[2],
        width=shape[3],
        traces=(first, second),
    )


def _check_strain(strain: float, name: str) -> None:
    """Refuse a strain that no elastic bar bears."""
    if strain > LARGEST_STRAIN:
        hint = 'strain or microstrain? state unit = "ustrain" at the gauge, or look at its bridge and gain'
        allowed = f"at most {percent(LARGEST_STRAIN, 0)}: a pressure bar stays elastic"
        raise InputError(f"{name} trace", f"a strain of {strain:.3g}", allowed, hint)


def _place(trace: GaugeTrace, time: float) -> tuple[int, float]:
    """Return the sample at or before a time, and its distance after it (at most zero), s."""
    place = (time - trace.start) / trace.step
    k = int(np.floor(place + ROUNDING))
    if not 0 <= k < trace.strain.size:
        raise InputError("record", f"no sample at {time * 1e6:.4g} us", "a record that holds all three pulses")
    return k, (k - place) * trace.step


def _shape(body: Array, step: float) -> tuple[float, float, float, float]:
    """Return duration to the fall below a tenth, 10-90 % rise (s), plateau strain, and width at half height (s)."""
    top = float(np.abs(body).max())
    for _ in range(2):  # the plateau, not the first overshoot, gives the height
        inside = np.flatnonzero(body > HALF * top)
        top = float(np.median(body[inside[0] : inside[-1] + 1]))
    middle = (int(inside[0]) + int(inside[-1])) // 2
    half = [crossing(body, middle, HALF * top, way) for way in (-1, 1)]
    low, high = (_first(body, share * top) for share in (LOW, HIGH))
    after = np.flatnonzero(body[int(inside[-1]) :] < LOW * top)
    last = int(inside[-1]) + int(after[0]) if after.size else body.size
    return last * step, (high - low) * step, top, (half[1] - half[0]) * step


def _first(body: Array, level: float) -> float:
    """Return the place at which a pulse first reaches a level, between samples."""
    k = max(int(np.argmax(body >= level)), 1)
    return k - float((body[k] - level) / (body[k] - body[k - 1])) if body[k] != body[k - 1] else float(k)
