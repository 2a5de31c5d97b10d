"""Case in; stack, taps, load and measuring channels out, and where the stack loses energy."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import scipy

from strikewave.base import declare
from strikewave.base.citations import FROM_MEMORY
from strikewave.base.constants import Material, material
from strikewave.base.declare import KEY
from strikewave.base.errors import MISSING, InputError, checked, nearest, show
from strikewave.base.quantities import Value
from strikewave.base.result import INFO, Notice
from strikewave.base.shock_quantities import FREQUENCY, RATIO
from strikewave.cases.case import Case
from strikewave.cases.contact_parts import capped_pressure, cushion_of, pressure_words, refuse_beyond_law
from strikewave.cases.files import read_small_file
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable
from strikewave.cases.tables.contact import CUSHION
from strikewave.cases.tables.stack import EndTable, JointTable, LayerTable, SensorTable
from strikewave.contact.damping import named_contact
from strikewave.contact.elastoplastic import cap_of
from strikewave.contact.stiffness import Geometry, stiffness_of
from strikewave.records import Channel, Options, read_record
from strikewave.records.calibration import known_unit
from strikewave.sensors import (
    Accelerometer,
    Gasket,
    Mounting,
    Recorder,
    Sensor,
    accelerometer,
    accelerometers,
    oscilloscope,
    storage_recorder,
)
from strikewave.sensors.chain import RATE_OVER_CUTOFF
from strikewave.sensors.mounting import mounting_system
from strikewave.sensors.trial import SensorChannel
from strikewave.waves import BONDED, End, Joint, Layer, Sampled, Stack, Tap
from strikewave.waves.dispersion import Theory
from strikewave.waves.layers import LossFit
from strikewave.waves.li_ma import EXACT
from strikewave.waves.spectral import USUAL_BAND, fit_loss

T = TypeVar("T")

DEFAULT_LAW = "hertz"  # stiffness law of a contact between two layers that names none
USUAL_TAPS = 20  # where a case names none: the middle of each layer, of many layers as many as a figure can hold
_EXAMPLES = {
    "density": 'density = "2700 kg/m^3"',
    "modulus": 'modulus = "70 GPa"',
    "poissons_ratio": "poissons_ratio = 0.3",
}
"""Example to add where a layer lacks a number."""
_JOINT_FIELDS = {
    "bonded": (),
    "compliant": ("stiffness", "damping"),
    "gasket": ("material", "modulus", "loss_factor", "thickness", "diameter", "area", "band_low", "band_high"),
    "unilateral": ("stiffness", "damping", "gap", "preload"),
    "mass": ("mass",),
    "oscillator": ("mass", "stiffness", "resonance", "damping", "quality"),
    "contact": ("law", "radius", "length", "datum_depth", "gap", "preload", "yield_pressure"),
    "cushion": ("cushion", "gap", "preload"),
}
"""Fields that each kind of joint takes: any other would be read and do nothing."""


class Matter(NamedTuple):
    """The material of a table: its numbers, its own or those of the table of materials, and its row there."""

    density: float | None
    modulus: float | None
    loss_factor: float | None
    row: Material | None


def need(value: Value | None, path: str, allowed: str, hint: str = "") -> float:
    """Return the SI value of a field that this kind of part needs."""
    if value is None:
        raise InputError(path, MISSING, allowed, hint)
    return value.si


def matter_of(table: Any, path: str) -> Matter:
    """Return the material of a table; its own numbers overrule those of the named material."""
    row, numbers = material(table.material, f"{path}.material") if table.material else None, []
    for key, column in (("density", "density"), ("modulus", "youngs_modulus"), ("loss_factor", "loss_factor")):
        own = getattr(table, key, None)
        numbers.append(own.si if own else getattr(row, column, None))
    density, modulus, loss = numbers
    return Matter(density, modulus, loss, row)


def area_of(table: Any, path: str, other: float | None = None) -> float:
    """Return the area of a table that has a diameter or an area, m^2; ``other`` where it has neither."""
    if table.diameter is not None and table.area is not None:
        hint = f'remove one of them, or --set "{path}.diameter=none"'
        raise InputError(f"{path}.area", table.area.typed, "diameter or area, not both", hint)
    if table.area is not None:
        return float(table.area.si)
    if table.diameter is not None:
        return 0.25 * math.pi * float(table.diameter.si) ** 2
    if other is None:
        raise InputError(f"{path}.diameter", MISSING, "a diameter or an area", 'add diameter = "30 mm"')
    return other


def _layer(table: LayerTable, dispersion: Theory) -> Layer:
    path = f"stack.layer.{table.name}"
    matter = matter_of(table, path)
    if matter.density is None or matter.modulus is None:
        raise InputError(f"{path}.material", MISSING, "a material, or density and modulus", 'add material = "65Mn"')
    ratio = _poissons_ratio(table, matter)
    if dispersion != "none" and ratio is None:
        allowed = f"a Poisson's ratio for the dispersion {dispersion}"
        raise InputError(f"{path}.poissons_ratio", MISSING, allowed, "add one")
    return Layer(
        table.name,
        matter.density,
        matter.modulus,
        area_of(table, path),
        table.length.si,
        table.diameter.si if table.diameter else 0.0,
        matter.row.yield_strength if matter.row else None,
        ratio,
        table.speed.si if table.speed else 0.0,
        layer_loss(table, path),
        dispersion,
    )


def _poissons_ratio(table: LayerTable, matter: Matter) -> float | None:
    """Return the Poisson's ratio of a layer, its own before that of the named material; None where neither has one."""
    if table.poissons_ratio is not None:
        return table.poissons_ratio.si
    return matter.row.poissons_ratio if matter.row else None


