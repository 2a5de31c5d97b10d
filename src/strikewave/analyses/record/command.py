"""``strikewave record``: what measured records say, file by file and together."""

from __future__ import annotations

import dataclasses
import math
import shlex
import sys
import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out, number, print_json, say, significant, table

if TYPE_CHECKING:
    from strikewave.records import Campaign, ChannelReading, FileReading, Record, Request
    from strikewave.signal.filters import Filter

UNREADABLE = 3
"""Exit code where some files could not be read."""
MOST_ROWS = 60
"""Files shown in the table on the screen."""


def command(
    files: measured.Files,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    gain: measured.Gain = None,
    excitation: measured.Excitation = None,
    rated_excitation: measured.RatedExcitation = None,
    count: measured.Count = None,
    polarity: measured.Polarity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    drop_height: Annotated[
        str | None, typer.Option("--drop-height", help='Fall before the blow, such as "1.2 m".', show_default=False)
    ] = None,
    cutoff: Annotated[
        str | None,
        typer.Option("--filter", help="Zero-phase low-pass: -3 dB there for both passes.", show_default=False),
    ] = None,
    cfc: Annotated[
        str | None,
        typer.Option("--cfc", help="SAE J211 filter of this channel class, such as 1000.", show_default=False),
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Examine records: status, health, pulses, campaign.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.record.result import record_document
    from strikewave.base.errors import StrikewaveError
    from strikewave.records import Request, compare, summed

    begun = clock.perf_counter()
    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    height = math.nan if drop_height is None else measured.positive(drop_height, "m", "--drop-height")
    wanted = Request(tuple(channel or ()), stated, height, _filter(cutoff, cfc))
    records = measured.read_all(files, measured.options_of(rate, time, channel))
    measured.check_channels(stated, (record for record in records if not isinstance(record, Exception)))
    read = [_reading(file, record, wanted, len(files) > 1) for file, record in zip(files, records, strict=True)]
    unread = [finding for file in read for finding in file.findings if finding.code == "unreadable"]
    if len(unread) == len(read):
        raise StrikewaveError(unread[0].message)
    readings = compare(read)
    numbers = dict.fromkeys(reading.number for file in readings for reading in file.channels)
    campaigns = [one for one in (summed(readings, k) for k in numbers) if one is not None]
    if out is not None or not json:
        _write(readings, campaigns, wanted, out, force)
    if json:
        print_json(record_document(readings, campaigns, wanted.filter), indent=None)
    else:
        _print(readings, campaigns, wanted.filter)
    say(f"done in {clock.perf_counter() - begun:.2f} s")
    return UNREADABLE if unread else 0


def _filter(cutoff: str | None, cfc: str | None) -> Filter | None:
    from strikewave.base.errors import InputError
    from strikewave.signal.filters import Filter

    if cutoff is not None and cfc is not None:
        raise InputError("--cfc", cfc, "either --filter or --cfc", "leave one out")
    if cutoff is not None:
        return Filter(measured.positive(cutoff, "Hz", "--filter"))
    if cfc is None:
        return None
    try:
        channel_class = float(cfc)
    except ValueError:
        channel_class = math.nan
    if not 0.0 < channel_class < 1e6:
        raise InputError("--cfc", cfc, "a channel frequency class, such as 60, 180, 600 or 1000")
    return Filter.sae_j211(channel_class)


def _reading(file: str, record: Record | Exception, wanted: Request, among: bool) -> FileReading:
    """Return what a file says; one among several that cannot be used is named, and the others are done."""
    from strikewave.base.errors import StrikewaveError
    from strikewave.records import FileReading, calibrations_beside, read_file, unreadable

    if isinstance(record, Exception):
        return FileReading(measured.shown(file), "", (), (unreadable(str(record)),))
    try:
        reading = read_file(record, calibrations_beside(Path(file)), wanted)
        return dataclasses.replace(reading, path=measured.shown(file))
    except StrikewaveError as error:
        if not among:
            raise
        say(f"left out: {file}: {error}")
        return FileReading(measured.shown(file), "", (), (unreadable(str(error)),))


def _write(
    readings: Sequence[FileReading], campaigns: Sequence[Campaign], wanted: Request, out: Path | None, force: bool
) -> None:
    from strikewave.analyses.record.figures.spectra import record_summary
    from strikewave.analyses.record.report import RecordFacts, record_report
    from strikewave.analyses.record.result import pulse_table, warnings_of
    from strikewave.base.output_folder import whole_folder
    from strikewave.reporting.style import save

    paths = [Path(reading.path) for reading in readings]
    name = paths[0].stem if len(paths) == 1 else paths[0].absolute().parent.name or "records"
    folder, replace = (Path("out") / f"record-{name}", True) if out is None else (out, force)
    asked = measured.shown(shlex.join(["strikewave", *sys.argv[1:]]))
    digests = measured.digests_of(paths)
    with whole_folder(folder, text := measured.identity(asked, digests), replace) as place:
        facts = RecordFacts(
            title=f"{len(paths)} records of {name}" if len(paths) > 1 else paths[0].name,
            command=asked,
            calibrations=_calibrations(wanted, paths),
            filter=wanted.filter,
            digests=digests,
        )
        (place / "record.toml").write_text(text, "utf-8")
        (place / "pulses.csv").write_text(pulse_table(readings), "utf-8")
        save(record_summary(readings, campaigns[0] if campaigns else None), place / "summary.svg")
        (place / "report.html").write_text(
            record_report(readings, campaigns, facts, warnings_of(readings)), "utf-8", newline="\n"
        )
    say(f"written: {folder}/ (report.html, summary.svg, pulses.csv, record.toml)")


def _calibrations(wanted: Request, paths: Sequence[Path]) -> list[tuple[str, str]]:
    """Return where a calibration was stated, and what."""
    from strikewave.records import calibrations_beside

    layers = {"command line": wanted.calibrations}
    layers |= {f"beside {path.name}": stated for path in paths if (stated := calibrations_beside(path))}
    return [
        (where, f"{channel}: " + ", ".join(f"{key} = {value}" for key, value in table.items()))
        for where, stated in layers.items()
        for channel, table in stated.items()
    ]


def _print(readings: Sequence[FileReading], campaigns: Sequence[Campaign], filter_: Filter | None) -> None:
    from strikewave.analyses.record.tables import short_names

    names = short_names([file.path for file in readings])
    rows = [row for file in readings for row in _rows(file, names[file.path])]
    columns = ["file", "channel", "status", "blows", "peak", "rise (us)", "width (us)", "velocity change"]
    shown = rows[:MOST_ROWS]
    title = f"{len(readings)} records" if len(readings) > 1 else readings[0].path
    table(
        title if len(rows) == len(shown) else f"{title}, the first {MOST_ROWS} of {len(rows)} rows",
        columns,
        shown,
        left=3,
    )
    for file in readings:
        if file.status != "good":
            say(f"{names[file.path]}, {file.status}: {'; '.join(file.reasons)}")
    for campaign in campaigns:
        _print_campaign(campaign, readings, names)
    _print_filter([reading for file in readings for reading in file.channels], filter_)
    for warning in _warnings(readings):
        say(warning)


def _rows(file: FileReading, name: str) -> list[list[str]]:
    from strikewave.records import worst

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
                _value(means["peak"], unit),
                number(means["rise"], "s", "us"),
                number(means["width"], "s", "us"),
                _integral(means["velocity_change"], unit),
            ]
        )
    return rows


