"""A pool that must not be asked: what is known is not run again."""

import pytest

from strikewave.studies.engine.pools import GivenPool


class NoExecutor:
    """An executor that fails where it is asked."""

    def submit(self, *_):
        raise AssertionError("what is known was asked again")


@pytest.fixture(scope="session")
def unasked():
    return GivenPool(NoExecutor(), 1)
