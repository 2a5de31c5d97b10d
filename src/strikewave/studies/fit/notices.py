"""What the user should know of a fit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from strikewave.base.result import FAILED, INFO, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case
from strikewave.reporting.numbers import listed
from strikewave.studies.fit.posterior import ENOUGH, LONG, Posterior
from strikewave.studies.fit.result import FitStudy, combination_words, separating_words

Array = NDArray[np.float64]

NOT_SAMPLED = Notice("not-sampled", "stopped before the posterior was sampled: intervals are those of least squares")
MET = 2.0
"""Standard uncertainties of a number within which the fit meets it: 95 %."""
AT_BOUND = 1e-4
"""Distance from a bound, over the width of the bounds, at which a value stands at it."""
ON_STAIRS = 0.5
"""Steps in which a value moves the run, over its standard error, beyond which they are a good part of it."""
ALIKE = 0.98
"""Correlation of two values beyond which the report says that they are known together far better than each."""


def posterior_notices(posterior: Posterior) -> list[Notice]:
    """Return what the user should know of a posterior: of chains that are too short to be trusted."""
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
    """Return which values of an earlier fit are held, where the fields are those that the case marks as fitted."""
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
    """Return what the user should know of a fit."""
    notices = list[Notice]()
    if study.solved.stopped:
        notices.append(Notice("stopped", "stopped: the best so far; fit fitted.toml to go on", severity=FAILED))
    for group in study.solved.estimate.groups():
        words = f"{combination_words(study, group)}; {separating_words(study, group)}"
        notices.append(Notice("not-determined", words, float(len(group)), 0.0))
    notices += [*_of_records(study), *_of_numbers(study), *_of_values(study), *_of_pairs(study)]
    return notices


def _of_records(study: FitStudy) -> Iterator[Notice]:
    """Yield what is left of the records beyond noise."""
    broken = [misfit for misfit in study.solved.misfits if misfit.more_than_noise and not misfit.scatters]
    if broken:
        worst = max(broken, key=lambda one: one.size)
        known = "times its noise" if worst.noise_known else "times 1e-4 of its peak, for it shows no noise"
        others = f" (the worst of {len(broken)} records)" if len(broken) > 1 else ""
        message = (
            f"the residual of {worst.called} is not noise{others}: its RMS is {percent(worst.share, 1)} of the peak, "
            f"{plain(worst.size)} {known}; the model lacks something, and standard errors are those of what is left"
        )
        yield Notice("residual-not-noise", message, worst.size, 1.0)
    apart = [one for one in study.solved.misfits if one.scatters]
    if apart:
        worst = max(apart, key=lambda one: one.size)
        message = (
            f"{len(apart)} of {len(study.pulses)} records differ by more than noise, {worst.called} by "
            f"{percent(worst.share, 1)} of the peak (RMS), and each can be fitted alone: the shots scatter, and "
            "standard errors hold that"
        )
        yield Notice("shots-scatter", message, worst.size, 1.0, INFO)


def _of_numbers(study: FitStudy) -> Iterator[Notice]:
    """Yield what is left of the stated numbers."""
    excess = study.solved.problem.excess
    if excess.between:
        repeats = " and repeats" if len({one.called for one in study.numbers}) < len(study.numbers) else ""
        shares = [
            excess.between * number.uncertainty / abs(number.value) for number in study.numbers if not number.of_field
        ]
        message = (
            f"the numbers are off by {percent(float(np.median(shares)), 1)} (standard deviation) from setting to "
            f"setting, beyond what their uncertainties{repeats} explain: the model lacks something, and standard "
            "errors and predictions hold that"
        )
        yield Notice("lack-of-fit", message, excess.between, 0.0)
    missed = [misfit for misfit in study.solved.misfits if misfit.is_number and misfit.size > MET]
    if missed:
        worst = max(missed, key=lambda one: one.size)
        others = f" (the worst of {len(missed)} of {len(study.numbers)} numbers)" if len(missed) > 1 else ""
        message = (
            f"{worst.called} is missed by {plain(worst.size, 2)} times its uncertainty, "
            f"{percent(worst.share, 1)}{others}"
        )
        yield Notice("not-met", message, worst.size, MET)


def _of_values(study: FitStudy) -> Iterator[Notice]:
    """Yield values at a bound or on the steps of waves, and other solutions."""
    for value, at in zip(study.parameters, study.solved.estimate.place, strict=True):
        if min(at, 1.0 - at) < AT_BOUND:
            message = f"{value.field.path} stands at a bound, {value.words}: its best value may lie beyond"
            yield Notice("at-bound", message, value.value)
    for value in study.parameters:
        if value.stair > ON_STAIRS * value.standard_error and value.determined:
            steps = value.field.shown(value.stair, 2)
            message = (
                f"{value.field.path} moves the run in steps of {steps}, those of waves through its layer: it cannot be "
                "known better; a smaller solver.step makes them finer"
            )
            yield Notice("on-stairs", message, value.stair, ON_STAIRS * value.standard_error)
    for place in study.solved.others:
        words = ", ".join(
            f"{value.field.path} = {value.field.shown(value.field.si(float(at)), 4)}"
            for value, at in zip(study.parameters, place, strict=True)
        )
        yield Notice("another-solution", f"another solution fits as well: {words}; bounds or a record decide")


def _of_pairs(study: FitStudy) -> Iterator[Notice]:
    """Yield pairs of values that are known together far better than each."""
    size = len(study.parameters)
    for a in range(size):
        for b in range(a):
            share = study.correlation[a, b]
            both = study.parameters[a], study.parameters[b]
            if abs(share) > ALIKE and all(one.determined for one in both):
                message = (
                    f"{both[1].field.path} and {both[0].field.path} are known together only (correlation {share:+.3f})"
                )
                yield Notice("correlated", message, abs(float(share)), ALIKE, INFO)
