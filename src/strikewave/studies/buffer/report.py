"""The report of a buffer design: what the sensor reads on each stack of gaskets, and what the stack passes."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.base.materials import material
from strikewave.reporting import chapters
from strikewave.reporting.numbers import headed, hertz, percent, shown, with_unit
from strikewave.reporting.parts import Cell, Part, Picture, Section, Table, Tag, written
from strikewave.reporting.table_columns import page_table
from strikewave.sensors.mounting import RESOLVED
from strikewave.studies.buffer.candidate import ALIKE, BufferCandidate, distinct
from strikewave.studies.buffer.columns import MODULI_COLUMNS, RANK_COLUMNS, RankedStack, needed
from strikewave.studies.buffer.figures import buffer_histories, buffer_transmissibility, peak_bandwidth
from strikewave.studies.buffer.moduli import spread
from strikewave.studies.buffer.result import BufferStudy

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
    summary = chapters.Summary("Report of a buffer design", buffer_words(study), _key_numbers(study), status)
    return chapters.result_page(study, summary, sections)


def buffer_words(study: BufferStudy) -> str:
    """Say in words what the stacks do to the reading."""
    within = sum(candidate.keeps for candidate in study.candidates)
    first, limit = study.candidates[0], with_unit(study.goal.limit, "m/s^2", "g")
    words = [
        f"{within} of {len(study.candidates)} stacks keep the reading of {study.motion.name} within {limit}; directly "
        f"on the surface {study.site.table.name} would read {_peak(study.direct)}.",
        f"{study.order[0].upper()}{study.order[1:]}: {first.name}, {_peak(first)}, amplitudes within 10 % up to "
        f"{_bandwidth(first.band.within_10)}.",
    ]
    if study.verdicts.words:
        words.insert(0, f"{study.verdicts.sentence[:-1]}: the blow is that of this run.")
    if study.robust is None:
        words.append("No stack is known to keep the limit whatever the moduli of its gaskets.")
    elif study.robust is not first:
        words.append(f"Whatever the moduli of its gaskets, {study.robust.name} keeps it, with {_peak(study.robust)}.")
    words.append("The motion of the surface is given: the back-effect of the sensor on the structure is not modelled.")
    return " ".join(words)


def _bandwidth(within_10: float) -> str:
    """Return the frequency, Hz, up to which amplitudes pass; it is sought up to `RESOLVED`."""
    return hertz(within_10) if math.isfinite(within_10) else f"{hertz(RESOLVED)} and beyond"


def _key_numbers(study: BufferStudy) -> list[tuple[str, str]]:
    first = study.candidates[0]
    return [
        ("stacks that keep the limit", f"{sum(one.keeps for one in study.candidates)} of {len(study.candidates)}"),
        (f"reading on the first; limit {with_unit(study.goal.limit, 'm/s^2', 'g')}", _peak(first)),
        ("reading without gaskets", _peak(study.direct)),
        ("amplitude within 10 % up to, first", _bandwidth(first.band.within_10)),
        ("resonance of the first", hertz(first.band.resonance)),
        ("height of the first", with_unit(first.height, "m", "mm", 3)),
    ]


def _peak(candidate: BufferCandidate) -> str:
    return with_unit(candidate.true_peak, "m/s^2", "g") + (" (cut off)" if candidate.clipped else "")


def _ranking_section(study: BufferStudy) -> Section:
    """List the first distinct stacks, the robust and the direct one, and the buffer that the case has now."""
    listing = distinct(study.candidates, MOST_ROWS)
    listing += [one for one in (study.robust, study.direct) if one is not None and one not in listing]
    places = {candidate: place for place, candidate in enumerate(study.candidates, 1)}
    rows = [RankedStack(str(places[one]), one) for one in sorted(listing, key=places.__getitem__)]
    rows += [] if study.present is None else [RankedStack("", study.present)]
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
        page_table("Stacks by rank", needed(RANK_COLUMNS, rows), rows),
        page_table(moduli, MODULI_COLUMNS, [row for row in rows if row.leading is not None]),
    ]
    return Section("Stacks", text, tables)


def _gasket_section(study: BufferStudy, first: BufferCandidate) -> Section:
    """List the gaskets of the first stack: what they bear, and what is known of their material."""
    leading = first.leading
    rows: list[Sequence[Cell]] = []
    for k, layer in enumerate(first.stack):
        row = material(layer.material)
        low, high = spread(row)
        bears = (leading.stress[k], leading.strain[k]) if leading else (math.nan, math.nan)
        rows.append(
            [
                layer.material,
                str(layer.thickness.typed),
                written(shown(bears[0], "Pa", "MPa"), 3),
                written(100.0 * bears[1], 3),
                f"{low:g} to {high:g}",
                row.source,
            ]
        )
    heads = ["material", "thickness", headed("largest stress", "Pa", "MPa"), "strain (%)", "modulus, times", "source"]
    text = (
        f"From the surface up. The stack is {with_unit(first.height, 'm', 'mm', 3)} high and sags by "
        f"{with_unit(first.sag, 'm', 'um', 3)} under its load; loss factors are held within "
        f"{percent(first.loss_error)} from 1 to 100 kHz."
    )
    return Section("Gaskets of the first stack", text, [Table("Gaskets", heads, rows)])


def _sensor_section(study: BufferStudy) -> Section:
    """List sensor, footprint and blow."""
    site, motion, sensor = study.site, study.motion, study.site.channel.sensor
    rate = site.channel.recorder.sampling_rate
    rows: list[list[Cell]] = [
        ["sensor", site.table.name + (f", {site.table.model}" if site.table.model else "")],
        ["mass", with_unit(site.mass, "kg", "gram")],
        ["area of the gaskets", with_unit(site.area, "m^2", "mm^2")],
        ["resonance of the element", hertz(sensor.resonance)],
        ["range", with_unit(sensor.range, "m/s^2", "g") if math.isfinite(sensor.range) else "none stated"],
        ["sampling rate", "ideal recorder" if rate is None else hertz(rate)],
        ["blow", motion.name],
        ["peak of the surface", with_unit(motion.peak, "m/s^2", "g")],
        ["velocity change of the surface", with_unit(motion.surface_change, "m/s", "m/s", 3)],
    ]
    if motion.recorded is not None:
        sample = with_unit(motion.largest_sample, "m/s^2", "g")
        rows.insert(-1, ["largest sample, with the noise that readings have too", sample])
    if motion.rigid_peak is not None:
        rows.append(["rigid-body peak", with_unit(motion.rigid_peak, "m/s^2", "g")])
    parts: list[Part] = [Table("Sensor and blow", ["", "value"], rows)]
    return Section("Sensor and blow", "", parts)
