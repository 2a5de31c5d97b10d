"""Contact forces and energies that LS-DYNA wrote: its text files ``rcforc`` and ``glstat``, in the units of the file.

Line by line, as LSTC's own converter ``l2a`` writes them and as runs of ``smp d R16`` and ``mpp.190 s`` show::

    rcforc:  "  slave           1 time 0.00000E+00  x  0.00000E+00  y ... z ... mass ...", in newer versions "mx my mz";
             the sides are "slave" and "master", in newer versions "SURFA" and "SURFB"
    glstat:  " dt of cycle       1 is controlled by ...", then "name.....   value", one block for each output

A run that was killed leaves a last line without its end: it is left out. A run that was restarted writes some times
twice: the later lines count.
"""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, show

Array = NDArray[np.float64]

LARGEST_FILE = 4 << 30
"""Bytes of a file that is read, of histories of either code: millions of outputs of tens of contacts."""
LONGEST_LINE = 1000
"""Characters of a line; LS-DYNA writes less than 200, and a file without line ends is no text of its own."""
MOST_SERIES = 20_000
"""Sides of contacts that a file may hold: bounds the memory of a file that names ever new ones."""
MOST_ENERGIES = 200
"""Names of energies that a file may hold; LS-DYNA writes about thirty."""
LABELS = (b"time", b"x", b"y", b"z", b"mass", b"mx", b"my", b"mz")
"""Words before the numbers of a line of ``rcforc``."""
SIDES = {b"slave": "A", b"surfa": "A", b"master": "B", b"surfb": "B"}
"""Words that begin a line of ``rcforc``, and the side that they name."""
_FORTRAN = re.compile(rb"([+-]?\d+\.\d*)([+-]\d{3})")
"""A number whose exponent of three digits has pushed out its letter."""
_ENTRY = re.compile(rb"\s*(\S.*?)[ .]*\.\s*([-+]?[\d.][-+.\dEeDd]*|\*+)(?:\s|$)")
"""A name, dots, and its value, or stars where it did not fit."""
_CYCLE = re.compile(rb"\s*dt of cycle\s+\d+")
"""First line of an output of ``glstat``."""
_LEGEND = re.compile(rb"\s*(\d+)\s+(.*)")
"""Number and title of a contact."""


@dataclass(frozen=True)
class ContactForce:
    """Force on one side of a contact, in the units of the file.

    Attributes
    ----------
    number : int
        Of the contact.
    side : str
        ``A`` (slave) or ``B`` (master).
    title : str
        Of the contact; empty where it has none.
    time : array (outputs,)
        Rising.
    force : array (outputs, 3)
        Resultant on this side.
    mass : array (outputs,)
        Of the nodes that touch, where the file has it; else 0.
    moment : array (outputs, 3) or None
        About the origin, where the file has it.
    """

    number: int
    side: str
    title: str
    time: Array
    force: Array
    mass: Array
    moment: Array | None = None


@dataclass(frozen=True)
class GlobalEnergies:
    """Energies of the whole model by their names in the file, such as ``kinetic energy``; units of the file.

    Attributes
    ----------
    time : array (outputs,)
        Rising.
    values : mapping of str to array (outputs,)
        NaN where an output lacks one. Those of several walls are added up.
    """

    time: Array
    values: Mapping[str, Array] = field(default_factory=dict)


def read_rcforc(path: Path) -> tuple[ContactForce, ...]:
    """Return the contact forces of a file ``rcforc``, by number and side.

    Contacts of a surface with itself have no resultant and are left out.

    Raises
    ------
    InputError
        If the file is missing, too large, holds no force, or a line is not as LS-DYNA writes it.

    Examples
    --------
    >>> import tempfile
    >>> line = "  slave           1 time 1.00000E-06  x  0.00000E+00  y  0.00000E+00  z -5.00000E+01 mass  0.00000E+00"
    >>> with tempfile.TemporaryDirectory() as home:
    ...     path = Path(home) / "rcforc"
    ...     _ = path.write_text(line + chr(10))
    ...     curves = read_rcforc(path)
    >>> curves[0].number, curves[0].side, curves[0].force.tolist()
    (1, 'A', [[0.0, 0.0, -50.0]])
    """
    titles: dict[int, str] = {}
    rows: dict[tuple[int, str, int], array[float]] = {}
    in_legend = False
    for number, line in _lines(path):
        words = line.split()
        side = SIDES.get(words[0].lower()) if words else None
        if side is not None and not in_legend:
            key, values = _force_line(path, number, side, words)
            rows.setdefault(key, array("d")).extend(values)
            if len(rows) > MOST_SERIES:
                raise _bad(path, number, line, f"at most {MOST_SERIES} sides of contacts")
        elif b"END LEGEND" in line or b"BEGIN LEGEND" in line:
            in_legend = b"BEGIN" in line
        elif in_legend and (legend := _LEGEND.match(line)):
            titles[int(legend[1])] = title_of(legend[2])
    if not rows:
        raise InputError(
            "FILE", str(path), "lines such as 'slave 1 time ...' or 'SURFA 1 time ...'", "is it an rcforc?"
        )
    return tuple(_force(key, values, titles.get(key[0], "")) for key, values in sorted(rows.items()))


