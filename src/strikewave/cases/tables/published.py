"""[[published]]: numbers to compare a result with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from strikewave.base.declare import NO_UNIT
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range, Value
from strikewave.base.shock_quantities import PUBLISHED_QUANTITIES
from strikewave.cases.tables.base import CaseTable


def published_unit(quantity: str) -> str:
    """Return the SI unit of a published number by its name; empty of a ratio and a count, as cases have them.

    Examples
    --------
    >>> published_unit("first.width"), published_unit("count")
    ('s', '')
    """
    return PUBLISHED_QUANTITIES[quantity].si.replace(NO_UNIT, "")


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
    if isinstance(value, Value):
        return raw
    read = Range(published_unit(quantity), 0.0, open_low=True).read(value)
    if read.tolerance is not None:
        raise InputError("value.tolerance", read.tolerance.typed, "no tolerance on a published number", "remove it")
    return {**raw, "value": read.model_copy(update={"provenance": "published"})}
