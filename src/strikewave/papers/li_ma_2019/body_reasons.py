"""Elements beside masses on springs and layers of a bar for the same bodies, and the causes of their differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_model
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.cases.case import Case, dump_case, parse_case
from strikewave.cases.tables.fem import FramePart, HalfCylinder, MeshTable
from strikewave.contact import slow_force
from strikewave.fem.model import Driven, Fixed, Model, Point, TimeCurve
from strikewave.papers.li_ma_2019.bodies import (
    LAW,
    FrameBlow,
    LineLaw,
    SimpleAnswer,
    bar_dispersed,
    bar_elements,
    bar_layered,
    bar_lumped,
    elastic,
    element_answer,
    endless_compliance,
    frame_blow,
    layered,
    lumped,
    solid_bar,
)
from strikewave.papers.li_ma_2019.element_pulses import SPECIMEN, whole_force
from strikewave.papers.li_ma_2019.published import SEE_UNIT
from strikewave.papers.li_ma_2019.runs import coarser

LAWS: tuple[LineLaw, ...] = ("palmgren", "johnson")


@declare.dataclass(eq=False)
class BodyRow:
    """The answer of a model, beside that of the elements."""

    case: str = declare.word("name of the case")

    @declare.computed(declare.word("elements, lumped, layered, or layered with the sides hung"))
    def model(self) -> str:
        """Name of the model."""
        return self.answer.name

    law: str = declare.word("of the line contact; empty of elements")
    answer: SimpleAnswer = declare.part(SimpleAnswer, "what the model, or the elements, say of a blow", inline=True)
    elements: SimpleAnswer


def compare(case: Case, solution: FemSolution) -> tuple[BodyRow, ...]:
    """Set masses and layers of a case beside its elements; the first row is that of the elements.

    The solution may have a coarser mesh or a shorter duration than the case.
    """
    parts = solution.parts
    elements = element_answer(solution, parts[SPECIMEN].rigid_peak if SPECIMEN in parts else None)
    answers = [("", elements)]
    answers += [(law, lumped(case, law)) for law in LAWS]
    answers += [(law, layered(case, sides, law)) for sides in ("in the layers", "hung") for law in LAWS]
    return tuple(BodyRow(case.name, law, answer, elements) for law, answer in answers)


def body_rows(solutions: Sequence[FemSolution]) -> list[BodyRow]:
    """Return the rows of all solutions that are a half-cylinder upon a frame without non-reflecting faces."""
    rows: list[BodyRow] = []
    for solution in solutions:
        case = solution.case
        shapes = [type(part) for part in (case.mesh.part if case.mesh else ())]
        other_boundaries = {row.kind for row in (case.fem.boundary if case.fem else ())} - {"symmetry"}
        if HalfCylinder in shapes and FramePart in shapes and not other_boundaries:
            rows += compare(case, solution)
    return rows


Array = NDArray[np.float64]

COARSE, SHORT = 2.0, "fem.duration=400 us"
"""Ratio of the element size to that of the case, and duration of the run: a sixteenth of that of the case, and long
enough for the blow. Both sides of a comparison have the same mesh."""
EARLY = 40e-6
"""Time for which a wall is followed as a beam without ends, s: past the first maximum of the force at 6 us."""
STEPS = 1000
"""Steps in that time; the cost grows with their square."""
HUMP = 0.1
"""Share of the largest force that a first maximum must exceed, so that ripple before the rise does not count."""
MIDDLE, SIDE = "middle", "side"
"""Points of the wall whose motion is recorded."""
PUSH, RAMP, HOLD = 10e-6, 400e-6, 400e-6
"""Displacement (m), ramp time (s) and hold time (s) of the push that measures the stiffness of a wall: the hold lasts
two periods of the wall or more, so that the remaining vibration cancels in the mean."""
PUSH_INTERVAL = 2e-6
"""Interval of the histories of that push, s: two hundred means over the time that it is held."""


@declare.dataclass
class Reason:
    """A cause by which simple answers part from the elements, and the numbers that show it."""

    case: str = declare.word("name of the case", column=KEY)
    cause: str = declare.word("the cause", column=KEY)
    sentence: str = declare.word("what was measured, with its numbers", label="measured", column=MAIN)
    unit: str = declare.word("SI unit of both numbers")
    without: float = declare.number(SEE_UNIT, "what comes out without the cause")
    with_it: float = declare.number(SEE_UNIT, "what comes out with it")

    @declare.computed(
        declare.number(
            Quantity(NO_UNIT, "%", "without it", 1, 0, signed=True),
            "difference that the cause makes, relative to what comes out with it",
            column=MAIN,
        )
    )
    def off(self) -> float:
        """Difference that the cause makes, relative to what comes out with it."""
        return self.without / self.with_it - 1.0


def first_hump(force: Array) -> float:
    """Return the first maximum of a force above `HUMP` of its largest value."""
    level = HUMP * float(force.max())
    falls = np.flatnonzero((force[:-1] > level) & (np.diff(force) < 0.0))
    return float(force[falls[0]]) if falls.size else float(force.max())


def endless_wall(
    blow: FrameBlow, law: LineLaw = LAW, duration: float = EARLY, steps: int = STEPS
) -> tuple[Array, Array]:
    """Return times, s, and the contact force, N, of the striker on its top wall as a beam without ends.

    The wall gives way by w(t) = C int F(s) sqrt(t - s) ds (`endless_compliance`), the striker is a mass, the contact as
    in `lumped`: an equation like Timoshenko's of 1913, stepped explicitly, of order 3/2.
    """
    contact, mass = blow.contact(law), blow.striker_mass
    step = duration / steps
    time = step * np.arange(steps + 1.0)
    kernel = endless_compliance(blow.frame, blow.depth, blow.top) * np.sqrt(time)
    force = np.zeros(steps + 1)
    place, speed = 0.0, blow.speed
    for n in range(1, steps + 1):
        place += step * speed
        # the deflection of the wall by all steps before this one, whose own force is not known yet
        depth = place - step * float(force[:n] @ kernel[n:0:-1])
        force[n] = float(slow_force(contact, depth)) if depth > 0.0 else 0.0
        speed -= step * force[n] / mass
    return time, force


def with_changes(case: Case, changes: Sequence[str]) -> Case:
    """Return a case with changes such as "fem.duration=40 us"."""
    return parse_case(dump_case(case), case.name, changes)


def wall_stiffness(case: Case, threads: int = 1) -> float:
    """Return force over deflection of the top wall in its frame without a column, by elements, N/m.

    The frame stands on its bottom, elastic, of elements with full integration twice as large as in the case; the
    striker is pushed onto it slowly and stays. The deflection is that of the middle of the wall against the side walls,
    both in the wall's mid-plane; both are means over the time after the push, two periods of the wall and more.
    """
    coarse = with_changes(case, coarser(case, COARSE))
    if coarse.mesh is None or coarse.fem is None:
        raise ValueError("a case with [[mesh.part]] and [fem] is needed")
    parts = tuple(
        part.model_copy(update={"elements": "full"}) if isinstance(part, FramePart) else part
        for part in coarse.mesh.part
        if isinstance(part, FramePart | HalfCylinder)
    )
    names = {part.name for part in parts}
    tables = {
        "contact": tuple(
            x for x in coarse.fem.contact if {x.first.partition(".")[0], x.second.partition(".")[0]} <= names
        ),
        "boundary": tuple(x for x in coarse.fem.boundary if x.kind == "symmetry" and x.side.partition(".")[0] in names),
        **dict.fromkeys(("tie", "group", "section", "point"), ()),
    }
    pushed_case = coarse.model_copy(update={"mesh": MeshTable(part=parts), "fem": coarse.fem.model_copy(update=tables)})
    striker, frame = (next(x.name for x in parts if isinstance(x, shape)) for shape in (HalfCylinder, FramePart))
    solution = run_model(pushed_case, _pushed(build_model(pushed_case, threads), frame_blow(coarse), striker, frame))
    contact_force = whole_force(solution)
    if contact_force is None:
        raise ValueError(f"the striker of {case.name} does not reach its frame")
    time, force, _ = contact_force
    points = solution.run.points
    # after the ramp the wall still swings: the mean over the hold cancels it
    late = solution.run.time > RAMP
    deflection = float((points[SIDE].displacement - points[MIDDLE].displacement)[late, 2].mean())
    return float(force[time > RAMP].mean()) / deflection


def _pushed(model: Model, blow: FrameBlow, striker: str, frame: str) -> Model:
    """Return a frame that stands still while the top of the striker is pushed down, slowly, and held."""
    height = blow.height - 0.5 * blow.top
    push = TimeCurve((0.0, 0.5 * RAMP, RAMP), (0.0, 2.0 * PUSH / RAMP, 0.0))
    supports = (Fixed(f"{frame}.bottom"), Driven(f"{striker}.top", (0.0, 0.0, -1.0), push))
    return replace(
        elastic(model),
        velocity={},
        gravity=(0.0, 0.0, 0.0),
        boundaries=(*model.boundaries, *supports),
        points=(
            Point(MIDDLE, frame, (0.0, 0.0, height)),
            Point(SIDE, frame, (0.5 * blow.width - 0.25 * blow.sides, 0.0, height)),
        ),
        controls=replace(model.controls, duration=RAMP + HOLD, interval=PUSH_INTERVAL),
    )


def reasons(case: Case, threads: int = 1) -> tuple[Reason, ...]:
    """Return why simple answers differ from the elements of a case, with elements twice as large: half a minute."""
    blow, name = frame_blow(case), case.name
    coarse = with_changes(case, [*coarser(case, COARSE), SHORT])
    model = build_model(coarse, threads)
    firm = element_answer(run_model(coarse, elastic(model)), None)
    yielding = element_answer(run_model(coarse, model), None)
    sentence = (
        f"steel that does not yield would be pressed with {firm.peak / 1e3:.1f} in place of {yielding.peak / 1e3:.1f} "
        "kN; masses and layers know no yielding"
    )
    causes = [Reason(name, "yielding", sentence, "N", firm.peak, yielding.peak)]
    if not blow.bonded:  # a column that is tied takes the blow before the wall bends
        elements, masses = first_hump(firm.force), first_hump(lumped(case).force)
        sentence = (
            f"the first maximum is {masses / 1e3:.1f} kN where 13/35 of the wall move at once and "
            f"{elements / 1e3:.1f} kN in elastic elements: at first only the strip moves that bending waves have "
            "reached; a beam without ends, with no number more, gives "
            f"{first_hump(endless_wall(blow)[1]) / 1e3:.1f} kN"
        )
        causes.append(Reason(name, "inertia of bending", sentence, "N", masses, elements))
        clamped, real = blow.top_wall.stiffness, wall_stiffness(case, threads)
        sentence = (
            f"the top wall of the frame has {real / 1e6:.1f} N/um, clamped by walls that do not give way "
            f"{clamped / 1e6:.1f} N/um"
        )
        causes.append(Reason(name, "side walls that bend", sentence, "N/m", clamped, real))
    slices = layered(case, "in the layers", "johnson")
    sentence = (
        f"layers in which each slice across the blow moves as one make the force {slices.peak / 1e3:.1f} kN, elastic "
        f"elements {firm.peak / 1e3:.1f} kN: the side walls are not struck at once but by the walls that bend"
    )
    causes.append(Reason(name, "slices that move as one", sentence, "N", slices.peak, firm.peak))
    bar = solid_bar(case)
    solid, layer, pair = bar_elements(bar, case, threads), bar_layered(bar), bar_lumped(bar)
    sentence = (
        f"on the end of a solid bar in place of the frame the force is {solid.peak / 1e3:.1f} kN by elements, "
        f"{layer.peak / 1e3:.1f} kN by layers, {pair.peak / 1e3:.1f} kN by two masses: what parts them is the frame"
    )
    causes.append(Reason(f"{name}, a solid bar", "none", sentence, "N", layer.peak, solid.peak))
    far, layer_far = solid.watched_peak or 0.0, layer.watched_peak or 0.0
    sentence = (
        f"the far end of that bar is accelerated by {far:.4g} m/s^2 in elements, by {layer_far:.4g} m/s^2 in a layer "
        f"where short waves run as fast as long ones, and by {bar_dispersed(bar):.4g} m/s^2 where they run slower as "
        "Love's theory has it"
    )
    causes.append(Reason(f"{name}, a solid bar", "dispersion", sentence, "m/s^2", layer_far, far))
    return tuple(causes)
