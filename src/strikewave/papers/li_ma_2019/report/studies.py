"""Tables of what the element models depend on: meshes, assumed dimensions, blows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from strikewave.base.percents import percent
from strikewave.base.shock_quantities import ACCELERATION, ENERGY, FORCE, IMPULSE, MICROSECONDS
from strikewave.fem.blow_measures import blow_measure
from strikewave.papers.li_ma_2019.assumed import SHARE, Answer, MeshRow
from strikewave.papers.li_ma_2019.body_reasons import Reason
from strikewave.reporting.faces import columns_of
from strikewave.reporting.numbers import headed, shown
from strikewave.reporting.parts import NONE, Cell, Part, Table, Tag, written
from strikewave.reporting.table_columns import TableColumn, page_table

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution
    from strikewave.papers.li_ma_2019.assumed import DimensionStudy
    from strikewave.papers.li_ma_2019.body_rows import BodyRow
    from strikewave.papers.li_ma_2019.result import Reproduction


def study_tables(result: Reproduction) -> Iterator[Part]:
    """Yield the tables of all studies that were made."""
    further = result.further
    if result.bodies:
        yield body_table(result.bodies)
    if further.reasons:
        yield reason_table(further.reasons)
    yield from (mesh_table(name, rows) for name, rows in further.meshes.items())
    if further.blows is not None:
        yield blow_table(further.blows)
    yield from (dimension_table(study) for study in further.dimensions)


def body_table(found: Sequence[BodyRow]) -> Table:
    """Set masses on springs and layers of a bar beside the elements, for the same bodies; nothing in them is fitted."""
    columns: list[TableColumn[BodyRow]] = [
        TableColumn("case", lambda row: row.case),
        TableColumn("model", lambda row: row.model),
        TableColumn("contact law", lambda row: row.law or None),
        TableColumn("peak force", lambda row: row.answer.peak, *FORCE.units),
        TableColumn("first pulse", lambda row: row.answer.first_width, *MICROSECONDS.units),
        TableColumn("first to last tenth", lambda row: row.answer.width, *MICROSECONDS.units),
        TableColumn("pulses", lambda row: str(row.answer.pulses)),
        TableColumn("impulse", lambda row: row.answer.impulse, *IMPULSE.units),
        TableColumn("force over mass", lambda row: row.answer.rigid_peak, *ACCELERATION.units),
        TableColumn("sensor's peak", lambda row: row.answer.watched_peak, *ACCELERATION.units),
    ]
    words = "The same bodies as elements, as masses on springs, and as layers of a bar; nothing is fitted"
    return page_table(words, columns, found)


def reason_table(found: Sequence[Reason]) -> Table:
    """Say why masses and layers part from the elements: each cause alone, measured."""
    words = "Why they part: each cause alone, on elements twice as large"
    return page_table(words, columns_of(Reason), found)


def mesh_table(case: str, rows: Sequence[MeshRow]) -> Table:
    """Say how peak, width and impulse converge with the mesh."""
    caption = f"{case} on {len(rows)} meshes, sizes relative to those of the case"
    return page_table(caption, columns_of(MeshRow), rows)


def dimension_table(study: DimensionStudy) -> Table:
    """Say what each assumed dimension does to the answer."""
    rows: list[list[Cell]] = [["as it stands", NONE, NONE, *(column.cell(study.base) for column in columns_of(Answer))]]
    for row in study.rows:
        both = zip(row.larger.changes(study.base), row.smaller.changes(study.base), strict=True)
        changes = [f"{_percent(up)} / {_percent(down)}" for up, down in both]
        rows.append([row.name, _size(row.path, row.value), Tag(row.provenance, row.provenance), *changes])
    words = (
        f"{study.case}, coarse elements: each assumed dimension {percent(SHARE, 0)} larger / smaller, "
        "with all that follows"
    )
    return Table(words, ["changed", "value", "it is", *_answer_heads()], rows)


def blow_table(solution: FemSolution) -> Table:
    """Say what the plastic memory of the first blow changes in the second."""
    rows: list[list[Cell]] = []
    for blow in solution.blows:
        measure, contact = blow_measure(blow.run, blow.model.touching), next(iter(blow.contacts))
        touched, back = blow.contacts[contact], measure.restitution[contact]
        if touched is None:
            continue
        strain = max(measure.plastic_strain.values(), default=math.nan)
        found = Answer(touched.peak, touched.duration, touched.impulse, math.nan, strain)
        *cells, _, strained = (column.cell(found) for column in columns_of(Answer))
        given = NONE if back is None else f"{back:.4f}"
        work = written(shown(sum(measure.plastic_energy.values()), *ENERGY.units), 3)
        rows.append([str(measure.blow), *cells, given, work, strained])
    heads = [*_answer_heads()[:3], "restitution", headed("taken by yield", *ENERGY.units), "plastic strain"]
    words = f"{solution.case.name} struck again on the surface that the blow before left, whole bodies"
    return Table(words, ["blow", *heads], rows)


def _answer_heads() -> list[str]:
    """Return the heads of an answer."""
    return [column.head for column in columns_of(Answer)]


def _percent(share: float) -> str:
    return NONE if math.isnan(share) else percent(share, 1, "+")


def _size(path: str, value: float) -> str:
    """Write a dimension with the unit that its kind is read in."""
    if path.endswith("tangent_modulus"):
        return f"{value / 1e9:.4g} GPa"
    return f"{abs(value):.4g} m/s" if ".velocity." in path else f"{value * 1e3:.5g} mm"
