"""Geometry of a rotary machine and its motion: outlines that a picture or a page can draw.

The blow points along x. The axis of the turntable is the origin, and it turns from x to y. The strikers' noses are
circles about centres that run on the path, so that a nose whose centre reaches x touches a plane at x plus the
nose's radius, whatever its angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.cases.contact_of_case import or_else
from strikewave.cases.tables.machine import RotaryTable, StrikerTable

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.cases.tables.stack import LayerTable

Array = NDArray[np.float64]

GROUND, DISC, NOSE, ASSEMBLY, CARRIAGE = "ground", "disc", "nose", "assembly", "carriage"
"""Bodies that a drawn part can move with."""
LARGEST_NOSE, LONGEST_STROKE = 0.2, 2.0
"""Largest radius of a nose and longest stroke that are drawn to scale, in path radii."""
STACK_LENGTHS, STACK_HEIGHTS = (0.3, 0.8), (0.1, 0.5)
"""Lengths and diameters of a stack that are drawn to scale, in path radii."""


@dataclass(frozen=True)
class StrikeGeometry:
    """The path of the noses' centres and the face that stands in it, m and rad.

    ``engagement`` is the depth of the face at rest inside the reach of a nose at the strike position; ``blow_angle``
    that between the outward radius there and the blow, 0 for a cam, pi/2 for a tangential strike; ``face_width`` is
    None where the case sets no limit; ``errors`` holds angle ahead and reach beyond the path of each striker, and
    nothing where all are alike.
    """

    radius: float
    strikers: int
    engagement: float
    nose_radius: float
    blow_angle: float = 0.0
    face_width: float | None = None
    errors: tuple[tuple[float, float], ...] = ()

    @property
    def pitch(self) -> float:
        """Angle between strikers."""
        return 2.0 * math.pi / self.strikers

    @property
    def strike_position(self) -> tuple[float, float]:
        """Centre of a nose at the strike position."""
        return self.radius * math.cos(self.blow_angle), -self.radius * math.sin(self.blow_angle)

    @property
    def reach(self) -> float:
        """Reach along the blow of the nose of a striker at the strike position."""
        return self.strike_position[0] + self.nose_radius

    def noses(self, angle: float) -> Array:
        """Return the centres of the noses, shape (strikers, 2); at angle 0 the first is at the strike position."""
        ahead, beyond = np.array(self.errors or [(0.0, 0.0)]).T
        turned = angle - self.pitch * np.arange(self.strikers) - self.blow_angle + ahead
        return np.asarray((self.radius + beyond) * np.array([np.cos(turned), np.sin(turned)])).T

    def touch_angle(self, displacement: float = 0.0) -> float:
        """Return the angle before the strike position (negative) at which a nose meets the face.

        ``displacement`` is how far the face has gone back from its rest; NaN where no nose reaches it. For a cam it is
        -arccos(1 - q/R).

        Examples
        --------
        >>> cam = StrikeGeometry(radius=0.2, strikers=4, engagement=5.5e-3, nose_radius=0.01)
        >>> round(math.degrees(cam.touch_angle()), 3)
        -13.468
        """
        share = math.cos(self.blow_angle) - (self.engagement - displacement) / self.radius
        return self.blow_angle - math.acos(share) if abs(share) <= 1.0 else math.nan

    @property
    def half_face(self) -> float:
        """Half the width of the face; where none is set, just beyond the place of first touch."""
        if self.face_width is not None:
            return 0.5 * self.face_width
        return self.touch_distance + 0.5 * self.nose_radius

    @property
    def touch_distance(self) -> float:
        """Distance across the blow from the strike position to first touch, m; 0 where no nose reaches the face.

        Examples
        --------
        >>> cam = StrikeGeometry(radius=0.2, strikers=4, engagement=5.5e-3, nose_radius=0.01)
        >>> round(cam.touch_distance * 1e3, 2)  # sqrt(2 R q - q^2)
        46.58
        """
        angle = self.touch_angle()
        return 0.0 if math.isnan(angle) else abs(float(self.noses(angle)[0, 1]) - self.strike_position[1])

    def approach(self, speed: float) -> float:
        """Return the speed along the blow at which a nose meets the face at rest, m/s; ``speed`` in rad/s.

        Examples
        --------
        >>> cam = StrikeGeometry(radius=0.2, strikers=4, engagement=5.5e-3, nose_radius=0.01)
        >>> round(cam.approach(76.4), 4)  # w sqrt(2 R q - q^2)
        3.5588
        """
        return speed * self.radius * math.sin(self.blow_angle - self.touch_angle())


def strike_geometry(case: Case) -> StrikeGeometry | None:
    """Return the geometry of a rotary machine; None for any other case.

    Examples
    --------
    >>> from strikewave import load_case
    >>> strike_geometry(load_case("li-ma-2019")).strikers
    4
    """
    if not isinstance(case.machine, RotaryTable):
        return None
    machine, striker = case.rotary_tables().machine, case.rotary_tables().striker
    angle, width, radius = machine.blow_angle, machine.face_width, machine.radius.si
    count = int(machine.strikers.si)
    return StrikeGeometry(
        radius=radius,
        strikers=count,
        engagement=machine.engagement.si,
        nose_radius=min(striker.nose_radius.si, LARGEST_NOSE * radius),
        blow_angle=or_else(angle, 0.0),
        face_width=None if width is None else width.si,
        errors=_errors(striker, count),
    )


def _errors(striker: StrikerTable, count: int) -> tuple[tuple[float, float], ...]:
    """Return angle ahead of its place and reach beyond the path of each striker, rad and m."""
    own = {
        int(row.number.si): (or_else(row.angle_error, 0.0), or_else(row.reach_error, 0.0))
        for row in striker.each
        if row.angle_error is not None or row.reach_error is not None
    }
    return tuple(own.get(number, (0.0, 0.0)) for number in range(1, count + 1)) if own else ()


class Pose(NamedTuple):
    """Displacement of each part: angle of the turntable (rad), places of nose, assembly and carriage (m).

    Nose and assembly count from where a face at the reach of the noses would be; the carriage is at 0 when fed.
    """

    angle: float
    nose: float
    assembly: float
    carriage: float

    def shift(self, group: str) -> float:
        """Return the displacement of the parts of a group along the blow, m."""
        return {NOSE: self.nose, ASSEMBLY: self.assembly, CARRIAGE: self.carriage}.get(group, 0.0)


class Outline(NamedTuple):
    """A closed outline: the group that it moves with, its look, and its corners, shape (N, 2), m."""

    group: str
    look: str
    points: Array


class Connection(NamedTuple):
    """A spring, damper or rod between two parts: its end on each, and its lines, x as a share of the way, y in m."""

    groups: tuple[str, str]
    ends: tuple[float, float]
    lines: tuple[Array, ...]


class LabelPlaces(NamedTuple):
    """Places of the parts that words point at, m, at rest in the strike position."""

    half_height: float
    face: float
    middles: dict[str, tuple[float, float]]
    wall: float
    floor: float
    far_end: float


class Outlines(NamedTuple):
    """A machine as it is drawn; ``to_scale`` is True where the layers of a stack are, the lengths of bodies never."""

    geometry: StrikeGeometry
    shapes: tuple[Outline, ...]
    connections: tuple[Connection, ...]
    places: LabelPlaces
    to_scale: bool


LOOKS = {
    "disc": ("#e9edf0", "#4d5760", 1.0),
    "hub": ("#c4cbd0", "#4d5760", 1.0),
    "striker": ("#9fc5de", "#00507d", 1.0),
    "nose": ("#0072B2", "#00507d", 1.0),
    "face": ("#D55E00", "#D55E00", 2.4),
    "body": ("#f2d9c8", "#8f3f00", 1.0),
    "body 2": ("#f8eae0", "#8f3f00", 1.0),
    "carriage": ("#d9d9d9", "#4a4a4a", 1.0),
    "stop": ("#E69F00", "#7d5700", 1.0),
    "ground": ("#8a949c", "#4a4a4a", 0.6),
}
"""Filling, edge and width of an outline, by look."""


def outlines(case: Case) -> Outlines | None:
    """Return a rotary machine as outlines; None for any other case."""
    geometry = strike_geometry(case)
    if geometry is None or case.feed is None:
        return None
    object_, lengths, to_scale = _object(case, geometry)
    at = _levels(case, geometry, lengths)
    shapes = (*_turntable(geometry), *_holding(geometry, at, lengths.half_height), *object_)
    connections = _connections(geometry, at, lengths.frame)
    return Outlines(geometry, shapes, connections, _places(geometry, at, lengths.names), to_scale)


class Lengths(NamedTuple):
    """Ends of the object's frame, its own end, half its height, and the middles of its named parts, m from the face."""

    frame: tuple[float, float] | None
    end: float
    half_height: float
    names: dict[str, float]


