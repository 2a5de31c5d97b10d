"""What the engine refuses gets the name that it has in the case."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from strikewave.base.errors import InputError, InputErrors
from strikewave.fem.model import Driven, Model, Symmetry

CONTROLS = ("duration", "interval", "safety", "hourglass", "linear_viscosity", "quadratic_viscosity", "least_step")
"""Fields of [fem] that the engine calls as the case does."""


@contextlib.contextmanager
def fields_of_case(model: Model) -> Iterator[None]:
    """Raise what the engine refuses with the field of the case that it stands for.

    Examples
    --------
    >>> from strikewave.analyses.fem.build import build_model
    >>> from strikewave import load_case
    >>> with fields_of_case(build_model(load_case("two-bars-fem"))):
    ...     raise InputError("contact striker.top-bar.bottom.friction", -1, "at least 0")
    Traceback (most recent call last):
    ...
    strikewave.base.errors.InputError: fem.contact.0.friction: got -1; allowed: at least 0
    """
    try:
        yield
    except InputErrors as error:
        pairs = [line.partition(":") for line in error.lines]
        raise InputErrors(_field(name, None, model) + mark + rest for name, mark, rest in pairs) from None
    except InputError as error:
        raise error.at(_field(error.field, error.got, model)) from None


def _field(name: str, got: object, model: Model) -> str:
    """Return the path in the case of a field of the engine; what comes from the case already stays as it is."""
    if name in CONTROLS or name == "tie" or name.startswith("section."):
        return f"fem.{name}"
    if name.startswith("rigid "):
        return f"mesh.part.{name.removeprefix('rigid ')}.rigid"
    if name in ("boundary.side", "boundary.direction"):
        refusing = [k for k, b in enumerate(model.boundaries) if isinstance(b, Symmetry | Driven) and b.side == got]
        return f"fem.boundary.{refusing[-1]}.side" if refusing else f"fem.{name}"
    for engine_name, path in _tables(model):
        if name == engine_name or name.startswith(f"{engine_name}."):
            return path + name.removeprefix(engine_name)
    return name


def _tables(model: Model) -> Iterator[tuple[str, str]]:
    """Yield what the engine calls the contacts, walls and ties, with their paths, in the order of the case."""
    for k, contact in enumerate(model.contacts):
        yield f"contact {contact.name}", f"fem.contact.{k}"
        yield f"{contact.first} and {contact.second}", f"fem.contact.{k}"
    for k, wall in enumerate(model.walls):
        for kind in ("wall", "contact"):
            yield f"{kind} {wall.name}", f"fem.wall.{k}"
    for k, tie in enumerate(model.ties):
        yield f"tie of {tie.side}", f"fem.tie.{k}.side"
        yield f"{tie.side} and {tie.onto}", f"fem.tie.{k}"
