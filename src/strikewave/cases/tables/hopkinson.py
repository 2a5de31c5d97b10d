"""The set-up of a split-Hopkinson test as frozen tables: bars with their gauges, specimen, striker, solver, limits."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from strikewave.base.errors import MISSING, InputError
from strikewave.base.quantities import (
    Length,
    MaybeArea,
    MaybeDensity,
    MaybeFrequency,
    MaybeLength,
    MaybeMass,
    MaybeModulus,
    MaybeSpeed,
    Range,
    Value,
    positive,
)
from strikewave.cases.tables.common import CaseTable, PerformedTest, case_name
from strikewave.hopkinson.alignment import Method
from strikewave.hopkinson.bars import BridgeKind
from strikewave.hopkinson.echoes import Way
from strikewave.hopkinson.reduction import Analysis
from strikewave.waves.dispersion import Theory

MaybeNumber = Annotated[Value | None, positive("")]
MaybeVoltage = Annotated[Value | None, positive("V", 1e6)]
MaybePoisson = Annotated[Value | None, BeforeValidator(Range("", 0.0, 0.5).read)]
MaybeShare = Annotated[Value | None, BeforeValidator(Range("", 0.0, 0.5).read)]
Limit = Annotated[Value, positive("", 10.0)]
SkipCount = Annotated[Value, BeforeValidator(Range("count", 0, 1000).read)]


def _channel(raw: Any) -> str:
    """Check the name of a channel, or its number from 1."""
    if isinstance(raw, bool) or not isinstance(raw, int | str) or not str(raw).strip():
        raise InputError("", raw, "a name of a channel, or its number from 1")
    return str(raw)


class RecordedTable(CaseTable):
    """Location of a history: file and channel, time or rate where the file needs it; ``unit`` overrules the file's.

    ``measurement`` is the one to take of a file that holds several, from 1.
    """

    file: str
    channel: Annotated[str, BeforeValidator(_channel)] = "1"
    time: Annotated[str, BeforeValidator(_channel)] | None = None
    rate: MaybeFrequency = None
    measurement: Annotated[int, Field(ge=1)] | None = None
    unit: str = ""


class GaugeTable(RecordedTable):
    """[bar.incident.gauge]: where the strain stands, and what makes strain of it.

    A voltage needs a bridge (gauge_factor, excitation, gain), or strain_per_volt. The sign is found: the first pulse
    is compression.
    """

    bridge: BridgeKind | None = None
    gauge_factor: MaybeNumber = None
    excitation: MaybeVoltage = None
    gain: MaybeNumber = None
    strain_per_volt: MaybeNumber = None


class BarTable(CaseTable):
    """[bar.incident]: a pressure bar; two of density, modulus and speed, or a material.

    The transmitted bar takes from the incident one what it does not say itself, but for gauge and length.
    """

    material: str = ""
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    speed: MaybeSpeed = None
    poissons_ratio: MaybePoisson = None
    diameter: MaybeLength = None
    gauge_distance: Length
    length: MaybeLength = None
    gauge: GaugeTable


class BarsTable(CaseTable):
    """[bar]: the incident and, where there is a specimen, the transmitted bar."""

    incident: BarTable
    transmitted: BarTable | None = None


class SpecimenTable(CaseTable):
    """[specimen]: length; diameter or area; density and modulus (or a material) where they are known."""

    material: str = ""
    length: Length
    diameter: MaybeLength = None
    area: MaybeArea = None
    density: MaybeDensity = None
    modulus: MaybeModulus = None


class StrikerBarTable(CaseTable):
    """[striker]: a round striker bar; of the incident bar's material and diameter where nothing else is said."""

    material: str = ""
    length: Length
    speed: MaybeSpeed = None
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    diameter: MaybeLength = None


