"""The report of a run of LS-DYNA, alone or compared with ours: forces, energies, fields, and their differences."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.fem.ls_dyna.figures import comparison_sheet, contact_figure, energy_figure, force_figure
from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
from strikewave.base.declare import declarations
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.exchange.ls_dyna.comparison import ForcePair, PulseDifferences, RunComparison
from strikewave.exchange.ls_dyna.folder import ENERGIES, ContactPulse, Extreme, LsDynaRun
from strikewave.fem.measures import EnergyExtent
from strikewave.reporting import chapters
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, columns_of, face_table, text_of
from strikewave.reporting.numbers import shown
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    theirs, ours = result.found.ls_dyna, result.found.strikewave
    sections = [_forces(result), _energies(result)]
    sections += [_fields(result)] if theirs.fields or (ours and ours.extremes) else []
    sections += [chapters.warnings(result.notices), _read(theirs)]
    summary = chapters.Summary("Report of a run of LS-DYNA", ls_dyna_words(result), result.highlights())
    return chapters.result_page(result, summary, sections)


def ls_dyna_words(result: LsDynaResult) -> str:
    """Say in words what the contact came to, and how far both runs are apart: on the screen and in the report."""
    for name, pair in result.strongest_pair.items():
        theirs, ours = (text_of(pulse, "peak") for pulse in (pair.ls_dyna, pair.strikewave))
        peak, width, impulse = (text_of(pair.differences, what) for what in ("peak", "width", "impulse"))
        return (
            f"Contact {name}: LS-DYNA reaches {theirs}, strikewave {ours} ({peak}); pulse width {width}, impulse "
            f"{impulse}.{_meshed(result.found)}"
        )
    for name, pulse in result.strongest_pulse.items():
        return f"Contact {name} of LS-DYNA reaches {text_of(pulse, 'peak')}; no run of strikewave to compare."
    return "Nothing touched." if result.pulses else "No contact force is in the folder."


def _meshed(comparison: RunComparison) -> str:
    """Say that a sector is compared, where forces of whole bodies stand elsewhere."""
    of_sector = comparison.strikewave is not None and comparison.strikewave.as_meshed
    return " Forces and energies of both are those of the meshed sector, not of whole bodies." if of_sector else ""


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
    comparison, parts = result.found, list[Part]()
    for pair in comparison.forces:
        caption = f"Magnitude of the contact force {pair.name}: strikewave solid, LS-DYNA dashed."
        parts.append(Picture(force_figure(pair), caption))
    if not comparison.forces and comparison.ls_dyna.contacts:
        parts.append(
            Picture(contact_figure(comparison.ls_dyna.contacts), "Magnitudes of the contact forces of LS-DYNA.")
        )
    parts += [pair_table(pair) for pair in comparison.forces]
    parts.append(contact_table(result))
    return Section("Contact forces", _DIFFERENCES if comparison.forces else "", parts)


def pair_table(pair: ForcePair) -> Table:
    """Return the numbers of a contact of both."""
    both, differs = (pair.ls_dyna, pair.strikewave), declarations(PulseDifferences)
    rows: list[list[Cell]] = [
        [column.head, *column.cells(), text_of(pair.differences, name) if name in differs else NONE]
        for name, column in zip(declarations(ContactPulse), columns_of(ContactPulse, both), strict=True)
    ]
    rows += [[column.head, *column.cells(), NONE, NONE] for column in columns_of(ForcePair, [pair], "pair")]
    heads = ["", *RUNS, "difference"]
    return Table(f"Contact {pair.name}: contact {pair.contact.name} of LS-DYNA, side {pair.side}", heads, rows)


def contact_table(result: LsDynaResult) -> Table:
    """Return what each contact of LS-DYNA came to, by side."""
    empty = "No rcforc or binout with contact forces is there."
    return face_table(result, "sides", "contacts", "Contacts of LS-DYNA", empty)


def _table_of_both(caption: str, heads: list[str], kind: type, rows: Sequence[tuple[Any, ...]], empty: str) -> Table:
    """Return a table of columns of LS-DYNA and strikewave in turn; rows end with what they are of, None for nothing."""
    columns = [Column(head, [row[place] for row in rows]) for place, head in enumerate(heads)]
    for pair in zip(*(columns_of(kind, [row[place] for row in rows]) for place in (-2, -1)), strict=True):
        columns += [one._replace(name=f"{one.name}, {run}") for one, run in zip(pair, RUNS, strict=True)]
    return page_table(caption, columns, empty)


def _energies(result: LsDynaResult) -> Section:
    picture = Picture(energy_figure(result.found), "Energies: strikewave solid, LS-DYNA dashed.")
    return Section("Energies", _ENERGIES, [picture, energy_table(result)])


def energy_table(result: LsDynaResult) -> Table:
    """Return the energies of both: the largest in size over time, and at the end."""
    theirs, ours = result.read.energy or {}, result.comparison.energy if result.comparison else {}
    rows = [(word, theirs.get(word), ours.get(word)) for word in ENERGIES if word in theirs or word in ours]
    return _table_of_both("Energies", ["energy"], EnergyExtent, rows, "No glstat or binout with energies is there.")


def _fields(result: LsDynaResult) -> Section:
    text = (
        "Largest in each part at the instants of its fields; of an element with several points, their mean; stress and "
        "strain without deleted elements."
    )
    return Section("Fields", text, [field_table(result.found)])


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
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def picture(result: LsDynaResult) -> Figure:
    """Return the sheet of forces and energies."""
    return comparison_sheet(result.found, result.title)


def draw_result(result: LsDynaResult, folder: Path) -> list[str]:
    """Write page and picture into a folder, and return their names."""
    with drawing(folder / "comparison.svg") as path:
        save(picture(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(ls_dyna_report(result), "utf-8", newline="\n")
    return ["report.html", "comparison.svg"]
