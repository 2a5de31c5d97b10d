"""How the waves of a stack were followed: time step, and the layers as it makes them."""

from __future__ import annotations

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.shock_quantities import EXACT_LENGTH, RATIO, STEP
from strikewave.waves.layers import Stack
from strikewave.waves.transit import TimeGrid


@declare.dataclass
class LayerUsed:
    """A layer as asked for and as the time step made it."""

    name: str = declare.word("what the layer is called", label="layer", column=KEY, tables="lengths stress")
    length_asked: float = declare.number(
        EXACT_LENGTH, "its length in the case", label="asked", column=MAIN, tables="lengths"
    )
    length_used: float = declare.number(
        EXACT_LENGTH, "its length by whole steps", label="used", column=MAIN, tables="lengths"
    )
    steps: int = declare.count("steps of its transit", column=MAIN, tables="lengths")


@declare.dataclass
class WaveSetup:
    """How the waves of a stack were followed."""

    step: float = declare.number(STEP, "time step of the waves")
    mismatch: float = declare.number(RATIO, "largest relative error of a transit time by whole steps")
    layers: tuple[LayerUsed, ...] = declare.rows(LayerUsed, "the layers as the time step makes them")


def wave_setup(stack: Stack, grid: TimeGrid) -> WaveSetup:
    """Return how a stack was followed on a grid."""
    rows = zip(stack.layers, grid.lengths(stack), grid.counts, strict=True)
    return WaveSetup(
        grid.step, grid.mismatch, tuple(LayerUsed(layer.name, layer.length, used, n) for layer, used, n in rows)
    )
