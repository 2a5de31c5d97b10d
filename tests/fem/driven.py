"""Elements and points of a solid driven by hand, without a solver; kernels as they are written."""

import types

import numpy as np
from scipy import sparse

from strikewave.fem import _layout as layout
from strikewave.fem._solid_kernels import update_stress
from strikewave.fem.hexahedron import (
    FullyIntegrated,
    OnePoint,
    build_blocks,
    element_masses,
    one_point_constants,
    solid_row,
)
from strikewave.fem.mesh import Mesh

SORTS = ("one point", "full")
CUBE = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
XX, YY, ZZ, XY, YZ, ZX = range(6)


def mesh_of(points, hexahedra):
    return Mesh(np.asarray(points, float), hexahedra.astype(np.int32), np.zeros(len(hexahedra), np.int32), ("body",))


def random_hexahedra(rng, count, shift=0.25):
    """Cubes with each node moved by up to a share of the side, no two with a node in common."""
    points = np.tile(CUBE, (count, 1)) + rng.uniform(-shift, shift, (8 * count, 3))
    return mesh_of(points, np.arange(8 * count).reshape(count, 8))


def apart(mesh):
    """The same elements, each with nodes of its own."""
    return mesh_of(mesh.points[mesh.hexahedra.ravel()], np.arange(mesh.hexahedra.size).reshape(-1, 8))


def elements(mesh, solid, sort="one point", hourglass=0.05, viscous=(0.0, 0.0)):
    """Elements without stress."""
    name = mesh.names[0]
    mass = element_masses(mesh, {name: solid})
    if sort == "full":
        return FullyIntegrated(*build_blocks(mesh, {name: solid}, {name: mass[:, None]}, 8), viscous)
    constants = one_point_constants(mesh, {name: solid}, name, mass, hourglass)
    return OnePoint(*build_blocks(mesh, {name: solid}, {name: constants}, 1), viscous)


def moved(found, before, after, step=1.0):
    """Move the nodes in one step; return the forces."""
    force = np.zeros_like(before)
    found.add_forces(after, (after - before) / step, force, step)
    return force


def nodal_mass(mesh, solid):
    mass = np.zeros(len(mesh.points))
    np.add.at(mass, mesh.hexahedra.ravel(), np.repeat(element_masses(mesh, {mesh.names[0]: solid}) / 8.0, 8))
    return mass


def stiffness(mesh, solid, sort="one point", hourglass=0.05, viscous=(0.0, 0.0)):
    """Assembled stiffness (sparse) by differences of the forces, each element alone; with viscosity that of 1 s too."""
    alone = apart(mesh)
    own = np.empty((len(mesh.hexahedra), 24, 24))
    small = 1e-6 * np.ptp(mesh.points[mesh.hexahedra[0]], axis=0).max()
    for k in range(24):
        shift = np.zeros((len(mesh.hexahedra), 24))
        shift[:, k] = small
        ways = [alone.points + way * shift.reshape(-1, 3) for way in (1.0, -1.0)]
        push, pull = (moved(elements(alone, solid, sort, hourglass, viscous), alone.points, way) for way in ways)
        own[:, :, k] = ((pull - push) / (2.0 * small)).reshape(-1, 24)
    freedom = (3 * mesh.hexahedra[:, :, None] + np.arange(3)).reshape(-1, 24)
    rows, columns = np.repeat(freedom, 24, axis=1), np.tile(freedom, (1, 24))
    size = 3 * len(mesh.points)
    return sparse.csr_matrix((own.ravel(), (rows.ravel(), columns.ravel())), (size, size))


class Points:
    """As many points of a solid as a chunk has lanes, each on a path of its own."""

    def __init__(self, solid):
        self.kind, self.row = solid_row(solid)
        self.scratch = np.zeros(layout.SCRATCH)
        self.rows = self.scratch.reshape(-1, layout.LANES)

    def move(self, strain, step=1.0):
        """Add strain increments (lanes, 6) or (6,): tensors xx yy zz xy yz zx."""
        self._at(layout.STRAIN, 6)[:] = np.broadcast_to(strain, (layout.LANES, 6)).T
        update_stress(self.scratch, self.row, self.kind, step)

    def copy(self):
        other = object.__new__(Points)
        other.kind, other.row, other.scratch = self.kind, self.row, self.scratch.copy()
        other.rows = other.scratch.reshape(-1, layout.LANES)
        return other

    def _at(self, rows, count):
        first = int(rows[0] if isinstance(rows, tuple) else rows) // layout.LANES
        return self.rows[first : first + count]

    def _held(self, rows, count):
        return self._at(int(layout.HELD) + int(rows), count)

    @property
    def stress(self):
        return self._held(layout.SIGMA[0], 6).T

    @property
    def back_stress(self):
        return self._held(layout.BACK[0], 6).T

    @property
    def plastic_strain(self):
        return self._held(layout.STRAIN_P, 1)[0]

    @property
    def heat(self):
        """Temperature above room, K; may be set."""
        return self._held(layout.HEAT, 1)[0]

    @property
    def work(self):
        """Of the last step, J/m^3."""
        return self._at(layout.WORK, 1)[0]

    @property
    def plastic_work(self):
        """Of the last step, J/m^3."""
        return self._at(layout.PLASTIC, 1)[0]


def as_written(kernel, written):
    """Return a kernel, with all that it calls, as Python: nothing is compiled; ``written`` keeps those made before."""
    function = getattr(kernel, "py_func", None)
    if function is None:
        return kernel
    if kernel not in written:
        names = dict(function.__globals__)
        written[kernel] = types.FunctionType(function.__code__, names, function.__name__, function.__defaults__)
        names.update({name: as_written(value, written) for name, value in names.items() if hasattr(value, "py_func")})
    return written[kernel]
