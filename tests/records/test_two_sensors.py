"""Two sensors on one object: planted delays and gains, bars in closed form, and what is refused."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.texts import beside_doubt
from strikewave.records import find_pulses, two_sensors
from strikewave.records.two_sensors import paired_motion
from strikewave.waves import End, Layer, LoadPulse, Stack, Tap, run_bar

STEP, BEGIN, PEAK = 1e-6, 1500e-6, 1000.0
TIME = STEP * np.arange(6000)
BAR = Layer("bar", 7820.0, 211e9, 7e-4, 0.1)
SPEED = BAR.bar_speed


def pulse(length=300e-6, delay=0.0, power=1.5, begin=BEGIN):
    u = (TIME - begin - delay) / length
    return PEAK * np.where((u > 0.0) & (u < 1.0), np.sin(np.pi * np.clip(u, 0.0, 1.0)) ** power, 0.0)


def compared(first, second, step=STEP):
    return paired_motion(first, second, step, find_pulses(first, step))


def noise(rng, share):
    return share * PEAK * rng.normal(size=TIME.size)


@pytest.mark.parametrize("delay", [-37.3e-6, 0.4e-6, 12.6e-6])
def test_a_planted_delay_and_gain_come_back(delay, rng):
    found = compared(pulse() + noise(rng, 0.01), 0.8 * pulse(delay=delay) + noise(rng, 0.02))
    assert found.delay == pytest.approx(delay, abs=3.0 * found.delay_uncertainty)
    assert found.delay_uncertainty < 0.5e-6  # half a sample: it lies between them
    assert found.gain == pytest.approx(0.8, abs=3.0 * found.gain_uncertainty)
    assert found.one_body == "no"
    assert found.leads == (0 if abs(delay) < STEP else 1 if delay > 0.0 else 2)


@pytest.mark.verify
def test_the_uncertainty_of_a_delay_is_the_bound_for_white_noise(rng):
    """(s1^2 + s2^2) / sum s'^2, the Cramer-Rao bound of a known pulse, to what 30 draws tell of a scatter (13 %) and the
    band that is taken off tells of the noise."""
    clean = pulse()
    bound = math.sqrt(0.01**2 + 0.02**2) * PEAK / math.sqrt(np.sum((np.gradient(clean) / STEP) ** 2))
    found = [compared(clean + noise(rng, 0.01), clean + noise(rng, 0.02)) for _ in range(30)]
    assert np.std([one.delay for one in found]) == pytest.approx(bound, rel=0.4)
    assert np.mean([one.delay_uncertainty for one in found]) == pytest.approx(bound, rel=0.3)


def test_alike_channels_are_one_body_and_common_motion_is_theirs(rng):
    found = compared(pulse() + noise(rng, 0.01), pulse() + noise(rng, 0.01))
    assert (found.one_body, found.leads) == ("yes", 0)
    assert found.rigid_peak == pytest.approx(PEAK, abs=3.0 * found.common_uncertainty)
    assert found.differential_share < 0.05
    assert found.transfer.alike_to > 1.0 / 300e-6


def test_opposite_motion_is_differential(rng):
    """A swing of the ends against one another is in the difference alone: the common motion does not ring."""
    since = np.maximum(TIME - BEGIN, 0.0)
    swing = 300.0 * np.exp(-since / 400e-6) * np.sin(2.0 * np.pi * 9e3 * since)
    found = compared(pulse() - swing + noise(rng, 0.002), pulse() + swing + noise(rng, 0.002))
    assert found.rigid_peak == pytest.approx(PEAK, rel=0.01)  # noise of 0.2 % on the highest of some samples
    assert found.differential_peak == pytest.approx(np.max(swing), rel=0.05)


def test_a_channel_that_swings_is_no_delayed_copy(rng):
    since = np.maximum(TIME - BEGIN, 0.0)
    board = 2000.0 * np.exp(-since / 1e-3) * (np.sin(2.0 * np.pi * 7e3 * since) + np.sin(2.0 * np.pi * 5.3e3 * since))
    found = compared(pulse(150e-6) + noise(rng, 0.005), board + noise(rng, 0.005))
    assert found.one_body != "yes"
    assert math.isnan(found.delay)
    assert found.leads == 0
    tops = np.argmax(np.abs(board)) - np.argmax(pulse(150e-6))
    assert found.peak_lag == pytest.approx(tops * STEP, abs=10e-6)  # noise moves the highest sample of a flat top


def test_a_train_averages_its_blows(rng):
    first, second = np.zeros(TIME.size * 2), np.zeros(TIME.size * 2)
    for begin in (1500e-6, 4500e-6, 7500e-6):
        u = (STEP * np.arange(first.size) - begin) / 200e-6
        blow = PEAK * np.where((u > 0.0) & (u < 1.0), np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)
        first += blow
        second += np.roll(blow, 15)
    first += 0.02 * PEAK * rng.normal(size=first.size)
    second += 0.02 * PEAK * rng.normal(size=first.size)
    found = compared(first, second)
    assert found.blows == 3
    assert found.delay == pytest.approx(15e-6, abs=3.0 * found.delay_uncertainty)
    assert found.transfer.averages == 6  # three blows, two lines each


def of_bar(run, rng, share, values):
    """Return two records of taps, with a quiet time before, noise of a share of the peak, and the step."""
    step = run.time[1] - run.time[0]
    records = np.vstack([np.zeros((3000, 2)), values])
    return records + share * np.max(np.abs(values)) * rng.normal(size=records.shape), step


def test_a_wave_that_passes_is_late_by_distance_over_speed(rng):
    """A bar without end: the velocity at the second place is that at the first, delayed; nothing else."""
    run = run_bar(Stack((BAR,), (), End("matched")), LoadPulse("sine-squared", 2e4, 60e-6), [Tap(0, 0.2), Tap(0, 0.8)], 400e-6)  # fmt: skip
    records, step = of_bar(run, rng, 0.003, run.velocity)
    found = compared(*records.T, step)
    assert found.delay == pytest.approx(0.06 / SPEED, abs=3.0 * found.delay_uncertainty + run.grid.step)
    assert found.gain == pytest.approx(1.0, abs=0.01)
    assert (found.one_body, found.leads) == ("no", 1)
    number, doubt = beside_doubt(1e6 * found.delay, 1e6 * found.delay_uncertainty)  # as the table has them
    assert f"delay {number} ± {doubt} µs (standard uncertainties; sampling " in found.reason
    transfer = found.transfer
    low = (transfer.frequency > 0.0) & (transfer.frequency < 0.3 / 60e-6)
    phase = -2.0 * np.pi * transfer.frequency[low] * 0.06 / SPEED
    assert np.max(np.abs(np.angle(transfer.h1[low] * np.exp(-1j * phase)))) < 0.05  # 3 degrees: lines are averaged


def test_ends_of_a_free_bar_agree_below_its_first_mode(rng):
    """A blow of eight periods: no delay, though a wave takes 19 us, and the rigid peak is force over mass. Between the
    ends H = 1 / cos(2 pi f L / c), so that they are alike within 10 % up to 0.14 c / L."""
    length = 16.0 * 0.1 / SPEED
    run = run_bar(Stack((BAR,)), LoadPulse("sine-squared", 2e4, length), [Tap(0, 0.0), Tap(0, 1.0)], 12.0 * length)
    records, step = of_bar(run, rng, 0.002, run.acceleration)
    found = compared(*records.T, step)
    assert found.one_body == "yes"
    assert abs(found.delay) < 0.1 * 0.1 / SPEED
    assert found.rigid_peak == pytest.approx(2e4 / BAR.mass, abs=2.0 * found.common_uncertainty)
    assert found.common_uncertainty < 0.05 * found.rigid_peak
    transfer = found.transfer
    low = transfer.frequency < 0.1 * SPEED / 0.1
    low &= transfer.frequency <= transfer.trusted[1]
    true = 1.0 / np.cos(2.0 * np.pi * transfer.frequency[low] * 0.1 / SPEED)
    assert np.count_nonzero(low) >= 3
    assert np.abs(transfer.h1[low]) == pytest.approx(true, rel=0.05)
    assert transfer.alike_to < 0.2 * SPEED / 0.1


@pytest.mark.verify
def test_coverage_of_delay_and_gain_over_a_hundred_draws():
    """Two standard uncertainties hold 88 % at least (95 % but for chance in 100 draws, and for shapes); no bias."""
    rng = np.random.default_rng(20240612)
    delays, gains = [], []
    for _ in range(100):
        length, delay, gain = rng.uniform(100e-6, 600e-6), rng.uniform(-50e-6, 50e-6), rng.uniform(0.7, 1.3)
        power, shares = rng.uniform(1.0, 2.5), 10.0 ** rng.uniform(-3.0, -1.3, 2)
        first, second = pulse(length, 0.0, power), gain * pulse(length, delay, power)
        found = compared(first + noise(rng, shares[0]), second + noise(rng, shares[1]))
        delays.append((found.delay - delay) / found.delay_uncertainty)
        gains.append((found.gain - gain) / found.gain_uncertainty)
    for name, misses in (("delay", delays), ("gain", gains)):
        print(f"{name}: mean {np.mean(misses):.2f}, scatter {np.std(misses):.2f}, within two {np.mean(np.abs(misses) < 2.0):.0%}")  # fmt: skip
        assert np.mean(np.abs(misses) < 2.0) >= 0.88
        assert abs(np.mean(misses)) < 0.35


@pytest.mark.verify
def test_coverage_of_the_common_rigid_peak_over_sixty_bars():
    """Ends of free bars, blows of 2 to 12 periods: two standard uncertainties hold 90 % of the rigid peaks, which are
    force over mass; the common motion is nearer to them than either end."""
    rng = np.random.default_rng(20240613)
    misses, errors, ends = [], [], []
    for _ in range(60):
        bar = Layer("bar", rng.uniform(2700.0, 8000.0), rng.uniform(70e9, 210e9), 7e-4, rng.uniform(0.05, 0.2))
        length = float(np.exp(rng.uniform(np.log(2.0), np.log(12.0)))) * 2.0 * bar.transit
        shape = str(rng.choice(["half-sine", "sine-squared"]))
        run = run_bar(Stack((bar,)), LoadPulse(shape, 2e4, length), [Tap(0, 0.0), Tap(0, 1.0)], 10.0 * length)
        fine = run.time[1] - run.time[0]
        factor = max(1, round(length / 150.0 / fine))
        values = run.acceleration[: run.time.size // factor * factor].reshape(-1, factor, 2).mean(axis=1)
        values = np.vstack([np.zeros((round(8.0 * length / (factor * fine)), 2)), values])
        peak = 2e4 / bar.mass
        values += 0.003 * peak * rng.normal(size=values.shape)
        blows = find_pulses(values[:, 0], factor * fine) or find_pulses(values[:, 1], factor * fine)
        found = paired_motion(*values.T, factor * fine, blows) if blows else None
        if found is not None and math.isfinite(found.rigid_peak):
            misses.append((found.rigid_peak - peak) / found.common_uncertainty)
            errors.append(found.rigid_peak / peak - 1.0)
            ends.append(np.max(np.abs(values)) / peak - 1.0)
    within = np.mean(np.abs(misses) < 2.0)
    print(f"{len(misses)} given; bias {np.median(errors):.2%}, spread {np.std(errors):.2%}, within two {within:.0%}, raw {np.median(ends):.0%}")  # fmt: skip
    assert len(misses) >= 30
    assert within >= 0.9
    assert np.median(np.abs(errors)) < np.median(np.abs(ends))


def test_a_mean_is_as_uncertain_as_its_values_or_as_they_scatter():
    assert two_sensors._mean([(1.0, 0.3), (3.0, 0.4)]) == (2.0, pytest.approx(0.5 / 2.0))
    assert two_sensors._mean([(1.0, 0.1), (3.0, 0.1), (5.0, 0.1)]) == (3.0, pytest.approx(2.0 / math.sqrt(3.0)))
    assert np.isnan(two_sensors._mean([])).all()


@pytest.mark.parametrize(
    ("values", "rivalled"),
    [
        ([1, 0, 10, 0, 9.1], True),
        ([1, 0, 10, 0, 8.9], False),
        ([9.1, 0, 10, 0, 1], True),
        ([1, 5.1, 10, 5.1, 9.5], False),
        ([9.5, 4.9, 10, 6, 6], True),
        ([1, 4.9, 10], False),
    ],
)
def test_a_correlation_has_a_rival_behind_a_valley(values, rivalled):
    assert two_sensors._rivalled(np.array(values, dtype=float)) is rivalled


def windows_of(first, second, count, size):
    return [
        two_sensors.Window(first[k * size : (k + 1) * size], second[k * size : (k + 1) * size], (0.0, 0.0))
        for k in range(count)
    ]


def test_the_transfer_function_of_many_blows_is_that_of_welch(rng):
    """Scipy's spectra over six windows: H1, H2 and coherence, and the standard uncertainty of Bendat & Piersol."""
    from scipy.signal import coherence, csd, welch

    first = rng.normal(size=6 * 64)
    second = 0.5 * first + 0.4 * rng.normal(size=first.size)
    found = two_sensors._transfer(windows_of(first, second, 6, 64), 1e-3, 0.0)
    how = {"fs": 1e3, "window": "boxcar", "nperseg": 64, "noverlap": 0, "detrend": False}
    cross = csd(first, second, **how)[1]
    alike = coherence(first, second, **how)[1]
    assert found.frequency == pytest.approx(np.fft.rfftfreq(64, 1e-3))
    assert found.h1 == pytest.approx(cross / welch(first, **how)[1], rel=1e-9)
    assert found.h2 == pytest.approx(welch(second, **how)[1] / np.conj(cross), rel=1e-9)
    assert found.coherence == pytest.approx(alike, rel=1e-9)
    assert found.uncertainty == pytest.approx(np.sqrt((1.0 - alike) / (12.0 * alike)), rel=1e-6)
    assert (found.averages, found.resolution) == (6, pytest.approx(1e3 / 64))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_delayed_copy_turns_the_transfer_function_and_costs_no_coherence(count):
    """0.9 of a transient, three samples later: magnitude 0.9 and phase -2 pi f 3 h at each line, coherence 1."""
    transient = np.exp(-0.5 * ((np.arange(64) - 20.0) / 1.5) ** 2) * np.cos(0.3 * np.arange(64))
    first = np.tile(transient, count)
    second = 0.9 * np.tile(np.roll(transient, 3), count)
    found = two_sensors._transfer(windows_of(first, second, count, 64), 1e-3, 3e-3)
    expected = 0.9 * np.exp(-2j * np.pi * found.frequency * 3e-3)
    assert found.h1 == pytest.approx(expected, abs=1e-7)  # the highest lines hold 1e-9 of the largest
    assert found.h2 == pytest.approx(expected, abs=1e-7)
    assert found.coherence == pytest.approx(np.ones(33))
    lines = {1: 5, 2: 3, 3: 2}[count]
    assert (found.averages, found.resolution) == (lines * count, pytest.approx(lines * 1e3 / 64))
    assert found.trusted == (0.0, 500.0)
    # within 10 % in magnitude and phase: |0.9 exp(-i a) - 1| < 0.1 at frequency 0 alone
    assert found.alike_to == 0.0 or abs(expected[1] - 1.0) < 0.1


