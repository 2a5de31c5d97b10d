"""What the keys of JSON documents mean: those of `json_keys.toml`, held against documents that commands print.

A document with a key that has no meaning is refused, and so is a meaning that no document has a key for.
"""

import inspect
import json
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base import declare

HERE = Path(__file__).parent
MEANINGS = HERE / "json_keys.toml"
OF_EACH = ("schema", "version", "units", "warnings")
"""Keys of every document, which one table describes for all."""
LEADS_TO = "= "
"""What begins a meaning that is a shared table."""
NO_UNIT = "1"


@dataclass
class KeyTable:
    """What one table says, and what was seen of it.

    Attributes
    ----------
    title : str
        Its heading.
    meanings : dict
        Meaning by path.
    lines : list of str
        Commands whose documents it describes; none of a shared one.
    optional : set of str
        Paths whose meaning is that of a class, which may have more than the documents.
    seen : dict
        Unit by path.
    """

    title: str
    meanings: dict[str, str]
    lines: list[str] = field(default_factory=list)
    optional: set[str] = field(default_factory=set)
    seen: dict[str, str] = field(default_factory=dict)


class KeyTables(NamedTuple):
    """Tables of commands, and those that several of them share, by name."""

    commands: list[KeyTable]
    shared: dict[str, KeyTable]


def key_tables() -> KeyTables:
    """Run the commands, and return the tables with what was seen.

    Raises
    ------
    ValueError
        If keys and meanings differ.
    """
    stated = tomllib.loads(MEANINGS.read_text("utf-8"))
    tables_of = {_named(one["class"]): name for name, one in stated["shared"].items() if "class" in one}
    shared = {name: _shared(one, tables_of) for name, one in stated.pop("shared").items()}
    commands = [_of_command(name, one, tables_of) for name, one in stated.items()]
    documents = _documents([line for one in commands for line in one.lines])
    for known in commands:
        for document in (documents[line] for line in known.lines):
            units = document["units"]
            _look(shared["head"], {key: document[key] for key in OF_EACH}, units, shared)
            _look(known, {key: value for key, value in document.items() if key not in OF_EACH}, units, shared)
    tables = [*commands, *shared.values()]
    idle = [f"{one.title}: {path}" for one in tables for path in set(one.meanings) - set(one.seen) - one.optional]
    if idle:
        raise ValueError(f"{MEANINGS.name}: no document has " + "; ".join(sorted(idle)))
    return KeyTables(commands, shared)


def _of_command(name: str, stated: dict[str, Any], tables_of: Mapping[type, str]) -> KeyTable:
    """Return the table of a command, with what the class of its result declares."""
    lines, kind = stated.pop("lines"), stated.pop("class", "")
    found = dict(_of_declared(_named(kind), tables_of)) if kind else {}
    return KeyTable(name, {**found, **stated}, lines, optional=set(found) - set(stated))


def _of_declared(kind: type, tables_of: Mapping[type, str]) -> Iterator[tuple[str, str]]:
    """Yield path and meaning of each key that a class declares; what has a table of its own is left to that."""
    for path, one in declare.keys(kind, apart=tables_of):
        if one.of in tables_of:
            yield path + ("" if one.inline else declare.PLACES[one.kind]), f"{LEADS_TO}{tables_of[one.of]}"
        elif one.of is None:
            yield path, one.meaning


def _shared(stated: dict[str, Any], tables_of: Mapping[type, str]) -> KeyTable:
    """Return a table that several share, with what classes say of their fields; its own words stand over these."""
    if "class" in stated:
        others = {kind: name for kind, name in tables_of.items() if kind is not _named(stated["class"])}
        declared = dict(_of_declared(_named(stated.pop("class")), others))
        return KeyTable(stated.pop("heading"), {**declared, **stated}, optional=set(declared) - set(stated))
    found = {key: text for path in stated.pop("classes", ()) for key, text in _of_class(_named(path)).items()}
    found = {key: text for key, text in found.items() if not any(one.startswith(f"{key}[]") for one in stated)}
    return KeyTable(stated.pop("heading"), {**found, **stated}, optional=set(found) - set(stated))


