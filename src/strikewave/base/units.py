"""Units at the edge: "730 rpm", "4000 g", "0.5 mm" become SI floats, and SI floats become text.

In strikewave ``g`` is standard gravity (9.80665 m/s^2), never gram; ``r/min`` is a speed of rotation. A power is
``m/s^2``, ``m/s**2``, ``m/s2`` or ``m/s²``.
"""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base.errors import InputError, nearest

DIMENSIONS: dict[str, tuple[str, str]] = {
    "m": ("a length", "0.5 mm"),
    "m^2": ("an area", "700 mm^2"),
    "m^3": ("a volume", "5000 cm^3"),
    "kg": ("a mass", "0.459 kg"),
    "s": ("a time", "200 us"),
    "rad": ("an angle", "15 deg"),
    "rad/s": ("a speed of rotation", "730 rpm"),
    "m/s": ("a speed", "5 m/s"),
    "m/s^2": ("an acceleration", "4000 g"),
    "N": ("a force", "20 kN"),
    "N s": ("an impulse", "2.5 N s"),
    "N m": ("a torque", "30 N m"),
    "N/m": ("a stiffness", "40 kN/m"),
    "N m/rad": ("a stiffness in rotation", "20 kN m/rad"),
    "N s/m": ("a damping", "60 N s/m"),
    "N m s/rad": ("a damping in rotation", "0.02 N m s/rad"),
    "kg m^2": ("a moment of inertia", "4 kg m^2"),
    "Pa": ("a pressure or modulus", "211 GPa"),
    "kg/m^3": ("a density", "7820 kg/m^3"),
    "Hz": ("a frequency", "200 kHz"),
    "J": ("an energy", "10 J"),
    "V": ("a voltage", "10 V"),
    "C": ("a charge", "100 pC"),
    "K": ("an absolute temperature", "293 K"),
    "J/kg/K": ("a specific heat", "470 J/kg/K"),
    "1/s": ("a strain rate", "1 1/s"),
    "1/K": ("a share per kelvin", "0.0028 1/K"),
    "1": ("a strain or another ratio", "200 ustrain"),
}
"""The SI unit of every kind of quantity used here, its name, and an example that can be typed."""

_NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,4})?"
_WORD = r"[A-Za-zµμΩ°%_]{1,30}(?:(?:\^|\*\*)-?\d|[23²³])?"
_UNIT = rf"(?:(?<![\d.])1|{_WORD})(?:\s*[*/·]\s*{_WORD}|\s+{_WORD})*"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*({_UNIT})?\s*")
"""A number, the word of a unit with its power, a unit of several, and a quantity. Repeats are bounded, so that no text
takes long; an exponent of more than four digits is no number anyway. A unit that begins with 1 needs a blank before it:
"11/s" may be 1 1/s or 11/s."""
_BEGIN = re.compile(rf"\s*({_NUMBER})")
_MERGED = re.compile(rf"\s*({_NUMBER})1\s*/\s*({_WORD})\s*")
"""A number and a unit such as 1/s without a blank between them."""
_ANGLE = re.compile(r"(?<![A-Za-z])(?:rad|radian|deg|degree|°|r|rpm|turn|revolution)(?![A-Za-z])")
"""Words that mean an angle: pint takes turns as pure numbers, and would read "730 1/s" as a speed of rotation."""
_LONGEST = 80
"""Characters of a quantity: more are none, and are not searched."""
ENDLESS = ("inf", "infinity")
"""Words for a number without end, where one is allowed."""
_LARGEST_DIVISOR, _WHOLE = 1e15, 1e-12
"""Divisors up to which a float holds every whole number, and how near to one a factor's inverse must be to be one."""
_ALIASES = {"g": "standard_gravity", "r": "revolution", "us": "microsecond", "µs": "microsecond"}
"""Words that pint reads otherwise: g as gram, r as nothing, and a micro sign of either kind."""
_COMMON = "m mm um km s ms us ns kg gram rpm Hz kHz MHz N kN MN Pa kPa MPa GPa g deg rad J kJ min"
"""Units that are offered for one that is unknown: those of shock tests."""


