"""A case as a file has it: plain tables, TOML that reads back to the same case, and its fields in words."""

from __future__ import annotations

import functools
import textwrap
import tomllib
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from typing import Any, NamedTuple

from pydantic import BaseModel

from strikewave.base.quantities import Value
from strikewave.cases.case import SCHEMA, Case, FitTable
from strikewave.cases.tables.stack import StackTable

Comments = Callable[[str, Any], Sequence[str]]
"""What is said above a key of a file: its path and what stands there in, lines out."""

VECTOR = frozenset("xyz")
"""The keys of a vector."""


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


WIDTH = 118
"""Characters of a line of comment, without its mark."""


class Explained(NamedTuple):
    """A field in words: what it is, how one gets it on a real machine, why a case takes what it takes."""

    what: str
    how: str
    why: str


@functools.cache
def explanations(kind: str = "") -> dict[str, Explained]:
    """Return the words on every field by its path without names of rows, such as ``stack.layer.length``.

    ``kind`` is that of a machine, in which some fields mean something of their own.

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
    """Return the comment above a field of a case file: nothing above a table, or where a file says it itself.

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
