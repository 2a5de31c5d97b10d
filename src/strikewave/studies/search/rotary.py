"""Settings of the rotary machine that give blows of a wanted peak and width at a wanted interval.

Closed forms (`rotary_estimates`) give the start, full runs of all blows (`machine`) correct engagement, stiffness and
speed, and a full run judges every candidate (`rotary_candidate`).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.compiling import compiling_shown
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import FORCE, PULSE_WIDTH, RATIO
from strikewave.base.texts import percent, plain
from strikewave.base.units import si_value
from strikewave.cases.case import Case, load_case
from strikewave.cases.contact_of_case import face_contact
from strikewave.contact.law import indentation_under
from strikewave.machines import Blow, MachineRun, blows, run_machine
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import columns_of
from strikewave.signal.pulse import HALF_SINE_WIDTH
from strikewave.specifications.judging import ShockVerdict, judge_shock
from strikewave.specifications.reading import Specification
from strikewave.studies.engine.evaluation import case_text
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance, Workers, as_workers, share_reporter
from strikewave.studies.engine.store import RunStore, given_or_temporary, store_in
from strikewave.studies.search import DISC, REFERENCE, STIFFNESS
from strikewave.studies.search.machine import (
    PEAK,
    MachineSearch,
    SearchEnd,
    chosen,
    ranked,
    refuse_changes,
    search_end,
    shock_about,
    tried_designs,
)
from strikewave.studies.search.rotary_candidate import (
    INTERVAL,
    WITHIN,
    BlowGoal,
    FirstGuess,
    Limit,
    Observation,
    SettingsCandidate,
    blow_goal,
    limits_of,
    observe_blows,
)
from strikewave.studies.search.rotary_estimates import (
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
    support_for,
    turntable_speed,
    width_stiffness,
)
from strikewave.studies.simulation import RUN_TOLERANCE

Array = NDArray[np.float64]

LEAST_SHARES, LARGEST_SHARES = (0.02, 0.02, 0.8), (math.inf, 50.0, 1.25)
"""Least and largest engagement, stiffness and speed over their first estimates. Beyond fifty times the estimated
stiffness the contact alone sets the width; a fiftieth is chosen likewise. The speed alone sets the interval, and moves
by little more than the droop of the controller. `RotaryDesign.deepest` bounds the engagement above."""
STIFF_START = 10.0
"""First stiffness, over that of the object alone, where the other spring in series is too soft for the width: nearly
rigid beside it."""
AT_BOUND = 1e-6
"""Distance of a logarithm from its bound at which a setting counts as there: below every step, above rounding."""
SLOPES = np.array([[0.5, 0.35, 1.0], [0.0, -0.35, 0.0], [0.0, 0.0, -1.0]])
"""First guess of d ln(peak, width, interval)/d ln(engagement, stiffness, speed): a half-sine on springs in series."""
VARIED = {
    "frame": ("object.frame_stiffness", "object.frame_damping"),
    "mount": ("striker.mount_stiffness", "striker.mount_damping"),
}
"""Settings that give the width: a stiffness, and its damper, which keeps the damping ratio."""
STRIKERS = (1, 2, 3, 4, 6, 8, 12)
"""Numbers of strikers tried by default, besides that of the case: each a third to twice more than the one before, since
the speed goes with the inverse."""
MASS_SHARES = (0.5, 2.0)
"""Masses of a striker, over that of the case, tried on the best support: a factor of two shows which way to go."""
RETURN_SHARE = (0.12, 0.55)
"""Least and largest time of the object's return, over the interval. Bounces on the stop need the rest: settings of
li-ma-2019 that meet a goal settle in 0.2 to 1.0 of the interval (measured)."""
PASSED = 1.3
"""Least time of return over the first estimate of the passage of a nose, which is too short: the engagement grows by up
to 1.6 in the search (measured), and the passage with its root."""
WIDTHS = 10.0  # least time of return over the width of the pulse: an object that returns sooner takes part in the pulse
PRELOADS, DAMPINGS, TIMES = (0.3, 1.0), (0.2, 0.4, 0.7), 3
"""Series of supports: preload ratios, damping ratios (see `support_for`), number of return times. Chosen: from a weak
to a strong preload and from light to nearly critical damping, in steps that differ clearly."""
SUPPORTS = 6
"""Supports of the series, those that settle soonest, that are run for each number of strikers: a third of them, for a
run takes about 0.8 s (measured, li-ma-2019)."""
SUPPORT_DIGITS = 3  # significant digits of spring, preload and damper: no spring is made more exactly
PRESSED = 0.5
"""Largest compression of the stop by the preload, over the largest displacement: beyond it the object sits on its stop
more than it flies, and the closed forms of a rigid stop do not hold."""
MOST_STRIKERS = 100  # most strikers: the limit of ``machine.strikers`` in a case
SHORTEST = 10.0  # least interval over the width of the pulse: a sooner blow runs into the pulse before
LEAST_SHARE = 0.9
"""Share of the width of a half-sine on the contact alone below which a width is refused: no pulse is a half-sine to a
tenth. Full runs with a nearly rigid frame stand above it by less than a third."""
MOST_CANDIDATES = 500
"""Most combinations of strikers, masses and supports: at 0.8 s each (measured, li-ma-2019) they take seven minutes."""
SOURCES = ("li-ma-2019", "timoshenko-goodier-1970", "schwager-poschel-2007")
"""Keys of the sources: of the machine, the stress of the disc, the time on the stop."""


@dataclass(frozen=True)
class SettingsChoices:
    """Settings that `strikewave.settings` may choose, and the material assumed for the turntable.

    Attributes
    ----------
    strikers : sequence of int
        Numbers of strikers to try; empty for several about that of the case.
    masses : sequence of str or float
        Masses of one striker to try; empty for half, once and twice that of the case.
    vary : str
        Stiffness that sets the pulse width: of the ``frame``, or of the striker's ``mount``.
    disc : str
        Material assumed for the turntable.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.SettingsChoices(strikers=[4], masses=["0.2 kg"]).in_kg
    (0.2,)
    """

    strikers: Sequence[int] = ()
    masses: Sequence[str | float] = ()
    vary: str = STIFFNESS
    disc: str = DISC

    @property
    def in_kg(self) -> tuple[float, ...]:
        """Masses of one striker to try, kg."""
        return tuple(si_value(mass, "kg", "masses") for mass in self.masses)

    def asked(self, case: Case, goal: BlowGoal) -> str:
        """Return all that is asked, but for the case, as a text."""
        limits: tuple[object, ...] = (goal.interval, goal.peak, goal.width, goal.disc.name, goal.stop_limit)
        limits += () if goal.specification is None else (goal.specification.asked, goal.specification.text)
        return f"{limits} {(tuple(self.strikers), self.in_kg, self.vary)}"


@dataclass(frozen=True)
class JudgedBlows:
    """Stored outcome of a full run: measures of its blows, limits, and verdicts on blows and run."""

    observation: Observation
    limits: tuple[Limit, ...]
    verdicts: tuple[ShockVerdict, ...]
    run_verdict: str


@dataclass(frozen=True)
class RotaryDesign:
    """A combination that is tried for a goal: first estimates, bounds, and the case at its settings.

    Settings are engagement (m), stiffness (N/m) and speed (rad/s). ``support`` of the object and ``mass`` of a striker
    (kg) are None for those of the case; ``note`` says why a value was chosen.
    """

    answered_by: ClassVar[Any] = tuple[SearchEnd, JudgedBlows]

    case: Case
    goal: BlowGoal
    strikers: int
    support: Support | None = None
    mass: float | None = None
    vary: str = STIFFNESS
    note: str = ""

    def text(self) -> str:
        """Return a text of all values that its search depends on."""
        goal, spec = self.goal, self.goal.specification
        asked = goal.interval, goal.peak, goal.width, goal.disc, goal.stop_limit
        judged = "" if spec is None else f"{spec.asked} {spec.text}"
        tried = self.strikers, self.support, self.mass, self.vary, self.note
        return f"{asked} {judged} {tried} {case_text(self.case)}"

    @property
    def called(self) -> str:
        """Name in a sentence on a failure."""
        return f"{self.strikers} strikers"

    @cached_property
    def start(self) -> Array:
        """First estimates of engagement (m), stiffness (N/m) and speed (rad/s)."""
        case = self.case.rotary_tables()
        radius, speed = case.machine.radius.si, turntable_speed(self.strikers, self.goal.interval)
        approach = approach_speed(self.velocity_change, case.contact.restitution.si)
        depth = engagement(min(approach, approach_at(self.deepest, speed, radius)), speed, radius)
        mass, other = self.object_mass, math.inf
        if self.vary == "mount":
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
        mass = self.case.rotary_tables().object.mass
        assert mass is not None
        return mass.si

    @property
    def deepest(self) -> float:
        """Largest engagement, m."""
        case = self.case.rotary_tables()
        return largest_engagement(self.strikers, case.machine.radius.si, case.feed.stroke.si)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and largest settings."""
        least, largest = (self.start * np.array(shares) for shares in (LEAST_SHARES, LARGEST_SHARES))
        return least, np.array([self.deepest, *largest[1:]])

    @cached_property
    def support_there(self) -> Support:
        """Support that returns the object: spring, preload and damper."""
        table = self.case.rotary_tables().object
        return self.support or Support(table.spring.si, table.preload.si, table.damper.si)

    def estimates(self) -> FirstGuess:
        """Return the closed forms that the search begins with; SI."""
        table = self.case.rotary_tables().object
        weight = self.object_mass * table.gravity.si
        depth, stiffness, speed = (float(x) for x in self.start)
        arc = return_arc(self.support_there, self.object_mass, self.velocity_change, weight)
        settled = settling_time(
            self.support_there, self.object_mass, self.velocity_change, table.stop_restitution.si, weight
        )
        return FirstGuess(
            velocity_change=self.velocity_change,
            approach=approach_speed(self.velocity_change, self.case.rotary_tables().contact.restitution.si),
            engagement=depth,
            stiffness=stiffness,
            turntable_speed=speed,
            passage_time=passage_time(depth, speed, self.case.rotary_tables().machine.radius.si),
            return_time=arc.time,
            largest_displacement=arc.largest_displacement,
            settling_time=settled,
        )

    def changes(self, settings: Array) -> dict[str, Value]:
        """Return the values of the case at settings: engagement, stiffness, speed."""
        depth, stiffness, speed = (float(x) for x in settings)
        values = self.case.values()
        spring, damper = VARIED[self.vary]
        numbers: dict[str, float] = {
            "machine.speed": speed,
            "machine.strikers": self.strikers,
            "machine.engagement": depth,
            spring: stiffness,
            damper: values[damper].si * math.sqrt(stiffness / values[spring].si),
        }
        if self.mass is not None:
            numbers["striker.mass"] = self.mass
        if self.support is not None:
            numbers |= {f"object.{name}": value for name, value in self.support._asdict().items()}
        # the feed of the case stays where it clears the strikers before and after the blows in time
        feed, period = self.case.rotary_tables().feed, self.goal.interval
        for name, clear in (
            ("stroke_time", feed.arrival.si * period),
            ("retract_time", period - feed.release_delay.si),
        ):
            longest = feed_time(clear, depth, feed.stroke.si)
            if longest < getattr(feed, name).si:
                numbers[f"feed.{name}"] = longest
        return {path: chosen(path, value, self.note) for path, value in numbers.items()}

    def case_at(self, settings: Array) -> Case:
        """Return the case at settings."""
        return self.case.with_values(self.changes(settings))

    def run(self, case: Case, tolerance: float) -> tuple[MachineRun, Sequence[Blow], Observation]:
        """Return the run of a case, its blows, and their measures; a run without a blow is an error."""
        run = run_machine(build_machine(case), tolerance)
        train = blows(run)
        observation = observe_blows(run, train, self.goal)
        if observation is None:
            raise StrikewaveError("no striker touches the object")
        return run, train, observation

    def off(self, settings: Array) -> Array:
        """Return the logarithms of peak, width and interval over the goal."""
        _, _, observation = self.run(self.case_at(settings), RUN_TOLERANCE)
        return np.log1p(list(observation.misses.values()))

    def at_bound(self, logs: Array, low: Array, high: Array) -> str:
        """Return the sentence on a setting at its bound; empty for none."""
        if logs[0] > high[0] - AT_BOUND:
            return f"the engagement is the largest that strikers and stroke allow, {self.deepest * 1e3:.4g} mm"
        if logs[1] > high[1] - AT_BOUND:
            return f"the {self.vary} cannot be stiff enough: mount, frame and contact bend besides"
        return f"the {self.vary} cannot be soft enough" if logs[1] < low[1] + AT_BOUND else ""

    def answer(self) -> tuple[SearchEnd, JudgedBlows]:
        """Return the end of its search, and the outcome of the full run there."""
        end = search_end(self.off, self.start, self.bounds, SLOPES, self.at_bound)
        case = self.case_at(np.array(end.settings))
        run, train, observation = self.run(case, case.solver.tolerance.si)
        verdict = run_verdict(case, run, train).text
        limits, specification = limits_of(case, run, observation, self.goal), self.goal.specification
        if specification is None:
            return end, JudgedBlows(observation, limits, (), verdict)
        asked = specification.pulse_limits()
        struck = [blow.time for blow in train if blow.kind != "missed"]
        judged = tuple(judge_shock(shock_about(run, touch, asked), asked) for touch in struck)
        return end, JudgedBlows(observation, limits, judged, verdict)

    def candidate(self, answer: tuple[SearchEnd, JudgedBlows]) -> SettingsCandidate:
        """Return the candidate of an answer."""
        end, found = answer
        settings = np.array(end.settings)
        return SettingsCandidate(
            case=self.case_at(settings),
            place=0,
            goal=self.goal,
            limits=found.limits,
            runs=end.runs,
            halt=end.halt,
            run_verdict=found.run_verdict,
            chosen=tuple(self.changes(settings)),
            observation=found.observation,
            estimate=self.estimates(),
            verdicts=found.verdicts,
        )


