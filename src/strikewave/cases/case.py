"""The case: everything a run needs, read from a TOML file with units, checked, and written as one again.

A quantity is "number unit", or a table { value, provenance, note }. `load_case` reads a file or one
of the built-in cases; `dump_case` writes one that gives the same numbers again.
"""

from __future__ import annotations

import functools
import math
import re
import textwrap
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationInfo,
    field_validator,
    model_validator,
)

from strikewave.base import declare
from strikewave.base.declare import KEY
from strikewave.base.documents import read_toml
from strikewave.base.errors import MISSING, InputError, InputErrors, nearest, show
from strikewave.base.quantities import Range, ToleranceBand, Value
from strikewave.base.result import INFO, Comparison, Notice
from strikewave.base.texts import first_few
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.paths import SAME, Form, entries_of, quantities_of, row_name, with_provenance, with_quantities
from strikewave.cases.tables.common import CaseTable, PerformedTest, Published, Solver, case_name, read_published
from strikewave.cases.tables.contact import ContactTable
from strikewave.cases.tables.fem import FemTable, FilePart, MeshTable
from strikewave.cases.tables.machine import (
    AnyObject,
    AnyStriker,
    FeedTable,
    LaunchedTable,
    Object,
    RotaryTable,
    StrikerTable,
)
from strikewave.cases.tables.machine_kinds import AnyMachine
from strikewave.cases.tables.stack import LoadTable, RecorderTable, SensorTable, StackTable, TapTable

T = TypeVar("T", LoadTable, FilePart)
SCHEMA = 1  # version of case files: it rises when a field changes its meaning or goes
LONGEST_REASON = 120  # characters of a message of the TOML reader: a line of a terminal
TABLES = (
    *("machine", "striker", "feed", "object", "contact", "stack", "load", "tap", "sensor", "recorder", "solver"),
    *("mesh", "fem"),
)
"""The tables of a case that hold quantities, in the order in which they are written."""
ROTARY_TABLES = ("machine", "striker", "feed", "object", "contact", "recorder")
"""The tables that a rotary machine needs; a machine without a drive has no feed."""
STRICT: dict[str, type[CaseTable]] = {"striker": StrikerTable, "object": Object}
"""Tables of which a rotary machine needs all that one without a drive may leave out."""
LOOSE: dict[str, type[CaseTable]] = {"striker": AnyStriker, "object": AnyObject}
"""The same tables of a machine without a drive."""
RENAMED = {"youngs_modulus": "modulus"}
"""Older names of fields of a solid, `[mesh.part.solid]`, with today's: a file that has one is read, with a notice."""
DIFFERS = "the case differs in"
"""Begin of the note of a published number that belongs to another case."""


class StrikeTables(NamedTuple):
    """The tables that every machine case has: striker, object, contact and recorder."""

    striker: AnyStriker
    object: AnyObject
    contact: ContactTable
    recorder: RecorderTable


