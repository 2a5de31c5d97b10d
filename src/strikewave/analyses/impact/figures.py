"""Pictures of the contact laws: restitution that damping laws give, stiffness over load, cushions and their pulses."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.citations import FROM_MEMORY
from strikewave.contact import (
    DampingLaw,
    Geometry,
    LogarithmicStiffness,
    Stiffness,
    StiffnessLaw,
    damping_laws,
    impact_history,
    restitution,
    slow_force,
    solve_impact,
    stiffness_laws,
    stiffness_of,
)
from strikewave.contact.cushions import Cushion, Pad
from strikewave.contact.law import AnyContact, HardeningContact, indentation_under
from strikewave.contact.stiffness import ElasticBody
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.style import BLUE, GREEN, ORANGE, RED, WHOLE, legend_below, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

LOWEST = 0.01
"""Smallest coefficient of restitution drawn: some laws have no value at 0."""
MANY_COLOURS = (BLUE, RED, GREEN, ORANGE, "#CC79A7", "#56B4E9", "#000000")
BELOW = "Difference, logarithmic beyond 10 %"
MARKS = ("o", "s", "^", "D", "v")


def asked_given(laws: Mapping[str, DampingLaw] | None = None) -> Figure:
    """Draw the restitution of damping laws, all by default, over the one asked for, and the difference below.

    Examples
    --------
    >>> [axes.get_ylabel() for axes in asked_given().axes]
    ['restitution given (-)', 'difference (% of e)']
    """
    e = np.linspace(LOWEST, 1.0, 199)
    curves = [(law, restitution(law.function(e))) for law in (damping_laws() if laws is None else laws).values()]
    curves.sort(key=lambda pair: -float(np.interp(0.5, e, pair[1])))
    figure, (above, below) = _two_panels((1.5, 1.0))
    above.plot(e, e, color="#D0D0D0", linewidth=6.0, label="given = asked", zorder=1)
    below.axhline(0.0, color="#D0D0D0", linewidth=6.0, zorder=1)
    for k, (law, given) in enumerate(curves):
        style = _style(k, law, e.size)
        above.plot(e, given, label=_named(law), **style)
        below.plot(e, 100.0 * (given / e - 1.0), **style)
    quiet(above, "Restitution that the damping laws give", "", "restitution given (-)")
    quiet(below, BELOW, "restitution asked for, e (-)", "difference (% of e)")
    above.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    _symmetric_log(below)
    _list_beside(figure, above, "in the order at e = 0.5")
    return figure


def stiffness_over_load(one: ElasticBody, other: ElasticBody, geometry: Geometry, loads: ArrayLike) -> Figure:
    """Draw the indentation of two bodies over the load by every stiffness law, and the difference below.

    Laws that need a size not given, or do not hold for the sizes, are left out; a law ends where its formula ends.
    Loads ascend, N.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> steel = material("65Mn")
    >>> figure = stiffness_over_load(steel, steel, Geometry(0.01, 0.02, 0.04), [1e3, 1e4, 1e5])
    >>> figure.axes[1].get_ylabel()
    'difference from johnson (%)'
    """
    from matplotlib.ticker import FuncFormatter

    force = np.asarray(loads, dtype=float)
    curves = _indentations(one, other, geometry, force)
    if not curves:
        raise ValueError(f"no stiffness law does with these sizes: {_sizes(geometry)}")
    curves.sort(key=lambda pair: -float(np.nan_to_num(pair[1][-1])))
    figure, (above, below) = _two_panels((1.2, 1.0))
    reference = next((pair for pair in curves if pair[0].name == "johnson"), curves[0])
    (newton, _), (metre, _) = axis_unit("N", "kN"), axis_unit("m", "um")
    for k, (law, depth) in enumerate(curves):
        style = _style(k, law, force.size)
        above.loglog(force / newton, depth / metre, label=_named(law), **style)
        below.semilogx(force / newton, 100.0 * (depth / reference[1] - 1.0), **style)
    quiet(above, f"Indentation by the stiffness laws: {_sizes(geometry)}", "", headed("indentation", "m", "um"))
    quiet(below, BELOW, headed("load", "N", "kN"), f"difference from {reference[0].name} (%)")
    for axis in (below.xaxis, above.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    _symmetric_log(below)
    _list_beside(figure, above, "in the order at the largest load")
    return figure


def _sizes(geometry: Geometry) -> str:
    """Name the sizes that are given."""
    named = {"R1": geometry.radius1, "R2": geometry.radius2, "length": geometry.length}
    named["datum depth"] = geometry.datum_depth
    return ", ".join(
        f"{name} {'plane' if np.isinf(size) else with_unit(size, 'm', 'mm', 6)}"
        for name, size in named.items()
        if size is not None
    )


def _indentations(
    one: ElasticBody, other: ElasticBody, geometry: Geometry, force: Array
) -> list[tuple[StiffnessLaw, Array]]:
    """Return the laws that the sizes do for, and their indentations; NaN beyond the end of a law."""
    curves = []
    for name, law in stiffness_laws().items():
        try:
            stiffness = stiffness_of(name, one, other, geometry)
        except Exception:  # a size that is missing or out of range, or whatever a law of a foreign package does
            continue
        curves.append((law, _depths(stiffness, force)))
    return curves


def _depths(stiffness: Stiffness | LogarithmicStiffness, force: Array) -> Array:
    contact = stiffness.contact()
    depths = np.array([indentation_under(contact, float(f)) for f in force])
    end = stiffness.load / math.e if isinstance(stiffness, LogarithmicStiffness) else np.inf
    return np.where(force <= end, depths, np.nan)


def _two_panels(heights: tuple[float, float]) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    return figure, figure.subplots(2, 1, sharex=True, height_ratios=heights)


def _style(k: int, law: DampingLaw | StiffnessLaw, count: int) -> dict[str, Any]:
    """Return the look of a law: dashed from memory; colour and mark tell it from the others."""
    every = max(count // 9, 1)
    return {
        "color": MANY_COLOURS[k % len(MANY_COLOURS)],
        "linestyle": "--" if law.status == FROM_MEMORY else "-",
        "marker": MARKS[k % len(MARKS)],
        "markersize": 4.5,
        "markevery": (k * every // 5 % every, every),
        "linewidth": 1.2,
        "zorder": 3,
    }


def _named(law: DampingLaw | StiffnessLaw) -> str:
    return law.name + (" (from memory)" if law.status == FROM_MEMORY else "")


def _list_beside(figure: Any, axes: Any, title: str) -> None:
    figure.legend(
        *axes.get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=8.5, title=title,
        title_fontsize=8.5, alignment="left", handlelength=3.0, labelspacing=0.7,
    )  # fmt: skip


def _symmetric_log(axes: Any) -> None:
    """Scale an axis of per cent: linear within 10 %, logarithmic beyond."""
    from matplotlib.ticker import FixedLocator, FuncFormatter

    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    low, high = 1.5 * min(float(np.nanmin(drawn)), -4.0), 1.5 * max(float(np.nanmax(drawn)), 4.0)
    axes.set_yscale("symlog", linthresh=10.0)
    ticks = [t for t in (-100, -50, -10, -5, 0, 5, 10, 50, 100, 1000, 10_000) if low <= t <= high]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:+,.0f}".replace(",", " ") if value else "0"))
    axes.set_ylim(low, high)


SHOWN_PAD, SHOWN_MASS, SHOWN_SPEED = Pad(area=2e-3, thickness=20e-3), 2.0, 2.0
"""The pad of the picture, the mass (kg) and the speed (m/s) that it stops: 4 J."""
SHOWN_CUSHIONS = {
    "linear": {"modulus": 0.8e6},
    "power": {"stress": 1.8e6, "exponent": 2.5},
    "tangent": {"modulus": 0.5e6, "limit_strain": 0.8},
    "elastomer": {"modulus": 0.25e6, "compression_factor": 0.54},
    "foam": {"modulus": 4e6, "plateau": 0.2e6, "densification": 0.8},
    "crush": {"modulus": 4e6, "plateau": 0.2e6, "densification": 0.8},
}
"""Properties of the pads of the picture: made up, each so that the blow presses it to about half its thickness."""
CUSHION_DASHES = ("-", "--", "-.", ":", (0, (6, 1)), (0, (1, 1)))
"""Dashes of the laws, in their order: foam and crush lie on each other on the way in."""
_CURVE_POINTS = 301


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
    for law in _cushions_shown():
        blow = solve_impact(law.contact, SHOWN_MASS, math.inf, SHOWN_SPEED)
        deepest = float(blow.max_indentation)
        end = 0.75 * SHOWN_PAD.thickness
        if isinstance(law.contact, HardeningContact):
            end = min(end, float(law.contact.end_depth))
        d = np.linspace(0.0, end, _CURVE_POINTS)
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


def _cushions_shown() -> list[DrawnLaw]:
    return [
        DrawnLaw(
            name,
            Cushion(name, SHOWN_PAD, properties).contact(),
            {"color": MANY_COLOURS[k], "linestyle": CUSHION_DASHES[k], "linewidth": 1.5},
        )
        for k, (name, properties) in enumerate(SHOWN_CUSHIONS.items())
    ]


def picture(result: Any) -> Figure:
    """Return the picture of the laws in Python: the restitution that they give over the one asked for."""
    return asked_given(result.everything.damping)
