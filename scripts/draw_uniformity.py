"""The picture of docs/hopkinson.md on how the forces on an elastic specimen come together.

    python scripts/draw_uniformity.py [IMPEDANCE_RATIO ...]

A step on the left, a straight rise on the right; the strip marks the 3 to 5 transits by which equilibrium is often
taken for granted. Writes docs/images/stress-uniformity.svg.
"""

import sys
from pathlib import Path

import numpy as np

from strikewave.hopkinson.checks import UNIFORM, face_forces, stress_difference
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, WHOLE, new_figure, quiet, save

IMAGE = Path(__file__).parents[1] / "docs" / "images" / "stress-uniformity.svg"
RATIOS = (0.1, 0.25, 0.5, 1.0)
RISE, TRANSITS = 2.0, 12
MARKED_TRANSITS = (3.0, 5.0)
LOOKS = ((BLUE, "-"), (RED, "--"), (GREEN, "-."), (ORANGE, ":"))


def uniformity(ratios=RATIOS):
    """Return the picture for some impedance ratios of specimen and bar."""
    figure = new_figure(WHOLE)
    left, right = figure.subplots(1, 2, sharey=True)
    time = np.linspace(0.005, TRANSITS, 40 * TRANSITS)
    for beta, (colour, dash) in zip(ratios, LOOKS, strict=False):
        k = np.arange(1, TRANSITS + 1)
        steps = 100.0 * stress_difference(beta, k)
        left.step(np.append(k - 1, TRANSITS), np.append(steps, steps[-1]), dash, where="post", color=colour)
        ramp = 100.0 * np.abs(face_forces(beta, time, RISE).alpha)
        right.plot(time, ramp, dash, color=colour, label=f"β = {beta:g}")
    for axes, title in ((left, "Step"), (right, f"Straight rise over {RISE:g} transits")):
        axes.axvspan(*MARKED_TRANSITS, color="#EFEFEF", zorder=0)
        axes.axhline(100.0 * UNIFORM, color=GREY, linewidth=0.9, linestyle="--")
        quiet(axes, title, "time over transit time t/t₀", "force difference |α| (%)")
        axes.set_yscale("log")
        axes.set_ylim(0.1, 300.0)
        axes.set_xlim(0.0, TRANSITS)
    right.set_ylabel("")
    handles, labels = right.get_legend_handles_labels()
    left.legend(handles, labels, frameon=False, fontsize=8, loc="upper right")
    return figure


if __name__ == "__main__":
    save(uniformity(tuple(map(float, sys.argv[1:])) or RATIOS), IMAGE)
    print(IMAGE)
