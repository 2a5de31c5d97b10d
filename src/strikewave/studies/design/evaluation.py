"""The numbers that goals are about: those of an analysis, and what materials, judges and sensors say of the run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from strikewave.analyses.compare.specified import judged_by
from strikewave.base.materials import material
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import first_yield_of
from strikewave.cases.contact_of_case import cushion_of_contact, struck_material
from strikewave.cases.law_names import CUSHION
from strikewave.specifications.decisions import CANNOT_TELL
from strikewave.specifications.reading import load_specification
from strikewave.studies.engine.case_evaluation import CaseEvaluation
from strikewave.studies.engine.evaluation import RunOutcome
from strikewave.studies.simulation import Simulation, number_units, owners

SPEC, CLIPS, YIELDING, OF_YIELD = "spec:", "clips", "stress", " / yield"
"""Begin of the name of the least margin of a specification; name of the largest reading over the range of its sensor;
name of the largest stress anywhere; and end of the name of a load over that at which its material yields."""
PRESSED, PRESSED_BY = "pressed", "first.indentation"
"""Name of how far the first blow presses the pad of the contact, over its thickness; and of what that follows from."""
VON_MISES = "von_mises"
"""Name of the largest stress of a part of elements."""


def is_derived(name: str) -> bool:
    """Tell whether a number is none of the analysis itself.

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
        Of all numbers, in their order.
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
    """Return the evaluation that gives some numbers, with those that they follow from; on a device, of elements."""
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
    """Return the stress or contact force at which what a number is of first yields, SI; None where it is not known."""
    kind, _, rest = name.partition(".")
    place, _, what = rest.rpartition(".")
    if kind == "tap" and what == "peak_stress":
        layers = [tap.layer for tap in case.tap if tap.name == place]
        return _strength(next((one.material for one in case.stack.layer if one.name in layers), None))
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
    """Return a number that is none of the analysis itself; NaN where the run has none."""
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
    """Return the largest of what a sensor would put out over what it or its recorder can; of all without a name.

    NaN where a reading ends before its pulse does: what comes later may clip.
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
