"""Units: exact conversions, round trips, and everything that must be refused."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base import units
from strikewave.base.errors import InputError
from strikewave.base.units import DIMENSIONS, USUAL, in_unit, parse_quantity, parse_typed


@pytest.mark.parametrize(
    ("text", "si", "value"),
    [
        ("1 g", "m/s^2", 9.80665),  # CGPM 1901
        ("730 rpm", "rad/s", 730 * 2 * math.pi / 60),
        ("730 r/min", "rad/s", 730 * 2 * math.pi / 60),
        ("20 us", "s", 20e-6),
        ("200 µs", "s", 200e-6),
        ("15.58 mm", "m", 0.01558),
        ("1 in", "m", 0.0254),
        ("60 gram", "kg", 0.06),
        ("1 lbf", "N", 4.4482216152605),
        ("7.82 gram/cm^3", "kg/m^3", 7820),
        ("90 deg", "rad", math.pi / 2),
        ("-9.8 m/s^2", "m/s^2", -9.8),
        ("-9.8 m/s2", "m/s^2", -9.8),
        ("-9.8 m/s²", "m/s^2", -9.8),
        ("8500 kg/m3", "kg/m^3", 8500),
        ("2 cm³", "m^3", 2e-6),
        ("2 g2 s2/m", "m/s^2", 2 * 9.80665**2),
        ("4 kg·m^2", "kg m^2", 4),
        ("1e3 N", "N", 1000),
        (".5 kN", "N", 500),
        ("3 psi", "Pa", 3 * 4.4482216152605 / 0.0254**2),
    ],
)
def test_exact_conversions(text, si, value):
    assert parse_quantity(text, si, "field") == pytest.approx(value, rel=1e-14)


@given(st.floats(1e-9, 1e9), st.sampled_from(["mm", "um", "m", "km", "in"]))
def test_round_trip(value, unit):
    assert parse_quantity(f"{in_unit(value, 'm', unit)!r} {unit}", "m", "field") == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("si", DIMENSIONS)
def test_every_example_reads(si):
    assert math.isfinite(parse_quantity(DIMENSIONS[si][1], si, "field"))
    assert parse_quantity(f"1 {si}", si, "field") == 1.0


BAD = [
    "", " ", "fast", "5", "5 kg", "5 m/s m", "5 m/s5", "5 m/s1", "5 m 2", "5 m/s22", "m", "5 5 m", "5 mm mm", "1e99999 m", "nan m", "inf m", "5 m**99999", "9**9 m",
    "__import__('os') m", "5 (m)", "5 m; rm", "5 m\n6", "5 " + "m" * 50, "5 m" + " " * 100, "5 lightyear", "5 mmm", "5 %",
]  # fmt: skip


@pytest.mark.parametrize("text", BAD)
def test_what_is_no_length_is_refused_in_one_line(text):
    with pytest.raises(InputError) as caught:
        parse_quantity(text, "m", "object.length")
    line = str(caught.value)
    assert line.startswith("object.length: got ")
    assert "\n" not in line
    assert "a length" in line


@pytest.mark.parametrize(
    ("text", "si"), [("8.3 Hz", "rad/s"), ("730 1/min", "rad/s"), ("730 rpm", "Hz"), ("3 m/m", "rad")]
)
def test_turns_and_frequencies_are_never_mixed_up(text, si):
    with pytest.raises(InputError):
        parse_quantity(text, si, "machine.speed")


@pytest.mark.parametrize("raw", [5, 5.0, True, None, [], {}, float("nan"), b"5 m"])
def test_what_is_no_text_is_refused(raw):
    with pytest.raises(InputError, match="allowed: a length"):
        parse_quantity(raw, "m", "x")


def test_gram_is_never_g():
    with pytest.raises(InputError, match="standard gravity here; write gram or kg"):
        parse_quantity("300 g", "kg", "object.mass")


def test_nearest_unit_is_named():
    with pytest.raises(InputError, match='did you mean "rpm"'):
        parse_quantity("730 rpn", "rad/s", "machine.speed")


@given(st.text(max_size=100))
def test_any_text_is_read_or_refused(text):
    try:
        assert math.isfinite(parse_quantity(text, "m", "x"))
    except InputError as error:
        assert "\n" not in str(error)


def test_bare_number_on_the_command_line_is_si():
    assert parse_typed("20", "m/s", "--speed") == 20.0
    assert parse_typed("4000 g", "m/s^2", "--peak") == pytest.approx(39226.6)


@pytest.mark.parametrize(("unit", "si"), USUAL)
def test_usual_units_are_those_of_pint_to_the_last_bit(unit, si):
    """They stand in a table, so that a case of usual units is read without pint."""
    assert units._by_pint(unit, si) == USUAL[unit, si]
