"""A comparison in words, tables and pictures, for screen and report, and its report."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.clauses import (
    SHOWN,
    clause_columns,
    clause_words,
    held_words,
    verdict_sentence,
    verdict_tag,
    why_column,
)
from strikewave.analyses.compare.agreement import SpecificationVerdict
from strikewave.analyses.compare.limits import verdict_of
from strikewave.analyses.compare.result import TOGETHER, CompareResult, IsoScores
from strikewave.base.shock_quantities import KILOHERTZ, MICROSECONDS
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, columns_of, face_table, line_table
from strikewave.reporting.numbers import axis_unit, headed, time_unit
from strikewave.reporting.parts import Part, Picture, Section, Table
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    RED,
    WHOLE,
    legend_below,
    new_figure,
    one_diagram,
    plain,
    quiet,
    save,
    thin,
    titled,
)
from strikewave.signal.iso18571 import INNER, OUTER, RATE, SAMPLES, WEIGHTS
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Colours of the wide and the narrow corridor
SHADES = ("#DCE9F2", "#B9D5E8")
LONGEST = 60  # letters of a name in a legend
MARGIN = 0.15  # share of the interval that is drawn before and after it
SCORES = ("corridor", "phase", "magnitude", "slope", "overall")


def _shown(result: CompareResult) -> tuple[NDArray[np.bool_], Array, str]:
    """Return which samples are drawn, their times in the unit of the axis, and its label."""
    curves = result.agreement
    begin, end = curves.interval
    drawn = (curves.time >= begin - MARGIN * (end - begin)) & (curves.time <= end + MARGIN * (end - begin))
    size, unit = time_unit(float(np.ptp(curves.time[drawn])))
    return drawn, curves.time[drawn] / size, f"time of A ({unit})"


def draw_overlay(axes: Any, result: CompareResult) -> None:
    """Draw A with its corridor, and B on it."""
    curves = result.agreement
    drawn, time, label = _shown(result)
    size, _ = axis_unit(result.unit, result.usual)
    a, b = curves.a[drawn] / size, curves.b[drawn] / size
    judged = result.specified
    if judged is not None and judged.limits.band is not None:
        low, high = judged.limits.band.curves(curves.time[drawn] - judged.found.start)
        sign, words = result.a.sign / size, f"band of {judged.specification.asked}"
        axes.fill_between(time, sign * low, sign * high, color=SHADES[1], linewidth=0.0, label=words)
    elif curves.deviation is not None:
        of_a = result.a.deviation is not None
        mean, half = (a if of_a else b), result.factor * curves.deviation[drawn] / size
        words = f"mean of {(result.a if of_a else result.b).count} records ± {result.factor:g} standard deviations"
        axes.fill_between(time, mean - half, mean + half, color=SHADES[1], linewidth=0.0, label=words)
    else:
        largest = float(np.max(np.abs(a)))
        for share, shade in ((OUTER, SHADES[0]), (INNER, SHADES[1])):
            words = f"corridor of ISO/TS 18571, {100.0 * share:g} % of the peak"
            axes.fill_between(time, a - share * largest, a + share * largest, color=shade, linewidth=0.0, label=words)
    for name, values, colour, dash in (("A", a, BLUE, "-"), ("B", b, RED, "--")):
        curve = result.a if name == "A" else result.b
        axes.plot(*thin(time, values), dash, color=colour, linewidth=1.4, label=f"{name}: {plain(curve.name, LONGEST)}")
    second = time_unit(float(np.ptp(curves.time[drawn])))[0]
    for name, curve, pulse, colour in (("A", result.a, curves.pulse_a, BLUE), ("B", result.b, curves.pulse_b, RED)):
        band = curve.band.get("peak")
        if band is not None and np.isfinite(band.low + band.high):
            ends = np.array([band.low, band.high]) * curve.sign / size
            where, words = np.full(2, pulse.time / second), f"band of the peak of {name}"
            axes.plot(where, ends, "_-", color=colour, linewidth=1.0, markersize=12, label=words)
    for edge in curves.interval:
        if time[0] < edge / second < time[-1]:
            axes.axvline(edge / second, color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "B on A, shifted by " + ("nothing" if result.align == "none" else result.align), label, _axis(result))


def _axis(result: CompareResult) -> str:
    return headed(result.quantity, result.unit, result.usual) if result.unit else "value (the files' own)"


def draw_difference(axes: Any, result: CompareResult) -> None:
    """Draw B minus A."""
    curves = result.agreement
    drawn, time, label = _shown(result)
    size, _ = axis_unit(result.unit, result.usual)
    difference = (curves.b - curves.a)[drawn] / size
    if curves.deviation is not None:
        half = result.factor * curves.deviation[drawn] / size
        axes.fill_between(time, -half, half, color=SHADES[1], linewidth=0.0)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(*thin(time, difference), color=GREEN, linewidth=1.2)
    quiet(axes, "Difference, B minus A", label, _axis(result))
    axes.locator_params(axis="x", nbins=5)


def draw_ratio(axes: Any, result: CompareResult) -> None:
    """Draw the ratio of the shock response spectra."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    curves = result.agreement
    size, _ = axis_unit(*KILOHERTZ.units)
    axes.axhspan(-3.0, 3.0, color=SHADES[0], linewidth=0.0)
    axes.semilogx(curves.frequency / size, curves.ratio, color=BLUE, linewidth=1.3)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    quiet(axes, "Shock response spectra, B over A", headed("natural frequency", *KILOHERTZ.units), "ratio (dB)")
    largest = float(np.nanmax(np.abs(curves.ratio)))
    axes.set_ylim(-max(1.15 * largest, 4.0), max(1.15 * largest, 4.0))