def layer_material(table: LayerTable, path: str) -> Material:
    """Return the material of a layer for a contact law: its own numbers, and those of the named one."""
    matter = matter_of(table, path)
    density, modulus, ratio = matter.density, matter.modulus, _poissons_ratio(table, matter)
    if density is None or modulus is None or ratio is None:
        missing = next(key for key in ("density", "modulus", "poissons_ratio") if getattr(table, key) is None)
        allowed = "a number of its own, for the contact, where it names no material"
        raise InputError(f"{path}.{missing}", MISSING, allowed, f'add {_EXAMPLES[missing]}, or material = "65Mn"')
    row = matter.row or Material(table.name, density, modulus, ratio, "own", "the case", "stated", "")
    return dataclasses.replace(row, density=density, youngs_modulus=modulus, poissons_ratio=ratio)


def layer_loss(table: LayerTable, path: str) -> LossFit | None:
    """Return the springs and branches of a layer that loses energy, for a modulus of one."""
    if table.loss_factor is None:
        for key in ("band_low", "band_high"):
            if getattr(table, key) is not None:
                raise InputError(f"{path}.{key}", getattr(table, key).typed, "only with a loss_factor", "add it")
        return None
    return fitted(table, path, 1.0, table.loss_factor.si) if table.loss_factor.si > 0.0 else None


def fitted(table: LayerTable | JointTable, path: str, stiffness: float, loss_factor: float) -> LossFit:
    """Return the springs and branches of a loss factor over the band of a table."""
    ends = zip((table.band_low, table.band_high), USUAL_BAND, strict=True)
    low, high = (end.si if end else usual for end, usual in ends)
    return checked(f"{path}.loss_factor", lambda: fit_loss(stiffness, loss_factor, low, high))


