"""``strikewave impact``: blows of two free bodies, in closed form where the law allows it."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.analyses.impact import options
from strikewave.reporting.options.output import Output


def command(
    *,
    bodies: options.BodyOptions,
    loss: options.LossOptions,
    stiffness: options.StiffnessOptions,
    yielding: options.YieldOptions,
    repeat: Annotated[
        int,
        typer.Option(
            "--repeat",
            metavar="COUNT",
            min=1,
            max=options.MOST_BLOWS,
            help="Blows at the same speed on the same spot.",
        ),
    ] = 1,
    output: Output,
) -> int:
    """Solve the impact of two free bodies.

    The force is F = K d^n (1 + chi d'/v0), or that of a damper, or of a spot that yields.
    """
    from strikewave.analyses.impact.screen import solve_setup
    from strikewave.analyses.impact.setup import Setup, read_base, read_cap, read_loss, read_masses
    from strikewave.base.quantities import AUTO

    masses = read_masses(bodies)
    base = read_base(stiffness)
    lost = read_loss(loss, base.stiffness, masses)
    cap = read_cap(yielding, base, loss.damper)
    return solve_setup(Setup(masses, bodies.speed, base, lost, cap, repeat, yielding.yield_pressure == AUTO), output)
