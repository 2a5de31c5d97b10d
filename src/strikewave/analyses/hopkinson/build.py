"""Set-up in, what the compute room takes out: bars, specimen, striker, disk, and what gauges and sensors wrote."""

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
from strikewave.base.result import Notice
from strikewave.base.texts import percent
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
from strikewave.hopkinson import Pulses, Reduction, StressStrainCurve
from strikewave.hopkinson.bars import Bar, BarMaterial, Bridge, Specimen, StrikerBar, elastic
from strikewave.hopkinson.pulses import GaugeTrace, quieten
from strikewave.records import Channel, Options, read_record
from strikewave.records.calibration import ChannelCalibration, known_unit
from strikewave.records.clock import even
from strikewave.records.health import examine
from strikewave.records.health.limits import clipped
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.health_notice import HealthNotice
from strikewave.waves import Layer

LARGEST_SAMPLES = 20_000_000
"""A trace with more samples is refused: they are 160 MB, and a shot of a millisecond needs some ten thousand."""
SLOWEST, FASTEST = 500.0, 20_000.0
"""Bar speeds outside of these, m/s, are those of no solid: a unit is forgotten."""
TINIEST, LARGEST_READING = 1e-30, 1e30
"""Factors below and readings above are no readings of a sensor; their squares still are numbers."""
STEEL_RATIO = 0.29
"""Poisson's ratio of a bar where neither it nor a material is stated: that of steel, of which most bars are. It only
enters the dispersion."""


def build_bar(table: BarTable, path: str, incident: BarTable | None = None) -> tuple[Bar, BarMaterial]:
    """Return a bar, and which of its constants is derived; the rest comes from the incident bar."""
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
    """Return density, modulus and speed of a bar from what is stated, over what its material has."""
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
    """Return the striker bar, of the incident bar's constants where it states none of its own; None without one."""
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
    """Return the file of a record, which is relative to the set-up file."""
    return case.folder / table.file


def check_setup(case: HopkinsonCase) -> list[str]:
    """Build all that needs no file, and return the names of the files that are not there."""
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
    return sorted({one.file for one in records if not recorded_file(case, one).is_file()})


class Gauged(NamedTuple):
    """The strain of a gauge, the findings of reading it, and file and name of the channel that it came from.

    ``is_strain`` tells whether the file holds strain, not a voltage.
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
    """Record of an accelerometer: the history, in m/s^2 or V as ``unit`` says, and the findings of reading it."""

    trace: GaugeTrace
    unit: str
    findings: list[HealthNotice]


def build_reading(case: HopkinsonCase, table: AccelerometerTable) -> AccelerometerSignal:
    """Read the record of an accelerometer: an acceleration where it can be made of it, else the sensor's volts."""
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
    return AccelerometerSignal(GaugeTrace(channel.values * factor, channel.step, channel.start), scale.unit, findings)


def _calibration(table: AccelerometerTable) -> ChannelCalibration:
    """Return what makes an acceleration of an accelerometer's volts, where its sensitivity is stated."""
    voltages = {"excitation": table.excitation, "rated_excitation": table.rated_excitation}
    if not table.sensitivity:
        for key, value in voltages.items():
            if value is not None:
                raise InputError(f"accelerometer.{key}", value.typed, "nothing without a sensitivity that it scales")
        return ChannelCalibration(table.unit)
    stated: dict[str, Any] = {key: f"{value.si!r} V" for key, value in voltages.items() if value is not None}
    gain = "" if table.gain is None else repr(table.gain.si)
    return ChannelCalibration(table.unit, table.sensitivity, gain, **stated)


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
    quiet = quieten(GaugeTrace(volts, channel.step, channel.start), f"{path}.file")
    return -bridge.strain(-quiet.trace.strain)  # a bridge is not quite linear: it must know that this is compression


def _si(value: Value | None) -> float | None:
    return None if value is None else value.si


EXAMPLE = resources.files("strikewave.cases") / "hopkinson_example"
"""Folder of the example: set-up, record, and the licence of the record."""
RECORD = "shot.csv"
"""The record there, as its set-up calls it."""
LARGEST_FILE = 1_000_000
"""A set-up above this many bytes is refused: a record was named in its place, since no set-up comes near."""
FORM = Form(HopkinsonSetup, "set-up", 'bar.incident.speed="4866 m/s"')
"""A set-up file."""


class HopkinsonCase(NamedTuple):
    """A set-up, its text with all changes, and the folder that its files are relative to."""

    setup: HopkinsonSetup
    text: str
    folder: Path


