"""Interpolation of a few runs by a Gaussian process: a number at any place, how well it is known, and its error.

Ordinary kriging: y(x) = m + z(x), the mean m unknown, the covariance of z between two places
s^2 (1 + r + r^2/3) exp(-r), r^2 = 5 sum_k ((x_k - x'_k)/l_k)^2 (Matern, 5/2: twice differentiable, as what is smooth
but for kinks). Mean m and variance s^2 are those of the largest likelihood at lengths l_k, the lengths those of the
smallest n ln s^2 + ln det R. What each run comes to by all others needs no further fit (Dubrule 1983).

Source: ``sacks-1989``, ``dubrule-1983``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LENGTHS = (0.05, 10.0)
"""Least and largest length, in shares of a range: within a twentieth of it no few runs see anything, and over ten times
it a number is straight."""
STARTS = (0.3, 1.0, 3.0)
"""Lengths from which the likelihood is climbed, each in all directions: it may have several tops."""
NUGGET = 1e-8  # added to the correlation of a place with itself: runs agree to that, and R stays positive definite


def correlations(one: Array, other: Array, lengths: Array) -> Array:
    """Return the correlations of places, shapes (m, d) and (n, d), as (m, n)."""
    apart = (one[:, None, :] - other[None, :, :]) / lengths
    r = np.sqrt(5.0 * np.sum(apart**2, axis=2))
    return np.asarray((1.0 + r + r**2 / 3.0) * np.exp(-r))


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """A number by its runs.

    Attributes
    ----------
    places : ndarray
        Places of the runs, shape (n, d), 0 to 1.
    values : ndarray
        Shape (n,).
    lengths : ndarray
        Correlation length of each coordinate.
    """

    places: Array
    values: Array
    lengths: Array

    @cached_property
    def inverse(self) -> Array:
        """Inverse of the correlations of the runs, shape (n, n)."""
        from scipy.linalg import cho_solve

        return np.asarray(cho_solve((self._factor, True), np.eye(self.values.size)))

    @cached_property
    def _factor(self) -> Array:
        from scipy.linalg import cholesky

        matrix = correlations(self.places, self.places, self.lengths) + NUGGET * np.eye(self.values.size)
        return np.asarray(cholesky(matrix, lower=True))

    @cached_property
    def mean(self) -> float:
        """The mean m."""
        return float(self.inverse.sum(axis=0) @ self.values / self.inverse.sum())

    @cached_property
    def variance(self) -> float:
        """The variance s^2."""
        off = self.values - self.mean
        return float(off @ self.inverse @ off) / self.values.size

    @property
    def cost(self) -> float:
        """Twice the negative logarithm of the concentrated likelihood, but for a constant."""
        scale = max(self.variance, np.finfo(float).tiny)
        return float(self.values.size * np.log(scale) + 2.0 * np.sum(np.log(np.diag(self._factor))))

    def at(self, places: Array) -> tuple[Array, Array]:
        """Return the number at places, shape (m, d), and its standard deviation there."""
        near = correlations(places, self.places, self.lengths)
        value = self.mean + near @ (self.inverse @ (self.values - self.mean))
        lacking = 1.0 - near @ self.inverse.sum(axis=1)  # what is not known of the mean adds to the variance
        left = 1.0 - np.sum(near @ self.inverse * near, axis=1) + lacking**2 / self.inverse.sum()
        return value, np.sqrt(np.maximum(self.variance * left, 0.0))

    def left_out(self) -> Array:
        """Return each value less what all other runs make of it: at the same lengths, with a mean of their own."""
        sums = self.inverse.sum(axis=0)
        projected = self.inverse - np.outer(sums, sums) / sums.sum()
        return np.asarray(projected @ self.values / np.diag(projected))

    def with_run(self, place: Array) -> GaussianProcess:
        """Return the process as if a run had come to what is expected of it, so that others are sought elsewhere."""
        value, _ = self.at(place[None, :])
        return GaussianProcess(np.vstack([self.places, place]), np.append(self.values, value), self.lengths)


def fitted_process(places: Array, values: Array) -> GaussianProcess:
    """Return the process of the most likely lengths."""
    from scipy.optimize import minimize

    size = places.shape[1]
    bounds = [tuple(np.log(LENGTHS))] * size

    def cost(logs: Array) -> float:
        return GaussianProcess(places, values, np.exp(logs)).cost

    ends = [minimize(cost, np.full(size, np.log(start)), method="L-BFGS-B", bounds=bounds) for start in STARTS]
    best = min(ends, key=lambda end: float(end.fun))
    return GaussianProcess(places, values, np.exp(best.x))
