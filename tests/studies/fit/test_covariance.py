"""How far residuals fix a place: against closed forms, and against pulses whose values, scatter and patterns are planted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.stats import t

from strikewave.studies.fit.covariance import (
    NONE,
    ResidualBlock,
    by_noise,
    design_effect,
    estimate,
    larger,
    scatter_of_shots,
)

TIME = np.linspace(-1.0, 1.0, 100)
NOISE = 0.005
"""Over the peak."""


def pulse(height, width):
    return height * np.exp(-((TIME / width) ** 2))


SLOPES = np.column_stack([pulse(1.0, 0.3), 2.0 * (TIME / 0.3) ** 2 * pulse(1.0, 0.3)])
"""Of a pulse of height and width 1, by their logarithms: of a place in the unit cube where that is their logarithm."""


def fitted_shots(rng, count, scatter=0.0, stated=0.0, pattern=0.0, repeats=True):
    """The estimate of two logarithms, 0 each, from shots of this scatter, with a pattern that the model knows not of.

    Linear: the place moves by what least squares says. Amplitudes scatter, and widths as much.
    """
    phases, period = rng.uniform(0.0, 2.0 * np.pi, count), rng.uniform(0.15, 0.3)
    shots = [
        SLOPES @ (scatter * rng.standard_normal(2))
        + pattern * (np.abs(TIME) < 0.6) * np.sin(2.0 * np.pi * TIME / period + phases[0 if repeats else k])
        + NOISE * rng.standard_normal(TIME.size)
        for k in range(count)
    ]
    jacobian = np.tile(SLOPES, (count, 1)) / NOISE
    place, *_ = np.linalg.lstsq(jacobian, np.concatenate(shots) / NOISE)
    residuals = jacobian @ place - np.concatenate(shots) / NOISE
    known, blocks = stated * SLOPES / NOISE if stated else NONE, []
    for k in range(count):
        rows = slice(k * TIME.size, (k + 1) * TIME.size)
        alone = residuals[rows] - SLOPES @ np.linalg.lstsq(SLOPES, residuals[rows])[0]
        blocks.append(ResidualBlock(rows, np.ones(1), k, alone if pattern else None, stated=known))
    return estimate(place, residuals, jacobian, blocks)


def coverage(count, fits=250, **planted):
    """Share of 95 % intervals that hold 0; root mean square of the standard errors, and of the errors that were made."""
    rng = np.random.default_rng(100 + count)
    found = [fitted_shots(rng, count, **planted) for _ in range(fits)]
    inside = np.mean([np.abs(one.place) < one.reach * one.errors for one in found])
    errors, made = (np.array([getattr(one, name) for one in found]) for name in ("errors", "place"))
    return inside, *(np.sqrt(np.mean(np.square(what), axis=0)) for what in (errors, made))


@pytest.mark.parametrize("count", [1, 2, 5, 10])
def test_intervals_of_shots_that_scatter_by_2_percent_hold_the_truth(count):
    """Of 500 intervals 90 to 98 % hold, and their errors are 2 %/sqrt(n), be there one shot or ten.

    What one shot cannot tell is stated for it; of more, their scatter tells it. The root mean square error of 250 fits
    whose variance has n - 1 degrees of freedom is good to 1/sqrt(2 250 (n - 1)), 5 % for two: four of those.
    """
    inside, errors, _ = coverage(count, scatter=0.02, stated=0.02 if count == 1 else 0.0)
    assert 0.90 <= inside <= 0.98
    assert errors == pytest.approx(np.full(2, 0.02 / np.sqrt(count)), rel=0.2)


def one_shot(rng, quiet, scatter):
    """The estimate of the two logarithms from a shot whose noise so many samples show; the scatter of height is stated."""
    shot = SLOPES[:, 0] * scatter * rng.standard_normal() + NOISE * rng.standard_normal(TIME.size)
    shown = NOISE * np.sqrt(rng.chisquare(quiet) / quiet)
    place, *_ = np.linalg.lstsq(SLOPES, shot)
    residuals, jacobian = (SLOPES @ place - shot) / shown, SLOPES / shown
    block = ResidualBlock(slice(0, TIME.size), np.ones(1), 0, stated=scatter * jacobian[:, :1], quiet=quiet)
    return estimate(place, residuals, jacobian, [block])


@pytest.mark.parametrize("scatter", [0.002, 0.02])
def test_a_stated_scatter_is_as_sure_as_it_is_stated_however_short_the_quiet(scatter):
    """Six samples show the noise, and 2 % of scatter outweighs it: an interval of the height is 1.96 standard errors.

    Student's t of six for all of it, 2.45, held 98.6 % of 4000. Of 4000, 95 % have a standard deviation of 0.34 points;
    that of the width, which noise alone moves, is as wide as t has it.
    """
    rng = np.random.default_rng(6)
    found = [one_shot(rng, 6, scatter) for _ in range(4000)]
    inside = np.mean([np.abs(one.place) < one.reach * one.errors for one in found], axis=0)
    assert inside == pytest.approx([0.95, 0.95], abs=0.012)
    reach = np.array([one.reach for one in found])
    assert reach[:, 1] == pytest.approx(np.full(4000, t_of(6)), rel=1e-6)
    if scatter == 0.02:
        assert reach[:, 0].max() < 2.0


def test_freedom_of_a_sum_is_that_of_satterthwaite():
    """Numbers of one value, each sure to 1, the first by 4 samples: (1 + 1)^2/(1^2/4). Known together: of all samples."""
    jacobian, first, second = np.ones((2, 1)), slice(0, 1), slice(1, 2)
    apart = [ResidualBlock(first, np.ones(1), 0, quiet=4.0), ResidualBlock(second, np.ones(1), 0)]
    pooled = [ResidualBlock(rows, np.ones(1), 0, quiet=4.0, pooled=True) for rows in (first, second)]
    for blocks, freedom in ((apart, 16.0), (pooled, 8.0)):
        found = by_noise(jacobian, np.eye(1), blocks)
        assert found.covariance == pytest.approx(np.array([[0.5]]))
        assert found.freedom == pytest.approx(np.array([freedom]))


def t_of(freedom):
    return t.ppf(0.975, freedom)


@pytest.mark.verify
def test_a_pattern_that_repeats_does_not_average_out():
    """What the model cannot follow is the same in each record: the errors of five are those of one, to 10 %.

    120 fits, of which 95 % less 2.5 standard deviations of chance hold at least 90 %.
    """
    _, single, _ = coverage(1, fits=120, pattern=0.05)
    inside, errors, _ = coverage(5, fits=120, pattern=0.05)
    assert inside >= 0.90
    assert errors == pytest.approx(single, rel=0.1)


@pytest.mark.verify
def test_patterns_of_their_own_average_out_as_noise_does():
    """Of five records whose patterns have nothing in common: errors shrink, and not below those that are made."""
    _, single, _ = coverage(1, fits=120, pattern=0.05)
    inside, errors, made = coverage(5, fits=120, pattern=0.05, repeats=False)
    assert inside >= 0.90
    assert (errors < 0.6 * single).all()
    assert (errors > 0.9 * made).all()


@pytest.mark.verify
@pytest.mark.parametrize("count", [1, 5])
def test_intervals_of_shots_that_do_not_scatter_hold_the_truth(count):
    """Noise alone: 95 of 100 hold of one record; of five a few more, for the wider of two intervals is taken."""
    inside, errors, _ = coverage(count)
    assert 0.92 <= inside <= 0.995
    noise = NOISE * np.sqrt(np.diag(np.linalg.inv(SLOPES.T @ SLOPES)) / count)
    assert (errors >= noise * (1.0 - 1e-9)).all()
    assert errors == pytest.approx(noise, rel=0.4)


def test_the_scatter_of_equal_shots_is_that_of_their_mean():
    """A mean of n numbers: the variance s^2/n, with n - 1 degrees of freedom."""
    values = np.array([3.0, 5.0, 4.0, 8.0])
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(4)]
    found = scatter_of_shots(np.mean(values) - values, np.ones((4, 1)), np.eye(1), blocks)
    assert found.covariance == pytest.approx(np.var(values, ddof=1) / 4.0, rel=1e-12)
    assert found.freedom == pytest.approx([3.0], rel=1e-9)


def test_shots_of_a_number_each_have_the_covariance_hc2():
    """MacKinnon & White 1985: A^-1 sum(x x' r^2/(1 - h)) A^-1, with h the leverage of each; unequal shots."""
    rng = np.random.default_rng(8)
    design, blocks = rng.standard_normal((7, 2)), [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(7)]
    measured = rng.standard_normal(7)
    inverse = np.linalg.inv(design.T @ design)
    residuals = design @ (inverse @ design.T @ measured) - measured
    leverage = np.einsum("ij,jk,ik->i", design, inverse, design)
    wanted = inverse @ (design.T * residuals**2 / (1.0 - leverage)) @ design @ inverse
    found = scatter_of_shots(residuals, design, np.eye(2), blocks)
    assert found.covariance == pytest.approx(wanted, rel=1e-9)
    assert ((found.freedom > 1.0) & (found.freedom < 5.0)).all()  # at most n - p


def test_a_direction_that_one_shot_alone_informs_has_no_scatter():
    """The second value is felt by the last shot only: what is known of it is its noise."""
    design = 100.0 * np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(3)]
    residuals = np.array([1.0, -1.0, 0.0])
    found = scatter_of_shots(residuals, design, np.eye(2), blocks)
    assert found.covariance[0, 0] == pytest.approx(1e-4, rel=1e-9)  # of the two others: s^2/2
    whole = estimate(np.zeros(2), residuals, design, blocks)
    assert whole.covariance[1, 1] >= np.linalg.inv(design.T @ design)[1, 1] * (1.0 - 1e-9)


