"""Blows told from rebounds, double hits, ringing and gaps, in records whose contacts are known."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.records import Channel, Record, Request, contacts, find_pulses, read_file
from strikewave.records._pulse_kernels import best_chains
from strikewave.records.contacts import (
    BlowTrain,
    Contacts,
    find_train,
    gaps_of,
    mains_period,
    missing_of,
    sort_contacts,
)

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
def test_two_hits_a_little_more_than_their_length_apart_are_mark_responses(apart, ratio):
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


def chains_by_hand(times, weights, period, penalty, most, jitter):
    """Return the weight of the best of all chains that end at each contact, by trying every set of contacts."""
    best = np.full(times.size, -np.inf)
    for chosen in itertools.product((False, True), repeat=times.size):
        members = np.flatnonzero(chosen)
        if not members.size:
            continue
        gaps = np.diff(times[members]) / period
        counts = np.rint(gaps)
        if np.all((counts >= 1) & (counts <= most) & (np.abs(gaps - counts) < jitter)):
            score = np.sum(weights[members]) - penalty * np.sum(counts - 1.0)
            best[members[-1]] = max(best[members[-1]], score)
    return best


@settings(max_examples=30)
@given(st.lists(st.floats(0.0, 9.0), min_size=1, max_size=8, unique=True), st.integers(0, 999))
def test_the_best_chain_is_the_best_of_all(times, seed):
    times, weights = np.sort(times), np.random.default_rng(seed).uniform(0.1, 1.0, len(times))
    score, before = best_chains(times, weights, 1.3, 0.23, 3, 0.2)
    assert score == pytest.approx(chains_by_hand(times, weights, 1.3, 0.23, 3, 0.2), rel=1e-12)
    for k, earlier in enumerate(before):
        if earlier >= 0:
            count = np.rint((times[k] - times[earlier]) / 1.3)
            assert score[k] == pytest.approx(weights[k] + score[earlier] - 0.23 * (count - 1.0))
        else:
            assert score[k] == weights[k]


def test_a_chain_is_told_in_the_order_of_time():
    times = np.array([0.0, 0.4, 1.0, 2.0, 2.3, 4.0])
    weights = np.array([5.0, 1.0, 4.0, 6.0, 0.5, 3.0])
    assert contacts._chain(times, weights, 1.0, 0.7) == (pytest.approx(5.0 + 4.0 + 6.0 + 3.0 - 0.7), [0, 2, 3, 5])


@pytest.mark.parametrize(("gap", "more"), [(4.14, True), (4.16, False), (3.86, True), (3.84, False), (5.0, False)])
def test_a_train_goes_on_after_four_periods_at_most(gap, more):
    """Kept to 15 % of a period; a blow of the usual size outweighs those that are missing."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 4.0 + gap])
    train = find_train(times, np.ones(6))
    assert train.members == tuple(range(6 if more else 5))
    assert train.period == 1.0


