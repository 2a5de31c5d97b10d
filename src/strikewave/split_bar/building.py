"""Set-up in, what the compute room takes out: bars, specimen, striker, disk, and what gauges and sensors wrote."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.errors import InputError
from strikewave.hopkinson.bars import Bar, Elastic, Specimen, Striker, elastic
from strikewave.hopkinson.gauges import Bridge
from strikewave.hopkinson.pulses import Trace, quieten
from strikewave.materials import material
from strikewave.quantities import Value
from strikewave.records import Channel, Options, read_record
from strikewave.records.calibration import Calibration, known_unit
from strikewave.records.clock import even
from strikewave.records.finding import Finding
from strikewave.records.health import Examined, clipped
from strikewave.split_bar.reading import SplitBarCase
from strikewave.split_bar.tables import (
    AccelerometerTable,
    BarTable,
    DiskTable,
    GaugeTable,
    RecordedTable,
    SpecimenTable,
    SplitBarSetup,
)
from strikewave.waves import Layer

LARGEST_SAMPLES = 20_000_000
"""A trace with more samples is refused: no shot needs them."""
TINIEST, LARGEST_READING = 1e-30, 1e30
"""Factors below and readings above are no readings of a sensor."""


def build_bar(table: BarTable, path: str, incident: BarTable | None = None) -> tuple[Bar, Elastic]:
    """Return a bar, and which of its constants is derived; the rest comes from the incident bar.

    Raises
    ------
    InputError
        If constants are missing or do not fit.
    """
    own = table
    if incident is not None and not (table.material or table.density or table.modulus or table.speed):
        own = incident
    density, modulus, speed = (_si(getattr(own, key)) for key in ("density", "modulus", "speed"))
    poisson = table.poissons_ratio or own.poissons_ratio
    nu = 0.29 if poisson is None else poisson.si
    if own.material:
        known = material(own.material)
        density = known.density if density is None else density
        modulus = known.youngs_modulus if modulus is None and speed is None else modulus
        nu = known.poissons_ratio if poisson is None else nu
    diameter = table.diameter or (incident.diameter if incident is not None else None)
    if diameter is None:
        raise InputError(f"{path}.diameter", "nothing", 'a length with its unit, such as "20 mm"')
    try:
        constants = elastic(density, modulus, speed)
        length = math.inf if table.length is None else table.length.si
        made = Bar(constants.density, constants.modulus, diameter.si, table.gauge_distance.si, nu, length)
    except ValueError as error:
        raise InputError(
            path, "what is stated", "two of density, modulus and speed, or a material", str(error)
        ) from None
    return made, constants


def build_specimen(table: SpecimenTable) -> Specimen:
    """Return the specimen.

    Raises
    ------
    InputError
        If it has neither or both of diameter and area.
    """
    if (table.diameter is None) == (table.area is None):
        raise InputError("specimen", "both or none", "either a diameter or an area")
    area = table.area.si if table.area else 0.25 * math.pi * table.diameter.si**2 if table.diameter else math.nan
    density, modulus = _si(table.density), _si(table.modulus)
    if table.material:
        known = material(table.material)
        density = known.density if density is None else density
        modulus = known.youngs_modulus if modulus is None else modulus
    return Specimen(table.length.si, area, density, modulus)


def build_striker(setup: SplitBarSetup, bar: Bar) -> Striker | None:
    """Return the striker bar; None where none is stated."""
    table = setup.striker
    if table is None:
        return None
    density, modulus = table.density, table.modulus
    rho, E = (bar.density if density is None else density.si), (bar.modulus if modulus is None else modulus.si)
    if table.material:
        known = material(table.material)
        rho, E = known.density, known.youngs_modulus
    diameter = bar.diameter if table.diameter is None else table.diameter.si
    speed = math.sqrt(E / rho)
    impedance = rho * speed * 0.25 * math.pi * diameter**2
    return Striker(table.length.si, speed, impedance, math.nan if table.speed is None else table.speed.si)


def build_disk(table: DiskTable, bar: Bar) -> Layer:
    """Return an elastic disk as a layer; its diameter is that of the bar where none is stated."""
    diameter = bar.diameter if table.diameter is None else table.diameter.si
    density, modulus, strength = _si(table.density), _si(table.modulus), None
    if table.material:
        known = material(table.material)
        density = known.density if density is None else density
        modulus = known.youngs_modulus if modulus is None else modulus
        strength = known.yield_strength
    assert density is not None
    assert modulus is not None
    assert table.thickness is not None
    area = 0.25 * math.pi * diameter**2
    return Layer("disk", density, modulus, area, table.thickness.si, diameter, strength)


def recorded_file(case: SplitBarCase, table: RecordedTable) -> Path:
    """Return the file of a record, which is relative to the set-up file."""
    return case.folder / table.file


def build_trace(case: SplitBarCase, table: GaugeTable, path: str, bar: Bar) -> tuple[Trace, list[Finding]]:
    """Read the strain of a gauge, and what reading it showed.

    Raises
    ------
    InputError
        If the file, the channel or its unit cannot be used, or samples are missing.
    """
    channel, findings = _channel(case, table, path)
    return Trace(_strain(channel, table, path, bar), channel.step, channel.start), findings


class Reading(NamedTuple):
    """What an accelerometer wrote: the history, in m/s^2 or V as ``unit`` says, and what reading it showed."""

    trace: Trace
    unit: str
    findings: list[Finding]


def build_reading(case: SplitBarCase, table: AccelerometerTable) -> Reading:
    """Read the record of an accelerometer: an acceleration where it can be made of it, else the sensor's volts.

    Raises
    ------
    InputError
        If the file, the channel or its unit cannot be used, or samples are missing.
    """
    path = "accelerometer"
    channel, findings = _channel(case, table, path)
    scale = _calibration(table).scale(channel.unit, path)
    if scale.unit not in ("m/s^2", "V"):
        key = "sensitivity" if table.sensitivity else "unit"
        got = getattr(table, key) or channel.unit or "nothing"
        raise InputError(f"{path}.{key}", got, "an acceleration such as g, or V or mV", "say what the file holds")
    factor = scale.factor
    if table.gain is not None and not table.sensitivity:
        if scale.unit != "V":
            raise InputError(f"{path}.gain", table.gain.typed, "nothing for a file that holds an acceleration")
        factor /= table.gain.si
    largest = float(np.abs(channel.values).max(initial=0.0))
    if not TINIEST <= abs(factor) <= LARGEST_READING / max(largest, 1.0):
        raise InputError(
            path, f"{largest:g} times {factor:g} {scale.unit}", "readings of a sensor", "look at its factors"
        )
    return Reading(Trace(channel.values * factor, channel.step, channel.start), scale.unit, findings)


def _calibration(table: AccelerometerTable) -> Calibration:
    """Return what makes an acceleration of an accelerometer's volts, where its sensitivity is stated."""
    voltages = {"excitation": table.excitation, "rated_excitation": table.rated_excitation}
    if not table.sensitivity:
        for key, value in voltages.items():
            if value is not None:
                raise InputError(f"accelerometer.{key}", value.typed, "nothing without a sensitivity that it scales")
        return Calibration(table.unit)
    stated: dict[str, Any] = {key: f"{value.si!r} V" for key, value in voltages.items() if value is not None}
    gain = "" if table.gain is None else repr(table.gain.si)
    return Calibration(table.unit, table.sensitivity, gain, **stated)


