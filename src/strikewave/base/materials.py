"""Materials: elastic constants, yield and loss, each row with its source (``materials.toml``)."""

from __future__ import annotations

import functools
import math
import tomllib
from dataclasses import dataclass
from importlib import resources

from strikewave.base.errors import InputError, nearest

MATERIAL = "material"
"""Table in the paths of numbers that a named material stands for: a case has no other of that name."""


@dataclass(frozen=True)
class Material:
    """An isotropic material at room temperature, quasi-static; SI.

    Attributes
    ----------
    name : str
        Name in the table.
    density : float
        kg/m^3.
    youngs_modulus : float
        Pa.
    poissons_ratio : float
        Between -1 and 0.5.
    kind : str
        metal, polymer or elastomer.
    source, status, note : str
        Where the numbers come from; ``checked``, ``quoted`` or ``from memory`` (`strikewave.base.citations`); what to
        know about them.
    yield_strength : float or None
        Pa.
    hardness : float or None
        Mean pressure of a ball indentation (Brinell, in Pa), in the state of the yield strength.
    loss_factor : float or None
        Tangent of the loss angle.
    from_memory : tuple of str
        Which numbers nobody has seen in a text, where ``status`` is ``from memory``.
    """

    name: str
    density: float
    youngs_modulus: float
    poissons_ratio: float
    kind: str
    source: str
    status: str
    note: str
    yield_strength: float | None = None
    hardness: float | None = None
    loss_factor: float | None = None
    from_memory: tuple[str, ...] = ()

    @property
    def bar_speed(self) -> float:
        """Speed of a longitudinal wave in a thin bar, c0 = sqrt(E/rho), m/s."""
        return math.sqrt(self.youngs_modulus / self.density)

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
        By name.

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
    folded = {known.lower(): known for known in materials()}
    if str(name).lower() not in folded:
        raise InputError(
            field, name, "a material of the table (`strikewave materials`)", nearest(str(name), materials())
        )
    return materials()[folded[str(name).lower()]]
