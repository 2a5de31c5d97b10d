"""What the runs say of each published number of Li & Ma 2019."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from strikewave.fem_solution import FemSolution
from strikewave.solution import Comparison, Solution
from strikewave.studies.reproduction.element_pulses import (
    BodyPulse,
    body_pulse,
    specimen_body,
    struck_body,
    whole_force,
)
from strikewave.studies.reproduction.result import Computed, NumberRow, si_unit
from strikewave.studies.reproduction.runs import (
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    WAVE_ELEMENTS,
    Runs,
)
from strikewave.studies.reproduction.types import PublishedNumber
from strikewave.units import in_unit

DIRECT_PEAK, BUFFERED_PEAK = "direct peak", "buffered peak"
RIGID_PEAK, RIGID_WIDTH = "rigid peak", "rigid width"
TYPICAL_PEAK, TYPICAL_WIDTH = "typical peak", "typical width"
DYNA_PEAK, DYNA_WIDTH, DYNA_FORCE = "rigid peak simulated", "rigid width simulated", "force simulated"
WAVE_PEAK, WAVE_WIDTH, DYNA_WAVE_PEAK = "wave peak", "wave width", "wave peak simulated"
SEVEN_BLOWS, SEVEN_WINDOW, ELEVEN_BLOWS = "comparison count", "comparison time", "count"


@dataclass(frozen=True)
class Impact:
    """Where a machine case compares a published number: of which runs, under which quantity and sensor."""

    runs: str
    quantity: str
    sensor: str = ""


@dataclass(frozen=True)
class Body:
    """Where models of hexahedra give a published number: cases, and what of the pulse of their body."""

    cases: tuple[str, ...]
    value: Callable[[FemSolution, BodyPulse], float]


def _peak(solution: FemSolution, pulse: BodyPulse) -> float:
    return pulse.measure.rigid_peak


def _width(solution: FemSolution, pulse: BodyPulse) -> float:
    return pulse.measure.width


def _force(solution: FemSolution, pulse: BodyPulse) -> float:
    """Return the peak of the contact force between the whole bodies, N."""
    found = whole_force(solution)
    return math.nan if found is None else float(found[1].max())


IMPACTS = {
    DIRECT_PEAK: Impact("comparison", "first.sensor_peak", "direct"),
    BUFFERED_PEAK: Impact("comparison", "first.sensor_peak", "buffered"),
    SEVEN_BLOWS: Impact("comparison", "count"),
    SEVEN_WINDOW: Impact("comparison", "window"),
    ELEVEN_BLOWS: Impact("machine", "count"),
    TYPICAL_PEAK: Impact("machine", "typical.rigid_peak"),
    TYPICAL_WIDTH: Impact("machine", "typical.width"),
    RIGID_PEAK: Impact("machine", "first.rigid_peak"),
    RIGID_WIDTH: Impact("machine", "first.width"),
    DYNA_PEAK: Impact("machine", "first.rigid_peak"),
    DYNA_WIDTH: Impact("machine", "first.width"),
    DYNA_FORCE: Impact("machine", "first.peak_force"),
    WAVE_PEAK: Impact("fixture", "first.sensor_peak", "oscilloscope"),
    WAVE_WIDTH: Impact("fixture", "first.sensor_width", "oscilloscope"),
    DYNA_WAVE_PEAK: Impact("fixture", "first.sensor_peak", "oscilloscope"),
}
RIGID, WAVE = (RIGID_ELEMENTS, QUIET_ELEMENTS), (WAVE_ELEMENTS, QUIET_WAVE_ELEMENTS)
BODIES = {
    RIGID_PEAK: Body(RIGID, _peak),
    RIGID_WIDTH: Body(RIGID, _width),
    DYNA_PEAK: Body(RIGID, _peak),
    DYNA_WIDTH: Body(RIGID, _width),
    DYNA_FORCE: Body(RIGID, _force),
    WAVE_PEAK: Body(WAVE, _peak),
    WAVE_WIDTH: Body(WAVE, _width),
    DYNA_WAVE_PEAK: Body(WAVE, _peak),
}


def number_rows(published: Sequence[PublishedNumber], runs: Runs) -> tuple[NumberRow, ...]:
    """Set what the runs say beside every published number; elements first where LS-DYNA gave it."""
    return tuple(NumberRow(number, tuple(_answers(number, runs))) for number in published)


def _answers(number: PublishedNumber, runs: Runs) -> Iterator[Computed]:
    bodies = list(_by_elements(number, runs))
    if number.origin == "simulated":
        yield from bodies
    place = IMPACTS.get(number.name)
    if place is not None:
        solution: Solution = getattr(runs, place.runs)
        row = _comparison(solution, place, number)
        yield Computed(solution.case.name, row.computed, row.role, row.note)
    if number.origin != "simulated":
        yield from bodies


def _comparison(solution: Solution, place: Impact, number: PublishedNumber) -> Comparison:
    """Return where a case compares a number; measured and simulated ones have a line each."""
    origin = "simulated" if number.origin == "simulated" else "measured"
    return next(
        row
        for row in solution.published
        if (row.quantity, row.sensor, row.measured_or_simulated) == (place.quantity, place.sensor, origin)
    )


def _by_elements(number: PublishedNumber, runs: Runs) -> Iterator[Computed]:
    place = BODIES.get(number.name)
    for solution in runs.elements:
        if place is not None and solution.case.name in place.cases:
            value = place.value(solution, element_pulse(solution))
            note = "coarse mesh" if runs.quick else ""
            yield Computed(solution.case.name, None if math.isnan(value) else value, _role(solution, number), note)


def _role(solution: FemSolution, number: PublishedNumber) -> str:
    """Return the role that the case of a model gives a number; where it gives none, what its fitted inputs say."""
    rows = [row for row in solution.case.published if row.origin == number.origin]
    stated = next((row.role for row in rows if math.isclose(row.value.si, number.value, rel_tol=1e-9)), None)
    if stated is not None:
        return stated
    notes = [value.note for value in solution.case.values().values() if value.provenance == "fitted"]
    return "fitted" if any(_text(number) in note and number.origin in note for note in notes) else "predicted"


def _text(number: PublishedNumber) -> str:
    """Return a number as the paper writes it, such as "4151.25 g"."""
    return f"{in_unit(number.value, si_unit(number.unit), number.unit):.8g} {number.unit}"


def element_pulse(solution: FemSolution) -> BodyPulse:
    """Return the pulse that a model was made for: of the specimen, or of the whole struck body."""
    find = specimen_body if solution.case.name in WAVE else struck_body
    return body_pulse(solution, find(solution))
