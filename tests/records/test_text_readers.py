"""Text records: every way of writing the same numbers gives the same numbers, and damage is said or refused."""

import itertools
import math
import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records.readers import Options, read_measurements, text
from strikewave.records.readers.columns import cells_of
from strikewave.records.readers.headings import step_of
from strikewave.records.record import Record

LINES = "0.00,1.5,-2\n0.01,2.5,-3\n0.02,4.5,-5\n0.03,8.5,-9\n"
FIRST = [1.5, 2.5, 4.5, 8.5]
SECOND = [-2.0, -3.0, -5.0, -9.0]


@pytest.fixture
def read(tmp_path):
    numbered = itertools.count()

    def call(content, options=Options(), encoding="utf-8"):  # noqa: B008
        path = tmp_path / f"{next(numbered)}.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return text.read_text(path, options)

    return call


def codes(record):
    return [finding.code for finding in record.findings]


def values(record):
    return [channel.values.tolist() for channel in record.channels]


def named(record):
    return [(channel.name, channel.unit) for channel in record.channels]


# Encodings and marks


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings_that_instruments_write_give_the_same_units(read, encoding):
    record = read("Zeit [µs];Lage [°]\n0;1,5\n1;2,5\n2;3,5\n", encoding=encoding)
    assert named(record) == [("Lage", "°")]
    assert record.channels[0].stamps.tolist() == [0.0, 1e-6, 2e-6]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [",", ";", "\t", " ", "  ", ", ", " ;\t"])
def test_every_delimiter_and_line_end_gives_the_same_numbers(read, mark, end):
    record = read(LINES.replace(",", mark).replace("\n", end))
    assert values(record) == [FIRST, SECOND]
    assert record.channels[0].stamps.tolist() == [0.0, 0.01, 0.02, 0.03]


@pytest.mark.parametrize("mark", [";", "\t", " "])
def test_decimal_commas_give_the_same_numbers(read, mark):
    assert values(read(LINES.replace(",", mark).replace(".", ","))) == [FIRST, SECOND]


def test_quoted_cells_may_hold_decimal_commas_between_commas(read):
    assert values(read('"0,00","1,5"\n"0,01","2,5"\n"0,02","4,5"\n')) == [[1.5, 2.5, 4.5]]


def test_one_column_with_decimal_commas_is_one_column(read):
    assert values(read("0,05\n-0,5\n1,25\n")) == [[0.05, -0.5, 1.25]]


def test_comments_and_empty_lines_are_passed_over(read):
    record = read("# made by hand\n% and\n// more\n\n" + LINES.replace("0.02", "# in between\n\n0.02"))
    assert values(record) == [FIRST, SECOND]


def test_trailing_delimiters_make_no_column(read):
    record = read(LINES.replace("\n", ",\n"))
    assert values(record) == [FIRST, SECOND]
    assert codes(record) == []


# Settings of each channel, several measurements


WAVES = "".join(f"05/01/2026 10:45:47.{35000 + 20 * k:06d}\t{k}\t{2 * k}\n" for k in range(30))


def waveforms(*settings, below="time\tY[0]\tY[1]\n"):
    return "".join(line + "\n" for line in settings) + "\n" + below + WAVES


def test_waveforms_of_labview_as_text_have_their_samples_alone_over_their_own_step(read):
    start = "t0\t05/01/2026 10:45:47.035\t05/01/2026 10:45:47.035"
    record = read(waveforms("waveform\t[0]\t[1]", start, "delta t\t0.000020\t0.000020"))
    assert named(record) == [("Y[0]", ""), ("Y[1]", "")]
    assert [channel.values.tolist() for channel in record.channels] == [list(range(30)), list(range(0, 60, 2))]
    assert [(channel.step, channel.start) for channel in record.channels] == [(2e-5, 0.0)] * 2


def test_names_of_waveforms_give_their_units(read):
    settings = ("waveform\tboard [g]\tframe (N)", "delta t\t0.000020\t0.000020")
    assert named(read(waveforms(*settings))) == [("board", "g"), ("frame", "N")]
    stated = waveforms(*settings, below="time\tY[0] [m/s^2]\tY[1]\n")  # the heading of the samples counts first
    assert named(read(stated)) == [("board", "m/s^2"), ("frame", "N")]


