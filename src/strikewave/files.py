"""Results appear whole: written beside their place under another name, then renamed into it."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from strikewave.errors import InputError

MARK = "case.toml"
"""The file that marks a folder as a result."""


def check_place(folder: Path, identity: str, force: bool = False) -> None:
    """Refuse a result folder that holds something else.

    A folder that is absent, empty, or holds a result of the very same case (its ``case.toml`` equals
    ``identity``) may be written; any other result only by ``force``; what is not a result never.

    Raises
    ------
    InputError
        If the place is taken, is a file, or its parent cannot be written.
    """
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise InputError("--out", str(folder), "a folder", "this is a file or a link; choose another name")
    parent = next(p for p in [*folder.absolute().parents] if p.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        raise InputError("--out", str(folder), "a place that can be written", f"{parent} cannot")
    if not folder.exists() or not any(folder.iterdir()):
        return
    mark = folder / MARK
    if not mark.is_file():
        raise InputError("--out", str(folder), "an empty or new folder", "it holds files that are not a result")
    if not force and mark.read_text("utf-8", errors="replace") != identity:
        raise InputError(
            "--out", str(folder), "a new folder", "it holds the result of another case; add --force to replace it"
        )


@contextlib.contextmanager
def whole_folder(folder: Path, identity: str, force: bool = False) -> Iterator[Path]:
    """Give a temporary folder to write into; it takes the place of ``folder`` once all is written.

    On any error, Ctrl-C or a full disk included, the temporary folder goes and the old result stays.

    Raises
    ------
    InputError
        As `check_place` does, or if the disk is full.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as home:
    ...     with whole_folder(Path(home) / "out", identity="") as place:
    ...         _ = (place / "case.toml").write_text("")
    ...     [p.name for p in (Path(home) / "out").iterdir()]
    ['case.toml']
    """
    check_place(folder, identity, force)
    folder = folder.absolute()
    folder.parent.mkdir(parents=True, exist_ok=True)
    place = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        place.chmod(0o755)
        yield place
        _swap(place, folder)
    except OSError as error:
        raise InputError("--out", str(folder), "a place that can be written", error.strerror or str(error)) from error
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _swap(place: Path, folder: Path) -> None:
    """Move a finished folder into its place; an old one is put aside first and back if that fails."""
    if not folder.exists():
        place.rename(folder)
        return
    aside = Path(tempfile.mkdtemp(prefix=f".{folder.name}-old-", dir=folder.parent))
    old = aside / folder.name
    folder.rename(old)
    try:
        place.rename(folder)
    except BaseException:
        old.rename(folder)
        raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)
