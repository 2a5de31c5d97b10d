"""The fields of a file by their paths: their ranges, changes, faults, and the provenance of their values.

A path names tables and a key, such as ``machine.speed``; a row of an array of tables goes by its name or its place.
Where a table may be one of several, its ``kind`` (``shape``, ``law``) tells which; it stands in pydantic's paths, not
in ours.

A built-in case states the provenance of every value. In a file of one's own, typed or changed values are the user's; a
file with a built-in ``source`` is compared with it: provenance or note of a value there is not true of another value.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, Protocol, TypeVar, cast, get_args, get_origin, runtime_checkable

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from strikewave.base.errors import InputError, InputErrors, nearest, show
from strikewave.base.quantities import Range, Value
from strikewave.base.units import DIMENSIONS, take_apart

Held = TypeVar("Held", bound=BaseModel)
"""Type of the contents of a file."""

NAMING = ("name", "after", "number")
"""Keys that name a row of an array of tables."""
_OF_TOLERANCE = ("tolerance", "distribution")
"""Keys of a quantity that a change of its value keeps."""
NOTHING = "none"
"""Value by which a change removes a quantity."""


def row_name(row: Any, place: int) -> str:
    """Return the name of a row of an array of tables in a path: its name, the row before it, its number or place."""
    get = row.get if isinstance(row, Mapping) else (lambda key, default: getattr(row, key, default))
    number = get("number", "")
    number = number.get("value", "") if isinstance(number, Mapping) else number
    return str(get("name", "") or get("after", "") or getattr(number, "typed", number) or place)


def _name_in(rows: Sequence[Any], place: int, inner: Sequence[str | int]) -> str:
    """Return the name of a row in a path where it is unique and not itself the fault; else its place."""
    names = [row_name(row, k) if isinstance(row, Mapping) else str(k) for k, row in enumerate(rows)]
    name = names[place]
    is_wrong = bool(inner) and inner[0] in NAMING
    return name if re.fullmatch(r"[\w +-]+", name) and names.count(name) == 1 and not is_wrong else str(place)


def _shown(place: str | int) -> str:
    """Return a place of pydantic's path as a line has it."""
    return show(str(place)).strip('"')


@runtime_checkable
class Reader(Protocol):
    """A rule that reads a number of a file as a value, and gives an example of one."""

    def read(self, raw: Any) -> Any:
        """Return the value."""
        ...

    def example(self) -> str:
        """Return a number as a file has it."""
        ...


