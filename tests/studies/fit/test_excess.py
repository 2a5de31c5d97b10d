"""By how much stated numbers are off: against an analysis of variance, and against planted excesses."""

import numpy as np
import pytest
from scipy.stats import chi2

from strikewave.studies.fit.covariance import KNOWN_ELSEWHERE, Excess, excess_of


def test_of_as_many_repeats_each_it_is_the_analysis_of_variance():
    """A mean of five settings with four repeats each, one-way: s^2 = MSW, tau^2 = (MSB - MSW)/4 (Fisher)."""
    rng = np.random.default_rng(3)
    values = 5.0 * rng.standard_normal((5, 1)) + 3.0 * rng.standard_normal((5, 4))
    within = np.sum((values - values.mean(axis=1, keepdims=True)) ** 2) / 15.0
    between = 4.0 * np.var(values.mean(axis=1), ddof=1)
    found = excess_of((np.mean(values) - values).ravel(), np.repeat(np.arange(5), 4), 1)
    assert found.within**2 == pytest.approx(within, rel=1e-9)
    assert found.between**2 == pytest.approx((between - within) / 4.0, rel=1e-6)
    assert found.freedom == 4.0


def test_without_repeats_it_is_the_ratio_of_birge():
    rng = np.random.default_rng(5)
    design, measured = rng.standard_normal((9, 2)), 10.0 * rng.standard_normal(9)
    residuals = design @ np.linalg.lstsq(design, measured)[0] - measured
    found = excess_of(residuals, np.arange(9), 2)
    assert found.of_another**2 == pytest.approx(residuals @ residuals / 7.0, rel=1e-6)


def test_a_value_that_is_known_from_elsewhere_is_held_to_its_uncertainty():
    """Three numbers that agree 100 uncertainties beside what is known of their value: these are off, not that."""
    measured = np.array([100.0, 101.0, 99.0, 0.0])
    place = measured.sum() / 4.0
    found = excess_of(place - measured, [0, 1, 2, KNOWN_ELSEWHERE], 1)
    assert found.of_another > 50.0
    assert found.freedom == 3.0


@pytest.mark.parametrize(("within", "between"), [(1.0, 0.0), (1.0, 2.0), (3.0, 0.0), (3.0, 6.0)])
def test_planted_excesses_are_found_and_weights_by_them_are_those_of_the_best_estimate(within, between):
    """Settings with 1 to 30 repeats, three values: 40 draws; where both are told, values err as weighted least squares.

    Means over 40 draws of 18 - 3 degrees of freedom are good to 1/sqrt(2 15 40), 3 %: three of those.
    """
    rng, found = np.random.default_rng(7), []
    groups = np.repeat(np.arange(18), rng.integers(1, 31, 18))
    design = rng.standard_normal((18, 3))[groups]
    count = np.bincount(groups)[groups]
    for _ in range(40):
        measured, excess = between * rng.standard_normal(18)[groups] + within * rng.standard_normal(groups.size), None
        for _ in range(4):  # as a fit does
            weights = np.ones(groups.size) if excess is None else [1.0 / excess.weight(int(one)) for one in count]
            rows = np.array(weights)[:, None] * design
            place = np.linalg.lstsq(rows, weights * measured)[0]
            excess = excess_of(design @ place - measured, groups, 3)
        found.append(excess)
    sizes = np.sqrt(np.mean(np.square([(one.within, one.between) for one in found]), axis=0))
    assert sizes == pytest.approx([within, between], rel=0.1)
    weights = 1.0 / np.array([found[0].weight(int(one)) for one in count])
    whole = found[0].within ** 2 * np.eye(groups.size) + found[0].between ** 2 * np.equal.outer(groups, groups)
    rows = weights[:, None] * design
    best = np.linalg.inv(design.T @ np.linalg.solve(whole, design))  # of generalized least squares
    assert np.linalg.inv(rows.T @ rows) == pytest.approx(best, rel=1e-9)


