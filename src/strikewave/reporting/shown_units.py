"""Units that the user chose, one for each kind of quantity, and where they are in force."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field

from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, parse_quantity

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
    """Units that the user chose: at most one for each kind of quantity.

    Attributes
    ----------
    units : mapping of str to str
        Unit by the SI unit of its kind; a kind without one is shown as usual.

    Examples
    --------
    >>> chosen = ShownUnits.read("m/s2, ms")
    >>> chosen.unit("m/s^2", "g"), chosen.unit("s", "us"), chosen.unit("N", "kN")
    ('m/s^2', 'ms', 'kN')
    """

    units: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, words: str, option: str = "--show") -> ShownUnits:
        """Return the units of a list such as ``g,us,kN``.

        Raises
        ------
        InputError
            If one is unknown, or two are of one kind.
        """
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
    """Return the SI unit of the kind of quantity that a unit is of."""
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
    """Show quantities in these units, or in the usual ones, as long as the context lasts, in this thread.

    Examples
    --------
    >>> from strikewave.reporting.numbers import with_unit
    >>> with showing(ShownUnits.read("m/s^2")):
    ...     with_unit(40709.86, "m/s^2", "g")
    '40710 m/s²'
    """
    token = _chosen.set(units)
    try:
        yield
    finally:
        _chosen.reset(token)


def shown_unit(si: str, usual: str) -> str:
    """Return the unit in which quantities of an SI unit are shown: the one chosen, or the usual one.

    Examples
    --------
    >>> shown_unit("N", "kN")
    'kN'
    """
    chosen = _chosen.get()
    return usual if chosen is None else chosen.unit(si, usual)


def are_chosen() -> bool:
    """Tell whether the user chose a unit."""
    return _chosen.get() is not None