def _joint(table: JointTable, before: LayerTable, after: LayerTable) -> Joint:
    path = f"stack.joint.{table.after}"
    takes = _JOINT_FIELDS[table.kind]
    for key in sorted({field for fields in _JOINT_FIELDS.values() for field in fields} - set(takes)):
        if getattr(table, key) not in (None, ""):
            allowed = f"for a joint of kind {table.kind}: {', '.join(takes) or 'no other field'}"
            raise InputError(f"{path}.{key}", typed(getattr(table, key)), allowed)
    damping = table.damping.si if table.damping else 0.0
    if table.kind == "compliant":
        return Joint(need(table.stiffness, f"{path}.stiffness", "a stiffness", 'add stiffness = "90 MN/m"'), damping)
    if table.kind == "mass":
        return Joint(mass=need(table.mass, f"{path}.mass", "a mass", 'add mass = "5 gram"'))
    if table.kind == "gasket":
        return _gasket(table, path, min(area_of(x, f"stack.layer.{x.name}") for x in (before, after)))
    if table.kind == "unilateral":
        stiffness = table.stiffness.si if table.stiffness else math.inf
        gap, preload = (value.si if value else 0.0 for value in (table.gap, table.preload))
        return checked(path, lambda: Joint(stiffness, damping, (), True, gap, preload))
    if table.kind == "oscillator":
        hung = _hung(table, path)
        return checked(path, lambda: Joint(hung.stiffness, hung.damping, attached=hung.mass))
    if table.kind == "contact":
        return _contact(table, path, before, after)
    if table.kind == CUSHION:
        if table.cushion is None:
            hint = "add [stack.joint.cushion] with its thickness and law"
            raise InputError(f"{path}.cushion", MISSING, "a pad", hint)
        smaller = min(area_of(x, f"stack.layer.{x.name}") for x in (before, after))
        area = area_of(table.cushion, f"{path}.cushion", smaller)
        cushion = cushion_of(table.cushion, f"{path}.cushion", area)
        gap, preload = (value.si if value else 0.0 for value in (table.gap, table.preload))
        return checked(path, lambda: Joint(contact=cushion.contact(), gap=gap, preload=preload))
    return BONDED


class Hung(NamedTuple):
    """A mass on a spring with dashpot: kg, N/m, N s/m."""

    mass: float
    stiffness: float
    damping: float


def _hung(table: JointTable | EndTable, path: str) -> Hung:
    """Return a mass on a spring by stiffness or resonance, damping or quality."""
    for direct, derived in (("stiffness", "resonance"), ("damping", "quality")):
        if getattr(table, direct) is not None and getattr(table, derived) is not None:
            raise InputError(f"{path}.{derived}", getattr(table, derived).typed, f"{direct} or {derived}, not both")
    mass = need(table.mass, f"{path}.mass", "the mass on the spring", 'add mass = "2 gram"')
    if table.stiffness is not None:
        stiffness = table.stiffness.si
    else:
        f = need(table.resonance, f"{path}.resonance", "a resonance or a stiffness", 'add resonance = "50 kHz"')
        stiffness = mass * (2.0 * math.pi * f) ** 2
    damping = table.damping.si if table.damping else 0.0
    if table.quality is not None:
        damping = math.sqrt(stiffness * mass) / table.quality.si
    return Hung(mass, stiffness, damping)


def _contact(table: JointTable, path: str, before: LayerTable, after: LayerTable) -> Joint:
    """Return a nonlinear contact between the materials of two layers."""
    first, second = (layer_material(x, f"stack.layer.{x.name}") for x in (before, after))
    of_line = table.length.si if table.length else None
    datum = table.datum_depth.si if table.datum_depth else None
    geometry = Geometry(table.radius.si if table.radius else None, math.inf, of_line, datum)
    try:
        stiffness = stiffness_of(table.law or DEFAULT_LAW, first, second, geometry, f"{path}.law")
    except InputError as error:
        if error.field != "radius1":
            raise
        allowed = "the radius of the first face; the second one is plane"
        raise InputError(f"{path}.radius", error.got, allowed, 'add radius = "10 mm"') from None
    cap = None
    if table.yield_pressure is not None:
        pressure = capped_pressure(table.yield_pressure, first, second, f"{path}.yield_pressure")
        cap = checked(f"{path}.yield_pressure", lambda: cap_of(first, second, geometry, pressure))
        refuse_beyond_law(cap, stiffness, pressure_words(table.yield_pressure), f"{path}.yield_pressure", pressure)
    law = named_contact(stiffness, "exact", 1.0, cap)
    gap, preload = (value.si if value else 0.0 for value in (table.gap, table.preload))
    return checked(path, lambda: Joint(contact=law, gap=gap, preload=preload))


