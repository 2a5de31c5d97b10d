"""The reproduction of Li & Ma 2019 as one result: runs, equations, published numbers, findings; document and table."""

from __future__ import annotations

import csv
import functools
import io
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from strikewave.analyses.fem.result import FemSolution
from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.result import Notice, Result, Source
from strikewave.base.shock_quantities import ACCELERATION, MEASURED_IMPULSE, MICROSECONDS, RATIO, STEP
from strikewave.base.units import DIMENSIONS, convertible, in_unit
from strikewave.papers.li_ma_2019.body_reasons import BodyRow, Reason, body_rows
from strikewave.papers.li_ma_2019.further import DimensionStudy, Further
from strikewave.papers.li_ma_2019.runs import Effort, Runs
from strikewave.papers.li_ma_2019.types import Consistency, EquationRow, Finding, PublishedNumber
from strikewave.papers.li_ma_2019.unknowns import GasketCell, JointCell, Unknowns
from strikewave.reporting.columns import Column
from strikewave.reporting.shown_result import ShownResult

PAPER = "li-ma-2019"
SEE_SI = Quantity.of_data("SI, see si")


@dataclass(frozen=True)
class Computed:
    """What a model says of a published number.

    Attributes
    ----------
    by : str
        Case, and what was changed in it.
    value : float or None
        SI; None where it gives none.
    role : str
        fitted: the case was adjusted to the published number; predicted; range: inputs that are not known leave it
        between `low` and `high`, `note` says which; shown: not comparable, `note` says why.
    note : str
    low, high : float or None
        Ends of a range, SI; ``value`` is then what the case makes of it with what it assumes.
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
    """What a model says of a published number, as documents have it."""

    value_si: float | None = declare.number(SEE_SI, "what it gives; null where it gives none")
    low_si: float | None = declare.number(SEE_SI, "low end of a range")
    high_si: float | None = declare.number(SEE_SI, "high end of a range")
    by: str = declare.word("case, and what was changed in it")
    role: str = declare.word("fitted, predicted, range, or shown: not comparable")
    note: str = declare.word("what leaves the range, or why it is not comparable")
    difference: float | None = declare.number(RATIO, "how far it is from the published number, relative to that")


@declare.dataclass
class NumberRow:
    """A published number, and what the models say of it.

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
            ModelAnswer(one.value, one.low, one.high, one.by, one.role, one.note, one.difference(self.number.value))
            for one in self.computed
        ]

    @property
    def best(self) -> Computed | None:
        """The first answer with a value: that of the case made for it."""
        return next((one for one in self.computed if one.value is not None), None)


@declare.dataclass
class RunChecks:
    """A run, and what its checks came to."""

    case: str = declare.word("name of the case")
    verdict: str = declare.word("what its checks came to")


@declare.dataclass
class ElementRun:
    """What a finite-element run took, and its balance errors."""

    case: str = declare.word("name of the case")
    elements: int = declare.count("how many")
    steps: int = declare.count("of time")
    step: float = declare.number(STEP, "smallest step")
    seconds: float = declare.number(Quantity("s", "s"), "that it took")
    energy_error: float = declare.number(RATIO, "what the balance of energy misses, as a share")
    hourglass_share: float = declare.number(RATIO, "energy in hourglass modes, as a share")
    momentum_error: float = declare.number(RATIO, "what the balance of momentum misses, as a share")


@declare.dataclass
class BodyNumbers:
    """What a simple model, or the elements, say of a blow."""

    case: str = declare.word("name of the case")
    model: str = declare.word("elements, lumped, layered, or layered with the sides hung")
    law: str = declare.word("of the line contact; empty of elements")
    peak: float = declare.number(declare.NOT_MEASURED, "of the force, N: the peaks of joints are accelerations")
    width: float = declare.number(MICROSECONDS, "from the first to the last tenth of the peak, gaps included")
    first_width: float = declare.number(MICROSECONDS, "until the force first falls below a tenth")
    pulses: int = declare.count("how often the force rises above a tenth of its peak")
    impulse: float = declare.number(MEASURED_IMPULSE, "of the force")
    rigid_peak: float = declare.number(ACCELERATION, "of the force over the mass of the struck object")
    watched_peak: float | None = declare.number(ACCELERATION, "of the sensor, or of the far end of a bar")


