"""Moduli that gaskets may have in a blow: softer, stiffer, and where the faces of elastomers cannot slip."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from strikewave.base.constants import Material, material
from strikewave.studies.buffer.mounting_site import GasketStack

SPREAD = {"elastomer": (0.5, 5.0)}
"""Lowest and highest modulus over that of the table, by kind of material. Elastomers: the table gives the static one,
and its note expects 2 to 5 times that from 1 to 100 kHz (assumed); half is a softer compound (assumed)."""
OTHERS = (0.5, 2.0)
"""The same of all other kinds: grade, temperature, rate, and how flat the faces lie (assumed)."""
SOFTEST, STIFFEST = -1.0, 1.0
"""Places of the ends of the spread, where the modulus of the table is at 0."""
BETWEEN = (2.0 / 3.0, 1.0 / 3.0, -0.5)
"""Places between the table's modulus (0) and the ends of the spread (-1, 1) that are tried too: no step is beyond
1.8 times the modulus, 1.3 times the resonance."""


def spread(row: Material) -> tuple[float, float]:
    """Return the lowest and the highest modulus that a gasket is tried with, over that of the table.

    Examples
    --------
    >>> spread(material("rubber")), spread(material("PTFE"))
    ((0.5, 5.0), (0.5, 2.0))
    """
    return SPREAD.get(row.kind, OTHERS)


def moduli(stack: GasketStack, place: float) -> list[float]:
    """Return the modulus of each gasket over that of the table, at a place from `SOFTEST` to `STIFFEST`; 0 is one.

    Examples
    --------
    >>> from strikewave.base.quantities import Value
    >>> from strikewave.studies.buffer.mounting_site import GasketLayer
    >>> stack = GasketLayer("rubber", Value(si=1e-3, typed="1 mm")), GasketLayer("PTFE", Value(si=1e-3, typed="1 mm"))
    >>> moduli(stack, SOFTEST), moduli(stack, 0.0), moduli(stack, STIFFEST)
    ([0.5, 0.5], [1.0, 1.0], [5.0, 2.0])
    """
    ends = [spread(material(layer.material)) for layer in stack]
    return [(high if place > 0.0 else low) ** abs(place) for low, high in ends]


def confinement(row: Material, area: float, thickness: float, stiffer: float = 1.0) -> float:
    """Return the modulus of a disc of an elastomer whose faces cannot slip over that of the table, at most.

    1/E_a = 1/(E (1 + 2 S^2)) + 1/K, E_a at least E, with S = sqrt(A/pi) / (2 h), the loaded area of a disc over its
    free one, and K = E / (3 (1 - 2 nu)). Filled rubbers stiffen less: 2 S^2 is then multiplied by 0.5 to 1.
    Source: Gent & Lindley 1959, appendix I, eq. 5 for a disc, E (1 + 2 S^2), as quoted by R. Holland; 1/K beside it,
    the usual correction, leaves the bulk modulus where S is large.

    Parameters
    ----------
    row : Material
        E in Pa, nu.
    area, thickness : float
        A in m^2, h in m, of neighbours of this material together.
    stiffer : float, optional
        E over that of the table; K stays.

    Examples
    --------
    >>> round(confinement(material("rubber"), math.pi * 0.01**2, 5e-3), 2)
    2.97
    """
    shape = math.sqrt(area / math.pi) / (2.0 * thickness)
    bulk = 1.0 / (3.0 * (1.0 - 2.0 * row.poissons_ratio))
    return max(1.0 / (1.0 / (stiffer * (1.0 + 2.0 * shape**2)) + 1.0 / bulk), stiffer)


def confined(stack: GasketStack, area: float, factors: Sequence[float] = ()) -> list[float]:
    """Return the modulus of each gasket over that of the table where elastomers cannot slip.

    ``factors`` are those of the free gaskets, 1 by default.
    """
    ratios: list[float] = []
    for name, group in groupby(stack, key=lambda layer: layer.material):
        bonded, row = tuple(group), material(name)
        thickness = sum(layer.thickness.si for layer in bonded)
        free = factors[len(ratios)] if factors else 1.0
        ratios += [confinement(row, area, thickness, free) if row.kind == "elastomer" else free] * len(bonded)
    return ratios


def variants(stack: GasketStack, area: float) -> Iterator[list[float]]:
    """Yield the moduli that a robust stack must bear, over those of the table: free to slip, and not.

    The moduli of all gaskets go together, from the stiff end to the soft one, the table's left out where the faces
    slip.
    """
    places = (STIFFEST, SOFTEST, *BETWEEN)
    yield from (moduli(stack, place) for place in places)
    if any(material(layer.material).kind == "elastomer" for layer in stack):
        yield from (confined(stack, area, moduli(stack, place)) for place in (STIFFEST, 0.0, *BETWEEN, SOFTEST))
