"""The bodies of a finite-element case as masses on springs and as layers of a bar, with nothing fitted.

A half-cylinder strikes the top wall of a frame; between top and bottom wall stands a column: a shell, or cylinders
with a sensor. The walls are beams clamped at both ends and struck in the middle. Sizes, solids and speed are those of
the case. Both models are elastic throughout (restitution 1), have no gravity and follow motion along the blow alone. A
solid bar in place of the frame, struck on its end, shows where simple models and elements must agree.

Symbols: E Young's modulus (Pa), G shear modulus (Pa), nu Poisson's ratio, L span (m), b width (m), t thickness (m),
I = b t^3/12 second moment (m^4), A = b t area (m^2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.fem.build import build_model, solid_of, vector
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_model
from strikewave.base import declare
from strikewave.base.errors import MISSING, InputError
from strikewave.base.shock_quantities import ACCELERATION, MEASURED_IMPULSE, MICROSECONDS
from strikewave.cases.case import Case, document_of
from strikewave.cases.tables.fem import AnyPart, Cylinder, FramePart, HalfCylinder, Tube
from strikewave.contact import (
    AnyContact,
    Chain,
    ChainContact,
    Geometry,
    Spring,
    Stop,
    contact_modulus,
    simulate,
    stiffness_of,
)
from strikewave.contact.chain import Link
from strikewave.fem.model import Model
from strikewave.fem.run import interval_means, middles
from strikewave.fem.solids import AnySolid, Elastic
from strikewave.papers.li_ma_2019.element_pulses import SPECIMEN, struck_body, whole_force
from strikewave.signal.pulse import WIDTH_FRACTION, crossing
from strikewave.waves import BONDED, BarRun, Impactor, Joint, Layer, Sampled, Stack, Tap, run_bar

MIDDLE_SHARE = 13.0 / 35.0
"""Share of the mass of a clamped beam that moves with its middle; see `FrameWall.middle_mass`."""


def bending_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle by bending, k = 192 E I/L^3, N/m.

    For thin beams (t below about L/10) whose ends neither move nor turn. Source: Euler-Bernoulli; Timoshenko,
    Strength of Materials I, 1955, art. 41.
    """
    return 16.0 * body.youngs_modulus * width * (thickness / span) ** 3


def shear_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a beam in its middle by shear alone, k = 4 kappa G A/L, N/m.

    Each half carries half the force: F L/(4 kappa G A). kappa = 10 (1 + nu)/(12 + 11 nu) of a rectangle (Cowper 1966).
    """
    nu = body.poissons_ratio
    kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
    modulus = 0.5 * body.youngs_modulus / (1.0 + nu)
    return 4.0 * kappa * modulus * width * thickness / span


def clamped_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle, bending and shear in series, N/m.

    Source: Timoshenko 1921, whose two deflections add under a static force.
    """
    sizes = (span, width, thickness)
    return 1.0 / (1.0 / bending_stiffness(body, *sizes) + 1.0 / shear_stiffness(body, *sizes))


@dataclass(frozen=True)
class FrameWall:
    """A wall of a frame between its side walls, struck in its middle; span L, width b, thickness t, m.

    A column bonded to its middle keeps the wall flat over the length ``flat``: by symmetry the rest is a clamped beam
    of the span less that length, whose middle carries the strip under the column too.
    """

    solid: AnySolid
    span: float
    width: float
    thickness: float
    flat: float = 0.0

    @property
    def mass(self) -> float:
        """Mass over the whole span, kg."""
        return self.solid.density * self.span * self.width * self.thickness

    @property
    def stiffness(self) -> float:
        """Force over deflection of the middle against the side walls, N/m."""
        return clamped_stiffness(self.solid, self.span - self.flat, self.width, self.thickness)

    @property
    def middle_mass(self) -> float:
        """Mass that moves with the middle, kg: 13/35 of the beam has its kinetic energy.

        Rayleigh's method with the static shape, w = 4 x^2 (3 L - 4 x)/L^3 up to the middle and mirrored beyond: the
        mean of w^2 is 13/35. Its first frequency is 1.6 % above the exact one, 22.373 sqrt(E I/(m L^3)). Source:
        Rayleigh, Theory of Sound, 1877, ch. IV.
        """
        share = self.flat / self.span
        return share * self.mass + MIDDLE_SHARE * ((1.0 - share) * self.mass)


