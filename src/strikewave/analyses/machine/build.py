"""Case in, machine out: with a drive or launched, and its struck object, with the checks that the whole case allows."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel

from strikewave.analyses.machine.kind import LaunchedKind, Release, kind_of
from strikewave.analyses.machine.result import LineCollision
from strikewave.base.constants import STANDARD_GRAVITY, Material, material
from strikewave.base.errors import MISSING, InputError, InputErrors, checked, nearest
from strikewave.base.quantities import Value
from strikewave.base.texts import percent
from strikewave.cases.case import Case, RotaryTables
from strikewave.cases.contact_of_case import face_contact, or_else, refuse_sliding
from strikewave.cases.stack_of_case import build_stack, build_taps
from strikewave.cases.tables.machine import AnyObject, LaunchedTable, OwnStriker, RotaryTable
from strikewave.contact import AnyContact
from strikewave.machines import Arm, Feed, Launch, Machine, RotaryDrive, Striker, Strikers, StruckObject, Turntable
from strikewave.machines import Striker as BuiltStriker
from strikewave.machines.drive import expected_time
from strikewave.machines.launch import fall_speed
from strikewave.machines.machine import BEFORE_TOUCH
from strikewave.machines.spans import Rebounds
from strikewave.machines.struck_object import LayeredObject, machine_grid
from strikewave.waves import Stack


def build_machine(case: Case) -> Machine:
    """Turn a case into the machine that runs: launched machines are built alike, whatever their kind."""
    kind = kind_of(case)
    return build_launched(case, kind) if isinstance(kind, LaunchedKind) else build_rotary(case)


LONGEST_FOLLOWED = 10.0  # s of rebounds where the case states none: a ball let go at 1 m with e = 0.8 rests after 4 s


def build_launched(case: Case, kind: LaunchedKind) -> Machine:
    """Turn a case of a machine without a drive into the machine that runs; see `build_machine`."""
    striker, struck, contact, _ = case.impact()
    refuse_sliding(contact)
    layered = layered_object(case)
    bodies = object_bodies(case, layered)
    mass = bodies.nose_mass + bodies.assembly_mass
    start, object_falls = kind.release(case, mass), kind.falls in ("object", "both")
    lines = [str(error) for error in (*kind.inconsistencies(case), *_inconsistencies(kind, case, start, mass))]
    if lines:
        raise InputErrors(lines)
    face = material(struck.material, "object.material")
    # an object that falls on what strikes it falls against the blow
    gravity = or_else(struck.gravity, -STANDARD_GRAVITY if object_falls else 0.0)
    flying = Striker(
        mass=striker.mass.si,
        mount_stiffness=or_else(striker.mount_stiffness, 0.0),
        mount_damping=or_else(striker.mount_damping, 0.0),
        contact=face_contact(striker, contact, face),
    )
    return Machine(
        strikers=Strikers((flying,), contact.slowest_approach.si, contact.yields == "face"),
        struck=_object(struck, bodies, gravity, object_falls),
        start=_launch(start, kind, gravity),
        layered=layered,
    )


def release(case: Case, mass: float | None = None) -> Release:
    """Return the release of the machine of a case; ``mass`` is that of the object where it is known, kg.

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
    bodies, rows = start.bodies, start.line.collisions
    return tuple(
        LineCollision(c.time, bodies[c.pair], bodies[c.pair + 1], *c.before, *c.after, c.impulse, c.energy_lost)
        for c in rows
    )


def _launch(start: Release, kind: LaunchedKind, gravity: float) -> Launch:
    """Return the start, `BEFORE_TOUCH` of a touch with the speeds of a release; gravity acts from there on."""
    dt, pendulum, arm, rebounds = BEFORE_TOUCH, start.pendulum, None, None
    if kind.falls == "both":  # alike, whichever way they go
        speeds, pull = (start.striker - gravity * dt, start.object - gravity * dt), gravity
    else:
        pull = STANDARD_GRAVITY if kind.falls == "striker" else 0.0
        speeds = _before(start.striker, pull, dt), _before(start.object, gravity, dt)
    if pendulum is not None:  # slower than at first touch by what its weight still gives it
        weight = pendulum.mass * STANDARD_GRAVITY * pendulum.centre
        left = 1.0 - math.cos(start.arm * dt)
        speed = math.sqrt(start.arm**2 - 2.0 * weight / pendulum.inertia * left)
        arm = Arm(pendulum.inertia, pendulum.radius, speed, weight)
    if _rebounds(kind):
        rebounds = Rebounds(int(or_else(kind.brake_after, 1.0)) if kind.until == "brake" else None)
    return Launch(*speeds, arm, pull, start.travel, longest_followed(kind), rebounds)


