"""Fields over time in one VTKHDF file, which ParaView and VTK open as they are.

The file follows the VTKHDF specification 2.0 for an unstructured grid over time whose geometry does not change: the
mesh stands there once, before the blow, and every step points at it (all geometry offsets are 0), while the offsets
of its fields grow. What moves is the field ``displacement``: "warp by vector" shows the deformed parts. A stress of
six components is read by VTK as a symmetric tensor xx yy zz xy yz xz, the order of `FieldFrame`.

Fields are kept in single precision (seven digits, half the room); times and the mesh in double precision. Memory is
that of one frame; each frame is on the disk when `FieldWriter.add` returns.

Source: VTK documentation, "VTKHDF file format", docs.vtk.org.
"""

from __future__ import annotations

import contextlib
import importlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from strikewave.base.datasets import EnduringFile
from strikewave.base.errors import InputError, refusal
from strikewave.fem.run import FieldFrame
from strikewave.fem.solids import pressure, von_mises

if TYPE_CHECKING:
    from strikewave.fem.mesh import Mesh

VERSION = (2, 0)  # the first with steps in time, which ParaView reads from 5.12 on
"""Version of the specification of VTKHDF."""
HEXAHEDRON = 12
"""VTK's number of an 8-node hexahedron, whose nodes stand in the order of `strikewave.fem.mesh`."""
MOST_ROWS = 32768  # at six components 768 KiB, within HDF5's cache of 1 MiB
"""Most rows of a chunk."""
FEW_ROWS = 1024  # 8 KiB, about the frames of a run
"""Rows of a chunk of tables that have one row each step."""
LONGEST_HINT = 200  # a line or two
"""Most characters of another library's message in an error."""
MOST_FRAMES = 1_000_000  # five times the instants of the longest histories
"""Most frames that a file may claim to hold."""
MOST_NODES = 20_000_000  # several times the largest mesh; bounds the memory of reading one
"""Most nodes or elements that a file may claim to hold."""


class Field(NamedTuple):
    """A field of the file: its group, name, components and unit, and its values of a frame."""

    home: str
    name: str
    components: int
    unit: str
    of: Callable[[FieldFrame], NDArray[np.float64]]


FIELDS = (
    Field("PointData", "displacement", 3, "m", lambda frame: frame.displacement),
    Field("PointData", "velocity", 3, "m/s", lambda frame: frame.velocity),
    Field("CellData", "stress", 6, "Pa", lambda frame: frame.stress),
    Field("CellData", "von_mises_stress", 1, "Pa", lambda frame: von_mises(frame.stress)),
    Field("CellData", "pressure", 1, "Pa", lambda frame: pressure(frame.stress)),
    Field("CellData", "equivalent_plastic_strain", 1, "1", lambda frame: frame.plastic_strain),
)
"""Fields written of each frame."""


