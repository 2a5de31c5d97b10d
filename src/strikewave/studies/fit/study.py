"""A case fitted to measurements: read, search, what contradicts every value, and the case that came of it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.sources import SourceOptions
from strikewave.base.compiling import compiling_shown
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.quantities import Value
from strikewave.base.result import Notice, Verdicts
from strikewave.base.texts import first_few
from strikewave.cases.case import NONE, Case, FitTable
from strikewave.reporting.measured_files import digests_of
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Workers, as_workers
from strikewave.studies.engine.store import RunStore
from strikewave.studies.fit.checking import TriedChoice, check, read_tries, tried
from strikewave.studies.fit.covariance import Estimate
from strikewave.studies.fit.estimation import is_quadratic, keeping_in, profile, running_on
from strikewave.studies.fit.fit_file import load_fit
from strikewave.studies.fit.free_fields import FreeField, changed_case, free_fields
from strikewave.studies.fit.measured import MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.posterior import MOST_BANDS, check_sampler, predictive_bands, sample
from strikewave.studies.fit.problem import Problem, Solved, separating, solve
from strikewave.studies.fit.result import (
    NOT_SAMPLED,
    FitStudy,
    FittedParameter,
    fit_notices,
    held_notices,
    posterior_notices,
)
from strikewave.studies.fit.targets import (
    FitRequest,
    ReadTargets,
    Target,
    parse_targets,
    published_targets,
    read_targets,
)
from strikewave.studies.simulation import Simulation
from strikewave.uncertainty.draws import FELT

Array = NDArray[np.float64]

MOST_NAMED = 6  # targets that a note names: it stays one line


@compiling_shown()
def fit(
    case: Case | str | Path,
    to: Sequence[str] = (),
    free: Sequence[str] = (),
    *,
    tries: str = "",
    check_on: Sequence[str] = (),
    reading: SourceOptions | None = None,
    bayes: bool = False,
    workers: int | Workers | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> FitStudy:
    """Fit values of a case to measurements.

    Parameters
    ----------
    case : Case, str or Path
        Case of a machine, a layered bar, or elements; the search begins at its values. Or the path of a file of a whole
        fit, which states all else.
    to : sequence of str, optional
        Records and numbers, as ``--to`` takes them; the published numbers that the case was fitted to by default.
    free : sequence of str, optional
        Fields, ``path`` or ``path=low..high``; those marked as fitted by default.
    tries : str, optional
        Choices of a field that are fitted each, ``law=palmgren,johnson``: the one is kept that predicts best.
    check_on : sequence of str, optional
        Records and numbers that are kept out, and predicted.
    reading : SourceOptions, optional
        Options for reading records.
    bayes : bool, optional
        Also sample the posterior; needs emcee, ``pip install 'strikewave[bayes]'``.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``; threads of this
        process where it is left out.
    progress : callable, optional
        Called with the number of runs, and the smallest sum of squares so far.

    Returns
    -------
    FitStudy
        Values with standard errors and intervals, their correlation, what the data do not determine, and the
        fitted case.

    Raises
    ------
    InputError, StrikewaveError
        If a record cannot be read, a field is none, or the case cannot be run.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("jesd22-b111-b", ["contact.reference_force=700 kN"])
    >>> study = fit(case, ["first.rigid_peak=1500 g +- 1 %"], ["contact.reference_force"])
    >>> round(study.parameters[0].standard_error / study.parameters[0].value, 2)
    0.02
    """
    # without workers the searches share threads of their own (`estimation.each_or_none`)
    pool = None if workers is None else as_workers(workers).pool()
    if isinstance(case, Case):
        request = FitRequest(tuple(to), tuple(free), tries, tuple(check_on), reading or SourceOptions(), bayes)
        return requested(case, request, progress, pool)
    if to or free or tries or check_on or bayes or reading is not None:
        raise InputError("case", str(case), "the path of a file alone: it states all else", "or a case: load_case(...)")
    read = load_fit(case)
    return requested(read.case, read.request, progress, pool)


def requested(
    case: Case,
    request: FitRequest,
    progress: Callable[[int, float], None] | None = None,
    pool: Pool | None = None,
    store: RunStore | None = None,
) -> FitStudy:
    """Return the fit that is asked for; see `fit`. What its runs come to is kept in a store where one is given."""
    if request.bayes:
        check_sampler()
    with running_on(pool), keeping_in(store):
        study = _tried(case, request, progress) if request.tries else _fit(case, request, progress)
        return with_posterior(study, progress) if request.bayes and not study.solved.stopped else study


def with_posterior(study: FitStudy, progress: Callable[[int, float], None] | None = None) -> FitStudy:
    """Return a fit with its posterior sampled."""
    runs = study.solved.runs

    def advance(more: int, misfit: float) -> None:
        if progress is not None:
            progress(runs + more, misfit)

    posterior = sample(study.solved.problem.residuals, study.solved.estimate, advance)
    if posterior is None:
        return dataclasses.replace(study, notices=(*study.notices, NOT_SAMPLED))
    return dataclasses.replace(
        study,
        posterior=posterior,
        bands=tuple(predictive_bands(study.solved, posterior, MOST_BANDS)),
        citations=(*study.citations, "foreman-mackey-2013", "ribatet-2012"),
        notices=(*study.notices, *posterior_notices(posterior)),
    )


def _tried(case: Case, request: FitRequest, progress: Callable[[int, float], None] | None) -> FitStudy:
    """Return the fit of the choice that does best, with all of them."""
    with request.stated("try"):
        changes = read_tries(case, request.tries)
    studies, rows = dict[str, FitStudy](), list[TriedChoice]()
    for change in changes:
        try:
            studies[change] = _fit(changed_case(case, [change]), request, progress)
            rows.append(tried(change, studies[change].solved))
            if studies[change].solved.stopped:
                break
        except StrikewaveError as error:
            rows.append(TriedChoice(change, failure=str(error).partition("\n")[0]))
    rows.sort(key=lambda row: row.rank)
    if rows[0].failure:
        raise InputError("--try", rows[0].choice, "a choice that can be fitted", rows[0].failure)
    return dataclasses.replace(studies[rows[0].choice], tries=tuple(rows))


def _fit(case: Case, request: FitRequest, progress: Callable[[int, float], None] | None) -> FitStudy:
    """Return the fit of one case."""
    with request.stated("free"):
        fields = free_fields(case, request.free)
    targets = parse_targets(request.to, case) or published_targets(case)
    if not targets:
        hint = 'such as --to shot.csv or --to first.rigid_peak="4000 g"'
        raise InputError("--to", "none", "a record or a number: the case holds none that it was fitted to", hint)
    read = read_targets("--to", case, targets, fields, request.reading)
    kept_out = read_targets("--check-on", case, parse_targets(request.check_on, case), fields, request.reading)
    study = fitted_study(case, fields, read, targets, progress)
    if not request.free:
        study = dataclasses.replace(study, notices=(*study.notices, *held_notices(case)))
    if not request.check_on:
        return study
    checks = check(study.solved, kept_out.experiments)
    return dataclasses.replace(study, checks=checks, notices=(*study.notices, *kept_out.notices))


def fitted_study(
    case: Case,
    fields: Sequence[FreeField],
    read: ReadTargets,
    targets: Sequence[Target],
    progress: Callable[[int, float], None] | None = None,
) -> FitStudy:
    """Return the fit of a case to what was read."""
    solved = solve(Problem(read.experiments, fields), progress)
    try:
        parameters, separate = [_parameter(solved, k, field) for k, field in enumerate(fields)], separating(solved)
    except KeyboardInterrupt:  # values and errors are found: profiles and advice are left out
        solved = dataclasses.replace(solved, stopped=True)
        parameters, separate = [_parameter(solved, k, field) for k, field in enumerate(fields)], []
    found, problem = solved.estimate, solved.problem
    aside = [change.partition("=")[0].strip() for target in targets for change in target.changes]
    sensors = any("sensor" in one.left for one in targets) or any(
        pulse.part.partition(".")[0] in {sensor.name for sensor in case.sensor} for pulse in read.pulses
    )
    digests = {Path(path).name: digest for path, digest in digests_of(read.paths).items()}
    to = FittedTo(_words(targets), digests, tuple(dict.fromkeys(aside)), sensors)
    runs = problem.runs(found.place)
    pairs = problem.with_runs(runs)
    verdicts = Verdicts([run.verdict.text for run in runs], "fitted runs")
    study = FitStudy(
        base=case,
        case=fitted_case(case, fields, found, to),
        solved=solved,
        parameters=tuple(parameters),
        pulses=tuple((datum, datum.laid(run)) for datum, run in pairs if isinstance(datum, MeasuredPulse)),
        computed=tuple(datum.computed(run) for datum, run in pairs if isinstance(datum, MeasuredNumber)),
        separating=tuple(separate),
        citations=("liang-zeger-1986", "bell-mccaffrey-2002", "raue-2009"),
        verdicts=verdicts,
    )
    noticed = (*verdicts.notices(), *speed_notices(problem, runs), *fit_notices(study), *read.notices)
    return dataclasses.replace(study, notices=noticed)


def _words(targets: Sequence[Target]) -> str:
    """Return what a case is fitted to, in words."""
    words = [
        f"{target.left.replace('.', ' ').replace('_', ' ')} {target.right}"
        if target.is_number
        else Path(target.right).name
        for target in targets
    ]
    return first_few(list(dict.fromkeys(words)), MOST_NAMED)


def _parameter(solved: Solved, k: int, field: FreeField) -> FittedParameter:
    """Return a fitted value with its interval: that of the profile where the misfit is no parabola."""
    found = solved.estimate
    place, error = float(found.place[k]), float(found.errors[k])
    value = field.si(place)
    stair = field.error(value, float(solved.problem.stairs[k]))
    if not math.isfinite(error):
        return FittedParameter(field, value, math.inf, field.low, field.high, stair=stair)
    followed = None
    shaped_by_misfit = not found.groups() and not found.mostly_stated(k)
    if not solved.stopped and shaped_by_misfit and not is_quadratic(solved.search, found, k):
        followed = profile(solved.search, found, k)
    reach = float(found.reach[k]) * error
    low, high = (place - reach, place + reach) if followed is None else followed[:2]
    ends = field.si(max(low, 0.0)), field.si(min(high, 1.0))
    return FittedParameter(field, value, field.error(value, error), *ends, followed, stair, float(found.reach[k]))


READ_WELL = 0.97
"""Share of the least velocity change below which a record warns: a shock accelerometer reads to some 3 %."""


def speed_notices(problem: Problem, runs: Sequence[Simulation]) -> Iterator[Notice]:
    """Warn of records whose velocity change is below that of a blow without rebound.

    Two bodies that are free and stay together leave the object with ``v M/(M + m)`` of the speed v at which they meet,
    M the mass of the striker or base and m that of the object; whatever is given back adds to it.
    """
    for experiment, run in zip(problem.experiments, runs, strict=True):
        if run.case.command != "run" or not run.case.launched():
            continue
        machine = run.observed.machine
        striker = machine.strikers.first
        blow = next((blow for blow in run.observed.blows if blow.kind != "missed"), None)
        if blow is None or machine.launch.arm is not None or striker.mount_stiffness > 0.0:
            continue  # an arm or a mount pushes on: the bodies are not free
        arrival = blow.approach_speed
        change = arrival * striker.mass / (striker.mass + machine.struck.mass)
        for datum in experiment.measured:
            if not isinstance(datum, MeasuredPulse) or datum.unit != "m/s^2":
                continue
            measured = abs(float(np.trapezoid(datum.values, datum.time)))
            if measured < READ_WELL * change:
                height = getattr(run.case.machine, "height", None)
                field = "the speed at which the machine arrives" if height is None else "machine.height"
                stated = "" if height is None else f", from machine.height = {height.si:.4g}\xa0m"
                message = (
                    f"the velocity change of {datum.called}, {measured:.3g}\xa0m/s, is below the {change:.3g}\xa0m/s "
                    f"that even a blow without rebound gives at {arrival:.3g}\xa0m/s{stated}: no restitution and no "
                    f"pad explains it; correct {field}, or free it"
                )
                yield Notice("slower-than-arrival", message, measured, change)


ERROR_DIGITS, CORRELATION_DIGITS = 4, 6  # of a standard error and a correlation: more than any of them has


class FittedTo(NamedTuple):
    """Data that values were fitted to; the files by their SHA-256; fields that differ between the experiments."""

    words: str
    records: Mapping[str, str]
    aside: Sequence[str] = ()
    sensors: bool = False


def fitted_case(case: Case, fields: Sequence[FreeField], found: Estimate, to: FittedTo) -> Case:
    """Return a case with fitted values, and how well they are known; what is not determined is assumed."""
    values, errors = dict[str, Value](), dict[str, str | float]()
    determined = [k for k, error in enumerate(found.errors) if np.isfinite(error) and error > 0.0]
    for k, (field, place) in enumerate(zip(fields, found.place, strict=True)):
        typed = field.with_si(field.si(float(place))).typed
        si = field.allowed.read(typed).si
        if k in determined:
            size = float(f"{field.error(si, float(found.errors[k])):.{ERROR_DIGITS}g}")
            errors[field.path] = field.axis.typed(size)
            note = f"standard error {errors[field.path]}, fitted to {to.words}"
            values[field.path] = Value(si=si, typed=typed, provenance="fitted", note=note)
        elif np.isfinite(found.errors[k]):
            values[field.path] = Value(si=si, typed=typed, provenance="fitted", note=f"fitted to {to.words}")
        else:
            values[field.path] = Value(si=si, typed=typed, note=f"a fit to {to.words} does not determine it alone")
    changed = case.with_values(values, keep_tolerances=False)
    fitted = [path for path, value in values.items() if value.provenance == "fitted"]
    if not fitted:
        return changed
    shares = found.covariance[np.ix_(determined, determined)]
    deviations = np.sqrt(np.diag(shares))
    rows = np.round(shares / np.outer(deviations, deviations), CORRELATION_DIGITS).tolist() if determined else []
    table = FitTable(
        fields=tuple(fitted),
        to=to.words,
        under=_under(changed, fitted, to),
        standard_error=errors,
        correlation=tuple(map(tuple, rows)) if len(determined) > 1 else (),
        records=dict(to.records),
    )
    kept = []
    for fit in changed.fit:
        left = tuple(path for path in fit.fields if path not in values)
        whole = left == fit.fields
        if left:
            update = {"fields": left, "standard_error": {}, "correlation": ()}
            kept.append(fit if whole else fit.model_copy(update=update))
    return changed.model_copy(update={"fit": (*kept, table)})


def _under(case: Case, fitted: Sequence[str], to: FittedTo) -> dict[str, str | int | float]:
    """Return the fields that a fit holds under, as typed: those that an earlier one named, else all that are felt."""
    before = next((fit for fit in case.fit if set(fitted) <= set(fit.fields)), None)
    entries, values = case.entries(), case.values()
    paths = list[str]()
    if before is not None:
        for path in before.under:  # a table that was left out then may be there now
            below = [] if path in entries else [entry for entry in entries if entry.startswith(f"{path}.")]
            paths += below or [path]
    else:
        tables = (*FELT, "load", *(("sensor",) if to.sensors else ()))
        paths = [path for path in entries if path.partition(".")[0] in tables]
    paths = [path for path in dict.fromkeys([*paths, *fitted]) if path not in to.aside]
    return {path: values[path].typed if path in values else entries.get(path, NONE) for path in paths}
