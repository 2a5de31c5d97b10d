"""An explicit run as a page that plays by itself and as a GIF: the bodies cut open, beside force and acceleration."""

from __future__ import annotations

import base64
import io
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import features
from PIL.Image import Image, fromarray

from strikewave.analyses.fem.figures.cut import (
    QUANTITIES,
    TILT,
    CutQuantity,
    Seen,
    colour_scale,
    draw_body,
    sight,
    window_of,
)
from strikewave.analyses.fem.figures.pictures import frame_window, instant_words
from strikewave.fem.run import blow_axis, mean_acceleration, mean_force, middles
from strikewave.fem.snapshots import Skin, Snapshot, SnapshotRecorder
from strikewave.reporting.animation import (
    Animation,
    Chart,
    Clock,
    ColourScale,
    Panel,
    PlayedCurve,
    PlayedHistory,
    PlayedSpan,
    Scene,
    animation_page,
    even_rows,
    write_gif,
)
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import COLOURS, printable, quiet, shortened, thin

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

Array = NDArray[np.float64]

SNAPSHOTS = 60  # chosen: more than are shown, `TOUCHING` and `APART`
"""Instants kept over the run, and again while bodies touch."""
TOUCHING, APART = 52, 20  # a page plays 72 in ten seconds
"""Most instants shown while bodies touch, and while they are apart."""
LARGEST_PAGE = 850_000  # in base 64 they are 1.13 MB, so that a page fits into a mail
"""Most bytes of all pictures in a page."""
QUALITIES = (82, 65, 45, 25)  # chosen: from unseen loss to blocks
"""Qualities of WebP and JPEG, 0 to 100, tried until the page is small enough."""
COARSE = 2.0  # a frame has about half their pixels across
"""Factor on the size of painted pieces in still pictures."""
LARGEST_SIDES = (860, 640)  # chosen: sharp on a screen 1200 wide, and below `LARGEST_PAGE`
"""Largest sides of a picture, pixels."""
MOST_CURVES = 3  # chosen: their legends, one below the other, fit above it
"""Most curves of a panel."""
WIDE = 0.5
"""Height of a picture over its width below which it stands above the histories, not beside them."""
GIF_PICTURES = 60  # six seconds at ten a second
"""Pictures of a GIF."""
_DPI = 90  # chosen: 790 pixels wide, as a slide shows
"""Resolution of a GIF, dots an inch."""
PANEL_HEIGHT = 98.0  # two with their legends are as high as the bodies beside them
"""Height of a panel of histories, pixels."""
SCALE_COLOURS = 65  # more than an eye tells apart
"""Colours of the colour scale."""
NOTE = (
    "The bodies are cut open; sectors are mirrored to the half. Each element has the colour of its one value; "
    "displacements are to scale. The animation plays slower while bodies touch, as pictures are closer in time there. "
    "Forces are those of whole bodies where marked so, else of what was modelled; accelerations are those of the "
    "bodies."
)


class PanelHistories(NamedTuple):
    """Histories in one panel of the animation: label, unit, and time, s, with values by name."""

    label: str
    unit: str
    curves: Mapping[str, tuple[Array, Array]]


@dataclass(frozen=True)
class Movie:
    """Pictures of the bodies over time, and the histories beside them."""

    time: Array
    """Instants of the pictures, s."""
    images: Sequence[Image]
    """Pictures, all of one size."""
    shown: CutQuantity
    scale: Any
    """Colours of the quantity, a ScalarMappable."""
    width: float
    """Width of the view in a picture, m."""
    extend: str
    """Ends at which values lie beyond the scale, in the words of matplotlib."""
    traces: Sequence[PanelHistories]

    @property
    def wide(self) -> bool:
        """True if the pictures stand above the histories."""
        width, height = self.images[0].size
        return height < WIDE * width


def movie_of(
    solution: FemSolution, quantity: str = "von_mises", progress: Callable[[float], None] | None = None
) -> Movie | None:
    """Return the pictures of a run; None where it kept no instants. ``progress`` takes the share done, 0 to 1."""
    film = solution.film
    stills = shown_snapshots(film) if film is not None else []
    if film is None or not stills:
        return None
    skin, shown = film.skin, QUANTITIES[quantity]
    frame = sight(skin, stills, TILT)
    seen = Seen(frame, window_of(skin, stills, frame, bar=False), coarse=COARSE)
    values = [shown.of(skin, still)[skin.element] / shown.scale for still in stills]
    scale, extend = colour_scale(skin, values, shown)
    draw = _canvas(skin, seen)
    images = []
    for still, cells in zip(stills, values, strict=True):
        images.append(draw(still, scale.to_rgba(cells)[:, :3]))
        if progress is not None:
            progress(len(images) / len(stills))
    time, width = np.array([still.time for still in stills]), (seen.window[1] - seen.window[0]) * 1e-3
    return Movie(time, images, shown, scale, width, extend, traces_of(solution))


