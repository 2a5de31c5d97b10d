"""The motion of a rotary machine, as a page that plays by itself and as a GIF."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.machine.figures.drawing import close_limits, draw_machine, view, whole_limits
from strikewave.analyses.machine.figures.geometry import (
    ASSEMBLY,
    CARRIAGE,
    DISC,
    LOOKS,
    NOSE,
    Connection,
    Outline,
    Outlines,
    Pose,
    outlines,
)
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.units import in_unit
from strikewave.reporting.animation import (
    FRAMES_PER_SECOND,
    Animation,
    Chart,
    Clock,
    Event,
    Panel,
    PlayedCurve,
    PlayedHistory,
    PlayedSpan,
    Readout,
    Scene,
    Shape,
    animation_page,
    write_gif,
)
from strikewave.reporting.numbers import ShownQuantity, axis_unit, decimals_in, fixed, headed
from strikewave.reporting.style import BLUE, GREY, RED, printable, quiet, thin

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution
    from strikewave.machines import Blow

Array = NDArray[np.float64]

BEFORE_BLOW, IN_BLOW, AFTER_BLOW = 20, 36, 44
"""Frames of a GIF: until the first blow, in slow motion through it, and from there to the end."""
SLOW = (0.2e-3, 0.8e-3)
"""Time in slow motion before and after first touch, s."""
_DPI = 80
_SIZE = (8.4, 6.2)
PANEL_HEIGHT = 57.0
"""Height of a panel of the page, pixels: three of them stand under the pictures on a screen of 768 lines."""
CIRCLE_CORNERS = 241
"""Corners of the polygon that stands for the path: it leaves the circle by less than a pixel at any size."""
LEAST_SPEED_SPAN = 0.01
"""Share of the turntable's speed that its panel spans at least, so that rounding does not fill it."""
RPM = np.pi / 30.0
"""r/min in rad/s."""
ORDER = ("disc", "striker", "nose", "hub", "ground", "carriage", "stop", "body", "body 2", "face")
"""Looks of outlines from the lowest to the highest; connections lie between turntable and feed."""
NOTE = (
    "Path, noses, engagement, strokes and displacements are to scale in both pictures; disc, springs, damper, stop and "
    "carriage are symbols. Time counts from the valve signal."
)


def machine_page(solution: Solution) -> str | None:
    """Return a page that shows a run of the rotary machine; None for any other case.

    The reader chooses the whole run or one blow, and how much slower than the machine it plays.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> page = machine_page(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> len(page) < 500_000, "://" in page
    (True, False)
    """
    motion = machine_motion(solution)
    return None if motion is None else animation_page(machine_animation(motion), solution.title, solution.case.name)


def machine_animation(motion: MachineMotion) -> Animation:
    """Return turntable, object and feed in motion, whole and close up, above the histories of the run or of a blow."""
    outline, near = motion.made, motion.near
    (second, milli), (metre, place) = axis_unit("s", "ms"), axis_unit("m", "mm")
    views = [PlayedSpan("whole", "whole run", motion.time[[0, -1]])]
    views += [
        PlayedSpan(str(k), f"blow {row.blow.index} ({row.blow.kind})", np.array([row.begin, row.end]))
        for k, row in enumerate(near)
    ]
    return Animation(
        kicker="The machine in motion",
        note=NOTE,
        gif="machine.gif",
        clock=Clock(milli, second, decimals_in("s", "ms", 3)),
        views=views,
        canvases=[
            Scene(
                "whole",
                "The whole machine; what it does at this time is written below.",
                "the whole machine: strikers blue, struck face red, stop yellow, carriage and feed grey",
                whole_limits(outline),
            ),
            Scene("close", "The strike, close up.", "the strike, close up", near_limits(outline)),
            Chart(
                "traces",
                "Contact force, rigid-body acceleration and turntable speed over time; their values at this time are "
                "written below.",
                "time",
                "time after the valve signal",
                PANEL_HEIGHT,
                _panels(motion),
            ),
        ],
        beside=2,
        smooth=True,
        tracks={name: getattr(motion, name) for name in ("time", "angle", "speed", NOSE, ASSEMBLY, CARRIAGE)},
        shapes=_shapes(outline),
        readouts=[
            Readout("face", f"{place} behind its place at rest", NOSE, metre, decimals_in("m", "mm", 2), motion.rest),
            Readout("carriage", f"{place} back", CARRIAGE, metre, decimals_in("m", "mm", 2)),
        ],
        events=[
            Event(blow.time, f"blow {blow.index} ({blow.kind})", "its pass" if blow.kind == "missed" else "first touch")
            for blow in motion.blows
        ],
        no_event="no blow yet",
    )


