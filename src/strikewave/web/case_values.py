"""What processes of the app make of a case: its quantities and sliders, its layers, the files of its results."""

from __future__ import annotations

import functools
import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.analyses.by_tables import check_case
from strikewave.base.constants import materials
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Range
from strikewave.base.result import Result
from strikewave.base.units import DIMENSIONS, parse_quantity
from strikewave.cases.case import FORM, Case, document_of, dump_case, explanations, load_case, parse_case
from strikewave.cases.files import bundled_cases
from strikewave.cases.tables.fem import FilePart
from strikewave.reporting.numbers import round_step
from strikewave.reporting.shown_result import ShownResult
from strikewave.uncertainty.draws import range_of
from strikewave.uncertainty.known import field_of, known_inputs
from strikewave.web.case_state import CaseSource, EditedField, ListedStack, StackRow


def loaded(source: CaseSource) -> Case:
    """Return the case."""
    if source.text:
        case = parse_case(source.text, source.name, source.changes)
    elif source.name in bundled_cases():
        case = load_case(source.name, source.changes)
    else:
        hint = nearest(source.name, bundled_cases())
        raise InputError("case", source.name, "a built-in case, or a file dropped here", hint)
    return _with_own_files(case, Path(source.folder))


def _with_own_files(case: Case, folder: Path) -> Case:
    """Return a case whose files are those that were dropped: a page opens no other file of the machine it runs on."""
    if case.load is not None and case.load.file:
        own = str(_own_file("load.file", case.load.file, folder))
        case = case.model_copy(update={"load": case.load.model_copy(update={"file": own})})
    if case.mesh is not None and any(isinstance(part, FilePart) for part in case.mesh.part):
        parts = tuple(
            part.model_copy(update={"file": str(_own_file("mesh.part.file", part.file, folder))})
            if isinstance(part, FilePart)
            else part
            for part in case.mesh.part
        )
        case = case.model_copy(update={"mesh": case.mesh.model_copy(update={"part": parts})})
    return case


def _own_file(path: str, name: str, folder: Path) -> Path:
    place = folder / Path(name).name
    if not place.is_file():
        raise InputError(path, name, "a file dropped here", "drop it beside the case; other files are not opened")
    return place


