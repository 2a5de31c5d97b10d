"""What is typed means the same however it is spelled and wherever it stands: file, --set, --vary, app, table of bands."""

from __future__ import annotations

import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import strikewave
from strikewave.analyses.compare.limits import read_limit
from strikewave.base.errors import InputError
from strikewave.base.quantities import Range
from strikewave.base.result import BandMethod
from strikewave.base.units import DIMENSIONS, ENDLESS, parse_quantity, parse_typed, take_apart, typed_number
from strikewave.cases.case import FORM, dump_case, load_case, parse_case
from strikewave.cases.files import bundled_cases
from strikewave.records.calibration import ChannelCalibration, known_unit
from strikewave.reporting.bands import moved_rows
from strikewave.reporting.measured_files import _time_constant, read_time_unit
from strikewave.reporting.options import read_share
from strikewave.specifications.budget_file import load_budget
from strikewave.studies.axes import units_of
from strikewave.studies.engine.plan import read_ends, read_variable, typed_value
from strikewave.studies.search.goals import read_aim
from strikewave.uncertainty.bands import moved
from strikewave.uncertainty.draws import range_of
from strikewave.uncertainty.input_ranges import known_inputs
from strikewave.web.case_values import edited_fields
from strikewave.web.pages.case.bar_parts import _millimetres

SPELLINGS: tuple[Callable[[Decimal, str], str], ...] = (
    lambda number, unit: f"{number:e} {unit}",  # 1.5e-3
    lambda number, unit: f"{number:E}{unit}",  # 1.5E+3, no blank
    lambda number, unit: f"+{number:e}{unit}" if number >= 0 else f"{number:e}{unit}",
    lambda number, unit: f"  {number:E}\N{NO-BREAK SPACE}{unit} ",
    lambda number, unit: f"{number:f}{unit}",
    lambda number, unit: f"{number:e}".replace("+", "") + f" {unit}",  # 1.5e3
)
"""Ways to write a decimal number, whose digits they all keep, and its unit."""


def _spelled(number: str, unit: str, way: int) -> str:
    way = 0 if unit.startswith("1") else way  # 1/s needs its blank
    return SPELLINGS[way % len(SPELLINGS)](Decimal(number), unit)


@pytest.mark.parametrize("name", bundled_cases())
def test_each_quantity_of_each_built_in_case_means_the_same_in_every_spelling(name: str) -> None:
    values = load_case(name).values()
    parts = {path: take_apart(value.typed) for path, value in values.items() if ".normal." not in path}  # a word: "z"
    typed = {path: one for path, one in parts.items() if one is not None}
    assert len(typed) == len(parts)
    plain = load_case(name, [f"{path}={Decimal(one.number):f} {one.unit}" for path, one in typed.items()])
    usual = edited_fields(plain)
    turn = 3 * (bundled_cases().index(name) % 2)  # each half of the spellings at every other case
    texts = {path: _spelled(one.number, one.unit, place + turn) for place, (path, one) in enumerate(typed.items())}
    changed = load_case(name, [f"{path}={text}" for path, text in texts.items()])
    filed, fields = parse_case(dump_case(changed), name).values(), edited_fields(changed)
    for path in typed:
        value = plain.values()[path]
        assert changed.values()[path].si == filed[path].si == value.si
        assert units_of(path, changed.values()[path]) == units_of(path, value)
        in_app = fields[path].with_unit(texts[path]), fields[path].with_unit(f"{Decimal(typed[path].number):E}")
        for text in (texts[path], *in_app):
            assert typed_value(plain, path, text).si == value.si
        assert fields[path][4:] == usual[path][4:]  # unit, value and slider
    assert _shown_ranges(changed) == _shown_ranges(plain)


def _shown_ranges(case: strikewave.Case) -> list[list[object]]:
    """Return the rows of the table of inputs of a band, without what was typed."""
    method = BandMethod("", 0.95, 1, 1, inputs=tuple(moved(one) for one in known_inputs(case)))
    return [[row[0], *row[2:]] for row in moved_rows(method)]


_CASE = load_case("li-ma-2019")
_PIECES = [*"0123456789+-.eE,_ \N{NO-BREAK SPACE}mskgNHz/^%*·µ²١", "rpm", "1/s", "mm", "..", "inf", "nan", "0x"]


@settings(max_examples=400, deadline=None)
@given(st.lists(st.sampled_from(_PIECES), max_size=9).map("".join), st.sampled_from(sorted(DIMENSIONS)))
@example("11/s", "1/s")
@example("1 1/s", "1/s")
@example("1e999 m", "m")
@example("5e3e3 m", "m")
def test_an_odd_spelling_is_refused_in_a_sentence_or_read_alike_everywhere(text: str, si: str) -> None:
    try:
        value = Range(si).read(text).si
    except InputError as refusal:
        assert str(refusal).count("allowed:") == 1
        assert "\n" not in str(refusal)
        if typed_number(text) is None and text.strip() not in ENDLESS:  # a bare number is refused in a file alone
            with pytest.raises(InputError):
                parse_typed(text, si, "")
        return
    parts = take_apart(text)
    assert parts is not None
    assert parts.unit
    assert value == parse_typed(text, si, "") == parse_quantity(f"{parts.number} {parts.unit}", si, "")
    assert value == pytest.approx(parts.value * parse_quantity(f"1 {parts.unit}", si, ""), rel=1e-15)


