"""What is done with each of many cases, and what is kept of it: numbers, histories, or why there are none."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import StrikewaveError, show
from strikewave.base.result import RUN_FAILED
from strikewave.cases.case import Case
from strikewave.studies.engine.keys import run_key

Array = NDArray[np.float64]
Row = tuple[float, ...]
"""Place of a run: a value (SI), or the number of a word, of each thing that is varied."""

MOST_REASON = 200
"""Characters of the reason why a run failed, so that it stays in a cell of a table."""


class KeptHistory(NamedTuple):
    """Values of a run along time, or along its blows.

    Attributes
    ----------
    name : str
        Name of the history.
    unit : str
        SI.
    blow : int
        Number of the blow; 0 where they are not of one blow.
    start, step : float
        Time of the first value and between two, s; NaN where there is no time.
    values : ndarray
        SI.
    """

    name: str
    unit: str
    blow: int
    start: float
    step: float
    values: Array


@dataclass(frozen=True)
class RunOutcome:
    """What a run came to.

    Attributes
    ----------
    numbers : tuple of float
        In the order of the names of its evaluation, SI; NaN where the run has none. Empty where it failed.
    histories : tuple of KeptHistory
        Histories that are kept.
    document : str
        An answer that is more than numbers, as JSON; empty where there is none.
    failure : str
        Why there is nothing; empty where there is.
    verdict : str
        Outcome of the checks of the run, `strikewave.base.result.Verdict.text`; empty for an answer that is no run.
    retry : bool
        True if another try may end otherwise: it failed for want of memory, or its process was ended.
    seconds : float
        How long it took.
    """

    numbers: tuple[float, ...] = ()
    histories: tuple[KeptHistory, ...] = ()
    document: str = ""
    failure: str = ""
    verdict: str = ""
    retry: bool = False
    seconds: float = 0.0

    @property
    def judged(self) -> str:
        """Text of its verdict, that of a failure where it failed; empty of what is no run."""
        return RUN_FAILED if self.failure else self.verdict


class Evaluation(Protocol):
    """What is computed of a case: picklable, and its ``repr`` tells it from all others."""

    @property
    def names(self) -> tuple[str, ...]:
        """Of its numbers."""
        ...

    def __call__(self, case: Case) -> RunOutcome:
        """Return what a case comes to; raises what makes it fail."""
        ...


class Variation(Protocol):
    """What is varied: picklable."""

    def case_of(self, row: Row) -> Case:
        """Return the case of a row."""
        ...


@dataclass(frozen=True)
class Job:
    """An evaluation of the cases of a variation: what a process is given with its rows."""

    variation: Variation
    evaluation: Evaluation

    @property
    def names(self) -> tuple[str, ...]:
        """Of the numbers of its runs."""
        return self.evaluation.names

    def key(self, row: Row) -> bytes:
        """Return the key of a row."""
        return run_key(self.variation.case_of(row), self.evaluation)

    def __call__(self, rows: Iterable[Row]) -> list[RunOutcome]:
        """Return what some rows come to, each computed alone, so that no bit depends on what it is computed with."""
        return attempts(partial(self._run, row) for row in rows)

    def _run(self, row: Row) -> RunOutcome:
        return self.evaluation(self.variation.case_of(row))


def attempts(runs: Iterable[Callable[[], RunOutcome]]) -> list[RunOutcome]:
    """Return what some runs come to; where Ctrl-C stops them, what is finished goes with it, as ``finished``.

    Raises
    ------
    KeyboardInterrupt
        Where this process is stopped.
    """
    outcomes = list[RunOutcome]()
    try:
        for run in runs:
            outcomes.append(attempt(run))
    except KeyboardInterrupt as stop:
        stop.finished = outcomes  # type: ignore[attr-defined]  # for whoever keeps them
        raise
    return outcomes


def attempt(run: Callable[[], RunOutcome]) -> RunOutcome:
    """Return what a run comes to, with how long it took; or why it failed.

    Examples
    --------
    >>> attempt(lambda: RunOutcome((1 / 0,))).failure
    'division by zero'
    """
    begin = time.perf_counter()
    try:
        outcome = run()
    except MemoryError as error:
        outcome = failed(str(error) or "out of memory", retry=True)
    except (StrikewaveError, ValueError, ArithmeticError) as error:
        outcome = failed(str(error) or type(error).__name__)
    return replace(outcome, seconds=time.perf_counter() - begin)


def failed(reason: str, retry: bool = False) -> RunOutcome:
    """Return the outcome of a run that failed, and whether another try may end otherwise.

    Examples
    --------
    >>> failed("at 1 ms the turntable stalls").failure
    'at 1 ms the turntable stalls'
    """
    return RunOutcome(failure=show("; ".join(reason.splitlines()), MOST_REASON).strip('"'), retry=retry)


def ordered(numbers: dict[str, float | None], names: Sequence[str]) -> tuple[float, ...]:
    """Return numbers in the order of their names; NaN where there is none.

    Examples
    --------
    >>> ordered({"a": 1.0, "b": None}, ["b", "a"])
    (nan, 1.0)
    """
    found = (numbers.get(name) for name in names)
    return tuple(np.nan if value is None else float(value) for value in found)