class DiskTable(CaseTable):
    """[disk]: what stands between the end of the bar and the accelerometer; left out, the sensor sits on the bar.

    A rigid disk has a mass; an elastic one a thickness, a material or density and modulus, and a diameter (that of
    the bar where it is left out).
    """

    kind: Literal["rigid", "elastic"]
    mass: MaybeMass = None
    material: str = ""
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    thickness: MaybeLength = None
    diameter: MaybeLength = None

    @model_validator(mode="after")
    def _fits(self) -> DiskTable:
        for key in ("mass", "material", "density", "modulus", "thickness", "diameter"):
            value = getattr(self, key)
            if value and (key == "mass") != (self.kind == "rigid"):
                typed = value.typed if isinstance(value, Value) else value
                raise InputError(key, typed, f"nothing for a disk that is {self.kind}", "look at kind")
        if self.kind == "rigid" and self.mass is None:
            raise InputError("mass", MISSING, 'the mass of a rigid disk, such as "20 gram"')
        if self.kind == "elastic" and self.thickness is None:
            raise InputError("thickness", MISSING, 'the thickness of an elastic disk, such as "5 mm"')
        if self.kind == "elastic" and not self.material and (self.density is None or self.modulus is None):
            raise InputError("material", MISSING, "a material, or density and modulus")
        return self


class AccelerometerTable(RecordedTable):
    """[accelerometer]: the record of the sensor at the end of the bar, and its own mass.

    Volts alone: the sensitivity is found. With a stated ``sensitivity`` (such as "1.2 mV/g"; gain, excitation and
    rated_excitation where it needs them), or where the file holds an acceleration: the ratio to the reference.
    """

    sensitivity: str = ""
    gain: MaybeNumber = None
    excitation: MaybeVoltage = None
    rated_excitation: MaybeVoltage = None
    mass: MaybeMass = None


class UncertaintyTable(CaseTable):
    """[uncertainty]: relative standard uncertainties of the strain at the gauge and of the bar speed."""

    strain: MaybeShare = None
    speed: MaybeShare = None


class EchoesTable(CaseTable):
    """[echoes]: without a specimen; which way the first pulse runs, and how many passes to leave out."""

    way: Way = "towards"
    skip: SkipCount = Value(si=0, typed=0)


class SolverTable(CaseTable):
    """[solver]: which waves give the curve that is shown first, how pulses are carried, how they are aligned.

    ``bandwidth`` is that at which the reading of an accelerometer is compared; chosen where it is left out.
    """

    analysis: Analysis = "3-wave"
    dispersion: Theory = "pochhammer-chree"
    alignment: Method = "geometric"
    bandwidth: MaybeFrequency = None


class LimitsTable(CaseTable):
    """[limits]: what breaks the command: shares of the mean force and of the incident impulse."""

    force_misfit: Limit = Value(si=0.1, typed=0.1)
    momentum: Limit = Value(si=0.05, typed=0.05)


class HopkinsonSetup(CaseTable):
    """The set-up of one shot; of an accelerometer on a bar end; or of a bar that is calibrated by its echoes.

    ``folder`` is where the files of the gauges are; that of the set-up file where it is left out.
    """

    schema_version: Literal[1] = Field(alias="schema")
    name: Annotated[str, BeforeValidator(case_name)] = ""
    title: str = ""
    source: str = ""
    folder: str = ""
    test: PerformedTest = PerformedTest()
    bar: BarsTable
    specimen: SpecimenTable | None = None
    striker: StrikerBarTable | None = None
    disk: DiskTable | None = None
    accelerometer: AccelerometerTable | None = None
    uncertainty: UncertaintyTable = UncertaintyTable()
    echoes: EchoesTable = EchoesTable()
    solver: SolverTable = SolverTable()
    limits: LimitsTable = LimitsTable()

    @model_validator(mode="after")
    def _whole(self) -> HopkinsonSetup:
        alone = "leave [specimen] out to calibrate a bar by echoes"
        if self.accelerometer is not None:
            for path, table in (("specimen", self.specimen), ("bar.transmitted", self.bar.transmitted)):
                if table is not None:
                    raise InputError(path, "a table", "nothing beside [accelerometer]: it sits on the end of one bar")
        elif self.disk is not None:
            raise InputError("accelerometer", MISSING, "[accelerometer] on the [disk], with its file")
        elif self.specimen is not None and self.bar.transmitted is None:
            allowed = "[bar.transmitted] with its gauge, where there is a specimen"
            raise InputError("bar.transmitted", "nothing", allowed, alone)
        elif self.specimen is None and self.bar.transmitted is not None:
            hint = "leave [bar.transmitted] out to calibrate one bar by its echoes"
            raise InputError("specimen", "nothing", "[specimen] between two bars", hint)
        return self

    @property
    def kind(self) -> Literal["shot", "sensor", "echoes"]:
        """Subject of the test: a specimen, an accelerometer, or a bar alone."""
        if self.accelerometer is not None:
            return "sensor"
        return "echoes" if self.specimen is None else "shot"
