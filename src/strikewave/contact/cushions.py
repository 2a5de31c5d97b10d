"""Cushions: laws of pads under blows, materials with sources, energy, set and wear.

A pad of the area A and the thickness h bears F = A s(x) at the compression d = x h, where s is the stress (Pa) that its
material bears at the strain x. So the force goes with the area, and at equal force the compression with the thickness.
All of them give back what they store but `crush`, which keeps a set; what a pad loses besides comes by the hysteresis
of the contact, or by a retardation (`retarded`).

Examples
--------
>>> from strikewave.contact import solve_impact
>>> from strikewave.contact.cushions import Pad, tangent
>>> blow = solve_impact(tangent(Pad(5e-3, 0.02), modulus=2e6, limit_strain=0.8), 10.0, float("inf"), 2.0)
>>> print((blow.max_indentation * 1e3).round(2))
8.38
"""

from __future__ import annotations

import dataclasses
import functools
import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import resources
from typing import Any, NamedTuple, TypeVar

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED
from strikewave.base.errors import InputError, IntegrationError, nearest
from strikewave.contact import _pair_kernels
from strikewave.contact._law_kernels import DAMPING, YIELD_LOAD, base_force, damper_force
from strikewave.contact.damping import factor
from strikewave.contact.impact import Impact, solve_impact
from strikewave.contact.law import (
    AnyContact,
    Contact,
    Damper,
    HardeningContact,
    LogarithmicContact,
    PressureCap,
    check,
    check_end,
    positive,
    single,
)
from strikewave.contact.registry import CushionLaw, law_named, with_added

_OWN: dict[str, CushionLaw] = {}
"""The laws of this module by name; `_law` fills it."""
LARGEST_STRAIN = 1.0
"""Strain at which nothing is left of a pad, -."""


@dataclass(frozen=True)
class Pad:
    """Flat pad between two plane faces, evenly loaded: area A, m^2, and thickness h before any blow, m."""

    area: float
    thickness: float

    def __post_init__(self) -> None:
        for name in ("area", "thickness"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise ValueError(f"the {name} of a cushion must be above zero and finite, got {value!r}")

    @property
    def shape_factor(self) -> float:
        """Loaded area over the area free to bulge, of a disc: sqrt(A/pi)/(2 h)."""
        return math.sqrt(self.area / math.pi) / (2.0 * self.thickness)


Make = TypeVar("Make", bound=Callable[..., AnyContact])


def _law(name: str, equation: str, source: str, **details: Any) -> Callable[[Make], Make]:
    """Put a function into the table of cushion laws."""
    details.setdefault("status", QUOTED if details.get("seen") else CHECKED)

    def register(function: Make) -> Make:
        _OWN[name] = CushionLaw(name, function, equation, source=source, **details)
        return function

    return register


def _check(strain: Mapping[str, float] | None = None, **properties: float) -> None:
    """Refuse a property that is not above zero and finite, and a strain that no pad reaches."""
    for name, value in properties.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"the {name.replace('_', ' ')} must be above zero and finite, got {value!r}")
    for name, value in (strain or {}).items():
        if not 0.0 < value <= LARGEST_STRAIN:
            raise ValueError(f"the {name.replace('_', ' ')} must be above 0 and at most 1, got {value!r}")


@_law(
    "linear",
    "F = A E x",
    "mindlin-1945",
    limits="small strains; x below 1",
    needs=("modulus",),
    note="ours: Hooke's law, one of Mindlin's cases",
)
def linear(pad: Pad, modulus: float) -> Contact:
    """Return a linear pad: k = E A/h.

    A mass m at the speed v makes half a sine: peak v sqrt(k m), duration pi sqrt(m/k).
    """
    _check(modulus=modulus)
    return Contact(modulus * pad.area / pad.thickness, 1.0)


