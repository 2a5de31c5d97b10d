"""Parts shared by the commands on measured files: options, reading, and calibration."""

from __future__ import annotations

import contextlib
import functools
import glob
import hashlib
import inspect
import math
import os
import re
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, ParamSpec, TypeVar

import typer

from strikewave.base.errors import InputError, StrikewaveError, nearest
from strikewave.base.result import Source
from strikewave.base.units import parse_quantity, parse_typed, take_apart, typed_number
from strikewave.reporting.options import (
    Decision,
    LowPassOptions,
    OptionGroup,
    Texts,
    Uncertainty,
    low_pass_of,
    parsed,
    quantity,
)
from strikewave.reporting.output_options import ORIGIN, Output, origin_text
from strikewave.reporting.shown_result import ShownResult
from strikewave.reporting.terminal import progress_bar, say

if TYPE_CHECKING:
    from strikewave.cases.performed_test import StatedTest
    from strikewave.records import ChannelReading, FileReading, Options, Record, Request
    from strikewave.signal.filters import Filter
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification

Files = Annotated[
    list[str], typer.Argument(metavar="FILE", help="Measured files of any known format.", show_default=False)
]


def _of_channels(name: str, help: str) -> Any:
    """Return an option of the calibration, which may be said for each channel."""
    each = " [CHANNEL=]VALUE; may be repeated."
    return typer.Option(name, metavar="VALUE", help=help + each, show_default=False)


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
class ChannelOptions(OptionGroup):
    """Channels of a file, their unit and sampling rate."""

    panel: ClassVar[str] = "Reading and calibration"

    channels: Annotated[
        Texts,
        typer.Option(
            "--channel",
            metavar="NAME|NUMBER",
            help="Channel to take; all, or the first, by default; may be repeated.",
            show_default=False,
        ),
    ] = None
    unit: Annotated[Texts, _of_channels("--unit", "Unit of the file's values, such as g or mV.")] = None
    rate: Annotated[
        Any, quantity("--rate", si="Hz", help='Sampling rate of files without a time column, such as "200 kHz".')
    ] = None


@dataclass(frozen=True)
class Calibration(OptionGroup):
    """Calibration of measured channels: a value for all of them, or a mapping from names or numbers of channels.

    It stands over that of a ``calibration.toml`` beside the files.

    Attributes
    ----------
    sensitivity : str or mapping
        Output of the sensor for its input, such as ``"1.2 mV/g"``.
    gain : str, float or mapping
        Gain of the amplifier, such as 10 or ``"10 mV/pC"``.
    excitation, rated_excitation : str, float or mapping
        Bridge voltage in the test, and that which the sensitivity is stated for: with a unit, or in V.
    count : str, float or mapping
        Voltage of one count of the converter: with a unit, or in V.
    polarity : int or mapping
        1, or -1 for a sensor mounted the other way.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Calibration(sensitivity="1.2 mV/g", polarity={"frame": -1}).polarity
    ['frame=-1']
    """

    sensitivity: Annotated[Texts, _of_channels("--sensitivity", 'Sensitivity of the sensor, such as "1.2 mV/g".')] = (
        None
    )
    gain: Annotated[Texts, _of_channels("--gain", 'Gain of the amplifier: 10, or "10 mV/pC".')] = None
    excitation: Annotated[Texts, _of_channels("--excitation", 'Bridge voltage in the test, such as "5 V".')] = None
    rated_excitation: Annotated[
        Texts, _of_channels("--rated-excitation", "Bridge voltage that the sensitivity is stated for.")
    ] = None
    count: Annotated[Texts, _of_channels("--count", 'Voltage of one ADC count, such as "305 uV".')] = None
    polarity: Annotated[Texts, _of_channels("--polarity", "1, or -1 for a sensor mounted the other way.")] = None


