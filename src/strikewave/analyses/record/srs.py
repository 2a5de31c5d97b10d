"""``strikewave srs``: the shock response spectrum of a measured record."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out, number, print_json, say, significant, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.records import ChannelReading
    from strikewave.signal.srs import Scope, Spectrum

KIND_UNITS = {"absolute": "m/s^2", "displacement": "m", "pseudo-velocity": "m/s"}
SIDES = ("maximax", "positive", "negative")
HIGHEST = 100e3
"""Highest natural frequency unless said otherwise, Hz; at most 2/5 of the sampling rate."""


class Result(NamedTuple):
    """Spectra of one channel of a file."""

    file: str
    reading: ChannelReading
    spectra: list[Spectrum]
    side: str
    scope: Scope


def command(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="A measured file of any known format.", show_default=False)
    ],
    q: Annotated[str, typer.Option("--q", help="Quality factor 1 / (2 damping ratio), or inf.")] = "10",
    low: Annotated[str, typer.Option("--from", help="Lowest natural frequency.")] = "10 Hz",
    high: Annotated[
        str | None, typer.Option("--to", help="Highest; 100 kHz or 2/5 of the sampling rate.", show_default=False)
    ] = None,
    per_octave: Annotated[str, typer.Option("--per-octave", help="Frequencies an octave.")] = "12",
    frequency: Annotated[
        list[str] | None, typer.Option("--frequency", help="These frequencies instead; repeated.", show_default=False)
    ] = None,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            "--kind", help="absolute (default), displacement or pseudo-velocity; may be repeated.", show_default=False
        ),
    ] = None,
    side: Annotated[str, typer.Option("--side", help="maximax, positive or negative.")] = "maximax",
    part: Annotated[str, typer.Option("--part", help="total, primary (while the shock lasts) or residual.")] = "total",
    end: Annotated[
        str | None, typer.Option("--end", help="When the shock ends, in the file's time.", show_default=False)
    ] = None,
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
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Compute shock response spectra of a record, its zero line taken off.

    With --json, files are written only where --out says.
    """
    from strikewave.signal.srs import srs

    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    kinds = tuple(dict.fromkeys(_one_of(k, tuple(KIND_UNITS), "--kind") for k in kind or ["absolute"]))
    _one_of(side, SIDES, "--side")
    quality = math.inf if q.strip().lower() == "inf" else _number(q, "--q", "a quality factor above zero, or inf")
    reading = _reading(file, stated, measured.options_of(rate, time, channel))
    frequencies = _frequencies(frequency, (low, high, per_octave), reading.channel.sampling_rate)
    scope = _scope(part, end, reading)
    values = reading.channel.values - _zero(reading)

    def of(one: str) -> Spectrum:
        return srs(values, reading.channel.step, frequencies, quality, one, scope)

    result = Result(file, reading, [of(one) for one in kinds], side, scope)
    if out is not None or not json:
        velocity = next((s for s in result.spectra if s.kind == "pseudo-velocity"), None) or of("pseudo-velocity")
        _write(result, velocity, out, force)
    if json:
        print_json(_document(result), indent=None)
    else:
        _print(result)
    return 0


def _number(text: str, field: str, allowed: str) -> float:
    from strikewave.base.errors import InputError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise InputError(field, text, allowed)
    return value


def _one_of(word: str, choices: Sequence[str], field: str) -> str:
    from strikewave.base.errors import InputError, nearest

    if word not in choices:
        raise InputError(field, word, "one of " + ", ".join(choices), nearest(word, choices))
    return word


def _reading(file: str, stated: dict[str, dict[str, Any]], options: Any) -> ChannelReading:
    """Return one channel of a file, examined; a bad one is named, and computed all the same."""
    from strikewave.records import Request, calibrations_beside, read_file, read_record

    wanted = Request(options.channels or ("1",), stated)
    record = read_record(file, options)
    measured.check_channels(stated, [record])
    reading = read_file(record, calibrations_beside(Path(file)), wanted)
    for finding in reading.all_findings:
        if finding.severity != "good" and "spectrum" in finding.harms:
            say(f"{finding.severity} [{finding.code}]: {finding.message}")
    if len(reading.channels) > 1 or (not options.channels and len(record.channels) > 1):
        say(f"the spectrum is that of {reading.channels[0].channel.name}; --channel takes another")
    return reading.channels[0]


def _frequencies(given: list[str] | None, grid: tuple[str, str | None, str], rate: float) -> Any:
    from strikewave.base.errors import InputError
    from strikewave.signal.srs import octaves

    if given:
        return [_below(measured.positive(text, "Hz", "--frequency"), text, "--frequency", rate) for text in given]
    low = measured.positive(grid[0], "Hz", "--from")
    high = min(HIGHEST, 0.4 * rate)
    if grid[1] is not None:
        high = _below(measured.positive(grid[1], "Hz", "--to"), grid[1], "--to", rate)
    per_octave = _number(grid[2], "--per-octave", "a number of frequencies above zero")
    if not low < high:
        raise InputError("--to", grid[1] or f"{high:g} Hz", f"a frequency above --from, {low:g} Hz")
    if per_octave * math.log2(high / low) > 1e5:
        raise InputError("--per-octave", grid[2], "at most 100 000 frequencies")
    return octaves(low, high, per_octave)


def _below(frequency: float, text: str, field: str, rate: float) -> float:
    from strikewave.base.errors import InputError

    if frequency >= 0.5 * rate:
        hint = "the record holds nothing above; sample faster"
        raise InputError(field, text, f"a frequency below half the sampling rate, {0.5 * rate:g} Hz", hint)
    return frequency


