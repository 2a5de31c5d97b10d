"""A smooth pulse fitted to a noisy or ringing one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from strikewave.base import declare
from strikewave.base.shock_quantities import MICROSECONDS, OF_CHANNEL, OF_INTEGRAL
from strikewave.records._pulse_kernels import fit_pulse, unit_pulses
from strikewave.records.record import Array

if TYPE_CHECKING:
    from strikewave.signal.filters import Effect, Filter

MOST_SAMPLES = 240  # more are averaged: 50 for each parameter, and a pulse 80 of them wide loses little by it
# Bounds of peak, begin, length (over the guess), share of rise, power: a step and a spike fit, none runs away in noise
LOWEST, HIGHEST = np.array([0.05, -math.inf, 0.2, 0.05, 0.3]), np.array([3.0, math.inf, 4.0, 0.95, 4.0])
BEFORE = 0.5  # lengths before the first sample at which a pulse may begin: one that is cut has begun before its stretch
# Pulses from which the fit begins: flat, between a half-sine and a haversine, and pointed. Near the feet of a power
# below one the sum of squares has a kink at each sample, and valleys between them: of 959 blows, measured and planted,
# One in twenty is fitted better than from the middle power alone.
STARTS = np.array([[1.0, -0.1, 1.2, 0.5, power] for power in (0.6, 1.3, 2.5)])
# How far peak, begin, length, share of rise and power usually lie from the guess; scales the steps of the fit
SPREADS = np.array([1.0, 0.1, 0.3, 0.2, 1.0])
# Evaluations of a fit at most, and the relative change below which it ends: noise moves the parameters far more
ROUNDS, CONVERGED = 50, 1e-6


# Samples of a pulse that a filter is tried on, and times one over the cutoff to either side of it
FILTERED, BESIDE_FILTERED = 400, 3.0
# Share of a parameter by which it is changed for a derivative: squared, it is far below an uncertainty
DERIVATIVE = 1e-4
TOE_POINTS = 33  # points at which a toe is integrated: straight lines between them keep 0.1 % of it


@declare.dataclass
class PulseUncertainty:
    """Standard uncertainties of the figures of a blow by what lies beside it; NaN where they are not known."""

    peak: float = declare.number(
        OF_CHANNEL, "standard uncertainty by noise and baseline", key="peak_uncertainty", default=math.nan
    )
    width: float = declare.number(MICROSECONDS, "the same of the width", key="width_uncertainty", default=math.nan)
    velocity_change: float = declare.number(
        OF_INTEGRAL, "the same of the velocity change", key="velocity_change_uncertainty", default=math.nan
    )


BUDGETED = tuple(declare.declarations(PulseUncertainty))  # figures of a blow that have an uncertainty


class SmoothPulse(NamedTuple):
    """a(t) = A sin^p(pi u), where u goes straight from 0 to 1/2 while the pulse rises and on to 1 while it falls.

    p = 1 is a half-sine, p = 2 a haversine, a late rise a saw-tooth.
    """

    peak: float  # A
    # When it begins and how long it lasts, s
    begin: float
    length: float
    rise_share: float  # share of the length in which it rises
    power: float  # p
    misfit: float = 0.0  # root mean square of what is left, over the peak

    def at(self, time: Array) -> Array:
        """Return the pulse at some times."""
        return _pulses_at(np.ravel(time), np.array([self[:5]]))[0].reshape(np.shape(time))

    @property
    def time(self) -> float:
        """Time of the peak, s."""
        return self.begin + self.rise_share * self.length

    def width(self, share: float = 0.1) -> float:
        """Return the time above a share of the peak, s."""
        return self.length * (1.0 - 2.0 * self._phase(share))

    def rise(self) -> float:
        """Return the time from 10 to 90 % of the peak, s."""
        return self.length * self.rise_share * 2.0 * (self._phase(0.9) - self._phase(0.1))

    def area(self) -> float:
        """Return the integral: A T Gamma((p+1)/2) / (sqrt(pi) Gamma(p/2 + 1)).

        Examples
        --------
        >>> round(SmoothPulse(1.0, 0.0, 1.0, 0.3, 1.0).area() - 2.0 / math.pi, 12)
        0.0
        """
        half = 0.5 * self.power
        return (
            self.peak * self.length * math.exp(math.lgamma(half + 0.5) - math.lgamma(half + 1.0)) / math.sqrt(math.pi)
        )

    def area_beyond(self, begin: float, end: float) -> float:
        """Return the integral of the magnitude before one time and after another, s times its unit."""
        toes = (self.begin, min(begin, self.begin + self.length)), (max(end, self.begin), self.begin + self.length)
        first, last = np.array(toes).T
        times = np.linspace(first, np.maximum(first, last), TOE_POINTS)
        return float(np.sum(np.trapezoid(np.abs(self.at(times)), times, axis=0)))

    def width_slope(self, share: float = 0.1, by: float = 0.02) -> float:
        """Return by how much the width falls where the share rises, s: what an error of the baseline does to it."""
        return (self.width(share - by) - self.width(share + by)) / (2.0 * by)

    def uncertainty(self, step: float, noise: float) -> PulseUncertainty:
        """Return the standard uncertainty of the figures, fitted to samples so far apart with white noise.

        That of a least-squares fit, from the derivatives of the pulse by its five parameters.

        Examples
        --------
        >>> figures = SmoothPulse(1.0, 0.0, 1.0, 0.5, 1.0).uncertainty(0.01, 0.1)
        >>> 0.01 < figures.peak < 0.05, 0.01 < figures.width < 0.1
        (True, True)
        """
        samples = math.ceil(self.length / step)
        time: Array = np.asarray(self.begin + step * np.arange(-samples, 2 * samples), dtype=np.float64)
        rows, changes = self._changed()
        values = np.array([(abs(one.peak), one.width(), one.area()) for one in (SmoothPulse(*row) for row in rows)])
        figures = (values[:5] - values[5:]) / (2.0 * changes[:, None])
        columns, scale = self.tangents(time)
        spread = np.linalg.pinv(columns) / scale[:, None]
        return PulseUncertainty(*(noise * float(v) for v in np.linalg.norm(figures.T @ spread, axis=1)))

    def tangents(self, time: Array) -> tuple[Array, Array]:
        """Return the directions in which the pulse moves at some times with its five parameters, and how fast.

        The directions are unit columns.
        """
        rows, changes = self._changed()
        pulses = _pulses_at(time, rows)
        slopes = (pulses[:5] - pulses[5:]) / (2.0 * changes[:, None])
        speeds = np.linalg.norm(slopes, axis=1)
        speeds[speeds == 0.0] = 1.0
        return (slopes / speeds[:, None]).T, speeds

    def through(self, filter_: Filter) -> Effect:
        """Return what a filter leaves of the pulse."""
        from strikewave.signal.filters import effect_on_pulse

        step = min(self.length / FILTERED, 0.02 / filter_.cutoff)
        beside = self.length + BESIDE_FILTERED / filter_.cutoff
        time = np.arange(self.begin - beside, self.begin + self.length + beside, step)
        return effect_on_pulse(filter_, np.abs(self.at(time)), step)

    def _changed(self) -> tuple[Array, Array]:
        """Return the parameters with a little more of each, and with as much less, a row each, and these changes."""
        changes = np.array([abs(self.peak), self.length, self.length, 1.0, 1.0]) * DERIVATIVE
        return np.array(self[:5]) + np.vstack([np.diag(changes), -np.diag(changes)]), changes

    def _phase(self, share: float) -> float:
        return math.asin(share ** (1.0 / self.power)) / math.pi


def _pulses_at(time: Array, rows: Array) -> Array:
    """Return pulses at some times, of rows of their five parameters."""
    peaks, begins, lengths, shares, powers = rows.T
    since = (time - begins[:, None]) / lengths[:, None]
    return np.asarray(peaks[:, None] * unit_pulses(since, shares, powers))


def fit_smooth_pulse(time: Array, values: Array, begin: float, length: float) -> SmoothPulse:
    """Fit a smooth positive pulse by least squares, beginning from a guess of its begin and length.

    Times are in s; the baseline of the values is taken off.
    """
    factor = -(-values.size // MOST_SAMPLES)
    whole = values.size // factor * factor
    t = (time[:whole].reshape(-1, factor).mean(axis=1) - begin) / length
    scale = float(np.max(values)) or 1.0
    y = values[:whole].reshape(-1, factor).mean(axis=1) / scale
    low, high = LOWEST.copy(), HIGHEST.copy()
    low[1], high[1] = t[0] - BEFORE, t[-1]
    fits = [fit_pulse(t, y, start, low, high, SPREADS, ROUNDS, CONVERGED) for start in np.clip(STARTS, low, high)]
    best, squares = min(fits, key=lambda fit: float(fit[1]))
    peak, first, run, share, power = (float(v) for v in best)
    misfit = math.sqrt(squares / y.size) / peak
    return SmoothPulse(peak * scale, begin + first * length, run * length, share, power, misfit)
