"""HDF5 files on a disk that may fill or be damaged: the program outlives both, and tells what it was."""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

SEAL, SUM = b"\nstrikewave sha256 ", 2 * hashlib.sha256().digest_size
"""What stands behind the end of a file, before its check sum, and the digits of that."""
BLOCK = 1 << 20
"""Bytes that are read at once for a check sum."""


class EnduringFile(io.RawIOBase):
    """A file for HDF5 that hides from it what the disk refuses, and keeps the first error for `check`.

    HDF5 holds on to what it could not write, tries again when the process ends, and crashes there. Where all seems
    written it comes to its end; whoever opened the file then calls `check`, and leaves aside what was written.

    Parameters
    ----------
    path : Path
        Where the file lies.
    mode : str
        "w+" for a new file, "r+" for one that goes on.

    Raises
    ------
    OSError
        If it cannot be opened.
    """

    def __init__(self, path: Path, mode: str = "w+") -> None:
        self._file = io.FileIO(path, mode)
        self._error: OSError | None = None

    def check(self) -> None:
        """Raise the first error of the disk, where there was one."""
        if self._error is not None:
            raise self._error

    def write(self, data: Any) -> int:
        """Write all of some bytes."""
        left = memoryview(data).cast("B")
        size = left.nbytes

        def write() -> None:
            nonlocal left
            while left.nbytes:
                left = left[self._file.write(left) :]

        self._try(write)
        return size

    def truncate(self, size: int | None = None) -> int:
        """Cut or lengthen the file."""
        self._try(lambda: self._file.truncate(size))
        return self.tell() if size is None else size

    def readinto(self, buffer: Any) -> int:
        """Read into a buffer; what is not there since it could not be written is zero."""
        into = memoryview(buffer).cast("B")
        count = self._file.readinto(into) or 0
        if self._error is None:
            return count
        into[count:] = bytes(into.nbytes - count)
        return into.nbytes

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the place."""
        return self._file.tell()

    def readable(self) -> bool:
        """Return True."""
        return True

    def writable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True

    def close(self) -> None:
        """Close the file."""
        self._try(self._file.close)
        super().close()

    def _try(self, act: Callable[[], object]) -> None:
        if self._error is None:
            try:
                act()
            except OSError as error:
                self._error = error


@contextlib.contextmanager
def enduring_file(path: Path) -> Iterator[EnduringFile]:
    """Give a new file to write HDF5 into, which is sealed at its end.

    Raises
    ------
    OSError
        At its end, if the disk refused any of it.

    Examples
    --------
    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as home:
    ...     with enduring_file(Path(home) / "a.h5") as disk, h5py.File(disk, "w") as file:
    ...         file["x"] = [1, 2]
    ...     check_sealed(Path(home) / "a.h5")
    ...     with h5py.File(Path(home) / "a.h5") as file:
    ...         file["x"][:].tolist()
    [1, 2]
    """
    file = EnduringFile(path)
    try:
        yield file
    except Exception:
        file.check()  # what HDF5 says of a file that was not written is of no use
        raise
    finally:
        file.close()
    file.check()
    seal(path)


def seal(path: Path) -> None:
    """Write the SHA-256 of a file behind its end, where HDF5 does not look: see `check_sealed`.

    Raises
    ------
    OSError
        If the disk refuses it.
    """
    with path.open("r+b") as file:
        file.write(SEAL + _sum(file, path.stat().st_size))


def is_sealed(path: Path) -> bool:
    """Tell whether a file ends as `seal` leaves one, which says nothing of the rest.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    with path.open("rb") as file:
        return _seal_of(file, path.stat().st_size) is not None


def check_sealed(path: Path) -> None:
    """Refuse a file that is not, to the bit, as it was sealed, before HDF5 reads it.

    HDF5 checks no numbers: another bit is another number, or a search without end in its own tables.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is not as it was written.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        kept = _seal_of(file, size)
        if kept is None:
            raise ValueError("its check sum is missing: it was cut, rewritten, or an older strikewave wrote it")
        file.seek(0)
        if _sum(file, size - len(SEAL) - SUM) != kept:
            raise ValueError("it is not as it was written: bytes of it have changed")


def _seal_of(file: IO[bytes], size: int) -> bytes | None:
    """Return the check sum at the end of a file; None where there is none."""
    file.seek(max(0, size - len(SEAL) - SUM))
    end = file.read()
    return end[-SUM:] if end.startswith(SEAL) and len(end) == len(SEAL) + SUM else None


def _sum(file: IO[bytes], size: int) -> bytes:
    """Return the check sum of so many bytes from where a file stands, as text."""
    digest, left = hashlib.sha256(), size
    while left > 0 and (block := file.read(min(left, BLOCK))):
        digest.update(block)
        left -= len(block)
    return digest.hexdigest().encode()
