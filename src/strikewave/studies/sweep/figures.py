"""Pictures of a sweep: a line over one setting, a map over two, parallel coordinates and main effects over more.

Every run is drawn: none is left out of a mean without its dot, and runs that failed are marked where they stand.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.result import RUN_BROKEN
from strikewave.reporting.numbers import share_with_error
from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, legend_below, mark_runs, quiet, sheet_title
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.engine.case_evaluation import KeptNumber
from strikewave.studies.engine.plan import GRID, StudyVariable
from strikewave.studies.sweep.study import SweepStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MOST_NUMBERS = 4
"""Numbers that are drawn, the first ones: a page holds no more rows; the table has all."""
MOST_SETTINGS = 6
"""Settings that are drawn, those with the largest shares: more columns are too narrow to be read."""
MOST_LINES = 2000
"""Lines of parallel coordinates, evenly spread over the runs: more are one area of one colour."""
WIDTH, ROW, EFFECT_ROW = 9.0, 3.1, 2.5
"""Width of a picture, and heights of a row of axes and of one of main effects, inches."""
MOST_TICKS = 8
"""Words of an axis that are written out."""
FAILED_AT = 0.03
"""Height of the marks of failed runs above the lower edge, as a share of the axes."""


def picture(study: SweepStudy) -> Figure:
    """Draw a sweep over its settings."""
    count = len(study.plan.variables)
    if count == 1:
        return _lines(study)
    if count == 2 and study.plan.design != GRID:
        return _maps(study, _dots)
    return _maps(study, _cells) if count == 2 else _many(study)


def shown_number(study: SweepStudy, number: KeptNumber) -> Array:
    """Return a number of each run in the unit in which it is shown."""
    return np.asarray(study.number(number.name) / number.scale)


def _figure(study: SweepStudy, rows: int, columns: int, height: float) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height * rows + 0.7), layout="constrained")
    sheet_title(figure, f"{study.case.name or 'case'}: {len(study.failures)} runs, {study.plan.design}")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _drawn_numbers(study: SweepStudy) -> tuple[KeptNumber, ...]:
    return study.plan.kept[:MOST_NUMBERS]


def _lines(study: SweepStudy) -> Figure:
    """Draw each number over the one setting: its runs as dots on a line, and failed ones as marks at the foot."""
    numbers = _drawn_numbers(study)
    figure, axes = _figure(study, len(numbers), 1, ROW)
    variable, x = study.plan.variables[0], _setting(study, 0)
    order = np.argsort(x, kind="stable")
    line = "" if variable.words else "-"
    for drawn, number in zip(axes[:, 0], numbers, strict=True):
        values = shown_number(study, number)
        drawn.plot(x[order], values[order], line, marker="o", color=BLUE, markersize=3.5, linewidth=1.4, zorder=3)
        mark_runs(drawn, x, values, study.verdicts)
        _mark_failures(drawn, study, x)
        quiet(drawn, _extent(study, number), variable.label, number.label)
        _along(drawn.xaxis, drawn.set_xscale, variable)
        drawn.margins(x=0.02, y=0.08)
    return legend_below(figure)


def _mark_failures(axes: Any, study: SweepStudy, x: Array) -> None:
    """Mark at the foot where runs failed."""
    failed = np.array([bool(failure) for failure in study.failures])
    if failed.any():
        place = axes.get_xaxis_transform()
        at = np.full(failed.sum(), FAILED_AT)
        axes.plot(x[failed], at, "x", color=RED, transform=place, label="run failed", clip_on=False)


def _extent(study: SweepStudy, number: KeptNumber) -> str:
    """Return between what a number lies."""
    return study.range_of(number).extent or "no run has it"


def _setting(study: SweepStudy, k: int) -> Array:
    """Return a setting of each run in the unit in which it is shown; of words their places."""
    variable = study.plan.variables[k]
    values = study.settings[:, k]
    return values if variable.words else np.asarray(variable.axis.shown(values))


def _along(axis: Any, scale: Any, variable: StudyVariable) -> None:
    """Write words, or plain numbers on a logarithmic axis."""
    if variable.words:
        places = range(len(variable.words))[:: len(variable.words) // MOST_TICKS + 1]
        axis.set_ticks(list(places), [variable.words[k] for k in places], fontsize=8)
    elif variable.axis.log:
        scale("log")
        plain_log_ticks(axis)


def _maps(study: SweepStudy, draw: Any) -> Figure:
    """Draw each number in colour over two settings."""
    numbers = _drawn_numbers(study)
    columns = min(len(numbers), 2)
    rows = -(-len(numbers) // columns)
    figure, axes = _figure(study, rows, columns, ROW + 0.4)
    first, second = study.plan.variables
    for drawn, number in zip(axes.flat, numbers, strict=False):
        drawn.set_facecolor("#D9D9D9")
        coloured = draw(drawn, study, shown_number(study, number))
        figure.colorbar(coloured, ax=drawn, pad=0.02).set_label(number.label, fontsize=8)
        quiet(drawn, _extent(study, number), first.label, second.label)
        drawn.grid(False)
        _along(drawn.xaxis, drawn.set_xscale, first)
        _along(drawn.yaxis, drawn.set_yscale, second)
        mark_runs(drawn, _setting(study, 0), _setting(study, 1), study.verdicts, size=4.0)
    for drawn in list(axes.flat)[len(numbers) :]:
        drawn.set_axis_off()
    return legend_below(figure)


def _cells(axes: Any, study: SweepStudy, values: Array) -> Any:
    """Draw a grid as cells; those without a number stay grey."""
    x, y = (np.unique(_setting(study, k)) for k in (0, 1))
    drawn = axes.pcolormesh(
        x, y, np.ma.masked_invalid(values.reshape(y.size, x.size)), cmap="cividis", shading="nearest"
    )
    drawn.set_rasterized(True)
    return drawn


def _dots(axes: Any, study: SweepStudy, values: Array) -> Any:
    """Draw runs as dots."""
    return axes.scatter(_setting(study, 0), _setting(study, 1), c=values, cmap="cividis", s=22, zorder=3)


def _many(study: SweepStudy) -> Figure:
    """Draw parallel coordinates, coloured by the first number, and below them the main effects on each number."""
    numbers, chosen = _drawn_numbers(study), drawn_settings(study)
    from matplotlib.figure import Figure

    heights = [ROW + 0.5, *([EFFECT_ROW] * len(numbers))]
    figure = Figure(figsize=(WIDTH, sum(heights) + 0.7), layout="constrained")
    sheet_title(figure, f"{study.case.name or 'case'}: {len(study.failures)} runs, {study.plan.design}")
    parts: Any = figure.subfigures(len(heights), 1, height_ratios=heights)
    _parallel(figure, parts[0], study, chosen, numbers[0])
    for part, number in zip(parts[1:], numbers, strict=True):
        axes = part.subplots(1, len(chosen), squeeze=False, sharey=True)[0]
        for place, (drawn, k) in enumerate(zip(axes, chosen, strict=True)):
            _effect(drawn, study, k, number, place == 0)
    return figure


def drawn_settings(study: SweepStudy) -> list[int]:
    """Return which settings are drawn: all, or those with the largest share in the first number, in their order."""
    count = len(study.plan.variables)
    if count <= MOST_SETTINGS:
        return list(range(count))
    effects = study.effects[study.plan.evaluation.names[0]]
    shares = np.nan_to_num([effects[variable.path].share for variable in study.plan.variables], nan=-1.0)
    return sorted(np.argsort(-shares, kind="stable")[:MOST_SETTINGS].tolist())


def _parallel(figure: Figure, part: Any, study: SweepStudy, chosen: list[int], number: KeptNumber) -> None:
    """Draw a line a run through all settings to its number."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import LineCollection
    from matplotlib.colors import Normalize

    axes = part.subplots()
    values = shown_number(study, number)
    known = np.flatnonzero(np.isfinite(values))
    columns = [*(_setting(study, k) for k in chosen), values]
    scaled = np.column_stack([_to_one(column) for column in columns])
    places = np.arange(len(columns))
    drawn_runs = known[:: max(1, -(-known.size // MOST_LINES))]
    norm = Normalize(*((float(values[known].min()), float(values[known].max())) if known.size else (0.0, 1.0)))
    lines = [np.column_stack([places, scaled[run]]) for run in drawn_runs]
    drawn = LineCollection(lines, array=values[drawn_runs], cmap="cividis", norm=norm, linewidths=0.9, alpha=0.7)
    drawn.set_rasterized(True)
    axes.add_collection(drawn)
    failed = np.flatnonzero([bool(failure) for failure in study.failures])
    if failed.size:
        lost = [np.column_stack([places[:-1], scaled[run, :-1]]) for run in failed[:MOST_LINES]]
        axes.add_collection(LineCollection(lost, colors=RED, linewidths=0.9, linestyles="dashed"))
    broken = [run for run in drawn_runs if study.verdicts.statuses[run] == RUN_BROKEN]
    if broken:
        axes.add_collection(
            LineCollection([np.column_stack([places, scaled[run]]) for run in broken], colors=RED, linewidths=0.9)
        )
    note = f" ({drawn_runs.size} of {known.size} runs drawn)" if drawn_runs.size < known.size else ""
    note += "; red, and diamonds below: failed a check" if broken else ""
    note += "; dashed: failed" if failed.size else ""
    quiet(axes, f"Runs through their settings{note}", "", "")
    axes.grid(False)
    axes.set(xlim=(-0.15, places[-1] + 0.15), ylim=(-0.04, 1.04), yticks=[])
    axes.spines["left"].set_visible(False)
    labels = [*(_ends(study, k) for k in chosen), _range_words(number.label, values)]
    axes.set_xticks(places, labels, fontsize=8)
    for place in places:
        axes.axvline(place, color=GREY, linewidth=0.8, zorder=1)
    figure.colorbar(ScalarMappable(norm, "cividis"), ax=axes, pad=0.02).set_label(number.label, fontsize=8)


def _to_one(values: Array) -> Array:
    """Return values from 0 at the smallest to 1 at the largest."""
    low, high = np.nanmin(values, initial=np.inf), np.nanmax(values, initial=-np.inf)
    return np.full(values.shape, 0.5) if not low < high else (values - low) / (high - low)


def _ends(study: SweepStudy, k: int) -> str:
    variable = study.plan.variables[k]
    if variable.words:
        return f"{variable.path}\n{variable.words[0]} to {variable.words[-1]}"
    return _range_words(variable.label, _setting(study, k))


def _range_words(label: str, values: Array) -> str:
    known = values[np.isfinite(values)]
    ends = f"{known.min():.4g} to {known.max():.4g}" if known.size else "none"
    return f"{label}\n{ends}".replace(" of the ", "\nof the ", 1)


def _effect(axes: Any, study: SweepStudy, k: int, number: KeptNumber, first: bool) -> None:
    """Draw all runs over one setting, and the means of its groups."""
    variable = study.plan.variables[k]
    effect = study.effects[number.name][variable.path]
    x = effect.places if variable.words else variable.axis.shown(effect.places)
    dots = axes.plot(_setting(study, k), shown_number(study, number), ".", color=GREY, markersize=3, alpha=0.35)[0]
    dots.set_rasterized(True)
    mark_runs(axes, _setting(study, k), shown_number(study, number), study.verdicts, size=3.5)
    axes.plot(x, effect.means / number.scale, "o-", color=ORANGE, markersize=4, linewidth=1.8)
    chance = 100.0 * study.chance(effect)
    share = share_with_error(effect.share, effect.standard_error)
    title = "no variance" if np.isnan(effect.share) else f"share {share}"
    title += f" (chance: {chance:.0f} %)" if chance else ""
    quiet(axes, title, variable.label.replace(" of the ", "\nof the "), number.label if first else "")
    axes.xaxis.label.set_fontsize(8)
    axes.yaxis.label.set_fontsize(8)
    axes.margins(x=0.06, y=0.06)
    _along(axes.xaxis, axes.set_xscale, variable)