class RotaryTables(NamedTuple):
    """The tables of a rotary machine, none of which is missing."""

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
    >>> load_case("jesd22-b111-b")  # doctest: +ELLIPSIS
    <Case jesd22-b111-b: JESD22-B111 ... masses assumed; machine, striker, object, contact, recorder, solver, published>
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
    _older_names: tuple[str, ...] = PrivateAttr(())

    def _tables(self) -> list[str]:
        """Return the names of the tables that the case states, in the order of their fields."""
        return [name for name in document_of(self) if name not in ("schema", "name", "title", "source", "compare")]

    def _tables_and_changes(self) -> str:
        """Return the tables that the case states, and the fields in which it differs from its built-in source."""
        changed = self.changed_fields()
        differs = f"; differs from {self.source} in {first_few(changed, LISTED)}" if changed else ""
        return (", ".join(self._tables()) or "nothing stated") + differs

    def __repr__(self) -> str:
        title = f": {self.title}" if self.title else ""
        return f"<Case {self.name or 'without a name'}{title}; {self._tables_and_changes()}>"

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the title, and the case as TOML, folded."""
        head, tables = escape(self.title or self.name or "case"), escape(self._tables_and_changes())
        return f"<details><summary><b>{head}</b> ({tables})</summary><pre>{escape(dump_case(self))}</pre></details>"

    @field_validator("striker", "object", mode="before")
    @classmethod
    def _strict(cls, raw: Any, info: ValidationInfo) -> Any:
        """Ask for every quantity, but in a machine without a drive.

        Where the machine itself is refused its kind is unknown: a key that only a rotary machine has then decides.
        """
        if not isinstance(raw, Mapping) or info.field_name is None:
            return raw
        strict, loose = STRICT[info.field_name], LOOSE[info.field_name]
        rotary = isinstance(info.data.get("machine"), RotaryTable | None)
        if "machine" not in info.data:
            rotary = bool(raw.keys() & strict.model_fields.keys() - loose.model_fields.keys())
        return strict.model_validate(raw) if rotary else raw

    @model_validator(mode="after")
    def _whole(self) -> Case:
        """Refuse a case without a whole machine, bar or mesh, and tables that do not apply."""
        self._check_what_runs()
        if self.command == "fem" and self.solver != Solver():
            raise InputError("solver", "[solver]", "none: a mesh alone is run by the controls of [fem]", "remove it")
        if self.feed is not None and not self._may_be_fed():
            raise InputError("feed", "[feed]", "none: nothing is fed in a machine without a drive", "remove it")
        for place, fit in enumerate(self.fit):
            check_fit(fit, FORM, f"fit.{place}")
        return self

    def _check_what_runs(self) -> None:
        """Refuse a case in which neither a machine, nor a bar, nor a mesh is there with all its tables."""
        stated = [name for name in ROTARY_TABLES if getattr(self, name) is not None]
        lacking = [name for name in ("mesh", "fem") if getattr(self, name) is None]
        if len(lacking) == 1:
            examples = {"mesh": "[[mesh.part]], once for each part", "fem": '[fem] with its duration = "80 us"'}
            raise InputError(lacking[0], MISSING, examples[lacking[0]])
        if not stated and not self.stack.layer and lacking:
            needed_tables = "[machine] with its tables, [[stack.layer]] with [load], or [mesh] with [fem]"
            raise InputError("case", MISSING, needed_tables)
        if self.machine is not None or not (self.stack.layer or (not stated and not lacking)):
            missing = [name for name in ROTARY_TABLES if name not in stated and (name != "feed" or self._may_be_fed())]
            if missing:
                raise InputErrors([f"{name}: missing; add [{name}]" for name in missing])

    def _may_be_fed(self) -> bool:
        """Tell whether the machine has a drive, or is not there yet."""
        return isinstance(self.machine, RotaryTable | None)

    @property
    def command(self) -> str:
        """Command that runs it: "run" a machine, "wave" a bar alone, "fem" a mesh alone."""
        if self.machine is not None:
            return "run"
        return "fem" if self.fem is not None and not self.stack.layer else "wave"

    @property
    def time_zero(self) -> str:
        """Zero of the time of its results, in words."""
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
        """Return the tables of a rotary machine."""
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
            values.update(quantities_of(getattr(self, name), name))
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
        values, entries, stale = self.values(), self.entries(), list[StaleFit]()
        for fit in self.fit:
            changed = tuple(changed_since(fit, entries, values, FORM))
            for path in fit.fields if changed else ():
                if path in values and values[path].provenance == "fitted":
                    stale.append(StaleFit(path, fit.to, changed))
        return stale

    def with_stale_fits_assumed(self) -> Case:
        """Return the case with values assumed whose fit no longer applies."""
        stale, values = self.stale_fits(), self.values()
        assumed = {"provenance": "assumed"}
        return self.with_values(
            {fit.field: values[fit.field].model_copy(update={**assumed, "note": fit.since}) for fit in stale}
        )

    def compared(self) -> list[Published]:
        """Return the published numbers that its results are compared with.

        A changed case shows those of the built-in case that it comes from only by ``compare = true``; numbers that it
        adds to them are its own.
        """
        if self.compare is False:
            return []
        changed = self.changed_fields()
        theirs = _published_in(self.source)
        listed = self.published or (theirs if self.compare else ())
        if not changed:
            return list(listed)
        shown = {"role": "shown", "note": f"{DIFFERS} {', '.join(changed)}"}
        own = [entry for entry in listed if self.compare or entry not in theirs]
        return [entry.model_copy(update=shown) if entry in theirs else entry for entry in own]

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
            entries.update(entries_of(getattr(self, name), name))
        return entries

    def with_values(self, changes: Mapping[str, Value], keep_tolerances: bool = True) -> Case:
        """Return the case with some quantities replaced, by path; a value keeps the tolerance of the one before it."""
        mine, new = self.values(), dict[str, Value]()
        for path, value in changes.items():
            if path not in mine:
                raise InputError(path, value.typed, "a quantity of the case", nearest(path, mine))
            new[path] = _with_band(path, value, mine[path].tolerance) if keep_tolerances else value
        return with_quantities(self, new)


FORM = Form(Case, "case", 'machine.speed="500 rpm"')
"""A case file."""


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


def _published_in(name: str) -> tuple[Published, ...]:
    """Return the published numbers of a built-in case; none where it is no built-in one."""
    return _built_in(name).published if name in bundled_cases() else ()


@functools.cache
def _built_in_entries(name: str) -> dict[str, float | str]:
    """Return quantities and choices of a built-in case."""
    return _built_in(name).entries()


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
    case = _parse(text, re.sub(r"[^\w.+-]+", "-", stem).strip("-.+") or "case", changes, name in bundled_cases(), name)
    return _with_whole_path(case, Path(name))


def _with_whole_path(case: Case, place: Path) -> Case:
    """Return a case whose files of load and mesh have absolute paths: beside the case, or in the working folder."""
    folder = place if place.is_dir() else place.parent
    if case.load is not None and case.load.file:
        case = case.model_copy(update={"load": _with_whole_file(case.load, folder)})
    if case.mesh is not None:
        parts = tuple(_with_whole_file(x, folder) if isinstance(x, FilePart) else x for x in case.mesh.part)
        case = case.model_copy(update={"mesh": case.mesh.model_copy(update={"part": parts})})
    return case


def _with_whole_file(table: T, folder: Path) -> T:
    """Return a table whose ``file`` has its absolute path, where there is such a file."""
    if "\0" in table.file:
        return table
    beside = folder / table.file
    path = beside if beside.is_file() else Path(table.file)
    return table.model_copy(update={"file": str(path.resolve())}) if path.is_file() else table


def own_case(case: Case, name: str, origin: str) -> Case:
    """Return a case of one's own that begins from another, without the published numbers of the built-in one."""
    source = origin if origin in bundled_cases() else case.source
    theirs = _published_in(source)
    own = tuple(entry for entry in case.published if entry not in theirs)
    update = {"name": name, "title": f"{name}, from {origin}", "source": source, "published": own, "compare": None}
    return case.model_copy(update=update)


