"""The numbers that each analysis gives of a case, by the names that fits and published values use; its histories."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from strikewave.analyses.machine.notices import fast_not_judged, fast_verdict, run_verdict
from strikewave.analyses.machine.result import RigidReference, blow_results
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, Quantity, declarations
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import Verdict
from strikewave.base.shock_quantities import PUBLISHED_QUANTITIES, RATIO, VARIATION, usual_unit
from strikewave.cases.case import Case
from strikewave.machines.blows import KINDS, Blow
from strikewave.reporting.columns import Column, Values
from strikewave.reporting.faces import amount, label_of
from strikewave.reporting.numbers import FEWEST_DIGITS, axis_unit, headed
from strikewave.studies.engine.evaluation import KeptHistory, RunOutcome, ordered
from strikewave.studies.simulation import Simulation, checked_owner, name_and_owner, number_units
from strikewave.uncertainty.statistics import variation

if TYPE_CHECKING:
    from strikewave.machines.fast_run import FastTrain

ANALYSES = {
    "run": "a full run of the machine",
    "fast": "the fast run of the machine, its object as whole bodies",
    "wave": "the layered bar under its load",
    "fem": "explicit finite elements",
    "impact": "one impact on a free rigid object, by the contact law alone",
}
"""Analyses that may be computed of a case, in words: its own run, or of a machine the fast run or one impact."""
HISTORIES = ("blows", "pulses")
"""Histories that may be kept: the table of blows; the acceleration of each blow, or of a bar or elements."""
OF_BLOW = {name: one.quantity._replace(label=label_of(name, one)) for name, one in declarations(Blow).items()}
"""Quantities of the numbers of a blow, by name."""
OF_TRAIN = {
    "interval": Quantity("s", "ms", "median interval"),
    "cv": VARIATION._replace(label="coefficient of variation of the peaks"),
    "cv_later": VARIATION._replace(label="coefficient of variation of the peaks, from the second blow"),
    "missed": RATIO._replace(label="missed blows"),
    "largest_displacement": OF_BLOW["largest_displacement"],
    "energy_error": RATIO._replace(label="energy error"),
}
"""Further numbers of a machine's blows."""
OF_FAST = {"stop_force": Quantity("N", "kN", "largest force of the stop")}
"""Numbers that the fast run alone has."""
OF_ANY = {name: PUBLISHED_QUANTITIES[name] for name in ("count", "window")}
"""Numbers of a run that may be published too."""
OF_FIRST = tuple(
    quantity
    for which, _, quantity in (name.partition(".") for name in PUBLISHED_QUANTITIES)
    if which == "first" and quantity in {field.name for field in dataclasses.fields(Blow)}
)
"""Numbers of the first blow that are kept with it; the others are of its waves, of sensors, or of elements."""
OF_CONTACT = ("contact_time", "rebound_speed", "restitution", "indentation", "residual_indentation")
"""Numbers of the contact of the first blow."""
NOT_FAST = ("total_peak", "wave_peak", "sensor_peak", "sensor_width", "peak_force", *OF_CONTACT)
"""Numbers of the first blow that the fast run has not."""
BLOW_UNITS = {
    name: OF_BLOW[name].si or NO_UNIT
    for name in ("time", "rigid_peak", "width", "velocity_change", "approach_speed", "largest_displacement", "kind")
}
"""Columns of the table of blows, with SI units; kinds by their place in `KINDS`."""
PULSE_DIGITS = np.float32
"""Histories are kept to seven digits, beyond the 1e-6 of their balances: packed, they take a third of the room."""
MOST_KEPT = 500
"""Most numbers of a run: a row of SQLite takes two thousand."""


