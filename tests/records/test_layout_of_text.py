"""Where the numbers of a text file are, part by part: each rule at both sides of its limit."""

import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import text
from strikewave.records.readers.columns import Marks
from strikewave.records.readers.text import is_cut, is_data, lay_out, look_at

COMMAS = Marks(",")


@pytest.fixture
def written(tmp_path):
    def write(content, encoding="utf-8"):
        path = tmp_path / "lines.txt"
        path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return path

    return write


@pytest.fixture
def laid(written):
    def lay(content):
        look = look_at(written(content))
        return look, lay_out(look)

    return lay


def messages(found):
    return [finding.message for finding in found.findings]


# What is looked at


def test_a_short_file_is_looked_at_as_a_whole(written, monkeypatch):
    monkeypatch.setattr(text, "_LINES", 4)
    monkeypatch.setattr(text, "_MIDDLE_LINES", 3)
    look = look_at(written("\ufeff" + "".join(f"{k}\n" for k in range(20))))
    assert look.head == [*map(str, range(20)), ""]
    assert look.middle == ["10", "11", "12"]
    assert (look.tail, look.ended) == (["17", "18", "19"], True)
    assert (look.size, look.encoding, look.lone_returns, look.quoted, look.begin, look.end, look.line) == (
        3 + 50, "utf-8", False, False, 0, None, 1,
    )  # fmt: skip


def test_of_a_large_file_the_beginning_the_middle_and_the_end_are_looked_at(written, monkeypatch):
    """Lines of 5 bytes: 100 lie within the first 500 bytes, 8 within parts of 40; those at an edge are left out."""
    monkeypatch.setattr(text, "HEAD", 500)
    monkeypatch.setattr(text, "_PART", 42)
    path = written("".join(f"{k:04d}\n" for k in range(1000)))
    look = look_at(path)
    assert look.head == [f"{k:04d}" for k in range(100)]
    assert look.middle == [f"{k:04d}" for k in range(501, 508)]
    assert look.tail == [f"{k:04d}" for k in range(992, 1000)]
    assert look.ended
    part = look_at(path, (1000, 3002, 201), "cp1252")  # its middle begins at byte 2000
    assert (part.size, part.encoding, part.begin, part.end, part.line) == (2002, "cp1252", 1000, 3002, 201)
    assert (part.head[0], part.head[-1]) == ("0200", "0299")
    assert (part.middle[0], part.tail[0], part.tail[-1], part.ended) == ("0401", "0593", "06", False)
    assert look_at(path, (1000, 1500, 201)).middle[0] == "0250"  # as large as the head


def test_lines_of_two_bytes_a_letter_are_cut_between_letters(written, monkeypatch):
    monkeypatch.setattr(text, "HEAD", 100)
    monkeypatch.setattr(text, "_PART", 41)
    look = look_at(written("".join(f"{k:03d}\n" for k in range(103)), "utf-16"))
    assert all(line.isascii() and len(line) == 3 for line in (*look.head, *look.middle, *look.tail))
    assert look.tail[-1] == "102"


@pytest.mark.parametrize(
    ("content", "lone"), [(b"1\r2\r", True), (b"1\r\n2\r\n", False), ("1\r2\r".encode("utf-16"), True), ("1\r\n".encode("utf-16"), False)]
)  # fmt: skip
def test_returns_that_stand_alone_are_told(written, content, lone):
    assert look_at(written(content)).lone_returns is lone


@pytest.mark.parametrize(
    ("end", "ended"), [("", False), ("\n", True), ("\n\x1a", True), ("\n \t", True), ("\n7", False)]
)
def test_a_last_line_has_an_end_or_none(written, end, ended):
    assert look_at(written("1\n2\n3" + end)).ended is ended


def test_lines_in_quotes_as_a_whole_are_taken_off_them():
    """Three lines at least, and all but five; not where they are single numbers with a decimal comma."""
    whole = ['"1,a;2"', ' "2,b;3" ', '"3,c;4"']
    assert text._are_quoted(whole)
    assert not text._are_quoted(whole[:2])
    assert text._are_quoted([*whole, *["x"] * 5, "", ""])
    assert not text._are_quoted([*whole, *["x"] * 6])
    assert not text._are_quoted(['"1,5"', '"2,5"', '"3,5"'])
    assert not text._are_quoted(['"a,b"', '"2,5"', '"3,5"'])  # a head above them
    assert text._are_quoted(['"2,5"', '"3,5"', '"a,b"'])
    assert not text._are_quoted(['"a b"', '"c d"', '"e f"'])
    assert text._are_quoted(['"a,"', '"b,"', '"c,"'])
    assert not text._are_quoted(['"1,a;2'] * 3)


