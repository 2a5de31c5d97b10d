"""A pendulum: an arm let go at an angle, with the striker on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import FREE_OBJECT, Drawing, LaunchedKind, PartEntry, Release
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.declare import Quantity
from strikewave.base.errors import MISSING, InputError, checked
from strikewave.base.quantities import Length, Mass, MaybeInertia, MaybeTime, SwingAngle
from strikewave.cases.plausible import GoesWith

if TYPE_CHECKING:
    from collections.abc import Mapping

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
    settings: ClassVar = {"angle": Quantity("rad", "deg", "release angle"), "radius": Quantity("m", "m", "radius")}
    sources: ClassVar[tuple[str, ...]] = ("iso-148-2",)
    mount: ClassVar = "needed"

    def arm(self) -> launch.RigidPendulum:
        """Return the arm."""
        from strikewave.cases.contact_of_case import or_else
        from strikewave.machines import launch

        mass, centre, given = self.mass.si, self.centre.si, (self.inertia, self.period)
        if (given[0] is None) == (given[1] is None):
            got = MISSING if given[0] is None else given[0].typed
            raise InputError(
                "machine.inertia", got, "either inertia or period of small swings", 'inertia = "10 kg m^2"'
            )
        inertia = given[0].si if given[0] else launch.inertia_of_period(mass, centre, or_else(given[1], math.nan))
        return checked("machine.inertia", lambda: launch.RigidPendulum(mass, centre, inertia, self.radius.si))

    def goes_with(self) -> Mapping[str, GoesWith]:
        """Return how inertia, or period, goes with mass and centre: a point mass at the centre has the least."""
        mass, centre = self.mass.si, self.centre.si
        swing = 2.0 * math.pi * math.sqrt(centre / STANDARD_GRAVITY)
        return {
            "machine.inertia": GoesWith({"machine.mass": 1.0, "machine.centre": 2.0}, mass * centre**2),
            "machine.period": GoesWith({"machine.centre": 0.5}, swing),
        }

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

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        arm = s.part_numbers(
            ("release angle", self.angle, "deg"),
            ("mass", self.mass, s.MASS),
            ("pivot to centre", self.centre, "mm"),
            ("pivot to striker", self.radius, "mm"),
            ("inertia", self.inertia, "kg m^2"),
            ("period", self.period, "s"),
        )
        parts = [PartEntry("arm", "arm", arm), s.striker_part(case, "striker"), s.contact_part(case, "contact")]
        sketch = s.Schematic([*parts, s.object_part(case, "object")])
        pivot, reach = (5.0, 7.2), 5.0
        angle = self.angle.si
        released = (pivot[0] - reach * math.sin(angle), pivot[1] - reach * math.cos(angle))
        sketch.line(pivot, released, dashed=True)
        sketch.block((4.85, pivot[1] - reach), (5.15, pivot[1]), "hub")
        sketch.ball(pivot, 0.15, "ground")
        sketch.number("arm", (5.0, 5.4))
        sketch.block((4.6, 1.7), (5.5, 2.5), "striker", "striker")
        turn = [angle * k / 40.0 for k in range(41)]
        sketch.line(*[(pivot[0] - 2.0 * math.sin(a), pivot[1] - 2.0 * math.cos(a)) for a in turn])
        sketch.number("contact", (5.6, 3.0))
        sketch.block((5.6, 1.5), (7.2, 2.7), "body", "object")
        s.bearing(sketch, case, (8.8, 2.1), (7.2, 2.1))
        sketch.blow((6.2, 3.4), (7.8, 3.4))
        return sketch.drawing("The pendulum")
