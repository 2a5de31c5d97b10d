"""What the results of cases share: the case itself, its fits, what it says of the test."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from strikewave.base import declare
from strikewave.base.result import Source
from strikewave.cases.case import Case
from strikewave.cases.fits import StaleFit
from strikewave.cases.written_case import dump_case
from strikewave.reporting.shown_result import ShownResult


@declare.dataclass
class CaseResult(ShownResult):
    """A result of a case; see `Result` for what it shares with others."""

    case: Case

    @declare.computed(declare.word("name of the case", key="case"))
    def case_name(self) -> str:
        """What the case is called."""
        return self.case.name

    @declare.computed(declare.word("paths of the values that were fitted"))
    def fitted_fields(self) -> list[str]:
        """The fitted values of the case."""
        return self.case.fitted_fields()

    @declare.computed(declare.rows(StaleFit, "fits that no longer apply"))
    def stale_fits(self) -> list[StaleFit]:
        """The fits of the case that no longer apply."""
        return self.case.stale_fits()

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @functools.cached_property
    def source(self) -> Source:
        """The case."""
        return Source("case", self.case.name, dump_case(self.case))
