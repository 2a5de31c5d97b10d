"""The finished rows of a map on disk, so that a map that was stopped goes on where it was.

The file is NumPy's npz without pickles. It carries a key made of the plan and the version: rows of another map, or of
another version, are refused. It is written beside its place and renamed into it.
"""

from __future__ import annotations

import hashlib
import io
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.compiled import PACKAGE, kernel_key
from strikewave.errors import InputError
from strikewave.studies.map_cells import FIELDS, Plan

Array = NDArray[np.float64]

NAME = "map.partial.npz"
_LARGEST = 2_000_000_000


def key_of(plan: Plan) -> str:
    """Return what tells one map from all others: its plan, the version, and the source of the kernels."""
    return hashlib.sha256(repr((plan, tuple(FIELDS), __version__, kernel_key(PACKAGE))).encode()).hexdigest()


class Store:
    """Rows of a map: kept in memory, and in a folder where there is one.

    Parameters
    ----------
    plan : Plan
        What the map is of.
    folder : Path, optional
        Where the file lies.
    fresh : bool, optional
        Leave aside what is there.

    Raises
    ------
    InputError
        If the file is damaged, or holds another map.
    """

    def __init__(self, plan: Plan, folder: Path | None, fresh: bool = False) -> None:
        panels, rows, columns = plan.shape
        self.key = key_of(plan)
        self.path = None if folder is None else folder / NAME
        self.data = np.full((panels * rows, columns, len(FIELDS)), np.nan)
        self.done = np.zeros(panels * rows, dtype=bool)
        if self.path is not None and self.path.exists() and not fresh:
            self._read(self.path)

    def _read(self, path: Path) -> None:
        hint = "start anew with --fresh, or choose another --out"
        try:
            if path.stat().st_size > min(_LARGEST, 2 * self.data.nbytes + 100_000):
                raise ValueError
            with np.load(path, allow_pickle=False) as file:
                key, done, data = str(file["key"]), file["done"], file["data"]
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            raise InputError("--out", str(path), "the finished rows of a map; this file is damaged", hint) from None
        if key != self.key:
            raise InputError("--out", str(path), "the rows of this very map; these are of another", hint)
        fits = data.shape == self.data.shape and data.dtype == float and done.shape == self.done.shape
        if not fits or done.dtype != bool:
            raise InputError("--out", str(path), "the finished rows of a map; this file is damaged", hint)
        self.data, self.done = data, done

    def keep(self, row: int, cells: Array) -> None:
        """Keep a finished row."""
        self.data[row], self.done[row] = cells, True
        if self.path is None:
            return
        text = io.BytesIO()
        np.savez(text, key=np.array(self.key), done=self.done, data=self.data)
        partial = self.path.with_suffix(".new")
        try:
            partial.write_bytes(text.getvalue())
            partial.replace(self.path)
        except OSError as error:
            raise InputError("--out", str(self.path), "a place that can be written", error.strerror or "") from None
