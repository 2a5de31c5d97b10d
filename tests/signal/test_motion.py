"""Velocity and displacement by integration: closed forms, the way back, and drift against drawn noise."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.signal.motion import motion, zero_before


def test_half_sine_moves_its_base_by_its_closed_forms():
    """v = A T/pi (1 - cos), d = A T/pi (t - T/pi sin): 2 A T/pi and A T^2/pi at the end."""
    A, T, n = 500.0, 2e-3, 2000
    t = np.linspace(0.0, T, n + 1)
    found = motion(A * np.sin(math.pi * t / T), T / n)
    # straight lines lose (pi/n)^2/12 of the area: 2e-7
    assert found.velocity == pytest.approx(A * T / math.pi * (1 - np.cos(math.pi * t / T)), rel=3e-7, abs=1e-9)
    wanted = A * T / math.pi * (t - T / math.pi * np.sin(math.pi * t / T))
    assert found.displacement == pytest.approx(wanted, rel=1e-6, abs=1e-12)


@given(st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=40), st.floats(1e-6, 1.0))
def test_integrals_come_back(values, step):
    """Within a step v is a parabola and d a cubic: its ends give the acceleration back."""
    a, found = np.array(values), motion(values, step)
    size = max(1.0, float(np.max(np.abs(a))))
    assert np.diff(found.velocity) / step == pytest.approx(0.5 * (a[1:] + a[:-1]), abs=1e-9 * size * a.size)
    # d_1 - d_0 = h (v_0 + v_1)/2 + h^2 (a_0 - a_1)/12, the corrected trapezoid
    mean = 0.5 * (found.velocity[1:] + found.velocity[:-1]) * step
    back = np.diff(found.displacement) - mean
    assert back == pytest.approx(step**2 * (a[:-1] - a[1:]) / 12.0, abs=1e-9 * size * a.size**2 * step**2)


def test_drift_is_what_drawn_zeros_and_noise_do():
    draws, size, step, u, sigma = 3000, 400, 1e-3, 0.02, 0.5
    rng = np.random.default_rng(5)
    ends = [motion(u * rng.normal() + sigma * rng.normal(size=size), step)[:2] for _ in range(draws)]
    velocities, displacements = (np.array([end[k][-1] for end in ends]) for k in (0, 1))
    told = motion(np.zeros(size), step, u, sigma)
    # a standard deviation of 3000 draws is good to 1/sqrt(6000) = 1.3 %; four of them
    assert np.std(velocities) == pytest.approx(told.velocity_drift[-1], rel=0.052)
    assert np.std(displacements) == pytest.approx(told.displacement_drift[-1], rel=0.052)


@pytest.mark.parametrize(
    "bad", [{"step": 0.0}, {"step": math.nan}, {"zero_error": -1.0}, {"noise": math.inf}, {"values": [1.0]},
            {"values": [1.0, math.nan]}]
)  # fmt: skip
def test_what_makes_no_sense_is_refused(bad):
    with pytest.raises(ValueError, match="a motion needs"):
        motion(**{"values": [0.0, 1.0], "step": 1.0, **bad})


def test_drift_of_noise_is_that_of_the_weights_of_each_sample():
    """Independent samples add by their squares; that the first and the last count half leaves 1.5 samples of 1000."""
    size, step = 1000, 1e-3
    ends = [motion(row, step)[:2] for row in np.eye(size)]
    told = motion(np.zeros(size), step, 0.0, 0.5)
    for k, drift in enumerate(told[2:]):
        weights = np.array([end[k][-1] for end in ends])
        assert 0.5 * math.sqrt(np.sum(weights**2)) == pytest.approx(drift[-1], rel=2e-3)


def test_drift_of_a_zero_is_the_motion_under_it_and_both_kinds_add_by_squares():
    off, noisy, both = (motion(np.zeros(50), 0.1, *of) for of in ((0.3, 0.0), (0.0, 0.2), (0.3, 0.2)))
    moved = motion(np.full(50, 0.3), 0.1)
    assert off.velocity_drift == pytest.approx(moved.velocity, rel=1e-12)
    assert off.displacement_drift == pytest.approx(moved.displacement, rel=1e-12)
    for k in (2, 3):
        assert both[k] ** 2 == pytest.approx(off[k] ** 2 + noisy[k] ** 2, rel=1e-12)


def test_two_samples_are_a_motion():
    """6 and 12 m/s^2 over 2 s: 18 m/s, and 4/6 (2 x 6 + 12) m."""
    found = motion([6.0, 12.0], 2.0)
    assert found.velocity.tolist() == [0.0, 18.0]
    assert found.displacement.tolist() == pytest.approx([0.0, 16.0], rel=1e-15)


@pytest.mark.parametrize(
    ("touch", "values", "zero"),
    [
        (0.0, [-9.8, -9.7, 40.0], -9.7),  # the instant of the touch is before the blow
        (0.5, [-9.8, -9.7, 40.0], -9.7),
        (1.0, [-9.8, -9.7, 40.0], 40.0),
        (-1.0, [-9.8, -9.7, 40.0], -9.8),
        (-1.5, [-9.8, -9.7, 40.0], 0.0),  # nothing is known
        (0.0, [-9.8, math.nan, 40.0], 0.0),
    ],
)
def test_the_last_value_not_after_the_touch_is_zero(touch, values, zero):
    assert zero_before([-1.0, 0.0, 1.0], values, touch) == zero
