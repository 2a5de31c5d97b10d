"""The state of a run on disk, to go on from: HDF5, written beside the old one and renamed."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.errors import InputError
from strikewave.fem.engine import Engine

LARGEST = 40_000_000_000
"""Bytes of a restart file at most."""
NUMBERS = ("time", "instant", "steps", "behind", "ahead", "critical", "smallest")
ARRAYS = ("x", "v", "f", "given")
BODY = ("centre", "velocity", "spin", "turned")


def state_of(engine: Engine) -> dict[str, np.ndarray]:
    """Return everything that changes in a run, by name, as it is before the forces of an instant are found."""
    found: dict[str, Any] = {name: getattr(engine, name) for name in (*NUMBERS, *ARRAYS)}
    for k, elements in enumerate(engine.solid.kinds):
        found |= {f"elements/{k}/state": elements.blocks.state, f"elements/{k}/sums": elements.sums}
    found |= {f"done/{name}": value for name, value in engine.done.items()}
    found |= {f"impulse/{name}": value for name, value in engine.impulse.items()}
    for kind, touching in (("contact", engine.contacts), ("wall", engine.walls)):
        for name, state in touching.items():
            found |= {f"{kind}/{name}/{path}": value for path, value in _leaves(state)}
    for k, body in enumerate(engine.bodies):
        found |= {f"body/{k}/{name}": getattr(body, name) for name in BODY}
    found |= {f"row/{name}": np.array(column) for name, column in engine.recorder.rows.items()}
    return {name: np.asarray(value) for name, value in found.items()}


def put_back(engine: Engine, found: Mapping[str, np.ndarray]) -> None:
    """Bring an engine of the same model to a state."""
    for name in NUMBERS:
        setattr(engine, name, type(getattr(engine, name))(found[name]))
    for name in ARRAYS:
        getattr(engine, name)[:] = found[name]
    for k, elements in enumerate(engine.solid.kinds):
        elements.blocks.state[:], elements.sums[:] = found[f"elements/{k}/state"], found[f"elements/{k}/sums"]
    engine.done = {name: float(found[f"done/{name}"]) for name in engine.done}
    engine.impulse = {name: found[f"impulse/{name}"] for name in engine.impulse}
    for kind, touching in (("contact", engine.contacts), ("wall", engine.walls)):
        for name, state in touching.items():
            touching[name] = _rebuilt(state, found, f"{kind}/{name}")
    for k, body in enumerate(engine.bodies):
        for name in BODY:
            setattr(body, name, found[f"body/{k}/{name}"])
    rows = {name.removeprefix("row/"): value for name, value in found.items() if name.startswith("row/")}
    engine.recorder.rows = {name: list(value) for name, value in rows.items()}


def _leaves(state: Any) -> Iterator[tuple[str, Any]]:
    for name in state._fields:
        value = getattr(state, name)
        if hasattr(value, "_fields"):
            yield from ((f"{name}/{path}", leaf) for path, leaf in _leaves(value))
        else:
            yield name, value


def _rebuilt(state: Any, found: Mapping[str, np.ndarray], path: str) -> Any:
    """Return a named tuple of arrays and numbers as it was kept."""
    new = {}
    for name in state._fields:
        value = getattr(state, name)
        if hasattr(value, "_fields"):
            new[name] = _rebuilt(value, found, f"{path}/{name}")
        elif isinstance(value, np.ndarray):
            new[name] = found[f"{path}/{name}"].astype(value.dtype, copy=False)
        else:
            new[name] = type(value)(found[f"{path}/{name}"])
    return state._replace(**new)


def write_restart(path: Path, engine: Engine) -> None:
    """Write the state of a run; the file of before stays whole until this one is."""
    import h5py

    beside = path.with_name(path.name + ".new")
    with h5py.File(beside, "w") as file:
        file.attrs["fingerprint"] = engine.fingerprint
        for name, value in state_of(engine).items():
            file[name] = value
    os.replace(beside, path)


def read_restart(path: Path, engine: Engine) -> None:
    """Bring an engine to the state that a file keeps.

    Raises
    ------
    InputError
        If the file is not there, not a restart file, or that of another model.
    """
    import h5py

    allowed = "a restart file of this model"
    if not path.is_file() or path.stat().st_size > LARGEST:
        raise InputError("restart", str(path), allowed, "run without it")
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("fingerprint") != engine.fingerprint:
                raise InputError("restart", str(path), allowed, "the case has changed since: run without it")
            found: dict[str, np.ndarray] = {}
            file.visititems(lambda name, item: _take(found, name, item))
        put_back(engine, found)
    except (OSError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("restart", str(path), allowed, f"it is damaged ({error}): run without it") from None


def _take(found: dict[str, np.ndarray], name: str, item: Any) -> None:
    if hasattr(item, "shape"):
        found[name] = np.asarray(item[()])
