"""Names and units from the lines above columns of numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from strikewave.records.readers.clock import names_a_step, seconds_in
from strikewave.records.readers.columns import COMMENTS, Marks, cells_of, is_comment, number

LONGEST_NAME = 200
"""Characters of a heading that are looked at: bounds the time of patterns on hostile lines."""
LONGEST_UNIT = 40
"""Characters of a unit; the longest that instruments write has 13."""
_BRACKETS = re.compile(r"^(.*?)\s*[\[({]([^\[\](){}]{1,30})[\])}]$")
"""A name with a unit in brackets."""
_BEHIND = re.compile(r"/|,|\sin\s")
"""Marks before a unit without brackets."""
_KNOWN = re.compile(
    r"[pnuµμmkMG]?(?:s|V|A|g|N|Pa|m|m/s|m/s\^?2|m/s²|m/s/s|Hz|Ω|bar|C|W|J|eu|EU)|°C?|deg|rad|rpm|%|psi|gn|g0|"
    r"(?:milli|micro|nano|kilo)?(?:second|volt|amp(?:ere)?|meter|metre|newton|pascal)s?|"
    r"sec|min|[um]sec|[mµuμ]?strain|[µuμ]m/m|[µuμ]?[εe]|counts?|lbf?",
    re.IGNORECASE,
)
"""Units as instruments write them; anything else behind a mark is part of the name."""
_TIME = re.compile(
    r"(?:[\w.-]{1,30}[ _-]){0,3}(?:time|zeit|timestamp|messzeit)(?:[ _-]?(?:axis|base|stamp|value|achse|\d{1,3}))?"
    r"|t|x|x[ _-]?(?:axis|value|achse)|s|secs?|seconds?|sekunden?|temps|tiempo|tempo|elapsed|zeitachse|timebase",
    re.IGNORECASE,
)
"""Headings of time, in several languages."""
_COUNTER = re.compile(
    r"#|no\.?|nr\.?|n|index|sequence|samples?|points?|sample[ _-]?(?:no\.?|number|index)", re.IGNORECASE
)
"""Headings of a column that counts samples."""
_Y_UNITS = re.compile(r"(?:vertical|y)[ _-]?units?(?:[ _-]label)?", re.IGNORECASE)
"""Names of a line that gives the units of all columns after time."""


class Headings(NamedTuple):
    """Name and unit of each column, empty where the file has none; the header's cells as they stand."""

    names: list[str]
    units: list[str]
    header: tuple[str, ...] = ()

    @property
    def named(self) -> bool:
        """Whether there is a header."""
        return any(self.names)


def name_and_unit(text: str) -> tuple[str, str]:
    """Part a heading into a name and a unit.

    Examples
    --------
    >>> [name_and_unit(text) for text in ("Acc (g)", "Time/s", "acc, m/s^2", "board", "[V]")]
    [('Acc', 'g'), ('Time', 's'), ('acc', 'm/s^2'), ('board', ''), ('', 'V')]
    """
    text = text.strip(" \"'\t")[:LONGEST_NAME]
    match = _BRACKETS.match(text)
    if match is not None:
        return match[1].strip(), match[2].strip()
    for mark in _BEHIND.finditer(text):
        if mark.start() and is_unit(text[mark.end() :]):
            return text[: mark.start()].strip(), text[mark.end() :].strip()
    stem, _, tail = text.rpartition("_")
    if _TIME.fullmatch(stem) and seconds_in(tail) is not None:
        return stem, tail
    return text, ""


def is_unit(text: str) -> bool:
    """Tell whether a word is a unit that instruments write."""
    return bool(_KNOWN.fullmatch(text.strip(" \"'()[]")[:LONGEST_UNIT]))


def is_time(name: str, unit: str) -> bool:
    """Tell whether a heading is that of time."""
    if unit and seconds_in(unit) is None:
        return False
    return bool(_TIME.fullmatch(name[:60])) or bool(unit)


