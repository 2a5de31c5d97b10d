"""Ranked settings for a goal, as Python, a page and a JSON document show them."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from strikewave.base.citations import citation
from strikewave.base.result import Source
from strikewave.cases.case import FORM, Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import ShownResult, columns_of
from strikewave.specifications.judged_records import clause_document
from strikewave.specifications.judging import worst_clauses
from strikewave.studies.settings.answer_files import name_at, other_cases
from strikewave.studies.settings.candidate import WITHIN, BlowSpread, SettingsCandidate
from strikewave.studies.settings.estimate import engagement_sensitivity
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices, goal_words, name_of

_SPREAD = ("typical", "first", "worst")
"""Parts of a `BlowSpread` in the unit of its quantity."""
UNITS = {
    "interval": "s", "peak": "m/s^2", "width": "s", "within": "1", "variation": "1", "approach": "m/s",
    "velocity_change": "m/s", "peak_force": "N", "largest_displacement": "m", "stop_force": "N", "energy_taken": "J",
    "speed_lost": "rad/s", "speed_regained": "rad/s", "slowest": "rad/s", "engagement": "m", "stiffness": "N/m",
    "turntable_speed": "rad/s", "passage_time": "s", "return_time": "s", "settling_time": "s", "energy_error": "1",
    "stop_limit": "N", "engagement_sensitivity": "1/m",
}  # fmt: skip
"""SI unit of each quantity of the document; ``settings`` and ``limits`` name their own."""


@dataclass(frozen=True, eq=False)
class SettingsStudy(ShownResult):
    """Ranked settings for a goal; see `design_settings`, and `Result` for what it shares with others.

    ``left_out`` holds the reason why a number of strikers was not run, ``failed`` why a setting gave no result,
    and ``asked`` is the command line that gives it again, where one does.
    """

    command: ClassVar[str] = "settings"

    case: Case
    goal: BlowGoal
    choice: SettingsChoices
    candidates: tuple[SettingsCandidate, ...]
    left_out: dict[int, str]
    failed: tuple[str, ...]
    asked: str = ""

    @property
    def best(self) -> SettingsCandidate | None:
        """First of the ranking if it meets the goal."""
        return self.candidates[0] if self.candidates[0].meets else None

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

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many settings meet the goal, and the first one with its blows."""
        first = self.candidates[0]
        values, seen = first.case.values(), first.observation
        met = sum(candidate.meets for candidate in self.candidates)
        return [
            ("settings that meet the goal", f"{met} of {len(self.candidates)}"),
            ("speed", with_unit(values["machine.speed"].si, "rad/s", "rpm")),
            ("strikers", f"{values['machine.strikers'].si:.0f}"),
            ("engagement", with_unit(values["machine.engagement"].si, "m", "mm")),
            ("typical peak", with_unit(seen.peak.typical, "m/s^2", "g")),
            ("typical width", with_unit(seen.width.typical, "s", "us")),
        ]

    def columns(self) -> list[Column]:
        """Return the candidates, the best first; settings in SI by their paths."""
        rows = []
        for place, one in enumerate(self.candidates, 1):
            row = _row(place, one)
            settings = {path: values["si"] for path, values in row["settings"].items()}
            left = ("settings", "estimate", "blows", "clauses")
            rows.append({k: v for k, v in row.items() if k not in left} | settings)
        paths = {path: FORM.range_at(path.split(".")) for one in self.candidates for path in one.chosen}
        units = UNITS | {path: "" if of is None or of.unit == "count" else of.unit for path, of in paths.items()}
        spread = {f"{name}.{part}": UNITS[name] for name in ("peak", "width", "interval") for part in _SPREAD}
        return columns_of(rows, units | spread)

    def brief(self) -> dict[str, str]:
        """Return the main settings of each candidate, and its typical blow."""
        settings = {"strikers": "", "machine.speed": "rpm", "machine.engagement": "mm"}
        blow = {
            "peak.typical": "g",
            "width.typical": "us",
            "interval.typical": "ms",
            "peak.variation": "1",
            "run_verdict": "",
        }
        return {"place": "", "meets": "", **settings, **blow}

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        return {"settings.json": self.document_text(), **other_cases(len(self.candidates), self.case_of)}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        rows = [_row(place, one) for place, one in enumerate(self.candidates, 1)]
        goal = {key: getattr(self.goal, key) for key in ("interval", "peak", "width", "stop_limit")}
        return {
            "goal": {**goal, "within": WITHIN, "disc": self.goal.disc.name, "vary": self.choice.vary},
            **({} if self.goal.specification is None else {"spec": self.goal.specification.document()}),
            "from": self.case.name,
            "typical": "median of the later full blows; variation: standard deviation (n - 1) over mean of all",
            "sources": [citation(key) for key in self.citations],
            "met": not self.broken,
            "best": None if self.broken else rows[0],
            "candidates": rows,
            "left_out": [{"strikers": n, "why": why} for n, why in self.left_out.items()],
            "failed": list(self.failed),
        }


def asked_line(case: Case, goal: BlowGoal, choice: SettingsChoices) -> str:
    """Return the first line of the written case: what was asked, and a mark of everything that it was asked of."""
    limits: tuple[object, ...] = (goal.interval, goal.peak, goal.width, goal.disc.name, goal.stop_limit)
    limits += () if goal.specification is None else (goal.specification.asked, goal.specification.text)
    mark = hashlib.sha256(f"{limits} {dataclasses.astuple(choice)} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal_words(goal)}, from {case.name or 'case'} ({mark})\n"


def _row(place: int, one: SettingsCandidate) -> dict[str, Any]:
    """Return a candidate as a row of the document."""
    observation, values = one.observation, one.case.values()
    spreads: dict[str, BlowSpread] = {
        "peak": observation.peak,
        "width": observation.width,
        "interval": observation.interval,
    }
    return {
        "place": place,
        "meets": one.meets,
        "obstacles": one.obstacles,
        "strikers": round(values["machine.strikers"].si),
        "settings": {path: {"si": values[path].si, "typed": values[path].typed} for path in one.chosen},
        **{name: {**spread._asdict(), "miss": one.misses[name]} for name, spread in spreads.items()},
        "blows": {
            "wanted": observation.wanted,
            "kinds": list(observation.kinds),
            "touched_again": observation.touched_again,
            "odd": observation.odd,
        },
        **{
            key: getattr(observation, key)
            for key in ("approach", "velocity_change", "peak_force", "largest_displacement", "energy_error")
        },
        **observation.supply._asdict(),
        "engagement_sensitivity": engagement_sensitivity(values["machine.engagement"].si, values["machine.radius"].si),
        "limits": [{**limit._asdict(), "kept": limit.kept} for limit in one.limits],
        "estimate": one.estimate,
        "runs": one.runs,
        "run_verdict": one.run_verdict,
        **_verdict_row(one),
    }


def _verdict_row(one: SettingsCandidate) -> dict[str, Any]:
    """Return the verdict on a candidate for the document: each clause where it came out worst; nothing without one."""
    if not one.verdicts:
        return {}
    clauses = [{**clause_document(clause), "blow": place + 1} for clause, place in worst_clauses(one.verdicts)]
    return {"verdict": one.judged, "clauses": clauses}


def _without_mass(candidate: SettingsCandidate) -> tuple[float, ...]:
    """Return number of strikers and support of a candidate."""
    values = candidate.case.values()
    return tuple(values[path].si for path in ("machine.strikers", "object.spring", "object.preload", "object.damper"))
