"""The staircase: how force grows in steps behind and before a layer between two endless neighbours.

A jump of force comes down the first neighbour and enters the layer, which reflects it many times between its
interfaces I (where it enters) and II (where it leaves). With F_I and F_II of `Sandwich`:

    T_1 = 1 + F_I,    T_2 = 1 + F_II,    q = -F_I F_II

T_1 and T_2 are the shares of force that pass the interfaces, q what one round trip leaves; all (-).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.waves.layers import Stack
from strikewave.waves.li_ma import Sandwich, incident_strain, strain
from strikewave.waves.routes import specimen_of

Floats = NDArray[np.float64]


class Staircase(NamedTuple):
    """What interface I and interface II see: shares of the jump that comes in, step by step, or forces, N."""

    first: Floats
    second: Floats


def staircase(sandwich: Sandwich, steps: int) -> Staircase:
    """Return the closed-form steps of force at both interfaces of a bonded layer between endless neighbours.

    With t_0 the transit of the layer, t counted from when the jump reaches interface I, and n = 0, 1, ..:

        f_II(n) = T_1 T_2 sum_{m=0..n} q^m                   from t = (2 n + 1) t_0
        f_I(n)  = T_1 [1 + F_II T_i sum_{m=0..n-1} q^m]      from t = 2 n t_0,    T_i = 1 - F_I

    Both end at 2 Z_2/(Z_1 + Z_2), what passes where the layer is left out. They hold until the first echo from
    beyond the neighbours: `Sandwich.valid_until` later than the first arrival.

    Parameters
    ----------
    sandwich : Sandwich
        The layer and its neighbours.
    steps : int
        How many, at least 1.

    Raises
    ------
    ValueError
        If no step is asked for.

    Notes
    -----
    The geometric series of repeated reflections in a bar of finite length: Kolsky, Stress Waves in Solids
    (1963), ch. 2; with the coefficients of Li & Ma 2019, eqs (29)-(33).

    Examples
    --------
    >>> from strikewave.base.materials import material
    >>> from strikewave.waves.layers import round_bar
    >>> steel, alloy = (round_bar(name, material(name), 0.05, 0.03) for name in ("65Mn", "2A12"))
    >>> print(staircase(Sandwich(steel, alloy, steel), 4).second.round(3))
    [0.766 0.945 0.987 0.997]
    """
    if steps < 1:
        raise ValueError(f"at least one step is needed, got {steps!r}")
    first, second = sandwich.first_reflection, sandwich.second_reflection
    powers = (-first * second) ** np.arange(steps)
    sums = np.cumsum(powers)
    before = np.concatenate([[0.0], sums[:-1]])
    entered = 1.0 + first
    return Staircase(entered * (1.0 + second * (1.0 - first) * before), entered * (1.0 + second) * sums)


def endless_force(stack: Stack, layer: int, times: Floats, load_times: Floats, load: Floats) -> Staircase:
    """Return the force at both interfaces under any load, N, as if joints were bonded and neighbours endless.

    The steps of `staircase`, each with the history of the load: the corrected route of Li & Ma 2019 at x = 0 and
    x = l. What comes down is the load times 2 Z_b/(Z_a + Z_b) for each joint a|b above the first neighbour. Up to
    `first_echoes` this is what a bonded stack does.

    Parameters
    ----------
    layer : int
        Index of the layer, between two others.
    times : ndarray
        When, s from the start of the load.
    load_times, load : ndarray
        Force on the first face, s and N; at least two samples.

    Raises
    ------
    ValueError
        If the layer has one neighbour only.
    """
    sandwich = specimen_of(stack, layer)
    if sandwich is None:
        raise ValueError(f"a staircase needs a layer between two others; layer {layer} has one neighbour")
    above = stack.layers[:layer]
    passed = math.prod(2.0 * b.impedance / (a.impedance + b.impedance) for a, b in pairwise(above))
    incident = incident_strain(load_times, passed * np.asarray(load), sandwich.upper)
    since = times - sum(part.transit for part in above)
    first = strain(sandwich, incident, 0.0, since, "corrected")
    second = strain(sandwich, incident, 1.0, since - sandwich.transit, "corrected")
    stiffness = sandwich.specimen.modulus * sandwich.specimen.area
    return Staircase(stiffness * first, stiffness * second)


def first_echoes(stack: Stack, layer: int) -> tuple[float, float]:
    """Return when interface I and II hear the first echo from beyond the neighbours, s after the front reaches I.

    From above the earliest comes 2 min t_k behind the front, over the transits t_k of the layers above. From below it
    has gone through the lower neighbour and back, and for interface I once more through the layer itself; a matched
    end behind the neighbour sends none.

    Examples
    --------
    >>> from strikewave.waves.layers import BONDED, Layer
    >>> bars = [Layer("bar", 1.0, 1.0, 1.0, length) for length in (3.0, 1.0, 2.5)]
    >>> first_echoes(Stack(tuple(bars), (BONDED, BONDED)), 1)
    (6.0, 6.0)
    """
    transits = [part.transit for part in stack.layers]
    ends_here = layer + 2 == len(transits) and stack.end.kind == "matched"
    above, below = 2.0 * min(transits[:layer]), math.inf if ends_here else 2.0 * transits[layer + 1]
    return min(above, 2.0 * transits[layer] + below), transits[layer] + min(above, below)
