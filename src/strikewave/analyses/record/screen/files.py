"""Files and their blows: a table of all, why some are not good, which rebound."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from strikewave.analyses.record.budget_chapter import mean_expanded, with_doubt
from strikewave.analyses.record.screen.kit import (
    MOST_LINES,
    integral_text,
    mean_of,
    print_table,
    tell_first,
    value_text,
)
from strikewave.analyses.record.tables import rows_of
from strikewave.analyses.record.words import named
from strikewave.base.shock_quantities import MILLISECONDS, PULSE_WIDTH, RISE_TIME
from strikewave.records import ChannelReading, FileReading, worst
from strikewave.records.campaign import COPY
from strikewave.reporting.faces import amount
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.numbers import percent
from strikewave.reporting.terminal import number, tell

MOST_REASONS = 3
"""Reasons of pairs, and of a file that is not good, that are listed; the others are counted."""


def print_files(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print a table of files and their channels, and why some files are not good."""
    rows = [row for file in readings for row in _rows(file, names[file.path])]
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
            alike.setdefault((file.status, _reasons(file)), []).append(names[file.path])
    lines = [f"{named(where)}, {status}: {reasons}" for (status, reasons), where in alike.items()]
    copies: dict[str, list[str]] = {}
    for file, reading in rows_of(readings):
        for finding in reading.findings:
            if finding.code == COPY:  # harms no figure and leaves the file good, but not the scatter
                of = f"{reading.channel.name} of " if len(file.channels) > 1 else ""
                copies.setdefault(finding.message, []).append(of + names[file.path])
    lines += [f"{named(where)}: {message}" for message, where in copies.items()]
    tell_first(lines, MOST_LINES, "reasons why files are not good, or are copies", "  ")


def _reasons(file: FileReading) -> str:
    """Return why a file is not good, or the worst of many reasons and how many more there are."""
    more = len(file.reasons) - MOST_REASONS
    counted = [f"{more} more reasons: see report and JSON"] if more > 0 else []
    return "; ".join([*file.reasons[:MOST_REASONS], *counted])


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
    tell(
        f"{len(shares)} rebound{'s' if len(shares) > 1 else ''}, counted with their blows, in {named(where)}: "
        f"{_span(min(shares), max(shares), percent, 0)} of the peak, "
        f"{_span(min(lags), max(lags), lambda lag, digits: amount(MILLISECONDS, lag, digits=digits), 3)} after it"
    )


def _span(low: float, high: float, write: Callable[[float, int], str], digits: int) -> str:
    """Write two bounds, or one where both read the same."""
    ends = list(dict.fromkeys([write(low, digits), write(high, digits)]))
    return " to ".join(ends)


def _rows(file: FileReading, name: str) -> list[list[str]]:
    """Return a row a channel; one for a file that has none."""
    if not file.channels:
        return [[name, "-", file.status, "-", "-", "-", "-", "-"]]
    return [
        [name, reading.channel.name, worst((*file.findings, *reading.findings)), *_means(reading)]
        for reading in file.channels
    ]


def _means(reading: ChannelReading) -> list[str]:
    """Return the number of blows of a channel and the means of their figures."""
    peak, rise, width, change = (
        mean_of([getattr(pulse, name) for pulse in reading.pulses])
        for name in ("peak", "rise", "width", "velocity_change")
    )
    unit = reading.channel.unit
    return [
        str(len(reading.pulses)),
        _doubted(reading, "peak", peak, value_text(peak, unit)),
        number(rise, *RISE_TIME.units),
        _doubted(reading, "width", width, number(width, *PULSE_WIDTH.units)),
        _doubted(reading, "velocity_change", change, integral_text(change, unit)),
    ]


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
