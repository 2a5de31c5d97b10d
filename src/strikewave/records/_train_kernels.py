"""Kernel of the search for trains; `strikewave.records.trains` explains it."""

import numpy as np

from strikewave.base.compiled import kernel


@kernel
def best_chains(times, weights, period, penalty, most_periods, jitter):
    """Return the weight of the best chain that ends at each contact, and the contact before it; -1 where it begins."""
    score, before = weights.copy(), np.full(times.size, -1)
    first = 0
    for k in range(1, times.size):
        while times[first] < times[k] - (most_periods + jitter) * period:
            first += 1
        best = 0.0
        for earlier in range(first, k):
            gap = (times[k] - times[earlier]) / period
            count = np.rint(gap)
            gain = score[earlier] - (count - 1.0) * penalty
            if count >= 1.0 and abs(gap - count) < jitter and gain > best:
                best, before[k] = gain, earlier
        score[k] += best
    return score, before
