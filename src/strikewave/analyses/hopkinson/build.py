"""A split-Hopkinson set-up: its file, and bars, specimen, striker, disk, gauge and sensor records of it."""

from __future__ import annotations

import dataclasses
import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from pydantic import BaseModel

from strikewave.base.constants import material
from strikewave.base.documents import read_toml
from strikewave.base.errors import MISSING, InputError, InputErrors, show
from strikewave.base.quantities import Value
from strikewave.cases.paths import Form, with_provenance
from strikewave.cases.tables.common import CaseTable, PerformedTest
from strikewave.cases.tables.hopkinson import (
    AccelerometerTable,
    BarTable,
    DiskTable,
    GaugeTable,
    HopkinsonSetup,
    RecordedTable,
    SpecimenTable,
)
from strikewave.hopkinson.bars import Bar, BarMaterial, Bridge, Specimen, StrikerBar, elastic
from strikewave.hopkinson.pulses import GaugeTrace, quieten
from strikewave.records import Channel, Options, read_record
from strikewave.records.calibration import ChannelCalibration, even, known_unit
from strikewave.records.health import examine
from strikewave.records.health.limits import clipped
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.health_notice import HealthNotice
from strikewave.waves import Layer

LARGEST_SAMPLES = 20_000_000
"""Most samples of a trace: 160 MB; a shot of a millisecond needs some ten thousand."""
SLOWEST, FASTEST = 500.0, 20_000.0
"""Bar speeds of solids, m/s: outside of these a unit is forgotten."""
TINIEST, LARGEST_READING = 1e-30, 1e30
"""Smallest factor and largest reading of a sensor; their squares still are numbers."""
STEEL_RATIO = 0.29
"""Poisson's ratio where neither it nor a material is stated: that of steel, of which most bars are; only dispersion
uses it."""


def build_bar(table: BarTable, path: str, incident: BarTable | None = None) -> tuple[Bar, BarMaterial]:
    """Return a bar and its constants, one of them derived; what it does not state is that of the incident bar."""
    # a second bar that states nothing is like the first
    own = table
    if incident is not None and not (table.material or table.density or table.modulus or table.speed):
        own = incident
    poisson = table.poissons_ratio or own.poissons_ratio
    nu = STEEL_RATIO if poisson is None else poisson.si
    if own.material and poisson is None:
        nu = material(own.material).poissons_ratio
    diameter = table.diameter or (incident.diameter if incident is not None else None)
    if diameter is None:
        raise InputError(f"{path}.diameter", "nothing", 'a length with its unit, such as "20 mm"')
    constants = _constants(path, own.material, (_si(own.density), _si(own.modulus), _si(own.speed)))
    length = math.inf if table.length is None else table.length.si
    if not table.gauge_distance.si < length:
        got, allowed = table.gauge_distance.typed, f"less than the length of the bar, {length:g} m"
        raise InputError(f"{path}.gauge_distance", got, allowed, "it counts from the end at the specimen or sensor")
    if table.gauge_distance.si < diameter.si:
        allowed = f"at most the gauge distance, {table.gauge_distance.si:g} m, and better a tenth of it"
        hint = "within some ten diameters of its end no wave is one-dimensional"
        raise InputError(f"{path}.diameter", diameter.typed, allowed, hint)
    return Bar(constants.density, constants.modulus, diameter.si, table.gauge_distance.si, nu, length), constants


def _constants(path: str, name: str, stated: tuple[float | None, float | None, float | None]) -> BarMaterial:
    """Return density, modulus and speed of a bar as stated, else by its material."""
    density, modulus, speed = stated
    if name:
        known = material(name)
        density = known.density if density is None else density
        modulus = known.youngs_modulus if modulus is None and speed is None else modulus
    try:
        constants = elastic(density, modulus, speed)
    except ValueError as error:
        allowed = "two of density, modulus and speed, or a material"
        raise InputError(path, "what is stated", allowed, str(error)) from None
    if not SLOWEST <= constants.speed <= FASTEST:
        by = "as stated"
        if constants.derived == "speed":
            by = f"by {constants.density:.4g} kg/m^3 and {constants.modulus:.4g} Pa"
        allowed = f"a speed of {SLOWEST:g} to {FASTEST:g} m/s"
        raise InputError(path, f"a bar speed of {constants.speed:.4g} m/s {by}", allowed, "look at the units")
    return constants