def sensible_strikers(
    case: Case, goal: BlowGoal, choice: SettingsChoices
) -> tuple[list[int], tuple[StrikersLeftOut, ...]]:
    """Return the numbers of strikers to run, and the reason why each other number is left out."""
    rig = case.rotary_tables()
    wanted = choice.strikers or tuple(sorted({*STRIKERS, int(rig.machine.strikers.si)}))
    radius, stroke = rig.machine.radius.si, rig.feed.stroke.si
    change = pulse_velocity_change(goal.peak, goal.width)
    last = max((int(row.number.si) for row in rig.striker.each), default=0)
    reached, sensible, left_out = 0.0, [], {}
    for number in dict.fromkeys(wanted):
        if number < last:
            left_out[number] = f"the case has a row for striker {last}"
            continue
        speed = turntable_speed(number, goal.interval)
        deepest = largest_engagement(number, radius, stroke)
        reach = approach_at(deepest, speed, radius)
        reached = max(reached, reach)
        if 2.0 * reach < change:
            left_out[number] = (
                f"engaged by the {plain(deepest * 1e3)} mm that strikers and stroke allow, the noses come at "
                f"{plain(reach)} m/s; even a blow without loss takes {plain(0.5 * change)} m/s"
            )
            continue
        passing = passage_time(engagement(0.5 * change, speed, radius), speed, radius)
        if passing > RETURN_SHARE[1] * goal.interval:
            left_out[number] = (
                f"a nose is in the way for {plain(passing * 1e3)} ms of the {plain(goal.interval * 1e3, 4)} ms"
            )
            continue
        sensible.append(number)
    if not sensible and 2.0 * reached < change:
        largest = goal.peak * 2.0 * reached / change / STANDARD_GRAVITY
        allowed = (
            f"at most {plain(largest, 4)} g with this width, interval and radius, where the noses come at "
            f"{plain(reached)} m/s and nothing is lost"
        )
        hint = "a larger machine.radius or feed.stroke (--set), other --strikers, a shorter width or interval help"
        raise InputError("--peak", f"{plain(goal.peak / STANDARD_GRAVITY, 4)} g", allowed, hint)
    if not sensible:
        why = "; ".join(f"{number} strikers: {reason}" for number, reason in left_out.items())
        allowed = "a number that leaves the object time to return"
        raise InputError("--strikers", ", ".join(map(str, left_out)), allowed, why)
    return sensible, tuple(StrikersLeftOut(number, why) for number, why in left_out.items())


