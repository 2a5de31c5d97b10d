"""A Machete hammer: an arm on a ratchet wheel, driven by a weight, with the object in its head."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import Drawing, LaunchedKind, PartEntry, Release
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.base.errors import InputError, InputErrors, checked
from strikewave.base.quantities import Count, Inertia, Length, MaybeAngle, MaybeLength, MaybeMass, MaybeTorque
from strikewave.base.result import Notice

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.machines import launch

SAME_MASS = 0.01
"""Object and arm whose masses differ by less than this share are taken as one: chosen, well below what an effective
mass is known to."""
STARTS_WATCHED = 200
"""Angles at which an arm must have been given energy, or it does not start, or stops on its way: chosen, some seven to
each of 30 teeth."""


class Machete(LaunchedKind):
    """[machine]: a Machete hammer, drawn back by ``teeth`` of its ratchet wheel of ``wheel_teeth``.

    The object sits in the head of the arm and meets a fixed anvil, which is [striker]. ``weight`` pulls at a ``drum``
    of that radius; ``inertia`` is that of arm, head and counterweight about the shaft, ``radius`` shaft to head;
    ``mass`` and ``centre`` are those of an arm that is not balanced. ``friction`` is the torque of the shaft;
    ``strike_angle`` is where the arm strikes, from hanging down.
    """

    kind: Literal["machete"]
    teeth: Count
    wheel_teeth: Count
    inertia: Inertia
    radius: Length
    weight: MaybeMass = None
    drum: MaybeLength = None
    mass: MaybeMass = None
    centre: MaybeLength = None
    friction: MaybeTorque = None
    strike_angle: MaybeAngle = None

    description: ClassVar[str] = (
        "A Machete hammer: an arm is drawn back by a number of teeth of a ratchet wheel and driven by a weight; the "
        "object sits in its head and meets a fixed anvil. Arm and weight are taken as what gives the object its speed. "
        "The run begins just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("anvil", "contact", "nose", "frame", "assembly")
    settings: ClassVar = {
        "teeth": Quantity(NO_UNIT, NO_UNIT, "teeth"),
        "weight": Quantity("kg", "kg", "weight"),
        "radius": Quantity("m", "m", "radius"),
    }
    mount: ClassVar = "optional"

    def release(self, case: Case, mass: float) -> Release:
        """Return an object at R sqrt(2 E/(J + M r^2)), in the head of the arm."""
        from strikewave.cases.contact_of_case import or_else
        from strikewave.cases.stack_of_case import need
        from strikewave.machines import launch

        if self.teeth.si > self.wheel_teeth.si:
            allowed = f"at most machine.wheel_teeth ({self.wheel_teeth.typed})"
            raise InputError("machine.teeth", self.teeth.typed, allowed, "the arm would turn more than once")
        for key, other in (("weight", "drum"), ("drum", "weight"), ("mass", "centre"), ("centre", "mass")):
            if getattr(self, key) is not None:
                need(getattr(self, other), f"machine.{other}", f"where there is machine.{key}")
        if self.mass is not None and self.centre is not None:
            least = self.mass.si * self.centre.si**2
            if self.inertia.si < least:
                allowed = f"at least machine.mass times machine.centre squared ({least:.4g} kg m^2)"
                raise InputError("machine.inertia", self.inertia.typed, allowed, "it is about the shaft")
        hammer = launch.MacheteHammer(
            teeth=int(self.wheel_teeth.si),
            inertia=self.inertia.si,
            radius=self.radius.si,
            unbalance=or_else(self.mass, 0.0) * or_else(self.centre, 0.0),
            weight=or_else(self.weight, 0.0),
            drum=or_else(self.drum, 0.0),
            friction=or_else(self.friction, 0.0),
            strike_angle=or_else(self.strike_angle, 0.0),
        )
        teeth = int(self.teeth.si)
        energy = float(checked("machine.teeth", lambda: launch.machete_energy(hammer, teeth)))
        speed = float(launch.machete_speed(hammer, teeth))
        notices = []
        if abs(mass / hammer.effective_mass - 1.0) > SAME_MASS:
            message = (
                f"the object has {mass:.4g} kg and the arm an effective mass of {hammer.effective_mass:.4g} kg "
                "(inertia over radius squared): the arm would strike with the latter"
            )
            notices.append(Notice("effective-mass", message, mass, hammer.effective_mass))
        slack = launch.rope_tension(hammer, teeth)
        if slack < 0.0:
            message = (
                f"the arm turns faster than the weight falls (the rope would push with {-slack:.3g} N): the rope goes "
                "slack, and the weight does not drive as the energy says; take a smaller machine.drum"
            )
            notices.append(Notice("rope-slack", message, slack, 0.0))
        return Release(energy, _turning_time(hammer, teeth), object=-speed, notices=tuple(notices))

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        arm = s.part_numbers(
            ("teeth", self.teeth, ""),
            ("teeth of the wheel", self.wheel_teeth, ""),
            ("inertia", self.inertia, "kg m^2"),
            ("shaft to head", self.radius, "mm"),
            ("mass", self.mass, s.MASS),
            ("shaft to centre", self.centre, "mm"),
            ("strike angle", self.strike_angle, "deg"),
            ("friction", self.friction, "N m"),
        )
        weight = s.part_numbers(("mass", self.weight, s.MASS), ("radius of its drum", self.drum, "mm"))
        parts = [PartEntry("arm", "arm and ratchet", arm), PartEntry("weight", "weight", weight)]
        parts += [s.object_part(case, "object in the head"), s.contact_part(case, "contact")]
        sketch = s.Schematic([*parts, s.striker_part(case, "anvil")])
        shaft, reach = (4.0, 6.0), 4.4
        drawn = 2.0 * math.pi * self.teeth.si / self.wheel_teeth.si
        turn = [2.0 * math.pi * k / self.wheel_teeth.si for k in range(int(self.wheel_teeth.si) + 1)]
        sketch.ball(shaft, 0.9, "disc")
        for a in turn:
            tips = [(shaft[0] + r * math.sin(a), shaft[1] + r * math.cos(a)) for r in (0.9, 1.05)]
            sketch.line(*tips)
        drawn_back = (shaft[0] - 1.8 * math.sin(drawn), shaft[1] - 1.8 * math.cos(drawn))
        sketch.line(shaft, drawn_back, dashed=True)
        sketch.block((3.85, shaft[1] - reach), (4.15, shaft[1]), "hub")
        sketch.number("arm", (4.0, 4.4))
        if self.weight is not None:
            sketch.line((4.5, 6.0), (4.5, 3.6))
            sketch.block((4.2, 2.7), (5.0, 3.6), "ground")
            sketch.number("weight", (5.4, 3.2))
        sketch.block((3.4, 1.2), (4.7, 2.2), "body", "object")
        sketch.number("contact", (4.95, 2.45))
        sketch.block((4.8, 0.9), (6.2, 2.5), "striker", "striker")
        sketch.ground((6.2, 0.5), (6.2, 2.9))
        sketch.blow((3.2, 0.7), (1.8, 0.7))
        return sketch.drawing("The Machete hammer")


def _turning_time(hammer: launch.MacheteHammer, teeth: int) -> float:
    """Return the time that an arm turns from rest, s: the integral of da/w(a), w from the energy given by then."""
    import numpy as np
    from scipy.integrate import quad

    whole, b, g = teeth * hammer.pitch, hammer.strike_angle, STANDARD_GRAVITY

    def given(turned: float) -> float:
        torque = hammer.weight * g * hammer.drum - hammer.friction
        return torque * turned + hammer.unbalance * g * (math.cos(whole + b - turned) - math.cos(whole + b))

    if min(given(float(a)) for a in np.linspace(0.0, whole, STARTS_WATCHED + 1)[1:]) <= 0.0:
        raise InputErrors([f"machine.teeth: the arm does not start from {teeth} teeth, or stops on its way"])
    # a = whole s^2 takes the root out of the integrand at the start
    rate = math.sqrt(2.0 / hammer.turning_inertia)
    time, _ = quad(lambda s: 2.0 * whole * s / (rate * math.sqrt(given(whole * s * s))) if s else 0.0, 0.0, 1.0)
    return float(time)
