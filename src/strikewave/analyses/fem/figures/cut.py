"""Bodies of an explicit run cut open: whole, close up where they touch, and as a wave runs through them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.pictures import (
    SMALLEST_LINED,
    WIDEST,
    Camera,
    as_vector,
    frame_window,
    instant_words,
    paint_faces,
)
from strikewave.fem.snapshots import Skin, Snapshot
from strikewave.fem.solids import von_mises
from strikewave.reporting.numbers import ShownQuantity

Array = NDArray[np.float64]
Window = tuple[float, float, float, float]

TILT = 0.3  # chosen: 17 degrees show tops, and shorten lengths 4 %
"""Tangent of the eye's height above the normal of the cut."""
SLENDER = 2.5  # chosen: upright it would fill a screen and leave most of its width empty
"""Height of a picture over its width from which on it is laid down, or set in more columns."""
COVERED, LOADED = 0.99, 1e-4
"""Share of the loaded surface within the scale of colours over all instants: a single element at an edge would else
darken all others; share of the largest value of a loaded face: faces before the wave would else fill the 99 %."""
EDGEWISE = 0.03  # 1.7 degrees, less than the facets of a round body turn from one to the next
"""Cosine of the angle with the line of sight below which a face makes no outline."""
# Chosen: on a Hertzian contact p = p0 (1 - r²/a²)^½ this is r < 0.95 a, so that the reach of the picture follows the
# radius a.
PRESSED = 0.3
"""Share of the largest pressure above which a face counts as pressed."""
FACES_ACROSS = 12.0  # chosen: 24 elements across show a gradient
"""Smallest reach of a close-up over the size of the pressed faces."""
# Chosen: the largest shear stress below a contact, at about half its radius, and the free surface beside it are seen.
AROUND = 2.0
"""Smallest reach of a close-up over that of the pressed faces."""
ZONE_COARSE = 4.0  # its faces are large, and few lie behind one another
"""Factor on the size of the pieces of a close-up."""


class Seen(NamedTuple):
    """View of bodies that are cut open."""

    frame: Array
    """Unit vectors to the right, up and toward the eye, (3, 3)."""
    window: Window
    """Limits of the view, left, right, low, high, mm."""
    lined: float = SMALLEST_LINED
    """Smallest share of the larger side of the window at which a face has mesh lines."""
    coarse: float = 1.0
    """Factor on the usual size of the pieces that faces are painted in."""


@dataclass(frozen=True)
class CutQuantity(ShownQuantity):
    """A quantity shown in colours: its words, its colours, and its values from a still, (elements,)."""

    words: str
    colours: str
    of: Callable[[Skin, Snapshot], Array]

    @property
    def signed(self) -> bool:
        """True if both signs matter, and zero stands in the middle of the scale."""
        return self.colours == "RdBu_r"


def axial_stress(skin: Skin, still: Snapshot) -> Array:
    """Return the stress a . sigma a along the axis of the blow, Pa, tension positive, (elements,)."""
    x, y, z = skin.axis
    weights = np.array([x * x, y * y, z * z, 2 * x * y, 2 * y * z, 2 * z * x])
    return np.asarray(still.stress.astype(float) @ weights)


QUANTITIES: Mapping[str, CutQuantity] = {
    "von_mises": CutQuantity(
        "Pa", "MPa", "von Mises stress", "viridis", lambda skin, still: von_mises(still.stress.astype(float))
    ),
    "plastic_strain": CutQuantity(
        "1", "%", "equivalent plastic strain", "magma_r", lambda skin, still: still.plastic_strain.astype(float)
    ),
    "axial_stress": CutQuantity("Pa", "MPa", "stress along the blow, tension positive", "RdBu_r", axial_stress),
}


