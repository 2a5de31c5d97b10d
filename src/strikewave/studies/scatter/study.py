"""Scatter of a machine's blows: full runs of the case with everything that has a tolerance drawn anew.

The dynamics alone, one run at nominal values, stand apart: blows differ there too, since each meets the object
where the one before has left it.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.citations import citation
from strikewave.base.compile_progress import compiling_shown
from strikewave.base.errors import InputError
from strikewave.base.result import INFO, Notice, Source, Verdicts
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.records.campaign import Statistic, statistic
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.numbers import axis_unit, percent, with_unit
from strikewave.reporting.shown_result import Curve, ShownResult
from strikewave.studies.engine.pools import Pool, ProcessPool
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.studies.scatter.runs import FIGURES, Runner, RunResult, run_result
from strikewave.uncertainty.draws import UncertainInput, drawn, drawn_case, nominal, quantiles, tolerances_of, unfelt
from strikewave.uncertainty.shares import (
    Shares,
    mixtures,
    scatter_shares,
    sobol_points,
    sobol_shares,
    variance_shares,
)
from strikewave.uncertainty.statistics import RunSpread, spread

Array = NDArray[np.float64]

METHODS = ("alone", "sobol", "none")
"""How shares are computed; see `strikewave.uncertainty.shares`."""
FEWEST = 10
"""Fewest runs: below, the bounds of a CV are wider than the CV itself."""
MOST = 20_000
"""Most runs: bounds narrow with the root of their number, and at 0.1 s each (measured, li-ma-2019) they take half an
hour already."""
MOST_SEED = 2**63 - 1
"""Largest seed: that of a 64-bit integer, which every reader of the JSON document holds."""
MOST_WORKERS = 64
"""Most processes. Chosen: beyond the cores of a large machine; a typing error shall not start thousands."""
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
KINDS = ("full", "missed", "double", "glancing")
"""Kinds of blow that the table of runs counts, in the order of its columns."""
FIGURE_UNITS = {"peak": "m/s^2", "width": "s", "interval": "s", "velocity_change": "m/s"}
"""Figures of a blow and their SI units."""
COLUMNS: tuple[tuple[str, Callable[[RunResult, str], float]], ...] = (
    ("mean", RunResult.mean),
    ("typical", RunResult.typical),
    ("cv of", RunResult.variation),
)
"""What the table of runs holds of each figure: head of the column, and how it is read from a run."""
UNITS = {
    **FIGURE_UNITS, "cv": "1", "share": "1", "total": "1", "largest_displacement": "m",
    "nominal": "SI of its path", "half_width": "SI of its path",
}  # fmt: skip
"""SI unit of each quantity of the document."""
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
"""What the numbers of the document are."""


@dataclass(frozen=True)
class ScatterPlan:
    """How many runs, from which seed, how shares are found, and on how many processes.

    Parameters
    ----------
    runs : int, optional
        Draws within the tolerances.
    seed : int, optional
        Of the draws.
    shares : str, optional
        How the share of each tolerance is found: ``alone``, by runs in which it alone moves, ``sobol``, with what
        tolerances do together, or ``none``.
    workers : int, optional
        Processes.
    """

    runs: int = 500
    seed: int = 1
    shares: str = "alone"
    workers: int = 1

    def check(self) -> None:
        """Refuse what cannot be done.

        Raises
        ------
        InputError
            With the option.
        """
        for field, got, low, high in (
            ("--runs", self.runs, FEWEST, MOST),
            ("--seed", self.seed, 0, MOST_SEED),
            ("--workers", self.workers, 1, MOST_WORKERS),
        ):
            if not low <= got <= high:
                raise InputError(field, got, f"a whole number from {low} to {high}")
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


class Figure(NamedTuple):
    """Scatter of a figure of the blows.

    Attributes
    ----------
    mean : Statistic
        Of the means of the runs: mean and its bounds, scatter between runs and its bounds.
    typical : Statistic
        The same of the typical blow of each run, the median of the later full or double ones.
    within, later : RunSpread
        Coefficient of variation of the blows of a run, over the runs; without the first blow. What 95 % of all runs
        keep counts runs that failed or missed a blow as beyond every limit.
    """

    mean: Statistic
    typical: Statistic
    within: RunSpread
    later: RunSpread


@dataclass(frozen=True, eq=False)
class ScatterStudy(ShownResult):
    """Runs of a case within its tolerances; see `scatter`, and `Result` for what it shares with others.

    ``asked`` is the command line that gives it again, where one does.
    """

    command: ClassVar[str] = "scatter"

    case: Case
    plan: ScatterPlan
    tolerances: tuple[UncertainInput, ...]
    numbers: Array
    runs: tuple[RunResult, ...]
    nominal_run: RunResult
    shares: tuple[Shares, ...]
    asked: str = ""

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @property
    def source(self) -> Source:
        """The case, and above it what was asked."""
        return Source("case", self.case.name, marked_text(self.case, self.plan), asked=self.asked)

    @property
    def completed(self) -> list[RunResult]:
        """The runs that could be made to their end."""
        return [run for run in self.runs if not run.failure]

    def figure(self, name: str) -> Figure:
        """Return the scatter of a figure."""
        runs = self.completed
        return Figure(
            statistic(_known([run.mean(name) for run in runs])),
            statistic(_known([run.typical(name) for run in runs])),
            spread([run.variation(name) for run in self.runs], self.without_limit),
            spread([run.variation(name, later=True) for run in self.runs], self.without_limit),
        )

    @property
    def without_limit(self) -> list[bool]:
        """Which of the runs keep no limit of the scatter within a run: they failed, or missed a blow."""
        return [bool(run.failure) or "missed" in run.kinds for run in self.runs]

    def kinds(self) -> dict[str, tuple[int, int]]:
        """Return how many blows were missed, double and glancing, and in how many runs."""
        counts = [Counter(run.kinds) for run in self.completed]
        return {
            kind: (sum(count[kind] for count in counts), sum(count[kind] > 0 for count in counts))
            for kind in ("missed", "double", "glancing")
        }

    def peaks(self) -> Array:
        """Return the percentiles `BAND` of the peaks of each blow over the runs, shape (3, blows)."""
        longest = max(len(run.kinds) for run in self.completed)
        table = np.full((len(self.completed), longest), np.nan)
        for row, run in zip(table, self.completed, strict=True):
            row[: run.peak.size] = run.peak
        peaks = [column[np.isfinite(column)] for column in table.T]
        return np.array([np.percentile(p, BAND) if p.size else np.full(3, np.nan) for p in peaks]).T

    @property
    def largest_displacement(self) -> float:
        """Largest displacement (rearward) of the object after a blow of any run, m."""
        return max(run.largest_displacement for run in self.completed if math.isfinite(run.largest_displacement))

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

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        kinds = {kind: {"blows": blows, "runs": runs} for kind, (blows, runs) in self.kinds().items()}
        low, middle, high = self.peaks()
        return {
            "case": self.case.name,
            "runs": self.plan.runs,
            "seed": self.plan.seed,
            "failed": len(self.runs) - len(self.completed),
            "without_limit": sum(self.without_limit),
            "statements": STATEMENTS,
            "sources": [citation(key) for key in self.citations],
            "tolerances": [_tolerance(one) for one in self.tolerances],
            "dynamics_alone": self._dynamics(),
            "figures": {name: _figure(self.figure(name)) for name in FIGURES},
            "kinds": kinds,
            "peaks": {"percentiles": BAND, "low": low, "median": middle, "high": high},
            "largest_displacement": self.largest_displacement,
            "shares": {"method": self.plan.shares, "of": [_shares(one) for one in self.shares]},
        }

    def _dynamics(self) -> dict[str, Any]:
        """Return what the blows of the nominal run are."""
        still = self.nominal_run
        return {
            name: {
                "blows": getattr(still, name),
                "mean": still.mean(name),
                "typical": still.typical(name),
                "cv": still.variation(name),
                "cv_later": still.variation(name, later=True),
            }
            for name in FIGURES
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the number of runs, the mean peak and width, the scatter within a run, and the largest share."""
        peak = self.figure("peak")
        numbers = [
            ("runs", str(len(self.completed))),
            ("mean peak", with_unit(peak.mean.mean, "m/s^2", "g")),
            ("CV within a run", percent(peak.within.median, 2)),
            ("mean width", with_unit(self.figure("width").mean.mean, "s", "us")),
        ]
        for shares in self.shares[:1]:
            numbers += [(f"share of {row.path}", percent(row.share, 0)) for row in shares.rows[:1]]
        return numbers

    def preview(self) -> Curve:
        """Return the median peak of each blow over the runs."""
        size, name = axis_unit("m/s^2", "g")
        median = self.peaks()[1]
        return Curve(np.arange(1.0, median.size + 1.0), median / size, "blow", f"median peak ({name})")

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"scatter.json": self.document_text(2)}

    def tables(self) -> dict[str, str]:
        """Return the table of runs."""
        return {"runs.csv": csv_table(self.columns())}

    def columns(self) -> list[Column]:
        """Return all runs: what was drawn, and what came of it."""
        units = [one.allowed.unit for one in self.tolerances for _ in range(one.count)]
        names = [name for one in self.tolerances for name in one.names]
        columns = [Column("run", range(1, len(self.runs) + 1))]
        for name, si, values in zip(names, units, np.transpose(self.numbers), strict=True):
            columns.append(Column(name, values, si or "1"))
        columns.append(Column("blows", [len(run.kinds) for run in self.runs]))
        columns += [Column(kind, [run.kinds.count(kind) for run in self.runs]) for kind in KINDS]
        for name, si in FIGURE_UNITS.items():
            for how, read in COLUMNS:
                results = [float(read(run, name)) for run in self.runs]
                columns.append(Column(f"{how} {name}", results, "1" if how.startswith("cv ") else si))
        columns.append(Column("largest displacement", [float(run.largest_displacement) for run in self.runs], "m"))
        columns.append(Column("verdict", [run.verdict for run in self.runs]))
        return [*columns, Column("failure", [run.failure for run in self.runs])]

    def brief(self) -> dict[str, str]:
        """Return number, blows, mean peak, its scatter, width and interval of each run."""
        figures = {"mean peak": "g", "cv of peak": "1", "mean width": "us", "mean interval": "ms"}
        return {"run": "", "blows": "", **figures, "verdict": ""}


