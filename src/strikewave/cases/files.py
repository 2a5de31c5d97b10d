"""Case files, built in or in a folder, and small files of another kind: of a test, of a sensor."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any

from strikewave.base.documents import read_toml
from strikewave.base.errors import EXISTING_CASE, EXISTING_FILE, InputError, nearest, show

LARGEST_FILE = 1_000_000
"""A case file above this many bytes is refused: a hundred times the largest built-in case, so that it is no case
file."""


def bundled_cases() -> list[str]:
    """Return the names of the built-in cases.

    Examples
    --------
    >>> "li-ma-2019" in bundled_cases()
    True
    """
    folder = resources.files("strikewave.cases") / "published"
    return sorted(entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml"))


def _nearest_case(path: Path, name: str) -> str:
    """Return which case was meant: a file beside it, or a built-in one; all built-in ones where none is like it."""
    beside = [str(path.with_name(one.name)) for one in path.parent.glob("*.toml")]
    hints = [nearest(name, choices) for choices in (beside, bundled_cases())]
    meant = next((hint for hint in hints if hint.startswith("did you mean")), "")
    listed = "`strikewave cases` lists the built-in ones" if name.endswith(".toml") else hints[-1]
    return meant or listed


def read_case_text(name: str) -> tuple[str, str]:
    """Return the TOML text and the name of a case file, or of a built-in case."""
    if name in bundled_cases():
        return (resources.files("strikewave.cases") / "published" / f"{name}.toml").read_text("utf-8"), name
    path = Path(name)
    try:
        if path.is_dir() and (path / "case.toml").is_file():
            path = path / "case.toml"
        if not path.is_file():
            allowed = EXISTING_FILE if name.endswith(".toml") else EXISTING_CASE
            raise InputError("case", name, allowed, _nearest_case(path, name))
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("case", path, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_FILE:
        raise InputError("case", path, f"a case file of at most {LARGEST_FILE // 1000} kB")
    try:
        return data.decode("utf-8-sig"), path.stem
    except UnicodeDecodeError:
        raise InputError("case", path, "a text file in UTF-8") from None


LARGEST_SMALL_FILE = 100_000
"""A file above this many bytes is refused: no table of such fields comes near."""


def read_small_file(file: Path, field: str, allowed: str) -> dict[str, Any]:
    """Return the tables of a TOML file; ``allowed`` says what it is to hold."""
    try:
        with file.open("rb") as opened:
            data = opened.read(LARGEST_SMALL_FILE + 1)
        document = read_toml(data.decode("utf-8-sig"))
    except FileNotFoundError:
        raise InputError(field, file, EXISTING_FILE) from None
    except OSError as error:
        raise InputError(field, file, "a file that can be read", error.strerror or "") from None
    except ValueError as error:
        raise InputError(field, file, allowed, show(str(error), 120).strip('"')) from None
    if len(data) > LARGEST_SMALL_FILE:
        raise InputError(field, file, f"a file of at most {LARGEST_SMALL_FILE // 1000} kB")
    return document
