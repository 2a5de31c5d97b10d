"""Fit the unknown values of a case to the published numbers that it names for it, and to no others."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.run import published_value
from strikewave.base.errors import InputError
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.fits import NONE, FitTable
from strikewave.uncertainty.draws import FELT

FAILED = 10.0
"""Residual of a target that a trial run has no number for: as if it were eleven times the target, worse than any run
that strikes, so that the search turns back."""
MET = 1e-4
"""Largest relative miss of a target that counts as met, where there are as many values as targets: below the digits of
every published number."""
ACCURACY = 1e-8
"""Relative step of the values at which a search ends: below the seven digits that are written."""
STEP = 1e-4
"""Relative step of the differences that give the slopes: far above what the tolerance of a run errs by (1e-8), small
against what bends the slopes."""
SMALLEST_GAIN = 1e-14
"""Relative gain and slope of the misfit at which a search ends: as good as none, so that `ACCURACY` decides."""
DIGITS = 7
"""Significant digits of a fitted value: its target is then met as well as with all of them."""


@dataclass(frozen=True)
class CaseFit:
    """A fitted case, its relative misses of the targets, and how many runs it took."""

    case: Case
    misses: dict[str, float]
    runs: int


def calibrate(case: Case, accuracy: float = ACCURACY) -> CaseFit:
    """Fit the values marked ``fitted`` to the published numbers whose role is ``fitted``, and record it as [[fit]].

    Only targets of the first blow are met, so each trial runs a single blow. The values are searched on
    a logarithmic scale from where they stand.

    Parameters
    ----------
    case : Case
        With as many fitted values as fitted targets, or fewer.
    accuracy : float, optional
        Relative step at which the search ends.

    Raises
    ------
    InputError
        If nothing is marked fitted, a target is not of the first blow, there are more unknowns than targets,
        or the search ends without meeting the targets to `MET`.
    """
    from scipy.optimize import least_squares

    fields = case.fitted_fields()
    wanted = [entry for entry in case.published if entry.role == "fitted"]
    targets = {f"{entry.quantity} {entry.sensor}".strip(): entry.value.si for entry in wanted}
    if not fields or len(fields) > len(targets):
        raise InputError(
            "published",
            f"{len(targets)} fitted targets for {len(fields)} fitted values",
            "at least as many targets as values",
        )
    for name in targets:
        if not name.startswith("first."):
            raise InputError("published", name, "targets of the first blow, such as first.rigid_peak")
    start = np.array([case.values()[path].si for path in fields])
    one_blow = case.with_values({"feed.blows": Value(si=1, typed=1)})
    runs = 0

    def at(logs: np.ndarray) -> Case:
        values = start * np.exp(logs)
        return one_blow.with_values(
            {
                path: case.values()[path].model_copy(update={"si": float(v)})
                for path, v in zip(fields, values, strict=True)
            }
        )

    def miss(logs: np.ndarray) -> np.ndarray:
        nonlocal runs
        runs += 1
        run = observe(at(logs))
        computed = [published_value(entry.quantity, run.blows, run.readings, entry.sensor) for entry in wanted]
        return np.array(
            [FAILED if c is None else c / entry.value.si - 1.0 for c, entry in zip(computed, wanted, strict=True)]
        )

    answer = least_squares(
        miss, np.zeros(len(fields)), diff_step=STEP, xtol=accuracy, ftol=SMALLEST_GAIN, gtol=SMALLEST_GAIN
    )
    misses = dict(zip(targets, (float(r) for r in answer.fun), strict=True))
    if len(fields) == len(targets) and max(abs(r) for r in misses.values()) > MET:
        raise InputError(
            "published", misses, "targets that the fitted values can meet", "start nearer, or fit other values"
        )
    fitted = {}
    for path, value in zip(fields, start * np.exp(answer.x), strict=True):
        before = case.values()[path]
        fitted[path] = before.model_copy(
            update={
                "si": float(value),
                "typed": rounded(before.typed, float(value) / before.si),
                "note": f"to {_target_words(targets)}",  # a note of its own: read back, it is not the user's
            }
        )
    return CaseFit(with_fit_recorded(case.with_values(fitted), fields, targets), misses, runs)


def with_fit_recorded(case: Case, fields: Sequence[str], targets: Collection[str]) -> Case:
    """Return a case whose [[fit]] holds the fields that it has now, so that a later change of one is noticed.

    Parameters
    ----------
    case : Case
        With the fitted values.
    fields : sequence of str
        Paths of the fitted values.
    targets : collection of str
        Names of what they were fitted to.

    Notes
    -----
    A record that the case has keeps its choice of fields. A fitted value without one is recorded under every field that
    a blow feels, and those of the sensors where a target is theirs.
    """
    kept = [_refreshed(fit, case) for fit in case.fit if set(fit.fields) & set(fields)]
    others = [fit for fit in case.fit if not set(fit.fields) & set(fields)]
    recorded = {path for fit in kept for path in fit.fields}
    missing = tuple(path for path in fields if path not in recorded)
    if missing:
        tables = (*FELT, "sensor") if any("sensor" in name for name in targets) else FELT
        felt = [path for path in case.entries() if path.partition(".")[0] in tables]
        kept.append(FitTable(fields=missing, to=_target_words(targets), under=_as_typed(felt, case)))
    return case.model_copy(update={"fit": (*others, *kept)})


def _target_words(targets: Iterable[str]) -> str:
    return "the published " + ", ".join(name.replace(".", " ").replace("_", " ") for name in targets)


def _refreshed(fit: FitTable, case: Case) -> FitTable:
    """Return a record of a fit under what its fields are now; those of a table that was left out, and no longer is."""
    entries, under = case.entries(), list[str]()
    for path in fit.under:
        below = [] if path in entries else [entry for entry in entries if entry.startswith(f"{path}.")]
        under += below or [path]
    return fit.model_copy(update={"under": _as_typed(under, case)})


def _as_typed(paths: Sequence[str], case: Case) -> dict[str, str | int | float]:
    """Return the fields of a case as they were typed; `NONE` for one that it does not have."""
    entries, values = case.entries(), case.values()
    return {path: values[path].typed if path in values else entries.get(path, NONE) for path in paths}


def rounded(typed: str | int | float, ratio: float) -> str | float:
    """Return a typed quantity times a ratio in the same unit, to `DIGITS`.

    Examples
    --------
    >>> rounded("4 mm", 1.25)
    '5 mm'
    """
    if not isinstance(typed, str):
        return float(f"{typed * ratio:.{DIGITS}g}")
    number, _, unit = typed.strip().partition(" ")
    return f"{float(number) * ratio:.{DIGITS}g} {unit}".strip()
