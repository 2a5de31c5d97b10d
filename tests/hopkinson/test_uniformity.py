"""Equilibrium of an elastic specimen: the closed form, the sum of echoes, and delay lines, which know neither."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from strikewave.hopkinson import face_forces, stress_difference, transits_to_uniform
from strikewave.waves import BONDED, End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

BETAS = (0.05, 0.2, 0.5, 0.9, 1.0, 1.7, 4.0)


def delay_line_faces(beta, shape, rise=0.0, transits=12):
    """Return times over t0 and the forces on both faces of a specimen between two bars, by delay lines."""
    per, step = 20, 1e-8
    bar = Layer("bar", 1.0, 1.0, 1.0, 10 * step)
    specimen = Layer("specimen", 1.0, 1.0, beta, per * step)
    after = Layer("after", 1.0, 1.0, 1.0, 10 * step)
    long = Layer("before", 1.0, 1.0, 1.0, (transits + 4) * per * step)
    stack = Stack((long, bar, specimen, after), (BONDED,) * 3, End("matched"))
    load = LoadPulse(shape, 1.0, 1.0, rise) if shape == "trapezoid" else LoadPulse(shape, 1.0, 1.0)
    begin = (transits + 4) * per + 10
    run = run_bar(stack, load, [Tap(2, 0.0), Tap(2, 1.0)], (begin + transits * per + 2) * step, WantedError(step=step))
    time = (np.arange(run.time.size) - begin) / per
    keep = (time > 0.0) & (time < transits)
    return time[keep], run.force[keep, 0], run.force[keep, 1]


@pytest.mark.parametrize("beta", BETAS)
def test_alpha_of_a_step_against_delay_lines(beta):
    """alpha_k in the middle of each transit; 1e-12: the delay lines add and multiply, nothing else."""
    time, first, second = delay_line_faces(beta, "rectangle")
    middle = np.isclose(time % 1.0, 0.5)
    alpha = np.abs(2.0 * (first - second) / (first + second))[middle]
    assert alpha == pytest.approx(stress_difference(beta, np.arange(1, alpha.size + 1)), abs=1e-12)


@pytest.mark.parametrize("beta", BETAS)
@pytest.mark.parametrize("rise", [0.7, 2.0, 5.0])
def test_forces_under_a_straight_rise_against_delay_lines(beta, rise):
    """The sum of echoes is the exact solution: 1e-12."""
    time, first, second = delay_line_faces(beta, "trapezoid", rise * 20e-8)
    faces = face_forces(beta, time, rise)
    assert faces.first == pytest.approx(first, abs=1e-12)
    assert faces.second == pytest.approx(second, abs=1e-12)


@given(st.floats(1e-3, 1e3), st.integers(1, 200))
@example(1.005, 2)
def test_closed_form_in_its_printed_shape(beta, k):
    """2 beta (1-beta)^(k-1)/[(1+beta)^k - (1-beta)^(k-1)] in whole numbers of a fraction, which cannot cancel."""
    from fractions import Fraction

    b = Fraction(beta)
    exact = 2 * b * (1 - b) ** (k - 1) / ((1 + b) ** k - (1 - b) ** (k - 1))
    assert float(stress_difference(beta, k)) == pytest.approx(abs(float(exact)), rel=1e-10, abs=1e-290)


def test_first_transit_is_2_and_equal_impedances_are_done_after_one():
    assert stress_difference(BETAS, 1) == pytest.approx([2.0] * len(BETAS), rel=1e-14)
    assert float(stress_difference(1.0, 2)) < 1e-299
    assert transits_to_uniform(1.0) == 1.0


@pytest.mark.parametrize("beta", [0.05, 0.2, 0.5, 0.9, 4.0])
def test_transits_to_uniform_of_a_step_is_where_the_closed_form_falls_below(beta):
    k = np.arange(1, 200)
    first = int(k[stress_difference(beta, k) < 0.05][0])
    assert transits_to_uniform(beta) == first - 1.0


def test_a_slow_rise_makes_the_difference_small_but_keeps_it_longer():
    """Under a rise of 20 transits forces differ by about t0/t while it lasts: less than a step at first, then 5 % at 20.

    F1 leads F2 by one transit: alpha is about 1/(t - 1/2) in the rise of a matched specimen.
    """
    alpha = face_forces(1.0, [4.5, 10.5], 20.0).alpha
    assert alpha == pytest.approx([1.0 / 4.0, 1.0 / 10.0], rel=1e-12)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_an_impedance_ratio_that_cannot_be_is_refused(bad):
    for call in (lambda: stress_difference(bad, 1), lambda: face_forces(bad, [1.0]), lambda: transits_to_uniform(bad)):
        with pytest.raises(ValueError, match="beta"):
            call()


@pytest.mark.parametrize(("beta", "rise"), [(0.25, 2.0), (0.1, 2.0), (2.0, 5.0)])
def test_transits_to_uniform_to_a_two_hundredth(beta, rise):
    """The last time above 5 % on a grid of 1/1250; all is over after 30 transits."""
    time = np.arange(0.0, 30.0, 8e-4) + 4e-4
    late = time[np.flatnonzero(~(np.abs(face_forces(beta, time, rise).alpha) < 0.05))[-1]]
    assert transits_to_uniform(beta, rise) == pytest.approx(late, abs=0.006)


@pytest.mark.parametrize("beta", [0.3, 0.4, 0.5, 1.0, 2.0])
def test_under_a_long_rise_5_percent_comes_after_20_beta_and_half_its_inverse(beta):
    """F1 - F2 stays at 2 beta t0/rise of the plateau while the mean force grows as 2 (t - 1/(2 beta)) t0/rise.

    Their ratio is 5 % at t = 20 beta + 1/(2 beta), whatever the rise. 0.2: the echoes that are left swing about it.
    """
    expected = 20.0 * beta + 0.5 / beta
    assert [transits_to_uniform(beta, rise) for rise in (50.0, 200.0)] == pytest.approx([expected] * 2, abs=0.2)


def test_edges_of_what_uniformity_takes():
    assert transits_to_uniform(0.5, limit=1.999) == 1.0
    assert transits_to_uniform(0.5, limit=0.01) == 4.0  # 0.0253, 0.0083
    for limit in (0.0, 2.0, -0.1):
        with pytest.raises(ValueError, match="the limit lies between 0 and 2"):
            transits_to_uniform(0.5, limit=limit)
    for beta, transit in ((0.5, 0.999), (0.5, math.nan), ([0.5, 0.0], 1), ([0.5, math.inf], 1), (0.5, [1, 0])):
        with pytest.raises(ValueError, match="the transit at least 1"):
            stress_difference(beta, transit)
    for rise in (-1e-3, math.inf, math.nan):
        with pytest.raises(ValueError, match="the rise zero or above"):
            face_forces(0.5, [1.0], rise)
    with pytest.raises(ValueError, match="at most 100000 transits"):
        face_forces(0.5, [0.0, 100_001.0])
    # forces of a thousandth of the incident one have an alpha too
    small = face_forces(1e-3, [0.5, 1.5, 2.5])
    assert small.first[0] < 0.003
    assert small.alpha == pytest.approx([1, -1, 1] * stress_difference(1e-3, [1, 2, 3]), rel=1e-9)
    assert face_forces(1.0, [100_000.0]).second == pytest.approx([1.0], rel=1e-14)
    assert face_forces(0.5, []).first.size == 0


def test_forces_of_a_step_at_the_begin_of_each_transit_worked_by_hand():
    """beta = 1/2: T = 2/3, r = 1/3; F1 = 2/3, 2/3 + 2/9 ..., just after each arrival; nothing before."""
    faces = face_forces(0.5, [-0.5, 0.0, 1.0, 2.0, 3.0])
    # P = 2/3 up to 2, then 2/3 (1 + 1/9); F1 = P(t) + P(t - 2)/3, F2 = 4/3 P(t - 1)
    assert faces.first == pytest.approx([0.0, 2 / 3, 2 / 3, 20 / 27 + 2 / 9, 20 / 27 + 2 / 9], rel=1e-14)
    assert faces.second == pytest.approx([0.0, 0.0, 8 / 9, 8 / 9, 80 / 81], rel=1e-14)
    assert math.isnan(faces.alpha[0])
    assert faces.alpha[1:3] == pytest.approx([2.0, -2 / 7], rel=1e-13)
    # half way up a rise of two transits
    rising = face_forces(0.5, [1.0, 2.0, 9.0], 2.0)
    assert rising.first[:2] == pytest.approx([1 / 3, 2 / 3], rel=1e-14)
    assert rising.second[:2] == pytest.approx([0.0, 4 / 9], rel=1e-14)


def test_a_specimen_much_softer_than_the_bar_is_uniform_after_thousands_of_transits():
    """beta = 1e-3, r = 0.998: on a grid of one transit, where the closed form falls below 5 %."""
    k = np.arange(1, 4000)
    expected = k[stress_difference(1e-3, k) < 0.05][0] - 1
    assert transits_to_uniform(1e-3) == expected