# Columns


def test_columns_are_full_filled_or_left_out(tmp_path):
    """Of 200 lines a column needs more than two numbers, more numbers than words, and half of all to be full."""
    nan = float("nan")

    def of(numbers, words, lines=200):
        return [1.0] * numbers + [None] * words + [nan] * (lines - numbers - words)

    def sorted_out(*columns):
        filled, full, findings = text._columns_with_numbers(list(zip(*columns, strict=True)), tmp_path)
        return filled, full, [finding.message.partition("it ")[2] for finding in findings]

    whole = of(200, 0)
    assert sorted_out(whole, of(100, 0), of(99, 0)) == ([0, 1, 2], [0, 1], [])
    assert sorted_out(whole, of(51, 50), of(50, 50)) == ([0, 1], [0], ["holds words"])
    assert sorted_out(of(99, 0)) == ([0], [0], [])  # none is full: then those that are filled
    assert sorted_out(whole, of(16, 0), of(15, 0), of(0, 0)) == (
        [0, 1],
        [0],
        ["has a value in 15 of 200 lines looked at"],
    )
    assert sorted_out(of(2000, 0, 2000), of(20, 0, 2000), of(21, 0, 2000))[0] == [0, 2]
    assert sorted_out(of(31, 0, 31), of(15, 0, 31))[0] == [0, 1]  # of 31 lines fifteen are enough
    assert sorted_out(of(32, 0, 32), of(15, 0, 32))[0] == [0]
    assert sorted_out(of(3, 0, 3), of(1, 0, 3))[0] == [0]  # in the first line alone
    assert sorted_out(of(3, 0, 3), of(1, 0, 3)[::-1])[0] == [0, 1]
    assert sorted_out(of(2, 0, 2), of(1, 0, 2))[0] == [0, 1]
    with pytest.raises(InputError, match="in most lines"):
        sorted_out(of(0, 200))


def test_columns_of_words_and_settings_are_named(laid):
    _, found = laid("t,bar,note,kind,top\n" + "".join(f"{k},{k * k},ok,{'dt' if k == 3 else ''},\n" for k in range(40)))
    assert (found.filled, found.full, found.width, found.first) == ([0, 1], [0, 1], 5, 1)
    assert messages(found) == [
        "column 3 is left out: it holds words", "column 4 is left out: it holds words",
        "column 5, top, is left out: it holds no number",
    ]  # fmt: skip
    assert [finding.value for finding in found.findings] == [3.0, 4.0, 5.0]
    assert found.above == ["t,bar,note,kind,top"]


def test_settings_beside_numbers_are_named_where_no_column_is_theirs(laid):
    """Words of lines that hold numbers too, in a column that only they fill."""
    rows = [f"{k},{k * k}," for k in range(60)]
    rows[2] += "dt"
    _, found = laid("t,bar,\n" + "\n".join(rows) + "\n")
    assert messages(found) == ["column 3 is left out: it holds settings"]
    assert (found.filled, found.width) == ([0, 1], 3)
    assert text._labels(["1,2,x", "3,4,"], COMMAS, 3, [0, 1], []) != []
    assert text._labels(["1,2,x", "3,4,"], COMMAS, 2, [0, 1], []) == []
    assert text._labels(["1,a,x", "3,4,"], COMMAS, 3, [0, 1], []) == []  # no line of numbers
    assert text._labels(["1,2,nan", "3,4,"], COMMAS, 3, [0, 1], []) == []
    known = text._labels(["1,2,x"], COMMAS, 3, [0, 1], [])
    assert [(one.code, one.value) for one in known] == [("column-dropped", 3.0)]
    assert text._labels(["1,2,x"], COMMAS, 3, [0, 1], known) == []
    assert text._says("7", COMMAS)


@pytest.mark.parametrize(("lines", "beside"), [(1, 0), (2, 0), (40, 41), (41, 0)])
def test_settings_stand_beside_the_first_lines_of_the_data(laid, lines, beside):
    """Up to forty lines have more cells than columns; not the most, and not with others between."""
    rows = [
        f"{k},{k}" + (",set" if 0 < lines <= 2 or k < lines else "") for k in range(lines * 2 if lines < 3 else 200)
    ]
    assert laid("t,a\n" + "\n".join(rows) + "\n")[1].beside == beside


