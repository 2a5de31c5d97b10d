"""State of a run on disk, to go on from: HDF5, written beside the old file and renamed.

Numbers that the model itself fixes are never kept. A file is read as one by a stranger: names, shapes and types are
compared with those of the model before anything is read, and what numbers point to has to be there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.base.datasets import check_sealed, enduring_file
from strikewave.base.errors import InputError
from strikewave.fem._contact_kernels import ContactState, NodeContacts
from strikewave.fem.engine import COLLAPSED, Engine
from strikewave.fem.run import Rest

LARGEST = 40_000_000_000  # several times that of the largest mesh that is run: a larger one is none of ours
"""Most bytes of a restart file."""
ALLOWED = "a restart file of this model"
"""Allowed value in every refusal of a file."""
NUMBERS = ("instant", "steps", "dt_previous", "critical", "smallest", "initial_energy", "blow")
"""Numbers of the engine that a step begins with."""
ARRAYS = ("x", "v", "f", "impulse_given")
"""Arrays of the engine that a step begins with."""
FINITE = ("body/", "done/", "elements/", "impulse/", "row/")
"""Beginnings of the names of numbers that must be finite."""
SHORTEST = 0.4  # a step is cut to fit what is left of an interval, by half at most; less would take for ever
"""Least share of the safe step that a step of a file may be."""
LARGEST_OF_REST = 1e15  # energies, lengths and steps stay far below
"""Largest number in the record of how bodies came to rest."""
SEEN = "seen/"
"""Beginning of the names of what an observer has seen."""
ROUNDING = 1e-9  # times are summed in floating point
"""Share by which the steps of a file may exceed what its smallest step allows."""
BODY = ("centre", "velocity", "spin", "turned")
"""State of a rigid part."""
TOUCH = ("area", "velocity", "normal", "friction", "step")
"""State of the nodes of a contact or wall."""
SEARCHED = ("start", "candidates")
"""Arrays of a contact whose length is that of the last search."""
SURFACE = (*SEARCHED, "size", "radius", "place", "moving", "inverse_mass", "travel", "offset")
"""Other arrays of a contact or wall that a step begins with."""

Restore = Callable[[Mapping[str, np.ndarray]], None]
"""Takes what an observer had seen; raises ValueError or KeyError for what it never wrote."""


def state_of(engine: Engine) -> dict[str, np.ndarray]:
    """Return the whole changing state of a run, by name, before the forces of an instant are found."""
    engine.fetch()
    state: dict[str, Any] = {name: getattr(engine, name) for name in NUMBERS} | dict(_arrays(engine))
    state["rest"] = np.array(astuple(engine.rest) if engine.rest else np.zeros(len(fields(Rest))), float)
    state |= {f"done/{name}": value for name, value in engine.done.items()}
    for name, surfaces in engine.contacts.items():
        state |= {f"contact/{name}/{field}": getattr(surfaces, field) for field in SEARCHED}
    state |= {f"row/{name}": np.array(column) for name, column in engine.recorder.rows.items()}
    return {name: np.asarray(value) for name, value in state.items()}


def _arrays(engine: Engine) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the arrays that keep their shape in a run, each with its name."""
    yield from ((name, getattr(engine, name)) for name in ARRAYS)
    yield from ((f"impulse/{name}", value) for name, value in engine.impulse.items())
    for k, elements in enumerate(engine.solid.kinds):
        yield from ((f"elements/{k}/state", elements.blocks.state), (f"elements/{k}/sums", elements.sums))
    for k, body in enumerate(engine.bodies):
        yield from ((f"body/{k}/{name}", getattr(body, name)) for name in BODY)
    for kind, touching in (("contact", engine.contacts), ("wall", engine.walls)):
        for name, state in touching.items():
            yield from ((f"{kind}/{name}/{path}", value) for path, value in _surface(state))


def _surface(state: Any) -> Iterator[tuple[str, np.ndarray]]:
    yield from ((f"touch/{name}", getattr(state.touch, name)) for name in TOUCH)
    yield from ((name, getattr(state, name)) for name in SURFACE if name in state._fields and name not in SEARCHED)
    if isinstance(state, ContactState):
        yield from ((f"nodal/{name}", getattr(state.nodal, name)) for name in NodeContacts._fields)


def put_back(engine: Engine, state: Mapping[str, np.ndarray]) -> None:
    """Bring an engine of the same model to a state."""
    for name in NUMBERS:
        setattr(engine, name, type(getattr(engine, name))(state[name]))
    for name, value in _arrays(engine):
        value[...] = state[name]
    if engine.blow > 1:
        engine.rest, engine.overlaps = _rest(state["rest"]), []
    engine.done = {name: float(state[f"done/{name}"]) for name in engine.done}
    for name, contact in engine.contacts.items():
        start, candidates = (state[f"contact/{name}/{field}"] for field in SEARCHED)
        engine.contacts[name] = contact._replace(start=start, candidates=candidates)
    engine.recorder.rows = {name: list(state[f"row/{name}"]) for name in engine.recorder.rows}
    engine.begin_interval()
    engine.send()


def _rest(row: np.ndarray) -> Rest:
    """Return the record of how bodies came to rest, from its row in the state."""
    return Rest(int(row[0]), int(row[1]), *(float(value) for value in row[2:]))