USUAL: dict[tuple[str, str], float] = {(si, si): 1.0 for si in DIMENSIONS} | {
    (unit, si): factor
    for si, factors in {
        "m": {"mm": 1e-3, "um": 1e-6},
        "m^2": {"mm^2": 1e-6, "cm^2": 1e-4},
        "m^3": {"cm^3": 1.0000000000000002e-6},
        "kg": {"gram": 1e-3},
        "s": {"ms": 1e-3, "us": 1e-6, "ns": 1e-9},
        "rad": {"deg": math.pi / 180.0},
        "rad/s": {"rpm": math.pi / 30.0},
        "m/s^2": {"g": 9.80665},
        "N": {"kN": 1e3, "MN": 1e6},
        "N/m": {"kN/m": 1e3, "MN/m": 1e6, "GN/m": 1e9},
        "N s/m": {"kN s/m": 1e3},
        "Pa": {"MPa": 1e6, "GPa": 1e9, "bar": 1e5},
        "Hz": {"kHz": 1e3, "MHz": 1e6},
    }.items()
    for unit, factor in factors.items()
}
"""Factors of the usual units to SI, equal to those of pint to the last bit: pint takes 70 ms to import."""


def _pint() -> Any:
    """Return pint, imported where a unit is not among the usual ones."""
    import pint

    return pint


@functools.cache
def _registry() -> Any:
    return _pint().UnitRegistry(str(Path(__file__).with_name("units.txt")))


@functools.lru_cache(maxsize=512)
def _factor(unit: str, si: str) -> float:
    """Return how many ``si`` are in one ``unit``; raises pint's own errors. A unit such as N/m^n is known to itself."""
    usual = 1.0 if unit == si else USUAL.get((unit, si))
    return _by_pint(unit, si) if usual is None else usual


def _by_pint(unit: str, si: str) -> float:
    """Return how many ``si`` are in one ``unit``, whatever can be written; raises pint's own errors."""

    def tidy(text: str) -> str:
        text = re.sub(r"(?<=[A-Za-zµμΩ°%_])([23²³])", lambda m: "^" + str(unicodedata.digit(m[0])), text)
        text = re.sub(r"[A-Za-zµμΩ°%_]+", lambda m: _ALIASES.get(m[0], m[0]), text.replace("·", "*"))
        return re.sub(r"(?<=[\w°%])\s+(?=[A-Za-zµμΩ°%_])", "*", text)

    return float(_registry().Quantity(1.0, tidy(unit)).to(tidy(si)).magnitude)


class TypedQuantity(NamedTuple):
    """A quantity as it was typed: the text of its number, and that of its unit, empty where it has none.

    Examples
    --------
    >>> typed = take_apart("-2e-05 s")
    >>> typed.number, typed.unit, typed.value
    ('-2e-05', 's', -2e-05)
    """

    number: str
    unit: str

    @property
    def value(self) -> float:
        """The number; infinite where its exponent is too large."""
        return float(self.number)


def take_apart(typed: object) -> TypedQuantity | None:
    """Return number and unit of what was typed, as a text or as a bare number; None where it is no quantity.

    All that needs a part of a typed quantity takes it from here, so that each spelling means the same everywhere. That
    the unit exists is not checked: `parse_quantity` does. A per cent sign is a unit.

    Examples
    --------
    >>> take_apart("+1.5E3rpm"), take_apart("2 %"), take_apart(0.5), take_apart("fast")
    (TypedQuantity(number='+1.5E3', unit='rpm'), TypedQuantity(number='2', unit='%'), \
TypedQuantity(number='0.5', unit=''), None)
    """
    text = str(typed) if isinstance(typed, int | float) and not isinstance(typed, bool) else typed
    match = _QUANTITY.fullmatch(text) if isinstance(text, str) and len(text) <= _LONGEST else None
    return None if match is None else TypedQuantity(match[1], (match[2] or "").strip())


