"""Single-degree-of-freedom oscillators on a base whose acceleration runs straight between samples.

z'' + 2 zeta w z' + w^2 z = x, with base acceleration x and z = base minus mass: a base that starts upwards gives
a positive z first. Three responses, see `Response`: z itself, z', and the absolute acceleration of the mass,
w^2 z + 2 zeta w z'. Impulse responses are h = exp(-a t) (even cos(K t) + odd sin(K t)/K); a = zeta w,
K^2 = w^2 - a^2. All times here are in steps. Beyond critical damping K is imaginary and the same formulas hold; at
critical damping K is kept at 1e-7 w, which shifts a response by 1e-14.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def legendre(count: int) -> tuple[Array, Array]:
    """Return places and weights of the Gauss-Legendre rule on 0 to 1."""
    places, weights = np.polynomial.legendre.leggauss(count)
    return np.asarray(0.5 * (places + 1.0)), np.asarray(0.5 * weights)


NODES, WEIGHTS = legendre(24)
"""Gauss-Legendre rule on 0 to 1; exact to rounding up to eight decay times or half a period (3e-14, measured)."""

FEW = legendre(8)
"""The same, up to one radian or decay time: 6 nodes leave 8e-14, 8 leave 2e-15 (measured)."""

STIFF = 8.0
"""Decay times a step above which the exponential integrals are taken in closed form: up to there the rule is exact, and
from one on their differences lose no digits."""

CRITICAL = 1e-7
"""Smallest |K|/w: K in a denominator must not vanish, and its square, 1e-14, is what a response is off by."""

PLACES = np.linspace(0.0, 1.0, 17) ** 2
"""Places in a step at which a response is looked at: dense at its start, where fast modes die."""

BETWEEN_PLACES = 1.1
"""Factor by which the largest P and R of `bend` may exceed those at the places; measured: 1.008, up to three times
critical damping."""

CALM = 0.5
"""Least 1 - 2 a - w^2/8 at which that formula bounds a peak inside a step: below, the largest P and R bound it
better."""

SERIES_TERMS = 8
"""Terms of sin(K v)/K beyond the first, |K v| below 1: the next is 1e-16."""


class Response(NamedTuple):
    """What is looked at of an oscillator, f: f'' + 2 a f' + w^2 f = level x + slope x'.

    Attributes
    ----------
    even, odd : ndarray
        Of the impulse response, exp(-a t) (even cos(K t) + odd sin(K t)/K).
    mode : callable
        m(p) of each pole p; the impulse response is also (m(p1) exp(p1 t) - m(p2) exp(p2 t)) / (p1 - p2).
    level, slope : ndarray
        How the base acceleration and its slope load it.
    static : ndarray
        Response to a base acceleration of 1 that lasts.
    """

    even: Array
    odd: Array
    mode: Callable[[Array], Array]
    level: Array
    slope: Array
    static: Array


def displacement(w: Array, zeta: float) -> Response:
    """Return the relative displacement z."""
    none, one = np.zeros_like(w), np.ones_like(w)
    return Response(none, one, np.ones_like, one, none, 1.0 / w**2)


def velocity(w: Array, zeta: float) -> Response:
    """Return the relative velocity z'."""
    none, one = np.zeros_like(w), np.ones_like(w)
    return Response(one, -zeta * w, np.copy, none, one, none)


def acceleration(w: Array, zeta: float) -> Response:
    """Return the absolute acceleration of the mass, w^2 z + 2 a z'; w^2 m(z) + 2 a m(z') = w^2 + 2 a p = -p^2."""
    a = zeta * w
    return Response(2.0 * a, w**2 - 2.0 * a**2, lambda p: -(p**2), w**2, 2.0 * a, np.ones_like(w))


