"""Picture of the cushion laws: force over compression of equal pads, and the pulses that they make."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from strikewave.analyses.impact.figures.contact import MANY_COLOURS
from strikewave.contact import impact_history, slow_force, solve_impact
from strikewave.contact.cushions import Cushion, Pad
from strikewave.contact.law import AnyContact, HardeningContact
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.style import WHOLE, legend_below, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN_PAD, SHOWN_MASS, SHOWN_SPEED = Pad(area=2e-3, thickness=20e-3), 2.0, 2.0
"""The pad of the picture, the mass (kg) and the speed (m/s) that it stops: 4 J."""
SHOWN = {
    "linear": {"modulus": 0.8e6},
    "power": {"stress": 1.8e6, "exponent": 2.5},
    "tangent": {"modulus": 0.5e6, "limit_strain": 0.8},
    "elastomer": {"modulus": 0.25e6, "compression_factor": 0.54},
    "foam": {"modulus": 4e6, "plateau": 0.2e6, "densification": 0.8},
    "crush": {"modulus": 4e6, "plateau": 0.2e6, "densification": 0.8},
}
"""Properties of the pads of the picture: made up, each so that the blow presses it to about half its thickness."""
STYLES = ("-", "--", "-.", ":", (0, (6, 1)), (0, (1, 1)))
"""Dashes of the laws, in their order: foam and crush lie on each other on the way in."""
_POINTS = 301


class DrawnLaw(NamedTuple):
    """A law to draw: name, contact, and how its line looks."""

    name: str
    contact: AnyContact
    style: dict[str, object]


def cushion_curves() -> Figure:
    """Draw force over compression of the laws on equal pads, and the pulse of the same mass on each without other loss.

    A thin line is the way back of the one that crushes.

    Examples
    --------
    >>> [axes.get_xlabel() for axes in cushion_curves().axes]
    ['compression (mm)', 'time (ms)']
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=WHOLE, layout="constrained")
    left, right = figure.subplots(1, 2)
    (metre, _), (newton, _) = axis_unit("m", "mm"), axis_unit("N", "kN")
    (second, _), (size, _) = axis_unit("s", "ms"), axis_unit("m/s^2", "g")
    for law in _drawn():
        blow = solve_impact(law.contact, SHOWN_MASS, math.inf, SHOWN_SPEED)
        deepest = float(blow.max_indentation)
        end = 0.75 * SHOWN_PAD.thickness
        if isinstance(law.contact, HardeningContact):
            end = min(end, float(law.contact.end_depth))
        d = np.linspace(0.0, end, _POINTS)
        left.plot(d / metre, slow_force(law.contact, d) / newton, label=law.name, **law.style)
        if law.contact.cap is not None:
            back = np.linspace(float(blow.residual_indentation), deepest, 2)
            left.plot(back / metre, slow_force(law.contact, back, deepest) / newton, **{**law.style, "linewidth": 0.8})
        history = impact_history(blow)
        right.plot(history.time / second, history.force / (SHOWN_MASS * size), **law.style)
    sizes = f"{with_unit(SHOWN_PAD.area, 'm^2', 'cm^2')} and {with_unit(SHOWN_PAD.thickness, 'm', 'mm')}"
    quiet(left, f"Pads of {sizes}", headed("compression", "m", "mm"), headed("force", "N", "kN"))
    struck = f"{with_unit(SHOWN_MASS, 'kg', 'kg')} at {with_unit(SHOWN_SPEED, 'm/s', 'm/s')}"
    quiet(right, f"{struck} on them", headed("time", "s", "ms"), headed("acceleration", "m/s^2", "g"))
    left.set_ylim(0.0, 2e3 / newton)
    right.set_ylim(bottom=0.0)
    right.margins(x=0.03)
    right.set_xlim(left=0.0)
    return legend_below(figure)


def _drawn() -> list[DrawnLaw]:
    return [
        DrawnLaw(
            name,
            Cushion(name, SHOWN_PAD, properties).contact(),
            {"color": MANY_COLOURS[k], "linestyle": STYLES[k], "linewidth": 1.5},
        )
        for k, (name, properties) in enumerate(SHOWN.items())
    ]
