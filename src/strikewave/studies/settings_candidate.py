"""A setting of the rotary machine as full runs show it: what the blows are, and which limits it keeps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.case import Case
from strikewave.contact import Geometry, first_yield, stiffness_law
from strikewave.machines import Blow, RotaryRun
from strikewave.machines.blows import contact_table
from strikewave.materials import Material, material
from strikewave.notices import LEDGER_LIMIT
from strikewave.studies.settings_estimate import disc_stress, rim_speed_at_yield

Array = NDArray[np.float64]

WITHIN = 0.05
"""Largest miss of peak, width and interval of a setting that meets the goal."""
STRETCH_SHARE = 0.1
"""Largest stretch of the mount by the striker's circling, over the engagement: the reach of the noses grows by it."""
LARGEST_DROP = 0.05
"""Largest share of the set speed by which a blow may find the turntable slower."""
LARGEST_SCATTER = 0.05
"""Largest standard deviation of the peaks over their mean."""
SAMPLE_STEP = 20e-6
"""Step at which the stop's force and the turntable's speed are read between blows, s."""


@dataclass(frozen=True)
class Goal:
    """What the blows shall be, SI; ``disc`` carries the strikers, ``stop_limit`` is the largest force of the stop."""

    interval: float
    peak: float
    width: float
    disc: Material
    stop_limit: float | None = None


class Spread(NamedTuple):
    """A quantity over the blows: that of the typical one, of the first, of the one farthest from the goal; scatter.

    ``typical`` is the median of the later full blows (of all struck ones where no later one is full), ``variation`` the
    standard deviation of all struck ones over their mean.
    """

    typical: float
    first: float
    worst: float
    variation: float


class Limit(NamedTuple):
    """A value beside its limit; one that does not decide is only warned of."""

    name: str
    value: float
    limit: float
    unit: str
    decides: bool = True

    @property
    def kept(self) -> bool:
        """Whether the value is at most the limit."""
        return bool(self.value <= self.limit)


class Supply(NamedTuple):
    """What stop and drive bear between the first blow and the retraction.

    Largest force of the stop, N; largest loss of speed to a blow, and what was regained between the last two, rad/s;
    slowest speed that a blow found, rad/s.
    """

    stop_force: float
    speed_lost: float
    speed_regained: float
    slowest: float


@dataclass(frozen=True)
class Observation:
    """What a full run of a setting showed; SI."""

    peak: Spread
    width: Spread
    interval: Spread
    kinds: tuple[str, ...]
    touched_again: int
    wanted: int
    approach: float
    velocity_change: float
    peak_force: float
    retreat: float
    supply: Supply
    energy_error: float

    @property
    def odd(self) -> str:
        """What is wrong with the blows, in words; empty where all wanted ones came and were full."""
        counts = {kind: self.kinds.count(kind) for kind in ("missed", "double", "glancing") if kind in self.kinds}
        words = [f"{number} {kind}" for kind, number in counts.items()]
        again = self.touched_again - counts.get("double", 0)
        words += [f"{again} touched again on the way back"] if again > 0 else []
        struck = len(self.kinds) - counts.get("missed", 0)
        return ", ".join(words + ([f"{struck} blows instead of {self.wanted}"] if struck != self.wanted else []))


@dataclass(frozen=True, eq=False)
class Candidate:
    """A setting: its case, what its full run showed, the limits, and how many runs were needed.

    ``estimate`` holds the closed forms it began with, ``halt`` what the search stood still at, in words.
    """

    case: Case
    chosen: tuple[str, ...]
    seen: Observation
    goal: Goal
    limits: tuple[Limit, ...]
    estimate: dict[str, float]
    runs: int
    halt: str = ""

    @property
    def misses(self) -> dict[str, float]:
        """Relative misses of the typical blow."""
        return misses(self.seen, self.goal)

    @property
    def largest_miss(self) -> float:
        """Largest of the misses, infinite where one has no number."""
        return max((abs(miss) if math.isfinite(miss) else math.inf) for miss in self.misses.values())

    @property
    def broken(self) -> tuple[Limit, ...]:
        """Limits that decide and are not kept."""
        return tuple(limit for limit in self.limits if limit.decides and not limit.kept)

    @property
    def meets(self) -> bool:
        """Whether the typical blow is within 5 % of the goal, every blow full, and every limit kept."""
        return self.largest_miss <= WITHIN and not self.seen.odd and not self.broken

    @property
    def obstacles(self) -> str:
        """What stands between the setting and the goal, in words."""
        words = [f"{name} off by {miss:+.1%}" for name, miss in self.misses.items() if not abs(miss) <= WITHIN]
        words += [self.seen.odd] if self.seen.odd else []
        words += [f"{limit.name.replace('_', ' ')} above its limit" for limit in self.broken]
        return "; ".join(words + ([self.halt] if self.halt and words else []))


def misses(seen: Observation, goal: Goal) -> dict[str, float]:
    """Return the relative misses of the typical blow: peak, width, interval."""
    return {name: getattr(seen, name).typical / getattr(goal, name) - 1.0 for name in ("peak", "width", "interval")}


def rank_key(candidate: Candidate) -> tuple[bool, float, float]:
    """Return what candidates are ordered by.

    First those that meet the goal, by the scatter of their peaks in steps of 0.1 %, then by the force of the stop; then
    the others by how far they are from it, a broken limit or odd blows counting as 100 %.
    """
    if candidate.meets:
        return False, round(candidate.seen.peak.variation, 3), candidate.seen.supply.stop_force
    far = candidate.largest_miss + len(candidate.broken) + bool(candidate.seen.odd)
    return True, far, candidate.seen.supply.stop_force


