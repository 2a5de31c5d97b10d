"""A result folder belongs to one run at a time, and what a killed run left beside it goes with the next one.

Beside ``out/NAME`` lie, hidden and named after it, while a run is under way: a lock, which the system lets go of when
the run ends, however it ends; and the folder that it writes into. Only who has the lock touches them.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import importlib
import os
import shutil
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from strikewave.base.errors import InputError, StrikewaveWarning

LONGEST_NAME, DIGITS = 60, 12  # well within the 255 bytes of file systems in any script; 48 bits keep names apart
"""Characters of a name that its hidden neighbours take over, and hexadecimal digits behind them, of the whole name."""
FULL = (errno.ENOSPC, errno.EDQUOT)
"""System errors of a full disk, or of a full quota of the user on it."""
AT_FDCWD, RENAME_EXCHANGE = -100, 2
"""Numbers of Linux: paths count from the working folder; two names change places."""


class Claim:
    """A result folder that this run alone writes: as typed, from the root, and the hidden place of its files."""

    def __init__(self, folder: Path) -> None:
        self.typed, self.folder = folder, folder.absolute()
        self.place = hidden_beside(self.folder, hashlib.sha256(os.fsencode(self.folder.name)).hexdigest()[:DIGITS])
        self._old = self.place.with_name(f"{self.place.name}.old")
        self._begun: tuple[int, int] | None = None

    @property
    def lock(self) -> Path:
        """The file that is locked."""
        return self.place.with_name(f"{self.place.name}.lock")

    @property
    def written(self) -> bool:
        """Whether the result of this run stands in its place."""
        return self._begun is not None and _identity(self.folder) == self._begun

    def recover(self) -> None:
        """Remove what a killed run left, and put the older result back where it was stopped between two renames."""
        if self._old.is_dir() and not self.folder.exists():
            self._old.rename(self.folder)
            words = f"a run was stopped while it replaced {self.folder}; the older result is back"
            warnings.warn(words, StrikewaveWarning, stacklevel=2)
        for left in (self._old, self.place):
            shutil.rmtree(left, ignore_errors=True)

    def begin(self) -> None:
        """Make the hidden folder."""
        self.place.mkdir()
        self._begun = _identity(self.place)

    def swap(self) -> None:
        """Put the hidden folder in the place of the result; at each moment the place holds one or the other.

        Where the system cannot exchange two names there is a moment without either: `recover` puts the older back.
        """
        if not self.folder.exists():
            self.place.rename(self.folder)
        elif not _exchange(self.place, self.folder):
            self.folder.rename(self._old)
            try:
                self.place.rename(self.folder)
            except BaseException:
                if not self.folder.exists():
                    self._old.rename(self.folder)
                raise
            shutil.rmtree(self._old, ignore_errors=True)


@contextlib.contextmanager
def claimed(folder: Path) -> Iterator[Claim]:
    """Claim a result folder for this run, unless another run has it or nothing can be written there.

    Folders above it are made, and go again where nothing came into them.
    """
    claim = Claim(folder)
    made = [parent for parent in claim.folder.parents if not parent.exists()]
    try:
        try:
            claim.folder.parent.mkdir(parents=True, exist_ok=True)
            lock = _lock(claim)
        except OSError as error:
            allowed, reason = "a place that can be written", refusal(error, claim.folder)
            raise InputError("--out", folder, allowed, reason) from None
        try:
            claim.recover()
            yield claim
        finally:
            if lock is not None:
                claim.lock.unlink(missing_ok=True)
                os.close(lock)
    finally:
        for parent in made:
            with contextlib.suppress(OSError):
                parent.rmdir()


def _lock(claim: Claim) -> int | None:
    """Lock the file of a claim and return it, open; None where the system has no locks."""
    try:
        fcntl: Any = importlib.import_module("fcntl")
    except ImportError:
        return None
    while True:
        file = os.open(claim.lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        try:
            # of the process, not of the open file: workers that were forked do not hold it when the run is dead
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            owner = os.read(file, DIGITS).decode("ascii", "replace").strip()
            os.close(file)
            if error.errno not in (errno.EACCES, errno.EAGAIN):
                return None
            hint = f"process {owner or 'unknown'} is at work on it; wait for its end, or choose another folder"
            raise InputError("--out", claim.folder, "a folder that no other run writes", hint) from None
        if _identity(claim.lock) == _identity(file):
            break
        os.close(file)  # its owner removed it meanwhile
    with contextlib.suppress(OSError):  # the number is a word to the user: a full disk may lack it
        os.truncate(file, 0)
        os.write(file, str(os.getpid()).encode())
    return file


def _identity(path: Path | int) -> tuple[int, int] | None:
    try:
        entry = os.stat(path)
    except FileNotFoundError:
        return None
    return entry.st_dev, entry.st_ino


def _exchange(first: Path, second: Path) -> bool:
    """Let two folders change places in one step; return whether the system did."""
    import ctypes

    try:
        rename = ctypes.CDLL(None).renameat2
    except (AttributeError, OSError, TypeError):
        return False
    return bool(rename(AT_FDCWD, os.fsencode(first), AT_FDCWD, os.fsencode(second), RENAME_EXCHANGE) == 0)


def hidden_beside(path: Path, ending: str) -> Path:
    """Return a hidden name beside a path.

    Examples
    --------
    >>> hidden_beside(Path("out/map"), "12ab").as_posix()
    'out/.map-12ab'
    """
    return path.with_name(f".{path.name[:LONGEST_NAME]}-{ending}")


def refusal(error: OSError, path: Path) -> str:
    """Return the reason why the system refused to write at a place; of a full disk its place and free room.

    Examples
    --------
    >>> refusal(PermissionError(errno.EACCES, "Permission denied"), Path("a"))
    'Permission denied'
    >>> refusal(OSError(errno.EFBIG, "File too large"), Path("a"))
    'File too large: the system limits the size of a file here (ulimit -f)'
    """
    reason = error.strerror or str(error)
    if error.errno == errno.EFBIG:
        return f"{reason}: the system limits the size of a file here (ulimit -f)"
    if error.errno not in FULL:
        return reason
    place = next(folder for folder in (path.absolute(), *path.absolute().parents) if folder.exists())
    disk = next((folder for folder in (place, *place.parents) if folder.is_mount()), place)
    free = shutil.disk_usage(place).free / 1e6
    return f"{reason}: {free:.1f} MB are free on the disk at {disk}; free more, or choose another place"
