"""Command lines that a user is shown: they survive names of files that look like options, and names with blanks."""

from __future__ import annotations

from collections.abc import Iterable


def file_word(name: str) -> str:
    """Return the name of a file as a command takes it: one that begins as an option does leads through its folder.

    Examples
    --------
    >>> file_word("-rf.csv"), file_word("--out.csv"), file_word("shot 1.csv")
    ('./-rf.csv', './--out.csv', 'shot 1.csv')
    """
    return f"./{name}" if name.startswith("-") else name


def command_line(words: Iterable[str]) -> str:
    """Return the words behind ``strikewave`` as a line for a shell.

    Examples
    --------
    >>> command_line(["record", file_word("-a b.csv"), "--unit", "g"])
    "strikewave record './-a b.csv' --unit g"
    """
    import shlex  # each command of the screen imports this module for its names of files

    return shlex.join(["strikewave", *words])
