"""A sweep: its plan as command line, study file and Python ask for it, the numbers of each run, and main effects."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from strikewave.base import declare
from strikewave.base.compiling import compiling_shown
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.documents import read_toml
from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.result import Notice
from strikewave.base.texts import first_few
from strikewave.cases.case import SCHEMA, Case, load_case
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.shown_result import shown_table
from strikewave.studies.axes import Axis
from strikewave.studies.engine.case_evaluation import (
    OF_NUMBER,
    CaseEvaluation,
    KeptNumber,
    OfKept,
    checked_analysis,
    checked_device,
    kept_number,
    read_kept,
)
from strikewave.studies.engine.evaluation import Variation
from strikewave.studies.engine.plan import (
    DESIGNS,
    EXAMPLE,
    GRID,
    HYPERCUBE,
    MOST_RUNS,
    MOST_SEED,
    SOBOL,
    TOLERANCES,
    DrawVariation,
    StudyPlan,
    StudyVariable,
    drawn_rows,
    filled,
    grid,
    read_variable,
    varied,
)
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Advance, Workers, as_workers, at_work, finished_runs, share_reporter
from strikewave.studies.engine.store import RunStore, store_in
from strikewave.studies.study import Study
from strikewave.studies.study_file import Settings, Vary, case_place, states_a_study, vary_texts
from strikewave.studies.sweep.effects import MainEffect, main_effect, share_by_chance
from strikewave.uncertainty.draws import UncertainInput, tolerances_of

NOTE = "chosen by strikewave sweep"
"""Note in a case of a value that a sweep has changed."""
RUNS = 128
"""Runs of a design that is no grid, where none are asked for: a power of two, as Sobol's sequence needs."""


@dataclass(frozen=True, kw_only=True)
class SweepPlan(StudyPlan):
    """Runs of a sweep.

    Attributes
    ----------
    variables : tuple of StudyVariable
        In the order of the rows; of a draw within tolerances, what was drawn.
    design : str
        One of `strikewave.studies.engine.plan.DESIGNS`.
    seed : int
        Random seed of a design that is random.
    """

    variables: tuple[StudyVariable, ...]
    design: str
    seed: int
    evaluation: CaseEvaluation

    def on(self, workers: Workers) -> SweepPlan:
        """Return the plan with the steps of elements taken on the device of the workers."""
        device = checked_device(self.evaluation.analysis, workers.device, workers.cluster)
        return replace(self, evaluation=replace(self.evaluation, device=device))

    @cached_property
    def kept(self) -> tuple[KeptNumber, ...]:
        """The numbers that are kept of each run."""
        return tuple(kept_number(self.case, self.evaluation.analysis, name) for name in self.evaluation.names)

    @property
    def words(self) -> str:
        """The runs in words: how many, of which analysis, over what."""
        over = first_few([variable.path for variable in self.variables], 3)
        runs = "one run" if len(self.rows) == 1 else f"{len(self.rows)} runs"
        return f"{runs} ({self.evaluation.analysis}), {self.design}, over {over}"

    @cached_property
    def text(self) -> str:
        """The case as text, and above it what was asked: other runs are another result."""
        key = self.rows, self.evaluation, [(v.path, v.words) for v in self.variables]
        return self.marked(f"sweep: {self.words}; kept: {', '.join(self.evaluation.kept)}", key)


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
    count = RUNS if runs is None else runs
    if not 1 <= count <= MOST_RUNS:
        raise InputError("--runs", count, f"a whole number from 1 to {MOST_RUNS}")
    if not 0 <= seed <= MOST_SEED:
        raise InputError("--seed", seed, f"a whole number from 0 to {MOST_SEED}")
    variation: Variation
    if design == TOLERANCES:
        if variables:
            allowed = "nothing beside --design tolerances: the case says what moves"
            raise InputError("--vary", variables[0].path, allowed)
        inputs = tolerances_of(case)
        variation, rows = DrawVariation(case, inputs), drawn_rows(inputs, count, seed)
        variables = tuple(_drawn_variables(inputs))
    elif not variables:
        raise InputError("--vary", MISSING, "a setting with its values", EXAMPLE)
    else:
        variation = varied(case, variables, NOTE)
        if design == GRID and runs is not None:
            raise InputError("--runs", runs, "none with a grid", "--design latin-hypercube or sobol takes a number")
        rows = grid(variables) if design == GRID else filled(variables, design, count, seed)
    return SweepPlan(
        case=case,
        variation=variation,
        evaluation=evaluation,
        rows=tuple(rows),
        variables=variables,
        design=design,
        seed=seed,
    )


