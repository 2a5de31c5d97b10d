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
def test_segments_whose_clock_starts_anew_are_measurements_of_their_own(read, start):
    again = [[start, "8.5", "-9"], ["1.000", "16.5", "-17"]]
    content = header() + segment(TWO, ROWS) + segment(TWO, again, start=start)
    first, second = (read(content, Options(measurement=k)) for k in (1, 2))
    assert values(first)[0] == [1.5, 2.5, 4.5]
    assert values(second)[0] == [8.5, 16.5]
    assert second.channels[0].start == float(start)
    with pytest.raises(InputError, match=r"--measurement.*1 to 2"):
        read(content)


def test_a_segment_with_other_channels_is_a_measurement_of_its_own(read):
    other = segment(("X_Value", "bar"), [["0.003", "1"], ["0.004", "2"]], "0.003", units=("N",))
    second = read(header() + segment(TWO, ROWS) + other, Options(measurement=2))
    assert [(c.name, c.unit, c.values.tolist()) for c in second.channels] == [("bar", "N", [1.0, 2.0])]


def test_a_session_that_appended_to_the_file_is_a_measurement_of_its_own(read):
    appended = (
        header()
        + segment(TWO, ROWS)
        + "\r\n"
        + header("No")
        + segment(("X_Value", "bar"), [["", "7"]] * 2, units=("N",))
    )
    second = read(appended, Options(measurement=2))
    assert [(c.name, c.unit, c.values.tolist(), c.stamps) for c in second.channels] == [("bar", "N", [7.0, 7.0], None)]


def test_segments_that_begin_where_the_clock_time_of_the_one_before_ends_are_joined(read):
    def timed(time, rows):
        return segment(TWO, rows).replace("X_Dimension", f"Time\t{time}\t{time}\r\nX_Dimension", 1)

    later = [[f"0.00{k}", str(k), "0"] for k in range(3)]
    record = read(header() + timed("10:00:00.000", ROWS) + timed("10:00:00.003", later))
    assert record.channels[0].stamps == pytest.approx(0.001 * np.arange(6), abs=1e-12)
    with pytest.raises(InputError, match="--measurement"):
        read(header() + timed("10:00:00.000", ROWS) + timed("10:00:01.000", later))


def multi(
    units, samples, names=("X_Value", "a", "X_Value", "b"), starts=("0.0", "0.0"), times=("10:00:00", "10:00:00")
):
    """As LabVIEW lays it out: two cells of the header to a channel, the second empty."""

    def line(key, cells):
        return key + "\t" + "".join(f"{cell}\t\t" for cell in cells) + "\r\n"

    rows = [[f"{0.001 * k:.3f}", str(k), f"{0.002 * k:.3f}", str(10 * k)] for k in range(3)]
    return (
        header("Multi") + "Channels\t2\t\t\t\r\n" + line("Samples", samples) + line("Date", ["2026/01/05"] * 2)
        + line("Time", times) + line("Y_Unit_Label", units) + line("X0", starts) + line("Delta_X", ("0.001", "0.002"))
        + "***End_of_Header***\t\t\t\t\r\n" + "\t".join([*names, "Comment"]) + "\r\n"
        + "".join("\t".join(row) + "\r\n" for row in rows)
    )  # fmt: skip


def test_a_header_with_two_cells_to_a_channel_gives_each_channel_its_own_unit_and_step(read):
    record = read(multi(("m/s^2", "N"), ("3", "3")))
    assert [(c.name, c.unit, c.step, c.values.tolist()) for c in record.channels] == [
        ("a", "m/s^2", 0.001, [0.0, 1.0, 2.0]),
        ("b", "N", 0.002, [0.0, 10.0, 20.0]),
    ]


@pytest.mark.parametrize(
    ("cells", "units"),
    [
        ("g\t\tN\t", ("g", "N")),
        ("\t\tN\t", ("", "N")),
        ("g\t\t\t", ("g", "")),
        ("g\tN", ("g", "N")),
        ("g\tg\tN\tN", ("g", "N")),
        ("\tg\t\tN", ("g", "N")),
        ("s\tg\ts\tN", ("g", "N")),
    ],
)
def test_cells_of_a_header_find_their_channel_however_they_are_laid_out(read, cells, units):
    content = multi(("m/s^2", "N"), ("3", "3")).replace("Y_Unit_Label\tm/s^2\t\tN\t\t", f"Y_Unit_Label\t{cells}")
    assert tuple(channel.unit for channel in read(content).channels) == units


def test_two_different_cells_for_one_channel_are_refused(read):
    content = multi(("m/s^2", "N"), ("3", "3")).replace("Y_Unit_Label\tm/s^2\t\tN\t\t", "Y_Unit_Label\tV\tg\tV\tN")
    with pytest.raises(InputError, match="two different cells"):
        read(content)