@_law(
    "power",
    "F = A s x^n",
    "mindlin-1945",
    limits="n from 1; x below 1",
    seen="abstract of Boutillon 1988: felt as F = a d^n",
    needs=("stress", "exponent"),
    note="s is the stress that the curve, carried on, reaches at x = 1",
)
def power(pad: Pad, stress: float, exponent: float) -> Contact:
    """Return a pad that bears the stress s x^n: K = A s/h^n.

    A mass m at the speed v presses it to d = ((n + 1) m v^2/(2 K))^(1/(n + 1)). Theory: :eq:`contact-cushion`.

    Returns
    -------
    Contact
        Its stiffness in N/m^n.

    Examples
    --------
    >>> power(Pad(1e-2, 0.01), stress=1e6, exponent=2.0).stiffness
    100000000.0
    """
    _check(stress=stress, exponent=exponent)
    return Contact(stress * pad.area / pad.thickness**exponent, exponent)


@_law(
    "felt",
    "F = A (s x^n + T d(s x^n)/dt)",
    "stulov-2004",
    limits="wool felt; n from 2 to 5; x below 1",
    seen="J. O. Smith, Physical Audio Signal Processing, which cites it; n: Boutillon 1988, Russell & Rossing 1998",
    needs=("stress", "exponent", "retardation"),
    note="n of hammers: 2.1 to 5; industrial felt has its own, measure it",
)
def felt(pad: Pad, stress: float, exponent: float, retardation: float) -> Contact:
    """Return a pad of felt: a power law with the retardation T, s, which makes its loss grow with the speed."""
    elastic = power(pad, stress, exponent)
    return dataclasses.replace(elastic, damper=Damper(retardation, style="retarded")) if retardation else elastic


@_law(
    "tangent",
    "F = A (2 E L/pi) tan(pi x/(2 L))",
    "mindlin-1945",
    limits="foam and rubberized hair that bottom; x below 0.99 L",
    status=FROM_MEMORY,
    needs=("modulus", "limit_strain"),
    note="L is the strain at which the pad is solid; the tests integrate its motion",
)
def tangent(pad: Pad, modulus: float, limit_strain: float) -> HardeningContact:
    """Return a pad of tangent elasticity, which hardens towards the strain L at which it is solid.

    A mass m at the speed v is stopped with F = (2 k l/pi) sqrt(exp(pi^2 m v^2/(4 k l^2)) - 1), k = E A/h, l = L h.
    """
    _check({"limit_strain": limit_strain}, modulus=modulus)
    return HardeningContact("tangent", modulus * pad.area / pad.thickness, limit_strain * pad.thickness)


@_law(
    "elastomer",
    "F = A (E_a/3) [1/(1 - x)^2 - (1 - x)], E_a = E (1 + 2 k S^2)",
    "gent-lindley-1959",
    limits="faces bonded or rough; S below about 5, where bulk compression counts; x below about 0.3",
    seen="E_a in Koblar et al. 2014; k by hardness in a table after Lindley; neo-Hookean stress in a text",
    needs=("modulus",),
    options=("compression_factor", "shape_factor"),
    note="S: loaded over free area, of a disc where not given; k = 1 without filler, about 0.55 at 65 IRHD",
)
def elastomer(
    pad: Pad, modulus: float, compression_factor: float = 1.0, shape_factor: float | None = None
) -> HardeningContact:
    """Return a pad of rubber between faces on which it cannot slip: neo-Hookean, stiffened by its shape.

    Parameters
    ----------
    pad : Pad
        A disc where no shape factor is given.
    modulus : float
        Young's modulus E of the rubber, Pa.
    compression_factor : float, optional
        k of Lindley, -.
    shape_factor : float, optional
        S: loaded area over area free to bulge, -; 0 for faces that slip.
    """
    _check(modulus=modulus)
    shape = pad.shape_factor if shape_factor is None else shape_factor
    if not (0.0 <= shape < math.inf and 0.0 <= compression_factor < math.inf):
        raise ValueError(f"shape and compression factor must not be negative, got {shape!r}, {compression_factor!r}")
    apparent = modulus * (1.0 + 2.0 * compression_factor * shape**2)
    return HardeningContact("elastomer", apparent * pad.area / pad.thickness, pad.thickness)