def read_glstat(path: Path) -> GlobalEnergies:
    """Return the energies of a file ``glstat``.

    Raises
    ------
    InputError
        If the file is missing, too large, holds no output, or a line is not as LS-DYNA writes it.

    Examples
    --------
    >>> import tempfile
    >>> text = '''
    ...  dt of cycle       1 is controlled by solid              7 of part         1
    ...
    ...  time...........................   1.00000E-06
    ...  kinetic energy.................   2.50000E-01
    ...  hourglass energy ..............   0.00000E+00
    ... '''
    >>> with tempfile.TemporaryDirectory() as home:
    ...     path = Path(home) / "glstat"
    ...     _ = path.write_text(text)
    ...     energies = read_glstat(path)
    >>> energies.time.tolist(), {name: values.tolist() for name, values in energies.values.items()}
    ([1e-06], {'kinetic energy': [0.25], 'hourglass energy': [0.0]})
    """
    blocks: list[dict[str, float]] = []
    names: dict[str, None] = {}
    for number, line in _lines(path):
        if _CYCLE.match(line):
            blocks.append({})
        elif blocks and (entry := _ENTRY.match(line)):
            name = entry[1].decode("utf-8", "replace").rstrip(" .")
            names[name] = None
            value = math.nan if entry[2].startswith(b"*") else _number(path, number, line, entry[2])
            blocks[-1][name] = blocks[-1].get(name, 0.0) + value
            if len(names) > MOST_ENERGIES:
                raise _bad(path, number, line, f"at most {MOST_ENERGIES} names of energies")
    if len(blocks) > 1 and not set.intersection(*map(set, blocks[:-1])) <= blocks[-1].keys():
        blocks.pop()  # cut off: it lacks what all others have
    if not any("time" in block for block in blocks):
        raise InputError("FILE", str(path), "blocks that begin with 'dt of cycle', with a time", "is it a glstat?")
    blocks = [block for block in blocks if "time" in block]
    table = np.array([[block.get(name, math.nan) for name in names] for block in blocks])
    columns = dict(zip(names, table[last_pass(table[:, list(names).index("time")])].T, strict=True))
    return GlobalEnergies(columns.pop("time"), columns)


def title_of(stored: bytes) -> str:
    r"""Return a title as text that does no harm on a screen.

    Examples
    --------
    >>> title_of(b"ball \x1b[31m  \0")
    'ball ?[31m'
    """
    text = stored.decode("utf-8", "replace").strip(" \0\r\n\t")
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _force_line(path: Path, number: int, side: str, words: list[bytes]) -> tuple[tuple[int, str, int], list[float]]:
    """Return contact, side and count of numbers of a line, and its numbers."""
    count = (len(words) - 2) // 2
    if tuple(words[2::2]) != LABELS[: len(words[2::2])] or len(words) % 2 or count not in (4, 5, 8):
        raise _bad(path, number, b" ".join(words), "a side, its number, then time, x, y, z, mass and mx, my, mz")
    if not words[1].isdigit():
        raise _bad(path, number, b" ".join(words), "the number of a contact after its side")
    values = [_number(path, number, word, word) for word in words[3::2]]
    return (int(words[1]), side, count), values


def _force(key: tuple[int, str, int], values: array[float], title: str) -> ContactForce:
    number, side, count = key
    table = np.frombuffer(values, float).reshape(-1, count)
    table = table[last_pass(table[:, 0])]
    mass = table[:, 4] if count > 4 else np.zeros(len(table))
    return ContactForce(number, side, title, table[:, 0], table[:, 1:4], mass, table[:, 5:] if count > 5 else None)


def last_pass(time: Array) -> NDArray[np.bool_]:
    """Return which outputs count where a restart went back in time: those that no later one comes before.

    Examples
    --------
    >>> last_pass(np.array([0.0, 1.0, 2.0, 1.0, 2.0, 3.0])).tolist()
    [True, False, False, True, True, True]
    """
    after = np.append(np.minimum.accumulate(time[::-1])[::-1][1:], math.inf)
    return np.asarray(time < after)


def _number(path: Path, number: int, line: bytes, word: bytes) -> float:
    """Return a number as C or Fortran writes it (``1.0-100`` has an exponent); anything else is refused."""
    try:
        value = float(word)
    except ValueError:
        fortran = _FORTRAN.fullmatch(word)
        if fortran is None:
            raise _bad(path, number, line, "numbers such as 1.23456E+02") from None
        value = float(fortran[1] + b"E" + fortran[2])
    if not math.isfinite(value):
        raise _bad(path, number, line, "finite numbers", "the run blew up there; cut the file before that line")
    return value


def _lines(path: Path) -> Iterator[tuple[int, bytes]]:
    """Yield the lines of a file with their numbers; a last one without its end is left out."""
    with _opened(path) as file:
        for number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE), b""), 1):
            if line.endswith(b"\n"):
                yield number, line
            elif len(line) == LONGEST_LINE:
                raise _bad(path, number, line, f"lines of less than {LONGEST_LINE} characters")


def _opened(path: Path) -> IO[bytes]:
    try:
        size = path.stat().st_size
        if not path.is_file() or size > LARGEST_FILE:
            raise InputError("FILE", f"{path}, {size} bytes", f"a file of at most {LARGEST_FILE} bytes")
        return path.open("rb")
    except OSError as error:
        raise InputError("FILE", str(path), "a file that can be read", error.strerror or str(error)) from None


def _bad(path: Path, number: int, line: bytes, allowed: str, hint: str = "") -> InputError:
    return InputError(f"{path.name}, line {number}", show(line.decode("utf-8", "replace").strip())[1:-1], allowed, hint)
