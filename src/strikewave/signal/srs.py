"""Shock response spectra: the largest responses of oscillators of many natural frequencies to one base acceleration.

The record is taken as straight lines between samples, rising from zero over one step before its first sample and
falling to zero over one step after its last. For that input the spectra are exact: no sample is picked where the
peak lies between two, and the vibration after the record is followed in closed form. The relative displacement is
base minus mass: a base that starts upwards gives a positive spectrum first. Several spectra are joined by the
largest of them, or by the limit that a share of all shocks stays below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.signal.oscillators import KINDS, extremes, followed, framed, groups, interpolate, largest_sum

Array = NDArray[np.float64]

INITIAL = ("rest", "shifted", "steady")  # how a record can begin; see `Scope`
SIDES = ("maximax", "positive", "negative")  # sides of a spectrum: the larger of both polarities, or one of them
# Parts of a response: with the vibration after the shock, without it, or that alone
PARTS = ("total", "primary", "residual")

# Usual of shock spectra: a resonance of 5 % damping is wider than a twelfth of an octave
PER_OCTAVE, QUALITY = 12.0, 10.0

# Periods of free vibration after the record in which its largest vector sum lies: the first swing, and a little
LAST_SWING = 1.05

_SAME_FREQUENCY = 1e-9  # relative rounding of a frequency reached by even ratios


@dataclass(frozen=True)
class Scope:
    """Part of the response that counts, and options for reading the record.

    Attributes
    ----------
    part : str
        "total", "primary" (up to the end of the shock) or "residual" (after it).
    end : float, optional
        End of the shock, s after the first sample; the last sample unless given. What follows is taken as zero.
    upsample : bool
        True if the record is interpolated, band-limited, for frequencies above 1/20 of the sampling rate.
    initial : str
        "rest": the base is at rest and reaches its first sample within one step. "shifted": the first sample is taken
        off all. "steady": the base has had the acceleration of its first sample for ever.
    """

    part: str = "total"
    end: float | None = None
    upsample: bool = True
    initial: str = "rest"


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A shock response spectrum of both polarities.

    Attributes
    ----------
    frequency : ndarray
        Natural frequencies, Hz.
    positive, negative : ndarray
        Magnitudes of the largest responses of either sign: m/s^2 ("absolute", "equivalent-static"), m
        ("displacement") or m/s ("pseudo-velocity", "relative-velocity"), for a record in m/s^2.
    q : float
        Quality factor 1/(2 zeta).
    kind, part : str
        Kind of spectrum and part of the response that were asked for.
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
        """Return the largest responses of a side: "maximax", "positive" or "negative"."""
        if name not in SIDES:
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
        "absolute" acceleration of the mass (m/s^2); relative "displacement" (m) and "relative-velocity" (m/s), base
        minus mass; "pseudo-velocity" (m/s) and "equivalent-static" acceleration (m/s^2): 2 pi f and (2 pi f)^2 times
        the relative displacement.
    scope : Scope, optional
        Part of the response, end of the shock, interpolation.

    Returns
    -------
    Spectrum
        Largest responses of either sign at each frequency, in the unit of ``kind``.

    Raises
    ------
    ValueError
        If a value makes no sense, or a frequency is not below half the sampling rate.

    Notes
    -----
    Sources: ``smallwood-1981``, ``iso-18431-4``. Theory: :eq:`signal-oscillator`.

    Examples
    --------
    A half-sine of 100 m/s^2 and 10 ms; undamped, it is amplified 1.77-fold near 80 Hz:

    >>> pulse = 100.0 * np.sin(np.pi * np.arange(1001) / 1000)
    >>> spectrum = srs(pulse, 1e-5, [1.0, 81.0, 2000.0], q=np.inf)
    >>> spectrum.maximax.round(1)
    array([  4. , 176.8, 102.5])
    """
    [spectrum] = all_srs(values, step, frequencies, [(kind, q)], scope)
    return spectrum


