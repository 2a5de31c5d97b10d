"""Scatter of a machine's blows: full runs of the case with everything that has a tolerance drawn anew.

The dynamics alone, one run at nominal values, stand apart: blows differ there too, since each meets the object
where the one before has left it.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import run_verdict
from strikewave.base import declare
from strikewave.base.citations import citation
from strikewave.base.compiling import compiling_shown
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, NOT_MEASURED, Quantity
from strikewave.base.errors import InputError, IntegrationError, show
from strikewave.base.result import INFO, RUN_FAILED, Notice, Verdicts
from strikewave.base.shock_quantities import (
    ACCELERATION,
    OF_FIGURE,
    PULSE_WIDTH,
    TOTAL_PEAK,
    VARIATION,
    VELOCITY_CHANGE,
)
from strikewave.cases.case import Case, dump_case
from strikewave.machines import Blow, Machine, MachineRun, blows, run_machine
from strikewave.machines.blows import KINDS
from strikewave.records.campaign import statistic
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import axis_unit
from strikewave.reporting.shown_result import Curve
from strikewave.studies.engine.evaluation import MOST_REASON, Job, KeptHistory, RunOutcome
from strikewave.studies.engine.plan import MOST_SEED, DrawVariation
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Workers, as_workers, at_work, carry_out
from strikewave.studies.engine.store import RunStore, store_in
from strikewave.studies.simulation import FINER_TOLERANCE, RUN_TOLERANCE
from strikewave.studies.study import Study, key_number
from strikewave.uncertainty.draws import (
    UncertainInput,
    drawn,
    drawn_case,
    nominal,
    random_points,
    tolerances_of,
    unfelt,
)
from strikewave.uncertainty.shares import (
    Share,
    Shares,
    mixtures,
    scatter_shares,
    sobol_points,
    sobol_shares,
    variance_shares,
)
from strikewave.uncertainty.statistics import RunSpread, spread, variation

Array = NDArray[np.float64]

FIGURES = {
    "peak": TOTAL_PEAK._replace(label="peak"),
    "width": PULSE_WIDTH._replace(decimals=None, digits=5),
    "interval": Quantity("s", "ms", "interval", digits=5),
    "velocity_change": VELOCITY_CHANGE._replace(label="velocity change", decimals=None, digits=5),
}
"""Figures of each blow and what they measure: attributes of `RunResult` and of `Blow`, whose ``rigid_peak`` is called
peak here."""
UNITS = {"kind": NO_UNIT, **{name: quantity.si for name, quantity in FIGURES.items()}}
"""SI units of what is kept of each blow; kinds by their place in `KINDS`."""
TYPICAL_KINDS = ("full", "double")
"""Kinds of blow that may be typical: a glancing or missed one has no pulse of the whole striker."""


def _none() -> Array:
    return np.empty(0)


@dataclass(frozen=True, eq=False)
class RunResult:
    """Result of one run: kind and figures of each blow in order of time, SI; NaN where a blow has none.

    ``interval`` is the time since the blow before; NaN where that one missed. A run that could not be made has no
    blows, and says why in ``failure``. ``verdict`` is the text of `strikewave.base.result.Verdict`; empty where no
    verdict was kept.
    """

    kinds: tuple[str, ...] = ()
    peak: Array = field(default_factory=_none)
    width: Array = field(default_factory=_none)
    interval: Array = field(default_factory=_none)
    velocity_change: Array = field(default_factory=_none)
    largest_displacement: float = np.nan
    failure: str = ""
    verdict: str = ""

    @property
    def struck(self) -> NDArray[np.bool_]:
        """True for each blow that struck."""
        return np.array([kind != "missed" for kind in self.kinds], dtype=bool)

    def figure(self, name: str, later: bool = False) -> Array:
        """Return a figure of the blows that have one; with ``later`` without the first blow."""
        values: Array = getattr(self, name)[self.struck][1 if later else 0 :]
        return values[np.isfinite(values)]

    def mean(self, name: str) -> float:
        """Return the mean of a figure over the blows, NaN where there is none."""
        values = self.figure(name)
        return float(np.mean(values)) if values.size else np.nan

    def typical(self, name: str) -> float:
        """Return the median of a figure over the later full or double blows, NaN where there is none."""
        later = np.array([kind in TYPICAL_KINDS for kind in self.kinds], dtype=bool)
        later[: int(np.argmax(self.struck)) + 1 if self.struck.any() else 0] = False
        values = getattr(self, name)[later]
        values = values[np.isfinite(values)]
        return float(np.median(values)) if values.size else np.nan

    def variation(self, name: str, later: bool = False) -> float:
        """Return the coefficient of variation of a figure over the blows, NaN where there are too few."""
        return variation(self.figure(name, later))

    def over(self, other: RunResult) -> RunResult:
        """Return the run with its peaks over those of the same blows of another."""
        ratio = np.full(self.peak.size, np.nan)
        both = min(self.peak.size, other.peak.size)
        ratio[:both] = self.peak[:both] / other.peak[:both]
        return replace(self, peak=ratio)


def run_result(case: Case) -> RunResult:
    """Run a machine case and return what its blows were; what cannot be run says why.

    A motion that cannot be followed is tried again with `FINER_TOLERANCE`.
    """
    try:
        machine = build_machine(case)
        run = _followed(machine)
        train = blows(run)
        return replace(of_blows(train), verdict=run_verdict(case, run, train).text)
    except (InputError, IntegrationError, ValueError) as error:
        return RunResult(failure=show(str(error), MOST_REASON).strip('"'), verdict=RUN_FAILED)


def _followed(machine: Machine) -> MachineRun:
    try:
        return run_machine(machine, RUN_TOLERANCE)
    except IntegrationError:
        return run_machine(machine, FINER_TOLERANCE)


def of_blows(train: Sequence[Blow]) -> RunResult:
    """Return kinds and figures of the blows of a run."""
    missed = np.array([blow.kind == "missed" for blow in train], dtype=bool)
    times = np.array([blow.time for blow in train])
    interval = np.diff(times, prepend=np.nan)
    interval[missed | np.concatenate([[True], missed[:-1]])[: times.size]] = np.nan
    change = np.where(missed, np.nan, [blow.velocity_change for blow in train])
    displacements = [blow.largest_displacement for blow in train if np.isfinite(blow.largest_displacement)]
    return RunResult(
        kinds=tuple(blow.kind for blow in train),
        peak=np.array([blow.rigid_peak for blow in train]),
        width=np.array([blow.width for blow in train]),
        interval=interval,
        velocity_change=change,
        largest_displacement=max(displacements, default=np.nan),
    )


@dataclass(frozen=True)
class TrainEvaluation:
    """The numbers of a full run: kind and figures of each blow."""

    names: tuple[str, ...] = ("largest_displacement",)

    def __call__(self, case: Case) -> RunOutcome:
        """Return what the blows of a case are; a run that cannot be made says why."""
        run = run_result(case)
        if run.failure:
            return RunOutcome(failure=run.failure)
        kinds = np.array([KINDS.index(kind) for kind in run.kinds], dtype=float)
        columns = {"kind": kinds, **{name: getattr(run, name) for name in FIGURES}}
        histories = [KeptHistory(name, UNITS[name], 0, np.nan, np.nan, values) for name, values in columns.items()]
        return RunOutcome((run.largest_displacement,), tuple(histories), verdict=run.verdict)


@dataclass
class Runner:
    """Runs a case at drawn values, each alone, so that no number depends on it; ``advance`` takes how many are done.

    Attributes
    ----------
    case : Case
        Case of a machine.
    tolerances : tuple of UncertainInput
        Inputs whose values are drawn.
    store : RunStore
        Finished runs.
    pool : Pool
        Pool that runs the draws.
    """

    case: Case
    tolerances: tuple[UncertainInput, ...]
    store: RunStore
    pool: Pool
    advance: Callable[[int], None] = lambda done: None
    done: int = 0

    def __call__(self, rows: Array) -> list[RunResult]:
        """Return a run for each row of drawn values, in their order."""
        job, begun = Job(DrawVariation(self.case, self.tolerances), TrainEvaluation()), self.done
        places = [tuple(row) for row in rows.tolist()]
        keys = carry_out(job, places, self.store, self.pool, lambda now: self.advance(begun + now.done)).keys
        self.done += len(places)
        self.advance(self.done)  # runs that the store had already came in no batch
        return kept_runs(self.store, keys)


def kept_runs(store: RunStore, keys: Sequence[bytes]) -> list[RunResult]:
    """Return runs that a store has, in the order of their keys."""
    wanted = dict.fromkeys(keys)
    blows: dict[bytes, dict[str, Array]] = {key: {} for key in wanted}
    for key, history in store.histories():
        if key in wanted:
            blows[key][history.name] = history.values
    numbers, failures = store.table(TrainEvaluation().names, keys)
    verdicts = store.verdicts(keys).texts
    runs = []
    for key, (displacement,), failure, verdict in zip(keys, numbers, failures, verdicts, strict=True):
        of_run: dict[str, Any] = {} if failure else {"largest_displacement": float(displacement), **blows[key]}
        of_run["kinds"] = tuple(KINDS[int(code)] for code in of_run.pop("kind", ()))
        runs.append(RunResult(failure=failure, verdict=verdict, **of_run))
    return runs


METHODS = ("alone", "sobol", "none")
"""Methods by which shares are computed; see `strikewave.uncertainty.shares`."""
RUNS = 500
"""Runs where none are asked for. Chosen: a minute at 0.1 s each; a CV between runs is then known to 6 % of itself."""
FEWEST = 10
"""Fewest runs: below, the bounds of a CV are wider than the CV itself."""
MOST = 20_000
"""Most runs: bounds narrow with the root of their number, and at 0.1 s each (measured, li-ma-2019) they take half an
hour already."""
SHARE_RUNS = 4
"""Each tolerance alone gets one in so many runs, and as many Sobol's samples get. Chosen: 17 tolerances then take
four times as long as the runs themselves; four times the runs would only halve the bounds."""
FEWEST_SHARE_RUNS = 32
"""Fewest runs of each tolerance alone: a variance of fewer is known to no better than a quarter of itself."""
BAND = (2.5, 50.0, 97.5)
"""Percentiles of the peaks of each blow: the median, and the band that holds 95 % of the runs."""
BETWEEN = "variance of the typical peak"
"""Shares between runs are of this; see `strikewave.uncertainty.shares`."""
BETWEEN_CV = "variance of the CV of the peaks"
"""Sobol's shares of the scatter within a run are of this."""
ADDED = "scatter of the peaks within a run that tolerances add"
"""Shares within a run of each tolerance alone are of this."""
COUNTED_KINDS = ("full", "missed", "double", "glancing")
"""Kinds of blow that the table of runs counts, in the order of its columns."""
COLUMNS: dict[str, Callable[[RunResult, str], float]] = {
    "mean": RunResult.mean,
    "typical": RunResult.typical,
    "cv of": RunResult.variation,
}
"""Columns of the table of runs for each figure: head of the column, and how it is read from a run."""
SHOWN = ("mean peak", "cv of peak", "mean width", "mean interval")
"""Columns that screens and notebooks show."""
STATEMENTS = {
    "mean": "mean of the runs' means with bounds at 95 % (Student's t); cv between runs with bounds at 95 % (Vangel), "
    "which hold for normal figures",
    "typical": "the same of the median of each run's later full or double blows",
    "cv_within": "standard deviation (n - 1) over mean of the blows of a run: median over the runs with bounds at "
    "95 %, and a limit that 95 % of all runs keep, with 95 % confidence, both by order statistics; a run that "
    "failed or missed a blow keeps no limit",
    "drawn": "a normal tolerance is two standard deviations, cut off at three; a uniform one is the whole band",
    "shares": "with bootstrap bounds at 95 %; a share whose bounds reach 0 is not significant",
}
"""Definitions of the numbers of the document."""


