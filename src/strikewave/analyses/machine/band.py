"""The bands of a machine's run, and a first look at it while its settings are moved: many runs by the fast engine.

For its bands the machine runs with its inputs drawn within their ranges: a rotary machine by the fast engine
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

from strikewave.analyses.machine.blow_histories import BlowReading, TimedBlow, first_struck, struck_blows
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.result import SHOWN_WIDTHS, blow_results, sensor_results
from strikewave.base.quantities import Value
from strikewave.base.result import RUN_BROKEN, Band, BandMethod
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_channels
from strikewave.machines import Blow, MachineRun, blows, run_machine
from strikewave.machines.blows import pulse_window
from strikewave.machines.fast_run import TrainBlow, fast_train, why_not
from strikewave.uncertainty.bands import LEVEL, Sample, find_bands, moved
from strikewave.uncertainty.draws import FELT, SEED, UncertainInput, allowed_inputs, drawn, drawn_case, latin_hypercube
from strikewave.uncertainty.input_ranges import known_inputs
from strikewave.uncertainty.runs import on_threads, why_failed

Array = NDArray[np.float64]
Results = Mapping[str, float]

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
FULL_TOLERANCE = 1e-7  # local error of a step of a full run, as in `strikewave.studies.simulation`


def machine_bands(
    case: Case,
    run_blows: Sequence[Blow],
    readings: Sequence[BlowReading | None],
    progress: Callable[[float], None] | None = None,
    threads: int | None = None,
    runs: FastRuns | None = None,
) -> tuple[dict[str, Band], BandMethod | None]:
    """Return the bands of a run, by the names of the results, and their method; none where no blow struck.

    ``progress`` is called with the share done, 0 to 1; ``runs`` are those of `fast_runs` where they are at hand. Equal
    cases give equal bits, whatever the number of threads.
    """
    results = blow_results(run_blows)
    if not results:
        return {}, None
    say = progress or (lambda share: None)
    sensors = sensor_results(readings)
    if not by_fast_engine(case):
        of_sensors = sensors if case.launched() else {}
        return _as_it_is(case, {**results, **of_sensors}, bool(of_sensors), say, threads)
    share = 0.2 if sensors else 1.0  # of the progress: chosen, as runs of sensors take longer
    runs = runs or fast_runs(case, lambda done: say(share * done), threads)
    bands, method = _fast_bands(case, results, runs)
    if sensors:
        more, method = _sensor_bands(case, sensors, method, lambda done: say(share + (1.0 - share) * done), threads)
        bands |= more
    return bands, method


def by_fast_engine(case: Case) -> bool:
    """Tell whether the fast engine can find the bands of a case."""
    return case.launched() is None and not why_not(dataclasses.replace(build_machine(case), layered=None))


@dataclass(frozen=True)
class _Outcome:
    """Results of a run at drawn inputs, and whether it missed a blow or broke a limit."""

    results: Results
    missed: bool
    broken: bool = False


def _outcome(run_blows: Sequence[TimedBlow]) -> _Outcome:
    """Return the outcome of a run that is followed for a number of passes: one that misses has too few blows."""
    missed = not run_blows or len(struck_blows(run_blows)) < len(run_blows)
    return _Outcome(blow_results(run_blows), missed, missed)


@dataclass(frozen=True)
class FastRuns:
    """Runs of the fast engine: nominal, and at drawn inputs, first those of all blows; why the first one failed."""

    nominal: Results
    drawn: list[_Outcome | None]
    why: str = ""


def fast_runs(case: Case, say: Callable[[float], None] | None = None, threads: int | None = None) -> FastRuns:
    """Make the runs of the fast engine for the bands of a case: they need none of its results."""
    inputs, points, passes, short = _fast_draws(case)
    bodies = dataclasses.replace(build_machine(case), layered=None)

    def run(row: tuple[Array, int]) -> _Outcome:
        numbers, wanted = row
        machine = dataclasses.replace(build_machine(drawn_case(case, inputs, numbers.tolist())), layered=None)
        train = fast_train(machine, wanted, tolerance=TOLERANCE).blows
        if wanted < passes and (not train or train[0].kind == "missed"):  # the first that strikes comes later
            train = fast_train(machine, passes, tolerance=TOLERANCE).blows
        return _outcome(train)

    rows = list(zip(drawn(inputs, points), [passes] * RUNS + [short] * FIRST_RUNS, strict=True))
    outcomes = on_threads(run, rows, threads, say)
    nominal = blow_results(fast_train(bodies, passes, tolerance=TOLERANCE).blows)
    return FastRuns(nominal, outcomes, why_failed(run, rows, outcomes))


def _fast_draws(case: Case) -> tuple[Sequence[UncertainInput], Array, int, int]:
    """Return the inputs, the points, and the passes of runs of all blows and of those of the first one."""
    inputs = allowed_inputs(case, known_inputs(case), build_machine)
    points = np.vstack([_points(inputs, RUNS, WHOLE_STREAM), _points(inputs, FIRST_RUNS, FIRST_STREAM)])
    passes = min(build_machine(case).drive.feed.blows, MOST_BLOWS)
    return inputs, points, passes, min(passes, FIRST_PASSES)


def _fast_bands(case: Case, results: Results, runs: FastRuns) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands by the fast engine."""
    inputs, points, passes, short = _fast_draws(case)
    columns = _columns(runs.drawn, [name for name in results if name in runs.nominal])
    for name, values in columns.items():
        values += results[name] - runs.nominal[name]  # the fast engine's spread about the full run's result
        if short < passes and not name.startswith("first."):
            values[RUNS:] = np.nan
    missed, failed = _missed(runs.drawn[:RUNS]), runs.drawn.count(None)
    method = BandMethod("the fast engine", LEVEL, SEED, RUNS, FIRST_RUNS, missed, failed, why=runs.why, broken=missed)
    return find_bands(Sample(inputs, points), columns, method)


