"""The search for settings of a machine: each design that is tried ends by Broyden's method at a run, which is judged.

A design is a choice of what has no slope, such as a number of strikers or a programmer, with closed forms of two or
three settings; full runs correct their logarithms. Rotary machines and drop tables differ in their designs, in what a
run is held against, and by what candidates are ordered.
"""

from __future__ import annotations

import hashlib
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.errors import InputError, InputErrors, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import RUN_BROKEN, RUN_FAILED, Notice, Source, Verdicts, status_of
from strikewave.base.shock_quantities import usual_unit
from strikewave.base.texts import percent
from strikewave.base.units import in_unit
from strikewave.cases.case import FORM, Case, dump_case
from strikewave.machines import MachineRun
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import columns_of
from strikewave.reporting.parts import Tag
from strikewave.signal.pulse import crossing, refine_peak
from strikewave.specifications.judging import PulseLimits, Shock
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.questions import Failure, Question, answers
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore
from strikewave.studies.study import Study

Array = NDArray[np.float64]

CLOSE = 0.002
"""Miss at which a search ends: a 25th of what a goal of 5 % allows, so that rounding the values does not lose it
again."""
MOST_RUNS = 12
"""Most runs of a search. Of 36 searches from li-ma-2019 (two goals), 32 came `CLOSE` in three to five runs; the others
came no nearer in twelve."""
LONGEST_STEP = 0.6
"""Longest step of the logarithm of a setting from one run to the next, a factor of 1.8: the slopes hold near a run
only, and estimates were off by 1.6 at most (measured, li-ma-2019)."""
WORST_CONDITION = 1e4
"""Condition number of the slopes beyond which the first ones are taken again: the step would be that of rounding."""
SHORTEST_STEP = 1e-5
"""Step of the logarithms below which a search stands still: rounding changes a setting by more."""
LEAST_SQUARE = 1e-12
"""Least square of a step that Broyden's correction is divided by: a step that the bounds cut to nothing tells no
slope."""
DIGITS = 4
"""Significant digits of a chosen value: rounding then changes it by less than `CLOSE`, and no part is made more
exactly."""
UNITS = {
    "m": "mm", "s": "ms", "kg": "kg", "N": "N", "N/m": "kN/m", "N s/m": "N s/m", "rad/s": "rpm",
}  # fmt: skip
"""Units in which chosen values are written; others have none."""
STIFF = 1e6
"""Stiffnesses above this, N/m, are written in MN/m: those of frames and mounts; those of springs are in kN/m."""
MOST_REASONS = 5
"""Reasons that an error lists where nothing can be run: more would not be read."""
SAMPLES = 2000
"""Samples of the duration of the ideal pulse at which a run is read: a peak lies 3e-7 above them at most."""
BESIDE = (0.5, 1.0)
"""Durations before and after the pulse that are read where a specification has no band."""
ROOM = 0.75
"""Durations that are read beyond those: as far as a band is moved over a record to find its place."""
PEAK = Quantity("m/s^2", "g", "peak")
STIFFNESS = Quantity("N/m", "MN/m", digits=3)
OWN_UNIT = "its unit"


def chosen(path: str, value: float, note: str) -> Value:
    """Return a value of a case that was chosen here, rounded to `DIGITS`.

    Examples
    --------
    >>> chosen("machine.engagement", 0.00512345678, "by hand").typed
    '5.123 mm'
    """
    allowed = FORM.range_at(path.split("."))
    assert allowed is not None
    unit = "MN/m" if allowed.unit == "N/m" and value >= STIFF else UNITS.get(allowed.unit, "")
    number = float(f"{in_unit(value, allowed.unit, unit):.{DIGITS}g}") if unit else value
    typed = f"{number:.10g} {unit}" if unit else round(value) if allowed.unit == "count" else value
    try:
        return allowed.read({"value": typed, "provenance": "assumed", "note": note})
    except InputError as error:
        raise error.at(path) from None


