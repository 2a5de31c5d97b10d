"""Shares of the tolerances in the scatter: each alone, or Sobol indices, with bounds.

Alone: all other quantities are nominal. The share in the variance between runs of a figure y is Var(y_i)/Var(y). The
share in the scatter that tolerances add within a run is E(v_i²)/E(v²), with v the coefficient of variation of the peaks
over those of the same blows of the nominal run, which takes out what the dynamics alone do. Where tolerances do not
interact, shares add up to 1; a sum that cannot be 1 is reported.

Sobol indices split a variance whatever the interactions, at several times the runs.

A share is never below 0, but its estimator may be: 0 then stands for it, as for the ends of its bounds, which brings it
nearer to the share in every case. Its standard error, of the bootstrap, is that of the estimator, so that a share of 0
says how large it may be; sums and tests take the estimator as it is, whose mean is the share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, NO_UNIT, NOT_MEASURED, Quantity

Array = NDArray[np.float64]

RESAMPLES = 1000
"""Resamples of the bootstrap: 25 of them lie beyond either bound, so that a bound scatters little itself."""
CONFIDENCE = 0.95
"""Confidence of the bounds of shares: the usual one."""
ROUNDING = 1e-6
"""Relative scatter that a run's steps alone may give, ten times the tolerance of `strikewave.studies.scatter`: a share
of less is not distinct from 0."""
BOOTSTRAP_STREAM = 0xB007
"""Key of the random numbers of the bootstrap: any but the numbers of runs, so that they are not those of the draws."""


@declare.dataclass
class Share:
    """Share of one tolerance, with its standard error and its bounds at 95 %, none of them below 0.

    The total one counts interactions too (Sobol alone).
    """

    path: str = declare.word("path of the tolerance")
    share: float = declare.number(
        Quantity(NO_UNIT, "%", "share", digits=3),
        "its share",
        column=MAIN,
        tables="alone sobol",
        error="standard_error",
        bounds="low high",
    )
    low: float = declare.number(NOT_MEASURED, "low bound of the share at 95 %")
    high: float = declare.number(NOT_MEASURED, "high bound of the share at 95 %")
    floor: float = 0.0
    total: float | None = declare.number(
        Quantity(NO_UNIT, "%", "total", digits=3),
        "its share with interactions",
        default=None,
        optional=True,
        column=MAIN,
        tables="sobol",
        order=1,
        error="total_standard_error",
        bounds="total_low total_high",
    )
    total_low: float | None = declare.number(NOT_MEASURED, "low bound of that", default=None, optional=True)
    total_high: float | None = declare.number(NOT_MEASURED, "high bound of that", default=None, optional=True)
    standard_error: float = declare.number(NOT_MEASURED, "standard error of the share", default=np.nan)
    total_standard_error: float | None = declare.number(
        NOT_MEASURED, "standard error of the total", default=None, optional=True
    )

    @declare.computed(
        declare.word(
            "whether it is distinct from 0 (95 %)",
            key="distinct_from_0",
            label="significant (95 %)",
            is_tag=True,
            column=MAIN,
            tables="alone sobol",
        )
    )
    def distinct(self) -> bool:
        """True if the share is distinct from 0: bounds above what rounding of the runs gives."""
        return self.low > self.floor


@declare.dataclass
class Shares:
    """Shares in one quantity, largest first, and their sum."""

    of: str = declare.word("in which quantity")
    runs: int = declare.count("runs that each rests on", key="runs_each")
    sum: float = declare.number(NOT_MEASURED, "their sum")
    sum_low: float = declare.number(NOT_MEASURED, "low bound of the sum at 95 %")
    sum_high: float = declare.number(NOT_MEASURED, "high bound of the sum at 95 %")
    rows: tuple[Share, ...] = declare.rows(Share, "share of each tolerance")

    @property
    def additive(self) -> bool:
        """True if the sum can be 1: no interaction shows."""
        return self.sum_low <= 1.0 <= self.sum_high


@dataclass(frozen=True)
class Indices:
    """First-order and total Sobol indices."""

    first: Array
    total: Array


def sobol_indices(a: Array, b: Array, mixed: Array) -> Indices:
    """Return first-order and total indices from runs at Sobol's two samples and their mixtures.

    S_i = E(y_B (y_i - y_A))/V (Saltelli et al. 2010, table 2 (b)) with y centred, and T_i = E((y_A - y_i)²)/(2 V)
    (Jansen 1999), V the variance of y_A and y_B together.

    Parameters
    ----------
    a, b : array, shape (..., N)
        Results at the samples A and B.
    mixed : array, shape (groups, ..., N)
        Results at A with the columns of one group from B.

    Notes
    -----
    Source: ``saltelli-2010``, ``jansen-1999``.

    Examples
    --------
    >>> x = np.random.default_rng(1).random((2, 4, 4096))
    >>> a, b = x[0, 0] + 2 * x[0, 1], x[1, 0] + 2 * x[1, 1]
    >>> indices = sobol_indices(a, b, np.array([x[1, 0] + 2 * x[0, 1], x[0, 0] + 2 * x[1, 1]]))
    >>> bool(np.allclose(indices.first, [0.2, 0.8], atol=0.03))
    True
    """
    both = np.concatenate([a, b], axis=-1)
    centre, variance = both.mean(axis=-1, keepdims=True), both.var(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.mean((b - centre) * (mixed - a), axis=-1) / variance
        total = 0.5 * np.mean((a - mixed) ** 2, axis=-1) / variance
    return Indices(first, total)


def mixtures(points: Array, sizes: Sequence[int]) -> tuple[Array, Array, Array]:
    """Return A, B and, for each group of columns, A with that group from B; points have both halves side by side.

    Examples
    --------
    >>> [part.shape for part in mixtures(np.zeros((8, 6)), (1, 2))]
    [(8, 3), (8, 3), (2, 8, 3)]
    """
    a, b = np.split(points, 2, axis=1)
    edges = np.concatenate([[0], np.cumsum(sizes)])
    mixed = np.repeat(a[None], len(sizes), axis=0)
    for k, (begin, end) in enumerate(pairwise(edges)):
        mixed[k, :, begin:end] = b[:, begin:end]
    return a, b, mixed


def sobol_points(dimensions: int, runs: int, seed: int) -> Array:
    """Return scrambled Sobol points for both samples, shape (runs, 2 dimensions); ``runs`` is a power of two."""
    from scipy.stats.qmc import Sobol

    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(seed)))
    return np.asarray(Sobol(2 * dimensions, seed=source).random_base2(round(np.log2(runs))))


def sobol_shares(of: str, paths: Sequence[str], a: Array, b: Array, mixed: Array, seed: int) -> Shares:
    """Return the Sobol indices of a quantity with bootstrap bounds; runs without a result are left out.

    The bootstrap takes the points as random; Sobol's are more even, so that the bounds are on the wide side.
    """
    whole = np.isfinite(a) & np.isfinite(b) & np.isfinite(mixed).all(axis=0)
    a, b, mixed = a[whole], b[whole], mixed[:, whole]
    if not a.size:
        return _unknown(of, paths)
    indices = sobol_indices(a, b, mixed)
    place = _resamples(a.size, seed)
    resampled = [sobol_indices(a[place], b[place], group[place]) for group in mixed]
    firsts = np.array([row.first for row in resampled])
    totals = np.array([row.total for row in resampled])
    first, total = _bounds(firsts), _bounds(totals)
    errors, total_errors = _errors(firsts), _errors(totals)
    rows = [
        Share(
            path,
            *_floats(indices.first[k], *first[:, k]),
            0.0,
            *_floats(indices.total[k], *total[:, k]),
            float(errors[k]),
            float(total_errors[k]),
        )
        for k, path in enumerate(paths)
    ]
    return _shares(of, rows, float(indices.first.sum()), firsts.sum(axis=0), a.size)


def variance_shares(of: str, paths: Sequence[str], whole: Array, alone: Array, seed: int) -> Shares:
    """Return the shares Var(y_i)/Var(y) of each tolerance alone, with bootstrap bounds.

    Parameters
    ----------
    of : str
        Name of the quantity.
    paths : sequence of str
        Paths of the tolerances.
    whole : array, shape (N,)
        Results with all tolerances.
    alone : array, shape (tolerances, N)
        Results of the same draws with one tolerance at a time.
    seed : int
        Seed of the bootstrap.
    """
    rounding = ROUNDING * float(np.mean(whole[np.isfinite(whole)])) if np.isfinite(whole).any() else np.nan
    return _alone(of, paths, whole, alone, lambda y: y.var(axis=-1), rounding, seed)


def scatter_shares(of: str, paths: Sequence[str], whole: Array, alone: Array, seed: int) -> Shares:
    """Return the shares E(v_i²)/E(v²) of each tolerance alone, with bootstrap bounds; see `variance_shares`."""
    return _alone(of, paths, whole, alone, lambda v: np.mean(v**2, axis=-1), ROUNDING, seed)


def _alone(
    of: str,
    paths: Sequence[str],
    whole: Array,
    alone: Array,
    size: Callable[[Array], Array],
    rounding: float,
    seed: int,
) -> Shares:
    """Return the sizes of scatter of each tolerance alone over that of all together."""
    complete = np.isfinite(whole) & np.isfinite(alone).all(axis=0)
    whole, alone = whole[complete], alone[:, complete]
    if not whole.size:
        return _unknown(of, paths)
    place = _resamples(whole.size, seed)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares, floor = size(alone) / size(whole), float(rounding**2 / size(whole))
        resampled = np.array([size(row[place]) for row in alone]) / size(whole[place])
    bounds, errors = _bounds(resampled), _errors(resampled)
    rows = [
        Share(path, *_floats(shares[k], *bounds[:, k]), floor, standard_error=float(errors[k]))
        for k, path in enumerate(paths)
    ]
    return _shares(of, rows, float(shares.sum()), resampled.sum(axis=0), whole.size)


def _unknown(of: str, paths: Sequence[str]) -> Shares:
    """Return shares of which no run says anything."""
    rows = tuple(Share(path, np.nan, np.nan, np.nan) for path in paths)
    return Shares(of, 0, np.nan, np.nan, np.nan, rows)


def _floats(share: float, low: float, high: float) -> tuple[float, float, float]:
    """Return a share and its bounds, 0 in the place of what is below; NaN stays."""
    return _not_below_0(share), _not_below_0(low), _not_below_0(high)


def _not_below_0(value: float) -> float:
    return float(np.maximum(value, 0.0))  # which leaves NaN


def _errors(resampled: Array) -> Array:
    """Return the standard errors of resampled numbers along the last axis; NaN where there are none."""
    if resampled.shape[-1] == 0 or not np.isfinite(resampled).all():
        return np.full(resampled.shape[:-1], np.nan)
    return np.asarray(resampled.std(axis=-1, ddof=1))


def _shares(of: str, rows: list[Share], whole: float, resampled: Array, runs: int) -> Shares:
    low, high = _bounds(resampled)
    ordered = sorted(rows, key=lambda row: -row.share if np.isfinite(row.share) else np.inf)
    return Shares(of, runs, whole, float(low), float(high), tuple(ordered))


def _resamples(count: int, seed: int) -> NDArray[np.int64]:
    """Return places of the bootstrap, shape (resamples, count)."""
    source = np.random.Philox(np.random.SeedSequence(seed, spawn_key=(BOOTSTRAP_STREAM,)))
    return np.random.Generator(source).integers(0, max(count, 1), (RESAMPLES, count))


def _bounds(resampled: Array) -> Array:
    """Return the bounds at 95 % of resampled numbers along the last axis, stacked; NaN where there are none."""
    if resampled.shape[-1] == 0 or not np.isfinite(resampled).all():
        return np.full((2, *resampled.shape[:-1]), np.nan)
    return np.quantile(resampled, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=-1)
