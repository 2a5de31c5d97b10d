"""Names and units from the lines above columns of numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from strikewave.records.readers.clock import names_a_step, seconds_in
from strikewave.records.readers.columns import Marks, cells_of, is_comment, number

LONGEST_NAME = 200
"""Characters of a heading that are looked at: bounds the time of patterns on hostile lines."""
LONGEST_UNIT = 40
"""Characters of a unit; the longest that instruments write has 13."""
_BRACKETS = re.compile(r"^(.*?)\s*[\[({]([^\[\](){}]{1,30})[\])}]$")
"""A name with a unit in brackets."""
_BEHIND = re.compile(r"/|,|(?:^|\s)in\s")
"""Marks before a unit without brackets."""
_WITHIN = re.compile(r"(?:^|\s)in\s+(\S{1,40})(?=\s)|[\[(]([^\[\]()]{1,30})[\])]")
"""A unit within a sentence: ``time in ms since the trigger``, ``acceleration (g) of the board``."""
_BRACKETED = re.compile(r"[^\[\](){}]{1,200}[\[({][^\[\](){}]{1,30}[\])}]")
"""A heading that ends in a unit in brackets, in a line of several."""
_BEFORE_NAMES = re.compile(r"\s{0,5}[\w ]{1,30}:\s")
"""A word before the names of all columns: ``columns: time acceleration``."""
_SUFFIXES = {
    "g": "g", "n": "N", "kn": "kN", "v": "V", "mv": "mV", "pa": "Pa", "kpa": "kPa", "mpa": "MPa", "m_s2": "m/s^2",
    "ms2": "m/s^2", "mps2": "m/s^2", "mm": "mm", "ustrain": "ustrain",
}  # fmt: skip
"""Units behind an underscore, in files that write that of time so: ``time_ms``, ``board_g``."""
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
_BEFORE_COMMENTS = "#%/;!* "
"""Letters before a comment above the data."""
_MOST_COMMENTS = 50
"""Comments above the data in which a header is looked for, from the last one up."""
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
    >>> [name_and_unit(text) for text in ("Acc (g)", "Time/s", "acc, m/s^2", "board", "[V]", "in ms")]
    [('Acc', 'g'), ('Time', 's'), ('acc', 'm/s^2'), ('board', ''), ('', 'V'), ('', 'ms')]
    >>> name_and_unit("time in ms since the trigger"), name_and_unit("Y[0]"), name_and_unit("strain [1]")
    (('time', 'ms'), ('Y[0]', ''), ('strain', '1'))
    """
    text = text.strip(" \"'\t")[:LONGEST_NAME]
    match = _BRACKETS.match(text)
    if match is not None and match[2].isdecimal() and (match[2] != "1" or match.end(1) == match.start(2) - 1):
        return text, ""
    if match is not None:
        return match[1].strip(), match[2].strip()
    for mark in _BEHIND.finditer(text):
        if (mark.start() or mark[0].strip() == "in") and is_unit(text[mark.end() :]):
            return text[: mark.start()].strip(), text[mark.end() :].strip()
    stem, _, tail = text.rpartition("_")
    if _TIME.fullmatch(stem) and seconds_in(tail) is not None:
        return stem, tail
    for mark in _WITHIN.finditer(text):
        unit = mark[1] or mark[2]
        if is_unit(unit):
            return text[: mark.start()].strip(), unit
    return text, ""


def is_unit(text: str) -> bool:
    """Tell whether a word is a unit that instruments write."""
    word = text.strip(" \"'()[]")[:LONGEST_UNIT]
    return bool(_KNOWN.fullmatch(word)) or seconds_in(word) is not None


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
    lines = _whole([line for line in above if line.strip()])
    rows = [_row(line, marks, width) for line in lines if not is_comment(line) and not _setting(line, marks, filled)]
    rows = [row for row in rows if sum(bool(row[k]) for k in filled) * 2 > len(filled)]
    if not rows:
        return _commented(lines, marks, width, filled)
    worded = [row for row in rows if any(row[k] and number(row[k], marks.decimal) is None for k in filled)]
    rows = worded or rows  # numbers beside a row of words are a setting of each channel, such as an offset
    found = _of_rows(rows, marks, filled)
    said = _said_units(lines, marks, width, filled)
    return found._replace(units=[own or unit for own, unit in zip(found.units, said, strict=True)])


def _whole(lines: Sequence[str]) -> list[str]:
    """Join lines that end within quotes with the next ones: spreadsheets break headings so."""
    joined: list[str] = []
    for line in lines:
        if joined and joined[-1].count('"') % 2 and len(joined[-1]) < LONGEST_NAME:
            joined[-1] += " " + line
        else:
            joined.append(line)
    return joined