REACH = 2.0
"""Half widths of what is known of a field that its slider reaches to both sides: beyond what is likely, and back."""
SHARE = 0.5
"""Reach of the slider of a field of which nothing is said, as a share of its value."""
LEAST = 0.05
"""Least that a slider gives of a value above nothing, as a share: a mass or a speed of nothing is no machine."""
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
    known = {one.path: one for one in known_inputs(case)} if case.machine is not None else {}
    words = explanations("" if case.machine is None else case.machine.kind)
    fields = {}
    for path, value in case.values().items():
        field = field_of(case, path)
        allowed = range_of(case, path)
        unit = value.typed_unit
        scale = parse_quantity(f"1 {unit}", allowed.unit, path) if unit and allowed.unit in DIMENSIONS else 1.0
        one = known.get(path)
        half = max(one.high - value.si, value.si - one.low) if one is not None else 0.5 * SHARE * abs(value.si)
        low, high = _ends(value.si, REACH * half, allowed)
        step = 1.0 if allowed.unit == "count" else round_step((high - low) / scale / SLIDER_STEPS)
        what = words.get(field)
        fields[path] = EditedField(
            path=path,
            what=what.what if what else path,
            how=what.how if what else "see docs",
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


def _ends(value: float, reach: float, allowed: Range) -> tuple[float, float]:
    """Return the ends of a slider, SI: within what is allowed, and above nothing where the value is."""
    least = max(allowed.low, LEAST * value) if value > 0.0 else allowed.low
    return max(value - reach, least), min(value + reach, allowed.high)


class PageOfCases(NamedTuple):
    """A page of cases: its address, and its name."""

    place: str
    name: str


PAGES_OF = {
    "run": PageOfCases("/", "Machine"),
    "wave": PageOfCases("/target", "Target"),
    "fem": PageOfCases("/elements", "Elements"),
}
"""The page of each command that runs cases."""


def opened(source: CaseSource, program: str) -> dict[str, Any]:
    """Return what a page needs to be built: the built-in cases with their titles, and the fields of this one."""
    plain = loaded(source._replace(changes=()))
    if plain.command != program:
        page = PAGES_OF[plain.command].name if plain.command in PAGES_OF else "Fit and study"
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
    """Return the built-in cases that a command runs, with their titles.

    Examples
    --------
    >>> "li-ma-2019" in titles("run"), "togami-1996-bar" in titles("wave")
    (True, True)
    """
    cases = {name: load_case(name) for name in bundled_cases()}
    return {name: f"{name}: {case.title}" for name, case in cases.items() if case.command == program}


def values(source: CaseSource) -> dict[str, float]:
    """Return every quantity of a case, SI, by path: what a change would make of it."""
    return {path: value.si for path, value in loaded(source).values().items()}


def saved(source: CaseSource) -> str:
    """Return a case as a file, which gives the same numbers."""
    return dump_case(loaded(source))


def told(result: Result) -> dict[str, Any]:
    """Return what a page says of every result: notices, and the errors of its balances with their limits."""
    return {
        "notices": [(one.severity, one.code, one.message) for one in result.notices],
        "balance": [check.words for check in result.balance_checks],
    }


def by_full_run(result: Result) -> str:
    """Return in words that a full run is shown, and what its checks came to, and those of the runs it is made of."""
    words = [f"a full run; {result.state}", *([result.verdicts.words] if result.verdicts.words else [])]
    return "; ".join(words)


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
    """Return the layers of a bar, from the loaded face on, each with the joint behind it.

    Examples
    --------
    >>> [row.layer for row in listed_stack(CaseSource("li-ma-2019-fig13-bar", "", (), "")).rows]
    ['upper', 'sensor', 'lower']
    """
    stack = loaded(source).stack
    joints = {joint.after: joint for joint in stack.joint}
    rows = []
    for layer in stack.layer:
        size = f"{layer.length.typed}" if layer.length is not None else ""
        joint = joints.get(layer.name)
        own = [str(value.typed) for value in (layer.density, layer.modulus) if value is not None]
        words = ", ".join(filter(None, (layer.material, *own, size)))
        rows.append(StackRow(layer.name, words, joint.after if joint else "", joint.kind if joint else ""))
    return ListedStack(rows, list(materials()))


def rearranged(source: CaseSource, layers: Sequence[str], joints: Sequence[str]) -> str:
    """Return the case with its layers in another order, as a file.

    Parameters
    ----------
    source : CaseSource
    layers : sequence of str
        Names of all layers, from the loaded face on.
    joints : sequence of str
        Layer that the joint of each place behind a layer stood behind before; empty where none is.

    Raises
    ------
    InputError, InputErrors
        If that is not the layers and joints of the case, or the last layer has a joint behind it.
    """
    case = loaded(source)
    named, behind = [one.name for one in case.stack.layer], [one.after for one in case.stack.joint]
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

    Parameters
    ----------
    source : CaseSource
    behind : str
        The layer before it; empty for the loaded face.
    fields : mapping of str to str
        Fields of its table, its name among them; empty ones are left out.

    Raises
    ------
    InputError, InputErrors
        If there is no such layer, or the new one cannot be as it is said to be.
    """
    case = loaded(source)
    place = _place(case, behind) + 1 if behind else 0
    row = {key: text.strip() for key, text in fields.items() if text.strip()}
    if row.get("name") in [layer.name for layer in case.stack.layer]:
        raise InputError("stack.layer.name", row["name"], "a name that no other layer has")
    return _rewritten(case, lambda document: document["stack"]["layer"].insert(place, row))


def without_layer(source: CaseSource, name: str) -> str:
    """Return the case without a layer, as a file: the joint behind it, its taps and their sensors go with it.

    Raises
    ------
    InputError, InputErrors
        If there is no such layer, or no other.
    """
    case = loaded(source)
    place = _place(case, name)
    if len(case.stack.layer) == 1:
        raise InputError("stack.layer", name, "another layer beside it", "a bar has one at least")
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
    """Return the case with a joint behind a layer, as a file.

    Parameters
    ----------
    source : CaseSource
    behind, kind : str
        The layer before it, and what it is.
    fields : sequence of str
        Its properties, ``name = value`` each.

    Raises
    ------
    InputError, InputErrors
        If a joint stands there, or it cannot be as it is said to be.
    """
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
