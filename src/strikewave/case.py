"""The case: everything a run needs, read from a TOML file with units and checked.

A quantity is "number unit", or a table { value, provenance, note }. `load_case` reads a file or one
of the published cases that come along; `dump_case` writes a case that gives the same numbers again.
"""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from strikewave.errors import MISSING, InputError, InputErrors, nearest, show
from strikewave.quantities import Provenance, Range, Value
from strikewave.tables import (
    PUBLISHED_QUANTITIES,
    ContactTable,
    FeedTable,
    LoadTable,
    Machine,
    Object,
    Published,
    Recorder,
    SensorTable,
    Solver,
    StackTable,
    Striker,
    Table,
    TapTable,
    case_name,
    read_published,
)
from strikewave.units import DIMENSIONS

SCHEMA = 1
LARGEST_FILE = 1_000_000
"""A case file above this many bytes is refused."""


TABLES = ("machine", "striker", "feed", "object", "contact", "stack", "load", "tap", "sensor", "recorder", "solver")
"""The tables of a case that hold quantities."""
RIG = ("machine", "striker", "feed", "object", "contact", "recorder")
"""The tables that a machine needs."""


class Rig(NamedTuple):
    """The tables of a machine case, all of them there."""

    machine: Machine
    striker: Striker
    feed: FeedTable
    object: Object
    contact: ContactTable
    recorder: Recorder


