"""``strikewave record``: what measured records say, file by file and together."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.analyses.record.options import Examination
from strikewave.reporting import measured_files as measured
from strikewave.reporting.output_options import Output


def command(
    files: measured.Files,
    *,
    measurement: measured.MeasurementOptions,
    examination: Examination,
    fail_on: Annotated[
        Literal["bad", "suspect"] | None,
        typer.Option(
            "--fail-on", help="Status of a file, or a worse one, that makes the exit code 3; none by default."
        ),
    ] = None,
    spec: measured.Spec = None,
    judging: measured.RecordJudging,
    filtering: measured.Filtering,
    output: Output,
) -> int:
    """Measure the pulses of recorded files.

    Gives status, health and pulses of each file, and the statistics of all together. With --json, no files are
    written unless --out is given. Files that come as a shell lists them are taken in the natural order of their
    names, a2 before a10. --spec judges each blow by a specification; --sensor says whether a sensor could take it, and
    what is left of it. The exit code is 3 where a file could not be read, has a status of --fail-on, or where the
    verdict by a specification is FAIL.
    """
    from strikewave.analyses.record.examine import RecordsAsked
    from strikewave.analyses.record.screen import examine_records

    performed = None if output.test is None else output.performed
    judged = (judging, judging.specification(spec))
    asked = RecordsAsked(files, measurement, examination, filtering, *judged, performed, fail_on or "")
    return examine_records(asked, output)