class Bank(NamedTuple):
    """Oscillators side by side, and what the time loop needs of them.

    Attributes
    ----------
    frequency : ndarray
        w, natural angular frequency in radians a step.
    damping : float
        zeta, share of critical damping.
    static : ndarray
        Response to a base acceleration of 1 that lasts.
    weight : ndarray
        b0, response to the newest sample, in which unit the loop counts.
    filters : ndarray
        decay, stiffness, b1/b0, b2/b0; one column an oscillator.
    shapes : ndarray
        w^2; 2 a; load per sample and per slope; largest P and R; bound of a peak's height over its samples, per
        response, per sample and per slope.
    bends : ndarray
        P and R of `bend` at `PLACES`: axes P or R, oscillator, place.
    """

    frequency: Array
    damping: float
    static: Array
    weight: Array
    filters: Array
    shapes: Array
    bends: Array


def bank(frequency: Array, damping: float, response: Callable[[Array, float], Response]) -> Bank:
    """Prepare oscillators for the time loop.

    A peak inside a step stands at most max|f''|/8 above the samples. Its slope vanishes there, so that |f'| <= max|f''|
    in the step, and |f''| <= 2 a |f'| + w^2 |f| + |F| gives max|f''| <= (w^2 max|f_k| + |F|)/(1 - 2 a - w^2/8).
    Where that is of no use, the largest P and R of `bend` bound the height.

    Examples
    --------
    >>> bank(np.array([0.1]), 0.05, acceleration).filters.shape
    (4, 1)
    """
    of = response(frequency, damping)
    decay, stiffness, b0, b1, b2 = recursion(frequency, damping, of)
    bends = np.stack(bend(frequency[:, None], damping, PLACES))
    square, double = frequency**2, 2.0 * damping * frequency
    on_level, on_slope = of.level / b0, of.slope / b0
    flat, rising = BETWEEN_PLACES * np.max(bends, axis=2)
    calmness = 1.0 - double - square / 8.0
    lively, curved = calmness < CALM, 0.125 / np.maximum(calmness, CALM)
    between = [
        np.where(lively, flat * (square + 2.0 * double) + 2.0 * rising * square, curved * square),
        np.where(lively, flat, curved) * on_level,
        np.where(lively, flat * on_slope + rising * on_level, curved * on_slope),
    ]
    shapes = np.stack([square, double, on_level, on_slope, flat, rising, *between])
    return Bank(frequency, damping, of.static, b0, np.stack([decay, stiffness, b1 / b0, b2 / b0]), shapes, bends)


