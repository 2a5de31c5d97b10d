"""The plan of a design: its case, variables, goals and objectives, as its file states them; places and rows."""

from __future__ import annotations

import hashlib
import importlib.util
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from strikewave.base.errors import MISSING, InputError, MissingPackageError, nearest
from strikewave.base.quantities import Value
from strikewave.base.texts import first_few
from strikewave.base.units import in_unit
from strikewave.cases.case import Case, dump_case, load_case
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable
from strikewave.studies.axes import case_at
from strikewave.studies.engine.case_evaluation import KeptNumber, checked_analysis, checked_device, numbers_of
from strikewave.studies.engine.evaluation import Job, Row
from strikewave.studies.engine.plan import EXAMPLE, AxisVariation, StudyVariable, read_variable, typed_value, varied
from strikewave.studies.engine.runner import Workers
from strikewave.studies.search.goals import (
    EXAMPLES,
    Aim,
    DesignEvaluation,
    Goal,
    Objective,
    checks_of,
    evaluation_of,
    is_derived,
    kept_or_derived,
    read_aim,
)
from strikewave.studies.simulation import name_and_owner
from strikewave.studies.study_file import Settings, case_place, read_study, stated_at, vary_texts

Array = NDArray[np.float64]

NOTE = "chosen by strikewave design"  # note in a case of a chosen value
RUNS = 600
"""Default runs of a search. Chosen: forty generations of fifteen settings of the one or two that most designs vary, in
which the best margin settles to a hundredth."""
MOST_RUNS = 100_000  # a search of more is a typing error
SURROGATE_RUNS = 40  # default by surrogate. Chosen: elements of a minute each take a night, with all further searches
LEAST_RUNS = 16  # one generation of the smallest search
EVOLUTION, SURROGATE, OPTUNA = SEARCHES = ("evolution", "surrogate", "optuna")
"""Methods of search: generations of many runs, few runs chosen by Gaussian processes, or a whole front at once."""
LATER = 4  # a later search by surrogate has one in so many runs: it begins with those of all before
SLOW = ("fem",)  # analyses of which a run takes seconds and more: their settings are sought by surrogate by default
RESOLUTION = 1000.0
"""Steps of a linear range: no part is made more exactly, and a chosen value reads as it would be typed."""
DIGITS = 4  # significant digits of a setting on a logarithmic range, for the same reason
MOST_AIMS = 30  # goals and objectives: where none can be met, each takes a search of its own
MOST_DRAWS = 10_000  # within tolerances for each ranked setting: shares are then known to 1 %
FINER = 0.1  # tolerance of a run that verifies another, over that of the other: chosen
ALLOWED = "a TOML file with the case, goals and [vary]"


@dataclass(frozen=True)
class SearchMethod:
    """Search method of `strikewave.design`, and its seed.

    Attributes
    ----------
    name : str
        ``evolution``, or ``surrogate`` for few runs; empty for that of the analysis, which is by surrogate for
        elements. ``optuna``, of two objectives or more, searches for their whole front at once; needs
        ``pip install 'strikewave[optuna]'``.
    seed : int
        Random seed of the search and of draws: equal seeds give equal settings, bit for bit.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.SearchMethod(seed=3)
    SearchMethod(name='', seed=3)
    """

    name: str = ""
    seed: int = 1


