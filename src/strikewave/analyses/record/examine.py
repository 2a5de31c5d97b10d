"""Records read and judged: for the command, and in plain values for Python."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.analyses.clauses import budget_notices
from strikewave.analyses.record.options import RecordSpecificationOptions, filtered
from strikewave.analyses.record.result import RecordResult, record_result
from strikewave.analyses.record.rows import name_of
from strikewave.analyses.record.sensor_pairs import read_pair
from strikewave.analyses.record.verdicts import with_verdict
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import Source
from strikewave.base.units import si_value
from strikewave.cases.stack_of_case import StatedSensor, stated_sensor
from strikewave.cases.stated_test import StatedTest, load_test
from strikewave.records import (
    FileReading,
    Options,
    Request,
    SampleStore,
    calibrations_beside,
    compare,
    read_file,
    repeats,
    summed,
    unreadable,
)
from strikewave.records.budget import Budget
from strikewave.records.reading import with_budget
from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import say
from strikewave.signal.filters import Filter
from strikewave.specifications.judging import Rule

if TYPE_CHECKING:
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification


def record(
    paths: str | Path | Sequence[str | Path],
    *,
    channels: Sequence[str | int] = (),
    unit: measured.Stated | None = None,
    sensitivity: measured.Stated | None = None,
    gain: measured.Stated | None = None,
    excitation: measured.Stated | None = None,
    rated_excitation: measured.Stated | None = None,
    count: measured.Stated | None = None,
    polarity: measured.Stated | None = None,
    rate: str | float | None = None,
    time: str | int | None = None,
    time_unit: str | None = None,
    measurement: int | None = None,
    drop_height: str | float | None = None,
    filter: str | float | Filter | None = None,
    ac_coupling: str | float | None = None,
    high_pass: str | float | None = None,
    motion: bool = False,
    repeats_in_columns: bool = False,
    base: str | int = "",
    pair: Sequence[str | int] = (),
    sensor: str | Path | None = None,
    spec: str | None = None,
    decision: Rule = "simple",
    uncertainty: str | float | Path | None = None,
    strict: bool = False,
    direction: str | Sequence[str] = (),
    cross_axis: Sequence[str | int] = (),
    test: str | Path | None = None,
) -> RecordResult:
    """Read measured files and judge them: status, health and pulses of each, and the statistics of all together.

    It is what ``strikewave record`` does. Values of the calibration are for all channels, or a mapping from names (or
    numbers) of channels to values; they stand over those of a ``calibration.toml`` beside the files.

    Parameters
    ----------
    paths : str, Path or sequence of them
        Measured files of any known format, in the order of the test; or a pattern, such as ``"blows/*.lvm"``.
    channels : sequence of str or int, optional
        Names, or numbers from 1, of those to take; all by default.
    unit, sensitivity, gain, excitation, rated_excitation, count, polarity : str, float or mapping, optional
        Calibration, such as ``unit="g"`` or ``sensitivity="1.2 mV/g"``; see docs/records.md.
    rate : str or float, optional
        Sampling rate of files without a time column: with a unit, or in Hz.
    time : str or int, optional
        Name or number of the column that holds time; found by default.
    time_unit : str, optional
        Unit of that column, such as ``"ms"``; that of the file, or s, by default.
    measurement : int, optional
        Number of the measurement of a file to take, from 1; each as a record of its own by default.
    drop_height : str or float, optional
        Free fall before the blow: with a unit, or in m; not checked by default.
    filter : str, float or Filter, optional
        Zero-phase low-pass taken before blows are measured: its cutoff, with a unit or in Hz, its class, such as
        ``"CFC 1000"``, or a filter.
    ac_coupling : str or float, optional
        AC coupling to take off: ``"auto"``, a time constant, with a unit or in s, or a cutoff such as ``"100 Hz"``.
    high_pass : str or float, optional
        Cutoff of a zero-phase high-pass, with a unit or in Hz.
    motion : bool, optional
        True to give velocity and displacement, with their drift: ``.motions`` of the result.
    repeats_in_columns : bool, optional
        True if the columns of a file are repeats of one test, not channels.
    base : str or int, optional
        Name or number of the driving channel: the others are measured as responses to its blow.
    pair : sequence of str or int, optional
        Names or numbers of two channels that are compared as sensors on one object: ``.pairs`` of the result.
    sensor : str or Path, optional
        Sensor on which the blows are tried: an accelerometer of the table, such as ``"Endevco 7270A-20K"``, or a file
        with ``[[sensor]]`` that ends in ``.toml``; what it leaves of them is ``.sensor`` of the result.
    spec : str, optional
        Specification to judge the blows by: a built-in one, such as ``"jesd22-b110:B"``, or a file that ends in
        ``.toml``; the verdict is ``.verdict`` of the result.
    decision : str, optional
        ``simple``, or ``guarded`` by the expanded uncertainty.
    uncertainty : str, float or Path, optional
        Expanded uncertainty (k = 2) of the acceleration, such as ``"5 %"``, or a TOML file with an uncertainty budget;
        only that of noise and baseline by default. ``.uncertainties`` of each channel.
    strict : bool, optional
        True to state no verdict by limits that are from memory.
    direction : str or sequence of str, optional
        Direction of the shocks, such as ``"+x"`` or ``"up*.csv=-z"``.
    cross_axis : sequence of str or int, optional
        Names or numbers of channels that measure across the shock.
    test : str or Path, optional
        TOML file that says what was tested, by whom and when, for the head of the report.

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
    calibration = {
        "unit": unit,
        "sensitivity": sensitivity,
        "gain": gain,
        "excitation": excitation,
        "rated_excitation": rated_excitation,
        "count": count,
        "polarity": polarity,
    }
    with measured.named_for_python():
        files = measured.files_of(paths)
        stated = measured.MeasurementOptions.in_python(channels, calibration, rate, time, time_unit, measurement)
        if base != "" and repeats_in_columns:
            raise InputError("base", base, "a channel of files whose columns are channels", "not repeats_in_columns")
        two = read_pair(",".join(map(str, pair)), "pair") if pair else ()
        height = math.nan if drop_height is None else si_value(drop_height, "m", "drop_height")
        wanted = Request(tuple(stated.channel or ()), stated.calibration(), height, base=str(base))
        wanted = filtered(wanted, filter, ac_coupling, high_pass)
        judging = RecordSpecificationOptions.in_python(
            spec, decision, uncertainty, strict, direction=direction, cross_axis=cross_axis
        )
        specification = judging.specification()
        tried = None if sensor is None else (stated_sensor(str(sensor), "sensor"), "sensor")
        performed = None if test is None else load_test(Path(test), "test")
        origin = measured.source_in_python(name_of([Path(file) for file in files]), performed)
        found = examined(files, wanted, stated.reading(), origin, repeats_in_columns)
        judged = None if specification is None else (specification, judging.asked(origin.test))
        return completed(found, motion, two, tried, judged, performed, judging.uncertainty)


