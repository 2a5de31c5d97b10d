"""Numbers and units as they are shown, on the screen and in the report."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.base.units import in_unit
from strikewave.reporting.parts import NONE, written


def heads(columns: Sequence[tuple[str, str, str, int]]) -> list[str]:
    """Return the heads of columns with their units.

    Examples
    --------
    >>> heads([("restitution", "1", "1", 4), ("indentation", "m", "um", 2)])
    ['restitution', 'indentation (µm)']
    """
    return [name.replace("_", " ") + (f" ({spelled(unit)})" if unit != "1" else "") for name, _, unit, _ in columns]


SHOWN_UNITS = {"m/s^2": "g", "s": "us", "N": "N", "": ""}
"""SI unit of a published number and the unit in which it is shown."""


def fixed(value: float | None, si: str, unit: str, decimals: int) -> str:
    """Write an SI value in a unit with so many decimals; a dash where there is none.

    Examples
    --------
    >>> fixed(2e-4, "s", "us", 1)
    '200.0'
    """
    return NONE if value is None or value != value else f"{in_unit(value, si, unit):.{decimals}f}"


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