def test_each_waveform_keeps_its_own_name_start_and_step(read):
    start = "t0\t05/01/2026 10:45:47.035\t05/01/2026 10:45:47.032"
    record = read(waveforms("waveform\tboard\tframe", start, "delta t\t0.000020\t0.000040"))
    assert named(record) == [("board", ""), ("frame", "")]
    assert [(channel.step, channel.start) for channel in record.channels] == [(2e-5, 0.003), (4e-5, 0.0)]
    assert "start-times" in codes(record)


@pytest.mark.parametrize("row", ["Offset;0;0", "Blockl\u00e4nge;30;30", "Gain;1;1", "Delta t [ms];0,02;0,02"])
def test_rows_of_settings_with_a_number_for_each_channel_are_no_samples(read, row):
    lines = "".join(f"05.01.2026 10:45:{k:02d},5;{k},5;{2 * k}\n" for k in range(30))
    record = read("Name;board;frame\nEinheit;g;N\n" + row + "\n" + lines, Options(rate=1e3))
    assert [channel.values[0] for channel in record.channels] == [0.5, 0.0]
    assert record.channels[0].values.size == 30


@pytest.mark.parametrize("names_first", [True, False])
@pytest.mark.parametrize("count", [2, 3])
def test_a_column_that_is_left_out_is_named_however_many_settings_stand_above(read, count, names_first):
    """The third one here, below two settings and below three; their numbers are the names of no channels."""
    settings = ["t0;0;;0", "delta t;0.00001;;0.00001", "offset;1;;1"][:count]
    rows = "".join(f";{k % 7}.0;;{0.5 * k}\n" for k in range(60))
    head = ["name;left [g];spare;right [g]", *settings]
    record = read("\n".join([*(head if names_first else [*settings, head[0]]), rows]))
    assert {finding.value for finding in record.findings if finding.code == "column-dropped"} == {1.0, 3.0}
    assert named(record) == [("left", "g"), ("right", "g")]


def test_a_word_beside_the_samples_is_no_setting(read):
    lines = ["".join((word, f";{k};{2 * k}\n")) for k, word in enumerate([""] * 5 + ["Impact"] + [""] * 24)]
    record = read("mark;board;frame\n" + "".join(lines), Options(rate=1e3))
    assert values(record)[0] == list(range(30))


def test_a_start_and_an_increment_behind_the_columns_of_an_oscilloscope_are_its_time(read):
    rows = "".join(f"{k},{k}.5,-{k},\n" for k in range(20))
    record = read("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-8.000000e-03,2.000000e-05,\n" + rows)
    assert named(record) == [("CH1", "Volt"), ("CH2", "Volt")]
    assert [(channel.step, channel.start) for channel in record.channels] == [(2e-5, -0.008)] * 2


@pytest.mark.parametrize("head", ["t0\t2026-01-05 10:45:47\n", "t0 = 05.01.2026\n", "start: 10:45:47\n"])
def test_a_date_is_no_start_in_seconds(read, head):
    record = read(f"{head}fs = 1000 Hz\n" + "".join(f"{k}.5\n" for k in range(20)))
    assert record.channels[0].start == 0.0


PIECE = "".join(f"{k / 100:.2f},{k}.5,-{k}\n" for k in range(20))


@pytest.mark.parametrize(
    "content",
    [
        "time [ms],board [g],frame [g]\n" + PIECE + PIECE,
        2 * ("time [ms],board [g],frame [g]\n" + PIECE),
        2 * ("# made by hand\n# time [ms], board [g], frame [g]\n" + PIECE + "\n"),
        2 * ("run,1,2\ntime,board,frame\nms,g,g\n" + PIECE),
    ],
    ids=["time alone", "head", "comment", "head of lines"],
)
def test_measurements_one_after_another_are_records_of_their_own(tmp_path, content):
    (tmp_path / "a.csv").write_text(content)
    records = read_measurements(tmp_path / "a.csv")
    assert [record.channels[0].values.tolist() for record in records] == [[k + 0.5 for k in range(20)]] * 2
    assert [record.channels[0].stamps[0] for record in records] == [0.0, 0.0]
    assert {named(record)[0] for record in records} == {("board", "g")}


