"""Columns of text, part by part: encodings, cells, numbers, marks and the parser, each at both sides of its limits."""

import codecs
import math

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import columns
from strikewave.records.readers.columns import (
    CellLayout,
    Marks,
    Region,
    blocks,
    cells_of,
    decode,
    encoding_of,
    find_marks,
    is_comment,
    lines_of,
    number,
    parse,
)

SEMICOLONS = Marks(";")


@pytest.mark.parametrize(
    ("head", "encoding"),
    [
        (codecs.BOM_UTF16_LE + "1;2".encode("utf-16-le"), "utf-16-le"),
        (codecs.BOM_UTF16_BE + "1;2".encode("utf-16-be"), "utf-16-be"),
        (codecs.BOM_UTF16_LE + "1\x01".encode("utf-16-le"), None),
        (b"\t\n\r\x0c\x1a1", "utf-8"),  # what texts of old systems hold
        *[(bytes([code]), None) for code in (0, 8, 11, 14, 25, 27, 31, 127)],
        ("µ".encode()[:1], "utf-8"),  # cut within a letter
        (b"\xb5V", "cp1252"),
    ],
)
def test_an_encoding_is_told_by_marks_and_control_characters(head, encoding):
    assert encoding_of(head) == encoding


def test_what_cannot_be_decoded_becomes_a_replacement():
    assert (decode(b"a\xb5b", "utf-8"), decode(b"a\xb5b", "cp1252")) == ("a\ufffdb", "aµb")
    assert lines_of("a\r\nb\rc\nd") == ["a", "b", "c", "d"]


@pytest.mark.parametrize(
    ("line", "marks", "cells"),
    [
        (" 1 ; 2;", SEMICOLONS, ["1", "2", ""]),
        ('"1;2"; 3', SEMICOLONS, ["1;2", "3"]),
        ('"1" 2\t3 ', Marks(""), ["1", "2", "3"]),
        ("  ", Marks(""), [""]),
        ('1;"2', SEMICOLONS, ["1", "2"]),
        ("\ufeff1;2\x1a\r\n", SEMICOLONS, ["1", "2"]),
    ],
)
def test_lines_are_cut_into_cells(line, marks, cells):
    assert cells_of(line, marks) == cells


@pytest.mark.parametrize(
    ("cell", "decimal", "value"),
    [
        ("1.5e-3", ".", 1.5e-3), ("-1,5", ",", -1.5), ("1.5", ",", None), ("1,", ",", None), ("1.", ".", 1.0),
        ("1,2,3", ",", None), ("1_0", ".", None), ("٣", ".", None), ("inf", ".", None), ("x", ".", None),
    ],
)  # fmt: skip
def test_a_cell_is_a_finite_number_or_none(cell, decimal, value):
    assert number(cell, decimal) == value


@pytest.mark.parametrize("word", ["", "NaN", "+nan", "-NAN", "n/a", "NA", "Null"])
def test_words_for_none_are_no_number(word):
    assert math.isnan(number(word))


def test_comments_begin_with_one_of_three_marks():
    assert [is_comment(line) for line in (" # a", "\ufeff% a", "// a", "/ a", "a # b")] == [True] * 3 + [False] * 2


@pytest.mark.parametrize(
    ("lines", "marks"),
    [
        (["1.5,2", "2.5,3"], Marks(",")), (["1,5\t2,25", "1,6\t2,5"], Marks("\t", ",")), (["1 2", "3 4"], Marks("")),
        (["1,5 2,5", "1,6 3,5"], Marks("", ",")), (['"0,5","1,5"', '"0,6","1,7"', "3,4"], Marks(",", ",")),
        (["0,05", "0,06"], Marks("\t", ",")), (["-0,5", "1,7"], Marks("\t", ",")),
        (["1,2", "3,4"], Marks(",")), (["01,05", "2,06"], Marks(",")), (["1,2,3,4", "5,6,7,8"], Marks(",")),
        (["0,05,3", "0,06,4"], Marks(",")),
        (["a b", "c 1", "2;3;4 5", "6 x"], Marks("")),  # no line is whole: most numbers count
    ],
)  # fmt: skip
def test_marks_are_those_under_which_most_lines_are_numbers(lines, marks, tmp_path):
    assert find_marks(lines, tmp_path) == marks


@pytest.mark.parametrize("lines", [["1,05,2,5", "2,06,3,5"], ["-0,5,2,5", "1,5,3,5"]])
def test_commas_between_numbers_and_within_them_are_refused(lines, tmp_path):
    with pytest.raises(InputError, match="commas stand both"):
        find_marks(lines, tmp_path)


def test_one_line_of_decimals_with_a_zero_ahead_makes_no_decimals(tmp_path):
    assert find_marks(["1,05,2,5", "02,06,3,5"], tmp_path) == Marks(",")
    assert find_marks(["1,05,2,5", "2,06,3"], tmp_path) == Marks(",")  # an odd row


