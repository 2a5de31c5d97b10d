"""Results in Python: a line, a table with its curve in a notebook, picture, report and table.

Their fields declare them: see `strikewave.base.declare`. The picture of a result, and its page where it has one of its
own, stand in the module ``report`` beside it (``picture``, ``page``), which is found by its name: it takes long to
import, and imports the result.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.output_folder import write_atomically
from strikewave.base.result import RUN_PASSED, WARNING, Result
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import data_columns, key_numbers, shown_rows
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.parts import written

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

MOST_ROWS = 12  # a train of blows, and no more than a screen shows beside the curve
"""Rows of the table in a notebook."""
MOST_NUMBERS = 4  # more would not be read
"""Highlights in the one line of a result."""
WIDTH, HEIGHT, MARGIN = 420, 150, 34  # half a page wide, with letters of 11 pixels below and above
"""Size and margin of the curve in a notebook, pixels."""
COLUMNS = 210  # two pixels each
"""Columns into which the samples of the curve are gathered."""


OWN_PAGE, HEAD_OF_PAGE = b'<meta name="generator" content="strikewave', 2000
"""Text in the head of each page that strikewave writes, and the bytes within which it stands."""


def html_place(path: Path | str, usual: str) -> Path:
    """Return the HTML file that a path means: itself, or the usual one of a folder."""
    place = Path(path)
    if place.is_dir():
        place = place / usual
        if os.path.lexists(place) and not _is_own_page(place):
            hint = f"name the file: it is replaced, but {usual} of a folder only where strikewave wrote it"
            raise InputError("path", place, "a page that strikewave wrote", hint)
    if place.suffix.lower() not in (".html", ".htm") or not place.parent.is_dir():
        raise InputError("path", Path(path), "a file that ends in .html, in a folder that exists, or that folder")
    return place


def _is_own_page(place: Path) -> bool:
    """Tell whether a file is a page that strikewave wrote."""
    if not place.is_file():
        return False
    with place.open("rb") as file:
        return OWN_PAGE in file.read(HEAD_OF_PAGE)


def columns_of_mappings(rows: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> list[Column]:
    """Return rows, such as those of a JSON document, as columns; a table within a row is spread, lists are left out.

    ``units`` are the SI units by key, or by the last part of a spread one.

    Examples
    --------
    >>> [column[:3] for column in columns_of_mappings([{"name": "mid", "peaks": {"force": 2.0}}], {"force": "N"})]
    [('name', ['mid'], ''), ('peaks.force', [2.0], 'N')]
    """
    flat = [dict(_flat(row)) for row in rows]
    names = dict.fromkeys(name for row in flat for name in row)
    return [
        Column(name, [row.get(name) for row in flat], units.get(name, units.get(name.rpartition(".")[2], "")))
        for name in names
    ]


def _flat(row: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the single values of a row, those of a table within it by their paths."""
    for name, value in row.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{path}{name}.")
        elif isinstance(value, str) or not hasattr(value, "__len__"):
            yield f"{path}{name}", value


