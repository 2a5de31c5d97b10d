"""Measure the blows that were found in a record.

The baseline is that of the record before the blow (`strikewave.records.baseline`). Noise is smoothed off as
`strikewave.records.pulse_shape` says, so that a clean record stays as it is. Where the noise hides a tenth of the peak,
the figures are those of the smooth pulse that fits best, which its ``method`` reports.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.shock_quantities import (
    MICROSECONDS,
    OF_CHANNEL,
    OF_INTEGRAL,
    PULSE_WIDTH,
    RATIO,
    RISE_TIME,
    SECONDS,
)
from strikewave.records.baseline import LocalBaseline, baseline_before, noise_before
from strikewave.records.contacts import Box, Contacts, find_boxes, robust_line, sample_noise, sort_contacts
from strikewave.records.pulse_shape import (
    BUDGETED,
    LONGEST,
    PulseUncertainty,
    ReadPulse,
    SmoothingWindow,
    SmoothPulse,
    Surroundings,
    fit_smooth_pulse,
    read_pulse,
)
from strikewave.records.record import Array
from strikewave.records.ringing import (
    RINGS_WITHIN,
    BandSplit,
    RigidPulse,
    Stretch,
    rigid_pulse,
    ringing_of,
    split_bands,
)
from strikewave.records.thresholds import HARMED
from strikewave.signal.pulse import FOOT, WIDTH_FRACTION, area_between, crossing

FEWEST = 16  # samples that a record needs: a blow of three, and as much beside it as its noise is estimated from
TOES = 5  # widths of a blow to either side in which its feet are sought
SMALLEST_REBOUND = 0.1  # share of the peak of its blow from which a rebound is reported
# Bend below which a history is a straight line, as a share of its largest value and absolute: a count, a clock
STRAIGHT, TINY = 1e-6, 1e-100
CLEAR = 3.0  # standard deviations of the smoothed record that a tenth of the peak must have to be read off it
# Lead and duration of a half-sine whose mean stands out most, as shares of the box: a first guess
EARLIER, LENGTH = 0.15, 1.3
# Widths after a blow over which its ringing is looked at, and samples without which it is not: four swings of eight
RINGING_WIDTHS, FEWEST_OF_RINGING = 40, 32
TAIL = 0.75  # boxes that a blow lasts behind its own: 0.3 of a half-sine, 0.54 of a haversine, 0.72 of a saw-tooth
PERIODS_OF_RINGING = 8.0  # swings after a blow that are handed to the fit of its ringing
LOBE = 0.5  # share of a rebound by which a record swings to the other side before it where it is a lobe of a ringing
SWINGS, PADDED = 4, 4  # swings of the lowest frequency measured; padding of a spectrum, to find a peak between lines
STANDS_OUT = 30.0  # power of a ringing over that of the noise: noise reaches it once in 1e13 frequencies (exp(-30))
ROUNDING = 1e-24  # share of the largest power below which a peak is rounding: 1e-12 of the amplitude
# Baseline and uncertainty of a pulse that was not measured in a record
NO_BASELINE, NOT_KNOWN = LocalBaseline(math.nan), PulseUncertainty()


@declare.dataclass
class Rebound:
    """A contact that belongs to a blow: smaller than it, and as late after each, or near."""

    time: float = declare.number(SECONDS, "time of its peak")
    peak: float = declare.number(OF_CHANNEL, "largest value above the baseline, with its sign")
    velocity_change: float = declare.number(OF_INTEGRAL, "integral from foot to foot")


@declare.dataclass
class RecordedPulse:
    """One blow in a record, in the unit of the record and seconds.

    Beside what documents have:

    Attributes
    ----------
    smooth : SmoothPulse
        The smooth pulse that fits best; see its misfit. Strong ringing bends it.
    baseline : LocalBaseline
        The baseline before the pulse, its slope, and what noise does to it.
    uncertainty : PulseUncertainty
        Uncertainty of peak, width and velocity change, by what lies before the blow.
    rigid : RigidPulse or None
        The pulse without its ringing, fitted together with it; None where nothing rings, or no model of it fits.
    split : BandSplit or None
        The pulse without its ringing, by a low-pass between the two bands; None where nothing rings, or the low-pass
        leaves no pulse.
    step : float
        Time between samples, s.
    """

    time: float = declare.number(SECONDS, "time of the peak", column=KEY)
    peak: float = declare.number(OF_CHANNEL, "largest value above the baseline, with its sign", column=MAIN)
    rise: float = declare.number(RISE_TIME, "from 10 to 90 % of the peak; null where the record is cut")
    width: float = declare.number(PULSE_WIDTH, "above 10 % of the peak; null where the record is cut", column=MAIN)
    velocity_change: float = declare.number(
        OF_INTEGRAL,
        "integral from foot to foot, where 2 % of the peak is left; of the smooth pulse where the record does not come "
        "back to that",
        column=MAIN,
    )
    ringing_frequency: float = declare.number(
        Quantity("Hz", "kHz"), "of what swings after the pulse; null where nothing stands out"
    )
    offset: float = declare.number(OF_CHANNEL, "baseline before the pulse")
    noise: float = declare.number(OF_CHANNEL, "standard deviation of a single sample")
    smooth: SmoothPulse
    method: str = declare.word("record, read off the record; fit, where noise hides a tenth of the peak")
    begin: float = declare.number(SECONDS, "first foot")
    end: float = declare.number(SECONDS, "last foot")
    baseline: LocalBaseline = NO_BASELINE
    uncertainty: PulseUncertainty = NOT_KNOWN
    rebounds: tuple[Rebound, ...] = ()
    rigid: RigidPulse | None = None
    split: BandSplit | None = None
    step: float = math.nan

    smooth_peak = declare.computed(declare.number(OF_CHANNEL, "peak of the smooth pulse that fits best"))(
        lambda pulse: pulse.smooth.peak
    )
    smooth_width = declare.computed(declare.number(MICROSECONDS, "its width"))(lambda pulse: pulse.smooth.width())
    smooth_misfit = declare.computed(declare.number(RATIO, "what it leaves of the pulse, over the peak"))(
        lambda pulse: pulse.smooth.misfit
    )
    uncertainties = declare.computed(declare.part(PulseUncertainty, "by noise and baseline", inline=True))(
        lambda pulse: pulse.uncertainty
    )
    # NaN where no pulse was fitted together with the ringing: then ``rigid`` is None, which has no such figure
    rigid_peak = declare.computed(declare.number(OF_CHANNEL, "peak without the ringing, fitted together with it"))(
        lambda pulse: getattr(pulse.rigid, "peak", math.nan)
    )
    rigid_width = declare.computed(declare.number(MICROSECONDS, "width without the ringing"))(
        lambda pulse: getattr(pulse.rigid, "width", math.nan)
    )
    rigid_velocity_change = declare.computed(declare.number(OF_INTEGRAL, "velocity change without the ringing"))(
        lambda pulse: getattr(pulse.rigid, "velocity_change", math.nan)
    )
    rigid_peak_uncertainty = declare.computed(declare.number(OF_CHANNEL, "standard uncertainty of that peak"))(
        lambda pulse: getattr(pulse.rigid, "peak_uncertainty", math.nan)
    )
    rigid_width_uncertainty = declare.computed(declare.number(MICROSECONDS, "of that width"))(
        lambda pulse: getattr(pulse.rigid, "width_uncertainty", math.nan)
    )
    rigid_velocity_change_uncertainty = declare.computed(declare.number(OF_INTEGRAL, "of that velocity change"))(
        lambda pulse: getattr(pulse.rigid, "velocity_change_uncertainty", math.nan)
    )
    rebound_rows = declare.computed(
        declare.rows(Rebound, "smaller contacts that belong to the blow: time, peak, velocity change", key="rebounds")
    )(lambda pulse: pulse.rebounds)

    def area_uncertainty(self, duration: float) -> float:
        """Return the standard uncertainty of the integral over a duration, s, about the blow, by what lies before it.

        That of the velocity change is of its own duration; NaN where it is not known.
        """
        if math.isnan(self.baseline.wander) or math.isnan(self.step):
            return self.uncertainty.velocity_change
        return self.baseline.area_wander(duration / self.step) * self.step

    @property
    def split_peak(self) -> float:
        """Peak of the rigid part by the band split; NaN where it cannot be separated."""
        return self.split.peak if self.split is not None and self.split.separable else math.nan

    @property
    def split_width(self) -> float:
        """Width of the rigid part by the band split, s; NaN where it cannot be separated."""
        return self.split.width if self.split is not None and self.split.separable else math.nan

    @property
    def methods_apart(self) -> float:
        """Peaks by joint fit and by band split apart, over the standard uncertainty of that; NaN without both."""
        if self.rigid is None or self.split is None or not self.split.separable:
            return math.nan
        doubt = math.hypot(self.rigid.peak_uncertainty, self.split.peak_uncertainty)
        return abs(self.rigid.peak - self.split.peak) / doubt

    @property
    def differs_without_ringing(self) -> bool:
        """True if peak, width or velocity change without ringing differ by more than `HARMED`."""
        names = () if self.rigid is None else BUDGETED
        return _differ([(getattr(self, name), getattr(self.rigid, name)) for name in names])

    @property
    def differs_by_split(self) -> bool:
        """True if peak or width of the rigid part by the band split differ by more than `HARMED`."""
        return _differ([(self.peak, self.split_peak), (self.width, self.split_width)])


def _differ(pairs: Sequence[tuple[float, float]]) -> bool:
    """Tell whether a figure differs from the other one of its pair."""
    return any(abs(figure - other) > HARMED * abs(other) for figure, other in pairs)


def find_pulses(values: Array, step: float, start: float = 0.0) -> list[RecordedPulse]:
    """Find and measure the blows of an evenly sampled record.

    Parameters
    ----------
    values : ndarray
        The record: any unit, any offset, either sign; finite.
    step : float
        Time between samples, s.
    start : float, optional
        Time of the first sample, s.

    Returns
    -------
    list of RecordedPulse
        In the order of time; peaks in the unit of ``values``, times in s.

    Raises
    ------
    ValueError
        If there are fewer than 16 samples or one is not finite.

    Examples
    --------
    >>> t = np.arange(20_000) * 5e-6
    >>> noise = np.random.default_rng(1).normal(size=t.size)
    >>> blow = np.where(abs(t - 0.03) < 100e-6, 5000.0 * np.cos(np.pi * (t - 0.03) / 200e-6), 0.0)
    >>> [pulse] = find_pulses(blow + 50.0 + noise, 5e-6)
    >>> round(pulse.peak, -1), round(pulse.width * 1e6), round(pulse.velocity_change, 2), round(pulse.offset)
    (5000.0, 187, 0.64, 50)
    """
    if values.ndim != 1 or values.size < FEWEST:
        raise ValueError(f"a record needs at least {FEWEST} samples in one row, got shape {values.shape}")
    if not np.all(np.isfinite(values)):
        raise ValueError("the record holds values that are not finite")
    line = robust_line(values)
    bent = float(np.max(np.abs(values - line.at(np.arange(values.size)))))
    if bent <= max(STRAIGHT * float(np.max(np.abs(values))), TINY):
        return []
    noise = sample_noise(values)
    sign, large, small = find_boxes(values, line, noise)

    few = set(small)

    def measured(boxes: Sequence[Box], are_small: bool) -> list[tuple[RecordedPulse, bool]]:
        """Measure the large boxes, or the small ones, between their neighbours, and tell which they are."""
        contacts = []
        for k, box in enumerate(boxes):
            if (box in few) is are_small:
                earliest = boxes[k - 1].last if k else 0
                latest = boxes[k + 1].first if k + 1 < len(boxes) else values.size
                baseline = baseline_before(values, box.first, box.width, earliest)
                if baseline is None:
                    baseline = LocalBaseline(float(line.at(box.first + 0.5 * box.width)))
                pulse = _measure(values, BlowWindow(box, earliest, latest, sign, baseline, noise, step, start))
                contacts += [] if pulse is None else [(pulse, are_small)]
        return contacts

    contacts = [*measured(large, False), *measured(sorted(large + small), True)]
    return _with_rigid(values, step, start, _owned(sorted(contacts, key=lambda contact: contact[0].time)))


def _with_rigid(values: Array, step: float, start: float, pulses: Sequence[RecordedPulse]) -> list[RecordedPulse]:
    """Return blows with the pulse without ringing, where they ring; one of a double hit has too little beside it."""
    done: list[RecordedPulse] = []
    last: RigidPulse | None = None
    double = {k for pair in contacts_of(pulses).double.items() for k in pair}
    for k, pulse in enumerate(pulses):
        if k in double:
            done.append(pulse)
            continue
        others = [rebound.time - pulse.smooth.length for rebound in one_sided(values, step, start, pulse)]
        others += [pulses[k + 1].begin] if k + 1 < len(pulses) else []
        stretch = stretch_of(values, step, start, pulse, min(others, default=math.inf))
        frequency, sign = ringing_of(stretch), math.copysign(1.0, pulse.peak)
        split = split_bands(stretch, frequency) if frequency > 0.0 else None
        rigid = rigid_pulse(stretch, frequency, last)
        if rigid is not None:
            last = rigid
            rigid = rigid.moved(pulse.smooth.begin - stretch.smooth.begin, sign)
        done.append(replace(pulse, rigid=rigid, split=None if split is None else split.signed(sign)))
    return done


def one_sided(values: Array, step: float, start: float, pulse: RecordedPulse) -> list[Rebound]:
    """Return the rebounds of a blow that are no lobes of its ringing, which swings to the other side before them."""
    rebounds = []
    for rebound in pulse.rebounds:
        begin, end = (round((time - start) / step) for time in (pulse.end, rebound.time))
        sign = math.copysign(1.0, pulse.peak)
        deepest = float(np.min(sign * (values[max(begin, 0) : end] - pulse.offset), initial=0.0))
        rebounds += [] if -deepest > LOBE * abs(rebound.peak) else [rebound]
    return rebounds


def stretch_of(values: Array, step: float, start: float, pulse: RecordedPulse, until: float = math.inf) -> Stretch:
    """Return the record around a blow as its ringing is sought in: until a time, s, at most."""
    width = max((pulse.width if pulse.width > 0.0 else pulse.smooth.width()) / step, 1.0)
    begin, end = (min(max(round((time - start) / step), 0), values.size - 1) for time in (pulse.begin, pulse.end))
    first = max(begin - math.ceil(width), 0)
    ringing = 0.0 if math.isnan(pulse.ringing_frequency) else PERIODS_OF_RINGING / (pulse.ringing_frequency * step)
    last = end + math.ceil(max(RINGS_WITHIN * width, ringing, FEWEST_OF_RINGING)) + 1
    if math.isfinite(until):
        last = min(last, round((until - start) / step))
    sign = math.copysign(1.0, pulse.peak)
    above = sign * (values[first : max(last, end)] - pulse.offset)
    smooth_pulse = pulse.smooth._replace(peak=sign * pulse.smooth.peak, begin=pulse.smooth.begin - start - step * first)
    return Stretch(above, step, begin - first, end - first, width, smooth_pulse, pulse.noise)


def _owned(contacts: Sequence[tuple[RecordedPulse, bool]]) -> list[RecordedPulse]:
    """Return the blows among contacts, each with its rebounds.

    Where a small one was not known when its blow was measured, the spectrum after that blow is that of the rebound too.
    """
    pulses = [pulse for pulse, _ in contacts]
    kinds = sort_contacts(*_sizes(pulses), [small for _, small in contacts])
    rebounds: dict[int, list[Rebound]] = {}
    for k, blow in kinds.owner.items():
        pulse = pulses[k]
        if abs(pulse.peak) >= SMALLEST_REBOUND * abs(pulses[blow].peak):
            rebounds.setdefault(blow, []).append(Rebound(pulse.time, pulse.peak, pulse.velocity_change))
    disturbed = {blow for k, blow in kinds.owner.items() if contacts[k][1] and blow in rebounds}
    return [
        replace(
            pulses[k],
            rebounds=tuple(sorted(rebounds.get(k, ()), key=lambda rebound: rebound.time)),
            ringing_frequency=math.nan if k in disturbed else pulses[k].ringing_frequency,
        )
        for k in kinds.blows
    ]


def contacts_of(pulses: Sequence[RecordedPulse]) -> Contacts:
    """Return what the blows of a record are to one another: a train, double hits."""
    return sort_contacts(*_sizes(pulses), [False] * len(pulses))


def _sizes(pulses: Sequence[RecordedPulse]) -> tuple[Array, Array, Array]:
    """Return times, sizes of peaks, and widths."""
    return (
        np.array([pulse.time for pulse in pulses]),
        np.array([abs(pulse.peak) for pulse in pulses]),
        np.array([pulse.smooth.width() for pulse in pulses]),
    )


@dataclass(frozen=True)
class BlowWindow:
    """Place of one blow in a record, between its neighbours, and its baseline."""

    box: Box
    earliest: int
    latest: int
    sign: int
    baseline: LocalBaseline
    noise: float
    step: float
    start: float

    def time(self, place: float) -> float:
        """Return the time of a sample, s."""
        return self.start + place * self.step


def _measure(values: Array, stretch: BlowWindow) -> RecordedPulse | None:
    """Measure a blow; None where nothing of it is left above its own baseline."""
    box, step, sign = stretch.box, stretch.step, stretch.sign
    begin, end = _reach(stretch, values.size, TOES)
    raw = sign * (values[begin:end] - stretch.baseline.level)
    low, high = _reach(stretch, values.size, 1)
    near = slice(low - begin, high - begin)
    inside = slice(max(box.first - box.width // 2, low) - begin, min(box.last + box.width // 2, high) - begin)
    fitted = _fitted(values, stretch)
    time = np.asarray(stretch.time(begin) + step * np.arange(end - begin), dtype=np.float64)
    noise = noise_before(values, box.first, box.width, stretch.earliest, stretch.noise)
    read = read_pulse(Surroundings(raw, time, near, inside, box.width), fitted, noise)
    clean = read.values
    index = inside.start + int(np.argmax(clean[inside]))
    if clean[index] <= 0.0 or read.peak <= 0.0:
        return None
    smooth_pulse = fitted._replace(peak=sign * fitted.peak)
    common = _ringing(values, stretch), stretch.baseline.level, stretch.noise, smooth_pulse
    feet = fitted.begin, fitted.begin + fitted.length
    rest = stretch.noise * SmoothingWindow(max(box.width // LONGEST, 2)).gain
    if WIDTH_FRACTION * read.peak < CLEAR * rest:
        figures = (fitted.time, sign * fitted.peak, fitted.rise(), fitted.width(), sign * fitted.area())
        return RecordedPulse(*figures, *common, "fit", *feet, stretch.baseline, _of_fit(fitted, stretch), step=step)
    area = fitted.area()
    first, last = (crossing(clean, index, FOOT * read.peak, side) for side in (-1, 1))
    if not math.isnan(first) and not math.isnan(last):  # else it does not come back to its zero: the smooth pulse does
        area = area_between(raw, first, last) * step
        feet = stretch.time(begin + first), stretch.time(begin + last)
    figures = (stretch.time(begin + read.place), sign * read.peak, read.rise * step, read.width * step, sign * area)
    doubt = _of_record(fitted, feet, stretch, read)
    return RecordedPulse(*figures, *common, "record", *feet, stretch.baseline, doubt, step=step)


def _of_record(
    fitted: SmoothPulse, feet: tuple[float, float], stretch: BlowWindow, read: ReadPulse
) -> PulseUncertainty:
    """Return the uncertainty of figures read off the record: the baseline moves under them, and noise beside it.

    What the pulse has beyond its feet is not in the velocity change, 0.02 % of it of a half-sine and 0.12 % of a
    haversine; where samples are few, each foot is known to a sample.
    """
    baseline, step = stretch.baseline, stretch.step
    shifted = fitted.width_slope() * baseline.wander / fitted.peak
    return PulseUncertainty(
        math.hypot(baseline.wander, read.peak_scatter),
        math.hypot(shifted, read.width_scatter * step),
        math.hypot(
            baseline.area_wander((feet[1] - feet[0]) / step) * step,
            max(fitted.area_beyond(*feet), FOOT * fitted.peak * step),
        ),
    )


def _of_fit(fitted: SmoothPulse, stretch: BlowWindow) -> PulseUncertainty:
    """Return the uncertainty of fitted figures: of white noise, or what the mean over the blow wanders if more."""
    wander = stretch.baseline.wander
    white = stretch.noise / math.sqrt(stretch.box.width)
    more = 1.0 if math.isnan(wander) else max(wander / white, 1.0)
    return fitted.uncertainty(stretch.step, more * stretch.noise)


def _reach(stretch: BlowWindow, size: int, widths: int) -> tuple[int, int]:
    """Return the samples around a blow, so many of its widths to either side, at most halfway to its neighbours."""
    box = stretch.box
    begin = max(box.first - widths * box.width - 2, (stretch.earliest + box.first) // 2 if stretch.earliest else 0, 0)
    halfway = (stretch.latest + box.last + 1) // 2 if stretch.latest < size else size
    return begin, min(box.last + widths * box.width + 3, halfway)


def _fitted(values: Array, stretch: BlowWindow) -> SmoothPulse:
    """Return the smooth pulse that fits a blow and its near surroundings."""
    box = stretch.box
    begin, end = _reach(stretch, values.size, 1)
    time = np.asarray(stretch.start + np.arange(begin, end) * stretch.step, dtype=np.float64)
    guess = stretch.time(box.first - EARLIER * box.width), LENGTH * box.width * stretch.step
    return fit_smooth_pulse(time, stretch.sign * (values[begin:end] - stretch.baseline.level), *guess)


def _ringing(values: Array, stretch: BlowWindow) -> float:
    """Return the frequency of what swings after a blow, from the highest peak of its spectrum, Hz.

    NaN where that peak does not stand out of the noise, or where fewer than four swings fit before the next blow.
    """
    begin = stretch.box.last + math.ceil(TAIL * stretch.box.width)
    end = min(stretch.latest - stretch.box.width, begin + RINGING_WIDTHS * stretch.box.width, values.size)
    if end - begin < FEWEST_OF_RINGING:
        return math.nan
    part = values[begin:end] - stretch.baseline.level
    window = np.hanning(2 * part.size)[part.size :]
    power = np.abs(np.fft.rfft((part - np.mean(part)) * window, PADDED * part.size)) ** 2
    lowest = PADDED * SWINGS
    if power.size <= lowest + 3:
        return math.nan
    k = lowest + int(np.argmax(power[lowest:-1]))
    noise = stretch.noise**2 * float(np.sum(window**2))
    if power[k] < STANDS_OUT * max(noise, ROUNDING * power.max(initial=1.0)) or k == lowest:
        return math.nan
    left, middle, right = np.log(power[k - 1 : k + 2])
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    return float((k + shift) / (PADDED * part.size * stretch.step))
