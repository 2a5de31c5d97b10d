"""The fields of a run as a VTKHDF file: what VTK reads, what the file holds, taking it up again, hostile files."""

import pickle
import subprocess
import sys

import h5py
import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.fem.run import FieldFrame
from strikewave.fem.solids import pressure, von_mises
from strikewave.fem.vtkhdf import FIELDS, FieldWriter, _growing, stored_frames

from . import synthetic


@pytest.fixture(scope="module")
def mesh():
    return synthetic.mesh()


@pytest.fixture(scope="module")
def frames(mesh):
    return synthetic.frames(mesh, 5)


def write(path, mesh, frames):
    with FieldWriter(path, mesh) as writer:
        for frame in frames:
            writer.add(frame)
    return path


@pytest.fixture
def written(tmp_path, mesh, frames):
    return write(tmp_path / "fields.vtkhdf", mesh, frames)


@pytest.fixture(scope="module")
def whole(tmp_path_factory, mesh, frames):
    return write(tmp_path_factory.mktemp("fields") / "fields.vtkhdf", mesh, frames).read_bytes()


@pytest.fixture
def copied(tmp_path, whole):
    """A file that was written once, for tests that spoil it."""
    path = tmp_path / "fields.vtkhdf"
    path.write_bytes(whole)
    return path


def single(values):
    return np.asarray(values, np.float32)


def test_vtks_own_reader_gives_back_every_array_of_every_step(written, mesh, frames):
    reader_module = pytest.importorskip("vtkmodules.vtkIOHDF", reason="VTK is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

    reader = reader_module.vtkHDFReader()
    reader.SetFileName(str(written))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())
    assert times == tuple(frame.time for frame in frames)
    for frame in (*frames, frames[2]):  # back again in time as well
        reader.UpdateTimeStep(frame.time)
        grid = reader.GetOutput()
        assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), mesh.points)
        assert np.array_equal(vtk_to_numpy(grid.GetCells().GetConnectivityArray()), mesh.hexahedra.ravel())
        assert {grid.GetCellType(k) for k in range(grid.GetNumberOfCells())} == {12}
        held = {"PointData": grid.GetPointData(), "CellData": grid.GetCellData()}
        assert np.array_equal(vtk_to_numpy(grid.GetCellData().GetArray("part")), mesh.part)
        for field in FIELDS:
            assert np.array_equal(vtk_to_numpy(held[field.home].GetArray(field.name)), single(field.of(frame)))


def test_vtk_finds_the_volume_of_the_mesh(written, mesh):
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    from strikewave.fem.mesh import volumes

    grid = pyvista.get_reader(str(written)).read()
    cells = grid.compute_cell_sizes(length=False, area=False).cell_data["Volume"]
    flat = mesh.elements_of("block")  # VTK splits cells into tetrahedra, exact for flat faces alone
    assert cells[flat] == pytest.approx(volumes(mesh.points, mesh.hexahedra)[flat], rel=1e-12)


def test_the_mesh_stands_once_and_offsets_of_fields_grow_as_the_specification_says(written, mesh, frames):
    points, cells, steps = len(mesh.points), len(mesh.hexahedra), len(frames)
    with h5py.File(written) as file:
        grid = file["VTKHDF"]
        assert tuple(grid.attrs["Version"]) == (2, 0)
        assert grid.attrs["Type"] == b"UnstructuredGrid"
        assert grid["Points"].shape == (points, 3)
        assert grid["NumberOfPoints"][:].tolist() == [points]
        assert grid["NumberOfCells"][:].tolist() == [cells]
        assert grid["NumberOfConnectivityIds"][:].tolist() == [8 * cells]
        assert grid["Offsets"][:].tolist() == list(range(0, 8 * cells + 1, 8))
        assert grid["Steps"].attrs["NSteps"] == steps
        for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "CellDataOffsets/part"):
            assert grid["Steps"][name][:].tolist() == [0] * steps
        assert grid["Steps/NumberOfParts"][:].tolist() == [1] * steps
        for field in FIELDS:
            rows = {"PointData": points, "CellData": cells}[field.home]
            assert len(grid[f"{field.home}/{field.name}"]) == rows * steps
            offsets = grid[f"Steps/{field.home}Offsets/{field.name}"]
            assert offsets[:].tolist() == [k * rows for k in range(steps)]
        assert list(grid["CellData/part"].attrs["names"]) == ["ball", "block"]


def test_frames_come_back_to_single_precision(written, frames):
    for read, frame in zip(stored_frames(written), frames, strict=True):
        assert read.time == frame.time
        for name in ("displacement", "velocity", "stress", "plastic_strain"):
            assert np.array_equal(single(getattr(read, name)), single(getattr(frame, name)))


