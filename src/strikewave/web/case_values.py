"""A case in a process of the app: its quantities and sliders, its layers, the files of its results."""

from __future__ import annotations

import functools
import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from strikewave.analyses.by_tables import check_case
from strikewave.base.constants import materials
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import Result
from strikewave.base.units import DIMENSIONS, parse_quantity
from strikewave.cases.case import FORM, Case, document_of, dump_case, explanations, load_case, parse_case
from strikewave.cases.files import bundled_cases
from strikewave.cases.tables.fem import FilePart
from strikewave.reporting.numbers import round_step
from strikewave.reporting.shown_result import ShownResult
from strikewave.uncertainty.draws import range_of
from strikewave.uncertainty.input_ranges import field_of, known_inputs
from strikewave.web.case_state import CaseSource, EditedField, ListedStack, StackRow


def loaded(source: CaseSource) -> Case:
    """Return the case; its files are dropped ones, for a page opens no other file of the machine it runs on."""
    if source.text:
        case = parse_case(source.text, source.name, source.changes)
    elif source.name in bundled_cases():
        case = load_case(source.name, source.changes)
    else:
        hint = nearest(source.name, bundled_cases())
        raise InputError("case", source.name, "a built-in case, or a file dropped here", hint)

    def dropped(path: str, name: str) -> str:
        place = Path(source.folder) / Path(name).name
        if not place.is_file():
            raise InputError(path, name, "a file dropped here", "drop it beside the case; other files are not opened")
        return str(place)

    tables: dict[str, Any] = {}
    if case.load is not None and case.load.file:
        tables["load"] = case.load.model_copy(update={"file": dropped("load.file", case.load.file)})
    if case.mesh is not None and any(isinstance(part, FilePart) for part in case.mesh.part):
        parts = tuple(
            part.model_copy(update={"file": dropped("mesh.part.file", part.file)})
            if isinstance(part, FilePart)
            else part
            for part in case.mesh.part
        )
        tables["mesh"] = case.mesh.model_copy(update={"part": parts})
    return case.model_copy(update=tables) if tables else case


REACH = 2.0
"""Reach of a slider to both sides, in half widths of the known range of its field: beyond the likely, and back."""
SHARE = 0.5
"""Reach of the slider of a field without a known range, as a share of its value. Chosen."""
LEAST = 0.05
"""Least value of a slider as a share of a value above 0: a machine without mass or speed is none."""
SLIDER_STEPS = 200
"""Places of a slider: as many as a hand can tell apart on it."""


def edited_fields(case: Case) -> dict[str, EditedField]:
    """Return all quantities of a case by path, with the ranges of their sliders.

    Examples
    --------
    >>> from strikewave import load_case
    >>> speed = edited_fields(load_case("li-ma-2019"))["machine.speed"]
    >>> speed.label, speed.low < 730.0 < speed.high
    ('machine speed (rpm)', True)
    """
    known = {entry.path: entry for entry in known_inputs(case)} if case.machine is not None else {}
    meanings = explanations("" if case.machine is None else case.machine.kind)
    fields = {}
    for path, value in case.values().items():
        allowed = range_of(case, path)
        unit = value.typed_unit
        scale = parse_quantity(f"1 {unit}", allowed.unit, path) if unit and allowed.unit in DIMENSIONS else 1.0
        entry = known.get(path)
        half = 0.5 * SHARE * abs(value.si)
        if entry is not None:
            half = max(entry.high - value.si, value.si - entry.low)
        # a machine without mass, speed or stiffness is none, so that 0 is no end
        least = max(allowed.low, LEAST * value.si) if value.si > 0.0 else allowed.low
        low, high = max(value.si - REACH * half, least), min(value.si + REACH * half, allowed.high)
        step = 1.0 if allowed.unit == "count" else round_step((high - low) / scale / SLIDER_STEPS)
        meaning = meanings.get(field_of(case, path))
        fields[path] = EditedField(
            path=path,
            what=meaning.what if meaning else path,
            how=meaning.how if meaning else "see docs",
            typed=str(value.typed),
            unit=unit,
            value=value.si / scale,
            low=math.ceil(low / scale / step) * step,
            high=math.floor(high / scale / step) * step,
            step=step,
            provenance=value.provenance,
            scale=scale,
        )
    return fields


