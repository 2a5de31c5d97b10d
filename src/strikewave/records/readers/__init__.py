"""Read a measured file of any known format; the format is found by content, never by name.

Each module of this folder reads one format, and has ``sniff`` (do these
first bytes begin such a file?) and ``read`` (path and options in, record out). Every file is taken as hostile:
nothing in it is run, sizes it claims are checked against its true size before memory is taken, and whatever is
wrong with it ends in an `InputError`.
"""

from __future__ import annotations

import importlib
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from strikewave.base.errors import EXISTING_FILE, InputError, StrikewaveError, show
from strikewave.records.health_notice import HealthNotice
from strikewave.records.record import Record

FORMATS = (
    "tdms",
    "mdf",
    "ide",
    "rigol",
    "hdf",
    "mat",
    "netcdf",
    "parquet",
    "wav",
    "uff",
    "excel",
    "lvm",
    "text",
)
"""Modules, in the order in which they are asked; text, which takes almost anything, comes last."""
HEAD = 8192
"""Bytes shown to ``sniff``: HDF5 may begin behind a user block of 4096."""
LARGEST_ARRAY = 16 * 2**30
"""A file whose channels would take more bytes in memory is refused: 2 thousand million samples, what a workstation
holds."""


SHORTEST_STEP, LONGEST_STEP = 1e-15, 1e6
"""Between two samples, s: the fastest oscilloscopes take one in 4e-12 s, and a million seconds are twelve days. Beyond,
powers of a step leave the range of numbers."""


class Options(NamedTuple):
    """What the user states about a file that the file itself does not.

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
        Which of the measurements of a file to take, from 1.
    """

    rate: float | None = None
    time: str | None = None
    channels: tuple[str, ...] = ()
    time_unit: float | None = None
    measurement: int | None = None


def _of_folder(folder: Path) -> str:
    """Return words that lead from a folder to its files, by the ending that most of them have."""
    endings = Counter(one.suffix for one in folder.iterdir() if one.suffix and one.is_file())
    most = max(endings, key=lambda ending: (endings[ending], ending), default="")
    return f'this is a folder; name its files: "{folder}/*{most}"'


def read_record(path: str | Path, options: Options = Options()) -> Record:  # noqa: B008  (a tuple, frozen)
    r"""Read a file of any known format that holds one measurement, or the one that is asked for.

    Parameters
    ----------
    path : str or Path
        The file; its content says which format it has.
    options : Options, optional
        What the file itself does not say: sampling rate (Hz), column of time, channels wanted, unit of time (s).

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

    Raises
    ------
    InputError
        As `read_record` does, but not for several measurements.

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
    whole = _read_whole(path, options)
    records = [replace(whole, further=()), *whole.further]
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
        raise InputError(
            "--measurement", options.measurement, f"a number from 1 to {len(records)}", f"it holds {holds}"
        )
    return [records[options.measurement - 1]]


def _read_whole(path: str | Path, options: Options) -> Record:
    """Read a file, with its further measurements behind the first."""
    from strikewave.records.readers.measurements import apart

    file = Path(path)
    if options.rate is not None and not 1.0 / LONGEST_STEP <= options.rate <= 1.0 / SHORTEST_STEP:
        raise InputError(
            "--rate", options.rate, f"a sampling rate of {1.0 / LONGEST_STEP:g} to {1.0 / SHORTEST_STEP:g} Hz"
        )
    if options.time_unit is not None and options.rate is not None:
        raise InputError(
            "--time-unit", f"{options.time_unit:g} s", "none beside --rate", "the rate overrules all times"
        )
    try:
        if not file.is_file():
            raise InputError("FILE", str(path), EXISTING_FILE, _of_folder(file) if file.is_dir() else "")
        with file.open("rb") as opened:
            head = opened.read(HEAD)
    except OSError as error:
        raise InputError("FILE", str(path), "a file that can be read", error.strerror or "") from None
    if not head.strip(b"\0 \t\r\n"):
        hint = "it holds nothing but zeros or blanks" if head else "it is empty"
        raise InputError("FILE", str(path), "a file with samples", hint)
    try:
        return apart(_reader(path, head).read(file, options))
    except StrikewaveError:
        raise
    except MemoryError:
        raise InputError("FILE", str(path), "a file that fits into memory", "read fewer channels") from None
    except Exception as error:
        raise InputError("FILE", str(path), "a file that is whole", f"{type(error).__name__}: {error}"[:200]) from None


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
            raise InputError("FILE", record.path, allowed, f"channel {show(channel.name)} has {step:.4g} s")


def _reader(path: str | Path, head: bytes):  # type: ignore[no-untyped-def]  # a module
    for name in FORMATS:
        module = importlib.import_module(f"{__name__}.{name}")
        if module.sniff(head):
            return module
    hint = f"it begins with {show(head[:16])}, which is none of them"
    raise InputError("FILE", str(path), "a known format: " + ", ".join(FORMATS), hint)