@dataclass(frozen=True)
class DesignPlan:
    """Plan of a design.

    Attributes
    ----------
    case : Case
        Case to design.
    variables : tuple of StudyVariable
        Settings that may be chosen; of a range, all values between its ends.
    aims : tuple of Goal or Objective
        Goals and objectives to reach.
    analysis : str
        Analysis that each run is.
    runs : int
        Most runs of a search.
    seed : int
        Random seed of the search and of draws.
    robust : int
        Draws within tolerances for each ranked setting; 0 for none.
    variation : AxisVariation
        Variation that makes a case of a row.
    search : str
        One of `SEARCHES`.
    device : str or None
        Device that computes the steps of elements; None: the processor.
    """

    case: Case
    variables: tuple[StudyVariable, ...]
    aims: tuple[Aim, ...]
    analysis: str
    runs: int
    seed: int
    robust: int
    variation: AxisVariation
    search: str = EVOLUTION
    device: str | None = None

    def on(self, workers: Workers) -> DesignPlan:
        """Return the plan with the steps of elements taken on the device of the workers."""
        return replace(self, device=checked_device(self.analysis, workers.device, workers.cluster))

    @property
    def by_surrogate(self) -> bool:
        """True if a Gaussian process chooses few runs."""
        return self.search == SURROGATE

    @property
    def later_runs(self) -> int:
        """Most runs of a search after others."""
        return max(self.runs // LATER, 1) if self.by_surrogate else self.runs

    @cached_property
    def goals(self) -> tuple[Goal, ...]:
        """Goals, all of which must be met."""
        return tuple(aim for aim in self.aims if isinstance(aim, Goal))

    def goal_of(self, name: str) -> Goal | None:
        """Return the goal of a number, the first of several; None where it has none."""
        return next((goal for goal in self.goals if goal.number == name), None)

    @cached_property
    def objectives(self) -> tuple[Objective, ...]:
        """Objectives: numbers to be small or large where all goals are met."""
        return tuple(aim for aim in self.aims if isinstance(aim, Objective))

    @cached_property
    def evaluation(self) -> DesignEvaluation:
        """Evaluation of each run."""
        return evaluation_of(self.case, self.analysis, [aim.number for aim in self.aims], self.device)

    @property
    def job(self) -> Job:
        """Job of its runs."""
        return Job(self.variation, self.evaluation)

    @cached_property
    def bounds(self) -> list[tuple[float, float]]:
        """Ends of the places of each variable: from 0 to 1 in a range, else the first and last of its values."""
        return [
            (0.0, 1.0) if variable.is_range else (0.0, float(len(variable.axis.values) - 1))
            for variable in self.variables
        ]

    @property
    def whole(self) -> list[bool]:
        """True for places that are whole numbers."""
        return [not variable.is_range for variable in self.variables]

    def row_at(self, place: Sequence[float] | Array) -> Row:
        """Return the row of a place: values as they would be typed, of a list the one at that number."""
        pairs = zip(self.variables, place, strict=True)
        return tuple(
            self._rounded(one, one.at(min(max(float(x), 0.0), 1.0))) if one.is_range else one.axis.values[round(x)]
            for one, x in pairs
        )

    def _rounded(self, one: StudyVariable, value: float) -> float:
        axis = one.axis
        low, high = axis.values[0], axis.values[-1]
        if axis.log:
            typed = f"{in_unit(value, axis.si_unit, axis.unit) if axis.unit else value:.{DIGITS}g}"
        else:
            ends = [in_unit(end, axis.si_unit, axis.unit) if axis.unit else end for end in (low, high, value)]
            step = 10.0 ** math.floor(math.log10((ends[1] - ends[0]) / RESOLUTION))
            typed = f"{round(ends[2] / step) * step:.12g}"
        read = typed_value(self.case, one.path, f"{typed} {axis.unit}".strip()).si
        return min(max(read, low), high)

    def place_of(self, row: Row) -> Array:
        """Return the place of a row."""
        places = []
        for variable, value in zip(self.variables, row, strict=True):
            values = variable.axis.values
            if not variable.is_range:
                places.append(float(values.index(value)))
            elif variable.axis.log:
                places.append(math.log(value / values[0]) / math.log(values[-1] / values[0]))
            else:
                places.append((value - values[0]) / (values[-1] - values[0]))
        return np.array(places)

    def case_of(self, row: Row, keep_tolerances: bool = True) -> Case:
        """Return the case of a row, with the tolerances that the case has."""
        pairs = list(zip(self.variables, row, strict=True))
        words = tuple(value for one, value in pairs if one.words)
        numbers = [(one.axis, value) for one, value in pairs if not one.words]
        axes, values = [axis for axis, _ in numbers], [value for _, value in numbers]
        return case_at(self.variation.cases[words], axes, values, NOTE, keep_tolerances)

    def setting(self, row: Row) -> dict[str, Any]:
        """Return settings by their paths: SI, or words."""
        pairs = zip(self.variables, row, strict=True)
        return {one.path: one.words[int(value)] if one.words else value for one, value in pairs}

    def at(self, row: Row) -> str:
        """Return settings in words."""
        pairs = zip(self.variables, row, strict=True)
        return ", ".join(f"{one.path} = {one.shown(value)}" for one, value in pairs)

    def kept(self, name: str) -> KeptNumber:
        """Return a number with the units in which it is kept and shown."""
        return kept_or_derived(self.case, self.analysis, name)

    @cached_property
    def verifying(self) -> tuple[DesignPlan, str] | None:
        """Plan by which the best settings are verified, and its name; None where there is no better one.

        A full run verifies a fast one; a run of a tenth of the tolerance verifies a full one.
        """
        if self.analysis == "fast":
            return self._with("run", self.case), "a full run"
        if self.analysis == "run":
            tolerance = FINER * self.case.solver.tolerance.si
            finer = self.case.with_values({"solver.tolerance": Value(si=tolerance, typed=float(f"{tolerance:.3g}"))})
            return self._with("run", finer), "another run at a tenth of the solver's tolerance (solver.tolerance)"
        return None

    def _with(self, analysis: str, case: Case) -> DesignPlan:
        known = numbers_of(case, analysis)
        aims = tuple(aim for aim in self.aims if is_derived(aim.number) or name_and_owner(aim.number)[0] in known)
        variation = varied(case, self.variables, NOTE)
        return DesignPlan(case, self.variables, aims, analysis, self.runs, self.seed, 0, variation, self.search)

    @property
    def words(self) -> str:
        """Goals, variables and analysis, in words."""
        over = first_few([variable.path for variable in self.variables], 3)
        return f"{'; '.join(aim.typed for aim in self.aims)}; over {over} ({self.analysis})"

    @cached_property
    def asked_line(self) -> str:
        """First line of the written case: the question, and a mark of all that was asked."""
        asked = repr((self.aims, self.runs, self.seed, self.robust, self.analysis, self.search))
        asked += repr([(variable.axis, variable.words) for variable in self.variables]) + dump_case(self.case)
        key = hashlib.sha256(asked.encode()).hexdigest()[:12]
        return f"# strikewave design: {self.words}; plan {key}\n"


def plan_of(
    case: Case,
    vary: Sequence[str],
    aims: Sequence[str],
    analysis: str = "",
    runs: int | None = None,
    seed: int = 1,
    robust: int = 0,
    search: str = "",
) -> DesignPlan:
    """Return the plan of a design."""
    chosen = checked_analysis(case, analysis)
    if not aims:
        raise InputError("goals", MISSING, "at least one goal or objective", EXAMPLES)
    if not vary:
        raise InputError("vary", MISSING, "a setting with its range", EXAMPLE)
    if len(aims) > MOST_AIMS:
        raise InputError("goals", f"{len(aims)} goals", f"at most {MOST_AIMS}")
    way = search or (SURROGATE if chosen in SLOW else EVOLUTION)
    if way not in SEARCHES:
        raise InputError("search", search, "one of " + ", ".join(SEARCHES), nearest(search, SEARCHES))
    read = tuple(read_aim(case, chosen, text, f"goals.{k}") for k, text in enumerate(aims))
    if way == OPTUNA:
        _check_optuna(sum(isinstance(aim, Objective) for aim in read))
    usual = SURROGATE_RUNS if way == SURROGATE else RUNS
    count = usual if runs is None else runs
    if not LEAST_RUNS <= count <= MOST_RUNS:
        raise InputError("runs", count, f"a whole number from {LEAST_RUNS} to {MOST_RUNS}")
    if not 0 <= robust <= MOST_DRAWS:
        raise InputError("robust", robust, f"a whole number from 0 (no draws) to {MOST_DRAWS}")
    if not 0 <= seed < 2**63:
        raise InputError("seed", seed, "a whole number from 0 to 2^63 - 1")
    variables = tuple(read_variable(case, text) for text in vary)
    read += checks_of(case, chosen)
    return DesignPlan(case, variables, read, chosen, count, seed, robust, varied(case, variables, NOTE), way)


def _check_optuna(objectives: int) -> None:
    """Refuse the search for a trade-off without two objectives, or without optuna."""
    if objectives < 2:
        raise InputError("search", OPTUNA, "two objectives or more", f"{EVOLUTION} or {SURROGATE} for a single one")
    if importlib.util.find_spec("optuna") is None:
        raise MissingPackageError(f"search {OPTUNA}", "optuna", "optuna")


class DesignFile(CaseTable):
    """The file of a design; ``[vary]`` has settings as keys, dotted or as tables, and values as they are typed."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    case: str
    changes: Settings = Field(default=(), alias="set")
    goals: tuple[str, ...]
    vary: dict[str, Any]
    analysis: str = ""
    runs: int | None = None
    seed: int = 1
    robust: int = 0
    search: str = ""


FORM = Form(DesignFile, "design", 'goals="cv < 3 %"')


class DesignRequest(NamedTuple):
    """A read file of a design: its case and changes; options have replaced its keys."""

    case: Case
    changes: tuple[str, ...]
    file: DesignFile
    name: str

    def plan(self, case: Case) -> DesignPlan:
        """Return the plan of the design of a case."""
        file = self.file
        with stated_at(f"{self.name}: vary"):
            vary = vary_texts(file.vary)
            for text in vary:
                read_variable(case, text)
        with stated_at(self.name):
            return plan_of(case, vary, file.goals, file.analysis, file.runs, file.seed, file.robust, file.search)


def load_design(path: str | Path, changes: Sequence[str] = (), **options: int | None) -> DesignRequest:
    """Read a file of a design."""
    path = Path(path)
    file = read_study(path, FORM, ALLOWED)
    place = case_place(file.case, path.parent)
    whole = (*file.changes, *changes)
    with stated_at(f"{path.name}: case"):
        load_case(place)
    with stated_at(f"{path.name}: set"):
        case = load_case(place, whole)
    given = {name: value for name, value in options.items() if value is not None}
    return DesignRequest(case, whole, file.model_copy(update=given), path.name)
