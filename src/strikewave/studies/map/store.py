"""The finished rows of a map on disk, so that a map that was stopped goes on where it was.

The file lies beside the map's folder. It begins with a key made of the plan and the version: rows of another map, or
of another version, are refused. Then each finished row is appended: its number, its cells, and their check sum. A row
that was not written to its end, by a full disk or a process that was killed, is the last one, and is left aside.
"""

from __future__ import annotations

import dataclasses
import hashlib
import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.errors import InputError
from strikewave.studies.map.cells import FIELDS, MapPlan

Array = NDArray[np.float64]

MOST_TIMES = 4
"""A file with more rows than so many whole maps has is refused: two runs at once write each row twice. Chosen: twice
that, so that a damaged file is not read to its end."""
LONGEST_NAME = 200
"""Characters of a folder's name that the file takes over: a file system takes 255 bytes, dot and ending included."""
NUMBER, CHECK = struct.Struct("<q"), struct.Struct("<I")
"""Number of a row, before its cells, and their check sum, after them: little-endian on every machine."""
_MARK = b"rows of a strikewave map "
_HINT = "start anew with --fresh, or choose another --out"


def key_of(plan: MapPlan) -> str:
    """Return what tells one map from all others: its plan, the version, and the source of the kernels."""
    return hashlib.sha256(
        repr((dataclasses.astuple(plan), tuple(FIELDS), __version__, kernel_key(PACKAGE))).encode()
    ).hexdigest()


def rows_beside(folder: Path) -> Path:
    """Return where the finished rows of the map in a folder are kept.

    Examples
    --------
    >>> str(rows_beside(Path("out/map")))
    'out/.map.partial'
    """
    return folder.with_name(f".{folder.name[:LONGEST_NAME]}.partial")


class Store:
    """Rows of a map: kept in memory, and in a file where there is one.

    Parameters
    ----------
    plan : MapPlan
        What the map is of.
    path : Path, optional
        The file.
    fresh : bool, optional
        Leave aside what is there.

    Raises
    ------
    InputError
        If the file is damaged, or holds another map.
    """

    def __init__(self, plan: MapPlan, path: Path | None, fresh: bool = False) -> None:
        panels, rows, columns = plan.shape
        self.key = key_of(plan)
        self.path = path
        self.data = np.full((panels * rows, columns, len(FIELDS)), np.nan)
        self.done = np.zeros(panels * rows, dtype=bool)
        self._head = _MARK + f"{self.key}\n".encode()
        self._whole: int | None = 0  # bytes of the file that stand; None once it is begun
        if path is not None and (path.is_symlink() or (path.exists() and not path.is_file())):
            raise InputError("--out", str(path), "a file for the finished rows", "this is a folder or a link; move it")
        if path is not None and path.exists() and not fresh:
            self._read(path)

    def _read(self, path: Path) -> None:
        size = NUMBER.size + self.data[0].nbytes + CHECK.size
        try:
            with path.open("rb") as file:
                head = file.read(len(self._head))
                if head != self._head and head.startswith(_MARK) and len(head) == len(self._head):
                    raise InputError("--out", str(path), "the rows of this very map; these are of another", _HINT)
                if not self._head.startswith(head) or path.stat().st_size > MOST_TIMES * size * (len(self.done) + 1):
                    raise _damaged(path)
                while len(record := file.read(size)) == size:
                    self._take(record, path)
                    self._whole = file.tell()
        except OSError as error:
            raise InputError("--out", str(path), "a file that can be read", error.strerror or "") from None

    def _take(self, record: bytes, path: Path) -> None:
        """Take one row from its record."""
        body, end = record[: -CHECK.size], record[-CHECK.size :]
        (row,), (check,) = NUMBER.unpack(body[: NUMBER.size]), CHECK.unpack(end)
        if zlib.crc32(body) != check or not 0 <= row < len(self.done):
            raise _damaged(path)
        self.data[row] = np.frombuffer(body[NUMBER.size :], "<f8").reshape(self.data[row].shape)
        self.done[row] = True

    def keep(self, row: int, cells: Array) -> None:
        """Keep a finished row.

        Raises
        ------
        InputError
            If the disk is full, or the place cannot be written.
        """
        self.data[row], self.done[row] = cells, True
        if self.path is None:
            return
        record = NUMBER.pack(row) + np.ascontiguousarray(cells, "<f8").tobytes()
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab") as file:
                if self._whole is not None:
                    file.truncate(self._whole)
                    file.write(b"" if self._whole else self._head)
                    self._whole = None
                file.write(record + CHECK.pack(zlib.crc32(record)))
        except OSError as error:
            raise InputError("--out", str(self.path), "a place that can be written", error.strerror or "") from None

    def remove(self) -> None:
        """Remove the file: the map is whole."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)


def _damaged(path: Path) -> InputError:
    return InputError("--out", str(path), "the finished rows of a map; this file is damaged", _HINT)
