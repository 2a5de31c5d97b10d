"""Runs beyond those that the figures need: meshes, assumed dimensions, a second blow, the same bodies without yield."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from strikewave.analyses.fem.result import FemSolution
from strikewave.cases.case import load_case
from strikewave.papers.li_ma_2019.assumed import DimensionStudy, MeshRow, dimension_study, mesh_rows, studied
from strikewave.papers.li_ma_2019.body_reasons import Reason, reasons
from strikewave.papers.li_ma_2019.execution import Execution
from strikewave.papers.li_ma_2019.runs import QUIET_ELEMENTS, RIGID_ELEMENTS, WAVE_ELEMENTS, coarser
from strikewave.studies.engine.answers import OfCase

NO_YIELD = tuple(f"mesh.part.{part}.solid.yield_strength=100 GPa" for part in ("striker", "frame"))
"""Changes after which nothing yields: a strength that no blow of these bodies comes near."""
STAGES = (0.12, 0.14, 0.2, 0.08, 0.12)
"""About what share of the time meshes (twice), second blow, no yield and reasons take; the rest is for
dimensions. For the progress bar alone."""


@dataclass(frozen=True)
class Further:
    """Results of the studies; empty where they were left out.

    Attributes
    ----------
    meshes : mapping of str to tuple of MeshRow
        By case, coarsest first.
    dimensions : tuple of DimensionStudy
    blows : FemSolution or None
        Two blows of the rigid model, on elements that are larger by `COARSER`.
    elastic : FemSolution or None
        The quiet model without yield.
    reasons : tuple of Reason
        Why masses and layers part from the elements.
    """

    meshes: Mapping[str, tuple[MeshRow, ...]] = field(default_factory=dict)
    dimensions: tuple[DimensionStudy, ...] = ()
    blows: FemSolution | None = None
    elastic: FemSolution | None = None
    reasons: tuple[Reason, ...] = ()


def run_further(execution: Execution) -> Further:
    """Run all studies."""
    begin, stages = 0.0, []
    for share in STAGES:
        stages.append(execution.within(begin, begin + share))
        begin += share
    meshes = {
        name: mesh_rows(name, stage) for name, stage in zip((RIGID_ELEMENTS, WAVE_ELEMENTS), stages, strict=False)
    }
    again = studied(RIGID_ELEMENTS, [*coarser(studied(RIGID_ELEMENTS)), "fem.blows=2"])
    stages[2].report(0.0, "a second blow on what the first one left")
    blows = stages[2].elements(again)
    stages[3].report(0.0, "the same bodies without yield")
    elastic = stages[3].elements(studied(QUIET_ELEMENTS, NO_YIELD))
    asked = [
        OfCase(load_case(name), reasons, tuple[Reason, ...], threads=execution.threads)
        for name in (RIGID_ELEMENTS, WAVE_ELEMENTS)
    ]
    causes = stages[4].answers("why masses and layers part from the elements", asked)
    middle = 0.5 * (begin + 1.0)
    dimensions = (
        dimension_study(RIGID_ELEMENTS, execution.within(begin, middle)),
        dimension_study(WAVE_ELEMENTS, execution.within(middle, 1.0)),
    )
    return Further(meshes, dimensions, blows, elastic, tuple(reason for found in causes for reason in found))