def endless_compliance(solid: AnySolid, width: float, thickness: float) -> float:
    """Return C of a beam without ends: an impulse P upon it deflects that place by w = C P sqrt(t), m/(N s^1.5).

    C = 1/(sqrt(2 pi) (E I)^(1/4) m^(3/4)), m mass per length, from the Laplace transform of the Euler-Bernoulli beam,
    w(s) = F(s)/(2 sqrt(2) (E I)^(1/4) m^(3/4) s^(3/2)). It holds until bending waves come back from the ends.
    Timoshenko 1913 has this kind of equation for a ball on a beam; the kernel is derived here, the tests check it by
    modes.
    """
    inertia = width * thickness**3 / 12.0
    mass = solid.density * width * thickness
    return 1.0 / (math.sqrt(2.0 * math.pi) * (solid.youngs_modulus * inertia) ** 0.25 * mass**0.75)


Array = NDArray[np.float64]
LineLaw = Literal["palmgren", "johnson"]
LAW: LineLaw = "palmgren"
"""Default law of the line contact: that of the paper."""
Sides = Literal["in the layers", "hung"]


class Timed(Protocol):
    """A blow whose histories have a duration and an interval."""

    @property
    def duration(self) -> float:
        """Duration of the run, s."""

    @property
    def interval(self) -> float:
        """Interval of the histories, s."""


@dataclass(frozen=True)
class Piece:
    """A prismatic part of the column: name, solid, outer diameter (m), area (m^2), length (m)."""

    name: str
    solid: AnySolid
    diameter: float
    area: float
    length: float

    @property
    def mass(self) -> float:
        """Mass rho A l, kg."""
        return self.solid.density * self.area * self.length

    @property
    def stiffness(self) -> float:
        """Stiffness E A/l, N/m."""
        return self.solid.youngs_modulus * self.area / self.length


@dataclass(frozen=True)
class FrameBlow:
    """A half-cylinder that strikes a frame with a column in it, all whole; lengths in m, times in s.

    ``sides`` is the thickness of both side walls together; ``column`` goes from the top wall down; ``bonded`` ties it
    to the frame, else it may leave it; ``interval`` is the sampling interval of the histories.
    """

    striker: AnySolid
    frame: AnySolid
    radius: float
    striker_length: float
    speed: float
    width: float
    depth: float
    height: float
    sides: float
    bottom: float
    top: float
    column: tuple[Piece, ...]
    bonded: bool
    duration: float
    interval: float

    @property
    def striker_mass(self) -> float:
        """Mass of the striker, kg."""
        return 0.5 * math.pi * self.radius**2 * self.striker_length * self.striker.density

    @property
    def span(self) -> float:
        """Clear span of top and bottom wall, m."""
        return self.width - self.sides

    @property
    def mass(self) -> float:
        """Mass of frame and column, kg."""
        return self.side_mass + self.top_wall.mass + self.bottom_wall.mass + self.column_mass

    @property
    def side_mass(self) -> float:
        """Mass of both side walls over the whole height, kg."""
        return self.frame.density * self.sides * self.depth * self.height

    @property
    def column_mass(self) -> float:
        """Mass of the column, kg."""
        return sum(piece.mass for piece in self.column)

    @property
    def top_wall(self) -> FrameWall:
        """Top wall, with the upper end of the column on it."""
        return self._wall(self.top, self.column[0])

    @property
    def bottom_wall(self) -> FrameWall:
        """Bottom wall, with the lower end of the column on it."""
        return self._wall(self.bottom, self.column[-1])

    def _wall(self, thickness: float, piece: Piece) -> FrameWall:
        return FrameWall(self.frame, self.span, self.depth, thickness, piece.diameter if self.bonded else 0.0)

    def contact(self, law: LineLaw = LAW) -> AnyContact:
        """Return the elastic line contact of striker and frame; a law with a datum has it at the wall's far face."""
        sizes = Geometry(radius1=self.radius, length=self.depth, datum_depth=self.top)
        return stiffness_of(law, self.striker, self.frame, sizes).contact()


