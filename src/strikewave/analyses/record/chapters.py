"""The sections of a report of records: files, health, blows, campaign, pictures, spectra, filter, provenance."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import mean, median

from strikewave.analyses.record.chosen import advised_filter
from strikewave.analyses.record.figures.campaigns import figure_unit
from strikewave.analyses.record.tables import (
    Columns,
    Names,
    digits_of,
    number,
    percent,
    rows_of,
    squeezed,
    status_tag,
    units_of,
)
from strikewave.base.shock_quantities import MICROSECONDS, MILLISECONDS
from strikewave.records.campaign import SUMMED, WITHOUT_RINGING, Campaign
from strikewave.records.health_notice import STATUSES, worst
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting import faces
from strikewave.reporting.numbers import listed, spelled
from strikewave.reporting.parts import NONE, Cell, Part, Section, Table, written
from strikewave.signal.filters import ADVISED_LOSS, Filter, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH

MOST_ROWS = 200
"""Blows, and findings, that a table lists: ten screens; the CSV file has all."""
LEFT_LEAST = 0.01
"""Cutoff times duration of a half-sine below which a filter leaves less than 2 % of the peak: no number is then
shown."""


def file_section(files: Sequence[FileReading], names: Names) -> Section:
    """List the files: what they are, what their blows came to, why one is not good."""
    rows = rows_of(files)
    columns = Columns(("peak", "width", "velocity_change"), units_of(rows))
    cells: list[list[Cell]] = []
    for file in files:
        for reading in file.channels:
            findings = [*file.findings, *reading.findings]
            means = {name: mean(values) for name in columns.names if (values := reading.figures(name))}
            reasons = dict.fromkeys(f.message for f in findings if f.severity != "good")
            cells.append(
                [
                    names[file.path],
                    status_tag(worst(findings)),
                    "; ".join(reasons) or NONE,
                    reading.channel.name,
                    file.format,
                    written(reading.channel.sampling_rate / 1e3) if reading.channel.step > 0.0 else NONE,
                    reading.channel.values.size,
                    len(reading.pulses),
                    *columns.cells(means, reading.channel.unit),
                ]
            )
        if not file.channels:
            row: list[Cell] = [
                names[file.path],
                status_tag(file.status),
                "; ".join(file.reasons) or "no channel was read",
                NONE,
                file.format,
                *[NONE] * (len(columns.names) + 3),
            ]
            cells.append(row)
    heads = ["file", "status", "why", "channel", "format", "rate (kHz)", "samples", "blows", *columns.heads]
    heads, cells, same = squeezed(heads, cells, ("channel", "format"))
    caption = f"Files{same}; means over the blows of each record, a dash where a finding harms the figure"
    return Section("Files", "", [Table(caption, heads, cells, "No file was read.")])


def health_section(files: Sequence[FileReading], names: Names) -> Section:
    """List every finding; one that several files share stands once."""
    entries = [(file, "", finding) for file in files for finding in file.findings]
    entries += [(file, reading.channel.name, f) for file, reading in rows_of(files) for f in reading.findings]
    several = len({reading.channel.name for _, reading in rows_of(files)}) > 1
    places = {file.path: place for place, file in enumerate(files)}
    entries.sort(key=lambda entry: (-STATUSES.index(entry[2].severity), places[entry[0].path]))
    groups: dict[tuple[str, str, str, str, tuple[str, ...]], list[str]] = {}
    for file, channel, one in entries:
        key = (channel if several else "", one.message, one.severity, one.code, one.harms)
        groups.setdefault(key, []).append(names[file.path])
    rows: list[list[Cell]] = [
        [
            ", ".join([_several(where), *([channel] if channel else [])]),
            message,
            status_tag(severity),
            code,
            listed([word.replace("_", " ") for word in harms]) or NONE,
        ]
        for (channel, message, severity, code, harms), where in list(groups.items())[:MOST_ROWS]
    ]
    text = (
        "A bad record goes into no mean. A suspect one loses the figures that the finding harms. A good finding is "
        "information and harms nothing, unless the column harms names a figure."
    )
    if len(groups) > MOST_ROWS:
        text += f" The worst {MOST_ROWS} of {len(groups)} findings are listed."
    heads = ["where", "what", "severity", "code", "harms"]
    empty = "Nothing was found wrong." if files else "No file was read."
    return Section("Health", text, [Table("Findings, the worst first", heads, rows, empty)])


def blow_section(files: Sequence[FileReading], names: Names) -> Section:
    """List the blows as they were measured."""
    rows = rows_of(files)
    rings = any(pulse.ringing_frequency > 0.0 for _, reading in rows for pulse in reading.pulses)
    figures = ("peak", "rise", "width", "velocity_change", *(("ringing_frequency",) if rings else ()))
    columns = Columns(figures, units_of(rows))
    smooth = Columns(("peak", "width"), units_of(rows))
    differs = any(pulse.differs_without_ringing for _, reading in rows for pulse in reading.pulses)
    rigid = Columns(("peak", "width") if differs else (), units_of(rows))
    rebounding = any(pulse.rebounds for _, reading in rows for pulse in reading.pulses)
    several = len({reading.channel.name for _, reading in rows}) > 1
    cells: list[list[Cell]] = []
    total = sum(len(reading.pulses) for _, reading in rows)
    for file, reading in rows:
        unit = reading.channel.unit
        for k, pulse in enumerate(reading.pulses[: MOST_ROWS - len(cells)], 1):
            values = {name: getattr(pulse, name) for name in columns.names}
            fitted = {"peak": pulse.smooth.peak, "width": pulse.smooth.width()}
            cells.append(
                [
                    names[file.path],
                    *([reading.channel.name] if several else []),
                    k,
                    f"{pulse.time * 1e3:.3f}",
                    *columns.cells(values, unit),
                    pulse.method,
                    *smooth.cells(fitted, unit),
                    *rigid.cells({"peak": pulse.rigid_peak, "width": pulse.rigid_width}, unit),
                    *([_rebounds(pulse)] if rebounding else []),
                ]
            )
    text = (
        "The peak counts from the baseline before the blow. The rise time is from 10 to 90 % of the peak, the pulse "
        "width at 10 %, the velocity change from foot to foot, where 2 % of the peak is left. "
        + ("Ringing is what swings afterwards. " if rings else "No ringing stands out. ")
        + "The smooth pulse is the best fit of a power of a half-sine: the blow with little of its ringing. Where "
        "noise hides a tenth of the peak, the figures are those of the fit. Bad records stand here too."
    )
    if differs:
        text += " The pulse without ringing is fitted together with the mode that rings; a dash where no mode fits."
    if total > len(cells):
        text += f" The first {len(cells)} of {total} blows are listed."
    heads = ["file", *(["channel"] if several else []), "#", "time (ms)", *columns.heads, "method"]
    heads += [f"smooth {head}" for head in smooth.heads]
    heads += [f"without ringing: {head}" for head in rigid.heads]
    heads += ["rebounds (share of the peak, after)"] if rebounding else []
    return Section("Blows", text if cells else "", [Table("Blows", heads, cells, "No blow was found.")])


def _rebounds(pulse: RecordedPulse) -> str:
    """Write the rebounds of a blow."""
    words = [
        f"{percent(rebound.peak / pulse.peak, 2)}, {faces.amount(MILLISECONDS, rebound.time - pulse.time, digits=3)}"
        for rebound in pulse.rebounds
    ]
    return "; ".join(words) or NONE


def mean_sections(campaigns: Sequence[Campaign], files: Sequence[FileReading], names: Names) -> list[Section]:
    """Sum up each channel over all files; where there are several, those without any figure share a section."""
    several = len(campaigns) > 1
    silent = [one for one in campaigns if one.left_out and not one.statistics] if several else []
    sections = [
        _mean_section(one, files, names, several)
        for one in campaigns
        if one.sums_up and (one.statistics or not several)
    ]
    rows: list[list[Cell]] = [
        [one.channel, names.get(path, path), why] for one in silent for path, _, why in one.left_out
    ]
    table = Table("Left out of the means", ["channel", "file", "why"], rows)
    return [*sections, *([Section("Channels without figures", "", [table])] if silent else [])]


def _mean_section(campaign: Campaign, files: Sequence[FileReading], names: Names, several: bool) -> Section:
    """Sum up a channel over all files: statistics, trend, what was left out."""
    unit = campaign.unit
    table: list[list[Cell]] = []
    trends: list[list[Cell]] = []
    for name in (*SUMMED, *WITHOUT_RINGING):
        _, what, shown = figure_unit(name, unit)
        if name in campaign.statistics:
            one = campaign.statistics[name]
            digits = digits_of(one.low, one.high)
            values = [number(name, unit, value, digits) for value in (one.mean, one.low, one.high, one.median)]
            scatter = (one.cv, one.cv_low, one.cv_high, one.robust_cv)
            table.append([f"{what} ({shown})", one.n, *values, *map(percent, scatter)])
        if name in campaign.trends:
            line = campaign.trends[name]
            significant = "yes" if line.significant else "no"
            values = [number(name, unit, value, 3) for value in (line.slope, line.low, line.high)]
            trends.append([f"{what} ({shown})", *values, percent(line.change), significant])
    gone: list[list[Cell]] = [
        [names.get(path, path), "all" if set(SUMMED) <= set(harmed) else _words(harmed), why]
        for path, harmed, why in campaign.left_out
    ]
    heads = ["figure", "values", "mean", "from", "to", "median", "CV", "CV from", "CV to", "robust scatter"]
    parts: list[Part] = [
        Table("Means and scatter, with bounds at 95 %", heads, table, "No record gave a figure that can be trusted."),
        Table(
            "Trend a file, with bounds at 95 %",
            ["figure", "change a file", "from", "to", "first to last", "significant (95 %)"],
            trends,
            "A trend needs values from three files.",
        ),
        Table("Left out of the means", ["file", "figures", "why"], gone, "Nothing was left out."),
        *([_odd_table(campaign, unit, names)] if campaign.outliers else []),
    ]
    title = "Campaign" if len(files) > 1 else "Means"
    title += f": {campaign.channel}" if several else ""
    text = (
        "CV is the standard deviation over the mean. The bounds of the mean are Student's, those of the CV Vangel's; "
        "they hold for values that scatter like a normal distribution and have no trend. Robust scatter is that of the "
        "median deviation over the median. The trend is the median of the slopes between all files, its bounds are "
        "Kendall's: single files bend none of the three."
    )
    used = [reading for _, reading in same_channel(files, campaign) if reading.status != "bad"]
    units = sorted({reading.channel.unit or "file's own numbers" for reading in used})
    if len(units) > 1:
        text += f" The files hold this channel in different units, {listed(units)}: "
        text += "peak and velocity change are summed up in the usual one."
    return Section(title, text, parts)


def _odd_table(campaign: Campaign, unit: str, names: Names) -> Table:
    """List what disagrees with the other files, and what it would do to mean and scatter."""
    rows: list[list[Cell]] = []
    for one in campaign.outliers:
        _, what, shown = figure_unit(one.figure, unit)
        statistic = campaign.statistics[one.figure]
        values = [number(one.figure, unit, value) for value in (one.value, statistic.mean, one.mean_with)]
        rows.append(
            [
                names.get(one.path, one.path),
                f"{what} ({shown})",
                values[0],
                f"{one.ratio:.3g}",
                *values[1:],
                percent(statistic.cv),
                percent(one.cv_with),
            ]
        )
    heads = ["file", "figure", "value", "over the median", "mean without", "mean with", "CV without", "CV with"]
    return Table("What disagrees with the other files, and what it would do", heads, rows)


def _words(harmed: Sequence[str]) -> str:
    return listed([name.replace("_", " ") for name in harmed])


def same_channel(files: Sequence[FileReading], campaign: Campaign) -> list[tuple[str, ChannelReading]]:
    """Return the readings of a campaign's channel: those with the place that the channel has in the first file."""
    sound = ((file.path, file.numbered(campaign.number)) for file in files if worst(file.findings) != "bad")
    return [(path, reading) for path, reading in sound if reading is not None]


