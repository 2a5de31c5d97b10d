"""Systems of units of other codes, which have none of their own: numbers that belong together.

A system is three units, of length, mass and time; all others follow from them. Temperatures stay in K.
"""

from __future__ import annotations

from dataclasses import dataclass

from strikewave.base.errors import InputError, nearest


@dataclass(frozen=True)
class UnitSystem:
    """A consistent system of units; each factor turns a number in SI into one in the system.

    Parameters
    ----------
    name : str
    length, mass, time : float
        The units in SI: m, kg, s.
    words : tuple of str
        Names of the units of length, mass and time.

    Examples
    --------
    >>> system = SYSTEMS["mm-t-s"]
    >>> system.stress * 211e9, system.density * 7820.0  # MPa, t/mm^3
    (211000.0, 7.82e-09)
    >>> SYSTEMS["mm-g-us"].stress * 211e9, SYSTEMS["mm-g-us"].force * 1e6  # TPa, MN
    (0.211, 1.0)
    """

    name: str
    length: float
    mass: float
    time: float
    words: tuple[str, str, str]

    def factor(self, length: int = 0, mass: int = 0, time: int = 0) -> float:
        """Return the factor of a quantity length^a mass^b time^c."""
        return float(f"{self.length**-length * self.mass**-mass * self.time**-time:.14g}")

    distance = property(lambda self: self.factor(1), doc="Factor of a length.")
    duration = property(lambda self: self.factor(time=1), doc="Factor of a time.")
    density = property(lambda self: self.factor(-3, 1), doc="Factor of a density.")
    stress = property(lambda self: self.factor(-1, 1, -2), doc="Factor of a stress, a pressure or a modulus.")
    force = property(lambda self: self.factor(1, 1, -2), doc="Factor of a force.")
    energy = property(lambda self: self.factor(2, 1, -2), doc="Factor of an energy.")
    velocity = property(lambda self: self.factor(1, 0, -1), doc="Factor of a velocity.")
    acceleration = property(lambda self: self.factor(1, 0, -2), doc="Factor of an acceleration.")
    rate = property(lambda self: self.factor(time=-1), doc="Factor of a rate of strain.")
    specific_heat = property(lambda self: self.factor(2, 0, -2), doc="Factor of an energy per mass and kelvin.")
    heat_capacity = property(lambda self: self.factor(-1, 1, -2), doc="Factor of an energy per volume and kelvin.")


SYSTEMS = {
    "SI": UnitSystem("SI", 1.0, 1.0, 1.0, ("m", "kg", "s")),
    "mm-t-s": UnitSystem("mm-t-s", 1e-3, 1e3, 1.0, ("mm", "Mg", "s")),
    "mm-ms-kg": UnitSystem("mm-ms-kg", 1e-3, 1.0, 1e-3, ("mm", "kg", "ms")),
    "mm-g-us": UnitSystem("mm-g-us", 1e-3, 1e-3, 1e-6, ("mm", "g", "mus")),
}
"""Unit systems by name; words as OpenRadioss writes them: Mg is a tonne, mus a microsecond."""


def unit_system(name: str, field: str = "units") -> UnitSystem:
    """Return a system of units by its name; ``field`` is where that was stated."""
    if name not in SYSTEMS:
        raise InputError(field, name, ", ".join(SYSTEMS), nearest(name, SYSTEMS))
    return SYSTEMS[name]