@declare.dataclass(eq=False)
class SimpleAnswer:
    """The pulse of a model in N, s, N s and m/s^2; histories are means over the intervals of the case."""

    name: str
    time: Array = field(repr=False)
    force: Array = field(repr=False)
    peak: float = declare.number(declare.NOT_MEASURED, "of the force, N: the peaks of joints are accelerations")
    width: float = declare.number(MICROSECONDS, "from the first to the last tenth of the peak, gaps included")
    first_width: float = declare.number(MICROSECONDS, "until the force first falls below a tenth")
    pulses: int = declare.count("how often the force rises above a tenth of its peak")
    impulse: float = declare.number(MEASURED_IMPULSE, "of the force")
    rigid_peak: float = declare.number(ACCELERATION, "of the force over the mass of the struck object")
    watched_peak: float | None = declare.number(ACCELERATION, "of the sensor, or of the far end of a bar", default=None)


def frame_blow(case: Case) -> FrameBlow:
    """Return the bodies of a case: one half-cylinder, one frame, and cylinders or tubes as the column.

    Raises `InputError` for a case with other parts.
    """
    parts = case.mesh.part if case.mesh else ()
    strikers = [part for part in parts if isinstance(part, HalfCylinder)]
    frames = [part for part in parts if isinstance(part, FramePart)]
    column = [part for part in parts if isinstance(part, Cylinder | Tube)]
    known = len(strikers) + len(frames) + len(column)
    if case.fem is None or len(strikers) != 1 or len(frames) != 1 or not column or known != len(parts):
        shapes = ", ".join(part.shape for part in parts) or MISSING
        raise InputError("mesh.part", shapes, "one half-cylinder, one frame and cylinders or tubes in it")
    striker, frame = strikers[0], frames[0]
    return FrameBlow(
        striker=solid_of(striker),
        frame=solid_of(frame),
        radius=striker.radius.si,
        striker_length=striker.length.si,
        speed=vector(frame.velocity)[2] - vector(striker.velocity)[2],
        width=frame.width.si,
        depth=frame.depth.si,
        height=frame.height.si,
        sides=frame.left.si + frame.right.si,
        bottom=frame.bottom.si,
        top=frame.top.si,
        column=tuple(_piece(part) for part in sorted(column, key=lambda part: -vector(part.at)[2])),
        bonded=bool(case.fem.tie),
        duration=case.fem.duration.si,
        interval=case.fem.interval.si,
    )


def _piece(part: AnyPart) -> Piece:
    if isinstance(part, Tube):
        diameter = part.outer_diameter.si
        area = 0.25 * math.pi * (diameter**2 - part.inner_diameter.si**2)
    elif isinstance(part, Cylinder):
        diameter = part.diameter.si
        area = 0.25 * math.pi * diameter**2
    else:
        raise InputError(f"mesh.part.{part.name}.shape", part.shape, "a cylinder or a tube")
    return Piece(part.name, solid_of(part), diameter, area, part.length.si)


def lumped(case: Case, law: LineLaw = LAW) -> SimpleAnswer:
    """Return the answer of a few masses: striker, middles of top and bottom wall, side walls, and a sensor.

    The middle of a wall has the mass that moves with it, on its bending spring to the side walls, which have the rest
    (`FrameWall`). A column without a sensor is one spring E A/l; with one, the pieces above and below it, each with
    half its own length, are two. Half of the mass of a spring is at either end: the column moves with the object, so
    halves, not the thirds of a spring whose end is fixed. A column that is not tied pushes only.

    It holds while the blow is long against the first periods that the masses leave out, those of waves in the column
    and of bending in the walls beyond the static shape; `body_reasons` measures the error.
    """
    blow = frame_blow(case)
    chain = _chain(blow, law)
    edges = edges_of(blow)
    motion = simulate(chain, {}, {"striker": blow.speed}, float(edges[-1]))
    momentum = blow.striker_mass * (blow.speed - motion.speeds(edges)[:, 0])
    sensor = None
    if SPECIMEN in chain.bodies:
        speeds = motion.speeds(edges)[:, list(chain.bodies).index(SPECIMEN)]
        sensor = float(interval_means(speeds, edges).max())
    return answer_of("lumped", edges, momentum, blow.mass, sensor)


