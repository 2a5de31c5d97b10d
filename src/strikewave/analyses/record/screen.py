"""Records as a command: read, examine, sum up, print, draw."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.analyses.clauses import SHOWN, clause_columns, clause_name, decision_words, value_words
from strikewave.analyses.record.budget_chapter import (
    budget_lines,
    mean_expanded,
    share_table,
    uncertainty_table,
    with_doubt,
)
from strikewave.analyses.record.chapters import (
    LEFT_OUT_FIRST,
    MORE_COLUMNS,
    motion_table,
    pair_reasons,
    pair_table,
    sensor_table,
)
from strikewave.analyses.record.examine import RecordsAsked, examined
from strikewave.analyses.record.figures.records import figure_unit
from strikewave.analyses.record.options import filtered_folder
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.rows import (
    INTEGRALS,
    FilterRow,
    ResponseSummary,
    advised_filter,
    filter_effect,
    harmed,
    name_of,
    responding,
)
from strikewave.analyses.record.sentences import WHY_HEAD, name_of_shock, named, record_words, why_of_shock
from strikewave.analyses.record.tables import rows_of, short_names
from strikewave.base.declare import MORE
from strikewave.base.result import Source
from strikewave.base.shock_quantities import (
    BANDWIDTH,
    FREQUENCY,
    MICROSECONDS,
    MILLISECONDS,
    PULSE_WIDTH,
    RISE_TIME,
    usual_unit,
)
from strikewave.base.texts import percent
from strikewave.base.units import DIMENSIONS
from strikewave.records import Campaign, ChannelReading, FileReading, worst
from strikewave.records.campaign import COPY, SUMMED, WITHOUT_RINGING
from strikewave.records.measuring import RecordedPulse
from strikewave.records.response import MeasuredResponse
from strikewave.records.ringing import BandSplit, RigidPulse
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.numbers import shown_unit, with_unit
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import NONE
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import number, print_rows, report_table, significant, table, tell
from strikewave.signal.filters import ADVISED_LOSS, Filter
from strikewave.specifications.judged_records import RecordsVerdict
from strikewave.specifications.judging import WORST_FIRST

MOST_LINES = 12  # files or channels that have a line of their own, or a table, on the screen; the others are counted
MOST_ROWS = 60  # files shown in the table on the screen


def tell_first(lines: Sequence[str], most: int, others: str, indent: str = "") -> None:
    """Print the first lines, and how many others there are."""
    for line in lines[:most]:
        tell(line, indent)
    if len(lines) > most:
        tell(f"{len(lines) - most} more {others}: see report and JSON", indent)


def print_table(title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]]) -> None:
    """Print a table, or its first rows."""
    if len(rows) > MOST_ROWS:
        title = f"{title}, the first {MOST_ROWS} of {len(rows)} rows"
    table(title, columns, rows[:MOST_ROWS])


def mean_of(values: Sequence[float]) -> float:
    """Return the mean of those that are finite; NaN where none is."""
    finite = [value for value in values if math.isfinite(value)]
    return sum(finite) / len(finite) if finite else math.nan


def value_text(value: float, unit: str) -> str:
    """Write a figure in the unit of its channel; a dash where there is none."""
    if value != value:
        return "-"
    if unit == "1":
        return f"{significant(1e6 * value, 5)} ustrain"
    if unit in DIMENSIONS:
        return with_unit(value, unit, usual_unit(unit), 5)
    return f"{significant(value, 5)} {unit}".strip()


def integral_text(value: float, unit: str) -> str:
    """Write an integral over time of what a channel measures in a unit; a dash where there is none."""
    integral = INTEGRALS.get(unit, "")
    if value != value:
        return "-"
    known = integral in DIMENSIONS
    return with_unit(value, integral, integral) if known else f"{significant(value, 4)} {integral}".strip()


def print_campaign(campaign: Campaign, readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print the figures of a channel over all blows, and which of them were left out."""
    writers = _writers(campaign.unit)
    rows = _campaign_rows(campaign, writers)
    if not rows and len(readings) > 1:
        tell(f"{campaign.channel}: nothing is left to sum up")
    if not rows or not campaign.sums_up:
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
    for outlier in campaign.outliers:
        if outlier.figure in ("peak", "width", "interval"):  # the velocity change goes with the peak
            write, statistic = writers[outlier.figure], campaign.statistics[outlier.figure]
            with_it = f"{write(outlier.mean_with)}, scatter {percent(outlier.cv_with, 2)}"
            tell(
                f"with the {outlier.figure} of {names[outlier.path]}, {write(outlier.value)}, the mean would be "
                f"{with_it}, instead of {write(statistic.mean)}, {percent(statistic.cv, 2)}"
            )


