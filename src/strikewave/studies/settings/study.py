"""Inverse design of the rotary machine: settings that give blows of an asked peak and width at an asked interval.

Closed forms (`estimate`) say where to begin, full runs of all blows (`search`) correct engagement,
stiffness and speed, and every candidate is judged by a full run (`candidate`).
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from strikewave.base.citations import citation
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import MISSING, InputError, InputErrors
from strikewave.base.materials import Material, material
from strikewave.base.result import Notice, Source
from strikewave.cases.case import FORM, Case
from strikewave.cases.contact_of_case import face_contact
from strikewave.cases.written_case import dump_case
from strikewave.contact.law import indentation_under
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import ShownResult, columns_of
from strikewave.signal.pulse import HALF_SINE_WIDTH, WIDTH_FRACTION
from strikewave.specifications.ideal_pulses import HALF_SINE as HALF_SINE_SHAPE
from strikewave.specifications.judged_records import clause_document
from strikewave.specifications.judging import worst_clauses
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.answers import Failure, answers
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.studies.settings.answer_files import name_at, other_cases
from strikewave.studies.settings.candidate import WITHIN, BlowGoal, BlowSpread, SettingsCandidate, rank_key
from strikewave.studies.settings.estimate import (
    Support,
    approach_at,
    engagement,
    engagement_sensitivity,
    largest_engagement,
    passage_time,
    pulse_velocity_change,
    return_arc,
    settling_time,
    support_for,
    turntable_speed,
)
from strikewave.studies.settings.search import VARIED, Design, Trial, settings_candidate

STRIKERS = (1, 2, 3, 4, 6, 8, 12)
"""Numbers of strikers that are tried by default, besides that of the case: each about a third to twice more than the
one before, since the speed goes with its inverse."""
MOST_STRIKERS = 100
"""Most strikers: the limit of ``machine.strikers`` in a case."""
MASS_SHARES = (0.5, 2.0)
"""Masses of a striker over that of the case which are tried besides, on the best support: a factor of two up and down
shows which way to go."""
RETURN_SHARE = (0.12, 0.55)
"""Least and largest time of the object's return that is tried, over the interval. The rest is left for bounces on the
stop: the settings of li-ma-2019 that meet a goal settle in 0.2 to 1.0 of the interval (measured)."""
PASSED = 1.3
"""Least time of return that is tried, over the passage of a nose by the first estimate, which is too short: engagement
grows by up to 1.6 in the search (measured), and the passage with its root."""
WIDTHS = 10.0
"""Least time of return that is tried, over the width of the pulse: what returns sooner takes part in the pulse."""
PRELOADS, DAMPINGS, TIMES = (0.3, 1.0), (0.2, 0.4, 0.7), 3
"""Series of supports: preload ratios, damping ratios (see `support_for`), and how many times of return. Chosen: from
a weak to a strong preload and from light to nearly critical damping, in steps that differ clearly."""
SUPPORTS = 6
"""Supports of the series that are run, those that settle soonest, for each number of strikers: a third of the series,
about 0.8 s each (measured, li-ma-2019)."""
SUPPORT_DIGITS = 3
"""Significant digits of spring, preload and damper: no spring is made more exactly, and no run depends on more."""
PRESSED = 0.5
"""Largest compression of the stop by the preload alone, over the largest displacement: beyond it the object sits on its
stop more than it flies, and the closed forms of a rigid stop do not hold."""
SHORTEST = 10.0
"""Least interval over the width of the pulse: what comes sooner runs into the pulse before."""
LEAST_SHARE = 0.9
"""Share of the width of a half-sine on the contact alone below which a width is refused: the tenth is left for what a
half-sine is not. Full runs with a nearly rigid frame stand above it by less than a third."""
MOST_REASONS = 5
"""Reasons that an error lists where no setting can be run: more would not be read."""
MOST_CANDIDATES = 500
"""More combinations of strikers, masses and supports than this are refused: at 0.8 s each (measured, li-ma-2019) they
take seven minutes."""
SOURCES = ("li-ma-2019", "timoshenko-goodier-1970", "schwager-poschel-2007")
"""Keys of the sources: of the machine, the stress of the disc, the time on the stop."""
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


@dataclass(frozen=True)
class SettingsChoices:
    """What may be chosen: numbers of strikers, masses of one (empty: several about the case), what sets the width."""

    strikers: tuple[int, ...] = ()
    masses: tuple[float, ...] = ()
    vary: str = "frame"


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
        blow = {"peak.typical": "g", "width.typical": "us", "interval.typical": "ms", "peak.variation": "1"}
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


def goal_words(goal: BlowGoal) -> str:
    """Return a goal in words.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
    >>> goal_words(BlowGoal(0.02, 4000 * 9.80665, 200e-6, material("45 steel")))
    'blows of 4000 g and 200 us every 20 ms'
    """
    pulse = f"{goal.peak / STANDARD_GRAVITY:.6g} g and {goal.width * 1e6:.6g} us"
    by = "" if goal.specification is None else f", by {goal.specification.asked}"
    return f"blows of {pulse} every {goal.interval * 1e3:.6g} ms{by}"


def name_of(goal: BlowGoal) -> str:
    """Return the name of the case and of the folder of a goal.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
    >>> name_of(BlowGoal(0.02, 4000 * 9.80665, 200e-6, material("45 steel")))
    'settings-20ms-4000g-200us'
    """
    return f"settings-{goal.interval * 1e3:.6g}ms-{goal.peak / STANDARD_GRAVITY:.6g}g-{goal.width * 1e6:.6g}us"


def _notices(candidate: SettingsCandidate) -> Iterator[Notice]:
    """Yield the warnings on a candidate: limits that do not decide, and a goal that is not met."""
    for limit in candidate.limits:
        if not limit.decides and not limit.kept:
            message = (
                f"the contact yields below its surface (von Mises) beyond {limit.limit / 1e3:.3g} kN and is loaded "
                f"with {limit.value / 1e3:.3g} kN: give contact.yield_pressure by --set, or trust peak and width, "
                "which depend on frame and mount, more than the contact force"
            )
            yield Notice("contact-yield", message, limit.value, limit.limit)
    if not candidate.meets:
        message = f"the nearest setting misses the goal: {candidate.obstacles}"
        yield Notice("not-met", message, candidate.largest_miss, WITHIN)


def is_rotary(case: Case) -> bool:
    """Tell whether a case is of a rotary machine, or at least of no other one."""
    return getattr(case.machine, "kind", "rotary") == "rotary"


def blow_goal(
    interval: float | None,
    peak: float | None,
    width: float | None,
    disc: Material,
    stop_limit: float | None = None,
    spec: str | None = None,
) -> BlowGoal:
    """Return what blows shall be: as given, or those of a specification, at its rate where no interval is given.

    Raises
    ------
    InputError
        If something is missing, or the specification cannot be read, or is of no half-sine.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
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


