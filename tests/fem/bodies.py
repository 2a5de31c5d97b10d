"""Models of bodies with closed-form answers."""

import math
from dataclasses import dataclass

import numpy as np

from strikewave.fem.mesh import joined
from strikewave.fem.model import Controls, CutSection, Model, NonReflecting, Point, RigidWall, SurfaceContact, Symmetry
from strikewave.fem.sections import Grading
from strikewave.fem.shapes import ball, block, half_cylinder, half_space, moved, turned
from strikewave.fem.solids import Elastic

STEEL = Elastic(7820.0, 211e9, 0.288)
"""65Mn of Li & Ma 2019, Table 1."""
THIN_STEEL = Elastic(7820.0, 211e9, 0.0)
"""The same without lateral strain: a bar of any thickness is then a thin one."""
BAR_SPEED = math.sqrt(211e9 / 7820.0)


def rod_on_wall(elements=100, solid=THIN_STEEL, speed=5.0, duration=100e-6, **controls):
    """A rod of 200 mm, two elements across, that flies onto a rigid wall."""
    width = 2 * 0.2 / elements
    mesh = block("rod", (width, width, 0.2), width / 2, width / 2, 0.2 / elements)
    foot = mesh.points[:, 2].min()
    return Model(
        mesh,
        {"rod": solid},
        Controls(duration, interval=0.2e-6, **controls),
        velocity={"rod": (0.0, 0.0, -speed)},
        walls=(RigidWall("rod.z-", (0.0, 0.0, foot), (0.0, 0.0, 1.0)),),
        sections=(CutSection("middle", "rod", (0.0, 0.0, foot + 0.1), (0.0, 0.0, 1.0)),),
    ), width**2


@dataclass(frozen=True)
class Bar:
    """A bar of two bodies that meet: length (m), elements along and across, solid."""

    length: float = 0.1
    along: int = 100
    across: int = 2
    solid: Elastic = THIN_STEEL


WIDTH = 2e-3
"""Of both bars, m."""


def two_bars(striking=None, struck=None, speed=5.0, duration=80e-6, angle=0.0, **contact):
    """A bar that strikes another at rest, both square; ``angle`` turns the pair about x."""
    striking, struck = striking or Bar(), struck or Bar()

    def made(name, bar):
        return block(name, (WIDTH, WIDTH, bar.length), WIDTH / bar.across, WIDTH / bar.across, bar.length / bar.along)

    mesh = joined([moved(made("striking", striking), (0.0, 0.0, struck.length)), made("struck", struck)])
    mesh = turned(mesh, (1.0, 0.0, 0.0), angle)
    axis = np.array([0.0, -math.sin(angle), math.cos(angle)])
    middle = tuple((0.5 * struck.length + 1e-9) * axis)
    return Model(
        mesh,
        {"striking": striking.solid, "struck": struck.solid},
        Controls(duration, interval=0.2e-6),
        velocity={"striking": tuple(-speed * axis)},
        contacts=(SurfaceContact("striking.z-", "struck.z+", **contact),),
        sections=(CutSection("middle", "struck", middle, tuple(axis)),),
    )


@dataclass(frozen=True)
class Ball:
    """A ball on a half-space: radius (m), speed (m/s), solids, size of the elements at the pole, m."""

    radius: float = 0.01
    speed: float = 1.0
    solid: Elastic = STEEL
    base: Elastic = STEEL
    size: float = 2e-4
    angle: float = 0.0

    @property
    def mass(self):
        return self.solid.density * 4.0 / 3.0 * math.pi * self.radius**3

    @property
    def modulus(self):
        """E* of both bodies, Pa."""
        return 1.0 / sum((1.0 - s.poissons_ratio**2) / s.youngs_modulus for s in (self.solid, self.base))

    @property
    def hertz(self):
        """Peak force, largest indentation and duration of Hertz's impact (Johnson 1985, Contact Mechanics, 11.4)."""
        stiffness = 4.0 / 3.0 * self.modulus * math.sqrt(self.radius)
        deepest = (1.25 * self.mass * self.speed**2 / stiffness) ** 0.4
        return stiffness * deepest**1.5, deepest, 2.94327 * deepest / self.speed


