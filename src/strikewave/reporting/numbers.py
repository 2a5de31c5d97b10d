"""Numbers and units as they are shown: on the screen, in the report, and in tables of text.

Each function takes the unit in which a quantity is shown as a rule; the unit that the user chose for that kind of
quantity takes its place. JSON and NetCDF stay in SI.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field

from strikewave.base.errors import InputError, nearest
from strikewave.base.texts import NO_DOUBT, beside_doubt, percent, rounded
from strikewave.base.units import DIMENSIONS, in_unit, parse_quantity
from strikewave.reporting.parts import NONE, written

OFFERED = {
    "m/s^2": ("g", "m/s^2", "mm/s^2", "km/s^2", "ft/s^2"),
    "s": ("s", "ms", "us", "ns"),
    "N": ("N", "kN", "MN", "lbf"),
    "m": ("m", "cm", "mm", "um", "nm", "in"),
    "m/s": ("m/s", "mm/s", "km/h", "ft/s", "in/s"),
    "Pa": ("Pa", "kPa", "MPa", "GPa", "bar", "psi"),
    "J": ("J", "mJ", "kJ"),
    "kg": ("kg", "gram", "mg", "t", "lb"),
    "Hz": ("Hz", "kHz", "MHz"),
    "rad": ("rad", "deg"),
    "rad/s": ("rad/s", "rpm"),
    "m^2": ("m^2", "cm^2", "mm^2"),
    "N s": ("N s", "mN s", "kN s", "lbf s"),
    "N m": ("N m", "N mm", "kN m"),
    "N/m": ("N/m", "N/mm", "kN/m", "MN/m", "GN/m"),
    "N s/m": ("N s/m", "kN s/m"),
    "kg/m^3": ("kg/m^3", "gram/cm^3"),
    "1/s": ("1/s", "1/ms"),
    "V": ("V", "mV"),
}
"""Kinds of quantities whose unit may be chosen, by SI unit, and units that are offered; others that convert are taken
too, by the first kind that they fit."""


@dataclass(frozen=True)
class ShownUnits:
    """Units that the user chose, by the SI unit of their kind: at most one for each kind of quantity.

    Examples
    --------
    >>> chosen = ShownUnits.read("m/s2, ms")
    >>> chosen.unit("m/s^2", "g"), chosen.unit("s", "us"), chosen.unit("N", "kN")
    ('m/s^2', 'ms', 'kN')
    """

    units: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, words: str, option: str = "--show") -> ShownUnits:
        """Return the units of a list such as ``g,us,kN``."""
        units: dict[str, str] = {}
        for word in words.split(","):
            unit = plain_unit(word)
            si = _kind_of(unit, word, option)
            if si in units:
                allowed = f"at most one unit of {_kind(si)}"
                raise InputError(option, words, allowed, f"leave out {units[si]} or {unit}")
            units[si] = unit
        return cls(units)

    def unit(self, si: str, usual: str) -> str:
        """Return the unit in which a quantity of an SI unit is shown: the one chosen, or the usual one."""
        return self.units.get(si, usual)


def plain_unit(word: str) -> str:
    """Return a unit as it is written in files: ``m/s²``, ``m/s2`` and ``m/s**2`` are m/s^2, µs is us.

    Examples
    --------
    >>> plain_unit(" m/s2"), plain_unit("µs"), plain_unit("kg/m³")
    ('m/s^2', 'us', 'kg/m^3')
    """
    text = re.sub(r"\s+", " ", re.sub("[µμ]", "u", word.strip()))
    return re.sub(r"(?<=[A-Za-z])([23])", r"^\1", text.replace("**", "^").replace("²", "2").replace("³", "3"))


def _kind(si: str) -> str:
    """Return the kind of quantity of an SI unit, without its article."""
    return DIMENSIONS[si][0].partition(" ")[2]


def _kind_of(unit: str, word: str, option: str) -> str:
    """Return the SI unit of the kind of quantity to which a unit belongs."""
    for si, offered in OFFERED.items():
        if unit in offered:
            return si
    for si in OFFERED:
        with contextlib.suppress(InputError):
            parse_quantity(f"1 {unit}", si, option)
            return si
    near = nearest(unit, [name for offered in OFFERED.values() for name in offered])
    for si, offered in OFFERED.items():
        if any(f'"{name}"' in near for name in offered):
            raise InputError(option, word, f"a unit of {_kind(si)}: {', '.join(offered)}", near)
    first = ", ".join(offered[0] for offered in OFFERED.values())
    raise InputError(option, word, f"at most one unit for each kind of quantity, such as {first}")


_chosen: ContextVar[ShownUnits | None] = ContextVar("shown units", default=None)


@contextlib.contextmanager
def showing(units: ShownUnits | None) -> Iterator[None]:
    """Show quantities in these units, or in the usual ones, as long as the context lasts, in this thread."""
    token = _chosen.set(units)
    try:
        yield
    finally:
        _chosen.reset(token)


def shown_unit(si: str, usual: str) -> str:
    """Return the unit in which quantities of an SI unit are shown: the one chosen, or the usual one."""
    chosen = _chosen.get()
    return usual if chosen is None else chosen.unit(si, usual)


LONGEST_IN_MICROSECONDS = 5e-3  # µs would need five digits before the point
"""Time, s, above which runs are shown in milliseconds."""
LEAST_SHARE = 1e-6  # rounding of the runs makes smaller ones
"""Share of a variance below which it is written as such, and a smaller error not at all."""
FEWEST_DIGITS = 4  # "5 kN" is 1124 lbf, not 1000
"""Significant digits, at least, of a number of a message in another unit."""
MOST_MORE = 4  # zero but for rounding would have no end
"""Decimals, at most, of a number of a table beyond those of its column."""
NO_BREAK = "\N{NO-BREAK SPACE}"
_SI_OF = {unit: si for si, offered in reversed(OFFERED.items()) for unit in offered}
_JOINED = re.compile(
    rf"([+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?){NO_BREAK}"
    rf"({'|'.join(map(re.escape, sorted(_SI_OF, key=len, reverse=True)))})(?![\w/^²³])"
)
"""A number and a unit of which there is a choice, joined by a no-break space."""


def axis_unit(si: str, usual: str) -> tuple[float, str]:
    """Return the size, in SI, and the name of the unit in which an axis of a picture shows a quantity.

    Examples
    --------
    >>> axis_unit("m/s^2", "g"), axis_unit("s", "us")
    ((9.80665, 'g'), (1e-06, 'µs'))
    """
    unit = shown_unit(si, usual)
    return parse_quantity(f"1 {unit}", si, unit) if si in DIMENSIONS else 1.0, spelled(unit)


@dataclass(frozen=True)
class ShownQuantity:
    """A kind of quantity that pictures show: its SI unit, and the unit in which it is shown as a rule."""

    si: str
    usual: str

    @property
    def unit(self) -> str:
        """Name of the unit in which it is shown."""
        return axis_unit(self.si, self.usual)[1]

    @property
    def scale(self) -> float:
        """Size of the unit in which it is shown, in SI."""
        return axis_unit(self.si, self.usual)[0]


def headed(name: str, si: str, usual: str) -> str:
    """Return a name with the unit in which it is shown: the head of a column, the label of an axis.

    Examples
    --------
    >>> headed("peak", "m/s^2", "g"), headed("restitution", "1", "1")
    ('peak (g)', 'restitution')
    """
    unit = shown_unit(si, usual)
    return f"{name} ({spelled(unit)})" if unit not in ("", "1") else name


def shown_heads(*usual: str) -> list[str]:
    """Return heads that end with their usual unit, such as ``peak (kN)``, with the unit shown in its place.

    A head without a unit, or with one of which there is no choice, stays as it is.

    Examples
    --------
    >>> with showing(ShownUnits.read("N")):
    ...     shown_heads("contact", "peak (kN)", "at (us)", "strain (%)")
    ['contact', 'peak (N)', 'at (µs)', 'strain (%)']
    """
    heads = []
    for head in usual:
        found = re.fullmatch(r"(.*\s)\(([^()]*)\)", head, re.DOTALL)
        unit = plain_unit(found[2]) if found else ""
        is_offered = found is not None and unit in _SI_OF
        heads.append(f"{found[1]}({spelled(shown_unit(_SI_OF[unit], unit))})" if is_offered and found else head)
    return heads


def shown(value: float, si: str, usual: str) -> float:
    """Return an SI value in the unit in which it is shown.

    Examples
    --------
    >>> shown(9806.65, "m/s^2", "g")
    1000.0
    """
    return float(in_unit(value, si, shown_unit(si, usual)))


def _decimals(si: str, usual: str, decimals: int) -> int:
    """Return the decimals in the unit shown that are worth those in the usual one; below 0 for tens and hundreds."""
    unit = shown_unit(si, usual)
    return decimals if unit == usual else decimals - round(math.log10(in_unit(1.0, si, unit) / in_unit(1.0, si, usual)))


def decimals_in(si: str, usual: str, decimals: int) -> int:
    """Return the decimals in the unit shown that are worth so many in the usual one; at least 0.

    Examples
    --------
    >>> with showing(ShownUnits.read("us")):
    ...     decimals_in("s", "ms", 3)
    0
    """
    return max(_decimals(si, usual, decimals), 0)


def fixed(value: float | None, si: str, usual: str, decimals: int) -> str:
    """Write an SI value in a unit with so many decimals; a dash where there is none.

    In a unit that was chosen instead it keeps about the digits that it has in the usual one.

    Examples
    --------
    >>> fixed(2e-4, "s", "us", 1)
    '200.0'
    >>> with showing(ShownUnits.read("ms,mm/s2")):
    ...     fixed(2e-4, "s", "us", 1), fixed(40709.86, "m/s^2", "g", 1)
    ('0.2000', '40710000')
    """
    if value is None or value != value:
        return NONE
    return rounded(shown(value, si, usual), _decimals(si, usual, decimals))


def decimals_of(value: float | None, si: str, usual: str, decimals: int, digits: int = FEWEST_DIGITS) -> int:
    """Return the decimals of a number of a table, in its usual unit, that leave it the digits of a sentence on it.

    These are those of its column, or up to `MOST_MORE` more: a sentence has so many significant digits.

    Examples
    --------
    >>> decimals_of(980.5, "m/s^2", "g", 1), decimals_of(40709.86, "m/s^2", "g", 1), decimals_of(0.0, "m/s^2", "g", 1)
    (2, 1, 1)
    """
    number = 0.0 if value is None else abs(shown(value, si, usual))
    if not (digits and number and math.isfinite(number)):
        return decimals
    needed = digits - 1 - math.floor(math.log10(number)) - _decimals(si, usual, 0)
    return min(max(decimals, needed), decimals + MOST_MORE)


def time_unit(last: float) -> tuple[float, str]:
    """Return the size, s, and the name of the unit in which times up to the last one are shown.

    Examples
    --------
    >>> time_unit(1e-4), time_unit(1.0)
    ((1e-06, 'µs'), (0.001, 'ms'))
    """
    return axis_unit("s", "us" if last < LONGEST_IN_MICROSECONDS else "ms")


def energy_unit(largest: float) -> tuple[float, str]:
    """Return the size, J, and the name of the unit in which energies up to the largest one are shown.

    Numbers then have one to four digits before the point, or at most one zero after it.

    Examples
    --------
    >>> energy_unit(0.02), energy_unit(30.0), energy_unit(2e5)
    ((0.001, 'mJ'), (1.0, 'J'), (1000.0, 'kJ'))
    """
    return axis_unit("J", "mJ" if largest < 0.1 else "J" if largest < 1e4 else "kJ")


def spelled(unit: str) -> str:
    """Return a unit as print spells it.

    Examples
    --------
    >>> spelled("us"), spelled("m/s^2"), spelled("ustrain"), spelled("N s/m^2.5")
    ('µs', 'm/s²', 'µε', 'N s/m^2.5')
    """
    text = unit.replace("ustrain", "µε").replace("us", "µs").replace("um", "µm")
    return re.sub(r"\^3(?![\d.])", "³", re.sub(r"\^2(?![\d.])", "²", text))


def listed(words: list[str]) -> str:
    """Join words as a sentence does.

    Examples
    --------
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def with_unit(value: float | None, si: str, usual: str, digits: int = 4) -> str:
    """Write an SI value with the unit it is shown in, where it has one.

    A dash stands for no value.

    Examples
    --------
    >>> with_unit(40709.86, "m/s^2", "g"), with_unit(0.0, "s", "us"), with_unit(math.nan, "s", "us")
    ('4151 g', '0 µs', '–')
    """
    if value is None or math.isnan(value):
        return NONE
    number, unit = written(shown(value, si, usual), digits), shown_unit(si, usual)
    return number if unit == "1" else f"{number} {spelled(unit)}"