def filter_section(files: Sequence[FileReading], names: Names, filter_: Filter | None) -> Section:
    """Show what the filter did to each blow, or what one would do."""
    pulses = [
        pulse
        for _, reading in rows_of(files)
        if reading.status != "bad"
        for pulse in reading.unfiltered or reading.pulses
    ]
    if filter_ is not None:
        text = f"Before the blows were measured, the records went through: {filter_}."
        parts: list[Part] = [_filtered_table(files, names)]
        filters = [("", filter_)]
    else:
        text = (
            "No filter was used: all figures are those of the records as they are. The table says what filters would "
            "do; from the advised cutoff on, peak, pulse width and velocity change of the steepest blow that enters "
            f"the means are changed by at most {percent(ADVISED_LOSS, 0)}, 4 poles a pass, zero-phase."
        )
        parts, filters = [], [("", Filter.sae_j211(k)) for k in (1000, 600)]
    widths = [pulse.width for pulse in pulses if pulse.width > 0.0]
    if not widths:
        return Section("Filter", text.partition(" The table")[0] + " There is no blow to filter.", parts)
    advised = advised_filter(files) if filter_ is None else None
    filters = filters if advised is None else [("advised: ", advised), *filters]
    duration = median(widths) / HALF_SINE_WIDTH
    rows: list[list[Cell]] = [
        [
            f"{name}{one}",
            f"{one.half_power(1e-3 / one.cutoff) / 1e3:.4g}",
            *_left(one, duration),
        ]
        for name, one in filters
    ]
    long = faces.amount(MICROSECONDS, duration)
    caption = f"What filters leave of a half-sine of {long}, which is as wide as the median blow"
    heads = ["filter", "−3 dB in all (kHz)", "peak left", "width left"]
    return Section("Filter", text, [*parts, Table(caption, heads, rows)])


