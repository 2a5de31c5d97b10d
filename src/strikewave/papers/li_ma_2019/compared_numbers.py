"""The published numbers of Li & Ma 2019, each with the answers of the models."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.machine.result import Solution
from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import RATIO
from strikewave.base.units import DIMENSIONS, convertible, in_unit
from strikewave.papers.li_ma_2019.element_pulses import BodyPulse, body_pulse, specimen_body, struck_body
from strikewave.papers.li_ma_2019.published import PublishedNumber
from strikewave.papers.li_ma_2019.runs import NON_REFLECTING, QUIET_WAVE_ELEMENTS, WAVE_ELEMENTS, Runs
from strikewave.papers.li_ma_2019.unknowns import OpenRange

DIRECT_PEAK, BUFFERED_PEAK = "direct peak", "buffered peak"
RIGID_PEAK, RIGID_WIDTH = "rigid peak", "rigid width"
TYPICAL_PEAK, TYPICAL_WIDTH = "typical peak", "typical width"
DYNA_PEAK, DYNA_WIDTH, DYNA_FORCE = "rigid peak simulated", "rigid width simulated", "force simulated"
WAVE_PEAK, WAVE_WIDTH, DYNA_WAVE_PEAK = "wave peak", "wave width", "wave peak simulated"
SEVEN_BLOWS, SEVEN_WINDOW, ELEVEN_BLOWS = "comparison count", "comparison time", "count"
"""Names of the published numbers that runs are compared with; see `published_numbers`."""


IMPACTS = {
    DIRECT_PEAK: ("comparison", "first.sensor_peak", "direct"),
    BUFFERED_PEAK: ("comparison", "first.sensor_peak", "buffered"),
    SEVEN_BLOWS: ("comparison", "count", ""),
    SEVEN_WINDOW: ("comparison", "window", ""),
    ELEVEN_BLOWS: ("machine", "count", ""),
    TYPICAL_PEAK: ("machine", "typical.rigid_peak", ""),
    TYPICAL_WIDTH: ("machine", "typical.width", ""),
    RIGID_PEAK: ("machine", "first.rigid_peak", ""),
    RIGID_WIDTH: ("machine", "first.width", ""),
    DYNA_PEAK: ("machine", "first.rigid_peak", ""),
    DYNA_WIDTH: ("machine", "first.width", ""),
    DYNA_FORCE: ("machine", "first.peak_force", ""),
    WAVE_PEAK: ("fixture", "first.sensor_peak", "oscilloscope"),
    WAVE_WIDTH: ("fixture", "first.sensor_width", "oscilloscope"),
    DYNA_WAVE_PEAK: ("fixture", "first.sensor_peak", "oscilloscope"),
}
"""Run, quantity and sensor under which a machine case compares a published number."""
OF_THE_FIRST_BLOW = (RIGID_PEAK, RIGID_WIDTH, DYNA_PEAK, DYNA_WIDTH, DYNA_FORCE, WAVE_PEAK, WAVE_WIDTH, DYNA_WAVE_PEAK)
"""Published numbers of the first blow, with which a finite-element model can be compared."""
SAME_NUMBER = 1e-9
"""Relative difference up to which two published numbers are the same: rounding of their units."""


SEE_SI = Quantity.of_data("SI, see si")


def si_unit(unit: str) -> str:
    """Return the SI unit of a unit that the paper writes; the same where there is none.

    Examples
    --------
    >>> si_unit("us"), si_unit("GPa"), si_unit("1"), si_unit("blows")
    ('s', 'Pa', '1', 'blows')
    """
    conversion = None if unit == "1" else convertible(unit, DIMENSIONS)
    return unit if conversion is None else conversion[0]


@dataclass(frozen=True)
class Computed:
    """An answer of a model to a published number, SI; ``value`` is None where the model gives none.

    The role is fitted (the case was adjusted to the number), predicted, range (unknown inputs leave it between ``low``
    and ``high``, ``note`` says which; ``value`` then follows from the assumed ones) or shown (not comparable, ``note``
    says why). ``by`` is the case, with its changes.
    """

    by: str
    value: float | None
    role: str
    note: str = ""
    low: float | None = None
    high: float | None = None

    def difference(self, published: float) -> float | None:
        """Return how far it is from the published number, relative to that.

        Examples
        --------
        >>> Computed("case", 3.0, "predicted").difference(4.0)
        -0.25
        """
        return None if self.value is None or not published else self.value / published - 1.0

    def differences(self, published: float) -> tuple[float, float] | None:
        """Return how far the ends of its range are from the published number; None where it is no range.

        Examples
        --------
        >>> Computed("case", 3.0, "range", low=2.0, high=8.0).differences(4.0)
        (-0.5, 1.0)
        """
        if self.low is None or self.high is None or not published:
            return None
        return self.low / published - 1.0, self.high / published - 1.0


@declare.dataclass
class ModelAnswer:
    """An answer of a model to a published number in the form of documents."""

    value_si: float | None = declare.number(SEE_SI, "what it gives; null where it gives none")
    low_si: float | None = declare.number(SEE_SI, "low end of a range")
    high_si: float | None = declare.number(SEE_SI, "high end of a range")
    by: str = declare.word("case, and what was changed in it")
    role: str = declare.word("fitted, predicted, range, or shown: not comparable")
    note: str = declare.word("what leaves the range, or why it is not comparable")
    difference: float | None = declare.number(RATIO, "how far it is from the published number, relative to that")


@declare.dataclass
class NumberRow:
    """A published number with the answers of the models.

    Examples
    --------
    >>> number = PublishedNumber("window", "Figure 5", "time", 0.15, "ms", "measured")
    >>> document = declare.content(NumberRow(number, ()))
    >>> [document[key] for key in ("value_si", "si", "published_value", "published_unit")]
    [0.15, 's', 150.0, 'ms']
    """

    number: PublishedNumber = declare.part(PublishedNumber, "the number", inline=True)
    computed: tuple[Computed, ...]

    @declare.computed(declare.number(SEE_SI, "what is published"))
    def value_si(self) -> float:
        """The published number."""
        return self.number.value

    @declare.computed(declare.word("its SI unit"))
    def si(self) -> str:
        """The SI unit of the number."""
        return si_unit(self.number.unit)

    @declare.computed(declare.number(Quantity.of_data("see published_unit"), "it as the paper says it"))
    def published_value(self) -> float:
        """The number in the unit of the paper."""
        value, unit = self.number.value, self.number.unit
        return value if unit == self.si else float(f"{in_unit(value, self.si, unit):.12g}")

    @declare.computed(declare.word("unit in which the paper says it"))
    def published_unit(self) -> str:
        """The unit of the paper."""
        return self.number.unit

    @declare.computed(declare.rows(ModelAnswer, "what the models say of it", key="computed"))
    def answers(self) -> list[ModelAnswer]:
        """The answers of the models, with their differences."""
        return [
            ModelAnswer(row.value, row.low, row.high, row.by, row.role, row.note, row.difference(self.number.value))
            for row in self.computed
        ]

    @property
    def best(self) -> Computed | None:
        """The first answer with a value: that of the case made for it."""
        return next((answer for answer in self.computed if answer.value is not None), None)


def number_rows(
    published: Sequence[PublishedNumber], runs: Runs, ranges: Mapping[str, OpenRange]
) -> tuple[NumberRow, ...]:
    """Compare the runs with every published number, like for like first.

    The first answer to a number of LS-DYNA is that of the elements with the paper's own faces, then those with faces
    that reflect. The answer of a machine case to a number that has a range is that range.
    """
    rows = []
    for number in published:
        answers = list(_by_elements(number, runs))
        if number.name in IMPACTS:
            run, *place = IMPACTS[number.name]
            solution: Solution = getattr(runs, run)
            origin = "simulated" if number.origin == "simulated" else "measured"
            row = next(
                row
                for row in solution.published
                if [row.quantity, row.sensor, row.measured_or_simulated] == [*place, origin]
            )
            answer = Computed(solution.case.name, row.computed, row.role, row.note)
            if span := ranges.get(number.name):
                note = f"left open by {span.left_by}, which are not published"
                answer = replace(answer, role="range", note=note, low=span.low, high=span.high)
            # like for like: elements come first for a number of LS-DYNA, the machine for a measured one
            answers.insert(len(answers) if number.origin == "simulated" else 0, answer)
        rows.append(NumberRow(number, tuple(answers)))
    return tuple(rows)


def _by_elements(number: PublishedNumber, runs: Runs) -> Iterator[Computed]:
    """Yield the answers of finite-element models whose case compares the number."""
    alike = number.origin == "simulated"
    # those with the faces of the paper come first for its simulated numbers, the others for measured ones
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
