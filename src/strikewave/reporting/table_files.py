"""A result as files of tables: histories as CSV or Parquet, and all its numbers as one workbook."""

from __future__ import annotations

import importlib
import importlib.util
import io
import itertools
import math
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel

from strikewave._version import __version__
from strikewave.base.errors import MissingPackageError
from strikewave.base.quantities import Value
from strikewave.base.texts import percent
from strikewave.base.units import in_unit
from strikewave.cases.paths import Form
from strikewave.reporting.chapters import input_groups
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import in_shown_units, one_in, shown_unit
from strikewave.reporting.terminal import say

if TYPE_CHECKING:
    from strikewave.base.datasets import LabelledArrays
    from strikewave.base.result import Result

HistoryFormat = Literal["csv", "parquet"]
"""Formats of tables of histories."""


def history_tables(result: Result) -> dict[str, list[Column]]:
    """Return the histories of a result by the stem of their files: ``histories`` over the time of the whole run.

    Others count time from first touch (``histories-pulse``), as a recorder samples it (``histories-record``), or from
    the first sample of a sensor (``histories-reading_1``). Each begins with its time. Fields over place are left out:
    the NetCDF file has them.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> tables = history_tables(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> [column.file_head for column in tables["histories-pulse"]]
    ['time [s]', 'pulse_force of blow 1 [N]', 'pulse_acceleration of blow 1 [m/s^2]']
    """
    tables: dict[str, list[Column]] = {}
    for file, data in result.datasets().items():
        blow = re.search(r"-\d+(?=\.)", file)
        for base, time in _time_bases(data).items():
            columns = list(_columns_over(data, base))
            if columns:
                name = base.removesuffix("_time").replace("sample", "reading")
                stem = "histories" if base == "time" else f"histories-{name}"
                tables[stem + (blow[0] if blow else "")] = [Column("time", time, "s"), *columns]
    return tables


def write_histories(result: Result, folder: Path, form: HistoryFormat) -> list[str]:
    """Write the histories of a result into a folder, and return the names of the files.

    A table that the result keeps anyway is not written twice.
    """
    names, kept = [], result.tables()
    for stem, columns in history_tables(result).items():
        name = f"{stem}.{form}"
        if form == "csv" and name in kept:
            continue
        if form == "csv":
            (folder / name).write_text(csv_table(columns, HISTORY_DIGITS), "utf-8", newline="\n")
        else:
            write_parquet(columns, folder / name)
        names.append(name)
    return names


def _time_bases(data: LabelledArrays) -> dict[str, Any]:
    """Return the times, s, of each dimension that is one: by its coordinate, or by the step of its samples."""
    bases = {
        name: data[name].values for name in data.sizes if name in data.coords and data[name].attrs.get("units") == "s"
    }
    for variable in data.data_vars.values():
        if "step" in variable.attrs:
            base = variable.dims[-1]
            bases[base] = variable.attrs["step"] * np.arange(data.sizes[base])
    return bases


def _columns_over(data: LabelledArrays, base: str) -> Iterator[Column]:
    """Yield the columns of all variables over a time base; one for each label of their other dimensions."""
    for name, variable in data.data_vars.items():
        others = [dim for dim in variable.dims if dim != base]
        if base not in variable.dims or not all(dim in data.coords for dim in others):
            continue
        si = str(variable.attrs.get("units", ""))
        for places in itertools.product(*(range(data.sizes[dim]) for dim in others)):
            at = dict(zip(others, places, strict=True))
            values = variable.values[tuple(at.get(dim, slice(None)) for dim in variable.dims)]
            if np.isfinite(values).any():
                yield Column(_named(name, data, at, variable.attrs), values, si)


def _named(name: str, data: LabelledArrays, at: Mapping[str, int], attributes: Mapping[Any, Any]) -> str:
    """Return the name of a column: the variable's, the sensor it is of, and the labels of its place."""
    labels = [str(attributes["sensor"])] if "sensor" in attributes else []
    for dim, place in at.items():
        label = data[dim].values[place]
        labels.append(f"{dim} {label}" if dim == "blow" else str(label))
    return f"{name} of {', '.join(labels)}" if labels else name


