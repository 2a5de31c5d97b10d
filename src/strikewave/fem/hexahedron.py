"""The 8-node hexahedron with one integration point (Flanagan & Belytschko 1981): constants, slabs, forces; SI.

The critical step is that of the theory, :eq:`fem-step`.

Gradient. With the amplitudes of the modes 1, xi, eta, zeta, eta zeta, xi zeta, xi eta, xi eta zeta in place of nodal
values (a Walsh-Hadamard transform of eight numbers), a shape is e1 xi + e2 eta + e3 zeta + h1 eta zeta + h2 xi zeta +
h3 xi eta + h4 xi eta zeta, and its volume V has the gradient

    g(e1) = 8 (e2 x e3 + h3 x h2 / 3),   g(h1) = 8/3 (e3 x h2 + h3 x e2),   g(h4) = 0,   and cyclic.

The mean gradient of a field u over the element is then exactly sum over the modes of u_m g_m / V: a linear field gives
a constant stress for any shape, so that the patch test is passed. Forces are f_m = -sigma g_m, transformed back.

Stress. Strain and rotation increments are taken at the middle of the step, stress is turned by the rotation increment
(Hughes & Winget 1980) and the strain by half of it: a rigid motion leaves no stress, the turned stress keeps its
invariants, and an elastic solid that spins while it strains follows Jaumann's rate to second order in the step.

Hourglass stiffness. What remains of an hourglass mode h when the motion that is linear over the first shape (index
0) is taken off is q = h + sum over m of c_m x_m, c_m = -(h_0 . g_0m) / V_0. It is zero for any uniform deformation and
turns with the element. Each q has the energy 8 k q^2 / (1 + r), r = sqrt(1 + q^2 / q_y^2), in an elastic solid 4 k q^2:
the forces follow from a potential, so that they conserve energy, momentum and angular momentum, and need no history.
k = 1/2 kappa (lambda + 2 G) B : B / V_0 is that of Flanagan & Belytschko's stiffness form, kappa
``Controls.hourglass``. For a cube k = E h / 6 would bend exactly: kappa = 0.17 at nu = 0.29. Where a solid yields the
force of a mode must not go on to grow, or an elastic skeleton would hold the plastic flow up: it stays below
8 k q_y = 9/2 kappa sigma_y V^(2/3), for a cube of nu = 0 whose stiffness bends exactly the load of a plastic hinge,
sigma_y h^2.

Bulk viscosity. q = -rho l (q1 c - q2 l min(r, 0)) r, r the rate of volume, l the smallest thickness, c the speed of
a pressure wave. Its work in a step is, as that of the stress, what the mean of q before and after does: the work of
the forces at both ends.

Time step. 4 / (d + sqrt(d^2 + 4 w)), w = (2 G a + lambda b) / (m V) with a, b the largest eigenvalue (a bound of it)
and the trace of sum g g^T, d = l (q1 c - q2 l min(r, 0)) b / V^2 the damping rate of the bulk viscosity, whose force
lags half a step: no element is faster, nor is a mesh of such elements. It is 0 for an element that is turned inside
out, or whose numbers are not finite.

The 8-node hexahedron with selectively reduced full integration (mean dilatation, Nagtegaal et al 1974); SI.

Two by two by two Gauss points carry the deviator of the stress; the volume change is the mean over the element, the
same as that of the one-point element (`strikewave.fem.hexahedron`): 2 x 2 x 2 points integrate the Jacobian and its
cofactors exactly, so that the mean over the points of the gradient is g / V. A solid that keeps its volume, plastic or
nearly incompressible, does not lock (Hughes 1980), and no hourglass mode is without stiffness.

At each point the strain and rotation increments are taken at the middle of the step, and the same laws of the solid
hold, as in the one-point element. Forces on the modes are those of the deviators at the points, and of the mean of
their mean stresses, the pressure of the bulk viscosity included, with the mean gradient.

In bending within a plane the element is too stiff by shear (it has no curvature of its own): what it needs is two or
three elements across, or the one-point element.

Time step. As for the one-point element, with a bound of the largest eigenvalue of the integral of gradient times
gradient: 8 times the largest over the points of that of w J^-1 J^-T, w the Jacobian; 0 unless each w is positive.

Sources: J. C. Nagtegaal, D. M. Parks, J. R. Rice, On numerically accurate finite element solutions in the fully plastic
range, Computer Methods in Applied Mechanics and Engineering 4 (1974) 153; T. J. R. Hughes, Generalization of selective
integration procedures to anisotropic and nonlinear media, International Journal for Numerical Methods in Engineering 15
(1980) 1413.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.fem import _full_kernels
from strikewave.fem import _hexahedron_kernels as kernels
from strikewave.fem import _history_kernels as history_kernels
from strikewave.fem import _layout as layout
from strikewave.fem._full_kernels import POINTS
from strikewave.fem._layout import Blocks
from strikewave.fem.mesh import Array, Index, Mesh, volumes
from strikewave.fem.model import Model
from strikewave.fem.solids import AnySolid, Bilinear, HeatedSolid, JohnsonCook, ZerilliArmstrong
from strikewave.fem.threads import on_all

SLAB = 16  # 384 elements: threads share small meshes evenly, and most slabs share nodes with their neighbours alone
"""Fewest chunks of a slab."""
SLABS = 32  # twice the threads of a usual machine, since slabs that share nodes take turns
"""Most slabs of a mesh."""
COUPLINGS = 24
"""Couplings of the four hourglass modes to the six other modes: the first rows of constants."""
STIFFNESS, MASS, YIELDING = (int(row) // layout.LANES for row in (layout.STIFFNESS, layout.MASS, layout.YIELDING))
"""Columns of the other constants; see `strikewave.fem._layout`."""
HINGE = 4.5  # the plastic hinge of a cube, see the module
"""Largest hourglass force over kappa sigma_y V^(2/3)."""
SIGNS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
"""xi, eta, zeta of the nodes."""
MODES = np.stack(
    [*SIGNS.T, SIGNS[:, 1] * SIGNS[:, 2], SIGNS[:, 0] * SIGNS[:, 2], SIGNS[:, 0] * SIGNS[:, 1], SIGNS.prod(axis=1)]
)
"""Values of the modes e1, e2, e3, h1, h2, h3, h4 at the nodes, (7, 8)."""

TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Place in a row xx yy zz xy yz zx of each component of a symmetric tensor."""
COMPONENTS = ((0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0))
"""Row and column of the tensor of each place in such a row."""


