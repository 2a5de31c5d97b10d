"""Steps on a device, by the bodies that its threads run, against those of the processor."""

import dataclasses
import functools
import itertools
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import Workers, design, load_case, sweep
from strikewave.analyses.fem import run as fem_run
from strikewave.base.errors import InputError
from strikewave.fem import _layout as layout
from strikewave.fem.contact import prepare, searched
from strikewave.fem.device import devices, gpu
from strikewave.fem.device._bodies import one_point_element
from strikewave.fem.device.devices import Loop, device_named
from strikewave.fem.device.engine import DeviceEngine, FaceSearch, put_fields
from strikewave.fem.mesh import joined
from strikewave.fem.model import (
    Controls,
    CutSection,
    Driven,
    Fixed,
    Model,
    NonReflecting,
    Point,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    Tie,
    TimeCurve,
)
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook, ZerilliArmstrong
from strikewave.fem.solve import Checkpoint, RunOptions, solve, solve_blows

from .bodies import THIN_STEEL, rod_on_wall
from .driven import as_written

SAME = 1e-10
"""Of the largest value: sums of up to eight corners in another order, over some hundred steps."""
SIZE = 1e-3
SOLIDS = {
    "elastic": Elastic(7820.0, 211e9, 0.29),
    "bilinear": Bilinear(7820.0, 211e9, 0.29, yield_strength=100e6, tangent_modulus=2e9),
    "kinematic": Bilinear(7820.0, 211e9, 0.29, yield_strength=100e6, tangent_modulus=2e9, kinematic=0.5),
    "johnson-cook": JohnsonCook(
        7830.0, 200e9, 0.29, A=100e6, B=510e6, n=0.26, C=0.014, m=1.03, melting_temperature=1793.0, specific_heat=477.0
    ),
    "zerilli-armstrong": ZerilliArmstrong(
        8960.0, 124e9, 0.34, C0=65e6, C2=890e6, C3=0.0028, C4=0.000115, specific_heat=383.0
    ),
}


def skewed(name, counts):
    """Return a block whose inner nodes are moved, so that no two elements are alike."""
    mesh = block(name, tuple(SIZE * n for n in counts), SIZE, SIZE, SIZE)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    inner = np.all((mesh.points > low + 0.1 * SIZE) & (mesh.points < high - 0.1 * SIZE), axis=1)
    points = mesh.points.copy()
    points[inner] += np.random.default_rng(3).uniform(-0.15, 0.15, (inner.sum(), 3)) * SIZE
    return dataclasses.replace(mesh, points=points)


class AsWritten(Loop):
    """A device that runs bodies, and all that they call, as Python: nothing is compiled."""

    def __init__(self):
        super().__init__()
        self.written = {}

    def each(self, body, count, *arguments):
        run = as_written(body, self.written)
        for i in range(count):
            run(i, *arguments)


def body(solid, full=()):
    """Return a block that is held, driven, weighed, and lets waves out; 45 elements fill one chunk and a part."""
    return Model(
        skewed("body", (3, 3, 5)),
        {"body": SOLIDS[solid]},
        Controls(4e-6, 1e-6, full=full),
        gravity=(0.0, 3e4, -1e5),
        boundaries=(
            Symmetry("body.x-"),
            Driven("body.z+", (0.0, 0.0, -1.0), TimeCurve((0.0, 1e-6, 2e-6), (0.0, 20.0, 0.0))),
            NonReflecting("body.z-"),
        ),
    )


