"""Scatter, limits without a distribution, runs on threads, and shares, against binomial tails of scipy and by hand."""

import math
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.stats import binom

from strikewave.uncertainty import runs
from strikewave.uncertainty.runs import on_threads, or_none, why_failed
from strikewave.uncertainty.shares import (
    Share,
    Shares,
    _bounds,
    _errors,
    _resamples,
    mixtures,
    scatter_shares,
    sobol_indices,
    sobol_points,
    sobol_shares,
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
    assert upper_limit([7.0], 0.04, 0.95) == 7.0  # of one run: 1 - 0.04
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


@pytest.mark.parametrize(
    ("threads", "processors", "items", "taken"),
    [
        (None, 5, 9, 5),
        (None, None, 9, 0),  # not known
        (3, 5, 9, 3),
        (12, 5, 20, 8),
        (8, 5, 2, 2),
        (1, 5, 9, 0),
        (7, 5, 1, 0),
        (None, 5, 1, 0),
    ],
)
def test_runs_take_as_many_threads_as_processors_runs_or_eight(monkeypatch, threads, processors, items, taken):
    """A lone thread is this one."""
    made = []
    monkeypatch.setattr(os, "cpu_count", lambda: processors)
    monkeypatch.setattr(runs, "ThreadPoolExecutor", lambda count: made.append(count) or ThreadPoolExecutor(1))
    assert on_threads(float, list(range(items)), threads) == list(range(items))
    assert made == ([taken] if taken else [])


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
    both = sobol_indices(
        np.array([[0.0, 2.0], [7.0, 9.0]]),
        np.array([[4.0, 6.0], [11.0, 13.0]]),
        np.array([[[4.0, 4.0], [11.0, 11.0]], [[0.0, 4.0], [7.0, 11.0]]]),
    )
    assert (both.first.tolist(), both.total.tolist()) == ([[1.0, 1.0], [0.6, 0.6]], [[1.0, 1.0], [0.2, 0.2]])


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
        pytest.approx((1e-6 * 10.0) ** 2 / 25.0, rel=0.02, abs=0.0),
    )
    assert found.rows[0].standard_error == pytest.approx(0.0, abs=1e-12)
    mean = scatter_shares("scatter", ["a", "b"], whole, alone, 1)
    by_hand = [(100.0 + 16.0) / 125.0, (100.0 + 9.0) / 125.0]
    assert [row.share for row in mean.rows] == pytest.approx(by_hand, rel=1e-12)
    assert mean.rows[0].floor == pytest.approx(1e-12 / 125.0, rel=1e-12, abs=0.0)


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
    assert [Shares("y", 9, 1.0, *ends, ()).additive for ends in ((1.0, 1.2), (0.8, 1.0), (1.01, 2.0), (0.1, 0.99))] == [
        True,
        True,
        False,
        False,
    ]
    assert not Share("a", 0.1, 0.05, 0.2, 0.05).distinct
    assert Share("a", 0.1, 0.06, 0.2, 0.05).distinct


def test_bounds_of_resamples_leave_a_fortieth_on_either_side():
    """Of 0 to 1000 and of 2000 to 4000: 25 and 975 thousandths of the way; their deviations by the closed form."""
    rows = np.array([np.random.default_rng(k).permutation(np.arange(1001.0)) for k in (1, 2)])
    rows[1] = 2000.0 + 2.0 * rows[1]
    assert _bounds(rows) == pytest.approx(np.array([[25.0, 2050.0], [975.0, 3950.0]]), rel=1e-12)
    even = math.sqrt(1001.0 * 1002.0 / 12.0)  # of the whole numbers, over one less than there are
    assert _errors(rows) == pytest.approx([even, 2.0 * even], rel=1e-12)
    for none in (np.zeros((2, 0)), np.array([[1.0, 2.0], [math.nan, 3.0]])):
        assert np.isnan(_errors(none)).all()
        assert np.isnan(_bounds(none)).all()
        assert (_errors(none).shape, _bounds(none).shape) == ((2,), (2, 2))


@pytest.mark.parametrize("count", [1, 2, 40])
def test_a_bootstrap_draws_each_run_as_often_as_any_a_thousand_times(count):
    """Counts of 1000 x n draws scatter by sqrt(1000): five of them."""
    place = _resamples(count, 3)
    assert place.shape == (1000, count)
    assert np.bincount(place.ravel(), minlength=count) == pytest.approx(np.full(count, 1000.0), abs=160.0)
    assert np.array_equal(place, _resamples(count, 3))
    if count > 2:
        assert not np.array_equal(place, _resamples(count, 4))


