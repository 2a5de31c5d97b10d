"""Which cases a study runs: grids, designs that fill a range evenly, and draws within the tolerances of a case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.cases.case import Case
from strikewave.studies.axes import Axis, case_at
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.variables import StudyVariable, with_word
from strikewave.uncertainty.bands import latin_hypercube
from strikewave.uncertainty.draws import UncertainInput, drawn, drawn_case, quantiles

Array = NDArray[np.float64]

GRID, HYPERCUBE, SOBOL, TOLERANCES = DESIGNS = {
    "grid": "all values of each setting with all of the others",
    "latin-hypercube": "one in each n-th of the range of every setting (Latin hypercube)",
    "sobol": "Sobol's sequence, scrambled",
    "tolerances": "drawn within the tolerances of the case",
}
"""How rows are chosen, in words. Sources: ``mckay-1979`` for hypercubes, ``joe-kuo-2008`` for Sobol's sequence."""
MOST_RUNS = 1_000_000
"""Most runs of a study: rows and keys of so many take 400 MB."""
MOST_SEED = 2**63 - 1
"""Largest seed: that of a 64-bit integer, which every reader of the JSON document holds."""
MOST_WORDS = 256
"""Most combinations of words: a case of each is held."""


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
        words = tuple(value for variable, value in pairs if variable.words)
        numbers = [(variable.axis, value) for variable, value in pairs if not variable.words]
        axes: list[Axis] = [axis for axis, _ in numbers]
        return case_at(self.cases[words], axes, [value for _, value in numbers], self.note)


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
    return [tuple(one.at(share) for one, share in zip(variables, row, strict=True)) for row in shares.tolist()]


def sobol_sequence(dimensions: int, runs: int, seed: int) -> Array:
    """Return points of Sobol's scrambled sequence, shape (runs, dimensions).

    Source: ``joe-kuo-2008`` for the direction numbers.

    Examples
    --------
    >>> sobol_sequence(1, 4, 1).ravel().argsort().size
    4
    """
    from scipy.stats.qmc import Sobol

    if runs & (runs - 1):
        near = 2 ** round(math.log2(runs))
        raise InputError("--runs", runs, "a power of two: others leave Sobol's sequence uneven", f"such as {near}")
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(seed)))
    return np.asarray(Sobol(dimensions, seed=source).random(runs))


def drawn_rows(inputs: Sequence[UncertainInput], runs: int, seed: int) -> list[Row]:
    """Return rows drawn within the tolerances of a case; more runs change none of them."""
    return [tuple(row) for row in drawn(inputs, quantiles(inputs, runs, seed)).tolist()]
