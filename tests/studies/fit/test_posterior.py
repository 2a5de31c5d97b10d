"""The sampled posterior against closed forms: normal, Student's t, truncated by bounds, and along what is not known."""

import json
import sys
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.stats import f as f_distribution
from scipy.stats import multivariate_t, norm, t, truncnorm

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.studies.fit.covariance import Estimate
from strikewave.studies.fit.posterior import LONG, WALKERS, Posterior, _moves, _sampled, sample
from strikewave.studies.fit.study import fit

SLOPES = np.array([[40.0, 5.0], [-12.0, 30.0], [8.0, 25.0], [20.0, -9.0]])
BEST = np.array([0.45, 0.55])


def residuals(place):
    """A linear model whose best place leaves nothing."""
    return SLOPES @ (place - BEST)


def linear(covariance=None, reach=1.96):
    covariance = np.linalg.inv(SLOPES.T @ SLOPES) if covariance is None else covariance
    return Estimate(BEST, residuals(BEST), SLOPES, covariance, np.zeros((2, 0)), np.full(2, reach))


def errors_of(posterior):
    """Monte Carlo error of a quantile, in standard deviations: of 2.5 % it is sqrt(p (1 - p)/n) over the density there."""
    return np.sqrt(0.025 * 0.975 / posterior.independent) / norm.pdf(1.96)


@pytest.mark.verify
@pytest.mark.parametrize("reach", [1.96, t.ppf(0.975, 6.0)])
@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_the_posterior_of_a_linear_model_is_that_of_the_closed_form(reach, scale):
    """Normal with the 95 % of the fit, Student's t or not, also where its covariance is not 1/J'J: within 4 errors of chance."""
    shape = np.array([[scale, 0.3], [0.3, 1.0]])
    root = np.linalg.inv(SLOPES.T @ SLOPES)
    found = linear(shape @ root @ shape.T, reach)
    posterior = sample(residuals, found)
    assert not posterior.too_short
    assert posterior.steps >= LONG * posterior.memory
    deviations, chance = np.sqrt(np.diag(found.covariance)), errors_of(posterior)
    assert posterior.quantiles(0.5) == pytest.approx(BEST, abs=4.0 * chance * deviations.max() * reach / 1.96)
    for side, share in ((-1.0, 0.025), (1.0, 0.975)):
        apart = (posterior.quantiles(share) - BEST) / deviations
        assert apart == pytest.approx(np.full(2, side * reach), abs=4.0 * chance * reach / 1.96)
    expected = found.covariance[0, 1] / np.prod(deviations)
    assert np.corrcoef(posterior.draws.T)[0, 1] == pytest.approx(expected, abs=4.0 / np.sqrt(posterior.independent))


@pytest.mark.verify
def test_bounds_cut_the_posterior_off():
    """A best place at a bound: half a normal distribution."""
    slope, best = np.array([[20.0]]), np.array([0.0])
    found = Estimate(best, np.zeros(1), slope, np.array([[1.0 / 400.0]]), np.zeros((1, 0)), np.full(1, 1.96))
    posterior = sample(lambda place: slope @ (place - best), found)
    assert posterior.draws.min() >= 0.0
    half = truncnorm(0.0, np.inf, scale=0.05)
    assert posterior.quantiles(0.975)[0] == pytest.approx(half.ppf(0.975), abs=4.0 * 0.05 * errors_of(posterior))
    assert posterior.quantiles(0.5)[0] == pytest.approx(half.ppf(0.5), abs=4.0 * 0.05 * errors_of(posterior))


@pytest.mark.verify
def test_what_is_not_determined_is_as_likely_as_its_prior():
    """Only the sum of two places is known: each is even over the bounds, but where the other would lie beyond."""
    slopes = np.array([[60.0, 60.0]])
    best, along = np.array([0.5, 0.5]), np.array([[np.sqrt(0.5)], [-np.sqrt(0.5)]])
    across = np.full((2, 2), 0.5) / (2.0 * 3600.0)
    found = Estimate(best, np.zeros(1), slopes, across, along, np.full(2, 1.96))
    posterior = sample(lambda place: slopes @ (place - best), found)
    assert np.sum(posterior.draws, axis=1).std() == pytest.approx(1.0 / 60.0, rel=0.1)
    for share in (0.025, 0.25, 0.75):  # four errors of chance of a share
        chance = 4.0 * np.sqrt(share * (1.0 - share) / posterior.independent)
        assert posterior.quantiles(share)[0] == pytest.approx(share, abs=chance + 0.01)


