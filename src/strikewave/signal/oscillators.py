"""Oscillators on a base whose acceleration runs straight between samples, and their largest responses.

z'' + 2 zeta w z' + w^2 z = x, with base acceleration x and z = base minus mass: a base that starts upwards gives
a positive z first. Three responses, see `Response`: z itself, z', and the absolute acceleration of the mass,
w^2 z + 2 zeta w z'. Impulse responses are h = exp(-a t) (even cos(K t) + odd sin(K t)/K); a = zeta w,
K^2 = w^2 - a^2. All times here are in steps. Beyond critical damping K is imaginary and the same formulas hold; at
critical damping K is kept at 1e-7 w, which shifts a response by 1e-14.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.signal import _srs_kernels as kernels

Array = NDArray[np.float64]


def legendre(count: int) -> tuple[Array, Array]:
    """Return places and weights of the Gauss-Legendre rule on 0 to 1."""
    places, weights = np.polynomial.legendre.leggauss(count)
    return np.asarray(0.5 * (places + 1.0)), np.asarray(0.5 * weights)


# Gauss-Legendre rule on 0 to 1; exact to rounding up to eight decay times or half a period (3e-14, measured)
NODES, WEIGHTS = legendre(24)

FEW = legendre(8)  # the same, up to one radian or decay time: 6 nodes leave 8e-14, 8 leave 2e-15 (measured)

STIFF = 8.0  # decay times a step where closed forms begin: the rule is exact below, their differences above one

# Smallest |K|/w: K in a denominator must not vanish, and its square, 1e-14, is what a response is off by
CRITICAL = 1e-7

# Places in a step at which a response is looked at: dense at its start, where fast modes die
PLACES = np.linspace(0.0, 1.0, 17) ** 2

BETWEEN_PLACES = 1.1  # factor of P and R of `bend` between places; measured: 1.008 up to 3 times critical damping

# Least 1 - 2 a - w^2/8 at which that formula bounds a peak inside a step: below, the largest P and R bound it better
CALM = 0.5

SERIES_TERMS = 8  # terms of sin(K v)/K beyond the first, |K v| below 1: the next is 1e-16


class Response(NamedTuple):
    """Response of an oscillator, f: f'' + 2 a f' + w^2 f = level x + slope x'.

    Attributes
    ----------
    even, odd : ndarray
        Coefficients of the impulse response, exp(-a t) (even cos(K t) + odd sin(K t)/K).
    mode : callable
        m(p) of each pole p; the impulse response is also (m(p1) exp(p1 t) - m(p2) exp(p2 t)) / (p1 - p2).
    level, slope : ndarray
        Loads of the oscillator by the base acceleration and by its slope.
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


# Kinds of spectra: what is looked at of the oscillator, and the powers of 2 pi f and of the step that make SI of it
KINDS = {
    "absolute": (acceleration, 0, 0),
    "displacement": (displacement, 0, 2),
    "relative-velocity": (velocity, 0, 1),
    "pseudo-velocity": (displacement, 1, 2),
    "equivalent-static": (displacement, 2, 2),
}

SMOOTH = 20  # samples a period below which straight lines are no longer good: they lose (pi/20)^2/3 = 0.8 % there

# A frequency takes the least that leaves `SMOOTH` samples a period; few, as each costs a pass
FACTORS = (1, 2, 4, 8, 10)

_ROUNDING = 1e-12  # relative rounding of the samples a period of a frequency at the edge of a factor


class Group(NamedTuple):
    """Frequencies that need the same factor of interpolation: which of all, w = 2 pi f, and the step after it, s."""

    factor: int
    members: NDArray[np.intp]
    w: Array
    step: float

    def oscillators(self, q: float, kind: str) -> tuple[Bank, Array]:
        """Return oscillators of these frequencies, and what makes SI of a response counted in steps."""
        response, of_frequency, of_step = KINDS[kind]
        return bank(self.w * self.step, 0.5 / q, response), self.w**of_frequency * self.step**of_step


