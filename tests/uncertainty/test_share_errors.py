"""Shares of a variance are never below 0, and their standard errors are those of repeated studies."""

import numpy as np
import pytest

from strikewave.base.quantities import Range, Value
from strikewave.studies.sweep.effects import jackknife_error, main_effect
from strikewave.uncertainty.draws import UncertainInput
from strikewave.uncertainty.expansion import fit_expansion, polynomials_at
from strikewave.uncertainty.shares import sobol_indices, sobol_shares

RUNS = 128


def sobol_study(seed):
    """Return results at two random samples and their mixtures of y = 3 x1 + 0.3 x2 + 0 x3: shares 0.99, 0.01 and 0."""
    a, b = np.random.default_rng(seed).standard_normal((2, RUNS, 3))
    slopes = np.array([3.0, 0.3, 0.0])
    mixed = np.repeat(a[None], 3, axis=0)
    for k in range(3):
        mixed[k, :, k] = b[:, k]
    return a @ slopes, b @ slopes, mixed @ slopes


def test_no_share_and_no_bound_of_it_lies_below_0_where_its_estimator_does():
    """The estimator of x2, a hundredth of the variance, falls below 0 in some of these studies of 128 runs."""
    below = 0
    for seed in range(60):
        a, b, mixed = sobol_study(seed)
        raw = sobol_indices(a, b, mixed).first
        shares = sobol_shares("y", ["x1", "x2", "x3"], a, b, mixed, seed)
        below += bool((raw < 0.0).any())
        assert all(min(row.share, row.low, row.total, row.total_low) >= 0.0 for row in shares.rows)
        expected = {f"x{k + 1}": max(share, 0.0) for k, share in enumerate(raw)}
        assert {row.path: row.share for row in shares.rows} == pytest.approx(expected)
        assert shares.sum == pytest.approx(
            raw.sum()
        )  # of the estimators as they are: its mean is the sum of the shares
    assert below > 5


def test_the_standard_error_of_a_sobol_index_is_that_of_repeated_studies():
    """Over 200 studies; a bootstrap of 128 runs is good to some 15 % on the mean of eight."""
    repeated = np.array([sobol_indices(*sobol_study(seed)).first for seed in range(200)])
    rows = [sobol_shares("y", ["1", "2", "3"], *sobol_study(1000 + seed), seed).rows for seed in range(8)]
    for k in range(2):
        errors = [row.standard_error for of_study in rows for row in of_study if row.path == str(k + 1)]
        assert np.mean(errors) == pytest.approx(repeated[:, k].std(ddof=1), rel=0.3)


def test_the_jackknife_is_that_of_shares_without_each_run():
    """Each run is left out in turn and the share computed anew, by sums of squares in full."""
    source = np.random.default_rng(3)
    sizes = np.array([4, 1, 7, 5])
    group = np.repeat(np.arange(sizes.size), sizes)
    y = source.standard_normal(group.size) + 0.5 * group + 1e3

    def share(y, group):
        total = np.sum((y - y.mean()) ** 2)
        within = sum(np.sum((y[group == k] - y[group == k].mean()) ** 2) for k in np.unique(group))
        count = np.unique(group).size
        return (total - within - (count - 1) * within / (y.size - count)) / total

    left = np.array([share(np.delete(y, i), np.delete(group, i)) for i in range(y.size)])
    expected = np.sqrt((y.size - 1) / y.size * np.sum((left - left.mean()) ** 2))
    assert jackknife_error(y, sizes) == pytest.approx(expected, rel=1e-9)


def test_a_setting_that_does_nothing_has_a_share_of_0_with_its_error():
    """Epsilon squared of noise is below 0 in more than half of all studies: 0 stands for it."""
    source = np.random.default_rng(4)
    effects = [main_effect(source.random(64), source.standard_normal(64), grid=False) for _ in range(40)]
    assert min(effect.share for effect in effects) == 0.0
    assert sum(effect.share == 0.0 for effect in effects) > 10
    assert all(effect.standard_error > 0.0 for effect in effects)
    assert main_effect([1, 1, 2, 2], [0.0, 1.0, 3.0, 4.0], grid=True).standard_error == 0.0


def test_the_standard_error_of_a_share_of_a_fit_is_that_of_repeated_noise():
    """y = a + 2 b + noise of a half of the variance, 100 times with other noise at the same points."""
    value = Value(si=0.0, typed=0.0)
    inputs = [UncertainInput(name, value, Range(""), -1.0, 1.0) for name in "ab"]
    source = np.random.default_rng(5)
    points = source.random((96, 2))
    polynomials = polynomials_at(inputs, points)
    smooth = inputs[0].at(points[:, 0]) + 2.0 * inputs[1].at(points[:, 1])
    fits = [fit_expansion(polynomials, smooth + smooth.std() * source.standard_normal(96)) for _ in range(100)]
    shares = np.array([fit.shares("ab")["b"] for fit in fits])
    errors = [fit.share_errors("ab", 96)["b"] for fit in fits]
    assert np.mean(errors) == pytest.approx(shares.std(ddof=1), rel=0.3)
    exact = fit_expansion(polynomials, smooth)
    assert exact.share_errors("ab", 96)["b"] < 1e-6  # nothing is left: nothing is in doubt