def check_goal(case: Case, goal: BlowGoal, choice: SettingsChoices) -> None:
    """Refuse what no setting can give, before anything is run.

    Raises
    ------
    InputError
        With the option.
    """
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
        longest = goal.interval / SHORTEST * 1e6
        allowed = f"at most {longest:.4g} us, a tenth of the interval"
        raise InputError("--width", f"{goal.width * 1e6:.4g} us", allowed, "longer pulses run into the next blow")
    _check_strikers(case, choice)
    feed, typed = case.rotary_tables().feed, f"{goal.interval * 1e3:.4g} ms"
    if feed.release_delay.si >= goal.interval:
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
        allowed = f"at least about {least * 1e6:.3g} us at this peak: object and striker are no stiffer"
        hint = "a lighter striker or a stiffer contact helps" + ("" if choice.vary == "frame" else ", or --vary frame")
        raise InputError("--width", f"{goal.width * 1e6:.4g} us", allowed, hint)


def check_changes(changes: Iterable[str], vary: str) -> None:
    """Refuse a change (``path=value``) of a field that is chosen here: the search would replace it, with no warning.

    Raises
    ------
    InputError
        With the field.

    Examples
    --------
    >>> check_changes(["machine.speed=700 rpm"], "frame")
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: machine.speed: got "700 rpm"; allowed: no --set of it: it is chosen, with the \
strikers by --interval; leave it out, or ask for another --interval
    """
    chosen_here = {
        "machine.speed": ("with the strikers by --interval", "leave it out, or ask for another --interval"),
        "machine.engagement": ("by --peak", "leave it out, or ask for another --peak"),
        "machine.strikers": ("from those that are tried", "give --strikers"),
        "striker.mass": ("from those that are tried", "give --striker-mass"),
        VARIED[vary][0]: ("by --width", "leave it out, ask for another --width, or --vary the other stiffness"),
    }
    for change in changes:
        path, _, value = (part.strip() for part in change.partition("="))
        if path in chosen_here:
            how, hint = chosen_here[path]
            raise InputError(path, value, f"no --set of it: it is chosen, {how}", hint)