def hertz(value: float) -> str:
    """Write a frequency, Hz, in the unit that leaves no row of zeros, with three digits; a dash where there is none.

    Examples
    --------
    >>> hertz(12345.0), hertz(50.0), hertz(2.5e6)
    ('12.3 kHz', '50 Hz', '2.5 MHz')
    """
    if not math.isfinite(value):
        return NONE
    return with_unit(float(value), "Hz", "MHz" if value >= 1e6 else "kHz" if value >= 1e3 else "Hz", 3)


def in_shown_units(text: str) -> str:
    r"""Return a message with its quantities in the units that were chosen.

    A message that a room words without knowing who reads it joins a number and its unit by a no-break space. The digits
    written are kept in number; all else of the text stays as it is, and no such space is left.

    Examples
    --------
    >>> in_shown_units("the peak of 5.2\xa0kN is above 5 kN")
    'the peak of 5.2 kN is above 5 kN'
    >>> with showing(ShownUnits.read("N,m/s2")):
    ...     in_shown_units("the peak of 5.2\xa0kN gives 1200\xa0g within 3\xa0ms")
    'the peak of 5200 N gives 11768 m/s² within 3 ms'
    """
    if NO_BREAK not in text:
        return text
    if _chosen.get() is not None:
        text = _JOINED.sub(_in_shown_unit, text)
    return text.replace(NO_BREAK, " ")


