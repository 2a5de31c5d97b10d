"""Covariance of a fitted place: from noise, from residuals beyond noise, and from the scatter over shots.

With J the slopes of the residuals and A = J'J, least squares has the covariance A^-1 B A^-1 under any noise, with B the
covariance of J'r. Three things are known of B, and each holds something that the others cannot see: the noise of each
record; what a model leaves that is no noise; the scatter of J'r over shots. The covariance stated is above all three.

Repeats of a number at one setting share what the model lacks there, which does not average out over them. So the two
are told apart as in an analysis of variance: within the repeats, and between their means and the fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import Quantity

Array = NDArray[np.float64]

CHANCE = 1e-3
"""Probability with which noise alone makes a residual that is said to be more than noise."""
MOST_ORDER, LONGEST, FAINT = 40, 4096, 1e-4
"""Highest order of the autoregression of noise, the lags that it is followed over, and the correlation at which it
ends: what mains and amplifiers leave in a record takes two coefficients each."""
SUPPORTED = 8.0
"""Criterion above the least up to which the samples speak for an order too (Burnham & Anderson 2002: beyond 10 they do
not). With 216 samples the least alone took the error of a pulse in white noise on a slow one for less than 0.6 of what
it was in 55 of 100 draws, the one of these that wanders most in 32; in white noise that is 6 % too wide."""


def autocorrelation(noise: Array) -> Array:
    """Return the autocorrelation of noise by lag, that of the autoregression which explains it best, until it dies out.

    Burg's autoregression of each order up to a tenth of the samples is tried. Of those whose corrected information
    criterion of Akaike (Hurvich & Tsai 1989) is the least or nearly so, the one that wanders most is taken, for pulses
    are slow. Sums of products over a few hundred samples of coloured noise would err by as much as they are.

    Examples
    --------
    >>> source = np.random.default_rng(1).standard_normal(4000)
    >>> walk = np.convolve(source, 0.8 ** np.arange(60))[:4000]
    >>> bool(np.max(np.abs(autocorrelation(walk)[:10] - 0.8 ** np.arange(10))) < 0.06)
    True
    """
    from scipy.signal import correlate, lfilter

    centred = noise - np.mean(noise)
    count, power = centred.size, float(np.mean(centred**2))
    if power == 0.0 or count < 3:
        return np.ones(1)
    forward, backward, weights = centred.copy(), centred.copy(), np.ones(1)
    tried = [(count * math.log(power) + 2.0 * count / (count - 2.0), power, weights)]
    for order in range(1, min(count // 10, MOST_ORDER) + 1):
        ahead, behind = forward[1:], backward[:-1]
        reflected = -2.0 * float(ahead @ behind) / float(ahead @ ahead + behind @ behind)
        weights = np.append(weights, 0.0) + reflected * np.append(weights, 0.0)[::-1]
        forward, backward = ahead + reflected * behind, behind + reflected * ahead
        power *= 1.0 - reflected**2
        if power <= 0.0:
            break
        criterion = count * math.log(power) + 2.0 * (order + 1) * count / (count - order - 2.0)
        at_zero = power / max(float(np.sum(weights)) ** 2, np.finfo(float).tiny)  # spectral density at frequency 0
        tried.append((criterion, at_zero, weights))
    least = min(criterion for criterion, _, _ in tried)
    _, _, chosen = max((one for one in tried if one[0] <= least + SUPPORTED), key=lambda one: one[1])
    impulse = np.zeros(LONGEST)
    impulse[0] = 1.0
    answer = lfilter([1.0], chosen, impulse)
    lags = correlate(answer, answer, "full", "fft")[LONGEST - 1 :]
    lags = lags / lags[0]
    kept = np.flatnonzero(np.abs(lags) > FAINT)
    return np.asarray(lags[: int(kept[-1]) + 1])


def independent_count(samples: int, correlation: Array) -> float:
    """Return how many independent samples have as sure a mean square as so many correlated ones.

    Examples
    --------
    >>> independent_count(100, np.ones(1))
    100.0
    """
    shape = correlation / correlation[0]
    return samples / (1.0 + 2.0 * float(np.sum(shape[1:] ** 2)))


RANK = 1e-8
"""Information along a direction, over the largest, below which slopes by steps cannot tell it from none."""
ALONE = 1.0 - 1e-6
"""Share of the information along a direction that one shot has, from which on the others say nothing of its scatter."""
UNDETERMINED = 0.125
"""Standard error in the unit cube from which on a direction counts as undetermined: 95 % then covers half of all that
was allowed, so that hardly more is known than before."""
NAMED = 0.05
"""Share of a coordinate in an undetermined direction, squared, from which on it takes part."""
NORMAL = 1.96
"""Standard deviations that 95 % lie within, where they are known."""
NONE = np.zeros((1, 0))


class ResidualBlock(NamedTuple):
    """Residuals that go together.

    Attributes
    ----------
    rows : slice
        Rows of the residuals.
    noise : ndarray
        Autocovariance of their noise by lag; one number for residuals that are independent.
    shot : int or None
        Number of the shot that they are of; None for what is known from elsewhere.
    left : ndarray or None
        Residuals that remain with the values at their best for this block alone, where that is more than noise.
    shared : ndarray
        Error that they may have in common by the noise that shows it, one standard deviation: a column for the baseline
        of a record.
    stated : ndarray
        The same that is stated, and not read off the noise: a column for the scatter of the amplitude of a record.
    quiet : float
        Independent samples from which the noise is known.
    pooled : bool
        True if it is known together with that of the other blocks that are pooled, from ``quiet`` samples of each.
    """

    rows: slice
    noise: Array
    shot: int | None
    left: Array | None = None
    shared: Array = NONE
    stated: Array = NONE
    quiet: float = math.inf
    pooled: bool = False


class Spread(NamedTuple):
    """A covariance of the place, and the degrees of freedom of each of its variances."""

    covariance: Array
    freedom: Array


class Push(NamedTuple):
    """A part of the covariance of J'r, and the degrees of freedom with which it is known."""

    covariance: Array
    freedom: float