def _rebounds(kind: LaunchedTable) -> bool:
    """Tell whether a machine is followed over its rebounds."""
    return kind.until not in (None, "time")


def longest_followed(kind: LaunchedTable) -> float:
    """Return the longest time for which a machine is followed after first touch, s."""
    return or_else(kind.longest, LONGEST_FOLLOWED) if _rebounds(kind) else kind.follow.si


def _before(speed: float, gravity: float, time: float) -> float:
    """Return the speed u at the way u dt before the speed v is reached: v^2 = u^2 + 2 g u dt."""
    return math.copysign(math.hypot(speed, gravity * time), speed) - gravity * time if speed else 0.0


def _object(struck: AnyObject, bodies: Bodies, gravity: float, falls: bool) -> StruckObject:
    """Return the object with its supports; a support that is left out holds nothing."""
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
    """Yield an error for each pair of values that does not fit together in a machine without a drive of any kind."""
    struck = case.impact().object
    if struck.stiction is not None and struck.stiction.si < or_else(struck.friction, 0.0):
        allowed = f"at least object.friction ({or_else(struck.friction, 0.0):g} N)"
        yield InputError("object.stiction", struck.stiction.typed, allowed)
    samples = longest_followed(kind) / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the run below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        field = "machine.longest" if _rebounds(kind) else "machine.follow"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed, f"or a shorter {field}")
    if kind.brake_after is not None and kind.until != "brake":
        allowed = 'only with machine.until = "brake": nothing else brakes'
        yield InputError("machine.brake_after", kind.brake_after.typed, allowed, "remove it")
    if kind.longest is not None and not _rebounds(kind):
        allowed = 'only with machine.until = "rest" or "brake"'
        yield InputError("machine.longest", kind.longest.typed, allowed, "machine.follow is the time after first touch")
    if start.object != 0.0:  # it comes through the air: it has no support, and in a line no gravity of its own
        for key in ("spring", "preload", "damper", "stop_stiffness", "stop_restitution"):
            value = getattr(struck, key)
            if value is not None:
                yield InputError(f"object.{key}", value.typed, "none: nothing holds an object that moves", "remove it")
        if kind.falls == "both" and struck.gravity is not None:
            yield InputError("object.gravity", struck.gravity.typed, "none: the whole line falls alike", "remove it")
        return
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


def guided_fall(height: Value, friction: Value | None, mass: float) -> tuple[float, float, float]:
    """Return speed (m/s), time (s) and energy (J) of a fall from rest along a guide, its friction a share of weight."""
    share = or_else(friction, 0.0)
    speed = float(checked("machine.friction", lambda: fall_speed(height.si, friction=share)))
    return speed, 2.0 * height.si / speed, 0.5 * mass * speed**2


T = TypeVar("T")
TableT = TypeVar("TableT", bound=BaseModel)


def _strikers(tables: RotaryTables) -> Strikers:
    """Return the strikers, each with its own values where it has some."""
    face, count = material(tables.object.material, "object.material"), int(tables.machine.strikers.si)
    own: dict[int, OwnStriker] = {}
    for row in tables.striker.each:
        number = int(row.number.si)
        if number > count or number in own:
            allowed = f"each of the strikers 1 to {count} once at most"
            raise InputError(f"striker.each.{number}.number", row.number.typed, allowed)
        own[number] = row
    contact, common = tables.contact, face_contact(tables.striker, tables.contact, face)
    each = tuple([_striker(tables, own.get(number), common, face) for number in range(1, count + 1)])
    return Strikers(
        each,
        contact.slowest_approach.si,
        contact.yields == "face",
        or_else(contact.friction, 0.0),
        or_else(contact.sliding_damping, 0.0),
    )