@pytest.mark.parametrize(
    ("rows", "width", "expected"),
    [
        ([["1", "05", "02", "5"]], 0, False), ([["1", "5", "2", "05"]], 0, True), ([["1", "05", "x", "5"]], 0, False),
        ([["1", "15", "2", "5"]], 0, False), ([["a", "b"], ["1", "05"]], 2, True), ([["a", "5"], ["1", "05"]], 2, True),
        ([["+10", "05"]], 2, True), ([["1", "05"]], 0, False), ([], 0, False),
    ],
)  # fmt: skip
def test_every_second_cell_reads_like_decimals(rows, width, expected):
    assert columns._decimals_behind_commas(rows, width) is expected


def test_nearly_all_lines_of_a_sample_suffice_and_fewer_do_not():
    """Four in five lines of numbers settle the marks; else all marks are tried on all lines."""
    orders = [SEMICOLONS, Marks(",")]
    most = ["1;2"] * 8 + ["word"] * 2
    assert columns._plain(orders, most) == SEMICOLONS
    assert columns._plain(orders, [*most[1:], "word"]) is None
    assert columns._plain(orders, ["1;2"]) is None  # one line tells nothing
    assert columns._plain([*orders, Marks("\t")], ["1"] * 10) is None  # all of them fit
    assert columns._plain(orders, (["1;2"] + ["word"] * 9) * 40) == SEMICOLONS  # every tenth line of 400 is looked at


def test_whole_lines_count_before_their_numbers_and_numbers_before_none():
    assert columns._fit(["1;2;3", "4;x", "5", ";"], SEMICOLONS) == (2, 4, 0)
    assert columns._fit(["1;2;x", "4;x", ";"], SEMICOLONS) == (0, 0, 3)


def region(tmp_path, content, **how):
    path = tmp_path / "lines.txt"
    path.write_bytes(content)
    return Region(path, **{"encoding": "utf-8", **how})


@pytest.mark.parametrize("size", [3, 7, 50, 1000])
def test_blocks_are_whole_lines_however_small_they_are(tmp_path, monkeypatch, size):
    monkeypatch.setattr(columns, "BLOCK", size)
    lines = [f"{k};{k * k}\n".encode() for k in range(30)]
    found = list(blocks(region(tmp_path, b"".join(lines), skip=3)))
    assert b"".join(found) == b"".join(lines[3:])
    assert all(block.endswith(b"\n") for block in found)
    begin, end = len(b"".join(lines[:5])), len(b"".join(lines[:9]))
    assert b"".join(blocks(region(tmp_path, b"".join(lines), start=begin, end=end))) == b"".join(lines[5:9])
    assert b"".join(blocks(region(tmp_path, b"".join(lines) + b"30;9", cut=True))) == b"".join(lines)
    assert list(blocks(region(tmp_path, b"".join(lines) + b"30;9", skip=31))) == []


def test_marks_of_byte_order_quotes_and_lone_returns_are_taken_off(tmp_path):
    assert b"".join(blocks(region(tmp_path, b'\xef\xbb\xbf"1;2"\r"3;4"\r', quoted=True, lone_returns=True))) == (
        b"1;2\n3;4\n"
    )
    assert b"".join(blocks(region(tmp_path, b"1\n\xef\xbb\xbf2\n", start=2))) == b"\xef\xbb\xbf2\n"
    wide = codecs.BOM_UTF16_LE + "1;µ\n".encode("utf-16-le")
    assert b"".join(blocks(region(tmp_path, wide, encoding="utf-16-le"))) == "1;µ\n".encode()


def test_a_line_longer_than_the_limit_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(columns, "LONGEST_LINE", 20)
    assert list(blocks(region(tmp_path, b"1" * 20))) == [b"1" * 20]
    with pytest.raises(InputError, match="at most 20 bytes"):
        list(blocks(region(tmp_path, b"1" * 21)))
    layout = CellLayout(SEMICOLONS, 1, (0,))
    assert parse(region(tmp_path, b"x\n" + b"1" * 20 + b"\n"), layout, 1).columns[0][1] == float("1" * 20)
    with pytest.raises(InputError, match="line 2 is longer"):
        parse(region(tmp_path, b"x\n" + b"1" * 21 + b"\n"), layout, 1)


