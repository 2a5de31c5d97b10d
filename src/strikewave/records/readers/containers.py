"""Named arrays in groups: HDF5 with NetCDF-4, MATLAB 7.3 and pandas; classic NetCDF; MATLAB 4 to 7.

HDF5 is read in a child process with limits, as damaged files can keep its library busy for ever; links that leave the
file are not followed. MATLAB's older layout is that of "MAT-File Format" (The MathWorks, 2024), read in plain Python:
a file whose cells nest without end breaks down readers that follow them.
"""

from __future__ import annotations

import importlib
import struct
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

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


DEEPEST_STRUCT = 8  # structs in structs: measured files have two or three, and a hostile one could nest for ever
# NumPy's types by the numbers of MATLAB's
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_MATRIX, _COMPRESSED = 14, 15  # types of elements that hold an array, and one that is packed
_STRUCT, _NUMBERS, _COMPLEX = 2, range(6, 16), 0x0800  # classes of arrays, and the flag of complex ones
_OLD_TYPES = ("f8", "f4", "i4", "i2", "u2", "u1")  # numPy's types by the third digit of the type of version 4


class _Variable(NamedTuple):
    folder: str
    name: str
    array: Any


def sniff_mat(head: bytes) -> bool:
    """Return whether a file begins like a MATLAB file of version 4 to 7."""
    if len(head) >= 128 and head[124:128] in (b"\x00\x01IM", b"\x01\x00MI"):
        return True
    return _old_head(head, 0) is not None


def read_mat(path: Path, options: Options) -> Record:
    """Read the numeric arrays of a MATLAB file, those in structs too."""
    content = memoryview(np.memmap(path, np.uint8, "r"))  # type: ignore[arg-type]
    skipped: list[str] = []
    arrays: list[_Variable] = []
    new = content[124:128].tobytes() in (b"\x00\x01IM", b"\x01\x00MI")
    for variable in _variables(path, content, skipped) if new else _old_variables(path, content):
        arrays.append(variable)
        common.check_count(path, len(arrays) + len(skipped))
    scalars: dict[str, list[tuple[str, Any]]] = {"": []}
    columns = []
    for folder, name, array in arrays:
        if array.size == 1:
            scalars.setdefault(folder, []).append((name, array))
        elif fresh := common.array_columns(folder + name, array, folder=folder):
            columns += fresh
        else:
            skipped.append(folder + name)
    return common.assemble(
        path, "mat", common.on_grids(columns, scalars), options, common.grid_of(scalars[""]), common.left_out(skipped)
    )


def _variables(path: Path, content: memoryview, skipped: list[str]) -> Iterator[_Variable]:
    """Yield the arrays of versions 5 to 7."""
    order = "<" if content[126:128].tobytes() == b"IM" else ">"
    at = 128
    while at + 8 <= len(content):
        kind, size = struct.unpack(order + "II", content[at : at + 8])
        body = content[at + 8 : at + 8 + size]
        if len(body) < size:
            raise common.damaged(path, "it ends within an array")
        if kind == _COMPRESSED:
            kind, body = _unpacked(path, body, order)
        if kind == _MATRIX:
            yield from _matrix(path, body, order, "", None, skipped, 0)
        at += 8 + size


def _unpacked(path: Path, body: memoryview, order: str) -> tuple[int, memoryview]:
    """Return kind and content of a compressed element, never more of it than it claims and than fits."""
    stream = zlib.decompressobj()
    head = stream.decompress(body, 8)
    if len(head) < 8:
        raise common.damaged(path, "a compressed array is empty")
    kind, size = struct.unpack(order + "II", head)
    common.guard(path, size)
    rest = stream.decompress(stream.unconsumed_tail, max(size, 1))
    return kind, memoryview(rest)


def _elements(body: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Yield kind and content of the parts of an array."""
    at = 0
    while at + 8 <= len(body):
        kind, size = struct.unpack(order + "II", body[at : at + 8])
        if kind >> 16:
            yield kind & 0xFFFF, body[at + 4 : at + 4 + min(kind >> 16, 4)]
            at += 8
        else:
            yield kind, body[at + 8 : at + 8 + size]
            at += 8 + size + -size % 8


def _matrix(
    path: Path, body: memoryview, order: str, folder: str, field: str | None, skipped: list[str], depth: int
) -> Iterator[_Variable]:
    """Yield the numbers of one array, or of the fields of one struct."""
    parts = _elements(body, order)
    try:
        flags = struct.unpack(order + "I", next(parts)[1][:4])[0]
        shape = tuple(np.frombuffer(next(parts)[1], order + "i4").tolist())
        own = next(parts)[1].tobytes().decode("ascii", "replace")
    except StopIteration:
        return
    name, kind = field if field is not None else own, flags & 0xFF
    count = float(np.prod(shape, dtype=np.float64))
    if kind == _STRUCT and count == 1.0 and depth < DEEPEST_STRUCT:
        length = int(np.frombuffer(next(parts)[1], order + "i4")[0])
        names = next(parts)[1].tobytes()
        for k, (inner, part) in enumerate(parts):
            called = names[k * length : (k + 1) * length].split(b"\0")[0].decode("ascii", "replace")
            if inner == _MATRIX and called and length > 0:
                yield from _matrix(path, part, order, f"{folder}{name}/", called, skipped, depth + 1)
    elif kind in _NUMBERS and not flags & _COMPLEX and (stored := next(parts, (0, body))) and stored[0] in _TYPES:
        numbers = np.frombuffer(stored[1], order + _TYPES[stored[0]])
        if numbers.size != count:
            raise common.damaged(path, f"{numbers.size} numbers for a shape of {shape}")
        if numbers.size:
            yield _Variable(folder, name, numbers.reshape(shape, order="F"))
    else:
        skipped.append(folder + name)


def _old_head(content: Any, at: int) -> tuple[str, tuple[int, int], int, bool, int] | None:
    """Return type, shape, place of the name, whether complex, and length of the name, for an array of version 4."""
    if len(content) < at + 24:
        return None
    for order in "<>":
        form, rows, across, imaginary, length = struct.unpack(order + "5i", bytes(content[at : at + 20]))
        thousands, rest = divmod(form, 1000)
        fits = thousands == "<>".index(order) and rest % 10 == 0 and rest // 10 < len(_OLD_TYPES)
        if not fits or imaginary not in (0, 1) or not 1 < length < 256 or min(rows, across) < 0:
            continue
        name = bytes(content[at + 20 : at + 20 + length])
        if name[-1:] == b"\0" and name[:-1].isascii() and name[:-1].decode("ascii").isidentifier():
            return order + _OLD_TYPES[rest // 10], (rows, across), at + 20, bool(imaginary), length
    return None


def _old_variables(path: Path, content: memoryview) -> Iterator[_Variable]:
    """Yield the arrays of version 4."""
    at = 0
    while at < len(content):
        if (head := _old_head(content, at)) is None:
            raise common.damaged(path, f"no array begins at byte {at}")
        kind, shape, begin, imaginary, length = head
        name = bytes(content[begin : begin + length - 1]).decode("ascii")
        size = shape[0] * shape[1] * np.dtype(kind).itemsize
        begin += length
        if begin + size > len(content):
            raise common.damaged(path, "it ends within an array")
        if size and not imaginary:
            yield _Variable("", name, np.frombuffer(content[begin : begin + size], kind).reshape(shape, order="F"))
        at = begin + size * (2 if imaginary else 1)