def _of_rows(rows: list[list[str]], marks: Marks, filled: Sequence[int]) -> Headings:
    """Take names and units from the last of the rows above the data, or from the last two."""
    below = rows[-1]
    has_units = len(rows) > 1 and _all_units([below[k] for k in filled])
    second = len(rows) > 1 and not has_units and _is_second_head(rows[-2], below, marks, filled)
    header = rows[-2] if has_units or second else below
    parts = [name_and_unit(cell) for cell in header]
    units = [cell.strip("()[] ") for cell in below] if has_units else [unit for _, unit in parts]
    if second:
        units = [unit or name_and_unit(cell)[1] for unit, cell in zip(units, below, strict=True)]
    if not has_units and _all_units([header[k] for k in filled]):
        units = [unit or name for name, unit in parts]
    names = [name for name, _ in parts]
    return _with_suffixes(Headings(names, units, tuple(header)))


def _is_second_head(above: Sequence[str], below: Sequence[str], marks: Marks, filled: Sequence[int]) -> bool:
    """Tell whether the row above names time and holds no number: then the one below it only tells more of the same."""
    if any(number(above[k], marks.decimal) is not None for k in filled):
        return False
    named = [k for k in filled if is_time(*name_and_unit(above[k]))]
    again = [k for k in filled if is_time(*name_and_unit(below[k]))]
    return bool(named) and (not again or again[0] == named[0])


def _with_suffixes(found: Headings) -> Headings:
    """Take units behind underscores off the names of a file that writes that of time so."""
    if not any(unit and cell.endswith(f"_{unit}") for cell, unit in zip(found.header, found.units, strict=False)):
        return found
    names, units = list(found.names), list(found.units)
    for k, (name, unit) in enumerate(zip(names, units, strict=True)):
        for suffix, meant in _SUFFIXES.items():
            stem = name[: -len(suffix) - 1]
            if not unit and stem and name.casefold().endswith(f"_{suffix}"):
                names[k], units[k] = stem, meant
    return found._replace(names=names, units=units)


def _setting(line: str, marks: Marks, filled: Sequence[int]) -> bool:
    """Tell whether a line is a name and its value, not a header."""
    cells = cells_of(line, marks)
    values = [number(cell, marks.decimal) for cell in cells]
    numbers = sum(value is not None and value == value for value in values[1:])
    if names_a_step(line) and len(filled) > 1 and values[0] is None:
        return "start" not in line.lower() or numbers > 0
    return bool(_Y_UNITS.fullmatch(cells[0])) or (len(filled) == 1 and names_a_step(line))


def _row(line: str, marks: Marks, width: int) -> list[str]:
    """Cut a header into as many cells as there are columns; it may be cut otherwise than the data.

    Of several ways that give as many cells, the one with most units counts.
    """
    choices = [cells_of(line, marks)]
    if not marks.delimiter:
        joined = re.sub(r"(\S)[ \t](?=[\[(])", "\\1\0", line.replace('"', ""))
        choices.append([cell.replace("\0", " ") for cell in joined.split()])
        choices.append([cell.strip() for cell in re.split(r"[ \t]{2,}", line.strip())])
    choices += [cells_of(line, Marks(other)) for other in ("\t", ";", ",", "|") if other in line]
    choices.append([cell.strip(' \t,;|"') for cell in _BRACKETED.findall(line[: width * LONGEST_NAME])])
    fitting = [cells for cells in choices if len(cells) == width] or [choices[0]]
    cells = max(fitting, key=_units_in)
    return (cells + [""] * width)[:width]


def _units_in(cells: Sequence[str]) -> int:
    """Count the cells that are a unit, end in one, or name time."""
    whole = [cell for cell in cells if cell.strip(" ,;|") == cell]
    return sum(bool(name_and_unit(cell)[1]) or is_unit(cell) or is_time(cell, "") for cell in whole)


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
    """Take the last comment that names time, or a unit for every column, as a header.

    A comment below it that holds units only gives the units.
    """
    blank = Headings([""] * width, [""] * width)
    comments = [line.strip().lstrip(_BEFORE_COMMENTS).strip() for line in lines if _comments(line)]
    units: list[str] = []
    for comment in reversed(comments[-_MOST_COMMENTS:]):
        for words in (comment, _BEFORE_NAMES.sub("", comment, count=1)):
            row = _row(words, marks, width)
            if width == 1:
                row = [words]
            if not all(row[k] for k in filled):
                continue
            if not units and _all_units([row[k] for k in filled]):
                units = [cell.strip("()[] ") for cell in row]
                break
            parts = [name_and_unit(cell) for cell in row]
            found = _with_suffixes(Headings([name for name, _ in parts], [unit for _, unit in parts], tuple(row)))
            if is_time(found.names[filled[0]], found.units[filled[0]]) or all(found.units[k] for k in filled):
                own = [unit or below for unit, below in zip(found.units, units or blank.units, strict=True)]
                return Headings(found.names, own)
    return blank._replace(units=units) if units else blank


def _comments(line: str) -> bool:
    """Tell whether a line above the data is a comment, of any kind."""
    return line.lstrip().startswith(tuple(_BEFORE_COMMENTS.strip()))
