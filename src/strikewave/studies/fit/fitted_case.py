"""The case that a fit comes to: fitted values with their standard errors, and what they were fitted to and under."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from strikewave.base.quantities import Value
from strikewave.cases.case import NONE, Case, FitTable
from strikewave.studies.fit.covariance import Estimate
from strikewave.studies.fit.free_fields import FreeField
from strikewave.uncertainty.draws import FELT

ERROR_DIGITS, CORRELATION_DIGITS = 4, 6
"""Digits of a standard error and of a correlation: more than any of them has."""


class FittedTo(NamedTuple):
    """What values were fitted to, in words; the files by their SHA-256; fields that differ between the experiments."""

    words: str
    records: Mapping[str, str]
    aside: Sequence[str] = ()
    sensors: bool = False


def fitted_case(case: Case, fields: Sequence[FreeField], found: Estimate, to: FittedTo) -> Case:
    """Return a case with fitted values, and how well they are known; what is not determined is assumed.

    Parameters
    ----------
    case : Case
        What was fitted.
    fields : sequence of FreeField
        The free fields.
    found : Estimate
        Where they ended.
    to : FittedTo
        What they were fitted to.
    """
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
