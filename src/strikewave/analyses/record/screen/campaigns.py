"""All blows of a channel together: mean, scatter, trend, and what was left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from strikewave.analyses.record.screen.kit import MOST_LINES, integral_text, value_text
from strikewave.analyses.record.words import named
from strikewave.base.shock_quantities import FREQUENCY, MICROSECONDS, MILLISECONDS
from strikewave.records import Campaign, FileReading
from strikewave.records.campaign import SUMMED, WITHOUT_RINGING
from strikewave.reporting.faces import amount
from strikewave.reporting.layout import MORE, keys, numerals
from strikewave.reporting.numbers import percent
from strikewave.reporting.terminal import table, tell


def print_campaigns(campaigns: Sequence[Campaign], readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print the first campaigns, and how many more there are."""
    for campaign in campaigns[:MOST_LINES]:
        _print_campaign(campaign, readings, names)
    more = sum(campaign.sums_up and bool(campaign.statistics) for campaign in campaigns[MOST_LINES:])
    if more:
        tell(f"{more} more channels are summed up: see report and JSON")


def _print_campaign(campaign: Campaign, readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print the figures of a channel over all blows, and which of them were left out."""
    rows = _rows(campaign)
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
    _print_left_out(campaign, names)
    _print_outliers(campaign, names)


def _writers(unit: str) -> dict[str, Any]:
    """Return what writes each figure of a channel with its unit."""
    return {
        **dict.fromkeys(("peak", "rigid_peak"), lambda v: value_text(v, unit)),
        "velocity_change": lambda v: integral_text(v, unit),
        "interval": lambda v: amount(MILLISECONDS, v),
        "ringing_frequency": lambda v: amount(FREQUENCY, v),
        **dict.fromkeys(("rise", "width", "rigid_width"), lambda v: amount(MICROSECONDS, v)),
    }


def _rows(campaign: Campaign) -> list[list[str]]:
    """Return a row a figure: mean, scatter, bounds, blows, median, robust scatter, trend."""
    rows, writers = [], _writers(campaign.unit)
    for name, statistic in campaign.statistics.items():
        write = writers[name]
        line = campaign.trends.get(name)
        trend = "-" if line is None else percent(line.change, 1, "+") + (" *" if line.significant else "")
        bounds = "-" if statistic.n < 2 else f"{write(statistic.low)} to {write(statistic.high)}"
        cv = "-" if statistic.n < 2 else percent(statistic.cv, 2)
        robust = ["-", "-"] if statistic.n < 2 else [write(statistic.median), percent(statistic.robust_cv, 2)]
        called = f"{name.removeprefix('rigid_')} without ringing" if name in WITHOUT_RINGING else name.replace("_", " ")
        rows.append([called, write(statistic.mean), cv, bounds, str(statistic.n), *robust, trend])
    return rows


def _print_left_out(campaign: Campaign, names: Mapping[str, str]) -> None:
    """Say which figures of which files were left out."""
    gone: dict[str, list[str]] = {}
    for path, figures, _ in campaign.left_out:
        what = "all figures" if len(figures) == len(SUMMED) else ", ".join(figures).replace("_", " ")
        gone.setdefault(what, []).append(names[path])
    for what, where in gone.items():
        tell(f"left out: {what} of {named(where)}")


def _print_outliers(campaign: Campaign, names: Mapping[str, str]) -> None:
    """Say what the mean would be with each file that disagrees with the others."""
    writers = _writers(campaign.unit)
    for one in campaign.outliers:
        if one.figure in ("peak", "width", "interval"):  # the velocity change goes with the peak
            write = writers[one.figure]
            statistic = campaign.statistics[one.figure]
            with_it = f"{write(one.mean_with)}, scatter {percent(one.cv_with, 2)}"
            tell(
                f"with the {one.figure} of {names[one.path]}, {write(one.value)}, the mean would be {with_it}, instead "
                f"of {write(statistic.mean)}, {percent(statistic.cv, 2)}"
            )
