"""The struck object as a stack of layers: where it divides into nose and assembly, and how it is stepped."""

from __future__ import annotations

from dataclasses import dataclass

from strikewave.waves.layers import Stack
from strikewave.waves.transit import TimeGrid, choose_grid, grid_of

MISMATCH = 1e-4
LARGEST_STEP, SMALLEST_STEP = 40e-9, 20e-9
"""Wanted mismatch of the transits, and steps to try, s."""


@dataclass(frozen=True)
class LayeredObject:
    """A stack that is struck.

    Parameters
    ----------
    stack : Stack
        Its end is free: spring, damper and stop of the object hold it.
    first_of_assembly : int
        Index of the first layer that belongs to the assembly; the joint before it is the frame.
    grid : TimeGrid
        How it is stepped.
    taps : tuple of (int, float), optional
        Where it is watched: layer, and fraction of it from its struck side.
    """

    stack: Stack
    first_of_assembly: int
    grid: TimeGrid
    taps: tuple[tuple[int, float], ...] = ()

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
