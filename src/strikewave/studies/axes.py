"""Axes of a study: a setting of a case, the values that it takes, the case at some of them; the ticks of its figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from strikewave.base import declare
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Value
from strikewave.base.units import in_unit
from strikewave.cases.case import FORM, Case
from strikewave.reporting.numbers import headed, shown_unit, spelled

HALF_TO_TWICE = (0.5, 2.0)
"""Ends of an axis over the value of the case where no range is given, and of the range in which an assumed value is in
doubt. Chosen: a factor of two either way, the least that changes what a machine does."""
TYPED_DIGITS = 9
"""Significant digits of a value that a case is given: an axis of a thousand points is told apart by them, and the value
that was typed comes back."""


@declare.dataclass
class Axis:
    """A setting and the values that it takes, ascending.

    Attributes
    ----------
    unit, si_unit : str
        In which it was typed, and is shown where no other was chosen; and its SI unit.
    """

    path: str = declare.word("path of the setting: x, y, panels")
    unit: str
    si_unit: str
    values: tuple[float, ...] = declare.word("its values, SI")
    log: bool = declare.word("whether they are spaced by the logarithm", default=False)

    def typed(self, value: float) -> str | float:
        """Return a value as a case file has it.

        Examples
        --------
        >>> Axis("machine.speed", "rpm", "rad/s", (50.0,)).typed(76.445421237351)
        '730 rpm'
        """
        number = float(f"{in_unit(value, self.si_unit, self.unit) if self.unit else value:.{TYPED_DIGITS}g}")
        return f"{number:.{TYPED_DIGITS}g} {self.unit}" if self.unit else number

    def shown(self, value: Any) -> Any:
        """Return values in the unit in which they are shown."""
        return in_unit(value, self.si_unit, shown_unit(self.si_unit, self.unit)) if self.unit else value

    def words(self, value: float, digits: int = 5) -> str:
        """Return a value with the unit in which it is shown."""
        return f"{self.shown(value):.{digits}g} {self.shown_unit}".strip()

    @property
    def shown_unit(self) -> str:
        """Unit in which `shown` gives them, as print spells it; empty where there is none.

        Examples
        --------
        >>> from strikewave.reporting.numbers import ShownUnits, showing
        >>> with showing(ShownUnits.read("rad/s")):
        ...     Axis("machine.speed", "rpm", "rad/s", (50.0,)).shown_unit
        'rad/s'
        """
        return spelled(shown_unit(self.si_unit, self.unit)) if self.unit else ""

    @property
    def label(self) -> str:
        """Name, such as speed of the machine, with the unit in which it is shown.

        Examples
        --------
        >>> Axis("machine.speed", "rpm", "rad/s", (50.0,)).label
        'speed of the machine (rpm)'
        """
        table, _, key = self.path.partition(".")
        name = f"{key.replace('_', ' ').replace('.', ' ')} of the {table}"
        return headed(name, self.si_unit, self.unit) if self.unit else f"{name} (1)"


def axis_of(case: Case, path: str, ends: tuple[Value, Value] | None, points: int, log: bool) -> Axis:
    """Return an axis: a quantity of the case from one value to another, `HALF_TO_TWICE` where none are given."""
    values = case.values()
    if path not in values:
        raise InputError(path, path, "a quantity of the case", nearest(path, values))
    if ends is None:
        low, high = (values[path].model_copy(update={"si": share * values[path].si}) for share in HALF_TO_TWICE)
        ends = low, high
    return range_axis(path, ends, points, log)


def range_axis(path: str, ends: tuple[Value, Value], points: int, log: bool) -> Axis:
    """Return an axis from one value to another, in the unit in which the first was typed.

    Examples
    --------
    >>> range_axis("machine.strikers", (Value(si=2.0, typed=2), Value(si=4.0, typed=4)), 3, False).values
    (2.0, 3.0, 4.0)
    """
    unit, si_unit = units_of(path, ends[0])
    low, high = (end.si for end in ends)
    if not low < high:
        raise InputError(
            path, f"{low:g} to {high:g}", "a range whose end lies above its begin, SI", "such as 400..1000 rpm"
        )
    if log and low <= 0.0:
        raise InputError(path, low, "a range above zero on a logarithmic axis")
    steps = np.geomspace(low, high, points) if log else np.linspace(low, high, points)
    return Axis(path, unit, si_unit, tuple(float(step) for step in steps), log)


def units_of(path: str, value: Value) -> tuple[str, str]:
    """Return the unit in which a quantity of a case was typed, and its SI unit."""
    allowed = FORM.range_at(path.split("."))
    si_unit = "" if allowed is None or allowed.unit == "count" else allowed.unit
    return value.typed_unit or si_unit, si_unit


def case_at(
    case: Case, axes: Sequence[Axis], values: Sequence[float], note: str, keep_tolerances: bool = False
) -> Case:
    """Return a case at a value (SI) of each axis.

    Parameters
    ----------
    case : Case
        Case that the axes belong to.
    axes : sequence of Axis
        Axes that are changed.
    values : sequence of float
        One an axis, SI.
    note : str
        Note that names the study that chose them: it stands beside each value.
    keep_tolerances : bool, optional
        True if the values keep the tolerances that the case has; a run needs none.

    Examples
    --------
    >>> from strikewave.cases.case import load_case
    >>> speed = Axis("machine.speed", "rpm", "rad/s", (50.0, 100.0))
    >>> case_at(load_case("li-ma-2019"), [speed], [76.445421237351], "by hand").machine.speed.typed
    '730 rpm'
    """
    changes = {
        axis.path: Value(si=value, typed=axis.typed(value), note=note) for axis, value in zip(axes, values, strict=True)
    }
    return case.with_values(changes, keep_tolerances)


def plain_log_ticks(axis: Any) -> None:
    """Write 1, 2, 5, 10 along a logarithmic axis: as plain numbers they are read at a glance, powers are not.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot()
    >>> axes.set_xscale("log")
    >>> plain_log_ticks(axes.xaxis)
    >>> axes.xaxis.get_major_formatter()(2000.0)
    '2000'
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())
