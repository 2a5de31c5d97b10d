"""What response channels do after the blows of their base."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from strikewave.analyses.record.figures.campaigns import figure_unit
from strikewave.analyses.record.responses import ResponseSummary, harmed, responding
from strikewave.analyses.record.screen.kit import print_table, value_text
from strikewave.base.shock_quantities import FREQUENCY, MILLISECONDS
from strikewave.records import FileReading
from strikewave.records.response import MeasuredResponse
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.numbers import percent, shown_unit
from strikewave.reporting.terminal import number, significant, table, tell

DOUBTED = " ?"
"""Stands behind a figure that a finding harms."""


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
                    for name, text in _figures(one, reading.channel.unit).items()
                ]
            )
    only = "" if keyed["channel"] else f": {channels[0][1].channel.name}"
    print_table(f"Response channels{only}", _columns(keyed), rows)
    if doubted:
        tell(f"{DOUBTED.strip()} a figure that a finding harms: see the report")
    for together in summaries:
        _print_summary(together)


def _figures(one: MeasuredResponse, unit: str) -> dict[str, str]:
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


def _columns(keyed: Mapping[str, bool]) -> list[Column]:
    """Return the columns of the table: file, channel and blow where there are several, then `_figures`."""
    columns = [*(keys("file") if keyed["file"] else []), *(texts("channel") if keyed["channel"] else [])]
    columns += [*(numerals("blow") if keyed["blow"] else []), *numerals("peak")]
    columns += numerals("over base", priority=MORE)
    columns += numerals("delay (ms)", "effective duration (ms)")
    columns += numerals("RMS", priority=MORE)
    columns += numerals("strongest mode (Hz)", "damping ratio (%)")
    return columns


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
