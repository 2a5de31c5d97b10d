"""Shifts of pulses that were moved by a known time."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.signal.alignment import (
    EvenHistory,
    _at_step,
    _coherent,
    _steepened,
    _vertex,
    are_opposite,
    by_correlation,
    by_onset,
    by_peak,
)

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
    ramp = np.interp(time, [10.0, 110.0, 310.0], [0.0, 1.0, 0.0])[10 + cut :]
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


def bands(*coherences, lines=8):
    """Return two spectra that have a coherence in each band of so many lines, the first ones louder."""
    even, odd = np.ones(lines), (-1.0) ** np.arange(lines)
    first = [(len(coherences) - k) * even for k in range(len(coherences))]
    second = [np.exp(0.3j) * (math.sqrt(c) * even + math.sqrt(1.0 - c) * odd) for c in coherences]
    return np.concatenate(first).astype(complex), np.concatenate(second)


@pytest.mark.parametrize(
    ("coherences", "last", "gap"),
    [
        ((1.0, 1.0, 1.0), 24, 24),
        ((1.0, 0.0, 1.0, 0.0), 24, 8),
        ((0.0, 1.0, 1.0, 0.0, 0.0, 0.7, 0.0), 48, 24),
        # noise reaches 1 - 1e-3^(1/7) = 0.6272 of 8 lines with a probability of 1e-3
        ((1.0, 0.6275, 0.6, 0.0), 16, 16),
        ((1.0, 0.627, 0.0), 8, 8),
        ((0.0, 0.0, 0.1, 0.0), 24, 24),  # the strongest is always alike
        ((0.3,), 8, 8),
    ],
)
@pytest.mark.parametrize("spacing", [1, 3])
def test_two_spectra_are_alike_up_to_the_last_coherent_band(coherences, last, gap, spacing):
    """The last band takes what is left of a whole one, which noise fills; padding puts lines a spacing apart."""
    one, two = bands(*coherences, lines=8 * spacing)
    one, two = (np.concatenate([x, np.full(5, filled)]) for x, filled in ((one, 1e-9), (two, 1e-9)))
    size = one.size
    expected = [size if found == 8 * len(coherences) else found * spacing for found in (last, gap)]
    assert [_coherent(one, two, spacing, to_gap) for to_gap in (False, True)] == expected
    assert [_coherent(1e-3 * one, 1e-4 * two, spacing, to_gap) for to_gap in (False, True)] == expected


@pytest.mark.parametrize(("coherence", "alike"), [(0.26, True), (0.24, False)])
def test_a_band_of_many_lines_needs_a_quarter(coherence, alike):
    """Bands are a tenth of their frequency wide, from 80 lines on: of 26 and more noise
    reaches a quarter with less than 1e-3."""
    edges = [0]
    while edges[-1] < 500:
        edges.append(edges[-1] + max(8, math.ceil(0.1 * edges[-1])))
    begin, end = next((a, b) for a, b in pairwise(edges) if b - a >= 26 and (b - a) % 2 == 0)
    one, two = np.zeros(500, complex), np.zeros(500, complex)
    one[:8], two[:8] = 3.0, 3.0
    one[begin:end], two[begin:end] = bands(coherence, lines=end - begin)
    assert _coherent(one, two, 1.0, False) == (end if alike else 8)


@pytest.mark.parametrize("place", [0, 1, 5, 11])
def test_the_vertex_of_a_parabola_is_found_on_a_ring(place):
    """Also across its ends; where three do not bend down, the middle one."""
    ring = np.roll([7.0, 9.0, 6.0, *[0.0] * 9], place - 1)
    assert _vertex(ring, place) == pytest.approx(-0.1, rel=1e-14)  # (6 - 7) / 2 over 2 x 9 - 7 - 6
    assert _vertex(-ring, place) == 0.0
    assert _vertex(np.zeros(12), place) == 0.0


@pytest.mark.parametrize(
    ("begun", "found"),
    [(0.0, 0.0), (0.4, 0.0), (-0.9, 0.0), (0.99, 0.0), (1.005, 1.005), (1.2, 1.2), (-1.6, -1.6), (4.0, 4.0)],
)
def test_the_largest_correlation_is_sought_within_a_sample(begun, found):
    """Of waves of 12 and of 30 samples that meet at 7.3; farther off, and where it bends up, the place stays."""
    omega = np.array([0.0, 2.0 * math.pi / 12.0, 2.0 * math.pi / 30.0])
    both = np.array([5.0, 2.0, 1.0]) * np.exp(-7.3j * omega)
    for unit in (1e-4, 1.0):
        assert _steepened(unit * both, omega, 7.3 + begun) == pytest.approx(7.3 + found, abs=1e-9)


@pytest.mark.parametrize(
    ("sizes", "place"),
    [((900, 700), 300), ((900, 1500), 150), ((900, 1300), -600), ((1300, 800), -200), ((600, 1000), 0)],
)
def test_an_impulse_beside_a_pulse_counts_as_white_noise_of_its_energy(sizes, place):
    """Of n samples that both hold, e^2/n is its variance; the bell has the sum b'^2 = sqrt(pi/2)/w, and of the noise
    the shift takes up 3 sqrt(pi)/4 w/n. 1e-4: the impulse ends where the bell has ended, in its spectrum."""
    begin, end = max(place + 1, 0), min(place + sizes[1], sizes[0])  # a shift of 0.4 more than whole samples
    n, width, step, impulse = end - begin, 15.0, 2e-6, 3e-3
    values = bell(np.arange(sizes[0]) - begin - 0.3 * n, width)
    values[begin + round(0.75 * n)] += impulse
    other = EvenHistory(bell(np.arange(sizes[1]) - (begin + 0.3 * n - place - 0.4), width), step, 0.0)
    found = by_correlation(EvenHistory(values, step, 1.0), other)
    taken_up = 0.75 * math.sqrt(math.pi) * width / n
    bound = impulse / math.sqrt(n * math.sqrt(math.pi / 2.0) / width * (1.0 - taken_up))
    assert found.shift == pytest.approx(1.0 + (place + 0.4) * step, abs=1e-6 * step)
    assert found.uncertainty == pytest.approx(bound * step, rel=1e-4, abs=0.0)


@pytest.mark.parametrize(
    ("steps", "taken"), [((1.0, 1.5), "1"), ((3.0, 1.0), "1.5"), ((1.0, 4.0), "2"), ((2.0, 2.0), "2")]
)
def test_histories_are_brought_to_the_finer_step_or_to_half_the_coarser_one(steps, taken):
    one, two = (EvenHistory(bell(step * np.arange(300.0) - 150.0, 20.0), step, 0.0) for step in steps)
    found = by_correlation(one, two)
    assert found.rule.endswith(f" of {taken} s")
    assert found.shift == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(("step", "count"), [(0.5, 19), (1.0, 10), (2.0, 5), (3.0, 4), (4.5, 3), (4.6, 2), (9.1, 1)])
def test_a_history_at_another_step_has_as_many_samples_as_lie_in_it(step, count):
    """Ten samples last nine steps. A step that is the same but for rounding leaves it as it is."""
    time = np.arange(10.0)
    one = EvenHistory(np.full(10, 3.0), 1.0, 0.0)
    assert _at_step(one, step).tolist() == pytest.approx([3.0] * count, rel=1e-12)
    assert (_at_step(one, step) is one.values) is (step == 1.0)
    fine = _at_step(EvenHistory(time, 1.0, 0.0), 0.5)
    assert fine[::2].tolist() == time.tolist()
    assert _at_step(EvenHistory(np.zeros(500), 1.0, 0.0), 0.5).size == 999
    tone = EvenHistory(np.cos(0.6 * np.pi * np.arange(400.0)), 1.0, 0.0)  # which three steps cannot hold
    assert np.abs(_at_step(tone, 3.0)[40:90]).max() < 1e-3
    assert _at_step(one, 1.0 + 0.9e-9) is one.values
    assert _at_step(one, 1.0 + 1.2e-9) is not one.values


def test_an_onset_and_a_peak_of_bells_lie_where_their_closed_forms_put_them():
    """A tenth of the peak is crossed sqrt(ln 10) widths before it. Lines between points 1/16 apart leave 1e-4 samples of
    bells of 12 and 31 steps, parabolas less; a smaller pulse long before it does not count,
    though it passes the share."""
    time = np.arange(500.0)
    one = EvenHistory(-2.0 * bell(time - 203.37, 12.0) - 0.5 * bell(time - 60.0, 9.0), 2.0, 30.0)
    two = EvenHistory(bell(time - 250.81, 31.0), 0.5, -7.0)
    peaks = (30.0 + 2.0 * 203.37) - (-7.0 + 0.5 * 250.81)
    assert by_peak(one, two).shift == pytest.approx(peaks, abs=2e-4)
    for share in (0.1, 0.4):
        earlier = 2.0 * 12.0 - 0.5 * 31.0
        found = by_onset(one, two, share)
        assert found.shift == pytest.approx(peaks - earlier * math.sqrt(-math.log(share)), abs=4e-4)
        assert found.rule == f"first crossings of {100 * share:g} % of the peaks"


@pytest.mark.parametrize(("cut", "error"), [(3, 0.2), (20, 1e-3)])
def test_a_peak_near_an_end_is_found_among_what_is_there(cut, error):
    """Three samples on either side are looked at where there are so many; what is held beyond an end bends the last."""
    whole = bell(np.arange(200.0) - 100.25, 8.0)
    still = EvenHistory(whole, 1.0, 0.0)
    assert by_peak(EvenHistory(whole[: 100 + cut], 1.0, 0.0), still).shift == pytest.approx(0.0, abs=error)
    assert by_peak(EvenHistory(whole[100 - cut :], 1.0, 100.0 - cut), still).shift == pytest.approx(0.0, abs=error)


def test_a_peak_whose_width_is_not_known_is_uncertain_as_if_it_were_as_wide_as_the_history():
    """Held above four fifths to its end, 100 samples: a curvature of 0.4 of the height over 100^2."""
    values = np.interp(np.arange(100.0), [0.0, 50.0, 99.0], [0.0, 1.0, 0.9])
    found = by_peak(EvenHistory(values, 1.0, 0.0, 1e-3), EvenHistory(bell(np.arange(99.0) - 49.0, 9.0), 1.0, 0.0))
    curvature = 0.4 / 100.0**2
    assert found.uncertainty == pytest.approx(math.sqrt(1e-3 / curvature), rel=5e-3)


@pytest.mark.parametrize("unit", [1e-6, -300.0])
@pytest.mark.parametrize("rule", RULES)
def test_no_shift_and_no_doubt_depend_on_the_unit(rule, unit):
    """Nor on the sign of both."""
    time, generator = np.arange(300.0), np.random.default_rng(5)
    one = EvenHistory(2.0 * bell(time - 130.3, 14.0) + 0.01 * generator.normal(size=300), 1e-5, 0.0, 0.01)
    two = EvenHistory(3.0 * bell(time - 170.0, 14.0) + 0.01 * generator.normal(size=300), 1e-5, 0.0, 0.01)
    found, other = (
        rule(*(one._replace(values=k * one.values, noise=abs(k) * one.noise) for one in (one, two)))
        for k in (1.0, unit)
    )
    assert other[:2] == pytest.approx(found[:2], rel=1e-6, abs=0.0)


@pytest.mark.parametrize("place", [0, 5, 9])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_spike_is_a_peak_at_its_sample_and_as_wide_as_one(place, sign):
    """At an end too; three sines cross four fifths of it within half a sample: a curvature of 0.4 over a half squared."""
    values = np.full(10, 1e-3)
    values[place] = -3.0
    spike = EvenHistory(sign * values, 2.0, 7.0, 0.004)
    still = EvenHistory(bell(np.arange(99.0) - 49.0, 9.0), 1.0, -49.0)
    found = by_peak(spike, still)
    assert found.shift == pytest.approx(7.0 + 2.0 * place, abs=0.02)
    if place == 5:
        assert found.uncertainty == pytest.approx(2.0 * 0.004 * math.pi / math.sqrt(3.0) / (3.0 * 0.4 / 0.25), rel=0.01)
