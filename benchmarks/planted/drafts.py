"""A record in the making, with its truth."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import bessel, sosfilt

BESIDE = 12
"""Samples to either side of a pulse in which its filtered shape is followed."""


@dataclass(frozen=True)
class Blow:
    """What was planted, as the recorder would have it without noise and faults.

    Attributes
    ----------
    time, peak, width, velocity_change : float
        Of the rigid pulse: s, g, s at 10 % of the peak, and g s.
    raw_peak : float
        With what rings in the pulse.
    begin, end : float
        Where the pulse lies, s.
    """

    time: float
    peak: float
    width: float
    velocity_change: float
    raw_peak: float
    begin: float
    end: float


@dataclass(frozen=True)
class Setting:
    """What the pulses and the recorder of one record are like."""

    shape: object
    width: float
    peak: float
    step: float
    filtered: float
    """Cutoff of the anti-alias filter over the sampling rate; 0 for none."""

    @property
    def length(self):
        """From begin to end of a pulse, s."""
        return self.width / self.shape.width

    @property
    def per_width(self):
        """Samples in a width."""
        return self.width / self.step


@dataclass
class Draft:
    """A record while it is made: faults change its values, never its truth.

    Attributes
    ----------
    values : ndarray
        In g.
    blows : list of Blow
        In the order of time.
    faults : dict
        What was planted beside, with its strength.
    sign : int
        -1 where the whole record is turned round.
    begin_time, period : float
        Time of the first sample; from blow to blow of a train; s.
    limit : float
        Where the range of the recorder ends, g.
    zero : ndarray
        What the blows stand on: offset, drift and hum, g.
    plain : ndarray
        The values with their faults, before noise, rounding and sign; None while they are made.
    """

    setting: Setting
    values: np.ndarray
    blows: list = field(default_factory=list)
    faults: dict = field(default_factory=dict)
    sign: int = 1
    begin_time: float = 0.0
    period: float = np.nan
    limit: float = np.inf
    zero: np.ndarray = None
    plain: np.ndarray = None

    def __post_init__(self):
        """Stand at zero where nothing else is said."""
        if self.zero is None:
            self.zero = np.zeros_like(self.values)

    def lift(self, zero):
        """Add what the blows stand on."""
        self.values = self.values + zero
        self.zero = self.zero + zero

    name: str = "record"

    @property
    def time(self):
        """Of each sample from the first, s."""
        return self.setting.step * np.arange(self.values.size)

    def cut(self, first, last):
        """Keep the samples between two places; blows that are left out altogether leave the truth."""
        step = self.setting.step
        shift = first * step
        self.values, self.zero = self.values[first:last], self.zero[first:last]
        moved = [
            replace(b, time=b.time - shift, begin=b.begin - shift, end=b.end - shift)
            for b in self.blows
        ]  # fmt: skip
        self.blows = [b for b in moved if b.end > 0.0 and b.begin < self.values.size * step]


def add_pulse(values, setting, begin, peak, width):
    """Add a pulse as the recorder sees it, and return its truth, from a grid many times as fine."""
    step = setting.step
    length = width / setting.shape.width
    fineness = int(np.clip(np.ceil(400.0 * step / width), 4, 64))
    first = int(np.floor(begin / step)) - 2
    count = (int(np.ceil(length / step)) + 2 * BESIDE) * fineness
    time = first * step + step / fineness * np.arange(count)
    dense = peak * setting.shape.at((time - begin) / length)
    if setting.filtered:
        sections = bessel(8, 2.0 * setting.filtered / fineness, output="sos", norm="mag")
        dense = sosfilt(sections, dense)
    samples = dense[::fineness]
    low, high = max(first, 0), min(first + samples.size, values.size)
    if high > low:
        values[low:high] += samples[low - first : high - first]
    top = int(np.argmax(dense))
    above = time[dense >= 0.1 * dense[top]]
    area = float(np.sum(dense)) * step / fineness
    return Blow(float(time[top]), float(dense[top]), float(above[-1] - above[0]), area, float(dense[top]), begin, begin + length)  # fmt: skip


def quantised(values, span, bits):
    """Return values as a converter of so many bits over plus and minus a span has them."""
    least = 2.0 * span / 2**bits
    return np.clip(least * np.round(values / least), -span, span - least)
