"""The tables of a case file as frozen models: which fields each has, and what each may be."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict

from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import (
    Acceleration,
    BlowCount,
    Count,
    Damping,
    Duration,
    FeedTime,
    FollowTime,
    Force,
    Frequency,
    Inertia,
    Length,
    Mass,
    MaybeAcceleration,
    MaybeAngle,
    MaybeArea,
    MaybeBits,
    MaybeBlowCount,
    MaybeCoefficient,
    MaybeContactPressure,
    MaybeDamping,
    MaybeDensity,
    MaybeError,
    MaybeExponent,
    MaybeForce,
    MaybeFrequency,
    MaybeFriction,
    MaybeGap,
    MaybeGravity,
    MaybeHold,
    MaybeInertia,
    MaybeLayerSpeed,
    MaybeLength,
    MaybeLongest,
    MaybeLoss,
    MaybeMass,
    MaybeModulus,
    MaybeOffset,
    MaybeOrder,
    MaybePoisson,
    MaybePositiveForce,
    MaybePreload,
    MaybeQuality,
    MaybeRatio,
    MaybeRestitution,
    MaybeRipple,
    MaybeRotationDrag,
    MaybeRotationRate,
    MaybeShare,
    MaybeShift,
    MaybeSpeed,
    MaybeSpringRate,
    MaybeStep,
    MaybeStrength,
    MaybeStrokeShare,
    MaybeTime,
    MaybeTurns,
    OutputStep,
    Range,
    Restitution,
    Rotation,
    RotationDrag,
    RotationGain,
    SampleCount,
    Share,
    Speed,
    SpringRate,
    StrikerNumber,
    Tolerance,
    Torque,
    Value,
)
from strikewave.cases.law_names import ContactName, CushionName, DampingName, StiffnessName
from strikewave.cases.plausible import GoesWith

PUBLISHED_QUANTITIES = {
    "first.rigid_peak": "m/s^2",
    "first.total_peak": "m/s^2",
    "first.wave_peak": "m/s^2",
    "first.sensor_peak": "m/s^2",
    "first.sensor_width": "s",
    "first.width": "s",
    "first.peak_force": "N",
    "first.contact_time": "s",
    "first.approach_speed": "m/s",
    "first.rebound_speed": "m/s",
    "first.restitution": "",
    "first.indentation": "m",
    "first.residual_indentation": "m",
    "first.velocity_change": "m/s",
    "first.force_width": "s",
    "first.force_over_mass": "m/s^2",
    "typical.rigid_peak": "m/s^2",
    "typical.width": "s",
    "count": "",
    "window": "s",
}
"""What a published number can be compared with: its name and SI unit.

``force_width`` and ``force_over_mass`` are those of explicit finite elements. There ``width`` of a part or group is
that of the one pulse round its peak, where it first falls below a tenth of it on either side; ``force_width`` runs
from the first to the last tenth of the peak of the force, with gaps between contacts.
"""
LONGEST_NAME, LONGEST_CASE_NAME = 40, 80
"""Characters of a name that stands in paths and heads of columns, and of a case, which names a folder: a table and a
path still fit a line."""


class CaseTable(BaseModel):
    """What every table of a case is: frozen, without unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


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


class CushionTable(CaseTable):
    """[contact.cushion], [stack.joint.cushion]: a pad with its area (or diameter) and thickness.

    ``material`` is a row of the cushion materials, ``law`` a cushion law where none is named; the law says which
    properties it takes, and what is given overrules the row. What it loses beside the restitution of a contact is a
    ``retardation``, or the ``loss_factor`` that it has at a ``loss_frequency``. After ``blows_before`` it has lost
    ``settling`` of its thickness in each blow, and grown stiffer by ``stiffening``.
    """

    law: CushionName = ""
    material: str = ""
    area: MaybeArea = None
    diameter: MaybeLength = None
    thickness: Length
    modulus: MaybeModulus = None
    stress: MaybeStrength = None
    exponent: MaybeExponent = None
    limit_strain: MaybeShare = None
    compression_factor: MaybeLoss = None
    shape_factor: MaybeLoss = None
    plateau: MaybeStrength = None
    densification: MaybeShare = None
    retardation: MaybeTime = None
    loss_factor: MaybeLoss = None
    loss_frequency: MaybeFrequency = None
    blows_before: MaybeBlowCount = None
    settling: MaybeShare = None
    stiffening: MaybeShare = None


