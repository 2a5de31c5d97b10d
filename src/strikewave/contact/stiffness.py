"""Contact stiffness laws F = K d^n: one law, one short function.

Every law returns a `Stiffness`. Symbols: E Young's modulus (Pa), nu Poisson's ratio (-), R radius (m),
h length of the contact line (m), d indentation (m), F force (N).
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol


class ElasticBody(Protocol):
    """Anything with a Young's modulus (Pa) and a Poisson's ratio, such as a `Material`."""

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus, Pa."""

    @property
    def poissons_ratio(self) -> float:
        """Poisson's ratio."""


class Stiffness(NamedTuple):
    """A power law F = K d^n.

    Attributes
    ----------
    stiffness : float
        K, N/m^n.
    exponent : float
        n.
    law : str
        Name of the law it came from.
    status : str
        ``checked`` (the source was opened) or ``from memory``.
    source : str
        Key of the source in `strikewave.citations`.
    """

    stiffness: float
    exponent: float
    law: str = "given"
    status: str = "given"
    source: str = ""


def contact_modulus(one: ElasticBody, other: ElasticBody) -> float:
    """Return the contact modulus E* of two bodies, 1/E* = sum (1 - nu^2)/E, in Pa (Johnson 1985, eq. 4.21).

    Examples
    --------
    >>> from strikewave.materials import material
    >>> round(contact_modulus(material("65Mn"), material("65Mn")) / 1e9, 4)
    115.042
    """
    return 1.0 / sum((1.0 - body.poissons_ratio**2) / body.youngs_modulus for body in (one, other))


def hertz(one: ElasticBody, other: ElasticBody, radius1: float, radius2: float = math.inf) -> Stiffness:
    """Return the stiffness of two spheres: K = (4/3) E* sqrt(R), n = 3/2, 1/R = 1/R1 + 1/R2.

    Valid for elastic bodies and a contact radius small beside R. ``radius2 = inf`` is a plane.
    Source: Hertz 1882 in Johnson 1985, eq. 4.23.

    Raises
    ------
    ValueError
        If a radius is not positive.

    Examples
    --------
    >>> from strikewave.materials import material
    >>> law = hertz(material("65Mn"), material("65Mn"), radius1=0.01)
    >>> round(law.stiffness / 1e10, 5), law.exponent
    (1.53389, 1.5)
    """
    if not (radius1 > 0.0 and radius2 > 0.0):
        raise ValueError(f"radii must be positive, got {radius1!r} and {radius2!r}")
    radius = 1.0 / (1.0 / radius1 + 1.0 / radius2)
    return Stiffness(
        4.0 / 3.0 * contact_modulus(one, other) * math.sqrt(radius), 1.5, "hertz", "checked", "johnson-1985"
    )


def palmgren(one: ElasticBody, other: ElasticBody, length: float) -> Stiffness:
    """Return the stiffness of a cylinder of length h on a plane or cylinder, n = 10/9.

    d = 3.81 [2 / (pi E')]^0.9 F^0.9 / h^0.8 with E' = 2 / sum((1 - nu^2)/E) = 2 E*, SI units;
    so K = {h^0.8 / (3.81 [2 / (pi E')]^0.9)}^(10/9). The cylinder's radius does not enter.
    Empirical, for steel rollers of bearings. Source: Palmgren as given by Li & Ma 2019, eqs (2)-(4);
    their eq (5) prints E' upside down (a compliance), which is repaired here.

    Raises
    ------
    ValueError
        If the length is not positive.

    Examples
    --------
    >>> from strikewave.materials import material
    >>> law = palmgren(material("65Mn"), material("65Mn"), length=0.04)
    >>> round(law.stiffness / 1e9, 2), round(law.exponent, 4)
    (4.68, 1.1111)
    """
    if not length > 0.0:
        raise ValueError(f"the contact length must be positive, got {length!r}")
    modulus = 2.0 * contact_modulus(one, other)
    compliance = 3.81 * (2.0 / (math.pi * modulus)) ** 0.9 / length**0.8
    return Stiffness(compliance ** (-10.0 / 9.0), 10.0 / 9.0, "palmgren", "checked", "li-ma-2019")


def line_contact_yield_load(weaker: ElasticBody, other: ElasticBody, yield_strength: float, radius: float) -> float:
    """Return the load per length at which a line contact first yields, N/m.

    F/h = pi R p0^2 / E* with the largest Hertz pressure p0 = 1.79 sigma_y (von Mises, below the
    surface, nu = 0.30). Source: Johnson 1985, sections 4.2 and 6.2.

    Examples
    --------
    >>> from strikewave.materials import material
    >>> steel = material("65Mn")
    >>> round(line_contact_yield_load(steel, steel, steel.yield_strength, radius=0.01) * 0.04 / 1e3, 1)
    6.5
    """
    return math.pi * radius * (1.79 * yield_strength) ** 2 / contact_modulus(weaker, other)


STIFFNESS_LAWS = {"hertz": hertz, "palmgren": palmgren}
"""The stiffness laws by the name that a case file uses."""
