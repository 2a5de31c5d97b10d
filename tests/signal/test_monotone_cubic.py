"""The monotone cubic against scipy's, and what it promises."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from strikewave.signal.monotone_cubic import monotone_cubic


@pytest.mark.parametrize("seed", range(20))
def test_values_and_slopes_are_those_of_scipy_to_the_last_bit(seed):
    """Steps, plateaus, extremes, jumps, few samples, times before and after the samples."""
    source = np.random.default_rng(seed)
    count = int(source.integers(2, 40))
    times = np.cumsum(source.uniform(0.1, 1.0, count) ** 4)
    values = source.choice(
        [source.normal(size=count), np.round(source.normal(size=count)), np.cumsum(source.exponential(size=count))]
    )
    at = np.concatenate([times, source.uniform(times[0] - 0.1, times[-1] + 0.1, 500)])
    ours, theirs = monotone_cubic(times, values), PchipInterpolator(times, values)
    assert np.array_equal(ours(at), theirs(at))
    assert np.array_equal(ours.derivative()(at), theirs.derivative()(at))


def test_no_value_lies_beyond_the_samples_beside_it():
    times, values = np.arange(12.0), np.random.default_rng(3).normal(size=12)
    at = np.linspace(0.0, 11.0, 2201)
    left = np.minimum(at.astype(int), 10)
    low, high = np.minimum(values[left], values[left + 1]), np.maximum(values[left], values[left + 1])
    found = monotone_cubic(times, values)(at)
    assert np.all(found >= low - 1e-12)  # rounding of values of size 1
    assert np.all(found <= high + 1e-12)


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, np.nan]])
def test_times_that_do_not_increase_are_refused(times):
    with pytest.raises(ValueError, match="increasing"):
        monotone_cubic(np.array(times), np.zeros(len(times)))
