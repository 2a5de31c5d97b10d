"""Force of one impact in time, by what a record shows of it: begin, peak, width, and a shape of n and e.

The law is F = K d^n (1 + chi d'/v0) of two free bodies, chi = exact(e). Every sample of its pulse stays as it is under
v -> s v, m -> m / s, K -> K / s^n (then d -> s d): a force pulse tells m v and K v^n, never K, m and v one by one.
With the width W = impulse / peak the pulse is F(t) = F_p g((t - t0) / W), whose shape g follows from n and e alone.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.texts import percent
from strikewave.contact import _kernels
from strikewave.contact.damping import exact

Array = NDArray[np.float64]

_NODES = 200  # cubics between them are off by 2e-6 of the peak, far below the noise of any record
"""Nodes of each half of a shape."""
FEWEST = 8  # five are its unknowns, and some must be left to see the misfit in
"""Fewest samples of a pulse."""
# Chosen: nothing is left out of the fit, drift stays below the foot, and the margin shows the fit where it is zero.
FOOT, MARGIN = 0.02, 0.2
"""Share of the peak at which a pulse begins and ends, and share of its length taken to either side."""
NOISY_FOOT, HIGHEST_FOOT = 4.0, 0.3
"""Least height of the foot in standard deviations of the noise, so that noise does not pass for the pulse, and its
largest share of the peak, so that something is left of the pulse."""
# Of a thousand samples of noise the largest is at 3.3; of fewer than 64 the pulse makes up too many of the steps that
# noise is read from.
CLEAR, MANY = 6.0, 64
"""Least height of a pulse in standard deviations, and samples from which on it is asked."""
MEDIAN_STEP = 0.954  # 0.6745 sqrt(2)
"""Median of the steps from sample to sample of white noise, over its standard deviation."""
EARLY_PART, EARLY_SAMPLES = 10, 4
"""Share of the time before a peak, a tenth, or samples, for a first baseline: a pulse takes less than the rest."""
BASELINE_WIDTHS, QUIET_SHARE = 6.0, 0.1
"""Widths before the rise that give the baseline, without the last, into which the foot may reach (chosen: drift far
before does not count); samples off their median by more than this share of the peak are other blows."""
_ELASTIC = 1e-9  # it changes them by as much
"""Hysteresis factor that stands for none, since shapes divide by it."""
_SERIES = 0.02  # measured
"""|x| below which exp(x) - 1 - x is its series: there it and the difference are off by 4e-15 and 9e-15."""
# The force is then a power of 4 or more of them, which cubics follow, and never so high that all nodes crowd at the
# end.
_STEEPEST, _LEAST_POWER = 4.0, 2.0
"""Powers of the nodes with which the distance from an end of the contact grows."""
_GAUSS = np.polynomial.legendre.leggauss(5)
"""Five points between two nodes: exact up to degree 9, where the integrand is smooth in the nodes."""


@dataclass(frozen=True)
class ForcePulse:
    """Force of one impact in time, with the n and e of its law."""

    begin: float
    """First touch, s."""
    peak: float
    """Largest force, N."""
    width: float
    """Impulse over peak, s."""
    exponent: float
    restitution: float

    def force(self, times: ArrayLike) -> Array:
        """Return the force at times, zero outside the contact, N; to 2e-6 of the peak (n from 0.5, e from 0.01)."""
        t, g, slope = shape(self.exponent, self.restitution)
        u = (np.asarray(times, dtype=float) - self.begin) / self.width
        k = np.clip(np.searchsorted(t, u) - 1, 0, t.size - 2)
        length = t[k + 1] - t[k]
        x = (u - t[k]) / length
        at = (1.0 + 2.0 * x) * g[k] + x * length * slope[k]
        at = at * (1.0 - x) ** 2 + ((3.0 - 2.0 * x) * g[k + 1] + (x - 1.0) * length * slope[k + 1]) * x**2
        return np.where((u > 0.0) & (u < t[-1]), self.peak * at, 0.0)

    @property
    def momentum(self) -> float:
        """Reduced mass x approach speed, N s."""
        return self.peak * self.width / (1.0 + self.restitution)

    @property
    def time_unit(self) -> float:
        """(m v^(1 - n) / K)^(1 / (n + 1)), s."""
        return self.momentum * unit_impact(self.exponent, self.restitution)[0] / self.peak

    @property
    def stiffness_speed(self) -> float:
        """K v^n, N/s^n."""
        return self.momentum / self.time_unit ** (self.exponent + 1.0)

    @property
    def duration(self) -> float:
        """Length of the contact, s."""
        return self.time_unit * unit_impact(self.exponent, self.restitution)[1]


@functools.lru_cache(maxsize=256)
def unit_impact(n: float, e: float) -> tuple[float, float]:
    """Return largest force and duration of the impact with K = m = v0 = 1."""
    _, _, force, duration = _kernels.impact(1.0, n, float(exact(e)), 1.0, 1.0)
    return force, duration


@functools.lru_cache(maxsize=256)
def shape(n: float, e: float) -> tuple[Array, Array, Array]:
    """Return times, forces and slopes of the pulse of height 1 and area 1 at nodes that crowd at both ends."""
    chi = max(float(exact(e)), _ELASTIC)
    begun, ended = _half(n, chi, e, False), _half(n, chi, e, True)
    duration = begun[0][-1] + ended[0][-1]
    t = np.concatenate([begun[0], duration - ended[0][-2::-1]])
    g = np.concatenate([begun[1], ended[1][-2::-1]])
    slope = np.concatenate([begun[2], ended[2][-2::-1]])
    peak, area = unit_impact(n, e)[0], 1.0 + e
    return t * peak / area, g / peak, slope * area / peak**2


def _half(n: float, chi: float, e: float, released: bool) -> tuple[Array, Array, Array]:
    """Return time from one end of the contact, force and its slope over time, as far as half the span of u.

    K = m = v0 = 1; the notation is that of ``contact/_kernels.py``. w grows from the end by such a power of the nodes
    that the force is a power of 4 or more of them; time is integrated node by node (Gauss-Legendre).
    """
    power, span = min(_STEEPEST, max(_LEAST_POWER, 4.0 / n)) * (n + 1.0), chi * (1.0 + e)
    depth = ((n + 1.0) / chi**2) ** (1.0 / (n + 1.0))
    late = math.exp(-span) * (1.0 + chi)
    x = np.linspace(0.0, 0.5, _NODES + 1)

    def reached(x: Array) -> tuple[Array, Array]:
        ratio = (x / (1.0 - x)) ** power
        w = span * ratio / (1.0 + ratio)
        g = w * e * chi - late * _rest(w) if released else chi * -np.expm1(-w) - _rest(-w)
        return w, g

    between = (x[1:, None] + x[:-1, None]) / 2.0 + (x[1] / 2.0) * _GAUSS[0]
    w, g = reached(between)
    rate = g ** (-n / (n + 1.0)) * w * (1.0 - w / span) * power / (between * (1.0 - between))
    t = np.concatenate([[0.0], np.cumsum(rate @ _GAUSS[1])]) * (x[1] / 2.0) * depth**-n / chi
    w, g = reached(x)
    y = late * np.expm1(w) - e * chi if released else (1.0 + chi) * np.expm1(-w) + chi
    d = depth * np.maximum(g, 0.0) ** (1.0 / (n + 1.0))
    force = d**n * (1.0 + y)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = n * d ** (n - 1.0) * (y / chi) * (1.0 + y) - d**n * chi * force
    if not math.isfinite(slope[0]):  # n below 1 rises steeply at touch: the chord stands for the infinite slope
        slope[0] = (-1.0 if released else 1.0) * force[1] / t[1]
    return t, force, slope


def _rest(x: Array) -> Array:
    """Return exp(x) - 1 - x without cancellation near zero."""
    series = x * x * (0.5 + x / 6.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0)))))
    with np.errstate(over="ignore"):
        return np.where(np.abs(x) < _SERIES, series, np.expm1(x) - x)


class PulseRecord(NamedTuple):
    """Samples of one pulse, s and N, without their baseline."""

    time: Array
    force: Array
    offset: float
    """Baseline, N: mean before the pulse, within the window where it holds some; 0 without samples there."""
    noise: float | None
    """Standard deviation of a sample before the pulse, N; None where there are too few."""
    before: int
    """Samples before the pulse."""
    peak: float
    """Largest sample, N."""

    @property
    def length(self) -> float:
        """Time from the first sample to the last, s."""
        return float(self.time[-1] - self.time[0])


def cut_out(time: ArrayLike, force: ArrayLike, window: tuple[float, float] | None = None) -> PulseRecord:
    """Return the largest pulse of a record, with a fifth of its length to either side, or what lies in a window.

    Parameters
    ----------
    time, force : array_like
        Samples, s and N; shape (N,), times ascending.
    window : tuple of float, optional
        First and last time, s.

    Raises
    ------
    ValueError
        If there is no whole positive pulse of eight samples.
    """
    t, f = _checked(time, force)
    rows = np.arange(t.size)
    if window is not None:
        rows = np.flatnonzero((t >= window[0]) & (t <= window[1]))
        if rows.size < FEWEST:
            raise ValueError(f"only {rows.size} samples lie within the window {window}; {FEWEST} are needed")
    _check_sign(t, f, rows)
    top = int(rows[np.argmax(f[rows])])
    baseline, noise, before = _baseline(t[rows], f[rows], top - int(rows[0]))
    if not before:
        baseline, noise, before = _baseline(t, f, top)
    f = f - baseline
    peak = float(f[top])
    _check_clear(f[rows], peak)
    level = min(max(FOOT * peak, NOISY_FOOT * (noise or 0.0)), HIGHEST_FOOT * peak)
    first, last = _beyond(f, top, level, -1), _beyond(f, top, level, 1)
    if window is None:
        if first is None or last is None:
            side, left = ("end", f[-1]) if last is None else ("beginning", f[0])
            raise ValueError(
                f"the pulse is cut at the {side} of the record, where {percent(left / peak, 0)} of its peak is left: "
                "record longer, with some time before the blow, take the baseline off, or give a window"
            )
        _check_count(last - first - 1)
        margin = MARGIN * (t[last] - t[first])
        rows = np.flatnonzero((t >= t[first] - margin) & (t <= t[last] + margin))
        rows = rows[(rows > _neighbour(f, first, level, -1)) & (rows < _neighbour(f, last, level, 1))]
    else:
        _check_count(int(np.count_nonzero(f[rows] > level)))
    return PulseRecord(t[rows], f[rows], baseline, noise, before, peak)


def _checked(time: ArrayLike, force: ArrayLike) -> tuple[Array, Array]:
    t, f = np.asarray(time, dtype=float), np.asarray(force, dtype=float)
    if t.ndim != 1 or t.shape != f.shape:
        raise ValueError(f"time and force must be rows of equal length, got shapes {t.shape} and {f.shape}")
    if t.size < FEWEST:
        raise ValueError(f"{t.size} samples; a pulse needs at least {FEWEST}")
    if not (np.all(np.isfinite(t)) and np.all(np.isfinite(f))):
        raise ValueError("time or force holds values that are not finite: leave those samples out")
    if not np.all(np.diff(t) > 0.0):
        raise ValueError("times must ascend: sort the samples, and leave out those of the same time")
    return t, f


def _check_sign(t: Array, f: Array, rows: NDArray[np.intp]) -> None:
    """Refuse a record whose largest pulse points down, each direction measured from the baseline before it."""
    heights = []
    for turned in (f, -f):
        top = int(rows[np.argmax(turned[rows])])
        heights.append(turned[top] - _baseline(t, turned, top)[0])
    if not max(heights) > 0.0:
        raise ValueError("there is no pulse: the record does not leave its baseline")
    if heights[1] > heights[0]:
        raise ValueError("the largest pulse is negative: turn the sign of the record")


def _check_clear(f: Array, peak: float) -> None:
    """Refuse a pulse within the noise, which the steps from sample to sample show where there are many."""
    noise = float(np.median(np.abs(np.diff(f)))) / MEDIAN_STEP if f.size >= MANY else 0.0
    if peak < CLEAR * noise:
        raise ValueError(f"no pulse stands out of the noise of {noise:.3g} N: the largest sample is {peak:.3g} N")


def _check_count(count: int) -> None:
    if count < FEWEST:
        raise ValueError(f"only {count} samples lie within the pulse; {FEWEST} are needed: sample faster")


def _beyond(f: Array, top: int, level: float, side: int) -> int | None:
    """Return the first sample below a level to one side of the peak; None where the record ends before."""
    part = f[top::side] < level
    return top + side * int(np.argmax(part)) if part.any() else None


def _neighbour(f: Array, foot: int, level: float, side: int) -> int:
    """Return the first sample beyond a foot that is above a level again, or one past the end of the record."""
    part = f[foot::side] > level
    return foot + side * int(np.argmax(part)) if part.any() else (f.size if side > 0 else -1)


def _baseline(t: Array, f: Array, top: int) -> tuple[float, float | None, int]:
    """Return mean, standard deviation and number of the samples up to five widths before a pulse."""
    rough = float(np.median(f[: max(top // EARLY_PART, min(top, EARLY_SAMPLES))])) if top else 0.0
    half = _beyond(f - rough, top, 0.5 * (f[top] - rough), -1)
    after = _beyond(f - rough, top, 0.5 * (f[top] - rough), 1)
    if half is None:
        return 0.0, None, 0
    width = t[top if after is None else after] - t[half]
    quiet = f[(t < t[half] - width) & (t > t[half] - BASELINE_WIDTHS * width)]
    if quiet.size < EARLY_SAMPLES:
        return 0.0, None, 0
    middle = float(np.median(quiet))
    quiet = quiet[np.abs(quiet - middle) < QUIET_SHARE * (f[top] - middle)]
    baseline = float(np.mean(quiet)) if quiet.size else middle
    return baseline, float(np.std(quiet, ddof=1)) if quiet.size >= FEWEST else None, quiet.size
