"""Fit the unknown values of a case to the published numbers that it names for it, and to no others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.run import published_value
from strikewave.base.errors import InputError
from strikewave.base.quantities import Value
from strikewave.cases.case import Case

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
    """Fit the values marked ``fitted`` to the published numbers whose role is ``fitted``.

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
            update={"si": float(value), "typed": rounded(before.typed, float(value) / before.si)}
        )
    return CaseFit(case.with_values(fitted), misses, runs)


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
