"""What documents and tables of a scatter study have: statistics of figures, tolerances, and their shares."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, NOT_MEASURED, Quantity
from strikewave.base.shock_quantities import OF_FIGURE, VARIATION
from strikewave.records.campaign import statistic
from strikewave.reporting.faces import amount
from strikewave.studies.scatter.runs import FIGURES
from strikewave.uncertainty.draws import UncertainInput
from strikewave.uncertainty.shares import Share, Shares
from strikewave.uncertainty.statistics import RunSpread

Array = NDArray[np.float64]

PEAK, WIDTH, OF_PATH = Quantity("m/s^2", "g"), Quantity("s", "us"), Quantity.of_data("SI of its path")
MEAN = OF_FIGURE._replace(label="mean", digits=5)


@declare.dataclass
class RunStatistic:
    """A figure over runs: mean and scatter between them."""

    figure: str = declare.word("which figure", column=KEY, in_document=False)
    mean: float = declare.number(MEAN, "mean over the runs", column=MAIN, bounds="low high")
    low: float = declare.number(MEAN, "low bound of the mean at 95 %")
    high: float = declare.number(MEAN, "high bound of the mean at 95 %")
    cv: float = declare.number(
        VARIATION._replace(label="CV"), "coefficient of variation between runs", column=MAIN, bounds="cv_low cv_high"
    )
    cv_low: float = declare.number(VARIATION, "low bound of that at 95 %")
    cv_high: float = declare.number(VARIATION, "high bound of that at 95 %")
    runs: int = declare.count("runs that have it")
    quantity: Quantity = NOT_MEASURED

    @classmethod
    def of_values(cls, name: str, values: Sequence[float]) -> RunStatistic:
        """Return the statistic of a figure, of what runs have; see `strikewave.records.campaign.Statistic`."""
        one = statistic([value for value in values if math.isfinite(value)])
        numbers = one.mean, one.low, one.high, one.cv, one.cv_low, one.cv_high
        return cls(FIGURES[name].label, *numbers, one.n, FIGURES[name])

    @property
    def given_units(self) -> declare.GivenUnits:
        """What the figure measures."""
        return {OF_FIGURE.given_by: self.quantity}


@declare.dataclass
class Figure:
    """Scatter of a figure of the blows.

    What 95 % of all runs keep counts runs that failed or missed a blow as beyond every limit.
    """

    mean: RunStatistic = declare.part(RunStatistic, "of the means of the runs", quantity=MEAN)
    typical: RunStatistic = declare.part(
        RunStatistic, "of the typical blow of each run, the median of the later full or double ones", quantity=MEAN
    )
    within: RunSpread = declare.part(RunSpread, "of the blows of a run", key="cv_within", quantity=VARIATION)
    later: RunSpread = declare.part(RunSpread, "without the first blow", key="cv_within_later", quantity=VARIATION)


@declare.dataclass
class WithinRow:
    """Scatter of a figure within a run, and what the dynamics alone make."""

    figure: str = declare.word("which figure", column=KEY)
    blows: str = declare.word("all blows, or without the first", column=KEY)
    dynamics_alone: float = declare.number(VARIATION._replace(label="dynamics alone"), "nominal", column=MAIN)
    spread: RunSpread = declare.part(RunSpread, "over the runs")

    @declare.phrase("95 % of runs below", quantity=VARIATION, column=MAIN)
    def limit(self) -> str:
        """Say what 95 % of all runs keep."""
        return limit_words(self.spread.limit, "none").removesuffix(" %")


@declare.dataclass
class NominalFigure:
    """A figure of the blows of the run without scatter."""

    blows: Array = declare.word("of the run without scatter: the figure of each blow")
    mean: float = declare.number(MEAN, "mean of these")
    typical: float = declare.number(MEAN, "median of the later full or double blows")
    cv: float = declare.number(VARIATION, "coefficient of variation")
    cv_later: float = declare.number(VARIATION, "the same without the first blow")


@declare.dataclass
class OddBlows:
    """Blows of a kind that are not full."""

    blows: int = declare.count("how many blows missed, were double, or glanced", column=MAIN)
    runs: int = declare.count("in how many runs", label="runs", column=MAIN)


@declare.dataclass
class PeakBand:
    """Percentiles of the peak of each blow over the runs."""

    percentiles: tuple[float, ...] = declare.word("which percentiles follow")
    low: Array = declare.history(PEAK, "low percentile of the peak of each blow, over the runs")
    median: Array = declare.history(PEAK, "median")
    high: Array = declare.history(PEAK, "high percentile")


@declare.dataclass
class Tolerance:
    """What is drawn, and how; what a table of shares says of it."""

    path: str = declare.word("path of what scatters", label="tolerance", column=KEY, tables="drawn alone sobol")
    value: str = declare.word(
        "the value with its tolerance, as typed", column=MORE, tables="drawn alone sobol", in_document=False
    )
    nominal: float = declare.number(OF_PATH, "its value, SI")
    half_width: float | None = declare.number(OF_PATH, "half of its tolerance, SI")
    unit: str = declare.word("SI unit of both")
    typed: str | float = declare.word("the tolerance as typed")
    distribution: str = declare.word("normal or uniform", column=MAIN, tables="drawn")
    drawn: str = declare.word("once a run, or for each striker", column=MORE, tables="drawn alone sobol")
    provenance: str = declare.word("where the value comes from", column=MORE, tables="drawn alone sobol", is_tag=True)
    note: str = declare.word("what the case says of it", column=MAIN, tables="drawn")

    @classmethod
    def of_input(cls, one: UncertainInput) -> Tolerance:
        """Return what documents and tables have of an input."""
        value, band = one.value, one.value.tolerance
        assert band is not None
        drawn = "for each striker" if one.strikers else "once a run"
        numbers = f"{value.typed} ± {band.typed}", value.si, value.half_width, one.allowed.unit or NO_UNIT
        return cls(one.path, *numbers, band.typed, band.distribution, drawn, value.provenance, value.note)


@declare.dataclass
class ShareRow:
    """A tolerance and its share."""

    tolerance: Tolerance = declare.part(Tolerance, "what is drawn")
    share: Share = declare.part(Share, "its share")


@declare.dataclass
class LargestShare:
    """The largest share among the key numbers."""

    name: str = declare.word("path of the tolerance")
    share: float = declare.number(Quantity(NO_UNIT, "%", "share", 0, 0), "its share", headline="share of {name}")


@declare.dataclass
class FoundShares:
    """How shares were found, and what they are."""

    method: str = declare.word("how shares were found: alone, sobol or none")
    of: tuple[Shares, ...] = declare.rows(Shares, "shares in each quantity")


def limit_words(limit: float, nothing: str) -> str:
    """Return what runs keep, or that they keep none; a dash where too few runs tell nothing."""
    return nothing if math.isinf(limit) else amount(VARIATION, limit)
