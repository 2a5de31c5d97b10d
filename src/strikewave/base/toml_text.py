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
