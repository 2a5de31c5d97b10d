"""Universal file format: time responses of data set 58, as text and binary (58b)."""

from __future__ import annotations

import contextlib
import importlib
import math
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options
from strikewave.records.readers.common import MOST_ARRAYS, ArrayColumn, assemble, damaged, left_out, text
from strikewave.records.record import Record

TIME_RESPONSE = 1
"""Function type of a time response."""
MEASURED = 58
"""Data set of a function at a degree of freedom."""
_HEAD = re.compile(rb"\A[ \r\n]*-1 *\r?\n *\d{1,5}[bB \r\n]")
"""Beginning of a data set: -1 in a line, then its number."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like a universal file."""
    return _HEAD.match(head) is not None


def read(path: Path, options: Options) -> Record:
    """Read the time responses of a universal file; other data sets are passed over."""
    pyuff = importlib.import_module("pyuff")
    with warnings.catch_warnings(), contextlib.suppress(OSError):
        warnings.simplefilter("ignore")
        file = pyuff.UFF(str(path))
        kinds = file.get_set_types()
        if len(kinds) > MOST_ARRAYS:
            raise damaged(path, f"it has {len(kinds)} data sets", f"a file with at most {MOST_ARRAYS}")
        columns: list[ArrayColumn] = []
        skipped: list[str] = []
        for k, kind in enumerate(kinds):
            set_columns = _columns(file.read_sets(k), len(columns)) if kind == MEASURED else []
            columns += set_columns
            skipped += [f"data set {kind}"] * (not set_columns)
        return assemble(path, "uff", columns, options, findings=left_out(skipped))
    raise damaged(path, "it cannot be opened")


def _columns(data_set: dict[str, Any], count: int) -> list[ArrayColumn]:
    """Return a time response, with its abscissa where that is uneven."""
    values = data_set["data"]
    if data_set["func_type"] != TIME_RESPONSE or np.iscomplexobj(values) or not len(values):
        return []
    folder = f"{count}"
    unit = _label(data_set, "ordinate_axis_units_lab")
    even = data_set["abscissa_spacing"] == 1
    values = values[: data_set["num_pts"]] if data_set["num_pts"] > 0 else values
    step, start = (data_set["abscissa_inc"], data_set["abscissa_min"]) if even else (math.nan, math.nan)
    step = step if step > 0.0 else math.nan
    column = ArrayColumn(_name(data_set, count), len(values), lambda: values, unit, step, start, folder)
    if even:
        return [column]
    stamps, scale = data_set["x"][: len(values)], _label(data_set, "abscissa_axis_units_lab")
    return [column, ArrayColumn("time", len(stamps), lambda: stamps, scale, folder=folder, time=True)]


def _name(data_set: dict[str, Any], count: int) -> str:
    """Return the label of the ordinate, the entity or the first line of the header, the first that is filled."""
    names = (_label(data_set, name) for name in ("ordinate_axis_lab", "rsp_ent_name", "id1"))
    return next((name for name in names if name), f"channel {count + 1}")


def _label(data_set: dict[str, Any], name: str) -> str:
    label = text(data_set.get(name, ""))
    return "" if label.upper() in ("NONE", "NULL") else label
