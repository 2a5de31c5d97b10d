"""The report of a fit."""

from __future__ import annotations

from strikewave.reporting import chapters
from strikewave.reporting.numbers import percent
from strikewave.reporting.parts import Cell, Link, Part, Picture, Section, Table
from strikewave.reporting.table_columns import page_table
from strikewave.studies.fit.checking import Checks
from strikewave.studies.fit.columns import (
    CHECK_COLUMNS,
    CORRELATION_TITLE,
    PARAMETER_COLUMNS,
    POSTERIOR_COLUMNS,
    POSTERIOR_TITLE,
    RESIDUAL_COLUMNS,
    TRIED_COLUMNS,
    check_words,
    correlation_columns,
    correlation_rows,
    fit_words,
    posterior_words,
    residual_rows,
)
from strikewave.studies.fit.corner import corner_figure
from strikewave.studies.fit.figures import MOST_DRAWN, overlay, profile_figures, values_figure
from strikewave.studies.fit.posterior import Posterior
from strikewave.studies.fit.result import FitStudy


def fit_report(study: FitStudy) -> str:
    """Return the report of a fit as one HTML page: no script, nothing fetched, the same bytes each time."""
    sections = [
        _values(study),
        *([_posterior(study, study.posterior)] if study.posterior is not None else []),
        *([_records(study)] if study.pulses else []),
        Section(
            "Residuals",
            _residual_text(study),
            [page_table("Measured and computed", RESIDUAL_COLUMNS, residual_rows(study))],
        ),
        *([_tries(study)] if study.tries else []),
        *([_checks(study.checks)] if study.checks is not None else []),
        chapters.warnings(study.notices),
        _files(study),
        chapters.inputs(study.case),
    ]
    summary = chapters.Summary("Report of a fit", fit_words(study), study.highlights())
    return chapters.result_page(study, summary, sections)


def _values(study: FitStudy) -> Section:
    parts: list[Part] = [page_table("Fitted values", PARAMETER_COLUMNS, study.parameters)]
    caption = "Each value between its bounds; the bar is its 95 % interval, red where the data do not determine it."
    parts.append(Picture(values_figure(study), caption))
    if len(study.parameters) > 1:
        parts.append(page_table(CORRELATION_TITLE, correlation_columns(study), correlation_rows(study)))
    parts += [Picture(figure, words) for figure, words in profile_figures(study)]
    parts.append(Link("fitted.toml", "The fitted case, fitted.toml"))
    text = (
        "Standard errors hold the noise of the records with its colour, what is left where that is more, and what "
        f"differs from shot to shot: {_shots(study)}. They hold no error of fields that were not free."
    )
    return Section("Fitted values", text, parts)


def _posterior(study: FitStudy, posterior: Posterior) -> Section:
    caption = (
        "Posterior of each value (median, 95 %) and of each pair (contours of 68 and 95 % of the draws); red: the "
        "least-squares values."
    )
    text = (
        "Bounds are flat priors on the scale on which each value is searched: the logarithm of stiffnesses, masses and "
        "other scales. The likelihood has the covariance of the fit, so that colour of the noise, what is left beyond "
        f"it, and scatter from shot to shot are in it. {posterior_words(posterior)}"
    )
    table = page_table(POSTERIOR_TITLE, POSTERIOR_COLUMNS, study.posterior_values())
    return Section("Posterior", text, [table, Picture(corner_figure(study), caption)])


def _shots(study: FitStudy) -> str:
    """Say what is known of the scatter of shots."""
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


def _tries(study: FitStudy) -> Section:
    text = (
        "Root mean square residuals over noise or uncertainty. Kept out: each record, or tenth of them, predicted by "
        "a fit to the others (cross-validation), by which choices are ranked."
    )
    return Section("Choices", text, [page_table("Choices, the best first", TRIED_COLUMNS, study.tries)])


def _checks(checks: Checks) -> Section:
    rows: list[list[Cell]] = [
        [name, f"{found.rating.overall:.3f}", found.rating.grade, percent(found.rms)]
        for name, found in checks.agreements
    ]
    parts: list[Part] = [page_table("Predictions", CHECK_COLUMNS, checks.figures)]
    if rows:
        parts.append(Table("Whole pulses, by ISO/TS 18571", ["record", "overall", "grade", "RMS difference"], rows))
    text = (
        f"{check_words(checks)} A band holds values drawn from the fit, what the same figure was off in the records of "
        "the fit, and the noise of the record."
    )
    return Section("Predictions of what was kept out", text, parts)


def _residual_text(study: FitStudy) -> str:
    return (
        f"Sum of squares {study.solved.estimate.misfit:.4g} over {study.solved.estimate.residuals.size} residuals; "
        f"{study.solved.runs} runs. A residual is called more than noise where noise alone leaves so much once in a "
        "thousand times."
    )


def _files(study: FitStudy) -> Section:
    rows: list[list[Cell]] = [[name, digest] for fit in study.case.fit for name, digest in fit.records.items()]
    empty = "No record: the case was fitted to stated numbers."
    return Section("Files", "", [Table("Records that the case was fitted to", ["file", "SHA-256"], rows, empty)])
