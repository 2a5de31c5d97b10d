"""The sections of a machine's report: set-up, blows, pulses, balances, masses and phases."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.machine.kind import kind_of
from strikewave.analyses.machine.words import (
    ANSWERS_CALLED,
    MACHINES,
    answer_columns,
    blow_columns,
    launch_tables,
    reference_law,
    restitution_words,
)
from strikewave.base.shock_quantities import KILOGRAMS, PULSE_WIDTH, RIGID_PEAK
from strikewave.reporting.chapters import balance_table, layer_steps
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, face_table, text_of
from strikewave.reporting.numbers import headed, listed, shown
from strikewave.reporting.parts import NONE, Cell, Flow, Link, Part, Picture, Section, Table, Tag

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.machine.result import Solution
    from strikewave.cases.case import Case


_DATA_FLOW = (
    "case file",
    "checks of units and fits",
    "machine",
    "motion with every contact located in time",
    "blows",
    "pulses: peak, width, velocity change",
    "comparison with published values",
)


_PARTS = "The parts with their numbers, counted as in the drawing"
_WORDS = (
    "A blow is one pass of one striker, all its re-contacts included. It is glancing when its approach speed is below "
    "half of the nominal one, double when a second group of contacts, more than a pulse width later, carries a tenth "
    "of the contact impulse, missed when the striker passed an object in place without touching it, and full "
    "otherwise. Time counts from {begun}. The rigid peak and its width, taken at 10 % of the peak, belong to "
    "the rigid-body acceleration: the momentum rate of the assembly over its mass, its zero that of a sensor, taken "
    "before the blow (of an object that falls, in the fall: gravity is not in it). The velocity change is the integral "
    "of this pulse from foot to foot, where 2 % of its peak is left. g is standard gravity, 9.80665 m/s²."
)


def setup(case: Case) -> Section:
    """Say what machine it is and how the numbers come about."""
    words, chain = MACHINES[case.machine.kind if case.machine else ""]
    layers = layer_steps(case)
    parts = _drawing(case.with_stale_fits_assumed())
    if chain and not layers:
        parts.append(Flow(chain, "Bodies and links, in the order in which a blow runs through them"))
    if layers:
        parts.append(Flow(layers, "The stack, from its loaded face on"))
    parts.append(Flow(_DATA_FLOW, "From the case to this report"))
    return Section("Set-up", words + _strike_words(case), parts)


def _strike_words(case: Case) -> str:
    """Say how the nose of a striker of the rotary machine meets the face; nothing for another machine."""
    from strikewave.analyses.machine.figures.geometry import strike_geometry

    geometry = strike_geometry(case)
    if geometry is None:
        return ""
    if not geometry.blow_angle:
        return " The nose of a striker acts on the object's face like a cam."
    return f" The blow stands at {math.degrees(geometry.blow_angle):.4g}° to the radius at the strike position."


def _drawing(case: Case) -> list[Part]:
    """Return drawings of the machine and a table of its numbers; nothing for a machine that is not drawn."""
    drawing = kind_of(case).drawing(case)
    if drawing is None:
        return []
    rows: list[list[Cell]] = []
    for number, part in enumerate(drawing.parts, 1):
        name = f"{number} {part.name}" if part.place else part.name
        for one in part.entries:
            looks = ("follows", "") if one.provenance == "computed" else (one.provenance, one.provenance)
            rows.append([f"{name}: {one.name}", one.shown, Tag(*looks)])
        if not part.entries:
            rows.append([name, NONE, NONE])
    return [*drawing.pictures, Table(_PARTS, ["part", "value", "provenance"], rows)]


def blow_table(solution: Solution) -> Section:
    """List the blows, in the units and columns of the command line."""
    columns = blow_columns("blows", solution.blows, solution.band)
    table = page_table("Blows", columns, "No blow: no striker passed the object.")
    reference = solution.reference
    beside = (
        f"\n\nFor comparison, {reference_law(solution.case)} on a rigid object, at the nominal "
        f"{text_of(reference, 'approach_speed')} and with no frame or mount to bend: {reference.words}."
    )
    words = _WORDS.format(begun=solution.case.time_zero) if solution.blows else ""
    return Section("Blows", words + beside, [table, *_contacts(solution), *_answers(solution)])


def _contacts(solution: Solution) -> list[Table]:
    """List the contact of each blow that struck, and what its nose does across the face where friction acts."""
    contact = (
        "Contact, blow by blow. The coefficient of restitution is that of the contact: the square root of the work it "
        "gives back over the work it takes; the rebound speed depends on frame and mount too. The stiffness is the "
        "slope of the contact force at the largest indentation on the way back. What stays of the indentation, and the "
        "radius of the spot over that before, change only where the case gives a yield pressure."
    )
    sliding = (
        "The nose slides across the face, blow by blow: the largest side force and the side impulse on the object, "
        "above 0 the way the nose passes, the heat of this friction, and the turntable's speed at first touch. The "
        "guide of the object bears the side force; the friction that this adds in the guide is not in the model."
    )
    struck = solution.struck
    shown = {"contact": contact, "sliding": sliding} if solution.slides else {"contact": contact}
    return [page_table(caption, blow_columns(which, struck)) for which, caption in shown.items() if struck]


def _answers(solution: Solution) -> list[Table]:
    """List what the contact says of the first blow as elastic and as yielding, where that differs."""
    answers = solution.contact
    if answers is None or not answers.differ:
        return []
    asked = restitution_words(answers)
    passed = "" if answers.first_yield is None else text_of(answers, "first_yield")
    caption = (
        f"{ANSWERS_CALLED}. The weaker material first yields inside at {passed}. Low and high are the ends of what is "
        f"known of the pressure that the contact bears. {asked[0].upper()}{asked[1:]}."
    )
    return [page_table(caption, answer_columns(answers, solution.band))]


def pulse_pictures(solution: Solution, moving: str = "") -> Section:
    """Draw acceleration and force of the first blow, all pulses, the train; say what is missing.

    ``moving`` is the name of the page that shows the machine in motion.
    """
    from strikewave.analyses.machine.figures import pulses

    data = solution.arrays
    struck = [row for row, blow in enumerate(solution.blows) if blow.kind != "missed"]
    parts: list[Part] = []
    words = [] if struck else ["No striker touched the object: there is no pulse to show."]

    def add(needs: Sequence[str], draw: Callable[[], Figure], caption: str, label: str) -> None:
        if all(name in data for name in needs):
            parts.append(Picture(draw(), caption, label))
        else:
            words.append(
                f"Without the history {listed([n for n in needs if n not in data])} there is no picture: {label}"
            )

    if struck:
        first = solution.blows[struck[0]]
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.rigid_acceleration(solution, struck[0]),
            f"Rigid-body acceleration of the assembly, blow {first.index}"
            + ("; the marks are published peaks and widths." if _marked(solution) else "."),
            f"Rigid-body acceleration over time, blow {first.index}: peak "
            f"{amount(RIGID_PEAK, first.rigid_peak, solution.band.get('first.rigid_peak'))}, "
            f"width {amount(PULSE_WIDTH, first.width, solution.band.get('first.width'))}.",
        )
        add(
            ["pulse_time", "pulse_force"],
            lambda: pulses.contact_force(solution, struck[0]),
            f"Contact force between striker and object, blow {first.index}. Each rise from zero is a contact.",
            f"Contact force over time, blow {first.index}: peak {text_of(first, 'peak_force')}, "
            f"{first.contacts} contacts.",
        )
        drawn = pulses.chosen(solution)
        some = "" if len(drawn) == len(struck) else f" {len(drawn)} of {len(struck)} are drawn."
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.overlaid_pulses(solution),
            f"Rigid-body pulses of all blows over each other, each from its first touch.{some}",
            f"Rigid-body pulses of {len(drawn)} blows over each other; their peaks and widths stand in the table of "
            "blows.",
        )
    add(
        ["time", "rigid_acceleration"],
        lambda: pulses.whole_train(solution),
        "Rigid-body acceleration over the whole train"
        + ("; the marks are the peaks of the table of blows, with its numbers." if len(struck) else "."),
        f"Rigid-body acceleration over the whole train: {len(struck)} blows.",
    )
    if moving:
        parts.append(Link(moving, "The machine in motion, with its histories: the whole run, or one blow slowed down"))
    return Section("Pulses", "\n\n".join(words), parts)


def _marked(solution: Solution) -> bool:
    peaks = any(entry.quantity == "first.rigid_peak" for entry in solution.published)
    return peaks and not solution.case.changed_fields()


def checks(solution: Solution) -> Section:
    """List balances, masses and phases."""
    masses: list[list[Cell]] = [[name, shown(mass, *KILOGRAMS.units)] for name, mass in solution.masses.items()]
    return Section(
        "Balances, masses and phases",
        "Energy: what the balance of work and losses misses, over the energy that flowed. Momentum: impulse of all "
        "forces less change of momentum, over the contact impulse; the worst blow.",
        [
            balance_table(solution.balance_checks),
            Table("Masses", ["body", headed("mass", *KILOGRAMS.units)], masses, empty="No mass is listed."),
            *launch_tables(solution),
            face_table(
                solution, "phase_rows", caption=f"Phases, from {solution.case.time_zero}", empty="No phase is listed."
            ),
        ],
    )
