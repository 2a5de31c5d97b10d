"""A sparse polynomial fit to runs at drawn inputs, which gives the share of each input in the variance.

The result is written as a sum of products of polynomials, each in one number drawn, orthonormal under its distribution:
the coefficients squared are then shares of the variance (Sudret 2008), whatever the sample. Of many candidate terms a
few are chosen one after the other, the one first that explains most of what is left (orthogonal least squares, the
forward selection of Blatman and Sudret 2011 with the best term of each step). How many are kept is found by generalized
cross-validation, in which a term counts as three, because it was chosen among many (Friedman 1991).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.uncertainty.draws import UncertainInput

Array = NDArray[np.float64]
Term = tuple[tuple[int, int], ...]
"""Pairs of a number drawn, from 0, and its degree; two of them are an interaction."""

DEGREE = 4
"""Highest degree of a polynomial. Measured on machines of eleven blows: the fifth explains nothing more."""
TOGETHER = 8
"""Numbers drawn of which pairs are tried, those that come first in the fit without pairs: 28 pairs of 3 terms are as
many candidates as runs, and more find accidents."""
COST = 3.0
"""Cost of a chosen term in the cross-validation, in free parameters (Friedman 1991 recommends 2 to 4)."""
MOST_TERMS = 40
"""Most terms: with three parameters each, 128 runs never keep as many."""
PATIENCE = 6  # terms without any gain before the search ends: chosen, so that one accident does not end it
DEPENDENT = 1e-6  # a candidate of which less than this share of its square is new adds nothing but rounding
NOTHING_LEFT = 1e-24  # share of the variance below which the residual is rounding: the square of 1e-12
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)


class _Selection(NamedTuple):
    """Places of the chosen columns, the error that cross-validation expects (a variance), residuals left out singly."""

    chosen: list[int]
    error: float
    left_out: Array


@dataclass(frozen=True, eq=False)
class Expansion:
    """A fit; see `fit_expansion`.

    Attributes
    ----------
    terms : tuple of Term
        Terms of the fit.
    coefficients : ndarray
        The mean, and that of each term.
    error : float
        Variance that it does not explain, as cross-validation expects it.
    left_out : ndarray
        Residual of each run as if it had been left out of the fit, about their mean, of that variance.
    """

    terms: tuple[Term, ...]
    coefficients: Array
    error: float
    left_out: Array

    @property
    def variance(self) -> float:
        """Variance of the result: of the fit, and of what it does not explain."""
        return float(np.sum(self.coefficients[1:] ** 2)) + self.error

    @property
    def explained(self) -> float:
        """Share of the variance that the fit explains; 1 of a result that does not vary."""
        return 1.0 - self.error / self.variance if self.variance > 0.0 else 1.0

    def at(self, polynomials: Array) -> Array:
        """Return the fit at the points of some polynomials."""
        values = np.full(polynomials.shape[1], self.coefficients[0])
        for term, coefficient in zip(self.terms, self.coefficients[1:], strict=True):
            values += coefficient * _column(polynomials, term)
        return values

    def shares(self, owner: Sequence[str]) -> dict[str, float]:
        """Return the share of each input in the variance, by itself; ``owner`` names that of each number drawn."""
        shares = dict.fromkeys(owner, 0.0)
        if self.variance > 0.0:
            for term, coefficient in zip(self.terms, self.coefficients[1:], strict=True):
                owners = {owner[place] for place, _ in term}
                if len(owners) == 1:
                    shares[owners.pop()] += float(coefficient) ** 2 / self.variance
        return shares

    def share_errors(self, owner: Sequence[str], runs: int) -> dict[str, float]:
        """Return the standard errors of `shares`, as the regression on so many runs gives them.

        A coefficient of orthonormal terms has the variance e/n, with e what the fit does not explain, and e itself
        2 e^2/n; by the derivatives of S = sum c_own^2/V, V = sum c^2 + e, these give that of a share. The choice of the
        terms is taken as given.
        """
        squares, variance = self.coefficients[1:] ** 2, self.variance
        if not variance > 0.0:
            return dict.fromkeys(owner, 0.0)
        errors, spread = dict[str, float](), self.error / runs
        owners = [{owner[place] for place, _ in term} for term in self.terms]
        for name, share in self.shares(owner).items():
            own = np.array([of_term == {name} for of_term in owners], dtype=bool)
            slopes = 4.0 * squares * (own - share) ** 2 / variance**2
            errors[name] = float(np.sqrt(spread * slopes.sum() + 2.0 * self.error * spread * (share / variance) ** 2))
        return errors


def polynomials_at(inputs: Sequence[UncertainInput], points: Array, needed: Collection[int] | None = None) -> Array:
    """Return polynomials of degree 1 to `DEGREE` at quantiles of the inputs, shape (numbers drawn, points, degrees).

    They are orthonormal under the distribution of their input: Legendre's where it is even. Of numbers that are not
    among the ``needed`` ones they are 0.

    Examples
    --------
    >>> from strikewave.base.quantities import Range, Value
    >>> x = UncertainInput("x", Value(si=0.5, typed=0.5), Range(""), 0.0, 1.0)
    >>> polynomials_at([x], np.array([[0.0], [1.0]]))[0].round(4).tolist()
    [[-1.7321, 2.2361, -2.6458, 3.0], [1.7321, 2.2361, 2.6458, 3.0]]
    """
    values, place = np.zeros((points.shape[1], len(points), DEGREE)), 0
    for row in inputs:
        places = range(place, place + row.count)
        place += row.count
        if needed is not None and not set(needed) & set(places):
            continue
        nodes = np.vander(_standard(row, 0.5 * (_NODES + 1.0)), DEGREE + 1, increasing=True)
        triangle = np.linalg.qr(np.sqrt(0.5 * _WEIGHTS)[:, None] * nodes, mode="r")
        triangle *= np.sign(np.diag(triangle))[:, None]
        for k in places:
            powers = np.vander(_standard(row, points[:, k]), DEGREE + 1, increasing=True)
            values[k] = np.linalg.solve(triangle.T, powers.T).T[:, 1:]
    return values


def _standard(source: UncertainInput, quantile: Array) -> Array:
    """Return an input at quantiles in units of its width, in which results are smooth."""
    if source.shape != "normal":
        return 2.0 * quantile - 1.0
    return (source.at(quantile) - source.value.si) / source.deviation


def fit_expansion(polynomials: Array, results: Array) -> Expansion:
    """Fit results of runs by few terms in the numbers drawn.

    Parameters
    ----------
    polynomials : ndarray
        At the runs; see `polynomials_at`.
    results : ndarray
        One a run, all of them known.

    Notes
    -----
    Source: ``blatman-sudret-2011``, ``sudret-2008``, ``friedman-1991``.

    Examples
    --------
    >>> from strikewave.base.quantities import Range, Value
    >>> value = Value(si=0.0, typed=0.0)
    >>> inputs = [UncertainInput(name, value, Range(""), -1.0, 1.0) for name in "ab"]
    >>> points = np.random.default_rng(1).random((40, 2))
    >>> results = inputs[0].at(points[:, 0]) + 2.0 * inputs[1].at(points[:, 1])
    >>> fit = fit_expansion(polynomials_at(inputs, points), results)
    >>> {name: round(share, 9) for name, share in fit.shares("ab").items()}
    {'a': 0.2, 'b': 0.8}
    """
    numbers, runs, degrees = polynomials.shape
    alone: list[Term] = [((place, degree),) for place in range(numbers) for degree in range(1, degrees + 1)]
    first = _select(_columns(polynomials, alone), results)
    active = list(dict.fromkeys(alone[k][0][0] for k in first.chosen))
    terms = [term for term in alone if term[0][0] in active or term[0][1] <= 2] + [
        ((a, p), (b, q)) for a, b in combinations(active[:TOGETHER], 2) for p, q in ((1, 1), (1, 2), (2, 1))
    ]
    best = _select(_columns(polynomials, terms), results)
    if first.error <= best.error:  # pairs explain nothing more
        terms, best = alone, first
    chosen = tuple([terms[k] for k in best.chosen])
    matrix = np.column_stack([np.ones(runs), _columns(polynomials, chosen)]) if chosen else np.ones((runs, 1))
    coefficients = np.asarray(np.linalg.lstsq(matrix, results, rcond=None)[0], dtype=np.float64)
    return Expansion(chosen, coefficients, best.error, best.left_out)


def _column(polynomials: Array, term: Term) -> Array:
    """Return a term at the points."""
    column = np.ones(polynomials.shape[1])
    for place, degree in term:
        column = column * polynomials[place, :, degree - 1]
    return column


def _columns(polynomials: Array, terms: Sequence[Term]) -> Array:
    return np.column_stack([_column(polynomials, term) for term in terms])


def _select(columns: Array, results: Array) -> _Selection:
    """Choose columns one after the other, the best first, and keep as many as cross-validation finds good."""
    runs = len(results)
    columns = columns - columns.mean(axis=0)
    whole = np.einsum("ij,ij->j", columns, columns)
    residual, leverage = results - results.mean(), np.full(runs, 1.0 / runs)
    total, chosen = float(residual @ residual), list[int]()
    best = (0, _expected(residual, 0), residual, leverage)
    for count in range(1, MOST_TERMS + 1):
        left = np.einsum("ij,ij->j", columns, columns)
        free = left > DEPENDENT * whole
        gain = np.where(free, (columns.T @ residual) ** 2 / np.where(free, left, 1.0), 0.0)
        place = int(gain.argmax())
        if gain[place] <= NOTHING_LEFT * total or COST * count + 1.0 >= runs:
            break
        unit = columns[:, place] / np.sqrt(left[place])
        residual, leverage = residual - unit * (unit @ residual), leverage + unit**2
        columns = columns - np.outer(unit, unit @ columns)
        chosen.append(place)
        error = _expected(residual, count)
        if error < best[1]:
            best = (count, error, residual, leverage)
        elif count > best[0] + PATIENCE:
            break
    count, error, residual, leverage = best
    left_out = residual / np.maximum(1.0 - leverage, 1e-12)
    left_out -= left_out.mean()
    size = float(np.sqrt(np.mean(left_out**2)))
    return _Selection(chosen[:count], error, left_out * (np.sqrt(error) / size) if size > 0.0 else left_out)


def _expected(residual: Array, terms: int) -> float:
    """Return the squared error of another run, by generalized cross-validation."""
    runs = len(residual)
    free = 1.0 - (1.0 + COST * terms) / runs
    return float(np.mean(residual**2)) / free**2 if free > 0.0 else np.inf
