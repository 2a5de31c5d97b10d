"""Parts shared by the readers: named arrays become channels, time is found, sizes are checked before reading."""

from __future__ import annotations

import importlib
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.base.errors import InputError, MissingPackageError, nearest
from strikewave.base.texts import first_few, plain
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import LARGEST_ARRAY, Options
from strikewave.records.readers.headings import PICO, is_time, name_and_unit, seconds_in, step_of, to_seconds
from strikewave.records.readers.long_table import Labels, as_asked, as_long_table, labels_of, may_count
from strikewave.records.record import Array, Channel, Record

# A file with more arrays is refused: no recorder has as many channels, and each takes time to look at
MOST_ARRAYS = 10_000
MOST_COLUMNS = 64  # a 2-D array whose short side is longer is no table of channels: pictures and maps are wider
LARGEST_RATIO = 1000.0  # bytes claimed for each in the file: Deflate packs 1032 to 1 at best, measured records 10 to 1
# Bytes that any file may claim, however small: no machine is harmed by them. A constant record packs as well as that
FREE_BYTES = 256 * 2**20
LONGEST_TEXT = 200  # characters of an attribute that is shown: a line or two
ONE_MEASUREMENT = 3600.0  # s between begins of channels of one measurement: blows and shots last seconds
# Arrays named in a finding, and `LONGEST_NAMED` characters of each: enough to know them, few enough for a line
MOST_NAMED = 8
LONGEST_NAMED = 40  # see `MOST_NAMED`

# Names of arrays that hold time; others that only sound like it do so where none of these is there
TIMES = {"time", "t", "times", "timestamp", "timestamps", "zeit", "temps"}
# Names that are time in text, where columns are few, and more often something else in files of named arrays
_AXES = {"x", "s"}
# Names of attributes and scalars that hold a sampling rate, Hz
_RATES = {
    "fs", "sampling_rate", "sample_rate", "samplerate", "samplingrate", "sampling_frequency", "samplefreq", "rate",
}  # fmt: skip
# Those of a step, s
_STEPS = {"dt", "wf_increment", "sampling_interval", "sample_interval", "sampling_period", "delta_t", "time_step"}
_STARTS = {"t0", "start_time", "wf_start_offset", "starttime"}  # those of the time of the first sample, s


class ArrayColumn(NamedTuple):
    """One array of a file that is not loaded yet."""

    name: str  # as the file has it, with ``folder/`` before it where the file has folders
    size: int  # number of samples
    load: Callable[[], Any]  # returns the samples
    unit: str = ""  # as the file writes it; empty where it has none
    # Uniform sampling of this array by the file, s; NaN where it states none
    step: float = math.nan
    start: float = math.nan
    folder: str = ""  # arrays of the same folder share their time
    time: bool = False  # true where the file marks this array as time
    origin: int | None = None  # clock time from which ``start`` counts, ps; None where the file states none
    # Where the array holds words: all that there are; ``load`` returns their places, NaN for none
    words: tuple[str, ...] = ()


def damaged(path: Path, hint: str, allowed: str = "a file that is whole") -> InputError:
    """Return the error for a file that is wrong."""
    return InputError("FILE", path, allowed, hint)