def test_lines_are_trusted_above_ten_times_the_noise_and_alike_within_a_tenth():
    size = 64
    k = np.arange(size)
    first = sum(np.cos(2.0 * np.pi * j * k / size) for j in range(1, 11))
    second = sum((1.05 if j < 6 else 1.2) * np.cos(2.0 * np.pi * j * k / size) for j in range(1, 11))
    # a cosine has the one-sided power density size h / 2, white noise 2 h s^2
    for share, last in ((0.97, 10e3 / 64), (1.03, math.nan)):
        noise = share * math.sqrt(size / 4.0 / 10.0)
        windows = [two_sensors.Window(first, second, (noise, 0.0))] * 5
        found = two_sensors._transfer(windows, 1e-3, 0.0)
        assert found.trusted[1] == pytest.approx(last, nan_ok=True)
        assert found.trusted[0] == pytest.approx(1e3 / 64 if last > 0.0 else math.nan, nan_ok=True)
        assert found.alike_to == pytest.approx(5e3 / 64 if last > 0.0 else math.nan, nan_ok=True)


@pytest.mark.parametrize("gain", [0.7, -1.3])
def test_a_copy_has_its_delay_and_gain_exactly(gain):
    """Three samples and a half later, of a pulse that a sum of sines holds: what cutting the ends loses is 1e-4."""
    t = np.arange(256.0)
    first = np.exp(-0.5 * ((t - 100.0) / 6.0) ** 2)
    second = gain * np.exp(-0.5 * ((t - 103.5) / 6.0) ** 2)
    found = two_sensors._copied_below(two_sensors.Window(first, second, (0.0, 0.0)), 1e-3, math.inf)
    assert found.delay == pytest.approx(3.5e-3, rel=1e-4)
    assert found.gain == pytest.approx(gain, rel=1e-4)
    assert found.explained == pytest.approx(1.0, abs=1e-6)
    assert not found.ambiguous
    none = two_sensors._copied_below(two_sensors.Window(first, 0.0 * t, (0.0, 0.0)), 1e-3, math.inf)
    assert (none.delay, none.explained) == (0.0, 0.0)