def groups(step: float, fn: Array, upsample: bool = True) -> Iterator[Group]:
    """Yield the frequencies by the interpolation that they need."""
    needed = np.searchsorted(FACTORS, SMOOTH * fn * step * (1.0 - _ROUNDING)) if upsample else np.zeros(fn.size, int)
    for i in np.unique(needed):
        members = np.flatnonzero(needed == i)
        yield Group(FACTORS[i], members, 2.0 * np.pi * fn[members], step / FACTORS[i])


REACH = 32  # samples on each side that interpolation looks at: flat within 1e-4 up to 0.46 of the sampling rate

KAISER = 8.0  # shape of its Kaiser window: 6 and 10 leave 5e-4 and 2.5e-3 with as many samples (measured)

BLOCK = 4096  # samples whose responses are held together: 100 frequencies of them take 3 MB, which stays in a cache

# Half widths, in steps, of the parabolas about a peak: the error of each is of the third power of its width
NARROWER = (0.08, 0.01, 0.001)

TINY = 1e-300  # least magnitude of a curvature as a divisor


def interpolate(history: Array, factor: int) -> Array:
    """Interpolate a history band-limited, so that straight lines between the new samples carry its spectrum.

    Lines between samples of a rate r attenuate by sinc^2(f/r), about 1 - (2 pi f/r)^2/12; three weights -1/12, 14/12,
    -1/12 take that back up to order four. Outside, the history is held: a record cut while it is not
    zero is not made to ring.
    """
    if factor == 1:
        return history
    from scipy import signal

    reach = REACH * factor
    taps = factor * signal.firwin(2 * reach + 1, 1.0 / factor, window=("kaiser", KAISER))
    taps = np.convolve(taps, np.array([-1.0, 14.0, -1.0]) / 12.0)
    padded = np.pad(history, REACH + 1, mode="edge")
    first = (REACH + 1) * factor + reach + 1
    fine = signal.upfirdn(taps, padded, up=factor)
    return np.ascontiguousarray(fine[first : first + (history.size - 1) * factor + 1])


def framed(body: Array, factor: int, level: float = 0.0) -> tuple[Array, Array]:
    """Return a record with its rise from a level over one step of the original, and its fall to zero over one step."""
    ramp = np.arange(1, factor) / factor
    rising = np.concatenate([level + ramp * (body[0] - level), body]) if factor > 1 else body
    return rising, np.concatenate([ramp[::-1] * body[-1], np.zeros(1)])


def at_rest(oscillators: Bank, level: float) -> Array:
    """Return the state of oscillators whose base has had an acceleration for ever: response and its change."""
    static = level * oscillators.static / oscillators.weight
    return np.stack([static, np.zeros_like(static)])


def extremes(x: Array, tail: Array, oscillators: Bank, part: str, level: float = 0.0) -> tuple[Array, Array]:
    """Return the magnitudes of the largest responses while the record ``x`` lasts, after it, or both.

    ``level`` is the acceleration that the base has had for ever before the record.
    """
    state = at_rest(oscillators, level)
    during = _stretch(x, np.full(2, level), oscillators, state, part != "residual")
    if part == "primary":
        return during
    before = np.concatenate([np.full(1, level), x[-2:]])[-2:]
    after = _stretch(tail, before, oscillators, state, True)
    decay, stiffness, _, second = oscillators.filters
    change = decay * state[1] - stiffness * state[0] + second * np.concatenate([before, tail])[-2]
    weight = oscillators.weight
    free = free_extremes(oscillators.frequency, oscillators.damping, weight * state[0], weight * change)
    sides = np.maximum(after[0], free[0]), np.maximum(after[1], -free[1])
    return sides if part == "residual" else (np.maximum(sides[0], during[0]), np.maximum(sides[1], during[1]))


