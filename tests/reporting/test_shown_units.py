"""Units that the user chose: numbers, heads, and what is refused."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.base.units import parse_quantity
from strikewave.reporting.numbers import (
    OFFERED,
    ShownUnits,
    axis_unit,
    fixed,
    headed,
    in_shown_units,
    showing,
    spelled,
    with_unit,
)

PAIRS = [(si, usual, unit) for si, offered in OFFERED.items() for usual in offered for unit in offered]


@given(st.sampled_from(PAIRS), st.floats(1e-9, 1e12))
def test_value_with_unit_reads_back_within_its_digits(pair, value):
    si, usual, unit = pair
    with showing(ShownUnits.read(unit)):
        text = with_unit(value, si, usual)
    number, _, name = text.partition(" ")
    assert name == spelled(unit)
    # half a unit of the fourth digit: 5e-4 of a number that begins with 1
    assert parse_quantity(f"{number} {unit}", si, "") == pytest.approx(value, rel=5.01e-4)


@given(st.sampled_from(PAIRS), st.floats(1e-9, 1e9), st.integers(0, 4))
def test_column_in_a_chosen_unit_keeps_its_resolution(pair, value, decimals):
    si, usual, unit = pair
    with showing(ShownUnits.read(unit)):
        cell, (size, _) = fixed(value, si, usual, decimals), axis_unit(si, usual)
    step = 10.0**-decimals * parse_quantity(f"1 {usual}", si, "")
    # half a step of the usual column; a ratio of units that is no power of ten moves it by a root of ten at most,
    # and whole numbers are the coarsest below a float's own 1e-12
    assert float(cell) * size == pytest.approx(value, abs=0.5 * math.sqrt(10.0) * step, rel=1e-12)


@given(st.sampled_from(PAIRS))
def test_head_names_the_unit_in_which_the_axis_is_drawn(pair):
    si, usual, unit = pair
    with showing(ShownUnits.read(unit)):
        head, (size, name) = headed("x", si, usual), axis_unit(si, usual)
    assert head == f"x ({name})"
    assert size == parse_quantity(f"1 {unit}", si, "")


def test_choice_ends_with_its_context_and_leaves_other_kinds_alone():
    before = with_unit(9806.65, "m/s^2", "g"), with_unit(1e-3, "s", "ms")
    with showing(ShownUnits.read("m/s²")):
        assert with_unit(9806.65, "m/s^2", "g") == "9807 m/s²"
        assert with_unit(1e-3, "s", "ms") == before[1]
    assert (with_unit(9806.65, "m/s^2", "g"), with_unit(1e-3, "s", "ms")) == before


@pytest.mark.parametrize("words", ["m/s2", "m/s^2", "m/s**2", "m/s²", " m/s2 "])
def test_spellings_of_a_power_are_one_unit(words):
    assert dict(ShownUnits.read(words).units) == {"m/s^2": "m/s^2"}


def test_g_is_standard_gravity_and_gram_a_mass():
    assert dict(ShownUnits.read("g,gram").units) == {"m/s^2": "g", "kg": "gram"}


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ("kn", 'did you mean "kN"'),
        ("g,m/s2", "at most one unit of acceleration; leave out g or m/s^2"),
        ("furlong", "at most one unit for each kind"),
        ("", 'got ""'),
        ("g,", 'got ""'),
    ],
)
def test_unit_that_is_unknown_or_twice_is_refused_with_what_is_allowed(words, named):
    with pytest.raises(InputError, match=re.escape(named)) as caught:
        ShownUnits.read(words)
    assert str(caught.value).startswith("--show: ")
    assert "\n" not in str(caught.value)


@given(st.sampled_from(PAIRS), st.floats(1e-9, 1e9))
def test_quantity_of_a_message_is_the_same_in_a_chosen_unit_and_the_rest_of_it_stays(pair, value):
    si, usual, unit = pair
    number = f"{value:.4g}"
    with showing(ShownUnits.read(unit)):
        shown = in_shown_units(f"blow 3 has {number}\xa0{usual}, above 3 {usual} ({unit})")
    before, _, rest = shown.partition(" has ")
    assert (before, rest.partition(", ")[2]) == ("blow 3", f"above 3 {usual} ({unit})")
    said, _, name = rest.partition(", ")[0].partition(" ")
    assert name in (spelled(unit), unit)
    # half a unit of the fourth digit, 5e-4 of a number that begins with 1
    assert parse_quantity(f"{said} {unit}", si, "") == pytest.approx(
        parse_quantity(f"{number} {usual}", si, ""), rel=5.01e-4
    )


@pytest.mark.verify
def test_warnings_follow_the_units_shown_on_screen_and_page_but_not_in_json(strikewave, tmp_path):
    run = ["run", "li-ma-2019", "--no-band", "--set", "feed.blows=1", "--out", "o", "--force", "--show", "N"]
    code, _, err = strikewave(*run, "-v")
    assert code == 0
    assert re.search(r"passes first yield \(\d+ N\)", err)
    page = (tmp_path / "o" / "report.html").read_text("utf-8")
    assert re.search(r"passes first yield \(\d+ N\)", page)
    _, out, _ = strikewave(*run, "--json")
    assert re.search(r"passes first yield \([\d.]+ kN\)", out)
