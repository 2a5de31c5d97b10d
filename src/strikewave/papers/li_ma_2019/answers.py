"""Computed answers to each published number of Li & Ma 2019."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.machine.result import Solution
from strikewave.base.result import Comparison
from strikewave.papers.li_ma_2019.element_pulses import BodyPulse, body_pulse, specimen_body, struck_body
from strikewave.papers.li_ma_2019.result import Computed, NumberRow
from strikewave.papers.li_ma_2019.runs import NON_REFLECTING, QUIET_WAVE_ELEMENTS, WAVE_ELEMENTS, Runs
from strikewave.papers.li_ma_2019.types import PublishedNumber
from strikewave.papers.li_ma_2019.unknowns import OpenRange

DIRECT_PEAK, BUFFERED_PEAK = "direct peak", "buffered peak"
RIGID_PEAK, RIGID_WIDTH = "rigid peak", "rigid width"
TYPICAL_PEAK, TYPICAL_WIDTH = "typical peak", "typical width"
DYNA_PEAK, DYNA_WIDTH, DYNA_FORCE = "rigid peak simulated", "rigid width simulated", "force simulated"
WAVE_PEAK, WAVE_WIDTH, DYNA_WAVE_PEAK = "wave peak", "wave width", "wave peak simulated"
SEVEN_BLOWS, SEVEN_WINDOW, ELEVEN_BLOWS = "comparison count", "comparison time", "count"
"""Names of the published numbers that runs are compared with; see `published_numbers`."""


@dataclass(frozen=True)
class PublishedAnswer:
    """Where a machine case compares a published number: of which runs, under which quantity and sensor."""

    runs: str
    quantity: str
    sensor: str = ""


IMPACTS = {
    DIRECT_PEAK: PublishedAnswer("comparison", "first.sensor_peak", "direct"),
    BUFFERED_PEAK: PublishedAnswer("comparison", "first.sensor_peak", "buffered"),
    SEVEN_BLOWS: PublishedAnswer("comparison", "count"),
    SEVEN_WINDOW: PublishedAnswer("comparison", "window"),
    ELEVEN_BLOWS: PublishedAnswer("machine", "count"),
    TYPICAL_PEAK: PublishedAnswer("machine", "typical.rigid_peak"),
    TYPICAL_WIDTH: PublishedAnswer("machine", "typical.width"),
    RIGID_PEAK: PublishedAnswer("machine", "first.rigid_peak"),
    RIGID_WIDTH: PublishedAnswer("machine", "first.width"),
    DYNA_PEAK: PublishedAnswer("machine", "first.rigid_peak"),
    DYNA_WIDTH: PublishedAnswer("machine", "first.width"),
    DYNA_FORCE: PublishedAnswer("machine", "first.peak_force"),
    WAVE_PEAK: PublishedAnswer("fixture", "first.sensor_peak", "oscilloscope"),
    WAVE_WIDTH: PublishedAnswer("fixture", "first.sensor_width", "oscilloscope"),
    DYNA_WAVE_PEAK: PublishedAnswer("fixture", "first.sensor_peak", "oscilloscope"),
}
"""Published numbers that a machine case compares, each with where."""
OF_THE_FIRST_BLOW = (RIGID_PEAK, RIGID_WIDTH, DYNA_PEAK, DYNA_WIDTH, DYNA_FORCE, WAVE_PEAK, WAVE_WIDTH, DYNA_WAVE_PEAK)
"""Published numbers of the first blow, which a finite-element model can be compared with."""
SAME_NUMBER = 1e-9
"""Relative difference up to which two published numbers are the same one: rounding of their units."""


def number_rows(
    published: Sequence[PublishedNumber], runs: Runs, ranges: Mapping[str, OpenRange]
) -> tuple[NumberRow, ...]:
    """Compare the runs with every published number, like for like first.

    Where LS-DYNA gave it, these are the elements with the paper's own faces, then those with faces that reflect. What a
    machine case says of a number that has a range is that range.
    """
    return tuple(NumberRow(number, tuple(_answers(number, runs, ranges))) for number in published)


def _answers(number: PublishedNumber, runs: Runs, ranges: Mapping[str, OpenRange]) -> Iterator[Computed]:
    bodies = list(_by_elements(number, runs))
    if number.origin == "simulated":
        yield from bodies
    place = IMPACTS.get(number.name)
    if place is not None:
        solution: Solution = getattr(runs, place.runs)
        row = _comparison(solution, place, number)
        answer = Computed(solution.case.name, row.computed, row.role, row.note)
        span = ranges.get(number.name)
        if span is not None:
            note = f"left open by {span.left_by}, which are not published"
            answer = replace(answer, role="range", note=note, low=span.low, high=span.high)
        yield answer
    if number.origin != "simulated":
        yield from bodies


def _comparison(solution: Solution, place: PublishedAnswer, number: PublishedNumber) -> Comparison:
    """Return where a case compares a number; measured and simulated ones have a line each."""
    origin = "simulated" if number.origin == "simulated" else "measured"
    return next(
        row
        for row in solution.published
        if (row.quantity, row.sensor, row.measured_or_simulated) == (place.quantity, place.sensor, origin)
    )


def _by_elements(number: PublishedNumber, runs: Runs) -> Iterator[Computed]:
    """Yield the answers of finite-element models whose case compares the number; coarse meshes keep the role."""
    alike = number.origin == "simulated"
    models = sorted(runs.elements, key=lambda solution: (solution.case.name in NON_REFLECTING) != alike)
    for solution in models if number.name in OF_THE_FIRST_BLOW else ():
        for entry, row in zip(solution.case.published, solution.published, strict=True):
            same = math.isclose(row.published, number.value, rel_tol=SAME_NUMBER)
            if same and row.measured_or_simulated == number.origin:
                note = "; ".join(filter(None, ["coarse mesh" if runs.quick else "", entry.note]))
                yield Computed(solution.case.name, row.computed, entry.role, note)


def element_pulse(solution: FemSolution) -> BodyPulse:
    """Return the pulse that a model was made for: of the specimen, or of the whole struck body."""
    body_of = specimen_body if solution.case.name in (WAVE_ELEMENTS, QUIET_WAVE_ELEMENTS) else struck_body
    return body_pulse(solution, body_of(solution))
