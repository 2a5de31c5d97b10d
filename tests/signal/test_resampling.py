"""Band-limited interpolation against the functions that were sampled."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.signal.interpolation import ERROR, FLAT, resampled, share_above


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
