"""The reproduction of Li & Ma 2019 as one result: runs, equations, published numbers, findings; document and table."""

from __future__ import annotations

import csv
import functools
import io
import math
from dataclasses import asdict, dataclass, field, replace
from typing import Any, ClassVar

from strikewave.analyses.fem.result import FemSolution
from strikewave.base.json_document import without
from strikewave.base.result import Notice, Result, Source
from strikewave.base.units import DIMENSIONS, convertible, in_unit
from strikewave.papers.li_ma_2019.assumed import SHARE, DimensionStudy, MeshRow
from strikewave.papers.li_ma_2019.body_rows import BodyRow, body_rows
from strikewave.papers.li_ma_2019.further import Further
from strikewave.papers.li_ma_2019.joints import JointCell, JointStudy
from strikewave.papers.li_ma_2019.runs import Effort, Runs
from strikewave.papers.li_ma_2019.types import Consistency, EquationRow, Finding, PublishedNumber
from strikewave.papers.li_ma_2019.unknowns import Unknowns
from strikewave.reporting.columns import Column
from strikewave.reporting.shown_result import ShownResult, columns_of

PAPER = "li-ma-2019"
GASKET_UNITS = {
    "modulus": "Pa",
    "loss_factor": "1",
    "thickness": "m",
    "engagement": "m",
    "direct": "m/s^2",
    "rigid_peak": "m/s^2",
    "direct_ringing": "m/s^2",
    "buffered_ringing": "m/s^2",
}
"""Of a row of the map over gaskets."""
JOINT_UNITS = {"preload": "N", "stiffness": "N/m", "peak": "m/s^2", "width": "s", "rigid_width": "s"}
"""Of a row of the map over joints, beside those it shares with a gasket."""


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


@dataclass(frozen=True)
class NumberRow:
    """A published number, and what the models say of it."""

    number: PublishedNumber
    computed: tuple[Computed, ...]

    @property
    def best(self) -> Computed | None:
        """The first answer with a value: that of the case made for it."""
        return next((one for one in self.computed if one.value is not None), None)


@dataclass(frozen=True)
class Reproduction(ShownResult):
    """Everything that a reproduction came to; see `Result` for what it shares with others.

    Attributes
    ----------
    runs : Runs
    equations : tuple of EquationRow
    numbers : tuple of NumberRow
    checks : tuple of Consistency
        Published numbers among each other.
    findings : tuple of Finding
    unknowns : Unknowns
        Maps over gaskets and joints, which are not published.
    further : Further
        Studies of the finite-element models.
    effort : Effort
        How much was run.
    """

    command: ClassVar[str] = "reproduce"

    runs: Runs
    equations: tuple[EquationRow, ...]
    numbers: tuple[NumberRow, ...]
    checks: tuple[Consistency, ...]
    findings: tuple[Finding, ...]
    unknowns: Unknowns
    further: Further = field(default_factory=Further)
    effort: Effort = field(default_factory=Effort)

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

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        units = {
            "exact": "SI, see unit",
            "printed": "SI, see printed_unit, else unit",
            "corrected_value": "SI, see unit",
        }
        units |= {"value_si": "SI, see si", "published_value": "see published_unit"}
        units |= {"low_si": "SI, see si", "high_si": "SI, see si"} | GASKET_UNITS | JOINT_UNITS
        units |= {
            "value": "SI, see unit",
            "stated": "SI, see unit",
            "difference": "1",
            "deviation": "1",
            "step": "s",
            "seconds": "s",
        }
        return units | {"energy_error": "1", "hourglass_share": "1", "momentum_error": "1"}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head; numbers are SI."""
        runs = self.runs
        return {
            "paper": PAPER,
            "quick": runs.quick,
            "cases": [case.name for case in runs.cases],
            "runs": [{"case": name, "verdict": verdict} for name, verdict in runs.checked],
            "equations": [equation_document(row) for row in self.equations],
            "published": [number_document(row) for row in self.numbers],
            "consistency": [asdict(row) for row in self.checks],
            "elements": [element_document(solution) for solution in runs.elements],
            "meshes": {name: [mesh_document(row) for row in rows] for name, rows in self.further.meshes.items()},
            "bodies": [body_document(row) for row in self.bodies],
            "reasons": [{**asdict(row), "off": row.off} for row in self.further.reasons],
            "dimensions": [dimension_document(study) for study in self.further.dimensions],
            "findings": [asdict(row) for row in self.findings],
            "gaskets": [{**asdict(cell), "calm": cell.calm} for cell in self.unknowns.gaskets.cells],
            "joints": [joint_document(cell, self.unknowns.joints) for cell in self.unknowns.joints.cells],
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many equations and published numbers were computed, and what was found."""
        computed = sum(row.best is not None for row in self.numbers)
        return [
            ("equations", str(len(self.equations))),
            ("published numbers computed", f"{computed} of {len(self.numbers)}"),
            ("findings", str(len(self.findings))),
        ]

    def columns(self) -> list[Column]:
        """Return the published numbers with the first answer to each, SI of the unit beside them."""
        rows = []
        for row in self.numbers:
            number, best = row.number, row.best
            own = {
                "name": number.name,
                "where": number.where,
                "quantity": number.quantity,
                "unit": si_unit(number.unit),
            }
            difference = None if best is None else best.difference(number.value)
            answer = {"computed": best and best.value, "difference": difference, "role": best and best.role}
            rows.append({**own, "published": number.value, **answer, "by": best and best.by})
        return columns_of(rows, {"difference": "1"})

    def brief(self) -> dict[str, str]:
        """Return what is published, what was computed, and how far they differ."""
        return dict.fromkeys(("name", "where", "unit", "published", "computed", "difference", "role"), "")

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