def refuse_changes(changes: Iterable[str], chosen_here: Mapping[str, tuple[str, str]]) -> None:
    """Refuse a change (``path=value``) of a field that is chosen here: the search would replace it, with no warning.

    ``chosen_here`` has for each such field how it is chosen, and what to do instead.
    """
    for change in changes:
        path, _, value = (part.strip() for part in change.partition("="))
        if path in chosen_here:
            how, hint = chosen_here[path]
            raise InputError(path, value, f"no --set of it: it is chosen{how}", hint)


def beside(limits: PulseLimits) -> tuple[float, float]:
    """Return the durations before and after the pulse that its judge looks at."""
    before, after = BESIDE if limits.band is None else (limits.band.before, limits.band.after)
    return max(before, limits.window[0]), max(after, limits.window[1])


def shock_about(run: MachineRun, touch: float, limits: PulseLimits) -> Shock:
    """Return the rigid-body acceleration about a first touch, s; its zero is that of a sensor, as in `Moments`."""
    duration, (before, after) = limits.pulse.duration, beside(limits)
    step = duration / SAMPLES
    first = -math.ceil((before + 1.0 + ROOM) * duration / step)
    last = min(math.ceil((2.0 + after + ROOM) * duration / step), math.floor((run.end - touch) / step))
    since = step * np.arange(first, last + 1)
    begin = float(run.spans[0].begin)
    values = run.sample(np.clip(touch + since, begin, run.end)).rigid_acceleration
    inside = (since >= 0.0) & (since <= 2.0 * duration)
    place = int(np.argmax(np.where(inside, values, -math.inf)))
    return Shock(np.asarray(values, dtype=np.float64), step, float(since[0]), place)


def peak_and_width(shock: Shock, level: float) -> tuple[float, float]:
    """Return the peak of a shock, and its width at a share of it, s; as its judge takes them."""
    _, peak = refine_peak(shock.values, shock.peak_index)
    first, last = (crossing(shock.values, shock.peak_index, level * peak, side) for side in (-1, 1))
    return peak, shock.step * (last - first)


@declare.dataclass
class Limit:
    """A value beside its limit; one that does not decide is only warned of."""

    name: str = declare.word("what is limited")

    @declare.phrase("limit", column=KEY)
    def words(self) -> str:
        """Return what is limited, in words."""
        return self.name.replace("_", " ")

    value: float = declare.number(Quantity.of_data(OWN_UNIT, digits=3), "what it comes to, in its unit", column=MAIN)
    limit: float = declare.number(
        Quantity.of_data(OWN_UNIT, "at most", digits=3), "the limit, in its unit", column=MAIN
    )
    unit: str = declare.word("SI unit of both")
    decides: bool = declare.word("whether it decides, or is only warned of", default=True)

    kept = declare.computed(declare.word("whether it is kept"))(lambda one: bool(one.value <= one.limit))

    @property
    def given_units(self) -> declare.GivenUnits:
        """Its unit, and the one in which it is shown."""
        return {OWN_UNIT: (self.unit, usual_unit(self.unit))}


def limit_columns(limits: Sequence[Limit]) -> list[Column]:
    """Return the columns of limits of a candidate, each in its own unit."""
    result = [Tag("kept", "good") if one.kept else Tag("broken", "bad") if one.decides else Tag("warned", "warned")
              for one in limits]  # fmt: skip
    return [*columns_of(Limit, limits), Column("result", result, words=True)]


@declare.dataclass
class ChosenValue:
    """A value that was chosen."""

    si: float = declare.number(Quantity.of_data("as the field"), "value of what was chosen, SI")
    typed: str | float = declare.word("as it stands in the case")


