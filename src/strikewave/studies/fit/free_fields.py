"""The fields of a case that a fit may change: bounds, scales of the search, and steps of waves through layers."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Provenance, Range, Value
from strikewave.cases.case import Case, dump_case, parse_case
from strikewave.cases.plausible import PLAUSIBLE
from strikewave.cases.stack_of_case import build_stack
from strikewave.studies.axes import Axis, units_of
from strikewave.studies.engine.plan import read_ends
from strikewave.studies.simulation import Simulation
from strikewave.uncertainty.draws import allowed_at, range_of
from strikewave.uncertainty.input_ranges import field_of
from strikewave.waves.spectral import is_linear
from strikewave.waves.transit import WaveSetup, wave_setup

Array = NDArray[np.float64]

REACH = 10.0
"""Factor about the value of the case that bounds a field without own bounds: a typed value may be off by a unit's
prefix; a value further away is another machine."""
WIDE = 5.0  # half widths of the plausible range that bound a field of either sign: chosen
ASIDE = ("solver", "recorder", "tap", "mesh", "fem")  # tables on solver and sensors, not on the tested object
OF_ELEMENTS = re.compile(r"mesh\.part\..+\.(?:solid|velocity)\..+|fem\.(?:contact|wall)\..+\.friction")
"""Fields of elements that can be fitted: solids, speeds and friction. A size would change mesh and result in steps."""
MOST = 12  # most free fields: each takes further runs at every start, and data that fix a dozen values are rare


@dataclass(frozen=True)
class FreeField:
    """A field that is fitted.

    Attributes
    ----------
    path : str
        In the case.
    value : Value
        Start of the search.
    allowed : Range
        Range of allowed values.
    low, high : float
        Bounds, SI.
    log : bool
        True if it is searched on a logarithmic scale.
    """

    path: str
    value: Value
    allowed: Range
    low: float
    high: float
    log: bool

    @property
    def axis(self) -> Axis:
        """Axis of the field between its bounds, with its unit."""
        unit, si_unit = units_of(self.path, self.value)
        return Axis(self.path, unit, si_unit, (self.low, self.high), self.log)

    @property
    def width(self) -> float:
        """Width of the bounds on its scale."""
        return math.log(self.high / self.low) if self.log else self.high - self.low

    def place(self, si: float) -> float:
        """Return the place of a value between the bounds, 0 to 1."""
        return (math.log(si / self.low) if self.log else si - self.low) / self.width

    def si(self, place: float) -> float:
        """Return the value at a place."""
        value = self.low * math.exp(place * self.width) if self.log else self.low + place * self.width
        return min(max(value, self.low), self.high)

    def shown(self, si: float, digits: int = 5) -> str:
        """Return a value in the unit in which the field was typed, or in the one that was chosen."""
        return self.axis.words(si, digits)

    def between(self, low: float, high: float) -> str:
        """Return the ends of an interval, as `shown` does."""
        return f"{self.axis.shown(low):.5g} to {self.shown(high)}"

    def error(self, si: float, of_place: float) -> float:
        """Return the standard error of a value whose place has this one."""
        return of_place * self.width * (abs(si) if self.log else 1.0)

    def with_si(self, si: float, provenance: Provenance = "fitted", note: str = "") -> Value:
        """Return a value of the field."""
        return Value(si=si, typed=self.axis.typed(si), provenance=provenance, note=note)


def free_fields(case: Case, words: Sequence[str]) -> tuple[FreeField, ...]:
    """Return the free fields, each ``path`` or ``path=low..high``; those marked as fitted where none is named."""
    named = list(words) or case.fitted_fields()
    if not named:
        example = "such as --free contact.restitution"
        raise InputError("--free", "none", "one field of the case or more: none of it is marked as fitted", example)
    fields = [_free_field(case, word) for word in named]
    paths = [field.path for field in fields]
    double = next((path for path in paths if paths.count(path) > 1), None)
    if double is not None:
        raise InputError("--free", double, "each field once")
    if len(fields) > MOST:
        raise InputError("--free", f"{len(fields)} fields", f"at most {MOST}")
    return tuple(fields)


def _free_field(case: Case, word: str) -> FreeField:
    path, equals, ends = (part.strip() for part in word.partition("="))
    values = case.values()
    if path not in values:
        if allowed_at(case, path) is not None and _has_table(case, path):
            hint = f"give it a start: --set {path}=VALUE"
            raise InputError("--free", path, "a quantity that the case states: the search begins there", hint)
        choice = "" if path not in case.entries() else "; a choice is tried by --try"
        raise InputError("--free", path, f"a quantity of the case{choice}", nearest(path, values))
    value, allowed = values[path], range_of(case, path)
    if path.partition(".")[0] in ASIDE and not OF_ELEMENTS.fullmatch(path):
        raise InputError("--free", path, f"a quantity of what was tested: [{path.partition('.')[0]}] is none")
    if allowed.unit == "count":
        raise InputError("--free", path, "a quantity that may be any number: this one is counted", "try it by --set")
    if equals:
        low, high = _typed_bounds(case, path, ends)
    else:
        low, high = _bounds(case, path, value, allowed)
    if not low < high:
        raise InputError("--free", word, "bounds of which the first is the smaller one", f"{path}=LOW..HIGH")
    if not low <= value.si <= high:
        words = f"bounds that hold the value of the case, {value.typed}"
        raise InputError("--free", word, words, f"or begin elsewhere: --set {path}=VALUE")
    return FreeField(path, value, allowed, low, high, low > 0.0 and _is_scale(case, path))


def _typed_bounds(case: Case, path: str, ends: str) -> tuple[float, float]:
    """Return bounds that were typed."""
    found = read_ends(case, path, ends)
    if found is None:
        hint = f'such as {path}="LOW..HIGH", with units'
        raise InputError("--free", f"{path}={ends}", "PATH or PATH=LOW..HIGH", hint)
    low, high = (end.si for end in found)
    return low, high


def _has_table(case: Case, path: str) -> bool:
    """Tell whether the case has the table of a field: a layer of another name is none of its own."""
    table = path.rpartition(".")[0]
    return "." not in table or any(entry.startswith(f"{table}.") for entry in case.entries())


def _is_scale(case: Case, path: str) -> bool:
    """Tell whether factors of a field count, not differences: shares and widths are no scales."""
    plausible, allowed = PLAUSIBLE.get(field_of(case, path)), range_of(case, path)
    share = allowed.low == 0.0 and allowed.high <= 1.0 and allowed.unit == ""
    return not share and (plausible is None or plausible.form != "width")


def _bounds(case: Case, path: str, value: Value, allowed: Range) -> tuple[float, float]:
    """Return bounds of a field without typed ones: a factor for a scale, else all that is allowed, or some widths."""
    if _is_scale(case, path) and value.si != 0.0:
        low, high = sorted((value.si / REACH, value.si * REACH))
    elif math.isfinite(allowed.low) and math.isfinite(allowed.high) and allowed.unit == "":
        low, high = allowed.low, allowed.high
    else:
        plausible = PLAUSIBLE.get(field_of(case, path))
        if plausible is None or plausible.form != "width":
            hint = f"state bounds, {path}=LOW..HIGH, or begin elsewhere than at 0: --set {path}=VALUE"
            raise InputError("--free", path, "a field whose bounds are known", hint)
        low, high = value.si - WIDE * plausible.size, value.si + WIDE * plausible.size
    low, high = max(low, allowed.low), min(high, allowed.high)
    if allowed.open_low and low == allowed.low:
        low = float(np.nextafter(low, high))
    return low, high


def case_at(case: Case, fields: Sequence[FreeField], place: Array) -> Case:
    """Return a case with its free fields at a place of the unit cube."""
    return case.with_values(
        {
            field.path: field.value.model_copy(update={"si": field.si(float(at)), "note": ""})
            for field, at in zip(fields, place, strict=True)
        }
    )


def changed_case(case: Case, changes: Sequence[str]) -> Case:
    """Return a case with some of its fields changed, each ``path=value``."""
    return parse_case(dump_case(case), case.name, changes) if changes else case


OF_TRANSIT = re.compile(r"stack\.layer\.(.+)\.(length|density|modulus)")
"""Fields that change a transit, and the layer that each is of."""


def smooth_case(case: Case, paths: Sequence[str]) -> Case:
    """Return a case whose run follows these fields smoothly: a linear bar is solved by its spectrum."""
    if case.command != "wave" or case.solver.method != "auto" or not any(map(OF_TRANSIT.fullmatch, paths)):
        return case
    from strikewave.analyses.wave.build import build_load

    stack = build_stack(case)
    return changed_case(case, ["solver.method=spectral"]) if is_linear(stack, build_load(case, stack)) else case


def stairs(case: Case, paths: Sequence[str]) -> list[float]:
    """Return the step of each field, as a share, that the run of a case feels; 0 where the run follows smoothly.

    With a step that is stated, that is one step of the transit of its layer; else what the chosen one misses of it.
    """
    found = [OF_TRANSIT.fullmatch(path) for path in paths]
    waves = _waves(case) if any(found) else None
    return [0.0 if one is None or waves is None else _stair(case, waves, one[1], one[2]) for one in found]


def _stair(case: Case, waves: WaveSetup, name: str, field: str) -> float:
    """Return the step of a field of a layer that delay lines feel, as a share."""
    layer = next(one for one in waves.layers if one.name == name)
    if not layer.steps:  # by its spectrum
        return 0.0
    share = 1.0 / layer.steps if case.solver.step else 2.0 * waves.mismatch
    return share * (1.0 if field == "length" else 2.0)  # the transit goes with their square root


def _waves(case: Case) -> WaveSetup | None:
    """Return how the stack of a case is followed; None where it has none."""
    if case.command == "wave":
        waves: WaveSetup = Simulation(case).bar.waves
        return waves
    from strikewave.analyses.machine.build import build_machine

    layered = build_machine(case).layered if case.command == "run" else None
    return wave_setup(layered.stack, layered.grid) if layered is not None else None