def test_settings_beside_the_data_are_counted_from_their_first_line(laid):
    rows = [f"{k},{k}" for k in range(9)]
    rows[0] += ",dt,5"
    rows[1] += ",t0,3"
    look, found = laid("t,a\n" + "\n".join(rows) + "\n")
    assert (found.first, found.beside, found.width) == (1, 3, 2)
    assert messages(found)[-1] == "settings stand behind the columns in lines 2 to 3: they are left out"
    assert found.findings[-1].value == 3.0
    rows[1], rows[2] = "1,1", "2,2,t0"
    assert laid("t,a\n" + "\n".join(rows) + "\n")[1].beside == 0  # not together
    assert text._settings_beside(look._replace(head=look.head[:5]), found.marks, 2, 1) == 0  # half of the lines
    assert text._settings_beside(look._replace(head=look.head[:6]), found.marks, 2, 1) == 3


def test_lines_of_words_are_left_out_where_one_in_five_is_of_numbers(laid):
    assert laid("1,2\n3,4\n" + "x,9,y\n" * 8)[1].width == 2  # two of ten
    assert laid("1,2\n" + "x,9,y\n" * 9)[1].width == 3


@pytest.mark.parametrize("least", [1, 8])
def test_long_lines_are_judged_by_fewer_of_them(laid, monkeypatch, least):
    """Lines are halved until they are short enough, but not below eight."""
    monkeypatch.setattr(text, "_MOST_JUDGED", 60)
    monkeypatch.setattr(text, "_FEWEST_JUDGED", least)
    _, found = laid("".join(f"{k:02d},{k if k == 4 else '':4},1\n" for k in range(32)))
    assert found.filled == ([0, 2] if least == 1 else [0, 1, 2])


# The first line


@pytest.mark.parametrize(
    ("content", "first"),
    [
        ("t,a,b\n0,1,2\n1,2,3\n2,3,4\n", 1),
        ("t,a,b\n0,over,2\n1,2,3\n2,3,4\n", 1),
        ("t,a,b\n0,word,2\n1,2,3\n2,3,4\n", 2),
        ("t,a,b\n,1,2\n1,2,3\n2,3,4\n", 2),
        ("t,a,b\n# 0,1,2\n1,2,3\n2,3,4\n", 2),
        ("0,1,2\n1,2,3\n2,3,4\n", 0),
        ("0,over,2\n1,2,3\n2,3,4\n", 0),
        ("t,a\n1,\n,2\n3,\n,4\n", 1),  # no line has a number in every column
    ],
)
def test_the_first_line_of_the_data_may_lack_numbers_like_those_over_the_range(laid, content, first):
    assert laid(content)[1].first == first


def test_a_line_may_be_nearly_one_of_data():
    assert text._nearly("1,over,3", COMMAS, 3, [0, 1, 2])
    assert text._nearly("1,---,***", COMMAS, 3, [0, 1, 2])
    assert text._nearly("1,,3", COMMAS, 3, [0, 1, 2])
    assert not text._nearly("over,1,3", COMMAS, 3, [0, 1, 2])
    assert not text._nearly(",1,3", COMMAS, 3, [0, 1, 2])
    assert not text._nearly("1,bar,3", COMMAS, 3, [0, 1, 2])
    assert not text._nearly("1,over", COMMAS, 3, [0, 1])
    assert not text._nearly("1,over", COMMAS, 2, [0])
    assert text._nearly("1,9" + "x" * 19 + " bar", COMMAS, 2, [0, 1])  # twenty letters are looked at
    assert not text._nearly("1,9" + "x" * 18 + " bar", COMMAS, 2, [0, 1])


def test_lines_of_data_have_a_number_in_every_full_column(laid):
    _, found = laid("t,a,b\n0,1,2\n1,2,3\n2,3,4\n")
    assert [is_data(line, found) for line in ("5,6,7", "5,6", "# 5,6,7", "5,ovld,7", "t,a,b", "5,6,nan", "nan,5,6")] == [
        True, False, False, True, False, True, False,
    ]  # fmt: skip


SETTINGS = "name,bar,top\ndelta t,2,3\nlength,40,40\n"
BODY = "".join(f",{k},{k * k}\n" for k in range(50))


def test_settings_with_a_number_for_each_channel_are_above_the_data(laid):
    _, found = laid(SETTINGS + BODY)
    assert (found.first, found.full) == (3, [1, 2])
    assert messages(found) == [
        "column 1 is left out: it holds settings", "settings above the data are no samples: delta t, length",
    ]  # fmt: skip
    assert found.findings[1].value == 2.0
    _, found = laid(SETTINGS.replace("2,3", "2,x") + BODY)
    assert messages(found)[-1].endswith("samples: length")


