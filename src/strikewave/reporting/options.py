"""Options of commands: kinds that turn what was typed into a value, and those that several commands take.

Kinds of options that turn what was typed into a value. A kind is used as ``Annotated[float | None, quantity("--
speed", si="m/s", help="Approach speed.")]``. Choices and counts need none: a ``Literal``, or ``typer.Option("--runs",
min=10)``.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from importlib import resources
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, get_args, get_origin, get_type_hints

import typer

from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, ENDLESS, parse_quantity, parse_typed, si_value, typed_number

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.records.budget import Budget
    from strikewave.signal.filters import Filter

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

    option = typer.Option(*names, help=help, parser=_as_typed, callback=callback, show_default=False, **settings)
    option.read = value_of
    return option


def _as_typed(word: Any) -> Any:
    """Keep typer from converting a word before `parsed` does."""
    return word


if TYPE_CHECKING:  # as Python takes them; typer makes a list of an option that may be repeated
    Texts = str | float | Sequence[Any] | Mapping[Any, Any] | None
else:
    Texts = list[str] | None


@dataclass(frozen=True)
class OptionGroup:
    """Options of commands that are arguments of calls in Python too: texts and numbers are read where it is made.

    A field is annotated as a parameter of a command. One of several values takes one alone, a sequence, or a mapping of
    channels to values; a number is in SI.
    """

    def __post_init__(self) -> None:
        """Read what Python gives; values of the command line are read already."""
        group: Any = type(self)
        hints = _hints_of(group)
        for field in fields(self):
            value = getattr(self, field.name)
            is_default = value is None or (isinstance(value, str | Real) and value == field.default)
            if field.name in hints and not is_default:
                object.__setattr__(self, field.name, _value_of(value, field.name, *get_args(hints[field.name])))


@functools.cache
def _hints_of(group: type) -> dict[str, Any]:
    """Return the annotations of the options of a group."""
    hints = get_type_hints(group, include_extras=True)
    return {name: hint for name, hint in hints.items() if get_origin(hint) is Annotated}


def _value_of(value: Any, field: str, kind: Any, option: Any) -> Any:
    """Return the value of an option that Python gives as its command line has it."""
    kinds, read = (kind, *get_args(kind)), getattr(option, "read", None)
    if any(get_origin(each) is list for each in kinds):
        if isinstance(value, Mapping):
            value = [f"{name}={each}" for name, each in value.items()]
        several = [value] if isinstance(value, str | Real | Path) else value
        return [_value_of(each, field, Any if read else str, option) for each in several] or None
    if type(value) in (tuple, list):  # not a NamedTuple, which was read
        value = ",".join(map(str, value))
    if read is not None and isinstance(value, str | Real | Path) and not isinstance(value, Typed):
        return read(str(value), field)
    choices = [choice for each in kinds if get_origin(each) is Literal for choice in get_args(each)]
    if choices and value not in choices:
        raise wrong_choice(str(value), field, choices)
    return str(value) if str in kinds and not isinstance(value, str) else value


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
        True if zero and values below it, or ``inf``, are allowed.
    bare : bool
        True if a number without a unit is taken as SI; refused where another unit is usual, such as g.
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
    """Return a typed quantity as a value of a case."""
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
        typed = math.inf if word.strip().lower() in ENDLESS else typed_number(word)
        value = math.nan if typed is None else typed
        if not (value > above if low is None else value >= low) or not value <= high:
            raise InputError(field, word, words)
        return value

    return parsed(*names, read=read, help=help, metavar="NUMBER")


def share(*names: str, help: str) -> Any:
    """Return an option that takes a share above 0 and below 1, such as 2 % or 0.02."""
    return parsed(*names, read=read_share, help=help, metavar="SHARE")


def read_share(word: str, field: str) -> float:
    """Return a typed share.

    Examples
    --------
    >>> read_share("2 %", "--want-cv")
    0.02
    """
    number, percent = typed_number(word), typed_number(word, "%")
    value = percent / 100.0 if percent is not None else number
    if value is None or not 0.0 < value < 1.0:
        raise InputError(field, word, "a share above 0 and below 1, such as 2 %")
    return value


def grid_size(*names: str, help: str) -> Any:
    """Return an option that takes points along x and y, such as 60x40, or 60 for both."""
    return parsed(*names, read=read_size, help=help, metavar="NXxNY")


def read_size(word: str, field: str) -> Size:
    """Return points along x and y.

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
ElementDevice = Annotated[
    Literal["cuda", "cuda-mixed"] | None,
    typer.Option(
        "--device",
        help=(
            "Take the steps of elements on an NVIDIA GPU, by cuda-mixed in single and double precision; on the "
            "processor by default."
        ),
        show_default=False,
    ),
]


