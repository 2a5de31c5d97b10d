"""Headings, units, settings and times of text, part by part: small examples worked by hand, at both sides of limits."""

import math

import numpy as np
import pytest

from strikewave.records.calibration import known_unit
from strikewave.records.readers import headings
from strikewave.records.readers.columns import Marks
from strikewave.records.readers.headings import (
    PICO,
    below_start_and_increment,
    clock_times,
    find_headings,
    is_counter,
    is_time,
    is_unit,
    last_digit,
    name_and_unit,
    rises_evenly,
    said_step,
    seconds_in,
    settings_of,
    step_of,
    to_seconds,
)

COMMAS, SEMICOLONS = Marks(","), Marks(";")

# Names and units


@pytest.mark.parametrize(
    ("cell", "name", "unit"),
    [
        ("Acc [2]", "Acc [2]", ""), ("Acc[1]", "Acc[1]", ""), ("Acc [1]", "Acc", "1"), ("/s", "/s", ""),
        ("a/b/mV", "a/b", "mV"), ("force in kN", "force", "kN"), ("in kN", "", "kN"), ("time_us", "time", "us"),
        ("board_us", "board_us", ""), ("force (N) of the bar", "force", "N"), ("a (left) b", "a (left) b", ""),
        ("' acc (g)\"", "acc", "g"), ("speed, m/s", "speed", "m/s"), ("x" * 201 + " [g]", "x" * 200, ""),
    ],
)  # fmt: skip
def test_a_heading_is_parted_into_name_and_unit(cell, name, unit):
    assert name_and_unit(cell) == (name, unit)


def test_units_are_those_that_instruments_write():
    assert all(map(is_unit, ("(g)", "[mV]", "µstrain", "MPa", "m/s²", "counts", "msec", "lbf")))
    assert not any(map(is_unit, ("board", "gx", "", "kilo", "strains of bars")))


@pytest.mark.parametrize(
    ("name", "unit", "expected"),
    [
        ("Zeit", "", True), ("time", "ms", True), ("time", "V", False), ("board", "ms", True), ("board", "", False),
        ("x-axis", "", True), ("wave_time_2", "", True),
    ],
)  # fmt: skip
def test_time_is_told_by_its_name_and_its_unit(name, unit, expected):
    assert is_time(name, unit) is expected
    assert not is_time("t" + " " * 60 + "t", "")


def test_counters_are_told_by_name_or_unit():
    assert [is_counter(*pair) for pair in (("Sample No.", ""), ("n", ""), ("a", "#"), ("n", "V"), ("board", ""))] == [
        True, True, True, False, False,
    ]  # fmt: skip


# Heads


def head(lines, marks=COMMAS, width=2, filled=None):
    found = find_headings(lines, marks, width, list(range(width)) if filled is None else filled)
    return found.names, found.units


@pytest.mark.parametrize(
    ("lines", "names", "units"),
    [
        (["t,bar,top", "s,g,kN"], ["t", "bar", "top"], ["s", "g", "kN"]),
        (["t,bar,top", "(s),[g],(kN)"], ["t", "bar", "top"], ["s", "g", "kN"]),
        (["s,g,kN"], ["s", "g", "kN"], ["s", "g", "kN"]),
        (["t,bar,top", "t [ms],bar [mV],"], ["t", "bar", "top"], ["ms", "mV", ""]),
        (["1,2,3", "t,bar,top"], ["t", "bar", "top"], ["", "", ""]),
        (["t,bar,top", "0,1,2"], ["t", "bar", "top"], ["", "", ""]),
        (["bar,t,top", "t,bar,top"], ["t", "bar", "top"], ["", "", ""]),
        (["a,b,c", "t,bar,top"], ["t", "bar", "top"], ["", "", ""]),
        (["t,bar,top", "Vertical Units,mV,kN"], ["t", "bar", "top"], ["", "mV", "kN"]),
        (["t,bar [g],top", "Y-Units,mV,what"], ["t", "bar", "top"], ["", "g", ""]),
        (["time_ms,bar_g,top_kN"], ["time", "bar", "top"], ["ms", "g", "kN"]),
        (["time,bar_g,top_kN"], ["time", "bar_g", "top_kN"], ["", "", ""]),
        (["time_ms,_g,top [V]"], ["time", "_g", "top"], ["ms", "", "V"]),
        (["t\tbar\ttop"], ["t", "bar", "top"], ["", "", ""]),
        (["t [s] bar [g] top [kN]"], ["t", "bar", "top"], ["s", "g", "kN"]),
        (['"t', 's",bar,top'], ["t s", "bar", "top"], ["", "", ""]),
        (["sample rate,5,6", "t,bar,top"], ["t", "bar", "top"], ["", "", ""]),
        (["only,,"], ["", "", ""], ["", "", ""]),
        (["two,of,"], ["two", "of", ""], ["", "", ""]),
    ],
)
def test_names_and_units_are_taken_from_the_last_rows_of_a_head(lines, names, units):
    assert head(lines, width=3) == (names, units)


