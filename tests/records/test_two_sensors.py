"""Two sensors on one object: planted delays and gains, bars in closed form, and what is refused."""

import math

import numpy as np
import pytest

from strikewave.base.percents import beside_doubt
from strikewave.records import find_pulses
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
