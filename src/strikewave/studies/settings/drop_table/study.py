"""Design of a drop table to a specification: programmers, sizes, heights and masses, ranked.

Closed forms (`programmers`) say where to begin, full runs (`search`) correct size and height until peak and width are
those of the ideal pulse, and the specification judges the pulse of each candidate.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from strikewave.base import declare
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import InputError, InputErrors
from strikewave.base.result import Notice, Source
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import or_else
from strikewave.cases.written_case import dump_case
from strikewave.machines.launch import drop_for_half_sine
from strikewave.reporting.clause_words import first_upper
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import Curve, ShownResult, columns_of, history_curve
from strikewave.specifications.ideal_pulses import HALF_SINE
from strikewave.specifications.judged_records import clause_document, rests_on_indicative
from strikewave.studies.engine.answers import Failure, answers
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.runner import Advance
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.studies.settings.answer_files import name_at, other_cases
from strikewave.studies.settings.drop_table.programmers import DEFAULTS, Programmer, pad_of_case, read_programmer
from strikewave.studies.settings.drop_table.search import (
    WITHIN,
    DropCandidate,
    DropDesign,
    DropGoal,
    HeightOfFall,
    drop_candidate,
    drop_rank,
)
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
UNITS = {
    "peak": "m/s^2", "width": "s", "velocity_change": "m/s", "height": "m", "table_mass": "kg", "diameter": "m",
    "thickness": "m", "rate": "N/m", "approach": "m/s", "rigid_peak": "m/s^2", "peak_force": "N", "compression": "m",
    "rise": "s", "restitution": "1", "stroke": "m", "duration": "s", "speed": "m/s", "margin": "1", "departure": "1",
}  # fmt: skip
"""SI unit of each quantity of the document; settings, limits and clauses name their own. ``estimate.size`` is a rate or
a thickness."""


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


@dataclass(frozen=True, eq=False)
class DropStudy(ShownResult):
    """Ranked designs of a drop table for a specification; see `design_drop_table`, and `Result` for what it shares.

    ``failed`` holds why a programmer gave no result; ``asked`` is the command line that gives it again, where one does.
    """

    command: ClassVar[str] = "settings"

    case: Case
    goal: DropGoal
    choice: DropChoices
    candidates: tuple[DropCandidate, ...]
    failed: tuple[str, ...]
    asked: str = ""

    @property
    def best(self) -> DropCandidate | None:
        """First of the ranking if it meets the specification."""
        return self.candidates[0] if self.candidates[0].meets else None

    @property
    def broken(self) -> bool:
        """Whether no design meets the specification."""
        return self.best is None

    @property
    def by_indicative(self) -> bool:
        """Whether the verdict on the first rests on a limit that is from memory."""
        verdict = self.candidates[0].verdict
        return rests_on_indicative(verdict.clauses, verdict.verdict)

    @property
    def heights(self) -> tuple[HeightOfFall, ...]:
        """Heights of free falls that give the velocity change of the ideal pulse, for `RESTITUTIONS`."""
        pulse, friction = self.goal.pulse, or_else(getattr(self.case.machine, "friction", None), 0.0)
        pull = STANDARD_GRAVITY * (1.0 - friction)
        return tuple(
            HeightOfFall(e, drop_for_half_sine(pulse.peak, pulse.duration, e, pull).height) for e in RESTITUTIONS
        )

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

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many designs meet the specification, and the first one."""
        first = self.candidates[0]
        met = sum(candidate.meets for candidate in self.candidates)
        return [
            ("designs that meet it", f"{met} of {len(self.candidates)}"),
            ("programmer", first.programmer.name),
            ("drop height", with_unit(first.height, "m", "mm")),
            ("peak", with_unit(first.reading.peak, "m/s^2", "g")),
            ("pulse width", with_unit(first.reading.width, "s", "ms")),
        ]

    def columns(self) -> list[Column]:
        """Return the candidates, the best first, in SI."""
        rows = [_row(place, one) for place, one in enumerate(self.candidates, 1)]
        left = ("settings", "limits", "clauses", "estimate")
        return columns_of([{k: v for k, v in row.items() if k not in left} for row in rows], UNITS)

    def brief(self) -> dict[str, str]:
        """Return the main settings of each candidate, and its pulse."""
        settings = {"programmer": "", "height": "mm", "diameter": "mm", "thickness": "mm"}
        return {
            "place": "",
            "meets": "",
            **settings,
            "peak": "g",
            "width": "ms",
            "velocity_change": "m/s",
            "run_verdict": "",
        }

    def preview(self) -> Curve:
        """Return the pulse of the first."""
        shock = self.candidates[0].reading.shock
        return history_curve(shock.time, shock.values, "m/s^2", "g", "acceleration of the table")

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file, and the cases of the candidates after the first."""
        return {"settings.json": self.document_text(), **other_cases(len(self.candidates), self.case_of)}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        rows, pulse = [_row(place, one) for place, one in enumerate(self.candidates, 1)], self.goal.pulse
        return {
            "spec": self.goal.specification.document(),
            "goal": {
                "shape": pulse.shape,
                "peak": pulse.peak,
                "duration": pulse.duration,
                "width": self.goal.width,
                "level": self.goal.limits.level,
                "velocity_change": pulse.velocity_change,
                "stroke": self.goal.stroke,
                "within": WITHIN,
            },
            "from": self.case.name,
            "reading": "acceleration of the table less that of the fall: a sensor whose zero is taken before the blow",
            "met": not self.broken,
            "by_indicative_limits": self.by_indicative,
            "best": None if self.broken else rows[0],
            "heights": [one._asdict() for one in self.heights],
            "candidates": rows,
            "failed": list(self.failed),
        }


def _row(place: int, one: DropCandidate) -> dict[str, Any]:
    """Return a candidate as a row of the document."""
    values, blow = one.case.values(), one.reading.blow
    return {
        "place": place,
        "meets": one.meets,
        "obstacles": one.obstacles,
        "verdict": one.verdict.verdict,
        "margin": one.margin,
        "departure": one.departure,
        "programmer": one.programmer.name,
        "law": one.programmer.law,
        "height": one.height,
        "table_mass": one.table_mass,
        "diameter": one.diameter,
        "thickness": None if one.diameter is None else one.thickness,
        "rate": one.rate,
        "restitution": one.restitution,
        "settings": {
            path: {"si": values[path].si, "typed": values[path].typed, "provenance": values[path].provenance}
            for path in one.chosen
        },
        "peak": one.reading.peak,
        "width": one.reading.width,
        "velocity_change": one.velocity_change,
        "misses": one.misses,
        "approach": blow.approach_speed,
        "rigid_peak": blow.rigid_peak,
        "rise": blow.rise,
        "peak_force": blow.peak_force,
        "compression": blow.indentation,
        "clauses": [clause_document(clause) for clause in one.verdict.clauses],
        "limits": [declare.content(limit) for limit in one.limits],
        "estimate": one.estimate._asdict(),
        "runs": one.runs,
        "run_verdict": one.run_verdict,
    }


def goal_words(goal: DropGoal) -> str:
    """Return a goal in words.

    Examples
    --------
    >>> from strikewave.specifications.reading import load_specification
    >>> specification = load_specification("jesd22-b110:B")
    >>> goal_words(DropGoal(specification, specification.pulse_limits(), 2.0))
    'a half-sine of 1500 g and 0.5 ms by jesd22-b110:B'
    """
    peak, duration = with_unit(goal.pulse.peak, "m/s^2", "g"), with_unit(goal.pulse.duration, "s", "ms")
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
    ranked = tuple(sorted(found, key=drop_rank))
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
        highest = study.heights[-1].height
        message = (
            f"{', '.join(lossless)}: nothing is lost, so the height counts on a full rebound; without any rebound the "
            f"same velocity change takes {with_unit(highest, 'm', 'mm')}. Give the restitution of the programmer, such "
            "as --programmer 'linear, restitution=0.5'"
        )
        notices.append(Notice("no-loss", message, min(one.height for one in ranked if one.lossless), highest))
    for name in dict.fromkeys(one.programmer.name for one in ranked if one.programmer.assumed):
        message = f"the law of {name} is assumed, nobody measured it: it stands after those that have a source"
        notices.append(Notice("assumed-law", message))
    if not first.meets:
        message = f"the nearest design misses the goal: {first.obstacles}"
        notices.append(Notice("not-met", message, first.largest_miss, WITHIN))
    return notices
