"""Parts shared by the results of cases: the case itself, its fits, its statements about the test."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING

from strikewave.base import declare
from strikewave.base.result import Source
from strikewave.cases.case import Case, StaleFit, dump_case
from strikewave.reporting.shown_result import ShownResult


@declare.dataclass
class ResultOfCase(ShownResult):
    """A result that begins with a case, its ``case``; see `Result` for what it shares with others."""

    if TYPE_CHECKING:

        @property
        def case(self) -> Case:
            """Case that the result is of."""

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def test(self) -> Mapping[str, str]:
        """Statements of the case about the test."""
        return self.case.test.stated()

    @declare.computed(declare.word("name of the case", key="case"))
    def case_name(self) -> str:
        """Name of the case."""
        return self.case.name


@declare.dataclass
class CaseResult(ResultOfCase):
    """The result of a case itself."""

    case: Case

    @declare.computed(declare.word("paths of the values that were fitted"))
    def fitted_fields(self) -> list[str]:
        """The fitted values of the case."""
        return self.case.fitted_fields()

    @declare.computed(declare.rows(StaleFit, "fits that no longer apply"))
    def stale_fits(self) -> list[StaleFit]:
        """The fits of the case that no longer apply."""
        return self.case.stale_fits()

    @functools.cached_property
    def source(self) -> Source:
        """The case."""
        return Source("case", self.case.name, dump_case(self.case))
