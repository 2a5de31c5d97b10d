"""Picture and page of a synthesized motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.analyses.clauses import tag_of, verdict_words
from strikewave.analyses.record.figures.verdicts import draw_spectrum_limits
from strikewave.analyses.record.specification.synthesis import SynthesisResult, synthesis_words
from strikewave.analyses.record.verdicts import spectra_section
from strikewave.base.declare import declarations
from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.parts import Picture, Section, Tag
from strikewave.reporting.style import BLUE, new_figure, plain, put_below, quiet, thin, titled
from strikewave.signal.synthesis import MotionPeaks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (10.0, 5.6)
POINTS = 600  # points of a history in the picture


def picture(result: SynthesisResult) -> Figure:
    """Draw acceleration, velocity and displacement over time, and the spectrum in its tolerance."""
    import numpy as np

    figure = new_figure(SIZE)
    grid = figure.add_gridspec(3, 2, width_ratios=(1.1, 1.0))
    found = result.motion
    time = np.asarray(found.step * np.arange(found.acceleration.size), dtype=np.float64)
    size, clock = time_unit(float(time[-1]))
    first = None
    for row, (name, one) in enumerate(declarations(MotionPeaks).items()):
        axes = figure.add_subplot(grid[row, 0], sharex=first)
        first = first or axes
        scale, unit = axis_unit(one.quantity.si, one.quantity.usual)
        x, y = thin(time, getattr(found, name), POINTS)
        axes.plot(x / size, y / scale, color=BLUE, linewidth=0.9)
        quiet(axes, "", f"time ({clock})" if row == 2 else "", f"{name} ({unit})")
        if row < 2:
            axes.tick_params(labelbottom=False)
    axes = figure.add_subplot(grid[:, 1])
    (judged,) = result.verdict.spectra
    drawn = [("spectrum", judged.frequency, judged.values, judged.verdict)]
    draw_spectrum_limits(axes, result.verdict.limits, drawn, "")
    put_below(figure, *axes.get_legend_handles_labels())
    return titled(figure, plain(result.title, 90))


def page(result: SynthesisResult) -> str:
    """Return the page of a synthesis: the motion, the verdict, the components."""
    caption = "Left, the motion: it begins and ends at rest. Right, its spectrum within the tolerance."
    if result.half_sine is not None:
        caption = "Left, the pulse, which leaves a velocity. Right, its spectrum and the tolerance."
    sections = [
        Section("The motion", "", [Picture(picture(result), caption, caption)]),
        spectra_section(result.verdict),
    ]
    if result.components:
        text = (
            "A damped sine is A exp(−ζ ω (t − t₀)) sin(ω (t − t₀)); a wavelet A sin(ω (t − t₀)/N) sin(ω (t − t₀)) over "
            "N half-sines. The compensating pulses bring velocity and displacement at the end to zero. Damped sines "
            "are faded out over the last fifth. acceleration.csv has the history, after some rest."
        )
        sections.append(Section("Components", text, [face_table(result, "components")]))
    sections.append(chapters.warnings(result.notices))
    verdict = result.verdict
    tag = Tag(verdict_words(verdict.verdict, verdict.by_indicative), tag_of(verdict.verdict).look)
    summary = chapters.Summary("Synthesis of a shock", synthesis_words(result), result.highlights(), tag)
    return chapters.result_page(result, summary, sections)
