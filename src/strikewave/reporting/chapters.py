"""The sections of every report: set-up, inputs, blows, pulses, published numbers, warnings, checks, sources.

Each function takes a solution, whose parts may be empty or None, and returns one `Section`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from strikewave._version import __version__
from strikewave.analyses.machine.words import MACHINES, launch_tables, reference_law
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import (
    BLOW_COLUMNS,
    CONTACT_COLUMNS,
    SHOWN_UNITS,
    fixed,
    heads,
    listed,
    spelled,
    with_unit,
)
from strikewave.reporting.parts import NONE, Cell, Code, Flow, Link, Part, Picture, Section, Table, Tag, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pydantic import BaseModel

    from strikewave.analyses.machine.result import Solution
    from strikewave.cases.case import Case

_DATA_FLOW = (
    "case file",
    "checks of units and fits",
    "machine",
    "motion with every contact located in time",
    "blows",
    "pulses: peak, width, velocity change",
    "published beside computed",
)

_WAVE_FLOW = ("case file", "checks of units and fits", "stack", "stress waves", "taps and sensors")

_PROVENANCE_WORDS = {
    "published": "printed in the source that the note names",
    "measured": "read from a measurement",
    "inferred": "follows from published or measured numbers, as the note says",
    "assumed": "chosen without a source; the note may say why",
    "fitted": "adjusted until a result met a published number, as the note says",
}

_PUBLISHED_WORDS = {"first": "first blow", "typical": "later full blows, median", "count": "number of blows"}
_PUBLISHED_WORDS["window"] = "first to last blow"

_WORDS = (
    "A blow is one pass of one striker, all its re-contacts included. It is glancing when its approach speed is below "
    "half of the nominal one, double when a second group of contacts, more than a pulse width later, carries a tenth "
    "of the contact impulse, missed when the striker passed an object in place without touching it, and full "
    "otherwise. Time counts from {begun}. The rigid peak and its width, taken at 10 % of the peak, belong to "
    "the rigid-body acceleration: the momentum rate of the assembly over its mass. The velocity change is that of the "
    "object's centre of mass from first touch to last release. g is standard gravity, 9.80665 m/s²."
)


def setup(solution: Solution, moving: str = "") -> Section:
    """Say what machine it is and how the numbers come about; ``moving`` is the page that shows it in motion."""
    kind = str(getattr(getattr(solution.case, "machine", None), "kind", ""))
    words, chain = MACHINES.get(kind, (f"A machine of the kind {kind}.", ()))
    layers = _layers(solution.case)
    if not kind:
        words = "No machine: a stack of layers, loaded at its first face." if layers else "No machine is named."
    words += _strike_words(solution.case)
    parts = _drawing(solution.case)
    if moving:
        parts.append(Link(moving, "The machine in motion, with its histories: the whole run, or one blow slowed down"))
    if chain and not layers:
        parts.append(Flow(chain, "Bodies and links, in the order in which a blow runs through them"))
    if layers:
        parts.append(Flow(layers, "The stack, from its loaded face on"))
    parts.append(Flow(_DATA_FLOW if kind else _WAVE_FLOW, "From the case to this report"))
    return Section("Set-up", words, parts)


def _strike_words(case: Case) -> str:
    """Say how the nose of a striker of the rotary machine meets the face; nothing for another machine."""
    from strikewave.analyses.machine.figures.geometry import strike_geometry

    geometry = strike_geometry(case)
    if geometry is None:
        return ""
    if not geometry.blow_angle:
        return " The nose of a striker acts on the object's face like a cam."
    return f" The blow stands at {math.degrees(geometry.blow_angle):.4g}° to the radius at the strike position."


def _drawing(case: Case) -> list[Part]:
    """Return the drawing of the machine with its numbers; nothing for a machine that is not drawn."""
    from strikewave.analyses.machine.figures.drawing import drawing_words, machine_drawing

    figure = machine_drawing(case)
    if figure is None:
        return []
    words = f"The machine with its numbers, at first touch. {drawing_words(case)}"
    return [Picture(figure, words, f"Drawing of the rotary machine with a list of its parts. {drawing_words(case)}")]


def _layers(case: Case) -> list[str]:
    """Return the layers of a stack in their order, with every joint that is not bonded, and the far end."""
    stack = getattr(case, "stack", None)
    if stack is None or not stack.layer:
        return []
    joints = {joint.after: joint.kind for joint in stack.joint if joint.kind != "bonded"}
    steps = []
    for layer in stack.layer:
        steps += [layer.name] + ([f"{joints[layer.name]} joint"] if layer.name in joints else [])
    return [*steps, f"{stack.end.kind} end"]


def inputs(case: Case) -> Section:
    """List every value of the case, as typed, with provenance and note."""
    from strikewave.base.quantities import PROVENANCES, Value

    unused = "solver" if getattr(case, "command", "") == "fem" else ""
    groups = [group for group in _groups(case) if group[0] != unused]
    found = [(f"{path}.{key}", entry) for path, _, rows in groups for key, entry in rows if isinstance(entry, Value)]
    counts: list[list[Cell]] = [
        [Tag(p, p), sum(value.provenance == p for _, value in found), _PROVENANCE_WORDS.get(p, NONE)]
        for p in PROVENANCES
    ]
    fitted = [f"{path} = {value.typed}" for path, value in found if value.provenance == "fitted"]
    text = f"{len(found)} values, as they were typed; g is standard gravity. " + (
        f"Fitted: {listed(fitted)}." if fitted else "No value is fitted."
    )
    tables = [Table("Where the values come from", ["provenance", "values", "meaning"], counts)]
    for path, about, rows in groups:
        shown: list[list[Cell]] = []
        for key, entry in rows:
            if isinstance(entry, Value):
                shown.append([key, str(entry.typed), Tag(entry.provenance, entry.provenance), entry.note or NONE])
            else:
                shown.append([key, str(entry), Tag("choice"), NONE])
        tables.append(
            Table(
                f"[{path}]" + (f": {about}" if about else ""),
                ["input", "value", "provenance", "note"],
                shown,
                empty="No input.",
            )
        )
    return Section("Inputs", text, tables)


def _groups(model: BaseModel, path: str = "") -> Iterator[tuple[str, str, list[tuple[str, Any]]]]:
    """Yield path, description and entries of each table of a case; an array of tables is one table."""
    from pydantic import BaseModel

    from strikewave.base.quantities import Value

    inner: list[tuple[str, str, list[tuple[str, Any]]]] = []
    rows: list[tuple[str, Any]] = []
    for key, entry in model:
        below = f"{path}.{key}" if path else key
        if path and (isinstance(entry, Value) or not isinstance(entry, BaseModel | tuple)):
            rows.append((key, entry))
        elif isinstance(entry, BaseModel) and (path or _quantities(entry)):
            inner += _groups(entry, below)
        elif isinstance(entry, tuple) and entry and key != "published":
            inner.append((below, _about(entry[0]), list(_flat(entry, ""))))
    rows = [(key, entry) for key, entry in rows if entry is not None and entry != ""]
    if rows:
        yield path, _about(model), rows
    yield from inner


def _about(table: Any) -> str:
    """Return what the docstring of a table of a case says after its name."""
    found = re.match(r"\[[^\]]*\]+: (.*?)\.?$", (type(table).__doc__ or "").strip().partition("\n")[0])
    return found[1].replace("``", "") if found else ""


def _flat(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield all entries below a part of a case, named as their paths are."""
    from pydantic import BaseModel

    from strikewave.base.quantities import Value
    from strikewave.cases.case import row_name

    start = f"{path}." if path else ""
    if isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _flat(row, f"{start}{row_name(row, place)}")
    elif isinstance(part, BaseModel) and not isinstance(part, Value):
        for key, entry in part:
            if not (path and key in ("name", "after")):  # the path says it
                yield from _flat(entry, f"{start}{key}")
    elif part is not None and part != "":
        yield path, part