def typed_number(text: str, sign: str = "") -> float | None:
    """Return the finite number that a text is, without a unit or with that ``sign`` alone; None where it is no such.

    Examples
    --------
    >>> typed_number("+2e-05"), typed_number("5 %", "%"), typed_number("5 %"), typed_number("1_000")
    (2e-05, 5.0, None, None)
    """
    typed = take_apart(text)
    return typed.value if typed is not None and typed.unit == sign and math.isfinite(typed.value) else None


def split_number(text: str) -> tuple[float, str] | None:
    """Return the number that a text begins with, and what follows it; None where it begins with none.

    For what is no quantity by itself, such as a sensitivity, whose unit has brackets.

    Examples
    --------
    >>> split_number("1.2e0 mV/(m/s^2)"), split_number("mV")
    ((1.2, 'mV/(m/s^2)'), None)
    """
    match = _BEGIN.match(text) if len(text) <= _LONGEST else None
    return None if match is None else (float(match[1]), text[match.end() :].strip())


def range_ends(text: str) -> tuple[str, str] | None:
    """Return the two quantities of a range such as ``400..900 rpm``, a bare first one with the unit of the last.

    None stands for what is no range: three dots are none either, since "0...5" may end at 5 or at 0.5.

    Examples
    --------
    >>> range_ends("400..900rpm"), range_ends("1e-3 s .. 2 ms"), range_ends("0...5"), range_ends("5")
    (('400 rpm', '900rpm'), ('1e-3 s', '2 ms'), None, None)
    """
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not (dots and low and high) or "..." in text:
        return None
    first, last = with_last_unit([low, high])
    return first, last


def with_last_unit(parts: Sequence[str]) -> list[str]:
    """Return quantities of a list, bare ones with the unit of the last one.

    Examples
    --------
    >>> with_last_unit(["400", "900rpm"]), with_last_unit(["1", "2"])
    (['400 rpm', '900rpm'], ['1', '2'])
    """
    last = take_apart(parts[-1])
    unit = "" if last is None else last.unit
    return [f"{part.strip()} {unit}".strip() if typed_number(part) is not None else part for part in parts]


def parse_quantity(text: object, si: str, field: str, example: str = "") -> float:
    """Turn "number unit" into a float in the SI unit ``si``.

    Parameters
    ----------
    text : str
        A number and a unit, such as ``"730 rpm"``.
    si : str
        The SI unit wanted, one of `DIMENSIONS`.
    field : str
        Path of the field, for the error message.
    example : str, optional
        A usual value of that field, for the error message; that of its kind by default.

    Raises
    ------
    InputError
        For a bare number, a wrong dimension, an unknown unit, or a value that is not finite.

    Examples
    --------
    >>> parse_quantity("1 g", "m/s^2", "peak")
    9.80665
    >>> parse_quantity("0.5 mm", "m", "depth")
    0.0005
    """
    name, usual = DIMENSIONS[si]
    allowed = f'{name} with its unit, such as "{example or usual}"'
    if isinstance(text, bool) or not isinstance(text, str):
        bare = isinstance(text, int | float) and not isinstance(text, bool)
        hint = f'a bare number has no unit: write "{text} {si}" if that is meant' if bare else ""
        raise InputError(field, text, allowed, hint)
    typed = take_apart(text)
    if typed is None:
        raise InputError(field, text, allowed, _of_spelling(text) or "write one number, then its unit")
    unit = typed.unit
    if not unit:
        hint = f'a bare number has no unit: write "{typed.number} {si}" if that is meant'
        raise InputError(field, text, allowed, hint)
    try:
        value = _times(typed.value, _factor(unit, si))
    except _pint().UndefinedUnitError as error:
        unknown = str(error.args[0][0] if isinstance(error.args[0], tuple | list) else error.args[0])
        raise InputError(
            field, text, allowed, f'unknown unit "{unknown}": {nearest(unknown, _COMMON.split())}'
        ) from None
    except _pint().DimensionalityError:
        hint = (
            '"g" is standard gravity here; write gram or kg' if re.search(r"(?<![A-Za-z])g(?![A-Za-z])", unit) else ""
        )
        raise InputError(field, text, allowed, hint or f'"{unit}" is not {name}') from None
    except (_pint().PintError, ValueError, TypeError, ArithmeticError, AssertionError):
        raise InputError(field, text, allowed, "the unit could not be read") from None
    turns = bool(_ANGLE.search(unit))
    if si in ("rad", "rad/s") and not turns:
        raise InputError(field, text, allowed, f'"{unit}" does not say turns or radians: write rpm, rad/s, deg')
    if si == "Hz" and turns:
        raise InputError(field, text, allowed, f'"{unit}" is a speed of rotation, not a frequency')
    if not math.isfinite(value):
        raise InputError(field, text, allowed, "the value is not finite")
    return value


