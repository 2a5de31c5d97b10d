"""How far residuals fix a place: against closed forms, and against pulses whose values, scatter and patterns are planted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from scipy.stats import t

from strikewave.studies.fit.covariance import (
    NONE,
    Estimate,
    ResidualBlock,
    autocorrelation,
    by_noise,
    by_what_is_left,
    design_effect,
    estimate,
    independent_count,
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

    Student's t of six for all of it, 2.45, held 98.6 % of 4000. Of 1500, 95 % have a standard deviation of 0.56 points;
    that of the width, which noise alone moves, is as wide as t has it.
    """
    rng = np.random.default_rng(6)
    found = [one_shot(rng, 6, scatter) for _ in range(1500)]
    inside = np.mean([np.abs(one.place) < one.reach * one.errors for one in found], axis=0)
    assert inside == pytest.approx([0.95, 0.95], abs=0.017)
    reach = np.array([one.reach for one in found])
    assert reach[:, 1] == pytest.approx(np.full(1500, t_of(6)), rel=1e-6)
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
    assert found.freedom[1] == pytest.approx(1.0)
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


DESIGN = np.array([[1.0, 0.2], [0.3, 1.0], [-0.5, 0.8], [1.2, -0.4], [0.1, 0.9], [0.7, 0.7]])
INVERSE = np.linalg.inv(DESIGN.T @ DESIGN)


def test_the_covariance_of_coloured_noise_and_of_what_is_shared_is_that_of_generalised_errors():
    """A^-1 J' C J A^-1 with the whole covariance C of the residuals written out, two records apart from one another."""
    colour, baseline, scatter = np.array([2.0, 0.7, 0.3]), np.full((3, 1), 0.4), np.array([[0.5], [1.0], [0.2]])
    blocks = [
        ResidualBlock(slice(0, 3), colour, 0, shared=baseline, quiet=9.0),
        ResidualBlock(slice(3, 6), np.array([1.5]), 1, stated=scatter, quiet=5.0),
    ]
    whole = np.zeros((6, 6))
    whole[:3, :3] = [[2.0, 0.7, 0.3], [0.7, 2.0, 0.7], [0.3, 0.7, 2.0]]
    whole[:3, :3] += 0.16
    whole[3:, 3:] = 1.5 * np.eye(3)
    first = INVERSE @ DESIGN[:3].T @ whole[:3, :3] @ DESIGN[:3] @ INVERSE
    second = INVERSE @ DESIGN[3:].T @ whole[3:, 3:] @ DESIGN[3:] @ INVERSE
    found = by_noise(DESIGN, np.eye(2), blocks)
    assert found.covariance == pytest.approx(first + second, rel=1e-12)
    spent = np.diag(first) ** 2 / 9.0 + np.diag(second) ** 2 / 5.0
    assert found.freedom == pytest.approx(np.diag(first + second) ** 2 / spent, rel=1e-12)
    amplitude = INVERSE @ DESIGN[3:].T @ scatter @ scatter.T @ DESIGN[3:] @ INVERSE
    one = [block._replace(shot=0) for block in blocks]  # of one shot no scatter counts
    whole_estimate = estimate(np.full(2, 0.5), np.zeros(6), 100.0 * DESIGN, one)
    wanted = (first + second) / 1e4 + amplitude / 1e4
    assert whole_estimate.covariance == pytest.approx(wanted, rel=1e-9)
    assert whole_estimate.stated is None
    moved = np.array([[0.01, 0.003], [0.02, -0.004]])
    refitted = estimate(np.full(2, 0.5), np.zeros(6), 100.0 * DESIGN, one, moved)
    assert refitted.covariance == pytest.approx((first + second) / 1e4 + moved @ moved.T, rel=1e-9)
    assert refitted.stated == pytest.approx(np.diag(moved @ moved.T), rel=1e-9)
    mostly = np.diag(moved @ moved.T) > np.diag(first + second) / 1e4
    assert [refitted.mostly_stated(k) for k in range(2)] == list(mostly)
    assert not whole_estimate.mostly_stated(0)


def test_a_variance_that_is_half_stated_is_not_mostly_stated():
    covariance = np.diag([1.0, 1.0])
    found = Estimate(np.zeros(2), np.zeros(2), np.eye(2), covariance, np.zeros((2, 0)), np.ones(2), [0.499, 0.501])
    assert [found.mostly_stated(k) for k in range(2)] == [False, True]