def _gasket(table: JointTable, path: str, area: float) -> Joint:
    matter = matter_of(table, path)
    if matter.modulus is None:
        raise InputError(f"{path}.material", MISSING, "a material or a modulus", 'add material = "PTFE"')
    thickness = need(table.thickness, f"{path}.thickness", "a thickness", 'add thickness = "1 mm"')
    area = area_of(table, path, area)
    stiffness = matter.modulus * area / thickness
    fit = fitted(table, path, stiffness, matter.loss_factor or 0.0)
    strength = matter.row.yield_strength if matter.row else None
    return Joint(fit.stiffness, branches=fit.branches, yield_force=strength * area if strength else math.inf)


def typed(value: Any) -> Any:
    """Return a quantity as it was typed; words stay."""
    return value.typed if isinstance(value, Value) else value


def build_stack(case: Case) -> Stack:
    """Return the stack of a case.

    Examples
    --------
    >>> from strikewave import load_case
    >>> len(build_stack(load_case("li-ma-2019-fig13")).layers) > 2
    True
    """
    table = case.stack
    names = [layer.name for layer in table.layer]
    if not names:
        raise InputError("stack.layer", MISSING, "at least one [[stack.layer]]")
    once("stack.layer", names)
    once("stack.joint", [joint.after for joint in table.joint])
    layers = tuple(_layer(layer, case.solver.dispersion) for layer in table.layer)
    joints = [BONDED] * (len(layers) - 1)
    for joint in table.joint:
        if joint.after not in names[:-1]:
            hint = nearest(joint.after, names[:-1]) if names[:-1] else "a single layer has no joint"
            raise InputError("stack.joint.after", joint.after, "a layer that another one follows", hint)
        k = names.index(joint.after)
        joints[k] = _joint(joint, table.layer[k], table.layer[k + 1])
    return Stack(layers, tuple(joints), _end(case))


def _end(case: Case) -> End:
    end = case.stack.end
    fields = {"mass": "mass", "spring": "stiffness", "dashpot": "damping"}
    every = _JOINT_FIELDS["oscillator"]
    takes = every if end.kind == "oscillator" else tuple(key for kind, key in fields.items() if kind == end.kind)
    for key in every:
        if getattr(end, key) is not None and key not in takes:
            allowed = ", ".join(takes) or "no other field"
            raise InputError(f"stack.end.{key}", typed(getattr(end, key)), f"for the kind {end.kind}: {allowed}")
    if end.kind == "oscillator":
        hung = _hung(end, "stack.end")
        return End(end.kind, *hung)
    if end.kind not in fields:
        return End(end.kind)
    key = fields[end.kind]
    value = need(getattr(end, key), f"stack.end.{key}", f"a {key} for an end of kind {end.kind}")
    return checked(f"stack.end.{key}", lambda: End(end.kind, value))


def once(path: str, names: list[str]) -> None:
    """Refuse a name that stands twice."""
    for k, name in enumerate(names):
        if name in names[:k]:
            raise InputError(path, name, "each name once", "give the second one another name")


def build_taps(case: Case) -> tuple[tuple[str, Tap], ...]:
    """Return name and place of each tap; where a case names none the middles of its layers, of many layers some."""
    names = [layer.name for layer in case.stack.layer]
    if not case.tap:
        shown = np.unique(np.linspace(0, len(names) - 1, min(len(names), USUAL_TAPS)).round().astype(int)).tolist()
        return tuple((f"{names[k]} middle", Tap(k, 0.5)) for k in shown)
    once("tap", [tap.name for tap in case.tap])
    for tap in case.tap:
        if tap.layer not in names:
            raise InputError(f"tap.{tap.name}.layer", tap.layer, "a layer of the stack", nearest(tap.layer, names))
    return tuple((tap.name, Tap(names.index(tap.layer), tap.position.si)) for tap in case.tap)


