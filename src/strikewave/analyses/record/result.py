"""What measured records say: files, campaigns, JSON document and tables."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from strikewave.analyses.record.chosen import advised_filter, sources_of
from strikewave.analyses.record.document import campaign_row, file_row
from strikewave.analyses.record.figure_units import INTEGRALS, OF_CHANNEL, OF_INTEGRAL, SENSOR_UNITS, units_of
from strikewave.analyses.record.moved import MOTION_UNITS, RecordMotion, all_moved, motion_columns
from strikewave.analyses.record.paired import OF_CHANNEL as PAIR_OF_CHANNEL
from strikewave.analyses.record.paired import PAIR_UNITS, RecordPair, all_pairs, pair_columns, transfer_columns
from strikewave.analyses.record.pulse_columns import pulse_columns
from strikewave.analyses.record.responses import ResponseSummary, responding, response_columns, summaries
from strikewave.analyses.record.shock_columns import shock_columns
from strikewave.base.errors import StrikewaveError
from strikewave.base.output_folder import write_atomically
from strikewave.base.result import FAILED, Notice
from strikewave.records.campaign import Campaign
from strikewave.records.health_notice import STATUSES, HealthNotice
from strikewave.records.reading import FileReading
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import Curve, history_curve, html_place
from strikewave.signal.filters import Filter

if TYPE_CHECKING:
    from strikewave.analyses.record.sensor_trials import SensorTrials
    from strikewave.cases.sensor_file import StatedSensor
    from strikewave.cases.stated_test import StatedTest
    from strikewave.records.budget.contributions import Budget
    from strikewave.specifications.judged_records import RecordsVerdict


@dataclass(frozen=True)
class RecordResult(AskedResult):
    """What measured records say, file by file and together; see `Result` for what it shares with others.

    Attributes
    ----------
    readings : sequence of FileReading
        In the order of the test.
    campaigns : sequence of Campaign
        One a channel; the first stands under ``campaign`` in the JSON document.
    filter : Filter or None
        Low-pass that was taken before the blows were measured.
    calibrations : sequence of (str, str)
        Where a calibration was stated (an option, a file), and what.
    fail_on : str
        Status, ``suspect`` or ``bad``, that makes the command exit with 3 where a file has it, or a worse one.
    motion : bool
        Whether velocity and displacement are given.
    verdict : RecordsVerdict or None
        By a specification, where one was asked for.
    sensor : SensorTrials or None
        The blows on a sensor, where one was asked for.
    pair : tuple of str
        Two channels that are compared as sensors on one object; empty for none.
    performed : StatedTest or None
        What is stated of the test, where a file states it.
    budget : Budget or None
        By which the uncertainties of the blows were found.
    """

    command: ClassVar[str] = "record"

    readings: Sequence[FileReading]
    campaigns: Sequence[Campaign] = ()
    filter: Filter | None = None
    calibrations: Sequence[tuple[str, str]] = ()
    fail_on: str = ""
    motion: bool = False
    verdict: RecordsVerdict | None = None
    sensor: SensorTrials | None = None
    pair: tuple[str, str] | tuple[()] = ()
    performed: StatedTest | None = None
    budget: Budget | None = None

    def of_test(self, performed: StatedTest) -> RecordResult:
        """Return the same with what is stated of the test, and a warning for each calibration that did not hold."""
        return dataclasses.replace(self, performed=performed, notices=(*self.notices, *performed.notices()))

    def test_report(self, path: Path | str) -> Path:
        """Write its test report as one HTML file, whole or not at all, and return the path of the file.

        Parameters
        ----------
        path : Path or str
            The file, which ends in ``.html``, or a folder, where it is called ``test-report.html``.

        Raises
        ------
        StrikewaveError
            If the records were not judged by a specification.
        """
        page = self._drawn("test_page")
        if page is None or self.verdict is None:
            raise StrikewaveError("a test report needs a verdict: record(..., spec=..., test=...)")
        place = html_place(path, "test-report.html")
        write_atomically(place, page(self))
        return place

    @functools.cached_property
    def pairs(self) -> list[RecordPair]:
        """What two channels of each file do together, where asked for."""
        return all_pairs(self.readings, self.pair) if self.pair else []

    def on_sensor(self, stated: StatedSensor, field: str) -> RecordResult:
        """Return the same with the blows tried on a sensor; ``field`` is what an error calls it.

        Raises
        ------
        InputError
            If the records hold no acceleration.
        """
        from strikewave.analyses.record.sensor_trials import try_records
        from strikewave.sensors.channel import SensorChannel, sensor_sources

        found = try_records(self.readings, self.filter, stated, field)
        notices = (*self.notices, *found.notices)
        citations = tuple(
            dict.fromkeys((*self.citations, *sensor_sources([SensorChannel(stated.sensor, None, stated.recorder)])))
        )
        return dataclasses.replace(self, sensor=found, notices=notices, citations=citations)

    @functools.cached_property
    def motions(self) -> list[RecordMotion]:
        """Velocity and displacement of the channels, where asked for."""
        return all_moved(self.readings) if self.motion else []

    @functools.cached_property
    def response_summaries(self) -> list[ResponseSummary]:
        """Each response channel summed up over its blows in all files; none where no base was named."""
        return summaries(self.readings)

    @property
    def title(self) -> str:
        """Name of the only file, or how many there are of which folder."""
        only = len(self.readings) == 1
        return Path(self.readings[0].path).name if only else f"{len(self.readings)} records of {self.origin.name}"

    @property
    def broken(self) -> bool:
        """Whether some files could not be read, or have a status that was not to be."""
        failed = any(notice.broken for notice in self.notices)
        return failed or any(notice.code == "unreadable" for file in self.readings for notice in file.findings)

    @property
    def state(self) -> str:
        """How many files have which status; which checks failed, where some did."""
        return super().state if self.own_verdict.codes else ", ".join(counted(self.readings)) or super().state

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        units = units_of(self.readings)
        more = {**MOTION_UNITS, "lost": "s"} if self.motion else {}
        more |= {**PAIR_UNITS, **dict.fromkeys(PAIR_OF_CHANNEL, units["peak"])} if self.pair else {}
        more |= {**dict.fromkeys(("standard", "expanded"), "as the figure"), "coverage": "1", "share": "1"}
        more |= {} if self.sensor is None else SENSOR_UNITS
        return {**units, **more}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        content = {
            "files": [file_row(file, self.filter) for file in self.readings],
            "campaign": campaign_row(self.campaigns[0]) if self.campaigns else {},
            "advised_cutoff": None if (advised := advised_filter(self.readings)) is None else advised.cutoff,
        }
        if self.budget is not None:
            content["budget"] = self.budget.document()
        if self.motion:
            content["motion"] = [{"file": one.file, "channel": one.channel, **one.document()} for one in self.motions]
        if self.pair:
            content["pairs"] = [one.document() for one in self.pairs]
        if self.verdict is not None:
            lapses = [] if self.performed is None else self.performed.lapses
            content["spec"] = {**self.verdict.document(), "calibration_overdue": [one.instrument for one in lapses]}
        if self.sensor is not None:
            content["sensor"] = self.sensor.document()
        if responding(self.readings):
            content["response_summary"] = [one.document() for one in self.response_summaries]
        if len(self.campaigns) > 1:
            content["campaigns"] = [campaign_row(one) for one in self.campaigns]
        return content

    def highlights(self) -> list[tuple[str, str]]:
        """Return the number of files and blows, and the means of their peaks, widths and velocity changes."""
        blows = sum(len(reading.pulses) for file in self.readings for reading in file.channels)
        numbers = [("files", str(len(self.readings))), ("blows", str(blows))]
        campaign = min(self.campaigns, key=lambda one: one.unit == "", default=None)
        units, shown = {**self.units()}, {"m/s^2": "g", "s": "us", "N": "kN", "m/s": "m/s"}
        if campaign is not None:  # files in other units are in none of its figures
            units |= dict.fromkeys(OF_CHANNEL, campaign.unit) | dict.fromkeys(
                OF_INTEGRAL, INTEGRALS.get(campaign.unit, "")
            )
        for name, statistic in campaign.statistics.items() if campaign is not None else ():
            if units.get(name) in shown:
                numbers.append(
                    (f"mean {name.replace('_', ' ')}", with_unit(statistic.mean, units[name], shown[units[name]]))
                )
        return numbers

    def columns(self) -> list[Column]:
        """Return all blows, file by file."""
        return pulse_columns(self.readings)

    def brief(self) -> dict[str, str]:
        """Return where each blow stands, and what it is."""
        shown, units = {"m/s^2": "g", "s": "us", "N": "kN"}, {column.name: column.si for column in self.columns()}
        places = {"file": "", "channel": "", "index": "", "time": "s"}
        return places | {n: shown.get(units[n], units[n]) for n in ("peak", "width", "velocity_change")}

    def brief_columns(self) -> list[Column]:
        """Return them with the unit in each cell where channels differ in it: 4900 m/s^2 is no number beside 4900 N."""
        units = [reading.channel.unit for file in self.readings for reading in file.channels for _ in reading.pulses]
        columns = super().brief_columns()
        if len(set(units)) < 2:
            return columns
        from strikewave.analyses.record.tables import in_own_unit

        return [
            Column(one.name, [in_own_unit(one.name, *pair) for pair in zip(units, one.values, strict=True)])
            if one.name in (*OF_CHANNEL, *OF_INTEGRAL)
            else one
            for one in columns
        ]

    def preview(self) -> Curve | None:
        """Return the first channel over the first blow; over the whole record where there is none."""
        reading = next((reading for file in self.readings for reading in file.channels), None)
        if reading is None:
            return None
        channel, unit = reading.channel, reading.channel.unit
        chosen = np.ones(channel.values.size, bool)
        for pulse in reading.pulses[:1]:
            span = pulse.end - pulse.begin
            chosen = (channel.time >= pulse.begin - span) & (channel.time <= pulse.end + 2.0 * span)
        shown = {"m/s^2": "g", "N": "kN"}.get(unit, unit)
        return history_curve(channel.time[chosen], channel.values[chosen], unit, shown, channel.name)

    def tables(self) -> dict[str, str]:
        """Return all pulses as CSV text."""
        tables = {"pulses.csv": csv_table(self.columns())}
        if responding(self.readings):
            tables["responses.csv"] = csv_table(response_columns(self.readings))
        if self.motion:
            tables["motion.csv"] = csv_table(motion_columns(self.motions), HISTORY_DIGITS)
        if self.pair:
            tables["pairs.csv"] = csv_table(pair_columns(self.pairs))
            tables["transfer.csv"] = csv_table(transfer_columns(self.pairs), HISTORY_DIGITS)
        if self.verdict is not None:
            tables["shocks.csv"] = csv_table(shock_columns(self.verdict))
        if self.sensor is not None:
            tables["sensor.csv"] = csv_table(self.sensor.columns())
        return tables


def name_of(paths: Sequence[Path]) -> str:
    """Return the name of the only file without its ending, or of the folder of several.

    Examples
    --------
    >>> name_of([Path("shots/a.csv")]), name_of([Path("shots/a.csv"), Path("shots/b.csv")])
    ('a', 'shots')
    """
    return paths[0].stem if len(paths) == 1 else paths[0].absolute().parent.name or "records"


def counted(files: Sequence[FileReading]) -> list[str]:
    """Return how many files there are of each status, in words."""
    statuses = [file.status for file in files]
    return [f"{statuses.count(status)} {status}" for status in STATUSES if status in statuses]


def record_result(
    readings: Sequence[FileReading],
    campaigns: Sequence[Campaign] = (),
    filter: Filter | None = None,
    fail_on: str = "",
    **asked: Any,
) -> RecordResult:
    """Return the result of records with its notices and sources; ``asked`` are further attributes of `RecordResult`."""
    citations = sources_of(readings, campaigns, filter)
    notices = (*notices_of(readings), *failed_on(readings, fail_on))
    return RecordResult(readings, campaigns, filter, fail_on=fail_on, notices=notices, citations=citations, **asked)


def failed_on(files: Sequence[FileReading], status: str) -> tuple[Notice, ...]:
    """Return a failed check where a file has a status, or a worse one; none for an empty status."""
    failing = STATUSES[STATUSES.index(status) :] if status else ()
    counts = {one: sum(file.status == one for file in files) for one in reversed(failing)}
    found = sum(counts.values())
    if not found:
        return ()
    words = " and ".join(f"{count} {one}" for one, count in counts.items() if count)
    message = f"{words} of {len(files)} file{'s' if len(files) > 1 else ''}, and none was to be (--fail-on {status})"
    return (Notice("fail-on", message, float(found), 0.0, FAILED),)


NOTED = (
    "unit-unknown", "not-calibrated", "unreadable", "rate-overrules", "unit-overrules", "measurements", "start-times",
    "start-unknown", "count-differs",
)  # fmt: skip
"""Codes of findings that are warnings of the result too: what all its figures depend on."""


def notices_of(files: Sequence[FileReading]) -> tuple[Notice, ...]:
    """Return the warnings on all files, each once."""
    findings: dict[str, tuple[HealthNotice, int]] = {}
    for file in files:
        for code in {f.code for f in file.all_findings if f.code in NOTED}:
            first = next(f for f in file.all_findings if f.code == code)
            findings[code] = (findings[code][0] if code in findings else first, findings.get(code, (first, 0))[1] + 1)
    return tuple(
        Notice(code, f.message if count == 1 else f"{f.message} ({count} files)", count, 0)
        for code, (f, count) in findings.items()
    )