def _object(case: Case, geometry: StrikeGeometry) -> tuple[list[Outline], Lengths, bool]:
    """Return the struck object: nose and assembly, or the layers of a stack."""
    radius, layers = geometry.radius, case.stack.layer
    if layers:
        shapes, lengths, to_scale = _layers(case, geometry)
    else:
        high, face = 0.16 * radius, 0.16 * radius if geometry.face_width is None else geometry.half_face
        lengths = Lengths((0.1 * radius, 0.27 * radius), 0.62 * radius, high, {})
        lengths.names.update({"nose": 0.05 * radius, "frame": 0.185 * radius, "assembly": 0.445 * radius})
        shapes = [
            _block(geometry, NOSE, "body", (0.0, 0.1 * radius), (-face, face)),
            _block(geometry, ASSEMBLY, "body 2", (0.27 * radius, 0.62 * radius), (-high, high)),
        ]
        to_scale = False
    half = max(geometry.half_face, lengths.half_height if geometry.face_width is None else 0.0)
    shapes.append(_block(geometry, NOSE, "face", (0.0, 0.0), (-half, half)))
    return shapes, lengths, to_scale


def _layers(case: Case, geometry: StrikeGeometry) -> tuple[list[Outline], Lengths, bool]:
    """Return the layers of a stack, drawn to scale where that can be read."""
    layers, radius = case.stack.layer, geometry.radius
    diameters = [_diameter(layer) for layer in layers]
    total, widest = sum([layer.length.si for layer in layers]), max(diameters)
    along = min(max(total / radius, STACK_LENGTHS[0]), STACK_LENGTHS[1]) * radius / total
    across = min(max(widest / radius, STACK_HEIGHTS[0]), STACK_HEIGHTS[1]) * radius / widest
    assembly = case.object.assembly if case.object is not None else ""
    first = next((k for k, layer in enumerate(layers) if layer.name == assembly), 0)
    shapes, begin, names = [], 0.0, {}
    for k, layer in enumerate(layers):
        end, half = begin + along * layer.length.si, 0.5 * across * diameters[k]
        group, look = (NOSE if k < first else ASSEMBLY), ("body" if k % 2 == 0 else "body 2")
        shapes.append(_block(geometry, group, look, (begin, end), (-half, half)))
        names[f"layer {layer.name}"], begin = 0.5 * (begin + end), end
    lengths = Lengths(None, begin, 0.5 * across * widest, names)
    return shapes, lengths, math.isclose(along, 1.0) and math.isclose(across, 1.0)


