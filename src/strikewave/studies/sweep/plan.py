"""The plan of a sweep: what is varied and kept, as the command line, a study file and Python ask for it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import Field

from strikewave.base.documents import read_toml
from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.quantities import Value
from strikewave.base.texts import first_few
from strikewave.cases.case import SCHEMA, Case, dump_case, load_case
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable
from strikewave.studies.axes import Axis
from strikewave.studies.engine.case_evaluation import (
    CaseEvaluation,
    KeptNumber,
    checked_analysis,
    checked_device,
    kept_number,
    read_kept,
)
from strikewave.studies.engine.evaluation import Job, Row, Variation
from strikewave.studies.engine.plan import (
    DESIGNS,
    GRID,
    MOST_RUNS,
    MOST_SEED,
    TOLERANCES,
    DrawVariation,
    drawn_rows,
    filled,
    grid,
    varied,
)
from strikewave.studies.engine.runner import Workers
from strikewave.studies.engine.variables import EXAMPLE, StudyVariable, read_variable
from strikewave.studies.study_file import Settings, case_place, states_a_study
from strikewave.uncertainty.draws import UncertainInput, tolerances_of

NOTE = "chosen by strikewave sweep"
"""Note in a case of a value that a sweep has changed."""
RUNS = 128
"""Runs of a design that is no grid, where none are asked for: a power of two, as Sobol's sequence needs."""
Vary = Mapping[str, Any] | Sequence[str]
"""Varied settings: texts ``setting=values``, or values by settings."""


