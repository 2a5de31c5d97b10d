"""Study files: how they are read, and the settings, files and errors that they name."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator

from strikewave.base.errors import MISSING, InputError, InputErrors
from strikewave.base.quantities import Value
from strikewave.cases.files import bundled_cases, read_small_file
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable

Stated = TypeVar("Stated", bound=CaseTable)

MOST_SET, DEEPEST = 100, 8
"""Settings of one table, and tables within one another: no test has as many."""

_OPTION = re.compile(r"--(?:to|free|try|set|check-on|filter|vary|analysis)(?:: | |$)")


def read_study(path: Path, form: Form[Stated], allowed: str) -> Stated:
    """Return the tables of the file of a study."""
    return form.read(read_small_file(path, "FILE", allowed), f"{path.name}: ")


def states_a_study(document: Mapping[str, Any], tables: Sequence[str]) -> bool:
    """Tell whether a document is that of a study: it names a case, or has a table that only such a study has.

    Examples
    --------
    >>> states_a_study({"schema": 1, "case": "li-ma-2019"}, ["vary"]), states_a_study({"machine": {}}, ["vary"])
    (True, False)
    """
    return isinstance(document.get("case"), str) or any(table in document for table in tables)


def quantity(raw: Any) -> str | int | float:
    """Return a quantity as typed: a text, or a bare number."""
    if isinstance(raw, bool) or not isinstance(raw, str | int | float):
        raise InputError("", raw, 'a quantity, such as "0.5 m", or a bare number')
    return raw


def _settings(raw: Any) -> tuple[str, ...]:
    """Return settings, ``path=value`` each; a path is a key in quotes, or keys within one another."""
    changes = [f"{path}={value}" for path, value in _leaves(raw, "")]
    if len(changes) > MOST_SET:
        raise InputError("", f"{len(changes)} settings", f"at most {MOST_SET}")
    return tuple(changes)


def _leaves(raw: Any, path: str, depth: int = 0) -> Iterator[tuple[str, Any]]:
    if isinstance(raw, Mapping):
        if depth > DEEPEST:
            raise InputError(path, "tables within tables", "paths of a case")
        for key, value in raw.items():
            yield from _leaves(value, f"{path}.{key}".lstrip("."), depth + 1)
    elif not path or isinstance(raw, bool) or not isinstance(raw, str | int | float):
        raise InputError(path, raw, 'paths with their values, such as machine.height = "0.5 m"')
    else:
        yield path, raw


Quantity = Annotated[str | int | float, BeforeValidator(quantity)]
Settings = Annotated[tuple[str, ...], BeforeValidator(_settings)]


Vary = Mapping[str, Any] | Sequence[str]
"""Varied settings: texts ``setting=values``, or values by settings."""


def vary_texts(vary: Vary) -> list[str]:
    """Return what is varied as it is typed on the command line: a list with commas, SI without a unit.

    Keys with dots are tables within tables in TOML.

    Examples
    --------
    >>> vary_texts({"machine.speed": [40.0, 50.0], "object": {"spring": "20..40 kN/m"}})
    ['machine.speed=40.0, 50.0', 'object.spring=20..40 kN/m']
    """
    return list(_varied(vary, "")) if isinstance(vary, Mapping) else list(vary)


def _varied(table: Mapping[str, Any], path: str) -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _varied(value, f"{path}{key}.")
        elif isinstance(value, str | int | float | Value) and value != "":
            yield f"{path}{key}={value}"
        elif isinstance(value, Iterable) and value != "":
            yield f"{path}{key}={', '.join(map(str, value))}"
        else:
            raise InputError(f"vary.{path}{key}", MISSING, 'values, such as "400..900 rpm:11"')


def beside(word: str, folder: Path) -> str:
    """Return a file or a pattern beside the file of a study, or else from where we work."""
    place = str(folder / word)
    is_pattern = any(mark in word for mark in "*?[")
    return place if is_pattern or os.path.lexists(place) else word


def case_place(name: str, folder: Path) -> str:
    """Return a built-in case, or the file of a case beside the file of a study."""
    return name if name in bundled_cases() else beside(name, folder)


@contextlib.contextmanager
def stated_at(place: str) -> Iterator[None]:
    """Name the place of a file in an error that would name the option of the command; nothing where it is empty.

    Examples
    --------
    >>> with stated_at("fit.toml: number.0"):
    ...     raise InputError("--to first.width", "1", "a time with its unit")
    Traceback (most recent call last):
    strikewave.base.errors.InputErrors: fit.toml: number.0: first.width: got "1"; allowed: a time with its unit
    """
    try:
        yield
    except InputError as error:
        if not place:
            raise
        lines = error.lines if isinstance(error, InputErrors) else (str(error),)
        raise InputErrors(f"{place}: {_OPTION.sub('', line, count=1)}" for line in lines) from None