@pytest.mark.parametrize(
    ("lines", "names", "units"),
    [
        (["# t,bar"], ["t", "bar"], ["", ""]),
        (["# t,bar", "# s,mV"], ["t", "bar"], ["s", "mV"]),
        (["# bar [g],top [V]"], ["bar", "top"], ["g", "V"]),
        (["# bar [g],top"], ["", ""], ["", ""]),
        (["# columns: t,bar [V]"], ["t", "bar"], ["", "V"]),
        (["# s,mV"], ["", ""], ["s", "mV"]),
        (["# t,bar [V]", "# ms,mV"], ["t", "bar"], ["ms", "V"]),
    ],
)
def test_a_comment_that_names_time_or_all_units_is_a_head(lines, names, units):
    assert head(lines) == (names, units)


def test_a_comment_far_above_the_data_is_no_head():
    """The last fifty are looked at, from the last one up."""
    assert head(["# t,bar"] + ["# word"] * 49)[0] == ["t", "bar"]
    assert head(["# t,bar"] + ["# word"] * 50)[0] == ["", ""]


def test_the_comment_above_a_single_column_is_taken_whole():
    assert head(["# force, raw [kN]"], Marks("\t"), 1) == (["force, raw"], ["kN"])


def test_a_head_is_cut_with_blanks_where_the_data_are():
    assert head(["t (s)  bar end (g)"], Marks("")) == (["t", "bar end"], ["s", "g"])
    assert head(["t [s] bar [g]"], Marks("")) == (["t", "bar"], ["s", "g"])
    assert head(["t | bar | top"], COMMAS, 3)[0] == ["t", "bar", "top"]
    assert head(["t"], COMMAS, 3, [0])[0] == ["t", "", ""]


def test_columns_without_numbers_need_no_heading():
    """More than half of those with numbers do: of two, both."""
    assert head(["a,t,bar", ",x,"], width=3, filled=[1, 2])[0] == ["a", "t", "bar"]
    assert head(["a,t,"], width=3, filled=[1, 2])[0] == ["", "", ""]


@pytest.mark.parametrize(
    ("line", "filled", "expected"),
    [
        ("Sampling interval,5e-6", 2, True), ("Sampling interval,5e-6", 1, True), ("start,5", 2, True),
        ("start,stop", 2, False), ("t,start 3", 2, False), ("5,Sampling interval 3 s", 2, False), ("t,bar", 1, False),
        ("Y_Unit_Label,g", 2, True),
    ],
)  # fmt: skip
def test_settings_are_told_from_heads(line, filled, expected):
    assert headings._setting(line, COMMAS, range(filled)) is expected


@pytest.mark.parametrize(
    ("lines", "names", "units"),
    [
        (["t,bar,top", "x,0.5,1"], ["t", "bar", "top"], ["", "", ""]),
        (["t,bar,top", "what,g,N"], ["t", "bar", "top"], ["what", "g", "N"]),
        (["what,g,N"], ["what", "g", "N"], ["what", "g", "N"]),
        (["5,t,bar", "6,t [ms],bar [V]"], ["5", "t", "bar"], ["", "ms", "V"]),
        (["# ,t,bar"], ["", "t", "bar"], ["", "", ""]),
        (["# what,s,mV"], ["", "", ""], ["what", "s", "mV"]),
        (["# note,bar [g],top [V]"], ["note", "bar", "top"], ["", "g", "V"]),
    ],
)
def test_columns_of_words_tell_nothing_of_a_head(lines, names, units):
    """Of three columns the last two hold numbers."""
    assert head(lines, width=3, filled=[1, 2]) == (names, units)


