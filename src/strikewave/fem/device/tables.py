"""Tables that fix the order of a sum on a device."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.mesh import Index


def lists(keys: NDArray[np.integer[Any]], values: NDArray[np.integer[Any]], count: int) -> tuple[Index, Index]:
    """Return where the values of each key begin, (count + 1,), and the values, ascending for each.

    Examples
    --------
    >>> start, places = lists(np.array([1, 0, 1]), np.array([5, 6, 4]), 3)
    >>> start.tolist(), places.tolist()
    ([0, 1, 3, 3], [6, 4, 5])
    """
    order = np.lexsort((values, keys))
    start = np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=count))])
    return start.astype(np.int32), values[order].astype(np.int32)
