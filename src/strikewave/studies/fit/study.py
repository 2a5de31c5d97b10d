"""A case fitted to measurements: the values, how well the data fix them, and what is left over."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.curve import QUANTITIES, SHOWN_IN
from strikewave.analyses.compare.sources import SourceOptions
from strikewave.base.compile_progress import compiling_shown
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import FAILED, INFO, Notice
from strikewave.cases.case import Case, dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import AskedResult, digests_of
from strikewave.reporting.numbers import listed, percent
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.studies.fit.checking import Checks, check
from strikewave.studies.fit.estimation import ProfileEnds, is_quadratic, profile
from strikewave.studies.fit.fitted_case import FittedTo, fitted_case
from strikewave.studies.fit.free_fields import FreeField, changed_case, free_fields
from strikewave.studies.fit.measured import LaidPulse, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.problem import Problem, Solved, solve
from strikewave.studies.fit.separating import SeparatingNumber, separating
from strikewave.studies.fit.simulation import Simulation
from strikewave.studies.fit.targets import (
    ReadTargets,
    Target,
    parse_target,
    published_targets,
    read_targets,
    target_words,
)
from strikewave.studies.fit.trying import TriedChoice, read_tries, tried

Array = NDArray[np.float64]

MET = 2.0
"""Standard uncertainties of a number within which the fit meets it: 95 %."""
MOST_NAMED = 6
"""Targets that a note names."""
AT_BOUND = 1e-4
"""Distance from a bound, over the width of the bounds, at which a value stands at it."""
WHOLE_POWER = 5e-3
"""Difference of a power from 1 below which it is not written: slopes know it no better."""
ALIKE = 0.98
"""Correlation of two values beyond which the report says that they are known together far better than each."""


@dataclass(frozen=True)
class FittedParameter:
    """A fitted value, SI.

    Attributes
    ----------
    field : FreeField
        What it is.
    value : float
        SI.
    standard_error : float
        SI; infinite where the data do not determine it.
    low, high : float
        Ends of its 95 % interval, SI; its bounds where it is not determined.
    profile : ProfileEnds or None
        Where the interval is that of its profile, as the misfit is no parabola.
    """

    field: FreeField
    value: float
    standard_error: float
    low: float
    high: float
    profile: ProfileEnds | None = None

    @property
    def determined(self) -> bool:
        """Whether the data determine it."""
        return math.isfinite(self.standard_error)


@dataclass(frozen=True, kw_only=True, eq=False)
class FitStudy(AskedResult):
    """A fitted case; see `fit`, and `Result` for what it shares with others.

    Attributes
    ----------
    base : Case
        What was fitted.
    case : Case
        With the fitted values.
    solved : Solved
        The best place, and what the data say of it.
    parameters : tuple of FittedParameter
        The values.
    pulses : tuple of (MeasuredPulse, LaidPulse)
        The records, each with the fitted run laid on it.
    computed : tuple of float
        What the fitted case gives of each stated number, SI.
    separating : tuple of SeparatingNumber
        Numbers that would tell apart what the data do not, the best first.
    checks : Checks or None
        Predictions of what was kept out.
    tries : tuple of TriedChoice
        Choices of a field that were fitted, the best first: that of this case.
    """

    command: ClassVar[str] = "fit"

    base: Case
    case: Case
    solved: Solved
    parameters: tuple[FittedParameter, ...]
    pulses: tuple[tuple[MeasuredPulse, LaidPulse], ...]
    computed: tuple[float, ...]
    separating: tuple[SeparatingNumber, ...] = ()
    checks: Checks | None = None
    tries: tuple[TriedChoice, ...] = ()

    @property
    def title(self) -> str:
        """What was fitted to what."""
        count = len(self.solved.problem.measured)
        return f"{self.base.name or 'case'} fitted to {count} measurement{'s' if count > 1 else ''}"

    @functools.cached_property
    def correlation(self) -> Array:
        """Correlation of the values; NaN of one that is not determined."""
        found = self.solved.estimate
        sizes = np.where(np.isfinite(found.errors), found.errors, np.nan)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(found.covariance / np.outer(sizes, sizes))

    @property
    def undetermined(self) -> list[list[str]]:
        """The fields that the data do not determine, those together of which only a combination is."""
        return [[self.parameters[k].field.path for k in group] for group in self.solved.estimate.groups()]

    @property
    def numbers(self) -> list[MeasuredNumber]:
        """The stated numbers."""
        return [one for one in self.solved.problem.measured if isinstance(one, MeasuredNumber)]

    def units(self) -> Mapping[str, str]:
        """Return the unit of each key of the JSON document."""
        return {
            "value": "as the field",
            "standard_error": "as the field",
            "low": "as the field",
            "high": "as the field",
            "start": "as the field",
            "correlation": "1",
            "size": "standard deviations of the noise",
            "share": "1",
            "independent": "1",
            "shift": "s",
            "measured": "as the number",
            "computed": "as the number",
            "uncertainty": "as the number",
            "predicted": "as the figure",
            "bias": "1",
            "iso18571": "1",
            "rms": "1",
            "errors": "1",
            "kept_out": "standard deviations of the noise",
        }

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        found = self.solved.estimate
        return {
            "case": self.base.name,
            "parameters": [
                {
                    "field": one.field.path,
                    "unit": one.field.axis.si_unit or "1",
                    "value": one.value,
                    "standard_error": one.standard_error if one.determined else None,
                    "low": one.low,
                    "high": one.high,
                    "start": one.field.value.si,
                    "bounds": [one.field.low, one.field.high],
                    "interval": "profile" if one.profile is not None else "quadratic" if one.determined else "bounds",
                }
                for one in self.parameters
            ],
            "correlation": self.correlation.tolist(),
            "undetermined": self.undetermined,
            "combinations": [combination_words(self, group) for group in found.groups()],
            "separating": [one._asdict() for one in self.separating],
            "misfit": {
                "chi_squared": found.misfit,
                "residuals": int(found.residuals.size),
                "freedom": found.freedom if math.isfinite(found.freedom) else None,
                "measured": [vars(one) for one in self.solved.misfits],
            },
            "numbers": [
                {
                    "number": one.called,
                    "unit": one.unit or "1",
                    "measured": one.value,
                    "uncertainty": one.uncertainty,
                    "computed": computed,
                }
                for one, computed in zip(self.numbers, self.computed, strict=True)
            ],
            "tries": [vars(one) for one in self.tries],
            "checks": None if self.checks is None else _checks_document(self.checks),
            "other_solutions": [self._values_at(place) for place in self.solved.others],
            "runs": self.solved.runs,
            "stopped": self.solved.stopped,
        }

    def _values_at(self, place: Array) -> dict[str, float]:
        fields = [one.field for one in self.parameters]
        return {field.path: field.si(float(at)) for field, at in zip(fields, place, strict=True)}

    def texts(self) -> dict[str, str]:
        """Return the fitted case, and the JSON document."""
        return {"fitted.toml": dump_case(self.case), "fit.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return the values, and record and fitted run over time, as CSV text."""
        tables = {"parameters.csv": csv_table(self.columns())}
        if not self.pulses:
            return tables
        units = {pulse.unit for pulse, _ in self.pulses}
        unit = units.pop() if len(units) == 1 else ""
        columns = [
            Column("record", [pulse.called for pulse, laid in self.pulses for _ in laid.time]),
            Column("time", np.concatenate([laid.time for _, laid in self.pulses]), "s"),
            Column("measured", np.concatenate([laid.measured for _, laid in self.pulses]), unit),
            Column("fitted", np.concatenate([laid.computed for _, laid in self.pulses]), unit),
        ]
        return {**tables, "residuals.csv": csv_table(columns, HISTORY_DIGITS)}

    def columns(self) -> list[Column]:
        """Return the values, each in the SI unit beside it."""
        return [
            Column("field", [one.field.path for one in self.parameters]),
            Column("unit", [one.field.axis.si_unit or "1" for one in self.parameters]),
            Column("value", [one.value for one in self.parameters]),
            Column("standard_error", [one.standard_error if one.determined else None for one in self.parameters]),
            Column("low", [one.low for one in self.parameters]),
            Column("high", [one.high for one in self.parameters]),
        ]

    def brief(self) -> dict[str, str]:
        """Return all columns."""
        return dict.fromkeys((column.name for column in self.columns()), "")

    def highlights(self) -> list[tuple[str, str]]:
        """Return the values with their standard errors, and the misfit."""
        numbers = [(one.field.path, value_words(one)) for one in self.parameters]
        worst = max(self.solved.misfits, key=lambda one: one.share)
        return [*numbers, ("largest RMS residual", percent(worst.share, 2))]

    def preview(self) -> Curve | None:
        """Return the residual of the first record."""
        if not self.pulses:
            return None
        pulse, laid = self.pulses[0]
        words = f"residual of the {QUANTITIES.get(pulse.unit, 'value')}"
        return history_curve(
            laid.time, laid.computed - laid.measured, pulse.unit, SHOWN_IN.get(pulse.unit, pulse.unit), words
        )


