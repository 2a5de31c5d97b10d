"""Butterworth filters against their transfer function in closed form, and pulses that start from rest."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from strikewave.signal.filters import (
    Filter,
    HighPass,
    ac_coupled,
    ac_uncoupled,
    advised_cutoff,
    effect_on_half_sine,
    effect_on_pulse,
    low_pass,
    stated,
)

STEP = 1e-6


def zero_phase(values, step, cutoff, order=4, axis=-1):
    return Filter(cutoff, order).apply(values, step, axis)


def warped(f, cutoff):
    return np.tan(np.pi * f * STEP) / np.tan(np.pi * cutoff * STEP)


@pytest.mark.parametrize("order", [1, 2, 4, 7])
@pytest.mark.parametrize("cutoff", [8e3, 100e3, 450e3])
def test_causal_filter_has_the_butterworth_magnitude(order, cutoff):
    size = 16384
    impulse = np.zeros(size)
    impulse[0] = 1.0
    H = np.abs(np.fft.rfft(low_pass(impulse, STEP, cutoff, order)))
    f = np.fft.rfftfreq(size, STEP)[:-1]
    # the response has died within the window; what is left is round-off
    assert np.allclose(H[:-1] ** 2, 1.0 / (1.0 + warped(f, cutoff) ** (2 * order)), atol=1e-10)


@pytest.mark.parametrize("order", [1, 2, 4, 7])
@pytest.mark.parametrize("cutoff", [8e3, 100e3, 450e3])
def test_both_passes_together_have_the_cutoff_asked_for_and_no_phase(order, cutoff):
    size = 16384
    impulse = np.zeros(size)
    impulse[size // 2] = 1.0
    H = np.fft.rfft(np.roll(zero_phase(impulse, STEP, cutoff, order), -size // 2))
    f = np.fft.rfftfreq(size, STEP)[:-1]
    expected = 1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * warped(f, cutoff) ** (2 * order))
    assert np.allclose(H[:-1].real, expected, atol=1e-10)
    assert np.allclose(H.imag, 0.0, atol=1e-10)
    assert np.interp(cutoff, f, H[:-1].real) == pytest.approx(math.sqrt(0.5), abs=2e-4)  # between frequencies


def test_peak_of_a_half_sine_is_that_of_its_fourier_integral():
    # 10 kHz, two poles forward and back, a half-sine of 100 us: 4.9 % lower
    T, cutoff, order, step = 100e-6, 10e3, 2, 1e-7

    def spectrum(f):  # of cos(pi t/T) over |t| < T/2
        return 0.5 * T * (np.sinc(f * T - 0.5) + np.sinc(f * T + 0.5))

    def integrand(f):
        return 2.0 * spectrum(f) / (1.0 + (math.sqrt(2.0) - 1.0) * (f / cutoff) ** (2 * order))

    expected = quad(integrand, 0.0, 1e6, epsrel=1e-10, limit=1000)[0]  # beyond, less than 1e-12 is left
    t = (np.arange(10001) - 5000) * step
    filtered = zero_phase(np.where(np.abs(t) < T / 2, np.cos(np.pi * t / T), 0.0), step, cutoff, order)
    # the bilinear transform bends the slope by (pi f dt)^2/3, 3e-6 at the cutoff
    assert filtered[5000] == pytest.approx(expected, rel=2e-6)
    assert 1.0 - filtered[5000] == pytest.approx(0.049, abs=5e-4)


@given(st.sampled_from([1, 2, 4]), st.floats(2e3, 400e3))
def test_pulse_from_rest_at_the_first_sample_stays_right(order, cutoff):
    pulse = np.sin(np.linspace(0.0, np.pi, 101))
    pulse[-1] = 0.0
    within = np.concatenate([np.zeros(8000), pulse, np.zeros(8000)])
    alone = zero_phase(pulse, STEP, cutoff, order)
    # padding lasts until the response has fallen to 1e-13; order 1 near 2 kHz leaves the most behind the window
    assert np.allclose(alone, zero_phase(within, STEP, cutoff, order)[8000:8101], atol=1e-11)


def test_constants_and_mirrored_histories_stay(rng):
    assert np.allclose(zero_phase(np.full(50, 3.0), STEP, 20e3), 3.0, rtol=1e-10)
    history = rng.normal(size=300)
    forward, back = zero_phase(history, STEP, 50e3), zero_phase(history[::-1], STEP, 50e3)[::-1]
    inner = slice(150, 151)  # far from the ends, where the order of the passes is forgotten
    assert np.allclose(forward[inner], back[inner], atol=1e-9)


def test_causal_filter_knows_no_future_and_starts_from_rest():
    history = np.ones(200)
    later = history.copy()
    later[120:] = 5.0
    one, other = low_pass(history, STEP, 30e3), low_pass(later, STEP, 30e3)
    assert np.array_equal(one[:120], other[:120])
    assert 0.0 < one[0] < 0.01


@given(scale=st.floats(-1e6, 1e6), shift=st.integers(1, 50))
def test_linear_and_along_any_axis(scale, shift):
    one = np.sin(np.arange(200) / 7.0)
    two = np.roll(one, shift)
    together = np.stack([one, scale * two], axis=1)
    for run in (low_pass, zero_phase):
        answer = run(together, STEP, 40e3, axis=0)
        assert answer.shape == (200, 2)
        assert np.allclose(answer[:, 0], run(one, STEP, 40e3), atol=1e-14)
        assert np.allclose(answer[:, 1], scale * run(two, STEP, 40e3), rtol=1e-9, atol=1e-12 * max(1.0, abs(scale)))


@pytest.mark.parametrize("run", [low_pass, zero_phase])
@pytest.mark.parametrize(
    ("values", "step", "cutoff", "order", "word"),
    [
        ([1.0, 2.0], STEP, 500e3, 4, "half the sampling rate, 500 kHz"),
        ([1.0, 2.0], STEP, 0.0, 4, "above zero"),
        ([1.0, 2.0], STEP, math.nan, 4, "cutoff"),
        ([1.0, 2.0], 0.0, 1e3, 4, "step"),
        ([1.0, 2.0], STEP, 1e3, 0, "order"),
        ([1.0, 2.0], STEP, 1e3, 2.5, "order"),
        ([1.0, math.nan], STEP, 1e3, 4, "finite"),
        ([], STEP, 1e3, 4, "samples"),
    ],
)
def test_bad_values_are_refused_in_words(run, values, step, cutoff, order, word):
    with pytest.raises(ValueError, match=word):
        run(values, step, cutoff, order)


@pytest.mark.parametrize(("duration", "left"), [(100e-6, 0.28), (200e-6, 0.52), (300e-6, 0.70)])
def test_cfc_1000_leaves_of_a_half_sine_what_sae_j211_gives(duration, left):
    assert effect_on_half_sine(Filter.sae_j211(1000), duration).peak == pytest.approx(left, abs=5e-3)  # two digits


def test_sae_j211_recursion_as_the_standard_writes_it(rng):
    # SAE J211-1 appendix C: the difference equation of one pass, forward then backward, from rest
    step, cfc = 1e-5, 1000.0
    wd = 2.0 * math.pi * cfc * 2.0775
    wa = math.sin(wd * step / 2.0) / math.cos(wd * step / 2.0)
    a0 = wa**2 / (1.0 + math.sqrt(2.0) * wa + wa**2)
    b1 = -2.0 * (wa**2 - 1.0) / (1.0 + math.sqrt(2.0) * wa + wa**2)
    b2 = (-1.0 + math.sqrt(2.0) * wa - wa**2) / (1.0 + math.sqrt(2.0) * wa + wa**2)

    def once(x):
        y = np.zeros_like(x)
        for k in range(2, x.size):
            y[k] = a0 * (x[k] + 2.0 * x[k - 1] + x[k - 2]) + b1 * y[k - 1] + b2 * y[k - 2]
        return y

    x = np.zeros(3000)
    x[1400:1600] = rng.normal(size=200)
    standard = once(once(x)[::-1])[::-1]
    assert np.allclose(Filter.sae_j211(cfc).apply(x, step), standard, atol=1e-12)


def test_both_conventions_differ_by_the_stated_factor_in_cutoff():
    both = Filter(10e3, 2, "both")
    each = Filter(10e3 * (math.sqrt(2.0) - 1.0) ** -0.25, 2, "each")
    f = np.linspace(0.0, 100e3, 101)
    assert np.allclose(both.gain(f, 1e-9), each.gain(f, 1e-9), rtol=1e-7)  # the warped scale bends by (pi f dt)^2/3
    assert both.half_power(1e-9) == pytest.approx(10e3, rel=1e-12)


def test_two_poles_at_10_khz_take_off_a_half_sine_of_100_us_what_the_conventions_say():
    assert 1.0 - effect_on_half_sine(Filter(10e3, 2, "each"), 100e-6).peak == pytest.approx(0.108, abs=5e-4)
    assert 1.0 - effect_on_half_sine(Filter(10e3, 2, "both"), 100e-6).peak == pytest.approx(0.049, abs=5e-4)


def test_advised_cutoff_changes_no_figure_of_the_half_sine_it_is_for_by_more_than_two_percent():
    width = 200e-6 * (1.0 - 2.0 * math.asin(0.1) / math.pi)
    cutoff = advised_cutoff(math.nan, width)
    effect = effect_on_half_sine(Filter(cutoff), 200e-6)
    assert effect.largest == pytest.approx(0.02, abs=1e-4)
    assert effect.width == pytest.approx(1.02, abs=1e-4)  # the width grows first
    for higher in (1.2, 2.0, 4.0):
        assert effect_on_half_sine(Filter(higher * cutoff), 200e-6).largest < 0.02
    alone = effect_on_half_sine(Filter(advised_cutoff(math.nan, width, peak_alone=True)), 200e-6)
    assert alone.peak == pytest.approx(0.98, abs=1e-4)
    assert alone.width > 1.1
    # a rise twice as steep asks for twice the cutoff
    assert advised_cutoff(0.5 * 200e-6 * (math.asin(0.9) - math.asin(0.1)) / math.pi, width) == pytest.approx(
        2 * cutoff
    )
    with pytest.raises(ValueError, match="rise or the width"):
        advised_cutoff(math.nan, math.nan)


def test_unknown_convention_is_refused():
    with pytest.raises(ValueError, match="both"):
        Filter(1e3, convention="one")


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("cutoff", [8e3, 100e3])
def test_high_pass_has_its_closed_form_and_no_phase(order, cutoff):
    size = 16384
    impulse = np.zeros(size)
    impulse[size // 2] = 1.0
    high = HighPass(cutoff, order)
    H = np.fft.rfft(np.roll(high.apply(impulse, STEP), -size // 2))
    f = np.fft.rfftfreq(size, STEP)
    # W_c^(2n) of each pass is (sqrt(2) - 1) W(cutoff)^(2n): both lose 3 dB at the cutoff
    expected = 1.0 / (1.0 + (math.sqrt(2.0) - 1.0) / np.maximum(warped(f[1:-1], cutoff), 1e-300) ** (2 * order))
    assert np.allclose(H[1:-1].real, expected, atol=1e-9)
    assert np.allclose(H.imag, 0.0, atol=1e-9)
    assert high.gain([0.0, cutoff], STEP) == pytest.approx([0.0, math.sqrt(0.5)])


def test_high_pass_makes_zero_of_an_offset_and_of_the_velocity_change(rng):
    high = HighPass(500.0)
    assert np.allclose(high.apply(np.full(3000, 7.0), 1e-5), 0.0, atol=1e-9)
    blow = np.zeros(20_000)
    blow[9950:10050] = np.sin(np.pi * np.arange(100) / 100)
    assert abs(np.sum(high.apply(blow, 1e-5))) < 1e-9 * np.sum(blow)  # gain zero at zero frequency
    history = rng.normal(size=500)
    assert np.allclose(high.apply(history + 5.0, 1e-5), high.apply(history, 1e-5), atol=1e-9)


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 500e3, math.nan])
def test_high_pass_refuses_a_cutoff_that_makes_no_sense(cutoff):
    with pytest.raises(ValueError, match="the cutoff must lie above zero and below half the sampling rate"):
        HighPass(cutoff).apply(np.ones(100), STEP)


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("convention", ["both", "each"])
def test_gain_is_half_the_power_at_the_frequency_that_is_stated_for_it(order, convention):
    found = Filter(80e3, order, convention)
    assert found.gain(found.half_power(STEP), STEP) == pytest.approx(math.sqrt(0.5), rel=1e-12)
    assert found.gain(80e3, STEP) == pytest.approx(0.5 if convention == "each" else math.sqrt(0.5), rel=1e-12)


def test_a_filter_has_12_poles_at_most():
    assert low_pass(np.ones(9), STEP, 300e3, 12).size == 9
    with pytest.raises(ValueError, match="from 1 to 12, got 13"):
        low_pass(np.ones(9), STEP, 300e3, 13)


def test_a_filter_leaves_of_an_uneven_pulse_what_is_read_off_its_output():
    """Peak, width at 10 % and integral above 2 %, of the filter run over the samples, on lines between them."""
    place = np.arange(6000.0)
    since = np.maximum(place - 2500.0, 0.0) / 80.0
    pulse = since**2 * np.exp(-since)
    filter_ = Filter(2e-3, 2)

    def seen(values):
        top = values.max()
        width, feet = (place[values > share * top] for share in (0.1, 0.02))
        return top, np.ptp(width), values[values > 0.02 * top].sum(), np.ptp(feet)

    before, after = seen(pulse), seen(filter_.apply(pulse, 1.0))
    found = effect_on_pulse(filter_, pulse, 1.0)
    assert found.peak == pytest.approx(after[0] / before[0], rel=1e-4)
    assert found.width == pytest.approx(after[1] / before[1], rel=1e-2)  # whole samples, of 300
    assert found.velocity_change == pytest.approx(after[2] / before[2], rel=1e-3)
    assert found.largest == max(abs(share - 1.0) for share in found) > 0.1


def test_half_sines_are_alike_over_frequency_times_duration():
    """Steps are shares of the duration, or of one over the cutoff where that is less: 1e-6, as is stated."""
    for cutoff in (0.5, 1.0, 6.0, 40.0):
        one, fine = effect_on_half_sine(Filter(cutoff), 1.0), effect_on_half_sine(Filter(cutoff), 1.0, 4000)
        assert one == pytest.approx(fine, rel=2e-5)
        assert effect_on_half_sine(Filter(1e3 * cutoff), 1e-3) == pytest.approx(one, rel=1e-9)


def test_cutoffs_are_advised_for_losses_from_half_a_percent_to_a_half():
    finest, coarsest = (advised_cutoff(math.nan, 1.0, loss, peak_alone=True) for loss in (5e-3, 0.5))
    assert effect_on_half_sine(Filter(coarsest), 1.0 / 0.936231).peak == pytest.approx(0.5, abs=1e-3)
    assert effect_on_half_sine(Filter(finest), 1.0 / 0.936231).peak == pytest.approx(0.995, abs=1e-4)
    for loss in (4.9e-3, 0.51):
        with pytest.raises(ValueError, match="lies between"):
            advised_cutoff(math.nan, 1.0, loss)


@pytest.mark.parametrize(("bandwidth", "lost"), [(50e3, 20), (30e3, 34), (4e3, 50)])
def test_a_history_at_a_bandwidth_is_not_known_within_one_over_it_of_its_end(bandwidth, lost):
    """At most half of it."""
    rows = np.random.default_rng(4).normal(size=(2, 100))
    found = stated(rows, STEP, bandwidth)
    assert np.array_equal(found[:, : 100 - lost], Filter(bandwidth).apply(rows, STEP)[:, : 100 - lost])
    assert np.isnan(found[:, 100 - lost :]).all()
    assert stated(rows, STEP, math.inf) is rows


def test_what_lies_between_the_feet_counts_in_the_velocity_change():
    """A step of 3 % of the peak behind a half-sine: above its foot of 2 % before as well as after the filter, which
    takes three tenths off the peak. Above 4 % it would count after it alone, as much again as the half-sine."""
    pulse = np.zeros(8000)
    pulse[2000:2101] = np.sin(np.pi * np.arange(101) / 100)
    pulse[2100:4200] = 0.03
    found = effect_on_pulse(Filter(4e-3, 1), pulse, 1.0)
    assert found.peak < 0.7
    assert found.velocity_change == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("pole", [0.0, 0.005, -0.005, 0.3])
def test_fast_filters_are_padded_until_they_have_settled(pole):
    """One pole, at (1 - W)/(1 + W): the same values as in a history with ones before and after, held for long."""
    cutoff = math.atan((1.0 - pole) / (1.0 + pole)) / (math.pi * STEP)
    values = np.array([2.0, -1.0, 5.0, 3.0])
    filter_ = Filter(cutoff, 1, "each")
    held = np.concatenate([np.full(50, 2.0), values, np.full(50, 3.0)])
    assert filter_.apply(values, STEP) == pytest.approx(filter_.apply(held, STEP)[50:54], abs=1e-12)


@pytest.mark.parametrize("constant", [1e-5, 3e-4, 1e-2, 1.0])
def test_the_inverse_is_exact(constant, rng):
    """Trapezoids both ways: what is left is rounding, which the sum of 5 000 samples carries on."""
    values = np.concatenate([[0.0], rng.normal(size=5000)])
    assert np.max(np.abs(ac_uncoupled(ac_coupled(values, 1e-5, constant), 1e-5, constant) - values)) < 1e-10


def test_a_half_sine_is_undershot_as_in_closed_form():
    """x = sin(pi t / T): y = (w^2 tau^2 sin wt + w tau cos wt - w tau e^(-t/tau)) / (1 + w^2 tau^2) until T."""
    length, constant, step = 1e-3, 2e-3, 1e-6
    time = step * np.arange(6000)
    omega = math.pi / length
    clean = np.where(time < length, np.sin(omega * time), 0.0)
    a = omega * constant
    inside = (a**2 * np.sin(omega * time) + a * np.cos(omega * time) - a * np.exp(-time / constant)) / (1.0 + a**2)
    last = -a * (1.0 + math.exp(-length / constant)) / (1.0 + a**2)
    truth = np.where(time < length, inside, last * np.exp(-(time - length) / constant))
    coupled = ac_coupled(clean, step, constant)
    # lines between samples: (w h)^2 / 12 = 8e-7
    assert np.max(np.abs(coupled - truth)) < 2e-6


def test_the_area_of_pulse_and_undershoot_is_zero():
    """Nothing passes at frequency zero: after twenty time constants e^-20 of the area is left."""
    pulse = np.zeros(60_000)
    pulse[1000:2000] = np.sin(np.pi * (np.arange(1000) + 0.5) / 1000)
    coupled = ac_coupled(pulse, 1e-6, 2.5e-3)
    assert abs(np.sum(coupled)) < 1e-8 * np.sum(pulse)
