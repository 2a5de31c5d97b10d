"""Time, channels and measurements of text records, part by part: small files with known answers."""

import itertools
import math

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import Options, text
from strikewave.records.readers.columns import ParsedColumns
from strikewave.records.readers.text import lay_out, look_at
from strikewave.records.record import Channel, Record

ROWS = "".join(f"{3 + 0.5 * k},{k * k},{-7 * k}\n" for k in range(30))


@pytest.fixture
def read(tmp_path):
    numbered = itertools.count()

    def call(content, options=Options()):  # noqa: B008
        path = tmp_path / f"{next(numbered)}.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return text.read_text(path, options)

    return call


@pytest.fixture
def laid(tmp_path):
    def lay(content):
        path = tmp_path / "lines.csv"
        path.write_text(content)
        look = look_at(path)
        return look, lay_out(look)

    return lay


def codes(record):
    return [finding.code for finding in record.findings]


def named(record):
    return [(channel.name, channel.unit, channel.values[:2].tolist()) for channel in record.channels]


# Time


@pytest.mark.parametrize(
    ("head", "expected"),
    [
        ("a,b,c\n", None), ("a,t,c\n", 1), ("time,b,c\n", 0), ("x [s],b,c\n", 0), ("a,b,c [ms]\n", 2),
        ("t,b,x\n", 0), ("b,x,t\n", 1), ("b,c,t\n", None), ("c,t,time\n", 2), ("", 0),
    ],
)  # fmt: skip
def test_time_is_named_or_rises_evenly(laid, head, expected):
    """A name of one or two letters counts where the column rises; the last one does not."""
    look, layout = laid(head + ROWS)
    rows = text._rows(look.head[layout.first :], layout)
    assert text._time_column(rows, layout, Options()) == expected


def test_a_rate_makes_a_column_called_t_time(laid):
    look, layout = laid("a,T,c\n" + ROWS)
    rows = text._rows(look.head[layout.first :], layout)
    assert text._time_column(rows, layout, Options(rate=3.0)) == 1
    look, layout = laid("a,b,x\n" + ROWS)
    assert text._time_column(rows, layout, Options(rate=3.0)) is None


def test_a_single_column_is_no_time(read):
    assert read("".join(f"{k}\n" for k in range(30))).channels[0].stamps is None


def test_even_time_may_lose_digits_as_it_grows(laid):
    """Six digits: hundredths up to 999.99, tenths from 1000 on; half of a tenth is more than one in a hundred."""
    rows = "".join(f"{f'{990.0 + 0.25 * k:.6g}'},{k % 3}\n" for k in range(100))
    look, layout = laid(rows)
    assert text._even(text._rows(look.head, layout), layout, 0)
    assert not text._even(text._rows(look.head, layout), layout, 1)
    bent = [f"{k},{k % 3}" for k in range(100)]
    bent[15] = "14.6,1"
    assert not text._even(text._rows(bent, layout), layout, 0)
    bent[15], bent[80] = "15,1", "78.6,1"
    assert not text._even(text._rows(bent, layout), layout, 0)


def test_a_column_rises_that_never_falls(laid):
    _, layout = laid(ROWS)

    def rises(*cells):
        return text._rises([[str(cell), "1", "2"] for cell in cells], layout, 0)

    assert rises(1, 2, 2, 3)
    assert not rises(1, 3, 2, 4)
    assert not rises(1, 1, 1)
    assert not rises(1)
    assert rises(1, 2)
    assert not rises(2, 1)


@pytest.mark.parametrize(("wanted", "column"), [("TIME", 1), ("3", 2), ("c [v]", 2), (" c ", 2), ("1", 0)])
def test_the_column_of_time_is_named_or_numbered(laid, wanted, column):
    assert text._named_time(laid("a,time,c [V]\n" + ROWS)[1], wanted, True) == column


@pytest.mark.parametrize("wanted", ["0", "5", "x", "000000003", "d"])
def test_a_column_of_time_that_is_none_is_refused(laid, wanted):
    _, layout = laid("a,time,c [V],d\n" + ROWS.replace("\n", ",\n"))
    with pytest.raises(InputError, match="--time"):
        text._named_time(layout, wanted, False)
    assert text._named_time(layout, "00000003", True) == 2
    with pytest.raises(InputError, match="a column in s, ms, us or ns"):
        text._named_time(layout, "c", False)