def _chain(blow: FrameBlow, law: LineLaw) -> Chain:
    """Return the bodies as masses on springs; a column with a sensor is cut in the middle of the sensor."""
    top, bottom, column = blow.top_wall, blow.bottom_wall, blow.column
    at = next((k for k, piece in enumerate(column) if piece.name == SPECIMEN), None)
    nodes, stretches = ["top", "bottom"], [column]
    if at is not None:
        half = replace(column[at], length=0.5 * column[at].length)
        nodes, stretches = ["top", SPECIMEN, "bottom"], [(*column[:at], half), (half, *column[at + 1 :])]
    masses = {"striker": blow.striker_mass, **dict.fromkeys(nodes, 0.0)}
    masses["top"], masses["bottom"] = top.middle_mass, bottom.middle_mass
    masses["sides"] = blow.side_mass + top.mass + bottom.mass - top.middle_mass - bottom.middle_mass
    links: list[Link] = [
        ChainContact("striker", "top", blow.contact(law)),
        Spring("top", "sides", top.stiffness),
        Spring("bottom", "sides", bottom.stiffness),
    ]
    # a column that is not tied pushes, and never pulls
    join = Spring if blow.bonded else Stop
    for (behind, ahead), stretch in zip(pairwise(nodes), stretches, strict=True):
        links.append(join(behind, ahead, 1.0 / sum(1.0 / piece.stiffness for piece in stretch)))
        # halves, not thirds: the column moves with the object, none of its ends rests
        for end in (behind, ahead):
            masses[end] += 0.5 * sum(piece.mass for piece in stretch)
    return Chain(masses, links)


def layered(case: Case, sides: Sides = "in the layers", law: LineLaw = LAW) -> SimpleAnswer:
    """Return the answer of a bar of layers along the blow, by delay lines; the striker is rigid.

    With the sides "in the layers" each slice across the blow is a layer of all its material: the top wall over its
    whole width, side walls beside the column with their joint mass and stiffness, the bottom wall. With the sides
    "hung" the layers are the column and the strips of both walls above and below it; a strip weighs what moves with the
    middle of its wall. The rest hangs in halves, each a mass on the bending spring of a wall in its mid-plane: the wave
    down the side walls is left out. A column that is not tied may leave the strips.
    """
    blow = frame_blow(case)
    stack = _slices(blow) if sides == "in the layers" else _hung(blow)
    at = next((k for k, layer in enumerate(stack.layers) if layer.name == SPECIMEN), None)
    taps = [Tap(at or 0, 0.0), Tap(at or 0, 1.0)]
    run = run_bar(stack, Impactor(blow.striker_mass, blow.speed, blow.contact(law)), taps, blow.duration)
    # forces are compared as means over the intervals of the elements, whose histories are no instants
    momentum, edges = gathered(blow, run, run.face_force), edges_of(blow)
    sensor = None
    if at is not None:
        speed = gathered(blow, run, run.force[:, 0] - run.force[:, 1]) / stack.layers[at].mass
        sensor = float(interval_means(speed, edges).max())
    name = "layered" if sides == "in the layers" else "layered, sides hung"
    return answer_of(name, edges, momentum, blow.mass, sensor)


