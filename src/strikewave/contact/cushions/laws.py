"""Cushion laws: the force of a pad over its compression. One law, one short function of stress over strain.

A pad of the area A and the thickness h bears F = A s(x) at the compression d = x h, where s is the stress (Pa) that its
material bears at the strain x. So the force goes with the area, and at equal force the compression with the thickness.
All of them give back what they store but `crush`, which keeps a set; what a pad loses besides comes by the hysteresis
of the contact, or by a retardation (`retarded`).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from strikewave.contact.law import AnyContact, Contact, Damper, HardeningContact, LogarithmicContact, PressureCap
from strikewave.contact.registry import CHECKED, FROM_MEMORY, QUOTED, CushionLaw, law_named, with_added

_OWN: dict[str, CushionLaw] = {}
"""The laws of this module by name; `_law` fills it."""
LARGEST_STRAIN = 1.0
"""Strain at which nothing is left of a pad, -."""


@dataclass(frozen=True)
class Pad:
    """A flat pad between two plane faces, with its load spread evenly over it.

    Parameters
    ----------
    area : float
        A, m^2.
    thickness : float
        h before any blow, m.

    Examples
    --------
    >>> round(Pad(area=7.854e-3, thickness=0.0125).shape_factor, 3)
    2.0
    """

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


def _positive(**properties: float) -> None:
    """Refuse a property that is not above zero and finite."""
    for name, value in properties.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"the {name.replace('_', ' ')} must be above zero and finite, got {value!r}")


def _strain(**strains: float) -> None:
    """Refuse a strain that no pad reaches."""
    for name, value in strains.items():
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

    Examples
    --------
    >>> linear(Pad(1e-2, 0.01), modulus=1e6).stiffness
    1000000.0
    """
    _positive(modulus=modulus)
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
    _positive(stress=stress, exponent=exponent)
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
    """Return a pad of felt: a power law with the retardation T, s, which makes its loss grow with the speed.

    Examples
    --------
    >>> felt(Pad(1e-2, 0.01), stress=1e6, exponent=2.5, retardation=20e-6).damper.style
    'retarded'
    """
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

    Examples
    --------
    >>> print(tangent(Pad(1e-2, 0.01), modulus=1e6, limit_strain=0.8).limit)
    0.008
    """
    _positive(modulus=modulus)
    _strain(limit_strain=limit_strain)
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

    Examples
    --------
    >>> soft = elastomer(Pad(7.854e-3, 0.0125), modulus=1e6, shape_factor=0.0)
    >>> print(round(soft.stiffness), round(elastomer(Pad(7.854e-3, 0.0125), modulus=1e6).stiffness / soft.stiffness, 2))
    628320 9.0
    """
    _positive(modulus=modulus)
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
    """Return a pad of foam that buckles at the stress P, densifies towards the strain L, and comes back.

    Examples
    --------
    >>> pad = foam(Pad(1e-2, 0.05), modulus=1e6, plateau=5e4, densification=0.9)
    >>> print(pad.plateau, round(pad.limit, 3))
    500.0 0.045
    """
    _positive(modulus=modulus, plateau=plateau)
    _strain(densification=densification)
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

    Examples
    --------
    >>> from strikewave.contact import solve_impact
    >>> blow = solve_impact(crush(Pad(1e-3, 0.05), modulus=1e9, plateau=1e6), 1.0, math.inf, 4.0)
    >>> print(blow.peak_force.round(3), (blow.residual_indentation * 1e3).round(3))
    1000.0 7.975
    """
    _positive(modulus=modulus, plateau=plateau)
    if not math.isinf(densification):
        _strain(densification=densification)
    cap = PressureCap(plateau * pad.area, "crush", densification * pad.thickness)
    return Contact(modulus * pad.area / pad.thickness, 1.0, cap=cap)


def retarded(contact: AnyContact, retardation: float) -> AnyContact:
    """Return a contact with a retardation T: F(d) + T F'(d) d', about the force at the compression a time T ahead.

    At a small swing of the frequency f about any compression its loss factor is 2 pi f T.

    Raises
    ------
    ValueError
        If the contact keeps a set, or loses energy in another way.

    Examples
    --------
    >>> retarded(linear(Pad(1e-2, 0.01), modulus=1e6), 1e-5).damper
    Damper(coefficient=1e-05, exponent=0.0, style='retarded')
    """
    if isinstance(contact, LogarithmicContact) or contact.cap is not None or contact.damper is not None:
        raise ValueError("a retardation is for a cushion that comes back and has none of its own")
    return dataclasses.replace(contact, damper=Damper(retardation, style="retarded"))


def retardation_of(loss_factor: float, frequency: float) -> float:
    """Return the retardation that has a loss factor at a frequency, eta/(2 pi f), s.

    Examples
    --------
    >>> round(retardation_of(0.2, 1e3) * 1e6, 2)
    31.83
    """
    return loss_factor / (2.0 * math.pi * frequency)


def solid_strain(relative_density: float) -> float:
    """Return the strain towards which a foam densifies, 1 - 1.4 rho/rho_solid (Gibson & Ashby).

    Examples
    --------
    >>> round(solid_strain(0.05), 3)
    0.93
    """
    return 1.0 - 1.4 * relative_density


def cushion_laws() -> dict[str, CushionLaw]:
    """Return the cushion laws by name: our own, and those that installed packages add.

    Examples
    --------
    >>> list(cushion_laws())
    ['linear', 'power', 'felt', 'tangent', 'elastomer', 'foam', 'crush']
    """
    return with_added(CushionLaw, _OWN)


def cushion_law(name: str, field: str = "law") -> CushionLaw:
    """Return a cushion law by its name.

    Raises
    ------
    InputError
        If no law has that name; the nearest is offered.
    """
    return law_named(cushion_laws(), name, field, "a cushion law (`strikewave laws`)")
