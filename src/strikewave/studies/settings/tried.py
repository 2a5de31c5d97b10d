"""What is tried for a goal: numbers of strikers, masses of one, and what brings the object back."""

from __future__ import annotations

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import InputError
from strikewave.base.percents import plain
from strikewave.cases.case import Case
from strikewave.studies.settings.estimate import (
    Support,
    approach_at,
    engagement,
    largest_engagement,
    passage_time,
    pulse_velocity_change,
    return_arc,
    settling_time,
    support_for,
    turntable_speed,
)
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices
from strikewave.studies.settings.search import Design, Trial

STRIKERS = (1, 2, 3, 4, 6, 8, 12)
"""Numbers of strikers that are tried by default, besides that of the case: each about a third to twice more than the
one before, since the speed goes with its inverse."""
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
    if not sensible:
        raise _none_left(goal, reached, change, left_out)
    return sensible, left_out


def _none_left(goal: BlowGoal, reached: float, change: float, left_out: dict[int, str]) -> InputError:
    """Return why no number of strikers is left: the noses come too slowly, or leave no time to return.

    ``reached`` is the fastest approach of a nose, ``change`` the velocity change of the pulse, m/s.
    """
    if 2.0 * reached < change:
        largest = goal.peak * 2.0 * reached / change / STANDARD_GRAVITY
        allowed = (
            f"at most {plain(largest, 4)} g with this width, interval and radius, where the noses come at "
            f"{plain(reached)} m/s and nothing is lost"
        )
        hint = "a larger machine.radius or feed.stroke (--set), other --strikers, a shorter width or interval help"
        return InputError("--peak", f"{plain(goal.peak / STANDARD_GRAVITY, 4)} g", allowed, hint)
    why = "; ".join(f"{number} strikers: {reason}" for number, reason in left_out.items())
    return InputError(
        "--strikers", ", ".join(map(str, left_out)), "a number that leaves the object time to return", why
    )


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
