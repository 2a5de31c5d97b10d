"""The rotary machine: full runs, fast runs, and a map of settings."""

import os
import time

import numpy as np
from timing import best, table, write

from strikewave import load_case
from strikewave.machines import run_machine
from strikewave.machines.fast_run import fast_train
from strikewave.studies.axes import axis_of
from strikewave.studies.map.cells import machine_of
from strikewave.studies.map.study import make_map, plan_of

SIDE, TRAIN = 200, 60
SAMPLE = 20
"""Cells along each side that are timed; the time of the whole map follows from them."""
STAGES = 16
"""Evaluations of the rates in a step with its dense output (Hairer, Norsett & Wanner)."""
STATES = 18
"""Of a blow: three bodies, turntable and belt, energies."""
TOUCHED = 2 * 8 * (STAGES * (STAGES + 1) // 2 + 8 * STAGES) * STATES
"""Bytes that the weighted sums of a step and of its dense output read and write, at least."""


def floor():
    """Return the least time of a step, s: its sums at the speed at which numpy adds and multiplies in the cache."""
    x = np.ones(1000)
    out = np.empty_like(x)
    each = best(lambda: [np.multiply(x, 1.1, out=out) for _ in range(1000)]) / (1000 * 24 * x.size)
    return each * TOUCHED


def rows():
    """Return runs of eleven blows."""
    machine = machine_of(load_case("li-ma-2019"))
    found = [
        (
            f"full run, 11 blows, tolerance {tolerance:g}",
            write(best(lambda t=tolerance: run_machine(machine, t))),
            "",
            "",
        )
        for tolerance in (1e-9, 1e-7)
    ]
    least = floor()
    for name, blows in (("fast run, 11 blows", None), (f"fast run, {TRAIN} blows", TRAIN)):
        seconds = best(lambda b=blows: fast_train(machine, b))
        steps = sum(fast_train(machine, blows).steps)
        found.append(
            (name, write(seconds), f"{steps} steps of {write(seconds / steps)}", f"{seconds / steps / least:.0f} x")
        )
    return found


def maps(workers):
    """Return the time of a map on some processes, from a coarser one over the same ranges."""
    case = load_case("li-ma-2019")
    axes = (axis_of(case, "machine.speed", None, SAMPLE, False), axis_of(case, "object.spring", None, SAMPLE, True))
    found = []
    for train in (0, TRAIN):
        plan = plan_of(case, axes, None, train)
        make_map(plan, 0.02)
        begun = time.perf_counter()
        make_map(plan, 0.02)
        cell = (time.perf_counter() - begun) / SAMPLE**2
        name = f"map {SIDE} x {SIDE}, 11 blows" + (f", regimes from {train}" if train else "")
        found.append((name, write(cell * SIDE**2 / workers), f"{write(cell)} a cell", ""))
    return found


def section():
    """Return the section of the page of benchmarks."""
    workers = min(2, os.cpu_count() or 1)
    return f"""## The machine, fast and mapped

{table(("work", "time", "which is", "above the floor"), rows() + maps(workers))}

Times of maps are those of {SAMPLE} x {SAMPLE} cells on one core, times {SIDE**2 // SAMPLE**2}, over {workers} cores.
Floor: the sums of a step of DOP853 with its dense output, {STATES} states, {TOUCHED // 1000} kB, at the speed at which
numpy multiplies in the cache; the forces come on top."""


if __name__ == "__main__":
    print(section())