def supports(case: Case, goal: BlowGoal, strikers: int) -> list[Support | None]:
    """Return the supports to try: that of the case (None), and those of the series that settle soonest.

    The first arc takes between the passage of a nose and about half the interval. Supports that let the object move
    beyond the stroke, or press the stop by more than `PRESSED` of its largest displacement, come last.
    """
    rig = case.rotary_tables()
    assert rig.object.mass is not None
    mass, change = rig.object.mass.si, pulse_velocity_change(goal.peak, goal.width)
    weight, restitution = mass * rig.object.gravity.si, rig.object.stop_restitution.si
    radius, speed = rig.machine.radius.si, turntable_speed(strikers, goal.interval)
    passing = passage_time(float(RotaryDesign(case, goal, strikers).start[0]), speed, radius)
    longest = RETURN_SHARE[1] * goal.interval
    shortest = min(max(PASSED * passing, RETURN_SHARE[0] * goal.interval, WIDTHS * goal.width), longest)
    order: dict[Support, tuple[bool, float]] = {}
    for time in np.geomspace(shortest, longest, TIMES):
        for preload in PRELOADS:
            for damping in DAMPINGS:
                exact = support_for(float(time), mass, change, preload, damping, weight)
                support = Support(*(float(f"{value:.{SUPPORT_DIGITS}g}") for value in exact))
                arc = return_arc(support, mass, change, weight)
                pressed = support.preload / rig.object.stop_stiffness.si
                fits = arc.largest_displacement < rig.feed.stroke.si and pressed < PRESSED * arc.largest_displacement
                order[support] = not fits, settling_time(support, mass, change, restitution, weight)
    return [None, *sorted(order, key=order.__getitem__)[:SUPPORTS]]