def extra(module: str, path: Path) -> Any:
    """Import a module that comes with the extra ``formats``; an error tells how to install it."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise MissingPackageError(path.name, module.partition(".")[0], "formats") from None


def check_count(path: Path, count: int) -> None:
    """Refuse a file with more than `MOST_ARRAYS` arrays."""
    if count > MOST_ARRAYS:
        raise damaged(path, f"it has {count}", f"a file with at most {MOST_ARRAYS} arrays")


def guard(path: Path, claimed: float, compressed: bool = True) -> None:
    """Refuse a file that claims more bytes than it can hold, or more than fit.

    ``claimed`` are bytes of samples, as float64 where they are ``compressed`` and may exceed the size of the file.
    """
    size = path.stat().st_size
    if not compressed and claimed > size:
        raise damaged(path, f"it claims {claimed:.4g} bytes of samples and has {size}")
    if claimed > LARGEST_ARRAY or (claimed > FREE_BYTES and claimed > LARGEST_RATIO * size):
        raise damaged(path, f"it claims {claimed:.4g} bytes of samples", "a file that fits into memory")


def text(value: object) -> str:
    """Return an attribute as one line of text; empty for what is none."""
    while isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    return " ".join(value.split())[:LONGEST_TEXT] if isinstance(value, str) else ""


def number(value: object) -> float:
    """Return an attribute as a finite float; NaN for what is none."""
    try:
        array = np.asarray(value)
        parsed = float(array.reshape(-1)[0]) if array.size == 1 and array.dtype.kind in "biuf" else float(text(value))
    except (ValueError, TypeError, OverflowError):
        return math.nan
    return parsed if math.isfinite(parsed) else math.nan


def grid_of(attributes: Iterable[tuple[str, object]]) -> tuple[float, float]:
    """Return step and start, s, from named attributes or scalars such as ``fs`` or ``dt``; NaN without them."""
    step = start = math.nan
    for name, value in attributes:
        word, unit = name_and_unit(name.rpartition("/")[2])
        word = word.strip().lower().replace(" ", "_")
        factor = {"khz": 1e3, "mhz": 1e6}.get(unit.lower(), 1.0)
        if word in _RATES and number(value) > 0.0:
            step = 1.0 / (number(value) * factor)
        elif word in _STEPS and number(value) > 0.0:
            step = number(value) * (seconds_in(unit) or 1.0)
        elif word in _STARTS:
            start = number(value) * (seconds_in(unit) or 1.0)
    return step, start


def on_grids(
    columns: Sequence[ArrayColumn], attributes: Mapping[str, Iterable[tuple[str, object]]]
) -> list[ArrayColumn]:
    """Give the longest arrays of each folder the step and start that attributes or scalars of the folder state."""
    grids = {folder: grid_of(named) for folder, named in attributes.items()}
    longest: dict[str, int] = {}
    for column in columns:
        longest[column.folder] = max(column.size, longest.get(column.folder, 0))
    return [
        column._replace(step=grids[column.folder][0], start=grids[column.folder][1])
        if math.isnan(column.step) and column.folder in grids and column.size == longest[column.folder]
        else column
        for column in columns
    ]


def floats(values: Any) -> Array:
    """Return samples as float64: masked ones become NaN, dates seconds since the first; no objects, no text."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(values)
    if array.dtype.kind in "mM":
        since = array - array[:1] if array.dtype.kind == "M" else array
        seconds = since.astype("timedelta64[ns]").astype(np.float64) * 1e-9
        seconds[np.isnat(since)] = np.nan
        return np.ascontiguousarray(seconds.reshape(-1))
    if array.dtype.kind not in "biuf":
        raise TypeError(f"samples of type {array.dtype}")
    return np.ascontiguousarray(array.reshape(-1), dtype=np.float64)


class Scaled:
    """Slices of an array with scale, offset and fill value of the CF conventions applied.

    ``load`` returns a slice as a new float64 array, ``attribute`` what a name stands for, None for none.
    """

    def __init__(
        self, load: Callable[[Any], Array], attribute: Callable[[str], object], shape: tuple[int, ...]
    ) -> None:
        self.load, self.attribute, self.shape = load, attribute, shape

    def __getitem__(self, key: Any) -> Array:
        values = self.load(key)
        for name in ("_FillValue", "missing_value"):
            values[values == number(self.attribute(name))] = np.nan
        scale, offset = number(self.attribute("scale_factor")), number(self.attribute("add_offset"))
        if not np.isnan(scale):
            values *= scale
        return values if np.isnan(offset) else values + offset


def array_columns(name: str, array: Any, unit: str = "", folder: str = "", **details: Any) -> list[ArrayColumn]:
    """Return the columns of a 1-D or 2-D array that is sliced only when a column is loaded; none for another one."""
    shape = array.shape
    long = [extent for extent in shape if extent != 1]
    if len(long) == 1 or (len(shape) == 1 and shape[0]):
        return [ArrayColumn(name, int(np.prod(shape)), lambda: array[...], unit, folder=folder, **details)]
    if len(long) != 2 or len(shape) != 2 or min(shape) > MOST_COLUMNS or min(shape) < 1:
        return []
    across = shape[0] < shape[1]

    def load(k: int) -> Callable[[], Any]:
        return (lambda: array[k, :]) if across else (lambda: array[:, k])

    return [
        ArrayColumn(f"{name} {k + 1}", max(shape), load(k), unit, folder=folder, **details) for k in range(min(shape))
    ]


