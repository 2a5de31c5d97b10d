"""Robust statistics: published examples, tables, closed forms, and false alarms by simulation."""

import itertools
import math

import numpy as np
import pytest
import scipy.stats
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.records.campaign import statistic, trend
from strikewave.records.robust import SMALL_SAMPLE, kendall_bound, median_line, outliers, spread_of


@pytest.fixture(autouse=True)
def nothing_kept():
    """Let each test compute the bounds that are kept."""
    kendall_bound.cache_clear()


ROSNER = """-0.25 0.68 0.94 1.15 1.20 1.26 1.26 1.34 1.38 1.43 1.49 1.49 1.55 1.56 1.58 1.65 1.69 1.70 1.76 1.77 1.81 1.91
1.94 1.96 1.99 2.06 2.09 2.10 2.14 2.15 2.23 2.24 2.26 2.35 2.37 2.40 2.47 2.54 2.62 2.64 2.90 2.92 2.92 2.93 3.21 3.26
3.30 3.59 3.68 4.30 4.64 5.34 5.42 6.01"""
"""The data of Rosner 1983, of which three are outliers at 5 %."""


def test_outliers_of_rosner_are_his_three():
    values = np.array(ROSNER.split(), dtype=float)
    assert values[outliers(values, 0.05)].tolist() == [6.01, 5.42, 5.34]


def test_one_outlier_is_that_of_grubbs():
    """G(5) = 1.715 at a two-sided 5 % (Grubbs & Beck 1972): just below and just above, by how far the last one lies."""
    values = np.array([0.0, 1.0, 2.0, 3.0, 0.0])
    for x in np.linspace(5.0, 40.0, 200):
        values[4] = x
        deviation = abs(x - values.mean()) / values.std(ddof=1)
        if abs(deviation - 1.715) > 1e-3:
            assert outliers(values, 0.05) == ([4] if deviation > 1.715 else [])


