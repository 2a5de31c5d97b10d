"""Variables of an xarray Dataset, with their unit and what they are."""

from __future__ import annotations

from typing import Any


def quantity(dimension: Any, values: Any, unit: str, name: str) -> tuple[Any, Any, dict[str, str]]:
    """Return a variable of a dataset with its unit and name."""
    return dimension, values, {"units": unit, "long_name": name}