class ContactTable(CaseTable):
    """[contact]: law of the contact between nose and face; with a yield pressure it is elastic-plastic.

    ``yield_pressure`` is the largest pressure that the contact bears, or "auto": that of the softer material
    (`strikewave.contact.automatic_pressure`).

    What has yielded stays: on the face, where all strikers hit the same spot, or on each nose (``yields``).
    The law "power", that of a pulse shaper or of a measured contact, is F = K d^n with K from ``reference_force`` at
    ``reference_depth`` and n = ``exponent`` (1). The law "cushion" is that of the pad of [contact.cushion].
    The nose of a rotary machine slides across the face: against ``friction`` (Coulomb's coefficient) and a viscous
    ``sliding_damping``; none where they are left out.
    """

    law: ContactName = "palmgren"
    damping: DampingName = "exact"
    restitution: Restitution
    slowest_approach: Speed
    reference_force: MaybePositiveForce = None
    reference_depth: MaybeLength = None
    exponent: MaybeExponent = None
    datum_depth: MaybeLength = None
    yield_pressure: MaybeContactPressure = None
    yields: Literal["face", "nose"] = "face"
    cushion: CushionTable | None = None
    friction: MaybeCoefficient = None
    sliding_damping: MaybeDamping = None


class RecorderTable(CaseTable):
    """[recorder]: triggered by the valve signal, or at the start of a machine without one."""

    sampling_rate: Frequency
    delay: Duration
    pre_trigger: Duration
    memory: SampleCount

    @property
    def begin(self) -> float:
        """Time of the first sample after the valve signal, s."""
        return self.delay.si - self.pre_trigger.si


def _name(raw: Any) -> Any:
    """Check a name that stands in paths and heads of columns."""
    if isinstance(raw, str) and re.fullmatch(rf"[^\W_][\w +-]{{0,{LONGEST_NAME - 1}}}", raw) and not raw.isdigit():
        return raw
    allowed = f"a letter or digit, then also space, +, - and _, at most {LONGEST_NAME} in all, not a number alone"
    raise InputError("", raw, allowed)


Name = Annotated[str, BeforeValidator(_name)]


class LayerTable(CaseTable):
    """[[stack.layer]]: loaded at its first face; material, or density and modulus; diameter, or area.

    With a ``loss_factor`` it loses energy, evenly from ``band_low`` to ``band_high`` (1 and 100 kHz where left out),
    and the modulus is that in the middle of the band; the loss factor of a named material is not taken unasked.
    """

    name: Name
    material: str = ""
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    poissons_ratio: MaybePoisson = None
    loss_factor: MaybeLoss = None
    band_low: MaybeFrequency = None
    band_high: MaybeFrequency = None
    length: Length
    diameter: MaybeLength = None
    area: MaybeArea = None
    speed: MaybeLayerSpeed = None


class JointTable(CaseTable):
    """[[stack.joint]]: the joint behind the layer that ``after`` names; bonded where none is named.

    A gasket has a thickness, an area (or diameter; else that of the thinner neighbour) and a material, or a
    modulus and a loss factor that holds from ``band_low`` to ``band_high`` (1 and 100 kHz where left out).
    An oscillator is a sensor's mass on a spring that sits on bonded faces: mass, stiffness or resonance, damping or
    quality. A contact is a nonlinear one by the elastic law ``law`` between the materials of its neighbours: radius
    of the first face on the second, which is plane, length of a line; gap or preload, yield_pressure (as of [contact]).
    A cushion is the pad of [stack.joint.cushion], without mass of its own, that pushes only; gap or preload.
    """

    after: Name
    kind: Literal["bonded", "compliant", "gasket", "unilateral", "mass", "oscillator", "contact", "cushion"]
    stiffness: MaybeSpringRate = None
    damping: MaybeDamping = None
    gap: MaybeGap = None
    preload: MaybePreload = None
    mass: MaybeMass = None
    material: str = ""
    modulus: MaybeModulus = None
    loss_factor: MaybeLoss = None
    thickness: MaybeLength = None
    diameter: MaybeLength = None
    area: MaybeArea = None
    band_low: MaybeFrequency = None
    band_high: MaybeFrequency = None
    resonance: MaybeFrequency = None
    quality: MaybeQuality = None
    law: StiffnessName = ""
    radius: MaybeLength = None
    length: MaybeLength = None
    datum_depth: MaybeLength = None
    yield_pressure: MaybeContactPressure = None
    cushion: CushionTable | None = None


class EndTable(CaseTable):
    """[stack.end]: the far end; mass, stiffness or damping for the kinds that need one.

    An oscillator is a sensor's mass on a spring: mass, stiffness or resonance, damping or quality.
    """

    kind: Literal["free", "matched", "rigid", "mass", "spring", "dashpot", "oscillator"] = "free"
    mass: MaybeMass = None
    stiffness: MaybeSpringRate = None
    damping: MaybeDamping = None
    resonance: MaybeFrequency = None
    quality: MaybeQuality = None


class StackTable(CaseTable):
    """[stack]: layers from the loaded face on, joints between them, and the far end."""

    layer: tuple[LayerTable, ...] = ()
    joint: tuple[JointTable, ...] = ()
    end: EndTable = EndTable()


