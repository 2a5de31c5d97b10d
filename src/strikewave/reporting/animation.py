"""Animations: one page with one player for all analyses, and one writer of GIFs; an analysis says what is drawn.

A page that plays an animation by itself: one template, one player; an analysis gives only what is drawn. A *scene*
shows polygons, lines and pictures in space, undistorted; a *chart* shows panels with one axis, time or place. The
page stands alone: script, style and data are inside, and its policy lets nothing else run. It begins to play unless
the reader asks for less motion.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Literal, NamedTuple, TypeVar

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from strikewave._version import __version__
from strikewave.reporting.numbers import time_unit
from strikewave.reporting.style import printable

Array = NDArray[np.float64]
Document = dict[str, object]
"""Content of a JSON document."""

PLAYING_SECONDS = 10.0  # chosen: a slide's worth of patience; a reader can take 1/8 to 8 of it
"""Time that a view plays at speed 1, s."""
SPEEDS = ((0.125, "⅛"), (0.25, "¼"), (0.5, "½"), (1, "1"), (2, "2"), (4, "4"), (8, "8"))
"""Speeds to choose from, and their texts."""
SLIDER_STEPS = 2000  # one for each pixel of a wide screen
"""Steps of the time slider where motion is smooth."""
FULL_SCALE = 32767
"""Full scale of a 16-bit integer: the peak of a field."""
MOST_DECIMALS = 6  # picoseconds, where the unit is the microsecond
"""Decimals of a time at most."""


class Clock(NamedTuple):
    """Form of times: their unit, its size in s, and decimals."""

    unit: str
    per: float
    decimals: int

    @classmethod
    def of(cls, time: Array) -> Clock:
        """Return the clock that tells each of rising times from the next.

        Examples
        --------
        >>> Clock.of(np.array([0.0, 0.4e-6, 20e-6])), Clock.of(np.array([0.0, 1e-3, 1.0])).unit
        (Clock(unit='µs', per=1e-06, decimals=1), 'ms')
        """
        per, unit = time_unit(time[-1])
        steps = np.diff(time)[np.diff(time) > 0.0]
        finest = float(steps.min()) / per if steps.size else 1.0
        return cls(unit, per, int(np.clip(np.ceil(np.round(-np.log10(finest), 6)), 0, MOST_DECIMALS)))


class PlayedSpan(NamedTuple):
    """A stretch of the run that can be played; its key stands in the address of the page."""

    key: str
    label: str
    time: Array
    """Times of the frames, s; where motion is smooth, begin and end are enough."""


class Shape(NamedTuple):
    """A polygon or line of a scene; an empty colour draws nothing."""

    points: Array
    """Corners, m, shape (corners, 2); between moving ends x is the share of the way from the first to the second."""
    fill: str = ""
    edge: str = ""
    width: float = 1.0
    """Width of the edge, pixels."""
    closed: bool = True
    dashes: Sequence[float] = ()
    """Lengths of the dashes of the edge, pixels."""
    turn: str = ""
    """Track of the angle by which it turns about the origin, rad."""
    ends: tuple[tuple[float, str], tuple[float, str]] = ((0.0, ""), (1.0, ""))
    """Place x of each end, m, and the track that moves it, m; an empty name stands still."""

    def document(self) -> Document:
        """Return it as the player reads it."""
        return {**self._asdict(), "points": packed(np.asarray(self.points).ravel(), "<f4")}


class ColourScale(NamedTuple):
    """Colours of the pictures of a scene, from the low to the high limit, and at which ends values lie beyond them.

    ``extend`` is neither, min, max or both, as in matplotlib.
    """

    label: str
    limits: tuple[float, float]
    colours: Sequence[str]
    extend: str


@dataclass(frozen=True)
class Scene:
    """A canvas that shows all shapes and pictures within limits: left, right, bottom, top, m."""

    id: str
    alternative: str
    title: str
    limits: tuple[float, float, float, float]
    colour_scale: ColourScale | None = None
    kind: Literal["scene"] = "scene"

    @property
    def caption(self) -> str:
        """Text below it."""
        return self.title

    def document(self) -> Document:
        """Return it as the player reads it."""
        scale = self.colour_scale
        return {
            "kind": self.kind,
            "id": self.id,
            "title": self.title,
            "limits": self.limits,
            "colour_scale": scale and {**scale._asdict(), "label": printable(scale.label)},
        }


class PlayedHistory(NamedTuple):
    """Values over time, s; the page keeps 4 bytes of the time after ``begin``, so that a late history stays sharp."""

    time: Array
    values: Array
    begin: float = 0.0

    def document(self) -> Document:
        """Return it as the player reads it."""
        time, values = packed(self.time - self.begin, "<f4"), packed(self.values, "<f4")
        return {"begin": self.begin, "time": time, "values": values}


class PlayedCurve(NamedTuple):
    """A curve over time: a history for each view, or one for all, or else a track. One without a name has no legend."""

    name: str
    colour: str
    histories: Sequence[PlayedHistory] = ()
    track: str = ""

    def document(self) -> Document:
        """Return it as the player reads it."""
        histories = [history.document() for history in self.histories]
        return {"name": printable(self.name), "colour": self.colour, "track": self.track, "histories": histories}


class FieldCurve(NamedTuple):
    """A curve over place that changes with time: values (frames, places), filled above and below zero."""

    colour: str
    above: str
    below: str
    values: Array

    def document(self) -> Document:
        """Return it as the player reads it: 16 bits a value."""
        counts, peak = quantised(self.values)
        colours = {"colour": self.colour, "above": self.above, "below": self.below}
        return {"name": "", **colours, "peak": peak, "counts": packed(counts, "<i2")}


@dataclass(frozen=True)
class Panel:
    """Curves with one axis of values."""

    name: str
    unit: str
    curves: Sequence[PlayedCurve | FieldCurve]
    per: float = 1.0
    """Size of the unit in that of the values."""
    label: str = ""
    """Label above the panel; name and unit if empty."""
    limits: tuple[float, float] | None = None
    """Limits of the axis; the range of the values in view where None."""
    zero: bool = True
    """True if the axis shows zero, where it has no limits."""
    least: float = 0.0
    """Span of the axis at least."""
    decimals: int | None = None
    """Decimals of the values; three digits where None."""

    def document(self) -> Document:
        """Return it as the player reads it."""
        label, curves = self.label or f"{self.name} ({self.unit})", [curve.document() for curve in self.curves]
        return {**vars(self), "label": label, "curves": curves}


@dataclass(frozen=True)
class Chart:
    """A canvas of panels below one another over time or place; ``height`` is that of one, pixels at most."""

    id: str
    alternative: str
    axis: Literal["time", "place"]
    label: str
    height: float
    panels: Sequence[Panel]
    kind: Literal["chart"] = "chart"
    caption: str = ""

    def document(self) -> Document:
        """Return it as the player reads it."""
        named = {name: getattr(self, name) for name in ("kind", "id", "axis", "label", "height")}
        return {**named, "panels": [panel.document() for panel in self.panels]}


class LayerBand(NamedTuple):
    """A layer behind a chart over place: where it lies, m, its grey, 0 to 255, and how the joint before it is drawn."""

    name: str
    begin: float
    end: float
    grey: int
    joint: Literal["", "dashed", "thick"] = ""


class PlaceMark(NamedTuple):
    """A place with a name, m."""

    name: str
    position: float


@dataclass(frozen=True)
class PlaceAxis:
    """The axis of charts over place: positions, m, the band of each, the one that is read first, marked ones."""

    position: Sequence[float]
    band: Sequence[int]
    bands: Sequence[LayerBand]
    marks: Sequence[PlaceMark]
    start: int
    unit: str
    per: float

    def document(self) -> Document:
        """Return it as the player reads it."""
        bands = [{**band._asdict(), "name": printable(band.name)} for band in self.bands]
        marks = [{**mark._asdict(), "name": printable(mark.name)} for mark in self.marks]
        lists = {"position": list(self.position), "band": list(self.band), "bands": bands, "marks": marks}
        return {"unit": self.unit, "per": self.per, "start": self.start, **lists}


class Readout(NamedTuple):
    """A track that is written below the pictures: its value beyond ``zero``."""

    name: str
    unit: str
    track: str
    per: float
    decimals: int
    zero: float = 0.0


class Event(NamedTuple):
    """An event at a time, s, with its label, and the words that the time since then counts from."""

    time: float
    label: str
    since: str


@dataclass(frozen=True)
class Animation:
    """A run that a page plays."""

    kicker: str
    """Kind of run, above the title."""
    note: str
    """Words below the controls: how the pictures are to be read."""
    gif: str
    """File in which the same run is found where no script runs."""
    clock: Clock
    views: Sequence[PlayedSpan]
    canvases: Sequence[Scene | Chart]
    beside: int = 0
    """Number of canvases that share the first line of a wide screen."""
    smooth: bool = False
    """True if there is motion between the times of a view; else each of them is one frame."""
    tracks: Mapping[str, Array] | None = None
    """Values that move shapes, over the track ``time``, s."""
    shapes: Sequence[Shape] = ()
    pictures: Sequence[str] = ()
    """Picture of every frame that fills the scenes, as an address that holds it (data:)."""
    readouts: Sequence[Readout] = ()
    events: Sequence[Event] = ()
    no_event: str = ""
    """Text before the first event; no events are written where it is empty."""
    places: PlaceAxis | None = None

    def document(self) -> Document:
        """Return the data of the player; times in s."""
        kinds = {"time": "<f8"}
        return {
            "playing_seconds": PLAYING_SECONDS,
            "clock": self.clock._asdict(),
            "smooth": self.smooth,
            "views": [{**view._asdict(), "time": np.asarray(view.time).tolist()} for view in self.views],
            "tracks": {name: packed(track, kinds.get(name, "<f4")) for name, track in (self.tracks or {}).items()},
            "shapes": [shape.document() for shape in self.shapes],
            "pictures": list(self.pictures),
            "canvases": [canvas.document() for canvas in self.canvases],
            "readouts": [readout._asdict() for readout in self.readouts],
            "events": [event._asdict() for event in self.events],
            "no_event": self.no_event,
            "places": self.places and self.places.document(),
        }


def animation_page(animation: Animation, title: str, name: str = "") -> str:
    """Return an animation as a page that stands alone, headed by a title and the name of the case, in plain text."""
    folder = resources.files("strikewave.reporting") / "player"
    script, style = ((folder / name).read_text("utf-8") for name in ("player.js", "style.css"))
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, keep_trailing_newline=True)
    return environment.from_string((folder / "page.html").read_text("utf-8")).render(
        animation=animation,
        title=printable(title),
        name=printable(name),
        version=__version__,
        speeds=SPEEDS,
        last_step=SLIDER_STEPS if animation.smooth else len(animation.views[0].time) - 1,
        style=Markup(style),  # our own, no input
        script=Markup(script),
        style_hash=Markup(_source_hash(style)),
        script_hash=Markup(_source_hash(script)),
        data=Markup(script_safe(json.dumps(animation.document(), allow_nan=False, separators=(",", ":")))),
    )


def packed(values: ArrayLike, kind: str) -> str:
    """Return an array as base 64 of numbers of a kind, such as ``<f4``.

    Examples
    --------
    >>> packed([1.0, 2.0], "<f4")
    'AACAPwAAAEA='
    """
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode("ascii")


def quantised(values: Array) -> tuple[NDArray[np.int16], float]:
    """Return values as 16-bit shares of their largest magnitude, and that magnitude, 1 where all are zero.

    Examples
    --------
    >>> quantised(np.array([[-2.0, 1.0]]))
    (array([[-32767,  16384]], dtype=int16), 2.0)
    """
    peak = float(np.abs(values).max(initial=0.0)) or 1.0
    return np.rint(values / peak * FULL_SCALE).astype(np.int16), peak


def script_safe(text: str) -> str:
    r"""Return JSON that cannot end the script element it stands in.

    Examples
    --------
    >>> script_safe('"</script><!--"')
    '"\\u003c/script\\u003e\\u003c!--"'
    """
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def even_rows(count: int, most: int) -> NDArray[np.int64]:
    """Return evenly chosen rows, at most so many, the first and the last one among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _source_hash(text: str) -> str:
    """Return the hash by which a content security policy knows a script or a style sheet."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


Frame = TypeVar("Frame")

FRAMES_PER_SECOND = 10  # exact: GIFs count in hundredths of a second, and browsers slow down below 2
"""Frames of a GIF in a second."""
PALETTE_FRAMES = 4  # evenly over the film, as moving parts change its colours little
"""Frames from which the palette is taken."""
COLOURS, EXACT_COLOURS = 256, 16  # as many as a GIF can hold; chosen: white, the axes and each curve
"""Colours of the palette of all frames, and the commonest of them, which are exact."""
APART = 10.4  # Pillow looks up the colour nearest to the corner of a cube of side 4, up to 5.2 from the colour itself
"""Distance of other colours from exact ones."""


def write_gif(
    path: Path,
    figure: Figure,
    show: Callable[[Frame], None],
    frames: Sequence[Frame],
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write a figure that moves as a GIF that plays for ever, with one palette, so that still parts do not flicker.

    ``show`` brings the figure to one of the frames, of which there is one at least; the layout of the figure is made
    once. ``progress`` takes the share that is done, 0 to 1.
    """
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    figure.set_layout_engine("none")

    def drawn(frame: Frame) -> Image.Image:
        show(frame)
        canvas.draw()
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())

    palette = _palette([drawn(frames[row]) for row in even_rows(len(frames), PALETTE_FRAMES)])

    def film() -> Iterator[Image.Image]:
        for done, frame in enumerate(frames, 1):
            yield drawn(frame).quantize(palette=palette, dither=Image.Dither.NONE)
            if progress is not None:
                progress(done / len(frames))

    pictures = film()
    duration = round(1000 / FRAMES_PER_SECOND)
    next(pictures).save(path, "GIF", save_all=True, append_images=pictures, duration=duration, loop=0)


def _palette(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return the commonest colours of pictures, and others that cover all the rest."""
    pixels = np.concatenate([np.asarray(picture) for picture in pictures])
    colours, counts = np.unique(pixels.reshape(-1, 3), axis=0, return_counts=True)
    exact = colours[[int(np.argmax(counts))]]
    for colour in colours[np.argsort(-counts)][:COLOURS]:
        if len(exact) < EXACT_COLOURS and np.linalg.norm(exact - colour.astype(float), axis=1).min() > APART:
            exact = np.vstack([exact, colour])
    covering = Image.fromarray(pixels).quantize(COLOURS - EXACT_COLOURS, Image.Quantize.MAXCOVERAGE)
    others = np.array(covering.getpalette() or [], np.uint8).reshape(-1, 3)
    far = np.linalg.norm(others[:, None].astype(float) - exact, axis=2).min(axis=1) > APART
    palette = Image.new("P", (1, 1))
    palette.putpalette(exact.tobytes() + others[far].tobytes())
    return palette
