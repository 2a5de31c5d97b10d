"""A pendulum: an arm let go at an angle, with the striker on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import FREE_OBJECT, LaunchedKind, Release, Setting
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import MISSING, InputError
from strikewave.base.quantities import Length, Mass, MaybeInertia, MaybeTime, SwingAngle

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.machines import launch


class Pendulum(LaunchedKind):
    """[machine]: an arm let go at an ``angle`` from hanging, whose [striker] meets the object at the lowest point.

    ``mass``, ``centre`` (of gravity from the pivot) and ``inertia`` (about the pivot) are those of the whole arm, the
    striker included; ``period`` of small swings may stand for the inertia. ``radius`` is pivot to striker.
    """

    kind: Literal["pendulum"]
    angle: SwingAngle
    mass: Mass
    centre: Length
    radius: Length
    inertia: MaybeInertia = None
    period: MaybeTime = None

    description: ClassVar[str] = (
        "A pendulum: an arm is let go at an angle, and the striker on it meets the object at the lowest point. The run "
        "begins just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("arm", "mount", "striker", *FREE_OBJECT)
    settings: ClassVar[tuple[Setting, ...]] = (
        Setting("angle", "rad", "deg", "release angle"),
        Setting("radius", "m", "m", "radius"),
    )
    sources: ClassVar[tuple[str, ...]] = ("iso-148-2",)
    mount: ClassVar = "needed"

    def arm(self) -> launch.Pendulum:
        """Return the arm.

        Raises
        ------
        InputError, InputErrors
            If its inertia is not given once, or cannot be.
        """
        from strikewave.cases.contact_of_case import or_else
        from strikewave.cases.stack_of_case import checked
        from strikewave.machines import launch

        mass, centre, given = self.mass.si, self.centre.si, (self.inertia, self.period)
        if (given[0] is None) == (given[1] is None):
            got = MISSING if given[0] is None else given[0].typed
            raise InputError(
                "machine.inertia", got, "either inertia or period of small swings", 'inertia = "10 kg m^2"'
            )
        inertia = given[0].si if given[0] else launch.inertia_of_period(mass, centre, or_else(given[1], math.nan))
        return checked("machine.inertia", lambda: launch.Pendulum(mass, centre, inertia, self.radius.si))

    def release(self, case: Case, mass: float) -> Release:
        """Return an arm at w = sqrt(2 m g r (1 - cos a)/J), after a quarter of its period at this amplitude."""
        from scipy.special import ellipk

        from strikewave.machines import launch

        arm, angle = self.arm(), self.angle.si
        if angle >= math.pi:
            raise InputError("machine.angle", self.angle.typed, "less than 180 deg, where the arm stands upright")
        struck_with = case.impact().striker.mass.si * arm.radius**2
        if struck_with >= arm.inertia:
            allowed = f"more than that of the striker alone ({struck_with:.4g} kg m^2)"
            raise InputError("machine.inertia", f"{arm.inertia:.4g} kg m^2", allowed, "it includes [striker]")
        swing = math.sqrt(arm.reduced_length / STANDARD_GRAVITY) * float(ellipk(math.sin(0.5 * angle) ** 2))
        speed = float(launch.pendulum_speed(arm, angle)) / arm.radius
        return Release(float(launch.pendulum_energy(arm, angle)), swing, arm=speed, pendulum=arm)