def all_srs(
    values: ArrayLike,
    step: float,
    frequencies: ArrayLike,
    asked: Sequence[tuple[str, float]],
    scope: Scope | None = None,
) -> list[Spectrum]:
    """Return several shock response spectra of one base acceleration, which is interpolated once for all of them.

    Each is, to the bit, what `srs` gives.

    Parameters
    ----------
    values, step, frequencies, scope
        As for `srs`.
    asked : sequence of (str, float)
        Kind and quality factor of each spectrum.

    Raises
    ------
    ValueError
        As for `srs`.

    Examples
    --------
    >>> pulse = 100.0 * np.sin(np.pi * np.arange(1001) / 1000)
    >>> damped, undamped = all_srs(pulse, 1e-5, [81.0], [("absolute", 10.0), ("absolute", np.inf)])
    >>> damped.maximax.round(1), undamped.maximax.round(1)
    (array([165.1]), array([176.8]))
    """
    scope = scope or Scope()
    history, fn = _history(values, step), _natural(frequencies, step)
    for kind, q in asked:
        _check(q, kind, scope)
    if scope.end is not None:
        if not 0.0 < scope.end < math.inf or round(scope.end / step) < 1:
            raise ValueError(f"the end of the shock must come at least one step after its start, got {scope.end!r} s")
        history = history[: round(scope.end / step) + 1]
    history, level = _begun(history, scope.initial)
    spectra = [Spectrum(fn, np.empty_like(fn), np.empty_like(fn), float(q), kind, scope.part) for kind, q in asked]
    for group in groups(step, fn, scope.upsample):
        record, fall = framed(interpolate(history, group.factor), group.factor, level)
        for spectrum in spectra:
            oscillators, unit = group.oscillators(spectrum.q, spectrum.kind)
            sides = extremes(record, fall, oscillators, scope.part, level)
            spectrum.positive[group.members], spectrum.negative[group.members] = (side * unit for side in sides)
    return spectra


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
    for group in groups(step, fn):
        body, (oscillators, unit) = interpolate(history, group.factor), group.oscillators(q, kind)
        for row, start in enumerate(starts):
            part = body[start * group.factor : (start + length - 1) * group.factor + 1]
            sides = extremes(*framed(part, group.factor), oscillators, "total")
            positive[row, group.members], negative[row, group.members] = (side * unit for side in sides)
    return RollingSpectrum(np.asarray((starts + 0.5 * (length - 1)) * step), fn, positive, negative)


def response_history(
    values: ArrayLike, step: float, frequency: float, q: float = QUALITY, kind: str = "absolute", initial: str = "rest"
) -> Array:
    """Return what an oscillator does while the record lasts: its response at each sample.

    Parameters
    ----------
    values, step, q, kind
        As for `srs`.
    frequency : float
        Natural frequency, Hz.
    initial : str, optional
        Beginning of the record; see `Scope`.

    Raises
    ------
    ValueError
        As for `srs`.
    """
    _check(q, kind, Scope(initial=initial))
    history, level = _begun(_history(values, step), initial)
    [group] = groups(step, _natural(frequency, step))
    body, (oscillators, unit) = interpolate(history, group.factor), group.oscillators(q, kind)
    x = framed(body, group.factor, level)[0]
    response = np.concatenate([block[:, 0] for block in followed(x, oscillators, level)])
    return np.asarray(response[x.size - body.size :: group.factor] * unit)


def rms_spectrum(
    values: ArrayLike,
    step: float,
    frequencies: ArrayLike,
    q: float = QUALITY,
    kind: str = "absolute",
    initial: str = "rest",
) -> Array:
    """Return the root mean square of the responses while the record lasts, one a natural frequency.

    For long shocks and vibration; it depends on how long the record goes on after the shock.

    Parameters
    ----------
    values, step, frequencies, q, kind
        As for `srs`.
    initial : str, optional
        Beginning of the record; see `Scope`.

    Raises
    ------
    ValueError
        As for `srs`.
    """
    _check(q, kind, Scope(initial=initial))
    history, level = _begun(_history(values, step), initial)
    fn = _natural(frequencies, step)
    rms = np.empty_like(fn)
    for group in groups(step, fn):
        body, (oscillators, unit) = interpolate(history, group.factor), group.oscillators(q, kind)
        squares = sum(np.sum(block**2, axis=0) for block in followed(body, oscillators, level))
        rms[group.members] = np.sqrt(squares / body.size) * unit
    return rms


def resultant_srs(
    axes: Sequence[ArrayLike],
    step: float,
    frequencies: ArrayLike,
    q: float = QUALITY,
    kind: str = "absolute",
    initial: str = "rest",
) -> Array:
    """Return the largest vector sums of the responses of equal oscillators along several axes, at one instant.

    Never above the root of the sum of the squares of the axes' own spectra, which peak at different instants. The
    free vibration after the record counts.

    Parameters
    ----------
    axes : sequence of array_like
        Acceleration of the base along two or three perpendicular axes, sampled together, m/s^2.
    step, frequencies, q, kind
        As for `srs`.
    initial : str, optional
        Beginning of the record; see `Scope`.

    Raises
    ------
    ValueError
        As for `srs`, and if the axes do not have as many samples.
    """
    _check(q, kind, Scope(initial=initial))
    histories = [_history(values, step) for values in axes]
    if not histories or len({history.size for history in histories}) > 1:
        raise ValueError(f"axes need as many samples each, got {[history.size for history in histories]}")
    fn = _natural(frequencies, step)
    largest = np.empty_like(fn)
    begun = [_begun(history, initial) for history in histories]
    for group in groups(step, fn):
        oscillators, unit = group.oscillators(q, kind)
        swing = np.zeros(math.ceil(LAST_SWING * 2.0 * np.pi / float(np.min(oscillators.frequency))))
        blocks = []
        for history, level in begun:
            framed_history = framed(interpolate(history, group.factor), group.factor, level)
            blocks.append(followed(np.concatenate([*framed_history, swing]), oscillators, level))
        largest[group.members] = largest_sum(zip(*blocks, strict=True)) * unit
    return largest


