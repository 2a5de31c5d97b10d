"""Layers and joints of a bar put in another order, added and removed; it runs in processes of the app."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from strikewave.analyses.check import check
from strikewave.base.errors import InputError, nearest
from strikewave.base.materials import materials
from strikewave.cases.case import FORM, Case, parse_case
from strikewave.cases.written_case import document_of, dump_case
from strikewave.web.case.loading import loaded
from strikewave.web.case.stack_row import ListedStack, StackRow
from strikewave.web.case.state import CaseSource

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
        Of each place behind a layer, the layer that its joint stood behind before; empty where none is.

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
        Of its table, its name among them; what is empty is left out.

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
    """Return the case with bonded faces behind a layer, as a file.

    Raises
    ------
    InputError
        If there is no such layer.
    """
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
    check(changed)
    return dump_case(changed)
