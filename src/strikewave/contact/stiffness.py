"""Stiffness laws: the elastic force of a contact over its indentation. One law, one short function.

Power laws F = K d^n come as `Stiffness`, those of long bodies in line contact, d = (F/G) ln(B/F), as
`LogarithmicStiffness`. Symbols: E Young's modulus (Pa), nu Poisson's ratio (-), E* contact modulus (Pa), R radius (m),
dR = R1 + R2 (m; the radius of a hole is negative), h length of the contact line (m), d indentation (m), F force (N).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED
from strikewave.base.errors import MISSING, InputError
from strikewave.contact.law import Contact, Damper, LogarithmicContact, PressureCap
from strikewave.contact.registry import StiffnessLaw, law_named, with_added

SMALLEST = 1e-15  # that of a proton, so that only a wrong unit gets below; curvatures stay far from overflow
"""Smallest size, m."""
GEOMETRY = ("radius1", "radius2", "length", "datum_depth")
"""Sizes that a law can ask for: the fields of `Geometry`."""
OPTIONAL_NEEDS = {"radius2", "datum_depth"}
"""Sizes that may be left out: without a second radius it is a plane, and only a plane needs a datum depth."""

_OWN: dict[str, StiffnessLaw] = {}
"""The laws of this module by name; `_law` fills it."""


class ElasticBody(Protocol):
    """Anything with a Young's modulus (Pa) and a Poisson's ratio, such as a `Material`."""

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus, Pa."""

    @property
    def poissons_ratio(self) -> float:
        """Poisson's ratio."""


class Stiffness(NamedTuple):
    """Power law F = K d^n: K in N/m^n, n, and the law it comes from."""

    stiffness: float
    exponent: float
    law: str = "given"
    status: str = "given"
    """``checked``, ``quoted`` or ``from memory`` (`strikewave.base.citations`)."""
    source: str = ""
    """Key of the source in `strikewave.base.citations`."""

    def contact(
        self, hysteresis_factor: ArrayLike = 0.0, cap: PressureCap | None = None, damper: Damper | None = None
    ) -> Contact:
        """Return a contact with this stiffness."""
        return Contact(self.stiffness, self.exponent, hysteresis_factor, damper, cap)


class LogarithmicStiffness(NamedTuple):
    """Logarithmic law d = (F/G) ln(B/F), for F below B/e: slope G, N/m, load B, N, and its law as of a `Stiffness`."""

    slope: float
    load: float
    law: str
    status: str
    source: str

    def contact(self, hysteresis_factor: ArrayLike = 0.0, cap: PressureCap | None = None) -> LogarithmicContact:
        """Return a contact with this stiffness."""
        return LogarithmicContact(self.slope, self.load, hysteresis_factor, cap)

    def indentation(self, force: ArrayLike) -> np.ndarray:
        """Return the indentation under a force, m."""
        f = np.asarray(force, dtype=float)
        return np.asarray(f / self.slope * np.log(self.load / f))


@dataclass(frozen=True)
class Geometry:
    """Sizes of two bodies in contact, m: radii, length of the line, datum depth of a plane.

    The second radius may be inf, a plane, or negative, a hole.
    """

    radius1: float | None = None
    radius2: float = math.inf
    length: float | None = None
    datum_depth: float | None = None

    @property
    def reduced_radius(self) -> float:
        """R with 1/R = 1/R1 + 1/R2, m."""
        return reduced_radius(self.radius1 if self.radius1 is not None else math.nan, self.radius2)


def contact_modulus(body1: ElasticBody, body2: ElasticBody) -> float:
    """Return the contact modulus E* of two bodies, 1/E* = sum (1 - nu^2)/E, in Pa (Johnson 1985, eq. 4.21)."""
    return 1.0 / sum((1.0 - body.poissons_ratio**2) / body.youngs_modulus for body in (body1, body2))


def reduced_radius(radius1: float, radius2: float) -> float:
    """Return R with 1/R = 1/R1 + 1/R2, m; a plane is inf, a hole negative.

    Raises
    ------
    ValueError
        If the first radius is not positive, or does not fit into the hole.
    """
    if not (0.0 < radius1 < math.inf and radius2 == radius2 and radius2 != 0.0):
        raise ValueError(f"radii must be positive, inf a plane, or negative a hole, got {radius1!r} and {radius2!r}")
    if radius1 < SMALLEST or abs(radius2) < SMALLEST:
        raise ValueError(f"radii below {SMALLEST:g} m are none, got {radius1!r} and {radius2!r}")
    curvature = 1.0 / radius1 + 1.0 / radius2
    if not curvature > 0.0:
        raise ValueError(f"the radius {radius1!r} must be smaller than that of the hole, {-radius2!r}")
    return 1.0 / curvature


