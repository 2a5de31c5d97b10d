"""The set-up file: read, changed, checked, written back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel

from strikewave.base.errors import MISSING, InputError, InputErrors, show
from strikewave.base.quantities import Value
from strikewave.base.toml_text import read_toml
from strikewave.cases.paths import Form
from strikewave.cases.provenance import with_provenance
from strikewave.cases.tables.base import CaseTable
from strikewave.cases.tables.hopkinson import HopkinsonSetup
from strikewave.cases.tables.performed_test import PerformedTest

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
