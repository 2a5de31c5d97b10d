"""The case: everything a run needs, read from a TOML file with units and checked.

A quantity is "number unit", or a table { value, provenance, note }. `load_case` reads a file or one
of the built-in cases; `dump_case` writes a case that gives the same numbers again.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from strikewave.base.errors import EXISTING_FILE, MISSING, InputError, InputErrors, nearest, show
from strikewave.base.quantities import Provenance, ToleranceBand, Value
from strikewave.base.toml_text import read_toml
from strikewave.cases.fem_tables import FemTable
from strikewave.cases.fits import FitTable, StaleFit, changed_since, check_fit
from strikewave.cases.machine_tables import AnyMachine
from strikewave.cases.mesh_tables import FilePart, MeshTable
from strikewave.cases.paths import Form, row_name
from strikewave.cases.performed_test import PerformedTest
from strikewave.cases.provenance import with_provenance
from strikewave.cases.tables import (
    PUBLISHED_QUANTITIES,
    AnyObject,
    AnyStriker,
    CaseTable,
    ContactTable,
    FeedTable,
    LaunchedTable,
    LoadTable,
    Object,
    Published,
    RecorderTable,
    RotaryTable,
    SensorTable,
    Solver,
    StackTable,
    StrikerTable,
    TapTable,
    case_name,
    read_published,
)

T = TypeVar("T", LoadTable, FilePart)
Comments = Callable[[str, Any], Sequence[str]]
"""What is said above a key of a file: its path and what stands there in, lines out."""

SCHEMA = 1
"""Version of case files: it rises when a field changes its meaning or goes."""
LARGEST_FILE = 1_000_000
"""A case file above this many bytes is refused: a hundred times the largest built-in case, so that it is no case
file."""
LONGEST_REASON = 120
"""Characters of what the TOML reader says: a line of a terminal."""
TABLES = (
    *("machine", "striker", "feed", "object", "contact", "stack", "load", "tap", "sensor", "recorder", "solver"),
    *("mesh", "fem"),
)
"""The tables of a case that hold quantities, in the order in which they are written."""
ROTARY_TABLES = ("machine", "striker", "feed", "object", "contact", "recorder")
"""The tables that a rotary machine needs; a machine without a drive has no feed."""
VECTOR = frozenset("xyz")
"""The keys of a vector."""
STRICT: dict[str, type[CaseTable]] = {"striker": StrikerTable, "object": Object}
"""Tables of which a rotary machine needs all that one without a drive may leave out."""
LOOSE: dict[str, type[CaseTable]] = {"striker": AnyStriker, "object": AnyObject}
"""The same tables of a machine without a drive."""
DIFFERS = "the case differs in"
"""Begin of the note of a published number that belongs to another case."""


class StrikeTables(NamedTuple):
    """The tables that every machine case has: what meets, how, and what records it."""

    striker: AnyStriker
    object: AnyObject
    contact: ContactTable
    recorder: RecorderTable


class RotaryTables(NamedTuple):
    """The tables of a rotary machine, all of them there."""

    machine: RotaryTable
    striker: StrikerTable
    feed: FeedTable
    object: Object
    contact: ContactTable
    recorder: RecorderTable


class Case(CaseTable):
    """A case as read: frozen, every quantity in SI with its provenance.

    Its tables are attributes, as the file has them: ``case.machine.speed.si`` is a number, beside ``typed``,
    ``provenance``, ``note`` and ``tolerance``. `load_case` makes one, `with_values` another with other values.

    Examples
    --------
    >>> speed = load_case("li-ma-2019").machine.speed
    >>> speed.typed, round(speed.si, 3), speed.provenance
    ('730 rpm', 76.445, 'published')
    """

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True, defer_build=True)

    schema_version: Literal[1] = Field(alias="schema")
    name: Annotated[str, BeforeValidator(case_name)] = ""
    title: str = ""
    source: str = ""
    compare: bool | None = None
    test: PerformedTest = PerformedTest()
    machine: AnyMachine | None = None
    striker: AnyStriker | None = None
    feed: FeedTable | None = None
    object: AnyObject | None = None
    contact: ContactTable | None = None
    stack: StackTable = StackTable()
    load: LoadTable | None = None
    tap: tuple[TapTable, ...] = ()
    sensor: tuple[SensorTable, ...] = ()
    recorder: RecorderTable | None = None
    solver: Solver = Solver()
    mesh: MeshTable | None = None
    fem: FemTable | None = None
    fit: tuple[FitTable, ...] = ()
    published: tuple[Annotated[Published, BeforeValidator(read_published)], ...] = ()

    @field_validator("striker", "object", mode="before")
    @classmethod
    def _strict(cls, raw: Any, info: ValidationInfo) -> Any:
        """Ask for every quantity, but in a machine without a drive.

        Of a machine that is itself refused the kind is not known: there a key that only a rotary machine has tells.
        """
        if not isinstance(raw, Mapping) or info.field_name is None:
            return raw
        strict, loose = STRICT[info.field_name], LOOSE[info.field_name]
        rotary = isinstance(info.data.get("machine"), RotaryTable | None)
        if "machine" not in info.data:
            rotary = any(key in strict.model_fields and key not in loose.model_fields for key in raw)
        return strict.model_validate(raw) if rotary else raw

    @model_validator(mode="after")
    def _whole(self) -> Case:
        """Refuse a case without anything to run, and a machine without one of its tables."""
        needed = [name for name in ROTARY_TABLES if name != "feed" or isinstance(self.machine, RotaryTable | None)]
        lacking = [name for name in ("mesh", "fem") if getattr(self, name) is None]
        if len(lacking) == 1:
            examples = {"mesh": "[[mesh.part]], once for each part", "fem": '[fem] with its duration = "80 us"'}
            raise InputError(lacking[0], MISSING, examples[lacking[0]])
        alone = not any(getattr(self, name) is not None for name in ROTARY_TABLES)
        if alone and not self.stack.layer and lacking:
            needed_tables = "[machine] with its tables, [[stack.layer]] with [load], or [mesh] with [fem]"
            raise InputError("case", MISSING, needed_tables)
        if self.machine is not None or not (self.stack.layer or (alone and not lacking)):
            lines = [f"{name}: missing; add [{name}]" for name in needed if getattr(self, name) is None]
            if lines:
                raise InputErrors(lines)
        if self.command == "fem" and self.solver != Solver():
            raise InputError("solver", "[solver]", "none: a mesh alone is run by the controls of [fem]", "remove it")
        if "feed" not in needed and self.feed is not None:
            raise InputError("feed", "[feed]", "none: nothing is fed in a machine without a drive", "remove it")
        for place, fit in enumerate(self.fit):
            check_fit(fit, FORM, f"fit.{place}")
        return self

    @property
    def command(self) -> str:
        """The command that runs it: "run" a machine, "wave" a bar alone, "fem" a mesh alone."""
        if self.machine is not None:
            return "run"
        return "fem" if self.fem is not None and not self.stack.layer else "wave"

    @property
    def time_zero(self) -> str:
        """What the time of its results counts from, in words."""
        return "the start" if self.launched() else "the valve signal"

    def impact(self) -> StrikeTables:
        """Return the tables that every machine case has.

        Raises
        ------
        InputError
            If the case is that of a bar alone.
        """
        parts = self.striker, self.object, self.contact, self.recorder
        if self.machine is None or None in parts:
            what = "a mesh" if self.command == "fem" else "a bar"
            hint = f"this case is {what} alone: `strikewave {self.command}` runs it"
            raise InputError("machine", MISSING, "[machine] with its tables", hint)
        return StrikeTables(*parts)  # type: ignore[arg-type]

    def rotary_tables(self) -> RotaryTables:
        """Return the tables of a rotary machine.

        Raises
        ------
        InputError
            If the case is that of a bar alone, or of another machine.
        """
        striker, struck, contact, recorder = self.impact()
        if not (
            isinstance(self.machine, RotaryTable)
            and isinstance(striker, StrikerTable)
            and isinstance(struck, Object)
            and self.feed is not None
        ):
            kind = getattr(self.machine, "kind", MISSING)
            raise InputError("machine.kind", kind, "rotary", "this needs a rotary machine, such as case li-ma-2019")
        return RotaryTables(self.machine, striker, self.feed, struck, contact, recorder)

    def launched(self) -> LaunchedTable | None:
        """Return the machine if it is one without a drive."""
        return self.machine if isinstance(self.machine, LaunchedTable) else None

    def values(self) -> dict[str, Value]:
        """Return every quantity by its path, such as ``machine.speed`` or ``stack.layer.upper.length``."""
        values: dict[str, Value] = {}
        for name in self.tables():
            values.update(_values(getattr(self, name), name))
        return values

    def tables(self) -> list[str]:
        """Return the names of the tables that hold quantities of this case; a mesh alone has no solver."""
        return [name for name in TABLES if (name, self.command) != ("solver", "fem")]

    def fitted_fields(self) -> list[str]:
        """Return the paths of the fitted values."""
        return [path for path, value in self.values().items() if value.provenance == "fitted"]

    def stale_fits(self) -> list[StaleFit]:
        """Return the fitted values whose fit no longer applies: a field that they were fitted under has changed."""
        if not self.fit:
            return []
        values, entries, stale = self.values(), self.entries(), []
        for fit in self.fit:
            changed = tuple(changed_since(fit, entries, values, FORM))
            stale += [
                StaleFit(path, fit.to, changed)
                for path in fit.fields
                if changed and path in values and values[path].provenance == "fitted"
            ]
        return stale

    def with_stale_fits_assumed(self) -> Case:
        """Return the case as what is known of it today: a value whose fit no longer applies is assumed."""
        values = self.values()
        assumed: dict[str, Value] = {
            one.field: values[one.field].model_copy(update={"provenance": "assumed", "note": one.since})
            for one in self.stale_fits()
        }
        return self.with_values(assumed)

    def compared(self) -> list[Published]:
        """Return the published numbers that its results are compared with.

        Those of the built-in case that a changed case comes from are no longer its own: they are shown only where it
        asks for that by ``compare = true``. What it adds to them is its own.
        """
        if self.compare is False:
            return []
        changed = self.changed_fields()
        theirs = _built_in(self.source).published if self.source in bundled_cases() else ()
        listed = self.published or (theirs if self.compare else ())
        if not changed:
            return list(listed)
        shown = {"role": "shown", "note": f"{DIFFERS} {', '.join(changed)}"}
        return [
            entry.model_copy(update=shown) if entry in theirs else entry
            for entry in listed
            if self.compare or entry not in theirs
        ]

    def changed_fields(self) -> list[str]:
        """Return the paths whose values or choices differ from the built-in case that this one comes from.

        The solver does not count, nor the recorder where no sensor feels it, nor how many blows and pictures a mesh is
        followed over: they change no published result.
        """
        if self.source not in bundled_cases():
            return []
        aside = ("solver",) if self.sensor else ("solver", "recorder")
        origin, mine = _built_in_entries(self.source), self.entries()
        changed = [path for path, value in mine.items() if path not in origin or value != origin[path]]
        gone = [path for path in origin if path not in mine]
        return [p for p in changed + gone if p.partition(".")[0] not in aside and p not in ("fem.blows", "fem.frames")]

    def entries(self) -> dict[str, float | str]:
        """Return every quantity (SI) and every choice, such as a material, by its path."""
        entries: dict[str, float | str] = {}
        for name in self.tables():
            entries.update(_entries(getattr(self, name), name))
        return entries

    def with_values(self, changes: Mapping[str, Value], keep_tolerances: bool = True) -> Case:
        """Return the case with some quantities replaced, by path; a value keeps the tolerance of the one before it.

        Raises
        ------
        InputError
            If there is no such quantity, or the tolerance does not suit the new value.
        """
        mine, tree = self.values(), dict[str, Any]()
        for path, value in changes.items():
            if path not in mine:
                raise InputError(path, value.typed, "a quantity of the case", nearest(path, mine))
            new = _with_band(path, value, mine[path].tolerance) if keep_tolerances else value
            *places, key = path.split(".")
            branch = tree
            for place in places:
                branch = branch.setdefault(place, {})
            branch[key] = new
        changed: Case = _with_tree(self, tree)
        return changed


FORM = Form(Case, "case", 'machine.speed="500 rpm"')
"""A case file."""


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


def _with_band(path: str, value: Value, band: ToleranceBand | None) -> Value:
    """Return a value with a tolerance, unless it has its own; checked as a case file that holds both would be.

    A share of nothing is nothing: a value of 0 goes without.
    """
    allowed = FORM.range_at(path.split("."))
    if band is None or value.tolerance is not None or allowed is None or (band.relative and value.si == 0.0):
        return value
    toleranced = value.model_copy(update={"tolerance": band})
    try:
        allowed.read(toleranced.document())
    except InputError as error:
        raise error.at(f"{path}.{error.field}".rstrip(".")) from None
    return toleranced


@functools.cache
def _built_in(name: str) -> Case:
    """Return a built-in case; it is read once."""
    return load_case(name)


@functools.cache
def _built_in_entries(name: str) -> dict[str, float | str]:
    """Return quantities and choices of a built-in case."""
    return _built_in(name).entries()


def bundled_cases() -> list[str]:
    """Return the names of the built-in cases.

    Examples
    --------
    >>> "li-ma-2019" in bundled_cases()
    True
    """
    folder = resources.files("strikewave.cases") / "published"
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def read_case_text(name: str) -> tuple[str, str]:
    """Return the TOML text and the name of a case file, or of a built-in case.

    Raises
    ------
    InputError
        If there is neither, or the file is too large or not text.
    """
    if name in bundled_cases():
        return (resources.files("strikewave.cases") / "published" / f"{name}.toml").read_text("utf-8"), name
    path = Path(name)
    try:
        if path.is_dir() and (path / "case.toml").is_file():
            path = path / "case.toml"
        if not path.is_file():
            allowed = EXISTING_FILE if name.endswith(".toml") else "a case file or a built-in case"
            raise InputError("case", name, allowed, nearest(name, bundled_cases()))
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("case", name, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError("case", name, f"a case file of at most {LARGEST_FILE // 1000} kB")
    try:
        return data.decode("utf-8-sig"), path.stem
    except UnicodeDecodeError:
        raise InputError("case", name, "a text file in UTF-8") from None


def load_case(name: str, changes: Iterable[str] = ()) -> Case:
    """Read a case file or a built-in case, change some of its fields, and check it.

    Parameters
    ----------
    name : str
        Path of a TOML file, of a folder that holds ``case.toml``, or the name of a built-in case.
    changes : iterable of str, optional
        ``path=value`` each, such as ``machine.speed=500 rpm``.

    Returns
    -------
    Case
        The checked case, with its provenance; quantities keep the text they were typed in.

    Raises
    ------
    InputError
        With one line for each thing that is wrong.

    Examples
    --------
    >>> case = load_case("li-ma-2019", ["machine.speed=500 rpm"])
    >>> round(case.machine.speed.si, 4)
    52.3599
    """
    text, stem = read_case_text(name)
    case = _parse(text, re.sub(r"[^\w.+-]+", "-", stem).strip("-.+") or "case", changes, name in bundled_cases())
    return _with_whole_path(case, Path(name))


def _with_whole_path(case: Case, place: Path) -> Case:
    """Return a case whose files of load and mesh have their whole path: beside the case, or else from where we work."""
    folder = place if place.is_dir() else place.parent
    if case.load is not None and case.load.file:
        case = case.model_copy(update={"load": _with_whole_file(case.load, folder)})
    if case.mesh is not None:
        parts = tuple(_with_whole_file(x, folder) if isinstance(x, FilePart) else x for x in case.mesh.part)
        case = case.model_copy(update={"mesh": case.mesh.model_copy(update={"part": parts})})
    return case


def _with_whole_file(table: T, folder: Path) -> T:
    """Return a table whose ``file`` has its whole path, where there is such a file."""
    if "\0" in table.file:
        return table
    beside = folder / table.file
    path = beside if beside.is_file() else Path(table.file)
    return table.model_copy(update={"file": str(path.resolve())}) if path.is_file() else table


def own_case(case: Case, name: str, origin: str) -> Case:
    """Return a case of one's own that begins from another: it names the built-in one, whose numbers are not its own."""
    source = origin if origin in bundled_cases() else case.source
    theirs = _built_in(source).published if source in bundled_cases() else ()
    own = tuple(entry for entry in case.published if entry not in theirs)
    update = {"name": name, "title": f"{name}, from {origin}", "source": source, "published": own, "compare": None}
    return case.model_copy(update=update)


