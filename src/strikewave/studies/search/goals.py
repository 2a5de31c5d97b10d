"""Goals in words of the results, how far a number lies inside them, and the numbers that they are about.

``first.rigid_peak = 4000 g +- 5 %``, ``first.width = 180..220 us``, ``cv < 3 %``, ``first.peak_force < 0.8 yield``,
``spec:mil-std-810h passes``, ``sensor clips never``; ``stop_force smallest`` is no goal but an objective. Their numbers
are those of an analysis, and what materials, judges and sensors say of the run.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import judged_by
from strikewave.base import declare
from strikewave.base.constants import material
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range
from strikewave.base.units import DIMENSIONS, range_ends, typed_number
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import first_yield_of
from strikewave.cases.contact_of_case import cushion_of_contact, struck_material
from strikewave.cases.tables.contact import CUSHION
from strikewave.contact.cushions import LARGEST_STRAIN
from strikewave.specifications.judging import CANNOT_TELL
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.case_evaluation import (
    CaseEvaluation,
    KeptNumber,
    kept_number,
    numbers_of,
    read_kept,
    unit_of,
)
from strikewave.studies.engine.evaluation import RunOutcome
from strikewave.studies.fit.targets import PLUS_MINUS
from strikewave.studies.simulation import Simulation, number_units, owners

Array = NDArray[np.float64]

EXAMPLES = 'such as "first.rigid_peak = 4000 g +- 5 %", "cv < 3 %", "sensor clips never" or "cv smallest"'
WHOLE = ("count", "missed")  # numbers that are whole: they alone may be asked for exactly
FULL_RUN = ("run", "wave")  # analyses that follow the history that a specification judges and a sensor reads
SENSES = {"smallest": 1.0, "largest": -1.0}
_RELATION = re.compile(r"(?P<number>[^<>=]+?)\s*(?P<relation><=|>=|<|>|=)\s*(?P<value>[^<>=]+)")
_PASSES = re.compile(r"spec:(?P<name>\S+)\s+passes")
_CLIPS = re.compile(r"(?P<sensor>\S.*?)\s+clips\s+never")
_SENSE = re.compile(r"(?P<number>[^<>=]+?)\s+(?P<sense>smallest|largest)")
SPEC, CLIPS, YIELDING, OF_YIELD = "spec:", "clips", "stress", " / yield"
"""Begin of the name of the least margin of a specification; name of the largest reading over the range of its sensor;
name of the largest stress anywhere; and end of the name of a load over that at which its material yields."""
PRESSED, PRESSED_BY = "pressed", "first.indentation"
"""Name of how far the first blow presses the pad of the contact, over its thickness; and of what that follows from."""
VON_MISES = "von_mises"  # name of the largest stress of a part of elements
DERIVED = Quantity(NO_UNIT, "%", decimals=2, digits=0)
"""Quantity of a number that goals alone have: a share of a yield strength, of a range, or a least margin."""


@declare.dataclass
class Goal:
    """Limits of a number of a run.

    Attributes
    ----------
    is_check : bool
        True if it is a check of the run, which passes or does not: its margin limits no setting that passes.
    """

    typed: str = declare.word("as typed", key="goal")
    number: str = declare.word("number that it is of")
    low: float = declare.word("low limit, SI; infinite where there is none")
    high: float = declare.word("high limit, SI")
    is_check: bool = False

    @property
    def scale(self) -> float:
        """Unit of margins: half the distance of the limits, or the one limit; 1 where that is 0."""
        half = 0.5 * (self.high - self.low)
        limit = self.high if math.isfinite(self.high) else self.low
        return half if math.isfinite(half) else abs(limit) or 1.0

    def share(self, values: Array) -> Array:
        """Return the margins of values: the distance to the nearer limit over `scale`, below 0 outside.

        Clauses of specifications have the same margins. It is NaN without the number, and infinite for a passed check.
        """
        margins = np.asarray(np.minimum(values - self.low, self.high - values) / self.scale)
        return np.where(margins > 0.0, math.inf, margins) if self.is_check else margins


class Objective(NamedTuple):
    """A number to be as small (``sign`` 1) or as large (-1) as the goals allow."""

    typed: str
    number: str
    sign: float


Aim = Goal | Objective


def read_aim(case: Case, analysis: str, text: str, field: str = "goals") -> Aim:
    """Read a goal or an objective."""
    typed = " ".join(text.split())
    if found := _PASSES.fullmatch(typed):
        _needs_history(case, analysis, typed, field)
        load_specification(found["name"], field).pulse_limits()
        return Goal(typed, SPEC + found["name"], 0.0, math.inf)
    if found := _CLIPS.fullmatch(typed):
        return _never_clips(case, analysis, typed, found["sensor"], field)
    if found := _SENSE.fullmatch(typed):
        return Objective(typed, _number(case, analysis, found["number"], field), SENSES[found["sense"]])
    found = _RELATION.fullmatch(typed)
    if found is None:
        raise InputError(field, text, "a goal or an objective", EXAMPLES)
    return _limited(case, analysis, typed, found, field)


def checks_of(case: Case, analysis: str) -> tuple[Goal, ...]:
    """Return the checks of a run beside the goals: no pad may be pressed solid."""
    if analysis != "run" or case.contact is None or case.contact.law != CUSHION:
        return ()
    limit = f"{100.0 * LARGEST_STRAIN:g} %"
    return (Goal(f"check cushion-solid: {PRESSED} < {limit}", PRESSED, -math.inf, LARGEST_STRAIN, is_check=True),)


def _needs_history(case: Case, analysis: str, typed: str, field: str) -> None:
    if analysis not in FULL_RUN:
        raise InputError(field, typed, 'analysis = "run" or "wave" beside it', f'"{analysis}" follows no history')


def _never_clips(case: Case, analysis: str, typed: str, sensor: str, field: str) -> Goal:
    _needs_history(case, analysis, typed, field)
    names = [one.name for one in case.sensor]
    if not names or sensor not in ("sensor", *names):
        hint = nearest(sensor, [*names, "sensor"]) if names else "the case has no sensor"
        raise InputError(field, typed, 'the name of a sensor, or "sensor" for all', hint)
    return Goal(typed, CLIPS if sensor == "sensor" else f"{CLIPS} {sensor}", -math.inf, 1.0)


def _number(case: Case, analysis: str, name: str, field: str) -> str:
    """Return the name of a number that the analysis gives of the case."""
    try:
        read_kept(case, analysis, [name])
    except InputError as error:
        raise error.at(field) from None
    return name


def _limited(case: Case, analysis: str, typed: str, found: re.Match[str], field: str) -> Goal:
    """Return the goal of a number with a relation and a value."""
    name, relation, value = (found[key].strip() for key in ("number", "relation", "value"))
    if value.endswith(" yield"):
        return _of_yield(case, analysis, typed, found, field)
    if name == YIELDING:
        raise InputError(field, typed, 'a share of the yield strength, such as "stress < 0.8 yield"')
    known = _number(case, analysis, name, field)
    unit = unit_of(case, analysis, known)
    if relation != "=":
        limit = _read(value, unit, field)
        if limit == 0.0 and unit != "1":
            raise InputError(field, typed, "a limit other than 0: margins are shares of it")
        return Goal(typed, known, *((-math.inf, limit) if relation.startswith("<") else (limit, math.inf)))
    return Goal(typed, known, *_band(value, unit, typed, field, name in WHOLE))


def _of_yield(case: Case, analysis: str, typed: str, found: re.Match[str], field: str) -> Goal:
    """Return the goal of a load or stress as a share of that at which its material yields."""
    name, value = found["number"].strip(), found["value"].strip().removesuffix("yield")
    stresses = stress_names(case)
    if name != YIELDING and yield_of(case, name) is None:
        known = [one for one in (*numbers_of(case, analysis), *stresses) if yield_of(case, one) is not None]
        known += [YIELDING] if stresses else []
        hint = nearest(name, known) if known else "nothing of this case has a yield strength that is known"
        raise InputError(field, name, "a force or stress whose yield is known", hint)
    if name == YIELDING and not stresses:
        raise InputError(field, name, "stresses, which a bar or elements have", "first.peak_force of a machine")
    if not found["relation"].startswith("<"):
        raise InputError(field, typed, f"< or <= of {name}", "what yields is no goal")
    share = _read(value.strip(), "1", field)
    if not share > 0.0:
        raise InputError(field, typed, "a share above 0, such as 0.8 yield")
    return Goal(typed, f"{name}{OF_YIELD}", -math.inf, share)


def _band(value: str, unit: str, typed: str, field: str, whole: bool) -> tuple[float, float]:
    """Return the limits of a value with its tolerance, or of a range."""
    nominal, *tolerance = PLUS_MINUS.split(value, maxsplit=1)
    if tolerance:
        middle, word = _read(nominal, unit, field), tolerance[0].strip()
        half = _read(word, "1", field) * abs(middle) if word.endswith("%") else _read(word, unit, field)
        if not half > 0.0:
            raise InputError(field, typed, "a tolerance above 0, such as +- 5 %")
        return middle - half, middle + half
    between = range_ends(value)
    if between is not None:
        ends = _read(between[0], unit, field), _read(between[1], unit, field)
        if not ends[0] < ends[1]:
            raise InputError(field, typed, "a range whose end lies above its begin")
        return ends
    if whole:
        middle = _read(value, unit, field)
        return middle - 0.5, middle + 0.5
    raise InputError(field, typed, "a value with its tolerance", f'such as "{nominal} +- 5 %", or "low..high"')


def _read(text: str, unit: str, field: str) -> float:
    """Return a value, SI: with its unit, or a bare number or per cent where it has none."""
    word = text.strip()
    is_ratio = unit == "1" or unit not in DIMENSIONS
    if is_ratio:
        number, share = typed_number(word), typed_number(word, "%")
        if number is not None or share is not None:
            return 0.01 * share if number is None and share is not None else float(number or 0.0)
    try:
        return Range(unit).read(word).si
    except InputError as error:
        allowed = "a number without unit, or per cent, such as 0.03 or 3 %" if is_ratio else error.allowed
        raise InputError(field, error.got, allowed, "" if is_ratio else error.hint) from None


def shares_of(goals: Sequence[Goal], names: Sequence[str], numbers: Array) -> Array:
    """Return the margins of runs, shape (runs, goals), from their numbers, shape (runs, names)."""
    columns = [goal.share(numbers[:, names.index(goal.number)]) for goal in goals]
    return np.column_stack(columns) if columns else np.empty((len(numbers), 0))


def is_derived(name: str) -> bool:
    """Tell whether the analysis itself does not give a number.

    Examples
    --------
    >>> [is_derived(name) for name in ("cv", "spec:jesd22-b110:B", "stress / yield", "clips sensor", "pressed")]
    [False, True, True, True, True]
    """
    return name.startswith(SPEC) or name.endswith(OF_YIELD) or name == PRESSED or name.split(" ")[0] == CLIPS


@dataclass(frozen=True)
class DesignEvaluation:
    """An analysis of a case with its numbers, and others that follow from its histories and materials.

    Attributes
    ----------
    analysis : CaseEvaluation
        The analysis; its names are those that are needed.
    names : tuple of str
        Names of all numbers, in their order.
    """

    analysis: CaseEvaluation
    names: tuple[str, ...]

    def __call__(self, case: Case) -> RunOutcome:
        """Return the numbers of a case."""
        simulation = Simulation(case, self.analysis.device)
        numbers, verdict = dict[str, float](), ""
        if self.analysis.names:
            run = self.analysis(case)
            numbers, verdict = dict(zip(self.analysis.names, run.numbers, strict=True)), run.verdict
        for name in self.names:
            if name not in numbers:
                numbers[name] = _derived(name, case, numbers, simulation)
        verdict = verdict or simulation.verdict.text
        return RunOutcome(tuple(numbers[name] for name in self.names), verdict=verdict)


def evaluation_of(case: Case, analysis: str, names: Iterable[str], device: str | None = None) -> DesignEvaluation:
    """Return the evaluation of some numbers, and of those that they follow from; ``device`` takes steps of elements."""
    wanted = tuple(dict.fromkeys(names))
    needed = [name for name in wanted if not is_derived(name)]
    for name in wanted:
        if name.endswith(OF_YIELD):
            load = name.removesuffix(OF_YIELD)
            needed += stress_names(case) if load == YIELDING else [load]
    needed += [PRESSED_BY] if PRESSED in wanted else []
    needed = list(dict.fromkeys(needed))
    evaluation = CaseEvaluation(analysis, tuple(needed), device=device)
    return DesignEvaluation(evaluation, (*needed, *filter(is_derived, wanted)))


def stress_names(case: Case) -> list[str]:
    """Return the names of the stresses that a bar or elements give; a machine has none.

    Examples
    --------
    >>> from strikewave import load_case
    >>> stress_names(load_case("two-bars-fem")), stress_names(load_case("li-ma-2019"))
    (['von_mises striker', 'von_mises bar'], [])
    """
    known = number_units(case)
    if VON_MISES in known:
        return [f"{VON_MISES} {part}" for part in owners(case, VON_MISES) or ()]
    return [name for name in known if name.endswith(".peak_stress")]


def yield_of(case: Case, name: str) -> float | None:
    """Return the stress or contact force at which the material of a number first yields, SI; None where unknown."""
    kind, _, rest = name.partition(".")
    place, _, what = rest.rpartition(".")
    if kind == "tap" and what == "peak_stress":
        layers = [tap.layer for tap in case.tap if tap.name == place]
        return _strength(next((layer.material for layer in case.stack.layer if layer.name in layers), None))
    if name.startswith(f"{VON_MISES} ") and case.mesh is not None:
        part = next((one for one in case.mesh.part if one.name == name.partition(" ")[2]), None)
        own: Any = getattr(getattr(part, "solid", None), "yield_strength", None)
        return _strength(getattr(part, "material", None)) if own is None else float(own.si)
    if name == "first.peak_force" and case.command == "run":
        parts = case.impact()
        found = first_yield_of(parts.striker, parts.contact, struck_material(case))
        return None if found is None else found.load
    return None


def _strength(name: str | None) -> float | None:
    return material(name).yield_strength if name else None


def _derived(name: str, case: Case, numbers: Mapping[str, float], simulation: Simulation) -> float:
    """Return a number that the analysis itself does not give; NaN where the run has none."""
    if name.startswith(SPEC):
        return _least_margin(name.removeprefix(SPEC), case, simulation)
    if name.endswith(OF_YIELD):
        load = name.removesuffix(OF_YIELD)
        loads = stress_names(case) if load == YIELDING else [load]
        shares = [numbers[one] / limit for one in loads if (limit := yield_of(case, one))]
        return float(np.nanmax(shares)) if shares and np.isfinite(shares).any() else math.nan
    if name == PRESSED:
        pad = case.impact().contact
        return numbers[PRESSED_BY] / cushion_of_contact(pad).pad.thickness if pad.law == CUSHION else 0.0
    return _clipping(name.removeprefix(CLIPS).strip(), case, simulation)


def _least_margin(asked: str, case: Case, simulation: Simulation) -> float:
    """Return the least margin of all blows by a specification; NaN where it cannot tell."""
    specification = load_specification(asked)
    limits = specification.pulse_limits()
    struck = [0]
    if case.command == "run":
        struck = [blow.index for blow in simulation.observed.blows if blow.kind != "missed"]
    margins = []
    for blow in struck:
        found = judged_by(specification, simulation.history("", blow, "m/s^2"), None).found
        told = found.verdict != CANNOT_TELL
        margins.append(found.least_margin(limits) if told else math.nan)
    return float(np.min(margins)) if margins else math.nan


def _clipping(sensor: str, case: Case, simulation: Simulation) -> float:
    """Return the largest reading of a sensor over its range or that of its recorder; of all sensors without a name.

    It is NaN where a reading ends before its pulse does: the rest may clip.
    """
    if case.command == "run":
        observed = simulation.observed
        if any(
            pulse.cut and not pulse.clipped and sensor in ("", name)
            for reading in observed.readings
            if reading is not None
            for name, pulse in reading.sensors.items()
        ):
            return math.nan
        pairs = [
            (channel, reading)
            for history in observed.histories
            if history is not None
            for channel, reading in zip(observed.view.channels, history.readings, strict=True)
        ]
    else:
        bar = simulation.bar
        pairs = list(zip(bar.channels, bar.readings, strict=True))
    shares = []
    for channel, reading in pairs:
        if sensor in ("", channel.sensor.name):
            full = channel.recorder.full_scale
            highest = channel.sensor.range if full is None else min(channel.sensor.range, full)
            share = reading.peak_before_clip / highest
            shares.append(max(share, float(np.nextafter(1.0, 2.0))) if reading.clipped else share)
    return float(np.nanmax(shares)) if shares and np.isfinite(shares).any() else math.nan


def kept_or_derived(case: Case, analysis: str, name: str) -> KeptNumber:
    """Return a number with the units in which it is kept and shown."""
    if is_derived(name):
        return KeptNumber(name, DERIVED._replace(label=name.replace(".", " ").replace("_", " ")))
    return kept_number(case, analysis, name)
