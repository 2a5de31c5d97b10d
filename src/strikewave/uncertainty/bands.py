"""The band of a result over the ranges of its inputs, and the share of each input in it.

Runs are made at a Latin hypercube of all inputs. A fit to them (`strikewave.uncertainty.expansion`) tells the share of
each input in the variance. Where it explains nearly everything, the ends of the band are those of many draws of the
fit, with what it leaves of the runs added; elsewhere, such as where blows begin to be double or to miss, they are
quantiles of the runs themselves.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.result import Band, BandMethod, InputShare, MovedInput
from strikewave.uncertainty.draws import SEED, UncertainInput, latin_hypercube, normal_quantile
from strikewave.uncertainty.expansion import Expansion, fit_expansion, polynomials_at

Array = NDArray[np.float64]

LEVEL = 0.95
"""Share of the draws within a band, as many beyond either end: the usual one."""
SMOOTH = 0.95
"""Share of the variance that a fit must explain for its draws to give the ends. Chosen: what it leaves is then at most
a fifth of the spread, and is added to the draws; 40 random smooth functions keep the level to 3 points (the tests)."""
RANKED_BELOW = 0.90
"""Share of the variance below which the shares may be those in the variance of the ranks instead: a few blows that
glance or miss, far off from all others, else hide what moves the rest."""
FIT_DRAWS = 8192
"""Draws of the fit: a Latin hypercube of so many gives a quantile of an additive result to 1e-3 of its width."""
FEWEST = 20
"""Fewest runs with a result for a band: fewer have no quantile near the level."""
INPUTS = 3
"""Inputs that a band names."""
LEAST_SHARE = 0.005
"""An input of less than half a per cent of the variance is not named."""
FIT_STREAM, LEFT_STREAM = 1, 2
"""Keys of the random numbers of the draws of a fit, and of what is added to them."""


def moved(row: UncertainInput) -> MovedInput:
    """Return an input as a row of the inputs that moved."""
    return MovedInput(row.path, row.value.typed, row.low, row.high, row.allowed.unit, row.basis, row.reason)


@dataclass(frozen=True, eq=False)
class Sample:
    """Runs at drawn inputs: the inputs, and the quantiles of the runs, shape (runs, numbers drawn)."""

    inputs: Sequence[UncertainInput]
    points: Array
    seed: int = SEED

    @functools.cached_property
    def polynomials(self) -> Array:
        """Polynomials at the runs."""
        return polynomials_at(self.inputs, self.points)

    @functools.cached_property
    def owners(self) -> list[str]:
        """Field of each number drawn."""
        return [row.path for row in self.inputs for _ in range(row.count)]

    @functools.cached_property
    def _many(self) -> Array:
        return latin_hypercube(self.points.shape[1], FIT_DRAWS, self.seed, FIT_STREAM)

    def draws(self, fit: Expansion) -> Array:
        """Return many draws of a fit, with what it leaves of the runs added."""
        needed = {place for term in fit.terms for place, _ in term}
        source = np.random.Generator(np.random.Philox(np.random.SeedSequence(self.seed, spawn_key=(LEFT_STREAM,))))
        return fit.at(polynomials_at(self.inputs, self._many, needed)) + source.choice(fit.left_out, FIT_DRAWS)


class FoundBand(NamedTuple):
    """A band, the share of the variance that no input makes by itself, and the method; see `BandMethod`."""

    band: Band
    rest: float
    fitted: bool
    ranked: bool


def find_band(sample: Sample, results: Array, level: float = LEVEL) -> FoundBand | None:
    """Return the band of a result; None where too few of the runs have it.

    Parameters
    ----------
    sample : Sample
        The runs.
    results : ndarray
        One a run; NaN, where a run has none, is left out.
    level : float, optional
        Share of the draws within the band.

    Examples
    --------
    >>> from strikewave.base.quantities import Range, Value
    >>> inputs = [UncertainInput("a", Value(si=0.0, typed=0.0), Range(""), -1.0, 1.0)]
    >>> points = latin_hypercube(1, 32, 1)
    >>> band = find_band(Sample(inputs, points), 3.0 * inputs[0].at(points[:, 0])).band
    >>> round(band.low, 2), round(band.high, 2), [share.field for share in band.inputs]
    (-2.85, 2.85, ['a'])
    """
    known = np.isfinite(results)
    if known.sum() < FEWEST:
        return None
    results = results[known]
    if np.ptp(results) == 0.0:
        return FoundBand(Band(float(results[0]), float(results[0]), level), 0.0, False, False)
    polynomials = sample.polynomials[:, known]
    fit, ranked = fit_expansion(polynomials, results), False
    fitted = fit.explained >= SMOOTH
    low, high = _band_ends(sample.draws(fit) if fitted else results, level)
    if fit.explained < RANKED_BELOW:
        of_ranks = fit_expansion(polynomials, _normal_scores(results))
        fit, ranked = (of_ranks, True) if of_ranks.explained > fit.explained else (fit, False)
    shares, errors = fit.shares(sample.owners), fit.share_errors(sample.owners, len(results))
    largest = sorted(shares.items(), key=lambda item: -item[1])[:INPUTS]
    named = tuple([InputShare(path, share, errors[path]) for path, share in largest if share >= LEAST_SHARE])
    return FoundBand(Band(low, high, level, named), max(1.0 - sum(shares.values()), 0.0), fitted, ranked)


def _band_ends(values: Array, level: float) -> tuple[float, float]:
    """Return the ends that hold a share of the values: quantile p is the value of rank p (n + 1)."""
    place = np.array([0.5 * (1.0 - level), 0.5 * (1.0 + level)]) * (len(values) + 1) - 1.0
    low, high = np.interp(place, np.arange(len(values)), np.sort(values))
    return float(low), float(high)


def _normal_scores(results: Array) -> Array:
    """Return the normal quantile of the rank of each result."""
    ranks = np.empty(len(results))
    ranks[np.argsort(results, kind="stable")] = np.arange(len(results))
    return normal_quantile((ranks + 0.5) / len(results))


def find_bands(sample: Sample, results: Mapping[str, Array], method: BandMethod) -> tuple[dict[str, Band], BandMethod]:
    """Return the band of each result that has one, and the method completed by these bands."""
    bands, rest = dict[str, Band](), dict(method.rest)
    fitted, ranked = list(method.fitted), list(method.ranked)
    for name, values in results.items():
        row = find_band(sample, values)
        if row is not None:
            bands[name], rest[name] = row.band, row.rest
            fitted += [name] * row.fitted
            ranked += [name] * row.ranked
    inputs = tuple(map(moved, sample.inputs))
    return bands, dataclasses.replace(method, rest=rest, fitted=tuple(fitted), ranked=tuple(ranked), inputs=inputs)