def is_rotary(case: Case) -> bool:
    """Tell whether a case has a rotary machine, or no machine of another kind."""
    return getattr(case.machine, "kind", "rotary") == "rotary"


def check_goal(case: Case, goal: BlowGoal, choice: SettingsChoices) -> None:
    """Refuse a goal that no setting can give, before anything is run."""
    if case.machine is None or case.stack.layer or not is_rotary(case):
        allowed = "a machine case whose object is a nose on a frame, such as li-ma-2019"
        raise InputError("--from", case.name, allowed, "a stack of layers has no frame stiffness to choose")
    angle = getattr(case.machine, "blow_angle", None)
    if angle is not None and angle.si != 0.0:
        allowed = "0: noses that strike as a cam"
        raise InputError("machine.blow_angle", angle.typed, allowed, "remove it, or the first estimates do not hold")

    for field, value in (("--interval", goal.interval), ("--peak", goal.peak), ("--width", goal.width)):
        if not 0.0 < value < math.inf:
            raise InputError(field, value, "above zero")
    if goal.width * SHORTEST > goal.interval:
        allowed = f"at most {plain(goal.interval / SHORTEST * 1e6, 4)} us, a tenth of the interval"
        raise InputError("--width", f"{plain(goal.width * 1e6, 4)} us", allowed, "longer pulses run into the next blow")

    odd = [number for number in choice.strikers if not 1 <= number <= MOST_STRIKERS]
    if odd:
        raise InputError("--strikers", odd[0], f"a whole number from 1 to {MOST_STRIKERS}")
    rig = case.rotary_tables()
    rows = {int(row.number.si): row for row in rig.striker.each}
    last = max(rows, default=0)
    if choice.strikers and min(choice.strikers) < last:
        allowed = f"at most {min(choice.strikers)}, as --strikers asks"
        raise InputError(f"striker.each.{last}.number", last, allowed, "remove its row, or ask for more strikers")
    own = [number for number, row in rows.items() if row.mass is not None]
    if choice.masses and own:
        allowed = f"none: striker {own[0]} has a mass of its own"
        raise InputError("--striker-mass", f"{choice.in_kg[0]:g} kg", allowed, "remove the masses of [[striker.each]]")

    feed = rig.feed
    if feed.release_delay.si >= goal.interval:
        typed = f"{plain(goal.interval * 1e3, 4)} ms"
        allowed = f"less than the interval, {typed}: the next striker comes before the object leaves"
        raise InputError("feed.release_delay", feed.release_delay.typed, allowed, "shorten it by --set")
    if feed.arrival.si == 0.0:
        raise InputError("feed.arrival", feed.arrival.typed, "above 0: the object comes between two strikers")

    if choice.vary not in VARIED:
        raise InputError("--vary", choice.vary, " or ".join(VARIED))
    if goal.disc.yield_strength is None or goal.disc.kind != "metal":
        raise InputError("--disc", goal.disc.name, "a metal with a yield strength", "see `strikewave materials`")
    count = len(choice.strikers) * max(len(choice.masses), 1) * (SUPPORTS + 1)
    if count > MOST_CANDIDATES:
        raise InputError("--strikers", f"{count} settings to try", f"at most {MOST_CANDIDATES}", "ask for fewer")
    least = least_width(case, goal, choice)
    if goal.width < least:
        allowed = f"at least about {plain(least * 1e6)} us at this peak: object and striker are no stiffer"
        hint = "a lighter striker or a stiffer contact helps" + ("" if choice.vary == "frame" else ", or --vary frame")
        raise InputError("--width", f"{plain(goal.width * 1e6, 4)} us", allowed, hint)


