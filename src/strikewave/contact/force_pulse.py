"""The force of one impact in time, drawn from what a record shows of it: begin, peak, width, and a shape of n and e.

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

from strikewave.contact import _kernels
from strikewave.contact.damping import exact

Array = NDArray[np.float64]

_NODES = 200
"""Of each half of a shape."""
FEWEST = 8
"""Samples that a pulse needs."""
FOOT, MARGIN = 0.02, 0.2
"""Share of the peak at which a pulse begins and ends, and share of its length that is taken to either side."""
CLEAR, MANY = 6.0, 64
"""Standard deviations that a pulse must be high, and samples from which on that is asked."""
_GAUSS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True)
class ForcePulse:
    """The force of one impact in time, by what a record shows of it.

    Attributes
    ----------
    begin : float
        First touch, s.
    peak : float
        Largest force, N.
    width : float
        Impulse over peak, s.
    exponent, restitution : float
        n and e of the law.
    """

    begin: float
    peak: float
    width: float
    exponent: float
    restitution: float

    def force(self, times: ArrayLike) -> Array:
        """Return the force at times, zero outside the contact, N; to 2e-6 of the peak (n from 0.5, e from 0.01).

        Examples
        --------
        >>> print(ForcePulse(0.0, 3.0, 2e-4 / np.pi, 1.0, 1.0).force([0.0, 25e-6, 50e-6, 100e-6]).round(4))
        [0.     2.1213 3.     0.    ]
        """
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
    chi = max(float(exact(e)), 1e-9)
    begun, ended = _half(n, chi, e, False), _half(n, chi, e, True)
    whole = begun[0][-1] + ended[0][-1]
    t = np.concatenate([begun[0], whole - ended[0][-2::-1]])
    g = np.concatenate([begun[1], ended[1][-2::-1]])
    slope = np.concatenate([begun[2], ended[2][-2::-1]])
    peak, area = unit_impact(n, e)[0], 1.0 + e
    return t * peak / area, g / peak, slope * area / peak**2


def _half(n: float, chi: float, e: float, released: bool) -> tuple[Array, Array, Array]:
    """Return time from one end of the contact, force and its slope over time, as far as half the span of u.

    K = m = v0 = 1; the notation is that of ``contact/_kernels.py``. w grows from the end by such a power of the nodes
    that the force is a power of 4 or more of them; time is integrated node by node (Gauss-Legendre).
    """
    power, span = min(4.0, max(2.0, 4.0 / n)) * (n + 1.0), chi * (1.0 + e)
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
    if not math.isfinite(slope[0]):
        slope[0] = (-1.0 if released else 1.0) * force[1] / t[1]
    return t, force, slope


def _rest(x: Array) -> Array:
    """Return exp(x) - 1 - x without cancellation near zero."""
    series = x * x * (0.5 + x / 6.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0)))))
    with np.errstate(over="ignore"):
        return np.where(np.abs(x) < 0.02, series, np.expm1(x) - x)


# ---- a pulse in a record --------------------------------------------------------------------------------------------


class PulseRecord(NamedTuple):
    """The samples of one pulse, its zero line taken off.

    Attributes
    ----------
    time, force : ndarray
        s and N.
    offset : float
        Zero line: mean before the pulse, within the window where it holds some; 0 where there is nothing, N.
    noise : float or None
        Standard deviation of a sample before the pulse, N; None where there are too few.
    before : int
        Samples before the pulse.
    peak : float
        Largest sample, N.
    """

    time: Array
    force: Array
    offset: float
    noise: float | None
    before: int
    peak: float

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

    Examples
    --------
    >>> t = np.arange(400) * 1e-6
    >>> found = cut_out(t, 7.0 + ForcePulse(1e-4, 50.0, 60e-6, 1.5, 0.6).force(t))
    >>> print(found.offset, found.before > 50, round(found.peak, 1), (found.time[[0, -1]] * 1e6).round())
    7.0 True 50.0 [ 76. 252.]
    """
    t, f = _checked(time, force)
    held = np.arange(t.size)
    if window is not None:
        held = np.flatnonzero((t >= window[0]) & (t <= window[1]))
        if held.size < FEWEST:
            raise ValueError(f"only {held.size} samples lie within the window {window}; {FEWEST} are needed")
    _check_sign(t, f, held)
    top = int(held[np.argmax(f[held])])
    zero, noise, before = _zero(t[held], f[held], top - int(held[0]))
    if not before:
        zero, noise, before = _zero(t, f, top)
    f = f - zero
    peak = float(f[top])
    _check_clear(f[held], peak)
    level = min(max(FOOT * peak, 4.0 * (noise or 0.0)), 0.3 * peak)
    first, last = _beyond(f, top, level, -1), _beyond(f, top, level, 1)
    if window is None:
        if first is None or last is None:
            side, left = ("end", f[-1]) if last is None else ("beginning", f[0])
            raise ValueError(
                f"the pulse is cut at the {side} of the record, where {left / peak:.0%} of its peak is left: record "
                "longer, with some time before the blow, take the zero line off, or give a window"
            )
        _check_count(last - first - 1)
        margin = MARGIN * (t[last] - t[first])
        held = np.flatnonzero((t >= t[first] - margin) & (t <= t[last] + margin))
        held = held[(held > _neighbour(f, first, level, -1)) & (held < _neighbour(f, last, level, 1))]
    else:
        _check_count(int(np.count_nonzero(f[held] > level)))
    return PulseRecord(t[held], f[held], zero, noise, before, peak)


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


def _check_sign(t: Array, f: Array, held: NDArray[np.intp]) -> None:
    """Refuse a record whose largest pulse points down, each direction measured from the zero line before it."""
    heights = []
    for turned in (f, -f):
        top = int(held[np.argmax(turned[held])])
        heights.append(turned[top] - _zero(t, turned, top)[0])
    if not max(heights) > 0.0:
        raise ValueError("there is no pulse: the record does not leave its zero line")
    if heights[1] > heights[0]:
        raise ValueError("the largest pulse is negative: turn the sign of the record")


def _check_clear(f: Array, peak: float) -> None:
    """Refuse what does not stand out of the noise, that the steps from sample to sample show; not of few samples."""
    noise = float(np.median(np.abs(np.diff(f)))) / 0.954 if f.size >= MANY else 0.0
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


def _zero(t: Array, f: Array, top: int) -> tuple[float, float | None, int]:
    """Return mean, standard deviation and number of the samples up to five widths before a pulse."""
    rough = float(np.median(f[: max(top // 10, min(top, 4))])) if top else 0.0
    half = _beyond(f - rough, top, 0.5 * (f[top] - rough), -1)
    after = _beyond(f - rough, top, 0.5 * (f[top] - rough), 1)
    if half is None:
        return 0.0, None, 0
    width = t[top if after is None else after] - t[half]
    quiet = f[(t < t[half] - width) & (t > t[half] - 6.0 * width)]
    if quiet.size < 4:
        return 0.0, None, 0
    middle = float(np.median(quiet))
    quiet = quiet[np.abs(quiet - middle) < 0.1 * (f[top] - middle)]
    zero = float(np.mean(quiet)) if quiet.size else middle
    return zero, float(np.std(quiet, ddof=1)) if quiet.size >= FEWEST else None, quiet.size
