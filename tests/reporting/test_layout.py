"""Tables and sentences in lines of a width: what no line may break stays whole, whatever the words and numbers."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.declare import KEY, MORE
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import cut, keys, length, numerals, plain, table_lines, texts, tokens, wrapped

WORD = st.text("abcdefghijklmnopqrstuvwxyzµ-_./", min_size=1, max_size=14)
NUMBER = st.one_of(
    st.floats(-1e6, 1e6).map(lambda value: f"{value:.5g}"), st.integers(-9999, 99999).map(str), st.just("–")
)
UNIT = st.sampled_from(["", " (g)", " (N s)", " (m/s²)", " (µs)"])
SENTENCE = st.lists(st.one_of(WORD, NUMBER, NUMBER.map(lambda number: f"{number} kN")), min_size=1, max_size=12).map(
    " ".join
)
HEAD = st.tuples(st.lists(WORD, min_size=1, max_size=4).map(" ".join), UNIT).map("".join)


@st.composite
def tables(draw):
    """Return columns and rows as a command may have them: the first names the row."""
    columns = [draw(st.sampled_from([*keys("case"), *numerals("#", priority=KEY)]))]
    for _ in range(draw(st.integers(1, 9))):
        columns.append(Column("", (), label=draw(HEAD), priority=draw(st.integers(1, 4)), words=draw(st.booleans())))
    cells = [draw(st.lists(SENTENCE if c.words else NUMBER, min_size=3, max_size=3)) for c in columns]
    return columns, [list(row) for row in zip(*cells, strict=True)]


def unbroken(text: str, lines: str) -> bool:
    """Return whether a text stands in one of the lines, not as a part of a longer word."""
    return re.search(rf"(?<!\S){re.escape(text)}(?!\S)", lines) is not None


@given(tables(), st.sampled_from([60, 80, 100, 160]), st.booleans())
def test_no_table_is_wider_than_its_width_or_breaks_a_word(table, width, wide):
    columns, rows = table
    lines = [line.text for line in table_lines("A table of what came out", columns, rows, width, wide)]
    assert max(map(length, lines)) <= width
    shown = "\n".join(lines)
    named = shown.rpartition("not shown: ")[2] if "not shown: " in shown else ""
    for place, column in enumerate(columns):
        heads = tokens(column.head.partition(" (")[0])
        left_out = column.priority > 1 and "\n".join(heads).split()[0] in " ".join(named.split())
        if left_out and not wide:
            continue
        for text in [token for row in rows for token in (tokens(row[place]) if column.words else [row[place]])]:
            assert unbroken(text, shown) or text in shown.split("\n"), (text, column)


@pytest.mark.verify
@given(tables(), st.integers(60, 200))
def test_main_columns_are_never_left_out_and_wide_leaves_out_none(table, width):
    columns, rows = table
    for wide in (False, True):
        shown = "\n".join(line.text for line in table_lines("", columns, rows, width, wide))
        left_out = [c for c in columns if c.priority > 1] if not wide else []
        assert ("not shown" in shown) <= bool(left_out)
        kept = [row[k] for row in rows for k, column in enumerate(columns) if column not in left_out]
        assert all(unbroken(token, shown) for cell in kept for token in tokens(cell))


@given(SENTENCE, st.integers(40, 120))
def test_a_sentence_ends_its_lines_at_spaces_and_loses_nothing(text, width):
    lines = wrapped(text, width)
    assert " ".join(lines) == text
    assert all(length(line) <= width for line in lines)
    number_and_unit = re.findall(r"(?<!\S)-?\d[\d.e+-]* kN", text)
    assert all(any(pair in line for line in lines) for pair in number_and_unit)


@given(SENTENCE, st.integers(20, 120))
def test_a_shortened_line_ends_between_words(text, width):
    line = cut(text, width)
    assert length(line) <= width
    kept = line.removesuffix(" …")
    assert text == kept if line == text else text.startswith(f"{kept} ")


@given(st.text(max_size=40))
def test_a_dumb_terminal_gets_ascii(text):
    assert plain(text).isascii()


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("a peak of 4150 g (3200 to 4900 g) in the first", ["4150 g", "4900 g)"]),
        ("an impulse of 2.48 N s and a slope of 90.8 MN/m", ["2.48 N s", "90.8 MN/m"]),
        ("a share of 61 % of the scatter, 1.2e-05 m/s² or -3 °C", ["61 %", "1.2e-05 m/s²", "-3 °C"]),
        ("a mass of 1.2 kg ± 0.1 kg", ["1.2 kg ± 0.1 kg"]),
    ],
)
def test_a_number_keeps_its_unit(text, kept):
    for width in range(12, 40):
        lines = wrapped(text, width)
        assert all(any(words in line for line in lines) for words in kept), (width, lines)


def test_a_table_picks_its_columns_by_priority():
    columns = [
        *numerals("#", priority=KEY), *texts("kind"), *numerals("peak (g)"), *numerals("force (kN)", priority=MORE + 1),
        *numerals("impulse (N s)", priority=MORE),
    ]  # fmt: skip
    rows = [["1", "full", "4151.3", "30.69", "2.482"]]
    shown = {w: "\n".join(line.text for line in table_lines("", columns, rows, w)) for w in (18, 30, 40)}
    assert "not shown: force, impulse (--wide)" in " ".join(shown[18].split())
    assert "not shown: force (--wide)" in " ".join(shown[30].split())
    assert "not shown" not in shown[40]
    assert ("2.482" in shown[30], "2.482" in shown[18]) == (True, False)


def test_units_stand_in_a_line_of_their_own_below_heads_that_break_at_spaces():
    columns = [*numerals("#", priority=KEY), *numerals("pulse width at 10 % (µs)", "velocity change (m/s)")]
    lines = [line.text for line in table_lines("", columns, [["1", "200.0", "5.408"]], 24)]
    assert lines[:4] == [
        "   pulse width  velocity",
        "#      at 10 %    change",
        "          (µs)     (m/s)",
        "────────────────────────",
    ]


def test_a_table_whose_main_columns_do_not_fit_is_turned():
    columns = [*numerals("blow", priority=KEY), *numerals(*(f"quantity{k} (g)" for k in range(6)))]
    lines = [line.text for line in table_lines("", columns, [[str(k) for k in range(7)]], 40)]
    assert lines == ["blow 0", *(f"  quantity{k} (g)  {k + 1}" for k in range(6))]


def test_wide_splits_a_table_that_does_not_fit_and_repeats_the_keys():
    columns = [*keys("case"), *numerals(*(f"quantity{k}" for k in range(6)), priority=MORE)]
    lines = [line.text for line in table_lines("", columns, [["a", *"123456"]], 40, wide=True)]
    heads = [line.split() for line in lines if line.startswith("case")]
    assert heads == [["case", "quantity0", "quantity1", "quantity2"], ["case", "quantity3", "quantity4", "quantity5"]]
    endless = [line.text for line in table_lines("", columns, [["a", *"123456"]], float("inf"), wide=True)]
    assert len(endless) == 3
