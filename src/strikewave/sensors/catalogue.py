"""Accelerometers for high shocks: range and resonance, each row with its source (``sensors.toml``)."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass
from importlib import resources

from strikewave.base.errors import InputError, nearest
from strikewave.sensors.chain import ASSUMED_QUALITY, Sensor
from strikewave.sensors.mounting import Mounting


@dataclass(frozen=True)
class Accelerometer:
    """An accelerometer of the table; SI.

    Attributes
    ----------
    name : str
        Name in the table.
    range : float
        Largest acceleration to both sides, m/s^2.
    resonance : float
        Hz; the least that the maker states where a range is given.
    kind : str
        piezoresistive or piezoelectric.
    source, status, note : str
        Where the numbers come from; ``checked``, ``quoted`` or ``from memory`` (`strikewave.base.citations`); what to
        know about them.
    quality : float
        Magnification at resonance; assumed unless the note says otherwise.
    """

    name: str
    range: float
    resonance: float
    kind: str
    source: str
    status: str
    note: str
    quality: float = ASSUMED_QUALITY

    def mounted(self, mounting: Mounting | None = None) -> Sensor:
        """Return it as a sensor on a mounting, directly where none is given.

        Examples
        --------
        >>> accelerometer("Endevco 7270A-20K").mounted().resonance
        350000.0
        """
        return Sensor(self.name, mounting or Mounting(), self.resonance, self.quality, self.range)


@functools.cache
def accelerometers() -> dict[str, Accelerometer]:
    """Return all accelerometers by name, in the order of the table.

    Examples
    --------
    >>> round(accelerometers()["Endevco 7270A-60K"].range / 9.80665)
    60000
    """
    text = (resources.files("strikewave.sensors") / "sensors.toml").read_text("utf-8")
    return {name: Accelerometer(name=name, **row) for name, row in tomllib.loads(text).items()}


def accelerometer(name: str, field: str = "sensor") -> Accelerometer:
    """Return an accelerometer by name; case does not matter.

    Parameters
    ----------
    name : str
        Name in the table.
    field : str, optional
        Path of the field, for the error message.

    Raises
    ------
    InputError
        If the table has no such accelerometer.

    Examples
    --------
    >>> accelerometer("pcb 350c02").kind
    'piezoelectric'
    """
    folded = {known.lower(): known for known in accelerometers()}
    if str(name).lower() not in folded:
        raise InputError(field, name, "an accelerometer of the table", nearest(str(name), accelerometers()))
    return accelerometers()[folded[str(name).lower()]]