def build_specimen(table: SpecimenTable) -> Specimen:
    """Return the specimen."""
    if (table.diameter is None) == (table.area is None):
        raise InputError("specimen", "both or none", "either a diameter or an area")
    area = table.area.si if table.area else 0.25 * math.pi * table.diameter.si**2 if table.diameter else math.nan
    density, modulus = _si(table.density), _si(table.modulus)
    if table.material:
        known = material(table.material)
        density = known.density if density is None else density
        modulus = known.youngs_modulus if modulus is None else modulus
    return Specimen(table.length.si, area, density, modulus)


def build_striker(setup: HopkinsonSetup, bar: Bar) -> StrikerBar | None:
    """Return the striker bar, by the constants of the incident bar where it states none; None without one."""
    table = setup.striker
    if table is None:
        return None
    own = BarMaterial(bar.density, bar.modulus, bar.speed, "speed")
    if table.material or table.density or table.modulus:
        for key, other in (("density", "modulus"), ("modulus", "density")):
            if not table.material and getattr(table, key) is None:
                raise InputError(f"striker.{key}", MISSING, f"both density and modulus, or neither: {other} is stated")
        own = _constants("striker", table.material, (_si(table.density), _si(table.modulus), None))
    diameter = bar.diameter if table.diameter is None else table.diameter.si
    impedance = own.density * own.speed * 0.25 * math.pi * diameter**2
    return StrikerBar(table.length.si, own.speed, impedance, math.nan if table.speed is None else table.speed.si)


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


def recorded_file(case: HopkinsonCase, table: RecordedTable) -> Path:
    """Return the file of a record, relative to the set-up file."""
    return case.folder / table.file


def check_setup(case: HopkinsonCase) -> list[str]:
    """Build all parts that need no file, and return the names of missing files."""
    setup = case.setup
    incident, transmitted = setup.bar.incident, setup.bar.transmitted
    bar, _ = build_bar(incident, "bar.incident")
    records: list[RecordedTable] = [incident.gauge]
    if transmitted is not None:
        build_bar(transmitted, "bar.transmitted", incident)
        records.append(transmitted.gauge)
    if setup.specimen is not None:
        build_specimen(setup.specimen)
    if setup.disk is not None and setup.disk.kind == "elastic":
        build_disk(setup.disk, bar)
    if setup.accelerometer is not None:
        records.append(setup.accelerometer)
    build_striker(setup, bar)
    return sorted({record.file for record in records if not recorded_file(case, record).is_file()})


class Gauged(NamedTuple):
    """The strain of a gauge, the findings of reading it, and file and name of its channel.

    ``is_strain`` is True if the file holds strain, not a voltage.
    """

    trace: GaugeTrace
    findings: list[HealthNotice]
    source: tuple[Path, str]
    is_strain: bool


def build_trace(case: HopkinsonCase, table: GaugeTable, path: str, bar: Bar) -> Gauged:
    """Read the strain of a gauge, and the findings of reading it."""
    channel, findings = _channel(case, table, path)
    trace = GaugeTrace(_strain(channel, table, path, bar), channel.step, channel.start)
    is_strain = table.bridge is None and table.strain_per_volt is None
    return Gauged(trace, findings, (recorded_file(case, table).resolve(), channel.name), is_strain)


class AccelerometerSignal(NamedTuple):
    """The record of an accelerometer, in m/s^2 or V as ``unit`` says, and the findings of reading it."""

    trace: GaugeTrace
    unit: str
    findings: list[HealthNotice]