def _named(path: str) -> Any:
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


def _of_class(kind: type) -> dict[str, str]:
    """Return the meaning of each attribute that the docstring of a class describes; NaN and None are null in JSON."""
    found = {}
    for names, lines in _attributes(inspect.getdoc(kind) or ""):
        text = " ".join(lines).replace("`", "").replace("NaN", "null").replace("None", "null").rstrip(".")
        found |= {name: text[:1].lower() + text[1:] if text[1:2].islower() else text for name in names.split(", ")}
    return found


def _attributes(docstring: str) -> Iterator[tuple[str, list[str]]]:
    """Yield names and description of each entry below Attributes."""
    entry: tuple[str, list[str]] | None = None
    for line in docstring.partition("\nAttributes\n")[2].splitlines()[1:]:
        if entry is not None and line.startswith(" "):
            entry[1].append(line.strip())
        elif line.strip():
            if entry is not None:
                yield entry
            entry = line.partition(" : ")[0], []
    if entry is not None:
        yield entry


def _documents(lines: list[str]) -> dict[str, dict[str, Any]]:
    """Return the document that each line prints; one process runs them all."""
    words = [sys.executable, str(HERE / "json_documents.py")]
    ran = subprocess.run(words, input="\n".join(lines), capture_output=True, text=True, check=False)
    if ran.returncode:
        raise RuntimeError(f"the documents of docs/json.md could not be made:\n{ran.stderr}")
    found: dict[str, dict[str, Any]] = json.loads(ran.stdout)
    return found


def _look(
    known: KeyTable,
    value: Any,
    units: Mapping[str, str],
    shared: Mapping[str, KeyTable],
    path: str = "",
    above: str = "",
) -> None:
    """Note the keys of a part of a document that a table describes, with units; ``above`` is where the table is."""
    meaning = known.meanings.get(path)
    if meaning is not None:
        name = meaning.removeprefix(LEADS_TO)
        known.seen.setdefault(path, _unit(path, above, units, value) if name == meaning else "")
        for inner in [] if name == meaning or value is None else value if isinstance(value, list) else [value]:
            _look(shared[name], inner, units, shared, above=path)
    elif isinstance(value, Mapping) and value:
        for key, inner in value.items():
            _look(known, inner, units, shared, _below(known, path, key), above)
    elif isinstance(value, list) and value and _describes(known, f"{path}[]"):
        for inner in value:
            _look(known, inner, units, shared, f"{path}[]", above)
    elif value or not _describes(known, path):
        raise ValueError(f"{MEANINGS.name}: no meaning of {path!r} in [{known.title}]")
    elif value is not None:  # nothing stands there, but the key does
        empty = f"{path}.*" if isinstance(value, Mapping) else f"{path}[]"
        if known.meanings.get(empty, "").startswith(LEADS_TO):
            known.seen.setdefault(empty, "")


def _unit(path: str, above: str, units: Mapping[str, str], value: Any) -> str:
    """Return the unit that a document states of a path: by its last two names, its last, or of what it is part of."""
    names = path.replace("[]", "").split(".")
    of = (above.replace("[]", "").split(".") + names)[-2]
    parts = reversed(names[:-1]) if isinstance(value, float) else ()
    found = next((units[one] for one in (f"{of}.{names[-1]}", names[-1], *parts) if one in units), NO_UNIT)
    return "" if found == NO_UNIT else found


def _describes(known: KeyTable, path: str) -> bool:
    """Tell whether a table describes a path, or something below it."""
    return any(one == path or one.startswith((f"{path}.", f"{path}[]")) for one in known.meanings)


def _below(known: KeyTable, path: str, key: str) -> str:
    """Return the path of a key: by its name, or of any name where the table says so."""
    named, any_name = (f"{path}.{one}" if path else one for one in (key, "*"))
    return named if _describes(known, named) or not _describes(known, any_name) else any_name