def impact(friction=0.3, duration=6e-6):
    """Return a block that falls aslant on another, which stands on a wall."""
    low, up = skewed("low", (4, 4, 2)), skewed("up", (3, 3, 2))
    gap = low.points[:, 2].max() - up.points[:, 2].min() + 2e-6
    up = moved(up, (0.3 * SIZE, 0.2 * SIZE, gap))
    cuts = [(name, tuple(mesh.points.mean(axis=0) + 0.2 * SIZE)) for name, mesh in (("low", low), ("up", up))]
    return Model(
        joined([low, up]),
        {"low": SOLIDS["bilinear"], "up": SOLIDS["elastic"]},
        Controls(duration, 1e-6, full=("up",)),
        velocity={"up": (20.0, 5.0, -30.0)},
        contacts=(SurfaceContact("low.z+", "up.z-", friction),),
        walls=(RigidWall("low.z-", (0.0, 0.0, float(low.points[:, 2].min())), (0.0, 0.0, 1.0), 0.1),),
        sections=tuple(CutSection(name, name, place, (0.0, 0.0, 1.0)) for name, place in cuts),
        points=(Point("corner", "up", tuple(up.points.max(axis=0))),),
    )


def tied():
    """Return a fine block tied to a coarse one, under a pressure; its nodes lie anywhere in the faces there."""
    low, up = skewed("low", (2, 2, 2)), block("up", (SIZE, SIZE, SIZE), SIZE / 2.0, SIZE / 2.0, SIZE / 2.0)
    place = (0.4 * SIZE, 0.3 * SIZE, float(low.points[:, 2].max() - up.points[:, 2].min()))
    return Model(
        joined([low, moved(up, place)]),
        {"low": SOLIDS["bilinear"], "up": SOLIDS["elastic"]},
        Controls(1.5e-6, 0.5e-6),
        velocity={"up": (3.0, -2.0, 0.0)},
        gravity=(0.0, 0.0, -1e5),
        ties=(Tie("up.z-", "low.z+"),),
        boundaries=(Fixed("low.z-"), Pressure("up.z+", TimeCurve((0.0, 0.5e-6), (0.0, 400e6)))),
    )


def struck(blows=1):
    """Return a rigid block that strikes another off its middle and turns."""
    low, up = skewed("low", (3, 3, 2)), skewed("up", (2, 2, 2))
    gap = low.points[:, 2].max() - up.points[:, 2].min() + 1e-6
    return Model(
        joined([low, moved(up, (1.2 * SIZE, 0.9 * SIZE, gap))]),
        {"low": SOLIDS["bilinear"], "up": SOLIDS["elastic"]},
        Controls(3e-6, 1e-6, blows=blows),
        velocity={"up": (0.0, 0.0, -40.0)},
        contacts=(SurfaceContact("low.z+", "up.z-", 0.2),),
        rigid=(Rigid("up"),),
        boundaries=(Fixed("low.z-"),),
    )


def brick(name, place, seed, size=SIZE):
    """Return one element whose nodes lie aside, with flat ends."""
    mesh = moved(block(name, (size, size, size), size, size, size), tuple(SIZE * c for c in place))
    shift = 0.08 * size * np.random.default_rng(seed).uniform(-1.0, 1.0, mesh.points.shape)
    return dataclasses.replace(mesh, points=mesh.points + shift * [1.0, 1.0, 0.0])


