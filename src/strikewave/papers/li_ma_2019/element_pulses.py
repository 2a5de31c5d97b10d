"""Measures of a finite-element model: the pulse of its struck body, and the numbers that findings rest on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.run import PartMeasure, contact_measure, interval_means, mean_acceleration, mean_force, middles

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

Array = NDArray[np.float64]

SPECIMEN = "sensor"
"""Name of the part that stands for the tested specimen."""
SHELL = "shell"
"""Name of the part that stands for the cylinder shell in the frame."""
EARLY, LATE = (0.1, 0.3), (0.5, 0.9)
"""Shares of the peak between which the slope of the contact force is taken early, where the contact is elastic, and
late, where it is plastic; the ends and the top are left out, where a pulse bends."""


@dataclass(frozen=True)
class ElementNumbers:
    """Numbers of a run of finite elements, whole bodies; None where the run does not measure them."""

    peak_force: float | None = None
    """Largest force of the contact between striker and fixture, N."""
    rigid_peak: float | None = None
    """Largest acceleration of the whole struck body, its momentum rate over its mass, m/s^2."""
    width: float | None = None
    """Width of that pulse at 10 % of its peak, s."""
    impulse: float | None = None
    """Impulse of the contact force, N s."""
    momentum: float | None = None
    """Largest momentum of the struck body, N s."""
    slope_early: float | None = None
    """Slope of the rise of the contact force between 10 and 30 % of its peak, N/s."""
    slope_late: float | None = None
    """Slope of the rise of the contact force between 50 and 90 % of its peak, N/s."""
    section_peak: float | None = None
    """Largest acceleration of the mid section of the sensor, m/s^2."""
    mean_peak: float | None = None
    """Largest acceleration of the sensor, mean over the part, m/s^2."""
    plastic_strain: float | None = None
    """Largest equivalent plastic strain anywhere."""
    shell_stress: float | None = None
    """Largest von Mises stress of the cylinder shell in the frame, Pa."""


@dataclass(frozen=True)
class BodyPulse:
    """The blow that a body took: its history along the blow, and its peak and width.

    ``time`` counts from first touch, s; ``acceleration``, m/s^2, is a mean over the intervals of the histories.
    """

    name: str
    time: Array
    acceleration: Array
    measure: PartMeasure


def struck_body(solution: FemSolution) -> str:
    """Return the body that takes the blow: the first group, or else the heaviest part that is at rest before it."""
    run = solution.run
    if run.groups:
        return next(iter(run.groups))
    at_rest = [name for name, part in run.parts.items() if not part.velocity[0].any()] or list(run.parts)
    return max(at_rest, key=lambda name: run.parts[name].mass)


def body_pulse(solution: FemSolution, name: str) -> BodyPulse:
    """Return the rigid-body pulse of a part or group along its blow."""
    measure = {**solution.parts, **solution.groups}[name]
    along = mean_acceleration(solution.run, name) @ np.array(measure.direction)
    return BodyPulse(name, middles(solution.run.time) - first_touch(solution), along, measure)


def first_touch(solution: FemSolution) -> float:
    """Return when the first contact of the run begins, s; 0 where nothing touched."""
    contacts = [contact_measure(solution.run, name) for name in solution.run.force]
    return min((contact.begin for contact in contacts if contact is not None), default=0.0)


def specimen_body(solution: FemSolution) -> str:
    """Return the part that stands for the tested specimen, or the struck body where there is none."""
    return SPECIMEN if SPECIMEN in solution.run.parts else struck_body(solution)


def whole_force(solution: FemSolution) -> tuple[Array, Array, float] | None:
    """Return the force of the first contact between the whole bodies: s, N, and its impulse, N s; None without one."""
    run, name = solution.run, next(iter(solution.run.force), None)
    measure = None if name is None else contact_measure(run, name)
    if name is None or measure is None:
        return None
    return middles(run.time), np.linalg.norm(mean_force(run, name), axis=1), measure.impulse


def rise_slope(time: Array, values: Array, shares: tuple[float, float]) -> float:
    """Return how steeply a pulse first rises between two shares of its peak."""
    top = int(np.argmax(values))
    low, high = (share * float(values[top]) for share in shares)
    end = int(np.argmax(values[: top + 1] >= high))
    begin = int(np.flatnonzero(values[: end + 1] < low)[-1]) if (values[: end + 1] < low).any() else 0
    # interpolation needs ascending values, and a rise that rings falls now and then
    rising = np.maximum.accumulate(values[begin : end + 1])
    at = np.interp([low, high], rising, time[begin : end + 1])
    return float((high - low) / (at[1] - at[0])) if at[1] > at[0] else float("nan")


def element_numbers(solution: FemSolution) -> ElementNumbers:
    """Return the numbers of a model that findings rest on, of whole bodies."""
    body, run = struck_body(solution), solution.run
    pulse, force = body_pulse(solution, body), whole_force(solution)
    has_specimen = SPECIMEN in run.parts
    section = next(iter(run.sections.values()), None)
    along = np.array(pulse.measure.direction)
    return ElementNumbers(
        peak_force=None if force is None else float(force[1].max()),
        rigid_peak=pulse.measure.rigid_peak,
        width=pulse.measure.width,
        impulse=None if force is None else force[2],
        momentum=pulse.measure.velocity_change * pulse.measure.mass,
        slope_early=None if force is None else rise_slope(*force[:2], EARLY),
        slope_late=None if force is None else rise_slope(*force[:2], LATE),
        section_peak=None if section is None else float((interval_means(section.velocity, run.time) @ along).max()),
        mean_peak=body_pulse(solution, SPECIMEN).measure.rigid_peak if has_specimen else None,
        plastic_strain=max((float(values.max()) for values in run.plastic_strain.values()), default=None),
        shell_stress=float(run.von_mises[SHELL].max()) if SHELL in run.von_mises else None,
    )
