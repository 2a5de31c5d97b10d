"""Files of compiled kernels: in a folder that nobody else can write, and each with a check sum.

They are pickles, with machine code in them: to read one is to run it. So the folder is the user's own; and a file that
a full disk or a fault of the disk has damaged is dropped, and its kernel compiled anew.
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import shutil
import stat
import warnings
from pathlib import Path
from typing import Any

from numba.core.caching import IndexDataCacheFile

from strikewave.base.errors import StrikewaveWarning

PRIVATE = 0o700
"""Mode of the folder: its owner reads and writes, nobody else sees it."""
WRITTEN_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH
"""Of a mode, by which others may have put files there."""
CHECK = hashlib.sha256().digest_size
"""Bytes of the check sum at the beginning of a file."""


def own_folder(folder: Path) -> None:
    """Make a folder that is the user's own, or see to it that it is: emptied where others could write there.

    Raises
    ------
    OSError
        If it cannot be made, is no folder, or belongs to someone else.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE, exist_ok=True)
    if not hasattr(os, "geteuid"):
        return
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        raise PermissionError(0, "it belongs to another user, or is a link")
    if found.st_mode & WRITTEN_BY_OTHERS:
        shutil.rmtree(folder)
        folder.mkdir(mode=PRIVATE)
    elif stat.S_IMODE(found.st_mode) != PRIVATE:
        folder.chmod(PRIVATE)


class KernelFiles(IndexDataCacheFile):
    """Index and data of the kernels of a function, as numba keeps them, behind a check sum.

    Numba itself takes what a file holds on trust: emptied, cut or with another bit it stops each later run, by an error
    of pickle or a crash.
    """

    def _load_index(self) -> Any:
        held = self._checked(self._index_path)
        if held is None or held[:2] != (self._version, self._source_stamp):
            return {}
        return held[2]

    def _save_index(self, overloads: Any) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._checked(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, held: Any) -> None:
        body = self._dump(held)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(body).digest() + body)

    def _checked(self, path: str) -> Any:
        """Return what a file holds; None where it is not there or was damaged, which removes it."""
        try:
            whole = Path(path).read_bytes()
        except OSError:
            return None
        check, body = whole[:CHECK], whole[CHECK:]
        if hashlib.sha256(body).digest() == check:
            return pickle.loads(body)
        Path(path).unlink(missing_ok=True)
        _warn(f"compiled kernels in {Path(path).parents[1]} were damaged; those are dropped, and compiled anew")
        return None


def report_unkept(folder: str, error: OSError) -> None:
    """Warn, once, that compiled kernels could not be kept in the folder of a module."""
    _warn(
        f"compiled kernels cannot be kept in {Path(folder).parent} ({error.strerror}); runs compile anew what is "
        "missing there. Free some room, or set NUMBA_CACHE_DIR to a folder that can be written"
    )


@functools.cache
def _warn(message: str) -> None:
    warnings.warn(message, StrikewaveWarning, stacklevel=3)
