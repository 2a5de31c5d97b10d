"""A record as the checks of its health take it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strikewave.base.shock_quantities import ACCELERATION
from strikewave.base.units import in_unit
from strikewave.records.coupling import uncoupled
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measuring import RecordedPulse, contacts_of, find_pulses
from strikewave.records.pulses import Baseline, robust_line, sample_noise
from strikewave.records.tail import TailModel, model_of, tail_of
from strikewave.records.trains import Contacts

Array = NDArray[np.float64]


BLOW = ("peak", "rise", "width", "velocity_change")
"""Figures of a single blow."""
BEFORE, FEWEST_BEFORE = 2.0, 16
"""Widths before the first blow whose scatter is taken, of 16 samples at least: known to a fifth, and no drift in it."""
BEGINNING, FEWEST_OF_PART = 20, 8
"""The first twentieth of a record is its beginning, and the last its end, of eight samples at least.

Chosen: short beside what a pre-trigger lasts, so that a blow that is cut fills much of it."""


def effects_of_level(pulse: RecordedPulse, level: float, after_peak: bool = False) -> dict[str, float]:
    """Return what a level added under a blow does to its figures, over themselves.

    Parameters
    ----------
    pulse : RecordedPulse
        The blow.
    level : float
        What stands under it and is not its own, in the unit of the record.
    after_peak : bool, optional
        The level is there from the peak on only: one foot stands on it, and half of the area.
    """
    share = level / pulse.peak
    half = 0.5 if after_peak else 1.0
    width = share * pulse.smooth.width_slope() / pulse.width if pulse.width > 0.0 else math.nan
    area = level * (pulse.end - pulse.begin) / pulse.velocity_change if pulse.velocity_change else math.nan
    effects = {"peak": share, "width": half * width, "velocity_change": half * area}
    return {name: effect for name, effect in effects.items() if math.isfinite(effect)}


def with_unit(value: float, unit: str) -> str:
    r"""Write a value with its SI unit: accelerations in g, times in us or ms, frequencies in Hz or kHz.

    Examples
    --------
    >>> with_unit(9806.65, "m/s^2"), with_unit(3.0, ""), with_unit(0.01032, "s"), with_unit(19893.6, "Hz")
    ('1000\xa0g', '3', '10.32\xa0ms', '19.89\xa0kHz')
    """
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
    """A uniformly sampled record.

    Attributes
    ----------
    values : ndarray
        Finite samples.
    step, start : float
        Time between samples, and of the first, s.
    unit : str
        SI unit of the values; empty where it is not known.
    """

    values: Array
    step: float
    start: float = 0.0
    unit: str = ""

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
class Examined(SampledRecord):
    """A record with the blows found in it; see `SampledRecord`.

    Attributes
    ----------
    pulses : sequence of RecordedPulse
        As `find_pulses` gives them.
    drop_height : float
        What the fall before the blow was stated to be, m; NaN where it was not.
    """

    pulses: tuple[RecordedPulse, ...] = ()
    drop_height: float = math.nan

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
        """What the blows are to one another: a train, double hits."""
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
        """What the zero does after the blows; None where too little follows them.

        Examples
        --------
        >>> from strikewave.signal.coupling import ac_coupled
        >>> u = np.arange(4000) * 1e-3 - 1.0
        >>> blow = np.where((u > 0.0) & (u < 0.1), 1e3 * np.sin(10.0 * np.pi * u), 0.0)
        >>> values = ac_coupled(blow, 1e-5, 2e-3) + np.random.default_rng(1).normal(size=4000)
        >>> found = Examined(values, 1e-5, pulses=tuple(find_pulses(values, 1e-5))).tail
        >>> found.kind, round(1e3 * found.constant, 2)
        ('ac-coupling', 2.0)
        """
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

    def ringing_as_uncoupled(self) -> Examined:
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
        """Standard deviation of noise of any colour: of what lies before the first blow, where some does.

        Examples
        --------
        >>> values = np.where(np.arange(900) < 500, 0.0, 1e3 * np.sin(np.pi * np.arange(900) / 400.0) ** 2)
        >>> slow = np.sin(0.1 * np.arange(900.0))  # the difference of neighbours is small
        >>> seen = Examined(values + slow, 1e-5, pulses=tuple(find_pulses(values + slow, 1e-5)))
        >>> seen.noise < 0.2 < 0.6 < seen.scatter < 0.8
        True
        """
        if not self.pulses:
            return self.noise
        first = min(self.pulses, key=lambda pulse: pulse.begin)
        width = first.width if first.width > 0.0 else first.smooth.width()
        last = self.place(first.begin - width)
        before = self.values[max(last - max(round(BEFORE * width / self.step), FEWEST_BEFORE), 0) : last]
        return max(self.noise, float(np.std(before)) if before.size >= FEWEST_BEFORE else 0.0)


def dead(record: SampledRecord, figures: tuple[str, ...]) -> list[HealthNotice]:
    """Find that every sample is the same; it takes all figures."""
    if float(np.ptp(record.values)):
        return []
    message = f"every sample is {record.text(record.values[0])}: the channel is dead or not connected"
    return [HealthNotice("dead", message, float(record.values[0]), severity="bad", harms=figures)]