def least_width(case: Case, goal: BlowGoal, choice: SettingsChoices) -> float:
    """Return a width that no setting goes below, s: `LEAST_SHARE` times 0.9362 pi sqrt(M/k) for a free striker.

    1/M = 1/m + 1/m_s of object and lightest striker; k is the contact's force over its indentation at the peak, with
    the frame in series where that is not chosen: mount and drive only make a pulse longer. 0 where a striker has a nose
    of its own.

    Source: docs/settings.md.
    """
    rig = case.rotary_tables()
    assert rig.object.mass is not None
    if any(row.nose_radius or row.contact_length for row in rig.striker.each):
        return 0.0
    mass, own = rig.object.mass.si, [row.mass.si for row in rig.striker.each if row.mass is not None]
    lightest = min([*choice.in_kg, *own], default=min(MASS_SHARES) * rig.striker.mass.si)
    force = mass * goal.peak
    contact = face_contact(rig.striker, rig.contact, material(rig.object.material))
    compliance = indentation_under(contact, force) / force
    if choice.vary == "mount" and rig.object.frame_stiffness is not None:
        compliance += 1.0 / rig.object.frame_stiffness.si
    reduced = mass * lightest / (mass + lightest)
    return LEAST_SHARE * math.pi * HALF_SINE_WIDTH * math.sqrt(reduced * compliance)