def test_channels_that_begin_at_different_clock_times_are_laid_on_one_clock(read):
    record = read(multi(("g", "g"), ("3", "3"), times=("10:00:00.0030000", "10:00:00,0000000")))
    assert [channel.start for channel in record.channels] == [0.003, 0.0]
    assert record.channels[0].stamps == pytest.approx([0.003, 0.004, 0.005], abs=1e-15)
    assert codes(record) == ["start-times"]


def test_a_channel_that_is_read_alone_keeps_its_place_on_the_clock_of_all(read):
    content = multi(("g", "g"), ("3", "3"), times=("10:00:00.003", "10:00:00.000"))
    assert read(content, Options(channels=("a",))).channels[0].start == 0.003


def test_segments_in_other_units_are_measurements_of_their_own(read):
    content = header() + segment(TWO, ROWS) + segment(TWO, NEXT, start="0.003", units=("N", "V"))
    assert [read(content, Options(measurement=k)).channels[0].unit for k in (1, 2)] == ["g", "N"]


def test_clock_times_that_were_never_set_move_nothing(read):
    record = read(multi(("g", "g"), ("3", "3")).replace("2026/01/05", "1903/12/31", 1))
    assert [channel.start for channel in record.channels] == [0.0, 0.0]


def test_one_column_of_time_is_that_of_the_first_channel_where_steps_differ(read):
    rows = [["0.000", "1", "10"], ["0.001", "2", "20"], ["0.002", "3", ""], ["0.003", "4", ""]]
    content = segment(TWO, rows, samples=(4, 2)).replace("Delta_X\t0.001\t0.001", "Delta_X\t0.001\t0.002")
    record = read(header() + content)
    assert [(c.step, c.values.tolist()) for c in record.channels] == [
        (0.001, [1.0, 2.0, 3.0, 4.0]),
        (0.002, [10.0, 20.0]),
    ]
    assert record.channels[1].stamps is None


def test_lines_beyond_the_count_of_a_header_without_time_are_further_measurements(read):
    rows = [["", str(k), "0"] for k in range(40)]
    content = header("No") + segment(TWO, rows, samples=(20, 20))
    assert [read(content, Options(measurement=k)).channels[0].values[0] for k in (1, 2)] == [0.0, 20.0]
    assert read(content, Options(rate=1000.0)).channels[0].values.size == 40


@pytest.mark.parametrize(("lines", "count"), [(50, 20), (30, 10)])
def test_lines_without_time_that_are_no_whole_measurements_are_refused(read, lines, count):
    with pytest.raises(InputError, match=f"its header counts.*has {lines}.*--rate"):
        read(header("No") + segment(TWO, [["", "1", "2"]] * lines, samples=(count, count)))


def test_writes_below_one_header_whose_time_begins_anew_are_measurements(read):
    rows = [[f"{0.001 * (k % 20):.3f}", str(k), "0"] for k in range(60)]
    content = header() + segment(TWO, rows, samples=(20, 20))
    assert [read(content, Options(measurement=k)).channels[0].values[0] for k in (1, 2, 3)] == [0.0, 20.0, 40.0]


def test_fewer_lines_than_the_header_counts_are_reported(read):
    record = read(header() + segment(TWO, ROWS, samples=(500, 500)))
    assert [(f.code, f.severity) for f in record.findings] == [("count-differs", "suspect")]


def test_notes_above_the_channels_and_blocks_of_other_programs_are_no_samples(read):
    notes = "Notes\tX values guaranteed valid only for board\r\n"
    special = "***Start_Special***\r\nlimits\t1\t2\r\n***End_Special***\r\n"
    second = segment(TWO, NEXT, start="0.003").replace("***End_of_Header***\r\n", f"***End_of_Header***\r\n{special}")
    record = read(header() + notes + segment(TWO, ROWS) + "\r\n" + notes + second)
    assert values(record)[0] == [1.5, 2.5, 4.5, 8.5, 16.5]
    assert codes(record) == []


def test_decimal_commas_between_semicolons_of_a_header_are_one_number(read):
    rows = [["", "1,5", "-2"], ["", "2,5", "-3"]]
    content = header("No", "Semicolon", ",", ";") + segment(TWO, rows, start="-0,25", step="0,0005", mark=";")
    record = read(content)
    assert [(c.start, c.step) for c in record.channels] == [(-0.25, 0.0005)] * 2


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
        (header() + segment(("***Start_Special***",), ROWS, units=("g",)), "lacks its names"),
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
    record = lvm.read_lvm(path)
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
        assert isinstance(lvm.read_lvm(path), Record)
