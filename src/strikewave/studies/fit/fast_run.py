"""The fast run of a rotary machine in place of the full one, where numbers of its blows are all that is asked for."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from strikewave.cases.case import Case
from strikewave.studies.engine.case_evaluation import CaseEvaluation, numbers_of
from strikewave.studies.simulation import Simulation


class FastRun(Simulation):
    """A run whose numbers are those of `strikewave.machines.fast_train`: a tenth of the time, and within 1e-3."""

    @functools.cached_property
    def _numbers(self) -> Mapping[str, float]:
        names = tuple(numbers_of(self.case, "fast"))
        return dict(zip(names, CaseEvaluation("fast", names)(self.case).numbers, strict=True))

    def number(self, name: str, sensor: str = "") -> float | None:
        """Return a number, SI; NaN where this run has none."""
        return self._numbers[name]


def runs_fast(case: Case) -> bool:
    """Tell whether the fast run is that of this case: a machine with a drive, and an object that is no stack.

    Examples
    --------
    >>> from strikewave import load_case
    >>> runs_fast(load_case("li-ma-2019")), runs_fast(load_case("jesd22-b111-b"))
    (True, False)
    """
    return case.command == "run" and case.launched() is None and not case.stack.layer
