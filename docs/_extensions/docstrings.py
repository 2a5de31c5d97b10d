"""Docstrings of the reference: what autodoc and napoleon would get wrong, or would show that is nobody's business."""

import re
from collections.abc import Iterator
from functools import cached_property
from itertools import takewhile
from typing import Any

from pydantic import BaseModel
from sphinx.ext.napoleon.docstring import GoogleDocstring

from strikewave import Result

PAGE = re.compile(r"\bdocs/([\w-]+)\.md\b")
NAMES = re.compile(r"^( *)(\w+(?:, \w+)+) : (.*)$")
"""The line of a section that describes several attributes at once."""


def shown_signature(app: Any, what: str, name: str, obj: Any, options: Any, arguments: str, returns: str) -> Any:
    """Return no signature of a class whose objects are got from functions, and one that can be parsed of the others."""
    if isinstance(obj, type) and issubclass(obj, BaseModel | Result):
        return "", ""
    return arguments and _readable(arguments), returns and _readable(returns)


def _readable(types: str) -> str:
    types = re.sub(r"~?TypeAliasForwardRef\('(\w+)'\)", r"\1", types.replace("<factory>", "..."))
    return re.sub(r"ndarray\[tuple\[Any, \.\.\.\], dtype\[\w+\]\]", "ndarray", types)


def mended(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Give each of several attributes an entry of its own, and let names of pages lead to them."""
    lines[:] = [PAGE.sub(r":doc:`/\1`", line) for line in _each_by_itself(lines)]


def _each_by_itself(lines: list[str]) -> Iterator[str]:
    """Yield the lines; napoleon splits `a, b : float` below Parameters, and garbles it below Attributes."""
    inside = False
    for k, line in enumerate(lines):
        if set(line.strip()) == {"-"}:
            inside = lines[k - 1].strip() == "Attributes"
        found = NAMES.match(line) if inside else None
        if found is None:
            yield line
            continue
        indent, names, kind = found.groups()
        *first, last = names.split(", ")
        inner = re.compile(rf"$|{indent} ")
        described = list(takewhile(inner.match, lines[k + 1 :]))
        for one in first:
            yield from (f"{indent}{one} : {kind}", *described)
        yield f"{indent}{last} : {kind}"


def left_out(app: Any, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Leave out what pydantic brings, and fields, which the class describes itself."""
    function = obj.fget if isinstance(obj, property) else obj.func if isinstance(obj, cached_property) else obj
    if what != "module" and not callable(function):
        return True
    return True if (getattr(function, "__module__", "") or "").startswith("pydantic") else None


def setup(app: Any) -> dict[str, bool]:
    """Listen to autodoc, before napoleon does."""
    # napoleon takes what stands before a colon in the docstring of a property for its type
    GoogleDocstring._parse_attribute_docstring = lambda self: list(self._consume_to_end())  # type: ignore[method-assign]
    app.connect("autodoc-process-signature", shown_signature)
    app.connect("autodoc-process-docstring", mended, priority=400)
    app.connect("autodoc-skip-member", left_out)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
