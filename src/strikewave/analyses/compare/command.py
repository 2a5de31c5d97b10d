"""``strikewave compare``: one history held against another."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.analyses.compare.limits import ComparisonLimit, Scoring, read_limit
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import LowPassOptions, complete_case, parsed
from strikewave.reporting.output_options import StudyOutput


def command(
    a: Annotated[
        str,
        typer.Argument(
            metavar="A",
            help="The reference: FILE#CHANNEL, a pattern or a folder of records, CASE:PART, or the folder of a result.",
            show_default=False,
            autocompletion=complete_case,
        ),
    ],
    b: Annotated[
        str,
        typer.Argument(metavar="B", help="What is held against it.", show_default=False, autocompletion=complete_case),
    ],
    *,
    align: Annotated[
        Literal["correlation", "onset", "peak", "none"],
        typer.Option("--align", help="What B is shifted by: cross-correlation, crossings of 10 % of the peak, peaks."),
    ] = "correlation",
    limits: Annotated[
        list[ComparisonLimit] | None,
        parsed(
            "--limit",
            read=read_limit,
            metavar="METRIC",
            help='Limit to keep, such as "iso18571 > 0.8" or "peak < 5 %"; else the exit code is 3; may be repeated.',
        ),
    ] = None,
    scoring: Scoring,
    judging: measured.DecisionOptions,
    measurement: measured.MeasurementOptions,
    filtering: LowPassOptions,
    output: StudyOutput,
) -> int:
    """Compare two histories, measured or simulated.

    B is aligned with A and both are judged: peak, width, velocity change, shock response spectra, RMS, ISO/TS 18571.
    Several records, or all blows of one (FILE@all), are a corridor; @N takes blow N. With spec:NAME as B, A is judged
    by a specification. With --json, no files are written unless --out is given. The exit code is 3 where a --limit or
    a specification is not kept.
    """
    from strikewave.analyses.compare.run import CompareRequest
    from strikewave.analyses.compare.screen import compare_sources

    request = CompareRequest.of(align, limits or (), scoring, judging, measurement, filtering.low_pass())
    return compare_sources(a, b, request, output)