@dataclass(frozen=True)
class Estimate:
    """The best place, and what the data say of it.

    Attributes
    ----------
    place : ndarray
        In the unit cube.
    residuals, jacobian : ndarray
        There; the slopes have a column for each coordinate.
    covariance : ndarray
        Covariance of the place, in the directions that are determined.
    undetermined : ndarray
        Directions that are not, a column each; orthonormal.
    reach : ndarray
        Standard errors that 95 % lie within, to either side, of each coordinate.
    stated : ndarray or None
        Variance of each coordinate by what is stated, where fits to other amplitudes show it.
    """

    place: Array
    residuals: Array
    jacobian: Array
    covariance: Array
    undetermined: Array
    reach: Array
    stated: Array | None = None

    @property
    def misfit(self) -> float:
        """Sum of squares of the residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def errors(self) -> Array:
        """Standard error of each coordinate; infinite where it takes part in an undetermined direction."""
        errors = np.sqrt(np.diag(self.covariance))
        for group in self.groups():
            errors[group] = math.inf
        return np.asarray(errors)

    @property
    def widest(self) -> float:
        """Largest reach of what is determined: that of a prediction, which depends on all of it."""
        determined = self.reach[np.isfinite(self.errors)]
        return float(np.max(determined)) if determined.size else NORMAL

    def mostly_stated(self, coordinate: int) -> bool:
        """Tell whether most of a variance is what is stated and was fitted: no profile of the misfit shows that."""
        return self.stated is not None and bool(2.0 * self.stated[coordinate] > self.covariance[coordinate, coordinate])

    def groups(self) -> list[list[int]]:
        """Return the coordinates that are not determined, those together that only their combination is."""
        projector = self.undetermined @ self.undetermined.T
        left = [k for k in range(self.place.size) if projector[k, k] > NAMED]
        groups: list[list[int]] = []
        while left:
            group, left = [left[0]], left[1:]
            for one in group:  # it grows as its neighbours are found
                near = [k for k in left if abs(projector[one, k]) > NAMED * projector[one, one]]
                group += near
                left = [k for k in left if k not in near]
            groups.append(sorted(group))
        return groups


def estimate(
    place: Array, residuals: Array, jacobian: Array, blocks: Sequence[ResidualBlock], moved: Array | None = None
) -> Estimate:
    """Return what the data say of a place; directions without information are left out of the covariance.

    The interval of a coordinate is the widest of those by noise, by what is left, and by shots, each with Student's t.
    Theory: :eq:`fit-covariance`.

    Parameters
    ----------
    place : ndarray
        The best place, shape (n,).
    residuals : ndarray
        There, over their standard deviations, shape (m,).
    jacobian : ndarray
        Slopes of the residuals, shape (m, n).
    blocks : sequence of ResidualBlock
        Blocks of residuals of one record or number.
    moved : ndarray, optional
        Shifts of the best place by the stated errors that residuals share, in columns whose squares add up to its
        covariance; computed from the slopes where it is left out.

    Returns
    -------
    Estimate
        Covariance, intervals and directions without information, in the coordinates of ``place``.
    """
    values, vectors = np.linalg.eigh(jacobian.T @ jacobian)
    known = vectors[:, values > RANK * max(float(values[-1]), np.finfo(float).tiny)]
    stated = _by_what_is_stated(jacobian, blocks)
    if moved is not None:
        stated = [Push(_shared(jacobian, jacobian @ moved), math.inf)]
    spreads = [by_noise(jacobian, known, blocks, stated)]
    if any(block.left is not None for block in blocks):
        spreads.append(by_what_is_left(jacobian, known, blocks, stated))
    if len({block.shot for block in blocks if block.shot is not None}) > 1:
        spreads.append(scatter_of_shots(residuals, jacobian, known, blocks))
    covariance = spreads[0].covariance
    for spread in spreads[1:]:
        covariance = larger(covariance, spread.covariance)
    values, vectors = np.linalg.eigh(covariance)
    sure = vectors[:, values <= UNDETERMINED**2]
    inside = sure @ sure.T
    inside = inside @ (known @ known.T) @ inside
    values, vectors = np.linalg.eigh(inside)
    kept, lost = vectors[:, values > 0.5], vectors[:, values <= 0.5]
    projected = kept @ kept.T @ covariance @ kept @ kept.T
    fitted = None if moved is None else np.diag(_spread(jacobian, known, stated).covariance)
    return Estimate(place, residuals, jacobian, projected, lost, _reach(covariance, spreads), fitted)


def _reach(covariance: Array, spreads: Sequence[Spread]) -> Array:
    """Return the half width of the 95 % interval of each coordinate over its standard error."""
    from scipy.special import stdtrit

    whole = np.maximum(np.diag(covariance), np.finfo(float).tiny)
    shares = [np.sqrt(np.maximum(np.diag(spread.covariance), 0.0) / whole) for spread in spreads]
    ends = [stdtrit(one.freedom, 0.975) * share for one, share in zip(spreads, shares, strict=True)]
    return np.asarray(np.max([np.full(whole.size, NORMAL), *ends], axis=0))


def _sandwich(jacobian: Array, known: Array, middle: Array) -> Array:
    """Return A^-1 B A^-1 in the directions that are known."""
    inverse = known @ np.linalg.inv(known.T @ jacobian.T @ jacobian @ known) @ known.T
    return np.asarray(inverse @ middle @ inverse)


def _pushed(part: Array, covariance: Array) -> Array:
    """Return the covariance of J'r of residuals with an autocovariance by lag."""
    from scipy.linalg import matmul_toeplitz

    lags = np.zeros(part.shape[0])
    lags[: covariance.size] = covariance[: lags.size]
    return np.asarray(part.T @ (matmul_toeplitz(lags, part) if covariance.size > 1 else lags[0] * part))


