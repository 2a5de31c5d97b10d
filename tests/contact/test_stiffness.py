"""Stiffness laws against published constants."""

import math

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.base.materials import material
from strikewave.contact import Geometry, contact_modulus, hertz, johnson, palmgren, stiffness_of
from strikewave.contact.stiffness import dubowsky_freudenstein, pereira, radzimovsky


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
