"""The stacked velocity amplifier: bodies in a line that hit one another in pairs, each faster than the one before.

Positions and speeds are positive upwards, along the blow. Bodies are numbered from the bottom, in words from 1. A body
of infinite mass is a floor, a ceiling or a striker that nothing slows. `collide` finds every collision in its order,
secondary ones included; `collide_softly` follows the same line with contacts that take time: where two contacts of a
body overlap, pairs no longer tell how fast the last body goes.
"""

from strikewave.machines.amplifier.collisions import Collision, Collisions, collide
from strikewave.machines.amplifier.line import BodyLine
from strikewave.machines.amplifier.soft_collisions import SoftCollisions, collide_softly
from strikewave.machines.amplifier.speeds import (
    chain_speed,
    fastest_masses,
    gain_limit,
    gain_limit_of,
    next_speed,
    resting_ratio,
)

__all__ = [
    "BodyLine",
    "Collision",
    "Collisions",
    "SoftCollisions",
    "chain_speed",
    "collide",
    "collide_softly",
    "fastest_masses",
    "gain_limit",
    "gain_limit_of",
    "next_speed",
    "resting_ratio",
]
