"""The drawings of machines: a rotary machine, whole and its strike close up, and the schematic of a launched one.

Those of a rotary machine are to scale. A schematic is of symbols, not to scale: a kind of machine draws its own in a
field 10 wide. Each drawing is as wide as a phone shows without scrolling; balloons number the parts, whose numbers
stand in a table beside it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.machine.figures.geometry import (
    LARGEST_NOSE,
    LONGEST_STROKE,
    LOOKS,
    Outlines,
    Pose,
    StrikeGeometry,
    at_rest,
    outlines,
    placed,
    stretched,
)
from strikewave.analyses.machine.kind import DROP_HEIGHT, Drawing, PartEntry, PartNumber
from strikewave.base.quantities import PROVENANCES, Value
from strikewave.base.units import USUAL, in_unit
from strikewave.cases.case import Case
from strikewave.reporting.numbers import spelled
from strikewave.reporting.parts import Picture, written
from strikewave.reporting.style import BLUE, GREY, RED, shortened

Array = NDArray[np.float64]

SIZE = (4.9, 3.3)
"""Size of each drawing, inches."""
WHOLE, CLOSE = (0.05, 0.05, 4.8, 3.2), (0.05, 0.05, 4.8, 3.05)
"""Left, bottom, width and height of the views, inches."""
INK = "#1a1f24"
_ARROW: dict[str, Any] = {"arrowstyle": "<|-|>", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 0.9, "mutation_scale": 8}


def machine_drawings(case: Case) -> tuple[Figure, ...]:
    """Draw a rotary machine from its case: the whole, and the strike magnified; nothing for any other case.

    Path, noses, engagement, face and stroke are to scale, and so are the layers of a stack where that can be read.

    Examples
    --------
    >>> from strikewave import load_case
    >>> len(machine_drawings(load_case("li-ma-2019")))
    2
    >>> machine_drawings(load_case("li-ma-2019-fig13-bar"))
    ()
    """
    outline = outlines(case)
    if outline is None:
        return ()
    figures = Figure(figsize=SIZE), Figure(figsize=SIZE)
    whole, scale = view(figures[0], WHOLE, whole_limits(outline))
    _draw_whole(whole, case, outline, machine_parts(case, outline.geometry))
    close, enlarged = view(figures[1], CLOSE, close_limits(outline.geometry))
    _draw_close(close, case, outline, enlarged / scale)
    return figures


def view(
    figure: Figure, place: tuple[float, float, float, float], limits: tuple[float, float, float, float]
) -> tuple[Any, float]:
    """Return axes without frame that show limits (left, right, bottom, top in m) undistorted, and inches a metre."""
    width, height = figure.get_size_inches()
    axes = figure.add_axes((place[0] / width, place[1] / height, place[2] / width, place[3] / height))
    left, right, bottom, top = limits
    scale = min(place[2] / (right - left), place[3] / (top - bottom))
    x, y = 0.5 * (left + right), 0.5 * (bottom + top)
    axes.set_xlim(x - 0.5 * place[2] / scale, x + 0.5 * place[2] / scale)
    axes.set_ylim(y - 0.5 * place[3] / scale, y + 0.5 * place[3] / scale)
    axes.set_axis_off()
    return axes, scale


def whole_limits(made: Outlines) -> tuple[float, float, float, float]:
    """Return the limits of the whole machine: left, right, bottom, top, m."""
    radius, places = made.geometry.radius, made.places
    out = radius + made.geometry.nose_radius + 0.12 * radius
    y, half = made.geometry.strike_position[1], 0.5 * (made.geometry.face_width or 0.0)
    low = min(-out, places.floor - 0.22 * radius, y - half)
    return -out, max(places.far_end, out), low, max(out, y + half)


def close_limits(geometry: StrikeGeometry) -> tuple[float, float, float, float]:
    """Return the limits of the strike, from first touch to the strike position: left, right, bottom, top, m."""
    x, y = geometry.strike_position
    angle = geometry.touch_angle()
    touch = geometry.noses(0.0 if math.isnan(angle) else angle)[0]
    nose = geometry.nose_radius
    size = 0.5 * max(abs(touch[1] - y), abs(touch[0] - x), 2.0 * nose) + 1.6 * nose
    middle = (0.5 * (touch[0] + x) + 0.55 * nose, 0.5 * (touch[1] + y))
    return middle[0] - size, middle[0] + size, middle[1] - size, middle[1] + size


def draw_machine(axes: Any, made: Outlines, pose: Pose, thickness: float = 1.0) -> list[Any]:
    """Draw a machine in a pose, and return its artists."""
    drawn: list[Any] = []
    for connection in made.connections:
        for line in stretched(connection, pose):
            drawn += axes.plot(line[:, 0], line[:, 1], color="#4a4a4a", linewidth=1.1 * thickness, zorder=2.5)
    for shape in made.shapes:
        fill, edge, width = LOOKS[shape.look]
        points = placed(shape, pose, made.geometry.blow_angle)
        order = {"disc": 1.0, "striker": 1.2, "nose": 1.4, "hub": 1.6, "face": 3.4}.get(shape.look, 3.0)
        drawn += axes.fill(
            points[:, 0], points[:, 1], facecolor=fill, edgecolor=edge, linewidth=width * thickness, zorder=order
        )
    return drawn


def _draw_whole(axes: Any, case: Case, made: Outlines, parts: Sequence[PartEntry]) -> None:
    """Draw the machine with its object fed and at rest, and a striker at first touch."""
    geometry, places = made.geometry, made.places
    angle = geometry.touch_angle()
    first = 0.0 if math.isnan(angle) else angle
    draw_machine(axes, made, at_rest(geometry, first))
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    axes.plot(
        geometry.radius * np.cos(turn), geometry.radius * np.sin(turn), color=GREY, linewidth=0.7, dashes=(8, 3, 2, 3)
    )
    shown = _draw_radius(axes, case, geometry, first)
    _draw_turning(axes, geometry, shown + 2.2)
    _draw_directions(axes, case, made)
    _draw_stroke(axes, case, made)
    at = {
        **places.middles,
        "turntable": _polar(0.42 * geometry.radius, shown + 4.0),
        "striker": tuple(0.86 * _clear_nose(geometry, first, -2.2)),
        "strike": _polar(1.1 * geometry.radius, -geometry.blow_angle - 0.42),
    }
    for number, part in enumerate(parts, 1):
        if part.place in at:
            balloon(axes, number, at[part.place])


def _clear_nose(geometry: StrikeGeometry, angle: float, towards: float) -> Array:
    """Return the centre of the nose whose angle on the path is nearest to one, rad, but not that which strikes."""
    noses = geometry.noses(angle)
    turned = np.arctan2(noses[:, 1], noses[:, 0])
    away = np.abs((turned - towards + math.pi) % (2.0 * math.pi) - math.pi)
    away[0] = 10.0 if geometry.strikers > 1 else 0.0
    return np.asarray(noses[int(np.argmin(away))])


def balloon(axes: Any, number: int, place: tuple[float, float]) -> None:
    """Draw the number of a part in a circle."""
    look = {"boxstyle": "circle,pad=0.2", "facecolor": "white", "edgecolor": INK, "linewidth": 0.8}
    axes.text(*place, str(number), ha="center", va="center", fontsize=8, color=INK, bbox=look, zorder=6)


def _polar(radius: float, angle: float) -> tuple[float, float]:
    return radius * math.cos(angle), radius * math.sin(angle)


def _draw_turning(axes: Any, geometry: StrikeGeometry, middle: float) -> None:
    """Draw the sense of rotation as an arrow about the axis, its middle at an angle, rad."""
    turn = np.linspace(middle - 0.7, middle + 0.7, 40)
    arc = 0.5 * geometry.radius * np.column_stack([np.cos(turn), np.sin(turn)])
    axes.plot(arc[:-2, 0], arc[:-2, 1], color=BLUE, linewidth=1.8, zorder=2)
    arrow = {"arrowstyle": "-|>", "color": BLUE, "linewidth": 1.8, "mutation_scale": 14, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", arc[-1], arc[-5], arrowprops=arrow, zorder=2)
    axes.text(*_polar(0.33 * geometry.radius, middle), "turns", color=BLUE, fontsize=8, ha="center", va="center")


def _draw_radius(axes: Any, case: Case, geometry: StrikeGeometry, angle: float) -> float:
    """Dimension the path from the axis to a nose that stands clear of the strike; return its angle, rad."""
    end = _clear_nose(geometry, angle, 1.2)
    axes.annotate("", end, (0.0, 0.0), arrowprops={**_ARROW, "arrowstyle": "-|>", "color": INK}, zorder=4)
    _dimensioned(axes, tuple(0.45 * end), f"R {written_value(case.rotary_tables().machine.radius, 'mm')}")
    return math.atan2(end[1], end[0])


def _draw_directions(axes: Any, case: Case, made: Outlines) -> None:
    """Draw the blow, gravity along it, and the angle between radius and blow where there is one."""
    geometry, places = made.geometry, made.places
    top = (
        geometry.strike_position[1]
        + max(places.half_height, 0.5 * (geometry.face_width or 0.0))
        + 0.16 * geometry.radius
    )
    wide = 0.3 * geometry.radius
    arrow = {"arrowstyle": "-|>", "color": RED, "linewidth": 2.2, "mutation_scale": 16, "shrinkA": 0, "shrinkB": 0}
    begin = places.wall - 0.3 * geometry.radius
    axes.annotate("", (begin + wide, top), (begin, top), arrowprops=arrow, zorder=5)
    axes.text(begin + wide + 0.04 * geometry.radius, top, "blow", color=RED, fontsize=9, va="center", zorder=5)
    gravity = case.rotary_tables().object.gravity.si
    if gravity:
        ends = (begin, begin + wide) if gravity > 0.0 else (begin + wide, begin)
        above = top + 0.13 * geometry.radius
        thin = {**arrow, "color": GREY, "linewidth": 1.2, "mutation_scale": 11}
        axes.annotate("", (ends[1], above), (ends[0], above), arrowprops=thin, zorder=5)
        axes.text(begin + wide + 0.04 * geometry.radius, above, "gravity", color=GREY, fontsize=8, va="center")
    if geometry.blow_angle:
        _draw_blow_angle(axes, geometry)


def _draw_blow_angle(axes: Any, geometry: StrikeGeometry) -> None:
    """Draw the outward radius at the strike position, and its angle to the blow."""
    x, y = geometry.strike_position
    radius, arc = geometry.radius, 0.2 * geometry.radius
    axes.plot([0.0, 1.12 * x], [0.0, 1.12 * y], color=GREY, linewidth=0.8, dashes=(5, 3), zorder=2)
    axes.plot([x, x + 1.5 * arc], [y, y], color=GREY, linewidth=0.8, dashes=(5, 3), zorder=3.5)
    turn = np.linspace(-geometry.blow_angle, 0.0, 30)
    axes.plot(x + arc * np.cos(turn), y + arc * np.sin(turn), color=INK, linewidth=0.9, zorder=4)
    middle = -0.5 * geometry.blow_angle
    words = f"{significant(math.degrees(geometry.blow_angle), 4)}°"
    place = (x + 0.3 * radius * math.cos(middle), y + 0.3 * radius * math.sin(middle))
    axes.text(*place, words, fontsize=8, ha="center", va="center", zorder=6, bbox=_PLAIN)


def _draw_stroke(axes: Any, case: Case, made: Outlines) -> None:
    """Dimension the way of the carriage, and show where the face is when it is retracted."""
    geometry, places = made.geometry, made.places
    if case.feed is None:
        return
    stroke = case.feed.stroke
    y, shown = places.floor - 0.06 * geometry.radius, min(stroke.si, LONGEST_STROKE * geometry.radius)
    right = places.wall
    for x in (right, right + shown):
        axes.plot([x, x], [places.floor - 0.1 * geometry.radius, places.floor + 0.1 * geometry.radius], **_EXTENSION)
    axes.annotate("", (right + shown, y), (right, y), arrowprops={**_ARROW, "color": INK}, zorder=5)
    label = f"stroke s {written_value(stroke, 'mm')}" + (" (not to scale)" if stroke.si > shown else "")
    _dimensioned(axes, (right - 0.02 * geometry.radius, y), label, "right")


_EXTENSION: dict[str, Any] = {"color": GREY, "linewidth": 0.7, "zorder": 4}
_PLAIN: dict[str, Any] = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.8}


def _dimensioned(axes: Any, place: tuple[float, ...], label: str, side: str = "center") -> None:
    """Write a dimension."""
    axes.text(*place, label, fontsize=8, ha=side, va="center", color=INK, bbox=_PLAIN, zorder=6)


def _draw_close(axes: Any, case: Case, made: Outlines, magnified: float) -> None:
    """Draw the strike itself: a nose at first touch and at the strike position, the face between, the engagement."""
    from matplotlib.patches import Rectangle

    geometry, machine = made.geometry, case.rotary_tables().machine
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    size = min(right - left, top - bottom)
    face, angle = geometry.reach - geometry.engagement, geometry.touch_angle()
    turn = np.linspace(0.0, 2.0 * math.pi, 2001)
    path = geometry.radius * np.column_stack([np.cos(turn), np.sin(turn)])
    axes.plot(path[:, 0], path[:, 1], color=GREY, linewidth=0.8, dashes=(8, 3, 2, 3))
    x, y = geometry.strike_position
    half = 0.5 * geometry.face_width if geometry.face_width is not None else 10.0 * size
    low, high = max(y - half, bottom), min(y + half, top)
    axes.fill([face, right, right, face], [low, low, high, high], facecolor=LOOKS["body"][0], linewidth=0.0, zorder=0)
    axes.plot([face, face], [low, high], color=RED, linewidth=2.2, zorder=3)
    outline = np.linspace(0.0, 2.0 * math.pi, 181)
    ring = geometry.nose_radius * np.column_stack([np.cos(outline), np.sin(outline)])
    axes.plot(x + ring[:, 0], y + ring[:, 1], color=LOOKS["nose"][1], linewidth=1.0, dashes=(4, 2), zorder=2)
    axes.plot([x], [y], "+", color=INK, markersize=6, zorder=4)
    if not math.isnan(angle):
        _draw_touch(axes, geometry, angle, size)
    level = top - 0.1 * size
    axes.plot([geometry.reach] * 2, [y, level], **_EXTENSION)
    _draw_engagement(axes, machine.engagement, (face, geometry.reach), level, size)
    axes.set_title(f"The strike, magnified × {significant(magnified, 2)}", fontsize=9, loc="left", pad=-8, zorder=9)
    frame = Rectangle((left, bottom), right - left, top - bottom, fill=False, edgecolor=GREY, linewidth=0.8, zorder=8)
    axes.add_patch(frame)


def _draw_touch(axes: Any, geometry: StrikeGeometry, angle: float, size: float) -> None:
    """Draw the nose at first touch, where it touches, and which way it goes."""
    centre = geometry.noses(angle)[0]
    turn = np.linspace(0.0, 2.0 * math.pi, 181)
    ring = centre + geometry.nose_radius * np.column_stack([np.cos(turn), np.sin(turn)])
    axes.fill(
        ring[:, 0], ring[:, 1], facecolor=LOOKS["striker"][0], edgecolor=LOOKS["nose"][1], linewidth=1.1, zorder=2
    )
    axes.plot([centre[0]], [centre[1]], "+", color=INK, markersize=6, zorder=4)
    axes.plot([centre[0] + geometry.nose_radius], [centre[1]], "o", color=INK, markersize=3.5, zorder=5)
    along = np.array([-centre[1], centre[0]]) / geometry.radius
    arrow = {"arrowstyle": "-|>", "color": BLUE, "linewidth": 1.6, "mutation_scale": 12, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", centre + 0.22 * size * along, centre, arrowprops=arrow, zorder=5)
    below = 0.22 * size * math.sin(abs(geometry.blow_angle))  # clear of the path
    place = (centre[0] + geometry.nose_radius + 0.03 * size, centre[1] - below)
    words = f"first touch,\n{significant(-math.degrees(angle), 3)}° before the\nstrike position"
    axes.text(*place, words, fontsize=8, ha="left", va="center", zorder=6)


def _draw_engagement(axes: Any, value: Any, ends: tuple[float, float], y: float, size: float) -> None:
    """Dimension the engagement; the arrows stand outside where it is too small for them."""
    label = f"q {written_value(value, 'mm')}"
    if ends[1] - ends[0] > 0.3 * size:
        axes.annotate("", (ends[1], y), (ends[0], y), arrowprops={**_ARROW, "color": INK}, zorder=6)
        _dimensioned(axes, (0.5 * (ends[0] + ends[1]), y - 0.06 * size), label)
        return
    for end, side in zip(ends, (-1.0, 1.0), strict=True):
        begin = (end + side * 0.1 * size, y)
        axes.annotate("", (end, y), begin, arrowprops={**_ARROW, "arrowstyle": "-|>", "color": INK}, zorder=6)
    _dimensioned(axes, (ends[0] - 0.12 * size, y), label, "right")


def scale_words(case: Case, made: Outlines) -> list[str]:
    """Return the sentences on what is drawn to scale and what is not."""
    geometry, stack = made.geometry, bool(case.stack.layer)
    striker = case.rotary_tables().striker
    layers = ["layers"] if stack and made.to_scale else []
    noses = ["noses"] if striker.nose_radius.si <= LARGEST_NOSE * geometry.radius else []
    width = ["face width"] if geometry.face_width is not None else []
    stroke = ["stroke"] if case.feed is None or case.feed.stroke.si <= LONGEST_STROKE * geometry.radius else []
    scaled = ["path", *noses, "engagement", *stroke, *width, *layers]
    symbols = ["disc", "mounts", "spring", "damper", "stop", "carriage"]
    symbols += ([] if noses else ["noses"]) + ([] if stroke else ["stroke"])
    symbols += [] if layers else ["layers' lengths and diameters" if stack else "lengths of the object"]
    sentences = [f"To scale: {', '.join(scaled)}.", f"Not to scale: {', '.join(symbols)}."]
    if geometry.face_width is None:
        across = significant(geometry.touch_distance * 1e3, 3)
        sentences.append(
            f"The case sets no width of the face: it is taken to reach {across} mm to the side, where a nose first "
            "touches it."
        )
    return sentences


FIELD, HEIGHT = 10.0, 4.0
"""Width of the field in which symbols stand; height of a schematic, inches: its field is 8.2 high."""
Point = tuple[float, float]


class Schematic:
    """A field of symbols beside a list of parts, by whose places, from 1, balloons are numbered."""

    def __init__(self, parts: Sequence[PartEntry]) -> None:
        self.parts = parts
        width, height = SIZE[0], HEIGHT
        self.figure = Figure(figsize=(width, height))
        self.axes = self.figure.add_axes((0.01, 0.01, 0.98, 0.98))
        self.axes.set_xlim(0.0, FIELD)
        self.axes.set_ylim(0.0, FIELD * height / width)
        self.axes.set_axis_off()

    def block(self, low: Point, high: Point, look: str, part: str = "") -> None:
        """Draw a rectangle from its lower left to its upper right corner, with the balloon of a part."""
        fill, edge, width = LOOKS[look]
        x, y = [low[0], high[0], high[0], low[0]], [low[1], low[1], high[1], high[1]]
        self.axes.fill(x, y, facecolor=fill, edgecolor=edge, linewidth=width, zorder=2)
        self.number(part, (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])))

    def ball(self, centre: Point, radius: float, look: str, part: str = "") -> None:
        """Draw a circle, with the balloon of a part."""
        fill, edge, width = LOOKS[look]
        turn = np.linspace(0.0, 2.0 * math.pi, 90)
        x, y = centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)
        self.axes.fill(x, y, facecolor=fill, edgecolor=edge, linewidth=width, zorder=2)
        self.number(part, centre)

    def line(self, *points: Point, dashed: bool = False) -> None:
        """Draw a line through points."""
        x, y = zip(*points, strict=True)
        self.axes.plot(x, y, color=GREY if dashed else INK, linewidth=1.1, dashes=(6, 3) if dashed else (), zorder=1.5)

    def ground(self, left: Point, right: Point) -> None:
        """Draw the ground: a line with hatches on its right-hand side, seen from its left end."""
        self.line(left, right)
        along = np.subtract(right, left)
        length = float(np.hypot(*along))
        unit = along / length
        back = np.array([unit[1], -unit[0]]) - unit
        for s in np.arange(0.25, length + 1e-9, 0.3):
            foot = np.array(left) + s * unit
            self.line((foot[0], foot[1]), (foot[0] + 0.18 * back[0], foot[1] + 0.18 * back[1]))

    def spring(self, begin: Point, end: Point, part: str = "") -> None:
        """Draw a spring between two points, with the balloon of a part beside its middle."""
        way = np.subtract(end, begin)
        across = np.array([-way[1], way[0]]) / np.hypot(*way)
        shares, sides = [0.0, 0.15, *np.linspace(0.2, 0.8, 7), 0.85, 1.0], [0, 0, 1, -1, 1, -1, 1, -1, 1, 0, 0]
        points = [np.array(begin) + s * way + 0.16 * side * across for s, side in zip(shares, sides, strict=True)]
        self.line(*[(float(p[0]), float(p[1])) for p in points])
        middle = 0.5 * np.add(begin, end) + 0.5 * across
        self.number(part, (float(middle[0]), float(middle[1])))

    def arrow(self, begin: Point, end: Point, words: str, colour: str = BLUE) -> None:
        """Draw an arrow, with words on its right-hand side."""
        look: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "mutation_scale": 14}
        self.axes.annotate("", end, begin, arrowprops={**look, "shrinkA": 0, "shrinkB": 0}, zorder=3)
        right = end if end[0] >= begin[0] else begin
        self.axes.text(right[0] + 0.2, right[1], words, color=colour, fontsize=9, va="center", zorder=4)

    def blow(self, begin: Point, end: Point) -> None:
        """Draw the direction of the blow."""
        self.arrow(begin, end, "blow", RED)

    def dimension(self, begin: Point, end: Point, words: str) -> None:
        """Draw a dimension between two points, with words beside its middle."""
        self.axes.annotate("", end, begin, arrowprops={**_ARROW, "color": INK}, zorder=3)
        x, y = 0.5 * (begin[0] + end[0]), 0.5 * (begin[1] + end[1])
        upright = abs(end[1] - begin[1]) > abs(end[0] - begin[0])
        place = (x + 0.15, y) if upright else (x, y + 0.25)
        side = "left" if upright else "center"
        self.axes.text(*place, words, fontsize=8, ha=side, va="center", color=INK, zorder=4)

    def number(self, part: str, place: Point) -> None:
        """Draw the balloon of a part."""
        if part:
            balloon(self.axes, [entry.place for entry in self.parts].index(part) + 1, place)

    def drawing(self, what: str) -> Drawing:
        """Return the schematic of a machine, named in words, with its parts."""
        words = provenance_words(self.parts)
        caption = f"{what}: schematic, not to scale; the table gives its numbers. {words}"
        return Drawing([Picture(self.figure, caption, f"{what}. {words}")], self.parts)


def striker_part(case: Case, name: str) -> PartEntry:
    """Return [striker] as a part, called as its machine calls it."""
    striker = case.impact().striker
    numbers = part_numbers(
        ("mass", striker.mass, MASS),
        ("nose radius", striker.nose_radius, "mm"),
        ("mount", striker.mount_stiffness, STIFFNESS),
        ("mount, damping", striker.mount_damping, "N s/m"),
    )
    return PartEntry("striker", name, numbers)


def object_part(case: Case, name: str) -> PartEntry:
    """Return [object] as a part, called as its machine calls it."""
    struck = case.impact().object
    numbers = part_numbers(
        ("mass", struck.mass, MASS),
        ("of it the nose", struck.nose_mass, MASS),
        ("frame", struck.frame_stiffness, STIFFNESS),
        ("frame, damping", struck.frame_damping, "N s/m"),
        ("spring", struck.spring, STIFFNESS),
        ("damper", struck.damper, "N s/m"),
        ("stop", struck.stop_stiffness, STIFFNESS),
    )
    return PartEntry("object", name, numbers)


def contact_part(case: Case, name: str) -> PartEntry:
    """Return [contact] as a part, called as its machine calls it."""
    contact = case.impact().contact
    law, pad = contact.law, contact.cushion
    numbers = part_numbers(
        ("restitution", contact.restitution, ""),
        ("force at depth", contact.reference_force, "kN"),
        ("depth", contact.reference_depth, "mm"),
        ("exponent", contact.exponent, ""),
    )
    if pad is not None:
        law = f"{contact.law} ({pad.material or pad.law})"
        numbers += part_numbers(
            ("thickness", pad.thickness, "mm"),
            ("diameter", pad.diameter, "mm"),
            ("area", pad.area, "cm^2"),
            ("plateau", pad.plateau, "MPa"),
            ("modulus", pad.modulus, "MPa"),
            ("stress", pad.stress, "MPa"),
        )
    return PartEntry("contact", f"{name}, {law}", numbers)


def fall_part(place: str, name: str, height: Value, friction: Value | None, *more: PartRow) -> PartEntry:
    """Return a fall as a part: its height, the friction on the way as a share of the weight, and further numbers."""
    drop = (DROP_HEIGHT.label, height, DROP_HEIGHT.usual)
    return PartEntry(place, name, part_numbers(drop, ("friction of weight", friction, ""), *more))


def bearing(sketch: Schematic, case: Case, foot: Point, top: Point) -> None:
    """Draw the bearing of an object at rest: a spring to the ground, or nothing."""
    struck = case.impact().object
    along = np.sign(np.subtract(top, foot))
    if struck.spring is not None or struck.stop_stiffness is not None:
        sketch.spring(top, foot)
        wide = (-0.8 * along[1], 0.8 * along[0])
        sketch.ground((foot[0] + wide[0], foot[1] + wide[1]), (foot[0] - wide[0], foot[1] - wide[1]))


DRAWN = {"deg": "°", "gram": "g", "rpm": "r/min"}
"""Units that drawings spell otherwise than sentences do."""
MOST_LAYERS = 6  # of a stack that are listed one by one: chosen
MASS, STIFFNESS = "mass", "stiffness"
"""Units by the size of a number: g below a tenth of a kilogram, MN/m from a million N/m on."""
PartRow = tuple[str, Value | None, str]
"""A number of a part: its name, its value in the case, and its unit, `MASS` or `STIFFNESS`."""


def significant(value: float, digits: int = 4) -> str:
    """Write a number to so many significant digits, without an exponent where it stays readable.

    Examples
    --------
    >>> significant(5.501265), significant(40000.0), significant(1e-7), significant(-0.0)
    ('5.501', '40000', '1e-07', '0')
    """
    return written(value + 0.0, digits)  # no zero has a sign


def part_numbers(*rows: PartRow) -> list[PartNumber]:
    """Return the numbers of a part, without those that the case leaves out."""
    numbers = []
    for name, value, unit in rows:
        if value is not None:
            numbers.append(PartNumber(name, written_value(value, unit), value.provenance))
    return numbers


def written_value(value: Value, unit: str) -> str:
    """Write a value of a case in a unit, as a drawing shows it."""
    if unit == MASS:
        unit = "gram" if value.si < 0.1 else "kg"
    elif unit == STIFFNESS:
        unit = "kN/m" if value.si < 1e6 else "MN/m"
    number = in_unit(value.si, dict(USUAL.keys())[unit], unit) if unit else value.si
    return f"{significant(float(number))}{'' if unit in ('', 'deg') else ' '}{DRAWN.get(unit, spelled(unit))}"


def provenance_words(parts: Sequence[PartEntry]) -> str:
    """Return the sentence on how many numbers of some parts have each provenance."""
    marks = [entry.provenance for part in parts for entry in part.entries if entry.provenance != "computed"]
    counted = [f"{marks.count(word)} {word}" for word in PROVENANCES if word in marks]
    return f"Of the {len(marks)} numbers shown {', '.join(counted)}."


def machine_parts(case: Case, geometry: StrikeGeometry) -> list[PartEntry]:
    """Return the parts of a rotary machine in the order in which a blow runs through them."""
    tables, layers = case.rotary_tables(), case.stack.layer
    machine, striker, struck, feed = tables.machine, tables.striker, tables.object, tables.feed
    angle, approach = geometry.touch_angle(), geometry.approach(machine.speed.si)
    meets = "none" if math.isnan(angle) else f"{significant(-math.degrees(angle), 3)}°"
    speed = "none" if math.isnan(approach) else f"{significant(approach, 4)} m/s"
    turntable = part_numbers(
        ("speed", machine.speed, "rpm"),
        ("inertia", machine.inertia, "kg m^2"),
        ("drive, at most", machine.torque, "N m"),
    )
    strikers = part_numbers(
        ("count", machine.strikers, ""),
        ("path radius R", machine.radius, "mm"),
        ("nose radius", striker.nose_radius, "mm"),
        ("moving mass, each", striker.mass, MASS),
        ("mount", striker.mount_stiffness, STIFFNESS),
    )
    strike = part_numbers(
        ("engagement q", machine.engagement, "mm"),
        ("blow to radius", machine.blow_angle, "deg"),
        ("face width", machine.face_width, "mm"),
    )
    strike.append(PartNumber("angle from first touch", meets, "computed"))
    strike.append(PartNumber("approach, nominal", speed, "computed"))
    parts = [PartEntry("turntable", "turntable", turntable), PartEntry("striker", "strikers", strikers)]
    parts.append(PartEntry("strike", "strike", strike))
    for layer in layers[:MOST_LAYERS]:
        area = layer.area if layer.diameter is None else None
        sizes = ("length", layer.length, "mm"), ("diameter", layer.diameter, "mm"), ("area", area, "mm^2")
        parts.append(PartEntry(f"layer {layer.name}", shortened(layer.name, 16), part_numbers(*sizes)))
    if len(layers) > MOST_LAYERS:
        parts.append(PartEntry("", f"{len(layers) - MOST_LAYERS} further layers", []))
    holders: dict[tuple[str, str], tuple[PartRow, ...]] = {
        ("spring", "heavy-load spring"): (("rate", struck.spring, STIFFNESS), ("preload", struck.preload, "N")),
        ("damper", "damper"): (("damping", struck.damper, "N s/m"),),
        ("stop", "stop"): (
            ("stiffness", struck.stop_stiffness, STIFFNESS),
            ("restitution", struck.stop_restitution, ""),
        ),
        ("carriage", "carriage"): (
            ("gravity along blow", struck.gravity, "m/s^2"),
            ("friction of the rails", struck.friction, "N"),
        ),
        ("feed", "feed"): (("stroke s", feed.stroke, "mm"), ("stroke time", feed.stroke_time, "ms")),
    }
    bodies: dict[tuple[str, str], tuple[PartRow, ...]] = {
        ("nose", "nose"): (("mass of the object", struck.mass, MASS), ("of it the nose", struck.nose_mass, MASS)),
        ("frame", "frame"): (
            ("stiffness", struck.frame_stiffness, STIFFNESS),
            ("damping", struck.frame_damping, "N s/m"),
        ),
        ("assembly", "assembly with sensor"): (),
    }
    for (place, name), rows in (holders if layers else {**bodies, **holders}).items():
        parts.append(PartEntry(place, name, part_numbers(*rows)))
    return parts
