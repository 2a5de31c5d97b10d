"""Uncertainty of a measured quantity from those of its inputs: by the law of propagation, and by Monte Carlo.

Both take the same model: rows of inputs in, rows of quantities out. The law of propagation (JCGM 100:2008, 5.1.2) takes
the sensitivity to each input from a change by its standard uncertainty to both sides (5.1.3, note 2). Monte Carlo
(JCGM 101:2008, clause 7) draws all inputs at once; trials are added until mean, standard uncertainty and both ends of
the coverage interval are known to a tolerance (7.9.4). The first is validated by the second (8.1).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Model = Callable[[Array], Array]
"""Rows of inputs in, rows of quantities out."""

NORMAL, RECTANGULAR, TRIANGULAR, U_SHAPED = "normal", "rectangular", "triangular", "u-shaped"
DIVISORS = {NORMAL: 1.0, RECTANGULAR: math.sqrt(3.0), TRIANGULAR: math.sqrt(6.0), U_SHAPED: math.sqrt(2.0)}
"""Half-width of a distribution over its standard uncertainty (JCGM 100, 4.3.7 and 4.3.9; JCGM 101, 6.4.6 for the
U-shaped one, which is the arc sine distribution); of a normal one, its standard uncertainty is stated."""
PROBABILITY = 0.95
"""Coverage probability of intervals."""
NORMAL_FACTOR = 1.959964
"""Coverage factor of a normal distribution for it."""
TRIALS = 10_000
"""Trials that are added at a time: JCGM 101, 7.9.4 b, asks for max(100/(1 - p), 10 000)."""
MOST_TRIALS = 1_000_000
"""Trials after which it ends in any case: as many as JCGM 101, 7.2.1, expects to do for an interval of 95 %."""
TOLERANCE = 0.25
"""Of the ends of a coverage interval by the law of propagation, in standard uncertainties: JCGM 101, 7.9.2, takes half
a unit of the last digit of the standard uncertainty that counts; this is that of one digit, a 2."""
FINER = 5.0
"""Times that Monte Carlo is better than that (JCGM 101, 8.2)."""


@dataclass(frozen=True)
class InputQuantity:
    """An uncertain input, about an estimate.

    Attributes
    ----------
    name : str
        What it is.
    spread : float
        Half-width of its distribution; of a normal one, its standard uncertainty.
    distribution : str
        ``normal``, ``rectangular``, ``triangular`` or ``u-shaped``.
    estimate : float
        Its middle.
    """

    name: str
    spread: float
    distribution: str = NORMAL
    estimate: float = 0.0

    @property
    def standard(self) -> float:
        """Its standard uncertainty.

        Examples
        --------
        >>> round(InputQuantity("temperature", 0.03, "rectangular").standard, 5)  # 0.03 / sqrt(3)
        0.01732
        """
        return self.spread / DIVISORS[self.distribution]

    def drawn(self, generator: np.random.Generator, count: int) -> Array:
        """Return as many draws of it."""
        if self.distribution == NORMAL:
            unit = generator.standard_normal(count)
        elif self.distribution == RECTANGULAR:
            unit = generator.uniform(-1.0, 1.0, count)
        elif self.distribution == TRIANGULAR:
            unit = generator.uniform(-0.5, 0.5, count) + generator.uniform(-0.5, 0.5, count)
        else:
            unit = np.cos(np.pi * generator.uniform(0.0, 1.0, count))
        return np.asarray(self.estimate + self.spread * unit, dtype=np.float64)


class Propagated(NamedTuple):
    """What the law of propagation gives.

    Attributes
    ----------
    estimate : ndarray
        The quantities at the estimates of the inputs.
    contributions : ndarray
        Inputs x quantities: sensitivity coefficient times standard uncertainty, with its sign.
    """

    estimate: Array
    contributions: Array

    @property
    def standard(self) -> Array:
        """Combined standard uncertainties of the quantities."""
        return np.asarray(np.sqrt(np.sum(self.contributions**2, axis=0)))


class Simulated(NamedTuple):
    """What Monte Carlo gives, a number a quantity.

    Attributes
    ----------
    mean, standard : ndarray
        Mean and standard deviation of the trials.
    low, high : ndarray
        Ends of the probabilistically symmetric coverage interval of 95 %.
    trials : int
        How many there were.
    stable : bool
        Whether all four are known to the tolerance, where they are numbers.
    """

    mean: Array
    standard: Array
    low: Array
    high: Array
    trials: int
    stable: bool

    def validates(self, propagated: Propagated) -> NDArray[np.bool_]:
        """Tell of which quantities both intervals agree within `TOLERANCE` (JCGM 101, 8.1)."""
        half = NORMAL_FACTOR * propagated.standard
        ends = np.abs(propagated.estimate - half - self.low), np.abs(propagated.estimate + half - self.high)
        return np.asarray(np.maximum(*ends) <= TOLERANCE * self.standard)


def law_of_propagation(model: Model, inputs: Sequence[InputQuantity]) -> Propagated:
    """Return estimate and contributions by the law of propagation of uncertainty.

    Theory: :eq:`uncertainty-propagation`.

    Parameters
    ----------
    model : callable
        Rows of inputs in, rows of quantities out.
    inputs : sequence of InputQuantity
        Independent inputs, in the order of its columns.

    Returns
    -------
    Propagated
        Estimate of each quantity, and the contribution of each input to its standard uncertainty.

    Examples
    --------
    >>> both = law_of_propagation(lambda x: x[:, :1] * x[:, 1:], [InputQuantity("a", 0.3, "normal", 3.0),
    ...                                                           InputQuantity("b", 0.4, "normal", 4.0)])
    >>> both.estimate.tolist(), both.contributions.round(9).tolist()
    ([12.0], [[1.2], [1.2]])
    """
    middle = np.array([one.estimate for one in inputs])
    changes = np.diag([one.standard for one in inputs])
    found = model(np.vstack([middle[None, :], middle + changes, middle - changes]))
    count = len(inputs)
    return Propagated(found[0], 0.5 * (found[1 : count + 1] - found[count + 1 :]))


def monte_carlo(
    model: Model,
    inputs: Sequence[InputQuantity],
    seed: int = 0,
    tolerance: float = TOLERANCE / FINER,
    most: int = MOST_TRIALS,
) -> Simulated:
    """Return mean, standard uncertainty and coverage interval by the adaptive Monte Carlo procedure.

    Parameters
    ----------
    model, inputs
        As of `law_of_propagation`.
    seed : int, optional
        Equal seeds give equal results.
    tolerance : float, optional
        To what mean, standard uncertainty and ends of the interval are known (twice their standard deviations over the
        batches), in standard uncertainties.
    most : int, optional
        Trials after which it ends in any case.

    Examples
    --------
    >>> found = monte_carlo(lambda x: np.sum(x, axis=1, keepdims=True), [InputQuantity("x", 1.0)] * 4)
    >>> found.low.round(1).tolist(), found.standard.round(1).tolist(), found.high.round(1).tolist(), found.stable
    ([-3.9], [2.0], [3.9], True)
    """
    generator = np.random.default_rng(seed)
    batches: list[Array] = []
    figures: list[Array] = []
    stable = False
    tail = 0.5 * (1.0 - PROBABILITY)
    while not stable and TRIALS * len(batches) < most:
        batch = model(np.column_stack([one.drawn(generator, TRIALS) for one in inputs]))
        batches.append(batch)
        ends = np.quantile(batch, [tail, 1.0 - tail], axis=0)
        figures.append(np.array([np.mean(batch, axis=0), np.std(batch, axis=0, ddof=1), *ends]))
        count = len(figures)
        if count > 1:
            over = np.std(figures, axis=0, ddof=1) / math.sqrt(count)
            spread = np.std(np.concatenate(batches), axis=0, ddof=1)
            stable = bool(np.all((2.0 * over <= tolerance * spread) | np.isnan(spread)))
    every = np.concatenate(batches)
    low, high = np.quantile(every, [tail, 1.0 - tail], axis=0)
    return Simulated(np.mean(every, axis=0), np.std(every, axis=0, ddof=1), low, high, every.shape[0], stable)