def _quantities(part: Any) -> bool:
    from strikewave.base.quantities import Value

    return any(isinstance(entry, Value) for _, entry in _flat(part, ""))


def blow_table(solution: Solution) -> Section:
    """List the blows, in the units and columns of the command line."""
    blows = solution.blows or ()
    columns = [column for column in BLOW_COLUMNS if any(hasattr(blow, column[0]) for blow in blows)]
    named = ["#", "kind", *heads(columns), "contacts"]
    rows: list[list[Cell]] = [
        [
            str(blow.index),
            Tag(blow.kind, blow.kind),
            *(fixed(getattr(blow, name, None), si, unit, decimals) for name, si, unit, decimals in columns),
            str(blow.contacts),
        ]
        for blow in blows
    ]
    table = Table("Blows", named, rows, empty="No blow: no striker passed the object.")
    reference = solution.reference
    beside = ""
    if reference is not None:
        beside = (
            f"\n\nFor comparison, {reference_law(solution.case)} on a rigid object, at the nominal "
            f"{written(reference.approach_speed, 3)} m/s and with no frame or mount to bend: "
            f"{with_unit(reference.duration, 's', 'us', 3)}, {with_unit(reference.peak_force, 'N', 'kN', 3)}, "
            f"{with_unit(reference.peak_acceleration, 'm/s^2', 'g', 3)}."
        )
    words = _WORDS.format(begun=solution.case.time_zero) if rows else ""
    return Section("Blows", words + beside, [table, *_contacts(solution)])