def test_heads_that_may_be_cut_or_read_in_two_ways():
    assert head(["t,5,x", "time,b,c"], width=3) == (["time", "b", "c"], ["", "", ""])
    assert head(["t [ms],bar_g"]) == (["t", "bar_g"], ["ms", ""])
    assert head(["a b,c [g];t"]) == (["a b,c", "t"], ["g", ""])  # the way with most units
    assert head(["# t"]) == (["", ""], ["", ""])
    assert head(["t,bar", "s,(" + "x" * 29 + ")"]) == (["t", "bar"], ["s", "x" * 29])
    assert headings._whole(['"a",b', "c,d"]) == ['"a",b', "c,d"]


def test_headings_of_more_letters_than_a_line_are_not_joined():
    short, long = '"' + "a" * 198, '"' + "a" * 199
    assert headings._whole([short, 'b",c']) == [short + ' b",c']
    assert headings._whole([long, 'b",c']) == [long, 'b",c']


# Time


@pytest.mark.parametrize(
    ("unit", "seconds"),
    [
        ("ps", 1e-12), ("nsec", 1e-9), ("μs", 1e-6), ("MSEC", 1e-3), (" sekunden ", 1.0), ("min", 60.0), ("h", 3600.0),
        ("nanosekunden", 1e-9), ("mikrosekunden", 1e-6), ("millisekunden", 1e-3),
    ],
)  # fmt: skip
def test_units_of_time_have_their_seconds(unit, seconds):
    assert seconds_in(unit) == seconds
    assert to_seconds(np.array([20.0, 3.0]), unit).tolist() == pytest.approx(
        [20.0 * seconds, 3.0 * seconds], rel=1e-15, abs=0.0
    )
    assert to_seconds(np.array([20.0]), unit, 7.0).tolist() == [140.0]
    assert to_seconds(np.array([20.0]), "what").tolist() == [20.0]


def test_of_a_hostile_line_no_more_than_its_begin_is_looked_at():
    """Five hundred letters of a setting, two hundred of a heading, eighty of a unit with a number."""
    for blanks, found in ((491, 0.25), (492, math.nan)):
        np.testing.assert_equal(said_step([" " * blanks + "fs = 4 Hz"])[0], found)
    for letters, found in ((196, ("a" * 196, "g")), (197, ("a" * 197 + " [g", ""))):
        assert headings.name_and_unit("a" * letters + " [g]") == found
    for blanks, known in ((75, ("m/s^2", 9806.65)), (76, None)):
        assert known_unit("1000" + " " * blanks + "g") == known
    for count, known in ((246, 246), (247, 0)):
        line = "delta t" + ";1" * count
        assert len(headings.settings_of([line], Marks(";"), count + 1, range(1, count + 1)).steps) == known


@pytest.mark.parametrize("seconds", [3e-3, 0.7, 0.3, 1.005, 0.995, 1e-5, 7.5e-4])
def test_a_unit_of_time_that_is_stated_may_be_any(seconds):
    """3 ms are no 333rd of a second, and 0.7 s not a whole one; 10 us are its hundred-thousandth to the last bit."""
    assert to_seconds(np.array([20.0, 3.0]), "", seconds).tolist() == pytest.approx(
        [20.0 * seconds, 3.0 * seconds], rel=1e-15, abs=0.0
    )
    assert to_seconds(np.array([7.0]), "us")[0] == 7e-6


@pytest.mark.parametrize(
    ("cells", "digit"),
    [
        (["1.5", "10.25", "9"], 0.01), (["100", "20"], 1.0), (["0.0", "0"], 0.1), (["word", ""], 0.0), (["1e3"], 1e3),
        (["1.234e-6", "2.5e-3"], 1e-6), ([" 1,25 "], 0.01), ([".5"], 0.1), (["0.001", "10"], 1.0), (["0.001", "10.0"], 0.1), (["-12.5"], 0.1),
        (["0.00123", "9.87e2"], 1.0), (["1.250", "30.5"], 0.01),
    ],
)  # fmt: skip
def test_the_last_digit_is_that_of_the_largest_number(cells, digit):
    """No number has more figures than the longest one, and none is finer than the finest."""
    assert last_digit(cells) == digit