def test_each_measurement_has_the_settings_of_its_own_head(tmp_path):
    pieces = [f"fs = {rate} Hz\nboard [g]\n" + "".join(f"{k}.5\n" for k in range(20)) for rate in (1000, 2000)]
    (tmp_path / "a.csv").write_text("".join(pieces))
    records = read_measurements(tmp_path / "a.csv")
    assert [(r.channels[0].step, r.channels[0].values.size) for r in records] == [(1e-3, 20), (5e-4, 20)]


def test_a_clock_that_is_set_back_once_makes_no_second_measurement(tmp_path):
    lines = [f"{k / 100 - 0.05 * (k > 30):.2f},{k}.5\n" for k in range(60)]
    (tmp_path / "a.csv").write_text("time [ms],board [g]\n" + "".join(lines))
    assert len(read_measurements(tmp_path / "a.csv")) == 1


@pytest.mark.parametrize(("count", "sizes"), [(20, [20, 20]), (40, [40])])
def test_lines_without_time_are_measurements_of_as_many_samples_as_the_head_counts(tmp_path, count, sizes):
    lines = "".join(f"{k}.5\n" for k in range(40))
    (tmp_path / "a.csv").write_text(f"Samples: {count}\nfs = 1000 Hz\n{lines}")
    assert [r.channels[0].values.size for r in read_measurements(tmp_path / "a.csv")] == sizes


@pytest.mark.parametrize(("count", "severity"), [(30, "suspect"), (500, "good")])
def test_a_head_that_counts_other_samples_than_the_file_has_is_reported(read, count, severity):
    record = read(f"Record Length,{count},Points\nfs = 1000 Hz\n" + "".join(f"{k}.5\n" for k in range(40)))
    assert [(f.code, f.severity) for f in record.findings] == [("count-differs", severity)]


# Headers


@pytest.mark.parametrize(
    ("header", "name", "unit", "factor"),
    [
        ("time [ms],board [g],x\n", "board", "g", 1e-3),
        ("Time (us),Acc (g),x\n", "Acc", "g", 1e-6),
        ("Time/s,CH1(V),x\n", "CH1", "V", 1.0),
        ("t [ns],CH1/mV,x\n", "CH1", "mV", 1e-9),
        ('time_ms,"acc, m/s^2",x\n', "acc", "m/s^2", 1e-3),
        ("time,board,frame\ns,V,V\n", "board", "V", 1.0),
        ("Time,Channel A,Channel B\n(ms),(V),(mV)\n\n", "Channel A", "V", 1e-3),
        ("x-axis,1,2\nsecond,Volt,Volt\n", "1", "Volt", 1.0),
        ("Second,Volt,Volt\n", "Volt", "Volt", 1.0),
        ("# time [ms], board [g], frame [g]\n", "board", "g", 1e-3),
        ("made by,the logger\nserial,7\nZeit in ms,Kraft in kN,x\n", "Kraft", "kN", 1e-3),
    ],
)
def test_names_and_units_come_from_the_header(read, header, name, unit, factor):
    record = read(header + LINES)
    assert named(record)[0] == (name, unit)
    assert values(record) == [FIRST, SECOND]
    assert record.channels[0].stamps == pytest.approx(factor * np.array([0.0, 0.01, 0.02, 0.03]), rel=1e-15, abs=0.0)


def test_blanks_between_names_and_units_are_understood(read):
    record = read("time [ms]  board (g)  frame (g)\n" + LINES.replace(",", "  "))
    assert named(record) == [("board", "g"), ("frame", "g")]
    assert record.channels[0].step == pytest.approx(1e-5, rel=1e-12)


def test_names_that_come_again_get_a_number(read):
    assert named(read("time,a,a\n" + LINES)) == [("a", ""), ("a (2)", "")]


def test_without_a_header_channels_are_numbered(read):
    assert named(read(LINES)) == [("channel 1", ""), ("channel 2", "")]


# Oscilloscopes, as their manuals print the files


def test_tektronix_settings_beside_the_data_are_left_out(read):
    beside = ["Record Length,4,Points", "Sample Interval,1e-06,s", 'Note,"",']
    rows = [f"{k * 1e-6:.6e},{0.5 * k}" for k in range(40)]
    record = read("\n".join(f"{beside[k] if k < 3 else ',,'},{row}" for k, row in enumerate(rows)) + "\n")
    assert values(record) == [[0.5 * k for k in range(40)]]
    assert record.channels[0].step == pytest.approx(1e-6, rel=1e-9)
    assert set(codes(record)) == {"column-dropped"}