class FieldWriter:
    """Writes frames, one at a time, into a file that takes its name once it is closed.

    Until then it is ``NAME.part`` beside it, and can be taken up again by `restored`. Used as a context, an error
    leaves that part where it is and an older file under the name untouched.
    """

    def __init__(self, path: Path, mesh: Mesh) -> None:
        self._begin(path, mesh)
        try:
            with self._reported():
                self._open("w")
                _write_mesh(self._file, mesh)
                self._file.flush()
        except BaseException:
            self.abandon()  # left open, HDF5 would write at the end of the process, into a file that is gone
            raise

    @classmethod
    def restored(cls, path: Path, mesh: Mesh, before: float) -> Self:
        """Take up a file again: its part if there is one, else a copy of the finished file.

        Frames from the time ``before`` on, s, are dropped.
        """
        writer = cls.__new__(cls)
        writer._begin(path, mesh)
        try:
            with writer._reported():
                if not writer._partial.exists():
                    shutil.copyfile(path, writer._partial)
                writer._open("r+")
            with writer._reported():
                grid = _checked_grid(path, writer._file)
                _check_same_mesh(path, grid, mesh)
                times = grid["Steps/Values"][: writer.frames_of(grid)]
                writer._keep(int(np.searchsorted(times, before)))
                _check_whole(path, grid)
        except BaseException:
            writer.abandon()
            raise
        return writer

    def _begin(self, path: Path, mesh: Mesh) -> None:
        self.path = path
        self.frames = 0
        self._partial = path.with_name(path.name + ".part")
        self._disk: EnduringFile | None = None
        self._file: Any = None
        self._sizes = {"PointData": len(mesh.points), "CellData": len(mesh.hexahedra)}

    def _open(self, mode: str) -> None:
        self._disk = EnduringFile(self._partial, "w+" if mode == "w" else mode)
        self._file = _opened(self._disk, mode)

    @staticmethod
    def frames_of(grid: Any) -> int:
        """Return how many whole frames a VTKHDF group holds."""
        return int(grid["Steps"].attrs["NSteps"])

    def _keep(self, frames: int) -> None:
        """Cut everything behind so many frames."""
        grid = self._file["VTKHDF"]
        self.frames = frames
        grid["Steps"].attrs["NSteps"] = np.int64(frames)
        for field in FIELDS:
            grid[f"{field.home}/{field.name}"].resize(frames * self._sizes[field.home], axis=0)
        for table in _tables(grid["Steps"]):
            table.resize(frames, axis=0)
        self._file.flush()

    def add(self, frame: FieldFrame) -> None:
        """Append a frame; it is on the disk on return."""
        grid = self._file["VTKHDF"]
        steps = grid["Steps"]
        if self.frames and not frame.time > (last := float(steps["Values"][self.frames - 1])):
            raise InputError("frame.time", frame.time, f"after the frame before it, {last:g} s")
        values = [np.asarray(field.of(frame), np.float32) for field in FIELDS]
        for field, rows in zip(FIELDS, values, strict=True):
            if len(rows) != self._sizes[field.home]:
                raise InputError(f"frame.{field.name}", len(rows), f"{self._sizes[field.home]} rows, as the mesh has")
        with self._reported():
            for field, rows in zip(FIELDS, values, strict=True):
                _append(grid[f"{field.home}/{field.name}"], rows, self.frames * len(rows))
                offsets = steps[f"{field.home}Offsets/{field.name}"]
                _append(offsets, np.array([self.frames * len(rows)]), self.frames)
            for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "CellDataOffsets/part"):
                _append(steps[name], np.array([0]), self.frames)
            _append(steps["NumberOfParts"], np.array([1]), self.frames)
            _append(steps["Values"], np.array([frame.time]), self.frames)
            self.frames += 1
            steps.attrs["NSteps"] = np.int64(self.frames)
            self._file.flush()

    def close(self) -> None:
        """Finish the file and give it its name."""
        with self._reported():
            self.abandon()
        with self._reported():
            self._partial.replace(self.path)

    def abandon(self) -> None:
        """Leave the file as a part, to be taken up by `restored`."""
        if self._file is not None:
            self._file.close()
        if self._disk is not None:
            self._disk.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if kind is None:
            self.close()
        else:
            self.abandon()

    @contextlib.contextmanager
    def _reported(self) -> Iterator[None]:
        """Turn an error of the disk into an `InputError`."""
        try:
            try:
                yield
            finally:
                if self._disk is not None:
                    self._disk.check()
        except OSError as error:
            allowed = "a place that can be written, with room"
            raise InputError("FILE", self.path, allowed, refusal(error, self.path)) from error


def stored_frames(path: Path) -> Iterator[FieldFrame]:
    """Yield the frames of a file, one in memory at a time, in the file's single precision."""
    try:
        file = _opened(path, "r")
    except OSError as error:
        raise InputError("FILE", path, "a VTKHDF file", error.strerror or str(error)) from None
    with file:
        grid = _checked_grid(path, file)
        points, cells = len(grid["Points"]), len(grid["Types"])
        times = grid["Steps/Values"]
        for k in range(FieldWriter.frames_of(grid)):
            at_nodes, at_cells = (slice(k * n, (k + 1) * n) for n in (points, cells))
            yield FieldFrame(
                float(times[k]),
                grid["PointData/displacement"][at_nodes].astype(float),
                grid["PointData/velocity"][at_nodes].astype(float),
                grid["CellData/stress"][at_cells].astype(float),
                grid["CellData/equivalent_plastic_strain"][at_cells].astype(float),
            )


def _opened(place: Path | EnduringFile, mode: str) -> Any:
    return _h5py().File(place, mode)


def _h5py() -> Any:
    return importlib.import_module("h5py")  # it has no types


def _write_mesh(file: Any, mesh: Mesh) -> None:
    """Write the geometry, and empty tables for all that comes with the frames."""
    grid = file.create_group("VTKHDF")
    grid.attrs["Version"] = np.array(VERSION, np.int64)
    grid.attrs["Type"] = np.bytes_("UnstructuredGrid")  # ASCII of fixed length, as readers expect
    cells = len(mesh.hexahedra)
    for name, count in (("Points", len(mesh.points)), ("Cells", cells), ("ConnectivityIds", 8 * cells)):
        grid[f"NumberOf{name}"] = np.array([count], np.int64)
    _packed(grid, "Points", mesh.points)
    _packed(grid, "Connectivity", mesh.hexahedra.reshape(-1).astype(np.int64))
    _packed(grid, "Offsets", 8 * np.arange(cells + 1, dtype=np.int64))
    _packed(grid, "Types", np.full(cells, HEXAHEDRON, np.uint8))
    _packed(grid, "CellData/part", mesh.part)
    grid["CellData/part"].attrs["names"] = list(mesh.names)
    steps = grid.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(0)
    _growing(steps, "Values", np.float64)
    places = ("PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets")
    for name in (*places, "CellDataOffsets/part"):
        _growing(steps, name, np.int64)
    sizes = {"PointData": len(mesh.points), "CellData": cells}
    for field in FIELDS:
        _growing(steps, f"{field.home}Offsets/{field.name}", np.int64)
        data = _growing(grid, f"{field.home}/{field.name}", np.float32, field.components, sizes[field.home])
        data.attrs["unit"] = field.unit


