"""One cell of a map: a machine with some of its settings changed, run fast, and what its blows come to."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.build.machine import build_machine
from strikewave.case import Case, parse_case
from strikewave.errors import InputError, IntegrationError, StrikewaveError
from strikewave.machines import RotaryMachine
from strikewave.machines.quick import QuickRun, quick_run, why_not
from strikewave.quantities import Value
from strikewave.studies.map_regimes import FAILED, IRREGULAR, UNKNOWN, Regime, regime_of
from strikewave.studies.map_return import arrivals
from strikewave.units import in_unit

Array = NDArray[np.float64]

FIELDS = {
    "cv": ("1", "coefficient of variation of the rigid peaks of the machine's own blows; a missed one counts as 0"),
    "cv_later": ("1", "the same from the second blow on"),
    "peak": ("m/s^2", "mean rigid peak of the machine's own blows"),
    "first_peak": ("m/s^2", "rigid peak of the first blow"),
    "missed": ("1", "how many of the machine's own blows missed"),
    "retreat": ("m", "largest retreat of the object"),
    "stop_force": ("N", "largest force of the stop"),
    "train_time": ("s", "from the first to the last of the machine's own blows"),
    "return_ratio": ("1", "time of the return after the last of the own blows, closed form, over the striking period"),
    "bounce_ratio": ("1", "the same until the object is back once more after one bounce"),
    "regime": ("1", "what a longer train settles to, by code"),
    "period": ("1", "its period in blows, 0 where it has none"),
    "reason": ("1", "why there is no result or no regime, by code; 0 where there is"),
}
"""What is kept of a cell: SI unit and meaning."""
PLACE = {name: k for k, name in enumerate(FIELDS)}

REASONS = (
    "",
    "these settings make no machine",
    "on its stop the object is no single body",
    "a striker meets the edge of the face",
    "another striker touches while a blow still rings",
    "the turntable stalls, or the motion could not be followed",
)
"""Why a cell has no result, by code."""
NO_MACHINE, NOT_RIGID, EDGE, CROWDED, LOST = range(1, 6)

REPEATS = 1e-5
"""A train ends early once its blows repeat within this."""


@dataclass(frozen=True)
class Axis:
    """A setting and the values that it takes.

    Attributes
    ----------
    path : str
        Of the case.
    unit, si_unit : str
        In which it is shown, and its SI unit.
    values : tuple of float
        SI, ascending.
    log : bool
        Whether they stand in equal ratios.
    """

    path: str
    unit: str
    si_unit: str
    values: tuple[float, ...]
    log: bool = False

    def typed(self, value: float) -> str | float:
        """Return a value as a case file has it.

        Examples
        --------
        >>> Axis("machine.speed", "rpm", "rad/s", (50.0,)).typed(76.445421237351)
        '730 rpm'
        """
        number = float(f"{self.shown(value):.9g}")
        return f"{number:.9g} {self.unit}" if self.unit else number

    def shown(self, value: Any) -> Any:
        """Return values in the unit in which they are shown."""
        return in_unit(value, self.si_unit, self.unit) if self.unit else value


@dataclass(frozen=True)
class Plan:
    """What a map is of.

    Attributes
    ----------
    case : str
        Text of the case.
    axes : tuple of Axis
        x, y, and panels where there are any.
    blows : int
        The machine's own blows.
    train : int
        Blows of the longer train, half of which is left out; none of it where 0.
    """

    case: str
    axes: tuple[Axis, ...]
    blows: int
    train: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """Panels, rows (y) and columns (x)."""
        sizes = [len(axis.values) for axis in self.axes]
        return (sizes[2] if len(sizes) > 2 else 1, sizes[1], sizes[0])


def case_at(case: Case, axes: tuple[Axis, ...], values: tuple[float, ...]) -> Case:
    """Return a case with the settings of a cell."""
    changes = {
        axis.path: Value(si=value, typed=axis.typed(value), note="chosen by strikewave map")
        for axis, value in zip(axes, values, strict=True)
    }
    return case.with_values(changes)


def machine_of(case: Case) -> RotaryMachine:
    """Return the machine of a case with its object as two bodies on the frame, whatever the case has."""
    machine = build_machine(case)
    if machine.launch is not None:
        raise InputError("machine.kind", case.rig().machine.kind, "rotary", "a map is of a machine that strikes again")
    return dataclasses.replace(machine, layered=None)


def cell_of(case: Case, blows: int, train: int) -> Array:
    """Return what the blows of a case come to, in the order of `FIELDS`; NaN where there is no result.

    Where only the longer train fails, the machine's own blows stand, and the regime is "failed".
    """
    out = np.full(len(FIELDS), np.nan)
    out[PLACE["regime"]], out[PLACE["period"]] = FAILED, 0.0
    try:
        machine = machine_of(case)
    except StrikewaveError:
        out[PLACE["reason"]] = NO_MACHINE
        return out
    if why_not(machine):
        out[PLACE["reason"]] = NOT_RIGID
        return out
    for length in dict.fromkeys((max(blows, train), blows)):
        try:
            run = quick_run(machine, length, repeats=REPEATS if length > blows else 0.0, least=blows)
        except (IntegrationError, ValueError) as error:
            out[PLACE["reason"]] = _reason(str(error))
            continue
        found = measured(run, blows, train if length >= train else 0)
        if length < train:
            found[PLACE["regime"]], found[PLACE["reason"]] = FAILED, out[PLACE["reason"]]
        return found
    return out


def _reason(text: str) -> int:
    """Return the code of a failure told in words."""
    return EDGE if "edge" in text else CROWDED if "another striker" in text else LOST


def measured(run: QuickRun, blows: int, train: int) -> Array:
    """Return what a fast run comes to, in the order of `FIELDS`."""
    machine = run.machine
    missed = np.isnan(run.column("approach_speed"))
    peaks = np.where(missed, 0.0, run.column("rigid_peak"))[:blows]
    times, later = run.column("time")[:blows], peaks[1:]
    leaves = (run.column("face_speed") + run.column("velocity_change"))[:blows][~missed[:blows]]
    back = arrivals(machine.struck, float(leaves[-1])) if leaves.size and leaves[-1] > 0.0 else (np.nan, np.nan)
    period = machine.pitch / machine.turntable.speed
    regime = train_regime(run, missed, train)
    found = {
        "cv": spread(peaks),
        "cv_later": spread(later),
        "peak": peaks.mean(),
        "first_peak": peaks[0],
        "missed": missed[:blows].sum(),
        "retreat": _largest(run.column("retreat")[:blows]),
        "stop_force": _largest(run.column("stop_force")[:blows]),
        "train_time": times[-1] - times[0],
        "return_ratio": back[0] / period,
        "bounce_ratio": back[1] / period,
        "regime": regime.code,
        "period": regime.period,
        "reason": 0,
    }
    return np.array([found[name] for name in FIELDS], dtype=float)


def train_regime(run: QuickRun, missed: NDArray[np.bool_], train: int) -> Regime:
    """Return the regime of the second half of a train, or of its last quarter where only that has settled."""
    if train == 0:
        return Regime(UNKNOWN, 0)
    states = np.column_stack([run.column("approach_speed"), run.column("angle")])
    scales = np.array([run.machine.nominal_approach, abs(run.machine.first_touch)])
    count = len(states)
    regimes = [regime_of(states[k:], missed[k:], scales) for k in (count // 2, count - count // 4)]
    return regimes[1] if regimes[0].code == IRREGULAR and regimes[1].period else regimes[0]


def spread(peaks: Array) -> float:
    """Return the coefficient of variation: standard deviation (n - 1) over mean; NaN of fewer than two or of none.

    Examples
    --------
    >>> round(spread(np.array([1.0, 3.0])), 9)
    0.707106781
    """
    mean = peaks.mean() if peaks.size else 0.0
    return float(peaks.std(ddof=1) / mean) if peaks.size > 1 and mean > 0.0 else float("nan")


def _largest(values: Array) -> float:
    known = values[~np.isnan(values)]
    return float(known.max()) if known.size else float("nan")


_worker: dict[str, Any] = {}


def start_worker(plan: Plan) -> None:
    """Make a process ready for rows of a map."""
    _worker["plan"], _worker["case"] = plan, parse_case(plan.case)


def row_of(row: int) -> Array:
    """Return one row of the map that the worker was made ready for, shape (columns, fields); panels come first."""
    plan, case = _worker["plan"], _worker["case"]
    _, rows, _ = plan.shape
    rest = [plan.axes[1].values[row % rows]]
    if len(plan.axes) > 2:
        rest.append(plan.axes[2].values[row // rows])
    cells = [cell_of(case_at(case, plan.axes, (x, *rest)), plan.blows, plan.train) for x in plan.axes[0].values]
    return np.array(cells)
