"""Heads and clocks of LabVIEW measurement files, part by part: small examples worked by hand."""

import math
from pathlib import Path

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import Options, lvm
from strikewave.records.readers.columns import Marks, Region
from strikewave.records.readers.headings import PICO
from strikewave.records.record import Channel

FILE = Path("blow.lvm")
TABS = Marks("\t")


def segment(columns=("x_value", "bar", "top"), kind="one", **keys):
    cells = {key: value.split(";") for key, value in keys.items()}
    return lvm.Segment(cells, list(columns), 0, 0, 1, TABS, kind, 0)


# Clock times


@pytest.mark.parametrize(
    ("day", "time", "picoseconds"),
    [
        ("1970/1/1", "00:00:00", 719163 * 86400 * PICO),  # the ordinal of that day
        ("1970/01/02", "23:58:57.5", (719164 * 86400 + 86337) * PICO + PICO // 2),
        ("2026/01/02", "10:00:00,0000000000019", (739618 * 86400 + 36000) * PICO + 1),
        ("1969/12/31", "23:59:59", None), ("2026/02/29", "10:00:00", None), ("", "10:00:00", None),
        ("2026/01/02", "", None), ("2026/01/02 x", "10:00:00", None),
    ],
)  # fmt: skip
def test_a_clock_time_is_one_number_of_picoseconds(day, time, picoseconds):
    assert lvm._clock_time(day, time) == picoseconds


def test_each_channel_has_the_clock_time_of_its_own_cells():
    own = segment(Date="1970/01/01;1970/01/01", Time="00:00:01;")
    assert lvm._origins(FILE, own, [(1, 0), (2, 0)]) == [(719163 * 86400 + 1) * PICO, None]


# Heads


def test_keys_and_their_cells_are_cut_by_any_mark():
    assert lvm._keys(b"A, 1;2\tx\n\nB\n", "utf-8") == {"A": ["1", "2", "x"], "A, 1;2": ["x"], "B": []}
    assert lvm._keys(b"A;1,5;2,5\nB,3,4\n ;5\n", "utf-8", ";") == {"A": ["1,5", "2,5"], "B": ["3", "4"]}
    assert lvm._keys(b"Separator,Comma\nC;2;3", "utf-8") == {"Separator": ["Comma"], "C": ["2", "3"]}


@pytest.mark.parametrize(
    ("keys", "marks"),
    [
        ({}, Marks("\t")), ({"Separator": ["Semicolon"], "Decimal_Separator": [","]}, Marks(";", ",")),
        ({"Separator": ["Space"]}, Marks("")), ({"Separator": [","]}, Marks(",")), ({"Separator": [";"]}, Marks(";")),
        ({"Separator": ["Comma"], "Decimal_Separator": ["."]}, Marks(",")),
        ({"Separator": ["Semicolon"], "Decimal_Separator": ["", ""]}, Marks(";", ",")),  # it was cut at the comma
        ({"Separator": ["Tab"], "Decimal_Separator": [""]}, Marks("\t", ",")),
    ],
)  # fmt: skip
def test_marks_are_said_by_the_head(keys, marks):
    assert lvm._marks(FILE, keys) == marks


@pytest.mark.parametrize("keys", [{"Separator": ["Bar"]}, {"Separator": ["Comma"], "Decimal_Separator": [","]}])
def test_marks_that_cannot_be_are_refused(keys):
    with pytest.raises(InputError, match="Tab, Comma, Semicolon or Space"):
        lvm._marks(FILE, keys)


def test_a_word_of_the_head_may_be_missing():
    assert lvm._said({"A": ["1", "2"], "B": [""]}, "A", "z") == "1"
    assert (
        lvm._said({"A": ["1"], "B": [""]}, "B", "z") == lvm._said({"B": []}, "B", "z") == lvm._said({}, "B", "z") == "z"
    )


@pytest.mark.parametrize(
    ("columns", "kind", "keys", "expected"),
    [
        (("X_Value", "a", "b", "Comment"), "one", {}, [(1, 0), (2, 0)]),
        (("X_Value", "a", "X_Value", "b", ""), "multi", {}, [(1, 0), (3, 2)]),
        (("X_Value", "a", "b"), "no", {}, [(1, None), (2, None)]),
        (("a", "X_Value", "b"), "one", {}, [(0, None), (2, 1)]),
        (("X_Value", "a", "b", "note"), "one", {"Channels": "2"}, [(1, 0), (2, 0)]),
        (("X_Value", "a", "b"), "one", {"Channels": "1"}, [(1, 0)]),
        (("X_Value", "a", "b"), "one", {"Channels": "0"}, [(1, 0), (2, 0)]),
        (("X_Value", "a", "b"), "one", {"Channels": "3"}, [(1, 0), (2, 0)]),
        (("X_Value", "a"), "one", {"Channels": "x"}, [(1, 0)]),
    ],
)
def test_channels_have_a_column_and_that_of_their_time(columns, kind, keys, expected):
    assert lvm._columns(segment(columns, kind, **keys), FILE) == expected


def test_more_columns_than_any_recorder_are_refused(monkeypatch):
    monkeypatch.setattr(lvm, "MOST_COLUMNS", 3)
    assert len(lvm._columns(segment(("X_Value", "a", "b")), FILE)) == 2
    for columns in ((), ("X_Value", "a", "b", "c")):
        with pytest.raises(InputError, match="1 to 3 columns"):
            lvm._columns(segment(columns), FILE)


@pytest.mark.parametrize(
    ("kind", "cells", "expected"),
    [
        ("one", "g;N", ["g", "N"]), ("one", "g", ["g", ""]), ("one", "g;;N;", ["g", ""]), ("multi", "g;;N;", ["g", "N"]),
        ("multi", "g;N", ["g", "N"]), ("multi", ";g;;N", ["g", "N"]), ("multi", "s;g;s;N", ["g", "N"]),
        ("multi", "g;", ["g", ""]), ("multi", "g", ["g", ""]), ("multi", ";g;N;", ["g", "N"]),
        ("multi", ";;;N", ["", "N"]), ("multi", "g;g;;N", ["g", "N"]), ("multi", "V;N;x", None),
    ],
)  # fmt: skip
def test_cells_find_their_channels(kind, cells, expected):
    own = segment(("X_Value", "a", "X_Value", "b"), kind, Unit=cells)
    if expected is None:
        with pytest.raises(InputError, match="two different cells"):
            lvm._cells(FILE, own, "Unit", [(1, 0), (3, 2)])
    else:
        assert lvm._cells(FILE, own, "Unit", [(1, 0), (3, 2)]) == expected


def test_a_number_that_stands_alone_is_that_of_all_channels():
    columns = [(1, 0), (2, 0)]
    assert lvm._values(FILE, segment(X0="0,5"), "X0", columns) == [0.5, 0.5]
    assert lvm._values(FILE, segment(X0=";3"), "X0", columns) == [3.0, 3.0]
    assert lvm._values(FILE, segment(X0="3;4"), "X0", columns) == [3.0, 4.0]
    np.testing.assert_equal(lvm._values(FILE, segment(X0="3;x"), "X0", columns), [3.0, math.nan])
    np.testing.assert_equal(lvm._values(FILE, segment(), "X0", columns), [math.nan, math.nan])


def test_names_and_units_come_from_head_and_columns():
    own = segment(("X_Value", "bar [kN]", "", "bar (g)", "[V]"), Y_Unit_Label="N;;")
    layout = lvm._layout(FILE, own, Options(channels=("bar (2)",)))
    assert [(one.name, one.unit) for one in layout.blank] == [("bar", "N"), ("bar (2)", "g"), ("channel 3", "V")]
    assert layout.wanted == [False, True, False]
    assert layout.columns == [(1, 0), (3, 0), (4, 0)]


def test_a_head_begins_below_the_last_blank_line_before_its_channels():
    def head(before, notes="Notes\tx\n"):
        content = before + (notes + "Channels\t2\nX0\t0\n***End").encode()
        found = lvm._head_of(content, 0, content.index(b"***End"))
        return content[found:].decode().partition("\n")[0]

    assert head(b"1\t2\n\n") == "Notes\tx"
    assert head(b"1\t2\n \t;,\r\n") == "Notes\tx"
    assert head(b"1\t2\n") == "Channels\t2"  # no blank line: what is above are samples
    assert head(b"1\n\n", "Notes\n" * 48) == "Notes"
    assert head(b"1\n\n", "Notes\n" * 49) == "Notes"
    assert head(b"1\n\n", "Notes\n" * 50) == "Channels\t2"
    assert lvm._head_of(b"1\n2\n***End", 0, 4) == 0  # no line of channels
    assert lvm._head_of(b"abc\nChannels\t2\n***End", 2, 15) == 4


def test_blocks_of_other_programs_and_blank_lines_are_passed_over():
    block = b"***Start_Special***\nlimits\t1\n***End_Special*** x\n"
    for before in (b"", b"\n", b"\t\t;,\n", block, block + b" \n" + block):
        assert lvm._after_special(b"9" + before + b"X_Value\ta\n", 1) == 1 + len(before)
    assert lvm._after_special(b"***Start_Special***\nlimits", 0) == 0  # without an end
    assert lvm._after_special(b"\n" * 49 + b"a\n", 0) == 49
    assert lvm._after_special(b"\n" * 60 + b"a\n", 0) == 50
    assert lvm._after_special(b"\n\n", 0) == 2
    assert (lvm._after(b"ab\ncd", 0), lvm._after(b"ab\ncd", 3)) == (3, 5)


@pytest.mark.parametrize("size", [1, 3, 7, 100])
def test_lines_are_counted_in_blocks(monkeypatch, size):
    monkeypatch.setattr(lvm, "_BLOCK", size)
    content = b"a\nbb\n\nccc\nd"
    assert lvm._lines(content, 0, len(content)) == 4
    assert lvm._lines(content, 2, 6) == 2
    assert lvm._lines(content, 2, 5) == 1


FILE_HEAD = b"LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\n"
SEGMENT = b"Channels\t1\nX0\t%d\nDelta_X\t2\n***End_of_Header***\nX_Value\ta\n\t%d\n\t%d\n"


def test_segments_have_their_place_line_and_session():
    first, second = SEGMENT % (0, 5, 6), SEGMENT % (4, 7, 8)
    content = FILE_HEAD + first + second + FILE_HEAD.replace(b"No", b"One") + SEGMENT % (0, 1, 2)
    found = lvm._segments(FILE, content, "utf-8")
    assert [content[one.start : one.end].split() for one in found] == [[b"5", b"6"], [b"7", b"8"], [b"1", b"2"]]
    assert [one.line for one in found] == [11, 18, 30]
    assert [(one.part, one.kind, one.columns, one.keys["X0"]) for one in found] == [
        (0, "no", ["X_Value", "a"], ["0"]), (0, "no", ["X_Value", "a"], ["4"]), (1, "one", ["X_Value", "a"], ["0"]),
    ]  # fmt: skip


def test_more_segments_than_the_most_are_refused(monkeypatch):
    many = FILE_HEAD + SEGMENT % (0, 5, 6) * 10_000
    assert len(lvm._segments(FILE, many, "utf-8")) == 10_000
    with pytest.raises(InputError, match="at most 10000 segments"):
        lvm._segments(FILE, many + SEGMENT % (0, 5, 6), "utf-8")
    monkeypatch.setattr(lvm, "_MOST_SEGMENTS", 3)
    assert len(lvm._segments(FILE, FILE_HEAD + SEGMENT % (0, 5, 6) + SEGMENT % (4, 7, 8) * 2, "utf-8")) == 3
    with pytest.raises(InputError, match="at most 3 segments"):
        lvm._segments(FILE, FILE_HEAD + SEGMENT % (0, 5, 6) + SEGMENT % (4, 7, 8) * 3, "utf-8")


@pytest.mark.parametrize(
    "content",
    [
        FILE_HEAD,
        FILE_HEAD + b"Channels\t1\n***End_of_Header***\n***",
        FILE_HEAD.replace(b"No", b"No" * 99) + SEGMENT % (0, 1, 2),
    ],
)
def test_heads_that_are_not_whole_are_refused(monkeypatch, content):
    monkeypatch.setattr(lvm, "_LARGEST_HEADER", 150)
    assert len(lvm._segments(FILE, FILE_HEAD + SEGMENT % (0, 1, 2), "utf-8")) == 1
    with pytest.raises(InputError, match="that is whole"):
        lvm._segments(FILE, content, "utf-8")
    long_line = FILE_HEAD.replace(b"Separator", b"Remark\t" + b"x" * 140 + b"\nSeparator")
    for one in (FILE_HEAD + (SEGMENT % (0, 1, 2)).replace(b"X0", b"X" * 140), long_line + SEGMENT % (0, 1, 2)):
        with pytest.raises(InputError, match="a header has no end"):
            lvm._segments(FILE, one, "utf-8")


# Samples


def test_what_the_head_counts_is_compared_with_the_file():
    own, without = segment(), segment(kind="no")
    options = Options()
    assert lvm._counted(FILE, own, [(20, 20), (20, math.nan), (20, 0.0), (20, 1e15)], options) == ([], 0)
    found, every = lvm._counted(FILE, own, [(20, 20), (20, 30)], options)
    assert ([(one.severity, one.value) for one in found], every) == ([("suspect", 20.0)], 0)
    found, every = lvm._counted(FILE, own, [(40, 20)], options)
    assert ([(one.severity, one.value) for one in found], every) == ([("good", 40.0)], 0)
    assert lvm._counted(FILE, without, [(40, 20), (40, 20)], options) == ([], 20)
    assert lvm._counted(FILE, without, [(32, 16)], options) == ([], 16)
    assert lvm._counted(FILE, without, [(40, 20)], Options(rate=5.0))[0][0].severity == "good"
    for sizes in ([(30, 15)], [(41, 20)], [(40, 20), (60, 20)]):
        with pytest.raises(InputError, match="whole measurements of as many"):
            lvm._counted(FILE, without, sizes, options)


def test_a_channel_ends_where_its_count_ends_and_nothing_follows():
    nan = math.nan
    values = np.array([1.0, 2.0, nan, nan])
    assert lvm._trimmed(values, 2.0).tolist() == [1.0, 2.0]
    for count in (1.0, 4.0, 5.0, 0.0, nan):
        assert lvm._trimmed(values, count) is values


def test_the_step_of_the_head_holds_where_stamps_agree_within_their_digits():
    stamps = 10.0 + np.array([0.0, 0.31, 0.62, 0.93])
    assert lvm._agreed(0.3, 0.31, stamps, 0.016) == 0.3  # 0.03 off, within two digits of 0.016
    assert lvm._agreed(0.3, 0.31, stamps, 0.014) == 0.31
    exact = np.arange(5.0)
    assert lvm._agreed(1.0, 2.0, exact, 0.0) == 1.0
    assert lvm._agreed(1.0 + 1e-9, 2.0, exact, 0.0) == 1.0 + 1e-9  # a share of 1e-9 a sample: 4e-9 of 5e-9
    assert lvm._agreed(1.0 + 1.5e-9, 2.0, exact, 0.0) == 2.0
    for last, step in ((1000.0 + 1.7e-12, 1e-12), (1000.0 + 4e-12, 3.0)):  # eight units in the last place: 1.8e-12
        assert lvm._agreed(1e-12, 3.0, np.array([1000.0, last]), 0.0) == step
        assert lvm._agreed(-1e-12, 3.0, np.array([last, 1000.0]), 0.0) == (-1e-12 if step < 1.0 else 3.0)


def run(start, count=3, step=0.5, origin=None, every=0, stamps=None):
    return lvm.Read([np.arange(float(count))], [stamps], [step], [start], [origin], [], every)


@pytest.mark.parametrize(
    ("after", "shift"),
    [
        (run(2.5), 0.0), (run(2.74), 0.0), (run(2.751), None), (run(2.26), 0.0), (run(2.24), None),
        (run(2.5, step=0.5049), 0.0), (run(2.5, step=0.5051), None), (run(2.5, step=0.4949), None),
        (run(2.5, every=5), None), (run(9.0, count=0), 0.0), (run(1.0, origin=3 * PICO // 2), None),
    ],
)  # fmt: skip
def test_a_segment_goes_on_within_half_a_step(after, shift):
    """The one before it has three samples from 1 s, 0.5 s apart: its next one is due at 2.5 s."""
    assert lvm._shift(run(1.0), after, [True], Options()) == shift
    assert lvm._shift(run(1.0), after, [False], Options()) == (None if after.every else 0.0)
    assert lvm._shift(run(1.0, every=4), after, [True], Options()) is None
    assert lvm._shift(run(1.0), after, [True], Options(rate=3.0)) == (None if after.every else 0.0)


def of_two(starts, origins=(None, None), sizes=(3, 2), steps=(0.5, 0.25)):
    return lvm.Read([np.zeros(n) for n in sizes], [None, None], list(steps), list(starts), list(origins), [])


@pytest.mark.parametrize(
    ("before", "after", "shift"),
    [
        (of_two((1.0, 7.0)), of_two((2.5, 7.5)), 0.0), (of_two((1.0, 7.0)), of_two((2.5, 7.7)), None), (of_two((1.0, 7.0)), of_two((2.8, 7.5)), None),
        (of_two((1.0, 7.0)), of_two((2.5, 7.5), steps=(0.5, 0.26)), None), (of_two((1.0, 7.0)), of_two((2.5, 99.0), sizes=(3, 0)), 0.0),
        (of_two((1.0, 7.0), sizes=(3, 0)), of_two((2.5, 99.0)), 0.0), (of_two((1.0, 7.0)), of_two((99.0, 7.5), sizes=(0, 2)), 0.0),
        (of_two((1.0, 7.0), (PICO, PICO)), of_two((0.5, 5.5), (3 * PICO, 9 * PICO)), 2.0),
        (of_two((1.0, 7.0), (PICO, PICO)), of_two((0.5, 5.5), (9 * PICO, 3 * PICO)), None),  # the clock of the first counts
        (of_two((1.0, 7.0), (PICO, None)), of_two((0.5, 5.5), (3 * PICO, PICO)), None),
        (of_two((1.0, 7.0), (PICO, PICO)), of_two((0.5, 5.5), (3 * PICO, None)), None),
    ],
)  # fmt: skip
def test_all_channels_of_a_segment_go_on_together(before, after, shift):
    """Three samples from 1 s and two from 7 s: the next ones are due at 2.5 s and at 7.5 s."""
    assert lvm._shift(before, after, [True, True], Options()) == shift


def test_a_segment_that_begins_at_zero_goes_on_by_its_clock_time():
    before = run(1.0, origin=7 * PICO)
    assert lvm._shift(before, run(1.0, origin=8 * PICO + PICO // 2), [True], Options()) == 1.5
    assert lvm._shift(before, run(1.0, origin=9 * PICO), [True], Options()) is None
    moved = lvm._shifted(run(1.0, stamps=np.array([1.0, 1.5, 2.0])), 1.5)
    assert (moved.starts, moved.stamps[0].tolist()) == ([2.5], [2.5, 3.0, 3.5])


def test_segments_become_one_channel():
    stamps = np.array([1.0, 1.5, 2.0])
    runs = [run(1.0, stamps=stamps), run(2.5, stamps=stamps + 1.5)]
    blank = Channel("bar", np.empty(0), unit="g")
    found = lvm._channel(runs, 0, blank, True, Options())
    assert (found.values.tolist(), found.step, found.start, found.unit) == ([0, 1, 2, 0, 1, 2], 0.5, 1.0, "g")
    assert found.stamps.tolist() == [1.0, 1.5, 2.0, 2.5, 3.0, 3.5]
    assert lvm._channel(runs, 0, blank, False, Options()).stamps is None
    assert lvm._channel([runs[0], run(2.5)], 0, blank, True, Options()).stamps is None
    rated = lvm._channel(runs, 0, blank, True, Options(rate=4.0))
    assert (rated.step, rated.start, rated.stamps) == (0.25, 0.0, None)


def look(tmp_path, content, last=1, unended=True, start=0):
    path = tmp_path / "lines"
    path.write_bytes(content)
    return lvm._look(Region(path, "utf-8", start, len(content)), TABS, last, unended)


def test_a_last_line_without_the_wanted_columns_is_cut(tmp_path):
    assert look(tmp_path, b"0\t1\n1\t2\n2")[0]
    assert look(tmp_path, b"0\t1\n1\t2\n2\t-")[0]
    assert not look(tmp_path, b"0\t1\n1\t2\n2\t3")[0]
    assert not look(tmp_path, b"0\t1\n1\t2\n2", 0)[0]
    assert not look(tmp_path, b"0\t1\n1\t2\n2", unended=False)[0]
    assert not look(tmp_path, b"2")[0]


def test_digits_are_those_of_the_coarser_end(tmp_path, monkeypatch):
    """Of 24 bytes at either end, the last line of the beginning, and the first and the last of the end, may be cut."""
    monkeypatch.setattr(lvm, "_EDGE", 24)
    lines = b"9.999\t9\n" + b"0.25\t1.25\n" * 3 + b"10\t1.5\n" * 6 + b"9\t.125"
    assert look(tmp_path, lines, start=8)[1] == {0: 1.0, 1: 0.1}
    assert look(tmp_path, lines[:37] + b"5\t6\n", start=8)[1] == {0: 0.01, 1: 0.01}
    for judged, columns in ((1, {0}), (2, {0, 1})):
        monkeypatch.setattr(lvm, "_MOST_JUDGED", judged)
        assert set(look(tmp_path, lines, start=8)[1]) == columns


# Whole files


def lvm_file(tmp_path, *segments, kind="No"):
    """A file of segments, each its head by key and its lines."""
    text = f"LabVIEW Measurement\nSeparator\tTab\nX_Columns\t{kind}\n***End_of_Header***\n\n"
    for keys, names, rows in segments:
        text += "".join("\t".join([key, *cells]) + "\n" for key, cells in keys.items()) + "***End_of_Header***\n"
        text += "\t".join([*names, "Comment"]) + "\n" + "".join("\t".join(row) + "\n" for row in rows)
    (tmp_path / "blow.lvm").write_text(text)
    return tmp_path / "blow.lvm"


NAMES = ("X_Value", "bar", "top")


def two(
    x0=("1", "7"),
    delta=("0.5", "0.25"),
    samples=("3", "2"),
    rows=(("", "1", "-4"), ("", "2", "-5"), ("", "3", "")),
    **more,
):
    keys = {"Channels": ["2"], "Samples": samples, "Y_Unit_Label": ["g", "N"], "X0": x0, "Delta_X": delta}
    return {**keys, **more}, NAMES, rows


def described(record):
    return [(c.name, c.unit, c.values.tolist(), c.step, c.start) for c in record.channels]


def test_each_channel_has_the_grid_count_and_unit_of_its_own_cells(tmp_path):
    record = lvm.read_lvm(lvm_file(tmp_path, two()), Options())
    assert described(record) == [("bar", "g", [1.0, 2.0, 3.0], 0.5, 1.0), ("top", "N", [-4.0, -5.0], 0.25, 7.0)]
    assert record.findings == ()
    only = lvm.read_lvm(lvm_file(tmp_path, two()), Options(channels=("top",)))
    assert [(c.values.strides == (0,), c.values.size, c.step, c.start) for c in only.channels] == [
        (True, 2, 0.5, 1.0),
        (False, 2, 0.25, 7.0),
    ]
    bare = lvm.read_lvm(lvm_file(tmp_path, two(x0=(), delta=("0", "0"), samples=())), Options())
    np.testing.assert_equal([(c.step, c.start, c.values.size) for c in bare.channels], [(math.nan, 0.0, 3)] * 2)


def test_columns_of_time_give_the_grid_of_the_channels_behind_them(tmp_path):
    rows = (("1.0", "1", "-4"), ("1.5", "2", "-5"), ("2.0", "3", "-6"))
    same = lvm.read_lvm(
        lvm_file(tmp_path, two(x0=("0", "0"), delta=("9", "9"), samples=("3", "3"), rows=rows), kind="One"), Options()
    )
    assert described(same) == [("bar", "g", [1.0, 2.0, 3.0], 0.5, 1.0), ("top", "N", [-4.0, -5.0, -6.0], 0.5, 1.0)]
    other = lvm.read_lvm(
        lvm_file(tmp_path, two(x0=("1", "7"), delta=("0.5", "0.25"), samples=("3", "3"), rows=rows), kind="One"),
        Options(),
    )
    assert [(c.step, c.start, c.stamps is None) for c in other.channels] == [(0.5, 1.0, False), (0.25, 7.0, True)]


def test_segments_of_a_line_are_left_out(tmp_path):
    short = two(rows=(("", "1", "-4"),), samples=("1", "1"))
    record = lvm.read_lvm(lvm_file(tmp_path, short, two(x0=("90", "90")), two(x0=("200", "200"))), Options())
    assert [c.start for c in record.channels] == [90.0, 90.0]
    assert [one.channels[0].start for one in record.further] == [200.0]
    assert [(f.code, f.value) for f in record.findings] == [("segments", 1.0)]
    assert record.findings[0].message.startswith("1 of 3 measurements have fewer than two lines")
    with pytest.raises(InputError, match="at least two lines"):
        lvm.read_lvm(lvm_file(tmp_path, short), Options())


@pytest.mark.parametrize(
    ("second", "joined"),
    [
        ({"x0": ("2.5", "2.5")}, True), ({"x0": ("2.5", "7")}, False), ({"x0": ("2.5", "2.5"), "Y_Unit_Label": ["g", "V"]}, False),
        ({"x0": ("2.5", "2.5"), "delta": ("0.5", "0.6")}, False), ({"x0": ("1", "1")}, False),
    ],
)  # fmt: skip
def test_segments_are_joined_where_clock_and_units_of_all_channels_go_on(tmp_path, second, joined):
    how = {"samples": ("3", "3"), "delta": ("0.5", "0.5"), "rows": (("", "1", "-4"), ("", "2", "-5"), ("", "3", "-6"))}
    record = lvm.read_lvm(lvm_file(tmp_path, two(x0=("1", "1"), **how), two(**{**how, **second})), Options())
    assert len(record.further) == (0 if joined else 1)
    if joined:
        assert record.channels[1].values.tolist() == [-4.0, -5.0, -6.0] * 2


@pytest.mark.parametrize("options", [Options(time="top"), Options(time="2"), Options(time_unit=1e-3)])
def test_options_that_a_head_leaves_no_room_for_are_refused(tmp_path, options):
    file = lvm_file(tmp_path, two())
    with pytest.raises(InputError, match="--time"):
        lvm.read_lvm(file, options)
    assert (
        lvm.read_lvm(file, Options(time=" x_VALUE ")).channels[0].step
        == lvm.read_lvm(file, Options(time="1")).channels[0].step
        == 0.5
    )


def test_writes_that_are_not_counted_are_parted_in_all_channels(tmp_path):
    rows = tuple(("", f"{k}", f"{-k}") for k in range(48))
    record = lvm.read_lvm(lvm_file(tmp_path, two(samples=("16", "16"), rows=rows)), Options())
    assert [[c.values[0] for c in one.channels] for one in (record, *record.further)] == [
        [0.0, 0.0],
        [16.0, -16.0],
        [32.0, -32.0],
    ]
    assert [[c.start for c in one.channels] for one in (record, *record.further)] == [[1.0, 7.0]] * 3
    assert lvm.sniff_lvm(b"\xef\xbb\xbf\r\nLabVIEW Measurement\t")
    assert not lvm.sniff_lvm(b"x LabVIEW Measurement")
