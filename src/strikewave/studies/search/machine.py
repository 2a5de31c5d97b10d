"""The search for settings of a machine: each design that is tried ends at a full run, by which it is judged.

A design is a choice that has no slope, such as a number of strikers or a programmer, with closed forms of two or three
settings; full runs correct their logarithms by Broyden's method. Rotary machines and drop tables differ in their
designs, in the goal that a run is compared with, and in the order of candidates. `SearchStudy` is the result that they
share with the search over any settings of a case (`strikewave.studies.search.design`).
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
"""Miss at which a search ends: a 25th of the 5 % that a goal allows, so that rounding the values does not lose it."""
MOST_RUNS = 12
"""Most runs of a search. Of 36 searches from li-ma-2019 (two goals), 32 came `CLOSE` in three to five runs; the others
came no nearer in twelve."""
LONGEST_STEP = 0.6
"""Longest step of the logarithm of a setting from one run to the next, a factor of 1.8: the slopes hold near a run
only, and estimates were off by 1.6 at most (measured, li-ma-2019)."""
WORST_CONDITION = 1e4
"""Condition number of the slopes beyond which the first ones return: rounding alone would decide the step."""
SHORTEST_STEP = 1e-5  # step of the logarithms below which a search stands still: rounding changes a setting by more
LEAST_SQUARE = 1e-12  # least divisor of Broyden's correction: a step that the bounds cut to nothing tells no slope
DIGITS = 4
"""Significant digits of a chosen value: rounding changes it by less than `CLOSE`, and no part is made more exactly."""
UNITS = {
    "m": "mm", "s": "ms", "kg": "kg", "N": "N", "N/m": "kN/m", "N s/m": "N s/m", "rad/s": "rpm",
}  # fmt: skip
"""Units in which chosen values are written; others have none."""
STIFF = 1e6
"""Stiffnesses above this, N/m, are written in MN/m: those of frames and mounts; those of springs are in kN/m."""
MOST_REASONS = 5  # reasons that an error lists where nothing can be run: more would not be read
SAMPLES = 2000  # samples a duration of the ideal pulse: a peak lies 3e-7 above them at most
BESIDE = (0.5, 1.0)
"""Durations read before and after the pulse where a specification has no band: chosen, to show baseline and rebound."""
ROOM = 0.75  # durations read beyond those: as far as a band is moved over a record to find its place
PEAK = Quantity("m/s^2", "g", "peak")
STIFFNESS = Quantity("N/m", "MN/m", digits=3)
OWN_UNIT = "its unit"


def chosen(path: str, value: float, note: str) -> Value:
    """Return a chosen value of a case, rounded to `DIGITS`."""
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
    """Refuse a change (``path=value``) of a field in ``chosen_here``, which the search would replace with no warning.

    Its values say how the field is chosen, and what to do instead.
    """
    for change in changes:
        path, _, value = (part.strip() for part in change.partition("="))
        if path in chosen_here:
            how, hint = chosen_here[path]
            raise InputError(path, value, f"no --set of it: it is chosen{how}", hint)


def beside(limits: PulseLimits) -> tuple[float, float]:
    """Return the durations before and after the pulse that its specification judges."""
    before, after = BESIDE if limits.band is None else (limits.band.before, limits.band.after)
    return max(before, limits.window[0]), max(after, limits.window[1])


def shock_about(run: MachineRun, touch: float, limits: PulseLimits) -> Shock:
    """Return the rigid-body acceleration about a first touch (s), with the zero of a sensor, as in `Moments`."""
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
    """Return the peak of a shock, and its width at a share of the peak, s, as judging takes them."""
    _, peak = refine_peak(shock.values, shock.peak_index)
    first, last = (crossing(shock.values, shock.peak_index, level * peak, side) for side in (-1, 1))
    return peak, shock.step * (last - first)


@declare.dataclass
class Limit:
    """A value with its limit; one that does not decide only warns."""

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

    kept = declare.computed(declare.word("whether it is kept"))(lambda limit: bool(limit.value <= limit.limit))

    @property
    def given_units(self) -> declare.GivenUnits:
        """Unit of the limit, and the one in which it is shown."""
        return {OWN_UNIT: (self.unit, usual_unit(self.unit))}


def limit_columns(limits: Sequence[Limit]) -> list[Column]:
    """Return the columns of the limits of a candidate, each in its own unit."""
    broken = {True: Tag("broken", "bad"), False: Tag("warned", "warned")}
    result = [Tag("kept", "good") if limit.kept else broken[limit.decides] for limit in limits]
    return [*columns_of(Limit, limits), Column("result", result, words=True)]


@declare.dataclass
class ChosenValue:
    """A value that was chosen."""

    si: float = declare.number(Quantity.of_data("as the field"), "value of what was chosen, SI")
    typed: str | float = declare.word("as it stands in the case")


@declare.dataclass(eq=False)
class MachineCandidate(ABC):
    """A design at the settings where its search ended, judged by its full run.

    Attributes
    ----------
    case : Case
        Case at these settings.
    goal : BlowGoal or DropGoal
        Goal that the full run is compared with.
    chosen : tuple of str
        Paths of the chosen values.
    limits : tuple of Limit
        Values that have a limit.
    runs : int
        Runs of the search.
    halt : str
        Reason why the search ended before the goal; empty where it came close.
    run_verdict : str
        Outcome of the checks of the full run: the text of `strikewave.base.result.Verdict`.
    """

    within: ClassVar[float]
    """Largest miss of what meets the goal."""

    case: Case
    place: int = declare.count("in the ranking, from 1", label="#", column=KEY, tables="ranking")
    goal: Any
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
        """True if no part misses by more than `within`, its blows pass, and it keeps all limits and checks."""
        kept = self.largest_miss <= self.within and self.passes and not self.broken
        return kept and status_of(self.run_verdict) != RUN_BROKEN

    @declare.computed(declare.word("what keeps it from that, in words"))
    def obstacles(self) -> str:
        """Reasons why it does not meet the goal, in one line."""
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
        """Relative miss of each part of the goal."""

    @property
    @abstractmethod
    def passes(self) -> bool:
        """True if all blows are as wanted, and the specification, if any, passes them."""

    @property
    @abstractmethod
    def not_passed(self) -> list[str]:
        """Clauses of the specification that do not pass, in words."""

    @property
    @abstractmethod
    def rank(self) -> tuple[Any, ...]:
        """Key by which candidates are sorted."""

    @property
    def odd_blows(self) -> list[str]:
        """Blows that are not as wanted, in words."""
        return []

    def limit_words(self, limit: Limit) -> str:
        """Return the sentence on a broken limit."""
        return f"{limit.words} above its limit"

    @property
    def broken(self) -> tuple[Limit, ...]:
        """Broken limits that decide."""
        return tuple(limit for limit in self.limits if limit.decides and not limit.kept)

    @property
    def largest_miss(self) -> float:
        """Largest of the misses; infinite where one is no number."""
        return max((abs(miss) if math.isfinite(miss) else math.inf) for miss in self.relative_misses.values())


RUN_CHECKS = "what the checks of its full run came to: passed, or broken with the checks that failed"
"""Meaning of `MachineCandidate.run_verdict`."""


Candidate = TypeVar("Candidate", bound=MachineCandidate)
Candidate_co = TypeVar("Candidate_co", bound=MachineCandidate, covariant=True)


@dataclass(frozen=True)
class SearchEnd:
    """End of a search: settings, runs, and the reason why it ended before the goal (empty where it came close)."""

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

    Each run corrects the slopes; a run that fails halves the step.

    Parameters
    ----------
    off : callable
        Returns the logarithms of results over the goal; raises `StrikewaveError` or `ValueError` where a run
        fails.
    start, bounds : ndarray
        First settings, the least and the largest.
    slopes : ndarray
        First guess of the slopes of the logarithms of results over those of settings.
    at_bound : callable
        Returns the sentence on a setting at its bound, from the logarithms of settings and bounds; empty for none.

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
            if not np.all(np.isfinite(missed)):  # a failed pulse is treated as a failed run
                raise ValueError("a pulse has no width at that share of its peak")
        except (StrikewaveError, ValueError) as error:
            failure = error.lines[0] if isinstance(error, InputErrors) else str(error)
            if best is None:
                raise StrikewaveError(failure) from None
            x = 0.5 * (x + best[0])  # the best run was possible, so a place nearer to it may be
            continue
        if best is not None:
            moved = x - best[0]
            slopes += np.outer(missed - best[1] - slopes @ moved, moved) / max(float(moved @ moved), LEAST_SQUARE)
        if best is None or np.abs(missed).max() < np.abs(best[1]).max():
            best = x, missed
        if np.abs(best[1]).max() < CLOSE:
            return SearchEnd(tuple(np.exp(best[0]).tolist()), runs + 1, "")  # 1: the full run that judges it
        if not np.linalg.cond(slopes) < WORST_CONDITION:
            slopes = first_slopes.copy()
        # from the best run, not the last: a step that made it worse is not followed
        step = np.clip(-np.linalg.solve(slopes, best[1]), -LONGEST_STEP, LONGEST_STEP)
        following = np.clip(best[0] + step, low, high)
        if np.abs(following - x).max() < SHORTEST_STEP:
            break
        x = following
    assert best is not None
    halt = at_bound(best[0], low, high) or at_bound(x, low, high) or failure
    return SearchEnd(tuple(np.exp(best[0]).tolist()), runs + 1, halt or f"nothing nearer was found in {runs} runs")


class MachineDesign(Question[Any], Protocol[Candidate_co]):
    """A design that is tried for a goal: its answer is the end of its search, and the full run there.

    The full run has the rounded values and the tolerance of the case, as the written case has them.
    """

    @property
    def called(self) -> str:
        """Name in a sentence on a failure."""

    def candidate(self, answer: Any) -> Candidate_co:
        """Return the candidate of an answer."""


Tried = list[tuple[MachineDesign[Candidate], Candidate | Failure]]


def tried_designs(
    designs: Sequence[MachineDesign[Candidate]], store: RunStore, pool: Pool, advance: Advance | None
) -> Tried[Candidate]:
    """Return each design with the candidate of its search, or with its failure."""
    return [
        (design, answer if isinstance(answer, Failure) else design.candidate(answer))
        for design, answer in zip(designs, answers(designs, store, pool, advance), strict=True)
    ]


def ranked(tried: Tried[Candidate]) -> tuple[tuple[Candidate, ...], tuple[str, ...], Verdicts]:
    """Return the sorted candidates, the failures in words, and the verdicts of the runs, of which the first decides."""
    reasons = [end.reason for _, end in tried if isinstance(end, Failure)]
    candidates = sorted((end for _, end in tried if not isinstance(end, Failure)), key=lambda end: end.rank)
    if not candidates:
        raise InputErrors(list(dict.fromkeys(reasons))[:MOST_REASONS])
    failed = dict.fromkeys(f"{design.called}: {end.reason}" for design, end in tried if isinstance(end, Failure))
    texts = [*(end.run_verdict for end in candidates), *[RUN_FAILED] * len(reasons)]
    verdicts = Verdicts(texts, "settings", next(iter(reasons), ""), deciding=texts[:1])
    return tuple(replace(end, place=place) for place, end in enumerate(candidates, 1)), tuple(failed), verdicts


def asked_line(case: Case, goal: Any, choice: Any) -> str:
    """Return the first line of the written case: the goal, and a mark of all that was asked."""
    mark = hashlib.sha256(f"{choice.asked(case, goal)} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal.words}, from {case.name or 'case'} ({mark})\n"


class SearchStudy(Study):
    """Ranked settings of a case, the best first; see `Result` for the members that all results share."""

    candidates: tuple[Any, ...]

    @property
    @abstractmethod
    def asked_line(self) -> str:
        """First line of the written case: the question, and a mark of all that was asked."""

    @property
    @abstractmethod
    def written_as(self) -> tuple[str, str]:
        """Name and title of the written case."""

    @property
    def broken(self) -> bool:
        """True if no candidate meets the goal."""
        return not self.candidates[0].meets

    @property
    def marked_text(self) -> str:
        """The case of the first candidate, below the question."""
        return self.asked_line + dump_case(self.case_of())

    @abstractmethod
    def candidate_case(self, place: int) -> Case:
        """Return the case of a candidate."""

    def case_of(self, place: int = 0) -> Case:
        """Return the case of a candidate under its own name, without published numbers to compare with."""
        name, title = self.written_as
        update = {"name": f"{name}-{place + 1}" if place else name, "title": title, "published": ()}
        return self.candidate_case(place).model_copy(update=update)


@declare.dataclass(eq=False)
class MachineSearch(SearchStudy):
    """Ranked settings of a machine for a goal; see `Result` for the members that all results share.

    Attributes
    ----------
    case : Case
        Case that gives all values that were not chosen.
    goal : BlowGoal or DropGoal
        Goal of the search.
    choice : SettingsChoices or DropChoices
        Settings that could be chosen.
    candidates : tuple of MachineCandidate
        The best first.
    failed : tuple of str
        Reasons why designs gave no result.
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
        """Number of candidates that meet the goal."""
        return sum(candidate.meets for candidate in self.candidates)

    @property
    def asked_line(self) -> str:
        """First line of the written case: the goal, and a mark of all that was asked."""
        return asked_line(self.case, self.goal, self.choice)

    @cached_property
    def source(self) -> Source:
        """The written case under the name of the goal."""
        return Source("case", self.name, self.marked_text, asked=self.asked)

    def candidate_case(self, place: int) -> Case:
        """Return the case of a candidate."""
        case: Case = self.candidates[place].case
        return case

    @property
    def name(self) -> str:
        """Name of the goal, for the case and its folder."""
        return str(self.goal.name)

    @property
    def written_as(self) -> tuple[str, str]:
        """Name and title of the written case: those of the goal."""
        return self.name, self.title

    @property
    def title(self) -> str:
        """The goal in words, after "nearest to" where no candidate meets it."""
        return ("nearest to " if self.broken else "") + self.goal.words

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        others = {f"case-{k + 1}.toml": dump_case(self.case_of(k)) for k in range(1, len(self.candidates))}
        return {**super().texts(), **others}

    def not_met(self) -> Iterator[Notice]:
        """Yield the warning where no candidate meets the goal."""
        first = self.candidates[0]
        if self.broken:
            message = f"the nearest {self.noun} misses the goal: {first.obstacles}"
            yield Notice("not-met", message, first.largest_miss, first.within)

    @property
    def words(self) -> str:
        """Outcome of the search in sentences."""
        first, met = self.candidates[0], self.meeting
        values = first.case.values()
        settings = ", ".join(f"{path} = {values[path].typed}" for path in first.chosen)
        return " ".join(
            [
                f"{met or 'None'} of {len(self.candidates)} {self.noun}s that were run in full "
                f"{'gives' if met == 1 else 'give'} {self.goal_words}.",
                *self.first_sentences("The first" if met else "The nearest", settings),
                *([] if met else [f"It misses the goal: {first.obstacles}."]),
                *([self.verdicts.sentence] if self.verdicts.words else []),
            ]
        )

    @property
    def goal_words(self) -> str:
        """The goal, and the conditions of meeting it, in words."""
        return str(self.goal.words)

    def first_sentences(self, which: str, settings: str) -> list[str]:
        """Return the sentences on the first candidate."""
        return [f"{which}: {settings}."]
