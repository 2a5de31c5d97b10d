"""A blow that looks like one, made of closed forms, for tests of what is shown and stored: no solver ran.

A striker with the first mode of a bar hits a block: half-sine force, motions by Newton's law from it, an energy balance
whose parts add up to what is left of the kinetic energy, stresses that fall off with the distance from the contact.
"""

import numpy as np

from strikewave.fem.mesh import FACES, Mesh, joined, volumes
from strikewave.fem.model import Controls, CutSection, Model, Point, SurfaceContact
from strikewave.fem.run import FemRun, FieldFrame, PartHistory, PointHistory, SectionHistory
from strikewave.fem.solids import Bilinear, Elastic

STEEL, BRASS = Elastic(7850.0, 210e9, 0.3), Bilinear(8500.0, 100e9, 0.35, yield_strength=200e6, tangent_modulus=2e9)
SPEED, DURATION, INTERVAL = 3.0, 60e-6, 0.5e-6


def grid(name: str, low, high, cells) -> Mesh:
    """A block of equal hexahedra with its bottom and top as sides."""
    axes = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, cells, strict=True)]
    nx, ny, nz = cells
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    k, j, i = (index.ravel() for index in np.meshgrid(*(np.arange(n) for n in (nz, ny, nx)), indexing="ij"))

    def node(di, dj, dk):
        return (i + di) + (nx + 1) * ((j + dj) + (ny + 1) * (k + dk))

    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexahedra = np.column_stack([node(*corner) for corner in corners]).astype(np.int32)
    sides = {f"{name}.bottom": hexahedra[k == 0][:, FACES[0]], f"{name}.top": hexahedra[k == nz - 1][:, FACES[1]]}
    return Mesh(points, hexahedra, np.zeros(len(hexahedra), np.int32), (name,), sides)


def ball(name: str, centre, radius: float, cells: int) -> Mesh:
    """A cube of cells blown up to a ball: each concentric cube becomes a sphere."""
    cube = grid(name, (-1, -1, -1), (1, 1, 1), (cells,) * 3)
    far = np.abs(cube.points).max(axis=1, keepdims=True)
    length = np.linalg.norm(cube.points, axis=1, keepdims=True)
    points = radius * cube.points * far / np.maximum(length, 1e-12)
    return Mesh(points + np.asarray(centre), cube.hexahedra, cube.part, cube.names, cube.sides)


def mesh(fine: int = 1) -> Mesh:
    """A ball of 6 mm radius just above a block of 30 mm x 30 mm x 12 mm."""
    block = grid("block", (-0.015, -0.015, -0.012), (0.015, 0.015, 0.0), (10 * fine, 10 * fine, 4 * fine))
    return joined([ball("ball", (0.0, 0.0, 0.006), 0.006, 6 * fine), block])


def model(of: Mesh | None = None) -> Model:
    return Model(
        of or mesh(),
        {"ball": STEEL, "block": BRASS},
        Controls(2 * DURATION, INTERVAL),
        velocity={"ball": (0.0, 0.0, -SPEED)},
        contacts=(SurfaceContact("ball.all", "block.top"),),
        sections=(CutSection("below", "block", (0, 0, -0.006), (0, 0, 1)),),
        points=(Point("under", "block", (0, 0, -0.012)),),
    )


