"""The runs that reproduce Li & Ma 2019, and their execution: a stopped one continues from what it stored."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from strikewave.analyses.machine.result import Solution
from strikewave.analyses.machine.run import run_case
from strikewave.analyses.wave.result import WaveSolution
from strikewave.analyses.wave.run import run_wave
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import Result
from strikewave.cases.case import Case, load_case
from strikewave.cases.files import bundled_cases
from strikewave.studies.engine.evaluation import run_key
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.questions import Failure, OfCase, answers
from strikewave.studies.engine.runner import StudyProgress
from strikewave.studies.engine.store import RunStore, given_or_temporary

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

Answer = TypeVar("Answer")
Report = Callable[[float, str], None]
"""Takes the share done, 0 to 1, and the name of the current stage."""


def silent(share: float, stage: str) -> None:
    """Report nothing."""


def within(report: Report, begin: float, end: float, what: str = "") -> Report:
    """Return a report of a stage that goes from one share to another; ``what`` stands before its name.

    Examples
    --------
    >>> within(lambda share, stage: print(share, stage), 0.5, 1.0, "a case")(0.5, "builds the mesh")
    0.75 a case: builds the mesh
    """
    return lambda share, stage: report(begin + (end - begin) * share, ": ".join(filter(None, (what, stage))))


@dataclass(frozen=True)
class Execution:
    """The store of finished runs, the pool for others, threads of a run of elements, and the report of progress."""

    store: RunStore
    pool: Pool
    threads: int = 1
    report: Report = silent

    def within(self, begin: float, end: float, what: str = "") -> Execution:
        """Return the execution of a stage; see `within`."""
        return replace(self, report=within(self.report, begin, end, what))

    def answers(self, stage: str, questions: Sequence[OfCase[Answer]]) -> list[Answer]:
        """Return the answers to questions, in their order; raise `StrikewaveError` for one that failed."""

        def advance(now: StudyProgress) -> None:
            self.report(now.share, f"{stage}: {now.done} of {now.total}")

        self.report(0.0, stage)
        results: list[Answer] = []
        for answer, question in zip(answers(questions, self.store, self.pool, advance), questions, strict=True):
            if isinstance(answer, Failure):
                raise StrikewaveError(f"{question.case.name}: {answer.reason}")
            results.append(answer)
        return results

    def elements(self, case: Case) -> FemSolution:
        """Return the run of a case of elements, from the last stored state if it was stopped."""
        from strikewave.analyses.fem.build import build_model
        from strikewave.analyses.fem.run import run_model
        from strikewave.fem.solve import Checkpoint, Progress, RunOptions

        def seen(progress: Progress) -> None:
            left = f"{progress.left:.0f} s left of this run" if progress.time else ""
            self.report(progress.time / progress.duration, left)

        self.report(0.0, "builds the mesh")
        model, state = build_model(case, self.threads), self.store.state(run_key(case, "elements"))
        options = RunOptions(report=seen, checkpoint=Checkpoint(state))
        if any(state.parent.glob(f"{state.stem}*")):
            with contextlib.suppress(InputError):  # a state that cannot be read: begin anew
                return run_model(case, model, options._replace(resume=state))
        return run_model(case, model, options)


@contextlib.contextmanager
def executing(
    store: RunStore | None = None, pool: Pool | None = None, threads: int = 1, report: Report = silent
) -> Iterator[Execution]:
    """Give an execution with the store and pool that are given, or in this process, for as long as it takes."""
    with given_or_temporary(store) as open_store, pool or ProcessPool(1) as open_pool:
        yield Execution(open_store, open_pool, threads, report)


MACHINE, COMPARISON, FIXTURE, BAR, EQUAL_BLOWS = (
    "li-ma-2019",
    "li-ma-2019-fig5",
    "li-ma-2019-fig13",
    "li-ma-2019-fig13-bar",
    "li-ma-2019-equal-blows",
)
RIGID_ELEMENTS, QUIET_ELEMENTS = "li-ma-2019-fem-rigid", "li-ma-2019-fem-rigid-quiet"
WAVE_ELEMENTS, QUIET_WAVE_ELEMENTS = "li-ma-2019-fem-wave", "li-ma-2019-fem-wave-quiet"
"""The object of Figure 11 and the sensor of Figure 15, each also with non-reflecting faces."""
NON_REFLECTING = (QUIET_ELEMENTS, QUIET_WAVE_ELEMENTS)
"""Cases whose faces are as in the paper's own simulations."""
ELEMENT_CASES = (RIGID_ELEMENTS, QUIET_ELEMENTS, WAVE_ELEMENTS, QUIET_WAVE_ELEMENTS)
COARSER, SHORTER = 1.25, "fem.duration=400 us"
"""Growth of elements in a quick run, and its duration: twice the published width. The time of a run falls with the 4th
power of the size, here to two fifths."""
PASSING = (
    "stack.layer.sensor.material=2A12",
    "stack.layer.upper.length=60 mm",
    "stack.layer.lower.length=60 mm",
    "load.shape=trapezoid",
    "load.duration=60 us",
    "load.rise=0.3 us",
    "solver.step=2 ns",
    "solver.duration=30 us",
)
"""Changes to `BAR` that make a wave reflect again and again in its middle layer: aluminium under a steep front."""


