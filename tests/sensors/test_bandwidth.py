"""The band that a mounting passes, against closed forms of one mass on a spring and of a layer."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.sensors import Gasket, Mounting, transmission
from strikewave.sensors.mounting import band


def on_spring(natural, zeta=0.0, mass=5e-3):
    w = 2.0 * math.pi * natural
    return Mounting((), mass, mass * w**2, 2.0 * zeta * mass * w)


@given(st.floats(200.0, 1e5))
def test_mass_on_a_spring_without_loss_leaves_the_band_as_its_closed_form_says(natural):
    # |H| = 1 / |1 - r^2|: 1.05 and 1.1 below resonance, 1/sqrt(2) above; 2e-7 of a frequency is left by the zooms
    found = band(on_spring(natural))
    assert found.within_5 == pytest.approx(natural * math.sqrt(1.0 - 1.0 / 1.05), rel=1e-6)
    assert found.within_10 == pytest.approx(natural * math.sqrt(1.0 - 1.0 / 1.1), rel=1e-6)
    assert found.half_power == pytest.approx(natural * math.sqrt(1.0 + math.sqrt(2.0)), rel=1e-6)
    assert found.resonance == pytest.approx(natural, rel=2e-6)  # a summit is looked for on both sides


@given(st.floats(200.0, 1e5), st.floats(0.005, 0.4))
def test_resonance_and_quality_of_a_damped_mass(natural, zeta):
    # the largest |H| of a base-excited mass stands at r^2 = (sqrt(1 + 8 zeta^2) - 1) / (4 zeta^2)
    found, r2 = band(on_spring(natural, zeta)), (math.sqrt(1.0 + 8.0 * zeta**2) - 1.0) / (4.0 * zeta**2)
    height = math.sqrt((1.0 + 4.0 * zeta**2 * r2) / ((1.0 - r2) ** 2 + 4.0 * zeta**2 * r2))
    # a summit is flat: what is left of its frequency is a share of its width, of its height the square of that
    assert found.resonance == pytest.approx(natural * math.sqrt(r2), rel=1e-4)
    assert found.quality == pytest.approx(height, rel=1e-7)
    assert (found.largest, found.largest_at) == (found.quality, found.resonance)


def test_layer_with_a_free_face_leaves_10_percent_where_its_cosine_says():
    # |H| = 1 / |cos k h|
    layer = Gasket(1100.0, 10e6, 1e-4, 2e-3)
    speed = math.sqrt(10e6 / 1100.0)
    expected = math.acos(1.0 / 1.1) * speed / (2.0 * math.pi * 2e-3)
    assert band(Mounting((layer,))).within_10 == pytest.approx(expected, rel=1e-6)


def test_a_direct_mounting_passes_everything():
    found = band(Mounting())
    assert (found.within_5, found.within_10, found.half_power) == (math.inf,) * 3
    assert math.isnan(found.resonance)
    assert found.largest == 1.0


def test_what_lies_above_200_khz_is_not_claimed():
    found = band(on_spring(1e6))
    assert found.half_power == math.inf
    assert math.isnan(found.resonance)
    assert found.within_5 == math.inf  # 5 % is left at 218 kHz
    assert found.largest_at == pytest.approx(200e3)


@given(st.floats(0.01, 0.5), st.floats(2e-4, 3e-3), st.floats(1e-3, 2e-2))
def test_inside_the_band_nothing_is_further_from_one(eta, thickness, mass):
    mounting = Mounting((Gasket(2170.0, 0.475e9, 1.8e-4, thickness, eta),), mass, 2e8, 50.0)
    found = band(mounting)
    for edge, share in ((found.within_5, 0.05), (found.within_10, 0.10)):
        inside = np.linspace(0.0, edge * (1.0 - 1e-6), 500)
        assert np.max(np.abs(np.abs(transmission(mounting, inside)) - 1.0)) <= share
        assert abs(abs(transmission(mounting, edge)) - 1.0) >= share


def test_the_5_percent_band_of_an_overdamped_mounting_ends_below_one():
    """Four times critical: |H|^2 = (1 + (2 z r)^2) / ((1 - r^2)^2 + (2 z r)^2) stays below 1.05 and leaves at 0.95."""
    k, m, z = 4e5, 1e-2, 4.0
    found = band(Mounting((Gasket(1.0, 1e12, 1e-4, 1e-4),), m, k, 2.0 * z * math.sqrt(k * m)))
    r = found.within_5 / (math.sqrt(k / m) / (2.0 * math.pi))
    height = math.sqrt((1.0 + (2.0 * z * r) ** 2) / ((1.0 - r * r) ** 2 + (2.0 * z * r) ** 2))
    assert found.largest < 1.05
    assert height == pytest.approx(0.95, abs=1e-5)
    r = found.within_10 / (math.sqrt(k / m) / (2.0 * math.pi))
    height = math.sqrt((1.0 + (2.0 * z * r) ** 2) / ((1.0 - r * r) ** 2 + (2.0 * z * r) ** 2))
    assert height == pytest.approx(0.9, abs=1e-5)


def test_one_lossy_gasket_of_two_keeps_the_quality_finite():
    layers = [Gasket(1100.0, 10e6, 1e-4, 2e-3, eta) for eta in (0.0, 0.1)]
    assert band(Mounting(tuple(layers), 5e-3)).quality == pytest.approx(2.0 / 0.1, rel=0.2)


@pytest.mark.parametrize(("eta", "damping"), [(0.0, 0.0), (0.01, 0.0), (0.0, 5e3)])
def test_quality_is_infinite_where_nothing_has_loss_and_only_there(eta, damping):
    found = band(Mounting((Gasket(1100.0, 10e6, 1e-4, 2e-3, eta),), 5e-3, 2e8, damping))
    assert math.isinf(found.quality) == (eta == damping == 0.0)
    assert (found.largest, found.largest_at) == (found.quality, found.resonance) or eta + damping > 0.0
    # of the gasket a third moves along
    natural = math.sqrt(5e5 / (5e-3 + 0.22e-3 / 3.0)) / (2.0 * math.pi)
    assert found.resonance == pytest.approx(natural, rel=0.01)


def test_a_mounting_too_soft_to_pass_10_hz_leaves_every_band_there():
    """|H| = 1/3 at twice its resonance and less above: looked at from 10 Hz on, it is largest there."""
    found = band(on_spring(5.0))
    assert (found.within_5, found.within_10, found.half_power) == (10.0, 10.0, 10.0)
    assert math.isnan(found.resonance)
    assert math.isnan(found.quality)
    assert (found.largest, found.largest_at) == (pytest.approx(1.0 / 3.0, rel=1e-12), 10.0)