def _contacts(solution: Solution) -> list[Table]:
    """List the contact of each blow, where its numbers are held."""
    struck = [blow for blow in solution.blows or () if blow.kind != "missed" and hasattr(blow, "restitution")]
    rows: list[list[Cell]] = [
        [str(b.index), *(fixed(getattr(b, name), si, unit, d) for name, si, unit, d in CONTACT_COLUMNS)] for b in struck
    ]
    caption = (
        "Contact, blow by blow. The restitution is that of the contact: the square root of the work it gives back over "
        "the work it takes; the rebound speed hangs on frame and mount too. The stiffness is the slope of the contact "
        "force at the largest indentation on the way back; what stays of the indentation, and the radius of the spot "
        "over that before, change only where the case gives a yield pressure."
    )
    return [Table(caption, ["#", *heads(CONTACT_COLUMNS)], rows)] if rows else []


def pulse_pictures(solution: Solution) -> Section:
    """Draw force and acceleration of the first blow, all pulses, the train; say what is missing."""
    from strikewave.analyses.machine.figures import pulses

    held = solution.data if solution.data is not None else {}
    struck = [row for row, blow in enumerate(solution.blows or ()) if blow.kind != "missed"]
    parts: list[Part] = []
    words = [] if struck else ["No striker touched the object: there is no pulse to show."]

    def add(needs: Sequence[str], draw: Callable[[], Figure], caption: str, label: str) -> None:
        if all(name in held for name in needs):
            parts.append(Picture(draw(), caption, label))
        else:
            words.append(
                f"Without the history {listed([n for n in needs if n not in held])} there is no picture: {label}"
            )

    if struck:
        first = solution.blows[struck[0]]
        add(
            ["pulse_time", "pulse_force"],
            lambda: pulses.contact_force(solution, struck[0]),
            f"Contact force between striker and object, blow {first.index}. Each rise from zero is a contact.",
            f"Contact force over time, blow {first.index}: peak {with_unit(first.peak_force, 'N', 'kN', 3)}, "
            f"{first.contacts} contacts.",
        )
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.rigid_acceleration(solution, struck[0]),
            f"Rigid-body acceleration of the assembly, blow {first.index}"
            + ("; the marks are published peaks and widths." if _marked(solution) else "."),
            f"Rigid-body acceleration over time, blow {first.index}: peak {with_unit(first.rigid_peak, 'm/s^2', 'g')}, "
            f"width {with_unit(first.width, 's', 'us')}.",
        )
        drawn = pulses.chosen(solution)
        some = "" if len(drawn) == len(struck) else f" {len(drawn)} of {len(struck)} are drawn."
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.overlaid_pulses(solution),
            f"Rigid-body pulses of all blows over each other, each from its first touch.{some}",
            f"Rigid-body pulses of {len(drawn)} blows over each other; their peaks and widths stand in the table of "
            "blows.",
        )
    add(
        ["time", "rigid_acceleration"],
        lambda: pulses.whole_train(solution),
        "Rigid-body acceleration over the whole train"
        + ("; the marks are the peaks of the table of blows, with its numbers." if len(struck) else "."),
        f"Rigid-body acceleration over the whole train: {len(struck)} blows.",
    )
    return Section("Pulses", "\n\n".join(words), parts)


def _marked(solution: Solution) -> bool:
    peaks = any(entry.quantity == "first.rigid_peak" for entry in solution.published or ())
    return peaks and not solution.case.changed_fields()


