"""Elements beside masses on springs and layers of a bar for the same bodies: a table, and why they part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from strikewave.analyses.fem.result import FemSolution
from strikewave.cases.case import Case
from strikewave.cases.tables.mesh import FramePart, HalfCylinder
from strikewave.papers.li_ma_2019.bodies import LineLaw, SimpleAnswer, layered, lumped
from strikewave.papers.li_ma_2019.element_pulses import SPECIMEN
from strikewave.papers.li_ma_2019.solid_bars import element_answer

LAWS: tuple[LineLaw, ...] = ("palmgren", "johnson")


@dataclass(frozen=True)
class BodyRow:
    """An answer beside that of the elements.

    Attributes
    ----------
    case : str
        Name of the case.
    law : str
        Of the line contact; empty of elements.
    answer, elements : SimpleAnswer
    """

    case: str
    law: str
    answer: SimpleAnswer
    elements: SimpleAnswer

    @property
    def model(self) -> str:
        """elements, lumped, layered, or layered with the sides hung."""
        return self.answer.name

    def off(self, quantity: str) -> float | None:
        """Return how much an answer's ``quantity`` is above that of the elements, relative to it.

        Parameters
        ----------
        quantity : str
            peak, width, first_width, impulse, rigid_peak or watched_peak.
        """
        own, other = getattr(self.answer, quantity), getattr(self.elements, quantity)
        return None if own is None or other is None else float(own / other - 1.0)


def compare(case: Case, solution: FemSolution) -> tuple[BodyRow, ...]:
    """Set masses and layers beside elements; the first row is that of the elements.

    Parameters
    ----------
    case : Case
        What the simple answers are made from; see `frame_blow`.
    solution : FemSolution
        Of the same case; a coarser mesh or a shorter duration is taken as it is.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.analyses.fem.run import run_fem
    >>> from strikewave.papers.li_ma_2019.runs import coarser
    >>> case = load_case("li-ma-2019-fem-wave")
    >>> quick = load_case("li-ma-2019-fem-wave", [*coarser(case, 3.0), "fem.duration=40 us"])
    >>> rows = compare(quick, run_fem(quick))
    >>> [(row.model, row.law) for row in rows][:3]
    [('elements', ''), ('lumped', 'palmgren'), ('lumped', 'johnson')]
    """
    parts = solution.parts
    elements = element_answer(solution, parts[SPECIMEN].rigid_peak if SPECIMEN in parts else None)
    answers = [("", elements)]
    answers += [(law, lumped(case, law)) for law in LAWS]
    answers += [(law, layered(case, sides, law)) for sides in ("in the layers", "hung") for law in LAWS]
    return tuple(BodyRow(case.name, law, answer, elements) for law, answer in answers)


def body_rows(solutions: Sequence[FemSolution]) -> list[BodyRow]:
    """Return the table of all solutions that are a half-cylinder upon a frame without non-reflecting faces."""
    frame_blows = [one for one in solutions if _is_frame_blow(one.case)]
    return [row for one in frame_blows for row in compare(one.case, one)]


def _is_frame_blow(case: Case) -> bool:
    shapes = [type(part) for part in (case.mesh.part if case.mesh else ())]
    boundary_kinds = {row.kind for row in (case.fem.boundary if case.fem else ())} - {"symmetry"}
    return HalfCylinder in shapes and FramePart in shapes and not boundary_kinds