def test_time_stamps_give_step_and_start_in_their_unit(read):
    record = read("a,t [ms],b\n" + "".join(f"{k % 4},{-2 + 0.25 * k},{k % 5}\n" for k in range(40)))
    assert named(record) == [("a", "", [0.0, 1.0]), ("b", "", [0.0, 1.0])]
    channel = record.channels[1]
    assert (channel.step, channel.start) == (pytest.approx(2.5e-4, rel=1e-12), -2e-3)
    assert channel.stamps[:3].tolist() == [-2e-3, -1.75e-3, -1.5e-3]
    minutes = read("t,b\n0,1\n1,2\n2,4\n", Options(time_unit=60.0)).channels[0]
    assert (minutes.step, minutes.stamps.tolist()) == (60.0, [0.0, 60.0, 120.0])


def test_the_digits_of_time_are_the_coarser_ones_of_both_ends(laid):
    """Printed without decimals at the end, 69.3 s are 69: the stamps stray by less than 1 s, but by more than 0.1."""
    cells = [f"{0.7 * k:.1f}" if k < 20 else f"{0.7 * k:.0f}" for k in range(100)]
    look, layout = laid("t [s],a\n" + "".join(f"{cell},{k % 3}\n" for k, cell in enumerate(cells)))
    stamps = np.array([float(cell) for cell in cells])
    step, start, skip, findings = text._grid(look, layout, 0, 1.0, stamps, [])
    assert (step, start, skip, findings) == (69.0 / 99.0, 0.0, 0, [])


@pytest.mark.parametrize(
    ("head", "digits", "said"), [("", "", True), ("", ".0", False), ("t,a\n", "", False)]
)  # fmt: skip
def test_a_column_that_counts_is_said_to_be_taken_for_time(laid, head, digits, said):
    look, layout = laid(head + "".join(f"{k}{digits},{k % 3}\n" for k in range(30)))
    found = text._grid(look, layout, 0, 1.0, np.arange(30.0), [])[3]
    assert [one.code for one in found] == ["counter"] * said
    assert not text._grid(look, layout, 0, 1.0, 2.0 * np.arange(30.0), [])[3]
    assert not text._grid(look, layout, 0, 1e-3, 1e-3 * np.arange(30.0), [])[3]


START_AND_STEP = "-2e-03,-2e-03\n5e-05,5e-05\n"


def test_the_first_two_numbers_of_all_columns_may_be_start_and_step(read):
    record = read(START_AND_STEP + "".join(f"{k}.5,{-k}.25\n" for k in range(30)))
    assert [(c.step, c.start, c.values.size, c.values[0]) for c in record.channels] == [
        (5e-5, -2e-3, 30, 0.5), (5e-5, -2e-3, 30, 0.25),
    ]  # fmt: skip
    assert (codes(record), record.findings[0].value) == (["start-and-step"], 5e-5)
    assert codes(read("Samples: 30\n" + START_AND_STEP + "".join(f"{k}.5,{-k}.25\n" for k in range(30)))) == [
        "start-and-step"
    ]
    plain = read("fs = 8 Hz\n" + START_AND_STEP + "".join(f"{k}.5,{-k}.25\n" for k in range(30)))
    assert (plain.channels[0].values.size, plain.channels[0].step) == (32, 0.125)


@pytest.mark.parametrize(
    ("start", "step", "count", "expected"),
    [
        ("-2e-3", "5e-5", 20, True), ("-2e-3", "5e-5", 19, False), ("-2e-3", "0.00005", 20, False), ("0", "5e-5", 20, True),
        ("-2.3e-5", "5e-5", 20, False), ("-2e-3", "5e0", 20, False), ("-2e-3", "-5e-5", 20, False), ("3e0", "1e0", 20, False),
        ("3e0", "9e-1", 20, False), ("-2E-3", "5E-5", 20, True), ("word", "5e-5", 20, False), ("2e1", "9.9999e-1", 20, False),
        ("2e1", "9.99999999e-1", 20, True),
    ],
)  # fmt: skip
def test_start_and_step_are_written_as_no_sample_is(start, step, count, expected):
    rows = [["7", start, start], ["8", step, step], *[["9", "1.5", "2.5"]] * count]
    assert text._begins_with_a_clock(rows, [1, 2], ".") is expected
    assert not text._begins_with_a_clock(rows, [1], ".")
    assert not text._begins_with_a_clock([*rows[:-1], ["9", "1.5"]], [1, 2], ".")
    assert not text._begins_with_a_clock([*rows[:-1], ["9", "1.5", "2e3"]], [1, 2], ".")
    assert not text._begins_with_a_clock([["7", start, "1"], *rows[1:]], [1, 2], ".")
    assert not text._begins_with_a_clock([rows[0], ["7", step, "1"], *rows[2:]], [1, 2], ".")


