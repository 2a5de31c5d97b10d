"""[[sensor]] and [recorder]: how what moves is measured."""

from __future__ import annotations

from typing import Literal

from strikewave.base.quantities import (
    Duration,
    Frequency,
    Length,
    MaybeAcceleration,
    MaybeArea,
    MaybeBits,
    MaybeDamping,
    MaybeDensity,
    MaybeFrequency,
    MaybeLength,
    MaybeLoss,
    MaybeMass,
    MaybeModulus,
    MaybeOrder,
    MaybeQuality,
    MaybeShift,
    MaybeSpringRate,
    SampleCount,
)
from strikewave.cases.tables.base import CaseTable, Name


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