def assemble(
    path: Path,
    form: str,
    columns: Sequence[ArrayColumn],
    options: Options,
    grid: tuple[float, float] = (math.nan, math.nan),
    findings: Iterable[HealthNotice] = (),
) -> Record:
    """Make a record of a file's arrays.

    Parameters
    ----------
    path : Path
        The file.
    form : str
        Name of the format.
    columns : sequence of ArrayColumn
        Arrays of the file, in their order. Where the caller wants only some channels, the others keep their place and
        are NaN, at no cost in memory.
    options : Options
        ``rate`` overrules every time, ``time`` names the time array.
    grid : tuple of float
        Step and start, s, that hold for the whole file; NaN where it states none.
    findings : iterable of HealthNotice
        Findings of reading so far.
    """
    columns = [column for column in columns if column.size]
    labels, columns = [c for c in columns if c.words], [c for c in columns if not c.words]
    named = labels + [c for c in columns if may_count(_named(c)[0].removeprefix(c.folder) or "-", "1")]
    if named and (table := _long_table(path, form, (columns, named), options, grid, findings)) is not None:
        return table
    findings = (*findings, *left_out([column.name for column in labels]))
    if not columns:
        raise damaged(path, "it has no arrays of numbers", "a file with samples")
    check_count(path, len(columns))
    clocks = _clocks(columns, options)
    with_clock = list(_with_clocks(_others(columns, clocks), clocks))
    channels_with_clock, ignored = _kept(with_clock, bool(clocks) and options.rate is None)
    if not channels_with_clock:
        raise damaged(path, "it has nothing but time", "a file with samples")
    if options.time_unit is not None and not any(clock for _, clock in channels_with_clock):
        hint = "no array of it is: name it by --time"
        raise InputError("--time-unit", f"{options.time_unit:g} s", "a file with time", hint)
    names = one_each([_named(column)[0] for column, _ in channels_with_clock])
    wanted = _wanted(path, names, [column for column, _ in channels_with_clock], options)
    guard(path, 8.0 * sum(column.size for (column, _), want in zip(channels_with_clock, wanted, strict=True) if want))
    stamps: dict[int, tuple[Array, float, float]] = {}
    channels = []
    for (column, clock), want, name in zip(channels_with_clock, wanted, names, strict=True):
        channels.append(replace(_channel(column, clock, want, options, grid, stamps), name=name))
    origins = [(column if clock is None else clock).origin for column, clock in channels_with_clock]
    channels, later = begin_together(channels, origins)
    return Record(str(path), form, tuple(channels), (*findings, *later, *left_out([c.name for c in ignored])))


def _long_table(
    path: Path,
    form: str,
    columns: tuple[Sequence[ArrayColumn], Sequence[ArrayColumn]],
    options: Options,
    grid: tuple[float, float],
    findings: Iterable[HealthNotice],
) -> Record | None:
    """Return the record of arrays of which some may name the channel of each line; None where none does."""
    arrays, named = columns
    size = named[0].size
    values = [column for column in arrays if column not in named]
    if not values or any(column.size != size or column.folder != named[0].folder for column in (*arrays, *named)):
        return None
    guard(path, 8.0 * size * (len(arrays) + len(named)))
    labels = []
    for column in named:
        heading, codes = _named(column)[0].removeprefix(column.folder), floats(column.load())
        if column.words or np.array_equal(codes, np.round(codes)):
            labels.append(Labels(heading, codes, column.words) if column.words else labels_of(heading, codes))
    record = assemble(path, form, values, options._replace(channels=(), rate=None), grid, findings)
    shared = {id(channel.stamps) for channel in record.channels}
    table = as_long_table(record, labels) if len(shared) == 1 and labels else None
    return None if table is None else as_asked(table, options)


