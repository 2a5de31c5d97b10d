"""The explicit elements on a GPU: `python benchmarks/device_bench.py` prints the tables of docs/device.md.

It needs an NVIDIA GPU and `pip install 'strikewave[gpu]'`. Nothing is written.
"""

import datetime
import itertools
import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
from elements_bench import PAPER, SIZE, SOLIDS, body, pressed, taken
from timing import table

from strikewave.fem import _layout as layout
from strikewave.fem.device.devices import NAMES, device_named
from strikewave.fem.device.engine import DeviceEngine
from strikewave.fem.model import Controls, Model
from strikewave.fem.solve import RunOptions, solve

MESHES = {"10 000": (20, 20, 25), "100 000": (50, 50, 40), "1 000 000": (100, 100, 100), "8 000 000": (200, 200, 200)}
"""Elements along x, y and z; contact halves the last."""
LEAST = 1.0
"""Seconds that a timing lasts at least."""
VARIANTS, VARIANT = 100, 100e-6
"""Impacts that are run side by side, and their duration, s."""
COPIED = 1 << 28
"""Bytes that are copied to measure the bandwidth, far more than a cache holds."""
KEPT = int(layout.BACK[0]) // layout.LANES
"""Rows of state of a solid whose yield surface stands."""
ELEMENT_BYTES = {
    "numbers of its nodes, places of its corners": 2 * 4 * 8,
    "works, read and written, and hourglass energy": 2 * 8 * 3 + 8,
    "critical step, written and reduced": 2 * 8,
}
"""Of an element and step."""
STORED_NUMBERS = {
    "constants": layout.CONSTANTS,
    "state, read and written": 2 * KEPT,
    "forces on corners, written and gathered": 2 * 24,
}
"""Of an element and step, in the precision in which they are stored."""
NODE_BYTES = {
    "x and v, gathered": 8 * 6,
    "where its corners begin": 4,
    "force, gathered": 2 * 8 * 3,
    "x, v and f, read and written, and 1/m": 2 * 8 * 9 + 8,
}
"""Of the one node that each element has."""


def bytes_moved(stored=np.float64):
    """Return the bytes of an element and step; mixed precision stores single numbers."""
    kept = np.dtype(stored).itemsize * sum(STORED_NUMBERS.values())
    return sum(ELEMENT_BYTES.values()) + kept + sum(NODE_BYTES.values())


def bandwidth(cuda):
    """Return the bytes a second of a copy on the device, read and written."""
    there = cuda.to_device(np.zeros(COPIED // 8))
    other = cuda.device_array_like(there)

    def copy():
        other.copy_to_device(there)
        cuda.synchronize()

    copy()
    begun = time.perf_counter()
    for _ in range(20):
        copy()
    return 20 * 2 * COPIED / (time.perf_counter() - begun)


def rate(model, device, cuda):
    """Return element-steps a second of a model that moves at random."""
    engine = DeviceEngine(model, device)
    engine.v += np.random.default_rng(1).normal(0.0, 2.0, engine.v.shape)
    engine.send()
    taken(engine, 3)
    steps = max(3, int(LEAST / taken(engine, 3)))
    seconds = taken(engine, steps)
    cuda.synchronize()
    return engine.elements / seconds


def rows(devices, cuda, most):
    """Return the rows of meshes, solids and precisions, with the share of the bound by bandwidth."""
    found = []
    for name, counts in MESHES.items():
        models = {kind: Model(body(counts), {"body": SOLIDS[kind]}, Controls(1.0)) for kind in ("elastic", "bilinear")}
        models["bilinear, in contact"] = pressed((counts[0], counts[1], counts[2] // 2))
        for (kind, model), device in itertools.product(models.items(), devices):
            reached = rate(model, device, cuda)
            share, precision = reached * bytes_moved(device.stored) / most, np.dtype(device.stored).name
            found.append((name, kind, precision, rate_of(reached), f"{share:.0%}"))
    return found


def impact(device):
    """Return the seconds of the published impact, the time loop and all of it, and its energy error."""
    begun = time.perf_counter()
    model = pressed()
    model = replace(model, controls=replace(model.controls, duration=PAPER, interval=1e-6))
    run = solve(model, RunOptions(device=device))
    return run.seconds, time.perf_counter() - begun, float(np.abs(run.energy_error).max())


def variant(speed, name=None):
    """Run an impact of 10 000 elements at a speed, m/s, on a device or the processor; return its element-steps."""
    model = pressed((20, 25, 10))
    controls = replace(model.controls, duration=VARIANT, interval=1e-6)
    model = replace(model, controls=controls, velocity={"upper": (0.0, 0.0, -speed)})
    run = solve(model, RunOptions(device=device_named(name) if name else None))
    return run.elements * run.steps


def batch(name=None, workers=(1, 4, 16), variants=VARIANTS):
    """Return rows of how many processes share a device, and what they do in a second on many impacts."""
    found, context = [], multiprocessing.get_context("spawn")
    for count in workers:
        with ProcessPoolExecutor(count, mp_context=context) as pool:
            list(pool.map(variant, [1.0] * count, [name] * count))  # kernels are compiled or loaded once in each
            begun = time.perf_counter()
            done = sum(pool.map(variant, np.linspace(5.0, 20.0, variants), [name] * variants))
        found.append((str(count), rate_of(done / (time.perf_counter() - begun))))
    return found


def rate_of(each_second):
    """Write element-steps a second."""
    return f"{each_second / 1e6:.0f} M/s"


def main():
    """Print what was measured."""
    devices = [device_named(name) for name in NAMES]
    from numba import cuda

    gpu = cuda.get_current_device()
    print(f"{datetime.date.today()}, {gpu.name}, compute capability {gpu.compute_capability}")
    most = bandwidth(cuda)
    print(
        f"a copy moves {most / 1e9:.0f} GB/s; an element and step {bytes_moved()} bytes, {bytes_moved(np.float32)} mixed\n"
    )
    heads = "elements", "kind", "stored", "element-steps a second", "share of the bandwidth"
    print(table(heads, rows(devices, cuda, most)))
    for device in devices:
        loop, whole, error = impact(device)
        print(
            f"\nAn impact of {PAPER * 1e3:g} ms of 100 000 hexahedra of {SIZE * 1e3:g} mm, {np.dtype(device.stored).name}: {loop:.1f} s of "
            f"time loop, {whole:.1f} s with building and compiling; energy error {error:.1e}."
        )
    print(
        f"\n{VARIANTS} impacts of 10 000 hexahedra of {VARIANT * 1e6:g} us at as many speeds, by processes that share the GPU:\n"
    )
    print(table(("processes", "element-steps a second"), batch(NAMES[0])))


if __name__ == "__main__":
    main()
