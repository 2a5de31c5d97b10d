"""Picture of designs of a drop table: the pulse of the first in its band, and what each design takes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.record.verdicts.figures import draw_shock
from strikewave.base.result import Verdicts
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    legend_below,
    mark_runs,
    new_figure,
    plain,
    quiet,
    titled,
)
from strikewave.studies.settings.drop_table.candidate import DropCandidate
from strikewave.studies.settings.drop_table.study import DropStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (10.0, 4.6)
MARKERS = (("o", BLUE), ("s", ORANGE), ("^", GREEN), ("D", RED), ("v", "#CC79A7"), ("P", "#56B4E9"), ("X", GREY))


def drop_figure(study: DropStudy) -> Figure:
    """Draw the pulse of the first design in its band, and the rise of each pulse over the drop height."""
    figure = new_figure(SIZE)
    left, right = figure.subplots(1, 2)
    first = study.candidates[0]
    draw_shock(left, first.reading.shock, first.verdict, study.goal.limits, first.programmer.name, "full run")
    _designs(right, study)
    legend_below(figure)
    return titled(figure, plain(f"Drop table. {study.title}", 90))


def _designs(axes: Any, study: DropStudy) -> None:
    """Draw drop height and share of the pulse in which it rises, of each design; filled where it meets the goal."""
    names = list(dict.fromkeys(one.programmer.name for one in study.candidates))
    for k, name in enumerate(names):
        marker, colour = MARKERS[k % len(MARKERS)]
        mine = [one for one in study.candidates if one.programmer.name == name]
        for met, fill in ((True, colour), (False, "none")):
            points = [one for one in mine if one.meets == met]
            if points:
                axes.plot(*_places(points), marker, color=colour, markerfacecolor=fill, markersize=6)
        axes.plot([], [], marker, color=colour, markersize=6, label=plain(name, 30))
    axes.plot([], [], "o", color=GREY, fillstyle="none", markersize=6, label="does not meet it")
    mark_runs(axes, *_places(study.candidates), Verdicts(one.run_verdict for one in study.candidates))
    sine = (np.arcsin(0.9) - np.arcsin(0.1)) / (np.pi - 2.0 * np.arcsin(0.1))
    axes.axhline(100.0 * sine, color=GREY, linewidth=1.0, linestyle="--", label="half-sine")
    quiet(axes, "Designs", headed("drop height", "m", "mm"), "rise time over pulse width (%)")
    axes.margins(0.08)


def _places(candidates: Sequence[DropCandidate]) -> tuple[list[float], list[float]]:
    """Return drop heights as shown, and rise times over widths in %."""
    metre, _ = axis_unit("m", "mm")
    return (
        [one.height / metre for one in candidates],
        [100.0 * one.reading.blow.rise / one.reading.width for one in candidates],
    )
