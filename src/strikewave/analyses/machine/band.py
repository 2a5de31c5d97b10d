"""The bands of a machine's run, and a first look at it while its settings are moved: many runs by the fast engine.

For its bands the machine runs with its inputs moved within what is known of them: a rotary machine by the fast engine
(`strikewave.machines.fast_run`), a stack as two bodies on its frame; the first blow has further runs, since two
passes are cheap. A machine that strikes once, or that the fast engine does not hold for, runs as it is. Sensors need
the whole history of a blow, on a stack with its waves: few such runs are made.

A full run of a train takes about a second, its samples the most of it. A first look takes a tenth: the fast engine for
all blows, and the bodies in full only up to the first blow that strikes.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.readings import BlowReading
from strikewave.analyses.machine.result import SHOWN_WIDTHS, TimedBlow, figures_of, sensor_figures
from strikewave.base.quantities import Value
from strikewave.base.result import RUN_BROKEN, Band, BandMethod
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_channels
from strikewave.machines import Blow, MachineRun, blows, run_machine
from strikewave.machines.blows import pulse_window
from strikewave.machines.fast_run import TrainBlow, fast_train, why_not
from strikewave.uncertainty.bands import LEVEL, SEED, Sample, find_bands, latin_hypercube, moved
from strikewave.uncertainty.draws import FELT, UncertainInput, allowed_inputs, drawn, drawn_case
from strikewave.uncertainty.known import known_inputs
from strikewave.uncertainty.runs import on_threads, why_failed

Array = NDArray[np.float64]
Figures = Mapping[str, float]

RUNS = 96
"""Runs of all blows. On li-ma-2019 and li-ma-2019-fig13 the bands of so many hold 94 to 97 % of 1200 other draws on the
mean over seeds, as those of 128 do (docs/band.md); with those of the first blow they take 0.6 s of a processor."""
FIRST_RUNS = 96
"""Further runs of the first blow: each takes a third of the time of one of all blows."""
FIRST_PASSES = 2
"""Passes after which the first blow has ended: a second contact of it may come as late as the next striker."""
MOST_BLOWS = 20
"""Most blows of a run: a longer train is judged by its beginning, and its bands are moved to its own numbers."""
SENSOR_RUNS = 32
"""Runs of the first blow for sensors: each takes 0.06 s of a processor on a stack, so that they take 1 s on two. The
ends are then the lowest and the highest run where no fit smooths them, which hold 31/33 = 94 % of others on the
mean, and shares below a tenth are within chance."""
LAUNCHED_RUNS = 128
"""Runs of a machine that strikes once, or as it is: 2 to 18 ms of a processor each over the built-in cases, 12 draws of
each measured, so 0.3 to 2.3 s. On jesd22-b111-b their bands hold 94 to 95 % of 2000 full runs (docs/band.md)."""
WHOLE_STREAM, FIRST_STREAM, SENSOR_STREAM = 11, 12, 13
"""Keys of the draws of each."""
TOLERANCE = 1e-4
"""Local error of a step of the fast engine. Measured on li-ma-2019 over its inputs: it changes no result by more than
6e-4, a tenth of what the number of runs does to the ends."""
FULL_TOLERANCE = 1e-7
"""Local error of a step of a run as it is; see `strikewave.studies.simulation`."""


def machine_bands(
    case: Case,
    found: Sequence[Blow],
    readings: Sequence[BlowReading | None],
    progress: Callable[[float], None] | None = None,
    threads: int | None = None,
    runs: FastRuns | None = None,
) -> tuple[dict[str, Band], BandMethod | None]:
    """Return the bands of a run, by the names of the results, and how they were found; none where no blow struck.

    Equal cases give equal bits, whatever the number of threads.

    Parameters
    ----------
    case : Case
        Case that was run.
    found : sequence of Blow
        Its blows.
    readings : sequence of (BlowReading or None)
        Sensor readings of the blows.
    progress : callable, optional
        Called with the share done, 0 to 1.
    threads : int, optional
        As many as processors, where it is left out.
    runs : FastRuns, optional
        Result of `fast_runs` for the case, where it is at hand.
    """
    figures = figures_of(found)
    if not figures:
        return {}, None
    say = progress or (lambda share: None)
    sensors = sensor_figures(readings)
    if not by_fast_engine(case):
        of_sensors = sensors if case.launched() else {}
        return _as_it_is(case, {**figures, **of_sensors}, bool(of_sensors), say, threads)
    share = 0.2 if sensors else 1.0
    runs = runs or fast_runs(case, lambda done: say(share * done), threads)
    bands, method = _fast_bands(case, figures, runs)
    if sensors:
        more, method = _sensor_bands(case, sensors, method, lambda done: say(share + (1.0 - share) * done), threads)
        bands |= more
    return bands, method


def by_fast_engine(case: Case) -> bool:
    """Tell whether the bands of a case are found by the fast engine."""
    return case.launched() is None and not why_not(dataclasses.replace(build_machine(case), layered=None))


@dataclass(frozen=True)
class _Outcome:
    """What a run at drawn inputs came to."""

    figures: Figures
    missed: bool
    broken: bool = False


def _judged(case: Case, run: MachineRun, found: Sequence[Blow], more: Figures) -> _Outcome:
    """Return the outcome of a full run, judged by its limits."""
    outcome, broken = _outcome(found), run_verdict(case, run, found).status == RUN_BROKEN
    return _Outcome({**outcome.figures, **more}, outcome.missed, broken)


def _outcome(found: Sequence[TimedBlow]) -> _Outcome:
    """Return the outcome of a run that is followed for a number of passes: one that misses has too few blows."""
    missed = any(blow.kind == "missed" for blow in found) or not found
    return _Outcome(figures_of(found), missed, missed)


@dataclass(frozen=True)
class FastRuns:
    """What runs of the fast engine came to: as the case is, and at drawn inputs, first those of all blows.

    ``why`` says why the first of those that could not be made failed.
    """

    nominal: Figures
    drawn: list[_Outcome | None]
    why: str = ""


def fast_runs(case: Case, say: Callable[[float], None] | None = None, threads: int | None = None) -> FastRuns:
    """Make the runs of the fast engine for the bands of a case: they need none of its results."""
    inputs, points, passes, short = _fast_draws(case)

    def run(row: tuple[Array, int]) -> _Outcome:
        numbers, wanted = row
        machine = dataclasses.replace(build_machine(drawn_case(case, inputs, numbers.tolist())), layered=None)
        train = fast_train(machine, wanted, tolerance=TOLERANCE).blows
        if wanted < passes and (not train or train[0].kind == "missed"):  # the first that strikes comes later
            train = fast_train(machine, passes, tolerance=TOLERANCE).blows
        return _outcome(train)

    rows = list(zip(drawn(inputs, points), [passes] * RUNS + [short] * FIRST_RUNS, strict=True))
    found = on_threads(run, rows, threads, say)
    bodies = dataclasses.replace(build_machine(case), layered=None)
    nominal = figures_of(fast_train(bodies, passes, tolerance=TOLERANCE).blows)
    return FastRuns(nominal, found, why_failed(run, rows, found))


def _fast_draws(case: Case) -> tuple[Sequence[UncertainInput], Array, int, int]:
    """Return what is drawn, the points, and the passes of runs of all blows and of those of the first one."""
    inputs = allowed_inputs(case, known_inputs(case), build_machine)
    points = np.vstack([_points(inputs, RUNS, WHOLE_STREAM), _points(inputs, FIRST_RUNS, FIRST_STREAM)])
    passes = min(build_machine(case).drive.feed.blows, MOST_BLOWS)
    return inputs, points, passes, min(passes, FIRST_PASSES)


def _fast_bands(case: Case, figures: Figures, runs: FastRuns) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands by the fast engine."""
    inputs, points, passes, short = _fast_draws(case)
    nominal, found = runs.nominal, runs.drawn
    results = _columns(found, [name for name in figures if name in nominal])
    for name, values in results.items():
        values += figures[name] - nominal[name]
        if short < passes and not name.startswith("first."):
            values[RUNS:] = np.nan
    missed, failed = _missed(found[:RUNS]), _failed(found)
    method = BandMethod("the fast engine", LEVEL, SEED, RUNS, FIRST_RUNS, missed, failed, why=runs.why, broken=missed)
    return find_bands(Sample(inputs, points), results, method)