def pile():
    """Return an element of eight points on a wall, which lets waves out; one of one point falls aslant on it.

    The faster one yields and moves its yield surface; what is tied to it is pressed. A rigid one spins upon another.
    """
    low, up, top = (
        brick("low", (0.0, 0.0, 0.0), 1),
        brick("up", (0.3, 0.2, 1.001), 2),
        brick("top", (0.35, 0.15, 2.001), 3, 0.4 * SIZE),
    )
    anvil, hammer = brick("anvil", (5.0, 0.0, 0.0), 4), brick("hammer", (5.4, 0.3, 1.0005), 5)
    mesh = joined([low, up, top, anvil, hammer])
    laws = {"low": "zerilli-armstrong", "up": "kinematic", "top": "johnson-cook", "anvil": "bilinear"}
    solids = {name: SOLIDS[laws.get(name, "elastic")] for name in mesh.names}
    duration = 0.36e-6
    return Model(
        mesh,
        solids,
        Controls(duration, duration / 2.0, full=("low",)),
        velocity={
            "up": (11.0, -7.0, -400.0),
            "top": (11.0, -7.0, -400.0),
            "hammer": (3.0, 5.0, -90.0),
            "low": (1.0, 2.0, -9.0),
        },
        gravity=(2e5, -3e5, -5e5),
        contacts=(SurfaceContact("low.z+", "up.z-", 0.13), SurfaceContact("hammer.z-", "anvil.z+", 0.4)),
        ties=(Tie("top.z-", "up.z+"),),
        walls=(RigidWall("low.z-", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.1),),
        rigid=(Rigid("hammer"),),
        boundaries=(
            NonReflecting("low.y-"),
            Pressure("top.x+", TimeCurve((0.0, duration), (300e6, 500e6))),
            Symmetry("anvil.z-"),
            Driven("anvil.x+", (1.0, 0.0, 0.0), TimeCurve((0.0, duration), (4.0, 9.0))),
        ),
        sections=tuple(CutSection(n, n, (0.0, 0.0, SIZE * z), (0.0, 0.0, 1.0)) for n, z in (("low", 0.4), ("up", 1.4))),
        points=(Point("corner", "up", (SIZE, SIZE, 2.0 * SIZE)),),
    )


def assert_same(run, other, rounding=()):
    """Assert that two runs are the same, each energy over its own largest value but for those that are rounding."""
    most = max(np.abs(column).max() for column in run.energy.values())
    for what in ("energy", "force", "impulse", "von_mises", "plastic_strain", "pressed"):
        for name, column in getattr(run, what).items():
            scale = most if what == "energy" and name in rounding else max(np.abs(column).max(), 1e-300)
            np.testing.assert_allclose(getattr(other, what)[name] / scale, column / scale, atol=SAME, rtol=0.0)
    watched = [(getattr(run, what), getattr(other, what)) for what in ("parts", "points", "sections")]
    for (histories, theirs), field in itertools.product(watched, ("displacement", "velocity", "stress")):
        for name, history in histories.items():
            if hasattr(history, field):
                ours = getattr(history, field)
                np.testing.assert_allclose(getattr(theirs[name], field), ours, atol=SAME * np.abs(ours).max(), rtol=0.0)
    np.testing.assert_allclose(other.momentum, run.momentum, atol=SAME * np.abs(run.momentum).max(), rtol=0.0)
    assert other.steps == run.steps
    assert other.step == pytest.approx(run.step, rel=SAME)


@pytest.mark.verify
@pytest.mark.parametrize("full", [(), ("body",)], ids=["one-point", "full"])
@pytest.mark.parametrize("solid", SOLIDS)
def test_bodies_of_a_device_move_solids_as_the_processor_does(solid, full):
    model = body(solid, full)
    run = solve(model)
    assert solid == "elastic" or run.energy["plastic"][-1] > 0.05 * run.energy["internal"][-1]
    assert_same(run, solve(model, RunOptions(device=Loop())))


@pytest.mark.verify
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_bodies_of_a_device_meet_as_on_the_processor(friction):
    model = impact(friction)
    run = solve(model)
    assert max(np.linalg.norm(force, axis=1).max() for force in run.force.values()) > 100.0
    again = solve(model, RunOptions(device=Loop()))
    assert_same(run, again)
    assert again.energy_error == pytest.approx(run.energy_error, abs=SAME)


@pytest.mark.verify
@pytest.mark.parametrize("solid", [THIN_STEEL, Bilinear(7820.0, 211e9, 0.0, yield_strength=60e6, tangent_modulus=2e9)])
def test_mixed_precision_is_off_by_the_rounding_of_single_numbers(solid):
    """A rod that bounces off a wall, 1500 steps.

    What is kept is rounded by 6e-8 in each: stresses err by some of these, and energies by less than one, as roundings
    are of either sign.
    """
    model, _ = rod_on_wall(elements=20, duration=300e-6, solid=solid)
    run, mixed = solve(model), solve(model, RunOptions(device=Loop(np.float32)))
    assert run.steps == mixed.steps > 1000
    most = max(np.abs(column).max() for column in run.energy.values())
    apart = max(np.abs(mixed.energy[name] - column).max() for name, column in run.energy.items())
    assert 1e-10 < apart / most < 2e-7
    for name, stress in run.von_mises.items():
        np.testing.assert_allclose(mixed.von_mises[name], stress, rtol=0.0, atol=1e-6 * stress.max())
    for name, force in run.force.items():
        np.testing.assert_allclose(mixed.force[name], force, rtol=0.0, atol=1e-6 * np.abs(force).max())
    assert np.abs(mixed.energy_error).max() == pytest.approx(np.abs(run.energy_error).max(), abs=1e-7)


