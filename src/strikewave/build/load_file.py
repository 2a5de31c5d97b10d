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
LARGEST_NUMBER = 1e12
"""Larger numbers than this are refused: no load has them."""
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
    try:
        split = (
            (row.split() for row in lines) if mark is None else csv.reader(lines, delimiter=mark, skipinitialspace=True)
        )
        rows = list(split)
    except csv.Error as error:
        raise InputError("load.file", path, "two columns of numbers", str(error)) from None
    units = ["s", "N"]
    if not _is_number(rows[0][0]):
        found = [_UNIT.search(head.strip(" \"'")) for head in (rows[0] if mark else [lines[0]])[:2]]
        if len(found) < 2 or None in found:
            allowed = 'a first line with a unit in brackets for each column, such as "time [us], force [kN]"'
            raise InputError("load.file", lines[0][:60], allowed, "or no head at all: then s and N")
        units = [match[1] for match in found if match]
        rows = rows[1:]
    numbers = np.empty((len(rows), 2))
    for k, row in enumerate(rows):
        try:
            numbers[k] = float(row[0]), float(row[1])
        except (ValueError, IndexError):
            raise InputError(
                "load.file", show(",".join(row), 60), "two columns of numbers", f"row {k + 1} of {path}"
            ) from None
    if not np.all(np.abs(numbers) < LARGEST_NUMBER):
        raise InputError("load.file", path, f"finite numbers below {LARGEST_NUMBER:.0e}")
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
