"""Case in, launched machine out: its release, what holds the object, and gravity while it is followed."""

from __future__ import annotations

import math
from collections.abc import Iterator

from strikewave.analyses.machine.consistency import MOST_SAMPLES
from strikewave.analyses.machine.kind import LaunchedKind, Release, kind_of
from strikewave.analyses.machine.result import LineCollision
from strikewave.analyses.machine.struck_object import Bodies, layered_object, object_bodies
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import MISSING, InputError, InputErrors
from strikewave.base.materials import material
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import face_contact, or_else, refuse_sliding
from strikewave.cases.tables.machine import AnyObject, LaunchedTable
from strikewave.machines import Arm, Launch, Machine, Striker, Strikers, StruckObject
from strikewave.machines.machine import BEFORE_TOUCH
from strikewave.machines.spans import Rebounds

LONGEST_FOLLOWED = 10.0
"""How long rebounds are followed where the case does not say, s: chosen; a ball let go at 1 m that keeps 0.8 of its
speed rests after 4 s."""


def build_launched(case: Case, kind: LaunchedKind) -> Machine:
    """Turn a case of a machine without a drive into the machine that runs; see `build_machine`."""
    striker, struck, contact, _ = case.impact()
    refuse_sliding(contact)
    layered = layered_object(case)
    bodies = object_bodies(case, layered)
    mass = bodies.nose_mass + bodies.assembly_mass
    start = kind.release(case, mass)
    lines = [str(error) for error in (*kind.inconsistencies(case), *_inconsistencies(kind, case, start, mass))]
    if lines:
        raise InputErrors(lines)
    face = material(struck.material, "object.material")
    gravity = _gravity(struck, kind)
    flying = Striker(
        mass=striker.mass.si,
        mount_stiffness=or_else(striker.mount_stiffness, 0.0),
        mount_damping=or_else(striker.mount_damping, 0.0),
        contact=face_contact(striker, contact, face),
    )
    return Machine(
        strikers=Strikers((flying,), contact.slowest_approach.si, contact.yields == "face"),
        struck=_object(struck, bodies, gravity, kind.falls in ("object", "both")),
        start=_launch(start, kind, gravity),
        layered=layered,
    )


def release(case: Case, mass: float | None = None) -> Release:
    """Return how the machine of a case comes to first touch; ``mass`` is that of the object where it is known, kg.

    Raises
    ------
    InputError
        If it does not come there, or has a drive.

    Examples
    --------
    >>> from strikewave import load_case
    >>> start = release(load_case("jesd22-b111-b"))
    >>> round(start.object, 3), round(start.energy, 2)
    (-2.341, 54.82)
    """
    kind = kind_of(case)
    if not isinstance(kind, LaunchedKind):
        raise InputError("machine.kind", kind.kind, "a machine without a drive", "a rotary machine is not released")
    if mass is None:
        bodies = object_bodies(case, layered_object(case))
        mass = bodies.nose_mass + bodies.assembly_mass
    return kind.release(case, mass)


def line_collisions(start: Release) -> tuple[LineCollision, ...]:
    """Return the collisions of a release by the names of its bodies; none where there is no line of bodies."""
    if start.line is None:
        return ()
    return tuple(
        LineCollision(
            time=c.time,
            lower=start.bodies[c.pair],
            upper=start.bodies[c.pair + 1],
            lower_before=c.before[0],
            upper_before=c.before[1],
            lower_after=c.after[0],
            upper_after=c.after[1],
            impulse=c.impulse,
            energy_lost=c.energy_lost,
        )
        for c in start.line.collisions
    )


def _gravity(struck: AnyObject, kind: LaunchedKind) -> float:
    """Return gravity along the blow on the object: against the blow where it falls on what strikes it."""
    return or_else(struck.gravity, -STANDARD_GRAVITY if kind.falls in ("object", "both") else 0.0)


def _launch(start: Release, kind: LaunchedKind, gravity: float) -> Launch:
    """Return the start, `BEFORE_TOUCH` of a touch with the speeds of a release; gravity acts from there on."""
    dt = BEFORE_TOUCH
    if kind.falls == "both":  # alike, whichever way they go
        speeds, pull = (start.striker - gravity * dt, start.object - gravity * dt), gravity
    else:
        pull = STANDARD_GRAVITY if kind.falls == "striker" else 0.0
        speeds = _before(start.striker, pull, dt), _before(start.object, gravity, dt)
    return Launch(*speeds, _arm(start), pull, start.travel, longest_followed(kind), _rebounds(kind))


