"""What is wrong with a response channel, which has no blow of its own, and what that does to its figures.

The checks of blows that presume no pulse are here again: clipping, saturation, zero, hum, noise, sampling. What a fault
does is found by measuring again: without it, where the record tells it (drift, shift, AC coupling), else at levels that
differ by as much as the fault may move them. An effect on the delay is over a swing of the strongest mode.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import COVERAGE
from strikewave.base.percents import percent
from strikewave.records.correlation import alike_as_one
from strikewave.records.health.examined import SampledRecord
from strikewave.records.health.noise import NOTED_HUM, NOTED_NOISE, hum_beside
from strikewave.records.health.range import rail
from strikewave.records.health.sampling import folded_level
from strikewave.records.health_notice import HARMED, RESPONSE_FIGURES, HealthNotice, by_effect, worst_first
from strikewave.records.modes import FEWEST
from strikewave.records.pulses import MAD_TO_SIGMA, sample_noise
from strikewave.records.response import EFFECTIVE, ROUND, BaseBlow, MeasuredResponse, measure_responses, zero_before
from strikewave.signal.coupling import ac_uncoupled
from strikewave.signal.oscillators import acceleration, recursion

Array = NDArray[np.float64]

STANDS_OUT = 8.0
"""Standard deviations of what lies before that a response must reach: noise alone reaches five in a million samples."""
OVER_BEFORE = 2.0
"""Times the largest value before the blow that a response must reach."""
JUMPING = ("delay", "duration", "rms")
"""Figures that jump by half a swing, or by what it holds, where two tops, or a top and the level, differ by less than
the noise: they are then withheld, and the channel is not suspect for it."""
FLATTER, FLAT_ALONE, SAME_LEVEL = 0.12, 0.3, 0.02
"""Shares of a half swing by which the highest tops are flatter than that of a sine: half of those within this share of
the height, and one that stands alone. Modes together make a flat top now and then, but not several alike."""
TOP, NOISES_OF_TOP, DEEPEST_TOP = 0.02, 4.0, 0.5
"""What counts as top: 2 % of it below it and four standard deviations of noise, at most half of it."""
HIGH_TOPS = 0.5
"""Share of the highest top that the tops have which are looked at."""
LAG = 16
"""Parts of a swing over which its slope is taken: it then still is 97 % of the true one."""
COARSE = 0.02
"""Half a step of the converter over the peak from which on it is worth a word."""
UNIQUE = 1e-9
"""Share of the span below which two values are one: the rounding of a calibration."""
SLOPED, SHIFTED = 5.0, 5.0
"""Standard errors of a slope before the blow, and of a shift after it, that are some."""
CARRIED_ON = 0.5
"""Share of what a drift comes to after the last decay by which what lies there may differ from it."""
NOTED_ZERO, LARGE_ZERO = 0.05, 0.5
"""Shares of the peak at which an offset that is taken off is noted, and at which the range was ill used."""
NOTED_SHIFT = 0.01
"""Share of the peak from which on a shift of the zero is worth a word."""
TIME_CONSTANTS, FASTEST = 40, 0.3
"""Time constants of a decay of the zero that are tried, and swings that the shortest lasts."""
MOST_LOOKED_AT = 4000
"""Samples of a free decay in which its zero is looked for."""
OWN_SIZE = 0.3
"""Share of a decay that is left of the zero without AC coupling of its time constant, or beside it, at most."""
FEW, TOO_FEW = 8.0, 6.0
"""Samples of a swing at which a parabola through three may miss 0.9 and 2.6 % of a top; below six none is round."""
COUNTS = 0.2
"""Share of the peak that a mode must have for its samples to count."""
LOWER, FEWEST_OF_TOPS = 0.6, 4
"""Share of the peak below which a limit that takes 5 % off it leaves the samples as they are, and samples above it."""
MISSES, WORSE = 3.0, 1.5
"""Times what the modes miss of the lower samples that the tops must lack, and that they must miss of all samples where
these are fitted too: a mode that is not known is missed in both."""
SPIKE = 0.4
"""Share of itself by which a top stands off the cubic through its neighbours: a sine of five samples has 0.32."""


@dataclass(frozen=True, eq=False)
class ExaminedResponse(SampledRecord):
    """A response channel with what was measured of it; see `SampledRecord`.

    Attributes
    ----------
    blows : sequence of BaseBlow
        Of the base.
    responses : sequence of MeasuredResponse
        As `measure_responses` gives them: at least one.
    base : ndarray or None
        Samples of the base, at the same times; None where they are not.
    """

    blows: Sequence[BaseBlow] = ()
    responses: Sequence[MeasuredResponse] = ()
    base: Array | None = None

    @cached_property
    def largest(self) -> MeasuredResponse:
        """The response with the highest peak."""
        return max(self.responses, key=lambda one: abs(one.peak))

    @cached_property
    def peak(self) -> float:
        """The lowest of the peaks: what a level does is largest for it."""
        return min(abs(one.peak) for one in self.responses)

    @cached_property
    def first(self) -> int:
        """The sample at which the first blow begins."""
        return self.place(self.blows[0].begin)

    @cached_property
    def above(self) -> Array:
        """The values over the zero."""
        return self.values - self.largest.zero

    @cached_property
    def noise(self) -> float:
        """Standard deviation of what lies before the first blow, of any colour; where little does, of white noise."""
        if self.first < FEWEST:
            return sample_noise(self.values)
        rounding = _resolution(self.values) / math.sqrt(12.0)
        return max(MAD_TO_SIGMA * float(np.median(np.abs(self.above[: self.first]))), rounding)

    @cached_property
    def period(self) -> float:
        """A swing of the strongest mode, s; where none is known, twice the mean time between crossings of the zero."""
        one = self.largest
        if one.modes:
            return 1.0 / one.modes[0].frequency
        part = self.above[self.place(one.begin) : self.place(one.begin + one.duration) + 1]
        crossings = int(np.count_nonzero(np.diff(np.signbit(part))))
        return 2.0 * max(one.duration, self.step) / max(crossings, 1)

    def span(self, one: MeasuredResponse) -> tuple[int, int]:
        """Return first sample of what follows a blow, and the one after the last."""
        begin = self.place(self.blows[one.blow - 1].begin)
        later = [self.place(blow.begin) for blow in self.blows if blow.begin > self.blows[one.blow - 1].begin]
        return begin, min(later, default=self.values.size)

    def driven(self, end: int) -> Array | None:
        """Return the base up to a sample, and what it makes of each mode there; None where there is no base beside it.

        Ramp-invariant, as shock response spectra are.
        """
        from scipy.signal import lfilter

        if self.base is None or self.base.size != self.values.size or not self.largest.modes:
            return None
        base = self.base[:end] - zero_before(self.base, self.first)
        columns = [base]
        for mode in self.largest.modes:
            natural = 2.0 * math.pi * mode.frequency / math.sqrt(1.0 - mode.damping**2)
            w = np.array([natural * self.step])
            decay, stiffness, *weights = recursion(w, mode.damping, acceleration(w, mode.damping))
            poles = [1.0, float(stiffness[0] - 1.0 - decay[0]), float(decay[0])]
            columns.append(lfilter([float(weight[0]) for weight in weights], poles, base))
        return np.stack(columns, axis=1)

    def against(self, values: Array) -> dict[str, float]:
        """Return what the figures are off against those of other values, the largest of all blows."""
        others = measure_responses(values, self.step, self.start, self.blows)
        effects: dict[str, float] = {}
        for one, other in zip(self.responses, others, strict=True):
            pairs = {name: (getattr(one, name), getattr(other, name)) for name in ("peak", "duration", "rms")}
            found = {name: abs(a / b) - 1.0 for name, (a, b) in pairs.items() if b}
            found["delay"] = (one.delay - other.delay) / self.period
            if one.modes and other.modes:
                for name in ("frequency", "damping"):
                    found[name] = getattr(one.modes[0], name) / getattr(other.modes[0], name) - 1.0
            effects = {
                name: max(effects.get(name, 0.0), found.get(name, 0.0), key=abs) for name in {**effects, **found}
            }
        return effects

    def moved_by(self, reach: float) -> dict[str, float]:
        """Return what values that may be off by so much do to the figures, the largest of all blows."""
        effects = {"peak": reach / self.peak, "delay": 0.0, "duration": 0.0, "rms": 0.0}
        for one in self.responses:
            begin, end = self.span(one)
            size = np.abs(self.above[begin:end])
            spans = [_above(size, EFFECTIVE * abs(one.peak) + sign * reach) for sign in (1.0, -1.0)]
            for first, last in spans if one.duration > 0.0 and one.rms > 0.0 else ():
                longer = (last - first) * self.step / one.duration - 1.0
                stronger = math.sqrt(float(np.mean(size[first : last + 1] ** 2))) / one.rms - 1.0
                effects["duration"] = max(effects["duration"], abs(longer))
                effects["rms"] = max(effects["rms"], abs(stronger))
            ties = np.flatnonzero(size > abs(one.peak) - 2.0 * reach)
            away = np.abs(ties - (one.time - self.start) / self.step + begin) * self.step / self.period
            effects["delay"] = max(effects["delay"], float(np.max(away[away > HARMED], initial=0.0)))
            effects["rms"] = max(effects["rms"], 0.5 * (reach / COVERAGE / one.rms) ** 2 if one.rms else 0.0)
        return effects


def _above(size: Array, level: float) -> tuple[int, int]:
    """Return the first and the last sample whose magnitude is above a level."""
    above = np.flatnonzero(size > level)
    return (int(above[0]), int(above[-1])) if above.size else (0, 0)


def _larger(effects: Mapping[str, float], others: Mapping[str, float]) -> dict[str, float]:
    """Return effects, with those of others where figures jump and they are larger."""
    jumping = {name: max(effects.get(name, 0.0), others[name], key=abs) for name in JUMPING}
    return {**effects, **jumping}


def _finding(
    code: str, message: str, value: float, effects: Mapping[str, float], signed: bool = True, start: float = math.nan
) -> HealthNotice:
    """Return a finding by what it does; one that only makes a timing uncertain withholds that, and nothing else."""
    found = by_effect(code, message, value, effects, signed, start=start, figures=RESPONSE_FIGURES)
    return dataclasses.replace(found, severity="good") if set(found.harms) <= set(JUMPING) else found


def nothing(record: ExaminedResponse) -> list[HealthNotice]:
    """Find that the channel does not answer the blow of its base."""
    before = record.above[: record.first]
    level = max(STANDS_OUT * record.noise, OVER_BEFORE * float(np.max(np.abs(before), initial=0.0)))
    highest = abs(record.largest.peak)
    if highest > level:
        return []
    message = (
        f"after the blows of the base the channel reaches {record.text(highest)}, no more than before them: it is not "
        "connected, or does not answer"
    )
    return [HealthNotice("no-response", message, highest, severity="bad", harms=RESPONSE_FIGURES)]


def clipped(record: ExaminedResponse) -> list[HealthNotice]:
    """Find where the channel stops at one value again and again: the recorder's range ended there."""
    findings = []
    for sign in (1.0, -1.0):
        at = rail(sign * record.values, sign * record.largest.zero)
        if at.size:
            level = float(record.values[at[0]])
            lasts = at.size * record.step * 1e6
            message = f"clipped at {record.text(level)} for {lasts:.4g} us: the true peak is larger"
            begin, end = (record.time(int(k)) for k in (at[0], at[-1]))
            findings.append(
                HealthNotice("clipped", message, level, severity="bad", harms=RESPONSE_FIGURES, start=begin, end=end)
            )
    return findings


