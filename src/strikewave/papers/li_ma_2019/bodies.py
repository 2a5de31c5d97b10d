"""The bodies of a finite-element case as masses on springs, walls as beams, and layers of a bar: nothing fitted.

Walls of a frame as beams clamped at both ends and struck in the middle: stiffness, and the mass that moves. Symbols:
E Young's modulus (Pa), G shear modulus (Pa), nu Poisson's ratio, L span (m), b width (m), t thickness (m), I = b
t^3/12 second moment (m^4), A = b t area (m^2).

The bodies of a finite-element case as a few masses on springs, and as layers of a bar: nothing fitted.
A half-cylinder strikes the top wall of a frame; between its top and bottom wall stands a column: a shell, or
cylinders with a sensor. Sizes, solids and speed are those of the case. Both answers are elastic throughout
(restitution 1: what elements lose to yielding is not in them), have no gravity, and follow motion along the blow alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.fem.build import solid_of, vector
from strikewave.base.errors import MISSING, InputError
from strikewave.cases.case import Case
from strikewave.cases.tables.fem import AnyPart, Cylinder, FramePart, HalfCylinder, Tube
from strikewave.contact import AnyContact, Chain, ChainContact, Geometry, Spring, Stop, simulate, stiffness_of
from strikewave.contact.chain import Link
from strikewave.fem.run import interval_means, middles
from strikewave.fem.solids import AnySolid
from strikewave.papers.li_ma_2019.element_pulses import SPECIMEN
from strikewave.signal.pulse import WIDTH_FRACTION, crossing
from strikewave.waves import BONDED, BarRun, Impactor, Joint, Layer, Stack, Tap, run_bar

MIDDLE_SHARE = 13.0 / 35.0
"""Share of the mass of a clamped beam that moves with its middle; see `middle_mass`."""


def bending_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle by bending, k = 192 E I/L^3, N/m.

    For thin beams (t below about L/10) whose ends neither move nor turn. Source: Euler-Bernoulli; Timoshenko,
    Strength of Materials I, 1955, art. 41.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(bending_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 3)
    12.66
    """
    return 16.0 * body.youngs_modulus * width * (thickness / span) ** 3


def shear_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a beam in its middle by shear alone, k = 4 kappa G A/L, N/m.

    Each half carries half the force: F L/(4 kappa G A). kappa = 10 (1 + nu)/(12 + 11 nu) of a rectangle (Cowper 1966).

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(shear_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 1)
    417.3
    """
    nu = body.poissons_ratio
    kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
    modulus = 0.5 * body.youngs_modulus / (1.0 + nu)
    return 4.0 * kappa * modulus * width * thickness / span


def clamped_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle, bending and shear in series, N/m.

    Source: Timoshenko 1921, whose two deflections add under a force that rests.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(clamped_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 3)
    12.287
    """
    sizes = (span, width, thickness)
    return 1.0 / (1.0 / bending_stiffness(body, *sizes) + 1.0 / shear_stiffness(body, *sizes))


def middle_mass(mass: float) -> float:
    """Return the mass at the middle of a clamped beam that has its kinetic energy, 13/35 of its own, kg.

    Rayleigh's method with the shape under a force that rests, w = 4 x^2 (3 L - 4 x)/L^3 up to the middle and mirrored
    beyond: the mean of w^2 is 13/35. Its first frequency is 1.6 % above the exact one, 22.373 sqrt(E I/(m L^3)).
    Source: Rayleigh, Theory of Sound, 1877, ch. IV.

    Examples
    --------
    >>> round(middle_mass(0.35), 6)
    0.13
    """
    return MIDDLE_SHARE * mass


@dataclass(frozen=True)
class FrameWall:
    """A wall of a frame between its side walls, struck in its middle.

    Where a column is bonded to its middle, the wall neither bends nor turns there: by symmetry what is left is a
    clamped beam of the span less the column, whose middle carries the strip under the column too.

    Parameters
    ----------
    solid : solid
    span, width, thickness : float
        L, b, t, m.
    held : float
        Length of the span that a bonded column holds flat, m.
    """

    solid: AnySolid
    span: float
    width: float
    thickness: float
    held: float = 0.0

    @property
    def mass(self) -> float:
        """Mass over the whole span, kg."""
        return self.solid.density * self.span * self.width * self.thickness

    @property
    def stiffness(self) -> float:
        """Force over deflection of the middle against the side walls, N/m."""
        return clamped_stiffness(self.solid, self.span - self.held, self.width, self.thickness)

    @property
    def middle_mass(self) -> float:
        """Mass that moves with the middle, kg."""
        share = self.held / self.span
        return share * self.mass + middle_mass((1.0 - share) * self.mass)


