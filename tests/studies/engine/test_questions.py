"""Answers to questions: kept as they were given, whatever their numbers, found once, and failures as rows."""

import functools
import math
from concurrent.futures import Future
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave import load_case
from strikewave.base.errors import StrikewaveError
from strikewave.studies.engine.pools import GivenPool, ProcessPool, ThreadPool, each_on
from strikewave.studies.engine.questions import Failure, OfCase, answers
from strikewave.studies.engine.store import RunStore


class Part(NamedTuple):
    """A part of an answer."""

    name: str
    values: tuple[float, ...]
    kept: bool


@dataclass(frozen=True)
class Whole:
    """An answer."""

    number: float
    count: int
    parts: tuple[Part, ...]
    other: Part | None = None


@dataclass(frozen=True)
class Asked:
    """A question whose answer is given."""

    answered_by: ClassVar[type] = Whole

    given: Whole

    def text(self):
        return repr(self.given)

    def answer(self):
        if self.given.count < 0:
            raise StrikewaveError("fewer than none")
        return self.given


NUMBERS = st.floats(width=64)
PARTS = st.builds(Part, st.text(), st.lists(NUMBERS, max_size=3).map(tuple), st.booleans())
WHOLES = st.builds(Whole, NUMBERS, st.integers(0, 2**53), st.lists(PARTS, max_size=2).map(tuple), st.none() | PARTS)


@given(st.lists(WHOLES, max_size=4))
def test_answers_come_back_bit_for_bit(unasked, wholes):
    """``repr`` tells NaN, infinity and minus zero apart, and floats by their shortest digits."""
    with RunStore(None) as store, ProcessPool(1) as pool:
        first = answers([Asked(one) for one in wholes], store, pool)
        again = answers([Asked(one) for one in wholes], store, unasked)
    assert repr(first) == repr(again) == repr(wholes)


def test_a_question_without_an_answer_is_kept_with_its_reason_and_not_asked_again(unasked):
    asked = [Asked(Whole(math.nan, -1, ())), Asked(Whole(1.0, 1, ()))]
    with RunStore(None) as store, ProcessPool(1) as own:
        for pool in (own, unasked):
            failed, found = answers(asked, store, pool)
            assert failed == Failure("fewer than none")
            assert found == asked[1].given
        assert len(store.known()) == 2


def speed_over(case, share, threads=1):
    """Return the speed of a machine over a share."""
    return case.machine.speed.si / share


def test_what_a_function_finds_of_a_case_is_asked_once_for_each_case_and_argument():
    """Threads change no number: they are no part of what is asked."""
    slow, fast = load_case("li-ma-2019", ["machine.speed=50 rad/s"]), load_case("li-ma-2019")
    asked = [OfCase(one, speed_over, float, (share,), threads) for one, share, threads in
             ((slow, 1.0, 1), (slow, 2.0, 1), (fast, 1.0, 1), (slow, 1.0, 2))]  # fmt: skip
    with RunStore(None) as store, ProcessPool(1) as pool:
        assert answers(asked, store, pool) == [50.0, 25.0, fast.machine.speed.si, 50.0]
        assert len(store.known()) == 3


def test_items_come_back_in_their_order_from_threads_and_their_errors_are_raised():
    with ThreadPool(2) as pool:
        assert each_on(pool, abs, [-3, 2, -1, 0, 5]) == [3, 2, 1, 0, 5]
        with pytest.raises(ZeroDivisionError):
            each_on(pool, functools.partial(divmod, 1), [1, 0, 2])


class Breaking:
    """An executor that breaks with the first item, once."""

    def __init__(self, error):
        self.error, self.asked = error, 0

    def submit(self, job, items):
        self.asked += 1
        future = Future()
        if self.asked == 1:
            future.set_exception(self.error)
        else:
            future.set_result(job(items))
        return future


def test_items_of_a_pool_that_was_lost_are_computed_again():
    from concurrent.futures.process import BrokenProcessPool

    executor = Breaking(BrokenProcessPool())
    assert each_on(GivenPool(executor, 1), abs, [-1, -2, -3]) == [1, 2, 3]
    assert executor.asked == 4
