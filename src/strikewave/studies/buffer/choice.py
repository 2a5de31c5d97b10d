"""Which gasket stacks are tried: materials, thicknesses, how many sheets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby, product

from strikewave.base.errors import MISSING, InputError
from strikewave.base.materials import material
from strikewave.base.quantities import Value
from strikewave.studies.buffer.seat import Sheet, Sheets

MOST_CANDIDATES = 20_000
"""More stacks than this are refused before one is tried."""


@dataclass(frozen=True)
class Choice:
    """What stacks may be made of: materials, thicknesses, and the most layers."""

    materials: tuple[str, ...]
    thicknesses: tuple[Value, ...]
    layers: int = 3


def stacks(choice: Choice) -> list[Sheets]:
    """Return all stacks of a choice, none first; those that another one equals are left out.

    Neighbours of one material are bonded and are as one gasket of both thicknesses: 0.5 + 1 mm is 1 + 0.5 mm.

    Raises
    ------
    InputError
        If there is nothing to choose from, or far too much.

    Examples
    --------
    >>> thin, thick = Value(si=1e-3, typed="1 mm"), Value(si=2e-3, typed="2 mm")
    >>> [" | ".join(map(str, found)) for found in stacks(Choice(("PTFE",), (thin, thick), 2))]
    ['', 'PTFE 1 mm', 'PTFE 2 mm', 'PTFE 1 mm | PTFE 2 mm', 'PTFE 2 mm | PTFE 2 mm']
    """
    names = tuple(dict.fromkeys(material(name, "--material").name for name in choice.materials))
    sizes = {value.si: value for value in choice.thicknesses}
    _check_count(len(names) * len(sizes), choice.layers)
    sheets = [Sheet(name, value) for name in names for value in sizes.values()]
    found: dict[tuple[tuple[str, float], ...], Sheets] = {}
    for layers in range(choice.layers + 1):
        for stack in product(sheets, repeat=layers):
            merged = tuple((name, round(size, 12)) for name, size in _runs(stack))
            found.setdefault(merged, stack)
    return list(found.values())


def _check_count(kinds: int, layers: int) -> None:
    """Refuse nothing to choose from, and more stacks than may be tried."""
    if not kinds:
        raise InputError("--thickness", MISSING, "at least one material and one thickness")
    if not 0 <= layers <= 10:
        raise InputError("--layers", layers, "a whole number from 0 to 10")
    count = sum(kinds**k for k in range(layers + 1))
    if count > MOST_CANDIDATES:
        hint = "take fewer materials, thicknesses or layers"
        raise InputError("--layers", f"{layers} of {kinds} gaskets: {count} stacks", f"at most {MOST_CANDIDATES}", hint)


def _runs(sheets: Sheets) -> Iterator[tuple[str, float]]:
    """Yield material and whole thickness of neighbours of one material."""
    for name, group in groupby(sheets, key=lambda sheet: sheet.material):
        yield name, sum(sheet.thickness.si for sheet in group)