def test_settings_end_where_a_line_has_a_number_and_no_name(laid):
    assert laid(SETTINGS + "\n" + BODY)[1].first == 4
    assert laid(SETTINGS + ",0,over\n" + "foo,3,4\n" + BODY)[1].first == 4
    _, found = laid("name,bar,top\nt0,2,3\n" + BODY)
    assert (found.first, messages(found)[-1]) == (2, "settings above the data are no samples: t0")


def test_names_that_come_again_are_no_settings(laid):
    """Lines may begin with the name of their channel; what stands once above them is a setting."""
    body = "".join(f"{'bar' if k % 2 else 'top'},{k},{k * k}\n" for k in range(50))
    assert laid(SETTINGS + body)[1].first == 3
    assert laid("bar,1,1\ntop,2,5\n" + body)[1].first == 0


def test_a_date_before_the_numbers_is_one_of_data(laid):
    body = "".join(f"05/01/2026 10:{k:02d},{k},{k * k}\n" for k in range(50))
    assert laid(body)[1].first == 0
    assert laid(SETTINGS + body)[1].first == 3
    assert text._kind("a" * 59 + "7b") == "a0"  # sixty letters


@pytest.mark.parametrize(("count", "first"), [(39, 39), (40, 40), (41, 40)])
def test_settings_are_looked_for_in_forty_lines(laid, count, first):
    letters = [chr(97 + k % 26) * (1 + k // 26) for k in range(count)]
    assert laid("".join(f"{word},1,2\n" for word in letters) + BODY + BODY)[1].first == first


# The last line


@pytest.mark.parametrize(
    ("content", "cut"),
    [
        ("1,20\n2,30\n3,40\n4", True), ("1,20\n2,30\n3,40\n4,", True), ("1,20\n2,30\n3,40\n4\n", True),
        ("1,20\n2,30\n3,40\n4,\n", False), ("1,20\n2,\n3,40\n4,", False), ("1,20\n2,30\n3,40\n4,50", False),
        ("1,20\n2", False), ("1,20\n2,30\n3", True), ("1,20\n2,30\n3,40\n# 4", False),
        ("1,20\n2,30\n# 3,4\n4", True), ("1,20\n# 3,4\n2,30\n4", True), ("1,2,\n3,4\n3,4\n5,\n", False),
    ],
)  # fmt: skip
def test_a_last_line_without_all_columns_is_cut(laid, content, cut):
    assert is_cut(*laid(content)) is cut


def test_a_line_that_lacks_what_others_lacked_ten_lines_ago_is_cut(laid):
    rows = [f"{k},{k}" for k in range(30)]
    rows[19] = "19,"
    assert is_cut(*laid("\n".join([*rows, "30"])))
    rows[20] = "20,"
    assert not is_cut(*laid("\n".join([*rows, "30"])))


@pytest.mark.parametrize(
    ("above", "last", "cut"),
    [
        (["1.25"] * 8, "1.2", True), (["1.25"] * 7, "1.2", False), (["1.25"] * 8, "1.25", False),
        (["1.25", "1.250"] * 25, "1.2", True), (["1.25", "1.250"] * 24, "1.2", False),
        (["1.25", "1.250"] * 25, "1.25", False), (["1.5e-10"] * 8, "1.5e-1", True), (["12"] * 9, "1", False),
    ],
)  # fmt: skip
def test_a_last_number_with_fewer_digits_is_cut(laid, above, last, cut):
    """Eight numbers of as many digits above it, or fifty of any, make it known."""
    assert is_cut(*laid("".join(f"{k},{cell}\n" for k, cell in enumerate(above)) + f"{len(above)},{last}")) is cut


def test_a_number_that_a_mark_ends_is_whole(laid):
    assert not is_cut(*laid("".join(f"{k},1.25,\n" for k in range(9)) + "9,1.2,"))


def test_the_end_of_a_large_file_is_judged_by_its_own_lines(written, monkeypatch):
    monkeypatch.setattr(text, "HEAD", 100)
    look = look_at(written("".join(f"{k},1.25\n" for k in range(60)) + "60,1.2"))
    assert is_cut(look, lay_out(look))
    look = look_at(written("".join(f"{k},1.25\n" for k in range(60)) + "60,1.25"))
    assert not is_cut(look, lay_out(look))


def test_digits_are_decimals_and_those_of_the_power():
    assert [text._digits(cell) for cell in ("1.25", "-1,5e-10", "12", "word", "1.e5")] == [
        (2, 0), (1, 2), (0, 0), (0, 0), (0, 1),
    ]  # fmt: skip
