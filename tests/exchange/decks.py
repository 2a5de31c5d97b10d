"""A model of everything that a deck can hold, and readers that turn decks back into SI."""

import re
from types import SimpleNamespace

import numpy as np

from strikewave.fem.mesh import joined
from strikewave.fem.model import (
    Controls,
    CutSection,
    Driven,
    Fixed,
    Model,
    NonReflecting,
    Point,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    Tie,
    TimeCurve,
)
from strikewave.fem.shapes import block, moved, turned
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook

LENGTH = {"SI": 1.0, "mm-t-s": 1e-3, "mm-g-us": 1e-3, "mm-ms-kg": 1e-3}
MASS = {"SI": 1.0, "mm-t-s": 1e3, "mm-g-us": 1e-3, "mm-ms-kg": 1.0}
TIME = {"SI": 1.0, "mm-t-s": 1.0, "mm-g-us": 1e-6, "mm-ms-kg": 1e-3}
"""What 1 of a system is in SI, typed anew."""
COPPER = JohnsonCook(
    8960.0, 124e9, 0.34, A=90e6, B=292e6, n=0.31, C=0.025, m=1.09, melting_temperature=1356.0, specific_heat=383.0
)
"""Johnson & Cook 1983, OFHC copper."""
TILT = 0.3
"""rad, of the block that nothing is along an axis of."""


def unit_of(system, length=0, mass=0, time=0):
    return LENGTH[system] ** length * MASS[system] ** mass * TIME[system] ** time


def everything():
    """Five blocks: steel on aluminium on copper, a tilted one, a rigid one above."""

    def made(name, place, size=(4e-3, 4e-3, 2e-3)):
        return moved(block(name, size, 2e-3, 2e-3, 1e-3), place)

    tilted = turned(block("tilted", (4e-3, 4e-3, 2e-3), 2e-3, 2e-3, 1e-3), (1.0, 0.0, 0.0), TILT)
    mesh = joined(
        [
            made("copper", (0.0, 0.0, 0.0)),
            made("plate", (0.0, 0.0, 2e-3)),
            made("striker", (0.0, 0.0, 4.1e-3)),
            moved(tilted, (2e-2, 0.0, 0.0)),
            made("anvil", (4e-2, 0.0, 0.0)),
        ]
    )
    return Model(
        mesh,
        {
            "copper": COPPER,
            "plate": Bilinear(2770.0, 70e9, 0.33, 320e6, 1.1e9, 0.25),
            "striker": Elastic(7823.456789, 211e9, 0.288),
            "tilted": Elastic(7820.0, 211e9, 0.3),
            "anvil": Elastic(7820.0, 211e9, 0.3),
        },
        Controls(20e-6, 0.5e-6, 0.8, 0.07, 0.05, 1.4, full=("plate",), least_step=1e-8),
        velocity={"striker": (0.0, 0.0, -3.0), "anvil": (1.0, 5.0, 2.0)},
        gravity=(0.0, 0.0, -9.81),
        boundaries=(
            Symmetry("copper.x-"),
            Symmetry("copper.y-"),
            Symmetry("tilted.z-"),
            Fixed("tilted.x-"),
            Driven("tilted.x+", (0.0, np.cos(TILT), np.sin(TILT)), TimeCurve((5e-6, 10e-6), (0.0, 2.0))),
            Driven("plate.x+", (-1.0, 0.0, 0.0), TimeCurve((0.0, 10e-6), (0.0, 2.0))),
            Driven("copper.x+", (-1.0, 0.0, 0.0), TimeCurve((0.0, 10e-6), (0.0, 2.0))),
            Pressure("striker.z+", TimeCurve((0.0, 5e-6), (1e6, 4e6))),
            NonReflecting("copper.z-"),
        ),
        contacts=(SurfaceContact("striker.z-", "plate.z+", 0.15), SurfaceContact("striker.all", "anvil.all")),
        ties=(Tie("plate.z-", "copper.z+"),),
        walls=(RigidWall("tilted.y+", (0.0, 3e-3, 0.0), (0.0, -1.0, 0.0), 0.2),),
        rigid=(Rigid("anvil", (True, False, True), (False, True, False)),),
        sections=(CutSection("gauge", "striker", (0.0, 0.0, 4.6e-3), (0.0, 0.0, 1.0)),),
        points=(Point("tip", "striker", (0.0, 0.0, 4.1e-3)),),
        groups={"stack": ("copper", "plate")},
    )


