"""Balances and analyses of constant waves in closed form, the stretch in which forces agree, the slope of the rise."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from strikewave.hopkinson import (
    Bar,
    FaceWaves,
    Specimen,
    StressStrainCurve,
    energy,
    equilibrium,
    face_forces,
    momentum,
    reduce,
    rise_slope,
    stress_difference,
    transits_to_uniform,
)
from strikewave.hopkinson.bars import StrikerBar
from strikewave.hopkinson.checks import rise_slopes, striker_check
from strikewave.waves import BONDED, End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

BAR, OTHER = Bar(7800.0, 210e9, 0.02, 1.0), Bar(2700.0, 70e9, 0.03, 1.0)


def still(time, incident, reflected, transmitted):
    """Return waves as they are at the specimen, the loading being the first 80 us, without noise."""
    none = (0.0, 0.0)
    return FaceWaves(
        time, incident, reflected, transmitted, 1e-7, 80e-6, "none", "geometric", 1e6, 1e-7, none, none, none, none
    )


def constant(incident, reflected, transmitted, specimen):
    """Return a reduction of three constant waves that last 100 us, the loading being its first 80 us."""
    time = 1e-7 * np.arange(1001)
    one = np.ones(1001)
    waves = still(time, incident * one, reflected * one, transmitted * one)
    return reduce(waves, (BAR, OTHER), specimen)


def test_momentum_and_energy_of_constant_waves_are_products():
    """Impulses F t, work F v t: every integral of a constant is exact, 1e-12 for rounding of 800 sums."""
    specimen = Specimen(5e-3, 1e-4, 8000.0)
    r = constant(1e-3, -0.4e-3, 0.3e-3, specimen)
    f1, f2 = BAR.stiffness * 0.6e-3, OTHER.stiffness * 0.3e-3
    v1, v2 = BAR.speed * 1.4e-3, OTHER.speed * 0.3e-3
    m, t = momentum(r), 80e-6
    assert m.specimen == pytest.approx(8000.0 * 1e-4 * 5e-3 * 0.5 * (v1 + v2), rel=1e-12)
    closure = ((f1 - f2) * t - m.specimen) / (BAR.stiffness * 1e-3 * t)
    assert m.closure == pytest.approx(closure, rel=1e-9)
    work = energy(r)
    assert work.incident == pytest.approx(BAR.impedance * (BAR.speed * 1e-3) ** 2 * t, rel=1e-12)
    assert work.transmitted == pytest.approx(f2 * v2 * t, rel=1e-12)
    assert work.deformation == pytest.approx(0.5 * (f1 + f2) * (v1 - v2) * t, rel=1e-9)
    assert work.acceleration == pytest.approx(0.5 * (f1 - f2) * (v1 + v2) * t, rel=1e-9)
    alike = equilibrium(r)
    assert alike.misfit == pytest.approx(2.0 * abs(f1 - f2) / (f1 + f2), rel=1e-12)
    assert alike.force_ratio == pytest.approx(f1 / f2, rel=1e-12)


@pytest.mark.parametrize(("name", "force"), [("1-wave", 1), ("2-wave", 0), ("3-wave", None)])
def test_each_analysis_between_unequal_bars(name, force):
    """Stress and rate of constant waves by the formulas of the docs, for bars of different speed and stiffness."""
    specimen = Specimen(5e-3, 1e-4)
    r = constant(1e-3, -0.4e-3, 0.3e-3, specimen)
    forces = (BAR.stiffness * 0.6e-3, OTHER.stiffness * 0.3e-3)
    shown = 0.5 * sum(forces) if force is None else forces[force]
    beyond = OTHER.speed * (0.3e-3 if name == "3-wave" else forces[0] / OTHER.stiffness)
    curve = r.curve(name)
    assert curve.stress == pytest.approx(shown / 1e-4, rel=1e-12)
    assert curve.rate == pytest.approx((BAR.speed * 1.4e-3 - beyond) / 5e-3, rel=1e-12)


def test_forces_that_come_together_agree_from_where_they_do():
    """F1 - F2 falls straight to 0 in 40 us: R = d/(1 + d/2) of d = 0.2 (1 - t/40 us) is 5 % at 29.74 us."""
    time = 1e-7 * np.arange(801)
    apart = 0.2 * np.clip(1.0 - time / 40e-6, 0.0, None)
    one = 1e-3 * np.ones(801)
    waves = still(time, one * (1.0 + apart), 0.0 * one, one)
    alike = equilibrium(reduce(waves, (BAR, BAR), Specimen(5e-3, 1e-4)))
    d = 0.05 / (1.0 - 0.025)
    assert alike.begin == pytest.approx(40e-6 * (1.0 - d / 0.2), abs=1.01e-7)


def test_the_slope_is_that_from_10_to_50_percent_of_the_largest_stress():
    """A curve that is steep below 10 %, 200 GPa up to 60 % and soft above: 200 GPa, to rounding."""
    strain = np.concatenate([np.linspace(0.0, 5e-6, 20), 5e-6 + np.linspace(0.0, 3e-3, 400)[1:]])
    stress = np.interp(strain, [0.0, 5e-6, 5e-6 + 5.5e-4 * 5 / 5, 3.1e-3], [0.0, 2e7, 2e7 + 1.1e8, 2.2e8])
    slope = rise_slope(StressStrainCurve(strain, strain, stress, strain), np.ones(strain.size, dtype=bool))
    assert slope == pytest.approx(1.1e8 / 5.5e-4, rel=1e-9)


def test_the_running_integral_of_a_straight_line_is_exact():
    """The trapezoidal rule integrates t to t^2/2; 0 before the arrival."""
    r = constant(1e-3, -0.4e-3, 0.3e-3, Specimen(5e-3, 1e-4))
    assert r.integral(r.time) == pytest.approx(0.5 * r.time**2, rel=1e-12)


def test_two_short_agreements_are_no_equilibrium_but_count_in_the_share():
    """Forces that agree for 2 us twice, with a rise of 1 us: no stretch of 3 rise times, 4 us in all of 80 us."""
    time = 1e-7 * np.arange(801)
    one = 1e-3 * np.ones(801)
    alike = ((time > 20e-6) & (time < 22e-6)) | ((time > 50e-6) & (time < 52e-6))
    waves = dataclasses.replace(still(time, one * np.where(alike, 1.0, 1.3), 0.0 * one, one), window=1e-6)
    found = equilibrium(reduce(waves, (BAR, BAR), Specimen(5e-3, 1e-4)))
    assert math.isnan(found.begin)
    assert math.isnan(found.end)
    assert found.share == pytest.approx(2 * (2e-6 - 1e-6) / 80e-6, rel=0.25)  # smoothing takes half a rise on each side


def test_agreement_ends_where_the_forces_part():
    """Equal from 20 to 60 us: begin and end to half a rise time, by which smoothing spreads what differs."""
    time = 1e-7 * np.arange(801)
    one = 1e-3 * np.ones(801)
    apart = np.where((time > 20e-6) & (time < 60e-6), 1.0, 1.3)
    waves = dataclasses.replace(still(time, one * apart, 0.0 * one, one), window=2e-6)
    found = equilibrium(reduce(waves, (BAR, BAR), Specimen(5e-3, 1e-4)))
    assert (found.begin, found.end) == pytest.approx((20e-6, 60e-6), abs=1e-6)
    assert found.share == pytest.approx((found.end - found.begin) / 80e-6, rel=0.01)


def test_every_impulse_and_energy_of_constant_waves():
    r = constant(1e-3, -0.4e-3, 0.3e-3, Specimen(5e-3, 1e-4))
    t = 80e-6
    m, e = momentum(r), energy(r)
    came, back, on = BAR.stiffness * 1e-3 * t, BAR.stiffness * -0.4e-3 * t, OTHER.stiffness * 0.3e-3 * t
    assert dataclasses.astuple(m)[:5] == pytest.approx((came, back, on, came + back, on), rel=1e-12)
    # a specimen of unknown density counts as without mass
    assert math.isnan(m.specimen)
    assert m.closure == pytest.approx((came + back - on) / came, rel=1e-12)
    reflected = BAR.stiffness * BAR.speed * 0.16e-6 * t
    assert e.reflected == pytest.approx(reflected, rel=1e-12)
    assert e.absorbed == pytest.approx(e.incident - reflected - e.transmitted, rel=1e-12)
    assert np.count_nonzero(r.loading) == 801


def test_forces_have_a_ratio_where_their_mean_stands_five_deviations_out():
    """R = 2 |F1 - F2|/(F1 + F2) of 1.2 and 1 over a ramp; noise of both gauges by its root of squares."""
    ramp = 1e-6 * np.arange(801)
    waves = still(1e-7 * np.arange(801), 1.2 * ramp, 0.0 * ramp, ramp)
    noisy = dataclasses.replace(waves, noise=(3e-6, 4e-6))
    ratio = equilibrium(reduce(noisy, (BAR, BAR), Specimen(5e-3, 1e-4))).ratio
    # 1.1 k > 25
    assert np.array_equal(np.isnan(ratio), np.arange(801) <= 22)
    assert ratio[23:] == pytest.approx(0.2 / 1.1, rel=1e-12)
    other = dataclasses.replace(waves, noise=(0.0, 4e-6))
    unequal = equilibrium(reduce(other, (BAR, OTHER), Specimen(5e-3, 1e-4)))
    mean = 0.5 * (1.2 * BAR.stiffness + OTHER.stiffness) * np.arange(801)
    assert np.array_equal(np.isnan(unequal.ratio), mean <= 20.0 * OTHER.stiffness)
    nothing = equilibrium(
        reduce(still(1e-7 * np.arange(801), 0.0 * ramp, 0.0 * ramp, 0.0 * ramp), (BAR, BAR), Specimen(1, 1))
    )
    assert math.isnan(nothing.misfit)
    assert math.isnan(nothing.force_ratio)


def agreeing(*stretches, window=3.3e-7, apart=1.3, limit=0.05):
    """Equal forces in stretches of samples, both ends included; smoothing over three takes one from either end."""
    k = np.arange(801)
    same = np.any([(k >= low) & (k <= high) for low, high in stretches], axis=0)
    one = 1e-3 * np.ones(801)
    waves = still(1e-7 * k, one * np.where(same, 1.0, apart), 0.0 * one, one)
    found = equilibrium(reduce(dataclasses.replace(waves, window=window), (BAR, BAR), Specimen(5e-3, 1e-4)), limit)
    return found.begin, found.end, found.share


def test_the_longest_stretch_of_agreement_to_the_sample():
    assert agreeing((200, 600)) == pytest.approx((20.1e-6, 59.9e-6, 399 / 801), rel=1e-12)
    # the longer of two, the first of two alike
    assert agreeing((100, 200), (300, 500)) == pytest.approx((30.1e-6, 49.9e-6, 298 / 801), rel=1e-12)
    assert agreeing((300, 500), (600, 700)) == pytest.approx((30.1e-6, 49.9e-6, 298 / 801), rel=1e-12)
    assert agreeing((100, 200), (300, 400))[:2] == pytest.approx((10.1e-6, 19.9e-6), rel=1e-12)
    # three windows of 3.3 steps: ten steps count, nine do not
    assert agreeing((200, 212))[:2] == pytest.approx((20.1e-6, 21.1e-6), rel=1e-12)
    begin, end, share = agreeing((200, 211))
    assert math.isnan(begin)
    assert math.isnan(end)
    assert share == pytest.approx(10 / 801, rel=1e-12)
    # no window narrower than a sample
    assert agreeing((200, 212), window=1e-9)[:2] == pytest.approx((20.0e-6, 21.2e-6), rel=1e-12)


def test_agreement_is_measured_by_the_mean_of_both_forces():
    """1.2 and 1 differ by 0.1818 of their mean."""
    assert agreeing((900, 900), apart=1.2, limit=0.1822) == pytest.approx((0.0, 80e-6, 1.0))
    assert agreeing((900, 900), apart=1.2, limit=0.1815)[2] == 0.0


def test_a_striker_is_checked_by_its_plateau_and_its_width():
    """A striker of a third of the impedance: v/4c of strain, 2 L/c of length, and the speed that the plateau stands for."""
    striker = StrikerBar(0.2, 4000.0, BAR.impedance / 3, 8.0)
    pulses = SimpleNamespace(plateau=1e-3, width=90e-6)
    found = striker_check(pulses, SimpleNamespace(bars=(BAR, OTHER)), striker)
    expected = (1e-3, 8.0 / (4.0 * BAR.speed), 90e-6, 100e-6, 4.0 * BAR.speed * 1e-3)
    assert dataclasses.astuple(found) == pytest.approx(expected, rel=1e-13)


def test_a_slope_needs_three_samples_of_a_rise():
    """Stress 0.05, 0.2, 0.3, 0.4, 0.8, 1: fitted from 0.2 to 0.4, strain on stress."""
    on = np.ones(6, dtype=bool)

    def slope(stress, strain):
        return rise_slope(StressStrainCurve(np.arange(6.0), np.array(strain), np.array(stress), np.arange(6.0)), on)

    stress = [0.05, 0.2, 0.3, 0.4, 0.8, 1.0]
    assert slope(stress, [9.0, 0.1, 0.15, 0.2, 7.0, 3.0]) == pytest.approx(2.0, rel=1e-13)
    assert slope([1e-4 * one for one in stress], [9.0, 0.1, 0.15, 0.2, 7.0, 3.0]) == pytest.approx(2e-4, rel=1e-13)
    # the middle one of three has no weight
    assert slope(stress, [9.0, 0.1, 0.9, 0.2, 7.0, 3.0]) == pytest.approx(2.0, rel=1e-13)
    assert math.isnan(slope([0.05, 0.09, 0.3, 0.4, 0.8, 1.0], [0.0, 0.1, 0.15, 0.2, 0.3, 0.4]))
    assert math.isnan(slope([-1.0] * 6, [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]))
    assert math.isnan(slope(stress, [0.0] * 6))
    # no foot: from the first sample on
    assert slope([0.1, 0.2, 0.3, 0.4, 0.8, 1.0], [0.1, 0.2, 0.3, 0.4, 5.0, 5.0]) == pytest.approx(1.0, rel=1e-13)


def test_slopes_of_a_straight_rise_moved_by_a_sample_in_closed_form():
    """Strain rate and stress both ramps: moved by a sample either way the three slopes are in order; upright is infinite."""
    k = np.arange(801.0)
    # equal bars: F1 = F2 = E A e, e_r = e_t - e_i
    on = np.minimum(np.minimum(k, 395.0), 800.0 - k) * 1e-6
    waves = still(1e-7 * k, 2.0 * on, -on, on)
    reduction = reduce(waves, (BAR, BAR), Specimen(5e-3, 1e-4))
    found = rise_slopes(reduction, "1-wave")
    compliances = []
    for back in (-1, 0, 1):
        for forward in (-1, 0, 1):
            moved = dataclasses.replace(waves, reflected=np.roll(-on, back), transmitted=np.roll(on, forward))
            one = rise_slope(reduce(moved, (BAR, BAR), Specimen(5e-3, 1e-4)).curve("1-wave"), reduction.loading)
            compliances.append(1.0 / one)
    assert found.value == pytest.approx(1.0 / compliances[4], rel=1e-12)
    assert found.low == pytest.approx(1.0 / max(compliances), rel=1e-12)
    assert found.high == pytest.approx(1.0 / min(compliances), rel=1e-12)
    # strain = c/L int 2 e_t dt of a ramp, by least squares from 10 to 50 % of it
    strain = BAR.speed * 2e-6 / 5e-3 * 1e-7 * 0.5 * k**2
    stress = BAR.stiffness * 1e-6 / 1e-4 * k
    part = slice(40, 198)
    assert found.value == pytest.approx(1.0 / np.polyfit(stress[part], strain[part], 1)[0], rel=1e-9)
    flat = reduce(still(1e-7 * k, 0.0 * k, 0.0 * k, 0.0 * k), (BAR, BAR), Specimen(5e-3, 1e-4))
    assert all(math.isnan(x) for x in dataclasses.astuple(rise_slopes(flat, "3-wave")))


def test_forces_of_micronewtons_are_compared_as_any_others():
    one = 1e-14 * np.ones(801)
    found = equilibrium(
        reduce(still(1e-7 * np.arange(801), 1.2 * one, 0.0 * one, one), (BAR, BAR), Specimen(5e-3, 1e-4))
    )
    assert (found.misfit, found.force_ratio) == pytest.approx((0.2 / 1.1, 1.2), rel=1e-12)


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