def build_reading(case: HopkinsonCase, table: AccelerometerTable) -> AccelerometerSignal:
    """Read the record of an accelerometer: as an acceleration where possible, else in the sensor's volts."""
    path = "accelerometer"
    channel, findings = _channel(case, table, path)
    voltages = {"excitation": table.excitation, "rated_excitation": table.rated_excitation}
    stated: dict[str, Any] = {}
    for key, value in voltages.items():
        if value is not None and not table.sensitivity:
            raise InputError(f"{path}.{key}", value.typed, "nothing without a sensitivity that it scales")
        if value is not None:
            stated[key] = f"{value.si!r} V"
    calibration = ChannelCalibration(table.unit)
    if table.sensitivity:  # makes an acceleration of volts
        gain = "" if table.gain is None else repr(table.gain.si)
        calibration = ChannelCalibration(table.unit, table.sensitivity, gain, **stated)
    scale = calibration.scale(channel.unit, path)
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
    return AccelerometerSignal(GaugeTrace(channel.values * factor, channel.step, channel.start), scale.unit, findings)


def _channel(case: HopkinsonCase, table: RecordedTable, path: str) -> tuple[Channel, list[HealthNotice]]:
    """Read a channel with uniform sampling, and the findings of reading it."""
    options = Options(_si(table.rate), table.time, (table.channel,), measurement=table.measurement)
    try:
        channel, findings = even(read_record(recorded_file(case, table), options).channel(table.channel))
    except InputError as error:
        key = {"FILE": "file"}.get(error.field, error.field.removeprefix("--"))
        place = f"{path}.{key}" if key in type(table).model_fields else f"{path}.file"
        hint = re.sub(r"--(\w+)", rf"{path}.\1", error.hint)
        raise InputError(place, error.got, error.allowed, hint) from None
    if channel.values.size > LARGEST_SAMPLES:
        raise InputError(f"{path}.file", f"{channel.values.size} samples", f"at most {LARGEST_SAMPLES} samples")
    bad = int(np.count_nonzero(~np.isfinite(channel.values)))
    if bad:
        raise InputError(f"{path}.file", f"{bad} samples that are no numbers", "finite samples")
    findings += [
        dataclasses.replace(
            finding, message=f"{path}: the record stops at {finding.value:.4g} again and again: its range ended there"
        )
        for finding in examine(BlowRecord(channel.values, channel.step, channel.start), clipped)
    ]
    return channel, findings


def _strain(channel: Channel, table: GaugeTable, path: str, bar: Bar) -> np.ndarray:
    """Return the strain of a channel that holds strain itself, or a voltage."""
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
    quiet = quieten(GaugeTrace(volts, channel.step, channel.start), f"{path}.file")
    return -bridge.strain(-quiet.trace.strain)  # a bridge is not quite linear: it must know that this is compression


def _si(value: Value | None) -> float | None:
    return None if value is None else value.si


EXAMPLE = resources.files("strikewave.cases") / "hopkinson_example"
"""Folder of the example: set-up, record, and the licence of the record."""
RECORD = "shot.csv"
"""Name of the record in its set-up."""
LARGEST_FILE = 1_000_000
"""Most bytes of a set-up: a larger file is a record, named in its place."""
FORM = Form(HopkinsonSetup, "set-up", 'bar.incident.speed="4866 m/s"')
"""A set-up file."""


class HopkinsonCase(NamedTuple):
    """A set-up, its text with all changes, and the folder that its files are relative to."""

    setup: HopkinsonSetup
    text: str
    folder: Path


def example_setup(record: str = RECORD) -> str:
    """Return the text of a set-up of a shot with a comment at every key; ``record`` is its file."""
    text = (EXAMPLE / "setup.toml").read_text("utf-8")
    quoted, plain = re.escape(f'"{RECORD}"'), re.escape(RECORD)
    typed = json.dumps(record, ensure_ascii=False)
    return re.sub(f"{quoted}|{plain}", lambda name: typed if name[0].startswith('"') else record, text)


def example_record(name: str = "") -> tuple[str, str]:
    """Return name and text of the measured record of the example, with its credit.

    The record of a set-up has its name, so that it replaces no measurement: ``my-bars-shot.csv``.

    Examples
    --------
    >>> example_record("my-bars")[0], example_record("shot")[0]
    ('my-bars-shot.csv', 'shot.csv')
    """
    import lzma

    called = f"{name}.csv" if name.endswith(Path(RECORD).stem) else "-".join(filter(None, (name, RECORD)))
    return called, lzma.decompress((EXAMPLE / f"{RECORD}.xz").read_bytes()).decode("utf-8")