def equation_document(row: EquationRow) -> dict[str, Any]:
    """Return an equation as a row of the JSON document."""
    return {**asdict(row), "deviation": row.deviation, "corrected_deviation": row.corrected_deviation}


def number_document(row: NumberRow) -> dict[str, Any]:
    """Return a published number with its answers as a row of the JSON document.

    Examples
    --------
    >>> number = PublishedNumber("window", "Figure 5", "time", 0.15, "ms", "measured")
    >>> document = number_document(NumberRow(number, ()))
    >>> [document[key] for key in ("value_si", "si", "published_value", "published_unit")]
    [0.15, 's', 150.0, 'ms']
    """
    number = row.number
    si = si_unit(number.unit)
    shown = number.value if number.unit == si else float(f"{in_unit(number.value, si, number.unit):.12g}")
    values = {"value_si": number.value, "si": si, "published_value": shown, "published_unit": number.unit}
    answers = [
        {
            **{"value_si": one.value, "low_si": one.low, "high_si": one.high},
            **without(asdict(one), "value", "low", "high"),
            "difference": one.difference(number.value),
        }
        for one in row.computed
    ]
    return {**without(asdict(number), "value", "unit"), **values, "computed": answers}


def joint_document(cell: JointCell, study: JointStudy) -> dict[str, Any]:
    """Return the first blow with a pair of joints; ``stiffness`` is None of rigid faces."""
    stiffness = cell.stiffness if math.isfinite(cell.stiffness) else None
    head = {"preload": cell.preload, "stiffness": stiffness}
    return {**head, **asdict(cell.blow), "keeps_rigid_pulse": cell.blow.keeps(study.assumed)}


def element_document(solution: FemSolution) -> dict[str, Any]:
    """Return what a finite-element run took, and its balance errors."""
    run, balance = solution.run, solution.measured_balance
    return {
        "case": solution.case.name,
        "elements": run.elements,
        "steps": run.steps,
        "step": run.step,
        "seconds": run.seconds,
        "energy_error": balance.energy,
        "hourglass_share": balance.hourglass,
        "momentum_error": balance.momentum,
    }


def mesh_document(row: MeshRow) -> dict[str, Any]:
    """Return a mesh of a model as a row of the JSON document."""
    return {**asdict(row), "answer": row.answer._asdict()}


def body_document(row: BodyRow) -> dict[str, Any]:
    """Return an answer beside the elements as a row of the JSON document."""
    numbers = ("peak", "width", "first_width", "pulses", "impulse", "rigid_peak", "watched_peak")
    return {
        "case": row.case,
        "model": row.model,
        "law": row.law,
        **{name: getattr(row.answer, name) for name in numbers},
    }


def dimension_document(study: DimensionStudy) -> dict[str, Any]:
    """Return what assumed dimensions do to the answer of a model."""
    rows = [
        {**asdict(row), "larger": row.larger._asdict(), "smaller": row.smaller._asdict(), "share": SHARE}
        for row in study.rows
    ]
    return {"case": study.case, "base": study.base._asdict(), "rows": rows}
