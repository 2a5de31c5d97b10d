"""A gas gun: a projectile of known speed, or of the speed that its reservoir can give."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import FREE_OBJECT, Drawing, LaunchedKind, PartEntry, Release
from strikewave.base.declare import Quantity
from strikewave.base.errors import MISSING, InputError, checked
from strikewave.base.quantities import (
    MaybeAmbient,
    MaybeFriction,
    MaybeHeatRatio,
    MaybeLength,
    MaybePressure,
    MaybeSpeed,
    MaybeVolume,
)
from strikewave.base.result import Notice

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.machines import launch

AIR_SOUND_SPEED, AIR_HEAT_RATIO = 343.0, 1.4
"""m/s, and of a diatomic gas, at 20 degrees C."""
HIGHEST_PRESSURE = 30e6
"""Pressure up to which the gas is taken as ideal with no warning, Pa. Chosen: air and nitrogen at room temperature take
a tenth more room there than an ideal gas (from memory), and ever more beyond."""


class GasGun(LaunchedKind):
    """[machine]: a gun whose projectile, [striker], flies at the object.

    Either its ``speed`` is known, or it follows, as an upper bound, from the reservoir (absolute ``pressure``,
    ``volume``), the barrel (diameter ``bore``, ``length``, ``friction`` in N), the ``ambient`` pressure (1 atm), the
    ``heat_ratio`` of the gas (1.4) and its ``sound_speed`` (343 m/s).
    """

    kind: Literal["gas-gun"]
    speed: MaybeSpeed = None
    pressure: MaybePressure = None
    volume: MaybeVolume = None
    bore: MaybeLength = None
    length: MaybeLength = None
    friction: MaybeFriction = None
    ambient: MaybeAmbient = None
    heat_ratio: MaybeHeatRatio = None
    sound_speed: MaybeSpeed = None

    description: ClassVar[str] = (
        "A gas gun: gas drives a projectile through a barrel, and it flies at the object. The run begins just before "
        "first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("projectile", *FREE_OBJECT)
    settings: ClassVar = {
        "speed": Quantity("m/s", "m/s", "speed"),
        "pressure": Quantity("Pa", "bar", "pressure, absolute"),
    }
    sources: ClassVar[tuple[str, ...]] = ("rohrbach-2012", "siegel-1965")

    def release(self, case: Case, mass: float) -> Release:
        """Return a projectile at its speed, or at the smaller of two upper bounds."""
        from strikewave.cases.contact_of_case import or_else
        from strikewave.cases.stack_of_case import need
        from strikewave.machines import launch

        projectile = case.impact().striker.mass.si
        reservoir = ("pressure", "volume", "bore", "length")
        others = ("friction", "ambient", "heat_ratio", "sound_speed")
        if self.speed is not None:
            given = next((key for key in reservoir + others if getattr(self, key) is not None), None)
            if given is not None:
                allowed = "either the speed, or what it follows from"
                raise InputError(f"machine.{given}", getattr(self, given).typed, allowed, "remove one")
            return Release(0.5 * projectile * self.speed.si**2, striker=self.speed.si)
        if all(getattr(self, key) is None for key in reservoir):
            allowed = "the speed, or what it follows from: pressure, volume, bore, length"
            raise InputError("machine.speed", MISSING, allowed, 'such as speed = "45 m/s"')
        pressure, volume, bore, length = (
            need(getattr(self, key), f"machine.{key}", "with the others of the reservoir, or speed alone")
            for key in reservoir
        )
        ambient = or_else(self.ambient, launch.STANDARD_ATMOSPHERE)
        if self.pressure is not None and pressure <= ambient:
            allowed = f"more than the ambient {ambient / 1e3:.4g} kPa: it is absolute"
            raise InputError("machine.pressure", self.pressure.typed, allowed, "add 1 atm to a gauge pressure")
        gun = launch.GunBarrel(
            *(pressure, volume, 0.25 * math.pi * bore**2, length, projectile, or_else(self.friction, 0.0), ambient),
            heat_ratio=or_else(self.heat_ratio, AIR_HEAT_RATIO),
        )
        return _from_reservoir(gun, or_else(self.sound_speed, AIR_SOUND_SPEED))

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        gas = s.part_numbers(
            ("speed", self.speed, "m/s"),
            ("pressure", self.pressure, "bar"),
            ("volume", self.volume, "cm^3"),
            ("bore", self.bore, "mm"),
            ("barrel", self.length, "mm"),
            ("friction", self.friction, "N"),
        )
        parts = [PartEntry("gun", "gun", gas), s.striker_part(case, "projectile"), s.contact_part(case, "contact")]
        sketch = s.Schematic([*parts, s.object_part(case, "object")])
        sketch.block((0.3, 3.2), (2.2, 4.8), "disc", "gun")
        sketch.line((2.2, 4.3), (5.2, 4.3))
        sketch.line((2.2, 3.7), (5.2, 3.7))
        sketch.ball((5.9, 4.0), 0.3, "striker")
        sketch.number("striker", (5.9, 4.8))
        sketch.arrow((5.6, 3.3), (6.6, 3.3), "flies")
        sketch.number("contact", (7.3, 4.8))
        sketch.block((7.4, 3.1), (8.4, 4.9), "body", "object")
        sketch.blow((7.4, 5.6), (8.8, 5.6))
        s.bearing(sketch, case, (9.6, 4.0), (8.4, 4.0))
        return sketch.drawing("The gas gun")


def _from_reservoir(gun: launch.GunBarrel, sound_speed: float) -> Release:
    """Return the release of a gun whose speed follows from its reservoir: the smaller of two upper bounds."""
    from strikewave.machines import launch

    bounds = {"expands without inertia": checked("machine", lambda: launch.muzzle_speed(gun))}
    bounds["has inertia, from a wide reservoir,"] = launch.reservoir_muzzle_speed(gun, sound_speed)
    narrow = min(launch.wave_muzzle_speed(gun, sound_speed), *bounds.values())
    speed = min(bounds.values())
    gases = ", and one that ".join(f"{what} gives {value:.4g} m/s" for what, value in bounds.items())
    message = (
        f"{speed:.4g} m/s is an upper bound: a gas that {gases}; the smallest is taken (from a chamber no wider than "
        f"the barrel at most {narrow:.4g} m/s); valves and seals cost more"
    )
    notices = [Notice("muzzle-speed-bound", message, speed, max(bounds.values()))]
    if gun.pressure > HIGHEST_PRESSURE:
        message = (
            f"the gas is taken as ideal, but at {gun.pressure / 1e5:.4g} bar (machine.pressure) it is not: above "
            f"{HIGHEST_PRESSURE / 1e5:.0f} bar it takes a tenth more room, and more; measure machine.speed"
        )
        notices.append(Notice("gas-not-ideal", message, gun.pressure, HIGHEST_PRESSURE))
    return Release(0.5 * gun.mass * speed**2, striker=speed, notices=tuple(notices))
