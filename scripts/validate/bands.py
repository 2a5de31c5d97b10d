"""Bands of runs against brute force: the share of full runs at independent random draws that lie within each band.

For a rotary machine as published, the same under settings it was not fitted to, one of one's own with six strikers on
a smaller turntable, machines that strike once (one on a named pad, one whose contact yields by its material), and the
first blow of a machine with a stack of named materials and a sensor: the band as `strikewave run` finds it, then full
runs, none of which uses the fast engine, the Latin hypercube or the fit; those of the stack have its waves.
Writes out/validate/bands.csv. ``--seeds`` tells instead what bands of other seeds hold, by the fast engine: the ends of
a band are chance too. ``--runs`` makes fewer of them, ``--only`` one machine, ``--processes`` leaves processors to
others. docs/band.md has the numbers.
"""

import argparse
import csv
import dataclasses
import functools
import os
import time
from pathlib import Path

import numpy as np

from strikewave import load_case, run_case
from strikewave.analyses.machine.band import FULL_TOLERANCE, MOST_BLOWS, TOLERANCE
from strikewave.analyses.machine.band import RUNS as BAND_RUNS
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.result import figures_of, sensor_figures
from strikewave.analyses.machine.run import with_bands
from strikewave.base.errors import StrikewaveError
from strikewave.base.quantities import Value
from strikewave.machines import blows, run_machine
from strikewave.machines.fast_run import fast_train
from strikewave.studies.engine.pools import ProcessPool
from strikewave.uncertainty.bands import Sample, find_band
from strikewave.uncertainty.draws import FELT, drawn, drawn_case, latin_hypercube
from strikewave.uncertainty.input_ranges import known_inputs

MACHINES = {
    "li-ma-2019": ("li-ma-2019", ()),
    "li-ma-2019 at 500 rpm and 1.2 kg": ("li-ma-2019", ("machine.speed=500 rpm", "striker.mass=1.2 kg")),
    "six strikers": (
        "li-ma-2019",
        ("machine.strikers=6", "machine.speed=500 rpm", "machine.radius=120 mm", "striker.mass=1.2 kg"),
    ),
    "jesd22-b111-b": ("jesd22-b111-b", ()),
    "iec-60068-2-27-rubber": ("iec-60068-2-27-rubber", ()),
    "iso-16063-22-dropball": ("iso-16063-22-dropball", ()),
    "li-ma-2019-fig13": ("li-ma-2019-fig13", ()),
}
SEED = 20190321
"""Of the draws: any but that of the bands."""
RUNS = 2000
"""The standard deviation of a share of 95 % is then 0.5 points."""
RESULTS = (
    "first.rigid_peak",
    "first.width",
    "first.velocity_change",
    "typical.rigid_peak",
    "typical.width",
    "typical.velocity_change",
    "interval",
)
COLUMNS = ("machine", "result", "low", "high", "runs", "within", "band_time", "run_time")


def full_run(item):
    """Return the results of a full run of a machine at one row of quantiles; none where it could not be followed."""
    source, changes, point = item
    case, inputs = read(source, changes)
    changed = drawn_case(case, inputs, drawn(inputs, point[None])[0].tolist())
    begin = time.process_time()
    try:
        if case.stack.layer:
            seen = observe(changed.with_values({"feed.blows": Value(si=1.0, typed=1)}))
            first = {name: value for name, value in figures_of(seen.blows).items() if name.startswith("first.")}
            figures = {**first, **sensor_figures(seen.readings)}
        else:
            figures = figures_of(blows(run_machine(build_machine(changed), FULL_TOLERANCE)))
    except (StrikewaveError, ValueError, ArithmeticError):
        figures = {}
    return figures, time.process_time() - begin


def fast_run(item):
    """Return the results of a run by the fast engine at one row of quantiles; none where it could not be followed."""
    source, changes, point = item
    case, inputs = read(source, changes)
    try:
        machine = build_machine(drawn_case(case, inputs, drawn(inputs, point[None])[0].tolist()))
        bodies = dataclasses.replace(machine, layered=None)
        return figures_of(fast_train(bodies, min(bodies.drive.feed.blows, MOST_BLOWS), tolerance=TOLERANCE).blows)
    except (StrikewaveError, ValueError, ArithmeticError):
        return {}


def in_order(workers, function, items):
    """Return what a function gives of some items."""
    return [future.result() for future in [workers.submit(function, item) for item in items]]


def over_seeds(name, runs, seeds, workers):
    """Print the share of random draws within bands of other seeds, each of as many runs as a band has."""
    source, changes = MACHINES[name]
    inputs = read(source, changes)[1]
    count = sum(one.count for one in inputs)

    def results(points):
        found = in_order(workers, fast_run, [(source, changes, point) for point in points])
        return lambda result: np.array([figures.get(result, np.nan) for figures in found])

    others = results(np.random.default_rng(SEED).random((runs, count)))
    samples = [Sample(inputs, latin_hypercube(count, BAND_RUNS, seed), seed) for seed in range(seeds)]
    found = [results(sample.points) for sample in samples]
    for result in RESULTS:
        values = others(result)
        values = values[np.isfinite(values)]
        bands = [one.band for sample, at in zip(samples, found, strict=True) if (one := find_band(sample, at(result)))]
        within = 100 * np.array([np.mean((values >= band.low) & (values <= band.high)) for band in bands])
        print(f"{name}: {result}: {within.mean():.1f} % on the mean of {len(bands)} seeds, ", end="")
        print(
            f"standard deviation {within.std():.1f} points, {np.mean(abs(within - 95) <= 3):.0%} within 3", flush=True
        )


@functools.cache
def read(source, changes):
    """Return a case and its inputs."""
    case = load_case(source, changes)
    return case, known_inputs(case, (*FELT, "sensor") if case.stack.layer else FELT)


def judged(name, runs, workers):
    """Return a row for each result with a band."""
    source, changes = MACHINES[name]
    case, inputs = read(source, changes)
    plain = run_case(case)
    begin = time.perf_counter()
    solution = with_bands(plain)
    took = time.perf_counter() - begin
    count = sum(one.count for one in inputs)
    points = np.random.default_rng(SEED).random((runs, count))
    found = in_order(workers, full_run, [(source, changes, point) for point in points])
    spent = float(np.mean([seconds for _, seconds in found]))
    rows = []
    for result, band in solution.band.items():
        values = np.array([figures[result] for figures, _ in found if result in figures])
        if not values.size:
            continue  # of later blows of the stack
        within = float(np.mean((values >= band.low) & (values <= band.high)))
        rows.append((name, result, band.low, band.high, len(values), within, took, spent))
        print(f"{name}: {result} {plain.figures[result]:.6g}, {band.low:.6g} to {band.high:.6g}: ", end="")
        print(f"{100 * within:.1f} % of {len(values)} full runs within", flush=True)
    print(f"{name}: bands {took:.2f} s, a full run {spent:.3f} s of a processor", flush=True)
    return rows


def main():
    """Judge the bands of every machine."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--only", choices=MACHINES)
    parser.add_argument("--seeds", type=int, default=0)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    words = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for the processes: matrices are small
    with ProcessPool(words.processes) as workers:
        names = [words.only] if words.only else MACHINES
        if words.seeds:
            for name in (name for name in names if name.startswith(("li-ma-2019", "six"))):
                over_seeds(name, words.runs, words.seeds, workers)
            return
        rows = [row for name in names for row in judged(name, words.runs, workers)]
    place = Path("out/validate")
    place.mkdir(parents=True, exist_ok=True)
    with open(place / "bands.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(rows)


if __name__ == "__main__":
    main()
