"""By how much stated numbers are off: against an analysis of variance, and against planted excesses."""

import numpy as np
import pytest

from strikewave.studies.fit.excess import ALONE, excess_of


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
    found = excess_of(place - measured, [0, 1, 2, ALONE], 1)
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
    sizes = np.sqrt(np.mean(np.square([one[:2] for one in found]), axis=0))
    assert sizes == pytest.approx([within, between], rel=0.1)
    weights = 1.0 / np.array([found[0].weight(int(one)) for one in count])
    whole = found[0].within ** 2 * np.eye(groups.size) + found[0].between ** 2 * np.equal.outer(groups, groups)
    rows = weights[:, None] * design
    best = np.linalg.inv(design.T @ np.linalg.solve(whole, design))  # of generalized least squares
    assert np.linalg.inv(rows.T @ rows) == pytest.approx(best, rel=1e-9)
