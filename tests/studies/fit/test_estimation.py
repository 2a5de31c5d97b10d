"""Least squares in the unit cube, against pulses in closed form whose values and noise are planted."""

import numpy as np
import pytest
from scipy.signal import lfilter

from strikewave.studies.fit.covariance import ResidualBlock, estimate
from strikewave.studies.fit.estimation import FINAL_STEP, Search, is_quadratic, profile
from strikewave.studies.fit.noise import autocorrelation, independent_count

TIME = np.linspace(-1.0, 1.0, 160)


def pulse(place):
    """A pulse of two values, height and width, each from a tenth to ten times 1 as its place goes from 0 to 1."""
    height, width = 10.0 ** (2.0 * np.asarray(place) - 1.0)
    return height * np.exp(-((TIME / (0.3 * width)) ** 2))


def coloured(rng, share, count):
    """Noise of deviation 1 with a correlation of ``share`` between neighbours."""
    noise = lfilter([np.sqrt(1.0 - share**2)], [1.0, -share], rng.standard_normal(count + 200))
    return noise[200:]


def fitted(residuals, blocks, start=(0.4, 0.6)):
    search = Search(residuals, len(start))
    search.begin(np.array(start))
    place, left = search.descend(np.array(start))
    return search, estimate(place, left, search.slopes(place, left, FINAL_STEP, both=True), blocks)


@pytest.mark.verify
@pytest.mark.parametrize("share", [0.0, 0.9])
def test_intervals_hold_planted_values_in_95_of_100_fits(share):
    """In white noise, and in noise of 20 samples' memory that weights know nothing of: 60 fits of 2 values each.

    The colour is that of 600 quiet samples, as of a record. Of 120 intervals of 95 %, 120 ± 2.4 standard deviations of
    chance give 108 to 119.
    """
    rng, inside = np.random.default_rng(20), 0
    for _ in range(60):
        truth, deviation = rng.uniform(0.4, 0.6, 2), 0.02
        measured = pulse(truth) + deviation * coloured(rng, share, TIME.size)
        colour = autocorrelation(coloured(rng, share, 600))
        block = [ResidualBlock(slice(0, TIME.size), colour, 0, quiet=independent_count(600, colour))]
        _, found = fitted(lambda place, m=measured, d=deviation: (pulse(place) - m) / d, block)
        assert not found.groups()
        inside += np.count_nonzero(np.abs(found.place - truth) < found.reach * found.errors)
    assert 108 <= inside <= 119


def test_slow_noise_beneath_white_noise_is_seldom_taken_for_much_less_than_it_is():
    """A fifth of the power has a memory of 33 samples, and 216 quiet samples show it: of 40 errors of the height of a
    pulse at most 20 are below 0.6 of the true one, as some can be whose six independent samples show nothing slow. The
    order of the least criterion alone leaves 55 of 100.
    """
    rng, shape, lags = np.random.default_rng(20), pulse([0.5, 0.5]), np.arange(TIME.size)
    apart = np.abs(lags[:, None] - lags)
    truth = shape @ (0.8 * np.eye(TIME.size) + 0.2 * 0.97**apart) @ shape
    low = 0
    for _ in range(40):
        noise = np.sqrt(0.8) * coloured(rng, 0.0, 216) + np.sqrt(0.2) * coloured(rng, 0.97, 216)
        known = np.append(np.var(noise) * autocorrelation(noise), np.zeros(TIME.size))[: TIME.size]
        low += shape @ known[apart] @ shape < 0.36 * truth
    assert low <= 20


@pytest.mark.parametrize("seed", range(8))
def test_values_that_only_their_product_fixes_are_named_and_no_other(seed):
    """Height = a b: a and b together are undetermined whatever the noise, the width is not."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(0.4, 0.6, 3)

    def model(place):
        return pulse([place[0] + place[1] - 0.5, place[2]])

    deviation = 10.0 ** rng.uniform(-4.0, -1.5)
    measured = model(truth) + deviation * rng.standard_normal(TIME.size)
    block = [ResidualBlock(slice(0, TIME.size), np.ones(1), 0)]
    _, found = fitted(lambda place: (model(place) - measured) / deviation, block, start=(0.4, 0.5, 0.6))
    assert found.groups() == [[0, 1]]
    assert np.isinf(found.errors[:2]).all()
    assert abs(found.place[2] - truth[2]) < 5.0 * found.errors[2]
    along = found.undetermined[:, 0] * np.sign(found.undetermined[0, 0])
    assert along == pytest.approx([np.sqrt(0.5), -np.sqrt(0.5), 0.0], abs=1e-3)


def test_a_value_that_nothing_was_measured_of_is_undetermined_alone():
    block = [ResidualBlock(slice(0, TIME.size), np.ones(1), 0)]
    measured = pulse([0.5, 0.5])
    _, found = fitted(lambda place: (pulse([place[0], 0.5]) - measured) / 0.01 + 0.0 * place[1], block)
    assert found.groups() == [[1]]


def test_a_profile_gives_the_interval_that_a_parabola_does_not():
    """One number, x^2 = 0.25: the ends solve (x^2 - 0.25)/u = ± 1.96 in closed form."""
    uncertainty = 0.1

    def residuals(place):
        return np.array([(place[0] ** 2 - 0.25) / uncertainty])

    search, found = fitted(residuals, [ResidualBlock(slice(0, 1), np.ones(1), 0)], start=(0.6,))
    assert not is_quadratic(search, found, 0)
    ends = profile(search, found, 0)
    assert [ends.low, ends.high] == pytest.approx(np.sqrt(0.25 + np.array([-1.96, 1.96]) * uncertainty), abs=3e-3)


def test_of_two_valleys_the_deeper_is_found():
    """100 (x - 0.2)^2 (x - 0.75)^2 + (x - 0.75)^2: a search from the shallow one stays there, several starts do not."""

    def residuals(place):
        return np.array([10.0 * (place[0] - 0.2) * (place[0] - 0.75), place[0] - 0.75, place[1] - 0.5])

    search, start = Search(residuals, 2), np.array([0.15, 0.4])
    search.begin(start)
    assert search.descend(start)[0][0] == pytest.approx(0.2, abs=0.03)
    assert search.wide(start)[0][0] == pytest.approx([0.75, 0.5], abs=1e-5)


def test_a_place_that_cannot_be_run_turns_the_search_back():
    """Half of the cube fails: the best place beside it is found from several starts, of which some fail."""

    def residuals(place):
        if place[0] > 0.55:
            raise ValueError("cannot be run")
        return np.append(10.0 * (place - 0.5), 0.1)

    search = Search(residuals, 2)
    search.begin(np.array([0.1, 0.9]))
    assert search.wide(np.array([0.1, 0.9]))[0][0] == pytest.approx([0.5, 0.5], abs=1e-6)


def test_colour_of_noise_is_found_from_few_samples():
    """Of an autoregression with 0.9, 600 samples: the independent ones, n (1 - a^2)/(1 + a^2) in closed form.

    One such record knows its own memory of 20 samples to a third; the median of 30 is below that.
    """
    counts = [
        independent_count(600, autocorrelation(coloured(np.random.default_rng(seed), 0.9, 600))) for seed in range(30)
    ]
    assert np.median(counts) == pytest.approx(600.0 * 0.19 / 1.81, rel=0.2)