def frame(of: Mesh, time: float) -> FieldFrame:
    """Stresses of a pulse that spreads from the contact at the origin; the ball goes down and back."""
    middle = of.points[of.hexahedra].mean(axis=1)
    distance = np.linalg.norm(middle, axis=1)
    share = np.sin(np.pi * min(time / DURATION, 1.0))
    spread = share / (1.0 + (distance / 0.003) ** 2)
    direction = middle / np.maximum(distance, 1e-12)[:, None]
    size = -900e6 * spread
    stress = np.column_stack(
        [size * direction[:, a] * direction[:, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    )
    depth = np.zeros_like(of.points)
    depth[:, 2] = -40e-6 * share / (1.0 + (np.linalg.norm(of.points, axis=1) / 0.004) ** 2)
    nodes = np.unique(of.hexahedra[of.elements_of("ball")])
    depth[nodes, 2] -= 30e-6 * share
    inside, block = np.zeros(len(of.hexahedra)), of.elements_of("block")
    most = np.sin(np.pi * min(time / DURATION, 0.5)) / (1.0 + (distance[block] / 0.003) ** 2)  # what yielded stays so
    inside[block] = np.maximum(most - 0.3, 0.0) * 0.02
    return FieldFrame(time, depth, depth / DURATION, stress, inside)


def frames(of: Mesh, count: int = 4) -> list[FieldFrame]:
    return [frame(of, float(t)) for t in np.linspace(0.0, DURATION, count)]


def run(of: Mesh | None = None, leak: float = 2e-4, hourglass: float = 0.01) -> FemRun:
    """Histories of the blow; ``leak`` is the energy error at the end, ``hourglass`` its share of internal energy."""
    of = of or mesh()
    volume = volumes(of.points, of.hexahedra)
    mass = {n: d * float(volume[of.elements_of(n)].sum()) for n, d in (("ball", 7850.0), ("block", 8500.0))}
    reduced = mass["ball"] * mass["block"] / sum(mass.values())
    time = INTERVAL * np.arange(round(2 * DURATION / INTERVAL) + 1)
    impulse = 1.6 * reduced * SPEED
    peak = impulse * np.pi / (2 * DURATION)
    on = time < DURATION
    size = np.where(on, peak * np.sin(np.pi * time / DURATION), 0.0)
    given = np.where(on, 0.5 * impulse * (1 - np.cos(np.pi * time / DURATION)), impulse)
    up = np.array([0.0, 0.0, 1.0])
    parts = {}
    for name, sign, start in (("ball", 1.0, -SPEED), ("block", -1.0, 0.0)):
        velocity = np.outer(start + sign * given / mass[name], up)
        acceleration = np.outer(sign * size / mass[name], up)
        displacement = np.cumsum(velocity, axis=0) * INTERVAL
        parts[name] = PartHistory(mass[name], velocity, acceleration, displacement)
    kinetic = sum(0.5 * p.mass * (p.velocity**2).sum(axis=1) for p in parts.values())
    initial = 0.5 * mass["ball"] * SPEED**2
    lost = initial - kinetic
    glass, viscous, contact = hourglass * lost, 0.02 * lost, 0.03 * size**2 / peak**2 * initial
    internal = lost - glass - viscous - contact + leak * initial * time / time[-1]
    zero = np.zeros_like(time)
    energy = {"kinetic": kinetic, "internal": internal, "plastic": np.maximum.accumulate(0.4 * internal)}
    energy |= {"hourglass": glass, "contact": contact, "viscous": viscous, "external": zero}
    stress = np.zeros((time.size, 6))
    stress[:, 2] = -size / 9e-4
    parts_momentum = sum(p.mass * p.velocity for p in parts.values())
    rows = np.outer(size, up)
    return FemRun(
        time=time,
        force={"ball.all-block.top": rows},
        impulse={"ball.all-block.top": np.outer(given, up)},
        energy=energy,
        initial_energy=initial,
        parts=parts,
        points={"under": PointHistory(3, -rows * 1e-9, -rows * 1e-4, -rows / 2.0)},
        sections={"below": SectionHistory(100, stress, -rows * 1e-5, -rows * 10.0)},
        momentum=np.asarray(parts_momentum),
        impulse_given=np.zeros((time.size, 3)),
        steps=4321,
        step=2.8e-8,
        added_mass=0.0,
        seconds=12.3,
        elements=len(of.hexahedra),
        von_mises={"ball": 2.0 * size / 9e-4, "block": size / 9e-4},
        plastic_strain={"ball": zero, "block": np.maximum.accumulate(size) / peak * 0.02},
    )