@pytest.mark.parametrize("delimiter", [";", ""])
@pytest.mark.parametrize("small", [1, 10**6])
def test_wanted_columns_come_back_with_words_counted(tmp_path, monkeypatch, delimiter, small):
    """Of 60 lines two have words: in whole, halved or read one by one, the others keep their place."""
    monkeypatch.setattr(columns, "_SMALL", small)
    monkeypatch.setattr(columns, "BLOCK", 400 if small == 1 else 10**6)
    rows = [[str(k), str(k * 10), str(k * 100)] for k in range(60)]
    rows[41][2], rows[55][0] = "over", "err"
    content = "".join((delimiter or "  ").join(row) + "\n" for row in rows).encode()
    table = parse(region(tmp_path, content, skip=5, line=4), CellLayout(Marks(delimiter), 3, (0, 2)), 7)
    first, last = np.arange(5.0, 60.0), 100.0 * np.arange(5.0, 60.0)
    last[36], first[50] = math.nan, math.nan
    np.testing.assert_array_equal(table.columns, [first, last])
    assert (table.words, table.first_word) == (2, 4 + 41)


def test_missing_cells_and_short_lines_are_missing_values(tmp_path):
    layout = CellLayout(SEMICOLONS, 3, (0, 1, 2))
    table = parse(region(tmp_path, b"1;2;3\n4;nan;5\n6;7\n\n# a\n8;;9\n"), layout, 10)
    nan = math.nan
    np.testing.assert_array_equal(table.columns, [[1, 4, 6, 8], [2, nan, 7, nan], [3, 5, nan, 9]])
    assert table.words == 0


def test_numbers_beyond_all_numbers_are_words(tmp_path):
    table = parse(region(tmp_path, b"1\n1e999\n3\n"), CellLayout(SEMICOLONS, 1, (0,)), 3)
    np.testing.assert_array_equal(table.columns[0], [1.0, math.nan, 3.0])
    assert (table.words, table.first_word) == (1, 2)


def test_more_cells_than_columns_are_refused_behind_the_lines_of_settings(tmp_path):
    content = b"1;2;dt;9\n3;4;t0\n5;6;\n"
    layout = CellLayout(SEMICOLONS, 2, (0, 1), beside=2)
    np.testing.assert_array_equal(parse(region(tmp_path, content), layout, 3).columns, [[1, 3, 5], [2, 4, 6]])
    with pytest.raises(InputError, match="line 2 has 3"):
        parse(region(tmp_path, content), layout._replace(beside=1), 3)


def test_a_header_that_comes_again_is_refused(tmp_path):
    layout = CellLayout(SEMICOLONS, 2, (0, 1), header=("t", "a"))
    with pytest.raises(InputError, match="again in line 12"):
        parse(region(tmp_path, b"1;2\nt;a\n3;4\n", line=11), layout, 3)
    assert parse(region(tmp_path, b"1;2\nt;b\n3;4\n", line=11), layout, 3).words == 2


@pytest.mark.parametrize("spoiled", [b"", b"9;x;y\n"])
def test_coded_columns_hold_the_places_of_their_words(tmp_path, monkeypatch, spoiled):
    """Read at once or line by line; words beyond the most that are told apart have no place."""
    monkeypatch.setattr(columns, "MOST_WORDS", 3)
    content = b"1;bar;2\n3; frame ;4\n5;bar;6\n7;;8\n9;top;1\n9;more;1\n" + spoiled
    table = parse(region(tmp_path, content), CellLayout(SEMICOLONS, 3, (0, 1, 2), coded=(1,)), 3)
    np.testing.assert_array_equal(table.columns[1][:6], [0, 1, 0, math.nan, 2, math.nan])
    assert table.labels == {1: ["bar", "frame", "top"]}
    assert table.words == (spoiled != b"")


def test_columns_grow_and_are_as_long_as_they_are_filled(tmp_path, monkeypatch):
    store = columns._Store(tmp_path, 2, 3)
    for k in range(5):
        store.add([np.full(2, float(k)), np.full(2, -float(k))])
    np.testing.assert_array_equal(store.columns(), [np.repeat(np.arange(5.0), 2), -np.repeat(np.arange(5.0), 2)])
    monkeypatch.setattr(columns, "LARGEST_ARRAY", 8 * 2 * 10)
    tight = columns._Store(tmp_path, 2, 4)
    tight.add([np.zeros(10), np.zeros(10)])  # as many as fit
    with pytest.raises(InputError, match="read fewer channels"):
        tight.add([np.zeros(1), np.zeros(1)])


def test_columns_much_too_large_are_given_back(tmp_path):
    """A guess of twice the lines and more costs its memory no longer."""
    for used, loose in ((49, True), (50, False)):
        store = columns._Store(tmp_path, 1, 100)
        store.add([np.arange(float(used))])
        assert (store.columns()[0].base is None) == loose


def test_slices_of_arrow_columns_keep_their_missing_values():
    import pyarrow as pa

    whole = pa.chunked_array([pa.array([9.0, 1.0, None, 3.0, 4.0, None]).slice(1), pa.array([5.0])])
    np.testing.assert_array_equal(columns._floats(whole), [1.0, math.nan, 3.0, 4.0, math.nan, 5.0])
    assert columns._floats(pa.chunked_array([], pa.float64())).size == 0