def _of_spelling(text: str) -> str:
    """Return what to write where a number has a comma, or its unit needs a blank; empty where that is not the fault.

    Examples
    --------
    >>> _of_spelling("1,2 m"), _of_spelling("1,200 g"), _of_spelling("m")
    ('write a decimal point, not a comma: "1.2 m"', 'a comma may mean either: write "1.200 g" or "1200 g"', '')
    >>> _of_spelling("2001/s")
    'a unit that begins with 1 needs a blank before it: "200 1/s"'
    """
    if len(text) <= _LONGEST and (merged := _MERGED.fullmatch(text)) is not None:
        return f'a unit that begins with 1 needs a blank before it: "{merged[1]} 1/{merged[2]}"'
    pointed = text.strip().replace(",", ".", 1)
    if "," not in text or len(text) > _LONGEST or _QUANTITY.fullmatch(pointed) is None:
        return ""
    if re.search(r",\d{3}(?!\d)", text):
        return f'a comma may mean either: write "{pointed}" or "{text.strip().replace(",", "", 1)}"'
    return f'write a decimal point, not a comma: "{pointed}"'


def _times(number: float, factor: float) -> float:
    """Multiply; by a divisor where that is a whole number, so that 20 us is 2e-05 and not a digit less."""
    inverse = 1.0 / factor
    whole = round(inverse) if inverse < _LARGEST_DIVISOR else 0
    return number / whole if whole > 1 and abs(inverse - whole) < _WHOLE * inverse else number * factor


def parse_typed(text: str, si: str, field: str) -> float:
    """Turn what was typed on a command line into SI: with a unit it is converted, a bare number is SI.

    Examples
    --------
    >>> parse_typed("20", "m/s", "--speed")
    20.0
    >>> parse_typed("72 km/h", "m/s", "--speed")
    20.0
    >>> parse_typed("inf", "kg", "--m2")
    inf
    """
    if text.strip().lower() in ENDLESS:
        return math.inf
    number = typed_number(text)
    return parse_quantity(text, si, field) if number is None else number


def si_value(value: str | float, si: str, field: str) -> float:
    """Return a quantity in SI: a text has its unit, a number is SI already.

    Examples
    --------
    >>> si_value("20 ms", "s", "interval"), si_value(0.02, "s", "interval")
    (0.02, 0.02)
    """
    return parse_quantity(value, si, field) if isinstance(value, str) else float(value)


def in_unit(value: float, si: str, unit: str) -> float:
    """Return an SI value in another unit.

    Examples
    --------
    >>> in_unit(9806.65, "m/s^2", "g")
    1000.0
    """
    return _times(value, 1.0 / _factor(unit, si))


def convertible(unit: str, choices: Iterable[str]) -> tuple[str, float] | None:
    """Return the first SI unit of some choices that a unit can be turned into, and its factor; None where none fits.

    Examples
    --------
    >>> convertible("mV", ("m/s^2", "V")), convertible("furlong", ("m",))
    (('V', 0.001), None)
    """
    if len(unit) > _LONGEST or not re.fullmatch(_UNIT, unit.strip()):
        return None
    for si in choices:
        try:
            return si, _times(1.0, _factor(unit.strip(), si))
        except (_pint().PintError, ValueError, TypeError, ArithmeticError, AssertionError):
            continue
    return None
