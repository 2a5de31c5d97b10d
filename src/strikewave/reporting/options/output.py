"""Options of what a command writes and shows, and the folder that its result goes to."""

from __future__ import annotations

import functools
import hashlib
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from strikewave.base import control_characters
from strikewave.base.errors import InputError
from strikewave.base.result import FailOn
from strikewave.reporting.options.kinds import parsed
from strikewave.reporting.shown_units import ShownUnits
from strikewave.reporting.terminal import Screen, screen

if TYPE_CHECKING:
    from strikewave.base.result import Result
    from strikewave.cases.case import Case
    from strikewave.cases.stated_test import StatedTest

LONGEST_FOLDER = 150
"""Bytes of the name of a folder that nobody asked for: file systems take 255, and a hidden one beside it has more."""

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
    """What is shown of a result.

    Attributes
    ----------
    json : bool
        Whether one JSON document goes to stdout, and nothing else.
    wide : bool
        Whether tables have all their columns.
    verbose : bool
        Whether warnings are shown whole.
    quiet : bool
        Whether nothing but the result is shown.
    """

    panel: ClassVar[str] = "Output"

    json: Json = False
    wide: Wide = False
    verbose: Verbose = False
    quiet: Quiet = False

    def in_force(self) -> AbstractContextManager[None]:
        """Return the context in which that much is shown.

        Raises
        ------
        InputError
            If all and nothing is wanted.
        """
        if self.verbose and self.quiet:
            raise InputError("--quiet", "--verbose beside it", "either --quiet or --verbose", "leave one out")
        return screen(Screen(self.wide, self.verbose, self.quiet))


@dataclass(frozen=True)
class Output(Shown):
    """Where a result goes, and what is shown of it.

    Attributes
    ----------
    out : Path or None
        The folder asked for; with ``json``, files are written only there.
    force : bool
        Whether it may replace the result of something else.
    test : Path or None
        The file that says what was tested.
    show : ShownUnits or None
        Units of numbers on screen, in the report and in CSV; None for the usual ones.
    pdf : str or None
        Paper of the report as PDF, A4 or letter; None for no PDF.
    xlsx : bool
        Whether tables and histories are written as one workbook too.
    """

    out: Out = None
    force: Force = False
    test: TestFile = None
    show: Show = None
    pdf: Pdf = None
    xlsx: Xlsx = False

    @property
    def fails_on(self) -> str:
        """What makes the exit code 3, as `Result.exit_code` takes it."""
        return "broken"

    @functools.cached_property
    def performed(self) -> StatedTest:
        """What ``--test`` states, read once.

        Raises
        ------
        InputError
            If its file cannot be used.
        """
        from strikewave.cases.stated_test import NO_TEST, load_test

        return NO_TEST if self.test is None else load_test(self.test)

    def stated_test(self) -> dict[str, str]:
        """Return what the table [test] of ``--test`` states; nothing without it.

        Raises
        ------
        InputError
            If its file cannot be used.
        """
        return self.performed.test.stated()

    def tested(self, case: Case) -> Case:
        """Return a case with the test that ``--test`` states in the place of its own; the case itself without it.

        Raises
        ------
        InputError
            If its file cannot be used.
        """
        return case if self.test is None else case.model_copy(update={"test": self.performed.test})

    def check_animation(self, animate: bool) -> None:
        """Refuse an animation that has no folder to go to.

        Raises
        ------
        InputError
            If there is none.
        """
        if animate and self.json and self.out is None:
            raise InputError("--animate", "--json without --out", "a folder for the animation", "add --out DIR")

    def check_files(self, usual: str | None) -> None:
        """Refuse files that cannot be written, before the work; ``usual`` as of `place`.

        Raises
        ------
        InputError
            If there is no folder for them, or what writes them is not installed.
        """
        if self.pdf is not None:
            from strikewave.reporting.pdf import check_pdf

            self._check_folder("--pdf", usual)
            check_pdf("--pdf", self.pdf)
        if self.xlsx:
            from strikewave.reporting.workbook import check_workbook

            self._check_folder("--xlsx", usual)
            check_workbook()

    def _check_folder(self, option: str, usual: str | None) -> None:
        """Refuse an option whose files have no folder."""
        if not self.writes(usual):
            got = "--json without --out" if self.json else "no --out"
            raise InputError(option, got, "a folder for the files", "add --out DIR")

    def write_more(self, result: Result, folder: Path) -> list[str]:
        """Write what was asked for beside the usual files of a result, and return the names of the files.

        Raises
        ------
        InputError
            If a PDF is wanted of a report that is not written.
        """
        names = []
        if self.pdf is not None:
            from strikewave.reporting.pdf import write_pdf

            pages = [page for name in REPORTS if (page := folder / name).is_file()]
            if not pages:
                raise InputError("--pdf", self.pdf, "only where a report is written", "leave it out")
            names += [write_pdf(page, self.pdf) for page in pages]
        if self.xlsx:
            from strikewave.reporting.workbook import write_workbook

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
    plain = control_characters.shown(name, "-")
    begin = plain.encode()[:LONGEST_FOLDER].decode(errors="ignore")
    return plain if begin == plain else f"{begin}-{hashlib.sha256(plain.encode()).hexdigest()[:8]}"


@dataclass(frozen=True)
class StudyOutput(Output):
    """Where the result of several runs goes, and which of them make the exit code 3.

    Attributes
    ----------
    fail_on : str
        "failed", "broken" or "never"; see `strikewave.base.result.Result.exit_code`.
    """

    fail_on: FailOnOption = "broken"

    @property
    def fails_on(self) -> str:
        """What makes the exit code 3."""
        return self.fail_on


@dataclass(frozen=True)
class RunOutput(StudyOutput):
    """Where the result of a run goes, and which files hold it.

    Attributes
    ----------
    histories : str or None
        Format of the tables of histories, csv or parquet; None for none.
    """

    histories: Histories = None

    def check_files(self, usual: str | None) -> None:
        """Refuse histories that have no folder.

        Raises
        ------
        InputError
            If there is none, or what `Output.check_files` raises.
        """
        super().check_files(usual)
        if self.histories:
            self._check_folder("--histories", usual)

    def write_more(self, result: Result, folder: Path) -> list[str]:
        """Write the histories too, and return the names of the files."""
        names = super().write_more(result, folder)
        if self.histories is None:
            return names
        from strikewave.reporting.histories import write_histories

        return [*write_histories(result, folder, self.histories), *names]
