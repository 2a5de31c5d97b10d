"""Buffer design: gasket stacks under a sensor, ranked by what it then reads of a given blow.

The motion of the surface is given, and drives each stack of gaskets with the sensor on it; as everywhere in
`strikewave.sensors` the sensor does not load the surface back. Each candidate is run in time through the whole
chain: gaskets with mass and causal loss, resonance of the element, its range, the recorder. What it costs is
bandwidth: see `strikewave.sensors.bandwidth`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

from strikewave.sensors import Mounting
from strikewave.sensors.mounting import mounting_system
from strikewave.studies.buffer.candidate import (
    Candidate,
    Goal,
    alike,
    assess,
    assess_mounting,
    distinct,
    look_closer,
    ranked,
    with_front,
    withstands,
)
from strikewave.studies.buffer.choice import Choice, stacks
from strikewave.studies.buffer.notices import study_notices
from strikewave.studies.buffer.result import BufferStudy
from strikewave.studies.buffer.seat import Blows, Motion, Seat

MOST_STATES = 800
"""A stack with more states is left out of the search: each would take seconds."""
LEADING = 10
"""First distinct ones of the ranking that are also tried with other moduli, as is the front where it keeps the limit.
"""


def design_buffer(
    seat: Seat, blows: Blows, choice: Choice, goal: Goal, progress: Callable[[float], None] | None = None
) -> BufferStudy:
    """Rank all stacks of a choice for a sensor, a blow, and a limit on what it may read.

    Parameters
    ----------
    seat : Seat
        The sensor.
    blows : Blows
        The blow, and the others of its run, which the best stack is tried on too.
    choice : Choice
        What stacks may be made of.
    goal : Goal
        The limit, and what decides among those that keep it.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError, InputErrors
        If there are too many stacks, or the sensor's recorder does not fit the history.
    """
    found, skipped, every = [], 0, stacks(choice)
    for k, sheets in enumerate(every):
        if _too_large(seat.mounting(sheets)):
            skipped += 1
        else:
            found.append(assess(seat, sheets, blows.motion, goal))
        if progress is not None:
            progress((k + 1) / len(every))
    study = BufferStudy(seat, blows, goal, _looked_at(found, seat, blows.motion, goal), _present(seat, blows, goal))
    return dataclasses.replace(study, notices=(*blows.warnings, *study_notices(study, skipped)))


def _present(seat: Seat, blows: Blows, goal: Goal) -> Candidate | None:
    """Return what the sensor reads on the buffer that the case has now."""
    if seat.present is None or _too_large(seat.present.mounting):
        return None
    return assess_mounting(seat, seat.present.mounting, blows.motion, goal, seat.present.name)


def _looked_at(found: Sequence[Candidate], seat: Seat, motion: Motion, goal: Goal) -> tuple[Candidate, ...]:
    """Return candidates ranked, the first distinct ones and the front with what is found only of them."""
    order = ranked(with_front(found), goal)
    chosen = distinct(order, LEADING) + [one for one in order if one.pareto and one.keeps]
    if goal.rank == "robust":
        chosen += _withstanding(order, seat, motion, goal)
    closer = {id(one): look_closer(seat, one, motion, goal) for one in dict.fromkeys(chosen)}
    return tuple(ranked([closer.get(id(one), one) for one in order], goal))


def _withstanding(order: Sequence[Candidate], seat: Seat, motion: Motion, goal: Goal) -> list[Candidate]:
    """Return the first distinct ones of a ranking that keep the limit with all moduli, `LEADING` at most."""
    found: list[Candidate] = []
    for one in order:
        if len(found) == LEADING:
            break
        if not any(alike(one, other) for other in found) and withstands(seat, one, motion, goal):
            found.append(one)
    return found


def _too_large(mounting: Mounting) -> bool:
    try:
        return mounting_system(mounting).b.size > MOST_STATES
    except ValueError:
        return True
