"""How fast a striker arrives: fall, pendulum, Machete hammer, gas gun, and the pulse of a drop table.

One law, one short function; a module a machine. A striker bar needs none of its own:
`strikewave.hopkinson.bars.StrikerBar` gives the strain v/(2c) and the duration 2L/c of the pulse that it makes.
"""

from strikewave.machines.launch.falling import corded_fall, fall_speed
from strikewave.machines.launch.gas_gun import (
    STANDARD_ATMOSPHERE,
    GunBarrel,
    muzzle_speed,
    reservoir_muzzle_speed,
    wave_muzzle_speed,
)
from strikewave.machines.launch.machete import MacheteHammer, machete_energy, machete_speed, rope_tension
from strikewave.machines.launch.pendulum import RigidPendulum, inertia_of_period, pendulum_energy, pendulum_speed
from strikewave.machines.launch.table_pulse import (
    ShapedDrop,
    TablePulse,
    drop_for_half_sine,
    half_sine_pulse,
    linear_shaper,
    shaper_pulse,
)

__all__ = [
    "STANDARD_ATMOSPHERE",
    "GunBarrel",
    "MacheteHammer",
    "RigidPendulum",
    "ShapedDrop",
    "TablePulse",
    "corded_fall",
    "drop_for_half_sine",
    "fall_speed",
    "half_sine_pulse",
    "inertia_of_period",
    "linear_shaper",
    "machete_energy",
    "machete_speed",
    "muzzle_speed",
    "pendulum_energy",
    "pendulum_speed",
    "reservoir_muzzle_speed",
    "rope_tension",
    "shaper_pulse",
    "wave_muzzle_speed",
]
