"""Gaussian processes against scipy's normal distribution and explicit refits; designs by few runs in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal, qmc

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.studies.search import design_report as report
from strikewave.studies.search.design import design
from strikewave.studies.search.gaussian_process import LENGTHS, NUGGET, GaussianProcess, correlations, fitted_process
from strikewave.studies.search.plan import plan_of

G = 9.80665
HEIGHT = ["machine.height=0.1..2 m"]
BALL = load_case("iso-16063-22-dropball")
SEEDS = st.integers(0, 2**32 - 1)


def some(seed, count=8, size=2):
    """Places that lie apart, and values without any law."""
    source = np.random.default_rng(seed)
    return qmc.Sobol(size, seed=source).random(count), source.standard_normal(count)


def matrix(process):
    return correlations(process.places, process.places, process.lengths) + NUGGET * np.eye(process.values.size)


@given(SEEDS)
@settings(max_examples=20)
def test_the_cost_is_the_likelihood_of_a_normal_distribution(seed):
    """-2 ln L = cost + n (1 + ln 2 pi), with the mean and variance of the process itself."""
    process = GaussianProcess(*some(seed), np.array([0.3, 0.5]))
    law = multivariate_normal(np.full(8, process.mean), process.variance * matrix(process))
    assert -2.0 * law.logpdf(process.values) == pytest.approx(process.cost + 8 * (1.0 + math.log(2.0 * math.pi)))


@given(SEEDS)
@settings(max_examples=10)
def test_what_is_left_out_is_what_a_process_without_it_misses(seed):
    """Dubrule: no refit needed; to 1e-6, the nugget over the variance of what is known of a place."""
    places, values = some(seed)
    lengths = np.array([0.4, 0.6])
    left = GaussianProcess(places, values, lengths).left_out()
    for k in range(values.size):
        rest = np.arange(values.size) != k
        value, _ = GaussianProcess(places[rest], values[rest], lengths).at(places[k : k + 1])
        assert left[k] == pytest.approx(values[k] - value[0], rel=1e-5, abs=1e-5)


@given(SEEDS)
@settings(max_examples=10)
def test_a_process_goes_through_its_runs_and_far_from_them_knows_its_mean_alone(seed):
    process = GaussianProcess(*some(seed), np.array([0.2, 0.2]))
    value, spread = process.at(process.places)
    assert value == pytest.approx(process.values, abs=1e-5)
    assert np.all(spread < 1e-3)
    value, spread = process.at(np.full((1, 2), 100.0))
    assert value[0] == pytest.approx(process.mean)
    # of the mean, Var = s^2/(1' R^-1 1), besides that of a place, s^2
    known = 1.0 + 1.0 / np.linalg.inv(matrix(process)).sum()
    assert spread[0] == pytest.approx(math.sqrt(process.variance * known))


def test_lengths_tell_what_a_number_feels():
    """Of a number that feels the first of two settings alone the second has the largest length that is sought."""
    places = qmc.Sobol(2, seed=1).random(16)
    process = fitted_process(places, np.sin(4.0 * places[:, 0]))
    assert process.lengths[0] < 1.0
    assert process.lengths[1] == pytest.approx(LENGTHS[1])
    assert process.cost <= GaussianProcess(places, process.values, np.ones(2)).cost


def test_few_runs_find_the_height_of_free_fall():
    """v^2 = 2 g h: the middle of the band in 20 runs, to 1 % of the height; their error is told."""
    study = design(BALL, HEIGHT, ["approach_speed = 4 m/s +- 1 %"], analysis="impact", runs=20, search="surrogate")
    assert study.best.row[0] == pytest.approx(4.0**2 / (2.0 * G), rel=0.01)
    assert len(study.rows) <= 20 + 2
    (error,) = study.surrogate
    assert error.name == "approach_speed"
    assert 0.0 < error.share < 0.05
    assert "leave-one-out error" in report.page(study)
    assert "dubrule-1983" in study.citations


def test_few_runs_go_to_the_limit_of_a_goal_and_equal_seeds_are_equal():
    words = BALL, HEIGHT, ["approach_speed < 4 m/s", "peak_force largest"]
    first, again = (design(*words, analysis="impact", runs=20, search="surrogate", workers=n) for n in (1, None))
    assert first.candidates[0].numbers[0] == pytest.approx(4.0, rel=0.01)
    assert first.candidates[0].numbers[0] <= 4.0
    assert first.rows == again.rows


def test_elements_are_sought_by_surrogate_unless_it_is_stated_otherwise():
    case, vary = load_case("two-bars-fem"), ["mesh.part.striker.velocity.z=1..5 m/s"]
    plan = plan_of(case, vary, ["first.peak_force < 20 kN"])
    assert plan.by_surrogate
    assert plan.runs == 40
    assert not plan_of(case, vary, ["first.peak_force < 20 kN"], search="evolution").by_surrogate
    with pytest.raises(
        InputError, match=r'search: got "surogate"; allowed: one of evolution, surrogate, optuna; .*surrogate'
    ):
        plan_of(BALL, HEIGHT, ["approach_speed < 4 m/s"], "impact", search="surogate")
