"""Shifts of pulses that were moved by a known time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.signal.alignment import EvenHistory, by_correlation, by_onset, by_peak

RULES = [by_correlation, by_onset, by_peak]


def bell(time, width):
    return np.exp(-((time / width) ** 2))


def history_of(time, width, step):
    return EvenHistory(bell(time, width), step, 0.0)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    st.floats(0.3e-6, 2e-6),
    st.floats(0.3e-6, 2e-6),
    st.floats(4.0, 20.0),
    st.floats(-1e-4, 1e-4),
    st.sampled_from([1, -1]),
)
def test_band_limited_pulses_are_aligned_within_a_hundredth_of_a_sample(first, second, samples, shift, sign):
    """A bell of four steps holds 1e-17 of its spectrum above half the sampling rate."""
    width = samples * max(first, second)
    a = EvenHistory(sign * bell((np.arange(600) - 300) * first - shift, width), first, -300 * first)
    b = EvenHistory(bell((np.arange(700) - 350) * second, width), second, 1.0 - 350 * second)
    for rule in RULES if sign > 0 else RULES[1:]:
        assert rule(a, b).shift + 1.0 == pytest.approx(shift, abs=0.01 * min(first, second)), rule.__name__


def test_a_long_coarse_record_is_aligned_with_a_short_fine_one_without_being_made_as_fine():
    """Steps of 5 us and 5 ns: 2 s of record at the finer one would be 4e8 samples."""
    coarse = history_of(np.arange(400_000) * 5e-6 - 1.0123456789, 5e-5, 5e-6)
    fine = history_of(np.arange(100_000) * 5e-9 - 2.5e-4, 5e-5, 5e-9)
    assert by_correlation(coarse, fine).shift == pytest.approx(1.0123456789 - 2.5e-4, abs=5e-9)


def test_a_history_is_aligned_with_itself_by_nothing():
    values = np.convolve(np.random.default_rng(3).normal(size=200), bell(np.arange(-20, 21), 5.0))
    one = EvenHistory(values, 1e-6, 0.5)
    for rule in RULES:
        assert abs(rule(one, one).shift) < 1e-12
        assert rule(one, one).uncertainty < 1e-12


@pytest.mark.parametrize("rule", RULES)
def test_stated_uncertainty_is_that_of_pulses_under_noise(rule):
    """100 draws tell a deviation within 7 %; the onset and the peak state theirs for a lone crossing and wiggle."""
    generator, time, deviation = np.random.default_rng(4), np.arange(600) * 1e-6, 0.01
    still = EvenHistory(bell(time - 2e-4, 2e-5), 1e-6, 0.0)
    found = [
        rule(EvenHistory(bell(time - 3e-4, 2e-5) + deviation * generator.normal(size=600), 1e-6, 0.0, deviation), still)
        for _ in range(100)
    ]
    scatter = np.std([one.shift for one in found])
    assert np.mean([one.shift for one in found]) == pytest.approx(1e-4, abs=0.4 * scatter)
    assert np.mean([one.uncertainty for one in found]) == pytest.approx(scatter, rel=0.5)


@pytest.mark.parametrize("rule", RULES)
def test_nothing_has_no_shift(rule):
    with pytest.raises(ValueError, match="zero throughout"):
        rule(EvenHistory(bell(np.arange(-10.0, 10.0), 3.0), 1.0, 0.0), EvenHistory(np.zeros(20), 1.0, 0.0))


def test_a_history_cut_above_its_onset_is_refused():
    with pytest.raises(ValueError, match="begins above 10 %"):
        by_onset(EvenHistory(np.linspace(1.0, 0.0, 40), 1.0, 0.0), EvenHistory(bell(np.arange(-50, 50), 9.0), 1.0, 0.0))