def _channel(case: SplitBarCase, table: RecordedTable, path: str) -> tuple[Channel, list[Finding]]:
    """Read a channel on an even clock, and what reading it showed."""
    options = Options(_si(table.rate), table.time, (table.channel,))
    channel = read_record(recorded_file(case, table), options).channel(table.channel)
    if channel.values.size > LARGEST_SAMPLES:
        raise InputError(f"{path}.file", f"{channel.values.size} samples", f"at most {LARGEST_SAMPLES} samples")
    bad = int(np.count_nonzero(~np.isfinite(channel.values)))
    if bad:
        raise InputError(f"{path}.file", f"{bad} samples that are no numbers", "finite samples")
    channel, findings = even(channel)
    findings += [
        found._replace(message=f"{path}: the record stops at {found.value:.4g} again and again: its range ended there")
        for found in clipped(Examined(channel.values, channel.step, channel.start))
    ]
    return channel, findings


def _strain(channel: Channel, table: GaugeTable, path: str, bar: Bar) -> np.ndarray:
    """Return strain from what a channel holds: strain itself, or a voltage."""
    unit = table.unit or channel.unit or ("V" if table.bridge or table.strain_per_volt else "")
    si, factor = known_unit(unit) or ("", 1.0) if unit else ("", 1.0)
    if si == "1":
        return np.asarray(channel.values * factor)
    if si != "V":
        raise InputError(f"{path}.unit", unit or "nothing", "strain, ustrain, V or mV", "say what the file holds")
    volts = channel.values * factor
    if (table.bridge is None) == (table.strain_per_volt is None):
        raise InputError(path, "a voltage", "a bridge with its gauges, or strain_per_volt")
    if table.strain_per_volt is not None:
        return np.asarray(volts * table.strain_per_volt.si)
    if table.bridge is None or table.gauge_factor is None or table.excitation is None:
        raise InputError(path, "a bridge", "gauge_factor and excitation beside it")
    gain = 1.0 if table.gain is None else table.gain.si
    bridge = Bridge(table.bridge, table.gauge_factor.si, table.excitation.si, gain, bar.poissons_ratio)
    quiet = quieten(Trace(volts, channel.step, channel.start), f"{path}.file")
    return -bridge.strain(-quiet.trace.strain)  # a bridge is not quite linear: it must know that this is compression


def _si(value: Value | None) -> float | None:
    return None if value is None else value.si