def numbers_of(case: Case, analysis: str) -> dict[str, str]:
    """Return the names of the numbers that an analysis gives of a case, with their SI units.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("li-ma-2019")
    >>> numbers_of(case, "run")["cv"], "first.wave_peak" in numbers_of(case, "fast")
    ('1', False)
    """
    if analysis == "impact":
        return {name: declared.quantity.si for name, declared in declarations(RigidReference).items()}
    units = number_units(case)
    if analysis in ("run", "fast"):
        of_train = OF_TRAIN | (OF_FAST if analysis == "fast" else {})
        units |= {"typical.velocity_change": OF_BLOW["velocity_change"].si} | {
            name: declared.si for name, declared in of_train.items()
        }
    left_out = NOT_FAST if analysis == "fast" else ()
    return {name: unit for name, unit in units.items() if name.partition(".")[2] not in left_out}


def checked_analysis(case: Case, analysis: str) -> str:
    """Return the analysis, that of the case where none is named."""
    own = case.command
    name = analysis or own
    if name not in ANALYSES:
        raise InputError("--analysis", name, "one of " + ", ".join(ANALYSES), nearest(name, ANALYSES))
    if name in ("fast", "impact"):
        if own != "run" or (name == "fast" and case.launched() is not None):
            what = "a rotary machine" if name == "fast" else "a machine"
            raise InputError("--analysis", name, f"{own}: this case is not that of {what}")
    elif name != own:
        raise InputError("--analysis", name, f"{own}, which this case is for")
    return name


def checked_device(analysis: str, device: str | None, cluster: str | None) -> str | None:
    """Return the device of a study, which is here unless the runs are made on a cluster."""
    if device is not None and analysis != "fem":
        raise InputError("--device", device, "a study of elements", f"leave it out: these runs are {analysis}")
    if device is not None and cluster is None:
        from strikewave.fem.device.devices import device_named

        device_named(device)
    return device


def usual_numbers(case: Case, analysis: str) -> tuple[str, ...]:
    """Return what is kept of a case where nothing is asked for: the first blow, and how equal several blows are."""
    names = numbers_of(case, analysis)
    of_blow = ("first.rigid_peak", "first.width")
    wanted: dict[str, tuple[str, ...]] = {"run": of_blow, "fast": of_blow}
    wanted |= {"impact": ("peak_force", "duration"), "fem": ("first.peak_force",)}
    several = analysis in ("run", "fast") and case.feed is not None and case.feed.blows.si > 1.0
    of_bar = tuple(name for name in names if name.endswith(("peak_force", ".peak")))
    chosen = wanted.get(analysis, of_bar[:2])
    return chosen + (("cv",) if several else ())


@dataclass(frozen=True)
class CaseEvaluation:
    """An analysis of a case, and what is kept of it.

    Attributes
    ----------
    analysis : str
        One of `ANALYSES`.
    names : tuple of str
        Names of the numbers that are kept.
    histories : tuple of str
        Histories that are kept, of `HISTORIES`.
    device : str or None
        Device that computes the steps of elements; None: the processor.
    """

    analysis: str
    names: tuple[str, ...]
    histories: tuple[str, ...] = ()
    device: str | None = None

    @property
    def kept(self) -> tuple[str, ...]:
        """Names of all that is kept."""
        return (*self.names, *self.histories)

    def __call__(self, case: Case) -> RunOutcome:
        """Return what is kept of a case."""
        numbers, histories, verdict = EVALUATED[self.analysis](self, case)
        return RunOutcome(ordered(numbers, self.names), tuple(histories), verdict=verdict.text)

    def not_judged(self, case: Case) -> tuple[str, ...]:
        """Return the checks of a run of a case that this analysis cannot make."""
        return fast_not_judged(case) if self.analysis == "fast" else ()


