"""[machine] with what strikes, what feeds and what is struck."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from strikewave.base.quantities import (
    Acceleration,
    BlowCount,
    Count,
    Damping,
    Duration,
    FeedTime,
    FollowTime,
    Force,
    Inertia,
    Length,
    Mass,
    MaybeAngle,
    MaybeBlowCount,
    MaybeDamping,
    MaybeFriction,
    MaybeGravity,
    MaybeHold,
    MaybeInertia,
    MaybeLength,
    MaybeLongest,
    MaybeMass,
    MaybeOffset,
    MaybePreload,
    MaybeRatio,
    MaybeRestitution,
    MaybeRipple,
    MaybeRotationDrag,
    MaybeRotationRate,
    MaybeSpringRate,
    MaybeStrokeShare,
    MaybeTurns,
    Restitution,
    Rotation,
    RotationDrag,
    RotationGain,
    Share,
    SpringRate,
    StrikerNumber,
    Torque,
    Value,
)
from strikewave.cases.plausible import GoesWith
from strikewave.cases.tables.common import CaseTable


class MachineTable(CaseTable):
    """[machine] of any kind."""

    kind: str


class RotaryTable(MachineTable):
    """[machine]: a rotary machine.

    ``blow_angle`` is that between the outward radius and the blow at the strike position: 0, where it is left out, is
    a cam, 90 deg is a blow along the path; a blow at an angle needs a ``face_width`` after which the nose lets go.
    Motor and belt: turns of the motor a turn (1), its inertia (0), and the belt's stiffness (rigid) at the turntable;
    ``torque`` is that behind the belt. The speed may ripple by a share, so many times a turn (1).
    """

    kind: Literal["rotary"]
    speed: Rotation
    strikers: Count
    radius: Length
    engagement: Length
    inertia: Inertia
    torque: Torque
    speed_gain: RotationGain
    drag: RotationDrag
    brake: Torque
    blow_angle: MaybeAngle = None
    face_width: MaybeLength = None
    belt_ratio: MaybeRatio = None
    motor_inertia: MaybeInertia = None
    belt_stiffness: MaybeRotationRate = None
    belt_damping: MaybeRotationDrag = None
    speed_ripple: MaybeRipple = None
    ripple_order: MaybeTurns = None
    ripple_phase: MaybeAngle = None


class LaunchedTable(MachineTable):
    """[machine] without a drive: ``follow``, how long it is followed after first touch (10 ms).

    ``until`` may say instead that it is followed over its rebounds: until it rests ("rest"), or until a brake catches
    it at the top of its rebound ("brake") after so many blows (``brake_after``, 1); but not beyond ``longest`` (10 s).
    """

    follow: FollowTime = Value(si=10e-3, typed="10 ms")
    until: Literal["time", "rest", "brake"] | None = None
    brake_after: MaybeBlowCount = None
    longest: MaybeLongest = None

    def goes_with(self) -> Mapping[str, GoesWith]:
        """Return, by path, the quantities that cannot be drawn apart from others; none, unless a kind has some."""
        return {}


class OwnStriker(CaseTable):
    """[[striker.each]]: what one striker, by its ``number`` from 1, has for itself.

    ``angle_error`` is how far it stands ahead of its place, ``reach_error`` how far beyond the others' radius;
    ``restitution`` stands for that of [contact].
    """

    number: StrikerNumber
    mass: MaybeMass = None
    nose_radius: MaybeLength = None
    contact_length: MaybeLength = None
    mount_stiffness: MaybeSpringRate = None
    mount_damping: MaybeDamping = None
    angle_error: MaybeAngle = None
    reach_error: MaybeOffset = None
    restitution: MaybeRestitution = None


class AnyStriker(CaseTable):
    """[striker]: what strikes; without a mount it is free. The contact law says which sizes of its nose it needs."""

    mass: Mass
    material: str
    nose_radius: MaybeLength = None
    contact_length: MaybeLength = None
    mount_stiffness: MaybeSpringRate = None
    mount_damping: MaybeDamping = None


class StrikerTable(AnyStriker):
    """[striker]: the impact component on its mount; strikers that differ have rows of their own.

    ``angle_error`` and ``reach_error`` are those of every striker (0): they are there for their tolerances.
    """

    nose_radius: Length
    contact_length: Length
    mount_stiffness: SpringRate
    mount_damping: Damping
    angle_error: MaybeAngle = None
    reach_error: MaybeOffset = None
    each: tuple[OwnStriker, ...] = ()


class FeedTable(CaseTable):
    """[feed]: the hydraulic feed.

    ``acceleration`` and ``cushion`` are the shares of a stroke's time in which it speeds up and is cushioned (halves);
    ``hold`` is the longest time in the strike position.
    """

    blows: BlowCount
    wait: Duration
    valve_delay: FeedTime
    stroke: Length
    stroke_time: FeedTime
    arrival: Share
    release_delay: FeedTime
    retract_time: FeedTime
    acceleration: MaybeStrokeShare = None
    cushion: MaybeStrokeShare = None
    hold: MaybeHold = None


class AnyObject(CaseTable):
    """[object]: everything that moves when struck, and what holds it; gravity above 0 pushes it away.

    The object is either a nose on a frame (mass, nose_mass, frame_stiffness, frame_damping), or a stack
    (``assembly`` names the first layer of the part that carries the sensor). ``friction`` is that of its rails while
    it slides, ``stiction`` the most while it sticks (as much where left out). A support that is left out is none.
    """

    mass: MaybeMass = None
    nose_mass: MaybeMass = None
    frame_stiffness: MaybeSpringRate = None
    frame_damping: MaybeDamping = None
    assembly: str = ""
    material: str
    spring: MaybeSpringRate = None
    preload: MaybePreload = None
    damper: MaybeDamping = None
    stop_stiffness: MaybeSpringRate = None
    stop_restitution: MaybeRestitution = None
    gravity: MaybeGravity = None
    friction: MaybeFriction = None
    stiction: MaybeFriction = None


class Object(AnyObject):
    """[object]: everything that moves when struck, and what holds it; gravity above 0 pushes it away.

    See `AnyObject`; in a rotary machine spring, damper and stop bring it back.
    """

    spring: SpringRate
    preload: Force
    damper: Damping
    stop_stiffness: SpringRate
    stop_restitution: Restitution
    gravity: Acceleration
