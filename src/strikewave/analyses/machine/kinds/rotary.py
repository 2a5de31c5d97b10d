"""The rotary machine: a turntable carries the strikers, a feed brings the object into their path."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from strikewave.analyses.machine.kind import Drawing, MachineKind
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.cases.tables.machine import RotaryTable

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.contact.law import AnyContact
    from strikewave.machines import Machine


class Rotary(RotaryTable, MachineKind):
    """[machine]: a rotary machine.

    Its fields are those of `strikewave.cases.tables.machine.RotaryTable`, which studies know too;
    `strikewave.analyses.machine.build` builds it.
    """

    description: ClassVar[str] = (
        "A rotary machine: a turntable carries the strikers, a hydraulic feed brings the object into their path, each "
        "striker hits it in turn, and a preloaded spring and a damper bring it back to its stop before the next one "
        "comes. After the wanted number of passes the feed withdraws the object and the turntable is braked."
    )
    chain: ClassVar[tuple[str, ...]] = (
        *("turntable", "mount", "striker", "contact", "nose", "frame", "assembly"),
        *("spring, damper, stop", "carriage of the feed"),
    )
    settings: ClassVar = {
        "speed": Quantity("rad/s", "rpm"),
        "strikers": Quantity(NO_UNIT, NO_UNIT, "strikers"),
        "engagement": Quantity("m", "mm", "engagement"),
    }
    reference_law: ClassVar[str] = "the printed contact law"

    def rigid_contact(self, case: Case, machine: Machine) -> tuple[AnyContact, float]:
        """Return the printed law, damping by eq (24) of Li & Ma 2019, before a massive turntable."""
        from strikewave.cases.contact_of_case import contact_stiffness
        from strikewave.cases.tables.contact import CUSHION
        from strikewave.contact import factor

        if case.impact().contact.law == CUSHION:
            return machine.strikers.first.contact, math.inf

        chi = float(factor("li-ma-printed", case.impact().contact.restitution.si))
        return contact_stiffness(case).contact(chi), math.inf

    def drawing(self, case: Case) -> Drawing | None:
        """Return path, strike and parts with their numbers."""
        from strikewave.analyses.machine.figures.drawing import (
            machine_drawings,
            machine_parts,
            provenance_words,
            scale_words,
        )
        from strikewave.analyses.machine.figures.geometry import outlines
        from strikewave.reporting.parts import Picture

        made, figures = outlines(case), machine_drawings(case)
        if made is None or not figures:
            return None
        parts = machine_parts(case, made.geometry)
        notes = " ".join([provenance_words(parts), *scale_words(case, made)])
        pictures = [
            Picture(figures[0], f"The machine at first touch; the table gives its numbers. {notes}"),
            Picture(
                figures[1], "The strike: a nose at first touch, and dashed at the strike position; q is the engagement."
            ),
        ]
        return Drawing(pictures, parts)