def parse_case(text: str, name: str = "", changes: Iterable[str] = ()) -> Case:
    """Check the TOML text of a case of one's own; see `load_case`.

    What was typed or changed in it is the user's: see `strikewave.cases.provenance`.
    """
    return _parse(text, name, changes)


def _parse(text: str, name: str, changes: Iterable[str], built_in: bool = False) -> Case:
    """Check the TOML text of a case; a built-in one says of every value itself where it comes from."""
    try:
        document = read_toml(text)
    except ValueError as error:
        reason = show(str(error), LONGEST_REASON).strip('"')
        hint = "values with a unit stand in quotes; `strikewave new` writes an example"
        raise InputErrors([f"{name or 'case'}: not a TOML file: {reason}; {hint}"]) from None
    _check_schema(document)
    for change in changes:
        FORM.change(document, change)
    document.setdefault("name", name)
    try:
        case = Case.model_validate(document)
    except ValidationError as error:
        raise InputErrors(FORM.lines(error)) from None
    if built_in:
        return case
    return with_provenance(case, document, _built_in(case.source) if case.source in bundled_cases() else None)


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


def document_of(case: Case) -> dict[str, Any]:
    """Return a case as the plain tables of a case file."""
    head = {"schema": SCHEMA, "name": case.name, "title": case.title, "source": case.source}
    document: dict[str, Any] = {key: value for key, value in head.items() if value}
    if case.compare is not None:
        document["compare"] = case.compare
    if case.test.stated():
        document["test"] = case.test.stated()
    for table in case.tables():
        rows = _document(getattr(case, table))
        if rows:
            document[table] = rows
    published = [
        {key: value.typed if isinstance(value, Value) else value for key, value in entry if value != ""}
        for entry in case.published
    ]
    fits = [_fit_document(fit) for fit in case.fit]
    return document | ({"fit": fits} if fits else {}) | ({"published": published} if published else {})


