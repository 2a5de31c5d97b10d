"""A response channel with what was measured of it, and what a fault moves of its figures.

What a fault does is found by measuring again: without it, where the record tells it, else at levels that differ by as
much as the fault may move them. An effect on the delay is over a swing of the strongest mode.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import COVERAGE
from strikewave.records.health.examined import SampledRecord
from strikewave.records.health_notice import HARMED, RESPONSE_FIGURES, HealthNotice, by_effect
from strikewave.records.modes import FEWEST
from strikewave.records.pulses import MAD_TO_SIGMA, sample_noise
from strikewave.records.response import EFFECTIVE, BaseBlow, MeasuredResponse, measure_responses, zero_before
from strikewave.signal.oscillators import acceleration, recursion

Array = NDArray[np.float64]

STANDS_OUT = 8.0
"""Standard deviations of what lies before that a response must reach: noise alone reaches five in a million samples."""
JUMPING = ("delay", "duration", "rms")
"""Figures that jump by half a swing, or by what it holds, where two tops, or a top and the level, differ by less than
the noise: they are then withheld, and the channel is not suspect for it."""
UNIQUE = 1e-9
"""Share of the span below which two values are one: the rounding of a calibration."""


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


def finding(
    code: str, message: str, value: float, effects: Mapping[str, float], signed: bool = True, start: float = math.nan
) -> HealthNotice:
    """Return a finding by what it does; one that only makes a timing uncertain withholds that, and nothing else."""
    found = by_effect(code, message, value, effects, signed, start=start, figures=RESPONSE_FIGURES)
    return dataclasses.replace(found, severity="good") if set(found.harms) <= set(JUMPING) else found
