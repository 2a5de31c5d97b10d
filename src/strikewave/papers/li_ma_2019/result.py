"""The reproduction of Li & Ma 2019 as one result: runs, equations, published numbers, findings; document and table."""

from __future__ import annotations

import csv
import functools
import io
from dataclasses import field, replace
from typing import Any, ClassVar

from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.result import Notice, Result, Source
from strikewave.base.shock_quantities import RATIO, STEP
from strikewave.papers.li_ma_2019.body_reasons import BodyRow, Reason, body_rows
from strikewave.papers.li_ma_2019.compared_numbers import Computed, NumberRow, si_unit
from strikewave.papers.li_ma_2019.element_studies import DimensionStudy, ElementStudies
from strikewave.papers.li_ma_2019.equations import EquationRow
from strikewave.papers.li_ma_2019.findings import Finding
from strikewave.papers.li_ma_2019.published import Consistency
from strikewave.papers.li_ma_2019.runs import Effort, Runs
from strikewave.papers.li_ma_2019.unknowns import GasketCell, JointCell, Unknowns
from strikewave.reporting.columns import Column
from strikewave.reporting.shown_result import ShownResult

PAPER = "li-ma-2019"


@declare.dataclass
class RunChecks:
    """A run, and the verdict of its checks."""

    case: str = declare.word("name of the case")
    verdict: str = declare.word("what its checks came to")


@declare.dataclass
class ElementRun:
    """The cost of a finite-element run, and its balance errors."""

    case: str = declare.word("name of the case")
    elements: int = declare.count("how many")
    steps: int = declare.count("of time")
    step: float = declare.number(STEP, "smallest step")
    seconds: float = declare.number(Quantity("s", "s"), "that it took")
    energy_error: float = declare.number(RATIO, "what the balance of energy misses, as a share")
    hourglass_share: float = declare.number(RATIO, "energy in hourglass modes, as a share")
    momentum_error: float = declare.number(RATIO, "what the balance of momentum misses, as a share")


@declare.dataclass
class JointRow:
    """A pair of joints, and the first blow with it."""

    cell: JointCell = declare.part(JointCell, "the joints", inline=True)
    keeps_rigid_pulse: bool = declare.word("whether the rigid pulse stays as it is with the joints of the case")


@declare.dataclass
class Reproduction(ShownResult):
    """Everything that a reproduction computes."""

    command: ClassVar[str] = "reproduce"

    main_rows: ClassVar[str] = "first_answers"

    runs: Runs

    @declare.computed(declare.word("what is reproduced"))
    def paper(self) -> str:
        """The paper."""
        return PAPER

    @declare.computed(declare.word("whether elements are coarse, and no studies were made"))
    def quick(self) -> bool:
        """True for coarse elements without studies."""
        return self.runs.quick

    @declare.computed(declare.word("names of the cases that were run"))
    def cases(self) -> list[str]:
        """The cases that were run."""
        return [case.name for case in self.runs.cases]

    @declare.computed(declare.rows(RunChecks, "what the checks of the runs came to", key="runs"))
    def checked_runs(self) -> list[RunChecks]:
        """The runs, with the verdicts of their checks."""
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
        rows = []
        for solution in self.runs.elements:
            run, balance = solution.run, solution.measured_balance
            cost = run.elements, run.steps, run.step, run.seconds
            rows.append(ElementRun(solution.case.name, *cost, balance.energy, balance.hourglass, balance.momentum))
        return rows

    @declare.computed(declare.word("the models on several meshes, by case"))
    def meshes(self) -> dict[str, list[dict[str, Any]]]:
        """The models on several meshes."""
        return {name: [declare.content(row) for row in rows] for name, rows in self.element_studies.meshes.items()}

    @declare.computed(declare.rows(BodyRow, "the same bodies as elements, masses and layers", key="bodies"))
    def body_numbers(self) -> list[BodyRow]:
        """Masses on springs and layers beside the elements."""
        return self.bodies

    @declare.computed(declare.rows(Reason, "why they part"))
    def reasons(self) -> tuple[Reason, ...]:
        """Reasons why masses and layers differ from the elements."""
        return self.element_studies.reasons

    @declare.computed(declare.rows(DimensionStudy, "what assumed dimensions do to the answers"))
    def dimensions(self) -> tuple[DimensionStudy, ...]:
        """Effects of assumed dimensions."""
        return self.element_studies.dimensions

    findings: tuple[Finding, ...] = declare.rows(Finding, "what the paper gets right, and what not", headline="count")
    unknowns: Unknowns
    element_studies: ElementStudies = field(default_factory=ElementStudies)
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
        """Title of the reproduction."""
        return "Li & Ma 2019, reproduced: equations, figures and published numbers"

    @property
    def source(self) -> Source:
        """Source: the paper and the command line that reproduces it."""
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
        differences = [answer and answer.difference(number.value) for answer, number in zip(best, numbers, strict=True)]
        return [
            Column("name", [number.name for number in numbers], shown=""),
            Column("where", [number.where for number in numbers], shown=""),
            Column("quantity", [number.quantity for number in numbers]),
            Column("unit", [si_unit(number.unit) for number in numbers], shown=""),
            Column("published", [number.value for number in numbers], shown=""),
            Column("computed", [answer and answer.value for answer in best], shown=""),
            Column("difference", differences, "1", shown=""),
            Column("role", [answer and answer.role for answer in best], shown=""),
            Column("by", [answer and answer.by for answer in best]),
        ]

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"reproduction.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return published numbers and what was computed as CSV text, SI; a row an answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        heads = ["name", "where", "quantity", "origin", "SI unit", "published", "computed", "difference", "role", "by"]
        writer.writerow([*heads, "note", "low", "high"])
        for row in self.numbers:
            number = row.number
            begin = [number.name, number.where, number.quantity, number.origin, si_unit(number.unit), number.value]
            for answer in row.computed or (Computed("", None, "", number.note),):
                cells = [answer.value, answer.difference(number.value), answer.role, answer.by]
                cells += [answer.note or number.note, answer.low, answer.high]
                writer.writerow([*begin, *("" if cell is None else cell for cell in cells)])
        return {"published.csv": text.getvalue()}


def notices_of(runs: Runs) -> tuple[Notice, ...]:
    """Return the notices of the runs, each with the name of its case."""
    results: list[Result] = [*runs.impacts, runs.bar, *runs.elements]
    return tuple(replace(notice, case=result.source.name) for result in results for notice in result.notices)


def marked_text(effort: Effort) -> str:
    """Return the request as TOML: another effort is another result."""
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
