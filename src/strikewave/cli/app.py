"""The command ``strikewave``: runs a command, and turns errors into one line and an exit code.

Exit codes: 0 done, 1 our fault, 2 bad input, 3 done but a check failed, 128 + n stopped by signal n (Ctrl-C is 2).
"""

from __future__ import annotations

import errno
import gc
import io
import os
import re
import sys
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from strikewave._version import __version__
from strikewave.base.errors import (
    FULL,
    LONGEST_SHOWN,
    MISSING,
    InputError,
    StrikewaveError,
    StrikewaveWarning,
    nearest,
    refusal,
    show,
)
from strikewave.base.processes import Stopped, exit_code, heed
from strikewave.base.texts import file_word
from strikewave.cli.group import SETTINGS, CommandGroup, entries
from strikewave.reporting.options import one_of_words, wrong_choice
from strikewave.reporting.terminal import complain, say

if TYPE_CHECKING:
    from typer.core import TyperArgument, TyperOption

app = typer.Typer(
    name="strikewave",
    cls=CommandGroup,
    help="Predict, measure and design high-g impact tests.",
    epilog="The options of a command: strikewave COMMAND --help",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings=SETTINGS,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"strikewave {__version__}\n")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(False, "--version", help="Print the version.", callback=_print_version, is_eager=True),
) -> None:
    """Predict, measure and design high-g impact tests."""


# on matrices as small as ours threads wait, and by turning, which takes fifteen times as long on cores with other work
LINEAR_ALGEBRA_THREADS = "1"
"""Threads of linear algebra, where nothing else is asked for."""
YOUNG_OBJECTS = 50_000  # at Python's own 700 the collector takes 9 % of a run with its files
"""Objects after which the garbage collector looks for circles."""


def main() -> None:
    """Run the command line and exit."""
    _open_closed_streams()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", LINEAR_ALGEBRA_THREADS)  # read when numpy is imported, which is later
    gc.set_threshold(YOUNG_OBJECTS, *gc.get_threshold()[1:])
    heed()
    warnings.showwarning = _show_warning
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # no letter that a terminal lacks costs a result
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.exit(_run())


def _open_closed_streams() -> None:
    """Let streams that the caller closed lead nowhere: else the next file that is opened takes their output."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            os.open(os.devnull, os.O_RDWR)
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115 (until the end)


def _show_warning(message: Warning | str, category: type[Warning], *rest: Any, **more: Any) -> None:
    if issubclass(category, StrikewaveWarning):
        say(f"warning: {message}")


COMPILER_SETTINGS = ".numba_config.yaml"
"""File from which numba takes settings, wherever a program is run."""


def _run() -> int:
    """Run and return the exit code."""
    try:
        # no settings of libraries are taken from the folder that the program is run in, which holds data
        if Path(COMPILER_SETTINGS).exists():
            allowed = "no settings of numba in the folder that strikewave is run in: they would change what is computed"
            raise InputError("folder", COMPILER_SETTINGS, allowed)
        if Path("matplotlibrc").exists():
            import matplotlib

            matplotlib.rcdefaults()
        code = int(app(prog_name="strikewave", standalone_mode=False) or 0)
        sys.stdout.flush()
    except (Stopped, typer.Abort, KeyboardInterrupt) as stop:
        cause = stop.__cause__ or stop  # typer makes one of its own of Ctrl-C
        complain(f"stopped; {next(iter(getattr(cause, '__notes__', ())), 'nothing was written')}")
        return exit_code(stop.__cause__ or stop)
    except StrikewaveError as error:
        complain(str(error))
        return 2
    except BrokenPipeError:
        _drop_output()
        return 0
    except SystemExit as end:
        if not isinstance(end.__context__, BrokenPipeError):
            raise
        return 0  # typer and rich take a reader that has left, such as head, for a failure
    except MemoryError:
        less = "a smaller recorder.memory, a larger solver.output_step or step, or fewer taps take less"
        complain(f"out of memory: {less}")
        return 2
    except Exception as error:
        wrong = usage_line(error) or _limit_line(error)
        if wrong is not None:
            complain(wrong)
            return 2
        if os.environ.get("STRIKEWAVE_TRACE"):
            raise
        complain(f"internal error ({type(error).__name__}: {error}); please report it, with STRIKEWAVE_TRACE=1 set")
        return 1
    return code


def _drop_output() -> None:
    """Let output that nobody took lead nowhere, so that Python does not try once more at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


