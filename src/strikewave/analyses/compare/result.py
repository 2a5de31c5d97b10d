"""What a comparison comes to: metrics, verdict, tables, JSON document."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from strikewave.analyses.compare.agreement import CurveAgreement, PairOfFigures
from strikewave.analyses.compare.curve import FIGURES, QUANTITIES, SHOWN_IN, ComparedCurve
from strikewave.analyses.compare.limits import Judged, verdict_of
from strikewave.analyses.compare.specified import SpecificationVerdict
from strikewave.base.result import Band
from strikewave.records.budget.contributions import Budget
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import axis_unit, percent, rounded
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.signal.filters import Filter
from strikewave.signal.iso18571 import RATE, SAMPLES
from strikewave.specifications.decisions import together

INTEGRALS = {"m/s^2": "m/s", "N": "N s"}
"""Unit of the integral over time of what has a name for it: the velocity change, and the impulse."""
LONGEST_IN_US, LONGEST_IN_MS = 1e-2, 10.0
"""Shifts, s, up to which they are shown in µs and in ms."""
DECIMALS, MOST_DECIMALS = 4, 6
"""Of a shift: without an uncertainty, and at most."""
NAMES = {"peak": "peak", "width": "pulse width at 10 %", "velocity_change": "velocity change", "impulse": "impulse"}


@dataclass(frozen=True)
class CompareResult(AskedResult):
    """Two histories held against one another; see `Result` for what it shares with others.

    Attributes
    ----------
    a, b : ComparedCurve
        The reference, and what is held against it.
    agreement : CurveAgreement
        Both laid on one another, and how well they agree.
    align : str
        Rule of the alignment.
    low_pass : Filter or None
        Filter that both went through.
    factor : float
        Standard deviations of a campaign that its corridor is wide to either side.
    judged : sequence of Judged
        The limits, and whether they are kept.
    specified : SpecificationVerdict or None
        What a specification comes to, where B is one.
    """

    command: ClassVar[str] = "compare"
    is_history: ClassVar[bool] = True

    a: ComparedCurve
    b: ComparedCurve
    agreement: CurveAgreement
    align: str = "correlation"
    low_pass: Filter | None = None
    factor: float = 2.0
    judged: Sequence[Judged] = ()
    specified: SpecificationVerdict | None = None
    budget: Budget | None = None

    @property
    def title(self) -> str:
        """The names of both."""
        return f"{self.b.name} against {self.a.name}"

    @property
    def unit(self) -> str:
        """SI unit of both; empty where it is not known."""
        return self.a.unit or self.b.unit

    @property
    def usual(self) -> str:
        """Unit in which both are shown as a rule."""
        return SHOWN_IN.get(self.unit, self.unit)

    @property
    def quantity(self) -> str:
        """What both are of."""
        return QUANTITIES.get(self.unit, "value")

    @property
    def verdict(self) -> str | None:
        """The worst verdict, of the specification and of the limits; None without any."""
        verdicts = [one for one in (verdict_of(self.judged), self.specified and self.specified.verdict) if one]
        return together(verdicts) if verdicts else None

    @functools.cached_property
    def figures(self) -> dict[str, PairOfFigures]:
        """Peak, width, and velocity change or impulse, of both."""
        integral = {"m/s^2": "velocity_change", "N": "impulse"}.get(self.unit)
        names = {"peak": "peak", "width": "width", **({integral: "integral"} if integral else {})}
        one, other = self.agreement.pulse_a, self.agreement.pulse_b
        return {
            name: PairOfFigures(
                getattr(one, FIGURES[key]),
                getattr(other, FIGURES[key]),
                self.a.uncertainty.get(key, 0.0),
                self.b.uncertainty.get(key, 0.0),
            )
            for name, key in names.items()
        }

    @property
    def expanded(self) -> dict[str, float]:
        """Expanded uncertainties, k = 2, of what limits are of, as far as they are known."""
        known = {name: pair.uncertainty for name, pair in self.figures.items()}
        known |= {"shift": self.agreement.shift.uncertainty} if self.align != "none" else {}
        return {name: 2.0 * one for name, one in known.items() if math.isfinite(one)}

    @functools.cached_property
    def values(self) -> dict[str, float]:
        """What a limit can be of, by its name: differences as sizes."""
        found = self.agreement
        return {
            **{name: abs(pair.difference) for name, pair in self.figures.items()},
            "rms": found.rms,
            "correlation": found.correlation,
            "srs": abs(found.largest_ratio[0]),
            "iso18571": found.rating.overall,
            **{f"iso18571.{name}": getattr(found.rating, name) for name in ("corridor", "phase", "magnitude", "slope")},
            "shift": abs(found.shift.shift),
            "inside": found.inside(self.factor),
        }

    @functools.cached_property
    def in_bands(self) -> list[tuple[str, str, float, Band, bool]]:
        """Each figure of one history that the other one has a band of: name, whose, value, band, whether inside."""
        rows = []
        for name, pair in self.figures.items():
            for owner, value, band in (("A", pair.a, self.b.band.get(name)), ("B", pair.b, self.a.band.get(name))):
                if band is not None and math.isfinite(value):
                    rows.append((name, owner, value, band, band.low <= abs(value) <= band.high))
        return rows

    def units(self) -> Mapping[str, str]:
        """Return the unit of each key of the JSON document."""
        own = self.unit or "the files' own numbers"
        integral = INTEGRALS.get(self.unit, "1")
        return {
            "peak": own,
            "width": "s",
            "velocity_change": integral,
            "impulse": integral,
            "difference": "1",
            "difference_uncertainty": "1",
            "uncertainty": "s",
            "a_uncertainty": "as the figure",
            "b_uncertainty": "as the figure",
            "noise": own,
            "sampling_rate": "Hz",
            "delay": "s",
            "start": "s",
            "stretched": "1",
            "above_nyquist": "1",
            "shift": "s",
            "interval": "s",
            "time": "s",
            "history": own,
            "frequency": "Hz",
            "ratio": "dB",
            "rms": "1",
            "correlation": "1",
            "share": "1",
        }

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        found = self.agreement
        figures: dict[str, Any] = dict.fromkeys(("peak", "width", "velocity_change", "impulse"))
        for name, pair in self.figures.items():
            figures[name] = {
                **pair._asdict(),
                "difference": pair.difference,
                "difference_uncertainty": pair.uncertainty,
            }
        rating = found.rating._asdict()
        step = (found.interval[1] - found.interval[0]) / (SAMPLES - 1)
        return {
            "a": _curve_document(self.a),
            "b": _curve_document(self.b),
            "quantity": self.quantity,
            "filter": None if self.low_pass is None else str(self.low_pass),
            "metrics": {
                **figures,
                "rms": found.rms,
                "correlation": found.correlation,
                "srs": self._srs_document(),
                "iso18571": {**rating, "grade": found.rating.grade, "delay": step * found.rating.delay, **self.scaling},
                "shift": {
                    "value": found.shift.shift,
                    "uncertainty": found.shift.uncertainty,
                    "align": self.align,
                    "rule": found.shift.rule,
                },
                "inside": None
                if found.deviation is None
                else {"share": found.inside(self.factor), "deviations": self.factor},
                "band": [
                    {"figure": name, "of": owner, "value": value, "low": band.low, "high": band.high, "inside": inside}
                    for name, owner, value, band, inside in self.in_bands
                ],
            },
            "interval": list(found.interval),
            "above_nyquist": found.lost,
            "limits": [
                {
                    "metric": one.limit.metric,
                    "limit": one.limit.typed,
                    "value": one.value,
                    "margin": one.margin,
                    "verdict": one.verdict,
                }
                for one in self.judged
            ],
            "budget": None if self.budget is None else self.budget.document(),
            "spec": None if self.specified is None else self.specified.document(),
            "verdict": self.verdict,
            "history": {"time": found.time, "a": found.a, "b": found.b, "deviation": found.deviation},
        }

    @property
    def scaling(self) -> dict[str, float]:
        """How time was scaled for ISO/TS 18571: samples of the interval, and times by which it was stretched."""
        begin, end = self.agreement.interval
        return {"samples": SAMPLES, "stretched": (SAMPLES - 1) / RATE / (end - begin)}

    def _srs_document(self) -> dict[str, Any] | None:
        found = self.agreement
        if not found.frequency.size:
            return None
        return {
            "largest": dict(zip(("ratio", "frequency"), found.largest_ratio, strict=True)),
            "frequency": found.frequency,
            "ratio": found.ratio,
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the rating, the differences of the figures, and the shift."""
        rating = self.agreement.rating
        numbers = [("ISO/TS 18571", f"{rating.overall:.3f} ({rating.grade})")]
        numbers += [
            (NAMES[name], percent(pair.difference, 1, "+"))
            for name, pair in self.figures.items()
            if math.isfinite(pair.difference)
        ]
        return [*numbers, ("shift", shift_words(self))]

    def preview(self) -> Curve | None:
        """Return the difference over the interval."""
        found, kept = self.agreement, self.agreement.inside_interval
        return history_curve(
            found.time[kept], (found.b - found.a)[kept], self.unit, self.usual, f"difference of {self.quantity}"
        )

    def columns(self) -> list[Column]:
        """Return both histories over the common time."""
        found, usual = self.agreement, self.unit
        columns = [
            Column("time", found.time, "s"),
            Column("A", found.a, usual),
            Column("B", found.b, usual),
            Column("difference", found.b - found.a, usual),
        ]
        return columns + ([Column("deviation", found.deviation, usual)] if found.deviation is not None else [])

    def brief(self) -> dict[str, str]:
        """Return all columns."""
        return {"time": "us"} | {column.name: self.usual for column in self.columns()[1:]}

    def tables(self) -> dict[str, str]:
        """Return histories and spectra as CSV text."""
        tables = {"comparison.csv": csv_table(self.columns(), HISTORY_DIGITS)}
        found, usual = self.agreement, self.unit
        if found.frequency.size:
            spectra = [
                Column("frequency", found.frequency, "Hz"),
                Column("A", found.spectrum_a, usual),
                Column("B", found.spectrum_b, usual),
                Column("ratio [dB]", found.ratio),
            ]
            tables["spectrum.csv"] = csv_table(spectra)
        return tables


def _curve_document(curve: ComparedCurve) -> dict[str, Any]:
    return {
        "name": curve.name,
        "kind": curve.kind,
        "count": curve.count,
        "sampling_rate": 1.0 / curve.history.step,
        "noise": curve.history.noise,
    }


def shift_words(result: CompareResult) -> str:
    """Return the shift with its uncertainty, in words."""
    shift = result.agreement.shift
    if result.align == "none":
        return "none"
    size = abs(shift.shift)
    (second, unit) = axis_unit("s", "us" if size < LONGEST_IN_US else "ms" if size < LONGEST_IN_MS else "s")
    doubt = shift.uncertainty / second
    decimals = min(max(1 - math.floor(math.log10(doubt)), 0), MOST_DECIMALS) if doubt > 0.0 else DECIMALS
    value = f"{rounded(shift.shift / second, decimals)} {unit}"
    return f"{value} ± {rounded(doubt, decimals)} {unit}" if doubt > 0.5 * 10.0**-MOST_DECIMALS else value
