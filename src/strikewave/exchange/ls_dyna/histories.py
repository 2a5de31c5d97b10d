"""Contact forces and energies that LS-DYNA wrote: text ``rcforc``, ``glstat`` or ``binout``, in the file's units.

The text files line by line, as LSTC's own converter ``l2a`` writes them and as runs of ``smp d R16`` and ``mpp.190 s``
show::

    rcforc:  "  slave           1 time 0.00000E+00  x  0.00000E+00  y ... z ... mass ...", in newer versions "mx my mz";
             the sides are "slave" and "master", in newer versions "SURFA" and "SURFB"
    glstat:  " dt of cycle       1 is controlled by ...", then "name.....   value", one block for each output

A run that was killed leaves a last line without its end: it is left out. A run that was restarted writes some times
twice: the later lines count.

``binout`` is a data archive of LSTC: a tree of named arrays, spread over one file or several. A file begins with the
sizes of what follows (8 bytes: of this header, of lengths, offsets, commands and types, then the byte order), and is a
chain of records: length, command, content. Two commands matter: 2 goes to a folder of the tree, 3 holds an array: its
type, the length of its name, its name, its numbers. All else, the tables of contents included, is stepped over, so that
a file whose run was killed reads as far as it goes.

Source: ``lsda.py`` of LSTC, as lasso-python carries it on (BSD licence); its writer makes the files of the tests.

Names of the arrays: ``/rcforc/metadata/ids, side, legend_ids, legend`` and ``/rcforc/d000001/time, x_force, y_force,
z_force, mass``, ``/glstat/d000001/time, kinetic_energy, ...``, as LSTC's converter ``l2a`` reads them.
"""

from __future__ import annotations

import math
import mmap
import posixpath
import re
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, Literal, NamedTuple

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
        Number of the contact.
    side : str
        ``A`` (slave) or ``B`` (master).
    title : str
        Title of the contact; empty where it has none.
    time : array (outputs,)
        Rising.
    force : array (outputs, 3)
        Resultant on this side.
    """

    number: int
    side: str
    title: str
    time: Array
    force: Array


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
        raise InputError("FILE", path, "lines such as 'slave 1 time ...' or 'SURFA 1 time ...'", "is it an rcforc?")
    return tuple(_force(key, values, titles.get(key[0], "")) for key, values in sorted(rows.items()))


def read_glstat(path: Path) -> GlobalEnergies:
    """Return the energies of a file ``glstat``.

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
        raise InputError("FILE", path, "blocks that begin with 'dt of cycle', with a time", "is it a glstat?")
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
    return ContactForce(number, side, title, table[:, 0], table[:, 1:4])


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
        raise InputError("FILE", path, "a file that can be read", error.strerror or str(error)) from None


def _bad(path: Path, number: int, line: bytes, allowed: str, hint: str = "") -> InputError:
    return InputError(f"{path.name}, line {number}", show(line.decode("utf-8", "replace").strip())[1:-1], allowed, hint)


FOLDER, DATA = 2, 3
"""Commands that are followed."""
TYPES = {1: "i1", 2: "i2", 3: "i4", 4: "i8", 5: "u1", 6: "u2", 7: "u4", 8: "u8", 9: "f4", 10: "f8"}
"""Types of arrays by their number."""
LONGEST_PATH = 4096
"""Characters of a folder's path; those of LS-DYNA have some tens, and a hostile file could nest for ever."""
MOST_ARRAYS = 20_000_000
"""Records that a file may hold: millions of outputs of tens of arrays; bounds the time of records of no length."""


class Archived(NamedTuple):
    """An array of an archive: its path in the tree and its numbers."""

    path: str
    values: NDArray[Any]


class _LsdaHeader(NamedTuple):
    """Sizes of a length, a command and a type, bytes, and the byte order."""

    length: int
    command: int
    kind: int
    order: Literal["<", ">"]


def archived(path: Path) -> Iterator[Archived]:
    """Yield the arrays of an archive in the order of the file; numbers are views that end with the next one.

    A record that is cut off at the end of the file, and all after it, is left out.
    """
    try:
        if not path.is_file() or path.stat().st_size < 8:
            raise InputError("FILE", path, "a file of at least 8 bytes")
        with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as view:
            yield from _walked(path, view)
    except OSError as error:
        raise InputError("FILE", path, "a file that can be read", error.strerror or str(error)) from None