@given(
    st.lists(st.sampled_from([-1e3, 0.0, 0.1, 1e3]), min_size=1, max_size=12),
    st.sampled_from([0.0, 0.1, 5114.3, -2.0]),
    st.integers(0, 12),
)
def test_values_of_which_many_or_all_are_equal_have_statistics(others, value, copies):
    """Copies, and figures that take few values: no error, no warning, and no outlier beside equal ones."""
    sample = np.array([*others, *[value] * copies])
    spread_of(sample)
    assert not set(sample[outliers(sample, 0.01)].tolist()) & {value} or np.ptp(sample[sample != value]) > 0.0
    assert (outliers([value] * 5 + [value + 7.0], 0.01), outliers([value] * 9, 0.01)) == ([], [])
    summary = statistic(sample)
    assert summary.n == sample.size
    median_line(np.arange(float(sample.size)), sample, 0.95) if sample.size > 1 else None
    trend(np.arange(sample.size) // 2, sample) if sample.size > 2 else None


@pytest.mark.verify
@pytest.mark.parametrize(("n", "most"), [(5, 1.1), (8, 1.9), (12, 1.6), (20, 1.4), (50, 1.2)])
def test_false_alarms_of_normal_samples_are_those_asked_for(rng, n, most):
    """Rosner gives the level from 25 values on; between 8 and 20 up to 1.9 times of it."""
    trials, level = 4000, 0.02
    found = sum(bool(outliers(rng.normal(size=n), level)) for _ in range(trials))
    assert found <= scipy.stats.binom.ppf(0.999, trials, most * level)
    assert found >= scipy.stats.binom.ppf(0.001, trials, 0.7 * level)


def test_two_outliers_do_not_hide_one_another(rng):
    values = 1.0 + 0.02 * rng.normal(size=12)
    values[[3, 7]] = 0.5
    assert sorted(outliers(values, 0.01)) == [3, 7]


def test_more_than_one_in_four_is_a_group_and_no_outlier(rng):
    values = np.concatenate([1.0 + 0.02 * rng.normal(size=8), 1.5 + 0.02 * rng.normal(size=8)])
    assert outliers(values, 0.01) == []


def test_fewer_than_five_and_equal_values_have_no_outlier():
    assert outliers([1.0, 1.0, 1.0, 9.0], 0.01) == []
    assert outliers([1.0] * 9, 0.01) == []


@pytest.mark.verify
@pytest.mark.parametrize("n", [2, 3, 4, 5, 6, 7, 8, 9, 10, 25])
def test_the_spread_of_normal_samples_has_no_bias(rng, n):
    """The mean of 20 000 is known to 0.9 / sqrt(20 000) = 0.6 %; five of these."""
    found = np.mean([spread_of(sample) for sample in rng.normal(size=(20_000, n))])
    assert found == pytest.approx(1.0, abs=0.03 if n < 10 else 0.015)
    assert n > 9 or SMALL_SAMPLE[n - 2] > 1.0


@settings(derandomize=True, max_examples=100, deadline=None)
@given(st.lists(st.floats(-1e3, 1e3), min_size=5, max_size=30), st.floats(1e-3, 1e3), st.floats(-1e3, 1e3))
def test_spread_and_line_follow_scale_and_shift(values, scale, shift):
    sample = np.array(values)
    assert spread_of(scale * sample + shift) == pytest.approx(
        scale * spread_of(sample), rel=1e-6, abs=1e-8 * scale + 1e-9
    )
    x = np.arange(sample.size, dtype=float)
    plain, moved = median_line(x, sample, 0.95), median_line(x, scale * sample + shift * x, 0.95)
    assert moved == pytest.approx([scale * slope + shift for slope in plain], rel=1e-6, abs=1e-6, nan_ok=True)


@pytest.mark.parametrize(("n", "least"), [(5, 10), (6, 13), (7, 15), (8, 18), (9, 20), (10, 23)])
def test_bounds_of_kendall_are_those_of_the_table(n, least):
    """Least S with P(S >= it) <= 0.025 (Hollander & Wolfe, table of Kendall's K), the next below it is the bound."""
    assert kendall_bound(n, 0.95) == least - 2


def test_counted_bounds_go_over_into_normal_ones():
    assert kendall_bound(60, 0.95) == pytest.approx(1.95996 * math.sqrt(60 * 59 * 125 / 18), abs=2.0)
    assert kendall_bound(4, 0.95) is None


@pytest.mark.parametrize("n", [5, 9, 20, 61])
def test_bounds_of_a_trend_hold_whatever_the_distribution(rng, n):
    trials = 1000
    held = 0
    for errors in rng.standard_t(2, size=(trials, n)):
        _, low, high = median_line(np.arange(float(n)), 0.3 * np.arange(n) + errors, 0.95)
        held += low <= 0.3 <= high
    assert held >= scipy.stats.binom.ppf(0.001, trials, 0.95)


def test_a_line_through_many_points_takes_means_of_neighbours(rng):
    x = np.arange(5000.0)
    slope, low, high = median_line(x, 2.0 * x + rng.normal(size=x.size), 0.95)
    assert low <= 2.0 <= high
    assert slope == pytest.approx(2.0, abs=1e-4)


def test_bounds_of_kendall_are_those_of_the_exact_distribution():
    """All orders of up to seven values counted one by one; from 61 on the normal variance n (n - 1)(2 n + 5) / 18."""
    for n in (4, 5, 7):
        pairs = list(itertools.combinations(range(n), 2))
        sums = [abs(sum(1 if p[i] < p[j] else -1 for i, j in pairs)) for p in itertools.permutations(range(n))]
        for confidence in (0.8, 0.95):
            fits = [
                c for c in range(len(pairs) % 2, len(pairs) + 1, 2) if np.mean(np.array(sums) > c) <= 1.0 - confidence
            ]
            found = kendall_bound(n, confidence)
            assert (found if found is not None else len(pairs)) == fits[0]
    # of 120 orders of five, five have at most one pair the wrong way round: twice that is ten
    assert (kendall_bound(5, 1.0 - 10.01 / 120.0), kendall_bound(5, 1.0 - 9.97 / 120.0)) == (6, 8)
    exact, normal = kendall_bound(60, 0.95), kendall_bound(61, 0.95)
    assert exact == pytest.approx(1.96 * math.sqrt(60 * 59 * 125 / 18), abs=2.0)
    for n in (61, 62, 200, 500):
        expected = 1.959964 * math.sqrt(n * (n - 1) * (2 * n + 5) / 18)
        found = kendall_bound(n, 0.95)
        assert 0.0 <= found - expected < 2.0
        assert (found - n * (n - 1) // 2) % 2 == 0
    assert normal > exact


def test_a_median_line_is_that_of_theil_and_sen(rng):
    """Slope and, to a place among the slopes, bounds of scipy, whose variance is the normal one."""
    from scipy.stats import theilslopes

    x = np.sort(rng.uniform(size=70))
    y = 3.0 * x + rng.normal(size=70)
    slope, low, high = median_line(x, y, 0.9)
    other = theilslopes(y, x, 0.9)
    slopes = np.sort([(y[j] - y[i]) / (x[j] - x[i]) for i in range(70) for j in range(i + 1, 70)])
    assert slope == pytest.approx(other.slope, rel=1e-12)
    for mine, theirs in ((low, other.low_slope), (high, other.high_slope)):
        assert abs(np.searchsorted(slopes, mine) - np.searchsorted(slopes, theirs)) <= 1
    assert np.searchsorted(slopes, low) == slopes.size - 1 - np.searchsorted(slopes, high)


def test_a_line_of_many_points_is_taken_over_means():
    x = np.arange(2003.0)
    assert median_line(x, 2.0 + 0.25 * x, 0.95) == pytest.approx((0.25, 0.25, 0.25))


def test_a_spread_is_that_of_normal_values_whatever_their_number():
    """Of three, four and twenty samples the mean over many is the standard deviation, to 1 / sqrt(2 x 4000 (n - 1))."""
    rng = np.random.default_rng(8)
    for n in (2, 3, 4, 5, 8, 9, 12, 20):
        spreads = [spread_of(row) for row in rng.normal(size=(1500, n))]
        assert np.mean(spreads) == pytest.approx(1.0, abs=4.0 * np.std(spreads) / math.sqrt(1500) + 0.005)


def test_the_factors_of_small_samples_are_those_of_croux_and_rousseeuw():
    """Of 0, 1, ... n - 1 the median deviation is a quarter of n, or of n - 1 or n + 1 where n is odd; n / (n - 0.8) from ten on."""
    published = {
        2: 1.196,
        3: 1.495,
        4: 1.363,
        5: 1.206,
        6: 1.200,
        7: 1.140,
        8: 1.129,
        9: 1.107,
        10: 10 / 9.2,
        12: 12 / 11.2,
    }
    deviations = {2: 0.5, 3: 1.0, 4: 1.0, 5: 1.0, 6: 1.5, 7: 2.0, 8: 2.0, 9: 2.0, 10: 2.5, 12: 3.0}
    for n, factor in published.items():
        assert spread_of(np.arange(float(n))) == pytest.approx(factor * 1.4826 * deviations[n])
