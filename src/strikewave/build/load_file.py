"""A measured load from a text file: two columns, time and force, or time and speed or acceleration of the face."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid

from strikewave.errors import InputError, StrikewaveError, show
from strikewave.units import parse_quantity
from strikewave.waves import Load, Sampled

LARGEST_FILE = 100_000_000
"""A file above this many bytes is refused."""
_UNIT = re.compile(r"[\[(]([^\])]{1,30})[\])]\s*$")


def read_load(path: str) -> Load:
    """Read a load from CSV, TSV or blank-separated text.

    The first line may be a head with units in brackets, such as ``time [us], force [kN]``; without one the
    columns are in s and N. A second column in m/s or m/s^2 is the speed or acceleration of the face.

    Raises
    ------
    InputError
        If the file cannot be read, or is not two columns of numbers.
    """
    file = Path(path)
    try:
        if file.stat().st_size > LARGEST_FILE:
            raise InputError("load.file", path, f"a file of at most {LARGEST_FILE // 1_000_000} MB")
        text = file.read_text("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("load.file", path, "a text file in UTF-8") from None
    except OSError as error:
        raise InputError("load.file", path, "a file that can be read", error.strerror or "") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 3:
        raise InputError("load.file", path, "at least three lines of two columns")
    mark = next((m for m in (";", "\t", ",") if m in lines[0]), None)
    rows = [row.split() for row in lines] if mark is None else list(csv.reader(lines, delimiter=mark))
    units = ["s", "N"]
    if not _is_number(rows[0][0]):
        for k, head in enumerate(rows[0][:2]):
            found = _UNIT.search(head.strip())
            units[k] = found[1] if found else units[k]
        rows = rows[1:]
    try:
        numbers = np.array([[float(cell) for cell in row[:2]] for row in rows], dtype=float)
    except ValueError as error:
        raise InputError("load.file", path, "two columns of numbers", show(str(error), 80)) from None
    if numbers.ndim != 2 or numbers.shape[1] != 2:
        raise InputError("load.file", path, "two columns of numbers")
    time = numbers[:, 0] * _factor(units[0], "s", path)
    for si, kind in (("N", "force"), ("m/s", "speed"), ("m/s^2", "acceleration")):
        try:
            values = numbers[:, 1] * _factor(units[1], si, path)
        except StrikewaveError:
            continue
        if kind == "acceleration":
            values, kind = cumulative_trapezoid(values, time, initial=0.0), "speed"
        try:
            return Sampled(time, values, "speed" if kind == "speed" else "force")
        except ValueError as error:
            raise InputError("load.file", path, "times that rise and finite values", str(error)) from None
    raise InputError("load.file", units[1], "a force, a speed or an acceleration in the head", 'such as "force [kN]"')


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _factor(unit: str, si: str, path: str) -> float:
    return parse_quantity(f"1 {unit}", si, f"load.file {show(path)}")
