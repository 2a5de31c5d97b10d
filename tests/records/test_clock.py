"""An even clock: what is missing or uneven is mended and said; a rounded clock is an even one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records import calibration as clocks
from strikewave.records.calibration import even
from strikewave.records.health_notice import FIGURES
from strikewave.records.record import Channel

STEP = 1e-5


def put_even(stamps, values=None):
    """Return step, values, and severity by code."""
    stamps = np.asarray(stamps, dtype=float)
    values = stamps.copy() if values is None else np.asarray(values, dtype=float)
    channel, findings = even(Channel("a", values, stamps=stamps))
    return channel, {finding.code: finding for finding in findings}


def clock(size=20_000, step=STEP):
    return step * np.arange(size)


def test_an_even_clock_is_left_as_it_is():
    channel, said = put_even(clock(), np.arange(20_000))
    assert channel.step == pytest.approx(STEP, rel=1e-9)
    assert np.array_equal(channel.values, np.arange(20_000))
    assert said == {}


@pytest.mark.parametrize(("first", "count"), [(5000, 1), (5000, 5), (5000, 50), (100, 1900)])
def test_lost_samples_are_named_and_bridged_and_leave_the_rate(first, count):
    channel, said = put_even(np.delete(clock(), np.s_[first : first + count]))
    assert set(said) == {"gap"}
    assert said["gap"].value == pytest.approx(count * STEP, rel=1e-6)
    assert (said["gap"].severity, said["gap"].harms) == ("suspect", ("spectrum",))
    assert said["gap"].start == pytest.approx((first - 1) * STEP)
    assert channel.step == pytest.approx(STEP, rel=1e-9)
    assert np.allclose(channel.values, clock(), rtol=0, atol=1e-12)


def test_a_record_that_lacks_more_than_a_tenth_is_bad():
    _, said = put_even(np.delete(clock(), np.s_[100:3100]))
    assert (said["gap"].severity, said["gap"].harms) == ("bad", FIGURES)


def test_samples_lost_here_and_there_leave_the_rate(rng):
    kept = np.sort(rng.choice(20_000, 19_000, replace=False))
    channel, said = put_even(clock()[kept])
    assert channel.step == pytest.approx(STEP, rel=1e-9)
    assert said["gap"].value == pytest.approx((kept[-1] - kept[0] + 1 - kept.size) * STEP, rel=1e-6)


@pytest.mark.parametrize(
    ("step", "write"),
    [
        (5e-6, "{:.5f}"),
        (5e-6, "{:.6f}"),
        (1.3e-5, "{:.4f}"),
        (1.3e-5, "{:.5f}"),
        (5e-6, "{:.4g}"),
        (5e-6, "{:.6g}"),
        (1.234567e-6, "{:.6g}"),
        (1 / 48_000, "{:.5f}"),
    ],
)
def test_a_clock_rounded_to_few_digits_counts_as_even(step, write):
    stamps = np.array([float(write.format(t)) for t in clock(step=step)])
    values = np.arange(stamps.size)
    channel, said = put_even(stamps, values)
    assert said == {}
    assert np.array_equal(channel.values, values)
    assert channel.step == pytest.approx(step, rel=2e-5)
    assert channel.start == pytest.approx(0.0, abs=1e-4)


def test_a_clock_that_begins_late_loses_no_samples_to_its_large_numbers():
    channel, said = put_even(1e12 + clock(), np.arange(20_000))
    assert channel.values.size == 20_000
    assert channel.step == pytest.approx(STEP, rel=1e-3)
    assert said == {}


def test_jitter_is_named_by_its_size_and_taken_out(rng):
    for share, severity in ((0.02, "good"), (0.2, "suspect")):
        stamps = clock() + share * STEP * rng.uniform(-1.0, 1.0, 20_000)
        channel, said = put_even(stamps, 1e3 * stamps)
        assert set(said) == {"time-uneven"}
        assert said["time-uneven"].severity == severity
        assert said["time-uneven"].harms == ("spectrum",)
        assert channel.step == pytest.approx(STEP, rel=1e-3)
        assert np.allclose(channel.values[1:-1], 1e3 * channel.time[1:-1], rtol=0, atol=1e3 * STEP * 1e-6)


def test_a_time_that_stands_twice_keeps_its_first_sample():
    stamps = np.insert(clock(1000), 500, 499 * STEP)
    values = np.insert(np.arange(1000.0), 500, -7.0)
    channel, said = put_even(stamps, values)
    assert set(said) == {"time-twice"}
    assert said["time-twice"].value == 1
    assert np.array_equal(channel.values, np.arange(1000.0))


def test_time_that_runs_backwards_is_bad():
    stamps = clock()
    stamps[10_000:] -= 0.1
    _, said = put_even(stamps)
    assert (said["time-backwards"].severity, said["time-backwards"].harms) == ("bad", FIGURES)
    assert said["time-backwards"].start == pytest.approx(9999 * STEP)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e300, -1e300, 1.7e308])
def test_a_stamp_that_is_no_time_costs_its_sample_alone(wrong):
    stamps = clock(1000)
    stamps[[100, 700]] = wrong, -wrong
    channel, said = put_even(stamps, np.arange(1000))
    assert said["time-missing"].value == pytest.approx(0.002)
    assert channel.step == pytest.approx(STEP)
    assert np.allclose(channel.values, np.arange(1000))


def test_a_stamp_absurdly_far_away_takes_no_memory():
    stamps = clock(1000)
    stamps[-1] = 1e6
    channel, said = put_even(stamps)
    assert channel.values.size == 1000
    assert said["gap"].severity == "bad"
    assert "too long to be bridged" in said["gap"].message


@pytest.mark.parametrize("stamps", [[], [0.0], [np.nan] * 20, [1.0] * 20])
def test_a_clock_without_a_step_gives_too_few_samples_and_no_error(stamps):
    channel, _ = put_even(stamps, np.arange(len(stamps)))
    assert channel.values.size < 2


def test_two_samples_make_a_clock():
    channel, said = put_even([0.5, 0.75])
    assert (channel.step, channel.start, said) == (0.25, 0.5, {})


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 9.9e37])
def test_samples_that_are_no_numbers_are_bridged_and_counted(wrong):
    values = np.arange(1000.0)
    values[[0, 300, 301]] = wrong
    channel, findings = even(Channel("a", values, STEP))
    assert [f.code for f in findings] == ["not-a-number"]
    assert (findings[0].value, findings[0].severity, findings[0].harms) == (3, "suspect", ("spectrum",))
    assert channel.values[298:304].tolist() == [298, 299, 300, 301, 302, 303]
    assert channel.values[0] == 1.0


@pytest.mark.parametrize(("share", "severity"), [(0.05, "suspect"), (0.2, "bad"), (1.0, "bad")])
def test_many_samples_that_are_no_numbers_make_a_record_bad(share, severity):
    values = np.ones(1000)
    values[: int(share * 1000)] = np.nan
    _, findings = even(Channel("a", values, STEP))
    assert findings[0].severity == severity


@pytest.mark.parametrize("step", [np.nan, 0.0, -1.0])
def test_without_time_a_rate_is_asked_for(step):
    with pytest.raises(InputError, match="--rate"):
        even(Channel("board", np.ones(20), step))


@given(st.lists(st.one_of(st.floats(), st.integers(0, 100).map(lambda k: 1e-3 * k)), max_size=60))
def test_any_stamps_end_in_an_even_clock(stamps):
    channel, findings = put_even(stamps, np.ones(len(stamps)))
    assert channel.stamps is None
    assert channel.values.size <= 8 * len(stamps) + 2000
    assert channel.values.size < 2 or channel.step > 0.0
    assert all(finding.severity in ("good", "suspect", "bad") for finding in findings.values())


def test_gaps_are_told_with_the_longest_of_them():
    """Five, nine and two samples lost of 2000: 0.8 % of the record."""
    kept = np.delete(np.arange(2000), [*range(300, 305), *range(700, 709), 1500, 1501])
    _, said = put_even(3.0 + 0.5 * kept)
    assert said["gap"].value == pytest.approx(8.0)
    assert (said["gap"].start, said["gap"].end) == (3.0 + 0.5 * 699, 3.0 + 0.5 * 709)
    assert "3 gaps in time, 0.80 % of the record, the longest 5\xa0s after 352.5" in said["gap"].message


@pytest.mark.parametrize(("lost", "severity"), [(99, "suspect"), (101, "bad")])
def test_a_tenth_of_a_record_may_be_lost(lost, severity):
    kept = np.delete(np.arange(1001), range(300, 300 + lost))
    assert put_even(STEP * kept)[1]["gap"].severity == severity
    values = np.arange(1000.0)
    values[300 : 300 + lost] = np.nan
    assert even(Channel("a", values, STEP))[1][0].severity == severity


@pytest.mark.parametrize(("step", "rounding", "seen"), [(1.49, 0.0, 0), (1.51, 0.0, 1), (1.69, 0.2, 0), (1.71, 0.2, 1)])
def test_a_gap_is_a_step_and_a_half_and_what_rounding_does(step, rounding, seen):
    steps = np.array([1.0, 1.0, step, 1.0])
    stamps = np.cumsum([0.0, *steps])
    assert len(clocks._gaps(stamps, steps, (1.0, rounding), True)) == seen


@pytest.mark.parametrize(
    ("stray", "severity"), [(0.0099, None), (0.0101, "good"), (0.099, "good"), (0.101, "suspect"), (-0.101, "suspect")]
)
def test_stamps_that_stray_by_more_than_a_hundredth_are_uneven(stray, severity):
    """A tenth harms the spectrum; the step is that between first and last."""
    stamps = clock(2000)
    stamps[700] += stray * STEP
    channel, said = put_even(stamps)
    assert [(one.code, one.severity) for one in said.values()] == ([("time-uneven", severity)] if severity else [])
    assert channel.step == pytest.approx(STEP, rel=1e-12)
    if severity:
        assert said["time-uneven"].value == pytest.approx(abs(stray) * STEP, rel=1e-9)
        assert channel.values == pytest.approx(clock(2000), abs=1e-15)


@pytest.mark.parametrize(("every", "uneven"), [(16, False), (22, True)])
def test_where_a_tenth_of_the_steps_are_odd_stamps_may_stray_by_their_digit(every, uneven):
    """Steps of ten digits, one later in the first half and one earlier in the second, but for each 16th or 22nd: 12.5 or
    9.1 % of the steps are odd. No straight line goes through all within a digit."""
    k = np.arange(2001)
    off = np.where(k % every == 0, 0, np.where(k < 1000, 1, -1))
    off[-1] = 0
    _, said = put_even((10 * k + off) * 1e-6)
    assert ("time-uneven" in said) is uneven


@pytest.mark.parametrize(("last", "bridged"), [(1399, True), (1400, False)])
def test_gaps_are_bridged_up_to_four_times_the_samples_and_a_thousand(last, bridged):
    stamps = np.r_[np.arange(99.0), last]
    channel, said = put_even(stamps)
    assert channel.values.size == (last + 1 if bridged else 100)
    assert ("too long" in said["gap"].message) is not bridged


@pytest.mark.parametrize(("count", "severity"), [(66, "suspect"), (67, "bad")])
def test_stamps_that_stand_twice_are_several_channels_where_two_fifths_do(count, severity):
    """Of 166 kept samples 66.4 are that."""
    stamps = np.repeat(np.arange(166.0), np.where(np.arange(166) < count, 2, 1))
    said = put_even(stamps)[1]["time-twice"]
    assert (said.severity, said.value) == (severity, count)
    assert said.harms == (FIGURES if severity == "bad" else ())


@pytest.mark.parametrize(("odd", "step"), [(1.49, 1.049), (1.51, 1.0), (0.51, 0.951), (0.49, 1.0)])
def test_the_step_is_the_mean_of_those_within_a_half_of_the_usual(odd, step):
    steps = np.ones(100)
    steps[::10] = odd
    assert put_even(np.cumsum([0.0, *steps]))[0].step == pytest.approx(step)


@pytest.mark.parametrize(
    ("stamps", "digit"),
    [
        ([0.123, 0.456], 1e-3),
        ([0.1, 0.4], 1e-3),
        ([0.1, 0.45678], 1e-5),
        ([1234.5, 1299.0], 0.1),
        ([10.05, 20.0], 1e-2),
        ([0.0012345, 2.5], 1e-2),
        ([1.0 / 3.0, 0.5], 2.0**-53),
        ([0.0, 0.0], 0.0),
        ([1e9, 2e9], 1e7),
    ],
)
def test_the_last_digit_of_the_largest_stamps(stamps, digit):
    """Three digits at least are looked for; smaller stamps than the largest decade have others."""
    assert clocks._last_digit(np.array(stamps)) == pytest.approx(digit, rel=1e-9, abs=0.0)
    assert clocks._last_digit(-np.array(stamps)) == pytest.approx(digit, rel=1e-9, abs=0.0)
    assert clocks._last_digit(np.r_[0.777777777 * stamps[0], np.resize(stamps, 50)]) == pytest.approx(
        digit, rel=1e-9, abs=0.0
    )
    assert clocks._last_digit(np.r_[0.111111 * np.ones(450), 0.2 * np.ones(50)]) == pytest.approx(1e-3)
    assert clocks._last_digit(np.r_[0.111111 * np.ones(449), 0.2 * np.ones(49)]) == pytest.approx(1e-6)
    assert clocks._last_digit(np.r_[0.111111 * np.ones(541), 0.2 * np.ones(59)]) == pytest.approx(1e-6)


def test_what_is_missing_is_told_with_its_time():
    values = np.arange(1000.0)
    values[[300, 400, 401]] = np.nan
    _, [found] = even(Channel("a", values, 0.5, 7.0))
    assert found.start == 157.0
    assert "3 samples (0.30 %)" in found.message
    for size, counts in ((1e30, False), (0.99e30, True)):
        _, findings = even(Channel("a", np.array([1.0, 2.0, size, 3.0]), 1.0))
        assert (findings == []) is counts


def test_a_late_begin_is_kept_by_every_way_a_clock_is_mended():
    """Even, rounded, uneven and with a gap: the first sample stays where it was."""
    rounded = np.round((7.0 + clock(2000, 1.3e-5)), 5)
    uneven = 7.0 + clock(2000)
    uneven[700] += 0.05 * STEP
    for stamps, start in ((7.0 + clock(2000), 7.0), (rounded, 7.0), (uneven, 7.0), (np.delete(7.0 + clock(), 50), 7.0)):
        channel, _ = put_even(stamps)
        assert channel.start == pytest.approx(start, abs=1e-5)
        assert channel.start + channel.step * (channel.values.size - 1) == pytest.approx(stamps[-1], abs=1e-5)


def test_time_that_runs_backwards_is_sorted_with_its_samples():
    stamps = np.array([0.0, 1.0, 2.0, 5.0, 6.0, 3.0, 4.0, 7.0])
    channel, said = put_even(stamps, 10.0 * stamps)
    assert channel.values.tolist() == [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0]
    assert (said["time-backwards"].value, said["time-backwards"].start) == (1, 6.0)
    assert "once" in said["time-backwards"].message
    assert "2 times" in put_even(np.array([0.0, 2.0, 1.0, 4.0, 3.0]))[1]["time-backwards"].message