@pytest.mark.parametrize(("peak", "more"), [(0.23, True), (0.215, False)])
def test_a_small_blow_after_a_gap_is_of_the_train_where_its_square_is_worth_it(peak, more):
    """A missing blow costs half of a usual square, and a tenth of that once the period is known."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0])
    assert find_train(times, 3.0 * np.array([1.0, 1.0, 1.0, 1.0, 1.0, peak])).members == tuple(range(6 if more else 5))


def test_a_train_that_lacks_two_blows_is_none_of_twice_the_period():
    """Of 0 1 2 . 4 . 6 the period 1 costs two halves, the period 2 a blow."""
    assert find_train(np.array([0.0, 1.0, 2.0, 4.0, 6.0]), np.ones(5)).period == 1.0
    assert find_train(np.array([0.0, 0.9, 2.0, 4.0, 6.0, 8.0]), np.array([9.0, 1.0, 9.0, 9.0, 9.0, 9.0])).period == 2.0


def test_jitter_is_the_median_deviation_of_gaps_over_the_period():
    times = np.cumsum([0.0, 1.0, 1.02, 0.97, 1.1, 1.0])
    train = find_train(times, np.ones(6))
    assert train.period == pytest.approx(1.0)
    assert train.jitter == pytest.approx(0.02)
    two = find_train(np.array([0.0, 1.0, 2.1]), np.ones(3))
    assert (two.members, two.period) == ((0, 1, 2), pytest.approx(1.05))
    assert find_train(np.array([0.0, 1.0, 2.6]), np.ones(3)) is None


@pytest.mark.parametrize(
    ("gaps", "period"),
    [
        ([1.0, 2.0, 2.1, 2.2], 1.0),
        ([2.0, 2.2, 1.0, 2.1, 2.3], 2.15),
        ([1.0, 1.29, 1.31], 1.145),
        ([3.0, 1.0, 0.9, 1.1, 2.0], 1.0),
    ],
)
def test_the_common_period_is_that_of_gaps_near_the_shortest_quarter(gaps, period):
    assert contacts._common_period(np.array(gaps)) == pytest.approx(period)


def test_gaps_lie_off_a_period_by_their_mean():
    assert contacts._off_period(np.array([0.0, 2.1, 4.0, 10.2]), 2.0) == pytest.approx((0.05 + 0.05 + 0.1) / 3.0)
    assert contacts._off_period(np.array([3.0]), 2.0) == math.inf


def test_periods_are_tried_up_to_the_sixth_neighbour_and_a_twentieth_apart():
    """Of 1, 2, 4 ... to 256 each gap 2^b - 2^a is one of its own; two that differ by less than a step are one."""
    times = 2.0 ** np.arange(9)
    found = contacts._periods(times)
    expected = {2.0**b - 2.0**a for a in range(9) for b in range(a + 1, min(a + 7, 9))}
    assert all(np.min(np.abs(found / gap - 1.0)) < 0.025 for gap in expected)
    assert all(min(abs(one / gap - 1.0) for gap in expected) < 0.025 for one in found)
    assert contacts._periods(np.array([0.0, 0.0, 1.0])).tolist() == [1.0]
    assert contacts._periods(np.array([0.0, 1.0, 2.25])).tolist() == [1.0, 1.25, 2.25]
    long = np.arange(406.0)
    long[400:] += 0.5 * np.arange(1.0, 7.0)
    assert not np.any(np.abs(contacts._periods(long) - 1.5) < 0.1)
    assert contacts._periods(np.arange(5.0)).tolist() == [1.0, 2.0, 3.0, 4.0]


@pytest.mark.parametrize(
    ("beside", "large", "regular"),
    [
        ([0.3, 1.4, 2.3, 3.6], 0.61, False),
        ([0.3, 1.4, 2.3, 3.6], 0.59, True),
        ([0.3, 1.4, 2.3], 0.61, True),
        ([0.3, 1.3, 2.3, 3.3], 0.61, True),
        ([0.276, 1.276, 2.324, 3.324], 0.61, False),
        ([0.279, 1.279, 2.321, 3.321], 0.61, True),
        ([-1.4, 9.5, 9.9], 0.61, True),
        ([-1.4, -1.2, 9.5, 9.9], 0.61, False),
        ([-1.4, -1.2, 9.5, 9.9], 0.59, True),
    ],
)
def test_what_lies_beside_a_train_is_rare_or_always_as_late(beside, large, regular):
    """Of nine members three may be beside them inside, or the median lag differs by 7.5 %; three outside, for of four
    the train would need ten members."""
    members = np.arange(9.0)
    times = np.concatenate([members, beside])
    peaks = np.concatenate([np.full(9, 2.0), np.full(len(beside), 2.0 * large)])
    order = np.argsort(times)
    on = [int(k) for k in np.flatnonzero(order < 9)]
    assert contacts._regular(times[order], peaks[order], on) is regular


def test_of_a_short_train_one_is_let_pass_beside_it():
    times, peaks = np.array([0.0, 0.4, 1.0, 2.0]), np.ones(4)
    assert contacts._regular(times, peaks, [0, 2, 3])
    assert not contacts._regular(np.array([0.0, 0.4, 1.0, 1.7, 2.0]), np.ones(5), [0, 2, 4])


def late_of(lags, peaks, blows=None):
    """Return which of the contacts so long after blows of 4, one a second, are as late as the others."""
    count = len(lags)
    times = np.concatenate([np.arange(float(count)), np.arange(float(count)) + lags])
    order = np.argsort(times, kind="stable")
    place = {int(old): new for new, old in enumerate(order)}
    sizes = np.concatenate([np.full(count, 4.0), peaks])[order]
    blow_of = {place[count + k]: place[k] for k in range(count)}
    found = contacts._as_late(times[order], sizes, blow_of, count if blows is None else blows)
    return sorted(k for k in range(count) if place[count + k] in found)


def test_rebounds_come_as_late_as_one_another_and_are_smaller():
    assert late_of([0.2, 0.2, 0.229, 0.231, 0.171, 0.169], np.full(6, 3.9)) == [0, 1, 2, 4]
    assert late_of([0.2] * 4, [4.1, 4.1, 3.9, 3.9]) == [0, 1, 2, 3]
    assert late_of([0.2] * 4, [4.1, 4.1, 4.1, 3.9]) == []  # a fourth is smaller, a third and more is asked
    assert late_of([0.2] * 3, [1.0] * 3, 7) == [0, 1, 2]
    assert late_of([0.2] * 3, [1.0] * 3, 8) == []
    assert late_of([0.2], [1.0], 1) == []
    assert late_of([0.2, 0.2], [1.0] * 2, 1) == [0, 1]
    assert late_of([0.2, 0.2, 0.4, 0.5], [1.0] * 4, 6) == []  # about a median of 0.3 no three
    assert late_of([-0.1, 0.2, 0.2, 0.2], [1.0] * 4) == [1, 2, 3]  # one before its blow is none of it


def test_contacts_without_a_train_belong_to_the_nearest_that_is_larger():
    """Smaller than 0.6 of one within 20 of its widths; small ones are no blows of their own."""
    peaks, widths = np.array([10.0, 5.9, 6.1]), np.array([0.1, 0.3, 0.3])
    for lag, owner in ((1.99, {1: 0}), (2.01, {})):
        found = contacts._without_train(np.array([0.0, lag, 1e3]), peaks, widths, [False] * 3)
        assert found.owner == owner
        assert found.blows == ((0, 2) if owner else (0, 1, 2))
    assert contacts._without_train(np.array([0.0, 1.0]), np.array([10.0, 6.1]), widths, [False] * 2).blows == (0, 1)
    assert contacts._without_train(np.array([0.0, 1.0]), np.array([10.0, 6.1]), widths, [False, True]).blows == (0,)
    three = contacts._without_train(np.array([0.0, 3.0, 4.0]), np.array([9.0, 1.0, 8.0]), np.full(3, 0.5), [False] * 3)
    assert three.owner == {1: 2}
    three = contacts._without_train(np.array([0.0, 1.0, 4.0]), np.array([9.0, 1.0, 8.0]), np.full(3, 0.5), [False] * 3)
    assert three.owner == {1: 0}


@pytest.mark.parametrize(("apart", "double"), [(1.99, {1: 0}), (2.01, {})])
def test_two_as_large_within_five_of_the_wider_width_are_a_double_hit(apart, double):
    for widths in ([0.4, 0.3], [0.3, 0.4]):
        found = contacts._without_train(np.array([0.0, apart]), np.array([9.0, 8.0]), np.array(widths), [False] * 2)
        assert (found.blows, found.owner, found.double, found.train) == ((0, 1), {}, double, None)


def test_what_lies_beside_a_train_is_a_rebound_or_half_of_a_double_hit():
    """As large as 0.6 of its blow and nearer than half a period to one, before it too; else it is a blow."""
    times = np.array([0.0, 1.0, 1.3, 2.0, 3.0, 3.7, 4.0, 5.0, 6.0])
    for peak, owner, double in ((5.9, {2: 1, 5: 4}, {}), (6.1, {}, {2: 1, 5: 6})):
        peaks = np.array([10.0, 10.0, peak, 10.0, 10.0, peak, 10.0, 10.0, 10.0])
        found = sort_contacts(times, peaks, np.full(9, 0.01), [False] * 9)
        assert (found.owner, found.double) == (owner, double)
        assert found.train.members == (0, 1, 3, 4, 6, 7, 8)
        assert found.blows == tuple(k for k in range(9) if k not in owner)
    peaks[2] = peaks[5] = 9.0
    small = [k == 2 for k in range(9)]
    assert sort_contacts(times, peaks, np.full(9, 0.01), small).owner == {2: 1}
    early = sort_contacts(np.array([-0.4, *range(6)]), np.array([3.0, *[9.0] * 6]), np.full(7, 0.01), [False] * 7)
    assert early.owner == {0: 1}
    for place, double in ((7.4, {}), (6.4, {7: 6})):
        lone = sort_contacts(np.array([*range(7), place]), np.full(8, 9.0), np.full(8, 0.01), [False] * 8)
        assert (lone.double, lone.owner) == (double, {})


def test_a_train_of_what_is_small_beside_a_blow_is_none():
    """Of contacts of 0.55 of a blow that is not among them; with one of 0.65 they are blows."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 3.4])
    for share, train in ((0.55, None), (0.65, (0, 1, 2, 3))):
        found = sort_contacts(times, 50.0 * np.array([share, share, share, share, 1.0]), np.full(5, 0.5), [False] * 5)
        assert (found.train and found.train.members) == train