def _scope(part: str, end: str | None, reading: ChannelReading) -> Scope:
    from strikewave.base.errors import InputError
    from strikewave.base.units import parse_typed
    from strikewave.signal.srs import PARTS, Scope

    _one_of(part, PARTS, "--part")
    if end is None and part != "total" and reading.pulses:
        last = reading.pulses[-1].end
        say(f"the shock is taken to end with its last blow, at {last:.6g} s (--end)")
        return Scope(part, max(last - reading.channel.start, 2.0 * reading.channel.step))
    if end is None:
        return Scope(part)
    after = parse_typed(end, "s", "--end") - reading.channel.start
    if not reading.channel.step < after <= reading.channel.duration:
        last = reading.channel.start + reading.channel.duration
        raise InputError("--end", end, f"a time from {reading.channel.start:g} s to {last:g} s")
    return Scope(part, after)


def _zero(reading: ChannelReading) -> float:
    """Return the zero line: before the first blow, or the median of the record without one."""
    import numpy as np

    return reading.pulses[0].offset if reading.pulses else float(np.median(reading.channel.values))


def _document(result: Result) -> dict[str, Any]:
    from strikewave.base.json_document import head, plain

    file, reading, spectra, side, scope = result

    has = reading.channel.unit or "the file's own numbers"
    told = "" if has == "m/s^2" else f" for a record in m/s^2; this one is in {has}"
    units = {"frequency": "Hz", "q": "1", "zero_line": has, **{s.kind: KIND_UNITS[s.kind] + told for s in spectra}}
    first = spectra[0]
    document = {
        **head(units, _warnings(reading)),
        "file": file,
        "channel": reading.channel.name,
        "status": reading.status,
        "calibration": reading.calibration.stated(),
        "zero_line": _zero(reading),
        "q": first.q if math.isfinite(first.q) else "inf",
        "side": side,
        "part": first.part,
        "end": None if scope.end is None else scope.end + reading.channel.start,
        "frequency": first.frequency,
        **{spectrum.kind: spectrum.side(side) for spectrum in spectra},
    }
    return dict(plain(document))


def _warnings(reading: ChannelReading) -> list[dict[str, Any]]:
    return [
        {"code": f.code, "message": f.message, "value": f.value if f.value == f.value else None, "limit": None}
        for f in reading.findings
        if "spectrum" in f.harms or f.code in ("unit-unknown", "not-calibrated")
    ]


def _write(result: Result, velocity: Spectrum, out: Path | None, force: bool) -> None:
    from strikewave.analyses.record.figures.spectra import srs_figure, tripartite
    from strikewave.base.output_folder import whole_folder
    from strikewave.reporting.style import plain, save

    file, reading, spectra, side, _ = result
    path = Path(file)

    def titled(figure: Figure) -> Figure:
        part = "" if spectra[0].part == "total" else f", {spectra[0].part} part"
        figure.suptitle(plain(f"{path.name}, {reading.channel.name}{part}", 90), x=0.01, ha="left", fontsize=11)
        return figure

    folder, replace = (Path("out") / f"srs-{path.stem}", True) if out is None else (out, force)
    text = measured.identity(shlex.join(["strikewave", *sys.argv[1:]]), measured.digests_of([path]))
    told = "" if reading.channel.unit == "m/s^2" else " for a record in m/s^2"
    names = ["frequency (Hz)"] + [f"{s.kind} ({KIND_UNITS[s.kind]}{told})" for s in spectra]
    rows = zip(spectra[0].frequency, *(s.side(side) for s in spectra), strict=True)
    lines = [",".join(names), *(",".join(repr(float(v)) for v in row) for row in rows)]
    with whole_folder(folder, text, replace) as place:
        (place / "record.toml").write_text(text, "utf-8")
        (place / "spectrum.csv").write_text("\n".join(lines) + "\n", "utf-8")
        save(titled(srs_figure(spectra[0], unit=reading.channel.unit)), place / "summary.svg")
        save(titled(tripartite(velocity)), place / "tripartite.svg")
    say(f"written: {folder}/ (spectrum.csv, summary.svg, tripartite.svg, record.toml)")


def _print(result: Result) -> None:
    file, reading, spectra, side, _ = result
    first = spectra[0]
    step = max(len(first.frequency) // 24, 1)
    shown = range(0, len(first.frequency), step)
    in_g = reading.channel.unit == "m/s^2"
    screen = {"absolute": ("m/s^2", "g"), "displacement": ("m", "mm"), "pseudo-velocity": ("m/s", "m/s")}
    columns = ["frequency (Hz)"] + [f"{s.kind} ({screen[s.kind][1] if in_g else 'own'})" for s in spectra]
    rows = [
        [significant(float(first.frequency[k]), 4)]
        + [number(float(s.side(side)[k]), *(screen[s.kind] if in_g else (screen[s.kind][0],) * 2)) for s in spectra]
        for k in shown
    ]
    q = "undamped" if math.isinf(first.q) else f"Q = {first.q:g}"
    title = f"Shock response spectrum of {Path(file).name}, {reading.channel.name}: {q}, {side}, {first.part}"
    table(title, columns, rows, left=0)
    if step > 1:
        say(f"every {step}th of {len(first.frequency)} frequencies; --json or spectrum.csv has them all")
    for warning in _warnings(reading):
        say(f"warning [{warning['code']}]: {warning['message']}")
