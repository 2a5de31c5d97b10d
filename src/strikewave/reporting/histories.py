"""Histories of a result as flat tables: one for each time base, as CSV or Parquet, a unit in each head."""

from __future__ import annotations

import importlib
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table

if TYPE_CHECKING:
    from strikewave.base.result import Result
    from strikewave.base.variables import LabelledArrays

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
    >>> list(tables)
    ['histories', 'histories-pulse', 'histories-record']
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
