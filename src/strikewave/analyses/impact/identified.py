"""What a measured blow tells of its contact: values, tables, documents."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from strikewave.base.units import DIMENSIONS
from strikewave.contact.identification import Identified, IdentifiedValue
from strikewave.records import ChannelReading
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import percent, spelled
from strikewave.reporting.options.kinds import Typed
from strikewave.reporting.shown_result import Curve, columns_of, history_curve
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.terminal import number, significant

UNITS = {
    "stiffness": "N/m^n",
    "exponent": "1",
    "restitution": "1",
    "mass": "kg",
    "speed": "m/s",
    "begin": "s",
    "momentum": "N s",
    "impulse": "N s",
    "peak_force": "N",
    "duration": "s",
    "stiffness_speed": "N/s^n",
    "noise": "N",
    "offset": "N",
    "residual": "1",
    "time": "s",
    "measured": "N",
    "fitted": "N",
}
"""SI unit of each key of the JSON document."""
USUAL = {"begin": "us", "duration": "us"}
"""Units in which values are shown as a rule, where it is not the SI unit."""
CALLED = {
    "mass": "reduced mass",
    "speed": "approach speed",
    "momentum": "mass x speed",
    "peak_force": "peak force",
    "stiffness_speed": "stiffness x speed^n",
    "begin": "first touch",
}
"""What values are called, where it is not their key."""


@dataclass(frozen=True)
class Given:
    """What is known of the bodies, as far as it was typed.

    Attributes
    ----------
    known : dict
        Speed, stiffness, exponent, restitution, SI.
    masses : dict
        What was typed of the masses, by option.
    window : (float or None, Typed or None)
        From when to when the blow is fitted.
    """

    known: dict[str, float]
    masses: dict[str, Typed | None]
    window: tuple[float | None, Typed | None]


@dataclass(frozen=True)
class IdentifyResult(measured.AskedResult):
    """What a channel of a file tells of a contact; see `Result` for what it shares with others.

    Attributes
    ----------
    file : str
        The measured file.
    reading : ChannelReading
        The channel, examined.
    found : Identified
        What was identified.
    """

    command: ClassVar[str] = "identify"

    file: str
    reading: ChannelReading
    found: Identified

    @property
    def title(self) -> str:
        """File and channel."""
        return f"{Path(self.file).name}, {self.reading.channel.name}"

    @property
    def broken(self) -> bool:
        """Whether the law does not describe the blow."""
        return not self.found.described

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        reading, contact = self.reading, self.found
        return {
            "file": self.file,
            "channel": reading.channel.name,
            "measured_unit": reading.channel.unit,
            "status": reading.status,
            "calibration": reading.calibration.stated(),
            "values": {name: _row(estimate) for name, estimate in contact.values.items()},
            "begin": _row(contact.begin),
            "combinations": {name: _row(estimate) for name, estimate in contact.combinations.items()},
            "correlation": {"names": contact.names, "matrix": contact.correlation},
            "noise": contact.noise,
            "offset": contact.offset,
            "residual": contact.residual,
            "described": contact.described,
            "words": contact.words,
            "time": contact.time,
            "measured": contact.measured,
            "fitted": contact.fitted,
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the values that were determined, each with its standard error, and the misfit."""
        numbers = [
            (CALLED.get(name, name), _in_words(name, estimate))
            for name, estimate in self.found.values.items()
            if estimate.value is not None and not estimate.given
        ]
        return [*numbers, ("misfit", percent(self.found.residual, 2))]

    def columns(self) -> list[Column]:
        """Return values and combinations with their standard errors, a row each, SI."""
        found = {**self.found.values, "begin": self.found.begin, **self.found.combinations}
        rows = [{"name": name, **_row(estimate), "unit": UNITS[name]} for name, estimate in found.items()]
        return columns_of(rows, {})

    def brief(self) -> dict[str, str]:
        """Return all columns but which values were given."""
        return dict.fromkeys(("name", "value", "standard_error", "unit"), "")

    def preview(self) -> Curve:
        """Return the measured force."""
        return history_curve(self.found.time, self.found.measured, "N", "kN", "measured force")

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"identify.json": self.document_text()}


def _in_words(name: str, estimate: IdentifiedValue) -> str:
    """Return a value with its standard error, where it has one, and its unit."""
    _, value, error, unit = value_line(name, estimate)
    known = value if estimate.standard_error is None else f"{value} ± {error}"
    return known if unit == "1" else f"{known} {unit}"


def _row(estimate: IdentifiedValue) -> dict[str, Any]:
    return {"value": estimate.value, "standard_error": estimate.standard_error, "given": estimate.given}


def value_line(name: str, estimate: IdentifiedValue) -> tuple[str, str, str, str]:
    """Return what a value is called, and value, standard error and unit in words."""
    si = UNITS[name]
    usual = USUAL.get(name, si)
    called, unit = CALLED.get(name, name), spelled(shown_unit(si, usual))
    if estimate.value is None:
        return called, "not determined", "-", unit
    write = partial(number, si=si, usual=usual) if si in DIMENSIONS else significant
    value = write(estimate.value, digits=5)
    error = estimate.standard_error
    return called, value, "given" if error is None else write(error, digits=2), unit