PAGES_OF = {"run": ("/", "Machine"), "wave": ("/target", "Target"), "fem": ("/elements", "Elements")}
"""Address and name of the page of each command that runs cases."""


def opened(source: CaseSource, program: str) -> dict[str, Any]:
    """Return the content of a new page: the built-in cases with their titles, and the fields of this one."""
    plain = loaded(source._replace(changes=()))
    if plain.command != program:
        _, page = PAGES_OF.get(plain.command, ("", "Fit and study"))
        raise InputError(
            "case", source.name, f"a case that `strikewave {program}` runs", f"the page {page} shows this one"
        )
    return {
        "titles": titles(program),
        "fields": edited_fields(plain),
        "values": values(source),
        "stack": listed_stack(source) if program == "wave" else None,
    }


@functools.cache
def titles(program: str) -> dict[str, str]:
    """Return the built-in cases that a command runs, with their titles."""
    cases = {name: load_case(name) for name in bundled_cases()}
    return {name: f"{name}: {case.title}" for name, case in cases.items() if case.command == program}


def values(source: CaseSource) -> dict[str, float]:
    """Return every quantity of a changed case, SI, by path."""
    return {path: value.si for path, value in loaded(source).values().items()}


def saved(source: CaseSource) -> str:
    """Return a case as a file with the same numbers."""
    return dump_case(loaded(source))


def notices_and_balance(result: Result) -> dict[str, Any]:
    """Return the notices of a result, and the errors of its balances with their limits."""
    return {
        "notices": [(notice.severity, notice.code, notice.message) for notice in result.notices],
        "balance": [check.words for check in result.balance_checks],
    }


def full_run_label(result: Result) -> str:
    """Return the state of a full run, with the verdicts of the runs that it is made of."""
    return "; ".join(filter(None, (f"a full run; {result.state}", result.verdicts.words)))


