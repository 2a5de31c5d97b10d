"""The explicit elements: element-steps a second beside the limits of the machine and beside CalculiX."""

import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import calculix
import numba
import numpy as np
import operations
from timing import best, table, write

from strikewave.base.compiled import fused_called_kernel
from strikewave.fem import _layout as layout
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, Model, SurfaceContact
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook
from strikewave.fem.solve import solve

SIZE = 0.5e-3
"""Of an element, m."""
MESHES = {"10 000": (20, 20, 25), "100 000": (50, 50, 40), "650 000": (100, 100, 65)}
"""Elements along x, y and z."""
LEAST = 0.4
"""Seconds that a timing lasts at least."""
PASSES = 3
"""Passes over the rows, of which each has its best: other work on a machine comes and goes."""
PAPER = 1e-3
"""Duration of the paper's impact, s."""
STEEL = Elastic(7820.0, 211e9, 0.29)
SOLIDS = {
    "elastic": STEEL,
    "bilinear": Bilinear(7820.0, 211e9, 0.29, yield_strength=400e6, tangent_modulus=2e9),
    # 4340 steel of Johnson & Cook 1983
    "Johnson-Cook": JohnsonCook(
        7830.0, 200e9, 0.29, A=792e6, B=510e6, n=0.26, C=0.014, m=1.03, melting_temperature=1793.0, specific_heat=477.0
    ),
}
NODE_BYTES = 8 * (3 * 2 + 3 * 2 + 3 * 2 + (4 * 3 + 3 + 1))
"""Of a node and step: x and v gathered, forces cleared and summed (read and written), all of it and 1/m to move it."""


def body(counts):
    """Return a block of so many elements."""
    return block("body", tuple(SIZE * n for n in counts), SIZE, SIZE, SIZE)


def shaken(model, pool=None):
    """Return an engine whose nodes move at random, so that every element strains and most of them yield."""
    engine = Engine(model, pool)
    engine.v += np.random.default_rng(1).normal(0.0, 2.0, engine.v.shape)
    return engine


def taken(engine, steps):
    """Return the mean time of so many steps in which nothing is noted, s."""
    begun = time.perf_counter()
    for _ in range(steps):
        engine.assemble_forces()
        engine.step()
    return (time.perf_counter() - begun) / steps


def step_time(engine, tries=4):
    """Return the shortest time of a step, s."""
    steps = max(2, int(LEAST / tries / taken(engine, 2)))
    return min(taken(engine, steps) for _ in range(tries))


def one_body(counts, solid, threads=1, full=()):
    """Return the time of a step of a free block, s."""
    model = Model(body(counts), {"body": solid}, Controls(1.0, threads=threads, full=full))
    with ThreadPoolExecutor(threads) as pool:
        return step_time(shaken(model, pool if threads > 1 else None))


def rate(elements, seconds):
    """Write element-steps a second."""
    return f"{elements / seconds / 1e6:.2f} M/s"


def pressed(counts=(50, 50, 20), threads=1, shift=0.0):
    """Return two blocks that press on each other with a whole side each, at 10 m/s; nodes meet corners, or are shifted."""
    lower = body(counts)
    place = (shift * SIZE, shift * SIZE, SIZE * counts[2])
    upper = moved(block("upper", tuple(SIZE * n for n in counts), SIZE, SIZE, SIZE), place)
    return Model(
        joined([lower, upper]),
        {"body": SOLIDS["bilinear"], "upper": SOLIDS["bilinear"]},
        Controls(1.0, threads=threads),
        velocity={"upper": (0.0, 0.0, -10.0)},
        contacts=(SurfaceContact("body.z+", "upper.z-"),),
    )


def contact_cost(threads, shift):
    """Return the times of a step with and without contact, s, taken in turns while the blocks touch (70 steps)."""
    model = pressed(threads=threads, shift=shift)
    with ThreadPoolExecutor(threads) as pool:
        engines = [Engine(each, pool if threads > 1 else None) for each in (model, replace(model, contacts=()))]
        times = np.array([[taken(engine, 8) for engine in engines] for _ in range(8)])
    (state,) = engines[0].contacts.values()
    assert state.nodal.touches.mean() > 0.9
    return times[1:].min(axis=0)


@fused_called_kernel
def multiply_and_add(x, a, b, times):
    """Sixteen multiplications and additions of each number, again and again; they stay in the cache."""
    for _ in range(times):
        for j in range(x.size):
            y = x[j]
            y = a * (a * (a * (a * y + b) + b) + b) + b
            y = a * (a * (a * (a * y + b) + b) + b) + b
            y = a * (a * (a * (a * y + b) + b) + b) + b
            x[j] = a * (a * (a * (a * y + b) + b) + b) + b


@numba.njit(error_model="numpy")
def triad(a, b, c, s):
    """STREAM's triad."""
    for j in range(a.size):
        a[j] = b[j] + s * c[j]


def limits():
    """Return what one core can do: operations a second, and bytes a second from memory."""
    x, times = np.ones(512), 20_000
    operations_rate = 32 * x.size * times / best(lambda: multiply_and_add(x, 0.5, 0.5, times))
    a, b, c = (np.ones(8_000_000) for _ in range(3))
    return operations_rate, 32 * a.size / best(lambda: triad(a, b, c, 3.0))


def bytes_moved():
    """Return bytes of an element and step: constants and nodes read, state read and written, and its node's share."""
    kept = int(layout.BACK[0]) // layout.LANES
    return 8 * layout.CONSTANTS + 2 * 8 * kept + 4 * 8 + NODE_BYTES