def _begun(history: Array, initial: str) -> tuple[Array, float]:
    """Return a record as it begins, and the acceleration that its base had for ever before; see `Scope`."""
    if initial == "shifted":
        return history - history[0], 0.0
    return history, float(history[0]) if initial == "steady" else 0.0


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
    for name, got, allowed in (
        ("kind", kind, tuple(KINDS)),
        ("part", scope.part, PARTS),
        ("initial state", scope.initial, INITIAL),
    ):
        if got not in allowed:
            raise ValueError(f"the {name} of a spectrum must be one of {', '.join(allowed)}, got {got!r}")


# Share of shocks below the limit and its confidence: P95/50 of maximum expected environments
PROPORTION, CONFIDENCE = 0.95, 0.5
# Spectra without which no limit is given: of two the factor is exact and useless (2.3 deviations of two values)
FEWEST = 3


def envelope(spectra: Sequence[ArrayLike]) -> Array:
    """Return the largest of several spectra at each frequency.

    Parameters
    ----------
    spectra : sequence of array_like
        One row a shock, at the same frequencies.

    Raises
    ------
    ValueError
        If there is none, or they differ in length.

    Examples
    --------
    >>> envelope([[1.0, 5.0], [2.0, 3.0]])
    array([2., 5.])
    """
    return np.asarray(np.max(_rows(spectra), axis=0))


def tolerance_factor(count: int, proportion: float = PROPORTION, confidence: float = CONFIDENCE) -> float:
    """Return k: mean + k s of ``count`` normal values lies above a share of all values, with a confidence.

    k = t / sqrt(n), with t the quantile of the non-central t distribution of n - 1 degrees of freedom and
    non-centrality z sqrt(n), z the normal quantile of the share.

    Parameters
    ----------
    count : int
        Values, n, two or more.
    proportion, confidence : float, optional
        Share of all values, and confidence that no more lie above.

    Raises
    ------
    ValueError
        If the count is below two, or a share does not lie between 0 and 1.

    Notes
    -----
    Source: ``nist-handbook``.
    """
    from scipy.special import nctdtrit, ndtri

    if count < 2:
        raise ValueError(f"a tolerance limit needs two values or more, got {count}")
    for name, share in (("share of values", proportion), ("confidence", confidence)):
        if not 0.0 < share < 1.0:
            raise ValueError(f"the {name} of a tolerance limit lies between 0 and 1, got {share!r}")
    root = math.sqrt(count)
    return float(nctdtrit(count - 1, float(ndtri(proportion)) * root, confidence)) / root


def tolerance_limit(
    spectra: Sequence[ArrayLike], proportion: float = PROPORTION, confidence: float = CONFIDENCE
) -> Array:
    """Return the normal tolerance limit of several spectra: P95/50 unless asked otherwise.

    At each frequency 10^(m + k s), with mean m and standard deviation s of the decimal logarithms, and k of
    `tolerance_factor`: shock spectra scatter log-normally. A frequency at which one of them is zero has no limit, NaN.

    Parameters
    ----------
    spectra : sequence of array_like
        One row a shock, at the same frequencies; three or more.
    proportion, confidence : float, optional
        Share of all shocks that stays below, and how sure that is.

    Raises
    ------
    ValueError
        If there are fewer than three, they differ in length, or a share makes no sense.

    Notes
    -----
    Source: ``piersol-2009``.
    """
    rows = _rows(spectra)
    if rows.shape[0] < FEWEST:
        raise ValueError(f"a tolerance limit of spectra needs {FEWEST} of them or more, got {rows.shape[0]}")
    factor = tolerance_factor(rows.shape[0], proportion, confidence)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log10(rows)
        limit = 10.0 ** (logs.mean(axis=0) + factor * logs.std(axis=0, ddof=1))
    return np.asarray(np.where(np.all(rows > 0.0, axis=0), limit, np.nan))


def _rows(spectra: Sequence[ArrayLike]) -> Array:
    rows = [np.asarray(row, dtype=float) for row in spectra]
    if not rows or any(row.ndim != 1 for row in rows) or len({row.size for row in rows}) > 1:
        raise ValueError(
            f"spectra need one row each, all at the same frequencies, got shapes {[row.shape for row in rows]}"
        )
    return np.stack(rows)