def test_time_rises_evenly_within_its_digits():
    even = np.array([3.0, 3.5, 4.0, 4.5, 5.0])
    middle = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
    assert rises_evenly(even, 0.0)
    assert rises_evenly(even[:3], 0.0)
    assert not rises_evenly(even[:2], 0.0)
    assert not rises_evenly(even[::-1], 0.0)
    assert not rises_evenly(np.array([1.0, np.nan, 3.0]), 0.0)
    assert not rises_evenly(np.full(5, 2.0), 0.0)
    bent = even + 0.0102 * middle  # 2 % of the step
    assert rises_evenly(bent, 0.0102)
    assert not rises_evenly(bent, 0.01)
    slightly = even + 0.0049 * middle  # within one in a hundred of the step, that is, 0.005
    assert rises_evenly(slightly, 0.6)
    assert not rises_evenly(even + 0.0051 * middle, 0.6)
    assert rises_evenly(np.array([0.0, 0.0, 1.0, 1.0, 2.0]), 1.0)  # printed with too few digits
    assert not rises_evenly(np.array([0.0, 0.0, 1.0, 1.0, 2.0]), 0.4)


def test_the_step_is_from_end_to_end_within_a_tenth_of_jitter():
    stamps = 7.0 + 2.0 * np.arange(11.0)
    stamps[4] += 0.19
    assert step_of(stamps, 0.0) == 2.0
    stamps[10] += 0.1
    assert step_of(stamps, 0.0) == pytest.approx(2.01, rel=1e-12)  # end to end, and not the median
    stamps[10] += 0.3  # end to end 2.04
    assert step_of(stamps, 0.0) == 2.0  # the median: more than a tenth of the step astray
    assert step_of(np.array([1.0, 4.0]), 0.0) == 3.0
    assert math.isnan(step_of(np.array([1.0]), 0.0))
    assert math.isnan(step_of(np.array([4.0, 4.0, 4.0]), 0.0))
    assert math.isnan(step_of(np.array([4.0, 2.0, 0.0]), 0.0))


def test_gaps_leave_the_step_and_coarse_digits_take_it_over_a_lag():
    """Of 40 intervals two are five times as long: a gap, whatever the digits. Without them, rounding counts."""
    stamps = np.arange(41.0)
    stamps[20:] += 4.0
    stamps[30:] += 4.0
    assert step_of(stamps, 0.0) == 1.0
    assert step_of(stamps, 50.0) == 1.0
    rounded = np.round(0.7 * np.arange(41.0))
    assert step_of(rounded, 1.0) == pytest.approx(0.7, rel=1e-12)  # 28 over 40
    late = rounded.copy()
    late[35:] += 9.0  # astray by more than a digit: over a lag of 41 // 8 = 5
    assert step_of(late, 1.0) == pytest.approx(float(np.median(late[5:] - late[:-5])) / 5.0, rel=1e-12)
    assert step_of(late, 0.2) == 1.0  # fine digits: the median of the differences


def test_a_gap_is_told_from_jitter_by_its_share_and_its_length():
    def differences(*parts):
        return np.concatenate([[0.0], np.cumsum(np.concatenate([np.full(n, d) for n, d in parts]))])

    assert headings._typical(differences((95, 2.0), (5, 3.0))) == (2.0, True)
    assert headings._typical(differences((94, 2.0), (6, 3.0))) == (2.0, False)
    assert headings._typical(differences((95, 2.0), (5, 2.9))) == (2.0, False)
    assert headings._typical(differences((95, 2.0), (5, 2.2)))[1]  # within a tenth: none that differs
    assert math.isnan(headings._typical(np.array([1.0]))[0])


@pytest.mark.parametrize("size", [1, 2, 3, 100])
def test_stray_stamps_are_found_in_every_part(monkeypatch, size):
    monkeypatch.setattr(headings, "_CHUNK", size)
    stamps = 5.0 + 0.5 * np.arange(8.0)
    stamps[[3, 6]] += [-0.2, 0.1]
    stamps[5] = np.nan
    assert headings._strays(stamps, 0.5) == pytest.approx(0.2, rel=1e-12)
    stamps[6] += 0.3
    assert headings._strays(stamps, 0.5) == pytest.approx(0.4, rel=1e-12)


