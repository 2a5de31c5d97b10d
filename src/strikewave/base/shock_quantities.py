"""The quantities that several results have: unit, unit shown as a rule, label, decimals, each said once."""

from __future__ import annotations

from strikewave.base.declare import NO_UNIT, Quantity

ACCELERATION = Quantity("m/s^2", "g", decimals=0)
RIGID_PEAK = Quantity("m/s^2", "g", decimals=1)
TOTAL_PEAK = Quantity("m/s^2", "g", digits=5)
PULSE_WIDTH = Quantity("s", "us", "pulse width at 10 %", 1)
SPEED = Quantity("m/s", "m/s", decimals=3, digits=0)
VELOCITY_CHANGE = Quantity("m/s", "m/s", decimals=3, digits=3)
RISE_TIME = Quantity("s", "us", "rise time 10-90 %", 1)
PEAK_FORCE = Quantity("N", "kN", decimals=2, digits=3)
RESTITUTION = Quantity(NO_UNIT, NO_UNIT, "coefficient of restitution", 4, 0)
VELOCITY = Quantity("m/s", "m/s", decimals=3)
FORCE = Quantity("N", "kN", decimals=3)
STRESS = Quantity("Pa", "MPa", decimals=2)
IMPULSE = Quantity("N s", "N s", decimals=3, digits=0)
MEASURED_IMPULSE = Quantity("N s", "N s")
ENERGY = Quantity("J", "J")
MICROSECONDS = Quantity("s", "us")
STEP = Quantity("s", "ns")
LENGTH = Quantity("m", "mm")
EXACT_LENGTH = Quantity("m", "mm", digits=7)
CONTACT_TIME = Quantity("s", "us", decimals=1, digits=0)
INDENTATION = Quantity("m", "um", decimals=2, digits=0)
MASS = Quantity("kg", "gram")
KILOGRAMS = Quantity("kg", "kg")
FREQUENCY = Quantity("Hz", "Hz")
KILOHERTZ = Quantity("Hz", "kHz")
BANDWIDTH = Quantity("Hz", "kHz", digits=3)
RATIO = Quantity(NO_UNIT, NO_UNIT)
VARIATION = Quantity(NO_UNIT, "%", digits=3)
"""Quantity of a coefficient of variation: its bounds are wider than three digits."""
SHARE = Quantity(NO_UNIT, "%", decimals=2, digits=0)
MICROSTRAIN = Quantity(NO_UNIT, "ustrain", digits=3)
DENSITY = Quantity("kg/m^3", "kg/m^3", digits=5)
MODULUS = Quantity("Pa", "GPa", digits=5)
BAR_SPEED = Quantity("m/s", "m/s", digits=6)
SECONDS = Quantity("s", "s")
MILLISECONDS = Quantity("s", "ms")
OF_CHANNEL = Quantity.of_data("each channel's unit")
OF_INTEGRAL = Quantity.of_data("each channel's unit, times s")
SCORE = Quantity(NO_UNIT, NO_UNIT, decimals=3, digits=0)
OF_FIGURE = Quantity.of_data("as the figure")
OF_PUBLISHED = Quantity.of_data("that of its quantity")
PUBLISHED_QUANTITIES = {
    "first.rigid_peak": RIGID_PEAK,
    "first.total_peak": TOTAL_PEAK,
    "first.wave_peak": TOTAL_PEAK,
    "first.sensor_peak": ACCELERATION,
    "first.sensor_width": PULSE_WIDTH,
    "first.width": PULSE_WIDTH,
    "first.peak_force": PEAK_FORCE,
    "first.contact_time": CONTACT_TIME,
    "first.approach_speed": SPEED,
    "first.rebound_speed": SPEED,
    "first.restitution": RESTITUTION,
    "first.indentation": INDENTATION,
    "first.residual_indentation": INDENTATION,
    "first.velocity_change": VELOCITY_CHANGE,
    "first.blow_velocity_change": VELOCITY_CHANGE,
    "first.force_width": PULSE_WIDTH,
    "first.force_over_mass": RIGID_PEAK,
    "typical.rigid_peak": RIGID_PEAK,
    "typical.width": PULSE_WIDTH,
    "count": RATIO._replace(label="blows that struck"),
    "window": MILLISECONDS._replace(label="from the first to the last blow"),
}
"""Values that a published number can be compared with: name, and quantity as the field of the result has it.

``force_width`` and ``force_over_mass`` are those of explicit finite elements. There ``width`` of a part or group is
that of the one pulse round its peak, where it first falls below a tenth of it on either side; ``force_width`` runs
from the first to the last tenth of the peak of the force, with gaps between contacts.
"""
USUAL_UNITS = dict(one.units for one in (ACCELERATION, FORCE, STRESS, LENGTH, MICROSECONDS))
"""Unit shown as a rule, by SI unit, of numbers whose unit the data or the user decide."""


def usual_unit(si: str) -> str:
    """Return the unit in which such numbers are shown as a rule: of channels, curves, limits, published values.

    Examples
    --------
    >>> usual_unit("N"), usual_unit("m/s"), usual_unit("")
    ('kN', 'm/s', '')
    """
    return USUAL_UNITS.get(si, si)
