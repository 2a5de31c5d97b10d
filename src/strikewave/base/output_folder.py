"""Results appear whole: written beside their place under another name, then renamed into it."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

from strikewave.base.errors import InputError, show
from strikewave.base.folder_claim import Claim, hidden_beside, refusal

MARKS = ("case.toml", "record.toml")
"""One of these files marks a folder as a result; its text distinguishes one result from another."""
RESULT_FILES = (
    *MARKS,
    "waves.nc",
    "taps.csv",
    "solution.nc",
    "blows.csv",
    "pulses.csv",
    "motion.csv",
    "pairs.csv",
    "transfer.csv",
    "responses.csv",
    "spectrum.csv",
    "comparison.csv",
    "response.csv",
    "response.svg",
    "rolling.csv",
    "rolling.svg",
    "summary.svg",
    "field.svg",
    "animation.html",
    "animation.gif",
    "machine.html",
    "machine.gif",
    "tripartite.svg",
    "impact.json",
    "impact.svg",
    "history.csv",
    "identify.json",
    "reduction.csv",
    "reduction.nc",
    "echoes.csv",
    "echoes.nc",
    "buffer.json",
    "buffers.csv",
    "sensor.csv",
    "sensor.toml",
    "peak-bandwidth.svg",
    "histories.svg",
    "transmissibility.svg",
    "fit.json",
    "fit.svg",
    "fitted.toml",
    "parameters.csv",
    "residuals.csv",
    "runs.csv",
    "runs.parquet",
    "run-histories.parquet",
    "design.json",
    "design.svg",
    "sweep.json",
    "sweep.svg",
    "scatter.json",
    "scatter.svg",
    "map.json",
    "map.nc",
    "map.csv",
    "map.svg",
    "acceleration.csv",
    "synthesis.json",
    "map.png",
    "equal-blows.toml",
    "settings.json",
    "settings.svg",
    "spec.json",
    "specification.toml",
    "laws.json",
    "asked-given.svg",
    "asked-given.png",
    "stiffness-laws.svg",
    "stiffness-laws.png",
    "cushion-laws.svg",
    "cushion-laws.png",
    "histories.nc",
    "histories.csv",
    "histories-pulse.csv",
    "histories-record.csv",
    "histories-reading.csv",
    "histories-interval.csv",
    "histories.parquet",
    "histories-pulse.parquet",
    "histories-record.parquet",
    "histories-reading.parquet",
    "histories-interval.parquet",
    "field.vtkhdf",
    "result.xlsx",
    "comparison.json",
    "comparison.svg",
    "report.html",
    "report.pdf",
    "test-report.html",
    "test-report.pdf",
    "shocks.csv",
)
"""What a result consists of; a folder that holds anything else is never replaced, for it may be the user's own."""
ANIMATIONS = ("machine.html", "machine.gif", "animation.html", "animation.gif")
"""Files that take long to make and depend on the inputs alone: a rerun that does not make them keeps them."""
_RANDOM_BYTES = 6
"""Random bytes behind the name of a file that is being written, of which no two runs ever share."""


_NUMBER = re.compile(r"[-_]\d+\.")
"""Of the files of a later blow: histories-2.csv is one of the files that a result consists of, as histories.csv is; and
of the readings of a sensor."""


def check_place(folder: Path, identity: str, force: bool = False, own: Sequence[str] = ()) -> None:
    """Refuse a result folder that holds something else.

    A folder that is absent, empty, or holds the very same result (its ``case.toml`` or ``record.toml`` equals
    ``identity``, or begins with it where it is one line) may be written; any other result only by ``force``; one that
    holds other files never. ``own`` are files of this result beside `RESULT_FILES`, such as those named after the case.

    Raises
    ------
    InputError
        If the place is taken, is a file, or its parent cannot be written.
    """
    try:
        _check(folder, identity, force, own)
    except OSError as error:
        raise InputError("--out", str(folder), "a folder that can be written", error.strerror or str(error)) from None


def _check(folder: Path, identity: str, force: bool, own: Sequence[str]) -> None:
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise InputError("--out", str(folder), "a folder", "this is a file or a link; choose another name")
    parent = next((p for p in folder.absolute().parents if p.exists()), None)
    if parent is None:
        raise InputError("--out", str(folder), "a folder below the root")
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        raise InputError("--out", str(folder), "a place that can be written", f"{parent} cannot")
    if not folder.exists() or not any(folder.iterdir()):
        return
    mark = next((folder / name for name in MARKS if (folder / name).is_file()), None)
    known, names = {*RESULT_FILES, *own}, (entry.name for entry in folder.iterdir())
    foreign = sorted(name for name in names if not {name, _NUMBER.sub(".", name)} & known)
    if foreign or mark is None:
        hint = (
            f"it holds files that are not of a result ({show(', '.join(foreign))}); move them, or choose another folder"
        )
        raise InputError("--out", str(folder), "an empty or new folder", hint)
    if not force and not _is_marked(mark.read_text("utf-8", errors="replace"), identity):
        raise InputError("--out", str(folder), "a new folder", "it holds another result; add --force to replace it")