@dataclass(frozen=True)
class Effort:
    """The amount of work."""

    quick: bool = False
    """True for coarser elements."""
    elements: bool = True
    """True if the finite-element models are run."""
    threads: int = 1
    """Threads of those models."""
    studies: bool = True
    """True if those models are also studied: meshes, assumed dimensions, a second blow; never where quick."""


@dataclass(frozen=True)
class Runs:
    """The solutions that the reproduction rests on."""

    machine: Solution  # Figures 9 and 11
    comparison: Solution  # Figure 5
    fixture: Solution  # Figure 13
    equal_blows: Solution  # the same machine, adjusted for equal blows
    bar: WaveSolution  # the sensor fixture under a front of 5 us
    passing: WaveSolution  # a stack with multiple reflections, Figure 7
    elements: tuple[FemSolution, ...]  # Figures 11 and 15; empty where they were left out
    quick: bool  # whether their meshes are coarse

    @property
    def impacts(self) -> tuple[Solution, ...]:
        """The machine cases."""
        return self.machine, self.comparison, self.fixture, self.equal_blows

    @property
    def checked(self) -> tuple[tuple[str, str], ...]:
        """Name of each run, and the verdict of its checks."""
        solutions: list[Result] = [*self.impacts, self.bar, self.passing, *self.elements]
        return tuple((solution.source.name, solution.own_verdict.text) for solution in solutions)

    @property
    def cases(self) -> tuple[Case, ...]:
        """All built-in cases that were run, each once."""
        return (
            *(solution.case for solution in self.impacts),
            self.bar.case,
            *(solution.case for solution in self.elements),
        )

    def element_solution(self, case: str) -> FemSolution | None:
        """Return the solution of a finite-element model, or None."""
        return next((solution for solution in self.elements if solution.case.name == case), None)


def run_all(effort: Effort, execution: Execution) -> Runs:
    """Run everything, with that effort and execution.

    Examples
    --------
    >>> from strikewave.papers.li_ma_2019.runs import executing
    >>> with executing() as execution:
    ...     runs = run_all(Effort(elements=False), execution)
    >>> [len(solution.blows) for solution in runs.impacts]
    [11, 7, 11, 11]
    """
    short = (MACHINE, COMPARISON, FIXTURE, EQUAL_BLOWS)
    models = element_cases(effort) if effort.elements else []
    # the elements take minutes, all machines seconds
    share = 0.1 if models else 1.0
    impacts = []
    for k, name in enumerate(short):
        execution.report(share * k / (len(short) + 1), name)
        impacts.append(run_case(load_case(name)))
    execution.report(share * len(short) / (len(short) + 1), BAR)
    machine, comparison, fixture, equal_blows = impacts
    bar, passing = run_wave(load_case(BAR)), run_wave(load_case(BAR, PASSING))
    elements = []
    for k, case in enumerate(models):
        begin, end = (share + (1.0 - share) * place / len(models) for place in (k, k + 1))
        elements.append(execution.within(begin, end, case.name).elements(case))
    execution.report(1.0, "")
    return Runs(machine, comparison, fixture, equal_blows, bar, passing, tuple(elements), effort.quick)


def element_cases(effort: Effort) -> list[Case]:
    """Return the finite-element models to run."""
    cases = [load_case(name) for name in ELEMENT_CASES if name in bundled_cases()]
    return [load_case(case.name, quick_changes(case.name)) for case in cases] if effort.quick else cases


def quick_changes(name: str) -> list[str]:
    """Return the changes of a quick run to a finite-element model."""
    return [*coarser(load_case(name)), SHORTER, "compare=true"]


def coarser(case: Case, factor: float = COARSER) -> list[str]:
    """Return the changes that make the elements of a case larger.

    Examples
    --------
    >>> coarser(load_case("two-bars-fem"))
    ['mesh.part.striker.size=1.25 mm', 'mesh.part.bar.size=1.25 mm']
    """
    return [
        f"mesh.part.{part.name}.{field}={1e3 * factor * value.si:g} mm"
        for part in (case.mesh.part if case.mesh else ())
        for field in ("size", "finest")
        if (value := getattr(part, field, None)) is not None
    ]
