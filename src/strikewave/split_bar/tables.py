"""The set-up of a split-Hopkinson test as frozen tables: bars with their gauges, specimen, striker, solver, limits."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from strikewave.errors import InputError
from strikewave.hopkinson.alignment import Method
from strikewave.hopkinson.echoes import Way
from strikewave.hopkinson.gauges import BridgeKind
from strikewave.hopkinson.reduction import Analysis
from strikewave.quantities import (
    Length,
    MaybeArea,
    MaybeDensity,
    MaybeFrequency,
    MaybeLength,
    MaybeModulus,
    MaybeSpeed,
    Range,
    Value,
    positive,
)
from strikewave.tables import Table, case_name
from strikewave.waves.dispersion import Theory

MaybeNumber = Annotated[Value | None, positive("")]
MaybeVoltage = Annotated[Value | None, positive("V", 1e6)]
MaybePoisson = Annotated[Value | None, BeforeValidator(Range("", 0.0, 0.5).read)]
Limit = Annotated[Value, positive("", 10.0)]
SkipCount = Annotated[Value, BeforeValidator(Range("count", 0, 1000).read)]


def _channel(raw: Any) -> str:
    """Check the name of a channel, or its number from 1."""
    if isinstance(raw, bool) or not isinstance(raw, int | str) or not str(raw).strip():
        raise InputError("", raw, "a name of a channel, or its number from 1")
    return str(raw)


class GaugeTable(Table):
    """[bar.incident.gauge]: where the strain stands, and what makes strain of it.

    ``unit`` overrules what the file says. A voltage needs a bridge (gauge_factor, excitation, gain), or
    strain_per_volt. The sign is found: the first pulse is compression.
    """

    file: str
    channel: Annotated[str, BeforeValidator(_channel)] = "1"
    time: Annotated[str, BeforeValidator(_channel)] | None = None
    rate: MaybeFrequency = None
    unit: str = ""
    bridge: BridgeKind | None = None
    gauge_factor: MaybeNumber = None
    excitation: MaybeVoltage = None
    gain: MaybeNumber = None
    strain_per_volt: MaybeNumber = None


class BarTable(Table):
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


class BarsTable(Table):
    """[bar]: the incident and, where there is a specimen, the transmitted bar."""

    incident: BarTable
    transmitted: BarTable | None = None


class SpecimenTable(Table):
    """[specimen]: length; diameter or area; density and modulus (or a material) where they are known."""

    material: str = ""
    length: Length
    diameter: MaybeLength = None
    area: MaybeArea = None
    density: MaybeDensity = None
    modulus: MaybeModulus = None


class StrikerTable(Table):
    """[striker]: a round striker bar; of the incident bar's material and diameter where nothing else is said."""

    material: str = ""
    length: Length
    speed: MaybeSpeed = None
    density: MaybeDensity = None
    modulus: MaybeModulus = None
    diameter: MaybeLength = None


class EchoesTable(Table):
    """[echoes]: without a specimen; which way the first pulse runs, and how many passes to leave out."""

    way: Way = "towards"
    skip: SkipCount = Value(si=0, typed=0)


class SolverTable(Table):
    """[solver]: which waves give the curve that is shown first, how pulses are carried, how they are aligned."""

    analysis: Analysis = "3-wave"
    dispersion: Theory = "pochhammer-chree"
    alignment: Method = "geometric"


class LimitsTable(Table):
    """[limits]: what breaks the command: shares of the mean force and of the incident impulse."""

    force_misfit: Limit = Value(si=0.1, typed=0.1)
    momentum: Limit = Value(si=0.05, typed=0.05)


class SplitBarSetup(Table):
    """The set-up of one shot, or of one calibration of a bar by its echoes where there is no specimen.

    ``folder`` is where the files of the gauges are; that of the set-up file where it is left out.
    """

    schema_version: Literal[1] = Field(alias="schema")
    name: Annotated[str, BeforeValidator(case_name)] = ""
    title: str = ""
    source: str = ""
    folder: str = ""
    bar: BarsTable
    specimen: SpecimenTable | None = None
    striker: StrikerTable | None = None
    echoes: EchoesTable = EchoesTable()
    solver: SolverTable = SolverTable()
    limits: LimitsTable = LimitsTable()

    @model_validator(mode="after")
    def _whole(self) -> SplitBarSetup:
        if self.specimen is not None and self.bar.transmitted is None:
            allowed = "[bar.transmitted] with its gauge, where there is a specimen"
            raise InputError("bar.transmitted", "nothing", allowed, "leave [specimen] out to calibrate a bar by echoes")
        if self.specimen is None and self.bar.transmitted is not None:
            hint = "leave [bar.transmitted] out to calibrate one bar by its echoes"
            raise InputError("specimen", "nothing", "[specimen] between two bars", hint)
        return self

    @property
    def is_calibration(self) -> bool:
        """Whether it is the calibration of a bar by its echoes."""
        return self.specimen is None