def example_setup(record: str = RECORD) -> str:
    """Return the text of a set-up of a shot to begin from, every key with a comment; ``record`` is its file.

    Examples
    --------
    >>> parse_setup(example_setup("my-bars-shot.csv")).setup.bar.incident.gauge.file
    'my-bars-shot.csv'
    """
    text = (EXAMPLE / "setup.toml").read_text("utf-8")
    quoted, plain = re.escape(f'"{RECORD}"'), re.escape(RECORD)
    typed = json.dumps(record, ensure_ascii=False)
    return re.sub(f"{quoted}|{plain}", lambda found: typed if found[0].startswith('"') else record, text)


def example_record(name: str = "") -> tuple[str, str]:
    """Return name and text of the record of the example: a shot that was measured, with its credit.

    The record of a set-up is called after that, so that it takes the place of no measurement: ``my-bars-shot.csv``.

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
    """Return a set-up with what is stated of its test in the place of its own; the set-up itself where nothing is."""
    import tomlkit

    if not test:
        return case
    document = tomlkit.parse(case.text)
    document["test"] = dict(test)
    setup = case.setup.model_copy(update={"test": PerformedTest.model_validate(dict(test))})
    return case._replace(setup=setup, text=tomlkit.dumps(document))


def _check_tables(part: dict[str, Any], places: list[str]) -> None:
    """Refuse what stands where a table belongs, in words."""
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


BAR_STRAIN = 0.005
"""Plateau strain of a bar above which its material must be asked: a strong steel yields at 0.7 %."""
FLATTEST, SLENDEREST = 0.25, 2.0
"""Length over diameter: below it friction at the faces counts, above it the specimen buckles or is late."""
NEAREST_GAUGE = 10.0
"""Diameters between gauge and end of a bar after which the higher modes of a front have died away, as a rule."""
STRESS_OF_MODULUS = 0.1
"""Largest stress over the modulus: about the strength of a perfect crystal."""
LARGEST_STRESS = 10e9
"""Largest stress, Pa, where no modulus is stated."""


def check_strain(reduction: Reduction, curve: StressStrainCurve) -> None:
    """Refuse a specimen that is shorter than the way that its faces come together."""
    on = reduction.loading
    gone = np.flatnonzero(curve.strain[on] >= 1.0)
    if gone.size:
        when = float(reduction.time[on][gone[0]]) * 1e6
        got = f"{reduction.specimen.length * 1e3:.4g} mm, an engineering strain of 100 % after {when:.4g} us"
        hint = "look at the units of length and strain, and at diameter and speed of the bars"
        raise InputError("specimen.length", got, "more than the way by which its faces come together", hint)


def strain_notices(pulses: Pulses) -> Iterator[Notice]:
    """Yield an incident pulse that would bring most bars to yield."""
    if pulses.plateau > BAR_STRAIN:
        message = (
            f"the plateau of the incident pulse is {percent(pulses.plateau, 2)} of strain: does the bar bear that?"
        )
        yield Notice("bar-strain", message, pulses.plateau, BAR_STRAIN)


def gauge_notices(bars: tuple[Bar, Bar]) -> Iterator[Notice]:
    """Yield a gauge so near the specimen that the wave is not yet one-dimensional there."""
    for name, bar in zip(("incident", "transmitted"), bars, strict=True):
        diameters = bar.gauge_distance / bar.diameter
        if diameters < NEAREST_GAUGE:
            message = (
                f"the gauge of the {name} bar is {diameters:.3g} diameters from the specimen: waves are not yet plane"
            )
            yield Notice("gauge-near", message, diameters, NEAREST_GAUGE)


def specimen_notices(specimen: Specimen, bars: tuple[Bar, Bar]) -> Iterator[Notice]:
    """Yield a specimen wider than a bar, and one too flat or too slender for a uniform stress."""
    width = math.sqrt(4.0 * specimen.area / math.pi)
    narrowest = min(bar.diameter for bar in bars)
    if width > narrowest:
        message = f"the specimen, {width * 1e3:.4g} mm wide, is wider than a bar, {narrowest * 1e3:.4g} mm"
        yield Notice("specimen-wide", message, width, narrowest)
    shape = specimen.length / width
    if shape > SLENDEREST:
        message = f"the specimen is {shape:.3g} times as long as wide: it may buckle, and comes late to equilibrium"
        yield Notice("specimen-slender", message, shape, SLENDEREST)
    if shape < FLATTEST:
        message = f"the specimen is {shape:.3g} times as long as wide: friction at its faces raises the stress"
        yield Notice("specimen-flat", message, shape, FLATTEST)


def stress_notices(stress: float, specimen: Specimen) -> Iterator[Notice]:
    """Yield a largest stress (Pa) that no specimen bears."""
    limit = LARGEST_STRESS if specimen.modulus is None else STRESS_OF_MODULUS * specimen.modulus
    if stress > limit:
        words = "10 GPa" if specimen.modulus is None else "a tenth of the stated modulus"
        message = f"the largest stress is {stress / 1e9:.4g} GPa, above {words}: look at units, gains and diameters"
        yield Notice("stress-implausible", message, stress, limit)