def _lasting(seconds: float) -> str:
    """Write a time that passed, s, in the unit that leaves one to three digits before the point."""
    sizes = ((86400.0, "d"), (3600.0, "h"), (1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns"))
    size, unit = next((pair for pair in sizes if seconds >= pair[0]), sizes[-1])
    return f"{plain(seconds / size, 6)}\xa0{unit}"


def begin_together(
    channels: Sequence[Channel], origins: Sequence[int | None]
) -> tuple[list[Channel], list[HealthNotice]]:
    """Lay channels on one clock: each begins as much later as its clock time is after the earliest one.

    ``origins`` are clock times, ps; None where the file states none, and the channel is left as it is.
    """
    stated = [origin for origin in origins if origin is not None]
    if len(set(stated)) < 2:
        return list(channels), []
    first = min(stated)
    moved, late = [], []
    for channel, origin in zip(channels, origins, strict=True):
        shift = 0.0 if origin is None else (origin - first) / PICO
        stamps = None if channel.stamps is None else channel.stamps + shift
        moved.append(replace(channel, start=channel.start + shift, stamps=stamps) if shift else channel)
        late += [f"{channel.name} by {_lasting(shift)}"] * (shift > 0.0)
    unknown = [channel.name for channel, origin in zip(channels, origins, strict=True) if origin is None]
    message = f"the channels begin at different times, and are laid on one clock; later: {first_few(late, MOST_NAMED)}"
    apart = (max(stated) - first) / PICO
    if apart > ONE_MEASUREMENT:
        message += "; starts more than an hour apart are those of different measurements as a rule: read them apart"
    findings = [HealthNotice("start-times", message, apart, severity="suspect" if apart > ONE_MEASUREMENT else "good")]
    if unknown:
        message = f"{first_few(unknown, MOST_NAMED)}: no start time is stated, while that of other channels is"
        findings.append(HealthNotice("start-unknown", message, float(len(unknown))))
    return moved, findings


def left_out(names: Sequence[str]) -> tuple[HealthNotice, ...]:
    """Return the word on arrays that are no channels."""
    if not names:
        return ()
    listed = ", ".join(str(name)[:LONGEST_NAMED] for name in names[:MOST_NAMED])
    message = f"{len(names)} arrays are no channels: {listed}{', ...' if len(names) > MOST_NAMED else ''}"
    return (HealthNotice("array-ignored", message, len(names), severity="good"),)


def one_each(names: Sequence[str]) -> list[str]:
    """Give names that come again a number.

    Examples
    --------
    >>> one_each(["a", "b", "a"])
    ['a', 'b', 'a (2)']
    """
    taken: dict[str, None] = {}
    times: Counter[str] = Counter()
    for name in names:
        unique = name
        while unique in taken:
            times[name] += 1
            unique = f"{name} ({times[name] + 1})"
        taken[unique] = None
    return list(taken)


def _clocks(columns: Sequence[ArrayColumn], options: Options) -> list[ArrayColumn]:
    """Return the arrays that hold time: the one that the user names, else those that the file or their name tells."""
    if options.time is not None:
        wanted, names = str(options.time).strip(), [column.name for column in columns]
        chosen = [c for c in columns if wanted in (c.name, _named(c)[0])]
        bare = [c for c in columns if wanted in (c.name.removeprefix(c.folder), _named(c)[0].removeprefix(c.folder))]
        if bare and len(bare) == len({column.folder for column in bare}):
            return bare  # one in each sheet or group
        if not chosen and wanted.isdecimal() and 1 <= int(wanted) <= len(columns):
            chosen = [columns[int(wanted) - 1]]
        if not chosen:
            raise InputError("--time", options.time, "the name or number of an array", nearest(wanted, names))
        return chosen[:1]
    marked = [column for column in columns if column.time]
    lowered = [_named(column)[0].removeprefix(column.folder).lower() for column in columns]
    named = [column for column, word in zip(columns, lowered, strict=True) if word in TIMES]
    if not marked + named:
        named = [c for c, word in zip(columns, lowered, strict=True) if word not in _AXES and is_time(word, "")]
    return marked + _others(named, marked)


def _others(columns: Iterable[ArrayColumn], left: Iterable[ArrayColumn]) -> list[ArrayColumn]:
    """Return columns without those that are left out."""
    without = {id(column) for column in left}
    return [column for column in columns if id(column) not in without]


def _with_clocks(
    columns: Iterable[ArrayColumn], clocks: Iterable[ArrayColumn]
) -> Iterator[tuple[ArrayColumn, ArrayColumn | None]]:
    """Yield columns with the first clock of their size in their folder, or else in any; None without one."""
    first: dict[tuple[int, str | None], ArrayColumn] = {}
    for clock in clocks:
        first.setdefault((clock.size, clock.folder), clock)
        first.setdefault((clock.size, None), clock)
    for column in columns:
        yield column, first.get((column.size, column.folder)) or first.get((column.size, None))


def _kept(
    with_clock: list[tuple[ArrayColumn, ArrayColumn | None]], timed: bool
) -> tuple[list[tuple[ArrayColumn, ArrayColumn | None]], list[ArrayColumn]]:
    """Keep the arrays over time; without time those with a grid of their own, else those of the fullest length."""
    keep = [pair for pair in with_clock if pair[1] is not None or not math.isnan(pair[0].step)]
    if not keep:
        sizes = Counter(column.size for column, _ in with_clock)
        fullest = max(sizes, key=lambda size: (size * sizes[size], size), default=0)
        keep = [pair for pair in with_clock if pair[0].size == fullest and not timed]
    return keep, _others((column for column, _ in with_clock), (column for column, _ in keep))


def _wanted(path: Path, names: Sequence[str], columns: Sequence[ArrayColumn], options: Options) -> list[bool]:
    """Tell of each column whether it is wanted; a name as it stands in the file is as good as that of the channel."""
    files_own = {column.name: name for name, column in zip(reversed(names), reversed(columns), strict=True)}
    units = [_named(column)[1] for column in columns]
    blank = [Channel(name, np.empty(0), unit=unit) for name, unit in zip(names, units, strict=True)]
    asked = [files_own.get(str(word).strip(), word) for word in options.channels]
    chosen = {channel.name for channel in Record(str(path), "", tuple(blank)).only(asked).channels}
    return [name in chosen for name in names]


def _channel(
    column: ArrayColumn,
    clock: ArrayColumn | None,
    wanted: bool,
    options: Options,
    grid: tuple[float, float],
    stamps: dict[int, tuple[Array, float, float]],
) -> Channel:
    """Load one channel and lay it on its grid."""
    name, unit = _named(column)
    step, start = (
        own if not math.isnan(own) else of for own, of in zip((column.step, column.start), grid, strict=True)
    )
    own_stamps = None
    if options.rate is not None:
        step = 1.0 / options.rate
    elif clock is not None and wanted:
        if id(clock) not in stamps:
            stamps[id(clock)] = _stamps(clock, options.time_unit)
        own_stamps, step, start = stamps[id(clock)]
    values = floats(column.load()) if wanted else np.broadcast_to(np.float64(np.nan), (column.size,))
    if own_stamps is not None and own_stamps.size != values.size:
        own_stamps = None
    start = 0.0 if math.isnan(start) else start
    return Channel(name, values, step, start, unit, own_stamps)


def _named(column: ArrayColumn) -> tuple[str, str]:
    """Return name and unit, the unit from the name where the file does not state it."""
    own = column.name.removeprefix(column.folder)
    name, unit = name_and_unit(own)
    return column.name[: len(column.name) - len(own)] + (name or own), column.unit or unit


def _stamps(clock: ArrayColumn, unit: float | None) -> tuple[Array, float, float]:
    """Return time stamps, s, with their step and start; seconds of a unit that is stated overrule that of the file."""
    with np.errstate(all="ignore"):
        stamps = to_seconds(floats(clock.load()).copy(), _named(clock)[1], unit)
        step = step_of(stamps, 0.0)
    start = float(stamps[0]) if stamps.size else math.nan
    return stamps, step if math.isfinite(step) else math.nan, start
