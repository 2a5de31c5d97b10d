"""Scatter, limits without a distribution, runs on threads, and shares, against binomial tails of scipy and by hand."""

import math

import numpy as np
import pytest
from scipy.stats import binom

from strikewave.uncertainty.runs import on_threads, or_none, why_failed
from strikewave.uncertainty.shares import (
    Share,
    Shares,
    mixtures,
    scatter_shares,
    sobol_indices,
    sobol_points,
    variance_shares,
)
from strikewave.uncertainty.statistics import median_bounds, spread, upper_limit, variation


def test_variation_by_hand():
    """2, 4, 9: mean 5, squares of deviations 26, over two."""
    assert variation([2.0, 4.0, math.nan, 9.0]) == pytest.approx(math.sqrt(13.0) / 5.0, rel=1e-15)
    assert variation([-2.0, -4.0, -9.0]) == variation([2.0, 4.0, 9.0])
    assert variation([1.0, 2.0]) == pytest.approx(math.sqrt(0.5) / 1.5, rel=1e-15)
    assert math.isnan(variation([1.0]))
    assert math.isnan(variation([]))


@pytest.mark.parametrize("n", [58, 59, 92, 93, 94, 200, 473])
def test_the_upper_limit_is_the_first_that_is_sure_enough(n):
    limit = upper_limit(np.random.default_rng(n).permutation(n) + 1.0)
    sure = [r for r in range(1, n + 1) if binom.cdf(r - 1, n, 0.95) >= 0.95]
    assert limit == sure[0] if sure else math.isnan(limit)
    assert bool(sure) == (n >= 59)


