"""What a fit comes to: values with errors, what is not determined, predictions; its tables and JSON document."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.curve import QUANTITIES, SHOWN_IN
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import listed, percent
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.studies.fit.checking import Checks
from strikewave.studies.fit.estimation import ProfileEnds
from strikewave.studies.fit.free_fields import FreeField
from strikewave.studies.fit.measured import LaidPulse, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.posterior import SEED, WALKERS, Posterior
from strikewave.studies.fit.separating import SeparatingNumber
from strikewave.studies.fit.solving import Solved
from strikewave.studies.fit.trying import TriedChoice

Array = NDArray[np.float64]

KEPT_DRAWS = 2000
"""Draws of a posterior that are written: as many as are independent at least."""
WHOLE_POWER = 5e-3
"""Difference of a power from 1 below which it is not written: slopes know it no better."""


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
    stair : float
        By how much it moves until the run feels it, SI; 0 where it does smoothly.
    """

    field: FreeField
    value: float
    standard_error: float
    low: float
    high: float
    profile: ProfileEnds | None = None
    stair: float = 0.0

    @property
    def determined(self) -> bool:
        """Whether the data determine it."""
        return math.isfinite(self.standard_error)


class PosteriorValue(NamedTuple):
    """A fitted value with the median and the 95 % interval of its posterior, SI."""

    value: FittedParameter
    median: float
    low: float
    high: float


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
    posterior : Posterior or None
        Draws of the values, where they were asked for.
    bands : tuple of (ndarray, ndarray)
        Ends of the 95 % predictive band of the first ``pulses``, on their samples, SI.
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
    posterior: Posterior | None = None
    bands: tuple[tuple[Array, Array], ...] = ()

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

    def verdicts_of_measured(self) -> list[str]:
        """Return the verdict of the fitted run of each measured thing, in the order of the misfits."""
        experiments = self.solved.problem.experiments
        texts = self.verdicts.texts or ("",) * len(experiments)
        return [text for one, text in zip(experiments, texts, strict=True) for _ in one.measured]

    def units(self) -> Mapping[str, str]:
        """Return the unit of each key of the JSON document."""
        return {
            "value": "as the field",
            "standard_error": "as the field",
            "low": "as the field",
            "high": "as the field",
            "start": "as the field",
            "reach": "standard errors",
            "correlation": "1",
            "size": "standard deviations of the noise",
            "share": "1",
            "within": "standard uncertainties",
            "between": "standard uncertainties",
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
            "median": "as the field",
            "autocorrelation_time": "1",
            "accepted": "1",
            "kept_out": "standard deviations of the noise",
        }

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        found, excess = self.solved.estimate, self.solved.problem.excess
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
                    "reach": float(reach) if one.determined else None,
                }
                for one, reach in zip(self.parameters, found.reach, strict=True)
            ],
            "correlation": self.correlation.tolist(),
            "undetermined": self.undetermined,
            "combinations": [combination_words(self, group) for group in found.groups()],
            "separating": [one._asdict() for one in self.separating],
            "misfit": {
                "chi_squared": found.misfit,
                "residuals": int(found.residuals.size),
                "excess": {"within": excess.within, "between": excess.between},
                "shots": self.solved.problem.shot_count,
                "measured": [
                    {**vars(one), "verdict": verdict}
                    for one, verdict in zip(self.solved.misfits, self.verdicts_of_measured(), strict=True)
                ],
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
            "posterior": None if self.posterior is None else self._posterior_document(self.posterior),
            "checks": None if self.checks is None else _checks_document(self.checks),
            "other_solutions": [self._values_at(place) for place in self.solved.others],
            "runs": self.solved.runs,
            "stopped": self.solved.stopped,
        }

    def _posterior_document(self, posterior: Posterior) -> dict[str, Any]:
        """Return the posterior for the JSON document."""
        return {
            "parameters": [
                {"field": one.value.field.path, "median": one.median, "low": one.low, "high": one.high}
                for one in self.posterior_values()
            ],
            "walkers": WALKERS,
            "steps": posterior.steps,
            "autocorrelation_time": posterior.memory if math.isfinite(posterior.memory) else None,
            "independent_draws": posterior.independent,
            "accepted": posterior.accepted,
            "too_short": posterior.too_short,
            "seed": SEED,
        }

    def posterior_values(self) -> list[PosteriorValue]:
        """Return median and 95 % interval of each value, SI; none where no posterior was sampled."""
        if self.posterior is None:
            return []
        places = [self.posterior.quantiles(share) for share in (0.5, 0.025, 0.975)]
        return [
            PosteriorValue(one, *(one.field.si(float(place[k])) for place in places))
            for k, one in enumerate(self.parameters)
        ]

    def _values_at(self, place: Array) -> dict[str, float]:
        fields = [one.field for one in self.parameters]
        return {field.path: field.si(float(at)) for field, at in zip(fields, place, strict=True)}

    def texts(self) -> dict[str, str]:
        """Return the fitted case, and the JSON document."""
        return {"fitted.toml": dump_case(self.case), "fit.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return the values, and record and fitted run over time, as CSV text."""
        tables = {"parameters.csv": csv_table(self.columns())}
        if self.posterior is not None:
            draws = np.array(self.posterior.some(KEPT_DRAWS)).T
            rows = [
                Column(one.field.path, [one.field.si(float(place)) for place in places], one.field.axis.si_unit or "1")
                for one, places in zip(self.parameters, draws, strict=True)
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
    >>> from strikewave.studies.fit.free_fields import free_fields
    >>> field = free_fields(load_case("li-ma-2019"), ["machine.engagement=5 mm..12 mm"])[0]
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
