"""The set-up file: read, changed, checked, written back."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError

from strikewave.errors import MISSING, InputError, InputErrors, nearest, show
from strikewave.quantities import Range, Value
from strikewave.split_bar.tables import SplitBarSetup
from strikewave.units import DIMENSIONS

LARGEST_FILE = 1_000_000
"""A set-up above this many bytes is refused."""


class SplitBarCase(NamedTuple):
    """A set-up, its text with all changes, and the folder that its files are relative to."""

    setup: SplitBarSetup
    text: str
    folder: Path


def load_setup(path: str, changes: Iterable[str] = ()) -> SplitBarCase:
    """Read a set-up file, change some of its fields, and check it.

    Parameters
    ----------
    path : str
        A TOML file, or a folder that holds ``case.toml``.
    changes : iterable of str, optional
        ``path=value`` each, such as ``bar.incident.speed=4866 m/s``; a bare number is SI.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that is wrong.
    """
    file = Path(path)
    try:
        file = file / "case.toml" if file.is_dir() else file
        with file.open("rb") as opened:
            data = opened.read(LARGEST_FILE + 1)
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError("SETUP", path, "a text file in UTF-8") from None
    except (OSError, ValueError) as error:
        raise InputError("SETUP", path, "a set-up file", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError("SETUP", path, f"a set-up file of at most {LARGEST_FILE // 1000} kB")
    name = re.sub(r"[^\w.+-]+", "-", file.stem).strip("-.+") or "shot"
    return parse_setup(text, name, changes, file.parent)


def parse_setup(text: str, name: str = "", changes: Iterable[str] = (), folder: Path | None = None) -> SplitBarCase:
    """Check the TOML text of a set-up; see `load_setup`."""
    import tomlkit

    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = show(str(error) or "nested too deeply", 120).strip('"')
        raise InputErrors([f"{name or 'set-up'}: not a TOML file: {reason}"]) from None
    schema = document.get("schema", MISSING)
    if schema is MISSING or isinstance(schema, bool) or schema != 1:
        raise InputError("schema", schema, "schema = 1", "begin the set-up with schema = 1")
    for change in changes:
        _apply(document, change)
    document.setdefault("name", name)
    place = folder or Path()
    if isinstance(document.get("folder"), str) and document["folder"]:
        place = place / document["folder"]
    document["folder"] = str(place.absolute())
    try:
        setup = SplitBarSetup.model_validate(document)
    except ValidationError as error:
        raise InputErrors(_lines(error)) from None
    return SplitBarCase(setup, tomlkit.dumps(_toml(document)), place)


def values_of(part: Any, path: str = "") -> Iterator[tuple[str, Value]]:
    """Yield every quantity of a set-up with its path, such as ``bar.incident.density``."""
    if isinstance(part, Value):
        yield path, part
    elif isinstance(part, BaseModel):
        for key, entry in part:
            yield from values_of(entry, f"{path}.{key}" if path else key)


def _apply(document: dict[str, Any], change: str) -> None:
    """Set ``path=value``; a changed quantity is assumed and says so."""
    path, equals, text = (part.strip() for part in change.partition("="))
    if not equals or not path or not text:
        raise InputError("--set", change, 'path=value, such as bar.incident.speed="4866 m/s"')
    *tables, key = path.split(".")
    place: Any = document
    for table in tables:
        place = place.setdefault(table, {})
        if not isinstance(place, dict):
            raise InputError("--set " + path, change, "a table of the set-up")
    allowed = _range_at([*tables, key])
    if allowed is None:
        place[key] = text
        return
    typed: Any = text
    try:
        number = float(text)
        typed = f"{text} {allowed.unit}" if allowed.unit in DIMENSIONS else number
    except ValueError:
        pass
    place[key] = {"value": typed, "provenance": "assumed", "note": "set by the user"}


def _table_at(places: list[str]) -> type[BaseModel] | None:
    """Return the model of the table at a path; None where there is none."""
    model: type[BaseModel] | None = SplitBarSetup
    for place in places:
        field = model.model_fields.get(place) if model else None
        kinds = [field.annotation, *get_args(field.annotation)] if field else []
        model = next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel) and k is not Value), None)
    return model


def _range_at(places: list[str]) -> Range | None:
    """Return what the quantity at a path may be; None where there is no quantity."""
    model = _table_at(places[:-1])
    field = model.model_fields.get(places[-1]) if model else None
    for rule in field.metadata if field else ():
        owner = getattr(getattr(rule, "func", None), "__self__", None)
        if isinstance(owner, Range):
            return owner
    return None


def _lines(error: ValidationError) -> list[str]:
    """Turn pydantic's report into one line a fault: field, what came, what is allowed, what to do."""
    lines = []
    for fault in error.errors():
        places = [show(str(part)).strip('"') for part in fault["loc"]]
        path, cause = ".".join(places), fault.get("ctx", {}).get("error")
        if isinstance(cause, InputError):
            inner = ".".join(part for part in (path, cause.field) if part)
            lines.append(str(InputError(inner, cause.got, cause.allowed, cause.hint)))
        elif fault["type"] == "extra_forbidden":
            model = _table_at(places[:-1])
            lines.append(f"{path}: unknown key; {nearest(places[-1], model.model_fields if model else ())}")
        elif fault["type"] == "missing":
            allowed = _range_at(places)
            unit = DIMENSIONS.get(allowed.unit) if allowed else None
            example = f'{places[-1]} = "{unit[1]}"' if unit else (f"[{path}]" if _table_at(places) else places[-1])
            lines.append(f"{path}: missing; add {example}")
        elif fault["type"] == "literal_error":
            lines.append(str(InputError(path, fault["input"], str(fault.get("ctx", {}).get("expected", "")))))
        else:
            lines.append(f"{path or 'set-up'}: got {show(fault['input'])}; {fault['msg']}")
    return lines


def _toml(value: Any) -> Any:
    """Turn plain tables into TOML's: a quantity stays on its line."""
    import tomlkit

    if isinstance(value, dict):
        made: Any = tomlkit.inline_table() if "value" in value else tomlkit.table()
        plain_first = sorted(value.items(), key=lambda item: isinstance(item[1], dict) and "value" not in item[1])
        for key, entry in plain_first:
            made[key] = _toml(entry)
        return made
    return value
