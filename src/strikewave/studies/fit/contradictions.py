"""What a record says that no value of the case can give: a blow slower than the machine arrives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from strikewave.base.result import Notice
from strikewave.studies.fit.measured import MeasuredPulse
from strikewave.studies.fit.problem import Problem
from strikewave.studies.simulation import Simulation

READ_WELL = 0.97
"""Share of the least velocity change that a record may lack: a shock accelerometer reads to some 3 %."""


def speed_notices(problem: Problem, runs: Sequence[Simulation]) -> Iterator[Notice]:
    """Warn of records whose velocity change is below that of a blow without rebound.

    Two bodies that are free and stay together leave the object with ``v M/(M + m)`` of the speed v at which they meet,
    M the mass of the striker or base and m that of the object; whatever is given back adds to it.

    Parameters
    ----------
    problem : Problem
        What is fitted to.
    runs : sequence of Simulation
        Of each experiment, at the fitted values.
    """
    for experiment, run in zip(problem.experiments, runs, strict=True):
        least = _least_change(run) if run.case.command == "run" and run.case.launched() else None
        if least is None:
            continue
        arrival, change = least
        for one in experiment.measured:
            if not isinstance(one, MeasuredPulse) or one.unit != "m/s^2":
                continue
            measured = abs(float(np.trapezoid(one.values, one.time)))
            if measured < READ_WELL * change:
                height = getattr(run.case.machine, "height", None)
                field = "the speed at which the machine arrives" if height is None else "machine.height"
                stated = "" if height is None else f", from machine.height = {height.si:.4g}\xa0m"
                message = (
                    f"the velocity change of {one.called}, {measured:.3g}\xa0m/s, is below the {change:.3g}\xa0m/s "
                    f"that even a blow without rebound gives at {arrival:.3g}\xa0m/s{stated}: no restitution and no "
                    f"pad explains it; correct {field}, or free it"
                )
                yield Notice("slower-than-arrival", message, measured, change)


def _least_change(run: Simulation) -> tuple[float, float] | None:
    """Return the speed at which two free bodies meet in a run, and the least velocity change, m/s; None of others."""
    machine = run.observed.machine
    striker = machine.strikers.first
    blow = next((one for one in run.observed.blows if one.kind != "missed"), None)
    if blow is None or machine.launch.arm is not None or striker.mount_stiffness > 0.0:
        return None
    return blow.approach_speed, blow.approach_speed * striker.mass / (striker.mass + machine.struck.mass)
