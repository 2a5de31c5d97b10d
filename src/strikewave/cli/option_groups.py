"""Groups of options: a dataclass in the signature of a command stands for its fields, each an option of its own."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any, get_args, get_origin, get_type_hints


def spread(command: Callable[..., int]) -> Callable[..., int]:
    """Return a command whose groups are spread into their options, in their place; called, it puts them together again.

    Parameters
    ----------
    command : callable
        A parameter annotated with a dataclass is a group; the fields of the dataclass are annotated as parameters of a
        command are, and have defaults where not required. Its ``panel``, a class variable, heads them in the help. The
        command runs in the context that its method ``in_force`` returns, if it has one.

    Raises
    ------
    ValueError
        If two options have one name.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Output:
    ...     out: str | None = None
    ...     json: bool = False
    >>> def command(file: str, output: Output) -> int:
    ...     return len(file) + output.json
    >>> list(inspect.signature(spread(command)).parameters)
    ['file', 'out', 'json']
    >>> spread(command)(file="a.csv", out=None, json=True)
    6
    """
    hints = get_type_hints(command, include_extras=True)
    groups = {name: hint for name, hint in hints.items() if dataclasses.is_dataclass(hint) and isinstance(hint, type)}
    options = [
        option
        for one in inspect.signature(command).parameters.values()
        for option in (_options(groups[one.name]) if one.name in groups else [one.replace(annotation=hints[one.name])])
    ]

    @functools.wraps(command)
    def gathered(**values: Any) -> int:
        with contextlib.ExitStack() as stack:
            for name, group in groups.items():
                values[name] = group(**{field.name: values.pop(field.name) for field in dataclasses.fields(group)})
                if hasattr(values[name], "in_force"):
                    stack.enter_context(values[name].in_force())
            return command(**values)

    keyword_only = [option.replace(kind=inspect.Parameter.KEYWORD_ONLY) for option in options]
    gathered.__dict__["__signature__"] = inspect.Signature(keyword_only)
    gathered.__annotations__ = {option.name: option.annotation for option in options}
    return gathered


def _options(group: type) -> list[inspect.Parameter]:
    """Return the fields of a group as parameters."""
    hints = get_type_hints(group, include_extras=True)
    panel: str | None = getattr(group, "panel", None)
    return [
        one.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=_under(panel, hints[name]))
        for name, one in inspect.signature(group).parameters.items()
    ]


def _under(panel: str | None, annotation: Any) -> Any:
    """Return the annotation of an option whose help stands in a panel."""
    if panel is None or get_origin(annotation) is not Annotated:
        return annotation
    kind, option = get_args(annotation)
    placed = copy.copy(option)
    placed.rich_help_panel = panel
    return Annotated[kind, placed]