@pytest.mark.parametrize(
    ("lines", "step", "start"),
    [
        (["fs = 50 kHz"], 2e-5, 0.0), (["Sampling rate (MHz): 2"], 5e-7, 0.0), (["samples per second: 400"], 0.0025, 0.0),
        (["fs: 1 GS/s"], 1e-9, 0.0), (["dt = 5 us", "fs = 3 Hz"], 5e-6, 0.0), (["delta t: 0,25 ms", "x0 = -3 ms"], 2.5e-4, -3e-3),
        (["time step 2 min"], 120.0, 0.0), (["t0 = 7"], math.nan, 7.0), (["fs = 0"], math.nan, 0.0),
        (["dt = 0 s", "fs = 4 Hz"], 0.25, 0.0), (["fs = 3 V", "fs = 8 Hz"], 0.125, 0.0), (["nothing 3"], math.nan, 0.0),
        ([" " * 480 + "fs = 5" + "0" * 30 + " Hz"], 1.0 / 5e14, 0.0), ([" " * 501 + "fs = 5"], math.nan, 0.0),
    ],
)  # fmt: skip
def test_lines_above_the_data_name_step_and_start(lines, step, start):
    found = said_step(lines)
    np.testing.assert_allclose(found, (step, start), rtol=1e-15, atol=0.0)


def test_a_line_names_a_step_within_its_first_letters():
    assert [headings.names_a_step(line) for line in ("a, fs = 3", "offset = 3", " " * 494 + "fs = 5", " " * 495 + "fs = 5")] == [
        True, False, True, False,
    ]  # fmt: skip


# Settings of each channel


def test_settings_of_each_channel_stand_in_its_column():
    lines = ["waveform;[0];bar [kN];top", "t0 [ms];-2;-3;", "start time [ms];-2;-3;4", "delta t [us];20;40;50"]
    found = settings_of(lines, SEMICOLONS, 4, [1, 2, 3])
    assert found.steps == {1: 2e-5, 2: 4e-5, 3: 5e-5}
    assert found.starts == {1: -2e-3, 2: -3e-3, 3: 4e-3}
    assert (found.names, found.units, found.origins) == ({2: "bar", 3: "top"}, {2: "kN"}, {})


def test_settings_with_a_name_before_all_columns_are_moved_by_one():
    assert settings_of(["dt;2;3;4"], SEMICOLONS, 3, [0, 1, 2]).steps == {0: 2.0, 1: 3.0, 2: 4.0}
    assert settings_of(["dt [min];2;3;4"], SEMICOLONS, 3, [0, 1, 2]).steps == {0: 120.0, 1: 180.0, 2: 240.0}
    assert settings_of(["dt;2;0;4"], SEMICOLONS, 3, [0, 1, 2]).steps == {}  # no step is zero
    assert settings_of(["dt;2;3"], SEMICOLONS, 3, [0, 1, 2]).steps == {}
    assert settings_of(["dt;;2;3"], SEMICOLONS, 4, [2, 3]).steps == {2: 2.0, 3: 3.0}
    assert settings_of(["x0;2;-3;x"], SEMICOLONS, 4, [1, 2]).starts == {1: 2.0, 2: -3.0}


def test_clock_times_are_whole_picoseconds():
    """23:59:58.5 is 86398.5 s of a day; 12 AM is midnight and 12 PM noon."""
    assert clock_times({3: "23:59:58,5"}) == {3: 86398 * PICO + PICO // 2}
    assert clock_times({1: "12:00:01 AM", 2: "12:00:01 pm", 3: "1:02:03 PM"}) == {
        1: PICO, 2: 43201 * PICO, 3: (13 * 3600 + 123) * PICO,
    }  # fmt: skip
    days = clock_times({1: "2024-02-28 10:00:00", 2: "2024/03/01T10:00:00.000000000001234"})
    assert days[2] - days[1] == 2 * 86400 * PICO + 1  # a leap year
    assert clock_times({1: "2024-02-30 10:00:00", 2: "2024-03-01 10:00:00"}) == {}
    assert clock_times({1: "10:00:00", 2: "noon"}) == {}
    assert settings_of(["t0;10:00:00;10:00:02"], SEMICOLONS, 3, [1, 2]).origins[2] == 36002 * PICO


def test_start_and_increment_stand_above_their_numbers():
    assert below_start_and_increment(["X,Start,Incr", "s,-3,0.5", "s,-4,0"], COMMAS) == (0.5, -3.0)
    np.testing.assert_equal(below_start_and_increment(["Start,Incr", "x,nan"], COMMAS), (math.nan, math.nan))
    np.testing.assert_equal(below_start_and_increment(["Incr,Start", "-1,3"], COMMAS), (math.nan, 3.0))


@pytest.mark.parametrize(
    ("lines", "count"),
    [(["# Number of samples: 12"], 12), (["Points = 7", "Samples;7"], 7), (["Points = 7", "Samples;8"], 0), ([""], 0)],
)
def test_the_head_counts_the_samples(lines, count):
    assert headings.counted_samples(lines) == count