def _left(one: Filter, duration: float) -> list[str]:
    """Return what a filter leaves of peak and width of a half-sine."""
    if one.cutoff * duration < LEFT_LEAST:
        return ["below 2 %", NONE]
    effect = effect_on_half_sine(one, duration)
    return [percent(effect.peak), percent(effect.width)]


def _filtered_table(files: Sequence[FileReading], names: Names) -> Table:
    """Compare the blows before the filter with those after it."""
    rows = [(file, reading) for file, reading in rows_of(files) if reading.unfiltered]
    columns = Columns(("peak", "width"), units_of(rows))
    cells: list[list[Cell]] = []
    total = sum(len(reading.unfiltered) for _, reading in rows)
    for file, reading in rows:
        for k, before in enumerate(reading.unfiltered[: MOST_ROWS - len(cells)], 1):
            after = _nearest(before, reading.pulses)
            pairs = [{"peak": p.peak, "width": p.width} if p else {} for p in (before, after)]
            old, new = (columns.cells(pair, reading.channel.unit) for pair in pairs)
            left = [percent(pairs[1][n] / pairs[0][n]) if after and pairs[0][n] else NONE for n in ("peak", "width")]
            who: list[Cell] = [names[file.path], reading.channel.name, k]
            cells.append([*who, old[0], new[0], left[0], old[1], new[1], left[1]])
    heads = ["file", "channel", "#"]
    heads += [words for head in columns.heads for words in (f"{head} before", "after", "left")]
    some = f"; the first {len(cells)} of {total}" if total > len(cells) else ""
    return Table(f"Blows before and after the filter{some}", heads, cells, "No blow was found before the filter.")


