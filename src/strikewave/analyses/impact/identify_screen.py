"""The contact of a measured blow as a command: identify, print, draw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.analyses.impact.identified import IdentifyResult, identified_words
from strikewave.base.errors import MISSING, InputError
from strikewave.base.result import Notice, Source
from strikewave.contact.identification import DESCRIBED, Identified, identify
from strikewave.contact.impact import reduced_mass
from strikewave.records import ChannelReading, Options
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import face_columns, text_of
from strikewave.reporting.options import Typed
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import print_rows, tell


@dataclass(frozen=True)
class Given:
    """Known numbers of the bodies (SI), their typed masses by option, and the begin and end of the fit."""

    known: dict[str, float]
    masses: dict[str, Typed | None]
    window: tuple[float | None, Typed | None]


def identify_contact(
    file: str, given: Given, stated: dict[str, dict[str, Any]], options: Options, output: Output
) -> int:
    """Identify the contact of the largest blow of a file, write and print it, and return the exit code."""
    origin = measured.source_of_records(Path(file).stem, [Path(file)], output, None)
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
        """Return the identified contact."""
        masses = self.given.masses
        reading = measured.examined_channel(self.file, self.stated, self.options, "peak", "the blow")
        scale = _newtons(reading, masses["--m2"])
        reduced = _reduced(masses, reading.channel.unit == "m/s^2")
        known = self.given.known if reduced is None else {**self.given.known, "mass": reduced}
        contact = _identified(self.file, reading, scale, known, self.given.window)
        notices = [row.notice for row in reading.findings if row.severity != "good" and "peak" in row.harms]
        if not contact.described:
            notices.append(Notice("law-misfit", contact.words[-1], contact.residual, DESCRIBED))
        return IdentifyResult(self.file, reading, contact, origin=self.origin, notices=tuple(notices))

    def summary(self, result: IdentifyResult) -> str:
        """Return the values that the pulse determines, in words."""
        return identified_words(result)

    def show(self, result: IdentifyResult) -> None:
        """Print the values that the pulse determines, and its misfit."""
        contact = result.contact
        title = f"Contact of {Path(result.file).name}, {result.reading.channel.name}: F = K d^n (1 + chi d'/v0)"
        print_rows(title, face_columns(result, "identified_rows"))
        noise, misfit = text_of(contact, "noise"), text_of(contact, "residual")
        tell(f"noise {noise}, misfit {misfit} of the peak, {contact.time.size} samples")
        shared = result.found.correlated("exponent", "restitution")
        if shared is not None:
            tell(f"correlation of exponent and restitution: {shared:.2f}")

    def draw(self, result: IdentifyResult, folder: Path) -> list[str]:
        """Write the page, and the pulse beside the law."""
        from strikewave.analyses.impact.identified_report import identified_picture, identified_report
        from strikewave.reporting.style import save

        with drawing(folder / "summary.svg") as path:
            save(identified_picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(identified_report(result), "utf-8", newline="\n")
        return ["report.html", "summary.svg"]


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
        raise InputError("FILE", Path(file), "a record of one whole blow", f"{error}{how}") from None