def _striker(tables: RotaryTables, own: OwnStriker | None, common: AnyContact, face: Material) -> BuiltStriker:
    """Return one striker, as all are or with its own values."""
    given = {key: value for key, value in own or () if isinstance(value, Value)}
    table, pair = _with_own(tables.striker, given), _with_own(tables.contact, given)
    its_own = bool({"nose_radius", "contact_length", "restitution"} & given.keys())
    contact = face_contact(table, pair, face) if its_own else common
    errors = {key: or_else(getattr(table, key), 0.0) for key in ("angle_error", "reach_error")}
    return _filled(BuiltStriker, table, contact=contact, **errors)


def _with_own(table: TableT, given: dict[str, Value]) -> TableT:
    """Return a table with those of some values that are its own."""
    return table.model_copy(update={key: value for key, value in given.items() if key in type(table).model_fields})


def build_rotary(case: Case) -> Machine:
    """Turn a case of the rotary machine into the machine that runs; see `build_machine`."""
    tables, layered = case.rotary_tables(), layered_object(case)
    drive, feed = tables.machine, tables.feed
    turntable = _filled(
        Turntable,
        drive,
        motor_inertia=or_else(drive.motor_inertia, 0.0) * or_else(drive.belt_ratio, 1.0) ** 2,  # as at the turntable
        belt_stiffness=or_else(drive.belt_stiffness, math.inf),
        belt_damping=or_else(drive.belt_damping, 0.0),
        ripple=or_else(drive.speed_ripple, 0.0),
        ripple_order=or_else(drive.ripple_order, 1.0),
        ripple_phase=or_else(drive.ripple_phase, 0.0),
    )
    strokes = _filled(
        Feed,
        feed,
        blows=int(feed.blows.si),
        acceleration=or_else(feed.acceleration, 0.5),
        cushion=or_else(feed.cushion, 0.5),
        hold=or_else(feed.hold, math.inf),
    )
    angle, width = or_else(drive.blow_angle, 0.0), or_else(drive.face_width, math.inf)
    machine = Machine(
        strikers=_strikers(tables),
        struck=_object(tables.object, object_bodies(case, layered), tables.object.gravity.si, falls=False),
        start=RotaryDrive(turntable, strokes, drive.engagement.si, angle, width),
        layered=layered,
    )
    lines = [str(error) for error in rotary_inconsistencies(case, machine)]
    if lines:
        raise InputErrors(lines)
    return machine


def _filled(kind: type[T], table: BaseModel, **others: Any) -> T:
    """Return a part whose fields are the SI values of the same names in a table of the case, or ``others``."""
    names = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: others[name] if name in others else getattr(table, name).si for name in names})


MOST_SAMPLES = 2e6  # of the whole train: 16 MB a history; more is refused
LONGEST_INTERVAL = 0.5  # s between strikers: the bodies between two blows are followed in full, which then takes long
LARGEST_STRETCH = 0.1  # share of the radius by which a mount may stretch at set speed: the path is taken as a circle
FASTEST_BELT = 1e5  # rad/s at which turntable and motor may swing on the belt: beyond it the belt is rigid


