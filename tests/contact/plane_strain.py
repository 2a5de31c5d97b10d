"""Elastic contact in plane strain, solved numerically: nothing of Hertz's solution goes in.

Symbols: a half-width (m), E1 = E/(1 - nu^2) plane-strain modulus (Pa), 1/E* = sum 1/E1, P = F/h load per
length (N/m), R radius (m), D depth (m). Pressure is piecewise linear between nodes, zero at both ends (a smooth
contact), and acts along the line of centres; x runs along the common tangent. Equations are met between the nodes.
"""

import math
from typing import NamedTuple

import numpy as np

GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)


class Pressed(NamedTuple):
    """A solved contact: nodes (m), pressure at them (Pa), approach (m), load per length (N/m)."""

    nodes: np.ndarray
    pressure: np.ndarray
    approach: float
    load: float


def nodes_of(half_width, elements):
    """Return nodes on [-a, a], finer to the ends as the cosine: x = -a cos(k pi/n)."""
    return -half_width * np.cos(np.pi * np.arange(elements + 1) / elements)


def log_weights(points, nodes):
    """Return the exact integrals of ln|x - t| times each node's hat function, one row per point x."""
    ends = nodes[None, :] - np.asarray(points, float)[:, None]
    logs = np.log(np.abs(np.where(ends == 0.0, 1.0, ends)))
    zeroth = np.diff(ends * logs - ends)
    first = np.diff(ends**2 * (logs / 2 - 0.25))
    right = (first - ends[:, :-1] * zeroth) / np.diff(nodes)
    return _hats(zeroth - right, right)


def smooth_weights(points, nodes, kernel):
    """Return the integrals of a smooth kernel(x, t) times each hat function (Gauss, four points an element)."""
    size = np.diff(nodes)
    share = (1 + GAUSS_POINTS) / 2
    inner = nodes[:-1, None] + size[:, None] * share
    values = kernel(np.asarray(points, float)[:, None, None], inner[None]) * GAUSS_WEIGHTS * size[:, None] / 2
    return _hats((values * (1 - share)).sum(axis=2), (values * share).sum(axis=2))


def _hats(left, right):
    """Join the integrals of each element's falling and rising half to those of the hats."""
    return np.pad(left, ((0, 0), (0, 1))) + np.pad(right, ((0, 0), (1, 0)))


def press(half_width, elements, compression, gap):
    """Solve compression(x) of the pressure = approach - gap(x) on |x| <= a, both even in x (elements even).

    Unknown are the pressures at 0 <= x < a and the approach; the equation is met at every node, the end too.
    """
    nodes, middle = nodes_of(half_width, elements), elements // 2
    points = nodes[middle:]
    rows = compression(points, nodes)
    matrix = rows[:, middle:] + rows[:, middle::-1]
    matrix[:, 0] /= 2
    matrix[:, -1] = -1.0
    solved = np.linalg.solve(matrix, -gap(points))
    half = np.append(solved[:-1], 0.0)
    pressure = np.append(half[:0:-1], half)
    return Pressed(nodes, pressure, float(solved[-1]), float(np.trapezoid(pressure, nodes)))


def half_plane(points, nodes, modulus):
    """Return the surface displacement of a half-plane by Flamant, -(2/(pi E1)) int p ln|x - t| dt."""
    return -2 / (math.pi * modulus) * log_weights(points, nodes)


def press_parabola(half_width, radius, modulus, elements):
    """Press the parabola x^2/(2R) into a half-plane of modulus E*; its approach has no datum."""
    return press(half_width, elements, lambda x, t: half_plane(x, t, modulus), lambda x: x**2 / (2 * radius))


def drop_to_depth(pressed, depth, youngs, nu):
    """Return the displacement at the centre less that on the axis at depth D, of Flamant's field.

    A load dP at t moves a point down by dP (1 + nu)/(pi E) [-2 (1 - nu) ln r + z^2/r^2].
    """

    def below(x, t):
        square = (x - t) ** 2 + depth**2
        return -(1 - nu) * np.log(square) + depth**2 / square

    centre = -2 * (1 - nu) * log_weights([0.0], pressed.nodes) - smooth_weights([0.0], pressed.nodes, below)
    return (1 + nu) / (math.pi * youngs) * float((centre @ pressed.pressure)[0])