@pytest.mark.parametrize(("members", "jitter", "sure"), [(4, 0.049, True), (3, 0.0, False), (4, 0.0502, False)])
def test_gaps_are_missing_blows_where_a_train_is_sure(members, jitter, sure):
    """Four members, and a jitter below half of a tenth; blows are then missing at equal parts of the gap."""
    times = np.array([0.0, 1.0, 2.0, 3.0][:members])
    times = np.append(times, times[-1] + 3.15)
    train = BlowTrain(tuple(range(times.size))[-members:], 1.0, jitter)
    contacts = Contacts(tuple(range(times.size)), {}, {}, train)
    missing = missing_of(times, contacts)
    assert missing == (pytest.approx([times[-2] + 1.05, times[-2] + 2.1]) if sure else [])
    assert len(gaps_of(times, contacts)) == times.size - (2 if sure else 1)
    times[-1] = times[-2] + 3.31  # a third of it is a tenth off
    assert missing_of(times, contacts) == []
    times[-1] = times[-2] + 1.49
    assert missing_of(times, contacts) == []
    assert len(gaps_of(times, contacts)) == times.size - 1
    assert missing_of(times, contacts._replace(train=None)) == []
    assert len(gaps_of(times, contacts._replace(double={1: 0}))) == times.size - (3 if sure else 2)


