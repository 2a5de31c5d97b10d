"""Kernels of pulse finding; `strikewave.records.pulses` explains them."""

import numpy as np

from strikewave.base.compiled import kernel


@kernel
def strongest_boxes(values, level, slope, width, sign, least, boxes):
    """Write the local maxima of the mean over a sliding box, ``sign`` times, above ``least``; return how many.

    ``boxes`` has a row for each: first sample of the box, mean. Maxima closer than a box are one. The line
    ``level + slope k`` is taken off.
    """
    n = values.size
    total = 0.0
    for k in range(width):
        total += values[k] - level - slope * k
    best, place, count = -np.inf, -1, 0
    for k in range(n - width + 1):
        mean = sign * total / width
        if mean > best:
            best, place = mean, k
        elif place >= 0 and k - place >= width:
            if best > least and count < boxes.shape[0]:
                boxes[count, 0], boxes[count, 1] = place, best
                count += 1
            best, place = mean, k
        if k + width < n:
            total += values[k + width] - values[k] - slope * width
    if place >= 0 and best > least and count < boxes.shape[0]:
        boxes[count, 0], boxes[count, 1] = place, best
        count += 1
    return count
