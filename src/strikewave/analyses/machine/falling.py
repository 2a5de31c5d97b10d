"""A fall along a guide, which several kinds of machines begin with."""

from __future__ import annotations

from strikewave.base.errors import checked
from strikewave.base.quantities import Value
from strikewave.cases.contact_of_case import or_else
from strikewave.machines.launch import fall_speed


def fall(height: Value, friction: Value | None, mass: float) -> tuple[float, float, float]:
    """Return speed (m/s), time (s) and energy (J) of a fall from rest along a guide, its friction a share of weight.

    Raises
    ------
    InputErrors
        If the friction is no such share.
    """
    share = or_else(friction, 0.0)
    speed = float(checked("machine.friction", lambda: fall_speed(height.si, friction=share)))
    return speed, 2.0 * height.si / speed, 0.5 * mass * speed**2