def test_tektronix_settings_above_the_data_name_the_units(read):
    above = "Model,MSO54\nHorizontal Units,s,\nVertical Units,V,A\nSample Interval,0.01\n\nTIME,CH1,CH2\n"
    record = read(above + LINES)
    assert named(record) == [("CH1", "V"), ("CH2", "A")]
    assert values(record) == [FIRST, SECOND]


def test_lecroy_segments_and_names_are_passed_over(read):
    above = "LECROYWR6Zi,1,Waveform\nSegments,1,SegmentSize,4\nSegment,TrigTime,TimeSinceSegment1\n#1,12-Dec-2012,0\n"
    record = read(above + "Time,Ampl\n0.00,1.5\n0.01,2.5\n0.02,4.5\n0.03,8.5\n")
    assert values(record) == [FIRST]
    assert named(record) == [("Ampl", "")]


def test_rigol_start_and_increment_stand_in_the_header(read):
    record = read("X,CH1,Start,Increment,\nSequence,Volt,-6.0e-05,1.0e-07\n0,1.5,,\n1,2.5,,\n2,4.5,,\n3,8.5,,\n")
    assert values(record) == [FIRST]
    assert (record.channels[0].step, record.channels[0].start) == (1e-7, -6e-5)
    assert record.channels[0].unit == "Volt"


def test_siglent_interval_above_does_not_hide_the_time_column(read):
    above = "Record Length,Analog:4\nSample Interval,Analog:0.01\nVertical Scale,CH1:0.05\nSecond,Volt\n"
    record = read(above + "0.00,1.5\n0.01,2.5\n0.02,4.5\n0.03,8.5\n")
    assert values(record) == [FIRST]
    assert record.channels[0].stamps.tolist() == [0.0, 0.01, 0.02, 0.03]


def test_start_and_step_on_top_of_every_column_are_no_samples(read):
    samples = [(0.001 * k, -0.002 * k * k) for k in range(30)]
    rows = "".join(f"\t\t{a:.6f}\t{b:.6f}\n" for a, b in samples)
    record = read("Date\t1/2/2006\tbar\tspecimen\nTime\t11:48\t-5E-05\t-5E-05\nBy\tme\t1E-07\t1E-07\n" + rows)
    assert named(record) == [("bar", ""), ("specimen", "")]
    assert values(record)[0] == [round(a, 6) for a, _ in samples]
    assert (record.channels[1].start, record.channels[1].step) == (-5e-5, 1e-7)
    assert "start-and-step" in codes(record)


# Time


def test_options_name_the_time_column(read):
    content = "clock [ms],b\n" + "5,1\n6,2\n8,3\n"
    for wanted in ("clock", "CLOCK", "clock [ms]", "1"):
        record = read(content, Options(time=wanted))
        assert record.channels[0].stamps.tolist() == [5e-3, 6e-3, 8e-3]
    assert read(content, Options(time="1")).channels[0].start == 5e-3


def test_a_rate_overrules_time_which_then_is_no_channel(read):
    record = read(LINES, Options(rate=1e6))
    assert values(record) == [FIRST, SECOND]
    assert (record.channels[0].step, record.channels[0].start, record.channels[0].stamps) == (1e-6, 0.0, None)


def test_without_time_all_columns_are_channels_and_the_step_is_unknown(read):
    record = read("3,1\n1,2\n4,3\n")
    assert values(record) == [[3.0, 1.0, 4.0], [1.0, 2.0, 3.0]] or values(record) == [[3.0, 1.0, 4.0]]
    record = read("a,b\n3,1\n1,7\n4,3\n")
    assert values(record) == [[3.0, 1.0, 4.0], [1.0, 7.0, 3.0]]
    assert math.isnan(record.channels[0].step)


