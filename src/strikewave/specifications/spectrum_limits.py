"""A shock response spectrum against a specification: breakpoints, tolerance in dB by band, shares of the band."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, ROUNDING, Clause, Limits, Rule, refused, weakest

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
    """What a specification asks of a spectrum, in SI."""

    # Breakpoints, Hz and the unit of the kind; straight lines between them on logarithmic axes
    frequency: tuple[float, ...]
    level: tuple[float, ...]
    status: str  # status of the breakpoints
    q: float  # the spectrum that is meant
    kind: str
    side: str
    per_octave: float
    bands: tuple[DecibelBand, ...]  # tolerances
    share: Limits  # share of the natural frequencies, evenly spread in octaves, that must lie within them
    share_above: Limits | None = None  # share that must reach the nominal level

    def nominal(self, frequency: ArrayLike) -> Array:
        """Return the nominal spectrum at natural frequencies, Hz."""
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
    uncertainty: float | Array = 0.0,
    rule: Rule = "simple",
    strict: bool = False,
    trouble: str = "",
) -> tuple[Clause, ...]:
    """Judge a spectrum.

    With a guarded decision the spectrum passes if it does so wherever between up and down by its uncertainty it is
    moved as a whole, and fails if it passes nowhere.
    """
    low, high = limits.curves(frequency)
    nominal = limits.nominal(frequency)
    reach = np.broadcast_to(np.asarray(uncertainty, dtype=np.float64), values.shape)
    guarded = rule == "guarded"
    if guarded and not trouble and np.any(np.isnan(reach)):
        trouble = "its uncertainty is not known"
    statuses = [band.status for band in limits.bands]
    worst = _worst(frequency, values, low, high)
    status = weakest(limits.status, limits.share.status, *statuses)
    known = np.isfinite(low)
    within = _shares(values[known], low[known], high[known], reach[known])
    clauses = [_share("share within the tolerance", within, limits.share, status, trouble, worst, guarded)]
    if limits.share_above is not None:
        status = weakest(limits.status, limits.share_above.status)
        above = _shares(values, nominal, np.full(values.shape, math.inf), reach)
        clauses.append(_share("share at or above nominal", above, limits.share_above, status, trouble, "", guarded))
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
    return f"{out[k]:.2g} dB {side} the tolerance at {frequency[k]:.4g}\xa0Hz"


LEAST = 1e-12  # uncertainty that is taken at least, so that nothing is divided by zero


class _Shares(NamedTuple):
    """Share of a spectrum within its limits: as measured, and the smallest and largest within its uncertainty."""

    measured: float
    least: float
    most: float


def _shares(values: Array, low: Array, high: Array, uncertainty: Array) -> _Shares:
    """Return the share of values within limits, as they are and moved as a whole; NaN where there is none.

    Moved by t from -1 to 1 a value is (1 + U)^t times as large, and lies within from t = ln(low / value) / ln(1 + U) to
    ln(high / value) / ln(1 + U): between two such edges, and from the last to -1 or 1, no share changes.
    """
    if not values.size or not np.all(np.isfinite(values)):
        return _Shares(math.nan, math.nan, math.nan)
    with np.errstate(divide="ignore"):
        room = np.log1p(np.maximum(np.nan_to_num(uncertainty), LEAST))
        first = np.sort((np.log(low / values) - ROUNDING) / room)
        last = np.sort((np.log(high / values) + ROUNDING) / room)
    edges = np.unique(np.clip(np.concatenate([first, last, [-1.0, 0.0, 1.0]]), -1.0, 1.0))
    moves = np.concatenate([[0.0], edges, 0.5 * (edges[1:] + edges[:-1])])
    begun = np.searchsorted(first, moves, "right")
    shares = (begun - np.searchsorted(last, moves, "left")) / values.size
    return _Shares(float(shares[0]), float(shares.min()), float(shares.max()))


def _share(name: str, shares: _Shares, limits: Limits, status: str, trouble: str, worst: str, guarded: bool) -> Clause:
    """Return the clause of a share, which must be enough wherever the spectrum is moved to."""
    enough = limits.low - 1e-12
    reason = trouble or worst
    if trouble or math.isnan(shares.measured):
        verdict = CANNOT_TELL
        reason = trouble or "no tolerance is stated at its natural frequencies, or it could not be measured"
    elif (shares.least if guarded else shares.measured) >= enough:
        verdict = PASS
    elif (shares.most if guarded else shares.measured) < enough:
        verdict = FAIL
    else:
        verdict = CANNOT_TELL
        reason = "; ".join(filter(None, ["the uncertainty reaches over the limit", worst]))
    margin = shares.measured - limits.low
    reach = max(shares.most - shares.measured, shares.measured - shares.least)
    return Clause(name, status, "1", shares.measured, limits.low, limits.high, margin, reach, verdict, reason)