def test_what_is_left_beyond_noise_counts_by_its_own_colour_and_raised_by_the_values_that_were_fitted():
    """White remainders of two records that have nothing in common, one value: sigma^2/(J'J) n/(n - 1), with n - 1 degrees."""
    rng = np.random.default_rng(3)
    first = rng.standard_normal(9)
    second = rng.standard_normal(9)
    first, second = first - first.mean(), second - second.mean()  # of fewer than ten samples no colour is known
    second -= first * (first @ second) / (first @ first)
    jacobian = np.full((18, 1), 50.0)
    blocks = [ResidualBlock(slice(9 * k, 9 * k + 9), np.ones(1), 0, one) for k, one in enumerate((first, second))]
    found = by_what_is_left(jacobian, np.eye(1), blocks)
    squares = (first @ first + second @ second) / 18.0
    assert found.covariance[0, 0] == pytest.approx(squares / (18.0 * 2500.0) * 18.0 / 17.0, rel=1e-12)
    assert found.freedom == pytest.approx([17.0], rel=1e-9)
    alike = [block._replace(left=first) for block in blocks]  # the same in both: as if there were one
    found = by_what_is_left(jacobian, np.eye(1), alike)
    assert found.covariance[0, 0] == pytest.approx(first @ first / 9.0 / (9.0 * 2500.0) * 9.0 / 8.0, rel=1e-12)
    assert found.freedom == pytest.approx([8.0], rel=1e-9)
    mixed = [blocks[0], blocks[1]._replace(left=None, quiet=7.0)]  # the other by its noise
    found = by_what_is_left(jacobian, np.eye(1), mixed)
    of_first = first @ first / 9.0 * 9.0 * 2500.0 * 9.0 / 8.0
    of_noise = 9.0 * 2500.0
    assert found.covariance[0, 0] == pytest.approx((of_first + of_noise) / (18.0 * 2500.0) ** 2, rel=1e-12)
    wanted = (of_first + of_noise) ** 2 / (of_first**2 / 8.0 + of_noise**2 / 7.0)
    assert found.freedom == pytest.approx([wanted], rel=1e-9)


def test_the_design_effect_of_records_of_other_lengths_is_of_their_shapes():
    """A straight line of 7 and of 31 samples is the same; one turned round has nothing in common, and no less."""
    line = np.linspace(1.0, 2.0, 31)
    assert design_effect([line[::5], line]) == pytest.approx(2.0, rel=1e-12)
    assert design_effect([line]) == design_effect([]) == 1.0
    assert design_effect([line, -line]) == 1.0
    wave = np.sin(2.0 * np.pi * np.arange(40) / 40.0)
    other = np.cos(2.0 * np.pi * np.arange(40) / 40.0)
    assert design_effect([wave, 0.6 * wave + 0.8 * other]) == pytest.approx(1.6, rel=1e-12)
    assert design_effect([wave, wave, other]) == pytest.approx(5.0 / 3.0, rel=1e-12)


def test_the_freedom_of_unequal_shots_is_that_of_bell_and_mccaffrey():
    """A value felt by three shots with 1, 1 and 4 of the information: (sum v)^2/sum v^2 of the eigenvalues v of their form.

    With the residuals of white noise, e = (I - H) z, the estimate is z'B'Bz: its eigenvalues are written out here.
    """
    slopes = np.array([1.0, 1.0, 2.0])
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(3)]
    share = slopes**2 / 6.0
    maker = np.eye(3) - np.outer(slopes, slopes) / 6.0
    form = np.diag(slopes / np.sqrt(1.0 - share)) @ maker
    values = np.linalg.eigvalsh(form @ form.T)
    found = scatter_of_shots(np.array([1.0, -1.0, 0.0]), slopes[:, None], np.eye(1), blocks)
    assert found.freedom == pytest.approx([values.sum() ** 2 / np.sum(values**2)], rel=1e-9)
    assert found.covariance[0, 0] == pytest.approx((2.0 / (1.0 - 1.0 / 6.0)) / 36.0, rel=1e-12)


