"""Records read and judged: for the command, and in plain values for Python."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.clauses import budget_notices
from strikewave.analyses.record.options import Examination
from strikewave.analyses.record.result import RecordResult, record_result
from strikewave.analyses.record.rows import name_of
from strikewave.analyses.record.sensors import try_records
from strikewave.analyses.record.verdicts import with_verdict
from strikewave.base.errors import StrikewaveError
from strikewave.base.result import Source
from strikewave.cases.stack_of_case import stated_sensor
from strikewave.records import (
    FileReading,
    Request,
    SampleStore,
    calibrations_beside,
    compare,
    read_file,
    repeats,
    summed,
    unreadable,
)
from strikewave.records.reading import with_budget
from strikewave.reporting import measured_files as measured
from strikewave.reporting.measured_files import Calibration, Filtering, Judging, MeasurementOptions, Reading
from strikewave.reporting.terminal import say
from strikewave.sensors.trial import SensorChannel, sensor_sources
from strikewave.signal.filters import Filter

if TYPE_CHECKING:
    from strikewave.cases.performed_test import StatedTest
    from strikewave.records.budget import Budget
    from strikewave.specifications.reading import Specification


@measured.with_groups(
    calibration=Calibration, reading=Reading, filter=Filtering, examination=Examination, judging=Judging
)
def record(
    paths: str | Path | Sequence[str | Path],
    *,
    channels: str | int | Sequence[str | int] = (),
    unit: Any = None,
    rate: str | float | None = None,
    calibration: Calibration | None = None,
    reading: Reading | None = None,
    filter: str | float | Filter | Filtering | None = None,
    examination: Examination | None = None,
    spec: str | None = None,
    judging: Judging | None = None,
) -> RecordResult:
    """Read measured files and judge them: status, health and pulses of each, and the statistics of all together.

    It is what ``strikewave record`` does; its further options are groups.

    Parameters
    ----------
    paths : str, Path or sequence of them
        Measured files of any known format, in the order of the test; or a pattern, such as ``"blows/*.lvm"``.
    channels : str, int or sequence of them, optional
        Names, or numbers from 1, of those to take; all by default.
    unit : str or mapping, optional
        Unit of the values of the files, such as ``"g"``; for all channels, or a mapping from their names or numbers.
    rate : str or float, optional
        Sampling rate of files without a time column: with a unit, or in Hz.
    calibration : Calibration, optional
        Sensitivity, gain, bridge voltages and polarity of the channels.
    reading : Reading, optional
        Time column and its unit, and the measurement of a file to take.
    filter : str, float, Filter or Filtering, optional
        Zero-phase low-pass taken before blows are measured: its cutoff, with a unit or in Hz, its class, such as
        ``"CFC 1000"``, or a filter; `Filtering` has a high-pass and AC coupling too.
    examination : Examination, optional
        Drop height, driving channel, pair of sensors, sensor and motion.
    spec : str, optional
        Specification to judge the blows by: a built-in one, such as ``"jesd22-b110:B"``, or a file that ends in
        ``.toml``; the verdict is ``.verdict`` of the result.
    judging : Judging, optional
        Decision rule, uncertainty, directions, and the file of the test.

    Returns
    -------
    RecordResult
        Health, pulses and notices of each channel, the campaign over the files, verdicts where they are asked
        for.

    Raises
    ------
    InputError, StrikewaveError
        If not one file can be read, or a value is none that it can be.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> import strikewave
    >>> time = np.arange(4000) * 1e-5
    >>> pulse = 500.0 * np.sin(np.pi * (time - 0.01) / 1e-3) * ((time > 0.01) & (time < 0.011))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "shot.csv"
    ...     np.savetxt(file, np.column_stack([time, pulse]), delimiter=",", header="time (s),frame", comments="")
    ...     found = strikewave.record(file, unit={"frame": "g"})
    >>> found.highlights()[:2]
    [('files', '1'), ('blows', '1')]
    >>> len(found.to_dataframe()), found.readings[0].status
    (1, 'good')
    """
    files, judging = measured.files_of(paths), judging or Judging()
    asked = RecordsAsked(
        files,
        MeasurementOptions.of(channels, unit, rate, calibration, reading),
        examination or Examination(),
        Filtering.of(filter),
        judging,
        judging.specification(spec),
        judging.performed,
    )
    return examined(asked, measured.source_in_python(name_of([Path(file) for file in files]), asked.performed))


@dataclass(frozen=True)
class RecordsAsked:
    """Request for measured files, in the order of the test."""

    files: Sequence[str]
    measurement: MeasurementOptions
    examination: Examination
    filtering: Filtering
    judging: measured.RecordJudging
    specification: Specification | None = None
    performed: StatedTest | None = None
    fail_on: str = ""

    @functools.cached_property
    def request(self) -> Request:
        """Request for the compute room."""
        height = math.nan if self.examination.drop_height is None else self.examination.drop_height
        base = self.examination.base or ""
        wanted = Request(self.measurement.names, self.measurement.calibration(), height, base=base)
        return self.filtering.on(wanted)


def examined(asked: RecordsAsked, origin: Source) -> RecordResult:
    """Return what records say, and what else is asked of them."""
    asked.examination.check()
    more = asked.examination
    judged = None if asked.specification is None else (asked.specification, asked.judging.asked(origin.test))
    sensor = None if more.sensor is None else stated_sensor(more.sensor, "--sensor")
    result = _read(asked, origin)
    result = dataclasses.replace(result, motion=more.motion, pair=more.pair or ())
    budget = asked.judging.uncertainty
    result = result if budget is None else budgeted(result, budget)
    if sensor is not None:
        trials = try_records(result.readings, result.filter, sensor, "--sensor")
        sources = sensor_sources([SensorChannel(sensor.sensor, None, sensor.recorder)])
        citations = tuple(dict.fromkeys((*result.citations, *sources)))
        notices = (*result.notices, *trials.notices)
        result = dataclasses.replace(result, sensor=trials, notices=notices, citations=citations)
    result = result if judged is None else with_verdict(result, *judged)
    result = result if asked.performed is None else result.of_test(asked.performed)
    result.pairs  # noqa: B018 a wrong pair is refused before anything is written
    return result


def _read(asked: RecordsAsked, origin: Source) -> RecordResult:
    """Return what records say by themselves: readings, campaigns, calibrations."""
    files, wanted = asked.files, asked.request
    known: dict[str, int] = {}
    read: list[FileReading] = []
    errors: dict[str, StrikewaveError] = {}
    with SampleStore() as store:
        for file, record_of_file in measured.read_each(files, asked.measurement.reading()):
            try:
                if isinstance(record_of_file, Exception):
                    raise record_of_file
                known |= record_of_file.keys
                reading = store.kept(read_file(record_of_file, calibrations_beside(Path(file)), wanted))
            except StrikewaveError as error:
                errors[file] = error
                reading = FileReading(file, "", (), (unreadable(str(error)),))
            read.append(dataclasses.replace(reading, path=measured.shown(reading.path)))
    if len(errors) == len(files):
        raise next(iter(errors.values()))
    measured.check_channels(wanted.calibrations, known)
    for file, failed in errors.items():
        say(f"left out: {failed}" if file in str(failed) else f"left out: {file}: {failed}")
    if asked.examination.columns == "repeats":
        read = [repeat for file in read for repeat in repeats(file) or [file]]
    readings = compare(read)
    channels = [reading for file in readings for reading in file.channels]
    answering = {reading.number for reading in channels if reading.responses}
    numbers = dict.fromkeys(reading.number for reading in channels if reading.number not in answering)
    campaigns = [campaign for campaign in (summed(readings, k) for k in numbers) if campaign is not None]
    layers = {"command line" if origin.asked else "the call": wanted.calibrations}
    for file in files:
        if stated := calibrations_beside(Path(file)):
            layers[f"beside {Path(file).name}"] = stated
    calibrations = [
        (where, f"{channel}: " + ", ".join(f"{key} = {value}" for key, value in table.items()))
        for where, tables in layers.items()
        for channel, table in tables.items()
    ]
    return record_result(readings, campaigns, wanted.filter, asked.fail_on, calibrations=calibrations, origin=origin)


def budgeted(result: RecordResult, budget: Budget) -> RecordResult:
    """Return the result of records with the uncertainty of each blow by a budget."""
    citations = tuple(dict.fromkeys((*result.citations, "jcgm-100", "jcgm-101")))
    readings = with_budget(result.readings, budget)
    notices = (*result.notices, *budget_notices(budget))
    return dataclasses.replace(result, readings=readings, budget=budget, citations=citations, notices=notices)
