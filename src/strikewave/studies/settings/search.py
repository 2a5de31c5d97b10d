"""Settings of one machine found by full runs: engagement, stiffness and speed by Broyden's method from closed forms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base.errors import InputError, InputErrors, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.units import in_unit
from strikewave.cases.case import FORM, Case
from strikewave.machines import MachineRun, blows, run_machine
from strikewave.specifications.judging import ShockVerdict, judge_shock
from strikewave.studies.engine.keys import case_text
from strikewave.studies.settings.broyden import nearest_settings
from strikewave.studies.settings.candidate import (
    FirstGuess,
    Limit,
    Observation,
    SettingsCandidate,
    limits_of,
    misses,
    observe_blows,
)
from strikewave.studies.settings.estimate import (
    Support,
    approach_at,
    approach_speed,
    engagement,
    feed_time,
    largest_engagement,
    passage_time,
    pulse_velocity_change,
    return_arc,
    settling_time,
    turntable_speed,
    width_stiffness,
)
from strikewave.studies.settings.goal import BlowGoal
from strikewave.studies.settings.judged_run import shock_about
from strikewave.studies.simulation import RUN_TOLERANCE

Array = NDArray[np.float64]

LEAST_SHARES, LARGEST_SHARES = (0.02, 0.02, 0.8), (math.inf, 50.0, 1.25)
"""Least and largest engagement, stiffness and speed over their first estimates. Beyond fifty times the estimated
stiffness the contact alone makes the width; a fiftieth is chosen likewise. The speed alone makes the interval, so that
it moves by little more than the droop of the controller. The engagement is bounded above by `Design.deepest`."""
STIFF_START = 10.0
"""Stiffness from which the search begins, over that of the object alone, where the other spring in series is too soft
for the width: nearly rigid beside the other one."""
AT_BOUND = 1e-6
"""Distance of a logarithm from its bound within which a setting stands there: below every step, above rounding."""
DIGITS = 4
"""Significant digits of a chosen value: rounding then changes it by less than `CLOSE`, and no part is made more
exactly."""
SLOPES = np.array([[0.5, 0.35, 1.0], [0.0, -0.35, 0.0], [0.0, 0.0, -1.0]])
"""First guess of d ln(peak, width, interval)/d ln(engagement, stiffness, speed): a half-sine on springs in series."""
VARIED = {
    "frame": ("object.frame_stiffness", "object.frame_damping"),
    "mount": ("striker.mount_stiffness", "striker.mount_damping"),
}
"""What gives the width: a stiffness, and the damper beside it, which keeps its damping ratio."""
UNITS = {
    "m": "mm", "s": "ms", "kg": "kg", "N": "N", "N/m": "kN/m", "N s/m": "N s/m", "rad/s": "rpm",
}  # fmt: skip
"""Units in which chosen values are written; others have none."""
STIFF = 1e6
"""Stiffnesses above this, N/m, are written in MN/m: those of frames and mounts; those of springs are in kN/m."""


class Trial(NamedTuple):
    """What is tried: a case, a number of strikers, their mass (kg), what brings the object back, what is varied.

    ``support`` and ``mass`` are None where the case's own are kept; ``note`` says why a value was chosen.
    """

    case: Case
    strikers: int
    support: Support | None
    mass: float | None
    vary: str
    note: str


@dataclass(frozen=True)
class FoundSettings:
    """Where a search ended: settings (engagement, stiffness, speed), runs, why before the goal; and its full run."""

    settings: tuple[float, ...]
    runs: int
    halt: str
    observation: Observation
    limits: tuple[Limit, ...]
    verdicts: tuple[ShockVerdict, ...]
    run_verdict: str = ""


@dataclass(frozen=True)
class Design:
    """A rig with a goal: its first estimates, its bounds, and the case at given settings; a `Question` of a study."""

    answered_by: ClassVar[type] = FoundSettings

    rig: Trial
    goal: BlowGoal

    def text(self) -> str:
        """Return all that its search depends on."""
        rig, goal = self.rig, self.goal
        asked = goal.interval, goal.peak, goal.width, goal.disc, goal.stop_limit
        spec = "" if goal.specification is None else f"{goal.specification.asked} {goal.specification.text}"
        return f"{asked} {spec} {rig[1:]} {case_text(rig.case)}"

    def answer(self) -> FoundSettings:
        """Return what its search finds."""
        return found_settings(self)

    @cached_property
    def start(self) -> Array:
        """First estimates of engagement (m), stiffness (N/m) and speed (rad/s)."""
        case = self.rig.case.rotary_tables()
        radius, speed = case.machine.radius.si, turntable_speed(self.rig.strikers, self.goal.interval)
        approach = approach_speed(self.velocity_change, case.contact.restitution.si)
        depth = engagement(min(approach, approach_at(self.deepest, speed, radius)), speed, radius)
        mass, other = self.object_mass, math.inf
        if self.rig.vary == "mount":
            other = case.object.frame_stiffness.si if case.object.frame_stiffness else math.inf
        stiffness = width_stiffness(self.goal.width, mass, other)
        if math.isinf(stiffness):
            stiffness = STIFF_START * width_stiffness(self.goal.width, mass)
        return np.array([depth, stiffness, speed])

    @property
    def velocity_change(self) -> float:
        """Velocity change of the pulse asked for, m/s."""
        return pulse_velocity_change(self.goal.peak, self.goal.width)

    @property
    def object_mass(self) -> float:
        """Mass of the object, kg."""
        mass = self.rig.case.rotary_tables().object.mass
        assert mass is not None
        return mass.si

    @property
    def deepest(self) -> float:
        """Largest engagement, m."""
        case = self.rig.case.rotary_tables()
        return largest_engagement(self.rig.strikers, case.machine.radius.si, case.feed.stroke.si)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and largest settings."""
        least, largest = (self.start * np.array(shares) for shares in (LEAST_SHARES, LARGEST_SHARES))
        return least, np.array([self.deepest, *largest[1:]])

    @cached_property
    def support(self) -> Support:
        """What brings the object back."""
        table = self.rig.case.rotary_tables().object
        return self.rig.support or Support(table.spring.si, table.preload.si, table.damper.si)

    def estimates(self) -> FirstGuess:
        """Return the closed forms that the search begins with; SI."""
        table = self.rig.case.rotary_tables().object
        weight = self.object_mass * table.gravity.si
        depth, stiffness, speed = (float(x) for x in self.start)
        arc = return_arc(self.support, self.object_mass, self.velocity_change, weight)
        settled = settling_time(self.support, self.object_mass, self.velocity_change, table.stop_restitution.si, weight)
        return FirstGuess(
            velocity_change=self.velocity_change,
            approach=approach_speed(self.velocity_change, self.rig.case.rotary_tables().contact.restitution.si),
            engagement=depth,
            stiffness=stiffness,
            turntable_speed=speed,
            passage_time=passage_time(depth, speed, self.rig.case.rotary_tables().machine.radius.si),
            return_time=arc.time,
            largest_displacement=arc.largest_displacement,
            settling_time=settled,
        )

    def changes(self, settings: Array) -> dict[str, Value]:
        """Return the values of the case at settings: engagement, stiffness, speed."""
        depth, stiffness, speed = (float(x) for x in settings)
        values = self.rig.case.values()
        spring, damper = VARIED[self.rig.vary]
        numbers: dict[str, float] = {
            "machine.speed": speed,
            "machine.strikers": self.rig.strikers,
            "machine.engagement": depth,
            spring: stiffness,
            damper: values[damper].si * math.sqrt(stiffness / values[spring].si),
        }
        if self.rig.mass is not None:
            numbers["striker.mass"] = self.rig.mass
        if self.rig.support is not None:
            numbers |= {f"object.{name}": value for name, value in self.rig.support._asdict().items()}
        numbers |= self._feed_times(depth)
        return {path: chosen(path, value, self.rig.note) for path, value in numbers.items()}

    def _feed_times(self, depth: float) -> dict[str, float]:
        """Return the times of the feed that are too long to clear the strikers before and after the blows."""
        feed, period = self.rig.case.rotary_tables().feed, self.goal.interval
        longest = {
            "stroke_time": feed_time(feed.arrival.si * period, depth, feed.stroke.si),
            "retract_time": feed_time(period - feed.release_delay.si, depth, feed.stroke.si),
        }
        return {f"feed.{name}": time for name, time in longest.items() if time < getattr(feed, name).si}

    def case_at(self, settings: Array) -> Case:
        """Return the case at settings: engagement, stiffness, speed."""
        return self.rig.case.with_values(self.changes(settings))

    def run(self, settings: Array, tolerance: float) -> tuple[MachineRun, Observation | None]:
        """Run the machine at settings.

        Raises
        ------
        InputError, IntegrationError, ValueError
            If it does not fit together, or cannot be followed.
        """
        run = run_machine(build_machine(self.case_at(settings)), tolerance)
        return run, observe_blows(run, blows(run), self.goal)


