"""Case in, launched machine out: how striker or object comes to first touch, and what holds them there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.integrate import quad
from scipy.special import ellipk

from strikewave.analyses.machine.consistency import MOST_SAMPLES
from strikewave.analyses.machine.result import LineCollision
from strikewave.analyses.machine.struck_object import Bodies, layered_object, object_bodies
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import MISSING, InputError, InputErrors
from strikewave.base.materials import material
from strikewave.base.quantities import Value
from strikewave.base.result import Notice
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import face_contact, or_else
from strikewave.cases.machine_tables import Amplifier, AnyLaunched, Drop, FallingBall, GasGun, Machete, Pendulum
from strikewave.cases.stack_of_case import checked, need
from strikewave.cases.tables import AnyObject
from strikewave.machines import Feed, Launch, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.machines import Striker as BuiltStriker
from strikewave.machines import launch as laws
from strikewave.machines.amplifier import Collisions, Line, collide
from strikewave.machines.machine import BEFORE_TOUCH

SAME_MASS = 0.01
"""Object and arm of a Machete hammer whose masses differ by less than this share are taken as one."""
AIR_SOUND_SPEED = 343.0
"""m/s, at 20 degrees C."""
LEAST_HEAT_RATIO = 1.05
"""Of a gas whose waves are followed; below it, near an isothermal one, the bound without inertia stands alone."""
LONGEST_LINE = 1.0
"""How long an amplifier is followed for its top body to be struck, s."""
MOST_COLLISIONS = 1000
FLOOR, STRIKER, OBJECT = "floor", "striker", "object"
"""Names of the other bodies of an amplifier."""
UNIT_ARM = Turntable(inertia=1.0, radius=1.0, speed=0.0, torque=0.0, speed_gain=0.0, drag=0.0, brake=0.0)
"""Stands where nothing turns: a seat on it at the apex of a cam stands still."""


class Release(NamedTuple):
    """How a machine comes to first touch, SI; speeds along the blow, at first touch.

    ``energy`` is what weight or gas gave the moving parts on the way, less friction; ``travel`` the time from the
    release (of a gun: the muzzle, so 0).
    """

    energy: float
    travel: float = 0.0
    striker: float = 0.0
    object: float = 0.0
    arm: float = 0.0
    pendulum: laws.Pendulum | None = None
    line: Collisions | None = None
    told: tuple[Notice, ...] = ()


def build_launched(case: Case) -> RotaryMachine:
    """Turn a case of a machine without a drive into the machine that runs; see `build_machine`."""
    machine = case.launched()
    assert machine is not None
    striker, struck, contact, _ = case.impact()
    layered = layered_object(case)
    bodies = object_bodies(case, layered)
    mass = bodies.nose_mass + bodies.assembly_mass
    start = release(case, mass)
    lines = [str(error) for error in _misfits(machine, case, start, mass)]
    if lines:
        raise InputErrors(lines)
    face = material(struck.material, "object.material")
    hammer = start.pendulum
    one = BuiltStriker(
        mass=striker.mass.si,
        mount_stiffness=or_else(striker.mount_stiffness, 0.0),
        mount_damping=or_else(striker.mount_damping, 0.0),
        contact=face_contact(striker, contact, face),
    )
    follow = BEFORE_TOUCH + machine.follow.si
    return RotaryMachine(
        turntable=UNIT_ARM if hammer is None else _arm(hammer),
        strikers=Strikers((one,), contact.slowest_approach.si, contact.yields == "face"),
        feed=Feed(0.0, 0.0, 0.0, 1.0, 0.0, 10**6, 0.0, 1.0, hold=follow),
        struck=_held(struck, bodies, machine),
        engagement=0.0,
        layered=layered,
        blow_angle=0.0 if hammer is None else 0.5 * math.pi,
        launch=_launch(start, machine, _gravity(struck, machine)),
    )


def release(case: Case, mass: float | None = None) -> Release:
    """Return how the machine of a case comes to first touch; ``mass`` is that of the object where it is known, kg.

    Raises
    ------
    InputError, InputErrors
        If it does not come there.

    Examples
    --------
    >>> from strikewave import load_case
    >>> start = release(load_case("jesd22-b111-b"))
    >>> round(start.object, 3), round(start.energy, 2)
    (-2.341, 54.82)
    """
    machine = case.launched()
    assert machine is not None
    if mass is None:
        bodies = object_bodies(case, layered_object(case))
        mass = bodies.nose_mass + bodies.assembly_mass
    return _OF_KIND[machine.kind](machine, case, mass)


def _falling(height: Value, friction: Value | None, mass: float) -> tuple[float, float, float]:
    """Return speed, time and energy of a fall from rest along a guide."""
    share = or_else(friction, 0.0)
    speed = float(checked("machine.friction", lambda: laws.fall_speed(height.si, friction=share)))
    return speed, 2.0 * height.si / speed, 0.5 * mass * speed**2


def _falling_ball(machine: FallingBall, case: Case, _: float) -> Release:
    speed, travel, energy = _falling(machine.height, machine.friction, case.impact().striker.mass.si)
    return Release(energy, travel, striker=speed)


def _drop(machine: Drop, _: Case, mass: float) -> Release:
    speed, travel, energy = _falling(machine.height, machine.friction, mass)
    return Release(energy, travel, object=-speed)


def pendulum_of(machine: Pendulum) -> laws.Pendulum:
    """Return the arm of a pendulum case.

    Raises
    ------
    InputError, InputErrors
        If its inertia is not given once, or cannot be.
    """
    mass, centre, given = machine.mass.si, machine.centre.si, (machine.inertia, machine.period)
    if (given[0] is None) == (given[1] is None):
        got = MISSING if given[0] is None else given[0].typed
        raise InputError("machine.inertia", got, "either inertia or period of small swings", 'inertia = "10 kg m^2"')
    inertia = given[0].si if given[0] else laws.inertia_of_period(mass, centre, or_else(given[1], math.nan))
    return checked("machine.inertia", lambda: laws.Pendulum(mass, centre, inertia, machine.radius.si))


def _pendulum(machine: Pendulum, case: Case, _: float) -> Release:
    hammer, angle = pendulum_of(machine), machine.angle.si
    if angle >= math.pi:
        raise InputError("machine.angle", machine.angle.typed, "less than 180 deg, where the arm stands upright")
    struck_with = case.impact().striker.mass.si * hammer.radius**2
    if struck_with >= hammer.inertia:
        allowed = f"more than that of the striker alone ({struck_with:.4g} kg m^2)"
        raise InputError("machine.inertia", f"{hammer.inertia:.4g} kg m^2", allowed, "it includes [striker]")
    swing = math.sqrt(hammer.reduced_length / STANDARD_GRAVITY) * float(ellipk(math.sin(0.5 * angle) ** 2))
    arm = float(laws.pendulum_speed(hammer, angle)) / hammer.radius
    return Release(float(laws.pendulum_energy(hammer, angle)), swing, arm=arm, pendulum=hammer)


def _machete(machine: Machete, _: Case, mass: float) -> Release:
    if machine.teeth.si > machine.wheel_teeth.si:
        allowed = f"at most machine.wheel_teeth ({machine.wheel_teeth.typed})"
        raise InputError("machine.teeth", machine.teeth.typed, allowed, "the arm would turn more than once")
    for one, other in (("weight", "drum"), ("drum", "weight"), ("mass", "centre"), ("centre", "mass")):
        if getattr(machine, one) is not None:
            need(getattr(machine, other), f"machine.{other}", f"where there is machine.{one}")
    hammer = laws.MacheteHammer(
        teeth=int(machine.wheel_teeth.si),
        inertia=machine.inertia.si,
        radius=machine.radius.si,
        unbalance=or_else(machine.mass, 0.0) * or_else(machine.centre, 0.0),
        weight=or_else(machine.weight, 0.0),
        drum=or_else(machine.drum, 0.0),
        friction=or_else(machine.friction, 0.0),
        strike_angle=or_else(machine.strike_angle, 0.0),
    )
    teeth = int(machine.teeth.si)
    energy = float(checked("machine.teeth", lambda: laws.machete_energy(hammer, teeth)))
    speed = float(laws.machete_speed(hammer, teeth))
    told = []
    if abs(mass / hammer.effective_mass - 1.0) > SAME_MASS:
        message = (
            f"the object has {mass:.4g} kg and the arm an effective mass of {hammer.effective_mass:.4g} kg (inertia "
            "over radius squared): the arm would strike with the latter"
        )
        told.append(Notice("effective-mass", message, mass, hammer.effective_mass))
    return Release(energy, _turning_time(hammer, teeth), object=-speed, told=tuple(told))


def _turning_time(hammer: laws.MacheteHammer, teeth: int) -> float:
    """Return how long an arm turns from rest, s: the integral of da/w(a), w from the energy given by then.

    Raises
    ------
    InputErrors
        If the arm does not start, or stops on the way.
    """
    whole, b, g = teeth * hammer.pitch, hammer.strike_angle, STANDARD_GRAVITY

    def given(turned: float) -> float:
        torque = hammer.weight * g * hammer.drum - hammer.friction
        return torque * turned + hammer.unbalance * g * (math.cos(whole + b - turned) - math.cos(whole + b))

    if min(given(float(a)) for a in np.linspace(0.0, whole, 201)[1:]) <= 0.0:
        raise InputErrors([f"machine.teeth: the arm does not start from {teeth} teeth, or stops on its way"])
    # a = whole s^2 takes the root out of the integrand at the start
    rate = math.sqrt(2.0 / hammer.turning_inertia)
    time, _ = quad(lambda s: 2.0 * whole * s / (rate * math.sqrt(given(whole * s * s))) if s else 0.0, 0.0, 1.0)
    return float(time)


def _gas_gun(machine: GasGun, case: Case, _: float) -> Release:
    mass = case.impact().striker.mass.si
    reservoir = ("pressure", "volume", "bore", "length")
    others = ("friction", "ambient", "heat_ratio", "sound_speed")
    if machine.speed is not None:
        given = next((key for key in reservoir + others if getattr(machine, key) is not None), None)
        if given is not None:
            allowed = "either the speed, or what it follows from"
            raise InputError(f"machine.{given}", getattr(machine, given).typed, allowed, "remove one")
        return Release(0.5 * mass * machine.speed.si**2, striker=machine.speed.si)
    if all(getattr(machine, key) is None for key in reservoir):
        allowed = "the speed, or what it follows from: pressure, volume, bore, length"
        raise InputError("machine.speed", MISSING, allowed, 'such as speed = "45 m/s"')
    pressure, volume, bore, length = (
        need(getattr(machine, key), f"machine.{key}", "with the others of the reservoir, or speed alone")
        for key in reservoir
    )
    ambient = or_else(machine.ambient, laws.STANDARD_ATMOSPHERE)
    if machine.pressure is not None and pressure <= ambient:
        allowed = f"more than the ambient {ambient / 1e3:.4g} kPa: it is absolute"
        raise InputError("machine.pressure", machine.pressure.typed, allowed, "add 1 atm to a gauge pressure")
    gun = laws.GasGun(
        *(pressure, volume, 0.25 * math.pi * bore**2, length, mass, or_else(machine.friction, 0.0), ambient),
        heat_ratio=or_else(machine.heat_ratio, 1.4),
    )
    return _from_reservoir(gun, or_else(machine.sound_speed, AIR_SOUND_SPEED))


def _from_reservoir(gun: laws.GasGun, sound_speed: float) -> Release:
    """Return the release of a gun whose speed follows from its reservoir: the smaller of two upper bounds."""
    bounds = {"expands without inertia": checked("machine", lambda: laws.muzzle_speed(gun))}
    if gun.heat_ratio >= LEAST_HEAT_RATIO:
        fast = checked("machine", lambda: laws.wave_muzzle_speed(gun, sound_speed))
        bounds["has inertia, in an endless chamber,"] = fast
    speed = min(bounds.values())
    said = ", and one that ".join(f"{what} gives {value:.4g} m/s" for what, value in bounds.items())
    message = f"{speed:.4g} m/s is an upper bound: a gas that {said}; the smallest is taken; valves and seals cost more"
    notice = Notice("muzzle-speed-bound", message, speed, max(bounds.values()))
    return Release(0.5 * gun.mass * speed**2, striker=speed, told=(notice,))


def _amplifier(machine: Amplifier, case: Case, mass: float) -> Release:
    parts = case.impact()
    rows, striker, g = machine.body, parts.striker.mass.si, STANDARD_GRAVITY
    taken = [FLOOR, STRIKER, OBJECT]
    for row in rows:
        if row.name in taken:
            raise InputError(
                f"machine.body.{row.name}.name", row.name, f"a name of its own, none of {', '.join(taken)}"
            )
        taken.append(row.name)
    bodies = (*(row.mass.si for row in rows), striker, mass)
    speed, fall, energy = _falling(machine.height, machine.friction, sum(bodies))
    gaps = (0.0, *(or_else(row.gap, 0.0) for row in rows), or_else(machine.gap, 0.0))
    line = Line(
        masses=(math.inf, *bodies),
        restitutions=(machine.restitution.si, *(row.restitution.si for row in rows), parts.contact.restitution.si),
        gaps=gaps,
        speeds=(0.0, *(-speed for _ in bodies)),
        gravity=g,
    )
    top = len(bodies) - 1
    struck = next((c for c in collide(line, LONGEST_LINE, MOST_COLLISIONS).collisions if c.pair == top), None)
    if struck is None:
        allowed = f"a line whose object is struck within {LONGEST_LINE:g} s and {MOST_COLLISIONS} collisions"
        raise InputError("machine.body", f"{len(bodies)} bodies", allowed, "take smaller gaps or lighter upper bodies")
    followed = collide(line, struck.time + machine.follow.si, MOST_COLLISIONS)
    told = [Notice("line-of-bodies", word, float(len(followed.collisions)), 0.0) for word in followed.words]
    again = sum(c.pair == top for c in followed.collisions) - 1
    if again:
        message = f"the striker meets the object {again} more times in the line of bodies: only the first is followed"
        told.append(Notice("later-blows", message, float(again), 0.0))
    return Release(energy, fall + struck.time, *struck.before, line=followed, told=tuple(told))


_OF_KIND: dict[str, Callable[..., Release]] = {
    "falling-ball": _falling_ball,
    "drop": _drop,
    "pendulum": _pendulum,
    "machete": _machete,
    "gas-gun": _gas_gun,
    "amplifier": _amplifier,
}


def line_collisions(case: Case, start: Release) -> tuple[LineCollision, ...]:
    """Return the collisions of an amplifier by the names of its bodies; none of any other machine."""
    machine = case.launched()
    if not isinstance(machine, Amplifier) or start.line is None:
        return ()
    names = [FLOOR, *(row.name for row in machine.body), STRIKER, OBJECT]
    return tuple(
        LineCollision(
            time=c.time,
            lower=names[c.pair],
            upper=names[c.pair + 1],
            lower_before=c.before[0],
            upper_before=c.before[1],
            lower_after=c.after[0],
            upper_after=c.after[1],
            impulse=c.impulse,
            energy_lost=c.energy_lost,
        )
        for c in start.line.collisions
    )


def _arm(hammer: laws.Pendulum) -> Turntable:
    return Turntable(hammer.inertia, hammer.radius, 0.0, 0.0, 0.0, 0.0, 0.0)


def _gravity(struck: AnyObject, machine: AnyLaunched) -> float:
    """Return gravity along the blow on the object: against the blow where it falls on what strikes it."""
    return or_else(struck.gravity, -STANDARD_GRAVITY if isinstance(machine, Drop | Amplifier) else 0.0)


def _launch(start: Release, machine: AnyLaunched, gravity: float) -> Launch:
    """Return the start, `BEFORE_TOUCH` of a touch with the speeds of a release; gravity acts from there on."""
    dt, weight, arm = BEFORE_TOUCH, 0.0, start.arm
    pull = STANDARD_GRAVITY if isinstance(machine, FallingBall) else 0.0
    striker, thing = _before(start.striker, pull, dt), _before(start.object, gravity, dt)
    if start.pendulum is not None:
        weight = start.pendulum.mass * STANDARD_GRAVITY * start.pendulum.centre
        arm = math.sqrt(arm**2 - 2.0 * weight / start.pendulum.inertia * (1.0 - math.cos(arm * dt)))
    if isinstance(machine, Amplifier):  # both fall alike, whichever way they go
        pull, striker, thing = gravity, start.striker - gravity * dt, start.object - gravity * dt
    return Launch(striker, thing, arm, weight, pull, start.travel, machine.follow.si)


def _before(speed: float, gravity: float, time: float) -> float:
    """Return the speed u at the way u dt before the speed v is reached: v^2 = u^2 + 2 g u dt."""
    return math.copysign(math.hypot(speed, gravity * time), speed) - gravity * time if speed else 0.0


def _held(struck: AnyObject, bodies: Bodies, machine: AnyLaunched) -> StruckObject:
    """Return the object with what holds it; what is left out holds nothing."""
    return StruckObject(
        *bodies,
        spring=or_else(struck.spring, 0.0),
        preload=or_else(struck.preload, 0.0),
        damper=or_else(struck.damper, 0.0),
        stop_stiffness=or_else(struck.stop_stiffness, 0.0),
        stop_restitution=or_else(struck.stop_restitution, 1.0),
        gravity=_gravity(struck, machine),
        friction=or_else(struck.friction, 0.0),
        stiction=None if struck.stiction is None else struck.stiction.si,
    )


def _misfits(machine: AnyLaunched, case: Case, start: Release, mass: float) -> Iterator[InputError]:
    """Yield an error for each thing that a machine of this kind cannot have, or needs."""
    striker, struck, _, _ = case.impact()
    mount = striker.mount_stiffness
    if isinstance(machine, Pendulum) and mount is None:
        yield InputError("striker.mount_stiffness", MISSING, "of the striker on its arm", 'such as "300 MN/m"')
    if isinstance(machine, FallingBall | GasGun | Amplifier) and mount is not None:
        yield InputError("striker.mount_stiffness", mount.typed, f"none: the striker of a {machine.kind} flies")
    if mount is None and striker.mount_damping is not None:
        allowed = "only with striker.mount_stiffness: without it there is no mount"
        yield InputError("striker.mount_damping", striker.mount_damping.typed, allowed, "remove it")
    if struck.stiction is not None and struck.stiction.si < or_else(struck.friction, 0.0):
        allowed = f"at least object.friction ({or_else(struck.friction, 0.0):g} N)"
        yield InputError("object.stiction", struck.stiction.typed, allowed)
    samples = machine.follow.si / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the run below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed, "or a shorter machine.follow")
    if start.object != 0.0:
        yield from _moving_misfits(struck, isinstance(machine, Amplifier))
    else:
        yield from _resting_misfits(struck, mass)


def _moving_misfits(struck: AnyObject, in_line: bool) -> Iterator[InputError]:
    """Yield an error for each support of an object that comes through the air, or for its own gravity in a line."""
    for key in ("spring", "preload", "damper", "stop_stiffness", "stop_restitution"):
        value = getattr(struck, key)
        if value is not None:
            yield InputError(f"object.{key}", value.typed, "none: nothing holds an object that moves", "remove it")
    if in_line and struck.gravity is not None:
        yield InputError("object.gravity", struck.gravity.typed, "none: the whole line falls alike", "remove it")


def _resting_misfits(struck: AnyObject, mass: float) -> Iterator[InputError]:
    """Yield an error for each load on an object at rest that nothing bears."""
    if struck.stop_stiffness is not None:
        weight = mass * or_else(struck.gravity, 0.0)
        if or_else(struck.preload, 0.0) <= weight:
            got = MISSING if struck.preload is None else struck.preload.typed
            allowed = f"more than the weight along the blow ({weight:.4g} N)"
            yield InputError("object.preload", got, allowed, "it must hold the object on its stop")
        return
    for key in ("preload", "gravity", "stop_restitution"):
        value = getattr(struck, key)
        if value is not None and value.si != 0.0:
            allowed = "only where object.stop_stiffness gives a stop that bears it"
            yield InputError(f"object.{key}", value.typed, allowed, "add the stop, or remove it")