def result_file(result: ShownResult, wanted: str) -> bytes:
    """Return a file of a result: its report, as HTML or PDF, or its histories."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / wanted
        if wanted.endswith(".nc"):
            result.datasets()[wanted].write(place)
            return place.read_bytes()
        page = result.report(Path(folder) / "report.html").read_text("utf-8")
    if wanted != "report.pdf":
        return page.encode()
    from strikewave.reporting.pdf import check_pdf, pdf_of

    check_pdf("report.pdf", "PDF")
    return pdf_of(page, "A4")


Document = dict[str, Any]


def listed_stack(source: CaseSource) -> ListedStack:
    """Return the layers of a bar, from the loaded face on, each with the joint behind it."""
    stack = loaded(source).stack
    joints = {joint.after: joint for joint in stack.joint}
    rows = []
    for layer in stack.layer:
        size = f"{layer.length.typed}" if layer.length is not None else ""
        joint = joints.get(layer.name)
        own = [str(value.typed) for value in (layer.density, layer.modulus) if value is not None]
        label = ", ".join(filter(None, (layer.material, *own, size)))
        rows.append(StackRow(layer.name, label, joint.after if joint else "", joint.kind if joint else ""))
    return ListedStack(rows, list(materials()))


def rearranged(source: CaseSource, layers: Sequence[str], joints: Sequence[str]) -> str:
    """Return the case with its layers in another order, as a file.

    ``layers`` are the names of all layers from the loaded face on; ``joints`` has for each place behind a layer the
    layer that its joint stood behind before, empty where there is none.
    """
    case = loaded(source)
    named, behind = [layer.name for layer in case.stack.layer], [joint.after for joint in case.stack.joint]
    if sorted(layers) != sorted(named) or sorted(filter(None, joints)) != sorted(behind) or len(joints) != len(layers):
        raise InputError("stack", ", ".join(layers), f"each of {', '.join(named)} once, with the joints behind them")

    def arrange(document: Document) -> None:
        stack = document["stack"]
        stack["layer"].sort(key=lambda row: layers.index(row["name"]))
        moved = {row["after"]: row for row in stack.get("joint", ())}
        stack["joint"] = [moved[joint] | {"after": layer} for layer, joint in zip(layers, joints, strict=True) if joint]

    return _rewritten(case, arrange)


def with_layer(source: CaseSource, behind: str, fields: Mapping[str, str]) -> str:
    """Return the case with one more layer, as a file; a joint behind its neighbour stays between the two.

    ``behind`` is the layer before it, empty for the loaded face; empty ``fields`` of its table are left out.
    """
    case = loaded(source)
    place = _place(case, behind) + 1 if behind else 0
    row = {key: text.strip() for key, text in fields.items() if text.strip()}
    if row.get("name") in [layer.name for layer in case.stack.layer]:
        raise InputError("stack.layer.name", row["name"], "a name that no other layer has")
    return _rewritten(case, lambda document: document["stack"]["layer"].insert(place, row))


def without_layer(source: CaseSource, name: str) -> str:
    """Return the case without a layer, as a file: the joint behind it, its taps and their sensors go with it."""
    case = loaded(source)
    place = _place(case, name)
    if len(case.stack.layer) == 1:
        raise InputError("stack.layer", name, "another layer beside it", "a bar has one at least")
    # a sensor on a tap that is gone would refuse the case
    gone = {tap.name for tap in case.tap if tap.layer == name}
    ends = {name, case.stack.layer[place - 1].name} if place == len(case.stack.layer) - 1 else {name}

    def take(document: Document) -> None:
        del document["stack"]["layer"][place]
        joints = document["stack"].get("joint", ())
        document["stack"]["joint"] = [row for row in joints if row["after"] not in ends]
        document["tap"] = [row for row in document.get("tap", ()) if row["name"] not in gone]
        document["sensor"] = [row for row in document.get("sensor", ()) if row.get("tap") not in gone]

    return _rewritten(case, take)


def with_joint(source: CaseSource, behind: str, kind: str, fields: Sequence[str]) -> str:
    """Return the case with a joint behind a layer, as a file; each of ``fields`` is ``name = value``."""
    case = loaded(source)
    _place(case, behind)
    if behind in [joint.after for joint in case.stack.joint]:
        raise InputError("stack.joint.after", behind, "a layer without a joint behind it", "remove that first")

    def add(document: Document) -> None:
        document["stack"].setdefault("joint", []).append({"after": behind, "kind": kind})
        for field in filter(str.strip, fields):
            FORM.change(document, f"stack.joint.{behind}.{field.strip()}")

    return _rewritten(case, add)


def without_joint(source: CaseSource, behind: str) -> str:
    """Return the case with bonded faces behind a layer, as a file."""
    case = loaded(source)
    _place(case, behind)

    def take(document: Document) -> None:
        document["stack"]["joint"] = [row for row in document["stack"].get("joint", ()) if row["after"] != behind]

    return _rewritten(case, take)


def _place(case: Case, name: str) -> int:
    """Return the place of a layer."""
    names = [layer.name for layer in case.stack.layer]
    if name not in names:
        raise InputError("stack.layer", name, "a layer of this bar", nearest(name, names))
    return names.index(name)


def _rewritten(case: Case, change: Callable[[Document], None]) -> str:
    """Return a case as a file after a change of its tables that still fits together."""
    import tomlkit

    document = document_of(case)
    change(document)
    changed = parse_case(tomlkit.dumps(document), case.name)
    check_case(changed)
    return dump_case(changed)
