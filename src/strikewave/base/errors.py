"""Errors that name the field, what came, what is allowed and what to do; and warnings."""

from __future__ import annotations

import difflib
import enum
import errno
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path, PurePath
from typing import Any, TypeVar

T = TypeVar("T")


class _Missing(enum.Enum):
    """One member, which stays the same where an error goes to another process."""

    MISSING = enum.auto()


MISSING = _Missing.MISSING
"""Stands for what came where nothing came."""
EXISTING_FILE, EXISTING_CASE = "an existing file", "a case file or a built-in case"
"""Allowed values where a name leads to nothing: the message then reads "no such file: x", all there is to say."""
_NOT_THERE = {EXISTING_FILE: "no such file", EXISTING_CASE: "no such case"}
LONGEST_SHOWN = 60
"""Characters of a value in an error line: with field and hint it still is one line of a terminal."""
LONGEST_WORD, ALIKE, MOST_CHOICES = 80, 0.6, 40
"""Characters of a word that are compared, since the time grows with their square; likeness from which on a choice is
offered, that of `difflib`, at which two of five letters may be wrong; and choices that are listed where none is like
it."""


class StrikewaveError(Exception):
    """Base of every error that strikewave raises on purpose."""


class InputError(StrikewaveError, ValueError):
    """An input that cannot be used: which field, what came, what is allowed, what to do.

    Parameters
    ----------
    field : str
        Path of the field, such as ``machine.speed`` or ``--speed``; an argument of a command is named by its metavar.
    got : object
        Value that was given: a `pathlib.Path` of a file or folder, `MISSING` where nothing came.
    allowed : str
        Values that would have been accepted; `EXISTING_FILE` or `EXISTING_CASE` where a name leads to nothing.
    hint : str, optional
        Next step, or the nearest match.

    Examples
    --------
    >>> str(InputError("machine.speed", "730", "a rotational speed with its unit", 'write "730 rpm"'))
    'machine.speed: got "730"; allowed: a rotational speed with its unit; write "730 rpm"'
    >>> str(InputError("load.file", "blow.csv", EXISTING_FILE)), str(InputError("FILE", "blow.csv", EXISTING_FILE))
    ('load.file: no such file: blow.csv', 'no such file: blow.csv')
    >>> str(InputError("--out", PurePath("out/map"), "a new folder", "add --force to replace what it holds"))
    '--out: out/map cannot be used; needed: a new folder; add --force to replace what it holds'
    """

    def __init__(self, field: str, got: object, allowed: str, hint: str = "") -> None:
        self.field = field
        self.got = got
        self.allowed = allowed
        self.hint = hint
        name = show(str(got)).strip('"')
        where = f"{field}: "
        if got is MISSING:
            fault = f"missing; needed: {allowed}"
        elif allowed in _NOT_THERE:
            fault = f"{_NOT_THERE[allowed]}: {name}"
            where = "" if field.isupper() or field == "case" else where  # the name says which argument it is
        elif isinstance(got, PurePath):
            fault = f"{name} cannot be used; needed: {allowed}"
            where = "" if field.isupper() else where
        else:
            fault = f"got {show(got)}; allowed: {allowed}"
        super().__init__(where + fault + (f"; {hint}" if hint else ""))

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the error anew where it comes to another process."""
        return type(self), (self.field, self.got, self.allowed, self.hint)

    def at(self, field: str) -> InputError:
        """Return the same error of a field that has another name where the input came from.

        Examples
        --------
        >>> str(InputError("radius", -1.0, "a length above zero").at("striker.nose_radius"))
        'striker.nose_radius: got -1.0; allowed: a length above zero'
        """
        return InputError(field, self.got, self.allowed, self.hint)


class MissingPackageError(InputError):
    """A package that is not installed, and the extra of strikewave that brings it.

    Examples
    --------
    >>> str(MissingPackageError("--xlsx", "openpyxl", "formats"))
    "--xlsx needs openpyxl: pip install 'strikewave[formats]'"
    """

    def __init__(self, field: str, package: str, extra: str) -> None:
        self.field, self.got, self.allowed, self.hint = field, MISSING, package, extra
        ValueError.__init__(self, f"{field} needs {package}: pip install 'strikewave[{extra}]'")

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the error anew where it comes to another process."""
        return type(self), (self.field, self.allowed, self.hint)

    def at(self, field: str) -> MissingPackageError:
        """Return the same error of a field that has another name where the input came from."""
        return MissingPackageError(field, self.allowed, self.hint)