def _fit_document(fit: FitTable) -> dict[str, Any]:
    """Return [[fit]] as plain tables, without what is absent."""
    rows = {"correlation": [list(row) for row in fit.correlation]} if fit.correlation else {}
    tables: dict[str, Mapping[str, Any]] = {"standard_error": fit.standard_error, "records": fit.records}
    return {
        "fields": list(fit.fields),
        "to": fit.to,
        **rows,
        "under": dict(fit.under),
        **{key: dict(table) for key, table in tables.items() if table},
    }


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


def dump_case(case: Case, comments: Comments | None = None) -> str:
    """Write a case as TOML that reads back to the same numbers and provenance.

    Parameters
    ----------
    case : Case
        What is written.
    comments : callable, optional
        Returns the lines of comment above a key from its path, without names of rows, and from what stands there.

    Returns
    -------
    str
        The case as TOML, which `load_case` reads again as the same case.

    Examples
    --------
    >>> case = load_case("li-ma-2019")
    >>> parse_case(dump_case(case)) == case
    True
    """
    import tomlkit

    document = tomlkit.document()
    for key, value in document_of(case).items():
        document[key] = _toml(value, key, comments)
    return tomlkit.dumps(document)


def _toml(value: Any, path: str, comments: Comments | None) -> Any:
    """Turn plain tables into TOML's: a quantity or a vector stays on its line, rows become arrays of tables."""
    import tomlkit

    if isinstance(value, dict):
        flat = not _has_head(value)
        table: Any = tomlkit.inline_table() if flat else tomlkit.table()
        for key, entry in sorted(value.items(), key=lambda item: _has_head(item[1])):
            for line in comments(f"{path}.{key}", entry) if comments and not flat else ():
                table.add(tomlkit.comment(line))
            table[key] = _toml(entry, f"{path}.{key}", comments)
        return table
    if isinstance(value, list) and not _is_rows(value):
        return [_toml(entry, path, comments) for entry in value]
    if isinstance(value, list):
        rows = tomlkit.aot()
        for entry in value:
            rows.append(_toml(entry, path, comments))
        return rows
    return value


def _has_head(value: Any) -> bool:
    """Tell whether a part of a file has a head of its own: what has none stands before it."""
    if isinstance(value, dict):
        return not ("provenance" in value or value.keys() <= VECTOR)
    return isinstance(value, list) and _is_rows(value)


def _is_rows(values: list[Any]) -> bool:
    """Tell whether a list holds rows of an array of tables, not quantities."""
    return all(isinstance(entry, dict) and "provenance" not in entry for entry in values)


__all__ = [
    "PUBLISHED_QUANTITIES",
    "Case",
    "Provenance",
    "Value",
    "bundled_cases",
    "document_of",
    "dump_case",
    "load_case",
    "own_case",
    "parse_case",
]