def endless_compliance(solid: AnySolid, width: float, thickness: float) -> float:
    """Return C of a beam without ends: an impulse P upon it deflects that place by w = C P sqrt(t), m/(N s^1.5).

    C = 1/(sqrt(2 pi) (E I)^(1/4) m^(3/4)), m mass per length: that of the Euler-Bernoulli beam, transformed by Laplace
    w(s) = F(s)/(2 sqrt(2) (E I)^(1/4) m^(3/4) s^(3/2)). It holds until bending waves come back from the ends. Source:
    the kind of equation is that of Timoshenko 1913 for a ball on a beam; the kernel is derived here, the tests find it
    by modes of a long beam.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> print(f"{endless_compliance(Elastic(7820.0, 211e9, 0.288), 0.03, 0.005):.5f}")
    0.12421
    """
    inertia = width * thickness**3 / 12.0
    mass = solid.density * width * thickness
    return 1.0 / (math.sqrt(2.0 * math.pi) * (solid.youngs_modulus * inertia) ** 0.25 * mass**0.75)


Array = NDArray[np.float64]
LineLaw = Literal["palmgren", "johnson"]
LAW: LineLaw = "palmgren"
"""Law of the line contact unless another is asked for: that of the paper."""
Sides = Literal["in the layers", "hung"]


class Timed(Protocol):
    """A blow whose histories have a duration and an interval, s."""

    @property
    def duration(self) -> float:
        """Of the run, s."""

    @property
    def interval(self) -> float:
        """Of the histories, s."""


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
    """A half-cylinder that strikes a frame with a column in it, all whole.

    Attributes
    ----------
    striker, frame : solid
    radius, striker_length, speed : float
        Radius and length of the striker, m, and its speed, m/s.
    width, depth, height : float
        Dimensions of the frame, m.
    sides, bottom, top : float
        Thicknesses of its walls, m; ``sides`` of both side walls together.
    column : tuple of Piece
        From the top wall down.
    bonded : bool
        True if the column is tied to the frame; else it may leave it.
    duration, interval : float
        Duration of the run and sampling interval of its histories, s.
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
    def opening(self) -> float:
        """Height of the opening, m."""
        return self.height - self.top - self.bottom

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


@dataclass(frozen=True)
class SimpleAnswer:
    """What a simple model says of a blow; histories are means over the intervals of the case, as of elements.

    Attributes
    ----------
    name : str
    time, force : array
        Middles of the intervals, s; contact force, N.
    peak, width, impulse : float
        Peak of the force, N; time from the first to the last tenth of the peak, gaps included, s; impulse, N s.
    first_width : float
        From the first tenth of the peak until the force first falls below a tenth, s.
    pulses : int
        How often the force rises above a tenth of its peak.
    rigid_peak : float
        Peak of the force over the mass of the struck object, m/s^2.
    watched_peak : float or None
        Largest acceleration of what is watched, m/s^2: the mean of the part ``sensor``, the far end of a bar.
    """

    name: str
    time: Array = field(repr=False)
    force: Array = field(repr=False)
    peak: float
    width: float
    impulse: float
    first_width: float
    pulses: int
    rigid_peak: float
    watched_peak: float | None = None


def frame_blow(case: Case) -> FrameBlow:
    """Return the bodies of a case: one half-cylinder, one frame, and cylinders or tubes as the column.

    Examples
    --------
    >>> from strikewave import load_case
    >>> blow = frame_blow(load_case("li-ma-2019-fem-rigid"))
    >>> round(blow.striker_mass, 3), round(blow.mass, 3), [piece.name for piece in blow.column]
    (0.663, 0.459, ['shell'])
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

    The middle of a wall has what of its mass moves with it, on its bending spring to the side walls, which have the
    rest (`Wall`). A column without a sensor is one spring E A/l; with one, the pieces above and below it, each
    with half its own length, are two. Half of the mass of a spring is at either end: what the column weighs moves with
    the object, so halves, not the thirds of a spring that is held. A column that is not tied pushes only.

    It holds while the blow lasts long beside the first periods that the masses leave out, those of waves in the column
    and of bending in the walls beyond the static shape; `body_reasons` measures by how much it does not.

    Parameters
    ----------
    case : Case
        Case of elements; see `frame_blow`.
    law : str
        Law of the line contact.

    Examples
    --------
    >>> from strikewave import load_case
    >>> answer = lumped(load_case("li-ma-2019-fem-rigid", ["fem.duration=300 us"]))
    >>> answer.watched_peak is None, answer.peak > 0.0
    (True, True)
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
    return _answer("lumped", blow, momentum, sensor)


def _chain(blow: FrameBlow, law: LineLaw) -> Chain:
    top, bottom = blow.top_wall, blow.bottom_wall
    stretches = _stretches(blow.column)
    nodes = ["top", SPECIMEN, "bottom"] if len(stretches) == 2 else ["top", "bottom"]
    masses = {"striker": blow.striker_mass, **dict.fromkeys(nodes, 0.0)}
    masses["top"], masses["bottom"] = top.middle_mass, bottom.middle_mass
    masses["sides"] = blow.side_mass + top.mass + bottom.mass - top.middle_mass - bottom.middle_mass
    links: list[Link] = [
        ChainContact("striker", "top", blow.contact(law)),
        Spring("top", "sides", top.stiffness),
        Spring("bottom", "sides", bottom.stiffness),
    ]
    join = Spring if blow.bonded else Stop
    for (behind, ahead), stretch in zip(pairwise(nodes), stretches, strict=True):
        links.append(join(behind, ahead, 1.0 / sum(1.0 / piece.stiffness for piece in stretch)))
        for end in (behind, ahead):
            masses[end] += 0.5 * sum(piece.mass for piece in stretch)
    return Chain(masses, links)