def test_a_mesh_of_many_chunks_comes_back(tmp_path):
    mesh = synthetic.grid("bar", (0, 0, 0), (1, 1, 40), (2, 2, 4001))  # 36018 nodes: more than a chunk holds
    frames = [
        FieldFrame(float(k), *(np.random.default_rng(k).normal(size=(len(mesh.points), 3)) for _ in range(2)), *cells)
        for k in range(3)
        for cells in [(np.full((len(mesh.hexahedra), 6), float(k)), np.full(len(mesh.hexahedra), float(k)))]
    ]
    with FieldWriter(tmp_path / "bar.vtkhdf", mesh) as writer:
        for frame in frames:
            writer.add(frame)
    for read, frame in zip(stored_frames(tmp_path / "bar.vtkhdf"), frames, strict=True):
        assert np.array_equal(single(read.velocity), single(frame.velocity))
        assert np.array_equal(read.stress, frame.stress)


def test_the_name_appears_only_once_all_is_written(tmp_path, mesh, frames):
    path = tmp_path / "fields.vtkhdf"
    writer = FieldWriter(path, mesh)
    writer.add(frames[0])
    assert not path.exists()
    with h5py.File(tmp_path / "fields.vtkhdf.part") as file:  # what is added is on the disk
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 1
    writer.close()
    assert [entry.name for entry in tmp_path.iterdir()] == ["fields.vtkhdf"]


def test_an_error_keeps_the_old_file_and_leaves_a_part_to_take_up(written, mesh, frames):
    before = written.read_bytes()
    with pytest.raises(KeyboardInterrupt), FieldWriter(written, mesh) as writer:
        writer.add(frames[0])
        raise KeyboardInterrupt
    assert written.read_bytes() == before
    with FieldWriter.restored(written, mesh, before=1.0) as writer:
        assert writer.frames == 1
        writer.add(frames[1])
    assert [frame.time for frame in stored_frames(written)] == [frames[0].time, frames[1].time]


@pytest.mark.parametrize("kept", [0, 2, 5])
def test_a_run_taken_up_again_gives_the_same_file_as_one_that_never_stopped(tmp_path, written, mesh, frames, kept):
    before = frames[kept].time if kept < len(frames) else np.inf
    with FieldWriter.restored(written, mesh, before) as writer:
        assert writer.frames == kept
        for frame in frames[kept:]:
            writer.add(frame)
    again = tmp_path / "again.vtkhdf"
    with FieldWriter(again, mesh) as writer:
        for frame in frames:
            writer.add(frame)
    with h5py.File(written) as one, h5py.File(again) as other:
        found: list[str] = []
        one.visititems(lambda name, place: found.append(name) if isinstance(place, h5py.Dataset) else None)
        assert len(found) > 20
        for name in found:
            assert np.array_equal(one[name][:], other[name][:]), name


def test_a_killed_run_leaves_the_frames_that_it_added(tmp_path, mesh, frames, environment):
    path = tmp_path / "fields.vtkhdf"
    program = (
        "import os, pickle, sys\n"
        "from pathlib import Path\n"
        "from strikewave.fem.vtkhdf import FieldWriter\n"
        "mesh, frames = pickle.load(sys.stdin.buffer)\n"
        "writer = FieldWriter(Path(sys.argv[1]), mesh)\n"
        "for frame in frames: writer.add(frame)\n"
        "os.kill(os.getpid(), 9)\n"
    )
    given = pickle.dumps((mesh, frames[:3]))
    ended = subprocess.run([sys.executable, "-c", program, str(path)], input=given, env=environment, check=False)
    assert ended.returncode == -9
    with FieldWriter.restored(path, mesh, before=np.inf) as writer:
        assert writer.frames == 3
        writer.add(frames[3])
    assert [frame.time for frame in stored_frames(path)] == [frame.time for frame in frames[:4]]


def test_a_torn_last_frame_is_dropped(tmp_path, mesh, frames):
    path = tmp_path / "fields.vtkhdf"
    writer = FieldWriter(path, mesh)
    writer.add(frames[0])
    writer.abandon()
    with h5py.File(tmp_path / "fields.vtkhdf.part", "r+") as file:  # as a kill between fields and count leaves it
        file["VTKHDF/PointData/displacement"].resize(2 * len(mesh.points), axis=0)
    with FieldWriter.restored(path, mesh, before=1.0) as writer:
        writer.add(frames[1])
    first, second = stored_frames(path)
    assert np.array_equal(single(second.displacement), single(frames[1].displacement))
    assert first.time == frames[0].time


def test_frames_that_do_not_fit_are_refused(tmp_path, mesh, frames):
    other = synthetic.grid("block", (0, 0, 0), (1, 1, 1), (1, 1, 1))
    writer = FieldWriter(tmp_path / "fields.vtkhdf", mesh)
    writer.add(frames[1])
    with pytest.raises(InputError, match=r"frame\.time.*after the frame before it"):
        writer.add(frames[0])
    with pytest.raises(InputError, match=r"frame\.displacement.*rows"):
        writer.add(FieldFrame(1.0, np.zeros((8, 3)), np.zeros((8, 3)), np.zeros((1, 6)), np.zeros(1)))
    writer.close()
    with pytest.raises(InputError, match="another mesh"):
        FieldWriter.restored(tmp_path / "fields.vtkhdf", other, before=1.0)


