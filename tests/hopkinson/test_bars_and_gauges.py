"""Constants of bars, striker laws, and bridges of strain gauges against the resistances of their arms."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.hopkinson import BRIDGES, Bar, Bridge, Specimen, StrikerBar, elastic
from strikewave.waves import BONDED, End, Joint, Layer, LoadPulse, Stack, Tap, WantedError, run_bar


@given(st.floats(1e3, 2e4), st.floats(1e9, 1e12))
def test_any_two_of_density_modulus_and_speed_give_the_third(density, modulus):
    """c^2 = E/rho, to rounding."""
    speed = math.sqrt(modulus / density)
    for given_two, derived in (
        ({"density": density, "modulus": modulus}, "speed"),
        ({"density": density, "speed": speed}, "modulus"),
        ({"modulus": modulus, "speed": speed}, "density"),
    ):
        found = elastic(**given_two)
        assert found.derived == derived
        assert dataclasses.astuple(found)[:3] == pytest.approx((density, modulus, speed), rel=1e-14)


def test_a_third_constant_that_disagrees_is_told_not_used():
    """Ti-6Al-4V as its record states it: 4416 kg/m^3, 109.297 GPa, and 4865.9 m/s measured by reflected time."""
    found = elastic(4416.0, 109.297184e9, 4865.900383)
    assert found.modulus == pytest.approx(4416.0 * 4865.900383**2, rel=1e-15)
    assert found.mismatch == pytest.approx((4974.964141 / 4865.900383) ** 2 - 1.0, rel=1e-6)


@pytest.mark.parametrize(
    "bad", [{}, {"density": 1.0}, {"density": -1.0, "modulus": 1.0}, {"speed": math.nan, "density": 1.0}]
)
def test_constants_that_do_not_do_are_refused(bad):
    with pytest.raises(ValueError, match=r"two of density|above zero"):
        elastic(**bad)


@pytest.mark.parametrize("key", ["density", "modulus", "diameter", "gauge_distance"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_bar_without_size_is_refused(key, value):
    good = {"density": 7800.0, "modulus": 210e9, "diameter": 0.02, "gauge_distance": 1.0}
    with pytest.raises(ValueError, match=key):
        Bar(**{**good, key: value})


def test_a_gauge_off_its_bar_is_refused():
    with pytest.raises(ValueError, match="lies off"):
        Bar(7800.0, 210e9, 0.02, 1.0, length=1.0)


def test_impedance_ratio_and_transit_of_a_specimen():
    """beta = sqrt(rho E) A / (sqrt(rho E) A): 1 for the bar's own material and size; t0 = l/c."""
    bar = Bar(7800.0, 210e9, 0.02, 1.0)
    same = Specimen(0.01, bar.area, 7800.0, 210e9)
    assert same.impedance_ratio(bar) == pytest.approx(1.0, rel=1e-15)
    assert same.transit == pytest.approx(0.01 / bar.speed, rel=1e-15)
    assert Specimen(0.01, bar.area).impedance_ratio(bar) is None


def test_striker_strain_and_pulse_length_against_delay_lines():
    """A lighter striker of equal speed: plateau v Zs/((Zs+Zb) c), for 2 Ls/cs; delay lines carry steps exactly."""
    bar = Bar(7800.0, 210e9, 0.02, 0.5)
    step, transits = 1e-7, 100
    striker_layer = Layer("striker", 7800.0, 210e9, 0.25 * bar.area, transits * step * bar.speed, speed=8.0)
    striker = StrikerBar(striker_layer.length, bar.speed, striker_layer.impedance, 8.0)
    long = Layer("bar", 7800.0, 210e9, bar.area, 2000 * step * bar.speed)
    stack = Stack((striker_layer, long), (Joint(unilateral=True),), End("matched"))
    run = run_bar(stack, LoadPulse("rectangle", 0.0, 1e-6), [Tap(1, 0.1)], 100e-6, WantedError(step=step))
    strain = run.force[:, 0] / bar.stiffness
    assert strain.max() == pytest.approx(striker.strain(bar), rel=1e-12)
    lasts = step * np.count_nonzero(strain > 0.5 * strain.max())
    assert lasts == pytest.approx(striker.pulse_length, abs=1.01 * step)
    assert striker.pulse_length == pytest.approx(2 * transits * step, rel=1e-12)
    assert BONDED.kind == "bonded"


def bridge_voltage(kind, strain, factor, nu):
    """Return the output over the excitation from the four arms themselves."""
    x = factor * strain
    active, around = 1.0 + x, 1.0 - nu * x
    arms = {
        "quarter": (active, 1.0, 1.0, 1.0),
        "half": (active, 1.0, active, 1.0),
        "half-poisson": (active, around, 1.0, 1.0),
        "full-poisson": (active, around, active, around),
    }[kind]
    r1, r2, r3, r4 = arms
    return r1 / (r1 + r2) - r4 / (r3 + r4)