@dataclass(frozen=True)
class Form(Generic[Held]):
    """The form of a file: its model, its name in an error line, and an example of a change for it."""

    model: type[Held]
    name: str
    example: str

    def change(self, document: dict[str, Any], change: str) -> None:
        """Set ``path=value`` in a document; a bare number is SI; a changed quantity is marked as the user's.

        It keeps its tolerance, which ``path.tolerance=value`` changes; a value of 0 has no relative one.
        ``path=none`` takes a quantity out.

        Examples
        --------
        >>> from strikewave.cases.tables.machine import RotaryTable
        >>> document = {}
        >>> Form(RotaryTable, "machine", 'radius="1 m"').change(document, "radius=0.2")
        >>> document["radius"]["value"]
        '0.2 m'
        """
        path, equals, text = (part.strip() for part in change.partition("="))
        if not equals or not path or not text:
            raise InputError("--set", change, f"path=value, such as {self.example}")
        if len(text) > 2 and text[0] == text[-1] and text[0] in "\"'":
            text = text[1:-1]
        *tables, key = path.split(".")
        place = self._table_in(document, tables, change)
        if not isinstance(place, dict):
            raise InputError("--set " + path, change, f"a table of the {self.name}")
        typed: Any = _number(text)
        allowed = self.range_at([*self._with_kinds(document, tables), key])
        if allowed is None:
            is_text = isinstance(place.get(key), str) or self._takes_text([*tables, key])
            place[key] = text if is_text else typed
            return
        if text == NOTHING:
            place.pop(key, None)
            return
        if allowed.unit in DIMENSIONS and not isinstance(typed, str):
            typed = f"{text} {allowed.unit}"
        before = place.get(key)
        tolerance = {name: before[name] for name in _OF_TOLERANCE if name in before} if isinstance(before, dict) else {}
        if "%" in str(tolerance.get("tolerance")) and _is_zero(allowed, typed):
            tolerance = {}
        place[key] = {"value": typed, "provenance": "user", **tolerance}

    def _table_in(self, document: dict[str, Any], tables: list[str], change: str) -> Any:
        """Return the table of a document at a path, made where it is not there."""
        place: Any = document
        for depth, table in enumerate(tables):
            inner: Any = None
            if isinstance(place, dict):
                inner = place.setdefault(table, {})
                if not isinstance(inner, dict | list) and self.range_at(tables[: depth + 1]) is not None:
                    inner = place[table] = {"value": inner}
            elif isinstance(place, list):
                inner = next((row for k, row in enumerate(place) if table in (row_name(row, k), str(k))), None)
            if not isinstance(inner, dict | list) or (isinstance(inner, list) and depth == len(tables) - 1):
                path = ".".join(tables[: depth + 1])
                allowed, hint = f"a table of the {self.name}", _row_hint(place, inner, path, change)
                raise InputError(f"--set {path}", change, allowed, hint)
            place = inner
        return place

    def read(self, document: Mapping[str, Any], before: str = "") -> Held:
        """Return a document as the model of the file, or raise a line for each fault, after ``before``."""
        try:
            return self.model.model_validate(document)
        except ValidationError as error:
            raise InputErrors(before + line for line in self.lines(error, document)) from None

    def lines(self, error: ValidationError, document: Mapping[str, Any]) -> list[str]:
        """Return pydantic's report as one line a fault: field, value, allowed values, advice."""
        lines: list[str] = []
        for fault in error.errors():
            path = ".".join(self._called(fault["loc"], document))
            cause = fault.get("ctx", {}).get("error")
            if isinstance(cause, InputErrors):
                lines += cause.lines
            elif isinstance(cause, InputError):
                inner = ".".join(part for part in (path, cause.field) if part)
                lines.append(str(InputError(inner, cause.got, cause.allowed, cause.hint)))
            else:
                lines.append(self._line(fault, path))
        return lines

    def _line(self, fault: ErrorDetails, path: str) -> str:
        """Return the line of a fault that pydantic found by itself."""
        kind, got, places = fault["type"], fault["input"], [_shown(part) for part in fault["loc"]]
        if kind == "extra_forbidden":
            others = self._kinds_with(places)
            meant = f"it is a key of {', '.join(others)}, and this is {places[-2]}" if others else ""
            return f"{path}: unknown key; {meant or nearest(places[-1], self.keys_at(places[:-1]))}"
        if kind == "missing":
            return f"{path}: missing; {self._example(places)}"
        if kind == "tuple_type" and self.tables_at(places) == [Value]:
            return f"{path}: got {show(got)}; allowed: a list of quantities with their units"
        if kind == "tuple_type" and not isinstance(got, dict):
            return f'{path}: got {show(got)}; allowed: a list, such as ["a", "b"]'
        if kind == "tuple_type":
            return f"{path}: got one table; write [[{path}]], once for each"
        if kind == "literal_error":
            return str(InputError(path, got, str(fault.get("ctx", {}).get("expected", ""))))
        return f"{path or self.name}: got {show(got)}; {fault['msg']}"

    def _kinds_with(self, places: list[str]) -> list[str]:
        """Return the other kinds of a table that have a key which is unknown in it."""
        siblings = self.tables_at(places[:-2])
        if len(places) < 3 or places[-2] not in map(_kind_of, siblings):
            return []
        return [_kind_of(model) for model in siblings if places[-1] in _keys_of(model)]

    def tables_at(self, places: list[str]) -> list[type[BaseModel]]:
        """Return the models of the table at a path; a name or number stands for the row of an array of tables."""
        models: list[type[BaseModel]] = [self.model]
        in_rows = False
        for place in places:
            if in_rows:
                in_rows = False
                continue
            chosen = [model for model in models if _kind_of(model) == place] if len(models) > 1 else []
            if chosen:
                models = chosen
                continue
            inner: dict[type[BaseModel], None] = {}
            for model in models:
                if place in model.model_fields:
                    tables, rows = _tables_of(model.model_fields[place].annotation)
                    inner.update(dict.fromkeys(tables))
                    in_rows = in_rows or rows
            models = list(inner)
        return models

    def table_at(self, places: list[str]) -> type[BaseModel] | None:
        """Return the model of the table at a path, the first where it may be one of several."""
        return next(iter(self.tables_at(places)), None)

    def keys_at(self, places: list[str]) -> list[str]:
        """Return the keys of the table at a path; none where there is no table."""
        return [key for model in self.tables_at(places) for key in _keys_of(model)]

    def range_at(self, places: list[str]) -> Range | None:
        """Return the range of the quantity at a path; None where there is no quantity."""
        for reader in self._readers_at(places):
            if isinstance(reader, Range):
                return reader
        return None

    def _readers_at(self, places: list[str]) -> list[Reader]:
        """Return the readers of the number at a path; none where there is no number."""
        readers = []
        for field in self._fields_at(places):
            owners = [getattr(getattr(rule, "func", None), "__self__", None) for rule in field.metadata]
            readers += [owner for owner in owners if isinstance(owner, Reader)]
        return readers

    def _fields_at(self, places: list[str]) -> list[FieldInfo]:
        tables = self.tables_at(places[:-1])
        return [model.model_fields[places[-1]] for model in tables if places[-1] in model.model_fields]

    def _called(self, places: Sequence[str | int], document: Mapping[str, Any]) -> list[str]:
        """Return the places of a fault as in paths: rows by their names, without the kinds of tables."""
        called: list[str] = []
        part: Any = document
        for depth, place in enumerate(places):
            shown = [_shown(part_of_path) for part_of_path in places[: depth + 1]]
            if depth and len(several := self.tables_at(shown[:-1])) > 1 and shown[-1] in map(_kind_of, several):
                continue
            if isinstance(place, int) and isinstance(part, list | tuple) and place < len(part):
                called.append(_name_in(part, place, places[depth + 1 :]))
                part = part[place]
            else:
                called.append(shown[-1])
                part = part.get(place) if isinstance(part, Mapping) else None
        return called

    def _with_kinds(self, document: Mapping[str, Any], tables: list[str]) -> list[str]:
        """Return the tables of a path, each of several followed by the kind that a document says it is."""
        places: list[str] = []
        part: Any = document
        for table in tables:
            places.append(table)
            part = part.get(table) if isinstance(part, Mapping) else None
            if isinstance(part, Mapping) and "kind" in part and len(self.tables_at(places)) > 1:
                places.append(str(part["kind"]))
        return places

    def _takes_text(self, places: list[str]) -> bool:
        return any(str in (field.annotation, *get_args(field.annotation)) for field in self._fields_at(places))

    def _example(self, places: list[str]) -> str:
        """Return the advice on a missing entry: a number with its unit, a table, a text."""
        for reader in self._readers_at(places):
            if isinstance(reader, Range) and reader.unit not in DIMENSIONS:
                return f"add {places[-1]}, {reader.allowed()}"
            return f"add {places[-1]} = {reader.example()}"
        is_table = self.tables_at(places) not in ([], [Value])
        kinds = [field.annotation for field in self._fields_at(places) if get_origin(field.annotation) is Literal]
        choices = [str(choice) for kind in kinds for choice in get_args(kind) if choice]
        if choices:
            return f"add {places[-1]}, one of {', '.join(dict.fromkeys(choices))}"
        text = ' = "..."' if self._takes_text(places) else ""
        return f"add [{'.'.join(places)}]" if is_table else f"add {places[-1]}{text}"