def _walked(path: Path, view: mmap.mmap) -> Iterator[Archived]:
    layout, place, folder, count = _layout(path, view), view[0], "/", 0
    head = layout.length + layout.command
    while place + head <= len(view):
        length = int.from_bytes(view[place : place + layout.length], _word(layout))
        command = int.from_bytes(view[place + layout.length : place + head], _word(layout))
        count += 1
        if length < head or count > MOST_ARRAYS:
            raise _damaged(path, place, f"a record of {length} bytes")
        if place + length > len(view):
            return
        if command == FOLDER:
            folder = _moved(path, folder, view[place + head : place + min(length, head + LONGEST_PATH)])
        elif command == DATA:
            yield _array(path, view, place, length, layout, folder)
        place += length


def _array(path: Path, view: mmap.mmap, place: int, length: int, layout: _LsdaHeader, folder: str) -> Archived:
    """Return the array of a record."""
    start = place + layout.length + layout.command
    kind = int.from_bytes(view[start : start + layout.kind], _word(layout))
    named = start + layout.kind + 1
    first = named + view[named - 1]
    end = place + length
    if first > end:
        raise _damaged(path, place, "a name beyond its record")
    name = view[named:first].decode("latin-1")
    dtype = np.dtype(TYPES.get(kind, "u1")).newbyteorder(layout.order)
    values = np.frombuffer(view[first:end], dtype, (end - first) // dtype.itemsize)
    return Archived(posixpath.join(folder, name), values)


def _layout(path: Path, view: mmap.mmap) -> _LsdaHeader:
    header, length, _, command, kind, order = view[:6]
    known = length in (2, 4, 8) and command in (1, 2, 4) and kind in (1, 2, 4) and order in (0, 1)
    if not (8 <= header <= 64 and known):
        raise InputError("FILE", path, "an archive of LS-DYNA (binout)", "its first bytes are of something else")
    return _LsdaHeader(length, command, kind, "<" if order else ">")


def _word(layout: _LsdaHeader) -> Any:
    return "little" if layout.order == "<" else "big"


def _moved(path: Path, folder: str, to: bytes) -> str:
    moved = posixpath.normpath(posixpath.join(folder, to.decode("latin-1").rstrip("\0")))
    if len(moved) > LONGEST_PATH:
        raise InputError("FILE", path, f"folders of at most {LONGEST_PATH} characters")
    return moved


def _damaged(path: Path, place: int, what: str) -> InputError:
    return InputError("FILE", f"{path.name}, byte {place}: {what}", "an archive of LS-DYNA (binout) that is whole")


def number_of(name: str) -> float:
    """Return the number of a folder of an output, ``d000012``; infinity for others.

    Examples
    --------
    >>> number_of("d000012"), number_of("metadata")
    (12, inf)
    """
    return int(name[1:]) if name[:1] == "d" and name[1:].isdecimal() and len(name) < 20 else math.inf


MOST_OUTPUTS = 10_000_000
"""Outputs that a file may hold: bounds the memory of a file that begins ever new ones."""
_NONE = np.empty(0)
"""Stands for an array that is missing."""
FORCES = ("x_force", "y_force", "z_force")
"""Arrays of the components of a contact force."""

Held = dict[str, dict[str, NDArray[Any]]]
"""Arrays by the folder in which they lie, such as ``d000001``."""


def read_binout(paths: Sequence[Path]) -> tuple[tuple[ContactForce, ...], GlobalEnergies | None]:
    """Return the contact forces and energies of one run's files ``binout``; empty and None where there are none."""
    branches: dict[str, Held] = {"rcforc": {}, "glstat": {}}
    for path in paths:
        for values in archived(path):
            folders = values.path.split("/")[1:]
            if len(folders) == 3 and folders[0] in branches:
                branches[folders[0]].setdefault(folders[1], {})[folders[2]] = np.array(values.values)
                if len(branches[folders[0]]) > MOST_OUTPUTS:
                    raise InputError("FILE", path, f"at most {MOST_OUTPUTS} outputs")
    where = paths[0] if paths else Path("binout")
    return _contacts(where, branches["rcforc"]), _energies(where, branches["glstat"])


def _contacts(path: Path, branch: Held) -> tuple[ContactForce, ...]:
    about = branch.pop("metadata", {})
    outputs = _in_order(path, "rcforc", branch)
    if not outputs or "ids" not in about:
        return ()
    for name in ("ids", "side", "legend_ids"):
        if name in about and about[name].dtype.kind not in "iu":
            raise InputError(f"{path.name}, rcforc/metadata/{name}", str(about[name].dtype), "whole numbers")
    numbers = about["ids"].astype(int)
    sides = about.get("side", np.zeros(numbers.size)).astype(bool)
    if sides.size != numbers.size:
        raise InputError("FILE", path, "a side for each contact in rcforc/metadata")
    time = _table(path, outputs, ("time",), 1)[:, 0, 0]
    force = _table(path, outputs, FORCES, numbers.size)
    titles = _titles(about)
    return tuple(
        ContactForce(number, "B" if is_master else "A", titles.get(number, ""), time, force[:, :, k])
        for k, (number, is_master) in enumerate(zip(numbers.tolist(), sides.tolist(), strict=True))
    )


def _energies(path: Path, branch: Held) -> GlobalEnergies | None:
    branch.pop("metadata", None)
    outputs = _in_order(path, "glstat", branch)
    if not outputs:
        return None
    names = dict.fromkeys(
        name for output in outputs for name, values in output.items() if values.size and name != "time"
    )
    table = {}
    for name in names:
        columns = [output.get(name) for output in outputs]
        if all(values is None or values.dtype.kind in "if" for values in columns):
            sums = [None if values is None else float(values.sum(dtype=float)) for values in columns]
            _check_finite(path, f"glstat {name}", np.array([total for total in sums if total is not None]))
            table[_words(name)] = np.array([math.nan if total is None else total for total in sums])
    return GlobalEnergies(np.array([float(output["time"][0]) for output in outputs]), table)


def _in_order(path: Path, branch: str, folders: Held) -> list[dict[str, NDArray[Any]]]:
    """Return the outputs that have a time by their number, without those that a restart wrote again.

    A last one that lacks what all others have was cut off, and is left out.
    """
    outputs = [folders[name] for name in sorted(folders, key=number_of) if folders[name].get("time", _NONE).size == 1]
    if not outputs:
        return []
    time = np.array([float(output["time"][0]) for output in outputs])
    _check_finite(path, f"{branch} time", time)
    outputs = [output for output, keep in zip(outputs, last_pass(time), strict=True) if keep]
    if len(outputs) > 1 and not set.intersection(*map(set, outputs[:-1])) <= outputs[-1].keys():
        outputs.pop()
    return outputs


def _check_finite(path: Path, what: str, values: NDArray[Any]) -> None:
    if not np.isfinite(values).all():
        raise InputError(f"{path.name}, {what}", "NaN or infinity", "finite numbers", "the run blew up there")


def _table(path: Path, outputs: list[dict[str, NDArray[Any]]], names: tuple[str, ...], count: int) -> Array:
    """Return arrays of all outputs, (outputs, names, count); an output that lacks one is refused."""
    for output in outputs:
        for name in names:
            if output.get(name, _NONE).size != count:
                got = f"{output.get(name, _NONE).size} numbers"
                raise InputError(f"{path.name}, rcforc {name}", got, f"{count} in each output", "is the run whole?")
            _check_finite(path, f"rcforc {name}", output[name])
    return np.array([[output[name] for name in names] for output in outputs], float)


def _titles(about: dict[str, NDArray[Any]]) -> dict[int, str]:
    """Return the titles of contacts by number; all are as long as each other, 70 or 80 characters."""
    numbers, text = about.get("legend_ids", _NONE), about.get("legend", _NONE).tobytes()
    if not numbers.size:
        return {}
    each = len(text) // numbers.size
    pieces = (text[k * each : (k + 1) * each] for k in range(numbers.size))
    return {int(n): title_of(piece) for n, piece in zip(numbers, pieces, strict=True)}


def _words(name: str) -> str:
    """Return the name that an energy has in ``glstat``.

    Examples
    --------
    >>> _words("sliding_interface_energy"), _words("energy_ratio")
    ('sliding interface energy', 'total energy / initial energy')
    """
    return "total energy / initial energy" if name == "energy_ratio" else name.replace("_", " ")