class Case(Table):
    """A case as read: frozen, every quantity in SI with its provenance."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_version: Literal[1] = Field(alias="schema")
    name: Annotated[str, BeforeValidator(case_name)] = ""
    title: str = ""
    source: str = ""
    machine: Machine | None = None
    striker: Striker | None = None
    feed: FeedTable | None = None
    object: Object | None = None
    contact: ContactTable | None = None
    stack: StackTable = StackTable()
    load: LoadTable | None = None
    tap: tuple[TapTable, ...] = ()
    sensor: tuple[SensorTable, ...] = ()
    recorder: Recorder | None = None
    solver: Solver = Solver()
    published: tuple[Annotated[Published, BeforeValidator(read_published)], ...] = ()

    @model_validator(mode="after")
    def _whole(self) -> Case:
        """Refuse a case without anything to run, and a machine without one of its tables."""
        if self.machine is None and not self.stack.layer:
            missing = [name for name in RIG if getattr(self, name) is None]
            if len(missing) == len(RIG):
                raise InputError("", MISSING, "[machine] with its tables, or [[stack.layer]] with [load]")
        if self.machine is not None or not self.stack.layer:
            lines = [f"{name}: missing; add [{name}]" for name in RIG if getattr(self, name) is None]
            if lines:
                raise InputErrors(lines)
        return self

    @property
    def command(self) -> str:
        """The command that runs it: "run" a machine, or "wave" a bar alone."""
        return "run" if self.machine is not None else "wave"

    def rig(self) -> Rig:
        """Return the tables of the machine.

        Raises
        ------
        InputError
            If the case is that of a bar alone.
        """
        if self.machine is None:
            hint = "this case is a bar alone: `strikewave wave` runs it"
            raise InputError("machine", MISSING, "[machine] with its tables", hint)
        return Rig(*(getattr(self, name) for name in RIG))

    def values(self) -> dict[str, Value]:
        """Return every quantity by its path, such as ``machine.speed`` or ``stack.layer.upper.length``."""
        found: dict[str, Value] = {}
        for name in TABLES:
            found.update(_values(getattr(self, name), name))
        return found

    def fitted_fields(self) -> list[str]:
        """Return the paths of the fitted values."""
        return [path for path, value in self.values().items() if value.provenance == "fitted"]

    def changed_fields(self) -> list[str]:
        """Return the paths whose values or choices differ from the published case that this one comes from.

        The solver does not count, nor the recorder where no sensor feels it: they change no result.
        """
        if self.source not in bundled_cases():
            return []
        aside = ("solver",) if self.sensor else ("solver", "recorder")
        origin, mine = _published_entries(self.source), self.entries()
        changed = [path for path, value in mine.items() if path not in origin or value != origin[path]]
        gone = [path for path in origin if path not in mine]
        return [path for path in changed + gone if path.partition(".")[0] not in aside]

    def entries(self) -> dict[str, float | str]:
        """Return every quantity (SI) and every choice, such as a material, by its path."""
        found: dict[str, float | str] = {}
        for name in TABLES:
            found.update(_entries(getattr(self, name), name))
        return found

    def with_values(self, changes: Mapping[str, Value]) -> Case:
        """Return the case with some quantities replaced, by path."""
        case = self
        for path, value in changes.items():
            if path not in self.values():
                raise InputError(path, value.typed, "a quantity of the case", nearest(path, self.values()))
            case = _with_value(case, path.split("."), value)
        return case


def _values(part: Any, path: str) -> Iterator[tuple[str, Value]]:
    """Yield every quantity below a part of a case with its path."""
    if isinstance(part, Value):
        yield path, part
    elif isinstance(part, BaseModel):
        for key, value in part:
            yield from _values(value, f"{path}.{key}")
    elif isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _values(row, f"{path}.{row_name(row, place)}")


def _entries(part: Any, path: str) -> Iterator[tuple[str, float | str]]:
    """Yield every quantity, in SI, and every word below a part of a case with its path."""
    if isinstance(part, Value):
        yield path, part.si
    elif isinstance(part, str):
        if part:
            yield path, part
    elif isinstance(part, BaseModel):
        for key, value in part:
            yield from _entries(value, f"{path}.{key}")
    elif isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _entries(row, f"{path}.{row_name(row, place)}")


def row_name(row: Any, place: int) -> str:
    """Return how a path calls a row of an array of tables: by its name, what it comes after, or its place."""
    get = row.get if isinstance(row, Mapping) else (lambda key, default: getattr(row, key, default))
    return str(get("name", "") or get("after", "") or place)


def _with_value(part: Any, places: list[str], value: Value) -> Any:
    """Return a part of a case with the quantity at a path replaced."""
    if not places:
        return value
    first, rest = places[0], places[1:]
    if isinstance(part, tuple):
        return tuple(
            _with_value(row, rest, value) if row_name(row, place) == first else row for place, row in enumerate(part)
        )
    return part.model_copy(update={first: _with_value(getattr(part, first), rest, value)})


@functools.cache
def _published_entries(name: str) -> dict[str, float | str]:
    """Return quantities and choices of a published case; it is read once."""
    return load_case(name).entries()


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
        hint = "values with a unit stand in quotes; `strikewave new` writes an example"
        raise InputErrors([f"{name or 'case'}: not a TOML file: {reason}; {hint}"]) from None
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
        inner: Any = None
        if isinstance(place, dict):
            inner = place.setdefault(table, {})
        elif isinstance(place, list):
            inner = next((row for k, row in enumerate(place) if table in (row_name(row, k), str(k))), None)
        if not isinstance(inner, dict | list) or (isinstance(inner, list) and depth == len(tables) - 1):
            raise InputError("--set " + ".".join(tables[: depth + 1]), change, "a table of the case")
        place = inner
    if not isinstance(place, dict):
        raise InputError("--set " + path, change, "a table of the case")
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
        elif isinstance(cause, InputErrors):
            lines += cause.lines
        elif fault["type"] == "tuple_type":
            lines.append(f"{path}: got one table; write [[{path}]], once for each")
        elif fault["type"] == "literal_error":
            expected = fault.get("ctx", {}).get("expected", "")
            lines.append(str(InputError(path, fault["input"], str(expected))))
        else:
            lines.append(f"{path or 'case'}: got {show(fault['input'])}; {fault['msg']}")
    return lines


def _model_at(places: list[str]) -> type[BaseModel] | None:
    """Return the model of the table at a path; a name or number stands for the row of an array of tables."""
    model: type[BaseModel] | None = Case
    in_rows = False
    for place in places:
        if in_rows:
            in_rows = False
            continue
        field = model.model_fields.get(place) if model else None
        model, in_rows = _table_in(field.annotation) if field else (None, False)
    return model


def _table_in(kind: Any) -> tuple[type[BaseModel] | None, bool]:
    """Return the table that an annotation holds, and whether it holds a row of them."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind, False
    for part in get_args(kind):
        table, rows = _table_in(part)
        if table is not None:
            return table, rows or get_origin(kind) is tuple
    return None, False


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
        rows = _document(getattr(case, table))
        if rows:
            document[table] = rows
    published = [
        {key: value.typed if isinstance(value, Value) else value for key, value in entry if value != ""}
        for entry in case.published
    ]
    return {**document, "published": published} if published else document


def _document(part: Any) -> Any:
    """Return a part of a case as plain tables, without what is absent."""
    if isinstance(part, Value):
        return part.document()
    if isinstance(part, BaseModel):
        if isinstance(part, StackTable) and not part.layer:
            return {}
        rows = {key: _document(value) for key, value in part}
        return {key: value for key, value in rows.items() if value not in (None, "", [], {})}
    if isinstance(part, tuple):
        return [_document(row) for row in part]
    return part


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
        document[key] = _toml(value)
    return tomlkit.dumps(document)


def _toml(value: Any) -> Any:
    """Turn plain tables into TOML's: a quantity stays on its line, rows become arrays of tables."""
    import tomlkit

    if isinstance(value, dict):
        made: Any = tomlkit.inline_table() if "provenance" in value else tomlkit.table()
        for key, entry in value.items():
            made[key] = _toml(entry)
        return made
    if isinstance(value, list):
        rows = tomlkit.aot()
        for entry in value:
            rows.append(_toml(entry))
        return rows
    return value


__all__ = [
    "PUBLISHED_QUANTITIES",
    "Case",
    "Provenance",
    "Value",
    "bundled_cases",
    "document_of",
    "dump_case",
    "load_case",
    "parse_case",
]