def test_contacts_in_step_with_the_mains():
    """The median gap within 1 %, or mean and most gaps within 0.5 %; blips last a fortieth of a whole period at least."""
    wide = np.full(4, 2e-3)

    def found(gaps, widths=wide, **more):
        return mains_period(np.cumsum([0.0, *gaps]), widths, **more)

    for period in (20e-3, 10e-3, 1.0 / 60.0, 1.0 / 120.0):
        for share, seen in ((1.009, True), (1.011, False), (0.991, True), (0.989, False)):
            assert found([share * period] * 3) == (period if seen else pytest.approx(math.nan, nan_ok=True))
        for share, seen in ((1.0049, True), (1.0051, False), (0.9951, True), (0.9949, False)):
            locked = found([share * period] * 3, locked=True)
            assert locked == (period if seen else pytest.approx(math.nan, nan_ok=True))
        whole = period if period > 15e-3 else 2.0 * period
        for share, seen in ((0.0251, True), (0.0249, False)):
            assert (found([period] * 3, np.full(4, share * whole)) == period) is seen
    scattered = [0.98 * 20e-3, 1.02 * 20e-3, 20e-3, 20e-3, 20e-3]
    assert found(scattered, locked=True) == 20e-3  # most are on it
    assert math.isnan(found([0.98 * 20e-3, 1.02 * 20e-3, 0.98 * 20e-3, 1.02 * 20e-3], locked=True))
    assert math.isnan(found([20e-3]))
    assert found([20e-3, 20e-3]) == 20e-3