def published(solution: Solution) -> Section:
    """Set published numbers beside computed ones."""
    from strikewave.cases.case import PUBLISHED_QUANTITIES

    rows: list[list[Cell]] = []
    for entry in solution.published or ():
        si = PUBLISHED_QUANTITIES.get(entry.quantity, "")
        unit = SHOWN_UNITS.get(si, si)
        which, _, quantity = entry.quantity.partition(".")
        words = _PUBLISHED_WORDS.get(which, which) + (f": {quantity.replace('_', ' ')}" if quantity else "")
        words += f" of {entry.sensor}" if getattr(entry, "sensor", "") else ""
        values = [
            NONE if v is None or math.isnan(v) else written(float(in_unit(v, si, unit)) if si else v, 6)
            for v in (entry.published, entry.computed)
        ]
        difference = NONE if entry.difference is None else f"{100.0 * entry.difference:+.1f} %"
        unit = f" ({spelled(unit)})" if unit else ""
        rows.append(
            [words + unit, *values, difference, entry.measured_or_simulated, Tag(entry.role, entry.role), entry.note]
        )
    heads = ["quantity", "published", "computed", "difference", "origin", "role", "note"]
    table = Table("Published beside computed", heads, rows, empty="The case names no published number.")
    text = (
        "A fitted number is no evidence: the case was adjusted to it. A predicted one is. One that is only shown "
        "cannot be compared; its note says why."
    )
    return Section("Published beside computed", text if rows else "", [table])


def warnings(solution: Solution) -> Section:
    """List what the user should know, with the number that raised it and its limit."""
    rows: list[list[Cell]] = [
        [
            Tag(notice.code, "bad" if notice.broken else "warned"),
            notice.message,
            f"{notice.value:.6g}",
            f"{notice.limit:.6g}",
            Tag("limit broken", "bad") if notice.broken else Tag("to know"),
        ]
        for notice in solution.warnings or ()
    ]
    heads = ["code", "message", "number", "limit", "weight"]
    table = Table("Warnings; number and limit in SI units", heads, rows, empty="No warning was raised.")
    return Section("Warnings", "", [table])


def checks(solution: Solution) -> Section:
    """List ledgers, masses and phases."""
    from strikewave.base.result import LEDGER_LIMIT

    ledger: list[list[Cell]] = [
        [
            name.removesuffix("_error"),
            f"{error:.1e}",
            f"{LEDGER_LIMIT:.0e}",
            Tag("closes", "good") if error <= LEDGER_LIMIT else Tag("broken", "bad"),
        ]
        for name, error in (solution.ledger or {}).items()
    ]
    masses: list[list[Cell]] = [[name, mass] for name, mass in (solution.masses or {}).items()]
    phases: list[list[Cell]] = [[name, f"{time:.6f}"] for name, time in solution.phases or ()]
    begun = solution.case.time_zero
    heads = ["ledger", "error, share", "limit", "result"]
    kept = Table("Ledgers", heads, ledger, empty="No ledger was kept.")
    if solution.case.machine is None and not masses and not phases:
        words = "Momentum: impulses at both ends less the momentum of the stack, over the greater impulse."
        return Section("Ledger", words, [kept])
    return Section(
        "Ledgers, masses and phases",
        "Energy: what the ledger of work and losses misses, over the energy that flowed. Momentum: impulse of all "
        "forces less change of momentum, over the contact impulse; the worst blow.",
        [
            kept,
            Table("Masses", ["body", "mass (kg)"], masses, empty="No mass is listed."),
            *launch_tables(solution),
            Table(f"Phases, from {begun}", ["phase", "begins (s)"], phases, empty="No phase is listed."),
        ],
    )


def sources(solution: Solution) -> Section:
    """List the sources of the models used."""
    from strikewave.base.citations import SOURCES

    rows: list[list[Cell]] = [[key, SOURCES.get(key, NONE)] for key in solution.citations or ()]
    table = Table("Sources of the models used", ["key", "source"], rows, empty="No source is named.")
    return Section("Sources", "", [table])


def reproduction(case: Case, text: str, digest: str) -> Section:
    """Say how the same numbers come again, with the whole case file."""
    same = _is_published(case, text)
    command = "run" if getattr(case, "machine", None) is not None else "wave"
    commands = (f"strikewave {command} {case.name}\n" if same else "") + f"strikewave {command} case.toml"
    either = "Either of these commands" if same else "This command"
    words = (
        f"{either} gives the same numbers again with strikewave {__version__}; case.toml is the text below, which also "
        f"lies beside this report. The text has the SHA-256 {digest}."
    )
    return Section("How to run this again", words, [Code(commands), Code(text, "The whole case file, case.toml")])


def _is_published(case: Case, text: str) -> bool:
    """Tell whether a case is a published one without any change."""
    from strikewave.cases.case import bundled_cases, load_case

    return case.name in bundled_cases() and case_text(load_case(case.name)) == text


def case_text(case: Case) -> str:
    """Return the case as the text of a case file."""
    from strikewave.cases.case import dump_case

    return dump_case(case)
