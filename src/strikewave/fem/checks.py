"""What is wrong with a model, as far as its own names and numbers tell before anything is built; SI."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem.model import Controls, Driven, Guided, Model, Pressure, TimeCurve

MOST_BLOWS = 20
"""Blows of a run: yield has come to an end after a few, and each takes its own files and up to 4.5 times its steps."""
MOST_HOURGLASS = 0.5
"""Largest coefficient of the hourglass stiffness: three times the 0.17 at which a cube bends exactly."""


def faults(model: Model) -> Iterator[InputError]:
    """Yield what cannot be run.

    Examples
    --------
    >>> from strikewave.fem.mesh import Mesh
    >>> nothing = Mesh(np.zeros((0, 3)), np.zeros((0, 8), np.int32), np.zeros(0, np.int32), ())
    >>> [str(fault) for fault in faults(Model(nothing, {}, Controls(1e-3, safety=1.5)))]
    ['safety: got 1.5; allowed: above 0 to 1']
    """
    yield from control_faults(model.controls)
    yield from _parts(model)
    yield from _repeated(model)
    yield from _vectors(model)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _curve(f"velocity of {boundary.side}", boundary.velocity)
        elif isinstance(boundary, Pressure):
            yield from _curve(f"pressure on {boundary.side}", boundary.pressure)


def control_faults(c: Controls) -> Iterator[InputError]:
    """Yield what is wrong with the controls alone.

    Examples
    --------
    >>> [str(fault) for fault in control_faults(Controls(1e-3, hourglass=0.6))]
    ['hourglass: got 0.6; allowed: from 0 to 0.5']
    """
    rows = [
        ("duration", 0.0 < c.duration < np.inf, "above 0"),
        ("interval", 0.0 < c.interval <= c.duration, "above 0, at most the duration"),
        ("safety", 0.0 < c.safety <= 1.0, "above 0 to 1"),
        ("hourglass", 0.0 <= c.hourglass <= MOST_HOURGLASS, f"from 0 to {MOST_HOURGLASS:g}"),
        ("linear_viscosity", 0.0 <= c.linear_viscosity < np.inf, "at least 0"),
        ("quadratic_viscosity", 0.0 <= c.quadratic_viscosity < np.inf, "at least 0"),
        ("least_step", 0.0 <= c.least_step < np.inf, "at least 0"),
        ("threads", c.threads >= 1, "at least 1"),
        ("blows", 1 <= c.blows <= MOST_BLOWS, f"a whole number from 1 to {MOST_BLOWS}"),
    ]
    yield from (InputError(name, getattr(c, name), allowed) for name, good, allowed in rows if not good)


def _parts(model: Model) -> Iterator[InputError]:
    parts = model.mesh.names
    for name in parts:
        if name not in model.solids:
            yield InputError(f"part {name}", "no solid", "a solid for each part")
    named: list[tuple[str, Iterable[str]]] = [
        ("velocity", model.velocity),
        ("full", model.controls.full),
        ("rigid", (each.part for each in model.rigid)),
        *((f"point {each.name}", (each.part,)) for each in model.points),
        *((f"section {each.name}", (each.part,)) for each in model.sections),
        *((f"group {name}", group) for name, group in model.groups.items()),
    ]
    for key, names in named:
        for name in names:
            if name not in parts:
                yield InputError(key, name, "a part of the mesh: " + ", ".join(parts))


def _repeated(model: Model) -> Iterator[InputError]:
    """Yield names that stand for two things, of which a run would tell one."""
    named = [
        ("contact", [each.name for each in model.contacts], ""),
        ("wall", [each.name for each in model.walls], "stand the second wall before another side, such as part.all"),
        ("rigid", [each.part for each in model.rigid], ""),
        ("point", [each.name for each in model.points], ""),
        ("section", [each.name for each in model.sections], ""),
    ]
    for key, names, hint in named:
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield InputError(key, f"{name} twice", "each only once", hint)


def _vectors(model: Model) -> Iterator[InputError]:
    rows = [
        ("gravity", model.gravity),
        *((f"velocity of {name}", vector) for name, vector in model.velocity.items()),
        *((f"{what} of {w.name}", getattr(w, what)) for w in model.walls for what in ("point", "normal")),
        *((f"{what} of section {s.name}", getattr(s, what)) for s in model.sections for what in ("point", "normal")),
        *((f"place of point {p.name}", p.place) for p in model.points),
        *((f"direction of {b.side}", b.direction) for b in model.boundaries if isinstance(b, Driven)),
        *((f"axis of {b.side}", b.axis) for b in model.boundaries if isinstance(b, Guided)),
    ]
    for key, vector in rows:
        if len(vector) != 3 or not np.all(np.isfinite(vector)):
            yield InputError(key, vector, "three finite numbers")


def _curve(field: str, curve: TimeCurve) -> Iterator[InputError]:
    if not curve.time or len(curve.time) != len(curve.value):
        yield InputError(field, f"{len(curve.time)} times, {len(curve.value)} values", "as many of both, at least one")
    elif not np.all(np.isfinite([curve.time, curve.value])):
        yield InputError(field, "a number that is not finite", "finite times and values")
    for before, after in itertools.pairwise(curve.time):
        if before >= after:
            yield InputError(field, f"{after:g} s after {before:g} s", "times that ascend")
            return
