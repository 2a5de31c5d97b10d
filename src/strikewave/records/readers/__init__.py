"""Read a measured file of any known format; the format is found by content, never by name.

Each format has ``sniff_FORMAT`` (do these first bytes begin such a file?) and ``read_FORMAT`` (path and options in,
record out) in a module of this folder. Every file is taken as hostile: nothing in it is run, sizes it claims are
checked against its true size before memory is taken, and whatever is wrong with it ends in an `InputError`.

Where time begins anew in a file, it holds several measurements: each is a record of its own.
"""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import EXISTING_FILE, InputError, StrikewaveError, show
from strikewave.records.health_notice import HealthNotice
from strikewave.records.record import Array, Channel, Record

# Module of each format, in the order in which they are asked; text, which takes almost anything, comes last
FORMATS = {
    "tdms": "recorders", "mdf": "recorders", "ide": "recorders", "rigol": "recorders",
    "hdf": "containers", "mat": "containers", "netcdf": "containers", "parquet": "tables",
    "wav": "recorders", "uff": "recorders", "excel": "tables", "lvm": "lvm", "text": "text",
}  # fmt: skip
HEAD = 8192  # bytes shown to ``sniff``: HDF5 may begin behind a user block of 4096
# A file whose channels would take more bytes in memory is refused: 2 thousand million samples, what a workstation holds
LARGEST_ARRAY = 16 * 2**30


SHORTEST_STEP, LONGEST_STEP = 1e-15, 1e6  # s: the fastest oscilloscopes take 4e-12; a million are twelve days


class Options(NamedTuple):
    """Statements of the user about a file, which the file itself lacks.

    Attributes
    ----------
    rate : float or None
        Sampling rate, Hz, for files without time; overrules a time column.
    time : str or None
        Name or number (from 1) of the column that holds time.
    channels : tuple of str
        Names or numbers of the channels wanted, where reading fewer saves memory; empty for all.
    time_unit : float or None
        Seconds of one number of the time column; overrules the unit that the file states.
    measurement : int or None
        Number of the measurement to take, from 1.
    """

    rate: float | None = None
    time: str | None = None
    channels: tuple[str, ...] = ()
    time_unit: float | None = None
    measurement: int | None = None


def _of_folder(folder: Path) -> str:
    """Return words that lead from a folder to its files, by the ending that most of them have."""
    endings = Counter(file.suffix for file in folder.iterdir() if file.suffix and file.is_file())
    most = max(endings, key=lambda ending: (endings[ending], ending), default="")
    return f'this is a folder; name its files: "{folder}/*{most}"'


def read_record(path: str | Path, options: Options = Options()) -> Record:  # noqa: B008  (a tuple, frozen)
    r"""Read a file of any known format that holds one measurement, or the one that is asked for.

    Parameters
    ----------
    path : str or Path
        The file; its content says which format it has.
    options : Options, optional
        Statements that the file lacks: sampling rate (Hz), column of time, channels wanted, unit of time (s).

    Returns
    -------
    Record
        Channels as arrays over their times, s, each in the unit that the file states.

    Raises
    ------
    InputError
        If the file cannot be read, is empty, of no known format, damaged, or needs an extra that is missing; if it
        holds several measurements and none is chosen.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "blow.txt"
    ...     _ = file.write_text("time [ms], board [g]\n0.00, 1\n0.01, 5\n0.02, 2\n0.03, 1\n")
    ...     record = read_record(file)
    >>> [(c.name, c.unit, c.values.tolist(), round(c.step, 9)) for c in record.channels]
    [('board', 'g', [1.0, 5.0, 2.0, 1.0], 1e-05)]
    """
    records = read_measurements(path, options)
    if len(records) > 1:
        hint = f"{path} holds {len(records)}, each over a time of its own: take one, or save each as a file"
        raise InputError("--measurement", "none", f"a number from 1 to {len(records)}", hint)
    return records[0]


def read_measurements(path: str | Path, options: Options = Options()) -> list[Record]:  # noqa: B008
    r"""Read every measurement of a file: one of most files, several where time begins anew in it.

    Each is a record of its own, called as the file with its number; no interval is known from one to the next.

    Parameters
    ----------
    path, options
        As for `read_record`; ``measurement`` takes one of them.

    Examples
    --------
    >>> import tempfile
    >>> lines = "".join(f"{0.01 * k:.2f}, {k}\n" for k in range(20))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "blows.txt"
    ...     _ = file.write_text("time [ms], board [g]\n" + lines + lines)
    ...     records = read_measurements(file)
    >>> [(record.path.rpartition(": ")[2], record.channels[0].values.size) for record in records]
    [('measurement 1', 20), ('measurement 2', 20)]
    """
    record_of_file = _read_whole(path, options)
    records = [replace(record_of_file, further=()), *record_of_file.further]
    several = len(records) > 1
    for number, record in enumerate(records, start=1):
        _check_steps(record)
        if several:
            message = f"the file holds {len(records)} measurements: each is a record, with no interval to the next"
            notice = HealthNotice("measurements", message, float(len(records)), severity="good")
            findings = (notice, *record.findings)
            records[number - 1] = replace(record, path=f"{path}: measurement {number}", findings=findings)
    if options.measurement is None:
        return records
    if not 1 <= options.measurement <= len(records):
        holds = "one measurement" if len(records) == 1 else f"{len(records)} measurements"
        allowed = f"a number from 1 to {len(records)}"
        raise InputError("--measurement", options.measurement, allowed, f"it holds {holds}")
    return [records[options.measurement - 1]]


