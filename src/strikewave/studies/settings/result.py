"""Ranked settings for a goal, as Python, a page and a JSON document show them."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from typing import ClassVar

from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.result import Source
from strikewave.base.shock_quantities import FORCE, PULSE_WIDTH, RATIO
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import columns_of
from strikewave.reporting.parts import Tag
from strikewave.reporting.shown_result import ShownResult
from strikewave.specifications.reading import Specification
from strikewave.studies.settings.answer_files import name_at, other_cases
from strikewave.studies.settings.candidate import INTERVAL, PEAK, WITHIN, Limit, SettingsCandidate
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices, goal_words, name_of
from strikewave.studies.settings.search import VARIED


@declare.dataclass
class SettingsGoal:
    """What the blows shall be."""

    interval: float = declare.number(INTERVAL, "wanted interval of the blows")
    peak: float = declare.number(PEAK, "wanted peak")
    width: float = declare.number(PULSE_WIDTH, "wanted width")
    stop_limit: float | None = declare.number(FORCE, "largest allowed force of the stop; null for none")
    within: float = declare.number(RATIO, "relative miss at which the goal is met")
    disc: str = declare.word("material assumed for the turntable")
    vary: str = declare.word("whose stiffness sets the width: frame or mount")


@declare.dataclass
class StrikersLeftOut:
    """A number of strikers that was not run."""

    strikers: int = declare.count("number of strikers that was not run")
    why: str = declare.word("why it was not")


@declare.dataclass(eq=False)
class SettingsStudy(ShownResult):
    """Ranked settings for a goal; see `design_settings`, and `Result` for what it shares with others.

    Attributes
    ----------
    case : Case
        What was not chosen.
    goal : BlowGoal
        What the blows shall be.
    choice : SettingsChoices
        What could be chosen.
    left_out : dict
        Why a number of strikers was not run.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "settings"
    main_rows: ClassVar[str] = "candidates"

    case: Case
    goal: BlowGoal
    choice: SettingsChoices

    @declare.computed(declare.word("how many meet the goal", headline="settings that meet the goal", in_document=False))
    def met_count(self) -> str:
        """How many of the settings meet the goal."""
        return f"{sum(candidate.meets for candidate in self.candidates)} of {len(self.candidates)}"

    @declare.computed(declare.part(SettingsGoal, "what the blows shall be", key="goal"))
    def wanted(self) -> SettingsGoal:
        """What the blows shall be, and what may be chosen."""
        goal = self.goal
        return SettingsGoal(
            goal.interval, goal.peak, goal.width, goal.stop_limit, WITHIN, goal.disc.name, self.choice.vary
        )

    specification = declare.computed(
        declare.part(Specification, "what the blows are judged by", key="spec", optional=True)
    )(lambda one: one.goal.specification)
    case_name = declare.computed(declare.word("case that gives what is not chosen", key="from"))(
        lambda one: one.case.name
    )
    typical = declare.computed(declare.word("what typical and variation mean, in words"))(
        lambda one: "median of the later full blows; variation: standard deviation (n - 1) over mean of all"
    )
    sources = declare.computed(declare.word("sources of the models"))(
        lambda one: [citation(key) for key in one.citations]
    )
    met = declare.computed(declare.word("whether the best one meets the goal and keeps all limits"))(
        lambda one: not one.broken
    )

    @declare.computed(declare.part(SettingsCandidate, "the first that meets the goal; null where none does"))
    def best(self) -> SettingsCandidate | None:
        """First of the ranking if it meets the goal."""
        return self.candidates[0] if self.candidates[0].meets else None

    candidates: tuple[SettingsCandidate, ...] = declare.rows(
        SettingsCandidate, "the settings, the best first", headline="first"
    )
    left_out: dict[int, str]

    not_run = declare.computed(
        declare.rows(StrikersLeftOut, "numbers of strikers that were not run, and why", key="left_out")
    )(lambda one: [StrikersLeftOut(strikers, why) for strikers, why in one.left_out.items()])

    failed: tuple[str, ...] = declare.word("why settings gave no result")
    asked: str = ""

    @property
    def broken(self) -> bool:
        """Whether no setting meets the goal."""
        return self.best is None

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @property
    def source(self) -> Source:
        """The case of the first candidate, and above it what was asked."""
        text = asked_line(self.case, self.goal, self.choice) + dump_case(self.case_of())
        return Source("case", self.name, text, asked=self.asked)

    def case_of(self, place: int = 0) -> Case:
        """Return the case of a candidate, under a name of its own and without published numbers to compare with."""
        update = {"name": name_at(self.name, place), "title": self.title, "published": ()}
        return self.candidates[place].case.model_copy(update=update)

    @property
    def name(self) -> str:
        """Name of the case and of its folder."""
        return name_of(self.goal)

    @property
    def masses(self) -> list[SettingsCandidate]:
        """The first candidate, and those that differ from it in the strikers' mass alone, lightest first."""
        first = self.candidates[0]
        alike = [candidate for candidate in self.candidates if _without_mass(candidate) == _without_mass(first)]
        return sorted(alike, key=lambda candidate: candidate.case.values()["striker.mass"].si)

    @property
    def title(self) -> str:
        """The goal in words, after "nearest to" where no candidate meets it."""
        return ("nearest to " if self.broken else "") + goal_words(self.goal)

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        return {"settings.json": self.document_text(), **other_cases(len(self.candidates), self.case_of)}


def asked_line(case: Case, goal: BlowGoal, choice: SettingsChoices) -> str:
    """Return the first line of the written case: what was asked, and a mark of everything that it was asked of."""
    limits: tuple[object, ...] = (goal.interval, goal.peak, goal.width, goal.disc.name, goal.stop_limit)
    limits += () if goal.specification is None else (goal.specification.asked, goal.specification.text)
    mark = hashlib.sha256(f"{limits} {dataclasses.astuple(choice)} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal_words(goal)}, from {case.name or 'case'} ({mark})\n"


def _without_mass(candidate: SettingsCandidate) -> tuple[float, ...]:
    """Return number of strikers and support of a candidate."""
    values = candidate.case.values()
    return tuple(values[path].si for path in ("machine.strikers", "object.spring", "object.preload", "object.damper"))


def candidate_columns(varied: str, rows: Sequence[SettingsCandidate], table: str = "ranking") -> list[Column]:
    """Return the columns of candidates, or of what the "mass" of a striker costs, without what was not varied."""
    columns = columns_of(SettingsCandidate, rows, table)
    return [column for column in columns if column.name not in set(VARIED) - {varied}]


def _limit_result(limit: Limit) -> Tag:
    return Tag("kept", "good") if limit.kept else Tag("broken", "bad") if limit.decides else Tag("warned", "warned")


def limit_columns(limits: Sequence[Limit]) -> list[Column]:
    """Return the columns of limits of a candidate, each in its own unit."""
    return [*columns_of(Limit, limits), Column("result", [_limit_result(one) for one in limits], words=True)]
