"""Layers and joints of a bar in another order; it runs in processes of the app."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.base.errors import InputError
from strikewave.cases.case import dump_case, parse_case
from strikewave.web.case.loading import loaded
from strikewave.web.case.stack_row import StackRow
from strikewave.web.case.state import CaseSource


def stack_rows(source: CaseSource) -> list[StackRow]:
    """Return the layers of a bar, from the loaded face on, each with the joint behind it.

    Examples
    --------
    >>> [row.layer for row in stack_rows(CaseSource("li-ma-2019-fig13-bar", "", (), ""))]
    ['upper', 'sensor', 'lower']
    """
    stack = loaded(source).stack
    joints = {joint.after: joint for joint in stack.joint}
    rows = []
    for layer in stack.layer:
        size = f"{layer.length.typed}" if layer.length is not None else ""
        joint = joints.get(layer.name)
        words = ", ".join(filter(None, (layer.material, size)))
        rows.append(StackRow(layer.name, words, joint.after if joint else "", joint.kind if joint else ""))
    return rows


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
    InputError
        If that is not the layers and joints of the case, or the last layer has a joint behind it.
    """
    case = loaded(source)
    named, behind = {one.name: one for one in case.stack.layer}, {one.after: one for one in case.stack.joint}
    if sorted(layers) != sorted(named) or sorted(filter(None, joints)) != sorted(behind) or len(joints) != len(layers):
        raise InputError("stack", ", ".join(layers), f"each of {', '.join(named)} once, with the joints behind them")
    moved = tuple(
        behind[joint].model_copy(update={"after": layer}) for layer, joint in zip(layers, joints, strict=True) if joint
    )
    stack = case.stack.model_copy(update={"layer": tuple(named[name] for name in layers), "joint": moved})
    text = dump_case(case.model_copy(update={"stack": stack}))
    parse_case(text, case.name)  # refuses what does not fit together
    return text