def draw_scores(axes: Any, result: CompareResult) -> None:
    """Draw the scores of ISO/TS 18571 as bars, each with its number and weight."""
    rating = result.agreement.rating
    places = np.arange(len(SCORES))[::-1]
    values = [getattr(rating, name) for name in SCORES]
    axes.barh(places, values, color=[SHADES[1]] * 4 + [BLUE], height=0.6)
    for place, value in zip(places, values, strict=True):
        inside = value > 0.85
        axes.text(
            value - 0.02 if inside else value + 0.02,
            place,
            f"{value:.3f}",
            va="center",
            ha="right" if inside else "left",
            fontsize=9,
            color="white" if inside and place == 0 else "black",
        )
    labels = [f"{name}, {100.0 * w:g} %" for name, w in zip(SCORES, WEIGHTS, strict=False)] + [SCORES[-1]]
    axes.set_yticks(places, labels)
    quiet(axes, f"ISO/TS 18571: {rating.grade}", "score", "")
    axes.set_xlim(0.0, 1.0)


def overlay(result: CompareResult) -> Figure:
    """Return both histories over one another."""
    figure = new_figure((WHOLE[0], 4.2))
    draw_overlay(figure.add_subplot(), result)
    return legend_below(figure)


def half_figures(result: CompareResult) -> list[tuple[Figure, str]]:
    """Return difference, ratio of spectra and scores, each with its caption."""
    pictures = [(one_diagram(lambda axes: draw_difference(axes, result), HALF), "What B has more than A.")]
    if result.agreement.frequency.size:
        words = "Largest responses of oscillators of 5 % damping (Q = 10) to B, over those to A; shaded: ± 3 dB."
        pictures.append((one_diagram(lambda axes: draw_ratio(axes, result), HALF), words))
    words = "Scores of ISO/TS 18571 over the interval between the dotted lines, with their weights."
    pictures.append((one_diagram(lambda axes: draw_scores(axes, result), HALF), words))
    return pictures


def summary_figure(result: CompareResult) -> Figure:
    """Return the diagrams on one sheet; the scores where there is no ratio of spectra."""
    figure = new_figure((WHOLE[0], 7.4))
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1.0))
    draw_overlay(figure.add_subplot(grid[0, :]), result)
    draw_difference(figure.add_subplot(grid[1, 0]), result)
    (draw_ratio if result.agreement.frequency.size else draw_scores)(figure.add_subplot(grid[1, 1]), result)
    return titled(legend_below(figure), result.title)


SIDES = "A is the reference; the shift is added to the times of B."


def compare_words(result: CompareResult) -> str:
    """Say in words how well the two agree."""
    curves, rating = result.agreement, result.agreement.rating
    peak, width = result.figures["peak"], result.figures["width"]
    words = [
        f"{result.b.name} agrees with {result.a.name} to {rating.overall:.2f} of 1 by ISO/TS 18571 ({rating.grade}):"
    ]
    parts = [f"peak {percent(peak.difference, 1, '+')}"]
    if math.isfinite(width.difference):
        parts.append(f"pulse width at 10 % {percent(width.difference, 1, '+')}")
    parts.append(f"RMS difference {percent(curves.rms)}")
    words[0] += f" {', '.join(parts)}."
    words.append("Not aligned." if result.align == "none" else f"B is shifted by {result.shift_words}.")
    if curves.deviation is not None:
        words.append(
            f"{percent(curves.inside(result.factor), 0)} of the interval lies within the corridor of "
            f"± {result.factor:g} standard deviations."
        )
    if result.judged:
        count = sum(one.verdict == PASS for one in result.judged)
        words.insert(0, f"{SHOWN[verdict_of(result.judged) or PASS]}: {count} of {len(result.judged)} limits kept.")
    if result.specified is not None:
        words.insert(0, specification_words(result.specified))
    if result.verdicts.words:
        words.insert(0, result.verdicts.sentence)
    return " ".join(words)


