"""The largest responses of a bank of oscillators to one record, between its samples and after its end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from strikewave.signal import _srs_kernels as kernels
from strikewave.signal.oscillators import PLACES, Bank, bend, free_extremes

Array = NDArray[np.float64]

REACH = 32
"""Samples on each side that interpolation looks at: flat within 1e-4 up to 0.46 of the sampling rate."""

KAISER = 8.0
"""Shape of its Kaiser window: 6 and 10 leave 5e-4 and 2.5e-3 with as many samples (measured)."""

BLOCK = 4096
"""Samples whose responses are held together: 100 frequencies of them take 3 MB, which stays in a cache."""

NARROWER = (0.08, 0.01, 0.001)
"""Half widths, in steps, of the parabolas about a peak: the error of each is of the third power of its width."""

TINY = 1e-300
"""What a curvature is divided by at least."""


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
