"""Design of a drop table to a specification: programmers, sizes, heights and masses, each judged by its full run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.clauses import tag_of, verdict_words
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base import declare
from strikewave.base.compiling import compiling_shown
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import BALANCE_LIMIT, Notice
from strikewave.base.shock_quantities import LENGTH, MICROSECONDS, PEAK_FORCE, RATIO, RIGID_PEAK, VELOCITY
from strikewave.base.texts import percent
from strikewave.base.units import si_value
from strikewave.cases.case import FORM, Case, document_of, load_case
from strikewave.cases.contact_of_case import cushion_of_contact, or_else
from strikewave.contact.cushions import Cushion
from strikewave.machines import Blow, blows, run_machine
from strikewave.machines.launch import drop_for_half_sine
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount, capitalized, columns_of, text_of
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.specifications.ideal_pulses import HALF_SINE, IdealPulse
from strikewave.specifications.judged_records import rests_on_indicative
from strikewave.specifications.judging import PASS, Clause, PulseLimits, Shock, ShockVerdict, area_between, judge_shock
from strikewave.specifications.reading import Specification, load_specification
from strikewave.studies.engine.evaluation import case_text
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance, Workers, as_workers, share_reporter
from strikewave.studies.engine.store import RunStore, given_or_temporary, store_in
from strikewave.studies.search import DROP_TABLE
from strikewave.studies.search.machine import (
    PEAK,
    ROOM,
    RUN_CHECKS,
    STIFFNESS,
    ChosenValue,
    Limit,
    MachineCandidate,
    MachineSearch,
    SearchEnd,
    beside,
    chosen,
    peak_and_width,
    ranked,
    refuse_changes,
    search_end,
    shock_about,
    tried_designs,
)
from strikewave.studies.search.programmers import (
    DEFAULTS,
    LARGEST_SHAPE_FACTOR,
    THICKEST,
    THINNEST,
    FirstEstimate,
    Programmer,
    largest_strain,
    pad_of_case,
    power_estimate,
    read_programmer,
    thickness_for,
)

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
    """Wanted pulse: that of a specification, which judges it; ``stroke`` is the machine's largest height, m."""

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
        """The goal in words."""
        peak, duration = amount(PEAK, self.pulse.peak), amount(WIDTH, self.pulse.duration)
        return f"a half-sine of {peak} and {duration} by {self.specification.asked}".replace("\xa0", " ")

    @property
    def name(self) -> str:
        """Name of the case and of the folder."""
        return f"drop-{self.specification.file_name}"