def saturated(record: ExaminedResponse) -> list[HealthNotice]:
    """Find tops flatter than those of swings: an amplifier at its limit."""
    begin, end = record.span(record.largest)
    flat = _flat(record.above[begin:end], record.noise + 0.5 * _resolution(record.values))
    if flat is None:
        return []
    message = (
        f"the highest top is flat for {percent(flat[0], 0)} of its half swing (a sine's for {percent(flat[1], 0)}): "
        "the sensor or an amplifier may have saturated; the true peak is larger"
    )
    return [HealthNotice("flat-top", message, flat[0], harms=RESPONSE_FIGURES, start=record.largest.time)]


def compressed(record: ExaminedResponse) -> list[HealthNotice]:
    """Find tops that are lower than the modes, driven by the base, would make them: a limit that is soft.

    Fitted are the base and the absolute accelerations of the modes on it to the samples below `LOWER` of the peak, so
    that only the level is carried on. What they miss of these is the doubt.
    """
    one = record.largest
    begin, end = record.span(one)
    end = min(end, record.place(one.decay[1]) + 1)
    through = record.driven(end)
    if through is None:
        return []
    values = record.above[begin:end]
    low = np.abs(values) < LOWER * abs(one.peak)
    if np.count_nonzero(~low) < FEWEST_OF_TOPS or np.count_nonzero(low) < FEWEST:
        return []
    columns = through[begin:end]
    shares = np.linalg.lstsq(columns[low], values[low], rcond=None)[0]
    model = columns @ shares
    missed = math.sqrt(float(np.mean((model - values)[low] ** 2))) / abs(one.peak)
    lost = 1.0 - abs(one.peak) / float(np.max(np.abs(model)))
    all_missed = columns @ np.linalg.lstsq(columns, values, rcond=None)[0] - values
    worse = math.sqrt(float(np.mean(all_missed**2))) / abs(one.peak)
    if not (lost > max(NOTED_NOISE, MISSES * missed) and worse > WORSE * missed):
        return []
    message = (
        "the highest tops are lower than what the base makes of the modes that fit the lower samples: the sensor or an "
        "amplifier may have saturated"
    )
    effects = {**record.moved_by(lost * abs(one.peak)), "peak": -lost}
    found = _finding("flat-top", message, lost, effects, start=one.time)
    return [dataclasses.replace(found, harms=RESPONSE_FIGURES) if found.severity != "good" else found]


