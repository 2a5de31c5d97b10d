"""The plan of a study: what it varies, as it is typed, and its rows: grids, even designs, draws within tolerances."""

from __future__ import annotations

import hashlib
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.by_tables import check_case
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range, Value
from strikewave.base.texts import first_few
from strikewave.base.units import DIMENSIONS, range_ends, take_apart, with_last_unit
from strikewave.cases.case import Case, dump_case, parse_case
from strikewave.reporting.columns import Column, Values
from strikewave.reporting.numbers import with_unit
from strikewave.studies.axes import Axis, case_at, range_axis, units_of
from strikewave.studies.engine.evaluation import Evaluation, Job, Row, Variation
from strikewave.studies.engine.store import RunStore
from strikewave.uncertainty.draws import UncertainInput, drawn, drawn_case, latin_hypercube, random_points, range_of

POINTS = 11
"""Values of a range where no number of them stands behind it: eleven show a curve."""
MOST_VALUES = 100_000
"""Most values of one variable."""
MOST_LISTED = 12
"""Values of a list that a table of a page names."""
EXAMPLE = 'such as machine.speed="400..900 rpm:11" or contact.damping=hunt-crossley,exact'
_RANGE = re.compile(
    r"(?P<low>[^:]*?)\s*\.\.\s*(?P<high>[^:]+?)\s*(:\s*(?P<count>\d{1,7})?)?\s*(?P<log>(?<=[\s:\d])log)?\s*"
)


@declare.dataclass
class StudyVariable:
    """A quantity with its values, or a word of the case with its choices.

    Attributes
    ----------
    axis : Axis
        Path, units and values (SI) of a quantity; of words their places, 0 and on.
    words : tuple of str
        Empty for a quantity.
    is_range : bool
        True if all values between its first and last are meant.
    """

    axis: Axis
    words: tuple[str, ...] = ()
    is_range: bool = False

    @declare.computed(declare.word("path of a setting", label="setting", column=KEY, tables="grid range"))
    def path(self) -> str:
        """In the case."""
        return self.axis.path

    @declare.computed(declare.word("what it is varied between, where it is a word", key="words", optional=True))
    def named(self) -> tuple[str, ...] | None:
        """Words of the variable; None of a quantity."""
        return self.words or None

    @declare.computed(declare.word("low end of its range, SI", optional=True))
    def low(self) -> float | None:
        """Low end of the range, SI; None of a list."""
        return self.axis.values[0] if self.is_range else None

    @declare.computed(declare.word("high end of its range, SI", optional=True))
    def high(self) -> float | None:
        """High end of the range, SI; None of a list."""
        return self.axis.values[-1] if self.is_range else None

    @declare.computed(declare.word("whether it is spaced by its logarithm", optional=True))
    def log(self) -> bool | None:
        """True if its range is logarithmic; None of a list."""
        return self.axis.log if self.is_range else None

    @declare.computed(declare.word("its values where they are a list, SI", optional=True))
    def values(self) -> tuple[float, ...] | None:
        """Values of a list, SI; None of words and of a range."""
        return None if self.words or self.is_range else self.axis.values

    @declare.computed(declare.word("how it is spaced", column=MAIN, tables="grid range", in_document=False))
    def spacing(self) -> str:
        """Kind of the variable: words, a list, or a range with its spacing."""
        return "words" if self.words else "logarithmic" if self.log else "linear" if self.is_range else "list"

    @declare.computed(
        declare.word("what it takes", label="values", column=MAIN, tables="grid range", in_document=False)
    )
    def extent(self) -> str:
        """Both ends of a range, else the first values."""
        if self.is_range:
            return f"{self.brief(self.axis.values[0])} to {self.brief(self.axis.values[-1])}"
        return first_few([self.brief(value) for value in self.axis.values], MOST_LISTED)

    @declare.computed(declare.count("how many", label="count", column=MAIN, tables="grid", in_document=False))
    def count(self) -> int:
        """The number of its values."""
        return len(self.axis.values)

    def at(self, share: float) -> float:
        """Return the value at a share of the range from 0 to 1, or that of the list.

        Examples
        --------
        >>> speed = StudyVariable(Axis("machine.speed", "rpm", "rad/s", (50.0, 100.0)), is_range=True)
        >>> speed.at(0.5), StudyVariable(Axis("feed.blows", "", "", (1.0, 5.0))).at(0.5)
        (75.0, 5.0)
        """
        values = self.axis.values
        if not self.is_range:
            return values[min(int(share * len(values)), len(values) - 1)]
        low, high = values[0], values[-1]
        return float(low * (high / low) ** share if self.axis.log else low + share * (high - low))

    def shown(self, value: float) -> str:
        """Return a value as a case file has it."""
        return self.words[int(value)] if self.words else str(self.axis.typed(value))

    def brief(self, value: float) -> str:
        """Return a value as a reader takes it in, to four digits.

        Examples
        --------
        >>> StudyVariable(Axis("machine.speed", "rpm", "rad/s", (50.0,))).brief(76.4454212)
        '730 rpm'
        """
        return (
            self.words[int(value)] if self.words else with_unit(value, self.axis.si_unit or "1", self.axis.unit or "1")
        )

    def column(self, values: Values, is_shown: bool = True) -> Column:
        """Return its values in SI, or its words, as a column of a table."""
        if self.words:
            return Column(self.path, values, shown="" if is_shown else None)
        unit = self.axis.unit
        return Column(self.path, values, self.axis.si_unit or NO_UNIT, unit, (unit or NO_UNIT) if is_shown else None)

    @property
    def label(self) -> str:
        """Name, such as speed of the machine, with the unit in which it is shown; words have none."""
        return self.axis.label.removesuffix(" (1)") if self.words else self.axis.label


