"""What a command works on, and of what the result is that stands in the folder it would write."""

from __future__ import annotations

import contextlib
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from strikewave.base.errors import InputError, show
from strikewave.base.output_folder import MARKS, mark_of, mark_text

ORIGIN = "record.toml"
"""The file of a result that says what was asked, and of what."""
CASE = MARKS[0]
"""The file of a result that runs again."""
LISTED = 2
"""Inputs that an error names; the others are counted."""

_inputs: ContextVar[tuple[str, ...]] = ContextVar("inputs", default=())


@contextlib.contextmanager
def working_on(inputs: Sequence[str]) -> Iterator[None]:
    """Work on these, files or names of built-in cases as they were typed, as long as the context lasts."""
    token = _inputs.set(tuple(os.fsencode(name).decode("utf-8", "backslashreplace") for name in inputs))
    try:
        yield
    finally:
        _inputs.reset(token)


def command_inputs() -> tuple[str, ...]:
    """Return what the command that runs now works on; nothing in Python.

    Examples
    --------
    >>> with working_on(["shot.csv"]):
    ...     command_inputs()
    ('shot.csv',)
    """
    return _inputs.get()


def origin_text(command: str, digests: Mapping[str, str] | None = None, test: Mapping[str, Any] | None = None) -> str:
    """Return what was asked of which inputs: of measured files with their SHA-256, and what is stated of the test."""
    import tomlkit  # takes longer than all else that a command needs to show its help

    document = tomlkit.document()
    document.add("schema", tomlkit.item(1))
    document.add("command", tomlkit.item(command))
    if command_inputs():
        document.add("input", tomlkit.item(list(command_inputs())))
    if digests is not None:
        files = tomlkit.aot()
        for path, digest in digests.items():
            files.append(tomlkit.item({"path": path, "sha256": digest}))
        document.add("file", files)
    if test:
        document.add("test", tomlkit.item(dict(test)))
    return tomlkit.dumps(document)


def is_within(folder: Path) -> bool:
    """Tell whether the command works on a file of that very folder, as where ``out/NAME/case.toml`` runs again."""
    home = _absolute(folder)
    return any(home in (path, *path.parents) for path in map(_absolute, command_inputs()))


def _absolute(name: str | Path) -> Path:
    """Return where a name leads without ``..``, which would hide that a file lies below a folder."""
    return Path(os.path.abspath(name))


def check_inputs_stay(folder: Path) -> None:
    """Refuse to replace a result that holds an input of the new one, but for its case, which the new one has too.

    Raises
    ------
    InputError
        With the input.
    """
    home = _absolute(folder)
    for name in command_inputs():
        path = _absolute(name)  # of "history.csv#2" the file is below that folder too
        if home in path.parents and path != home / CASE:
            hint = "choose another folder by --out DIR, or move the input first"
            raise InputError("--out", str(folder), f"a folder without an input, and it holds {show(name)}", hint)


def check_inputs(folder: Path, identity: str | None) -> None:
    """Refuse the folder that a command chose by itself where it holds the result of another input.

    The same inputs, more or fewer of them, may have changed, and their result is replaced: who edits a case runs it
    again. Two files of one name in two folders, or two cases of one name, are no such thing.

    Parameters
    ----------
    folder : Path
        The folder.
    identity : str or None
        The text that will mark it, where it is known: the very same result is replaced from wherever it was asked.

    Raises
    ------
    InputError
        If the result there is of none of the inputs, or of one that is no longer among them beside another new one.
    """
    now, before = _places(command_inputs()), _inputs_of(folder)
    known = _places(before)
    if not now or not known or is_within(folder) or now <= known or known <= now:
        return
    mark = mark_of(folder)
    if identity is not None and mark is not None and mark_text(mark) == identity:
        return
    is_case = mark is not None and mark.name != ORIGIN
    others = [name for name in before if os.path.abspath(name) not in now]
    named = ", ".join(show(name) for name in others[:LISTED])
    named += f" and {len(others) - LISTED} more" if len(others) > LISTED else ""
    way = "give the case another name, choose" if is_case else "choose"
    hint = f"it holds the result of {named}; {way} another folder by --out DIR, or replace it by --force"
    raise InputError("--out", str(folder), "a folder without the result of another input", hint)


def _places(names: Sequence[str]) -> set[str]:
    """Return the whole paths of inputs, however they were typed; that of a built-in case is as good as its name."""
    return {os.path.abspath(name) for name in names}


def _inputs_of(folder: Path) -> tuple[str, ...]:
    """Return of what the result in a folder is; nothing where it does not say."""
    try:
        told = tomllib.loads((folder / ORIGIN).read_text("utf-8")).get("input", ())
    except (OSError, ValueError):
        return ()
    return tuple(name for name in told if isinstance(name, str) and "\0" not in name) if isinstance(told, list) else ()