def _in_shown_unit(found: re.Match[str]) -> str:
    """Return a number and its unit as they are shown."""
    number, unit = found.groups()
    si = _SI_OF[unit]
    if shown_unit(si, unit) == unit:
        return found[0]
    digits = len(re.sub(r"[eE].*|\D", "", number).lstrip("0"))
    value = shown(parse_quantity(f"{number} {unit}", si, unit), si, unit)
    return f"{written(value, max(digits, FEWEST_DIGITS))} {spelled(shown_unit(si, unit))}"


def doubted(value: float, doubt: float) -> tuple[str, str]:
    """Write a number and its uncertainty: that with two digits, the number with as many decimals.

    Examples
    --------
    >>> doubted(50.0, 1.93), doubted(19702.4, 394.0), doubted(3.3371, 0.0033)
    (('50.0', '1.9'), ('19700', '390'), ('3.3371', '0.0033'))
    """
    if not (math.isfinite(value + doubt) and doubt > NO_DOUBT * abs(value)):
        return written(value), written(doubt, 2)
    return beside_doubt(value, doubt)


def share_with_error(share: float, error: float, decimals: int = 0) -> str:
    """Write a share with its standard error, in per cent: the error to one digit at least, the share as far.

    A share without an error, as where nothing is by chance, gets so many ``decimals``; one that is not known is a dash.

    Examples
    --------
    >>> share_with_error(0.59123, 0.0004), share_with_error(0.5, 0.04), share_with_error(0.0, 0.126)
    ('59.12 ± 0.04 %', '50 ± 4 %', '0 ± 13 %')
    >>> share_with_error(0.5, math.nan), share_with_error(0.25, 0.0, 1), share_with_error(math.nan, 0.1)
    ('50 %', '25.0 %', '–')
    """
    if math.isnan(share):
        return NONE
    if not LEAST_SHARE < error < math.inf:
        return percent(share, decimals)
    to = max(0, -math.floor(math.log10(float(f"{100.0 * error:.0e}"))))
    return f"{percent(share, to).removesuffix(' %')} ± {percent(error, to)}"


def one_in(count: int) -> str:
    """Name the share of a row that is shown: every second, third, ... one.

    Examples
    --------
    >>> [one_in(count) for count in (2, 3, 23, 11, 4)]
    ['every 2nd', 'every 3rd', 'every 23rd', 'every 11th', 'every 4th']
    """
    ending = "th" if count % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(count % 10, "th")
    return f"every {count}{ending}"


def round_step(size: float) -> float:
    """Return a step that begins with 1, 2 or 5, at most as large.

    Examples
    --------
    >>> round_step(0.37), round_step(1.4)
    (0.2, 1.0)
    """
    if not size > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(size))
    return power * max(mark for mark in (1.0, 2.0, 5.0) if mark * power <= size * (1 + 1e-9))
