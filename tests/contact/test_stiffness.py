"""Stiffness laws against published constants."""

import numpy as np
import pytest

from strikewave.contact import contact_modulus, hertz, line_contact_yield_load, palmgren
from strikewave.materials import material


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


@pytest.mark.parametrize(("radius", "load"), [(0.005, 3.2e3), (0.010, 6.5e3), (0.020, 13e3)])
def test_line_contact_yield_of_65mn(radius, load):
    """3.2, 6.5, 13 kN for 40 mm of 65Mn (430 MPa), von Mises, p0 = 1.79 sigma_y."""
    steel = material("65Mn")
    assert line_contact_yield_load(steel, steel, 430e6, radius) * 0.04 == pytest.approx(load, rel=0.02)


def test_yield_pressure_factor_from_the_stress_field():
    """p0 = 1.79 sigma_y: largest von Mises stress below a Hertz line contact, nu = 0.30 (Johnson 1985, eq. 4.49)."""
    z = np.linspace(0.0, 3.0, 30001)
    root = np.sqrt(1 + z**2)
    along, down = -((1 + 2 * z**2) / root - 2 * z), -1 / root
    across = 0.3 * (along + down)
    mises = np.sqrt(0.5 * ((along - down) ** 2 + (down - across) ** 2 + (across - along) ** 2))
    assert 1 / mises.max() == pytest.approx(1.79, abs=0.005)


def test_impossible_sizes_are_refused():
    steel = material("65Mn")
    with pytest.raises(ValueError, match="length"):
        palmgren(steel, steel, 0.0)
    with pytest.raises(ValueError, match="radii"):
        hertz(steel, steel, -0.01)
