"""One cell of a map: a machine run fast, what its blows come to, and the regime that its train settles to."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import fast_verdict
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.errors import InputError, IntegrationError, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import RUN_FAILED, Verdict
from strikewave.base.shock_quantities import LENGTH, RATIO, TOTAL_PEAK, VARIATION
from strikewave.cases.case import Case, dump_case
from strikewave.machines import Machine, StruckObject
from strikewave.machines.fast_run import FastTrain, fast_train, why_not
from strikewave.studies.axes import Axis
from strikewave.studies.engine.evaluation import RunOutcome
from strikewave.studies.engine.plan import StudyPlan
from strikewave.studies.search.rotary_estimates import Support, return_arc
from strikewave.studies.simulation import RUN_TOLERANCE
from strikewave.uncertainty.statistics import variation

Array = NDArray[np.float64]

TOLERANCE = 1e-3
"""Blows are alike within this share of the scale of each of their quantities: above what the fast run errs by (3e-4 of
the approach speed, docs/map.md), far below what tolerances do to a blow."""
CYCLES = 3
"""Times that a period must be seen: twice may be chance."""
LONGEST_PERIOD = 10
"""Longest period that is distinguished from irregular motion: the second half of a train of 60 blows holds it `CYCLES`
times."""

NAMES = ("period-1", "period-2", "period-n", "irregular", "misses", "no return", "failed", "unknown")
"""Regimes by their code."""
PERIOD_1, PERIOD_2, PERIOD_N, IRREGULAR, MISSES, NO_RETURN, FAILED, UNKNOWN = range(8)
"""Codes of the regimes."""


class Regime(NamedTuple):
    """A regime by its code (see `NAMES`), and its period in blows, 0 where it has none."""

    code: int
    period: int

    @property
    def name(self) -> str:
        """In words; a longer period with its number."""
        return f"period-{self.period}" if self.code == PERIOD_N else NAMES[self.code]


def period_of(states: Array, scales: Array, turn: int = 1, tolerance: float = TOLERANCE) -> int:
    """Return the shortest period of a sequence, 0 where it has none that is seen `CYCLES` times.

    Periods up to `LONGEST_PERIOD` are tried, and that of a turn.

    Parameters
    ----------
    states : ndarray
        Sections of the motion, shape (N, quantities).
    scales : ndarray
        Scale of each quantity, of which ``tolerance`` is a share.
    turn : int, optional
        Blows of a turn.
    tolerance : float, optional
        Largest difference of alike states.

    Examples
    --------
    >>> period_of(np.array([[1.0], [2.0]] * 6), np.array([1.0]))
    2
    """
    count = len(states)
    for period in sorted({*range(1, LONGEST_PERIOD + 1), turn}):
        if period * CYCLES > count:
            break
        apart = np.abs(states[period:] - states[:-period]) / scales
        if np.all(apart <= tolerance):
            return period
    return 0


def regime_of(
    states: Array, missed: NDArray[np.bool_], scales: Array, turn: int = 1, tolerance: float = TOLERANCE
) -> Regime:
    """Name what a train has settled to, from the passes after its transient.

    Parameters
    ----------
    states : ndarray
        Approach speed and angle of each pass, shape (N, quantities); not looked at where missed.
    missed : ndarray
        True if the pass touched nothing.
    scales : ndarray
        Scale of each quantity.
    turn : int, optional
        Strikers of a turn where they differ from one another: the blows can repeat after a whole turn at best.
    tolerance : float, optional
        See `period_of`.

    Returns
    -------
    Regime
        "no return" where every pass missed, "misses" where some did, else the period, or irregular.
        Fewer than `CYCLES` passes, or turns without a period, are unknown.

    Examples
    --------
    >>> regime_of(np.ones((9, 1)), np.zeros(9, dtype=bool), np.ones(1)).name
    'period-1'
    """
    if len(states) < CYCLES:
        return Regime(UNKNOWN, 0)
    if missed.all():
        return Regime(NO_RETURN, 0)
    if missed.any():
        return Regime(MISSES, 0)
    period = period_of(states, scales, turn, tolerance)
    if not period and turn * CYCLES > len(states):
        return Regime(UNKNOWN, 0)
    code = {0: IRREGULAR, 1: PERIOD_1, 2: PERIOD_2}.get(period, PERIOD_N)
    return Regime(code, period)


MEAN_PEAK = Quantity("m/s^2", "g")


@declare.dataclass
class MapCell:
    """The numbers of a cell, or of all cells as arrays; NaN where there is nothing."""

    cv: float = declare.number(
        VARIATION._replace(label="CV of the peaks"),
        "coefficient of variation of the rigid peaks of the machine's own blows; missed ones are left out",
        column=MAIN,
    )
    cv_later: float = declare.number(
        VARIATION._replace(label="CV from 2nd blow"), "the same without the first blow", column=MAIN
    )
    peak: float = declare.number(
        TOTAL_PEAK._replace(label="mean rigid peak"),
        "mean rigid peak of the machine's own blows; missed ones are left out",
        column=MAIN,
    )
    first_peak: float = declare.number(
        TOTAL_PEAK._replace(label="rigid peak of the first blow"), "rigid peak of the first blow"
    )
    missed: float = declare.number(
        RATIO._replace(label="missed blows"),
        "how many of the machine's own blows missed, or did not come before feed.hold was over",
        column=MAIN,
    )
    largest_displacement: float = declare.number(
        LENGTH._replace(digits=5), "largest displacement (rearward) of the object", column=MAIN
    )
    stop_force: float = declare.number(
        Quantity("N", "kN", "largest force of the stop", digits=5), "largest force of the stop", column=MAIN
    )
    train_time: float = declare.number(
        Quantity("s", "ms", "first to last blow", digits=5),
        "from the first to the last of the machine's own blows",
        column=MAIN,
    )
    return_ratio: float = declare.number(
        RATIO, "time of the return after the last of the own blows, closed form, over the striking period"
    )
    bounce_ratio: float = declare.number(RATIO, "the same until the object is back once more after one bounce")
    regime: float = declare.number(RATIO, "what a longer train settles to, by code")
    period: float = declare.number(RATIO, "its period in blows, 0 where it has none")
    reason: float = declare.number(RATIO, "why there is no result or no regime, by code; 0 where there is")


FIELDS = tuple(declare.declarations(MapCell))
"""Names of what is kept of a cell, in their order."""


@declare.dataclass
class FullRun:
    """The result of a full run at a setting of the map."""

    cv: float = declare.number(VARIATION, "coefficient of variation in a full run there")
    peak: float = declare.number(MEAN_PEAK, "mean rigid peak in it")
    tolerance: float = declare.number(RATIO, "tolerance of the integrator in it", default=RUN_TOLERANCE)


@declare.dataclass
class EvenSetting:
    """A setting of the map with equal blows, and what it costs.

    Its distance is the root of the summed squares of the steps from the case, each over its scale (the value of the
    case, or the range of the axis where that is 0).
    """

    settings: dict[str, float] = declare.word("nearest setting with equal blows, SI; null where there is none")
    distance: float = declare.number(RATIO, "how far it is, in steps over their scales")
    cell: dict[str, float] = declare.part(MapCell, "what the map has of it", key="result")
    full_run: FullRun = declare.part(FullRun, "what the same blows come to in a full run")

    @property
    def values(self) -> tuple[float, ...]:
        """The values along the axes, SI."""
        return tuple(self.settings.values())


@declare.dataclass
class Refusal:
    """An even setting of the map that its full run refutes."""

    setting: str = declare.word("what it is", column=KEY, in_document=False)
    settings: dict[str, float] = declare.word("nearer setting that a full run did not confirm, SI")
    why: str = declare.word("why", column=MAIN)


@declare.dataclass
class SettingOfCase:
    """The place of the case along an axis."""

    value: float = declare.word("setting of the case, SI")
    provenance: str = declare.word("where it comes from")


@declare.dataclass
class Present:
    """The place of the case, and the result of its blows."""

    settings: dict[str, SettingOfCase] = declare.named(SettingOfCase, "settings of the case", inline=True)
    result: dict[str, float] = declare.part(MapCell, "what its blows come to")


@declare.dataclass
class NearestSetting:
    """A value of the nearest setting with equal blows, as it is shown."""

    name: str = declare.word("path of the setting")
    text: str = declare.word("its value", headline="{name}, nearest with equal blows")


PLACE = {name: k for k, name in enumerate(FIELDS)}
"""Place of each field in a cell."""
NOTE = "chosen by strikewave map"
"""Note in a case of a value that a map has changed."""

REASONS = (
    "",
    "these settings make no machine",
    "on its stop the object is no single body",
    "a striker meets the edge of the face",
    "another striker touches while a blow still rings",
    "the turntable stalls, or the motion could not be followed",
    "the train is too short to tell: it must last six turns of strikers that differ",
)
"""Reasons why a cell has no result, by code."""
NO_MACHINE, NOT_RIGID, EDGE, CROWDED, LOST, SHORT = range(1, 7)
"""Codes of the reasons but the first, which stands for none."""

REPEATS = 1e-5
"""A train ends early once its blows repeat within this, a hundredth of what a regime calls alike. Measured on
li-ma-2019: sixty blows end after 44, and the peak that is then repeated is within 3e-5 of the sixtieth."""
HALF, QUARTER = 2, 4
"""A train is looked at in its second half, the first being its transient; where that has no period, in its last
quarter, which may have settled later."""


@dataclass(frozen=True)
class CellEvaluation:
    """The numbers of a cell, of so many blows of the machine, and of the train that names its regime."""

    blows: int
    train: int

    @property
    def names(self) -> tuple[str, ...]:
        """The fields of a cell."""
        return FIELDS

    def __call__(self, case: Case) -> RunOutcome:
        """Return what the blows of a case come to: a cell without a result has its reason as a number."""
        cell, verdict = judged_cell(case, self.blows, self.train)
        return RunOutcome(tuple(cell.tolist()), verdict=verdict.text)


@dataclass(frozen=True, kw_only=True)
class MapPlan(StudyPlan):
    """Cells of a map, x fastest, then y, then panels.

    Attributes
    ----------
    axes : tuple of Axis
        x, y, and panels where there are any.
    """

    noun: ClassVar[str] = "cells"

    axes: tuple[Axis, ...]
    evaluation: CellEvaluation

    @property
    def shape(self) -> tuple[int, int, int]:
        """Panels, rows (y) and columns (x)."""
        sizes = [len(axis.values) for axis in self.axes]
        return (sizes[2] if len(sizes) > 2 else 1, sizes[1], sizes[0])

    @property
    def blows(self) -> int:
        """Blows of the machine in each cell."""
        return self.evaluation.blows

    @property
    def train(self) -> int:
        """Blows of the longer train that names the regime."""
        return self.evaluation.train

    def marked_text(self, wanted: float) -> str:
        """Return the case as text, and above it what was asked: other axes are another result."""
        sizes = " x ".join(f"{len(axis.values)} {axis.path}" for axis in self.axes)
        asked = f"map of {sizes}, {self.blows} blows, trains of {self.train}, CV within {100.0 * wanted:g} %"
        axes = tuple(dataclasses.astuple(axis) for axis in self.axes)
        return self.marked(asked, ((dump_case(self.case), axes, self.blows, self.train), wanted))


def machine_of(case: Case) -> Machine:
    """Return the machine of a case with its object as two bodies on the frame, whatever the case has."""
    machine = build_machine(case)
    if machine.launch is not None:
        raise InputError(
            "machine.kind", case.rotary_tables().machine.kind, "rotary", "a map is of a machine that strikes again"
        )
    return dataclasses.replace(machine, layered=None)


def cell_of(case: Case, blows: int, train: int) -> Array:
    """Return what the blows of a case come to; see `judged_cell`."""
    return judged_cell(case, blows, train)[0]


def judged_cell(case: Case, blows: int, train: int) -> tuple[Array, Verdict]:
    """Return what the blows of a case come to, in the order of `FIELDS`, and their verdict; NaN where there is nothing.

    Where only the longer train fails, the machine's own blows stand, and the regime is "failed".
    """
    lost = Verdict(RUN_FAILED)
    out = np.full(len(FIELDS), np.nan)
    out[PLACE["regime"]], out[PLACE["period"]] = FAILED, 0.0
    try:
        machine = machine_of(case)
    except StrikewaveError:
        out[PLACE["reason"]] = NO_MACHINE
        return out, lost
    if why_not(machine):
        out[PLACE["reason"]] = NOT_RIGID
        return out, lost
    # one run for both: the train begins with the own blows, which are run alone only where it fails
    for length in dict.fromkeys((max(blows, train), blows)):
        try:
            run = fast_train(machine, length, repeats=REPEATS if length > blows else 0.0, least=blows)
        except (IntegrationError, ValueError) as error:
            out[PLACE["reason"]] = _reason(str(error))
            continue
        cell = measured(run, blows, train if length >= train else 0)
        if length < train:
            cell[PLACE["regime"]], cell[PLACE["reason"]] = FAILED, out[PLACE["reason"]]
        return cell, own_verdict(case, machine, blows)
    return out, lost


def own_verdict(case: Case, machine: Machine, blows: int) -> Verdict:
    """Return the verdict of a fast run with the machine's own feed, so many blows and the retraction, as of any run."""
    wanted = case.with_values({"feed.blows": Value(si=float(blows), typed=blows)})
    try:
        return fast_verdict(wanted, fast_train(machine.with_feed(blows=blows)))
    except (IntegrationError, ValueError):
        return Verdict(RUN_FAILED)


