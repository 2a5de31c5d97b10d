"""By how much stated numbers are off beyond their uncertainties: what repeats differ by, and what the model lacks.

Repeats of a number at one setting share what the model lacks there, which does not average out over them. So the two
are told apart as in an analysis of variance: within the repeats, and between their means and the fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.studies.fit.noise import CHANCE

Array = NDArray[np.float64]

ALONE = -1
"""Group of a number that is known from elsewhere: the model can lack nothing of it."""
OF_DOUBTS = Quantity.of_data("standard uncertainties")


@declare.dataclass
class Excess:
    """By how much numbers are off; 1 and 0 where chance and their uncertainties explain it.

    ``freedom`` are the degrees of freedom from which these are known; infinite where uncertainties are as stated.
    """

    within: float = declare.number(
        OF_DOUBTS, "by how much repeats of numbers scatter, in their standard uncertainties", default=1.0
    )
    between: float = declare.number(
        OF_DOUBTS, "by how much numbers at a setting are off together, in the same", default=0.0
    )
    freedom: float = math.inf

    @property
    def of_another(self) -> float:
        """Standard deviation of one number at another setting."""
        return math.hypot(self.within, self.between)

    def weight(self, repeats: int) -> float:
        """Return what the uncertainty of each repeat is raised by, so that their mean has the one of both parts."""
        return math.sqrt(self.within**2 + repeats * self.between**2)


def excess_of(residuals: Array, groups: Sequence[int], values: int) -> Excess:
    """Return by how much numbers are off beyond their uncertainties.

    Of n repeats in G groups and p values, the repeats tell the one part with n - G degrees of freedom, and their means
    the other with G - p: the variance at which the weighted sum of squares of the means is as expected (Paule & Mandel
    1982; the values shall be the best under these weights). Without repeats that is the ratio of Birge (1932). Either
    counts where chance makes as much once in a thousand times at most.

    Parameters
    ----------
    residuals : ndarray
        Of the numbers, over their standard uncertainties.
    groups : sequence of int
        Which group each is of: repeats at one setting have one; `ALONE` for one that is known from elsewhere.
    values : int
        How many values are fitted.

    Examples
    --------
    >>> values = np.array([-10.0, 0.0, 10.0])  # three of one value, each sure to 1
    >>> found = excess_of(values, [0, 1, 2], 1)
    >>> round(found.of_another, 9), found.freedom
    (10.0, 2.0)
    >>> excess_of(values / 10.0, [0, 1, 2], 1)
    Excess(within=1.0, between=0.0, freedom=inf)
    """
    from scipy.optimize import brentq
    from scipy.special import chdtri

    of_model = np.array(groups) != ALONE
    apart = float(np.sum(residuals[~of_model] ** 2))
    _, places, repeats = np.unique(np.array(groups)[of_model], return_inverse=True, return_counts=True)
    means = np.bincount(places, residuals[of_model]) / repeats

    scatter, repeated = float(np.sum((residuals[of_model] - means[places]) ** 2)), places.size - repeats.size
    scattered = repeated > 0 and scatter > float(chdtri(repeated, CHANCE))
    within = scatter / repeated if scattered else 1.0

    def left(between: float) -> float:
        return apart + float(np.sum(means**2 / (within / repeats + between)))

    freedom = residuals.size - repeated - values
    if freedom < 1 or not repeats.size or left(0.0) <= float(chdtri(freedom, CHANCE)):
        return Excess(math.sqrt(within), 0.0, float(repeated) if scattered else math.inf)
    most = left(0.0) * float(np.max(within / repeats)) / freedom
    between = brentq(lambda size: left(size) - freedom, 0.0, most) if left(most) < freedom else most
    return Excess(math.sqrt(within), math.sqrt(between), float(freedom))