def parse_case(text: str, name: str = "", changes: Iterable[str] = ()) -> Case:
    """Check the TOML text of a case of one's own; see `load_case`.

    What was typed or changed in it is the user's: see `strikewave.cases.paths`.
    """
    return _parse(text, name, changes)


def _parse(text: str, name: str, changes: Iterable[str], built_in: bool = False, place: str = "") -> Case:
    """Check the TOML text of a case, whose values have their provenance in a built-in one; ``place`` names its file."""
    try:
        document = read_toml(text)
    except ValueError as error:
        reason = show(str(error), LONGEST_REASON).strip('"')
        raise InputErrors([f"{place or name or 'case'}: not a TOML file: {reason}"]) from None
    _check_schema(document)
    older_names = _with_names_of_today(document)
    for change in changes:
        FORM.change(document, _with_name_of_today(change))
    document.setdefault("name", name)
    case = FORM.read(document)
    case._older_names = older_names
    if built_in:
        return case
    return with_provenance(case, document, _built_in(case.source) if case.source in bundled_cases() else None)


OLDER_PATH = re.compile(rf"^(\s*mesh\.part\.[^.=]+\.solid\.)({'|'.join(RENAMED)})(?=[.=\s]|$)")
"""Path of a field of a solid by an older name, also at the begin of a change."""


def _with_names_of_today(document: Mapping[str, Any]) -> tuple[str, ...]:
    """Give the solids of a case file the names that their fields have today, and return the paths that were older."""
    mesh, fits, older = document.get("mesh"), document.get("fit"), list[str]()
    parts = mesh.get("part") if isinstance(mesh, dict) else None
    for place, part in enumerate(parts if isinstance(parts, list) else ()):
        solid = part.get("solid") if isinstance(part, dict) else None
        for before, now in RENAMED.items():
            if isinstance(solid, dict) and before in solid and now not in solid:  # a solid with both names is refused
                solid[now] = solid.pop(before)
                older.append(f"mesh.part.{row_name(part, place)}.solid.{before}")
    for fit in fits if isinstance(fits, list) else ():
        for key in {"fields", "under", "standard_error"} & fit.keys() if isinstance(fit, dict) else ():
            rows = fit[key]
            if isinstance(rows, list):
                fit[key] = [_with_name_of_today(str(path)) for path in rows]
            elif isinstance(rows, dict):
                fit[key] = {_with_name_of_today(path): row for path, row in rows.items()}
    return tuple(older)