@declare.dataclass
class JointRow:
    """A pair of joints, and the first blow with it."""

    cell: JointCell = declare.part(JointCell, "the joints", inline=True)
    keeps_rigid_pulse: bool = declare.word("whether the rigid pulse stays as it is with the joints of the case")


@declare.dataclass
class Reproduction(ShownResult):
    """Everything that a reproduction came to; see `Result` for what it shares with others.

    Attributes
    ----------
    runs : Runs
    unknowns : Unknowns
        Maps over gaskets and joints, which are not published.
    further : Further
        Studies of the finite-element models.
    effort : Effort
        How much was run.
    """

    command: ClassVar[str] = "reproduce"

    main_rows: ClassVar[str] = "first_answers"

    runs: Runs

    @declare.computed(declare.word("what is reproduced"))
    def paper(self) -> str:
        """The paper."""
        return PAPER

    @declare.computed(declare.word("whether elements are coarse, and no studies were made"))
    def quick(self) -> bool:
        """Whether it is a quick one."""
        return self.runs.quick

    @declare.computed(declare.word("names of the cases that were run"))
    def cases(self) -> list[str]:
        """The cases that were run."""
        return [case.name for case in self.runs.cases]

    @declare.computed(declare.rows(RunChecks, "what the checks of the runs came to", key="runs"))
    def checked_runs(self) -> list[RunChecks]:
        """The runs, with what their checks came to."""
        return [RunChecks(*pair) for pair in self.runs.checked]

    equations: tuple[EquationRow, ...] = declare.rows(EquationRow, "equations", headline="count")
    numbers: tuple[NumberRow, ...] = declare.rows(NumberRow, "published numbers", key="published")

    @declare.phrase("published numbers computed", headline="published numbers computed")
    def computed(self) -> str:
        """Return how many of the published numbers a model answers."""
        return f"{sum(row.best is not None for row in self.numbers)} of {len(self.numbers)}"

    checks: tuple[Consistency, ...] = declare.rows(Consistency, "published numbers among each other", key="consistency")

    @declare.computed(declare.rows(ElementRun, "what the finite-element runs took"))
    def elements(self) -> list[ElementRun]:
        """The finite-element runs."""
        return [element_run(solution) for solution in self.runs.elements]

    @declare.computed(declare.word("the models on several meshes, by case"))
    def meshes(self) -> dict[str, list[dict[str, Any]]]:
        """The models on several meshes."""
        return {name: [declare.content(row) for row in rows] for name, rows in self.further.meshes.items()}

    @declare.computed(declare.rows(BodyNumbers, "the same bodies as elements, masses and layers", key="bodies"))
    def body_numbers(self) -> list[BodyNumbers]:
        """Masses on springs and layers beside the elements."""
        numbers = ("peak", "width", "first_width", "pulses", "impulse", "rigid_peak", "watched_peak")
        return [
            BodyNumbers(row.case, row.model, row.law, *(getattr(row.answer, name) for name in numbers))
            for row in self.bodies
        ]

    @declare.computed(declare.rows(Reason, "why they part"))
    def reasons(self) -> tuple[Reason, ...]:
        """Why masses and layers part from the elements."""
        return self.further.reasons

    @declare.computed(declare.rows(DimensionStudy, "what assumed dimensions do to the answers"))
    def dimensions(self) -> tuple[DimensionStudy, ...]:
        """What assumed dimensions do."""
        return self.further.dimensions

    findings: tuple[Finding, ...] = declare.rows(Finding, "what the paper gets right, and what not", headline="count")
    unknowns: Unknowns
    further: Further = field(default_factory=Further)
    effort: Effort = field(default_factory=Effort)

    @declare.computed(declare.rows(GasketCell, "the direct sensor over gaskets"))
    def gaskets(self) -> tuple[GasketCell, ...]:
        """The gaskets that were tried."""
        return self.unknowns.gaskets.cells

    @declare.computed(declare.rows(JointRow, "the sensor between two cylinders over its joints"))
    def joints(self) -> list[JointRow]:
        """The joints that were tried."""
        study = self.unknowns.joints
        return [JointRow(cell, cell.blow.keeps(study.assumed)) for cell in study.cells]

    def row(self, name: str) -> NumberRow:
        """Return a published number by its name."""
        return next(row for row in self.numbers if row.number.name == name)

    @property
    def title(self) -> str:
        """What is reproduced."""
        return "Li & Ma 2019, reproduced: equations, figures and published numbers"

    @property
    def source(self) -> Source:
        """What was asked."""
        return Source("paper", PAPER, marked_text(self.effort), "record.toml", asked=asked_command(self.effort))

    @functools.cached_property
    def bodies(self) -> list[BodyRow]:
        """Masses on springs and layers for the bodies of the finite-element models, beside these."""
        return body_rows(self.runs.elements)

    @property
    def named_units(self) -> dict[str, str]:
        """The unit of a peak that is a force, beside those that are accelerations."""
        return {"bodies.peak": "N"}

    @declare.computed(declare.table("published numbers with the first answer to each, SI of the unit beside them"))
    def first_answers(self) -> list[Column]:
        """The published numbers with the first answer to each."""
        numbers, best = [row.number for row in self.numbers], [row.best for row in self.numbers]
        differences = [one and one.difference(number.value) for one, number in zip(best, numbers, strict=True)]
        return [
            Column("name", [number.name for number in numbers], shown=""),
            Column("where", [number.where for number in numbers], shown=""),
            Column("quantity", [number.quantity for number in numbers]),
            Column("unit", [si_unit(number.unit) for number in numbers], shown=""),
            Column("published", [number.value for number in numbers], shown=""),
            Column("computed", [one and one.value for one in best], shown=""),
            Column("difference", differences, "1", shown=""),
            Column("role", [one and one.role for one in best], shown=""),
            Column("by", [one and one.by for one in best]),
        ]

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"reproduction.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return the table of published numbers."""
        return {"published.csv": self._number_table()}

    def _number_table(self) -> str:
        """Return published numbers and what was computed as CSV text, SI; a row an answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        heads = ["name", "where", "quantity", "origin", "SI unit", "published", "computed", "difference", "role", "by"]
        writer.writerow([*heads, "note", "low", "high"])
        for row in self.numbers:
            number = row.number
            begin = [number.name, number.where, number.quantity, number.origin, si_unit(number.unit), number.value]
            for one in row.computed or (Computed("", None, "", number.note),):
                cells = [
                    one.value,
                    one.difference(number.value),
                    one.role,
                    one.by,
                    one.note or number.note,
                    one.low,
                    one.high,
                ]
                writer.writerow([*begin, *("" if cell is None else cell for cell in cells)])
        return text.getvalue()


def notices_of(runs: Runs) -> tuple[Notice, ...]:
    """Return what the runs warn of, each with the name of its case."""
    results: list[Result] = [*runs.impacts, runs.bar, *runs.elements]
    return tuple(replace(notice, case=one.source.name) for one in results for notice in one.notices)


def marked_text(effort: Effort) -> str:
    """Return what was asked as TOML: another effort is another result."""
    switches = {"quick": effort.quick, "elements": effort.elements, "studies": effort.studies}
    return f'paper = "{PAPER}"\n' + "".join(f"{name} = {str(on).lower()}\n" for name, on in switches.items())


def asked_command(effort: Effort) -> str:
    """Return the command that gives the same result again."""
    chosen = (
        " --quick" * effort.quick
        + " --without elements" * (not effort.elements)
        + " --without studies" * (not effort.studies)
    )
    return f"strikewave reproduce {PAPER}{chosen}"


def si_unit(unit: str) -> str:
    """Return the SI unit of a unit that the paper writes; the same where there is none.

    Examples
    --------
    >>> si_unit("us"), si_unit("GPa"), si_unit("1"), si_unit("blows")
    ('s', 'Pa', '1', 'blows')
    """
    conversion = None if unit == "1" else convertible(unit, DIMENSIONS)
    return unit if conversion is None else conversion[0]


def element_run(solution: FemSolution) -> ElementRun:
    """Return what a finite-element run took, and its balance errors."""
    run, balance = solution.run, solution.measured_balance
    took = run.elements, run.steps, run.step, run.seconds
    return ElementRun(solution.case.name, *took, balance.energy, balance.hourglass, balance.momentum)