def rows():
    """Return the rows of meshes, solids and threads."""
    kinds = [(name, kind, ()) for name in MESHES for kind in ("elastic", "bilinear")]
    kinds += [("100 000", "Johnson-Cook", ()), ("100 000", "elastic", ("body",)), ("100 000", "bilinear", ("body",))]
    passes = [
        [[one_body(MESHES[name], SOLIDS[kind], threads, full) for threads in (1, 2)] for name, kind, full in kinds]
        for _ in range(PASSES)
    ]
    found = []
    for (name, kind, full), seconds in zip(kinds, np.min(passes, axis=0), strict=True):
        target = ">= 10 M/s on one" if (name, kind, full) == ("100 000", "bilinear", ()) else ""
        rates = [rate(np.prod(MESHES[name]), each) for each in seconds]
        found.append((name, f"{kind}, {'full' if full else 'one point'}", *rates, target))
    return found


def contact_rows():
    """Return what contact costs on one and two threads."""
    found = []
    for name, shift in (("nodes over faces", 0.3), ("nodes over corners, where four faces are as close", 0.0)):
        for threads in (1, 2):
            touching, apart = contact_cost(threads, shift)
            cost = f"{touching / apart - 1.0:+.0%}"
            found.append((name, str(threads), write(apart), write(touching), cost, "<= 25 %"))
    return found


def limit_rows():
    """Return the shares of the two limits that 100 000 bilinear elements reach on one core."""
    counted = operations.counted()
    peak, bandwidth = limits()
    elements = 100_000
    seconds = min(one_body(MESHES["100 000"], SOLIDS["bilinear"]) for _ in range(PASSES)) / elements
    done, moved_bytes = counted["bilinear"], bytes_moved()
    counts = "; ".join(f"{name} {number}" for name, number in counted.items())
    reached = [
        ("operations", f"{done}", f"{peak / 1e9:.1f} G/s", f"{done / peak / seconds:.0%}"),
        ("bytes", f"{moved_bytes}", f"{bandwidth / 1e9:.1f} GB/s", f"{moved_bytes / bandwidth / seconds:.0%}"),
    ]
    return reached, counts


def calculix_rows():
    """Return CalculiX's rate on the mesh of 10 000 elements, from two lengths of run, and ours on the same."""
    counts = MESHES["10 000"]
    elements = int(np.prod(counts))
    ours = [elements / min(one_body(counts, STEEL, threads) for _ in range(PASSES)) for threads in (1, 2)]
    found = [("strikewave", *(f"{each / 1e6:.2f} M/s" for each in ours))]
    if calculix.CCX is None:
        return [*found, ("CalculiX", "not installed", "not installed")]
    model = Model(body(counts), {"body": STEEL}, Controls(1e-6), velocity={"body": (0.0, 0.0, 1.0)})
    row = [f"CalculiX {calculix.version()}, C3D8R, explicit"]
    for threads in (1, 2):
        runs = []
        for duration in (1e-6, 5e-6):
            longer = replace(model, controls=replace(model.controls, duration=duration))
            with tempfile.TemporaryDirectory() as folder:
                deck = calculix.Deck(longer, every=1_000_000, stressed=np.zeros(1, int))
                runs.append(min((calculix.run(deck, folder, threads) for _ in range(2)), key=lambda run: run.seconds))
        steps = 4e-6 / runs[0].step
        row.append(f"{elements * steps / (runs[1].seconds - runs[0].seconds) / 1e6:.2f} M/s")
    return [*found, tuple(row)]


def paper():
    """Return a sentence on the time of an impact of the published size, from a shorter one that was run."""
    model = pressed(threads=2)

    def ran(duration):
        controls = Controls(duration, interval=1e-6, threads=2)
        return min((solve(replace(model, controls=controls)) for _ in range(2)), key=lambda run: run.seconds)

    begun, run = ran(2e-6), ran(22e-6)
    seconds = run.seconds - begun.seconds
    steps = PAPER / run.step
    return (
        f"An impact of {PAPER * 1e3:g} ms of {run.elements} hexahedra of {SIZE * 1e3:g} mm, bilinear steel in contact with steel over "
        f"2500 faces, takes {steps:.0f} steps of {write(run.step)}. 20 us of it with its histories took {write(seconds)} on two "
        f"threads: {write(seconds * PAPER / 20e-6)} for all of it."
    )


def section():
    """Return the section of the page of benchmarks."""
    reached, counts = limit_rows()
    return f"""## Explicit elements

Element-steps a second of cubes of {SIZE * 1e3:g} mm that move at random (most elements yield where they can), whole steps with
the motion of the nodes and the energy balance; the best of {PASSES} passes:

{table(("elements", "kind", "one thread", "two threads", "target"), rows())}

Contact: two blocks of 50 000 bilinear elements pressed on each other, 2500 faces and 2601 nodes a side, all of which touch:

{table(("meshes", "threads", "step without", "step with contact", "cost", "target"), contact_rows())}

The two limits of one core, for 100 000 bilinear elements with one point:

{table(("limit", "an element and step", "the core", "share reached"), reached)}

Operations are counted by running the kernels on numbers that count (benchmarks/operations.py): {counts}. The core's are those
of fused multiply-adds that stay in the cache, a product and a sum each. Bytes: {layout.CONSTANTS} constants and 8 node numbers
read, {int(layout.BACK[0]) // layout.LANES} numbers of state read and written, and {NODE_BYTES} bytes of the one node that each element has: x and v read for the
elements, forces cleared and summed, then x, v, forces and 1/m read and x and v written. The core's are those of STREAM's
triad, where a line that is written is first read (32 bytes a number).

CalculiX on the same mesh of 10 000 elastic elements; its rate follows from runs of 1 us and of 5 us:

{table(("code", "one thread", "two threads"), calculix_rows())}

{paper()}"""


if __name__ == "__main__":
    print(section())
