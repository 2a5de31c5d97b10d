"""``strikewave hopkinson``: reduce a split-Hopkinson shot, compare an accelerometer on a bar, calibrate a bar."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options import Changes
from strikewave.reporting.output_options import Output

Setup = Annotated[
    str,
    typer.Argument(
        metavar="SETUP", help="The set-up file: bars, gauges, specimen or accelerometer.", show_default=False
    ),
]


def command(setup: Setup, *, changes: Changes = None, output: Output) -> int:
    """Reduce split-Hopkinson-bar records.

    The set-up names files, gauges and bars; the pulses are found. With [specimen] it is a shot, reduced to stress,
    strain and strain rate; with [accelerometer], a sensor on the end of one bar, compared with the acceleration that
    the gauge gives; with neither, a bar alone, calibrated by its echoes. With --json, no files are written unless
    --out is given. The exit code is 3 where forces or impulses miss each other by more than [limits].
    """
    from strikewave.analyses.hopkinson.build import load_setup
    from strikewave.analyses.hopkinson.screen import run_setup

    return run_setup(load_setup(setup, changes or ()), changes or (), output)
