"""The 8-node hexahedron with selectively reduced full integration (mean dilatation, Nagtegaal et al 1974); SI.

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

from collections.abc import Sequence

import numpy as np

from strikewave.fem import _full_kernels
from strikewave.fem._full_kernels import POINTS
from strikewave.fem.hexahedron import Hexahedra, shapes, steps_of
from strikewave.fem.mesh import Array, Index
from strikewave.fem.solids import AnySolid


class FullyIntegrated(Hexahedra):
    """Elements with eight integration points for the deviator and the mean volume change."""

    points = len(POINTS)
    forces = staticmethod(_full_kernels.slab_forces)


class Mixed:
    """Elements of several kinds behind the interface of one.

    Attributes
    ----------
    kinds : sequence of Hexahedra
    """

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


def critical_steps(points: Array, hexahedra: Index, mass: Array, solid: AnySolid, viscosity: float) -> Array:
    """Return a time step below which each element is stable by itself, s, with a linear viscosity; see the module.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> from strikewave.fem.solids import Elastic
    >>> round(float(critical_steps(cube, np.arange(8)[None], np.ones(1), Elastic(1.0, 1.0, 0.0), 0.0)[0]), 12)
    1.0
    """
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
