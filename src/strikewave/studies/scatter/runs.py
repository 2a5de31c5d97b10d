"""Full runs of a machine within its tolerances, on several processes, with the same result whatever their number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.base.errors import InputError, IntegrationError, show
from strikewave.base.result import RUN_FAILED
from strikewave.base.shock_quantities import PULSE_WIDTH, TOTAL_PEAK, VELOCITY_CHANGE
from strikewave.cases.case import Case
from strikewave.machines import Blow, Machine, MachineRun, blows, run_machine
from strikewave.machines.blows import KINDS
from strikewave.studies.engine.evaluation import MOST_REASON, Job, KeptHistory, RunOutcome
from strikewave.studies.engine.plan import DrawVariation
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.studies.simulation import FINER_TOLERANCE, RUN_TOLERANCE
from strikewave.uncertainty.draws import UncertainInput
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

FIGURES = {
    "peak": TOTAL_PEAK._replace(label="peak"),
    "width": PULSE_WIDTH._replace(decimals=None, digits=5),
    "interval": Quantity("s", "ms", "interval", digits=5),
    "velocity_change": VELOCITY_CHANGE._replace(label="velocity change", decimals=None, digits=5),
}
"""Figures of each blow and what they measure: attributes of `RunResult` and of `Blow`, whose ``rigid_peak`` is called
peak here."""
UNITS = {"kind": NO_UNIT, **{name: one.si for name, one in FIGURES.items()}}
"""SI units of what is kept of each blow; kinds by their place in `KINDS`."""
TYPICAL_KINDS = ("full", "double")
"""Kinds of blow that may be typical: a glancing or missed one has no pulse of the whole striker."""


def _none() -> Array:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class RunResult:
    """Result of one run: kind and figures of each blow in order of time, SI; NaN where a blow has none.

    ``interval`` is the time since the blow before; NaN where that one missed. A run that could not be made has no
    blows, and says why in ``failure``. ``verdict`` is the text of `strikewave.base.result.Verdict`; empty where no
    verdict was kept.
    """

    kinds: tuple[str, ...] = ()
    peak: Array = field(default_factory=_none)
    width: Array = field(default_factory=_none)
    interval: Array = field(default_factory=_none)
    velocity_change: Array = field(default_factory=_none)
    largest_displacement: float = np.nan
    failure: str = ""
    verdict: str = ""

    @property
    def struck(self) -> NDArray[np.bool_]:
        """Which of the blows struck."""
        return np.array([kind != "missed" for kind in self.kinds], dtype=bool)

    def figure(self, name: str, later: bool = False) -> Array:
        """Return a figure of the blows that have one; with ``later`` without the first blow."""
        values: Array = getattr(self, name)[self.struck][1 if later else 0 :]
        return values[np.isfinite(values)]

    def mean(self, name: str) -> float:
        """Return the mean of a figure over the blows, NaN where there is none."""
        values = self.figure(name)
        return float(np.mean(values)) if values.size else np.nan

    def typical(self, name: str) -> float:
        """Return the median of a figure over the later full or double blows, NaN where there is none."""
        later = np.array([kind in TYPICAL_KINDS for kind in self.kinds], dtype=bool)
        later[: int(np.argmax(self.struck)) + 1 if self.struck.any() else 0] = False
        values = getattr(self, name)[later]
        values = values[np.isfinite(values)]
        return float(np.median(values)) if values.size else np.nan

    def variation(self, name: str, later: bool = False) -> float:
        """Return the coefficient of variation of a figure over the blows, NaN where there are too few."""
        return variation(self.figure(name, later))

    def over(self, other: RunResult) -> RunResult:
        """Return the run with its peaks over those of the same blows of another."""
        ratio = np.full(self.peak.size, np.nan)
        both = min(self.peak.size, other.peak.size)
        ratio[:both] = self.peak[:both] / other.peak[:both]
        return replace(self, peak=ratio)


def run_result(case: Case) -> RunResult:
    """Run a machine case and return what its blows were; what cannot be run says why.

    A motion that cannot be followed is tried again with `FINER_TOLERANCE`.
    """
    try:
        machine = build_machine(case)
        run = _followed(machine)
        train = blows(run)
        return replace(of_blows(train), verdict=run_verdict(case, run, train).text)
    except (InputError, IntegrationError, ValueError) as error:
        return RunResult(failure=show(str(error), MOST_REASON).strip('"'), verdict=RUN_FAILED)


def _followed(machine: Machine) -> MachineRun:
    try:
        return run_machine(machine, RUN_TOLERANCE)
    except IntegrationError:
        return run_machine(machine, FINER_TOLERANCE)


def of_blows(train: Sequence[Blow]) -> RunResult:
    """Return kinds and figures of the blows of a run."""
    missed = np.array([blow.kind == "missed" for blow in train], dtype=bool)
    times = np.array([blow.time for blow in train])
    interval = np.diff(times, prepend=np.nan)
    interval[missed | np.concatenate([[True], missed[:-1]])[: times.size]] = np.nan
    change = np.where(missed, np.nan, [blow.velocity_change for blow in train])
    displacements = [blow.largest_displacement for blow in train if np.isfinite(blow.largest_displacement)]
    return RunResult(
        kinds=tuple(blow.kind for blow in train),
        peak=np.array([blow.rigid_peak for blow in train]),
        width=np.array([blow.width for blow in train]),
        interval=interval,
        velocity_change=change,
        largest_displacement=max(displacements, default=np.nan),
    )


@dataclass(frozen=True)
class TrainEvaluation:
    """What is kept of a full run: kind and figures of each blow."""

    names: tuple[str, ...] = ("largest_displacement",)

    def __call__(self, case: Case) -> RunOutcome:
        """Return what the blows of a case are; a run that cannot be made says why."""
        run = run_result(case)
        if run.failure:
            return RunOutcome(failure=run.failure)
        kinds = np.array([KINDS.index(kind) for kind in run.kinds], dtype=float)
        kept = {"kind": kinds, **{name: getattr(run, name) for name in FIGURES}}
        histories = [KeptHistory(name, UNITS[name], 0, np.nan, np.nan, values) for name, values in kept.items()]
        return RunOutcome((run.largest_displacement,), tuple(histories), verdict=run.verdict)


@dataclass
class Runner:
    """Runs a case at drawn values, each alone, so that no number depends on it; ``advance`` takes how many are done.

    Attributes
    ----------
    case : Case
        Case of a machine.
    tolerances : tuple of UncertainInput
        Inputs whose values are drawn.
    store : RunStore
        Finished runs.
    pool : Pool
        Who runs them.
    """

    case: Case
    tolerances: tuple[UncertainInput, ...]
    store: RunStore
    pool: Pool
    advance: Callable[[int], None] = lambda done: None
    done: int = 0

    def __call__(self, rows: Array) -> list[RunResult]:
        """Return a run for each row of drawn values, in their order."""
        job, begun = Job(DrawVariation(self.case, self.tolerances), TrainEvaluation()), self.done
        places = [tuple(row) for row in rows.tolist()]
        keys = carry_out(job, places, self.store, self.pool, lambda now: self.advance(begun + now.done)).keys
        self.done += len(places)
        self.advance(self.done)  # runs that the store had already came in no batch
        return kept_runs(self.store, keys)


def kept_runs(store: RunStore, keys: Sequence[bytes]) -> list[RunResult]:
    """Return runs that a store has, in the order of their keys."""
    wanted = dict.fromkeys(keys)
    blows: dict[bytes, dict[str, Array]] = {key: {} for key in wanted}
    for key, history in store.histories():
        if key in wanted:
            blows[key][history.name] = history.values
    numbers, failures, _ = store.table(TrainEvaluation().names, keys)
    verdicts = store.verdicts(keys).texts
    runs = []
    for key, (displacement,), failure, verdict in zip(keys, numbers, failures, verdicts, strict=True):
        of_run: dict[str, Any] = {} if failure else {"largest_displacement": float(displacement), **blows[key]}
        of_run["kinds"] = tuple(KINDS[int(code)] for code in of_run.pop("kind", ()))
        runs.append(RunResult(failure=failure, verdict=verdict, **of_run))
    return runs
