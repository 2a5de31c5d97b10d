"""A shock response spectrum against a specification: breakpoints, tolerance in dB by band, shares of the band."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.specifications.decisions import CANNOT_TELL, FAIL, PASS, Rule
from strikewave.specifications.judging import Clause, Limits, refused, weakest

Array = NDArray[np.float64]


class DecibelBand(NamedTuple):
    """Tolerance of a spectrum within frequencies, dB about the nominal one."""

    first: float
    last: float
    low: float
    high: float
    status: str


@dataclass(frozen=True)
class SpectrumLimits:
    """What a specification asks of a spectrum, in SI.

    Attributes
    ----------
    frequency, level : tuple of float
        Breakpoints, Hz and the unit of the kind; straight lines between them on logarithmic axes.
    status : str
        Of the breakpoints.
    q, kind, side, per_octave
        The spectrum that is meant.
    bands : tuple of DecibelBand
        Tolerances.
    share : Limits
        Share of the natural frequencies, evenly spread in octaves, that must lie within them.
    share_above : Limits or None
        Share that must reach the nominal level.
    """

    frequency: tuple[float, ...]
    level: tuple[float, ...]
    status: str
    q: float
    kind: str
    side: str
    per_octave: float
    bands: tuple[DecibelBand, ...]
    share: Limits
    share_above: Limits | None = None

    def nominal(self, frequency: ArrayLike) -> Array:
        """Return the nominal spectrum at natural frequencies, Hz.

        Examples
        --------
        >>> limits = SpectrumLimits((10.0, 1000.0), (1.0, 100.0), "quoted", 10.0, "absolute", "maximax", 12.0, (),
        ...                         Limits(1.0, 1.0, "quoted"))
        >>> limits.nominal([100.0]).round(6).tolist()
        [10.0]
        """
        return np.exp(np.interp(np.log(frequency), np.log(self.frequency), np.log(self.level)))

    def grid(self) -> Array:
        """Return the natural frequencies at which it is judged, Hz: evenly in octaves, both ends included."""
        octaves = math.log2(self.frequency[-1] / self.frequency[0])
        return np.geomspace(self.frequency[0], self.frequency[-1], max(math.ceil(octaves * self.per_octave) + 1, 2))

    def curves(self, frequency: Array) -> tuple[Array, Array]:
        """Return the lower and the upper limit at natural frequencies, Hz; NaN where no tolerance is stated."""
        low, high = np.full(frequency.shape, np.nan), np.full(frequency.shape, np.nan)
        for band in self.bands:
            inside = (frequency >= band.first * (1.0 - 1e-9)) & (frequency <= band.last * (1.0 + 1e-9))
            low[inside], high[inside] = band.low, band.high
        nominal = self.nominal(frequency)
        return nominal * 10.0 ** (low / 20.0), nominal * 10.0 ** (high / 20.0)


def judge_spectrum(
    frequency: Array,
    values: Array,
    limits: SpectrumLimits,
    uncertainty: float = 0.0,
    rule: Rule = "simple",
    strict: bool = False,
    trouble: str = "",
) -> tuple[Clause, ...]:
    """Judge a spectrum.

    With a guarded decision the spectrum must pass as measured, and moved up and down by its uncertainty.

    Parameters
    ----------
    frequency, values : ndarray
        Natural frequencies, Hz, those of `SpectrumLimits.grid`, and the spectrum.
    limits : SpectrumLimits
        What is asked.
    uncertainty : float, optional
        Expanded uncertainty, k = 2, as a share.
    rule, strict
        As of `judge_shock`.
    trouble : str, optional
        Why the spectrum is not to be trusted.

    Examples
    --------
    >>> limits = SpectrumLimits((10.0, 1000.0), (1.0, 100.0), "quoted", 10.0, "absolute", "maximax", 12.0,
    ...                         (DecibelBand(10.0, 1000.0, -3.0, 3.0, "quoted"),), Limits(0.9, math.inf, "quoted"))
    >>> f = limits.grid()
    >>> [clause.verdict for clause in judge_spectrum(f, 1.2 * limits.nominal(f), limits)]
    ['pass']
    """
    low, high = limits.curves(frequency)
    nominal = limits.nominal(frequency)
    factors = (1.0, 1.0 + uncertainty, 1.0 / (1.0 + uncertainty)) if rule == "guarded" and uncertainty > 0.0 else (1.0,)
    statuses = [band.status for band in limits.bands]

    def within(factor: float) -> float:
        known = np.isfinite(low)
        inside = (factor * values >= low * (1.0 - 1e-9)) & (factor * values <= high * (1.0 + 1e-9))
        return float(np.mean(inside[known])) if np.any(known) else math.nan

    def above(factor: float) -> float:
        return float(np.mean(factor * values >= nominal * (1.0 - 1e-9)))

    worst = _worst(frequency, values, low, high)
    status = weakest(limits.status, limits.share.status, *statuses)
    clauses = [_share("share within the tolerance", [within(x) for x in factors], limits.share, status, trouble, worst)]
    if limits.share_above is not None:
        status = weakest(limits.status, limits.share_above.status)
        clauses.append(
            _share("share at or above nominal", [above(x) for x in factors], limits.share_above, status, trouble, "")
        )
    return tuple(refused(clause) for clause in clauses) if strict else tuple(clauses)


def _worst(frequency: Array, values: Array, low: Array, high: Array) -> str:
    """Return where a spectrum is farthest outside, in words; empty where it is nowhere."""
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.fmax(20.0 * np.log10(values / high), 20.0 * np.log10(low / values))
    known = np.flatnonzero(np.isfinite(out))
    if not known.size or out[known].max() <= 0.0:
        return ""
    k = int(known[np.argmax(out[known])])
    side = "above" if values[k] > high[k] else "below"
    return f"{out[k]:.2g} dB {side} the tolerance at {frequency[k]:.4g} Hz"


def _share(name: str, shares: Sequence[float], limits: Limits, status: str, trouble: str, worst: str) -> Clause:
    """Return the clause of a share, which must be enough with every factor."""
    enough = [share >= limits.low - 1e-12 for share in shares]
    verdict = CANNOT_TELL if trouble or math.isnan(shares[0]) else PASS if all(enough) else CANNOT_TELL
    verdict = FAIL if not any(enough) and verdict == CANNOT_TELL and not trouble else verdict
    reason = trouble or worst
    if verdict == CANNOT_TELL and not trouble:
        reason = (
            f"the uncertainty reaches over the limit; {worst}" if worst else "the uncertainty reaches over the limit"
        )
    margin = shares[0] - limits.low
    return Clause(name, shares[0], limits.low, limits.high, margin, "1", math.nan, status, verdict, reason)
