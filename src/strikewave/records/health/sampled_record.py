"""A record as the checks of its health take it: with its blows, or with its responses to the blows of another channel.

What a fault does to a response is found by measuring again: without it, where the record tells it, else at levels that
differ by as much as the fault may move them. An effect on the delay is over a swing of the strongest mode.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, TypeVar

import numpy as np

from strikewave.base.constants import COVERAGE
from strikewave.base.shock_quantities import ACCELERATION
from strikewave.base.units import in_unit
from strikewave.records.contacts import MAD_TO_SIGMA, Baseline, Contacts, robust_line, sample_noise
from strikewave.records.health_notice import FIGURES, OF_BLOWS, OF_RESPONSES, RESPONSE_FIGURES
from strikewave.records.measuring import RecordedPulse, contacts_of, find_pulses
from strikewave.records.record import Array
from strikewave.records.response import EFFECTIVE, FEWEST, BaseBlow, MeasuredResponse, measure_responses, zero_before
from strikewave.records.tail import TailModel, model_of, tail_of, uncoupled
from strikewave.records.thresholds import HARMED
from strikewave.signal.oscillators import acceleration, recursion

Made = TypeVar("Made")
# Widths before the first blow whose scatter is taken, of 16 samples at least: known to a fifth, and no drift in it
BEFORE, FEWEST_BEFORE = 2.0, 16
# Shares and samples of both ends: short beside a pre-trigger, so that a cut blow fills them
BEGINNING, FEWEST_OF_PART = 20, 8
# Figures that jump where two tops differ by less than the noise: they are withheld, and the channel is not suspect
JUMPING = ("delay", "duration", "rms")
UNIQUE = 1e-9  # share of the span below which two values are one: the rounding of a calibration


def effects_of_level(pulse: RecordedPulse, level: float, after_peak: bool = False) -> dict[str, float]:
    """Return what a level added under a blow does to its figures, over themselves.

    With ``after_peak`` the level is there from the peak on only: one foot stands on it, and half of the area.
    """
    share = level / pulse.peak
    half = 0.5 if after_peak else 1.0
    width = share * pulse.smooth.width_slope() / pulse.width if pulse.width > 0.0 else math.nan
    area = level * (pulse.end - pulse.begin) / pulse.velocity_change if pulse.velocity_change else math.nan
    effects = {"peak": share, "width": half * width, "velocity_change": half * area}
    return {name: effect for name, effect in effects.items() if math.isfinite(effect)}


def with_unit(value: float, unit: str) -> str:
    r"""Write a value with its SI unit: accelerations in g, times in us or ms, frequencies in Hz or kHz."""
    if unit == "m/s^2":
        return f"{in_unit(value, *ACCELERATION.units):.5g}\xa0g"
    if unit == "s":
        return f"{1e6 * value:.4g}\xa0us" if abs(value) < 1e-3 else f"{1e3 * value:.4g}\xa0ms"
    if unit == "Hz":
        return f"{value:.4g}\xa0Hz" if abs(value) < 1e4 else f"{1e-3 * value:.4g}\xa0kHz"
    if unit == "1":
        return f"{1e6 * value:.5g} ustrain"
    return f"{value:.5g} {unit}".strip()


@dataclass(frozen=True, eq=False)
class SampledRecord:
    """A uniformly sampled record."""

    kind: ClassVar[str]  # object of the checks that apply to it, such as the blows; see `Check.of`
    figures: ClassVar[tuple[str, ...]]  # figures that notices on it may harm
    jumping: ClassVar[tuple[str, ...]] = ()  # figures that may be uncertain without the record being suspect for it

    values: Array  # finite samples
    # Time between samples, and of the first, s
    step: float
    start: float = 0.0
    unit: str = ""  # SI unit of the values; empty where it is not known

    @cached_property
    def _made(self) -> dict[Callable[[Any], Any], Any]:
        return {}

    def once(self, made: Callable[[Any], Made]) -> Made:
        """Return what a function makes of the record: what several checks look at is made once."""
        if made not in self._made:
            self._made[made] = made(self)
        return self._made[made]

    def text(self, value: float) -> str:
        """Write a value with its unit: accelerations in g."""
        return with_unit(value, self.unit)

    def time(self, place: float) -> float:
        """Return the time of a sample, s."""
        return self.start + self.step * place

    def place(self, time: float) -> int:
        """Return the sample nearest to a time, inside the record."""
        return min(max(round((time - self.start) / self.step), 0), self.values.size - 1)


@dataclass(frozen=True, eq=False)
class BlowRecord(SampledRecord):
    """A record with the blows found in it; see `SampledRecord`."""

    kind = OF_BLOWS
    figures = FIGURES

    pulses: tuple[RecordedPulse, ...] = ()  # as `find_pulses` gives them
    drop_height: float = math.nan  # stated height of the fall before the blow, m; NaN where none was stated

    @property
    def largest(self) -> RecordedPulse | None:
        """The blow with the highest peak."""
        return max(self.pulses, key=lambda pulse: abs(pulse.peak), default=None)

    @cached_property
    def line(self) -> Baseline:
        """The baseline of the whole record."""
        return robust_line(self.values)

    @cached_property
    def contacts(self) -> Contacts:
        """Relation of the blows to one another: a train, double hits."""
        return contacts_of(self.pulses)

    def next_begin(self, pulse: RecordedPulse) -> float:
        """Return when the first of the blows begins that end after one, s; infinite where none does."""
        ends, begins = self._begins_by_end
        return float(begins[np.searchsorted(ends, pulse.end, side="right")])

    @cached_property
    def _begins_by_end(self) -> tuple[Array, Array]:
        """Ends of the blows, rising, and with each the first begin of those that end then or later, s."""
        ordered = sorted((pulse.end, pulse.begin) for pulse in self.pulses)
        ends, begins = np.array([*ordered, (math.inf, math.inf)]).T
        return ends, np.minimum.accumulate(begins[::-1])[::-1]

    @cached_property
    def tail(self) -> TailModel | None:
        """Model of the zero after the blows; None where too little follows them."""
        tail = tail_of(self.values, self.step, self.start, self.pulses)
        return None if tail is None else model_of(tail)

    @cached_property
    def uncoupled_pulses(self) -> tuple[RecordedPulse, ...]:
        """The blows without AC coupling, where that is recognised and leaves as many."""
        if self.tail is None or self.tail.kind != "ac-coupling":
            return ()
        values = uncoupled(self.values, self.step, self.start, self.pulses, self.tail.constant)
        pulses = tuple(find_pulses(values, self.step, self.start))
        return pulses if len(pulses) == len(self.pulses) else ()

    def ringing_as_uncoupled(self) -> BlowRecord:
        """Return the record with the pulses without ringing that are fitted without its AC coupling, where it has any.

        An undershoot is no ringing. What is known of the tail holds on: no pulse without ringing is in it.
        """
        if not self.uncoupled_pulses:
            return self
        pairs = zip(self.pulses, self.uncoupled_pulses, strict=True)
        seen = replace(self, pulses=tuple(replace(pulse, rigid=other.rigid) for pulse, other in pairs))
        vars(seen).update(tail=self.tail, uncoupled_pulses=self.uncoupled_pulses)
        return seen

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the white noise of a sample."""
        return sample_noise(self.values)

    @cached_property
    def scatter(self) -> float:
        """Standard deviation of noise of any colour: of what lies before the first blow, where some does."""
        if not self.pulses:
            return self.noise
        first = min(self.pulses, key=lambda pulse: pulse.begin)
        width = first.width if first.width > 0.0 else first.smooth.width()
        last = self.place(first.begin - width)
        before = self.values[max(last - max(round(BEFORE * width / self.step), FEWEST_BEFORE), 0) : last]
        return max(self.noise, float(np.std(before)) if before.size >= FEWEST_BEFORE else 0.0)