@pytest.mark.verify
def test_chains_are_the_same_bit_for_bit_and_short_ones_are_told(monkeypatch):
    monkeypatch.setattr("strikewave.studies.fit.posterior.MOST_RUNS", 50 * WALKERS)
    first, second, other = (sample(residuals, linear(), seed=seed) for seed in (1, 1, 2))
    assert first.too_short
    assert np.array_equal(first.draws, second.draws)
    assert not np.array_equal(first.draws[:50], other.draws[:50])
    assert Posterior(first.draws, 100, 10.0, 0.5, 1).too_short


def test_an_interrupt_keeps_the_chains_so_far():
    def interrupt(runs, misfit):
        if runs > 2000:
            raise KeyboardInterrupt

    posterior = sample(residuals, linear(), interrupt)
    assert posterior.stopped
    assert posterior.too_short
    assert sample(residuals, linear(), lambda runs, _: interrupt(2000 + runs, 0.0) if runs > 40 else None) is None


def test_without_the_extra_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(InputError) as error:
        fit(load_case("li-ma-2019"), bayes=True)
    assert str(error.value) == "--bayes needs emcee: pip install 'strikewave[bayes]'"


@pytest.mark.verify
def test_intervals_of_a_planted_drop_are_those_of_least_squares(tmp_path, strikewave, monkeypatch):
    """A record of 1 % of white noise: 95 % intervals within 15 % of those of the standard errors, medians within one.

    Of 800 independent draws, of which 2000 are usual, an interval is good to 4 %.
    """
    monkeypatch.setattr("strikewave.studies.fit.posterior.LONG", 25.0)
    monkeypatch.setattr("strikewave.studies.fit.posterior.ENOUGH", 800.0)
    from .test_fit import DROP, FIELDS, write_record

    truth = load_case(DROP, ["contact.reference_force=900 kN", "contact.restitution=0.72"])
    record = write_record(tmp_path / "a.csv", truth, 0)
    free = [word for path in FIELDS for word in ("--free", path)]
    words = ("fit", DROP, "--set", "contact.restitution=0.6", "--to", record, *free, "--bayes", "--out", "written")
    assert strikewave(*words)[0] == 0
    document = json.loads((tmp_path / "written" / "fit.json").read_text())
    assert not document["posterior"]["too_short"]
    for one, fitted in zip(document["posterior"]["parameters"], document["parameters"], strict=True):
        assert one["high"] - one["low"] == pytest.approx(fitted["high"] - fitted["low"], rel=0.15)
        assert abs(one["median"] - fitted["value"]) < fitted["standard_error"]
    page = (tmp_path / "written" / "report.html").read_text()
    assert "Posterior beside least squares" in page
    assert (tmp_path / "written" / "posterior.svg").is_file()
    assert len((tmp_path / "written" / "posterior.csv").read_text().splitlines()) > 800


@pytest.mark.verify
def test_a_posterior_of_numbers_has_its_pictures_and_tables(monkeypatch, tmp_path, strikewave):
    """Two numbers, two fields, chains cut short: it is said, and written whole."""
    monkeypatch.setattr("strikewave.studies.fit.posterior.MOST_RUNS", 25 * WALKERS)
    monkeypatch.setattr("strikewave.studies.simulation.Simulation.number", _closed_form)
    to = ["--to", "first.rigid_peak=1500 g +- 1 %", "--to", "first.width=450 us +- 2 %", "--out", "written"]
    free = ["--free", "contact.reference_force", "--free", "contact.restitution"]
    code, out, err = strikewave("fit", "jesd22-b111-b", "--set", "contact.restitution=0.65", *to, *free, "--bayes")
    assert code == 0, err
    assert "Posterior beside least squares" in out
    assert "chains of 25 steps are too short" in err
    found = ElementTree.parse(tmp_path / "written" / "posterior.svg").getroot()
    assert found.tag.endswith("svg")
    document = json.loads((tmp_path / "written" / "fit.json").read_text())
    assert document["posterior"]["too_short"]
    assert document["posterior"]["seed"] == 20


def _closed_form(self, name, sensor=""):
    """Stand for the run: a spring and a loss, both in each number."""
    force = self.case.contact.reference_force.si / 789.6e3
    loss = self.case.contact.restitution.si
    return {"first.rigid_peak": 14700.0 * force**0.5 * (1.2 - 0.3 * loss), "first.width": 450e-6 * (0.6 + 0.6 * loss)}[
        name
    ]