def test_places_that_cannot_be_written_or_read_are_told(tmp_path, mesh):
    with pytest.raises(InputError, match="a place that can be written"):
        FieldWriter(tmp_path / "absent" / "fields.vtkhdf", mesh)
    with pytest.raises(InputError, match="cannot be used; needed: a place that can be written"):
        FieldWriter.restored(tmp_path / "absent.vtkhdf", mesh, before=1.0)
    with pytest.raises(InputError, match="a VTKHDF file"):
        next(stored_frames(tmp_path / "absent.vtkhdf"))


def _claims_too_much(file, elsewhere):
    file["VTKHDF/Steps"].attrs["NSteps"] = 10**15


def _claims_one_more(file, elsewhere):
    file["VTKHDF/Steps"].attrs["NSteps"] += 1


def _all_lies_elsewhere(file, elsewhere):
    file.move("VTKHDF", "other")
    file["VTKHDF"] = h5py.SoftLink("/other")


def _claims_many_nodes(file, elsewhere):
    del file["VTKHDF/Points"]
    file["VTKHDF"].create_dataset("Points", (10**9, 3), dtype="f8", chunks=(1024, 3))


def _lies_elsewhere(file, elsewhere):
    del file["VTKHDF/CellData/stress"]
    file["VTKHDF/CellData/stress"] = h5py.ExternalLink(str(elsewhere), "secret")


def _has_no_stress(file, elsewhere):
    del file["VTKHDF/CellData/stress"]


def _has_words(file, elsewhere):
    del file["VTKHDF/Steps/Values"]
    file["VTKHDF/Steps/Values"] = ["a"] * 5


def _has_no_steps(file, elsewhere):
    del file["VTKHDF/Steps"]


def _has_fewer_times(file, elsewhere):
    file["VTKHDF/Steps/Values"].resize(4, axis=0)


def _has_other_cells(file, elsewhere):
    short = file["VTKHDF/Connectivity"][:-1]
    del file["VTKHDF/Connectivity"]
    file["VTKHDF/Connectivity"] = short


def _has_flat_stress(file, elsewhere):
    rows = len(file["VTKHDF/CellData/stress"])
    del file["VTKHDF/CellData/stress"]
    file["VTKHDF/CellData/stress"] = np.zeros((rows, 5))


def _has_fewer_rows(file, elsewhere):
    table = file["VTKHDF/PointData/velocity"]
    table.resize(len(table) - 1, axis=0)


@pytest.mark.parametrize(
    "harm",
    [
        _has_fewer_times,
        _has_other_cells,
        _has_flat_stress,
        _has_fewer_rows,
        _claims_too_much,
        _claims_one_more,
        _claims_many_nodes,
        _lies_elsewhere,
        _all_lies_elsewhere,
        _has_no_stress,
        _has_words,
        _has_no_steps,
    ],
)
def test_a_hostile_file_is_refused(copied, tmp_path, mesh, harm):
    with h5py.File(tmp_path / "elsewhere.h5", "w") as file:
        file["secret"] = np.zeros((5 * len(mesh.hexahedra), 6))
    with h5py.File(copied, "r+") as file:
        harm(file, tmp_path / "elsewhere.h5")
    with pytest.raises(InputError, match="fields as strikewave writes them"):
        list(stored_frames(copied))
    with pytest.raises(InputError, match="fields as strikewave writes them"):
        FieldWriter.restored(copied, mesh, before=1.0)


def test_a_file_of_random_bytes_is_refused(tmp_path, rng):
    path = tmp_path / "noise.vtkhdf"
    path.write_bytes(rng.bytes(5000))
    with pytest.raises(InputError, match="a VTKHDF file"):
        list(stored_frames(path))


def test_invariants_do_not_hang_on_the_axes(rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tensor = rng.normal(size=(3, 3))
    tensor = tensor + tensor.T
    one, other = (
        np.array([t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[1, 2], t[2, 0]]) for t in (tensor, turn @ tensor @ turn.T)
    )
    principal = np.linalg.eigvalsh(tensor)
    by_principal = np.sqrt(0.5 * sum((principal[a] - principal[a - 1]) ** 2 for a in range(3)))
    assert von_mises(one) == pytest.approx(by_principal, rel=1e-13)  # rounding alone
    assert von_mises(other) == pytest.approx(by_principal, rel=1e-13)
    assert pressure(one) == pytest.approx(-principal.mean(), rel=1e-13)


@pytest.mark.parametrize(("rows", "chunk"), [(7, 7), (32_768, 32_768), (32_769, 16_385), (100_000, 25_000)])
def test_a_step_lies_in_as_few_equal_chunks_of_at_most_32768_rows_as_it_takes(rows, chunk):
    with h5py.File("nowhere", "w", driver="core", backing_store=False) as file:
        table = _growing(file, "stress", np.float32, 6, rows)
        assert (table.shape, table.maxshape, table.chunks) == ((0, 6), (None, 6), (chunk, 6))
        plain = _growing(file, "time", np.float64)
        assert (plain.shape, plain.chunks, plain.compression) == ((0,), (1024,), "gzip")