def check_route(case: Case, taps: Sequence[tuple[str, Tap]], channels: Sequence[SensorChannel]) -> None:
    """Refuse a route of the paper where the first tap, or one that a sensor sits at, has no neighbour on one side."""
    if case.solver.route == EXACT:
        return
    last = len(case.stack.layer) - 1
    for k in sorted({0, *(channel.tap for channel in channels if channel.tap is not None)}):
        name, tap = taps[k]
        if not 0 < tap.layer < last:
            allowed = f'a layer between two others for the route "{case.solver.route}"'
            hint = 'move the tap, or take solver.route = "exact"'
            raise InputError(f"tap.{name}.layer", case.stack.layer[tap.layer].name, allowed, hint)


FORCE, SPEED, ACCELERATION = "N", "m/s", "m/s^2"


def read_load(path: str) -> Sampled:
    """Read a load from the first channel of a file; time may be uneven.

    A channel without a unit is a force in N. One in m/s or m/s^2 is the speed or acceleration of the face, which
    is at rest at the first sample.
    """
    try:
        channel = _first(path)
    except InputError as error:
        raise InputError("load.file", path if error.got == path else error.got, error.allowed, error.hint) from None
    time = channel.stamps if channel.stamps is not None else channel.time
    if not np.all(np.isfinite(time)):
        raise InputError("load.file", path, "a file with time", 'a first column such as "time [us]"')
    unit, factor = (FORCE, 1.0) if not channel.unit else known_unit(channel.unit) or ("", 1.0)
    if unit not in (FORCE, SPEED, ACCELERATION):
        allowed = "a force, a speed or an acceleration as the first channel"
        raise InputError("load.file", channel.unit, allowed, 'name its unit, such as "force [kN]"')
    values = channel.values * factor
    if unit == ACCELERATION:
        values, unit = scipy.integrate.cumulative_trapezoid(values, time, initial=0.0), SPEED
    try:
        return Sampled(time, values, "force" if unit == FORCE else "speed", bool(channel.unit))
    except ValueError as error:
        raise InputError("load.file", path, "times that rise and finite values", str(error)) from None


def _first(path: str) -> Channel:
    record = read_record(path)
    if record.format == "text" and record.channels and record.channels[0].stamps is None:
        record = read_record(path, Options(time="1"))
    if not record.channels:
        raise InputError("load.file", path, "a file with time and one channel")
    return record.channels[0]


_SENSOR_FIELDS = {"resonance": float, "quality": float, "range": float, "zero_shift": float}
_RECORDER_FIELDS = {"sampling_rate": float, "cutoff": float, "order": int, "bits": int}
"""Fields of [[sensor]] that overrule the model of the sensor, and its recorder."""


def build_channels(case: Case) -> tuple[SensorChannel, ...]:
    """Return the measuring channels of a case."""
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
    """Return the mounted sensor of a table, and its recorder; ``rate`` is that of [recorder], Hz."""
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
    """Return the stated fields of a table, in SI."""
    values = [(key, getattr(table, key), kind) for key, kind in fields.items()]
    return {key: kind(value.si) for key, value, kind in values if isinstance(value, Value)}


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


class SensorFile(CaseTable):
    """A file with the [[sensor]] of a case, as ``buffer --record`` writes it."""

    sensor: tuple[SensorTable, ...]


FORM = Form(SensorFile, "sensor", 'sensor.shock.range="20000 g"')
ALLOWED = 'a TOML file with one [[sensor]], such as name = "shock" and model = "Endevco 2225"'


class StatedSensor(NamedTuple):
    """A sensor with its recorder, the model of which its numbers are as far as they are not its own, and notices."""

    sensor: Sensor
    recorder: Recorder
    model: Accelerometer | None
    notices: tuple[Notice, ...]


