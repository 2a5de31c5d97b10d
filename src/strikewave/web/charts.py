"""Diagrams of the pages in the colours of the reports, as plain options of ECharts, and their curves."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from strikewave.reporting.numbers import round_step
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, thin

COLOURS = (BLUE, RED, GREEN, ORANGE, GREY)
KIND_COLOURS = {"full": BLUE, "double": RED, "glancing": ORANGE, "missed": GREY}
DASHES = ("solid", "dashed")
MOST_CURVES = len(COLOURS) * len(DASHES)
"""Curves of a diagram that colour and dash tell apart."""
SHAPES = ("circle", "diamond", "triangle", "rect", "pin")
INK, SOFT, LINE = "#1a1f24", "#4d5760", "#e4e4e4"
PALE_BAND = "rgba(0, 114, 178, 0.10)"
BELOW_LEGEND = 60
"""Pixels from the upper edge of a diagram to its axes, so that names of curves touch no number."""
NUMBERS = {"fontSize": 10, "lineHeight": 12, "hideOverlap": True}
"""Numbers at an axis; one that would touch the next is left out. Their height is stated, since ECharts takes the width
of a Chinese letter for it, too little where no font has that letter."""
MARKS = 8
"""Rough number of marks of an axis."""
BESIDE_TOOLS = "84%"
"""Largest width of the names of curves: the button that saves a picture stands beside them."""


def colour(place: int) -> str:
    """Return the colour of a curve by its place; colours begin anew after the last."""
    return COLOURS[place % len(COLOURS)]


def dash(place: int) -> str:
    """Return the dash of a curve by its place: another one where the colours begin anew.

    Examples
    --------
    >>> colour(0) == colour(5), dash(0), dash(5)
    (True, 'solid', 'dashed')
    """
    return DASHES[place // len(COLOURS) % len(DASHES)]


class ChartLine(NamedTuple):
    """A curve: its name, points (x, y), colour and dash (``solid``, ``dashed``, ``dotted``)."""

    name: str
    points: Sequence[Sequence[float]]
    colour: str = BLUE
    dash: str = "solid"


class MarkedSpan(NamedTuple):
    """A marked piece of the axis of time, with its name."""

    name: str
    begin: float
    end: float


def line_chart(
    title: str,
    x: str,
    y: str,
    lines: Sequence[ChartLine],
    *,
    log: bool = False,
    log_y: bool = False,
    spans: Sequence[MarkedSpan] = (),
    zoom: bool = False,
) -> dict[str, Any]:
    """Return a diagram of curves, with a description for screen readers.

    Examples
    --------
    >>> line_chart("Force", "time (µs)", "force (kN)", [ChartLine("blow 1", [[0.0, 1.0]])])["xAxis"]["name"]
    'time (µs)'
    """
    series = [
        {
            "name": line.name,
            "type": "line",
            "data": line.points,
            "showSymbol": False,
            "lineStyle": {"width": 1.6, "color": line.colour, "type": line.dash},
            "itemStyle": {"color": line.colour},
        }
        for line in lines
    ]
    if spans and series:
        series[0]["markArea"] = {
            "silent": True,
            "itemStyle": {"color": PALE_BAND},
            "label": {"color": SOFT, "fontSize": 10, "position": "insideTop"},
            "data": [[{"name": span.name, "xAxis": span.begin}, {"xAxis": span.end}] for span in spans],
        }
    options = _frame(title, x, y, "log" if log else "value", "log" if log_y else "value")
    if zoom:
        slider = {"type": "slider", "height": 14, "bottom": 8, "moveHandleSize": 4}
        options["dataZoom"] = [{"type": "inside", "filterMode": "none"}, slider]
        options["grid"]["bottom"] = 66
    return _named({**options, "series": series})


class Dots(NamedTuple):
    """A group of dots: its name, and for each dot x, y and further values for a click."""

    name: str
    dots: Sequence[Sequence[float]]


def dot_chart(title: str, x: str, y: str, groups: Sequence[Dots]) -> dict[str, Any]:
    """Return dots by groups, which differ in colour and in shape."""
    series = [
        {
            "name": group.name,
            "type": "scatter",
            "data": list(group.dots),
            "symbol": SHAPES[k % len(SHAPES)],
            "symbolSize": 9,
            "itemStyle": {"color": colour(k), "opacity": 0.75},
        }
        for k, group in enumerate(groups)
    ]
    options = _frame(title, x, y, "value", "value")
    options["tooltip"]["trigger"] = "item"
    options["yAxis"]["scale"] = True
    named = _named({**options, "series": series})
    named["legend"] |= {"itemWidth": 9, "itemHeight": 9}  # as the dots are
    return named


def train_chart(title: str, unit: str, bars: Sequence[Sequence[Any]], band: Sequence[float] | None) -> dict[str, Any]:
    """Return the peaks of a train of blows as bars, coloured by their kinds, before the band of the later ones."""
    options = _frame(title, "blow", f"rigid peak ({unit})", "category", "value")
    options["xAxis"]["data"] = [str(index) for index, _, _ in bars]
    kinds = list(dict.fromkeys(kind for _, _, kind in bars))
    drawn: dict[str, Any] = {
        "name": "rigid peak",
        "type": "bar",
        "barMaxWidth": 26,
        "itemStyle": {"color": BLUE},
        "data": [
            {"value": peak, "itemStyle": {"color": KIND_COLOURS.get(kind, GREY)}, "name": kind}
            for _, peak, kind in bars
        ],
    }
    if band is not None:
        drawn["markArea"] = {
            "silent": True,
            "itemStyle": {"color": PALE_BAND},
            "data": [[{"yAxis": band[0], "name": "95 % band of the later blows"}, {"yAxis": band[1]}]],
            "label": {"color": SOFT, "fontSize": 10, "position": "insideTop"},
        }
    series = [drawn]
    if len(kinds) > 1 or kinds not in ([], ["full"]):
        options["title"]["text"] = f"{title}: {', '.join(kinds)}"
    return {**options, "series": series}


def round_ends(low: float, high: float) -> tuple[float, float]:
    """Return ends of an axis, on its marks, that take in two numbers.

    Examples
    --------
    >>> round_ends(-12.0, 4151.0)
    (-500.0, 4500.0)
    """
    mark = round_step((high - low) / MARKS)
    return math.floor(low / mark) * mark, math.ceil(high / mark) * mark


def with_beside(options: dict[str, Any], beside: dict[str, Any]) -> dict[str, Any]:
    """Return a diagram with the curve of another one of its kind in grey behind it."""
    # cells of a field cannot lie on cells
    if not beside["series"] or options["series"][0]["type"] == "heatmap":
        return options
    grey: dict[str, Any] = {"name": "kept beside", "itemStyle": {"color": "#b6bcc2"}}
    if beside["series"][0]["type"] == "line":
        grey |= {"showSymbol": False, "lineStyle": {"width": 1.6, "color": GREY, "type": "dashed"}, "data": []}
        grey["data"] = beside["series"][0]["data"]
    else:
        grey["data"] = [bar["value"] for bar in beside["series"][0]["data"]]
    shape = {key: value for key, value in beside["series"][0].items() if key in ("type", "barMaxWidth")}
    return _named({**options, "series": [*options["series"], {**shape, **grey}]})


def heat_chart(
    title: str,
    x: str,
    y: str,
    columns: Sequence[str],
    rows: Sequence[str],
    cells: Sequence[Sequence[float]],
    unit: str,
    *,
    signed: bool = True,
    ends: Sequence[float] = (),
) -> dict[str, Any]:
    """Return a field in cells, in colours that a colour-blind reader can tell apart.

    Cells are (column, row, value, further values for a click); ``columns`` and ``rows`` are labels along the axes. A
    ``signed`` field is white at zero, another begins from white. With ``ends`` (first and last x, first and last y) of
    cells of equal size the axes have round numbers in place of the labels.
    """
    # a field of zeros still needs a scale
    largest = max((abs(cell[2]) for cell in cells), default=0.0) or 1.0
    options = _frame(title, x, y, "category", "category")
    options["xAxis"]["data"], options["yAxis"]["data"] = list(columns), list(rows)
    options["grid"] |= {"right": 84}
    options["yAxis"]["axisLabel"] = {**options["yAxis"]["axisLabel"], "interval": max(len(rows) // 6 - 1, 0)}
    if ends:
        options["xAxis"] = _with_numbers(options["xAxis"], "bottom", ends[:2])
        options["yAxis"] = _with_numbers(options["yAxis"], "left", ends[2:])
    options["visualMap"] = {
        "min": -largest if signed else 0.0,
        "max": largest,
        "calculable": True,
        "orient": "vertical",
        "right": 0,
        "top": "middle",
        "dimension": 2,
        "inRange": {"color": [RED, "#f4c9b0", "#ffffff", "#a9d0e6", BLUE] if signed else ["#ffffff", "#a9d0e6", BLUE]},
        "text": [unit, ""],
        "textStyle": {"color": SOFT, "fontSize": 10},
        "itemHeight": 110,
    }
    return {
        **options,
        "series": [{"type": "heatmap", "data": cells, "progressive": 0, "progressiveThreshold": len(cells) + 1}],
    }


def _with_numbers(cells: dict[str, Any], position: str, ends: Sequence[float]) -> list[dict[str, Any]]:
    """Return the hidden axis of cells, and one of numbers over the same length."""
    numbers = {key: value for key, value in cells.items() if key != "data"}
    label = {**NUMBERS, "showMaxLabel": False}  # the last end is no round number
    drawn = {"type": "value", "min": ends[0], "max": ends[1], "position": position, "axisLabel": label}
    return [{**cells, "show": False}, {**numbers, **drawn, "splitLine": {"show": False}}]


def _named(options: dict[str, Any]) -> dict[str, Any]:
    """Return a diagram with the names of its curves above them, where there are several."""
    names = list(dict.fromkeys(str(series["name"]) for series in options["series"]))
    legend = {
        "show": len(names) > 1,
        "data": names,
        "top": 22,
        "left": 8,
        "width": BESIDE_TOOLS,
        "itemWidth": 18,
        "itemHeight": 8,
        "type": "scroll",
        "textStyle": {"fontSize": 11, "lineHeight": 15},
    }
    grid = {**options["grid"], **({"top": BELOW_LEGEND} if len(names) > 1 else {})}
    return {**options, "grid": grid, "legend": legend}


def _frame(title: str, x: str, y: str, x_kind: str, y_kind: str) -> dict[str, Any]:
    """Return quiet axes with their labels: no box, a faint grid, and a button that saves the picture."""
    axis = {"nameLocation": "middle", "nameTextStyle": {"color": SOFT, "fontSize": 11}, "axisLabel": NUMBERS}
    return {
        "animation": False,
        "aria": {"enabled": True, "label": {"description": f"{title}. Horizontal: {x}. Vertical: {y}."}},
        "title": {"text": title, "left": 8, "top": 2, "textStyle": {"fontSize": 13, "fontWeight": 600, "color": INK}},
        "grid": {"left": 58, "right": 22, "top": 44, "bottom": 42},
        "tooltip": {"trigger": "axis" if x_kind != "category" else "item", "confine": True},
        "toolbox": {
            "right": 6,
            "top": 0,
            "itemSize": 13,
            "feature": {"saveAsImage": {"title": "save as PNG", "pixelRatio": 2}},
        },
        "xAxis": {**axis, "type": x_kind, "name": x, "nameGap": 26, "splitLine": {"show": False}, "scale": True},
        "yAxis": {**axis, "type": y_kind, "name": y, "nameGap": 42, "splitLine": {"lineStyle": {"color": LINE}}},
    }


CURVE_COLUMNS = 300
"""Columns of pixels of a curve on a page."""


def points(x: Any, y: Any, columns: int = CURVE_COLUMNS) -> list[list[float]]:
    """Return a curve as points, without what is not finite; each column of pixels keeps its least and its greatest.

    Examples
    --------
    >>> points(np.array([0.0, 1.0, 2.0]), np.array([0.0, np.nan, 4.0]))
    [[0.0, 0.0], [2.0, 4.0]]
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    finite = np.isfinite(y) & np.isfinite(x)
    x, y = thin(x[finite], y[finite], columns)
    return [[float(f"{a:.6g}"), float(f"{b:.6g}")] for a, b in zip(x, y, strict=True)]


def svg_of(figure: Any) -> bytes:
    """Return a figure of matplotlib as SVG."""
    with io.BytesIO() as file:
        figure.savefig(file, format="svg")
        return file.getvalue()
