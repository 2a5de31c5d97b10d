"""Response channels as a chapter: picture, figures, modes, and all blows together."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.analyses.record.figures.campaigns import figure_unit
from strikewave.analyses.record.figures.records import drawable
from strikewave.analyses.record.responses import ResponseSummary, base_of, harmed, responding
from strikewave.analyses.record.tables import (
    Columns,
    Names,
    amount,
    called,
    number,
    percent,
    squeezed,
    status_tag,
    units_of,
)
from strikewave.records.health_notice import RESPONSE_FIGURES, worst
from strikewave.records.reading import FileReading
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written

MOST_DRAWN = 6
"""Channels of which there are pictures."""
MOST_ROWS = 200
"""Lines of a table; responses.csv has all."""
FIGURES = ("peak", "ratio", "delay", "duration", "rms")
OF_MODES = ("amplitude", "decay_time")


def response_sections(files: Sequence[FileReading], together: Sequence[ResponseSummary], names: Names) -> list[Section]:
    """Return the chapter of response channels; none where no base was named."""
    rows = responding(files)
    if not rows:
        return []
    text = (
        "What each channel does after a blow of the base, until the next one, from the zero before the first. The "
        "effective duration is from the first to the last time above a third of the peak (T_E of MIL-STD-810H, as "
        "quoted), and the RMS is over it. Modes are those of the free decay, the one with the most energy first; ± is "
        "a standard uncertainty."
    )
    parts: list[Part] = []
    for file, reading in rows[:MOST_DRAWN]:
        base = base_of(file)
        if base is not None and drawable(base) and drawable(reading):
            from strikewave.analyses.record.figures.responses import response_figure

            one = max(reading.responses, key=lambda response: abs(response.base_peak))
            peak, delay = amount("peak", reading.channel.unit, one.peak), amount("delay", "", one.delay, 3)
            who = f"{names[file.path]}, {reading.channel.name}: {reading.status}"
            words = f"{who}, {peak}, {delay} after the peak of {base.channel.name}."
            parts.append(Picture(response_figure(base, reading), words))
    if len(rows) > MOST_DRAWN:
        text += f" The first {MOST_DRAWN} of {len(rows)} channels are drawn."
    parts += [_figures(files, names), _modes(files, names), *_together(together)]
    return [Section("Response channels", text, parts)]


def _figures(files: Sequence[FileReading], names: Names) -> Table:
    rows = responding(files)
    columns = Columns(FIGURES, units_of(rows))
    cells: list[list[Cell]] = []
    for file, reading in rows:
        doubted = harmed(file, reading)
        wrong = listed([called(name, reading.channel.unit) for name in doubted]) or NONE
        wrong = "all" if doubted == RESPONSE_FIGURES else wrong
        for one in reading.responses:
            values = {name: getattr(one, name) for name in FIGURES}
            cells.append(
                [
                    names[file.path],
                    reading.channel.name,
                    status_tag(worst((*file.findings, *reading.findings))),
                    one.blow,
                    *columns.cells(values, reading.channel.unit),
                    wrong,
                ]
            )
    heads, kept, same = squeezed(
        ["file", "channel", "status", "blow", *columns.heads, "not to be trusted"],
        cells[:MOST_ROWS],
        ("file", "channel", "blow"),
    )
    first = f", the first {MOST_ROWS} of {len(cells)}" if len(cells) > MOST_ROWS else ""
    return Table(f"Responses{same}{first}", heads, kept)


def _modes(files: Sequence[FileReading], names: Names) -> Table:
    rows = responding(files)
    columns = Columns(OF_MODES, units_of(rows))
    cells: list[list[Cell]] = []
    for file, reading in rows:
        for one in reading.responses:
            for mode in one.modes:
                values = {name: getattr(mode, name) for name in OF_MODES}
                frequency = f"{written(mode.frequency, 5)} ± {written(mode.frequency_uncertainty, 2)}"
                damping = f"{written(1e2 * mode.damping, 3)} ± {written(1e2 * mode.damping_uncertainty, 2)}"
                cells.append(
                    [
                        names[file.path],
                        reading.channel.name,
                        one.blow,
                        frequency,
                        damping,
                        *columns.cells(values, reading.channel.unit),
                    ]
                )
    heads, kept, same = squeezed(
        ["file", "channel", "blow", "frequency (Hz)", "damping ratio (%)", *columns.heads],
        cells[:MOST_ROWS],
        ("file", "channel", "blow"),
    )
    first = f", the first {MOST_ROWS} of {len(cells)}" if len(cells) > MOST_ROWS else ""
    return Table(f"Modes of the free decay{same}{first}", heads, kept, "No decaying swing stands out.")


def _together(found: Sequence[ResponseSummary]) -> list[Table]:
    """Return means and scatter over the blows of each channel that has more than one."""
    tables = []
    for one in found:
        if not any(statistic.n > 1 for statistic in one.statistics.values()):
            continue
        cells: list[list[Cell]] = []
        for name, statistic in one.statistics.items():
            _, what, shown = figure_unit(name, one.unit)
            values = [number(name, one.unit, v) for v in (statistic.mean, statistic.low, statistic.high)]
            cells.append([f"{what} ({shown})" if shown else what, statistic.n, *values, percent(statistic.cv)])
        who = f" of {one.channel}" if len(found) > 1 else ""
        title = f"All responses{who} together, with bounds at 95 %; what is not to be trusted is left out"
        tables.append(Table(title, ["figure", "values", "mean", "from", "to", "CV"], cells))
    return tables


def response_words(together: Sequence[ResponseSummary]) -> str:
    """Say what each response channel comes to; empty where there is none."""
    words = []
    for one in together:
        statistics = one.statistics
        if "peak" not in statistics:
            words.append(f"{one.channel}: no peak of its response can be trusted.")
            continue
        n = statistics["peak"].n
        text = f"{one.channel} answers with {amount('peak', one.unit, statistics['peak'].mean)}"
        text += f" in the mean of {n} blows" if n > 1 else ""
        if "ratio" in statistics:
            text += f", {written(statistics['ratio'].mean, 3)} of the base"
        if "frequency" in statistics and "damping" in statistics:
            text += f", and swings at {amount('frequency', '', statistics['frequency'].mean)}"
            text += f" with a damping ratio of {percent(statistics['damping'].mean, 2)}"
        words.append(f"{text}.")
    return " ".join(words)
