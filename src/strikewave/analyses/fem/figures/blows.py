"""Several blows of the same bodies, one over the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from strikewave.fem.measures import contact_measure, mean_force, middles
from strikewave.fem.run import FemRun
from strikewave.reporting.curves import shortened, thin
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, WHOLE, empty_axes, new_figure, quiet

MARGIN = 0.1
"""Share of the contact time that is shown before and after it (chosen: start and end are seen, the pulse fills the
picture)."""
MOST_LABELS = 5
"""Of more blows only the first two and the last one are in the legend (chosen: it stays in the upper right corner)."""
MOST_TICKS = 10
"""Of more blows not each is a tick (chosen: numbers of three digits stay apart in a third of the width of a page)."""


def blows_figure(runs: Sequence[FemRun]) -> Figure:
    """Draw the force of the strongest contact, mean of each interval, of all blows, beside the yield of each blow.

    The first blow is red and the last one blue; those between go from light to dark grey.
    """
    figure = new_figure(WHOLE)
    left, right = figure.subplots(1, 2, width_ratios=(1.9, 1.0))
    _draw_forces(left, runs)
    _draw_yield(right, runs)
    return figure


def _draw_forces(axes: Any, runs: Sequence[FemRun]) -> None:
    names = {name: peak for name in runs[0].force if (peak := _peak(runs, name)) > 0.0}
    if not names:
        empty_axes(axes, "", "nothing touched")
        return
    name = max(names, key=lambda each: names[each])
    (second, _), (newton, _) = axis_unit("s", "us"), axis_unit("N", "kN")
    for k, run in enumerate(runs):
        force = np.linalg.norm(mean_force(run, name), axis=1) / newton
        colour, dash = _look(k, len(runs))
        label = f"blow {run.blow}" if k in (0, 1, len(runs) - 1) or len(runs) <= MOST_LABELS else None
        axes.plot(*thin(middles(run.time) / second, force), dash, color=colour, linewidth=1.4, label=label)
    since, label = headed("time of each blow", "s", "us"), headed("mean force of intervals", "N", "kN")
    quiet(axes, "Contact force, blow after blow", since, label)
    axes.set_title(axes.get_title(loc="left") + f": {shortened(name, 34)}", loc="left", fontsize=10, parse_math=False)
    touches = [touch for run in runs if (touch := contact_measure(run, name)) is not None]
    first, last = min(touch.begin for touch in touches) / second, max(touch.end for touch in touches) / second
    axes.set_xlim(max(0.0, first - MARGIN * (last - first)), last + MARGIN * (last - first))
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False, fontsize=8, loc="upper right")


def _draw_yield(axes: Any, runs: Sequence[FemRun]) -> None:
    """Draw the plastic energy of each blow as a share of the energy in play."""
    shares = [100.0 * sum(run.plastic_work.values()) / max(run.energy_in_play, 1e-300) for run in runs]
    numbers = [run.blow for run in runs]
    axes.bar(numbers, shares, width=0.6, color=ORANGE)
    quiet(axes, "Taken by yield in each blow", "blow", "share of the energy in play (%)")
    axes.set_xlim(0.4, len(numbers) + 0.6)
    axes.set_xticks(numbers if len(numbers) <= MOST_TICKS else numbers[:: len(numbers) // (MOST_TICKS - 3) + 1])
    if max(shares) <= 0.0:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, "nothing yields", ha="center", va="center", transform=axes.transAxes, color=GREY)


def _peak(runs: Sequence[FemRun], name: str) -> float:
    return max((touch.peak for run in runs if (touch := contact_measure(run, name)) is not None), default=0.0)


def _look(k: int, count: int) -> tuple[str, str]:
    """Return colour and dash of the k-th of some blows."""
    if k == 0:
        return RED, "-"
    if k == count - 1:
        return BLUE, "--"
    return str(round(0.75 - 0.5 * k / count, 3)), "-"
