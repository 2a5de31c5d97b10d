"""Constants of nature, and of materials: elasticity, yield and loss, each row with its source (``materials.toml``)."""

from __future__ import annotations

import functools
import math
import tomllib
from importlib import resources

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError, nearest

STANDARD_GRAVITY = 9.80665
"""Standard gravity, m/s^2 (exact, CGPM 1901)."""
COVERAGE = 2.0
"""Coverage factor k of an expanded uncertainty: 95.45 % of a normal distribution (JCGM 100, 6.2)."""


MATERIAL = "material"
"""Table in the paths of numbers that a named material stands for: a case has no other of that name."""


@declare.dataclass
class Material:
    """An isotropic material at room temperature, quasi-static; SI.

    Its status is ``checked``, ``quoted`` or ``from memory`` (`strikewave.base.citations`). The hardness is the mean
    pressure of a ball indentation (Brinell), in the state of the yield strength; the loss factor is the tangent of the
    loss angle.
    """

    name: str = declare.word("name", column=KEY)
    density: float = declare.number(Quantity("kg/m^3", "kg/m^3"), "density", column=MAIN)
    youngs_modulus: float = declare.number(Quantity("Pa", "GPa", "E"), "Young's modulus", column=MAIN)
    poissons_ratio: float = declare.number(Quantity(NO_UNIT, NO_UNIT, "nu"), "Poisson's ratio", column=MORE)
    kind: str = declare.word("metal, polymer, ...")
    source: str = declare.word("where the numbers come from")
    status: str = declare.word("how they are known", column=MORE)
    note: str = declare.word("remarks on them")
    yield_strength: float | None = declare.number(
        Quantity("Pa", "MPa"), "yield strength", label="yield", column=MAIN, default=None
    )
    hardness: float | None = declare.number(Quantity("Pa", "MPa"), "hardness", column=MORE, default=None)
    loss_factor: float | None = declare.number(Quantity(NO_UNIT, NO_UNIT), "loss factor", column=MORE, default=None)
    from_memory: tuple[str, ...] = declare.word("which of them were seen in no text", default=())

    bar_speed = declare.computed(declare.number(Quantity("m/s", "m/s"), "speed of a wave in a thin bar", column=MAIN))(
        lambda row: math.sqrt(row.youngs_modulus / row.density)
    )

    @property
    def impedance(self) -> float:
        """Wave impedance per area, rho c0, kg/(m^2 s)."""
        return self.density * self.bar_speed


@functools.cache
def materials() -> dict[str, Material]:
    """Return all materials by name, in the order of the table.

    Returns
    -------
    dict of str to Material
        Materials by name.

    Examples
    --------
    >>> round(materials()["65Mn"].bar_speed, 2)
    5194.43
    """
    text = (resources.files("strikewave.base") / "materials.toml").read_text("utf-8")
    rows = tomllib.loads(text)
    return {name: Material(name, from_memory=tuple(row.pop("from_memory", ())), **row) for name, row in rows.items()}


def material(name: str, field: str = "material") -> Material:
    """Return a material by name.

    Parameters
    ----------
    name : str
        Name in the table; case does not matter.
    field : str, optional
        Path of the field, for the error message.

    Returns
    -------
    Material
        Density (kg/m^3), Young's modulus (Pa), Poisson's ratio and what else is known, with its source.

    Raises
    ------
    InputError
        If the table has no such material.

    Examples
    --------
    >>> material("65mn").density
    7820
    """
    rows = {known.lower(): row for known, row in materials().items()}
    if str(name).lower() not in rows:
        allowed = "a material of the table (`strikewave materials`)"
        raise InputError(field, name, allowed, nearest(str(name), materials()))
    return rows[str(name).lower()]