def test_faces_that_a_device_finds_near_nodes_are_those_that_the_processor_finds():
    """Over 9 by 9 and 7 by 7 faces, several groups of each surface, that are bent and lie aslant."""
    low, up = skewed("low", (9, 9, 1)), moved(skewed("up", (7, 7, 1)), (0.3 * SIZE, 0.2 * SIZE, SIZE))
    mesh = joined([low, up])
    state = prepare(SurfaceContact("low.z+", "up.z-"), mesh)
    points = mesh.points + np.random.default_rng(4).normal(0.0, 0.1 * SIZE, mesh.points.shape)
    there = put_fields(Loop(), state)
    start, _, candidates = FaceSearch(Loop(), state).near(there, points)
    expected = searched(state, points)
    assert candidates.size > 100
    for found, right in (
        (start, expected.start),
        (candidates, expected.candidates),
        (there.touch.area, expected.touch.area),
        (there.size, expected.size),
        (there.radius, expected.radius),
    ):
        np.testing.assert_array_equal(found, right)


@pytest.mark.verify
def test_an_interrupted_run_goes_on_there_and_on_the_processor(tmp_path):
    path = tmp_path / "state.h5"
    whole = solve(impact(), RunOptions(device=Loop()))
    solve(impact(duration=3e-6), RunOptions(device=Loop(), checkpoint=Checkpoint(path, 2)))
    for device in (Loop(), None):
        assert_same(whole, solve(impact(), RunOptions(device=device, resume=path)))


def test_ties_and_pressures_of_a_device_are_those_of_the_processor():
    run = solve(tied())
    assert run.energy["plastic"][-1] > 0.01 * run.energy["internal"][-1]
    assert_same(run, solve(tied(), RunOptions(device=Loop())))


@pytest.mark.verify
def test_a_rigid_part_and_the_next_blow_on_a_device_are_those_of_the_processor():
    """Bodies come to rest on the processor in both; the second blow begins on what the device left.

    The forces within a rigid part do no work: what is booked of them, external here, is rounding.
    """
    runs = solve_blows(struck(blows=2))
    assert len(runs) == 2
    assert max(np.abs(column).max() for column in runs[1].force.values()) > 100.0
    for run, other in zip(runs, solve_blows(struck(blows=2), RunOptions(device=Loop())), strict=True):
        assert_same(run, other, rounding=("external",))


def test_bodies_as_they_are_written_move_whatever_stands_falls_spins_and_is_tied_as_the_processor_does():
    run = solve(pile())
    assert min(np.abs(force).max() for force in run.force.values()) > 10.0
    assert run.energy["plastic"][-1] > 0.01 * run.energy["internal"][-1]
    assert_same(run, solve(pile(), RunOptions(device=AsWritten())))


def test_a_run_that_begins_anew_does_so_on_its_device():
    engine = DeviceEngine(pile(), Loop())
    other = engine.begun_anew()
    assert type(other) is DeviceEngine
    assert other.device is engine.device
    assert other.model is engine.model


