"""Elements beside masses on springs and layers of a bar for the same bodies, and why they part, cause by cause."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

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
    endless_compliance,
    frame_blow,
    layered,
    lumped,
)
from strikewave.papers.li_ma_2019.element_pulses import SPECIMEN, whole_force
from strikewave.papers.li_ma_2019.runs import coarser
from strikewave.papers.li_ma_2019.solid_bars import (
    bar_dispersed,
    bar_elements,
    bar_layered,
    bar_lumped,
    elastic,
    element_answer,
    solid_bar,
)
from strikewave.papers.li_ma_2019.types import SEE_UNIT

LAWS: tuple[LineLaw, ...] = ("palmgren", "johnson")


@dataclass(frozen=True)
class BodyRow:
    """An answer beside that of the elements.

    Attributes
    ----------
    case : str
        Name of the case.
    law : str
        Law of the line contact; empty for elements.
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
        Case that the simple answers are made from; see `frame_blow`.
    solution : FemSolution
        Solution of the same case; a coarser mesh or a shorter duration is taken as it is.

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


Array = NDArray[np.float64]

COARSE, SHORT = 2.0, "fem.duration=400 us"
"""By how much elements are larger than those of the case, and for how long it is run: a sixteenth of the time, and long
enough for the blow. What is compared has the same mesh on both sides."""
EARLY = 40e-6
"""How long a wall is followed as a beam without ends, s: past the first maximum of the force, which comes after
6 us (li-ma-2019-fem-rigid)."""
STEPS = 1000
"""Steps in that time; the sum over all steps before takes their square."""
HUMP = 0.1
"""Share of the largest force that a first maximum must exceed, so that ripple before the rise does not count."""
MIDDLE, SIDE = "middle", "side"
"""Points of the wall whose motion is recorded."""
PUSH, RAMP, HOLD = 10e-6, 400e-6, 400e-6
"""How far (m), and in which time (s) a wall is pushed to find its stiffness, and how long (s) it is then held: the hold
lasts two periods of the wall and more, so that what still swings cancels in the mean."""
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


class Humps(NamedTuple):
    """First maximum of the contact force, N: of elements, of masses, and of a beam without ends under the striker."""

    elements: float
    lumped: float
    endless: float


def first_hump(force: Array) -> float:
    """Return the first maximum of a force above `HUMP` of its largest value.

    Examples
    --------
    >>> first_hump(np.array([0.0, 0.5, 3.0, 2.0, 9.0, 0.0]))
    3.0
    """
    level = HUMP * float(force.max())
    falls = np.flatnonzero((force[:-1] > level) & (np.diff(force) < 0.0))
    return float(force[falls[0]]) if falls.size else float(force.max())


def endless_wall(
    blow: FrameBlow, law: LineLaw = LAW, duration: float = EARLY, steps: int = STEPS
) -> tuple[Array, Array]:
    """Return times, s, and the contact force, N, of the striker on its top wall as a beam without ends.

    The wall gives way by w(t) = C int F(s) sqrt(t - s) ds (`endless_compliance`), the striker is a mass, the contact as
    in `lumped`: an equation like Timoshenko's of 1913, stepped explicitly, of order 3/2.

    Examples
    --------
    >>> from strikewave import load_case
    >>> time, force = endless_wall(frame_blow(load_case("li-ma-2019-fem-rigid")))
    >>> 14e3 < first_hump(force) < 16e3
    True
    """
    contact, mass = blow.contact(law), blow.striker_mass
    step = duration / steps
    time = step * np.arange(steps + 1.0)
    kernel = endless_compliance(blow.frame, blow.depth, blow.top) * np.sqrt(time)
    force = np.zeros(steps + 1)
    place, speed = 0.0, blow.speed
    for n in range(1, steps + 1):
        place += step * speed
        depth = place - step * float(force[:n] @ kernel[n:0:-1])
        force[n] = float(slow_force(contact, depth)) if depth > 0.0 else 0.0
        speed -= step * force[n] / mass
    return time, force


def first_humps(case: Case, elements: Array, law: LineLaw = LAW) -> Humps:
    """Return the first maximum of the contact force by elements (force at the instants of a run, N), and without."""
    _, endless = endless_wall(frame_blow(case), law)
    return Humps(first_hump(elements), first_hump(lumped(case, law).force), first_hump(endless))


def changed(case: Case, changes: Sequence[str]) -> Case:
    """Return a case with changes such as "fem.duration=40 us"."""
    return parse_case(dump_case(case), case.name, changes)


