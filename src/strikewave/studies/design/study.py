"""A design: settings of a case at which its numbers are as they shall be, ranked and verified; or why there is none."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.compile_progress import compiling_shown
from strikewave.base.declare import NO_UNIT
from strikewave.base.result import FAILED, RUN_BROKEN, Notice, Source, Verdicts
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.case_result import ResultOfCase
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import percent
from strikewave.studies.design.candidates import (
    DesignCandidate,
    Sensitivity,
    chosen_runs,
    front,
    ranked_candidates,
    sensitivities,
)
from strikewave.studies.design.conflict import Conflict, Reach, conflict_of
from strikewave.studies.design.evaluation import is_derived
from strikewave.studies.design.goals import Goal, shares_of
from strikewave.studies.design.plan import OPTUNA, DesignPlan
from strikewave.studies.design.rows import (
    DERIVED,
    MARGIN,
    ChosenSetting,
    DesignRun,
    GoalAtFirst,
    GoalConflict,
    GoalReach,
    KnownNumber,
    NumberChange,
    RankedRun,
    SettingChanges,
    StatedGoal,
)
from strikewave.studies.design.runs import (
    DesignRuns,
)
from strikewave.studies.design.surrogate import SurrogateError, left_out_errors
from strikewave.studies.design.trade_off import goals_met, ranking
from strikewave.studies.engine.case_evaluation import KeptNumber, kept_number
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore
from strikewave.studies.engine.variables import StudyVariable

Array = NDArray[np.float64]

SOURCES: tuple[str, ...] = ("storn-price-1997", "deb-2000")
"""Keys of the sources of the search."""
SURROGATE_SOURCES: tuple[str, ...] = ("sacks-1989", "dubrule-1983", "jones-1998", "deb-2000")
"""The same by surrogate."""
OPTUNA_SOURCES: tuple[str, ...] = ("ozaki-2022", "akiba-2019")
"""Those of the search for a whole front."""
MOST_SETTINGS, MOST_NUMBERS = 6, 4
"""Settings, and numbers, that the table of ranked settings shows; the CSV file has all."""
AT_LIMIT = 0.95
"""Share of its limit from which on the number of a check is said to limit what a goal comes to."""


@declare.dataclass(eq=False)
class DesignStudy(ResultOfCase):
    """A design; see `Result` for what it shares with others.

    Attributes
    ----------
    plan : DesignPlan
        What it is of.
    rows : tuple of tuple
        Settings of all runs, in their order.
    numbers : ndarray
        SI, shape (runs, names of the evaluation); NaN where a run has none.
    failures : tuple of str
        Why each run failed; empty where it did not.
    candidates : tuple of DesignCandidate
        The best first; where nothing meets all goals, the nearest alone.
    sensitivities : tuple of Sensitivity
        Of the first candidate.
    front : tuple of int
        Runs that no other one beats in all objectives; empty with fewer than two of them.
    conflict : Conflict or None
        Goals that exclude each other, where nothing meets all.
    surrogate : tuple of SurrogateError
        How well each number is known by the other runs, where they are few; else empty.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "design"
    table_name: ClassVar[str] = "settings"
    main_rows: ClassVar[str] = "rank_table"

    plan: DesignPlan
    rows: tuple[Row, ...]
    numbers: Array
    failures: tuple[str, ...]
    candidates: tuple[DesignCandidate, ...]
    sensitivities: tuple[Sensitivity, ...] = ()
    front: tuple[int, ...] = ()
    conflict: Conflict | None = None
    surrogate: tuple[SurrogateError, ...] = ()
    asked: str = ""

    @property
    def case(self) -> Case:
        """What was designed, as it came."""
        return self.plan.case

    @property
    def best(self) -> DesignCandidate | None:
        """The first setting, where it meets all goals."""
        return self.candidates[0] if self.candidates[0].meets else None

    @property
    def broken(self) -> bool:
        """Whether no setting meets all goals."""
        return self.best is None

    def case_of(self, place: int = 0) -> Case:
        """Return the case of a candidate, without published numbers to compare with."""
        name = f"{self.case.name or 'case'}-design"
        title = f"Settings of a design, from: {self.title}"
        return self.plan.case_of(self.candidates[place].row).model_copy(
            update={"name": name, "title": title, "published": ()}
        )

    @cached_property
    def source(self) -> Source:
        """The case at the best settings, and above it what was asked."""
        text = f"{self.plan.asked_line}{dump_case(self.case_of())}"
        return Source("case", self.case.name, text, asked=self.asked)

    def kept(self, name: str) -> KeptNumber:
        """Return a number with the units in which it is kept and shown."""
        if is_derived(name):
            return KeptNumber(name, DERIVED._replace(label=name.replace(".", " ").replace("_", " ")))
        return kept_number(self.case, self.plan.analysis, name)

    def value(self, run: int, name: str) -> float:
        """Return a number of a run, SI."""
        return float(self.numbers[run, self.plan.evaluation.names.index(name)])

    def lacks(self, name: str) -> bool:
        """Tell whether no run has a number, such as where all failed, or a theory allows none to be quoted."""
        return bool(np.isnan(self.numbers[:, self.plan.evaluation.names.index(name)]).all())

    def value_words(self, name: str, value: float) -> str:
        """Write a number with its unit."""
        return self.kept(name).words(value) if math.isfinite(value) else "none"

    def at(self, row: Row) -> str:
        """Return settings in words."""
        pairs = zip(self.plan.variables, row, strict=True)
        return ", ".join(f"{one.path} = {one.shown(value)}" for one, value in pairs)

    @cached_property
    def settings(self) -> Array:
        """The settings of all runs, shape (runs, variables): SI, of words their places."""
        return np.array(self.rows, dtype=float).reshape(len(self.rows), len(self.plan.variables))

    @cached_property
    def shares(self) -> Array:
        """Margins of all runs, shape (runs, goals)."""
        return shares_of(self.plan.goals, self.plan.evaluation.names, self.numbers)

    @cached_property
    def margins(self) -> Array:
        """The least margin of each run; infinite where there is no goal, NaN where a run lacks a number."""
        return np.asarray(self.shares.min(axis=1, initial=math.inf))

    analysis = declare.computed(declare.word("run, fast, wave, fem or impact"))(lambda study: study.plan.analysis)
    goals = declare.computed(declare.rows(StatedGoal, "what must be met"))(
        lambda study: [StatedGoal(one.typed, one.number, one.low, one.high) for one in study.plan.goals]
    )
    objectives = declare.computed(declare.word("objectives as typed"))(
        lambda study: [one.typed for one in study.plan.objectives]
    )
    seed = declare.computed(declare.count("of the search"))(lambda study: study.plan.seed)
    run_count = declare.computed(declare.count("how many runs", key="runs", headline="runs"))(
        lambda study: len(study.rows)
    )
    failed = declare.computed(declare.count("how many of them failed"))(lambda study: sum(map(bool, study.failures)))

    @declare.computed(
        declare.count(
            "how many meet all goals and fail no check", key="meeting_all_goals", headline="runs that meet all goals"
        )
    )
    def met(self) -> int:
        """How many runs meet all goals, and fail no check."""
        return int(np.sum((self.margins >= 0.0) & ~self._failed_check))

    is_met = declare.computed(declare.word("whether one does", key="met"))(lambda study: not study.broken)

    @declare.computed(declare.rows(ChosenSetting, "the first setting", headline="3", in_document=False))
    def first_setting(self) -> list[ChosenSetting]:
        """The first setting in words."""
        pairs = zip(self.plan.variables, self.candidates[0].row, strict=True)
        return [ChosenSetting(one.path, one.shown(value)) for one, value in pairs]

    @declare.computed(declare.number(MARGIN, "its margin", headline="least margin", in_document=False))
    def least_margin(self) -> float | None:
        """The least margin of the first setting; None where there is no goal."""
        margin = self.candidates[0].margin
        return margin if math.isfinite(margin) else None

    @declare.computed(declare.rows(RankedRun, "ranked settings", key="candidates"))
    def ranked(self) -> list[RankedRun]:
        """The ranked settings."""
        goals = [goal.typed for goal in self.plan.goals]

        def by_goal(shares: Array) -> dict[str, float]:
            return dict(zip(goals, shares.tolist(), strict=True))

        return [
            RankedRun(
                **vars(self._run(one.run)),
                meets=one.meets,
                margin=one.margin,
                margins=by_goal(one.shares),
                verified_margins=None if one.verified is None else by_goal(one.verified),
                failure=one.failure,
                verdict=one.verdict,
                robust=one.robustness,
            )
            for one in self.candidates
        ]

    @declare.computed(declare.rows(SettingChanges, "how the numbers move with each setting", key="sensitivities"))
    def changes(self) -> list[SettingChanges]:
        """How the numbers move with each setting."""
        names = self.plan.evaluation.names
        return [
            SettingChanges(one.path, dict(zip(names, one.changes.tolist(), strict=True)), list(one.room))
            for one in self.sensitivities
        ]

    front_runs = declare.computed(
        declare.rows(
            DesignRun, "runs that no other one beats in all objectives, with two or more of these", key="front"
        )
    )(lambda study: [study._run(run) for run in study.front])

    excluding = declare.computed(
        declare.part(
            GoalConflict,
            "where nothing meets all: goals that exclude each other, and what each comes to under the others",
            key="conflict",
        )
    )(lambda study: study.conflict and GoalConflict([goal.typed for goal in study.conflict.goals], study.reaches))
    known_numbers = declare.computed(
        declare.rows(
            KnownNumber, "of a search by surrogate: how well each number is known by the other runs", key="surrogate"
        )
    )(lambda study: [KnownNumber(study.kept(one.name), *one) for one in study.surrogate])
    sources = declare.computed(declare.word("sources of the methods"))(
        lambda study: [citation(key) for key in study.citations]
    )

    @declare.computed(declare.rows(GoalAtFirst, "goals at the first setting", in_document=False))
    def goals_at_first(self) -> list[GoalAtFirst]:
        """What each goal comes to at the first setting."""
        first = self.candidates[0]
        checked = [None] * len(self.plan.goals) if first.verified is None else first.verified.tolist()
        return [
            GoalAtFirst(self.kept(one.number), one.typed, self.value(first.run, one.number), *margins)
            for one, *margins in zip(self.plan.goals, first.shares.tolist(), checked, strict=True)
        ]

    @declare.computed(declare.rows(NumberChange, "sensitivities at the first setting", in_document=False))
    def number_changes(self) -> list[NumberChange]:
        """How the numbers of the aims move with each setting, and between which values of it all goals stay met."""
        wanted = dict.fromkeys(aim.number for aim in self.plan.aims)
        return [
            NumberChange(self.kept(name), one.setting, name, one.changes[name], *self._room(one))
            for one in self.changes
            for name in wanted
        ]

    @declare.computed(declare.rows(GoalReach, "goals that exclude each other", in_document=False))
    def reaches(self) -> list[GoalReach]:
        """What each of the goals that exclude each other comes to at best while the others are met."""
        return [
            GoalReach(
                self.kept(one.goal.number),
                one.goal.typed,
                one.value,
                one.lacks,
                self._run(one.run),
                self.at(self.rows[one.run]),
            )
            for one in (self.conflict.reaches if self.conflict else ())
        ]

    vary = declare.computed(declare.rows(StudyVariable, "what may be chosen", in_document=False))(
        lambda study: study.plan.variables
    )

    @declare.computed(declare.table("the ranked settings"))
    def rank_table(self) -> list[Column]:
        """The ranked settings: what was chosen, what comes of it, what verifies it, and draws."""
        ranked, goals = self.candidates, self.plan.goals
        columns = [Column("place", range(1, len(ranked) + 1), shown=""), *self._columns([one.run for one in ranked])]
        if goals:
            tightest = [goals[int(np.argmin(one.shares))].number for one in ranked]
            columns.append(Column("of goal", tightest, shown=""))
        if self.plan.verifying is not None and goals:
            columns.append(Column("verified", [_least(one.verified) for one in ranked], NO_UNIT, shown="%"))
        if self.plan.robust:
            drawn = [one.robustness for one in ranked]
            ends = [None if one is None else f"{percent(one.low, 0)} to {percent(one.high, 0)}" for one in drawn]
            shares = [None if one is None else one.share for one in drawn]
            columns += [
                Column("draws that meet all", shares, NO_UNIT, shown="%"),
                Column("95 % bounds", ends, shown=""),
            ]
        return [*columns, Column("verdict", [one.verdict or None for one in ranked], shown="")]

    @property
    def named_units(self) -> Mapping[str, str]:
        """SI units of settings and numbers."""
        settings = {one.path: one.axis.si_unit or NO_UNIT for one in self.plan.variables if not one.words}
        return {**settings, **{name: self.kept(name).si for name in self.plan.evaluation.names}}

    @property
    def met_broken(self) -> int:
        """How many runs meet all goals, but fail a check."""
        return int(np.sum((self.margins >= 0.0) & self._failed_check))

    @property
    def _failed_check(self) -> NDArray[np.bool_]:
        return np.array([status == RUN_BROKEN for status in self.verdicts.statuses], dtype=bool)

    @property
    def nearest_sound(self) -> int | None:
        """The run that fails no check and comes nearest to the goals; None where there is none."""
        able = np.flatnonzero(~self._failed_check & np.isfinite(self.margins))
        return int(able[np.argmax(self.margins[able])]) if able.size else None

    def found_notices(self) -> tuple[Notice, ...]:
        """Return what should be known: goals that are not met, settings that do not hold, runs that failed."""
        notices = []
        first = self.candidates[0]
        if first.margin < 0.0 or math.isnan(first.margin):
            message = f"no setting was found that meets all goals: {conflict_words(self)}"
            notices.append(Notice("not-met", message, first.margin, 0.0, FAILED))
        elif first.breaks and not self.met:
            notices.append(Notice("not-met", all_broken_words(self), float(self.met_broken), 0.0, FAILED))
        elif not first.holds:
            why = first.failure or (f"that run is {first.verdict}" if first.breaks else "a goal is missed")
            notices.append(
                Notice("not-verified", f"the setting does not hold when it is verified: {why}", 0.0, 0.0, FAILED)
            )
        return (*notices, *self.verdicts.notices())

    def setting(self, row: Row) -> dict[str, Any]:
        """Return settings by their paths: SI, or words."""
        pairs = zip(self.plan.variables, row, strict=True)
        return {one.path: one.words[int(value)] if one.words else value for one, value in pairs}

    def _run(self, run: int) -> DesignRun:
        numbers = dict(zip(self.plan.evaluation.names, self.numbers[run].tolist(), strict=True))
        return DesignRun(run + 1, self.setting(self.rows[run]), numbers)

    def _room(self, one: SettingChanges) -> Iterator[str | None]:
        """Yield to where a setting may be moved down and up, till the first goal is missed."""
        k = [variable.path for variable in self.plan.variables].index(one.setting)
        variable, value = self.plan.variables[k], self.candidates[0].row[k]
        ends = variable.axis.values[0], variable.axis.values[-1]
        for far, way, end in zip(one.room, (-1.0, 1.0), ends, strict=True):
            moved = value + way * far
            within = ends[0] <= moved <= ends[1]
            brief = variable.brief(moved) if within else f"beyond {variable.brief(end)}"
            yield None if math.isnan(far) else brief

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"design.json": self.document_text()}

    def tables(self) -> dict[str, str]:
        """Return the table of all runs."""
        columns = [Column("run", range(1, len(self.rows) + 1)), *self._columns(list(range(len(self.rows))))]
        columns += [Column("verdict", self.verdicts.texts), Column("failure", self.failures)]
        return {"runs.csv": csv_table(columns, HISTORY_DIGITS)}

    def _columns(self, runs: list[int]) -> list[Column]:
        columns = list[Column]()
        for one in self.plan.variables:
            values = [self.setting(self.rows[run])[one.path] for run in runs]
            columns.append(one.column(values, len(columns) < MOST_SETTINGS))
        for k, name in enumerate(self.plan.evaluation.names):
            columns.append(self.kept(name).column(self.numbers[runs, k], k < MOST_NUMBERS))
        margins = np.where(np.isfinite(self.margins[runs]), self.margins[runs], np.nan)
        return [*columns, Column("margin", margins, NO_UNIT, "", "%", "least margin")] if self.plan.goals else columns