def shown_snapshots(film: SnapshotRecorder) -> list[Snapshot]:
    """Return the instants to be shown, in the order of time: most of them while bodies touch."""
    touching = {still.time for still in film.contact.kept}
    apart = [still for still in film.snapshots if still.time not in touching]
    shown = [film.contact.kept[k] for k in even_rows(len(touching), TOUCHING)] if touching else []
    most = APART if shown else TOUCHING + APART
    shown += [apart[k] for k in even_rows(len(apart), most)] if apart else []
    return sorted(shown, key=lambda still: still.time)


def traces_of(solution: FemSolution) -> list[PanelHistories]:
    """Return the contact forces and the rigid-body accelerations along the blow, those that reach farthest.

    Parts of a group move as the group.
    """
    run, groups = solution.run, solution.model.groups
    between = middles(run.time)
    (newton, force_unit), (size, unit) = axis_unit("N", "kN"), axis_unit("m/s^2", "g")
    forces = {shortened(name, 34): np.linalg.norm(mean_force(run, name), axis=1) / newton for name in run.force}
    axis, grouped = blow_axis(run), {part for parts in groups.values() for part in parts}
    bodies = [*groups, *(name for name in run.parts if name not in grouped)]
    rates = {name: mean_acceleration(run, name) @ axis / size for name in bodies}
    return [
        PanelHistories("contact force", force_unit, _curves(between, forces)),
        PanelHistories("rigid-body acceleration along the blow", unit, _curves(between, rates)),
    ]


def _curves(time: Array, values: Mapping[str, Array]) -> dict[str, tuple[Array, Array]]:
    """Return the curves that reach farthest, with no more samples than can be seen."""
    ranked = sorted(values, key=lambda name: -float(np.abs(values[name]).max(initial=0.0)))
    drawn = [name for name in ranked[:MOST_CURVES] if float(np.abs(values[name]).max(initial=0.0)) > 0.0]
    return {printable(shortened(name, 48)): thin(time, values[name]) for name in drawn}


def _canvas(skin: Skin, seen: Seen) -> Callable[[Snapshot, Array], Image]:
    """Return a function that draws the bodies at an instant in the colours of their faces."""
    left, right, low, high = seen.window
    each = min(LARGEST_SIDES[0] / (right - left), LARGEST_SIDES[1] / (high - low))
    size = (max(round(each * (right - left)), 80), max(round(each * (high - low)), 60))
    figure = Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    canvas = FigureCanvasAgg(figure)

    def draw(still: Snapshot, colours: Array) -> Image:
        figure.clear()
        draw_body(figure.add_axes((0.0, 0.0, 1.0, 1.0)), skin, still, seen, colours, bar=False)
        canvas.draw()
        return fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())

    return draw


def fem_page(movie: Movie, title: str, name: str = "") -> str:
    """Return a page that plays the pictures beside the histories, which grow with time; it stands alone."""
    return animation_page(fem_animation(movie), title, name)


def fem_animation(movie: Movie) -> Animation:
    """Return the pictures as frames in one scene, and the histories in a chart beside it, or below wide pictures."""
    time = np.array([float(f"{t:.7g}") for t in movie.time])
    pixels = movie.images[0].size
    limits = (float(movie.scale.norm.vmin), float(movie.scale.norm.vmax))
    colours = movie.scale.to_rgba(np.linspace(*limits, SCALE_COLOURS), bytes=True)[:, :3]
    label = f"{movie.shown.words} ({movie.shown.unit})"
    bodies = Scene(
        "body",
        f"The bodies cut open, coloured by {movie.shown.words}; the time is written below.",
        "",
        (0.0, movie.width, 0.0, movie.width * pixels[1] / pixels[0]),
        ColourScale(label, limits, ["#" + bytes(row).hex() for row in colours], movie.extend),
    )
    histories = Chart(
        "traces",
        "Contact force and rigid-body acceleration up to the time that is shown; their values are written below.",
        "time",
        "time",
        PANEL_HEIGHT,
        [
            Panel(
                trace.label,
                trace.unit,
                [
                    PlayedCurve(name, colour, [PlayedHistory(instants, values)])
                    for (name, (instants, values)), colour in zip(trace.curves.items(), COLOURS, strict=False)
                ],
            )
            for trace in movie.traces
        ],
    )
    return Animation(
        kicker="Impact of bodies, explicit finite elements",
        note=NOTE,
        gif="animation.gif",
        clock=Clock.of(time),
        views=[PlayedSpan("whole", "whole run", time)],
        canvases=[bodies, histories],
        beside=0 if movie.wide else 2,
        pictures=_encoded(movie.images),
    )


