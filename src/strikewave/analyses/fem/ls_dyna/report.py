"""The report of a run of LS-DYNA, alone or beside ours: forces, energies, fields, and how far both are apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.exchange.ls_dyna.folder import ENERGIES, pulse_of
from strikewave.reporting import chapters
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written

if TYPE_CHECKING:
    from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
    from strikewave.exchange.ls_dyna.comparison import ForcePair, RunComparison
    from strikewave.exchange.ls_dyna.folder import Contact, Extreme, LsDynaRun, Pulse

_METHOD = (
    "Numbers of LS-DYNA were computed by it and read from its files; units are those that were stated, its files have "
    "none. A peak is that of the size of the force; a width lasts from its first to its last tenth of the peak; an "
    "impulse is the size of the force summed over the whole run. Ours are means over the intervals of the histories."
)
_APART = (
    "Differences are (LS-DYNA - ours) / ours. M, P and C are those of Sprague and Geers (2003): of size, of phase "
    "(0 to 1), and both together; RMS is the root mean square difference over our peak. Windows hold both pulses; "
    '"begun together" is the same with LS-DYNA\'s moved so that both begin at once.'
)
_BOOKS = (
    "Internal energy of ours is with the work of bulk viscosity, for which LS-DYNA has no line of its own. Hourglass "
    "energy of LS-DYNA is 0 where its deck did not ask for it (HGEN = 2 of *CONTROL_ENERGY)."
)
_COLUMNS = (("peak", 1e3), ("at", 1e-6), ("impulse", 1.0), ("width", 1e-6))
_FIELDS = (("displacement", 1e-3), ("von_mises", 1e6), ("plastic_strain", 1.0))


def ls_dyna_report(result: LsDynaResult) -> str:
    """Return the report as one HTML page: no script, nothing fetched."""
    beside = result.found
    theirs, ours = beside.ls_dyna, beside.strikewave
    sections = [_read(theirs), _forces(beside), _energies(beside)]
    sections += [_fields(beside)] if theirs.fields or (ours and ours.extremes) else []
    sections.append(chapters.warnings(result.notices))
    summary = chapters.Summary("Report of a run of LS-DYNA", _summary(beside), _key_numbers(beside))
    return chapters.result_page(result, summary, sections)


def _summary(beside: RunComparison) -> str:
    pair = _largest(beside)
    if pair and pair.strikewave and pair.ls_dyna:
        return (
            f"Contact {pair.name}: LS-DYNA reaches {with_unit(pair.ls_dyna.peak, 'N', 'kN')}, ours "
            f"{with_unit(pair.strikewave.peak, 'N', 'kN')} ({share(pair.difference('peak'))}); width "
            f"{share(pair.difference('width'))}, impulse {share(pair.difference('impulse'))}."
        )
    found = {contact.name: pulse_of(contact.first) for contact in beside.ls_dyna.contacts}
    touched = {name: pulse for name, pulse in found.items() if pulse}
    if not touched:
        return "No contact force is in the folder." if not found else "Nothing touched."
    name, most = max(touched.items(), key=lambda one: one[1].peak)
    return f"Contact {name} of LS-DYNA reaches {with_unit(most.peak, 'N', 'kN')}; nothing of ours lies beside it."


def _key_numbers(beside: RunComparison) -> list[tuple[str, str]]:
    pair = _largest(beside)
    numbers = [("contacts", f"{len(beside.ls_dyna.contacts)}"), ("states of d3plot", f"{beside.ls_dyna.frames}")]
    if pair and pair.strikewave and pair.ls_dyna:
        numbers = [
            ("peak, LS-DYNA", with_unit(pair.ls_dyna.peak, "N", "kN")),
            ("peak, ours", with_unit(pair.strikewave.peak, "N", "kN")),
            ("peak, apart", share(pair.difference("peak"))),
            ("width, apart", share(pair.difference("width"))),
            ("impulse, apart", share(pair.difference("impulse"))),
            *numbers,
        ]
    return numbers


def _largest(beside: RunComparison) -> ForcePair | None:
    both = [pair for pair in beside.forces if pair.strikewave and pair.ls_dyna]
    return max(both, key=lambda pair: pair.strikewave.peak if pair.strikewave else 0.0, default=None)


def share(value: float) -> str:
    """Write a relative difference in per cent with its sign; a dash where it is not known.

    Files of LS-DYNA hold six digits: what is less than a hundred-thousandth is not told apart.

    Examples
    --------
    >>> share(0.0312), share(-4e-7), share(float("nan"))
    ('+3.12 %', '< 0.001 %', '–')
    """
    if value != value:
        return NONE
    return "< 0.001 %" if 0.0 < abs(value) < 1e-5 else f"{100.0 * value:+.3g} %"


def _read(theirs: LsDynaRun) -> Section:
    rows: list[list[Cell]] = [[path.name, f"{path.stat().st_size}"] for path in theirs.files]
    first, last = theirs.span
    words = f"From {first * 1e6:.4g} µs to {last * 1e6:.4g} µs. " if last == last else ""
    if theirs.fields:
        mesh = theirs.fields.mesh
        words += f"{len(mesh.hexahedra)} solids, {len(mesh.points)} nodes, {theirs.frames} states. "
    return Section("What was read", words + _METHOD, [Table("Files", ["file", "bytes"], rows)])


def _forces(beside: RunComparison) -> Section:
    from strikewave.analyses.fem.ls_dyna import figures as ls_dyna

    parts: list[Part] = []
    for pair in beside.forces:
        caption = f"Size of the contact force {pair.name}: ours in a full line, LS-DYNA's dashed."
        parts += [pair_table(pair), Picture(ls_dyna.force_figure(pair), caption)]
    parts.append(contact_table(beside.ls_dyna.contacts))
    if not beside.forces and beside.ls_dyna.contacts:
        parts.append(Picture(ls_dyna.contact_figure(beside.ls_dyna.contacts), "Sizes of LS-DYNA's contact forces."))
    return Section("Contact forces", _APART if beside.forces else "", parts)


def pair_table(pair: ForcePair) -> Table:
    """Return the numbers of a contact of both."""
    rows: list[list[Cell]] = [
        [words, *(_cell(pulse, what, scale) for pulse in (pair.ls_dyna, pair.strikewave)), share(pair.difference(what))]
        for words, what, scale in (
            ("peak (kN)", "peak", 1e3), ("impulse (N s)", "impulse", 1.0), ("width (µs)", "width", 1e-6),
        )
    ]  # fmt: skip
    rows += [
        [words, *(_cell(pulse, what, 1e-6) for pulse in (pair.ls_dyna, pair.strikewave)), NONE]
        for words, what in (("peak at (µs)", "at"), ("begins (µs)", "begin"), ("ends (µs)", "end"))
    ]
    rows.append(["begins later (µs)", written(pair.shift * 1e6), NONE, NONE])
    rows.append(["angle of the impulses (deg)", written(pair.angle, 3), NONE, NONE])
    for words, found in (("as they are", pair.plain), ("begun together", pair.moved)):
        rows.append([f"M, {words}", share(found.magnitude), NONE, NONE])
        rows.append([f"P, {words}", written(found.phase, 3), NONE, NONE])
        rows.append([f"C, {words}", written(found.combined, 3), NONE, NONE])
        rows.append([f"RMS, {words}", share(found.rms).lstrip("+"), NONE, NONE])
    heads = ["", "LS-DYNA", "ours", "difference"]
    return Table(f"Contact {pair.name}: contact {pair.contact.name} of LS-DYNA, side {pair.side}", heads, rows)


def contact_table(contacts: tuple[Contact, ...]) -> Table:
    """Return what each contact of LS-DYNA came to, by side."""
    rows: list[list[Cell]] = []
    for contact in contacts:
        for side, force in sorted(contact.sides.items()):
            pulse = pulse_of(force)
            cells = [_cell(pulse, what, scale) for what, scale in _COLUMNS]
            rows.append([str(contact.number), contact.title or NONE, side, *cells])
    heads = ["number", "title", "side", "peak (kN)", "at (µs)", "impulse (N s)", "width (µs)"]
    return Table("Contacts of LS-DYNA", heads, rows, empty="No rcforc or binout with contact forces is there.")


def _cell(pulse: Pulse | None, what: str, scale: float) -> str:
    return NONE if pulse is None else written(getattr(pulse, what) / scale)


def _energies(beside: RunComparison) -> Section:
    from strikewave.analyses.fem.ls_dyna import figures as ls_dyna

    picture = Picture(ls_dyna.energy_figure(beside), "Energies: ours in full lines, LS-DYNA's dashed.")
    return Section("Energies", _BOOKS, [energy_table(beside), picture])


def energy_table(beside: RunComparison) -> Table:
    """Return the energies of both: the largest in size over time, and at the end."""
    runs = [beside.ls_dyna.energies, beside.strikewave.energies if beside.strikewave else None]
    rows: list[list[Cell]] = []
    for word in ENERGIES:
        curves = [run.energy.get(word) if run else None for run in runs]
        if any(curve is not None for curve in curves):
            most = [NONE if c is None else written(float(c[abs(c).argmax()])) for c in curves]
            last = [NONE if c is None else written(float(c[-1])) for c in curves]
            rows.append([word, *most, *last])
    heads = ["energy", "largest, LS-DYNA (J)", "largest, ours (J)", "end, LS-DYNA (J)", "end, ours (J)"]
    return Table("Energies", heads, rows, empty="No glstat or binout with energies is there.")


def _fields(beside: RunComparison) -> Section:
    words = (
        "Largest in each part at the instants of its fields; of an element with several points, their mean; stress and "
        "strain without deleted elements."
    )
    return Section("Fields", words, [field_table(beside)])


def field_table(beside: RunComparison) -> Table:
    """Return the extremes of the parts of both, pairs first."""
    theirs, ours = beside.ls_dyna.extremes, beside.strikewave.extremes if beside.strikewave else {}
    pairs: list[tuple[str | None, str | None]] = [(other, name) for name, other in beside.parts.items()]
    pairs += [(other, None) for other in theirs if other not in beside.parts.values()]
    pairs += [(None, name) for name in ours if name not in beside.parts]
    rows: list[list[Cell]] = []
    for other, name in pairs:
        both = (theirs.get(other) if other else None, ours.get(name) if name else None)
        cells = [_extreme(one, what, scale) for what, scale in _FIELDS for one in both]
        rows.append([other or NONE, name or NONE, *cells])
    units = ("displacement, {} (mm)", "von Mises, {} (MPa)", "plastic strain, {}")
    heads = [unit.format(who) for unit in units for who in ("LS-DYNA", "ours")]
    return Table("Parts", ["part of LS-DYNA", "part of ours", *heads], rows, empty="No fields are there.")


def _extreme(one: Extreme | None, what: str, scale: float) -> str:
    return NONE if one is None else written(getattr(one, what) / scale)
