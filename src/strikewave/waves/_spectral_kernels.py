"""Compiled reflection recursion: force waves through layers, joints and an end, one complex frequency after another.

With s = sigma + i w, exp(-g x) the travel along a layer and Z = rho A s/g its impedance, all exponentials fall. From
the end towards the load, the wave that comes back is R times the one that goes, at the far face of each layer; top
over bottom is the impedance that a face looks into.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel
from strikewave.waves._kernels import FORCE, SPEED

MATCHED, RIGID, MASS, SPRING, DASHPOT, OSCILLATOR = range(1, 7)
"""Kinds of the end by their places in `strikewave.waves.layers.END_KINDS`; 0 is a free end, whose impedance is 0."""
STIFFNESS, DAMPING, POINT, ATTACHED = 0, 1, 2, 3
"""Columns of `SpectralTables.joint`; an infinite stiffness is a bonded joint."""
END_KIND, END_VALUE, END_STIFFNESS, END_DAMPING = 0, 1, 2, 3
"""Places in `SpectralTables.end`."""


class SpectralTables(NamedTuple):
    """A stack as its spectrum needs it; ``group`` tells which row of travel constants is a layer's."""

    length: np.ndarray
    line_mass: np.ndarray
    group: np.ndarray
    joint: np.ndarray
    branch: np.ndarray
    end: np.ndarray


class StackPlaces(NamedTuple):
    """Places in a stack, in the order of its layers: layer, and distance from its loaded face (m)."""

    layer: np.ndarray
    distance: np.ndarray


@leaf_kernel
def hung_impedance(s, mass, stiffness, damping):
    """Return the impedance of a mass on a spring with dashpot, 1/(1/(m s) + 1/(k/s + c))."""
    arm = stiffness / s + damping
    return mass * s * arm / (mass * s + arm)


@leaf_kernel
def mobility(tables, i, s):
    """Return the speed per force, x'/f, of a joint that gives way."""
    row = tables.joint[i]
    if row[STIFFNESS] == np.inf or row[ATTACHED] > 0.0:
        return 0.0j
    total = row[STIFFNESS] + row[DAMPING] * s
    for j in range(tables.branch.shape[1]):
        k, tau = tables.branch[i, j, 0], tables.branch[i, j, 1]
        if k > 0.0:
            total += k * s * tau / (1.0 + s * tau)
    return s / total


@leaf_kernel
def carried(tables, i, s):
    """Return the impedance of what a joint carries."""
    row = tables.joint[i]
    if row[ATTACHED] > 0.0:
        return hung_impedance(s, row[ATTACHED], row[STIFFNESS], row[DAMPING])
    return row[POINT] * s


@leaf_kernel
def end_reflection(tables, s, z):
    """Return M/P at the end of the last layer."""
    end = tables.end
    kind, value = end[END_KIND], end[END_VALUE]
    if kind == MATCHED:
        return 0.0j
    if kind == RIGID:
        return 1.0 + 0.0j
    support = 0.0j
    if kind == MASS:
        support = value * s
    elif kind == SPRING:
        support = value / s
    elif kind == DASHPOT:
        support = value + 0.0j
    elif kind == OSCILLATOR:
        support = hung_impedance(s, value, end[END_STIFFNESS], end[END_DAMPING])
    return (support - z) / (support + z)


@kernel
def respond(tables, s, travel, speed, load, by, places):
    """Return the spectra of force and velocity at places, those of first face and end, and of the momentum.

    Parameters
    ----------
    tables : SpectralTables
        The stack.
    s : ndarray
        Complex frequencies, 1/s, shape (n,).
    travel : ndarray
        Travel constants g, 1/m, shape (groups, n).
    speed : ndarray
        s/g, m/s, shape (groups, n).
    load : ndarray
        Spectrum of what is prescribed, shape (n,).
    by : int
        `FORCE`, `SPEED` or `INCIDENT`.
    places : StackPlaces
        Places of the evaluation, sorted by layer.
    """
    layers, count = tables.length.size, places.layer.size
    force, velocity = np.empty((count, s.size), np.complex128), np.empty((count, s.size), np.complex128)
    ends, momentum = np.empty((3, s.size), np.complex128), np.empty(s.size, np.complex128)
    scratch = np.empty((3, layers), np.complex128)
    back, gone, impedance = scratch[0], scratch[1], scratch[2]
    for n in range(s.size):
        last = layers - 1
        for i in range(last, -1, -1):  # from the end to the load, so that all exponentials fall
            g = travel[tables.group[i], n]
            impedance[i] = tables.line_mass[i] * speed[tables.group[i], n]
            gone[i] = np.exp(-g * tables.length[i])
            if i == last:
                back[i] = end_reflection(tables, s[n], impedance[i])
                continue
            r = back[i + 1] * gone[i + 1] * gone[i + 1]
            top, bottom = impedance[i + 1] * (1.0 + r), 1.0 - r
            top += carried(tables, i, s[n]) * bottom
            bottom += mobility(tables, i, s[n]) * top
            back[i] = (top - impedance[i] * bottom) / (top + impedance[i] * bottom)
        r = back[0] * gone[0] * gone[0]
        wave = load[n]
        if by == FORCE:
            wave /= 1.0 + r
        elif by == SPEED:
            wave *= impedance[0] / (1.0 - r)
        ends[0, n] = wave * (1.0 + r)
        k, total = 0, 0.0j
        for i in range(layers):
            g = travel[tables.group[i], n]
            while k < count and places.layer[k] == i:
                ahead = np.exp(-g * places.distance[k])
                behind = back[i] * gone[i] * np.exp(-g * (tables.length[i] - places.distance[k]))
                force[k, n] = wave * (ahead + behind)
                velocity[k, n] = wave * (ahead - behind) / impedance[i]
                k += 1
            total += wave * (1.0 - gone[i]) * (1.0 - back[i] * gone[i])
            wave *= gone[i]
            f = wave * (1.0 + back[i])
            if i == last:
                ends[1, n], ends[2, n] = f, wave * (1.0 - back[i]) / impedance[i]
                break
            r = back[i + 1] * gone[i + 1] * gone[i + 1]
            top = impedance[i + 1] * (1.0 + r)
            own = carried(tables, i, s[n]) * (1.0 - r)
            if own != 0.0:
                total += f * own / (top + own)
            if r.real > 0.0:  # by force or by speed: of 1 + r and 1 - r the one that cannot vanish divides
                wave = f * impedance[i + 1] / (top + own)
            else:
                v = wave * (1.0 - back[i]) / impedance[i] - mobility(tables, i, s[n]) * f
                wave = v * impedance[i + 1] / (1.0 - r)
        momentum[n] = total / s[n]
    return force, velocity, ends, momentum
