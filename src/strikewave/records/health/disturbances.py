"""Noise, hum and ringing beside blows and responses, and what they do to the figures of a record."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import COVERAGE
from strikewave.base.texts import percent
from strikewave.records.health.sampled_record import (
    FEWEST_OF_PART,
    JUMPING,
    Array,
    BlowRecord,
    ResponseRecord,
    with_unit,
)
from strikewave.records.health_notice import Fault
from strikewave.records.measuring import RecordedPulse, one_sided, stretch_of
from strikewave.records.pulse_shape import BUDGETED
from strikewave.records.response import FEWEST
from strikewave.records.ringing import RINGS_WITHIN, ringing_of
from strikewave.records.thresholds import HARMED, OfNoise, OfRinging, OfRingingSought

MAINS = (50.0, 60.0)  # frequencies of the mains, Hz
HARMONICS = 3  # harmonics of the mains that are looked for: what rectifiers make besides is small
A_PERIOD = 30  # means of the record a period of the mains: ten a period of its third harmonic
MOST_MEANS = 6000  # means that are looked at: two hundred periods tell enough


def noisy(record: BlowRecord) -> Iterator[Fault]:
    """Find noise that hides a tenth of the peak: the figures are then those of a fitted smooth pulse."""
    fitted = [p for p in record.pulses if p.method == "fit"]
    if fitted:
        ratio = min(20.0 * math.log10(abs(p.peak) / p.noise) for p in fitted if p.noise > 0.0)
        yield Fault(ratio, severity="" if ratio < OfNoise.NOISY else "good")


def hum(record: BlowRecord) -> Iterator[Fault]:
    """Find hum beside the blows that may move a figure."""
    line = record.once(_noted_hum)
    if line is not None:
        frequency, amplitude = line
        peak = min((abs(pulse.peak) for pulse in record.pulses), default=math.nan)
        share = f", {percent(amplitude / peak)} of the peak" if record.pulses else f" and {record.text(amplitude)}"
        details = {"frequency": frequency, "share": share}
        yield Fault(amplitude, details, effects=record.once(worst_effects), signed=False)


def _noted_hum(record: BlowRecord) -> tuple[float, float] | None:
    line = mains_hum(record)
    peak = min((abs(pulse.peak) for pulse in record.pulses), default=math.nan)
    return line if line is not None and not line[1] <= OfNoise.NOTED_HUM * peak else None


def noise(record: BlowRecord) -> Iterator[Fault]:
    """Find noise of any colour that moves the figures of a blow, from what it does before the blow."""
    effects = record.once(worst_effects)
    if max(effects.values(), default=0.0) < OfNoise.NOTED or record.once(_noted_hum) is not None:
        return
    wander = max((p.baseline.wander for p in record.pulses if math.isfinite(p.baseline.wander)), default=math.nan)
    if math.isnan(wander):
        yield Fault(record.noise, effects=effects, signed=False, message="noise of {value:unit} a sample")
    else:
        yield Fault(wander, effects=effects, signed=False)


def short_before(record: BlowRecord) -> Iterator[Fault]:
    """Find that too little lies before the first blow to know what noise and drift do to its figures."""
    if record.pulses and not math.isfinite(record.pulses[0].baseline.wander):
        yield Fault(record.pulses[0].baseline.widths, end=record.pulses[0].begin)


def hum_of_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a line of the mains beside the response."""
    spans = [(record.blows[r.blow - 1].begin, r.begin + r.duration) for r in record.responses]
    line = hum_beside(record.values, record.step, record.start, spans)
    if line is not None and not line[1] < OfNoise.NOTED_HUM * record.peak:
        frequency, amplitude = line
        details = {"frequency": frequency, "share": amplitude / record.peak}
        yield Fault(amplitude, details, effects=record.moved_by(amplitude), signed=False)


def noise_of_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find noise of any colour, or motion before the blow, that moves the figures."""
    effects = record.moved_by(COVERAGE * record.noise)
    least = max(effects["peak"], effects["rms"]) < OfNoise.NOTED
    if not least or any(effects[name] > HARMED for name in JUMPING):
        yield Fault(record.noise, effects=effects, signed=False)


def short_before_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find that too little lies before the first blow to know the zero and the noise."""
    if record.first < FEWEST:
        yield Fault(record.first, end=record.blows[0].begin)