def outward(points, faces, hexahedra):
    """For each face, whether its normal leads away from the element that it belongs to."""
    found = []
    for face in faces:
        owner = hexahedra[np.isin(hexahedra, face).sum(axis=1) == 4]
        assert len(owner) == 1
        a, b, c, d = points[face]
        found.append(np.cross(c - a, d - b) @ (points[face].mean(axis=0) - points[owner[0]].mean(axis=0)) > 0.0)
    return np.array(found)


class LsDyna:
    """A keyword deck, read by ansys-dyna-core."""

    def __init__(self, text, system):
        from ansys.dyna.core import Deck

        self.deck, self.system = Deck(), system
        self.deck.loads(text)
        self.keywords = list(self.deck.all_keywords)
        nodes, elements = self.one("Node").nodes, self.one("ElementSolid").elements
        self.points = nodes[["x", "y", "z"]].to_numpy(float) * unit_of(system, 1)
        self.hexahedra = elements[[f"n{k}" for k in range(1, 9)]].to_numpy(np.int64) - 1
        self.part = elements["pid"].to_numpy(np.int64) - 1
        self.names = [self.row(part)["heading"].strip() for part in self.all("Part")]

    def all(self, kind):
        return [k for k in self.keywords if type(k).__name__ == kind]

    def one(self, kind):
        (found,) = self.all(kind)
        return found

    def row(self, part):
        return part.parts.iloc[0]

    def nodes_of(self, number):
        (found,) = [s for s in self.all("SetNodeList") if s.sid == number]
        return np.array(found.nodes.data) - 1

    def faces_of(self, number):
        (found,) = [s for s in self.all("SetSegment") if s.sid == number]
        return found.segments[["n1", "n2", "n3", "n4"]].to_numpy(np.int64) - 1

    def curve(self, number):
        (found,) = [c for c in self.all("DefineCurve") if c.lcid == number]
        return found.curves[["a1", "o1"]].to_numpy(float).T


class Radioss:
    """A starter, by blocks: keyword words, title and lines."""

    TITLED = ("NODE", "BRICK", "BEGIN", "END")

    def __init__(self, text, system):
        self.system, self.blocks = system, []
        for line in text.splitlines():
            if line.startswith("#"):
                continue
            if line.startswith("/"):
                self.blocks.append(SimpleNamespace(words=line[1:].split("/"), lines=[]))
            else:
                self.blocks[-1].lines.append(line)
        for found in self.blocks:
            if found.words[0] not in self.TITLED and found.lines:
                found.title, *found.lines = found.lines
        rows = [line for found in self.all("NODE") for line in found.lines]
        table = {int(line[:10]): [float(line[k : k + 20]) for k in (10, 30, 50)] for line in rows}
        self.points = np.array([table[k] for k in sorted(table)]) * unit_of(system, 1)
        elements = [(int(b.words[1]) - 1, tens(line)) for b in self.all("BRICK") for line in b.lines]
        self.part = np.array([part for part, _ in elements])
        self.hexahedra = np.array([row[1:] for _, row in elements]) - 1
        self.names = [found.title for found in self.all("PART")]

    def all(self, *words):
        return [b for b in self.blocks if b.words[: len(words)] == list(words)]

    def one(self, *words):
        (found,) = self.all(*map(str, words))
        return found

    def nodes_of(self, number):
        return np.array([n for line in self.one("GRNOD", "NODE", number).lines for n in tens(line)]) - 1

    def faces_of(self, number):
        return np.array([tens(line)[1:] for line in self.one("SURF", "SEG", number).lines]) - 1

    def curve(self, number):
        return np.array([reals(line) for line in self.one("FUNCT", number).lines]).T


def tens(line):
    return [int(line[k : k + 10]) for k in range(0, len(line), 10) if line[k : k + 10].strip()]


def reals(line):
    return [float(line[k : k + 20]) for k in range(0, len(line), 20) if line[k : k + 20].strip()]


def fields(line, *widths):
    """Cut a line into columns; blanks are None."""
    ends = np.cumsum(widths)
    cut = [line[end - width : end].strip() for end, width in zip(ends, widths, strict=True)]
    return [(float(x) if re.search(r"[.e]", x) else int(x)) if x and not x.isalpha() else (x or None) for x in cut]
