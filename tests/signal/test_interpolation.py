"""Band-limited interpolation against the functions that were sampled."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from strikewave.signal.interpolation import ERROR, FLAT, monotone_cubic, resampled, share_above


def test_samples_are_kept_bit_for_bit():
    values = np.random.default_rng(1).normal(size=300)
    assert np.array_equal(resampled(values, np.arange(300.0)), values)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.floats(0.0, FLAT), st.floats(0.0, 6.28))
def test_a_tone_within_the_flat_band_is_met_between_its_samples(frequency, phase):
    """Far from both ends, where the history is held."""
    places = np.random.default_rng(2).uniform(100.0, 400.0, 200)
    tone = np.cos(2.0 * np.pi * frequency * np.arange(500) + phase)
    error = resampled(tone, places) - np.cos(2.0 * np.pi * frequency * places + phase)
    assert np.abs(error).max() < 5.0 * ERROR  # the largest of 200 places and two sides of the band


def test_a_constant_stays_one_up_to_its_ends_and_beyond_there_is_nothing():
    found = resampled(np.full(50, 7.0), [-0.1, 0.0, 0.3, 48.9, 49.0, 49.1])
    assert np.allclose(found[1:5], 7.0, rtol=1e-14)
    assert np.isnan(found[[0, 5]]).all()


def test_what_longer_steps_cannot_hold_is_taken_off():
    """0.2 of the sampling rate is above half of a third of it, and 0.05 below."""
    places = np.arange(40.0, 360.0) * 3.0
    time = np.arange(1200)
    left = resampled(np.cos(2.0 * np.pi * 0.2 * time) + np.cos(2.0 * np.pi * 0.05 * time), places, 3.0)
    assert np.abs(left - np.cos(2.0 * np.pi * 0.05 * places)).max() < 1e-5


@pytest.mark.parametrize("values", [[], [1.0, np.nan], [[1.0, 2.0]]])
def test_what_is_no_history_is_refused(values):
    with pytest.raises(ValueError, match="finite samples"):
        resampled(values, [0.0])


def test_the_share_above_a_frequency_is_that_of_the_parts_of_a_sum():
    time = np.arange(2000) * 1e-6
    both = 5.0 * np.sin(2e5 * np.pi * time) + 12.0 * np.cos(4e4 * np.pi * time)
    assert share_above(both, 1e-6, 60e3) == pytest.approx(5.0 / 13.0, rel=1e-9)
    assert share_above(both, 1e-6, 1e3) == pytest.approx(1.0)
    assert share_above(np.zeros(8), 1.0, 0.1) == 0.0


@pytest.mark.parametrize("size", [2, 8, 100])
@pytest.mark.parametrize("scale", [1.0, 1e-4])
def test_offset_and_fastest_swing_count_once_in_the_share(size, scale):
    """3 and 4 (-1)^k: root mean squares 3 and 4 of 5; both lines of the spectrum have no second side."""
    swing = 4.0 * (-1.0) ** np.arange(size)
    assert share_above(scale * (3.0 + swing), 1.0, 0.3) == pytest.approx(0.8, rel=1e-12)


@pytest.mark.parametrize("size", [9, 12])
def test_a_tone_beside_an_offset_has_the_share_of_its_root_mean_square(size):
    """Of an odd number of samples the fastest line has a second side, as any other."""
    if size % 2:
        fastest = 4.0 * np.sqrt(2.0) * np.cos(2.0 * np.pi * (size // 2) / size * np.arange(size))
        assert share_above(3.0 + fastest, 0.5, 0.1) == pytest.approx(0.8, rel=1e-12)
    tone = 4.0 * np.sqrt(2.0) * np.cos(2.0 * np.pi * np.arange(size) / 3.0)
    assert share_above(3.0 + tone, 0.5, 0.1) == pytest.approx(0.8, rel=1e-12)


def test_the_stated_error_is_that_at_the_end_of_the_flat_band():
    """Of both quadratures, at the worst place; twice as good would be stated so."""
    places = np.linspace(250.0, 251.0, 41)
    turn = 2.0j * np.pi * FLAT
    found = [
        resampled(part(turn * np.arange(500)), places) for part in (lambda a: np.exp(a).real, lambda a: np.exp(a).imag)
    ]
    worst = np.abs(found[0] + 1j * found[1] - np.exp(turn * places)).max()
    assert 0.5 * ERROR < worst < 2.5 * ERROR


def test_within_a_billionth_of_a_sample_the_sample_itself_is_taken():
    values = np.random.default_rng(4).normal(size=80)
    for place in (3.0, 40.0):
        near = resampled(values, place + np.array([-1.5e-9, -0.8e-9, 0.8e-9, 1.5e-9]))
        assert (near == values[int(place)]).tolist() == [False, True, True, False]
        assert near == pytest.approx(values[int(place)], abs=1e-7)
    ends = resampled(values, [-0.8e-9, -1.5e-9, 79.0 + 0.8e-9, 79.0 + 1.5e-9])
    assert ends[[0, 2]].tolist() == [values[0], values[-1]]
    assert np.isnan(ends[[1, 3]]).all()


def test_places_and_their_mirror_images_have_the_same_values():
    """Near ends too, and for longer steps; that a place within a step is counted from the sample before it shows in the
    outermost weights alone, of 1e-6."""
    values = np.random.default_rng(5).normal(size=90)
    places = np.random.default_rng(6).uniform(0.0, 89.0, 40)
    for factor in (1.0, 1.7):
        mirrored = resampled(values[::-1], 89.0 - places, factor)
        assert resampled(values, places, factor) == pytest.approx(mirrored, abs=5e-6)


@pytest.mark.parametrize("seed", range(20))
def test_values_and_slopes_are_those_of_scipy_to_the_last_bit(seed):
    """Steps, plateaus, extremes, jumps, few samples, times before and after the samples."""
    source = np.random.default_rng(seed)
    count = int(source.integers(2, 40))
    times = np.cumsum(source.uniform(0.1, 1.0, count) ** 4)
    values = source.choice(
        [source.normal(size=count), np.round(source.normal(size=count)), np.cumsum(source.exponential(size=count))]
    )
    at = np.concatenate([times, source.uniform(times[0] - 0.1, times[-1] + 0.1, 500)])
    ours, theirs = monotone_cubic(times, values), PchipInterpolator(times, values)
    assert np.array_equal(ours(at), theirs(at))
    assert np.array_equal(ours.derivative()(at), theirs.derivative()(at))


def test_no_value_lies_beyond_the_samples_beside_it():
    times, values = np.arange(12.0), np.random.default_rng(3).normal(size=12)
    at = np.linspace(0.0, 11.0, 2201)
    left = np.minimum(at.astype(int), 10)
    low, high = np.minimum(values[left], values[left + 1]), np.maximum(values[left], values[left + 1])
    found = monotone_cubic(times, values)(at)
    assert np.all(found >= low - 1e-12)  # rounding of values of size 1
    assert np.all(found <= high + 1e-12)


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, np.nan], [0.0, 2.0, 1.0], [0.0, 1.0, 1.0]])
def test_times_that_do_not_increase_are_refused(times):
    with pytest.raises(ValueError, match="increasing"):
        monotone_cubic(np.array(times), np.zeros(len(times)))


@pytest.mark.parametrize(("times", "values"), [([1.0, 3.0], [5.0, 2.0]), ([1.0, 3.0, 3.5], [5.0, 2.0, 9.0])])
def test_two_samples_make_a_line_and_three_what_scipy_makes_of_them(times, values):
    at = np.array([0.5, 1.0, 2.5, 3.0, 3.7])
    ours, theirs = monotone_cubic(np.array(times), np.array(values)), PchipInterpolator(times, values)
    assert np.array_equal(ours(at), theirs(at))
    if len(times) == 2:
        assert ours(at).tolist() == (5.0 - 1.5 * (at - 1.0)).tolist()


@pytest.mark.parametrize("last", [-2.9, -2.99, -3.01, -3.04, -4.5])
def test_slopes_at_an_end_before_a_turn_are_three_secants_at_most(last):
    """Steps of 1: the parabola's slope is (3 s - t)/2, above 3 s from t = -3 s on."""
    times, values = np.arange(4.0), np.array([0.0, 1.0, 1.0 + last, 7.0])
    for sign in (1.0, -1.0):
        ours, theirs = monotone_cubic(times, sign * values), PchipInterpolator(times, sign * values)
        assert ours.derivative()(times[:1]) == theirs.derivative()(times[:1])
        assert ours.derivative()(times[:1]) == sign * min(1.5 - 0.5 * last, 3.0)
