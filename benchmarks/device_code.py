"""Compile what runs on a GPU, without one: registers, scratch memory and operations of each kernel.

    pip install numba-cuda nvidia-cuda-nvcc-cu12 nvidia-cuda-nvrtc-cu12
    python benchmarks/device_code.py

A kernel that calls what a device has not, or keeps an array that is indexed while it runs, shows here.
"""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np
from numba import types
from numba.cuda import compile_ptx, cudadrv, dispatcher
from numba.np.numpy_support import from_dtype

from strikewave.fem._contact_kernels import Step, predict_node, press_node, speed_share, wall_node
from strikewave.fem._history_kernels import kinetic_share, peak_of_chunk, touch_share, velocity_of, watch_share
from strikewave.fem._node_kernels import (
    absorb_node,
    add_row,
    bring_node,
    hold_node,
    move_node,
    move_tied_node,
    sum_share,
    take_row,
)
from strikewave.fem.contact import prepare, prepare_wall
from strikewave.fem.device import _bodies as bodies
from strikewave.fem.device import _bodies as searching
from strikewave.fem.device.gpu import kernel_of, scratch_kernel_of
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, RigidWall, SurfaceContact
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Elastic

TARGET = 9, 0
"""Compute capability: H100, H200."""


class Gpu:
    """What numba asks of a device while it compiles for it."""

    compute_capability = TARGET


def type_of(value):
    """Return numba's type of an argument that holds arrays."""
    if isinstance(value, np.ndarray):
        return types.Array(from_dtype(value.dtype), value.ndim, "C")
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        kinds = [type_of(each) for each in value]
        if len(set(kinds)) == 1:
            return types.NamedUniTuple(kinds[0], len(kinds), type(value))
        return types.NamedTuple(kinds, type(value))
    if isinstance(value, tuple):
        return types.Tuple([type_of(each) for each in value])
    return types.int64 if isinstance(value, int) else types.float64


def samples():
    """Return each kernel with arguments of the types that a run has."""
    low = block("low", (1e-3, 1e-3, 1e-3), 1e-3, 1e-3, 1e-3)
    up = moved(block("up", (1e-3, 1e-3, 1e-3), 1e-3, 1e-3, 1e-3), (0.0, 0.0, 1e-3))
    mesh = joined([low, up])
    contact = SurfaceContact("low.z+", "up.z-", 0.1)
    solids = {"low": Elastic(7820.0, 211e9, 0.3), "up": Elastic(7820.0, 211e9, 0.3)}
    engine = Engine(Model(mesh, solids, Controls(1e-6, full=("up",)), contacts=(contact,)))
    touch, wall = prepare(contact, mesh), prepare_wall(RigidWall("low.z-", (0.0,) * 3, (0.0, 0.0, 1.0)), mesh)
    x, v, f, m = engine.x, engine.v, engine.f, engine.mass
    lists, one = np.zeros(1, np.int32), 1.0
    results = bodies.ElementResults(np.zeros((3, 1)), np.zeros((4, 1)), np.zeros(1))
    step, nodes, frame = Step(one, one, one, one), lists, np.zeros((1, 3, 3))
    faces, groups = np.zeros((1, 4), np.int32), searching.FaceGroups(lists, x, x, 1)
    elements = {
        body: (kind.blocks, x, v, one, (one, one), results)
        for body, kind in zip((bodies.one_point_element, bodies.full_element), engine.solid.kinds, strict=True)
    }
    return elements, {
        move_node: (x, v, f, m, one, one),
        bodies.gather_node: (lists, lists, results.corner, f),
        hold_node: (nodes, frame, one, one, v, f, m, x),
        absorb_node: (nodes, frame, one, v, f, m, x),
        add_row: (nodes, x, f),
        take_row: (nodes, v, x),
        bodies.pressed_node: (nodes, lists, lists, faces, one, x, x, f),
        bodies.tied_corner: (nodes, lists, lists, engine.ties, f),
        bodies.clear_row: (nodes, f),
        bodies.follow_node: (engine.ties, x, v, one),
        sum_share: (nodes, x, f, (one, one, one), x),
        bring_node: (nodes, x, x, one, one, x, v, f, m, f),
        bodies.copy_row: (x, v),
        bodies.join_row: (x, v),
        bodies.book_row: (nodes, x, v, v, one, x),
        bodies.book_touch: (touch.touch, v, one, x),
        predict_node: (touch, x, v, f, m, step),
        bodies.note_travel: (touch, one),
        press_node: (touch, step),
        speed_share: (touch, (one, one, one)),
        velocity_of: (v, f, m, one, x),
        move_tied_node: (engine.ties, v),
        watch_share: (engine.recorder.watched, x, x, v, x),
        kinetic_share: (v, f, m, m, one, one, m),
        peak_of_chunk: (engine.solid.kinds[0].blocks.state, engine.solid.kinds[0].blocks.filled, 1, x),
        touch_share: (touch.touch, x),
        bodies.drain_share: (x, x),
        bodies.acting_share: (x, v, x),
        bodies.drain_chunk: (results.works, x),
        bodies.take_stress: (np.zeros((1, 6), np.int64), results.step, x),
        bodies.collect_node: (touch, lists, lists, f),
        wall_node: (wall, x, v, f, m, step),
        searching.survey_face: (touch, one, x, x[0]),
        searching.survey_node: (touch, lists, lists, x[0]),
        searching.bound_group: (groups,),
        searching.count_near: (touch, groups, touch.start),
        searching.fill_near: (touch, groups, touch.start, lists),
    }


def ptx_of(function, arguments):
    """Return the code of a kernel."""
    code, _ = compile_ptx(function, (types.int64, type_of(arguments)), cc=TARGET)
    return code


def registers(code, folder):
    """Return what the assembler says of a kernel, if it is there: registers, bytes spilled."""
    if shutil.which("ptxas") is None:
        return "no ptxas", ""
    path = Path(folder) / "kernel.ptx"
    path.write_text(code)
    said = subprocess.run(
        ["ptxas", "-v", f"-arch=sm_{TARGET[0]}{TARGET[1]}", str(path), "-o", str(path.with_suffix(".cubin"))],
        capture_output=True,
        text=True,
        check=True,
    ).stderr
    used, spilled = re.search(r"Used (\d+) registers", said), re.search(r"(\d+) bytes spill stores", said)
    return used.group(1), spilled.group(1)


def main():
    """Print a line for each kernel."""
    elements, others = samples()
    print(
        "| kernel | registers | bytes spilled | local memory | double operations in the code |\n| --- | --- | --- | --- | --- |"
    )
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch.object(dispatcher, "get_current_device", Gpu),
        mock.patch.object(cudadrv.nvrtc, "get_arch_option", return_value="compute_90"),
    ):
        for build, group in ((scratch_kernel_of, elements), (kernel_of, others)):
            for body, arguments in group.items():
                code = ptx_of(build(body), arguments)
                done = len(re.findall(r"^\s+(?:add|sub|mul|div|fma|sqrt)\S*\.f64", code, re.M))
                local = re.search(r"\.local \S+ \S+ \S+\[(\d+)\]", code)
                row = body.__name__, *registers(code, folder), local.group(1) if local else "0", str(done)
                print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
