"""What stands in a part of a case, by its path, and the part with other quantities in their places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeVar, cast

from pydantic import BaseModel

from strikewave.base.quantities import Value
from strikewave.cases.paths import row_name

T = TypeVar("T")


def quantities_of(part: Any, path: str) -> Iterator[tuple[str, Value]]:
    """Yield every quantity below a part of a case with its path."""
    return ((place, leaf) for place, leaf in _leaves(part, path) if isinstance(leaf, Value))


def entries_of(part: Any, path: str) -> Iterator[tuple[str, float | str]]:
    """Yield every quantity, in SI, and every word below a part of a case with its path."""
    for place, leaf in _leaves(part, path):
        if isinstance(leaf, Value):
            yield place, leaf.si
        elif isinstance(leaf, str) and leaf:
            yield place, leaf


def _leaves(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield what stands in a part of a case, below its tables and rows, with its path."""
    if isinstance(part, BaseModel) and not isinstance(part, Value):
        for key, value in part:
            yield from _leaves(value, f"{path}.{key}")
    elif isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _leaves(row, f"{path}.{row_name(row, place)}")
    else:
        yield path, part


def with_quantities(part: T, values: Mapping[str, Value]) -> T:
    """Return a part of a case with quantities at paths below it, also such as it leaves out; none is checked.

    Examples
    --------
    >>> from strikewave import load_case
    >>> dense = Value(si=8e3, typed="8000 kg/m^3")
    >>> changed = with_quantities(load_case("li-ma-2019-fig13"), {"stack.layer.nose.density": dense})
    >>> changed.stack.layer[0].density.si
    8000.0
    """
    tree = dict[str, Any]()
    for path, value in values.items():
        *places, key = path.split(".")
        branch = tree
        for place in places:
            branch = branch.setdefault(place, {})
        branch[key] = value
    return cast(T, _with_tree(part, tree))


def _with_tree(part: Any, tree: Value | dict[str, Any]) -> Any:
    """Return a part of a case with some quantities replaced, which stand in a tree of the keys of their paths."""
    if isinstance(tree, Value):
        return tree
    if isinstance(part, tuple):
        names = [row_name(row, place) for place, row in enumerate(part)]
        return tuple(
            _with_tree(row, tree[name]) if name in tree else row for name, row in zip(names, part, strict=True)
        )
    return part.model_copy(update={key: _with_tree(getattr(part, key), branch) for key, branch in tree.items()})
