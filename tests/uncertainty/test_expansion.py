"""The polynomial fit: orthonormal polynomials of other codes, coefficients by hand, runs left out in truth."""

import numpy as np
import pytest
from scipy.linalg import hadamard
from scipy.special import eval_legendre
from scipy.stats import truncnorm

from strikewave.base.quantities import Range, Value
from strikewave.uncertainty.draws import UncertainInput
from strikewave.uncertainty.expansion import Expansion, _select, fit_expansion, polynomials_at

EVEN = UncertainInput("even", Value(si=2.0, typed=2.0), Range(""), 1.0, 4.0)
GROWING = UncertainInput("growing", Value(si=2.0, typed=2.0), Range(""), 1.0, 4.0, "log-uniform")
BELL = UncertainInput("bell", Value(si=200.0, typed=200.0), Range(""), 198.75, 202.5, "normal", 1.0)
"""Cut off at 1.25 deviations below and 2.5 above: its polynomials are none of the tables."""


def test_polynomials_of_even_inputs_are_legendres():
    """Also where the input is even in its logarithm: in the quantile, it is. Of degree 4 at most."""
    u = np.array([0.0, 0.13, 0.5, 0.71, 1.0])
    found = polynomials_at([EVEN, GROWING], np.column_stack([u, u[::-1]]))
    assert found.shape == (2, 5, 4)
    for n in range(1, 5):
        wanted = np.sqrt(2 * n + 1) * eval_legendre(n, 2 * u - 1)
        assert found[0, :, n - 1] == pytest.approx(wanted, abs=1e-12)
        assert found[1, :, n - 1] == pytest.approx(wanted[::-1], abs=1e-12)


