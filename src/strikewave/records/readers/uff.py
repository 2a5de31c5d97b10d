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
from strikewave.records.readers.common import MOST_ARRAYS, Column, assemble, damaged, left_out, text
from strikewave.records.record import Record

TIME_RESPONSE = 1
_HEAD = re.compile(rb"\A[ \r\n]*-1 *\r?\n *\d{1,5}[bB \r\n]")


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
        columns: list[Column] = []
        skipped: list[str] = []
        for k, kind in enumerate(kinds):
            found = _columns(file.read_sets(k), len(columns)) if kind == 58 else []
            columns += found
            skipped += [f"data set {kind}"] * (not found)
        return assemble(path, "uff", columns, options, findings=left_out(skipped))
    raise damaged(path, "it cannot be opened")


def _columns(held: dict[str, Any], count: int) -> list[Column]:
    """Return a time response, with its abscissa where that is uneven."""
    values = held["data"]
    if held["func_type"] != TIME_RESPONSE or np.iscomplexobj(values) or not len(values):
        return []
    folder = f"{count}"
    unit = _label(held, "ordinate_axis_units_lab")
    even = held["abscissa_spacing"] == 1
    values = values[: held["num_pts"]] if held["num_pts"] > 0 else values
    step, start = (held["abscissa_inc"], held["abscissa_min"]) if even else (math.nan, math.nan)
    step = step if step > 0.0 else math.nan
    column = Column(_name(held, count), len(values), lambda: values, unit, step, start, folder)
    if even:
        return [column]
    stamps, scale = held["x"][: len(values)], _label(held, "abscissa_axis_units_lab")
    return [column, Column("time", len(stamps), lambda: stamps, scale, folder=folder, time=True)]


def _name(held: dict[str, Any], count: int) -> str:
    """Return the label of the ordinate, the entity or the first line of the header, whichever says something."""
    names = (_label(held, name) for name in ("ordinate_axis_lab", "rsp_ent_name", "id1"))
    return next((name for name in names if name), f"channel {count + 1}")


def _label(held: dict[str, Any], name: str) -> str:
    label = text(held.get(name, ""))
    return "" if label.upper() in ("NONE", "NULL") else label