def rotary_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for each pair of values of a rotary machine that does not fit together."""
    yield from _strike_inconsistencies(case.rotary_tables().machine, machine)
    yield from _striker_inconsistencies(case, machine)
    yield from _drive_inconsistencies(case, machine)
    yield from _object_inconsistencies(case, machine)
    yield from _feed_inconsistencies(case, machine)


def reach_beyond(machine: Machine, striker: Striker) -> float:
    """Return the reach of a nose beyond its place at the strike position while it is over the face, m.

    The largest f = R cos u - R0 cos a over the places s = R sin u + R0 sin a from the middle of the face: at its
    apex u = 0 if that lies over the face, else at the edge that it leaves by.
    """
    radius, angle = machine.radius + striker.reach_error, machine.drive.blow_angle
    aside, along = machine.radius * math.sin(angle), machine.radius * math.cos(angle)
    half = 0.5 * machine.drive.face_width
    if aside <= half:
        return radius - along
    return math.sqrt(max(radius**2 - (half - aside) ** 2, 0.0)) - along


def _strike_inconsistencies(m: RotaryTable, machine: Machine) -> Iterator[InputError]:
    """Yield an error for each way in which noses and face cannot meet as they should."""
    angle, radius, q = machine.drive.blow_angle, machine.radius, machine.engagement
    if not 0.0 <= angle <= 0.5 * math.pi:
        typed = m.blow_angle.typed if m.blow_angle else angle
        yield InputError("machine.blow_angle", typed, "from 0 (as a cam) to 90 deg (along the path)")
        return
    half = 0.5 * machine.pitch
    turn = min(half + angle, math.pi) if angle else min(half, 0.5 * math.pi)
    most = radius * (math.cos(angle) - math.cos(turn))
    if q >= most:
        allowed = f"less than {most * 1e3:.4g} mm, where a nose would touch more than half a pitch before its apex"
        yield InputError("machine.engagement", m.engagement.typed, allowed)
        return
    if m.face_width is None:
        if angle > 0.0:
            allowed = "the width of the face across the blow, after which the nose lets go"
            yield InputError("machine.face_width", MISSING, allowed, 'such as face_width = "20 mm"')
        return
    across = abs(radius * (math.sin(machine.drive.first_touch - angle) + math.sin(angle)))
    if across >= 0.5 * machine.drive.face_width:
        allowed = f"more than {2e3 * across:.4g} mm: a nose first touches {across * 1e3:.4g} mm from the middle"
        yield InputError("machine.face_width", m.face_width.typed, allowed, "it would meet the edge")
    way = 0.5 * machine.drive.face_width / radius - math.sin(angle)
    if angle > 0.0 and (way >= 1.0 or angle + math.asin(way) >= half):
        allowed = "small enough that a nose has left it half a pitch after the strike position"
        yield InputError("machine.face_width", m.face_width.typed, allowed)


def _striker_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for each striker that its mount cannot hold, or that stands in another's place."""
    w, radius, half = machine.drive.turntable.speed, machine.radius, 0.5 * machine.pitch
    lasts, values = 0.0, case.values()
    if abs(math.cos(machine.drive.blow_angle) - machine.engagement / radius) <= 1.0:
        lasts = max(abs(machine.drive.first_touch), machine.drive.leaves)
    named: set[str] = set()
    for number, striker in enumerate(machine.strikers.each, start=1):
        stretch = striker.mass * w**2 / striker.mount_stiffness
        faults = {}
        if stretch > LARGEST_STRETCH:
            by = percent(stretch, 0)
            faults["mount_stiffness"] = (
                f"enough to hold the striker on its circle (it would stretch by {by} of the radius)"
            )
        if striker.angle_error != 0.0 and abs(striker.angle_error) + lasts >= half:
            most = max(half - lasts, 0.0)
            faults["angle_error"] = f"within {most:.3g} rad: beyond, a blow falls into the time of the next striker"
        for key, allowed in faults.items():  # of a value of all strikers once, of a striker's own by its number
            own = f"striker.each.{number}.{key}"
            path = own if own in values else f"striker.{key}"
            if path not in named:
                named.add(path)
                yield InputError(path, values[path].typed if path in values else MISSING, allowed)
    yield from _overlaps(case, machine)


