"""One writer of GIFs, which any slide or page can show."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from strikewave.reporting.animation.page import even_rows

Frame = TypeVar("Frame")

FRAMES_PER_SECOND = 10
"""GIFs count in hundredths of a second, and browsers slow down those of less than 2: 10 is exact everywhere."""
PALETTE_FRAMES = 4
"""Frames from which the palette is taken: evenly over the film, as what moves changes colours little."""
COLOURS, EXACT_COLOURS = 256, 16
"""Of the one palette of all frames, as many as a GIF can hold; the commonest of them, such as white, are exact."""
APART = 10.4
"""Distance of other colours from exact ones: Pillow looks up the colour nearest to the corner of a cube of side 4,
which is up to 5.2 from the colour that is meant."""


def write_gif(
    path: Path,
    figure: Figure,
    show: Callable[[Frame], None],
    frames: Sequence[Frame],
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write a figure that moves as a GIF that plays for ever, with one palette, so that still parts do not flicker.

    Parameters
    ----------
    path : Path
        Where it is written.
    figure : Figure
        Its size and resolution are those of the GIF; its layout is made once.
    show : callable
        Brings the figure to a frame.
    frames : sequence
        What ``show`` takes; at least one.
    progress : callable, optional
        Called with the share that is done, 0 to 1.
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