@_law(
    "foam",
    "F = A E x up to A P, A P up to x = L (1 - 1/D), then A (P/D) L/(L - x), D = 2.3",
    "gibson-ashby-1997",
    limits="foam that comes back; x below 0.99 L",
    status=FROM_MEMORY,
    needs=("modulus", "plateau", "densification"),
    note="P: stress of the plateau; L, about 1 - 1.4 rho/rho_solid (seen in codes): strain towards which it densifies",
)
def foam(pad: Pad, modulus: float, plateau: float, densification: float) -> HardeningContact:
    """Return a pad of foam that buckles at the stress P, densifies towards the strain L, and comes back."""
    _check({"densification": densification}, modulus=modulus, plateau=plateau)
    return HardeningContact(
        "plateau", modulus * pad.area / pad.thickness, densification * pad.thickness, plateau * pad.area
    )


@_law(
    "crush",
    "as foam, unloading with A E/h: the set d - F h/(A E) stays; elastic from where it densifies as steeply",
    "gibson-ashby-1997",
    limits="honeycomb, lead, rigid foam; one way to crush, no rebound of the crushed",
    status=FROM_MEMORY,
    needs=("modulus", "plateau"),
    options=("densification",),
    note="without densification the plateau has no end; unloading and set by perfect plasticity, ours",
)
def crush(pad: Pad, modulus: float, plateau: float, densification: float = math.inf) -> Contact:
    """Return a pad that crushes at the stress P and keeps its set, deeper with each blow that reaches beyond it.

    A rigid one stops a mass m at the speed v with F = A P within m v/F, and keeps m v^2/(2 F).
    """
    _check({} if math.isinf(densification) else {"densification": densification}, modulus=modulus, plateau=plateau)
    cap = PressureCap(plateau * pad.area, "crush", densification * pad.thickness)
    return Contact(modulus * pad.area / pad.thickness, 1.0, cap=cap)


def retarded(contact: AnyContact, retardation: float) -> AnyContact:
    """Return a contact with a retardation T: F(d) + T F'(d) d', about the force at the compression a time T ahead.

    At a small swing of the frequency f about any compression its loss factor is 2 pi f T.

    Raises
    ------
    ValueError
        If the contact keeps a set, or loses energy in another way.
    """
    if isinstance(contact, LogarithmicContact) or contact.cap is not None or contact.damper is not None:
        raise ValueError("a retardation is for a cushion that comes back and has none of its own")
    return dataclasses.replace(contact, damper=Damper(retardation, style="retarded"))


def retardation_of(loss_factor: float, frequency: float) -> float:
    """Return the retardation that has a loss factor at a frequency, eta/(2 pi f), s."""
    return loss_factor / (2.0 * math.pi * frequency)


def solid_strain(relative_density: float) -> float:
    """Return the strain towards which a foam densifies, 1 - 1.4 rho/rho_solid (Gibson & Ashby)."""
    return 1.0 - 1.4 * relative_density


def cushion_laws() -> dict[str, CushionLaw]:
    """Return the cushion laws by name: our own, and those that installed packages add."""
    return with_added(CushionLaw, _OWN)


def cushion_law(name: str, field: str = "law") -> CushionLaw:
    """Return a cushion law by its name, or raise `InputError`, which offers the nearest."""
    return law_named(cushion_laws(), name, field, "a cushion law (`strikewave laws`)")


@dataclass(frozen=True)
class CushionMaterial:
    """Cushion material at room temperature, pressed slowly."""

    name: str
    law: str
    """Name of its cushion law."""
    properties: Mapping[str, float]
    """Known properties, SI, by their names in the law; missing ones must be given."""
    source: str
    status: str
    """``checked``, ``quoted`` or ``from memory``."""
    note: str


@functools.cache
def cushion_materials() -> dict[str, CushionMaterial]:
    """Return all cushion materials by name, in the order of the table."""
    text = (resources.files("strikewave.contact") / "cushions.toml").read_text("utf-8")
    return {name: CushionMaterial(name=name, **row) for name, row in tomllib.loads(text).items()}


