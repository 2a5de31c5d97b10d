"""The records of a test: each file read and examined in its turn, then all of them compared and summed up."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

from strikewave.analyses.record.result import RecordResult, record_result
from strikewave.base.errors import StrikewaveError
from strikewave.base.result import Source
from strikewave.records import (
    FileReading,
    Options,
    Record,
    Request,
    SampleStore,
    calibrations_beside,
    compare,
    read_file,
    repeats,
    summed,
    unreadable,
)
from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import say


def examine_files(
    files: Sequence[str],
    wanted: Request,
    options: Options,
    origin: Source = measured.UNKNOWN,
    in_columns: bool = False,
    fail_on: str = "",
) -> RecordResult:
    """Return what files say, one by one and together; one among several that cannot be used is named and left out.

    Parameters
    ----------
    files : sequence of str
        Paths, in the order of the test.
    wanted, options : Request, Options
        What is wanted of them, and how they are read.
    origin : Source
        Where the result comes from.
    in_columns : bool
        Whether the channels of a file are repeats of one test.
    fail_on : str
        Status that makes the result a failed one; empty for none.

    Raises
    ------
    InputError, StrikewaveError
        If not one file can be read, or a calibration is for a channel that none has.
    """
    store, known = SampleStore(), dict[str, int]()
    read: list[FileReading] = []
    errors: list[Exception] = []
    for file, record in measured.read_each(files, options):
        shown = measured.shown(file)
        if isinstance(record, Record):
            known |= record.keys
            try:
                reading = read_file(record, calibrations_beside(Path(file)), wanted)
                read.append(store.kept(dataclasses.replace(reading, path=shown)))
                continue
            except StrikewaveError as error:
                record = error
        errors.append(record)
        read.append(FileReading(shown, "", (), (unreadable(str(record)),)))
    if len(errors) == len(files):
        raise errors[0]
    measured.check_channels(wanted.calibrations, known)
    for failed in errors:
        say(f"left out: {failed}")
    if in_columns:
        read = [one for file in read for one in repeats(file) or [file]]
    readings = compare(read)
    numbers = dict.fromkeys(reading.number for file in readings for reading in file.channels)
    campaigns = [one for one in (summed(readings, k) for k in numbers) if one is not None]
    calibrations = _calibrations(wanted, [Path(file) for file in files])
    return record_result(readings, campaigns, wanted.filter, fail_on, calibrations=calibrations, origin=origin)


def _calibrations(wanted: Request, paths: Sequence[Path]) -> list[tuple[str, str]]:
    """Return where a calibration was stated, and what."""
    layers = {"command line": wanted.calibrations}
    layers |= {f"beside {path.name}": stated for path in paths if (stated := calibrations_beside(path))}
    return [
        (where, f"{channel}: " + ", ".join(f"{key} = {value}" for key, value in table.items()))
        for where, stated in layers.items()
        for channel, table in stated.items()
    ]