def _reason(text: str) -> int:
    """Return the code of a failure from its message."""
    return EDGE if "edge" in text else CROWDED if "another striker" in text else LOST


def measured(run: FastTrain, blows: int, train: int) -> Array:
    """Return what a fast run comes to, in the order of `FIELDS`."""
    machine = run.machine
    missed = np.isnan(run.column("approach_speed"))
    own = own_blows(run, blows)
    peaks, times, struck = run.column("rigid_peak")[own], run.column("time")[own], ~missed[own]
    leaves = (run.column("face_speed") + run.column("blow_velocity_change"))[own][struck]
    back = arrivals(machine.struck, float(leaves[-1])) if leaves.size and leaves[-1] > 0.0 else (np.nan, np.nan)
    period = machine.pitch / machine.drive.turntable.speed
    regime = train_regime(run, missed, train)
    short = train > 0 and regime.code == UNKNOWN
    fields = {
        "cv": variation(peaks),
        "cv_later": variation(peaks[1:]),
        "peak": peaks[struck].mean() if struck.any() else np.nan,
        "first_peak": peaks[0] if peaks.size else np.nan,
        "missed": blows - struck.sum(),
        "largest_displacement": _largest(run.column("largest_displacement")[own]),
        "stop_force": _largest(run.column("stop_force")[own]),
        "train_time": times[-1] - times[0] if times.size else np.nan,
        "return_ratio": back[0] / period,
        "bounce_ratio": back[1] / period,
        "regime": regime.code,
        "period": regime.period,
        "reason": SHORT if short else 0,
    }
    return np.array([fields[name] for name in FIELDS], dtype=float)


