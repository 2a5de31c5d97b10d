"""A fit in words and tables, for screen and page."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from strikewave.analyses.compare.curve import SHOWN_IN
from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.numbers import headed, listed, percent, shown
from strikewave.reporting.parts import NONE, Tag
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.fit.checking import Checks, PredictedFigure
from strikewave.studies.fit.notices import MET
from strikewave.studies.fit.posterior import SEED, WALKERS, Posterior
from strikewave.studies.fit.problem import Misfit
from strikewave.studies.fit.result import (
    FitStudy,
    FittedParameter,
    PosteriorValue,
    combination_words,
    value_words,
)
from strikewave.studies.fit.trying import TriedChoice

USUAL = {**SHOWN_IN, "s": "us"}
"""Unit in which a figure is shown as a rule."""
CORRELATION_TITLE = "Correlation of the values"


def fit_words(study: FitStudy) -> str:
    """Say in words what a fit comes to."""
    found = study.solved.estimate
    values = [f"{one.field.path} = {value_words(one)}" for one in study.parameters if one.determined]
    words = [f"{', '.join(values)} (standard errors)."] if values else []
    words += [f"{_capital(combination_words(study, group))}." for group in found.groups()]
    broken = [one for one in study.solved.misfits if one.more_than_noise]
    worst = max(study.solved.misfits, key=lambda one: one.share)
    missed = [one for one in study.solved.misfits if one.is_number and one.size > MET]
    if missed:
        words.append(
            f"{len(missed)} of {len(study.numbers)} numbers are missed by more than {MET:g} times their uncertainty, "
            f"by up to {percent(max(one.share for one in missed), 1)}."
        )
    if broken:
        words.append(
            f"What is left is more than noise in {len(broken)} of {len(study.pulses)} records: up to "
            f"{percent(max(one.share for one in broken), 1)} of the peak (RMS)."
        )
    if not broken and not missed:
        words.append(f"What is left is within noise or uncertainty: at most {percent(worst.share, 2)} (RMS).")
    if study.tries:
        words.insert(0, f"Of {len(study.tries)} choices, {study.tries[0].choice} {_best_by(study.tries[0])}.")
    if study.checks is not None:
        words.append(check_words(study.checks))
    if study.verdicts.words:
        words.insert(0, study.verdicts.sentence)
    return " ".join(words)


def _best_by(best: TriedChoice) -> str:
    return "predicts records that it was not fitted to best" if best.kept_out == best.kept_out else "fits best"


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]


def _between(one: FittedParameter, low: float, high: float) -> str:
    return f"{one.field.axis.shown(low):.5g} to {one.field.shown(high)}"


def _interval(one: FittedParameter) -> str:
    words = _between(one, one.low, one.high)
    return words if one.determined else f"{words} (bounds)"


def _state(one: FittedParameter) -> Tag:
    if not one.determined:
        return Tag("not determined", "warned")
    return Tag("profile", "good") if one.profile is not None else Tag("parabola", "good")


PARAMETER_COLUMNS: tuple[TableColumn[FittedParameter], ...] = (
    TableColumn("field", lambda one: one.field.path, priority=KEY, words=True),
    TableColumn("value ± standard error", value_words, priority=KEY, words=True),
    TableColumn("95 % interval", _interval, words=True),
    TableColumn("interval from", _state, priority=MORE, words=True),
    TableColumn("began at", lambda one: one.field.shown(one.field.value.si), priority=MORE, words=True),
)


POSTERIOR_TITLE = "Posterior beside least squares"
POSTERIOR_COLUMNS: tuple[TableColumn[PosteriorValue], ...] = (
    TableColumn("field", lambda one: one.value.field.path, priority=KEY, words=True),
    TableColumn("median", lambda one: one.value.field.shown(one.median), priority=KEY, words=True),
    TableColumn("95 % of the posterior", lambda one: _between(one.value, one.low, one.high), priority=KEY, words=True),
    TableColumn("least squares", lambda one: one.value.field.shown(one.value.value), priority=MORE, words=True),
    TableColumn("95 % of least squares", lambda one: _interval(one.value), words=True),
)


def posterior_words(posterior: Posterior) -> str:
    """Say how the posterior was sampled, and how well."""
    return (
        f"{WALKERS} chains of {posterior.steps} steps, {posterior.steps / posterior.memory:.0f} autocorrelation times "
        f"of {posterior.memory:.3g} steps: about {posterior.independent:.0f} independent draws; "
        f"{percent(posterior.accepted, 0)} of moves accepted; seed {SEED}."
    )


class CorrelationRow(NamedTuple):
    """A row of the correlation."""

    field: str
    values: tuple[float, ...]


def correlation_rows(study: FitStudy) -> list[CorrelationRow]:
    """Return a row a field."""
    return [
        CorrelationRow(one.field.path, tuple(map(float, row)))
        for one, row in zip(study.parameters, study.correlation, strict=True)
    ]


def correlation_columns(study: FitStudy) -> tuple[TableColumn[CorrelationRow], ...]:
    """Return a column a field."""

    def column(k: int) -> TableColumn[CorrelationRow]:
        return TableColumn(study.parameters[k].field.path, lambda row: row.values[k], digits=3)

    numbers = [column(k) for k in range(len(study.parameters))]
    return (TableColumn("", lambda row: row.field, priority=KEY, words=True), *numbers)


class ResidualRow(NamedTuple):
    """What is left of a measured thing, and the verdict of the fitted run that it is held against."""

    one: Misfit
    verdict: str


def _verdict(one: Misfit) -> Tag:
    if one.is_number:
        return Tag("number")
    if one.more_than_noise:
        return Tag("not noise", "warned")
    return Tag("noise", "good")


RESIDUAL_COLUMNS: tuple[TableColumn[ResidualRow], ...] = (
    TableColumn("measured", lambda row: row.one.called, priority=KEY, words=True),
    TableColumn("RMS residual (%)", lambda row: 100.0 * row.one.share, digits=3),
    TableColumn("over its noise or uncertainty", lambda row: row.one.size, digits=3),
    TableColumn("independent samples", lambda row: math.floor(row.one.independent), priority=MORE),
    TableColumn("is", lambda row: _verdict(row.one), words=True),
    TableColumn("verdict of the run", lambda row: row.verdict or NONE, words=True),
)


def _shown(one: PredictedFigure, value: float) -> float:
    return float(shown(value, one.unit, USUAL.get(one.unit, one.unit))) if one.unit else value


def _figure(one: PredictedFigure) -> str:
    return headed(one.figure, one.unit, USUAL.get(one.unit, one.unit)) if one.unit else one.figure


CHECK_COLUMNS: tuple[TableColumn[PredictedFigure], ...] = (
    TableColumn("record", lambda one: one.record, priority=KEY, words=True),
    TableColumn("figure", _figure, priority=KEY, words=True),
    TableColumn("measured", lambda one: _shown(one, one.measured)),
    TableColumn("predicted", lambda one: _shown(one, one.predicted)),
    TableColumn("low", lambda one: _shown(one, one.low), priority=MORE),
    TableColumn("high", lambda one: _shown(one, one.high), priority=MORE),
    TableColumn("bias (%)", lambda one: f"{100.0 * one.bias:+.1f}"),
    TableColumn(
        "band holds it", lambda one: Tag("inside", "good") if one.inside else Tag("outside", "warned"), words=True
    ),
)


TRIED_COLUMNS: tuple[TableColumn[TriedChoice], ...] = (
    TableColumn("choice", lambda one: one.choice, priority=KEY, words=True),
    TableColumn("residual over noise", lambda one: one.misfit, digits=3),
    TableColumn("of records kept out", lambda one: one.kept_out, digits=3),
    TableColumn("more than noise", lambda one: None if one.failure else str(one.more_than_noise), priority=MORE),
    TableColumn("could not be fitted", lambda one: one.failure or None, priority=MORE, words=True),
)


def check_words(checks: Checks) -> str:
    """Say how well what was kept out is predicted."""
    count = len(checks.figures)
    biases = listed([f"{name} {percent(bias, 1, '+')}" for name, bias in checks.biases().items()])
    words = f"Of what was kept out, {checks.inside} of {count} bands hold what was measured; mean bias: {biases}."
    scores = [one.rating.overall for _, one in checks.agreements]
    return f"{words} Predictions agree to {np.mean(scores):.2f} of 1 by ISO/TS 18571." if scores else words


def residual_rows(study: FitStudy) -> list[ResidualRow]:
    """Return a row for each record and number, the largest residuals over noise or uncertainty first."""
    rows = map(ResidualRow, study.solved.misfits, study.verdicts_of_measured())
    return sorted(rows, key=lambda row: -row.one.size)
