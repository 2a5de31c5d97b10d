"""The JSON documents of the commands: what each begins with, and values fit for JSON."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from typing import Any

from strikewave._version import __version__
from strikewave.base.control_characters import escaped

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
