"""Several laws or structures fitted to the same measurements, and which predicts best what it was not fitted to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, GivenUnits, Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.cases.case import Case
from strikewave.studies.fit.batches import result_of
from strikewave.studies.fit.estimation import Search
from strikewave.studies.fit.measured import Measured, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.problem import NO_MORE_UNIT, OVER_NOISE, Problem
from strikewave.studies.fit.solving import Solved

MOST_TRIED = 20
"""Most choices of one field."""
FEWEST, FOLDS = 3, 10
"""Records, or settings of numbers, from which on choices are compared by cross-validation, and parts into which more of
them are divided."""


@declare.dataclass
class TriedChoice:
    """A choice of a field, and how well it fits."""

    given_units: ClassVar[GivenUnits] = NO_MORE_UNIT

    choice: str = declare.word("as typed, path=value", column=KEY)
    misfit: float = declare.number(
        Quantity("", "", "residual over noise", digits=3),
        "root mean square of all residuals over their noise or uncertainty; null where it could not be fitted",
        default=math.nan,
        column=MAIN,
    )
    kept_out: float = declare.number(
        OVER_NOISE,
        "the same of records that each fit was without, or of the numbers of a setting; null where they are too few",
        label="of records kept out",
        default=math.nan,
        column=MAIN,
    )
    more_than_noise: int = declare.count("records of which the residual is more than noise", default=0)
    failure: str = declare.word(
        "why it could not be fitted; empty where it was",
        label="could not be fitted",
        default="",
        column=MORE,
        order=1,
    )
    beyond_noise = declare.phrase("more than noise", column=MORE)(
        lambda one: None if one.failure else str(one.more_than_noise)
    )

    @property
    def rank(self) -> tuple[bool, float]:
        """What it is ranked by: cross-validation where there is one, else the misfit; failures last."""
        return bool(self.failure), self.kept_out if math.isfinite(self.kept_out) else self.misfit


def read_tries(case: Case, word: str) -> list[str]:
    """Return the changes that are tried, ``path=choice`` each; ``law`` is short for ``contact.law``.

    Raises
    ------
    InputError
        If the case has no such field, or fewer than two choices are named.

    Examples
    --------
    >>> from strikewave import load_case
    >>> read_tries(load_case("li-ma-2019"), "law=palmgren,johnson")
    ['contact.law=palmgren', 'contact.law=johnson']
    """
    path, _, rest = (part.strip() for part in word.partition("="))
    known = {**case.entries(), **case.values()}
    if "." not in path:
        path = f"contact.{path}"
    if path not in known:
        raise InputError("--try", path, "a field of the case", nearest(path, known))
    choices = [part.strip() for part in rest.split(",") if part.strip()]
    if not 2 <= len(dict.fromkeys(choices)) <= MOST_TRIED:
        allowed = f"PATH=CHOICE,CHOICE with 2 to {MOST_TRIED} choices"
        raise InputError("--try", word, allowed, "such as law=palmgren,johnson")
    return [f"{path}={choice}" for choice in dict.fromkeys(choices)]


def tried(choice: str, solved: Solved) -> TriedChoice:
    """Return how well a fitted choice does."""
    sizes = [one.size for one in solved.misfits]
    broken = sum(one.more_than_noise for one in solved.misfits)
    return TriedChoice(choice, _mean(sizes), _kept_out(solved), broken)


def _mean(sizes: Sequence[float]) -> float:
    return math.sqrt(float(np.mean(np.square(sizes))))


def _kept_out(solved: Solved) -> float:
    """Return the root mean square residual of records, or of numbers of a setting, that each fit was without."""
    problem = solved.problem
    parts: list[list[Measured]] = [[one] for one in problem.measured if isinstance(one, MeasuredPulse)]
    if not parts:
        settings = [[one for one in test.measured if not _is_known(one)] for test in problem.experiments]
        parts = [setting for setting in settings if setting]
    if len(parts) < FEWEST or solved.stopped:
        return math.nan
    sizes, folds = list[float](), min(FOLDS, len(parts))
    for fold in range(folds):
        out = [one for part in parts[fold::folds] for one in part]
        search = Search(_without(problem, out, keep=False).residuals, len(problem.fields), stairs=problem.stairs)
        search.begin(solved.estimate.place)
        place, _ = search.descend(solved.estimate.place)
        left = _without(problem, out, keep=True)
        sizes += [one.size for one in left.misfits(result_of(left.residuals, place))]
    return _mean(sizes)


def _is_known(one: Measured) -> bool:
    """Tell whether it is known of a field from elsewhere: of the fit alone, with any measurements."""
    return isinstance(one, MeasuredNumber) and one.of_field


def _without(problem: Problem, measured: Sequence[Measured], keep: bool) -> Problem:
    """Return a problem with what was measured here alone, or without it."""
    out = set(map(id, measured))
    experiments = [
        replace(one, measured=tuple(thing for thing in one.measured if (id(thing) in out) == keep))
        for one in problem.experiments
    ]
    return Problem([one for one in experiments if one.measured], problem.fields)