def longest_followed(kind: LaunchedTable) -> float:
    """Return how long a machine is followed after first touch at most, s."""
    return kind.follow.si if kind.until in (None, "time") else or_else(kind.longest, LONGEST_FOLLOWED)


def _rebounds(kind: LaunchedTable) -> Rebounds | None:
    """Return how far a machine is followed over its rebounds, if it is."""
    if kind.until in (None, "time"):
        return None
    return Rebounds(int(or_else(kind.brake_after, 1.0)) if kind.until == "brake" else None)


def _arm(start: Release) -> Arm | None:
    """Return the arm, slower than at first touch by what its weight still gives it."""
    arm = start.pendulum
    if arm is None:
        return None
    weight = arm.mass * STANDARD_GRAVITY * arm.centre
    left = 1.0 - math.cos(start.arm * BEFORE_TOUCH)
    return Arm(arm.inertia, arm.radius, math.sqrt(start.arm**2 - 2.0 * weight / arm.inertia * left), weight)


def _before(speed: float, gravity: float, time: float) -> float:
    """Return the speed u at the way u dt before the speed v is reached: v^2 = u^2 + 2 g u dt."""
    return math.copysign(math.hypot(speed, gravity * time), speed) - gravity * time if speed else 0.0


def _object(struck: AnyObject, bodies: Bodies, gravity: float, falls: bool) -> StruckObject:
    """Return the object with what holds it; what is left out holds nothing."""
    return StruckObject(
        *bodies,
        spring=or_else(struck.spring, 0.0),
        preload=or_else(struck.preload, 0.0),
        damper=or_else(struck.damper, 0.0),
        stop_stiffness=or_else(struck.stop_stiffness, 0.0),
        stop_restitution=or_else(struck.stop_restitution, 1.0),
        gravity=gravity,
        friction=or_else(struck.friction, 0.0),
        stiction=None if struck.stiction is None else struck.stiction.si,
        falls=falls,
    )


def _inconsistencies(kind: LaunchedKind, case: Case, start: Release, mass: float) -> Iterator[InputError]:
    """Yield an error for each thing that does not fit together in a machine without a drive, of whatever kind."""
    struck = case.impact().object
    if struck.stiction is not None and struck.stiction.si < or_else(struck.friction, 0.0):
        allowed = f"at least object.friction ({or_else(struck.friction, 0.0):g} N)"
        yield InputError("object.stiction", struck.stiction.typed, allowed)
    samples = longest_followed(kind) / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the run below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        field = "machine.follow" if _rebounds(kind) is None else "machine.longest"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed, f"or a shorter {field}")
    if kind.brake_after is not None and kind.until != "brake":
        allowed = 'only with machine.until = "brake": nothing else brakes'
        yield InputError("machine.brake_after", kind.brake_after.typed, allowed, "remove it")
    if kind.longest is not None and _rebounds(kind) is None:
        allowed = 'only with machine.until = "rest" or "brake"'
        yield InputError("machine.longest", kind.longest.typed, allowed, "machine.follow is the time after first touch")
    if start.object != 0.0:
        yield from _moving_inconsistencies(struck, kind.falls == "both")
    else:
        yield from _resting_inconsistencies(struck, mass)


def _moving_inconsistencies(struck: AnyObject, falls_alike: bool) -> Iterator[InputError]:
    """Yield an error for each support of an object that comes through the air, or for its own gravity in a line."""
    for key in ("spring", "preload", "damper", "stop_stiffness", "stop_restitution"):
        value = getattr(struck, key)
        if value is not None:
            yield InputError(f"object.{key}", value.typed, "none: nothing holds an object that moves", "remove it")
    if falls_alike and struck.gravity is not None:
        yield InputError("object.gravity", struck.gravity.typed, "none: the whole line falls alike", "remove it")


def _resting_inconsistencies(struck: AnyObject, mass: float) -> Iterator[InputError]:
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
