"""Shifts of pulses that were moved by a known time."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.signal.alignment import EvenHistory, are_opposite, by_correlation, by_onset, by_peak

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


def lobe(time, at):
    return np.cos(np.pi * np.clip((time - at) / 2e-4, -0.5, 0.5)) ** 2


def coloured(generator, size, step, corner):
    """Noise of deviation 1 that falls as 1 / f above a corner; of a ring twice as long, as its ends do not meet."""
    spectrum = np.fft.rfft(generator.normal(size=2 * size))
    found = np.fft.irfft(spectrum / np.hypot(1.0, np.fft.rfftfreq(2 * size, step) / corner), 2 * size)[:size]
    return found / np.std(found)


def errors_and_doubts(rate, sizes, draws, noise):
    """Of a pulse of 200 us with its noise in both histories, moved by 37.3 us, in s."""
    delay, (first, second) = 37.3e-6, (np.arange(size) / rate for size in sizes)
    shifts = [
        by_correlation(
            EvenHistory(lobe(first, 2e-4 + delay) + noise(first.size), 1.0 / rate, 0.0),
            EvenHistory(lobe(second, 2e-4) + noise(second.size), 1.0 / rate, 0.0),
        )
        for _ in range(draws)
    ]
    errors, doubts = np.array([(one.shift - delay, one.uncertainty) for one in shifts]).T
    return math.sqrt(np.mean(errors**2)), math.sqrt(np.mean(doubts**2))


@pytest.mark.verify
@pytest.mark.parametrize(
    ("rate", "span", "other", "draws"),
    [
        (2e5, 5e-4, 5e-4, 200),
        (1e6, 5e-4, 5e-4, 200),
        (1e6, 2e-2, 5e-4, 100),
        (5e6, 5e-4, 5e-4, 200),
        (5e7, 4e-4, 4e-4, 50),
    ],
)
def test_correlation_reaches_the_cramer_rao_bound_under_white_noise_at_any_sampling(rate, span, other, draws):
    """Bound: s sqrt(2) / sqrt(sum x'^2). 200, 100 and 50 draws tell a deviation within 5, 7 and 10 %: 2.5 times 10 %."""
    generator, deviation = np.random.default_rng(6), 0.01
    sizes = round(span * rate), round(other * rate)
    error, doubt = errors_and_doubts(rate, sizes, draws, lambda size: deviation * generator.normal(size=size))
    slope = np.gradient(lobe(np.arange(sizes[1]) / rate, 2e-4), 1.0 / rate)
    bound = deviation * math.sqrt(2.0 / np.sum(slope**2))
    assert error == pytest.approx(bound, rel=0.25)
    assert doubt == pytest.approx(error, rel=0.25)


@pytest.mark.parametrize("rate", [2e5, 5e6])
@pytest.mark.parametrize("corner", [2e3, 2e4])
def test_correlation_states_the_uncertainty_of_coloured_noise_too(rate, corner):
    """Few lines tell the spectrum of the noise: 30 %."""
    generator, size = np.random.default_rng(7), round(6e-4 * rate)
    error, doubt = errors_and_doubts(
        rate, (size, size), 100, lambda size: 0.01 * coloured(generator, size, 1.0 / rate, corner)
    )
    assert doubt == pytest.approx(error, rel=0.3)


def test_a_second_blow_in_one_of_them_leaves_the_least_squares_shift():
    """Coherence of neighbouring lines is then no longer 1; 0.01 samples."""
    time = np.arange(2000) * 1e-6
    one = EvenHistory(lobe(time, 5e-4), 1e-6, 0.0)
    two = EvenHistory(lobe(time, 6.0037e-4) + 0.5 * lobe(time, 1.4e-3), 1e-6, 0.0)
    assert by_correlation(two, one).shift == pytest.approx(1.0037e-4, abs=1e-8)


@pytest.mark.parametrize("rule", RULES)
def test_nothing_has_no_shift(rule):
    with pytest.raises(ValueError, match="zero throughout"):
        rule(EvenHistory(bell(np.arange(-10.0, 10.0), 3.0), 1.0, 0.0), EvenHistory(np.zeros(20), 1.0, 0.0))


def test_a_history_cut_above_its_onset_is_refused():
    with pytest.raises(ValueError, match="begins above 10 %"):
        by_onset(EvenHistory(np.linspace(1.0, 0.0, 40), 1.0, 0.0), EvenHistory(bell(np.arange(-50, 50), 9.0), 1.0, 0.0))


def test_times_of_a_history_run_from_its_start_to_its_end():
    one = EvenHistory(np.zeros(4), 0.5, 2.0)
    assert one.time.tolist() == [2.0, 2.5, 3.0, 3.5]
    assert one.end == 3.5


@pytest.mark.parametrize(("least", "opposite"), [(-1.5, True), (-1.15, True), (-1.05, False), (1.0, False)])
@pytest.mark.parametrize("step", [0.5, 1.0])
def test_signs_are_opposite_where_the_correlation_reaches_a_tenth_farther_below_zero(least, opposite, step):
    """One bell against two that are apart: the correlation is as high as the first and as low as the second."""
    one = history_of(np.arange(0.0, 60.0, step) - 30.0, 4.0, step)
    time = np.arange(300.0)
    two = EvenHistory(bell(time - 70.0, 4.0) + least * bell(time - 220.0, 4.0), 1.0, 0.0)
    assert are_opposite(one, two) is opposite
    assert are_opposite(two, one) is opposite


@pytest.mark.parametrize("cut", [0, 13])
def test_an_onset_on_a_straight_front_is_uncertain_by_noise_over_its_slope(cut):
    """Also where the history begins between a half and the whole of the share that is sought."""
    time = np.arange(400.0)
    ramp = np.interp(time, [10.0, 110.0, 210.0], [0.0, 1.0, 0.0])[10 + cut :]
    noisy, still = EvenHistory(ramp, 1e-3, 0.0, 0.02), EvenHistory(bell(time - 200.0, 40.0), 1e-3, 0.0)
    assert by_onset(noisy, still, 0.2).uncertainty == pytest.approx(0.02 * 100.0 * 1e-3, rel=1e-9)
    assert by_onset(noisy, noisy, 0.2).uncertainty == pytest.approx(math.sqrt(2.0) * 2e-3, rel=1e-9)
    assert by_onset(still, still).uncertainty == 0.0


@pytest.mark.parametrize(("noise", "doubt"), [(1e-5, 1e-5 * math.pi / math.sqrt(3.0) * 20000.0), (1e-2, 200.0**0.5)])
def test_a_peak_is_uncertain_by_the_lesser_of_both_estimates(noise, doubt):
    """A parabola of curvature 1 / 20 000: samples on it read its width at 80 % within 1e-4."""
    hill = np.maximum(1.0 - ((np.arange(601.0) - 300.25) / 200.0) ** 2, 0.0)
    found = by_peak(EvenHistory(hill, 2.0, 0.0, noise), EvenHistory(bell(np.arange(-99.0, 100.0), 20.0), 2.0, 0.0))
    assert found.uncertainty == pytest.approx(2.0 * doubt, rel=3e-4)
    assert found.shift == pytest.approx(
        2.0 * (300.25 - 99.0), abs=2e-3
    )  # a parabola through points 1/16 apart, of 1e-6 each


def test_a_tone_that_both_picked_up_beyond_a_gap_is_left_out_on_demand():
    """A bell holds nothing near the tone; between them each has noise of its own."""
    time, generator = np.arange(2000.0), np.random.default_rng(8)

    def seen(at, phase):
        tone = 0.02 * np.cos(2.0 * np.pi * 0.2 * time + phase)
        return EvenHistory(bell(time - at, 20.0) + tone + 1e-3 * generator.normal(size=time.size), 1.0, 0.0)

    one, two = seen(1003.3, 0.0), seen(1000.0, 2.0)
    assert by_correlation(one, two, to_gap=True).shift == pytest.approx(3.3, abs=0.02)
    assert abs(by_correlation(one, two).shift - 3.3) > 0.2


@pytest.mark.parametrize("shift", [-0.45, -0.2, 0.31, 0.5])
def test_a_correlation_of_few_samples_a_pulse_is_largest_where_its_bells_meet(shift):
    """Bells of two steps hold 5e-5 at half the sampling rate; a parabola through three samples would err by 1e-3."""
    time = np.arange(64.0)
    one, two = EvenHistory(bell(time - 30.0 - shift, 2.0), 1.0, 0.0), EvenHistory(bell(time - 25.0, 2.0), 1.0, 0.0)
    assert by_correlation(one, two).shift == pytest.approx(5.0 + shift, abs=1e-6)
