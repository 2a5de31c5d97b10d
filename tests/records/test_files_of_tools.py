"""Records as the tools of engineers write them: numpy, pandas, openpyxl and csv; names, units and times come back."""

import csv
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records import Channel, Record, Request, read_file, read_record, repeats
from strikewave.records.readers import Options

COUNT, STEP = 64, 5e-6
TIME = STEP * np.arange(COUNT)
BOARD = np.round(1000.0 * np.exp(-(((np.arange(COUNT) - 30.0) / 6.0) ** 2)), 3)
FORCE = np.round(0.5 * BOARD[::-1], 3)
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0}


def told(record):
    return [(channel.name, channel.unit) for channel in record.channels]


def check(record, *columns, rel=1e-9):
    """Compare all samples, which must be exact, and the step, as exact as its stamps were printed."""
    assert [channel.values.tolist() for channel in record.channels] == [column.tolist() for column in columns]
    for channel in record.channels:
        assert channel.step == pytest.approx(STEP, rel=rel)


@pytest.fixture
def saved(tmp_path):
    """Write columns as numpy does."""
    numbered = itertools.count()

    def write(header, *columns, **options):
        path = tmp_path / f"{next(numbered)}.txt"
        np.savetxt(path, np.column_stack(columns), header=header, encoding="utf-8", **options)
        return path

    return write


@pytest.mark.parametrize("unit", list(SECONDS))
@pytest.mark.parametrize(
    "header",
    [
        "time ({}), acceleration (g)",
        "time ({})  acceleration (g)",
        "time [{}]; acceleration [g]",
        "time ({}) | acceleration (g)",
        "time/{} acceleration/g",
        "Shot 5 of the drop table\ntime ({}), acceleration (g)",
        "time ({}), acceleration (g)\nmade at noon",
        "time, acceleration\n{}, g",
        "columns: time ({}), acceleration (g)",
        "time in {}, acceleration in g",
        "time in {} since the trigger, acceleration in g",
    ],
)
def test_savetxt_with_a_head_in_a_comment_gives_names_units_and_time(saved, header, unit):
    stamps = TIME / SECONDS[unit]
    record = read_record(saved(header.format(unit), stamps, BOARD))
    assert told(record) == [("acceleration", "g")]
    check(record, BOARD)


@pytest.mark.parametrize("comments", ["# ", "", "% ", "; ", "! "])
@pytest.mark.parametrize("delimiter", [" ", "\t", ",", ";"])
def test_any_sign_of_comments_and_any_delimiter_give_the_same(saved, comments, delimiter):
    path = saved(
        "time (ms), board, raw (g), force (kN)", 1e3 * TIME, BOARD, FORCE, comments=comments, delimiter=delimiter
    )
    record = read_record(path)
    assert [channel.unit for channel in record.channels] == ["g", "kN"]
    check(record, BOARD, FORCE)


def test_a_single_column_takes_its_unit_from_the_comment(saved):
    record = read_record(saved("acceleration (g)", BOARD), Options(rate=1.0 / STEP))
    assert told(record) == [("acceleration", "g")]
    check(record, BOARD)


def test_units_behind_underscores_are_read_where_time_has_one(saved):
    record = read_record(saved("time_ms board_g force_kN", 1e3 * TIME, BOARD, FORCE))
    assert told(record) == [("board", "g"), ("force", "kN")]
    check(record, BOARD, FORCE)
    assert told(read_record(saved("time board_g", TIME, BOARD))) == [("board_g", "")]


@pytest.mark.parametrize(
    ("second", "unit"),
    [
        ("in milliseconds;in g", "g"),
        ("Time in ms since the trigger;Acceleration of the board in g", "g"),
        ("elapsed since the trigger (ms);sensor 1234, range 5000", ""),
        ("(ms);(g)", "g"),
    ],
)
def test_a_second_head_in_prose_gives_units_and_no_names(tmp_path, second, unit):
    rows = "".join(f"{1e3 * t!r};{v!r}\n" for t, v in zip(TIME.tolist(), BOARD.tolist(), strict=True))
    (tmp_path / "a.csv").write_text(f"Recorded on table 3\nTime;Board\n{second}\n{rows}")
    record = read_record(tmp_path / "a.csv")
    assert told(record) == [("Board", unit)]
    check(record, BOARD)


def test_prose_below_names_with_units_does_not_hide_them(tmp_path):
    rows = "".join(f"{1e3 * t!r},{v!r}\n" for t, v in zip(TIME.tolist(), BOARD.tolist(), strict=True))
    (tmp_path / "a.csv").write_text(f"time (ms),acceleration (g)\nsince the trigger,of the board\n{rows}")
    record = read_record(tmp_path / "a.csv")
    assert told(record) == [("acceleration", "g")]
    check(record, BOARD)