def test_the_kernels_of_a_gpu_run_in_the_simulator_of_numba():
    script = Path(__file__).with_name("simulated_gpu.py")
    path = os.pathsep.join([str(script.parents[2] / "benchmarks"), *sys.path])
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "PYTHONPATH": path}
    found = subprocess.run([sys.executable, script], env=environment, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


@pytest.mark.verify
def test_studies_of_elements_take_their_steps_on_a_device(monkeypatch):
    """A sweep and a design of one run each; the device is the one that runs bodies here, and counts its calls."""
    calls = []

    class Counting(Loop):
        def each(self, body, count, *arguments):
            calls.append(body)
            super().each(body, count, *arguments)

    monkeypatch.setattr(devices, "device_named", lambda name: Counting())
    monkeypatch.setattr(fem_run, "device_named", lambda name: Counting())
    case = load_case("two-bars-fem", ["fem.duration=1 us"])
    with ThreadPoolExecutor(1) as pool:
        for study in (
            lambda device: sweep(
                case, ["fem.duration=1 us"], keep=["energy_error"], workers=Workers(executor=pool, device=device)
            ),
            lambda device: design(
                case,
                ["fem.duration=1 us, 1.2 us"],
                ["energy_error < 5 %"],
                runs=16,
                workers=Workers(executor=pool, device=device),
            ),
        ):
            calls.clear()
            here = study(None)
            assert not calls
            there = study("cuda")
            assert np.isfinite(there.numbers).all()
            assert one_point_element in calls
            np.testing.assert_allclose(there.numbers, here.numbers, rtol=1e-6)


def test_a_study_of_a_machine_has_no_use_for_a_device():
    with pytest.raises(InputError, match='--device: got "cuda"; allowed: a study of elements'):
        sweep(load_case("li-ma-2019"), ["machine.speed=600 rpm"], workers=Workers(device="cuda"))


def test_without_a_gpu_one_line_says_what_is_missing(monkeypatch):
    monkeypatch.setattr(gpu.cuda, "is_available", lambda: False)
    with pytest.raises(
        InputError, match='--device: got "cuda"; allowed: a machine with an NVIDIA GPU and its driver'
    ) as error:
        device_named("cuda")
    assert "\n" not in str(error.value)


class Threads:
    """What a GPU is to numba, with its threads one after another."""

    def __init__(self):
        self.local, self.launched, self.compiled = SimpleNamespace(array=np.zeros), [], 0

    def is_available(self):
        return True

    def to_device(self, array):
        there = np.array(array)
        return SimpleNamespace(array=there, copy_to_host=lambda: there)

    def grid(self, axes):
        return self.thread

    def reduce(self, lesser):
        return lambda there, init: functools.reduce(lesser, there.array.tolist(), init)

    def jit(self, kernel):
        self.compiled += 1
        threads = self

        class Kernel:
            def __getitem__(self, shape):
                def launch(*arguments):
                    threads.launched.append(shape)
                    for threads.thread in range(shape[0] * shape[1]):
                        kernel(*arguments)

                return launch

        return Kernel()


def test_a_gpu_calls_a_body_once_for_each_index_in_blocks_of_128_threads(monkeypatch):
    threads = Threads()
    monkeypatch.setattr(gpu, "cuda", threads)
    device = gpu.Cuda(np.float32)
    there = device.put(np.zeros(300))

    def count(i, out, more):
        out.array[i] += more + i

    def add(i, scratch, out):
        assert (scratch.size, scratch.sum()) == (layout.SCRATCH, 0.0)
        scratch[:] = 1.0
        out.array[i] -= i

    device.each(count, 257, there, 0.25)
    device.each(count, 128, there, 0.25)
    device.each(count, 0, there, 0.25)
    device.each_with_scratch(add, 300, there)
    expected = 0.25 * (np.arange(300) < 257) + (np.arange(300) < 128) * (0.25 + np.arange(300))
    expected -= np.where(np.arange(300) < 257, 0, np.arange(300))
    np.testing.assert_array_equal(device.get(there), expected)
    assert threads.launched == [(3, 128), (1, 128), (3, 128)]
    assert threads.compiled == 2
    assert (device.stored, device.least(there)) == (np.float32, -299.0)
    assert device.least(device.put(np.array([7.0, 5.0, 9.0]))) == 5.0
