"""A design of a drop table: its settings, the pulse in a full run, the verdict, the limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import LENGTH, MICROSECONDS, PEAK_FORCE, RATIO, RIGID_PEAK, VELOCITY
from strikewave.base.texts import percent
from strikewave.machines import Blow
from strikewave.reporting.faces import amount
from strikewave.specifications.ideal_pulses import IdealPulse
from strikewave.specifications.judging import PASS, Clause, PulseLimits, Shock, ShockVerdict, area_between
from strikewave.specifications.reading import Specification
from strikewave.studies.search.machine import PEAK, RUN_CHECKS, STIFFNESS, ChosenValue, Limit, MachineCandidate
from strikewave.studies.search.programmers import FirstEstimate, Programmer

LOSSLESS = 0.99
"""Coefficient of restitution from which on a programmer is said to lose nothing. Chosen: one that gives back 0.99 takes
1 % more height than one that gives back all, less than a height is set to; the frame of a table takes less."""
WITHIN = 0.005
"""Largest miss of peak and width of a candidate: the search comes to 0.2 %; rounding to four digits moves it less."""
REBOUND = Quantity(NO_UNIT, "%", "rebound", 0, 0)
WIDTH = Quantity("s", "ms", "width")
CHANGE = Quantity("m/s", "m/s")
MASS = Quantity("kg", "kg")


@dataclass(frozen=True)
class DropGoal:
    """What the pulse shall be: that of a specification, judged by it; ``stroke`` is the machine's largest height, m."""

    specification: Specification
    limits: PulseLimits
    stroke: float

    @property
    def pulse(self) -> IdealPulse:
        """The ideal pulse."""
        return self.limits.pulse

    @property
    def width(self) -> float:
        """Width of the ideal pulse at the share of its peak where the specification takes it, s."""
        return self.pulse.width(self.limits.level)

    @property
    def words(self) -> str:
        """It in words."""
        peak, duration = amount(PEAK, self.pulse.peak), amount(WIDTH, self.pulse.duration)
        return f"a half-sine of {peak} and {duration} by {self.specification.asked}".replace("\xa0", " ")

    @property
    def name(self) -> str:
        """Name of the case and of the folder."""
        return f"drop-{self.specification.file_name}"


@declare.dataclass
class DropReading:
    """What a sensor on the table reads, its zero taken in the fall; SI.

    Attributes
    ----------
    shock : Shock
        Its history.
    blow : Blow
        First blow of the run.
    energy_error : float
        Energy balance error of the run.
    """

    shock: Shock
    peak: float = declare.number(PEAK, "of the pulse as it is judged", column=MAIN, headline="peak")
    width: float = declare.number(WIDTH, "of the pulse as it is judged", column=MAIN, headline="pulse width")
    blow: Blow
    energy_error: float


@declare.dataclass
class HeightOfFall:
    """A height of a free fall along the guides."""

    restitution: float = declare.number(REBOUND, "coefficient of restitution of a programmer", column=KEY)
    height: float = declare.number(
        LENGTH,
        "of a free fall that then gives the velocity change of the ideal pulse",
        label="height of a free fall",
        column=MAIN,
    )


@declare.dataclass
class StatedChoice(ChosenValue):
    """A value that was chosen, and where it comes from."""

    provenance: str = declare.word("where it comes from")


@declare.dataclass
class PulseMisses:
    """By how much of itself the goal is missed."""

    peak: float = declare.number(RATIO, "by how much of itself the peak of the goal is missed")
    width: float = declare.number(RATIO, "by how much of itself the width of the goal is missed")


@declare.dataclass
class ProgrammerBlow:
    """The first blow of the full run on the programmer."""

    approach: float = declare.number(VELOCITY, "speed of the table at first touch")
    rigid_peak: float = declare.number(RIGID_PEAK, "peak of the rigid-body acceleration of the run")
    rise: float = declare.number(MICROSECONDS, "from 10 to 90 % of that peak")
    peak_force: float = declare.number(PEAK_FORCE, "largest force of the programmer")
    compression: float = declare.number(LENGTH, "largest compression of the programmer")