def _stretches(column: Sequence[Piece]) -> list[tuple[Piece, ...]]:
    """Return what each spring of the chain is made of: the whole column, or what is above and below mid-sensor."""
    at = next((k for k, piece in enumerate(column) if piece.name == SPECIMEN), None)
    if at is None:
        return [tuple(column)]
    half = replace(column[at], length=0.5 * column[at].length)
    return [(*column[:at], half), (half, *column[at + 1 :])]


def layered(case: Case, sides: Sides = "in the layers", law: LineLaw = LAW) -> SimpleAnswer:
    """Return the answer of a bar of layers along the blow, by delay lines; the striker is rigid.

    Parameters
    ----------
    case : Case
        Case of elements; see `frame_blow`.
    sides : str
        "in the layers": each slice across the blow is a layer of all its material: the top wall over its whole width,
        side walls beside the column with their joint mass and stiffness, the bottom wall. "hung": layers are the
        column and the strips of both walls above and below it; a strip weighs what moves with the middle of its wall.
        All the rest hangs in halves, each a mass on the bending spring of a wall in its mid-plane: the wave down the
        side walls is left out. A column that is not tied may leave the strips.
    law : str
        Law of the line contact.

    Examples
    --------
    >>> from strikewave import load_case
    >>> answer = layered(load_case("li-ma-2019-fem-wave", ["fem.duration=50 us"]))
    >>> answer.name, answer.watched_peak > 0.0
    ('layered', True)
    """
    blow = frame_blow(case)
    stack = _slices(blow) if sides == "in the layers" else _hung(blow)
    at = next((k for k, layer in enumerate(stack.layers) if layer.name == SPECIMEN), None)
    taps = [Tap(at or 0, 0.0), Tap(at or 0, 1.0)]
    run = run_bar(stack, Impactor(blow.striker_mass, blow.speed, blow.contact(law)), taps, blow.duration)
    momentum, edges = gathered(blow, run, run.face_force), edges_of(blow)
    sensor = None
    if at is not None:
        speed = gathered(blow, run, run.force[:, 0] - run.force[:, 1]) / stack.layers[at].mass
        sensor = float(interval_means(speed, edges).max())
    return _answer("layered" if sides == "in the layers" else "layered, sides hung", blow, momentum, sensor)


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


def _answer(name: str, blow: FrameBlow, momentum: Array, sensor: float | None) -> SimpleAnswer:
    return answer_of(name, edges_of(blow), momentum, blow.mass, sensor)


def edges_of(blow: Timed) -> Array:
    """Return the instants of the histories, s."""
    return blow.interval * np.arange(math.ceil(blow.duration / blow.interval - 1e-9) + 1.0)


def gathered(blow: Timed, run: BarRun, rate: Array) -> Array:
    """Return the integral of a history of a bar at the instants of the histories."""
    sums = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(run.time))])
    return np.asarray(np.interp(edges_of(blow), run.time, sums))


def answer_of(name: str, edges: Array, impulse: Array, mass: float, watched: float | None) -> SimpleAnswer:
    """Measure a blow by the impulse of its force, N s, at the instants of the histories, s; mass of the object, kg."""
    time, force = middles(edges), interval_means(impulse, edges)
    peak = float(force.max())
    widths = pulse_widths(time, force)
    return SimpleAnswer(
        name=name,
        time=time,
        force=force,
        peak=peak,
        width=widths.whole,
        impulse=float(impulse[-1]),
        first_width=widths.first,
        pulses=widths.pulses,
        rigid_peak=peak / mass,
        watched_peak=watched,
    )


class Widths(NamedTuple):
    """Of a force above a tenth of its peak: from first to last, of the first stretch, s; how many stretches."""

    whole: float
    first: float
    pulses: int


def pulse_widths(time: Array, force: Array) -> Widths:
    """Measure how long a force is above a tenth of its peak; one that is still there at the end ends with it.

    Examples
    --------
    >>> widths = pulse_widths(np.arange(5.0), np.array([0.0, 10.0, 0.0, 10.0, 0.0]))
    >>> round(widths.whole, 3), round(widths.first, 3), widths.pulses
    (3.8, 1.8, 2)
    """
    level = WIDTH_FRACTION * float(force.max())
    above = np.flatnonzero(force > level)
    first, last = int(above[0]), int(above[-1])
    places = [crossing(force, first, level, -1), crossing(force, first, level, 1), crossing(force, last, level, 1)]
    places = [0.0 if math.isnan(places[0]) else places[0], *np.nan_to_num(places[1:], nan=force.size - 1.0)]
    begin, fall, end = (float(t) for t in np.interp(places, np.arange(force.size), time))
    return Widths(end - begin, fall - begin, 1 + int(np.count_nonzero(np.diff(above) > 1)))
