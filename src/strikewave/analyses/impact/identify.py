"""``strikewave identify``: stiffness, exponent, restitution, mass and speed from a measured blow."""

from __future__ import annotations

import math
from typing import Annotated

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out


def command(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A measured file of any known format: force, or acceleration of one body.",
            show_default=False,
        ),
    ],
    mass: Annotated[
        str | None, typer.Option("--mass", help='Reduced mass, such as "0.14 kg".', show_default=False)
    ] = None,
    m1: Annotated[
        str | None, typer.Option("--m1", help="Mass of the striker, such as 0.2 (kg) or inf.", show_default=False)
    ] = None,
    m2: Annotated[
        str | None,
        typer.Option(
            "--m2", help='Mass of the struck body, such as "459 gram"; needed for an acceleration.', show_default=False
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option("--speed", help="Approach speed, such as 20 (m/s).", show_default=False)
    ] = None,
    stiffness: Annotated[str | None, typer.Option("--stiffness", help="K in N/m^n.", show_default=False)] = None,
    exponent: Annotated[str | None, typer.Option("-n", "--exponent", help="n, 0.2 to 8.", show_default=False)] = None,
    restitution: Annotated[
        str | None, typer.Option("-e", "--restitution", help="e, 0.001 to 1.", show_default=False)
    ] = None,
    first: Annotated[
        str | None, typer.Option("--from", help="Fit from this time on, in the file's time.", show_default=False)
    ] = None,
    last: Annotated[str | None, typer.Option("--to", help="Fit up to this time.", show_default=False)] = None,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    gain: measured.Gain = None,
    excitation: measured.Excitation = None,
    rated_excitation: measured.RatedExcitation = None,
    count: measured.Count = None,
    polarity: measured.Polarity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Find which contact F = K d^n (1 + chi d'/v0) of two free bodies makes the largest blow of a record.

    What is known (masses, speed, stiffness, n, e) is given; the rest is told with its standard error, or it is said
    why it cannot be. Exit code 3 where the law does not describe the blow.
    """
    from strikewave.analyses.impact.identified import Given, identify_contact
    from strikewave.reporting.run_and_write import Output

    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    known = _known({"--speed": speed, "--stiffness": stiffness, "--exponent": exponent, "--restitution": restitution})
    given = Given(known, {"--mass": mass, "--m1": m1, "--m2": m2}, (first, last))
    return identify_contact(file, given, stated, measured.options_of(rate, time, channel), Output(out, force, json))


def _known(typed: dict[str, str | None]) -> dict[str, float]:
    """Return what is known, but for the masses."""
    from strikewave.base.errors import InputError
    from strikewave.contact.pulse_fit import EXPONENTS, RESTITUTIONS

    known = {}
    limits = {"--stiffness": (0.0, 1e300), "--exponent": EXPONENTS, "--restitution": RESTITUTIONS}
    for option, text in typed.items():
        if text is None:
            continue
        if option == "--speed":
            known["speed"] = measured.positive(text, "m/s", option)
            continue
        low, high = limits[option]
        value = float(text) if measured.is_bare(text) else math.nan
        if not (low <= value <= high and value > 0.0):
            allowed = (
                "a number above zero, in N/m^n" if option == "--stiffness" else f"a number from {low:g} to {high:g}"
            )
            raise InputError(option, text, allowed)
        known[option[2:]] = value
    return known