@dataclass(frozen=True, eq=False)
class ResponseRecord(SampledRecord):
    """A response channel with what was measured of it; see `SampledRecord`."""

    kind = OF_RESPONSES
    figures = RESPONSE_FIGURES
    jumping = JUMPING

    blows: Sequence[BaseBlow] = ()  # blows of the base
    responses: Sequence[MeasuredResponse] = ()  # as `measure_responses` gives them: at least one
    base: Array | None = None  # samples of the base, at the same times; None where they are not

    @cached_property
    def largest(self) -> MeasuredResponse:
        """The response with the highest peak."""
        return max(self.responses, key=lambda response: abs(response.peak))

    @cached_property
    def peak(self) -> float:
        """The lowest of the peaks: what a level does is largest for it."""
        return min(abs(response.peak) for response in self.responses)

    @cached_property
    def first(self) -> int:
        """The sample at which the first blow begins."""
        return self.place(self.blows[0].begin)

    @cached_property
    def above(self) -> Array:
        """The values over the zero."""
        return self.values - self.largest.zero

    @cached_property
    def resolution(self) -> float:
        """The smallest step between values, of the converter; 0 where there is none."""
        known = np.unique(self.values)
        steps = np.diff(known)
        steps = steps[steps > UNIQUE * float(np.ptp(known))]
        return float(np.min(steps)) if steps.size else 0.0

    @cached_property
    def noise(self) -> float:
        """Standard deviation of what lies before the first blow, of any colour; where little does, of white noise."""
        if self.first < FEWEST:
            return sample_noise(self.values)
        rounding = self.resolution / math.sqrt(12.0)
        return max(MAD_TO_SIGMA * float(np.median(np.abs(self.above[: self.first]))), rounding)

    @cached_property
    def period(self) -> float:
        """A swing of the strongest mode, s; where none is known, twice the mean time between crossings of the zero."""
        response = self.largest
        if response.modes:
            return 1.0 / response.modes[0].frequency
        part = self.above[self.place(response.begin) : self.place(response.begin + response.duration) + 1]
        crossings = int(np.count_nonzero(np.diff(np.signbit(part))))
        return 2.0 * max(response.duration, self.step) / max(crossings, 1)

    def span(self, response: MeasuredResponse) -> tuple[int, int]:
        """Return first sample of what follows a blow, and the one after the last."""
        begin = self.place(self.blows[response.blow - 1].begin)
        later = [self.place(blow.begin) for blow in self.blows if blow.begin > self.blows[response.blow - 1].begin]
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
        for response, other in zip(self.responses, others, strict=True):
            pairs = {name: (getattr(response, name), getattr(other, name)) for name in ("peak", "duration", "rms")}
            changes = {name: abs(a / b) - 1.0 for name, (a, b) in pairs.items() if b}
            changes["delay"] = (response.delay - other.delay) / self.period
            if response.modes and other.modes:
                for name in ("frequency", "damping"):
                    changes[name] = getattr(response.modes[0], name) / getattr(other.modes[0], name) - 1.0
            for name, change in changes.items():
                effects[name] = max(effects.get(name, 0.0), change, key=abs)
        return effects

    def moved_by(self, reach: float) -> dict[str, float]:
        """Return what values that may be off by so much do to the figures, the largest of all blows."""
        effects = {"peak": reach / self.peak, "delay": 0.0, "duration": 0.0, "rms": 0.0}
        for response in self.responses:
            begin, end = self.span(response)
            size = np.abs(self.above[begin:end])
            spans = [_above(size, EFFECTIVE * abs(response.peak) + sign * reach) for sign in (1.0, -1.0)]
            for first, last in spans if response.duration > 0.0 and response.rms > 0.0 else ():
                longer = (last - first) * self.step / response.duration - 1.0
                stronger = math.sqrt(float(np.mean(size[first : last + 1] ** 2))) / response.rms - 1.0
                effects["duration"] = max(effects["duration"], abs(longer))
                effects["rms"] = max(effects["rms"], abs(stronger))
            ties = np.flatnonzero(size > abs(response.peak) - 2.0 * reach)
            away = np.abs(ties - (response.time - self.start) / self.step + begin) * self.step / self.period
            effects["delay"] = max(effects["delay"], float(np.max(away[away > HARMED], initial=0.0)))
            effects["rms"] = max(effects["rms"], 0.5 * (reach / COVERAGE / response.rms) ** 2 if response.rms else 0.0)
        return effects


def _above(size: Array, level: float) -> tuple[int, int]:
    """Return the first and the last sample whose magnitude is above a level."""
    above = np.flatnonzero(size > level)
    return (int(above[0]), int(above[-1])) if above.size else (0, 0)
