"""A dual-mass shock amplifier: a second mass on cushions above a drop table, which the rebounding table strikes."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import DROP_HEIGHT, Drawing, LaunchedKind, PartEntry, Release
from strikewave.base.declare import Quantity
from strikewave.base.errors import checked
from strikewave.base.quantities import DropHeight, Length, MaybeDamping, MaybeShare, Restitution, SpringRate
from strikewave.base.result import Notice

if TYPE_CHECKING:
    from strikewave.cases.case import Case


class DualMassAmplifier(LaunchedKind):
    """[machine]: a second mass, [object], on cushions above a drop table, [striker]; [contact] is the pad between them.

    Both fall from ``height``; ``friction`` is that of the guides as a share of the weight (0). The table meets a
    shaper on the anvil (``shaper_stiffness``, ``shaper_restitution``) and is thrown back; the second mass closes the
    ``gap`` against its cushions (``cushion_stiffness``, ``cushion_damping``, all together) and meets the table.
    """

    kind: Literal["dual-mass-amplifier"]
    height: DropHeight
    gap: Length
    shaper_stiffness: SpringRate
    shaper_restitution: Restitution
    cushion_stiffness: SpringRate
    cushion_damping: MaybeDamping = None
    friction: MaybeShare = None

    description: ClassVar[str] = (
        "A dual-mass shock amplifier on a drop table: table and second mass fall together; the pulse shaper on the "
        "anvil throws the table back while the second mass goes on down on its cushions, and the two meet. The object "
        "is the second mass, and its blow on the pad of the table is followed in full. The way there is that of two "
        "rigid masses on shaper and cushions. The run begins just before the two meet."
    )
    chain: ClassVar[tuple[str, ...]] = (
        *("anvil", "pulse shaper", "table", "pad, and cushions beside it"),
        *("nose", "frame", "assembly of the second mass"),
    )
    settings: ClassVar = {"height": DROP_HEIGHT, "gap": Quantity("m", "mm", "gap")}
    sources: ClassVar[tuple[str, ...]] = ("jesd22-b104", "rodgers-2009")
    falls: ClassVar = "both"

    def release(self, case: Case, mass: float) -> Release:
        """Return table and second mass as shaper and cushions leave them when they meet."""
        from strikewave.analyses.machine.build import guided_fall
        from strikewave.base.constants import material
        from strikewave.cases.contact_of_case import face_contact, or_else
        from strikewave.machines.amplifier import DualMass, second_impact

        striker, struck, contact, _ = case.impact()
        speed, travel, energy = guided_fall(self.height, self.friction, striker.mass.si + mass)
        masses = DualMass(
            table=striker.mass.si,
            second=mass,
            gap=self.gap.si,
            cushion_stiffness=self.cushion_stiffness.si,
            cushion_damping=or_else(self.cushion_damping, 0.0),
            shaper_stiffness=self.shaper_stiffness.si,
            shaper_restitution=self.shaper_restitution.si,
            pad=face_contact(striker, contact, material(struck.material, "object.material")),
        )
        impact = checked("machine.gap", lambda: second_impact(masses, speed))
        pushed = impact.cushion_force * self.follow.si / mass
        message = (
            f"the cushions are left out while the blow is followed: their {impact.cushion_force:.3g} N when the masses "
            f"meet would change the speed of the second mass by {pushed:.3g} m/s in {self.follow.typed}"
        )
        notices = [Notice("cushions-let-go", message, pushed, 0.0)]
        if impact.shaper_force > 0.0:
            message = (
                f"the table is still on its shaper, which pushes with {impact.shaper_force:.3g} N when the masses meet "
                "and is let go then: take a larger gap, or a stiffer shaper"
            )
            notices.append(Notice("table-on-shaper", message, impact.shaper_force, 0.0))
        if impact.gain < 1.0:
            message = (
                f"the second mass leaves with {impact.gain:.3g} of the speed of the fall: the machine does not "
                "amplify; take a lighter second mass, a gap that lets the table come up first, or higher restitutions"
            )
            notices.append(Notice("no-gain", message, impact.gain, 1.0))
        return Release(
            energy,
            travel + impact.time,
            striker=impact.table,
            object=impact.second,
            gain=impact.gain,
            notices=tuple(notices),
        )

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        shaper = s.part_numbers(
            ("stiffness", self.shaper_stiffness, s.STIFFNESS), ("restitution", self.shaper_restitution, "")
        )
        cushions = s.part_numbers(
            ("stiffness, all", self.cushion_stiffness, s.STIFFNESS),
            ("damping, all", self.cushion_damping, "N s/m"),
            ("gap to the pad", self.gap, "mm"),
        )
        parts = [
            s.fall_part("fall", "fall", self.height, self.friction),
            PartEntry("shaper", "pulse shaper", shaper),
            s.striker_part(case, "table"),
            PartEntry("cushions", "cushions", cushions),
            s.contact_part(case, "pad"),
            s.object_part(case, "second mass"),
        ]
        sketch = s.Schematic(parts)
        for x in (1.9, 8.1):
            sketch.line((x, 1.5), (x, 8.0))
        sketch.ground((0.8, 0.6), (9.2, 0.6))
        sketch.block((1.6, 0.6), (8.4, 1.5), "ground")
        sketch.block((4.4, 1.5), (5.6, 1.9), "stop")
        sketch.number("shaper", (6.0, 1.8))
        sketch.block((1.7, 3.9), (8.3, 4.7), "striker", "striker")
        sketch.block((4.3, 4.7), (5.7, 5.0), "stop")
        sketch.number("contact", (5.95, 5.1))
        for x in (2.9, 7.1):
            sketch.spring((x, 4.7), (x, 6.2))
        sketch.number("cushions", (7.65, 5.4))
        sketch.block((2.4, 6.2), (7.6, 7.0), "body", "object")
        sketch.dimension((3.6, 1.9), (3.6, 3.9), s.written_value(self.height, DROP_HEIGHT.usual))
        sketch.number("fall", (3.2, 2.9))
        sketch.dimension((4.9, 5.0), (4.9, 6.2), s.written_value(self.gap, "mm"))
        sketch.arrow((5.0, 3.8), (5.0, 2.6), "both fall")
        sketch.blow((8.9, 5.0), (8.9, 6.4))
        return sketch.drawing("The dual-mass shock amplifier")
