"""The evaluation of one of many cases, its outcome, and the key that tells it from all others."""

from __future__ import annotations

import functools
import hashlib
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from pathlib import Path
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.declare import ComputedField
from strikewave.base.errors import StrikewaveError, show
from strikewave.base.result import ELEMENTS_SCHEMA, RUN_FAILED, SCHEMA
from strikewave.cases.case import Case


@functools.cache
def program_key() -> str:
    """Return what a result depends on beside its case: version, meaning of its numbers, source of the kernels."""
    return f"{__version__} {SCHEMA} {ELEMENTS_SCHEMA} {kernel_key(PACKAGE)}"


def run_key(case: Case, evaluation: object) -> bytes:
    """Return the key of a run: the SHA-256 of its case with the files it names, its evaluation, and the version.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.studies.engine.case_evaluation import CaseEvaluation
    >>> case, peak = load_case("li-ma-2019"), CaseEvaluation("run", ("first.rigid_peak",))
    >>> run_key(case, peak) == run_key(load_case("li-ma-2019"), peak)
    True
    >>> run_key(case, peak) == run_key(load_case("li-ma-2019", ["machine.speed=700 rpm"]), peak)
    False
    """
    digest = hashlib.sha256(f"{program_key()} {evaluation!r}\n{case_text(case)}".encode())
    for file in case_files(case):
        digest.update(_file_digest(file, file.stat().st_mtime_ns))
    return digest.digest()


def content_key(thing: object) -> bytes:
    """Return the SHA-256 of the content of an object, of a function with what it is bound to, or of a tuple of these.

    What is computed once and remembered (`functools.cached_property`, `ComputedField`) is no content.

    Raises
    ------
    TypeError
        If it holds something whose content is not known, such as a file or a lambda.

    Examples
    --------
    >>> content_key(("a", 1.0)) == content_key(("a", 1.0)), content_key((1, (2,))) == content_key(((1, 2),))
    (True, False)
    """
    digest = hashlib.sha256(program_key().encode())
    _add_content(digest, thing)
    return digest.digest()


def _add_content(digest: Any, thing: Any) -> None:
    """Add the kind of a thing, how much it holds, and all that."""
    parts: list[Any] = []
    text = f"{type(thing).__module__}.{type(thing).__qualname__}"
    if isinstance(thing, Case):
        text += run_key(thing, "").hex()
    elif isinstance(thing, np.ndarray):
        text += f" {thing.dtype} {thing.shape} {hashlib.sha256(thing.tobytes()).hexdigest()}"
    elif thing is None or isinstance(thing, str | bytes | int | float | complex | Path | Enum | np.generic):
        text += f" {thing!r}"
    elif isinstance(thing, type | FunctionType | BuiltinFunctionType):
        if "<" in thing.__qualname__:  # a lambda, or a function within one: what it holds is not seen
            raise TypeError(f"the content of {thing.__qualname__} is not known")
        text += f" {thing.__module__}.{thing.__qualname__}"
    elif isinstance(thing, MethodType):
        parts = [thing.__func__, thing.__self__]
    elif isinstance(thing, functools.partial):
        parts = [thing.func, thing.args, thing.keywords]
    elif isinstance(thing, tuple | list):
        parts = [*thing]
    elif isinstance(thing, Mapping):
        parts = [part for item in thing.items() for part in item]
    elif hasattr(thing, "__dict__"):
        remembered = functools.cached_property | ComputedField
        own = {k: v for k, v in vars(thing).items() if not isinstance(getattr(type(thing), k, None), remembered)}
        parts = [own]
    else:
        raise TypeError(f"the content of a {text} is not known")
    # the count of parts tells (1, (2,)) from ((1, 2),)
    digest.update(f"{text} {len(parts)}\n".encode())
    for part in parts:
        _add_content(digest, part)


def case_text(case: Case) -> str:
    """Return all values of a case as a text that tells it from others; a field of a table's own kind counts too."""
    return case.model_dump_json(serialize_as_any=True)


def case_files(case: Case) -> list[Path]:
    """Return the files that a case names: of its load, and of parts of its mesh."""
    names = [case.load.file] if case.load is not None else []
    names += [getattr(part, "file", "") for part in (case.mesh.part if case.mesh is not None else ())]
    return [path for path in map(Path, filter(None, names)) if path.is_file()]


@functools.lru_cache(maxsize=64)
def _file_digest(path: Path, changed: int) -> bytes:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").digest()


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
    """The outcome of a run.

    Attributes
    ----------
    numbers : tuple of float
        In the order of the names of its evaluation, SI; NaN where the run has none. Empty where it failed.
    histories : tuple of KeptHistory
        Histories that are kept.
    document : str
        An answer that is more than numbers, as JSON; empty where there is none.
    failure : str
        Reason of a failed run; empty for one that succeeded.
    verdict : str
        Outcome of the checks of the run, `strikewave.base.result.Verdict.text`; empty for an answer that is no run.
    retry : bool
        True if another try may end otherwise: it failed for want of memory, or its process was ended.
    seconds : float
        Duration of the computation, s.
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
    """A computation on a case: picklable, and its ``repr`` tells it from all others."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its numbers."""
        ...

    def __call__(self, case: Case) -> RunOutcome:
        """Return what a case comes to; raises what makes it fail."""
        ...


class Variation(Protocol):
    """A source of cases, one for each row: picklable."""

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
        """The names of the numbers of its runs."""
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
    values = (numbers.get(name) for name in names)
    return tuple(np.nan if value is None else float(value) for value in values)