def _is_marked(text: str, identity: str) -> bool:
    """Tell whether a text marks a result: of a search it begins with what was asked, and what was found follows."""
    asked = identity.endswith("\n") and identity.count("\n") == 1
    return text.startswith(identity) if asked else text == identity


LATER = 2.0
"""Seconds by which a file is newer than all others where it was changed after the run: a run writes the text that marks
its folder before tables and PDF, and some file systems keep times to 2 s."""


def check_unchanged(folder: Path, identity: str) -> None:
    """Refuse to replace a result whose ``case.toml`` was changed by hand after the run: it may be someone's only copy.

    Raises
    ------
    InputError
        If the text that marks the folder is another one, and newer than all else there.
    """
    with contextlib.suppress(OSError):
        mark = next((folder / name for name in MARKS if (folder / name).is_file()), None)
        if mark is None or mark.read_text("utf-8", errors="replace") == identity:
            return
        others = [entry.stat().st_mtime for entry in folder.iterdir() if entry.name != mark.name]
        if others and mark.stat().st_mtime > max(others) + LATER:
            hint = f"{mark} was changed after the run: copy it to run it, or add --force to replace it"
            raise InputError("--out", str(folder), "a result as its run wrote it", hint)


@contextlib.contextmanager
def atomic_folder(claim: Claim, identity: str, force: bool = False, own: Sequence[str] = ()) -> Iterator[Path]:
    """Give a temporary folder to write into; it takes the place of the claimed one once all is written.

    On any error, Ctrl-C or a full disk included, the temporary folder goes and the old result stays.

    Raises
    ------
    InputError
        As `check_place` does, or if the disk is full.

    Examples
    --------
    >>> import tempfile
    >>> from strikewave.base.folder_claim import claimed
    >>> with tempfile.TemporaryDirectory() as home:
    ...     with claimed(Path(home) / "out") as claim, atomic_folder(claim, identity="") as place:
    ...         _ = (place / "case.toml").write_text("")
    ...     [p.name for p in (Path(home) / "out").iterdir()], len(list(Path(home).iterdir()))
    (['case.toml'], 1)
    """
    check_place(claim.folder, identity, force, own)
    try:
        claim.begin()
        yield claim.place
        check_place(claim.folder, identity, force, own)
        claim.swap()
    except OSError as error:
        allowed, reason = "a place that can be written", refusal(error, claim.folder)
        raise InputError("--out", str(claim.folder), allowed, reason) from error
    finally:
        shutil.rmtree(claim.place, ignore_errors=True)


def keep_true_files(old: Path, new: Path, identity: str) -> tuple[list[str], list[str]]:
    """Copy the animations of an older run that are still true into the new folder; return the kept and removed names.

    They are true where the older folder is of the same inputs, and every table and picture that both hold is equal to
    the byte: tables tell other numbers, pictures other units.
    All else that the new run did not write goes with the older folder.
    """
    if not old.is_dir():
        return [], []
    rest = sorted(entry.name for entry in old.iterdir() if not (new / entry.name).exists())
    shared = [path for kind in ("*.csv", "*.svg") for path in new.glob(kind) if (old / path.name).is_file()]
    same = any((old / mark).is_file() and (old / mark).read_text("utf-8", "replace") == identity for mark in MARKS)
    same = same and bool(shared) and all(path.read_bytes() == (old / path.name).read_bytes() for path in shared)
    kept = [name for name in rest if same and name in ANIMATIONS]
    for name in kept:
        shutil.copy2(old / name, new / name)
    return kept, [name for name in rest if name not in kept]


def write_atomically(path: Path, text: str) -> None:
    """Write a text file that appears whole or not at all.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    partial = hidden_beside(path, secrets.token_hex(_RANDOM_BYTES))
    try:
        with partial.open("x", encoding="utf-8") as file:
            file.write(text)
        partial.replace(path)
    except OSError as error:
        raise InputError("FILE", str(path), "a place that can be written", refusal(error, path)) from None
    finally:
        partial.unlink(missing_ok=True)