def test_repeats_scatter_beyond_chance_from_its_thousandth_on():
    """Four numbers in two settings, scattered by (1, -1, 1, -1) d: 4 d^2 beside chi-squared of two degrees."""
    limit = np.sqrt(chi2.isf(1e-3, 2) / 4.0)
    for size, scattered in ((limit * 0.999, False), (limit * 1.001, True)):
        found = excess_of(size * np.array([1.0, -1.0, 1.0, -1.0]), [4, 4, 7, 7], 1)
        assert found.within == pytest.approx(np.sqrt(2.0) * size if scattered else 1.0, rel=1e-12)
        assert (found.between, found.freedom) == (0.0, 2.0 if scattered else np.inf)


def test_settings_are_off_beyond_chance_from_its_thousandth_on():
    """Three settings of which the first has two repeats, one value: means weigh 2, 1, 1, chi-squared has two degrees."""
    residuals, groups = np.array([1.0, 1.0, -1.0, -1.0]), [0, 0, 1, 2]
    limit = np.sqrt(chi2.isf(1e-3, 2) / 4.0)
    assert excess_of(0.999 * limit * residuals, groups, 1) == Excess()
    found = excess_of(1.001 * limit * residuals, groups, 1)
    assert (found.within, found.freedom) == (1.0, 2.0)
    square = (1.001 * limit) ** 2
    assert square / (0.5 + found.between**2) + 2.0 * square / (1.0 + found.between**2) == pytest.approx(2.0, rel=1e-9)


def test_with_as_many_values_as_settings_none_is_off():
    """No degree of freedom is left, but that of a value known from elsewhere."""
    off = np.array([50.0, -50.0])
    assert excess_of(off, [0, 1], 2) == Excess()
    assert excess_of(np.array([50.0]), [KNOWN_ELSEWHERE], 0) == Excess()
    assert excess_of(off, [0, 1], 1).freedom == 1.0
    assert excess_of(off, [0, 1], 1).of_another == pytest.approx(np.sqrt(5000.0), rel=1e-9)


def test_what_is_known_from_elsewhere_alone_off_ends_the_search_for_the_excess():
    """It is off by 10 and leaves 100 of two degrees whatever the excess of the numbers: that is (100 + 2)/2 at most."""
    found = excess_of(np.array([10.0, 1.0, -1.0]), [KNOWN_ELSEWHERE, 0, 1], 1)
    assert found.between**2 == pytest.approx(102.0 / 2.0, rel=1e-12)


def test_the_weight_of_repeats_gives_their_mean_both_parts():
    """Of n repeats the mean has within^2/n + between^2, which is weight^2/n: 3 and 4 of one, of 5 repeats."""
    found = Excess(3.0, 4.0)
    assert found.of_another == 5.0
    assert found.weight(1) == 5.0
    assert found.weight(5) ** 2 / 5.0 == pytest.approx(9.0 / 5.0 + 16.0, rel=1e-12)


def test_an_excess_is_sought_up_to_where_it_explains_all_whatever_the_repeats():
    """Two settings of which one has 50 repeats: the root of the sum of squares of the means, by bisection."""
    residuals, groups = np.concatenate([np.full(50, 3.0), [-9.0, 6.0]]), np.append(np.zeros(50, int), [1, 2])
    found = excess_of(residuals, groups, 1)
    low, high = 0.0, 1e4
    for _ in range(200):
        middle = 0.5 * (low + high)
        left = 9.0 / (1.0 / 50.0 + middle) + 81.0 / (1.0 + middle) + 36.0 / (1.0 + middle)
        low, high = (middle, high) if left > 2.0 else (low, middle)
    assert found.within == 1.0
    assert found.between**2 == pytest.approx(low, rel=1e-9)


def test_one_repeat_tells_a_scatter_and_many_a_small_excess():
    """5 and -5 of one setting: 50 of one degree. Of 10 000 repeats the mean is off by 0.05, which is sure to 0.01."""
    assert excess_of(np.array([5.0, -5.0, 0.0]), [0, 0, 1], 1).within == pytest.approx(np.sqrt(50.0))
    found = excess_of(np.append(np.full(10000, 0.05), 0.0), np.append(np.zeros(10000, int), 1), 1)
    assert found.between**2 == pytest.approx(0.05**2 - 0.01**2, rel=1e-9)