def write_parquet(columns: Sequence[Column], path: Path) -> None:
    """Write columns as Parquet, the unit of each in its name and in its metadata; texts and counts stay what they are.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_parquet([Column("run", [1, 2]), Column("kind", ["full", "missed"])], Path(folder) / "runs.parquet")
    """
    pyarrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    arrays = [
        pyarrow.array(np.asarray(one.converted(), dtype=float) if one.unit else list(one.values)) for one in columns
    ]
    fields = [
        pyarrow.field(one.file_head, array.type, metadata={"unit": one.unit})
        for one, array in zip(columns, arrays, strict=True)
    ]
    parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields)), path)


WORKBOOK = "result.xlsx"
"""Name of the file, the same for every result, as that of a report is."""
MOST_ROWS = 1_048_575  # the format ends at 2^20
"""Rows of a sheet below its heads."""
LONGEST_TITLE = 31
"""Letters of the name of a sheet that the format allows."""
_DATE = datetime(2000, 1, 1)  # in the place of the time of writing: equal results are equal to the byte
_NOT_IN_TITLES, _NOT_IN_CELLS = re.compile(r"[\[\]:*?/\\]"), re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")
_MODIFIED = re.compile(rb"(<dcterms:modified[^>]*>)[^<]*")
NAME_WIDTH, TEXT_WIDTH = 18, 60
"""Widths of columns, in letters: of numbers and names, and of sentences."""
Rows = Iterator[Sequence[Any]]


def check_workbook() -> None:
    """Refuse a workbook where its writer is not installed."""
    if importlib.util.find_spec("openpyxl") is None:
        raise MissingPackageError("--xlsx", "openpyxl", "formats")


def write_workbook(result: Result, folder: Path) -> str:
    """Write a result into a folder as a workbook, in the units shown (SI where none was chosen), and return its name.

    Its sheets: summary, the main table, bands, comparison, warnings, inputs as typed and in SI, and the histories of
    each time base; those that would be empty are left out. A text is never a formula, whatever it begins with.
    """
    openpyxl, excel = importlib.import_module("openpyxl"), importlib.import_module("openpyxl.writer.excel")
    book = openpyxl.Workbook(write_only=True)
    book.properties.creator, book.properties.created = "strikewave", _DATE
    for title, heads, rows in _sheets(result):
        _add(book, title, heads, rows)
    loose, whole = io.BytesIO(), io.BytesIO()
    excel.ExcelWriter(book, zipfile.ZipFile(loose, "w", zipfile.ZIP_STORED)).save()
    with zipfile.ZipFile(loose) as parts, zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as kept:
        for name in parts.namelist():
            text = parts.read(name)
            if name == "docProps/core.xml":
                text = _MODIFIED.sub(rb"\g<1>" + _DATE.strftime("%Y-%m-%dT%H:%M:%SZ").encode(), text)
            kept.writestr(zipfile.ZipInfo(name, (*_DATE.timetuple()[:6],)), text, zipfile.ZIP_DEFLATED)
    (folder / WORKBOOK).write_bytes(whole.getvalue())
    return WORKBOOK


