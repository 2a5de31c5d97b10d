"""Full runs of a machine within its tolerances, on several processes, with the same result whatever their number."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputError, InputErrors, IntegrationError, show
from strikewave.cases.case import Case
from strikewave.machines import Blow, Machine, MachineRun, blows, run_machine
from strikewave.studies.accuracy import FINER_TOLERANCE, RUN_TOLERANCE
from strikewave.studies.workers import Workers
from strikewave.uncertainty.draws import UncertainInput, drawn_case
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

CHUNK = 4
"""Runs that a process is given at a time: some 0.3 s of work, so that handing it over costs little, and progress still
moves and the last process ends soon after the others."""
FIGURES = ("peak", "width", "interval", "velocity_change")
"""Figures of each blow: attributes of `RunResult` and of `Blow`, whose ``rigid_peak`` is called peak here."""
TYPICAL_KINDS = ("full", "double")
"""Kinds of blow that may be typical: a glancing or missed one has no pulse of the whole striker."""
MOST_REASON = 200
"""Characters of the reason why a run failed, so that it stays in a cell of a table."""


def _none() -> Array:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class RunResult:
    """Result of one run: kind and figures of each blow in order of time, SI; NaN where a blow has none.

    ``interval`` is the time since the blow before; NaN where that one missed. A run that could not be made has no
    blows, and says why in ``failure``.
    """

    kinds: tuple[str, ...] = ()
    peak: Array = field(default_factory=_none)
    width: Array = field(default_factory=_none)
    interval: Array = field(default_factory=_none)
    velocity_change: Array = field(default_factory=_none)
    largest_displacement: float = np.nan
    failure: str = ""

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
        return of_blows(blows(_followed(machine)))
    except (InputError, InputErrors, IntegrationError, ValueError) as error:
        return RunResult(failure=show(str(error), MOST_REASON).strip('"'))


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


def _run_chunk(case: Case, tolerances: tuple[UncertainInput, ...], rows: Array) -> list[RunResult]:
    return [run_result(drawn_case(case, tolerances, row)) for row in rows]


class Runner:
    """Runs a case at drawn values; a context manager that holds its processes.

    Parameters
    ----------
    case : Case
        Of a machine.
    tolerances : tuple of UncertainInput
        What is drawn.
    workers : int, optional
        Processes; with 1 everything runs in this one. Each run is computed alone, so that their number changes no bit.
    advance : callable, optional
        Called with the number of runs done so far.
    """

    def __init__(
        self,
        case: Case,
        tolerances: tuple[UncertainInput, ...],
        workers: int = 1,
        advance: Callable[[int], None] | None = None,
    ) -> None:
        self._run_chunk = functools.partial(_run_chunk, case, tolerances)
        self._advance = advance
        self._done = 0
        self._workers = Workers(workers)

    def __enter__(self) -> Runner:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._workers.__exit__(kind, error, trace)

    def __call__(self, rows: Array) -> list[RunResult]:
        """Return a run for each row of drawn values, in their order.

        Raises
        ------
        StrikewaveError
            If a process came to an end before its time.
        """
        chunks = [rows[k : k + CHUNK] for k in range(0, len(rows), CHUNK)]
        results: list[RunResult] = []
        for part in self._workers.in_order(self._run_chunk, chunks):
            results += part
            self._done += len(part)
            if self._advance is not None:
                self._advance(self._done)
        return results
