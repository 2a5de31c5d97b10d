"""What the fields of a case are, in words: what each is, how one gets it on a real machine, why a default is taken."""

from __future__ import annotations

import functools
import textwrap
import tomllib
from importlib import resources
from typing import Any, NamedTuple

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