def _diameter(layer: LayerTable) -> float:
    """Return the diameter of a layer, m; of another section that of a circle of the same area."""
    if layer.diameter is not None:
        return layer.diameter.si
    if layer.area is None:
        raise InputError(f"stack.layer.{layer.name}.diameter", None, "a diameter or an area")
    return math.sqrt(4.0 * layer.area.si / math.pi)


def _block(geometry: StrikeGeometry, group: str, look: str, x: tuple[float, float], y: tuple[float, float]) -> Outline:
    """Return a rectangle; x counts from the face, y from the line of the blow through the strike position."""
    base = np.array([geometry.reach, geometry.strike_position[1]])
    return Outline(group, look, base + np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]))


def _circle(centre: tuple[float, float], radius: float, corners: int = 72) -> Array:
    turn = np.linspace(0.0, 2.0 * math.pi, corners, endpoint=False)
    return np.array(centre) + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def _turntable(geometry: StrikeGeometry) -> list[Outline]:
    """Return disc, strikers and noses, the first striker at the strike position when the angle is 0."""
    radius, nose = geometry.radius, geometry.nose_radius
    rim = max(0.82 * (radius - nose), 0.3 * radius)
    half = min(0.06 * radius, 0.3 * geometry.pitch * rim)
    shapes = [Outline(DISC, "disc", _circle((0.0, 0.0), rim, 96))]
    for x, y in geometry.noses(geometry.blow_angle):
        out = math.hypot(x, y)
        turn = np.array([[x, y], [-y, x]]) / out
        arm = np.array([(0.8 * rim, -half), (out, -half), (out, half), (0.8 * rim, half)])
        shapes.append(Outline(DISC, "striker", arm @ turn))
        shapes.append(Outline(DISC, "nose", _circle((x, y), nose, 36)))
    return [*shapes, Outline(DISC, "hub", _circle((0.0, 0.0), 0.1 * rim, 36))]


