"""Plausible ranges of the fields that nobody can weigh or read off, and the fields that a band leaves alone.

A stiffness of a joint, a damping, a restitution or an engagement stands in a case as one number, yet nobody knows it
so well. Here each has its range about that number, with its reason; a value in the middle of a range is as likely as
one at its end. `strikewave.uncertainty.input_ranges` says when the range counts.

A path names tables and key without the names of rows: ``stack.joint.stiffness`` is that of every joint.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Form = Literal["share", "factor", "width"]


@dataclass(frozen=True)
class PlausibleRange:
    """The range of a field about its value, with its reason.

    ``size`` is the half width as a share of the value; the factor by which the value is divided and multiplied, even in
    its logarithm; or the half width in SI, which holds at a value of 0 too. ``each`` is True if strikers differ by it.
    """

    form: Form
    size: float
    reason: str
    each: bool = False

    def ends(self, value: float) -> tuple[float, float]:
        """Return the ends of the range about a value, SI.

        Examples
        --------
        >>> PlausibleRange("factor", 2.0, "").ends(3.0), PlausibleRange("width", 0.1, "").ends(0.0)
        ((1.5, 6.0), (-0.1, 0.1))
        """
        if self.form == "factor":
            low, high = sorted((value / self.size, value * self.size))
            return low, high
        half = self.size * abs(value) if self.form == "share" else self.size
        return value - half, value + half


@dataclass(frozen=True)
class GoesWith:
    """The powers by which a quantity changes with others from the same drawing or weighing, by their paths.

    ``least`` is its least value at their nominal ones, SI, which changes with the same powers.
    """

    powers: Mapping[str, float]
    least: float


def _share(size: float, reason: str) -> PlausibleRange:
    return PlausibleRange("share", size, reason)


def _factor(size: float, reason: str) -> PlausibleRange:
    return PlausibleRange("factor", size, reason)


def _width(size: float, reason: str, each: bool = False) -> PlausibleRange:
    return PlausibleRange("width", size, reason, each)


_JOINT = "a bolted or pressed joint: its stiffness changes by about two with torque, flatness and load"
_DAMPING = "damping of joints is a guess of a few per cent of critical, and differs by three from one to the next"
_RUBBER = "a grade of rubber is sold within 5 IRHD, some 20 % of its modulus, and stiffens by half under a fast load"
_RESTITUTION = "restitution of metals falls from about 0.9 to 0.6 as speed and yield grow; pads scatter as much"
_GUIDES = "friction of guides and seals about doubles from well aligned and greased to not"
_CORDS = "rubber cords differ by a fifth with age, temperature and how far they were stretched before"
_LOSS = "loss factors of one polymer differ by half between tables, with temperature and frequency"
_PAD_MODULUS = "moduli of polymers and pads differ by a fifth between batches and with temperature"
_QUALITY = "the sharpness of a resonance is seldom stated, and halves with another mounting"
_RESONANCE = "a data sheet gives a typical resonance, some 10 % from that of one piece as mounted"
_YIELD = "a contact yields at 1.6 to 3 times the yield strength, which itself is known to some 10 %"

PLAUSIBLE: Mapping[str, PlausibleRange] = {
    "machine.engagement": _share(
        0.5, "overlap of a nose in motion and a face that is fed: feed stop, seats and their give add up to millimetres"
    ),
    "machine.inertia": _share(0.1, "computed from drawings, seldom swung: bolts, holes and pulleys are left out"),
    "machine.motor_inertia": _share(0.1, "of the data sheet, without pulley and coupling"),
    "machine.torque": _factor(1.5, "a drive gives for a second up to half more than its rating, a warm one less"),
    "machine.speed_gain": _factor(3.0, "a setting of the drive's controller that is hardly ever written down"),
    "machine.drag": _factor(3.0, "bearings, belt and air, cold or warm"),
    "machine.belt_stiffness": _factor(2.0, "a belt's stiffness depends on its tension and age"),
    "machine.belt_damping": _factor(3.0, _DAMPING),
    "machine.speed_ripple": _factor(2.0, "what an encoder shows of it depends on its averaging"),
    "machine.ripple_phase": _width(math.pi, "where the ripple stands when the valve opens is not recorded"),
    "machine.friction": _factor(2.0, _GUIDES),
    "machine.cord_force": _share(0.2, _CORDS),
    "machine.cord_stiffness": _share(0.2, _CORDS),
    "machine.restitution": _width(0.1, _RESTITUTION),
    "machine.body.restitution": _width(0.1, _RESTITUTION),
    "machine.shaper_restitution": _width(0.1, _RESTITUTION),
    "machine.shaper_stiffness": _factor(1.5, _RUBBER),
    "machine.cushion_stiffness": _factor(1.5, _RUBBER),
    "machine.cushion_damping": _factor(3.0, _DAMPING),
    "striker.mount_stiffness": _factor(2.0, _JOINT),
    "striker.mount_damping": _factor(3.0, _DAMPING),
    "striker.angle_error": _width(math.radians(0.1), "seats bored on a dividing head, noses bolted in by hand", True),
    "striker.reach_error": _width(20e-6, "noses set to a feeler gauge", True),
    "feed.arrival": _width(0.1, "valve and oil repeat to some 2 ms, a tenth of the time between two strikers"),
    "feed.stroke_time": _share(0.2, "oil warm or cold"),
    "feed.acceleration": _width(0.1, "how a cylinder gets going is seldom recorded"),
    "feed.cushion": _width(0.1, "how a cylinder is cushioned depends on a screw"),
    "object.nose_mass": _share(0.3, "which share of a frame moves with its struck face is a choice of the model"),
    "object.frame_stiffness": _factor(2.0, _JOINT),
    "object.frame_damping": _factor(3.0, _DAMPING),
    "object.spring": _share(0.1, "a coiled spring as bought"),
    "object.preload": _share(0.1, "set by the length of a spring whose rate is known to 10 %"),
    "object.damper": _share(0.3, "a damper as bought, its oil warm or cold"),
    "object.stop_stiffness": _factor(1.5, _RUBBER),
    "object.stop_restitution": _width(0.15, "rubber warm or cold, and falling with speed"),
    "object.friction": _factor(2.0, _GUIDES),
    "object.stiction": _factor(2.0, _GUIDES),
    "contact.restitution": _width(0.1, _RESTITUTION),
    "contact.friction": _width(0.1, "oblique impacts gave 0.12, tables say 0.06 for greased and 0.57 for dry steel"),
    "contact.sliding_damping": _factor(3.0, _DAMPING),
    "contact.reference_force": _factor(1.5, _RUBBER),
    "contact.yield_pressure": _share(0.3, _YIELD),
    "contact.cushion.modulus": _share(0.2, _PAD_MODULUS),
    "contact.cushion.stress": _share(0.15, "crush strengths of foams and honeycombs differ by 15 % within a batch"),
    "contact.cushion.plateau": _share(0.15, "crush strengths of foams and honeycombs differ by 15 % within a batch"),
    "contact.cushion.limit_strain": _width(0.05, "where a pad locks up is read off a curve without a corner"),
    "contact.cushion.densification": _width(0.05, "where a foam locks up is read off a curve without a corner"),
    "contact.cushion.compression_factor": _share(0.2, "of a fit over many rubbers"),
    "contact.cushion.retardation": _factor(2.0, _LOSS),
    "contact.cushion.loss_factor": _factor(1.5, _LOSS),
    "contact.cushion.settling": _factor(2.0, "wear of a pad differs by two from batch to batch"),
    "contact.cushion.stiffening": _factor(2.0, "wear of a pad differs by two from batch to batch"),
    "stack.layer.loss_factor": _factor(1.5, _LOSS),
    "stack.joint.stiffness": _factor(2.0, _JOINT),
    "stack.joint.damping": _factor(3.0, _DAMPING),
    "stack.joint.preload": _share(0.3, "bolts tightened by torque scatter by a quarter to a third"),
    "stack.joint.gap": _share(0.5, "a gap of some hundredths of a millimetre between faces that are not flat"),
    "stack.joint.radius": _factor(2.0, "the curvature of a face that is nearly plane"),
    "stack.joint.modulus": _share(0.2, _PAD_MODULUS),
    "stack.joint.loss_factor": _factor(1.5, _LOSS),
    "stack.joint.resonance": _share(0.1, _RESONANCE),
    "stack.joint.quality": _factor(2.0, _QUALITY),
    "stack.joint.yield_pressure": _share(0.3, _YIELD),
    "stack.end.stiffness": _factor(2.0, _JOINT),
    "stack.end.damping": _factor(3.0, _DAMPING),
    "stack.end.resonance": _share(0.1, _RESONANCE),
    "stack.end.quality": _factor(2.0, _QUALITY),
    "sensor.resonance": _share(0.1, _RESONANCE),
    "sensor.quality": _factor(2.0, _QUALITY),
    "sensor.zero_shift": _factor(2.0, "the zero shift of a piezoelectric sensor differs from shock to shock"),
    "sensor.edge_stiffness": _factor(2.0, _JOINT),
    "sensor.edge_damping": _factor(3.0, _DAMPING),
    "sensor.gasket.modulus": _share(0.2, _PAD_MODULUS),
    "sensor.gasket.loss_factor": _factor(1.5, _LOSS),
}  # fmt: skip
"""The plausible range of each field that nobody can weigh or read off."""
PLAUSIBLE_JOINT_CUSHION = {
    path.replace("contact.cushion.", "stack.joint.cushion."): known
    for path, known in PLAUSIBLE.items()
    if path.startswith("contact.cushion.")
}
PLAUSIBLE = {**PLAUSIBLE, **PLAUSIBLE_JOINT_CUSHION}

_MODEL = "belongs to the model, not to the machine"
_ASIDE = "acts before the first blow or after the last"
_SETTING = "a setting of what looks on"
_WITH_FORCE = "goes with contact.reference_force"

NOT_MOVED: Mapping[str, str] = {
    "machine.follow": _SETTING,
    "machine.longest": _SETTING,
    "machine.brake": _ASIDE,
    "feed.wait": _ASIDE,
    "feed.valve_delay": _ASIDE,
    "feed.release_delay": _ASIDE,
    "feed.retract_time": _ASIDE,
    "feed.hold": "how long the operator lets it strike",
    "object.gravity": "known far better than anything else",
    "contact.slowest_approach": _MODEL,
    "contact.exponent": "the law: a choice",
    "contact.reference_depth": _WITH_FORCE,
    "contact.datum_depth": _MODEL,
    "contact.cushion.exponent": "the law: a choice",
    "contact.cushion.loss_frequency": "goes with the loss factor",
    "stack.joint.cushion.exponent": "the law: a choice",
    "stack.joint.cushion.loss_frequency": "goes with the loss factor",
    "stack.joint.datum_depth": _MODEL,
    "stack.layer.band_low": "goes with the loss factor",
    "stack.layer.band_high": "goes with the loss factor",
    "stack.joint.band_low": "goes with the loss factor",
    "stack.joint.band_high": "goes with the loss factor",
    "sensor.sampling_rate": _SETTING,
    "sensor.cutoff": _SETTING,
    "sensor.range": _SETTING,
    "tap.position": _SETTING,
}
"""Fields that a band leaves as they are, with the reason; so are whole numbers and words, which are choices."""
