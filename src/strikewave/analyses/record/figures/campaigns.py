"""Pictures of many records: how a figure goes over the files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.record.figures.records import say, shown
from strikewave.records.campaign import Campaign
from strikewave.reporting.numbers import axis_unit
from strikewave.reporting.style import BLUE, RED, WHOLE, legend_below, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TRENDS = ("peak", "width", "velocity_change", "interval")
"""Figures whose trend is drawn."""
OF_CHANNEL = {
    "peak": "peak",
    "rigid_peak": "peak without ringing",
    "rms": "RMS",
    "amplitude": "amplitude",
}
"""What figures in the unit of their channel are called."""
PURE = {"ratio": (1.0, "peak over base", ""), "damping": (0.01, "damping ratio", "%")}
"""How figures without a unit are shown: size, name and unit."""


def trend(campaign: Campaign, count: int = 0) -> Figure:
    """Draw peak, width, velocity change and interval over the files, with mean, its 95 % bounds, and a clear trend.

    Parameters
    ----------
    campaign : Campaign
        As `strikewave.records.campaign.summed` gives it.
    count : int, optional
        Number of files; as far as the last one with a value unless given.
    """
    names = [name for name in TRENDS if campaign.points.get(name)] or [TRENDS[0]]
    size = {1: WHOLE, 2: WHOLE, 3: (9.8, 3.3), 4: (9.8, 5.8)}[len(names)]
    figure = new_figure(size)
    figure.get_layout_engine().set(wspace=0.05, hspace=0.05)  # type: ignore[union-attr,call-arg]
    grid = figure.subplots(2, 2) if len(names) == 4 else figure.subplots(1, len(names))
    panels = np.atleast_1d(grid).ravel()
    for axes, name in zip(panels, names, strict=True):
        draw_trend(axes, campaign, name, campaign.unit, count)
    return legend_below(figure)


def draw_trend(axes: Any, campaign: Campaign, name: str, unit: str, count: int = 0) -> None:
    """Draw the trend of one figure on axes."""
    points = campaign.points.get(name, ())
    left_out = len({path for path, harmed, _ in campaign.left_out if name in harmed})
    gone = f"{left_out} file{'s' if left_out != 1 else ''} left out"
    if not points:
        say(axes, f"no file gave a value: {gone}")
        return
    scale, what, shown_unit = figure_unit(name, unit)
    x = np.array([k + 1 for k, _ in points], dtype=float)
    y = np.array([value for _, value in points]) / scale
    mean = campaign.statistics[name]
    ends = np.array([0.5, max(count, int(x.max())) + 0.5])
    if np.isfinite(mean.low):
        axes.fill_between(
            ends,
            max(mean.low / scale, 0.0) if y.min() > 0.0 else mean.low / scale,  # none can be on the other side
            min(mean.high / scale, 0.0) if y.max() < 0.0 else mean.high / scale,
            color=BLUE,
            alpha=0.15,
            linewidth=0,
            label="95 % bounds of the mean",
        )
    axes.plot(ends, [mean.mean / scale] * 2, color=BLUE, linewidth=1.2, label="mean")
    if name in campaign.trends and campaign.trends[name].significant:
        slope = campaign.trends[name].slope / scale
        along = np.array([x.min(), x.max()])
        axes.plot(along, np.median(y - slope * x) + slope * along, "--", color=RED, linewidth=1.4, label="trend")
    axes.plot(x, y, "o", color="#333333", markersize=4, alpha=0.8, label="blows", zorder=4)
    quiet(axes, what[0].upper() + what[1:] + (f" ({gone})" if left_out else ""), "file", f"{what} ({shown_unit})")
    axes.set_xlim(*ends)
    axes.margins(y=0.1)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.ticklabel_format(axis="y", useOffset=False)


def figure_unit(name: str, unit: str) -> tuple[float, str, str]:
    """Return how much SI the shown unit of a figure is, what the figure is called, and the unit.

    Examples
    --------
    >>> figure_unit("width", "m/s^2"), figure_unit("velocity_change", "N")
    ((1e-06, 'pulse width at 10 %', 'µs'), (1.0, 'impulse change', 'N s'))
    """
    how = shown(unit)
    if name in OF_CHANNEL:
        return how.scale, OF_CHANNEL[name], how.unit or how.name
    if name in PURE:
        return PURE[name]
    if name == "velocity_change":
        return how.integral_scale, f"{how.integral} change", how.integral_unit
    si, usual, called = {
        "ringing_frequency": ("Hz", "kHz", "ringing frequency"),
        "interval": ("s", "ms", name),
        "rise": ("s", "us", "rise time 10-90 %"),
        "width": ("s", "us", "pulse width at 10 %"),
        "rigid_width": ("s", "us", "pulse width at 10 % without ringing"),
        "delay": ("s", "ms", name),
        "duration": ("s", "ms", "effective duration"),
        "decay_time": ("s", "ms", "decay time (to 1/e)"),
        "frequency": ("Hz", "Hz", name),
    }[name]
    size, shown_as = axis_unit(si, usual)
    return size, called, shown_as