def test_directions_are_lost_from_an_eighth_of_the_bounds_on():
    """Errors of 0.12 and 0.13 of the bounds, of independent numbers: the second is not determined."""
    sizes = np.array([0.12, 0.13, 0.01])
    blocks = [ResidualBlock(slice(0, 3), np.ones(1), 0)]
    found = estimate(np.full(3, 0.5), np.zeros(3), np.diag(1.0 / sizes), blocks)
    assert found.groups() == [[1]]
    assert found.errors == pytest.approx([0.12, np.inf, 0.01], rel=1e-9)
    assert np.abs(found.undetermined[:, 0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert found.reach == pytest.approx(np.full(3, 1.96))
    assert found.widest == 1.96


def test_groups_are_of_coordinates_that_share_a_lost_direction():
    """Two directions that are lost, of two coordinates each, and one that takes part by less than a twentieth."""
    lost = np.zeros((6, 2))
    lost[[0, 3], 0] = np.sqrt(0.5)
    lost[[1, 4], 1] = 0.6, -0.8
    found = Estimate(np.zeros(6), np.zeros(1), np.zeros((1, 6)), np.eye(6), lost, np.arange(1.0, 7.0))
    assert found.groups() == [[0, 3], [1, 4]]
    assert found.widest == 6.0  # the largest of those that are determined, 2 and 5 here
    for share, groups in ((0.049, [[0]]), (0.06, [[0, 1]])):
        lost = np.sqrt([[1.0 - share], [share]])
        one = Estimate(np.zeros(2), np.zeros(1), np.zeros((1, 2)), np.eye(2), lost, np.ones(2))
        assert one.groups() == groups
    assert (
        Estimate(np.zeros(1), np.zeros(1), np.zeros((1, 1)), np.eye(1), np.ones((1, 1)), np.full(1, 9.0)).widest == 1.96
    )


def test_intervals_are_the_widest_of_noise_and_of_shots():
    """Two shots that are off by u each way have a mean sure to u by one degree, 12.7 standard errors; noise to sqrt(1/2)."""
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(2)]
    jacobian = np.full((2, 1), 100.0)
    for off, variance, reach in ((1.0, 1.0, t_of(1.0)), (0.5, 0.5, t_of(1.0) * np.sqrt(0.5)), (0.01, 0.5, 1.96)):
        found = estimate(np.array([0.5]), np.array([off, -off]), jacobian, blocks)
        assert found.covariance[0, 0] == pytest.approx(variance / 1e4, rel=1e-9)
        assert found.reach[0] == pytest.approx(reach, rel=1e-9)
        assert found.misfit == pytest.approx(2.0 * off**2)


@pytest.mark.parametrize(("share", "lost"), [(1.1e-8, False), (0.9e-8, True)])
def test_a_direction_has_information_from_a_hundred_millionth_of_the_largest_on(share, lost):
    sizes = np.array([1e6, 1e6 * np.sqrt(share)])
    found = estimate(np.full(2, 0.5), np.zeros(2), np.diag(sizes), [ResidualBlock(slice(0, 2), np.ones(1), 0)])
    assert found.groups() == ([[1]] if lost else [])


def test_a_coordinate_belongs_to_a_group_from_a_twentieth_of_what_another_takes_part_on():
    """Of the first a half is lost, of the second 0.075, and 0.05 of both together: a tenth of that half."""
    first = np.array([np.sqrt(0.5), 0.0707, 0.0, 0.0])
    first[2] = np.sqrt(1.0 - first @ first)
    second = np.array([0.0, np.sqrt(0.07), 0.0, 0.0])
    second[2] = -first[1] * second[1] / first[2]
    second[3] = np.sqrt(1.0 - second @ second)
    lost = np.column_stack([first, second])
    found = Estimate(np.zeros(4), np.zeros(1), np.zeros((1, 4)), np.eye(4), lost, np.ones(4))
    assert found.groups() == [[0, 1, 2, 3]]


def test_what_is_left_of_one_record_alone_widens_the_errors():
    """Two records of a value; of the second ten times its noise is left, white and of nine samples."""
    left = np.array([10.0, -10.0, 10.0, -10.0, 0.0, 10.0, -10.0, 10.0, -10.0])
    jacobian = np.full((18, 1), 50.0)
    blocks = [ResidualBlock(slice(0, 9), np.ones(1), 0), ResidualBlock(slice(9, 18), np.ones(1), 0, left)]
    found = estimate(np.array([0.5]), np.zeros(18), jacobian, blocks)
    pushed = 9.0 * 2500.0 * (1.0 + left @ left / 9.0 * 9.0 / 8.0)
    assert found.covariance[0, 0] == pytest.approx(pushed / (18.0 * 2500.0) ** 2, rel=1e-9)


def test_a_colour_of_two_lags_is_followed():
    noise = np.array([2.0, 0.7])
    whole = toeplitz([2.0, 0.7, 0.0, 0.0, 0.0, 0.0])
    found = by_noise(DESIGN, np.eye(2), [ResidualBlock(slice(0, 6), noise, 0)])
    assert found.covariance == pytest.approx(INVERSE @ DESIGN.T @ whole @ DESIGN @ INVERSE, rel=1e-12)


def test_what_is_left_has_its_own_colour():
    """40 samples of an autoregression, on their own: variance times autocorrelation, raised by one value of so many."""
    rng = np.random.default_rng(5)
    left = lfilter([1.0], [1.0, -0.7], 3.0 * rng.standard_normal(40))
    slopes = pulse(20.0, 0.3)[30:70][:, None]
    colour = autocorrelation(left)
    count = independent_count(40, colour)
    assert colour.size > 3
    lags = np.append(colour, np.zeros(40))[:40]
    middle = np.mean(left**2) * slopes.T @ toeplitz(lags) @ slopes
    found = by_what_is_left(slopes, np.eye(1), [ResidualBlock(slice(0, 40), np.ones(1), 0, left)])
    wanted = middle / np.sum(slopes**2) ** 2 * count / (count - 1.0)
    assert found.covariance == pytest.approx(wanted, rel=1e-9)
    assert found.freedom == pytest.approx([count - 1.0], rel=1e-9)


def test_of_few_samples_one_degree_is_left():
    """Two samples and two values: nothing would be left to tell what is."""
    jacobian, left = 50.0 * np.array([[1.0, 0.2], [0.3, 1.0]]), np.array([3.0, -1.0])
    found = by_what_is_left(jacobian, np.eye(2), [ResidualBlock(slice(0, 2), np.ones(1), 0, left)])
    assert found.freedom == pytest.approx([1.0, 1.0])
    assert found.covariance == pytest.approx(5.0 * 2.0 * np.linalg.inv(jacobian.T @ jacobian), rel=1e-9)


def test_records_are_held_against_one_another_on_the_samples_of_the_shortest():
    """A spike of three samples and one of five: on three they are the same."""
    assert design_effect([np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 0.0, 0.0])]) == pytest.approx(2.0)


