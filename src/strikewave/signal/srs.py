"""Shock response spectra: the largest responses of oscillators of many natural frequencies to one base acceleration.

The record is taken as straight lines between samples, rising from zero over one step before its first sample and
falling to zero over one step after its last. For that input the spectra are exact: no sample is picked where the
peak lies between two, and the vibration after the record is followed in closed form. The relative displacement is
base minus mass: a base that starts upwards gives a positive spectrum first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.signal.oscillators import bank
from strikewave.signal.responses import extremes, framed, interpolate

Array = NDArray[np.float64]

KINDS = ("absolute", "displacement", "pseudo-velocity")
"""Responses that a spectrum can be of."""
PARTS = ("total", "primary", "residual")
"""Parts of a response: with the vibration after the shock, without it, or that alone."""

SMOOTH = 20
"""Samples a period below which straight lines are no longer good: they lose (pi/20)^2/3 = 0.8 % there."""

FACTORS = (1, 2, 4, 8, 10)
"""Factors of interpolation: a frequency takes the least that leaves `SMOOTH` samples a period, and 10 serves up to half
the sampling rate; few factors, since the record is gone through once for each."""

PER_OCTAVE, QUALITY = 12.0, 10.0
"""Frequencies an octave, and quality factor, where none is given: the usual ones of shock response spectra, a resonance
of 5 % damping being wider than a twelfth of an octave."""

_ROUNDING, _SAME_FREQUENCY = 1e-12, 1e-9
"""Relative roundings: of the samples a period of a frequency at the edge of a factor, and of a frequency reached by
even ratios."""


@dataclass(frozen=True)
class Scope:
    """Which part of the response counts, and how the record is read.

    Attributes
    ----------
    part : str
        "total", "primary" (up to the end of the shock) or "residual" (after it).
    end : float, optional
        End of the shock, s after the first sample; the last sample unless given. What follows is taken as zero.
    upsample : bool
        Whether the record is interpolated, band-limited, for frequencies above 1/20 of the sampling rate.
    """

    part: str = "total"
    end: float | None = None
    upsample: bool = True


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A shock response spectrum of both polarities.

    Attributes
    ----------
    frequency : ndarray
        Natural frequencies, Hz.
    positive, negative : ndarray
        Magnitudes of the largest responses of either sign: m/s^2 ("absolute"), m ("displacement") or m/s
        ("pseudo-velocity"), for a record in m/s^2.
    q : float
        Quality factor 1/(2 zeta).
    kind, part : str
        What was asked for.
    """

    frequency: Array
    positive: Array
    negative: Array
    q: float
    kind: str
    part: str

    @property
    def maximax(self) -> Array:
        """The larger of both polarities."""
        return np.maximum(self.positive, self.negative)

    def side(self, name: str) -> Array:
        """Return "maximax", "positive" or "negative"."""
        if name not in ("maximax", "positive", "negative"):
            raise ValueError(f"the side of a spectrum must be maximax, positive or negative, got {name!r}")
        return np.asarray(getattr(self, name))


class RollingSpectrum(NamedTuple):
    """Spectra of windows that slide over a record.

    Attributes
    ----------
    time : ndarray
        Middle of each window, s after the first sample.
    frequency : ndarray
        Natural frequencies, Hz.
    positive, negative : ndarray
        Magnitudes of the largest responses, windows x frequencies.
    """

    time: Array
    frequency: Array
    positive: Array
    negative: Array

    @property
    def maximax(self) -> Array:
        """The larger of both polarities."""
        return np.maximum(self.positive, self.negative)


def octaves(low: float, high: float, per_octave: float = PER_OCTAVE) -> Array:
    """Return natural frequencies from low to high at even ratios; high is the last where the ratio meets it.

    Examples
    --------
    >>> octaves(10.0, 40.0, 1)
    array([10., 20., 40.])
    """
    if not (0.0 < low <= high < math.inf and 0.0 < per_octave < math.inf):
        raise ValueError(
            f"octaves need 0 < low <= high and per_octave > 0, all finite, got low={low!r}, high={high!r}, "
            f"per_octave={per_octave!r}"
        )
    count = math.floor(math.log2(high / low) * per_octave + _SAME_FREQUENCY)
    grid = low * 2.0 ** (np.arange(count + 1) / per_octave)
    grid[-1] = high if math.isclose(grid[-1], high, rel_tol=_SAME_FREQUENCY) else grid[-1]
    return np.asarray(grid)