def poles(w: Array, zeta: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return p1 and p2 = -a +- sqrt(a^2 - w^2), the slower one without cancellation, p1 p2 = w^2."""
    share = math.sqrt(max(abs((1.0 - zeta) * (1.0 + zeta)), CRITICAL**2))
    if zeta <= 1.0:
        p1 = np.asarray(w * complex(-zeta, share), dtype=np.complex128)
        return p1, np.asarray(p1.conj(), dtype=np.complex128)
    fast = -w * (zeta + share)
    return np.asarray(w**2 / fast, dtype=np.complex128), np.asarray(fast, dtype=np.complex128)


def recursion(w: Array, zeta: float, of: Response) -> tuple[Array, Array, Array, Array, Array]:
    """Return decay E^2, stiffness 1 - 2 E cos K + E^2 and the weights b0, b1, b2 of three samples.

    A straight line between samples is a sum of hats, and b0 = int_0^1 (1 - u) h(u) du is the response to a hat at
    its top. The free vibration behind a hat, continued back to its top, misses b0 by b2 = -E^2 int_0^1 (1 - u)
    h(-u) du. A constant input has to give the static response: b0 + b1 + b2 = stiffness H(0).

    Ramp-invariant method of Smallwood and of ISO 18431-4, whose closed forms lose digits as w^-3.

    Sources: ``smallwood-1981``, ``iso-18431-4``.
    """
    p1, p2 = poles(w, zeta)
    a = zeta * w
    stiffness = (np.expm1(p1) * np.expm1(p2)).real
    static = stiffness * of.static
    if np.all(np.abs(p2.real) <= STIFF):
        b0, both = _weights_by_quadrature(w, zeta, of.even, of.odd)
    else:
        soft = np.abs(p2.real) <= STIFF
        b0, both = np.empty_like(w), np.empty_like(w)
        b0[soft], both[soft] = _weights_by_quadrature(w[soft], zeta, of.even[soft], of.odd[soft])
        b0[~soft], both[~soft] = _weights_of_stiff(p1[~soft].real, p2[~soft].real, of.mode)
    return np.exp(-2.0 * a), stiffness, b0, static - both, both - b0


def _weights_by_quadrature(w: Array, zeta: float, of_even: Array, of_odd: Array) -> tuple[Array, Array]:
    """Return b0 and b0 + b2; the sum by itself, because damping cancels in it."""
    p1, p2 = poles(w[:, None], zeta)
    a, sigma = zeta * w[:, None], 0.5 * (p1 - p2)
    cosh, sinh = np.cosh(sigma * NODES).real, (np.sinh(sigma * NODES) / sigma).real
    even, odd = of_even[:, None] * cosh, of_odd[:, None] * sinh
    rule, forth = WEIGHTS * (1.0 - NODES), np.exp(-a * NODES)
    less = -np.expm1(-2.0 * a * (1.0 - NODES))  # forth - back, as a share of forth; back = E^2 exp(a u)
    return (forth * (even + odd)) @ rule, (forth * (even * less + odd * (2.0 - less))) @ rule


def _weights_of_stiff(p1: Array, p2: Array, mode: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Return b0 and b0 + b2 far beyond critical damping, mode by mode."""
    m1, m2 = mode(p1), mode(p2)

    def falling(p: Array) -> Array:
        """int_0^1 (1 - u) exp(p u) du."""
        exact = (np.expm1(p) - p) / p**2
        return np.where(p > -1.0, np.exp(p[:, None] * NODES) @ (WEIGHTS * (1.0 - NODES)), exact)

    def rising(p: Array) -> Array:
        """int_0^1 u exp(p u) du."""
        exact = (p * np.exp(p) - np.expm1(p)) / p**2
        return np.where(p > -1.0, np.exp(p[:, None] * NODES) @ (WEIGHTS * NODES), exact)

    b0 = (m1 * falling(p1) - m2 * falling(p2)) / (p1 - p2)
    b2 = -(m1 * np.exp(p2) * rising(p1) - m2 * np.exp(p1) * rising(p2)) / (p1 - p2)
    return b0, b0 + b2


def bend(w: Array, zeta: float, u: Array) -> tuple[Array, Array]:
    """Return P and R: how far constant and rising loads bend a response off its chord within a step.

    P and R solve f'' + 2 a f' + w^2 f = -1 and = -u, zero at u = 0 and 1. A response that starts a step at y, changes
    by d, and is loaded by F_0 + F_1 u runs at y + u d + (w^2 y + 2 a d - F_0) P(u) + (w^2 d - F_1) R(u). Both are
    integrals of exp(-a (u - s)) sin(K s) sin(K (1 - u))/(K sin K), s < u, and its mirror: nothing cancels.
    """
    p1, p2 = poles(w, zeta)
    if np.all(np.abs(p2) < 1.0):
        return _bend_by_quadrature(w, zeta, u)
    gap = np.expm1(p2 - p1)
    first = (np.exp(p2 * u) * np.expm1((p2 - p1) * (1.0 - u)) / gap).real - (1.0 - u)
    second = (np.exp(-p1 * (1.0 - u)) * np.expm1((p2 - p1) * u) / gap).real - u
    P = (first + second) / w**2
    near = np.abs(p2) < 1.0
    soft = _bend_by_quadrature(np.where(near, w, 0.0), zeta, u)
    return np.where(near, soft[0], P), np.where(near, soft[1], (second - 2.0 * zeta * w * P) / w**2)


def _bend_by_quadrature(w: Array, zeta: float, u: Array) -> tuple[Array, Array]:
    a, square = zeta * w, w**2 * (zeta - 1.0) * (zeta + 1.0)

    def sine(v: Array) -> Array:
        """sin(K v)/K by its series."""
        q = square * v**2
        total = np.ones_like(q)
        for n in range(SERIES_TERMS, 0, -1):
            total *= q / (2.0 * n * (2.0 * n + 1.0))
            total += 1.0
        return v * total

    nodes, weights = (row.reshape(-1, *(1,) * max(w.ndim, u.ndim)) for row in FEW)
    before, after = u * nodes, u + (1.0 - u) * nodes
    left = weights * np.exp(-a * (u - before)) * sine(before) * (u * sine(1.0 - u))
    right = weights * np.exp(a * (after - u)) * sine(1.0 - after) * ((1.0 - u) * sine(u))
    whole = sine(np.ones(1))
    return np.sum(left + right, axis=0) / whole, np.sum(left * before + right * after, axis=0) / whole


def free_extremes(w: Array, zeta: float, start: Array, change: Array) -> tuple[Array, Array]:
    """Return the largest and the smallest value of a free vibration from a sample on, to the end of all time.

    Parameters
    ----------
    w : ndarray
        Natural angular frequency, radians a step.
    zeta : float
        Share of critical damping.
    start : ndarray
        Response at the sample.
    change : ndarray
        Change of the response to the next sample.

    Examples
    --------
    An undamped oscillator at 3 sin(w t):

    >>> w = np.array([0.1])
    >>> print(*free_extremes(w, 0.0, np.zeros(1), 3.0 * np.sin(w)))
    [3.] [-3.]
    """
    values = (_free_oscillation if zeta <= 1.0 else _free_creep)(w, zeta, start, change)
    return np.maximum(np.maximum(start, 0.0), values[0]), np.minimum(np.minimum(start, 0.0), values[1])


def _free_oscillation(w: Array, zeta: float, start: Array, change: Array) -> tuple[Array, Array]:
    """Return the first maximum and the first minimum of exp(-a t) (C cos K t + V sin(K t)/K).

    C + d = E (C cos K + V sin(K)/K) gives V. The slope, exp(-a t) ((V - a C) cos K t - (C K^2 + a V) sin(K t)/K),
    falls through zero at K t = atan2(K (V - a C), C K^2 + a V) and rises through it half a turn later.
    """
    a, K = zeta * w, poles(w, zeta)[0].imag
    E = np.exp(-a)
    V = (change + start * (2.0 * E * np.sin(0.5 * K) ** 2 - np.expm1(-a))) * K / (E * np.sin(K))
    top = np.arctan2(K * (V - a * start), start * K**2 + a * V)

    def value(angle: Array) -> Array:
        angle = np.mod(angle, 2.0 * np.pi)
        return np.asarray(np.exp(-a * angle / K) * (start * np.cos(angle) + V * np.sin(angle) / K))

    return value(top), value(top + np.pi)


def _free_creep(w: Array, zeta: float, start: Array, change: Array) -> tuple[Array, Array]:
    """Return the one stationary value of A exp(p1 t) + B exp(p2 t) twice; zero where it is not ahead.

    A + B = C and A expm1(p1) + B expm1(p2) = d; the slope is zero where exp((p1 - p2) t) = -B p2/(A p1).
    """
    p1, p2 = (p.real for p in poles(w, zeta))
    A = (change - start * np.expm1(p2)) / (np.expm1(p1) - np.expm1(p2))
    B = start - A
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.log1p(-(A * p1 + B * p2) / (A * p1)) / (p1 - p2)
    ahead = np.isfinite(t) & (t > 0.0)
    t = np.where(ahead, t, 0.0)
    value = np.where(ahead, A * np.exp(p1 * t) + B * np.exp(p2 * t), 0.0)
    return value, value
