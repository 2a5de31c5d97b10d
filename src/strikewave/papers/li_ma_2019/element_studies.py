"""Studies of the element models: meshes, assumed dimensions, a second blow, the same bodies without yield.

The paper gives no dimension. A part that stands on another follows it: a taller frame carries the striker higher and
leaves more room in its opening.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field

from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_fem
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.base.shock_quantities import RATIO
from strikewave.base.texts import percent
from strikewave.cases.case import Case, load_case
from strikewave.papers.li_ma_2019.body_reasons import Reason, reasons
from strikewave.papers.li_ma_2019.element_pulses import specimen_body
from strikewave.papers.li_ma_2019.runs import QUIET_ELEMENTS, RIGID_ELEMENTS, WAVE_ELEMENTS, Execution, coarser
from strikewave.studies.engine.questions import OfCase

SHARE = 0.1
"""Relative change of an assumed dimension, up and down: above the error of a coarse mesh, yet nearly linear."""
MESHES = (2.0, math.sqrt(2.0), 1.0)
"""Sizes of elements over those of the case, in a geometric series; each root of two takes four times as long."""
STUDIED = "300 us"
"""Duration of the runs of a study: one and a half published widths, so that the blow is over."""


@declare.dataclass
class Answer:
    """The first contact of an element model, and its effect on the bodies."""

    peak_force: float = declare.number(Quantity("N", "kN", digits=5), "of whole bodies", column=MAIN)
    width: float = declare.number(
        Quantity("s", "us", "pulse width at 10 %", digits=5),
        "from the first to the last tenth of the peak",
        column=MAIN,
    )
    impulse: float = declare.number(Quantity("N s", "N s", digits=5), "of whole bodies", column=MAIN)
    body_peak: float = declare.number(
        Quantity("m/s^2", "g", "body's peak", digits=5),
        "largest mean acceleration of the specimen, or of the whole object where there is none",
        column=MAIN,
    )
    plastic_strain: float = declare.number(Quantity(NO_UNIT, NO_UNIT, digits=3), "largest anywhere", column=MAIN)

    def changes(self, other: Answer) -> tuple[float, ...]:
        """Return how far this answer is from another, relative to that; NaN where that is 0."""
        pairs = zip(astuple(self), astuple(other), strict=True)
        return tuple(round(mine / base - 1.0, 12) if base else math.nan for mine, base in pairs)


def answer(solution: FemSolution) -> Answer:
    """Return the answer of a run; NaN where nothing touched."""
    name = next(iter(solution.contacts))
    touched = solution.contacts[name]
    if touched is None:
        return Answer(*[math.nan] * 5)
    body = {**solution.parts, **solution.groups}[specimen_body(solution)]
    return Answer(
        peak_force=touched.peak,
        width=touched.duration,
        impulse=touched.impulse,
        body_peak=body.rigid_peak,
        plastic_strain=max(part.plastic_strain for part in solution.parts.values()),
    )


@declare.dataclass
class MeshRow:
    """An element model on one mesh."""

    size: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "elements' size", digits=3), "of its elements, relative to the case", column=KEY
    )
    elements: int = declare.count("how many", column=MAIN)
    steps: int = declare.count("of time", column=MAIN)
    seconds: float = declare.number(Quantity("s", "s", "took", digits=3), "of the run alone", column=MAIN)
    energy_error: float = declare.number(RATIO, "what the balance of energy misses, as a share")

    @declare.phrase("energy error", column=MAIN)
    def error_text(self) -> str:
        """Return the energy error with its sign."""
        return f"{self.energy_error:+.0e}"

    hourglass_share: float = declare.number(
        Quantity(NO_UNIT, "%", "hourglass energy", 1, 0), "energy in hourglass modes, as a share", column=MAIN
    )
    answer: Answer = declare.part(Answer, "what it says of the blow")


def mesh_row(case: Case, size: float, threads: int = 1) -> MeshRow:
    """Run a case whose elements have ``size`` times their usual size, and return its row."""
    solution = run_fem(case, threads)
    run, balance = solution.run, solution.measured_balance
    return MeshRow(size, run.elements, run.steps, run.seconds, balance.energy, balance.hourglass, answer(solution))


def mesh_rows(name: str, execution: Execution, sizes: Sequence[float] = MESHES) -> tuple[MeshRow, ...]:
    """Run a case on several meshes, coarsest first."""
    runs = []
    for size in sizes:
        mesh = studied(name, coarser(load_case(name), size) if size != 1.0 else [])
        runs.append(OfCase(mesh, mesh_row, MeshRow, (size,), execution.threads))
    return tuple(execution.answers(f"{name} on {len(sizes)} meshes", runs))


def studied(name: str, changes: Sequence[str] = ()) -> Case:
    """Return a case for a study: the blow alone, no fields."""
    return load_case(name, [*changes, f"fem.duration={STUDIED}", "fem.frames=0"])


@dataclass(frozen=True)
class Dimension:
    """An assumed dimension: the quantities at ``paths`` of the case, of which the first is listed.

    They change by the same factor, or by the same length where ``together``. ``outside`` is the path of the outer
    diameter of a tube whose inner one comes first: its wall is then the dimension.
    """

    name: str
    paths: tuple[str, ...]
    together: bool = False
    outside: str = ""

    def size(self, values: Mapping[str, float]) -> float:
        """Return the dimension in SI units."""
        first = values[self.paths[0]]
        return 0.5 * (values[self.outside] - first) if self.outside else first


def _part(*paths: str) -> tuple[str, ...]:
    return tuple(f"mesh.part.{path}" for path in paths)


FRAME = (
    Dimension("speed", _part("striker.velocity.z")),
    Dimension("radius of the striker", _part("striker.radius")),
    Dimension("length of the striker", _part("striker.length")),
    Dimension("width of the frame", _part("frame.width")),
    Dimension("depth of the frame", _part("frame.depth")),
    Dimension("height of the frame", _part("frame.height")),
    Dimension("side walls", _part("frame.left", "frame.right")),
    Dimension("top wall", _part("frame.top")),
    Dimension("bottom wall", _part("frame.bottom")),
)
"""Dimensions of striker and frame that both models assume."""
SHELL = (
    Dimension("diameter of the shell", _part("shell.outer_diameter", "shell.inner_diameter"), together=True),
    Dimension("wall of the shell", _part("shell.inner_diameter"), outside="mesh.part.shell.outer_diameter"),
    Dimension("slope beyond yield", _part("striker.solid.tangent_modulus", "frame.solid.tangent_modulus")),
)
"""ElementStudies dimensions that the model of the rigid pulse assumes."""
SENSOR = (
    Dimension("diameter of cylinders and sensor", _part("sensor.diameter", "upper.diameter", "lower.diameter")),
    Dimension("height of the sensor", _part("sensor.length")),
    Dimension(
        "slope beyond yield",
        _part(*(f"{name}.solid.tangent_modulus" for name in ("striker", "frame", "upper", "lower"))),
    ),
)
"""ElementStudies dimensions that the model of the wave assumes."""


def dimensions(case: Case) -> tuple[Dimension, ...]:
    """Return the assumed dimensions of the model of the rigid pulse, or of the wave."""
    return FRAME + (SENSOR if any(path.startswith("mesh.part.sensor.") for path in case.values()) else SHELL)


def changed(case: Case, dimension: Dimension, share: float) -> list[str]:
    """Return the changes to a case where one dimension is larger by a share of itself, with what follows from it."""
    values = {path: value.si for path, value in case.values().items()}
    # a wall of a tube grows inward: its inner diameter falls by twice as much
    first = dimension.size(values) * share * (-2.0 if dimension.outside else 1.0)
    alike = dimension.together or bool(dimension.outside)
    moved = {path: values[path] + (first if alike else values[path] * share) for path in dimension.paths}
    moved |= seats({**values, **moved})
    return [f"{path}={value:.12g}" for path, value in moved.items() if not math.isclose(value, values[path])]


def seats(values: Mapping[str, float]) -> dict[str, float]:
    """Return where parts stand, and the lengths of those that fill the opening of the frame: by path, m.

    The striker touches the top of the frame; a shell fills the opening, or two equal cylinders with the sensor between.
    """
    frame = {name: values[f"mesh.part.frame.{name}"] for name in ("height", "top", "bottom")}
    floor, opening = frame["bottom"], frame["height"] - frame["top"] - frame["bottom"]
    places = {"mesh.part.striker.at.z": frame["height"] + values["mesh.part.striker.radius"]}
    if "mesh.part.sensor.length" not in values:
        return places | {"mesh.part.shell.at.z": floor, "mesh.part.shell.length": opening}
    sensor = values["mesh.part.sensor.length"]
    cylinder = 0.5 * (opening - sensor)
    places |= {f"mesh.part.{name}.length": cylinder for name in ("lower", "upper")}
    starts = {"lower": floor, "sensor": floor + cylinder, "upper": floor + cylinder + sensor}
    return places | {f"mesh.part.{name}.at.z": start for name, start in starts.items()}


@declare.dataclass
class DimensionRow:
    """The answers with an assumed dimension larger and smaller by `SHARE`."""

    name: str = declare.word("what is changed")
    path: str = declare.word("of the quantity in the case")
    value: float = declare.number(declare.NOT_MEASURED, "SI")
    provenance: str = declare.word("what the case says of it: assumed, fitted, inferred")
    larger: Answer = declare.part(Answer, "of the larger one")
    smaller: Answer = declare.part(Answer, "of the smaller one")

    @declare.computed(declare.number(RATIO, "by how much it is larger and smaller"))
    def share(self) -> float:
        """Relative change of the dimension."""
        return SHARE


@declare.dataclass
class DimensionStudy:
    """The answer of a coarse mesh as the case stands, and with each assumed dimension changed."""

    case: str = declare.word("name of the case")
    base: Answer = declare.part(Answer, "as the case stands")
    rows: tuple[DimensionRow, ...] = declare.rows(DimensionRow, "what each dimension does")


def dimension_study(name: str, execution: Execution, size: float = MESHES[0]) -> DimensionStudy:
    """Run a case with each assumed dimension larger and smaller by `SHARE`, on elements of ``size`` times its own."""
    case = load_case(name)
    mesh, assumed, values = coarser(case, size), dimensions(case), case.values()
    changes = [[], *(changed(case, dimension, share) for dimension in assumed for share in (SHARE, -SHARE))]
    runs = [OfCase(studied(name, [*mesh, *change]), answer_of, Answer, threads=execution.threads) for change in changes]
    base, *answers = execution.answers(f"{name}, assumed dimensions ±{percent(SHARE, 0)}", runs)
    sizes = {path: value.si for path, value in values.items()}
    rows = []
    for dimension, larger, smaller in zip(assumed, answers[::2], answers[1::2], strict=True):
        path = dimension.paths[0]
        row = DimensionRow(dimension.name, path, dimension.size(sizes), values[path].provenance, larger, smaller)
        rows.append(row)
    return DimensionStudy(name, base, tuple(rows))


def answer_of(case: Case, threads: int = 1) -> Answer:
    """Run a case and return its answer."""
    return answer(run_fem(case, threads))


NO_YIELD = tuple(f"mesh.part.{part}.solid.yield_strength=100 GPa" for part in ("striker", "frame"))
"""Changes after which nothing yields: a strength that no blow of these bodies comes near."""
STAGES = (0.12, 0.14, 0.2, 0.08, 0.12)
"""Rough shares of time of meshes (twice), second blow, no yield and reasons, for the progress bar alone."""


@dataclass(frozen=True)
class ElementStudies:
    """Results of the studies; empty where they were left out."""

    meshes: Mapping[str, tuple[MeshRow, ...]] = field(default_factory=dict)  # by case, coarsest first
    dimensions: tuple[DimensionStudy, ...] = ()
    blows: FemSolution | None = None  # two blows of the rigid model, on coarser elements
    elastic: FemSolution | None = None  # the quiet model without yield
    reasons: tuple[Reason, ...] = ()  # why masses and layers differ from the elements


def run_element_studies(execution: Execution) -> ElementStudies:
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
    questions = [
        OfCase(load_case(name), reasons, tuple[Reason, ...], threads=execution.threads)
        for name in (RIGID_ELEMENTS, WAVE_ELEMENTS)
    ]
    causes = stages[4].answers("why masses and layers part from the elements", questions)
    middle = 0.5 * (begin + 1.0)
    dimensions = (
        dimension_study(RIGID_ELEMENTS, execution.within(begin, middle)),
        dimension_study(WAVE_ELEMENTS, execution.within(middle, 1.0)),
    )
    return ElementStudies(meshes, dimensions, blows, elastic, tuple(reason for of_case in causes for reason in of_case))
