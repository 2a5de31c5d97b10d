"""Output shared by the commands: words, tables and numbers on a terminal, in a pipe or a file; JSON.

The result goes to stdout: a sentence, tables, what explains them. All else goes to stderr: progress, warnings, where
files were written. A pipe or a file gets lines of `PIPE_WIDTH`, or of the environment variable COLUMNS, without styles.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO

from strikewave.base.compiling import WORDS, compiling_shown
from strikewave.base.declare import KEY, MAIN, MORE
from strikewave.base.documents import json_text
from strikewave.base.processes import interrupts_as_such
from strikewave.base.result import FAILED, INFO, WARNING, Band, Comparison, Notice, Result
from strikewave.base.texts import percent
from strikewave.reporting import numbers
from strikewave.reporting.bands import BAND_HEADS, band_rows, fixed_within
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import Line, clean, cut, keys, numerals, plain, table_lines, texts, wrapped
from strikewave.reporting.numbers import headed, shown, shown_heads
from strikewave.reporting.parts import written

if TYPE_CHECKING:
    from strikewave.reporting.parts import Table

STARTED = time.perf_counter()
"""Time at which the program started, s, except for imports before this module."""
SELDOM = 10.0  # a log of an hour gets some hundred lines at most, a run of seconds none
"""Seconds between two lines of progress, at least, where stderr is no terminal."""
PIPE_WIDTH = 80  # a file is the same wherever it is made, and any pager shows it
"""Characters of a line where there is no terminal."""
LEAST_WIDTH = 40  # below, hardly a number stands beside its name
"""Characters of a line at least."""


class Screen(NamedTuple):
    """Amount of output: all columns, whole warnings, nothing but the result."""

    wide: bool = False
    verbose: bool = False
    quiet: bool = False


_screen: ContextVar[Screen] = ContextVar("screen", default=Screen())  # noqa: B039 (a named tuple does not change)


@contextlib.contextmanager
def screen(shown: Screen) -> Iterator[None]:
    """Show as much as this as long as the context lasts, in this thread."""
    token = _screen.set(shown)
    try:
        yield
    finally:
        _screen.reset(token)


def is_wide() -> bool:
    """Tell whether all columns are wanted."""
    return _screen.get().wide


def is_dumb() -> bool:
    """Tell whether the terminal says that it shows letters and nothing else."""
    return os.environ.get("TERM", "").lower() in ("dumb", "unknown")


def screen_width(stream: TextIO, piped: float = PIPE_WIDTH) -> float:
    """Return the characters of a line: of COLUMNS, of the terminal, or what a pipe or a file gets.

    Where all columns are wanted and there is no terminal, a line is as long as it takes.
    """
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns) > 0:
        return max(int(columns), LEAST_WIDTH)
    if stream.isatty():
        with contextlib.suppress(OSError, ValueError):
            return max(os.get_terminal_size(stream.fileno()).columns, LEAST_WIDTH)
    return math.inf if is_wide() and not stream.isatty() else piped


def _shows_only_ascii(stream: TextIO) -> bool:
    """Tell whether a stream shows no other letters: a dumb terminal, or an encoding without them."""
    if is_dumb():
        return True
    try:
        "µ–²…─".encode(stream.encoding or "utf-8")
    except (UnicodeEncodeError, LookupError):
        return True
    return False


def _showable(text: str, stream: TextIO) -> str:
    """Return a text as the stream shows it: no command to the terminal, and ASCII where it knows nothing else."""
    text = clean(numbers.in_shown_units(text))
    return plain(text) if _shows_only_ascii(stream) else text


def _write(lines: Iterable[Line], stream: TextIO) -> None:
    """Write lines with their styles where the stream shows them."""
    texts = [Line(_showable(line.text, stream), line.style) for line in lines]
    if not stream.isatty() or is_dumb() or os.environ.get("NO_COLOR"):
        stream.write("".join([f"{line.text}\n" for line in texts]))
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(file=stream, highlight=False)
    for line in texts:
        console.print(Text(line.text, style=line.style), no_wrap=True, overflow="ignore", crop=False)


def print_json(document: dict[str, Any], indent: int | None = 2) -> None:
    """Print one JSON document on stdout; without indentation where it holds long histories."""
    sys.stdout.write(json_text(document, indent, ascii_only=_shows_only_ascii(sys.stdout)))


def tell(text: str, indent: str = "") -> None:
    """Print a sentence of the result on stdout, in lines that end at spaces; all but the first are indented."""
    _write(map(Line, wrapped(_showable(text, sys.stdout), screen_width(sys.stdout), indent)), sys.stdout)


def say(text: str) -> None:
    """Print words on stderr, where they cannot spoil what stdout carries; nothing where only the result is wanted."""
    if not _screen.get().quiet:
        complain(text)


def complain(text: str) -> None:
    """Print words on stderr in any case: an error, or a check that failed. A file gets them in one line."""
    width = screen_width(sys.stderr) if sys.stderr.isatty() else math.inf
    _write_beside(map(Line, wrapped(_showable(text, sys.stderr), width, "  ")))


def _write_beside(lines: Iterable[Line]) -> None:
    """Write lines on stderr; where it takes none, such as a log on a full disk, the result is none the worse for it."""
    try:
        _write(lines, sys.stderr)
        sys.stderr.flush()
    except BrokenPipeError:  # who read it has left, which ends the work
        raise
    except OSError:
        with contextlib.suppress(OSError):  # a stream that is no file has nothing to lead elsewhere
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def show_notices(notices: Sequence[Notice]) -> None:
    """Print what the user should know, what weighs most first: failed checks whole, the rest in a line each.

    A terminal gets the begin of what is longer than its line, a pipe or a file all of it. Where all is wanted, all
    is printed whole; where only the result is, failed checks alone.
    """
    piped = PIPE_WIDTH if sys.stderr.isatty() else math.inf
    shown, width, shortened = _screen.get(), screen_width(sys.stderr, piped), False
    for notice in [notice for weight in (FAILED, WARNING, INFO) for notice in notices if notice.severity == weight]:
        about = f" {notice.case}" if notice.case else ""
        limit = f" (limit {significant(notice.limit, 3)})" if notice.broken and notice.limit == notice.limit else ""
        kind = "check failed" if notice.broken else notice.severity
        text = _showable(f"{kind} [{notice.code}]{about}: {notice.message}{limit}", sys.stderr)
        if notice.broken:
            complain(text)
        elif shown.verbose:
            say(text)
        elif not shown.quiet:
            line = cut(text, width, _showable("…", sys.stderr))
            shortened = shortened or line != text
            _write_beside([Line(line, "dim" if notice.severity == INFO else "")])
    if shortened:
        say("shortened to a line each: -v shows all of it")


def case_hash(text: str, changes: Sequence[str] | None) -> str:
    """Return what tells the default folder of a changed case from that of the case itself; ``text`` is the case.

    Examples
    --------
    >>> case_hash("schema = 1", []), case_hash("schema = 1", ["machine.speed=500 rpm"])
    ('', '-20982c99')
    """
    return "-" + hashlib.sha256(text.encode()).hexdigest()[:8] if changes else ""


def say_compiling(count: int, done: bool) -> None:
    """Say in one plain line, for logs, that kernels are compiled; see `compiling_shown`."""
    if count == 0 and not done:
        say(f"{WORDS}: about 10 s")


@contextlib.contextmanager
def progress_bar(what: str, done: float = 0.0, clocks: Sequence[str] = ("elapsed",)) -> Iterator[Callable[..., None]]:
    """Show a bar on stderr where that is a terminal, else a plain line at each tenth, at most every `SELDOM` seconds.

    A dumb terminal gets the lines; nothing is shown where only the result is wanted. The function that is given takes
    the share done and words beside it. ``clocks`` are "elapsed", and "left" for the time that is left. Ctrl-C leaves
    the block as such.
    """
    if _screen.get().quiet:
        with interrupts_as_such(), compiling_shown(lambda *_: None):
            yield lambda share, words="": None
        return
    if not sys.stderr.isatty() or is_dumb():
        with interrupts_as_such(), compiling_shown(say_compiling):
            yield _plain_progress(what, done)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    times = [TimeElapsedColumn() if clock == "elapsed" else TimeRemainingColumn() for clock in clocks]
    columns = (TextColumn(what), BarColumn(), TextColumn("{task.percentage:>3.0f} %  {task.description}"), *times)
    with interrupts_as_such(), Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=1.0)
        progress.update(task, completed=done)
        with compiling_shown(lambda count, _: progress.update(task, description=f"{WORDS}: {count} compiled")):
            yield lambda share, words="": progress.update(task, completed=share, description=words)


def _plain_progress(what: str, done: float) -> Callable[..., None]:
    """Return what says the share that is done in lines of their own, for logs; a short run says nothing."""
    passed, last = math.floor(10.0 * done + 1e-9), time.monotonic()

    def show(share: float, words: str = "") -> None:
        nonlocal passed, last
        tenth, now = math.floor(10.0 * share + 1e-9), time.monotonic()
        if tenth > passed and now - last >= SELDOM:
            last = now
            say(", ".join(part for part in (f"{what} {100.0 * share:.0f} %".strip(), words) if part))
        passed = max(tenth, passed)

    return show


def number(value: float | None, si: str, usual: str, digits: int = 4, bands: Sequence[Band] = ()) -> str:
    """Write an SI value in the unit in which it is shown, for a table; a dash where there is none.

    Of a value with bands, there are the digits of `strikewave.reporting.bands.table_decimals`.

    Examples
    --------
    >>> number(40709.86, "m/s^2", "g", 5)
    '4151.3'
    """
    if value is None or value != value:
        return "-"
    if bands:
        return fixed_within(value, bands, si, usual)
    return significant(shown(value, si, usual), digits)


def fixed(value: float, si: str, usual: str, decimals: int) -> str:
    """Write an SI value in a unit with so many decimals, so that a column lines up; a dash where there is none.

    Examples
    --------
    >>> fixed(2e-4, "s", "us", 1)
    '200.0'
    """
    return "-" if value != value else numbers.fixed(value, si, usual, decimals)


def significant(value: float, digits: int) -> str:
    """Write a number to so many significant digits, without an exponent where it stays readable.

    Examples
    --------
    >>> significant(19685.34, 3), significant(1.5e-7, 3), significant(float("inf"), 3)
    ('19685', '1.5e-07', 'inf')
    """
    return written(float(value), digits)


def table(title: str, columns: Sequence[Column], rows: Iterable[Sequence[str]], detail: bool = False) -> None:
    """Print a table on stdout, with the columns that fit; see `strikewave.reporting.layout.table_lines`.

    Heads end with their usual units, such as ``peak (kN)``, and are shown with those chosen; cells are written by
    `number` or `fixed`. A detail is only named, unless all is wanted.
    """
    heads = shown_heads(*[column.head for column in columns])
    _table(title, heads, columns, rows, detail)


def print_rows(title: str, columns: Sequence[Column], detail: bool = False) -> None:
    """Print columns of equal length on stdout, as `table` does."""
    rows = zip(*[column.texts() for column in columns], strict=True)
    _table(title, [column.head for column in columns], columns, rows, detail)


def print_face(result: Result, name: str, title: str, table: str = "") -> None:
    """Print rows that a result declares, as `faces.face_table` shows them on a page; nothing where there are none."""
    from strikewave.reporting.faces import face_columns, face_rows

    if face_rows(result, name):
        print_rows(title, face_columns(result, name, table))


def _table(
    title: str, heads: Sequence[str], columns: Sequence[Column], rows: Iterable[Sequence[str]], detail: bool = False
) -> None:
    """Print a table as `table` does, with its heads as they are."""
    width = screen_width(sys.stdout)
    if detail and not is_wide():
        named = _showable(f"not shown: {title} (--wide)", sys.stdout)
        _write([Line(line, "dim") for line in wrapped(named, width)], sys.stdout)
        return
    title = _showable(title, sys.stdout)
    columns = [
        column._replace(name="", label=_showable(head, sys.stdout), si="", shown="")
        for column, head in zip(columns, heads, strict=True)
    ]
    cells = [[_showable(cell, sys.stdout) for cell in row] for row in rows]
    _write([Line(""), *table_lines(title, columns, cells, width, is_wide())], sys.stdout)


def report_table(shown: Table, keys: int = 1, more: Sequence[str] = ()) -> None:
    """Print a table of a report: its first columns name the rows, and those in ``more`` are left out first."""
    rows = [[cell if isinstance(cell, str) else cell.text for cell in row] for row in shown.cells()]
    columns = [
        Column("", (), label=head, priority=KEY if place < keys else MORE if head in more else MAIN, words=not numeric)
        for place, (head, numeric) in enumerate(zip(shown.columns, shown.numeric(), strict=True))
    ]
    _table(shown.caption, shown.columns, columns, rows)


def print_bands(result: Result, values: Mapping[str, float]) -> None:
    """Print the range of each result with the inputs that matter most, and how they were found; nothing without any.

    ``values`` are the results themselves, SI, by the names of the bands.
    """
    if result.band and result.band_method is not None:
        named, value, inputs, rest = BAND_HEADS
        columns = [*keys(named), *texts(value, inputs), *numerals(rest, priority=MORE)]
        table("What the results depend on", columns, band_rows(result, values, whole=is_wide()))
        tell(result.band_method.words())


def print_published(published: Sequence[Comparison]) -> None:
    """Print the comparison with published values; nothing where there are none."""
    if not published:
        return
    rows = []
    for entry in published:
        units = entry.measured.units
        quantity = headed(entry.quantity + (f" of {entry.sensor}" if entry.sensor else ""), *units)
        pair = [number(value, *units, 6) for value in (entry.published, entry.computed)]
        difference = "-" if entry.difference is None else percent(entry.difference, 1, "+")
        rows.append([quantity, entry.measured_or_simulated, entry.role, *pair, difference])
    columns = [*keys("quantity"), *texts("origin", priority=MORE), *texts("role")]
    columns += numerals("published", "computed", "difference")
    table("Comparison with published values", columns, rows)
    for note in dict.fromkeys([entry.note for entry in published if entry.role == "shown" and entry.note]):
        tell(f"shown, not comparable: {note}", "  ")
