"""A run of a case as measurements see it: numbers by name, histories by part; and how accurately studies run it."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

from strikewave.analyses.compare.agreement import ComparedCurve
from strikewave.base.datasets import LabelledArrays
from strikewave.base.declare import banded_quantities
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Value
from strikewave.base.result import Verdict
from strikewave.base.shock_quantities import ACCELERATION, PUBLISHED_QUANTITIES
from strikewave.cases.case import Case
from strikewave.cases.tables.common import published_unit
from strikewave.cases.tables.machine import RotaryTable

RUN_TOLERANCE = 1e-7
"""Local error of a step of a full run, over the scales of one contact. Measured on the blows of li-ma-2019: it
changes no peak by more than 1e-8, and takes half the time of 1e-10. Blows that amplify errors stay below 1e-6."""
FINER_TOLERANCE = 1e-8
"""Local error of a second try where a motion cannot be followed: two switches of friction and stop that fell into one
step may then be apart."""
STRESS = ".peak_stress"
"""End of the name of the stress at a tap of a bar."""
BALANCE = {"energy_error": "energy", "momentum_error": "momentum", "hourglass_share": "hourglass"}
"""Numbers of the balances of elements, and what of `strikewave.fem.run.BalanceMeasure` each is."""
OF_MODEL = {
    "first.peak_force": "N", "first.force_width": "s",
    "contact_force_peak": "N", "energy_error": "1", "momentum_error": "1", "hourglass_share": "1",
}  # fmt: skip
OF_BODY = {"first.rigid_peak": "m/s^2", "first.width": "s"}
OF_PART = {"velocity_change": "m/s", "von_mises": "Pa", "plastic_strain": "1"}
"""Numbers of elements, and their SI units: of the first contact and the whole model; of a part or group, whose name
stands behind them; of a part."""


class Simulation:
    """A run of a case: what of it is measured is computed when it is asked for.

    Parameters
    ----------
    case : Case
        Case of a machine, a layered bar, or elements.
    device : str, optional
        Device that computes the steps of elements: see `strikewave.run_fem`.
    """

    def __init__(self, case: Case, device: str | None = None) -> None:
        self.case, self.device = case, device

    @functools.cached_property
    def observed(self) -> Any:
        """The run of a machine as it is looked at: see `strikewave.analyses.machine.observe`."""
        from strikewave.analyses.machine.observe import observe

        return observe(self.case)

    @functools.cached_property
    def bar(self) -> Any:
        """The solution of a layered bar."""
        from strikewave.analyses.wave.run import followed

        return followed(self.case)

    @functools.cached_property
    def elements(self) -> Any:
        """The result of a model of elements."""
        from strikewave.analyses.fem.run import run_fem

        return run_fem(self.case, device=self.device)

    @functools.cached_property
    def verdict(self) -> Verdict:
        """The verdict of the run, by the limits of its analysis."""
        if self.case.command == "run":
            from strikewave.analyses.machine.notices import run_verdict

            return run_verdict(self.case, self.observed.run, self.observed.blows)
        if self.case.command == "wave":
            from strikewave.analyses.wave.notices import momentum_notices

            return Verdict.of(momentum_notices(self.bar.run))
        verdict: Verdict = self.elements.own_verdict
        return verdict

    @functools.cached_property
    def _arrays(self) -> LabelledArrays | None:
        if self.case.command == "run":
            from strikewave.analyses.machine.blow_histories import build_dataset

            return build_dataset(self.case, self.observed)
        if self.case.command == "wave":
            bar: LabelledArrays = self.bar.labelled_histories()
            return bar
        arrays: LabelledArrays | None = self.elements.arrays
        return arrays

    def number(self, name: str, sensor: str = "") -> float | None:
        """Return a number, SI; None where this run has none, such as the width of a blow that missed."""
        if self.case.command == "run":
            from strikewave.analyses.machine.run import published_value

            return published_value(name, self.observed.blows, self.observed.readings, sensor)
        if self.case.command == "fem":
            return self._of_elements(name, sensor)
        return self._of_bar(name)

    def _of_bar(self, name: str) -> float | None:
        """Return a number of a layered bar; a stress is the force over the area of the layer of its tap."""
        figures: Mapping[str, float] = self.bar.figures
        if not name.endswith(STRESS):
            return figures.get(name)
        force = figures.get(f"{name.removesuffix(STRESS)}.peak_force")
        layers = {f"tap.{tap}": place.layer for tap, place in self.bar.taps}
        area = float(self.bar.run.stack.layers[layers[name.removesuffix(STRESS)]].area)
        return None if force is None else force / area

    def _of_elements(self, name: str, body: str) -> float | None:
        """Return a number of a model of elements, or of one of its parts or groups."""
        if name in OF_PART:
            return float(getattr(self.elements.parts[body], name))
        if name.startswith("first."):
            number: float | None = self.elements.number(name, body)
            return number
        if name == "contact_force_peak":
            return float(self.elements.contact_force_peak)
        return float(getattr(self._balance, BALANCE[name]))

    @functools.cached_property
    def _balance(self) -> Any:
        return self.elements.measured_balance

    def history(self, part: str, blow: int = 0, unit: str = "") -> ComparedCurve:
        """Return the history of a part: PART or PART.QUANTITY, the usual one where it is empty."""
        from strikewave.analyses.compare.simulated import arrays_curve

        assert self._arrays is not None
        return arrays_curve("--to", self.case.name, self._arrays, part, blow, unit)


def number_units(case: Case) -> dict[str, str]:
    """Return the names of the numbers that a case gives, with their SI units.

    Examples
    --------
    >>> from strikewave import load_case
    >>> number_units(load_case("li-ma-2019"))["first.width"]
    's'
    """
    if case.command == "run":
        left_out = ("first.force_width", "first.force_over_mass")  # of elements
        return {name: published_unit(name) for name in PUBLISHED_QUANTITIES if name not in left_out}
    if case.command == "wave":
        from strikewave.analyses.wave.result import TapPeaks

        of_tap = banded_quantities(TapPeaks).items()
        units = {f"tap.{tap.name}.{name}": quantity.si for tap in case.tap for name, quantity in of_tap}
        return units | {f"sensor.{sensor.name}.peak": ACCELERATION.si for sensor in case.sensor}
    return OF_MODEL | OF_BODY | OF_PART


def name_and_owner(word: str) -> tuple[str, str]:
    """Return the name of a number, and the sensor or part that stands behind it; empty where none does.

    Examples
    --------
    >>> name_and_owner("first.width bar"), name_and_owner("tap.far end.peak_force")
    (('first.width', 'bar'), ('tap.far end.peak_force', ''))
    """
    typed = word.strip()
    if typed.startswith(("tap.", "sensor.")):  # of a bar: the name of tap or sensor stands within
        return typed, ""
    name, _, owner = typed.partition(" ")
    return name, owner.strip()


def owners(case: Case, name: str) -> list[str] | None:
    """Return what may stand behind a number that is of a sensor, or of a part of elements; None of any other.

    Examples
    --------
    >>> from strikewave import load_case
    >>> owners(load_case("two-bars-fem"), "first.width")
    ['striker', 'bar']
    """
    if "sensor_" in name:
        return [owner.name for owner in case.sensor]
    if case.command == "fem" and name in OF_BODY | OF_PART:
        assert case.mesh is not None
        assert case.fem is not None
        groups = case.fem.group if name in OF_BODY else ()
        return [owner.name for owner in (*case.mesh.part, *groups)]
    return None


def checked_number(case: Case, word: str, option: str = "--to") -> tuple[str, str, str]:
    """Return name, sensor and SI unit of a number that a case gives: ``first.sensor_peak NAME`` is that of a sensor.

    Of elements, ``first.width NAME`` is that of a part.
    """
    name, _ = name_and_owner(word)
    units = number_units(case)
    if name not in units:
        raise InputError(option, name, "a number that the case gives", nearest(name, units))
    return name, checked_owner(case, word, option), units[name]


def checked_owner(case: Case, word: str, option: str = "--to") -> str:
    """Return the sensor or part that stands behind the name of a number; empty where none does."""
    name, sensor = name_and_owner(word)
    of = owners(case, name)
    if of is None and sensor:
        raise InputError(option, word, f"{name} alone", "no name stands there")
    if of is not None and sensor not in of:
        what = "sensor" if "sensor_" in name else "part"
        hint = nearest(sensor or "?", of) if of else f"the case has no {what}"
        raise InputError(option, word, f'"{name} {what.upper()}" with the name of a {what}', hint)
    return sensor


def quick_case(case: Case, blows: int) -> Case:
    """Return a machine case that ends after so many blows (0: all), and runs as accurately as slopes need it."""
    if case.command != "run":
        return case
    changes = {"solver.tolerance": Value(si=FINER_TOLERANCE, typed=FINER_TOLERANCE)}
    if blows and isinstance(case.machine, RotaryTable):
        count = min(float(blows), case.rotary_tables().feed.blows.si)
        changes["feed.blows"] = Value(si=count, typed=int(count))
    return case.with_values(changes)
