"""The digits of a number are one rule: a headline agrees with the table below it, and what was rounded shows it."""

import math
from decimal import Decimal

from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.result import Band
from strikewave.reporting.bands import fixed_within, with_band
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.parts import written

NUMBERS = st.floats(1e-3, 1e6)


@given(NUMBERS, st.floats(0.01, 1.0), st.floats(0.01, 1.0))
def test_a_headline_and_the_table_below_it_have_the_same_digits(value, down, up):
    """A headline of 4200 g stood above 4150 g in the table, for one peak."""
    band = Band(value * (1.0 - 0.9 * down), value * (1.0 + up), 0.95)
    headline = with_band(value, band, "N", "N").partition(" ")[0]
    assert headline == fixed_within(value, [band], "N", "N", 9)
    room = max(0.01 * (band.high - band.low), 0.51e-3 * band.high)  # a digit beyond those of the range, or four in all
    assert abs(float(headline) - value) <= room


@given(NUMBERS, st.integers(0, 3))
def test_without_a_range_a_table_has_every_digit_of_the_headline(value, decimals):
    """A headline of 99.98 g stood above 100.0 g in the table, for one peak."""
    headline, cell = with_band(value, None, "N", "N").partition(" ")[0], fixed_within(value, [], "N", "N", decimals)
    if value < 0.1 * 10.0**-decimals:  # beyond that a table has no more digits, as rounding leaves no true zero
        return
    last = [Decimal(1).scaleb(int(Decimal(text).as_tuple().exponent)) for text in (headline, cell)]
    assert abs(Decimal(headline) - Decimal(cell)) <= sum(last) / 2
    exact = math.isclose(float(headline), value, rel_tol=1e-9)
    assert last[1] <= last[0] or exact


@given(NUMBERS, st.integers(2, 6))
def test_a_number_without_a_decimal_zero_at_its_end_is_exact_or_has_all_its_digits(value, digits):
    """2.995 m/s in three digits stood as 3 m/s."""
    text = written(value, digits)
    assert math.isclose(float(text), value, rel_tol=10.0 ** (1 - digits))
    if not math.isclose(float(text), value, rel_tol=1e-9):
        significant = text.partition("e")[0].replace(".", "").lstrip("0")
        assert len(significant) >= digits


def test_what_was_rounded_to_a_round_number_says_so():
    assert with_unit(2.995, "m/s", "m/s", 3) == "3.00 m/s"
    assert with_unit(3.0, "m/s", "m/s", 3) == "3 m/s"
    assert with_unit(5.798, "m/s", "m/s", 3) == "5.80 m/s"
    assert with_unit(2e-4, "s", "us") == "200 µs"  # what a conversion of units leaves is no rounding
    assert with_unit(199.97e-6, "s", "us") == "200.0 µs"