@dataclass(frozen=True)
class Shapes:
    """First shape of elements: amplitudes (elements, 7, 3), gradients of the volume (elements, 6, 3), volume."""

    amplitudes: Array
    gradients: Array
    volume: Array


def shapes(points: Array, hexahedra: Index) -> Shapes:
    """Return amplitudes, gradients and volumes of elements."""
    amplitudes = np.einsum("mk,ekd->emd", MODES, points[hexahedra]) / 8.0
    e1, e2, e3, h1, h2, h3, _ = (amplitudes[:, m] for m in range(7))
    cross = np.cross
    gradient = np.stack(
        [
            8.0 * cross(e2, e3) + 8.0 / 3.0 * cross(h3, h2),
            8.0 * cross(e3, e1) + 8.0 / 3.0 * cross(h1, h3),
            8.0 * cross(e1, e2) + 8.0 / 3.0 * cross(h2, h1),
            8.0 / 3.0 * (cross(e3, h2) + cross(h3, e2)),
            8.0 / 3.0 * (cross(e1, h3) + cross(h1, e3)),
            8.0 / 3.0 * (cross(e2, h1) + cross(h2, e1)),
        ],
        axis=1,
    )
    return Shapes(amplitudes, gradient, np.einsum("emd,emd->e", amplitudes[:, :6], gradient) / 3.0)