class Sampler:
    """Stands for a sampler of chains of two values, the second of which remembers for longer."""

    def __init__(self, steps, *times):
        self.iteration, self.times, self.acceptance_fraction = steps, np.array(times), np.array([0.2, 0.4])

    def get_autocorr_time(self, tol):
        assert tol == 0
        return self.times

    def get_chain(self, discard, flat):
        assert flat
        return np.full((1, 2), float(discard))


@pytest.mark.parametrize(
    ("times", "memory", "left_out"),
    [((1.2, 7.4), 7.4, 15), ((0.4, 0.2), 1.0, 2), ((30.0, 2.0), 30.0, 50), ((1.0, np.nan), np.inf, 50)],
)
def test_draws_are_those_after_two_memories_or_of_the_second_half(times, memory, left_out):
    """Of 101 steps; the memory is the longest, a step at least, and without an end where none is found."""
    found = _sampled(Sampler(101, *times), 17, False)
    assert (found.steps, found.memory, found.runs, found.stopped) == (101, memory, 17, False)
    assert found.accepted == pytest.approx(0.3)
    assert found.draws[0, 0] == left_out


def test_moves_of_the_fit_are_student_t_of_four_degrees_about_it():
    """Ratio of densities to the last digit of scipy's, its distances that of Fisher's F of 2 and 4: the median to 3 %."""
    found = linear(np.array([[4e-4, 3e-4], [3e-4, 9e-4]]), 2.5)
    moves = _moves(found)
    assert [share for _, share in moves] == pytest.approx([0.7, 0.15, 0.15])
    wide = np.array([[4e-4, 3e-4], [3e-4, 9e-4]]) * (2.5 / 1.96) ** 2
    places = BEST + np.random.default_rng(2).normal(0.0, 0.05, (20000, 2))
    new, ratio = moves[0][0].get_proposal(places, np.random.RandomState(3))
    density = multivariate_t(BEST, wide, 4.0)
    assert ratio == pytest.approx(density.logpdf(places) - density.logpdf(new), abs=1e-9)
    apart = np.einsum("ij,jk,ik->i", new - BEST, np.linalg.inv(wide), new - BEST) / 2.0
    for share in (0.25, 0.5, 0.9):
        assert np.quantile(apart, share) == pytest.approx(f_distribution.ppf(share, 2, 4), rel=0.04)
    covered = np.mean((new - BEST) @ np.array([1.0, -1.0]) > 0.0)
    assert covered == pytest.approx(0.5, abs=0.015)
    assert new.mean(axis=0) == pytest.approx(BEST, abs=2e-3)
    ensembles = _moves(Estimate(BEST, np.zeros(1), SLOPES, np.eye(2), np.array([[0.6], [0.8]]), np.full(2, 1.96)))
    assert [share for _, share in ensembles] == [0.5, 0.5]


def test_chains_keep_within_bounds_and_where_the_model_runs(monkeypatch):
    """Of 50 steps and 32 chains: none below 0, none where there is no number or no run; progress counts them."""
    monkeypatch.setattr("strikewave.studies.fit.posterior.MOST_RUNS", 50 * WALKERS + 31)
    told = []

    def some(place):
        if place[0] > 0.04:
            raise ValueError("cannot be run")
        return np.full(1, np.nan) if place[0] > 0.03 else place / 0.02

    found = Estimate(
        np.zeros(1), np.zeros(1), np.array([[50.0]]), np.array([[4e-4]]), np.zeros((1, 0)), np.full(1, 1.96)
    )
    posterior = sample(some, found, lambda runs, misfit: told.append((runs, misfit)))
    assert (posterior.steps, posterior.too_short, posterior.stopped) == (50, True, False)
    assert 0.0 <= posterior.draws.min() < 0.003
    assert 0.027 < posterior.draws.max() <= 0.03
    assert told[-1] == (posterior.runs, 0.0)
    assert len(told) > 50
    assert 0.3 < posterior.accepted < 0.9


def test_chains_are_looked_at_every_25_steps(monkeypatch):
    looked = []

    def sampled(sampler, runs, stopped):
        looked.append(sampler.iteration)
        return SimpleNamespace(too_short=len(looked) < 2)

    monkeypatch.setattr("strikewave.studies.fit.posterior._sampled", sampled)
    sample(residuals, linear())
    assert looked == [25, 50, 50]