def slew_limited(record: ExaminedResponse) -> list[HealthNotice]:
    """Find slopes that stay at one value where those of swings turn: the amplifier could not follow."""
    begin, end = record.span(record.largest)
    lag = max(round(record.period / LAG / record.step), 1)
    part = record.above[begin:end]
    if part.size <= 4 * lag:
        return []
    noise = math.sqrt(2.0) * (record.noise + 0.5 * _resolution(record.values))
    flat = _flat(part[lag:] - part[:-lag], noise)
    if flat is None:
        return []
    message = (
        f"the steepest slope stays the same for {percent(flat[0], 0)} of its half swing (a sine's for "
        f"{percent(flat[1], 0)}): the amplifier was too slow (slew rate); the true peak is larger"
    )
    return [HealthNotice("slew-rate", message, flat[0], harms=RESPONSE_FIGURES, start=record.largest.begin)]


def _flat(values: Array, noise: float) -> tuple[float, float] | None:
    """Return for how much of a half swing the highest tops are flat, and a sine's; None if no flatter."""
    edges = np.flatnonzero(np.diff(np.signbit(values))) + 1
    tops = []
    for part in np.split(np.abs(values), edges):
        height = float(np.max(part))
        if not height > 0.0 or part.size < 4:
            continue
        depth = min(TOP + NOISES_OF_TOP * noise / height, DEEPEST_TOP)
        high = np.flatnonzero(part >= (1.0 - depth) * height)
        share = float(high[-1] - high[0] + 1) / part.size
        tops.append((height, share, 1.0 - 2.0 / math.pi * math.asin(1.0 - depth)))
    tops = sorted((top for top in tops if top[0] > HIGH_TOPS * max(tops)[0]), reverse=True)
    if not tops:
        return None
    near = SAME_LEVEL * tops[0][0] + NOISES_OF_TOP * noise
    alike = [top for top in tops if tops[0][0] - top[0] < near]
    share, usual = (float(np.median([top[k] for top in alike])) for k in (1, 2))
    return (share, usual) if share - usual > (FLATTER if len(alike) > 1 else FLAT_ALONE) else None