def followed(x: Array, oscillators: Bank, level: float = 0.0) -> Iterator[Array]:
    """Yield the responses at the samples, blocks of rows, a column an oscillator; see `extremes`."""
    state, before = at_rest(oscillators, level), np.full(2, level)
    for begin in range(0, x.size, BLOCK):
        part = x[begin : begin + BLOCK]
        history = np.empty((part.size, oscillators.frequency.size))
        kernels.follow(part, before, oscillators.filters, state, history)
        before = np.concatenate([before, part])[-2:]
        history *= oscillators.weight
        yield history


def largest_sum(blocks: Iterable[tuple[Array, ...]]) -> Array:
    """Return the root of the largest sum of squares at one instant, by a parabola through three samples."""
    best = np.zeros(0)
    last = np.zeros((0, 0))
    for block in blocks:
        squares = sum((axis**2 for axis in block[1:]), start=block[0] ** 2)
        best = best if best.size else np.zeros(squares.shape[1])
        squares = np.concatenate([last, squares]) if last.size else squares
        best = np.maximum(best, _tops(squares))
        last = squares[-2:]
    return np.asarray(np.sqrt(best))


def _tops(squares: Array) -> Array:
    """Return the largest value of each column, between its samples."""
    k = np.clip(np.argmax(squares, axis=0), 1, max(squares.shape[0] - 2, 1))
    if squares.shape[0] < 3:
        return np.asarray(squares.max(axis=0))
    column = np.arange(squares.shape[1])
    low, middle, high = (squares[k + shift, column] for shift in (-1, 0, 1))
    curvature = low - 2.0 * middle + high
    top = middle - np.where(curvature < 0.0, (high - low) ** 2 / (8.0 * np.minimum(curvature, -TINY)), 0.0)
    inside = (middle >= low) & (middle >= high)
    return np.asarray(np.where(inside, top, np.maximum(np.maximum(low, high), middle)))


def _stretch(x: Array, before: Array, oscillators: Bank, state: Array, counts: bool) -> tuple[Array, Array]:
    """Take the state through the samples; return the largest responses of either sign, where this part counts."""
    segments = -(-x.size // kernels.SEGMENT)
    record = np.empty((4, segments, state.shape[1]))
    kernels.march(x, before, oscillators.filters, state, record)
    if not counts:
        return state[0], state[1]
    load = np.empty((2, segments))
    kernels.loads(x, before, load)
    peaks = np.zeros((5, 2, state.shape[1]))
    for side, sign in enumerate((1.0, -1.0)):
        shape = (oscillators.shapes, oscillators.bends, PLACES)
        kernels.sharpen(sign, x, before, oscillators.filters, *shape, record, load, peaks[:, side])
    at_samples = np.stack([record[0].max(axis=0), -record[1].min(axis=0)])
    sides = np.maximum(np.maximum(at_samples, _polished(peaks, oscillators)), 0.0) * oscillators.weight
    return sides[0], sides[1]


def _polished(peaks: Array, oscillators: Bank) -> Array:
    """Return the largest and minus the smallest response, by narrow parabolas around the places found in a step."""
    place, start, change, flat, rising = peaks
    sign = np.array([[1.0], [-1.0]])
    for width in NARROWER:
        middle = np.clip(place, width, 1.0 - width)
        u = middle + width * np.array([-1.0, 0.0, 1.0])[:, None, None]
        P, R = bend(oscillators.frequency, oscillators.damping, u)
        low, centre, high = sign * (start + u * change + flat * P + rising * R)
        curvature = low - 2.0 * centre + high
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = np.clip(0.5 * (low - high) / curvature, -1.0, 1.0)
        shift = np.where(curvature < 0.0, shift, np.where(high > low, 1.0, -1.0))
        top = centre + 0.5 * (high - low) * shift + 0.5 * curvature * shift**2
        place = middle + width * shift
    return np.asarray(np.maximum(top, np.maximum(low, high)))