def interacting(runs, seed):
    """Return runs of y = 2 x1 + x2 + 2 x2 x3 of normal inputs: of 9, first-order 4, 1, 0 and totals 4, 5, 4."""
    a, b = np.random.default_rng(seed).standard_normal((2, runs, 3))

    def y(x):
        return 2.0 * x[..., 0] + x[..., 1] + 2.0 * x[..., 1] * x[..., 2]

    return y(a), y(b), np.array([y(np.where(np.arange(3) == k, b, a)) for k in range(3)])


def test_first_and_total_indices_have_bounds_of_their_own():
    """1000 runs tell each to some 0.06, and bounds reach about two standard errors to either side of it."""
    found = sobol_shares("y", ["u", "v", "w"], *interacting(1000, 5), 1)
    rows = {row.path: row for row in found.rows}
    assert [row.path for row in found.rows] == ["u", "v", "w"]
    assert (found.of, found.runs) == ("y", 1000)
    for path, first, total in (("u", 4 / 9, 4 / 9), ("v", 1 / 9, 5 / 9), ("w", 0.0, 4 / 9)):
        row = rows[path]
        assert row.floor == 0.0
        assert abs(row.share - first) < 3.0 * row.standard_error < 0.3
        assert abs(row.total - total) < 3.0 * row.total_standard_error < 0.3
        assert row.total_low < row.total < row.total_high
        # the bootstrap is nearly normal: its outer fortieths lie 1.96 deviations off, those of 1000 draws to a tenth
        assert row.total_high - row.total_low == pytest.approx(3.92 * row.total_standard_error, rel=0.1)
        if first:
            assert row.low < row.share < row.high
            assert row.high - row.low == pytest.approx(3.92 * row.standard_error, rel=0.1)
    assert (found.sum_low < found.sum < found.sum_high, found.additive) == (True, False)
    assert found.sum == pytest.approx(5 / 9, abs=0.15)


def test_the_standard_error_of_a_total_index_is_that_of_repeated_studies():
    """Over 100 studies of 300 runs; a bootstrap of so many is good to some 15 % on the mean of six."""
    repeated = np.array([sobol_indices(*interacting(300, seed)).total for seed in range(100)])
    found = [sobol_shares("y", ["0", "1", "2"], *interacting(300, 500 + seed), seed).rows for seed in range(6)]
    for k in range(3):
        errors = [row.total_standard_error for rows in found for row in rows if row.path == str(k)]
        assert np.mean(errors) == pytest.approx(repeated[:, k].std(ddof=1), rel=0.3)


def test_runs_without_a_result_leave_the_shares_of_the_others():
    a, b, mixed = interacting(200, 6)
    whole = sobol_shares("y", ["u", "v", "w"], a[3:], b[3:], mixed[:, 3:], 2)
    a[0] = b[1] = mixed[1, 2] = math.nan
    assert sobol_shares("y", ["u", "v", "w"], a, b, mixed, 2) == whole
    assert whole.runs == 197
    none = sobol_shares("y", ["u", "v"], np.full(3, math.nan), b[:3], mixed[:2, :3], 2)
    assert (none.runs, [row.path for row in none.rows]) == (0, ["u", "v"])
    assert np.isnan([none.sum, none.sum_low, none.sum_high, none.rows[1].share]).all()


def test_shares_that_are_not_known_stand_last():
    """What does not vary at all has no share, where nothing else does either."""
    still = np.zeros((2, 30))
    found = variance_shares("y", ["a", "b"], still[0], still, 1)
    assert [row.path for row in found.rows] == ["a", "b"]
    assert np.isnan([row.share for row in found.rows]).all()
    assert not found.rows[0].distinct


def test_shares_of_each_tolerance_are_those_that_it_has_without_the_others():
    y, z = np.random.default_rng(8).standard_normal((2, 60))
    alone = np.array([0.6 * y + 0.3 * z, z, 0.1 * y])
    found = scatter_shares("y", ["a", "b", "c"], y + z, alone, 2)
    for row in found.rows:
        [single] = scatter_shares("y", [row.path], y + z, alone["abc".index(row.path)][None], 2).rows
        told = [(one.share, one.low, one.high, one.standard_error) for one in (single, row)]
        assert told[0] == pytest.approx(told[1], rel=1e-9)
