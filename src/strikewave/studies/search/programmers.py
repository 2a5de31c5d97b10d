"""Programmers of a drop table, which shape its pulse: their given properties, and the closed forms of their size.

A programmer is a spring of a rate that is chosen ("linear"), or a pad of a cushion law or material of which diameters
are tried and the thickness is chosen. The table of the mass m meets it at the speed v and leaves it at e v.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from scipy.optimize import brentq
from scipy.special import beta, betainc

from strikewave.base import declare
from strikewave.base.declare import MAIN, NOT_MEASURED
from strikewave.base.errors import InputError, nearest
from strikewave.base.shock_quantities import LENGTH, VELOCITY
from strikewave.base.units import typed_number
from strikewave.cases.case import Case, document_of
from strikewave.cases.contact_parts import PROPERTIES
from strikewave.cases.tables.contact import CUSHION, POWER
from strikewave.contact.cushions import Cushion, Pad, cushion_law, cushion_laws, cushion_material, cushion_materials
from strikewave.contact.law import HardeningContact, indentation_under

LINEAR = "linear"  # spring of a rate that is chosen
DEFAULTS = (
    "linear, restitution=1",
    "natural rubber 65 IRHD, restitution=0.75",
    "natural rubber 75 IRHD, restitution=0.75",
    "felt, stress=20 MPa, exponent=2.5, retardation=20 us",
)
"""Programmers that are tried unless others are asked for. All of it is assumed, but for the moduli of the rubber: a
spring without loss, as gas springs and elastic strike surfaces nearly are; the coefficient of restitution of
iec-60068-2-27-rubber; a felt with the exponent of hammer felts, since no source has one of an industrial felt."""
OF_A_PAD = (*PROPERTIES, "loss_factor", "loss_frequency")  # properties that may be given of a pad
LARGEST_STRAINS = {"elastomer": 0.3, "linear": 0.3}
"""Strain up to which a law holds, where the law has no end of its own; of others `FULL` of their end."""
FULL = 0.9  # largest strain over that at which a law ends: a maker's pad may be thinner or softer by the last tenth
LARGEST_SHAPE_FACTOR = 5.0
"""Shape factor beyond which bulk compression counts, which the law of an elastomer leaves out (docs/cushions.md)."""
THINNEST, THICKEST = 0.2e-3, 0.2  # least and largest thickness of a pad, m: a sheet of paper, and a block


@declare.dataclass
class Programmer:
    """A programmer: ``linear``, a cushion law, or a cushion material, with its given properties.

    Attributes
    ----------
    given : mapping of str to str
        Restitution and properties as typed.
    own : bool
        True if it is one of `DEFAULTS`, all of which is assumed.
    table : mapping or None
        The table [contact] of the case whose pad it is; None of others.
    """

    name: str = declare.word(
        "name of the programmer", key="programmer", label="programmer", column=MAIN, headline="programmer"
    )
    given: Mapping[str, str]
    own: bool = False
    table: Mapping[str, Any] | None = None

    @property
    def is_pad(self) -> bool:
        """True if it is a pad, of which diameter and thickness are chosen."""
        return self.name != LINEAR

    @property
    def assumed(self) -> bool:
        """True if its law is assumed altogether: a pad that is tried by default without a material."""
        return self.own and self.is_pad and self.name not in cushion_materials()

    @declare.computed(declare.word("law of its force"))
    def law(self) -> str:
        """Law of the force."""
        if not self.is_pad:
            return POWER
        if self.table is not None:
            pad = self.table["cushion"]
            return pad.get("law") or cushion_material(pad["material"]).law
        return cushion_material(self.name).law if self.name in cushion_materials() else self.name

    @property
    def restitution(self) -> str:
        """Coefficient of restitution of its contact as typed; 1 where none is given, as a retardation needs."""
        return self.given.get("restitution", "1")

    def contact_table(self, diameter: float | None, slowest: Any) -> dict[str, Any]:
        """Return the table [contact] of a case with it; its size is put in by the search."""
        size = {"value": f"{(diameter or 0.0) * 1e3:.10g} mm", "provenance": "assumed", "note": "one of those tried"}
        if self.table is not None:
            pad = {key: value for key, value in self.table["cushion"].items() if key != "area"}
            return {**self.table, "cushion": {**pad, "diameter": size, "thickness": "1 mm"}}
        why = "one of the programmers that are tried by default" if self.own else "asked for by --programmer"

        def stated(typed: str) -> dict[str, Any]:
            number = typed_number(typed)
            return {"value": typed if number is None else number, "provenance": "assumed", "note": why}

        table: dict[str, Any] = {"law": CUSHION if self.is_pad else POWER, "slowest_approach": slowest}
        table["restitution"] = stated(self.restitution)
        if diameter is None:
            return table | {
                "reference_force": "1 kN",
                "reference_depth": {"value": "1 mm", "provenance": "assumed", "note": "the rate is force over depth"},
                "exponent": {"value": 1, "provenance": "assumed", "note": "linear"},
            }
        kind = "material" if self.name in cushion_materials() else "law"
        properties = {key: stated(typed) for key, typed in self.given.items() if key != "restitution"}
        table["cushion"] = {kind: self.name, **properties, "diameter": size, "thickness": "1 mm"}
        return table


def pad_of_case(case: Case) -> Programmer | None:
    """Return the pad of a case as a programmer, with its material, loss and provenance; None where it has none.

    Examples
    --------
    >>> from strikewave.cases.case import load_case
    >>> pad_of_case(load_case("iec-60068-2-27-rubber")).name, pad_of_case(load_case("jesd22-b111-b"))
    ('pad of iec-60068-2-27-rubber', None)
    """
    table = document_of(case).get("contact", {})
    if table.get("law") != CUSHION or "cushion" not in table:
        return None
    pad = Programmer(f"pad of {case.name or 'the case'}", {}, table=table)
    return None if pad.law == "crush" else pad


def read_programmer(word: str, own: bool = False, field: str = "--programmer") -> Programmer:
    """Read a programmer: a name, then what is given of it."""
    name, *parts = (part.strip() for part in word.split(","))
    known = [LINEAR, *(law for law in cushion_laws() if law not in (LINEAR, "crush")), *cushion_materials()]
    if name not in known:
        raise InputError(field, word, "linear, a cushion law, or a cushion material", nearest(name, known))
    given: dict[str, str] = {}
    for part in parts:
        key, equals, typed = (piece.strip() for piece in part.partition("="))
        allowed = ["restitution", *(OF_A_PAD if name != LINEAR else ())]
        if not equals or not typed or key not in allowed:
            raise InputError(field, word, "PROPERTY=VALUE of " + ", ".join(allowed), nearest(key, allowed))
        if key in given:
            raise InputError(field, word, f"{key} once")
        given[key] = typed
    programmer = Programmer(name, given, own)
    if programmer.law == "crush":
        back = "one that comes back: what crushes makes no half-sine, and is used up by a blow"
        raise InputError(field, word, back)
    if name in cushion_laws() and name != LINEAR:
        missing = [key for key in cushion_law(name).needs if key not in given]
        if missing:
            hint = 'such as "felt, stress=20 MPa, exponent=2.5, retardation=20 us"' if name == "felt" else ""
            raise InputError(field, word, ", ".join(missing) + " besides", hint)
    return programmer


@declare.dataclass
class FirstEstimate:
    """Closed forms of a programmer."""

    speed: float = declare.number(VELOCITY, "speed at touch")
    size: float = declare.number(NOT_MEASURED, "rate (N/m) or thickness (m) of the programmer then")
    compression: float = declare.number(LENGTH, "compression then")


def power_estimate(peak: float, width: float, level: float, exponent: float, restitution: float) -> tuple[float, float]:
    """Return speed (m/s) and compression (m) of a mass on F = K d^n for a peak and a width at a share of it.

    Without loss m v^2/2 = K d^(n + 1)/(n + 1) and F = m A = K d^n give v^2 = 2 A d/(n + 1); from the compression u d on
    and back the blow lasts 2 (d/v) J, J = int_u^1 (1 - x^(n + 1))^(-1/2) dx, u = level^(1/n). So v = A W/(J (n + 1))
    and d = v W/(2 J). With loss the same velocity change (1 + e) v takes 2/(1 + e) of that speed.

    For n = 1 this is v = A T/pi and d = A (T/pi)^2 of a half-sine of the duration T.
    """
    p = exponent + 1.0
    whole = float(beta(1.0 / p, 0.5)) / p
    integral = whole * (1.0 - float(betainc(1.0 / p, 0.5, level ** (p / exponent))))
    speed = peak * width / (integral * p)
    return speed * 2.0 / (1.0 + restitution), speed * width / (2.0 * integral)


def thickness_for(cushion: Cushion, force: float, compression: float) -> float:
    """Return the thickness at which a pad bears a force at a compression, m; the nearest bound where none does.

    Examples
    --------
    >>> felt = Cushion("power", Pad(1e-2, 0.01), {"stress": 1e6, "exponent": 2.0})
    >>> round(thickness_for(felt, 2500.0, 1e-3) * 1e3, 6)
    2.0
    """

    def over(thickness: float) -> float:
        pad = Pad(cushion.pad.area, thickness)
        contact = Cushion(cushion.law, pad, cushion.properties).contact()
        return math.log(indentation_under(contact, force) / compression)

    low, high = over(THINNEST), over(THICKEST)
    if low >= 0.0 or high <= 0.0:
        return THINNEST if low >= 0.0 else THICKEST
    return float(brentq(over, THINNEST, THICKEST, rtol=1e-9))


def largest_strain(cushion: Cushion) -> float:
    """Return the strain up to which a pad may be pressed: where its law holds, or short of where it ends.

    Examples
    --------
    >>> largest_strain(Cushion("elastomer", Pad(1e-2, 0.01), {"modulus": 5e6}))
    0.3
    """
    if cushion.law in LARGEST_STRAINS:
        return LARGEST_STRAINS[cushion.law]
    contact = cushion.contact()
    end = float(contact.end_depth) / cushion.pad.thickness if isinstance(contact, HardeningContact) else 1.0
    return FULL * end