@declare.dataclass(eq=False)
class MachineCandidate(ABC):
    """A design at the settings where its search ended: its case, and by its full run whether it meets the goal.

    Attributes
    ----------
    case : Case
        Its case.
    goal : MachineGoal
        Goal that it is compared with.
    chosen : tuple of str
        Paths of what was chosen.
    limits : tuple of Limit
        Its values that have a limit.
    runs : int
        Runs that it took.
    halt : str
        Why the search ended before the goal; empty where it came close.
    run_verdict : str
        Outcome of the checks of its full run: the text of `strikewave.base.result.Verdict`.
    """

    within: ClassVar[float]
    """Largest miss of what meets the goal."""

    case: Case
    place: int = declare.count("in the ranking, from 1", label="#", column=KEY, tables="ranking")
    goal: MachineGoal
    chosen: tuple[str, ...]
    limits: tuple[Limit, ...]
    runs: int
    halt: str
    run_verdict: str

    @declare.computed(
        declare.word(
            "whether it meets the goal and keeps all limits", column=MAIN, tables="ranking", is_tag=True, order=2
        )
    )
    def meets(self) -> bool:
        """Whether nothing is off by more than `within`, its blows pass, every limit is kept, and its run sound."""
        kept = self.largest_miss <= self.within and self.passes and not self.broken
        return kept and status_of(self.run_verdict) != RUN_BROKEN

    @declare.computed(declare.word("what keeps it from that, in words"))
    def obstacles(self) -> str:
        """What keeps it from the goal, in one line."""
        reasons = [
            f"{name} off by {percent(miss, 1, '+')}"
            for name, miss in self.relative_misses.items()
            if not abs(miss) <= self.within
        ]
        reasons += [*self.odd_blows, *map(self.limit_words, self.broken)]
        if status_of(self.run_verdict) == RUN_BROKEN:
            reasons.append(f"the run is {self.run_verdict}")
        reasons += self.not_passed
        return "; ".join(reasons + ([self.halt] if self.halt and reasons else []))

    @property
    @abstractmethod
    def relative_misses(self) -> Mapping[str, float]:
        """By how much of itself each part of the goal is missed."""

    @property
    @abstractmethod
    def passes(self) -> bool:
        """Whether all blows are as they shall be, and the specification passes them, where there is one."""

    @property
    @abstractmethod
    def not_passed(self) -> list[str]:
        """Clauses of the specification that are not passed, in words."""

    @property
    @abstractmethod
    def rank(self) -> tuple[Any, ...]:
        """What candidates are ordered by."""

    @property
    def odd_blows(self) -> list[str]:
        """Blows that are not as they shall be, in words."""
        return []

    def limit_words(self, limit: Limit) -> str:
        """Say that a limit is not kept."""
        return f"{limit.words} above its limit"

    @property
    def broken(self) -> tuple[Limit, ...]:
        """Limits that decide and are not kept."""
        return tuple(limit for limit in self.limits if limit.decides and not limit.kept)

    @property
    def largest_miss(self) -> float:
        """Largest of the misses, infinite where one has no number."""
        return max((abs(miss) if math.isfinite(miss) else math.inf) for miss in self.relative_misses.values())


RUN_CHECKS = "what the checks of its full run came to: passed, or broken with the checks that failed"
"""Meaning of `MachineCandidate.run_verdict`."""


class MachineGoal(Protocol):
    """What is asked of a machine."""

    @property
    def words(self) -> str:
        """It in words."""

    @property
    def name(self) -> str:
        """Name of the case and of the folder."""


class MachineChoice(Protocol):
    """What may be chosen of a machine."""

    def asked(self, case: Case, goal: Any) -> str:
        """Return all that is asked, but for the case, as a text."""


Candidate = TypeVar("Candidate", bound=MachineCandidate)
Candidate_co = TypeVar("Candidate_co", bound=MachineCandidate, covariant=True)


@dataclass(frozen=True)
class SearchEnd:
    """Where a search ended: settings, runs, why before the goal (empty where it came close)."""

    settings: tuple[float, ...]
    runs: int
    halt: str