def disc(points, nodes, modulus, radius):
    """Return the displacement towards its centre of a disc under opposite loads, along the line of centres.

    Loads dP down and up the chord x = t: Flamant's field at both ends and the all-round tension
    dP cos psi/(pi R) that frees the rim (Timoshenko & Goodier, art. 41). With x = R sin phi, t = R sin psi the rim
    moves by (2/(pi E1)) dP {ln[R (1 + cos(phi + psi))/|x - t|] - cos phi cos psi}; a turn, odd in x, is left out.
    """

    def smooth(x, t):
        phi, psi = np.arcsin(x / radius), np.arcsin(t / radius)
        return np.log(radius * (1 + np.cos(phi + psi))) - np.cos(phi) * np.cos(psi)

    return half_plane(points, nodes, modulus) + 2 / (math.pi * modulus) * smooth_weights(points, nodes, smooth)


def disc_centre(pressed, modulus, radius):
    """Return how far the middle of the loaded arc of a disc comes towards the disc's centre."""
    return float((disc([0.0], pressed.nodes, modulus, radius) @ pressed.pressure)[0])


def press_discs(half_width, bodies, elements):
    """Press two discs (E1, R) together, each held by an opposite equal load: approach of the two centres."""

    def compression(points, nodes):
        return sum(disc(points, nodes, modulus, radius) for modulus, radius in bodies)

    def gap(x):
        return sum(x**2 / (radius + np.sqrt(radius**2 - x**2)) for _, radius in bodies)

    return press(half_width, elements, compression, gap)


def squeeze(load, bodies, elements):
    """Press two discs together with a load per length: scale a by the root of the load's ratio until it is met."""
    half_width = min(radius for _, radius in bodies) / 100
    for _ in range(8):
        pressed = press_discs(half_width, bodies, elements)
        half_width *= math.sqrt(load / pressed.load)
    return pressed


def extrapolated(value, elements):
    """Return value(elements) with its 1/n^2 error removed (Richardson)."""
    return (4 * value(2 * elements) - value(elements)) / 3


def series_disc(angles, half_angle, traction, nu, opposed=True, modes=400):
    """Return 2 mu/R times the rim's displacement along the line of centres of a disc, by Michell's series.

    The traction p(psi) per arc acts along that line: sigma_r = -p cos psi, tau = p sin psi, on two opposite arcs or
    on one. Mode n of the stress function is (A r^n + B r^(n+2)) cos(n psi), displacements from Barber's table 9.1.
    """
    psi, forces = _arc(half_angle, traction)
    arcs = 2 if opposed else 1
    kappa, n = 3 - 4 * nu, np.arange(2, modes, arcs)
    normal = -2 * arcs / math.pi * np.cos(np.outer(n, psi)) @ (forces * np.cos(psi))
    shear = 2 * arcs / math.pi * np.sin(np.outer(n, psi)) @ (forces * np.sin(psi))
    outer = (normal + shear) / (2 * (n + 1))
    inner = (shear / n - outer * (n + 1)) / (n - 1)
    radial = np.cos(np.outer(angles, n)) @ (-n * inner + (kappa - n - 1) * outer)
    radial -= (1 - 2 * nu) * arcs / math.pi * (forces @ np.cos(psi))
    around = np.sin(np.outer(angles, n)) @ (n * inner + (kappa + n + 1) * outer)
    return -radial * np.cos(angles) + around * np.sin(angles)


def series_inertia(half_angle, traction, nu):
    """Return 2 mu/R times what mode n = 1 adds midway on one loaded arc, the disc being held by its own inertia.

    The even body force b = sum p/pi gives the plane hydrostatic stress -b y; the shear of the arc adds B r^3 cos psi.
    Counted from the mean displacement of the disc, that is of its centre of mass.
    """
    psi, forces = _arc(half_angle, traction)
    body, outer = 2 / math.pi * forces.sum(), forces @ np.sin(psi) ** 2 / math.pi
    return (1 - 2 * nu) / 2 * body - (2 - 4 * nu) * outer


def _arc(half_angle, traction):
    """Return Gauss points on 0 < psi < half_angle and the forces there."""
    share, weights = np.polynomial.legendre.leggauss(200)
    psi = half_angle * (1 + share) / 2
    return psi, weights * half_angle / 2 * traction(psi)