def test_a_gain_is_as_uncertain_as_a_regression_says(rng):
    """A copy without delay in white noise: s / |x|, and the share of energy explained is r^2."""
    first = np.exp(-0.5 * ((np.arange(400.0) - 150.0) / 12.0) ** 2)
    noise = 0.05 * (-1.0) ** np.arange(400)
    second = 0.8 * first + noise
    found = two_sensors._copied_below(two_sensors.Window(first, second, (0.0, 0.0)), 1e-3, math.inf)
    power = np.sum(first**2)
    assert found.gain == pytest.approx(np.sum(first * second) / power, rel=1e-3)
    assert found.gain_doubt == pytest.approx(0.05 / math.sqrt(power), rel=1e-2)
    assert found.explained == pytest.approx(1.0 - 400 * 0.05**2 / np.sum(second**2), rel=1e-3)


def test_what_lies_before_and_about_a_blow():
    """A blow of 10 samples from 500 on: its zero and noise come from 400 to 10 samples before, and 32 are needed."""
    [blow] = find_pulses(np.where((np.arange(900) >= 500) & (np.arange(900) < 510), 5.0, 0.0), 1e-3)
    blow = dataclasses.replace(blow, begin=2.0 + 0.5, end=2.0 + 0.51, width=0.01)
    places = np.arange(900.0)
    assert two_sensors._quiet(places, 1e-3, 2.0, blow).tolist() == places[100:490].tolist()
    assert two_sensors._near(blow, 1e-3, 2.0, 900) == slice(490, 520)
    assert two_sensors._near(blow, 1e-3, 2.0, 515) == slice(490, 515)
    assert two_sensors._zero(places, 1e-3, 2.0, blow) == 294.5
    early = dataclasses.replace(blow, begin=2.0 + 0.041)
    assert two_sensors._zero(places, 1e-3, 2.0, early) == np.median(places)
    late = dataclasses.replace(blow, begin=2.0 + 0.042)
    assert two_sensors._zero(places, 1e-3, 2.0, late) == 15.5
    assert two_sensors._width(dataclasses.replace(blow, width=math.nan)) == blow.smooth.width()
    assert two_sensors._rigid(blow) == (
        blow.peak,
        blow.noise if math.isnan(blow.uncertainty.peak) else blow.uncertainty.peak,
    )