def by_noise(jacobian: Array, known: Array, blocks: Sequence[ResidualBlock], stated: Sequence[Push] = ()) -> Spread:
    """Return the covariance by the noise of each block and by what is stated of them.

    Noise is known from as many independent samples as show it, and what is stated is known.
    """
    return _spread(jacobian, known, [*_by_noise_alone(jacobian, blocks), *stated])


def _by_noise_alone(jacobian: Array, blocks: Sequence[ResidualBlock]) -> list[Push]:
    """Return what the noise of each block pushes; that of blocks that are pooled is one."""
    pushes = [
        Push(_pushed(jacobian[block.rows], block.noise) + _shared(jacobian[block.rows], block.shared), block.quiet)
        for block in blocks
    ]
    pooled = [push for push, block in zip(pushes, blocks, strict=True) if block.pooled]
    apart = [push for push, block in zip(pushes, blocks, strict=True) if not block.pooled]
    if not pooled:
        return apart
    return [*apart, Push(np.sum([one.covariance for one in pooled], axis=0), sum(one.freedom for one in pooled))]


def _by_what_is_stated(jacobian: Array, blocks: Sequence[ResidualBlock]) -> list[Push]:
    """Return what is stated of residuals together, such as the scatter of an amplitude, pushes."""
    return [Push(_shared(jacobian[block.rows], block.stated), math.inf) for block in blocks if block.stated.size]


