"""What no setting can give, refused before anything is run."""

from __future__ import annotations

import math
from collections.abc import Iterable

from strikewave.base.errors import InputError
from strikewave.base.materials import material
from strikewave.base.percents import plain
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import face_contact
from strikewave.contact.law import indentation_under
from strikewave.signal.pulse import HALF_SINE_WIDTH
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices
from strikewave.studies.settings.search import VARIED
from strikewave.studies.settings.tried import MASS_SHARES, SUPPORTS

MOST_STRIKERS = 100
"""Most strikers: the limit of ``machine.strikers`` in a case."""
SHORTEST = 10.0
"""Least interval over the width of the pulse: what comes sooner runs into the pulse before."""
LEAST_SHARE = 0.9
"""Share of the width of a half-sine on the contact alone below which a width is refused: the tenth is left for what a
half-sine is not. Full runs with a nearly rigid frame stand above it by less than a third."""
MOST_CANDIDATES = 500
"""More combinations of strikers, masses and supports than this are refused: at 0.8 s each (measured, li-ma-2019) they
take seven minutes."""


def is_rotary(case: Case) -> bool:
    """Tell whether a case is of a rotary machine, or at least of no other one."""
    return getattr(case.machine, "kind", "rotary") == "rotary"


def check_goal(case: Case, goal: BlowGoal, choice: SettingsChoices) -> None:
    """Refuse what no setting can give, before anything is run.

    Raises
    ------
    InputError
        With the option.
    """
    _check_machine(case)
    _check_blows(goal)
    _check_strikers(case, choice)
    _check_feed(case, goal)
    _check_choice(goal, choice)
    least = least_width(case, goal, choice)
    if goal.width < least:
        allowed = f"at least about {plain(least * 1e6)} us at this peak: object and striker are no stiffer"
        hint = "a lighter striker or a stiffer contact helps" + ("" if choice.vary == "frame" else ", or --vary frame")
        raise InputError("--width", f"{plain(goal.width * 1e6, 4)} us", allowed, hint)


def _check_machine(case: Case) -> None:
    """Refuse what is no rotary machine with a nose on a frame, or one that strikes at an angle."""
    if case.machine is None or case.stack.layer or not is_rotary(case):
        allowed = "a machine case whose object is a nose on a frame, such as li-ma-2019"
        raise InputError("--from", case.name, allowed, "a stack of layers has no frame stiffness to choose")
    angle = getattr(case.machine, "blow_angle", None)
    if angle is not None and angle.si != 0.0:
        allowed = "0: noses that strike as a cam"
        raise InputError("machine.blow_angle", angle.typed, allowed, "remove it, or the first estimates do not hold")


def _check_blows(goal: BlowGoal) -> None:
    """Refuse blows of nothing, and those that run into one another."""
    for field, value in (("--interval", goal.interval), ("--peak", goal.peak), ("--width", goal.width)):
        if not 0.0 < value < math.inf:
            raise InputError(field, value, "above zero")
    if goal.width * SHORTEST > goal.interval:
        longest = goal.interval / SHORTEST * 1e6
        allowed = f"at most {plain(longest, 4)} us, a tenth of the interval"
        raise InputError("--width", f"{plain(goal.width * 1e6, 4)} us", allowed, "longer pulses run into the next blow")


def _check_feed(case: Case, goal: BlowGoal) -> None:
    """Refuse a feed that holds the object for the next striker, or brings it there with the first one."""
    feed, typed = case.rotary_tables().feed, f"{plain(goal.interval * 1e3, 4)} ms"
    if feed.release_delay.si >= goal.interval:
        allowed = f"less than the interval, {typed}: the next striker comes before the object leaves"
        raise InputError("feed.release_delay", feed.release_delay.typed, allowed, "shorten it by --set")
    if feed.arrival.si == 0.0:
        raise InputError("feed.arrival", feed.arrival.typed, "above 0: the object comes between two strikers")


def _check_choice(goal: BlowGoal, choice: SettingsChoices) -> None:
    """Refuse a stiffness that is not there to vary, a disc without a yield strength, and too many settings to try."""
    if choice.vary not in VARIED:
        raise InputError("--vary", choice.vary, " or ".join(VARIED))
    if goal.disc.yield_strength is None or goal.disc.kind != "metal":
        raise InputError("--disc", goal.disc.name, "a metal with a yield strength", "see `strikewave materials`")
    count = len(choice.strikers) * max(len(choice.masses), 1) * (SUPPORTS + 1)
    if count > MOST_CANDIDATES:
        raise InputError("--strikers", f"{count} settings to try", f"at most {MOST_CANDIDATES}", "ask for fewer")


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
