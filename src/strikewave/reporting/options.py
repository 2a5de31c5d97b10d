"""The options of commands: those that commands share, and kinds of options that turn what was typed into a value.

A kind is used as ``Annotated[float | None, quantity("--speed", si="m/s", help="Approach speed.")]``. Choices and counts
need none: a ``Literal``, or ``typer.Option("--runs", min=10)``.
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

import typer

from strikewave.base import control_characters
from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, parse_quantity, parse_typed
from strikewave.reporting.numbers import ShownUnits
from strikewave.reporting.terminal import Screen, screen

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.base.result import Result
    from strikewave.cases.case import Case
    from strikewave.cases.stated_test import StatedTest

LONGEST_FOLDER = 150
"""Bytes of the name of a folder that nobody asked for: file systems take 255, and a hidden one beside it has more."""
Read = Callable[[str, str], Any]
"""Takes a typed word and the name of its option; returns the value or raises `InputError`."""


class Typed(float):
    """A number in SI that knows how it was typed, for an error that is only found later.

    Examples
    --------
    >>> Typed(1000.0, "1 kHz").word, 2.0 * Typed(1000.0, "1 kHz")
    ('1 kHz', 2000.0)
    """

    word: str

    def __new__(cls, value: float, word: str) -> Typed:
        """Keep the word beside the number."""
        typed = super().__new__(cls, value)
        typed.word = word
        return typed

    def __reduce__(self) -> tuple[type[float], tuple[float]]:
        """Go to another process as a plain float."""
        return float, (float(self),)


class Size(NamedTuple):
    """Points along x and y."""

    x: int
    y: int


def parsed(*names: str, read: Read, help: str, **settings: Any) -> Any:
    """Return an option whose words ``read`` turns into values; each word of an option that may be repeated.

    A number is `Typed`. A default that is no text is taken as it is.
    """

    def value_of(word: str, field: str) -> Any:
        value = read(word, field)
        return Typed(value, word) if isinstance(value, float) else value

    def callback(param: typer.CallbackParam, value: Any) -> Any:
        field = param.opts[-1]
        if isinstance(value, str):
            return value_of(value, field)
        return [value_of(word, field) for word in value] if isinstance(value, list) else value

    return typer.Option(*names, help=help, parser=_as_typed, callback=callback, show_default=False, **settings)


def _as_typed(word: Any) -> Any:
    """Keep typer from converting a word before `parsed` does."""
    return word


def quantity(
    *names: str,
    si: str,
    help: str,
    signed: bool = False,
    infinite: bool = False,
    bare: bool = True,
    panel: str | None = None,
) -> Any:
    """Return an option that takes a quantity: with a unit, or a bare number in SI.

    Parameters
    ----------
    *names : str
        Of the option, the long one last.
    si : str
        SI unit, one of `strikewave.base.units.DIMENSIONS`.
    help : str
        Help text, which names the default.
    signed, infinite : bool
        Whether zero and values below it, or ``inf``, are allowed.
    bare : bool
        Whether a number without a unit is taken as SI; refused where another unit is usual, such as g.
    panel : str or None
        Section of the help; the usual one where None.
    """
    allowed = DIMENSIONS[si][0] + ("" if signed else " above zero") + (", or inf" if infinite else "")

    def read(word: str, field: str) -> float:
        value = parse_typed(word, si, field) if bare else parse_quantity(word, si, field)
        if value == -math.inf or not (signed or value > 0.0) or (value == math.inf and not infinite):
            raise InputError(field, word, allowed)
        return value

    return parsed(*names, read=read, help=help, metavar=_metavar(si), rich_help_panel=panel)


def _metavar(si: str) -> str:
    """Return what stands for a quantity in the help.

    Examples
    --------
    >>> _metavar("m/s^2")
    'ACCELERATION'
    """
    return DIMENSIONS[si][0].split()[1].upper()


def typed_value(*names: str, si: str, highest: float, help: str) -> Any:
    """Return an option that takes a quantity above zero as a case file has it: its text is kept for the case."""

    def read(word: str, field: str) -> Value:
        return read_value(word, field, si, highest)

    return parsed(*names, read=read, help=help, metavar=_metavar(si))


def read_value(word: str, field: str, si: str, highest: float) -> Value:
    """Return a typed quantity as a value of a case.

    Raises
    ------
    InputError
        If it is none, of another dimension, or not above zero and at most ``highest``.
    """
    from strikewave.base.quantities import Range

    try:
        return Range(si, 0.0, highest, open_low=True).read(word)
    except InputError as error:
        raise error.at(field) from None


def bare_number(
    *names: str, help: str, above: float = 0.0, low: float | None = None, high: float = math.inf, allowed: str = ""
) -> Any:
    """Return an option that takes a number without a unit.

    Parameters
    ----------
    *names : str
        Of the option, the long one last.
    help : str
        Help text, which names the default.
    above, low, high : float
        The number is above ``above``, or at least ``low`` where that is given, and at most ``high``, which may be inf.
    allowed : str, optional
        Words of an error, instead of the range.
    """
    most = "" if math.isinf(high) else f" and at most {high:g}" if low is None else f" to {high:g}"
    words = allowed or (f"a number above {above:g}" if low is None else f"a number from {low:g}") + most

    def read(word: str, field: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not (value > above if low is None else value >= low) or not value <= high:
            raise InputError(field, word, words)
        return value

    return parsed(*names, read=read, help=help, metavar="NUMBER")


def share(*names: str, help: str) -> Any:
    """Return an option that takes a share above 0 and below 1, such as 2 % or 0.02."""
    return parsed(*names, read=read_share, help=help, metavar="SHARE")


def read_share(word: str, field: str) -> float:
    """Return a typed share.

    Raises
    ------
    InputError
        If it is no number, or not between 0 and 1.

    Examples
    --------
    >>> read_share("2 %", "--want-cv")
    0.02
    """
    bare = word.strip()
    try:
        value = float(bare.removesuffix("%")) / (100.0 if bare.endswith("%") else 1.0)
    except ValueError:
        value = math.nan
    if not 0.0 < value < 1.0:
        raise InputError(field, word, "a share above 0 and below 1, such as 2 %")
    return value


def grid_size(*names: str, help: str) -> Any:
    """Return an option that takes points along x and y, such as 60x40, or 60 for both."""
    return parsed(*names, read=read_size, help=help, metavar="NXxNY")


def read_size(word: str, field: str) -> Size:
    """Return points along x and y.

    Raises
    ------
    InputError
        If they are no whole numbers.

    Examples
    --------
    >>> read_size("60x40", "--points"), read_size("60", "--points")
    (Size(x=60, y=40), Size(x=60, y=60))
    """
    parts = [part.strip() for part in word.lower().replace("×", "x").split("x")]
    if len(parts) > 2 or not all(part.isdecimal() and len(part) < 8 for part in parts):
        raise InputError(field, word, "two whole numbers", "such as 200x200")
    return Size(int(parts[0]), int(parts[-1]))


def one_of(*names: str, choices: Sequence[str], help: str) -> Any:
    """Return an option that takes a choice and may be repeated, which a ``Literal`` may not."""

    def read(word: str, field: str) -> str:
        if word not in choices:
            raise wrong_choice(word, field, choices)
        return word

    def complete(incomplete: str) -> list[str]:
        return [choice for choice in choices if choice.startswith(incomplete)]

    return parsed(*names, read=read, help=help, metavar="|".join(choices), autocompletion=complete)


def wrong_choice(word: str, field: str, choices: Sequence[str]) -> InputError:
    """Return the error of a word that is none of some choices.

    Examples
    --------
    >>> str(wrong_choice("strss", "--field", ["stress", "force", "velocity"]))
    '--field: got "strss"; allowed: one of stress, force, velocity; did you mean "stress"?'
    """
    near = nearest(word, choices)
    return InputError(field, word, one_of_words(choices), near if near.startswith("did you mean") else "")


def one_of_words(choices: Sequence[str]) -> str:
    """Return choices as an error lists them.

    Examples
    --------
    >>> one_of_words(["x", "y"]), one_of_words(["a", "b", "c"])
    ('x or y', 'one of a, b, c')
    """
    return " or ".join(choices) if len(choices) < 3 else "one of " + ", ".join(choices)


def complete_case(incomplete: str) -> list[str]:
    """Return the built-in cases and the case files of this folder that begin so."""
    published = resources.files("strikewave.cases") / "published"
    names = [entry.name.removesuffix(".toml") for entry in published.iterdir() if entry.name.endswith(".toml")]
    files = [path.name for path in Path().glob("*.toml")]
    return [name for name in (*sorted(names), *sorted(files)) if name.startswith(incomplete)]


def case_name(metavar: str, help: str) -> Any:
    """Return an argument that takes a case."""
    return typer.Argument(metavar=metavar, help=help, show_default=False, autocompletion=complete_case)


CaseName = Annotated[str, case_name("CASE", "A case file, or the name of a built-in case.")]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help='Change a field, such as machine.speed="700 rpm"; may be repeated.',
        show_default=False,
    ),
]
Processes = Annotated[
    int, typer.Option("--workers", metavar="COUNT", min=1, max=256, help="Processes, one a core at most.")
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="tcp://HOST:PORT",
        help="Dask scheduler that shares the runs among machines; processes of this one (--workers) by default.",
        show_default=False,
    ),
]
KeptRuns = Annotated[
    Path | None,
    typer.Option(
        "--store",
        metavar="DIR",
        help="Folder that keeps finished runs for later studies; beside the result, till it is written, by default.",
        show_default=False,
    ),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Run the finished runs of a stopped study again.")]


@dataclass(frozen=True)
class Shared:
    """Who makes the runs of a study.

    Attributes
    ----------
    workers : int or None
        Processes; None for threads of this one.
    cluster : str or None
        Address of a scheduler that shares the runs among machines.
    """

    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            metavar="COUNT",
            min=1,
            max=256,
            help="Processes, one a core at most; threads of one process by default.",
            show_default=False,
        ),
    ] = None
    cluster: Cluster = None


@dataclass(frozen=True)
class Running(Shared):
    """Who makes the runs of a study, and where finished ones are kept.

    Attributes
    ----------
    store : Path or None
        Folder that keeps finished runs; None for one beside the result, till that is written.
    fresh : bool
        Whether finished runs of a stopped study are made again.
    """

    store: KeptRuns = None
    fresh: Fresh = False


WithBand = Annotated[
    bool,
    typer.Option(
        "--band/--no-band", help="Find the range of each result when inputs move within what is known of them."
    ),
]
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


REPORTS = ("report.html", "test-report.html")
"""Pages of a result that are written as PDF too."""


@dataclass(frozen=True)
class Place:
    """The folder of a result, None where none is written, and whether it may replace another one there.

    ``force`` is false where nobody said that what was changed by hand there may go.
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
            raise InputError("--quiet", "--verbose too", "one of them")
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
class RunOutput(Output):
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
