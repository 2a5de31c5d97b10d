"""Places of the numbers of an element: rows of LANES elements in the scratch, the constants and the state.

Row k of lane j lies at k * LANES + j. Offsets are unsigned: a signed index would be tested for wrap-around, and the
loops over lanes would not become vector loops.

Modes: 0 e1, 1 e2, 2 e3 (linear in xi, eta, zeta), 3 h1 (eta zeta), 4 h2 (xi zeta), 5 h3 (xi eta), 6 h4 (xi eta zeta).
"""

from typing import NamedTuple

import numpy as np

# A whole number of vector registers of any width (2 to 8 doubles), and so few that the scratch of a chunk, 28 KiB,
# leaves room for its constants and state in a first-level cache. Fewer are no loops to a compiler, which writes them
# out and makes no vectors of them.
LANES = 24
"""Elements of a chunk."""
W = np.uint64(LANES)
"""Elements of a chunk as an unsigned number, as offsets are."""
ZERO, ONE, TWO, THREE, FOUR, FIVE, SIX, _, EIGHT = np.arange(9, dtype=np.uint64)


def rows(first: int, count: int) -> tuple[np.uint64, ...]:
    """Return the offsets of rows."""
    return tuple(np.uint64((first + k) * LANES) for k in range(count))


X, Y, Z = rows(0, 8), rows(8, 8), rows(16, 8)
"""Positions of the nodes, then of the modes."""
U, V, T = rows(24, 8), rows(32, 8), rows(40, 8)
"""Velocities of the nodes, then of the modes; at last the forces on modes, then on nodes."""
GX, GY, GZ = rows(48, 6), rows(54, 6), rows(60, 6)
"""Gradients of the volume with respect to the first six modes."""
STRAIN, SPIN = rows(66, 6), rows(72, 3)
"""Strain increment (tensor, xx yy zz xy yz zx) and rotation increment of the step."""
STRESS = rows(75, 6)
"""Stress at the end of the step."""
VOLUME, VISCOUS, WORK, PLASTIC, DAMPED, STEP, HOURGLASS = rows(81, 7)
"""Volume; pressure of the bulk viscosity; work, plastic work and work of the bulk viscosity per volume; critical step;
hourglass energy."""
FIXED, HELD = rows(88, 1)[0], rows(115, 1)[0]
"""Copies of constants and state of the chunk."""
DAMPING, STEEPEST, TRACE = rows(130, 3)
"""Damping rate of the bulk viscosity; largest eigenvalue and trace of sum g g^T over volume: for the critical step."""
FX, FY, FZ, COFACTOR = rows(88, 8), rows(96, 8), rows(104, 8), rows(133, 9)
"""Forces on the modes (in place of constants), cofactors of a point's Jacobian by columns: in full integration."""
WEIGHT, SWELLING, PRESSURE, ALL_WORK, ALL_PLASTIC = rows(142, 5)
"""Jacobian of a point, mean volume change, sums over the points weighted by the Jacobian: in full integration."""
SCRATCH = 147 * LANES
"""Numbers of scratch that a thread needs."""

STIFFNESS, MASS, YIELDING = rows(24, 3)
CONSTANTS = 27
"""Rows of constants: couplings of the hourglass modes, hourglass stiffness (N/m), mass (kg), 1/q_y^2 (1/m^2)."""
SIGMA, STRAIN_P, HEAT, BEFORE, BACK = rows(0, 6), *rows(6, 3), rows(9, 6)
STATES = 15
"""Rows of state of a point: stress, equivalent plastic strain, temperature above room, pressure of the bulk viscosity
(the element's, kept with its first point), back stress."""

ELASTIC, BILINEAR, JOHNSON_COOK, ZERILLI_ARMSTRONG = 0, 1, 2, 3
LAME, SHEAR, SPEED, DENSITY, YIELD, ISOTROPIC, KINEMATIC = np.arange(7, dtype=np.uint64)
RATE, HEATING, ROOM = np.arange(7, 10, dtype=np.uint64)
JC_A, JC_B, JC_N, JC_C, JC_M, JC_RANGE = np.arange(10, 16, dtype=np.uint64)
ZA_C0, ZA_C1, ZA_C2, ZA_C3, ZA_C4, ZA_C5, ZA_N = np.arange(10, 17, dtype=np.uint64)
SOLID = 17
"""Numbers that describe a solid: moduli lambda and G, wave speed, density; yield, isotropic and kinematic hardening;
reference rate, kelvin per joule of plastic work, room temperature; Johnson-Cook's A, B, n, C, m, melting less room
temperature, or Zerilli-Armstrong's C0 to C5 and n."""

SUMS = 4
"""Sums over elements: internal work, plastic work, work of the bulk viscosity, hourglass energy; J."""


class Blocks(NamedTuple):
    """Elements in chunks of LANES."""

    nodes: np.ndarray
    """Nodes of the elements, (chunks * 8 * LANES,)."""
    filled: np.ndarray
    """Elements in each chunk; the lanes beyond repeat the last one."""
    part: np.ndarray
    """Part of each chunk."""
    constants: np.ndarray
    """Constants, (chunks * CONSTANTS * LANES,)."""
    state: np.ndarray
    """State of each point, (chunks * points * STATES * LANES,)."""
    solids: np.ndarray
    """Numbers of the solid of each part, (parts, SOLID)."""
    kinds: np.ndarray
    """Kind of that solid."""
