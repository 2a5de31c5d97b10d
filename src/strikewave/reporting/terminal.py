"""What the commands share: printing JSON, tables and numbers."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from strikewave.base.compile_progress import WORDS, compiling_shown
from strikewave.reporting import numbers
from strikewave.reporting.bands import BAND_HEADS, band_rows
from strikewave.reporting.numbers import headed, shown

if TYPE_CHECKING:
    from strikewave.base.result import Comparison, Notice, Result
    from strikewave.cases.losses_of_case import FittedLoss
    from strikewave.sensors.channel import SensorChannel

STARTED = time.perf_counter()
"""When the program started, but for what is imported before this module."""
INTERRUPTED = 130
"""Exit code after Ctrl-C: 128 and the number of the signal, as shells have it."""
SELDOM = 10.0
"""Seconds between two lines of progress, at least, where stderr is no terminal."""


def print_json(document: dict[str, Any], indent: int | None = 2) -> None:
    """Print one JSON document on stdout; without indentation where it holds long histories."""
    sys.stdout.write(json.dumps(document, indent=indent, allow_nan=False, ensure_ascii=False) + "\n")


def say(text: str) -> None:
    """Print words on stderr, where they cannot spoil what stdout carries."""
    sys.stderr.write(text + "\n")


def show_notices(notices: Sequence[Notice]) -> None:
    """Print what the user should know."""
    for notice in notices:
        about = f" {notice.case}" if notice.case else ""
        limit = f" (limit {significant(notice.limit, 3)})" if notice.broken and notice.limit == notice.limit else ""
        kind = "check failed" if notice.broken else notice.severity
        say(f"{kind} [{notice.code}]{about}: {notice.message}{limit}")


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
        say(f"{WORDS}: about 20 s")


def most_memory() -> str:
    """Return in words how much memory one process has held at most; nothing where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return ""
    processes = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    most = max(resource.getrusage(which).ru_maxrss for which in processes) * (1 if sys.platform == "darwin" else 1024)
    return f", {most / 1e9:.2f} GB of memory at most"


@contextlib.contextmanager
def progress_bar(what: str, done: float = 0.0, clocks: Sequence[str] = ("elapsed",)) -> Iterator[Callable[..., None]]:
    """Show a bar on stderr where that is a terminal, else a plain line at each tenth, at most every `SELDOM` seconds.

    Gives a function that takes the share done, and words beside it. It begins with ``done``; ``clocks`` are "elapsed",
    and "left" for the time that is left.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        with compiling_shown(say_compiling):
            yield _plain_progress(what, done)
        return
    times = [TimeElapsedColumn() if clock == "elapsed" else TimeRemainingColumn() for clock in clocks]
    columns = (TextColumn(what), BarColumn(), TextColumn("{task.percentage:>3.0f} %  {task.description}"), *times)
    with Progress(*columns, console=console, transient=True) as progress:
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


def number(value: float | None, si: str, usual: str, digits: int = 4) -> str:
    """Write an SI value in the unit in which it is shown, for a table; a dash where there is none.

    Examples
    --------
    >>> number(40709.86, "m/s^2", "g", 5)
    '4151.3'
    """
    if value is None or value != value:
        return "-"
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
    if value == 0.0 or not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{digits}g}"
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e" in text else text


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> None:
    """Print a table on stdout: the first ``left`` columns to the left, the rest to the right."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    grid = Table(title=escape(title), title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    for place, column in enumerate(columns):
        grid.add_column(escape(column), justify="left" if place < left else "right", overflow="fold")
    for row in rows:
        grid.add_row(*(escape(cell) for cell in row))
    console = Console(soft_wrap=False)
    if not console.is_terminal:
        console.width = int(os.environ.get("COLUMNS", "160")) if os.environ.get("COLUMNS", "160").isdigit() else 160
    console.print(grid)


def print_bands(result: Result, values: Mapping[str, float]) -> None:
    """Print the range of each result with the inputs that matter most, and how they were found; nothing without any.

    Parameters
    ----------
    result : Result
        With bands.
    values : mapping of str to float
        The results themselves, SI, by the names of the bands.
    """
    if result.band and result.band_method is not None:
        table("What the results depend on", list(BAND_HEADS), band_rows(result, values), left=3)
        say(result.band_method.words())


def print_fits(losses: Sequence[FittedLoss]) -> None:
    """Print how well loss factors are held over their bands."""
    from strikewave.reporting.stack_chapters import fit_table

    if losses:
        fits = fit_table(losses)
        table(fits.caption, fits.columns, [[str(cell) for cell in row] for row in fits.rows])


def print_losses(channels: Sequence[SensorChannel]) -> None:
    """Print the insertion loss of the buffered sensors."""
    from strikewave.reporting.stack_chapters import loss_table

    losses = loss_table(channels)
    if losses.rows:
        table(losses.caption, losses.columns, [[str(cell) for cell in row] for row in losses.rows])


def print_published(published: Sequence[Comparison]) -> None:
    """Print the comparison with published values; nothing where there are none."""
    from strikewave.cases.case import PUBLISHED_QUANTITIES

    if not published:
        return
    rows = []
    for entry in published:
        unit = PUBLISHED_QUANTITIES[entry.quantity]
        usual = numbers.SHOWN_UNITS[unit]
        pair = [
            number(v, unit, usual, 6) if unit else ("-" if v is None else f"{v:g}")
            for v in (entry.published, entry.computed)
        ]
        difference = "-" if entry.difference is None else f"{entry.difference:+.1%}"
        rows.append(
            [
                headed(entry.quantity + (f" of {entry.sensor}" if entry.sensor else ""), unit, usual),
                entry.measured_or_simulated,
                entry.role,
                *pair,
                difference,
            ]
        )
    table(
        "Comparison with published values",
        ["quantity", "origin", "role", "published", "computed", "difference"],
        rows,
        left=3,
    )
