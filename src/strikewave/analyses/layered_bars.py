"""Waves of a layered bar in reports: wave field, x-t diagram, curves of taps and sensors, and the sections on them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.shock_quantities import ACCELERATION, KILOHERTZ, LENGTH, STEP
from strikewave.base.texts import percent
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import ShownQuantity, axis_unit, fixed, headed, shown, with_unit
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.reporting.style import (
    BLUE,
    COLOURS,
    DASHES,
    GREY,
    RED,
    WHOLE,
    Trace,
    new_figure,
    put_below,
    put_legend,
    quiet,
    shortened,
    spread,
    traces,
)
from strikewave.sensors import insertion_loss as loss_of
from strikewave.waves import Stack, Tap
from strikewave.waves.li_ma import Sandwich, endless_force, first_echoes, staircase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.cases.stack_of_case import FittedLoss
    from strikewave.sensors.trial import SensorChannel
    from strikewave.waves.transit import WaveSetup

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FieldQuantity(ShownQuantity):
    """A quantity of a picture of the field: its name, colours, words for both signs.

    The colour maps are diverging, white at zero, and told apart by colour-blind readers.
    """

    name: str
    colours: str
    above: str
    most: str
    least: str

    @property
    def label(self) -> str:
        """Label of an axis, with unit and sign."""
        return f"{self.name} ({self.unit}), {self.above} above 0"


QUANTITIES = {
    "stress": FieldQuantity("Pa", "MPa", "stress", "RdBu", "compression", "largest compression", "largest tension"),
    "force": FieldQuantity("N", "kN", "force", "RdBu", "compression", "largest compression", "largest tension"),
    "velocity": FieldQuantity("m/s", "m/s", "velocity", "PuOr", "along the blow", "fastest along", "fastest back"),
}
"""Quantities that the pictures of a field can show, by name."""

_FEWEST_ROWS = 120  # chosen: no cell of an x-t diagram is then wider than 6 pixels
"""Times of a field that is cut short."""
_MOST_NAMES = 22  # as `_NAME_STEP` sets them apart
"""Names beside a diagram; of more layers the longest ones are named."""
_NAME_STEP = 0.045  # `_MOST_NAMES` of 8 points fill the height
"""Distance of names beside a diagram, share of its height."""
_MOST_SHADED = 200  # of more, a layer would be two pixels high, and its lines would hide the waves
"""Layers up to which faces and shades are drawn, and curves cut there."""
_OPEN = 1e-9  # the solver gives exactly minus the preload there, but for rounding
"""Share of the largest force below which a joint that can open counts as open."""
_NARROWEST_NAMED = 0.04  # not even an upright name of 7 points would fit
"""Share of the stack below which a layer has no name in a panel."""
_LETTER = 0.03  # letters of 7 points in panels of 2.7 inches, with a little air
"""Width of a letter of a name in a panel, share of the panel; a name wider than its layer stands upright."""
_EXTREME, _NOTABLE = 0.999, 0.01  # the first row of a plateau; chosen: less cannot be seen
"""Share of the greatest value from which a row counts as its first; share of the larger sign from which the other sign
has a snapshot of its own."""
_APART = 100  # chosen: nearer ones look alike
"""Snapshots at fronts lie at least one over this of the duration apart."""
_AIR = 0.06  # as matplotlib leaves 0.05
"""Share of the range left free above and below the curves of snapshots."""
_SHADE, _RATIO = (0.97, 0.13), 3.0  # chosen: black text stays legible; nearly equal layers look nearly equal
"""Grey of the least impedance, and how much darker the greatest is; ratio of impedances below which the darkest grey is
not reached."""
SNAPSHOTS = 6  # two rows of three fill the width of a page
"""Panels of snapshots."""
MOST_TRANSITS = 2000.0  # the closed form sums over all transits of the layer
"""Transits of a field up to which its staircase is drawn."""
BONDED_STYLE: tuple[Any, float] = ("-", 0.7)
DASHED: tuple[Any, float] = ((0, (4, 2)), 0.9)
THICK: tuple[Any, float] = ("-", 1.8)
JOINT_STYLES = {"compliant": DASHED, "gasket": DASHED, "contact": DASHED, "mass": THICK, "oscillator": THICK}
"""Line style and width of joints, bonded ones apart: a spring is dashed, a mass thick."""


@dataclass(frozen=True)
class WaveField:
    """Force and velocity along a stack over time."""

    stack: Stack
    time: Array
    """Times, s, shape (times,)."""
    position: Array
    """Places, m from the first face, shape (places,); both faces of a joint have one place."""
    layer: NDArray[np.int64]
    """Index of the layer of each place; of very many layers only some have places."""
    force: Array
    """Force, N, compression positive, shape (times, places)."""
    velocity: Array | None
    """Velocity along the blow, m/s, of the same shape; None where none was kept."""
    taps: tuple[tuple[str, Tap], ...]
    """Names and places that are marked."""
    since: str
    """Label of the time axis, such as ``time``."""

    def values(self, quantity: str) -> Array:
        """Return stress (Pa), force (N) or velocity (m/s), shape (times, places)."""
        if quantity == "velocity":
            if self.velocity is None:
                raise ValueError("this field holds no velocity")
            return self.velocity
        if quantity == "force":
            return self.force
        area = np.array([layer.area for layer in self.stack.layers])
        return np.asarray(self.force / area[self.layer])

    @property
    def ends(self) -> Array:
        """Far end of each layer, m."""
        return np.cumsum([layer.length for layer in self.stack.layers])

    @property
    def middles(self) -> Array:
        """Middle of each layer, m."""
        return np.asarray(self.ends - 0.5 * np.array([layer.length for layer in self.stack.layers]))

    @property
    def loaded(self) -> bool:
        """True if a force acts on the first face."""
        return bool(np.any(self.force[:, 0]))

    def place(self, tap: Tap) -> float:
        """Return the place of a tap, m from the first face."""
        layer = self.stack.layers[tap.layer]
        return float(self.ends[tap.layer] - (1.0 - tap.position) * layer.length)

    def up_to(self, time: float) -> WaveField:
        """Return the field until a time, s, with at least `_FEWEST_ROWS` times."""
        rows = max(int(np.searchsorted(self.time, time * (1.0 + 1e-9), side="right")), _FEWEST_ROWS)
        velocity = None if self.velocity is None else self.velocity[:rows]
        return replace(self, time=self.time[:rows], force=self.force[:rows], velocity=velocity)

    def travel(self) -> Array:
        """Return the time that a wave takes from the first face to each place, s."""
        layers = self.stack.layers
        begins = np.concatenate([[0.0], self.ends[:-1]])[self.layer]
        before = np.concatenate([[0.0], np.cumsum([layer.transit for layer in layers])[:-1]])[self.layer]
        speed = np.array([layer.bar_speed for layer in layers])[self.layer]
        return np.asarray(before + (self.position - begins) / speed)

    def front(self) -> Array:
        """Return the earliest time at which a wave can be at each place, s: the leading characteristic.

        Waves start from the first face where a force acts on it, and from faces that meet at different speeds;
        infinite where there is neither.
        """
        transits = np.cumsum([layer.transit for layer in self.stack.layers])
        meeting = [
            t for t, (a, b) in zip(transits[:-1], pairwise(self.stack.layers), strict=True) if a.speed != b.speed
        ]
        travel = self.travel()
        sources = [*([0.0] if self.loaded else []), *meeting]
        return np.min([np.full_like(travel, np.inf), *(np.abs(travel - source) for source in sources)], axis=0)


def xt_diagram(field: WaveField, quantity: str = "stress") -> Figure:
    """Draw a quantity along a stack over time, with the faces of layers, the taps and the leading front.

    A joint that can open is a double line while no force crosses it. The quantity is one of `QUANTITIES`.
    """
    shown = QUANTITIES[quantity]
    values = field.values(quantity) / shown.scale
    most = float(np.abs(values).max(initial=0.0))
    second, metre = _second(), _metre()
    figure = new_figure((WHOLE[0], 4.2))
    axes = figure.add_subplot()
    mesh = axes.pcolormesh(
        cell_edges(field.time) / second,
        cell_edges(field.position) / metre,
        values.T,
        cmap=shown.colours,
        vmin=-(most or 1.0),
        vmax=most or 1.0,
        rasterized=True,
    )
    axes.set_xlim(0.0, field.time[-1] / second)
    axes.set_ylim(field.ends[-1] / metre, 0.0)
    front = field.front()
    reached = front <= field.time[-1]
    fronts = np.where(reached, front, np.nan) / second
    axes.plot(fronts, field.position / metre, color="#222222", linewidth=0.9, linestyle=(0, (5, 4)))
    _faces(axes, field)
    _tap_marks(axes, field)
    longest = _names_beside(axes, field)
    bar = figure.colorbar(mesh, ax=axes, pad=0.02 + 0.0075 * longest)
    bar.set_label(shown.label, labelpad=8)
    if most == 0.0:
        axes.text(0.5, 0.5, "nothing moves", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_title(f"{shown.name.capitalize()} along the stack", loc="left", fontsize=10)
    axes.set_xlabel(headed(field.since, "s", "us"))
    axes.set_ylabel(distance_label())
    return figure


def distance_label() -> str:
    """Return the label of the axis along the stack."""
    return headed("distance from the loaded face", "m", "mm")


def _second() -> float:
    """Return the size of the unit in which times are shown, s."""
    return axis_unit("s", "us")[0]


def _metre() -> float:
    """Return the size of the unit in which places are shown, m."""
    return axis_unit("m", "mm")[0]


def cell_edges(centres: Array) -> Array:
    """Return the edges of cells about their centres; both sides of a joint have the same place and share an edge.

    Examples
    --------
    >>> print(cell_edges(np.array([0.0, 1.0, 1.0, 3.0])))
    [0.  0.5 1.  2.  3. ]
    """
    return np.concatenate([centres[:1], 0.5 * (centres[1:] + centres[:-1]), centres[-1:]])


def _faces(axes: Any, field: WaveField) -> None:
    """Draw the joints: bonded a thin line, springs dashed, a mass thick; one that can open double while open."""
    if len(field.stack.layers) > _MOST_SHADED:
        return
    second, metre = _second(), _metre()
    last = field.time[-1] / second
    peak = float(np.abs(field.force).max(initial=0.0))
    for k, (joint, end) in enumerate(zip(field.stack.joints, field.ends[:-1] / metre, strict=True)):
        style, width = JOINT_STYLES.get(joint.kind, BONDED_STYLE)
        axes.plot([0.0, last], [end, end], color="#222222", linewidth=width, linestyle=style)
        face = np.flatnonzero(field.layer == k)
        if not joint.unilateral or not face.size:
            continue
        open_now = np.abs(field.force[:, face[-1]] + joint.preload) <= _OPEN * peak
        line = np.where(open_now, end, np.nan)
        axes.plot(field.time / second, line, color="#222222", linewidth=3.4, solid_capstyle="butt")
        axes.plot(field.time / second, line, color="white", linewidth=1.8, solid_capstyle="butt")


def _tap_marks(axes: Any, field: WaveField) -> None:
    """Mark the taps by a dotted line with their name at its end; taps at one place share it."""
    if len(field.taps) > _MOST_NAMES:
        return
    metre = _metre()
    places: dict[float, list[str]] = {}
    for name, tap in field.taps:
        places.setdefault(field.place(tap) / metre, []).append(name)
    total = field.ends[-1] / metre
    for place, names in places.items():
        low = place > 0.96 * total
        axes.axhline(place, color="#222222", linewidth=0.8, linestyle=":")
        axes.annotate(
            "▸ " + shortened(", ".join(names)),
            (1.0, place),
            (-4, 1 if low else -1),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            ha="right",
            va="bottom" if low else "top",
            fontsize=7,
            parse_math=False,
            bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8},
        )


def _names_beside(axes: Any, field: WaveField) -> int:
    """Write the names of the layers beside a diagram, spread where layers are thin; return the longest length."""
    layers = field.stack.layers
    chosen = sorted(sorted(range(len(layers)), key=lambda k: -layers[k].length)[:_MOST_NAMES])
    total = float(field.ends[-1]) / _metre()
    middles = field.middles[chosen] / _metre()
    names = [shortened(layers[k].name) for k in chosen]
    beside = axes.get_yaxis_transform()
    for name, middle, place in zip(names, middles, spread(middles, _NAME_STEP * total, total), strict=True):
        moved = abs(place - middle) > 1e-3 * total
        if moved:
            axes.plot([1.0, 1.012], [middle, place], color=GREY, linewidth=0.6, transform=beside, clip_on=False)
        text = {"fontsize": 8, "va": "center", "ha": "left", "parse_math": False}
        axes.text(1.015, place, name, transform=beside, **text)
    return max(len(name) for name in names)


def snapshot_rows(field: WaveField, quantity: str = "stress", count: int = SNAPSHOTS) -> list[tuple[int, str]]:
    """Choose rows of a field worth a picture, and say why.

    The greatest values of both signs; the front half-way through the first layer, half-way through the second one,
    at the far end, its echo half-way back, as far as no gap is in the way and no chosen row is nearer than a
    hundredth of the time. The rest of the count falls into the longest waits, without a reason.
    """
    chosen: dict[int, str] = {}
    for row, why in _extreme_rows(field, quantity):
        chosen[row] = f"{chosen[row]}, {why}" if row in chosen else why
    for row, why in _front_rows(field):
        if all(abs(row - other) > len(field.time) // _APART for other in chosen):
            chosen[row] = why
    rows = np.arange(len(field.time))
    while len(chosen) < min(count, rows.size):
        taken = np.array([0, rows[-1], *chosen])
        away = np.abs(rows - taken[:, None]).min(axis=0)
        away[list(chosen)] = -1
        chosen[int(np.argmax(away))] = ""
    return sorted(chosen.items())[:count]


def _front_rows(field: WaveField) -> list[tuple[int, str]]:
    """Return the rows of the front on its way, where it starts from the first face alone, up to an open gap."""
    layers, joints = field.stack.layers, field.stack.joints
    if not field.loaded or any(layer.speed for layer in layers):
        return []
    first, whole = layers[0].transit, field.stack.transit
    events = [(0.5 * first, f"front in {shortened(layers[0].name)}")]
    if joints and not joints[0].gap:
        events.append((first + 0.5 * layers[1].transit, f"front in {shortened(layers[1].name)}"))
    if not any(joint.gap for joint in joints):
        events += [(whole, "front at the far end"), (1.5 * whole, "its echo half-way back")]
    return [(int(np.searchsorted(field.time, t)), why) for t, why in events if t <= field.time[-1]]


def _extreme_rows(field: WaveField, quantity: str) -> list[tuple[int, str]]:
    """Return the first rows that come within a thousandth of the greatest and of the least value."""
    values, shown = field.values(quantity), QUANTITIES[quantity]
    high, low = values.max(axis=1), values.min(axis=1)
    most = float(np.abs(values).max(initial=0.0))
    rows = []
    for peaks, why in ((high, shown.most), (-low, shown.least)):
        if peaks.max() > _NOTABLE * most:
            rows.append((int(np.argmax(peaks >= _EXTREME * peaks.max())), why))
    return rows


def snapshots(field: WaveField, quantity: str = "stress") -> Figure:
    """Draw a quantity along the stack at a few times, see `snapshot_rows`; the darker a layer, the more impedance."""
    shown = QUANTITIES[quantity]
    values = field.values(quantity) / shown.scale
    figure = new_figure((WHOLE[0], 4.6))
    grid = figure.subplots(2, SNAPSHOTS // 2, sharex=True, sharey=True, squeeze=False)
    chosen = snapshot_rows(field, quantity)
    low, high = min(float(values.min(initial=0.0)), 0.0), max(float(values.max(initial=0.0)), 0.0)
    second, micro = axis_unit("s", "us")
    margin = _AIR * (high - low) or 1.0
    for axes, (row, why) in zip(grid.flat, chosen, strict=False):
        shade_layers(axes, field)
        draw_along(axes, field, values[row])
        time = f"{field.time[row] / second:.4g} {micro}"
        title = textwrap.fill(f"{time}: {why}" if why else time, 50)
        axes.set_title(title, loc="left", fontsize=8, parse_math=False)
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_xlim(0.0, field.ends[-1] / _metre())
        axes.set_ylim(low - margin, high + margin)
    for axes in grid.flat[len(chosen) :]:
        axes.set_axis_off()
    name_layers(grid[0, 0], field)
    figure.supxlabel(distance_label(), fontsize=10)
    figure.supylabel(shown.label, fontsize=10)
    return figure


def shades(stack: Stack) -> list[float]:
    """Return a grey for each layer, 1 white: light for the least impedance, darker for more, 3 to 1 at least."""
    impedance = np.log([layer.impedance for layer in stack.layers])
    share = (impedance - impedance.min()) / max(float(np.ptp(impedance)), np.log(_RATIO))
    return [float(_SHADE[0] - _SHADE[1] * part) for part in share]


def shade_layers(axes: Any, field: WaveField) -> None:
    """Shade the layers by impedance, draw their faces and the line at zero."""
    axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
    if len(field.stack.layers) > _MOST_SHADED:
        return
    begin, metre = 0.0, _metre()
    for end, grey in zip(field.ends / _metre(), shades(field.stack), strict=True):
        axes.axvspan(begin, end, color=str(grey), linewidth=0.0, zorder=0)
        begin = end
    for joint, end in zip(field.stack.joints, field.ends[:-1] / metre, strict=True):
        style, width = JOINT_STYLES.get(joint.kind, BONDED_STYLE)
        colour = "#8a8a8a" if joint.kind not in JOINT_STYLES else "#333333"
        axes.axvline(end, color=colour, linewidth=width, linestyle=style, zorder=1)


def draw_along(axes: Any, field: WaveField, values: Array) -> list[Any]:
    """Draw values along the stack: blue above zero, red below; jumps at joints stay jumps. Return what was drawn."""
    few = len(field.stack.layers) <= _MOST_SHADED
    cuts = np.flatnonzero(np.diff(field.layer)) + 1 if few else np.empty(0, np.int64)
    x, y = np.insert(field.position / _metre(), cuts, np.nan), np.insert(values, cuts, np.nan)
    look: dict[str, Any] = {"interpolate": True, "alpha": 0.3, "linewidth": 0.0, "zorder": 2}
    return [
        axes.fill_between(x, y, where=y >= 0.0, color=BLUE, **look),
        axes.fill_between(x, y, where=y <= 0.0, color=RED, **look),
        *axes.plot(x, y, color="#1a1f24", linewidth=1.2, zorder=3),
    ]


def name_layers(axes: Any, field: WaveField) -> None:
    """Write the names of layers into a panel, upright where they are too wide for their layer."""
    total, places = float(field.ends[-1]), axes.get_xaxis_transform()
    for layer, middle in zip(field.stack.layers, field.middles, strict=True):
        name, share = shortened(layer.name, 14), layer.length / total
        if share < _NARROWEST_NAMED:
            continue
        style: dict[str, Any] = {"fontsize": 7, "ha": "center", "va": "top", "color": "#4d5760", "parse_math": False}
        turned = 90 if len(name) * _LETTER > share else 0
        axes.text(middle / _metre(), 0.98, name, transform=places, rotation=turned, zorder=4, **style)


def sandwiched(field: WaveField) -> int | None:
    """Return the layer whose staircase is worth a picture: between two others, under a load on the first face.

    The first tapped one, else the one whose closed form lasts longest; None where there is none.
    """
    layers = field.stack.layers
    inner = [
        k
        for k in np.unique(field.layer).tolist()
        if 0 < k < len(layers) - 1 and field.time[-1] < MOST_TRANSITS * layers[k].transit
    ]
    if not inner or not field.loaded or any(layer.speed for layer in layers):
        return None
    longest = max(inner, key=lambda k: first_echoes(field.stack, k)[0] / layers[k].transit)
    return next((tap.layer for _, tap in field.taps if tap.layer in inner), longest)


_TRANSITS, _AFTER_PEAK = 9.0, 1.3
"""A staircase is drawn over so many transits of the layer, or so many times the time to the peak of the load (chosen:
all steps that are drawn are passed, or the peak is)."""
_AT_PEAK = 0.999
"""Share of the largest load from which on the peak counts as reached: a plateau is reached at its begin."""
_STEPS = 4
"""Steps of a staircase that are drawn; at a ratio of impedances of 3 the fifth adds less than 1 %."""
_CURVES_APART = 0.06
"""Share of the largest load by which labels of steps are apart at least: letters of 7 points on axes of 2.4 inches."""


def staircase_diagram(field: WaveField, layer: int, time: Array, load: Array) -> Figure:
    """Draw how force grows at both interfaces of a layer, compared with bonded, endless neighbours.

    Forces are over the largest load; time counts from when the front reaches interface I, in transits of the
    layer. Dotted are the steps of `staircase` for a jump; dashed the same steps for the load as it was. Behind the
    first echo from beyond the neighbours the dashed curve ends. Time and load, s and N, are those of the first face.
    """
    layers, transit = field.stack.layers, field.stack.layers[layer].transit
    peak = float(np.abs(load).max(initial=0.0)) or 1.0
    arrival = sum(part.transit for part in layers[:layer])
    highest = float(time[np.argmax(np.abs(load) >= _AT_PEAK * peak)])
    shown = field.time <= arrival + max(_TRANSITS * transit, _AFTER_PEAK * highest)
    since = (field.time[shown] - arrival) / transit
    until_last = time <= field.time[shown][-1]
    closed = endless_force(field.stack, layer, field.time[shown], time[until_last], load[until_last])
    steps = staircase(Sandwich(*layers[layer - 1 : layer + 2]), _STEPS)
    here = np.flatnonzero(field.layer == layer)
    figure = new_figure(WHOLE)
    for k, axes in enumerate(figure.subplots(1, 2, sharey=True)):
        _step_levels(axes, steps[k])
        heard = first_echoes(field.stack, layer)[k] / transit
        axes.plot(since, field.force[shown, here[-k]] / peak, color=BLUE, linewidth=1.6, label="this stack")
        before = since <= heard
        axes.plot(
            since[before], closed[k][before] / peak, "--", color=RED, linewidth=1.4, label="endless neighbours, bonded"
        )
        if heard < since[-1]:
            axes.axvline(heard, color=GREY, linewidth=0.8)
        a, b = (shortened(part.name) for part in layers[layer - 1 + k : layer + 1 + k])
        quiet(axes, "", f"time since the front reached I, over t₀ = {with_unit(transit, 's', 'us')}", "")
        axes.set_title(f"Interface {'I' * (k + 1)}: {a} | {b}", loc="left", fontsize=10, parse_math=False)
        axes.set_xlim(-1.0, float(since[-1]))
    figure.axes[0].set_ylabel("force over the largest load")
    handles, labels = figure.axes[1].get_legend_handles_labels()
    put_below(figure, handles, labels)
    return figure


def _step_levels(axes: Any, levels: Array) -> None:
    """Draw the steps of a staircase as dotted levels, and write those that are `_APART`."""
    labelled: list[float] = []
    for level in levels:
        axes.axhline(level, color=GREY, linewidth=0.8, linestyle=":")
        if all(abs(level - other) > _CURVES_APART for other in labelled):
            labelled.append(float(level))
            axes.text(-0.95, level, f"{level:.3f}", fontsize=7, ha="left", va="bottom", color="#4d5760")


def insertion_loss(curves: Sequence[tuple[str, Array, Array]]) -> Figure:
    """Draw the insertion loss (dB) of buffers over frequency (Hz): what a buffer takes off the motion below it."""
    figure = new_figure(WHOLE)
    axes: Any = figure.add_subplot()
    for k, (name, frequency, loss) in enumerate(curves):
        axes.semilogx(
            frequency / axis_unit("Hz", "kHz")[0],
            loss,
            DASHES[k % len(DASHES)],
            color=COLOURS[k % len(COLOURS)],
            label=name,
            linewidth=1.4,
        )
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Insertion loss of the buffer", headed("frequency", "Hz", "kHz"), "loss (dB), below 0 it amplifies")
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
    axes.minorticks_off()
    if len(curves) > 1:
        put_legend(axes)
    return figure


MOST_LAYERS = 50  # chosen: about two screens; the JSON lists all
"""Layers that a table lists."""
# chosen: 1, 2, 5 steps over the flat range and the resonances of shock accelerometers
LOSS_FREQUENCIES = (1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5)
"""Frequencies at which the insertion loss of a buffer is listed, Hz."""
_RECORDED = {"resonance": KILOHERTZ, "range": ACCELERATION, "sampling": KILOHERTZ, "filter": KILOHERTZ}
"""Data of each sensor in the table of sensors."""
_ROUTES = (
    "The routes of Li & Ma 2019 take the neighbours of the specimen as endless, with the force on the loaded face as "
    "input. As printed, echoes return too early and a backward wave has the wrong sign; the corrected route repairs "
    "both. The paper then adds the wave to the rigid acceleration (superposed), which counts the rigid motion twice. "
    "The exact route is the finite stack itself."
)


def fit_tables(losses: Sequence[FittedLoss]) -> list[Table]:
    """List each loss factor with its band and the largest relative deviation of the model; no table without any."""
    rows: list[list[Cell]] = []
    for loss in losses:
        low, high = (f"{shown(end, *KILOHERTZ.units):g}" for end in (loss.low, loss.high))
        rows.append([loss.where, f"{loss.loss_factor:g}", f"{low} to {high}", percent(loss.error, 1)])
    band = headed("band", *KILOHERTZ.units)
    return [Table("Fit of the loss factors", ["where", "loss factor", band, "largest deviation"], rows)][: len(rows)]


def layer_table(setup: WaveSetup) -> Table:
    """List the layers as asked for and as the time step made them."""
    rows: list[list[Cell]] = [
        [
            layer.name,
            written(shown(layer.length_asked, *LENGTH.units), 7),
            written(shown(layer.length_used, *LENGTH.units), 7),
            f"{layer.length_used / layer.length_asked - 1.0:+.1e}",
            layer.steps,
        ]
        for layer in setup.layers[:MOST_LAYERS]
    ]
    more = len(setup.layers) - MOST_LAYERS
    caption = f"Layers, rounded to whole time steps of {amount(STEP, setup.step)}"
    caption += f"; {more} more in the JSON" if more > 0 else ""
    lengths = [headed(name, *LENGTH.units) for name in ("length in the case", "length used")]
    return Table(caption, ["layer", *lengths, "relative difference", "time steps of a transit"], rows)


def field_pictures(field: WaveField, quantity: str = "stress") -> list[Part]:
    """Show the whole field: the x-t diagram, and snapshots along the stack."""
    drawn = QUANTITIES[quantity]
    meaning = {"RdBu": "blue is compression, red tension", "PuOr": "purple is along the blow, orange against it"}
    opens = any(joint.unilateral for joint in field.stack.joints)
    double = " A joint that can open is a double line while no force crosses it." if opens else ""
    return [
        Picture(
            xt_diagram(field, quantity),
            f"{drawn.name.capitalize()} along the stack over time (exact): {meaning[drawn.colours]}. Lines are faces "
            f"of layers, dotted ones taps; the dashed line is the leading front at the bar wave speeds.{double}",
        ),
        Picture(
            snapshots(field, quantity),
            f"{drawn.name.capitalize()} along the stack at chosen times: as the front passes, at the largest values, "
            "and in the longest intervals between. The darker a layer, the larger its impedance.",
        ),
    ]


def route_section(name: str, quoted: bool, time: Any, exact: Any, rigid: Any, waves: Any, since: str) -> Section:
    """Compare the paper's three routes with the exact solution at one tap; peaks only where they may be quoted."""
    printed, corrected = waves
    curves = [
        Trace("exact, total", time, exact),
        Trace("as printed, wave", time, printed),
        Trace("corrected, wave", time, corrected),
        Trace("superposed: rigid + as printed", time, rigid + printed),
    ]
    rows: list[list[Cell]] = [[c.label, fixed(_largest(c.values), *ACCELERATION.units, 0)] for c in curves]
    peaks = Table(f"Largest acceleration at {name} by route", ["route", headed("peak", *ACCELERATION.units)], rows)
    return Section(
        "Routes of the paper compared with the exact solution",
        _ROUTES,
        [
            Picture(traces(f"Acceleration at {name} by four routes", curves, "g", since), f"Acceleration at {name}."),
            *([peaks] if quoted else []),
        ],
    )