def _overlaps(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for the first two noses that overlap."""
    striker, each = case.rotary_tables().striker, machine.strikers.each
    count, pitch = len(each), machine.pitch
    own = {int(row.number.si): row.nose_radius for row in striker.each if row.nose_radius is not None}
    for i in range(count if count > 1 else 0):
        following = (i + 1) % count
        apart = pitch - each[following].angle_error + each[i].angle_error
        chord = 2.0 * machine.radius * math.sin(0.5 * min(max(apart, 0.0), math.pi))
        both = own.get(i + 1, striker.nose_radius).si + own.get(following + 1, striker.nose_radius).si
        if chord <= both:
            allowed = f"fewer, or smaller noses: {i + 1} and {following + 1} overlap "
            allowed += f"({chord * 1e3:.3g} mm from axis to axis, noses of {both * 1e3:.3g} mm together)"
            yield InputError("machine.strikers", case.rotary_tables().machine.strikers.typed, allowed)
            return


def _drive_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for a drive that cannot do what is asked, or that no step could follow."""
    m, disc = case.rotary_tables().machine, machine.drive.turntable
    interval = machine.pitch / disc.speed
    drag = disc.drag * disc.speed
    if drag >= disc.torque:
        allowed = f"more than the drag at set speed ({drag:.4g} N m)"
        yield InputError("machine.torque", m.torque.typed, allowed, "the drive cannot hold the speed")
    if interval > LONGEST_INTERVAL:
        allowed = f"a striking interval of at most {LONGEST_INTERVAL:g} s (here {interval:.3g} s)"
        yield InputError("machine.speed", m.speed.typed, allowed, "turn faster, or take more strikers")
    carried = sum([striker.mass * (disc.radius + striker.reach_error) ** 2 for striker in machine.strikers.each])
    if disc.inertia <= carried:
        allowed = f"more than that of the strikers alone ({carried:.4g} kg m^2)"
        yield InputError("machine.inertia", m.inertia.typed, allowed, "it includes them")
    if m.belt_stiffness is None:
        return
    if disc.motor_inertia == 0.0:
        yield InputError("machine.motor_inertia", MISSING, "above zero where the belt gives way", "or leave the belt")
        return
    rate = math.sqrt(disc.belt_stiffness * (1.0 / disc.inertia + 1.0 / disc.motor_inertia))
    if rate > FASTEST_BELT:
        allowed = f"one on which motor and turntable swing with less than {FASTEST_BELT:g} rad/s (here {rate:.3g})"
        yield InputError("machine.belt_stiffness", m.belt_stiffness.typed, allowed, "leave it out: the belt is rigid")
    if m.speed_ripple is not None and disc.ripple > 0.0:
        allowed = "none with machine.belt_stiffness: what the belt passes on of the motor's ripple is not that share"
        yield InputError("machine.speed_ripple", m.speed_ripple.typed, allowed, "leave one of them out")


def _object_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for an object that its spring, frame or rail cannot hold."""
    o, struck = case.rotary_tables().object, machine.struck
    weight = struck.mass * struck.gravity
    if struck.preload <= weight:
        allowed = f"more than the weight along the blow ({weight:.4g} N)"
        yield InputError("object.preload", o.preload.typed, allowed, "the spring must hold the object on its stop")
    sag = struck.nose_mass * abs(struck.gravity) / struck.frame_stiffness
    if sag > 0.01 * machine.engagement:
        allowed = f"enough to carry the nose (its weight bends the frame by {sag * 1e3:.3g} mm)"
        yield InputError("object.frame_stiffness", f"{struck.frame_stiffness:.4g} N/m", allowed)
    if o.stiction is not None and o.stiction.si < struck.friction:
        yield InputError("object.stiction", o.stiction.typed, f"at least object.friction ({struck.friction:g} N)")


def _feed_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for a feed that does not clear the strikers, or whose times do not fit."""
    f, feed = case.rotary_tables().feed, machine.drive.feed
    beyond = max([reach_beyond(machine, striker) for striker in machine.strikers.each])
    least = machine.engagement + max(beyond, 0.0)
    if feed.stroke <= least:
        allowed = f"more than machine.engagement ({case.rotary_tables().machine.engagement.typed})"
        if beyond > 0.0:
            allowed = f"more than {least * 1e3:.4g} mm, how far the noses reach over the face at rest"
        yield InputError("feed.stroke", f.stroke.typed, allowed, "a shorter stroke does not clear the strikers")
    if feed.acceleration + feed.cushion > 1.0:
        allowed = f"at most 1 together with feed.acceleration ({feed.acceleration:g})"
        yield InputError("feed.cushion", feed.cushion, allowed, "they are shares of the same stroke's time")
    samples = expected_time(feed, machine.pitch / machine.drive.turntable.speed) / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the train below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed)


FINEST_STEP, COARSEST_STEP = 1e-9, 1e-6  # s, of a struck stack: finer ones take minutes, coarser ones lose the contact
MOST_STACK_BLOWS = 100  # about 1 MB of waves is kept of each
_OF_BODIES = ("mass", "nose_mass", "frame_stiffness", "frame_damping")


class Bodies(NamedTuple):
    """The object as two bodies on a frame, SI."""

    nose_mass: float
    assembly_mass: float
    frame_stiffness: float
    frame_damping: float


