"""What does not fit together in a rotary machine: pairs of values that are fine one by one."""

from __future__ import annotations

import math
from collections.abc import Iterator

from strikewave.base.errors import MISSING, InputError
from strikewave.base.percents import percent
from strikewave.cases.case import Case
from strikewave.cases.tables.machine import RotaryTable
from strikewave.machines import Machine, Striker
from strikewave.machines.drive import expected_time

MOST_SAMPLES = 2e6
"""Samples of the whole train beyond which a solution is refused."""
LONGEST_INTERVAL = 0.5
"""Longest time between strikers, s: the bodies between two blows are followed in full."""
LARGEST_STRETCH = 0.1
"""Share of the radius by which a striker may stretch its mount at set speed."""
FASTEST_BELT = 1e5
"""Highest rate at which turntable and motor may swing on the belt, rad/s: beyond it the belt is rigid."""


def inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for each pair of values of a rotary machine that does not fit together."""
    yield from _strike_inconsistencies(case.rotary_tables().machine, machine)
    yield from _striker_inconsistencies(case, machine)
    yield from _drive_inconsistencies(case, machine)
    yield from _object_inconsistencies(case, machine)
    yield from _feed_inconsistencies(case, machine)


def reach_beyond(machine: Machine, striker: Striker) -> float:
    """Return how far a nose reaches beyond its place at the strike position while it is over the face, m.

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


def _of(case: Case, number: int, key: str) -> str:
    """Return the path of a value of one striker: its own where it has one, else that of all."""
    rows = {int(row.number.si): row for row in case.rotary_tables().striker.each}
    own = number in rows and getattr(rows[number], key) is not None
    return f"striker.each.{number}.{key}" if own else f"striker.{key}"


def _typed(case: Case, path: str) -> object:
    value = case.values().get(path)
    return MISSING if value is None else value.typed


def _striker_inconsistencies(case: Case, machine: Machine) -> Iterator[InputError]:
    """Yield an error for each striker that its mount cannot hold, or that stands in another's place."""
    w, radius, half = machine.drive.turntable.speed, machine.radius, 0.5 * machine.pitch
    lasts = 0.0
    if abs(math.cos(machine.drive.blow_angle) - machine.engagement / radius) <= 1.0:
        lasts = max(abs(machine.drive.first_touch), machine.drive.leaves)
    named: set[str] = set()
    for number, striker in enumerate(machine.strikers.each, start=1):
        stretch = striker.mass * w**2 / striker.mount_stiffness
        path = _of(case, number, "mount_stiffness")
        if stretch > LARGEST_STRETCH and path not in named:
            named.add(path)
            allowed = (
                f"enough to hold the striker on its circle (it would stretch by {percent(stretch, 0)} of the radius)"
            )
            yield InputError(path, _typed(case, path), allowed)
        path = _of(case, number, "angle_error")
        beyond = striker.angle_error != 0.0 and abs(striker.angle_error) + lasts >= half
        if beyond and path not in named:
            named.add(path)
            allowed = f"within {max(half - lasts, 0.0):.3g} rad: beyond, a blow falls into the time of the next striker"
            yield InputError(path, _typed(case, path), allowed)
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
        both = sum(own.get(k + 1, striker.nose_radius).si for k in (i, following))
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
    carried = sum(striker.mass * (disc.radius + striker.reach_error) ** 2 for striker in machine.strikers.each)
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
    beyond = max(reach_beyond(machine, striker) for striker in machine.strikers.each)
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
