"""The reproduction without finite elements, made once for all tests of a process."""

import pytest

from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.runs import Effort


@pytest.fixture(scope="session")
def result():
    return reproduce(Effort(elements=False, studies=False))
