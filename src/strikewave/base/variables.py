"""Arrays with names, units and dimensions, as an xarray Dataset holds them, made and written without importing it.

xarray takes a third of a second to import, pandas with it: a run, its page and its NetCDF file need neither.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.hdf5_files import check_sealed, enduring_file

if TYPE_CHECKING:
    import xarray


LARGEST_LOAD = 4_000_000_000
"""A file of a result that would take more bytes than this is refused."""


class Variable(NamedTuple):
    """An array: the names of its dimensions, its values, and what is said of it, such as ``units``."""

    dims: tuple[str, ...]
    values: Any
    attrs: Mapping[str, Any]


def quantity(dimension: Any, values: Any, unit: str, name: str) -> tuple[Any, Any, dict[str, str]]:
    """Return a variable of a dataset with its unit and name."""
    return dimension, values, {"units": unit, "long_name": name}


@dataclass(frozen=True, eq=False)
class LabelledArrays:
    """Variables and coordinates by name, named as in an xarray Dataset, which `to_xarray` makes of them.

    Attributes
    ----------
    data_vars : dict of str to Variable
        Those that are no coordinates.
    coords : dict of str to Variable
        The places along a dimension, by its name.
    attrs : dict
        What is said of all.
    """

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
        named = {name: _variable(*given) for name, given in variables.items()}
        along = {name: one for name, one in named.items() if one.dims == (name,)}
        data_vars = {name: one for name, one in named.items() if name not in along}
        coords = {name: _variable(*given) for name, given in coordinates.items()} | along
        return cls(data_vars, coords, dict(attributes))

    @classmethod
    def of_xarray(cls, data: xarray.Dataset) -> LabelledArrays:
        """Return what a dataset holds."""

        def held(variables: Mapping[Any, Any]) -> dict[str, Variable]:
            return {
                str(name): Variable(tuple(map(str, one.dims)), one.values, dict(one.attrs))
                for name, one in variables.items()
            }

        return cls(held(data.data_vars), held(data.coords), dict(data.attrs))

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
        """How long each dimension is."""
        return {dim: n for one in self.variables.values() for dim, n in zip(one.dims, one.values.shape, strict=True)}

    def with_attributes(self, attributes: Mapping[str, Any]) -> LabelledArrays:
        """Return the same arrays with more said of them all."""
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
    """Open the NetCDF file of a result, and refuse what is none: ``allowed`` are the words for what it is to be.

    Raises
    ------
    InputError
        If it is not as it was written, takes more than 4 GB in memory, or what is done with it raises whatever a
        damaged file may.
    """
    import xarray

    try:
        check_sealed(path)
        with xarray.open_dataset(path, engine="h5netcdf") as opened:
            if opened.nbytes > LARGEST_LOAD:
                raise InputError("solution", str(path), "a file of at most 4 GB in memory")
            yield opened
    except InputError:
        raise
    except Exception as error:  # whatever a damaged file makes the readers raise
        raise InputError("solution", str(path), allowed, f"it cannot be read ({error})") from error


def _variable(dims: Any, values: Any, attrs: Mapping[str, Any] | None = None) -> Variable:
    return Variable((dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), dict(attrs or {}))


def _attach(target: Any, attributes: Iterable[tuple[str, Any]]) -> None:
    for name, value in attributes:
        target[name] = np.asarray(value) if isinstance(value, int | float) else value