def worst_effects(record: BlowRecord) -> dict[str, float]:
    """Return by how much of itself noise may falsify each figure of the smallest blow.

    The noise of a record is one, but what each blow tells of it scatters, and the largest of many is not their worst
    but their luck: the median over the blows counts, each times its peak, as noise matters less to a larger blow.
    """
    over_peaks: dict[str, list[float]] = {}
    for pulse in record.pulses:
        for name, effect in _effects(record, pulse).items():
            over_peaks.setdefault(name, []).append(effect * abs(pulse.peak))
    smallest = min((abs(pulse.peak) for pulse in record.pulses if pulse.peak), default=math.nan)
    return {name: float(np.median(each)) / smallest for name, each in over_peaks.items()}


def _effects(record: BlowRecord, pulse: RecordedPulse) -> dict[str, float]:
    """Return by how much of itself noise may falsify each figure; of white noise where no more is known."""
    doubt = pulse.uncertainty
    if math.isnan(doubt.peak) and pulse.width > 0.0:
        doubt = pulse.smooth.uncertainty(record.step, pulse.noise)
    known = {name: getattr(doubt, name) / abs(getattr(pulse, name)) for name in BUDGETED if getattr(pulse, name)}
    return {name: COVERAGE * effect for name, effect in known.items() if math.isfinite(effect)}


def mains_hum(record: BlowRecord) -> tuple[float, float] | None:
    """Return frequency and amplitude of the hum of the mains; None where none is distinct."""
    spans = [(pulse.begin, pulse.end) for pulse in record.pulses]
    return hum_beside(record.values, record.step, record.start, spans)