def read_variable(case: Case, text: str, points: int = POINTS) -> StudyVariable:
    """Read what is varied.

    Examples
    --------
    >>> from strikewave import load_case
    >>> variable = read_variable(load_case("li-ma-2019"), "machine.speed=400..900rpm:3")
    >>> [variable.axis.typed(value) for value in variable.axis.values]
    ['400 rpm', '650 rpm', '900 rpm']
    """
    path, equals, typed = (part.strip() for part in text.partition("="))
    if not equals or not typed:
        raise InputError("--vary", text, "setting=values", EXAMPLE)
    if path in case.values():
        return _quantity(case, path, typed, points)
    entries = case.entries()
    if path not in entries:
        raise InputError("--vary", path, "a quantity or a word of the case", nearest(path, entries))
    names = tuple(dict.fromkeys(part.strip() for part in typed.split(",") if part.strip()))
    for name in names:
        with_word(case, path, name)
    return StudyVariable(Axis(path, "", "", tuple(float(k) for k in range(len(names)))), names)


def with_word(case: Case, path: str, word: str) -> Case:
    """Return a case with another word, such as another law."""
    changed = parse_case(dump_case(case), case.name, [f"{path}={word}"])
    check_case(changed)
    return changed


def _quantity(case: Case, path: str, typed: str, points: int) -> StudyVariable:
    matched = _RANGE.fullmatch(typed)
    if matched is None and ":" in typed:  # as other tools write ranges; no quantity has a colon
        low, high = with_last_unit([typed.partition(":")[0], typed.rpartition(":")[2]])
        hint = f'such as "{path}={low.partition(" ")[0]}..{high}:{points}"'
        raise InputError("--vary", f"{path}={typed}", "a range written low..high:COUNT, or values and commas", hint)
    if matched is None:
        values = read_list(case, path, typed)
        unit, si_unit = units_of(path, values[-1])
        numbers = sorted({value.si for value in values})
        return StudyVariable(Axis(path, unit, si_unit, tuple(numbers)))
    ends = read_ends(case, path, f"{matched['low']}..{matched['high']}")
    if ends is None:
        raise InputError(
            "--vary", f"{path}={typed}", "a range written low..high:COUNT", "two dots stand between its ends"
        )
    count = int(matched["count"] or points)
    if not 2 <= count <= MOST_VALUES:
        raise InputError("--vary", typed, f"2 to {MOST_VALUES} values of a range")
    axis = range_axis(path, ends, count, bool(matched["log"]))
    if range_of(case, path).unit == "count":
        rounded = sorted({float(round(value)) for value in axis.values})
        return StudyVariable(Axis(path, "", "", tuple(rounded), axis.log))
    # each value is what --set with its text would give
    steps = tuple(typed_value(case, path, str(axis.typed(value))).si for value in axis.values)
    return StudyVariable(replace(axis, values=steps), is_range=True)