def _nearest(pulse: RecordedPulse, others: Sequence[RecordedPulse]) -> RecordedPulse | None:
    """Return the blow that lies where a blow lay before the filter."""
    best = min(others, key=lambda other: abs(other.time - pulse.time), default=None)
    return best if best is not None and abs(best.time - pulse.time) <= pulse.end - pulse.begin else None


def calibration_section(
    files: Sequence[FileReading],
    names: Names,
    stated: Sequence[tuple[str, str]],
) -> Section:
    """List the calibrations, and where they come from."""
    groups: dict[tuple[str, str, str], list[str]] = {}
    for file, reading in rows_of(files):
        stated_values = reading.calibration.stated().items()
        calibration = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in stated_values)
        key = (reading.channel.name, calibration, reading.channel.unit)
        groups.setdefault(key, []).append(names[file.path])
    rows: list[list[Cell]] = [
        [name, calibration or "nothing was stated", spelled(unit) or "file's own numbers", _several(of)]
        for (name, calibration, unit), of in groups.items()
    ]
    parts: list[Part] = [
        Table(
            "What each channel was taken as", ["channel", "stated", "SI unit", "files"], rows, "No channel was read."
        ),
        Table("Where it was stated", ["where", "what"], [list(pair) for pair in stated], "No calibration was stated."),
    ]
    return Section("Calibration and provenance", "", parts)


def _several(names: Sequence[str]) -> str:
    return listed(list(names)) if len(names) <= 4 else f"{len(names)} files, {names[0]} to {names[-1]}"
