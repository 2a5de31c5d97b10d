"""The TOML of a file of the user's, read only where that costs little."""

from __future__ import annotations

import re
import tomllib
from typing import Any

MOST_PARTS = 40
"""Parts of a dotted key: ours have five at most. Memory grows with their square, to 6 GB at 40 000."""
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MOST_PARTS}}}")


def read_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises
    ------
    ValueError
        If it is none, is nested too deeply, or has a key of more than `MOST_PARTS` parts.

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
    """Return why a text is no TOML as its writer sees it, with what to do.

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