def stated_sensor(asked: str, field: str) -> StatedSensor:
    """Return the accelerometer of a name, directly mounted, or the sensor of a file that ends in ``.toml``.

    Examples
    --------
    >>> stated_sensor("endevco 2225", "--sensor").sensor.resonance
    80000.0
    """
    if asked.lower().endswith(".toml"):
        return _of_table(_only_table(Path(asked), field), field)
    known = {name.lower(): row for name, row in accelerometers().items()}
    model = known.get(asked.lower())
    if model is None:
        hint = nearest(asked, accelerometers())
        listed = "" if hint.startswith("choose") else f" ({', '.join(accelerometers())})"
        raise InputError(field, asked, f"an accelerometer of the table{listed}, or a file that ends in .toml", hint)
    message = f"range and resonance of {model.name} are from memory: no data sheet that states them could be opened; "
    message += "give them in a file with [[sensor]] from yours"
    notices = (Notice("sensor-from-memory", message, 1.0, 0.0, INFO),) if model.status == FROM_MEMORY else ()
    return StatedSensor(model.mounted(), Recorder(), model, notices)


def _of_table(table: SensorTable, field: str) -> StatedSensor:
    if table.tap:
        raise InputError(f"{field} sensor.{table.name}.tap", table.tap, "no tap: a record has none", "remove it")
    sensor, recorder = chain_of(table)
    if math.isinf(sensor.range) and math.isinf(sensor.resonance) and sensor.mounting.direct:
        raise InputError(
            f"{field} sensor.{table.name}", MISSING, "a model, a range or a resonance", 'add model = "Endevco 2225"'
        )
    from_table = table.model and (table.range is None or table.resonance is None)
    model = accelerometer(table.model) if from_table else None
    return StatedSensor(sensor, recorder, model, tuple(memory_notices(table)))


def _only_table(file: Path, field: str) -> SensorTable:
    document = read_small_file(file, field, ALLOWED)
    if set(document) != {"sensor"}:
        raise InputError(field, file, ALLOWED, f"it has {', '.join(map(show, document)) or 'nothing'}")
    tables = FORM.read(document, f"{field} ").sensor
    if len(tables) != 1:
        raise InputError(field, file, ALLOWED, f"it has {len(tables)}")
    return tables[0]


@declare.dataclass
class FittedLoss:
    """A loss factor held by springs and dashpots over a band of frequencies."""

    where: str = declare.word("what loses energy", column=KEY)
    loss_factor: float = declare.number(RATIO, "its loss factor in the case")
    error: float = declare.number(RATIO, "by how much of it the springs and dashpots miss it at most")
    low: float = declare.number(FREQUENCY, "low end of the band")
    high: float = declare.number(FREQUENCY, "high end of the band")


def fitted_losses(case: Case) -> tuple[FittedLoss, ...]:
    """Return the losses of layers, of gaskets between layers, and of gaskets under sensors.

    Examples
    --------
    >>> from strikewave import load_case
    >>> fitted_losses(load_case("li-ma-2019-fig13-bar", ["stack.layer.lower.loss_factor=0.1"]))[0].loss_factor
    0.1
    """
    losses = []
    for layer in case.stack.layer:
        fit = layer_loss(layer, f"stack.layer.{layer.name}")
        if fit is not None and layer.loss_factor is not None:
            losses.append(FittedLoss(layer.name, layer.loss_factor.si, fit.error, *fit.band))
    for joint in case.stack.joint:
        path = f"stack.joint.{joint.after}"
        eta = matter_of(joint, path).loss_factor if joint.kind == "gasket" else None
        if eta:
            fit = fitted(joint, path, 1.0, eta)
            losses.append(FittedLoss(f"gasket after {joint.after}", eta, fit.error, *fit.band))
    for channel in build_channels(case):
        mounting = channel.sensor.mounting
        for k, gasket in enumerate(mounting.gaskets):
            if gasket.loss_factor:
                fit = mounting.loss(gasket)
                where = f"gasket {k + 1} under {channel.sensor.name}"
                losses.append(FittedLoss(where, gasket.loss_factor, fit.error, *fit.band))
    return tuple(losses)