def write_restart(path: Path, engine: Engine, seen: Mapping[str, np.ndarray] | None = None) -> None:
    """Write the state of a run and of its observer; the file of before stays whole until this one is."""
    import h5py

    beside = path.with_name(path.name + ".new")
    state = state_of(engine) | {f"{SEEN}{name}": value for name, value in (seen or {}).items()}
    try:
        with enduring_file(beside) as disk, h5py.File(disk, "w") as file:
            file.attrs["fingerprint"], file.attrs["blow"] = engine.fingerprint, engine.blow
            for name, value in state.items():
                file[name] = value
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def path_of_blow(path: Path, blow: int) -> Path:
    """Return the path of the end of a blow, beside the state of the run."""
    return path.with_name(f"{path.stem}-{blow}{path.suffix}")


def kept_blows(path: Path) -> dict[int, Path]:
    """Return the file of each blow that a run goes on from: the ends of those before, and the one under way."""
    files: dict[int, Path] = {}
    while (end := path_of_blow(path, len(files) + 1)).is_file():
        files[len(files) + 1] = end
    if path.is_file() or not files:
        blow = _blow_in(path)
        if not 1 <= blow <= len(files) + 1:
            raise _damaged(path, ValueError(f"the end of blow {len(files) + 1} is missing"))
        files.setdefault(blow, path)
    return files


def _blow_in(path: Path) -> int:
    """Return the blow whose state a file keeps."""
    import h5py

    _check_file(path)
    try:
        check_sealed(path)
        with h5py.File(path, "r") as file:
            blow = file.attrs.get("blow", 1)
            _need("blow", isinstance(blow, int | np.integer))
            return int(blow)
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise _damaged(path, error) from None


def _check_file(path: Path) -> None:
    if not path.is_file() or path.stat().st_size > LARGEST:
        raise InputError("restart", path, ALLOWED, "run without it")


def _damaged(path: Path, error: Exception) -> InputError:
    return InputError("restart", path, ALLOWED, f"it is damaged ({error}): run without it")


def read_restart(path: Path, engine: Engine, blow: int = 1, restore: Restore | None = None) -> None:
    """Bring an engine that has not begun to the state that a file keeps of a blow, and hand on what was seen of it."""
    import h5py

    _check_file(path)
    try:
        check_sealed(path)
        with h5py.File(path, "r") as file:
            if file.attrs.get("fingerprint") != engine.fingerprint:
                raise InputError("restart", path, ALLOWED, "the case has changed since, or strikewave: run without it")
            state = _read(file, engine, path.stat().st_size)
        _check(engine, state, blow)
        seen = {name.removeprefix(SEEN): value for name, value in state.items() if name.startswith(SEEN)}
        if restore is not None and seen:
            restore(seen)
    except (OSError, KeyError, TypeError, ValueError, RuntimeError, MemoryError) as error:
        if isinstance(error, InputError):
            raise
        raise _damaged(path, error) from None
    put_back(engine, state)


def _read(file: Any, engine: Engine, most: int) -> dict[str, np.ndarray]:
    """Return the numbers of a file, if it holds those of the engine, which notes a row, and no others."""
    engine.assemble_forces()
    engine.record()
    items: dict[str, Any] = {}
    file.visititems(lambda name, item: items.update({name: item}) if hasattr(item, "shape") else None)
    wanted = state_of(engine)
    own = {name for name in items if not name.startswith(SEEN)}
    if own != wanted.keys():
        raise ValueError(f"{min(own ^ wanted.keys())} is missing or unknown")
    if sum(item.nbytes for item in items.values()) > most:
        raise ValueError("it claims more than it holds")
    rows = 0
    for name in sorted(items, key=lambda name: name != "instant"):
        item, like = items[name], wanted.get(name, items[name])
        shape = (rows, *like.shape[1:]) if name.startswith("row/") else like.shape
        if name.startswith("contact/") and name.endswith("/candidates"):
            shape = item.shape[:1]
        plain = item.chunks is None and item.external is None and item.id.get_storage_size() == item.nbytes
        if not (plain and item.dtype == like.dtype and item.shape == shape):
            raise ValueError(f"{name} has another shape or type")
        if name == "instant":
            rows = int(item[()])
            _need("instant", 0 <= rows <= engine.model.controls.intervals)
    return {name: np.asarray(item[()]) for name, item in items.items()}


def _check(engine: Engine, stored: Mapping[str, np.ndarray], blow: int) -> None:
    """Check what a run would not survive: numbers that end, steps without end, faces that are not there."""
    for name in (*ARRAYS, *(name for name in stored if name.startswith(FINITE))):
        _need(name, bool(np.all(np.isfinite(stored[name]))))
    least = min(engine.interval, SHORTEST * engine.model.controls.safety * engine.collapse)
    for name in ("dt_previous", "smallest"):
        _need(name, least <= float(stored[name]) <= engine.interval)
    steps, instant = int(stored["steps"]), int(stored["instant"])
    _need("steps", instant <= steps <= (1.0 + ROUNDING) * instant * engine.interval / float(stored["smallest"]))
    _need("blow", int(stored["blow"]) == blow)
    _need("rest", bool(np.all(np.isfinite(stored["rest"]) & (np.abs(stored["rest"]) < LARGEST_OF_REST))))
    _need("initial_energy", bool(np.isfinite(stored["initial_energy"])))
    _need("critical", engine.collapse <= float(stored["critical"]) <= engine.critical / COLLAPSED)
    for name, state in engine.contacts.items():
        start, candidates, face = (stored[f"contact/{name}/{each}"] for each in (*SEARCHED, "nodal/face"))
        _need(f"{name}: start", start[0] == 0 and start[-1] == len(candidates) and bool(np.all(np.diff(start) >= 0)))
        for faces, least in ((candidates, 0), (face, -1)):
            _need(f"{name}: faces", bool(np.all((faces >= least) & (faces < len(state.faces)))))


def _need(name: str, good: bool) -> None:
    if not good:
        raise ValueError(f"{name} is out of range")
