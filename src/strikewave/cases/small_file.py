"""A small TOML file that is no case: of a test, of a sensor."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from strikewave.base.errors import EXISTING_FILE, InputError, show
from strikewave.base.toml_text import read_toml

LARGEST_FILE = 100_000
"""A file above this many bytes is refused: no table of such fields comes near."""


def read_small_file(file: Path, field: str, allowed: str) -> dict[str, Any]:
    """Return the tables of a TOML file; ``allowed`` says what it is to hold.

    Raises
    ------
    InputError
        If it cannot be read, is none, or is too large.
    """
    try:
        with file.open("rb") as opened:
            data = opened.read(LARGEST_FILE + 1)
        document = read_toml(data.decode("utf-8-sig"))
    except FileNotFoundError:
        raise InputError(field, str(file), EXISTING_FILE) from None
    except OSError as error:
        raise InputError(field, str(file), "a file that can be read", error.strerror or "") from None
    except ValueError as error:
        raise InputError(field, str(file), allowed, show(str(error), 120).strip('"')) from None
    if len(data) > LARGEST_FILE:
        raise InputError(field, str(file), f"a file of at most {LARGEST_FILE // 1000} kB")
    return document
