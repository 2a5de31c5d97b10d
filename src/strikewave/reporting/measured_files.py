"""What the commands on measured files share: their options, reading, and calibration."""

from __future__ import annotations

import contextlib
import glob
import hashlib
import os
import re
import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from strikewave.base.errors import InputError, StrikewaveError, nearest
from strikewave.base.result import Source
from strikewave.base.units import parse_quantity, si_value, take_apart, typed_number
from strikewave.reporting.options import parsed, quantity
from strikewave.reporting.output_options import ORIGIN, Output, origin_text
from strikewave.reporting.shown_result import ShownResult
from strikewave.reporting.terminal import progress_bar, say

if TYPE_CHECKING:
    from strikewave.cases.stated_test import StatedTest
    from strikewave.records import ChannelReading, FileReading, Options, Record, Request

Files = Annotated[
    list[str], typer.Argument(metavar="FILE", help="Measured files of any known format.", show_default=False)
]


def _of_channels(name: str, help: str) -> Any:
    """Return an option of the calibration, which may be said for each channel."""
    each = " [CHANNEL=]VALUE; may be repeated."
    return typer.Option(name, metavar="VALUE", help=help + each, show_default=False)


Stated = str | float | Mapping[str, str | float]
"""A value of the calibration as Python takes it: for all channels, or one for each by its name or number."""


def _words(value: Stated | None) -> list[str] | None:
    """Return a value of the calibration as the command line takes it."""
    if value is None:
        return None
    return [f"{name}={one}" for name, one in value.items()] if isinstance(value, Mapping) else [str(value)]


def read_time_unit(word: str, field: str) -> float:
    """Return the seconds of a unit of time, or of a number of them.

    Examples
    --------
    >>> read_time_unit("ms", "--time-unit"), read_time_unit("10 us", "--time-unit")
    (0.001, 1e-05)
    """
    from strikewave.records.readers.headings import UNITS_OF_TIME, seconds_in

    seconds = seconds_in(word)
    if seconds is not None:
        return seconds
    typed = take_apart(word)
    unit = "" if typed is None else typed.unit
    if typed is not None and typed.value > 0.0 and seconds_in(unit) is not None:
        return parse_quantity(word, "s", field)
    allowed = 'a unit of time, such as s, ms, us, ns or min, or a number of them, such as "10 us"'
    raise InputError(field, word, allowed, nearest(unit or word, UNITS_OF_TIME))


