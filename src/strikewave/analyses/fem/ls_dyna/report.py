"""The report of a run of LS-DYNA, alone or compared with ours: forces, energies, fields, and their differences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.exchange.ls_dyna.folder import ENERGIES, pulse_of
from strikewave.reporting import chapters
from strikewave.reporting.numbers import headed, shown, shown_heads, with_unit
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written

if TYPE_CHECKING:
    from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
    from strikewave.exchange.ls_dyna.comparison import ForcePair, RunComparison
    from strikewave.exchange.ls_dyna.folder import ContactPulse, Extreme, LsDynaContact, LsDynaRun

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
_COLUMNS = (
    ("peak", "peak", "N", "kN"),
    ("at", "at", "s", "us"),
    ("impulse", "impulse", "N s", "N s"),
    ("pulse width at 10 %", "width", "s", "us"),
)
"""Of a contact: what it is called, its name, SI unit, and the unit in which it is shown as a rule."""
_TIMES = (("peak at", "at"), ("onset", "begin"), ("end", "end"))
_FIELDS = (
    ("displacement", "displacement", "m", "mm"),
    ("von Mises", "von_mises", "Pa", "MPa"),
    ("plastic strain", "plastic_strain", "1", "1"),
)
"""Of a part: as of a contact."""


def ls_dyna_report(result: LsDynaResult) -> str:
    """Return the report as one HTML page: no script, nothing fetched."""
    comparison = result.found
    theirs, ours = comparison.ls_dyna, comparison.strikewave
    sections = [_forces(comparison), _energies(comparison)]
    sections += [_fields(comparison)] if theirs.fields or (ours and ours.extremes) else []
    sections += [chapters.warnings(result.notices), _read(theirs)]
    summary = chapters.Summary("Report of a run of LS-DYNA", ls_dyna_words(comparison), _key_numbers(comparison))
    return chapters.result_page(result, summary, sections)


def ls_dyna_words(comparison: RunComparison) -> str:
    """Say in words what the contact came to, and how far both runs are apart: on the screen and in the report."""
    pair = _largest(comparison)
    if pair and pair.strikewave and pair.ls_dyna:
        return (
            f"Contact {pair.name}: LS-DYNA reaches {with_unit(pair.ls_dyna.peak, 'N', 'kN')}, strikewave "
            f"{with_unit(pair.strikewave.peak, 'N', 'kN')} ({share(pair.difference('peak'))}); pulse width "
            f"{share(pair.difference('width'))}, impulse {share(pair.difference('impulse'))}.{_meshed(comparison)}"
        )
    pulses = {contact.name: pulse_of(contact.first) for contact in comparison.ls_dyna.contacts}
    touched = {name: pulse for name, pulse in pulses.items() if pulse}
    if not touched:
        return "No contact force is in the folder." if not pulses else "Nothing touched."
    name, strongest = max(touched.items(), key=lambda entry: entry[1].peak)
    return f"Contact {name} of LS-DYNA reaches {with_unit(strongest.peak, 'N', 'kN')}; no run of strikewave to compare."


def _meshed(comparison: RunComparison) -> str:
    """Say that a sector is compared, where forces of whole bodies stand elsewhere."""
    of_sector = comparison.strikewave is not None and comparison.strikewave.as_meshed
    return " Forces and energies of both are those of the meshed sector, not of whole bodies." if of_sector else ""


def _key_numbers(comparison: RunComparison) -> list[tuple[str, str]]:
    pair = _largest(comparison)
    numbers = [
        ("contacts", f"{len(comparison.ls_dyna.contacts)}"),
        ("states of d3plot", f"{comparison.ls_dyna.frames}"),
    ]
    if pair and pair.strikewave and pair.ls_dyna:
        numbers = [
            ("peak, LS-DYNA", with_unit(pair.ls_dyna.peak, "N", "kN")),
            ("peak, strikewave", with_unit(pair.strikewave.peak, "N", "kN")),
            ("difference of peaks", share(pair.difference("peak"))),
            ("difference of pulse widths", share(pair.difference("width"))),
            ("difference of impulses", share(pair.difference("impulse"))),
            *numbers,
        ]
    return numbers


def _largest(comparison: RunComparison) -> ForcePair | None:
    both = [pair for pair in comparison.forces if pair.strikewave and pair.ls_dyna]
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
    text = f"From {written(shown(first, 's', 'us'))} to {with_unit(last, 's', 'us')}. " if last == last else ""
    if theirs.fields:
        mesh = theirs.fields.mesh
        text += f"{len(mesh.hexahedra)} solids, {len(mesh.points)} nodes, {theirs.frames} states. "
    return Section("What was read", text + _METHOD, [Table("Files", ["file", "bytes"], rows)])


def _forces(comparison: RunComparison) -> Section:
    from strikewave.analyses.fem.ls_dyna import figures as ls_dyna

    parts: list[Part] = []
    for pair in comparison.forces:
        caption = f"Magnitude of the contact force {pair.name}: strikewave solid, LS-DYNA dashed."
        parts.append(Picture(ls_dyna.force_figure(pair), caption))
    if not comparison.forces and comparison.ls_dyna.contacts:
        parts.append(
            Picture(ls_dyna.contact_figure(comparison.ls_dyna.contacts), "Magnitudes of the contact forces of LS-DYNA.")
        )
    parts += [pair_table(pair) for pair in comparison.forces]
    parts.append(contact_table(comparison.ls_dyna.contacts))
    return Section("Contact forces", _DIFFERENCES if comparison.forces else "", parts)


def pair_table(pair: ForcePair) -> Table:
    """Return the numbers of a contact of both."""
    both = (pair.ls_dyna, pair.strikewave)
    rows: list[list[Cell]] = [
        [headed(label, si, usual), *(_cell(one, what, si, usual) for one in both), share(pair.difference(what))]
        for label, what, si, usual in _COLUMNS
        if what != "at"
    ]
    rows += [[headed(label, "s", "us"), *(_cell(one, what, "s", "us") for one in both), NONE] for label, what in _TIMES]
    rows.append([headed("onset later by", "s", "us"), written(shown(pair.shift, "s", "us")), NONE, NONE])
    rows.append(["angle of the impulses (deg)", written(pair.angle, 3), NONE, NONE])
    for label, agreement in (("as they are", pair.plain), ("onsets aligned", pair.moved)):
        rows.append([f"M, {label}", share(agreement.magnitude), NONE, NONE])
        rows.append([f"P, {label}", written(agreement.phase, 3), NONE, NONE])
        rows.append([f"C, {label}", written(agreement.combined, 3), NONE, NONE])
        rows.append([f"RMS, {label}", share(agreement.rms).lstrip("+"), NONE, NONE])
    heads = ["", "LS-DYNA", "strikewave", "difference"]
    return Table(f"Contact {pair.name}: contact {pair.contact.name} of LS-DYNA, side {pair.side}", heads, rows)


def contact_table(contacts: tuple[LsDynaContact, ...]) -> Table:
    """Return what each contact of LS-DYNA came to, by side."""
    rows: list[list[Cell]] = []
    for contact in contacts:
        for side, force in sorted(contact.sides.items()):
            pulse = pulse_of(force)
            cells = [_cell(pulse, *column[1:]) for column in _COLUMNS]
            rows.append([str(contact.number), contact.title or NONE, side, *cells])
    heads = ["number", "title", "side", *(headed(name, si, usual) for name, _, si, usual in _COLUMNS)]
    return Table("Contacts of LS-DYNA", heads, rows, empty="No rcforc or binout with contact forces is there.")


def _cell(found: ContactPulse | Extreme | None, what: str, si: str, usual: str) -> str:
    """Return a number of a contact, or of a part, in the unit shown; a dash where there is none."""
    return NONE if found is None else written(shown(getattr(found, what), si, usual))


def _energies(comparison: RunComparison) -> Section:
    from strikewave.analyses.fem.ls_dyna import figures as ls_dyna

    picture = Picture(ls_dyna.energy_figure(comparison), "Energies: strikewave solid, LS-DYNA dashed.")
    return Section("Energies", _ENERGIES, [picture, energy_table(comparison)])


def energy_table(comparison: RunComparison) -> Table:
    """Return the energies of both: the largest in size over time, and at the end."""
    runs = [comparison.ls_dyna.energies, comparison.strikewave.energies if comparison.strikewave else None]
    rows: list[list[Cell]] = []
    for word in ENERGIES:
        curves = [run.energy.get(word) if run else None for run in runs]
        if any(curve is not None for curve in curves):
            most = [NONE if c is None else written(shown(c[abs(c).argmax()], "J", "J")) for c in curves]
            last = [NONE if c is None else written(shown(c[-1], "J", "J")) for c in curves]
            rows.append([word, *most, *last])
    heads = ("energy", "largest, LS-DYNA (J)", "largest, strikewave (J)", "end, LS-DYNA (J)", "end, strikewave (J)")
    return Table("Energies", shown_heads(*heads), rows, empty="No glstat or binout with energies is there.")


def _fields(comparison: RunComparison) -> Section:
    text = (
        "Largest in each part at the instants of its fields; of an element with several points, their mean; stress and "
        "strain without deleted elements."
    )
    return Section("Fields", text, [field_table(comparison)])


def field_table(comparison: RunComparison) -> Table:
    """Return the extremes of the parts of both, pairs first."""
    theirs, ours = comparison.ls_dyna.extremes, comparison.strikewave.extremes if comparison.strikewave else {}
    pairs: list[tuple[str | None, str | None]] = [(other, name) for name, other in comparison.parts.items()]
    pairs += [(other, None) for other in theirs if other not in comparison.parts.values()]
    pairs += [(None, name) for name in ours if name not in comparison.parts]
    rows: list[list[Cell]] = []
    for other, name in pairs:
        both = (theirs.get(other) if other else None, ours.get(name) if name else None)
        cells = [_cell(extreme, *column[1:]) for column in _FIELDS for extreme in both]
        rows.append([other or NONE, name or NONE, *cells])
    heads = [headed(f"{name}, {who}", *units) for name, _, *units in _FIELDS for who in ("LS-DYNA", "strikewave")]
    return Table("Parts", ["part in LS-DYNA", "part in strikewave", *heads], rows, empty="No fields are there.")
