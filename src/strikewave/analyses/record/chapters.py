"""Chapters of a report of records, from files and health to blows, motion, pairs, responses and sensors."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import mean, median

from strikewave.analyses.record.figures.records import (
    drawable,
    figure_unit,
    motion_figure,
    pair_figure,
    response_figure,
    transfer_figure,
)
from strikewave.analyses.record.rows import RecordMotion, ResponseSummary, advised_filter, base_of, harmed, responding
from strikewave.analyses.record.sensors import RecordPair, SensorTrials, lacking
from strikewave.analyses.record.tables import (
    Columns,
    Names,
    called,
    digits_of,
    figure_text,
    number,
    percents,
    plus_minus,
    rows_of,
    squeezed,
    status_tag,
    units_of,
)
from strikewave.base.shock_quantities import (
    ACCELERATION,
    BANDWIDTH,
    KILOHERTZ,
    LENGTH,
    MICROSECONDS,
    MILLISECONDS,
    VELOCITY,
)
from strikewave.base.texts import first_few, percent
from strikewave.records.campaign import SUMMED, WITHOUT_RINGING, Campaign
from strikewave.records.health_notice import RESPONSE_FIGURES, STATUSES, worst
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.thresholds import OfTwoSensors
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import axis_unit, doubted, listed, spelled
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.signal.filters import ADVISED_LOSS, Filter, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH

MOST_ROWS = 200  # blows, and findings, that a table lists: ten screens; the CSV file has all
# Channels, files or blows that a table of motions, pairs, sensors or pulses without ringing lists; the CSV file has all
MOST_LISTED = 60
# Cutoff times duration of a half-sine below which a filter leaves less than 2 % of the peak: no number is then shown
LEFT_LEAST = 0.01


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
            rebounds = [
                f"{percents(one.peak / pulse.peak, 2)}, {amount(MILLISECONDS, one.time - pulse.time, digits=3)}"
                for one in pulse.rebounds
            ]
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
                    *(["; ".join(rebounds) or NONE] if rebounding else []),
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
            table.append([f"{what} ({shown})", one.n, *values, *map(percents, scatter)])
        if name in campaign.trends:
            line = campaign.trends[name]
            significant = "yes" if line.significant else "no"
            values = [number(name, unit, value, 3) for value in (line.slope, line.low, line.high)]
            trends.append([f"{what} ({shown})", *values, percents(line.change), significant])
    gone: list[list[Cell]] = []
    for path, figures, why in campaign.left_out:
        what = "all" if set(SUMMED) <= set(figures) else listed([name.replace("_", " ") for name in figures])
        gone.append([names.get(path, path), what, why])
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
                percents(statistic.cv),
                percents(one.cv_with),
            ]
        )
    heads = ["file", "figure", "value", "over the median", "mean without", "mean with", "CV without", "CV with"]
    return Table("What disagrees with the other files, and what it would do", heads, rows)


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
            f"the means are changed by at most {percents(ADVISED_LOSS, 0)}, 4 poles a pass, zero-phase."
        )
        parts, filters = [], [("", Filter.sae_j211(k)) for k in (1000, 600)]
    widths = [pulse.width for pulse in pulses if pulse.width > 0.0]
    if not widths:
        return Section("Filter", text.partition(" The table")[0] + " There is no blow to filter.", parts)
    advised = advised_filter(files) if filter_ is None else None
    filters = filters if advised is None else [("advised: ", advised), *filters]
    duration = median(widths) / HALF_SINE_WIDTH
    rows: list[list[Cell]] = []
    for name, one in filters:
        left = ["below 2 %", NONE]
        if one.cutoff * duration >= LEFT_LEAST:
            effect = effect_on_half_sine(one, duration)
            left = [percents(effect.peak), percents(effect.width)]
        rows.append([f"{name}{one}", f"{one.half_power(1e-3 / one.cutoff) / 1e3:.4g}", *left])
    long = amount(MICROSECONDS, duration)
    caption = f"What filters leave of a half-sine of {long}, which is as wide as the median blow"
    heads = ["filter", "−3 dB in all (kHz)", "peak left", "width left"]
    return Section("Filter", text, [*parts, Table(caption, heads, rows)])


def _filtered_table(files: Sequence[FileReading], names: Names) -> Table:
    """Compare the blows before the filter with those after it."""
    rows = [(file, reading) for file, reading in rows_of(files) if reading.unfiltered]
    columns = Columns(("peak", "width"), units_of(rows))
    cells: list[list[Cell]] = []
    total = sum(len(reading.unfiltered) for _, reading in rows)
    for file, reading in rows:
        for k, before in enumerate(reading.unfiltered[: MOST_ROWS - len(cells)], 1):
            after = min(reading.pulses, key=lambda pulse: abs(pulse.time - before.time), default=None)
            if after is not None and abs(after.time - before.time) > before.end - before.begin:
                after = None  # another blow
            pairs = [{"peak": p.peak, "width": p.width} if p else {} for p in (before, after)]
            old, new = (columns.cells(pair, reading.channel.unit) for pair in pairs)
            left = [percents(pairs[1][n] / pairs[0][n]) if after and pairs[0][n] else NONE for n in ("peak", "width")]
            who: list[Cell] = [names[file.path], reading.channel.name, k]
            cells.append([*who, old[0], new[0], left[0], old[1], new[1], left[1]])
    heads = ["file", "channel", "#"]
    heads += [words for head in columns.heads for words in (f"{head} before", "after", "left")]
    some = f"; the first {len(cells)} of {total}" if total > len(cells) else ""
    return Table(f"Blows before and after the filter{some}", heads, cells, "No blow was found before the filter.")


def calibration_section(files: Sequence[FileReading], names: Names, stated: Sequence[tuple[str, str]]) -> Section:
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


def motion_table(found: Sequence[RecordMotion]) -> Table:
    """Return where the motions end, and how well that is known."""
    rows: list[list[Cell]] = []
    for one in found[:MOST_LISTED]:
        last = {name: float(values[-1]) for name, values in one.motion._asdict().items()}
        speed, way = (
            f"{amount(of, last[name], digits=3)} ± {amount(of, last[f'{name}_drift'], digits=2)}"
            for name, of in (("velocity", VELOCITY), ("displacement", LENGTH))
        )
        lost = "–" if math.isnan(one.lost) else f"from {amount(MILLISECONDS, one.lost)} on"
        rows.append([Path(one.file).name, one.channel, speed, way, lost])
    title = "Motion from rest before the first blow to the end of the record, ± a standard deviation of its drift"
    heads = ["file", "channel", "velocity at the end", "displacement at the end", "drift exceeds the displacement"]
    return Table(title, heads, rows, empty="No acceleration with a blow: no motion.")


def motion_section(found: Sequence[RecordMotion]) -> Section:
    """Return table and picture, that of the first channel."""
    text = (
        "The record, its zero before the first blow taken off, integrated once and twice. A zero that is off by u "
        "gives u t and u t²/2; both are told from what lies before the blow. motion.csv has the histories."
    )
    parts: list[Part] = []
    if found:
        caption = f"{Path(found[0].file).name}, {found[0].channel}: shaded is a standard deviation of drift either way."
        parts.append(Picture(motion_figure(found[0]), caption))
    return Section("Motion", text, [*parts, motion_table(found)])


LEFT_OUT_FIRST = ("leads", "common peak", "differential peak", "alike up to")  # columns that a narrow screen leaves out
# Answers to whether two sensors move as one rigid body, in words
ANSWERS = {"yes": "yes", "no": "no", "cannot-tell": "undetermined"}

MOVE = {
    "yes": "{both} move as one rigid body",
    "no": "{both} do not move as one rigid body",
    "cannot-tell": "Whether {both} move as one rigid body is undetermined",
}


def pair_table(pairs: Sequence[RecordPair], why: bool = False) -> Table:
    """Return what two channels of each file do together, and in words why that is one rigid body or not."""
    rows: list[list[Cell]] = []
    size, delay_unit = axis_unit(*MICROSECONDS.units)
    for one in pairs[:MOST_LISTED]:
        found, unit = one.found, "" if one.first is None else one.first.channel.unit
        if found is None:
            rows.append([Path(one.file).name, ANSWERS[one.one_body], *[NONE] * 6, *([one.why] if why else [])])
            continue
        alike = math.nan if found.transfer is None else found.transfer.alike_to
        rows.append(
            [
                Path(one.file).name,
                ANSWERS[one.one_body],
                NONE
                if math.isnan(found.delay)
                else f"{' ± '.join(doubted(found.delay / size, found.delay_uncertainty / size))} {delay_unit}",
                one.leads or ("neither" if math.isfinite(found.delay) else NONE),
                NONE if math.isnan(found.gain) else " ± ".join(doubted(found.gain, found.gain_uncertainty)),
                "not separable"
                if math.isnan(found.rigid_peak)
                else plus_minus("peak", unit, found.rigid_peak, found.common_uncertainty),
                figure_text("peak", unit, found.differential_peak),
                amount(BANDWIDTH, alike) if math.isfinite(alike) else NONE,
                *([one.why] if why else []),
            ]
        )
    first = next((one for one in pairs if one.first is not None and one.second is not None), None)
    names = "" if first is None else f": {_name(first, 0)} and {_name(first, 1)}"
    heads = ["file", "one rigid body", "delay of the second", "leads", "gain, second over first", "common peak"]
    heads += ["differential peak", "alike up to", *(["why"] if why else [])]
    return Table(f"Two sensors on one object{names}", heads, rows, empty="No file with both channels.")


def _name(pair: RecordPair, place: int) -> str:
    reading = (pair.first, pair.second)[place]
    return "" if reading is None else reading.channel.name


def pair_words(pairs: Sequence[RecordPair]) -> str:
    """Say whether both sensors move as one rigid body, and why where there is one answer for all files."""
    first = next((one for one in pairs if one.first is not None and one.second is not None), None)
    if first is None:
        return "No file has both channels of the pair."
    both = f"{_name(first, 0)} and {_name(first, 1)}"
    counts = Counter(one.one_body for one in pairs)
    if len(counts) > 1:
        named = [f"in {counts[answer]} {words}" for answer, words in ANSWERS.items() if counts[answer]]
        return f"{both} as one rigid body: {listed(named)} of {len(pairs)} files."
    reasons = {one.why for one in pairs}
    why = f": {reasons.pop()}" if len(reasons) == 1 else f", in each of {len(pairs)} files"
    return MOVE[pairs[0].one_body].format(both=both) + f"{why}."


def pair_card(pairs: Sequence[RecordPair]) -> tuple[str, str]:
    """Return the answer as a key number: of one file in a word, of several in how many they move so."""
    if len(pairs) == 1:
        return "one rigid body", ANSWERS[pairs[0].one_body]
    return "one rigid body, of all files", f"{sum(one.one_body == 'yes' for one in pairs)} of {len(pairs)}"


def pair_reasons(pairs: Sequence[RecordPair]) -> list[str]:
    """Return why, a line a file; files with the same answer and reason together."""
    groups: dict[tuple[str, str], list[str]] = {}
    for one in pairs:
        groups.setdefault((one.one_body, one.why), []).append(Path(one.file).name)
    words = {"yes": "one rigid body", "no": "not one rigid body", "cannot-tell": "undetermined"}
    return [f"{first_few(files, 1)}: {words[answer]}: {why}" for (answer, why), files in groups.items()]


def pair_section(pairs: Sequence[RecordPair]) -> Section:
    """Return table, reasons and pictures, those of the first file that has them."""
    calibrated = percent(OfTwoSensors.CALIBRATED, 0)
    text = (
        "Common motion is half the sum of both channels, differential motion half of second less first. The delay is "
        "that of the largest cross-correlation, the gain that of the second over the first so shifted, each ± a "
        "standard uncertainty. Two sensors move as one rigid body where the gain is 1 and the delay 0 within twice "
        f"their uncertainty, {calibrated} for calibration and a share of a sample included. The peak of "
        "the common motion is that without ringing where it can be separated; what the differential motion does in its "
        "band is in its uncertainty. pairs.csv and transfer.csv have all figures."
    )
    parts: list[Part] = [pair_table(pairs, why=True)]
    drawn = next((one for one in pairs if one.found is not None and one.found.transfer is not None), None)
    if drawn is not None and drawn.found is not None and drawn.found.transfer is not None:
        transfer = drawn.found.transfer
        name = Path(drawn.file).name
        words = f"{name}: both channels around the largest blow, and what they share."
        parts.append(Picture(pair_figure(drawn), words))
        words = f"{name}: transfer function, mean of {transfer.averages} spectra, {transfer.resolution:.3g}\xa0Hz wide"
        if math.isfinite(transfer.trusted[0]):
            low, high = (amount(BANDWIDTH, f) for f in transfer.trusted)
            words += f"; shaded from {low} to {high}, where it is known within 10 % and stands above the noise."
        else:
            words += "; nowhere known within 10 %."
        parts.append(Picture(transfer_figure(transfer), words))
    return Section("Two sensors", text, parts)


MOST_DRAWN = 6  # channels of which there are pictures
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
            one = max(reading.responses, key=lambda response: abs(response.base_peak))
            peak, delay = figure_text("peak", reading.channel.unit, one.peak), figure_text("delay", "", one.delay, 3)
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
    heads, rows_left, same = squeezed(
        ["file", "channel", "status", "blow", *columns.heads, "not to be trusted"],
        cells[:MOST_ROWS],
        ("file", "channel", "blow"),
    )
    first = f", the first {MOST_ROWS} of {len(cells)}" if len(cells) > MOST_ROWS else ""
    return Table(f"Responses{same}{first}", heads, rows_left)


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
    heads, rows_left, same = squeezed(
        ["file", "channel", "blow", "frequency (Hz)", "damping ratio (%)", *columns.heads],
        cells[:MOST_ROWS],
        ("file", "channel", "blow"),
    )
    first = f", the first {MOST_ROWS} of {len(cells)}" if len(cells) > MOST_ROWS else ""
    return Table(f"Modes of the free decay{same}{first}", heads, rows_left, "No decaying swing stands out.")


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
            cells.append([f"{what} ({shown})" if shown else what, statistic.n, *values, percents(statistic.cv)])
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
        text = f"{one.channel} answers with {figure_text('peak', one.unit, statistics['peak'].mean)}"
        text += f" in the mean of {n} blows" if n > 1 else ""
        if "ratio" in statistics:
            text += f", {written(statistics['ratio'].mean, 3)} of the base"
        if "frequency" in statistics and "damping" in statistics:
            text += f", and swings at {figure_text('frequency', '', statistics['frequency'].mean)}"
            text += f" with a damping ratio of {percents(statistics['damping'].mean, 2)}"
        words.append(f"{text}.")
    return " ".join(words)


def rigid_sections(files: Sequence[FileReading], names: Names) -> list[Section]:
    """Return what of the blows is rigid, by two methods; nothing where no blow rings."""
    found = [
        (names[file.path], reading, k, pulse)
        for file, reading in rows_of(files)
        for k, pulse in enumerate(reading.pulses, 1)
        if pulse.rigid is not None or pulse.split is not None
    ]
    if not found:
        return []
    cells = [[name, reading.channel.name, k, *_cells(pulse, reading.channel.unit)] for name, reading, k, pulse in found]
    text = (
        "Two ways to the pulse without its wave part. The joint fit takes pulse and one mode together. The band split "
        "takes a low-pass between the band of the pulse and the lowest mode, where its costs are least, and corrects "
        "the peak by what it takes off ideal pulses as wide. Costs are over the peak: how differently these pulses "
        "come out, what is left of the wave part, and what the lowest mode does in the pulse's own band. Apart is the "
        "difference of both peaks over its standard uncertainty: beyond 2 one of them is wrong. Where costs come to "
        "more than 10 % of the peak, the bands of pulse and wave part overlap, and they cannot be separated this way."
    )
    if len(cells) > MOST_LISTED:
        text += f" The first {MOST_LISTED} of {len(cells)} blows are listed."
    heads = ["file", "channel", "#", "joint fit", "model", "band split", "apart", "cutoff (kHz)", "lowest mode (kHz)"]
    heads += ["filter takes", "costs: shape", "wave left", "elastic", "energy of the wave part"]
    table = Table("Peaks without the wave part, ± a standard uncertainty", heads, cells[:MOST_LISTED])
    return [Section("Rigid and wave parts", text, [table])]


def _cells(pulse: RecordedPulse, unit: str) -> list[Cell]:
    rigid, split = pulse.rigid, pulse.split
    joint = NONE if rigid is None else plus_minus("peak", unit, rigid.peak, rigid.peak_uncertainty)
    model = NONE if rigid is None else rigid.model
    if split is None:
        return [joint, model, *[NONE] * 9]
    apart = pulse.methods_apart
    return [
        joint,
        model,
        plus_minus("peak", unit, split.peak, split.peak_uncertainty) if split.separable else "not separable",
        NONE if math.isnan(apart) else f"{apart:.2g}",
        *(written(frequency / 1e3, 3) for frequency in (split.cutoff, split.lowest_mode)),
        *(percents(share, 2) for share in (split.loss, split.loss_uncertainty, split.leak, split.elastic)),
        percents(split.wave_energy, 2),
    ]


def sensor_table(found: SensorTrials, names: Names) -> Table:
    """Return what is left of each blow."""
    rows: list[list[Cell]] = []
    for blow in found.blows[:MOST_LISTED]:
        trial = blow.trial
        used = percents(trial.range_used) if trial.range_used > 0.0 else NONE
        clipped = amount(MICROSECONDS, trial.time_clipped, digits=3)
        rows.append(
            [
                *(names[blow.file], blow.channel, str(blow.blow)),
                figure_text("peak", "m/s^2", trial.peak) + (" ?" if blow.doubted else ""),
                *(percents(trial.peak_left), percents(trial.width_left), used, clipped),
                *(percents(trial.ringing, 2), trial.verdict),
            ]
        )
    heads = ["file", "channel", "#", "highest value", "peak left", "width left", "of its range", "beyond it", "ringing"]
    many = f", the first {MOST_LISTED} of {len(found.blows)} blows" if len(found.blows) > MOST_LISTED else ""
    return Table(f"On {found.called}{many}", [*heads, "verdict"], rows, "No blow could be tried.")


MORE_COLUMNS = ("channel", "beyond it", "ringing")  # heads that a narrow screen leaves out first


def sensor_section(found: SensorTrials, names: Names) -> Section:
    """Return the chapter: the sensor, how it was tried, and what is left of each blow."""
    sensor, recorder, model = found.stated.sensor, found.stated.recorder, found.stated.model
    facts = [f"range {amount(ACCELERATION, sensor.range)}"] if math.isfinite(sensor.range) else []
    facts += [f"resonance {amount(KILOHERTZ, sensor.resonance)}, magnified {sensor.quality:.3g} times"] * math.isfinite(
        sensor.resonance
    )
    lowest = f"lowest resonance {amount(BANDWIDTH, found.resonance)} on its mounting"
    facts += [f"no {key} stated" for key in lacking(found.stated)]
    facts.append("directly mounted" if sensor.mounting.direct else lowest)
    if math.isfinite(recorder.sampling_rate):
        facts.append(f"recorded at {amount(KILOHERTZ, recorder.sampling_rate)}")
    if math.isfinite(recorder.cutoff):
        facts.append(f"low-pass of {recorder.order} poles at {amount(KILOHERTZ, recorder.cutoff)}")
    band = amount(BANDWIDTH, found.band)
    origin = "" if model is None else f" {model.name}: {model.status}; {model.source}. {model.note}"
    text = (
        f"{found.sentence()} Sensor: {listed(facts)}.{origin} Each blow is taken as the motion of "
        f"the surface, up to {band}, that the records hold; its highest value has noise, and what lies between its "
        "samples, in it, and may be above its measured peak. Left is what would be read, over what is recorded. "
        "Ringing is the largest departure of the sensing element from the motion, over the peak, and has the lag of a "
        "mounting in it. A peak or width more than 5 % off is not taken. sensor.csv has every blow."
    )
    if any(blow.doubted for blow in found.blows):
        text += " ? a peak that a finding of the record harms."
    return Section("On another sensor", text, [sensor_table(found, names)])
