"""What an explicit run gives: histories at equal intervals, the energy balance, the last state; SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import ENERGY, LENGTH
from strikewave.fem.contact import Overlap
from strikewave.fem.mesh import TINY

Array = NDArray[np.float64]

ENERGIES = ("kinetic", "internal", "plastic", "hourglass", "contact", "viscous", "external")
"""Columns of the energy balance; ``internal`` is elastic energy and plastic work, ``plastic`` the plastic work in
it."""
KEPT = ("kinetic", "internal", "hourglass", "contact", "viscous")
"""Those that together are what was there at the start and what came from outside."""


AT_REST = 1e-8
"""Speed below which bodies are at rest, m/s: what a strain of 1e-12 makes where waves run at 5 km/s, and coordinates
that are rounded by 1e-16 of a model strain an element of a thousandth of its size by 1e-13."""


def energy_at_rest(mass: float) -> float:
    """Return the energy of a mass, kg, at the speed `AT_REST`, J: less is rounding.

    Examples
    --------
    >>> round(energy_at_rest(2.0), 20)
    1e-16
    """
    return 0.5 * mass * AT_REST**2


@dataclass(frozen=True)
class PartHistory:
    """Motion of a part at the instants of the run, each (instants, 3).

    Attributes
    ----------
    mass : float
        kg.
    velocity : array
        Momentum over mass, m/s.
    acceleration : array
        Rate of momentum over mass (the rigid-body acceleration), m/s^2, average about each instant: its integral by
        the trapezoidal rule is the change of velocity.
    displacement : array
        Mean displacement by mass, m.
    """

    mass: float
    velocity: Array
    acceleration: Array
    displacement: Array


@dataclass(frozen=True)
class PointHistory:
    """Motion of a node, each (instants, 3); acceleration is the average about each instant."""

    node: int
    displacement: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class SectionHistory:
    """Means over the elements of a section, by volume: stress (instants, 6: xx yy zz xy yz zx) and motion."""

    elements: int
    stress: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class FieldFrame:
    """The whole field at an instant.

    Attributes
    ----------
    time : float
        s.
    displacement, velocity : array (nodes, 3)
        m, m/s.
    stress : array (elements, 6)
        Cauchy stress, Pa: xx yy zz xy yz zx, tension positive.
    plastic_strain : array (elements,)
        Equivalent plastic strain.
    """

    time: float
    displacement: Array
    velocity: Array
    stress: Array
    plastic_strain: Array


@declare.dataclass
class Rest:
    """How bodies came to rest between the blow before and this one."""

    maxima: int = declare.count(
        "maxima of the kinetic energy at which velocities were set to zero, of all bodies",
        label="kinetic-energy maxima of relaxation",
        column=MORE,
    )
    steps: int = declare.count("steps on the way to rest", label="steps of relaxation", column=MORE)
    kinetic_share: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, digits=3),
        "kinetic energy that was left, over the energy in play of the blow before",
        label="kinetic energy left (share)",
        column=MORE,
    )
    plastic_energy: float = declare.number(
        ENERGY, "plastic work that the way to rest itself did", label="yield during relaxation", column=MORE
    )
    added_distance: float = declare.number(
        Quantity("m", "um", digits=3),
        "by how much what strikes begins farther away than at first, as it would have stood inside what it strikes",
        label="moved back at the start",
        column=MORE,
    )
    overlap: float = declare.number(LENGTH, "deepest overlap that is let out without a force")
    plastic_before: float = declare.number(ENERGY, "plastic work of everything before this blow")


@dataclass(frozen=True)
class FemRun:
    """Histories of a run; row i of each is at ``time[i]``.

    Attributes
    ----------
    time : array (instants,)
        s, equal steps from 0; where a run stopped early the last may be shorter.
    force : mapping of str to array (instants, 3)
        Contact force on the first surface, N, by name of the contact or wall.
    impulse : mapping of str to array (instants, 3)
        Its integral over time, N s.
    energy : mapping of str to array (instants,)
        J, by the words of `ENERGIES`.
    initial_energy : float
        At the start, J.
    parts : mapping of str to PartHistory
        Motion of each part as one body.
    points : mapping of str to PointHistory
        Motion of each point.
    sections : mapping of str to SectionHistory
        Stress and motion of each section.
    momentum : array (instants, 3)
        Of everything, kg m/s.
    impulse_given : array (instants, 3)
        What boundaries, walls and gravity gave, N s.
    steps : int
        How many time steps.
    step : float
        Smallest time step, s.
    added_mass : float
        kg, by mass scaling on request.
    seconds : float
        Wall time.
    elements : int
        How many.
    stopped : str
        Why the run ended early; empty when it did not.
    frames : tuple of FieldFrame
        Only those asked for; a writer takes them as they come instead where one is given.
    von_mises : mapping of str to array (instants,)
        Largest von Mises stress of the elements of each part that deforms, Pa.
    plastic_strain : mapping of str to array (instants,)
        Largest equivalent plastic strain of the same.
    overlaps : tuple of Overlap
        Where contacts and walls overlapped before the blow.
    groups : mapping of str to PartHistory
        Motion of groups of parts, each as one body.
    pressed : mapping of str to array (instants, surfaces, 2)
        Of both surfaces of a contact, of the one of a wall: the share that is pressed, and how many faces that is.
    blow : int
        Which blow of the bodies this is, from 1.
    rest : Rest or None
        How they came to rest before it; None before the first.
    plastic_work : mapping of str to float
        Of each part that deforms, in this run, J.
    bodies : tuple of tuple of str
        Parts that ties or common nodes join.
    """

    time: Array
    force: Mapping[str, Array]
    impulse: Mapping[str, Array]
    energy: Mapping[str, Array]
    initial_energy: float
    parts: Mapping[str, PartHistory]
    points: Mapping[str, PointHistory]
    sections: Mapping[str, SectionHistory]
    momentum: Array
    impulse_given: Array
    steps: int
    step: float
    added_mass: float
    seconds: float
    elements: int
    stopped: str = ""
    frames: tuple[FieldFrame, ...] = field(default=())
    von_mises: Mapping[str, Array] = field(default_factory=dict)
    plastic_strain: Mapping[str, Array] = field(default_factory=dict)
    overlaps: tuple[Overlap, ...] = ()
    groups: Mapping[str, PartHistory] = field(default_factory=dict)
    pressed: Mapping[str, Array] = field(default_factory=dict)
    blow: int = 1
    rest: Rest | None = None
    plastic_work: Mapping[str, float] = field(default_factory=dict)
    bodies: tuple[tuple[str, ...], ...] = ()

    @property
    def energy_error(self) -> Array:
        """Energy that is missing (negative) or too much, as a share of the largest energy in play, (instants,)."""
        accounted = sum(self.energy[name] for name in KEPT)
        return np.asarray((accounted - self._given) / self._in_play)

    @property
    def contact_gain(self) -> float:
        """Most energy that contacts and walls made in place of taking it, as a share of the largest energy in play."""
        return max(0.0, float((-self.energy["contact"] / self._in_play).max()))

    @property
    def _given(self) -> Array:
        return np.asarray(self.initial_energy + self.energy["external"])

    @property
    def _in_play(self) -> Array:
        return np.asarray(np.maximum(np.maximum.accumulate(np.abs(self._given)), max(self.rounding_energy, TINY)))

    @property
    def rounding_energy(self) -> float:
        """Energy below which nothing moves, J; see `energy_at_rest`."""
        return energy_at_rest(sum(part.mass for part in self.parts.values()))

    @property
    def energy_in_play(self) -> float:
        """Energy that was there at the start and came from outside, the largest, J."""
        return float(self._in_play[-1])

    @property
    def momentum_error(self) -> float:
        """Largest difference of momentum and what was given, over the largest momentum in play."""
        off = self.momentum - self.momentum[0] - self.impulse_given
        carried = sum((part.mass * np.abs(part.velocity) for part in self.parts.values()), np.zeros_like(off))
        return float(np.abs(off).max() / max(float(carried.max()), TINY))

    @property
    def speed(self) -> float:
        """Element-steps a second."""
        return self.elements * self.steps / self.seconds