def _check_strikers(case: Case, choice: SettingsChoices) -> None:
    """Refuse numbers of strikers out of range, and those that rows of single strikers contradict."""
    odd = [number for number in choice.strikers if not 1 <= number <= MOST_STRIKERS]
    if odd:
        raise InputError("--strikers", odd[0], f"a whole number from 1 to {MOST_STRIKERS}")
    rows = {int(row.number.si): row for row in case.rotary_tables().striker.each}
    last = max(rows, default=0)
    if choice.strikers and min(choice.strikers) < last:
        allowed = f"at most {min(choice.strikers)}, as --strikers asks"
        raise InputError(f"striker.each.{last}.number", last, allowed, "remove its row, or ask for more strikers")
    own = [number for number, row in rows.items() if row.mass is not None]
    if choice.masses and own:
        allowed = f"none: striker {own[0]} has a mass of its own"
        raise InputError("--striker-mass", f"{choice.masses[0]:g} kg", allowed, "remove the masses of [[striker.each]]")


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
    lightest = min([*choice.masses, *own], default=min(MASS_SHARES) * rig.striker.mass.si)
    force = mass * goal.peak
    contact = face_contact(rig.striker, rig.contact, material(rig.object.material))
    compliance = indentation_under(contact, force) / force
    if choice.vary == "mount" and rig.object.frame_stiffness is not None:
        compliance += 1.0 / rig.object.frame_stiffness.si
    reduced = mass * lightest / (mass + lightest)
    return LEAST_SHARE * math.pi * HALF_SINE_WIDTH * math.sqrt(reduced * compliance)


def sensible_strikers(case: Case, goal: BlowGoal, choice: SettingsChoices) -> tuple[list[int], dict[int, str]]:
    """Return the numbers of strikers to run, and why each other one is left out.

    Raises
    ------
    InputError
        If none is left; a peak beyond what the largest engagement reaches is named with the largest one.
    """
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
                f"engaged by the {deepest * 1e3:.3g} mm that strikers and stroke allow, the noses come at {reach:.3g} "
                f"m/s; even a blow without loss takes {0.5 * change:.3g} m/s"
            )
            continue
        passing = passage_time(engagement(0.5 * change, speed, radius), speed, radius)
        if passing > RETURN_SHARE[1] * goal.interval:
            left_out[number] = f"a nose is in the way for {passing * 1e3:.3g} ms of the {goal.interval * 1e3:.4g} ms"
            continue
        sensible.append(number)
    if sensible:
        return sensible, left_out
    if 2.0 * reached < change:
        largest = goal.peak * 2.0 * reached / change / STANDARD_GRAVITY
        allowed = (
            f"at most {largest:.4g} g with this width, interval and radius, where the noses come at {reached:.3g} m/s "
            "and nothing is lost"
        )
        hint = "a larger machine.radius or feed.stroke (--set), other --strikers, a shorter width or interval help"
        raise InputError("--peak", f"{goal.peak / STANDARD_GRAVITY:.4g} g", allowed, hint)
    why = "; ".join(f"{number} strikers: {reason}" for number, reason in left_out.items())
    raise InputError("--strikers", ", ".join(map(str, wanted)), "a number that leaves the object time to return", why)


