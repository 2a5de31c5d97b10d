"""Questions whose answers are more than numbers, such as the blows of the settings that a search ends at.

A question is an object that knows its answer, and a text that tells it from all others. Its answer is kept in the store
of runs as JSON, written and read by the types of its dataclass, so that nothing but data is ever read back.
"""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from pydantic import TypeAdapter

from strikewave.cases.case import Case
from strikewave.studies.engine.evaluation import RunOutcome, attempts, program_key, run_key
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Advance, carry_out
from strikewave.studies.engine.store import RunStore

Answer_co = TypeVar("Answer_co", covariant=True)
Answer = TypeVar("Answer")


class Question(Protocol[Answer_co]):
    """A question about a case: picklable."""

    @property
    def answered_by(self) -> Any:
        """Type of the answer: a dataclass or tuple of numbers, texts and others of their kind."""
        ...

    def text(self) -> str:
        """Return all that the answer depends on, as a text."""
        ...

    def answer(self) -> Answer_co:
        """Return the answer; raises what makes it fail."""
        ...


@dataclass(frozen=True, eq=False)
class OfCase(Generic[Answer]):
    """A question about a case: what a function finds of it.

    Attributes
    ----------
    case : Case
        Case that the question is about.
    find : callable
        A function of a module, which takes the case, ``arguments`` and ``threads``.
    answered_by : type
        Class of the returned value.
    arguments : tuple
        Further arguments of the function.
    threads : int or None
        Threads of a run of elements, which change no number; None where the function takes none.
    """

    case: Case
    find: Callable[..., Answer]
    answered_by: Any
    arguments: tuple[Any, ...] = ()
    threads: int | None = None

    def text(self) -> str:
        """Return all that the answer depends on."""
        found_by = self.find.__module__, self.find.__qualname__, self.arguments
        return run_key(self.case, found_by).hex()

    def answer(self) -> Answer:
        """Return what the function finds."""
        return self.find(self.case, *self.arguments, **({} if self.threads is None else {"threads": self.threads}))


@dataclass(frozen=True)
class Failure:
    """The reason why a question has no answer."""

    reason: str


@functools.cache
def _written_as(answered_by: Any) -> TypeAdapter[Any]:
    return TypeAdapter(answered_by)


@dataclass(frozen=True)
class Answering:
    """The work of a process that is given questions; see `strikewave.studies.engine.runner.Work`."""

    names: tuple[str, ...] = ()

    def key(self, question: Question[Any]) -> bytes:
        """Return the key of a question."""
        kind = type(question)
        text = f"{program_key()} {kind.__module__}.{kind.__qualname__}\n{question.text()}"
        return hashlib.sha256(text.encode()).digest()

    def __call__(self, questions: Sequence[Question[Any]]) -> list[RunOutcome]:
        """Return the answers to some questions, each found alone."""
        return attempts(functools.partial(_outcome, question) for question in questions)


def _outcome(question: Question[Any]) -> RunOutcome:
    answer = _written_as(question.answered_by).dump_python(question.answer(), mode="json")
    return RunOutcome(document=json.dumps(answer))


def answers(
    questions: Sequence[Question[Answer]], store: RunStore, pool: Pool, advance: Advance | None = None
) -> list[Answer | Failure]:
    """Return the answers to questions, in their order; those that a store has are not sought again."""
    outcomes = store.documents(carry_out(Answering(), questions, store, pool, advance).keys)
    return [
        Failure(failure) if failure else _written_as(question.answered_by).validate_python(json.loads(document))
        for question, (document, failure) in zip(questions, outcomes, strict=True)
    ]