# Time


def test_the_unit_of_time_can_be_stated_and_overrules_that_of_the_file(saved):
    bare = saved("time acceleration", 1e3 * TIME, BOARD)
    check(read_record(bare, Options(time_unit=1e-3)), BOARD)
    wrong = saved("time (s), acceleration (g)", 1e3 * TIME, BOARD)
    check(read_record(wrong, Options(time_unit=1e-3)), BOARD)
    ticks = saved("tick acceleration", np.arange(COUNT), BOARD)
    check(read_record(ticks, Options(time="1", time_unit=STEP)), BOARD)


@pytest.mark.parametrize("kind", ["mat", "xlsx"])
def test_the_unit_of_time_can_be_stated_of_arrays_too(tmp_path, kind):
    path = tmp_path / f"a.{kind}"
    if kind == "mat":
        pytest.importorskip("scipy.io").savemat(path, {"time": 1e3 * TIME, "board": BOARD})
    else:
        _workbook(path, {"a": (["time", "board"], 1e3 * TIME, BOARD)})
    check(read_record(path, Options(time_unit=1e-3)), BOARD)


def test_a_stated_unit_of_time_needs_a_time_column_and_no_rate(saved):
    with pytest.raises(InputError, match=r"--time-unit.*name it by --time"):
        read_record(saved("a b", BOARD, FORCE), Options(time_unit=1e-3))
    with pytest.raises(InputError, match=r"--time-unit.*--rate"):
        read_record(saved("time a", TIME, FORCE), Options(time_unit=1e-3, rate=2e5))


@pytest.mark.parametrize("name", ["time (s)", "Time", "t", "Zeit [ms]"])
def test_a_time_column_that_is_named_is_no_channel_beside_a_rate(tmp_path, name):
    stopped = np.zeros(COUNT)  # a clock that stands still is why --rate is given
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(stopped.tolist(), BOARD.tolist(), strict=True))
    (tmp_path / "a.csv").write_text(f"{name},board (g)\n{rows}")
    record = read_record(tmp_path / "a.csv", Options(rate=1.0 / STEP))
    assert told(record) == [("board", "g")]
    check(record, BOARD)


@pytest.mark.parametrize("head", ["time (s),board (g)", "fs = 200 kHz\nboard (g)"])
def test_a_rate_that_is_not_that_of_the_file_is_reported(tmp_path, head):
    columns = [TIME, BOARD] if "time" in head else [BOARD]
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), "%.9g", ",", header=head, comments="")
    slip = read_record(tmp_path / "a.csv", Options(rate=200.0))  # kHz was meant
    assert [finding.code for finding in slip.findings] == ["rate-overrules"]
    assert slip.channels[0].step == 1.0 / 200.0
    assert read_record(tmp_path / "a.csv", Options(rate=200e3)).findings == ()


def test_a_named_column_without_a_number_is_reported(tmp_path):
    rows = "".join(f"{t!r},{v!r},nan\n" for t, v in zip(TIME.tolist(), BOARD.tolist(), strict=True))
    (tmp_path / "a.csv").write_text(f"time (s),board (g),frame (g)\n{rows}")
    record = read_record(tmp_path / "a.csv")
    assert told(record) == [("board", "g")]
    assert "column 3, frame, is left out" in record.findings[0].message


# pandas


def test_frames_of_pandas_come_back_without_their_index(tmp_path):
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({"time (ms)": 1e3 * TIME, "acc (g)": BOARD, "force (kN)": FORCE})
    frame.to_csv(tmp_path / "plain.csv", index=False)
    frame.to_csv(tmp_path / "index.csv")
    frame.to_csv(tmp_path / "german.csv", sep=";", decimal=",")
    frame.set_index("time (ms)").to_csv(tmp_path / "time.tsv", sep="\t")
    pairs = pd.MultiIndex.from_tuples([("time", "ms"), ("acc", "g"), ("force", "kN")])
    frame.set_axis(pairs, axis=1).to_csv(tmp_path / "levels.csv", index=False)
    frame.to_csv(tmp_path / "quoted.csv", quoting=csv.QUOTE_ALL, lineterminator="\r")
    for file in tmp_path.iterdir():
        record = read_record(file)
        assert told(record) == [("acc", "g"), ("force", "kN")], file.name
        check(record, BOARD, FORCE)


# csv


