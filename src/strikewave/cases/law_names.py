"""Names of contact laws in a case: an unknown one is refused where the case is read, with the nearest that there is."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

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
