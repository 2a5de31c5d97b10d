"""A contact identified from a measured blow: its values, tables and documents."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, NOT_MEASURED, Quantity, declarations
from strikewave.base.shock_quantities import FORCE, IMPULSE, MICROSECONDS, RATIO, RESTITUTION
from strikewave.contact.identification import Identified
from strikewave.records import ChannelReading
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import text_of
from strikewave.reporting.numbers import shown, shown_unit, spelled
from strikewave.reporting.parts import written
from strikewave.reporting.shown_result import Curve, history_curve

Array = NDArray[np.float64]


@declare.dataclass
class ExaminedRecord:
    """The channel of the blow, with its unit, status and calibration."""

    channel: str = declare.word("channel")
    measured_unit: str = declare.word("unit of the channel")
    status: str = declare.word("good, suspect or bad")
    calibration: dict[str, Any] = declare.word("what was stated of it, as typed")


@declare.dataclass
class IdentifiedNumber:
    """A value and its standard error, SI: see `strikewave.contact.identification.IdentifiedValue`."""

    value: float | None = declare.number(NOT_MEASURED, "SI; null where the pulse does not determine it")
    standard_error: float | None = declare.number(NOT_MEASURED, "of it; null where it was given")
    given: bool = declare.word("whether it was given")


@declare.dataclass
class ContactValues:
    """The values of a contact."""

    stiffness: IdentifiedNumber = declare.part(IdentifiedNumber, "K of F = K d^n", quantity=Quantity("N/m^n", "N/m^n"))
    exponent: IdentifiedNumber = declare.part(IdentifiedNumber, "n", quantity=RATIO)
    restitution: IdentifiedNumber = declare.part(IdentifiedNumber, "e", quantity=RESTITUTION)
    mass: IdentifiedNumber = declare.part(IdentifiedNumber, "m", quantity=Quantity("kg", "kg", "reduced mass"))
    speed: IdentifiedNumber = declare.part(IdentifiedNumber, "v", quantity=Quantity("m/s", "m/s", "approach speed"))


@declare.dataclass
class PulseCombinations:
    """Combinations of values that a pulse determines in any case."""

    momentum: IdentifiedNumber = declare.part(IdentifiedNumber, "m v", quantity=IMPULSE._replace(label="mass x speed"))
    impulse: IdentifiedNumber = declare.part(IdentifiedNumber, "m v (1 + e)", quantity=IMPULSE)
    peak_force: IdentifiedNumber = declare.part(IdentifiedNumber, "largest force", quantity=Quantity("N", "N"))
    duration: IdentifiedNumber = declare.part(IdentifiedNumber, "length of the contact", quantity=MICROSECONDS)
    stiffness_speed: IdentifiedNumber = declare.part(
        IdentifiedNumber, "K v^n", quantity=Quantity("N/s^n", "N/s^n", "stiffness x speed^n")
    )


@declare.dataclass
class Correlation:
    """The correlation of the errors of values."""

    names: tuple[str, ...] = declare.word("what was determined and not given")
    matrix: Array = declare.history(NO_UNIT, "correlation of the errors of their logarithms (of begin as it is)")


@declare.dataclass
class IdentifiedContact:
    """A contact identified from a pulse, with the errors of its values."""

    values: ContactValues = declare.part(ContactValues, "what the contact has")
    begin: IdentifiedNumber = declare.part(
        IdentifiedNumber, "first touch", quantity=MICROSECONDS._replace(label="first touch")
    )
    combinations: PulseCombinations = declare.part(PulseCombinations, "what the pulse determines anyway")
    correlation: Correlation = declare.part(Correlation, "how the errors go together")
    noise: float = declare.number(
        Quantity("N", "N", digits=3), "standard deviation of a sample on which the standard errors rest"
    )
    offset: float = declare.number(Quantity("N", "N"), "baseline before the pulse")
    residual: float = declare.number(
        Quantity(NO_UNIT, "%", decimals=2, digits=0),
        "root mean square of measured less fitted, as a share of the peak",
        headline="misfit, share of the peak",
    )
    described: bool = declare.word("whether the law describes the pulse")
    words: tuple[str, ...] = declare.word("what is not determined, or not well, in sentences")
    time: Array = declare.history("s", "samples that were taken")
    measured: Array = declare.history("N", "force there, the baseline taken off")
    fitted: Array = declare.history("N", "the fit there")


@declare.dataclass
class IdentifiedRow:
    """A value with its standard error, SI, and what it measures."""

    key: str = declare.word("what the document calls it", key="name")
    number: IdentifiedNumber = declare.part(IdentifiedNumber, "the value", inline=True)
    unit: str = declare.word("its SI unit")
    quantity: Quantity

    @declare.computed(declare.word("what faces call it", label="identified", column=KEY, in_document=False))
    def name(self) -> str:
        """Name on screen and page."""
        return self.quantity.label or self.key.replace("_", " ")

    @declare.computed(
        declare.word(
            "the value with its standard error", label="value", column=MAIN, headline="{name}", in_document=False
        )
    )
    def stated(self) -> str:
        """The value with its standard error and its unit where it has them."""
        value, error, given = self.number.value, self.number.standard_error, self.number.given
        if value is None:
            return "not determined"
        si, usual, unit = *self.quantity[:2], shown_unit(*self.quantity[:2])
        text = written(shown(value, si, usual), 5)
        text += "" if error is None else f" ± {written(shown(error, si, usual), 2)}"
        return text + ("" if unit == NO_UNIT else f" {spelled(unit)}") + (", given" if given else "")


@declare.dataclass
class IdentifyResult(measured.AskedResult):
    """A contact identified from a channel of a file; see `Result` for what it shares with others."""

    command: ClassVar[str] = "identify"
    drawing: ClassVar[str] = "identified_report"
    main_rows: ClassVar[str] = "identified_rows"

    file: str = declare.word("measured file")
    reading: ChannelReading
    found: Identified

    @property
    def title(self) -> str:
        """File and channel."""
        return f"{Path(self.file).name}, {self.reading.channel.name}"

    @property
    def broken(self) -> bool:
        """True if the law does not describe the blow."""
        return not self.found.described

    @declare.computed(declare.part(ExaminedRecord, "what the channel was taken as", inline=True))
    def record(self) -> ExaminedRecord:
        """The channel with its unit, status and calibration."""
        channel = self.reading.channel
        return ExaminedRecord(channel.name, channel.unit, self.reading.status, self.reading.calibration.stated())

    @declare.computed(
        declare.rows(IdentifiedRow, "values, with their standard errors", headline="5", in_document=False)
    )
    def identified_rows(self) -> list[IdentifiedRow]:
        """Values and combinations with their standard errors."""
        contact, rows = self.contact, list[IdentifiedRow]()
        for part in (contact.values, contact, contact.combinations):
            for key, declared in declarations(type(part)).items():
                if declared.of is IdentifiedNumber:
                    rows.append(IdentifiedRow(key, getattr(part, key), declared.quantity.si, declared.quantity))
        return rows

    @declare.computed(declare.part(IdentifiedContact, "what the pulse tells", inline=True, headline="first"))
    def contact(self) -> IdentifiedContact:
        """The identified contact as in the document."""
        fit = self.found
        values = {name: IdentifiedNumber(*number) for name, number in fit.values.items()}
        combinations = {name: IdentifiedNumber(*number) for name, number in fit.combinations.items()}
        parts = ContactValues(**values), IdentifiedNumber(*fit.begin), PulseCombinations(**combinations)
        same = ("noise", "offset", "residual", "described", "words", "time", "measured", "fitted")
        numbers = {name: getattr(fit, name) for name in same}
        return IdentifiedContact(*parts, Correlation(fit.names, fit.correlation), **numbers)

    def preview(self) -> Curve:
        """Return the measured force."""
        return history_curve(self.found.time, self.found.measured, *FORCE.units, "measured force")

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"identify.json": self.document_text()}


def identified_words(result: IdentifyResult) -> str:
    """Return the summary of an identified contact in words."""
    contact = result.contact
    fits = "describes" if contact.described else "does not describe"
    sentences = [
        f"The law F = K d^n (1 + chi d'/v0) of two free bodies {fits} the blow of {result.reading.channel.name} in "
        f"{Path(result.file).name}: the misfit is {text_of(contact, 'residual')} of the peak.",
        *(text[0].upper() + text[1:].rstrip(".") + "." for text in contact.words),
    ]
    return " ".join(sentences)
