"""Blows told from rebounds, double hits, ringing and gaps, in records whose contacts are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.records import Channel, Record, Request, find_pulses, read_file
from strikewave.records.trains import find_train, gaps_of, missing_of, sort_contacts

RATE, DURATION, PEAK = 100e3, 300e-6, 1000.0
WIDTH = 0.936 * DURATION


def half_sine(time, begin, peak=PEAK, duration=DURATION):
    u = (time - begin) / duration
    return np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0)


def train_of(begins, peaks, seed=1, noise=3.0, after=0.02):
    time = np.arange(int((max(begins) + after) * RATE)) / RATE
    values = noise * np.random.default_rng(seed).normal(size=time.size)
    return time, values + sum(half_sine(time, b, p) for b, p in zip(begins, peaks, strict=True))


def reading_of(values, rate=RATE):
    return read_file(Record("a", "text", (Channel("c", values, 1.0 / rate, unit="g"),)), {}, Request()).channels[0]


def begins_of(count, period=20e-3, jitter=0.005, seed=3):
    return 0.01 + period * (np.arange(count) + jitter * np.random.default_rng(seed).normal(size=count))


def codes(reading):
    return {finding.code: finding for finding in reading.findings}


@pytest.mark.parametrize("count", [1, 2, 7, 11])
@pytest.mark.parametrize(("share", "lag"), [(0.3, 0.8e-3), (0.15, 2e-3), (0.5, 0.6e-3)])
def test_rebounds_belong_to_their_blows(count, share, lag):
    begins = begins_of(count)
    time, values = train_of(begins, [PEAK] * count)
    values += sum(half_sine(time, b + lag, share * PEAK) for b in begins)
    reading = reading_of(values)
    assert len(reading.pulses) == count
    assert [len(pulse.rebounds) for pulse in reading.pulses] == [1] * count
    for pulse in reading.pulses:
        [rebound] = pulse.rebounds
        assert rebound.time - pulse.time == pytest.approx(lag, abs=2.0 / RATE)  # noise moves a flat top by two samples
        assert rebound.peak / pulse.peak == pytest.approx(share, abs=0.02)  # noise of 3 in 150
        assert rebound.velocity_change / pulse.velocity_change == pytest.approx(share, rel=0.05)
    assert codes(reading)["rebound"].severity == "good"
    assert reading.figures("interval") == pytest.approx(np.diff(begins), abs=2.0 / RATE)


@pytest.mark.parametrize("seed", range(4))
def test_blows_of_a_train_are_blows_however_small(seed):
    """Peaks that scatter by 40 %, the smallest a sixth of the largest."""
    scatter = np.random.default_rng(seed).normal(size=11)
    peaks = PEAK * np.clip(1.0 + 0.4 * scatter, 0.3, 1.8)
    _, values = train_of(begins_of(11), peaks)
    reading = reading_of(values)
    assert [pulse.peak / 9.80665 for pulse in reading.pulses] == pytest.approx(peaks, rel=0.02)
    assert not set(codes(reading)) & {"rebound", "double-hit", "missing-blow"}


@pytest.mark.parametrize("first", [1.1, 1.3])
def test_a_first_blow_that_is_larger_is_one_of_the_train(first):
    _, values = train_of(begins_of(11), [first * PEAK] + [PEAK] * 10)
    assert len(find_pulses(values, 1.0 / RATE)) == 11


@pytest.mark.parametrize("gone", [[1], [5], [9], [3, 4]])
def test_a_missing_blow_is_named_with_its_time_and_leaves_the_interval(gone):
    begins = begins_of(11)
    left = np.delete(begins, gone)
    _, values = train_of(left, [PEAK] * left.size)
    reading = reading_of(values)
    finding = codes(reading)["missing-blow"]
    assert finding.value == len(gone)
    assert (finding.start, finding.end) == pytest.approx(begins[[gone[0], gone[-1]]] + 0.5 * DURATION, abs=1e-3)
    gaps = np.diff(left)
    assert reading.figures("interval") == pytest.approx(gaps[gaps < 30e-3], abs=2.0 / RATE)


def test_a_double_hit_in_a_train_is_named_and_both_count():
    begins = begins_of(9)
    time, values = train_of(begins, [PEAK] * 9)
    values += half_sine(time, begins[4] + 2e-3, 0.9 * PEAK)
    reading = reading_of(values)
    assert len(reading.pulses) == 10
    finding = codes(reading)["double-hit"]
    assert finding.severity == "suspect"
    assert finding.start == pytest.approx(begins[4], abs=20e-6)
    assert reading.figures("interval") == pytest.approx(np.diff(begins), abs=2.0 / RATE)


def test_two_equal_blows_close_together_are_a_double_hit():
    _, values = train_of([0.01, 0.01 + 4.0 * DURATION], [PEAK, 0.9 * PEAK])
    reading = reading_of(values)
    assert len(reading.pulses) == 2
    assert "double-hit" in codes(reading)


@pytest.mark.parametrize("apart", [1.0, 1.2, 1.5, 2.0, 2.5, 3.0])
@pytest.mark.parametrize("ratio", [1.0, 0.8])
def test_two_hits_a_little_more_than_their_length_apart_are_told_apart(apart, ratio):
    _, values = train_of([0.01, 0.01 + apart * DURATION], [PEAK, ratio * PEAK])
    reading = reading_of(values)
    assert [pulse.peak / 9.80665 for pulse in reading.pulses] == pytest.approx([PEAK, ratio * PEAK], rel=0.02)
    assert [pulse.smooth.peak / 9.80665 for pulse in reading.pulses] == pytest.approx([PEAK, ratio * PEAK], rel=0.02)
    assert "double-hit" in codes(reading)


@pytest.mark.parametrize("frequency", [5e3, 8e3, 12e3])
@pytest.mark.parametrize("share", [0.6, 1.0])
def test_a_blow_that_rings_strongly_is_one_blow(frequency, share):
    time, values = train_of([0.01], [PEAK])
    since = np.maximum(time - 0.01, 0.0)
    values += share * PEAK * np.exp(-since / 1e-3) * np.sin(2.0 * np.pi * frequency * since)
    assert len(find_pulses(values, 1.0 / RATE)) == 1


@pytest.mark.verify
def test_ringing_that_is_folded_down_is_no_second_blow():
    """30 shots of a half-sine of 12 samples; 22 kHz, half the peak, sampled at 25.6 kHz: it looks like 3.6 kHz."""
    rate, counts = 25.6e3, []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        time = np.arange(5000) / rate
        begin = 0.05 + rng.random() / rate
        since = np.maximum(time - begin, 0.0)
        ringing = 0.6 * PEAK * np.exp(-since / 1e-3) * np.sin(2.0 * np.pi * 22e3 * (1.0 + 0.02 * rng.normal()) * since)
        values = half_sine(time, begin) + ringing + 3.0 * rng.normal(size=time.size)
        counts.append(len(find_pulses(values, 1.0 / rate)))
    assert counts == [1] * 30


@settings(derandomize=True, max_examples=40, deadline=None)
@given(
    count=st.integers(3, 30),
    share=st.floats(0.05, 0.55),
    lag=st.floats(0.02, 0.42),
    jitter=st.floats(0.0, 0.02),
    scatter=st.floats(0.0, 0.2),
    seed=st.integers(0, 2**16),
)
def test_the_train_of_any_period_is_found_among_its_rebounds(count, share, lag, jitter, scatter, seed):
    rng = np.random.default_rng(seed)
    period = 10.0 ** rng.uniform(-4.0, 2.0)
    begins = period * (np.arange(count) + jitter * rng.uniform(-1.0, 1.0, size=count))
    peaks = 1.0 + scatter * rng.uniform(-1.0, 1.0, size=count)
    times = np.concatenate([begins, begins + lag * period])
    order = np.argsort(times)
    sizes = np.concatenate([peaks, share * peaks])[order]
    contacts = sort_contacts(times[order], sizes, np.full(2 * count, 1e-3 * period), [False] * (2 * count))
    assert set(contacts.blows) == {int(np.flatnonzero(order == k)[0]) for k in range(count)}
    assert all(times[order][k] - times[order][b] > 0.0 for k, b in contacts.owner.items())
    assert len(contacts.owner) == count
    assert missing_of(times[order], contacts) == []
    assert len(gaps_of(times[order], contacts)) == count - 1


@pytest.mark.verify
def test_contacts_at_random_times_are_no_train_with_gaps(rng):
    """Blows by hand: no missing blow is named in more than one record of ten."""
    named = 0
    for _ in range(200):
        times = np.cumsum(rng.uniform(0.5, 2.0, size=8))
        contacts = sort_contacts(times, np.ones(8), np.full(8, 1e-3), [False] * 8)
        assert len(contacts.blows) == 8
        named += bool(missing_of(times, contacts))
    assert named <= 20


def test_fewer_than_three_contacts_are_no_train():
    assert find_train(np.array([0.0, 1.0]), np.ones(2)) is None
    assert sort_contacts(np.empty(0), np.empty(0), np.empty(0), []).blows == ()


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_a_part_of_a_blow_at_the_edge_of_a_train_is_named(at_end, share):
    begins = begins_of(5)
    _, values = train_of(begins, [PEAK] * 5)
    place = round((begins[-1 if at_end else 0] + share * DURATION) * RATE)
    reading = reading_of(values[:place] if at_end else values[place:])
    assert len(reading.pulses) in (4, 5)
    assert "cut" in codes(reading)
    whole = reading_of(values)
    assert "cut" not in codes(whole)


def test_a_double_hit_among_rebounds_keeps_its_figures():
    """The second hit lies between the first and its rebound; no pulse without ringing is made of the three."""
    begins = begins_of(7)
    time, values = train_of(begins, [PEAK] * 7)
    values += sum(half_sine(time, b + 0.8e-3, 0.3 * PEAK) for b in begins)
    values += half_sine(time, begins[2] + 1.5 * DURATION, 0.9 * PEAK)
    reading = reading_of(values)
    assert [pulse.peak / 9.80665 for pulse in reading.pulses] == pytest.approx(
        [PEAK] * 3 + [0.9 * PEAK] + [PEAK] * 4, rel=0.02
    )
    assert all(pulse.rigid is None for pulse in reading.pulses)
    assert "double-hit" in codes(reading)
