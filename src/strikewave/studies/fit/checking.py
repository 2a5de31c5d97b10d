"""A fitted case judged on what was kept out; several laws fitted to the same data, and which predicts best."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import FIGURES, ComparedCurve, CurveAgreement, agreement
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, NOT_MEASURED, GivenUnits, Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.base.shock_quantities import OF_FIGURE, RATIO, SCORE, usual_unit
from strikewave.cases.case import Case
from strikewave.reporting.numbers import shown, with_unit
from strikewave.reporting.parts import Tag, written
from strikewave.signal.pulse import Pulse
from strikewave.studies.fit.covariance import NORMAL, Estimate
from strikewave.studies.fit.estimation import Search, each_or_none, result_of
from strikewave.studies.fit.measured import Measured, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.problem import NO_MORE_UNIT, OVER_NOISE, Experiment, Problem, Solved
from strikewave.studies.simulation import Simulation
from strikewave.uncertainty.draws import latin_hypercube, normal_quantile

Array = NDArray[np.float64]

DRAWS = 32  # runs at drawn values for each setting: a standard deviation of so many is good to an eighth
HALVINGS = 12  # times that a drawn place is halved towards the best one at most: to 1/4000 of the bounds
CHECK_STREAM = 31  # key of the draws
OF_NUMBER = Quantity.of_data("as the number")


@declare.dataclass
class PredictedFigure:
    """A figure of a record that was kept out: measured, and predicted with its 95 % band, SI."""

    record: str = declare.word("what was measured", column=KEY)
    figure: str = declare.word("figure of it", column=KEY)
    unit: str = declare.word("its SI unit")
    measured: float = declare.number(OF_NUMBER, "as it was measured", column=MAIN)
    predicted: float = declare.number(OF_FIGURE, "as the fitted case has it", column=MAIN)
    low: float = declare.number(NOT_MEASURED, "low end of the 95 % band")
    high: float = declare.number(NOT_MEASURED, "high end of the 95 % band")

    @property
    def given_units(self) -> GivenUnits:
        """Unit of the figure."""
        return dict.fromkeys((OF_NUMBER.given_by, OF_FIGURE.given_by), (self.unit, usual_unit(self.unit)))

    @declare.phrase("95 % band", column=MORE)
    def band(self) -> str:
        """Return the ends of the band."""
        si, usual = self.unit or NO_UNIT, usual_unit(self.unit) or NO_UNIT
        return f"{written(shown(self.low, si, usual))} to {with_unit(self.high, si, usual)}"

    @declare.computed(declare.word("whether the band holds what was measured"))
    def inside(self) -> bool:
        """True if the band holds what was measured."""
        return self.low <= self.measured <= self.high

    @declare.computed(
        declare.number(
            Quantity(NO_UNIT, "%", "bias", 1, 0, signed=True),
            "by how much the prediction is above, as a share of what was measured",
            column=MAIN,
        )
    )
    def bias(self) -> float:
        """Excess of the prediction over the measurement, as a share."""
        return self.predicted / self.measured - 1.0

    held = declare.phrase("band holds it", column=MAIN)(
        lambda figure: Tag("inside", "good") if figure.inside else Tag("outside", "warned")
    )


@declare.dataclass
class PulseAgreement:
    """Agreement of the prediction of a whole pulse with the record."""

    record: str = declare.word("what was measured", column=KEY)
    overall: float = declare.number(SCORE, "overall score of ISO/TS 18571", column=MAIN)
    grade: str = declare.word("its grade in words", column=MAIN, in_document=False)
    rms: float = declare.number(
        Quantity(NO_UNIT, "%", "RMS difference", 1, 0),
        "root mean square of the difference over that of the record",
        column=MAIN,
    )


@declare.dataclass(eq=False)
class Checks:
    """Predictions of what was kept out; ``agreements`` have the prediction laid on each record."""

    @declare.computed(declare.count("how many bands hold what was measured"))
    def inside(self) -> int:
        """Number of bands that hold the measurement."""
        return sum(figure.inside for figure in self.figures)

    figures: tuple[PredictedFigure, ...] = declare.rows(
        PredictedFigure, "peaks, widths, velocity changes or impulses, and numbers"
    )
    agreements: tuple[tuple[str, CurveAgreement], ...]

    @declare.computed(declare.number(RATIO, "mean bias of each figure", key="bias"))
    def biases(self) -> dict[str, float]:
        """Mean bias of each figure."""
        names = dict.fromkeys(figure.figure for figure in self.figures)
        return {name: float(np.mean([one.bias for one in self.figures if one.figure == name])) for name in names}

    @declare.computed(declare.rows(PulseAgreement, "whole pulses, by ISO/TS 18571", key="iso18571"))
    def pulses(self) -> list[PulseAgreement]:
        """The prediction of each whole pulse beside the record."""
        return [
            PulseAgreement(name, found.rating.overall, found.rating.grade, found.rms) for name, found in self.agreements
        ]


def check(solved: Solved, experiments: Sequence[Experiment]) -> Checks:
    """Predict the measurements that were kept out.

    The band of a figure has the values drawn from the fit (as far as the data allow where they are not determined),
    what the same figure was off in the records of the fit, root mean square, and the noise of the record itself.
    """
    problem, found = solved.problem, solved.estimate
    drawn = drawn_places(found)
    places = [found.place, *(allowed_places(solved, drawn) if found.undetermined.size else drawn)]
    left = _left_over(problem, found.place)
    kept_out = Problem(experiments, problem.fields)
    runs = each_or_none(functools.partial(_predicted, kept_out), places)
    nominal = runs[0]
    assert nominal is not None
    draws = [run for run in runs[1:] if run is not None]
    figures, agreements, place = list[PredictedFigure](), list[tuple[str, CurveAgreement]](), 0
    for datum, run in kept_out.with_runs(kept_out.runs(found.place)):
        if isinstance(datum, MeasuredPulse):
            curve = run.history(datum.part, datum.blow, datum.unit).filtered(datum.low_pass)
            agreements.append((datum.called, agreement(datum.record, curve, "correlation")))
        for name, unit, measured, doubt in _figures(datum):
            predicted, values = nominal[place], [draw[place] for draw in draws]
            off = np.array(values) / predicted - 1.0  # about the prediction: draws may lie to one side of it
            spread = math.sqrt(float(np.mean(off**2))) if len(values) > 1 else 0.0
            shares = found.widest * spread, left.get(_kind(datum, name), 0.0), NORMAL * doubt / abs(measured)
            half = abs(predicted) * math.hypot(*shares)
            ends = predicted - half, predicted + half
            figures.append(PredictedFigure(datum.called, name, unit, measured, predicted, *ends))
            place += 1
    return Checks(tuple(figures), tuple(agreements))


def drawn_places(found: Estimate) -> list[Array]:
    """Return places drawn from a fit: normal where it determines them, even over the cube where it does not."""
    size, lost = found.place.size, found.undetermined
    quantiles = latin_hypercube(size + lost.shape[1], DRAWS, stream=CHECK_STREAM)
    values, vectors = np.linalg.eigh(found.covariance)
    factor = vectors * np.sqrt(np.maximum(values, 0.0))
    places = []
    for row in quantiles:
        place = np.clip(found.place + factor @ normal_quantile(row[:size]), 0.0, 1.0)
        for direction, share in zip(lost.T, row[size:], strict=True):
            with np.errstate(divide="ignore", invalid="ignore"):
                ends = np.array([(0.0 - place) / direction, (1.0 - place) / direction])
            ends = ends[:, np.abs(direction) > 1e-9]
            low, high = float(np.max(np.min(ends, axis=0))), float(np.min(np.max(ends, axis=0)))
            place = np.clip(place + (low + share * (high - low)) * direction, 0.0, 1.0)
        places.append(place)
    return places


def allowed_places(solved: Solved, places: Sequence[Array]) -> list[Array]:
    """Return drawn places, those that fit worse than 95 % may halved towards the best until they do not.

    A direction that is not determined is flat near the best place alone: far along it most places fit nothing. What
    one standard deviation of the determined directions adds to the misfit counts as one.
    """
    from scipy.special import chdtri

    found, size = solved.estimate, solved.estimate.place.size
    known = size - found.undetermined.shape[1]
    alone = float(np.sum((found.jacobian.T @ found.jacobian) * found.covariance))
    per = max(alone / known, 1.0) if known else 1.0
    limit = found.misfit + per * float(chdtri(size, 0.05)) * (found.widest / NORMAL) ** 2
    kept, left = [np.asarray(place) for place in places], list(range(len(places)))
    for _ in range(HALVINGS):
        residuals = each_or_none(solved.problem.residuals, [kept[k] for k in left])
        left = [
            k
            for k, residual in zip(left, residuals, strict=True)
            if residual is None or float(residual @ residual) > limit
        ]
        if not left:
            break
        for k in left:
            kept[k] = found.place + 0.5 * (kept[k] - found.place)
    return kept


def _predicted(problem: Problem, place: Array) -> list[float]:
    """Return all figures of a run at a place."""
    return [value for datum, run in problem.with_runs(problem.runs(place)) for value in _computed(datum, run)]


def _computed(one: MeasuredNumber | MeasuredPulse, run: Simulation) -> list[float]:
    if isinstance(one, MeasuredNumber):
        return [one.computed(run)]
    curve = run.history(one.part, one.blow, one.unit).filtered(one.low_pass)
    return [float(getattr(_as_sampled(curve, one).pulse, key)) for _, key in names_of(one.unit)]


def _as_sampled(curve: ComparedCurve, one: MeasuredPulse) -> ComparedCurve:
    """Return a history of a run with no more than samples of the record can hold."""
    return curve if one.record.history.step <= curve.history.step else one.band_limited(curve)


def _figures(one: MeasuredNumber | MeasuredPulse) -> list[tuple[str, str, float, float]]:
    """Return name, unit, value and standard uncertainty of each figure that was measured.

    A stated scatter is one of the amplitude: of the peak, and of the area with it.
    """
    if isinstance(one, MeasuredNumber):
        return [(one.called, one.unit, one.value, one.uncertainty)]
    pulse: Pulse = one.record.pulse
    doubts = {FIGURES[key]: value for key, value in one.record.uncertainty.items() if math.isfinite(value)}
    units = {"peak": one.unit, "width": "s", "area": {"m/s^2": "m/s", "N": "N s"}.get(one.unit, "")}
    found = []
    for name, key in names_of(one.unit):
        value = float(getattr(pulse, key))
        scatter = 0.0 if key == "width" else one.scatter * abs(value)
        found.append((name, units[key], value, math.hypot(doubts.get(key, 0.0), scatter)))
    return found


def _kind(one: MeasuredNumber | MeasuredPulse, name: str) -> str:
    """Return what a figure is called at any setting."""
    return f"{one.name} {one.sensor}" if isinstance(one, MeasuredNumber) else name


def names_of(unit: str) -> list[tuple[str, str]]:
    """Return the figures of a pulse, each with the name that `Pulse` gives it."""
    integral = {"m/s^2": "velocity change", "N": "impulse"}.get(unit)
    return [("peak", "peak"), ("width", "width"), *([(integral, "area")] if integral else [])]


def _left_over(problem: Problem, place: Array) -> dict[str, float]:
    """Return the 95 % error of each figure by those of the fit, as a share.

    Root mean square, with Student's t for as many; of numbers whose model lacks something, no less than one at another
    setting.
    """
    from scipy.special import stdtrit

    off, stated = dict[str, list[float]](), dict[str, list[float]]()
    for datum, run in problem.with_runs(problem.runs(place)):
        for (name, _, measured, doubt), computed in zip(_figures(datum), _computed(datum, run), strict=True):
            off.setdefault(_kind(datum, name), []).append(computed / measured - 1.0)
            if isinstance(datum, MeasuredNumber) and problem.excess.between:
                stated.setdefault(_kind(datum, name), []).append(problem.excess.of_another * doubt / measured)

    def reach(shares: Sequence[float], freedom: float) -> float:
        return float(stdtrit(freedom, 0.975)) * math.sqrt(float(np.mean(np.square(shares)))) if shares else 0.0

    return {
        name: max(reach(shares, len(shares)), reach(stated.get(name, []), problem.excess.freedom))
        for name, shares in off.items()
    }


MOST_TRIED = 20  # most choices of one field
FEWEST, FOLDS = 3, 10
"""Records, or settings of numbers, from which on choices are compared by cross-validation, and parts into which more of
them are divided."""


@declare.dataclass
class TriedChoice:
    """A choice of a field, and its residuals."""

    given_units: ClassVar[GivenUnits] = NO_MORE_UNIT

    choice: str = declare.word("as typed, path=value", column=KEY)
    misfit: float = declare.number(
        Quantity("", "", "residual over noise", digits=3),
        "root mean square of all residuals over their noise or uncertainty; null where it could not be fitted",
        default=math.nan,
        column=MAIN,
    )
    kept_out: float = declare.number(
        OVER_NOISE,
        "the same of records that each fit was without, or of the numbers of a setting; null where they are too few",
        label="of records kept out",
        default=math.nan,
        column=MAIN,
    )
    more_than_noise: int = declare.count("records of which the residual is more than noise", default=0)
    failure: str = declare.word(
        "why it could not be fitted; empty where it was", label="could not be fitted", default="", column=MORE, order=1
    )
    beyond_noise = declare.phrase("more than noise", column=MORE)(
        lambda choice: None if choice.failure else str(choice.more_than_noise)
    )

    @property
    def rank(self) -> tuple[bool, float]:
        """Key of the ranking: cross-validation where there is one, else the misfit; failures last."""
        return bool(self.failure), self.kept_out if math.isfinite(self.kept_out) else self.misfit


def read_tries(case: Case, word: str) -> list[str]:
    """Return the changes that are tried, ``path=choice`` each; ``law`` is short for ``contact.law``."""
    path, _, rest = (part.strip() for part in word.partition("="))
    known = {**case.entries(), **case.values()}
    if "." not in path:
        path = f"contact.{path}"
    if path not in known:
        raise InputError("--try", path, "a field of the case", nearest(path, known))
    choices = [part.strip() for part in rest.split(",") if part.strip()]
    if not 2 <= len(dict.fromkeys(choices)) <= MOST_TRIED:
        allowed = f"PATH=CHOICE,CHOICE with 2 to {MOST_TRIED} choices"
        raise InputError("--try", word, allowed, "such as law=palmgren,johnson")
    return [f"{path}={choice}" for choice in dict.fromkeys(choices)]


def tried(choice: str, solved: Solved) -> TriedChoice:
    """Return the residuals of a fitted choice."""
    sizes = [misfit.size for misfit in solved.misfits]
    broken = sum(one.more_than_noise for one in solved.misfits)
    return TriedChoice(choice, _mean(sizes), _kept_out(solved), broken)


def _mean(sizes: Sequence[float]) -> float:
    return math.sqrt(float(np.mean(np.square(sizes))))


def _kept_out(solved: Solved) -> float:
    """Return the root mean square residual of records, or of numbers of a setting, that each fit was without."""
    problem = solved.problem
    parts: list[list[Measured]] = [[datum] for datum in problem.measured if isinstance(datum, MeasuredPulse)]
    if not parts:
        settings = [[one for one in test.measured if not _is_known(one)] for test in problem.experiments]
        parts = [setting for setting in settings if setting]
    if len(parts) < FEWEST or solved.stopped:
        return math.nan
    sizes, folds = list[float](), min(FOLDS, len(parts))
    for fold in range(folds):
        out = [one for part in parts[fold::folds] for one in part]
        search = Search(_without(problem, out, keep=False).residuals, len(problem.fields), stairs=problem.stairs)
        search.begin(solved.estimate.place)
        place, _ = search.descend(solved.estimate.place)
        left = _without(problem, out, keep=True)
        sizes += [one.size for one in left.misfits(result_of(left.residuals, place))]
    return _mean(sizes)


def _is_known(one: Measured) -> bool:
    """Tell whether a number is one of a field, known from elsewhere."""
    return isinstance(one, MeasuredNumber) and one.of_field


def _without(problem: Problem, measured: Sequence[Measured], keep: bool) -> Problem:
    """Return a problem with what was measured here alone, or without it."""
    out = set(map(id, measured))
    experiments = [
        replace(experiment, measured=tuple(datum for datum in experiment.measured if (id(datum) in out) == keep))
        for experiment in problem.experiments
    ]
    return Problem([one for one in experiments if one.measured], problem.fields)