def solid_row(solid: AnySolid) -> tuple[int, Array]:
    """Return kind and numbers of a solid for the kernels."""
    row = np.zeros(layout.SOLID)
    shear = solid.shear_modulus
    row[layout.LAME], row[layout.SHEAR] = solid.wave_modulus - 2.0 * shear, shear
    row[layout.SPEED], row[layout.DENSITY] = solid.wave_speed, solid.density
    if isinstance(solid, Bilinear):
        hardening = solid.plastic_modulus
        row[layout.YIELD] = solid.yield_strength
        row[layout.ISOTROPIC] = (1.0 - solid.kinematic) * hardening
        row[layout.KINEMATIC] = solid.kinematic * hardening
        return layout.BILINEAR, row
    if isinstance(solid, HeatedSolid):
        row[layout.RATE], row[layout.ROOM] = solid.reference_rate, solid.room_temperature
        row[layout.HEATING] = solid.heat_fraction / (solid.density * solid.specific_heat)
    if isinstance(solid, JohnsonCook):
        row[layout.JC_A : layout.JC_M + 1] = solid.A, solid.B, solid.n, solid.C, solid.m
        row[layout.JC_RANGE] = solid.melting_temperature - solid.room_temperature
        return layout.JOHNSON_COOK, row
    if isinstance(solid, ZerilliArmstrong):
        row[layout.ZA_C0 : layout.ZA_N + 1] = solid.C0, solid.C1, solid.C2, solid.C3, solid.C4, solid.C5, solid.n
        return layout.ZERILLI_ARMSTRONG, row
    return layout.ELASTIC, row


def critical_steps(first_shapes: Shapes, mass: Array, solid: AnySolid, viscosity: float) -> Array:
    """Return a time step below which each element is stable by itself, s, with a linear viscosity; see the module."""
    g = first_shapes.gradients
    gram = np.abs(np.einsum("emd,end->emn", g[:, :3], g[:, :3]))
    warped = np.einsum("emd,emd->e", g[:, 3:], g[:, 3:])
    largest = gram.sum(axis=2).max(axis=1) + warped
    return steps_of(first_shapes, largest / first_shapes.volume, mass, solid, viscosity)


def steps_of(first_shapes: Shapes, steepest: Array, mass: Array, solid: AnySolid, viscosity: float) -> Array:
    """Return critical steps, given a bound of the largest eigenvalue of the integral of gradient times gradient."""
    square = np.einsum("emd,emd->em", first_shapes.gradients, first_shapes.gradients)
    trace, thickness = square.sum(axis=1), 2.0 * first_shapes.volume / np.sqrt(square[:, :3].max(axis=1))
    lame = solid.wave_modulus - 2.0 * solid.shear_modulus
    fastest = (2.0 * solid.shear_modulus * steepest + lame * trace / first_shapes.volume) / mass
    damping = viscosity * solid.wave_speed * thickness * trace / first_shapes.volume**2
    return np.asarray(4.0 / (damping + np.sqrt(damping**2 + 4.0 * fastest)))


def one_point_constants(mesh: Mesh, solids: Mapping[str, AnySolid], part: str, mass: Array, hourglass: float) -> Array:
    """Return the constants of each element of a part, (elements, CONSTANTS), for an hourglass coefficient."""
    elements = mesh.elements_of(part)
    first_shapes = shapes(mesh.points, mesh.hexahedra[elements])
    rows = np.empty((elements.stop - elements.start, layout.CONSTANTS))
    coupling = (
        np.einsum("ehd,emd->ehm", first_shapes.amplitudes[:, 3:], first_shapes.gradients)
        / first_shapes.volume[:, None, None]
    )
    rows[:, :COUPLINGS] = -coupling.reshape(-1, COUPLINGS)
    square = np.einsum("emd,emd->e", first_shapes.gradients, first_shapes.gradients) / 8.0
    rows[:, STIFFNESS] = 0.5 * hourglass * solids[part].wave_modulus * square / first_shapes.volume
    rows[:, MASS] = mass[elements]
    largest = HINGE * hourglass * solids[part].strength * first_shapes.volume ** (2.0 / 3.0)
    rows[:, YIELDING] = (8.0 * rows[:, STIFFNESS] / largest) ** 2 if hourglass else 0.0
    return rows