@declare.dataclass(eq=False)
class DropCandidate(MachineCandidate):
    """A programmer with a drop height: its pulse in a full run, and the verdict on it; see `MachineCandidate`.

    Attributes
    ----------
    verdict : ShockVerdict
        Verdict of the specification.
    """

    within: ClassVar[float] = WITHIN

    goal: DropGoal

    judged = declare.computed(
        declare.word("of the specification", key="verdict", label="verdict", column=MORE, order=1)
    )(lambda candidate: candidate.verdict.verdict)
    margin = declare.computed(
        declare.number(
            Quantity(NO_UNIT, "%", decimals=0, digits=0),
            "least margin of its clauses, as a share of half their tolerance",
            column=MORE,
            order=1,
        )
    )(lambda candidate: candidate.verdict.least_margin(candidate.goal.limits))

    @declare.computed(
        declare.number(
            Quantity(NO_UNIT, "%", decimals=1, digits=0),
            "root mean square of the pulse less the ideal one, over its peak",
            column=MORE,
            order=1,
        )
    )
    def departure(self) -> float:
        """Root mean square of the pulse less the ideal one, while that lasts, over its peak."""
        shock, pulse = self.reading.shock, self.goal.pulse
        since = shock.time - self.verdict.start
        inside = (since >= 0.0) & (since <= pulse.duration)
        return float(np.sqrt(np.mean((shock.values[inside] - pulse.at(since[inside])) ** 2))) / pulse.peak

    programmer: Programmer = declare.part(Programmer, "its programmer", inline=True)

    height = declare.computed(declare.number(LENGTH, "drop height", column=MAIN, headline="drop height"))(
        lambda candidate: float(candidate.case.values()["machine.height"].si)
    )
    table_mass = declare.computed(declare.number(MASS, "mass of the table with its load", label="table", column=MORE))(
        lambda candidate: float(candidate.case.values()["object.mass"].si)
    )

    diameter: float | None = declare.number(LENGTH, "of the pad; null of a programmer without one", column=MAIN)

    @declare.computed(declare.number(LENGTH, "of the pad; null of a programmer without one", column=MAIN))
    def thickness(self) -> float | None:
        """Thickness of a pad; None of a spring."""
        return None if self.diameter is None else float(self.case.values()["contact.cushion.thickness"].si)

    @declare.computed(declare.number(STIFFNESS._replace(digits=4), "stiffness of a linear programmer", column=MORE))
    def rate(self) -> float:
        """Rate of a spring; of a pad its largest force over the compression there."""
        if self.diameter is not None:
            return self.reading.blow.peak_force / self.reading.blow.indentation
        values = self.case.values()
        return float(values["contact.reference_force"].si / values["contact.reference_depth"].si)

    restitution = declare.computed(
        declare.number(REBOUND, "its coefficient of restitution in the full run", column=MAIN)
    )(lambda candidate: candidate.reading.blow.restitution)

    @declare.computed(declare.named(StatedChoice, "what was chosen"))
    def settings(self) -> dict[str, StatedChoice]:
        """What was chosen, by its path."""
        values = self.case.values()
        return {
            path: StatedChoice(values[path].si, values[path].typed, values[path].provenance) for path in self.chosen
        }

    reading: DropReading = declare.part(DropReading, "what a sensor on the table reads", inline=True)

    @declare.computed(declare.number(CHANGE, "of the pulse as it is judged", column=MORE))
    def velocity_change(self) -> float:
        """Integral of what the sensor reads, over what the specification integrates."""
        duration, (before, after) = self.goal.pulse.duration, self.goal.limits.window
        start = self.verdict.start
        return area_between(self.reading.shock, start - before * duration, start + (1.0 + after) * duration)

    @declare.computed(declare.part(PulseMisses, "by how much of itself the goal is missed", quantity=RATIO))
    def misses(self) -> PulseMisses:
        """Relative misses of peak and width."""
        reading, goal = self.reading, self.goal
        return PulseMisses(reading.peak / goal.pulse.peak - 1.0, reading.width / goal.width - 1.0)

    @declare.computed(declare.part(ProgrammerBlow, "the first blow of the run", inline=True))
    def blow(self) -> ProgrammerBlow:
        """The first blow of the full run."""
        blow = self.reading.blow
        return ProgrammerBlow(blow.approach_speed, blow.rigid_peak, blow.rise, blow.peak_force, blow.indentation)

    verdict: ShockVerdict

    clauses = declare.computed(declare.rows(Clause, "clauses of the specification"))(
        lambda candidate: candidate.verdict.clauses
    )

    limits: tuple[Limit, ...] = declare.rows(Limit, "its limits")
    estimate: FirstEstimate = declare.part(FirstEstimate, "closed form with which the search began")
    runs: int = declare.count("runs that it took")
    run_verdict: str = declare.word(RUN_CHECKS, column=MORE, order=2)

    @property
    def lossless(self) -> bool:
        """Whether the programmer gives back all that it takes: the height then counts on a full rebound."""
        return self.restitution >= LOSSLESS

    @property
    def relative_misses(self) -> dict[str, Any]:
        """Relative misses of peak and width."""
        return declare.content(self.misses)

    @property
    def passes(self) -> bool:
        """Whether the specification passes the pulse."""
        return self.verdict.verdict == PASS

    @property
    def not_passed(self) -> list[str]:
        """Clauses of the specification that are not passed, in words."""
        failed = [clause.clause for clause in self.verdict.clauses if clause.verdict not in (PASS, "not-judged")]
        return [f"{', '.join(failed)} not passed"] if failed else []

    @property
    def rank(self) -> tuple[bool, bool, float, float, float]:
        """What candidates are ordered by.

        First those that meet the goal, an assumed law behind those with a source, by the least margin of their clauses,
        the largest first, and by the departure from the ideal pulse, both in steps of 1 %, then by height; then the
        others by how far they are: a limit that is not kept by its factor.
        """
        assumed = self.programmer.assumed
        if self.meets:
            return False, assumed, -round(self.margin, 2), round(self.departure, 2), self.height
        over = sum(limit.value / limit.limit - 1.0 for limit in self.broken)
        failed = sum(clause.verdict != PASS for clause in self.verdict.clauses)
        return True, assumed, min(self.largest_miss, 1e6) + over + failed, self.departure, self.height

    def limit_words(self, limit: Limit) -> str:
        """Say that a limit is not kept."""
        if limit.name == "drop_height":
            return f"needs a drop of {limit.value:.3g}\xa0m, above the stroke of {self.goal.stroke:.3g}\xa0m"
        if limit.name == "strain":
            return f"pressed by {percent(limit.value, 0)} of its thickness, above {percent(limit.limit, 0)}"
        if limit.name == "shape_factor":
            return f"shape factor {limit.value:.3g}, above {limit.limit:g}: bulk compression counts"
        return super().limit_words(limit)
