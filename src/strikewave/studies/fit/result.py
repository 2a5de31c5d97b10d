"""The result of a fit: values with errors, combinations that are not determined, predictions, notices; its files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import QUANTITIES
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, GivenUnits, Quantity
from strikewave.base.result import FAILED, INFO, Notice
from strikewave.base.shock_quantities import RATIO, SHARE, usual_unit
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case, dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Tag
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.studies.fit.checking import OF_NUMBER, Checks, TriedChoice
from strikewave.studies.fit.covariance import Excess
from strikewave.studies.fit.estimation import ProfileEnds
from strikewave.studies.fit.free_fields import FreeField
from strikewave.studies.fit.measured import LaidPulse, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.posterior import ENOUGH, LONG, Posterior
from strikewave.studies.fit.problem import NO_MORE_UNIT, Misfit, SeparatingNumber, Solved

Array = NDArray[np.float64]

KEPT_DRAWS = 2000  # draws of a posterior that are written: as many as are independent at least
WHOLE_POWER = 5e-3  # difference of a power from 1 below which it is not written: slopes know it no better
OF_FIELD = Quantity.of_data("as the field", digits=5)


@declare.dataclass
class FittedParameter:
    """A fitted value, SI.

    Beside what documents have:

    Attributes
    ----------
    field : FreeField
        Fitted field.
    standard_error : float
        SI; infinite where the data do not determine it.
    profile : ProfileEnds or None
        Ends of the interval by the profile of the misfit, where that is no parabola.
    stair : float
        Step of the value that first changes the run, SI; 0 where the run changes smoothly.
    """

    field: FreeField
    name = declare.computed(declare.word("path of the value", key="field", label="field", column=KEY))(
        lambda parameter: parameter.field.path
    )
    unit = declare.computed(declare.word("its SI unit"))(lambda parameter: parameter.field.axis.si_unit or NO_UNIT)
    value: float = declare.number(OF_FIELD, "fitted value")
    standard_error: float
    known_error = declare.computed(
        declare.number(OF_FIELD, "of it; null where the data do not determine it", key="standard_error")
    )(lambda parameter: parameter.standard_error if parameter.determined else None)
    low: float = declare.number(OF_FIELD, "low end of its 95 % interval")
    high: float = declare.number(OF_FIELD, "high end of its 95 % interval")
    profile: ProfileEnds | None = None
    stair: float = 0.0
    start = declare.computed(declare.number(OF_FIELD, "value of the case", label="began at", column=MORE, order=1))(
        lambda parameter: parameter.field.value.si
    )
    bounds = declare.computed(declare.history(OF_FIELD, "[low, high] within which it was sought"))(
        lambda parameter: (parameter.field.low, parameter.field.high)
    )
    interval = declare.computed(
        declare.word("what the interval rests on: quadratic, profile, or bounds where it is not determined")
    )(
        lambda parameter: (
            "profile" if parameter.profile is not None else "quadratic" if parameter.determined else "bounds"
        )
    )
    reach: float | None = declare.number(
        Quantity.of_data("standard errors"), "standard errors that 95 % lie within, to either side", default=None
    )

    @property
    def determined(self) -> bool:
        """True if the data determine it."""
        return math.isfinite(self.standard_error)

    @property
    def given_units(self) -> GivenUnits:
        """Unit in which the field was typed."""
        return {OF_FIELD.given_by: (self.unit, self.field.axis.unit or NO_UNIT)}

    @declare.phrase("value ± standard error", column=KEY, headline="{name}")
    def words(self) -> str:
        """Return the value with its standard error, in the unit in which it was typed."""
        axis, unit = self.field.axis, self.field.axis.shown_unit
        if not self.determined:
            return f"{axis.shown(self.value):.4g} {unit}".strip() + " (not determined)"
        error = float(axis.shown(self.standard_error))
        decimals = min(max(1 - math.floor(math.log10(error)), 0), 12) if error > 0.0 else 6
        texts = f"{axis.shown(self.value):.{decimals}f}", f"{error:.{decimals}f}"
        if all("." in text and text.endswith("0") for text in texts):
            texts = texts[0][:-1].rstrip("."), texts[1][:-1].rstrip(".")
        return f"{texts[0]} ± {texts[1]} {unit}".strip()

    interval_words = declare.phrase("95 % interval", column=MAIN)(
        lambda parameter: (
            parameter.field.between(parameter.low, parameter.high) + ("" if parameter.determined else " (bounds)")
        )
    )

    @declare.phrase("interval from", column=MORE)
    def state(self) -> Tag:
        """Return what the interval rests on, in its box."""
        if not self.determined:
            return Tag("not determined", "warned")
        return Tag("profile" if self.profile is not None else "parabola", "good")


@declare.dataclass
class PosteriorValue:
    """A fitted value with the median and the 95 % interval of its posterior, SI."""

    value: FittedParameter
    name = declare.computed(declare.word("path of the value", key="field", label="field", column=KEY))(
        lambda value: value.value.name
    )
    median: float = declare.number(OF_FIELD, "median", column=KEY)
    low: float = declare.number(OF_FIELD, "low end of its 95 % interval")
    high: float = declare.number(OF_FIELD, "high end of its 95 % interval")

    @property
    def given_units(self) -> GivenUnits:
        """Unit in which the field was typed."""
        return self.value.given_units

    interval_words = declare.phrase("95 % of the posterior", column=KEY)(
        lambda value: value.value.field.between(value.low, value.high)
    )
    fitted_words = declare.phrase("least squares", column=MORE)(
        lambda value: value.value.field.shown(value.value.value)
    )
    fitted_interval = declare.phrase("95 % of least squares", column=MAIN)(lambda value: value.value.interval_words)


@declare.dataclass
class SampledValues:
    """Values by their posterior, and how that was sampled."""

    parameters: list[PosteriorValue] = declare.rows(PosteriorValue, "median and 95 % interval of each value")
    posterior: Posterior = declare.part(Posterior, "of the sampling", inline=True)


@declare.dataclass
class MisfitOfRun:
    """Residual of a measurement, and the verdict of the fitted run that it is compared with."""

    given_units: ClassVar[GivenUnits] = NO_MORE_UNIT

    misfit: Misfit = declare.part(Misfit, "what is left", inline=True)
    verdict: str = declare.word(
        "what the checks of the fitted run came to that it is held against", label="verdict of the run", column=MAIN
    )


@declare.dataclass
class MisfitOfAll:
    """Residuals of all measurements."""

    chi_squared: float = declare.number(RATIO, "sum of squares of the residuals over their noise")
    residuals: int = declare.count("how many residuals")
    excess: Excess = declare.part(Excess, "by how much numbers are off beyond their uncertainties")
    shots: int = declare.count("how many shots")
    measured: list[MisfitOfRun] = declare.rows(MisfitOfRun, "what is left of each measured thing")


@declare.dataclass
class FittedNumber:
    """A stated number, and what the fitted case gives of it."""

    number: str = declare.word("name of a stated number")
    unit: str = declare.word("its SI unit")
    measured: float = declare.number(OF_NUMBER, "as stated")
    uncertainty: float = declare.number(OF_NUMBER, "standard uncertainty as stated")
    computed: float = declare.number(OF_NUMBER, "of the fitted case")


@declare.dataclass(eq=False)
class FitStudy(AskedResult):
    """A fitted case; see `fit`, and `Result` for what it shares with others.

    Beside what documents have:

    Attributes
    ----------
    base : Case
        Case that was fitted.
    case : Case
        With the fitted values.
    solved : Solved
        The best place, and what the data say of it.
    pulses : tuple of (MeasuredPulse, LaidPulse)
        The records, each with the fitted run laid on it.
    computed : tuple of float
        Values of the stated numbers in the fitted case, SI.
    posterior : Posterior or None
        Draws of the values, where they were asked for.
    bands : tuple of (ndarray, ndarray)
        Ends of the 95 % predictive band of the first ``pulses``, on their samples, SI.
    """

    command: ClassVar[str] = "fit"
    main_rows: ClassVar[str] = "parameters"
    written: ClassVar[tuple[str, ...]] = ("field", "unit", "value", "standard_error", "low", "high")

    base: Case
    case: Case
    solved: Solved
    case_name = declare.computed(declare.word("name of the case", key="case"))(lambda study: study.base.name)
    parameters: tuple[FittedParameter, ...] = declare.rows(FittedParameter, "fitted values", headline="each")
    pulses: tuple[tuple[MeasuredPulse, LaidPulse], ...]
    computed: tuple[float, ...]

    @declare.computed(declare.history(RATIO, "correlation of the values, a row each"))
    def correlation(self) -> Array:
        """Correlation of the values; NaN of one that is not determined."""
        found = self.solved.estimate
        sizes = np.where(np.isfinite(found.errors), found.errors, np.nan)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(found.covariance / np.outer(sizes, sizes))

    @declare.computed(
        declare.word("fields that the data do not determine, those together of which only a combination is")
    )
    def undetermined(self) -> list[list[str]]:
        """Fields that the data do not determine, grouped where only a combination is determined."""
        return [[self.parameters[k].name for k in group] for group in self.solved.estimate.groups()]

    @declare.computed(declare.word("what is determined of these, in words"))
    def combinations(self) -> list[str]:
        """Combinations of these that are determined, in words."""
        return [combination_words(self, group) for group in self.solved.estimate.groups()]

    separating: tuple[SeparatingNumber, ...] = declare.rows(
        SeparatingNumber, "numbers that would tell them apart, the best first", default=()
    )

    @declare.computed(declare.part(MisfitOfAll, "what is left of all that was measured"))
    def misfit(self) -> MisfitOfAll:
        """Residuals of all measurements."""
        found, problem = self.solved.estimate, self.solved.problem
        measured = [MisfitOfRun(*pair) for pair in zip(self.solved.misfits, self.verdicts_of_measured(), strict=True)]
        return MisfitOfAll(found.misfit, int(found.residuals.size), problem.excess, problem.shot_count, measured)

    @declare.computed(declare.number(SHARE, "largest share", headline="largest RMS residual", in_document=False))
    def worst_share(self) -> float:
        """Root mean square residual over the peak, or the number, of what is farthest off."""
        return max(misfit.share for misfit in self.solved.misfits)

    @declare.computed(declare.rows(FittedNumber, "stated numbers", key="numbers"))
    def fitted_numbers(self) -> list[FittedNumber]:
        """The stated numbers, each with what the fitted case gives of it."""
        pairs = zip(self.numbers, self.computed, strict=True)
        return [FittedNumber(n.called, n.unit or NO_UNIT, n.value, n.uncertainty, found) for n, found in pairs]

    tries: tuple[TriedChoice, ...] = declare.rows(
        TriedChoice, "by the option try: the choices, and how well each fits", default=()
    )
    posterior: Posterior | None = None
    sampled = declare.computed(
        declare.part(SampledValues, "by the option bayes: the values by their posterior", key="posterior")
    )(lambda study: None if study.posterior is None else SampledValues(study.posterior_values(), study.posterior))
    checks: Checks | None = declare.part(
        Checks, "by the option check-on: predictions of what was kept out", default=None
    )
    bands: tuple[tuple[Array, Array], ...] = ()

    @declare.computed(declare.word("other values that fit as well, by their paths"))
    def other_solutions(self) -> list[dict[str, float]]:
        """Other values that fit as well, by their paths."""
        return [
            {
                parameter.name: parameter.field.si(float(at))
                for parameter, at in zip(self.parameters, place, strict=True)
            }
            for place in self.solved.others
        ]

    runs = declare.computed(declare.count("runs that it took"))(lambda study: study.solved.runs)
    stopped = declare.computed(declare.word("whether the search was stopped before its end"))(
        lambda study: study.solved.stopped
    )

    @property
    def title(self) -> str:
        """Name of the case and number of measurements."""
        count = len(self.solved.problem.measured)
        return f"{self.base.name or 'case'} fitted to {count} measurement{'s' if count > 1 else ''}"

    @property
    def numbers(self) -> list[MeasuredNumber]:
        """The stated numbers."""
        return [datum for datum in self.solved.problem.measured if isinstance(datum, MeasuredNumber)]

    def verdicts_of_measured(self) -> list[str]:
        """Return the verdict of the fitted run of each measured thing, in the order of the misfits."""
        problem = self.solved.problem
        return [text for _, text in problem.with_runs(self.verdicts.texts or ("",) * len(problem.experiments))]

    def posterior_values(self) -> list[PosteriorValue]:
        """Return median and 95 % interval of each value, SI; none where no posterior was sampled."""
        if self.posterior is None:
            return []
        places = [self.posterior.quantiles(share) for share in (0.5, 0.025, 0.975)]
        return [
            PosteriorValue(parameter, *(parameter.field.si(float(place[k])) for place in places))
            for k, parameter in enumerate(self.parameters)
        ]

    def texts(self) -> dict[str, str]:
        """Return the fitted case, and the JSON document."""
        return {"fitted.toml": dump_case(self.case), "fit.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return the values, and record and fitted run over time, as CSV text."""
        tables = {"parameters.csv": csv_table(self.columns())}
        if self.posterior is not None:
            draws = np.array(self.posterior.some(KEPT_DRAWS)).T
            rows = [
                Column(
                    parameter.field.path,
                    [parameter.field.si(float(place)) for place in places],
                    parameter.field.axis.si_unit or "1",
                )
                for parameter, places in zip(self.parameters, draws, strict=True)
            ]
            tables["posterior.csv"] = csv_table(rows)
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

    def preview(self) -> Curve | None:
        """Return the residual of the first record."""
        if not self.pulses:
            return None
        pulse, laid = self.pulses[0]
        words = f"residual of the {QUANTITIES.get(pulse.unit, 'value')}"
        return history_curve(laid.time, laid.computed - laid.measured, pulse.unit, usual_unit(pulse.unit), words)


