"""What the keys of JSON documents mean, as the classes of results declare it, held against printed documents."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, PLACES, Declaration
from strikewave.base.result import BandContent, DocumentHead, Result

HERE = Path(__file__).parent
FEWEST_KEYS = 3
"""Keys from which a class that several documents hold has a table of its own."""


class Command(NamedTuple):
    """Commands whose documents are described together.

    Attributes
    ----------
    title : str
        Its heading.
    kind : type
        The declared class of their documents.
    lines : list of str
        What is typed.
    """

    title: str
    kind: type
    lines: list[str]


class Key(NamedTuple):
    """A line of a table: path (``[]`` is each row of a list, ``*`` any name), unit, meaning, class of its own table."""

    path: str
    unit: str
    meaning: str
    leads_to: type | None = None


def commands_of(text: str) -> list[Command]:
    """Return the commands of a text: ``title: module.Class``, and below it indented what is typed."""
    found: list[Command] = []
    for line in text.splitlines():
        if line.startswith(" "):
            found[-1].lines.append(line.strip())
        elif line.strip():
            title, _, path = line.partition(": ")
            module, _, name = path.rpartition(".")
            found.append(Command(title, getattr(import_module(module), name), []))
    return found


def parts_of(kind: type) -> Iterator[tuple[Declaration, type]]:
    """Yield declaration and class of each part that a document of a class holds, of rows and named parts too."""
    for one in declare.declarations(kind).values():
        if one.of is not None and one.in_document:
            yield one, one.of


def described_with(kind: type) -> list[type]:
    """Return the classes whose keys stand together in the documents of a result."""
    return [kind, BandContent] if issubclass(kind, Result) and kind.may_have_bands else [kind]


def shared_classes(commands: list[Command]) -> list[type]:
    """Return the classes that have a table of their own: documents hold them in several places."""
    places: Counter[type] = Counter()
    seen: set[type] = set()

    def walk(kind: type) -> None:
        for one, of in parts_of(kind):
            places[of] += 0 if one.inline and one.kind == "part" else 1
            if of not in seen:
                seen.add(of)
                walk(of)

    for kind in [DocumentHead, *(each for command in commands for each in described_with(command.kind))]:
        walk(kind)
    return [kind for kind, count in places.items() if count > 1 and len(declare.declarations(kind)) >= FEWEST_KEYS]


def keys_of(kind: type, shared: list[type]) -> list[Key]:
    """Return the lines of the table of a class."""
    apart = [one for one in shared if one is not kind]
    return [
        Key(f"{path}{PLACES[one.kind] if one.of and not one.inline else ''}", _unit(one), one.meaning, one.of)
        for path, one in declare.keys(kind, apart=apart)
        if one.of is None or one.of in apart
    ]


def _unit(one: Declaration) -> str:
    return (one.quantity.si if one.quantity.si != NO_UNIT else "") or one.quantity.given_by


def heading_of(kind: type) -> str:
    """Return the heading of the table of a class: what it is, in the first words of its docstring."""
    return re.split(r"[:;.]", inspect.getdoc(kind) or kind.__name__)[0]


def unknown_keys(kinds: list[type], value: Any) -> list[str]:
    """Return the keys of a document, or a part of one, that no class declares."""
    known = {path: one for kind in kinds for path, one in declare.keys(kind)}
    return sorted(set(_unknown(known, value, "")))


def _unknown(known: Mapping[str, Declaration], value: Any, path: str) -> Iterator[str]:
    """Yield the paths of what is not declared; a dictionary or a list declared as a whole is described by that."""
    if path and path in known and known[path].of is None:
        return
    if isinstance(value, Mapping):
        for key, inner in value.items():
            below = [f"{path}.{one}" if path else one for one in (key, "*")]
            yield from _unknown(known, inner, next((one for one in below if _describes(known, one)), below[0]))
    elif isinstance(value, list):
        for inner in value:
            yield from _unknown(known, inner, f"{path}[]")
    elif path and not _describes(known, path):
        yield path


def _describes(known: Mapping[str, Declaration], path: str) -> bool:
    return path in known or any(one.startswith((f"{path}.", f"{path}[]")) for one in known)


def check_documents(commands: list[Command]) -> dict[str, dict[str, Any]]:
    """Run the commands, and return their documents by what is typed.

    Raises
    ------
    ValueError
        If a document has a key that is not declared.
    """
    documents = _documents([line for command in commands for line in command.lines])
    for command in commands:
        kinds = [DocumentHead, *described_with(command.kind)]
        for line in command.lines:
            if alone := unknown_keys(kinds, documents[line]):
                raise ValueError(f"strikewave {line}: no meaning of {', '.join(alone)} in {command.kind.__name__}")
    return documents


def _documents(lines: list[str]) -> dict[str, dict[str, Any]]:
    """Return the document that each line prints; one process runs them all."""
    words = [sys.executable, str(HERE / "json_documents.py")]
    ran = subprocess.run(words, input="\n".join(lines), capture_output=True, text=True, check=False)
    if ran.returncode:
        raise RuntimeError(f"the documents of docs/json.md could not be made:\n{ran.stderr}")
    found: dict[str, dict[str, Any]] = json.loads(ran.stdout)
    return found
