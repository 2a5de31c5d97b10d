"""The report of a run of LS-DYNA, alone or compared with ours: forces, energies, fields, differences, pictures."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.histories import TINY
from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
from strikewave.base.declare import declarations
from strikewave.base.shock_quantities import FORCE, MICROSECONDS
from strikewave.exchange.ls_dyna.comparison import ForcePair, PulseDifferences, RunComparison
from strikewave.exchange.ls_dyna.folder import ENERGIES, ContactPulse, EnergyHistory, Extreme, LsDynaContact, LsDynaRun
from strikewave.fem.run import EnergyExtent
from strikewave.reporting import chapters
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, columns_of, face_table, text_of
from strikewave.reporting.numbers import axis_unit, energy_unit, headed, shown, time_unit
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import (
    BLUE,
    COLOURS,
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
    save,
    sheet_title,
    shortened,
    thin,
)

RUNS = ("LS-DYNA", "strikewave")

_METHOD = (
    "LS-DYNA computed its numbers; strikewave read them from its files, in the units that were stated, as the files "
    "have none. The peak is the largest magnitude of the force. The pulse width lasts from the first to the last 10 % "
    "of the peak. The impulse is the magnitude of the force integrated over the run. Forces of strikewave are means "
    "over the intervals of the histories."
)
_DIFFERENCES = (
    "Differences are (LS-DYNA - strikewave) / strikewave. M, P and C are the metrics of Sprague and Geers (2003): "
    "magnitude, phase (0 to 1), and both combined; RMS is the root mean square difference over the peak of strikewave. "
    'The window holds both pulses; for "onsets aligned" the pulse of LS-DYNA is shifted to the onset of strikewave.'
)
_ENERGIES = (
    "The internal energy of strikewave includes the work of bulk viscosity, which LS-DYNA does not list by itself. "
    "The hourglass energy of LS-DYNA is 0 where its deck did not ask for it (HGEN = 2 of *CONTROL_ENERGY)."
)


def ls_dyna_report(result: LsDynaResult) -> str:
    """Return the report as one HTML page: no script, nothing fetched."""
    theirs, ours = result.runs.ls_dyna, result.runs.strikewave
    sections = [_forces(result), _energies(result)]
    sections += [_fields(result)] if theirs.fields or (ours and ours.extremes) else []
    sections += [chapters.warnings(result.notices), _read(theirs)]
    summary = chapters.Summary("Report of a run of LS-DYNA", ls_dyna_words(result), result.highlights())
    return chapters.result_page(result, summary, sections)


def ls_dyna_words(result: LsDynaResult) -> str:
    """Return the force of the contact, and its difference, in a sentence for the screen and the report."""
    for name, pair in result.strongest_pair.items():
        theirs, ours = (text_of(pulse, "peak") for pulse in (pair.ls_dyna, pair.strikewave))
        peak, width, impulse = (text_of(pair.differences, what) for what in ("peak", "width", "impulse"))
        of_sector = result.runs.strikewave is not None and result.runs.strikewave.as_meshed
        return (
            f"Contact {name}: LS-DYNA reaches {theirs}, strikewave {ours} ({peak}); pulse width {width}, impulse "
            f"{impulse}."
            + (" Forces and energies of both are those of the meshed sector, not of whole bodies." if of_sector else "")
        )
    for name, pulse in result.strongest_pulse.items():
        return f"Contact {name} of LS-DYNA reaches {text_of(pulse, 'peak')}; no run of strikewave to compare."
    return "Nothing touched." if result.pulses else "No contact force is in the folder."


def _read(theirs: LsDynaRun) -> Section:
    rows: list[list[Cell]] = [[path.name, f"{path.stat().st_size}"] for path in theirs.files]
    first, last = theirs.span
    text = (
        f"From {written(shown(first, *MICROSECONDS.units))} to {amount(MICROSECONDS, last)}. " if last == last else ""
    )
    if theirs.fields:
        mesh = theirs.fields.mesh
        text += f"{len(mesh.hexahedra)} solids, {len(mesh.points)} nodes, {theirs.frames} states. "
    return Section("What was read", text + _METHOD, [Table("Files", ["file", "bytes"], rows)])


def _forces(result: LsDynaResult) -> Section:
    comparison, parts = result.runs, list[Part]()
    for pair in comparison.forces:
        caption = f"Magnitude of the contact force {pair.name}: strikewave solid, LS-DYNA dashed."
        parts.append(Picture(one_diagram(functools.partial(draw_force, pair=pair), WHOLE), caption))
    if not comparison.forces and comparison.ls_dyna.contacts:
        figure = one_diagram(lambda axes: draw_contacts(axes, comparison.ls_dyna.contacts), WHOLE)
        parts.append(Picture(figure, "Magnitudes of the contact forces of LS-DYNA."))
    parts += [pair_table(pair) for pair in comparison.forces]
    parts.append(contact_table(result))
    return Section("Contact forces", _DIFFERENCES if comparison.forces else "", parts)


def pair_table(pair: ForcePair) -> Table:
    """Return the numbers of a contact in both runs."""
    both, differs = (pair.ls_dyna, pair.strikewave), declarations(PulseDifferences)
    rows: list[list[Cell]] = [
        [column.head, *column.cells(), text_of(pair.differences, name) if name in differs else NONE]
        for name, column in zip(declarations(ContactPulse), columns_of(ContactPulse, both), strict=True)
    ]
    rows += [[column.head, *column.cells(), NONE, NONE] for column in columns_of(ForcePair, [pair], "pair")]
    heads = ["", *RUNS, "difference"]
    return Table(f"Contact {pair.name}: contact {pair.contact.name} of LS-DYNA, side {pair.side}", heads, rows)


def contact_table(result: LsDynaResult) -> Table:
    """Return the numbers of each contact of LS-DYNA, by side."""
    empty = "No rcforc or binout with contact forces is there."
    return face_table(result, "sides", "contacts", "Contacts of LS-DYNA", empty)


def _table_of_both(caption: str, heads: list[str], kind: type, rows: Sequence[tuple[Any, ...]], empty: str) -> Table:
    """Return a table with columns of LS-DYNA and strikewave in turn; each row ends with both, or None."""
    columns = [Column(head, [row[place] for row in rows]) for place, head in enumerate(heads)]
    for pair in zip(*(columns_of(kind, [row[place] for row in rows]) for place in (-2, -1)), strict=True):
        columns += [column._replace(name=f"{column.name}, {run}") for column, run in zip(pair, RUNS, strict=True)]
    return page_table(caption, columns, empty)


def _energies(result: LsDynaResult) -> Section:
    figure = one_diagram(lambda axes: _draw_balances(axes, result.runs), (WHOLE[0], HALF[1] * 1.2))
    picture = Picture(figure, "Energies: strikewave solid, LS-DYNA dashed.")
    return Section("Energies", _ENERGIES, [picture, energy_table(result)])


def energy_table(result: LsDynaResult) -> Table:
    """Return the energies of both: the largest in size over time, and at the end."""
    theirs, ours = result.read.energy or {}, result.comparison.energy if result.comparison else {}
    rows = [(name, theirs.get(name), ours.get(name)) for name in ENERGIES if name in theirs or name in ours]
    return _table_of_both("Energies", ["energy"], EnergyExtent, rows, "No glstat or binout with energies is there.")


def _fields(result: LsDynaResult) -> Section:
    text = (
        "Largest in each part at the instants of its fields; of an element with several points, their mean; stress and "
        "strain without deleted elements."
    )
    return Section("Fields", text, [field_table(result.runs)])


def field_table(comparison: RunComparison) -> Table:
    """Return the extremes of the parts of both, pairs first."""
    theirs, ours = comparison.ls_dyna.extremes, comparison.strikewave.extremes if comparison.strikewave else {}
    pairs: list[tuple[str | None, str | None]] = [(other, name) for name, other in comparison.parts.items()]
    pairs += [(other, None) for other in theirs if other not in comparison.parts.values()]
    pairs += [(None, name) for name in ours if name not in comparison.parts]
    rows = [(other, name, theirs.get(other or ""), ours.get(name or "")) for other, name in pairs]
    heads = [f"part in {run}" for run in RUNS]
    return _table_of_both("Parts", heads, Extreme, rows, "No fields are there.")


page = ls_dyna_report
"""Page of a result in Python, found as `picture` is by `strikewave.reporting.shown_result`."""


def picture(result: LsDynaResult) -> Figure:
    """Return the sheet of forces and energies."""
    return comparison_sheet(result.runs, result.title)


def draw_result(result: LsDynaResult, folder: Path) -> list[str]:
    """Write page and picture into a folder, and return their names."""
    with drawing(folder / "comparison.svg") as path:
        save(picture(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(ls_dyna_report(result), "utf-8", newline="\n")
    return ["report.html", "comparison.svg"]


OUR_COLOUR, THEIR_COLOUR = BLUE, RED
"""Colours of strikewave and of LS-DYNA."""
CONTACT_COLOURS = (*COLOURS, "#000000")
"""One for each contact that is drawn: those that reach farthest."""
BESIDE_PULSE = 0.35  # chosen: both onsets are in view though one code is late
"""Share of the pulse width shown before and after a pulse."""
_ENERGY_COLOURS = {
    "kinetic": BLUE,
    "internal": RED,
    "hourglass": ORANGE,
    "contact": GREEN,
    "external": GREY,
    "total": "#000000",
}


def comparison_sheet(comparison: RunComparison, title: str) -> Figure:
    """Draw the forces of both runs, or of LS-DYNA alone, above their energies, on one sheet."""
    figure = new_figure((9.8, 7.6))
    sheet_title(figure, title)
    above, below = figure.subplots(2, 1)
    touched = [pair for pair in comparison.forces if pair.strikewave or pair.ls_dyna]
    if touched:
        draw_force(above, max(touched, key=lambda p: max(x.peak for x in (p.strikewave, p.ls_dyna) if x)))
    else:
        draw_contacts(above, comparison.ls_dyna.contacts)
    _draw_balances(below, comparison)
    return figure


def draw_force(axes: Any, pair: ForcePair) -> None:
    """Draw the size of a contact force of both about its pulse, and the peaks."""
    pulses = [pulse for pulse in (pair.strikewave, pair.ls_dyna) if pulse]
    newton, _ = axis_unit(*FORCE.units)
    scale, unit = time_unit(max((pulse.end for pulse in pulses), default=float(pair.curves[0].time[-1])))
    looks = (
        ("strikewave", OUR_COLOUR, "-"),
        (f"LS-DYNA, contact {pair.contact.number} side {pair.side}", THEIR_COLOUR, "--"),
    )
    for (label, colour, dash), curve, pulse in zip(looks, pair.curves, (pair.strikewave, pair.ls_dyna), strict=True):
        axes.plot(*thin(curve.time / scale, curve.size / newton), dash, color=colour, linewidth=1.5, label=label)
        if pulse:
            axes.plot(pulse.at / scale, pulse.peak / newton, "o", markersize=4, color=colour)
    quiet(axes, f"Contact force: {shortened(pair.name, 60)}", f"time ({unit})", headed("force", *FORCE.units))
    if pulses:
        begin, end = min(pulse.begin for pulse in pulses), max(pulse.end for pulse in pulses)
        first = min(float(curve.time[0]) for curve in pair.curves)
        axes.set_xlim(
            max(first, begin - BESIDE_PULSE * (end - begin)) / scale, (end + BESIDE_PULSE * (end - begin)) / scale
        )
    axes.set_ylim(bottom=0.0)
    _legend(axes)


def draw_contacts(axes: Any, contacts: tuple[LsDynaContact, ...]) -> None:
    """Draw the sizes of LS-DYNA's contact forces, those that reach farthest."""
    if not contacts:
        empty_axes(axes, "Contact force", "no rcforc or binout is there")
        return
    ranked = sorted(contacts, key=lambda contact: -float(contact.first.size.max(initial=0.0)))[: len(CONTACT_COLOURS)]
    newton, _ = axis_unit(*FORCE.units)
    scale, unit = time_unit(max(float(contact.first.time[-1]) for contact in ranked))
    for contact, colour in zip(ranked, CONTACT_COLOURS, strict=False):
        force = contact.first
        axes.plot(*thin(force.time / scale, force.size / newton), color=colour, label=shortened(contact.name, 40))
    quiet(axes, "Contact force of LS-DYNA", f"time ({unit})", headed("force", *FORCE.units))
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
                axes.plot(time, shown, dash, color=_ENERGY_COLOURS[name], linewidth=1.3, label=f"{name}, {who}")
    quiet(axes, "Energy", f"time ({unit})", f"energy ({energy_name})")
    _legend(axes)


def _reach(values: NDArray[np.float64]) -> float:
    """Return the largest size of the known values; 0 where none is known."""
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


def _legend(axes: Any, title: str | None = None) -> None:
    """Put the legend beside the axes, where it hides no curve."""
    legend = axes.legend(
        frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), title=title, title_fontsize=8
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
