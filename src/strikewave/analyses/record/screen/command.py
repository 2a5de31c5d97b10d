"""Records as a command: read, examine, sum up, print, draw."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from strikewave.analyses.record.chosen import name_of
from strikewave.analyses.record.filter_options import filtered_folder
from strikewave.analyses.record.motion_chapter import motion_table
from strikewave.analyses.record.pair_chapter import LEFT_OUT_FIRST, pair_reasons, pair_table
from strikewave.analyses.record.question import completed, examined
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.screen.budgets import print_budget
from strikewave.analyses.record.screen.campaigns import print_campaigns
from strikewave.analyses.record.screen.files import MOST_REASONS, print_files, print_rebounds
from strikewave.analyses.record.screen.filters import print_filter
from strikewave.analyses.record.screen.kit import tell_first
from strikewave.analyses.record.screen.responses import print_responses
from strikewave.analyses.record.screen.without_ringing import print_without_ringing
from strikewave.analyses.record.sensor_chapter import MORE_COLUMNS, sensor_table
from strikewave.analyses.record.tables import short_names
from strikewave.analyses.record.verdicts.screen import print_verdict
from strikewave.analyses.record.words import record_words
from strikewave.base.result import Source
from strikewave.records import Options, Request
from strikewave.reporting import measured_files as measured
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import report_table

if TYPE_CHECKING:
    from strikewave.cases.stack_of_case import StatedSensor
    from strikewave.cases.stated_test import StatedTest
    from strikewave.records.budget import Budget
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification


def examine_records(
    files: Sequence[str],
    wanted: Request,
    options: Options,
    output: Output,
    in_columns: bool = False,
    fail_on: str = "",
    motion: bool = False,
    specification: Specification | None = None,
    asked: Callable[[Mapping[str, str]], Asked] | None = None,
    pair: tuple[str, str] | tuple[()] = (),
    sensor: StatedSensor | None = None,
    budget: Budget | None = None,
) -> int:
    """Examine records, write and print what they say, and return the exit code.

    Parameters
    ----------
    files : sequence of str
        Paths, or patterns.
    wanted, options : Request, Options
        What is wanted of them, and how they are read.
    output : Output
        Where the result goes.
    in_columns : bool
        Whether the channels of a file are repeats of one test.
    fail_on : str
        Status that makes the exit code 3; empty for none.
    motion : bool
        Whether velocity and displacement are given.
    specification : Specification or None
        What the blows are judged by.
    asked : callable or None
        How they are, for what is stated of the test.
    pair : tuple of str
        Two channels that are compared as sensors on one object; empty for none.
    sensor : StatedSensor or None
        On what the blows are tried.
    budget : Budget or None
        By which the uncertainties of the blows are found.

    Raises
    ------
    InputError, StrikewaveError
        If not one file can be read.
    """
    files = measured.ordered(files)
    paths = [Path(measured.shown(file)) for file in files]
    name = name_of(paths)
    usual = f"record-{name}" + ("" if specification is None else f"-{specification.file_name}")
    usual = filtered_folder(usual, wanted)
    origin = measured.source_of_records(name, paths, output, usual)
    judged = None if specification is None or asked is None else (specification, asked(origin.test))
    performed = None if output.test is None else output.performed
    command = RecordCommand(
        files, wanted, options, origin, in_columns, fail_on, motion, judged, pair, sensor, performed, budget
    )
    return run_and_write(command, output, usual, origin.text)


@dataclass(frozen=True)
class RecordCommand(Command[RecordResult]):
    """The examination of records."""

    indent: ClassVar[int | None] = None

    files: Sequence[str]
    wanted: Request
    options: Options
    origin: Source
    in_columns: bool = False
    fail_on: str = ""
    motion: bool = False
    judged: tuple[Specification, Asked] | None = None
    pair: tuple[str, str] | tuple[()] = ()
    sensor: StatedSensor | None = None
    performed: StatedTest | None = None
    budget: Budget | None = None

    def solve(self) -> RecordResult:
        """Return what the records say."""
        found = examined(self.files, self.wanted, self.options, self.origin, self.in_columns, self.fail_on)
        sensor = None if self.sensor is None else (self.sensor, "--sensor")
        return completed(found, self.motion, self.pair, sensor, self.judged, self.performed, self.budget)

    def summary(self, result: RecordResult) -> str:
        """Say what the records have in common, and which are bad."""
        return record_words(result)

    def show(self, result: RecordResult) -> None:
        """Print the verdict, files, campaigns, and what the filter did."""
        if result.verdict is not None:
            print_verdict(result.verdict, short_names([file.path for file in result.readings]))
        print_records(result)
        if result.budget is not None:
            print_budget(result)
        if result.motion:
            report_table(motion_table(result.motions))
        if result.sensor is not None:
            names = short_names([file.path for file in result.readings])
            report_table(sensor_table(result.sensor, names), more=MORE_COLUMNS)
        if result.pair:
            report_table(pair_table(result.pairs), more=LEFT_OUT_FIRST)
            tell_first(pair_reasons(result.pairs), MOST_REASONS, "files have reasons of their own", "  ")

    def draw(self, result: RecordResult, folder: Path) -> list[str]:
        """Write page and summary."""
        from strikewave.analyses.record.report import draw_result

        return draw_result(result, folder)


def print_records(result: RecordResult) -> None:
    """Print files, pulses without ringing, responses, rebounds, campaigns, and what the filter did."""
    readings = result.readings
    names = short_names([file.path for file in readings])
    print_files(readings, names)
    print_without_ringing(readings, names)
    print_responses(readings, result.response_summaries, names)
    print_rebounds(readings, names)
    print_campaigns(result.campaigns, readings, names)
    print_filter(readings, result.filter)
