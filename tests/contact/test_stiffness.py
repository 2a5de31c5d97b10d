"""Stiffness laws against published constants."""

import math

import numpy as np
import pytest

from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.contact import Geometry, contact_modulus, hertz, johnson, palmgren, stiffness_of
from strikewave.contact.law import Damper, PressureCap
from strikewave.contact.stiffness import (
    LogarithmicStiffness,
    Stiffness,
    dubowsky_freudenstein,
    lankarani_nikravesh_cylinder,
    pereira,
    radzimovsky,
    reduced_radius,
)


class Soft:
    """(1 - nu^2)/E = 1/4."""

    youngs_modulus, poissons_ratio = 3.0, 0.5


class Hard:
    """(1 - nu^2)/E = 1/12."""

    youngs_modulus, poissons_ratio = 11.52, 0.2


def test_palmgren_constant_for_bearing_steel():
    """d = 3.84e-5 Q^0.9 / l^0.8 (mm, N): Palmgren's rule as bearing handbooks print it (E 206 GPa, nu 0.3)."""

    class BearingSteel:
        youngs_modulus, poissons_ratio = 206e9, 0.3

    steel = BearingSteel()
    force, length = 1e4, 0.01
    law = palmgren(steel, steel, length)
    depth = (force / law.stiffness) ** (1 / law.exponent)
    # three printed digits
    assert depth * 1e3 == pytest.approx(3.84e-5 * force**0.9 / (length * 1e3) ** 0.8, rel=5e-3)


def test_palmgren_forward_law():
    """F = K d^n inverts the printed compliance, d = 3.81 (2/(pi E'))^0.9 F^0.9/h^0.8."""
    one, other, length = material("65Mn"), material("2A12"), 0.03
    law = palmgren(one, other, length)
    for force in (10.0, 1e3, 1e5):
        modulus = 2 * contact_modulus(one, other)
        depth = 3.81 * (2 / (np.pi * modulus)) ** 0.9 * force**0.9 / length**0.8
        assert law.stiffness * depth**law.exponent == pytest.approx(force, rel=1e-12)


def test_hertz_is_symmetric_and_has_a_plane_limit():
    one, other = material("65Mn"), material("2A12")
    assert hertz(one, other, 0.01, 0.02).stiffness == pytest.approx(hertz(other, one, 0.02, 0.01).stiffness, rel=1e-15)
    assert hertz(one, other, 0.01, 1e12).stiffness == pytest.approx(hertz(one, other, 0.01).stiffness, rel=1e-12)


def test_johnson_1985_on_a_plane_is_the_sum_of_cylinder_and_half_space():
    """(1 - nu^2)/(pi E) F/h [2 ln(4R/a) - 1] and [2 ln(2D/a) - nu/(1 - nu)], a^2 = 4 F R/(pi E* h), of unlike materials."""
    steel, aluminium, radius, length, depth = material("65Mn"), material("2A12"), 0.01, 0.04, 0.03
    law = johnson(steel, aluminium, radius, math.inf, length, depth)
    for force in (1e2, 1e4, 1e5):
        a = math.sqrt(4 * force * radius / (math.pi * contact_modulus(steel, aluminium) * length))
        share = [(1 - m.poissons_ratio**2) / (math.pi * m.youngs_modulus) * force / length for m in (steel, aluminium)]
        nu = aluminium.poissons_ratio
        expected = share[0] * (2 * math.log(4 * radius / a) - 1) + share[1] * (
            2 * math.log(2 * depth / a) - nu / (1 - nu)
        )
        assert float(law.indentation(force)) == pytest.approx(expected, rel=1e-12)


def test_log_laws_have_no_limit_for_a_plane_and_ask_for_a_datum_depth():
    steel = material("65Mn")
    with pytest.raises(ValueError, match="datum depth"):
        johnson(steel, steel, 0.01, math.inf, 0.04)
    for law in (radzimovsky, dubowsky_freudenstein):
        with pytest.raises(ValueError, match="take johnson with a datum depth"):
            law(steel, steel, 0.01, math.inf, 0.04)


def test_radzimovsky_is_two_to_three_percent_above_johnson():
    """The print: 2-3 % for two steel cylinders of 10 mm and 20 mm at kilonewtons on 40 mm."""
    steel = material("65Mn")
    for radius in (0.01, 0.02):
        one, other = (law(steel, steel, radius, radius, 0.04) for law in (johnson, radzimovsky))
        for force in (1e3, 3e3, 1e4, 3e4):
            assert 1.02 < float(other.indentation(force) / one.indentation(force)) < 1.03