def _as_it_is(
    case: Case, results: Results, sensors: bool, say: Callable[[float], None], threads: int | None
) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands by full runs."""
    inputs = _with_channels(case) if sensors else allowed_inputs(case, known_inputs(case), build_machine)

    def run(numbers: Array) -> _Outcome:
        changed = drawn_case(case, inputs, numbers.tolist())
        if sensors:
            seen = observe(changed)
            full, run_blows, more = seen.run, seen.blows, sensor_results(seen.readings)
        else:
            full = run_machine(build_machine(changed), FULL_TOLERANCE)
            run_blows, more = blows(full), {}
        outcome, broken = _outcome(run_blows), run_verdict(changed, full, run_blows).status == RUN_BROKEN
        return _Outcome({**outcome.results, **more}, outcome.missed, broken)

    points = _points(inputs, LAUNCHED_RUNS, WHOLE_STREAM)
    rows = list(drawn(inputs, points))
    outcomes = on_threads(run, rows, threads, say)
    why, broken = why_failed(run, rows, outcomes), len([row for row in outcomes if row and row.broken])
    missed, failed = _missed(outcomes), outcomes.count(None)
    method = BandMethod("full runs", LEVEL, SEED, LAUNCHED_RUNS, 0, missed, failed, why=why, broken=broken)
    return find_bands(Sample(inputs, points), _columns(outcomes, list(results)), method)


def _sensor_bands(
    case: Case, results: Results, method: BandMethod, say: Callable[[float], None], threads: int | None
) -> tuple[dict[str, Band], BandMethod]:
    """Return the bands of sensors by full runs of the first blow."""
    inputs = _with_channels(case)
    once = case.with_values({"feed.blows": Value(si=1.0, typed=1)})

    def run(numbers: Array) -> _Outcome:
        seen = observe(drawn_case(once, inputs, numbers.tolist()))
        return _Outcome(sensor_results(seen.readings), False)

    points = _points(inputs, SENSOR_RUNS, SENSOR_STREAM)
    rows = list(drawn(inputs, points))
    outcomes = on_threads(run, rows, threads, say)
    why, failed = method.why or why_failed(run, rows, outcomes), method.failed + outcomes.count(None)
    method = dataclasses.replace(method, sensor_runs=SENSOR_RUNS, failed=failed, why=why)
    bands: dict[str, Band] = {}
    for name, values in _columns(outcomes, list(results)).items():
        more, method = find_bands(_felt_by(name, inputs, points), {name: values}, method)
        bands |= more
    return bands, dataclasses.replace(method, inputs=tuple(map(moved, inputs)))


def _with_channels(case: Case) -> tuple[UncertainInput, ...]:
    """Return the inputs of a case that its blows and sensors feel."""
    known = known_inputs(case, (*FELT, "sensor"))
    return allowed_inputs(case, known, lambda changed: (build_machine(changed), build_channels(changed)))


def _felt_by(name: str, inputs: Sequence[UncertainInput], points: Array) -> Sample:
    """Return the inputs that a sensor feels: not the fields of other sensors, which few runs would credit by chance."""
    sensor = name.removesuffix(".peak") + "."
    felt, columns = list[UncertainInput](), list[bool]()
    for row in inputs:
        is_felt = any(not field.startswith("sensor.") or field.startswith(sensor) for field in row.fields)
        felt += [row] * is_felt
        columns += [is_felt] * row.count
    return Sample(felt, points[:, columns])


def _points(inputs: Sequence[UncertainInput], runs: int, stream: int) -> Array:
    return latin_hypercube(sum([row.count for row in inputs]), runs, stream=stream)


def _columns(outcomes: Sequence[_Outcome | None], names: Sequence[str]) -> dict[str, Array]:
    """Return each result over the runs; NaN where a run has none."""
    nothing: Results = {}
    rows = [outcome.results if outcome else nothing for outcome in outcomes]
    return {name: np.array([row.get(name, math.nan) for row in rows]) for name in names}


def _missed(outcomes: Sequence[_Outcome | None]) -> int:
    return len([outcome for outcome in outcomes if outcome and outcome.missed])


PULSE_TOLERANCE = 1e-6  # local error of a step of the first blow: the curve moves by less than its line is wide
SAMPLES = 400  # of the curve of a blow: as many as a diagram has pixels across
MOST_PASSES = 60
"""Passes of a first look: more do not stand apart in a diagram, and a train of thousands would not be a first look."""
NO_ARRAY = np.zeros(0)


@dataclass(frozen=True)
class QuickLook:
    """A first look at a machine, SI: every pass, and the histories of the first blow that struck.

    ``fast`` is True if the table is from the fast engine, not a full run of the bodies; ``bodies_only`` if the object
    is a stack whose waves are left out.
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
        return first_struck(self.blows)


def quick_look(case: Case) -> QuickLook:
    """Return a first look at a machine case: a tenth of a second instead of one.

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
        struck = first_struck(table)
        if struck is None:
            return QuickLook(table, NO_ARRAY, NO_ARRAY, NO_ARRAY, True, bodies_only)
        run = run_machine(bodies.with_feed(blows=table.index(struck) + 1), PULSE_TOLERANCE)
        return QuickLook(table, *_pulse(run, blows(run)), True, bodies_only)
    run = run_machine(bodies, PULSE_TOLERANCE)
    full = blows(run)
    return QuickLook(full, *_pulse(run, full), False, bodies_only)


def _pulse(run: MachineRun, run_blows: Sequence[Blow]) -> tuple[Array, Array, Array]:
    """Return time after first touch, contact force and rigid-body acceleration of the first blow that struck."""
    first = first_struck(run_blows)
    if first is None:
        return NO_ARRAY, NO_ARRAY, NO_ARRAY
    longest = run.end - first.time
    shown = min(SHOWN_WIDTHS * first.width, longest) if first.width > 0.0 else longest
    return pulse_window(run, first.time, shown, shown / SAMPLES) if math.isfinite(shown) else (NO_ARRAY,) * 3
