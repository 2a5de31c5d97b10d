"""A ball that falls on an object at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import DROP_HEIGHT, FREE_OBJECT, Drawing, LaunchedKind, Release
from strikewave.base.quantities import DropHeight, MaybeShare

if TYPE_CHECKING:
    from strikewave.cases.case import Case


class FallingBall(LaunchedKind):
    """[machine]: a ball that falls on the object; [striker] is the ball, in free flight where it has no mount.

    ``friction`` is that of its guide as a share of its weight (0).
    """

    kind: Literal["falling-ball"]
    height: DropHeight
    friction: MaybeShare = None

    description: ClassVar[str] = (
        "A falling ball: it is let go at a height and falls on the object, whose support carries it. The run begins "
        "just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("falling ball", *FREE_OBJECT)
    settings: ClassVar = {"height": DROP_HEIGHT}
    falls: ClassVar = "striker"

    def release(self, case: Case, mass: float) -> Release:
        """Return a ball at v = sqrt(2 g (1 - friction) h)."""
        from strikewave.analyses.machine.build import guided_fall
        from strikewave.cases.contact_notices import ball_notices

        speed, travel, energy = guided_fall(self.height, self.friction, case.impact().striker.mass.si)
        return Release(energy, travel, striker=speed, notices=tuple(ball_notices(case)))

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        parts = [
            s.fall_part("fall", "fall", self.height, self.friction),
            s.striker_part(case, "ball"),
            s.contact_part(case, "contact"),
        ]
        sketch = s.Schematic([*parts, s.object_part(case, "object")])
        sketch.ball((5.0, 6.8), 0.6, "striker", "striker")
        sketch.arrow((5.0, 6.0), (5.0, 4.4), "falls")
        sketch.blow((8.6, 5.2), (8.6, 3.6))
        sketch.dimension((3.2, 3.0), (3.2, 6.2), s.written_value(self.height, DROP_HEIGHT.usual))
        sketch.number("fall", (2.8, 4.6))
        sketch.line((2.9, 6.2), (4.6, 6.2), dashed=True)
        sketch.block((3.6, 2.2), (6.4, 3.0), "body", "object")
        sketch.number("contact", (7.0, 3.1))
        s.bearing(sketch, case, (5.0, 0.9), (5.0, 2.2))
        return sketch.drawing("The falling ball")