def _sheets(result: Result) -> Iterator[tuple[str, Sequence[str], Rows]]:
    """Yield title, heads and rows of each sheet."""
    yield "summary", ["what", "value"], _summary(result)
    columns: Sequence[Column] = getattr(result, "columns", tuple)()
    if columns:
        yield getattr(result, "table_name", "table"), [column.file_head for column in columns], _rows(columns)
    yield "band", ["result", "low", "high", "unit", "level", "inputs that matter most"], _bands(result)
    heads = ["quantity", "unit", "published", "origin", "role", "computed", "difference [1]", "note"]
    yield "comparison", heads, _comparisons(result)
    yield "warnings", ["code", "severity", "message", "value (SI)", "limit (SI)", "case"], _notices(result)
    yield "inputs", ["input", "as typed", "value in SI", "SI unit", "provenance", "tolerance", "note"], _inputs(result)
    for stem, histories in history_tables(result).items():
        every = -(-len(histories[0].values) // MOST_ROWS)
        if every > 1:
            histories = [one._replace(values=one.values[::every]) for one in histories]
            words = f"{one_in(every)} instant: a sheet holds {MOST_ROWS} rows; the NetCDF file has them all"
            say(f"{WORKBOOK}, sheet {stem}: {words}")
            histories[0] = histories[0]._replace(name=f"time ({words})")
        yield stem, [column.file_head for column in histories], _rows(histories)


def _add(book: Any, title: str, heads: Sequence[str], rows: Rows) -> None:
    """Add a sheet whose heads stay in view; none where there are no rows."""
    first = next(rows, None)
    if first is None:
        return
    cells, styles = importlib.import_module("openpyxl.cell"), importlib.import_module("openpyxl.styles")
    sheet = book.create_sheet(_NOT_IN_TITLES.sub(" ", title)[:LONGEST_TITLE])
    sheet.freeze_panes = "A2"
    for place, head in enumerate(heads):
        letter = importlib.import_module("openpyxl.utils").get_column_letter(place + 1)
        long = head in ("message", "note", "value", "inputs that matter most")
        sheet.column_dimensions[letter].width = TEXT_WIDTH if long else max(NAME_WIDTH, min(len(head) + 2, 40))

    def cell(value: Any) -> Any:
        """Return a number as it is, nothing where there is none, and a text as a cell that is no formula."""
        if isinstance(value, str):
            made = cells.WriteOnlyCell(sheet, _NOT_IN_CELLS.sub(" ", value))
            made.data_type = "s"
            return made
        return None if isinstance(value, float) and not math.isfinite(value) else value

    bold = [cell(head) for head in heads]
    for made in bold:
        made.font = styles.Font(bold=True)
    sheet.append(bold)
    sheet.append([cell(value) for value in first])
    for row in rows:
        sheet.append([cell(value) for value in row])


def _rows(columns: Sequence[Column]) -> Rows:
    """Yield the rows of columns, numbers as Python has them."""
    converted = (column.converted() for column in columns)
    lists = (v.tolist() if isinstance(v, np.ndarray) else [_plain(x) for x in v] for v in converted)
    return zip(*lists, strict=True)


def _plain(value: Any) -> Any:
    """Return a number of NumPy as one of Python, anything that is neither number nor text as text.

    Examples
    --------
    >>> _plain(np.float64(2.0)), _plain("full"), _plain(None), _plain((1, 2))
    (2.0, 'full', None, '(1, 2)')
    """
    if isinstance(value, np.generic):
        return value.item()
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def _summary(result: Result) -> Rows:
    yield "title", result.title
    yield result.source.kind, result.source.name
    yield "command", f"strikewave {result.command}"
    yield "version", f"strikewave {__version__}"
    yield from _flat(result.test, "")
    yield from getattr(result, "highlights", tuple)()


def _flat(stated: Any, path: str) -> Rows:
    """Yield what is stated of a test, tables and their rows by their paths."""
    rows = stated.items() if isinstance(stated, Mapping) else enumerate(stated, start=1)
    for key, entry in rows:
        here = f"{path}.{key}" if path else str(key)
        if isinstance(entry, str):
            yield here, entry
        else:
            yield from _flat(entry, here)


def _bands(result: Result) -> Rows:
    units = result.units()
    for name, band in result.band.items():
        si = units.get(name, units.get(name.rpartition(".")[2], "s" if name == "interval" else ""))
        unit = shown_unit(si, si)
        low, high = (in_unit(end, si, unit) if unit != si else end for end in (band.low, band.high))
        inputs = ", ".join(f"{one.field} ({percent(one.share, 0)})" for one in band.inputs)
        yield name, low, high, unit, band.level, inputs


def _comparisons(result: Result) -> Rows:
    for one in result.comparisons:
        si = one.measured.si
        unit = shown_unit(si, si)
        pair = [None if v is None else in_unit(v, si, unit) if unit != si else v for v in (one.published, one.computed)]
        name = one.quantity + (f" of {one.sensor}" if one.sensor else "")
        yield name, unit, pair[0], one.measured_or_simulated, one.role, pair[1], one.difference, one.note


def _notices(result: Result) -> Rows:
    for one in result.notices:
        yield one.code, one.severity, in_shown_units(one.message), one.value, one.limit, one.case


def _inputs(result: Result) -> Rows:
    """Yield the inputs of a case or a set-up by their paths; nothing where a result has none of them."""
    case = getattr(result, "case", None)
    model = case if isinstance(case, BaseModel) else getattr(case, "setup", None)
    if not isinstance(model, BaseModel):
        return
    form = Form(type(model), "case", "")
    for table, _, entries in input_groups(model):
        for key, entry in entries:
            path = f"{table}.{key}"
            if not isinstance(entry, Value):
                yield path, _plain(entry), None, "", "choice", "", ""
                continue
            allowed = form.range_at(path.split("."))
            unit = allowed.unit.replace("count", "") if allowed else ""
            tolerance = "" if entry.tolerance is None else str(entry.tolerance.typed)
            yield path, entry.typed, entry.si, unit, entry.provenance, tolerance, entry.note
