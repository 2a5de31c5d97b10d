"""LabVIEW measurement files, written as the published specification has them."""

import contextlib
import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records.readers import Options, lvm, read_record
from strikewave.records.record import Record


def header(columns="One", separator="Tab", decimal=".", mark="\t"):
    lines = [
        ("LabVIEW Measurement", ""),
        ("Writer_Version", "2"),
        ("Reader_Version", "2"),
        ("Separator", separator),
        ("Decimal_Separator", decimal),
        ("Multi_Headings", "Yes"),
        ("X_Columns", columns),
        ("Time_Pref", "Absolute"),
        ("Date", "2024/05/06"),
        ("***End_of_Header***", ""),
    ]
    return "".join(f"{key}{mark}{value}\r\n" for key, value in lines) + "\r\n"


def segment(names, rows, start="0.0", step="0.001", units=("g", "V"), samples=None, mark="\t"):
    count = len(units)
    lines = [
        ["Channels", str(count)],
        ["Samples", *(str(k) for k in samples or [len(rows)] * count)],
        ["Date", *["2024/05/06"] * count],
        ["Y_Unit_Label", *units],
        ["X_Dimension", *["Time"] * count],
        ["X0", *[start] * count],
        ["Delta_X", *[step] * count],
        ["***End_of_Header***"],
        [*names, "Comment"],
        *rows,
    ]
    return "".join(mark.join(line) + "\r\n" for line in lines)


TWO = ("X_Value", "board", "frame")
ROWS = [["0.000", "1.5", "-2"], ["0.001", "2.5", "-3"], ["0.002", "4.5", "-5"]]
NEXT = [["0.003", "8.5", "-9"], ["0.004", "16.5", "-17"]]


@pytest.fixture
def read(tmp_path):
    numbered = itertools.count()

    def call(content, options=Options()):  # noqa: B008
        path = tmp_path / f"{next(numbered)}.lvm"
        path.write_bytes(content if isinstance(content, bytes) else content.encode("cp1252"))
        return read_record(path, options)

    return call


def values(record):
    return [channel.values.tolist() for channel in record.channels]


def codes(record):
    return [finding.code for finding in record.findings]


def test_one_time_column_serves_all_channels(read):
    record = read(header() + segment(TWO, ROWS))
    assert record.format == "lvm"
    assert [(c.name, c.unit, c.step) for c in record.channels] == [("board", "g", 0.001), ("frame", "V", 0.001)]
    assert values(record) == [[1.5, 2.5, 4.5], [-2.0, -3.0, -5.0]]
    assert record.channels[1].stamps.tolist() == [0.0, 0.001, 0.002]


def test_every_channel_may_have_a_time_column_of_its_own(read):
    rows = [["0.000", "1", "1.000", "5"], ["0.001", "2", "1.001", "6"], ["0.002", "3", "1.002", "7"]]
    record = read(header("Multi") + segment(("X_Value", "a", "X_Value", "b"), rows))
    assert values(record) == [[1.0, 2.0, 3.0], [5.0, 6.0, 7.0]]
    assert [channel.start for channel in record.channels] == [0.0, 1.0]


def test_without_time_columns_the_header_gives_step_and_start(read):
    rows = [["", "1.5", "-2"], ["", "2.5", "-3"]]
    record = read(header("No") + segment(TWO, rows, start="-0.25", step="5E-6"))
    assert values(record) == [[1.5, 2.5], [-2.0, -3.0]]
    assert [(c.start, c.step, c.stamps) for c in record.channels] == [(-0.25, 5e-6, None)] * 2


@pytest.mark.parametrize(
    ("word", "mark", "decimal"), [("Comma", ",", "."), ("Tab", "\t", ","), ("Semicolon", ";", ",")]
)
def test_separators_are_those_of_the_header(read, word, mark, decimal):
    rows = [[cell.replace(".", decimal) for cell in row] for row in ROWS]
    record = read(header(separator=word, decimal=decimal, mark=mark) + segment(TWO, rows, mark=mark))
    assert values(record) == [[1.5, 2.5, 4.5], [-2.0, -3.0, -5.0]]
    assert record.channels[0].step == pytest.approx(0.001, rel=1e-15)


def test_comments_behind_the_numbers_are_passed_over(read):
    rows = [[*ROWS[0], "first blow"], *ROWS[1:]]
    record = read(header() + segment(TWO, rows))
    assert values(record) == [[1.5, 2.5, 4.5], [-2.0, -3.0, -5.0]]
    assert codes(record) == []


def test_segments_whose_clock_goes_on_are_joined(read):
    record = read(header() + segment(TWO, ROWS) + "\r\n" + segment(TWO, NEXT, start="0.003"))
    assert values(record)[0] == [1.5, 2.5, 4.5, 8.5, 16.5]
    assert record.channels[0].stamps.tolist() == [0.0, 0.001, 0.002, 0.003, 0.004]
    assert codes(record) == []


def test_segments_without_time_columns_are_joined_by_their_starts(read):
    rows = [["", "1", "2"], ["", "3", "4"]]
    record = read(header("No") + segment(TWO, rows) + segment(TWO, rows, start="0.002"))
    assert values(record) == [[1.0, 3.0, 1.0, 3.0], [2.0, 4.0, 2.0, 4.0]]


