"""Cushion materials: the properties of a law by name, each row with its source (``cushions.toml``)."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources

from strikewave.base.errors import InputError, nearest


@dataclass(frozen=True)
class CushionMaterial:
    """A cushion material; quasi-static, at room temperature.

    Attributes
    ----------
    name, law : str
        Name in the table, and that of its law.
    properties : mapping
        What is known of it by the names of the law's properties, SI; what is missing must be given.
    source, status, note : str
        Where the numbers come from; ``checked``, ``quoted`` or ``from memory``; what to know about them.
    """

    name: str
    law: str
    properties: Mapping[str, float]
    source: str
    status: str
    note: str


@functools.cache
def cushion_materials() -> dict[str, CushionMaterial]:
    """Return all cushion materials by name, in the order of the table.

    Examples
    --------
    >>> cushion_materials()["EPS 22"].law
    'crush'
    """
    text = (resources.files("strikewave.contact") / "cushions.toml").read_text("utf-8")
    return {name: CushionMaterial(name=name, **row) for name, row in tomllib.loads(text).items()}


def cushion_material(name: str, field: str = "material") -> CushionMaterial:
    """Return a cushion material by its name; case does not matter.

    Raises
    ------
    InputError
        If the table has no such material.
    """
    folded = {known.lower(): known for known in cushion_materials()}
    if name.lower() not in folded:
        raise InputError(field, name, "a cushion material (docs/cushions.md)", nearest(name, cushion_materials()))
    return cushion_materials()[folded[name.lower()]]