def _read_whole(path: str | Path, options: Options) -> Record:
    """Read a file, with its further measurements behind the first."""
    file = Path(path)
    if options.rate is not None and not 1.0 / LONGEST_STEP <= options.rate <= 1.0 / SHORTEST_STEP:
        allowed = f"a sampling rate of {1.0 / LONGEST_STEP:g} to {1.0 / SHORTEST_STEP:g} Hz"
        raise InputError("--rate", options.rate, allowed)
    if options.time_unit is not None and options.rate is not None:
        hint = "the rate overrules all times"
        raise InputError("--time-unit", f"{options.time_unit:g} s", "none beside --rate", hint)
    try:
        if not file.is_file():
            raise InputError("FILE", file, EXISTING_FILE, _of_folder(file) if file.is_dir() else "")
        with file.open("rb") as opened:
            head = opened.read(HEAD)
    except OSError as error:
        raise InputError("FILE", file, "a file that can be read", error.strerror or "") from None
    if not head.strip(b"\0 \t\r\n"):
        hint = "it holds nothing but zeros or blanks" if head else "it is empty"
        raise InputError("FILE", file, "a file with samples", hint)
    try:
        return apart(_reader(file, head)(file, options))
    except StrikewaveError:
        raise
    except MemoryError:
        raise InputError("FILE", file, "a file that fits into memory", "read fewer channels") from None
    except Exception as error:
        raise InputError("FILE", file, "a file that is whole", f"{type(error).__name__}: {error}"[:200]) from None


def _check_steps(record: Record) -> None:
    """Refuse a record whose samples lie closer together, or further apart, than any recorder takes them.

    Time that does not go on at all is left to the checks of health.
    """
    for channel in record.channels:
        step, stamps = channel.step, channel.stamps
        if stamps is not None and stamps.size > 1:
            step = (float(stamps[-1]) - float(stamps[0])) / (stamps.size - 1)
        if 0.0 < abs(step) < SHORTEST_STEP or abs(step) > LONGEST_STEP:
            allowed = f"a time of {SHORTEST_STEP:g} to {LONGEST_STEP:g} s between two samples"
            raise InputError("FILE", Path(record.path), allowed, f"channel {show(channel.name)} has {step:.4g} s")


def _reader(file: Path, head: bytes) -> Callable[[Path, Options], Record]:
    for name, module_name in FORMATS.items():
        module = importlib.import_module(f"{__name__}.{module_name}")
        if getattr(module, f"sniff_{name}")(head):
            return getattr(module, f"read_{name}")
    hint = f"it begins with {show(head[:16])}, which is none of them"
    raise InputError("FILE", file, "a known format: " + ", ".join(FORMATS), hint)


# A shorter piece is no measurement: no blow has so few samples, and a clock that is often set back makes such ones
FEWEST_SAMPLES = 16
MOST_MEASUREMENTS = 1000  # measurements of a file that are read: each is examined as a record of its own
BACK = 0.5  # share of a piece that time falls back before a new measurement: a clock that is set moves by less


def apart(record: Record) -> Record:
    """Part a record where the time of all its channels begins anew; the first piece has the others in ``further``.

    A record whose time runs backwards in any other way is left as it is, for the checks of health.

    Examples
    --------
    >>> time = np.tile(np.arange(20.0), 2)
    >>> record = apart(Record("a.csv", "text", (Channel("board", time, 1.0, stamps=time),)))
    >>> record.channels[0].values.size, len(record.further)
    (20, 1)
    """
    if record.further or not record.channels:
        return record
    by_clock: dict[int, list[int]] = {}
    for channel in record.channels:
        if channel.stamps is None:
            return record
        if id(channel.stamps) not in by_clock:
            by_clock[id(channel.stamps)] = restarts(channel.stamps)
    first, *others = by_clock.values()
    sizes = {channel.values.size for channel in record.channels}
    if not first or len(sizes) > 1 or any(other != first for other in others):
        return record
    return parted(record, first)


def restarts(stamps: Array) -> list[int]:
    """Return the places at which time begins anew; none where a piece would be no measurement."""
    with np.errstate(invalid="ignore"):
        back = np.flatnonzero(np.diff(stamps) < 0.0) + 1
    edges = [0, *back.tolist(), stamps.size]
    if not back.size or min(end - begin for begin, end in pairwise(edges)) < FEWEST_SAMPLES:
        return []
    spans = [(float(stamps[begin]), float(stamps[end - 1])) for begin, end in pairwise(edges)]
    if any(start > first + (1.0 - BACK) * (last - first) for (first, last), (start, _) in pairwise(spans)):
        return []
    return [int(place) for place in back]


def parted(record: Record, places: Sequence[int]) -> Record:
    """Part a record at places that hold for all its channels; what begins without stamps begins at its own start."""
    size = max(channel.values.size for channel in record.channels)
    pieces = [
        replace(record, channels=tuple(_cut(channel, begin, end) for channel in record.channels))
        for begin, end in pairwise([0, *places, size])
    ]
    return joined_pieces(pieces)


def joined_pieces(pieces: Sequence[Record]) -> Record:
    """Return the first of several measurements, with the others behind it."""
    first, *further = pieces
    if len(pieces) > MOST_MEASUREMENTS:
        allowed = f"a file with at most {MOST_MEASUREMENTS} measurements"
        raise InputError("FILE", Path(first.path), allowed, f"it has {len(pieces)}: split it")
    return replace(first, further=tuple(further))


def _cut(channel: Channel, begin: int, end: int) -> Channel:
    """Return a channel from one sample to another, over a time of its own."""
    stamps = None if channel.stamps is None else channel.stamps[begin:end]
    start = channel.start if stamps is None or not stamps.size else float(stamps[0])
    return replace(channel, values=channel.values[begin:end], stamps=stamps, start=start)
