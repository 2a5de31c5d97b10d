"""A fit as a command, in words and tables, and its report."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from strikewave.analyses.compare.sources import parse_name, paths_of
from strikewave.base.result import Source
from strikewave.base.texts import percent
from strikewave.cases.case import Case, dump_case
from strikewave.reporting import chapters
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import columns_of
from strikewave.reporting.numbers import listed
from strikewave.reporting.options import Running
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Cell, Link, Part, Picture, Section, Table, written
from strikewave.reporting.run_and_write import case_folder, drawing, run_and_write
from strikewave.reporting.style import save, titled
from strikewave.reporting.terminal import print_rows, progress_bar, report_table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.fit.checking import Checks, PredictedFigure, PulseAgreement, TriedChoice
from strikewave.studies.fit.figures import (
    MOST_DRAWN,
    corner_figure,
    fit_figure,
    overlay,
    profile_figures,
    values_figure,
)
from strikewave.studies.fit.fit_file import load_fit
from strikewave.studies.fit.posterior import SEED, WALKERS, Posterior
from strikewave.studies.fit.result import MET, FitStudy, FittedParameter, MisfitOfRun, PosteriorValue, combination_words
from strikewave.studies.fit.study import requested
from strikewave.studies.fit.targets import FitRequest, parse_targets

POSTERIOR_TITLE = "Posterior beside least squares"


def fit_words(study: FitStudy) -> str:
    """Return the sentences on the outcome of a fit."""
    found = study.solved.estimate
    values = [f"{parameter.name} = {parameter.words}" for parameter in study.parameters if parameter.determined]
    words = [f"{', '.join(values)} (standard errors)."] if values else []
    combinations = [combination_words(study, group) for group in found.groups()]
    words += [f"{text[0].upper()}{text[1:]}." for text in combinations]
    broken = [misfit for misfit in study.solved.misfits if misfit.more_than_noise]
    worst = max(study.solved.misfits, key=lambda one: one.share)
    missed = [one for one in study.solved.misfits if one.is_number and one.size > MET]
    if missed:
        words.append(
            f"{len(missed)} of {len(study.numbers)} numbers are missed by more than {MET:g} times their uncertainty, "
            f"by up to {percent(max(one.share for one in missed), 1)}."
        )
    if broken:
        words.append(
            f"What is left is more than noise in {len(broken)} of {len(study.pulses)} records: up to "
            f"{percent(max(one.share for one in broken), 1)} of the peak (RMS)."
        )
    if not broken and not missed:
        words.append(f"What is left is within noise or uncertainty: at most {percent(worst.share, 2)} (RMS).")
    if study.tries:
        best = study.tries[0]
        by = "fits best" if math.isnan(best.kept_out) else "predicts records that it was not fitted to best"
        words.insert(0, f"Of {len(study.tries)} choices, {best.choice} {by}.")
    if study.checks is not None:
        words.append(check_words(study.checks))
    if study.verdicts.words:
        words.insert(0, study.verdicts.sentence)
    return " ".join(words)


def posterior_words(posterior: Posterior) -> str:
    """Return the sentence on the chains of the posterior."""
    return (
        f"{WALKERS} chains of {posterior.steps} steps, {posterior.steps / posterior.memory:.0f} autocorrelation times "
        f"of {posterior.memory:.3g} steps: about {posterior.independent:.0f} independent draws; "
        f"{percent(posterior.accepted, 0)} of moves accepted; seed {SEED}."
    )


def correlation_table(study: FitStudy) -> Table:
    """Return the correlation of the values, a row and a column each."""
    names = [parameter.name for parameter in study.parameters]
    rows = [
        [name, *(written(one, 3) for one in row)] for name, row in zip(names, study.correlation.tolist(), strict=True)
    ]
    return Table("Correlation of the values", ["", *names], rows)


def check_words(checks: Checks) -> str:
    """Return the sentences on predictions of measurements that were kept out."""
    count = len(checks.figures)
    biases = listed([f"{name} {percent(bias, 1, '+')}" for name, bias in checks.biases.items()])
    words = f"Of what was kept out, {checks.inside} of {count} bands hold what was measured; mean bias: {biases}."
    scores = [one.rating.overall for _, one in checks.agreements]
    return f"{words} Predictions agree to {np.mean(scores):.2f} of 1 by ISO/TS 18571." if scores else words


def residual_rows(study: FitStudy) -> list[MisfitOfRun]:
    """Return a row for each record and number, the largest residuals over noise or uncertainty first."""
    rows = map(MisfitOfRun, study.solved.misfits, study.verdicts_of_measured())
    return sorted(rows, key=lambda row: -row.misfit.size)


def page(study: FitStudy) -> str:
    """Return the report of a fit as one HTML page: no script, nothing fetched, the same bytes each time."""
    found = study.solved.estimate
    sections = [_values(study)]
    if study.posterior is not None:
        caption = (
            "Posterior of each value (median, 95 %) and of each pair (contours of 68 and 95 % of the draws); red: the "
            "least-squares values."
        )
        text = (
            "Bounds are flat priors on the scale on which each value is searched: the logarithm of stiffnesses, masses "
            "and other scales. The likelihood has the covariance of the fit, so that colour of the noise, what is left "
            f"beyond it, and scatter from shot to shot are in it. {posterior_words(study.posterior)}"
        )
        rows = page_table(POSTERIOR_TITLE, columns_of(PosteriorValue, study.posterior_values()))
        sections.append(Section("Posterior", text, [rows, Picture(corner_figure(study), caption)]))
    if study.pulses:
        sections.append(_records(study))
    text = (
        f"Sum of squares {found.misfit:.4g} over {found.residuals.size} residuals; {study.solved.runs} runs. A "
        "residual is called more than noise where noise alone leaves so much once in a thousand times."
    )
    rows = page_table("Measured and computed", columns_of(MisfitOfRun, residual_rows(study)))
    sections.append(Section("Residuals", text, [rows]))
    if study.tries:
        text = (
            "Root mean square residuals over noise or uncertainty. Kept out: each record, or tenth of them, predicted "
            "by a fit to the others (cross-validation), by which choices are ranked."
        )
        rows = page_table("Choices, the best first", columns_of(TriedChoice, study.tries))
        sections.append(Section("Choices", text, [rows]))
    if study.checks is not None:
        parts: list[Part] = [page_table("Predictions", columns_of(PredictedFigure, study.checks.figures))]
        if study.checks.pulses:
            pulses = columns_of(PulseAgreement, study.checks.pulses)
            parts.append(page_table("Whole pulses, by ISO/TS 18571", pulses))
        text = (
            f"{check_words(study.checks)} A band holds values drawn from the fit, what the same figure was off in the "
            "records of the fit, and the noise of the record."
        )
        sections.append(Section("Predictions of what was kept out", text, parts))
    files: list[list[Cell]] = [[name, digest] for fit in study.case.fit for name, digest in fit.records.items()]
    empty = "No record: the case was fitted to stated numbers."
    table = Table("Records that the case was fitted to", ["file", "SHA-256"], files, empty)
    sections += [chapters.warnings(study.notices), Section("Files", "", [table]), chapters.inputs(study.case)]
    summary = chapters.Summary("Report of a fit", fit_words(study), study.highlights())
    return chapters.result_page(study, summary, sections)


def _values(study: FitStudy) -> Section:
    parts: list[Part] = [page_table("Fitted values", columns_of(FittedParameter, study.parameters))]
    caption = "Each value between its bounds; the bar is its 95 % interval, red where the data do not determine it."
    parts.append(Picture(values_figure(study), caption))
    if len(study.parameters) > 1:
        parts.append(correlation_table(study))
    parts += [Picture(figure, words) for figure, words in profile_figures(study)]
    parts.append(Link("fitted.toml", "The fitted case, fitted.toml"))
    text = (
        "Standard errors hold the noise of the records with its colour, what is left where that is more, and what "
        f"differs from shot to shot: {_shots(study)}. They hold no error of fields that were not free."
    )
    return Section("Fitted values", text, parts)


def _shots(study: FitStudy) -> str:
    """Return the words on the scatter of shots."""
    count = study.solved.problem.shot_count
    if count > 1:
        return f"the scatter of {count} shots shows it, and intervals are as wide as Student's t has them"
    stated = any(pulse.scatter for pulse, _ in study.pulses)
    return "as stated" if stated else "nothing, for one shot does not show it, and none is stated"


def _records(study: FitStudy) -> Section:
    shown = f" The first {MOST_DRAWN} of {len(study.pulses)} are drawn." if len(study.pulses) > MOST_DRAWN else ""
    band = " The band has 95 % of what the posterior and the noise predict." if study.bands else ""
    words = f"Records and fitted runs, laid on one another by least squares; below, what is left.{band}{shown}"
    return Section("Records", "", [Picture(overlay(study), words)])


picture = fit_figure
MOST_ROWS = 20  # residuals that the screen lists: more fill it
SAMPLED = 5000  # runs that a posterior takes, roughly: for the bar alone
EXPECTED = 60  # runs that a fit takes for each free field, roughly: for the bar alone


def run_fit_file(
    path: str, changes: Sequence[str], output: Output, pool: Pool | None, running: Running, bayes: bool = False
) -> int:
    """Do the fit of a file, with its posterior if asked; write and print it, and return the exit code."""
    read = load_fit(path, changes)
    usual = f"fit-{case_folder(read.path.stem, read.path.read_text('utf-8-sig'), changes)}"
    request = dataclasses.replace(read.request, bayes=read.request.bayes or bayes)
    return _run(output.tested(read.case), request, output, usual, pool, running, [read.path])


def run_fit(
    case: Case, changes: Sequence[str], request: FitRequest, output: Output, pool: Pool | None, running: Running
) -> int:
    """Fit a case, write and print the result, and return the exit code."""
    return _run(case, request, output, f"fit-{case_folder(case.name, dump_case(case), changes)}", pool, running)


def _run(
    case: Case,
    request: FitRequest,
    output: Output,
    usual: str,
    pool: Pool | None,
    running: Running,
    files: Sequence[Path] = (),
) -> int:
    targets = parse_targets([*request.to, *request.check_on], case)
    paths = [
        *files,
        *(path for target in targets if not target.is_number for path in paths_of(parse_name(target.right))),
    ]
    origin = measured.source_of(
        "fit", case.name, list(dict.fromkeys(paths)) if output.writes(usual) else [], output.stated_test()
    )
    command = FitCommand(case, request, origin, pool, place=running.store, fresh=running.fresh)
    return run_and_write(command, output, usual, origin.text)


@dataclass
class FitCommand(ResumableCommand[FitStudy]):
    """A fit of a case to measurements; asked again, it reads what its runs came to."""

    indent: ClassVar[int | None] = 2

    case: Case
    request: FitRequest
    origin: Source
    pool: Pool | None

    def solved(self, store: RunStore) -> FitStudy:
        """Return the fit, with a bar on stderr; where it is stopped before it has begun, end with `stopped`."""
        with progress_bar("fitting") as report:

            def advance(runs: int, misfit: float) -> None:
                whole = EXPECTED * max(len(self.request.free), 2) + SAMPLED * self.request.bayes
                report(min(runs / whole, 0.99), f"{runs} runs, sum of squares {misfit:.4g}")

            try:
                study = requested(self.case, self.request, advance, self.pool, store)
            except KeyboardInterrupt as stop:
                self.stopped_after(stop, store)
        return dataclasses.replace(study, origin=self.origin)

    def summary(self, result: FitStudy) -> str:
        """Say what came out."""
        return fit_words(result)

    def show(self, result: FitStudy) -> None:
        """Print values, correlation and residuals."""
        print_rows("Fitted values", columns_of(FittedParameter, result.parameters))
        if len(result.parameters) > 1:
            report_table(correlation_table(result))
        if result.posterior is not None:
            print_rows(POSTERIOR_TITLE, columns_of(PosteriorValue, result.posterior_values()))
            tell(posterior_words(result.posterior))
        rows = residual_rows(result)
        if len(rows) > MOST_ROWS:
            tell(f"of {len(rows)} residuals the {MOST_ROWS} largest; the report and fit.json have all")
        print_rows("Residuals", columns_of(MisfitOfRun, rows[:MOST_ROWS]))
        if result.tries:
            print_rows("Choices, the best first", columns_of(TriedChoice, result.tries))
        if result.checks is not None:
            print_rows("Predictions of what was kept out", columns_of(PredictedFigure, result.checks.figures))

    def draw(self, result: FitStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        with drawing(folder / "fit.svg") as path:
            save(fit_figure(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(page(result), "utf-8", newline="\n")
        if result.posterior is None:
            return ["report.html", "fit.svg"]
        with drawing(folder / "posterior.svg") as path:
            save(titled(corner_figure(result), f"Posterior: {result.title}"), path)
        return ["report.html", "fit.svg", "posterior.svg"]