def _law(name: str, equation: str, source: str, **details: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Put a function into the table of stiffness laws."""
    details.setdefault("status", QUOTED if details.get("seen") else CHECKED)

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        _OWN[name] = StiffnessLaw(name, function, equation, source=source, **details)
        return function

    return register


def _positive(name: str, value: float) -> float:
    if not SMALLEST <= value < math.inf:
        raise ValueError(f"{name} must be positive, got {value!r}")
    return value


@_law(
    "hertz",
    "F = (4/3) E* sqrt(R) d^(3/2)",
    "johnson-1985",
    limits="spheres, elastic, contact radius small beside R",
    needs=("radius1", "radius2"),
)
def hertz(body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float = math.inf) -> Stiffness:
    """Return the stiffness of two spheres: K = (4/3) E* sqrt(R), n = 3/2, 1/R = 1/R1 + 1/R2.

    Valid for elastic bodies and a contact radius small beside R. ``radius2 = inf`` is a plane.
    Source: Hertz 1882 in Johnson 1985, eq. 4.23. Theory: :eq:`contact-hertz`.

    Returns
    -------
    Stiffness
        K, N/m^1.5, and the exponent 1.5.

    Raises
    ------
    ValueError
        If a radius is not positive.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> law = hertz(material("65Mn"), material("65Mn"), radius1=0.01)
    >>> round(law.stiffness / 1e10, 5), law.exponent
    (1.53389, 1.5)
    """
    k = 4.0 / 3.0 * contact_modulus(body1, body2) * math.sqrt(reduced_radius(radius1, radius2))
    return Stiffness(k, 1.5, "hertz", CHECKED, "johnson-1985")


@_law(
    "palmgren",
    "d = 3.81 [2/(pi E')]^0.9 F^0.9/h^0.8, E' = 2 E*",
    "palmgren",
    limits="steel rollers of bearings; the radius does not enter",
    seen="Li & Ma 2019, eqs (2)-(4); 3.84e-5 Q^0.9/L^0.8 in two codes of bearings",
    note="eq (5) of Li & Ma prints E' upside down, which is repaired here",
    needs=("length",),
)
def palmgren(body1: ElasticBody, body2: ElasticBody, length: float) -> Stiffness:
    """Return the stiffness of a cylinder of length h on a plane or cylinder, n = 10/9.

    d = 3.81 [2 / (pi E')]^0.9 F^0.9 / h^0.8 with E' = 2 / sum((1 - nu^2)/E) = 2 E*, SI units;
    so K = {h^0.8 / (3.81 [2 / (pi E')]^0.9)}^(10/9). The cylinder's radius does not enter.
    Empirical, for steel rollers of bearings. Source: Palmgren as given by Li & Ma 2019, eqs (2)-(4);
    their eq (5) prints E' upside down (a compliance), which is repaired here. Theory: :eq:`contact-palmgren`.

    Returns
    -------
    Stiffness
        K, N/m^(10/9), and the exponent 10/9.

    Raises
    ------
    ValueError
        If the length is not positive.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> law = palmgren(material("65Mn"), material("65Mn"), length=0.04)
    >>> round(law.stiffness / 1e9, 2), round(law.exponent, 4)
    (4.68, 1.1111)
    """
    modulus = 2.0 * contact_modulus(body1, body2)
    compliance = 3.81 * (2.0 / (math.pi * modulus)) ** 0.9 / _positive("the contact length", length) ** 0.8
    return Stiffness(compliance ** (-10.0 / 9.0), 10.0 / 9.0, "palmgren", QUOTED, "palmgren")


@_law(
    "johnson",
    "d = F/(pi E* h) [ln(4 pi E* dR h/F) - 1]",
    "johnson-1985",
    limits="long cylinders, each pressed from its opposite side; F below (pi E* h)(4 dR/e^2)",
    seen="codes that cite eqs (5.57)-(5.58); the tests solve the elastic problem and agree to 0.01 %",
    note="a plane needs a datum depth D: its share is then (1 - nu^2)/(pi E) F/h [2 ln(2 D/a) - nu/(1 - nu)]",
    needs=("radius1", "radius2", "length", "datum_depth"),
)
def johnson(
    body1: ElasticBody,
    body2: ElasticBody,
    radius1: float,
    radius2: float,
    length: float,
    datum_depth: float | None = None,
) -> LogarithmicStiffness:
    """Return the stiffness of two cylinders of length h in line contact, or of one on a plane.

    Each cylinder yields (1 - nu^2)/(pi E) (F/h) [2 ln(4 R_i/a) - 1] from its middle to the contact, where a is the
    Hertz half width, a^2 = 4 F R/(pi E* h); the sum for equal materials is d = F/(pi E* h)[ln(4 pi E* dR h/F) - 1].
    A plane yields (1 - nu^2)/(pi E)(F/h)[2 ln(2 D/a) - nu/(1 - nu)] over the depth D. Source: Johnson 1985,
    eqs (5.57) and (5.58), section 5.6.

    Raises
    ------
    ValueError
        If a size is not positive, or a plane has no datum depth.
    """
    modulus, h = contact_modulus(body1, body2), _positive("the contact length", length)
    slope = math.pi * modulus * h
    width = slope / (4.0 * reduced_radius(radius1, radius2))  # F/a^2
    total = 0.0
    for body, radius in ((body1, radius1), (body2, radius2)):
        share = (1.0 - body.poissons_ratio**2) / body.youngs_modulus * modulus
        if math.isinf(radius):
            if datum_depth is None:
                raise ValueError(
                    "a cylinder on a plane needs a datum depth: how deep the plane body is, for a log has no limit"
                )
            deep = 2.0 * _positive("the datum depth", datum_depth)
            less = body.poissons_ratio / (1.0 - body.poissons_ratio)
        else:
            deep, less = 4.0 * abs(radius), 1.0
        total += share * (math.log(deep * deep * width) - less)
    return LogarithmicStiffness(slope, math.exp(total), "johnson", QUOTED, "johnson-1985")


def _two_cylinders(name: str, radius1: float, radius2: float) -> tuple[float, float]:
    """Return reduced radius and dR, m, or raise ValueError for a plane."""
    if math.isinf(radius2):
        raise ValueError(f"the law {name} has no limit for a plane: take johnson with a datum depth, or palmgren")
    return reduced_radius(radius1, radius2), abs(radius1 + radius2)


@_law(
    "radzimovsky",
    "d = F/(pi E* h) [2/3 + ln(4 R1/b) + ln(4 R2/b)], b^2 = 16 F R/(pi E* h)",
    "radzimovsky-1953",
    limits="two long cylinders",
    seen="code of a review (ladisk/DyS)",
    note="b is the whole width; 2/3 belongs to a parabolic pressure: 2 to 3 % above johnson",
    needs=("radius1", "radius2", "length"),
)
def radzimovsky(
    body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float, length: float
) -> LogarithmicStiffness:
    """Return the stiffness of two cylinders by Radzimovsky 1953.

    b is the whole Hertz width, 2.257 sqrt(F R/(h E*)); the 1.60 in print goes with diameters.

    Raises
    ------
    ValueError
        If a size is not positive, or a radius is that of a plane.
    """
    _, total = _two_cylinders("radzimovsky", radius1, radius2)
    slope = math.pi * contact_modulus(body1, body2) * _positive("the contact length", length)
    load = math.exp(2.0 / 3.0) * total * slope
    return LogarithmicStiffness(slope, load, "radzimovsky", QUOTED, "radzimovsky-1953")


@_law(
    "dubowsky-freudenstein",
    "d = (F S/h) {ln[h^3 dR/(F R1 R2 S)] + 1}, S = sum (1 - nu^2)/(pi E)",
    "dubowsky-freudenstein-1971",
    limits="a pin in a hole",
    seen="code of a review (ladisk/DyS)",
    note="for two cylinders side by side it falls with the radius instead of rising: 15 to 41 % above johnson",
    needs=("radius1", "radius2", "length"),
)
def dubowsky_freudenstein(
    body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float, length: float
) -> LogarithmicStiffness:
    """Return the stiffness of a pin in a hole by Dubowsky & Freudenstein 1971.

    Raises
    ------
    ValueError
        If a size is not positive, or a radius is that of a plane.
    """
    reduced, _ = _two_cylinders("dubowsky-freudenstein", radius1, radius2)
    h = _positive("the contact length", length)
    slope = math.pi * contact_modulus(body1, body2) * h
    load = math.e * h * h / reduced * slope
    return LogarithmicStiffness(slope, load, "dubowsky-freudenstein", QUOTED, "dubowsky-freudenstein-1971")


@_law(
    "lankarani-nikravesh",
    "F = (4/3) E* sqrt(R) d^(3/2)",
    "lankarani-nikravesh-1994",
    limits="meant for cylinders in multibody codes",
    seen="code of a review (ladisk/DyS)",
    note="a law of spheres, without the length: 5 to 20 times too soft for a line contact",
    needs=("radius1", "radius2"),
)
def lankarani_nikravesh_cylinder(body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float) -> Stiffness:
    """Return the stiffness that Lankarani & Nikravesh 1994 give to cylinders: that of spheres of the same radii."""
    k = hertz(body1, body2, radius1, radius2).stiffness
    return Stiffness(k, 1.5, "lankarani-nikravesh", QUOTED, "lankarani-nikravesh-1994")


@_law(
    "pereira",
    "F = (a dR + b) h E*/dR d^n (mm, MPa); side by side .39, .85, n 1.094; in a hole .965, .0965, n = Y dR^-0.005",
    "pereira-2015",
    limits="side by side, or in a hole with 0.005 <= dR <= 10 mm",
    seen="code of a review (ladisk/DyS), which writes n in a hole otherwise",
    note="fitted to Johnson's law; its own damping is that of lankarani-nikravesh; n in a hole from memory",
    needs=("radius1", "radius2", "length"),
)
def pereira(body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float, length: float) -> Stiffness:
    """Return the stiffness of two cylinders by Pereira et al. 2015, F = (a dR + b) h E*/dR d^n in mm, N and MPa.

    A plane (dR = inf) leaves F = a h E* d^n. In a hole Y = 1.51 [ln(1000 dR)]^-0.151 below dR = 0.34954 mm, and
    0.0151 dR + 1.151 above.

    Raises
    ------
    ValueError
        If a size is not positive, or dR lies outside 0.005 to 10 mm in a hole.
    """
    reduced_radius(radius1, radius2)
    total = abs(radius1 + radius2) * 1e3
    modulus, h = contact_modulus(body1, body2) * 1e-6, _positive("the contact length", length) * 1e3
    status, a, b, n = QUOTED, 0.39, 0.85, 1.094
    if radius2 < 0.0:
        if not 0.005 <= total <= 10.0:
            raise ValueError(f"dR must lie within 0.005 to 10 mm in a hole for the law pereira, got {total:g} mm")
        y = 1.51 * math.log(1e3 * total) ** -0.151 if total < 0.34954 else 0.0151 * total + 1.151
        status, a, b, n = FROM_MEMORY, 0.965, 0.0965, y * total**-0.005
    factor = a if math.isinf(total) else a + b / total
    return Stiffness(factor * h * modulus * 1e3**n, n, "pereira", status, "pereira-2015")


def stiffness_laws() -> dict[str, StiffnessLaw]:
    """Return the stiffness laws by name: our own, and those that installed packages add."""
    return with_added(StiffnessLaw, _OWN)


def stiffness_law(name: str, field: str = "law") -> StiffnessLaw:
    """Return a stiffness law by its name, or raise `InputError`, which offers the nearest."""
    return law_named(stiffness_laws(), name, field, "a stiffness law")


def stiffness_of(
    name: str, body1: ElasticBody, body2: ElasticBody, geometry: Geometry, field: str = "law"
) -> Stiffness | LogarithmicStiffness:
    """Return the stiffness of two bodies by a named law.

    Raises
    ------
    InputError
        If no law has that name, a size that it needs is missing, or a size is out of its range; ``field`` names the
        law in the message.
    """
    law = stiffness_law(name, field)
    unknown = [need for need in law.needs if not hasattr(geometry, need)]
    if unknown:
        raise InputError(field, name, f"a law that needs none but {', '.join(GEOMETRY)}", f"it asks for {unknown[0]}")
    sizes = {need: getattr(geometry, need) for need in law.needs}
    missing = [need for need, size in sizes.items() if size is None and need not in OPTIONAL_NEEDS]
    if missing:
        raise InputError(
            missing[0], MISSING, f"the {missing[0].replace('_', ' ')} of the law {name}", f"{name} needs it"
        )
    try:
        stiffness: Stiffness | LogarithmicStiffness = law.function(body1, body2, **sizes)
    except ValueError as error:
        raise InputError(field, name, str(error)) from None
    return stiffness
