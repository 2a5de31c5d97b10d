"""``strikewave identify``: stiffness, exponent, restitution, mass and speed from a measured blow."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.options.kinds import Typed, bare_number, quantity
from strikewave.reporting.options.output import Output

MOST_STIFFNESS = 1e300
"""Largest stiffness that is taken, N/m^n: any number whose products still are numbers; the unit depends on n."""


def command(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A measured file of any known format: force, or acceleration of one body.",
            show_default=False,
        ),
    ],
    *,
    mass: Annotated[
        Typed | None, quantity("--mass", si="kg", help='Reduced mass, such as "0.14 kg"; estimated by default.')
    ] = None,
    m1: Annotated[
        Typed | None, quantity("--m1", si="kg", infinite=True, help="Mass of the striker, such as 0.2 (kg), or inf.")
    ] = None,
    m2: Annotated[
        Typed | None,
        quantity(
            "--m2",
            si="kg",
            infinite=True,
            help='Mass of the struck body, such as "459 gram"; needed for an acceleration.',
        ),
    ] = None,
    speed: Annotated[
        float | None,
        quantity("--speed", si="m/s", help="Approach speed, such as 20 (m/s); estimated by default."),
    ] = None,
    stiffness: Annotated[
        float | None,
        bare_number(
            "--stiffness",
            high=MOST_STIFFNESS,
            allowed="a number above zero, in N/m^n",
            help="Stiffness K in N/m^n; estimated by default.",
        ),
    ] = None,
    exponent: Annotated[
        float | None,
        bare_number("-n", "--exponent", low=0.2, high=8.0, help="Exponent n, 0.2 to 8; estimated by default."),
    ] = None,
    restitution: Annotated[
        float | None,
        bare_number(
            "-e",
            "--restitution",
            low=0.001,
            high=1.0,
            help="Coefficient of restitution, 0.001 to 1; estimated by default.",
        ),
    ] = None,
    first: Annotated[
        float | None,
        quantity("--from", si="s", signed=True, help="Begin of the fit in the file's time; the onset by default."),
    ] = None,
    last: Annotated[
        Typed | None,
        quantity("--to", si="s", signed=True, help="End of the fit in the file's time; that of the pulse by default."),
    ] = None,
    measurement: measured.MeasurementOptions,
    output: Output,
) -> int:
    """Identify a contact law from a pulse.

    It is the law F = K d^n (1 + chi d'/v0) of two free bodies, fitted to the largest blow of a record. What is known
    (masses, speed, stiffness, n, e) is given; the rest is found with its standard error, or it is reported why it
    cannot be. The exit code is 3 where the law does not describe the blow. `strikewave fit` does the same of a case:
    with a frame, a sensor, another law, or several records.
    """
    from strikewave.analyses.impact.identified import Given
    from strikewave.analyses.impact.screen import identify_contact

    known = {"speed": speed, "stiffness": stiffness, "exponent": exponent, "restitution": restitution}
    given = Given(
        {name: value for name, value in known.items() if value is not None},
        {"--mass": mass, "--m1": m1, "--m2": m2},
        (first, last),
    )
    return identify_contact(file, given, measurement.calibration(), measurement.reading(), output)