def _drawn_variables(inputs: Sequence[UncertainInput]) -> Iterator[StudyVariable]:
    """Yield what is drawn as variables, from one end of its range to the other."""
    for quantity in inputs:
        unit = quantity.allowed.unit if quantity.allowed.unit != "count" else ""
        for name in quantity.names:
            yield StudyVariable(Axis(name, unit, unit, (quantity.low, quantity.high)), is_range=True)


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
    """A sweep as it is asked for; what is empty is left to the file, or to the default.

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
        keep = [name for names in self.keep for name in names.split(",")]
        seed = 1 if self.seed is None else self.seed
        return plan_of(case, self.vary, keep, self.analysis, self.design or GRID, self.runs, seed)


def read_request(name: str, changes: Sequence[str], typed: SweepRequest) -> SweepRequest:
    """Return what is asked for of a case, or of a study file with what was typed beside it."""
    text, _ = read_case_text(name)
    document = _document(text)
    if name in bundled_cases() or not states_a_study(document, ("vary",)):
        return replace(typed, changes=tuple(changes), case=load_case(name, changes))
    file = FORM.read(document)
    if file.schema_version != SCHEMA:
        raise InputError("schema", file.schema_version, f"schema = {SCHEMA}")
    settings = (*file.set, *changes)
    case = load_case(case_place(file.case, Path(name).parent), settings)
    stated = SweepRequest(tuple(vary_texts(file.vary)), file.keep, file.analysis, file.design, file.runs, file.seed)
    beside = {name: value for name, value in vars(typed).items() if value not in (None, "", ())}
    return replace(stated, **{**beside, "changes": settings, "case": case})


def _document(text: str) -> Mapping[str, Any]:
    """Return the tables of a file; none where it is no TOML, which the reader of cases then says."""
    try:
        return read_toml(text)
    except ValueError:
        return {}


Array = NDArray[np.float64]

MOST_SHOWN = 4
"""Settings, and numbers, that the table of runs shows of a sweep over several: more make no line. Files have all."""
MOST_RUN_ROWS = 100
"""Runs of a sweep over one setting that are printed: more are read in runs.csv, and in the picture."""
MOST_EFFECTS = 12
"""Settings that a table of main effects names, those with the largest shares."""
SOURCES = {HYPERCUBE: ("mckay-1979",), SOBOL: ("joe-kuo-2008",)}
"""Keys of the sources of a design."""


SHARE = Quantity(NO_UNIT, "%", "share of the variance", 1, 0)


@declare.dataclass
class RunRange(OfKept):
    """A number over all runs."""

    name: str = declare.word("which number", label="number", column=KEY)
    smallest: float | None = declare.number(OF_NUMBER, "its smallest value", column=MAIN)
    median: float | None = declare.number(OF_NUMBER, "its median over the runs that have it", column=MAIN)
    largest: float | None = declare.number(OF_NUMBER, "its largest value", column=MAIN)
    smallest_at: str | None = declare.word("settings of its smallest value", column=MORE)
    largest_at: str | None = declare.word("settings of its largest value", column=MORE)

    @declare.phrase("extent", headline="{name}")
    def extent(self) -> str | None:
        """Say between what it lies; None where no run has it."""
        if self.smallest is None or self.largest is None:
            return None
        return f"{self.kept.words(self.smallest)} to {self.kept.words(self.largest)}"


@declare.dataclass
class EffectShare(OfKept):
    """The main effect of a setting on a number."""

    number: str = declare.word("which number", column=KEY, in_document=False)
    setting: str = declare.word("path of the setting", column=KEY, in_document=False)
    share: float = declare.number(
        SHARE, "share of the setting in the variance of the number", column=MAIN, error="standard_error"
    )
    standard_error: float = declare.number(SHARE, "its standard error")
    share_by_chance: float = declare.number(
        Quantity(NO_UNIT, "%", "by chance below", 1, 0), "the share that chance would give", column=MAIN
    )
    smallest_mean: float = declare.number(OF_NUMBER, "smallest mean", column=MAIN, in_document=False)
    largest_mean: float = declare.number(OF_NUMBER, "largest mean", column=MAIN, in_document=False)

    @property
    def stands_out(self) -> bool:
        """True if the share is beyond chance."""
        return self.share > self.share_by_chance


@declare.dataclass
class NumberEffects:
    """The main effects on a number."""

    of_settings: dict[str, EffectShare] = declare.named(EffectShare, "by the paths of the settings", inline=True)


@declare.dataclass(eq=False)
class SweepStudy(Study):
    """A sweep; see `Result` for what it shares with others.

    Attributes
    ----------
    plan : SweepPlan
        Plan of the sweep.
    numbers : ndarray
        SI, shape (runs, numbers); NaN where a run has none.
    failures : tuple of str
        Reason why each run failed; empty for one that did not.
    keys : tuple of str
        Key of each run, by which its histories are found.
    """

    command: ClassVar[str] = "sweep"
    table_name: ClassVar[str] = "runs"
    main_rows: ClassVar[str] = "run_table"

    plan: SweepPlan
    numbers: Array
    failures: tuple[str, ...]
    keys: tuple[str, ...]

    @property
    def case(self) -> Case:
        """The case that is varied."""
        return self.plan.case

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what was asked."""
        return self.plan.text

    analysis = declare.computed(declare.word("run, fast, wave, fem or impact"))(
        lambda study: study.plan.evaluation.analysis
    )
    design = declare.computed(declare.word("grid, latin-hypercube, sobol or tolerances"))(
        lambda study: study.plan.design
    )
    seed = declare.computed(declare.word("of the draws; null of a grid"))(
        lambda study: None if study.design == GRID else study.plan.seed
    )
    run_count = declare.computed(declare.count("how many runs", key="runs", headline="runs"))(
        lambda study: len(study.plan.rows)
    )
    failed = declare.computed(declare.count("how many of them failed"))(
        lambda study: sum(bool(failure) for failure in study.failures)
    )
    vary = declare.computed(declare.rows(StudyVariable, "what was varied"))(lambda study: study.plan.variables)
    keep = declare.computed(declare.word("names of what is kept"))(lambda study: list(study.plan.evaluation.kept))

    @declare.computed(declare.word("of each run: the setting, SI or words", key="settings"))
    def setting_lists(self) -> dict[str, list[Any]]:
        """The settings of the runs by their paths."""
        return {
            variable.path: [variable.words[int(value)] for value in column] if variable.words else column
            for variable, column in zip(self.plan.variables, self.settings.T.tolist(), strict=True)
        }

    @declare.computed(declare.word("of each run: the number, SI", key="numbers"))
    def number_arrays(self) -> dict[str, Array]:
        """The numbers of the runs by their names."""
        return {name: self.number(name) for name in self.plan.evaluation.names}

    verdict = declare.computed(
        declare.word("what the checks of each run came to: passed, broken with the checks that failed, or failed")
    )(lambda study: list(study.verdicts.texts))

    @declare.computed(declare.word("why runs failed, by their numbers from 1", key="failures"))
    def failures_by_run(self) -> dict[str, str]:
        """The reasons of runs that failed, by their numbers."""
        return {str(k): failure for k, failure in enumerate(self.failures, 1) if failure}

    @declare.computed(declare.named(NumberEffects, "main effects on each number, by its name", key="effects"))
    def number_effects(self) -> dict[str, NumberEffects]:
        """The main effects on each number, for the document."""
        return {
            number.name: NumberEffects({path: self._effect(number, path) for path in self.effects[number.name]})
            for number in self.plan.kept
            if self.effects
        }

    @declare.computed(declare.rows(EffectShare, "main effects, the largest first", in_document=False))
    def largest_effects(self) -> list[EffectShare]:
        """The main effects on each number, those with the largest shares first; of settings with any run."""
        largest = []
        for name, effects in self.number_effects.items():
            known = [effect for path, effect in effects.of_settings.items() if self.effects[name][path].means.size]
            largest += sorted(known, key=lambda effect: -np.nan_to_num(effect.share, nan=-1.0))[:MOST_EFFECTS]
        return largest

    @declare.computed(declare.rows(RunRange, "each number over all runs", headline="3", in_document=False))
    def ranges(self) -> list[RunRange]:
        """Each number over all runs."""
        return [self.range_of(number) for number in self.plan.kept]

    @declare.computed(declare.table("the runs: settings, numbers, verdicts, and why one failed"))
    def run_table(self) -> list[Column]:
        """All runs; with histories the keys by which they are found."""
        columns = [Column("run", range(1, self.run_count + 1), shown="")]
        columns += [
            shown_one.column(self.setting_lists[shown_one.path], k < MOST_SHOWN)
            for k, shown_one in enumerate(self.vary)
        ]
        most = None if len(self.vary) == 1 else MOST_SHOWN
        shown = self.plan.kept[:most]
        columns += [shown_one.column(self.number(shown_one.name), shown_one in shown) for shown_one in self.plan.kept]
        if self.plan.evaluation.histories:
            columns.append(Column("key", self.keys))
        return [*columns, Column("verdict", self.verdicts.texts, shown=""), Column("failure", self.failures)]

    @property
    def named_units(self) -> Mapping[str, str]:
        """SI units of settings and numbers."""
        settings = {number.path: number.axis.si_unit or NO_UNIT for number in self.vary if not number.words}
        return {**settings, **{number.name: number.si for number in self.plan.kept}}

    def run_rows(self) -> tuple[list[str], list[list[str]]]:
        """Return heads and rows of the runs over a single setting, in its order; no rows over several, or of many."""
        heads, rows = shown_table(self)
        if len(self.vary) != 1 or len(rows) > MOST_RUN_ROWS:
            return heads, []
        return heads, [rows[run] for run in np.argsort(self.settings[:, 0], kind="stable")]

    @property
    def reasons(self) -> dict[str, int]:
        """The reasons of runs that failed, the most frequent first."""
        return dict(Counter(filter(None, self.failures)).most_common())

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

    def _effect(self, kept: KeptNumber, path: str) -> EffectShare:
        """Return what faces show of the main effect of a setting on a number."""
        effect = self.effects[kept.name][path]
        ends = float(effect.means.min(initial=math.inf)), float(effect.means.max(initial=-math.inf))
        shares = effect.share, effect.standard_error, self.chance(effect)
        return EffectShare(kept, kept.called, path, *shares, *ends)

    def chance(self, effect: MainEffect) -> float:
        """Return the share below which an effect may be one of chance; 0 in a grid, which leaves nothing to it."""
        if self.plan.design == GRID:
            return 0.0
        return share_by_chance(effect.runs, effect.means.size, len(self.plan.variables))

    def range_of(self, kept: KeptNumber) -> RunRange:
        """Return a number over all runs; nothing of it where no run has it."""
        values = self.number(kept.name)
        if not np.isfinite(values).any():
            return RunRange(kept, kept.called, None, None, None, None, None)
        low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
        numbers = float(values[low]), float(np.nanmedian(values)), float(values[high])
        return RunRange(kept, kept.called, *numbers, self.at(low), self.at(high))

    def at(self, run: int) -> str:
        """Return the settings of a run in words."""
        pairs = list(zip(self.plan.variables, self.plan.rows[run], strict=True))[:6]
        return ", ".join(f"{variable.path} = {variable.brief(value)}" for variable, value in pairs)

    def found_notices(self) -> tuple[Notice, ...]:
        """Return what should be known: runs that failed, and numbers that runs have not."""
        notices = list(self.verdicts.notices())
        for number in self.plan.kept:
            lacking = int(np.sum(np.isnan(self.number(number.name)))) - self.failed
            if lacking > 0:
                message = f"{lacking} runs that did not fail have no {number.name}, such as where no blow struck"
                notices.append(Notice("number-missing", message, float(lacking), 0.0))
        return tuple(notices)

    def tables(self) -> dict[str, str]:
        """Return the table of runs."""
        return {"runs.csv": csv_table(self.run_table, HISTORY_DIGITS)}