@pytest.mark.parametrize("start", ["0.000", "0.900"])
def test_of_segments_whose_clock_starts_anew_the_first_is_read_with_a_word(read, start):
    again = [[start, "8.5", "-9"], ["1.000", "16.5", "-17"]]
    record = read(header() + segment(TWO, ROWS) + segment(TWO, again, start=start))
    assert values(record)[0] == [1.5, 2.5, 4.5]
    assert [(f.code, f.value, f.severity) for f in record.findings] == [("segments", 2.0, "suspect")]


def test_a_segment_with_other_channels_is_left_out_with_a_word(read):
    record = read(header() + segment(TWO, ROWS) + segment(("X_Value", "bar"), [["0.003", "1"]], "0.003", units=("g",)))
    assert values(record)[0] == [1.5, 2.5, 4.5]
    assert codes(record) == ["segments"]


def test_absolute_stamps_too_large_for_their_digits_give_the_step_of_the_header(read):
    rows = [[repr(3.8e9 + 1e-6 * k), str(k), "1"] for k in range(2000)]
    record = read(header() + segment(TWO, rows, start="3800000000.0", step="0.000001"))
    assert record.channels[0].step == 1e-6


def test_a_shorter_channel_ends_where_its_samples_end(read):
    rows = [ROWS[0], ROWS[1], ["0.002", "4.5", ""]]
    record = read(header() + segment(TWO, rows, samples=(3, 2)))
    assert values(record) == [[1.5, 2.5, 4.5], [-2.0, -3.0]]


def test_a_last_line_that_is_cut_is_left_out(read):
    record = read((header() + segment(TWO, [*ROWS, ["0.003", "8"]])).removesuffix("\r\n"))
    assert values(record) == [[1.5, 2.5, 4.5], [-2.0, -3.0, -5.0]]
    assert codes(record) == ["truncated"]


def test_channels_not_wanted_keep_their_place_and_cost_nothing(read):
    record = read(header() + segment(TWO, ROWS), Options(channels=("frame",)))
    assert record.channel(2).values.tolist() == [-2.0, -3.0, -5.0]
    assert record.channel(1).values.strides == (0,)


def test_a_rate_overrules_the_clock(read):
    record = read(header() + segment(TWO, ROWS), Options(rate=2e5))
    assert [(c.step, c.start, c.stamps) for c in record.channels] == [(5e-6, 0.0, None)] * 2


def test_a_file_without_a_header_is_text(read):
    record = read("0.000\t1.5\n0.001\t2.5\n0.002\t4.5\n")
    assert (record.format, values(record)) == ("text", [[1.5, 2.5, 4.5]])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("LabVIEW Measurement\r\nSeparator\tTab\r\n0\t1\r\n", "End_of_Header"),
        (header(separator="Pipe") + segment(TWO, ROWS), "its header says Pipe"),
        (header("Some") + segment(TWO, ROWS), "X_Columns One, Multi or No"),
        (header() + segment(("X_Value",), [["0"], ["1"]], units=("g",)), "it names no channels"),
        (header() + segment(TWO, ROWS[:1]), "at least two lines"),
        ((header() + segment(TWO, ROWS)) * 2, "several files are in this one"),
        (
            header() + segment(TWO, [*ROWS, ["0.003", "1", "2", "", "", "3"], ROWS[0]]),
            "4 columns in every line; line 24",
        ),
    ],
)
def test_files_that_cannot_be_used_are_refused_with_a_reason(read, content, words):
    with pytest.raises(InputError, match=words):
        read(content)


@given(
    rows=st.lists(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=2), min_size=2),
    decimal=st.sampled_from([".", ","]),
    cut=st.integers(1, 40),
)
def test_numbers_written_in_full_come_back_to_the_last_bit(tmp_path_factory, rows, decimal, cut):
    cells = [["", *(repr(value).replace(".", decimal) for value in row)] for row in rows]
    parts = [cells[k : k + cut] for k in range(0, len(cells), cut)]
    path = tmp_path_factory.mktemp("trip") / "a.lvm"
    starts = [repr(2.0**-9 * cut * k).replace(".", decimal) for k in range(len(parts))]
    step = repr(2.0**-9).replace(".", decimal)
    content = header("No", decimal=decimal) + "".join(
        segment(TWO, part, start, step) for part, start in zip(parts, starts, strict=True)
    )
    path.write_bytes(content.encode())
    record = lvm.read(path)
    got = np.array([channel.values for channel in record.channels]).T
    assert got.tobytes() == np.array(rows).tobytes()
    assert not math.isnan(record.channels[0].step)
    assert record.channels[0].step == 2.0**-9


@given(data=st.data())
def test_files_with_bytes_changed_give_a_record_or_an_input_error(tmp_path_factory, data):
    content = bytearray((header() + segment(TWO, ROWS) + segment(TWO, NEXT, start="0.003")).encode())
    for _ in range(data.draw(st.integers(1, 8))):
        at = data.draw(st.integers(20, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 60))] = data.draw(st.binary(max_size=4))
    path = tmp_path_factory.mktemp("fuzz") / "a"
    path.write_bytes(content)
    with contextlib.suppress(InputError):
        assert isinstance(lvm.read(path), Record)
