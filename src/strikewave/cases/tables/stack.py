"""[stack] with its layers, joints and far end, [load], and what watches it: [[tap]], [[sensor]] and [recorder]."""

from __future__ import annotations

from typing import Literal

from strikewave.base.quantities import (
    Duration,
    Frequency,
    Length,
    MaybeAcceleration,
    MaybeArea,
    MaybeBits,
    MaybeContactPressure,
    MaybeDamping,
    MaybeDensity,
    MaybeForce,
    MaybeFrequency,
    MaybeGap,
    MaybeLayerSpeed,
    MaybeLength,
    MaybeLoss,
    MaybeMass,
    MaybeModulus,
    MaybeOrder,
    MaybePoisson,
    MaybePreload,
    MaybeQuality,
    MaybeShift,
    MaybeSpeed,
    MaybeSpringRate,
    MaybeTime,
    SampleCount,
    Share,
    Value,
)
from strikewave.cases.tables.common import CaseTable, Name
from strikewave.cases.tables.contact import CushionTable, StiffnessName


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