def search_end(
    off: Callable[[Array], Array],
    start: Array,
    bounds: tuple[Array, Array],
    slopes: Array,
    at_bound: Callable[[Array, Array, Array], str],
) -> SearchEnd:
    """Return the settings whose run comes nearest to a goal, by Broyden's method on their logarithms.

    Each run gives its misses and corrects the slopes. A run that cannot be made halves the step.

    Parameters
    ----------
    off : callable
        Returns the logarithms of results over the goal at settings; raises `StrikewaveError` or `ValueError` where
        there are none.
    start, bounds : ndarray
        First settings, the least and the largest.
    slopes : ndarray
        First guess of the slopes of the logarithms of results over those of settings.
    at_bound : callable
        Says which setting stands at its bound, of logarithms of settings and of the bounds; empty where none does.

    Examples
    --------
    >>> bounds = np.ones(2), np.full(2, 9.0)
    >>> end = search_end(lambda x: np.log(x / [2.0, 3.0]), np.array([1.5, 4.0]), bounds, np.eye(2), lambda *_: "")
    >>> np.round(end.settings, 6).tolist(), end.runs, end.halt
    ([2.0, 3.0], 3, '')
    """
    low, high = (np.log(bound) for bound in bounds)
    first_slopes, slopes = slopes, slopes.copy()
    x, failure, best = np.clip(np.log(start), low, high), "", None
    for runs in range(1, MOST_RUNS + 1):
        try:
            missed = off(np.exp(x))
            if not np.all(np.isfinite(missed)):
                raise ValueError("a pulse has no width at that share of its peak")
        except (StrikewaveError, ValueError) as error:
            failure = error.lines[0] if isinstance(error, InputErrors) else str(error)
            if best is None:
                raise StrikewaveError(failure) from None
            x = 0.5 * (x + best[0])
            continue
        if best is not None:
            moved = x - best[0]
            slopes += np.outer(missed - best[1] - slopes @ moved, moved) / max(float(moved @ moved), LEAST_SQUARE)
        if best is None or np.abs(missed).max() < np.abs(best[1]).max():
            best = x, missed
        if np.abs(best[1]).max() < CLOSE:
            return SearchEnd(tuple(np.exp(best[0]).tolist()), runs + 1, "")
        if not np.linalg.cond(slopes) < WORST_CONDITION:
            slopes = first_slopes.copy()
        step = np.clip(-np.linalg.solve(slopes, best[1]), -LONGEST_STEP, LONGEST_STEP)
        following = np.clip(best[0] + step, low, high)
        if np.abs(following - x).max() < SHORTEST_STEP:
            break
        x = following
    assert best is not None
    halt = at_bound(best[0], low, high) or at_bound(x, low, high) or failure
    return SearchEnd(tuple(np.exp(best[0]).tolist()), runs + 1, halt or f"nothing nearer was found in {runs} runs")


class MachineDesign(Question[Any], Protocol[Candidate_co]):
    """What is tried for a goal: a question that is answered by where its search ends, and what a full run shows there.

    The full run has the rounded values and the own tolerance of the case, as the case file will have them.
    """

    @property
    def called(self) -> str:
        """What it is called where it gives no result."""

    def candidate(self, answer: Any) -> Candidate_co:
        """Return what was found with all that it is judged by."""


Tried = list[tuple[MachineDesign[Candidate], Candidate | Failure]]


def tried_designs(
    designs: Sequence[MachineDesign[Candidate]], store: RunStore, pool: Pool, advance: Advance | None
) -> Tried[Candidate]:
    """Return designs with what their searches end at, or why that is nothing."""
    return [
        (design, answer if isinstance(answer, Failure) else design.candidate(answer))
        for design, answer in zip(designs, answers(designs, store, pool, advance), strict=True)
    ]


def ranked(tried: Tried[Candidate]) -> tuple[tuple[Candidate, ...], tuple[str, ...], Verdicts]:
    """Return the candidates in their order, why designs gave none, and the verdicts of their runs: the first's decides.

    Raises
    ------
    InputErrors
        If there is none: with the reasons.
    """
    reasons = [end.reason for _, end in tried if isinstance(end, Failure)]
    candidates = sorted((end for _, end in tried if not isinstance(end, Failure)), key=lambda end: end.rank)
    if not candidates:
        raise InputErrors(list(dict.fromkeys(reasons))[:MOST_REASONS])
    failed = dict.fromkeys(f"{design.called}: {end.reason}" for design, end in tried if isinstance(end, Failure))
    texts = [*(end.run_verdict for end in candidates), *[RUN_FAILED] * len(reasons)]
    verdicts = Verdicts(texts, "settings", next(iter(reasons), ""), deciding=texts[:1])
    return tuple(replace(end, place=place) for place, end in enumerate(candidates, 1)), tuple(failed), verdicts


