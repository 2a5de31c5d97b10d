"""A scatter study as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from strikewave.cases.case import Case, dump_case
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.measured_files import asked
from strikewave.reporting.numbers import headed, with_unit
from strikewave.reporting.options import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.terminal import number, progress_bar, table, tell
from strikewave.studies.scatter.study import ScatterPlan, ScatterStudy, marked_text, scatter
from strikewave.uncertainty.shares import Shares

SHOWN = {"peak": ("m/s^2", "g"), "width": ("s", "us"), "interval": ("s", "ms"), "velocity_change": ("m/s", "m/s")}
"""Figures of a blow, their SI units and those shown."""
NAMES = {"peak": "peak", "width": "width", "interval": "interval", "velocity_change": "velocity change"}
FEWEST_FOR_LIMIT = 59
"""Runs below which no limit holds for 95 % of all runs with 95 % confidence."""


def run_scatter(case: Case, changes: Sequence[str], plan: ScatterPlan, output: Output) -> int:
    """Run a case within its tolerances, write and print the scatter, and return the exit code.

    Raises
    ------
    InputError
        If the plan cannot be done, or the case has no tolerance.
    """
    usual = f"scatter-{case_folder(case.name, dump_case(case), changes)}"
    return run_and_write(ScatterCommand(case, plan), output, usual, marked_text(case, plan))


@dataclass(frozen=True)
class ScatterCommand(Command[ScatterStudy]):
    """Runs of a case within its tolerances."""

    case: Case
    plan: ScatterPlan

    def solve(self) -> ScatterStudy:
        """Return the study, with a bar on stderr."""
        with progress_bar("runs", clocks=("elapsed", "left")) as report:
            return dataclasses.replace(scatter(self.case, self.plan, report), asked=asked())

    def summary(self, result: ScatterStudy) -> str:
        """Say how much the blows scatter, and which tolerance matters most."""
        from strikewave.studies.scatter.report import scatter_words

        return scatter_words(result)

    def show(self, result: ScatterStudy) -> None:
        """Print the scatter, and which tolerance it comes from."""
        _print(result)

    def draw(self, result: ScatterStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.reporting.style import save
        from strikewave.studies.scatter.figures import scatter_picture
        from strikewave.studies.scatter.report import scatter_report

        save(scatter_picture(result), folder / "scatter.svg")
        (folder / "report.html").write_text(scatter_report(result), "utf-8", newline="\n")
        return ["report.html", "scatter.svg"]


def _print(study: ScatterStudy) -> None:
    still = study.nominal_run
    rows = []
    for name, units in SHOWN.items():
        figure = study.figure(name)
        mean = [number(value, *units, 5) for value in (figure.mean.mean, figure.mean.low, figure.mean.high)]
        between = [_bare(value) for value in (figure.mean.cv, figure.mean.cv_low, figure.mean.cv_high)]
        typical = number(figure.typical.mean, *units, 5)
        rows.append([headed(NAMES[name], *units), mean[0], _to(*mean[1:]), typical, between[0], _to(*between[1:])])
    columns = [*keys("figure"), *numerals("mean", "95 % bounds"), *numerals("typical", priority=MORE)]
    columns += numerals("CV (%)", "95 % bounds of the CV (%)")
    table("Means of the runs, and CV between runs", columns, rows)
    rows = []
    for name in SHOWN:
        figure = study.figure(name)
        for blows, later, within in (("all", False, figure.within), ("later", True, figure.later)):
            cells = [_bare(x) for x in (still.variation(name, later), *within[:4])]
            rows.append([NAMES[name], blows, *cells[:2], _to(*cells[2:4]), cells[4]])
    columns = [*keys("figure"), *keys("blows"), *numerals("dynamics alone"), *numerals("median")]
    columns += numerals("95 % bounds", "95 % of runs below")
    table("Scatter within a run: CV (%); later: without the first blow", columns, rows)
    broken = sum(study.without_limit)
    counted = f"; {broken} of {len(study.runs)} runs failed or missed a blow and keep no limit" if broken else ""
    tell(f"bounds of the CV between runs: for normal figures; 95 % of runs below: with 95 % confidence{counted}")
    if len(study.runs) < FEWEST_FOR_LIMIT:
        tell(f"95 % of runs below takes {FEWEST_FOR_LIMIT} runs or more")
    kinds = ", ".join(f"{blows} {kind} (in {runs} runs)" for kind, (blows, runs) in study.kinds().items())
    tell(f"blows: {kinds}; largest displacement (rearward) {with_unit(study.largest_displacement, 'm', 'mm', 3)}")
    for one in study.shares:
        _print_shares(study, one)


def _print_shares(study: ScatterStudy, shares: Shares) -> None:
    """Print the shares in one quantity with what each tolerance is."""
    known = {one.path: one for one in study.tolerances}
    sobol = study.plan.shares == "sobol"
    columns = [*keys("tolerance"), *texts("value", "drawn", "provenance", priority=MORE)]
    columns += numerals("share (%)", "95 % bounds")
    columns += [*numerals("total (%)"), *numerals("95 % bounds of the total", priority=MORE)] if sobol else []
    rows = []
    for row in shares.rows:
        one = known[row.path]
        assert one.value.tolerance is not None
        typed = f"{one.value.typed} ± {one.value.tolerance.typed}"
        each = "each striker" if one.strikers else "once a run"
        cells = [row.path, typed, each, one.value.provenance]
        cells += [_bare(row.share) + ("" if row.distinct else " *"), _to(_bare(row.low), _bare(row.high))]
        cells += [_bare(row.total), _to(_bare(row.total_low), _bare(row.total_high))] if sobol else []
        rows.append(cells)
    title = f"Shares in the {shares.of}, {'Sobol indices' if sobol else 'each alone'}, {shares.runs} runs each"
    table(title, columns, rows)
    if not all(row.distinct for row in shares.rows):
        tell("*: not significant (95 %)")
    tell(f"sum of the shares: {_percent(shares.sum)} ({_percent(shares.sum_low)} to {_percent(shares.sum_high)})")


def _to(low: str, high: str) -> str:
    return "-" if "-" in (low, high) else f"{low} to {high}"


def _bare(value: float | None) -> str:
    """Write a share in percent without its sign, for a column that has it in its head."""
    return _percent(value).removesuffix(" %")


def _percent(value: float | None) -> str:
    """Write a share in percent to three digits; a dash where there is none.

    Examples
    --------
    >>> _percent(0.012345), _percent(float("nan")), _percent(float("inf"))
    ('1.23 %', '-', 'none')
    """
    if value is None or value != value:
        return "-"
    if math.isinf(value):
        return "none"
    if 0.0 < abs(value) < 1e-6:
        return "< 1e-4 %"
    return f"{100.0 * value:.3g} %" if abs(value) < 10.0 else f"{100.0 * value:.0f} %"