@dataclass(frozen=True)
class Zone:
    """Place of a contact: the pressed faces of a skin, and the reach of the view around them, m."""

    faces: NDArray[np.intp]
    reach: float

    def middle(self, skin: Skin, still: Snapshot) -> Array:
        """Return the middle of the faces at an instant, (3,), m, on the plane of the mirror where that is near."""
        place = skin.moved(still.displacement)[skin.faces[self.faces]].mean(axis=(0, 1))
        mirror = skin.cut.mirror
        if mirror is not None and abs(float(mirror.height(place))) < self.reach:
            place = place - mirror.height(place) * mirror.normal
        return np.asarray(place)

    def window(self, skin: Skin, still: Snapshot, frame: Array) -> Window:
        """Return the window at an instant, mm: all pressed faces, and no more void below or above than needed."""
        moved = skin.moved(still.displacement) @ frame.T
        x, y = (frame @ self.middle(skin, still))[:2]
        own = moved[skin.faces[self.faces]][:, :, :2].reshape(-1, 2)
        # a tenth of air (chosen): faces spread as the contact deepens
        reach = max(self.reach, 1.1 * float(np.abs(own - [x, y]).max()))
        beside = moved[np.abs(moved[:, 0] - x) <= reach, 1]
        y = float(
            np.clip(y, beside.min() + 0.75 * reach, max(beside.max() - 0.75 * reach, beside.min() + 0.75 * reach))
        )
        return tuple(1e3 * end for end in (x - reach, x + reach, y - reach, y + reach))  # type: ignore[return-value]


def cut_figure(skin: Skin, stills: Sequence[Snapshot], quantity: str = "von_mises") -> Figure:
    """Draw the bodies cut open at some instants, in one scale of colours for one of `QUANTITIES`."""
    shown = QUANTITIES[quantity]
    frame = sight(skin, stills, TILT)
    window = window_of(skin, stills, frame)
    aspect = _aspect(window)
    columns = 1 if aspect < 1 / SLENDER else min(len(stills), 2 if aspect < 1.2 else 3)
    return _sheet(skin, stills, Seen(frame, window), (shown, columns))


def wave_figure(skin: Skin, stills: Sequence[Snapshot], quantity: str = "axial_stress") -> Figure:
    """Draw the bodies cut open at the instants that follow the wave, straight onto the cut, in one scale of colours."""
    shown = QUANTITIES[quantity]
    frame = sight(skin, stills, 0.0, lying=False)
    window = window_of(skin, stills, frame)
    aspect = _aspect(window)
    columns = 1 if aspect < 0.15 else 2 if aspect < 0.4 else 4 if aspect < SLENDER else 8
    return _sheet(skin, stills, Seen(frame, window, np.inf), (shown, min(columns, len(stills))))


def close_up_figure(skin: Skin, zone: Zone, pictures: Sequence[tuple[Snapshot, str]]) -> Figure:
    """Draw a contact from near, straight onto the cut: an instant, a quantity and a scale for each picture."""
    frame = sight(skin, [], 0.0, lying=False)
    figure = Figure(figsize=(4.9 * len(pictures), 4.1), dpi=160, layout="constrained")
    for axes, (still, name) in zip(figure.subplots(1, len(pictures), squeeze=False).ravel(), pictures, strict=True):
        shown = QUANTITIES[name]
        window = zone.window(skin, still, frame)
        values = shown.of(skin, still)[skin.element] / shown.scale
        scale = _mappable(shown, _limits(values[_inside(skin, still, frame, window)], None, shown))
        draw_body(axes, skin, still, Seen(frame, window, coarse=ZONE_COARSE), scale.to_rgba(values)[:, :3])
        axes.set_title(instant_words(still.time), loc="left", fontsize=9)
        bar = figure.colorbar(scale, ax=axes, shrink=0.85, pad=0.02, aspect=24)
        bar.set_label(f"{shown.words} ({shown.unit})")
    return figure


def seen_close_up(skin: Skin, zone: Zone, still: Snapshot, name: str) -> Array:
    """Return the values of the faces that a close-up shows of a quantity, in SI."""
    frame = sight(skin, [], 0.0, lying=False)
    inside = _inside(skin, still, frame, zone.window(skin, still, frame))
    return np.asarray(QUANTITIES[name].of(skin, still)[skin.element][inside])


