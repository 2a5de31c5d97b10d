"""Supports on which eleven blows of the published machine agree, and full runs within tolerances that judge them.

The design studies/equal-blows.toml of `strikewave examples`; then settings of its front, evenly spread, are each run
in full with all tolerances drawn from another seed. Writes out/validate/equal-blows.csv. Goes on where it was stopped.
"""

import argparse
import csv
import dataclasses
import os
from pathlib import Path

import numpy as np

from strikewave.cli.program_commands import EXAMPLES
from strikewave.studies.engine.pools import ProcessPool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.design import make_design
from strikewave.studies.search.plan import load_design
from strikewave.studies.search.ranking import robustness_of

FILE = EXAMPLES / "studies" / "equal-blows.toml"
PLACE = Path("out/validate")
SEED = 2
"""Of the draws that judge: those of the design have its own, 1."""
DRAWS = 60
"""Fewest full runs of which none may fail for 95 % of all to hold with 95 % confidence (Wilks): 0.95^59 < 0.05."""
JUDGED = 6
"""Settings of the front that are judged."""


def main():
    """Design, judge, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=DRAWS)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    words = parser.parse_args()
    request = load_design(FILE)
    plan = request.plan(request.case)
    PLACE.mkdir(parents=True, exist_ok=True)
    with RunStore(PLACE / "equal-blows-runs") as store:
        study = make_design(plan, store, ProcessPool(words.workers))
        front = sorted(study.front, key=lambda run: study.value(run, "stop_force"))
        chosen = [front[k] for k in np.unique(np.linspace(0, len(front) - 1, JUDGED).round().astype(int))]
        full = dataclasses.replace(plan.verifying[0], robust=words.draws, seed=SEED)
        fast = dataclasses.replace(plan, robust=words.draws, seed=SEED)
        names = ["cv", "stop_force", "largest_displacement"]
        rows = []
        with ProcessPool(words.workers) as pool:
            for run in chosen:
                row = study.rows[run]
                judged = [robustness_of(one, row, store, pool) for one in (full, fast)]
                rows.append([*row, *(study.value(run, name) for name in names), *(one.met for one in judged)])
                print(f"{study.at(row)}: ", end="")
                print(", ".join(f"{name} {study.value_words(name, study.value(run, name))}" for name in names), end="")
                print(f"; goals met in {judged[0].met} of {words.draws} full runs", end="")
                print(f" and {judged[1].met} of {words.draws} fast ones, seed {SEED}", flush=True)
        paths = [one.path for one in plan.variables]
    print(f"{len(front)} settings on the front, of {len(study.rows)} runs, of which {study.met} meet all goals")
    with open(PLACE / "equal-blows.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*paths, *names, f"full runs of {words.draws} that meet all goals", "fast runs"])
        writer.writerows(rows)


if __name__ == "__main__":
    main()
