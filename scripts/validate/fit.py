"""Planted fits: cases with values of their own, records with noise, and whether intervals of the fit hold the truth.

    python scripts/validate/fit.py [--drops 60] [--pendulums 30] [--bars 30] [--pairs 30] [--shots 30]

A drop table, a pendulum hammer and a layered bar get values that are off by up to 30 %; an ideal recorder writes what a
run of each gives, with white or coloured noise of 0.5 to 3 % of the peak. The case as it is built in is fitted to it.
Of the 95 % intervals, 95 % shall hold the truth (one standard deviation of chance: sqrt(0.95 0.05/n)). Of the pairs,
two fields act as one: they shall be named each time, and nothing of them be called determined. Of the shots, 1, 2, 5
and 10 records of a drop whose amplitudes scatter by 2 % are fitted at once; that of one is stated.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from strikewave import load_case
from strikewave.cases.case import Case
from strikewave.signal.resampling import resampled
from strikewave.studies.fit.study import fit
from strikewave.studies.simulation import Simulation

QUIET = 0.02
"""Noise before the run begins that is recorded too, s: what is known of its colour comes from there."""
KINDS = {
    "drops": (
        "jesd22-b111-b",
        ["contact.restitution=0.7"],
        ("contact.reference_force", "contact.restitution"),
        200e3,
        "",
    ),
    "pendulums": ("mil-s-901d-hammer", [], ("object.mass", "contact.restitution"), 200e3, ""),
    "bars": ("li-ma-2019-fig13-bar", [], ("load.peak", "load.duration"), 5e6, "sensor.force"),
}
"""Case, settings, fields, sampling rate of the record, Hz, and part of the run."""
SCATTER = 0.02
"""Standard deviation of the amplitude of shots."""
PAIR = ("contact.reference_force", "contact.reference_depth", "contact.restitution")
"""Three fields of the drop table, of which a linear contact feels the first two as their quotient alone."""


def moved(case: Case, fields: tuple[str, ...], rng: np.random.Generator) -> Case:
    """Return a case with fields of its own: up to 30 % off, and no more than a share may be."""
    values = case.values()
    changes = {}
    for path in fields:
        size = values[path].si * math.exp(rng.uniform(-0.3, 0.3))
        size = min(size, 0.95) if "restitution" in path else size
        changes[path] = values[path].model_copy(update={"si": size})
    return case.with_values(changes)


def write_record(path: Path, case: Case, part: str, rate: float, rng: np.random.Generator, scatter: float = 0.0) -> str:
    """Write the record of a run with noise before it and on it; half of them have coloured noise."""
    curve = Simulation(case).history(part)
    ratio = 1.0 / rate / curve.history.step
    places = (np.arange(int((curve.history.values.size - 1) / ratio) - 1) + rng.random()) * ratio
    values = resampled(curve.history.values, places, ratio)
    values = np.concatenate([np.full(min(int(QUIET * rate), 4000), values[0]), values])
    colour = rng.choice([0.0, 0.8])
    noise = lfilter([math.sqrt(1.0 - colour**2)], [1.0, -colour], rng.standard_normal(values.size + 100))[100:]
    values = (
        values * (1.0 + scatter * rng.standard_normal()) + rng.uniform(0.005, 0.03) * np.max(np.abs(values)) * noise
    )
    table = np.column_stack([np.arange(values.size) / rate, values])
    np.savetxt(path, table, delimiter=",", header=f"time (s),gauge ({curve.unit.replace('^', '')})", comments="")
    return f"{part}={path}" if part else str(path)


def coverage(kind: str, count: int, folder: Path) -> None:
    """Print how many intervals hold the truth."""
    name, settings, fields, rate, part = KINDS[kind]
    case, inside, total, named = load_case(name, settings), 0, 0, 0
    for seed in range(count):
        rng = np.random.default_rng(5000 + seed)
        truth = moved(case, fields, rng)
        study = fit(case, [write_record(folder / f"{kind}-{seed}.csv", truth, part, rate, rng)], fields)
        named += bool(study.undetermined)
        for one in study.parameters:
            if one.determined:
                total += 1
                inside += one.low <= truth.values()[one.field.path].si <= one.high
    chance = 100.0 * math.sqrt(0.95 * 0.05 / max(total, 1))
    share = 100.0 * inside / max(total, 1)
    print(f"{kind}: {share:.1f} % of {total} intervals (95 ± {chance:.1f}); {named} with undetermined", flush=True)


def pairs(count: int, folder: Path) -> None:
    """Print how often two fields that are one are named, and nothing else."""
    case, right = load_case("jesd22-b111-b", ["contact.restitution=0.7"]), 0
    for seed in range(count):
        rng = np.random.default_rng(7000 + seed)
        truth = moved(case, PAIR, rng)
        study = fit(case, [write_record(folder / f"pair-{seed}.csv", truth, "", 200e3, rng)], PAIR)
        right += study.undetermined == [list(PAIR[:2])]
    print(f"pairs: named, and they alone, in {right} of {count}", flush=True)


def shots(count: int, folder: Path) -> None:
    """Print how many intervals of several shots that scatter hold the truth, and their standard errors."""
    name, settings, fields, rate, part = KINDS["drops"]
    case = load_case(name, settings)
    for records in (1, 2, 5, 10):
        inside, errors = 0, []
        for seed in range(count):
            rng = np.random.default_rng(9000 + seed)
            truth = moved(case, fields, rng)
            to = [
                write_record(folder / f"shot-{seed}-{k}.csv", truth, part, rate, rng, SCATTER) for k in range(records)
            ]
            stated = f" +- {100.0 * SCATTER:g} %" if records == 1 else ""
            study = fit(case, [f"{one}{stated}" for one in to], fields)
            inside += sum(one.low <= truth.values()[one.field.path].si <= one.high for one in study.parameters)
            errors.append([one.standard_error / one.value for one in study.parameters])
        share, mean = 100.0 * inside / (2 * max(count, 1)), 100.0 * np.sqrt(np.mean(np.square(errors), axis=0))
        print(
            f"{records} shots: {share:.1f} % of {2 * count} intervals; errors {mean[0]:.2f} and {mean[1]:.2f} %",
            flush=True,
        )


def main() -> None:
    """Run the studies that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    for kind, usual in (("drops", 60), ("pendulums", 30), ("bars", 30), ("pairs", 30), ("shots", 30)):
        parser.add_argument(f"--{kind}", type=int, default=usual)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            coverage(kind, getattr(asked, kind), Path(folder))
        pairs(asked.pairs, Path(folder))
        if asked.shots:
            shots(asked.shots, Path(folder))


if __name__ == "__main__":
    main()