def own_blows(run: FastTrain, blows: int) -> slice:
    """Return which passes of a run are the machine's own: so many at most, and those before its hold is over."""
    feed = run.machine.drive.feed
    return slice(0, min(blows, int(np.sum(run.column("time") <= feed.valve_delay + feed.stroke_time + feed.hold))))


def train_regime(run: FastTrain, missed: NDArray[np.bool_], train: int) -> Regime:
    """Return the regime of the second half of a train, or of its last quarter where only that has settled.

    A train that ended early repeats at its end, so that as many turns as are needed may be looked at there.
    """
    if train == 0:
        return Regime(UNKNOWN, 0)
    states = np.column_stack([run.column("approach_speed"), run.column("angle")])
    scales = np.array([run.machine.nominal_approach, abs(run.machine.drive.first_touch)])
    turn = _turn(run.machine)
    count = len(states)
    half = count // HALF if count >= train else min(count // HALF, max(count - CYCLES * turn, 0))
    regimes = [regime_of(states[k:], missed[k:], scales, turn) for k in (half, count - count // QUARTER)]
    return regimes[1] if regimes[0].code == IRREGULAR and regimes[1].period else regimes[0]


def _turn(machine: Machine) -> int:
    """Return the blows of a turn: the number of strikers where they differ, else one."""
    first, *others = machine.strikers.each
    return machine.strikers.count if any(other != first for other in others) else 1


def _largest(values: Array) -> float:
    known = values[~np.isnan(values)]
    return float(known.max()) if known.size else float("nan")


def bounce_time(struck: StruckObject) -> float:
    """Return how long the object stays on its stop before it is thrown back, s, its preload left out.

    On a linear spring and damper without tension, d = (v/w_d) exp(-z w t) sin(w_d t) until k d + c d' = 0 at
    w_d t = 2 acos(z): t = 2 acos(z) / (w sqrt(1 - z^2)), and with z > 1 t = 2 acosh(z) / (w sqrt(z^2 - 1))
    (Schwager & Poschel 2007).

    Examples
    --------
    >>> hard = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 0.0, 2e5, 1.0, 9.8)
    >>> round(bounce_time(hard) * (2e5 / 0.459) ** 0.5 / math.pi, 9)
    1.0
    """
    w = math.sqrt(struck.stop_stiffness / struck.mass)
    z = struck.stop_damping / (2.0 * struck.mass * w)
    if z == 1.0:
        return 2.0 / w
    return 2.0 * (math.acos(z) if z < 1.0 else math.acosh(z)) / (w * math.sqrt(abs(1.0 - z * z)))


def arrivals(struck: StruckObject, speed: float) -> tuple[float, float]:
    """Return when a struck object is back on its stop, and when again after one bounce, s; NaN where it never is.

    It leaves the stop at a speed (m/s) and flies without friction; the second flight begins with the speed of the first
    return times the stop's restitution.

    Examples
    --------
    >>> soft = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 20.0, 2e5, 0.5, 9.8)
    >>> [round(t * 1e3, 2) for t in arrivals(soft, 5.0)]
    [6.9, 15.32]
    """
    support = Support(struck.spring, struck.preload, struck.damper)
    weight = struck.mass * struck.gravity
    try:
        first = return_arc(support, struck.mass, speed, weight)
        second = return_arc(support, struck.mass, struck.stop_restitution * first.speed, weight)
    except ValueError:
        return math.nan, math.nan
    return first.time, first.time + bounce_time(struck) + second.time