def _mean(values: Sequence[float]) -> float:
    finite = [value for value in values if math.isfinite(value)]
    return sum(finite) / len(finite) if finite else math.nan


def _value(value: float, unit: str) -> str:
    if value != value:
        return "-"
    if unit == "1":
        return f"{significant(1e6 * value, 5)} ustrain"
    return f"{number(value, 'm/s^2', 'g', 5)} g" if unit == "m/s^2" else f"{significant(value, 5)} {unit}".strip()


def _integral(value: float, unit: str) -> str:
    from strikewave.analyses.record.result import INTEGRALS

    return "-" if value != value else f"{significant(value, 4)} {INTEGRALS.get(unit, '')}".strip()


def _print_campaign(campaign: Campaign, readings: Sequence[FileReading], names: dict[str, str]) -> None:
    from strikewave.records.campaign import SUMMED

    unit = next(r.channel.unit for file in readings for r in file.channels if r.channel.name == campaign.channel)
    writers: dict[str, Any] = {
        "peak": lambda v: _value(v, unit),
        "velocity_change": lambda v: _integral(v, unit),
        "interval": lambda v: number(v, "s", "ms") + " ms",
        "ringing_frequency": lambda v: number(v, "Hz", "Hz") + " Hz",
    }
    rows = []
    for name, found in campaign.statistics.items():
        write = writers.get(name, lambda v: number(v, "s", "us") + " us")
        line = campaign.trends.get(name)
        trend = "-" if line is None else f"{line.change:+.1%}" + ("" if line.low <= 0.0 <= line.high else " *")
        bounds = "-" if found.n < 2 else f"{write(found.low)} to {write(found.high)}"
        cv = "-" if found.n < 2 else f"{found.cv:.2%}"
        rows.append([name.replace("_", " "), write(found.mean), cv, bounds, str(found.n), trend])
    if not rows:
        say(f"{campaign.channel}: nothing is left to sum up")
        return
    columns = ["figure", "mean", "scatter (CV)", "mean, 95 % bounds", "blows", "trend over the files"]
    table(f"All blows together: {campaign.channel}", columns, rows)
    if any(" *" in row[-1] for row in rows):
        say("* a trend that scatter alone gives in less than 5 % of campaigns")
    for path, figures, _ in campaign.left_out:
        what = "all figures" if len(figures) == len(SUMMED) else ", ".join(figures).replace("_", " ")
        say(f"left out: {what} of {names[path]}")


def _print_filter(readings: Sequence[ChannelReading], filter_: Filter | None) -> None:
    """Say what the filter did to each channel, or which cutoff would leave the steepest blow of all as it is."""
    from strikewave.analyses.record.result import cutoff_for, filter_effect

    if filter_ is None:
        cutoffs = [cutoff for cutoff in map(cutoff_for, readings) if cutoff is not None]
        if cutoffs:
            kilohertz = significant(max(cutoffs) / 1e3, 3)
            say(f"a low-pass of {kilohertz} kHz or more (--filter) leaves 98 % of a half-sine as steep as these")
        return
    for reading in readings:
        effect = filter_effect(reading, filter_)
        said = f"{reading.channel.name}: {effect['name']}"
        if effect["peak_left"]:
            peak, width = _mean(effect["peak_left"]), _mean(effect["width_left"])
            said += f" leaves {peak:.1%} of the peak, {width:.1%} of the width"
        if effect["half_sine_peak_left"] is not None:
            said += f" (of a half-sine as wide {effect['half_sine_peak_left']:.1%})"
        say(said)


def _warnings(readings: Sequence[FileReading]) -> list[str]:
    from strikewave.analyses.record.result import warnings_of

    return [f"warning [{w['code']}]: {w['message']}" for w in warnings_of(readings)]
