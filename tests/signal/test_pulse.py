"""Pulse measures against closed forms of the half-sine, the triangle and the haversine."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from strikewave.signal import measure_pulse
from strikewave.signal import pulse as module
from strikewave.signal.pulse import area_between, crossing, foot_to_foot, front, largest, refine_peak


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


@given(place=st.floats(1.0, 7.0), height=st.floats(-5.0, 5.0), bend=st.floats(0.01, 10.0))
def test_a_parabola_has_its_own_vertex(place, height, bend):
    """From its first inner sample to its last one."""
    values = height - bend * (np.arange(9.0) - place) ** 2
    found = refine_peak(values, round(place))
    # differences of values up to 64 bends and 5 lose their last digits, which are divided by the bend
    assert found == pytest.approx((place, height), abs=1e-11)


@pytest.mark.parametrize(
    ("values", "index", "found"),
    [
        ([4.0, 3.0, 1.0], 0, (0.0, 4.0)),
        ([1.0, 3.0, 4.0], 2, (2.0, 4.0)),
        ([2.0, 2.0, 2.0], 1, (1.0, 2.0)),
        ([2.0, 2.0, 2.005], 1, (1.0, 2.0)),
        ([0.0, 2.0, 2.0], 1, (1.5, 2.25)),
    ],
)
def test_no_vertex_is_sought_at_an_end_or_where_three_samples_do_not_bend_down(values, index, found):
    assert refine_peak(np.array(values), index) == found


PEAKED = np.array([8.0, 0.0, 4.0, 10.0, 6.0, 1.0, 0.0, 9.0])


@pytest.mark.parametrize(
    ("level", "earlier", "later"),
    [(7.0, 2.5, 3.75), (4.0, 2.0, 4.4), (3.0, 1.75, 4.6), (0.5, 1.125, 5.5), (0.0, 1.0, 6.0), (10.0, 3.0, 3.0)],
)
def test_lines_between_samples_cross_a_level_where_they_do_by_hand(level, earlier, later):
    """The first crossing on each side counts; a sample that is not above the level is one by itself."""
    assert crossing(PEAKED, 3, level, -1) == pytest.approx(earlier, abs=1e-15)
    assert crossing(PEAKED, 3, level, 1) == pytest.approx(later, abs=1e-15)


def test_a_level_that_is_never_reached_is_crossed_nowhere():
    assert math.isnan(crossing(PEAKED, 3, -1.0, -1))
    assert math.isnan(crossing(PEAKED, 3, -1.0, 1))


@given(st.lists(st.integers(-9, 9), min_size=3, max_size=9), st.integers(0, 64), st.integers(0, 64))
@example([0, 4, 1, -3], 9, 14)  # both places within one interval, and in the last one
@example([0, 4, 1, -3], 17, 23)
def test_area_is_that_of_trapezoids_through_all_corners(values, one, other):
    """Within one interval, from sample to sample, up to the last one; places in eighths are exact."""
    last = len(values) - 1
    low, high = sorted(min(place / 8.0, float(last)) for place in (one, other))
    corners = np.unique(np.concatenate([[low, high], np.arange(math.ceil(low), math.floor(high) + 1.0)]))
    wanted = np.trapezoid(np.interp(corners, np.arange(last + 1.0), values), corners)
    assert area_between(np.array(values, dtype=float), low, high) == pytest.approx(wanted, abs=1e-12)


def test_an_uneven_triangle_is_measured_as_by_hand():
    """Rising by 10 a sample to 40, falling by 20: the vertex through 30, 40, 20 stands 1/6 earlier and 5/12 higher."""
    values = np.array([0.0, 0.0, 10.0, 20.0, 30.0, 40.0, 20.0, 0.0, 0.0])
    found, peak = measure_pulse(values, 0.5, start=3.0, fraction=0.2), 40.0 + 5.0 / 12.0
    assert found.peak == pytest.approx(peak, rel=1e-15)
    assert found.time == pytest.approx(3.0 + 0.5 * (5.0 - 1.0 / 6.0), rel=1e-15)
    level = 0.2 * peak
    assert found.width == pytest.approx(0.5 * (6.0 - level / 10.0 - level / 20.0), rel=1e-14)
    assert found.rise == pytest.approx(0.5 * 0.8 * peak / 10.0, rel=1e-14)
    # a triangle of base 6 without one below the level on either side
    assert found.area == pytest.approx(0.5 * (120.0 - level**2 / 20.0 - level**2 / 40.0), rel=1e-14)


def test_a_pulse_cut_at_an_end_has_no_width_and_the_area_of_what_is_there():
    begun = measure_pulse(np.array([3.0, 4.0, 2.0, 0.0]), 2.0, fraction=0.25)
    ended = measure_pulse(np.array([0.0, 2.0, 4.0, 3.0]), 2.0, fraction=0.25)
    assert math.isnan(begun.width)
    assert math.isnan(begun.rise)
    assert math.isnan(ended.width)
    # 3, 4, 2 have their vertex 1/6 before the 4, at 4 + 1/24; 2, 4, 3 behind it: a quarter is left out at the foot
    level = 0.25 * (4.0 + 1.0 / 24.0)
    for one in (begun, ended):
        assert one.peak == pytest.approx(4.0 + 1.0 / 24.0, rel=1e-15)
        assert one.area == pytest.approx(2.0 * (7.5 - 0.25 * level**2), rel=1e-14)


def test_three_samples_are_a_pulse_however_small():
    assert measure_pulse(np.array([0.0, 1e-3, 0.0]), 1.0).peak == 1e-3


@pytest.mark.parametrize(
    ("values", "area"),
    [
        # feet at 2 % of the peak, 100: 2 / 50 of a sample from zero, and 2 / 2 / 50 of area there
        ([0.0, 50.0, 100.0, 50.0, 0.0, 0.0, 9.0, 9.0], 200.0 - 0.08),
        # stays on 10: over at 12, of which the next sample is the fifth
        ([0.0, 50.0, 100.0, 50.0, 10.0, 10.0, 10.0, 10.0], 205.0 - 0.04),
        # the same, by a step on 11, which is below 12 too: the foot is 2 % of the peak above what it settles on
        ([0.0, 50.0, 100.0, 50.0, 11.0, 10.0, 10.0, 10.0], 205.5 - 0.04),
        # ends while it falls: all counts
        ([0.0, 50.0, 100.0, 50.0], 175.0 - 0.04),
        # begins above its foot
        ([50.0, 100.0, 50.0, 0.0, 0.0], 175.0 - 0.04),
    ],
)
def test_area_from_foot_to_foot_by_hand(values, area):
    assert foot_to_foot(np.array(values), 1e-3) == pytest.approx(1e-3 * area, rel=1e-14)


def test_the_value_farthest_from_zero_keeps_its_sign():
    assert largest(np.array([np.nan, 2.0, -3.0, 2.5, -np.inf])) == -3.0
    assert largest(np.array([-1.0, 4.0, 3.0])) == 4.0
    assert math.isnan(largest(np.array([np.nan])))


@pytest.mark.parametrize(
    ("values", "steps"),
    [
        ([0.0, 1e-3, 2e-3, 1e-3, 0.0], 3.6),  # a tenth of the peak is crossed at 0.2 and at 3.8
        ([0.0, -1.0, -2.0, -1.0, 0.0], 3.6),
        ([0.0, 10.0, 10.0, 10.0, 0.0, 9.0], 3.8),
        ([9.0, 10.0, 0.0], 1.9),
        ([0.0, 10.0, 9.0], 2.9),
        (np.ones(10), 10.0),  # never below: each sample counts for a step
    ],
)
def test_a_front_lasts_0_8_of_its_time_above_a_tenth(values, steps):
    assert front(np.array(values), 2.0) == pytest.approx(0.8 * 2.0 * steps, rel=1e-14)


def test_nothing_has_no_front():
    assert front(np.zeros(5), 1.0) == math.inf


def test_a_half_sine_of_the_fewest_intervals_loses_1_2_percent_of_its_peak():
    """Its top lies in the middle between two samples: cos(pi / 20)."""
    places = (np.arange(module.FEWEST_INTERVALS) + 0.5) / module.FEWEST_INTERVALS
    assert 1.0 - np.sin(np.pi * places).max() == pytest.approx(0.0123, abs=5e-5)