class LoadTable(CaseTable):
    """[load]: a force pulse of a shape, a file (time and force, or speed of the face), or a contact.

    A contact is the rigid [striker] that comes with ``speed`` under the law of [contact]. A force ``applied`` as
    "incident wave" is the wave that arrives along an endless bar like the first layer.
    """

    shape: Literal["half-sine", "sine-squared", "rectangle", "triangle", "trapezoid", "file", "contact"]
    peak: MaybeForce = None
    duration: MaybeTime = None
    rise: MaybeTime = None
    applied: Literal["force", "incident wave"] = "force"
    file: str = ""
    speed: MaybeSpeed = None


class TapTable(CaseTable):
    """[[tap]]: where a stack is watched; ``position`` is the fraction of the layer from its loaded side."""

    name: Name
    layer: str
    position: Share = Value(si=0.5, typed=0.5)


class GasketTable(CaseTable):
    """[[sensor.gasket]]: a layer under a buffered sensor, from the mounting surface up."""

    material: str = ""
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    loss_factor: MaybeLoss = None
    thickness: Length
    diameter: MaybeLength = None
    area: MaybeArea = None


class SensorTable(CaseTable):
    """[[sensor]]: an accelerometer at a tap or at the rigid assembly, its mounting and its recorder.

    With gaskets it is buffered: ``mass`` is then its own, and the edge is what the gaskets stand on; without
    them it is mounted directly.
    ``model`` names one of the known accelerometers; resonance, quality and range overrule it. ``recorder`` is
    "storage" (that of [recorder]), "oscilloscope", or "ideal"; sampling_rate, cutoff, order and bits overrule it.
    """

    name: Name
    tap: str = ""
    model: str = ""
    resonance: MaybeFrequency = None
    quality: MaybeQuality = None
    range: MaybeAcceleration = None
    zero_shift: MaybeShift = None
    mass: MaybeMass = None
    gasket: tuple[GasketTable, ...] = ()
    edge_stiffness: MaybeSpringRate = None
    edge_damping: MaybeDamping = None
    recorder: Literal["storage", "oscilloscope", "ideal"] = "ideal"
    sampling_rate: MaybeFrequency = None
    cutoff: MaybeFrequency = None
    order: MaybeOrder = None
    bits: MaybeBits = None


class Solver(CaseTable):
    """[solver]: how exactly to compute, and how densely to keep the whole train.

    ``duration`` is that of a bar alone, ``error`` the wanted one of its velocities over their peak (1e-3; that of
    accelerations is ten times as large), ``step`` the time step of waves (chosen where left out), and
    ``bandwidth`` that at which total and wave acceleration are stated (chosen where left out). ``route`` is "exact",
    or one of the routes of Li & Ma 2019, which take the neighbours of a tap's layer as endless. ``method`` is
    "auto": delay lines, but the spectral solver where layers lose energy or disperse; ``dispersion`` slows short
    waves in every layer that has a Poisson's ratio.
    """

    tolerance: Tolerance = Value(si=1e-9, typed=1e-9)
    output_step: OutputStep = Value(si=1e-5, typed="10 us")
    duration: MaybeTime = None
    step: MaybeStep = None
    error: MaybeError = None
    bandwidth: MaybeFrequency = None
    route: Literal["exact", "as printed", "corrected"] = "exact"
    method: Literal["auto", "delay lines", "spectral"] = "auto"
    dispersion: Literal["none", "love-rayleigh", "pochhammer-chree"] = "none"


class Published(CaseTable):
    """[[published]]: a number to compare the result with; ``sensor`` names the one it was read from.

    In a finite-element case ``sensor`` is the part or group that moves. Its ``origin`` is a measurement, a simulation,
    or what a standard specifies.
    """

    quantity: str
    sensor: str = ""
    value: Value
    origin: Literal["measured", "simulated", "specified"]
    role: Literal["fitted", "predicted", "shown"]
    note: str = ""


def read_published(raw: Any) -> Any:
    """Read a published number in the unit of the quantity it names."""
    if not isinstance(raw, Mapping) or "quantity" not in raw or "value" not in raw:
        return raw
    quantity, value = raw["quantity"], raw["value"]
    if not isinstance(quantity, str) or quantity not in PUBLISHED_QUANTITIES:
        raise InputError("quantity", quantity, "a computed quantity", nearest(str(quantity), PUBLISHED_QUANTITIES))
    unit = PUBLISHED_QUANTITIES[quantity]
    if isinstance(value, Value):
        return raw
    read = Range(unit, 0.0, open_low=True).read(value)
    if read.tolerance is not None:
        raise InputError("value.tolerance", read.tolerance.typed, "no tolerance on a published number", "remove it")
    return {**raw, "value": read.model_copy(update={"provenance": "published"})}


def case_name(raw: Any) -> Any:
    """Check the name of a case: it names a folder."""
    if isinstance(raw, str) and not re.fullmatch(rf"[\w][\w .+-]{{0,{LONGEST_CASE_NAME - 1}}}|", raw):
        allowed = f"letters, digits, space, dot, +, - and _, at most {LONGEST_CASE_NAME}"
        raise InputError("", raw, allowed, "the name becomes a folder's")
    return raw