@pytest.mark.parametrize(
    ("line", "step"),
    [
        ("Sampling rate: 200 kHz", 5e-6),
        ('"Sample Interval",8e-9,s', 8e-9),
        ("fs = 1 MHz", 1e-6),
        ("# Sample Rate (Hz): 5000", 2e-4),
        ("Abtastrate;4 kHz", 2.5e-4),
        ("dt=2 us", 2e-6),
        ("Sample Rate,100 MSa/s", 1e-8),
    ],
)
def test_a_rate_above_the_data_is_used_where_there_is_no_time(read, line, step):
    record = read(f"{line}\na;b\n3;1\n1;7\n4;3\n")
    assert values(record) == [[3.0, 1.0, 4.0], [1.0, 7.0, 3.0]]
    assert record.channels[0].step == pytest.approx(step, rel=1e-15)
    assert record.channels[0].stamps is None


def test_a_counter_taken_as_time_is_said(read):
    assert codes(read("1,5\n2,7\n3,6\n4,6\n")) == ["counter"]


@pytest.mark.parametrize("rate", [51_200.0, 44_100.0, 1e6 / 7.0])
@pytest.mark.parametrize("form", ["{:.5f}", "{:.6f}", "{:.5e}", "{:.4g}"])
def test_stamps_printed_with_few_digits_give_the_true_step(read, rate, form):
    time = np.arange(5000) / rate
    record = read("".join(f"{form.format(t)} {k % 7}\n" for k, t in enumerate(time)))
    # both ends are off by at most half of their last digit, 1e-5 s with four digits of 0.1 s
    assert record.channels[0].step == pytest.approx(1.0 / rate, abs=1.01e-4 / 4999 if "4g" in form else 1.01e-5 / 4999)


def test_the_step_of_uneven_stamps_is_their_median():
    stamps = np.delete(np.arange(1000) * 1e-5, [10, 11, 500])
    assert step_of(stamps, 1e-9) == pytest.approx(1e-5, rel=1e-9)
    assert step_of(np.delete(np.arange(1000.0), [500]), 1.0) == 1.0


# Damage that is said


def test_a_column_with_a_value_in_the_first_line_only_is_dropped(read):
    record = read("0.00\t1.5\t0.27\n0.01\t2.5\t\n0.02\t4.5\t\n0.03\t8.5\t\n")
    assert values(record) == [FIRST]
    assert [(f.code, f.severity) for f in record.findings] == [("column-dropped", "good")]


def test_missing_cells_become_nan_without_a_word(read):
    record = read("0.00,1.5,1\n0.01,,2\n0.02,nan,3\n0.03,8.5\n0.04,1.5,5\n")
    assert values(record)[0] == pytest.approx([1.5, math.nan, math.nan, 8.5, 1.5], nan_ok=True)
    assert values(record)[1] == pytest.approx([1.0, 2.0, 3.0, math.nan, 5.0], nan_ok=True)
    assert codes(record) == []


@pytest.mark.parametrize("word", ["OVER", "inf", "-Infinity", "1e999", "1_0", "0x10", "∞"])
def test_words_among_numbers_are_counted_with_their_first_line(read, word):
    record = read(f"time,a\n0.0,{word}\n0.1,2\n0.2,{word}\n0.3,4\n0.4,5\n")
    assert values(record)[0] == pytest.approx([math.nan, 2.0, math.nan, 4.0, 5.0], nan_ok=True)
    (finding,) = record.findings
    assert (finding.code, finding.value, finding.severity) == ("not-a-number", 2.0, "suspect")
    assert "line 2" in finding.message


def test_words_are_found_in_the_right_line_of_a_long_file(read):
    lines = [f"{k * 1e-6:.6f},{k % 17}\n" for k in range(60_000)]
    lines[43_210] = "0.043210,over\n"
    record = read("t,a\n" + "".join(lines))
    assert np.flatnonzero(np.isnan(record.channels[0].values)).tolist() == [43_210]
    assert "line 43212" in record.findings[0].message


@pytest.mark.parametrize("end", ["0.04,1", "0.04", "0.04,", "0.04,-", "0.04\n", "0.04,1.5e"])
def test_a_last_line_that_is_cut_is_left_out(read, end):
    record = read("".join(f"0.{k:02d},{k}.25\n" for k in range(4)) * 1 + end if end != "0.04,1" else _fixed() + end)
    assert "truncated" in codes(record)
    assert record.channels[0].values.size == (12 if end == "0.04,1" else 4)


def _fixed():
    return "".join(f"{0.01 * k:.2f},{k}.25\n" for k in range(12))