def _encoded(images: Sequence[Image]) -> list[str]:
    """Return pictures as data addresses, of the best quality that keeps them small enough."""
    kind = "webp" if features.check("webp") else "jpeg"
    method = {"method": 4} if kind == "webp" else {}  # chosen: the default of Pillow
    files: list[bytes] = []
    for quality in QUALITIES:
        buffers = [io.BytesIO() for _ in images]
        for image, buffer in zip(images, buffers, strict=True):
            image.save(buffer, kind.upper(), quality=quality, **method)
        files = [buffer.getvalue() for buffer in buffers]
        if sum(map(len, files)) <= LARGEST_PAGE:
            break
    return [f"data:image/{kind};base64," + base64.b64encode(file).decode("ascii") for file in files]


def write_fem_gif(movie: Movie, title: str, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write the animation as a GIF, which any slide or page can show."""
    figure, show = _moving(movie, title)
    write_gif(path, figure, show, even_rows(len(movie.time), GIF_PICTURES).tolist(), progress)


def _moving(movie: Movie, title: str) -> tuple[Any, Callable[[int], None]]:
    """Return a figure of the bodies and the histories, and the function that sets it to a picture."""
    width, height = movie.images[0].size
    share = height / width
    size = (8.4, 3.6 + 7.2 * share) if movie.wide else (8.8, float(np.clip(4.6 * share + 0.9, 3.6, 5.6)))
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
    figure.suptitle(textwrap.fill(printable(title), 95), x=0.01, ha="left", fontsize=10, parse_math=False)
    ratios = [share * 7.2, 1.4, 1.4]
    grid = (
        figure.add_gridspec(3, 1, height_ratios=ratios)
        if movie.wide
        else figure.add_gridspec(2, 2, width_ratios=(6, 4))
    )
    places = [grid[0], grid[1], grid[2]] if movie.wide else [grid[:, 0], grid[0, 1], grid[1, 1]]
    extent, below = (0.0, 1e3 * movie.width, 0.0, 1e3 * movie.width * share), 80.0 * movie.width * max(share, 1.0)
    body, *panels = (figure.add_subplot(place) for place in places)
    frame_window(body, (*extent[:2], -below, extent[3]))
    picture = body.imshow(np.asarray(movie.images[0]), extent=extent, interpolation="bilinear")
    clock = body.set_title("0", loc="left", fontsize=9, family="monospace")
    bar = figure.colorbar(movie.scale, ax=body, shrink=0.8, pad=0.01, aspect=26, extend=movie.extend)
    bar.set_label(f"{movie.shown.words} ({movie.shown.unit})", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    grown = [curve for axes, trace in zip(panels, movie.traces, strict=True) for curve in _history(axes, trace, movie)]
    second, _ = axis_unit("s", "us")
    panels[-1].set_xlabel(headed("time", "s", "us"), fontsize=8)

    def show(k: int) -> None:
        now = float(movie.time[k])
        picture.set_data(np.asarray(movie.images[k]))
        clock.set_text(f"t = {instant_words(now)}")
        for line, time, values in grown:
            past = time <= now
            line.set_data(time[past] / second, values[past])

    return figure, show


def _history(axes: Any, trace: PanelHistories, movie: Movie) -> list[tuple[Any, Array, Array]]:
    """Draw the curves of a panel in grey, and return those that grow over them with their time and values."""
    quiet(axes, "", "", "")
    axes.set_title(f"{trace.label} ({trace.unit})", loc="left", fontsize=8)
    axes.tick_params(labelsize=7)
    second, _ = axis_unit("s", "us")
    axes.set_xlim(0.0, float(movie.time[-1]) / second or 1.0)
    grown = []
    for (name, (time, values)), colour in zip(trace.curves.items(), COLOURS, strict=False):
        axes.plot(time / second, values, color="#D0D0D0", linewidth=0.9)
        (line,) = axes.plot([], [], color=colour, linewidth=1.4, label=name)
        grown.append((line, time, values))
    if grown:
        for text in axes.legend(frameon=False, fontsize=6.5, loc="best").get_texts():
            text.set_parse_math(False)
    return grown