def _panels(motion: MachineMotion) -> list[Panel]:
    """Return contact force, rigid-body acceleration and turntable speed, those of each blow sampled more finely."""
    near = motion.near
    forces, accelerations = [PlayedHistory(*motion.force, 0.0)], [PlayedHistory(*motion.acceleration, 0.0)]
    forces += [PlayedHistory(*row.force, row.begin) for row in near]
    accelerations += [PlayedHistory(*row.acceleration, row.begin) for row in near]
    (newton, force_unit), (size, unit) = axis_unit("N", "kN"), axis_unit("m/s^2", "g")
    least = LEAST_SPEED_SPAN * float(np.abs(motion.speed).max())
    return [
        Panel(
            "contact force",
            force_unit,
            [PlayedCurve("", BLUE, forces)],
            newton,
            least=1e3 / newton,
            decimals=decimals_in("N", "kN", 3),
        ),
        Panel(
            "rigid-body acceleration",
            unit,
            [PlayedCurve("", RED, accelerations)],
            size,
            least=STANDARD_GRAVITY / size,
            decimals=decimals_in("m/s^2", "g", 1),
        ),
        Panel(
            "turntable speed",
            "r/min",
            [PlayedCurve("", GREY, track="speed")],
            RPM,
            zero=False,
            least=least / RPM,
            decimals=2,
        ),
    ]


def _shapes(made: Outlines) -> list[Shape]:
    """Return path, outlines and connections from the lowest to the highest, as they cover one another."""
    turn = np.linspace(0.0, 2.0 * np.pi, CIRCLE_CORNERS)
    path = made.geometry.radius * np.column_stack([np.cos(turn), np.sin(turn)])
    shapes = [Shape(path, edge="#4d5760", dashes=(8, 3, 2, 3))]
    for look in ORDER[: ORDER.index("hub") + 1]:
        shapes += [_shape(outline, made.geometry.blow_angle) for outline in made.shapes if outline.look == look]
    shapes += [line for connection in made.connections for line in _lines(connection)]
    for look in ORDER[ORDER.index("hub") + 1 :]:
        shapes += [_shape(outline, made.geometry.blow_angle) for outline in made.shapes if outline.look == look]
    return shapes


def _shape(outline: Outline, blow_angle: float) -> Shape:
    """Return an outline with the track that moves it; one on the disc as it stands at the turntable's angle 0."""
    fill, edge, width = LOOKS[outline.look]
    if outline.group != DISC:
        ends = ((0.0, _track(outline.group)), (1.0, _track(outline.group)))
        return Shape(outline.points, fill, edge, width, ends=ends)
    cosine, sine = np.cos(-blow_angle), np.sin(-blow_angle)
    return Shape(outline.points @ np.array([[cosine, sine], [-sine, cosine]]), fill, edge, width, turn="angle")


def _lines(connection: Connection) -> Sequence[Shape]:
    """Return the lines of a spring, damper or rod, which stretch between two parts."""
    begin, end = [(at, _track(group)) for at, group in zip(connection.ends, connection.groups, strict=True)]
    return [Shape(line, edge="#4a4a4a", width=1.3, closed=False, ends=(begin, end)) for line in connection.lines]