def test_a_last_line_without_an_end_that_is_whole_is_kept(read):
    record = read(_fixed() + "0.12,12.25")
    assert record.channels[0].values.size == 13
    assert codes(record) == []


def test_lines_without_time_are_left_out_with_a_word(read):
    record = read("time,a\n0.0,1\n,2\n0.2,3\n0.3,4\n")
    assert values(record) == [[1.0, 3.0, 4.0]]
    assert codes(record) == ["time-missing"]


# Channels wanted


def test_channels_not_wanted_keep_their_place_and_cost_nothing(read):
    record = read("time,a,b\n" + LINES, Options(channels=("b",)))
    assert record.channel(2).values.tolist() == SECOND
    assert record.channel("a").values.strides == (0,)


# Refusals


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "bytes that are no text"),
        (b"\xff\xfe\0\0a\0\0\0", "bytes that are no text"),
        (b"once upon a time\nthere was no number\n", "columns of numbers"),
        (b"1,2\n", "at least two lines"),
        (b"t,a\n" + LINES.encode() + b"0.04,1,2,3,4\n", "line 6 has 5"),
        (b'"time,a,b"\n' + 9 * b'"1,2,3"\n' + b'"time,a,b"\n' + b'"1,2,3"\n', "the header comes again in line 11"),
        (b"0,05,1,5\n0,06,1,7\n", "semicolons"),
        (b"1" * 3_000_000, "lines of at most"),
        (b"1," * 20_000 + b"1\n" + b"1," * 20_000 + b"1\n", "at most 10000 columns"),
    ],
)
def test_files_that_cannot_be_used_are_refused_with_a_reason(read, content, words):
    with pytest.raises(InputError, match=words):
        read(content)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (Options(time="tme"), 'did you mean "time"'),
        (Options(time="9"), "number from 1 to 3"),
        (Options(time="a"), "its unit is V: state another by --time-unit, or give --rate"),
        (Options(channels=("c",)), "--channel"),
        (Options(channels=("3",)), "1 a, 2 b"),
    ],
)
def test_options_that_name_nothing_are_refused(read, options, words):
    with pytest.raises(InputError, match=words):
        read("time,a [V],b\n" + LINES, options)


def test_a_line_without_end_takes_bounded_memory(tmp_path):
    path = tmp_path / "long.csv"
    with path.open("wb") as opened:
        opened.write(b"0.000000000,1.000000000\n" * 1000)
        opened.seek(60_000_000)
        opened.write(b"\n")
    path.write_bytes(path.read_bytes().replace(b"\0", b"7"))
    tracemalloc.start()
    with pytest.raises(InputError, match="lines of at most"):
        text.read_text(path)
    assert tracemalloc.get_traced_memory()[1] < 100e6  # of which 2 columns for 60 MB in lines like the first
    tracemalloc.stop()


# Round trips

numbers = st.floats(allow_nan=False, allow_infinity=False)
tables = st.integers(1, 4).flatmap(
    lambda width: st.lists(st.lists(numbers, min_size=width, max_size=width), min_size=3, max_size=30)
)


@given(
    rows=tables,
    marks=st.sampled_from([(",", "."), (";", "."), ("\t", "."), (" ", "."), (";", ","), ("\t", ","), (" ", ",")]),
    heading=st.sampled_from(["none", "names", "brackets", "row"]),
    timed=st.booleans(),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"]),
)
def test_numbers_written_in_full_come_back_to_the_last_bit(tmp_path_factory, rows, marks, heading, timed, encoding):
    delimiter, decimal = marks
    width = len(rows[0])
    stamps = [k * 2.0**-10 for k in range(len(rows))]
    full = [[t, *row] for t, row in zip(stamps, rows, strict=True)] if timed else rows
    cells = [[repr(value).replace(".", decimal) for value in row] for row in full]
    # "0,0" in a lone column may be two columns of whole numbers as well
    whole = any(re.fullmatch(r"-?\d+,\d+", cell) for row in cells for cell in row)
    assume(timed or width > 1 or not whole)
    names = ["time"] * timed + [f"signal{k}" for k in range(width)]
    units = ["s"] * timed + ["V"] * width
    if heading == "brackets":
        names = [f"{name}[{unit}]" for name, unit in zip(names, units, strict=True)]
    # without a header and with a rate, a first column that happens to rise evenly would be time
    head = [] if heading == "none" and timed else [names, units] if heading == "row" else [names]
    path = tmp_path_factory.mktemp("trip") / "a.csv"
    path.write_bytes("".join(delimiter.join(row) + "\n" for row in head + cells).encode(encoding))
    options = Options(time="1") if timed else Options(rate=1e5)
    record = text.read_text(path, options)
    expected = np.array(rows)
    got = np.array([channel.values for channel in record.channels]).T
    assert got.tobytes() == expected.tobytes()
    if timed:
        assert record.channels[0].stamps.tolist() == stamps
        assert record.channels[0].step == 2.0**-10
    if heading in ("brackets", "row"):
        assert {channel.unit for channel in record.channels} == {"V"}


