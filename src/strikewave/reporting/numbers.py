"""Numbers and units as they are shown, on the screen and in the report."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.base.result import Band
from strikewave.base.units import in_unit
from strikewave.reporting.parts import NONE, written

TWO_DIGITS_BELOW = 3.0
"""Half widths of a band that begin with 1 or 2 are stated with two digits, others with one: rounding then moves an end
by a sixth of the half width at most."""
MOST_DIGITS = 4
"""Significant digits of a result with a narrow band: the balances hold to 1e-6, but nobody measures a shock so well."""
LONGEST_IN_MICROSECONDS = 5e-3
"""Runs that last longer, s, are shown in milliseconds: µs would need five digits before the point."""
SHOWN_UNITS = {"m/s^2": "g", "s": "us", "N": "N", "": ""}
"""SI unit of a published number and the unit in which it is shown."""


def heads(columns: Sequence[tuple[str, str, str, int]]) -> list[str]:
    """Return the heads of columns with their units.

    Examples
    --------
    >>> heads([("restitution", "1", "1", 4), ("indentation", "m", "um", 2)])
    ['restitution', 'indentation (µm)']
    """
    return [name.replace("_", " ") + (f" ({spelled(unit)})" if unit != "1" else "") for name, _, unit, _ in columns]


def fixed(value: float | None, si: str, unit: str, decimals: int) -> str:
    """Write an SI value in a unit with so many decimals; a dash where there is none.

    Examples
    --------
    >>> fixed(2e-4, "s", "us", 1)
    '200.0'
    """
    return NONE if value is None or value != value else f"{in_unit(value, si, unit):.{decimals}f}"


def time_unit(last: float) -> tuple[float, str]:
    """Return the size, s, and the name of the unit in which times up to the last one are shown.

    Examples
    --------
    >>> time_unit(1e-4), time_unit(1.0)
    ((1e-06, 'µs'), (0.001, 'ms'))
    """
    return (1e-6, "µs") if last < LONGEST_IN_MICROSECONDS else (1e-3, "ms")


def energy_unit(largest: float) -> tuple[float, str]:
    """Return the size, J, and the name of the unit in which energies up to the largest one are shown.

    Numbers then have one to four digits before the point, or at most one zero after it.

    Examples
    --------
    >>> energy_unit(0.02), energy_unit(30.0), energy_unit(2e5)
    ((0.001, 'mJ'), (1.0, 'J'), (1000.0, 'kJ'))
    """
    return (1e-3, "mJ") if largest < 0.1 else (1.0, "J") if largest < 1e4 else (1e3, "kJ")


def percent(share: float, decimals: int = 1, sign: str = "") -> str:
    """Write a share in per cent, with a space before the sign as SI asks for.

    Examples
    --------
    >>> percent(0.0331), percent(-0.002, 2, "+"), percent(0.5, 0)
    ('3.3 %', '-0.20 %', '50 %')
    """
    return f"{100.0 * share:{sign}.{decimals}f} %"


def spelled(unit: str) -> str:
    """Return a unit as print spells it.

    Examples
    --------
    >>> spelled("us"), spelled("m/s^2")
    ('µs', 'm/s²')
    """
    return unit.replace("us", "µs").replace("um", "µm").replace("^2", "²")


def listed(words: list[str]) -> str:
    """Join words as a sentence does.

    Examples
    --------
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def with_unit(value: float | None, si: str, unit: str, digits: int = 4) -> str:
    """Write an SI value with the unit it is shown in; a dash where there is none, or where a time is not positive.

    Examples
    --------
    >>> with_unit(40709.86, "m/s^2", "g"), with_unit(0.0, "s", "us")
    ('4151 g', '–')
    """
    if value is None or math.isnan(value) or (si == "s" and value <= 0.0):
        return NONE
    return f"{written(float(in_unit(value, si, unit)), digits)} {spelled(unit)}"


def decimals_within(low: float, high: float) -> int:
    """Return the decimals that a number keeps between the ends of its band; below 0 for tens, hundreds and so on.

    Examples
    --------
    >>> decimals_within(800.0, 1570.0), decimals_within(0.98, 1.26), decimals_within(4151.2, 4151.4)
    (-2, 2, 0)
    """
    half, largest = 0.5 * abs(high - low), max(abs(low), abs(high))
    if not (math.isfinite(half) and largest > 0.0):
        return MOST_DIGITS - 1
    finest = MOST_DIGITS - 1 - math.floor(math.log10(largest))
    if half == 0.0:
        return finest
    place = math.floor(math.log10(half))
    return min(finest, -place + (1 if half / 10.0**place < TWO_DIGITS_BELOW else 0))


def rounded(value: float, decimals: int) -> str:
    """Write a number with so many decimals; below 0 it is rounded to tens, hundreds and so on.

    Examples
    --------
    >>> rounded(1165.2, -2), rounded(1165.2, 1)
    ('1200', '1165.2')
    """
    return f"{round(value, decimals):.{max(decimals, 0)}f}"


def with_band(value: float | None, band: Band | None, si: str, unit: str) -> str:
    """Write an SI value with its unit and its band; digits follow the band.

    Examples
    --------
    >>> with_band(11424.0, Band(7850.0, 15400.0, 0.95), "m/s^2", "g")
    '1200 g (800 to 1600 g)'
    """
    if value is None or math.isnan(value) or band is None or not math.isfinite(band.low + band.high):
        return with_unit(value, si, unit)
    shown, low, high = (float(in_unit(number, si, unit)) for number in (value, band.low, band.high))
    decimals = decimals_within(low, high)
    name = spelled(unit)
    return f"{rounded(shown, decimals)} {name} ({rounded(low, decimals)} to {rounded(high, decimals)} {name})"