def load_setup(path: str, changes: Iterable[str] = ()) -> HopkinsonCase:
    """Read a set-up file, change some of its fields, and check it.

    Parameters
    ----------
    path : str
        A TOML file, or a folder that holds ``case.toml``.
    changes : iterable of str, optional
        ``path=value`` each, such as ``bar.incident.speed=4866 m/s``; a bare number is SI.

    Returns
    -------
    HopkinsonCase
        The checked set-up.

    Raises
    ------
    InputError
        With one line for each thing that is wrong.
    """
    file = Path(path)
    try:
        file = file / "case.toml" if file.is_dir() else file
        with file.open("rb") as opened:
            data = opened.read(LARGEST_FILE + 1)
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("SETUP", path, "a text file in UTF-8") from None
    except (OSError, ValueError) as error:
        raise InputError("SETUP", path, "a set-up file", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError("SETUP", path, f"a set-up file of at most {LARGEST_FILE // 1000} kB")
    name = re.sub(r"[^\w.+-]+", "-", file.stem).strip("-.+") or "shot"
    return parse_setup(text, name, changes, file.parent)


def parse_setup(text: str, name: str = "", changes: Iterable[str] = (), folder: Path | None = None) -> HopkinsonCase:
    """Check the TOML text of a set-up; see `load_setup`."""
    import tomlkit

    try:
        document = read_toml(text)
    except ValueError as error:
        reason = show(str(error), 120).strip('"')
        raise InputErrors([f"{name or 'set-up'}: not a TOML file: {reason}"]) from None
    schema = document.get("schema", MISSING)
    if schema is MISSING or isinstance(schema, bool) or schema != 1:
        raise InputError("schema", schema, "schema = 1", "begin the set-up with schema = 1")
    for change in changes:
        FORM.change(document, change)
    _check_tables(document, [])
    document.setdefault("name", name)
    place = folder or Path()
    if isinstance(document.get("folder"), str) and document["folder"]:
        place = place / document["folder"]
    document["folder"] = str(place.absolute())
    setup = with_provenance(FORM.read(document), document)
    return HopkinsonCase(setup, tomlkit.dumps(_toml(document)), place)


def with_test(case: HopkinsonCase, test: Mapping[str, str]) -> HopkinsonCase:
    """Return a set-up with the stated test in the place of its own; the set-up itself where none is stated."""
    import tomlkit

    if not test:
        return case
    document = tomlkit.parse(case.text)
    document["test"] = dict(test)
    setup = case.setup.model_copy(update={"test": PerformedTest.model_validate(dict(test))})
    return case._replace(setup=setup, text=tomlkit.dumps(document))


def _check_tables(part: dict[str, Any], places: list[str]) -> None:
    """Refuse another value in the place of a table."""
    for key, entry in part.items():
        model = FORM.table_at([*places, key])
        if model is None or not issubclass(model, CaseTable):
            continue
        path = ".".join([*places, key])
        if not isinstance(entry, dict):
            keys = ", ".join(FORM.keys_at([*places, key]))
            raise InputError(path, entry, f"a table [{path}] with {keys}")
        _check_tables(entry, [*places, key])


def values_of(part: Any, path: str = "") -> Iterator[tuple[str, Value]]:
    """Yield every quantity of a set-up with its path, such as ``bar.incident.density``."""
    if isinstance(part, Value):
        yield path, part
    elif isinstance(part, BaseModel):
        for key, entry in part:
            yield from values_of(entry, f"{path}.{key}" if path else key)


def _toml(value: Any) -> Any:
    """Turn plain tables into TOML's: a quantity stays on its line."""
    import tomlkit

    if isinstance(value, dict):
        table: Any = tomlkit.inline_table() if "value" in value else tomlkit.table()
        plain_first = sorted(value.items(), key=lambda item: isinstance(item[1], dict) and "value" not in item[1])
        for key, entry in plain_first:
            table[key] = _toml(entry)
        return table
    return value
