"""Vibration of bodies taken away by kinetic relaxation, until they are in static equilibrium; SI.

Bodies without outer loads vibrate about their state of rest. Whenever the kinetic energy of a body passes a maximum,
where it is nearest to equilibrium, its velocities are set to zero; what is left is a smaller vibration, and so on
(dynamic relaxation with kinetic damping). It takes no coefficient of damping, and changes nothing in the bodies but
what the vibration itself would.

A small maximum may be that of a fast vibration, while a slow one has only begun. A body rests when its kinetic energy
stays below the wanted one, with nothing set to zero, as long as the longest rise to a maximum before; and as long as a
wave takes there and back.

Sources: P. A. Cundall 1976, Explicit finite-difference methods in geomechanics, Numerical Methods in Engineering,
Proc. EF Conference, Blacksburg, 132-150; M. R. Barnes 1999, International Journal of Space Structures 14, 89-104.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.bodies import Body
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import Array

MOST_MAXIMA = 300
"""Maxima of a body after which it is taken as it is: each takes a share of the vibration, and bodies that come to rest
at all have done so after some tens."""


class Settled(NamedTuple):
    """How bodies came to rest: maxima of all bodies, steps, largest kinetic energy that was left, J."""

    maxima: int
    steps: int
    kinetic: float


class _Watch:
    """Kinetic energies of bodies from step to step: where each passes a maximum, and since when it is small."""

    def __init__(self, engine: Engine, bodies: Sequence[Body], wanted: float) -> None:
        self.wanted = wanted / len(bodies)
        self.owner = np.zeros(len(engine.x), np.int64)
        for number, body in enumerate(bodies):
            self.owner[body.nodes] = number
        self.energy, self.left = np.zeros(len(bodies)), np.zeros(len(bodies))
        self.maxima, self.rise, self.small = np.zeros((3, len(bodies)), np.int64)
        self.longest = np.array([_crossing_steps(engine, body) for body in bodies])

    def passed(self, now: Array) -> NDArray[np.bool_]:
        """Take the energies after a step, J; tell which bodies are at a maximum that is not small."""
        large = now > self.wanted
        passed = large & (now < self.energy)
        self.maxima += passed
        self.rise += 1
        self.longest = np.where(passed, np.maximum(self.longest, self.rise), self.longest)
        self.rise[passed] = 0
        self.small = np.where(large, 0, self.small + 1)
        self.left = np.where(self.small > 1, np.maximum(self.left, now), now)
        self.energy = np.where(passed, 0.0, now)
        return passed

    @property
    def over(self) -> bool:
        """Whether every body rests, or has passed as many maxima as it may."""
        return bool(np.all((self.small > self.longest) | (self.maxima >= MOST_MAXIMA)))


def settle(engine: Engine, bodies: Sequence[Body], wanted: float, most: int) -> Settled:
    """Bring bodies that begin without velocity to rest.

    Parameters
    ----------
    engine : Engine
        Of a model without velocities and loads; `Engine.initialize` has been called.
    bodies : sequence of Body
    wanted : float
        Kinetic energy to which they come to rest, J.
    most : int
        Steps after which they are taken as they are.
    """
    watch, rigid = _Watch(engine, bodies, wanted), [body.nodes for body in engine.bodies]
    first = engine.steps
    while not watch.over and engine.steps - first < most and engine.goes_on:
        engine.dt_next = min(engine.dt_next, engine.model.controls.safety * engine.critical)
        engine.assemble_forces()
        engine.step()
        square = np.einsum("n,ni,ni->n", engine.own_mass, engine.v, engine.v)
        passed = watch.passed(np.asarray(0.5 * np.bincount(watch.owner, square, len(bodies)), float))
        if passed.any():
            engine.v[passed[watch.owner]] = 0.0
            for body, nodes in zip(engine.bodies, rigid, strict=True):
                if passed[watch.owner[nodes[0]]]:
                    body.velocity, body.spin = np.zeros(3), np.zeros(3)
    engine.v.fill(0.0)
    return Settled(int(watch.maxima.sum()), engine.steps - first, float(watch.left.sum()))


def _crossing_steps(engine: Engine, body: Body) -> int:
    """Return the steps that a wave takes through a body and back."""
    places = engine.model.mesh.points[body.nodes]
    slowest = min(engine.model.solids[part].wave_speed for part in body.parts)
    reach = 2.0 * float(np.linalg.norm(np.ptp(places, axis=0)))
    return int(np.ceil(reach / (slowest * engine.dt_next)))