def supports(case: Case, goal: BlowGoal, strikers: int) -> list[Support | None]:
    """Return what may bring the object back: the case's own (None), and those of the series that settle soonest.

    The first arc takes between the passage of a nose and about half the interval. What would move beyond the stroke, or
    press the stop by more than `PRESSED` of its largest displacement, comes last.
    """
    rig = case.rotary_tables()
    assert rig.object.mass is not None
    mass, change = rig.object.mass.si, pulse_velocity_change(goal.peak, goal.width)
    weight, restitution = mass * rig.object.gravity.si, rig.object.stop_restitution.si
    radius, speed = rig.machine.radius.si, turntable_speed(strikers, goal.interval)
    passing = passage_time(float(Design(Trial(case, strikers, None, None, "frame", ""), goal).start[0]), speed, radius)
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


def design_settings(
    case: Case,
    goal: BlowGoal,
    choice: SettingsChoices | None = None,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> SettingsStudy:
    """Return settings of a machine for blows of a peak and a width at an interval, ranked.

    Parameters
    ----------
    case : Case
        What is not chosen: geometry, materials, contact, feed, stop.
    goal : BlowGoal
        What the blows shall be.
    choice : SettingsChoices, optional
        What may be chosen.
    store : RunStore, optional
        Searches that were finished.
    pool : Pool, optional
        Who makes the others; this process where it is left out.
    advance : callable, optional
        Called as searches come back.

    Raises
    ------
    InputError
        If no setting can give it, or none could be run: with the reasons.
    """
    choice = choice or SettingsChoices()
    check_goal(case, goal, choice)
    numbers, left_out = sensible_strikers(case, goal, choice)
    note = f"chosen by strikewave settings for {goal_words(goal)}"
    masses: tuple[float | None, ...] = choice.masses or (None,)
    first = [
        Design(Trial(case, number, support, mass, choice.vary, note), goal)
        for number in numbers
        for mass in masses
        for support in supports(case, goal, number)
    ]
    own = any(row.mass is not None for row in case.rotary_tables().striker.each)
    heavier = 0 if choice.masses or own else len(MASS_SHARES) * len(numbers)
    with given_or_temporary(store) as kept, pool or ProcessPool(1) as open_pool:
        tried = _tried(first, kept, open_pool, _of_all(advance, 0, len(first) + heavier))
        if heavier:
            other = list(_other_masses(tried, numbers))
            tried += _tried(other, kept, open_pool, _of_all(advance, len(first), len(first) + heavier))
    candidates = [found for _, found in tried if isinstance(found, SettingsCandidate)]
    failures = [(design, found.reason) for design, found in tried if isinstance(found, Failure)]
    if not candidates:
        raise InputErrors(list(dict.fromkeys(reason for _, reason in failures))[:MOST_REASONS])
    failed = tuple(dict.fromkeys(f"{design.rig.strikers} strikers: {reason}" for design, reason in failures))
    ranked = tuple(sorted(candidates, key=rank_key))
    return SettingsStudy(
        case, goal, choice, ranked, left_out, failed, notices=tuple(_notices(ranked[0])), citations=SOURCES
    )


Tried = list[tuple[Design, SettingsCandidate | Failure]]


def _of_all(advance: Advance | None, before: int, whole: int) -> Advance | None:
    """Return what tells of a part of all searches, with those before it."""
    if advance is None:
        return None
    return lambda now: advance(now._replace(total=whole, done=before + now.done))


def _tried(designs: Sequence[Design], store: RunStore, pool: Pool, advance: Advance | None) -> Tried:
    """Return designs with what their searches end at, or why that is nothing."""
    found = answers(designs, store, pool, advance)
    return [
        (design, one if isinstance(one, Failure) else settings_candidate(design, one))
        for design, one in zip(designs, found, strict=True)
    ]


def _other_masses(tried: Tried, numbers: Sequence[int]) -> Iterator[Design]:
    """Yield the best design of each number of strikers with other masses of a striker."""
    for number in numbers:
        runs = [
            (design, c) for design, c in tried if design.rig.strikers == number and isinstance(c, SettingsCandidate)
        ]
        if runs:
            design, _ = min(runs, key=lambda pair: rank_key(pair[1]))
            mass = design.rig.case.rotary_tables().striker.mass.si
            for share in MASS_SHARES:
                yield dataclasses.replace(design, rig=design.rig._replace(mass=share * mass))


__all__ = [
    "BlowGoal",
    "SettingsChoices",
    "SettingsStudy",
    "design_settings",
    "goal_words",
    "name_of",
]