# Fuzz


def outcome(path, options=Options()):  # noqa: B008
    try:
        return text.read_text(path, options)
    except InputError as error:
        return error


@given(content=st.binary(max_size=400))
def test_random_bytes_give_a_record_or_an_input_error(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("fuzz") / "a"
    path.write_bytes(content or b"\n")
    assert isinstance(outcome(path), Record | InputError)


@given(content=st.text(alphabet='0123456789.,;\t\n\r "eE+-#%/abnif[]()µ\x1a', max_size=300))
def test_random_text_like_numbers_gives_a_record_or_an_input_error(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("fuzz") / "a"
    path.write_text(content or "\n", "utf-8", newline="")
    assert isinstance(outcome(path), Record | InputError)


@given(data=st.data())
def test_files_with_bytes_changed_give_a_record_or_an_input_error(tmp_path_factory, data):
    content = bytearray(b"fs = 1 kHz\ntime [ms],board [g],frame [g]\n" + LINES.encode() * 3)
    for _ in range(data.draw(st.integers(1, 8))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 4))] = data.draw(st.binary(max_size=4))
        content = content or bytearray(b"\n")
    path = tmp_path_factory.mktemp("fuzz") / "a"
    path.write_bytes(content)
    assert isinstance(outcome(path), Record | InputError)


# Real records


def test_shocks_of_a_circuit_board_have_two_channels_at_200_khz(measured):
    record = text.read_text(measured("smd-5kg-impacts") / "impact_05.lvm")
    assert [channel.values.size for channel in record.channels] == [20_000, 20_000]
    assert record.channels[0].step == pytest.approx(5e-6, rel=1e-9)
    assert record.channels[0].values[0] == 146.646210
    assert record.channels[1].values[-1] == 57.818484
    assert codes(record) == ["column-dropped"]


def test_a_split_hopkinson_record_of_an_oscilloscope_is_read_with_its_settings_beside_it(measured):
    record = text.read_text(measured("lanl-kolsky") / "lanl_PMMA13_Ch1.csv")
    (channel,) = record.channels
    assert channel.values.size == 50_000
    assert (channel.step, channel.start) == (pytest.approx(8e-9, rel=1e-9), -8e-5)
    assert channel.values[[0, -1]].tolist() == [-2.08124998e-2, -1.16812501e-1]


def test_a_split_hopkinson_record_with_start_and_step_on_top_is_read_at_10_mhz(measured):
    record = text.read_text(measured("lanl-kolsky") / "lanl_Cu_20061201_1148HE.raw")
    assert [channel.name for channel in record.channels] == ["Incident/Reflected Waveform", "Transmitted Waveform"]
    assert record.channels[0].values.tolist()[:2] == [-0.011292, -0.012207]
    assert (record.channels[0].step, record.channels[0].start) == (1e-7, -5e-5)


def test_a_comment_above_thousands_of_columns_costs_no_more_than_a_header(tmp_path, monkeypatch):
    """Lines are cut once for all columns that may be time: 5000 columns took half a minute."""
    names, row = ",".join(f"name {k} in (x" for k in range(2000)), ",".join(["1.5"] * 2000)
    (tmp_path / "a.csv").write_text(f"# {names}\n" + f"{row}\n" * 40)
    cut = []
    monkeypatch.setattr(text, "cells_of", lambda line, marks: cut.append(line) or cells_of(line, marks))
    record = text.read_text(tmp_path / "a.csv")
    assert len(record.channels) == 2000
    assert len(cut) < 1000  # once for each line that is looked at, whatever the number of columns
