"""A record as the checks of its health take it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strikewave.base.units import in_unit
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulses import Baseline, robust_line, sample_noise

Array = NDArray[np.float64]


BLOW = ("peak", "rise", "width", "velocity_change")
"""Figures of a single blow."""
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
    """Write a value with its SI unit: accelerations in g.

    Examples
    --------
    >>> with_unit(9806.65, "m/s^2"), with_unit(3.0, "")
    ('1000 g', '3')
    """
    if unit == "m/s^2":
        return f"{in_unit(value, 'm/s^2', 'g'):.5g} g"
    if unit == "1":
        return f"{1e6 * value:.5g} ustrain"
    return f"{value:.5g} {unit}".strip()


@dataclass(frozen=True, eq=False)
class Examined:
    """A uniformly sampled record, with the blows found in it.

    Attributes
    ----------
    values : ndarray
        Finite samples.
    step, start : float
        Time between samples, and of the first, s.
    unit : str
        SI unit of the values; empty where it is not known.
    pulses : sequence of RecordedPulse
        As `find_pulses` gives them.
    drop_height : float
        What the fall before the blow was stated to be, m; NaN where it was not.
    """

    values: Array
    step: float
    start: float = 0.0
    unit: str = ""
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
    def noise(self) -> float:
        """Standard deviation of the white noise of a sample."""
        return sample_noise(self.values)

    def text(self, value: float) -> str:
        """Write a value with its unit: accelerations in g."""
        return with_unit(value, self.unit)

    def time(self, place: float) -> float:
        """Return the time of a sample, s."""
        return self.start + self.step * place

    def place(self, time: float) -> int:
        """Return the sample nearest to a time, inside the record."""
        return min(max(round((time - self.start) / self.step), 0), self.values.size - 1)
