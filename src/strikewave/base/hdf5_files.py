"""HDF5 files on a disk that may fill or be damaged: the program outlives both, and tells what it was."""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


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
    """Give a new file to write HDF5 into.

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


def content_digest(arrays: Mapping[str, NDArray[Any]], *words: str) -> str:
    """Return a SHA-256 of arrays with their names, types and shapes, and of some words.

    HDF5 checks neither numbers nor words: a bit that changed on the disk gives another number, and no error.

    Examples
    --------
    >>> one = content_digest({"x": np.arange(3.0)}, "run")
    >>> one == content_digest({"x": np.arange(3.0)}, "run"), one == content_digest({"x": np.arange(3.0)}, "walk")
    (True, False)
    """
    digest = hashlib.sha256(repr(words).encode("utf-8", "replace"))
    for name in sorted(arrays):
        values = np.asarray(arrays[name])
        if values.dtype.kind in "OUS":
            values = np.frombuffer(repr(values.tolist()).encode("utf-8", "replace"), np.uint8)
        digest.update(repr((name, values.dtype.str, values.shape)).encode())
        digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