def _track(group: str) -> str:
    """Return the track that moves a group; none moves what stands on the ground."""
    return group if group in (NOSE, ASSEMBLY, CARRIAGE) else ""


def near_limits(made: Outlines) -> tuple[float, float, float, float]:
    """Return the limits of the close-up of a moving machine: a little more than those of the drawing, m."""
    left, right, bottom, top = close_limits(made.geometry)
    more = 0.15 * (right - left)
    return left - 0.2 * more, right + 1.8 * more, bottom - more, top + more


def frame_times(motion: MachineMotion) -> tuple[Array, NDArray[np.bool_]]:
    """Return the times of a GIF's frames, s, and which of them belong to the slow motion through the first blow."""
    last = float(motion.time[-1])
    struck = motion.near_struck
    if struck is None:
        times = np.linspace(0.0, last, BEFORE_BLOW + IN_BLOW + AFTER_BLOW)
        return times, np.zeros(times.size, bool)
    first = struck.blow.time
    slow = np.linspace(max(first - SLOW[0], 0.0), min(first + SLOW[1], last), IN_BLOW)
    before = np.linspace(0.0, slow[0], BEFORE_BLOW, endpoint=False)
    after = np.linspace(slow[-1], last, AFTER_BLOW + 1)[1:]
    return np.concatenate([before, slow, after]), np.repeat([False, True, False], [before.size, slow.size, after.size])


