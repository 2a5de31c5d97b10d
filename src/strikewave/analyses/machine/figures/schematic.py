"""A schematic of a launched machine: symbols, not to scale; its parts with their numbers stand in a table beside it.

A kind draws its own with a few symbols in a field 10 wide; balloons number the parts, as in the drawing of the rotary
machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from strikewave.analyses.machine.figures.drawing import SIZE, balloon
from strikewave.analyses.machine.figures.geometry import LOOKS
from strikewave.analyses.machine.figures.parts import (
    damping_entry,
    mass_entry,
    number_entry,
    provenance_words,
    stiffness_entry,
)
from strikewave.analyses.machine.kind import Drawing, PartEntry
from strikewave.cases.case import Case
from strikewave.reporting.parts import Picture
from strikewave.reporting.style import BLUE, GREY, RED

FIELD = 10.0
"""Width of the field in which symbols stand."""
HEIGHT = 4.0
"""Of a schematic, inches: its field is 8.2 high."""
INK = "#1a1f24"
Point = tuple[float, float]


class Schematic:
    """A field of symbols beside a list of parts.

    Parameters
    ----------
    parts : sequence of PartEntry
        The parts with their numbers; balloons bear their places in this list, from 1.
    """

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
        """Draw what nothing moves: a line with hatches on its right-hand side, seen from its left end."""
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
        arrow = {"arrowstyle": "<|-|>", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 0.9, "mutation_scale": 8}
        self.axes.annotate("", end, begin, arrowprops={**arrow, "color": INK}, zorder=3)
        x, y = 0.5 * (begin[0] + end[0]), 0.5 * (begin[1] + end[1])
        upright = abs(end[1] - begin[1]) > abs(end[0] - begin[0])
        place = (x + 0.15, y) if upright else (x, y + 0.25)
        side = "left" if upright else "center"
        self.axes.text(*place, words, fontsize=8, ha=side, va="center", color=INK, zorder=4)

    def number(self, part: str, place: Point) -> None:
        """Draw the balloon of a part."""
        names = [entry.place for entry in self.parts]
        if part:
            balloon(self.axes, names.index(part) + 1, place)

    def drawing(self, what: str) -> Drawing:
        """Return the schematic with its parts, of what it shows in words."""
        words = provenance_words(self.parts)
        caption = f"{what}: schematic, not to scale; the table gives its numbers. {words}"
        return Drawing([Picture(self.figure, caption, f"{what}. {words}")], self.parts)


def striker_part(case: Case, name: str) -> PartEntry:
    """Return [striker] as a part, called as its machine calls it."""
    striker = case.impact().striker
    entries = [*mass_entry("mass", striker.mass), *number_entry("nose radius", striker.nose_radius, "mm")]
    entries += [
        *stiffness_entry("mount", striker.mount_stiffness),
        *damping_entry("mount, damping", striker.mount_damping),
    ]
    return PartEntry("striker", name, entries)


def object_part(case: Case, name: str) -> PartEntry:
    """Return [object] as a part, called as its machine calls it."""
    struck = case.impact().object
    entries = [*mass_entry("mass", struck.mass), *mass_entry("of it the nose", struck.nose_mass)]
    entries += [
        *stiffness_entry("frame", struck.frame_stiffness),
        *damping_entry("frame, damping", struck.frame_damping),
    ]
    entries += [*stiffness_entry("spring", struck.spring), *damping_entry("damper", struck.damper)]
    entries += stiffness_entry("stop", struck.stop_stiffness)
    return PartEntry("object", name, entries)


def contact_part(case: Case, name: str) -> PartEntry:
    """Return [contact] as a part, called as its machine calls it."""
    contact = case.impact().contact
    entries = [*number_entry("restitution", contact.restitution)]
    entries += number_entry("force at depth", contact.reference_force, "kN")
    entries += [*number_entry("depth", contact.reference_depth, "mm"), *number_entry("exponent", contact.exponent)]
    law, pad = contact.law, contact.cushion
    if pad is not None:
        law = f"{contact.law} ({pad.material or pad.law})"
        entries += [*number_entry("thickness", pad.thickness, "mm"), *number_entry("diameter", pad.diameter, "mm")]
        entries += [*number_entry("area", pad.area, "cm^2"), *number_entry("plateau", pad.plateau, "MPa")]
        entries += [*number_entry("modulus", pad.modulus, "MPa"), *number_entry("stress", pad.stress, "MPa")]
    return PartEntry("contact", f"{name}, {law}", entries)


def bearing(sketch: Schematic, case: Case, foot: Point, top: Point) -> None:
    """Draw what holds an object at rest: a spring to the ground, or nothing."""
    struck = case.impact().object
    along = np.sign(np.subtract(top, foot))
    if struck.spring is not None or struck.stop_stiffness is not None:
        sketch.spring(top, foot)
        wide = (-0.8 * along[1], 0.8 * along[0])
        sketch.ground((foot[0] + wide[0], foot[1] + wide[1]), (foot[0] - wide[0], foot[1] - wide[1]))
