"""The case: everything a run needs, read from a TOML file with units and checked.

A quantity is "number unit", or a table { value, provenance, note }. `load_case` reads a file or one
of the published cases that come along; `dump_case` writes a case that gives the same numbers again.
"""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Iterable, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from strikewave.errors import MISSING, InputError, InputErrors, nearest, show
from strikewave.quantities import (
    Acceleration,
    BlowCount,
    Count,
    Damping,
    Duration,
    FeedTime,
    Force,
    Frequency,
    Inertia,
    Length,
    Mass,
    OutputStep,
    Provenance,
    Range,
    Restitution,
    Rotation,
    RotationDrag,
    RotationGain,
    SampleCount,
    Share,
    Speed,
    SpringRate,
    Tolerance,
    Torque,
    Value,
)
from strikewave.units import DIMENSIONS

SCHEMA = 1
LARGEST_FILE = 1_000_000
"""A case file above this many bytes is refused."""


TABLES = ("machine", "striker", "feed", "object", "contact", "recorder", "solver")
"""The tables of a case that hold quantities."""


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Machine(_Table):
    """[machine]: a rotary machine."""

    kind: Literal["rotary"]
    speed: Rotation
    strikers: Count
    radius: Length
    engagement: Length
    inertia: Inertia
    torque: Torque
    speed_gain: RotationGain
    drag: RotationDrag
    brake: Torque


class Striker(_Table):
    """[striker]: the impact component on its mount."""

    mass: Mass
    material: str
    nose_radius: Length
    contact_length: Length
    mount_stiffness: SpringRate
    mount_damping: Damping


class FeedTable(_Table):
    """[feed]: the hydraulic feed."""

    blows: BlowCount
    wait: Duration
    valve_delay: FeedTime
    stroke: Length
    stroke_time: FeedTime
    arrival: Share
    release_delay: FeedTime
    retract_time: FeedTime


class Object(_Table):
    """[object]: everything that moves when struck, and what holds it; gravity above 0 pushes it away."""

    mass: Mass
    nose_mass: Mass
    material: str
    frame_stiffness: SpringRate
    frame_damping: Damping
    spring: SpringRate
    preload: Force
    damper: Damping
    stop_stiffness: SpringRate
    stop_restitution: Restitution
    gravity: Acceleration


class ContactTable(_Table):
    """[contact]: law of the contact between nose and face."""

    law: str = "palmgren"
    damping: str = "exact"
    restitution: Restitution
    slowest_approach: Speed


class Recorder(_Table):
    """[recorder]: triggered by the valve signal."""

    sampling_rate: Frequency
    delay: Duration
    pre_trigger: Duration
    memory: SampleCount

    @property
    def begin(self) -> float:
        """Time of the first sample after the valve signal, s."""
        return self.delay.si - self.pre_trigger.si


class Solver(_Table):
    """[solver]: how exactly to compute, and how densely to keep the whole train."""

    tolerance: Tolerance = Value(si=1e-9, typed=1e-9)
    output_step: OutputStep = Value(si=1e-5, typed="10 us")


PUBLISHED_QUANTITIES = {
    "first.rigid_peak": "m/s^2",
    "first.width": "s",
    "first.peak_force": "N",
    "typical.rigid_peak": "m/s^2",
    "typical.width": "s",
    "count": "",
    "window": "s",
}
"""What a published number can be set beside: its name and SI unit."""


class Published(_Table):
    """[[published]]: a number to set beside the result."""

    quantity: str
    value: Value
    origin: Literal["measured", "simulated"]
    role: Literal["fitted", "predicted", "shown"]
    note: str = ""


def _published(raw: Any) -> Any:
    """Read a published number in the unit of the quantity it names."""
    if not isinstance(raw, Mapping) or "quantity" not in raw or "value" not in raw:
        return raw
    quantity, value = raw["quantity"], raw["value"]
    if not isinstance(quantity, str) or quantity not in PUBLISHED_QUANTITIES:
        raise InputError("quantity", quantity, "a computed quantity", nearest(str(quantity), PUBLISHED_QUANTITIES))
    unit = PUBLISHED_QUANTITIES[quantity]
    if isinstance(value, Value):
        return raw
    read = Range(unit, 0.0, open_low=True).read(value)
    return {**raw, "value": read.model_copy(update={"provenance": "published"})}


def _name(raw: Any) -> Any:
    """Check the name of a case: it names a folder."""
    if isinstance(raw, str) and not re.fullmatch(r"[\w][\w .+-]{0,79}|", raw):
        raise InputError("", raw, "letters, digits, space, dot, +, - and _, at most 80", "the name becomes a folder's")
    return raw