def _sheet(skin: Skin, stills: Sequence[Snapshot], seen: Seen, looks: tuple[CutQuantity, int]) -> Figure:
    """Draw instants in columns, in one scale of colours."""
    shown, columns = looks
    rows, aspect = -(-len(stills) // columns), _aspect(seen.window)
    width = 9.8 if columns > 1 or aspect < 1.0 else 6.4
    height = float(np.clip((width - 1.3) / columns * aspect, 0.9, 5.5)) + 0.3
    figure = Figure(figsize=(width, rows * height), dpi=160, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    values = [shown.of(skin, still)[skin.element] / shown.scale for still in stills]
    scale, extend = colour_scale(skin, values, shown)
    for axes, still, cells in zip(panels, stills, values, strict=False):
        draw_body(axes, skin, still, seen, scale.to_rgba(cells)[:, :3])
        axes.set_title(instant_words(still.time), loc="left", fontsize=9)
    for axes in panels[len(stills) :]:
        axes.set_axis_off()
    bar = figure.colorbar(scale, ax=list(panels), shrink=0.85, pad=0.01, aspect=24, extend=extend)
    bar.set_label(f"{shown.words} ({shown.unit})")
    return figure


def draw_body(axes: Any, skin: Skin, still: Snapshot, seen: Seen, colours: Array, bar: bool = True) -> None:
    """Draw the bodies at an instant with their outlines, in colours by face, and a scale bar below."""
    frame, window, smallest, coarse = seen
    moved = skin.moved(still.displacement) @ frame.T
    corners = moved[skin.faces]
    inside = _within(corners, window)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    facing = normal[:, 2] > EDGEWISE * np.linalg.norm(normal, axis=1)
    ends, sides, sharp = skin.edges
    lined = (
        facing[sides].any(axis=1) & (sharp | (facing[sides[:, 0]] != facing[sides[:, 1]])) & inside[sides].any(axis=1)
    )
    across = max(window[1] - window[0], window[3] - window[2]) * 1e-3
    paint_faces(axes, corners[inside], colours[inside], coarse * across, smallest / coarse, moved[ends[lined]])
    frame_window(axes, window, bar)


def sight(skin: Skin, stills: Sequence[Snapshot], tilt: float, lying: bool = True) -> Array:
    """Return right, up and toward the eye, (3, 3), for a look onto the cut; slender bodies are laid down."""
    normal = skin.cut.plane.normal
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.7 else np.array([1.0, 0.0, 0.0])
    if lying:
        straight = Camera(toward=as_vector(normal), up=as_vector(up)).axes()
        if _aspect(window_of(skin, stills, straight)) > SLENDER:
            up = straight[0] * -1.0
    return Camera(toward=as_vector(normal + tilt * up), up=as_vector(up)).axes()


def window_of(skin: Skin, stills: Sequence[Snapshot], frame: Array, bar: bool = True) -> Window:
    """Return the window that holds the bodies at all instants, left, right, low and high, mm; with room for a bar."""
    flat = np.concatenate([skin.moved(still.displacement) @ frame.T[:, :2] for still in stills]) * 1e3
    (left, low), (right, high) = flat.min(axis=0), flat.max(axis=0)
    largest = max(right - left, high - low, 1e-9)
    aside = max(0.02 * largest, 0.5 * (largest / WIDEST - right + left))
    below = 0.1 * min(largest, 2.0 * (right - left + 2.0 * aside)) if bar else 0.02 * largest
    return float(left - aside), float(right + aside), float(low - below), float(high + 0.02 * largest)


def colour_scale(skin: Skin, values: Sequence[Array], shown: CutQuantity) -> tuple[Any, str]:
    """Return the scale of colours for values by face at some instants, and at which ends values lie beyond it."""
    corners = skin.points[skin.faces]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)
    low, high = _limits(np.concatenate(values), np.tile(areas, len(values)), shown)
    above, below = (
        any(bool(np.any(sign * cells > sign * end)) for cells in values) for sign, end in ((1, high), (-1, low))
    )
    extend = "both" if above and below else "max" if above else "min" if below else "neither"
    return _mappable(shown, (low, high)), extend


def _limits(values: Array, areas: Array | None, shown: CutQuantity) -> tuple[float, float]:
    """Return the ends of a scale of colours: all values, or what covers `COVERED` of the areas, rounded up."""
    sizes = np.abs(values)
    most = float(sizes.max(initial=0.0))
    if areas is not None and most > 0.0:
        loaded = sizes > LOADED * most
        order = np.argsort(sizes)
        share = np.cumsum(np.where(loaded, areas, 0.0)[order])
        most = float(sizes[order][min(int(np.searchsorted(share, COVERED * share[-1])), len(sizes) - 1)])
    most = round_up(most) if areas is not None and most > 0.0 else most or 1.0
    return (-most, most) if shown.signed else (0.0, most)


def round_up(value: float) -> float:
    """Return the next of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten.

    Examples
    --------
    >>> round_up(7.3), round_up(120.0), round_up(0.04)
    (8.0, 150.0, 0.04)
    """
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return float(f"{power * next(step for step in steps if step * power >= value * (1.0 - 1e-9)):.6g}")


def _mappable(shown: CutQuantity, limits: tuple[float, float]) -> Any:
    return ScalarMappable(Normalize(*limits), shown.colours)


def pressures(skin: Skin, still: Snapshot) -> Array:
    """Return the pressure -n . sigma n on the faces that may touch others, Pa, (faces,); 0 elsewhere."""
    pressure = np.zeros(len(skin.faces))
    own = np.flatnonzero(skin.touching >= 0)
    corners = skin.moved(still.displacement)[skin.faces[own]]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    x, y, z = (normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)).T
    xx, yy, zz, xy, yz, zx = still.stress[skin.element[own]].astype(float).T
    pressure[own] = -(xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + yz * y * z + zx * z * x))
    return np.maximum(pressure, 0.0)