def _writers(unit: str) -> dict[str, Any]:
    """Return what writes each figure of a channel with its unit."""
    return {
        **dict.fromkeys(("peak", "rigid_peak"), lambda v: value_text(v, unit)),
        "velocity_change": lambda v: integral_text(v, unit),
        "interval": lambda v: amount(MILLISECONDS, v),
        "ringing_frequency": lambda v: amount(FREQUENCY, v),
        **dict.fromkeys(("rise", "width", "rigid_width"), lambda v: amount(MICROSECONDS, v)),
    }


def _campaign_rows(campaign: Campaign, writers: Mapping[str, Any]) -> list[list[str]]:
    """Return a row a figure: mean, scatter, bounds, blows, median, robust scatter, trend."""
    rows = []
    for name, statistic in campaign.statistics.items():
        write, line, several = writers[name], campaign.trends.get(name), statistic.n > 1
        trend = "-" if line is None else percent(line.change, 1, "+") + (" *" if line.significant else "")
        bounds = f"{write(statistic.low)} to {write(statistic.high)}" if several else "-"
        cv = percent(statistic.cv, 2) if several else "-"
        robust = [write(statistic.median), percent(statistic.robust_cv, 2)] if several else ["-", "-"]
        called = f"{name.removeprefix('rigid_')} without ringing" if name in WITHOUT_RINGING else name.replace("_", " ")
        rows.append([called, write(statistic.mean), cv, bounds, str(statistic.n), *robust, trend])
    return rows


MOST_REASONS = 3  # reasons of pairs, and of a file that is not good, that are listed; the others are counted