def _slices(blow: FrameBlow) -> Stack:
    """Return a layer for each slice across the blow."""
    walls = blow.sides * blow.depth
    layers = [layer_of("top", blow.frame, blow.width * blow.depth, blow.top)]
    for piece in blow.column:
        area = walls + piece.area
        density = (blow.frame.density * walls + piece.solid.density * piece.area) / area
        modulus = (blow.frame.youngs_modulus * walls + piece.solid.youngs_modulus * piece.area) / area
        layers.append(Layer(piece.name, density, modulus, area, piece.length))
    layers.append(layer_of("bottom", blow.frame, blow.width * blow.depth, blow.bottom))
    return Stack(tuple(layers), (BONDED,) * (len(layers) - 1))


def _hung(blow: FrameBlow) -> Stack:
    """Return strips and column as layers, the rest carried by the bending springs of the walls."""
    half_top, half_bottom = (
        layer_of(name, blow.frame, wall.middle_mass / (blow.frame.density * wall.thickness), 0.5 * wall.thickness)
        for name, wall in (("top", blow.top_wall), ("bottom", blow.bottom_wall))
    )
    column = tuple(layer_of(piece.name, piece.solid, piece.area, piece.length) for piece in blow.column)
    layers = (half_top, half_top, *column, half_bottom, half_bottom)
    rest = 0.5 * (blow.mass - sum(layer.mass for layer in layers))
    top, bottom = (Joint(wall.stiffness, attached=rest) for wall in (blow.top_wall, blow.bottom_wall))
    seat = BONDED if blow.bonded else Joint(unilateral=True)
    return Stack(layers, (top, seat, *(BONDED,) * (len(column) - 1), seat, bottom))


def layer_of(name: str, solid: AnySolid, area: float, length: float) -> Layer:
    """Return a layer of a solid; area in m^2, length in m."""
    return Layer(name, solid.density, solid.youngs_modulus, area, length)


def edges_of(blow: Timed) -> Array:
    """Return the instants of the histories, s."""
    return blow.interval * np.arange(math.ceil(blow.duration / blow.interval - 1e-9) + 1.0)


def gathered(blow: Timed, run: BarRun, rate: Array) -> Array:
    """Return the integral of a history of a bar at the instants of the histories."""
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(run.time))])
    return np.asarray(np.interp(edges_of(blow), run.time, sums))


def answer_of(name: str, edges: Array, impulse: Array, mass: float, watched: float | None) -> SimpleAnswer:
    """Measure a blow by the impulse of its force, N s, at the instants of the histories, s; mass of the object, kg.

    A pulse that is still above a tenth of its peak at the end of the run ends there.
    """
    time, force = middles(edges), interval_means(impulse, edges)
    peak = float(force.max())
    level = WIDTH_FRACTION * peak
    above = np.flatnonzero(force > level)
    first, last = int(above[0]), int(above[-1])
    places = [crossing(force, first, level, -1), crossing(force, first, level, 1), crossing(force, last, level, 1)]
    # a pulse that is up at an end of the record begins or ends there
    places = [0.0 if math.isnan(places[0]) else places[0], *np.nan_to_num(places[1:], nan=force.size - 1.0)]
    begin, fall, end = (float(t) for t in np.interp(places, np.arange(force.size), time))
    return SimpleAnswer(
        name=name,
        time=time,
        force=force,
        peak=peak,
        width=end - begin,
        impulse=float(impulse[-1]),
        first_width=fall - begin,
        pulses=1 + int(np.count_nonzero(np.diff(above) > 1)),
        rigid_peak=peak / mass,
        watched_peak=watched,
    )


BAR, END = "bar", "far end"
"""Name of the part, and of the section whose acceleration is watched."""
FINE = 2.0
"""Elements over the Hertz half-width of the line at peak force: enough for the force, pressures take three."""
ZONE, GROWTH = 2.0, 1.3
"""Depth of the fine zone over that half-width, in which the stress below a Hertz line, p/sqrt(1 + (z/a)^2), falls to
0.45 of its pressure, and growth of elements beyond it (chosen)."""
ACROSS = 10.0
"""Coarse elements over the radius of the striker and the side of the bar: the wave of the blow is far longer."""
LASTING = 1.8
"""Duration of a run over the width of the force of two masses. Chosen: long enough that the blow, which ends later
on a bar, is over."""
INTERVAL = 0.5e-6
"""Interval of the histories, s: half of that which the paper writes."""
UNKNOWN_DURATION = 1e-3
"""Duration in which the blow of two masses is solved to find its width, s: five times the published width."""
WATCHED_ELEMENT = 0.1
"""Height of the watched section over the free end, in coarse elements: within the last one."""