def hum_beside(
    values: Array, step: float, start: float, spans: Sequence[tuple[float, float]]
) -> tuple[float, float] | None:
    """Return frequency and amplitude of the hum of the mains beside blows from begin to end; None for none."""
    if 2.0 * HARMONICS * max(MAINS) * step > 1.0:
        return None  # samples so far apart take the mains and their harmonics for something slower
    size = max(round(1.0 / (max(MAINS) * A_PERIOD * step)), 1)
    count = min(values.size // size, MOST_MEANS)
    means = values[: count * size].reshape(count, size).mean(axis=1)
    middles = size * np.arange(count) + 0.5 * (size - 1)
    time = np.asarray(start + step * middles, dtype=np.float64)
    first = min((begin for begin, _ in spans), default=-math.inf)
    for after, explained in zip(OfNoise.AFTER_BLOW, OfNoise.EXPLAINED, strict=True):
        quiet = np.ones(count, dtype=bool)
        for begin, end in spans:
            span = max(end - begin, step)
            quiet &= (time < begin - OfNoise.BEFORE_BLOW * span) | (time > end + after * span)
        periods = np.count_nonzero(quiet) * size * step * max(MAINS)
        if periods >= OfNoise.CLEAR_PERIODS:
            return _line_of_mains(first, time, means, quiet, explained)
    return _swing_of_mains(first, time, means, quiet) if periods >= OfNoise.FEWEST_PERIODS else None


def _line_of_mains(
    first: float, time: Array, means: Array, quiet: NDArray[np.bool_], least: float
) -> tuple[float, float] | None:
    """Return frequency and amplitude of the line of the mains that the quiet parts swing in most; None without one."""
    best: tuple[float, float] | None = None
    for frequency in MAINS:
        fitted, amplitude = _swing(time, means, quiet, frequency)
        if best is not None and amplitude <= best[1]:
            continue
        if _explained_of_parts(first, time, means, quiet, fitted) <= least:
            continue
        if amplitude > max(_swing(time, means, quiet, frequency * share)[1] for share in OfNoise.BESIDE_MAINS):
            best = frequency, amplitude
    return best


def _swing_of_mains(first: float, time: Array, means: Array, quiet: NDArray[np.bool_]) -> tuple[float, float] | None:
    """Return the one of the mains that explains a few quiet parts; None where a cubic does about as well."""
    scaled = (time - time[0]) / (time[-1] - time[0])
    cubic = np.polynomial.polynomial.polyfit(scaled[quiet], means[quiet], 3)
    bent = float(np.sum((means - np.polynomial.polynomial.polyval(scaled, cubic))[quiet] ** 2))
    best: tuple[float, float] | None = None
    for frequency in MAINS:
        fitted, amplitude = _swing(time, means, quiet, frequency, 1)
        left = float(np.sum((means - fitted)[quiet] ** 2))
        explained = _explained_of_parts(first, time, means, quiet, fitted)
        if left < OfNoise.SWINGS * bent and explained > max(OfNoise.EXPLAINED):
            best, bent = (frequency, amplitude), left / OfNoise.SWINGS
    return best


def _explained_of_parts(first: float, time: Array, means: Array, quiet: NDArray[np.bool_], fitted: Array) -> float:
    """Return the share that a swing explains of the quiet parts before the first blow and after it, the smaller."""
    before = time < first
    parts = [part for part in (quiet & before, quiet & ~before) if np.count_nonzero(part) >= A_PERIOD // 2]
    return min((_explained(means[part], fitted[part]) for part in parts), default=0.0)


def _swing(
    time: Array, means: Array, chosen: NDArray[np.bool_], frequency: float, harmonics: int = HARMONICS
) -> tuple[Array, float]:
    """Return the best swing of a frequency with its harmonics about a constant, and its amplitude."""
    angles = 2.0 * np.pi * frequency * np.outer(np.arange(1, harmonics + 1), time)
    columns = np.vstack([np.ones(time.size), np.cos(angles), np.sin(angles)]).T
    solution = np.linalg.lstsq(columns[chosen], means[chosen], rcond=None)[0]
    swings = columns[:, 1:] @ solution[1:]
    return np.asarray(columns @ solution), float(0.5 * np.ptp(swings))


def _explained(values: Array, fitted: Array) -> float:
    total = float(np.sum((values - np.mean(values)) ** 2))
    return 1.0 - float(np.sum((values - fitted) ** 2)) / total if total > 0.0 else 0.0


COMPARED = ("peak", "width", "velocity_change")  # figures that are compared with those of the pulse without ringing
WIDTH_BY_LEVEL = 0.68  # width of a half-sine at 10 % over a level under it: 2 / (pi sqrt(1 - 0.1^2)) / 0.936


# Message on ringing that no model tells from the blow
SLOW = (
    "after the blow the record swings by {value:%0} of the peak, about as slowly as the blow itself, and no single "
    "mode explains it: peak, rise and width may hold such ringing too; a smooth pulse misses the blow by {misfit:%0}"
)
# Message on ringing that is distinct from the blow, though of no single mode
NO_MODE = (
    "the blow rings at about {frequency}, by {of_peak:%0} of the peak, and no single mode explains it; against the "
    "smooth pulse"
)
# Message on ringing that has died out when the blow ends
WITHIN = (
    "on its way up to the peak and down from it the record goes back, and a contact pushes once: the blow rings, too "
    "fast for this rate or too briefly to be taken off, which may make"
)


def ringing(record: BlowRecord) -> Iterator[Fault]:
    """Find the blow that rings most, and what that does to its figures: against the pulse fitted together with it."""
    faults = [fault for pulse in record.pulses if (fault := _ringing_of(record, pulse)) is not None]
    yield from sorted(faults, key=_size)[-1:]


def _size(fault: Fault) -> tuple[bool, float]:
    """Return whether it harms a figure, and what it does at most."""
    effects, doubt = fault.effects or {}, fault.doubt or {}
    harms = any(abs(effect) + doubt.get(name, 0.0) > HARMED for name, effect in effects.items())
    return harms or fault.severity == "suspect", max(map(abs, effects.values()), default=0.0)


def _ringing_of(record: BlowRecord, pulse: RecordedPulse) -> Fault | None:
    rigid, smooth = pulse.rigid, pulse.smooth
    share = _swing_after(record, pulse) / abs(pulse.peak)
    if rigid is not None:
        pairs = [(name, getattr(pulse, name) / getattr(rigid, name) - 1.0) for name in COMPARED]
        effects = {name: effect for name, effect in pairs if math.isfinite(effect)}
        if max(map(abs, effects.values())) < OfRinging.NOTED_EFFECT and share < OfRinging.NOTED:
            return None
        frequency = pulse.ringing_frequency if pulse.ringing_frequency > 0.0 else rigid.frequency
        texts = {"frequency": with_unit(frequency, "Hz"), "width": with_unit(rigid.width, "s")}
        details = {"time": pulse.time, "peak": rigid.peak, **texts}
        doubt = {name: getattr(rigid, f"{name}_uncertainty") / abs(getattr(rigid, name)) for name in effects}
        return Fault(share, details, start=pulse.begin, effects=effects, doubt=doubt)
    within = smooth.misfit > OfRinging.STRAYS and pulse.method == "record"
    if share < OfRinging.NOTED and not within:
        return _dead_within(record, pulse)
    frequency = ringing_of(stretch_of(record.values, record.step, record.start, pulse))
    if share < OfRinging.NOTED and math.isnan(frequency):
        return _dead_within(record, pulse)
    if not frequency * smooth.width() > OfRinging.SEPARATE:
        strong = share > OfRinging.STRONG or (within and smooth.misfit > OfRingingSought.POOR)
        severity, harms = ("suspect", ("peak", "rise", "width")) if strong else ("good", ())
        return Fault(share, {"misfit": smooth.misfit}, severity, harms, pulse.end, message=SLOW)
    figures = {"peak": smooth.peak, "width": smooth.width(), "velocity_change": smooth.area()}
    effects = {name: getattr(pulse, name) / value - 1.0 for name, value in figures.items() if value}
    details = {"frequency": with_unit(frequency, "Hz"), "of_peak": max(share, smooth.misfit)}
    doubt = _doubt_of_smooth(pulse, frequency)
    return Fault(share, details, start=pulse.end, effects=effects, doubt=doubt, message=NO_MODE)


def _dead_within(record: BlowRecord, pulse: RecordedPulse) -> Fault | None:
    """Find ringing that has died out when the blow ends: the record goes back on its way up, or down.

    Peak and feet may be off by as much as it does, the velocity change by twice what lies between it and a record that
    never goes back: a swing lifts as much as it takes.
    """
    share, area = goes_back(record, pulse)
    if pulse.method != "record" or not share > HARMED:
        return None
    effects = {"peak": share, "width": share, "velocity_change": 2.0 * area / abs(pulse.velocity_change)}
    return Fault(share, start=pulse.begin, end=pulse.end, effects=effects, signed=False, message=WITHIN)


def goes_back(record: BlowRecord, pulse: RecordedPulse) -> tuple[float, float]:
    """Return by how much a record falls on the way up to a peak, or rises on the way down, over it, and over what area.

    What noise does is none.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> u = np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0)
    >>> for swing in (0.0, 0.3):
    ...     values = np.sin(np.pi * u) - swing * np.exp(-8.0 * u) * np.sin(40.0 * u)
    ...     [pulse] = find_pulses(values, 1e-6)
    ...     print(goes_back(BlowRecord(values, 1e-6, pulses=(pulse,)), pulse)[0] > HARMED)
    False
    True
    """
    sign = math.copysign(1.0, pulse.peak)
    width = pulse.width if pulse.width > 0.0 else 0.0
    places = [record.place(time) for time in (pulse.begin - OfRinging.FOOT * width, pulse.time, pulse.end)]
    up, down = (sign * record.values[a : b + 1] for a, b in itertools.pairwise(places))
    back = np.concatenate([np.maximum.accumulate(side) - side for side in (up, down[::-1])])
    noise = OfRinging.SPANS * record.scatter
    share = max(float(np.max(back)) - noise, 0.0) / abs(pulse.peak)
    return share, record.step * float(np.sum(back[back > noise]))


def _doubt_of_smooth(pulse: RecordedPulse, frequency: float) -> dict[str, float]:
    """Return by how much of itself a swing that the smooth pulse misses may falsify each of its figures.

    It has sqrt(2) of the misfit as amplitude A. It lifts or lowers the peak by that, the feet as any level does, and
    what it adds to the area is half a swing at most, A / (pi f).
    """
    amplitude = math.sqrt(2.0) * pulse.smooth.misfit
    smooth = pulse.smooth
    area = amplitude * abs(smooth.peak) / (math.pi * frequency) / abs(smooth.area())
    return {"peak": amplitude, "width": amplitude * WIDTH_BY_LEVEL, "velocity_change": area}


def _swing_after(record: BlowRecord, pulse: RecordedPulse) -> float:
    """Return by how much a record swings after a blow; 0 where it does not, or another blow is near."""
    width = pulse.width if pulse.width > 0.0 else pulse.smooth.width()
    until = pulse.end + RINGS_WITHIN * width
    begin = record.place(pulse.end + OfRinging.AFTER_BLOW * width)
    after = record.values[begin : record.place(until)] - pulse.offset
    rebounds = one_sided(record.values, record.step, record.start, pulse)
    contacts = [record.next_begin(pulse), *(rebound.time - width for rebound in rebounds)]
    if after.size < FEWEST_OF_PART or min(contacts) < until:
        return 0.0
    swing = 0.5 * float(np.ptp(after))
    return swing if swing >= OfRinging.NOISES * pulse.noise else 0.0


def larger_elsewhere(record: BlowRecord) -> Iterator[Fault]:
    """Find a record that goes higher outside the blows than in them: it swings rather than being struck."""
    pulse = record.largest
    if pulse is None:
        return
    away = np.ones(record.values.size, dtype=bool)
    for blow in record.pulses:
        away[record.place(blow.begin) : record.place(blow.end) + 1] = False
    highest = float(np.max(np.abs(record.values[away] - pulse.offset), initial=0.0))
    if highest > abs(pulse.peak) + OfRinging.HIGHER * pulse.noise:
        yield Fault(highest, {"peak": abs(pulse.peak)})
