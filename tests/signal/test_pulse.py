"""Pulse measures against closed forms of the half-sine, the triangle and the haversine."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.signal import measure_pulse


def test_half_sine_changes_velocity_by_two_a_t_over_pi():
    peak, duration = 4000 * 9.80665, 200e-6
    t = np.arange(-400, 1601) * 0.25e-6
    values = np.where((t > 0) & (t < duration), peak * np.sin(np.pi * t / duration), 0.0)
    pulse = measure_pulse(values, 0.25e-6, t[0])
    assert pulse.peak == pytest.approx(peak, rel=1e-9)
    assert pulse.time == pytest.approx(duration / 2, rel=1e-9)
    cut = math.asin(0.1) / math.pi
    assert pulse.width == pytest.approx(duration * (1 - 2 * cut), rel=1e-6)
    assert pulse.rise == pytest.approx(duration * (math.asin(0.9) - math.asin(0.1)) / math.pi, rel=1e-5)
    # the area above the width leaves out the two ends: cos(asin 0.1) = sqrt(0.99)
    # trapezoids on 800 intervals are pi^2/(12 800^2) low
    assert pulse.area == pytest.approx(2 * peak * duration / math.pi * math.sqrt(0.99), rel=2e-6)


def test_haversine_width():
    t = np.linspace(0, 1, 4001)
    pulse = measure_pulse(np.sin(np.pi * t) ** 2, t[1])
    assert pulse.width == pytest.approx(1 - 2 * math.asin(math.sqrt(0.1)) / math.pi, rel=1e-6)


@given(st.floats(0.1, 0.9), st.floats(0.2, 0.8))
def test_triangle_width_is_linear_in_the_level(fraction, corner):
    t = np.linspace(0, 1, 1001)
    values = np.where(t < corner, t / corner, (1 - t) / (1 - corner))
    pulse = measure_pulse(values, t[1], fraction=fraction)
    # the peak between samples is at most one sample's slope low
    assert pulse.width == pytest.approx(1 - fraction, abs=0.01)


@given(scale=st.floats(1e-6, 1e6), step=st.floats(1e-9, 1.0), start=st.floats(-1, 1))
def test_measures_scale_with_height_and_time(scale, step, start):
    values = np.sin(np.linspace(0, np.pi, 101))
    one = measure_pulse(values, 1.0)
    other = measure_pulse(scale * values, step, start)
    assert other.peak == pytest.approx(scale * one.peak, rel=1e-12)
    assert other.width == pytest.approx(step * one.width, rel=1e-9)
    assert other.area == pytest.approx(scale * step * one.area, rel=1e-9)


@pytest.mark.parametrize(
    "values", [np.zeros(5), np.array([1.0, np.nan, 2.0]), np.ones(2), -np.ones(9), np.ones((3, 3))]
)
def test_what_holds_no_pulse_is_refused(values):
    with pytest.raises(ValueError, match=r"pulse|finite|positive"):
        measure_pulse(values, 1.0)
