"""A run of the rotary machine as a page that plays by itself and as a GIF."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.figures.drawing import close_limits, draw_machine, view, whole_limits
from strikewave.analyses.machine.figures.geometry import LOOKS, Outlines
from strikewave.analyses.machine.figures.motion import MachineMotion, NearBlow, Trace, machine_motion
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.units import in_unit
from strikewave.reporting.animation_page import moving_page, packed, printable
from strikewave.reporting.style import BLUE, RED, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.machine.result import Solution

Array = NDArray[np.float64]

BEFORE_BLOW, IN_BLOW, AFTER_BLOW = 20, 36, 44
"""Frames of a GIF: until the first blow, in slow motion through it, and from there to the end."""
SLOW = (0.2e-3, 0.8e-3)
"""What the slow motion shows: before and after first touch, s."""
_PER_SECOND, _DPI = 10, 80
_SIZE = (8.4, 6.2)


def machine_page(solution: Solution) -> str | None:
    """Return a page that shows a run of the rotary machine; None for any other case.

    Turntable, object and feed move, whole and close up, above contact force and rigid-body acceleration. The reader
    chooses the whole run or one blow, and how much slower than the machine it plays. It stands alone, as
    `animation_page.moving_page` says, and begins to play unless the reader asks for less motion.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> page = machine_page(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> len(page) < 500_000, "://" in page
    (True, False)
    """
    motion = machine_motion(solution)
    if motion is None:
        return None
    views = [("whole", "whole run")]
    views += [(str(k), f"blow {one.blow.index} ({one.blow.kind})") for k, one in enumerate(motion.near)]
    return moving_page(__package__, page_data(motion), solution.title, solution.case.name, views=views)


def page_data(motion: MachineMotion) -> dict[str, Any]:
    """Return what the page's script draws from: s, m, N, m/s^2; arrays as base 64, 4 bytes a value."""
    made, geometry = motion.made, motion.made.geometry
    tracks = ("angle", "speed", "nose", "assembly", "carriage")
    return {
        "shapes": [[s.group, s.look, np.round(s.points, 6).ravel().tolist()] for s in made.shapes],
        "connections": [
            [c.groups, np.round(c.ends, 6).tolist(), [np.round(line, 6).ravel().tolist() for line in c.lines]]
            for c in made.connections
        ],
        "looks": LOOKS,
        "radius": geometry.radius,
        "blowAngle": geometry.blow_angle,
        "rest": motion.rest,
        "limits": {"whole": whole_limits(made), "close": near_limits(made)},
        "motion": {
            "time": packed(motion.time, "<f8"),
            **{name: packed(getattr(motion, name), "<f4") for name in tracks},
        },
        "train": {"force": _packed(motion.force), "acceleration": _packed(motion.acceleration)},
        "blows": [[blow.index, blow.kind, blow.time] for blow in motion.blows],
        "near": [
            {
                "begin": one.begin,
                "end": one.end,
                "force": _packed(one.force, one.begin),
                "acceleration": _packed(one.acceleration, one.begin),
            }
            for one in motion.near
        ],
    }


def _packed(trace: Trace, begin: float = 0.0) -> dict[str, str]:
    """Return a history with its times after ``begin``."""
    return {"time": packed(trace.time - begin, "<f4"), "values": packed(trace.values, "<f4")}


def near_limits(made: Outlines) -> tuple[float, float, float, float]:
    """Return what the close-up of a moving machine takes: a little more than that of the drawing, m."""
    left, right, bottom, top = close_limits(made.geometry)
    more = 0.15 * (right - left)
    return left - 0.2 * more, right + 1.8 * more, bottom - more, top + more


def frame_times(motion: MachineMotion) -> tuple[Array, NDArray[np.bool_]]:
    """Return the times of a GIF's frames, s, and which of them belong to the slow motion through the first blow."""
    last = float(motion.time[-1])
    struck = [one for one in motion.near if one.blow.kind != "missed"]
    if not struck:
        times = np.linspace(0.0, last, BEFORE_BLOW + IN_BLOW + AFTER_BLOW)
        return times, np.zeros(times.size, bool)
    first = struck[0].blow.time
    slow = np.linspace(max(first - SLOW[0], 0.0), min(first + SLOW[1], last), IN_BLOW)
    before = np.linspace(0.0, slow[0], BEFORE_BLOW, endpoint=False)
    after = np.linspace(slow[-1], last, AFTER_BLOW + 1)[1:]
    return np.concatenate([before, slow, after]), np.repeat([False, True, False], [before.size, slow.size, after.size])


def write_machine_gif(solution: Solution, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write a run of the rotary machine as a GIF, slow through the first blow.

    Parameters
    ----------
    solution : Solution
        Of a rotary machine.
    path : Path
        Where it is written.
    progress : callable, optional
        Called with the share that is done, 0 to 1.
    """
    from matplotlib.animation import PillowWriter

    motion = machine_motion(solution)
    if motion is None:
        raise ValueError("only a rotary machine can be shown")
    figure, show = _moving(motion, solution.title)
    times, slow = frame_times(motion)
    steps = np.gradient(times)
    writer = PillowWriter(fps=_PER_SECOND)
    with writer.saving(figure, str(path), _DPI):
        for done, (time, is_slow, step) in enumerate(zip(times, slow, steps, strict=True)):
            show(float(time), bool(is_slow), 1.0 / (_PER_SECOND * float(step)))
            writer.grab_frame()
            if progress is not None:
                progress((done + 1) / len(times))


def _moving(motion: MachineMotion, title: str) -> tuple[Figure, Callable[[float, bool, float], None]]:
    """Return a figure of machine, close-up and histories, and what brings it to a time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=_SIZE)
    figure.suptitle(textwrap.fill(printable(title), 90), x=0.01, y=0.995, ha="left", fontsize=10, parse_math=False)
    whole, scale = view(figure, (0.05, 2.6, 5.2, 2.95), whole_limits(motion.made))
    close, enlarged = view(figure, (5.3, 2.6, 3.05, 2.95), near_limits(motion.made))
    close.set_title(f"close up, × {enlarged / scale:.2g}", fontsize=8, loc="left", pad=2)
    close.patch.set_visible(True)
    panels = [figure.add_axes((0.085, bottom, 0.9, 0.125)) for bottom in (0.25, 0.075)]
    clock = figure.text(0.01, 0.418, "", fontsize=9, family="monospace")
    struck = next((one for one in motion.near if one.blow.kind != "missed"), None)
    drawn: list[Any] = []
    cursors: list[Any] = []
    before: list[bool] = []

    def show(time: float, slow: bool, slowed: float) -> None:
        while drawn:
            drawn.pop().remove()
        pose = motion.pose(time)
        for axes in (whole, close):
            drawn.extend(draw_machine(axes, motion.made, pose, 0.8))
        if before != [slow]:
            before[:], cursors[:] = [slow], _draw_histories(panels, motion, struck if slow else None)
        for cursor in cursors:
            cursor.set_xdata([time * 1e3] * 2)
        clock.set_text(frame_words(motion, time, slowed))

    return figure, show


def _draw_histories(panels: Any, motion: MachineMotion, near: NearBlow | None) -> list[Any]:
    """Draw contact force and rigid-body acceleration of a blow, or of the whole run; return a cursor in each."""
    traces = (motion.force, motion.acceleration) if near is None else (near.force, near.acceleration)
    shown = (0.0, float(motion.time[-1]))
    if near is not None:
        shown = (near.blow.time - SLOW[0], near.blow.time + SLOW[1])
    looks = (("contact force (kN)", 1e3, BLUE), ("rigid-body acceleration (g)", STANDARD_GRAVITY, RED))
    cursors = []
    for axes, trace, (label, unit, colour) in zip(panels, traces, looks, strict=True):
        axes.clear()
        axes.plot(trace.time * 1e3, trace.values / unit, color=colour, linewidth=0.9)
        cursors.append(axes.axvline(shown[0] * 1e3, color="#1a1f24", linewidth=1.0))
        quiet(axes, "", "time after the valve signal (ms)" if axes is panels[-1] else "", "")
        axes.set_title(label, fontsize=8, loc="left", pad=2)
        axes.set_xlim(shown[0] * 1e3, shown[1] * 1e3)
        axes.tick_params(labelsize=7, labelbottom=axes is panels[-1])
        axes.xaxis.label.set_size(8)
    return cursors


def frame_words(motion: MachineMotion, time: float, slowed: float) -> str:
    """Say when a frame is, which blow was the last, how fast the turntable turns, and how much slower it is shown.

    Time and speed are those of the solution.
    """
    done = [blow for blow in motion.blows if blow.time <= time]
    blow = f"blow {done[-1].index}" if done else "no blow yet"
    turns = in_unit(float(np.interp(time, motion.time, motion.speed)), "rad/s", "rpm")
    retreat = (float(np.interp(time, motion.time, motion.nose)) - motion.rest) * 1e3
    return (
        f"t = {time * 1e3:8.3f} ms  {blow:<11} {turns:6.1f} r/min  face {retreat:+6.2f} mm from rest  "
        f"slowed {slowed:,.0f} times"
    )
