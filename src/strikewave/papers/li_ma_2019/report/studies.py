"""Tables of what the element models depend on: meshes, assumed dimensions, blows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from strikewave.base.percents import percent
from strikewave.base.shock_quantities import (
    ACCELERATION,
    ENERGY,
    FORCE,
    IMPULSE,
    LENGTH,
    MICROSECONDS,
    MODULUS,
    VELOCITY,
)
from strikewave.fem.run import blow_measure
from strikewave.papers.li_ma_2019.assumed import SHARE, Answer, MeshRow
from strikewave.papers.li_ma_2019.body_reasons import Reason
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, columns_of
from strikewave.reporting.numbers import headed, shown
from strikewave.reporting.parts import NONE, Cell, Part, Table, Tag, written

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
    answers = [row.answer for row in found]
    columns = [
        Column("case", [row.case for row in found]),
        Column("model", [row.model for row in found]),
        Column("contact law", [row.law or None for row in found]),
        Column.of("peak force", [one.peak for one in answers], FORCE),
        Column.of("first pulse", [one.first_width for one in answers], MICROSECONDS),
        Column.of("first to last tenth", [one.width for one in answers], MICROSECONDS),
        Column("pulses", [one.pulses for one in answers]),
        Column.of("impulse", [one.impulse for one in answers], IMPULSE),
        Column.of("force over mass", [one.rigid_peak for one in answers], ACCELERATION),
        Column.of("sensor's peak", [one.watched_peak for one in answers], ACCELERATION),
    ]
    words = "The same bodies as elements, as masses on springs, and as layers of a bar; nothing is fitted"
    return page_table(words, columns)


def reason_table(found: Sequence[Reason]) -> Table:
    """Say why masses and layers part from the elements: each cause alone, measured."""
    words = "Why they part: each cause alone, on elements twice as large"
    return page_table(words, columns_of(Reason, found))


def mesh_table(case: str, rows: Sequence[MeshRow]) -> Table:
    """Say how peak, width and impulse converge with the mesh."""
    caption = f"{case} on {len(rows)} meshes, sizes relative to those of the case"
    return page_table(caption, columns_of(MeshRow, rows))


def dimension_table(study: DimensionStudy) -> Table:
    """Say what each assumed dimension does to the answer."""
    base = [column.texts()[0] for column in columns_of(Answer, [study.base])]
    rows: list[list[Cell]] = [["as it stands", NONE, NONE, *base]]
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
        *cells, _, strained = (column.texts()[0] for column in columns_of(Answer, [found]))
        given = NONE if back is None else f"{back:.4f}"
        work = written(shown(sum(measure.plastic_energy.values()), *ENERGY.units), 3)
        rows.append([str(measure.blow), *cells, given, work, strained])
    heads = [*_answer_heads()[:3], "restitution", headed("taken by yield", *ENERGY.units), "plastic strain"]
    words = f"{solution.case.name} struck again on the surface that the blow before left, whole bodies"
    return Table(words, ["blow", *heads], rows)


def _answer_heads() -> list[str]:
    """Return the heads of an answer."""
    return [column.head for column in columns_of(Answer, [])]


def _percent(share: float) -> str:
    return NONE if math.isnan(share) else percent(share, 1, "+")


def _size(path: str, value: float) -> str:
    """Write a dimension with its unit."""
    if path.endswith("tangent_modulus"):
        return amount(MODULUS, value, digits=4)
    return amount(VELOCITY, abs(value)) if ".velocity." in path else amount(LENGTH, value, digits=5)