@dataclass(frozen=True)
class SweepPlan:
    """What a sweep is of.

    Attributes
    ----------
    case : Case
        Case that is varied.
    variables : tuple of StudyVariable
        In the order of the rows; of a draw within tolerances, what was drawn.
    design : str
        One of `strikewave.studies.engine.plan.DESIGNS`.
    seed : int
        Random seed of a design that is random.
    variation : Variation
        Variation that makes a case of a row.
    evaluation : CaseEvaluation
        Numbers and histories that are kept of each run.
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

    def on(self, workers: Workers) -> SweepPlan:
        """Return the plan with the steps of elements taken on the device of the workers."""
        device = checked_device(self.evaluation.analysis, workers.device, workers.cluster)
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


def plan_of(
    case: Case,
    vary: Vary,
    keep: Sequence[str] = (),
    analysis: str = "",
    design: str = GRID,
    runs: int | None = None,
    seed: int = 1,
) -> SweepPlan:
    """Return the plan of a sweep; the arguments are those of `sweep`."""
    if design not in DESIGNS:
        raise InputError("--design", design, "one of " + ", ".join(DESIGNS), nearest(design, DESIGNS))
    evaluation = read_kept(case, checked_analysis(case, analysis), keep)
    variables = tuple(read_variable(case, text) for text in vary_texts(vary))
    variation, rows = _cases(case, variables, design, runs, seed)
    if design == TOLERANCES:
        variables = _drawn_variables(variation.inputs)  # type: ignore[attr-defined]  # a DrawVariation
    return SweepPlan(case, variables, design, seed, variation, evaluation, tuple(rows))


def _cases(
    case: Case, variables: tuple[StudyVariable, ...], design: str, runs: int | None, seed: int
) -> tuple[Variation, Iterable[Row]]:
    """Return what makes the cases, and the rows."""
    count = RUNS if runs is None else runs
    if not 1 <= count <= MOST_RUNS:
        raise InputError("--runs", count, f"a whole number from 1 to {MOST_RUNS}")
    if not 0 <= seed <= MOST_SEED:
        raise InputError("--seed", seed, f"a whole number from 0 to {MOST_SEED}")
    if design == TOLERANCES:
        if variables:
            raise InputError(
                "--vary", variables[0].path, "nothing beside --design tolerances: the case says what moves"
            )
        inputs = tolerances_of(case)
        return DrawVariation(case, inputs), drawn_rows(inputs, count, seed)
    if not variables:
        raise InputError("--vary", MISSING, "a setting with its values", EXAMPLE)
    variation = varied(case, variables, NOTE)
    if design == GRID:
        if runs is not None:
            raise InputError("--runs", runs, "none with a grid", "--design latin-hypercube or sobol takes a number")
        return variation, grid(variables)
    return variation, filled(variables, design, count, seed)


def _drawn_variables(inputs: Sequence[UncertainInput]) -> tuple[StudyVariable, ...]:
    """Return what is drawn as variables, from one end of its range to the other."""
    variables = []
    for one in inputs:
        unit = one.allowed.unit if one.allowed.unit != "count" else ""
        for name in one.names:
            variables.append(StudyVariable(Axis(name, unit, unit, (one.low, one.high)), is_range=True))
    return tuple(variables)


def vary_texts(vary: Vary) -> list[str]:
    """Return what is varied as texts.

    Examples
    --------
    >>> vary_texts({"machine.speed": [40.0, 50.0]})
    ['machine.speed=40.0, 50.0']
    """
    return [f"{path}={_typed(values)}" for path, values in vary.items()] if isinstance(vary, Mapping) else list(vary)


def _typed(values: Any) -> str:
    """Return values of Python as they are typed: a list with commas, SI without a unit.

    Examples
    --------
    >>> _typed([1, 2.5]), _typed("400..900 rpm:3"), _typed(["a", "b"])
    ('1, 2.5', '400..900 rpm:3', 'a, b')
    """
    if isinstance(values, str | int | float | Value):
        return str(values)
    return ", ".join(str(value) for value in values)


class SweepFile(CaseTable):
    """A study file; ``[vary]`` has settings as keys, dotted or as tables, and their values as they are typed."""

    schema_version: int = Field(alias="schema")
    case: str
    set: Settings = ()
    vary: dict[str, Any] = Field(default_factory=dict)
    keep: tuple[str, ...] = ()
    analysis: str = ""
    design: str = ""
    runs: int | None = None
    seed: int | None = None


FORM = Form(SweepFile, "study", 'machine.speed="500 rpm"')
"""A study file."""


@dataclass(frozen=True)
class SweepRequest:
    """What is asked for; what is empty is left to the file, or to the usual.

    Attributes
    ----------
    vary, keep, analysis, design, runs, seed
        As of `strikewave.sweep`.
    changes : tuple of str
        Changes of the case.
    case : Case or None
        Case that is varied, once it is read.
    """

    vary: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()
    analysis: str = ""
    design: str = ""
    runs: int | None = None
    seed: int | None = None
    changes: tuple[str, ...] = ()
    case: Case | None = field(default=None, repr=False)

    @property
    def loaded(self) -> Case:
        """The case."""
        assert self.case is not None
        return self.case

    def plan(self, case: Case) -> SweepPlan:
        """Return the plan of the sweep of a case."""
        keep = [name for words in self.keep for name in words.split(",")]
        seed = 1 if self.seed is None else self.seed
        return plan_of(case, self.vary, keep, self.analysis, self.design or GRID, self.runs, seed)


def read_request(name: str, changes: Sequence[str], typed: SweepRequest) -> SweepRequest:
    """Return what is asked for of a case, or of a study file with what was typed beside it.

    Parameters
    ----------
    name : str
        Case file, built-in case, or study file.
    changes : sequence of str
        Changes of the case, after those of the file.
    typed : SweepRequest
        Typed request.
    """
    text, _ = read_case_text(name)
    document = _document(text)
    if name in bundled_cases() or not states_a_study(document, ("vary",)):
        return replace(typed, changes=tuple(changes), case=load_case(name, changes))
    file = FORM.read(document)
    if file.schema_version != SCHEMA:
        raise InputError("schema", file.schema_version, f"schema = {SCHEMA}")
    whole = (*file.set, *changes)
    case = load_case(case_place(file.case, Path(name).parent), whole)
    stated = SweepRequest(tuple(varied_texts(file.vary)), file.keep, file.analysis, file.design, file.runs, file.seed)
    beside = {name: value for name, value in vars(typed).items() if value not in (None, "", ())}
    return replace(stated, **{**beside, "changes": whole, "case": case})


def _document(text: str) -> Mapping[str, Any]:
    """Return the tables of a file; none where it is no TOML, which the reader of cases then says."""
    try:
        return read_toml(text)
    except ValueError:
        return {}


def varied_texts(table: Mapping[str, Any]) -> list[str]:
    """Return the settings of [vary] with their values as they are typed on the command line.

    Examples
    --------
    >>> varied_texts({"machine": {"speed": "400..900 rpm"}, "feed.blows": [1, 3]})
    ['machine.speed=400..900 rpm', 'feed.blows=1, 3']
    """
    return [f"{path}={values}" for path, values in _flat(table)]


def _flat(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """Yield settings and their values: keys with dots are tables within tables in TOML."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{path}{key}.")
        elif isinstance(value, list):
            yield f"{path}{key}", ", ".join(map(str, value))
        elif isinstance(value, str | int | float) and value != "":
            yield f"{path}{key}", str(value)
        else:
            raise InputError(f"vary.{path}{key}", MISSING, 'values, such as "400..900 rpm:11"')
