"""What stands in a part of a case, by its path, and the part with other quantities in their places."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from strikewave.base.quantities import Value
from strikewave.cases.paths import row_name


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


def with_tree(part: Any, tree: Value | dict[str, Any]) -> Any:
    """Return a part of a case with some quantities replaced, which stand in a tree of the keys of their paths."""
    if isinstance(tree, Value):
        return tree
    if isinstance(part, tuple):
        names = [row_name(row, place) for place, row in enumerate(part)]
        return tuple(with_tree(row, tree[name]) if name in tree else row for name, row in zip(names, part, strict=True))
    return part.model_copy(update={key: with_tree(getattr(part, key), branch) for key, branch in tree.items()})
