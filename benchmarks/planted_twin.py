"""Whether a faulty record can be told from a sound one at all: its sound twin, and how far apart they are.

The twin is the pulse of the sound classes, as the same recorder takes it, that is nearest to the faulty record before
noise. Of two known records in the same noise the likelihood ratio is the best test there is (Neyman and Pearson). It
sees their distance d, the difference whitened by the spectrum of the noise and summed over its squares; with a share a of
false alarms it finds the faulty one with the probability Phi(d - Phi^-1(1 - a)). No rule that sees one record only does
better, and any that reports the faulty record reports its twin nearly as often.
"""

import math
from dataclasses import dataclass

import numpy as np
from planted.drafts import add_pulse
from planted.faults import level
from planted.shapes import FAMILIES, Shape
from scipy.optimize import least_squares
from scipy.stats import norm

BOUNDS = {
    "half-sine": (),
    "haversine": (),
    "versed-sine": ((0.6, 2.5),),
    "saw-tooth": ((0.7, 0.93),),
    "leaning": ((0.9, 2.2), (0.6, 1.6)),
    "gamma-like": ((1.5, 6.0),),
    "trapezoid": ((0.15, 0.4), (0.15, 0.4), (0.02, 0.1)),
    "contact": ((0.0, 0.6),),
}
"""What the parameters of each family are drawn from, in the sound classes too."""
FALSE_ALARMS = 0.02
"""Share of sound records that may be reported."""
FEWEST_FOUND = 0.5
"""Chance of the best test to find the faulty record below which the two cannot be told apart."""
ROUNDS = 60
"""Evaluations of a fit, times the parameters."""


@dataclass(frozen=True)
class Twin:
    """A sound pulse that looks like a faulty one: its shape, its truth, and its distance in standard deviations."""

    shape: Shape
    blow: object
    distance: float

    @property
    def chance(self):
        """Probability with which the best test finds the faulty record, where it reports 2 % of such twins."""
        return float(norm.cdf(self.distance - norm.ppf(1.0 - FALSE_ALARMS)))


def spectrum(draft, size):
    """Return the power of noise and rounding at the frequencies of a stretch, that of a sample where it is white."""
    frequencies, whole = np.fft.rfftfreq(size), np.fft.rfftfreq(draft.values.size)
    frequencies[0] = frequencies[1]
    power = {"pink": -1.0, "brown": -2.0}.get(draft.faults["noise"], 0.0)
    density = frequencies**power / np.mean(whole[1:] ** power)
    if draft.faults["noise"] == "autoregressive":
        noise = draft.sign * draft.values - draft.plain
        noise = noise - np.mean(noise)
        pole = float(np.sum(noise[1:] * noise[:-1]) / np.sum(noise**2))
        density = (1.0 - pole**2) / np.abs(1.0 - pole * np.exp(-2j * np.pi * frequencies)) ** 2
    steps = np.diff(np.unique(draft.values))
    rounding = float(np.min(steps)) ** 2 / 12.0 if steps.size else 0.0
    return (level(draft) * 10.0 ** (-draft.faults["decibels"] / 20.0)) ** 2 * density + rounding


def twin(draft, number=0, families=tuple(FAMILIES)):
    """Return the nearest sound pulse of a blow of a record, of all families.

    The distance is that of all blows of the record, taken as far from their twins as this one.
    """
    how, blow, step = draft.setting, draft.blows[number], draft.setting.step
    ends = [0, *(round(0.5 * (a.end + b.begin) / step) for a, b in zip(draft.blows, draft.blows[1:], strict=False))]
    first, last = ends[number], [*ends[1:], draft.values.size][number]
    faulty = draft.plain[first:last]
    weight = np.sqrt(spectrum(draft, faulty.size))
    begin, length = blow.begin - first * step, blow.end - blow.begin
    top = float(np.max(faulty - np.median(faulty)))

    def made(name, numbers):
        offset, start, peak, stretch, *parameters = numbers
        values = np.zeros(faulty.size)
        shape = Shape(name, tuple(round(p, 2) if name == "contact" else float(p) for p in parameters))
        one = add_pulse(values, how.__class__(shape, how.width, how.peak, step, how.filtered), begin + start * length, peak * top, stretch * length * shape.width)  # fmt: skip
        return values + offset * top, one, shape

    def missed(numbers, name):
        return np.fft.irfft(np.fft.rfft(faulty - made(name, numbers)[0]) / weight, faulty.size)

    best = None
    for name in families:
        low, high = np.array([(-0.2, 0.2), (-0.5, 0.5), (0.5, 2.5), (0.5, 2.5), *BOUNDS[name]]).T
        for stretch in (1.0, 1.3):
            guess = np.array([0.0, 0.0, 1.0, stretch, *(0.5 * (a + b) for a, b in BOUNDS[name])])
            found = least_squares(missed, guess, bounds=(low, high), args=(name,), x_scale=0.1 * (high - low), diff_step=1e-3, max_nfev=ROUNDS)  # fmt: skip
            if best is None or found.cost < best[0]:
                best = found.cost, name, found.x
    cost, name, numbers = best
    _, one, shape = made(name, numbers)
    return Twin(shape, one, math.sqrt(2.0 * cost * len(draft.blows)))
