"""How long a sweep takes, by a few of its runs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from strikewave.studies.engine.store import RunStore
from strikewave.studies.sweep.study import SweepPlan

TRIED = 3
"""Runs that are timed: the first, the middle and the last one, after one that loads what a process needs."""


class SweepEstimate(NamedTuple):
    """How much there is to do.

    Attributes
    ----------
    runs, finished : int
        In all, and those that a store has.
    run_seconds : float
        About how long one takes, s; NaN where none is left.
    seconds : float
        About how long all that are left take on so many processes, s.
    workers : int
        Processes.
    """

    runs: int
    finished: int
    run_seconds: float
    seconds: float
    workers: int

    @property
    def words(self) -> str:
        """What is to be done, in words.

        Examples
        --------
        >>> SweepEstimate(100, 40, 0.5, 15.0, 2).words
        '100 runs, 40 of them finished: about 15 s for the others, 0.5 s each on 2 processes'
        """
        done = f"{self.runs} runs, {self.finished} of them finished" if self.finished else f"{self.runs} runs"
        if self.finished == self.runs:
            return f"{done}: nothing is left"
        processes = f"{self.workers} processes" if self.workers > 1 else "one process"
        others = " for the others" if self.finished else ""
        return f"{done}: about {lasting(self.seconds)}{others}, {self.run_seconds:.2g} s each on {processes}"


def lasting(seconds: float) -> str:
    """Write how long something takes.

    Examples
    --------
    >>> lasting(0.2), lasting(90.0), lasting(3.2 * 3600)
    ('1 s', '90 s', '3.2 h')
    """
    if seconds < 120.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def estimated(plan: SweepPlan, store: RunStore, workers: int) -> SweepEstimate:
    """Return how much there is to do, by some runs that are made and thrown away.

    Parameters
    ----------
    plan : SweepPlan
        What is run.
    store : RunStore
        Finished runs.
    workers : int
        Processes.
    """
    known = store.known()
    keys = {plan.job.key(row): row for row in plan.rows}
    left = [row for key, row in keys.items() if key not in known]
    finished = len(keys) - len(left)
    if not left:
        return SweepEstimate(len(keys), finished, float("nan"), 0.0, workers)
    places = sorted({0, len(left) // 2, len(left) - 1})[:TRIED]
    job = plan.job
    job([left[0]])
    each = float(np.mean([outcome.seconds for outcome in job([left[place] for place in places])]))
    return SweepEstimate(len(keys), finished, each, each * len(left) / workers, workers)