@dataclass(frozen=True)
class FemOptions:
    """Options of a run of elements besides its case and its output."""

    threads: Annotated[
        int,
        typer.Option("--threads", metavar="COUNT", min=1, help="Threads, one a core at most; they change no number."),
    ] = 1
    device: ElementDevice = None
    restart: Annotated[bool, typer.Option("--restart", help="Continue an interrupted run.")] = False
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False


KeptRuns = Annotated[
    Path | None,
    typer.Option(
        "--store",
        metavar="DIR",
        help="Folder that keeps finished runs for later studies; beside the result, till it is written, by default.",
        show_default=False,
    ),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Make all runs anew: none of a stopped or a finished study is read.")
]


@dataclass(frozen=True)
class Running:
    """Options for the runs of a study: workers, and the store of finished runs.

    Attributes
    ----------
    workers : int or None
        Processes; None for threads of this one.
    cluster : str or None
        Address of a scheduler that shares the runs among machines.
    store : Path or None
        Folder that keeps finished runs; None for one beside the result, till that is written.
    fresh : bool
        True if finished runs of a stopped study are made again.
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
    store: KeptRuns = None
    fresh: Fresh = False


@dataclass(frozen=True)
class RunningInProcesses(Running):
    """Options for the runs of a study that shares them among processes; see `Running`."""

    workers: Processes = 2


@dataclass(frozen=True)
class RunningElements(RunningInProcesses):
    """Options for the runs of a study that may use finite elements; see `Running`.

    Attributes
    ----------
    device : str or None
        GPU that takes the steps of elements; None for the processor.
    dry_run : bool
        True if only the number of runs and their time are printed.
    """

    device: ElementDevice = None
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say how many runs there are and how long they take, and make none.")
    ] = False


WithBand = Annotated[
    bool,
    typer.Option(
        "--band/--no-band", help="Find the range of each result when inputs move within what is known of them."
    ),
]


def read_budget(word: str, field: str) -> Budget:
    """Return the budget of a share, or of a file.

    Examples
    --------
    >>> read_budget("5 %", "--uncertainty").share
    0.05
    """
    from strikewave.specifications.budget_file import load_budget

    return load_budget(word, field)


Decision = Annotated[
    Literal["simple", "guarded"],
    typer.Option(
        "--decision",
        help="Decision rule: by the value alone, or with a guard band of its expanded uncertainty (ISO 14253-1).",
    ),
]
Uncertainty = Annotated[
    Any,
    parsed(
        "--uncertainty",
        read=read_budget,
        metavar="SHARE|FILE",
        help="Expanded uncertainty (k = 2) of the acceleration, such as 5 %, or a .toml file with an uncertainty "
        "budget; noise and baseline alone by default.",
    ),
]


ALLOWED_FILTER = 'a cutoff above zero such as "10 kHz", a class such as "CFC 1000", or a filter'


@dataclass(frozen=True)
class LowPassOptions(OptionGroup):
    """A zero-phase low-pass, by its cutoff or by its channel frequency class."""

    panel: ClassVar[str] = "Filters"

    cutoff: Annotated[
        Any, quantity("--filter", si="Hz", help="Zero-phase low-pass, -3 dB for both passes; none by default.")
    ] = None
    cfc: Annotated[
        Any,
        bare_number(
            "--cfc",
            high=1e6,
            allowed="a channel frequency class, such as 60, 180, 600 or 1000",
            help="SAE J211 filter of this channel frequency class, such as 1000; none by default.",
        ),
    ] = None

    def low_pass(self) -> Filter | None:
        """Return the low-pass; None where none is asked for."""
        from strikewave.signal.filters import Filter

        if self.cutoff is not None and self.cfc is not None:
            raise InputError("--cfc", self.cfc.word, "either --filter or --cfc", "leave one out")
        if self.cutoff is not None:
            return self.cutoff if isinstance(self.cutoff, Filter) else Filter(self.cutoff)
        return None if self.cfc is None else Filter.sae_j211(self.cfc)


def low_pass_of(value: str | float | Filter | None) -> Filter | None:
    """Return the low-pass that a call names by its cutoff or its class.

    Examples
    --------
    >>> str(low_pass_of("CFC 1000")), low_pass_of("10 kHz").cutoff, low_pass_of(None)
    ('CFC 1000 (SAE J211)', 10000.0, None)
    """
    from strikewave.signal.filters import Filter

    if value is None or isinstance(value, Filter):
        return value
    if isinstance(value, str) and value.strip()[:3].upper() == "CFC":
        number = typed_number(value.strip()[3:])
        if number is None or not number > 0.0:
            raise InputError("filter", value, ALLOWED_FILTER)
        return Filter.sae_j211(number)
    try:
        cutoff = si_value(value, "Hz", "filter")
    except (InputError, TypeError, ValueError) as error:
        raise InputError("filter", value, ALLOWED_FILTER) from error
    if not 0.0 < cutoff < math.inf:
        raise InputError("filter", value, ALLOWED_FILTER)
    return Filter(cutoff)
