"""Result of measured records: files, campaigns, JSON document and tables."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from strikewave.analyses.record.rows import (
    BlowRow,
    CampaignRow,
    FileRow,
    MotionRow,
    RecordMotion,
    ResponseSummary,
    advised_filter,
    all_moved,
    blow_rows,
    counted,
    motion_columns,
    responding,
    response_columns,
    sources_of,
    summaries,
    units_given,
)
from strikewave.analyses.record.sensors import (
    PAIR_COLUMNS,
    PairRow,
    RecordPair,
    SensorRow,
    SensorTrials,
    all_pairs,
    transfer_columns,
)
from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED, GivenUnits, Quantity, declarations
from strikewave.base.errors import StrikewaveError
from strikewave.base.output_folder import write_atomically
from strikewave.base.result import FAILED, Notice
from strikewave.base.shock_quantities import FREQUENCY, MILLISECONDS, OF_CHANNEL, OF_FIGURE, OF_INTEGRAL, usual_unit
from strikewave.records.budget import Budget
from strikewave.records.campaign import Campaign
from strikewave.records.health_notice import STATUSES, HealthNotice
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import FileReading
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import data_columns
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import shown_unit
from strikewave.reporting.shown_result import Curve, columns_of_mappings, history_curve, html_place
from strikewave.signal.filters import Filter
from strikewave.specifications.judged_records import RecordsVerdict
from strikewave.specifications.judging import FAIL, NOT_JUDGED

if TYPE_CHECKING:
    from strikewave.cases.performed_test import StatedTest

OWN = "as in the file"  # stands for the unit of figures whose file does not say it
MEANS_SHOWN = ("m/s^2", "s", "N", "m/s")  # SI units of figures whose means are key numbers


@declare.dataclass
class MeanOfFigure:
    """Mean of a figure over all files."""

    name: str = declare.word("which figure")
    mean: float = declare.number(OF_FIGURE, "its mean", headline="mean {name}")
    quantity: Quantity = NOT_MEASURED

    @property
    def given_units(self) -> GivenUnits:
        """Units of the figure."""
        return {OF_FIGURE.given_by: self.quantity.units}


@declare.dataclass
class SpecifiedRecords:
    """A verdict on records by a specification."""

    verdict: RecordsVerdict = declare.part(RecordsVerdict, "the verdict", inline=True)
    calibration_overdue: list[str] = declare.word("instruments whose calibration has run out by the date of the test")


@declare.dataclass
class RecordResult(AskedResult):
    """Result of measured records, file by file and together; members that all results share: see `Result`.

    Attributes
    ----------
    readings : sequence of FileReading
        In the order of the test.
    campaigns : sequence of Campaign
        One a channel; the first stands under ``campaign`` in the JSON document.
    filter : Filter or None
        Low-pass that was taken before the blows were measured.
    calibrations : sequence of (str, str)
        Stated calibrations: source (an option, a file) and statement.
    fail_on : str
        Status, ``suspect`` or ``bad``, that makes the command exit with 3 where a file has it, or a worse one.
    motion : bool
        True if velocity and displacement are given.
    verdict : RecordsVerdict or None
        Verdict by a specification, where one was requested.
    sensor : SensorTrials or None
        The blows on a sensor, where one was asked for.
    pair : tuple of str
        Two channels that are compared as sensors on one object; empty for none.
    performed : StatedTest or None
        Statements about the test, where a file states it.
    budget : Budget or None
        Budget behind the uncertainties of the blows.
    """

    command: ClassVar[str] = "record"
    main_rows: ClassVar[str] = "blows"

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
        """
        page = self._drawn("test_page")
        if page is None or self.verdict is None:
            raise StrikewaveError("a test report needs a verdict: record(..., spec=..., judging=Judging(test=...))")
        place = html_place(path, "test-report.html")
        write_atomically(place, page(self))
        return place

    @functools.cached_property
    def pairs(self) -> list[RecordPair]:
        """Comparison of two channels of each file, where asked for."""
        return all_pairs(self.readings, self.pair) if self.pair else []

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
        """True if some files could not be read, or fail a check."""
        failed = any(notice.broken for notice in self.notices)
        return failed or any(notice.code == "unreadable" for file in self.readings for notice in file.findings)

    @property
    def state(self) -> str:
        """Number of files of each status, or the checks that failed."""
        return super().state if self.own_verdict.codes else ", ".join(counted(self.readings)) or super().state

    @property
    def unit(self) -> str:
        """SI unit of all channels; empty where they differ in it, or it is not known."""
        return next(iter(self._units)) if len(self._units) == 1 else ""

    @property
    def _units(self) -> set[str]:
        return {reading.channel.unit for file in self.readings for reading in file.channels}

    @property
    def given_units(self) -> GivenUnits:
        """Units of all channels, where they share one, or none of them is known."""
        return units_given(self.unit) if len(self._units) < 2 else {}

    @property
    def named_units(self) -> Mapping[str, str]:
        """Unit of intervals of a campaign, and words for unknown units."""
        own = {} if any(self._units) else {OF_CHANNEL.given_by: OWN, OF_INTEGRAL.given_by: f"{OWN}, times s"}
        units = declare.units(type(self)) if own else {}
        return {"interval": MILLISECONDS.si, **{key: own[unit] for key, unit in units.items() if unit in own}}

    @declare.computed(declare.rows(FileRow, "measured files", key="files", label="files", headline="count"))
    def file_rows(self) -> list[FileRow]:
        """Files, with channels and blows."""
        return [FileRow.of(file, self.filter) for file in self.readings]

    @declare.computed(declare.part(CampaignRow, "all blows of a channel together"))
    def campaign(self) -> CampaignRow | dict[str, Any]:
        """First channel over all files."""
        return CampaignRow.of(self.campaigns[0]) if self.campaigns else {}

    @declare.computed(declare.number(FREQUENCY, "low-pass that is advised for all"))
    def advised_cutoff(self) -> float | None:
        """Cutoff of the filter that is advised for all files."""
        return None if (advised := advised_filter(self.readings)) is None else advised.cutoff

    @declare.computed(declare.part(Budget, "by which the uncertainties were found", key="budget", optional=True))
    def stated_budget(self) -> Budget | None:
        """Budget, as documents have it."""
        return self.budget

    @declare.computed(declare.rows(MotionRow, "by the option motion: where each ends", key="motion", optional=True))
    def motion_rows(self) -> list[MotionRow] | None:
        """Velocity and displacement at their ends."""
        return [one.row for one in self.motions] if self.motion else None

    @declare.computed(
        declare.rows(PairRow, "by the option pair: what two channels do together", key="pairs", optional=True)
    )
    def pair_rows(self) -> list[PairRow] | None:
        """Comparison of two channels of each file."""
        return [one.row for one in self.pairs] if self.pair else None

    @declare.computed(declare.part(SpecifiedRecords, "the verdict by a specification", key="spec", optional=True))
    def specified(self) -> SpecifiedRecords | None:
        """Verdict, with the instruments whose calibration had run out."""
        lapses = [] if self.performed is None else self.performed.lapses
        overdue = [one.instrument for one in lapses]
        return None if self.verdict is None else SpecifiedRecords(self.verdict, overdue)

    @declare.computed(declare.part(SensorRow, "by the option sensor: the blows on it", key="sensor", optional=True))
    def sensor_row(self) -> SensorRow | None:
        """Sensor with its blows."""
        return None if self.sensor is None else self.sensor.row

    @declare.computed(
        declare.rows(ResponseSummary, "each response channel over its blows", key="response_summary", optional=True)
    )
    def summed_responses(self) -> list[ResponseSummary] | None:
        """Each response channel summed up; None where no base was named."""
        return self.response_summaries if responding(self.readings) else None

    @declare.computed(
        declare.rows(
            CampaignRow, "of several channels: the same for each, as in campaign", key="campaigns", optional=True
        )
    )
    def campaign_rows(self) -> list[CampaignRow] | None:
        """Campaigns of several channels."""
        return [CampaignRow.of(one) for one in self.campaigns] if len(self.campaigns) > 1 else None

    @declare.computed(
        declare.rows(BlowRow, "all blows, file by file", label="blows", headline="count", in_document=False)
    )
    def blows(self) -> list[BlowRow]:
        """Table of blows."""
        return blow_rows(self.readings)

    @declare.computed(declare.rows(MeanOfFigure, "means over all files", headline="each", in_document=False))
    def means(self) -> list[MeanOfFigure]:
        """Means of a campaign whose unit is known: files in other units enter none of them."""
        campaign = min(self.campaigns, key=lambda declared: declared.unit == "", default=None)
        if campaign is None:
            return []
        units = units_given(campaign.unit)
        known = {name: declared.quantity.within(units) for name, declared in declarations(RecordedPulse).items()}
        known["interval"] = MILLISECONDS
        pairs = [(name, known[name]) for name in campaign.statistics if name in known]
        return [
            MeanOfFigure(name.replace("_", " "), campaign.statistics[name].mean, quantity)
            for name, quantity in pairs
            if quantity.si in MEANS_SHOWN
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
        usual = usual_unit(unit)
        return history_curve(channel.time[chosen], channel.values[chosen], unit, usual, channel.name)

    def tables(self) -> dict[str, str]:
        """Return all pulses as CSV text."""
        unit = [Column("unit", [shown_unit(self.unit, self.unit)] * len(self.blows))] if self.unit else []
        columns = [*self.columns()[:2], *unit, *self.columns()[2 + len(unit) :]]  # numbers of one unit are in that
        tables = {"pulses.csv": csv_table(columns)}
        if responding(self.readings):
            tables["responses.csv"] = csv_table(response_columns(self.readings))
        if self.motion:
            tables["motion.csv"] = csv_table(motion_columns(self.motions), HISTORY_DIGITS)
        if self.pair:
            units = {row.unit for row in self.pair_rows or ()}  # that which all pairs share
            given, known = units_given(units.pop() if len(units) == 1 else ""), declarations(PairRow)
            numbers = [column for column in data_columns(self, "pair_rows") if column.name in PAIR_COLUMNS]
            numbers = [column._replace(si=known[column.name].quantity.within(given).si) for column in numbers]
            tables["pairs.csv"] = csv_table(numbers)
            tables["transfer.csv"] = csv_table(transfer_columns(self.pairs), HISTORY_DIGITS)
        if self.verdict is not None:
            tables["shocks.csv"] = csv_table(shock_columns(self.verdict))
        if self.sensor is not None:
            tables["sensor.csv"] = csv_table(self.sensor.table())
        return tables


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
    counts = {each: sum(file.status == each for file in files) for each in reversed(failing)}
    failed = sum(counts.values())
    if not failed:
        return ()
    words = " and ".join(f"{count} {each}" for each, count in counts.items() if count)
    message = f"{words} of {len(files)} file{'s' if len(files) > 1 else ''}, and none was to be (--fail-on {status})"
    return (Notice("fail-on", message, float(failed), 0.0, FAILED),)


# Codes of findings that are warnings of the result too: what all its figures depend on
NOTED = (
    "unit-unknown", "not-calibrated", "unreadable", "rate-overrules", "unit-overrules", "measurements", "start-times",
    "start-unknown", "count-differs",
)  # fmt: skip


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


def shock_columns(verdict: RecordsVerdict) -> list[Column]:
    """Return all shocks with their verdicts: a line each, a value and a margin for each clause, in SI."""
    by_name = dict.fromkeys(clause.clause for one in verdict.shocks for clause in one.found.clauses)
    rows, units = [], {"time": "s"}
    for number, shock in enumerate(verdict.shocks, start=1):
        row: dict[str, object] = {
            "number": number,
            "file": shock.file,
            "channel": shock.reading.channel.name,
            "blow": shock.number,
            "direction": shock.direction,
            "time": shock.pulse.time,
            "verdict": shock.found.verdict,
            "fails": ", ".join(clause.clause for clause in shock.found.clauses if clause.verdict == FAIL),
        }
        clauses = {clause.clause: clause for clause in shock.found.clauses}
        for name in by_name:
            clause = clauses.get(name)
            judged_here = clause is not None and clause.verdict != NOT_JUDGED
            for what in ("value", "margin", "uncertainty"):
                key = f"{name} {what}".replace(" value", "")
                row[key] = getattr(clause, what) if judged_here else math.nan
                units[key] = units.get(key) or (clause.unit if clause is not None else "")
        rows.append(row)
    return columns_of_mappings(rows, units)