def _keys_of(model: type[BaseModel]) -> list[str]:
    return [field.alias or key for key, field in model.model_fields.items()]


def _row_hint(place: Any, inner: Any, path: str, change: str) -> str:
    """Return the rows of an array of tables, where a change names none of them."""
    rows = inner if isinstance(inner, list) else place
    names = [row_name(row, k) for k, row in enumerate(rows)] if isinstance(rows, list) else []
    if not names:
        return ""
    if rows is inner:
        return f"name its row: {path}.{names[0]}{change.strip().removeprefix(path)}"
    return nearest(path.rpartition(".")[2], names)


def _is_zero(allowed: Range, typed: Any) -> bool:
    """Tell whether a typed value is valid and 0."""
    try:
        return allowed.read(typed).si == 0.0
    except InputError:
        return False


def _number(text: str) -> int | float | str:
    """Return a number where a text is one, else the text."""
    typed = take_apart(text)
    if typed is None or typed.unit:
        return text
    return int(typed.number) if typed.number.lstrip("+-").isdecimal() else typed.value


def _tables_of(kind: Any) -> tuple[list[type[BaseModel]], bool]:
    """Return the tables that an annotation may hold, with their stricter forms, and whether it holds rows of them."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind, *kind.__subclasses__()], False
    tables, in_rows = list[type[BaseModel]](), False
    for part in get_args(kind):
        inner, rows = _tables_of(part)
        tables += inner
        in_rows = in_rows or rows or (get_origin(kind) is tuple and bool(inner))
    return tables, in_rows


def _kind_of(table: type[BaseModel]) -> str:
    """Return the kind (shape, law) of a table; empty where it has none."""
    for key in ("kind", "shape", "law"):
        kinds = get_args(table.model_fields[key].annotation) if key in table.model_fields else ()
        if len(kinds) == 1:
            return str(kinds[0])
    return ""


T = TypeVar("T")


def quantities_of(part: Any, path: str) -> Iterator[tuple[str, Value]]:
    """Yield every quantity below a part of a case with its path."""
    for place, leaf in _leaves(part, path):
        if isinstance(leaf, Value):
            yield place, leaf


def entries_of(part: Any, path: str) -> Iterator[tuple[str, float | str]]:
    """Yield every quantity, in SI, and every word below a part of a case with its path."""
    for place, leaf in _leaves(part, path):
        if isinstance(leaf, Value):
            yield place, leaf.si
        elif isinstance(leaf, str) and leaf:
            yield place, leaf


def _leaves(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield the entries of a part of a case below its tables and rows, each with its path."""
    if isinstance(part, BaseModel) and not isinstance(part, Value):
        for key, value in part:
            yield from _leaves(value, f"{path}.{key}")
    elif isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _leaves(row, f"{path}.{row_name(row, place)}")
    else:
        yield path, part


