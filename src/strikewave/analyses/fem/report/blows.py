"""The section of a report on several blows of the same bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from strikewave.analyses.fem.figures.blows import blows_figure
from strikewave.analyses.fem.sectors import blow_of_bodies
from strikewave.fem.blow_measures import blow_measure
from strikewave.reporting.numbers import shown, shown_heads
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, written

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
    runs = [blow.run for blow in solution.blows]
    caption = "Force of the strongest contact of each blow, means of intervals; and what yield takes of each."
    return Section(
        "Blow after blow", _WORDS, [_forces(solution), _yield(solution), Picture(blows_figure(runs), caption)]
    )


def _forces(solution: FemSolution) -> Table:
    rows: list[list[Cell]] = []
    for blow in solution.blows:
        restitution = blow_measure(blow.run, blow.model.touching).restitution
        name, pulse = next(iter(blow_of_bodies(blow.model, blow.run).items()))
        width = NONE if math.isnan(pulse.width) else written(shown(pulse.width, "s", "us"))
        change = written(shown(pulse.velocity_change, "m/s", "m/s"))
        rigid = [f"{name}: {written(shown(pulse.rigid_peak, 'm/s^2', 'g'))}", width, change]
        for contact, measure in blow.contacts.items():
            e = restitution[contact]
            values: list[Cell] = [NONE, NONE, NONE]
            if measure is not None:
                pulse_of = ((measure.peak, "N", "kN"), (measure.impulse, "N s", "N s"), (measure.duration, "s", "us"))
                values = [written(shown(*one)) for one in pulse_of]
            rows.append([str(blow.run.blow), contact, *values, NONE if e is None else f"{e:.4f}", *rigid])
    heads = shown_heads("blow", "contact", "peak force (kN)", "impulse (N s)", "duration (us)")
    heads += ["coefficient of restitution"]
    heads += shown_heads("rigid peak (g)", "pulse width at 10 % (us)", "velocity change (m/s)")
    return Table("Forces of each blow", heads, rows, empty="No contact is in the model.")


def _yield(solution: FemSolution) -> Table:
    rows: list[list[Cell]] = []
    for blow in solution.blows:
        measure = blow_measure(blow.run, blow.model.touching)
        strain, rest = max(measure.plastic_strain.values(), default=math.nan), measure.rest
        energy = [sum(measure.plastic_energy.values()), blow.run.initial_energy]
        to_rest: list[Cell] = [NONE] * 5
        if rest is not None:
            energy_of, distance = shown(rest.plastic_energy, "J", "J"), shown(rest.added_distance, "m", "um")
            values = [rest.kinetic_share, energy_of, distance]
            to_rest = [str(rest.maxima), str(rest.steps), *(written(value, 3) for value in values)]
        cells = [
            NONE if math.isnan(strain) else written(strain),
            *(written(shown(value, "J", "J")) for value in energy),
        ]
        rows.append([str(measure.blow), *cells, f"{blow.measured_balance.energy:+.1e}", *to_rest])
    heads = ["blow", "plastic strain, largest", "taken by yield (J)", "energy at the start (J)", "energy balance error"]
    heads += [
        "kinetic-energy maxima of relaxation",
        "steps of relaxation",
        "kinetic energy left (share)",
        "yield during relaxation (J)",
    ]
    return Table(
        "Yield in each blow, and relaxation before it", shown_heads(*heads, "moved back at the start (um)"), rows
    )
