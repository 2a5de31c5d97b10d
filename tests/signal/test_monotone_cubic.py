"""The monotone cubic against scipy's, and what it promises."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from strikewave.signal.interpolation import monotone_cubic


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


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, np.nan], [0.0, 2.0, 1.0], [0.0, 1.0, 1.0]])
def test_times_that_do_not_increase_are_refused(times):
    with pytest.raises(ValueError, match="increasing"):
        monotone_cubic(np.array(times), np.zeros(len(times)))


@pytest.mark.parametrize(("times", "values"), [([1.0, 3.0], [5.0, 2.0]), ([1.0, 3.0, 3.5], [5.0, 2.0, 9.0])])
def test_two_samples_make_a_line_and_three_what_scipy_makes_of_them(times, values):
    at = np.array([0.5, 1.0, 2.5, 3.0, 3.7])
    ours, theirs = monotone_cubic(np.array(times), np.array(values)), PchipInterpolator(times, values)
    assert np.array_equal(ours(at), theirs(at))
    if len(times) == 2:
        assert ours(at).tolist() == (5.0 - 1.5 * (at - 1.0)).tolist()


@pytest.mark.parametrize("last", [-2.9, -2.99, -3.01, -3.04, -4.5])
def test_slopes_at_an_end_before_a_turn_are_three_secants_at_most(last):
    """Steps of 1: the parabola's slope is (3 s - t)/2, above 3 s from t = -3 s on."""
    times, values = np.arange(4.0), np.array([0.0, 1.0, 1.0 + last, 7.0])
    for sign in (1.0, -1.0):
        ours, theirs = monotone_cubic(times, sign * values), PchipInterpolator(times, sign * values)
        assert ours.derivative()(times[:1]) == theirs.derivative()(times[:1])
        assert ours.derivative()(times[:1]) == sign * min(1.5 - 0.5 * last, 3.0)
