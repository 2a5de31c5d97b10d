"""The contact of a measured blow as a command: read, identify, print, draw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.base.errors import MISSING, InputError
from strikewave.base.result import Notice, Source
from strikewave.contact.identification import DESCRIBED, Identified, IdentifiedValue, identify
from strikewave.contact.impact import reduced_mass
from strikewave.records import ChannelReading, Options
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.numbers import listed, percent
from strikewave.reporting.options import Output, Typed
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.shown_result import Curve, columns_of, history_curve
from strikewave.reporting.terminal import number, significant, table, tell

_UNITS = {
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
_SHOWN = {"begin": "us", "duration": "us"}
_CALLED = {
    "mass": "reduced mass",
    "speed": "approach speed",
    "momentum": "mass x speed",
    "peak_force": "peak force",
    "stiffness_speed": "stiffness x speed^n",
    "begin": "first touch",
}


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
        return _UNITS

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
            (_CALLED.get(name, name), _in_words(name, estimate))
            for name, estimate in self.found.values.items()
            if estimate.value is not None and not estimate.given
        ]
        return [*numbers, ("misfit", percent(self.found.residual, 2))]

    def columns(self) -> list[Column]:
        """Return values and combinations with their standard errors, a row each, SI."""
        found = {**self.found.values, "begin": self.found.begin, **self.found.combinations}
        rows = [{"name": name, **_row(estimate), "unit": _UNITS[name]} for name, estimate in found.items()]
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
    _, value, error, unit = _line(name, estimate)
    known = value if estimate.standard_error is None else f"{value} ± {error}"
    return known if unit == "1" else f"{known} {unit}"


def identify_contact(
    file: str, given: Given, stated: dict[str, dict[str, Any]], options: Options, output: Output
) -> int:
    """Identify the contact of the largest blow of a file, write and print it, and return the exit code.

    Raises
    ------
    InputError
        If the file, or what is known of the bodies, cannot be used.
    """
    origin = measured.source_of(
        "records", Path(file).stem, [Path(file)] if output.writes(None) else [], output.stated_test()
    )
    return run_and_write(IdentifyCommand(file, given, stated, options, origin), output, None, origin.text)


@dataclass(frozen=True)
class IdentifyCommand(Command[IdentifyResult]):
    """The contact of a measured blow."""

    indent: ClassVar[int | None] = None

    file: str
    given: Given
    stated: dict[str, dict[str, Any]]
    options: Options
    origin: Source

    def solve(self) -> IdentifyResult:
        """Return what the blow tells."""
        masses = self.given.masses
        reading = measured.examined_channel(self.file, self.stated, self.options, "peak", "the blow")
        scale = _newtons(reading, masses["--m2"])
        reduced = _reduced(masses, reading.channel.unit == "m/s^2")
        known = self.given.known if reduced is None else {**self.given.known, "mass": reduced}
        contact = _identified(self.file, reading, scale, known, self.given.window)
        notices = _notices(reading, contact)
        return IdentifyResult(self.file, reading, contact, origin=self.origin, notices=notices)

    def summary(self, result: IdentifyResult) -> str:
        """Say what the pulse determines of the contact."""
        return identify_words(result)

    def show(self, result: IdentifyResult) -> None:
        """Print what the pulse determines of the contact."""
        _print(result)

    def draw(self, result: IdentifyResult, folder: Path) -> list[str]:
        """Write the pulse beside the law."""
        from strikewave.analyses.impact.figures.identified import identified_figure
        from strikewave.reporting.style import save, titled

        save(titled(identified_figure(result.found), result.title), folder / "summary.svg")
        return ["summary.svg"]


def _notices(reading: ChannelReading, found: Identified) -> tuple[Notice, ...]:
    """Return what harms the peak, and a law that does not describe the blow."""
    notices: list[Notice] = [
        finding.notice for finding in reading.findings if finding.severity != "good" and "peak" in finding.harms
    ]
    if not found.described:
        notices.append(Notice("law-misfit", found.words[-1], found.residual, DESCRIBED))
    return tuple(notices)


def _reduced(masses: dict[str, Typed | None], acceleration: bool) -> float | None:
    """Return the reduced mass where it is known; the mass of the struck body alone may be for its acceleration."""
    typed = {option: mass for option, mass in masses.items() if mass is not None}
    if "--mass" in typed:
        if "--m1" in typed or ("--m2" in typed and not acceleration):
            other = "--m1" if "--m1" in typed else "--m2"
            raise InputError(
                "--mass", typed["--mass"].word, f"--mass or {other}", "--mass is the reduced mass of both bodies"
            )
        return typed["--mass"]
    if not typed or (typed.keys() == {"--m2"} and acceleration):
        return None
    missing = {"--m1", "--m2"} - typed.keys()
    if missing:
        raise InputError(missing.pop(), MISSING, "the mass of the other body, or inf", "or give the reduced --mass")
    striker, struck = typed["--m1"], typed["--m2"]
    if math.isinf(striker) and math.isinf(struck):
        raise InputError("--m2", struck.word, "at most one infinite mass")
    return float(reduced_mass(striker, struck))


def _newtons(reading: ChannelReading, struck: float | None) -> float:
    """Return the newtons in one SI unit of a channel: 1 of a force, the struck mass of its acceleration."""
    unit, name = reading.channel.unit, reading.channel.name
    if unit == "N":
        return 1.0
    if unit != "m/s^2":
        allowed = f"a force such as N, or an acceleration such as g, of {name}"
        raise InputError("--unit", unit or MISSING, allowed, "a voltage needs --sensitivity")
    if struck is None:
        hint = f'{name} is an acceleration: such as --m2 "0.459 kg"'
        raise InputError("--m2", MISSING, "the mass of the struck body, that makes a force of its acceleration", hint)
    if math.isinf(struck):
        raise InputError("--m2", "inf", f"a finite mass of the struck body, whose acceleration {name} is")
    return struck


def _identified(
    file: str, reading: ChannelReading, scale: float, known: dict[str, float], span: tuple[float | None, Typed | None]
) -> Identified:
    channel, window = reading.channel, None
    if span != (None, None):
        first = -math.inf if span[0] is None else span[0]
        last = math.inf if span[1] is None else span[1]
        if not first < last:
            raise InputError("--to", "inf" if span[1] is None else span[1].word, f"a time after --from, {first:g} s")
        window = (first, last)
    try:
        return identify(channel.time, scale * channel.values, known, window=window)
    except InputError:
        raise
    except ValueError as error:
        ways = {"negative": " (--polarity -1)", "window": " (--from, --to)"}
        how = next((way for word, way in ways.items() if word in str(error)), "")
        raise InputError("FILE", file, "a record of one whole blow", f"{error}{how}") from None


def _row(estimate: IdentifiedValue) -> dict[str, Any]:
    return {"value": estimate.value, "standard_error": estimate.standard_error, "given": estimate.given}


def identify_words(result: IdentifyResult) -> str:
    """Say in words which values the pulse determines, and how well the law follows it."""
    contact = result.found
    lines = [_line(name, estimate) for name, estimate in contact.values.items()]
    found = [
        f"{name} {value}{'' if error in ('given', '-') else f' ± {error}'}{'' if unit == '1' else f' {unit}'}"
        for (name, value, error, unit), one in zip(lines, contact.values.values(), strict=True)
        if one.value is not None and one.standard_error is not None
    ]
    verdict = "describes" if contact.described else "does not describe"
    determined = f": {listed(found)} (± the standard error)" if found else ", which determines no value of it"
    return f"The law {verdict} the pulse to {percent(contact.residual, 2)} of its peak{determined}."


def _print(result: IdentifyResult) -> None:
    contact = result.found
    rows = [_line(name, estimate) for name, estimate in contact.values.items()]
    rows += [_line(name, estimate) for name, estimate in contact.combinations.items()]
    rows.append(_line("begin", contact.begin))
    title = f"Contact of {Path(result.file).name}, {result.reading.channel.name}: F = K d^n (1 + chi d'/v0)"
    table(title, [*keys(""), *numerals("value", "standard error"), *texts("unit")], rows)
    tell(
        f"noise {significant(contact.noise, 3)} N, misfit {contact.residual:.2%} of the peak, "
        f"{contact.time.size} samples"
    )
    shared = contact.correlated("exponent", "restitution")
    if shared is not None:
        tell(f"correlation of exponent and restitution: {shared:.2f}")
    for sentence in contact.words[: None if contact.described else -1]:
        tell(sentence)


def _line(name: str, estimate: IdentifiedValue) -> tuple[str, str, str, str]:
    unit = _UNITS[name]
    shown = _SHOWN.get(name, unit)
    called = _CALLED.get(name, name)
    if estimate.value is None:
        return called, "not determined", "-", unit
    value = number(estimate.value, unit, shown, 5) if shown != unit else significant(estimate.value, 5)
    if estimate.standard_error is None:
        return called, value, "given", shown
    error = estimate.standard_error
    return called, value, number(error, unit, shown, 2) if shown != unit else significant(error, 2), shown
