"""The fast run of a rotary machine in place of the full one, where numbers of its blows are all that is asked for."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

from strikewave.base.result import Verdict
from strikewave.cases.case import Case
from strikewave.studies.engine.case_evaluation import EVALUATED, CaseEvaluation, numbers_of
from strikewave.studies.simulation import Simulation


class FastRun(Simulation):
    """A run whose numbers are those of `strikewave.machines.fast_run`: a tenth of the time, and within 1e-3."""

    @functools.cached_property
    def _found(self) -> tuple[Mapping[str, float | None], Verdict]:
        numbers, _, verdict = EVALUATED["fast"](CaseEvaluation("fast", tuple(numbers_of(self.case, "fast"))), self.case)
        return numbers, verdict

    @property
    def verdict(self) -> Verdict:
        """What the checks of the fast run came to."""
        return self._found[1]

    def number(self, name: str, sensor: str = "") -> float | None:
        """Return a number, SI; NaN where this run has none."""
        value = self._found[0].get(name)
        return math.nan if value is None else float(value)


def runs_fast(case: Case) -> bool:
    """Tell whether the fast run is that of this case: a machine with a drive, and an object that is no stack.

    Examples
    --------
    >>> from strikewave import load_case
    >>> runs_fast(load_case("li-ma-2019")), runs_fast(load_case("jesd22-b111-b"))
    (True, False)
    """
    return case.command == "run" and case.launched() is None and not case.stack.layer