def read_kept(case: Case, analysis: str, typed: Sequence[str]) -> CaseEvaluation:
    """Return the evaluation that keeps what is named.

    Examples
    --------
    >>> from strikewave import load_case
    >>> read_kept(load_case("li-ma-2019"), "fast", ["cv", "blows"])
    CaseEvaluation(analysis='fast', names=('cv',), histories=('blows',), device=None)
    """
    wanted = tuple(dict.fromkeys(word.strip() for word in typed if word.strip()))
    histories = tuple(word for word in wanted if word in HISTORIES)
    names = tuple(word for word in wanted if word not in HISTORIES) or usual_numbers(case, analysis)
    if len(names) > MOST_KEPT:
        raise InputError("--keep", f"{len(names)} numbers", f"at most {MOST_KEPT}")
    known = numbers_of(case, analysis)
    for name in names:
        if name_and_owner(name)[0] not in known:
            raise InputError("--keep", name, f"a number that {analysis} gives", nearest(name, [*known, *HISTORIES]))
        checked_owner(case, name, "--keep")
    if "blows" in histories and analysis not in ("run", "fast"):
        raise InputError("--keep", "blows", "pulses: only a machine has a table of blows")
    if "pulses" in histories and analysis in ("fast", "impact"):
        raise InputError("--keep", "pulses", "none here: this analysis follows no history", "blows has peak and width")
    return CaseEvaluation(analysis, names, histories)


def unit_of(case: Case, analysis: str, name: str) -> str:
    """Return the SI unit of a number."""
    return numbers_of(case, analysis)[name_and_owner(name)[0]] or "1"


Evaluated = tuple[dict[str, float | None], Sequence[KeptHistory], Verdict]


def _machine(wanted: CaseEvaluation, case: Case) -> Evaluated:
    """Run a machine; its waves and sensors are computed only where something of them is kept."""
    seen = [name for name in wanted.names if any(word in name for word in ("total_peak", "wave_peak", "sensor_"))]
    run: Any
    if seen or "pulses" in wanted.histories:
        simulation = Simulation(case)
        run, train = simulation.observed.run, simulation.observed.blows
    else:
        from strikewave.analyses.machine.build import build_machine
        from strikewave.machines import blows, run_machine

        simulation = None
        run = run_machine(build_machine(case), case.solver.tolerance.si)
        train = blows(run)
    numbers = train_numbers(train) | {"energy_error": run.energy_error}
    if simulation is not None:
        numbers |= {name: simulation.number(*name_and_owner(name)) for name in seen}
    histories = _blow_table(train, wanted)
    if "pulses" in wanted.histories and simulation is not None:
        struck = [blow.index for blow in train if blow.kind != "missed"]
        histories += [_pulse(simulation, number) for number in struck]
    return numbers, histories, run_verdict(case, run, train)


def _fast(wanted: CaseEvaluation, case: Case) -> Evaluated:
    from strikewave.analyses.machine.build import build_machine
    from strikewave.machines.fast_run import fast_train

    run: FastTrain = fast_train(dataclasses.replace(build_machine(case), layered=None))
    train = run.blows
    forces = [blow.stop_force for blow in train if math.isfinite(blow.stop_force)]
    numbers = train_numbers(train) | {"energy_error": run.energy_error, "stop_force": max(forces, default=None)}
    return numbers, _blow_table(train, wanted), fast_verdict(case, run)


def train_numbers(train: Sequence[Any]) -> dict[str, float | None]:
    """Return the numbers of the blows of a run, full or fast, by name.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> numbers = train_numbers(run_case(load_case("jesd22-b111-b")).blows)
    >>> numbers["count"], numbers["missed"], numbers["cv"]
    (1.0, 0.0, nan)
    """
    struck = [blow for blow in train if blow.kind != "missed"]
    peaks = [blow.rigid_peak for blow in struck]
    displacements = [b.largest_displacement for b in train if math.isfinite(b.largest_displacement)]
    numbers: dict[str, float | None] = dict(blow_results(train))
    if struck:
        first = struck[0]
        numbers |= {f"first.{name}": getattr(first, name, None) for name in OF_FIRST}
        numbers["window"] = struck[-1].time - first.time
    return numbers | {
        "count": float(len(struck)),
        "missed": float(len(train) - len(struck)),
        "cv": variation(peaks),
        "cv_later": variation(peaks[1:]),
        "largest_displacement": max(displacements, default=None),
    }