class InputErrors(InputError):  # noqa: N818  (it is several)
    """Several inputs that cannot be used, one line each; what catches `InputError` catches it too.

    Each line names its own field, so ``field``, ``allowed`` and ``hint`` are empty, and ``got`` is `MISSING`.

    Examples
    --------
    >>> try:
    ...     raise InputErrors(["striker: missing; add [striker]", "object: missing; add [object]"])
    ... except InputError as error:
    ...     print(error)
    striker: missing; add [striker]
    object: missing; add [object]
    """

    def __init__(self, lines: Iterable[str]) -> None:
        self.lines = tuple(lines)
        self.field, self.got, self.allowed, self.hint = "", MISSING, "", ""
        ValueError.__init__(self, "\n".join(self.lines))

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the errors anew where they come to another process."""
        return type(self), (self.lines,)

    def at(self, field: str) -> InputErrors:
        """Return the error as it is: each line names its field already."""
        return self


class IntegrationError(StrikewaveError, RuntimeError):
    """The motion could not be integrated to its end; the message says where and why."""


class StrikewaveWarning(UserWarning):
    """Something the user should know that does not stop the work."""


def checked(path: str, make: Callable[[], T]) -> T:
    """Make a part; what its own room refuses becomes an error that names the field.

    Examples
    --------
    >>> checked("striker.mass", lambda: float("heavy"))
    Traceback (most recent call last):
    strikewave.base.errors.InputErrors: striker.mass: could not convert string to float: 'heavy'
    """
    try:
        return make()
    except StrikewaveError:
        raise
    except ValueError as error:
        raise InputErrors([f"{path}: {error}"]) from None


def show(value: object, longest: int = LONGEST_SHOWN) -> str:
    """Write a value for an error line: quoted when text, printable, never longer than ``longest``.

    Examples
    --------
    >>> show("a" * 100, longest=8)
    '"aaaaaaaa..."'
    """
    text = value if isinstance(value, str) else repr(value)
    text = "".join(c if c.isprintable() else "?" for c in text[: longest + 1])
    text = text if len(text) <= longest else text[:longest] + "..."
    return f'"{text}"' if isinstance(value, str) else text


def nearest(word: str, choices: Iterable[str]) -> str:
    """Name the choice nearest to a mistyped word as a hint, or list the choices.

    Examples
    --------
    >>> nearest("sped", ["speed", "radius"])
    'did you mean "speed"?'
    >>> nearest("zzz", ["speed", "radius"])
    'choose from: radius, speed'
    """
    known = sorted(set(choices))
    folded = {choice.lower(): choice for choice in known}
    match = difflib.get_close_matches(str(word).lower()[:LONGEST_WORD], folded, n=1, cutoff=ALIKE)
    if match:
        return f'did you mean "{folded[match[0]]}"?'
    return "choose from: " + ", ".join(known[:MOST_CHOICES])


FULL = (errno.ENOSPC, errno.EDQUOT)
"""System errors of a full disk, or of a full quota of the user on it."""


def refusal(error: OSError, path: Path) -> str:
    """Return the reason why the system refused to write at a place; of a full disk its place and free room.

    Examples
    --------
    >>> refusal(PermissionError(errno.EACCES, "Permission denied"), Path("a"))
    'Permission denied'
    >>> refusal(OSError(errno.EFBIG, "File too large"), Path("a"))
    'File too large: the system limits the size of a file here (ulimit -f)'
    """
    reason = error.strerror or str(error)
    if error.errno == errno.EFBIG:
        return f"{reason}: the system limits the size of a file here (ulimit -f)"
    if error.errno not in FULL:
        return reason
    place = next(folder for folder in (path.absolute(), *path.absolute().parents) if folder.exists())
    disk = next((folder for folder in (place, *place.parents) if folder.is_mount()), place)
    free = shutil.disk_usage(place).free / 1e6
    return f"{reason}: {free:.1f} MB are free on the disk at {disk}; free more, or choose another place"
