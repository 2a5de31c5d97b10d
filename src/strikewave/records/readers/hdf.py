"""HDF5: plain files, NetCDF-4, MATLAB 7.3 and tables of pandas; links that leave the file are not followed.

The file is read in a child process with limits, as damaged ones can keep the HDF5 library busy for ever.

NetCDF-4 is HDF5; its classic form (CDF-1 and CDF-2) is read here too.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options, common
from strikewave.records.readers.child import isolated
from strikewave.records.readers.headings import is_time
from strikewave.records.record import Record

DEEPEST = 16  # groups in groups: measured files have three or four, and a hostile one could nest for ever
MOST_ATTRIBUTES = 200  # attributes of a group or array that are read: rates, units and scales are among the first few
# First bytes of HDF5, at the beginning or after a user block of 512 bytes or twice as many and so on
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def sniff_hdf(head: bytes) -> bool:
    """Return whether a file begins like HDF5, perhaps behind a user block."""
    return any(head[at : at + 8] == _SIGNATURE for at in (0, 512, 1024, 2048, 4096))


def read_hdf(path: Path, options: Options) -> Record:
    """Read the 1-D arrays, narrow tables and numeric fields of an HDF5 file."""
    return isolated("hdf", path, options)


def parse_hdf(path: Path, options: Options) -> Record:
    """Read an HDF5 file in this process."""
    h5py = importlib.import_module("h5py")
    columns: list[common.ArrayColumn] = []
    skipped: list[str] = []
    attributes: dict[str, list[tuple[str, Any]]] = {}
    with h5py.File(path, "r") as file:
        attributes[""] = _attributes(file)
        for count, (folder, name, data) in enumerate(_datasets(file, h5py), start=1):
            common.check_count(path, count)
            if data.size == 1 and data.dtype.kind in "biuf":
                attributes.setdefault(folder, _attributes(data.parent)).append((name, data[()]))
            elif dataset_columns := _columns(path, folder, name, data):
                columns += dataset_columns
            else:
                skipped.append(f"{folder}{name}")
        for folder in {column.folder for column in columns} - set(attributes):
            attributes[folder] = _attributes(file[folder])
        return common.assemble(
            path,
            "hdf",
            common.on_grids(columns, attributes),
            options,
            common.grid_of(attributes[""]),
            common.left_out(skipped),
        )


def _datasets(group: Any, h5py: Any, folder: str = "", depth: int = 0) -> Iterator[tuple[str, str, Any]]:
    """Yield the datasets of a group that lie in the file itself, each once."""
    if depth > DEEPEST:
        return
    for name in list(group)[: common.MOST_ARRAYS + 1]:
        link = group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink) or name == "#refs#":
            continue
        kind = group.get(name, getclass=True)
        if kind is h5py.Group:
            yield from _datasets(group[name], h5py, f"{folder}{name}/", depth + 1)
        elif kind is h5py.Dataset and _own(data := group[name]):
            yield folder, name, data


def _own(data: Any) -> bool:
    """Return whether a dataset holds numbers, in this file."""
    return (
        data.shape is not None
        and not data.is_virtual
        and not data.external
        and data.dtype.kind in "biufV"
        and not data.dtype.hasobject
    )


def _columns(path: Path, folder: str, name: str, data: Any) -> list[common.ArrayColumn]:
    """Return what a dataset holds; nothing for coordinates without time, text and arrays of more dimensions."""
    named = dict(_attributes(data))
    scale = common.text(named.get("CLASS")) == "DIMENSION_SCALE"
    if data.size == 0 or common.text(named.get("MATLAB_class")) == "char" or (scale and not is_time(name, "")):
        return []
    if data.chunks:
        common.guard(path, float(np.prod(data.chunks, dtype=np.float64)) * data.dtype.itemsize)
    if data.dtype.kind == "V":
        return _fields(folder, name, data)
    names = _block_names(data)
    step, start = common.grid_of(named.items())
    index = name == "axis1" and data.dtype.kind == "f"
    scaled = common.Scaled(lambda key: data.astype(np.float64)[key], data.attrs.get, data.shape)
    columns = common.array_columns(folder + name, scaled, _unit(named), folder, step=step, start=start, time=index)
    return [c._replace(name=folder + names[k] if len(names) == len(columns) else c.name) for k, c in enumerate(columns)]


def _fields(folder: str, name: str, data: Any) -> list[common.ArrayColumn]:
    """Return the numeric fields of a table."""
    columns: list[common.ArrayColumn] = []
    place = f"{folder}{name}/"
    for field in (data.dtype.names or ())[: common.MOST_COLUMNS]:
        kind = data.dtype[field]
        if len(data.shape) == 1 and kind.base.kind in "biuf" and len(kind.shape) <= 1:
            index = field == "index" and kind.base.kind == "f"
            columns += common.array_columns(place + field, _Field(data, field), folder=place, time=index)
    return columns


class _Field:
    """Slices of one field of a table."""

    def __init__(self, data: Any, field: str) -> None:
        self.data, self.field = data, field
        self.shape = data.shape + data.dtype[field].shape

    def __getitem__(self, key: Any) -> Any:
        return self.data.fields(self.field)[()][key]


def _block_names(data: Any) -> list[str]:
    """Return the column names that pandas keeps beside a block of values."""
    name = data.name.rpartition("/")[2]
    beside = name.removesuffix("_values") + "_items"
    if not name.endswith("_values") or type(data.parent.get(beside, getlink=True)).__name__ != "HardLink":
        return []
    items = data.parent[beside]
    if not hasattr(items, "shape") or items.dtype.kind != "S" or items.size > common.MOST_COLUMNS:
        return []
    return [common.text(value) for value in items[()]]


def _attributes(node: Any) -> list[tuple[str, Any]]:
    """Return the attributes that can be read."""
    attributes = []
    for name in list(node.attrs)[:MOST_ATTRIBUTES]:
        try:
            attributes.append((name, node.attrs[name]))
        except (OSError, TypeError, ValueError, RuntimeError, KeyError):
            continue
    return attributes


def _unit(named: dict[str, Any]) -> str:
    return next((common.text(named[name]) for name in ("units", "unit", "Units", "Unit") if name in named), "")


def sniff_netcdf(head: bytes) -> bool:
    """Return whether a file begins like classic NetCDF."""
    return head[:4] in (b"CDF\x01", b"CDF\x02")


def read_netcdf(path: Path, options: Options) -> Record:
    """Read the 1-D variables and narrow tables of a classic NetCDF file."""
    from scipy.io import netcdf_file

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=RuntimeWarning, module=r"scipy\.io")
        with netcdf_file(path, "r", mmap=True) as file:
            columns: list[common.ArrayColumn] = []
            skipped, scalars = [], list(vars(file).get("_attributes", {}).items())
            for name, variable in file.variables.items():
                numeric = variable.data.dtype.kind in "iuf"
                if numeric and not variable.data.shape:
                    scalars.append((name, variable.data[()]))
                    continue
                own = variable._attributes
                step, start = common.grid_of(own.items())
                unit = common.text(own.get("units", own.get("unit")))
                variable_columns = (
                    common.array_columns(name, _scaled(variable.data, own), unit, step=step, start=start)
                    if numeric
                    else []
                )
                columns += variable_columns
                skipped += [name] * (not variable_columns)
            record = common.assemble(
                path, "netcdf", columns, options, common.grid_of(scalars), common.left_out(skipped)
            )
            del variable, columns, variable_columns
            return record


def _scaled(data: Any, attributes: dict[str, Any]) -> common.Scaled:
    return common.Scaled(lambda key: np.array(data[key], np.float64), attributes.get, data.shape)