def _least(shares: Array | None) -> float | None:
    """Return the least finite margin; None where there is none."""
    known = [] if shares is None else [share for share in shares.tolist() if math.isfinite(share)]
    return min(known, default=None)


def conflict_words(study: DesignStudy) -> str:
    """Say which goals exclude each other, and what each comes to under the others."""
    conflict = study.conflict
    if conflict is None:
        return "the search ended too soon"
    lacking = dict.fromkeys(goal.number for goal in conflict.goals if study.lacks(goal.number))
    if lacking:
        return f"no run has {' or '.join(lacking)}"
    words = []
    for one in conflict.reaches:
        words.append(f'"{one.goal.typed}" {_reach_words(study, one, conflict.goals)}')
    which = " and ".join(f'"{goal.typed}"' for goal in conflict.goals)
    head = f"{which} exclude each other" if len(conflict.goals) > 1 else f"{which} cannot be reached alone"
    return f"{head}: {'; '.join(words)}"


def all_broken_words(study: DesignStudy) -> str:
    """Say that all runs that meet the goals failed a check, and which that passed comes nearest to the goals."""
    goals = " meets all goals" if study.plan.goals else " was found"
    count = study.met_broken
    others = f"{count} runs that fail one do" if count > 1 else "one run that fails one does"
    words = f"no setting whose run passes its checks{goals}" + (f"; {others}" if study.plan.goals else "")
    near = study.nearest_sound
    if near is None or not study.plan.goals:
        return words
    goal = study.plan.goals[int(np.argmin(study.shares[near]))]
    comes_to = study.value_words(goal.number, study.value(near, goal.number))
    return f'{words}; the nearest that passes is {study.at(study.rows[near])}, where "{goal.typed}" comes to {comes_to}'


