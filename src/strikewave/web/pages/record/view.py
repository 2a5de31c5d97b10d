"""The page of records: its view of measured files as plain values, made in processes of the app."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import strikewave
from strikewave.analyses.clauses import verdict_words
from strikewave.analyses.compare.report import agreement_tables
from strikewave.analyses.compare.result import CompareResult
from strikewave.analyses.record.figures.records import figure_unit, shown
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.analyses.record.tables import figure_text
from strikewave.analyses.record.verdict_chapter import clause_table
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import InputError, StrikewaveError, nearest
from strikewave.base.texts import percent
from strikewave.cases.files import bundled_cases
from strikewave.records.health_notice import STATUSES
from strikewave.records.reading import ChannelReading
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.parts import NONE
from strikewave.reporting.shown_result import shown_table
from strikewave.web.charts import (
    DASHES,
    GREY,
    MOST_CURVES,
    SOFT,
    ChartLine,
    MarkedSpan,
    colour,
    dash,
    line_chart,
    points,
    round_ends,
)
from strikewave.web.jobs import Say
from strikewave.web.markup import PageTable, page_table
from strikewave.web.pages.record.request import COMPARED, FILTERS, STATED, RecordRequest, count_of_files, on_page

MOST_MARKED = 40
"""Pulses that are marked in one diagram: more are no longer told apart."""
FIGURES = ("peak", "rise", "width", "velocity_change", "interval")
"""Figures of a campaign that are summarized."""
COST = ("peak", "width", "velocity_change")
"""Figures of a pulse that filters change."""


def measure(request: RecordRequest, say: Say) -> dict[str, Any]:
    """Return health, pulses, campaign, spectrum, verdict and agreement with a simulation of measured files."""
    try:
        view = _measured(request, say)
    except strikewave.StrikewaveError as error:
        raise strikewave.StrikewaveError(on_page(str(error))) from None
    notices = [(severity, code, on_page(message)) for severity, code, message in view["notices"]]
    return {**view, "notices": notices}


def _measured(request: RecordRequest, say: Say) -> dict[str, Any]:
    os.chdir(request.folder)  # so that messages and tables name the files as they were dropped
    names = list(request.names)
    if not names:
        raise InputError("FILE", "no file", "one or more measured files", "drop them on the page")
    case = request.beside.partition(":")[0]
    if request.beside and case not in bundled_cases():  # no file of this machine is opened
        hint = nearest(case, bundled_cases())
        raise InputError("beside", request.beside, "a built-in case, such as li-ma-2019:rigid", hint)
    say(None, "reading and judging")
    result = strikewave.record(names, spec=request.spec or None, **request.keywords())
    plain = None
    if any(getattr(request, key) for key in FILTERS):
        say(None, "the same without the filters")
        plain = strikewave.record(names, **request.keywords(*FILTERS))
    best = min(result.readings, key=lambda file: STATUSES.index(file.status)).path  # the first of the healthiest
    units = units_of_channels(result) or [""]
    charts = [chart for unit in units for chart in (history_chart(result, unit), overlay_chart(result, unit, plain))]
    lead = [*([] if plain is None else [cost_table(result, plain)]), file_table(result)]
    tables = [("Pulses", *shown_table(result), (0, 1)), *campaign_tables(result)]
    notices = [(notice.severity, notice.code, notice.message) for notice in result.notices]
    verdict = None
    if result.verdict is not None:
        judged = result.verdict
        text = verdict_words(judged.verdict, judged.by_indicative, [clause for clause, _ in judged.clauses])
        verdict = (text, f"by {judged.specification.title}")
        lead.append(page_table(clause_table(judged, {name: name for name in names})))
    alike = files_in_unit(result, units[0]) or names
    if request.spectrum:
        say(None, "shock response spectra")
        try:
            if len(alike) < len(names):
                others = ", ".join(sorted({*names} - {*alike}))
                notices.append(
                    ("info", "spectrum-of-one-unit", f"the spectrum is without {others}, in another unit or none")
                )
            spectrum = strikewave.shock_spectra(
                alike, spectra=strikewave.Spectra(q=request.q, kinds="pseudo-velocity"), **request.keywords("base")
            )
            charts.append(four_axes(spectrum))
        except strikewave.StrikewaveError as error:
            notices.append(("warning", "no-spectrum", str(error)))
    if request.beside:
        say(None, "the simulation beside it")
        try:
            taken = request.keywords("base", *({*STATED, *FILTERS} - {*COMPARED}))
            taken.pop("channels", None)
            channel = f"#{request.channel}" if request.channel else ""
            compared = strikewave.compare(f"{best}{channel}", request.beside, **taken)
            charts.append(beside_chart(compared))
            tables += map(page_table, agreement_tables(compared))
            notices += [(notice.severity, notice.code, notice.message) for notice in compared.notices]
        except strikewave.StrikewaveError as error:
            notices.append(("warning", "no-simulation", str(error)))
    say(None, "the report")
    with tempfile.TemporaryDirectory() as folder:
        report = result.report(Path(folder) / "report.html").read_bytes()
    return {
        "by": f"{count_of_files(len(result.readings))} read and judged",
        "verdict": verdict,
        "figures": [list(row) for row in result.highlights()],
        "lead": lead,
        "charts": charts,
        "tables": tables,
        "notices": notices,
        "files": {**result.tables(), "report.html": report},
        "same": request.commands(best, alike),
    }


def cost_table(result: RecordResult, plain: RecordResult) -> PageTable:
    """Return the mean of each figure of the pulses with and without the filters."""
    unit, rows = next(iter(units_of_channels(result)), ""), []
    for name in COST:
        without, with_them = _mean(plain, name, unit), _mean(result, name, unit)
        change = percent(with_them / without - 1.0, 1, "+") if without else NONE
        rows.append(
            [figure_unit(name, unit)[1], *(figure_text(name, unit, mean) for mean in (without, with_them)), change]
        )
    return "What filter and baseline cost", ["mean over the pulses", "without", "with", "change"], rows, (0,)


def _mean(result: RecordResult, name: str, unit: str) -> float:
    """Return the mean of the size of a figure over all pulses of channels of a unit; NaN where there are none."""
    sizes = [abs(getattr(p, name)) for _, channel in _channels(result, unit) for p in channel.pulses]
    return float(np.mean(sizes)) if sizes else math.nan


def file_table(result: RecordResult) -> PageTable:
    """Return status and reasons of each file, the worst first."""
    rows = [[Path(file.path).name, file.status, on_page("; ".join(file.reasons)) or "–"] for file in result.readings]
    return (
        "Health of the files",
        ["file", "status", "reasons"],
        sorted(rows, key=lambda row: -STATUSES.index(row[1])),
        (0, 1, 2),
    )


def units_of_channels(result: RecordResult) -> list[str]:
    """Return the SI units of the channels, each once, for no two share an axis; an unknown unit comes last."""
    units = dict.fromkeys(channel.channel.unit for file in result.readings for channel in file.channels)
    return sorted(units, key=lambda unit: unit == "")


def files_in_unit(result: RecordResult, unit: str) -> list[str]:
    """Return the files without a channel in another unit."""
    return [file.path for file in result.readings if {reading.channel.unit for reading in file.channels} <= {unit}]


def _channels(result: RecordResult, unit: str) -> list[tuple[str, ChannelReading]]:
    """Return the channels of a unit by name, good ones first; the channel is named where a file has several."""
    channels = [
        (Path(file.path).name + (f", {reading.channel.name}" if len(file.channels) > 1 else ""), reading)
        for file in result.readings
        for reading in file.channels
        if reading.channel.unit == unit
    ]
    return sorted(channels, key=lambda pair: pair[1].status == "bad")


def history_chart(result: RecordResult, unit: str) -> dict[str, Any]:
    """Return the whole histories of the channels of a unit, with the pulses of the first one marked.

    The axis is that of the sound channels, if there are any: a bad one may leave it.
    """
    channels = _channels(result, unit)[:MOST_CURVES]
    if not channels:
        return line_chart("Records", "time (ms)", "", [])
    style = shown(unit)
    duration = max(reading.channel.values.size / reading.channel.sampling_rate for _, reading in channels)
    second, time_name = time_unit(duration)
    lines = [
        ChartLine(
            f"{name} ({reading.status})",
            points(reading.channel.time / second, reading.channel.values / style.scale),
            colour(k),
            "dotted" if reading.status == "bad" else dash(k),
        )
        for k, (name, reading) in enumerate(channels)
    ]
    marked = [
        MarkedSpan(f"{k}", p.begin / second, p.end / second)
        for k, p in enumerate(channels[0][1].pulses[:MOST_MARKED], 1)
    ]
    title = f"Records; pulses of {channels[0][0]} marked" if marked else "Records"
    options = line_chart(title, f"time ({time_name})", style.label, lines, spans=marked, zoom=True)
    sound = [reading.channel.values for _, reading in channels if reading.status != "bad"]
    if 0 < len(sound) < len(channels):  # a bad one far off zero would press the others flat
        values = np.concatenate([values[np.isfinite(values)] for values in sound]) / style.scale
        low, high = float(values.min(initial=0.0)), float(values.max(initial=0.0))
        if high > low:
            options["yAxis"]["min"], options["yAxis"]["max"] = round_ends(low, high)
    return options


def overlay_chart(result: RecordResult, unit: str, plain: RecordResult | None = None) -> dict[str, Any]:
    """Return the first pulses of the channels of a unit over each other, from their onsets, without bad ones.

    Behind them stands the first one without filters, where these were used.
    """
    style = shown(unit)
    struck = [pair for pair in _channels(result, unit) if pair[1].pulses and pair[1].status != "bad"][:MOST_CURVES]
    raw = None if plain is None else next((pair for pair in _channels(plain, unit) if pair[1].pulses), None)
    second, time_name = time_unit(2.0 * max((reading.pulses[0].width for _, reading in struck), default=0.0))
    lines = [
        ChartLine(name, _near(reading, reading.pulses[0], second, style.scale), colour(k), dash(k))
        for k, (name, reading) in enumerate(struck)
    ]
    if raw is not None and struck:
        unfiltered = _near(raw[1], struck[0][1].pulses[0], second, style.scale)
        lines.insert(0, ChartLine(f"{raw[0]}, no filter", unfiltered, GREY, "dashed"))
    return line_chart("First pulses over each other", f"time after onset ({time_name})", style.label, lines)


def _near(reading: ChannelReading, pulse: Any, second: float, size: float) -> list[list[float]]:
    """Return a channel around a pulse without its baseline, from the onset of the pulse."""
    time = reading.channel.time - pulse.begin
    near = (time > -0.5 * pulse.width) & (time < 2.0 * pulse.width)
    return points(time[near] / second, (reading.channel.values[near] - reading.baseline) / size)


def campaign_tables(result: RecordResult) -> list[PageTable]:
    """Return mean, scatter and interval of each figure over the files, and the outliers that were left out."""
    tables: list[PageTable] = []
    for campaign in result.campaigns:
        rows, unit = [], campaign.unit
        for name in FIGURES:
            statistics = campaign.statistics.get(name)
            if statistics is not None:
                mean, low, high = (
                    figure_text(name, unit, value) for value in (statistics.mean, statistics.low, statistics.high)
                )
                cv = "–"
                if statistics.cv is not None and math.isfinite(statistics.cv):
                    cv = f"{100.0 * statistics.cv:.2g} %"
                rows.append([figure_unit(name, unit)[1], mean, cv, f"{low} to {high}", str(statistics.n)])
        if rows:
            heads = ["figure", "mean", "CV", "95 % interval of the mean", "n"]
            tables.append((f"Campaign: {campaign.channel}", heads, rows, (0, 3)))
        outliers = [[out.figure.replace("_", " "), Path(out.path).name, out.reason] for out in campaign.outliers]
        if outliers:
            tables.append(("Outliers, left out", ["figure", "file", "reason"], outliers, (0, 1, 2)))
    return tables


def beside_chart(compared: CompareResult) -> dict[str, Any]:
    """Return a record and a simulation over each other, as aligned, where they are compared."""
    agreement, inside = compared.agreement, compared.agreement.inside_interval
    second, time_name = time_unit(float(np.ptp(agreement.time[inside])))
    size, unit = axis_unit(compared.unit, compared.usual)
    lines = [
        ChartLine(side.name, points(agreement.time[inside] / second, values[inside] / size), colour(k), DASHES[k])
        for k, (side, values) in enumerate(((compared.a, agreement.a), (compared.b, agreement.b)))
    ]
    return line_chart("Record and simulation", f"time ({time_name})", f"{compared.quantity} ({unit})", lines)


GRID = "#c9ced3"
BESIDE_GUIDES = 62
"""Pixels on the right of four axes for the names of the lines that leave there."""
WITHIN = 1.2
"""Margin of the lines of the grid, a twelfth of a decade, so that no name touches a number of an axis."""


def four_axes(result: SpectrumResult) -> dict[str, Any]:
    """Return the pseudo-velocities on four axes: lines of equal acceleration fall, of equal displacement rise.

    Records in other units than acceleration have no such lines. Spectra outside the envelope are left out.
    """
    unit = result.reading.channel.unit
    is_acceleration = unit == "m/s^2"
    shocks = [(shock.name, shock.found.spectra[0]) for shock in result.used or result.shocks]
    drawn = (shocks or [(result.title, result.spectra[0])])[:MOST_CURVES]
    frequency = drawn[0][1].frequency
    sizes = [np.maximum(spectrum.positive, spectrum.negative) for _, spectrum in drawn]
    lines = [
        ChartLine(name, points(frequency, size), colour(k), dash(k))
        for k, ((name, _), size) in enumerate(zip(drawn, sizes, strict=True))
    ]
    above_zero = np.concatenate([size[size > 0.0] for size in sizes])
    if not above_zero.size:
        raise StrikewaveError("the record is zero throughout: it has no spectrum")
    low, high = 10.0 ** math.floor(math.log10(above_zero.min())), 10.0 ** math.ceil(math.log10(above_zero.max()))
    guides: list[ChartLine] = []
    for power in range(0, 7) if is_acceleration else ():
        g = 10.0**power
        guides += _guide(f"{g:g} g", frequency, g * STANDARD_GRAVITY / (2.0 * math.pi * frequency), low, high)
    for power in range(-7, 1) if is_acceleration else ():
        d = 10.0**power
        guides += _guide(f"{1e3 * d:g} mm", frequency, 2.0 * math.pi * frequency * d, low, high)
    options = line_chart(
        "Shock response spectrum" + (" on four axes" if is_acceleration else ""),
        "natural frequency (Hz)",
        f"pseudo-velocity ({'m/s' if is_acceleration else shown(unit).integral_unit})",
        [*lines, *guides],
        log=True,
        log_y=True,
    )
    options["legend"] |= {"data": [line.name for line in lines], "show": len(lines) > 1}
    for guide in options["series"][len(lines) :]:
        guide["endLabel"] = {"show": True, "formatter": "{a}", "fontSize": 9, "color": SOFT}
        guide["silent"] = True
    options["yAxis"] |= {"min": low, "max": high}
    options["grid"] |= {"right": BESIDE_GUIDES} if guides else {}
    return options


def _guide(name: str, frequency: Any, velocity: Any, low: float, high: float) -> Sequence[ChartLine]:
    """Return a line of the grid of four axes, where it crosses the diagram; its name stays inside."""
    inside = (velocity >= WITHIN * low) & (velocity <= high / WITHIN)
    if np.count_nonzero(inside) < 2:
        return ()
    return (ChartLine(name, points(frequency[inside], velocity[inside], 40), GRID, "dotted"),)