def _largest(values: Any) -> float:
    finite = values[np.isfinite(values)]
    return float(finite[np.argmax(np.abs(finite))]) if finite.size else math.nan


def sensor_part(channels: Sequence[SensorChannel], picture: Figure, readings: Table) -> Section:
    """Show the readings of the sensors, describe them, and list the loss by their buffers."""
    described: list[list[Cell]] = []
    for sensor, _, recorder in channels:
        stated = (sensor.resonance, sensor.range, recorder.sampling_rate, recorder.cutoff)
        described.append(
            [
                sensor.name,
                "direct" if sensor.mounting.direct else f"{len(sensor.mounting.gaskets)} gaskets",
                *(
                    "none" if math.isinf(value) else written(shown(value, *of.units), 4)
                    for value, of in zip(stated, _RECORDED.values(), strict=True)
                ),
                str(recorder.bits or NONE),
            ]
        )
    described_by = ["sensor", "mounting", *(headed(name, *of.units) for name, of in _RECORDED.items()), "bits"]
    caption = "Sensor readings as recorded: with mounting, resonance, range, filter, sampling and bits."
    parts: list[Part] = [
        Picture(picture, caption),
        readings,
        Table("Sensors and their recorders", described_by, described),
    ]
    buffered = [channel.sensor for channel in channels if not channel.sensor.mounting.direct]
    if buffered:
        frequency = np.geomspace(1e3, 1e5, 201)
        curves = [(sensor.name, frequency, loss_of(sensor.mounting, frequency)) for sensor in buffered]
        caption = "Insertion loss: how much the buffer reduces the motion below it; negative where it amplifies."
        parts += [Picture(insertion_loss(curves), caption), *loss_tables(channels)]
    return Section("Sensors", "", parts)


def loss_tables(channels: Sequence[SensorChannel]) -> list[Table]:
    """List the insertion loss of the buffered sensors; no table where none is buffered."""
    rows: list[list[Cell]] = [
        [sensor.name, *(f"{value:.1f}" for value in loss_of(sensor.mounting, np.array(LOSS_FREQUENCIES)))]
        for sensor, _, _ in channels
        if not sensor.mounting.direct
    ]
    heads = ["sensor", *(amount(KILOHERTZ, f) for f in LOSS_FREQUENCIES)]
    return [Table("Insertion loss (dB; negative where the mounting amplifies)", heads, rows)][: len(rows)]