class Case(_Table):
    """A case as read: frozen, every quantity in SI with its provenance."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_version: Literal[1] = Field(alias="schema")
    name: Annotated[str, BeforeValidator(_name)] = ""
    title: str = ""
    source: str = ""
    machine: Machine
    striker: Striker
    feed: FeedTable
    object: Object
    contact: ContactTable
    recorder: Recorder
    solver: Solver = Solver()
    published: tuple[Annotated[Published, BeforeValidator(_published)], ...] = ()

    def values(self) -> dict[str, Value]:
        """Return every quantity by its path, such as ``machine.speed``."""
        found: dict[str, Value] = {}
        for table in TABLES:
            for key, value in getattr(self, table):
                if isinstance(value, Value):
                    found[f"{table}.{key}"] = value
        return found

    def fitted_fields(self) -> list[str]:
        """Return the paths of the fitted values."""
        return [path for path, value in self.values().items() if value.provenance == "fitted"]

    def changed_fields(self) -> list[str]:
        """Return the paths whose values differ from the published case that this one comes from.

        Recorder and solver do not count: they change no motion.
        """
        if self.source not in bundled_cases():
            return []
        origin = _published_values(self.source)
        values = {p: v for p, v in self.values().items() if p.partition(".")[0] not in ("recorder", "solver")}
        return [path for path, value in values.items() if value.si != origin[path].si]

    def with_values(self, changes: Mapping[str, Value]) -> Case:
        """Return the case with some quantities replaced, by path."""
        tables: dict[str, dict[str, Value]] = {}
        for path, value in changes.items():
            table, _, key = path.partition(".")
            if path not in self.values():
                raise InputError(path, value.typed, "a quantity of the case", nearest(path, self.values()))
            tables.setdefault(table, {})[key] = value
        return self.model_copy(update={t: getattr(self, t).model_copy(update=u) for t, u in tables.items()})


@functools.cache
def _published_values(name: str) -> dict[str, Value]:
    """Return the quantities of a published case; it is read once."""
    return load_case(name).values()


def bundled_cases() -> list[str]:
    """Return the names of the published cases that come along.

    Examples
    --------
    >>> "li-ma-2019" in bundled_cases()
    True
    """
    folder = resources.files("strikewave") / "cases"
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def read_case_text(name: str) -> tuple[str, str]:
    """Return the TOML text and the name of a case file, or of a published case.

    Raises
    ------
    InputError
        If there is neither, or the file is too large or not text.
    """
    if name in bundled_cases():
        return (resources.files("strikewave") / "cases" / f"{name}.toml").read_text("utf-8"), name
    path = Path(name)
    try:
        if path.is_dir() and (path / "case.toml").is_file():
            path = path / "case.toml"
        if not path.is_file():
            raise InputError("case", name, "a case file or a published case", nearest(name, bundled_cases()))
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("case", name, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError("case", name, f"a case file of at most {LARGEST_FILE // 1000} kB")
    try:
        return data.decode("utf-8"), path.stem
    except UnicodeDecodeError:
        raise InputError("case", name, "a text file in UTF-8") from None


def load_case(name: str, changes: Iterable[str] = ()) -> Case:
    """Read a case file or a published case, change some of its fields, and check it.

    Parameters
    ----------
    name : str
        Path of a TOML file, of a folder that holds ``case.toml``, or the name of a published case.
    changes : iterable of str, optional
        ``path=value`` each, such as ``machine.speed=500 rpm``.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that is wrong.

    Examples
    --------
    >>> case = load_case("li-ma-2019", ["machine.speed=500 rpm"])
    >>> round(case.machine.speed.si, 4)
    52.3599
    """
    text, stem = read_case_text(name)
    return parse_case(text, re.sub(r"[^\w.+-]+", "-", stem).strip("-.+") or "case", changes)


def parse_case(text: str, name: str = "", changes: Iterable[str] = ()) -> Case:
    """Check the TOML text of a case; see `load_case`."""
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = show(str(error) or "nested too deeply", 120).strip('"')
        raise InputErrors(
            [f"{name or 'case'}: not a TOML file: {reason}; `strikewave new` writes an example"]
        ) from None
    _check_schema(document)
    for change in changes:
        _apply(document, change)
    document.setdefault("name", name)
    try:
        return Case.model_validate(document)
    except ValidationError as error:
        raise InputErrors(_lines(error)) from None


def _check_schema(document: Mapping[str, Any]) -> None:
    schema = document.get("schema")
    if schema is None:
        raise InputError("schema", MISSING, f"schema = {SCHEMA}", f"begin the case file with schema = {SCHEMA}")
    if isinstance(schema, bool) or not isinstance(schema, int) or schema < 1:
        raise InputError("schema", schema, f"schema = {SCHEMA}")
    if schema > SCHEMA:
        raise InputError(
            "schema", schema, f"at most {SCHEMA}", "this file was written for a newer strikewave; update it"
        )


def _apply(document: dict[str, Any], change: str) -> None:
    """Set ``path=value`` in a case document; a bare number is SI; a changed quantity is assumed and says so."""
    path, equals, text = change.partition("=")
    path, text = path.strip(), text.strip()
    if not equals or not path or not text:
        raise InputError("--set", change, 'path=value, such as machine.speed="500 rpm"')
    *tables, key = path.split(".")
    place: Any = document
    for depth, table in enumerate(tables):
        if not isinstance(place, dict) or not isinstance(place.setdefault(table, {}), dict):
            raise InputError("--set " + ".".join(tables[: depth + 1]), change, "a table of the case")
        place = place[table]
    before = place.get(key)
    typed: Any = text
    for kind in (int, float):
        try:
            typed = kind(text)
            break
        except ValueError:
            continue
    allowed = _range_at([*tables, key])
    if allowed is None:
        place[key] = text if isinstance(before, str) else typed
        return
    if allowed.unit in DIMENSIONS and not isinstance(typed, str):
        typed = f"{text} {allowed.unit}"
    place[key] = {"value": typed, "provenance": "assumed", "note": "set by the user"}


def _lines(error: ValidationError) -> list[str]:
    """Turn pydantic's report into one line a fault: field, what came, what is allowed, what to do."""
    lines = []
    for fault in error.errors():
        places = [show(str(part)).strip('"') for part in fault["loc"]]
        path = ".".join(places)
        cause = fault.get("ctx", {}).get("error")
        if isinstance(cause, InputError):
            inner = ".".join([path, cause.field]) if cause.field else path
            lines.append(str(InputError(inner, cause.got, cause.allowed, cause.hint)))
        elif fault["type"] == "extra_forbidden":
            known = _keys_at(places[:-1])
            lines.append(f"{path}: unknown key; {nearest(places[-1], known)}")
        elif fault["type"] == "missing":
            lines.append(f"{path}: missing; {_example(places)}")
        elif fault["type"] == "literal_error":
            expected = fault.get("ctx", {}).get("expected", "")
            lines.append(str(InputError(path, fault["input"], str(expected))))
        else:
            lines.append(f"{path or 'case'}: got {show(fault['input'])}; {fault['msg']}")
    return lines


