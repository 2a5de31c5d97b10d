"""Inverse design of the rotary machine: settings that give blows of an asked peak and width at an asked interval.

Closed forms (`estimate`) say where to begin, full runs of all blows (`search`) correct engagement,
stiffness and speed, and every candidate is judged by a full run (`candidate`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from strikewave.base.errors import InputErrors
from strikewave.base.percents import plain
from strikewave.base.result import RUN_FAILED, Notice, Verdicts
from strikewave.cases.case import Case
from strikewave.studies.engine.answers import Failure, answers
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.studies.settings.candidate import WITHIN, SettingsCandidate, rank_key
from strikewave.studies.settings.checks import check_goal
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices, goal_words
from strikewave.studies.settings.result import SettingsStudy
from strikewave.studies.settings.search import Design, Trial, settings_candidate
from strikewave.studies.settings.tried import MASS_SHARES, sensible_strikers, supports

MOST_REASONS = 5
"""Reasons that an error lists where no setting can be run: more would not be read."""
SOURCES = ("li-ma-2019", "timoshenko-goodier-1970", "schwager-poschel-2007")
"""Keys of the sources: of the machine, the stress of the disc, the time on the stop."""


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
    ranked = tuple(dataclasses.replace(one, place=k) for k, one in enumerate(sorted(candidates, key=rank_key), 1))
    verdicts = searched([one.run_verdict for one in ranked], [reason for _, reason in failures])
    notices = (*_notices(ranked[0]), *verdicts.notices())
    return SettingsStudy(
        case, goal, choice, ranked, left_out, failed, notices=notices, citations=SOURCES, verdicts=verdicts
    )


def searched(found: Sequence[str], reasons: Sequence[str]) -> Verdicts:
    """Return the verdicts of the runs that searches ended at, the first one's decides; and why others came to none."""
    texts = [*found, *[RUN_FAILED] * len(reasons)]
    return Verdicts(texts, "settings", next(iter(reasons), ""), deciding=texts[:1])


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


def _notices(candidate: SettingsCandidate) -> Iterator[Notice]:
    """Yield the warnings on a candidate: limits that do not decide, and a goal that is not met."""
    for limit in candidate.limits:
        if not limit.decides and not limit.kept:
            message = (
                f"the contact yields below its surface (von Mises) beyond {plain(limit.limit / 1e3)} kN and is loaded "
                f"with {plain(limit.value / 1e3)} kN: give contact.yield_pressure by --set, or trust peak and width, "
                "which depend on frame and mount, more than the contact force"
            )
            yield Notice("contact-yield", message, limit.value, limit.limit)
    if not candidate.meets:
        message = f"the nearest setting misses the goal: {candidate.obstacles}"
        yield Notice("not-met", message, candidate.largest_miss, WITHIN)