def chosen(path: str, value: float, note: str) -> Value:
    """Return a value of a case that was chosen here, rounded to `DIGITS`.

    Raises
    ------
    InputError
        If a case may not have it.

    Examples
    --------
    >>> chosen("machine.engagement", 0.00512345678, "by hand").typed
    '5.123 mm'
    """
    allowed = FORM.range_at(path.split("."))
    assert allowed is not None
    unit = "MN/m" if allowed.unit == "N/m" and value >= STIFF else UNITS.get(allowed.unit, "")
    number = float(f"{in_unit(value, allowed.unit, unit):.{DIGITS}g}") if unit else value
    typed = f"{number:.10g} {unit}" if unit else round(value) if allowed.unit == "count" else value
    try:
        return allowed.read({"value": typed, "provenance": "assumed", "note": note})
    except InputError as error:
        raise error.at(path) from None


class SearchEnd(NamedTuple):
    """Where a search ended: settings, runs, and why it ended before the goal; empty where it came `CLOSE`."""

    settings: Array
    runs: int
    halt: str


def search(design: Design) -> SearchEnd | str:
    """Return the settings that meet a goal most nearly, from the closed forms on, or why no run could be made."""
    low, high = (np.log(bound) for bound in design.bounds)
    end = nearest_settings(lambda settings: _missed(design, settings), np.log(design.start), low, high, SLOPES)
    if isinstance(end, str):
        return end
    if end.close:
        return SearchEnd(np.exp(end.nearest), end.runs, "")
    halt = _at_bound(end.nearest, low, high, design) or _at_bound(end.last, low, high, design) or end.failure
    return SearchEnd(np.exp(end.nearest), end.runs, halt or f"nothing nearer was found in {end.runs} runs")