def cushion_material(name: str, field: str = "material") -> CushionMaterial:
    """Return a cushion material by its name, in any case, or raise `InputError`, which offers the nearest."""
    folded = {known.lower(): known for known in cushion_materials()}
    if name.lower() not in folded:
        raise InputError(field, name, "a cushion material (docs/cushions.md)", nearest(name, cushion_materials()))
    return cushion_materials()[folded[name.lower()]]


_STRESSES = ("modulus", "stress", "plateau")  # a strain or an exponent does not change as the material settles
"""Properties that stiffen as a cushion wears: all that are stresses."""


@dataclass(frozen=True)
class Wear:
    """Change of a cushion with each blow."""

    settling: float = 0.0
    """Share of its thickness that a blow takes."""
    stiffening: float = 0.0
    """Share by which a blow raises its moduli and stresses."""

    def __post_init__(self) -> None:
        if not (0.0 <= self.settling < 1.0 and 0.0 <= self.stiffening < math.inf):
            raise ValueError(f"a cushion wears by shares of at least 0, settling below 1, got {self}")

    def thickness_left(self, blows: float) -> float:
        """Return the share of its thickness left after N blows, (1 - settling)^N."""
        return float((1.0 - self.settling) ** blows)

    def stiffened(self, blows: float) -> float:
        """Return the factor of its moduli and stresses after N blows, (1 + stiffening)^N."""
        return float((1.0 + self.stiffening) ** blows)


@dataclass(frozen=True)
class Cushion:
    """Cushion before any blow: its law, its pad, its material, its loss of energy and its wear."""

    law: str
    """Name of a cushion law."""
    pad: Pad
    properties: Mapping[str, float]
    """Properties that the law needs, SI, by name."""
    wear: Wear = field(default_factory=Wear)
    retardation: float = 0.0
    """T of `retarded`, s."""

    def after(self, blows: int) -> Cushion:
        """Return the cushion worn by some blows; the set of one that crushes is not in it."""
        stiffer = self.wear.stiffened(blows)
        pad = Pad(self.pad.area, self.pad.thickness * self.wear.thickness_left(blows))
        properties = {key: value * (stiffer if key in _STRESSES else 1.0) for key, value in self.properties.items()}
        return dataclasses.replace(self, pad=pad, properties=properties)

    def contact(self, damping: str = "exact", restitution: float = 1.0) -> AnyContact:
        """Return its force law with the hysteresis of a damping law; a value outside the law's range is refused."""
        made: AnyContact = cushion_law(self.law).function(self.pad, **self.properties)
        if self.retardation:
            made = retarded(made, self.retardation)
        chi = float(factor(damping, restitution))
        lossy = dataclasses.replace(made, hysteresis_factor=chi) if chi else made
        check(lossy)
        return lossy


class CushionBalance(NamedTuple):
    """Energies of a blow on a cushion, J, and the compression that stays, m."""

    taken: NDArray[np.float64]
    """Kinetic energy of the approach."""
    stored: NDArray[np.float64]
    """Energy in the cushion at its largest compression."""
    lost: NDArray[np.float64]
    """Energy that does not come back."""
    returned: NDArray[np.float64]
    """Kinetic energy of the rebound."""
    set: NDArray[np.float64]


def balance_of(impact: Impact) -> CushionBalance:
    """Return the energies of an impact on a cushion."""
    problem = impact.problem
    taken = (0.5 * problem.mass * problem.speed**2).reshape(problem.shape)
    stored, depth = np.empty(problem.mass.size), impact.max_indentation.reshape(-1)
    _pair_kernels.energies(problem.laws, depth, np.maximum(impact.deepest, 0.0).reshape(-1), stored)
    returned = taken - impact.energy_lost
    return CushionBalance(
        taken, stored.reshape(problem.shape), impact.energy_lost, returned, impact.residual_indentation
    )


