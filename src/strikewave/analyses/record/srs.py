"""``strikewave srs``: the shock response spectrum of a measured record."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.analyses.record.options import FilterOptions, SpecificationOptions
from strikewave.analyses.record.rolling_window import ALLOWED_Q, Rolling, read_rolling
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Typed, bare_number, one_of, parsed, quantity
from strikewave.reporting.output_options import Output

KINDS = ("absolute", "displacement", "relative-velocity", "pseudo-velocity", "equivalent-static")
"""Kinds of spectra."""


def command(
    files: measured.Files,
    *,
    q: Annotated[
        float,
        bare_number("--q", allowed=ALLOWED_Q, help="Quality factor 1 / (2 damping ratio), or inf; 10 by default."),
    ] = 10.0,
    low: Annotated[float, quantity("--from", si="Hz", help="Lowest natural frequency; 10 Hz by default.")] = 10.0,
    high: Annotated[
        Typed | None,
        quantity(
            "--to", si="Hz", help="Highest natural frequency; 100 kHz, or 2/5 of the least sampling rate, by default."
        ),
    ] = None,
    per_octave: Annotated[
        float,
        bare_number(
            "--per-octave",
            high=1e5,
            allowed="a number of frequencies above zero, at most 100 000",
            help="Number of natural frequencies in an octave; 12 by default.",
        ),
    ] = 12.0,
    frequency: Annotated[
        list[Typed] | None,
        quantity("--frequency", si="Hz", help="Natural frequency, instead of a range; may be repeated."),
    ] = None,
    kind: Annotated[
        list[str] | None,
        one_of("--kind", choices=KINDS, help="Kind of spectrum; absolute by default; may be repeated."),
    ] = None,
    side: Annotated[
        Literal["maximax", "positive", "negative"], typer.Option("--side", help="Side of the response.")
    ] = "maximax",
    part: Annotated[
        Literal["total", "primary", "residual"],
        typer.Option("--part", help="Part of the response: primary is while the shock lasts, residual after it."),
    ] = "total",
    end: Annotated[
        Typed | None,
        quantity(
            "--end", si="s", signed=True, help="End of the shock in the file's time; its last blow's end by default."
        ),
    ] = None,
    resultant: Annotated[
        bool, typer.Option("--resultant", help="Vector sum of 2 or 3 perpendicular channels of a file.")
    ] = False,
    rolling: Annotated[
        Rolling | None,
        parsed(
            "--rolling",
            read=read_rolling,
            metavar="WINDOW[,HOP]",
            help='Spectra of windows that slide over the record, such as "20 ms" or "20 ms,5 ms"; '
            "a quarter of a window on by default.",
        ),
    ] = None,
    initial: Annotated[
        Literal["rest", "shifted", "steady"],
        typer.Option(
            "--initial",
            help="How the record begins: from rest, its first sample taken off all, or at its first sample for ever.",
        ),
    ] = "rest",
    rms: Annotated[
        bool, typer.Option("--rms", help="Root mean square of the responses too, while the record lasts.")
    ] = False,
    response: Annotated[
        Typed | None,
        quantity("--response", si="Hz", help="Natural frequency of an oscillator whose response is written too."),
    ] = None,
    measurement: measured.MeasurementOptions,
    judging: SpecificationOptions,
    filtering: FilterOptions,
    output: Output,
) -> int:
    """Compute shock response spectra.

    They are those of a record, its baseline taken off. Of several files, or channels, their envelope is given, and from
    three on the limit P95/50. --spec judges each by a specification, which then states frequencies, Q and side. With
    --json, no files are written unless --out is given. The exit code is 3 where the verdict is FAIL.
    """
    from strikewave.analyses.record.file_spectra import FilesAsked
    from strikewave.analyses.record.spectrum import SpectrumOptions, SpectrumRequest
    from strikewave.analyses.record.spectrum_screen import compute_spectra
    from strikewave.records import Request

    kinds = tuple(dict.fromkeys(kind or ["absolute"]))
    options = SpectrumOptions(initial, rms, resultant, response, rolling, judging.uncertainty)
    wanted = SpectrumRequest(q, frequency, (low, high, per_octave), kinds, side, part, end, options)
    asked = FilesAsked(files, measurement.calibration(), measurement.reading(), filtering.on(Request()))
    return compute_spectra(asked, wanted, output, judging.spectra_judge())
