"""The struck object: bodies on a carriage with spring, damper and stop, or a stack of layers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from strikewave.contact.chain import Friction, Link, Spring, Stop
from strikewave.contact.damping import cut_off_damping_ratio
from strikewave.waves.layers import Stack
from strikewave.waves.transit import TimeGrid, choose_grid, grid_of

NOSE, ASSEMBLY, CARRIAGE = "nose", "assembly", "carriage"
FAR = 1e6  # out of reach
"""Place of the stop of an object without one, m."""


@dataclass(frozen=True)
class StruckObject:
    """A nose that is struck, a frame that bends, and the assembly that carries the sensor.

    A rigid object struck by the contact law alone would answer with a pulse several times shorter and
    higher than any measured one; the frame's stiffness in series sets the pulse.
    """

    nose_mass: float
    """kg."""
    assembly_mass: float
    """kg."""
    frame_stiffness: float
    """N/m."""
    frame_damping: float
    """N s/m."""
    spring: float
    """Heavy-load spring between assembly and carriage, N/m."""
    preload: float
    """N."""
    damper: float
    """N s/m."""
    stop_stiffness: float
    """Stop that the spring holds the assembly against, N/m."""
    stop_restitution: float
    """Coefficient of restitution of the whole object on the stop, 0.01 to 1."""
    gravity: float
    """Gravity along the blow, m/s^2."""
    friction: float = 0.0
    """Coulomb friction of the rail between assembly and carriage while it slides, N."""
    stiction: float | None = None
    """Largest friction while it sticks, N; as while it slides where left out."""
    falls: bool = False
    """True if it falls freely before the blow; its sensor then takes its zero in the fall."""

    @property
    def sensed_gravity(self) -> float:
        """Gravity in the rigid acceleration, m/s^2: none of an object that falls, whose sensor reads nothing then.

        A sensor's zero is what it reads before the blow. At rest something bears the object, and without that its
        acceleration is that of gravity; a sensor zeroed in the fall reads the forces on the object alone.
        """
        return 0.0 if self.falls else self.gravity

    @property
    def rail(self) -> Friction:
        """Friction between assembly and carriage."""
        return Friction(ASSEMBLY, CARRIAGE, self.friction, self.stiction)

    @property
    def rubs(self) -> bool:
        """True if the rail has friction."""
        return self.rail.holds > 0.0

    @property
    def mass(self) -> float:
        """Mass of everything that moves when struck, kg."""
        return self.nose_mass + self.assembly_mass

    @property
    def frame_frequency(self) -> float:
        """Frequency at which nose and assembly swing on the frame, free and undamped, Hz."""
        modal_mass = self.nose_mass * self.assembly_mass / self.mass
        return math.sqrt(self.frame_stiffness / modal_mass) / (2.0 * math.pi)

    @cached_property
    def stop_damping(self) -> float:
        """Damping of the stop that gives its restitution, N s/m."""
        ratio = float(cut_off_damping_ratio(self.stop_restitution))
        return 2.0 * ratio * (self.stop_stiffness * self.mass) ** 0.5

    @property
    def stop_compression(self) -> float:
        """Compression of the stop at rest, m: preload less weight over stiffness; none without a stop."""
        if self.stop_stiffness == 0.0:
            return 0.0
        return (self.preload - self.mass * self.gravity) / self.stop_stiffness

    def links(self, rest: float) -> list[Link]:
        """Return frame, support spring and stop for an assembly that rests at ``rest`` on a carriage at 0, m."""
        stands = -rest - self.stop_compression if self.stop_stiffness else FAR
        without_rail: list[Link] = [
            Spring(NOSE, ASSEMBLY, self.frame_stiffness, self.frame_damping),
            Spring(ASSEMBLY, CARRIAGE, self.spring, self.damper, self.preload, offset=rest),
            Stop(CARRIAGE, ASSEMBLY, self.stop_stiffness, self.stop_damping, offset=stands),
        ]
        return [*without_rail, self.rail] if self.rubs else without_rail


MISMATCH = 1e-4
LARGEST_STEP, SMALLEST_STEP = 40e-9, 20e-9  # chosen: 1 ms of a blow takes 25 000 to 50 000 of them
"""Wanted mismatch of the transits, below the error of any dimension, and steps to try, s."""


@dataclass(frozen=True)
class LayeredObject:
    """A stack that is struck."""

    stack: Stack
    """Layers; the end is free: spring, damper and stop of the object hold it."""
    first_of_assembly: int
    """Index of the first layer that belongs to the assembly; the joint before it is the frame."""
    grid: TimeGrid
    """Scheme of its steps."""
    taps: tuple[tuple[int, float], ...] = ()
    """Layer, and fraction of it from its struck side, of each place that is watched."""

    @property
    def nose_mass(self) -> float:
        """Mass of layers and point masses before the frame, kg."""
        k = self.first_of_assembly
        return sum(x.mass for x in self.stack.layers[:k]) + sum(x.mass for x in self.stack.joints[: k - 1])

    @property
    def assembly_mass(self) -> float:
        """Mass of what follows the frame, kg."""
        k = self.first_of_assembly
        return sum(x.mass for x in self.stack.layers[k:]) + sum(x.mass for x in self.stack.joints[k:])

    @property
    def frame_damping(self) -> float:
        """Damping of the frame's joint, N s/m."""
        return self.stack.joints[self.first_of_assembly - 1].damping

    @property
    def frame_stiffness(self) -> float:
        """Stiffness between the means of the two parts, N/m: the frame's joint and the bars beside it in series.

        In a part of mass m that the frame pushes, the force falls with the mass q that it has passed,
        f = F (1 - q/m); compliances are mean displacements over F.
        """
        k, layers, joints = self.first_of_assembly, self.stack.layers, self.stack.joints
        before = [(layers[i], joints[i - 1] if i else None) for i in range(k - 1, -1, -1)]
        behind = [(layers[i], joints[i] if i < len(joints) else None) for i in range(k, len(layers))]
        compliance = 1.0 / joints[k - 1].stiffness
        for part, mass in ((before, self.nose_mass), (behind, self.assembly_mass)):
            passed = shortened = 0.0
            for layer, joint in part:
                share, left = layer.mass / mass, 1.0 - passed / mass
                bend = layer.length / (layer.modulus * layer.area)
                compliance += share * (shortened + bend * (left / 2.0 - share / 6.0))
                shortened += bend * (left - share / 2.0)
                passed += layer.mass
                if joint is not None:
                    compliance += joint.mass / mass * shortened
                    passed += joint.mass
                    shortened += (1.0 - passed / mass) / joint.stiffness
        return 1.0 / compliance


def machine_grid(stack: Stack, step: float | None = None) -> TimeGrid:
    """Return the grid on which a stack is struck: the step asked for, or one that suits all transits."""
    return grid_of(stack, step) if step else choose_grid(stack, MISMATCH, LARGEST_STEP, SMALLEST_STEP)
