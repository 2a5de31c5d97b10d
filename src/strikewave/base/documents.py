"""JSON documents of the commands, and TOML files of the user."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Sequence
from typing import Any

from strikewave._version import __version__
from strikewave.base.texts import escaped

SCHEMA = 1
"""Version of every JSON document: from release 0.1.0 on it rises when a key changes its meaning or goes."""


def head(units: dict[str, str], warnings: Sequence[dict[str, Any]] = ()) -> dict[str, Any]:
    """Return the keys that every JSON document begins with."""
    return {"schema": SCHEMA, "version": __version__, "units": units, "warnings": list(warnings)}


def json_text(document: dict[str, Any], indent: int | None = None, ascii_only: bool = False) -> str:
    r"""Return a JSON document as the text of a file: words with their usual spaces, a line end last.

    Examples
    --------
    >>> json_text({"message": "5\N{NO-BREAK SPACE}kN"})
    '{"message": "5 kN"}\n'
    >>> print(json_text({"length": "5 µm"}, ascii_only=True), end="")
    {"length": "5 \u00b5m"}
    """
    text = json.dumps(document, indent=indent, allow_nan=False, ensure_ascii=False)
    text = escaped(text.replace("\N{NO-BREAK SPACE}", " ")) + "\n"
    return re.sub("[^\x00-\x7f]", lambda found: json.dumps(found[0])[1:-1], text) if ascii_only else text


def without(row: dict[str, Any], *keys: str) -> dict[str, Any]:
    """Return a row without some keys."""
    return {k: v for k, v in row.items() if k not in keys}


def plain(value: Any) -> Any:
    """Return nested data fit for JSON: numpy numbers become Python's, NaN and infinity become null.

    Examples
    --------
    >>> import numpy as np
    >>> plain({"a": np.float64("nan"), "b": (1, 2.5)})
    {'a': None, 'b': [1, 2.5]}
    """
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


MOST_PARTS = 40  # ours have five; memory grows with their square, to 6 GB at 40 000
"""Parts of a dotted key at most."""
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MOST_PARTS}}}")


def read_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text; one that is none, is nested too deeply or has too long a key is a `ValueError`.

    Examples
    --------
    >>> read_toml("a.b = 1")
    {'a': {'b': 1}}
    >>> read_toml("a" + ".b" * 50 + " = 1")
    Traceback (most recent call last):
    ValueError: a key of many parts
    """
    if _LONG_KEY.search(text):
        raise ValueError("a key of many parts")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(_in_words(str(error))) from None


def _in_words(reason: str) -> str:
    """Return the reason why a text is no TOML in its writer's words, with the way out.

    Examples
    --------
    >>> _in_words("Cannot declare ('machine', 'body') twice (at line 9, column 9)")
    'the table [machine.body] stands there twice (at line 9, column 9): make one of them'
    >>> _in_words("Expected newline or end of document after a statement (at line 2, column 7)")
    'more than a value stands there (at line 2, column 7): a value with a unit stands in quotes, "1.2 m"'
    """
    where = "".join(re.findall(r" \(at .*\)$", reason))
    twice = re.match(r"Cannot declare \((.*?),?\) twice", reason)
    if twice is not None:
        table = ".".join(part.strip(" '\"") for part in twice[1].split(","))
        return f"the table [{table}] stands there twice{where}: make one of them"
    if reason.startswith("Cannot overwrite"):
        return f"a key stands there twice{where}: leave one out"
    if reason.startswith("Expected newline"):
        return f'more than a value stands there{where}: a value with a unit stands in quotes, "1.2 m"'
    if reason.startswith("Illegal character '\\n'"):
        return f"a text is not closed by its quote{where}"
    if reason.startswith("Invalid value"):
        return f"no value stands there{where}: texts, and values with a unit, stand in quotes"
    return reason