@dataclass(frozen=True)
class MeasurementOptions:
    """How files are read, and the calibration of their channels."""

    panel: ClassVar[str] = "Reading and calibration"

    channel: Annotated[
        list[str] | None,
        typer.Option(
            "--channel",
            metavar="NAME|NUMBER",
            help="Channel to take; all, or the first, by default; may be repeated.",
            show_default=False,
        ),
    ] = None
    unit: Annotated[list[str] | None, _of_channels("--unit", "Unit of the file's values, such as g or mV.")] = None
    sensitivity: Annotated[
        list[str] | None, _of_channels("--sensitivity", 'Sensitivity of the sensor, such as "1.2 mV/g".')
    ] = None
    gain: Annotated[list[str] | None, _of_channels("--gain", 'Gain of the amplifier: 10, or "10 mV/pC".')] = None
    excitation: Annotated[
        list[str] | None, _of_channels("--excitation", 'Bridge voltage in the test, such as "5 V".')
    ] = None
    rated_excitation: Annotated[
        list[str] | None, _of_channels("--rated-excitation", "Bridge voltage that the sensitivity is stated for.")
    ] = None
    count: Annotated[list[str] | None, _of_channels("--count", 'Voltage of one ADC count, such as "305 uV".')] = None
    polarity: Annotated[
        list[str] | None, _of_channels("--polarity", "1, or -1 for a sensor mounted the other way.")
    ] = None
    rate: Annotated[
        float | None,
        quantity("--rate", si="Hz", help='Sampling rate of files without a time column, such as "200 kHz".'),
    ] = None
    time: Annotated[
        str | None,
        typer.Option(
            "--time", metavar="NAME|NUMBER", help="Column that holds time; found by default.", show_default=False
        ),
    ] = None

    time_unit: Annotated[
        float | None,
        parsed(
            "--time-unit",
            read=read_time_unit,
            metavar="UNIT",
            help='Unit of the time column, such as ms or "10 us"; that of the file, or s, by default.',
        ),
    ] = None
    measurement: Annotated[
        int | None,
        typer.Option(
            "--measurement",
            min=1,
            help="Which of the measurements of a file to take, from 1; all of them by default, where many are read.",
            show_default=False,
        ),
    ] = None

    @classmethod
    def in_python(
        cls,
        channels: Sequence[str | int],
        calibration: Mapping[str, Stated | None],
        rate: str | float | None,
        time: str | int | None,
        time_unit: str | None,
        measurement: int | None = None,
    ) -> MeasurementOptions:
        """Return the options that stand for the arguments of a call.

        Examples
        --------
        >>> MeasurementOptions.in_python([1], {"unit": {"frame": "mV"}}, "1 kHz", None, None).rate
        1000.0
        """
        named = {channels} if isinstance(channels, str | int) else channels
        return cls(
            channel=[str(channel) for channel in named] or None,
            **{name: _words(value) for name, value in calibration.items()},
            rate=None if rate is None else si_value(rate, "Hz", "rate"),
            time=None if time is None else str(time),
            time_unit=None if time_unit is None else read_time_unit(time_unit, "time_unit"),
            measurement=measurement,
        )

    def calibration(self) -> dict[str, dict[str, Any]]:
        """Return what was typed of the calibration, a table a channel; ``all`` for values without one.

        A bare voltage is in V.

        Examples
        --------
        >>> MeasurementOptions(unit=["g", "frame=mV"]).calibration()
        {'all': {'unit': 'g'}, 'frame': {'unit': 'mV'}}
        """
        names = ("unit", "sensitivity", "gain", "excitation", "rated_excitation", "count", "polarity")
        stated: dict[str, dict[str, Any]] = {}
        for name in names:
            for text in getattr(self, name) or ():
                channel, mark, value = text.rpartition("=")
                stated.setdefault(channel.strip() if mark else "all", {})[name] = _stated(name, value.strip())
        return stated

    def reading(self) -> Options:
        """Return what is said of the files."""
        from strikewave.records import Options

        return Options(self.rate, self.time, tuple(self.channel or ()), self.time_unit, self.measurement)


PARAMETERS = {
    "FILE": "paths",
    "--channel": "channels",
    "--frequency": "frequencies",
    "--from": "low",
    "--kind": "kinds",
    "--to": "high",
}
"""Names in Python of the options that have another name there than on the command line."""


@contextlib.contextmanager
def named_for_python() -> Iterator[None]:
    """Name the parameter in an error that would name the option of the command.

    Examples
    --------
    >>> with named_for_python():
    ...     raise InputError("--high-pass", "2", "a frequency")
    Traceback (most recent call last):
    strikewave.base.errors.InputError: high_pass: got "2"; allowed: a frequency
    """
    try:
        yield
    except InputError as error:
        name = PARAMETERS.get(error.field) or error.field.removeprefix("--").replace("-", "_")
        if name == error.field:
            raise
        raise error.at(name) from None


def files_of(paths: str | Path | Sequence[str | Path]) -> list[str]:
    """Return the files that a call names, as `ordered` does."""
    several = [paths] if isinstance(paths, str | Path) else paths
    files = ordered([str(path) for path in several])
    if not files:
        raise InputError("paths", "none", "at least one measured file")
    return files


