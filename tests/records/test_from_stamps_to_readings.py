"""The way of a channel from its stamps to its reading, part by part: each limit from both sides, figures by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import calibration, pulse_shape, reading, response, ringing, sample_store, tail
from strikewave.records.calibration import ChannelCalibration, even
from strikewave.records.health_notice import FIGURES, HealthNotice
from strikewave.records.reading import (
    ChannelReading,
    FileReading,
    Request,
    filter_changes,
    filtered_channel,
    read_file,
    repeats,
)
from strikewave.records.record import Channel, Record
from strikewave.records.response import FreeDecay, swings, zero_before
from strikewave.records.robust import alike_as_one
from strikewave.signal.filters import Filter, HighPass

NAN = math.nan
STEP = 2.0**-12


def mended(stamps, values=None):
    stamps = np.asarray(stamps, float)
    channel, findings = even(
        Channel("a", np.arange(float(stamps.size)) if values is None else np.asarray(values, float), stamps=stamps)
    )
    return channel, {finding.code: finding for finding in findings}


# Clocks


@pytest.mark.parametrize(("more", "found"), [(0.49, False), (0.51, True)])
def test_a_step_of_one_and_a_half_is_a_gap(more, found):
    stamps = 3.0 + STEP * np.arange(100.0)
    stamps[40:] += more * STEP
    _, said = mended(stamps)
    assert ("gap" in said) is found
    if found:
        gap = said["gap"]
        assert (gap.value, gap.start, gap.end) == (pytest.approx(more * STEP, rel=0.05), stamps[39], stamps[40])


def test_a_gap_is_as_long_as_it_says_and_bridged_by_a_straight_line():
    stamps = 5.0 + STEP * np.delete(np.arange(60.0), [20, 40, 41, 42])
    values = 7.0 + 2.0 * stamps / STEP
    channel, said = mended(stamps, values)
    np.testing.assert_allclose(channel.values, 7.0 + 2.0 * (5.0 / STEP + np.arange(60.0)), rtol=1e-12)
    gap = said["gap"]
    assert (gap.value, gap.start, gap.end) == (4.0 * STEP, stamps[38], stamps[39])
    assert gap.message.startswith(f"2 gaps in time, 6.78 % of the record, the longest {4.0 * STEP:.3g}\xa0s after")
    assert gap.message.endswith("bridged by straight lines")
    assert (gap.severity, gap.harms) == ("suspect", ("spectrum",))
    assert (channel.step, channel.start, channel.stamps) == (STEP, 5.0, None)


@pytest.mark.parametrize(("lost", "severity"), [(10, "suspect"), (12, "bad")])
def test_a_record_may_lack_a_tenth(lost, severity):
    """Of 111 or 113 steps between the first and the last."""
    stamps = STEP * np.r_[np.arange(50.0), 50.0 + lost + np.arange(52.0)]
    gap = mended(stamps)[1]["gap"]
    assert (gap.severity, gap.harms == FIGURES) == (severity, severity == "bad")
    assert gap.message.startswith("1 gap in time")


@pytest.mark.parametrize(("far", "bridged"), [(1400, True), (1402, False)])
def test_gaps_are_bridged_up_to_four_times_the_samples_and_a_thousand(far, bridged):
    """Of 100 samples: up to a grid of 1400."""
    stamps = STEP * np.r_[np.arange(99.0), far - 1.0]
    channel, said = mended(stamps)
    assert channel.values.size == (far if bridged else 100)
    assert said["gap"].message.endswith("bridged by straight lines" if bridged else "too long to be bridged")


@pytest.mark.parametrize(
    ("share", "said", "severity"),
    [(0.012, True, "good"), (0.009, False, ""), (0.099, True, "good"), (0.11, True, "suspect")],
)
def test_stamps_that_stray_by_a_hundredth_are_resampled(share, said, severity):
    stamps = 3.0 + STEP * np.arange(101.0)
    stamps[50] += share * STEP
    values = np.arange(101.0)
    channel, found = mended(stamps, values)
    assert ("time-uneven" in found) is said
    if said:
        assert (found["time-uneven"].severity, found["time-uneven"].harms) == (severity, ("spectrum",))
        assert found["time-uneven"].value == pytest.approx(share * STEP, rel=0.02)
        assert channel.values[50] == pytest.approx(50.0 - share / (1.0 + share), rel=1e-9)
    else:
        assert channel.values is values or np.array_equal(channel.values, values)


def test_stamps_that_stand_twice_keep_their_first_sample():
    stamps = STEP * np.r_[np.arange(10.0), 9.0, 10.0, 11.0]
    channel, said = mended(stamps, np.arange(13.0))
    assert channel.values.tolist() == [*range(10), 11, 12]
    assert (said["time-twice"].value, said["time-twice"].severity, said["time-twice"].harms) == (1, "suspect", ())


@pytest.mark.parametrize(("twice", "severity"), [(39, "suspect"), (40, "bad")])
def test_stamps_of_which_many_stand_twice_are_those_of_several_channels(twice, severity):
    base = np.arange(100.0)
    stamps = STEP * np.sort(np.r_[base, base[:twice]])
    found = mended(stamps)[1]["time-twice"]
    assert (found.value, found.severity, found.harms == FIGURES) == (twice, severity, severity == "bad")


def test_time_that_runs_backwards_is_sorted_and_bad():
    stamps = STEP * np.array([0.0, 1.0, 2.0, 5.0, 4.0, 3.0, 6.0, 7.0])
    channel, said = mended(stamps, np.arange(8.0))
    assert channel.values.tolist() == [0.0, 1.0, 2.0, 5.0, 4.0, 3.0, 6.0, 7.0]
    found = said["time-backwards"]
    assert (found.value, found.start, found.severity) == (2, 5.0 * STEP, "bad")
    assert "backwards 2 times, first" in found.message


def test_stamps_that_are_no_times_cost_their_samples():
    stamps = STEP * np.arange(40.0)
    stamps[[3, 9]] = np.inf, 1.1e30
    channel, said = mended(stamps, np.arange(40.0))
    assert said["time-missing"].value == pytest.approx(0.05)
    assert channel.values.tolist() == list(range(40))
    stamps[[3, 9]] = 3.0 * STEP, 9.0 * STEP
    assert mended(stamps)[1] == {}
    only = mended(np.array([np.nan, 2.0]), [5.0, 7.0])[0]
    assert (only.values.tolist(), only.stamps) == ([7.0], None)


def test_samples_that_are_no_numbers_are_bridged():
    values = np.r_[np.nan, np.arange(1.0, 39.0), np.inf]
    values[[10, 11]] = 9.9e37
    channel, (found,) = even(Channel("a", values, 0.5, 3.0))
    assert channel.values.tolist() == [1.0, *range(1, 39), 38.0]
    assert (found.value, found.start, found.severity, found.harms) == (4, 3.0, "suspect", ("spectrum",))
    values[12] = -1e30
    assert even(Channel("a", values, 0.5, 3.0))[1][0].severity == "bad"
    values[:] = np.nan
    nothing, (found,) = even(Channel("a", values, 0.5, 3.0))
    assert (found.message, found.value, nothing.values is values) == ("no sample is a number", 40, True)
    for step in (0.0, NAN):
        with pytest.raises(InputError, match="a sampling rate"):
            even(Channel("a", np.zeros(3), step))


def test_the_last_digit_of_stamps_is_that_of_the_largest_ones():
    assert calibration._last_digit(np.round(np.arange(0.0, 50.0, 0.07), 2)) == pytest.approx(0.01)
    assert calibration._last_digit(np.round(1000.0 + np.arange(0.0, 50.0, 0.7), 1)) == pytest.approx(0.1)
    assert calibration._last_digit(np.zeros(5)) == 0.0
    assert calibration._last_digit(np.full(3, 1e-201)) == 0.0
    assert calibration._last_digit(np.array([123000.0])) == 1000.0  # three digits at least
    third = np.array([1.0 / 3.0])
    assert calibration._last_digit(third) == np.spacing(1.0 / 3.0)
    late = np.r_[np.full(500, 0.1234), np.full(60, 0.25)]
    for place, digit in ((503, 1e-3), (504, 1e-4)):  # of 560 the last 56 count
        late[500:504], late[place] = 0.25, 0.1234
        assert calibration._last_digit(late) == digit
    assert calibration._last_digit(np.r_[np.full(60, 0.1234), np.full(49, 0.25)]) == 1e-4  # fifty at least
    assert calibration._last_digit(np.r_[np.full(60, 0.1234), np.full(50, 0.25)]) == 1e-3


@pytest.mark.parametrize(("odd", "rounded"), [(4, False), (6, True), (9, True)])
def test_stamps_are_rounded_where_more_than_one_step_in_two_hundred_is_odd(odd, rounded):
    """Whole numbers of which so many of a thousand steps are two: fewer are lost samples of an even clock."""
    stamps = np.round((1.0 + odd / 1000.0) * np.arange(1001.0))
    found = calibration._rounded(stamps, np.diff(stamps))
    assert (found is not None) is rounded
    if rounded:
        assert found == (pytest.approx(0.0, abs=0.5), pytest.approx(1.0 + odd / 1000.0, rel=1e-4))


def test_rounded_stamps_give_the_line_through_them():
    """2 ms apart, printed to whole ms or to 5: neighbours become equal, and the line is that of all of them."""
    true = 7.0 + 2e-3 * np.arange(201.0) / 3.0
    stamps = np.round(true, 3)
    start, step = calibration._rounded(stamps, np.diff(stamps))
    assert step == pytest.approx(2e-3 / 3.0, rel=1e-4)
    assert start == pytest.approx(7.0, abs=1e-4)
    by_hand = np.polyfit(np.arange(201.0), stamps, 1)
    assert (step, start) == (pytest.approx(by_hand[0], rel=1e-9), pytest.approx(by_hand[1], rel=1e-12))
    assert calibration._rounded(stamps[:2], np.diff(stamps[:2])) is None
    assert calibration._rounded(stamps[::-1], np.diff(stamps[::-1])) is None
    assert calibration._rounded(np.arange(9.0), np.ones(8)) is None  # even as they are
    twice = np.round(1.0 + np.repeat(np.arange(60.0) * 1e-3, 2), 3)
    assert calibration._rounded(twice, np.diff(twice)) is not None  # half of its digit a step
    three = np.round(np.sort(np.r_[np.arange(60.0), np.arange(0.0, 60.0, 12.0)]) * 1e-2, 3)
    assert calibration._rounded(three, np.diff(three)) is None


def test_steps_are_odd_beyond_a_hundredth():
    assert calibration._share_odd(np.array([1.0, 1.0099, 1.0101, 0.5]), 1.0) == 0.5


# Correlation, smoothing, ringing, coupling


def test_neighbours_that_are_alike_count_as_one():
    """A correlation of 0.6, of 0 at least and of 0.9 at most."""
    values = np.array([2.0, 1.0, 0.0, 1.0, 2.0])
    assert alike_as_one(values) == pytest.approx((1.0 + 0.4) / (1.0 - 0.4))
    assert alike_as_one(np.ones(100)) == pytest.approx(1.9 / 0.1)
    assert alike_as_one(np.ones(100), 0.98) == pytest.approx(1.98 / 0.02)
    assert alike_as_one(np.array([1.0, -1.0])) == alike_as_one(np.zeros(3)) == 1.0


@pytest.mark.parametrize("direct", [0, 10**9])
@pytest.mark.parametrize("half", [2, 5])
def test_a_local_parabola_is_that_of_least_squares(monkeypatch, direct, half):
    """Within the record; and what a single one becomes is the weight of the middle of such a parabola."""
    monkeypatch.setattr(pulse_shape, "DIRECT", direct)
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(2, 31))
    found = pulse_shape.SmoothingWindow(half).over(rows)
    k = np.arange(-half, half + 1.0)
    for row, smooth in zip(rows, found, strict=True):
        for place in range(half, 31 - half):
            assert smooth[place] == pytest.approx(np.polyfit(k, row[place - half : place + half + 1], 2)[2], abs=1e-12)
    ends = pulse_shape.SmoothingWindow(half).over(np.pad(rows[0], half, mode="edge"))[half:-half]
    assert found[0] == pytest.approx(ends, abs=1e-12)
    assert pulse_shape.SmoothingWindow(0).over(rows) is rows
    assert pulse_shape.SmoothingWindow(0).gain == 1.0
    assert pulse_shape.SmoothingWindow(2).gain == pytest.approx(
        math.sqrt(17.0 / 35.0)
    )  # Savitzky-Golay: its middle weight


def test_windows_grow_by_half_an_octave():
    assert [one.half for one in pulse_shape.windows_up_to(1)] == [0]
    assert [one.half for one in pulse_shape.windows_up_to(2)] == [0, 2]
    assert [one.half for one in pulse_shape.windows_up_to(20)] == [0, 2, 3, 5, 7, 10, 14, 20]
    assert [one.half for one in pulse_shape.windows_up_to(19)] == [0, 2, 3, 5, 7, 10, 14]


def stretch(after, peak=10.0, noise=0.0, width=20.0, misfit=0.0, inside=None):
    """Forty samples of a blow, from 10 on, and what follows it."""
    values = np.r_[np.zeros(10), np.zeros(40) if inside is None else inside, after]
    smooth = SimpleNamespace(peak=peak, misfit=misfit, at=lambda time: np.zeros(time.size))
    return ringing.Stretch(values, 1e-3, 10, 50, width, smooth, noise)


def swing(amplitude, size=100, frequency=100.0):
    return amplitude * np.sin(2.0 * np.pi * frequency * 1e-3 * (np.arange(size) + 0.5))


@pytest.mark.parametrize(
    ("amplitude", "noise", "found"),
    [(0.51, 0.0, True), (0.49, 0.0, False), (1.01, 0.2, True), (0.99, 0.2, False), (-0.51, 0.0, True)],
)
def test_a_record_swings_by_a_twentieth_of_the_peak_or_five_times_its_noise(amplitude, noise, found):
    assert ringing.swings_after(stretch(swing(amplitude), noise=noise)) is found
    assert not ringing.swings_after(stretch(swing(amplitude)[:7]))
    assert ringing.swings_after(stretch(np.r_[np.zeros(100), swing(5.0)])) is False  # five widths after it


def test_ringing_is_the_strongest_swing_above_three_tenths_of_one_a_width():
    fast = swing(1.0, 100, 130.0)
    assert ringing.ringing_of(stretch(fast)) == pytest.approx(130.0, abs=2.0)
    assert ringing.ringing_of(stretch(swing(3.0, 100, 28.0) + fast)) == pytest.approx(28.0, abs=1.9)
    assert ringing.ringing_of(stretch(swing(3.0, 100, 28.0), width=8.0)) >= 37.5  # 0.3 of one over 8 ms
    assert math.isnan(ringing.ringing_of(stretch(fast[:7])))
    assert math.isnan(ringing.ringing_of(stretch(0.1 * fast)))
    assert ringing.ringing_of(stretch(fast[:8])) > 0.0


@pytest.mark.parametrize(
    ("misfit", "noise", "frequency", "found"),
    [
        (0.031, 0.0, 150.0, True),
        (0.029, 0.0, 150.0, False),
        (0.04, 0.26, 150.0, True),
        (0.04, 0.27, 150.0, False),
        (0.1, 0.0, 110.0, False),
        (0.1, 0.0, 140.0, True),
    ],
)
def test_ringing_in_a_blow_is_what_a_smooth_pulse_leaves(misfit, noise, frequency, found):
    """Three per cent of the peak, and one and a half times the noise; from two and a half swings a width on."""
    inside = swing(0.3, 40, frequency)
    answer = ringing.ringing_of(stretch(0.01 * swing(1.0, 20), misfit=misfit, noise=noise, inside=inside))
    assert (answer > 0.0) is found
    if found:
        assert answer == pytest.approx(frequency, abs=5.0)


def test_the_spectrum_of_what_dies_out_is_not_faded_from_its_begin():
    frequencies, height = ringing.spectrum_after(swing(1.0) + 3.0, 1e-3)
    assert frequencies.size == 8 * 100 // 2 + 1
    assert frequencies[-1] == 500.0
    assert frequencies[np.argmax(height)] == pytest.approx(100.0, abs=1.3)
    early, late = np.zeros(100), np.zeros(100)
    early[2:4], late[-4:-2] = (1.0, -1.0), (1.0, -1.0)
    assert np.max(ringing.spectrum_after(early, 1e-3)[1]) > 20.0 * np.max(ringing.spectrum_after(late, 1e-3)[1])
    assert math.isnan(ringing.strongest_frequency(swing(1.0), 1e-3, 501.0))
    assert ringing.strongest_frequency(swing(1.0), 1e-3, 500.0) == 500.0


def test_a_record_without_its_coupling_stands_on_the_zero_before_its_blow():
    from strikewave.signal.filters import ac_coupled

    size, step, constant = 1200, 1e-3, 0.2
    plain = np.zeros(size)
    plain[100:120] = 5.0
    zero = 3.0 + 2e-3 * (np.arange(size) - 110.0)
    slope = SimpleNamespace(slope=2e-3)
    blow = SimpleNamespace(
        offset=3.0, baseline=slope, time=7.0 + 0.110, end=7.0 + 0.12, smooth=SimpleNamespace(length=0.02)
    )
    wrong = 1e-3
    found = tail.uncoupled(ac_coupled(plain, step, constant) + zero + wrong, step, 7.0, [blow], constant)
    assert found - zero == pytest.approx(plain, abs=2e-3)
    rest = np.abs(found - zero)[700:]
    assert float(np.mean(rest)) < 1e-3
    for size, moved in ((421, True), (420, False)):  # a constant of time must lie behind the place of rest
        above = np.full(size, 1e-3)
        both = tail.resting(above, step, constant, 220)
        assert (abs(float(np.sum((1.0 + step / constant * np.arange(size))[220:] * both[220:]))) < 1e-9) is moved


# Readings


def blow(begin=1.0, time=1.2, end=1.4, peak=10.0, velocity=2.0, **how):
    return SimpleNamespace(
        begin=begin, time=time, end=end, peak=peak, velocity_change=velocity, width=end - begin, offset=0.0, **how
    )


def test_blows_that_lack_samples_are_incomplete():
    holes = np.array([0.9, 1.0, 1.4, 1.5, 2.5])
    (found,) = reading._incomplete(holes, FIGURES, [(0.1, 0.3, ""), (1.0, 1.4, "blow at 1.2"), (2.4, 2.6, "")])
    assert (found.harms, "2 samples of the blow at 1.2\xa0s" in found.message) == (FIGURES, True)
    assert (found.code, found.value, found.start, found.end) == ("blow-incomplete", 2, 1.0, 1.4)
    assert reading._incomplete(holes, FIGURES, [(1.1, 1.3, "")]) == []


def test_holes_are_the_times_of_samples_that_are_none():
    values = np.array([1.0, np.nan, 3.0, np.inf])
    assert reading.holes_of(Channel("a", values, 0.5, 3.0)).tolist() == [3.5, 4.5]
    assert reading.holes_of(Channel("a", values, 0.5, 3.0, stamps=np.array([7.0, 9.0, 5.0, 4.0]))).tolist() == [
        4.0,
        9.0,
    ]


@pytest.mark.parametrize(
    ("before", "after", "value", "severity"),
    [
        ([10.0, -20.0], [9.1, -18.2], None, ""), ([10.0, -20.0], [9.1, -17.8], 0.89, "good"), ([10.0, -20.0], [4.9, -20.0], 0.49, "suspect"),
        ([10.0], [5.1], 0.51, "good"), ([10.0, 20.0], [10.0], -1.0, "suspect"), ([], [], None, ""), ([0.0, 10.0], [5.0, 10.0], None, ""),
    ],
)  # fmt: skip
def test_what_a_filter_takes_off_peaks_is_told(before, after, value, severity):
    found = filter_changes(before, after)
    assert [(one.value, one.severity) for one in found] == ([] if value is None else [(pytest.approx(value), severity)])


def test_cutoffs_lie_between_half_a_period_a_record_and_half_the_rate():
    channel = Channel("a", np.random.default_rng(1).normal(size=101), 1e-3)  # lasts 0.1 s
    for option, make, field in (("filter", Filter, "--filter"), ("high_pass", HighPass, "--high-pass")):
        for cutoff, fine in ((5.01, True), (4.99, False), (499.0, True), (500.0, False)):
            request = Request(**{option: make(cutoff)})
            if fine:
                assert filtered_channel(channel, request).values is not channel.values
            else:
                with pytest.raises(InputError) as caught:
                    filtered_channel(channel, request)
                assert caught.value.field == field
    assert filtered_channel(channel, Request()) is channel


def test_what_a_high_pass_leaves_of_a_velocity_change():
    """Of 2 m/s the samples from 1.0 to 1.4 s leave five times 0.1, of 0.1 s each: a fortieth; of 0.08 m/s more than half."""
    channel = Channel("a", np.full(30, 0.1), 0.1, 0.0)
    (found,) = reading._lightened(HighPass(3.0), [blow(0.95, 1.2, 1.45, velocity=0.08), blow(0.95, 1.2, 1.45)], channel)
    assert (found.value, found.severity) == (pytest.approx(0.05 / 2.0), "suspect")
    assert "the high-pass at 3\xa0Hz leaves 2.5" in found.message
    (found,) = reading._lightened(HighPass(3.0), [blow(0.95, 1.2, 1.45, velocity=0.09)], channel)
    assert found.severity == "good"
    assert reading._lightened(HighPass(3.0), [], channel) == []
    exact = Channel("a", np.arange(8.0), 1.0, 0.0)
    (found,) = reading._lightened(HighPass(3.0), [blow(2.0, 3.0, 4.0, velocity=9.0)], exact)
    assert found.value == 1.0  # both ends of the blow count


def a_reading(values=None, pulses=(), findings=(), name="bar", number=1, **how):
    channel = Channel(name, np.zeros(40) if values is None else values, 1e-3, 3.0, "m/s^2")
    return ChannelReading(channel, number, tuple(pulses), tuple(findings), ChannelCalibration(), **how)


def test_figures_that_a_finding_harms_are_left_out():
    pulse = SimpleNamespace(peak=3.0, rigid_peak=2.5, width=NAN, rigid=None, offset=7.0)
    with_rigid = SimpleNamespace(peak=5.0, rigid_peak=4.5, width=6.0, rigid=object(), offset=8.0)
    one = a_reading(pulses=[pulse, with_rigid])
    assert (one.figures("peak"), one.figures("rigid_peak"), one.figures("width"), one.baseline) == (
        [3.0, 5.0],
        [3.0, 4.5],
        [6.0],
        7.0,
    )
    rings = HealthNotice("ringing", "", harms=("peak",))
    ringing_one = one.with_finding(rings)
    assert (ringing_one.figures("peak"), ringing_one.figures("rigid_peak")) == ([], [2.5, 4.5])
    assert one.with_finding(HealthNotice("x", "", severity="bad")).figures("peak") == []
    assert one.with_finding(HealthNotice("x", "", harms=("width",))).figures("peak") == [3.0, 5.0]
    assert a_reading(np.array([1.0, 2.0, 7.0])).baseline == 2.0
    assert a_reading(np.zeros(3)).with_finding(rings).status == "suspect"
    answer = SimpleNamespace(base_peak=-9.0, figure=lambda name: 4.0)
    small = SimpleNamespace(base_peak=8.0, figure=lambda name: NAN)
    assert a_reading(responses=(small, answer)).response is answer
    assert a_reading(responses=(small, answer)).figures("ratio") == [4.0]
    assert a_reading(responses=(small, answer)).figures("rise") == []


def test_reasons_are_told_once_the_worst_first():
    bad, odd = HealthNotice("a", "broken", severity="bad"), HealthNotice("b", "odd")
    fine = HealthNotice("c", "fine", severity="good")
    two = FileReading(
        "f",
        "text",
        (a_reading(findings=[odd, fine]), a_reading(findings=[odd, bad], name="top", number=5)),
        (HealthNotice("d", "cut"),),
    )
    assert two.reasons == ["top: broken", "cut", "bar and top: odd"] or two.reasons == [
        "top: broken",
        "cut",
        "bar, top: odd",
    ]
    assert (two.status, [f.code for f in two.all_findings]) == ("bad", ["a", "d", "b", "b", "c"])
    assert two.numbered(5) is two.channels[1]
    assert two.numbered(2) is None
    assert FileReading("f", "text", (a_reading(findings=[odd]),)).reasons == ["odd"]


def test_the_motion_of_a_whole_body_rings_of_its_own():
    rings = HealthNotice("ringing", "rings", harms=("peak",), effects=(("peak", 0.2),))
    other = HealthNotice("hum", "hums")
    from strikewave.records.measuring import RecordedPulse

    pulse = RecordedPulse(
        1.0, 2.0, 0.1, 0.2, 3.0, 500.0, 0.0, 0.0, None, "record", 0.9, 1.1, rigid=object(), split=object()
    )
    (own,), found = reading._as_body_motion([pulse], [rings, other])
    assert (own.rigid, own.split) == (None, None)
    assert (found[0].severity, found[0].harms, found[0].effects, found[1]) == ("good", (), (), other)
    assert found[0].message.startswith("the blow rings at 500\xa0Hz: the channel holds")
    assert reading._as_body_motion([], [rings])[1][0].message.startswith("the record swings after the blow: ")


def test_blows_beside_a_step_of_the_baseline(monkeypatch):
    """What comes after the step is lowered; where a blow holds the step, from its end on."""
    seen = []

    def find(values, step, start):
        seen.append(values.copy())
        return [SimpleNamespace(begin=3.020, end=3.0235, width=0.003)]

    monkeypatch.setattr(reading, "find_pulses", find)
    channel = Channel("a", np.ones(40), 1e-3, 3.0)
    for place, expected in ((None, None), (16, 16), (18, 24), (26, 24), (27, 27)):
        seen.clear()
        monkeypatch.setattr(reading, "level_step", lambda values, p=place: None if p is None else (p, 5.0))
        reading._blows(channel)
        if place is None:
            assert [values.tolist() for values in seen] == [[1.0] * 40]
        else:
            assert seen[-1].tolist() == [1.0] * expected + [-4.0] * (40 - expected)


# Responses


def test_a_base_that_is_bad_harms_what_counts_from_it():
    def of(*findings):
        return [(f.severity, f.harms) for f in reading._of_base(a_reading(findings=findings))]

    assert of(HealthNotice("a", "", severity="bad")) == [("suspect", ("ratio", "delay"))]
    assert of(HealthNotice("a", "", harms=("peak",))) == [("suspect", ("ratio",))]
    assert of(HealthNotice("a", "", harms=("peak",)), HealthNotice("b", "", severity="bad")) == [
        ("suspect", ("ratio", "delay"))
    ]
    assert of(HealthNotice("a", "", harms=("width",))) == []


def test_a_channel_swings_or_is_struck():
    t = np.linspace(0.0, 1.0, 400)
    swinging = np.sin(40.0 * t) * np.exp(-2.0 * t)
    assert reading._swings(a_reading(swinging + 3.0, [blow(offset_=0)])) is False  # its zero is 0 here
    assert reading._swings(a_reading(swinging))
    assert not reading._swings(a_reading(np.full(400, 3.0)))
    assert not reading._swings(a_reading(swinging[:15]))
    assert not reading._swings(a_reading(np.r_[swinging, np.nan]))
    assert swings(np.r_[-0.51, 1.0, -0.51, 0.0])
    assert not swings(np.r_[-0.49, 1.0, -0.49, 0.0])
    assert swings(np.r_[1.0, -1.0, 1.0, -1.0, 0.49, -0.0])  # area of a ninth of that of the magnitude
    assert not swings(np.r_[1.0, -0.6, 0.2])


def test_a_swing_is_louder_than_twenty_times_the_noise_before_it():
    values = np.tile([1.0, -1.0], 20)
    for height, louder in ((20.5, True), (19.5, False)):
        values[35] = height
        values[[0, 1, 34]] = 0.0  # as many to either side
        assert reading._louder(a_reading(values), 3.02) is louder
    values = np.r_[np.zeros(16), np.tile([5.0, -5.0], 12)]
    assert reading._louder(a_reading(values), 3.016)
    assert not reading._louder(a_reading(values), 3.015)  # too few samples before it: over all


def test_a_top_whose_neighbours_are_less_than_half_of_it_is_a_spike():
    assert response._tip(np.array([6.0, 10.0, 4.9]), 1) == (1.0, 10.0)
    assert response._tip(np.array([6.0, 10.0, 5.1]), 1)[1] > 10.0
    assert response._tip(-np.array([4.9, 10.0, 6.0]), 1) == (1.0, -10.0)


def test_the_zero_before_a_place_needs_enough_samples():
    from strikewave.records.response import FEWEST

    values = np.r_[np.full(FEWEST, 3.0), np.full(9 * FEWEST, 5.0)]
    assert zero_before(values, FEWEST) == 3.0
    assert zero_before(values, FEWEST - 1) == 5.0


def test_a_channel_that_swings_after_the_blow_of_another_is_told(monkeypatch):
    """From a width of that blow before its begin on, where it is louder than before."""

    def at(begin, name, number):
        return a_reading(
            pulses=[blow(begin, begin + 0.1, begin + 0.2)],
            findings=[HealthNotice("no-pulse", ""), HealthNotice("x", "")],
            name=name,
            number=number,
        )

    swinging, loud = {"top", "late", "early"}, {"top", "late", "early"}
    monkeypatch.setattr(reading, "_swings", lambda one: one.channel.name in swinging)
    monkeypatch.setattr(reading, "_louder", lambda one, begin: one.channel.name in loud and begin == 1.0)
    struck, top = at(1.0, "bar", 3), at(0.81, "top", 4)
    told = reading.mark_responses([top, struck, at(5.0, "late", 5), at(0.79, "early", 6)])
    assert [[f.code for f in one.findings] for one in told] == [
        ["x", "response"],
        ["no-pulse", "x"],
        ["x", "response"],
        ["no-pulse", "x"],
    ]
    assert "after the blow of bar; --base 3" in told[0].findings[-1].message
    assert told[0].findings[-1].harms == FIGURES
    silent = a_reading(name="top")
    assert [f.code for f in reading.mark_responses([silent, struck])[0].findings] == ["response"]
    loud.clear()
    assert reading.mark_responses([top, struck])[0] is top
    swinging.add("bar")
    assert reading.mark_responses([top, struck]) == [top, struck]


@pytest.mark.parametrize(
    ("size", "blows", "words"), [(2, 1, ""), (2, 0, "the base, bar, has no blow"), (1, 1, "too few samples")]
)
def test_a_response_needs_samples_and_a_blow_of_its_base(monkeypatch, size, blows, words):
    from strikewave.records.measuring import FEWEST

    count = 2 * FEWEST if size == 2 else 2 * FEWEST - 1
    channel = Channel("top", np.sin(np.arange(float(count))), 1e-3, 3.0, "m/s^2")
    base = a_reading(pulses=[blow(3.002, 3.003, 3.004)] * blows)
    found = reading.read_response(channel, 7, ChannelCalibration(), Request(), base)
    assert found.number == 7
    said = [
        f.message for f in found.findings if f.code == "no-response" and f.message.endswith("no response is measured")
    ]
    assert len(said) == bool(words)
    filtered = []
    monkeypatch.setattr(reading, "filtered_channel", lambda channel, request: filtered.append(request) or channel)
    for request in (Request(filter=Filter(50.0)), Request(high_pass=HighPass(50.0))):
        reading.read_response(channel, 7, ChannelCalibration(), request, base)
    assert len(filtered) == (0 if words else 2)
    if words:
        assert words in said[0]
        assert (found.status, found.responses) == ("bad", ())


def test_the_coupling_of_a_response_is_the_one_stated_or_recognised(monkeypatch):
    calls = []

    def rest(above, step, constant, place):
        calls.append((constant, place))
        return above * 2.0

    monkeypatch.setattr(reading, "resting", rest)
    one = SimpleNamespace(zero=5.0, decay=FreeDecay(3.1, 3.2))
    record = SimpleNamespace(
        responses=[SimpleNamespace(), one], above=np.arange(3.0), place=lambda time: round((time - 3.0) / 1e-3)
    )
    channel = Channel("a", np.zeros(3), 1e-3, 3.0)
    monkeypatch.setattr(
        reading, "examine", lambda examined: [HealthNotice("x", "", 9.0), HealthNotice("ac-coupling", "", 0.25)]
    )
    plain, said = reading._response_without_coupling(channel, record, "auto")
    assert (plain.values.tolist(), said.value, calls) == ([5.0, 7.0, 9.0], 0.25, [(0.25, 200)])
    assert "AC coupling of 0.6366\xa0Hz (tau = 250\xa0ms) was taken off" in said.message
    assert reading._response_without_coupling(channel, record, 0.5)[1].value == 0.5
    monkeypatch.setattr(reading, "examine", lambda examined: [])
    assert reading._response_without_coupling(channel, record, "auto") == (channel, reading.NOT_COUPLED)


# Files


def a_record(*names):
    t = np.arange(200) * 1e-4
    values = np.exp(-(((t - 0.01) / 1e-3) ** 2)) + 1e-4 * np.sin(1e5 * t)
    return Record(
        "f.csv", "text", tuple(Channel(name, values * (k + 1.0), 1e-4, unit="m/s^2") for k, name in enumerate(names))
    )


def test_calibrations_find_their_channels_by_number():
    record = a_record("bar", "top")
    file = read_file(
        record,
        {"2": {"unit": "g"}, "none": {"unit": "V"}},
        Request(calibrations={"bar": {"unit": "g", "polarity": -1}}),
    )
    g = 9.80665
    assert [
        one.channel.values.max() / r.values.max() for one, r in zip(file.channels[1:], record.channels[1:], strict=True)
    ] == [pytest.approx(g)]
    assert file.channels[0].channel.values.min() == pytest.approx(-g * record.channels[0].values.max())
    assert [f.code for f in file.findings] == ["calibration-unused"]
    only = read_file(record, {}, Request(channels=("top",)))
    assert [(one.number, one.channel.name) for one in only.channels] == [(2, "top")]


@pytest.mark.parametrize(
    ("channels", "base", "words"),
    [((), "none", "--base"), (("top", "in"), "bar", "add --channel bar"), (("bar",), "bar", "only bar is read")],
)
def test_bases_that_cannot_be_are_refused(channels, base, words):
    with pytest.raises(InputError, match=words):
        read_file(a_record("bar", "top", "in"), {}, Request(channels=channels, base=base))
    with pytest.raises(InputError, match="leave it out"):
        read_file(a_record("bar"), {}, Request(base="bar"))


def test_repeats_are_called_by_what_their_names_have_in_common():
    file = read_file(a_record("s/shot 1", "s/shot_2"), {}, Request())
    assert [(one.path, one.channels[0].channel.name, one.channels[0].number) for one in repeats(file)] == [
        ("f.csv: s/shot 1", "shot", 1), ("f.csv: s/shot_2", "shot", 1),
    ]  # fmt: skip
    assert {one.channels[0].channel.name for one in repeats(read_file(a_record("a 1", "b 2"), {}, Request()))} == {
        "repeats"
    }


def test_samples_beyond_the_memory_lie_on_disk_in_files_of_a_size(monkeypatch):
    import mmap

    monkeypatch.setattr(sample_store, "PART", mmap.ALLOCATIONGRANULARITY)
    count = mmap.ALLOCATIONGRANULARITY // 8

    def file_of(size, first):
        return FileReading("f", "text", (a_reading(first + np.arange(float(size))),))

    files = [file_of(size, 1000.0 * k) for k, size in enumerate((10, 5, count - 7, 7, count + 1, 0, 3))]
    with sample_store.SampleStore(in_memory=10) as store:
        kept = [store.kept(file) for file in files]
        store.forget()
    assert kept[0] is files[0]
    assert kept[1] is not files[1]
    for file, back in zip(files, kept, strict=True):
        np.testing.assert_array_equal(back.channels[0].channel.values, file.channels[0].channel.values)
    assert len(store._maps) == 5 - 1
