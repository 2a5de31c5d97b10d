"""Cushions: laws of pads under blows, materials with sources, energy, set and wear.

Examples
--------
>>> from strikewave.contact import solve_impact
>>> from strikewave.contact.cushions import Pad, tangent
>>> blow = solve_impact(tangent(Pad(5e-3, 0.02), modulus=2e6, limit_strain=0.8), 10.0, float("inf"), 2.0)
>>> print((blow.max_indentation * 1e3).round(2))
8.38
"""

from strikewave.contact.cushions.blows import (
    Cushion,
    CushionBalance,
    Wear,
    balance_of,
    repeated_blows,
)
from strikewave.contact.cushions.carried import Carried, carried
from strikewave.contact.cushions.laws import (
    Pad,
    crush,
    cushion_law,
    cushion_laws,
    elastomer,
    felt,
    foam,
    linear,
    power,
    retardation_of,
    retarded,
    solid_strain,
    tangent,
)
from strikewave.contact.cushions.table import CushionMaterial, cushion_material, cushion_materials

__all__ = [
    "Carried",
    "Cushion",
    "CushionBalance",
    "CushionMaterial",
    "Pad",
    "Wear",
    "balance_of",
    "carried",
    "crush",
    "cushion_law",
    "cushion_laws",
    "cushion_material",
    "cushion_materials",
    "elastomer",
    "felt",
    "foam",
    "linear",
    "power",
    "repeated_blows",
    "retardation_of",
    "retarded",
    "solid_strain",
    "tangent",
]