def build_blocks(
    mesh: Mesh, solids: Mapping[str, AnySolid], constants: Mapping[str, Array], points: int
) -> tuple[Blocks, Index]:
    """Return the elements of some parts in chunks, and the number of the element in each lane (chunks, LANES).

    ``constants`` are those that each element keeps, (elements of the part, rows), by part; ``points`` is the number of
    integration points of an element.
    """
    lanes, numbers, counts, owners, columns = layout.LANES, [], [], [], []
    for part, rows in constants.items():
        first, count = mesh.elements_of(part).start, len(rows)
        chunks = -(-count // lanes)
        lane = np.minimum(np.arange(chunks * lanes), count - 1)  # free lanes repeat the last element: no lane is NaN
        numbers.append(first + lane.reshape(chunks, lanes))
        counts.append(np.minimum(count - lanes * np.arange(chunks), lanes))
        owners.append(np.full(chunks, mesh.names.index(part)))
        columns.append(rows[lane].reshape(chunks, lanes, -1).transpose(0, 2, 1))
    number = np.concatenate(numbers)
    table = [solid_row(solids[name]) for name in mesh.names]
    nodes = mesh.hexahedra[number].transpose(0, 2, 1)
    owner = np.concatenate(owners).astype(np.int32)
    state = np.zeros((len(number), points, layout.STATES, lanes))
    preheat = np.array([getattr(solids[name], "preheat", 0.0) for name in mesh.names])
    state[:, :, int(layout.HEAT) // lanes] = preheat[owner, None, None]
    blocks = Blocks(
        nodes=np.ascontiguousarray(nodes, np.int32).ravel(),
        filled=np.concatenate(counts).astype(np.int32),
        part=owner,
        constants=np.concatenate(columns).ravel(),
        state=state.ravel(),
        solids=np.array([row for _, row in table]),
        kinds=np.array([kind for kind, _ in table], np.int32),
    )
    return blocks, number.astype(np.int32)


def cut_slabs(nodes: Index, part: Index) -> tuple[NDArray[np.int64], list[NDArray[np.int64]]]:
    """Cut chunks into slabs, and the slabs into groups whose members share no node.

    ``nodes`` are those of each chunk, (chunks, nodes), ``part`` is its part. Return first and last chunk (exclusive) of
    each slab, (slabs, 2), and the slabs of each group, which may be treated side by side. The number of threads changes
    neither, and so no sum.
    """
    chunks = len(part)
    size = max(SLAB, -(-chunks // SLABS))
    edges = np.unique([0, chunks, *np.flatnonzero(np.diff(part)) + 1, *range(0, chunks, size)]).astype(np.int64)
    slabs = np.column_stack([edges[:-1], edges[1:]])
    touched = [np.unique(nodes[first:last]) for first, last in slabs]
    groups: list[list[int]] = []
    taken: list[NDArray[np.bool_]] = []
    for slab, own in enumerate(touched):
        free = next((k for k, used in enumerate(taken) if not used[own].any()), len(groups))
        if free == len(groups):
            groups.append([])
            taken.append(np.zeros(int(nodes.max()) + 1, bool))
        groups[free].append(slab)
        taken[free][own] = True
    return slabs, [np.array(group, np.int64) for group in groups]


class Hexahedra:
    """Elements of one kind: state, forces, work.

    ``blocks`` and ``number`` are those of `build_blocks`, ``viscous`` the coefficients of the bulk viscosity.
    """

    points: ClassVar[int]
    """Integration points of an element."""
    forces: ClassVar[Callable[..., float]]
    """Kernel that treats slabs."""

    def __init__(
        self,
        blocks: Blocks,
        number: Index,
        viscous: tuple[float, float],
        pool: ThreadPoolExecutor | None = None,
        threads: int = 1,
    ) -> None:
        self.blocks, self.number, self.viscous, self.pool = blocks, number, viscous, pool
        self.slabs, groups = cut_slabs(blocks.nodes.reshape(-1, 8 * layout.LANES), blocks.part)
        self.sums = np.zeros((len(self.slabs), layout.SUMS))
        self.shares = [np.array_split(group, min(threads, len(group))) for group in groups]
        self.scratch = [np.zeros(layout.SCRATCH) for _ in range(threads)]

    def add_forces(self, x: Array, v: Array, f: Array, step: float) -> float:
        """Bring the elements to the end of a step and add their forces to f; return the critical step, s.

        x is at the end of the step, v the velocity within it.
        """
        least = np.inf
        for shares in self.shares:
            work = [
                (self.blocks, self.slabs, share, x, v, f, step, self.viscous, scratch, self.sums)
                for share, scratch in zip(shares, self.scratch, strict=False)
            ]
            least = min(least, *on_all(self.pool, self.forces, work))
        return least

    def work(self) -> Array:
        """Return internal work, plastic work, work of the bulk viscosity and hourglass energy, J."""
        return np.asarray(self.sums.sum(axis=0))

    def plastic_work(self, names: Sequence[str]) -> dict[str, float]:
        """Return the plastic work of each part of these elements, J; ``names`` are all parts of the mesh."""
        owner = self.blocks.part[self.slabs[:, 0]]
        return {names[part]: float(self.sums[owner == part, 1].sum()) for part in np.unique(owner)}

    def begin_balance(self) -> None:
        """Begin the sums with the energy that is stored."""
        # The plastic work is part of the internal: what is left is elastic. Nothing is plastic or viscous yet.
        self.sums[:, 0] -= self.sums[:, 1]
        self.sums[:, 1:3] = 0.0

    def turn(self, rotation: Array) -> None:
        """Turn stress and back stress with the elements, (elements of the mesh, 3, 3)."""
        shape = (-1, self.points, layout.STATES, layout.LANES)
        state, turns = self.blocks.state.reshape(shape), rotation[self.number]
        for rows in (layout.SIGMA, layout.BACK):
            first = int(rows[0]) // layout.LANES
            tensors = state[:, :, first : first + 6].transpose(0, 3, 1, 2)[..., TENSOR]
            turned = np.einsum("clij,clpjk,clmk->clpim", turns, tensors, turns)
            state[:, :, first : first + 6] = turned[..., *COMPONENTS].transpose(0, 2, 3, 1)

    def peaks(self) -> Array:
        """Return the largest squared von Mises stress, Pa^2, and plastic strain of each chunk, (chunks, 2)."""
        peaks = np.zeros((len(self.blocks.filled), 2))
        history_kernels.peaks_of_chunks(self.blocks.state, self.blocks.filled, self.points, peaks)
        return peaks

    def stress_places(self, elements: Index) -> Index:
        """Return where the stress of each point begins, (own, points), of the elements that are of this kind."""
        own = elements[np.isin(elements, self.number)]
        number = self.number.ravel()
        lane_of = np.zeros(number.max(initial=0) + 1, np.int64)
        lane_of[number[::-1]] = np.arange(number.size)[::-1]  # of an element that is repeated the first
        chunk, lane = np.divmod(lane_of[own], layout.LANES)
        points = chunk[:, None] * self.points + np.arange(self.points)
        return np.asarray(points * history_kernels.POINT + lane[:, None])

    def cell_values(self, elements: int) -> tuple[Array, Array]:
        """Return stress (elements, 6) and equivalent plastic strain (elements,), means over the points.

        They are zero for elements of others.
        """
        rows = self.blocks.state.reshape(-1, self.points, layout.STATES, layout.LANES)[:, :, :7].mean(axis=1)
        stress, strain = np.zeros((elements, 6)), np.zeros(elements)
        stress[self.number] = rows[:, :6].transpose(0, 2, 1)
        strain[self.number] = rows[:, 6]
        return stress, strain


class OnePoint(Hexahedra):
    """Elements with one integration point and hourglass stiffness."""

    points = 1
    forces = staticmethod(kernels.slab_forces)


def element_masses(mesh: Mesh, solids: Mapping[str, AnySolid]) -> Array:
    """Return the mass of each element, kg."""
    density = np.array([solids[name].density for name in mesh.names])
    return np.asarray(density[mesh.part] * volumes(mesh.points, mesh.hexahedra))


class FullyIntegrated(Hexahedra):
    """Elements with eight integration points for the deviator and the mean volume change."""

    points = len(POINTS)
    forces = staticmethod(_full_kernels.slab_forces)


class Mixed:
    """Elements of several kinds behind the interface of one."""

    def __init__(self, kinds: Sequence[Hexahedra]) -> None:
        self.kinds = kinds

    def add_forces(self, x: Array, v: Array, f: Array, step: float) -> float:
        """Bring the elements to the end of a step and add their forces to f; return the critical step, s."""
        return min((each.add_forces(x, v, f, step) for each in self.kinds), default=np.inf)

    def work(self) -> Array:
        """Return internal work, plastic work, work of the bulk viscosity and hourglass energy, J."""
        return sum((each.work() for each in self.kinds), np.zeros(4))

    def plastic_work(self, names: Sequence[str]) -> dict[str, float]:
        """Return the plastic work of each part that deforms, J; ``names`` are all parts of the mesh."""
        return {name: work for each in self.kinds for name, work in each.plastic_work(names).items()}

    def cell_values(self, elements: int) -> tuple[Array, Array]:
        """Return stress (elements, 6) and equivalent plastic strain (elements,); zero for rigid elements."""
        stress, strain = np.zeros((elements, 6)), np.zeros(elements)
        for each in self.kinds:
            own = each.cell_values(elements)
            stress, strain = stress + own[0], strain + own[1]
        return stress, strain


def full_critical_steps(points: Array, hexahedra: Index, mass: Array, solid: AnySolid, viscosity: float) -> Array:
    """Return a time step below which each element is stable by itself, s, with a linear viscosity; see the module."""
    first_shapes = shapes(points, hexahedra)
    steepest = np.zeros(len(hexahedra))
    for place in POINTS:
        p, q, r = np.moveaxis(np.einsum("km,emd->ekd", mode_slopes(place), first_shapes.amplitudes), 1, 0)
        columns = np.stack([np.cross(q, r), np.cross(r, p), np.cross(p, q)], axis=1)
        weight = np.einsum("ed,ed->e", p, columns[:, 0])
        gram = np.abs(np.einsum("emd,end->emn", columns, columns)).sum(axis=2).max(axis=1)
        steepest = np.maximum(steepest, 8.0 * gram / weight)
    return steps_of(first_shapes, steepest, mass, solid, viscosity)


def mode_slopes(place: Array) -> Array:
    """Return the derivatives of the seven modes by xi, eta and zeta at a place, (3, 7)."""
    x, y, z = place
    return np.array([[1, 0, 0, 0, z, y, y * z], [0, 1, 0, z, 0, x, x * z], [0, 0, 1, y, x, 0, x * y]])


SCALINGS = 60  # one does without bulk viscosity; with it the step grows more slowly than the root of the mass
"""Rounds in which mass is added; where the step then still is too short, no mass suffices."""
ROUNDING = 1e-9  # above rounding, far below what a step is cut by
"""Share by which a step may miss the span it should fit."""


def fitting(span: float, longest: float) -> float:
    """Return the largest step up to a longest one that goes into a span a whole number of times, s."""
    return span / max(1, math.ceil(span / longest - ROUNDING))


def part_masses(mesh: Mesh, element_mass: Array, name: str) -> Array:
    """Return the mass of a part at each of its nodes, kg."""
    chosen = mesh.elements_of(name)
    return nodal_sums(mesh.hexahedra[chosen], element_mass[chosen] / 8.0, len(mesh.points))[mesh.nodes_of(name)]


def nodal_sums(hexahedra: Index, values: Array, nodes: int) -> Array:
    """Return the sum of a value of elements over those of each node, (nodes,)."""
    return np.asarray(np.bincount(hexahedra.ravel(), np.repeat(values, 8), nodes), float)


def scaled_masses(model: Model, parts: Iterable[str]) -> tuple[Array, float, float]:
    """Return the masses of the elements, kg; the mass that was added for the wanted step; the critical step, s."""
    mesh, controls = model.mesh, model.controls
    mass = element_masses(mesh, model.solids)
    before, least = mass.sum(), np.inf
    for name in parts:
        chosen, wanted = mesh.elements_of(name), controls.least_step / controls.safety
        for _ in range(SCALINGS):
            steps = first_steps(model, name, mass[chosen])
            short = wanted / steps
            if short.max() <= 1.0 + ROUNDING:
                break
            mass[chosen] *= np.maximum(short, 1.0) ** 2  # the step grows as the root of the mass
        else:
            limit = f"at most about {controls.safety * float(steps.min()):.3g} s for {name}"
            raise InputError("least_step", controls.least_step, limit, "the bulk viscosity allows no longer one")
        least = min(least, float(steps.min()))
    return mass, float(mass.sum() - before), least


def first_steps(model: Model, part: str, mass: Array) -> Array:
    """Return the critical steps of the elements of a part before the run, s; ``mass`` is that of its elements."""
    mesh, controls = model.mesh, model.controls
    hexahedra, rest = mesh.hexahedra[mesh.elements_of(part)], (mass, model.solids[part], controls.linear_viscosity)
    if part in controls.full:
        return full_critical_steps(mesh.points, hexahedra, *rest)
    return critical_steps(shapes(mesh.points, hexahedra), *rest)