@dataclass(frozen=True)
class BarBlow:
    """A half-cylinder that strikes the end of a square bar, all elastic; lengths in m, speed in m/s, times in s."""

    striker: AnySolid
    bar: AnySolid
    radius: float
    striker_length: float
    speed: float
    side: float
    length: float
    duration: float
    interval: float

    @property
    def striker_mass(self) -> float:
        """Mass of the striker, kg."""
        return 0.5 * math.pi * self.radius**2 * self.striker_length * self.striker.density

    @property
    def mass(self) -> float:
        """Mass of the bar, kg."""
        return self.bar.density * self.side**2 * self.length

    def contact(self, datum_depth: float) -> AnyContact:
        """Return the line contact by Johnson, with the bar's yielding down to a depth in it."""
        sizes = Geometry(radius1=self.radius, length=self.side, datum_depth=datum_depth)
        return stiffness_of("johnson", self.striker, self.bar, sizes).contact()


def elastic(model: Model) -> Model:
    """Return a model none of whose parts yields."""
    solids = {
        name: Elastic(solid.density, solid.youngs_modulus, solid.poissons_ratio) for name, solid in model.solids.items()
    }
    return replace(model, solids=solids)


def solid_bar(case: Case, length: float | None = None) -> BarBlow:
    """Return the blow of a frame's striker on a square bar of its solid, as thick as it is deep and as long as high.

    The striker is cut to the depth of the frame: the part that stands out beside a bar would bear some of the load,
    which no line contact knows, and raise the force by about 3 %. ``length`` (m) replaces the height of the frame.
    """
    parts = case.mesh.part if case.mesh else ()
    (striker,) = (part for part in parts if isinstance(part, HalfCylinder))
    (frame,) = (part for part in parts if isinstance(part, FramePart))
    blow = BarBlow(
        striker=solid_of(striker),
        bar=solid_of(frame),
        radius=striker.radius.si,
        striker_length=frame.depth.si,
        speed=vector(frame.velocity)[2] - vector(striker.velocity)[2],
        side=frame.depth.si,
        length=length or frame.height.si,
        duration=UNKNOWN_DURATION,
        interval=INTERVAL,
    )
    return replace(blow, duration=LASTING * bar_lumped(blow).width)


def bar_lumped(blow: BarBlow) -> SimpleAnswer:
    """Return the answer of two masses: all of the bar's yielding, over its whole length, is in the contact law."""
    chain = Chain(
        {"striker": blow.striker_mass, BAR: blow.mass}, [ChainContact("striker", BAR, blow.contact(blow.length))]
    )
    edges = edges_of(blow)
    motion = simulate(chain, {}, {"striker": blow.speed}, float(edges[-1]))
    speeds = motion.speeds(edges)[:, 1]
    return answer_of("lumped", edges, blow.mass * speeds, blow.mass, float(interval_means(speeds, edges).max()))


def bar_layered(blow: BarBlow) -> SimpleAnswer:
    """Return the answer of a bar as one layer, by delay lines.

    The contact law has the yielding of the bar down to half its side, where a load that spreads by 45 degrees fills it;
    what lies deeper is the layer's.
    """
    edges = edges_of(blow)
    stack = Stack((layer_of(BAR, blow.bar, blow.side**2, blow.length),))
    striker = Impactor(blow.striker_mass, blow.speed, blow.contact(0.5 * blow.side))
    run = run_bar(stack, striker, [Tap(0, 1.0)], float(edges[-1]))
    end = float(interval_means(np.interp(edges, run.time, run.velocity[:, 0]), edges).max())
    return answer_of("layered", edges, gathered(blow, run, run.face_force), blow.mass, end)