PEAK, WIDTH, OF_PATH = Quantity("m/s^2", "g"), Quantity("s", "us"), Quantity.of_data("SI of its path")
MEAN = OF_FIGURE._replace(label="mean", digits=5)


@declare.dataclass
class ScatterPlan:
    """Runs of a scatter study: see `scatter`."""

    runs: int = declare.count("how many runs", default=RUNS)
    seed: int = declare.count("of the draws", default=1)
    shares: str = "alone"

    def check(self) -> None:
        """Refuse what cannot be done."""
        for option, got, low, high in (("--runs", self.runs, FEWEST, MOST), ("--seed", self.seed, 0, MOST_SEED)):
            if not low <= got <= high:
                raise InputError(option, got, f"a whole number from {low} to {high}")
        if self.shares not in METHODS:
            raise InputError("--shares", self.shares, "one of " + ", ".join(METHODS))

    @property
    def share_runs(self) -> int:
        """Runs of each tolerance alone, or of each of Sobol's samples: then the next power of two."""
        runs = max(self.runs // SHARE_RUNS, min(self.runs, FEWEST_SHARE_RUNS))
        return runs if self.shares != "sobol" else 2 ** math.ceil(math.log2(runs))

    def all_runs(self, tolerances: int) -> int:
        """Return how many runs there are in all, the nominal one included."""
        extra = {"alone": tolerances, "sobol": tolerances + 2, "none": 0}[self.shares]
        return 1 + self.runs + extra * self.share_runs

    def marked_text(self, case: Case) -> str:
        """Return the case as text, and above it what was asked: another seed is another result."""
        asked = f"# strikewave scatter --runs {self.runs} --seed {self.seed} --shares {self.shares}\n"
        return asked + dump_case(case)


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
        known = statistic([value for value in values if math.isfinite(value)])
        numbers = known.mean, known.low, known.high, known.cv, known.cv_low, known.cv_high
        return cls(FIGURES[name].label, *numbers, known.n, FIGURES[name])

    @property
    def given_units(self) -> declare.GivenUnits:
        """The quantity that the figure measures."""
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
    """A tolerance: how it is drawn, and its row in a table of shares."""

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
    def of_input(cls, drawn_input: UncertainInput) -> Tolerance:
        """Return what documents and tables have of an input."""
        value, band = drawn_input.value, drawn_input.value.tolerance
        assert band is not None
        drawn = "for each striker" if drawn_input.strikers else "once a run"
        numbers = f"{value.typed} ± {band.typed}", value.si, value.half_width, drawn_input.allowed.unit or NO_UNIT
        return cls(drawn_input.path, *numbers, band.typed, band.distribution, drawn, value.provenance, value.note)


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
    """Shares in each quantity, and the method that found them."""

    method: str = declare.word("how shares were found: alone, sobol or none")
    of: tuple[Shares, ...] = declare.rows(Shares, "shares in each quantity")


def limit_words(limit: float, nothing: str) -> str:
    """Return what runs keep, or that they keep none; a dash where too few runs tell nothing."""
    return nothing if math.isinf(limit) else amount(VARIATION, limit)


@declare.dataclass(eq=False)
class ScatterStudy(Study):
    """Runs of a case within its tolerances; see `scatter`, and `Result` for what it shares with others."""

    command: ClassVar[str] = "scatter"
    main_rows: ClassVar[str] = "run_table"
    indent: ClassVar[int | None] = 2

    case: Case
    plan: ScatterPlan = declare.part(ScatterPlan, "how many runs", inline=True)
    tolerances: tuple[UncertainInput, ...]
    numbers: Array
    runs: tuple[RunResult, ...]
    nominal_run: RunResult
    shares: tuple[Shares, ...]

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what was asked."""
        return self.plan.marked_text(self.case)

    @property
    def completed(self) -> list[RunResult]:
        """The runs that could be made to their end."""
        return [run for run in self.runs if not run.failure]

    run_count = declare.computed(declare.count("runs that were made to their end", headline="runs", in_document=False))(
        lambda study: len(study.completed)
    )
    failed = declare.computed(declare.count("how many failed"))(lambda study: len(study.runs) - len(study.completed))
    unlimited = declare.computed(
        declare.count("how many keep no limit, as they failed or missed a blow", key="without_limit")
    )(lambda study: sum(study.without_limit))
    statements = declare.computed(declare.word("what the statistics are, in words"))(lambda study: STATEMENTS)
    sources = declare.computed(declare.word("sources of the statistics"))(
        lambda study: [citation(key) for key in study.citations]
    )
    drawn = declare.computed(declare.rows(Tolerance, "what was drawn", key="tolerances"))(
        lambda study: [Tolerance.of_input(one) for one in study.tolerances]
    )

    @declare.computed(declare.named(NominalFigure, "figures of the run without scatter"))
    def dynamics_alone(self) -> dict[str, NominalFigure]:
        """The figures of the nominal run."""
        still = self.nominal_run
        return {
            name: NominalFigure(
                getattr(still, name),
                still.mean(name),
                still.typical(name),
                still.variation(name),
                still.variation(name, later=True),
            )
            for name in FIGURES
        }

    @declare.computed(declare.named(Figure, "scatter of each figure"))
    def figures(self) -> dict[str, Figure]:
        """Scatter of each figure."""
        runs = self.completed
        return {
            name: Figure(
                RunStatistic.of_values(name, [run.mean(name) for run in runs]),
                RunStatistic.of_values(name, [run.typical(name) for run in runs]),
                spread([run.variation(name) for run in self.runs], self.without_limit),
                spread([run.variation(name, later=True) for run in self.runs], self.without_limit),
            )
            for name in FIGURES
        }

    means = declare.computed(declare.rows(RunStatistic, "means of the runs, and CV between runs", in_document=False))(
        lambda study: [one.mean for one in study.figures.values()]
    )
    typical_blows = declare.computed(
        declare.rows(RunStatistic, "typical blow of each run, and CV between runs", in_document=False)
    )(lambda study: [one.typical for one in study.figures.values()])

    @declare.computed(declare.rows(WithinRow, "scatter within a run", in_document=False))
    def within(self) -> list[WithinRow]:
        """Scatter within a run of each figure: of all blows, and without the first."""
        return [
            WithinRow(FIGURES[name].label, blows, still, spread)
            for name, figure in self.figures.items()
            for alone in [self.dynamics_alone[name]]
            for blows, still, spread in (("all", alone.cv, figure.within), ("later", alone.cv_later, figure.later))
        ]

    @property
    def without_limit(self) -> list[bool]:
        """True for each run that keeps no limit of the scatter within a run: it failed, or missed a blow."""
        return [bool(run.failure) or "missed" in run.kinds for run in self.runs]

    @declare.computed(declare.named(OddBlows, "blows that are not full", key="kinds", label="kind"))
    def odd_blows(self) -> dict[str, OddBlows]:
        """The numbers of blows that were missed, double and glancing, and of the runs that have them."""
        counts = {kind: [run.kinds.count(kind) for run in self.completed] for kind in ("missed", "double", "glancing")}
        return {kind: OddBlows(sum(of_runs), sum(map(bool, of_runs))) for kind, of_runs in counts.items()}

    @declare.computed(declare.part(PeakBand, "peaks of each blow over the runs", key="peaks", quantity=PEAK))
    def peak_band(self) -> PeakBand:
        """Percentiles `BAND` of the peaks of each blow over the runs."""
        longest = max(len(run.kinds) for run in self.completed)
        table = np.full((len(self.completed), longest), np.nan)
        for row, run in zip(table, self.completed, strict=True):
            row[: run.peak.size] = run.peak
        peaks = [column[np.isfinite(column)] for column in table.T]
        return PeakBand(BAND, *np.array([np.percentile(p, BAND) if p.size else np.full(3, np.nan) for p in peaks]).T)

    def found_notices(self) -> tuple[Notice, ...]:
        """Return what should be known."""
        notices = list(self.verdicts.notices())
        outside = unfelt(self.case, self.tolerances)
        if outside:
            message = f"no blow depends on {', '.join(outside)}: this tolerance does not enter"
            notices.append(Notice("tolerance-not-felt", message, float(len(outside)), 0.0, severity=INFO))
        for shares in self.shares:
            if self.plan.shares == "alone" and math.isfinite(shares.sum_low) and not shares.additive:
                message = (
                    f"the shares in the {shares.of} add up to {shares.sum:.2f} ({shares.sum_low:.2f} to "
                    f"{shares.sum_high:.2f}), not 1: tolerances interact; --shares sobol shows how"
                )
                notices.append(Notice("tolerances-interact", message, shares.sum, 1.0))
        return tuple(notices)

    @declare.computed(declare.number(Quantity("m", "mm", digits=3), "largest displacement of the object in any run"))
    def largest_displacement(self) -> float:
        """Largest displacement (rearward) of the object after a blow of any run."""
        return max(run.largest_displacement for run in self.completed if math.isfinite(run.largest_displacement))

    shares_found = declare.computed(declare.part(FoundShares, "shares of the tolerances", key="shares"))(
        lambda study: FoundShares(study.plan.shares, study.shares)
    )
    mean_peak = key_number(PEAK, "mean peak")(lambda study: study.figures["peak"].mean.mean)
    typical_peak = key_number(PEAK, "peak of the typical blow, mean of the runs")(
        lambda study: study.figures["peak"].typical.mean
    )
    cv_between = key_number(VARIATION, "CV of that peak from run to run")(
        lambda study: study.figures["peak"].typical.cv
    )
    cv_within = key_number(VARIATION, "CV of the peaks within a run, median")(
        lambda study: study.figures["peak"].within.median
    )

    @declare.phrase("limit", headline="CV of the peaks in 95 % of all runs at most")
    def limit(self) -> str:
        """Say what 95 % of all runs keep."""
        return limit_words(self.figures["peak"].within.limit, "no limit")

    typical_width = key_number(WIDTH, "width of the typical blow, mean of the runs")(
        lambda study: study.figures["width"].typical.mean
    )
    mean_interval = key_number(FIGURES["interval"], "interval, mean of the runs")(
        lambda study: study.figures["interval"].mean.mean
    )

    @declare.computed(declare.rows(LargestShare, "the largest share", headline="first", in_document=False))
    def largest_share(self) -> list[LargestShare]:
        """The largest share in the first quantity; none where no shares were found."""
        return [LargestShare(row.path, row.share) for shares in self.shares[:1] for row in shares.rows[:1]]

    @declare.computed(declare.table("the runs: what was drawn, and what came of it"))
    def run_table(self) -> list[Column]:
        """All runs: what was drawn, and what came of it."""
        runs = self.runs
        units = [tolerance.allowed.unit for tolerance in self.tolerances for _ in range(tolerance.count)]
        names = [name for tolerance in self.tolerances for name in tolerance.names]
        columns = [Column("run", range(1, len(runs) + 1), shown="")]
        for name, si, values in zip(names, units, np.transpose(self.numbers), strict=True):
            columns.append(Column(name, values, si or NO_UNIT))
        columns.append(Column("blows", [len(run.kinds) for run in runs], shown=""))
        columns += [Column(kind, [run.kinds.count(kind) for run in runs]) for kind in COUNTED_KINDS]
        for name, tolerance in FIGURES.items():
            for how, read in COLUMNS.items():
                measured = VARIATION if how == "cv of" else tolerance
                values = [float(read(run, name)) for run in runs]
                is_shown = f"{how} {name}" in SHOWN
                columns.append(Column(f"{how} {name}", values, measured.si, "", measured.usual if is_shown else None))
        columns.append(Column("largest displacement", [float(run.largest_displacement) for run in runs], "m"))
        columns.append(Column("verdict", [run.verdict for run in runs], shown=""))
        return [*columns, Column("failure", [run.failure for run in runs])]

    @property
    def named_units(self) -> Mapping[str, str]:
        """SI units of the figures."""
        return {name: quantity.si for name, quantity in FIGURES.items()}

    def share_rows(self, shares: Shares) -> list[ShareRow]:
        """Return a row a tolerance, the largest share first."""
        known = {tolerance.path: tolerance for tolerance in self.drawn}
        return [ShareRow(known[row.path], row) for row in shares.rows]

    def preview(self) -> Curve:
        """Return the median peak of each blow over the runs."""
        size, name = axis_unit(*ACCELERATION.units)
        median = self.peak_band.median
        return Curve(np.arange(1.0, median.size + 1.0), median / size, "blow", f"median peak ({name})")

    def tables(self) -> dict[str, str]:
        """Return the table of runs."""
        return {"runs.csv": csv_table(self.run_table)}


def scatter(
    case: Case,
    *,
    runs: int = RUNS,
    seed: int = 1,
    shares: str = "alone",
    workers: int | Workers = 1,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> ScatterStudy:
    """Run a case many times within its tolerances.

    Equal seeds reproduce the runs bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        Case of a machine, with a tolerance at least.
    runs, seed : int, optional
        Draws within the tolerances, and their seed.
    shares : str, optional
        Method for the share of each tolerance: ``alone``, by runs in which it alone moves, ``sobol``, with the
        interactions of tolerances, or ``none``.
    workers : int or Workers, optional
        Processes, or who runs instead, such as ``strikewave.Workers(cluster="tcp://host:8786")``.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    ScatterStudy
        Statistics of each result over the runs, and the share of each input in its spread.

    Raises
    ------
    InputError
        If the case has no tolerance, its nominal run cannot be made, or too few of the others.
    StrikewaveError
        If a process ended before its time.
    """
    plan = ScatterPlan(runs, seed, shares)
    with store_in(store) as finished:
        return make_scatter(case, plan, finished, as_workers(workers).pool(), progress)


@compiling_shown()
def make_scatter(
    case: Case,
    plan: ScatterPlan,
    store: RunStore | None = None,
    pool: Pool | None = None,
    progress: Callable[[float], None] | None = None,
) -> ScatterStudy:
    """Make a scatter study: all runs that a store does not have yet; the pool is ended here."""
    plan.check()
    case.rotary_tables()
    tolerances = tolerances_of(case)
    total = plan.all_runs(len(tolerances))
    points = random_points(tolerances, plan.runs, plan.seed)
    numbers = drawn(tolerances, points)
    nominal_run = run_result(drawn_case(case, tolerances, nominal(tolerances)[0].tolist()))
    if nominal_run.failure or not nominal_run.struck.any():
        raise InputError("case", nominal_run.failure or "no blow", "a case whose nominal run strikes")

    def advance(done: int) -> None:
        if progress is not None:
            progress((1 + done) / total)

    with at_work(store, pool) as (open_store, open_pool):
        runner = Runner(case, tolerances, open_store, open_pool, advance)
        runs = runner(numbers)
        sobol = ("saltelli-2010", "jansen-1999") if plan.shares == "sobol" else ()
        citations = ("vangel-1996", "wilks-1941", *sobol)
        reason = next((run.failure for run in runs if run.failure), "")
        verdicts = Verdicts([run.verdict for run in runs], reason=reason)
        known = case, plan, tolerances, numbers, tuple(runs), nominal_run, ()
        study = ScatterStudy(*known, citations=citations, verdicts=verdicts)
        if sum(run.struck.any() for run in study.completed) < FEWEST:
            raise InputError(
                "tolerance", reason or "no blow struck", f"tolerances with which at least {FEWEST} runs can be made"
            )
        study = dataclasses.replace(study, shares=_shares_of(study, points, runner))
        return dataclasses.replace(study, notices=study.found_notices())


def _shares_of(study: ScatterStudy, points: Array, runner: Runner) -> tuple[Shares, ...]:
    """Return the shares in the typical peak's variance between runs, and in the scatter of the peaks within a run."""
    tolerances, plan, count = study.tolerances, study.plan, study.plan.share_runs
    paths, sizes = [tolerance.path for tolerance in tolerances], [tolerance.count for tolerance in tolerances]
    if plan.shares == "none":
        return ()
    if plan.shares == "sobol":
        first, second, mixtures_of = mixtures(sobol_points(sum(sizes), count, plan.seed), sizes)
        a, b, *mixed = _in_parts(runner, [drawn(tolerances, part) for part in (first, second, *mixtures_of)])
        return tuple(
            sobol_shares(of, paths, read(a), read(b), np.array([read(sample) for sample in mixed]), plan.seed)
            for of, read in ((BETWEEN, _typical), (BETWEEN_CV, _variation))
        )
    # each tolerance alone: its values are those of the full runs, so that both differ by the other tolerances only
    rows = np.repeat(nominal(tolerances), count, axis=0)
    parts, place = [], 0
    for size in sizes:
        part = rows.copy()
        part[:, place : place + size] = study.numbers[:count, place : place + size]
        parts.append(part)
        place += size
    alone = _in_parts(runner, parts)
    together = study.runs[:count]
    return (
        variance_shares(BETWEEN, paths, _typical(together), np.array([_typical(runs) for runs in alone]), plan.seed),
        scatter_shares(
            ADDED,
            paths,
            _added(together, study.nominal_run),
            np.array([_added(runs, study.nominal_run) for runs in alone]),
            plan.seed,
        ),
    )


def _in_parts(runner: Runner, parts: Sequence[Array]) -> list[list[RunResult]]:
    """Return the runs of several samples, made together so that no process waits for the end of each."""
    runs = iter(runner(np.vstack(parts)))
    return [list(itertools.islice(runs, len(part))) for part in parts]


def _typical(runs: Sequence[RunResult]) -> Array:
    return np.array([run.typical("peak") for run in runs])


def _variation(runs: Sequence[RunResult]) -> Array:
    return np.array([run.variation("peak") for run in runs])


def _added(runs: Sequence[RunResult], nominal_run: RunResult) -> Array:
    """Return the coefficients of variation of the peaks over those of the nominal run, blow by blow."""
    return np.array([run.over(nominal_run).variation("peak") for run in runs])