class Levels(NamedTuple):
    """Levels of the parts that hold the object: x from the struck face at rest, y from the line of the blow, m.

    ``unit`` is a hundredth of the path's radius, in which symbols are sized.
    """

    unit: float
    high: float
    floor: float
    lug: float
    flange: float
    end: float
    wall: float
    cylinder: float


def _levels(case: Case, geometry: StrikeGeometry, lengths: Lengths) -> Levels:
    """Return the levels of carriage, stop and feed; the cylinder is clear of a carriage that is back."""
    stroke = case.feed.stroke.si if case.feed is not None else 0.0
    unit = 0.01 * geometry.radius
    high, end = max(lengths.half_height, 12.0 * unit), lengths.end
    wall = end + 36.0 * unit
    return Levels(
        unit=unit,
        high=high,
        floor=-high - 20.0 * unit,
        lug=end - 17.0 * unit,
        flange=end - 6.0 * unit,
        end=end,
        wall=wall,
        cylinder=wall + 10.0 * unit + min(stroke, LONGEST_STROKE * geometry.radius),
    )


def _holding(geometry: StrikeGeometry, at: Levels, half_height: float) -> list[Outline]:
    """Return rails, cylinder, carriage with its lug and wall, the stop on the lug, and the flange that meets it."""
    unit, floor, wall = at.unit, at.floor, at.wall

    def block(group: str, look: str, x: tuple[float, float], y: tuple[float, float]) -> Outline:
        rest = 0.0 if group == ASSEMBLY else geometry.engagement
        return _block(geometry, group, look, (x[0] - rest, x[1] - rest), y)

    below = floor - 6.0 * unit
    return [
        block(GROUND, "ground", (at.lug - 10.0 * unit, at.cylinder + 26.0 * unit), (below - 3.0 * unit, below)),
        block(GROUND, "ground", (at.cylinder, at.cylinder + 26.0 * unit), (-6.0 * unit, 6.0 * unit)),
        block(CARRIAGE, "carriage", (at.lug, wall + 6.0 * unit), (below, floor)),
        block(CARRIAGE, "carriage", (wall, wall + 6.0 * unit), (floor, at.high)),
        block(CARRIAGE, "carriage", (at.lug, at.lug + 5.0 * unit), (floor, -at.high - 3.0 * unit)),
        block(CARRIAGE, "stop", (at.lug + 5.0 * unit, at.flange), (-at.high - 12.0 * unit, -at.high - 4.0 * unit)),
        block(ASSEMBLY, "body 2", (at.flange, at.end), (-at.high - 13.0 * unit, -0.9 * half_height)),
    ]