def _checks_document(checks: Checks) -> dict[str, Any]:
    """Return the predictions for the JSON document."""
    return {
        "inside": checks.inside,
        "figures": [{**vars(one), "inside": one.inside, "bias": one.bias} for one in checks.figures],
        "bias": checks.biases(),
        "iso18571": [
            {"record": name, "overall": one.rating.overall, "rms": one.rms} for name, one in checks.agreements
        ],
    }


def value_words(one: FittedParameter) -> str:
    """Return a value with its standard error, in the unit in which it was typed.

    Examples
    --------
    >>> from strikewave import load_case
    >>> field = free_fields(load_case("li-ma-2019"), ["machine.engagement=5 mm:12 mm"])[0]
    >>> value_words(FittedParameter(field, 0.00804, 0.00002, 0.008, 0.00808))
    '8.04 ± 0.02 mm'
    """
    axis = one.field.axis
    if not one.determined:
        return f"{axis.shown(one.value):.4g} {axis.unit}".strip() + " (not determined)"
    error = float(axis.shown(one.standard_error))
    decimals = min(max(1 - math.floor(math.log10(error)), 0), 12) if error > 0.0 else 6
    texts = f"{axis.shown(one.value):.{decimals}f}", f"{error:.{decimals}f}"
    if all("." in text and text.endswith("0") for text in texts):
        texts = texts[0][:-1].rstrip("."), texts[1][:-1].rstrip(".")
    return f"{texts[0]} ± {texts[1]} {axis.unit}".strip()