def _blow_table(train: Sequence[Blow | Any], wanted: CaseEvaluation) -> list[KeptHistory]:
    """Return the table of blows as histories along the blows; none where it is not kept."""
    if "blows" not in wanted.histories:
        return []

    def column(name: str) -> list[float]:
        return [KINDS.index(blow.kind) if name == "kind" else getattr(blow, name) for blow in train]

    return [
        KeptHistory(f"blows.{name}", unit, 0, math.nan, math.nan, np.array(column(name), dtype=float))
        for name, unit in BLOW_UNITS.items()
    ]


def _pulse(simulation: Simulation, blow: int = 0) -> KeptHistory:
    """Return the acceleration of the usual part."""
    curve = simulation.history("", blow, "m/s^2")
    history = curve.history
    values = history.values.astype(PULSE_DIGITS).astype(float)
    return KeptHistory("pulse", curve.unit, blow, float(history.start), float(history.step), values)


def _simulated(wanted: CaseEvaluation, case: Case) -> Evaluated:
    """Run a layered bar, or elements."""
    simulation = Simulation(case, wanted.device)
    numbers = {name: simulation.number(*name_and_owner(name)) for name in wanted.names}
    return numbers, [_pulse(simulation)] if "pulses" in wanted.histories else [], simulation.verdict


def _impact(wanted: CaseEvaluation, case: Case) -> Evaluated:
    from strikewave.analyses.machine.build import build_machine
    from strikewave.analyses.machine.run import rigid_reference

    return dict(dataclasses.asdict(rigid_reference(case, build_machine(case)))), [], Verdict.of(())


EVALUATED: Mapping[str, Callable[[CaseEvaluation, Case], Evaluated]] = {
    "run": _machine,
    "fast": _fast,
    "wave": _simulated,
    "fem": _simulated,
    "impact": _impact,
}
"""Functions that make the analyses."""


class KeptNumber(NamedTuple):
    """A number that is kept of each run: its name, and what it measures."""

    name: str
    quantity: Quantity

    @property
    def si(self) -> str:
        """SI unit of the quantity."""
        return self.quantity.si

    @property
    def called(self) -> str:
        """Name of the quantity for a reader."""
        return self.quantity.label

    @property
    def label(self) -> str:
        """Name of the quantity with the unit in which it is shown."""
        return headed(self.called, self.si, self.quantity.usual)

    @property
    def scale(self) -> float:
        """Size of that unit, in SI."""
        return axis_unit(self.si, self.quantity.usual)[0]

    def column(self, values: Values, is_shown: bool = True) -> Column:
        """Return its values in SI as a column of a table."""
        return Column(self.name, values, self.si, "", self.quantity.usual if is_shown else None, self.called)

    def words(self, value: float) -> str:
        """Write a value with its unit."""
        return amount(self.quantity, value)


OF_NUMBER = Quantity.of_data("as the number")


@declare.dataclass
class OfKept:
    """A row on a number that is kept, which its `OF_NUMBER` are measured as."""

    kept: KeptNumber

    @property
    def given_units(self) -> declare.GivenUnits:
        """The quantity that the number measures."""
        return {OF_NUMBER.given_by: self.kept.quantity}


def kept_number(case: Case, analysis: str, name: str) -> KeptNumber:
    """Return a number of an analysis of a case, with its units and what it is called.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("li-ma-2019")
    >>> kept_number(case, "run", "first.width").label, kept_number(case, "run", "interval").label
    ('pulse width at 10 % of the first blow (µs)', 'median interval (ms)')
    >>> kept_number(load_case("two-bars-fem"), "fem", "von_mises bar").called
    'von mises bar'
    """
    which, _, of_blow = name.partition(".")
    si = unit_of(case, analysis, name)
    if which in ("first", "typical") and of_blow in OF_BLOW:
        quantity = OF_BLOW[of_blow]._replace(label=f"{OF_BLOW[of_blow].label} of the {which} blow")
        return KeptNumber(name, quantity._replace(decimals=None, digits=FEWEST_DIGITS))
    other = Quantity(si, usual_unit(si), name.replace(".", " ").replace("_", " "))
    return KeptNumber(name, (OF_TRAIN | OF_FAST | OF_ANY).get(name, other))