def test_values_that_other_shots_tell_have_the_freedom_of_these():
    """Two means, of three shots and of five others: two degrees and four."""
    design = np.zeros((8, 2))
    design[:3, 0] = design[3:, 1] = 1.0
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(8)]
    residuals = np.array([1.0, -1.0, 0.0, 2.0, -2.0, 1.0, -1.0, 0.0])
    found = scatter_of_shots(residuals, design, np.eye(2), blocks)
    assert found.freedom == pytest.approx([2.0, 4.0], rel=1e-9)
    assert np.diag(found.covariance) == pytest.approx([2.0 / 2.0 / 3.0, 10.0 / 4.0 / 5.0], rel=1e-9)


def test_a_shot_that_alone_tells_a_value_pushes_nothing():
    design = 100.0 * np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    blocks = [ResidualBlock(slice(k, k + 1), np.ones(1), k) for k in range(3)]
    found = [
        scatter_of_shots(np.array([1.0, -1.0, last]), design, np.eye(2), blocks).covariance for last in (0.0, 500.0)
    ]
    assert found[0] == pytest.approx(found[1], abs=1e-12)


@pytest.mark.parametrize(
    ("one", "other", "above"),
    [
        ((4.0, 4e-17), (1.0, 9.0), (4.0, 0.0)),  # a direction that is known to nothing, by rounding
        ((4e6, 1e-11), (1.0, 9.0), (4e6, 0.0)),
        ((4.0, 4e-10), (1.0, 8e-10), (4.0, 8e-10)),
        ((4.0, 4e-10), (9.0, 1e-10), (9.0, 4e-10)),
        ((4e-9, 4e-9), (1e-9, 9e-9), (4e-9, 9e-9)),
    ],
)
def test_a_covariance_above_two_keeps_the_directions_of_the_first(one, other, above):
    assert np.diag(larger(np.diag(one), np.diag(other))) == pytest.approx(above, rel=1e-6, abs=1e-30)