def repeated_blows(
    cushion: Cushion, mass: float, speed: float, count: int, damping: str = "exact", restitution: float = 1.0
) -> list[Impact]:
    """Return equal blows of a mass on a fixed cushion, one after the other: it wears, and keeps its set."""
    made: list[Impact] = []
    deepest = 0.0
    for blow in range(count):
        worn = cushion.after(blow).contact(damping, restitution)
        made.append(solve_impact(worn, mass, math.inf, speed, deepest=deepest))
        deepest = max(deepest, float(made[-1].deepest))
    return made


Array = NDArray[np.float64]

TOLERANCE = 1e-8  # far below what is known of any cushion
"""Relative error of a step."""
_SCALE_SHARE = 1e-8
"""Absolute error of a step over the way and speed that the surface makes."""
_LONGEST_SHARE = 0.5  # a step that is longer than the pulse could miss it
"""Longest step over the width of the surface's pulse, the integral of |a| over its largest value."""


class Carried(NamedTuple):
    """Acceleration of a carried mass, m/s^2, and compression of its cushion, m, at each sample."""

    acceleration: Array
    compression: Array


def carried(contact: AnyContact, mass: float, acceleration: ArrayLike, step: float) -> Carried:
    """Return the motion of a mass that rests on a cushion on a surface that moves; its weight is left out.

    d'' = a - F(d, d')/m with d the compression, a the acceleration of the surface, straight between samples. The
    cushion pushes only: where the surface falls back the mass flies.

    Parameters
    ----------
    contact : Contact or HardeningContact
        A cushion that comes back, with or without a retardation.
    mass : float
        m, kg.
    acceleration : array_like
        a of the surface, m/s^2, from rest; shape (N,).
    step : float
        Time between samples, s.

    Raises
    ------
    ValueError
        If the cushion keeps a set, or loses by hysteresis, for which nothing approaches.
    IntegrationError
        If it bottoms out.

    Notes
    -----
    Source: Newton's law; the embedded Runge-Kutta rule of Dormand & Prince (Hairer, Norsett & Wanner 1993).

    Examples
    --------
    A surface that is accelerated at once and for good throws a mass on a linear cushion to twice its acceleration:

    >>> from strikewave.contact import Contact
    >>> motion = carried(Contact(1e6, 1.0), 1.0, np.full(101, 100.0), step=1e-4)
    >>> print(motion.acceleration.max().round(1))
    200.0
    """
    law, m, h = single(contact), float(positive("the mass", mass)), float(positive("the step", step))
    surface = np.asarray(acceleration, dtype=float)
    if law[YIELD_LOAD] < np.inf or law[DAMPING]:
        raise ValueError("a carried mass takes a cushion that comes back, without hysteresis: give a retardation")
    times = h * np.arange(surface.size)
    if surface.size < 2 or not np.any(surface):
        return Carried(np.zeros(surface.size), np.zeros(surface.size))

    def force(d: float, rate: float) -> float:  # a cushion pushes only, while it is pressed
        return float(max(base_force(law, d) + damper_force(law, d, rate), 0.0)) if d > 0.0 else 0.0

    def rates(t: float, y: Array) -> tuple[float, float]:
        place = t / h
        k = min(int(place), surface.size - 2)
        base = surface[k] + (place - k) * (surface[k + 1] - surface[k])
        return y[1], base - force(y[0], y[1]) / m

    speed = float(np.sum(np.abs(surface))) * h  # the largest speed that the surface can reach: it scales the errors
    scales = _SCALE_SHARE * np.array([speed * times[-1], speed])
    longest = _LONGEST_SHARE * speed / float(np.abs(surface).max())
    start = (0.0, times[-1]), [0.0, 0.0]
    motion = scipy.integrate.solve_ivp(rates, *start, "RK45", times, rtol=TOLERANCE, atol=scales, max_step=longest)
    if not motion.success:
        raise IntegrationError(f"the mass on its cushion could not be followed: {motion.message}")
    d, rate = motion.y
    check_end(contact, float(d.max()))
    pushed = np.array([force(float(x), float(v)) for x, v in zip(d, rate, strict=True)])
    return Carried(pushed / m, np.maximum(d, 0.0))