def _refuse_waves_alone(case: Case, stack: Stack) -> None:
    """Refuse what only a bar alone can have: other solvers than delay lines, oscillators, contacts between layers."""
    hint = "`strikewave wave` takes it, for the stack under a [load]"
    if case.solver.method == "spectral":
        raise InputError("solver.method", case.solver.method, "auto or delay lines where a machine strikes", hint)
    if case.solver.dispersion != "none":
        raise InputError("solver.dispersion", case.solver.dispersion, "none where a machine strikes", hint)
    for table, layer in zip(case.stack.layer, stack.layers, strict=True):
        if layer.loss is not None and table.loss_factor is not None:
            allowed = "no loss in a layer that a machine strikes"
            raise InputError(f"stack.layer.{layer.name}.loss_factor", table.loss_factor.typed, allowed, hint)
    for layer, joint in zip(stack.layers, stack.joints, strict=False):
        if joint.kind in ("oscillator", "contact"):
            allowed = "bonded, compliant, gasket, unilateral or mass where a machine strikes"
            raise InputError(f"stack.joint.{layer.name}.kind", joint.kind, allowed, hint)


def layered_object(case: Case) -> LayeredObject | None:
    """Return the object as a stack, if the case has one."""
    table = case.impact().object
    if not case.stack.layer:
        return None
    given = [key for key in _OF_BODIES if getattr(table, key) is not None]
    if given:
        allowed = "none of " + ", ".join(_OF_BODIES) + " where the object is a stack: they follow from it"
        raise InputError(f"object.{given[0]}", getattr(table, given[0]).typed, allowed, "remove it")
    names = [layer.name for layer in case.stack.layer]
    if table.assembly not in names[1:]:
        allowed = "the first layer of the part that carries the sensor, not the struck one"
        hint = nearest(table.assembly, names[1:]) if names[1:] else "cut the object in two layers at least"
        raise InputError("object.assembly", table.assembly or MISSING, allowed, hint)
    stack = build_stack(case)
    _refuse_waves_alone(case, stack)
    if stack.end.kind != "free":
        allowed = "free: spring, damper and stop of [object] hold the end"
        raise InputError("stack.end.kind", stack.end.kind, allowed, "`strikewave wave` takes every end")
    moving = next((layer for layer in stack.layers if layer.speed), None)
    if moving is not None:
        raise InputError(f"stack.layer.{moving.name}.speed", moving.speed, "no speed of its own: a striker hits it")
    frame = stack.joints[names.index(table.assembly) - 1]
    if frame.mass > 0.0 or (frame.unilateral and frame.preload == 0.0):
        allowed = "a joint that holds: the frame before the assembly is bonded, compliant, gasket or preloaded"
        raise InputError(f"stack.joint.{names[names.index(table.assembly) - 1]}.kind", frame.kind, allowed)
    if case.feed is not None and case.feed.blows.si > MOST_STACK_BLOWS:
        allowed = f"at most {MOST_STACK_BLOWS} where the object is a stack"
        raise InputError("feed.blows", case.feed.blows.typed, allowed, "its waves are kept for each blow")
    step = case.solver.step.si if case.solver.step else None
    if step is not None and not FINEST_STEP <= step <= COARSEST_STEP:
        allowed = f"{FINEST_STEP * 1e9:g} to {COARSEST_STEP * 1e9:g} ns where a machine strikes a stack"
        raise InputError(
            "solver.step", case.solver.step.typed if case.solver.step else step, allowed, "or leave it out"
        )
    grid = checked("solver.step", lambda: machine_grid(stack, step))
    taps = tuple((tap.layer, tap.position) for _, tap in build_taps(case))
    return LayeredObject(stack, names.index(table.assembly), grid, taps)


def object_bodies(case: Case, layered: LayeredObject | None) -> Bodies:
    """Return nose, frame and assembly, as stated in the case or as they follow from the stack."""
    if layered is not None:
        return Bodies(layered.nose_mass, layered.assembly_mass, layered.frame_stiffness, layered.frame_damping)
    table = case.impact().object
    if table.assembly:
        raise InputError("object.assembly", table.assembly, "only where the object is a stack", "add [[stack.layer]]")
    missing = [key for key in _OF_BODIES if getattr(table, key) is None]
    if missing:
        raise InputErrors(
            [f"object.{key}: missing; add {key}, or describe the object by [[stack.layer]]" for key in missing]
        )
    mass, nose, stiffness, damping = [getattr(table, key) for key in _OF_BODIES]
    if nose.si >= mass.si:
        raise InputError("object.nose_mass", nose.typed, f"less than object.mass ({mass.typed})")
    return Bodies(nose.si, mass.si - nose.si, stiffness.si, damping.si)