def _as_it_is(
    case: Case, figures: Figures, sensors: bool, say: Callable[[float], None], threads: int | None
) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands by full runs."""
    inputs = _with_channels(case) if sensors else allowed_inputs(case, known_inputs(case), build_machine)

    def run(numbers: Array) -> _Outcome:
        changed = drawn_case(case, inputs, numbers.tolist())
        if not sensors:
            full = run_machine(build_machine(changed), FULL_TOLERANCE)
            return _judged(changed, full, blows(full), {})
        seen = observe(changed)
        return _judged(changed, seen.run, seen.blows, sensor_figures(seen.readings))

    points = _points(inputs, LAUNCHED_RUNS, WHOLE_STREAM)
    rows = list(drawn(inputs, points))
    found = on_threads(run, rows, threads, say)
    why = why_failed(run, rows, found)
    method = BandMethod("full runs", LEVEL, SEED, LAUNCHED_RUNS, 0, _missed(found), _failed(found), why=why)
    method = dataclasses.replace(method, broken=sum(one is not None and one.broken for one in found))
    return find_bands(Sample(inputs, points), _columns(found, list(figures)), method)


def _sensor_bands(
    case: Case, figures: Figures, method: BandMethod, say: Callable[[float], None], threads: int | None
) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands of sensors by full runs of the first blow."""
    inputs = _with_channels(case)
    once = case.with_values({"feed.blows": Value(si=1.0, typed=1)})

    def run(numbers: Array) -> _Outcome:
        seen = observe(drawn_case(once, inputs, numbers.tolist()))
        return _Outcome(sensor_figures(seen.readings), False)

    points = _points(inputs, SENSOR_RUNS, SENSOR_STREAM)
    rows = list(drawn(inputs, points))
    found = on_threads(run, rows, threads, say)
    why, failed = method.why or why_failed(run, rows, found), method.failed + _failed(found)
    method = dataclasses.replace(method, sensor_runs=SENSOR_RUNS, failed=failed, why=why)
    bands: dict[str, Band] = {}
    for name, values in _columns(found, list(figures)).items():
        more, method = find_bands(_felt_by(name, inputs, points), {name: values}, method)
        bands |= more
    moved_by_any = tuple(moved(one) for one in inputs)
    return bands, dataclasses.replace(method, inputs=moved_by_any)