def specification_words(judged: SpecificationVerdict) -> str:
    """Say what a specification comes to, and why."""
    by = f" by {judged.specification.title} ({judged.specification.file.edition})."
    words = [verdict_sentence(judged.verdict, judged.by_indicative, judged.found.clauses, by)]
    words += [f"{clause_words(clause)}." for clause in judged.found.clauses if clause.verdict in (FAIL, CANNOT_TELL)]
    return " ".join(words)


def clause_table(judged: SpecificationVerdict) -> Table:
    """Return the clauses of a specification with what came out."""
    clauses = judged.found.clauses
    return page_table(f"By {judged.specification.title}", [*clause_columns(clauses), why_column(clauses)])


def budget_words(result: CompareResult) -> str:
    """Say what the uncertainties of A and B are, and hold."""
    assert result.budget is not None
    words = "± of A and B is the expanded uncertainty U, that of the difference its standard uncertainty. "
    return words + held_words(result.budget.names, result.budget.not_stated)


def agreement_tables(result: CompareResult) -> list[Table]:
    """Return figures of both, what is measured of both together, and the scores of ISO/TS 18571."""
    together = line_table(result, TOGETHER, "Agreement", "of both together", result.given_units)
    scores = page_table("ISO/TS 18571", columns_of(IsoScores, [result.metrics.iso18571]))
    return [face_table(result, "pairs"), together, scores]


def scaling_words(result: CompareResult) -> str:
    """Say how time was scaled for ISO/TS 18571."""
    begin, end = result.agreement.interval
    return (
        f"The standard is made for signals sampled at {RATE / 1e3:g} kHz: the interval of "
        f"{amount(MICROSECONDS, end - begin)} is taken as {SAMPLES} such samples, time stretched "
        f"{result.metrics.iso18571.stretched:.3g} times. Its phase score is what the alignment leaves."
    )


def compare_report(result: CompareResult) -> str:
    """Return the report of a comparison as one HTML page: no script, nothing fetched, the same bytes."""
    pictures: list[Part] = [
        Picture(
            overlay(result),
            "Both histories over one another. The dotted lines are the ends of the interval in which they are judged.",
        )
    ]
    pictures += [Picture(figure, words) for figure, words in half_figures(result)]
    *tables, scores = agreement_tables(result)
    sections = [
        *([_specification(result.specified)] if result.specified is not None else []),
        *([Section("Limits", "", [face_table(result, "judged")])] if result.judged else []),
        Section("Comparison", "", pictures),
        Section("Figures", "" if result.budget is None else budget_words(result), tables),
        *([Section("Band", "", [face_table(result, "in_bands")])] if result.in_bands else []),
        Section("Scores", scaling_words(result), [scores]),
        Section(
            "What is compared",
            "A is the reference; the shift is added to the times of B.",
            [face_table(result, "sides")],
        ),
        chapters.warnings(result.notices),
    ]
    by_indicative = result.specified is not None and result.specified.by_indicative
    tag = None
    if result.verdict is not None:
        clauses = () if result.specified is None else result.specified.found.clauses
        tag = verdict_tag(result.verdict, by_indicative, clauses)
    summary = chapters.Summary("Report of a comparison", compare_words(result), result.highlights(), tag)
    return chapters.result_page(result, summary, sections)


def _specification(judged: SpecificationVerdict) -> Section:
    """Show what a specification comes to."""
    words = (
        f"{judged.decision} The status of a limit is normative (read in the standard), quoted (second-hand) or "
        "indicative (from memory)."
    )
    if judged.limits.band is not None:
        words += " The band lies where the smallest distance of A to it is largest."
    words += f" Source: {judged.specification.file.source}."
    return Section("Verdict by the specification", words, [clause_table(judged)])


# Picture and page of a result in Python, see `strikewave.reporting.shown_result`
picture, page = summary_figure, compare_report


def draw_result(result: CompareResult, folder: Path) -> list[str]:
    """Write page and summary of a comparison into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(summary_figure(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(compare_report(result), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
