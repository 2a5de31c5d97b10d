"""Files that a run goes on from, read as those of a stranger: damaged or forged ones are refused, none is trusted."""

import dataclasses
import shutil

import h5py
import numpy as np
import pytest

from strikewave.base.datasets import seal
from strikewave.base.errors import InputError
from strikewave.fem import engine as engine_module
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, RigidWall, SurfaceContact
from strikewave.fem.restart import kept_blows, read_restart
from strikewave.fem.shapes import block, moved
from strikewave.fem.snapshots import snapshot_recorder
from strikewave.fem.solve import Checkpoint, RunOptions, solve

from .bodies import STEEL

CONTACT = "contact/low.z+-up.z-"


def model(duration=4e-6):
    low = block("low", (4e-3, 4e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    up = block("up", (3e-3, 3e-3, 3e-3), 1e-3, 1e-3, 1e-3)
    up = moved(up, (0.3e-3, 0.2e-3, low.points[:, 2].max() - up.points[:, 2].min() + 1e-5))
    return Model(
        joined([low, up]),
        {"low": STEEL, "up": STEEL},
        Controls(duration, 0.5e-6),
        velocity={"up": (3.0, 0.0, -8.0)},
        contacts=(SurfaceContact("low.z+", "up.z-", 0.3),),
        walls=(RigidWall("low.z-", (0.0, 0.0, float(low.points[:, 2].min())), (0.0, 0.0, 1.0)),),
    )


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "restart.h5"
    solve(model(2.5e-6), RunOptions(checkpoint=Checkpoint(path, 2)))
    return path


def put(name, value):
    def change(file):
        new = value(file[name][()]) if callable(value) else value
        if name in file:
            del file[name]
        file[name] = new

    return change


def sparse(name, shape, kind="f8"):
    def change(file):
        if name in file:
            del file[name]
        file.create_dataset(name, shape=shape, dtype=kind, chunks=(10**6, *shape[1:]))

    return change


def outside(file):
    shape = file["x"].shape
    del file["x"]
    file.create_dataset("x", shape=shape, dtype="f8", external=[("/dev/zero", 0, 8 * shape[0] * shape[1])])


def without(name):
    return lambda file: file.__delitem__(name)


def both(one, other):
    return lambda file: (one(file), other(file))


FORGED = {
    "faces that are not there": put(f"{CONTACT}/candidates", lambda a: np.full_like(a, 10**9)),
    "a negative face": put(f"{CONTACT}/candidates", lambda a: np.full_like(a, -1)),
    "no face by -2": put(f"{CONTACT}/nodal/face", lambda a: np.full_like(a, -2)),
    "a found face that is not there": put(f"{CONTACT}/nodal/face", lambda a: np.full_like(a, 10**6)),
    "starts beyond the end": put(f"{CONTACT}/start", lambda a: np.arange(len(a)) * 10**9),
    "starts that fall": put(f"{CONTACT}/start", lambda a: np.concatenate([a[:1], a[:0:-1]])),
    "x of three numbers": put("x", np.zeros(3)),
    "x not finite": put("x", lambda a: a * np.nan),
    "x of words": put("x", "abc"),
    "x of half the digits": put("x", lambda a: a.astype("f4")),
    "a negative instant": put("instant", -5),
    "an instant after the end": put("instant", 10**9),
    "a step without end": put("critical", np.inf),
    "steps without end": put("steps", 2**62),
    "steps without end, each of no length": both(put("steps", 2**62), put("smallest", 1e-300)),
    "work that is no number": put("done/contact", np.nan),
    "elements that are no numbers": put("elements/0/state", lambda a: a * np.nan),
    "an impulse without end": put("impulse/low.z+-up.z-", np.full(3, np.inf)),
    "a history that is no number": put("row/kinetic", lambda a: a * np.nan),
    "no step": put("critical", 1e-30),
    "a step that is no number": put("critical", np.nan),
    "a negative step before": put("dt_previous", -1e-8),
    "an array for a number": put("steps", np.zeros(3, int)),
    "a ragged row": put("row/time", np.zeros(1)),
    "a missing row": without("row/time"),
    "a missing contact": without(CONTACT),
    "2.4 TB": sparse("x", (10**11, 3)),
    "400 GB of candidates": sparse(f"{CONTACT}/candidates", (10**11,), "i4"),
    "80 GB that nobody asked for": sparse("extra", (10**10,)),
    "another file's numbers": outside,
    "other faces": put(f"{CONTACT}/faces", np.zeros((18, 4), np.int32)),
}


@pytest.mark.parametrize("change", FORGED.values(), ids=FORGED)
def test_a_forged_file_is_refused(kept, tmp_path, change):
    path = tmp_path / "forged.h5"
    shutil.copy(kept, path)
    with h5py.File(path, "r+") as file:
        change(file)
    seal(path)  # as a stranger may, so that it is refused by what it claims
    with pytest.raises(InputError, match="damaged"):
        read_restart(path, Engine(model()))


@pytest.mark.parametrize("blow", [np.inf, np.nan, 1.0, 1.9, -1, 2, "1", [1, 2]])
def test_a_blow_that_is_none_is_refused(kept, tmp_path, blow):
    path = tmp_path / "forged.h5"
    shutil.copy(kept, path)
    with h5py.File(path, "r+") as file:
        file.attrs["blow"] = blow
    seal(path)
    with pytest.raises(InputError, match="damaged"):
        kept_blows(path)


def test_the_whole_file_is_read(kept):
    engine = Engine(model())
    read_restart(kept, engine)
    assert (engine.instant, engine.time) == (4, 2e-6)
    assert engine.steps > 0


def test_nothing_that_the_model_fixes_is_kept(kept):
    with h5py.File(kept) as file:
        names = []
        file.visit(names.append)
    ends = {name.rpartition("/")[2] for name in names}
    assert not ends & {"nodes", "faces", "neighbours", "first", "first_faces", "checked", "held", "point", "direction"}


def test_bytes_that_changed_end_in_one_word(kept, tmp_path):
    """50 files with up to 20 other bytes each, some cut short, are read or refused."""
    rng, raw, refused = np.random.default_rng(0), kept.read_bytes(), 0
    engine, path = Engine(model()), tmp_path / "changed.h5"
    for k in range(50):
        data = bytearray(raw)
        for place in rng.integers(0, min(len(data), 30_000), rng.integers(1, 20)):
            data[place] = rng.integers(0, 256)
        path.write_bytes(data[: rng.integers(0, len(data))] if k % 4 == 0 else data)
        seal(path)
        try:
            read_restart(path, engine)
        except InputError:
            refused += 1
    assert refused > 12


def test_one_bit_that_changed_is_refused(kept, tmp_path):
    """HDF5 checks no number: without a check sum most of these go on with other histories."""
    rng, raw, path = np.random.default_rng(1), kept.read_bytes(), tmp_path / "changed.h5"
    engine = Engine(model())
    for place in (0, len(raw) - 1, *rng.integers(0, len(raw), 60)):
        data = bytearray(raw)
        data[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(data)
        with pytest.raises(InputError, match="damaged"):
            read_restart(path, engine)


def test_what_an_observer_has_seen_goes_on_with_the_run(tmp_path):
    """A run that was stopped shows the same instants, and the same largest values, as one that never was."""
    path, whole, begun, again = tmp_path / "restart.h5", *(snapshot_recorder(model(), 8) for _ in range(3))
    solve(model(2.5e-6), RunOptions(checkpoint=Checkpoint(path, 2), observer=begun))
    solve(model(6e-6), RunOptions(observer=whole))
    solve(model(6e-6), RunOptions(observer=again, resume=path))
    assert again.largest == whole.largest
    assert not again.missed
    assert len(whole.snapshots) > 8
    one, other = whole.state(), again.state()
    assert one.keys() == other.keys()
    for name in one:
        assert np.array_equal(one[name], other[name], equal_nan=True), name


def test_what_another_observer_saw_is_refused(kept, tmp_path):
    path, seen = tmp_path / "restart.h5", snapshot_recorder(model())
    solve(model(2.5e-6), RunOptions(checkpoint=Checkpoint(path, 2), observer=seen))
    seen.skin = dataclasses.replace(seen.skin, elements=seen.skin.elements[:-1])
    with pytest.raises(InputError, match="not of this mesh"):
        read_restart(path, Engine(model()), restore=seen.restore)


def test_another_version_does_not_go_on(kept, monkeypatch):
    """The same state may mean something else to another version."""
    monkeypatch.setattr(engine_module, "__version__", "0.0.0")
    with pytest.raises(InputError, match="strikewave: run without it"):
        read_restart(kept, Engine(model()))


def test_a_longer_run_of_the_same_model_goes_on(kept):
    longer = solve(model(6e-6), RunOptions(resume=kept))
    assert np.array_equal(longer.momentum, solve(model(6e-6)).momentum)