def _with_name_of_today(path: str) -> str:
    """Return a path, or a change of one, with the name that its field has today."""
    return OLDER_PATH.sub(lambda older: older[1] + RENAMED[older[2]], path)


def _check_schema(document: Mapping[str, Any]) -> None:
    schema = document.get("schema")
    if schema is None:
        raise InputError("schema", MISSING, f"schema = {SCHEMA}", f"begin the case file with schema = {SCHEMA}")
    if isinstance(schema, bool) or not isinstance(schema, int) or schema < 1:
        raise InputError("schema", schema, f"schema = {SCHEMA}")
    if schema > SCHEMA:
        hint = "this file was written for a newer strikewave; update it"
        raise InputError("schema", schema, f"at most {SCHEMA}", hint)


NONE = "none"
"""Value of a field, or a table, that the case did not have when it was fitted."""


class FitTable(CaseTable):
    """[[fit]]: the ``fields`` fitted ``to`` something, and the values of fields ``under`` which the fit holds.

    Among the fields of ``under`` are the fitted ones; "none" stands for a field or table that was left out. Where one
    differs, the fit no longer applies. ``standard_error`` holds that of each field that the data fix, and
    ``correlation`` a row for each of them; ``records`` the SHA-256 of the files by their names.
    """

    fields: tuple[str, ...] = Field(min_length=1)
    to: str = ""
    under: dict[str, str | int | float] = Field(min_length=1)
    standard_error: dict[str, str | int | float] = Field(default_factory=dict)
    correlation: tuple[tuple[float, ...], ...] = ()
    records: dict[str, str] = Field(default_factory=dict)


class ChangedField(NamedTuple):
    """A field that has changed since a fit: its path, its value then and its value now, as typed."""

    path: str
    then: str
    now: str


@declare.dataclass
class StaleFit:
    """A value whose fit no longer applies, the target of the fit, and the fields that changed since."""

    field: str = declare.word("path of the fitted value", column=KEY)
    to: str
    changed: tuple[ChangedField, ...]

    @declare.computed(declare.word("paths of the fields under which it was fitted and that differ now", key="changed"))
    def changed_paths(self) -> list[str]:
        """Paths of the changed fields."""
        return [change.path for change in self.changed]

    @property
    def since(self) -> str:
        """Reason why it no longer applies, in words."""
        listed = ", ".join(f"{path} ({now}, then {then})" for path, then, now in self.changed)
        return f"fit no longer applies: {listed} changed"


def check_fit(fit: FitTable, form: Form, path: str) -> None:
    """Refuse a fit that names an unknown field, or gives a field a value that it cannot have."""
    for name in fit.fields:
        if form.range_at(name.split(".")) is None:
            raise InputError(f"{path}.fields", name, f"a quantity of the {form.name}", _like(name, form))
    for name, size in fit.standard_error.items():
        if name not in fit.fields:
            raise InputError(f"{path}.standard_error", name, "one of its fields", nearest(name, fit.fields))
        allowed = form.range_at(name.split("."))
        try:
            Range("" if allowed is None else allowed.unit, 0.0, open_low=True).read(size)
        except InputError as wrong:
            raise wrong.at(f"{path}.standard_error.{name}") from None
    rows, count = fit.correlation, len(fit.standard_error)
    if rows and not ({len(rows), *map(len, rows)} == {count} and _is_correlation(rows)):
        words = f"{count} rows of {count} numbers from -1 to 1, those of a correlation of the standard errors"
        raise InputError(f"{path}.correlation", str(rows), words)
    for name, then in fit.under.items():
        *places, key = name.split(".")
        if key not in form.keys_at(places):
            raise InputError(f"{path}.under", name, f"a field of the {form.name}", _like(name, form))
        allowed = form.range_at([*places, key])
        if allowed is not None and then != NONE:
            try:
                allowed.read(then)
            except InputError as error:
                raise error.at(f"{path}.under.{name}") from None


