"""What the page of records shows of measured files, as plain values; it runs in processes of the app."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import strikewave
from strikewave.analyses.compare.result import CompareResult
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import InputError, nearest
from strikewave.cases.case import bundled_cases
from strikewave.records.reading import ChannelReading
from strikewave.reporting.numbers import axis_unit, time_unit, with_unit
from strikewave.reporting.parts import NONE
from strikewave.reporting.shown_result import shown_table
from strikewave.web.charts import GREY, SOFT, ChartLine, MarkedSpan, colour, line_chart
from strikewave.web.curves import points
from strikewave.web.jobs import Say
from strikewave.web.markup import PageTable
from strikewave.web.pages.record.request import FILTERS, RecordRequest

MOST_CURVES = 12
"""Files whose curves are drawn: more cannot be told apart; the table has all."""
MOST_MARKED = 40
"""Pulses that are marked in one diagram."""
GRID = "#c9ced3"


class CampaignFigure(NamedTuple):
    """A figure of a campaign: name, SI unit, unit shown."""

    name: str
    si: str
    usual: str


FIGURES = (
    CampaignFigure("peak", "m/s^2", "g"),
    CampaignFigure("rise", "s", "us"),
    CampaignFigure("width", "s", "us"),
    CampaignFigure("velocity_change", "m/s", "m/s"),
    CampaignFigure("interval", "s", "ms"),
)
COST = tuple(figure for figure in FIGURES if figure.name in ("peak", "width", "velocity_change"))
"""What filters change of a pulse."""


def measure(request: RecordRequest, say: Say) -> dict[str, Any]:
    """Return what measured files say: health, pulses, campaign, spectrum, verdict, agreement with a simulation."""
    os.chdir(request.folder)  # so that messages and tables name the files as they were dropped
    names = list(request.names)
    if not names:
        raise InputError("FILE", "no file", "one or more measured files", "drop them on the page")
    options = request.keywords()
    say(None, "reading and judging")
    result = strikewave.record(names, spec=request.spec or None, **options)
    plain = None
    if any(key in options for key in FILTERS):
        say(None, "the same without the filters")
        plain = strikewave.record(names, **{key: value for key, value in options.items() if key not in FILTERS})
    charts = [history_chart(result), overlay_chart(result, plain)]
    lead = [*([] if plain is None else [cost_table(result, plain)]), file_table(result)]
    tables = [("Pulses", *shown_table(result), (0, 1)), *campaign_tables(result)]
    notices = [(one.severity, one.code, one.message) for one in result.notices]
    verdict = None
    if result.verdict is not None:
        verdict = (str(result.verdict.verdict).upper(), f"by {result.verdict.specification.name}")
        lead.append(clause_table(result))
    if request.spectrum:
        say(None, "shock response spectra")
        try:
            spectrum = strikewave.shock_spectra(names, kinds=("pseudo-velocity",), q=float(request.q), **options)
            charts.append(four_axes(spectrum))
        except strikewave.StrikewaveError as error:
            notices.append(("warning", "no-spectrum", str(error)))
    if request.beside:
        say(None, "the simulation beside it")
        compared = _compared(request, names[0], options)
        charts.append(beside_chart(compared))
        tables.append(("Agreement with the simulation", *shown_table(compared), (0,)))
        notices += [(one.severity, one.code, one.message) for one in compared.notices]
    say(None, "the report")
    with tempfile.TemporaryDirectory() as folder:
        report = result.report(Path(folder) / "report.html").read_bytes()
    return {
        "by": f"{len(result.readings)} files read and judged",
        "verdict": verdict,
        "figures": [list(row) for row in result.highlights()],
        "lead": lead,
        "charts": charts,
        "tables": tables,
        "notices": notices,
        "files": {**result.tables(), "report.html": report},
    }


def _compared(request: RecordRequest, name: str, options: Mapping[str, Any]) -> CompareResult:
    """Return a record held against a built-in case that is run."""
    case = request.beside.partition(":")[0]
    if case not in bundled_cases():
        raise InputError(
            "beside", request.beside, "a built-in case, such as li-ma-2019:rigid", nearest(case, bundled_cases())
        )
    kept = {
        key: value for key, value in options.items() if key in ("unit", "sensitivity", "gain", "filter", "high_pass")
    }
    channel = f"#{request.channel}" if request.channel else ""
    return strikewave.compare(f"{name}{channel}", request.beside, **kept)


def cost_table(result: RecordResult, plain: RecordResult) -> PageTable:
    """Return what the filters cost: the mean of each figure of the pulses with and without them."""
    rows = []
    for figure in COST:
        with_them, without = _mean(result, figure.name), _mean(plain, figure.name)
        shown = [with_unit(value, figure.si, figure.usual) for value in (without, with_them)]
        change = f"{100.0 * (with_them / without - 1.0):+.1f} %" if without else NONE
        rows.append([figure.name.replace("_", " "), *shown, change])
    return "What filter and baseline cost", ["mean over the pulses", "without", "with", "change"], rows, (0,)


def _mean(result: RecordResult, name: str) -> float:
    """Return the mean of the size of a figure over all pulses; NaN where there are none."""
    sizes = [abs(getattr(p, name)) for file in result.readings for channel in file.channels for p in channel.pulses]
    return float(np.mean(sizes)) if sizes else math.nan


def file_table(result: RecordResult) -> PageTable:
    """Return status and reasons of each file, the worst first."""
    order = {"bad": 0, "suspect": 1}
    rows = [[Path(file.path).name, file.status, "; ".join(file.reasons) or "–"] for file in result.readings]
    return (
        "Health of the files",
        ["file", "status", "reasons"],
        sorted(rows, key=lambda row: order.get(row[1], 2)),
        (0, 1, 2),
    )


def _channels(result: RecordResult) -> list[tuple[str, ChannelReading]]:
    """Return the channels that are drawn, the good ones first."""
    found = [(Path(file.path).name, channel) for file in result.readings for channel in file.channels]
    return sorted(found, key=lambda pair: pair[1].status == "bad")[:MOST_CURVES]


def _unit_of(channel: ChannelReading) -> tuple[float, str]:
    si = channel.channel.unit
    usual = {"m/s^2": "g", "N": "kN", "m/s": "m/s", "Pa": "MPa"}.get(si, si)
    return axis_unit(si, usual) if si in ("m/s^2", "N", "m/s", "Pa") else (1.0, si)


def history_chart(result: RecordResult) -> dict[str, Any]:
    """Return the whole histories, with the pulses of the first drawn one marked."""
    channels = _channels(result)
    if not channels:
        return line_chart("Records", "time (ms)", "", [])
    size, unit = _unit_of(channels[0][1])
    duration = max(one.channel.values.size / one.channel.sampling_rate for _, one in channels)
    second, time_name = time_unit(duration)
    lines = []
    for k, (name, one) in enumerate(channels):
        time = one.channel.time
        dash = "dotted" if one.status == "bad" else "solid"
        lines.append(
            ChartLine(
                f"{name} ({one.status})",
                points(time / second, one.channel.values / size),
                colour(k),
                dash,
            )
        )
    marked = [
        MarkedSpan(f"{k}", p.begin / second, p.end / second)
        for k, p in enumerate(channels[0][1].pulses[:MOST_MARKED], 1)
    ]
    title = f"Records; pulses of {channels[0][0]} marked" if marked else "Records"
    return line_chart(
        title, f"time ({time_name})", f"{channels[0][1].channel.name} ({unit})", lines, spans=marked, zoom=True
    )


def overlay_chart(result: RecordResult, plain: RecordResult | None = None) -> dict[str, Any]:
    """Return the first pulses of the files over each other, from their onsets; bad files are left out.

    Behind them stands the first one without filters, where these were taken.
    """
    lines: list[ChartLine] = []
    second, time_name, unit = 1e-6, "µs", "g"
    raw = None if plain is None else next((pair for pair in _channels(plain) if pair[1].pulses), None)
    for k, (name, one) in enumerate(_channels(result)):
        if not one.pulses or one.status == "bad":
            continue
        pulse = one.pulses[0]
        size, unit = _unit_of(one)
        second, time_name = time_unit(2.0 * pulse.width)
        if raw is not None and not lines:
            lines.append(ChartLine(f"{raw[0]}, no filter", _near(raw[1], pulse, second, size), GREY, "dashed"))
        lines.append(ChartLine(name, _near(one, pulse, second, size), colour(k)))
    return line_chart("First pulses over each other", f"time after onset ({time_name})", f"amplitude ({unit})", lines)


def _near(one: ChannelReading, pulse: Any, second: float, size: float) -> list[list[float]]:
    """Return a channel about a pulse, its baseline taken off, from the onset of the pulse."""
    time = one.channel.time - pulse.begin
    near = (time > -0.5 * pulse.width) & (time < 2.0 * pulse.width)
    return points(time[near] / second, (one.channel.values[near] - one.baseline) / size)


def campaign_tables(result: RecordResult) -> list[PageTable]:
    """Return mean, scatter and interval of each figure over the files, and the outliers that were left out."""
    tables: list[PageTable] = []
    for one in result.campaigns:
        rows = []
        for figure in FIGURES:
            found = one.statistics.get(figure.name)
            if found is not None:
                ends = [with_unit(end, figure.si, figure.usual) for end in (found.mean, found.low, found.high)]
                cv = f"{100.0 * found.cv:.2g} %" if found.cv is not None and math.isfinite(found.cv) else "–"
                rows.append([figure.name.replace("_", " "), ends[0], cv, f"{ends[1]} to {ends[2]}", str(found.n)])
        if rows:
            heads = ["figure", "mean", "CV", "95 % interval of the mean", "n"]
            tables.append((f"Campaign: {one.channel}", heads, rows, (0, 3)))
        outliers = [[out.figure.replace("_", " "), Path(out.path).name, out.reason] for out in one.outliers]
        if outliers:
            tables.append(("Outliers, left out", ["figure", "file", "reason"], outliers, (0, 1, 2)))
    return tables


def clause_table(result: RecordResult) -> PageTable:
    """Return the verdict clause by clause, as the JSON document has it."""
    rows = [
        [
            str(row.get(key) if row.get(key) is not None else "–")
            for key in ("clause", "status", "value", "limit", "verdict")
        ]
        for row in result.document()["spec"]["clauses"]
    ]
    return "Verdict, clause by clause", ["clause", "status of the number", "value", "limit", "verdict"], rows, (0, 1)


def four_axes(result: SpectrumResult) -> dict[str, Any]:
    """Return the pseudo-velocity on four axes: lines of equal acceleration fall, of equal displacement rise."""
    spectrum = result.spectra[0]
    frequency, velocity = spectrum.frequency, np.maximum(spectrum.positive, spectrum.negative)
    low, high = float(velocity[velocity > 0.0].min()), float(velocity.max())
    lines = [ChartLine("pseudo-velocity", points(frequency, velocity))]
    for power in range(0, 7):
        g = 10.0**power
        v = g * STANDARD_GRAVITY / (2.0 * math.pi * frequency)
        lines += _guide(f"{g:g} g", frequency, v, low, high)
    for power in range(-7, 1):
        d = 10.0**power
        lines += _guide(f"{1e3 * d:g} mm", frequency, 2.0 * math.pi * frequency * d, low, high)
    options = line_chart(
        "Shock response spectrum on four axes",
        "natural frequency (Hz)",
        "pseudo-velocity (m/s)",
        lines,
        log=True,
        log_y=True,
    )
    options["legend"]["show"] = False
    for guide in options["series"][1:]:
        guide["endLabel"] = {"show": True, "formatter": "{a}", "fontSize": 9, "color": SOFT}
        guide["silent"] = True
    options["yAxis"] |= {"min": 10.0 ** math.floor(math.log10(low)), "max": 10.0 ** math.ceil(math.log10(high))}
    return options


def _guide(name: str, frequency: Any, velocity: Any, low: float, high: float) -> Sequence[ChartLine]:
    """Return a line of the grid of four axes, where it crosses the diagram."""
    seen = (velocity >= 0.7 * low) & (velocity <= 1.5 * high)
    if np.count_nonzero(seen) < 2:
        return ()
    return (ChartLine(name, points(frequency[seen], velocity[seen], 40), GRID, "dotted"),)


def beside_chart(compared: CompareResult) -> dict[str, Any]:
    """Return a record and a simulation over each other, as they were aligned."""
    drawn = compared.preview()
    lines = [] if drawn is None else [ChartLine(drawn.y_label, points(drawn.x, drawn.y))]
    x, y = ("", "") if drawn is None else (drawn.x_label, drawn.y_label)
    return line_chart("Record and simulation", x, y, lines)
