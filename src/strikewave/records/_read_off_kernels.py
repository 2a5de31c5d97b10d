"""Kernels of reading figures off records; `read_off` and `smoothing` in `strikewave.records` explain them."""

import math

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel


@kernel
def row_figures(rows, first, last, width, low, high):
    """Return place, peak, rise and width of the largest value of each row between two samples.

    The width is taken at the share ``width`` of the peak, the rise from its share ``low`` to ``high``.
    """
    figures = np.empty((rows.shape[0], 4))
    for r in range(rows.shape[0]):
        row = rows[r]
        top = first
        for k in range(first + 1, last):
            if row[k] > row[top]:
                top = k
        shift, peak = 0.0, row[top]
        if 0 < top < row.size - 1:
            left, right = row[top - 1], row[top + 1]
            curvature = left - 2.0 * peak + right
            if curvature < 0.0:
                shift = 0.5 * (left - right) / curvature
                peak -= 0.25 * (left - right) * shift
        figures[r, 0], figures[r, 1] = top + shift, peak
        figures[r, 2] = crossed(row, top, high * peak, -1) - crossed(row, top, low * peak, -1)
        figures[r, 3] = crossed(row, top, width * peak, 1) - crossed(row, top, width * peak, -1)
    return figures


@leaf_kernel
def crossed(row, top, level, side):
    """Return where a row first falls to a level, before its top (-1) or after it; NaN where it does not."""
    k = top
    while 0 <= k < row.size and row[k] > level:
        k += side
    if not (0 <= k < row.size and level > 0.0):
        return math.nan
    above = row[min(max(k - side, 0), row.size - 1)]
    return k - side * (level - row[k]) / (above - row[k]) if above > row[k] else float(k)


@kernel
def smoothed_rows(rows, weights):
    """Return rows whose samples are sums of those around them, with some weights; the first and last sample go on."""
    half, count = weights.size // 2, rows.shape[1]
    smoothed = np.zeros_like(rows)
    padded = np.empty(count + 2 * half)
    for r in range(rows.shape[0]):
        padded[:half] = rows[r, 0]
        padded[half : half + count] = rows[r]
        padded[half + count :] = rows[r, count - 1]
        for j in range(weights.size):
            for k in range(count):
                smoothed[r, k] += weights[j] * padded[j + k]
    return smoothed
