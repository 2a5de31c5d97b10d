"""[contact] and cushions: the law between nose and face, the pad between them, and the names of laws that there are."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator

from strikewave.base.quantities import (
    Length,
    MaybeArea,
    MaybeBlowCount,
    MaybeCoefficient,
    MaybeContactPressure,
    MaybeDamping,
    MaybeExponent,
    MaybeFrequency,
    MaybeLength,
    MaybeLoss,
    MaybeModulus,
    MaybePositiveForce,
    MaybeShare,
    MaybeStrength,
    MaybeTime,
    Restitution,
    Speed,
)
from strikewave.cases.tables.common import CaseTable

POWER = "power"
"""The contact law that is given by a force at a depth."""
CUSHION = "cushion"
"""The contact law, and the kind of joint, that is a cushion with a table of its own."""
USUAL_DAMPING, USUAL_STIFFNESS = "exact", ("hertz", "palmgren")
"""Laws of the built-in cases: known without the registry, whose import (numba) takes longer than a case to read."""


def _damping(name: str) -> str:
    """Refuse what names no damping law."""
    if name != USUAL_DAMPING:
        from strikewave.contact.damping import damping_law

        damping_law(name, "")
    return name


def _stiffness(name: str) -> str:
    """Refuse what names no stiffness law; a joint that is no contact has none."""
    if name and name not in USUAL_STIFFNESS:
        from strikewave.contact.stiffness import stiffness_law

        stiffness_law(name, "")
    return name


def _contact(name: str) -> str:
    """Refuse what names no law of [contact]."""
    return name if name in (POWER, CUSHION) else _stiffness(name)


def _cushion(name: str) -> str:
    """Refuse what names no cushion law; a cushion of a material has none."""
    if name:
        from strikewave.contact.cushions import cushion_law

        cushion_law(name, "")
    return name


DampingName = Annotated[str, AfterValidator(_damping)]
StiffnessName = Annotated[str, AfterValidator(_stiffness)]
ContactName = Annotated[str, AfterValidator(_contact)]
CushionName = Annotated[str, AfterValidator(_cushion)]


class CushionTable(CaseTable):
    """[contact.cushion], [stack.joint.cushion]: a pad with its area (or diameter) and thickness.

    ``material`` is a row of the cushion materials, ``law`` a cushion law where none is named; the law says which
    properties it takes, and what is given overrules the row. What it loses beside the restitution of a contact is a
    ``retardation``, or the ``loss_factor`` that it has at a ``loss_frequency``. After ``blows_before`` it has lost
    ``settling`` of its thickness in each blow, and grown stiffer by ``stiffening``.
    """

    law: CushionName = ""
    material: str = ""
    area: MaybeArea = None
    diameter: MaybeLength = None
    thickness: Length
    modulus: MaybeModulus = None
    stress: MaybeStrength = None
    exponent: MaybeExponent = None
    limit_strain: MaybeShare = None
    compression_factor: MaybeLoss = None
    shape_factor: MaybeLoss = None
    plateau: MaybeStrength = None
    densification: MaybeShare = None
    retardation: MaybeTime = None
    loss_factor: MaybeLoss = None
    loss_frequency: MaybeFrequency = None
    blows_before: MaybeBlowCount = None
    settling: MaybeShare = None
    stiffening: MaybeShare = None


class ContactTable(CaseTable):
    """[contact]: law of the contact between nose and face; with a yield pressure it is elastic-plastic.

    ``yield_pressure`` is the largest pressure that the contact bears, or "auto": that of the softer material
    (`strikewave.contact.automatic_pressure`).

    What has yielded stays: on the face, where all strikers hit the same spot, or on each nose (``yields``).
    The law "power", that of a pulse shaper or of a measured contact, is F = K d^n with K from ``reference_force`` at
    ``reference_depth`` and n = ``exponent`` (1). The law "cushion" is that of the pad of [contact.cushion].
    The nose of a rotary machine slides across the face: against ``friction`` (Coulomb's coefficient) and a viscous
    ``sliding_damping``; none where they are left out.
    """

    law: ContactName = "palmgren"
    damping: DampingName = "exact"
    restitution: Restitution
    slowest_approach: Speed
    reference_force: MaybePositiveForce = None
    reference_depth: MaybeLength = None
    exponent: MaybeExponent = None
    datum_depth: MaybeLength = None
    yield_pressure: MaybeContactPressure = None
    yields: Literal["face", "nose"] = "face"
    cushion: CushionTable | None = None
    friction: MaybeCoefficient = None
    sliding_damping: MaybeDamping = None