def srs(
    values: ArrayLike,
    step: float,
    frequencies: ArrayLike,
    q: float = QUALITY,
    kind: str = "absolute",
    scope: Scope | None = None,
) -> Spectrum:
    """Return the shock response spectrum of a base acceleration, with what follows the record.

    Parameters
    ----------
    values : array_like
        Acceleration of the base, evenly sampled, m/s^2.
    step : float
        Time between samples, s.
    frequencies : array_like
        Natural frequencies, Hz, below half the sampling rate, in any order.
    q : float, optional
        Quality factor 1/(2 zeta); 0.5 is critical damping, `math.inf` none.
    kind : str, optional
        "absolute" acceleration of the mass (m/s^2), relative "displacement" (m), or "pseudo-velocity", 2 pi f times
        the relative displacement (m/s).
    scope : Scope, optional
        Part of the response, end of the shock, interpolation.

    Raises
    ------
    ValueError
        If a value makes no sense, or a frequency is not below half the sampling rate.

    Sources: ``smallwood-1981``, ``iso-18431-4``.

    Examples
    --------
    A half-sine of 100 m/s^2 and 10 ms; undamped, it is amplified 1.77-fold near 80 Hz:

    >>> pulse = 100.0 * np.sin(np.pi * np.arange(1001) / 1000)
    >>> spectrum = srs(pulse, 1e-5, [1.0, 81.0, 2000.0], q=np.inf)
    >>> spectrum.maximax.round(1)
    array([  4. , 176.8, 102.5])
    """
    scope = scope or Scope()
    history, fn = _history(values, step), _natural(frequencies, step)
    _check(q, kind, scope)
    if scope.end is not None:
        if not 0.0 < scope.end < math.inf or round(scope.end / step) < 1:
            raise ValueError(f"the end of the shock must come at least one step after its start, got {scope.end!r} s")
        history = history[: round(scope.end / step) + 1]
    positive, negative = np.empty_like(fn), np.empty_like(fn)
    for factor, members in _groups(fn, step, scope.upsample):
        body = interpolate(history, factor)
        oscillators = bank(2.0 * np.pi * fn[members] * (step / factor), 0.5 / q, kind == "absolute")
        sides = extremes(*framed(body, factor), oscillators, scope.part)
        positive[members], negative[members] = (side * _unit(kind, fn[members], step / factor) for side in sides)
    return Spectrum(fn, positive, negative, float(q), kind, scope.part)


def rolling_srs(
    values: ArrayLike,
    step: float,
    frequencies: ArrayLike,
    window: tuple[float, float],
    q: float = QUALITY,
    kind: str = "absolute",
) -> RollingSpectrum:
    """Return the spectra of windows that slide over a record, each as if nothing came before or after it.

    Parameters
    ----------
    values, step, frequencies, q, kind
        As for `srs`.
    window : tuple of float
        Length of a window and hop from one to the next, s; windows that pass the end of the record are left out.

    Raises
    ------
    ValueError
        As for `srs`, and if no window of two samples or more lies in the record.

    Examples
    --------
    >>> blows = np.tile(np.concatenate([np.sin(np.pi * np.arange(101) / 100), np.zeros(899)]), 2)
    >>> rolling = rolling_srs(blows, 1e-5, [100.0, 1000.0], window=(0.01, 0.01))
    >>> rolling.time.round(4)
    array([0.005, 0.015])
    >>> rolling.maximax.round(2)
    array([[0.37, 1.62],
           [0.37, 1.62]])
    """
    history, fn = _history(values, step), _natural(frequencies, step)
    _check(q, kind, Scope())
    length, hop = (round(time / step) if 0.0 < time < math.inf else 0 for time in window)
    if length < 2 or hop < 1 or length > history.size:
        raise ValueError(
            f"a window must hold from 2 samples to the whole record ({history.size} samples of {step:g} s), and hop by "
            f"one or more, got window={window!r} s"
        )
    starts = np.arange(0, history.size - length + 1, hop)
    positive, negative = np.empty((starts.size, fn.size)), np.empty((starts.size, fn.size))
    for factor, members in _groups(fn, step, True):
        body = interpolate(history, factor)
        oscillators = bank(2.0 * np.pi * fn[members] * (step / factor), 0.5 / q, kind == "absolute")
        unit = _unit(kind, fn[members], step / factor)
        for row, start in enumerate(starts):
            part = body[start * factor : (start + length - 1) * factor + 1]
            sides = extremes(*framed(part, factor), oscillators, "total")
            positive[row, members], negative[row, members] = (side * unit for side in sides)
    return RollingSpectrum(np.asarray((starts + 0.5 * (length - 1)) * step), fn, positive, negative)


def _groups(fn: Array, step: float, upsample: bool) -> list[tuple[int, NDArray[np.intp]]]:
    """Return factors of interpolation, each with the frequencies that need it."""
    needed = np.searchsorted(FACTORS, SMOOTH * fn * step * (1.0 - _ROUNDING)) if upsample else np.zeros(fn.size, int)
    return [(FACTORS[i], np.flatnonzero(needed == i)) for i in np.unique(needed)]


def _unit(kind: str, fn: Array, step: float) -> Array:
    """Return what a response counted in steps is multiplied by."""
    if kind == "absolute":
        return np.ones_like(fn)
    return step**2 * (2.0 * np.pi * fn if kind == "pseudo-velocity" else np.ones_like(fn))


def _history(values: ArrayLike, step: float) -> Array:
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step must be above zero and finite, got {step!r}")
    history = np.ascontiguousarray(values, dtype=float)
    if history.ndim != 1 or history.size < 2:
        raise ValueError(f"a record must be one row of two samples or more, got shape {history.shape}")
    if not np.all(np.isfinite(history)):
        raise ValueError("the record holds values that are not finite")
    return history


def _natural(frequencies: ArrayLike, step: float) -> Array:
    fn = np.array(frequencies, dtype=float, ndmin=1)
    if fn.ndim != 1 or fn.size == 0 or not np.all((fn > 0.0) & (fn < math.inf)):
        raise ValueError("natural frequencies must be one row of finite values above zero, Hz")
    if np.any(fn >= 0.5 / step):
        raise ValueError(
            f"natural frequencies must lie below half the sampling rate, {0.5 / step:g} Hz, got {fn.max():g} Hz: "
            "leave them out, or record at a higher rate"
        )
    return fn


def _check(q: float, kind: str, scope: Scope) -> None:
    if not q > 0.0:
        raise ValueError(f"the quality factor q must be above zero (math.inf for no damping), got {q!r}")
    for name, got, allowed in (("kind", kind, KINDS), ("part", scope.part, PARTS)):
        if got not in allowed:
            raise ValueError(f"the {name} of a spectrum must be one of {', '.join(allowed)}, got {got!r}")
