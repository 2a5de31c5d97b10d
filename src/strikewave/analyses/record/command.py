"""``strikewave record``: what measured records say, file by file and together."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from strikewave.base.errors import InputError
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Output, Typed, bare_number, quantity

if TYPE_CHECKING:
    from strikewave.signal.filters import Filter


def command(
    files: measured.Files,
    *,
    measurement: measured.MeasurementOptions,
    drop_height: Annotated[
        float | None,
        quantity("--drop-height", si="m", help='Free fall before the blow, such as "1.2 m"; not checked by default.'),
    ] = None,
    cutoff: Annotated[
        float | None,
        quantity("--filter", si="Hz", help="Zero-phase low-pass, -3 dB for both passes; none by default."),
    ] = None,
    cfc: Annotated[
        Typed | None,
        bare_number(
            "--cfc",
            high=1e6,
            allowed="a channel frequency class, such as 60, 180, 600 or 1000",
            help="SAE J211 filter of this channel frequency class, such as 1000; none by default.",
        ),
    ] = None,
    columns: Annotated[
        Literal["channels", "repeats"],
        typer.Option("--columns", help="What the columns of a file are: channels, or repeats of one test."),
    ] = "channels",
    fail_on: Annotated[
        Literal["bad", "suspect"] | None,
        typer.Option(
            "--fail-on", help="Status of a file, or a worse one, that makes the exit code 3; none by default."
        ),
    ] = None,
    output: Output,
) -> int:
    """Measure the pulses of recorded files.

    Gives status, health and pulses of each file, and the statistics of all together. With --json, no files are
    written unless --out is given. Files that come as a shell lists them are taken in the natural order of their
    names, a2 before a10. The exit code is 3 where a file could not be read, or has a status of --fail-on.
    """
    from strikewave.analyses.record.screen import examine_records
    from strikewave.records import Request

    height = math.nan if drop_height is None else drop_height
    wanted = Request(tuple(measurement.channel or ()), measurement.calibration(), height, _filter(cutoff, cfc))
    return examine_records(files, wanted, measurement.reading(), output, columns == "repeats", fail_on or "")


def _filter(cutoff: float | None, cfc: Typed | None) -> Filter | None:
    from strikewave.signal.filters import Filter

    if cutoff is not None and cfc is not None:
        raise InputError("--cfc", cfc.word, "either --filter or --cfc", "leave one out")
    if cutoff is not None:
        return Filter(cutoff)
    return None if cfc is None else Filter.sae_j211(cfc)
