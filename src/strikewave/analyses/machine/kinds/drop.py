"""A drop table: the table falls with the object on an anvil."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import DROP_HEIGHT, Drawing, LaunchedKind, Release
from strikewave.base.errors import checked
from strikewave.base.quantities import DropHeight, MaybePositiveForce, MaybeShare, MaybeSpringRate

if TYPE_CHECKING:
    from strikewave.cases.case import Case


class Drop(LaunchedKind):
    """[machine]: a table that falls with the object on an anvil; [contact] is the pulse shaper between them.

    [object] is the table with what it carries, [striker] the anvil, on its mount to the ground or free to move.
    ``friction`` is that of the guides as a share of the weight (0). Elastic cords may pull the table down: all together
    with ``cord_force`` where it meets the anvil, and by ``cord_stiffness`` more the higher it hangs.
    """

    kind: Literal["drop"]
    height: DropHeight
    friction: MaybeShare = None
    cord_force: MaybePositiveForce = None
    cord_stiffness: MaybeSpringRate = None

    description: ClassVar[str] = (
        "A drop table: it falls with what it carries on an anvil; the pulse shaper between them is the contact. "
        "The object is the table with its load, and the blow goes upwards. The run begins just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = (
        *("ground", "mount of the anvil, where there is one", "anvil", "pulse shaper"),
        *("nose", "frame", "assembly"),
    )
    settings: ClassVar = {"height": DROP_HEIGHT}
    sources: ClassVar[tuple[str, ...]] = ("jesd22-b104",)
    falls: ClassVar = "object"
    mount: ClassVar = "optional"

    def release(self, case: Case, mass: float) -> Release:
        """Return a table at v = sqrt(2 g (1 - friction) h), or faster where cords pull it, downwards."""
        from strikewave.cases.contact_of_case import or_else
        from strikewave.machines.launch import corded_fall

        pull = or_else(self.cord_force, 0.0), or_else(self.cord_stiffness, 0.0)
        friction = or_else(self.friction, 0.0)
        speed, travel = checked("machine.friction", lambda: corded_fall(self.height.si, mass, *pull, friction))
        return Release(0.5 * mass * speed**2, travel, object=-speed)

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        cords = (
            ("cords, force at the anvil", self.cord_force, "N"),
            ("cords, stiffness", self.cord_stiffness, s.STIFFNESS),
        )
        parts = [s.fall_part("fall", "fall", self.height, self.friction, *cords)]
        parts.append(s.object_part(case, "table with load"))
        sketch = s.Schematic([*parts, s.contact_part(case, "shaper"), s.striker_part(case, "anvil")])
        for x in (2.4, 7.6):
            sketch.line((x, 1.6), (x, 8.0))
        sketch.block((2.2, 5.2), (7.8, 6.0), "body", "object")
        sketch.block((4.0, 6.0), (6.0, 6.5), "body 2")
        sketch.block((4.4, 1.6), (5.6, 2.0), "stop")
        sketch.number("contact", (6.1, 2.0))
        sketch.block((1.6, 0.7), (8.4, 1.6), "striker", "striker")
        sketch.dimension((3.4, 2.0), (3.4, 5.2), s.written_value(self.height, DROP_HEIGHT.usual))
        sketch.number("fall", (3.0, 3.6))
        sketch.line((3.1, 2.0), (4.4, 2.0), dashed=True)
        sketch.arrow((5.0, 5.1), (5.0, 3.6), "falls")
        sketch.blow((9.0, 2.2), (9.0, 3.8))
        sketch.ground((0.8, 0.4), (9.2, 0.4))
        return sketch.drawing("The drop table")
