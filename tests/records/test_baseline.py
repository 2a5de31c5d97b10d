"""The baseline under a blow: against scipy's regression, sums of correlated values, and examples worked by hand."""

import math

import numpy as np
import pytest
from scipy.stats import linregress

from strikewave.records import baseline
from strikewave.records.baseline import LocalBaseline, baseline_before, noise_before
from strikewave.records.robust import alike_as_one


@pytest.mark.parametrize("alike", [0.0, 0.3, 0.9])
def test_the_area_wanders_as_a_sum_of_correlated_widths(alike):
    apart = np.abs(np.subtract.outer(np.arange(7), np.arange(7)))
    expected = 2.0 * 10 * math.sqrt(np.sum(alike**apart))
    assert LocalBaseline(0.0, wander=2.0, width=10, alike=alike).area_wander(70) == pytest.approx(expected, rel=1e-12)
    assert math.isnan(LocalBaseline(0.0).area_wander(70))


def alternating(count, width):
    """Return widths that stand at +1 and -1 in turn, a width of a blow's foot, and the blow."""
    return np.concatenate([np.repeat(np.tile([1.0, -1.0], count // 2), width), np.full(2 * width, 99.0)])


@pytest.mark.parametrize("count", [40, 20, 8])
def test_of_widths_that_alternate_the_level_is_known_as_a_median_is(count):
    """Each misses by 1, and the level by pi/2 over their number of it; nothing within a width ripples."""
    width = 10
    found = baseline_before(alternating(count, width) + 5.0, (count + 1) * width, width)
    error = 0.5 * math.pi / count
    assert found.level == 5.0
    assert found.wander == pytest.approx(math.sqrt(1.0 + error), rel=1e-12)
    assert found.alike == pytest.approx(error / (1.0 + error), rel=1e-12)
    assert (found.slope, found.ripple, found.widths, found.width) == (0.0, 0.0, count, width)


def test_widths_that_resemble_the_next_tell_less_of_the_level():
    """Eight runs of five widths: 32 of 39 neighbours are equal, 7 opposite, a correlation of 25 / 40."""
    means = np.repeat(np.tile([1.0, -1.0], 4), 5)
    found = baseline_before(np.repeat(np.r_[means, 9.0, 9.0], 10), 410, 10)
    error = 0.5 * math.pi / 40 * (1.0 + 0.625) / (1.0 - 0.625)
    assert (found.level, found.slope, found.widths) == (0.0, 0.0, 40)
    assert found.wander == pytest.approx(math.sqrt(1.0 + error), rel=1e-12)
    assert found.alike == pytest.approx((0.625 + error) / (1.0 + error), rel=1e-12)


def test_of_six_widths_the_level_alone_is_known():
    found = baseline_before(alternating(6, 10), 70, 10)
    assert (found.level, found.widths, found.width, found.alike) == (0.0, 6, 10, 0.0)
    assert math.isnan(found.wander)


def test_less_than_a_width_or_four_samples_is_no_baseline():
    values = np.zeros(100)
    assert baseline_before(values, 20, 10) is not None
    assert baseline_before(values, 19, 10) is None
    assert baseline_before(values, 6, 2) is not None
    assert baseline_before(values, 5, 2) is None
    assert baseline_before(values, 50, 10, 10) is not None
    assert baseline_before(values, 49, 10, 10) is None


def test_what_lies_two_widths_after_the_blow_before_or_far_back_is_not_seen(rng):
    values = rng.normal(size=4000)
    later = values.copy()
    later[:1020] = 1e6
    assert baseline_before(later, 2000, 10, 1000) == baseline_before(values[1020:], 980, 10)
    assert baseline_before(values, 3500, 10) == baseline_before(values[3490 - 2560 :], 2570, 10)
    assert np.array_equal(noise_before(later, 2000, 10, 1800), noise_before(values[1820:], 180, 10))
    assert np.array_equal(noise_before(values, 3500, 10), noise_before(values[3090:], 410, 10))


@pytest.mark.parametrize(("widths", "slope"), [(12, 0.2), (40, -0.5), (40, 0.0), (11, 0.2)])
def test_a_slope_is_carried_on_as_a_regression_predicts(widths, slope):
    """Residuals that alternate have no memory: level and what it misses are those of a prediction of one new value."""
    place = np.arange(widths, dtype=float)
    means = 3.0 + slope * place + 0.1 * (-1.0) ** place
    level = LocalBaseline(0.0, wander=2.0, width=10)
    found = baseline._sloped(means, 10, level)
    if widths < 12 or not slope:
        assert found is level
        return
    line = linregress(place, means)
    rest = means - line.intercept - line.slope * place
    spread = np.sum((place - place.mean()) ** 2)
    ahead = widths + 1.0 - place.mean()
    scatter = math.sqrt(np.sum(rest**2) / (widths - 2))
    assert found.slope == pytest.approx(line.slope / 10, rel=1e-12)
    assert found.level == pytest.approx(line.intercept + line.slope * (widths + 1.0), rel=1e-12)
    assert found.wander == pytest.approx(scatter * math.sqrt(1.0 + 1.0 / widths + ahead**2 / spread), rel=1e-9)
    for share, taken in ((0.59, True), (0.61, False)):
        level = level._replace(wander=found.wander / share)
        assert (baseline._sloped(means, 10, level) is not level) is taken


def test_a_slope_of_four_standard_errors_is_one():
    place = np.arange(20.0)
    noise = (-1.0) ** place
    noise -= np.polyval(np.polyfit(place, noise, 1), place)
    error = linregress(place, noise + place).stderr
    for share, taken in ((4.04, True), (3.96, False)):
        level = LocalBaseline(0.0, wander=1e3, width=5)
        assert (baseline._sloped(noise + share * error * place, 5, level) is not level) is taken


def test_a_nearer_baseline_is_taken_where_it_misses_less():
    """A slow hum, 40 widths long: the mean of three widths misses 2 sin(3 pi / 40) of it, that of eight too much."""
    means = np.cos(2.0 * math.pi * np.arange(40) / 40)
    found = baseline_before(np.repeat(np.r_[means, 0.0, 0.0], 10), 410, 10)
    missed = baseline._missed(means, 3)
    assert found.widths == 3
    assert found.slope == 0.0
    assert found.wander == pytest.approx(math.sqrt(np.mean(missed**2)), rel=1e-12)
    assert found.wander == pytest.approx(math.sqrt(2.0) * math.sin(3.0 * math.pi / 40), rel=0.05)
    assert found.level == pytest.approx(np.mean(means[-3:]), rel=1e-12)
    assert found.alike == 0.9


def test_a_mean_misses_the_width_after_next(rng):
    means = rng.normal(size=12)
    expected = [means[k + 4] - means[k : k + 3].mean() for k in range(8)]
    assert baseline._missed(means, 3) == pytest.approx(np.array(expected), rel=1e-9)
    assert baseline._missed(means[:5], 3).size == 1
    assert baseline._missed(means[:4], 3).size == 0


def test_the_ripple_of_a_fifth_about_its_width():
    """Fifths of 0, 0, 0, 0 and 5 lie 1 below and 4 above their mean: root mean square 2, of four degrees of freedom."""
    blocks = np.tile(np.repeat([0.0, 0.0, 0.0, 0.0, 5.0], 2), (3, 1))
    assert baseline._ripple(blocks, blocks.mean(axis=1)) == pytest.approx(2.0 * math.sqrt(5.0 / 4.0))
    assert math.isnan(baseline._ripple(blocks[:, :1], blocks[:, 0]))
    assert baseline._ripple(np.array([[1.0, 3.0]]), np.array([2.0])) == pytest.approx(math.sqrt(2.0))


def test_noise_is_what_a_straight_line_leaves(rng):
    values = rng.normal(size=600) + 0.1 * np.arange(600)
    part = values[180:580]
    expected = part - np.polyval(np.polyfit(np.arange(400), part, 1), np.arange(400))
    assert noise_before(values, 590, 10) == pytest.approx(expected, abs=1e-9)
    short = noise_before(values, 39, 10, white=3.0)
    assert short.size == 80
    assert np.std(short) == pytest.approx(3.0, rel=0.2)  # of 80: to 8 %
    assert noise_before(values, 40, 10).size == 30


def test_medians_of_a_long_record_wander_with_it():
    means = np.r_[np.full(40, 1.0), np.full(40, 5.0)]
    assert np.array_equal(baseline._medians_before(means, 9.0), means)
    assert baseline._medians_before(means[:40], 9.0) == 9.0


def test_the_memory_of_neighbours():
    assert baseline._alike(np.array([1.0, 1.0, -1.0, -1.0])) == 0.25
    assert baseline._alike(np.array([1.0, -1.0])) == 0.0
    assert baseline._alike(np.ones(99)) == 0.9
    assert baseline._alike(np.zeros(3)) == 0.0
    assert baseline._alike(1e-6 * np.array([1.0, 1.0, -1.0, -1.0])) == pytest.approx(0.25)
    assert alike_as_one(1e-6 * np.array([1.0, 1.0, -1.0, -1.0])) == pytest.approx(1.25 / 0.75)
    assert alike_as_one(np.array([1.0, 1.0, -1.0, -1.0])) == pytest.approx(1.25 / 0.75)
    assert alike_as_one(np.ones(99)) == pytest.approx(19.0)
    assert alike_as_one(np.zeros(3)) == alike_as_one(np.array([1.0, -1.0])) == 1.0