def write_machine_gif(solution: Solution, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write a run of the rotary machine as a GIF, slow through the first blow."""
    motion = machine_motion(solution)
    if motion is None:
        raise ValueError("only a rotary machine can be shown")
    figure, show = _moving(motion, solution.title)
    times, slow = frame_times(motion)
    slowed = 1.0 / (FRAMES_PER_SECOND * np.gradient(times))
    write_gif(
        path,
        figure,
        lambda frame: show(*frame),
        list(zip(times.tolist(), slow.tolist(), slowed.tolist(), strict=True)),
        progress,
    )


def _moving(motion: MachineMotion, title: str) -> tuple[Figure, Callable[[float, bool, float], None]]:
    """Return a figure of machine, close-up and histories, and the function that brings it to a time."""
    figure = Figure(figsize=_SIZE, dpi=_DPI)
    figure.suptitle(textwrap.fill(printable(title), 90), x=0.01, y=0.995, ha="left", fontsize=10, parse_math=False)
    whole, scale = view(figure, (0.05, 2.6, 5.2, 2.95), whole_limits(motion.made))
    close, enlarged = view(figure, (5.3, 2.6, 3.05, 2.95), near_limits(motion.made))
    close.set_title(f"close up, × {enlarged / scale:.2g}", fontsize=8, loc="left", pad=2)
    close.patch.set_visible(True)
    panels = [figure.add_axes((0.085, bottom, 0.9, 0.125)) for bottom in (0.25, 0.075)]
    clock = figure.text(0.01, 0.418, "", fontsize=9, family="monospace")
    struck = motion.near_struck
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
            cursor.set_xdata([time / axis_unit("s", "ms")[0]] * 2)
        clock.set_text(frame_words(motion, time, slowed))

    return figure, show


def _draw_histories(panels: Any, motion: MachineMotion, near: NearBlow | None) -> list[Any]:
    """Draw contact force and rigid-body acceleration of a blow, or of the whole run; return a cursor in each."""
    traces = (motion.force, motion.acceleration) if near is None else (near.force, near.acceleration)
    shown = (0.0, float(motion.time[-1]))
    if near is not None:
        shown = (near.blow.time - SLOW[0], near.blow.time + SLOW[1])
    second, _ = axis_unit("s", "ms")
    looks = (
        ("contact force", ShownQuantity("N", "kN"), BLUE),
        ("rigid-body acceleration", ShownQuantity("m/s^2", "g"), RED),
    )
    cursors = []
    for axes, trace, (label, kind, colour) in zip(panels, traces, looks, strict=True):
        axes.clear()
        axes.plot(trace.time / second, trace.values / kind.scale, color=colour, linewidth=0.9)
        cursors.append(axes.axvline(shown[0] / second, color="#1a1f24", linewidth=1.0))
        quiet(axes, "", headed("time after the valve signal", "s", "ms") if axes is panels[-1] else "", "")
        axes.set_title(headed(label, kind.si, kind.usual), fontsize=8, loc="left", pad=2)
        axes.set_xlim(shown[0] / second, shown[1] / second)
        axes.tick_params(labelsize=7, labelbottom=axes is panels[-1])
        axes.xaxis.label.set_size(8)
    return cursors


def frame_words(motion: MachineMotion, time: float, slowed: float) -> str:
    """Return the words below a frame: time, last blow, speed of the turntable, place of the face, slowness."""
    done = [blow for blow in motion.blows if blow.time <= time]
    blow = f"blow {done[-1].index}" if done else "no blow yet"
    turns = in_unit(float(np.interp(time, motion.time, motion.speed)), "rad/s", "rpm")
    (_, second), (_, metre) = axis_unit("s", "ms"), axis_unit("m", "mm")
    face = fixed(float(np.interp(time, motion.time, motion.nose)) - motion.rest, "m", "mm", 2)
    face = face if face.startswith("-") else f"+{face}"
    return (
        f"t = {fixed(time, 's', 'ms', 3):>8} {second}  {blow:<11} {turns:6.1f} r/min  "
        f"face {face:>6} {metre} from rest  slowed {slowed:,.0f} times"
    )


BEFORE, AFTER = 1e-3, 2e-3
"""Time shown before and after first touch of a blow, s."""
MOST_DETAILED = 20
"""Blows that can be looked at closely; of more the first, the odd ones and an even choice of the rest."""
WHOLE_PLACES, BLOW_PLACES = 1200, 100
"""Times at which places are kept: over the whole run, and about each blow."""
WHOLE_COLUMNS, PULSE_COLUMNS, REST_COLUMNS = 1000, 180, 50
"""Columns into which a history is gathered, its smallest and largest sample of each kept: the whole run; the pulse of
a blow; what comes after it."""
PULSE_WIDTHS = 2.0
"""Widths of a pulse, from first touch, that are kept as a pulse."""


class TimeHistory(NamedTuple):
    """A history: times after the valve signal, s, and values."""

    time: Array
    values: Array

    def at(self, time: float) -> float:
        """Return the value at a time, interpolated."""
        return float(np.interp(time, self.time, self.values)) if self.time.size else 0.0


class NearBlow(NamedTuple):
    """A blow from near by: the time in which it is shown, contact force (N) and rigid-body acceleration (m/s^2)."""

    blow: Blow
    begin: float
    end: float
    force: TimeHistory
    acceleration: TimeHistory


@dataclass(frozen=True)
class MachineMotion:
    """A run as it moves: outlines of the parts, and their tracks at times (s after the valve signal).

    Angle and speed are those of the turntable, rad and rad/s; nose, assembly and carriage places, m, as in `Pose`;
    force and acceleration the histories of the whole run; ``near`` holds the blows that are shown closely.
    """

    made: Outlines
    time: Array
    angle: Array
    speed: Array
    nose: Array
    assembly: Array
    carriage: Array
    force: TimeHistory
    acceleration: TimeHistory
    blows: Sequence[Blow]
    near: tuple[NearBlow, ...]

    def pose(self, time: float) -> Pose:
        """Return the pose at a time."""
        tracks = (self.angle, self.nose, self.assembly, self.carriage)
        return Pose(*[float(np.interp(time, self.time, track)) for track in tracks])

    @property
    def near_struck(self) -> NearBlow | None:
        """The first blow from near by that touched the object; None where none did."""
        return next((row for row in self.near if row.blow.kind != "missed"), None)

    @property
    def rest(self) -> float:
        """Place of the nose at rest with the object fed, m."""
        return -self.made.geometry.engagement


def machine_motion(solution: Solution) -> MachineMotion | None:
    """Return a run of the rotary machine as it moves; None for any other case."""
    outline = outlines(solution.case)
    if outline is None:
        return None
    data = solution.arrays
    time = data["time"].values
    near = tuple(_near(solution, row) for row in detailed(solution.blows))
    wanted = [np.linspace(0.0, time[-1], min(WHOLE_PLACES, time.size))]  # evenly over the run, more densely about blows
    wanted += [np.linspace(row.begin, row.end, BLOW_PLACES) for row in near]
    rows = np.unique(np.searchsorted(time, np.concatenate(wanted)).clip(0, time.size - 1))
    return MachineMotion(
        made=outline,
        time=time[rows],
        angle=data["turntable_angle"].values[rows],
        speed=data["turntable_speed"].values[rows],
        nose=data["nose_position"].values[rows],
        assembly=data["assembly_position"].values[rows],
        carriage=data["carriage_position"].values[rows],
        force=TimeHistory(*thin(time, data["contact_force"].values, WHOLE_COLUMNS)),
        acceleration=TimeHistory(*thin(time, data["rigid_acceleration"].values, WHOLE_COLUMNS)),
        blows=solution.blows,
        near=near,
    )


def detailed(blows: Sequence[Blow]) -> list[int]:
    """Return the rows of the blows that can be looked at closely."""
    if len(blows) <= MOST_DETAILED:
        return list(range(len(blows)))
    odd = [row for row, blow in enumerate(blows) if blow.kind != "full"][: MOST_DETAILED // 2]
    rest = np.linspace(0, len(blows) - 1, MOST_DETAILED - len(odd)).round().astype(int)
    return sorted({*odd, *rest.tolist()})


def _near(solution: Solution, row: int) -> NearBlow:
    """Return a blow from near by: samples of the whole run, and those of its pulse where it has one."""
    blow, time = solution.blows[row], solution.arrays["time"].values
    begin, end = max(blow.time - BEFORE, 0.0), min(blow.time + AFTER, float(time[-1]))
    force = _joined(solution, row, (begin, end), "contact_force", "pulse_force")
    acceleration = _joined(solution, row, (begin, end), "rigid_acceleration", "pulse_acceleration")
    return NearBlow(blow, begin, end, force, acceleration)


def _joined(solution: Solution, row: int, shown: tuple[float, float], train: str, pulse_name: str) -> TimeHistory:
    """Return a history about a blow, its pulse sampled as finely as the solution keeps it."""
    data, begun = solution.arrays, solution.blows[row].time
    time = data["time"].values
    rows = slice(*np.searchsorted(time, shown))
    coarse, values = time[rows], data[train].values[rows]
    fine, pulsed = begun + data["pulse_time"].values, data[pulse_name].values[row]
    known = np.isfinite(pulsed) & (fine >= shown[0]) & (fine <= shown[1])
    if not known.any():
        return TimeHistory(*thin(coarse, values, PULSE_COLUMNS))
    fine, pulsed = fine[known], pulsed[known]
    width = solution.blows[row].width
    within = fine <= begun + (PULSE_WIDTHS * width if width > 0.0 else AFTER)
    parts = [TimeHistory(coarse[coarse < fine[0]], values[coarse < fine[0]])]
    parts += [TimeHistory(*thin(fine[within], pulsed[within], PULSE_COLUMNS))]
    parts += [TimeHistory(*thin(fine[~within], pulsed[~within], REST_COLUMNS))] if not within.all() else []
    parts += [TimeHistory(coarse[coarse > fine[-1]], values[coarse > fine[-1]])]
    parts = [TimeHistory(*thin(*part, PULSE_COLUMNS)) if part.time.size else part for part in parts]
    return TimeHistory(np.concatenate([part.time for part in parts]), np.concatenate([part.values for part in parts]))