def _is_correlation(rows: tuple[tuple[float, ...], ...]) -> bool:
    """Tell whether rows are those of a correlation: ones on the diagonal, symmetric, of no negative variance."""
    import numpy as np

    matrix = np.array(rows)
    alike = np.allclose(matrix, matrix.T, atol=1e-6) and np.allclose(np.diag(matrix), 1.0, atol=1e-6)
    return bool(alike and np.all(np.abs(matrix) <= 1.0 + 1e-9) and np.linalg.eigvalsh(matrix)[0] > -1e-6)


def _like(name: str, form: Form) -> str:
    *places, key = name.split(".")
    return nearest(key, form.keys_at(places))


def changed_since(
    fit: FitTable, entries: Mapping[str, float | str], values: Mapping[str, Value], form: Form
) -> Iterator[ChangedField]:
    """Yield the fields that have changed since a checked fit, by the quantities and choices of the case now."""
    for path, then in fit.under.items():
        now = entries.get(path)
        if then == NONE and now is None:
            if any(entry.startswith(f"{path}.") for entry in entries):
                yield ChangedField(path, NONE, "given")
        elif now is None or not _same(now, then, path, form):
            typed = str(values[path].typed) if path in values else NONE if now is None else str(now)
            yield ChangedField(path, str(then), typed)


def _same(now: float | str, then: str | float, path: str, form: Form) -> bool:
    """Tell whether an entry, in SI or a choice, equals the text typed then."""
    if isinstance(now, str):
        return now == then
    allowed = form.range_at(path.split("."))
    read = None if allowed is None or then == NONE else allowed.read(then)
    return isinstance(read, Value) and math.isclose(read.si, now, rel_tol=SAME)


LISTED = 3  # fields that a notice names: more would not fit a line, and the report names all


def comparisons(case: Case, computed: Callable[[Published], float | None]) -> tuple[Comparison, ...]:
    """Compare the published numbers of a case with the computed ones."""
    rows = []
    for entry in case.compared():
        value = computed(entry)
        rows.append(
            Comparison(
                quantity=entry.quantity,
                published=entry.value.si,
                measured_or_simulated=entry.origin,
                computed=value,
                difference=None if value is None else value / entry.value.si - 1.0,
                role=entry.role,
                note=entry.note,
                sensor=entry.sensor,
            )
        )
    return tuple(rows)


def origin_notices(case: Case) -> Iterator[Notice]:
    """Report older names of fields, and the published numbers and fits of its source that no longer hold."""
    for path in case._older_names:
        now = RENAMED[path.rpartition(".")[2]]
        message = f"{path} is called {now} now, and is read as that: write {now} in the case file"
        yield Notice("field-renamed", message, severity=INFO)
    changed, compared = case.changed_fields(), case.compared()
    listed = f"it differs in {first_few(changed, LISTED)}"
    if len(compared) < len(case.published) and case.compare is None:
        message = f"not compared with the published numbers of {case.source}: {listed}; compare = true shows them"
        yield Notice("not-compared", message, float(len(changed)), 0.0, severity=INFO)
    elif changed and any(entry.role == "shown" and entry.note.startswith(DIFFERS) for entry in compared):
        message = f"the published numbers belong to the case {case.source}: {listed}"
        yield Notice("changed-case", message, float(len(changed)), 0.0, severity=INFO)
    stale = case.stale_fits()
    if stale:
        paths = list(dict.fromkeys([change.path for fit in stale for change in fit.changed]))
        fields = ", ".join([fit.field for fit in stale])
        message = (
            f"the fit of {fields} no longer applies: it was made under another {first_few(paths, LISTED)}; fit again, "
            "with records of both to have it for both, or take them as assumed"
        )
        yield Notice("fit-stale", message, float(len(paths)), 0.0)


Comments = Callable[[str, Any], Sequence[str]]
"""Comment lines above a key of a file, from its path and its value."""

VECTOR = frozenset("xyz")
"""The keys of a vector."""


