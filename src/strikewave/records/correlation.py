"""How much of what a fit leaves is new: neighbours that are alike tell the same twice."""

from __future__ import annotations

import numpy as np

from strikewave.records.record import Array


def alike_as_one(rest: Array, most: float = 0.9) -> float:
    """Return how many neighbours count as one: (1 + r) / (1 - r), with the correlation r of a value and the next.

    That of a process of first order, whose mean is uncertain by as much more than that of white noise, squared.

    Parameters
    ----------
    rest : ndarray
        What a fit leaves, in order.
    most : float, optional
        Bound of r: a few values do not tell a longer memory.

    Examples
    --------
    >>> alike_as_one(np.array([1.0, -1.0, 1.0, -1.0])), round(alike_as_one(np.array([1.0, 1.0, -1.0, -1.0])), 2)
    (1.0, 1.67)
    """
    power = float(np.sum(rest**2))
    alike = float(np.sum(rest[1:] * rest[:-1])) / power if power > 0.0 else 0.0
    alike = min(max(alike, 0.0), most)
    return (1.0 + alike) / (1.0 - alike)