def yield_loss(case: Case, threads: int = 1) -> tuple[SimpleAnswer, SimpleAnswer]:
    """Return the answers of elements twice as large as the case has, elastic and as the case has them."""
    coarse = changed(case, [*coarser(case, COARSE), SHORT])
    model = build_model(coarse, threads)
    return element_answer(run_model(coarse, elastic(model)), None), element_answer(run_model(coarse, model), None)


def wall_stiffness(case: Case, threads: int = 1) -> float:
    """Return force over deflection of the top wall in its frame without a column, by elements, N/m.

    The frame stands on its bottom, elastic, of elements with full integration twice as large as the case has; the
    striker is pushed onto it slowly and held. Deflection is that of the middle of the wall against the side walls, both
    in the wall's mid-plane; both are means over the time it is held, two periods and more of the wall.
    """
    coarse = changed(case, coarser(case, COARSE))
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
    """Return why simple answers part from the elements of a case, with elements twice as large: half a minute."""
    blow = frame_blow(case)
    firm, as_is = yield_loss(case, threads)
    causes = [_of_yielding(case.name, firm, as_is)]
    if not blow.bonded:
        causes += [_of_inertia(case, firm), _of_clamping(case, blow, threads)]
    return (*causes, _of_slices(case, firm), *_of_solid_bar(case, threads))


def _of_yielding(name: str, firm: SimpleAnswer, as_is: SimpleAnswer) -> Reason:
    sentence = (
        f"steel that does not yield would be pressed with {firm.peak / 1e3:.1f} in place of {as_is.peak / 1e3:.1f} kN; "
        "masses and layers know no yielding"
    )
    return Reason(name, "yielding", sentence, "N", firm.peak, as_is.peak)


def _of_inertia(case: Case, firm: SimpleAnswer) -> Reason:
    humps = first_humps(case, firm.force)
    sentence = (
        f"the first maximum is {humps.lumped / 1e3:.1f} kN where 13/35 of the wall move at once and "
        f"{humps.elements / 1e3:.1f} kN in elastic elements: at first only the strip moves that bending waves have "
        f"reached; a beam without ends, with no number more, gives {humps.endless / 1e3:.1f} kN"
    )
    return Reason(case.name, "inertia of bending", sentence, "N", humps.lumped, humps.elements)


def _of_clamping(case: Case, blow: FrameBlow, threads: int) -> Reason:
    clamped, real = blow.top_wall.stiffness, wall_stiffness(case, threads)
    sentence = (
        f"the top wall of the frame has {real / 1e6:.1f} N/um, clamped by walls that do not give way "
        f"{clamped / 1e6:.1f} N/um"
    )
    return Reason(case.name, "side walls that bend", sentence, "N/m", clamped, real)


def _of_slices(case: Case, firm: SimpleAnswer) -> Reason:
    plain = layered(case, "in the layers", "johnson")
    sentence = (
        f"layers in which each slice across the blow moves as one make the force {plain.peak / 1e3:.1f} kN, elastic "
        f"elements {firm.peak / 1e3:.1f} kN: the side walls are not struck at once but by the walls that bend"
    )
    return Reason(case.name, "slices that move as one", sentence, "N", plain.peak, firm.peak)


def _of_solid_bar(case: Case, threads: int) -> tuple[Reason, Reason]:
    blow = solid_bar(case)
    real, layers, masses = bar_elements(blow, case, threads), bar_layered(blow), bar_lumped(blow)
    bar = (
        f"on the end of a solid bar in place of the frame the force is {real.peak / 1e3:.1f} kN by elements, "
        f"{layers.peak / 1e3:.1f} kN by layers, {masses.peak / 1e3:.1f} kN by two masses: what parts them is the frame"
    )
    over = f"{case.name}, a solid bar"
    end = (
        f"the far end of that bar is accelerated by {real.watched_peak or 0.0:.4g} m/s^2 in elements, by "
        f"{layers.watched_peak or 0.0:.4g} m/s^2 in a layer where short waves run as fast as long ones, and by "
        f"{bar_dispersed(blow):.4g} m/s^2 where they run slower as Love's theory has it"
    )
    return (
        Reason(over, "none", bar, "N", layers.peak, real.peak),
        Reason(over, "dispersion", end, "m/s^2", layers.watched_peak or 0.0, real.watched_peak or 0.0),
    )
