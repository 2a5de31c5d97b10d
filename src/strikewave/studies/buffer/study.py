"""Buffer design: gasket stacks under a sensor, ranked by what it then reads of a given blow.

The motion of the surface is given, and drives each stack of gaskets with the sensor on it; as everywhere in
`strikewave.sensors` the sensor does not load the surface back. Each candidate is run in time through the whole
chain: gaskets with mass and causal loss, resonance of the element, its range, the recorder. What it costs is
bandwidth: see `strikewave.sensors.mounting`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.base.compiling import compiling_shown
from strikewave.base.errors import InputErrors
from strikewave.base.result import Verdicts
from strikewave.base.units import si_value
from strikewave.cases.case import Case
from strikewave.sensors import Mounting
from strikewave.sensors.mounting import mounting_system
from strikewave.studies.buffer import WORST
from strikewave.studies.buffer.mounting_site import (
    BaseMotion,
    Blows,
    GasketStack,
    MountingSite,
    blows_of,
    choose_sensor,
    mounting_site_of,
)
from strikewave.studies.buffer.result import BufferStudy, study_notices
from strikewave.studies.buffer.stacks import (
    BufferCandidate,
    BufferGoal,
    Leading,
    StackChoices,
    alike,
    all_stacks,
    assess,
    assess_mounting,
    distinct,
    look_closer,
    ranked,
    with_pareto,
    withstands,
)
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.questions import Answer, Failure, answers
from strikewave.studies.engine.runner import Advance, Workers, as_workers, share_reporter
from strikewave.studies.engine.store import RunStore, given_or_temporary, store_in

ALL_STACKS = StackChoices()
"""Stacks of the usual gaskets."""
MOST_STATES = 800
"""A stack with more states is left out of the search: its time grows faster than the square of their number
(measured: 0.5 s with 840 states, 3 s with 1680), where most stacks take 6 ms."""
LEADING = 10
"""First distinct ones of the ranking that are also tried with other moduli, besides the Pareto-optimal ones that
keep the limit. Chosen: as many as a screen shows; each takes up to 13 more runs."""


@dataclass(frozen=True, eq=False)
class _OfStack:
    """A stack under a sensor in a blow, of which something is asked."""

    site: MountingSite
    motion: BaseMotion
    goal: BufferGoal
    stack: GasketStack

    def text(self) -> str:
        """Return all that the answer depends on."""
        return f"{self.site} {self.motion.text} {self.goal} {self.stack}"


@dataclass(frozen=True, eq=False)
class AskedStack(_OfStack):
    """The reading of a sensor on a stack, as a `Question`."""

    answered_by: ClassVar[type] = BufferCandidate

    def answer(self) -> BufferCandidate:
        """Return what the sensor reads, and what the stack costs."""
        return assess(self.site, self.stack, self.motion, self.goal)


@dataclass(frozen=True, eq=False)
class AskedCloser(_OfStack):
    """The further numbers of a leading stack, as a `Question`."""

    answered_by: ClassVar[type] = Leading

    candidate: BufferCandidate

    def answer(self) -> Leading:
        """Return the sensitivity of the stack to its moduli, and the stress and strain of its gaskets."""
        return look_closer(self.site, self.candidate, self.motion, self.goal)


def design_buffer(
    site: MountingSite,
    blows: Blows,
    choice: StackChoices,
    goal: BufferGoal,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> BufferStudy:
    """Rank all stacks of a choice for a sensor, a blow, and a limit on what it may read."""
    every = all_stacks(choice)
    small = [stack for stack in every if not _too_large(site.mounting(stack))]
    with given_or_temporary(store) as open_store, pool or ProcessPool(1) as open_pool:
        asked = [AskedStack(site, blows.motion, goal, stack) for stack in small]
        candidates = _answered(answers(asked, open_store, open_pool, advance))
        order = ranked(with_pareto(candidates), goal, blows.motion.width)
        leading = _leading(order, site, blows.motion, goal)
        closer = [AskedCloser(site, blows.motion, goal, candidate.stack, candidate) for candidate in leading]
        closer_looks = dict(zip(map(id, leading), _answered(answers(closer, open_store, open_pool)), strict=True))
    looked_at = [dataclasses.replace(candidate, leading=closer_looks.get(id(candidate))) for candidate in order]
    order = ranked(looked_at, goal, blows.motion.width)  # again: what is robust is known now
    placed = tuple(dataclasses.replace(candidate, place=place) for place, candidate in enumerate(order, 1))
    verdicts = Verdicts([blows.verdict] if blows.verdict else [], "simulated runs")
    study = BufferStudy(site, blows, goal, _present(site, blows, goal), placed, verdicts=verdicts)
    return dataclasses.replace(study, notices=(*blows.warnings, *study_notices(study, len(every) - len(small))))


def _answered(outcomes: Sequence[Answer | Failure]) -> list[Answer]:
    """Return answers; what fails of one stack fails of all: the recorder does not fit the history."""
    for outcome in outcomes:
        if isinstance(outcome, Failure):
            raise InputErrors([outcome.reason])
    return [outcome for outcome in outcomes if not isinstance(outcome, Failure)]


def _present(site: MountingSite, blows: Blows, goal: BufferGoal) -> BufferCandidate | None:
    """Return what the sensor reads on the buffer that the case has now."""
    if site.present is None or _too_large(site.present.mounting):
        return None
    return assess_mounting(site, site.present.mounting, blows.motion, goal, site.present.name)


def _leading(
    order: Sequence[BufferCandidate], site: MountingSite, motion: BaseMotion, goal: BufferGoal
) -> list[BufferCandidate]:
    """Return the first distinct ones of a ranking and the Pareto-optimal ones, of which more is computed."""
    chosen = distinct(order, LEADING) + [candidate for candidate in order if candidate.pareto and candidate.keeps]
    if goal.rank == "robust":
        chosen += _withstanding(order, site, motion, goal)
    return list(dict.fromkeys(chosen))


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


@compiling_shown()
def buffer(
    case: Case,
    limit: str | float,
    *,
    sensor: str | None = None,
    blow: str | int = WORST,
    stacks: StackChoices = ALL_STACKS,
    rank: str = "bandwidth",
    workers: int | Workers | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> BufferStudy:
    """Rank stacks of gaskets under a sensor of a case, by what it then reads of a blow and what they pass.

    Parameters
    ----------
    case : Case
        A machine or a bar with the sensor.
    limit : str or float
        Largest allowed reading: with a unit, such as ``"5000 g"``, or in m/s^2.
    sensor : str, optional
        Name of the sensor, where the case has several.
    blow : str or int, optional
        Blow that the stacks are compared at: ``worst``, ``first`` or its number.
    stacks : StackChoices, optional
        Materials and thicknesses of the gaskets, and the largest number of them in a stack.
    rank : str, optional
        Criterion that ranks the stacks that keep the limit: ``bandwidth``, ``peak`` or ``robust``.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``; threads of this
        process where it is left out.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    BufferStudy
        Stacks that keep the reading below the limit, the best first.

    Raises
    ------
    InputError
        If the blow cannot be had, or no stack fits the sensor.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019-fig5")
    >>> stacks = strikewave.StackChoices(["PTFE"], ["1 mm"], layers=1)
    >>> study = strikewave.buffer(case, "7000 g", sensor="buffered", stacks=stacks)
    >>> [candidate.name for candidate in study.candidates]
    ['direct', 'PTFE 1 mm']
    """
    goal = BufferGoal(si_value(limit, "m/s^2", "limit"), rank)
    all_stacks(stacks)  # refuses too many before the case is run
    site = mounting_site_of(choose_sensor(case, sensor), case)
    blows = blows_of(case, site.table, str(blow))
    pool = as_workers(workers).pool()
    with store_in(store) as finished:
        study = design_buffer(site, blows, stacks, goal, finished, pool, share_reporter(progress))
    return dataclasses.replace(study, case=case)