@pytest.mark.parametrize(("settles", "length"), [(0, 210), (300, 320), (2000, 1010)])
def test_a_window_lasts_until_both_channels_have_settled(settles, length):
    """From a width before the blow: 20 widths after its begin at least, a width after the last sample above a tenth of
    the peak, 100 widths after its begin at most."""
    [blow] = find_pulses(np.where((np.arange(3000) >= 500) & (np.arange(3000) < 510), 5.0, 0.0), 1e-3)
    blow = dataclasses.replace(blow, begin=0.5, end=0.51, width=0.01)
    first, second = np.zeros((2, 3000))
    first[500:510] = second[500:510] = 5.0
    second[510 : 490 + settles + 10] = 0.51
    found = two_sensors._window(first, second, 1e-3, 0.0, [blow], 0)
    assert found.first.size == found.second.size == (length if settles != 300 else 300 + 10 + 10)
    second[510:] = 0.49
    assert two_sensors._window(first, second, 1e-3, 0.0, [blow], 0).first.size == 210
    after = dataclasses.replace(blow, begin=0.62)
    assert two_sensors._window(first, second, 1e-3, 0.0, [blow, after], 0).first.size == 120
    assert two_sensors._window(first, second, 1e-3, 0.0, [blow, dataclasses.replace(blow, begin=0.52)], 0) is None
    assert found.noises == (0.0, 0.0)
    assert np.array_equal(found.first, first[490 : 490 + found.first.size])