@compiling_shown()
def make_sweep(
    plan: SweepPlan, store: RunStore, pool: Pool | None = None, advance: Advance | None = None
) -> SweepStudy:
    """Make a sweep: all runs that a store does not have yet; the pool is ended here."""
    not_judged = plan.evaluation.not_judged(plan.case)
    with at_work(store, pool) as (open_store, open_pool):
        runs = finished_runs(plan.job, plan.rows, open_store, open_pool, advance, not_judged=not_judged)
    keys = tuple(key.hex() for key in runs.keys)
    sources = SOURCES.get(plan.design, ())
    study = SweepStudy(plan, runs.numbers, tuple(runs.failures), keys, citations=sources, verdicts=runs.verdicts)
    return replace(study, notices=study.found_notices())


def sweep(
    case: Case,
    vary: Vary = (),
    *,
    keep: Sequence[str] = (),
    analysis: str = "",
    design: str = GRID,
    runs: int | None = None,
    seed: int = 1,
    workers: int | Workers = 1,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> SweepStudy:
    """Run a case over some of its settings, and keep some numbers of each run.

    Equal arguments give equal numbers, bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        Case that is varied.
    vary : sequence of str, or mapping
        ``machine.speed=400..900 rpm:11``, ``object.damper=10, 20 N s/m``, ``contact.damping=LAW, LAW``; or the values
        by the settings. None for the design "tolerances".
    keep : sequence of str, optional
        Numbers by name, such as ``first.rigid_peak`` or ``cv``; ``blows`` and ``pulses`` for histories. The first blow
        where nothing is named.
    analysis : str, optional
        ``run``, ``fast``, ``wave``, ``fem`` or ``impact``; that of the case where it is left out.
    design : str, optional
        ``grid``, ``latin-hypercube``, ``sobol`` or ``tolerances``.
    runs, seed : int, optional
        Number of runs and random seed of a design that is no grid.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    SweepStudy
        A row for each run: its settings and the numbers kept, in SI.

    Raises
    ------
    InputError
        If the case has no such setting or number, or the store cannot be used.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019", ["feed.blows=1"])
    >>> study = strikewave.sweep(case, ["machine.speed=600..800 rpm:3"], keep=["first.rigid_peak"], analysis="fast")
    >>> study.number("first.rigid_peak").shape, study.failed
    ((3,), 0)
    """
    made_by = as_workers(workers, elements=True)
    plan = plan_of(case, vary, keep, analysis, design, runs, seed).on(made_by)
    with store_in(store) as finished:
        return make_sweep(plan, finished, made_by.pool(), share_reporter(progress))