def combination_words(study: FitStudy, group: Sequence[int]) -> str:
    """Say what the data determine of fields that they do not determine each."""
    fields = [study.parameters[k].field for k in group]
    if len(group) == 1:
        return f"the data do not determine {fields[0].path}"
    found = study.solved.estimate
    projector = (found.undetermined @ found.undetermined.T)[np.ix_(group, group)]
    values, vectors = np.linalg.eigh(projector)
    names = listed([field.path for field in fields])
    if np.count_nonzero(values > 0.5) > 1 or not all(field.log for field in fields):
        return f"the data do not determine {names}, each of which makes good for others"
    moves = vectors[:, -1] * [field.width for field in fields]  # logarithms that go together without a change
    if len(group) == 2:
        power = -float(moves[0] / moves[1])
        mark = f"^{abs(power):.3g}" if abs(abs(power) - 1.0) > WHOLE_POWER else ""
        gains = np.array([fields[0].width, power * fields[1].width])
        error = math.sqrt(float(gains @ found.covariance[np.ix_(group, group)] @ gains))
        one, other = fields[0].path, f"{fields[1].path}{mark}"
        return (
            f"the data fix {one} {'×' if power > 0.0 else '/'} {other} (to {percent(error, 2)}), not {one} and "
            f"{fields[1].path}"
        )
    moves = moves / moves[int(np.argmax(np.abs(moves)))]
    together = ", ".join(f"{field.path} by {move:+.3g} %" for field, move in zip(fields, moves, strict=True))
    return f"the data do not determine {names}: moved together ({together}) they change nothing"


def separating_words(study: FitStudy, group: Sequence[int]) -> str:
    """Say which measurement would determine fields that the data do not."""
    paths = tuple(study.parameters[k].field.path for k in group)
    best = next((one for one in study.separating if one.group == paths), None)
    if best is None:
        return "no other number of the blow would" + (" tell them apart" if len(group) > 1 else "")
    errors = [
        f"{path} to {percent(error * study.parameters[k].field.width, 1)}"
        for path, error, k in zip(paths, best.errors, group, strict=True)
        if study.parameters[k].field.log
    ]
    return f"{best.number} measured to 1 % would" + (f" ({listed(errors)})" if errors else "")