def _connections(geometry: StrikeGeometry, at: Levels, frame: tuple[float, float] | None) -> tuple[Connection, ...]:
    """Return spring and damper behind the object, the rod of the feed, and spring and damper of a frame."""
    y, reach, face = geometry.strike_position[1], geometry.reach, geometry.reach - geometry.engagement
    behind, rod = (reach + at.end, face + at.wall), (face + at.wall + 6.0 * at.unit, face + at.cylinder)
    connections = [
        Connection((ASSEMBLY, CARRIAGE), behind, (_spring(y + 0.45 * at.high, 3.5 * at.unit),)),
        Connection((ASSEMBLY, CARRIAGE), behind, _damper(y - 0.45 * at.high, 4.0 * at.unit)),
        Connection((CARRIAGE, GROUND), rod, (np.array([(0.0, y), (1.0, y)]),)),
    ]
    if frame is not None:
        ends = (reach + frame[0], reach + frame[1])
        half = at.high if geometry.face_width is None else min(at.high, geometry.half_face)
        size = min(3.5 * at.unit, 0.4 * half)
        connections.append(Connection((NOSE, ASSEMBLY), ends, (_spring(y + 0.45 * half, size),)))
        connections.append(Connection((NOSE, ASSEMBLY), ends, _damper(y - 0.45 * half, 1.1 * size)))
    return tuple(connections)


def _places(geometry: StrikeGeometry, at: Levels, names: dict[str, float]) -> LabelPlaces:
    """Return the places of words and numbers."""
    y, face, unit = geometry.strike_position[1], geometry.reach - geometry.engagement, at.unit
    behind = face + 0.5 * (at.end + at.wall)
    middles = {name: (face + x, y) for name, x in names.items()}
    if "frame" in middles:
        middles["frame"] = (middles["frame"][0], y + at.high + 8.0 * unit)
    middles |= {
        "spring": (behind, y + 0.45 * at.high + 13.0 * unit),
        "damper": (behind, y - 0.45 * at.high - 13.0 * unit),
        "stop": (face + 0.5 * (at.lug + 5.0 * unit + at.flange), y - at.high - 8.0 * unit),
        "carriage": (face + at.wall + 3.0 * unit, y + 0.5 * at.floor),
        "feed": (face + at.cylinder + 13.0 * unit, y),
    }
    far = face + at.cylinder + 28.0 * unit
    return LabelPlaces(at.high, face, middles, face + at.wall + 6.0 * unit, y + at.floor - 9.0 * unit, far)


def _spring(y: float, half: float) -> Array:
    """Return the zigzag of a spring along its way."""
    share = np.linspace(0.12, 0.88, 13)
    swing = np.concatenate([[0.0], half * (-1.0) ** np.arange(11), [0.0]])
    return np.vstack([[(0.0, y)], np.column_stack([share, y + swing]), [(1.0, y)]])


def _damper(y: float, half: float) -> tuple[Array, ...]:
    """Return rod and piston, then the pot of a damper along its way."""
    rod = np.array([(0.0, y), (0.48, y), (0.48, y + 0.7 * half), (0.48, y - 0.7 * half)])
    pot = np.array(
        [(0.3, y + half), (0.66, y + half), (0.66, y), (1.0, y), (0.66, y), (0.66, y - half), (0.3, y - half)]
    )
    return rod, pot


def placed(shape: Outline, pose: Pose, blow_angle: float) -> Array:
    """Return the corners of an outline in a pose, shape (N, 2), m."""
    if shape.group != DISC:
        return shape.points + np.array([pose.shift(shape.group), 0.0])
    turned = pose.angle - blow_angle
    cosine, sine = math.cos(turned), math.sin(turned)
    return np.asarray(shape.points @ np.array([[cosine, sine], [-sine, cosine]]))


def stretched(connection: Connection, pose: Pose) -> list[Array]:
    """Return the lines of a spring, damper or rod in a pose, m."""
    begin, end = [at + pose.shift(group) for at, group in zip(connection.ends, connection.groups, strict=True)]
    return [np.column_stack([begin + line[:, 0] * (end - begin), line[:, 1]]) for line in connection.lines]


def at_rest(geometry: StrikeGeometry, angle: float = 0.0) -> Pose:
    """Return the pose with the object fed and at rest, the turntable at an angle."""
    return Pose(angle, -geometry.engagement, -geometry.engagement, 0.0)
