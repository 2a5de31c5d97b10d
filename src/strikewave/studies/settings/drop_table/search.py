"""A programmer of a drop table found by full runs: its size and the drop height, judged by a specification."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import BALANCE_LIMIT
from strikewave.cases.case import FORM, Case
from strikewave.cases.contact_of_case import cushion_of_contact, or_else
from strikewave.cases.written_case import document_of
from strikewave.contact.cushions import Cushion
from strikewave.machines import Blow, blows, run_machine
from strikewave.specifications.decisions import PASS
from strikewave.specifications.judging import Shock, judge_shock
from strikewave.studies.engine.keys import case_text
from strikewave.studies.settings.broyden import nearest_settings
from strikewave.studies.settings.candidate import Limit
from strikewave.studies.settings.drop_table.candidate import DropCandidate, DropGoal, DropReading
from strikewave.studies.settings.drop_table.programmers import (
    LARGEST_SHAPE_FACTOR,
    THICKEST,
    THINNEST,
    FirstEstimate,
    Programmer,
    largest_strain,
    power_estimate,
    thickness_for,
)
from strikewave.studies.settings.judged_run import ROOM, beside, followed, peak_and_width, shock_about
from strikewave.studies.settings.search import chosen, reason_of

Array = NDArray[np.float64]

OUTPUT_STEPS = 500.0
"""Samples of the written case a duration: `strikewave run` then draws the pulse smoothly."""
SIZES, HEIGHTS = 1e3, (1e-5, 1e3)
"""Largest factor of a rate from its first estimate, and heights between which a drop is sought, m: beyond any machine,
so that a search never stands at them for a pulse that a machine could make."""
SLOPES = np.array([[0.5, 0.5], [-0.5, 0.0]])
"""First guess of d ln(peak, width)/d ln(rate, height): those of a half-sine; of a thickness with the other sign."""


UNTOUCHED = "the table does not touch the programmer"


@dataclass(frozen=True)
class FoundDrop:
    """Where a search ended, and its last run.

    Attributes
    ----------
    settings : tuple of float
        Rate (N/m) or thickness (m), and height (m).
    runs : int
        Of the search.
    halt : str
        Why it ended before the goal; empty where it came close.
    values, step, begin, peak_index
        Of the `Shock` that a sensor reads.
    blow : Blow
        What the run says of the first blow.
    energy_error : float
        Of the balance of the run.
    verdict : str
        What the checks of the run came to: the text of `strikewave.base.result.Verdict`.
    """

    settings: tuple[float, ...]
    runs: int
    halt: str
    values: tuple[float, ...]
    step: float
    begin: float
    peak_index: int
    blow: Blow
    energy_error: float
    verdict: str = ""


@dataclass(frozen=True)
class DropDesign:
    """A programmer on a machine with a goal: its first estimate, the case at given sizes; a `Question` of a study."""

    answered_by: ClassVar[type] = FoundDrop

    base: Case
    goal: DropGoal
    programmer: Programmer
    diameter: float | None
    table_mass: float | None
    note: str

    def text(self) -> str:
        """Return all that its search depends on."""
        specification = self.goal.specification
        asked = self.programmer, self.diameter, self.table_mass, self.note, specification.asked
        return f"{asked} {specification.text} {case_text(self.base)}"

    def answer(self) -> FoundDrop:
        """Return what its search finds."""
        return found_drop(self)

    @property
    def size_path(self) -> str:
        """Path of the size that is chosen."""
        return "contact.reference_force" if self.diameter is None else "contact.cushion.thickness"

    @cached_property
    def template(self) -> Case:
        """The case of the machine with the programmer, of which size and height are put in.

        Raises
        ------
        InputErrors
            If the programmer has a property that no case may have.
        """
        document = document_of(self.base)
        for table in ("fit", "published", "compare"):
            document.pop(table, None)
        slowest = document["contact"]["slowest_approach"]
        document["contact"] = self.programmer.contact_table(self.diameter, slowest)
        needed = chosen("machine.follow", followed(self.goal.limits), self.note)
        if self.base.values()["machine.follow"].si < needed.si:
            document["machine"]["follow"] = needed.document()
        step = chosen("solver.output_step", self.goal.pulse.duration / OUTPUT_STEPS, self.note)
        document["solver"]["output_step"] = step.document()
        before = (beside(self.goal.limits)[0] + ROOM) * self.goal.pulse.duration
        follow = max(self.base.values()["machine.follow"].si, needed.si)
        recorder = self.base.impact().recorder
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

    def read(self, case: Case) -> DropReading | None:
        """Run a case and return what a sensor on its table reads; None where the table is not struck.

        Raises
        ------
        InputError, IntegrationError, ValueError
            If it does not fit together, or cannot be followed.
        """
        run = run_machine(build_machine(case), case.solver.tolerance.si)
        train = blows(run)
        first = next((blow for blow in train if blow.kind != "missed"), None)
        if first is None:
            return None
        shock = shock_about(run, first.time, self.goal.limits)
        figures = peak_and_width(shock, self.goal.limits.level)
        return DropReading(shock, *figures, first, run.energy_error, run_verdict(case, run, train).text)


def found_drop(design: DropDesign) -> FoundDrop:
    """Return what a search ends at, as a full run of the rounded case shows it.

    Raises
    ------
    StrikewaveError, ValueError
        If there is nothing.
    """
    start = np.array([design.estimate.size, design.height_for(design.estimate.speed)])
    spring = design.cushion is None
    low = np.array([start[0] / SIZES if spring else THINNEST, HEIGHTS[0]])
    high = np.array([start[0] * SIZES if spring else THICKEST, HEIGHTS[1]])
    slopes = SLOPES if spring else SLOPES * np.array([[-1.0, 1.0]])
    logs = np.log(start), np.log(low), np.log(high)
    end = nearest_settings(lambda settings: _missed(design, settings), *logs, slopes)
    if isinstance(end, str):
        raise StrikewaveError(end)
    halt = ""
    if not end.close:
        size = float(np.exp(end.last[0]))
        ends = [word for word, bound in (("least", low[0]), ("largest", high[0])) if math.isclose(size, bound)]
        halt = f"the thickness stands at the {ends[0]} that is sought" if ends else end.failure
        halt = halt or f"nothing nearer was found in {end.runs} runs"
    settings = np.exp(end.nearest)
    reading = design.read(design.case_at(settings))
    if reading is None:
        raise StrikewaveError(UNTOUCHED)
    shock = reading.shock
    history = tuple(shock.values.tolist()), shock.step, shock.begin, shock.peak_index
    return FoundDrop(
        tuple(settings.tolist()), end.runs + 1, halt, *history, reading.blow, reading.energy_error, reading.verdict
    )


def drop_candidate(design: DropDesign, found: FoundDrop) -> DropCandidate:
    """Return what was found with all that it is judged by."""
    case = design.case_at(np.array(found.settings))
    shock = Shock(np.array(found.values), found.step, found.begin, found.peak_index)
    reading = DropReading(
        shock, *peak_and_width(shock, design.goal.limits.level), found.blow, found.energy_error, found.verdict
    )
    verdict = judge_shock(shock, design.goal.limits)
    limits = limits_of(case, design, reading)
    given = design.programmer, design.diameter
    return DropCandidate(
        case, 0, *given, reading, design.goal, verdict, limits, design.estimate, found.runs, found.halt
    )


def _missed(design: DropDesign, settings: Array) -> tuple[Array | None, str]:
    """Return the logarithms of peak and width over the goal, or why there are none."""
    try:
        reading = design.read(design.case_at(settings))
    except (StrikewaveError, ValueError) as error:
        return None, reason_of(error)
    if reading is None:
        return None, UNTOUCHED
    off = np.log([reading.peak / design.goal.pulse.peak, reading.width / design.goal.width])
    return (off, "") if np.all(np.isfinite(off)) else (None, "the pulse has no width at that share of its peak")


def limits_of(case: Case, design: DropDesign, reading: DropReading) -> tuple[Limit, ...]:
    """Return the values of a candidate that have a limit."""
    limits = [Limit("drop_height", float(case.values()["machine.height"].si), design.goal.stroke, "m")]
    if design.cushion is not None:
        pad = cushion_of_contact(case.impact().contact)
        limits.append(Limit("strain", reading.blow.indentation / pad.pad.thickness, largest_strain(pad), "1"))
        if pad.law == "elastomer" and "shape_factor" not in pad.properties:
            limits.append(Limit("shape_factor", pad.pad.shape_factor, LARGEST_SHAPE_FACTOR, "1"))
    limits.append(Limit("energy_error", reading.energy_error, BALANCE_LIMIT, "1"))
    return tuple(limits)


def drop_rank(candidate: DropCandidate) -> tuple[bool, bool, float, float, float]:
    """Return what candidates are ordered by.

    First those that meet the goal, an assumed law behind those with a source, by the least margin of their clauses, the
    largest first, and by the departure from the ideal pulse, both in steps of 1 %, then by height; then the others by
    how far they are: a limit that is not kept by its factor.
    """
    if candidate.meets:
        return (
            False,
            candidate.programmer.assumed,
            -round(candidate.margin, 2),
            round(candidate.departure, 2),
            candidate.height,
        )
    over = sum(limit.value / limit.limit - 1.0 for limit in candidate.broken)
    failed = sum(clause.verdict != PASS for clause in candidate.verdict.clauses)
    return (
        True,
        candidate.programmer.assumed,
        min(candidate.largest_miss, 1e6) + over + failed,
        candidate.departure,
        candidate.height,
    )