def test_settings_below_the_first_data_name_the_step_too(read):
    """Within forty lines, as some oscilloscopes write them."""
    for line, step in ((39, 0.125), (40, math.nan)):
        rows = [f"{k},{k * k}" for k in range(60)]
        rows[line] = f"# fs = 8 Hz\n{rows[line]}"
        np.testing.assert_equal(read("a,b\n" + "\n".join(rows) + "\n").channels[0].step, step)


@pytest.mark.parametrize(
    ("rate", "said"), [(4.0, False), (4.039, False), (4.041, True), (3.961, False), (3.959, True)]
)  # fmt: skip
def test_a_rate_within_a_hundredth_of_that_of_the_file_is_not_said(laid, rate, said):
    look, layout = laid("t [ms],a\n" + "".join(f"{250 * k},{k % 3}\n" for k in range(30)))
    rows = text._rows(look.head[layout.first :], layout)
    found = text._overruled(look, rows, layout, 0, rate)
    assert [(one.code, one.value) for one in found] == [("rate-overrules", rate)] * said
    if said:
        assert f"a rate of {rate:.6g} Hz is stated, and the file says 4 Hz" in found[0].message
    look, layout = laid("# fs = 4 Hz\nb,a\n" + "".join(f"{k % 5},{k % 3}\n" for k in range(30)))
    assert len(text._overruled(look, rows, layout, None, rate)) == said
    look, layout = laid("b,a\n" + "".join(f"{k % 5},{k % 3}\n" for k in range(30)))
    assert text._overruled(look, rows, layout, None, rate) == []


def test_lines_without_time_are_left_out():
    columns = {0: np.array([1.0, math.nan, 3.0, math.nan]), 2: np.array([5.0, 6.0, 7.0, 8.0])}
    stamps, lost = text._with_time(columns, 0, 1e-3)
    assert (stamps.tolist(), columns[2].tolist()) == ([1e-3, 3e-3], [5.0, 7.0])
    assert [(one.code, one.value) for one in lost] == [("time-missing", 2.0)]
    assert text._with_time({0: np.array([1.0, 2.0])}, None, 7.0) == (None, [])
    assert text._with_time({0: np.array([1.0, 2.0])}, 0, 7.0)[1] == []


# Channels


def test_a_column_that_counts_samples_is_no_channel(read):
    rows = "".join(f"{k + 5},{k % 3},{k % 5}\n" for k in range(30))
    record = read("no.,a,b\n" + rows, Options(rate=3.0))
    assert named(record) == [("a", "", [0.0, 1.0]), ("b", "", [0.0, 1.0])]
    assert record.findings[0].message == "column 1 is left out: it counts the samples"
    assert named(read("no.,a,b\n" + rows.replace("20,", "20.5,"), Options(rate=3.0)))[0] == ("no.", "", [5.0, 6.0])
    assert len(read("number,a,b\n" + rows, Options(rate=3.0)).channels) == 3
    assert len(read(",a,b\n" + rows, Options(rate=3.0)).channels) == 2
    assert len(read(rows, Options(rate=3.0)).channels) == 3 - 1  # without a head it is time
    assert [name for name, _, _ in named(read("a,b,\n" + rows, Options(rate=3.0)))] == ["a", "b", "channel 3"]


def test_two_lines_are_a_record_and_one_is_none(read):
    assert read("a,b\n1,5\n2,3\n", Options(rate=4.0)).channels[0].values.tolist() == [1.0, 2.0]
    with pytest.raises(InputError, match="at least two lines"):
        read("a,b\n1,5\n", Options(rate=4.0))


def test_channels_not_asked_for_are_not_read(read):
    record = read("t,a,b\n" + ROWS, Options(channels=("b",)))
    assert [(c.name, c.values.strides == (0,), c.values.size) for c in record.channels] == [
        ("a", True, 30),
        ("b", False, 30),
    ]


def test_odd_cells_are_counted_with_the_first_of_them():
    assert text.odd_cells(ParsedColumns([], 0, 0)) == []
    for words, begin in ((1, "1 cell is"), (2, "2 cells are")):
        (found,) = text.odd_cells(ParsedColumns([], words, 17))
        assert (found.code, found.value) == ("not-a-number", float(words))
        assert found.message.startswith(begin)
        assert "line 17" in found.message