def read_ends(case: Case, path: str, typed: str) -> tuple[Value, Value] | None:
    """Return the ends of a range of a quantity, such as ``400..900 rpm``; None where that is none.

    Examples
    --------
    >>> from strikewave import load_case
    >>> [end.typed for end in read_ends(load_case("li-ma-2019"), "machine.speed", "400..900 rpm")]
    ['400 rpm', '900 rpm']
    """
    ends = range_ends(typed)
    return None if ends is None else (typed_value(case, path, ends[0]), typed_value(case, path, ends[1]))


def read_list(case: Case, path: str, typed: str) -> list[Value]:
    """Return the values of a list of a quantity, such as ``10, 20 N s/m``."""
    parts = [part for part in typed.split(",") if part.strip()]
    if len(parts) > MOST_VALUES:
        raise InputError("--vary", f"{len(parts)} values", f"at most {MOST_VALUES}")
    return [typed_value(case, path, part) for part in with_last_unit(parts)] if parts else []


def typed_value(case: Case, path: str, text: str) -> Value:
    """Return a value of a quantity of a case as its file would take it; a bare number is SI."""
    allowed: Range = range_of(case, path)
    typed = take_apart(text)
    bare: str | float = text.strip()
    if typed is not None and not typed.unit:
        bare = f"{bare} {allowed.unit}" if allowed.unit in DIMENSIONS else typed.value
    try:
        return allowed.read(bare)
    except InputError as error:
        raise error.at(path) from None


Array = NDArray[np.float64]

GRID, HYPERCUBE, SOBOL, TOLERANCES = DESIGNS = {
    "grid": "all values of each setting with all of the others",
    "latin-hypercube": "one in each n-th of the range of every setting (Latin hypercube)",
    "sobol": "Sobol's sequence, scrambled",
    "tolerances": "drawn within the tolerances of the case",
}
"""Designs by which rows are chosen, in words. Sources: ``mckay-1979`` (hypercubes), ``joe-kuo-2008`` (Sobol)."""
MOST_RUNS = 1_000_000
"""Most runs of a study: rows and keys of so many take 400 MB."""
MOST_SEED = 2**63 - 1
"""Largest seed: that of a 64-bit integer, which every reader of the JSON document holds."""
MOST_WORDS = 256
"""Most combinations of words: a case of each is held."""


@dataclass(frozen=True, kw_only=True)
class StudyPlan:
    """Runs of a study: what varies a case, what is computed of each run, and the rows of the runs.

    Attributes
    ----------
    case : Case
        Case that is varied.
    variation : Variation
        Variation that makes a case of a row.
    evaluation : Evaluation
        Evaluation that gives what is kept of each run.
    rows : sequence of tuple
        The runs.
    noun : str
        Name of the counted runs.
    """

    case: Case
    variation: Variation
    evaluation: Evaluation
    rows: Sequence[Row] = field(repr=False)
    noun: ClassVar[str] = "runs"

    @property
    def job(self) -> Job:
        """The job that runs the rows."""
        return Job(self.variation, self.evaluation)

    def known(self, store: RunStore) -> int:
        """Return how many runs a store has."""
        known, job = store.known(), self.job
        return sum(job.key(row) in known for row in self.rows) if known else 0

    def marked(self, asked: str, key: object = None) -> str:
        """Return the case as text below what is asked, with a key of what the words do not hold."""
        mark = "" if key is None else f"; plan {hashlib.sha256(repr(key).encode()).hexdigest()[:12]}"
        return f"# strikewave {asked}{mark}\n{dump_case(self.case)}"