def _reach_words(study: DesignStudy, reach: Reach, stated: tuple[Goal, ...]) -> str:
    """Say what the number of a goal comes to at best, or that no run met the other goals that are stated with it."""
    if not math.isfinite(reach.value):
        return "is unknown: no run met the others"
    value = study.value_words(reach.goal.number, reach.value)
    limiting = [
        f", where {goal.typed} limits it"
        for goal in study.plan.goals
        if goal.is_check and goal not in stated and study.value(reach.run, goal.number) > AT_LIMIT * goal.high
    ]
    return f"comes to {value} {'with the others met' if len(stated) > 1 else 'at best'}{''.join(limiting)}"


@compiling_shown()
def make_design(
    plan: DesignPlan, store: RunStore, pool: Pool | None = None, advance: Advance | None = None
) -> DesignStudy:
    """Search for settings, rank and verify them; where none meets all goals, find out which exclude each other.

    Parameters
    ----------
    plan : DesignPlan
        What is asked.
    store : RunStore
        Finished runs.
    pool : Pool, optional
        Who runs the others; this process where it is left out.
    advance : callable, optional
        Called as runs come back.

    Raises
    ------
    InputError
        If the store cannot be written, or draws are asked for and nothing has a tolerance.
    StrikewaveError
        If the pool is lost.
    """
    with ProcessPool(1) if pool is None else pool as open_pool:
        runs = DesignRuns(plan, store, open_pool, advance)
        conflict = None if goals_met(runs) else conflict_of(runs)
        candidates, moved = _ranked(runs, store, open_pool)
        if not candidates[0].margin >= 0.0 and runs.meet():  # a step beside the nearest setting meets all goals
            candidates, moved = _ranked(runs, store, open_pool)
        conflict = None if runs.meet() else conflict
        on_front = front(runs, plan.objectives) if len(plan.objectives) > 1 and runs.meet() else []
    sources = SURROGATE_SOURCES if plan.by_surrogate else SOURCES
    sources += OPTUNA_SOURCES if plan.search == OPTUNA else ()
    sources += ("chinneck-dravnieks-1991",) if conflict else ()
    sources += ("clopper-pearson-1934",) if plan.robust else ()
    study = DesignStudy(
        plan=plan,
        rows=tuple(runs.rows),
        numbers=runs.numbers,
        failures=tuple(runs.failures),
        candidates=candidates,
        sensitivities=moved,
        front=tuple(on_front),
        conflict=conflict,
        surrogate=left_out_errors(runs) if plan.by_surrogate else (),
        citations=sources,
        verdicts=Verdicts(
            runs.verdicts,
            reason=next(filter(None, runs.failures), ""),
            not_judged=plan.evaluation.analysis.not_judged(plan.case),
            deciding=[candidates[0].verdict],
        ),
    )
    return dataclasses.replace(study, notices=study.found_notices())


def _ranked(
    runs: DesignRuns, store: RunStore, pool: Pool
) -> tuple[tuple[DesignCandidate, ...], tuple[Sensitivity, ...]]:
    """Return the ranked settings, and the sensitivities of the first one, which take runs beside it."""
    merit = ranking(runs)
    candidates = ranked_candidates(runs, chosen_runs(runs, merit(runs.numbers)), store, pool)
    return candidates, sensitivities(runs, candidates[0].run)
