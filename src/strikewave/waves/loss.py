"""Loss in the time domain: springs and dashpots whose loss factor is constant over a band.

A gasket's loss factor (tangent of the loss angle) is a number at a frequency; in the time domain it needs a
causal model. The generalised standard linear solid is a spring beside a few Maxwell branches, and passive for
every input because no spring and no dashpot is negative.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.waves.layers import Branch, LossFit

GOOD_ENOUGH = 0.05
"""Deviation of the loss factor at which no further branch is added: loss factors of materials are known no better."""
FARTHEST = 0.25
"""Deviation of the loss factor beyond which a fit is refused: it would be the loss of another material."""
MOST_BRANCHES = 4
"""Maxwell branches: four hold a loss factor of 1 over two decades to 5 %, and each costs a state of every joint."""
WIDTHS = np.geomspace(0.3, 2.0, 50)
"""Width of the relaxation times beside that of the band, both in logarithms, that are tried, 4 % apart: the best one is
found to 2 %."""
USUAL_BAND = 1e3, 1e5
"""Band in which a loss factor is constant where no other is given, Hz. Chosen: most of a blow of 10 us to 1 ms lies in
it."""
LEAST_REST = 1e-3
"""Share of the storage stiffness that stays for long times, at least: a solid without it would creep without end."""
POINTS, ROUNDS, SCALE_WEIGHT = 121, 6, 1e4
"""Frequencies of the least squares, 60 a decade in the usual band; rounds, after four of which the storage stiffness in
the weights changes by less than 1e-5 (measured); and weight of the row that sets the scale, whose size does not matter,
since what it misses is divided away (measured, from 100 to a million)."""


def dynamic_stiffness(k: float, branches: tuple[Branch, ...], frequency: ArrayLike) -> NDArray[np.complex128]:
    """Return the complex stiffness of a spring with Maxwell branches, N/m.

    K(w) = k + sum k_i (i w tau_i) / (1 + i w tau_i), with w = 2 pi f. The real part is the storage stiffness,
    and imaginary over real part the loss factor. Source: Emmerich & Korn 1987 (generalised Maxwell body).

    Parameters
    ----------
    k : float
        Long-time stiffness, N/m.
    branches : tuple of Branch
        Stiffness k_i (N/m) and relaxation time tau_i (s) of each.
    frequency : array_like
        f, Hz; complex where a signal grows or falls.

    Examples
    --------
    >>> one = Branch(stiffness=1.0, relaxation=1.0)
    >>> print(dynamic_stiffness(1.0, (one,), 1.0 / (2.0 * math.pi)).round(9))
    (1.5+0.5j)
    """
    s = 2j * np.pi * np.asarray(frequency)
    total = np.full(s.shape, complex(k))
    for branch in branches:
        x = s * branch.relaxation
        total += branch.stiffness * x / (1.0 + x)
    return total


def fit_loss(stiffness: float, loss_factor: float, low: float, high: float) -> LossFit:
    """Return the spring and Maxwell branches whose loss factor is constant over a band.

    Relaxation times are spaced evenly in the logarithm, symmetric about the geometric mean of the band; k and
    the k_i follow by non-negative least squares of Im K - eta Re K = 0 over the band, weighted by 1/Re K,
    and the width of the times is the one that leaves the smallest largest deviation. The fewest branches, at
    most 4, that hold the loss factor to 5 % are taken, or else the best. Two decades need three branches up
    to a loss factor of 0.25 and four up to 1. Outside the band the loss falls off as it must in a solid.
    Source: Emmerich & Korn 1987; the width is a search of this project.

    Parameters
    ----------
    stiffness : float
        Storage stiffness at the geometric mean of the band, N/m.
    loss_factor : float
        eta, at least 0; with 0 there are no branches.
    low, high : float
        The band, Hz.

    Raises
    ------
    ValueError
        If a value makes no sense, or no fit comes within 25 % of the loss factor.

    Examples
    --------
    >>> fit = fit_loss(1e7, 0.3, 1e3, 1e5)
    >>> len(fit.branches), round(fit.error, 3), round(fit.stiffness / 1e7, 3)
    (4, 0.026, 0.471)
    >>> K = dynamic_stiffness(fit.stiffness, fit.branches, 1e4)
    >>> print((K.real / 1e7).round(9), (K.imag / K.real).round(2))
    1.0 0.29
    """
    if not 0.0 < stiffness < math.inf:
        raise ValueError(f"the stiffness must be above zero and finite, got {stiffness!r}")
    if not 0.0 <= loss_factor < math.inf:
        raise ValueError(f"the loss factor must be zero or above and finite, got {loss_factor!r}")
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"the band must rise from above zero to a finite frequency, got {low!r} to {high!r} Hz")
    if loss_factor == 0.0:
        return LossFit(float(stiffness), (), 0.0, (float(low), float(high)))
    share, branches, error = _shares(float(loss_factor), float(low), float(high))
    scaled = tuple(Branch(stiffness * branch.stiffness, branch.relaxation) for branch in branches)
    return LossFit(stiffness * share, scaled, error, (float(low), float(high)))


@functools.lru_cache(maxsize=256)
def _shares(eta: float, low: float, high: float) -> tuple[float, tuple[Branch, ...], float]:
    """Return k, branches and error for a storage stiffness of one."""
    best: tuple[float, NDArray[np.float64], NDArray[np.float64]] | None = None
    for count in range(1, MOST_BRANCHES + 1):
        for width in WIDTHS if count > 1 else [1.0]:
            error, shares, times = _least_squares(eta, low, high, count, width)
            if shares[0] > LEAST_REST and (best is None or error < best[0]):
                best = error, shares, times
        if best is not None and best[0] <= GOOD_ENOUGH:
            break
    if best is None or best[0] > FARTHEST:
        closest = "" if best is None else f" (the closest is {100 * best[0]:.0f} % off)"
        raise ValueError(
            f"a loss factor of {eta:g} over {low:g} to {high:g} Hz cannot be held by {MOST_BRANCHES} Maxwell "
            f"branches{closest}: take a smaller loss factor or a narrower band"
        )
    error, shares, times = best
    branches = tuple(Branch(float(k), float(tau)) for k, tau in zip(shares[1:], times, strict=True) if k > 0.0)
    return float(shares[0]), branches, error


def _least_squares(
    eta: float, low: float, high: float, count: int, width: float
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return largest deviation, k with the k_i, and the relaxation times, for one width of the times."""
    middle = math.sqrt(low * high)
    half = 0.5 * width * math.log(high / low)
    times = np.exp(np.linspace(half, -half, count) if count > 1 else np.zeros(1)) / (2.0 * np.pi * middle)
    x = 2.0 * np.pi * np.append(np.geomspace(low, high, POINTS), middle)[:, None] * times
    K = np.column_stack([np.ones(x.shape[0]), x * (x + 1j) / (1.0 + x * x)])
    from scipy import optimize

    K, K_middle = K[:-1], K[-1].real
    storage = np.ones(K.shape[0])
    right = np.append(np.zeros(K.shape[0]), SCALE_WEIGHT)
    for _ in range(ROUNDS):
        rows = (K.imag / eta - K.real) / storage[:, None]
        shares = optimize.nnls(np.vstack([rows, SCALE_WEIGHT * K_middle]), right)[0]
        shares = shares / (K_middle @ shares)
        storage = K.real @ shares
    return float(np.max(np.abs(K.imag @ shares / (eta * storage) - 1.0))), shares, times
