"""How the waves of a stack were followed: time step, and the layers as it makes them."""

from __future__ import annotations

from dataclasses import dataclass

from strikewave.waves import Stack, TimeGrid


@dataclass(frozen=True)
class LayerUsed:
    """A layer as asked for and as the time step made it, m and steps."""

    name: str
    length_asked: float
    length_used: float
    steps: int


@dataclass(frozen=True)
class WaveSetup:
    """How the waves of a stack were followed: time step (s), largest mismatch of a transit, layers as used."""

    step: float
    mismatch: float
    layers: tuple[LayerUsed, ...]


def wave_setup(stack: Stack, grid: TimeGrid) -> WaveSetup:
    """Return how a stack was followed on a grid."""
    rows = zip(stack.layers, grid.lengths(stack), grid.counts, strict=True)
    return WaveSetup(
        grid.step, grid.mismatch, tuple(LayerUsed(layer.name, layer.length, used, n) for layer, used, n in rows)
    )
