"""Run a command: check the place of its result, solve, write whole, print."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import sys
import time
import traceback
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextvars import ContextVar
from pathlib import Path
from types import FrameType
from typing import ClassVar, Generic, TypeVar

from strikewave.base.errors import InputError, show
from strikewave.base.output_folder import Claim, atomic_folder, check_place, check_unchanged, claimed, keep_true_files
from strikewave.base.result import Notice, Result
from strikewave.reporting.bands import banded_words
from strikewave.reporting.measured_files import asked
from strikewave.reporting.numbers import showing
from strikewave.reporting.output_options import (
    ORIGIN,
    REPORTS,
    Output,
    check_inputs,
    check_inputs_stay,
    command_inputs,
    is_within,
    origin_text,
)
from strikewave.reporting.terminal import STARTED, case_hash, complain, print_json, say, show_notices, tell

R = TypeVar("R", bound=Result)
NOT_DRAWN = "not-drawn"
"""Code of the notice of a page or picture that could not be drawn."""
_failed: ContextVar[list[str] | None] = ContextVar("failed", default=None)
"""Pictures and pages that could not be drawn while a command writes its result, in words; None where none does."""


class Command(ABC, Generic[R]):
    """A command: it solves, prints and draws its result.

    `run_and_write` enters `under_way`, then calls `solve`, `draw`, `hand_over`, `summary` and `show`; what the result
    keeps of itself (`Result.files`) it writes by itself, between the pictures and what is handed over.
    """

    indent: ClassVar[int | None] = 2
    """Indent of the JSON document; None where it holds long histories."""
    of_test: ClassVar[bool] = True
    """True if the result may belong to a test that was made, which ``--test`` then names."""

    @abstractmethod
    def solve(self) -> R:
        """Return the result."""

    @abstractmethod
    def summary(self, result: R) -> str:
        """Return the key numbers in one or two sentences, which are printed first."""

    @abstractmethod
    def show(self, result: R) -> None:
        """Print the rest of the result below its summary, without its notices."""

    def printed_notices(self, result: R) -> Sequence[Notice]:
        """Return the notices that are printed."""
        return result.notices

    def draw(self, result: R, folder: Path) -> Sequence[str]:
        """Write page and pictures into a folder, and return the names of the files, the first ones first."""
        return ()

    def hand_over(self, result: R, folder: Path) -> Sequence[str]:
        """Move files written under way into a folder, last of all, and return their names."""
        return ()

    def under_way(self, folder: Path) -> contextlib.AbstractContextManager[object]:
        """Return the context in which it solves and writes: it keeps unfinished work, and drops it at the end."""
        return contextlib.nullcontext()


def case_folder(name: str, text: str, changes: Sequence[str]) -> str:
    """Return the usual folder of a case: its name; a changed case gets one of its own beside the unchanged one."""
    return f"{name or 'case'}{case_hash(text, changes)}"


def run_and_write(command: Command[R], output: Output, usual: str | None, identity: str | None) -> int:
    """Solve, write and print, and return the exit code.

    ``usual`` is the name of the folder below ``out`` where none is asked for; None where files are written only on
    request. ``identity`` is the text that will mark the folder, or its first line, so that a place which holds
    something else is refused before the work; None where only the result knows it, and it is refused after it.
    """
    if output.test is not None and not command.of_test:
        raise InputError("--test", str(output.test), "none here: this is not of a test that was made", "leave it out")
    output.check_files(usual)
    with showing(output.show):
        place = output.place(usual)
        if place.folder is None:
            return _print(command, output, command.solve(), timed=usual is not None)
        check_place(place.folder, identity or "", place.replace or identity is None)
        check_inputs_stay(place.folder)
        check_unchanged(place.folder, identity or "")
        if not place.force:
            check_inputs(place.folder, identity)
        with claimed(place.folder) as claim:
            try:
                result, words = _written(command, output, claim, identity, place.replace)
                return _print(command, output, result, timed=True, words=words)
            except KeyboardInterrupt as stop:
                if claim.written:
                    stop.add_note(f"the result is whole: {claim.typed}")
                raise


def _written(
    command: Command[R], output: Output, claim: Claim, identity: str | None, replace: bool
) -> tuple[R, list[str]]:
    """Solve, write the folder whole, and return the result and the lines on its files."""
    late = None
    with command.under_way(claim.typed):
        result = command.solve()
        try:
            with atomic_folder(claim, identity or result.source.text, replace) as folder:
                result, drawn, output = _drawn(command, result, folder, output)
                names = [*drawn, *write_files(result, folder), *output.write_more(result, folder)]
                if output.out is None and result.source.whole and command_inputs() and not is_within(claim.folder):
                    # of which input the case is, for the next command that would choose this place
                    (folder / ORIGIN).write_text(origin_text(asked()), "utf-8", newline="\n")
                    names.append(ORIGIN)
                names += command.hand_over(result, folder)
                kept, removed = keep_true_files(claim.folder, folder, result.source.text)
        except KeyboardInterrupt as stop:
            if not claim.written:
                raise
            late = stop  # nothing is left to go on with: unfinished work goes as after any run
    if late is not None:
        raise late
    lines = [f"written: {str(claim.typed).rstrip('/')}/ ({', '.join(names)})"]
    for verb, files in (("kept", kept), ("removed", removed)):
        if files:
            lines.append(f"{verb}: {', '.join(files)} (of the run before)")
    return result, lines


def _drawn(command: Command[R], result: R, folder: Path, output: Output) -> tuple[R, list[str], Output]:
    """Draw page and pictures, and return the result, the names of the files, and the further output that is wanted.

    A failure costs no result: a notice names it, see `drawing`. A page that is not there makes no PDF.
    """
    failed: list[str] = []
    before = _failed.set(failed)
    try:
        names: list[str] = []
        with drawing(folder / "page and pictures"):
            names += command.draw(result, folder)
        if failed:
            written = sorted(path.name for path in folder.iterdir())
            names = [*(name for name in names if name in written), *(name for name in written if name not in names)]
    finally:
        _failed.reset(before)
    if not failed:
        return result, names, output
    if output.pdf is not None and not any(name in names for name in REPORTS):
        failed.append(f"there is no PDF, for there is no {REPORTS[0]}")
        output = dataclasses.replace(output, pdf=None)
    notices = [Notice(NOT_DRAWN, f"{words}; the numbers are whole, please report it") for words in failed]
    return dataclasses.replace(result, notices=(*result.notices, *notices)), names, output


@contextlib.contextmanager
def drawing(path: Path) -> Iterator[Path]:
    """Give the path of a page or picture that is drawn in the block, and go on behind it where that fails.

    Nothing is left of a file that failed. Where no command runs, the error is raised as it is. So it is for a full
    disk, and where STRIKEWAVE_TRACE asks for the place in the code.

    Examples
    --------
    >>> with drawing(Path("summary.svg")) as path:
    ...     path.name
    'summary.svg'
    """
    failed = _failed.get()
    try:
        yield path
    except OSError:
        raise
    except Exception as error:
        if failed is None or os.environ.get("STRIKEWAVE_TRACE"):
            raise
        path.unlink(missing_ok=True)
        places = [frame for frame, _ in traceback.walk_tb(error.__traceback__) if _is_ours(frame)]
        failed.append(f"{path.name} could not be drawn (in {places[-1].f_code.co_name}: {show(str(error))})")


def _is_ours(frame: FrameType) -> bool:
    return str(frame.f_globals.get("__name__", "")).startswith("strikewave.")


def _print(command: Command[R], output: Output, result: R, timed: bool, words: Sequence[str] = ()) -> int:
    """Print a result and its place, and return the exit code; a question answered at once needs no clock."""
    if output.json:
        print_json(result.document(), indent=command.indent)
    else:
        print_result(command, result)
    for line in words:
        say(line)
    if timed:
        say(f"done in {time.perf_counter() - STARTED:.2f} s{_most_memory()}")
    code = result.exit_code(output.fails_on)
    if code:
        failed = ", ".join(result.own_verdict.codes)
        complain(
            f"exit code {code}: "
            + (f"check failed: {failed}" if failed else "the goal is missed, or something could not be read")
        )
    return code


def _most_memory() -> str:
    """Return in words how much memory one process has held at most; nothing where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return ""
    processes = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    most = max([resource.getrusage(which).ru_maxrss for which in processes])
    size = most * (1 if sys.platform == "darwin" else 1024)  # macOS counts bytes, the others KiB
    return f", {size / 1e9:.2f} GB of memory at most"


def print_result(command: Command[R], result: R) -> None:
    """Print a result: a sentence, tables, notices."""
    tell(" ".join([command.summary(result), *banded_words(result)]))
    command.show(result)
    show_notices(command.printed_notices(result))


def write_files(result: Result, folder: Path) -> list[str]:
    """Write the files of a result into a folder, and return their names."""
    files = result.files()
    for name, content in files.items():
        if isinstance(content, str):
            (folder / name).write_text(content, "utf-8", newline="\n")
        else:
            content.write(folder / name)
    return list(files)