def combination_words(study: FitStudy, group: Sequence[int]) -> str:
    """Return the sentence on the determined combination of fields that are not determined each."""
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
    """Return the sentence on a measurement that would determine the fields."""
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


NOT_SAMPLED = Notice("not-sampled", "stopped before the posterior was sampled: intervals are those of least squares")
MET = 2.0  # standard uncertainties of a number within which the fit meets it: 95 %
AT_BOUND = 1e-4  # distance from a bound, over the width of the bounds, at which a value stands at it
ON_STAIRS = 0.5
"""Steps in which a value moves the run, over its standard error, beyond which they are a good part of it."""
ALIKE = 0.98  # correlation of two values beyond which the report says that they are known together far better than each


def posterior_notices(posterior: Posterior) -> list[Notice]:
    """Return the notice on chains of a posterior that are too short."""
    if not posterior.too_short:
        return []
    why = "stopped: " if posterior.stopped else ""
    message = (
        f"{why}chains of {posterior.steps} steps are too short for an autocorrelation time of "
        f"{plain(posterior.memory)} "
        f"steps: about {posterior.independent:.0f} independent draws, {ENOUGH:.0f} and {LONG:.0f} times that are "
        "needed; ends of its intervals may be off"
    )
    return [Notice("chains-too-short", message, posterior.steps / posterior.memory, LONG)]