def asked_line(case: Case, goal: MachineGoal, choice: MachineChoice) -> str:
    """Return the first line of the written case: what was asked, and a mark of everything that it was asked of."""
    mark = hashlib.sha256(f"{choice.asked(case, goal)} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal.words}, from {case.name or 'case'} ({mark})\n"


@declare.dataclass(eq=False)
class MachineSearch(Study):
    """Ranked settings of a machine for a goal; see `Result` for what it shares with others.

    Attributes
    ----------
    case : Case
        Case that gives all that was not chosen.
    goal : MachineGoal
        Goal of the search.
    choice : MachineChoice
        Settings that could be chosen.
    candidates : tuple of MachineCandidate
        The best first.
    failed : tuple of str
        Why designs gave no result.
    """

    main_rows: ClassVar[str] = "candidates"
    noun: ClassVar[str]
    """Name of a candidate."""

    case: Case
    goal: Any
    choice: Any
    candidates: tuple[Any, ...]
    failed: tuple[str, ...]

    case_name = declare.computed(declare.word("case that gives what is not chosen", key="from"))(
        lambda study: study.case.name
    )
    met = declare.computed(declare.word("whether the best one meets the goal and keeps all limits"))(
        lambda study: not study.broken
    )

    @property
    def meeting(self) -> int:
        """How many candidates meet the goal."""
        return sum(candidate.meets for candidate in self.candidates)

    @property
    def broken(self) -> bool:
        """Whether no candidate meets the goal."""
        return not self.candidates[0].meets

    @property
    def marked_text(self) -> str:
        """The case of the first candidate, and above it what was asked."""
        return asked_line(self.case, self.goal, self.choice) + dump_case(self.case_of())

    @cached_property
    def source(self) -> Source:
        """That case under the name of the goal."""
        return Source("case", self.name, self.marked_text, asked=self.asked)

    def case_of(self, place: int = 0) -> Case:
        """Return the case of a candidate, under a name of its own and without published numbers to compare with."""
        name = f"{self.name}-{place + 1}" if place else self.name
        update = {"name": name, "title": self.title, "published": ()}
        return self.candidates[place].case.model_copy(update=update)

    @property
    def name(self) -> str:
        """Name of the case and of its folder."""
        return str(self.goal.name)

    @property
    def title(self) -> str:
        """The goal in words, after "nearest to" where no candidate meets it."""
        return ("nearest to " if self.broken else "") + self.goal.words

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        others = {f"case-{k + 1}.toml": dump_case(self.case_of(k)) for k in range(1, len(self.candidates))}
        return {**super().texts(), **others}

    def not_met(self) -> Iterator[Notice]:
        """Yield the warning that no candidate meets the goal, where none does."""
        first = self.candidates[0]
        if not first.meets:
            message = f"the nearest {self.noun} misses the goal: {first.obstacles}"
            yield Notice("not-met", message, first.largest_miss, first.within)

    @property
    def words(self) -> str:
        """What was found, in words."""
        first, met = self.candidates[0], self.meeting
        values = first.case.values()
        settings = ", ".join(f"{path} = {values[path].typed}" for path in first.chosen)
        sentences = [
            f"{met or 'None'} of {len(self.candidates)} {self.noun}s that were run in full "
            f"{'gives' if met == 1 else 'give'} {self.goal_words}.",
            *self.first_sentences("The first" if met else "The nearest", settings),
        ]
        if not met:
            sentences.append(f"It misses the goal: {first.obstacles}.")
        return " ".join([*sentences, *([self.verdicts.sentence] if self.verdicts.words else [])])

    @property
    def goal_words(self) -> str:
        """What candidates give that meet the goal, in words."""
        return str(self.goal.words)

    def first_sentences(self, which: str, settings: str) -> list[str]:
        """Return the sentences on the first candidate."""
        return [f"{which}: {settings}."]