def _with_channels(case: Case) -> tuple[UncertainInput, ...]:
    """Return the inputs of a case that its blows and sensors feel."""
    known = known_inputs(case, (*FELT, "sensor"))
    return allowed_inputs(case, known, lambda changed: (build_machine(changed), build_channels(changed)))


def _felt_by(name: str, inputs: Sequence[UncertainInput], points: Array) -> Sample:
    """Return the inputs that a sensor feels: not the fields of other sensors, which few runs would credit by chance."""
    sensor = name.removesuffix(".peak") + "."
    felt = [one for one in inputs if any(not f.startswith("sensor.") or f.startswith(sensor) for f in one.fields)]
    owners = [one.path for one in inputs for _ in range(one.count)]
    paths = {one.path for one in felt}
    return Sample(felt, points[:, [path in paths for path in owners]])


def _points(inputs: Sequence[UncertainInput], runs: int, stream: int) -> Array:
    return latin_hypercube(sum(one.count for one in inputs), runs, stream=stream)


def _columns(found: Sequence[_Outcome | None], names: Sequence[str]) -> dict[str, Array]:
    """Return each result over the runs; NaN where a run has none."""
    nothing: Figures = {}
    rows = [nothing if one is None else one.figures for one in found]
    return {name: np.array([row.get(name, math.nan) for row in rows]) for name in names}