@settings(max_examples=250, deadline=None)
@given(st.lists(st.sampled_from(_PIECES), max_size=9).map("".join))
def test_a_change_and_a_varied_value_take_the_same_spellings(text: str) -> None:
    document: dict[str, dict[str, object]] = {"machine": {}}

    def changed() -> float:
        FORM.change(document, f"machine.engagement={text}")
        return range_of(_CASE, "machine.engagement").read(document["machine"]["engagement"]).si

    def varied() -> float:
        return typed_value(_CASE, "machine.engagement", text).si

    assert _value_or_none(changed) == _value_or_none(varied)


def _value_or_none(read: Callable[[], float]) -> float | None:
    try:
        return read()
    except InputError:
        return None


def test_a_unit_that_begins_with_one_needs_a_blank() -> None:
    """201/s is 201/s to one reader, and 20 1/s to one who leaves blanks out."""
    assert parse_quantity("20 1/s", "1/s", "rate") == 20.0
    with pytest.raises(InputError, match='needs a blank before it: "20 1/s"'):
        parse_quantity("201/s", "1/s", "rate")


@pytest.mark.parametrize(
    "read",
    [
        lambda text: read_share(f"{text}e0 %", "--want-cv"),
        lambda text: read_share(f"+{text}E-2", "--want-cv"),
        lambda text: read_limit(f"peak < {text}E0%").value,
        lambda text: read_aim(load_case("li-ma-2019"), "run", f"cv < {text}e+0%").high,  # type: ignore[union-attr]
        lambda text: read_aim(load_case("li-ma-2019"), "run", f"cv < +{text}e-2").high,  # type: ignore[union-attr]
        lambda text: 2.0 * load_budget(f"{text}E+0 %").contributions[0].spread,
        lambda text: Range("m").read({"value": "1 m", "tolerance": f"{text}e0%"}).half_width,
    ],
)
def test_a_share_means_the_same_in_every_spelling(read: Callable[[str], float]) -> None:
    assert read("5") == pytest.approx(0.05, rel=1e-15)


@pytest.mark.parametrize("text", ["4e2..9E2rpm", "+400 rpm .. 0.9e3rpm", "400rpm..900rpm", "4.e2 ..900. rpm"])
def test_the_ends_of_a_range_take_each_spelling(text: str) -> None:
    case = load_case("li-ma-2019")
    ends = read_ends(case, "machine.speed", text)
    assert ends is not None
    assert [end.si for end in ends] == [parse_quantity(f"{speed} rpm", "rad/s", "") for speed in (400, 900)]
    variable = read_variable(case, f"machine.speed={text}:3")
    assert [variable.axis.typed(value) for value in variable.axis.values] == ["400 rpm", "650 rpm", "900 rpm"]


def test_a_range_has_two_dots() -> None:
    """0...5 may end at 5, or at 0.5."""
    case = load_case("li-ma-2019")
    assert read_ends(case, "machine.engagement", "0...5 mm") is None
    with pytest.raises(InputError, match="two dots"):
        read_variable(case, "machine.engagement=0...5 mm")
    with pytest.raises(InputError, match="or"):
        read_aim(case, "run", "first.width = 0...5 ms")


def test_what_is_typed_beside_a_case_takes_each_spelling() -> None:
    assert read_time_unit("1e1us", "") == read_time_unit("10 us", "") == 1e-5
    assert _time_constant("1.6E0ms", "") == _time_constant("1.6 ms", "") == 1.6e-3
    assert _time_constant("1e2Hz", "") == _time_constant("100 Hz", "")
    assert known_unit("1e3g") == known_unit("1000 g") == ("m/s^2", 9806.65)
    assert ChannelCalibration(sensitivity="1.2E0mV/g").scale("V") == ChannelCalibration(sensitivity="1.2 mV/g").scale(
        "V"
    )
    assert _millimetres("2.9e1mm") == _millimetres("29") == 29.0
    assert _millimetres("2.9 cm") == pytest.approx(29.0, rel=1e-15)


_BY_ITSELF = re.compile(r"""\\d.*\\?\[eE\]|lstrip\(["'][-+.0-9eE]{6,}|removesuffix\("%"\)""")
"""What takes a typed number apart: a pattern with an exponent, its characters stripped, a sign cut off."""
_NOT_TYPED = (
    "base/units.py",  # the one place
    "records/readers/",
    "exchange/ls_dyna/histories.py",
    "reporting/chapters.py",
    "reporting/layout.py",
    "reporting/numbers.py",
    "reporting/parts.py",
)
"""Where numbers of other programs are read, and those that we wrote ourselves."""


def test_no_module_takes_typed_quantities_apart_by_itself() -> None:
    """One that does reads ``2e-05 s`` otherwise sooner or later: `strikewave.base.units.take_apart` is for all."""
    root = Path(strikewave.__file__).parent
    assert _BY_ITSELF.search(r'_NUMBER = re.compile(r"\s*[-+]?(\d*)\.?(\d*)(?:[eE]([-+]?\d+))?")')
    assert _BY_ITSELF.search('unit = str(value.typed).lstrip("+-0123456789.eE").strip()')
    own = [
        f"{place}: {line.strip()}"
        for path in sorted(root.rglob("*.py"))
        if not (place := path.relative_to(root).as_posix()).startswith(_NOT_TYPED)
        for line in path.read_text("utf-8").splitlines()
        if _BY_ITSELF.search(line)
    ]
    assert own == []
