"""Goal of blows, and a candidate of settings by its full run: measures of its blows, and its limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import median
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import STANDARD_GRAVITY, Material, material
from strikewave.base.declare import MAIN, MORE, Quantity
from strikewave.base.errors import MISSING, InputError
from strikewave.base.result import BALANCE_LIMIT
from strikewave.base.shock_quantities import ENERGY, LENGTH, PULSE_WIDTH, RATIO, VARIATION, VELOCITY_CHANGE
from strikewave.cases.case import Case
from strikewave.cases.tables.contact import CUSHION, POWER
from strikewave.contact import Geometry, first_yield, stiffness_law
from strikewave.machines import Blow, MachineRun, Striker, Turntable
from strikewave.machines.blows import contact_table
from strikewave.machines.spans import ChainSpan
from strikewave.signal.pulse import WIDTH_FRACTION
from strikewave.specifications.ideal_pulses import HALF_SINE as HALF_SINE_SHAPE
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, Clause, ShockVerdict, together, worst_clauses
from strikewave.specifications.reading import Specification, load_specification
from strikewave.studies.search.machine import PEAK, RUN_CHECKS, STIFFNESS, ChosenValue, Limit, MachineCandidate
from strikewave.studies.search.rotary_estimates import disc_stress, engagement_sensitivity, rim_speed_at_yield
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

WITHIN = 0.05
"""Largest miss of peak, width and interval that meets the goal. Chosen: a real machine scatters by some per cent."""
STRETCH_SHARE = 0.1
"""Largest stretch of the mount by the striker's circling, over the engagement: a tenth changes the approach, which goes
with the root of the reach, and so the peak by 5 %, as much as `WITHIN` allows."""
LARGEST_DROP = 0.05
"""Largest loss of turntable speed at a blow, over the set speed: approach and peak follow it, by `WITHIN` at most."""
LARGEST_SCATTER = 0.05
"""Largest standard deviation of the peaks over their mean: as much as `WITHIN` allows the typical blow to miss."""
SAMPLE_STEP = 20e-6
"""Step of samples of the stop's force, s: a 240th of the 4.8 ms that the object of li-ma-2019 stays on its stop (half a
period), so that the largest sample misses the largest force by 1e-4 at most."""
AFTER_LAST = 0.9
"""Share of the striking period over which the energy of the last blow is counted: the next striker would come then."""
SCATTER_DIGITS = 3
"""Decimals to which the ranking compares scatters, 0.1 %: tolerances scatter blows by more; then the stop decides."""


INTERVAL = Quantity("s", "ms", "interval", 3, 0)
TURNING = Quantity("rad/s", "rpm", digits=3)
DAMPING = Quantity("N s/m", "N s/m")
MILLISECONDS = Quantity("s", "ms")
TYPICAL, FIRST, WORST = "median of the later full blows", "of the first blow", "of the blow farthest from the goal"
SCATTER, MISS = "standard deviation over mean of all struck blows", "by how much of itself the goal is missed"


@dataclass(frozen=True)
class BlowGoal:
    """Wanted blows, SI; ``disc`` carries the strikers, ``stop_limit`` is the largest force of the stop.

    With a specification, peak and width are those of its ideal pulse, and it judges each blow.
    """

    interval: float
    peak: float
    width: float
    disc: Material
    stop_limit: float | None = None
    specification: Specification | None = None

    @property
    def words(self) -> str:
        """The goal in words."""
        pulse = f"{self.peak / STANDARD_GRAVITY:.6g} g and {self.width * 1e6:.6g} us"
        by = "" if self.specification is None else f", by {self.specification.asked}"
        return f"blows of {pulse} every {self.interval * 1e3:.6g} ms{by}"

    @property
    def printed(self) -> str:
        """The goal in words, with units as print spells them."""
        return self.words.replace(" us ", " µs ")

    @property
    def name(self) -> str:
        """Name of the case and of the folder."""
        peak, width = f"{self.peak / STANDARD_GRAVITY:.6g}g", f"{self.width * 1e6:.6g}us"
        return f"settings-{self.interval * 1e3:.6g}ms-{peak}-{width}"


def blow_goal(
    interval: float | None,
    peak: float | None,
    width: float | None,
    disc: Material,
    stop_limit: float | None = None,
    spec: str | None = None,
) -> BlowGoal:
    """Return what blows shall be: as given, or those of a specification, at its rate where no interval is given.

    Examples
    --------
    >>> from strikewave.base.constants import Material, material
    >>> goal = blow_goal(None, None, None, material("45 steel"), spec="iec-60068-2-27-bump:100g-2ms")
    >>> round(goal.interval, 4), round(goal.peak / STANDARD_GRAVITY), round(goal.width * 1e3, 3)
    (0.3333, 100, 1.872)
    """
    specification = None
    if spec is not None:
        specification = load_specification(spec)
        pulse = specification.pulse
        if pulse.shape != HALF_SINE_SHAPE:
            raise InputError("--spec", specification.asked, "a half-sine: no blow of this machine is a " + pulse.shape)
        peak, width, rate = pulse.peak, pulse.width(WIDTH_FRACTION), specification.repetition()
        if interval is None and rate is not None:
            interval = 1.0 / (rate.high if math.isfinite(rate.high) else rate.low)
    if interval is None:
        hint = "a drop table is set by --spec; strikewave spec new writes one of your own"
        raise InputError("--interval", MISSING, 'time between blows, such as "20 ms"', hint)
    if peak is None or width is None:
        option, example = ("--peak", "4000 g") if peak is None else ("--width", "200 us")
        raise InputError(option, MISSING, f'that of the blows, such as "{example}", or --spec')
    return BlowGoal(interval, peak, width, disc, stop_limit, specification)


@declare.dataclass
class PeakSpread:
    """Peaks of the blows; the typical one is that of all struck blows where no later one is full."""

    typical: float = declare.number(PEAK, TYPICAL, column=MAIN, tables="ranking", headline="typical peak")
    first: float = declare.number(PEAK, FIRST)
    worst: float = declare.number(PEAK, WORST)
    variation: float = declare.number(
        VARIATION._replace(label="CV"), SCATTER, column=MORE, tables="ranking", headline="scatter of the peaks, CV"
    )
    miss: float = declare.number(RATIO, MISS)


@declare.dataclass
class WidthSpread:
    """Widths of the blows, likewise."""

    typical: float = declare.number(PULSE_WIDTH, TYPICAL, column=MAIN, tables="ranking", headline="typical width")
    first: float = declare.number(PULSE_WIDTH, FIRST)
    worst: float = declare.number(PULSE_WIDTH, WORST)
    variation: float = declare.number(VARIATION, SCATTER)
    miss: float = declare.number(RATIO, MISS)


@declare.dataclass
class IntervalSpread:
    """Times between the blows; the typical one is the median of all."""

    typical: float = declare.number(INTERVAL, TYPICAL, column=MORE, tables="ranking", headline="interval")
    first: float = declare.number(INTERVAL, FIRST)
    worst: float = declare.number(INTERVAL, WORST)
    variation: float = declare.number(VARIATION, SCATTER)
    miss: float = declare.number(RATIO, MISS)


@declare.dataclass
class Supply:
    """Loads of stop and drive between the first blow and the retraction."""

    stop_force: float = declare.number(
        Quantity("N", "kN", "stop", digits=3),
        "largest force of the stop",
        column=MORE,
        tables="ranking",
        headline="largest force of the stop",
    )
    energy_taken: float = declare.number(ENERGY, "mean energy that a blow takes from turntable, motor and belt")
    speed_lost: float = declare.number(
        TURNING,
        "largest loss of turntable speed in a blow, as if nothing drove meanwhile",
        label="lost a blow",
        column=MAIN,
        tables="mass",
    )
    speed_regained: float = declare.number(TURNING, "turntable speed regained between the last two blows")
    slowest: float = declare.number(TURNING, "slowest turntable speed that a blow found")


@declare.dataclass
class BlowKinds:
    """Number and kinds of the blows."""

    wanted: int = declare.count("how many blows were wanted")
    kinds: tuple[str, ...] = declare.word("full, glancing, double or missed, of each blow")
    touched_again: int = declare.count("blows that the striker touched again on its way back")

    @declare.computed(declare.word("blows that are not as they should be, in words"))
    def odd(self) -> str:
        """Blows that are not as wanted, in words; empty where all wanted ones came and were full."""
        counts = {kind: self.kinds.count(kind) for kind in ("missed", "double", "glancing") if kind in self.kinds}
        deviations = [f"{number} {kind}" for kind, number in counts.items()]
        again = self.touched_again - counts.get("double", 0)
        deviations += [f"{again} touched again on the way back"] if again > 0 else []
        struck = len(self.kinds) - counts.get("missed", 0)
        deviations += [f"{struck} blows instead of {self.wanted}"] if struck != self.wanted else []
        return ", ".join(deviations)


@declare.dataclass
class Observation:
    """Measures of the blows of a full run."""

    peak: PeakSpread = declare.part(PeakSpread, "peaks", quantity=PEAK)
    width: WidthSpread = declare.part(WidthSpread, "widths", quantity=PULSE_WIDTH)
    interval: IntervalSpread = declare.part(IntervalSpread, "times between them", quantity=INTERVAL)
    blows: BlowKinds = declare.part(BlowKinds, "the blows")
    approach: float = declare.number(VELOCITY_CHANGE, "median approach speed")
    velocity_change: float = declare.number(VELOCITY_CHANGE, "median velocity change")
    peak_force: float = declare.number(
        Quantity("N", "kN", "contact", digits=3), "largest contact force", column=MAIN, tables="mass"
    )
    largest_displacement: float = declare.number(
        Quantity("m", "mm", digits=3), "largest displacement of the object", column=MORE, tables="ranking"
    )
    energy_error: float = declare.number(RATIO, "energy that the balance misses, as a share of what flowed")
    supply: Supply = declare.part(Supply, "what stop and drive bear", inline=True)

    @property
    def misses(self) -> dict[str, float]:
        """Relative misses of the typical blow."""
        return {"peak": self.peak.miss, "width": self.width.miss, "interval": self.interval.miss}


@declare.dataclass
class FirstGuess:
    """Closed forms with which a search began."""

    velocity_change: float = declare.number(VELOCITY_CHANGE, "velocity change of the wanted pulse")
    approach: float = declare.number(VELOCITY_CHANGE, "approach speed that gives it")
    engagement: float = declare.number(LENGTH, "engagement that gives that")
    stiffness: float = declare.number(STIFFNESS, "stiffness that gives the width")
    turntable_speed: float = declare.number(TURNING, "speed that gives the interval")
    passage_time: float = declare.number(MILLISECONDS, "passage of a nose")
    return_time: float = declare.number(MILLISECONDS, "return of the object to its stop")
    largest_displacement: float = declare.number(LENGTH, "largest displacement of the object")
    settling_time: float = declare.number(MILLISECONDS, "time until the object rests on its stop")


def _of_case(
    path: str, quantity: Quantity, tables: str = "ranking", **shown: Any
) -> declare.ComputedField[float | None]:
    """Declare a value of the case of a candidate; documents have it among its settings."""
    shown = {"column": MORE + 1, **shown, "tables": tables, "in_document": False}
    declared = declare.computed(declare.number(quantity, f"{path} of its case", key=path, **shown))
    return declared(lambda candidate: getattr(candidate.case.values().get(path), "si", None))


@declare.dataclass(eq=False)
class SettingsCandidate(MachineCandidate):
    """A setting of the rotary machine with the blows of its full run; see `MachineCandidate`.

    Attributes
    ----------
    verdicts : tuple of ShockVerdict
        Verdicts of the specification on each blow that struck.
    """

    within: ClassVar[float] = WITHIN

    goal: BlowGoal

    strikers = declare.computed(declare.count("how many strikers", column=MAIN, tables="ranking", headline="strikers"))(
        lambda candidate: round(candidate.case.values()["machine.strikers"].si)
    )

    speed = _of_case("machine.speed", Quantity("rad/s", "rpm", "speed"), column=MAIN, headline="speed")
    mass = _of_case("striker.mass", Quantity("kg", "kg", "striker"), "ranking mass")
    engagement = _of_case(
        "machine.engagement", Quantity("m", "mm", "engagement"), "ranking mass", column=MAIN, headline="engagement"
    )
    frame = _of_case("object.frame_stiffness", STIFFNESS._replace(label="frame"), "ranking mass", column=MAIN)
    mount = _of_case("striker.mount_stiffness", STIFFNESS._replace(label="mount"), "ranking mass", column=MAIN)
    spring = _of_case("object.spring", Quantity("N/m", "kN/m", "spring", digits=3))
    preload = _of_case("object.preload", Quantity("N", "N", "preload", digits=3))
    damper = _of_case("object.damper", Quantity("N s/m", "N s/m", "damper", digits=3))
    frame_damping = _of_case("object.frame_damping", DAMPING, column=None)
    mount_damping = _of_case("striker.mount_damping", DAMPING, column=None)
    stroke_time = _of_case("feed.stroke_time", MILLISECONDS, column=None)
    retract_time = _of_case("feed.retract_time", MILLISECONDS, column=None)

    @declare.computed(declare.named(ChosenValue, "what was chosen"))
    def settings(self) -> dict[str, ChosenValue]:
        """Chosen values, by their paths."""
        values = self.case.values()
        return {path: ChosenValue(values[path].si, values[path].typed) for path in self.chosen}

    observation: Observation = declare.part(Observation, "what its full run shows", inline=True)

    @declare.computed(
        declare.number(
            Quantity("1/m", "%/mm", "sensitivity", digits=3),
            "relative change of the approach speed for a change of the engagement",
            column=MORE,
            tables="ranking",
        )
    )
    def engagement_sensitivity(self) -> float:
        """Relative change of the approach speed, and so of the peak, with the engagement."""
        values = self.case.values()
        return engagement_sensitivity(values["machine.engagement"].si, values["machine.radius"].si)

    limits: tuple[Limit, ...] = declare.rows(Limit, "its limits")
    estimate: FirstGuess = declare.part(FirstGuess, "closed forms with which the search began, SI")
    runs: int = declare.count("runs that it took")
    run_verdict: str = declare.word(RUN_CHECKS, column=MAIN, tables="ranking", order=2)
    verdicts: tuple[ShockVerdict, ...]
    judged_or_none = declare.computed(
        declare.word("of the specification on all blows that struck", key="verdict", optional=True)
    )(lambda candidate: candidate.judged or None)

    @declare.computed(
        declare.rows(Clause, "clauses of the specification, each by the blow that it judges worst", optional=True)
    )
    def clauses(self) -> list[Clause] | None:
        """Clauses of the specification, each with the blow that it judges worst; None without one."""
        if not self.verdicts:
            return None
        return [replace(clause, blow=place + 1) for clause, place in worst_clauses(self.verdicts)]

    @property
    def judged(self) -> str:
        """Verdict of the specification on all blows that struck; empty without one."""
        return together(verdict.verdict for verdict in self.verdicts) if self.verdicts else ""

    @property
    def relative_misses(self) -> dict[str, float]:
        """Relative misses of the typical blow."""
        return self.observation.misses

    @property
    def odd_blows(self) -> list[str]:
        """Blows that are not as they shall be, in words."""
        return [self.observation.blows.odd] if self.observation.blows.odd else []

    @property
    def passes(self) -> bool:
        """True if all wanted blows came and are full, and the specification passes each, where there is one."""
        return not self.odd_blows and self.judged in ("", PASS)

    @property
    def not_passed(self) -> list[str]:
        """Clauses of the specification that are not passed, in words."""
        failed = [clause for clause in self.clauses or () if clause.verdict in (FAIL, CANNOT_TELL)]
        return [f"{one.clause} of blow {one.blow} not passed" for one in failed]

    @property
    def rank(self) -> tuple[bool, float, float]:
        """Sort key of candidates.

        First those that meet the goal, by the scatter of their peaks in steps of 0.1 %, then by the force of the stop;
        then the others by how far they are from it, a broken limit, odd blows or a specification not passed counting as
        100 %.
        """
        scatter, stop_force = self.observation.peak.variation, self.observation.supply.stop_force
        if self.meets:
            return False, round(scatter, SCATTER_DIGITS) if math.isfinite(scatter) else 0.0, stop_force
        unpassed = self.judged not in ("", PASS)
        return True, self.largest_miss + len(self.broken) + bool(self.odd_blows) + unpassed, stop_force


def observe_blows(run: MachineRun, train: Sequence[Blow], goal: BlowGoal) -> Observation | None:
    """Return the measures of the blows of a run; None where no striker touched the object."""
    struck = [blow for blow in train if blow.kind != "missed"]
    if not struck:
        return None
    times = [blow.time for blow in struck]
    gaps = [later - earlier for earlier, later in pairwise(times)] or [goal.interval]
    full = [blow.kind == "full" for blow in struck]
    # a contact more than a pulse width after the one before is a new touch; only one with a tenth of the impulse makes
    # a blow "double", lighter ones count here too
    table = contact_table(run)
    groups = [table[table[:, 4] == passing, :2] for passing in np.unique(table[:, 4])]
    late = [np.any(rows[1:, 0] - rows[:-1, 1] > blow.width) for rows, blow in zip(groups, struck, strict=True)]
    kinds = tuple(blow.kind for blow in train)
    return Observation(
        peak=PeakSpread(*_spread([blow.rigid_peak for blow in struck], full, goal.peak)),
        width=WidthSpread(*_spread([blow.width for blow in struck], full, goal.width)),
        interval=IntervalSpread(*_spread(gaps, [], goal.interval)),
        blows=BlowKinds(wanted=run.machine.drive.feed.blows, kinds=kinds, touched_again=int(sum(late))),
        approach=median(blow.approach_speed for blow in struck),
        velocity_change=median(blow.velocity_change for blow in struck),
        peak_force=max(blow.peak_force for blow in struck),
        largest_displacement=max(blow.largest_displacement for blow in struck),
        supply=supply(run, times),
        energy_error=run.energy_error,
    )


def _spread(values: Sequence[float], full: Sequence[bool], goal: float) -> tuple[float, float, float, float, float]:
    """Return typical, first and worst value, variation and miss; the typical one is that of the later full blows."""
    later = [value for value, counts in zip(values[1:], full[1:], strict=False) if counts] or values
    known = [value for value in later if math.isfinite(value)]
    typical = median(known) if known else math.nan
    worst = max(values, key=lambda value: abs(value - goal) if math.isfinite(value) else math.inf)
    return typical, values[0], worst, variation(values), typical / goal - 1.0


def supply(run: MachineRun, touches: Sequence[float]) -> Supply:
    """Return the loads of stop and drive from the first touch to the retraction; see `Supply`.

    The force of the stop is that of `StruckObject`: k d + c d', never negative, d = compression at rest - (x + q). A
    blow takes what the drive gives until the next one touches, less what stays in turntable, motor and belt and what
    drag and belt lose: a ripple of the drive, which gives and takes by itself, cancels.
    """
    struck, retracted = run.machine.struck, dict(run.phases)["retract"]
    times = np.arange(touches[0], max(retracted, touches[-1]) + SAMPLE_STEP, SAMPLE_STEP)
    moments = run.sample(np.minimum(times, run.end))
    deep = struck.stop_compression - moments.assembly_place - run.machine.engagement
    force = struck.stop_stiffness * deep - struck.stop_damping * moments.assembly_speed
    stop_force = float(np.max(force[deep > 0.0], initial=0.0))

    disc, n = run.machine.drive.turntable, len(touches)
    spacing = (touches[-1] - touches[0]) / (n - 1) if n > 1 else run.machine.pitch / disc.speed
    after = min(max(retracted, touches[-1]), touches[-1] + AFTER_LAST * spacing)
    span = run.spans[0]  # the object is a nose on a frame: one span holds the whole run
    assert isinstance(span, ChainSpan)
    states, at = span.motion.sample(np.array([*touches, after]))[0], span.layout
    speed, twist, motor = states[:, at.turntable_speed], states[:, at.belt_twist], states[:, at.motor_speed]
    stored = 0.5 * disc.turning * speed**2
    if not disc.rigid_belt:
        stored = 0.5 * (disc.inertia * speed**2 + disc.motor_inertia * motor**2 + disc.belt_stiffness * twist**2)
    taken = np.diff(states[:, at.driven] - states[:, at.dragged]) - np.diff(stored)
    lost = taken / (disc.turning * speed[:-1])
    regained = float(speed[-2] - speed[-3] + lost[-2]) if n > 1 else math.nan
    return Supply(stop_force, float(np.mean(taken)), float(np.max(lost)), regained, float(np.min(speed[:-1])))


def limits_of(case: Case, run: MachineRun, observation: Observation, goal: BlowGoal) -> tuple[Limit, ...]:
    """Return the values of a setting that have a limit.

    The mean torque is what makes good the energy of a blow, E/(w T), and the drag at set speed. Stretch of the mount
    and first yield are those of the striker that is worst off.
    """
    machine, disc = run.machine, run.machine.drive.turntable
    strength = goal.disc.yield_strength or math.nan
    stretch = max(mount_stretch(striker, disc) for striker in machine.strikers.each)
    torque = observation.supply.energy_taken / (disc.speed * goal.interval) + disc.drag * disc.speed
    limits = [
        Limit("rim_speed", disc.speed * disc.radius, rim_speed_at_yield(goal.disc, strength), "m/s"),
        Limit("disc_stress", disc_stress(goal.disc, disc.speed, disc.radius), strength, "Pa"),
        Limit("mount_stretch", stretch, STRETCH_SHARE * machine.engagement, "m"),
        Limit("largest_displacement", observation.largest_displacement, machine.drive.feed.stroke, "m"),
        Limit("mean_torque", torque, disc.torque, "N m"),
        Limit("speed_drop", 1.0 - observation.supply.slowest / disc.speed, LARGEST_DROP, "1"),
        Limit("energy_error", observation.energy_error, BALANCE_LIMIT, "1"),
    ]
    if math.isfinite(observation.peak.variation):
        limits.append(Limit("peak_scatter", observation.peak.variation, LARGEST_SCATTER, "1"))
    if goal.stop_limit is not None:
        limits.append(Limit("stop_force", observation.supply.stop_force, goal.stop_limit, "N"))
    load = yield_load(case)
    if load is not None:
        limits.append(Limit("contact_force", observation.peak_force, load, "N", decides=False))
    return tuple(limits)


def mount_stretch(striker: Striker, disc: Turntable) -> float:
    """Return how far the mount stretches by the striker's circling, m w^2 R/(k - m w^2), m."""
    circling = striker.mass * disc.speed**2
    return circling * (disc.radius + striker.reach_error) / (striker.mount_stiffness - circling)


def yield_load(case: Case) -> float | None:
    """Return the least load at which the contact of a striker first yields inside, N.

    None where yielding is modelled, or the load is unknown.
    """
    rig = case.rotary_tables()
    table = rig.striker
    if rig.contact.yield_pressure is not None or rig.contact.law in (POWER, CUSHION):
        return None
    radius, length = table.nose_radius, table.contact_length
    noses = {((row.nose_radius or radius).si, (row.contact_length or length).si) for row in table.each}
    if len(table.each) < rig.machine.strikers.si:  # strikers without a row have the common nose
        noses.add((radius.si, length.si))
    pair = material(table.material), material(rig.object.material)
    is_long = "length" in stiffness_law(rig.contact.law).needs
    firsts = [first_yield(*pair, Geometry(nose, math.inf, size if is_long else None)) for nose, size in noses]
    loads = [first.load for first in firsts if first is not None]
    return min(loads) if len(loads) == len(firsts) else None