def held_notices(case: Case) -> list[Notice]:
    """Return the notice on values of an earlier fit that are held at changed values."""
    values = case.values()
    paths = dict.fromkeys(path for fit in case.fit for path in fit.fields if path in values)
    held = [path for path in paths if values[path].provenance != "fitted"]
    if not held:
        return []
    words = (
        "is held as it was set, though it was fitted before"
        if len(held) == 1
        else "are held as set, though fitted before"
    )
    message = f"{listed(held)} {words}: name every field to fit by --free"
    return [Notice("held", message, float(len(held)), 0.0)]


def fit_notices(study: FitStudy) -> list[Notice]:
    """Return the notices of a fit: on its end, undetermined fields, records, numbers, values and pairs of values."""
    solved, problem, values = study.solved, study.solved.problem, study.parameters
    notices = list[Notice]()
    if solved.stopped:
        notices.append(Notice("stopped", "stopped: the best so far; fit fitted.toml to go on", severity=FAILED))
    for group in solved.estimate.groups():
        words = f"{combination_words(study, group)}; {separating_words(study, group)}"
        notices.append(Notice("not-determined", words, float(len(group)), 0.0))

    broken = [misfit for misfit in solved.misfits if misfit.more_than_noise and not misfit.scatters]
    if broken:
        worst = max(broken, key=lambda misfit: misfit.size)
        known = "times its noise" if worst.noise_known else "times 1e-4 of its peak, for it shows no noise"
        others = f" (the worst of {len(broken)} records)" if len(broken) > 1 else ""
        message = (
            f"the residual of {worst.called} is not noise{others}: its RMS is {percent(worst.share, 1)} of the peak, "
            f"{plain(worst.size)} {known}; the model lacks something, and standard errors are those of what is left"
        )
        notices.append(Notice("residual-not-noise", message, worst.size, 1.0))
    apart = [misfit for misfit in solved.misfits if misfit.scatters]
    if apart:
        worst = max(apart, key=lambda misfit: misfit.size)
        message = (
            f"{len(apart)} of {len(study.pulses)} records differ by more than noise, {worst.called} by "
            f"{percent(worst.share, 1)} of the peak (RMS), and each can be fitted alone: the shots scatter, and "
            "standard errors hold that"
        )
        notices.append(Notice("shots-scatter", message, worst.size, 1.0, INFO))

    excess = problem.excess
    if excess.between:
        repeats = " and repeats" if len({number.called for number in study.numbers}) < len(study.numbers) else ""
        shares = [excess.between * one.uncertainty / abs(one.value) for one in study.numbers if not one.of_field]
        message = (
            f"the numbers are off by {percent(float(np.median(shares)), 1)} (standard deviation) from setting to "
            f"setting, beyond what their uncertainties{repeats} explain: the model lacks something, and standard "
            "errors and predictions hold that"
        )
        notices.append(Notice("lack-of-fit", message, excess.between, 0.0))
    missed = [misfit for misfit in solved.misfits if misfit.is_number and misfit.size > MET]
    if missed:
        worst = max(missed, key=lambda misfit: misfit.size)
        others = f" (the worst of {len(missed)} of {len(study.numbers)} numbers)" if len(missed) > 1 else ""
        size = plain(worst.size, 2)
        message = f"{worst.called} is missed by {size} times its uncertainty, {percent(worst.share, 1)}{others}"
        notices.append(Notice("not-met", message, worst.size, MET))

    for value, at in zip(values, solved.estimate.place, strict=True):
        if min(at, 1.0 - at) < AT_BOUND:
            message = f"{value.field.path} stands at a bound, {value.words}: its best value may lie beyond"
            notices.append(Notice("at-bound", message, value.value))
    for value in values:
        if value.stair > ON_STAIRS * value.standard_error and value.determined:
            message = (
                f"{value.field.path} moves the run in steps of {value.field.shown(value.stair, 2)}, those of waves "
                "through its layer: it cannot be known better; a smaller solver.step makes them finer"
            )
            notices.append(Notice("on-stairs", message, value.stair, ON_STAIRS * value.standard_error))
    for place in solved.others:
        pairs = [(value.field, value.field.si(float(at))) for value, at in zip(values, place, strict=True)]
        words = ", ".join(f"{field.path} = {field.shown(si, 4)}" for field, si in pairs)
        notices.append(Notice("another-solution", f"another solution fits as well: {words}; bounds or a record decide"))
    for a, later in enumerate(values):
        for b, earlier in enumerate(values[:a]):
            share = float(study.correlation[a, b])
            if abs(share) > ALIKE and earlier.determined and later.determined:
                message = (
                    f"{earlier.field.path} and {later.field.path} are known together only (correlation {share:+.3f})"
                )
                notices.append(Notice("correlated", message, abs(share), ALIKE, INFO))
    return notices