def test_what_is_known_from_elsewhere_is_no_shot():
    """A mean of four shots, which scatter by s, and a value known to u from elsewhere: s^2/4 and u^2 by their weights."""
    values, sure = np.array([3.0, 5.0, 4.0, 8.0]), 0.5
    design = np.append(np.ones(4), 1.0 / sure)[:, None]
    place = (np.sum(values) + 6.0 / sure**2) / (4.0 + 1.0 / sure**2)
    residuals = design[:, 0] * (place - np.append(values, 6.0))
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k if k < 4 else None) for k in range(5)]
    found = scatter_of_shots(residuals, design, np.eye(1), blocks)
    push = np.sum((residuals[:4]) ** 2 / (1.0 - 1.0 / 8.0))  # each has an eighth of the information
    assert found.covariance == pytest.approx((push + 1.0 / sure**2) / 8.0**2, rel=1e-12)


SQUARES = arrays(float, (3, 3), elements=st.floats(-3.0, 3.0))


@given(SQUARES, SQUARES)
def test_the_larger_of_two_covariances_is_above_both(one, other):
    one, other = one @ one.T + 0.1 * np.eye(3), other @ other.T
    above = larger(one, other)
    scale = np.linalg.norm(one) + np.linalg.norm(other)
    for lower in (one, other):
        assert np.linalg.eigvalsh(above - lower)[0] >= -1e-9 * scale
    assert np.trace(above) <= np.trace(one) + np.trace(other) + 1e-9 * scale  # and no larger than their sum


def test_the_design_effect_is_of_what_two_records_have_in_common():
    """Of equal patterns n, of independent ones 1; of patterns half of whose power is common, 1 + (n - 1)/2."""
    rng = np.random.default_rng(4)
    common, own = rng.standard_normal(20000), rng.standard_normal((5, 20000))
    assert design_effect([*own]) == pytest.approx(1.0, abs=0.05)
    assert design_effect([common + one for one in own]) == pytest.approx(3.0, abs=0.1)
    assert design_effect([common[:500], common[:500]]) == pytest.approx(2.0)