def _packed(group: Any, name: str, values: NDArray[Any]) -> None:
    group.create_dataset(name, data=values, compression="gzip", compression_opts=1, shuffle=True)


def _growing(group: Any, name: str, kind: type, components: int = 1, rows: int = FEW_ROWS) -> Any:
    """Begin an empty table of so many components, a step of ``rows`` in as few equal chunks as it takes."""
    across = () if components == 1 else (components,)
    chunk = -(-rows // -(-rows // MOST_ROWS))
    packing: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    return group.create_dataset(
        name, (0, *across), dtype=kind, maxshape=(None, *across), chunks=(max(chunk, 1), *across), **packing
    )


def _append(table: Any, rows: NDArray[Any], at: int) -> None:
    table.resize(at + len(rows), axis=0)
    table[at:] = rows


def _tables(steps: Any) -> Iterator[Any]:
    """Yield the tables of a row each step."""
    for name in steps:
        if name.endswith("DataOffsets"):
            yield from (steps[name][inner] for inner in steps[name])
        else:
            yield steps[name]


def _checked_grid(path: Path, file: Any) -> Any:
    """Return the group of a file after checking that all we read stands in it, in this file, in the right shape."""
    try:
        times = _own(file, "Steps/Values")
        grid = file["VTKHDF"]
        frames = FieldWriter.frames_of(grid)
        if not 0 <= frames <= min(times, MOST_FRAMES):
            raise ValueError(f"it claims {frames} frames")
        sizes = {"PointData": _own(file, "Points", 3), "CellData": _own(file, "Types")}
        if max(sizes.values()) > MOST_NODES:
            raise ValueError(f"it claims more than {MOST_NODES} nodes or elements")
        if _own(file, "Connectivity") != 8 * sizes["CellData"]:
            raise ValueError("its cells are not hexahedra")
        for field in FIELDS:
            if _own(file, f"{field.home}/{field.name}", field.components) < frames * sizes[field.home]:
                raise ValueError(f"{field.name} is shorter than its {frames} frames")
            _own(file, f"Steps/{field.home}Offsets/{field.name}")
    except (KeyError, ValueError, TypeError, AttributeError, OSError, RuntimeError) as error:
        raise InputError("FILE", path, "fields as strikewave writes them, whole", str(error)[:LONGEST_HINT]) from None
    return grid


def _own(file: Any, name: str, components: int = 1) -> int:
    """Return the rows of a table that lies in the file itself and has so many components."""
    h5py, place = _h5py(), file
    for step in ("VTKHDF", *name.split("/")):
        if not isinstance(place.get(step, getlink=True), h5py.HardLink):
            raise ValueError(f"{name} is missing or lies elsewhere")
        place = place[step]
    across = () if components == 1 else (components,)
    inside = isinstance(place, h5py.Dataset) and not place.is_virtual and not place.external
    if not inside or place.dtype.kind not in "iuf" or place.shape[1:] != across:
        raise ValueError(f"{name} is not a table of numbers in the shape it should have")
    return int(place.shape[0])


def _check_whole(path: Path, grid: Any) -> None:
    """Refuse fields that cannot be unpacked: each chunk has a check sum, by gzip."""
    for field in FIELDS:
        table = grid[f"{field.home}/{field.name}"]
        try:
            for chunk in table.iter_chunks() if len(table) else ():
                table[chunk]
        except OSError as error:
            what = f"{field.name}: {error}"[:LONGEST_HINT]
            raise InputError("FILE", path, "fields as strikewave writes them, whole", what) from None


def _check_same_mesh(path: Path, grid: Any, mesh: Mesh) -> None:
    """Refuse a file of another mesh."""
    same = (
        grid["Points"].shape == mesh.points.shape
        and grid["Connectivity"].shape == (mesh.hexahedra.size,)
        and np.array_equal(grid["Points"][:], mesh.points)
        and np.array_equal(grid["Connectivity"][:], mesh.hexahedra.reshape(-1))
    )
    if not same:
        raise InputError("FILE", path, "fields of this mesh", "it belongs to another mesh; begin a new file")