def _shared(part: Array, columns: Array) -> Array:
    """Return the covariance of J'r of what residuals are off together; none where there are no columns."""
    size = part.shape[1]
    pushed = part.T @ columns if columns.size else np.zeros((size, 0))
    return np.asarray(pushed @ pushed.T)


def _spread(jacobian: Array, known: Array, pushes: Sequence[Push]) -> Spread:
    """Return the covariance by independent parts of that of J'r, with the freedom of their sum (Satterthwaite 1946).

    A variance that is known leaves its share of the freedom: with all of it stated the interval is normal.
    """
    parts = [_sandwich(jacobian, known, push.covariance) for push in pushes]
    covariance = np.sum(parts, axis=0)
    spent = np.sum([np.diag(part) ** 2 / one.freedom for part, one in zip(parts, pushes, strict=True)], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        freedom = np.where(spent > 0.0, np.diag(covariance) ** 2 / spent, math.inf)
    return Spread(covariance, freedom)


def by_what_is_left(
    jacobian: Array, known: Array, blocks: Sequence[ResidualBlock], stated: Sequence[Push] = ()
) -> Spread:
    """Return the covariance by what is left of residuals beyond noise, as if any of its phases were as likely.

    What repeats from record to record does not average out: `design_effect` times the sum over independent records. Of
    as many independent samples the fit has taken one for each value, so that what it left is raised by their number.
    """
    size = jacobian.shape[1]
    left, count = np.zeros((size, size)), 0.0
    effect = design_effect([block.left for block in blocks if block.left is not None])
    for block in blocks:
        if block.left is not None:
            covariance = float(block.left @ block.left) / block.left.size * autocorrelation(block.left)
            left += effect * _pushed(jacobian[block.rows], covariance)
            count += independent_count(block.left.size, covariance) / effect
    freedom = max(count - size, 1.0)
    others = _by_noise_alone(jacobian, [block for block in blocks if block.left is None])
    return _spread(jacobian, known, [Push(left * max(count / freedom, 1.0), freedom), *others, *stated])


def design_effect(residuals: Sequence[Array]) -> float:
    """Return by how much the variance of a mean over records is above that of independent ones: 1 + (n - 1) rho.

    rho is the correlation of what is left of two records, pulse laid on pulse (Kish 1965): n where all leave the same,
    1 where they have nothing in common.

    Examples
    --------
    >>> wave = np.sin(np.linspace(0.0, 9.0, 60))
    >>> round(design_effect([wave, wave, 2.0 * wave]), 9), design_effect([wave, -wave])
    (3.0, 1.0)
    """
    if len(residuals) < 2:
        return 1.0
    count = min(residual.size for residual in residuals)
    along = np.linspace(0.0, 1.0, count)
    rows = np.array([np.interp(along, np.linspace(0.0, 1.0, one.size), one) for one in residuals])
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return min(max(float(np.sum(np.sum(rows, axis=0) ** 2)) / len(rows), 1.0), float(len(rows)))


def scatter_of_shots(residuals: Array, jacobian: Array, known: Array, blocks: Sequence[ResidualBlock]) -> Spread:
    """Return the covariance by the scatter of J'r over shots (Liang & Zeger 1986), unbiased (Bell & McCaffrey 2002).

    It holds whatever differs from shot to shot. With M_i = A^-1/2 J_i'J_i A^-1/2, the share of shot i in what is known,
    its J'r is divided by (I - M_i)^1/2, for the fit has followed it; of equal shots that is n/(n - 1). The degrees of
    freedom are Satterthwaite's, n - 1 of equal shots. Where one shot alone informs, the others say nothing of scatter.
    """
    size = jacobian.shape[1]
    values, vectors = np.linalg.eigh(known.T @ jacobian.T @ jacobian @ known)
    root = known @ (vectors / np.sqrt(values))  # A^-1 = root root'
    middle, shares, spreads = np.zeros((values.size, values.size)), list[Array](), list[Array]()
    for block in blocks:
        if block.shot is None:  # no scatter shows how far it may be off: that is stated
            part = jacobian[block.rows] @ root
            middle += part.T @ part
    for shot in sorted({block.shot for block in blocks if block.shot is not None}):
        rows = np.concatenate([np.arange(residuals.size)[block.rows] for block in blocks if block.shot == shot])
        part = jacobian[rows] @ root
        share, axes = np.linalg.eigh(part.T @ part)
        others = np.where(share < ALONE, 1.0 / np.sqrt(np.maximum(1.0 - share, 1.0 - ALONE)), 0.0)
        spread = (axes * others) @ axes.T
        push = spread @ (part.T @ residuals[rows])
        middle += np.outer(push, push)
        shares.append(part.T @ part)
        spreads.append(spread)
    freedom = np.ones(size)
    for k in range(size):
        ways = [spread @ root[k] for spread in spreads]
        felt = np.array([share @ way for share, way in zip(shares, ways, strict=True)])
        shape = np.diag(np.sum(felt * np.array(ways), axis=1)) - felt @ felt.T
        square = float(np.sum(shape**2))
        freedom[k] = max(float(np.trace(shape)) ** 2 / square, 1.0) if square > 0.0 else 1.0
    return Spread(root @ middle @ root.T, freedom)


def larger(one: Array, other: Array) -> Array:
    """Return a covariance that is above both: in no direction is its variance smaller than either's.

    In the coordinates in which the first is the unit matrix, the variances of the second below 1 are raised to it.

    Examples
    --------
    >>> larger(np.diag([1.0, 4.0]), np.diag([9.0, 1.0]))
    array([[9., 0.],
           [0., 4.]])
    """
    values, vectors = np.linalg.eigh(one)
    kept = values > RANK**2 * max(float(values[-1]), np.finfo(float).tiny)
    root, back = vectors[:, kept] * np.sqrt(values[kept]), vectors[:, kept] / np.sqrt(values[kept])
    sizes, axes = np.linalg.eigh(back.T @ other @ back)
    raised = root @ axes
    return np.asarray((raised * np.maximum(sizes, 1.0)) @ raised.T)


KNOWN_ELSEWHERE = -1
"""Group of a number that is known from elsewhere: the model can lack nothing of it."""
OF_DOUBTS = Quantity.of_data("standard uncertainties")


@declare.dataclass
class Excess:
    """Excess scatter of numbers over their uncertainties; 1 and 0 where chance explains it.

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
        Residuals of the numbers, over their standard uncertainties.
    groups : sequence of int
        Group of each number: repeats at one setting have one; `KNOWN_ELSEWHERE` for one that is known from elsewhere.
    values : int
        Number of fitted values.

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

    of_model = np.array(groups) != KNOWN_ELSEWHERE
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
