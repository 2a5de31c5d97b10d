"""What the paper's route says of a tap in a stack, beside the exact solution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.waves.layers import Stack
from strikewave.waves.li_ma import Sandwich, acceleration, incident_strain, strain, too_many, velocity

Array = NDArray[np.float64]

EXACT = "exact"
"""The finite stack itself, as the delay lines solve it."""


class RouteHistory(NamedTuple):
    """Force (N), velocity (m/s) and acceleration (m/s^2) of the stress wave at a tap by one route."""

    force: Array
    velocity: Array
    acceleration: Array


def specimen_of(stack: Stack, layer: int) -> Sandwich | None:
    """Return a layer between its neighbours; None for the first and the last one, which have but one."""
    if not 0 < layer < len(stack.layers) - 1:
        return None
    return Sandwich(*stack.layers[layer - 1 : layer + 2])


def too_thin(stack: Stack, times: Array) -> list[str]:
    """Return the layers that no route follows to these times: their waves would be too many."""
    specimens = (specimen_of(stack, layer) for layer in range(len(stack.layers)))
    return [one.specimen.name for one in specimens if one is not None and too_many(one, times)]


def route_history(
    stack: Stack, layer: int, position: float, times: Array, face_force: Array, route: str
) -> RouteHistory:
    """Return what a route of Li & Ma 2019 says of a tap, driven by the force on the first face of the stack.

    The force is taken to travel forward unchanged to the specimen, whose neighbours count as endless fixtures;
    everything else in the stack, and every echo from beyond the neighbours, is left out, as in the paper.

    Parameters
    ----------
    layer, position : int and float
        The tap: index of its layer, the specimen, and fraction from its loaded side.
    times, face_force : ndarray
        Times from the start of the load, s, and the force on the first face, N.
    route : str
        "as printed" or "corrected".

    Raises
    ------
    ValueError
        If the layer has no neighbour on one side, or the route is unknown.
    """
    sandwich = specimen_of(stack, layer)
    if sandwich is None:
        raise ValueError(f"the route {route!r} needs a specimen between two fixtures; layer {layer} has one neighbour")
    specimen = stack.layers[layer]
    arrival = sum(x.transit for x in stack.layers[:layer]) + position * specimen.transit
    incident = incident_strain(times, face_force, sandwich.upper)
    since = times - arrival
    return RouteHistory(
        specimen.modulus * specimen.area * strain(sandwich, incident, position, since, route),
        velocity(sandwich, incident, position, since, route),
        acceleration(sandwich, incident, position, since, route),
    )