def check_changes(changes: Sequence[str], vary: str) -> None:
    """Refuse a change (``path=value``) of a field that the search chooses."""
    chosen_here = {
        "machine.speed": (", with the strikers by --interval", "leave it out, or ask for another --interval"),
        "machine.engagement": (", by --peak", "leave it out, or ask for another --peak"),
        "machine.strikers": (", from those that are tried", "give --strikers"),
        "striker.mass": (", from those that are tried", "give --striker-mass"),
        VARIED[vary][0]: (", by --width", "leave it out, ask for another --width, or --vary the other stiffness"),
    }
    refuse_changes(changes, chosen_here)


@declare.dataclass
class SettingsGoal:
    """Wanted blows."""

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
class SettingsStudy(MachineSearch):
    """Ranked settings of the rotary machine for blows; see `MachineSearch`."""

    command: ClassVar[str] = "settings"
    drawing: ClassVar[str] = "settings_report"
    noun: ClassVar[str] = "setting"

    goal: BlowGoal
    choice: SettingsChoices

    @declare.computed(declare.word("how many meet the goal", headline="settings that meet the goal", in_document=False))
    def met_count(self) -> str:
        """Number of settings that meet the goal, of all."""
        return f"{self.meeting} of {len(self.candidates)}"

    @declare.computed(declare.part(SettingsGoal, "what the blows shall be", key="goal"))
    def wanted(self) -> SettingsGoal:
        """Wanted blows, and the stiffness that may be chosen."""
        goal = self.goal
        wanted = goal.interval, goal.peak, goal.width, goal.stop_limit
        return SettingsGoal(*wanted, WITHIN, goal.disc.name, self.choice.vary)

    specification = declare.computed(
        declare.part(Specification, "what the blows are judged by", key="spec", optional=True)
    )(lambda study: study.goal.specification)
    typical = declare.computed(declare.word("what typical and variation mean, in words"))(
        lambda study: "median of the later full blows; variation: standard deviation (n - 1) over mean of all"
    )
    sources = declare.computed(declare.word("sources of the models"))(
        lambda study: [citation(key) for key in study.citations]
    )

    @declare.computed(declare.part(SettingsCandidate, "the first that meets the goal; null where none does"))
    def best(self) -> SettingsCandidate | None:
        """First of the ranking if it meets the goal."""
        return None if self.broken else self.candidates[0]

    candidates: tuple[SettingsCandidate, ...] = declare.rows(
        SettingsCandidate, "the settings, the best first", headline="first"
    )
    left_out: tuple[StrikersLeftOut, ...] = declare.rows(
        StrikersLeftOut, "numbers of strikers that were not run, and why", default=()
    )
    failed: tuple[str, ...] = declare.word("why settings gave no result")

    @property
    def masses(self) -> list[SettingsCandidate]:
        """The first candidate, and those that differ from it in the strikers' mass alone, lightest first."""
        kept = [(one.strikers, one.spring, one.preload, one.damper) for one in self.candidates]
        alike = [candidate for candidate, rest in zip(self.candidates, kept, strict=True) if rest == kept[0]]
        return sorted(alike, key=lambda candidate: candidate.mass or 0.0)

    @property
    def goal_words(self) -> str:
        """The goal with its tolerance, in words."""
        near = f"each within {percent(WITHIN, 0)}"
        return f"{self.goal.printed}, {near}, with all blows full and all limits kept"

    def candidate_columns(self, rows: Sequence[SettingsCandidate], table: str = "ranking") -> list[Column]:
        """Return the columns of candidates, or of the table "mass", without the stiffness that was not varied."""
        columns = columns_of(SettingsCandidate, rows, table)
        return [column for column in columns if column.name not in set(VARIED) - {self.choice.vary}]