@dataclass(frozen=True)
class Reading(OptionGroup):
    """Options for the time column of a measured file, and for the measurement to read.

    Attributes
    ----------
    time : str or int
        Name or number of the column that holds time; found by default.
    time_unit : str
        Unit of that column, such as ``"ms"`` or ``"10 us"``; that of the file, or s, by default.
    measurement : int
        Number of the measurement of a file to take, from 1; each as a record of its own by default.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Reading(time="clock", time_unit="ms").time_unit
    0.001
    """

    time: Annotated[
        str | None,
        typer.Option(
            "--time", metavar="NAME|NUMBER", help="Column that holds time; found by default.", show_default=False
        ),
    ] = None
    time_unit: Annotated[
        Any,
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


@dataclass(frozen=True)
class MeasurementOptions(Reading, Calibration, ChannelOptions):
    """Options for reading files, and the calibration of their channels."""

    @classmethod
    def of(
        cls,
        channels: Any = None,
        unit: Any = None,
        rate: str | float | None = None,
        calibration: Calibration | None = None,
        reading: Reading | None = None,
    ) -> MeasurementOptions:
        """Return the options that stand for the arguments of a call.

        Examples
        --------
        >>> MeasurementOptions.of([1], {"frame": "mV"}, "1 kHz").rate
        1000.0
        """
        return cls(channels, unit, rate, **vars(calibration or Calibration()), **vars(reading or Reading()))

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

        return Options(self.rate, self.time, self.names, self.time_unit, self.measurement)

    @property
    def names(self) -> tuple[str, ...]:
        """Channels to take; none for all."""
        channels: Any = self.channels
        return tuple(channels or ())


def _time_constant(word: str, field: str) -> str | float:
    """Return the time constant of AC coupling, s, or ``auto``.

    Examples
    --------
    >>> _time_constant("auto", ""), _time_constant("1.6 ms", ""), round(_time_constant("100 Hz", ""), 6)
    ('auto', 0.0016, 0.001592)
    """
    if word.strip() == "auto":
        return "auto"
    typed = take_apart(word)
    unit = "" if typed is None else typed.unit
    try:
        value = parse_typed(word, "Hz" if "Hz" in unit else "s", field)
    except InputError as error:
        raise InputError(field, word, ALLOWED_COUPLING) from error
    if not 0.0 < value < math.inf:
        raise InputError(field, word, ALLOWED_COUPLING)
    return 1.0 / (2.0 * math.pi * value) if "Hz" in unit else value


ALLOWED_COUPLING = 'auto, a time constant above zero such as "1.6 ms", or a cutoff such as "100 Hz"'


@dataclass(frozen=True)
class Filtering(LowPassOptions):
    """Filters that records go through before they are measured.

    Attributes
    ----------
    cutoff : str, float or Filter
        Zero-phase low-pass: its cutoff, with a unit or in Hz, or a filter; none by default.
    cfc : float
        Class of an SAE J211 filter, such as 1000, instead of a cutoff.
    ac_coupling : str or float
        AC coupling that is taken off: ``"auto"``, a time constant, with a unit or in s, or a cutoff such as
        ``"100 Hz"``.
    high_pass : str or float
        Cutoff of a zero-phase high-pass, with a unit or in Hz.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Filtering(cfc=1000, ac_coupling="1.6 ms").ac_coupling
    0.0016
    """

    ac_coupling: Annotated[
        Any,
        parsed(
            "--ac-coupling",
            read=_time_constant,
            help='AC coupling to take off: auto, a time constant such as "1.6 ms", or a cutoff such as "100 Hz"; '
            "none by default.",
            metavar="auto|TIME|FREQUENCY",
        ),
    ] = None
    high_pass: Annotated[
        Any, quantity("--high-pass", si="Hz", help="Zero-phase high-pass, -3 dB for both passes; none by default.")
    ] = None

    @classmethod
    def of(cls, filter: str | float | Filter | Filtering | None) -> Filtering:
        """Return the filters that a call names, which may be a low-pass alone."""
        return filter if isinstance(filter, Filtering) else cls(low_pass_of(filter))

    def on(self, request: Request) -> Request:
        """Return a request with these filters."""
        from strikewave.signal.filters import HighPass

        high_pass = None if self.high_pass is None else HighPass(self.high_pass)
        coupling = "" if self.ac_coupling is None else self.ac_coupling
        return replace(request, filter=self.low_pass(), ac_coupling=coupling, high_pass=high_pass)


def complete_specification(incomplete: str) -> list[str]:
    """Return the built-in specifications that begin so, with their conditions."""
    from strikewave.specifications.reading import asked_names

    return [name for name in asked_names() if name.startswith(incomplete)]


Spec = Annotated[
    str | None,
    typer.Option(
        "--spec",
        metavar="NAME|FILE[:CONDITION]",
        help="Specification to judge by, see strikewave spec list; none by default.",
        show_default=False,
        autocompletion=complete_specification,
        rich_help_panel="Specification",
    ),
]


@dataclass(frozen=True)
class DecisionOptions(OptionGroup):
    """Decision rule of a verdict, and the uncertainty of what is judged."""

    decision: Decision = "simple"
    uncertainty: Uncertainty = None

    def __post_init__(self) -> None:
        """Read what Python gives, where a number is a share."""
        if isinstance(self.uncertainty, int | float):
            object.__setattr__(self, "uncertainty", f"{100.0 * self.uncertainty:g} %")
        super().__post_init__()

    def check_only(self, group: type[DecisionOptions], function: str) -> None:
        """Refuse what a function does not take, of all that ``record`` does."""
        known = {"test", *(field.name for field in fields(group))}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name not in known and value != field.default:
                raise InputError(field.name, value, f"none with {function}", "leave it out")


@dataclass(frozen=True)
class SpectraJudging(DecisionOptions):
    """Options of the verdict on spectra by a specification."""

    panel: ClassVar[str] = "Specification"

    strict: Annotated[bool, typer.Option("--strict", help="State no verdict by limits that are from memory.")] = False

    def specification(self, spec: str | None) -> Specification | None:
        """Return the specification of a name; None for none, which leaves nothing to decide."""
        from strikewave.specifications.reading import load_specification

        if spec is not None:
            return load_specification(spec)
        for field in fields(self):
            if field.name not in ("uncertainty", "test") and getattr(self, field.name) != field.default:
                option = "--" + field.name.replace("_", "-")
                raise InputError(option, "no --spec", "only with a specification", "add --spec NAME")
        return None


@dataclass(frozen=True)
class RecordJudging(SpectraJudging):
    """Options of the verdict on records, with what only the user knows of their shocks."""

    direction: Annotated[
        Texts,
        typer.Option(
            "--direction",
            metavar="[FILES][#CHANNEL]=DIRECTION",
            help="Direction of the shocks, such as +x, 'up*.csv=-z' or 'shot.csv#2=+y'; may be repeated.",
            show_default=False,
        ),
    ] = None
    cross_axis: Annotated[
        Texts,
        typer.Option(
            "--cross-axis",
            metavar="[FILES#]CHANNEL",
            help="Channel that measures across the shock, such as y or 'x*.csv#y'; may be repeated.",
            show_default=False,
        ),
    ] = None

    def asked(self, test: Mapping[str, Any]) -> Asked:
        """Return how records are judged; the direction that a test states holds where no option does."""
        from strikewave.specifications.judged_records import Asked, read_direction

        stated: Any = self.direction
        across: Any = self.cross_axis
        words = [("--direction", word) for word in stated or ()]
        if test.get("direction") and not stated:
            words = [("test.direction", test["direction"])]
        directions = [read_direction(word, option) for option, word in words]
        return Asked(self.decision, self.strict, self.uncertainty, directions, tuple(across or ()))


@dataclass(frozen=True)
class Judging(RecordJudging):
    """Options for judging measured records, and the uncertainty of the measurement.

    Attributes
    ----------
    decision : str
        ``"simple"``, or ``"guarded"`` by the expanded uncertainty.
    uncertainty : str, float or Path
        Expanded uncertainty (k = 2) of the acceleration, such as ``"5 %"`` or 0.05, or a TOML file with an uncertainty
        budget; that of noise and baseline alone by default.
    strict : bool
        True to state no verdict by limits that are from memory.
    direction : str or sequence of str
        Direction of the shocks, such as ``"+x"`` or ``"up*.csv=-z"``.
    cross_axis : str, int or sequence of them
        Names or numbers of channels that measure across the shock.
    test : str or Path
        TOML file that says what was tested, by whom and when, for the head of the report.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Judging(decision="guarded", uncertainty="5 %").uncertainty.share
    0.05
    """

    test: str | Path | None = None

    @property
    def performed(self) -> StatedTest | None:
        """Statements of that file."""
        from strikewave.cases.performed_test import load_test

        return None if self.test is None else load_test(Path(self.test), "test")


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
        option, space, rest = error.field.partition(" ")  # of a file: "--sensor sensor.frame"
        if not (option.startswith("--") or option in PARAMETERS):
            raise
        name = PARAMETERS.get(option) or option.removeprefix("--").replace("-", "_")
        raise error.at(name + space + rest) from None


P = ParamSpec("P")
R = TypeVar("R")


def with_groups(**groups: type[OptionGroup]) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return what makes a function of Python name its parameters in errors, and the group that took one over.

    Examples
    --------
    >>> @with_groups(calibration=Calibration)
    ... def measure(file, *, calibration=Calibration()): ...
    >>> measure("a.csv", gain=10)
    Traceback (most recent call last):
    strikewave.base.errors.InputError: gain: got 10; allowed: calibration=strikewave.Calibration(gain=...)
    """

    def named(function: Callable[P, R]) -> Callable[P, R]:
        known = inspect.signature(function).parameters

        @functools.wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            for name in kwargs.keys() - known.keys():
                for keyword, group in groups.items():
                    if name in {field.name for field in fields(group)}:
                        allowed = f"{keyword}=strikewave.{group.__name__}({name}=...)"
                        raise InputError(name, kwargs[name], allowed)
            with named_for_python():
                return function(*args, **kwargs)

        return called

    return named


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
        Request whose filters are taken; none by default.
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
        Request whose filters are taken; none by default.
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
"""Source of a result that was made in Python: no command line gives it again."""


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
        """Statements about the test on the command line."""
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
    from strikewave.cases.performed_test import NO_TEST, load_test

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
