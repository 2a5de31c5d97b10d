"""LSTC's data archive, the format of ``binout``: a tree of named arrays, spread over one file or several.

A file begins with the sizes of what follows (8 bytes: of this header, of lengths, offsets, commands and types, then the
byte order), and is a chain of records: length, command, content. Two commands matter: 2 goes to a folder of the tree,
3 holds an array: its type, the length of its name, its name, its numbers. All else, the tables of contents included, is
stepped over, so that a file whose run was killed reads as far as it goes.

Source: ``lsda.py`` of LSTC, as lasso-python carries it on (BSD licence); its writer makes the files of the tests.
"""

from __future__ import annotations

import math
import mmap
import posixpath
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError

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

    Raises
    ------
    InputError
        If the file cannot be read or is no archive.
    """
    try:
        if not path.is_file() or path.stat().st_size < 8:
            raise InputError("FILE", str(path), "a file of at least 8 bytes")
        with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as view:
            yield from _walked(path, view)
    except OSError as error:
        raise InputError("FILE", str(path), "a file that can be read", error.strerror or str(error)) from None


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
        raise InputError("FILE", str(path), "an archive of LS-DYNA (binout)", "its first bytes are of something else")
    return _LsdaHeader(length, command, kind, "<" if order else ">")


def _word(layout: _LsdaHeader) -> Any:
    return "little" if layout.order == "<" else "big"


def _moved(path: Path, folder: str, to: bytes) -> str:
    moved = posixpath.normpath(posixpath.join(folder, to.decode("latin-1").rstrip("\0")))
    if len(moved) > LONGEST_PATH:
        raise InputError("FILE", str(path), f"folders of at most {LONGEST_PATH} characters")
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