@compiling_shown()
def fit(
    case: Case,
    to: Sequence[str] = (),
    free: Sequence[str] = (),
    *,
    tries: str = "",
    check_on: Sequence[str] = (),
    reading: SourceOptions | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> FitStudy:
    """Fit values of a case to measurements.

    Parameters
    ----------
    case : Case
        Of a machine, a layered bar, or elements; the search begins at its values.
    to : sequence of str, optional
        Records and numbers, as ``--to`` takes them; the published numbers that the case was fitted to by default.
    free : sequence of str, optional
        Fields, ``path`` or ``path=low:high``; those marked as fitted by default.
    tries : str, optional
        Choices of a field that are fitted each, ``law=palmgren,johnson``: the one is kept that predicts best.
    check_on : sequence of str, optional
        Records and numbers that are kept out, and predicted.
    reading : SourceOptions, optional
        How records are read.
    progress : callable, optional
        Called with the number of runs, and the smallest sum of squares so far.

    Raises
    ------
    InputError, InputErrors, StrikewaveError
        If a record cannot be read, a field is none, or the case cannot be run.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("jesd22-b111-b", ["contact.reference_force=700 kN"])
    >>> study = fit(case, ["first.rigid_peak=1500 g +- 1 %"], ["contact.reference_force"])
    >>> round(study.parameters[0].standard_error / study.parameters[0].value, 3)
    0.02
    """
    reading = reading or SourceOptions()
    if not tries:
        return _fit(case, to, free, check_on, reading, progress)
    studies, rows = dict[str, FitStudy](), list[TriedChoice]()
    for change in read_tries(case, tries):
        try:
            studies[change] = _fit(changed_case(case, [change]), to, free, check_on, reading, progress)
            rows.append(tried(change, studies[change].solved))
        except StrikewaveError as error:
            rows.append(TriedChoice(change, failure=str(error).partition("\n")[0]))
    rows.sort(key=lambda row: row.rank)
    if rows[0].failure:
        raise InputError("--try", rows[0].choice, "a choice that can be fitted", rows[0].failure)
    return dataclasses.replace(studies[rows[0].choice], tries=tuple(rows))


def _fit(
    case: Case,
    to: Sequence[str],
    free: Sequence[str],
    check_on: Sequence[str],
    reading: SourceOptions,
    progress: Callable[[int, float], None] | None,
) -> FitStudy:
    """Return the fit of one case."""
    fields = free_fields(case, free)
    targets = [parse_target(word, case) for word in target_words(to)] or published_targets(case)
    if not targets:
        hint = 'such as --to shot.csv or --to first.rigid_peak="4000 g"'
        raise InputError("--to", "none", "a record or a number: the case holds none that it was fitted to", hint)
    read = read_targets("--to", case, targets, fields, reading)
    kept_out = read_targets(
        "--check-on", case, [parse_target(word, case) for word in target_words(check_on)], fields, reading
    )
    study = fitted_study(case, fields, read, targets, progress)
    if not check_on:
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
    problem = Problem(read.experiments, fields)
    solved = solve(problem, progress)
    found = solved.estimate
    fields = problem.fields
    parameters = tuple(_parameter(solved, k, field) for k, field in enumerate(fields))
    aside = [change.partition("=")[0].strip() for one in targets for change in one.changes]
    sensors = any("sensor" in one.left for one in targets) or any(
        pulse.part.partition(".")[0] in {sensor.name for sensor in case.sensor} for pulse in read.pulses
    )
    to = FittedTo(_words(targets), _digests(read.paths), tuple(dict.fromkeys(aside)), sensors)
    runs = solved.problem.runs(found.place)
    study = FitStudy(
        base=case,
        case=fitted_case(case, fields, found, to),
        solved=solved,
        parameters=parameters,
        pulses=tuple(_laid(solved.problem, runs)),
        computed=_computed(solved.problem, runs),
        separating=tuple(separating(solved)),
        citations=("liang-zeger-1986", "raue-2009"),
    )
    return dataclasses.replace(study, notices=(*_notices(study), *read.notices))


def _digests(paths: Sequence[Path]) -> dict[str, str]:
    return {Path(path).name: digest for path, digest in digests_of(paths).items()}


def _words(targets: Sequence[Target]) -> str:
    """Return what a case is fitted to, in words."""
    words = [
        f"{one.left.replace('.', ' ').replace('_', ' ')} {one.right}" if one.is_number else Path(one.right).name
        for one in targets
    ]
    words = list(dict.fromkeys(words))
    more = f" and {len(words) - MOST_NAMED} more" if len(words) > MOST_NAMED else ""
    return ", ".join(words[:MOST_NAMED]) + more


def _laid(problem: Problem, runs: Sequence[Simulation]) -> list[tuple[MeasuredPulse, LaidPulse]]:
    return [
        (one, one.laid(run))
        for experiment, run in zip(problem.experiments, runs, strict=True)
        for one in experiment.measured
        if isinstance(one, MeasuredPulse)
    ]


def _computed(problem: Problem, runs: Sequence[Simulation]) -> tuple[float, ...]:
    return tuple(
        float(run.number(one.name, one.sensor) or math.nan)
        for experiment, run in zip(problem.experiments, runs, strict=True)
        for one in experiment.measured
        if isinstance(one, MeasuredNumber)
    )


def _parameter(solved: Solved, k: int, field: FreeField) -> FittedParameter:
    """Return a fitted value with its interval: that of the profile where the misfit is no parabola."""
    found = solved.estimate
    place, error = float(found.place[k]), float(found.errors[k])
    value = field.si(place)
    if not math.isfinite(error):
        return FittedParameter(field, value, math.inf, field.low, field.high)
    followed = None
    if not solved.stopped and not found.groups() and not is_quadratic(solved.search, found, k):
        followed = profile(solved.search, found, k)
    low, high = (place - found.reach * error, place + found.reach * error) if followed is None else followed[:2]
    ends = field.si(max(low, 0.0)), field.si(min(high, 1.0))
    return FittedParameter(field, value, field.error(value, error), *ends, followed)


def _notices(study: FitStudy) -> list[Notice]:
    """Return what the user should know of a fit."""
    found, notices = study.solved.estimate, list[Notice]()
    if study.solved.stopped:
        notices.append(Notice("stopped", "stopped: the best so far; fit fitted.toml to go on", severity=FAILED))
    for group in found.groups():
        words = f"{combination_words(study, group)}; {separating_words(study, group)}"
        notices.append(Notice("not-determined", words, float(len(group)), 0.0))
    broken = [one for one in study.solved.misfits if one.more_than_noise]
    if broken:
        worst = max(broken, key=lambda one: one.size)
        known = "times its noise" if worst.noise_known else "times 1e-4 of its peak, for it shows no noise"
        others = f" (the worst of {len(broken)} records)" if len(broken) > 1 else ""
        message = (
            f"the residual of {worst.called} is not noise{others}: its RMS is {percent(worst.share, 1)} of the peak, "
            f"{worst.size:.3g} {known}; the model lacks something, and standard errors are those of what is left"
        )
        notices.append(Notice("residual-not-noise", message, worst.size, 1.0))
    missed = [one for one in study.solved.misfits if one.is_number and one.size > MET]
    if missed:
        worst = max(missed, key=lambda one: one.size)
        others = f" (the worst of {len(missed)} of {len(study.numbers)} numbers)" if len(missed) > 1 else ""
        message = (
            f"{worst.called} is missed by {worst.size:.2g} times its uncertainty, {percent(worst.share, 1)}{others}"
        )
        notices.append(Notice("not-met", message, worst.size, MET))
    for value, at in zip(study.parameters, found.place, strict=True):
        if min(at, 1.0 - at) < AT_BOUND:
            message = f"{value.field.path} stands at a bound, {value_words(value)}: its best value may lie beyond"
            notices.append(Notice("at-bound", message, value.value))
    for place in study.solved.others:
        words = ", ".join(
            f"{value.field.path} = {value.field.shown(value.field.si(float(at)), 4)}"
            for value, at in zip(study.parameters, place, strict=True)
        )
        notices.append(Notice("another-solution", f"another solution fits as well: {words}; bounds or a record decide"))
    size = len(study.parameters)
    for a in range(size):
        for b in range(a):
            share = study.correlation[a, b]
            both = study.parameters[a], study.parameters[b]
            if abs(share) > ALIKE and all(one.determined for one in both):
                message = (
                    f"{both[1].field.path} and {both[0].field.path} are known together only (correlation {share:+.3f})"
                )
                notices.append(Notice("correlated", message, abs(float(share)), ALIKE, INFO))
    return notices
