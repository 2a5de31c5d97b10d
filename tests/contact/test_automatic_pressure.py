"""The pressure cap that a material gives, against finite elements, full plasticity and geometry."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from strikewave.base.constants import material, materials
from strikewave.contact import (
    automatic_pressure,
    contact_modulus,
    hardness_of,
    hertz,
    line_yield_pressure,
    point_cap,
    point_yield_pressure,
    slow_force,
    solve_impact,
)
from strikewave.contact.elastoplastic import PLASTIC_AREA

from .jackson_green import jackson_green

STEEL = material("45 steel")
METALS = [m for m in materials().values() if m.kind == "metal"]
RADIUS = 0.01


def peak_at(work, pressure):
    """Peak force of an impact of that energy, J, on the sphere with a cap, N."""
    contact = hertz(STEEL, STEEL, RADIUS).contact(cap=point_cap(STEEL, STEEL, RADIUS, math.inf, pressure))
    return float(solve_impact(contact, 2.0 * work, np.inf, 1.0).peak_force)


@pytest.mark.parametrize("times", [2, 5, 10, 15, 30, 100, 300, 1000])
def test_finite_elements_of_jackson_and_green_lie_in_the_range(times):
    """Peak force at equal energy from first yield to 1 000 times its depth, a spot of 0.4 R: 16 % from the best pressure.

    16 % is the difference of the laws at 15 times the depth of first yield; beyond 100 times it is 5 %. The fit to the
    elements lies up to 4 % below the lowest pressure, near 3 times, where that is still elastic, and 0.3 % above the elastic
    force at 1.9 times, where it begins.
    """
    modulus = contact_modulus(STEEL, STEEL)
    depth, half_width, force = jackson_green(STEEL.yield_strength, STEEL.poissons_ratio, RADIUS, modulus)
    work = quad(force, 0.0, times * depth, points=[1.9 * depth], limit=200)[0]
    best, low, high = automatic_pressure(STEEL, STEEL)
    peak = force(times * depth)
    assert peak_at(work, low) * 0.96 < peak < peak_at(work, high) * 1.01
    assert half_width(times * depth) < 0.41 * RADIUS
    assert peak_at(work, best) == pytest.approx(peak, rel=0.16 if times < 100 else 0.05)


def test_full_plasticity_is_the_hardness_on_the_area_the_ball_cuts():
    """F = H pi a^2, a^2 = 2 R d (Abbott & Firestone, as Jackson & Green quote it); the elastic rest is below 0.2 %."""
    pressure = automatic_pressure(STEEL, STEEL).best
    contact = hertz(STEEL, STEEL, RADIUS).contact(cap=point_cap(STEEL, STEEL, RADIUS, math.inf, pressure))
    yields = (math.pi * pressure / (2 * contact_modulus(STEEL, STEEL))) ** 2 * RADIUS
    d = 200.0 * yields
    assert float(slow_force(contact, d)) == pytest.approx(hardness_of(STEEL) * math.pi * 2 * RADIUS * d, rel=2e-3)


@pytest.mark.parametrize(("share", "width"), [(0.02, 2.19), (0.05, 1.97), (0.1, 1.79)])
def test_plastic_line_is_twice_as_wide_as_the_elastic_one(share, width):
    """Elastic d = F/(pi E* h) [2 ln(4 R/a) - 1] with a^2 = 4 F R/(pi E* h) (Johnson 1985, 5.6), plastic a^2 = 2 R d."""
    elastic = share
    depth = elastic**2 / 4.0 * (2.0 * math.log(4.0 / elastic) - 1.0)
    assert math.sqrt(2.0 * depth) / elastic == pytest.approx(width, abs=0.01)
    assert math.sqrt(2.0 * depth) / elastic == pytest.approx(PLASTIC_AREA, rel=0.11)


@pytest.mark.parametrize("one", METALS, ids=lambda m: m.name)
@pytest.mark.parametrize("other", METALS, ids=lambda m: m.name)
def test_the_softer_of_two_metals_gives_a_range_in_order_above_first_yield(one, other):
    found = automatic_pressure(one, other)
    assert found.low < found.best < found.high
    assert found == automatic_pressure(other, one)
    assert found.best == PLASTIC_AREA * min(hardness_of(one), hardness_of(other))
    for first in (point_yield_pressure, line_yield_pressure):
        assert found.low > min(first(one, one.yield_strength), first(other, other.yield_strength))


def test_a_hardness_that_is_known_stands_for_the_yield_strength():
    """7075-T6: 150 HB, 2.92 times its yield strength; the range then ends at piled-up metal, 8/3 H."""
    alloy = material("7075-T6")
    assert hardness_of(alloy) == pytest.approx(150 * 9.80665e6, rel=1e-4)
    assert automatic_pressure(alloy, material("17-4PH")) == pytest.approx(
        (2 * alloy.hardness, alloy.hardness, 8 / 3 * alloy.hardness)
    )


def test_the_range_of_pressures_keeps_the_order_of_forces_and_of_restitutions():
    """Peak force and restitution rise with the pressure at any speed, and end at the elastic ones."""
    found = automatic_pressure(STEEL, STEEL)
    pressures = (found.low, found.best, found.high)
    bare = hertz(STEEL, STEEL, RADIUS)
    for speed in (0.01, 0.3, 3.0, 30.0):
        caps = (point_cap(STEEL, STEEL, RADIUS, math.inf, p) for p in pressures)
        blows = [solve_impact(bare.contact(cap=cap), 0.03, np.inf, speed) for cap in caps]
        blows.append(solve_impact(bare.contact(), 0.03, np.inf, speed))
        for name in ("peak_force", "restitution"):
            numbers = [float(getattr(blow, name)) for blow in blows]
            # equal where nothing yields, to the integrator's 1e-7
            assert all(a <= b * (1 + 1e-6) for a, b in pairwise(numbers)), name


def test_without_hardness_and_yield_strength_there_is_no_pressure():
    assert hardness_of(material("rubber")) is None
    with pytest.raises(ValueError, match="without hardness and without yield strength"):
        automatic_pressure(STEEL, material("rubber"))