def test_power_laws_stay_within_a_tenth_of_johnson():
    """Palmgren and Pereira were fitted to line contacts of this size: 20 mm radii, 40 mm long, 1 to 100 kN."""
    steel, radius = material("65Mn"), 0.02
    line = johnson(steel, steel, radius, radius, 0.04)
    for law in (palmgren(steel, steel, 0.04), pereira(steel, steel, radius, radius, 0.04)):
        for force in (1e3, 1e4, 1e5):
            depth = (force / law.stiffness) ** (1 / law.exponent)
            assert depth == pytest.approx(float(line.indentation(force)), rel=0.1)


def test_pereira_2015_in_millimetres_and_megapascals():
    """F = (a dR + b) h E*/dR d^n in N, mm, MPa: both branches and the plane, by hand."""
    steel = material("65Mn")
    modulus = contact_modulus(steel, steel) * 1e-6
    d = 0.007
    outside = pereira(steel, steel, 0.01, 0.02, 0.04)
    assert outside.stiffness * (d * 1e-3) ** outside.exponent == pytest.approx(
        (0.39 * 30 + 0.85) * 40 * modulus / 30 * d**1.094, rel=1e-12
    )
    plane = pereira(steel, steel, 0.01, math.inf, 0.04)
    assert plane.stiffness * (d * 1e-3) ** plane.exponent == pytest.approx(0.39 * 40 * modulus * d**1.094, rel=1e-12)
    for hole, y in ((-0.0101, 1.51 * math.log(100) ** -0.151), (-0.011, 0.0151 * 1 + 1.151)):
        inside = pereira(steel, steel, 0.01, hole, 0.04)
        gap = -1e3 * (0.01 + hole)
        assert inside.status == "from memory"
        assert inside.exponent == pytest.approx(y * gap**-0.005, rel=1e-9)
        assert inside.stiffness * (d * 1e-3) ** inside.exponent == pytest.approx(
            (0.965 * gap + 0.0965) * 40 * modulus / gap * d**inside.exponent, rel=1e-9
        )
    with pytest.raises(ValueError, match=r"within 0\.005 to 10 mm"):
        pereira(steel, steel, 0.01, -0.010001, 0.04)


def test_a_named_law_says_what_it_misses():
    steel = material("65Mn")
    with pytest.raises(InputError, match="length: missing"):
        stiffness_of("johnson", steel, steel, Geometry(radius1=0.01, radius2=0.01))
    with pytest.raises(InputError, match='did you mean "johnson"'):
        stiffness_of("jonson", steel, steel, Geometry())
    with pytest.raises(InputError, match="datum depth"):
        stiffness_of("johnson", steel, steel, Geometry(radius1=0.01, length=0.04))


def test_impossible_sizes_are_refused():
    steel = material("65Mn")
    with pytest.raises(ValueError, match="length"):
        palmgren(steel, steel, 0.0)
    with pytest.raises(ValueError, match="radii"):
        hertz(steel, steel, -0.01)


def test_contact_modulus_and_hertz_of_unlike_bodies_worked_by_hand():
    """1/E* = 1/4 + 1/12, R = 0.03 x 0.01/0.04: E* = 3, K = 4 sqrt(0.0075)."""
    assert contact_modulus(Soft, Hard) == pytest.approx(3.0, rel=1e-15)
    assert Geometry(radius1=0.01, radius2=0.03).reduced_radius == pytest.approx(0.0075, rel=1e-14)
    for law in (hertz, lankarani_nikravesh_cylinder):
        made = law(Soft, Hard, 0.01, 0.03)
        assert made.stiffness == pytest.approx(4.0 * math.sqrt(0.0075), rel=1e-14)
        assert made.exponent == 1.5


def test_reduced_radius_of_a_hole_a_plane_and_what_does_not_fit():
    assert reduced_radius(0.010, -0.011) == pytest.approx(0.11, rel=1e-12)
    assert reduced_radius(0.02, math.inf) == 0.02
    # a proton is just not refused
    assert reduced_radius(1.5e-15, math.inf) == pytest.approx(1.5e-15, rel=1e-15, abs=0.0)
    for one, other in ((0.01, -0.01), (0.01, -0.009), (0.0, 1.0), (math.inf, 1.0), (0.01, 0.0), (0.01, math.nan)):
        with pytest.raises(ValueError, match="radi"):
            reduced_radius(one, other)
    for one, other in ((5e-16, 1.0), (1.0, 5e-16), (1e-16, -5e-16)):
        with pytest.raises(ValueError, match="radii below 1e-15 m"):
            reduced_radius(one, other)


