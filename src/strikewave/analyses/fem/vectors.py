"""Vectors of a case in, numbers out."""

from __future__ import annotations

import math
from typing import Any

from strikewave.base.errors import InputError
from strikewave.fem.model import Vector


def vector(table: Any) -> Vector:
    """Return the numbers of a vector's table, 0 where it has none, or where there is no table.

    Examples
    --------
    >>> from strikewave.cases.tables.mesh import VelocityTable
    >>> vector(VelocityTable(z="-1 m/s"))
    (0.0, 0.0, -1.0)
    """
    x, y, z = (getattr(table, axis, None) for axis in "xyz")
    return (x.si if x else 0.0, y.si if y else 0.0, z.si if z else 0.0)


def direction(table: Any, path: str) -> Vector:
    """Return the unit vector of a direction.

    Raises
    ------
    InputError
        If it points nowhere.
    """
    x, y, z = vector(table)
    length = math.hypot(x, y, z)
    if length == 0.0:
        raise InputError(path, "no direction", "a vector that is not 0", 'such as "z", or { x = 1, z = 1 }')
    return (x / length, y / length, z / length)
