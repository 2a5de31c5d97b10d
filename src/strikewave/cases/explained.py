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
def explanations() -> dict[str, Explained]:
    """Return the words on every field by its path without names of rows, such as ``stack.layer.length``.

    Examples
    --------
    >>> explanations()["striker.mass"].how
    'weigh it'
    """
    text = (resources.files("strikewave.cases") / "explained.toml").read_text("utf-8")
    return dict(_fields(tomllib.loads(text), ""))


def _fields(table: dict[str, Any], path: str) -> list[tuple[str, Explained]]:
    rows: list[tuple[str, Explained]] = []
    for key, entry in table.items():
        below = f"{path}.{key}" if path else key
        rows += _fields(entry, below) if isinstance(entry, dict) else [(below, Explained(*entry))]
    return rows


def comment_lines(path: str, entry: Any) -> list[str]:
    """Return the comment above a field of a case file: nothing above a table, or where a file says it itself.

    Examples
    --------
    >>> comment_lines("striker.mass", {"value": "1 kg", "provenance": "user"})[0][:60]
    'moving mass of a striker, or of the anvil where the object f'
    """
    words = explanations().get(path)
    if words is None:
        return []
    noted = isinstance(entry, dict) and not str(entry.get("note", "tolerance")).startswith("tolerance")
    text = f"{words.what}. How to get it: {words.how}." + ("" if noted else f" Taken here: {words.why}.")
    return textwrap.wrap(text, WIDTH)