def _model_at(places: list[str]) -> type[BaseModel] | None:
    model: type[BaseModel] | None = Case
    for place in places:
        if place.isdigit() or model is None:
            continue
        if place == "published":
            model = Published
            continue
        field = model.model_fields.get(place)
        kind = field.annotation if field else None
        model = kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None
    return model


def _keys_at(places: list[str]) -> list[str]:
    model = _model_at(places)
    return [field.alias or key for key, field in model.model_fields.items()] if model else []


def _range_at(places: list[str]) -> Range | None:
    """Return what the quantity at a path may be; None where there is no quantity."""
    model = _model_at(places[:-1])
    field = model.model_fields.get(places[-1]) if model else None
    for rule in field.metadata if field else ():
        owner = getattr(getattr(rule, "func", None), "__self__", None)
        if isinstance(owner, Range):
            return owner
    return None


def _example(places: list[str]) -> str:
    allowed = _range_at(places)
    if allowed is not None and allowed.unit in DIMENSIONS:
        return f'add {places[-1]} = "{DIMENSIONS[allowed.unit][1]}"'
    if allowed is not None:
        return f"add {places[-1]}, {allowed.allowed()}"
    return f"add [{places[-1]}]" if len(places) == 1 else f"add {places[-1]}"


def document_of(case: Case) -> dict[str, Any]:
    """Return a case as the plain tables of a case file."""
    head = {"schema": SCHEMA, "name": case.name, "title": case.title, "source": case.source}
    document: dict[str, Any] = {key: value for key, value in head.items() if value}
    for table in TABLES:
        rows = getattr(case, table)
        document[table] = {key: value.document() if isinstance(value, Value) else value for key, value in rows}
    document["published"] = [
        {key: value.typed if isinstance(value, Value) else value for key, value in entry if value != ""}
        for entry in case.published
    ]
    return document


def dump_case(case: Case) -> str:
    """Write a case as TOML that reads back to the same numbers and provenance.

    Examples
    --------
    >>> case = load_case("li-ma-2019")
    >>> parse_case(dump_case(case)) == case
    True
    """
    import tomlkit

    document = tomlkit.document()
    for key, value in document_of(case).items():
        if isinstance(value, dict):
            table = tomlkit.table()
            for name, entry in value.items():
                if isinstance(entry, dict):
                    inline = tomlkit.inline_table()
                    inline.update(entry)
                    table[name] = inline
                else:
                    table[name] = entry
            document[key] = table
        elif isinstance(value, list):
            rows = tomlkit.aot()
            for entry in value:
                row = tomlkit.table()
                row.update(entry)
                rows.append(row)
            document[key] = rows
        else:
            document[key] = value
    return tomlkit.dumps(document)


__all__ = [
    "Case",
    "Provenance",
    "Value",
    "bundled_cases",
    "document_of",
    "dump_case",
    "load_case",
    "parse_case",
]
