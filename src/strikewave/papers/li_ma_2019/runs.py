"""What is run to reproduce Li & Ma 2019, and how: what is finished is kept, so that a stopped one goes on there."""

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
from strikewave.cases.case import Case, load_case
from strikewave.cases.files import bundled_cases
from strikewave.studies.engine.answers import Failure, OfCase, answers
from strikewave.studies.engine.keys import run_key
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import StudyProgress
from strikewave.studies.engine.store import RunStore, given_or_temporary

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

Answer = TypeVar("Answer")
Report = Callable[[float, str], None]
"""Takes the share done, 0 to 1, and what runs now."""


def silent(share: float, words: str) -> None:
    """Report nothing."""


def within(report: Report, begin: float, end: float, what: str = "") -> Report:
    """Return a report of a stage that goes from one share to another; ``what`` is said before its words.

    Examples
    --------
    >>> within(lambda share, words: print(share, words), 0.5, 1.0, "a case")(0.5, "builds the mesh")
    0.75 a case: builds the mesh
    """
    return lambda share, words: report(begin + (end - begin) * share, ": ".join(filter(None, (what, words))))


@dataclass(frozen=True)
class Execution:
    """Who makes runs, where finished ones are kept, and to whom they are reported.

    Attributes
    ----------
    store : RunStore
        Finished runs, and the state of those of elements.
    pool : Pool
        Who makes the others.
    threads : int
        Threads of a run of elements.
    report : callable
        Takes how far it is.
    """

    store: RunStore
    pool: Pool
    threads: int = 1
    report: Report = silent

    def within(self, begin: float, end: float, what: str = "") -> Execution:
        """Return the execution of a stage; see `within`."""
        return replace(self, report=within(self.report, begin, end, what))

    def answers(self, words: str, questions: Sequence[OfCase[Answer]]) -> list[Answer]:
        """Return the answers to questions, in their order."""

        def advance(now: StudyProgress) -> None:
            self.report(now.share, f"{words}: {now.done} of {now.total}")

        self.report(0.0, words)
        found = answers(questions, self.store, self.pool, advance)
        for one, question in zip(found, questions, strict=True):
            if isinstance(one, Failure):
                raise StrikewaveError(f"{question.case.name}: {one.reason}")
        return [one for one in found if not isinstance(one, Failure)]

    def elements(self, case: Case) -> FemSolution:
        """Return the run of a case of elements; one that was stopped goes on from the last state that it kept."""
        from strikewave.analyses.fem.build import build_model
        from strikewave.analyses.fem.run import run_model
        from strikewave.fem.solve import Checkpoint, Progress, RunOptions

        def seen(progress: Progress) -> None:
            words = f"{progress.left:.0f} s left of this run" if progress.time else ""
            self.report(progress.time / progress.duration, words)

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
    """Give an execution: in a store and on a pool that are given, or in this process, for as long as it takes."""
    with given_or_temporary(store) as kept, pool or ProcessPool(1) as open_pool:
        yield Execution(kept, open_pool, threads, report)


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
"""Those whose faces are as in the paper's own simulations."""
ELEMENT_CASES = (RIGID_ELEMENTS, QUIET_ELEMENTS, WAVE_ELEMENTS, QUIET_WAVE_ELEMENTS)
COARSER, SHORTER = 1.25, "fem.duration=400 us"
"""By how much elements are larger where a run is to be quick, and for how long it then goes: the time of a run falls
with the fourth power of their size, here to two fifths, and the duration is twice the published width."""
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
    """How much is run.

    Attributes
    ----------
    quick : bool
        True if elements are `COARSER`.
    elements : bool
        True if the finite-element models are run at all.
    studies : bool
        True if they are studied further: meshes, assumed dimensions, a second blow; never where quick.
    threads : int
        For those.
    """

    quick: bool = False
    elements: bool = True
    threads: int = 1
    studies: bool = True


@dataclass(frozen=True)
class Runs:
    """The solutions that the reproduction rests on.

    Attributes
    ----------
    machine, comparison, fixture, equal_blows : Solution
        Solutions of Figures 9 and 11, 5, 13, and of the same machine with equal blows.
    bar, passing : WaveSolution
        The sensor fixture under a front of 5 us, and a stack with multiple reflections (Figure 7).
    elements : tuple of FemSolution
        Solutions of Figures 11 and 15; empty where they were left out.
    quick : bool
        True if their meshes are coarse.
    """

    machine: Solution
    comparison: Solution
    fixture: Solution
    equal_blows: Solution
    bar: WaveSolution
    passing: WaveSolution
    elements: tuple[FemSolution, ...]
    quick: bool

    @property
    def impacts(self) -> tuple[Solution, ...]:
        """The machine cases."""
        return self.machine, self.comparison, self.fixture, self.equal_blows

    @property
    def checked(self) -> tuple[tuple[str, str], ...]:
        """Name of each run, and what its checks came to."""
        pairs = [(one.case.name, one.own_verdict.text) for one in self.impacts]
        pairs += [(one.case.name, one.own_verdict.text) for one in (self.bar, self.passing)]
        return (*pairs, *((one.case.name, one.own_verdict.text) for one in self.elements))

    @property
    def cases(self) -> tuple[Case, ...]:
        """All built-in cases that were run, each once."""
        own = tuple(solution.case for solution in self.impacts)
        return (*own, self.bar.case, *(solution.case for solution in self.elements))

    def element_solution(self, case: str) -> FemSolution | None:
        """Return the solution of a finite-element model, or None."""
        return next((solution for solution in self.elements if solution.case.name == case), None)


def run_all(effort: Effort, execution: Execution) -> Runs:
    """Run everything.

    Parameters
    ----------
    effort : Effort
        How much.
    execution : Execution
        How.

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
    """Return what a quick run changes in a finite-element model.

    Examples
    --------
    >>> quick_changes("li-ma-2019-fem-wave")[0], quick_changes("li-ma-2019-fem-wave")[-1]
    ('mesh.part.striker.size=3.75 mm', 'compare=true')
    """
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