@dataclass(frozen=True)
class AxisVariation:
    """A case at values of some of its quantities, and with some of its words.

    Attributes
    ----------
    variables : tuple of StudyVariable
        In the order of the rows.
    note : str
        Note that names the study that chose the values: it stands beside each.
    cases : mapping
        The case for each combination of words that occurs, by their places.
    """

    variables: tuple[StudyVariable, ...]
    note: str
    cases: Mapping[tuple[float, ...], Case] = field(repr=False)

    def case_of(self, row: Row) -> Case:
        """Return the case of a row."""
        pairs = list(zip(self.variables, row, strict=True))
        places = tuple(value for variable, value in pairs if variable.words)
        numbers = [(variable.axis, value) for variable, value in pairs if not variable.words]
        axes: list[Axis] = [axis for axis, _ in numbers]
        return case_at(self.cases[places], axes, [value for _, value in numbers], self.note)


def varied(case: Case, variables: Sequence[StudyVariable], note: str) -> AxisVariation:
    """Return the variation of a case by some variables."""
    paths = [variable.path for variable in variables]
    twice = next((path for k, path in enumerate(paths) if path in paths[:k]), None)
    if twice is not None:
        raise InputError("--vary", twice, "each setting once")
    worded = [variable for variable in variables if variable.words]
    count = math.prod(len(variable.words) for variable in worded)
    if count > MOST_WORDS:
        raise InputError("--vary", f"{count} combinations of words", f"at most {MOST_WORDS}")
    cases = {}
    for places in itertools.product(*(variable.axis.values for variable in worded)):
        changed = case
        for variable, place in zip(worded, places, strict=True):
            changed = with_word(changed, variable.path, variable.words[int(place)])
        cases[places] = changed
    return AxisVariation(tuple(variables), note, cases)


@dataclass(frozen=True)
class DrawVariation:
    """A case with what was drawn of its uncertain inputs."""

    case: Case
    inputs: tuple[UncertainInput, ...]

    def case_of(self, row: Row) -> Case:
        """Return the case of a row of drawn values."""
        return drawn_case(self.case, self.inputs, row)


def grid(variables: Sequence[StudyVariable]) -> list[Row]:
    """Return all values of each variable with all of the others; the first one changes fastest."""
    count = math.prod(len(variable.axis.values) for variable in variables)
    if count > MOST_RUNS:
        raise InputError("--vary", f"{count} runs", f"at most {MOST_RUNS}", "fewer values, or --design sobol --runs N")
    values = [variable.axis.values for variable in reversed(variables)]
    return [row[::-1] for row in itertools.product(*values)]


def filled(variables: Sequence[StudyVariable], design: str, runs: int, seed: int) -> list[Row]:
    """Return rows that fill the ranges of all variables evenly."""
    if design == HYPERCUBE:
        shares = latin_hypercube(len(variables), runs, seed)
    else:
        shares = sobol_sequence(len(variables), runs, seed)
    rows = (zip(variables, row, strict=True) for row in shares.tolist())
    return [tuple(variable.at(share) for variable, share in row) for row in rows]


def sobol_sequence(dimensions: int, runs: int, seed: int) -> Array:
    """Return points of Sobol's scrambled sequence, shape (runs, dimensions).

    Source: ``joe-kuo-2008`` for the direction numbers.

    Examples
    --------
    >>> sobol_sequence(1, 4, 1).ravel().argsort().size
    4
    """
    from scipy.stats.qmc import Sobol

    if runs & (runs - 1):  # no power of two: the balance of the sequence would be lost
        near = 2 ** round(math.log2(runs))
        raise InputError("--runs", runs, "a power of two: others leave Sobol's sequence uneven", f"such as {near}")
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(seed)))
    return np.asarray(Sobol(dimensions, seed=source).random(runs))


def drawn_rows(inputs: Sequence[UncertainInput], runs: int, seed: int) -> list[Row]:
    """Return rows drawn within the tolerances of a case; more runs change none of them."""
    return [tuple(row) for row in drawn(inputs, random_points(inputs, runs, seed)).tolist()]
