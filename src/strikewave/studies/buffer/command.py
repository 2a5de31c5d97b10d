"""``strikewave buffer``: rank gasket stacks under a sensor by what it then reads."""

from __future__ import annotations

import math
import os
import shlex
import shutil
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import (
    Changes,
    Force,
    Json,
    Out,
    number,
    print_json,
    progress_bar,
    say,
    say_compiling,
    significant,
    table,
)

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.cases.case import Case
    from strikewave.cases.tables import SensorTable
    from strikewave.records import ChannelReading, Finding
    from strikewave.studies.buffer.candidate import Candidate
    from strikewave.studies.buffer.choice import Choice
    from strikewave.studies.buffer.result import BufferStudy
    from strikewave.studies.buffer.seat import Blows, Seat

THICKNESSES = ("0.5 mm", "1 mm", "2 mm")
"""Of the gaskets unless said otherwise."""
LONGEST = 200_000
"""Samples of a record that are kept about its largest value."""

COLUMNS = (
    "#", "stack, from the surface up", "peak\n(g)", "of limit\n(1)", "5 %\n(Hz)", "10 %\n(Hz)", "-3 dB\n(Hz)",
    "resonance\n(Hz)", "Q", "softer\n(g)", "stiffer\n(g)", "no slip\n(g)", "robust",
)  # fmt: skip
LEFT_OUT, WIDE = (4, 6, 7, 8, 9, 11), 150
"""Columns of the table that a screen with fewer characters does without."""
NAME, SHORT_NAME = 38, 24
"""Characters of a line of a stack's name, on a wide and on a narrow screen."""


class Source(NamedTuple):
    """Where sensor and blow come from: the case, the sensor's table, its seat, the record's path and reading."""

    case: Case | None
    seat: Seat
    record: Path | None = None
    reading: ChannelReading | None = None


