"""Ideal pulses: their widths and velocity changes against the integrals and against published rows."""

import math

import numpy as np
import pytest

from strikewave.specifications.ideal_pulses import SHAPES, IdealPulse, from_width
from strikewave.specifications.reading import load_specification, read_built_in

GRAVITY = 9.80665


def pulse_of(shape):
    return IdealPulse(shape, 500.0, 2e-3, 0.15, 0.25)


@pytest.mark.parametrize("shape", SHAPES)
def test_velocity_change_is_the_integral(shape):
    time = np.linspace(-1e-3, 3e-3, 400_001)
    # trapezoidal rule: one step of 10 ns at a jump of 500 is 2.5e-6 of 0.5 m/s, the largest error
    assert np.trapezoid(pulse_of(shape).at(time), time) == pytest.approx(pulse_of(shape).velocity_change, rel=1e-5)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("level", [0.02, 0.1, 0.5, 0.9])
def test_width_is_the_time_above_a_share_of_the_peak(shape, level):
    time = np.linspace(0.0, 2e-3, 200_001)
    above = np.count_nonzero(pulse_of(shape).at(time) >= level * 500.0) * (time[1] - time[0])
    assert above == pytest.approx(pulse_of(shape).width(level), abs=3e-8)  # three samples


def test_t10_of_a_half_sine_is_0_936_of_its_duration():
    assert IdealPulse("half-sine", 1.0, 1.0).width(0.1) == pytest.approx(0.936, abs=5e-4)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_pulse_of_a_stated_width_has_it(shape):
    assert from_width(shape, 1.0, 1e-3, 0.1, 0.2, 0.2).width(0.1) == pytest.approx(1e-3, rel=1e-12)


@pytest.mark.parametrize("condition", read_built_in("jesd22-b110")[0].condition, ids=lambda row: row.name)
def test_velocity_change_and_drop_height_of_every_row_of_jesd22_b110_follow_from_peak_and_duration(condition):
    """v = 2 A D / pi and h = v^2 / 2 g: the printed digits leave 1 %."""
    pulse = load_specification(f"jesd22-b110:{condition.name}").pulse
    speed = 2.0 * pulse.peak * pulse.duration / math.pi
    assert pulse.velocity_change == pytest.approx(speed, rel=1e-12)
    assert condition.velocity_change.si == pytest.approx(speed, rel=0.01)
    assert condition.drop_height.si == pytest.approx(speed**2 / (2.0 * GRAVITY), rel=0.01)


@pytest.mark.parametrize("condition", read_built_in("iec-60068-2-27-bump")[0].condition, ids=lambda row: row.name)
def test_velocity_change_of_every_bump_follows_from_peak_and_duration(condition):
    pulse = load_specification(f"iec-60068-2-27-bump:{condition.name}").pulse
    assert condition.velocity_change.si == pytest.approx(pulse.velocity_change, abs=0.055)  # printed to 0.1 m/s


@pytest.mark.parametrize(
    ("shape", "values", "top"),
    [
        ("half-sine", [0.0, 0.0, 250.0, 500.0, 250.0 * 2**0.5, 0.0, 0.0], (1.0, 1.0)),
        ("sawtooth", [0.0, 0.0, 500.0 / 6.0, 250.0, 375.0, 500.0, 0.0], (2.0, 2.0)),
        ("trapezoid", [0.0, 0.0, 500.0 / 1.5, 500.0, 500.0, 0.0, 0.0], (0.5, 1.5)),
    ],
)
def test_a_pulse_of_2_s_has_the_values_of_its_lines(shape, values, top):
    pulse = IdealPulse(shape, 500.0, 2.0, 0.25, 0.25)
    time = [-0.001, 0.0, 1.0 / 3.0, 1.0, 1.5, 2.0, 2.001]
    assert pulse.at(time) == pytest.approx(values, abs=1e-10)
    assert pulse.top == top


def test_a_trapezoid_is_wide_by_its_own_slopes():
    pulse = IdealPulse("trapezoid", 4.0, 10.0, 0.1, 0.3)
    assert (pulse.width(0.5), pulse.velocity_change) == (pytest.approx(8.0), pytest.approx(32.0))
    assert pulse.at([0.5, 1.0, 7.0, 8.5, 10.0]) == pytest.approx([2.0, 4.0, 4.0, 2.0, 0.0])
    assert from_width("trapezoid", 4.0, 8.0, 0.5, 0.1, 0.3).duration == pytest.approx(10.0)
