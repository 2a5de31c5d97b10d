"""Options of the commands record and srs that calls in Python take too: what is examined, how spectra are computed."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import typer

from strikewave.base.errors import InputError
from strikewave.base.units import parse_typed
from strikewave.reporting.options import OptionGroup, Texts, bare_number, one_of, parsed, quantity

if TYPE_CHECKING:
    from strikewave.records import Request

TWO_CHANNELS = "names or numbers of two channels, such as 1,2"
ALLOWED_ROLLING = 'a window, or a window and a hop, times above zero such as "20 ms" or "20 ms,5 ms"'
# Hop of a rolling spectrum over its window, unless said: a blow then lies well inside of one of four windows
HOP = 0.25
KINDS = ("absolute", "displacement", "relative-velocity", "pseudo-velocity", "equivalent-static")  # kinds of spectra


def read_pair(word: str, field: str = "--pair") -> tuple[str, str]:
    """Return the two channels that a pair names.

    Examples
    --------
    >>> read_pair("1,2"), read_pair("left , right")
    (('1', '2'), ('left', 'right'))
    """
    names = [name.strip() for name in word.split(",")]
    if len(names) != 2 or not all(names) or names[0] == names[1]:
        raise InputError(field, word, TWO_CHANNELS)
    return names[0], names[1]


class Rolling(NamedTuple):
    """Window and hop of a rolling spectrum, s, and how they were typed."""

    window: float
    hop: float
    word: str


def read_rolling(word: str, field: str) -> Rolling:
    """Return a window, and a hop after a comma.

    Examples
    --------
    >>> read_rolling("20 ms,5 ms", "--rolling")[:2], read_rolling("0.02", "--rolling")[:2]
    ((0.02, 0.005), (0.02, 0.005))
    """
    try:
        times = [parse_typed(part.strip(), "s", field) for part in word.split(",")]
    except InputError as error:
        raise InputError(field, word, ALLOWED_ROLLING) from error
    if len(times) > 2 or not all(0.0 < time < math.inf for time in times):
        raise InputError(field, word, ALLOWED_ROLLING)
    return Rolling(times[0], times[-1] if len(times) > 1 else HOP * times[0], word)


@dataclass(frozen=True)
class Examination(OptionGroup):
    """Examination of measured records beyond the measures of their blows.

    Attributes
    ----------
    drop_height : str or float
        Free fall before the blow, with a unit or in m; not checked by default.
    base : str or int
        Name or number of the driving channel: the others are measured as responses to its blow.
    columns : str
        ``"channels"``, or ``"repeats"`` where the columns of a file are repeats of one test.
    motion : bool
        True to give velocity and displacement, with their drift: ``.motions`` of the result.
    pair : sequence of str or int
        Two channels that are compared as sensors on one object: ``.pairs`` of the result.
    sensor : str or Path
        Sensor on which the blows are tried: an accelerometer of the table, such as ``"Endevco 7270A-20K"``, or a file
        with ``[[sensor]]`` that ends in ``.toml``; what it leaves of them is ``.sensor`` of the result.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Examination(drop_height="1.2 m", pair=(1, 2)).pair
    ('1', '2')
    """

    drop_height: Annotated[
        Any,
        quantity("--drop-height", si="m", help='Free fall before the blow, such as "1.2 m"; not checked by default.'),
    ] = None
    base: Annotated[
        str | None,
        typer.Option(
            "--base", metavar="CHANNEL", help="Driving channel: the others are responses to its blow; none by default."
        ),
    ] = None
    columns: Annotated[
        Literal["channels", "repeats"],
        typer.Option("--columns", help="What the columns of a file are: channels, or repeats of one test."),
    ] = "channels"
    motion: Annotated[
        bool, typer.Option("--motion", help="Velocity and displacement too, by integration, with their drift.")
    ] = False
    pair: Annotated[
        Any,
        parsed(
            "--pair",
            read=read_pair,
            metavar="CHANNEL,CHANNEL",
            help="Two channels compared as sensors on one object: common and differential motion, delay, gain and "
            "transfer function; none by default.",
        ),
    ] = None
    sensor: Annotated[
        str | None,
        typer.Option(
            "--sensor",
            metavar="MODEL|FILE",
            help="Sensor on which the blows are tried: a known accelerometer, or a .toml file with [[sensor]].",
            show_default=False,
        ),
    ] = None

    def check(self) -> None:
        """Refuse channels by their part in the test where the columns of a file are repeats."""
        for option, value in (("--base", self.base), ("--pair", self.pair and ",".join(self.pair))):
            if value and self.columns == "repeats":
                allowed = "a channel of files whose columns are channels"
                raise InputError(option, value, allowed, "leave out --columns repeats")


@dataclass(frozen=True)
class Spectra(OptionGroup):
    """Settings of shock response spectra, and results that are given with them.

    Attributes
    ----------
    q : float
        Quality factor 1 / (2 damping ratio), or ``math.inf``; 10 by default.
    low, high : str or float
        Lowest and highest natural frequency, with a unit or in Hz; 10 Hz, and 100 kHz or 2/5 of the lowest sampling
        rate, by default.
    per_octave : float
        Number of natural frequencies in an octave; 12 by default.
    frequencies : sequence of str or float
        Natural frequencies, with a unit or in Hz, instead of a range.
    kinds : str or sequence of str
        ``"absolute"``, which is the default, ``"displacement"``, ``"relative-velocity"``, ``"pseudo-velocity"``,
        ``"equivalent-static"``.
    side : str
        ``"maximax"``, ``"positive"`` or ``"negative"``.
    part : str
        ``"total"``, ``"primary"`` (while the shock lasts) or ``"residual"`` (after it).
    end : str or float
        End of the shock in the time of the files, with a unit or in s; the end of the last blow by default.
    resultant : bool
        True to give the vector sum of 2 or 3 perpendicular channels of a file.
    rolling : str, float or (float, float)
        Window, or window and hop, of spectra that slide over the records: ``"20 ms,5 ms"``, or in s.
    initial : str
        Beginning of the records: ``"rest"``, ``"shifted"`` or ``"steady"``.
    rms : bool
        True to give root mean squares of the responses.
    response : str or float
        Natural frequency of an oscillator whose response is given, with a unit or in Hz.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Spectra(q=50, high="20 kHz", kinds="pseudo-velocity").high
    20000.0
    """

    q: Annotated[
        Any,
        bare_number(
            "--q",
            allowed="a quality factor above zero, such as 10 for 5 % of critical damping, or inf",
            help="Quality factor 1 / (2 damping ratio), or inf; 10 by default.",
        ),
    ] = 10.0
    low: Annotated[Any, quantity("--from", si="Hz", help="Lowest natural frequency; 10 Hz by default.")] = 10.0
    high: Annotated[
        Any,
        quantity(
            "--to", si="Hz", help="Highest natural frequency; 100 kHz, or 2/5 of the least sampling rate, by default."
        ),
    ] = None
    per_octave: Annotated[
        Any,
        bare_number(
            "--per-octave",
            high=1e5,
            allowed="a number of frequencies above zero, at most 100 000",
            help="Number of natural frequencies in an octave; 12 by default.",
        ),
    ] = 12.0
    frequencies: Annotated[
        Texts, quantity("--frequency", si="Hz", help="Natural frequency, instead of a range; may be repeated.")
    ] = None
    kinds: Annotated[
        Texts, one_of("--kind", choices=KINDS, help="Kind of spectrum; absolute by default; may be repeated.")
    ] = None
    side: Annotated[
        Literal["maximax", "positive", "negative"], typer.Option("--side", help="Side of the response.")
    ] = "maximax"
    part: Annotated[
        Literal["total", "primary", "residual"],
        typer.Option("--part", help="Part of the response: primary is while the shock lasts, residual after it."),
    ] = "total"
    end: Annotated[
        Any,
        quantity(
            "--end", si="s", signed=True, help="End of the shock in the file's time; its last blow's end by default."
        ),
    ] = None
    resultant: Annotated[
        bool, typer.Option("--resultant", help="Vector sum of 2 or 3 perpendicular channels of a file.")
    ] = False
    rolling: Annotated[
        Any,
        parsed(
            "--rolling",
            read=read_rolling,
            metavar="WINDOW[,HOP]",
            help='Spectra of windows that slide over the record, such as "20 ms" or "20 ms,5 ms"; '
            "a quarter of a window on by default.",
        ),
    ] = None
    initial: Annotated[
        Literal["rest", "shifted", "steady"],
        typer.Option(
            "--initial",
            help="How the record begins: from rest, its first sample taken off all, or at its first sample for ever.",
        ),
    ] = "rest"
    rms: Annotated[
        bool, typer.Option("--rms", help="Root mean square of the responses too, while the record lasts.")
    ] = False
    response: Annotated[
        Any, quantity("--response", si="Hz", help="Natural frequency of an oscillator whose response is written too.")
    ] = None

    @property
    def each_kind(self) -> tuple[str, ...]:
        """Kinds of spectra, each once."""
        kinds: Any = self.kinds
        return tuple(dict.fromkeys(kinds or ["absolute"]))


def filtered_folder(usual: str, request: Request) -> str:
    """Return the usual folder of a result: what is filtered gets one of its own beside what is not.

    Examples
    --------
    >>> from strikewave.records import Request
    >>> from strikewave.signal.filters import HighPass
    >>> filtered_folder("srs-a", Request()), filtered_folder("srs-a", Request(high_pass=HighPass(5.0)))
    ('srs-a', 'srs-a-82cd0941')
    """
    filters = (request.filter, request.ac_coupling, request.high_pass)
    return usual + (f"-{hashlib.sha256(repr(filters).encode()).hexdigest()[:8]}" if any(filters) else "")