def is_counter(name: str, unit: str) -> bool:
    """Tell whether a heading is that of a column that counts samples."""
    return bool(_COUNTER.fullmatch(unit[:40] or name[:40]))


def find_headings(above: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> Headings:
    """Find names and units in the lines above the data.

    Parameters
    ----------
    above : sequence of str
        Those lines.
    marks : Marks
        Of the data.
    width : int
        Number of columns.
    filled : sequence of int
        Columns that hold numbers.
    """
    lines = [line for line in above if line.strip()]
    rows = [_row(line, marks, width) for line in lines if not is_comment(line) and not _setting(line, marks, filled)]
    rows = [row for row in rows if sum(bool(row[k]) for k in filled) * 2 > len(filled)]
    if not rows:
        return _commented(lines, marks, width, filled)
    below = rows[-1]
    has_units = len(rows) > 1 and _all_units([below[k] for k in filled])
    header = rows[-2] if has_units else below
    parts = [name_and_unit(cell) for cell in header]
    units = [cell.strip("()[] ") for cell in below] if has_units else [unit for _, unit in parts]
    if not has_units and _all_units([header[k] for k in filled]):
        units = [unit or name for name, unit in parts]
    units = [own or unit for own, unit in zip(units, _said_units(lines, marks, width, filled), strict=True)]
    return Headings([name for name, _ in parts], units, tuple(header))


def _setting(line: str, marks: Marks, filled: Sequence[int]) -> bool:
    """Tell whether a line is a name and its value, not a header."""
    cells = cells_of(line, marks)
    values = [number(cell, marks.decimal) for cell in cells]
    numbers = sum(value is not None and value == value for value in values[1:])
    if names_a_step(line) and len(filled) > 1 and values[0] is None:
        return "start" not in line.lower() or numbers > 0
    return bool(_Y_UNITS.fullmatch(cells[0])) or (len(filled) == 1 and names_a_step(line))


def _row(line: str, marks: Marks, width: int) -> list[str]:
    """Cut a header into as many cells as there are columns; it may be cut otherwise than the data."""
    choices = [cells_of(line, marks)]
    if not marks.delimiter:
        joined = re.sub(r"(\S)[ \t](?=[\[(])", "\\1\0", line.replace('"', ""))
        choices.append([cell.replace("\0", " ") for cell in joined.split()])
        choices.append([cell.strip() for cell in re.split(r"[ \t]{2,}", line.strip())])
        choices += [cells_of(line, Marks(other)) for other in ("\t", ";", ",")]
    cells = next((c for c in choices if len(c) == width), choices[0])
    return (cells + [""] * width)[:width]


def _all_units(cells: Sequence[str]) -> bool:
    written = [cell for cell in cells if cell.strip("-")]
    return bool(written) and all(
        is_unit(cell) or (len(cell) < 32 and cell[0] + cell[-1] in ("()", "[]")) or is_counter(cell, "")
        for cell in written
    )


def _said_units(lines: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> list[str]:
    """Return the units that a line such as ``Vertical Units,V,V`` names for all columns after time."""
    for line in lines:
        cells = cells_of(line, marks)
        if _Y_UNITS.fullmatch(cells[0]):
            units = [cell if is_unit(cell) else "" for cell in cells[1:]]
            return [units[k - 1] if 0 < k <= len(units) and k in filled else "" for k in range(width)]
    return [""] * width


def _commented(lines: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> Headings:
    """Take the last comment as a header where it names time or units for every column."""
    last = lines[-1] if lines else ""
    if is_comment(last):
        row = _row(last.strip().lstrip("".join(COMMENTS)).strip(), marks, width)
        parts = [name_and_unit(cell) for cell in row]
        if all(row[k] for k in filled) and (is_time(*parts[filled[0]]) or all(parts[k][1] for k in filled)):
            return Headings([name for name, _ in parts], [unit for _, unit in parts])
    return Headings([""] * width, [""] * width)