@pytest.mark.parametrize("end", ["\r", "\n", "\r\n"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_quoted_rows_with_any_line_end_are_read(tmp_path, delimiter, end):
    path = tmp_path / "a.csv"
    with path.open("w", newline="") as opened:
        writer = csv.writer(opened, delimiter=delimiter, quoting=csv.QUOTE_ALL, lineterminator=end)
        writer.writerow(["time\n(ms)", "acc\n(g)"])  # as spreadsheets break a heading
        writer.writerows(zip((1e3 * TIME).tolist(), BOARD.tolist(), strict=True))
    record = read_record(path)
    assert told(record) == [("acc", "g")]
    check(record, BOARD)


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_rows_in_quotes_as_a_whole_are_read(tmp_path, mark):
    path = tmp_path / "a.csv"
    with path.open("w", newline="") as opened:
        writer = csv.writer(opened, quoting=csv.QUOTE_ALL, lineterminator="\r")  # each row as its only cell
        writer.writerow([f'"time (ms)"{mark}"acc (g)"'])
        writer.writerows([f"{t!r}{mark}{v!r}"] for t, v in zip((1e3 * TIME).tolist(), BOARD.tolist(), strict=True))
    record = read_record(path)
    assert told(record) == [("acc", "g")]
    check(record, BOARD)


def test_quoted_decimal_commas_alone_in_a_row_stay_numbers(tmp_path):
    rows = "".join('"{}"\r'.format(repr(v).replace(".", ",")) for v in BOARD.tolist())
    (tmp_path / "a.csv").write_bytes(b'"acc (g)"\r' + rows.encode())
    record = read_record(tmp_path / "a.csv", Options(rate=1.0 / STEP))
    check(record, BOARD)


# Settings beside the samples


@pytest.mark.parametrize("padded", [True, False])
def test_five_settings_beside_the_samples_are_no_channel(tmp_path, padded):
    lines = ["time (ms),acc (g),setting"] if padded else ["time (ms),acc (g)"]
    for k, (t, v) in enumerate(zip((1e3 * TIME).tolist(), BOARD.tolist(), strict=True)):
        lines.append(f"{t!r},{v!r}" + (f",{k + 0.5}" if k < 5 else "," * padded))
    (tmp_path / "a.csv").write_text("\n".join(lines) + "\n")
    record = read_record(tmp_path / "a.csv")
    assert told(record) == [("acc", "g")]
    check(record, BOARD)
    assert [(f.code, f.severity) for f in record.findings] == [("column-dropped", "good")]


def test_more_cells_further_down_are_damage_and_not_settings(tmp_path):
    rows = [f"{t!r},{v!r}" for t, v in zip(TIME.tolist(), BOARD.tolist(), strict=True)]
    rows[50] += ",7"
    (tmp_path / "a.csv").write_text("time,acc\n" + "\n".join(rows) + "\n")
    with pytest.raises(InputError, match="line 52 has 3"):
        read_record(tmp_path / "a.csv")


# openpyxl


def _workbook(path, sheets):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, (head, *columns) in sheets.items():
        sheet = book.create_sheet(title)
        sheet.append(head)
        for row in itertools.zip_longest(*(np.asarray(column).tolist() for column in columns)):
            sheet.append(row)
    book.save(path)


def test_sheets_and_columns_of_one_name_stay_apart(tmp_path):
    path = tmp_path / "a.xlsx"
    head = ["time (ms)", "acc (g)", "acc (g)"]
    _workbook(path, {"1": (head, 1e3 * TIME, BOARD, FORCE), "2": (head, 1e3 * TIME, FORCE, BOARD)})
    record = read_record(path)
    assert told(record) == [("1/acc", "g"), ("1/acc (2)", "g"), ("2/acc", "g"), ("2/acc (2)", "g")]
    check(record, BOARD, FORCE, FORCE, BOARD)
    for wanted in ("3", "2/acc", "2/acc (g)"):
        chosen = read_record(path, Options(channels=(wanted,)))
        assert chosen.channel(wanted).values.tolist() == FORCE.tolist()
        assert np.isnan(chosen.channel(2).values).all()


def test_one_name_of_time_stands_for_that_of_every_sheet(tmp_path):
    path = tmp_path / "a.xlsx"
    _workbook(path, {f"{k}": (["clock", "acc (g)"], k * 1e3 * TIME, BOARD) for k in (1, 2)})
    record = read_record(path, Options(time="clock", time_unit=1e-3))
    assert [channel.step for channel in record.channels] == pytest.approx([STEP, 2.0 * STEP], rel=1e-9)


def test_settings_beside_the_samples_of_a_sheet_are_no_channel(tmp_path):
    path = tmp_path / "a.xlsx"
    _workbook(path, {"a": (["time (ms)", "acc (g)", "setting"], 1e3 * TIME, BOARD, np.arange(5.0))})
    record = read_record(path)
    assert told(record) == [("acc", "g")]
    assert "setting" in record.findings[0].message


# Repeats, and reasons


@pytest.fixture
def read_columns(tmp_path):
    def read(columns, time):
        head = ",".join(["time (s)", *columns])
        np.savetxt(
            tmp_path / "a.csv", np.column_stack([time, *columns.values()]), "%.9g", ",", header=head, comments=""
        )
        return read_record(tmp_path / "a.csv")

    return read


def test_columns_that_repeat_a_test_become_files_of_one_channel(read_columns):
    u = np.arange(4000) * 1e-5
    pulse = np.where(abs(u - 0.02) < 1e-4, np.cos(np.pi * (u - 0.02) / 2e-4), 0.0)
    record = read_columns({"shot 1 (g)": 100.0 * pulse, "shot 2 (g)": 110.0 * pulse}, u)
    found = repeats(read_file(record, {}, Request()))
    assert [one.path.rpartition(": ")[2] for one in found] == ["shot 1", "shot 2"]
    assert [(r.channel.name, r.number) for one in found for r in one.channels] == [("shot", 1)] * 2


def test_reasons_name_their_channel_where_there_are_several(read_columns):
    u = np.arange(4000) * 1e-5
    pulse = np.where(abs(u - 0.02) < 1e-4, np.cos(np.pi * (u - 0.02) / 2e-4), 0.0)
    file = read_file(read_columns({"board (g)": 100.0 * pulse, "frame (g)": np.ones(4000)}, u), {}, Request())
    assert file.status == "bad"
    assert any(reason.startswith("frame: ") for reason in file.reasons)
    assert not any("board" in reason for reason in file.reasons if "dead" in reason or "same" in reason)
    alone = read_file(read_columns({"frame (g)": np.ones(4000)}, u), {}, Request())
    assert not any(reason.startswith("frame: ") for reason in alone.reasons)


def test_a_reason_names_a_few_channels_and_counts_the_others():
    silent = tuple(Channel(f"c{k}", np.zeros(100), 1e-5, unit="g") for k in range(9))
    [reason] = {reason for reason in read_file(Record("a", "text", silent), {}, Request()).reasons if "c0" in reason}
    assert reason.startswith("c0, c1, c2, c3 and 5 more: ")


# Round trips


@given(
    rows=st.lists(
        st.tuples(*[st.floats(-1e6, 1e6).map(lambda v: round(v, 6))] * 2), min_size=3, max_size=20, unique=True
    ),
    style=st.sampled_from(
        ["{} ({})", "{} [{}]", "{}/{}", "{}, {}", "{} in {}", "units below", "in a comment", "comment, units below"]
    ),
    time=st.sampled_from(list(SECONDS)),
    unit=st.sampled_from(["g", "m/s^2", "kN", "mV", "V"]),
    marks=st.sampled_from([(",", "."), (";", "."), ("\t", "."), (" ", "."), (";", ","), ("\t", ","), (" ", ",")]),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_any_head_unit_delimiter_and_decimal_mark_come_back(tmp_path_factory, rows, style, time, unit, marks, end):
    delimiter, decimal = marks
    between = {" ": "  "}.get(delimiter, delimiter)
    pairs = [("time", time), ("board", unit), ("frame", unit)]
    if style == "units below":
        head = [delimiter.join(name for name, _ in pairs), delimiter.join(of for _, of in pairs)]
    elif style == "in a comment":
        head = ["# " + ", ".join(f"{name} ({of})" for name, of in pairs)]
    elif style == "comment, units below":
        head = ["# " + between.join(name for name, _ in pairs), "# " + between.join(of for _, of in pairs)]
    elif style == "{}, {}" and delimiter == ",":
        head = [between.join(f'"{style.format(*pair)}"' for pair in pairs)]
    else:
        head = [between.join(style.format(*pair) for pair in pairs)]
    stamps = [k * 2.0**-7 for k in range(len(rows))]
    body = [[repr(v).replace(".", decimal) for v in (t, *row)] for t, row in zip(stamps, rows, strict=True)]
    path = tmp_path_factory.mktemp("trip") / "a.txt"
    path.write_bytes((end.join(head + [delimiter.join(row) for row in body]) + end).encode())
    record = read_record(path)
    assert told(record) == [("board", unit), ("frame", unit)]
    assert np.array([c.values for c in record.channels]).T.tolist() == [list(row) for row in rows]
    assert record.channels[0].step == pytest.approx(2.0**-7 * SECONDS[time], rel=1e-12, abs=0.0)