def with_quantities(part: T, values: Mapping[str, Value]) -> T:
    """Return a part of a case with quantities at paths below it, also where none is stated; none is checked.

    Examples
    --------
    >>> from strikewave import load_case
    >>> dense = Value(si=8e3, typed="8000 kg/m^3")
    >>> changed = with_quantities(load_case("li-ma-2019-fig13"), {"stack.layer.nose.density": dense})
    >>> changed.stack.layer[0].density.si
    8000.0
    """
    tree = dict[str, Any]()
    for path, value in values.items():
        *places, key = path.split(".")
        branch = tree
        for place in places:
            branch = branch.setdefault(place, {})
        branch[key] = value
    return cast(T, _with_tree(part, tree))


def _with_tree(part: Any, tree: Value | dict[str, Any]) -> Any:
    """Return a part of a case with some quantities replaced, which stand in a tree of the keys of their paths."""
    if isinstance(tree, Value):
        return tree
    if isinstance(part, tuple):
        names = [row_name(row, place) for place, row in enumerate(part)]
        return tuple(
            _with_tree(row, tree[name]) if name in tree else row for name, row in zip(names, part, strict=True)
        )
    return part.model_copy(update={key: _with_tree(getattr(part, key), branch) for key, branch in tree.items()})


SAME = 1e-12  # relative difference of values that are the same: another unit may cost a few bits


def with_provenance(part: T, raw: Any, origin: Any = None) -> T:
    """Return a validated part of a case with the true provenance of its values.

    - A value typed without a provenance is the user's; where it equals that of the source, it has the provenance there.
    - A value that differs from the source is the user's, without the note of the source, unless the file gives it
      another provenance or note than the source does.

    ``raw`` are the values in the file, ``origin`` is the same part of the built-in case named as source; rows are found
    by name, else by place.

    Examples
    --------
    >>> from strikewave.cases.tables.stack import RecorderTable
    >>> text = {"sampling_rate": "200 kHz", "delay": "0 s", "pre_trigger": "10 ms", "memory": 40000}
    >>> with_provenance(RecorderTable.model_validate(text), text).memory.provenance
    'user'
    """
    new: Any = part
    if isinstance(part, Value):
        new = _of_value(part, raw, origin)
    elif isinstance(part, BaseModel) and isinstance(raw, Mapping):
        fields = type(part).model_fields
        update = {}
        for key, entry in part:
            name = fields[key].alias or key
            changed = with_provenance(entry, raw[name], getattr(origin, key, None)) if name in raw else entry
            if changed is not entry:
                update[key] = changed
        new = part.model_copy(update=update) if update else part
    elif isinstance(part, tuple) and isinstance(raw, list) and len(raw) == len(part):
        rows = tuple(map(with_provenance, part, raw, _partners(part, origin)))
        new = part if all(a is b for a, b in zip(rows, part, strict=True)) else rows
    return new


def _of_value(value: Value, raw: Any, origin: Any) -> Value:
    known = isinstance(origin, Value)
    same = known and math.isclose(value.si, origin.si, rel_tol=SAME)
    if not (isinstance(raw, Mapping) and "provenance" in raw):
        return value.model_copy(update={"provenance": origin.provenance if same else "user"})
    if known and not same and (value.provenance, value.note) == (origin.provenance, origin.note):
        return value.model_copy(update={"provenance": "user", "note": ""})
    return value


def _partners(rows: tuple[Any, ...], origin: Any) -> list[Any]:
    """Return the row of the source for each row of an array: by its name, else that at its place if it is free."""
    theirs = {row_name(row, place): row for place, row in enumerate(origin)} if isinstance(origin, tuple) else {}
    names = [row_name(row, place) for place, row in enumerate(rows)]
    places = dict(enumerate(theirs))
    free = {place: theirs[name] for place, name in places.items() if name not in names}
    return [theirs.get(name, free.get(place)) for place, name in enumerate(names)]