def _missed(design: Design, settings: Array) -> tuple[Array | None, str]:
    """Return the logarithms of peak, width and interval over the goal, or why there are none."""
    try:
        _, observation = design.run(settings, RUN_TOLERANCE)
    except (StrikewaveError, ValueError) as error:
        return None, reason_of(error)
    if observation is None:
        return None, "no striker touches the object"
    missed = np.log1p(list(misses(observation).values()))
    return (missed, "") if np.all(np.isfinite(missed)) else (None, "a pulse has no width at 10 % of its peak")


def _at_bound(x: Array, low: Array, high: Array, design: Design) -> str:
    """Return which setting stands at its bound; empty where none does."""
    if x[0] > high[0] - AT_BOUND:
        return f"the engagement is the largest that strikers and stroke allow, {design.deepest * 1e3:.4g} mm"
    if x[1] > high[1] - AT_BOUND:
        return f"the {design.rig.vary} cannot be stiff enough: mount, frame and contact bend besides"
    return f"the {design.rig.vary} cannot be soft enough" if x[1] < low[1] + AT_BOUND else ""


def reason_of(error: Exception) -> str:
    """Return an error in one short line."""
    return error.lines[0] if isinstance(error, InputErrors) else str(error)


def found_settings(design: Design) -> FoundSettings:
    """Return the setting that a search ends at, as a full run shows it.

    The run has the case's own tolerance and the rounded values, as the case file will hold them.

    Raises
    ------
    StrikewaveError, ValueError
        If there is none.
    """
    end = search(design)
    if isinstance(end, str):
        raise StrikewaveError(end)
    case = design.case_at(end.settings)
    run, observation = design.run(end.settings, case.solver.tolerance.si)
    if observation is None:
        raise StrikewaveError("no striker touches the object")
    limits = limits_of(case, run, observation, design.goal)
    settings, judged = tuple(float(x) for x in end.settings), judged_blows(run, design.goal)
    verdict = run_verdict(case, run, blows(run)).text
    return FoundSettings(settings, end.runs + 1, end.halt, observation, limits, judged, verdict)


def settings_candidate(design: Design, found: FoundSettings) -> SettingsCandidate:
    """Return what was found with all that it is judged by."""
    settings = np.array(found.settings)
    paths = tuple(design.changes(settings))
    known = design.case_at(settings), paths, 0, found.observation, design.goal, found.limits, design.estimates()
    return SettingsCandidate(*known, found.runs, found.halt, found.verdicts, found.run_verdict)


def judged_blows(run: MachineRun, goal: BlowGoal) -> tuple[ShockVerdict, ...]:
    """Return the verdict of the specification of a goal on each blow that struck; nothing without one."""
    if goal.specification is None:
        return ()
    limits = goal.specification.pulse_limits()
    struck = [blow for blow in blows(run) if blow.kind != "missed"]
    return tuple(judge_shock(shock_about(run, blow.time, limits), limits) for blow in struck)
