"""Response channels: closed forms of decaying sines and exponentials."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planted import noises

from strikewave.base.errors import InputError
from strikewave.records import response
from strikewave.records.reading import Request, read_file
from strikewave.records.record import Channel, Record
from strikewave.records.response import (
    BaseBlow,
    covariance_of,
    decaying_modes,
    effective_span,
    measure_responses,
    swings,
)
from strikewave.signal.filters import ac_coupled

STEP = 5e-6
TIME = STEP * np.arange(6000)


def swing(frequency, damping, amplitude, phase=0.0):
    omega = 2.0 * math.pi * frequency
    decay = omega * damping / math.sqrt(1.0 - damping**2)
    return amplitude * np.exp(-decay * TIME) * np.cos(omega * TIME + phase)


@pytest.mark.verify
@settings(max_examples=20, deadline=None)
@given(st.floats(300.0, 1500.0), st.floats(1.8, 4.0), st.floats(0.01, 0.06), st.floats(-3.0, 3.0))
def test_a_sum_of_two_decaying_sines_gives_back_frequencies_and_damping(frequency, ratio, damping, phase):
    """A sum of exponentials is what least squares fit: rounding is left."""
    values = swing(frequency, damping, 100.0, phase) + swing(ratio * frequency, damping, 70.0)
    modes = sorted(decaying_modes(values, STEP), key=lambda mode: mode.frequency)
    assert [mode.frequency for mode in modes] == pytest.approx([frequency, ratio * frequency], rel=1e-6)
    assert [mode.damping for mode in modes] == pytest.approx([damping, damping], rel=1e-5)


def planted_swings(rng, kind, colour):
    """Return swings in noise 20 to 50 dB below them, their step, and (frequency, damping) of each.

    A close pair is one to three times one over the length apart, what a spectrum just resolves.
    """
    size = int(np.exp(rng.uniform(np.log(300), np.log(4000))))
    time = STEP * np.arange(size)
    frequencies = [rng.uniform(4.0, 30.0) / (STEP * size)]
    if kind == "double":
        frequencies.append(frequencies[0] * rng.uniform(1.5, 4.0))
    if kind == "close":
        frequencies.append(frequencies[0] + rng.uniform(1.0, 3.0) / (STEP * size))
    values = 10.0 ** (-rng.uniform(20.0, 50.0) / 20.0) * noises.noise(rng, size, colour)
    truth = []
    for frequency in frequencies:
        omega = 2.0 * np.pi * frequency
        decay = rng.uniform(0.6, 6.0) / (STEP * size)
        swing_ = np.exp(-decay * time) * np.cos(omega * time + rng.uniform(0.0, 6.28))
        values += (1.0 if not truth else rng.uniform(0.5, 1.0)) * swing_
        truth.append((frequency, decay / np.hypot(decay, omega)))
    return values, truth


def scores_of(kind, colour, count):
    """Return errors of frequency and damping over their stated uncertainties, and how many modes were not found."""
    rng = np.random.default_rng([count, len(kind), len(colour)])
    scores, lost = [], 0
    for _ in range(count):
        values, truth = planted_swings(rng, kind, colour)
        left = list(decaying_modes(values, STEP))
        for frequency, damping in truth:
            near = [mode for mode in left if abs(mode.frequency / frequency - 1.0) < 0.05]
            if not near:
                lost += 1
                continue
            mode = min(near, key=lambda one: abs(one.frequency - frequency))
            left.remove(mode)
            scores.append(
                (
                    (mode.frequency - frequency) / mode.frequency_uncertainty,
                    (mode.damping - damping) / mode.damping_uncertainty,
                )
            )
    return np.abs(scores), lost / count


@pytest.mark.verify
@pytest.mark.parametrize("kind", ["single", "double", "close"])
@pytest.mark.parametrize("colour", ["white", "pink", "autoregressive", "brown"])
def test_nine_errors_in_ten_lie_within_two_stated_uncertainties(kind, colour):
    """19 in 20 where all were normal: 2.5 standard deviations of the count of 200 draws are 4 %; a few close pairs, found
    as one, are far off. The other way, two thirds must not lie within half of it: then too much would be stated; noise
    whose power falls off as 1/f^2 leaks into its memory, and is stated up to twice too large."""
    scores, lost = scores_of(kind, colour, 200)
    assert np.all(np.mean(scores < 2.0, axis=0) > 0.9)
    assert colour == "brown" or np.all(np.mean(scores < 0.5, axis=0) < 0.66)
    assert lost < 0.05


@pytest.mark.verify
def test_the_stated_uncertainty_covers_what_noise_does():
    """60 double draws: three standard deviations of a share of 95 % are 6 %."""
    scores, lost = scores_of("double", "white", 60)
    assert np.all(np.mean(scores < 2.0, axis=0) > 0.87)
    assert lost == 0.0


def test_in_white_noise_the_uncertainty_is_the_cramer_rao_bound(rng):
    """Of a decaying swing that dies out, beside its phase: 1/var = a^2/(2 s^2) sum (t - mean)^2 exp(-2 d t), and the
    weights exp(-2 d t) sum up to 1/(2 d step), with a variance of 1/(2 d)^2. s is measured by 4000 samples, but its
    spectrum near one frequency by forty: 0.25 is 1.5 standard deviations of that."""
    decay, omega = 1.0 / (400 * STEP), 2.0 * np.pi * 900.0
    time = STEP * np.arange(4000)
    values = 100.0 * np.exp(-decay * time) * np.cos(omega * time) + rng.normal(size=time.size)
    [mode] = decaying_modes(values, STEP)
    lasts = 1.0 / (2.0 * decay * STEP)
    bound = math.sqrt(2.0 / 100.0**2 / (lasts / (2.0 * decay) ** 2)) / (2.0 * np.pi)
    assert mode.frequency_uncertainty == pytest.approx(bound, rel=0.25)


@given(st.floats(1.5, 20.0))
def test_effective_duration_of_an_exponential(decays):
    """|x| falls to 1/3 at tau ln 3; lines between samples of tau/200 miss that by less than a sample."""
    values = np.r_[np.zeros(50), np.exp(-np.arange(int(200 * 2.5 * decays)) / 200.0)]
    first, last = effective_span(values)
    assert 49.0 < first <= 50.0
    assert last - 50.0 == pytest.approx(200.0 * math.log(3.0), abs=1.0)


def test_a_response_beside_its_base():
    late = np.r_[np.zeros(1000), swing(900.0, 0.03, -300.0)] + 7.0
    [found] = measure_responses(late, STEP, 0.0, [BaseBlow(0.004, 0.0045, 0.005, 1000.0)])
    assert (found.peak, found.ratio) == pytest.approx((-300.0, 0.3), rel=1e-6)
    assert found.delay == pytest.approx(1000 * STEP - 0.0045, abs=1e-9)
    assert found.modes[0].amplitude == pytest.approx(300.0, rel=0.02)


def test_each_blow_of_a_train_has_its_response():
    """From its begin to the next blow; each of four swings is a tenth smaller than the one before."""
    sizes = [300.0, 270.0, 240.0, 210.0]
    values = np.concatenate([np.zeros(400), *(size * swing(900.0, 0.03, -1.0)[:3000] for size in sizes)])
    starts = STEP * (400 + 3000 * np.arange(4))
    blows = [BaseBlow(begin, begin + 1e-4, begin + 2e-4, 1000.0) for begin in starts]
    found = measure_responses(values, STEP, 0.0, blows)
    assert [one.blow for one in found] == [1, 2, 3, 4]
    assert [-one.peak for one in found] == pytest.approx(sizes, rel=1e-6)
    assert [one.delay for one in found] == pytest.approx([-1e-4] * 4, abs=1e-9)
    assert [one.modes[0].frequency for one in found] == pytest.approx([900.0] * 4, rel=1e-4)


def test_a_blow_with_ringing_does_not_swing_about_zero():
    half_sine = np.where(TIME < 4e-3, 100.0 * np.sin(np.pi * TIME / 4e-3), 0.0)
    assert not swings(half_sine)
    assert not swings(half_sine + swing(2000.0, 0.02, 40.0))
    assert swings(swing(900.0, 0.03, 300.0))


def file_of(request):
    half_sine = np.where(abs(TIME - 6.5e-3) < 0.5e-3, 1000.0 * np.cos(np.pi * (TIME - 6.5e-3) / 1e-3), 0.0)
    late = np.roll(swing(900.0, 0.03, -300.0, 1.5), 1300) * (TIME >= 1300 * STEP)
    noise = np.random.default_rng(3).normal(size=(2, TIME.size))
    channels = Channel("frame", half_sine + noise[0], STEP, unit="g"), Channel("board", late + noise[1], STEP, unit="g")
    return read_file(Record("a.csv", "text", channels), {}, request)


def test_the_named_base_makes_the_other_channel_a_response():
    frame, board = file_of(Request(base="frame")).channels
    assert frame.pulses
    assert frame.response is None
    assert not board.pulses
    assert board.status == "good"
    assert board.response.modes[0].frequency == pytest.approx(900.0, rel=0.01)


def test_without_a_base_a_swinging_channel_is_told_and_not_good():
    frame, board = file_of(Request()).channels
    assert "response" not in [finding.code for finding in frame.findings]
    [told] = [finding for finding in board.findings if finding.code == "response"]
    assert "--base 1" in told.message
    assert board.status != "good"
    assert board.figures("peak") == []


def test_a_channel_that_swings_through_most_of_its_record_is_told_too_and_not_as_one_without_a_blow():
    after = np.maximum(TIME - 6e-3, 0.0)
    long = 550.0 * np.exp(-0.03 * 2 * np.pi * 800.0 * after) * np.sin(2 * np.pi * 800.0 * after)
    half_sine = np.where(abs(TIME - 6.5e-3) < 0.5e-3, 1000.0 * np.cos(np.pi * (TIME - 6.5e-3) / 1e-3), 0.0)
    noise = np.random.default_rng(5).normal(size=(3, TIME.size))
    end = round(20e-3 / STEP)
    channels = [
        Channel(name, (values + noise[k])[:end], STEP, unit="g")
        for k, (name, values) in enumerate((("frame", half_sine), ("board", long), ("quiet", 0.0 * long)))
    ]
    frame, board, quiet = read_file(Record("a.csv", "text", tuple(channels)), {}, Request()).channels
    assert "response" in [finding.code for finding in board.findings]
    assert board.status == "suspect"
    assert frame.status == "good"
    assert "response" not in [finding.code for finding in quiet.findings]  # noise swings about zero too


def test_a_base_that_the_file_lacks_is_refused():
    for name in ("wall", "3"):
        with pytest.raises(InputError, match=r"^--base: .*has: 1 frame, 2 board"):
            file_of(Request(base=name))
    with pytest.raises(InputError, match=r"add --channel frame"):
        file_of(Request(base="frame", channels=("board",)))


def test_a_base_without_a_channel_that_responds_is_refused():
    with pytest.raises(InputError, match=r"^--base: .*beside others: only frame is read; name a channel that responds"):
        file_of(Request(base="frame", channels=("frame",)))


@pytest.mark.parametrize("wanted", ["auto", 4e-3])
def test_ac_coupling_of_a_response_is_recognised_and_taken_off(wanted):
    """A step of velocity rings out: x = a exp(-dt) sin(wt) has an integral, which a high-pass of 40 Hz lets sag."""
    late = np.where(TIME > 6e-3, np.roll(swing(500.0, 0.05, 300.0, -np.pi / 2.0), 1200), 0.0)
    late += np.where(abs(TIME - 6.5e-3) < 0.5e-3, 150.0 * np.cos(np.pi * (TIME - 6.5e-3) / 1e-3), 0.0)
    base = np.where(abs(TIME - 6.5e-3) < 0.5e-3, 1000.0 * np.cos(np.pi * (TIME - 6.5e-3) / 1e-3), 0.0)
    seen = ac_coupled(late, STEP, 4e-3)
    noise = 0.3 * np.random.default_rng(4).normal(size=(2, TIME.size))
    channels = Channel("frame", base + noise[0], STEP, unit="g"), Channel("board", seen + noise[1], STEP, unit="g")
    record = Record("a.csv", "text", channels)
    coupled = read_file(record, {}, Request(base="frame")).channels[1]
    free = read_file(record, {}, Request(base="frame", ac_coupling=wanted)).channels[1]
    assert "ac-coupling" in [f.code for f in coupled.findings]
    true = np.max(np.abs(late)) * 9.80665
    assert abs(abs(coupled.response.peak) / true - 1.0) > 0.02
    assert abs(free.response.peak) == pytest.approx(true, rel=0.01)


def led(lead, colour, blows=1, silent=False):
    """Return the findings of a channel of 150 g that comes so much before a base of the same shape, s."""
    time = STEP * np.arange(10_000 if blows == 1 else 24_000)

    def train(late, peak):
        u = (time[:, None] - 0.012 - late - 0.035 * np.arange(blows)) / 5e-4
        return np.sum(np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0), axis=1)

    rng = np.random.default_rng(5)
    answer = (0.0 if silent else 1.0) * train(-lead, 150.0) + 0.05 * noises.noise(rng, time.size, colour)
    base = train(0.0, 700.0) + 0.3 * rng.normal(size=time.size)
    channels = Channel("frame", base, STEP, unit="g"), Channel("board", answer, STEP, unit="g")
    board = read_file(Record("a.csv", "text", channels), {}, Request(base="frame")).channels[1]
    return {finding.code: finding.message for finding in board.findings}


@pytest.mark.parametrize("blows", [1, 3])
@pytest.mark.parametrize("colour", ["white", "brown"])
@pytest.mark.parametrize("lead", [1e-3, 3e-3, 5e-3])
def test_a_channel_that_comes_before_its_base_is_connected(lead, colour, blows):
    """What is wrong is a name, a clock or the base: the message says by how much the channel leads."""
    message = led(lead, colour, blows)["no-response"]
    assert f"{1e3 * lead:.3g}\xa0ms before the peak of the {'first ' if blows > 1 else ''}blow" in message
    assert "not connected" not in message
    peak = float(message.partition("reaches ")[2].partition("\xa0")[0])
    assert peak == pytest.approx(150.0, abs=0.25)  # five deviations of the noise


@pytest.mark.parametrize("lag", [1e-3, 5e-3])
def test_a_channel_that_comes_after_its_base_answers_it(lag):
    assert "no-response" not in led(-lag, "white")


@pytest.mark.parametrize("colour", ["white", "pink", "brown"])
@pytest.mark.parametrize("blows", [1, 3])
def test_a_channel_of_noise_is_not_connected(colour, blows):
    assert "not connected" in led(0.0, colour, blows, silent=True)["no-response"]


def test_an_effective_span_ends_between_samples():
    """A tent from 0 over 3 at sample 6 to 0 at 12, its zero taken off: a third of it is crossed at 2 and at 10."""
    values = np.interp(np.arange(20.0), [0.0, 6.0, 12.0], [0.0, 3.0, 0.0])
    assert response.effective_span(values) == pytest.approx((2.0, 10.0))
    assert response.effective_span(-values, 0.5) == pytest.approx((3.0, 9.0))
    assert response.effective_span(values, 0.55) == pytest.approx((3.3, 8.7))
    assert response.effective_span(values[6:], 0.5) == pytest.approx((0.0, 3.0))
    assert response.effective_span(values[:7], 0.5) == pytest.approx((3.0, 6.0))


def test_the_tip_of_a_parabola_lies_between_samples():
    for sign in (1.0, -1.0):
        values = sign * (5.0 - (np.arange(9.0) - 4.3) ** 2 / 10.0)
        assert response._tip(values, 4) == pytest.approx((4.3, 5.0 * sign))
        assert response._tip(values, 0) == (0.0, values[0])
        assert response._tip(values, 8) == (8.0, values[8])
    assert response._tip(np.array([0.0, 1.0, 0.0]), 1) == (1.0, 1.0)  # a spike is no parabola
    assert response._tip(np.full(3, 2.0), 1) == (1.0, 2.0)


def test_a_response_in_closed_form():
    """A sine of a whole number of swings that dies out: each figure of it by hand, against a blow 2 ms long."""
    time = 1e-5 * np.arange(4000)
    omega, decay = 2.0 * np.pi * 500.0, 100.0
    above = -6.0 * np.exp(-decay * time) * np.sin(omega * time)
    values = np.r_[np.full(1000, 0.7), 0.7 + above]
    blow = BaseBlow(3.0 + 0.01, 3.0 + 0.011, 3.0 + 0.012, -3.0)
    [found] = response.measure_responses(values, 1e-5, 3.0, [blow])
    top = math.atan2(omega, decay) / omega  # where the derivative is zero
    peak = -6.0 * math.exp(-decay * top) * math.sin(omega * top)
    assert found.zero == pytest.approx(0.7)
    assert found.peak == pytest.approx(peak, rel=1e-5)
    assert found.time == pytest.approx(3.01 + top, abs=1e-7)
    assert found.delay == pytest.approx(top - 1e-3, abs=1e-7)
    assert (found.base_peak, found.ratio) == (-3.0, pytest.approx(abs(peak) / 3.0, rel=1e-5))
    size = np.abs(above)
    inside = np.flatnonzero(size >= abs(peak) / 3.0)
    assert found.begin == pytest.approx(3.01 + 1e-5 * inside[0], abs=1e-5)
    assert found.duration == pytest.approx(1e-5 * (inside[-1] - inside[0]), abs=2e-5)
    assert found.rms == pytest.approx(math.sqrt(np.mean(above[inside[0] : inside[-1] + 1] ** 2)), rel=3e-3)
    assert found.decay.begin == pytest.approx(3.012, abs=1.01e-5)
    assert found.figure("peak") == -found.peak
    assert found.figure("frequency") == pytest.approx(500.0, rel=1e-6)
    assert found.figure("damping") == pytest.approx(decay / math.hypot(decay, omega), rel=1e-6)
    assert found.modes[0].amplitude == pytest.approx(6.0 * math.exp(-decay * (found.decay.begin - 3.01)), rel=1e-6)
    [none] = response.measure_responses(values, 1e-5, 3.0, [blow], same_unit=False)
    assert math.isnan(none.ratio)
    [flat] = response.measure_responses(np.full(2000, 0.7), 1e-5, 3.0, [blow])
    assert (flat.peak, flat.duration, flat.rms, flat.delay) == (0.0, 0.0, 0.0, pytest.approx(-1e-3))
    assert (flat.blow, flat.time, flat.base_peak, flat.ratio) == (1, blow.begin, -3.0, 0.0)
    assert (flat.begin, flat.modes, flat.zero, flat.decay) == (
        blow.begin,
        (),
        0.7,
        response.FreeDecay(blow.begin, blow.begin),
    )
    assert response._measure(2, np.zeros(99), 1e-5, 3.0, blow, True).zero == 0.0


def test_a_blow_at_the_end_of_a_record_has_its_last_samples_for_its_response():
    """Twenty-four are the fewest in which a swing is sought."""
    values = np.zeros(100)
    values[80] = 5.0
    for begin in (90.0, 1000.0):
        [found] = response.measure_responses(values, 1.0, 0.0, [BaseBlow(begin, begin, begin, 2.0)])
        assert (found.time, found.peak) == (80.0, 5.0)
    assert response.measure_responses(values[:23], 1.0, 0.0, [BaseBlow(9.0, 9.0, 9.0, 2.0)]) == ()


@pytest.mark.parametrize("n", [30, 200])
def test_the_covariance_of_a_mean_in_coloured_noise_is_that_of_newey_and_west(rng, n):
    """One column of ones: the triangle over a twentieth of the samples, and what the mean takes of the noise put back.

    Written as sums over lags; the rounds that put it back converge to c = sum(t_k g_k) + c sum(t_k (n - k)) / n^2."""
    rest = np.convolve(rng.normal(size=n + 3), [1.0, 0.8, 0.5, 0.2], "valid")
    rest -= rest.mean()
    memory = n // 20
    lags = range(-memory, memory + 1)
    taper = {k: 1.0 - abs(k) / (memory + 1) for k in lags}
    own = {k: np.sum(rest[abs(k) :] * rest[: n - abs(k)]) / n for k in lags}
    weights = {k: taper[k] * (n - abs(k)) / n for k in lags}
    plain = sum(weights[k] * own[k] for k in lags)
    back = sum(weights[k] * (n - abs(k)) / n for k in lags) / n
    expected = plain * sum(back**j for j in range(4)) / n
    assert covariance_of(np.ones((n, 1)), rest)[0, 0] == pytest.approx(expected, rel=1e-9)
    assert covariance_of(np.ones((n, 2)), rest) is None  # columns that are one
    assert covariance_of(np.eye(6)[:, :3], np.ones(6)) is None  # two samples a column