@declare.dataclass
class DropReading:
    """Reading of a sensor on the table, its zero taken in the fall; SI.

    Attributes
    ----------
    shock : Shock
        History of the reading.
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
    """Relative misses of the goal."""

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
        """Chosen values, by their paths."""
        values = self.case.values()
        return {
            path: StatedChoice(values[path].si, values[path].typed, values[path].provenance) for path in self.chosen
        }

    reading: DropReading = declare.part(DropReading, "what a sensor on the table reads", inline=True)

    @declare.computed(declare.number(CHANGE, "of the pulse as it is judged", column=MORE))
    def velocity_change(self) -> float:
        """Integral of the reading over the window of the specification."""
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
        """True if the programmer gives back all that it takes: the height then counts on a full rebound."""
        return self.restitution >= LOSSLESS

    @property
    def relative_misses(self) -> dict[str, Any]:
        """Relative misses of peak and width."""
        return declare.content(self.misses)

    @property
    def passes(self) -> bool:
        """True if the specification passes the pulse."""
        return self.verdict.verdict == PASS

    @property
    def not_passed(self) -> list[str]:
        """Clauses of the specification that do not pass, in words."""
        failed = [clause.clause for clause in self.verdict.clauses if clause.verdict not in (PASS, "not-judged")]
        return [f"{', '.join(failed)} not passed"] if failed else []

    @property
    def rank(self) -> tuple[bool, bool, float, float, float]:
        """Key by which candidates are sorted.

        Designs that meet the goal come first, an assumed law behind those with a source, by the least margin of their
        clauses, the largest first, and by the departure from the ideal pulse, both in steps of 1 %, then by height;
        the others follow by their distance from the goal: a broken limit counts by its factor.
        """
        assumed = self.programmer.assumed
        if self.meets:
            return False, assumed, -round(self.margin, 2), round(self.departure, 2), self.height
        over = sum(limit.value / limit.limit - 1.0 for limit in self.broken)
        failed = sum(clause.verdict != PASS for clause in self.verdict.clauses)
        return True, assumed, min(self.largest_miss, 1e6) + over + failed, self.departure, self.height

    def limit_words(self, limit: Limit) -> str:
        """Return the sentence on a broken limit."""
        if limit.name == "drop_height":
            return f"needs a drop of {limit.value:.3g}\xa0m, above the stroke of {self.goal.stroke:.3g}\xa0m"
        if limit.name == "strain":
            return f"pressed by {percent(limit.value, 0)} of its thickness, above {percent(limit.limit, 0)}"
        if limit.name == "shape_factor":
            return f"shape factor {limit.value:.3g}, above {limit.limit:g}: bulk compression counts"
        return super().limit_words(limit)


Array = NDArray[np.float64]

OUTPUT_STEPS = 500.0  # samples a duration in the written case: `strikewave run` then draws the pulse smoothly
SIZES, HEIGHTS = 1e3, (1e-5, 1e3)
"""Largest factor of a rate over its first estimate, and bounds of the height, m: beyond any machine, so that no search
for a possible pulse ends at them."""
SLOPES = np.array([[0.5, 0.5], [-0.5, 0.0]])
"""First guess of d ln(peak, width)/d ln(rate, height): those of a half-sine; of a thickness with the other sign."""
DIAMETERS = (0.05, 0.075, 0.1, 0.15, 0.2, 0.3)
"""Default diameters of a pad, m: from a striking post to a table, in steps of a half and a third."""
STROKE = 2.0  # largest drop height by default, m: assumed; ask the maker of the machine
SURELY = 1.2
"""Height of the closed forms over the stroke above which nothing is run: full runs of springs take up to 7 % less where
the frame rings (measured)."""
RESTITUTIONS = (1.0, 0.9, 0.75, 0.5, 0.25, 0.0)
"""Coefficients of restitution for which the height is shown: from no loss to no rebound."""
MOST_CANDIDATES = 300
"""Most combinations of programmers, diameters and masses: at 0.1 to 0.5 s each they take two minutes."""
SOURCES = ("mindlin-1945", "gent-lindley-1959", "stulov-2004", "jesd22-b104")
"""Keys of the sources: of the laws of the programmers, of the equivalent drop height."""


@dataclass(frozen=True)
class DropChoices:
    """Programmers, diameters of a pad (m) and masses of the table (kg; empty for that of the case) to choose from."""

    programmers: tuple[Programmer, ...] = ()
    diameters: tuple[float, ...] = ()
    masses: tuple[float, ...] = ()

    def tried(self, case: Case) -> tuple[Programmer, ...]:
        """Return the programmers to try: those asked for, or else the pad of the case and `DEFAULTS`."""
        if self.programmers:
            return self.programmers
        pad = pad_of_case(case)
        defaults = tuple(read_programmer(word, own=True) for word in DEFAULTS)
        return defaults if pad is None else (pad, *defaults)

    def asked(self, case: Case, goal: DropGoal) -> str:
        """Return all that is asked, but for the case, as a text."""
        programmers = [(one.name, dict(one.given)) for one in self.tried(case)]
        asked = f"{goal.specification.text} {goal.specification.asked} {goal.stroke} {programmers} "
        return f"{asked}{self.diameters} {self.masses}"


@dataclass(frozen=True)
class FoundPulse:
    """Stored outcome of a full run: the `Shock` that a sensor reads, first blow, error of balance, and verdict."""

    values: tuple[float, ...]
    step: float
    begin: float
    peak_index: int
    blow: Blow
    energy_error: float
    run_verdict: str

    @property
    def shock(self) -> Shock:
        """Reading of a sensor on the table."""
        return Shock(np.array(self.values), self.step, self.begin, self.peak_index)


@dataclass(frozen=True)
class DropDesign:
    """A programmer that is tried for a goal: its first estimate, and the case at its settings.

    Settings are its rate (N/m) or thickness (m), and the drop height (m).
    """

    answered_by: ClassVar[Any] = tuple[SearchEnd, FoundPulse]

    case: Case
    goal: DropGoal
    programmer: Programmer
    diameter: float | None
    table_mass: float | None
    note: str

    def text(self) -> str:
        """Return a text of all values that its search depends on."""
        specification = self.goal.specification
        asked = self.programmer, self.diameter, self.table_mass, self.note, specification.asked
        return f"{asked} {specification.text} {case_text(self.case)}"

    @property
    def called(self) -> str:
        """Name in a sentence on a failure."""
        size = "" if self.diameter is None else f" of {self.diameter * 1e3:.4g} mm"
        return f"{self.programmer.name}{size}"

    @property
    def size_path(self) -> str:
        """Path of the chosen size."""
        return "contact.reference_force" if self.diameter is None else "contact.cushion.thickness"

    @cached_property
    def template(self) -> Case:
        """The case of the machine with the programmer, of which size and height are put in."""
        document, limits = document_of(self.case), self.goal.limits
        for table in ("fit", "published", "compare"):
            document.pop(table, None)
        slowest = document["contact"]["slowest_approach"]
        document["contact"] = self.programmer.contact_table(self.diameter, slowest)
        needed = chosen("machine.follow", (1.0 + beside(limits)[1] + 2.0 * ROOM) * limits.pulse.duration, self.note)
        if self.case.values()["machine.follow"].si < needed.si:
            document["machine"]["follow"] = needed.document()
        step = chosen("solver.output_step", self.goal.pulse.duration / OUTPUT_STEPS, self.note)
        document["solver"]["output_step"] = step.document()
        before = (beside(limits)[0] + ROOM) * self.goal.pulse.duration
        follow = max(self.case.values()["machine.follow"].si, needed.si)
        recorder = self.case.impact().recorder
        if recorder.pre_trigger.si < before:
            document["recorder"]["pre_trigger"] = chosen("recorder.pre_trigger", before, self.note).document()
        samples = math.floor((before + follow) * recorder.sampling_rate.si)
        if recorder.memory.si < samples:
            document["recorder"]["memory"] = chosen("recorder.memory", samples, self.note).document()
        document["machine"].pop("until", None)
        if self.table_mass is not None:
            document["object"]["mass"] = chosen("object.mass", self.table_mass, self.note).document()
        return FORM.read(document)

    @cached_property
    def cushion(self) -> Cushion | None:
        """The pad, of a thickness of 1 mm."""
        return None if self.diameter is None else cushion_of_contact(self.template.impact().contact)

    @property
    def mass(self) -> float:
        """Mass of the table, kg."""
        return float(self.template.values()["object.mass"].si)

    @property
    def friction(self) -> float:
        """Friction of the guides as a share of the weight."""
        return or_else(getattr(self.template.machine, "friction", None), 0.0)

    @cached_property
    def estimate(self) -> FirstEstimate:
        """Speed, rate or thickness, and compression by the closed forms; the pad by its force there."""
        pulse, level = self.goal.pulse, self.goal.limits.level
        restitution = self.template.impact().contact.restitution.si
        exponent = 1.0 if self.cushion is None else self.cushion.properties.get("exponent", 1.0)
        speed, compression = power_estimate(pulse.peak, self.goal.width, level, exponent, restitution)
        force = self.mass * pulse.peak
        if self.cushion is None:
            return FirstEstimate(speed, force / compression, compression)
        return FirstEstimate(speed, thickness_for(self.cushion, force, compression), compression)

    def height_for(self, speed: float) -> float:
        """Return the height from which the table falls to a speed along its guides, m: v^2/(2 g (1 - friction))."""
        return speed**2 / (2.0 * STANDARD_GRAVITY * (1.0 - self.friction))

    def changes(self, settings: Array) -> dict[str, Value]:
        """Return the values of the case at settings: rate (N/m) or thickness (m), height (m)."""
        size, height = (float(x) for x in settings)
        if self.diameter is None:
            size *= self.template.values()["contact.reference_depth"].si
        return {
            self.size_path: chosen(self.size_path, size, self.note),
            "machine.height": chosen("machine.height", height, self.note),
        }

    def case_at(self, settings: Array) -> Case:
        """Return the case at settings."""
        return self.template.with_values(self.changes(settings))

    def at_bound(self, logs: Array, low: Array, high: Array) -> str:
        """Return whether the size stands at its bound, in words; empty where it does not."""
        size = "rate" if self.cushion is None else "thickness"
        ends = [word for word, bound in (("least", low[0]), ("largest", high[0])) if math.isclose(logs[0], bound)]
        return f"the {size} stands at the {ends[0]} that is sought" if ends else ""

    def run(self, settings: Array) -> FoundPulse:
        """Run the case at settings, and return what a sensor on its table reads."""
        case = self.case_at(settings)
        run = run_machine(build_machine(case), case.solver.tolerance.si)
        train = blows(run)
        first = next((blow for blow in train if blow.kind != "missed"), None)
        if first is None:
            raise StrikewaveError("the table does not touch the programmer")
        shock, verdict = shock_about(run, first.time, self.goal.limits), run_verdict(case, run, train).text
        history = tuple(shock.values.tolist()), shock.step, shock.begin, shock.peak_index
        return FoundPulse(*history, first, run.energy_error, verdict)

    def off(self, settings: Array) -> Array:
        """Return the logarithms of peak and width over the goal."""
        peak, width = peak_and_width(self.run(settings).shock, self.goal.limits.level)
        return np.log([peak / self.goal.pulse.peak, width / self.goal.width])

    def answer(self) -> tuple[SearchEnd, FoundPulse]:
        """Return the end of its search, and the outcome of the full run there."""
        rate, pad = self.estimate.size, self.cushion is not None
        low, high = (THINNEST, THICKEST) if pad else (rate / SIZES, rate * SIZES)
        bounds = np.array([low, HEIGHTS[0]]), np.array([high, HEIGHTS[1]])
        start = np.array([rate, self.height_for(self.estimate.speed)])
        slopes = SLOPES * np.array([[-1.0, 1.0]]) if pad else SLOPES
        end = search_end(self.off, start, bounds, slopes, self.at_bound)
        return end, self.run(np.array(end.settings))

    def candidate(self, answer: tuple[SearchEnd, FoundPulse]) -> DropCandidate:
        """Return the candidate of an answer."""
        end, found = answer
        case, shock = self.case_at(np.array(end.settings)), found.shock
        peak, width = peak_and_width(shock, self.goal.limits.level)
        pad = () if self.diameter is None else ("contact.cushion.diameter",)
        return DropCandidate(
            case=case,
            place=0,
            goal=self.goal,
            chosen=("machine.height", self.size_path, *pad, "object.mass"),
            limits=self.limits_of(case, found),
            runs=end.runs,
            halt=end.halt,
            run_verdict=found.run_verdict,
            programmer=self.programmer,
            diameter=self.diameter,
            reading=DropReading(shock, peak, width, found.blow, found.energy_error),
            verdict=judge_shock(shock, self.goal.limits),
            estimate=self.estimate,
        )

    def limits_of(self, case: Case, found: FoundPulse) -> tuple[Limit, ...]:
        """Return the values of a candidate that have a limit."""
        limits = [Limit("drop_height", float(case.values()["machine.height"].si), self.goal.stroke, "m")]
        if self.cushion is not None:
            pad = cushion_of_contact(case.impact().contact)
            limits.append(Limit("strain", found.blow.indentation / pad.pad.thickness, largest_strain(pad), "1"))
            if pad.law == "elastomer" and "shape_factor" not in pad.properties:
                limits.append(Limit("shape_factor", pad.pad.shape_factor, LARGEST_SHAPE_FACTOR, "1"))
        limits.append(Limit("energy_error", found.energy_error, BALANCE_LIMIT, "1"))
        return tuple(limits)


@declare.dataclass
class WantedPulse:
    """Wanted pulse."""

    shape: str = declare.word("shape of the ideal pulse")
    peak: float = declare.number(PEAK, "its peak")
    duration: float = declare.number(WIDTH, "its duration")
    width: float = declare.number(WIDTH, "its width at the level")
    level: float = declare.number(RATIO, "share of the peak at which the width is taken")
    velocity_change: float = declare.number(VELOCITY, "its velocity change")
    stroke: float = declare.number(LENGTH, "largest drop height")
    within: float = declare.number(RATIO, "relative miss at which the search ends")


@declare.dataclass(eq=False)
class DropTableStudy(MachineSearch):
    """Ranked designs of a drop table for a specification; see `MachineSearch`."""

    command: ClassVar[str] = "settings"
    drawing: ClassVar[str] = "settings_report"
    noun: ClassVar[str] = "design"

    goal: DropGoal
    choice: DropChoices

    @declare.computed(declare.word("how many meet it", headline="designs that meet it", in_document=False))
    def met_count(self) -> str:
        """Number of designs that meet the specification, of all."""
        return f"{self.meeting} of {len(self.candidates)}"

    specification = declare.computed(declare.part(Specification, "what pulses are judged by", key="spec"))(
        lambda study: study.goal.specification
    )

    @declare.computed(declare.part(WantedPulse, "what the pulse shall be", key="goal"))
    def wanted(self) -> WantedPulse:
        """The ideal pulse, and the stroke of the machine."""
        goal, pulse = self.goal, self.goal.pulse
        ideal = pulse.shape, pulse.peak, pulse.duration, goal.width, goal.limits.level, pulse.velocity_change
        return WantedPulse(*ideal, goal.stroke, WITHIN)

    reading = declare.computed(declare.word("what is judged, in words"))(
        lambda study: "acceleration of the table less that of the fall: a sensor whose zero is taken before the blow"
    )

    @declare.computed(declare.word("whether the verdict rests on a limit from memory", key="by_indicative_limits"))
    def by_indicative(self) -> bool:
        """True if the verdict on the first rests on a limit that is from memory."""
        verdict = self.candidates[0].verdict
        return rests_on_indicative(verdict.clauses, verdict.verdict)

    @declare.computed(declare.part(DropCandidate, "the first that meets it; null where none does"))
    def best(self) -> DropCandidate | None:
        """First of the ranking if it meets the specification."""
        return None if self.broken else self.candidates[0]

    @declare.computed(declare.rows(HeightOfFall, "heights of a free fall for this velocity change"))
    def heights(self) -> tuple[HeightOfFall, ...]:
        """Heights of free falls that give the velocity change of the ideal pulse, for `RESTITUTIONS`."""
        pulse, friction = self.goal.pulse, or_else(getattr(self.case.machine, "friction", None), 0.0)
        pull = STANDARD_GRAVITY * (1.0 - friction)
        return tuple(
            HeightOfFall(e, drop_for_half_sine(pulse.peak, pulse.duration, e, pull).height) for e in RESTITUTIONS
        )

    candidates: tuple[DropCandidate, ...] = declare.rows(DropCandidate, "the designs, the best first", headline="first")
    failed: tuple[str, ...] = declare.word("why designs gave no result")

    @property
    def title(self) -> str:
        """The goal in words, after "nearest to" where no design meets it."""
        return capitalized(super().title)

    @property
    def named_units(self) -> Mapping[str, str]:
        """Units of the misses, which are shares of numbers of the same names."""
        return dict.fromkeys(("misses.peak", "misses.width"), NO_UNIT)

    def preview(self) -> Curve:
        """Return the pulse of the first."""
        shock = self.candidates[0].reading.shock
        return history_curve(shock.time, shock.values, *PEAK.units, "acceleration of the table")

    def candidate_columns(self, designs: Sequence[DropCandidate]) -> list[Column]:
        """Return the columns of designs, with verdicts as they are written."""
        judged = [tag_of(design.judged) for design in designs]
        columns = columns_of(DropCandidate, designs)
        return [column._replace(values=judged) if column.name == "verdict" else column for column in columns]

    def first_sentences(self, which: str, settings: str) -> list[str]:
        """Return the sentences on the first design: its programmer, the verdict, and its height without rebound."""
        first = self.candidates[0]
        judged = verdict_words(first.verdict.verdict, self.by_indicative)
        sentences = [f"{which}, {first.programmer.name}: {settings}; {judged}."]
        if first.lossless:
            highest = text_of(self.heights[-1], "height")
            sentences.append(f"Its height counts on a full rebound: without any it is {highest}.")
        return sentences


def check_drop_changes(changes: Iterable[str], case: Case, choice: DropChoices) -> None:
    """Refuse a change (``path=value``) of a field that is chosen here: the search would replace it, with no warning.

    Examples
    --------
    >>> from strikewave.cases.case import load_case
    >>> check_drop_changes(["machine.height=1 m"], load_case("jesd22-b111-b"), DropChoices())
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: machine.height: got "1 m"; allowed: no --set of it: it is chosen for the \
velocity change; leave it out, or limit it by --stroke
    """
    chosen_here = {"machine.height": (" for the velocity change", "leave it out, or limit it by --stroke")}
    if choice.masses:
        chosen_here["object.mass"] = (" from --table-mass", "leave out one of both")
    refuse_changes(changes, chosen_here)
    pad = any(one.table is not None for one in choice.tried(case))
    for change in changes:
        path, _, value = (part.strip() for part in change.partition("="))
        size = path.rpartition(".")[2] in ("diameter", "area", "thickness")
        if path.startswith("contact.") and path != "contact.slowest_approach" and (size or not pad):
            raise InputError(
                path, value, "no --set of it: the programmer is chosen", "--programmer or --diameter state it"
            )


def check_drop(case: Case, goal: DropGoal, choice: DropChoices) -> None:
    """Refuse what no drop table can do, before anything is run."""
    kind = getattr(case.machine, "kind", "rotary")
    if kind != "drop":
        raise InputError("--from", case.name, "a drop table or a rotary machine with --spec", f"this is a {kind}")
    if case.stack.layer or case.impact().object.mass is None:
        raise InputError("--from", case.name, "a table of two bodies, nose and assembly", "leave out the stack")
    if goal.pulse.shape != HALF_SINE:
        allowed = "a half-sine: no programmer that comes back makes another shape"
        raise InputError("--spec", goal.specification.asked, allowed, f"a {goal.pulse.shape} takes one that crushes")
    many = len(choice.tried(case)) * max(len(choice.diameters or DIAMETERS), 1) * max(len(choice.masses), 1)
    if many > MOST_CANDIDATES:
        raise InputError("--programmer", f"{many} designs to try", f"at most {MOST_CANDIDATES}", "ask for fewer")


def design_drop_table(
    case: Case,
    goal: DropGoal,
    choice: DropChoices | None = None,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> DropTableStudy:
    """Return designs of a drop table for a specification, ranked; see `drop_table`."""
    choice = choice or DropChoices()
    check_drop(case, goal, choice)
    note = f"chosen by strikewave settings for {goal.words}"
    designs = list[DropDesign]()
    for programmer in choice.tried(case):
        diameters: Sequence[float | None] = (None,)
        if programmer.is_pad:  # a pad of the case is tried at its own diameter too
            own = case.values().get("contact.cushion.diameter") if programmer.table is not None else None
            diameters = choice.diameters or sorted({*DIAMETERS, *([] if own is None else [own.si])})
        designs += [
            DropDesign(case, goal, programmer, diameter, mass, note)
            for mass in choice.masses or (None,)
            for diameter in diameters
        ]
    heights = {design.height_for(design.estimate.speed): design for design in designs}
    least = min(heights)
    if least > SURELY * goal.stroke:  # where the closed forms are not far beyond the stroke, full runs decide
        easiest, change, stroke = heights[least], goal.pulse.velocity_change, goal.stroke * 1e3
        restitution = easiest.template.impact().contact.restitution.si
        reached = (1.0 + restitution) * np.sqrt(2.0 * STANDARD_GRAVITY * (1.0 - easiest.friction) * goal.stroke)
        name = goal.specification.asked
        raise InputError(
            "--stroke",
            f"{stroke:.4g} mm",
            f"about {least * 1e3:.4g} mm or more for {name}, a velocity change of {change:.4g} m/s",
            f"a fall of {stroke:.4g} mm gives at most {reached:.4g} m/s with {easiest.programmer.name}: a longer "
            "stroke, a programmer that gives back more, or a driven table",
        )
    with given_or_temporary(store) as kept, pool or ProcessPool(1) as open_pool:
        candidates, failed, verdicts = ranked(tried_designs(designs, kept, open_pool, advance))
    study = DropTableStudy(case, goal, choice, candidates, failed, citations=SOURCES, verdicts=verdicts)
    return replace(study, notices=(*_notices(study), *verdicts.notices()))


def _notices(study: DropTableStudy) -> Iterator[Notice]:
    """Yield the warnings on programmers that lose nothing, on those of an assumed law, and on the first candidate."""
    lossless = [candidate for candidate in study.candidates if candidate.lossless]
    if lossless:
        highest = study.heights[-1]
        names = ", ".join(dict.fromkeys(one.programmer.name for one in lossless))
        message = (
            f"{names}: nothing is lost, so the height counts on a full rebound; without any rebound the "
            f"same velocity change takes {text_of(highest, 'height')}. Give the restitution of the programmer, such "
            "as --programmer 'linear, restitution=0.5'"
        )
        yield Notice("no-loss", message, min(one.height for one in lossless), highest.height)
    for name in dict.fromkeys(one.programmer.name for one in study.candidates if one.programmer.assumed):
        message = f"the law of {name} is assumed, nobody measured it: it stands after those that have a source"
        yield Notice("assumed-law", message)
    yield from study.not_met()


@compiling_shown()
def drop_table(
    spec: str,
    case: Case | None = None,
    *,
    programmers: Sequence[str] = (),
    diameters: Sequence[str | float] = (),
    masses: Sequence[str | float] = (),
    stroke: str | float = STROKE,
    workers: int | Workers | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> DropTableStudy:
    """Find drop height and programmer of a drop table that give the pulse of a specification.

    Every design is checked by full runs, about a tenth of a second each.

    Parameters
    ----------
    spec : str
        Specification of a half-sine: a built-in one with its condition, or a file.
    case : Case, optional
        Gives what is not chosen; jesd22-b111-b by default.
    programmers : sequence of str, optional
        To try, such as ``"felt, stress=20 MPa, exponent=2.5, retardation=20 us"``; several by default.
    diameters, masses : sequence of str or float, optional
        Diameters of pads, and masses of the table with its load.
    stroke : str or float, optional
        Largest drop height.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``; threads of this
        process where it is left out.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    DropTableStudy
        Designs, the best first, each with its full run.

    Raises
    ------
    InputError
        If no design can give it, or none could be run: with the reasons.

    Examples
    --------
    >>> import strikewave
    >>> study = strikewave.drop_table("jesd22-b110:A", programmers=["linear"])
    >>> study.best.case.machine.height.typed, round(study.best.reading.peak / 9.80665)
    ('126.1 mm', 500)
    """
    specification = load_specification(spec, "spec")
    goal = DropGoal(specification, specification.pulse_limits(), si_value(stroke, "m", "stroke"))
    choice = DropChoices(
        tuple(read_programmer(word, field="programmers") for word in programmers),
        tuple(si_value(diameter, "m", "diameters") for diameter in diameters),
        tuple(si_value(mass, "kg", "masses") for mass in masses),
    )
    chosen = load_case(DROP_TABLE) if case is None else case
    with store_in(store) as finished:
        return design_drop_table(chosen, goal, choice, finished, as_workers(workers).pool(), share_reporter(progress))
