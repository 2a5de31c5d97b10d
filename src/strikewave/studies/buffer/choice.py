"""Which gasket stacks are tried: materials, thicknesses, how many layers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby, product

from strikewave.base.constants import material
from strikewave.base.errors import MISSING, InputError
from strikewave.base.quantities import Value
from strikewave.studies.buffer.mounting_site import GasketLayer, GasketStack

MOST_CANDIDATES = 20_000
"""More stacks than this are refused before one is tried: at about 6 ms each (measured with two
layers and a history of 2 ms) they take two minutes."""
MOST_LAYERS = 10
"""More gaskets than this in a stack are refused. Chosen: even two kinds of gasket give 2047 stacks there."""
THICKNESS_DIGITS = 12
"""Decimals of a thickness, m, by which stacks are compared: a picometre, above the rounding of a sum (1e-16 m) and
below every thickness that can be typed with sense."""


@dataclass(frozen=True)
class StackChoices:
    """What stacks may be made of: materials, thicknesses, and the most layers."""

    materials: tuple[str, ...]
    thicknesses: tuple[Value, ...]
    layers: int = 3


def stacks(choice: StackChoices) -> list[GasketStack]:
    """Return all stacks of a choice, none first; those that another one equals are left out.

    Neighbours of one material are bonded and are as one gasket of both thicknesses: 0.5 + 1 mm is 1 + 0.5 mm.

    Raises
    ------
    InputError
        If there is nothing to choose from, or far too much.

    Examples
    --------
    >>> thin, thick = Value(si=1e-3, typed="1 mm"), Value(si=2e-3, typed="2 mm")
    >>> [" | ".join(map(str, stack)) for stack in stacks(StackChoices(("PTFE",), (thin, thick), 2))]
    ['', 'PTFE 1 mm', 'PTFE 2 mm', 'PTFE 1 mm | PTFE 2 mm', 'PTFE 2 mm | PTFE 2 mm']
    """
    names = tuple(dict.fromkeys(material(name, "--material").name for name in choice.materials))
    sizes = {value.si: value for value in choice.thicknesses}
    _check_count(len(names) * len(sizes), choice.layers)
    single = [GasketLayer(name, value) for name in names for value in sizes.values()]
    distinct: dict[tuple[tuple[str, float], ...], GasketStack] = {}
    for count in range(choice.layers + 1):
        for stack in product(single, repeat=count):
            merged = tuple((name, round(thickness, THICKNESS_DIGITS)) for name, thickness in _bonded(stack))
            distinct.setdefault(merged, stack)
    return list(distinct.values())


def _check_count(kinds: int, layers: int) -> None:
    """Refuse nothing to choose from, and more stacks than may be tried."""
    if not kinds:
        raise InputError("--thickness", MISSING, "at least one material and one thickness")
    if not 0 <= layers <= MOST_LAYERS:
        raise InputError("--layers", layers, f"a whole number from 0 to {MOST_LAYERS}")
    count = sum(kinds**k for k in range(layers + 1))
    if count > MOST_CANDIDATES:
        hint = "take fewer materials, thicknesses or layers"
        raise InputError("--layers", f"{layers} of {kinds} gaskets: {count} stacks", f"at most {MOST_CANDIDATES}", hint)


def _bonded(stack: GasketStack) -> Iterator[tuple[str, float]]:
    """Yield material and whole thickness of neighbours of one material."""
    for name, group in groupby(stack, key=lambda layer: layer.material):
        yield name, sum(layer.thickness.si for layer in group)