def marked_text(case: Case, plan: ScatterPlan) -> str:
    """Return the case as text, and above it what was asked: another seed is another result."""
    asked = f"# strikewave scatter --runs {plan.runs} --seed {plan.seed} --shares {plan.shares}\n"
    return asked + dump_case(case)


@compiling_shown()
def scatter(
    case: Case,
    plan: ScatterPlan | None = None,
    progress: Callable[[float], None] | None = None,
    store: RunStore | None = None,
    pool: Pool | None = None,
) -> ScatterStudy:
    """Run a case many times within its tolerances.

    Equal seeds reproduce the runs bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        Of a machine, with a tolerance at least.
    plan : ScatterPlan, optional
        Runs, seed, shares, processes. With more than one process, call it below ``if __name__ == "__main__":``.
    progress : callable, optional
        Called with the share done, 0 to 1.
    store : RunStore, optional
        Finished runs; what it holds is not run again.
    pool : Pool, optional
        Who runs the others instead, and is ended here.

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
    plan = ScatterPlan() if plan is None else plan
    plan.check()
    case.rotary_tables()
    tolerances = tolerances_of(case)
    whole = plan.all_runs(len(tolerances))
    points = quantiles(tolerances, plan.runs, plan.seed)
    numbers = drawn(tolerances, points)
    nominal_run = run_result(drawn_case(case, tolerances, nominal(tolerances)[0].tolist()))
    if nominal_run.failure or not nominal_run.struck.any():
        raise InputError("case", nominal_run.failure or "no blow", "a case whose nominal run strikes")
    advance = None if progress is None else (lambda done: progress((1 + done) / whole))
    with (
        given_or_temporary(store) as kept,
        ProcessPool(plan.workers) if pool is None else pool as ready,
    ):
        runner = Runner(case, tolerances, kept, ready, advance)
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
    paths, sizes = [one.path for one in tolerances], [one.count for one in tolerances]
    if plan.shares == "none":
        return ()
    if plan.shares == "sobol":
        first, second, mixtures_of = mixtures(sobol_points(sum(sizes), count, plan.seed), sizes)
        a, b, *mixed = _in_parts(runner, [drawn(tolerances, part) for part in (first, second, *mixtures_of)])
        return tuple(
            sobol_shares(of, paths, read(a), read(b), np.array([read(one) for one in mixed]), plan.seed)
            for of, read in (
                (BETWEEN, _typical),
                (BETWEEN_CV, _variation),
            )
        )
    rows = np.repeat(nominal(tolerances), count, axis=0)
    parts, place = [], 0
    for size in sizes:
        part = rows.copy()
        part[:, place : place + size] = study.numbers[:count, place : place + size]
        parts.append(part)
        place += size
    alone = _in_parts(runner, parts)
    whole = study.runs[:count]
    return (
        variance_shares(BETWEEN, paths, _typical(whole), np.array([_typical(runs) for runs in alone]), plan.seed),
        scatter_shares(
            ADDED,
            paths,
            _added(whole, study.nominal_run),
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


def _known(values: list[float]) -> list[float]:
    return [value for value in values if math.isfinite(value)]


def _tolerance(one: UncertainInput) -> dict[str, Any]:
    assert one.value.tolerance is not None
    return {
        "path": one.path,
        "nominal": one.value.si,
        "half_width": one.value.half_width,
        "unit": one.allowed.unit or "1",
        "typed": one.value.tolerance.typed,
        "distribution": one.value.tolerance.distribution,
        "drawn": "for each striker" if one.strikers else "once a run",
        "provenance": one.value.provenance,
        "note": one.value.note,
    }


def _figure(figure: Figure) -> dict[str, Any]:
    def of(sample: Statistic) -> dict[str, float]:
        names = ("mean", "low", "high", "cv", "cv_low", "cv_high")
        return {name: getattr(sample, name) for name in names} | {"runs": sample.n}

    within = {"cv_within": figure.within._asdict(), "cv_within_later": figure.later._asdict()}
    return {"mean": of(figure.mean), "typical": of(figure.typical), **within}


def _shares(shares: Shares) -> dict[str, Any]:
    rows = [{**dataclasses.asdict(row), "distinct_from_0": row.distinct} for row in shares.rows]
    rows = [{k: v for k, v in row.items() if v is not None and k != "floor"} for row in rows]
    bounds = {"sum": shares.sum, "sum_low": shares.sum_low, "sum_high": shares.sum_high}
    return {"of": shares.of, "runs_each": shares.runs, **bounds, "rows": rows}
