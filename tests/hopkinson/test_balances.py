"""Balances and analyses of constant waves in closed form, the stretch in which forces agree, the slope of the rise."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.hopkinson import (
    Bar,
    FaceWaves,
    Specimen,
    StressStrainCurve,
    energy,
    equilibrium,
    momentum,
    reduce,
    rise_slope,
)

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
