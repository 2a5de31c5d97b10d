"""``strikewave hopkinson``: reduce a split-Hopkinson shot, compare an accelerometer on a bar, calibrate a bar."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import Changes, Force, Json, Out

Setup = Annotated[
    str,
    typer.Argument(
        metavar="SETUP", help="The set-up file: bars, gauges, specimen or accelerometer.", show_default=False
    ),
]


def command(setup: Setup, changes: Changes = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """Reduce a split-Hopkinson shot to stress, strain and strain rate; compare an accelerometer; calibrate a bar.

    The set-up names files, gauges and bars; the pulses are found. [specimen] makes it a shot, [accelerometer] a sensor
    on the end of one bar beside the acceleration that the gauge tells, neither of them a bar alone. With --json, files
    are written only where --out says. The exit code is 3 where forces or impulses miss each other by more than
    [limits].
    """
    from strikewave.analyses.hopkinson.screen import run_setup
    from strikewave.analyses.hopkinson.setup_file import load_setup
    from strikewave.reporting.run_and_write import Output

    return run_setup(load_setup(setup, changes or ()), changes or (), Output(out, force, json))