LIMITS = {*FULL, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EROFS, errno.EIO}
"""Limits of the system that may be met anywhere, with no input to blame: room, numbers of open files, a disk."""


def _limit_line(error: Exception) -> str | None:
    """Return the line on a limit of the system; None where it is another error."""
    if not isinstance(error, OSError) or error.errno not in LIMITS:
        return None
    if error.filename is not None:
        return f"{error.filename}: {refusal(error, Path(os.fsdecode(error.filename)))}"
    _drop_output()
    return f"the system refused what was to be printed or written: {error.strerror}"


REFUSED_NAMES = (errno.ENAMETOOLONG, errno.ELOOP)
"""Numbers of the errors of a system that takes a path for no name at all."""


NO_SUCH = re.compile(r"No such (command|option):? ('.*?'|\S+)")
EXTRA_ARGUMENTS = re.compile(r"unexpected extra argument(?:\(s\)|s)? \((.*)\)")
"""Errors of typer: a word that it does not know, and words beyond the arguments of a command."""
FILE_NAME = re.compile(r"-[^=]*\.[A-Za-z]\w*")
"""A word that begins as an option does, and ends as the name of a file."""


def shortened(word: str) -> str:
    """Return a word, without its end where it is longer than an error shows."""
    return word if len(word) <= LONGEST_SHOWN else word[:LONGEST_SHOWN] + "..."


def usage_line(error: Exception) -> str | None:
    """Return the line on an error that typer found; None for any other error."""
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
    extra = EXTRA_ARGUMENTS.search(words)
    if extra is not None:  # as the shell cuts --set machine.height=60 cm
        return f"{path}: too many arguments: {extra[1]}; put quotes around a value that has a space; {help_of}"
    missing = NO_SUCH.match(words)
    if missing is None:
        return f"{path}: {words[:1].lower()}{words[1:]}; {help_of}"
    name = missing[2].strip("'")
    files = [word for word in sys.argv[1:] if word.startswith("-") and _may_be_file(word)]
    if missing[1] == "command":
        return "; ".join([f"no such command: {name}", *_nearest(name, entries()), help_of])
    if files:
        hints = [f"to name the file {shortened(files[0])}, write {shortened(file_word(files[0]))}"]
    else:
        options = [] if context is None else context.command.params
        hints = _nearest(name, [word for option in options for word in option.opts if word.startswith("--")])
    return "; ".join([f"{path} has no option {name}", *hints, help_of])


def _nearest(name: str, choices: Iterable[str]) -> list[str]:
    """Return the choice that a name begins, or that is like it, as a hint; nothing where none is."""
    begun = [choice for choice in choices if choice.startswith(name)]
    near = nearest(name, begun[:1] or choices)
    return [near] if near.startswith("did you mean") else [f'did you mean "{begun[0]}"?'] if begun else []


def _may_be_file(word: str) -> bool:
    return FILE_NAME.fullmatch(word) is not None or os.path.lexists(word)


def _path_of(words: list[str]) -> str:
    """Return the command that was typed, for an error that does not know it."""
    return " ".join(["strikewave", *(word for word in words[:1] if word in entries())])


def _of_option(error: typer.BadParameter, option: TyperArgument | TyperOption | Any, help_of: str) -> InputError | None:
    """Return the error of the value of an option; None where typer does not state the value."""
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
    allowed = "a whole number" if option.type_descriptor.annotation in (int, list[int]) else "a number"
    if option.min is not None:
        allowed += f", at least {option.min}" if option.max is None else f" from {option.min} to {option.max}"
    return InputError(field, _number(got), allowed, help_of)


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
