"""The command ``strikewave``: runs a command, and turns errors into one line and an exit code.

Exit codes: 0 done, 1 our fault, 2 bad input, 3 done but a check failed, 128 + n stopped by signal n (Ctrl-C is 2).
"""

from __future__ import annotations

import errno
import gc
import io
import os
import sys
import warnings
from pathlib import Path
from typing import Any

import typer

from strikewave._version import __version__
from strikewave.base.errors import InputError, StrikewaveError, StrikewaveWarning
from strikewave.base.folder_claim import FULL, refusal
from strikewave.base.interrupts import Stopped, exit_code, heed
from strikewave.cli.group import SETTINGS, CommandGroup
from strikewave.cli.usage import usage_line
from strikewave.reporting.terminal import complain, say

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


LINEAR_ALGEBRA_THREADS = "1"
"""Threads of linear algebra, where nothing else is asked for: on matrices as small as ours they wait, and by turning,
which takes fifteen times as long where the cores have other work."""
YOUNG_OBJECTS = 50_000
"""Objects after which the garbage collector looks for circles. At Python's own 700 it looks a thousand times while
modules are imported and pictures drawn, which takes 9 % of a run with its files."""


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
    """Let what the caller closed lead nowhere: else the next file that is opened takes its number, and what is printed.

    The system gives the lowest number that is free.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            os.open(os.devnull, os.O_RDWR)
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115 (until the end)


def _show_warning(message: Warning | str, category: type[Warning], *rest: Any, **more: Any) -> None:
    if issubclass(category, StrikewaveWarning):
        say(f"warning: {message}")


COMPILER_SETTINGS = ".numba_config.yaml"
"""File from which numba takes settings, wherever a program is run."""


def _leave_settings_beside() -> None:
    """Take no settings of libraries from the folder that the program is run in, which holds data.

    Raises
    ------
    InputError
        If there are some that cannot be left aside: numba reads its file each time it compiles.
    """
    if Path(COMPILER_SETTINGS).exists():
        asked = "no settings of numba in the folder that strikewave is run in: they would change what is computed"
        raise InputError("folder", COMPILER_SETTINGS, asked)
    if Path("matplotlibrc").exists():
        import matplotlib

        matplotlib.rcdefaults()


def _run() -> int:
    """Run and return the exit code."""
    try:
        _leave_settings_beside()
        code = int(app(prog_name="strikewave", standalone_mode=False) or 0)
        sys.stdout.flush()
    except (Stopped, typer.Abort, KeyboardInterrupt) as stop:
        complain(f"stopped; {_what_stands(stop)}")
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
    """Let what was printed and not taken lead nowhere, so that Python does not try once more at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


LIMITS = {*FULL, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EROFS, errno.EIO}
"""What the system may refuse anywhere, and no input is to blame for: room, numbers of open files, a disk."""


def _limit_line(error: Exception) -> str | None:
    """Return the line for what the system refused; None where it is another error."""
    if not isinstance(error, OSError) or error.errno not in LIMITS:
        return None
    if error.filename is not None:
        return f"{error.filename}: {refusal(error, Path(os.fsdecode(error.filename)))}"
    _drop_output()
    return f"the system refused what was to be printed or written: {error.strerror}"


def _what_stands(stop: BaseException) -> str:
    """Say what a run that was stopped left, as it noted itself."""
    cause = stop.__cause__ or stop  # typer makes one of its own of Ctrl-C
    return next(iter(getattr(cause, "__notes__", ())), "nothing was written")
