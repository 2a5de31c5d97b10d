"""Case in, measuring channels out: a sensor, where it sits, and what records it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

from strikewave.base.citations import FROM_MEMORY
from strikewave.base.errors import MISSING, InputError, checked, nearest
from strikewave.base.quantities import Value
from strikewave.base.result import INFO, Notice
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import area_of, build_taps, matter_of, once
from strikewave.cases.tables.sensor import SensorTable
from strikewave.sensors import Gasket, Mounting, Recorder, Sensor, accelerometer, oscilloscope, storage_recorder
from strikewave.sensors.chain import RATE_OVER_CUTOFF
from strikewave.sensors.mounting import mounting_system
from strikewave.sensors.trial import SensorChannel

_SENSOR_FIELDS = {"resonance": float, "quality": float, "range": float, "zero_shift": float}
_RECORDER_FIELDS = {"sampling_rate": float, "cutoff": float, "order": int, "bits": int}
"""Fields of [[sensor]] that overrule the model of the sensor, and its recorder."""


def build_channels(case: Case) -> tuple[SensorChannel, ...]:
    """Return the measuring channels of a case.

    Raises
    ------
    InputError
        If a sensor names what is not there, or has values that do not fit together.
    """
    once("sensor", [sensor.name for sensor in case.sensor])
    return tuple(_channel(case, table) for table in case.sensor)


def _channel(case: Case, table: SensorTable) -> SensorChannel:
    path = f"sensor.{table.name}"
    taps = [name for name, _ in build_taps(case)] if case.stack.layer else []
    if table.tap and table.tap not in taps:
        hint = nearest(table.tap, taps) if taps else "the case has no stack; leave tap out for the rigid assembly"
        raise InputError(f"{path}.tap", table.tap, "the name of a tap", hint)
    rate = case.recorder.sampling_rate.si if case.recorder else None
    sensor, recorder = chain_of(table, rate)
    return SensorChannel(sensor, taps.index(table.tap) if table.tap else None, recorder)


def chain_of(table: SensorTable, rate: float | None = None) -> tuple[Sensor, Recorder]:
    """Return the sensor of a table on its mounting, and its recorder; ``rate`` is the sampling rate of [recorder], Hz.

    Raises
    ------
    InputError
        If it names no known accelerometer, or has values that do not fit together.
    """
    path = f"sensor.{table.name}"
    known = accelerometer(table.model, f"{path}.model") if table.model else None
    sensor = known.mounted() if known else Sensor()
    changes: dict[str, Any] = {"name": table.name, "mounting": _mounting(table, path), **_given(table, _SENSOR_FIELDS)}
    sensor = checked(path, lambda: dataclasses.replace(sensor, **changes))
    checked(f"{path}.gasket", lambda: mounting_system(sensor.mounting))  # kept for the run
    recorder = checked(path, lambda: dataclasses.replace(_recorder(table, rate), **_given(table, _RECORDER_FIELDS)))
    if recorder.bits and math.isinf(sensor.range):
        raise InputError(f"{path}.range", MISSING, "a range for a recorder with bits", 'add range = "20000 g"')
    return sensor, recorder


def sensor_notices(case: Case) -> Iterator[Notice]:
    """Report the accelerometers whose numbers are from memory, but for those that the case gives itself."""
    for table in case.sensor:
        yield from memory_notices(table)


def memory_notices(table: SensorTable) -> Iterator[Notice]:
    """Report a sensor whose range or resonance are those of an accelerometer that the table has from memory.

    Examples
    --------
    >>> from strikewave import load_case
    >>> sensor = load_case("li-ma-2019-fig5").sensor[0].model_copy(update={"model": "PCB 350C02", "range": None})
    >>> [notice.code for notice in memory_notices(sensor)]
    ['sensor-from-memory']
    """
    known = accelerometer(table.model, f"sensor.{table.name}.model") if table.model else None
    if known is None or known.status != FROM_MEMORY:
        return
    taken = [name for name in ("range", "resonance") if getattr(table, name) is None]
    if taken:
        message = (
            f"{' and '.join(taken)} of sensor {table.name} ({known.name}) are from memory: no data sheet that states "
            f"them could be opened; give {' and '.join(f'sensor.{table.name}.{name}' for name in taken)} from yours"
        )
        yield Notice("sensor-from-memory", message, 1.0, 0.0, severity=INFO)


def _given(table: SensorTable, fields: dict[str, Any]) -> dict[str, Any]:
    """Return the fields that a table gives, in SI."""
    given = {key: (getattr(table, key), kind) for key, kind in fields.items()}
    return {key: kind(value.si) for key, (value, kind) in given.items() if isinstance(value, Value)}


def _recorder(table: SensorTable, rate: float | None) -> Recorder:
    if table.recorder == "ideal":
        return Recorder()
    if table.recorder == "oscilloscope":
        return oscilloscope()
    stored = storage_recorder()
    return stored if rate is None else dataclasses.replace(stored, sampling_rate=rate, cutoff=rate / RATE_OVER_CUTOFF)


def _mounting(table: SensorTable, path: str) -> Mounting:
    if not table.gasket:
        return Mounting()
    if table.mass is None:
        raise InputError(f"{path}.mass", MISSING, "the mass of a buffered sensor", 'add mass = "5 gram"')
    gaskets = []
    for k, gasket in enumerate(table.gasket):
        here = f"{path}.gasket.{k}"
        matter = matter_of(gasket, here)
        if matter.density is None or matter.modulus is None:
            raise InputError(f"{here}.material", MISSING, "a material, or density and modulus", 'add material = "PTFE"')
        parts = (matter.density, matter.modulus, area_of(gasket, here), gasket.thickness.si, matter.loss_factor or 0.0)
        gaskets.append(checked(here, lambda parts=parts: Gasket(*parts)))  # type: ignore[misc]
    stiffness = table.edge_stiffness.si if table.edge_stiffness else math.inf
    damping = table.edge_damping.si if table.edge_damping else 0.0
    mass = table.mass.si
    return checked(path, lambda: Mounting(tuple(gaskets), mass, stiffness, damping))
