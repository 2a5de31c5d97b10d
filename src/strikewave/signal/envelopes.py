"""Several shock spectra as one: the largest of them, and the limit that a share of all shocks stays below."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

PROPORTION, CONFIDENCE = 0.95, 0.5
"""Share of shocks below the limit, and how sure that is, where none is stated: P95/50, usual for maximum expected
environments."""
FEWEST = 3
"""Spectra without which no limit is given: of two the factor is exact and useless (2.3 deviations of two values)."""


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

    Examples
    --------
    >>> [round(tolerance_factor(n, 0.95, 0.95), 3) for n in (3, 10, 50)]
    [7.656, 2.911, 2.065]
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

    Examples
    --------
    >>> tolerance_limit([[90.0], [100.0], [111.0]]).round(1)
    array([122.5])
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
