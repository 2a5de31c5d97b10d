"""The section of a report on several blows of the same bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.analyses.fem.figures.blows import blows_figure
from strikewave.reporting.faces import face_table
from strikewave.reporting.parts import Picture, Section

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

_WORDS = (
    "After a blow the bodies come to rest (dynamic relaxation) without their loads and contacts, go back to where "
    "they began as rigid bodies, and meet again with the velocities of the case. Plastic strain, back stress, "
    "temperature, shape and residual stress are those that the blow before left. All other sections are those of the "
    "first blow. The coefficient of restitution is the speed of separation at the end over that of approach at the "
    "start, of the parts of the contact as rigid bodies."
)


def blows_section(solution: FemSolution) -> Section:
    """Return what each blow came to, and the dynamic relaxation before it."""
    caption = "Force of the strongest contact of each blow, means of intervals; and what yield takes of each."
    picture = Picture(blows_figure([blow.run for blow in solution.blows]), caption)
    forces = face_table(solution, "contacts_of_blows", "blow", empty="No contact is in the model.")
    return Section("Blow after blow", _WORDS, [forces, face_table(solution, "yield_of_blows"), picture])