def coarse(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a converter whose steps are large beside the response."""
    resolution = _resolution(record.values)
    reach = 0.5 * resolution
    if reach < COARSE * record.peak:
        return []
    message = (
        f"the steps of the converter are {record.text(resolution)}, {percent(resolution / record.peak)} of the peak"
    )
    return [_finding("coarse", message, resolution, record.moved_by(reach), signed=False)]


def _resolution(values: Array) -> float:
    """Return the smallest step between values; 0 where there is none."""
    known = np.unique(values)
    steps = np.diff(known)
    steps = steps[steps > UNIQUE * float(np.ptp(known))]
    return float(np.min(steps)) if steps.size else 0.0


def offset(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a zero that is far off."""
    zero = record.largest.zero
    share = abs(zero) / record.peak
    if share < NOTED_ZERO:
        return []
    message = f"the zero stands at {record.text(zero)}, {percent(share)} of the peak; it is taken off"
    return [HealthNotice("not-settled", message, zero, severity="suspect" if share > LARGE_ZERO else "good")]


def shifted(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a zero that drifts, shifts with the blow, or decays as AC coupling makes it; measure again without that.

    A slope before the blow that noise made, carried on, makes a shift: one must be there without it, too.
    """
    places = np.arange(record.values.size)
    line = _line_before(record)
    findings = []
    straight = record.above
    if line is not None:
        drift = line[1] * (record.values.size - 1)
        straight = record.above - line[1] * (places - 0.5 * (record.first - 1))
        message = (
            f"before the blow the zero drifts, by {record.text(drift)} over a length of the record, "
            f"{percent(abs(drift) / record.peak)} of the peak"
        )
        end = record.place(record.largest.begin + record.largest.duration)
        effects = _larger(record.against(straight), record.moved_by(abs(line[1]) * (end - 0.5 * record.first)))
        findings = [_finding("drift", message, drift, effects)] if abs(drift) > NOTED_SHIFT * record.peak else []
    afters = [
        (above, _zero_after(record, above)) for above in ((record.above, straight) if findings else (record.above,))
    ]
    found = [(above, after) for above, after in afters if after is not None]
    if len(found) < len(afters):
        return findings
    return findings + _shifted_after(record, *min(found, key=lambda pair: abs(pair[1][1] + pair[1][2])))


def _shifted_after(
    record: ExaminedResponse, above: Array, after: tuple[int, float, float, float]
) -> list[HealthNotice]:
    """Tell a zero that has shifted with the last blow from one that decays after it, and what that does."""
    places = np.arange(above.size)
    begin, level, decay, constant = after
    since = np.maximum((places - begin) * record.step, 0.0)
    curve = level + decay * np.exp(-since / constant)
    size = float(np.max(np.abs(curve[begin:])))
    share = size / record.peak
    if share < NOTED_SHIFT:
        return []
    start = record.blows[-1].end
    if decay and abs(level) < OWN_SIZE * abs(decay) and _is_coupled(record, above, decay, constant):
        message = (
            f"after the blow the zero decays from {record.text(decay)} as a high-pass of "
            f"{1.0 / (2.0 * math.pi * constant):.4g} Hz makes it (AC coupling)"
        )
        effects = record.against(ac_uncoupled(above, record.step, constant))
        effects = _larger(effects, record.moved_by(size))
        return [_finding("ac-coupling", message, constant, effects, start=start)]
    ramp = np.clip((places - record.span(record.responses[-1])[0]) / max(begin - record.first, 1), 0.0, 1.0)
    message = f"after the blow the zero has shifted by {record.text(level + decay)}, {percent(share)} of the peak"
    if decay:
        message += f", and comes back with a time constant of {1e3 * constant:.3g} ms"
    effects = {name: abs(effect) for name, effect in record.against(above - ramp * curve).items()}
    effects = _larger({**effects, "peak": max(effects.get("peak", 0.0), share)}, record.moved_by(size))
    return [_finding("zero-shift", message, level + decay, effects, signed=False, start=start)]


def _line_before(record: ExaminedResponse) -> tuple[float, float] | None:
    """Return level and slope a sample of what lies before the first blow; None where no slope is significant.

    Noise with a long memory makes slopes too: where much follows the last decay, it must lie where the line leads.
    """
    before = record.above[: record.first]
    if before.size < 2 * FEWEST:
        return None
    place = np.arange(before.size) - 0.5 * (before.size - 1)
    power = float(np.sum(place**2))
    slope = float(np.sum(place * before)) / power
    rest = before - np.mean(before) - slope * place
    error = math.sqrt(float(np.mean(rest**2)) * alike_as_one(rest) / power)
    if not abs(slope) > SLOPED * error:
        return None
    last = record.place(record.responses[-1].decay[1])
    tail = record.above[last:]
    if tail.size >= 2 * FEWEST:
        expected = slope * (last + 0.5 * tail.size - 0.5 * record.first)
        if abs(float(np.mean(tail)) - expected) > CARRIED_ON * abs(expected):
            return None
    return float(np.mean(before)), slope


class _FreeDecay(NamedTuple):
    """The last free decay: where it begins, values and times since then, and cosines and sines of its modes."""

    begin: int
    values: Array
    since: Array
    swinging: Array

    def beside(self, *more: Array) -> tuple[float, Array, Array]:
        """Fit the modes with further columns; return squares left, amplitudes, and what is left."""
        columns = np.hstack([self.swinging, *(column[:, None] for column in more)])
        found = np.asarray(np.linalg.lstsq(columns, self.values, rcond=None)[0], dtype=np.float64)
        rest = np.asarray(self.values - columns @ found, dtype=np.float64)
        return float(rest @ rest), found, rest

    def decayed(self, constant: float) -> tuple[float, Array, Array]:
        """Fit the modes with a constant and a decay."""
        return self.beside(np.ones(self.values.size), np.exp(-self.since / constant))


def _free_decay(record: ExaminedResponse, above: Array) -> _FreeDecay | None:
    """Return the last free decay, thinned, to the end of the record; None where it is too short."""
    one = record.responses[-1]
    begin, end = record.place(one.decay[0]), record.values.size
    if end - begin < 2 * FEWEST:
        return None
    every = max((end - begin) // MOST_LOOKED_AT, 1)
    values = above[begin:end:every]
    since = np.asarray(record.step * every * np.arange(values.size), dtype=np.float64)
    waves = [np.empty((values.size, 0))]
    for mode in one.modes:
        wave = np.exp(since * (-1.0 / mode.decay_time + 2j * np.pi * mode.frequency))
        waves.append(np.stack([wave.real, wave.imag], axis=1))
    return _FreeDecay(begin, values, since, np.hstack(waves))


def _zero_after(record: ExaminedResponse, above: Array) -> tuple[int, float, float, float] | None:
    """Return where the last free decay begins, and level, decay and its time constant of the zero from there on.

    Fitted beside the modes: a constant, or a constant and a decay that explains more. None where neither stands out.
    """
    from scipy.optimize import minimize_scalar

    part = _free_decay(record, above)
    if part is None:
        return None
    plain, only = part.beside(), part.beside(np.ones(part.values.size))
    first, last = FASTEST * record.period, 0.5 * float(part.since[-1])
    constants = np.geomspace(first, last, TIME_CONSTANTS) if last > 2.0 * record.period else np.empty(0)
    if constants.size:
        best = int(np.argmin([part.decayed(float(constant))[0] for constant in constants]))
        low, high = constants[max(best - 1, 0)], constants[min(best + 1, constants.size - 1)]
        found = minimize_scalar(lambda size: part.decayed(math.exp(size))[0], bounds=(math.log(low), math.log(high)))
        constant = math.exp(found.x)
        fit = part.decayed(constant)
        if _explains(only, fit):
            return part.begin, float(fit[1][-2]), float(fit[1][-1]), constant
    return (part.begin, float(only[1][-1]), 0.0, math.inf) if _explains(plain, only) else None


def _is_coupled(record: ExaminedResponse, above: Array, decay: float, constant: float) -> bool:
    """Tell whether a decay of the zero is that of AC coupling: without it the zero then stands where it did before.

    A decay of another kind leaves a shift, as it is not as large as the area before demands.
    """
    part = _free_decay(record, ac_uncoupled(above, record.step, constant))
    return part is not None and abs(float(part.beside(np.ones(part.values.size))[1][-1])) < OWN_SIZE * abs(decay)


def _explains(before: tuple[float, Array, Array], fit: tuple[float, Array, Array]) -> bool:
    """Tell whether a fit leaves so much less than the one before that it is no chance, whatever the colour."""
    squares, _, rest = fit
    return before[0] - squares > SHIFTED**2 * squares / rest.size * alike_as_one(rest, 0.99)


def hum(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a line of the mains beside the response."""
    spans = [(record.blows[one.blow - 1].begin, one.begin + one.duration) for one in record.responses]
    found = hum_beside(record.values, record.step, record.start, spans)
    if found is None or found[1] < NOTED_HUM * record.peak:
        return []
    frequency, amplitude = found
    message = f"hum of {frequency:g} Hz, {percent(amplitude / record.peak)} of the peak"
    return [_finding("hum", message, amplitude, record.moved_by(amplitude), signed=False)]


def noise(record: ExaminedResponse) -> list[HealthNotice]:
    """Find noise of any colour, or motion before the blow, that moves the figures."""
    reach = COVERAGE * record.noise
    effects = record.moved_by(reach)
    if max(effects["peak"], effects["rms"]) < NOTED_NOISE and not any(effects[name] > HARMED for name in JUMPING):
        return []
    message = f"before the blow the channel scatters by {record.text(record.noise)}"
    return [_finding("noise", message, record.noise, effects, signed=False)]


def few_samples(record: ExaminedResponse) -> list[HealthNotice]:
    """Find swings of few samples: between two of them the peak is missed."""
    modes = [mode for one in record.responses for mode in one.modes if mode.amplitude > COUNTS * abs(one.peak)]
    if not modes:
        return []
    count = 1.0 / (max(mode.frequency for mode in modes) * record.step)
    if count >= FEW:
        return []
    message = f"a swing of {1.0 / (count * record.step):.4g} Hz has {count:.1f} samples; sample faster"
    effects = {**record.moved_by(_missed(count) * record.peak), "peak": -_missed(count)}
    return [_finding("few-samples", message, count, effects)]


def _missed(count: float) -> float:
    """Return by how much the top of a sine of so many samples a swing may be missed.

    Examples
    --------
    >>> round(_missed(8.0), 4), round(_missed(5.0), 2)
    (0.0085, 0.19)
    """
    beside, far = math.cos(math.pi / count), math.cos(3.0 * math.pi / count)
    if far < ROUND * beside and count < TOO_FEW:
        return 1.0 - beside
    return 1.0 - beside - 0.125 * (beside - far)


def aliased(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    one = record.largest
    begin, end = record.span(one)
    last = min(max(record.place(one.decay[1]), begin + 2 * FEWEST), end)
    first = max(begin - (last - begin), 0)  # a window of its own length before it: the onset is in its middle
    level = folded_level(record.above[first:last], record.noise)
    if level is None:
        return []
    message = (
        f"at half the sampling rate the spectrum still has {percent(level)} of its largest value: what lies above was "
        "folded into the record; sample faster or filter before"
    )
    return [HealthNotice("alias", message, level, harms=RESPONSE_FIGURES)]


def spike(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a peak of one sample that its neighbours know nothing of."""
    for one in record.responses:
        top = record.place(one.time)
        if not 2 <= top < record.values.size - 2:
            continue
        far, near, value = (
            float(record.above[top - 2] + record.above[top + 2]),
            float(record.above[top - 1] + record.above[top + 1]),
            float(record.above[top]),
        )
        if abs(value - (4.0 * near - far) / 6.0) > max(SPIKE * abs(value), STANDS_OUT * record.noise):
            message = f"at {one.time:.6g} s one sample stands off its neighbours, at {record.text(value)}: a spike"
            return [HealthNotice("spike", message, value, severity="bad", harms=RESPONSE_FIGURES, start=one.time)]
    return []


def cut(record: ExaminedResponse) -> list[HealthNotice]:
    """Find responses that have not fallen below a third of their peak when the record ends, or the next blow comes."""
    open_ = []
    for one in record.responses:
        end = record.span(one)[1]
        if record.start + end * record.step - (one.begin + one.duration) < 0.5 * record.period + record.step:
            open_.append((one, end == record.values.size))
    if not open_:
        return []
    one, at_end = open_[0]
    what = "the record ends" if at_end else "the next blow comes"
    several = f" ({len(open_)} of {len(record.responses)} responses)" if len(record.responses) > 1 else ""
    message = f"{what} before the response falls below a third of its peak{several}: it lasts longer"
    end_time = one.begin + one.duration
    return [HealthNotice("cut", message, end_time, harms=("duration", "rms"), start=end_time)]


def short_before(record: ExaminedResponse) -> list[HealthNotice]:
    """Find that too little lies before the first blow to know the zero and the noise."""
    if record.first >= FEWEST:
        return []
    message = (
        f"only {record.first} samples lie before the first blow: the zero is the median of the whole record, and what "
        "drift, hum and noise do to the figures cannot be known"
    )
    return [HealthNotice("short-pretrigger", message, record.first, severity="good", end=record.blows[0].begin)]


RESPONSE_CHECKS: tuple[Callable[[ExaminedResponse], list[HealthNotice]], ...] = (
    clipped,
    saturated,
    compressed,
    slew_limited,
    spike,
    coarse,
    offset,
    shifted,
    hum,
    noise,
    few_samples,
    aliased,
    cut,
    short_before,
)
"""Every check of a channel that answers, in the order of their findings."""


def examine_response(record: ExaminedResponse) -> list[HealthNotice]:
    """Return everything that is wrong with a response channel, the worst first.

    Examples
    --------
    >>> blows = [BaseBlow(2e-3, 3e-3, 4e-3, 1.0)]
    >>> still = np.full(1000, 3.0)
    >>> record = ExaminedResponse(still, 1e-5, 0.0, "", blows, measure_responses(still, 1e-5, 0.0, blows))
    >>> [finding.code for finding in examine_response(record)]
    ['dead']
    """
    if float(np.ptp(record.values)) == 0.0:
        message = f"every sample is {record.text(record.values[0])}: the channel is dead or not connected"
        return [HealthNotice("dead", message, float(record.values[0]), severity="bad", harms=RESPONSE_FIGURES)]
    silent = nothing(record)
    return silent or worst_first(finding for check in RESPONSE_CHECKS for finding in check(record))