def test_polynomials_of_a_normal_input_are_orthonormal_under_its_density():
    """By 200 nodes over its range; 64 nodes over its quantiles, where it is steep at both ends, are good to 1e-6."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    x = 0.625 + 1.875 * nodes
    density = truncnorm(-1.25, 2.5)
    found = polynomials_at([BELL], density.cdf(x)[:, None])[0]
    every = np.column_stack([np.ones(x.size), found])
    assert (every.T * (1.875 * weights * density.pdf(x))) @ every == pytest.approx(np.eye(5), abs=2e-6)
    for n in range(1, 5):  # of its degree, and rising at the end
        assert np.polynomial.Polynomial.fit(x, found[:, n - 1], n)(x) == pytest.approx(found[:, n - 1], abs=1e-6)
        assert np.all(np.diff(found[-3:, n - 1]) > 0.0)


def test_polynomials_that_are_not_needed_are_left_out():
    """Of an input drawn for two strikers both are made where one is needed."""
    inputs = [UncertainInput("two", EVEN.value, Range(""), 1.0, 4.0, strikers=(1, 3)), EVEN, GROWING]
    points = np.random.default_rng(1).random((6, 4))
    whole = polynomials_at(inputs, points)
    for needed in ({1}, {0, 3}, {2}):
        found = polynomials_at(inputs, points, needed)
        for place in needed:
            assert np.array_equal(found[place], whole[place])
        for place in {2, 3} - needed:
            assert not found[place].any()
    assert not polynomials_at(inputs, points, {3})[:3].any()


FIT = Expansion((((0, 1),), ((1, 2),), ((0, 1), (1, 3))), np.array([5.0, 3.0, -4.0, 2.0]), 6.0, np.zeros(3))
"""5 + 3 p1(a) - 4 p2(b) + 2 p1(a) p3(b), and a variance of 6 beside it: 9 + 16 + 4 + 6 = 35."""


def test_shares_of_a_fit_by_hand():
    assert (FIT.variance, FIT.explained) == pytest.approx((35.0, 29.0 / 35.0), rel=1e-15)
    assert FIT.shares("ab") == pytest.approx({"a": 9.0 / 35.0, "b": 16.0 / 35.0}, rel=1e-15)
    # an interaction of two numbers of one input is the input's own
    assert FIT.shares("aa") == pytest.approx({"a": 29.0 / 35.0}, rel=1e-15)
    polynomials = np.array([[[2.0, 0.0, 0.0], [1.0, 9.0, 9.0]], [[0.0, 3.0, 0.5], [9.0, 1.0, -1.0]]])
    assert FIT.at(polynomials) == pytest.approx([5.0 + 6.0 - 12.0 + 2.0, 5.0 + 3.0 - 4.0 - 2.0], rel=1e-15)


@pytest.mark.parametrize("runs", [7, 50])
@pytest.mark.parametrize("owner", ["ab", "aa"])
def test_errors_of_shares_are_those_of_small_changes(owner, runs):
    """Coefficients of variance e/n and e of variance 2 e^2/n, by differences of the shares themselves."""

    def moved(place, by):
        return Expansion(
            FIT.terms, FIT.coefficients + by * (np.arange(4) == place), FIT.error + by * (place == 0), FIT.left_out
        ).shares(owner)

    spread = [2.0 * 36.0 / runs, *[6.0 / runs] * 3]  # of the error, and of each coefficient but the mean
    errors = FIT.share_errors(owner, runs)
    for name, error in errors.items():
        slopes = [(moved(k, 1e-5)[name] - moved(k, -1e-5)[name]) / 2e-5 for k in range(4)]
        assert error**2 == pytest.approx(np.dot(spread, np.square(slopes)), rel=1e-8, abs=0.0)
    assert list(errors) == list(dict.fromkeys(owner))


def test_a_result_that_does_not_vary_is_all_explained_and_no_share_of_it_is_in_doubt():
    polynomials = polynomials_at([EVEN, GROWING], np.random.default_rng(2).random((24, 2)))
    fit = fit_expansion(polynomials, np.full(24, 7.0))
    assert (fit.terms, fit.coefficients.tolist(), fit.error) == ((), [pytest.approx(7.0)], 0.0)
    assert (fit.variance, fit.explained) == (0.0, 1.0)
    assert fit.shares("ab") == fit.share_errors("ab", 24) == {"a": 0.0, "b": 0.0}
    assert not fit.left_out.any()


def planted(terms, numbers, runs, seed=3):
    """Return polynomials at random points, and the sum of some terms there."""
    one = [UncertainInput(str(k), EVEN.value, Range(""), 1.0, 4.0) for k in range(numbers)]
    polynomials = polynomials_at(one, np.random.default_rng(seed).random((runs, numbers)))
    columns = [size * np.prod([polynomials[k, :, n - 1] for k, n in term], axis=0) for term, size in terms.items()]
    return polynomials, 2.5 + np.sum(columns, axis=0)


@pytest.mark.parametrize(
    "terms",
    [
        {((0, 1),): 3.0, ((0, 4),): -2.0, ((1, 3),): 1.5, ((0, 1), (1, 1)): 1.0},
        {((0, 1),): 3.0, ((1, 1),): 2.0, ((0, 1), (1, 2)): 1.0, ((0, 2), (1, 1)): -0.5},
        # too small beside an interaction to be seen alone: of the first two degrees, it is tried again with it
        {((0, 1),): 3.0, ((1, 1),): -2.5, ((0, 1), (1, 1)): 1.0, ((2, 1),): 0.05, ((3, 2),): 0.03},
    ],
)
def test_a_sum_of_planted_terms_is_found_to_rounding(terms):
    polynomials, results = planted(terms, 4, 72)
    fit = fit_expansion(polynomials, results)
    assert fit.coefficients[0] == pytest.approx(2.5, rel=1e-10)
    found = dict(zip(fit.terms, fit.coefficients[1:], strict=True))
    assert {term: found.pop(term) for term in terms} == pytest.approx(terms, rel=1e-9)
    assert np.abs([*found.values(), 0.0]).max() < 1e-9
    assert fit.error < 1e-18
    assert fit.at(polynomials) == pytest.approx(results, rel=1e-10)


@pytest.mark.parametrize(
    "small", [((2, 3),), ((0, 2), (1, 2)), ((0, 1), (1, 3)), ((0, 1), (2, 1))], ids=["third", "2-2", "1-3", "unseen"]
)
def test_what_is_no_candidate_is_left_over(small):
    """The third degree of what alone explains nothing, interactions of more than three degrees, and of what is not seen."""
    terms = {((0, 1),): 3.0, ((1, 1),): -2.5, ((0, 1), (1, 1)): 1.0, small: 0.05}
    fit = fit_expansion(*planted(terms, 3, 72))
    assert set(terms) - {small} <= set(fit.terms)
    assert small not in fit.terms
    assert fit.error > 0.2 * 0.05**2


@pytest.mark.parametrize(("last", "seen"), [(7, True), (8, False)])
def test_pairs_are_tried_of_the_eight_that_explain_the_most(last, seen):
    terms = {((k, 1),): 10.0 - k for k in range(10)} | {((0, 1), (last, 1)): 1.0}
    assert (((0, 1), (last, 1)) in fit_expansion(*planted(terms, 10, 90)).terms) is seen


def test_what_is_left_of_a_fit_is_that_of_runs_left_out_in_truth():
    """Each run is left out in turn and the same terms fitted anew; and Friedman's error, of three parameters a term."""
    polynomials, results = planted({((0, 1),): 1.0, ((1, 2),): -0.5}, 2, 30)
    results = results + 0.4 * np.random.default_rng(4).standard_normal(30)
    fit = fit_expansion(polynomials, results)
    assert fit.terms
    matrix = np.column_stack(
        [np.ones(30), *(np.prod([polynomials[k, :, n - 1] for k, n in t], axis=0) for t in fit.terms)]
    )
    left = []
    for k in range(30):
        others = np.arange(30) != k
        left.append(results[k] - matrix[k] @ np.linalg.lstsq(matrix[others], results[others], rcond=None)[0])
    left = np.array(left) - np.mean(left)
    residual = results - matrix @ np.linalg.lstsq(matrix, results, rcond=None)[0]
    error = np.mean(residual**2) * (30.0 / (30.0 - 1.0 - 3.0 * len(fit.terms))) ** 2
    assert fit.error == pytest.approx(error, rel=1e-10)
    assert np.mean(fit.left_out**2) == pytest.approx(error, rel=1e-10)
    assert fit.left_out / np.sqrt(error) == pytest.approx(left / np.sqrt(np.mean(left**2)), rel=1e-9, abs=1e-11)


