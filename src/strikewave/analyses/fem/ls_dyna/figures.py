"""Pictures that compare a run of LS-DYNA with ours: contact forces and energies of both."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.histories import TINY
from strikewave.reporting.curves import COLOURS, shortened, thin
from strikewave.reporting.numbers import axis_unit, energy_unit, headed, time_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    ORANGE,
    RED,
    WHOLE,
    empty_axes,
    new_figure,
    one_diagram,
    quiet,
    sheet_title,
)

if TYPE_CHECKING:
    from strikewave.exchange.ls_dyna.comparison import ForcePair, RunComparison
    from strikewave.exchange.ls_dyna.folder import EnergyHistory, LsDynaContact

OURS, THEIRS = BLUE, RED
"""Colours of strikewave and of LS-DYNA."""
CONTACT_COLOURS = (*COLOURS, "#000000")
"""One for each contact that is drawn: those that reach farthest."""
BEYOND = 0.35
"""Share of the pulse width that is shown before and after a pulse (chosen: both onsets are seen, also where one code is
a little late)."""
_LOOKS = {"kinetic": BLUE, "internal": RED, "hourglass": ORANGE, "contact": GREEN, "external": GREY, "total": "#000000"}


def comparison_sheet(comparison: RunComparison, title: str) -> Figure:
    """Draw the forces of both above their energies, on one sheet.

    Parameters
    ----------
    comparison : RunComparison
        Both runs, or LS-DYNA's alone.
    title : str
        Stands above.
    """
    figure = new_figure((9.8, 7.6))
    sheet_title(figure, title)
    above, below = figure.subplots(2, 1)
    pairs = _drawn(comparison)
    draw_force(above, pairs[0]) if pairs else draw_contacts(above, comparison.ls_dyna.contacts)
    _draw_balances(below, comparison)
    return figure


def force_figure(pair: ForcePair) -> Figure:
    """Draw a contact force of both, as wide as a page."""
    return one_diagram(lambda axes: draw_force(axes, pair), WHOLE)


def contact_figure(contacts: tuple[LsDynaContact, ...]) -> Figure:
    """Draw LS-DYNA's contact forces alone, as wide as a page."""
    return one_diagram(lambda axes: draw_contacts(axes, contacts), WHOLE)


def energy_figure(comparison: RunComparison) -> Figure:
    """Draw the energies of both, as wide as a page."""
    return one_diagram(lambda axes: _draw_balances(axes, comparison), (WHOLE[0], HALF[1] * 1.2))


def draw_force(axes: Any, pair: ForcePair) -> None:
    """Draw the size of a contact force of both about its pulse, and the peaks."""
    pulses = [pulse for pulse in (pair.strikewave, pair.ls_dyna) if pulse]
    newton, _ = axis_unit("N", "kN")
    scale, unit = time_unit(max((pulse.end for pulse in pulses), default=float(pair.curves[0].time[-1])))
    looks = (("strikewave", OURS, "-"), (f"LS-DYNA, contact {pair.contact.number} side {pair.side}", THEIRS, "--"))
    for (label, colour, dash), curve, pulse in zip(looks, pair.curves, (pair.strikewave, pair.ls_dyna), strict=True):
        axes.plot(*thin(curve.time / scale, curve.size / newton), dash, color=colour, linewidth=1.5, label=label)
        if pulse:
            axes.plot(pulse.at / scale, pulse.peak / newton, "o", markersize=4, color=colour)
    quiet(axes, f"Contact force: {shortened(pair.name, 60)}", f"time ({unit})", headed("force", "N", "kN"))
    if pulses:
        begin, end = min(pulse.begin for pulse in pulses), max(pulse.end for pulse in pulses)
        first = min(float(curve.time[0]) for curve in pair.curves)
        axes.set_xlim(max(first, begin - BEYOND * (end - begin)) / scale, (end + BEYOND * (end - begin)) / scale)
    axes.set_ylim(bottom=0.0)
    _legend(axes)


def draw_contacts(axes: Any, contacts: tuple[LsDynaContact, ...]) -> None:
    """Draw the sizes of LS-DYNA's contact forces, those that reach farthest."""
    if not contacts:
        empty_axes(axes, "Contact force", "no rcforc or binout is there")
        return
    ranked = sorted(contacts, key=lambda contact: -float(contact.first.size.max(initial=0.0)))[: len(CONTACT_COLOURS)]
    newton, _ = axis_unit("N", "kN")
    scale, unit = time_unit(max(float(contact.first.time[-1]) for contact in ranked))
    for contact, colour in zip(ranked, CONTACT_COLOURS, strict=False):
        force = contact.first
        axes.plot(*thin(force.time / scale, force.size / newton), color=colour, label=shortened(contact.name, 40))
    quiet(axes, "Contact force of LS-DYNA", f"time ({unit})", headed("force", "N", "kN"))
    axes.set_ylim(bottom=0.0)
    _legend(
        axes, f"{len(ranked)} of {len(contacts)}: those that reach farthest" if len(contacts) > len(ranked) else None
    )


def draw_energies(axes: Any, histories: Mapping[str, EnergyHistory]) -> None:
    """Draw the energies of one run or both over time: ours in full lines, LS-DYNA's dashed."""
    reach = {who: {name: _reach(v) for name, v in history.energy.items()} for who, history in histories.items()}
    most = max((largest for energies in reach.values() for largest in energies.values()), default=0.0)
    if not most > 0.0:
        empty_axes(axes, "Energy", "all energies are 0")
        return
    factor, energy_name = energy_unit(most)
    scale, unit = time_unit(max(float(history.time[-1]) for history in histories.values()))
    for who, history in histories.items():
        dash = "-" if who == "strikewave" else "--"
        for name, values in history.energy.items():
            if reach[who][name] > TINY * most:
                time, shown = thin(history.time / scale, np.nan_to_num(values) / factor)
                axes.plot(time, shown, dash, color=_LOOKS[name], linewidth=1.3, label=f"{name}, {who}")
    quiet(axes, "Energy", f"time ({unit})", f"energy ({energy_name})")
    _legend(axes)


def _reach(values: NDArray[np.float64]) -> float:
    """Return the largest size of what is known; 0 where nothing is."""
    return float(np.nan_to_num(np.abs(values)).max(initial=0.0))


def _draw_balances(axes: Any, comparison: RunComparison) -> None:
    both = {
        "strikewave": comparison.strikewave.energies if comparison.strikewave else None,
        "LS-DYNA": comparison.ls_dyna.energies,
    }
    histories = {who: history for who, history in both.items() if history is not None and len(history.time)}
    if histories:
        draw_energies(axes, histories)
    else:
        empty_axes(axes, "Energy", "no glstat or binout is there")


def _drawn(comparison: RunComparison) -> list[ForcePair]:
    """Return the pairs in which something touches, the largest force first."""
    touched = [pair for pair in comparison.forces if pair.strikewave or pair.ls_dyna]
    return sorted(touched, key=lambda pair: -max(pulse.peak for pulse in (pair.strikewave, pair.ls_dyna) if pulse))


def _legend(axes: Any, title: str | None = None) -> None:
    """Put the legend beside the axes, where it hides no curve."""
    legend = axes.legend(
        frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), title=title, title_fontsize=8
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
