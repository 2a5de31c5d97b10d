"""How the runs of a reproduction are made: what is finished is kept, so that one that is stopped goes on there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from strikewave.base.errors import InputError, StrikewaveError
from strikewave.cases.case import Case
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
        Of elements.
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
        """Return the answers to questions, in their order.

        Raises
        ------
        StrikewaveError
            If one has none.
        """

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