def orthonormal(runs, count):
    """Return columns of unit mean square that are orthogonal to one another and of mean 0."""
    source = np.random.default_rng(runs).standard_normal((runs, count + 1))
    source[:, 0] = 1.0
    return np.sqrt(runs) * np.linalg.qr(source)[0][:, 1:]


@pytest.mark.parametrize(("many", "kept"), [(12, 12), (13, 0)])
def test_the_search_ends_after_six_terms_without_a_gain(many, kept):
    """Equal terms, of which the last ones take the expected error down to nothing: of 12 among 64 runs the sixth is
    the first that gains, 6/(45/64)^2 < 12/(63/64)^2; of 13 the ninth, 4/(36/64)^2 < 13/(63/64)^2."""
    columns = hadamard(64)[:, 1:20].astype(float)
    found = _select(columns, columns[:, :many].sum(axis=1))
    assert sorted(found.chosen) == list(range(kept))
    assert found.error == pytest.approx(0.0 if kept else 13.0 * (64.0 / 63.0) ** 2, abs=1e-9)


@pytest.mark.parametrize("runs", [122, 128])
def test_forty_terms_are_kept_at_most(runs):
    """Each is worth three parameters: 40 of 122 runs leave one, and every further term gains more than it costs."""
    sizes = 2.5 ** -np.arange(44.0)
    sizes[38:] *= 50.0 ** -np.arange(1.0, 7.0)
    columns = orthonormal(runs, 44)
    assert _select(columns, columns @ np.sqrt(sizes)).chosen == list(range(40))


@pytest.mark.parametrize(("share", "chosen"), [(1.2e-6, 2), (0.8e-6, 1)])
def test_a_column_of_which_a_millionth_is_new_is_left_out(share, chosen):
    one, other = orthonormal(32, 2).T
    columns = np.column_stack([one, one + np.sqrt(share) * other])
    assert len(_select(columns, 100.0 * one + other).chosen) == chosen


@pytest.mark.parametrize(("size", "chosen"), [(1.2e-12, 2), (0.8e-12, 1)])
def test_a_term_of_less_than_1e_minus_24_of_the_variance_is_rounding(size, chosen):
    columns = hadamard(32)[:, 1:4].astype(float)
    assert len(_select(columns, columns[:, 0] + size * columns[:, 1]).chosen) == chosen


@pytest.mark.parametrize(("runs", "kept"), [(13, 3), (14, 4)])
def test_terms_leave_at_least_one_run_free(runs, kept):
    columns = orthonormal(runs, 6)
    found = _select(columns, columns @ 10.0 ** -np.arange(6.0))
    assert found.chosen == list(range(kept))


@pytest.mark.parametrize("unit", [1e-18, 1e-4, 1e9])
def test_a_fit_is_the_same_in_any_unit(unit):
    polynomials, results = planted({((0, 1),): 1.0, ((1, 2),): -0.5}, 2, 30)
    results = results + 0.1 * np.random.default_rng(4).standard_normal(30)
    one, other = fit_expansion(polynomials, results), fit_expansion(polynomials, unit * results)
    assert other.terms == one.terms
    assert other.coefficients == pytest.approx(unit * one.coefficients, rel=1e-9, abs=1e-9 * unit)
    assert other.left_out == pytest.approx(unit * one.left_out, rel=1e-9, abs=1e-9 * unit)
    assert other.explained == pytest.approx(one.explained, rel=1e-12)
    assert other.shares("ab") == pytest.approx(one.shares("ab"), rel=1e-12)
    assert other.share_errors("ab", 30) == pytest.approx(one.share_errors("ab", 30), rel=1e-12)