def bar_dispersed(blow: BarBlow) -> float:
    """Return the peak acceleration of the far end where short waves run slower, m/s^2.

    The layer is that of a round bar of the same area by Love and Rayleigh, under the force of `bar_layered`, by the
    spectral solver.
    """
    answer, edges = bar_layered(blow), edges_of(blow)
    layer = layer_of(BAR, blow.bar, blow.side**2, blow.length)
    slow = replace(layer, dispersion="love-rayleigh", poissons_ratio=blow.bar.poissons_ratio)
    load = Sampled(np.append(0.0, answer.time), np.append(0.0, answer.force))
    run = run_bar(Stack((slow,)), load, [Tap(0, 1.0)], float(edges[-1]))
    return float(interval_means(np.interp(edges, run.time, run.velocity[:, 0]), edges).max())


def bar_case(blow: BarBlow, case: Case) -> Case:
    """Return the case of a blow in finite elements, with solids, length and radius of the frame's case."""
    parts = document_of(case)["mesh"]["part"]
    (striker,) = (part for part in parts if part["shape"] == "half-cylinder")
    (frame,) = (part for part in parts if part["shape"] == "frame")
    # Hertz half-width of the line at the peak of the force, a^2 = 4 F R/(pi E* h) (Johnson 1985)
    modulus = contact_modulus(blow.striker, blow.bar)
    fine = math.sqrt(4.0 * bar_lumped(blow).peak * blow.radius / (math.pi * modulus * blow.side))
    mesh = {"finest": f"{fine / FINE!r} m", "extent": f"{ZONE * fine!r} m", "growth": GROWTH, "sector": "quarter"}
    side, height = f"{blow.side!r} m", f"{blow.length!r} m"
    bar = {"name": BAR, "shape": "block", "width": side, "depth": side, "height": height}
    own = {key: frame[key] for key in ("material", "solid") if key in frame}
    struck = mesh | {
        "length": f"{blow.striker_length!r} m",
        "at": {"z": f"{blow.length + blow.radius!r} m"},
        "size": f"{blow.radius / ACROSS!r} m",
    }
    cuts = [f"{name}.{cut}" for name in (striker["name"], BAR) for cut in ("x-", "y-")]
    watched = {"z": f"{WATCHED_ELEMENT * blow.side / ACROSS!r} m"}
    return Case.model_validate(
        {
            "schema": 1,
            "name": f"{case.name}-bar",
            "source": case.source,
            "mesh": {"part": [striker | struck, bar | own | mesh | {"size": f"{blow.side / ACROSS!r} m"}]},
            "fem": {
                "duration": f"{blow.duration!r} s",
                "interval": f"{blow.interval!r} s",
                "contact": [{"first": f"{BAR}.z+", "second": f"{striker['name']}.round"}],
                "boundary": [{"kind": "symmetry", "side": cut} for cut in cuts],
                "section": [{"name": END, "part": BAR, "point": watched, "normal": "z"}],
            },
        }
    )


def element_answer(solution: FemSolution, watched: float | None) -> SimpleAnswer:
    """Return the answer of elements on the first contact of a model, of whole bodies; ``watched`` in m/s^2."""
    contact_force = whole_force(solution)
    if contact_force is None:
        raise ValueError(f"nothing touched in {solution.case.name}")
    _, force, _ = contact_force
    spans = np.diff(solution.run.time)
    body = struck_body(solution)
    mass = {**solution.parts, **solution.groups}[body].mass
    return answer_of("elements", solution.run.time, np.concatenate([[0.0], np.cumsum(force * spans)]), mass, watched)


def bar_elements(blow: BarBlow, case: Case, threads: int = 1) -> SimpleAnswer:
    """Return the answer of finite elements, elastic: a quarter, as fine at the contact as its width asks for."""
    struck_bar = bar_case(blow, case)
    solution = run_model(struck_bar, elastic(build_model(struck_bar, threads)))
    speeds = solution.run.sections[END].velocity[:, 2]
    return element_answer(solution, float(-interval_means(speeds, solution.run.time).min()))