def examined(
    files: Sequence[str],
    wanted: Request,
    options: Options,
    origin: Source,
    repeats_in_columns: bool = False,
    fail_on: str = "",
) -> RecordResult:
    """Return what records say.

    Parameters
    ----------
    files : sequence of str
        Paths, in the order of the test.
    wanted, options : Request, Options
        Results wanted of the records, and options by which they are read.
    origin : Source
        Where the result comes from.
    repeats_in_columns : bool, optional
        True if the channels of a file are repeats of one test.
    fail_on : str, optional
        Status that counts as a failed check; empty for none.
    """
    known: dict[str, int] = {}
    read: list[FileReading] = []
    errors: dict[str, StrikewaveError] = {}
    with SampleStore() as store:
        for file, record_of_file in measured.read_each(files, options):
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
    if repeats_in_columns:
        read = [one for file in read for one in repeats(file) or [file]]
    readings = compare(read)
    read_channels = [reading for file in readings for reading in file.channels]
    answering = {reading.number for reading in read_channels if reading.responses}
    numbers = dict.fromkeys(reading.number for reading in read_channels if reading.number not in answering)
    campaigns = [one for one in (summed(readings, k) for k in numbers) if one is not None]
    calibrations = _calibrations("command line" if origin.asked else "the call", wanted, [Path(file) for file in files])
    return record_result(readings, campaigns, wanted.filter, fail_on, calibrations=calibrations, origin=origin)


def completed(
    result: RecordResult,
    motion: bool,
    pair: tuple[str, str] | tuple[()],
    sensor: tuple[StatedSensor, str] | None,
    judged: tuple[Specification, Asked] | None,
    performed: StatedTest | None = None,
    budget: Budget | None = None,
) -> RecordResult:
    """Return the result of records with what else is asked of them.

    Parameters
    ----------
    result : RecordResult
        Result of the records.
    motion : bool
        True to give velocity and displacement.
    pair : tuple of str
        Two channels that are compared as sensors on one object; empty for none.
    sensor : (StatedSensor, str) or None
        On what the blows are tried, and what an error calls it.
    judged : (Specification, Asked) or None
        Specification that the blows are judged by, and how it is applied.
    performed : StatedTest or None, optional
        Statements about the test.
    budget : Budget or None, optional
        By which the uncertainties of the blows are found.
    """
    result = dataclasses.replace(result, motion=motion, pair=pair)
    result = result if budget is None else budgeted(result, budget)
    result = result if sensor is None else result.on_sensor(*sensor)
    result = result if judged is None else with_verdict(result, *judged)
    result = result if performed is None else result.of_test(performed)
    result.pairs  # noqa: B018 a wrong pair is refused before anything is written
    return result


def budgeted(result: RecordResult, budget: Budget) -> RecordResult:
    """Return the result of records with the uncertainty of each blow by a budget."""
    citations = tuple(dict.fromkeys((*result.citations, "jcgm-100", "jcgm-101")))
    readings = with_budget(result.readings, budget)
    notices = (*result.notices, *budget_notices(budget))
    return dataclasses.replace(result, readings=readings, budget=budget, citations=citations, notices=notices)


def _calibrations(stated_in: str, wanted: Request, paths: Sequence[Path]) -> list[tuple[str, str]]:
    """Return where a calibration was stated, and what."""
    layers = {stated_in: wanted.calibrations}
    layers |= {f"beside {path.name}": stated for path in paths if (stated := calibrations_beside(path))}
    return [
        (where, f"{channel}: " + ", ".join(f"{key} = {value}" for key, value in table.items()))
        for where, stated in layers.items()
        for channel, table in stated.items()
    ]
