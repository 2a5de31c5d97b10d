"""Design of a drop table to a specification: programmers, sizes, heights and masses, ranked.

Closed forms (`programmers`) say where to begin, full runs (`search`) correct size and height until peak and width are
those of the ideal pulse, and the specification judges the pulse of each candidate.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from strikewave.base import declare
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.declare import NO_UNIT
from strikewave.base.errors import InputError, InputErrors
from strikewave.base.result import Notice, Source
from strikewave.base.shock_quantities import LENGTH, RATIO, VELOCITY
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import or_else
from strikewave.cases.written_case import dump_case
from strikewave.machines.launch import drop_for_half_sine
from strikewave.reporting.clause_words import first_upper, tag_of
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount, columns_of, text_of
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve
from strikewave.specifications.ideal_pulses import HALF_SINE
from strikewave.specifications.judged_records import rests_on_indicative
from strikewave.specifications.reading import Specification
from strikewave.studies.engine.answers import Failure, answers
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.studies.settings.answer_files import name_at, other_cases
from strikewave.studies.settings.candidate import PEAK
from strikewave.studies.settings.drop_table.candidate import WIDTH, WITHIN, DropCandidate, DropGoal, HeightOfFall
from strikewave.studies.settings.drop_table.programmers import DEFAULTS, Programmer, pad_of_case, read_programmer
from strikewave.studies.settings.drop_table.search import DropDesign, drop_candidate, drop_rank
from strikewave.studies.settings.study import MOST_REASONS, searched

DIAMETERS = (0.05, 0.075, 0.1, 0.15, 0.2, 0.3)
"""Diameters of a pad that are tried by default, m: from that of a striking post to that of a table, in steps of a half
and a third."""
STROKE = 2.0
"""Largest drop height by default, m: assumed; ask the maker of the machine."""
SURELY = 1.2
"""Height of the closed forms over the stroke from which nothing is run: full runs of springs ask for up to 7 % less,
where the frame rings (measured)."""
RESTITUTIONS = (1.0, 0.9, 0.75, 0.5, 0.25, 0.0)
"""Coefficients of restitution for which the height is shown: from no loss to no rebound."""
MOST_CANDIDATES = 300
"""More programmers, diameters and masses than this are refused: at 0.1 to 0.5 s each they take two minutes."""
SOURCES = ("mindlin-1945", "gent-lindley-1959", "stulov-2004", "jesd22-b104")
"""Keys of the sources: of the laws of the programmers, of the equivalent drop height."""


@dataclass(frozen=True)
class DropChoices:
    """What may be chosen: programmers, diameters of a pad (m), masses of the table (kg; empty: that of the case)."""

    programmers: tuple[Programmer, ...] = ()
    diameters: tuple[float, ...] = ()
    masses: tuple[float, ...] = ()

    def tried(self, case: Case) -> tuple[Programmer, ...]:
        """Return the programmers that are tried: unless some are asked for, the pad of the case and `DEFAULTS`."""
        if self.programmers:
            return self.programmers
        pad = pad_of_case(case)
        defaults = tuple(read_programmer(word, own=True) for word in DEFAULTS)
        return defaults if pad is None else (pad, *defaults)


@declare.dataclass
class WantedPulse:
    """What the pulse shall be."""

    shape: str = declare.word("shape of the ideal pulse")
    peak: float = declare.number(PEAK, "its peak")
    duration: float = declare.number(WIDTH, "its duration")
    width: float = declare.number(WIDTH, "its width at the level")
    level: float = declare.number(RATIO, "share of the peak at which the width is taken")
    velocity_change: float = declare.number(VELOCITY, "its velocity change")
    stroke: float = declare.number(LENGTH, "largest drop height")
    within: float = declare.number(RATIO, "relative miss at which the search ends")


@declare.dataclass(eq=False)
class DropStudy(ShownResult):
    """Ranked designs of a drop table for a specification; see `design_drop_table`, and `Result` for what it shares.

    Attributes
    ----------
    case : Case
        What was not chosen.
    goal : DropGoal
        What the pulse shall be.
    choice : DropChoices
        What could be chosen.
    asked : str
        Command line that gives it again, where one does.
    """

    command: ClassVar[str] = "settings"
    main_rows: ClassVar[str] = "candidates"

    case: Case
    goal: DropGoal
    choice: DropChoices

    @declare.computed(declare.word("how many meet it", headline="designs that meet it", in_document=False))
    def met_count(self) -> str:
        """How many of the designs meet the specification."""
        return f"{sum(candidate.meets for candidate in self.candidates)} of {len(self.candidates)}"

    specification = declare.computed(declare.part(Specification, "what pulses are judged by", key="spec"))(
        lambda one: one.goal.specification
    )

    @declare.computed(declare.part(WantedPulse, "what the pulse shall be", key="goal"))
    def wanted(self) -> WantedPulse:
        """The ideal pulse, and the stroke of the machine."""
        goal, pulse = self.goal, self.goal.pulse
        ideal = pulse.shape, pulse.peak, pulse.duration, goal.width, goal.limits.level, pulse.velocity_change
        return WantedPulse(*ideal, goal.stroke, WITHIN)

    case_name = declare.computed(declare.word("case that gives what is not chosen", key="from"))(
        lambda one: one.case.name
    )
    reading = declare.computed(declare.word("what is judged, in words"))(
        lambda one: "acceleration of the table less that of the fall: a sensor whose zero is taken before the blow"
    )
    met = declare.computed(declare.word("whether the best one passes and keeps all limits"))(lambda one: not one.broken)

    @declare.computed(declare.word("whether the verdict rests on a limit from memory", key="by_indicative_limits"))
    def by_indicative(self) -> bool:
        """Whether the verdict on the first rests on a limit that is from memory."""
        verdict = self.candidates[0].verdict
        return rests_on_indicative(verdict.clauses, verdict.verdict)

    @declare.computed(declare.part(DropCandidate, "the first that meets it; null where none does"))
    def best(self) -> DropCandidate | None:
        """First of the ranking if it meets the specification."""
        return self.candidates[0] if self.candidates[0].meets else None

    @declare.computed(declare.rows(HeightOfFall, "heights of a free fall for this velocity change"))
    def heights(self) -> tuple[HeightOfFall, ...]:
        """Heights of free falls that give the velocity change of the ideal pulse, for `RESTITUTIONS`."""
        pulse, friction = self.goal.pulse, or_else(getattr(self.case.machine, "friction", None), 0.0)
        pull = STANDARD_GRAVITY * (1.0 - friction)
        return tuple(
            HeightOfFall(e, drop_for_half_sine(pulse.peak, pulse.duration, e, pull).height) for e in RESTITUTIONS
        )

    candidates: tuple[DropCandidate, ...] = declare.rows(DropCandidate, "the designs, the best first", headline="first")
    failed: tuple[str, ...] = declare.word("why designs gave no result")
    asked: str = ""

    @property
    def broken(self) -> bool:
        """Whether no design meets the specification."""
        return self.best is None

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @property
    def source(self) -> Source:
        """The case of the first candidate, and above it what was asked."""
        text = asked_line(self.case, self.goal, self.choice) + dump_case(self.case_of())
        return Source("case", self.name, text, asked=self.asked)

    def case_of(self, place: int = 0) -> Case:
        """Return the case of a candidate, under a name of its own."""
        update = {"name": name_at(self.name, place), "title": self.title}
        return self.candidates[place].case.model_copy(update=update)

    @property
    def name(self) -> str:
        """Name of the case and of its folder."""
        return name_of(self.goal)

    @property
    def title(self) -> str:
        """The goal in words, after "nearest to" where no design meets it."""
        return first_upper(("nearest to " if self.broken else "") + goal_words(self.goal))

    @property
    def named_units(self) -> Mapping[str, str]:
        """Those of the misses, which are shares of what has their names elsewhere."""
        return dict.fromkeys(("misses.peak", "misses.width"), NO_UNIT)

    def preview(self) -> Curve:
        """Return the pulse of the first."""
        shock = self.candidates[0].reading.shock
        return history_curve(shock.time, shock.values, *PEAK.units, "acceleration of the table")

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        return {"settings.json": self.document_text(), **other_cases(len(self.candidates), self.case_of)}


def drop_columns(designs: Sequence[DropCandidate]) -> list[Column]:
    """Return the columns of designs, with verdicts as they are written."""
    judged = [tag_of(one.judged) for one in designs]
    columns = columns_of(DropCandidate, designs)
    return [one._replace(values=judged) if one.name == "verdict" else one for one in columns]


def goal_words(goal: DropGoal) -> str:
    """Return a goal in words.

    Examples
    --------
    >>> from strikewave.specifications.reading import load_specification
    >>> specification = load_specification("jesd22-b110:B")
    >>> goal_words(DropGoal(specification, specification.pulse_limits(), 2.0))
    'a half-sine of 1500 g and 0.5 ms by jesd22-b110:B'
    """
    peak, duration = amount(PEAK, goal.pulse.peak), amount(WIDTH, goal.pulse.duration)
    return f"a half-sine of {peak} and {duration} by {goal.specification.asked}".replace("\xa0", " ")


def name_of(goal: DropGoal) -> str:
    """Return the name of the case and of the folder of a goal."""
    return f"drop-{goal.specification.file_name}"


def asked_line(case: Case, goal: DropGoal, choice: DropChoices) -> str:
    """Return the first line of the written case: what was asked, and a mark of everything that it was asked of."""
    programmers = [(one.name, dict(one.given)) for one in choice.tried(case)]
    asked = f"{goal.specification.text} {goal.specification.asked} {goal.stroke} {programmers} "
    asked += f"{choice.diameters} {choice.masses}"
    mark = hashlib.sha256(f"{asked} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal_words(goal)}, from {case.name or 'case'} ({mark})\n"


def check_drop_changes(changes: Iterable[str], case: Case, choice: DropChoices) -> None:
    """Refuse a change (``path=value``) of a field that is chosen here: the search would replace it, with no warning.

    Raises
    ------
    InputError
        With the field.

    Examples
    --------
    >>> from strikewave.cases.case import load_case
    >>> check_drop_changes(["machine.height=1 m"], load_case("jesd22-b111-b"), DropChoices())
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: machine.height: got "1 m"; allowed: no --set of it: it is chosen for the \
velocity change; leave it out, or limit it by --stroke
    """
    chosen_here = {"machine.height": ("for the velocity change", "leave it out, or limit it by --stroke")}
    if choice.masses:
        chosen_here["object.mass"] = ("from --table-mass", "leave out one of both")
    pad = any(one.table is not None for one in choice.tried(case))
    for change in changes:
        path, _, value = (part.strip() for part in change.partition("="))
        if path in chosen_here:
            how, hint = chosen_here[path]
            raise InputError(path, value, f"no --set of it: it is chosen {how}", hint)
        size = path.rpartition(".")[2] in ("diameter", "area", "thickness")
        if path.startswith("contact.") and path != "contact.slowest_approach" and (size or not pad):
            raise InputError(
                path, value, "no --set of it: the programmer is chosen", "--programmer or --diameter state it"
            )


def check_drop(case: Case, goal: DropGoal, choice: DropChoices) -> None:
    """Refuse what no drop table can do, before anything is run.

    Raises
    ------
    InputError
        With the option.
    """
    kind = getattr(case.machine, "kind", "rotary")
    if kind != "drop":
        raise InputError("--from", case.name, "a drop table or a rotary machine with --spec", f"this is a {kind}")
    if case.stack.layer or case.impact().object.mass is None:
        raise InputError("--from", case.name, "a table of two bodies, nose and assembly", "leave out the stack")
    if goal.pulse.shape != HALF_SINE:
        allowed = "a half-sine: no programmer that comes back makes another shape"
        raise InputError("--spec", goal.specification.asked, allowed, f"a {goal.pulse.shape} takes one that crushes")
    many = len(choice.tried(case)) * max(len(choice.diameters or DIAMETERS), 1) * max(len(choice.masses), 1)
    if many > MOST_CANDIDATES:
        raise InputError("--programmer", f"{many} designs to try", f"at most {MOST_CANDIDATES}", "ask for fewer")


def design_drop_table(
    case: Case,
    goal: DropGoal,
    choice: DropChoices | None = None,
    store: RunStore | None = None,
    pool: Pool | None = None,
    advance: Advance | None = None,
) -> DropStudy:
    """Return designs of a drop table for a specification, ranked.

    Parameters
    ----------
    case : Case
        What is not chosen: anvil, frame of the table, guides.
    goal : DropGoal
        What the pulse shall be.
    choice : DropChoices, optional
        What may be chosen.
    store : RunStore, optional
        Searches that were finished.
    pool : Pool, optional
        Who makes the others; this process where it is left out.
    advance : callable, optional
        Called as searches come back.

    Raises
    ------
    InputError
        If no design can give it, or none could be run: with the reasons.
    """
    choice = choice or DropChoices()
    check_drop(case, goal, choice)
    note = f"chosen by strikewave settings for {goal_words(goal)}"
    designs = [
        DropDesign(case, goal, programmer, diameter, mass, note)
        for programmer in choice.tried(case)
        for mass in choice.masses or (None,)
        for diameter in _diameters(programmer, case, choice)
    ]
    _check_height(designs, goal)
    with given_or_temporary(store) as kept, pool or ProcessPool(1) as open_pool:
        tried = list(zip(designs, answers(designs, kept, open_pool, advance), strict=True))
    failed = tuple(
        dict.fromkeys(
            f"{design.programmer.name}{_of_diameter(design)}: {found.reason}"
            for design, found in tried
            if isinstance(found, Failure)
        )
    )
    found = [drop_candidate(design, one) for design, one in tried if not isinstance(one, Failure)]
    ranked = tuple(replace(one, place=place) for place, one in enumerate(sorted(found, key=drop_rank), 1))
    if not ranked:
        raise InputErrors(list(failed)[:MOST_REASONS])
    reasons = [one.reason for _, one in tried if isinstance(one, Failure)]
    verdicts = searched([one.run_verdict for one in ranked], reasons)
    study = DropStudy(case, goal, choice, ranked, failed, citations=SOURCES, verdicts=verdicts)
    return replace(study, notices=(*_notices(study), *verdicts.notices()))


def _diameters(programmer: Programmer, case: Case, choice: DropChoices) -> Sequence[float | None]:
    """Return the diameters that are tried of a programmer, m; that of the pad of a case too."""
    if not programmer.is_pad:
        return (None,)
    own = case.values().get("contact.cushion.diameter") if programmer.table is not None else None
    return choice.diameters or sorted({*DIAMETERS, *([] if own is None else [own.si])})


def _of_diameter(design: DropDesign) -> str:
    return "" if design.diameter is None else f" of {design.diameter * 1e3:.4g} mm"


def _check_height(designs: Sequence[DropDesign], goal: DropGoal) -> None:
    """Refuse a velocity change that no fall within the stroke gives: (1 + e) sqrt(2 g (1 - friction) h).

    Where the closed forms are not far beyond it, the full runs decide.
    """
    heights = {design.height_for(design.estimate.speed): design for design in designs}
    least = min(heights)
    if least <= SURELY * goal.stroke:
        return
    easiest, change, stroke = heights[least], goal.pulse.velocity_change, goal.stroke * 1e3
    restitution = easiest.template.impact().contact.restitution.si
    reached = (1.0 + restitution) * np.sqrt(2.0 * STANDARD_GRAVITY * (1.0 - easiest.friction) * goal.stroke)
    raise InputError(
        "--stroke",
        f"{stroke:.4g} mm",
        f"about {least * 1e3:.4g} mm or more for {goal.specification.asked}, a velocity change of {change:.4g} m/s",
        f"a fall of {stroke:.4g} mm gives at most {reached:.4g} m/s with {easiest.programmer.name}: a longer stroke, a "
        "programmer that gives back more, or a driven table",
    )


def _notices(study: DropStudy) -> list[Notice]:
    """Return the warnings on the first candidate, on programmers of an assumed law, and on those that lose nothing."""
    ranked = study.candidates
    notices, first = [], ranked[0]
    lossless = list(dict.fromkeys(one.programmer.name for one in ranked if one.lossless))
    if lossless:
        highest = study.heights[-1]
        message = (
            f"{', '.join(lossless)}: nothing is lost, so the height counts on a full rebound; without any rebound the "
            f"same velocity change takes {text_of(highest, 'height')}. Give the restitution of the programmer, such "
            "as --programmer 'linear, restitution=0.5'"
        )
        notices.append(Notice("no-loss", message, min(one.height for one in ranked if one.lossless), highest.height))
    for name in dict.fromkeys(one.programmer.name for one in ranked if one.programmer.assumed):
        message = f"the law of {name} is assumed, nobody measured it: it stands after those that have a source"
        notices.append(Notice("assumed-law", message))
    if not first.meets:
        message = f"the nearest design misses the goal: {first.obstacles}"
        notices.append(Notice("not-met", message, first.largest_miss, WITHIN))
    return notices
