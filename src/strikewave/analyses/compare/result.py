"""Result of a comparison: metrics, verdict, tables, JSON document."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import (
    FIGURES,
    OF_FILES,
    QUANTITIES,
    ComparedCurve,
    CurveAgreement,
    PairOfFigures,
    SpecificationVerdict,
)
from strikewave.analyses.compare.limits import METRICS, Judged, verdict_of
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, NOT_MEASURED, GivenUnits, Quantity
from strikewave.base.result import Band
from strikewave.base.shock_quantities import (
    FREQUENCY,
    KILOHERTZ,
    MICROSECONDS,
    MILLISECONDS,
    RATIO,
    SCORE,
    SECONDS,
    SHARE,
    usual_unit,
)
from strikewave.base.texts import percent, rounded
from strikewave.records.budget import Budget
from strikewave.reporting.bands import band_text
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import amount
from strikewave.reporting.measured_files import AskedResult
from strikewave.reporting.numbers import axis_unit, shown, with_unit
from strikewave.reporting.parts import Tag, written
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.signal.filters import Filter
from strikewave.signal.iso18571 import RATE, SAMPLES
from strikewave.specifications.judging import together

Array = NDArray[np.float64]

# Name and unit of the integral over time of what has a name for it
INTEGRALS = {"m/s^2": ("velocity_change", "m/s"), "N": ("impulse", "N s")}
LONGEST_IN_US, LONGEST_IN_MS = 1e-2, 10.0  # shifts, s, up to which they are shown in µs and in ms
LONGEST_INTERVAL_IN_US = 2e-3  # intervals, s, up to which they are shown in µs, and in ms beyond
DECIMALS, MOST_DECIMALS = 4, 6  # decimals of a shift: without an uncertainty, and at most
NAMES = {"peak": "peak", "width": "pulse width at 10 %", "velocity_change": "velocity change", "impulse": "impulse"}
TOGETHER = "of-both"
RMS = SHARE._replace(label=METRICS["rms"][1])
CORRELATION = Quantity(NO_UNIT, NO_UNIT, METRICS["correlation"][1], 5, 0)
LEVEL = Quantity("dB", "dB")
OF_INTEGRAL = Quantity.of_data("of the integral")


@declare.dataclass
class LargestRatio:
    """Largest difference of the shock response spectra."""

    ratio: float = declare.number(LEVEL, "largest ratio of the shock response spectra")
    frequency: float = declare.number(FREQUENCY, "natural frequency of that")
    words = declare.phrase("largest ratio of shock response spectra", column=MAIN, tables=TOGETHER)(
        lambda one: f"{one.ratio:+.2f} dB at {amount(KILOHERTZ, one.frequency, digits=3)}"
    )


@declare.dataclass
class SpectraRatio:
    """Ratio of the shock response spectra."""

    largest: LargestRatio = declare.part(LargestRatio, "where it is largest in size")
    frequency: Array = declare.history(FREQUENCY, "natural frequencies")
    ratio: Array = declare.history(LEVEL, "ratio of the spectra, b over a, there")


@declare.dataclass
class IsoScores:
    """Scores of ISO/TS 18571, and how time was scaled for them."""

    corridor: float = declare.number(SCORE, "corridor score of ISO/TS 18571, 0 to 1", column=MAIN)
    phase: float = declare.number(SCORE, "phase score", column=MAIN)
    magnitude: float = declare.number(SCORE, "magnitude score", column=MAIN)
    slope: float = declare.number(SCORE, "slope score", column=MAIN)
    overall: float = declare.number(SCORE, "overall score", column=MAIN)
    delay: float = declare.number(MICROSECONDS, "by how much b comes later, by the phase score")
    grade: str = declare.word("grade in words", column=MAIN)
    samples: int = declare.count("samples of the interval")
    stretched: float = declare.number(RATIO, "times by which time was stretched to the sampling rate of the standard")


@declare.dataclass
class ShiftTaken:
    """Shift that aligns the two histories."""

    value: float = declare.number(MICROSECONDS, "what was added to the times of b")
    uncertainty: float = declare.number(MICROSECONDS, "standard uncertainty of that")
    align: str = declare.word("rule that was asked for")
    rule: str = declare.word("rule that was taken")

    @declare.phrase("shift of B", column=MAIN, tables=TOGETHER)
    def words(self) -> str:
        """Return it with its uncertainty."""
        if self.align == "none":
            return "none"
        size = abs(self.value)
        of = MICROSECONDS if size < LONGEST_IN_US else MILLISECONDS if size < LONGEST_IN_MS else SECONDS
        second, unit = axis_unit(*of.units)
        doubt = self.uncertainty / second
        decimals = min(max(1 - math.floor(math.log10(doubt)), 0), MOST_DECIMALS) if doubt > 0.0 else DECIMALS
        value = f"{rounded(self.value / second, decimals)} {unit}"
        return f"{value} ± {rounded(doubt, decimals)} {unit}" if doubt > 0.5 * 10.0**-MOST_DECIMALS else value


@declare.dataclass
class CorridorShare:
    """Share of a history within the corridor of a campaign."""

    share: float = declare.number(RATIO, "of a campaign: share of the samples within its corridor")
    deviations: float = declare.number(NOT_MEASURED, "how wide that is in deviations")
    words = declare.phrase("within the corridor", column=MAIN, tables=TOGETHER)(
        lambda one: f"{percent(one.share, 1)}, ± {one.deviations:g} standard deviations"
    )


@declare.dataclass
class BandedFigure:
    """A figure of one history that the other one has a band of."""

    figure: str = declare.word("of a simulation with bands: the figure")
    of: str = declare.word("whose figure is held against the band")
    value: float = declare.number(NOT_MEASURED, "the figure")
    low: float = declare.number(NOT_MEASURED, "low end of the band")
    high: float = declare.number(NOT_MEASURED, "high end of the band")
    inside: bool = declare.word("whether it lies within")
    units: tuple[str, str]
    called = declare.phrase("figure", column=KEY)(lambda one: f"{NAMES[one.figure]} of {one.of}")
    size_words = declare.phrase("value", column=MAIN)(lambda one: with_unit(abs(one.value), *one.units))
    band_words = declare.phrase("band", column=MAIN)(lambda one: band_text(Band(one.low, one.high, 0.0), *one.units))
    place = declare.phrase("lies", column=MAIN)(
        lambda one: Tag("inside", "good") if one.inside else Tag("outside", "warned")
    )


@declare.dataclass
class ComparisonMetrics:
    """Metrics of the agreement of two histories."""

    peak: PairOfFigures | None = declare.part(PairOfFigures, "largest magnitude", quantity=OF_FILES)
    width: PairOfFigures | None = declare.part(PairOfFigures, "width at 10 % of it", quantity=MICROSECONDS)
    velocity_change: PairOfFigures | None = declare.part(PairOfFigures, "of accelerations", quantity=OF_INTEGRAL)
    impulse: PairOfFigures | None = declare.part(PairOfFigures, "of forces", quantity=OF_INTEGRAL)
    rms: float = declare.number(
        RMS, "root mean square of the difference over that of the reference", column=MAIN, tables=TOGETHER
    )
    correlation: float = declare.number(CORRELATION, "of both over the interval", column=MAIN, tables=TOGETHER)
    srs: SpectraRatio | None = declare.part(SpectraRatio, "the ratio of the spectra; null of what is no acceleration")
    iso18571: IsoScores = declare.part(IsoScores, "scores of ISO/TS 18571")
    shift: ShiftTaken = declare.part(ShiftTaken, "what aligned both", quantity=MICROSECONDS)
    inside: CorridorShare | None = declare.part(CorridorShare, "what lies within the corridor of a campaign")
    band: list[BandedFigure] = declare.rows(BandedFigure, "figures that a band is known of")


@declare.dataclass
class CompareResult(AskedResult):
    """Two histories held against one another; see `Result` for what it shares with others.

    Beside what documents have:

    Attributes
    ----------
    agreement : CurveAgreement
        Both laid on one another, and how well they agree.
    align : str
        Rule of the alignment.
    low_pass : Filter or None
        Filter that both went through.
    factor : float
        Standard deviations of a campaign that its corridor is wide to either side.
    specified : SpecificationVerdict or None
        Verdict of the specification, where B is one.
    budget : Budget or None
        Budget of the uncertainties of the measured histories.
    """

    command: ClassVar[str] = "compare"
    is_history: ClassVar[bool] = True
    main_rows: ClassVar[str] = "histories"
    a: ComparedCurve = declare.part(ComparedCurve, "the reference")
    b: ComparedCurve = declare.part(ComparedCurve, "what is held against it")
    agreement: CurveAgreement
    align: str = "correlation"
    low_pass: Filter | None = None
    factor: float = 2.0

    @property
    def title(self) -> str:
        """Names of both histories."""
        return f"{self.b.name} against {self.a.name}"

    @property
    def unit(self) -> str:
        """SI unit of both; empty where it is not known."""
        return self.a.unit or self.b.unit

    @property
    def usual(self) -> str:
        """Unit in which both are shown as a rule."""
        return usual_unit(self.unit)

    @property
    def given_units(self) -> GivenUnits:
        """Units of what the files hold, and of its integral."""
        _, integral = INTEGRALS.get(self.unit, ("", NO_UNIT))
        return {OF_FILES.given_by: (self.unit, self.usual), OF_INTEGRAL.given_by: (integral, integral)}

    @property
    def named_units(self) -> Mapping[str, str]:
        """Units of where a specification begins, and of the uncertainty of the shift."""
        return {"start": "s", "uncertainty": "s"}

    sides = declare.computed(declare.named(ComparedCurve, "histories", label="history", in_document=False))(
        lambda one: {"A": one.a, "B": one.b}
    )
    quantity = declare.computed(declare.word("what both are of, such as acceleration"))(
        lambda one: QUANTITIES.get(one.unit, "value")
    )
    low_pass_on_both = declare.computed(
        declare.word("low-pass that both went through", key="filter", column=MAIN, tables=TOGETHER, order=1)
    )(lambda one: None if one.low_pass is None else str(one.low_pass))

    @declare.phrase("rating", headline="ISO/TS 18571")
    def rating_words(self) -> str:
        """Return the rating of ISO/TS 18571 with its grade."""
        rating = self.agreement.rating
        return f"{rating.overall:.3f} ({rating.grade})"

    pairs = declare.computed(declare.rows(PairOfFigures, "largest pulse", in_document=False, headline="each"))(
        lambda one: list(one.figures.values())
    )

    @declare.computed(declare.part(ComparisonMetrics, "how well both agree"))
    def metrics(self) -> ComparisonMetrics:
        """Metrics of the agreement of both."""
        curves, rating = self.agreement, self.agreement.rating
        begin, end = curves.interval
        scaling = (SAMPLES, (SAMPLES - 1) / RATE / (end - begin))
        srs = SpectraRatio(LargestRatio(*curves.largest_ratio), curves.frequency, curves.ratio)
        return ComparisonMetrics(
            **{name: self.figures.get(name) for name in NAMES},
            rms=curves.rms,
            correlation=curves.correlation,
            srs=srs if curves.frequency.size else None,
            iso18571=IsoScores(*rating[:5], (end - begin) / (SAMPLES - 1) * rating.delay, rating.grade, *scaling),
            shift=ShiftTaken(curves.shift.shift, curves.shift.uncertainty, self.align, curves.shift.rule),
            inside=None if curves.deviation is None else CorridorShare(curves.inside(self.factor), self.factor),
            band=self.in_bands,
        )

    shift_words = declare.phrase("shift", headline="shift")(lambda one: one.metrics.shift.words)
    interval = declare.computed(declare.history(MICROSECONDS, "[begin, end] in which they are judged"))(
        lambda one: one.agreement.interval
    )

    @declare.phrase("interval in which they are judged", column=MAIN, tables=TOGETHER)
    def interval_words(self) -> str:
        """Return begin, end and length of the interval."""
        begin, end = self.interval
        of = MICROSECONDS if end - begin < LONGEST_INTERVAL_IN_US else MILLISECONDS
        ends = f"{written(shown(begin, *of.units), 6)} to {written(shown(end, *of.units), 6)}"
        return f"{ends} {axis_unit(*of.units)[1]} ({amount(of, end - begin)})"

    above_nyquist = declare.computed(
        declare.number(RATIO, "share of the RMS of the finer history above half the sampling rate of the other")
    )(lambda one: one.agreement.lost)
    judged: Sequence[Judged] = declare.rows(Judged, "limits", key="limits", default=())
    budget: Budget | None = declare.part(Budget, "the budget", default=None)
    specified: SpecificationVerdict | None = declare.part(
        SpecificationVerdict, "the verdict by a specification", key="spec", default=None
    )

    @declare.computed(declare.word("the worst of specification and limits; null without any"))
    def verdict(self) -> str | None:
        """Worst verdict, of the specification and of the limits; None without any."""
        verdicts = [one for one in (verdict_of(self.judged), self.specified and self.specified.verdict) if one]
        return together(verdicts) if verdicts else None

    history = declare.computed(declare.part(CurveAgreement, "both over the common time", quantity=OF_FILES))(
        lambda one: one.agreement
    )

    @declare.computed(declare.table("both over the common time"))
    def histories(self) -> list[Column]:
        """Both histories over the common time."""
        curves, si, usual = self.agreement, self.unit, self.usual
        columns = [
            Column.of("time", curves.time, MICROSECONDS),
            Column("A", curves.a, si, shown=usual),
            Column("B", curves.b, si, shown=usual),
            Column("difference", curves.b - curves.a, si, shown=usual),
        ]
        if curves.deviation is not None:
            columns.append(Column("deviation", curves.deviation, si, shown=usual))
        return columns

    @functools.cached_property
    def figures(self) -> dict[str, PairOfFigures]:
        """Peak, width, and velocity change or impulse, of both."""
        kinds = {"peak": ("peak", self.unit, self.usual), "width": ("width", *MICROSECONDS.units)}
        if self.unit in INTEGRALS:
            integral, si = INTEGRALS[self.unit]
            kinds[integral] = ("integral", si, si)
        return {
            name: PairOfFigures(
                getattr(self.agreement.pulse_a, FIGURES[key]),
                getattr(self.agreement.pulse_b, FIGURES[key]),
                self.a.uncertainty.get(key, 0.0),
                self.b.uncertainty.get(key, 0.0),
                NAMES[name],
                (si, usual),
                (self.a.budgeted, self.b.budgeted),
            )
            for name, (key, si, usual) in kinds.items()
        }

    @property
    def expanded(self) -> dict[str, float]:
        """Expanded uncertainties, k = 2, of what limits are of, as far as they are known."""
        known = {name: pair.uncertainty for name, pair in self.figures.items()}
        known |= {"shift": self.agreement.shift.uncertainty} if self.align != "none" else {}
        return {name: 2.0 * one for name, one in known.items() if math.isfinite(one)}

    @functools.cached_property
    def values(self) -> dict[str, float]:
        """Values that a limit can be set for, by name: differences as sizes."""
        curves = self.agreement
        return {
            **{name: abs(pair.difference) for name, pair in self.figures.items()},
            "rms": curves.rms,
            "correlation": curves.correlation,
            "srs": abs(curves.largest_ratio[0]),
            "iso18571": curves.rating.overall,
            **{
                f"iso18571.{name}": getattr(curves.rating, name) for name in ("corridor", "phase", "magnitude", "slope")
            },
            "shift": abs(curves.shift.shift),
            "inside": curves.inside(self.factor),
        }

    @declare.computed(declare.rows(BandedFigure, "band of the simulation", in_document=False))
    def in_bands(self) -> list[BandedFigure]:
        """Each figure of one history that the other one has a band of."""
        rows = []
        for name, pair in self.figures.items():
            for owner, value, band in (("A", pair.a, self.b.band.get(name)), ("B", pair.b, self.a.band.get(name))):
                if band is not None and math.isfinite(value):
                    inside = band.low <= abs(value) <= band.high
                    rows.append(BandedFigure(name, owner, value, band.low, band.high, inside, pair.units))
        return rows

    def preview(self) -> Curve | None:
        """Return the difference over the interval."""
        curves, inside = self.agreement, self.agreement.inside_interval
        return history_curve(
            curves.time[inside], (curves.b - curves.a)[inside], self.unit, self.usual, f"difference of {self.quantity}"
        )

    def tables(self) -> dict[str, str]:
        """Return histories and spectra as CSV text."""
        tables = {"comparison.csv": csv_table(self.histories, HISTORY_DIGITS)}
        curves, si = self.agreement, self.unit
        if curves.frequency.size:
            spectra = [
                Column("frequency", curves.frequency, "Hz"),
                Column("A", curves.spectrum_a, si),
                Column("B", curves.spectrum_b, si),
                Column("ratio [dB]", curves.ratio),
            ]
            tables["spectrum.csv"] = csv_table(spectra)
        return tables