def pressed_most(
    skin: Skin, stills: Sequence[Snapshot], at: float, own: NDArray[np.bool_]
) -> tuple[Snapshot, Zone] | None:
    """Return the instant nearest to ``at``, s, at which ``own`` faces press, and where; None where none does.

    The faces are those above `PRESSED` of the largest pressure, of the side that bears it.
    """
    for still in sorted(stills, key=lambda each: abs(each.time - at)):
        pressure = np.where(own, pressures(skin, still), 0.0)
        if pressure.any():
            return still, _zone(skin, pressure)
    return None


def _zone(skin: Skin, pressure: Array) -> Zone:
    """Return the place of a pressure, (faces,)."""
    worst = int(np.argmax(pressure))
    faces = np.flatnonzero((skin.touching == skin.touching[worst]) & (pressure > PRESSED * pressure[worst]))
    normal = skin.cut.plane.normal
    places = skin.points[skin.faces[faces]]
    flat = places - (places @ normal)[..., None] * normal
    size = float(np.linalg.norm(np.diff(flat, axis=1), axis=2).max(axis=1).mean())
    reach = max(FACES_ACROSS * size, AROUND * 0.5 * float(np.ptp(flat.reshape(-1, 3), axis=0).max()))
    whole = 0.5 * float(np.ptp(skin.points, axis=0).max())
    return Zone(faces, min(reach, whole))


def _within(corners: Array, window: Window) -> NDArray[np.bool_]:
    """Return which faces (faces, 4, 3) reach into a window."""
    left, right, low, high = (end * 1e-3 for end in window)
    x, y = corners[:, :, 0], corners[:, :, 1]
    return np.asarray(
        (x.max(axis=1) >= left) & (x.min(axis=1) <= right) & (y.max(axis=1) >= low) & (y.min(axis=1) <= high)
    )


def _inside(skin: Skin, still: Snapshot, frame: Array, window: Window) -> NDArray[np.bool_]:
    """Return which faces can be seen in a window, but for those behind others."""
    corners = skin.moved(still.displacement)[skin.faces] @ frame.T
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    # within 60 degrees of the line of sight: those that a close-up shows, not the sides of bodies
    return _within(corners, window) & (normal[:, 2] > 0.5 * np.linalg.norm(normal, axis=1))


def _aspect(window: Window) -> float:
    return (window[3] - window[2]) / (window[1] - window[0])
