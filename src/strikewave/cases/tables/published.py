"""[[published]]: numbers to compare a result with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range, Value
from strikewave.cases.tables.base import CaseTable

PUBLISHED_QUANTITIES = {
    "first.rigid_peak": "m/s^2",
    "first.total_peak": "m/s^2",
    "first.wave_peak": "m/s^2",
    "first.sensor_peak": "m/s^2",
    "first.sensor_width": "s",
    "first.width": "s",
    "first.peak_force": "N",
    "first.contact_time": "s",
    "first.approach_speed": "m/s",
    "first.rebound_speed": "m/s",
    "first.restitution": "",
    "first.indentation": "m",
    "first.residual_indentation": "m",
    "first.velocity_change": "m/s",
    "first.blow_velocity_change": "m/s",
    "first.force_width": "s",
    "first.force_over_mass": "m/s^2",
    "typical.rigid_peak": "m/s^2",
    "typical.width": "s",
    "count": "",
    "window": "s",
}
"""What a published number can be compared with: its name and SI unit.

``force_width`` and ``force_over_mass`` are those of explicit finite elements. There ``width`` of a part or group is
that of the one pulse round its peak, where it first falls below a tenth of it on either side; ``force_width`` runs
from the first to the last tenth of the peak of the force, with gaps between contacts.
"""


class Published(CaseTable):
    """[[published]]: a number to compare the result with; ``sensor`` names the one it was read from.

    In a finite-element case ``sensor`` is the part or group that moves. Its ``origin`` is a measurement, a simulation,
    or what a standard specifies.
    """

    quantity: str
    sensor: str = ""
    value: Value
    origin: Literal["measured", "simulated", "specified"]
    role: Literal["fitted", "predicted", "shown"]
    note: str = ""


def read_published(raw: Any) -> Any:
    """Read a published number in the unit of the quantity it names."""
    if not isinstance(raw, Mapping) or "quantity" not in raw or "value" not in raw:
        return raw
    quantity, value = raw["quantity"], raw["value"]
    if not isinstance(quantity, str) or quantity not in PUBLISHED_QUANTITIES:
        raise InputError("quantity", quantity, "a computed quantity", nearest(str(quantity), PUBLISHED_QUANTITIES))
    unit = PUBLISHED_QUANTITIES[quantity]
    if isinstance(value, Value):
        return raw
    read = Range(unit, 0.0, open_low=True).read(value)
    if read.tolerance is not None:
        raise InputError("value.tolerance", read.tolerance.typed, "no tolerance on a published number", "remove it")
    return {**raw, "value": read.model_copy(update={"provenance": "published"})}
