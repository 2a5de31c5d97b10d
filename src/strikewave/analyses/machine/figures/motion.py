"""What a picture that moves needs of a run of the rotary machine: places over time, and histories with their peaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.figures.geometry import Outlines, Pose, outlines
from strikewave.reporting.curves import thin

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution
    from strikewave.machines import Blow

Array = NDArray[np.float64]

BEFORE, AFTER = 1e-3, 2e-3
"""What is shown about a blow: before and after its first touch, s."""
MOST_DETAILED = 20
"""Blows that can be looked at closely; of more the first, the odd ones and an even choice of the rest."""
WHOLE_PLACES, BLOW_PLACES = 1200, 100
"""Times at which places are kept: over the whole run, and about each blow."""
WHOLE_COLUMNS, PULSE_COLUMNS, REST_COLUMNS = 1000, 180, 50
"""Columns into which a history is gathered, its smallest and largest sample of each kept: the whole run; the pulse of
a blow; what comes after it."""
PULSE_WIDTHS = 2.0
"""Widths of a pulse, from first touch, that are kept as a pulse."""


class TimeHistory(NamedTuple):
    """A history: times after the valve signal, s, and values."""

    time: Array
    values: Array

    def at(self, time: float) -> float:
        """Return the value at a time, on the line between its neighbours."""
        return float(np.interp(time, self.time, self.values)) if self.time.size else 0.0


class NearBlow(NamedTuple):
    """A blow from near by: what it was, when it is shown, contact force (N) and rigid-body acceleration (m/s^2)."""

    blow: Blow
    begin: float
    end: float
    force: TimeHistory
    acceleration: TimeHistory


@dataclass(frozen=True)
class MachineMotion:
    """A run as it moves.

    Attributes
    ----------
    made : Outlines
        What is drawn.
    time : ndarray
        Times at which places are kept, s after the valve signal.
    angle, speed : ndarray
        Of the turntable, rad and rad/s.
    nose, assembly, carriage : ndarray
        Places, m; see `Pose`.
    force, acceleration : TimeHistory
        Contact force and rigid-body acceleration over the whole run.
    blows : tuple of Blow
        All of them.
    near : tuple of NearBlow
        Those that can be looked at closely.
    """

    made: Outlines
    time: Array
    angle: Array
    speed: Array
    nose: Array
    assembly: Array
    carriage: Array
    force: TimeHistory
    acceleration: TimeHistory
    blows: Sequence[Blow]
    near: tuple[NearBlow, ...]

    def pose(self, time: float) -> Pose:
        """Return where everything is at a time."""
        tracks = (self.angle, self.nose, self.assembly, self.carriage)
        return Pose(*(float(np.interp(time, self.time, track)) for track in tracks))

    @property
    def rest(self) -> float:
        """Place of the nose at rest with the object fed, m."""
        return -self.made.geometry.engagement


def machine_motion(solution: Solution) -> MachineMotion | None:
    """Return what moves in a run of the rotary machine; None for any other case."""
    outline = outlines(solution.case)
    if outline is None:
        return None
    data = solution.arrays
    time = data["time"].values
    near = tuple(_near(solution, row) for row in detailed(solution.blows))
    rows = _kept_rows(time, near)
    return MachineMotion(
        made=outline,
        time=time[rows],
        angle=data["turntable_angle"].values[rows],
        speed=data["turntable_speed"].values[rows],
        nose=data["nose_position"].values[rows],
        assembly=data["assembly_position"].values[rows],
        carriage=data["carriage_position"].values[rows],
        force=TimeHistory(*thin(time, data["contact_force"].values, WHOLE_COLUMNS)),
        acceleration=TimeHistory(*thin(time, data["rigid_acceleration"].values, WHOLE_COLUMNS)),
        blows=solution.blows,
        near=near,
    )


def detailed(blows: Sequence[Blow]) -> list[int]:
    """Return the rows of the blows that can be looked at closely."""
    if len(blows) <= MOST_DETAILED:
        return list(range(len(blows)))
    odd = [row for row, blow in enumerate(blows) if blow.kind != "full"][: MOST_DETAILED // 2]
    rest = np.linspace(0, len(blows) - 1, MOST_DETAILED - len(odd)).round().astype(int)
    return sorted({*odd, *rest.tolist()})


def _near(solution: Solution, row: int) -> NearBlow:
    """Return a blow from near by: samples of the whole run, and those of its pulse where it has one."""
    blow, time = solution.blows[row], solution.arrays["time"].values
    begin, end = max(blow.time - BEFORE, 0.0), min(blow.time + AFTER, float(time[-1]))
    force = _joined(solution, row, (begin, end), "contact_force", "pulse_force")
    acceleration = _joined(solution, row, (begin, end), "rigid_acceleration", "pulse_acceleration")
    return NearBlow(blow, begin, end, force, acceleration)


def _joined(solution: Solution, row: int, shown: tuple[float, float], train: str, pulse_name: str) -> TimeHistory:
    """Return a history about a blow, its pulse sampled as finely as the solution keeps it."""
    data, begun = solution.arrays, solution.blows[row].time
    time = data["time"].values
    rows = slice(*np.searchsorted(time, shown))
    coarse, values = time[rows], data[train].values[rows]
    fine, pulsed = begun + data["pulse_time"].values, data[pulse_name].values[row]
    known = np.isfinite(pulsed) & (fine >= shown[0]) & (fine <= shown[1])
    if not known.any():
        return TimeHistory(*thin(coarse, values, PULSE_COLUMNS))
    fine, pulsed = fine[known], pulsed[known]
    width = solution.blows[row].width
    within = fine <= begun + (PULSE_WIDTHS * width if width > 0.0 else AFTER)
    parts = [TimeHistory(coarse[coarse < fine[0]], values[coarse < fine[0]])]
    parts += [TimeHistory(*thin(fine[within], pulsed[within], PULSE_COLUMNS))]
    parts += [TimeHistory(*thin(fine[~within], pulsed[~within], REST_COLUMNS))] if not within.all() else []
    parts += [TimeHistory(coarse[coarse > fine[-1]], values[coarse > fine[-1]])]
    whole = [TimeHistory(*thin(*part, PULSE_COLUMNS)) if part.time.size else part for part in parts]
    return TimeHistory(np.concatenate([part.time for part in whole]), np.concatenate([part.values for part in whole]))


def _kept_rows(time: Array, near: tuple[NearBlow, ...]) -> NDArray[np.int64]:
    """Return the rows at which places are kept: evenly over the run, more densely about blows."""
    wanted = [np.linspace(0.0, time[-1], min(WHOLE_PLACES, time.size))]
    wanted += [np.linspace(one.begin, one.end, BLOW_PLACES) for one in near]
    rows = np.searchsorted(time, np.concatenate(wanted)).clip(0, time.size - 1)
    return np.unique(rows)