def _missed(found: Sequence[_Outcome | None]) -> int:
    return sum(one is not None and one.missed for one in found)


def _failed(found: Sequence[_Outcome | None]) -> int:
    return sum(one is None for one in found)


PULSE_TOLERANCE = 1e-6
"""Local error of a step of the first blow: the curve moves by less than its line is wide."""
SAMPLES = 400
"""Samples of the curve of a blow: as many as a diagram has pixels across."""
MOST_PASSES = 60
"""Passes of a first look: more do not stand apart in a diagram, and a train of thousands would not be a first look."""
NO_ARRAY = np.zeros(0)


@dataclass(frozen=True)
class QuickLook:
    """What a first look shows, SI.

    Attributes
    ----------
    blows : sequence of TrainBlow or Blow
        Every pass, missed ones among them.
    since, force, acceleration : ndarray
        Time after first touch, contact force and rigid-body acceleration of the first blow that struck.
    fast : bool
        True if the table is from the fast engine; otherwise all of it is from a full run of the bodies.
    bodies_only : bool
        True if the object is a stack whose waves are left out here.
    """

    blows: Sequence[TrainBlow | Blow]
    since: Array
    force: Array
    acceleration: Array
    fast: bool
    bodies_only: bool

    @property
    def first(self) -> TrainBlow | Blow | None:
        """The first blow that struck; None where none did."""
        return next((blow for blow in self.blows if blow.kind != "missed"), None)


def quick_look(case: Case) -> QuickLook:
    """Return a first look at a machine case: a tenth of a second instead of one.

    Parameters
    ----------
    case : Case
        Case of a machine.

    Raises
    ------
    InputError
        If the case is that of no machine, or parts of it do not fit together.
    IntegrationError
        If the motion cannot be followed.

    Examples
    --------
    >>> from strikewave import load_case
    >>> look = quick_look(load_case("li-ma-2019"))
    >>> len(look.blows), look.fast, round(look.first.rigid_peak / 9.80665, -1)
    (11, True, 4150.0)
    """
    case.impact()
    machine = build_machine(case)
    bodies = dataclasses.replace(machine, layered=None)
    bodies_only = machine.layered is not None
    if bodies.launch is None and not why_not(bodies):
        longer = bodies.drive.feed.blows > MOST_PASSES
        table = fast_train(bodies, MOST_PASSES if longer else None, tolerance=TOLERANCE).blows
        struck = next((place for place, blow in enumerate(table) if blow.kind != "missed"), None)
        if struck is None:
            return QuickLook(table, NO_ARRAY, NO_ARRAY, NO_ARRAY, True, bodies_only)
        run = run_machine(bodies.with_feed(blows=struck + 1), PULSE_TOLERANCE)
        return QuickLook(table, *_pulse(run, blows(run)), True, bodies_only)
    run = run_machine(bodies, PULSE_TOLERANCE)
    full = blows(run)
    return QuickLook(full, *_pulse(run, full), False, bodies_only)


def _pulse(run: MachineRun, found: Sequence[Blow]) -> tuple[Array, Array, Array]:
    """Return time after first touch, contact force and rigid-body acceleration of the first blow that struck."""
    first = next((blow for blow in found if blow.kind != "missed"), None)
    if first is None:
        return NO_ARRAY, NO_ARRAY, NO_ARRAY
    longest = run.end - first.time
    shown = min(SHOWN_WIDTHS * first.width, longest) if first.width > 0.0 else longest
    return pulse_window(run, first.time, shown, shown / SAMPLES) if math.isfinite(shown) else (NO_ARRAY,) * 3
