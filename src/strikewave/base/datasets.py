"""Arrays with names, units and dimensions, as an xarray Dataset holds them, and the HDF5 files that hold them.

They are made and written without xarray, which takes a third of a second to import, pandas with it: a run, its page and
its NetCDF file need neither.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NamedTuple

import numpy as np

from strikewave.base.errors import InputError

if TYPE_CHECKING:
    import xarray

SEAL, SUM = b"\nstrikewave sha256 ", 2 * hashlib.sha256().digest_size
"""Mark behind the end of a file, before its check sum, and the digits of that."""
BLOCK = 1 << 20  # chosen: a file of any size needs no more memory
"""Bytes that are read at once for a check sum."""


class EnduringFile(io.RawIOBase):
    """A file for HDF5 that hides errors of the disk from it, and keeps the first one for `check`.

    HDF5 holds on to bytes that it could not write, tries again when the process ends, and crashes there. Where all
    seems written it comes to its end; whoever opened the file then calls `check`, and drops it. The mode is "w+" for a
    new file, "r+" for one that goes on.
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
        """Read into a buffer; bytes that could not be written are zero."""
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
    """Give a new file to write HDF5 into; at its end it is sealed, or an error of the disk is raised.

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
    """Write the SHA-256 of a file behind its end, where HDF5 does not look: see `check_sealed`."""
    with path.open("r+b") as file:
        file.write(SEAL + _sum(file, path.stat().st_size))


def is_sealed(path: Path) -> bool:
    """Tell whether a file ends as `seal` leaves one, which says nothing of the rest."""
    with path.open("rb") as file:
        return _seal_of(file, path.stat().st_size) is not None


def check_sealed(path: Path) -> None:
    """Refuse a file that is not, to the bit, as it was sealed, by a `ValueError`, before HDF5 reads it.

    HDF5 checks no numbers: another bit is another number, or a search without end in its own tables.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        sealed = _seal_of(file, size)
        if sealed is None:
            raise ValueError("its check sum is missing: it was cut, rewritten, or an older strikewave wrote it")
        file.seek(0)
        if _sum(file, size - len(SEAL) - SUM) != sealed:
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


LARGEST_LOAD = 4_000_000_000  # chosen: most machines hold it in memory, and a damaged head may claim anything
"""Bytes of a file of a result above which it is refused."""


class Variable(NamedTuple):
    """An array: the names of its dimensions, its values, and its attributes, such as ``units``."""

    dims: tuple[str, ...]
    values: Any
    attrs: Mapping[str, Any]


def quantity(dimension: Any, values: Any, unit: str, name: str) -> tuple[Any, Any, dict[str, str]]:
    """Return a variable of a dataset with its unit and name."""
    return dimension, values, {"units": unit, "long_name": name}


@dataclass(frozen=True, eq=False)
class LabelledArrays:
    """Variables, coordinates and attributes by name, as in an xarray Dataset, which `to_xarray` makes of them."""

    data_vars: dict[str, Variable]
    coords: dict[str, Variable] = field(default_factory=dict)
    attrs: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(
        cls, variables: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any]
    ) -> LabelledArrays:
        """Gather variables given as (dimensions, values[, attributes]); one named as its dimension is a coordinate.

        Examples
        --------
        >>> arrays = LabelledArrays.of({"f": quantity("time", [0.0, 1.0], "N", "f")}, {"time": ("time", [0, 1])}, {})
        >>> arrays["f"].values.tolist(), arrays["f"].attrs["units"], arrays.sizes
        ([0.0, 1.0], 'N', {'time': 2})
        """
        data_vars: dict[str, Variable] = {}
        coords = {name: _variable(*parts) for name, parts in coordinates.items()}
        for name, parts in variables.items():
            variable = _variable(*parts)
            (coords if variable.dims == (name,) else data_vars)[name] = variable
        return cls(data_vars, coords, dict(attributes))

    @classmethod
    def of_xarray(cls, data: xarray.Dataset) -> LabelledArrays:
        """Return the arrays of a dataset."""
        data_vars, coords = (
            {str(name): Variable(tuple(map(str, one.dims)), one.values, dict(one.attrs)) for name, one in group.items()}
            for group in (data.data_vars, data.coords)
        )
        return cls(data_vars, coords, dict(data.attrs))

    def __getitem__(self, name: str) -> Variable:
        """Return a variable or a coordinate by its name."""
        return self.data_vars[name] if name in self.data_vars else self.coords[name]

    def __contains__(self, name: object) -> bool:
        """Tell whether there is one of this name."""
        return name in self.data_vars or name in self.coords

    @property
    def variables(self) -> dict[str, Variable]:
        """All of them, coordinates last."""
        return {**self.data_vars, **self.coords}

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension."""
        sizes: dict[str, int] = {}
        for variable in self.variables.values():
            sizes.update(zip(variable.dims, variable.values.shape, strict=True))
        return sizes

    def with_attributes(self, attributes: Mapping[str, Any]) -> LabelledArrays:
        """Return the same arrays with more attributes."""
        return LabelledArrays(self.data_vars, self.coords, {**self.attrs, **attributes})

    def to_xarray(self) -> xarray.Dataset:
        """Return a dataset that shares the arrays."""
        import xarray

        return xarray.Dataset(self.data_vars, self.coords, self.attrs)

    def write(self, path: Path) -> None:
        """Write them as NetCDF, the file that xarray would write of the dataset."""
        import h5netcdf
        import h5py

        with enduring_file(path) as disk, h5netcdf.File(disk, "w") as file:
            file.dimensions = self.sizes
            for name, (dims, values, attrs) in self.variables.items():
                kind = h5py.string_dtype() if values.dtype.kind in "OU" else values.dtype
                missing = values.dtype.type(np.nan) if values.dtype.kind == "f" else None
                variable = file.create_variable(name, dims, kind, fillvalue=missing)
                _attach(variable.attrs, attrs.items())
                if values.size:
                    variable[...] = values
            _attach(file.attrs, self.attrs.items())


@contextlib.contextmanager
def open_result(path: Path, allowed: str) -> Iterator[xarray.Dataset]:
    """Open the NetCDF file of a result, and refuse others: ``allowed`` describes the file that is needed.

    Refused is a file that is not as it was written, takes more than 4 GB in memory, or raises an error in the block.
    """
    import xarray

    try:
        check_sealed(path)
        with xarray.open_dataset(path, engine="h5netcdf") as opened:
            if opened.nbytes > LARGEST_LOAD:
                raise InputError("solution", path, "a file of at most 4 GB in memory")
            yield opened
    except InputError:
        raise
    except Exception as error:  # whatever a damaged file makes the readers raise
        raise InputError("solution", path, allowed, f"it cannot be read ({error})") from error


def _variable(dims: Any, values: Any, attrs: Mapping[str, Any] | None = None) -> Variable:
    return Variable((dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), dict(attrs or {}))


def _attach(target: Any, attributes: Iterable[tuple[str, Any]]) -> None:
    for name, value in attributes:
        target[name] = np.asarray(value) if isinstance(value, int | float) else value