def ball_on_base(case, reach=30.0, interval=0.5e-6, threads=1):
    """A quarter of a ball that meets a half-space, cut off at ``reach`` tenths of the radius by dashpots."""
    _, deepest, duration = case.hertz
    radius = math.sqrt(case.radius * deepest)
    grading = Grading(0.2 * case.radius, fine=case.size, extent=1.65 * radius, growth=1.25)
    striker = moved(ball("ball", case.radius, grading, "quarter"), (0.0, 0.0, case.radius))
    mesh = joined([striker, half_space("base", 0.1 * reach * case.radius, grading, "quarter")])
    mesh = turned(mesh, (1.0, 0.0, 0.0), case.angle)
    down = (0.0, case.speed * math.sin(case.angle), -case.speed * math.cos(case.angle))
    return Model(
        mesh,
        {"ball": case.solid, "base": case.base},
        Controls(1.15 * duration, interval=interval, threads=threads),
        velocity={"ball": down},
        boundaries=(
            *(Symmetry(f"{part}.{side}") for part in ("ball", "base") for side in ("x-", "y-")),
            NonReflecting("base.round"),
        ),
        contacts=(SurfaceContact("ball.round", "base.top"),),
        points=(Point("pole", "base", (0.0, 0.0, 0.0)),),
    )


@dataclass(frozen=True)
class Roller:
    """A half-cylinder on a block, in plane strain: radius (m), speed (m/s), solids, size of the elements, angle."""

    size: float = 1e-4
    radius: float = 0.01
    speed: float = 2.0
    solid: Elastic = STEEL
    base: Elastic = STEEL
    angle: float = 0.0

    def half_width(self, force):
        """Half-width of the contact under a force per length (N/m), and largest pressure (Johnson 1985, 4.43, 4.45)."""
        modulus = 1.0 / sum((1.0 - s.poissons_ratio**2) / s.youngs_modulus for s in (self.solid, self.base))
        half = math.sqrt(4.0 * force * self.radius / (math.pi * modulus))
        return half, 2.0 * force / (math.pi * half)

    @property
    def turn(self):
        """Rotation from the upright model into this one, (3, 3)."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


THICK = 4e-4
"""Thickness of the roller and its block, one element, m."""


def roller_on_block(case, duration=12e-6):
    """Half of a half-cylinder that meets a block, plane strain."""
    scale = case.radius / 0.01
    grading = Grading(1.5e-3 * scale, fine=case.size, extent=6e-4 * scale, growth=1.2)
    wide = deep = 0.02 * scale
    roller = half_cylinder("roller", case.radius, 2.0 * THICK, grading, THICK, "quarter")
    roller = moved(roller, (0.0, -0.5 * THICK, case.radius))
    upright = Grading(1.5e-3 * scale, fine=case.size, at=(deep,), extent=6e-4 * scale, growth=1.2)
    ground = block("ground", (wide, THICK, deep), grading, THICK, upright)
    low, high = ground.points.min(axis=0), ground.points.max(axis=0)
    ground = moved(ground, (-low[0], -0.5 * (low[1] + high[1]), -high[2]))
    held = ("roller.x-", "ground.x-", "roller.y-", "roller.back", "ground.y-", "ground.y+")
    mesh = turned(joined([roller, ground]), (0.0, 1.0, 0.0), case.angle)
    return Model(
        mesh,
        {"roller": case.solid, "ground": case.base},
        Controls(duration * scale, interval=0.5e-6 * scale),
        velocity={"roller": tuple(case.turn @ (0.0, 0.0, -case.speed))},
        boundaries=(*map(Symmetry, held), NonReflecting("ground.x+"), NonReflecting("ground.z-")),
        contacts=(SurfaceContact("roller.round", "ground.z+"),),
    )