def test_the_lines_of_a_file_are_guessed_from_those_looked_at(laid):
    """A twentieth and a hundred more than its bytes over those of a line."""
    look, _ = laid("12,456\n" * 100)
    look = look._replace(size=70000, head=["123456"] * 300, middle=["1234"] * 100, tail=["12345678"] * 100)
    assert text._expected(look) == int(1.05 * 70000 / 7.0) + 100
    assert text._expected(look._replace(encoding="utf-16-le")) == int(1.05 * 70000 / 14.0) + 100
    longer = look._replace(head=["12345678"] * 100 + ["123456"] * 200)
    assert text._expected(longer) == text._expected(look)  # the last two hundred of the beginning
    assert text._expected(look._replace(head=[], middle=[], tail=[])) == int(1.05 * 70000) + 100


@pytest.mark.parametrize(
    ("size", "count", "goes_on", "pieces", "severity"),
    [
        (40, 0, False, 1, None), (40, 40, False, 1, None), (40, 20, False, 2, None), (48, 16, False, 3, None),
        (40, 20, True, 1, "good"), (41, 20, False, 1, "suspect"), (30, 15, False, 1, "suspect"), (20, 40, False, 1, "good"),
        (20, 40, True, 1, "good"),
    ],
)  # fmt: skip
def test_a_head_that_counts_fewer_samples_makes_measurements(size, count, goes_on, pieces, severity):
    whole = Record("a.csv", "text", (Channel("a", np.arange(float(size)), 0.5, 3.0),))
    found = text._as_counted(whole, count, size, goes_on)
    assert 1 + len(found.further) == pieces
    assert [(one.severity, one.value) for one in found.findings] == ([(severity, float(size))] if severity else [])
    assert [len(one.channels[0].values) for one in (found, *found.further)] == [size // pieces] * pieces


# Several measurements


def places(laid, content):
    look, layout = laid(content)
    return text._parts(look, layout)


PIECE = "name\nt,a\n" + "".join(f"{k},{k * k}\n" for k in range(20))


def test_a_head_that_comes_again_begins_a_measurement(laid):
    size = len(PIECE)
    assert places(laid, PIECE) == [(0, size, 1)]
    assert places(laid, PIECE * 3) == [(0, size, 1), (size, 2 * size, 23), (2 * size, 3 * size, 45)]
    assert places(laid, PIECE + "\n\n" + PIECE) == [
        (0, size, 1),
        (size, 2 * size + 2, 23),
    ]  # what is above a head is its own
    assert len(places(laid, PIECE + PIECE.replace("t,a", "t,abc"))) == 1
    assert len(places(laid, PIECE + PIECE.replace("t,a", "t,a  "))) == 2
    assert len(places(laid, (PIECE * 2).replace("t,a", "====="))) == 1  # no letters
    assert len(places(laid, (PIECE * 2).replace("t,a", "ab"))) == 1  # two letters
    assert len(places(laid, PIECE + "t,a")) == 2


def test_a_head_of_more_lines_than_the_most_begins_within(laid, monkeypatch):
    monkeypatch.setattr(text, "_MOST_HEAD_LINES", 3)
    size = len(PIECE)
    assert places(laid, PIECE + "x\ny\nz\n" + PIECE)[1][0] == size + 2
    assert places(laid, PIECE + "x\ny\n" + PIECE)[1][0] == size
    monkeypatch.setattr(text, "MOST_MEASUREMENTS", 1)
    assert len(places(laid, PIECE * 3)) == 3
    assert len(places(laid, PIECE * 5)) == 3


def test_each_measurement_is_read_from_its_own_lines(read):
    record = read(PIECE + PIECE.replace("t,a", "t,a").replace("4,16", "4,x"))
    (second,) = record.further
    assert (record.channels[0].values.size, second.channels[0].values.size) == (20, 20)
    assert (codes(record)[:1], second.findings[-1].value) == ([], 1.0)
    assert "line 29" in second.findings[-1].message


# Long tables


def long(head="Channel,time,value\n", names=("A", "B"), count=20):
    return head + "".join(f"{name},{0.5 * k},{(1 + j) * k}\n" for k in range(count) for j, name in enumerate(names))


def test_lines_that_name_their_channel_make_channels(read):
    record = read(long())
    assert named(record) == [("A", "", [0.0, 1.0]), ("B", "", [0.0, 2.0])]
    assert [(c.step, c.start, c.values.size) for c in record.channels] == [(0.5, 0.0, 20)] * 2
    assert codes(record) == ["long-table"]


@pytest.mark.parametrize("head", ["Channel,time [ms],value [g]\n", "No,Shot,time [ms],value [g]\n"])
def test_units_of_time_hold_in_long_tables_and_numbers_name_channels(read, head):
    if head.startswith("No"):
        content = head + "".join(f"{3 * k % 7},{s},{0.5 * k},{s * k}\n" for s in (4, 6) for k in range(20))
        record = read(content)
        assert [one.channels[-1].values[1] for one in (record, *record.further)] == [4.0, 6.0]
    else:
        record = read(long(head, ("4", "6")))
        assert named(record) == [("Channel 4", "g", [0.0, 1.0]), ("Channel 6", "g", [0.0, 2.0])]
    assert record.channels[0].step == pytest.approx(5e-4, rel=1e-12)
    assert read(content if head.startswith("No") else long(head), Options(time_unit=1.0)).channels[0].step == 0.5


def test_a_long_table_without_time_has_the_step_of_its_head(read):
    record = read("# fs = 4 Hz\n# t0 = 7 s\n" + "Channel,value\n" + "".join(f"{'AB'[k % 2]},{k}\n" for k in range(40)))
    assert [(c.name, c.step, c.start, c.values[:2].tolist()) for c in record.channels] == [
        ("A", 0.25, 7.0, [0.0, 2.0]), ("B", 0.25, 7.0, [1.0, 3.0]),
    ]  # fmt: skip


@pytest.mark.parametrize("count", [16, 40, 52, 120])
def test_lines_that_all_begin_with_another_word_are_no_settings(read, count):
    """Of a short file those at its begin are some of the usual ones too, which makes no word come again."""
    words = [f"{chr(97 + k % 26)}{chr(97 + k // 26)}" for k in range(count)]
    record = read("name,bar,top\n" + "".join(f"{word},{k},{k * k % 7}\n" for k, word in enumerate(words)))
    assert named(record) == [("bar", "", [0.0, 1.0]), ("top", "", [0.0, 1.0])]
    assert [c.values.size for c in record.channels] == [count, count]


def test_a_column_that_rises_in_each_channel_is_time_without_a_name(read):
    record = read(long("", ("A", "B")))
    assert [(c.name, c.step, c.values[:2].tolist()) for c in record.channels] == [
        ("A", 0.5, [0.0, 1.0]),
        ("B", 0.5, [0.0, 2.0]),
    ]


def test_more_names_of_channels_than_two_to_sixty_four_are_refused(read):
    with pytest.raises(InputError, match="2 to 64 channels of at least 16 lines"):
        read(long(count=15))
    assert len(read(long(count=16)).channels) == 2
    assert len(read(long(names=("A",), count=40)).channels) == 1


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0), (2, 0, 1)])
@pytest.mark.parametrize(("label", "names"), [("Channel", ("A", "B")), ("Sensor No", ("4", "6")), ("Shot", ("4", "6"))])
def test_columns_of_a_long_table_may_stand_in_any_order(read, order, label, names):
    """Time in ms from 2 s on; words, numbers of sensors, and of shots."""
    head = [label, "time [ms]", "value [g]"]
    rows = [[name, f"{2000 + 500 * k}", f"{(1 + j) * k}.5"] for k in range(20) for j, name in enumerate(names)]
    if label == "Shot":
        rows = rows[::2] + rows[1::2]
    record = read("".join(",".join(row[k] for k in order) + "\n" for row in [head, *rows]))
    channels = [one.channels[0] for one in (record, *record.further)] if label == "Shot" else record.channels
    assert [(c.unit, c.step, c.start, c.values[:3].tolist()) for c in channels] == [
        ("g", 0.5, 2.0, [0.5, 1.5, 2.5]), ("g", 0.5, 2.0, [0.5, 2.5, 4.5]),
    ]  # fmt: skip
    assert "column-dropped" not in codes(record)


def test_a_column_of_units_stands_beside_the_channels(read):
    rows = [f"{0.5 * k},{'Nm' if j else 'g'},{'top' if j else 'bar'},{k + j}" for k in range(20) for j in range(2)]
    record = read("time,unit,Channel,value\n" + "\n".join(rows) + "\n")
    assert [(c.name, c.unit, c.values[1], c.step) for c in record.channels] == [
        ("bar", "g", 1.0, 0.5),
        ("top", "Nm", 2.0, 0.5),
    ]


def test_time_without_a_name_is_the_first_column_that_rises_in_each_channel(read):
    """A value that rises too stands behind it; one that rises in one channel alone is none."""
    rows = [f"{'AB'[j]},{k if j else 3 * k % 7},{2 + 0.5 * k},{4 * k}" for k in range(20) for j in range(2)]
    record = read("\n".join(rows) + "\n")
    assert [(c.step, c.start) for c in record.channels] == [(0.5, 2.0)] * 4
    assert [c.values[:3].tolist() for c in record.channels] == [
        [0.0, 3.0, 6.0],
        [0.0, 4.0, 8.0],
        [0.0, 1.0, 2.0],
        [0.0, 4.0, 8.0],
    ]
