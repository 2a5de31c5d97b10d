"""Records as a command: read, examine, sum up, print, draw."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from strikewave.analyses.record.budget_chapter import (
    budget_lines,
    mean_expanded,
    share_table,
    uncertainty_table,
    with_doubt,
)
from strikewave.analyses.record.chosen import advised_filter
from strikewave.analyses.record.figures.campaigns import figure_unit
from strikewave.analyses.record.filter_options import filtered_folder
from strikewave.analyses.record.motion_chapter import motion_table
from strikewave.analyses.record.pair_chapter import LEFT_OUT_FIRST, pair_reasons, pair_table
from strikewave.analyses.record.question import completed, examined
from strikewave.analyses.record.responses import ResponseSummary, harmed, responding
from strikewave.analyses.record.result import (
    INTEGRALS,
    RecordResult,
    filter_effect,
    name_of,
)
from strikewave.analyses.record.sensor_chapter import MORE_COLUMNS, sensor_table
from strikewave.analyses.record.tables import rows_of, short_names
from strikewave.analyses.record.verdicts.screen import print_verdict
from strikewave.analyses.record.words import named, record_words
from strikewave.base.result import Source
from strikewave.base.units import DIMENSIONS
from strikewave.records import (
    Campaign,
    ChannelReading,
    FileReading,
    Options,
    Request,
    worst,
)
from strikewave.records.band_split import BandSplit
from strikewave.records.campaign import SUMMED, WITHOUT_RINGING
from strikewave.records.rigid_pulse import RigidPulse
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import MORE, ScreenColumn, keys, numerals, texts
from strikewave.reporting.numbers import percent, shown_unit, with_unit
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import number, report_table, significant, table, tell
from strikewave.signal.filters import Filter

if TYPE_CHECKING:
    from strikewave.cases.sensor_file import StatedSensor
    from strikewave.cases.stated_test import StatedTest
    from strikewave.records.budget.contributions import Budget
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification

MOST_REASONS = 3
"""Reasons of pairs, and of a file that is not good, that are listed; the others are counted."""
MOST_LINES = 12
"""Files or channels that have a line of their own, or a table, on the screen; the others are counted."""
MOST_ROWS = 60
"""Files shown in the table on the screen."""
DOUBTED = " ?"
"""Stands behind a figure that a finding harms."""


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
        _print(result)
        if result.budget is not None:
            _print_budget(result)
        if result.motion:
            report_table(motion_table(result.motions))
        if result.sensor is not None:
            names = short_names([file.path for file in result.readings])
            report_table(sensor_table(result.sensor, names), more=MORE_COLUMNS)
        if result.pair:
            report_table(pair_table(result.pairs), more=LEFT_OUT_FIRST)
            _tell_first(pair_reasons(result.pairs), MOST_REASONS, "files have reasons of their own", "  ")

    def draw(self, result: RecordResult, folder: Path) -> list[str]:
        """Write page and summary."""
        from strikewave.analyses.record.drawn import draw_result

        return draw_result(result, folder)


def _print(result: RecordResult) -> None:
    readings = result.readings
    names = short_names([file.path for file in readings])
    rows = [row for file in readings for row in _rows(file, names[file.path])]
    columns = [
        *(*keys("file"), *texts("channel"), *texts("status"), *numerals("blows", "peak")),
        *numerals("rise time 10-90 % (us)", priority=MORE),
        *numerals("pulse width at 10 % (us)"),
        *numerals("velocity change", priority=MORE),
    ]
    _table(f"{len(readings)} records" if len(readings) > 1 else readings[0].path, columns, rows)
    alike: dict[tuple[str, str], list[str]] = {}
    for file in readings:
        if file.status != "good":
            alike.setdefault((file.status, _reasons(file)), []).append(names[file.path])
    lines = [f"{named(where)}, {status}: {reasons}" for (status, reasons), where in alike.items()]
    _tell_first(lines, MOST_LINES, "files are not good, for reasons of their own", "  ")
    _print_rigid(readings, names)
    _print_responses(readings, result.response_summaries, names)
    _print_rebounds(readings, names)
    for campaign in result.campaigns[:MOST_LINES]:
        _print_campaign(campaign, readings, names)
    more = sum(campaign.sums_up and bool(campaign.statistics) for campaign in result.campaigns[MOST_LINES:])
    if more:
        tell(f"{more} more channels are summed up: see report and JSON")
    _print_filter(readings, result.filter)


def _reasons(file: FileReading) -> str:
    """Return why a file is not good, or the worst of many reasons and how many more there are."""
    more = len(file.reasons) - MOST_REASONS
    counted = [f"{more} more reasons: see report and JSON"] if more > 0 else []
    return "; ".join([*file.reasons[:MOST_REASONS], *counted])


def _tell_first(lines: Sequence[str], most: int, others: str, indent: str = "") -> None:
    """Print the first lines, and how many others there are."""
    for line in lines[:most]:
        tell(line, indent)
    if len(lines) > most:
        tell(f"{len(lines) - most} more {others}: see report and JSON", indent)


def _print_budget(result: RecordResult) -> None:
    """Print the uncertainty of each blow, of a single one what it is made of, and what the budget holds."""
    names = short_names([file.path for file in result.readings])
    blows = [one for _, reading in rows_of(result.readings) for one in reading.uncertainties]
    report_table(share_table(blows[0]) if len(blows) == 1 else uncertainty_table(result, names), keys=2)
    for line in budget_lines(result):
        tell(line, "  ")


def _table(title: str, columns: Sequence[ScreenColumn], rows: Sequence[Sequence[str]]) -> None:
    """Print a table, or its first rows."""
    if len(rows) > MOST_ROWS:
        title = f"{title}, the first {MOST_ROWS} of {len(rows)} rows"
    table(title, columns, rows[:MOST_ROWS])


def _print_rigid(readings: Sequence[FileReading], names: dict[str, str]) -> None:
    """Print the pulses without ringing beside those with it, where they differ by more than 5 %."""
    rows = []
    for file in readings:
        for reading in file.channels:
            pulses = [pulse for pulse in reading.pulses if pulse.rigid is not None or pulse.split is not None]
            if not any(pulse.differs_without_ringing or pulse.differs_by_split for pulse in pulses):
                continue
            unit, raw = reading.channel.unit, _mean([pulse.peak for pulse in pulses])
            joint = [pulse.rigid for pulse in pulses if pulse.rigid is not None]
            split = [pulse.split for pulse in pulses if pulse.split is not None and pulse.split.separable]
            best = _mean([one.peak for one in joint or split])
            rows.append(
                [
                    names[file.path],
                    reading.channel.name,
                    *_peak_of(joint, unit),
                    *(_peak_of(split, unit) if split else ("not separable", "-")),
                    percent(raw / best - 1.0, 1, "+"),
                    number(_mean([one.width for one in joint or split]), "s", "us"),
                    number(_mean([one.frequency for one in joint]), "Hz", "Hz"),
                    number(_mean([one.cutoff for one in split]), "Hz", "Hz"),
                    _times(_mean([pulse.methods_apart for pulse in pulses])),
                ]
            )
    if rows:
        columns = [*keys("file"), *texts("channel"), *numerals("peak", "uncertainty", "by band split")]
        columns += [*numerals("of that", priority=MORE), *numerals("with ringing")]
        columns += numerals(
            *("pulse width at 10 % (us)", "ringing (Hz)", "cutoff of the split (Hz)", "apart (uncertainties)"),
            priority=MORE,
        )
        _table("Without ringing", columns, rows)
    _print_overlapping(readings, names)


def _print_overlapping(readings: Sequence[FileReading], names: dict[str, str]) -> None:
    """Say of how many blows the rigid part can be separated neither way, and why of the first."""
    overlapping = [
        (names[file.path], reading.channel.name, pulse.split.reason)
        for file, reading in rows_of(readings)
        for pulse in reading.pulses
        if pulse.rigid is None and pulse.split is not None and not pulse.split.separable
    ]
    if overlapping:
        name, channel, reason = overlapping[0]
        several = len(overlapping) > 1
        blows = f"{len(overlapping)} blows that ring" if several else "the blow that rings"
        first = f" (the first: {name}, {channel})" if several else ""
        tell(f"the rigid part of {blows} cannot be separated: {reason}{first}")


def _peak_of(found: Sequence[RigidPulse | BandSplit], unit: str) -> tuple[str, str]:
    """Return the mean peak without ringing, and its standard uncertainty over it."""
    peak, doubt = _mean([one.peak for one in found]), _mean([one.peak_uncertainty for one in found])
    return _value(peak, unit), "-" if math.isnan(peak) else percent(doubt / abs(peak))


def _times(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"


def _print_responses(
    readings: Sequence[FileReading], summaries: Sequence[ResponseSummary], names: dict[str, str]
) -> None:
    """Print what response channels do after the blows of their base, and all blows together."""
    channels = responding(readings)
    if not channels:
        return
    keyed = {
        "file": len({file.path for file, _ in channels}) > 1,
        "channel": len({reading.channel.name for _, reading in channels}) > 1,
        "blow": any(len(reading.responses) > 1 for _, reading in channels),
    }
    rows, doubted = [], False
    for file, reading in channels:
        wrong = harmed(file, reading)
        doubted = doubted or bool(wrong)
        unit = reading.channel.unit
        for one in reading.responses:
            places = {"file": names[file.path], "channel": reading.channel.name, "blow": str(one.blow)}
            figures = {
                "peak": _value(one.peak, unit),
                "ratio": "-" if math.isnan(one.ratio) else f"{one.ratio:.3g}",
                "delay": number(one.delay, "s", "ms"),
                "duration": number(one.duration, "s", "ms"),
                "rms": _value(one.rms, unit),
                "frequency": next((number(mode.frequency, "Hz", "Hz") for mode in one.modes), "-"),
                "damping": next((f"{1e2 * mode.damping:.3g}" for mode in one.modes), "-"),
            }
            rows.append(
                [place for name, place in places.items() if keyed[name]]
                + [text + DOUBTED * (name in wrong and text != "-") for name, text in figures.items()]
            )
    columns = [*(keys("file") if keyed["file"] else []), *(texts("channel") if keyed["channel"] else [])]
    columns += [*(numerals("blow") if keyed["blow"] else []), *numerals("peak")]
    columns += numerals("over base", priority=MORE)
    columns += numerals("delay (ms)", "effective duration (ms)")
    columns += numerals("RMS", priority=MORE)
    columns += numerals("strongest mode (Hz)", "damping ratio (%)")
    only = "" if keyed["channel"] else f": {channels[0][1].channel.name}"
    _table(f"Response channels{only}", columns, rows)
    if doubted:
        tell(f"{DOUBTED.strip()} a figure that a finding harms: see the report")
    for together in summaries:
        _print_summary(together)


def _print_summary(one: ResponseSummary) -> None:
    """Print mean and scatter of the responses of a channel that has more than one."""
    writers: dict[str, Any] = {
        **dict.fromkeys(("peak", "rms"), lambda v: _value(v, one.unit)),
        "delay": lambda v: (
            f"{number(v, 's', 'ms')} {shown_unit('s', 'ms')}"
        ),  # of a peak before that of the base below 0
        "duration": lambda v: with_unit(v, "s", "ms"),
        "ratio": lambda v: significant(v, 4),
        "frequency": lambda v: with_unit(v, "Hz", "Hz"),
        "damping": lambda v: percent(v, 3),
    }
    rows = []
    for name, statistic in one.statistics.items():
        if statistic.n > 1:
            write = writers[name]
            bounds = f"{write(statistic.low)} to {write(statistic.high)}"
            called = figure_unit(name, one.unit)[1]
            rows.append([called, write(statistic.mean), percent(statistic.cv, 2), bounds, str(statistic.n)])
    if rows:
        columns = [*keys("figure"), *numerals("mean", "scatter (CV)", "mean, 95 % bounds", "blows")]
        table(f"All responses together: {one.channel}", columns, rows)


def _print_rebounds(readings: Sequence[FileReading], names: dict[str, str]) -> None:
    """Say in a line what the files with rebounds have in common; each is listed in the report."""
    owners = [
        (names[file.path], pulse)
        for file in readings
        for reading in file.channels
        for pulse in reading.pulses
        if pulse.rebounds
    ]
    if not owners:
        return
    shares = [abs(rebound.peak / pulse.peak) for _, pulse in owners for rebound in pulse.rebounds]
    lags = [abs(rebound.time - pulse.time) for _, pulse in owners for rebound in pulse.rebounds]
    where = list(dict.fromkeys(name for name, _ in owners))
    tell(
        f"{len(shares)} rebound{'s' if len(shares) > 1 else ''}, counted with their blows, in {named(where)}: "
        f"{_span(min(shares), max(shares), percent, 0)} of the peak, "
        f"{_span(min(lags), max(lags), lambda lag, digits: with_unit(lag, 's', 'ms', digits), 3)} after it"
    )


def _span(low: float, high: float, write: Callable[[float, int], str], digits: int) -> str:
    """Write two bounds, or one where both read the same."""
    ends = list(dict.fromkeys([write(low, digits), write(high, digits)]))
    return " to ".join(ends)


def _rows(file: FileReading, name: str) -> list[list[str]]:
    if not file.channels:
        return [[name, "-", file.status, "-", "-", "-", "-", "-"]]
    rows = []
    for reading in file.channels:
        unit = reading.channel.unit
        means = {
            name: _mean([getattr(pulse, name) for pulse in reading.pulses])
            for name in ("peak", "rise", "width", "velocity_change")
        }
        rows.append(
            [
                name,
                reading.channel.name,
                worst((*file.findings, *reading.findings)),
                str(len(reading.pulses)),
                *_doubted(reading, "peak", means["peak"], _value(means["peak"], unit)),
                number(means["rise"], "s", "us"),
                *_doubted(reading, "width", means["width"], number(means["width"], "s", "us")),
                *_doubted(
                    reading,
                    "velocity_change",
                    means["velocity_change"],
                    _integral(means["velocity_change"], unit),
                ),
            ]
        )
    return rows


def _doubted(reading: ChannelReading, name: str, mean: float, text: str) -> list[str]:
    """Return a mean, as ``text`` has it, or with its expanded uncertainty, where a budget gives one."""
    if not reading.uncertainties:
        return [text]
    expanded = mean_expanded(reading, name)
    if not math.isfinite(expanded):
        return [f"{text} ± ?"]
    value = with_doubt(mean, name, reading.channel.unit, expanded)
    bare = name == "width" or reading.channel.unit == ""
    return [value.rpartition(" ")[0] if bare else value]


def _mean(values: Sequence[float]) -> float:
    finite = [value for value in values if math.isfinite(value)]
    return sum(finite) / len(finite) if finite else math.nan


def _value(value: float, unit: str) -> str:
    if value != value:
        return "-"
    if unit == "1":
        return f"{significant(1e6 * value, 5)} ustrain"
    if unit in DIMENSIONS:
        return with_unit(value, unit, "g" if unit == "m/s^2" else unit, 5)
    return f"{significant(value, 5)} {unit}".strip()


def _integral(value: float, unit: str) -> str:
    integral = INTEGRALS.get(unit, "")
    if value != value:
        return "-"
    known = integral in DIMENSIONS
    return with_unit(value, integral, integral) if known else f"{significant(value, 4)} {integral}".strip()


def _print_campaign(campaign: Campaign, readings: Sequence[FileReading], names: dict[str, str]) -> None:
    unit = campaign.unit
    writers: dict[str, Any] = {
        **dict.fromkeys(("peak", "rigid_peak"), lambda v: _value(v, unit)),
        "velocity_change": lambda v: _integral(v, unit),
        "interval": lambda v: with_unit(v, "s", "ms"),
        "ringing_frequency": lambda v: with_unit(v, "Hz", "Hz"),
        **dict.fromkeys(("rise", "width", "rigid_width"), lambda v: with_unit(v, "s", "us")),
    }
    rows = []
    for name, statistic in campaign.statistics.items():
        write = writers[name]
        line = campaign.trends.get(name)
        trend = "-" if line is None else percent(line.change, 1, "+") + (" *" if line.significant else "")
        bounds = "-" if statistic.n < 2 else f"{write(statistic.low)} to {write(statistic.high)}"
        cv = "-" if statistic.n < 2 else percent(statistic.cv, 2)
        robust = ["-", "-"] if statistic.n < 2 else [write(statistic.median), percent(statistic.robust_cv, 2)]
        called = f"{name.removeprefix('rigid_')} without ringing" if name in WITHOUT_RINGING else name.replace("_", " ")
        rows.append([called, write(statistic.mean), cv, bounds, str(statistic.n), *robust, trend])
    if not rows:
        if len(readings) > 1:
            tell(f"{campaign.channel}: nothing is left to sum up")
        return
    if not campaign.sums_up:
        return
    columns = [*keys("figure"), *numerals("mean", "scatter (CV)"), *numerals("mean, 95 % bounds")]
    columns += numerals("blows", "median", "robust scatter", "trend over the files", priority=MORE)
    table(f"All blows together: {campaign.channel}", columns, rows)
    if any(" *" in row[-1] for row in rows):
        tell("* a trend that scatter alone gives in less than 5 % of campaigns")
    gone: dict[str, list[str]] = {}
    for path, figures, _ in campaign.left_out:
        what = "all figures" if len(figures) == len(SUMMED) else ", ".join(figures).replace("_", " ")
        gone.setdefault(what, []).append(names[path])
    for what, where in gone.items():
        tell(f"left out: {what} of {named(where)}")
    for one in campaign.outliers:
        if one.figure in ("peak", "width", "interval"):  # the velocity change goes with the peak
            write = writers[one.figure]
            statistic = campaign.statistics[one.figure]
            with_it = f"{write(one.mean_with)}, scatter {percent(one.cv_with, 2)}"
            tell(
                f"with the {one.figure} of {names[one.path]}, {write(one.value)}, the mean would be {with_it}, instead "
                f"of {write(statistic.mean)}, {percent(statistic.cv, 2)}"
            )


def _print_filter(files: Sequence[FileReading], filter_: Filter | None) -> None:
    """Say what the filters did to each channel, or which cutoff would leave the steepest blow of all as it is."""
    names = short_names([file.path for file in files]) if len(files) > 1 else {}
    passed = []
    for file, reading in rows_of(files):
        called = ", ".join([*filter(None, [names.get(file.path)]), reading.channel.name])
        passed += [f"{called}: {finding.message}" for finding in reading.findings if finding.code == "high-pass"]
    _tell_first(passed, MOST_LINES, "channels are filtered so")
    if filter_ is None:
        advised = advised_filter(files)
        if advised is not None:
            kilohertz = significant(advised.cutoff / 1e3, 3)
            tell(
                f"a low-pass of {kilohertz} kHz or more (--filter) changes peak, pulse width and velocity change "
                "of a half-sine as steep as these by at most 2 %"
            )
        return
    effects = []
    for file, reading in rows_of(files):
        effect = filter_effect(reading, filter_)
        called = ", ".join([*filter(None, [names.get(file.path)]), reading.channel.name])
        sentence = f"{called}: {effect['name']}"
        if effect["peak_left"]:
            peak, width = _mean(effect["peak_left"]), _mean(effect["width_left"])
            sentence += f" leaves {percent(peak)} of the peak, {percent(width)} of the width"
        if effect["half_sine_peak_left"] is not None:
            sentence += f" (of a half-sine as wide {percent(effect['half_sine_peak_left'])})"
        if effect["effect"]:
            figures = (("peak", "peak"), ("width", "width"), ("velocity_change", "velocity change"))
            shares = [f"{words} {percent(_mean([one[key] for one in effect['effect']]))}" for key, words in figures]
            sentence += f"; filter effect on the smooth pulse alone: {', '.join(shares)} left"
        effects.append(sentence)
    _tell_first(effects, MOST_LINES, "channels are filtered so")
