"""``strikewave fit``: values of a case from measurements, with what these tell and what they leave open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from strikewave.base.errors import InputError
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Changes, LowPassOptions, Running, case_name
from strikewave.reporting.output_options import StudyOutput

STATES_ALL = "the file of a whole fit states them: beside it there are only --set, of its case, and --bayes"


@dataclass(frozen=True)
class CheckOptions:
    """Options by which a fit is judged: choices that are compared, measurements kept out, and the posterior."""

    tries: Annotated[
        str,
        typer.Option(
            "--try",
            metavar="PATH=CHOICE,...",
            help="Choices that are fitted each, such as law=palmgren,johnson; the best at predicting is kept.",
            show_default=False,
        ),
    ] = ""
    check_on: Annotated[
        list[str] | None,
        typer.Option(
            "--check-on",
            metavar="RECORD|NUMBER=VALUE",
            help="Record or number, as of --to, that is kept out and predicted; may be repeated; none by default.",
            show_default=False,
        ),
    ] = None
    bayes: Annotated[
        bool,
        typer.Option(
            "--bayes",
            help="Also sample the posterior, bounds being flat priors; needs pip install 'strikewave[bayes]'.",
        ),
    ] = False


def command(
    case: Annotated[str, case_name("CASE", "A case file, the name of a built-in case, or the file of a whole fit.")],
    *,
    to: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            metavar="RECORD|NUMBER=VALUE",
            help=(
                "Record, [PART=]FILE#CHANNEL, or number, such as first.rigid_peak='4151 g +- 1 %'; settings follow "
                "after semicolons; may be repeated; the published numbers that the case was fitted to by default."
            ),
            show_default=False,
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            "--free",
            metavar="PATH[=LOW..HIGH]",
            help="Field to fit, with bounds or without; may be repeated; those marked as fitted by default.",
            show_default=False,
        ),
    ] = None,
    checks: CheckOptions,
    changes: Changes = None,
    measurement: measured.MeasurementOptions,
    filtering: LowPassOptions,
    running: Running,
    output: StudyOutput,
) -> int:
    """Fit values of a case to measurements.

    Least squares over whole pulses, aligned and in the band that run and record share, and over stated numbers. Gives
    each value with its standard error, which fields the data do not determine, and whether the residual is more than
    noise. The fitted case, fitted.toml, runs with bands that know the fit. Ctrl-C keeps the best so far. With --json,
    no files are written unless --out is given.
    """
    from strikewave.analyses.compare.sources import SourceOptions
    from strikewave.cases.case import load_case
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.fit.fit_file import is_fit_file
    from strikewave.studies.fit.report import run_fit, run_fit_file
    from strikewave.studies.fit.targets import FitRequest

    reading = SourceOptions(measurement.calibration(), measurement.reading(), filtering.low_pass(), band=False)
    bayes = checks.bayes
    asked = FitRequest(tuple(to or ()), tuple(free or ()), checks.tries, tuple(checks.check_on or ()), reading, bayes)
    by_threads = running.workers is None and running.cluster is None
    pool = None if by_threads else Workers(running.workers, cluster=running.cluster).pool()
    if is_fit_file(case):
        if asked != FitRequest(reading=SourceOptions(band=False), bayes=bayes):
            raise InputError("CASE", case, "a case, where records, fields or their reading are typed", STATES_ALL)
        return run_fit_file(case, changes or (), output, pool, running, bayes)
    return run_fit(output.tested(load_case(case, changes or ())), changes or (), asked, output, pool, running)
