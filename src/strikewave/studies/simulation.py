"""What a case gives that can be measured: numbers by name, and histories by part; of any case that is run."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

from strikewave.analyses.compare.curve import ComparedCurve
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Value
from strikewave.base.variables import LabelledArrays
from strikewave.cases.case import Case
from strikewave.cases.tables import PUBLISHED_QUANTITIES, RotaryTable
from strikewave.studies.accuracy import FINER_TOLERANCE

OF_BAR = {
    "peak_force": "N", "peak_stress": "Pa", "peak_velocity": "m/s", "peak_acceleration": "m/s^2", "peak": "m/s^2",
}  # fmt: skip
"""SI unit of a result of a layered bar by the last part of its name."""
OF_CONTACT, OF_BODY = ("first.peak_force", "first.force_width"), ("first.rigid_peak", "first.width")
"""Numbers of elements: of the first contact, and of a part or group."""


class Simulation:
    """A run of a case: what of it is measured is computed when it is asked for.

    Parameters
    ----------
    case : Case
        Of a machine, a layered bar, or elements.
    """

    def __init__(self, case: Case) -> None:
        self.case = case

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

        return run_fem(self.case)

    @functools.cached_property
    def _arrays(self) -> LabelledArrays | None:
        if self.case.command == "run":
            from strikewave.analyses.machine.dataset import build_dataset

            return build_dataset(self.case, self.observed)
        if self.case.command == "wave":
            bar: LabelledArrays = self.bar.histories()
            return bar
        arrays: LabelledArrays | None = self.elements.arrays
        return arrays

    def number(self, name: str, sensor: str = "") -> float | None:
        """Return a number, SI; None where this run has none, such as the width of a blow that missed."""
        if self.case.command == "run":
            from strikewave.analyses.machine.run import published_value

            return published_value(name, self.observed.blows, self.observed.readings, sensor)
        if self.case.command == "fem":
            number: float | None = self.elements.number(name, sensor)
            return number
        figures: Mapping[str, float] = self.bar.figures
        return figures.get(name)

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
        return {name: unit for name, unit in PUBLISHED_QUANTITIES.items() if name not in left_out}
    if case.command == "wave":
        names = [f"tap.{tap.name}.{what}" for tap in case.tap for what in OF_BAR if what != "peak"]
        names += [f"sensor.{sensor.name}.peak" for sensor in case.sensor]
        return {name: OF_BAR[name.rpartition(".")[2]] for name in names}
    return {name: PUBLISHED_QUANTITIES[name] for name in (*OF_CONTACT, *OF_BODY)}


def owners(case: Case, name: str) -> list[str] | None:
    """Return what may stand behind a number that is of a sensor, or of a part of elements; None of any other.

    Examples
    --------
    >>> from strikewave import load_case
    >>> owners(load_case("two-bars-fem"), "first.width")
    ['striker', 'bar']
    """
    if "sensor_" in name:
        return [one.name for one in case.sensor]
    if case.command == "fem" and name in OF_BODY:
        assert case.mesh is not None
        assert case.fem is not None
        return [one.name for one in (*case.mesh.part, *case.fem.group)]
    return None


def checked_number(case: Case, word: str, option: str = "--to") -> tuple[str, str, str]:
    """Return name, sensor and SI unit of a number that a case gives: ``first.sensor_peak NAME`` is that of a sensor.

    Of elements, ``first.width NAME`` is that of a part.

    Raises
    ------
    InputError
        If it gives none of that name.
    """
    name, _, sensor = word.strip().partition(" ")
    units = number_units(case)
    if name not in units:
        raise InputError(option, name, "a number that the case gives", nearest(name, units))
    of = owners(case, name)
    if of is None and sensor:
        raise InputError(option, word, f"{name} alone", "no name stands there")
    if of is not None and sensor.strip() not in of:
        what = "sensor" if "sensor_" in name else "part"
        hint = nearest(sensor.strip() or "?", of) if of else f"the case has no {what}"
        raise InputError(option, word, f'"{name} {what.upper()}" with the name of a {what}', hint)
    return name, sensor.strip(), units[name]


def quick_case(case: Case, blows: int) -> Case:
    """Return a machine case that ends after so many blows (0: all), and runs as accurately as slopes need it."""
    if case.command != "run":
        return case
    changes = {"solver.tolerance": Value(si=FINER_TOLERANCE, typed=FINER_TOLERANCE)}
    if blows and isinstance(case.machine, RotaryTable):
        count = min(float(blows), case.rotary_tables().feed.blows.si)
        changes["feed.blows"] = Value(si=count, typed=int(count))
    return case.with_values(changes)
