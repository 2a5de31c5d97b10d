"""Executors: one that must not be asked, as what is known is not run again; one that pickles, as processes do."""

import pickle
from concurrent.futures import Executor, Future

import pytest

from strikewave.studies.engine.pools import GivenPool


class NoExecutor:
    """An executor that fails where it is asked."""

    def submit(self, *_):
        raise AssertionError("what is known was asked again")


@pytest.fixture(scope="session")
def unasked():
    return GivenPool(NoExecutor(), 1)


class Pickling(Executor):
    """An executor of this process that hands over what a process would be sent, and back."""

    def __init__(self):
        self.asked = 0

    def submit(self, job, items):
        self.asked += 1
        job, items = pickle.loads(pickle.dumps((job, items)))
        done = Future()
        done.set_result(pickle.loads(pickle.dumps(job(items))))
        return done


@pytest.fixture
def pickling():
    return Pickling()
