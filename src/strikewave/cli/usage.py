"""A wrong word on the command line, said as every other wrong input: which option, what came, what is allowed."""

from __future__ import annotations

import errno
import os
import re
import sys
from typing import TYPE_CHECKING, Any

import typer

from strikewave.base.command_line import file_word
from strikewave.base.errors import LONGEST_SHOWN, MISSING, InputError, show
from strikewave.cli.group import entries
from strikewave.reporting.options.kinds import one_of_words, wrong_choice

if TYPE_CHECKING:
    from typer.core import TyperArgument, TyperOption


REFUSED_NAMES = (errno.ENAMETOOLONG, errno.ELOOP)
"""Numbers of the errors of a system that takes a path for no name at all."""


FILE_NAME = re.compile(r"-[^=]*\.[A-Za-z]\w*")
"""A word that begins as an option does, and ends as the name of a file."""


def shortened(word: str) -> str:
    """Return a word, without its end where it is longer than an error shows."""
    return word if len(word) <= LONGEST_SHOWN else word[:LONGEST_SHOWN] + "..."


def usage_line(error: Exception) -> str | None:
    """Return the line that tells of an error that typer found; None for any other error."""
    if isinstance(error, OSError) and error.errno in REFUSED_NAMES:
        return f"{show(str(error.filename))}: {error.strerror}"
    if not hasattr(error, "format_message"):
        return None
    context = getattr(error, "ctx", None)
    path = context.command_path if context else _path_of(sys.argv[1:])
    help_of = f"see `{path} --help`"
    if isinstance(error, typer.BadParameter) and error.param is not None:
        wrong = _of_option(error, error.param, help_of)
        if wrong is not None:
            return str(wrong)
    words = " ".join(shortened(word) for word in str(error.format_message()).rstrip(". ").split())
    if "unexpected extra argument" in words:  # as the shell cuts --set machine.height=60 cm
        words += ": put quotes around a value that has a space"
    files = [word for word in sys.argv[1:] if word.startswith("-") and _may_be_file(word)]
    if "No such option" in words and files:
        words += f": to name the file {shortened(files[0])}, write {shortened(file_word(files[0]))}"
    return f"{path}: {words} ({help_of})"


def _may_be_file(word: str) -> bool:
    return FILE_NAME.fullmatch(word) is not None or os.path.lexists(word)


def _path_of(words: list[str]) -> str:
    """Return the command that was typed, for an error that does not know it."""
    return " ".join(["strikewave", *(word for word in words[:1] if word in entries())])


def _of_option(error: typer.BadParameter, option: TyperArgument | TyperOption | Any, help_of: str) -> InputError | None:
    """Return what is wrong with the value of an option; None where typer does not say what came."""
    is_argument = option.param_type_name == "argument"
    field = (option.metavar or option.name.upper()).strip("[].") if is_argument else option.opts[-1]
    choices = option.type_descriptor.choices
    if not error.message:
        needed = one_of_words(choices) if choices else _lowered(option.help)
        return InputError(field, MISSING, needed, help_of)
    reasons: list[dict[str, Any]] = getattr(error.__cause__, "errors", list)()
    if not reasons:
        return None
    got = reasons[0]["input"]
    if choices:
        return wrong_choice(got, field, choices)
    return InputError(field, _number(got), _number_words(option), help_of)


def _number_words(option: Any) -> str:
    """Return what a number may be."""
    what = "a whole number" if option.type_descriptor.annotation in (int, list[int]) else "a number"
    if option.min is None:
        return what
    return f"{what}, at least {option.min}" if option.max is None else f"{what} from {option.min} to {option.max}"


def _number(text: str) -> int | float | str:
    """Return a typed number, which an error shows without quotes."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _lowered(words: str | None) -> str:
    """Return a help text as a part of a sentence."""
    text = (words or "a value").rstrip(".")
    return text[0].lower() + text[1:]