def design_settings(
    case: Case,
    goal: BlowGoal,
    choice: SettingsChoices | None = None,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> SettingsStudy:
    """Return settings of a machine for blows of a peak and a width at an interval, ranked; see `settings`."""
    choice = choice or SettingsChoices()
    check_goal(case, goal, choice)
    numbers, left_out = sensible_strikers(case, goal, choice)
    note = f"chosen by strikewave settings for {goal.words}"
    masses: tuple[float | None, ...] = choice.in_kg or (None,)
    first = [
        RotaryDesign(case, goal, number, support, mass, choice.vary, note)
        for number in numbers
        for mass in masses
        for support in supports(case, goal, number)
    ]
    own = any(row.mass is not None for row in case.rotary_tables().striker.each)
    heavier = 0 if choice.masses or own else len(MASS_SHARES) * len(numbers)
    with given_or_temporary(store) as kept, pool or ProcessPool(1) as open_pool:
        tried = tried_designs(first, kept, open_pool, _of_all(advance, 0, len(first) + heavier))
        if heavier:
            # on the best support alone: every support would take `SUPPORTS` times the runs
            ends = [
                (end.rank, design)
                for design, end in tried
                if isinstance(design, RotaryDesign) and isinstance(end, SettingsCandidate)
            ]
            others = []
            for number in numbers:
                own_ends = [pair for pair in ends if pair[1].strikers == number]
                if own_ends:
                    _, best = min(own_ends, key=lambda pair: pair[0])
                    mass = case.rotary_tables().striker.mass.si
                    others += [dataclasses.replace(best, mass=share * mass) for share in MASS_SHARES]
            tried += tried_designs(others, kept, open_pool, _of_all(advance, len(first), len(first) + heavier))
    candidates, failed, verdicts = ranked(tried)
    study = SettingsStudy(
        case, goal, choice, candidates, failed, left_out=left_out, citations=SOURCES, verdicts=verdicts
    )
    return dataclasses.replace(study, notices=(*_notices(study), *verdicts.notices()))


def _of_all(advance: Advance | None, before: int, whole: int) -> Advance | None:
    """Return a report of progress over all searches, for a part that begins after some of them."""
    if advance is None:
        return None
    return lambda now: advance(now._replace(total=whole, done=before + now.done))


def _notices(study: SettingsStudy) -> Iterator[Notice]:
    """Yield the warnings on the first candidate: limits that do not decide, and a goal that is not met."""
    for limit in study.candidates[0].limits:
        if not limit.decides and not limit.kept:
            message = (
                f"the contact yields below its surface (von Mises) beyond {plain(limit.limit / 1e3)} kN and is loaded "
                f"with {plain(limit.value / 1e3)} kN: give contact.yield_pressure by --set, or trust peak and width, "
                "which depend on frame and mount, more than the contact force"
            )
            yield Notice("contact-yield", message, limit.value, limit.limit)
    yield from study.not_met()


@compiling_shown()
def settings(
    interval: str | float | None = None,
    peak: str | float | None = None,
    width: str | float | None = None,
    case: Case | None = None,
    *,
    spec: str | None = None,
    choices: SettingsChoices | None = None,
    stop_limit: str | float | None = None,
    workers: int | Workers | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> SettingsStudy:
    """Find settings of the rotary machine for blows of a wanted peak and width at a wanted interval.

    Every candidate is checked by a full run of all its blows, about a second each.

    Parameters
    ----------
    interval, peak, width : str or float
        Goals of the blows: with a unit, such as ``"20 ms"``, or in SI. The width is that at 10 % of the peak.
        Peak and width are left out with ``spec``.
    case : Case, optional
        Gives what is not chosen: geometry, materials, stop; li-ma-2019 by default.
    spec : str, optional
        Specification of a half-sine, which has peak and width and judges every blow.
    choices : SettingsChoices, optional
        Settings that may be chosen, and the material assumed for the turntable.
    stop_limit : str or float, optional
        Largest allowed force of the object's stop; no limit by default.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``; threads of this
        process where it is left out.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    SettingsStudy
        Candidates, the best first, each with its full run.

    Raises
    ------
    InputError
        If no setting can give it, or none could be run: with the reasons.

    Examples
    --------
    >>> import strikewave
    >>> study = strikewave.settings("20 ms", "4000 g", "200 us")  # doctest: +SKIP
    >>> study.best.case.machine.speed.typed  # doctest: +SKIP
    '625.6 rpm'
    >>> strikewave.settings("20 ms", "4000 g", "5 ms")
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: --width: got "5000 us"; allowed: at most 2000 us, a tenth of the interval; \
longer pulses run into the next blow
    """
    choice = choices or SettingsChoices()
    wanted: dict[str, float | None] = {
        name: None if value is None else si_value(value, unit, name)
        for name, value, unit in (("interval", interval, "s"), ("peak", peak, "m/s^2"), ("width", width, "s"))
    }
    limit = None if stop_limit is None else si_value(stop_limit, "N", "stop_limit")
    goal = blow_goal(**wanted, disc=material(choice.disc, "disc"), stop_limit=limit, spec=spec)
    base = load_case(REFERENCE) if case is None else case
    with store_in(store) as finished:
        return design_settings(base, goal, choice, finished, as_workers(workers).pool(), share_reporter(progress))
