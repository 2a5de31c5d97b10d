"""The report of a buffer design: what the sensor reads on each stack of gaskets, and what the stack passes."""

from __future__ import annotations

import math

from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import columns_of, part_tables, text_of
from strikewave.reporting.parts import Picture, Section, Tag
from strikewave.studies.buffer.candidate import ALIKE, BufferCandidate, StackGasket, distinct
from strikewave.studies.buffer.figures import buffer_histories, buffer_transmissibility, peak_bandwidth
from strikewave.studies.buffer.result import MARKED, BufferStudy, stack_columns

MOST_ROWS = 20
"""Stacks in the table: the first that differ; buffers.csv has all."""


def buffer_report(study: BufferStudy) -> str:
    """Return the report of a buffer design as one HTML page: no script, nothing fetched, the same bytes each time."""
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
    words = [
        f"{study.keeping} stacks keep the reading of {study.motion.name} within {limit}; directly "
        f"on the surface {study.site.table.name} would read {_peak(study.direct)}.",
        f"{study.order[0].upper()}{study.order[1:]}: {first.name}, {_peak(first)}, amplitudes within 10 % up to "
        f"{study.bandwidth}.",
    ]
    if study.verdicts.words:
        words.insert(0, f"{study.verdicts.sentence[:-1]}: the blow is that of this run.")
    if study.robust is None:
        words.append("No stack is known to keep the limit whatever the moduli of its gaskets.")
    elif study.robust is not first:
        words.append(f"Whatever the moduli of its gaskets, {study.robust.name} keeps it, with {_peak(study.robust)}.")
    words.append("The motion of the surface is given: the back-effect of the sensor on the structure is not modelled.")
    return " ".join(words)


def _peak(candidate: BufferCandidate) -> str:
    return text_of(candidate, "true_peak") + (" (cut off)" if candidate.clipped else "")


def _ranking_section(study: BufferStudy) -> Section:
    """List the first distinct stacks, the robust and the direct one, and the buffer that the case has now."""
    listing = distinct(study.candidates, MOST_ROWS)
    listing += [one for one in (study.robust, study.direct) if one is not None and one not in listing]
    rows = [one for one in study.stacks if one in listing or one is study.present]
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
        page_table(moduli, stack_columns("moduli", [one for one in rows if one.stack and one.leading])),
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
    words = [f"The sensor is a {site.table.model}."] if site.table.model else []
    words += [] if math.isfinite(site.channel.sensor.range) else ["The sensor has no stated range."]
    words += [] if math.isfinite(site.channel.recorder.sampling_rate) else ["Its recorder is ideal."]
    if motion.recorded is not None:
        words.append(
            f"The largest sample, with the noise that readings have too, is {text_of(motion, 'largest_sample')}."
        )
    return Section("Sensor and blow", " ".join(words), [*part_tables(study, "sensor"), *part_tables(study, "motion")])


picture = peak_bandwidth
page = buffer_report
"""Page of a result in Python, found as `picture` is by `strikewave.reporting.shown_result`."""