def command(
    case: Annotated[
        str | None,
        typer.Argument(metavar="[CASE]", help="A case file or published case with the sensor.", show_default=False),
    ] = None,
    limit: Annotated[str, typer.Option("--limit", help='Largest reading, such as "5000 g".', show_default=False)] = "",
    sensor: Annotated[
        str | None, typer.Option("--sensor", help="Its name, where the case has several.", show_default=False)
    ] = None,
    blow: Annotated[str, typer.Option("--blow", help="worst, first, or the number of a blow.")] = "worst",
    material: Annotated[
        list[str] | None,
        typer.Option(
            "--material", help="Of the gaskets; repeated. Polymers and elastomers by default.", show_default=False
        ),
    ] = None,
    thickness: Annotated[
        list[str] | None,
        typer.Option("--thickness", help="Of the gaskets; repeated. 0.5, 1 and 2 mm by default.", show_default=False),
    ] = None,
    layers: Annotated[int, typer.Option("--layers", help="Most gaskets of a stack.")] = 3,
    rank: Annotated[str, typer.Option("--rank", help="bandwidth, peak or robust: what comes first.")] = "bandwidth",
    mass: Annotated[str | None, typer.Option("--mass", help="Of the sensor.", show_default=False)] = None,
    diameter: Annotated[
        str | None, typer.Option("--diameter", help="Of the gaskets; that of the case by default.", show_default=False)
    ] = None,
    model: Annotated[str | None, typer.Option("--model", help="A known accelerometer.", show_default=False)] = None,
    record: Annotated[
        str | None,
        typer.Option(
            "--record", metavar="FILE", help="Measured acceleration of the mounting surface.", show_default=False
        ),
    ] = None,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Rank gasket stacks under a sensor by what it then reads of a blow, with their price in bandwidth.

    The blow is that of a machine case or a bar case at the sensor's tap, or a record. With --json, files are
    written only where --out says.
    """
    begun = clock.perf_counter()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for matrices this small, threads wait longer than they work
    from strikewave.base.errors import InputError
    from strikewave.studies.buffer.candidate import Goal
    from strikewave.studies.buffer.study import design_buffer

    goal = Goal(_limit(limit), rank)
    choice = _choice(material, thickness, layers)
    given = _given(mass, diameter, model)
    if record is None:
        source = _from_case(case, sensor, changes, given)
        _check_out(out)
        say_compiling()
        with progress_bar("blows") as report:
            blows = _blows(source, blow, report)
    else:
        if blow != "worst":
            raise InputError("--blow", blow, "only without --record, which holds one blow")
        stated = measured.stated_of(unit=unit, sensitivity=sensitivity)
        reading, findings = _reading(record, stated, measured.options_of(rate, time, channel))
        seat = _from_case(case, sensor, changes, given, needed=False).seat
        source = Source(None, seat, Path(record), reading)
        _check_out(out)
        blows = _recorded(source.record, reading, findings)
    with progress_bar("stacks") as report:
        study = design_buffer(source.seat, blows, choice, goal, report)
    if out is not None or not json:
        _write(study, source, out, force)
    if json:
        print_json(study.document(), indent=None)
    else:
        _print(study)
    say(f"done in {clock.perf_counter() - begun:.2f} s")
    return BROKEN if study.broken else 0


def _limit(text: str) -> float:
    from strikewave.base.errors import MISSING, InputError
    from strikewave.base.units import parse_quantity

    allowed = 'an acceleration above zero with its unit, such as "5000 g"'
    if not text:
        raise InputError("--limit", MISSING, allowed, 'add --limit "5000 g"')
    value = parse_quantity(text, "m/s^2", "--limit")
    if not 0.0 < value < math.inf:
        raise InputError("--limit", text, allowed)
    return value


def _quantity(text: str, si: str, highest: float, field: str) -> Value:
    """Read a quantity above zero as a case file would."""
    from strikewave.base.errors import InputError
    from strikewave.base.quantities import Range

    try:
        value = Range(si, 0.0, highest, open_low=True).read(text)
    except InputError as error:
        raise InputError(field, error.got, error.allowed, error.hint) from None
    return value.model_copy(update={"note": "chosen by strikewave buffer"})


def _choice(names: list[str] | None, sizes: list[str] | None, layers: int) -> Choice:
    from strikewave.studies.buffer.choice import Choice, stacks
    from strikewave.studies.buffer.seat import usual_materials

    thicknesses = tuple(_quantity(text, "m", 0.1, "--thickness") for text in sizes or THICKNESSES)
    choice = Choice(tuple(names or usual_materials()), thicknesses, layers)
    stacks(choice)
    return choice


def _given(mass: str | None, diameter: str | None, model: str | None) -> dict[str, Any]:
    """Return what was typed of the sensor."""
    found: dict[str, Any] = {} if model is None else {"model": model}
    if mass is not None:
        found["mass"] = _quantity(mass, "kg", 1e3, "--mass")
    if diameter is not None:
        found["diameter"] = _quantity(diameter, "m", 1.0, "--diameter")
    return found


def _from_case(
    name: str | None, sensor: str | None, changes: list[str] | None, given: dict[str, Any], needed: bool = True
) -> Source:
    """Return case and seat; without a case, where none is needed, the seat stands on what was typed."""
    from strikewave.base.errors import MISSING, InputError
    from strikewave.cases.case import load_case
    from strikewave.cases.tables import SensorTable
    from strikewave.studies.buffer.seat import choose_sensor, seat_of

    typed = {key: value for key, value in given.items() if key != "diameter"}
    footprint = {"diameter": given["diameter"]} if "diameter" in given else None
    if name is None:
        if needed:
            raise InputError("CASE", MISSING, "a case, or --record with a measured blow", "see `strikewave cases`")
        if sensor is not None or changes:
            field = "--set" if sensor is None else "--sensor"
            hint = "without one, --model, --mass and --diameter describe the sensor"
            raise InputError(field, sensor or changes, "only with a case", hint)
        alone: SensorTable = SensorTable(name="sensor").model_copy(update=typed)
        return Source(None, seat_of(alone, None, footprint))
    case = load_case(name, changes or ())
    table = choose_sensor(case, sensor).model_copy(update=typed)
    return Source(case, seat_of(table, case, footprint))


def _blows(source: Source, blow: str, report: Callable[[float], None]) -> Blows:
    from strikewave.studies.buffer.seat import blows_of

    assert source.case is not None
    return blows_of(source.case, source.seat.table, blow, report)


def _reading(file: str, stated: dict[str, dict[str, Any]], options: Any) -> tuple[ChannelReading, list[Finding]]:
    """Return one channel of a file, and what its examination suspects; one that it calls bad is refused."""
    from strikewave.base.errors import InputError
    from strikewave.records import Request, calibrations_beside, read_file, read_record

    record = read_record(file, options)
    measured.check_channels(stated, [record])
    reading = read_file(record, calibrations_beside(Path(file)), Request(options.channels or ("1",), stated))
    channel = reading.channels[0].channel
    if channel.unit != "m/s^2":
        has = channel.unit or "the file's own numbers"
        raise InputError("--unit", has, "an acceleration", 'say --unit g, or --sensitivity "1.2 mV/g"')
    findings = [finding for finding in reading.all_findings if finding.severity != "good"]
    if reading.status == "bad":
        why = "; ".join(f"{f.code}: {f.message}" for f in findings if f.severity == "bad")
        hint = f"{why}; see `{shlex.join(['strikewave', 'record', file])}`, or take another --channel"
        raise InputError("--record", file, "a record that its examination does not call bad", hint)
    return reading.channels[0], findings


def _recorded(path: Path | None, reading: ChannelReading, findings: list[Finding]) -> Blows:
    """Return the motion about the largest value of a record, its zero line taken off."""
    import numpy as np

    from strikewave.base.result import Notice
    from strikewave.studies.buffer.seat import Blows, Motion

    channel = reading.channel
    zero = reading.pulses[0].offset if reading.pulses else float(np.median(channel.values))
    values = channel.values - zero
    first = max(int(np.argmax(np.abs(values))) - LONGEST // 4, 0)
    values = values[first : first + LONGEST]
    message = (
        f"the record holds nothing above {0.5e-3 * channel.sampling_rate:.4g} kHz, nor what its own sensor and filter "
        "took off: a stiff buffer may read more than is shown"
    )
    warnings = [Notice("record-bandwidth", message, 0.5 * channel.sampling_rate, 0.0)]
    warnings += [Notice("record-suspect", f"{f.code}: {f.message}", f.value, 0.0) for f in findings]
    name = f"{path.name if path else ''} {channel.name}".strip()
    return Blows((Motion(name, values, channel.step, channel.start + first * channel.step),), 0, tuple(warnings))


def _check_out(out: Path | None) -> None:
    """Refuse a folder of results that holds something else before the work begins."""
    from strikewave.base.output_folder import check_place

    if out is not None:
        check_place(out, "", force=True)


def _write(study: BufferStudy, source: Source, out: Path | None, force: bool) -> None:
    """Write documents and pictures, and the case or the sensor with the first stack in it."""
    import json

    from strikewave.base.output_folder import whole_folder
    from strikewave.reporting.style import save
    from strikewave.studies.buffer.figures import buffer_histories, buffer_transmissibility, peak_bandwidth

    mark, text = _marked(study, source)
    folder, replace = (Path("out") / f"buffer-{_called(source)}", True) if out is None else (out, force)
    with whole_folder(folder, text, replace) as place:
        (place / mark).write_text(text, "utf-8")
        if mark == "record.toml":
            (place / "sensor.toml").write_text(_sensor_text(study, source), "utf-8")
        (place / "buffer.json").write_text(json.dumps(study.document(), allow_nan=False) + "\n", "utf-8")
        (place / "buffers.csv").write_text(study.table(), "utf-8")
        save(peak_bandwidth(study), place / "peak-bandwidth.svg")
        save(buffer_histories(study), place / "histories.svg")
        save(buffer_transmissibility(study), place / "transmissibility.svg")
    names = "buffers.csv, buffer.json, peak-bandwidth.svg, histories.svg, transmissibility.svg"
    say(f"written: {folder}/ ({mark}{', sensor.toml' if mark == 'record.toml' else ''}, {names})")


def _called(source: Source) -> str:
    if source.record is not None:
        return source.record.stem
    return (source.case.name if source.case else "") or "case"


def _marked(study: BufferStudy, source: Source) -> tuple[str, str]:
    """Return name and text of the file that marks the result: the case with the first stack, or what was asked."""
    from strikewave.cases.case import dump_case
    from strikewave.studies.buffer.seat import case_with

    if source.case is not None:
        return "case.toml", dump_case(case_with(source.case, source.seat, study.candidates[0].sheets))
    asked = shlex.join(["strikewave", *sys.argv[1:]])
    return "record.toml", measured.identity(asked, measured.digests_of([source.record] if source.record else []))


def _sensor_text(study: BufferStudy, source: Source) -> str:
    """Return the [[sensor]] of a case with the first stack under it."""
    import tomlkit

    from strikewave.base.quantities import Value
    from strikewave.studies.buffer.seat import with_sheets

    def typed(fields: Any) -> dict[str, Any]:
        return {key: value.typed if isinstance(value, Value) else value for key, value in fields if value}

    table = with_sheets(source.seat, study.candidates[0].sheets)
    row = {**typed(table), "gasket": [typed(layer) for layer in table.gasket]}
    return tomlkit.dumps({"sensor": [row]})


def _print(study: BufferStudy) -> None:
    from strikewave.studies.buffer.candidate import ALIKE, RINGING, distinct
    from strikewave.studies.buffer.study import LEADING

    motion, seat = study.motion, study.seat
    rigid = "" if motion.rigid_peak is None else f", rigid-body peak {number(motion.rigid_peak, 'm/s^2', 'g', 5)} g"
    say(
        f"{seat.table.name}, {seat.mass * 1e3:.4g} g of mass, on {seat.area * 1e6:.4g} mm^2 of gasket; {motion.name}: "
        f"surface {number(motion.peak, 'm/s^2', 'g', 5)} g{rigid}"
    )
    say("the motion of the surface is given: the sensor's back-effect on the structure is not modelled")
    shown = distinct(study.candidates, LEADING)
    shown += [c for c in (study.robust, study.direct) if c is not None and c not in shown]
    places = {candidate: place for place, candidate in enumerate(study.candidates, 1)}
    rows = [_cells(str(places[candidate]), candidate) for candidate in sorted(shown, key=places.__getitem__)]
    rows += [] if study.present is None else [_cells("", study.present)]
    kept = sum(candidate.keeps for candidate in study.candidates)
    first_by = {"robust": "the robust first, then by bandwidth"}.get(study.goal.rank, f"first by {study.goal.rank}")
    title = (
        f"{kept} of {len(study.candidates)} stacks keep {number(study.goal.limit, 'm/s^2', 'g', 5)} g; "
        f"{first_by if kept else 'first by peak'} (* on the front of peak and bandwidth)"
    )
    kinds = [k for k in range(len(COLUMNS)) if k not in LEFT_OUT or _wide()]
    table(title, [COLUMNS[k] for k in kinds], [[row[k] for k in kinds] for row in rows], left=2)
    if len(study.candidates) > len(shown):
        say(
            f"stacks with peak and bandwidth of one above within {ALIKE:.0%} are left out here; --json and the files "
            "have all"
        )
    first = study.candidates[0]
    words = [f"{first.rigid_ratio:.3g} times the rigid-body peak"] if math.isfinite(first.rigid_ratio) else []
    if math.isfinite(first.velocity_error):
        words += [f"velocity change off by {first.velocity_error:+.1%}"]
    elif first.ringing > RINGING or not first.whole:
        words += ["velocity change not known: the history ends while it still rings"]
    words += [f"{first.sag * 1e6:.3g} um of sag", f"loss factors held to {first.loss_error:.1%} from 1 to 100 kHz"]
    say(f"{first.name}: {', '.join(words)}")
    for notice in study.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _wide() -> bool:
    """Return whether the screen holds all columns; without one there is room."""
    return shutil.get_terminal_size((160, 24)).columns >= WIDE


def _cells(place: str, candidate: Candidate) -> list[str]:
    """Return a row of the table on the screen."""
    band, found = candidate.band, candidate.leading if candidate.sheets else None
    passed = [
        "-" if not math.isfinite(f) else significant(f, 3)
        for f in (band.within_5, band.within_10, band.half_power, band.resonance)
    ]
    spread = (found.softer, found.stiffer, found.confined) if found else (None,) * 3
    return [
        f"{place}{'*' if candidate.pareto else ''}",
        _folded(candidate.name),
        number(candidate.true_peak, "m/s^2", "g", 5) + (" cut" if candidate.clipped else ""),
        "-" if math.isnan(candidate.margin) else f"{1.0 - candidate.margin:.3g}",
        *passed,
        "-" if math.isnan(band.quality) else significant(band.quality, 3),
        *(number(peak, "m/s^2", "g", 4) for peak in spread),
        "-" if found is None or not candidate.keeps else "yes" if found.robust else "no",
    ]


def _folded(name: str) -> str:
    """Return the name of a stack in lines that end between gaskets."""
    lines, longest = [""], NAME if _wide() else SHORT_NAME
    for part in name.split(" | "):
        if lines[-1] and len(lines[-1]) + len(part) > longest - 5:
            lines.append(part)
        else:
            lines[-1] += f" | {part}" if lines[-1] else part
    return " |\n".join(lines)
