"""What documents and tables of a design have: goals, runs, ranked settings, how numbers move, what excludes what."""

from __future__ import annotations

from typing import Any

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.studies.design.candidates import Robustness
from strikewave.studies.engine.case_evaluation import OF_NUMBER, OfKept

DERIVED = Quantity(NO_UNIT, "%", decimals=2, digits=0)
"""Of a number that goals alone have: a share of a yield strength, of a range, or a least margin."""
MARGIN = Quantity(NO_UNIT, "%", "margin", 1, 0)


@declare.dataclass
class StatedGoal:
    """What a number must lie within."""

    goal: str = declare.word("as typed")
    number: str = declare.word("number that it is of")
    low: float = declare.word("low limit, SI")
    high: float = declare.word("high limit, SI")


@declare.dataclass
class DesignRun:
    """A run of a design."""

    run: int = declare.count("number of the run, from 1")
    settings: dict[str, Any] = declare.word("its settings by their paths, SI or words")
    numbers: dict[str, float] = declare.word("its numbers by their names, SI")


@declare.dataclass
class RankedRun(DesignRun):
    """A ranked setting as documents have it."""

    meets: bool = declare.word("whether it meets all goals")
    margin: float = declare.number(
        MARGIN, "least margin, as of clauses: the distance to the nearer limit over its scale"
    )
    margins: dict[str, float] = declare.number(MARGIN, "margin of each goal")
    verified_margins: dict[str, float] | None = declare.number(
        MARGIN, "the same by a full run, where that is another one"
    )
    failure: str = declare.word("why that run failed; empty where it did not")
    verdict: str = declare.word("what the checks of its run came to: passed, or broken with the checks that failed")
    robust: Robustness | None = declare.part(
        Robustness, "by the option robust: how many draws within the tolerances meet all goals"
    )


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
class SettingChanges:
    """How the numbers move with a setting."""

    setting: str = declare.word("path of a setting of the best one")
    changes: dict[str, float] = declare.word(
        "change of each number, SI, for a hundredth of the range of the setting", key="changes_per_hundredth_of_range"
    )
    room: list[float] = declare.word("how far it may move down and up until a goal is missed, SI")


@declare.dataclass
class NumberChange(OfKept):
    """How a number moves with a setting."""

    setting: str = declare.word("path of the setting", column=KEY, order=-1)
    number: str = declare.word("which number", column=KEY, order=-1)
    size: float
    met_from: str | None = declare.word(
        "down to where it may move alone", label="all goals met from", quantity=OF_NUMBER, column=MAIN
    )
    met_to: str | None = declare.word("up to where", label="to", quantity=OF_NUMBER, column=MAIN)

    @declare.phrase("change per 1 % of its range", quantity=OF_NUMBER, column=MAIN, order=-1)
    def change(self) -> str:
        """Say by how much it moves, with its sign."""
        return f"{'-' if self.size < 0.0 else '+'}{self.kept.words(abs(self.size)) if self.size else '0'}"


@declare.dataclass
class GoalReach(OfKept):
    """A goal that others exclude, and what it comes to where they are met."""

    without: str = declare.word("goal that is given up, as typed", label="without the goal", column=KEY)
    value: float = declare.number(OF_NUMBER, "its number at best", label="it comes to", column=KEY)
    lacks: float = declare.number(OF_NUMBER, "what its limit lacks", label="its limit would move by", column=MAIN)
    run: DesignRun = declare.part(DesignRun, "where", inline=True)
    at: str = declare.word("where", label="at", column=MORE, in_document=False)


@declare.dataclass
class GoalConflict:
    """Goals that exclude each other."""

    goals: list[str] = declare.word("the fewest goals that exclude each other")
    reachable: list[GoalReach] = declare.rows(GoalReach, "what each comes to under the others")


@declare.dataclass
class KnownNumber(OfKept):
    """How well a number is known by the other runs."""

    name: str = declare.word("which number", label="number", column=KEY)
    error: float = declare.number(
        OF_NUMBER, "root mean square of what is left", label="leave-one-out error", column=KEY
    )
    share: float = declare.number(
        Quantity(NO_UNIT, "%", "of its scatter over the runs", 1, 0), "the same over its scatter", column=MAIN
    )


@declare.dataclass
class ChosenSetting:
    """A value of the first setting, as a case file has it."""

    name: str = declare.word("path of the setting")
    value: str = declare.word("its value", headline="{name}")
