"""Elastic-plastic contacts: elastic up to yield, the Hertz pressure then capped, unloading on a flattened radius.

Thornton (1997) cuts the Hertz pressure of a sphere off at a largest value p. With the width still that of the elastic
contact at the same depth, the force is F = F_y + pi p R (d - d_y). The same cut through the Hertz pressure of a line,
p(x) = (E*/2R)(a^2 - x^2)^(1/2), leaves

    F/h = (E*/2R) [a^2 asin(a_y/a) + a_y (a^2 - a_y^2)^(1/2)],    a_y = 2 p R/E*,

whose mean pressure rises from pi p/4 at yield towards p. Over the elastic force F_e at the same depth, q = F_e/F_y,
both are functions of q alone: 3/2 q^(2/3) - 1/2 of a sphere, (2/pi)[q asin(1/sqrt(q)) + sqrt(q - 1)] of a line.

Unloading is elastic with the radius s R that has the same width under the force reached: s = F_e/F. By similarity the
force is F_e(s (d - d_r))/s and the depth that stays d_r = D (1 - 1/s), D the largest depth. A later blow loads along
this line up to D, and yields on from there. For a sphere this is Thornton's unloading; the line law is derived here
from his argument and from Johnson's elastic line contact (1985, sections 4.2 and 5.6).
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.citations import CHECKED, QUOTED
from strikewave.contact import _pair_kernels
from strikewave.contact.law import AnyContact, PressureCap, flat, not_negative, positive, refuse, rows_beside, single
from strikewave.contact.registry import CapLaw
from strikewave.contact.stiffness import ElasticBody, Geometry, contact_modulus, reduced_radius

Array = NDArray[np.float64]


class PlasticBody(ElasticBody, Protocol):
    """An elastic body with a yield strength and an indentation hardness, Pa, each None where it is not known."""

    @property
    def yield_strength(self) -> float | None:
        """Yield strength, Pa."""

    @property
    def hardness(self) -> float | None:
        """Mean pressure of a fully plastic ball indentation, Pa."""


# Source: the finite elements of Jackson & Green 2005; Tabor and slip lines give 2.8 to 3 (from memory).
HARDNESS_OVER_YIELD = 2.84
"""Hardness over yield strength of a metal that does not harden."""
HARDENED_OVER_YIELD = 5.2
"""Hardness over yield strength of a metal that hardens strongly, the highest taken where only the yield strength is
known: hot-rolled AISI 1045, 163 HB and 45 000 psi (310 MPa), in a maker's table of estimated least values
(Mechanical Properties of Steel, scribd.com/document/360049537). Annealed copper hardens more: give its hardness."""
# A ball pressed in by d cuts the plane at a^2 = 2 R d, while Hertz has a^2 = R d. Of a line, ln(4 R/a) - 1/2 in place
# of 2 for the square of the width: 2.2 to 1.8 in width from a/R = 0.02 to 0.1.
PLASTIC_AREA = 2.0
"""Area of a fully plastic spot over that of the elastic one at the same depth."""
PILED_UP_AREA = 8.0 / 3.0  # the force of Jackson & Green 2005 tends to (8/3) pi R H d
"""The same where the metal does not harden and piles up round the spot."""
# A thousand times the modulus of diamond, so that only a wrong unit gets there; its cube, in the yield load, is far
# from overflow.
LARGEST_PRESSURE = 1e15
"""Largest pressure, Pa."""


def point_cap(
    body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float, pressure: ArrayLike
) -> PressureCap:
    """Return the cap of a sphere: F_y = pi^3 p^3 R^2/(6 E*^2). Source: Thornton 1997.

    ``pressure`` p (Pa) is the largest that the contact bears: 1.6 times the yield strength at first yield inside;
    `automatic_pressure` gives that of a fully plastic contact.
    """
    radius, modulus = reduced_radius(radius1, radius2), contact_modulus(body1, body2)
    return PressureCap(np.pi**3 * _pressure(pressure) ** 3 * radius**2 / (6.0 * modulus**2), "point")


def line_cap(
    body1: ElasticBody, body2: ElasticBody, radius1: float, radius2: float, length: float, pressure: ArrayLike
) -> PressureCap:
    """Return the cap of a line contact of length h: F_y = pi R h p^2/E*. Source: see the module.

    ``pressure`` p (Pa) is the largest that the contact bears: about 1.8 times the yield strength at first yield inside
    (`line_yield_pressure`); `automatic_pressure` gives that of a fully plastic contact.
    """
    radius, modulus = reduced_radius(radius1, radius2), contact_modulus(body1, body2)
    return PressureCap(np.pi * radius * length * _pressure(pressure) ** 2 / modulus, "line")


def cap_of(body1: ElasticBody, body2: ElasticBody, geometry: Geometry, pressure: ArrayLike) -> PressureCap:
    """Return the cap of a line where the geometry has a length, of spheres where not.

    Raises
    ------
    ValueError
        If the geometry has no radius, or the pressure is none that a body bears.
    """
    radius1 = math.nan if geometry.radius1 is None else geometry.radius1
    if geometry.length is None:
        return point_cap(body1, body2, radius1, geometry.radius2, pressure)
    return line_cap(body1, body2, radius1, geometry.radius2, geometry.length, pressure)


CAP_LAWS = {
    law.name: law
    for law in (
        CapLaw(
            "thornton",
            point_cap,
            "F = F_y + pi p R (d - d_y), F_y = pi^3 p^3 R^2/(6 E*^2), s = F_e/F, d_r = D (1 - 1/s)",
            "spheres, elastic and perfectly plastic, no hardening and no rate",
            QUOTED,
            "thornton-1997",
            "codes that cite it (loading, yield load and speed); its e(v) by our own integration, in the tests",
            "unloading on the radius s R by similarity, which is Thornton's",
        ),
        CapLaw(
            "line",
            line_cap,
            "F = (2/pi) F_y [q asin(1/sqrt(q)) + sqrt(q - 1)], q = F_e/F_y, F_y = pi R h p^2/E*, s, d_r as thornton",
            "long cylinders, elastic and perfectly plastic, no hardening and no rate",
            CHECKED,
            "thornton-1997",
            "ours: Thornton's cut through the Hertz pressure of a line (Johnson 1985, 4.2); the tests integrate it",
            "no published law of a line with unloading was found",
        ),
    )
}
"""The pressure caps by name, as `strikewave laws` shows them; which one holds follows from the shape of the contact."""


def cap_law_of(cap: PressureCap) -> CapLaw:
    """Return the law of a cap, by the shape of its contact."""
    return CAP_LAWS["thornton" if cap.shape == "point" else "line"]


def _pressure(pressure: ArrayLike) -> Array:
    """Return pressures as an array, or raise ValueError where one is no pressure that a body bears."""
    p = np.asarray(pressure, dtype=float)
    refuse("the pressure", p, (p > 0.0) & (p <= LARGEST_PRESSURE), f"positive and at most {LARGEST_PRESSURE:g} Pa")
    return p


def line_yield_pressure(body: ElasticBody, yield_strength: float) -> float:
    """Return the Hertz pressure at which a line contact first yields inside, p0 = C sigma_y, Pa.

    C = 1/sqrt(1 + 4 (nu - 1) nu) up to nu = 0.1938, 1.164 + 2.975 nu - 2.906 nu^2 above (von Mises). Source:
    Green 2005.
    """
    nu = body.poissons_ratio
    if nu <= 0.1938:
        return yield_strength / math.sqrt(1.0 + 4.0 * (nu - 1.0) * nu)
    return (1.164 + 2.975 * nu - 2.906 * nu * nu) * yield_strength


def point_yield_pressure(body: ElasticBody, yield_strength: float) -> float:
    """Return the Hertz pressure at which a sphere first yields inside, p0 = C sigma_y, Pa.

    C = 1.30075 + 0.87825 nu + 0.54373 nu^2 (von Mises). Source: the stress below the middle of a Hertz contact, in
    which the tests find it to 0.1 %; the polynomial is that of Green 2005, from memory.
    """
    nu = body.poissons_ratio
    return (1.30075 + 0.87825 * nu + 0.54373 * nu * nu) * yield_strength


class FirstYield(NamedTuple):
    """First yield inside the weaker of two bodies: Hertz pressure, Pa, and load, N."""

    pressure: float
    load: float


def first_yield(body1: PlasticBody, body2: PlasticBody, geometry: Geometry) -> FirstYield | None:
    """Return where a contact first yields: that of a line where the geometry has a length, of spheres where not.

    None where no radius or no yield strength is known.
    """
    strengths = [(body, body.yield_strength) for body in (body1, body2) if body.yield_strength is not None]
    if geometry.radius1 is None or not strengths:
        return None
    yield_pressure = point_yield_pressure if geometry.length is None else line_yield_pressure
    pressure = min(yield_pressure(body, strength) for body, strength in strengths)
    return FirstYield(pressure, float(np.asarray(cap_of(body1, body2, geometry, pressure).yield_load)))


class AutomaticPressure(NamedTuple):
    """Cap p on the contact pressure from hardness, Pa: the best estimate and its range."""

    best: float
    low: float
    high: float


def hardness_of(body: PlasticBody) -> float | None:
    """Return the indentation hardness of a body, Pa, by its yield strength where it is not given; None without both."""
    if body.hardness is not None or body.yield_strength is None:
        return body.hardness
    return HARDNESS_OVER_YIELD * body.yield_strength


def automatic_pressure(body1: PlasticBody, body2: PlasticBody) -> AutomaticPressure:
    """Return the cap p that the softer of two metals gives, with its range, Pa: p = 2 H, from H up.

    The cap cuts the pressure of an *elastic* spot, whose area at a depth d is pi R d, so that the force tends to
    pi R p d. A fully plastic spot bears the hardness H on the area that the ball cuts from the plane, 2 pi R d
    (`PLASTIC_AREA`), so its force 2 pi R H d asks for p = 2 H. With H = 2.84 sigma_y this p holds the peak force of
    the finite elements of Jackson & Green (2005) to 16 % from first yield to a spot of 0.4 R, and to 5 % beyond 100
    times the depth of first yield; p = H is up to 31 % low, and p at first yield, 1.6 sigma_y, up to 48 %.

    The range: from H, no wider spot than the elastic one, up to (8/3) H where the hardness is known and the metal piles
    up without hardening (`PILED_UP_AREA`), or to 2 H of a metal that hardens strongly where only the yield strength is
    known (`HARDENED_OVER_YIELD`). All are static: a rate raises H, and no rate is taken in. For a line the same
    factors stand, by the width of its spot.

    Raises
    ------
    ValueError
        If a body has neither hardness nor yield strength.
    """
    hardnesses = hardness_of(body1), hardness_of(body2)
    if hardnesses[0] is None or hardnesses[1] is None:
        raise ValueError("a body without hardness and without yield strength gives no cap on the pressure")
    softer = body1 if hardnesses[0] <= hardnesses[1] else body2
    hardness = min(hardnesses[0], hardnesses[1])
    of_yield = PLASTIC_AREA * HARDENED_OVER_YIELD / HARDNESS_OVER_YIELD
    high = PILED_UP_AREA if softer.hardness is not None else of_yield
    return AutomaticPressure(PLASTIC_AREA * hardness, hardness, high * hardness)


def yield_speed(contact: AnyContact, mass: ArrayLike) -> Array:
    """Return the approach speed above which a contact yields, sqrt(2 W(d_y)/m), m/s; without hysteresis.

    For a sphere it is Thornton's 3.194 sqrt(p^5 R^3/(E*^4 m)).

    Raises
    ------
    ValueError
        If the contact has no cap.
    """
    if contact.cap is None:
        raise ValueError("a contact without a pressure cap does not yield")
    laws, shape = rows_beside(contact, mass)
    depth, energy = np.empty((2, len(laws)))
    _pair_kernels.depths_at_yield(laws, depth)
    _pair_kernels.energies(laws, depth, depth, energy)
    return np.asarray(np.sqrt(2.0 * energy.reshape(shape) / positive("the mass", mass)))


def thornton_restitution(speed_ratio: ArrayLike) -> Array:
    """Return the restitution of an elastic-plastic sphere over its approach speed v/v_y; 1 up to v_y.

    e = (6 sqrt(3)/5)^(1/2) [1 - s^2/6]^(1/2) {s/[s + 2 sqrt(6/5 - s^2/5)]}^(1/4), s = v_y/v. Source: the integral of
    the law `thornton`, in closed form, which the tests compare with the integrator's; Thornton 1997 was not opened.
    Theory: :eq:`contact-yield`.

    Returns
    -------
    ndarray
        Coefficient of restitution, in the shape of the input.

    Examples
    --------
    >>> print(thornton_restitution([0.5, 1.0, 10.0, 100.0]).round(4))
    [1.     1.     0.6586 0.3743]
    """
    s = 1.0 / np.maximum(not_negative("the speed", speed_ratio), 1.0)
    share = s / (s + 2.0 * np.sqrt(1.2 - 0.2 * s * s))
    return np.asarray(np.sqrt(1.2 * np.sqrt(3.0) * (1.0 - s * s / 6.0)) * share**0.25)


class YieldedSpot(NamedTuple):
    """A spot after a blow: slope of the force on the way back (N/m), indentation that stays (m), radius over before."""

    stiffness: float
    residual_indentation: float
    flattening: float


def spot_after(contact: AnyContact, indentation: float, deepest: float) -> YieldedSpot:
    """Return the spot that a blow to an indentation leaves after yielding to a depth, both m."""
    out = np.empty((4, 1))
    out[0] = deepest
    laws = single(contact)[None]
    _pair_kernels.spots(laws, out[0], out[1], out[2])
    _pair_kernels.slopes_back(laws, np.array([indentation]), out[0], out[3])
    return YieldedSpot(float(out[3, 0]), float(out[1, 0]), float(out[2, 0]))


def slow_force(contact: AnyContact, indentation: ArrayLike, deepest: ArrayLike = 0.0) -> Array:
    """Return the force of a contact pressed slowly to an indentation, m, without hysteresis or damper, N.

    Beyond the depth ``deepest`` to which the spot has yielded, m, it yields on.
    """
    laws, shape = rows_beside(contact, indentation, deepest)
    out = np.empty(len(laws))
    _pair_kernels.slow_forces(laws, flat(indentation, shape), flat(deepest, shape), out)
    return out.reshape(shape)
