"""A ball that falls on an object at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import FREE_OBJECT, LaunchedKind, Release, Setting
from strikewave.base.quantities import Length, MaybeShare

if TYPE_CHECKING:
    from strikewave.cases.case import Case


class FallingBall(LaunchedKind):
    """[machine]: a ball that falls on the object; [striker] is the ball, in free flight where it has no mount.

    ``friction`` is that of its guide as a share of its weight (0).
    """

    kind: Literal["falling-ball"]
    height: Length
    friction: MaybeShare = None

    description: ClassVar[str] = (
        "A falling ball: it is let go at a height and falls on the object, whose support carries it. The run begins "
        "just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("falling ball", *FREE_OBJECT)
    settings: ClassVar[tuple[Setting, ...]] = (Setting("height", "m", "m", "drop height"),)
    falls: ClassVar = "striker"

    def release(self, case: Case, mass: float) -> Release:
        """Return a ball at v = sqrt(2 g (1 - friction) h)."""
        from strikewave.analyses.machine.falling import fall

        speed, travel, energy = fall(self.height, self.friction, case.impact().striker.mass.si)
        return Release(energy, travel, striker=speed)