@pytest.mark.parametrize("n", [1, 2, 5, 6, 8, 9, 10, 11, 37, 100])
def test_the_bounds_of_a_median_are_the_narrowest_that_are_sure_enough(n):
    low, high = median_bounds(np.arange(n, 0.0, -1.0))
    sure = [r for r in range(1, n // 2 + 1) if 1.0 - 2.0 * binom.cdf(r - 1, n, 0.5) >= 0.95]
    assert (low, high) == (sure[-1], n + 1 - sure[-1]) if sure else math.isnan(low) and math.isnan(high)
    assert bool(sure) == (n >= 6)


def test_other_confidences_and_no_values():
    assert upper_limit([3.0, 1.0, 2.0], 0.5, 0.875) == 3.0  # 1 - 1/8, exactly
    assert math.isnan(upper_limit([3.0, 1.0, 2.0], 0.5, 0.876))
    assert math.isnan(upper_limit([]))
    assert np.isnan(median_bounds([])).all()
    assert median_bounds([5.0, 7.0], 0.5) == (5.0, 7.0)


def test_a_broken_run_keeps_no_limit_and_a_run_without_a_value_counts_not():
    values = [*range(1, 60), math.nan]
    whole = spread(values)
    assert (whole.median, whole.limit, whole.n) == (30.0, 59.0, 59)
    assert (whole.low, whole.high) == median_bounds(range(1, 60))
    broken = spread(values, [False] * 59 + [True])
    assert (broken.median, broken.limit, broken.n) == (30.0, math.inf, 59)
    assert math.isnan(spread([math.nan]).median)


@pytest.mark.parametrize("threads", [1, 2])
def test_runs_keep_their_order_and_tell_how_far_they_are(threads):
    told = []
    found = on_threads(lambda x: 12 / x, [4, 0, 3], threads, told.append)
    assert found == [3.0, None, 4.0]
    assert told == pytest.approx([1 / 3, 2 / 3, 1.0], rel=1e-15)
    assert on_threads(float, [], threads) == []


def test_why_a_run_failed_is_the_first_line_of_its_error():
    def fails(x):
        if x:
            raise ValueError("first\nsecond" if x == 1 else "")
        return x

    assert why_failed(fails, [0, 1, 2], [0, None, None]) == "first"
    assert why_failed(fails, [2, 1], [None, None]) == "ValueError"
    assert why_failed(fails, [0, 0], [0, 0]) == why_failed(fails, [0], [None]) == ""
    assert or_none(fails, 1) is None
    assert or_none(fails, 0) == 0
    with pytest.raises(TypeError):
        or_none(len, 3)


def test_sobol_indices_by_hand():
    """y_A = 0, 2; y_B = 4, 6: mean 3, variance 5; with the group 4, 4: [1 x 4 + 3 x 2]/2 and [16 + 4]/4 over it."""
    found = sobol_indices(np.array([0.0, 2.0]), np.array([4.0, 6.0]), np.array([[4.0, 4.0]]))
    assert (found.first.tolist(), found.total.tolist()) == ([1.0], [1.0])
    moved = sobol_indices(np.array([7.0, 9.0]), np.array([11.0, 13.0]), np.array([[11.0, 11.0]]))
    assert (moved.first.tolist(), moved.total.tolist()) == ([1.0], [1.0])
    half = sobol_indices(np.array([0.0, 2.0]), np.array([4.0, 6.0]), np.array([[0.0, 4.0]]))
    assert (half.first.tolist(), half.total.tolist()) == ([0.6], [0.2])


def test_mixtures_take_their_columns_from_the_second_half():
    a, b, mixed = mixtures(np.arange(12.0).reshape(2, 6), (2, 1))
    assert (a.tolist(), b.tolist()) == ([[0, 1, 2], [6, 7, 8]], [[3, 4, 5], [9, 10, 11]])
    assert mixed.tolist() == [[[3, 4, 2], [9, 10, 8]], [[0, 1, 5], [6, 7, 11]]]


def test_sobol_points_are_once_in_each_stratum():
    points = sobol_points(3, 16, 7)
    assert np.array_equal(np.sort((16 * points).astype(int), axis=0), np.tile(np.arange(16)[:, None], (1, 6)))
    assert np.array_equal(points, sobol_points(3, 16, 7))
    assert not np.array_equal(points, sobol_points(3, 16, 8))


def test_shares_of_tolerances_alone_by_hand():
    """Whole +-5, alone +-3 and +-4 about 10: shares 9/25 and 16/25, whatever the mean; a run without result is left."""
    sign = np.tile([1.0, -1.0], 40)
    whole, alone = 10.0 + 5.0 * sign, np.array([10.0 + 3.0 * sign, 10.0 + 4.0 * sign])
    whole[-1], alone[0, -2] = math.nan, math.nan
    found = variance_shares("peak", ["a", "b"], whole, alone, 1)
    assert [(row.path, row.distinct) for row in found.rows] == [("b", True), ("a", True)]
    assert [row.share for row in found.rows] == pytest.approx([0.64, 0.36], rel=1e-12)
    assert (found.sum, found.sum_low, found.sum_high) == pytest.approx((1.0, 1.0, 1.0), rel=1e-9)
    assert (found.of, found.runs, found.rows[0].floor) == (
        "peak",
        78,
        pytest.approx((1e-6 * 10.0) ** 2 / 25.0, rel=0.02),
    )
    assert found.rows[0].standard_error == pytest.approx(0.0, abs=1e-12)
    mean = scatter_shares("scatter", ["a", "b"], whole, alone, 1)
    by_hand = [(100.0 + 16.0) / 125.0, (100.0 + 9.0) / 125.0]
    assert [row.share for row in mean.rows] == pytest.approx(by_hand, rel=1e-12)
    assert mean.rows[0].floor == pytest.approx(1e-12 / 125.0, rel=1e-12)


def test_bounds_of_a_share_are_those_of_the_normal_theory():
    """Of unit scatter y and 0.6 y + 0.8 z: the logarithm of a ratio of variances has the variance 4 (1 - 0.36)/n."""
    y, z = np.random.default_rng(3).standard_normal((2, 400))
    (row,) = variance_shares("y", ["a"], y, (0.6 * y + 0.8 * z)[None], 2).rows
    error = row.share * math.sqrt(4.0 * 0.64 / 400.0)
    assert row.standard_error == pytest.approx(error, rel=0.15)  # of 1000 resamples and of one sample's kurtosis
    assert row.high - row.low == pytest.approx(2.0 * 1.96 * row.standard_error, rel=0.1)
    assert row.low < row.share < row.high


def test_no_run_tells_no_share_and_bounds_hold_their_ends():
    none = np.full(4, math.nan)
    found = variance_shares("y", ["a"], none, none[None], 1)
    assert (found.runs, math.isnan(found.sum), math.isnan(found.rows[0].share)) == (0, True, True)
    assert [Shares("y", (), 1.0, *ends, 9).additive for ends in ((1.0, 1.2), (0.8, 1.0), (1.01, 2.0), (0.1, 0.99))] == [
        True,
        True,
        False,
        False,
    ]
    assert not Share("a", 0.1, 0.05, 0.2, 0.05).distinct
    assert Share("a", 0.1, 0.06, 0.2, 0.05).distinct