@pytest.mark.parametrize(("radius2", "by_length"), [(0.03, math.log(4 / 3)), (-0.0125, math.log(3.2))])
def test_line_laws_differ_by_multiples_of_the_mean_approach(radius2, by_length):
    """All are d = F/(pi E* h)(ln 1/F + constant): radzimovsky 5/3 - ln 4 beyond johnson, dubowsky 2 + ln[h^2/(4 R dR)]."""
    force, length = 0.3, 0.04
    unit = force / (math.pi * 3.0 * length)
    line, wide, pin = (
        float(law(Soft, Hard, 0.01, radius2, length).indentation(force))
        for law in (johnson, radzimovsky, dubowsky_freudenstein)
    )
    # johnson by halves: (1 - nu^2)/(pi E) F/h [2 ln(4 R_i/a) - 1]
    a = math.sqrt(4 * unit * reduced_radius(0.01, radius2))
    halves = sum(
        share / math.pi * force / length * (2 * math.log(4 * abs(radius) / a) - 1)
        for share, radius in ((1 / 4, 0.01), (1 / 12, radius2))
    )
    assert line == pytest.approx(halves, rel=1e-13)
    mean = unit * (math.log(4 * abs(0.01 + radius2) / unit) - 1)
    assert wide - mean == pytest.approx((5 / 3 - math.log(4)) * unit, rel=1e-11)
    assert pin - mean == pytest.approx((2 + by_length) * unit, rel=1e-11)


def test_logarithmic_stiffness_is_exact_at_a_power_of_e_and_hands_its_numbers_on():
    law = LogarithmicStiffness(2e9, 1e6, "given", "given", "")
    assert float(law.indentation(1e6 * math.exp(-4.0))) == pytest.approx(4e6 * math.exp(-4.0) / 2e9, rel=1e-14)
    cap, damper = PressureCap(5.0, "line"), Damper(3.0)
    made = law.contact(0.25, cap)
    assert (made.slope, made.load, made.hysteresis_factor, made.cap) == (2e9, 1e6, 0.25, cap)
    power = Stiffness(7.0, 1.2).contact(0.5, cap, damper)
    assert (power.stiffness, power.exponent, power.hysteresis_factor) == (7.0, 1.2, 0.5)
    assert (power.damper, power.cap) == (damper, cap)


def test_palmgren_goes_with_length_and_modulus_by_their_powers():
    """K ~ h^(8/9) E*; with E* = 3: d = 3.81 (1/(3 pi))^0.9 F^0.9/h^0.8."""
    one = palmgren(Soft, Hard, 1.0)
    assert 3.81 * (1 / (3 * math.pi)) ** 0.9 * one.stiffness**0.9 == pytest.approx(1.0, rel=1e-13)
    assert palmgren(Soft, Hard, 2.0).stiffness / one.stiffness == pytest.approx(2 ** (8 / 9), rel=1e-13)


def test_pereira_changes_its_exponent_where_it_says():
    """Y = 1.51 [ln(1000 dR)]^-0.151 up to 0.34954 mm, and a line above; both ends of 0.005 to 10 mm are taken."""
    steel = material("65Mn")
    for gap, y in ((0.3494, 1.51 * math.log(349.4) ** -0.151), (0.3497, 0.0151 * 0.3497 + 1.151)):
        assert pereira(steel, steel, 0.01, -0.01 - gap * 1e-3, 0.04).exponent == pytest.approx(
            y * gap**-0.005, rel=1e-9
        )
    for gap in (0.00500001, 9.99999):
        assert pereira(steel, steel, 0.01, -0.01 - gap * 1e-3, 0.04).exponent > 0.0
    with pytest.raises(ValueError, match=r"within 0\.005 to 10 mm"):
        pereira(steel, steel, 0.01, -0.02001, 0.04)


def test_a_law_asks_only_for_what_it_needs_and_leaves_out_what_may_be_missing():
    steel = material("65Mn")
    assert stiffness_of("palmgren", steel, steel, Geometry(length=0.04)) == palmgren(steel, steel, 0.04)
    plane = stiffness_of("johnson", steel, steel, Geometry(radius1=0.01, length=0.04, datum_depth=0.03))
    assert plane == johnson(steel, steel, 0.01, math.inf, 0.04, 0.03)
    with pytest.raises(InputError, match="radius1: missing"):
        stiffness_of("hertz", steel, steel, Geometry(length=0.04))
