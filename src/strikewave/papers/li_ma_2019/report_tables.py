"""The tables of a reproduced paper: inputs, equations, published numbers, elements, studies."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from strikewave.base.constants import material
from strikewave.base.quantities import PROVENANCES
from strikewave.base.shock_quantities import (
    ACCELERATION,
    ENERGY,
    FORCE,
    IMPULSE,
    LENGTH,
    MICROSECONDS,
    MODULUS,
    VELOCITY,
)
from strikewave.base.texts import percent
from strikewave.base.units import DIMENSIONS, convertible
from strikewave.cases.case import Case
from strikewave.fem.run import blow_measure
from strikewave.papers.li_ma_2019.body_reasons import BodyRow, Reason
from strikewave.papers.li_ma_2019.element_studies import SHARE, Answer, DimensionStudy, MeshRow
from strikewave.papers.li_ma_2019.equations import EQUAL
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, columns_of
from strikewave.reporting.numbers import headed, shown, spelled
from strikewave.reporting.parts import NONE, Cell, Code, Formula, Part, Picture, Section, Table, Tag, written

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution
    from strikewave.papers.li_ma_2019.compared_numbers import Computed, NumberRow
    from strikewave.papers.li_ma_2019.equations import EquationRow
    from strikewave.papers.li_ma_2019.findings import Finding
    from strikewave.papers.li_ma_2019.published import Consistency
    from strikewave.papers.li_ma_2019.result import Reproduction

VERDICTS = {"right": "good", "approximate": "warned", "misprint": "bad", "wrong": "bad", "definition": ""}
"""Look of the verdict on an equation."""
ANSWERS = {"right": "good", "partly": "warned", "not": "bad", "open": ""}
"""Look of the verdict of a finding."""
CLAIMS = {"right": "holds", "partly": "holds in part", "not": "does not hold", "open": "stays open"}
"""The verdicts of findings, in words."""
ORIGINS = {"measured": "measured", "simulated": "LS-DYNA", "given": "given"}
SECTIONS = {"3.1": "contact force", "3.2": "stress waves"}
MATERIALS = (("65Mn", "1, 2"), ("2A12", "1"), ("45 steel", "2"))
"""Materials of Tables 1 and 2 by their name in the package."""
_PROPERTIES = {
    "density": "density",
    "Young's modulus": "youngs_modulus",
    "Poisson's ratio": "poissons_ratio",
    "yield strength": "yield_strength",
}
"""Properties that the paper prints of a material, by the words of its published number."""
_COARSER = "set by --quick"


class Input(NamedTuple):
    """An input that several cases may share: its path, as typed, provenance, note."""

    path: str
    typed: str
    provenance: str
    note: str


def inputs_by_cases(cases: Sequence[Case]) -> dict[Input, list[str]]:
    """Return every input of cases once, with the names of the cases that have it; changed ones as by --quick."""
    cases_by_input: dict[Input, list[str]] = defaultdict(list)
    for case in cases:
        for path, value in case.values().items():
            note = _COARSER if value.provenance == "user" else value.note
            cases_by_input[Input(path, str(value.typed), value.provenance, note)].append(case.name)
    return dict(cases_by_input)


def provenance_section(cases: Sequence[Case]) -> Section:
    """Count and list the inputs of all cases by where they come from."""
    counts: list[list[Cell]] = []
    for case in cases:
        values = [str(value.provenance) for value in case.values().values()]
        counts.append([case.name, *(str(values.count(p)) for p in PROVENANCES), str(len(values))])
    inputs = inputs_by_cases(cases)
    shared = [entry.provenance for entry in inputs]
    counts.append(["all, each once", *(str(shared.count(p)) for p in PROVENANCES), str(len(shared))])
    known: list[list[Cell]] = [
        [entry.path, entry.typed, Tag(entry.provenance, entry.provenance), entry.note or NONE, ", ".join(names)]
        for provenance in ("fitted", "user", "inferred", "measured", "published")
        for entry, names in inputs.items()
        if entry.provenance == provenance
    ]
    assumed = [(entry, names) for entry, names in inputs.items() if entry.provenance == "assumed"]
    lines = [
        f"{entry.path} = {entry.typed}" + (f"   # {entry.note}" if entry.note else "") + f"   [{', '.join(names)}]"
        for entry, names in assumed
    ]
    text = (
        "The paper publishes its materials, a speed, counts of blows and results; it publishes no dimension, mass or "
        "spring of the machine, its fixtures or its elements. Each case says of every input where it comes from. A "
        "result that a case was fitted to is no evidence; the others follow from these inputs, most of which are "
        "assumed: where they leave much open, ranges are given, with the maps behind them."
    )
    parts: list[Part] = [
        Table("Inputs by provenance", ["case", *PROVENANCES, "inputs"], counts),
        Table("Inputs that are not assumed", ["input", "value", "provenance", "note", "cases"], known),
        Code("\n".join(lines), f"The {len(assumed)} assumed inputs"),
    ]
    return Section("Inputs: what it rests on", text, parts, folded=f"Show {len(inputs)} inputs with their provenance")


def materials_section(numbers: Sequence[NumberRow]) -> Section:
    """Set the materials as printed beside those of the package, with the speeds and impedances that follow."""
    printed = {row.number.name: row.number.value for row in numbers}
    first = material("65Mn").impedance
    rows: list[list[Cell]] = []
    derived: list[list[Cell]] = []
    for name, tables in MATERIALS:
        mine = material(name)
        equal = all(
            math.isclose(getattr(mine, key), printed.get(f"{name} {label}", math.nan), rel_tol=1e-12)
            for label, key in _PROPERTIES.items()
        )
        strength = NONE if mine.yield_strength is None else f"{mine.yield_strength / 1e6:g}"
        properties = [f"{mine.density:g}", f"{mine.youngs_modulus / 1e9:g}", f"{mine.poissons_ratio:g}", strength]
        same = Tag("the same", "good") if equal else Tag("differs", "bad")
        rows.append([name, f"Table {tables}", *properties, same])
        modulus, ratio = mine.youngs_modulus, mine.poissons_ratio
        bulk = math.sqrt(modulus * (1.0 - ratio) / ((1.0 + ratio) * (1.0 - 2.0 * ratio)) / mine.density)
        shear = math.sqrt(modulus / (2.0 * (1.0 + ratio)) / mine.density)
        reflected = (mine.impedance - first) / (mine.impedance + first)
        speeds = [f"{value:.1f}" for value in (mine.bar_speed, bulk, shear)]
        derived.append([mine.name, *speeds, f"{mine.impedance / 1e6:.3f}", f"{reflected:.2g}"])
    heads = ["material", "printed in", "density (kg/m³)", "E (GPa)", "Poisson's ratio", "yield (MPa)"]
    more = ["material", "c₀ = √(E/ρ) (m/s)", "speed in the bulk (m/s)", "shear speed (m/s)", "ρ c₀ (MPa s/m)"]
    more += ["F at 65Mn"]
    text = (
        "The package takes the materials as the paper prints them; the numbers stand among the published ones below. "
        "65Mn yields far higher once hardened. F is the reflection of a wave in a 65Mn bar that meets a bar of equal "
        "area, (Z − Z₁)/(Z + Z₁): for 45 steel it is so small that the paper's experiment with equal "
        "cylinders never shows the multiple reflections of its equations."
    )
    derived_words = "Speeds and impedances that follow; the bulk speed is that of plane strain"
    return Section(
        "Tables 1 and 2: materials",
        text,
        [
            Table("Materials as the package has them", [*heads, "against the printed ones"], rows),
            Table(derived_words, more, derived),
        ],
    )


def equation_sections(rows: Sequence[EquationRow]) -> list[Section]:
    """List every equation, what it says and what it gives: as printed, corrected, exact."""
    sections = []
    for place, about in SECTIONS.items():
        mine = [row for row in rows if row.section == place]
        counts = [f"{n} {verdict}" for verdict in VERDICTS if (n := sum(row.verdict == verdict for row in mine))]
        text = (
            f"{len(mine)} equations: {', '.join(counts)}. Right: it agrees within rounding. Approximate: an estimate. "
            "Misprint: the formula as printed cannot be meant. Wrong: it does not hold. Every number is computed here: "
            "by the formula as printed, by the corrected one, and by an independent exact solution, as the note says. "
            "Where no solution is independent the cell says what stands for it: a round trip gets back what was put "
            "in, an identity holds by its terms."
        )
        says = ["equation", "as printed", "corrected", "verdict", "printed is off by"]
        gives = ["number compared", "printed", "corrected", "exact", "note"]
        parts = [
            Table(f"Equations of section {place}", says, [_said(row) for row in mine]),
            Table(f"What the equations of section {place} give", gives, [_given(row) for row in mine]),
        ]
        title = f"Equations {mine[0].number} to {mine[-1].number}: {about}" if mine else f"Equations: {about}"
        sections.append(Section(title, text, parts))
    return sections


def _said(row: EquationRow) -> list[Cell]:
    off = NONE if row.deviation is None else share(row.deviation)
    if row.printed_unit and row.printed_unit != row.unit:
        off = "in another unit"
    return [
        f"{row.number} {row.what}",
        Formula(row.tex, row.formula),
        Formula(row.corrected_tex, row.corrected) if row.corrected else NONE,
        Tag(row.verdict, VERDICTS[row.verdict]),
        off,
    ]


def _given(row: EquationRow) -> list[Cell]:
    unit = f" ({spelled(row.unit)})" if row.unit not in ("", "1") else ""
    numbers = [written(value, 5) for value in (row.printed, row.corrected_value, row.exact)]
    if row.printed_unit and row.printed is not None:
        numbers[0] = f"{numbers[0]} {spelled(row.printed_unit)}"
    if row.basis != "independent" and row.exact is not None:
        numbers[2] = f"{numbers[2]}, {row.basis}"
    return [f"{row.number} {row.quantity}{unit}", *numbers, row.note or NONE]


def share(value: float) -> str:
    """Write a relative difference in per cent."""
    return "0 %" if abs(value) < EQUAL else f"{100.0 * value:+.3g} %"


def numbers_section(rows: Sequence[NumberRow], checks: Sequence[Consistency]) -> Section:
    """List every published number once, with what was computed, and what they say of each other."""
    checked: list[list[Cell]] = [
        [
            row.what,
            row.quantity,
            _with_unit(row.value, row.unit),
            NONE if row.stated is None else _with_unit(row.stated, row.unit),
            Tag("not said") if row.agrees is None else Tag("agrees", "good") if row.agrees else Tag("does not", "bad"),
            row.note,
        ]
        for row in checks
    ]
    within = ["question", "quantity", "follows", "the paper says", "result", "how it follows"]
    text = (
        "Measured numbers are those of the authors' accelerometers, LS-DYNA those of their elements, given ones what "
        "they chose or state. The paper publishes no curve in numbers, so none is compared. Where several models "
        "answer, each has its line. Fitted: a case was adjusted to the number. Predicted: it follows from "
        "other inputs. Range: inputs that are not published leave it between these ends, the note says which. "
        "Shown: the two cannot be compared, the note says why. Names of cases are without li-ma-2019-."
    )
    among = Table("Published numbers among each other", within, checked)
    stated: list[list[Cell]] = [
        [_name(row), _with_unit(row.number.value, row.number.unit, 8), row.number.note or NONE]
        for row in rows
        if not row.computed
    ]
    inputs = Table(
        "Published numbers that are inputs, materials or statements", ["published number", "published", "note"], stated
    )
    return Section("All published numbers", text, [numbers_table(rows), inputs, among])


def numbers_table(rows: Sequence[NumberRow]) -> Table:
    """List the published numbers that a model answers, each once; a line for each model."""
    lines: list[list[Cell]] = []
    for row in rows:
        number, origin = row.number, ORIGINS[row.number.origin]
        look = "measured" if origin == "measured" else ""
        begin: list[Cell] = [_name(row), _with_unit(number.value, number.unit, 8), Tag(origin, look)]
        for k, answer in enumerate(row.computed):
            value = NONE if answer.value is None else computed_text(answer, number.unit)
            off, ends = answer.difference(number.value), answer.differences(number.value)
            difference = NONE if off is None or answer.role == "shown" else share(off)
            if ends is not None:
                difference = " to ".join(share(end) for end in ends)
            by = answer.by.removeprefix("li-ma-2019-")
            note = "; ".join(filter(None, ["" if k else number.note, answer.note])) or NONE
            lines.append([*(["", "", ""] if k else begin), value, difference, Tag(answer.role, answer.role), by, note])
    heads = ["published number", "published", "origin", "computed", "difference", "role", "by", "note"]
    return Table("Published numbers and what was computed", heads, lines)


def _name(row: NumberRow) -> str:
    """Return what tells a number from all others: its name, quantity and place."""
    number = row.number
    what = "" if number.quantity.replace(":", "") == number.name else f": {number.quantity}"
    return f"{number.name}{what}, {number.where}"


def computed_text(answer: Computed, unit: str) -> str:
    """Write what was computed: a number, or both ends of a range, to three digits."""
    if answer.low is None or answer.high is None:
        return "" if answer.value is None else _with_unit(answer.value, unit)
    return span_text(answer.low, answer.high, unit)


def span_text(low: float, high: float, unit: str) -> str:
    """Write a range of SI values in a unit that the paper uses, each end to three digits."""
    conversion = convertible(unit, DIMENSIONS)
    factor = conversion[1] if conversion else 1.0
    ends = [float(f"{end / factor:.3g}") for end in (low, high)]
    return f"{ends[0]:.12g} to {ends[1]:.12g} {'' if unit == '1' else spelled(unit)}".strip()


def _with_unit(value: float, unit: str, digits: int = 5) -> str:
    """Write an SI value in a unit that the paper uses, with it."""
    conversion = convertible(unit, DIMENSIONS)
    # published numbers are shown in the units of the paper, whatever the reader chose
    text = written(value / conversion[1] if conversion else value, digits)
    return text if unit in ("", "1") else f"{text} {spelled(unit).replace('^3', '³')}"


def elements_section(solutions: Sequence[FemSolution], tables: Iterable[Part] = ()) -> Section:
    """List the cost of the finite-element runs and their balance errors, with further ``tables``."""
    rows: list[list[Cell]] = []
    for solution in solutions:
        run, balance = solution.run, solution.measured_balance
        rows.append(
            [
                solution.case.name,
                str(run.elements),
                str(run.steps),
                written(run.step * 1e9, 3),
                written(run.seconds, 3),
                share(balance.energy),
                share(balance.hourglass),
                f"{balance.momentum:.1e}",
                Tag("failed", "bad") if solution.broken else Tag("passed", "good"),
            ]
        )
    heads = ["case", "elements", "steps", "smallest step (ns)", "took (s)", "energy error", "hourglass energy"]
    empty = "The finite-element models were not run."
    table = Table("Explicit finite elements (8-node hexahedra)", [*heads, "momentum error", "checks"], rows, empty)
    text = (
        "Hexahedra of eight nodes with one point of integration, followed explicitly in time. Of its elements the "
        "paper says that they are Solid164, explicit hexahedra too. It shows its meshes in pictures and gives no "
        "dimension but the smallest element, so that shapes and sizes are assumed."
    )
    return Section("The element runs", text if rows else "", [table, *tables])


def findings_section(rows: Sequence[Finding]) -> Section:
    """Close with what the paper gets right, and what not."""
    text = (
        "Right: it holds. Partly: it holds within what the line says. Not: it does not hold. Open: what decides it is "
        "not published, or was not run."
    )
    return Section("What the paper gets right, and what not", text, [findings_table(rows)])


def claims_section(rows: Sequence[Finding], picture: Picture) -> Section:
    """Open with the claims of the paper by verdict, and the picture of how near the numbers are."""
    lines: list[list[Cell]] = []
    for answer, label in CLAIMS.items():
        topics = [row.topic for row in rows if row.verdict == answer]
        if topics:
            lines.append([Tag(label, ANSWERS[answer]), len(topics), "; ".join(topics)])
    table = Table("What the paper says, and what holds of it", ["verdict", "points", "on"], lines)
    return Section("What holds, and what does not", "", [picture, table], alone=True)


def findings_table(rows: Sequence[Finding]) -> Table:
    """List findings."""
    table: list[list[Cell]] = [
        [row.topic, row.paper, row.found, Tag(row.verdict, ANSWERS[row.verdict]), row.shown_by] for row in rows
    ]
    return Table("Findings", ["topic", "the paper says", "found", "verdict", "shown by"], table)


def plain_rows(table: Table, columns: Sequence[str]) -> list[list[str]]:
    """Return some columns of a table as text, for a terminal."""
    places = [list(table.columns).index(name) for name in columns]
    rows = [[cell if isinstance(cell, str) else cell.text for cell in row] for row in table.cells()]
    return [[row[place] for place in places] for row in rows]


def study_tables(result: Reproduction) -> Iterator[Part]:
    """Yield the tables of all studies that were made."""
    studies = result.element_studies
    if result.bodies:
        yield body_table(result.bodies)
    if studies.reasons:
        caption = "Why they part: each cause alone, on elements twice as large"
        yield page_table(caption, columns_of(Reason, studies.reasons))
    yield from (mesh_table(name, rows) for name, rows in studies.meshes.items())
    if studies.blows is not None:
        yield blow_table(studies.blows)
    yield from (dimension_table(study) for study in studies.dimensions)


def body_table(bodies: Sequence[BodyRow]) -> Table:
    """Set masses on springs and layers of a bar beside the elements, for the same bodies, with nothing fitted."""
    answers = [row.answer for row in bodies]
    columns = [
        Column("case", [row.case for row in bodies]),
        Column("model", [row.model for row in bodies]),
        Column("contact law", [row.law or None for row in bodies]),
        Column.of("peak force", [answer.peak for answer in answers], FORCE),
        Column.of("first pulse", [answer.first_width for answer in answers], MICROSECONDS),
        Column.of("first to last tenth", [answer.width for answer in answers], MICROSECONDS),
        Column("pulses", [answer.pulses for answer in answers]),
        Column.of("impulse", [answer.impulse for answer in answers], IMPULSE),
        Column.of("force over mass", [answer.rigid_peak for answer in answers], ACCELERATION),
        Column.of("sensor's peak", [answer.watched_peak for answer in answers], ACCELERATION),
    ]
    caption = "The same bodies as elements, as masses on springs, and as layers of a bar; nothing is fitted"
    return page_table(caption, columns)


def mesh_table(case: str, rows: Sequence[MeshRow]) -> Table:
    """Show how peak, width and impulse converge with the mesh."""
    caption = f"{case} on {len(rows)} meshes, sizes relative to those of the case"
    return page_table(caption, columns_of(MeshRow, rows))


def dimension_table(study: DimensionStudy) -> Table:
    """Show how each assumed dimension changes the answer."""
    base = [column.texts()[0] for column in columns_of(Answer, [study.base])]
    rows: list[list[Cell]] = [["as it stands", NONE, NONE, *base]]
    for row in study.rows:
        size = amount(LENGTH, row.value, digits=5)
        if row.path.endswith("tangent_modulus"):
            size = amount(MODULUS, row.value, digits=4)
        elif ".velocity." in row.path:
            size = amount(VELOCITY, abs(row.value))
        both = zip(row.larger.changes(study.base), row.smaller.changes(study.base), strict=True)
        changes = [
            " / ".join(NONE if math.isnan(change) else percent(change, 1, "+") for change in pair) for pair in both
        ]
        rows.append([row.name, size, Tag(row.provenance, row.provenance), *changes])
    caption = (
        f"{study.case}, coarse elements: each assumed dimension {percent(SHARE, 0)} larger / smaller, "
        "with all that follows"
    )
    return Table(caption, ["changed", "value", "it is", *(column.head for column in columns_of(Answer, []))], rows)


def blow_table(solution: FemSolution) -> Table:
    """Show how the plastic memory of the first blow changes the second."""
    rows: list[list[Cell]] = []
    for blow in solution.blows:
        measure, contact = blow_measure(blow.run, blow.model.touching), next(iter(blow.contacts))
        touched, back = blow.contacts[contact], measure.restitution[contact]
        if touched is None:
            continue
        strain = max(measure.plastic_strain.values(), default=math.nan)
        blow_answer = Answer(touched.peak, touched.duration, touched.impulse, math.nan, strain)
        *cells, _, strained = (column.texts()[0] for column in columns_of(Answer, [blow_answer]))
        restitution = NONE if back is None else f"{back:.4f}"
        work = written(shown(sum(measure.plastic_energy.values()), *ENERGY.units), 3)
        rows.append([str(measure.blow), *cells, restitution, work, strained])
    answer_heads = [column.head for column in columns_of(Answer, [])][:3]
    heads = [*answer_heads, "restitution", headed("taken by yield", *ENERGY.units), "plastic strain"]
    caption = f"{solution.case.name} struck again on the surface that the blow before left, whole bodies"
    return Table(caption, ["blow", *heads], rows)
