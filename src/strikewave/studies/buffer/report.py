"""Page, screen and command of a buffer design."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from strikewave.base.errors import MISSING, InputError
from strikewave.base.result import Notice
from strikewave.base.texts import command_line, file_word, percent
from strikewave.cases.case import Case, load_case
from strikewave.cases.tables.stack import SensorTable
from strikewave.records import ChannelReading, HealthNotice, Options
from strikewave.reporting import chapters
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, columns_of, part_tables, text_of
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Picture, Section, Tag
from strikewave.reporting.run_and_write import drawing, run_and_write
from strikewave.reporting.style import save
from strikewave.reporting.terminal import print_rows, progress_bar, tell
from strikewave.studies.buffer.mounting_site import (
    SURFACE,
    BaseMotion,
    Blows,
    MountingSite,
    blows_of,
    choose_sensor,
    mounting_site_of,
)
from strikewave.studies.buffer.result import MARKED, BufferStudy, stack_columns
from strikewave.studies.buffer.stacks import (
    ALIKE,
    READING,
    RINGING,
    BufferCandidate,
    BufferGoal,
    StackChoices,
    StackGasket,
    distinct,
)
from strikewave.studies.buffer.study import LEADING, design_buffer
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_ROWS = 20
"""Stacks in the table: the first that differ; buffers.csv has all."""


def page(study: BufferStudy) -> str:
    """Return the report of a buffer design as one HTML page: no script, nothing fetched, the same bytes each time."""
    from strikewave.studies.buffer.figures import buffer_histories, buffer_transmissibility, peak_bandwidth

    first = study.candidates[0]
    pictures = [
        Picture(
            buffer_histories(study),
            f"What {study.site.table.name} reads of {study.motion.name}: directly, and on the first stacks of the "
            "ranking.",
        ),
        Picture(
            peak_bandwidth(study),
            "Each stack by the largest reading (of the element where cut off) and the frequency up to which it passes "
            "amplitudes within 10 %.",
        ),
        Picture(buffer_transmissibility(study), "What the first stacks pass: acceleration of the sensor over surface."),
    ]
    sections = [
        Section("Readings and bandwidth", "", pictures),
        _ranking_section(study),
        *([_gasket_section(study, first)] if first.stack else []),
        chapters.warnings(study.notices),
        _sensor_section(study),
        *([chapters.inputs(study.case)] if study.case is not None else []),
    ]
    status = Tag("no stack keeps the limit", "bad") if study.broken else None
    summary = chapters.Summary("Report of a buffer design", buffer_words(study), study.highlights(), status)
    return chapters.result_page(study, summary, sections)


def buffer_words(study: BufferStudy) -> str:
    """Say in words what the stacks do to the reading."""
    first, limit = study.candidates[0], text_of(study, "limit")
    sentences = [
        f"{study.keeping} stacks keep the reading of {study.motion.name} within {limit}; directly "
        f"on the surface {study.site.table.name} would read {_peak(study.direct)}.",
        f"{study.order[0].upper()}{study.order[1:]}: {first.name}, {_peak(first)}, amplitudes within 10 % up to "
        f"{study.bandwidth}.",
    ]
    if study.verdicts.words:
        sentences.insert(0, f"{study.verdicts.sentence[:-1]}: the blow is that of this run.")
    if study.robust is None:
        sentences.append("No stack is known to keep the limit whatever the moduli of its gaskets.")
    elif study.robust is not first:
        sentences.append(
            f"Whatever the moduli of its gaskets, {study.robust.name} keeps it, with {_peak(study.robust)}."
        )
    sentences.append(
        "The motion of the surface is given: the back-effect of the sensor on the structure is not modelled."
    )
    return " ".join(sentences)


def _peak(candidate: BufferCandidate) -> str:
    return text_of(candidate, "true_peak") + (" (cut off)" if candidate.clipped else "")


def _ranking_section(study: BufferStudy) -> Section:
    """List the first distinct stacks, the robust and the direct one, and the buffer that the case has now."""
    listing = distinct(study.candidates, MOST_ROWS)
    listing += [stack for stack in (study.robust, study.direct) if stack is not None and stack not in listing]
    rows = [stack for stack in study.stacks if stack in listing or stack is study.present]
    text = (
        f"Stacks with reading and bandwidth of one above within {percent(ALIKE, 0)} are left out; buffers.csv has all. "
        "Where a reading is cut off, the value is that of the element. Robust stacks keep the limit "
        "whatever the moduli of their gaskets."
    )
    moduli = (
        "Readings with other moduli: all softer or all stiffer by what is known of them, and the faces of elastomers "
        "held so that they cannot slip"
    )
    tables = [
        page_table(f"Stacks by rank ({MARKED})", stack_columns("page", rows)),
        page_table(moduli, stack_columns("moduli", [stack for stack in rows if stack.stack and stack.leading])),
    ]
    return Section("Stacks", text, tables)


def _gasket_section(study: BufferStudy, first: BufferCandidate) -> Section:
    """List the gaskets of the first stack: what they bear, and what is known of their material."""
    text = (
        f"From the surface up. The stack is {text_of(first, 'height')} high and sags by {text_of(first, 'sag')} under "
        f"its load; loss factors are held within {percent(first.loss_error)} from 1 to 100 kHz."
    )
    table = page_table("Gaskets", columns_of(StackGasket, first.gaskets or []))
    return Section("Gaskets of the first stack", text, [table])


def _sensor_section(study: BufferStudy) -> Section:
    """List sensor, footprint and blow."""
    site, motion = study.site, study.motion
    sentences = [f"The sensor is a {site.table.model}."] if site.table.model else []
    sentences += [] if math.isfinite(site.channel.sensor.range) else ["The sensor has no stated range."]
    sentences += [] if math.isfinite(site.channel.recorder.sampling_rate) else ["Its recorder is ideal."]
    if motion.recorded is not None:
        sentences.append(
            f"The largest sample, with the noise that readings have too, is {text_of(motion, 'largest_sample')}."
        )
    return Section(
        "Sensor and blow", " ".join(sentences), [*part_tables(study, "sensor"), *part_tables(study, "motion")]
    )


def picture(study: BufferStudy) -> Figure:
    """Draw the picture of a result in Python, see `strikewave.reporting.shown_result`."""
    from strikewave.studies.buffer.figures import peak_bandwidth

    return peak_bandwidth(study)


LONGEST = 200_000
"""Samples of a record that are kept about its largest value, a quarter of them before it: at 1 MHz 0.2 s, longer than
any blow and its ringing, and few enough for a run of each stack."""


class BlowSource(NamedTuple):
    """The source of sensor and blow: the case, the site of the sensor, path and reading of a record."""

    case: Case | None
    site: MountingSite
    record: Path | None = None
    reading: ChannelReading | None = None
    found: Sequence[HealthNotice] = ()


def source_of_record(
    file: str,
    stated: dict[str, dict[str, Any]],
    options: Options,
    case: tuple[str | None, str | None, list[str] | None],
    stated_sensor: dict[str, Any],
) -> BlowSource:
    """Return where the blow of a record, and the sensor of a case or of what was typed, come from."""
    reading, notices = _reading(file, stated, options)
    return BlowSource(None, source_of_case(*case, stated_sensor, needed=False).site, Path(file), reading, notices)


@dataclass
class BufferCommand(ResumableCommand[BufferStudy]):
    """A search for the gaskets under a sensor; one that is stopped goes on where it was.

    Attributes
    ----------
    source : BlowSource
        Source of sensor and blow.
    blow : str
        Blow of a case: worst, first, or a number.
    choice : StackChoices
        Gaskets to choose from.
    goal : BufferGoal
        Goal that the reading must keep.
    pool : Pool
        Pool that runs the stacks.
    test : mapping of str to str
        Statements about the test, where no case holds it.
    """

    source: BlowSource
    blow: str
    choice: StackChoices
    goal: BufferGoal
    pool: Pool
    test: Mapping[str, str] = dataclasses.field(default_factory=dict)

    def run(self, output: Output) -> int:
        """Rank the stacks, write and print them, and return the exit code."""
        source = self.source
        if source.case is not None:
            self.source = source._replace(case=output.tested(source.case))
        else:
            self.test = output.stated_test()
        name = source.record.stem if source.record is not None else (source.case.name if source.case else "") or "case"
        return run_and_write(self, output, f"buffer-{name}", None)

    def solved(self, store: RunStore) -> BufferStudy:
        """Return the study, with bars on stderr."""
        source = self.source
        if source.reading is not None:
            blows = _recorded(source.record, source.reading, source.found)
        else:
            assert source.case is not None
            with progress_bar("blows") as report:
                blows = blows_of(source.case, source.site.table, self.blow, report)
        try:
            with progress_bar("stacks") as report:
                advance = share_reporter(report)
                study = design_buffer(source.site, blows, self.choice, self.goal, store, self.pool, advance)
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store, "stacks")
        origin = None
        if source.record is not None:
            origin = measured.source_of("records", source.record.stem, [source.record], self.test)
        return dataclasses.replace(study, case=source.case, origin=origin, asked=measured.asked())

    def summary(self, result: BufferStudy) -> str:
        """Say which stack is first, and what the sensor then reads."""
        return buffer_words(result)

    def show(self, result: BufferStudy) -> None:
        """Print the ranking."""
        motion, site = result.motion, result.site
        rigid = "" if motion.rigid_peak is None else f", rigid-body peak {amount(SURFACE, motion.rigid_peak, digits=5)}"
        if motion.recorded is not None:
            largest = amount(SURFACE, motion.largest_sample, digits=5)
            rigid += f" (largest sample {largest}: readings below have its noise too)"
        tell(
            f"{site.table.name}, {text_of(result.sensor, 'mass')}, on {text_of(result.sensor, 'area')} of gasket; "
            f"{motion.name}: surface {amount(SURFACE, motion.peak, digits=5)}{rigid}",
            "  ",
        )
        shown = distinct(result.candidates, LEADING)
        shown += [c for c in (result.robust, result.direct) if c is not None and c not in shown]
        rows = [stack for stack in result.stacks if stack in shown or stack is result.present]
        title = f"{result.keeping} stacks keep {amount(READING, result.limit, digits=5)}; {result.order} ({MARKED})"
        print_rows(title, stack_columns("screen", rows))
        if len(result.candidates) > len(shown):
            tell(
                f"stacks with peak and bandwidth of one above within {percent(ALIKE, 0)} are left out here; --json and "
                "the files have all"
            )
        first = result.candidates[0]
        parts = [f"{first.rigid_ratio:.3g} times the rigid-body peak"] if math.isfinite(first.rigid_ratio) else []
        if math.isfinite(first.velocity_error):
            parts += [f"velocity change off by {percent(first.velocity_error, 1, '+')}"]
        elif first.ringing > RINGING or not first.whole:
            parts += ["velocity change not known: the history ends while it still rings"]
        parts += [
            f"{text_of(first, 'sag')} of sag",
            f"loss factors held to {percent(first.loss_error)} from 1 to 100 kHz",
        ]
        tell(f"{first.name}: {', '.join(parts)}")

    def draw(self, result: BufferStudy, folder: Path) -> list[str]:
        """Write the page, peak over bandwidth, histories and transmissibility."""
        from strikewave.studies.buffer.figures import buffer_histories, buffer_transmissibility, peak_bandwidth

        with drawing(folder / "peak-bandwidth.svg") as path:
            save(peak_bandwidth(result), path)
        with drawing(folder / "histories.svg") as path:
            save(buffer_histories(result), path)
        with drawing(folder / "transmissibility.svg") as path:
            save(buffer_transmissibility(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(page(result), "utf-8", newline="\n")
        return ["report.html", "peak-bandwidth.svg", "histories.svg", "transmissibility.svg"]


def source_of_case(
    name: str | None, sensor: str | None, changes: list[str] | None, stated_sensor: dict[str, Any], needed: bool = True
) -> BlowSource:
    """Return case and site; without a case, where none is needed, the site stands on what was typed."""
    typed = {key: value for key, value in stated_sensor.items() if key != "diameter"}
    footprint = {"diameter": stated_sensor["diameter"]} if "diameter" in stated_sensor else None
    if name is None:
        if needed:
            raise InputError("CASE", MISSING, "a case, or --record with a measured blow", "see `strikewave cases`")
        if sensor is not None or changes:
            field = "--set" if sensor is None else "--sensor"
            hint = "without one, --model, --mass and --diameter describe the sensor"
            raise InputError(field, sensor or changes, "only with a case", hint)
        alone: SensorTable = SensorTable(name="sensor").model_copy(update=typed)
        return BlowSource(None, mounting_site_of(alone, None, footprint))
    case = load_case(name, changes or ())
    table = choose_sensor(case, sensor).model_copy(update=typed)
    return BlowSource(case, mounting_site_of(table, case, footprint))


def _reading(file: str, stated: dict[str, dict[str, Any]], options: Any) -> tuple[ChannelReading, list[HealthNotice]]:
    """Return one channel of a file, and what its examination suspects; one that it calls bad is refused."""
    _, reading = measured.read_channels(file, stated, options)
    channel = reading.channels[0].channel
    if channel.unit != "m/s^2":
        has = channel.unit or "the file's own numbers"
        raise InputError("--unit", has, "an acceleration", 'say --unit g, or --sensitivity "1.2 mV/g"')
    findings = [finding for finding in reading.all_findings if finding.severity != "good"]
    if reading.status == "bad":
        why = "; ".join(f"{f.code}: {f.message}" for f in findings if f.severity == "bad")
        hint = f"{why}; see `{command_line(['record', file_word(file)])}`, or take another --channel"
        raise InputError("--record", file, "a record that its examination does not call bad", hint)
    return reading.channels[0], findings


def _recorded(path: Path | None, reading: ChannelReading, findings: Sequence[HealthNotice]) -> Blows:
    """Return the motion about the largest value of a record, with the baseline of its blow taken off."""
    channel = reading.channel
    place = int(np.argmax(np.abs(channel.values - reading.baseline)))
    at = channel.start + place * channel.step
    blow = min(reading.pulses, key=lambda pulse: abs(pulse.time - at), default=None)
    first = max(place - LONGEST // 4, 0)
    values = channel.values[first : first + LONGEST] - (reading.baseline if blow is None else blow.offset)
    message = (
        f"the record holds nothing above {0.5e-3 * channel.sampling_rate:.4g} kHz, nor what its own sensor and filter "
        "took off: a stiff buffer may read more than is shown"
    )
    warnings = [Notice("record-bandwidth", message, 0.5 * channel.sampling_rate, 0.0)]
    warnings += [Notice("record-suspect", f"{f.code}: {f.message}", f.value, 0.0) for f in findings]
    name = f"{path.name if path else ''} {channel.name}".strip()
    motion = BaseMotion(name, values, channel.step, channel.start + first * channel.step, recorded=blow)
    return Blows((motion,), 0, tuple(warnings))