def document_of(case: Case) -> dict[str, Any]:
    """Return a case as the plain tables of a case file."""
    head = {"schema": SCHEMA, "name": case.name, "title": case.title, "source": case.source}
    document: dict[str, Any] = {key: value for key, value in head.items() if value}
    if case.compare is not None:
        document["compare"] = case.compare
    document["test"] = case.test.stated()
    for table in case.tables():
        document[table] = _document(getattr(case, table))
    document["fit"] = [_fit_document(fit) for fit in case.fit]
    document["published"] = [
        {key: value.typed if isinstance(value, Value) else value for key, value in entry if value != ""}
        for entry in case.published
    ]
    return {key: value for key, value in document.items() if value not in (None, {}, [])}


def _fit_document(fit: FitTable) -> dict[str, Any]:
    """Return [[fit]] as plain tables, without those that are empty."""
    tables = {
        "fields": list(fit.fields),
        "to": fit.to,
        "correlation": list(map(list, fit.correlation)),
        "under": dict(fit.under),
        "standard_error": dict(fit.standard_error),
        "records": dict(fit.records),
    }
    return {key: table for key, table in tables.items() if table or key == "to"}


def _document(part: Any) -> Any:
    """Return a part of a case as plain tables, without empty entries."""
    if isinstance(part, Value):
        return part.document()
    if isinstance(part, BaseModel):
        if isinstance(part, StackTable) and not part.layer:
            return {}
        rows = [(key, _document(value)) for key, value in part if value is not None]
        return {key: value for key, value in rows if value not in ("", [], {})}
    if isinstance(part, tuple):
        return [_document(row) for row in part]
    return part


def dump_case(case: Case, comments: Comments | None = None) -> str:
    """Write a case as TOML that reads back to the same numbers and provenance.

    Parameters
    ----------
    case : Case
        Case to be written.
    comments : callable, optional
        Returns the lines of comment above a key from its path, without names of rows, and its value.

    Returns
    -------
    str
        The case as TOML, which `load_case` reads again as the same case.

    Examples
    --------
    >>> from strikewave.cases.case import load_case, parse_case
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
    if isinstance(value, list):
        rows = tomlkit.aot() if _has_head(value) else []
        for entry in value:
            rows.append(_toml(entry, path, comments))
        return rows
    return value


def _has_head(value: Any) -> bool:
    """Tell whether a part of a file is a table, or rows of one, with a head of its own; other parts stand before it."""
    if isinstance(value, dict):
        return not ("provenance" in value or value.keys() <= VECTOR)
    return isinstance(value, list) and all(isinstance(row, dict) and "provenance" not in row for row in value)


WIDTH = 118  # characters of a line of comment without its mark: a line of 120


class Explained(NamedTuple):
    """A field in words: its meaning, the way to find it on a real machine, and the reason of the value of a case."""

    what: str
    how: str
    why: str


@functools.cache
def explanations(kind: str = "") -> dict[str, Explained]:
    """Return the explanation of every field by its path without names of rows, such as ``stack.layer.length``.

    ``kind`` is that of a machine, in which some fields have another meaning.

    Examples
    --------
    >>> explanations()["striker.mass"].how
    'weigh it'
    >>> explanations("drop")["striker.mass"].what
    'base of the machine, on which the pad lies and the carriage falls'
    """
    tables = tomllib.loads((resources.files("strikewave.cases") / "explained.toml").read_text("utf-8"))
    of_kinds = tables.pop("machine_kind")
    return {**dict(_fields(tables, "")), **dict(_fields(of_kinds.get(kind, {}), ""))}


def _fields(table: dict[str, Any], path: str) -> list[tuple[str, Explained]]:
    rows: list[tuple[str, Explained]] = []
    for key, entry in table.items():
        below = f"{path}.{key}" if path else key
        rows += _fields(entry, below) if isinstance(entry, dict) else [(below, Explained(*entry))]
    return rows


def comment_lines(path: str, entry: Any, kind: str = "") -> list[str]:
    """Return the comment above a field of a case file; nothing above a table.

    ``kind`` is that of the machine of the file; see `explanations`.

    Examples
    --------
    >>> comment_lines("striker.mass", {"value": "1 kg", "provenance": "user"})[0][:60]
    'moving mass of a striker, or of the anvil where the object f'
    """
    words = explanations(kind).get(path)
    if words is None:
        return []
    noted = isinstance(entry, dict) and not str(entry.get("note", "tolerance")).startswith("tolerance")
    text = f"{words.what}. How to get it: {words.how}." + ("" if noted else f" Taken here: {words.why}.")
    return textwrap.wrap(text, WIDTH)
