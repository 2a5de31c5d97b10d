"""Figures of records in tables: names of files, units, numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from strikewave.analyses.record.figures.records import figure_unit
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting.parts import NONE, Cell, Tag, written

Row = tuple[FileReading, ChannelReading]
Names = Mapping[str, str]  # short names of files by their path


LOOKS = {"good": "good", "suspect": "warned", "bad": "bad"}  # how a status, or a severity, looks on a page


def status_tag(status: str, words: str = "") -> Tag:
    """Return a status as a tag, or other words in its look."""
    return Tag(words or status, LOOKS[status])


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """Return for each path the shortest end that no other path shares."""
    parts = {path: [part for part in re.split(r"[/\\]", path) if part] or [path] for path in paths}
    names: dict[str, str] = {}
    for path, own in parts.items():
        others = [other for other in parts if other != path and parts[other][-1] == own[-1]]
        length = 1
        while length < len(own) and any(parts[other][-length:] == own[-length:] for other in others):
            length += 1
        names[path] = "/".join(own[-length:])
    return names


def rows_of(files: Sequence[FileReading]) -> list[Row]:
    """Return every channel with its file."""
    return [(file, reading) for file in files for reading in file.channels]


def figure_text(name: str, unit: str, value: float, digits: int = 4) -> str:
    """Write a figure of a channel with its unit.

    Examples
    --------
    >>> figure_text("peak", "m/s^2", 49033.25), figure_text("width", "N", 2e-4), figure_text("peak", "", 3.0)
    ('5000 g', '200 µs', '3')
    """
    text = number(name, unit, value, digits)
    shown = figure_unit(name, unit)[2]
    return text if text == NONE or (name == "peak" and not unit) else f"{text} {shown}"


def plus_minus(name: str, unit: str, value: float, doubt: float) -> str:
    """Write a figure of a channel with its standard uncertainty.

    Examples
    --------
    >>> plus_minus("peak", "m/s^2", 49033.25, 98.0665)
    '5000 g ± 10 g'
    """
    return f"{figure_text(name, unit, value)} ± {figure_text(name, unit, doubt, 2)}"


def number(name: str, unit: str, value: float, digits: int = 4) -> str:
    """Write a figure of a channel in its shown unit, without it."""
    return written(value / figure_unit(name, unit)[0], digits)


class Columns:
    """Columns of figures: with the unit in the head where all channels share it, else in each cell."""

    def __init__(self, names: Sequence[str], units: Sequence[str]) -> None:
        self.names = names
        heads_of = {name: {figure_unit(name, unit)[1:] for unit in units} for name in names}
        self.shared = {name: len(pairs) == 1 for name, pairs in heads_of.items()}
        self.heads = []
        for name, pairs in heads_of.items():
            what, unit = next(iter(pairs)) if self.shared[name] else (name.replace("_", " "), "")
            self.heads.append(f"{what} ({unit})" if unit else what)

    def cells(self, values: Mapping[str, float], unit: str) -> list[str]:
        """Write the values of a row; a dash where there is none."""
        return [
            (number if self.shared[name] else figure_text)(name, unit, values.get(name, float("nan")))
            for name in self.names
        ]


def called(name: str, unit: str) -> str:
    """Return what a figure of a channel is called."""
    return figure_unit(name, unit)[1]


def between(name: str, unit: str, low: float, high: float) -> str:
    """Write bounds of a figure.

    Examples
    --------
    >>> between("width", "m/s^2", 1e-4, 2e-4)
    '100 to 200 µs'
    """
    digits = digits_of(low, high)
    return f"{number(name, unit, low, digits)} to {figure_text(name, unit, high, digits)}"


def digits_of(low: float, high: float) -> int:
    """Return how many digits tell two bounds apart, four at least.

    Examples
    --------
    >>> digits_of(1.0, 2.0), digits_of(3.9998, 4.0002)
    (4, 6)
    """
    largest = max(abs(low), abs(high))
    if not (math.isfinite(largest) and high > low):
        return 4
    return min(max(math.floor(math.log10(largest / (high - low))) + 2, 4), 9)


def percents(share: float, digits: int = 3) -> str:
    """Write a share in percent; a dash where there is none.

    Examples
    --------
    >>> percents(0.02512), percents(float("nan"))
    ('2.51 %', '–')
    """
    return f"{written(100.0 * share, digits)} %" if math.isfinite(share) else NONE


def units_of(rows: Sequence[Row]) -> list[str]:
    """Return the SI unit of each channel."""
    return [reading.channel.unit for _, reading in rows]


def squeezed(
    heads: Sequence[str], rows: Sequence[Sequence[Cell]], names: Sequence[str]
) -> tuple[list[str], list[list[Cell]], str]:
    """Take columns that say the same in every row out of a table; return words for its caption."""
    places = [heads.index(name) for name in names]
    gone = [k for k in places if len(rows) > 1 and len({str(row[k]) for row in rows}) == 1]
    words = "".join(f", {heads[k]} {rows[0][k]}" for k in gone)
    left = [k for k in range(len(heads)) if k not in gone]
    return [heads[k] for k in left], [[row[k] for k in left] for row in rows], words