@given(st.sampled_from(BRIDGES), st.floats(-0.01, 0.01), st.floats(1.5, 130.0))
def test_a_bridge_gives_back_the_strain_of_its_arms(kind, strain, factor):
    """The output of the two dividers, turned back exactly; 1e-12 is rounding over a difference of two dividers."""
    nu = 0.29
    bridge = Bridge(kind, factor, 8.0, 200.0, nu)
    volts = 200.0 * 8.0 * bridge_voltage(kind, strain, factor, nu)
    assert float(bridge.strain(volts)) == pytest.approx(strain, rel=1e-10, abs=1e-14)


@pytest.mark.parametrize(
    "bad",
    [{"kind": "third"}, {"gauge_factor": 0.0}, {"excitation": math.nan}, {"gain": -1.0}],
    ids=lambda b: next(iter(b)),
)
def test_a_bridge_that_cannot_be_is_refused(bad):
    good = {"kind": "half", "gauge_factor": 2.0, "excitation": 8.0, "gain": 200.0}
    with pytest.raises(ValueError, match="third" if "kind" in bad else next(iter(bad))):
        Bridge(**{**good, **bad})


def test_numbers_of_a_round_bar_its_specimen_and_its_striker_worked_by_hand():
    """d 20 mm, rho 8000, E 200 GPa: A = pi 1e-4, c = 5000, Z = 4e7 A, E A = 2e11 A."""
    bar = Bar(8000.0, 2e11, 0.02, 1.5, 0.3, 4.0)
    area = math.pi * 1e-4
    assert (bar.area, bar.speed, bar.delay) == pytest.approx((area, 5000.0, 3e-4), rel=1e-14)
    assert (bar.impedance, bar.stiffness) == pytest.approx((4e7 * area, 2e11 * area), rel=1e-14)
    assert bar.rod == pytest.approx((0.01, 5000.0, 0.3), rel=1e-14)
    specimen = Specimen(0.005, 2e-4, 2000.0, 8e9)
    assert (specimen.mass, specimen.transit) == pytest.approx((2e-3, 2.5e-6), rel=1e-14)
    assert specimen.impedance_ratio(bar) == pytest.approx(4e6 * 2e-4 / (4e7 * area), rel=1e-14)
    bare = Specimen(0.005, 2e-4)
    assert (bare.mass, bare.transit, bare.impedance_ratio(bar)) == (None, None, None)
    for half in (Specimen(0.005, 2e-4, 2000.0), Specimen(0.005, 2e-4, None, 8e9)):
        assert (half.transit, half.impedance_ratio(bar)) == (None, None)
    # equal bars share the speed; one of a third of the impedance gives half of that
    assert StrikerBar(0.2, 5000.0, bar.impedance, 10.0).strain(bar) == pytest.approx(1e-3, rel=1e-14)
    light = StrikerBar(0.2, 4000.0, bar.impedance / 3, 10.0)
    assert (light.strain(bar), light.pulse_length) == pytest.approx((0.5e-3, 1e-4), rel=1e-14)


def test_edges_of_what_a_bar_can_be_are_taken():
    for nu in (0.5, -0.999, 0.005):
        assert Bar(8000.0, 2e11, 0.02, 1.5, nu).poissons_ratio == nu
    for nu in (0.501, -1.0, math.nan):
        with pytest.raises(ValueError, match="Poisson's ratio lies above -1"):
            Bar(8000.0, 2e11, 0.02, 1.5, nu)
    assert Bar(8000.0, 2e11, 0.02, 1.5, 0.3, 1.501).length == 1.501
    for key in ("length", "area", "density", "modulus"):
        for value in (0.0, math.inf):
            with pytest.raises(ValueError, match=f"{key} of the specimen must be above zero"):
                Specimen(**{"length": 1.0, "area": 1.0, key: value})
    assert Specimen(1e-6, 1e-6, 1e-3, 1e-3).mass == pytest.approx(1e-15, rel=1e-14, abs=0.0)
    assert elastic(modulus=1e-3, speed=1e-2).density == pytest.approx(10.0, rel=1e-14)


def test_one_of_density_modulus_and_speed_is_not_enough_and_each_is_above_zero():
    """8000 kg/m^3, 5000 m/s and 200 GPa belong together: nothing is off where two are given."""
    all_three = {"density": 8e3, "modulus": 2e11, "speed": 5e3}
    for one in all_three:
        left = {name: value for name, value in all_three.items() if name != one}
        assert (elastic(**left).derived, elastic(**left).mismatch) == (one, 0.0)
        with pytest.raises(ValueError, match="two of density, modulus and speed"):
            elastic(**{one: 1.0})
        for bad in (0.0, -1.0, math.inf, math.nan):
            with pytest.raises(ValueError, match=f"{one} must be above zero and finite"):
                elastic(**{**all_three, one: bad})
    assert elastic(8e3, 2.1e11, 5e3).mismatch == pytest.approx(0.05, rel=1e-12)
