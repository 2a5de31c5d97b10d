"""A design: settings of a case that meet goals, ranked and verified, or the goals that exclude each other."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.compiling import compiling_shown
from strikewave.base.declare import KEY, MAIN, NO_UNIT
from strikewave.base.result import FAILED, RUN_BROKEN, Notice, Verdicts
from strikewave.base.texts import percent
from strikewave.cases.case import Case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.studies.engine.case_evaluation import OF_NUMBER, KeptNumber, OfKept
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.plan import StudyVariable
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance, Workers, as_workers, share_reporter
from strikewave.studies.engine.store import RunStore, store_in
from strikewave.studies.search.evolution import DesignRuns, KnownNumber, known_numbers
from strikewave.studies.search.goals import Goal, shares_of
from strikewave.studies.search.machine import SearchStudy
from strikewave.studies.search.plan import OPTUNA, DesignPlan, SearchMethod, plan_of
from strikewave.studies.search.ranking import (
    MARGIN,
    Conflict,
    DesignCandidate,
    DesignRun,
    Reach,
    Sensitivity,
    chosen_runs,
    conflict_of,
    front,
    goals_met,
    ranked_candidates,
    ranking,
    sensitivities,
)
from strikewave.studies.study_file import Vary, vary_texts

Array = NDArray[np.float64]

SOURCES: tuple[str, ...] = ("storn-price-1997", "deb-2000")
"""Keys of the sources of the search."""
SURROGATE_SOURCES: tuple[str, ...] = ("sacks-1989", "dubrule-1983", "jones-1998", "deb-2000")
"""Keys of the sources of the search by surrogate."""
OPTUNA_SOURCES: tuple[str, ...] = ("ozaki-2022", "akiba-2019")
"""Keys of the sources of the search for a whole front."""
MOST_SETTINGS, MOST_NUMBERS = 6, 4  # that the table of ranked settings shows: a screen; the CSV file has all
AT_LIMIT = 0.95  # share of its limit from which a check is said to limit a goal: chosen, its slack is then below 5 %


@declare.dataclass
class GoalAtFirst(OfKept):
    """A goal at the first of the ranked settings."""

    goal: str = declare.word("as typed", column=KEY)
    value: float | None = declare.number(OF_NUMBER, "its number there", label="comes to", column=KEY)
    margin: float = declare.number(MARGIN, "its margin", column=MAIN)
    verified: float | None = declare.number(
        MARGIN, "its margin by the run that verifies it", label="verified", column=MAIN
    )


@declare.dataclass
class NumberChange(OfKept):
    """Change of a number with a setting."""

    setting: str = declare.word("path of the setting", column=KEY, order=-1)
    number: str = declare.word("which number", column=KEY, order=-1)
    size: float
    met_from: str | None = declare.word(
        "down to where it may move alone", label="all goals met from", quantity=OF_NUMBER, column=MAIN
    )
    met_to: str | None = declare.word("up to where", label="to", quantity=OF_NUMBER, column=MAIN)

    @declare.phrase("change per 1 % of its range", quantity=OF_NUMBER, column=MAIN, order=-1)
    def change(self) -> str:
        """Return the change with its sign."""
        return f"{'-' if self.size < 0.0 else '+'}{self.kept.words(abs(self.size)) if self.size else '0'}"


@declare.dataclass
class ChosenSetting:
    """Value of the first setting, as a case file has it."""

    name: str = declare.word("path of the setting")
    value: str = declare.word("its value", headline="{name}")


@declare.dataclass(eq=False)
class DesignStudy(SearchStudy):
    """Ranked settings of a case for goals; see `Result` for the members that all results share.

    Attributes
    ----------
    plan : DesignPlan
        Plan of the design.
    rows : tuple of tuple
        Settings of all runs, in their order.
    numbers : ndarray
        SI, shape (runs, names of the evaluation); NaN where a run has none.
    failures : tuple of str
        Reason why each run failed; empty for one that did not.
    front : tuple of int
        Runs that no other one beats in all objectives; empty with fewer than two of them.
    """

    command: ClassVar[str] = "design"
    drawing: ClassVar[str] = "design_report"
    table_name: ClassVar[str] = "settings"
    main_rows: ClassVar[str] = "rank_table"

    plan: DesignPlan
    rows: tuple[Row, ...]
    numbers: Array
    failures: tuple[str, ...]

    @property
    def case(self) -> Case:
        """Designed case, as given."""
        return self.plan.case

    @property
    def best(self) -> DesignCandidate | None:
        """The first setting, where it meets all goals."""
        return self.candidates[0] if self.candidates[0].meets else None

    @property
    def asked_line(self) -> str:
        """First line of the written case: the goals, and a mark of all that was asked."""
        return self.plan.asked_line

    @property
    def written_as(self) -> tuple[str, str]:
        """Name and title of the written case."""
        return f"{self.case.name or 'case'}-design", f"Settings of a design, from: {self.title}"

    def candidate_case(self, place: int) -> Case:
        """Return the case of a candidate."""
        return self.plan.case_of(self.candidates[place].row)

    def kept(self, name: str) -> KeptNumber:
        """Return a number with the units in which it is kept and shown."""
        return self.plan.kept(name)

    def value(self, run: int, name: str) -> float:
        """Return a number of a run, SI."""
        return float(self.numbers[run, self.plan.evaluation.names.index(name)])

    def lacks(self, name: str) -> bool:
        """Tell whether no run has a number, as where all failed, or the theory allows none to be quoted."""
        return bool(np.isnan(self.numbers[:, self.plan.evaluation.names.index(name)]).all())

    def value_words(self, name: str, value: float) -> str:
        """Write a number with its unit."""
        return self.kept(name).words(value) if math.isfinite(value) else "none"

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
    goals = declare.computed(declare.rows(Goal, "what must be met"))(lambda study: study.plan.goals)
    objectives = declare.computed(declare.word("objectives as typed"))(
        lambda study: [objective.typed for objective in study.plan.objectives]
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
        """Number of runs that meet all goals, and fail no check."""
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

    candidates: tuple[DesignCandidate, ...] = declare.rows(
        DesignCandidate, "ranked settings, the best first; where nothing meets all goals, the nearest alone"
    )
    sensitivities: tuple[Sensitivity, ...] = declare.rows(
        Sensitivity, "how the numbers move with each setting", default=()
    )
    front: tuple[int, ...] = ()

    front_runs = declare.computed(
        declare.rows(
            DesignRun, "runs that no other one beats in all objectives, with two or more of these", key="front"
        )
    )(lambda study: [DesignRun(study.plan, run, study.rows[run], study.numbers[run]) for run in study.front])

    conflict: Conflict | None = declare.part(
        Conflict,
        "where nothing meets all: goals that exclude each other, and what each comes to under the others",
        default=None,
    )
    surrogate: tuple[KnownNumber, ...] = declare.rows(
        KnownNumber, "of a search by surrogate: how well each number is known by the other runs", default=()
    )
    sources = declare.computed(declare.word("sources of the methods"))(
        lambda study: [citation(key) for key in study.citations]
    )

    @declare.computed(declare.rows(GoalAtFirst, "goals at the first setting", in_document=False))
    def goals_at_first(self) -> list[GoalAtFirst]:
        """Number and margin of each goal at the first setting."""
        first = self.candidates[0]
        checked = [None] * len(self.plan.goals) if first.verified is None else first.verified.tolist()
        return [
            GoalAtFirst(self.kept(one.number), one.typed, self.value(first.run, one.number), *margins)
            for one, *margins in zip(self.plan.goals, first.shares.tolist(), checked, strict=True)
        ]

    @declare.computed(declare.rows(NumberChange, "sensitivities at the first setting", in_document=False))
    def number_changes(self) -> list[NumberChange]:
        """Change of the numbers of the aims with each setting, and the range in which all goals stay met."""
        wanted = dict.fromkeys(aim.number for aim in self.plan.aims)
        return [
            NumberChange(self.kept(name), sensitivity.path, name, sensitivity.changes[name], *self._room(sensitivity))
            for sensitivity in self.sensitivities
            for name in wanted
        ]

    @declare.computed(declare.rows(Reach, "goals that exclude each other", in_document=False))
    def reaches(self) -> tuple[Reach, ...]:
        """Best number of each goal that the others exclude, while those are met."""
        return self.conflict.reaches if self.conflict else ()

    vary = declare.computed(declare.rows(StudyVariable, "what may be chosen", in_document=False))(
        lambda study: study.plan.variables
    )

    @declare.computed(declare.table("the ranked settings"))
    def rank_table(self) -> list[Column]:
        """The ranked settings: chosen values, numbers, verification, and draws."""
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
        settings = {
            variable.path: variable.axis.si_unit or NO_UNIT for variable in self.plan.variables if not variable.words
        }
        return {**settings, **{name: self.kept(name).si for name in self.plan.evaluation.names}}

    @property
    def met_broken(self) -> int:
        """Number of runs that meet all goals, but fail a check."""
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
        """Return the notices: goals that are not met, settings that do not hold, runs that failed."""
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

    def _room(self, one: Sensitivity) -> Iterator[str | None]:
        """Yield the lowest and highest value of a setting until the first goal is missed, in words."""
        k = [variable.path for variable in self.plan.variables].index(one.path)
        variable, value = self.plan.variables[k], self.candidates[0].row[k]
        ends = variable.axis.values[0], variable.axis.values[-1]
        for far, way, end in zip(one.room, (-1.0, 1.0), ends, strict=True):
            moved = value + way * far
            within = ends[0] <= moved <= ends[1]
            brief = variable.brief(moved) if within else f"beyond {variable.brief(end)}"
            yield None if math.isnan(far) else brief

    def tables(self) -> dict[str, str]:
        """Return the table of all runs."""
        columns = [Column("run", range(1, len(self.rows) + 1)), *self._columns(list(range(len(self.rows))))]
        columns += [Column("verdict", self.verdicts.texts), Column("failure", self.failures)]
        return {"runs.csv": csv_table(columns, HISTORY_DIGITS)}

    def _columns(self, runs: list[int]) -> list[Column]:
        columns = list[Column]()
        for variable in self.plan.variables:
            values = [self.plan.setting(self.rows[run])[variable.path] for run in runs]
            columns.append(variable.column(values, len(columns) < MOST_SETTINGS))
        for k, name in enumerate(self.plan.evaluation.names):
            columns.append(self.kept(name).column(self.numbers[runs, k], k < MOST_NUMBERS))
        margins = np.where(np.isfinite(self.margins[runs]), self.margins[runs], np.nan)
        return [*columns, Column("margin", margins, NO_UNIT, "", "%", "least margin")] if self.plan.goals else columns


def _least(shares: Array | None) -> float | None:
    """Return the least finite margin; None where there is none."""
    known = [] if shares is None else [share for share in shares.tolist() if math.isfinite(share)]
    return min(known, default=None)


def conflict_words(study: DesignStudy) -> str:
    """Return the sentence on goals that exclude each other, and their best numbers under the others."""
    conflict = study.conflict
    if conflict is None:
        return "the search ended too soon"
    lacking = dict.fromkeys(goal.number for goal in conflict.goals if study.lacks(goal.number))
    if lacking:
        return f"no run has {' or '.join(lacking)}"
    words = [f'"{reach.goal.typed}" {_reach_words(study, reach, conflict.goals)}' for reach in conflict.reaches]
    which = " and ".join(f'"{goal.typed}"' for goal in conflict.goals)
    head = f"{which} exclude each other" if len(conflict.goals) > 1 else f"{which} cannot be reached alone"
    return f"{head}: {'; '.join(words)}"


def all_broken_words(study: DesignStudy) -> str:
    """Return the sentence on runs that meet the goals and all fail a check, and on the nearest that passes."""
    goals = " meets all goals" if study.plan.goals else " was found"
    count = study.met_broken
    others = f"{count} runs that fail one do" if count > 1 else "one run that fails one does"
    words = f"no setting whose run passes its checks{goals}" + (f"; {others}" if study.plan.goals else "")
    near = study.nearest_sound
    if near is None or not study.plan.goals:
        return words
    goal = study.plan.goals[int(np.argmin(study.shares[near]))]
    comes_to = study.value_words(goal.number, study.value(near, goal.number))
    there = study.plan.at(study.rows[near])
    return f'{words}; the nearest that passes is {there}, where "{goal.typed}" comes to {comes_to}'


def _reach_words(study: DesignStudy, reach: Reach, stated: tuple[Goal, ...]) -> str:
    """Return the best number of a goal in words, or that no run met the other goals that are stated with it."""
    if not math.isfinite(reach.value):
        return "is unknown: no run met the others"
    value = study.value_words(reach.goal.number, reach.value)
    there = dict(zip(study.plan.evaluation.names, reach.run.numbers, strict=True))
    limiting = [
        f", where {goal.typed} limits it"
        for goal in study.plan.goals
        if goal.is_check and goal not in stated and there[goal.number] > AT_LIMIT * goal.high
    ]
    return f"comes to {value} {'with the others met' if len(stated) > 1 else 'at best'}{''.join(limiting)}"


@compiling_shown()
def make_design(
    plan: DesignPlan, store: RunStore, pool: Pool | None = None, advance: Advance | None = None
) -> DesignStudy:
    """Search for settings, rank and verify them; where none meets all goals, find those that exclude each other."""
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
        surrogate=tuple(known_numbers(runs)) if plan.by_surrogate else (),
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
    """Return the ranked settings, and the sensitivities of the first, which take runs beside it."""
    merit = ranking(runs)
    candidates = ranked_candidates(runs, chosen_runs(runs, merit(runs.numbers)), store, pool)
    return candidates, sensitivities(runs, candidates[0].run)


def design(
    case: Case,
    vary: Vary,
    goals: Sequence[str],
    *,
    analysis: str = "",
    runs: int | None = None,
    robust: int = 0,
    search: str | SearchMethod = "",
    workers: int | Workers = 1,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> DesignStudy:
    """Find settings of a case for goals on its numbers, or which goals exclude each other.

    Equal arguments give equal settings, bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        Case to design.
    vary : sequence of str, or mapping
        Settings that may be chosen: ``machine.speed=400..900 rpm``, ``object.spring=10..160 kN/m log``,
        ``contact.damping=LAW, LAW``; or the values by the settings.
    goals : sequence of str
        ``first.rigid_peak = 4000 g +- 5 %``, ``cv < 3 %``, ``spec:mil-std-810h passes``, ``sensor clips never``; and
        objectives, such as ``stop_force smallest``.
    analysis : str, optional
        ``run``, ``fast``, ``wave``, ``fem`` or ``impact``; that of the case where it is left out.
    runs : int, optional
        Most runs of a search; 600 where it is left out, 40 by surrogate.
    robust : int, optional
        Draws within the tolerances of the case for each ranked setting; none where it is left out.
    search : str or SearchMethod, optional
        Name of a method, see `SearchMethod`, or one with its random seed.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(4, device="cuda")``.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    DesignStudy
        The best settings, every run that was made, and where no setting meets all goals, those that exclude
        each other.

    Raises
    ------
    InputError
        If the case has no such setting or number, a goal is none, or the store cannot be used.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019", ["feed.blows=1"])
    >>> goals = ["peak_force = 30 kN +- 2 %"]
    >>> study = strikewave.design(case, ["machine.speed=200..900 rpm"], goals, analysis="impact", runs=48)
    >>> study.best.meets, study.conflict
    (True, None)
    """
    made_by = as_workers(workers, elements=True)
    method = search if isinstance(search, SearchMethod) else SearchMethod(search)
    plan = plan_of(case, vary_texts(vary), goals, analysis, runs, method.seed, robust, method.name).on(made_by)
    with store_in(store) as finished:
        return make_design(plan, finished, made_by.pool(), share_reporter(progress))
