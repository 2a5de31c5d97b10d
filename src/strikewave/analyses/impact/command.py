"""``strikewave impact``, ``identify`` and ``laws``."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.analyses.impact import options
from strikewave.base.quantities import AUTO
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Typed, bare_number, quantity
from strikewave.reporting.output_options import Output


def impact(
    *,
    bodies: options.BodyOptions,
    loss: options.LossOptions,
    stiffness: options.StiffnessOptions,
    yielding: options.YieldOptions,
    repeat: Annotated[
        int,
        typer.Option(
            "--repeat", metavar="COUNT", min=1, max=options.MOST_BLOWS, help="Blows at the same speed on the same spot."
        ),
    ] = 1,
    output: Output,
) -> int:
    """Solve the impact of two free bodies.

    The force is F = K d^n (1 + chi d'/v0), or that of a damper, or of a spot that yields.
    """
    from strikewave.analyses.impact.screen import solve_setup
    from strikewave.analyses.impact.setup import Setup, read_base, read_cap, read_loss, read_masses

    masses = read_masses(bodies)
    base = read_base(stiffness)
    lost = read_loss(loss, base.stiffness, masses)
    cap = read_cap(yielding, base, loss.damper)
    return solve_setup(Setup(masses, bodies.speed, base, lost, cap, repeat, yielding.yield_pressure == AUTO), output)


def identify(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A measured file of any known format: force, or acceleration of one body.",
            show_default=False,
        ),
    ],
    *,
    masses: options.MassOptions,
    speed: Annotated[
        float | None, quantity("--speed", si="m/s", help="Approach speed, such as 20 (m/s); estimated by default.")
    ] = None,
    stiffness: Annotated[
        float | None,
        bare_number(
            "--stiffness",
            high=options.MOST_STIFFNESS,
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
    from strikewave.analyses.impact.identify_screen import Given, identify_contact

    known = {"speed": speed, "stiffness": stiffness, "exponent": exponent, "restitution": restitution}
    given = Given(
        {name: value for name, value in known.items() if value is not None},
        {"--mass": masses.mass, "--m1": masses.m1, "--m2": masses.m2},
        (first, last),
    )
    return identify_contact(file, given, measurement.calibration(), measurement.reading(), output)


LawName = Annotated[
    str | None, typer.Argument(metavar="NAME", help="Name of a law of any kind; all by default.", show_default=False)
]


def laws(name: LawName = None, *, output: Output) -> int:
    """List the contact laws.

    Damping, dampers, stiffness and pressure caps, with equation, range, status, source, and the coefficient of
    restitution that they give.
    """
    from strikewave.analyses.impact.law_list import list_laws

    return list_laws(name, output)
