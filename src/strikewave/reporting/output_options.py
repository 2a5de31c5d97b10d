"""Options of what a command writes and shows, and the folder of its result."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import typer

from strikewave.base import texts
from strikewave.base.errors import InputError, show
from strikewave.base.output_folder import MARKS, mark_of, mark_text
from strikewave.base.result import FailOn, Result
from strikewave.reporting.numbers import ShownUnits
from strikewave.reporting.options import parsed
from strikewave.reporting.terminal import Screen, screen

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.cases.performed_test import StatedTest

LONGEST_FOLDER = 150  # file systems take 255, and the name of the hidden folder beside it is longer
"""Bytes of the name of a folder that nobody asked for."""

Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder of the result; out/NAME by default.", show_default=False),
]
Force = Annotated[bool, typer.Option("--force", help="Replace another result in that folder.")]
TestFile = Annotated[
    Path | None,
    typer.Option(
        "--test",
        metavar="FILE",
        help="TOML file that says what was tested, by whom and when, for the head of the report; none by default.",
        show_default=False,
    ),
]
Show = Annotated[
    ShownUnits | None,
    parsed(
        "--show",
        read=ShownUnits.read,
        help="Units to show, at most one for each kind of quantity, such as g,us,kN or m/s2,ms,N; JSON stays in SI.",
        metavar="UNITS",
    ),
]
Histories = Annotated[
    Literal["csv", "parquet"] | None,
    typer.Option(
        "--histories", help="Write the histories as tables too, one file for each time base.", show_default=False
    ),
]
Xlsx = Annotated[
    bool, typer.Option("--xlsx", help="Write one workbook too: tables, comparison, warnings, inputs, histories.")
]
Pdf = Annotated[
    Literal["A4", "letter"] | None,
    typer.Option(
        "--pdf",
        case_sensitive=False,
        help="Write the report as report.pdf too, on paper of this size; needs the extra pdf.",
        show_default=False,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]
Wide = Annotated[
    bool, typer.Option("--wide", help="Show all columns of the tables, not only those that matter and those that fit.")
]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="Show warnings whole, not in one line each.")]
Quiet = Annotated[
    bool, typer.Option("-q", "--quiet", help="Show the result and failed checks only: no progress, no warnings.")
]


FailOnOption = Annotated[
    FailOn,
    typer.Option(
        "--fail-on",
        help=(
            "What makes the exit code 3: a run that could not be made (failed), one that failed a check or a "
            "missed goal too (broken), or nothing (never)."
        ),
    ),
]

REPORTS = ("report.html", "test-report.html")
"""Pages of a result that are written as PDF too."""


@dataclass(frozen=True)
class Place:
    """The folder of a result, None where none is written, and whether it may replace another one there.

    ``force`` is false where nobody said that the result of another input may go.
    """

    folder: Path | None
    replace: bool
    force: bool = True


@dataclass(frozen=True)
class Shown:
    """Options of what is shown of a result: a document alone, all columns, whole warnings, nothing but the result."""

    panel: ClassVar[str] = "Output"

    json: Json = False
    wide: Wide = False
    verbose: Verbose = False
    quiet: Quiet = False

    def in_force(self) -> AbstractContextManager[None]:
        """Return the context in which that much is shown."""
        if self.verbose and self.quiet:
            raise InputError("--quiet", "--verbose beside it", "either --quiet or --verbose", "leave one out")
        return screen(Screen(self.wide, self.verbose, self.quiet))


@dataclass(frozen=True)
class Output(Shown):
    """Options of where a result goes, and what is shown of it; with ``json``, files are written only in ``out``."""

    out: Out = None
    force: Force = False
    test: TestFile = None
    show: Show = None
    pdf: Pdf = None
    xlsx: Xlsx = False

    @property
    def fails_on(self) -> str:
        """Outcome that makes the exit code 3, as `Result.exit_code` takes it."""
        return "broken"

    @functools.cached_property
    def performed(self) -> StatedTest:
        """Statements of the file ``--test``, read once."""
        from strikewave.cases.performed_test import NO_TEST, load_test

        return NO_TEST if self.test is None else load_test(self.test)

    def stated_test(self) -> dict[str, str]:
        """Return what the table [test] of ``--test`` states; nothing without it."""
        return self.performed.test.stated()

    def tested(self, case: Case) -> Case:
        """Return a case with the test that ``--test`` states in the place of its own; the case itself without it."""
        return case if self.test is None else case.model_copy(update={"test": self.performed.test})

    def check_animation(self, animate: bool) -> None:
        """Refuse an animation that has no folder to go to."""
        if animate and self.json and self.out is None:
            raise InputError("--animate", "--json without --out", "a folder for the animation", "add --out DIR")

    def check_files(self, usual: str | None) -> None:
        """Refuse files that cannot be written, before the work; ``usual`` as of `place`."""
        if self.pdf is not None:
            from strikewave.reporting.pdf import check_pdf

            self._check_folder("--pdf", usual)
            check_pdf("--pdf", self.pdf)
        if self.xlsx:
            from strikewave.reporting.table_files import check_workbook

            self._check_folder("--xlsx", usual)
            check_workbook()

    def _check_folder(self, option: str, usual: str | None) -> None:
        """Refuse an option whose files have no folder."""
        if not self.writes(usual):
            got = "--json without --out" if self.json else "no --out"
            raise InputError(option, got, "a folder for the files", "add --out DIR")

    def write_more(self, result: Result, folder: Path) -> list[str]:
        """Write what was asked for beside the usual files of a result, and return the names of the files."""
        names = []
        if self.pdf is not None:
            from strikewave.reporting.pdf import write_pdf

            pages = [page for name in REPORTS if (page := folder / name).is_file()]
            if not pages:
                raise InputError("--pdf", self.pdf, "only where a report is written", "leave it out")
            names += [write_pdf(page, self.pdf) for page in pages]
        if self.xlsx:
            from strikewave.reporting.table_files import write_workbook

            names.append(write_workbook(result, folder))
        return names

    def writes(self, usual: str | None) -> bool:
        """Tell whether files are written at all; ``usual`` as of `place`."""
        return self.place(usual).folder is not None

    def place(self, usual: str | None) -> Place:
        """Return the folder: the one asked for, or ``out/USUAL``, which always holds the last result of that name."""
        if self.out is None and usual is not None and not self.json:
            return Place(Path("out") / folder_name(usual), replace=True, force=self.force)
        return Place(self.out, self.force)


def folder_name(name: str) -> str:
    r"""Return a name that any file system takes, and any terminal shows; a longer one ends with a mark of the whole.

    Examples
    --------
    >>> folder_name("srs-shot 1"), folder_name("srs-a\x1bb"), len(folder_name("a" * 5000))
    ('srs-shot 1', 'srs-a-b', 159)
    """
    plain = texts.shown(name, "-")
    begin = plain.encode()[:LONGEST_FOLDER].decode(errors="ignore")
    return plain if begin == plain else f"{begin}-{hashlib.sha256(plain.encode()).hexdigest()[:8]}"


@dataclass(frozen=True)
class StudyOutput(Output):
    """Options of where the result of several runs goes, and which of them make the exit code 3."""

    fail_on: FailOnOption = "broken"

    @property
    def fails_on(self) -> str:
        """Outcome that makes the exit code 3."""
        return self.fail_on


@dataclass(frozen=True)
class RunOutput(StudyOutput):
    """Options of where the result of a run goes, and which files hold it."""

    histories: Histories = None

    def check_files(self, usual: str | None) -> None:
        """Refuse histories that have no folder."""
        super().check_files(usual)
        if self.histories:
            self._check_folder("--histories", usual)

    def write_more(self, result: Result, folder: Path) -> list[str]:
        """Write the histories too, and return the names of the files."""
        names = super().write_more(result, folder)
        if self.histories is None:
            return names
        from strikewave.reporting.table_files import write_histories

        return [*write_histories(result, folder, self.histories), *names]


ORIGIN = "record.toml"
"""File of a result that states the command line and its inputs."""
CASE = MARKS[0]
"""File of a result that runs again."""
LISTED = 2  # paths are long: a third one would push the way out off the line
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
    """Return the inputs of the command that runs now; nothing in Python."""
    return _inputs.get()


def origin_text(command: str, digests: Mapping[str, str] | None = None, test: Mapping[str, Any] | None = None) -> str:
    """Return command line and inputs as TOML: measured files with their SHA-256, and the statements on the test."""
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
    """Refuse to replace a result that holds an input of the new one, but for its case, which the new one has too."""
    home = _absolute(folder)
    for name in command_inputs():
        path = _absolute(name)  # of "history.csv#2" the file is below that folder too
        if home in path.parents and path != home / CASE:
            hint = "choose another folder by --out DIR, or move the input first"
            raise InputError("--out", folder, f"a folder without an input, and it holds {show(name)}", hint)


def check_inputs(folder: Path, identity: str | None) -> None:
    """Refuse the folder that a command chose by itself where it holds the result of another input.

    The same inputs, more or fewer of them, may have changed, and their result is replaced: who edits a case runs it
    again. Two files of one name in two folders, or two cases of one name, are no such thing. ``identity`` is the text
    that will mark the folder, where it is known: the very same result is replaced from wherever it was asked.
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
    raise InputError("--out", folder, "a folder without the result of another input", hint)


def _places(names: Sequence[str]) -> set[str]:
    """Return the whole paths of inputs, however they were typed; that of a built-in case is as good as its name."""
    return {os.path.abspath(name) for name in names}


def _inputs_of(folder: Path) -> tuple[str, ...]:
    """Return the inputs of the result in a folder; nothing where it does not state them."""
    try:
        inputs = tomllib.loads((folder / ORIGIN).read_text("utf-8")).get("input")
    except (OSError, ValueError):
        return ()
    names = inputs if isinstance(inputs, list) else []
    return tuple([name for name in names if isinstance(name, str) and "\0" not in name])