def test_a_window_in_which_neither_channel_moves_is_none():
    [blow] = find_pulses(np.where((np.arange(3000) >= 500) & (np.arange(3000) < 510), 5.0, 0.0), 1e-3)
    silent = np.full(3000, 7.0)
    assert two_sensors._window(silent, silent, 1e-3, 0.0, [blow], 0) is None
    moves = silent + (np.arange(3000) == 505)
    for pair in ((silent, moves), (moves, silent)):
        assert two_sensors._window(*pair, 1e-3, 0.0, [blow], 0) is not None


@pytest.mark.parametrize(("height", "length"), [(0.81, 311), (0.79, 210)])
def test_a_window_lasts_until_both_channels_stay_below_four_noises(height, length):
    """Zeros of 3 and -7 with noise of 0.2 and 0.1 to both sides; in the first what stands above 0.8 counts."""
    [blow] = find_pulses(np.where((np.arange(3000) >= 500) & (np.arange(3000) < 510), 5.0, 0.0), 1e-3)
    blow = dataclasses.replace(blow, begin=0.5, end=0.51, width=0.01, noise=0.7)
    swing = (-1.0) ** np.arange(3000)
    first, second = 3.0 + 0.2 * swing, -7.0 + 0.1 * swing
    first[500:510] += 5.0
    second[500:510] += 5.0
    first[790] = 3.0 + height
    found = two_sensors._window(first, second, 1e-3, 0.0, [blow], 0)
    assert (found.first.size, found.second.size) == (length, length)
    assert found.noises == (pytest.approx(0.2), pytest.approx(0.1))
    assert found.cutoff == math.inf
    assert (found.first[300] if length > 300 else height) == pytest.approx(height)
    assert found.second[:10] == pytest.approx(0.1 * swing[:10])
    early = dataclasses.replace(blow, begin=0.041, end=0.051)  # 31 samples before it tell no noise
    few = two_sensors._window(np.roll(first, -459), np.roll(second, -459), 1e-3, 0.0, [early], 0)
    assert few.noises == (0.7, 0.7)
    for separable, cutoff in ((True, 900.0), (False, math.inf)):
        part = SimpleNamespace(separable=separable, cutoff=900.0)
        known = two_sensors._window(first, second, 1e-3, 0.0, [dataclasses.replace(blow, split=part)], 0)
        assert known.cutoff == cutoff


@pytest.mark.parametrize(("strongest", "low", "high"), [(4, 3, 5), (8, 7, 9)])
def test_lines_are_trusted_around_the_strongest_up_to_one_that_is_not(strongest, low, high):
    """Lines 3 to 9, of which the sixth is a quarter of the power that noise leaves sure; all are alike."""
    size = 64
    k = np.arange(size)
    heights = {j: 0.5 if j == 6 else 1.0 for j in range(3, 10)} | {strongest: 1.1}
    first = sum(height * np.cos(2.0 * np.pi * j * k / size) for j, height in heights.items())
    noise = 0.97 * math.sqrt(size / 4.0 / 10.0)
    windows = [two_sensors.Window(first, 1.05 * first, (noise, 0.0))] * 5
    found = two_sensors._transfer(windows, 1e-3, 0.0)
    assert found.trusted == pytest.approx((low * 1e3 / size, high * 1e3 / size))
    assert found.alike_to == pytest.approx(high * 1e3 / size)