def ordered(files: Sequence[str]) -> list[str]:
    """Return files in the natural order of their names where they come as a shell lists them, a2 before a10; each once.

    Patterns that the shell left as they are (those of Windows) are replaced by what they find. Files that were named in
    another order than that of the alphabet keep it: it is the order of the test.

    Examples
    --------
    >>> ordered(["a1.csv", "a10.csv", "a2.csv"]), ordered(["b.csv", "a.csv"])
    (['a1.csv', 'a2.csv', 'a10.csv'], ['b.csv', 'a.csv'])
    """
    found: list[str] = []
    for file in files:
        pattern = any(mark in file for mark in "*?[") and not os.path.lexists(file)
        found += sorted(glob.glob(file, recursive=True), key=natural) or [file] if pattern else [file]
    once = {os.path.realpath(file): file for file in reversed(found)}
    files = [file for file in dict.fromkeys(found) if once[os.path.realpath(file)] == file]
    if len(files) < len(found):
        say(f"{len(found) - len(files)} of {len(found)} files were named twice, and are taken once")
    listed = [sorted(files), sorted(files, key=str.casefold), sorted(files, key=_letters)]
    return sorted(files, key=natural) if list(files) in listed else list(files)


def natural(name: str) -> tuple[tuple[str, int, str], ...]:
    """Return a key by which names are sorted with their numbers as numbers.

    Examples
    --------
    >>> sorted(["a10.csv", "a2.csv", "a.csv", "A1.csv"], key=natural)
    ['a.csv', 'A1.csv', 'a2.csv', 'a10.csv']
    """
    stem, ending = os.path.splitext(name)
    parts = re.findall(r"(\D*)(\d{0,30})", stem)
    return (*((words.casefold(), int(digits or -1), digits) for words, digits in parts), (ending, 0, name))


def _letters(name: str) -> str:
    """Return a name as the locales of most shells sort it: without marks and capitals."""
    return re.sub(r"[\W_]", "", name).casefold()


def _stated(name: str, value: str) -> Any:
    """Return a value of the calibration as its table takes it."""
    if name == "polarity":
        if value not in ("1", "+1", "-1"):
            raise InputError("--polarity", value, "1 or -1")
        return int(value)
    from strikewave.records.calibration import check_part

    stated = f"{value} V" if name in ("excitation", "rated_excitation", "count") and is_bare(value) else value
    check_part(name, stated, "--" + name.replace("_", "-"))
    return stated


def is_bare(text: str) -> bool:
    """Tell whether a text is a number without a unit."""
    return typed_number(text) is not None


def check_channels(stated: Mapping[str, Any], known: Iterable[str]) -> None:
    """Refuse a calibration of a channel that no record has, of all that ``known`` names."""
    known = set(known)
    for channel, table in stated.items():
        if channel != "all" and channel not in known:
            option = "--" + next(iter(table)).replace("_", "-")
            allowed = "a channel of the files, by name or number"
            raise InputError(option, f"{channel}=", allowed, nearest(channel, known))


def read_each(files: Sequence[str], options: Options) -> Iterator[tuple[str, Record | Exception]]:
    """Read files one after the other, with a bar on stderr; one that cannot be read gives its error.

    A file of several measurements gives a record of each.
    """
    from strikewave.records import read_measurements

    with progress_bar("reading") if len(files) > 1 else contextlib.nullcontext(lambda share: None) as report:
        for count, file in enumerate(files, start=1):
            try:
                records: Sequence[Record | Exception] = read_measurements(file, options)
            except StrikewaveError as error:
                records = [error]
            for record in records:
                yield file, record
            report(count / len(files))


def read_channels(
    file: str, stated: dict[str, dict[str, Any]], options: Options, filters: Request | None = None
) -> tuple[Record, FileReading]:
    """Read a file and examine the channels that are wanted of it: the first unless one is named.

    Parameters
    ----------
    file, stated, options
        As for `examined_channel`.
    filters : Request, optional
        Whose filters are taken; none by default.
    """
    from strikewave.records import Request, calibrations_beside, read_file, read_record

    record = read_record(file, options)
    check_channels(stated, record.keys)
    wanted = replace(filters or Request(), channels=options.channels or ("1",), calibrations=stated)
    found = read_file(record, calibrations_beside(Path(file)), wanted)
    if not all(reading.channel.step > 0.0 for reading in found.channels):
        raise InputError("FILE", Path(file), "time stamps that differ", "state the sampling rate by --rate")
    return record, found