def print_files(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print a table of files and their channels, and why some files are not good."""
    rows = [row for file in readings for row in _file_rows(file, names[file.path])]
    columns = [
        *(*keys("file"), *texts("channel"), *texts("status"), *numerals("blows", "peak")),
        *numerals("rise time 10-90 % (us)", priority=MORE),
        *numerals("pulse width at 10 % (us)"),
        *numerals("velocity change", priority=MORE),
    ]
    print_table(f"{len(readings)} records" if len(readings) > 1 else readings[0].path, columns, rows)
    alike: dict[tuple[str, str], list[str]] = {}
    for file in readings:
        if file.status != "good":
            more = len(file.reasons) - MOST_REASONS
            counted = [f"{more} more reasons: see report and JSON"] * (more > 0)
            reasons = "; ".join([*file.reasons[:MOST_REASONS], *counted])
            alike.setdefault((file.status, reasons), []).append(names[file.path])
    lines = [f"{named(where)}, {status}: {reasons}" for (status, reasons), where in alike.items()]
    copies: dict[str, list[str]] = {}
    for file, reading in rows_of(readings):
        for finding in reading.findings:
            if finding.code == COPY:  # harms no figure and leaves the file good, but not the scatter
                of = f"{reading.channel.name} of " if len(file.channels) > 1 else ""
                copies.setdefault(finding.message, []).append(of + names[file.path])
    lines += [f"{named(where)}: {message}" for message, where in copies.items()]
    tell_first(lines, MOST_LINES, "reasons why files are not good, or are copies", "  ")


def print_rebounds(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
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
    of_peak = " to ".join(dict.fromkeys(percent(share, 0) for share in (min(shares), max(shares))))
    after = " to ".join(dict.fromkeys(amount(MILLISECONDS, lag, digits=3) for lag in (min(lags), max(lags))))
    tell(
        f"{len(shares)} rebound{'s' if len(shares) > 1 else ''}, counted with their blows, in {named(where)}: "
        f"{of_peak} of the peak, {after} after it"
    )


def _file_rows(file: FileReading, name: str) -> list[list[str]]:
    """Return a row a channel, with the number of its blows and the means of their figures; one for a file without."""
    rows = [] if file.channels else [[name, "-", file.status, "-", "-", "-", "-", "-"]]
    for reading in file.channels:
        unit = reading.channel.unit
        peak, rise, width, change = (
            mean_of([getattr(pulse, figure) for pulse in reading.pulses])
            for figure in ("peak", "rise", "width", "velocity_change")
        )
        rows.append(
            [
                *(name, reading.channel.name, worst((*file.findings, *reading.findings)), str(len(reading.pulses))),
                _doubted(reading, "peak", peak, value_text(peak, unit)),
                number(rise, *RISE_TIME.units),
                _doubted(reading, "width", width, number(width, *PULSE_WIDTH.units)),
                _doubted(reading, "velocity_change", change, integral_text(change, unit)),
            ]
        )
    return rows


def _doubted(reading: ChannelReading, name: str, mean: float, text: str) -> str:
    """Return a mean, as ``text`` has it, or with its expanded uncertainty, where a budget gives one."""
    if not reading.uncertainties:
        return text
    expanded = mean_expanded(reading, name)
    if not math.isfinite(expanded):
        return f"{text} ± ?"
    value = with_doubt(mean, name, reading.channel.unit, expanded)
    bare = name == "width" or reading.channel.unit == ""
    return value.rpartition(" ")[0] if bare else value


def print_filter(files: Sequence[FileReading], filter_: Filter | None) -> None:
    """Say what the filters did to each channel, or which cutoff would leave the steepest blow of all as it is."""
    names = short_names([file.path for file in files]) if len(files) > 1 else {}
    channels = [
        (", ".join([*filter(None, [names.get(file.path)]), reading.channel.name]), reading)
        for file, reading in rows_of(files)
    ]
    passed = [
        f"{called}: {finding.message}"
        for called, reading in channels
        for finding in reading.findings
        if finding.code == "high-pass"
    ]
    tell_first(passed, MOST_LINES, "channels are filtered so")
    advised = advised_filter(files) if filter_ is None else None
    if filter_ is not None:
        effects = [f"{called}: {_effect(filter_effect(reading, filter_))}" for called, reading in channels]
        tell_first(effects, MOST_LINES, "channels are filtered so")
    elif advised is not None:
        tell(
            f"a low-pass of {amount(BANDWIDTH, advised.cutoff)} or more (--filter) changes peak, pulse width and "
            f"velocity change of a half-sine as steep as these by at most {percent(ADVISED_LOSS, 0)}"
        )


def _effect(effect: FilterRow) -> str:
    """Say what a filter left of the blows of a channel; see `filter_effect`."""
    sentence = effect.name
    if effect.peak_left:
        peak, width = mean_of(effect.peak_left), mean_of(effect.width_left)
        sentence += f" leaves {percent(peak)} of the peak, {percent(width)} of the width"
    if effect.half_sine_peak_left is not None:
        sentence += f" (of a half-sine as wide {percent(effect.half_sine_peak_left)})"
    if effect.effect:
        figures = (("peak", "peak"), ("width", "width"), ("velocity_change", "velocity change"))
        shares = [f"{words} {percent(mean_of([one[key] for one in effect.effect]))}" for key, words in figures]
        sentence += f"; filter effect on the smooth pulse alone: {', '.join(shares)} left"
    return sentence


DOUBTED = " ?"  # stands behind a figure that a finding harms


def print_responses(
    readings: Sequence[FileReading], summaries: Sequence[ResponseSummary], names: Mapping[str, str]
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
        for one in reading.responses:
            places = {"file": names[file.path], "channel": reading.channel.name, "blow": str(one.blow)}
            rows.append(
                [place for name, place in places.items() if keyed[name]]
                + [
                    text + DOUBTED * (name in wrong and text != "-")
                    for name, text in _response_figures(one, reading.channel.unit).items()
                ]
            )
    only = "" if keyed["channel"] else f": {channels[0][1].channel.name}"
    columns = [*(keys("file") if keyed["file"] else []), *(texts("channel") if keyed["channel"] else [])]
    columns += [*(numerals("blow") if keyed["blow"] else []), *numerals("peak")]
    columns += numerals("over base", priority=MORE)
    columns += numerals("delay (ms)", "effective duration (ms)")
    columns += numerals("RMS", priority=MORE)
    columns += numerals("strongest mode (Hz)", "damping ratio (%)")
    print_table(f"Response channels{only}", columns, rows)
    if doubted:
        tell(f"{DOUBTED.strip()} a figure that a finding harms: see the report")
    for together in summaries:
        _print_summary(together)


def _response_figures(one: MeasuredResponse, unit: str) -> dict[str, str]:
    """Return the figures of a response, as the table has them."""
    return {
        "peak": value_text(one.peak, unit),
        "ratio": "-" if math.isnan(one.ratio) else f"{one.ratio:.3g}",
        "delay": number(one.delay, *MILLISECONDS.units),
        "duration": number(one.duration, *MILLISECONDS.units),
        "rms": value_text(one.rms, unit),
        "frequency": next((number(mode.frequency, *FREQUENCY.units) for mode in one.modes), "-"),
        "damping": next((f"{1e2 * mode.damping:.3g}" for mode in one.modes), "-"),
    }


def _print_summary(one: ResponseSummary) -> None:
    """Print mean and scatter of the responses of a channel that has more than one."""
    writers: dict[str, Any] = {
        **dict.fromkeys(("peak", "rms"), lambda v: value_text(v, one.unit)),
        # of a peak before that of the base below 0
        "delay": lambda v: f"{number(v, *MILLISECONDS.units)} {shown_unit(*MILLISECONDS.units)}",
        "duration": lambda v: amount(MILLISECONDS, v),
        "ratio": lambda v: significant(v, 4),
        "frequency": lambda v: amount(FREQUENCY, v),
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


def print_without_ringing(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print the pulses without ringing beside those with it, where they differ by more than 5 %."""
    rows = []
    for file, reading in rows_of(readings):
        pulses = [pulse for pulse in reading.pulses if pulse.rigid is not None or pulse.split is not None]
        if any(pulse.differs_without_ringing or pulse.differs_by_split for pulse in pulses):
            rows.append([names[file.path], reading.channel.name, *_figures(pulses, reading.channel.unit)])
    if rows:
        columns = [*keys("file"), *texts("channel"), *numerals("peak", "uncertainty", "by band split")]
        columns += [*numerals("of that", priority=MORE), *numerals("with ringing")]
        columns += numerals(
            *("pulse width at 10 % (us)", "ringing (Hz)", "cutoff of the split (Hz)", "apart (uncertainties)"),
            priority=MORE,
        )
        print_table("Without ringing", columns, rows)
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


def _figures(pulses: Sequence[RecordedPulse], unit: str) -> list[str]:
    """Return the means of pulses without ringing: by fit and by band split, and how far these lie apart."""
    raw = mean_of([pulse.peak for pulse in pulses])
    joint = [pulse.rigid for pulse in pulses if pulse.rigid is not None]
    split = [pulse.split for pulse in pulses if pulse.split is not None and pulse.split.separable]
    best = mean_of([one.peak for one in joint or split])
    apart = mean_of([pulse.methods_apart for pulse in pulses])
    return [
        *_peak_of(joint, unit),
        *(_peak_of(split, unit) if split else ("not separable", "-")),
        percent(raw / best - 1.0, 1, "+"),
        number(mean_of([one.width for one in joint or split]), *PULSE_WIDTH.units),
        number(mean_of([one.frequency for one in joint]), *FREQUENCY.units),
        number(mean_of([one.cutoff for one in split]), *FREQUENCY.units),
        "-" if math.isnan(apart) else f"{apart:.2g}",
    ]


def _peak_of(found: Sequence[RigidPulse | BandSplit], unit: str) -> tuple[str, str]:
    """Return the mean peak without ringing, and its standard uncertainty over it."""
    peak, doubt = mean_of([one.peak for one in found]), mean_of([one.peak_uncertainty for one in found])
    return value_text(peak, unit), "-" if math.isnan(peak) else percent(doubt / abs(peak))


MOST_SHOCKS = 20  # shocks of the table on the screen, the failed ones first; report and JSON have all


def print_verdict(verdict: RecordsVerdict, names: dict[str, str]) -> None:
    """Print the clauses, and the shocks where there are several."""
    several = len({shock.reading.channel.name for shock in verdict.shocks}) > 1
    many = len(verdict.shocks) > 1
    columns = clause_columns([clause for clause, _ in verdict.clauses])
    if many:
        worst = [name_of_shock(shock, names, several) for _, shock in verdict.clauses]
        columns.append(Column("worst", worst, priority=MORE, words=True))
    print_rows(f"By {verdict.specification.title}", columns)
    tell(decision_words(verdict.asked.rule, verdict.asked.holds, verdict.asked.not_stated))
    for clause, _ in verdict.clauses:
        if clause.reason:
            tell(f"{clause.clause}: {clause.reason}", "  ")
    if many:
        _print_shocks(verdict, names, several)


def _print_shocks(verdict: RecordsVerdict, names: dict[str, str], several: bool) -> None:
    shocks = sorted(verdict.shocks, key=lambda shock: WORST_FIRST.index(shock.found.verdict))
    by_name = list(dict.fromkeys(clause.clause for shock in shocks for clause in shock.found.clauses))
    figures = [name for name in by_name if name in ("peak", "velocity change") or name.startswith("pulse width")]
    directed = any(shock.direction for shock in shocks)
    rows = []
    for shock in shocks[:MOST_SHOCKS]:
        clauses = {clause.clause: clause for clause in shock.found.clauses}
        rows.append(
            [
                name_of_shock(shock, names, several),
                *([shock.direction or NONE] if directed else []),
                *[value_words(clauses[name]) if name in clauses else NONE for name in figures],
                SHOWN[shock.found.verdict],
                why_of_shock(shock),
            ]
        )
    columns = [*keys("shock"), *(texts("direction") if directed else []), *numerals(*map(clause_name, figures))]
    columns += [*texts("verdict"), *texts(WHY_HEAD, priority=MORE)]
    left = f", the first {MOST_SHOCKS} of {len(shocks)}" if len(shocks) > MOST_SHOCKS else ""
    table(f"Shocks, those that fail first{left}", columns, rows)


def examine_records(asked: RecordsAsked, output: Output) -> int:
    """Examine records, write and print what they say, and return the exit code."""
    asked.examination.check()
    asked = dataclasses.replace(asked, files=measured.ordered(asked.files))
    paths = [Path(measured.shown(file)) for file in asked.files]
    name = name_of(paths)
    usual = f"record-{name}" + ("" if asked.specification is None else f"-{asked.specification.file_name}")
    usual = filtered_folder(usual, asked.request)
    origin = measured.source_of_records(name, paths, output, usual)
    return run_and_write(RecordCommand(asked, origin), output, usual, origin.text)


@dataclass(frozen=True)
class RecordCommand(Command[RecordResult]):
    """Examination of records."""

    indent: ClassVar[int | None] = None

    asked: RecordsAsked
    origin: Source

    def solve(self) -> RecordResult:
        """Return what the records say."""
        return examined(self.asked, self.origin)

    def summary(self, result: RecordResult) -> str:
        """Say what the records have in common, and which are bad."""
        return record_words(result)

    def show(self, result: RecordResult) -> None:
        """Print the verdict, files, campaigns, and what the filter did."""
        names = short_names([file.path for file in result.readings])
        if result.verdict is not None:
            print_verdict(result.verdict, names)
        print_records(result)
        if result.budget is not None:
            blows = [blow for _, reading in rows_of(result.readings) for blow in reading.uncertainties]
            report_table(share_table(blows[0]) if len(blows) == 1 else uncertainty_table(result, names), keys=2)
            for line in budget_lines(result):
                tell(line, "  ")
        if result.motion:
            report_table(motion_table(result.motions))
        if result.sensor is not None:
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
    for campaign in result.campaigns[:MOST_LINES]:
        print_campaign(campaign, readings, names)
    more = sum(campaign.sums_up and bool(campaign.statistics) for campaign in result.campaigns[MOST_LINES:])
    if more:
        tell(f"{more} more channels are summed up: see report and JSON")
    print_filter(readings, result.filter)
