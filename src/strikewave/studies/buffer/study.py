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
    BufferCandidate,
    BufferGoal,
    alike,
    assess,
    assess_mounting,
    distinct,
    look_closer,
    ranked,
    with_pareto,
    withstands,
)
from strikewave.studies.buffer.choice import StackChoices, stacks
from strikewave.studies.buffer.mounting_site import BaseMotion, Blows, MountingSite
from strikewave.studies.buffer.notices import study_notices
from strikewave.studies.buffer.result import BufferStudy

MOST_STATES = 800
"""A stack with more states is left out of the search: its time grows faster than the square of their number
(measured: 0.5 s with 840 states, 3 s with 1680), where most stacks take 6 ms."""
LEADING = 10
"""First distinct ones of the ranking that are also tried with other moduli, besides the Pareto-optimal ones that
keep the limit. Chosen: as many as a screen shows; each takes up to 13 more runs."""


def design_buffer(
    site: MountingSite,
    blows: Blows,
    choice: StackChoices,
    goal: BufferGoal,
    progress: Callable[[float], None] | None = None,
) -> BufferStudy:
    """Rank all stacks of a choice for a sensor, a blow, and a limit on what it may read.

    Parameters
    ----------
    site : MountingSite
        The sensor.
    blows : Blows
        The blow, and the others of its run, which the best stack is tried on too.
    choice : StackChoices
        What stacks may be made of.
    goal : BufferGoal
        The limit, and what decides among those that keep it.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError, InputErrors
        If there are too many stacks, or the sensor's recorder does not fit the history.
    """
    candidates, skipped, every = [], 0, stacks(choice)
    for k, stack in enumerate(every):
        if _too_large(site.mounting(stack)):
            skipped += 1
        else:
            candidates.append(assess(site, stack, blows.motion, goal))
        if progress is not None:
            progress((k + 1) / len(every))
    study = BufferStudy(
        site, blows, goal, _looked_at(candidates, site, blows.motion, goal), _present(site, blows, goal)
    )
    return dataclasses.replace(study, notices=(*blows.warnings, *study_notices(study, skipped)))


def _present(site: MountingSite, blows: Blows, goal: BufferGoal) -> BufferCandidate | None:
    """Return what the sensor reads on the buffer that the case has now."""
    if site.present is None or _too_large(site.present.mounting):
        return None
    return assess_mounting(site, site.present.mounting, blows.motion, goal, site.present.name)


def _looked_at(
    candidates: Sequence[BufferCandidate], site: MountingSite, motion: BaseMotion, goal: BufferGoal
) -> tuple[BufferCandidate, ...]:
    """Return candidates ranked, the first distinct and the Pareto-optimal ones with what is computed only of them."""
    order = ranked(with_pareto(candidates), goal, motion.width)
    chosen = distinct(order, LEADING) + [candidate for candidate in order if candidate.pareto and candidate.keeps]
    if goal.rank == "robust":
        chosen += _withstanding(order, site, motion, goal)
    closer = {id(candidate): look_closer(site, candidate, motion, goal) for candidate in dict.fromkeys(chosen)}
    return tuple(ranked([closer.get(id(candidate), candidate) for candidate in order], goal, motion.width))


def _withstanding(
    order: Sequence[BufferCandidate], site: MountingSite, motion: BaseMotion, goal: BufferGoal
) -> list[BufferCandidate]:
    """Return the first distinct ones of a ranking that keep the limit with all moduli, `LEADING` at most."""
    robust: list[BufferCandidate] = []
    for candidate in order:
        if len(robust) == LEADING:
            break
        if not any(alike(candidate, other) for other in robust) and withstands(site, candidate, motion, goal):
            robust.append(candidate)
    return robust


def _too_large(mounting: Mounting) -> bool:
    try:
        return mounting_system(mounting).b.size > MOST_STATES
    except ValueError:
        return True