def examined_channel(
    file: str,
    stated: dict[str, dict[str, Any]],
    options: Options,
    figure: str,
    what: str,
    filters: Request | None = None,
) -> ChannelReading:
    """Read one channel of a file and examine it; a bad one is named on stderr, and used all the same.

    Parameters
    ----------
    file : str
        A measured file.
    stated : dict
        Typed calibration; see `MeasurementOptions.calibration`.
    options : Options
        Options that the user states for the file; its first channel is taken unless one is named.
    figure : str
        Figure wanted of the channel, one of `strikewave.records.health_notice.FIGURES`: defects that harm it are named.
    what : str
        The same in words, such as "the spectrum".
    filters : Request, optional
        Whose filters are taken; none by default.
    """
    record, reading = read_channels(file, stated, options, filters)
    for notice in reading.all_findings:
        if notice.severity != "good" and figure in notice.harms:
            say(f"{notice.severity} [{notice.code}]: {notice.message}")
    if len(reading.channels) > 1 or (not options.channels and len(record.channels) > 1):
        say(f"{what} is that of {reading.channels[0].channel.name}; --channel takes another")
    return reading.channels[0]


def digests_of(paths: Sequence[Path]) -> dict[str, str]:
    """Return the SHA-256 of files, by their paths."""
    digests = {}
    for path in paths:
        if path.is_file():
            with path.open("rb") as file:
                digests[str(path)] = hashlib.file_digest(file, "sha256").hexdigest()
    return digests


UNKNOWN = Source("records", "records", "", "record.toml")
"""Where a result comes from that was made in Python: no command line gives it again."""


@dataclass(frozen=True, kw_only=True)
class AskedResult(ShownResult):
    """A result that its command line and the files it names give again, not a text alone.

    Attributes
    ----------
    origin : Source
        The command line, and the files by their SHA-256: see `source_of`.
    """

    origin: Source = UNKNOWN

    @property
    def label(self) -> str:
        """The title: what was measured has no case."""
        return self.title

    @property
    def test(self) -> Mapping[str, Any]:
        """What the command line names of the test."""
        return self.origin.test

    @property
    def source(self) -> Source:
        """The command line, and the files by their SHA-256."""
        return self.origin


def source_of(kind: str, name: str, paths: Sequence[Path] = (), test: Mapping[str, Any] | None = None) -> Source:
    """Return the source of a result of measured files, or of a command alone: what runs now, and their SHA-256.

    Files are hashed whole, which takes as long as to read them: name them only where the source is written. ``test`` is
    what is stated of the test, see `strikewave.reporting.output_options.Output.stated_test`.
    """
    digests, command, stated = digests_of(paths), asked(), dict(test or {})
    text = origin_text(command, {shown(path): digest for path, digest in digests.items()}, stated)
    return Source(kind, name, text, ORIGIN, digests, command, stated)


def source_of_records(name: str, paths: Sequence[Path], output: Output, usual: str | None) -> Source:
    """Return the source of a result of measured files as ``output`` has it; they are hashed only where it is written.

    ``usual`` is the name of its folder where none is asked for; see `strikewave.reporting.output_options.Output.place`.
    """
    return source_of("records", name, paths if output.writes(usual) else [], output.performed.stated())


def source_in_python(name: str, test: StatedTest | str | Path | None = None) -> Source:
    """Return the source of a result of measured files that a call makes; ``test`` is a file as ``--test`` takes it."""
    from strikewave.cases.stated_test import NO_TEST, load_test

    read = load_test(Path(test)) if isinstance(test, str | Path) else test
    return replace(UNKNOWN, name=name, test=(read or NO_TEST).stated())


def asked() -> str:
    """Return the command line that runs now, as it is to be typed."""
    return shown(shlex.join(["strikewave", *sys.argv[1:]]))


def shown(path: str) -> str:
    r"""Return a path fit for a text file: bytes that are no UTF-8 are written as \\xNN.

    Examples
    --------
    >>> shown("a.csv")
    'a.csv'
    """
    return os.fsencode(path).decode("utf-8", "backslashreplace")
