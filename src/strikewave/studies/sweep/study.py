"""A sweep: a case over its settings, what each run came to, and which setting matters."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.compile_progress import compiling_shown
from strikewave.base.first_few import first_few
from strikewave.base.result import Notice, Source
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import headed, percent, with_unit
from strikewave.reporting.shown_result import ShownResult
from strikewave.studies.axes import Axis
from strikewave.studies.engine.case_evaluation import CaseEvaluation, called, checked_device, unit_of
from strikewave.studies.engine.evaluation import Job, Row, Variation
from strikewave.studies.engine.plan import GRID, HYPERCUBE, SOBOL, TOLERANCES
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import StudyProgress, carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.studies.engine.variables import StudyVariable
from strikewave.studies.sweep.effects import MainEffect, main_effect, share_by_chance

Array = NDArray[np.float64]

NOTE = "chosen by strikewave sweep"
"""What a case says of a value that a sweep has changed."""
USUAL = {"m/s^2": "g", "s": "us", "N": "kN", "m": "mm", "Pa": "MPa"}
"""Unit in which numbers are shown as a rule, by SI unit."""
SLOW = ("window", "interval")
"""Numbers that are times between blows, which are shown in ms."""
SHARES = ("cv", "cv_later", "energy_error", "momentum_error", "hourglass_share")
"""Numbers that are shares, which are shown in per cent."""


SOURCES = {HYPERCUBE: ("mckay-1979",), SOBOL: ("joe-kuo-2008",)}
"""Keys of the sources of a design."""


class KeptNumber(NamedTuple):
    """A number that is kept of each run: its name, SI unit, and the unit in which it is shown as a rule."""

    name: str
    si: str
    usual: str

    @property
    def label(self) -> str:
        """What it is called, with the unit in which it is shown."""
        name = called(self.name)
        return f"{name} (%)" if self.usual == "%" else headed(name, self.si, self.usual)

    def words(self, value: float) -> str:
        """Write a value with its unit."""
        return percent(value, 2) if self.usual == "%" else with_unit(value, self.si, self.usual)


def kept_number(case: Case, analysis: str, name: str) -> KeptNumber:
    """Return a number of an analysis of a case, with the units in which it is kept and shown.

    Examples
    --------
    >>> from strikewave import load_case
    >>> kept_number(load_case("li-ma-2019"), "run", "interval")
    KeptNumber(name='interval', si='s', usual='ms')
    """
    si = unit_of(case, analysis, name)
    usual = "%" if name in SHARES else "ms" if name in SLOW else USUAL.get(si, si)
    return KeptNumber(name, si, usual)


@dataclass(frozen=True)
class SweepPlan:
    """What a sweep is of.

    Attributes
    ----------
    case : Case
        What is varied.
    variables : tuple of StudyVariable
        In the order of the rows; of a draw within tolerances, what was drawn.
    design : str
        One of `strikewave.studies.engine.plan.DESIGNS`.
    seed : int
        Of a design that is random.
    variation : Variation
        What makes a case of a row.
    evaluation : CaseEvaluation
        What is kept of each run.
    rows : tuple of tuple
        The runs.
    """

    case: Case
    variables: tuple[StudyVariable, ...]
    design: str
    seed: int
    variation: Variation
    evaluation: CaseEvaluation
    rows: tuple[Row, ...]

    def on(self, device: str | None, cluster: str | None) -> SweepPlan:
        """Return the plan with the steps of elements taken on a device, here or on a cluster; None: the processor.

        Raises
        ------
        InputError
            If the runs are not of elements, or there is no such device.
        """
        device = checked_device(self.evaluation.analysis, device, cluster)
        return replace(self, evaluation=replace(self.evaluation, device=device))

    @property
    def job(self) -> Job:
        """What is run."""
        return Job(self.variation, self.evaluation)

    @cached_property
    def kept(self) -> tuple[KeptNumber, ...]:
        """The numbers that are kept of each run."""
        return tuple(kept_number(self.case, self.evaluation.analysis, name) for name in self.evaluation.names)

    @property
    def words(self) -> str:
        """What is run, in words."""
        over = first_few([variable.path for variable in self.variables], 3)
        runs = "one run" if len(self.rows) == 1 else f"{len(self.rows)} runs"
        return f"{runs} ({self.evaluation.analysis}), {self.design}, over {over}"

    @cached_property
    def text(self) -> str:
        """The case as text, and above it what was asked: other runs are another result."""
        asked = repr((self.rows, self.evaluation, [(v.path, v.words) for v in self.variables]))
        key = hashlib.sha256(asked.encode()).hexdigest()[:12]
        kept = ", ".join((*self.evaluation.names, *self.evaluation.histories))
        return f"# strikewave sweep: {self.words}; kept: {kept}; plan {key}\n{dump_case(self.case)}"


@dataclass(frozen=True, eq=False)
class SweepStudy(ShownResult):
    """A sweep; see `Result` for what it shares with others.

    Attributes
    ----------
    plan : SweepPlan
        What it is of.
    numbers : ndarray
        SI, shape (runs, numbers); NaN where a run has none.
    failures : tuple of str
        Why each run failed; empty where it did not.
    keys : tuple of str
        Of each run, by which its histories are found.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "sweep"
    table_name: ClassVar[str] = "runs"

    plan: SweepPlan
    numbers: Array
    failures: tuple[str, ...]
    keys: tuple[str, ...]
    asked: str = ""

    @property
    def case(self) -> Case:
        """What was varied."""
        return self.plan.case

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @cached_property
    def source(self) -> Source:
        """The case, and above it what was asked."""
        return Source("case", self.case.name, self.plan.text, asked=self.asked)

    @property
    def failed(self) -> int:
        """How many runs failed."""
        return sum(bool(failure) for failure in self.failures)

    @property
    def reasons(self) -> dict[str, int]:
        """Why runs failed, the most frequent reason first."""
        counts: dict[str, int] = {}
        for failure in filter(None, self.failures):
            counts[failure] = counts.get(failure, 0) + 1
        return dict(sorted(counts.items(), key=lambda pair: -pair[1]))

    def number(self, name: str) -> Array:
        """Return a number of each run, SI."""
        return np.asarray(self.numbers[:, self.plan.evaluation.names.index(name)])

    @cached_property
    def settings(self) -> Array:
        """The settings of the runs, shape (runs, variables): SI, of words their places."""
        return np.array(self.plan.rows, dtype=float).reshape(len(self.plan.rows), len(self.plan.variables))

    @cached_property
    def effects(self) -> dict[str, dict[str, MainEffect]]:
        """The main effect of each setting on each number, by number and path; none of a single setting."""
        if len(self.plan.variables) < 2:
            return {}
        grid = self.plan.design == GRID and not np.isnan(self.numbers).any()
        return {
            name: {
                variable.path: main_effect(self.settings[:, k], self.number(name), grid)
                for k, variable in enumerate(self.plan.variables)
            }
            for name in self.plan.evaluation.names
        }

    def chance(self, effect: MainEffect) -> float:
        """Return the share below which an effect may be one of chance; 0 in a grid, which leaves nothing to it."""
        if self.plan.design == GRID:
            return 0.0
        return share_by_chance(effect.runs, effect.means.size, len(self.plan.variables))

    def best(self, name: str) -> tuple[int, int] | None:
        """Return which runs have the smallest and the largest value of a number; None where no run has it."""
        values = self.number(name)
        if not np.isfinite(values).any():
            return None
        return int(np.nanargmin(values)), int(np.nanargmax(values))

    def at(self, run: int) -> str:
        """Return the settings of a run in words."""
        pairs = list(zip(self.plan.variables, self.plan.rows[run], strict=True))[:6]
        return ", ".join(f"{variable.path} = {variable.brief(value)}" for variable, value in pairs)

    def found_notices(self) -> tuple[Notice, ...]:
        """Return what should be known: runs that failed, and numbers that runs have not."""
        notices = list(self.verdicts.notices())
        for one in self.plan.kept:
            lacking = int(np.sum(np.isnan(self.number(one.name)))) - self.failed
            if lacking > 0:
                message = f"{lacking} runs that did not fail have no {one.name}, such as where no blow struck"
                notices.append(Notice("number-missing", message, float(lacking), 0.0))
        return tuple(notices)

    def highlights(self) -> list[tuple[str, str]]:
        """Return the number of runs, and the range of the first numbers."""
        numbers = [("runs", str(len(self.failures)))]
        for one in self.plan.kept[:3]:
            ends = self.best(one.name)
            if ends is not None:
                low, high = (one.words(float(self.number(one.name)[run])) for run in ends)
                numbers.append((called(one.name), f"{low} to {high}"))
        return numbers

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        settings = {
            variable.path: variable.axis.si_unit or "1" for variable in self.plan.variables if not variable.words
        }
        return {
            **settings,
            **{one.name: one.si for one in self.plan.kept},
            "share": "1",
            "standard_error": "1",
            "share_by_chance": "1",
        }

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        plan = self.plan
        return {
            "case": self.case.name,
            "analysis": plan.evaluation.analysis,
            "design": plan.design,
            "seed": None if plan.design == GRID else plan.seed,
            "runs": len(plan.rows),
            "failed": self.failed,
            "vary": [_variable(variable) for variable in plan.variables],
            "keep": [*plan.evaluation.names, *plan.evaluation.histories],
            "settings": {v.path: self._setting(k) for k, v in enumerate(plan.variables)},
            "numbers": {name: self.number(name) for name in plan.evaluation.names},
            "verdict": list(self.verdicts.texts),
            "failures": {str(k + 1): failure for k, failure in enumerate(self.failures) if failure},
            "effects": {
                name: {
                    path: {
                        "share": effect.share,
                        "standard_error": effect.standard_error,
                        "share_by_chance": self.chance(effect),
                    }
                    for path, effect in effects.items()
                }
                for name, effects in self.effects.items()
            },
        }

    def _setting(self, k: int) -> list[Any]:
        variable = self.plan.variables[k]
        values = self.settings[:, k].tolist()
        return [variable.words[int(value)] for value in values] if variable.words else values

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"sweep.json": self.document_text()}

    def tables(self) -> dict[str, str]:
        """Return the table of runs."""
        return {"runs.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    def columns(self) -> list[Column]:
        """Return all runs: settings, numbers, and why one failed; with histories the keys by which they are found."""
        columns = [Column("run", range(1, len(self.failures) + 1))]
        for k, variable in enumerate(self.plan.variables):
            axis, values = variable.axis, self._setting(k)
            columns.append(Column(axis.path, values, *(() if variable.words else (axis.si_unit or "1", axis.unit))))
        columns += [Column(one.name, self.number(one.name), one.si) for one in self.plan.kept]
        if self.plan.evaluation.histories:
            columns.append(Column("key", self.keys))
        return [*columns, Column("verdict", self.verdicts.texts), Column("failure", self.failures)]

    def brief(self) -> dict[str, str]:
        """Return settings and numbers."""
        settings = {variable.path: variable.axis.unit or "1" for variable in self.plan.variables[:4]}
        numbers = {one.name: one.usual.replace("%", "1") for one in self.plan.kept[:4]}
        return {"run": "", **settings, **numbers, "verdict": ""}


def _variable(variable: StudyVariable) -> dict[str, Any]:
    axis: Axis = variable.axis
    if variable.words:
        return {"path": axis.path, "words": list(variable.words)}
    if variable.is_range:
        return {"path": axis.path, "low": axis.values[0], "high": axis.values[-1], "log": axis.log}
    return {"path": axis.path, "values": list(axis.values)}


@compiling_shown()
def make_sweep(
    plan: SweepPlan,
    store: RunStore,
    pool: Pool | None = None,
    advance: Callable[[StudyProgress], None] | None = None,
) -> SweepStudy:
    """Make a sweep: all runs that a store does not have yet.

    Parameters
    ----------
    plan : SweepPlan
        What is run.
    store : RunStore
        Finished runs.
    pool : Pool, optional
        Who runs them, and is ended here; this process where it is left out.
    advance : callable, optional
        Called as runs come back.

    Raises
    ------
    InputError
        If the store cannot be written.
    StrikewaveError
        If the pool is lost.
    """
    with ProcessPool(1) if pool is None else pool as ready:
        finished = carry_out(plan.job, plan.rows, store, ready, advance)
    numbers, failures, _ = store.table(plan.evaluation.names, finished.keys)
    keys = tuple(key.hex() for key in finished.keys)
    sources = SOURCES.get(plan.design, ())
    verdicts = store.verdicts(finished.keys, not_judged=plan.evaluation.not_judged(plan.case))
    study = SweepStudy(plan, numbers, tuple(failures), keys, citations=sources, verdicts=verdicts)
    return replace(study, notices=study.found_notices())


def is_drawn(plan: SweepPlan) -> bool:
    """Tell whether the runs are drawn within tolerances."""
    return plan.design == TOLERANCES
