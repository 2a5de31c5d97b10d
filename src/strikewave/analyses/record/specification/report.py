"""Page and picture of a specification."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.analyses.record.figures.verdicts import limits_figure, spectrum_limits_figure
from strikewave.analyses.record.specification.result import SpecificationResult, specification_words
from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table
from strikewave.reporting.parts import Part, Picture, Section, Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def picture(result: SpecificationResult) -> Figure | None:
    """Return the band, or the ideal pulse, or the tolerance of a spectrum; nothing where there are no breakpoints."""
    specification = result.specification
    if specification.file.pulse is not None:
        return limits_figure(specification.pulse_limits(), result.title)
    table = specification.file.srs
    if table is None or not table.points:
        return None
    return spectrum_limits_figure(specification.spectrum_limits(), [], result.title)


def page(result: SpecificationResult) -> str:
    """Return the page of a specification: its picture, what it asks, its numbers with status and source."""
    file = result.specification.file
    figure = picture(result)
    parts: list[Part] = []
    if figure is not None:
        words = "The ideal pulse and the band about it." if file.band is not None else "What it asks."
        parts.append(Picture(figure, words))
    tables = [
        face_table(result, "asked"),
        face_table(result, "demands", caption="Asked too, and not judged by a record"),
    ]
    parts += [table for table in tables if table.rows]
    numbers = face_table(result, "numbers", caption="All numbers")
    sections = [Section("Specification", "", parts), Section("Numbers", "", [numbers])]
    worst = "indicative" if any(row.status == "indicative" for row in result.numbers) else file.status
    tag = Tag(f"{worst} numbers" if worst == "indicative" else worst, worst)
    summary = chapters.Summary("Specification", specification_words(result), result.highlights(), tag)
    return chapters.result_page(result, summary, sections)


def draw_specification(result: SpecificationResult, folder: Path) -> list[str]:
    """Write page and picture of a specification into a folder, and return their names."""
    names = ["report.html"]
    with drawing(folder / "report.html") as path:
        path.write_text(page(result), "utf-8", newline="\n")
    figure = picture(result)
    if figure is not None:
        with drawing(folder / "summary.svg") as path:
            save(figure, path)
        names.append("summary.svg")
    return names