class Curve(NamedTuple):
    """The pulse, or another curve that says most of a result: values over an axis, with labels, in units shown."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    x_label: str
    y_label: str


def history_curve(time: ArrayLike, values: ArrayLike, si: str, usual: str, words: str) -> Curve:
    """Return a history, time and values in SI, as a curve in the units in which it is shown.

    Examples
    --------
    >>> history_curve([0.0, 1e-4], [0.0, 9806.65], "m/s^2", "g", "acceleration")[2:]
    ('time (µs)', 'acceleration (g)')
    """
    x, y = np.asarray(time, float), np.asarray(values, float)
    (second, unit), (size, name) = time_unit(float(np.ptp(x)) if x.size else 0.0), axis_unit(si, usual)
    return Curve(x / second, y / size, f"time ({unit})", f"{words} ({name})" if name not in ("", "1") else words)


@dataclass(frozen=True, kw_only=True)
class ShownResult(Result):
    """A result that shows itself in Python; see `Result` for what files and JSON take of it."""

    drawing: ClassVar[str] = "report"
    """The module beside the result with its picture and page; empty where nothing is drawn."""
    table_name: ClassVar[str] = "table"
    """Name of its main table in a workbook."""

    main_rows: ClassVar[str] = ""
    """The declared field with the rows of that table."""

    main_table: ClassVar[str] = ""
    """Name of the table of these rows that it is, where they have several."""

    written: ClassVar[tuple[str, ...]] = ()
    """Names of its columns for Python and files, where these are not all."""

    is_history: ClassVar[bool] = False
    """True if its main table is a history, of which a notebook shows rows spread over it, not the first ones."""

    def __init_subclass__(cls, **rest: Any) -> None:
        super().__init_subclass__(**rest)
        cls.__repr__ = ShownResult.__repr__  # type: ignore[method-assign]  # a dataclass writes its own otherwise

    @property
    def label(self) -> str:
        """Name in one line: that of the case, else the title."""
        return self.source.name or self.title

    @property
    def data_rows(self) -> str:
        """The declared field whose rows Python and files take: the one of its main table."""
        return self.main_rows

    def highlights(self) -> Sequence[tuple[str, str]]:
        """Return the few numbers that it comes to, each with its label, the most important one first.

        Examples
        --------
        >>> from strikewave import load_case, run_case
        >>> run_case(load_case("li-ma-2019", ["feed.blows=1"])).highlights()[1]
        ('first rigid peak', '4151 g')
        """
        return key_numbers(self)

    def columns(self) -> Sequence[Column]:
        """Return its main table."""
        columns = data_columns(self, self.data_rows) if self.data_rows else ()
        return [column for column in columns if not self.written or column.name in self.written]

    def preview(self) -> Curve | None:
        """Return the pulse, or the curve that says most of it; None where no single curve does."""
        return None

    def plot(self) -> Figure:
        """Return its picture, the one that its command writes, as a matplotlib figure."""
        picture = self._drawn("picture")
        if picture is None:
            raise StrikewaveError(f"a {type(self).__name__} has no picture: to_dataframe() has what it holds")
        figure: Figure = picture(self)
        _show_in_notebooks()
        return figure

    def report(self, path: Path | str) -> Path:
        """Write its report as one HTML file, whole or not at all: the one that its command writes.

        Where the command writes none, the report has its key numbers, picture, table and warnings.

        Parameters
        ----------
        path : Path or str
            The file, which ends in ``.html``, or a folder, where it is called ``report.html``.

        Returns
        -------
        Path
            Of the file.

        Examples
        --------
        >>> import tempfile
        >>> from strikewave import load_case, run_case
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     run_case(load_case("li-ma-2019", ["feed.blows=1"])).report(folder).name
        'report.html'
        """
        from strikewave.reporting.chapters import plain_page

        page, place = self._drawn("page"), html_place(path, "report.html")
        if page is None:
            picture = self._drawn("picture")
            text = plain_page(self, self.highlights(), picture and picture(self), *shown_table(self))
        else:
            text = page(self)
        write_atomically(place, text)
        return place

    def to_dataframe(self) -> pandas.DataFrame:
        """Return its main table in SI; ``attrs["units"]`` holds the unit of each column.

        Examples
        --------
        >>> from strikewave import load_case, run_case
        >>> table = run_case(load_case("li-ma-2019")).to_dataframe()
        >>> len(table), table.attrs["units"]["rigid_peak"]
        (11, 'm/s^2')
        """
        import pandas

        columns = self.columns()
        if not columns:
            raise StrikewaveError(f"a {type(self).__name__} has no table: document() has all that it holds")
        table = pandas.DataFrame({column.name: list(column.values) for column in columns})
        table.attrs["units"] = {column.name: column.si for column in columns if column.si}
        return table

    def _drawn(self, what: str) -> Callable[[Any], Any] | None:
        """Return the function that makes the picture or the page of this result; None where there is none."""
        if not self.drawing:
            return None
        module = import_module(f"{type(self).__module__.rpartition('.')[0]}.{self.drawing}")
        functions: Mapping[type, Callable[[Any], Any]] | Callable[[Any], Any] | None = getattr(module, what, None)
        return functions.get(type(self)) if isinstance(functions, Mapping) else functions

    def __repr__(self) -> str:
        numbers = [f"{label} {value}" for label, value in self.highlights()[:MOST_NUMBERS]]
        numbers += [f"check failed: {code}" for code in self.own_verdict.codes]
        return f"<{type(self).__name__} {self.label}" + (f": {', '.join(numbers)}>" if numbers else ">")

    def _repr_html_(self) -> str:
        warned = self.own_verdict.status == RUN_PASSED and any(one.severity == WARNING for one in self.notices)
        state = f"{self.state}: see notices" if warned else self.state
        numbers = "".join(_row("th", "td", [label, value]) for label, value in self.highlights())
        curve = self.preview()
        beside = [f"<table>{numbers}</table>"] * bool(numbers) + ([_svg(curve)] if curve is not None else [])
        cells = "".join(f'<td style="vertical-align:top;border:0">{part}</td>' for part in beside)
        return (
            f"<div><p><b>{escape(self.title)}</b><br>{escape(type(self).__name__)}; {escape(state)}</p>"
            f'<table style="border:0"><tr>{cells}</tr></table>{_html_table(self)}</div>'
        )


def _html_table(result: ShownResult) -> str:
    """Return some rows of the main table, as notebooks show them; nothing where no column is shown."""
    heads, rows = shown_table(result, MOST_ROWS)
    if not heads:
        return ""
    count = len(result.columns()[0].values)
    more = f"<p>{count - MOST_ROWS} more rows: see to_dataframe()</p>" if count > MOST_ROWS else ""
    body = "".join(_row("td", "td", row) for row in rows)
    return f"<table><thead>{_row('th', 'th', heads)}</thead><tbody>{body}</tbody></table>{more}"


def _row(first: str, rest: str, cells: Sequence[str]) -> str:
    """Return a row of a table; the first cell is of its own kind."""
    kinds = [first] + [rest] * (len(cells) - 1)
    parts = (
        f'<{kind} style="text-align:left">{escape(cell)}</{kind}>' for kind, cell in zip(kinds, cells, strict=True)
    )
    return f"<tr>{''.join(parts)}</tr>"


def shown_table(result: ShownResult, most: int | None = None) -> tuple[list[str], list[list[str]]]:
    """Return heads with units and the first ``most`` rows for a notebook; of a history as many spread over it."""
    if not result.main_rows:
        return [], []
    return shown_rows(result, result.main_rows, result.main_table, most, result.is_history)


def _svg(curve: Curve) -> str:
    """Return a curve as an inline drawing: its line, its ends, its largest and smallest value."""
    x, y = _gathered(curve)
    if x.size < 2:
        return ""
    low, high = min(float(y.min()), 0.0), max(float(y.max()), 0.0)
    left, right = float(x.min()), float(x.max())
    span, length = (high - low) or 1.0, (right - left) or 1.0
    across = MARGIN + (WIDTH - 2.0 * MARGIN) * (x - left) / length
    down = HEIGHT - MARGIN - (HEIGHT - 2.0 * MARGIN) * (y - low) / span
    zero = HEIGHT - MARGIN + (HEIGHT - 2.0 * MARGIN) * low / span
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, down, strict=True))

    def words(where: float, line: float, text: str, anchor: str) -> str:
        return f'<text x="{where:g}" y="{line:g}" text-anchor="{anchor}">{escape(text)}</text>'

    extent = f"{written(low)} to {written(high)}" if low < 0.0 else f"to {written(high)}"
    return (
        f'<svg role="img" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
        f'font-family="sans-serif" font-size="11" fill="currentColor" aria-label="{escape(curve.y_label)}">'
        f'<line x1="{MARGIN}" x2="{WIDTH - MARGIN}" y1="{zero:.1f}" y2="{zero:.1f}" stroke="#888" stroke-width="0.7"/>'
        f'<polyline points="{points}" fill="none" stroke="#0072B2" stroke-width="1.5"/>'
        + words(MARGIN, 16, f"{curve.y_label}: {extent}", "start")
        + words(MARGIN, HEIGHT - 10, written(left), "start")
        + words(WIDTH / 2, HEIGHT - 10, curve.x_label, "middle")
        + words(WIDTH - MARGIN, HEIGHT - 10, written(right), "end")
        + "</svg>"
    )


def _gathered(curve: Curve) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the known samples of a curve, the smallest and the largest of each of `COLUMNS`."""
    from strikewave.reporting.style import thin

    known = np.isfinite(curve.x) & np.isfinite(curve.y)
    return thin(np.asarray(curve.x)[known], np.asarray(curve.y)[known], COLUMNS)


def _show_in_notebooks() -> None:
    """Let a notebook draw figures that are made without pyplot: its backend, once imported, knows how."""
    ipython = sys.modules.get("IPython")
    if ipython is not None and ipython.get_ipython() is not None:
        with contextlib.suppress(ImportError):
            import_module("matplotlib_inline.backend_inline")