def observe_blows(run: RotaryRun, found: Sequence[Blow], goal: Goal) -> Observation | None:
    """Return what a run showed; None where no striker touched the object."""
    struck = [blow for blow in found if blow.kind != "missed"]
    if not struck:
        return None
    times = [blow.time for blow in struck]
    gaps = [later - earlier for earlier, later in pairwise(times)] or [goal.interval]
    full = [blow.kind == "full" for blow in struck]
    return Observation(
        peak=_spread([blow.rigid_peak for blow in struck], full, goal.peak),
        width=_spread([blow.width for blow in struck], full, goal.width),
        interval=Spread(median(gaps), gaps[0], _farthest(gaps, goal.interval), _variation(gaps)),
        kinds=tuple(blow.kind for blow in found),
        touched_again=_touched_again(run, [blow.width for blow in struck]),
        wanted=run.machine.feed.blows,
        approach=median(blow.approach_speed for blow in struck),
        velocity_change=median(blow.velocity_change for blow in struck),
        peak_force=max(blow.peak_force for blow in struck),
        retreat=max(blow.retreat for blow in struck),
        supply=supply(run, times),
        energy_error=run.energy_error,
    )


def _touched_again(run: RotaryRun, widths: Sequence[float]) -> int:
    """Return how many blows have a contact more than a pulse width after the one before it.

    Such a blow is called double where that carries a tenth of the impulse; lighter ones count here too.
    """
    table = contact_table(run)
    groups = [table[table[:, 4] == passing, :2] for passing in np.unique(table[:, 4])]
    late = [np.any(rows[1:, 0] - rows[:-1, 1] > width) for rows, width in zip(groups, widths, strict=True)]
    return int(sum(late))


def _spread(values: Sequence[float], full: Sequence[bool], goal: float) -> Spread:
    later = [value for value, counts in zip(values[1:], full[1:], strict=True) if counts] or values
    known = [value for value in later if math.isfinite(value)]
    return Spread(median(known) if known else math.nan, values[0], _farthest(values, goal), _variation(values))


def _farthest(values: Sequence[float], goal: float) -> float:
    return max(values, key=lambda value: abs(value - goal) if math.isfinite(value) else math.inf)


def _variation(values: Sequence[float]) -> float:
    """Return standard deviation over mean."""
    return float(np.std(values) / np.mean(values))


def supply(run: RotaryRun, touches: Sequence[float]) -> Supply:
    """Return what stop and drive bear from the first touch to the retraction; see `Supply`.

    The force of the stop is that of `StruckObject`: k d + c d', never negative, d = compression at rest - (x + q).
    """
    struck = run.machine.struck
    end = dict(run.phases)["retract"]
    times = np.arange(touches[0], max(end, touches[-1]) + SAMPLE_STEP, SAMPLE_STEP)
    moments = run.sample(np.minimum(times, run.end))
    deep = struck.stop_compression - moments.assembly_place - run.machine.engagement
    force = struck.stop_stiffness * deep - struck.stop_damping * moments.assembly_speed
    speed = moments.turntable_speed
    found = np.searchsorted(times, touches)
    edges = [*found, times.size]
    slow = [float(speed[a:b].min()) for a, b in pairwise(edges) if b > a]
    before = [float(speed[k]) for k in found[: len(slow)]]
    return Supply(
        stop_force=float(np.max(force[deep > 0.0], initial=0.0)),
        speed_lost=max(first - low for first, low in zip(before, slow, strict=True)),
        speed_regained=before[-1] - slow[-2] if len(slow) > 1 else math.nan,
        slowest=min(before),
    )


def limits_of(case: Case, run: RotaryRun, seen: Observation, goal: Goal) -> tuple[Limit, ...]:
    """Return the values of a setting that have a limit.

    The mean torque is what makes good the speed lost, J dw/T, and the drag at set speed.
    """
    machine, disc = run.machine, run.machine.turntable
    striker, strength = case.rig().striker, goal.disc.yield_strength or math.nan
    circling = striker.mass.si * disc.speed**2
    stretch = circling * disc.radius / (striker.mount_stiffness.si - circling)
    torque = disc.inertia * seen.supply.speed_lost / goal.interval + disc.drag * disc.speed
    found = [
        Limit("rim_speed", disc.speed * disc.radius, rim_speed_at_yield(goal.disc, strength), "m/s"),
        Limit("disc_stress", disc_stress(goal.disc, disc.speed, disc.radius), strength, "Pa"),
        Limit("mount_stretch", stretch, STRETCH_SHARE * machine.engagement, "m"),
        Limit("retreat", seen.retreat, machine.feed.stroke, "m"),
        Limit("mean_torque", torque, disc.torque, "N m"),
        Limit("speed_drop", 1.0 - seen.supply.slowest / disc.speed, LARGEST_DROP, "1"),
        Limit("peak_scatter", seen.peak.variation, LARGEST_SCATTER, "1"),
        Limit("energy_error", seen.energy_error, LEDGER_LIMIT, "1"),
    ]
    if goal.stop_limit is not None:
        found.append(Limit("stop_force", seen.supply.stop_force, goal.stop_limit, "N"))
    load = yield_load(case)
    if load is not None:
        found.append(Limit("contact_force", seen.peak_force, load, "N", decides=False))
    return tuple(found)


def yield_load(case: Case) -> float | None:
    """Return the load at which the contact first yields inside, N; None where that is modelled, or not known."""
    rig = case.rig()
    if rig.contact.yield_pressure is not None:
        return None
    length = rig.striker.contact_length.si if "length" in stiffness_law(rig.contact.law).needs else None
    pair = material(rig.striker.material), material(rig.object.material)
    first = first_yield(*pair, Geometry(rig.striker.nose_radius.si, math.inf, length))
    return None if first is None else first.load
