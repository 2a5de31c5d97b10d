"""Contact forces and energies from ``binout``, as `strikewave.exchange.ls_dyna.ascii` reads them from text.

Names of the arrays: ``/rcforc/metadata/ids, side, legend_ids, legend`` and ``/rcforc/d000001/time, x_force, y_force,
z_force, mass``, ``/glstat/d000001/time, kinetic_energy, ...``, as LSTC's converter ``l2a`` reads them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna.ascii import Array, ContactForce, GlobalEnergies, last_pass, title_of
from strikewave.exchange.ls_dyna.lsda import archived, number_of

MOST_OUTPUTS = 10_000_000
"""Outputs that a file may hold: bounds the memory of a file that begins ever new ones."""
_NONE = np.empty(0)
"""Stands for an array that is missing."""
FORCES = ("x_force", "y_force", "z_force")
"""Arrays of the components of a contact force."""
MOMENTS = ("x_moment", "y_moment", "z_moment")
"""Those of its moment, which newer versions write."""

Held = dict[str, dict[str, NDArray[Any]]]
"""Arrays by the folder in which they lie, such as ``d000001``."""


def read_binout(paths: Sequence[Path]) -> tuple[tuple[ContactForce, ...], GlobalEnergies | None]:
    """Return the contact forces and energies of one run's files ``binout``; empty and None where there are none.

    Raises
    ------
    InputError
        If a file cannot be read, is no archive, or its arrays do not fit together.
    """
    branches: dict[str, Held] = {"rcforc": {}, "glstat": {}}
    for path in paths:
        for values in archived(path):
            folders = values.path.split("/")[1:]
            if len(folders) == 3 and folders[0] in branches:
                branches[folders[0]].setdefault(folders[1], {})[folders[2]] = np.array(values.values)
                if len(branches[folders[0]]) > MOST_OUTPUTS:
                    raise InputError("FILE", str(path), f"at most {MOST_OUTPUTS} outputs")
    where = paths[0] if paths else Path("binout")
    return _contacts(where, branches["rcforc"]), _energies(where, branches["glstat"])


def _contacts(path: Path, branch: Held) -> tuple[ContactForce, ...]:
    about = branch.pop("metadata", {})
    outputs = _in_order(path, "rcforc", branch)
    if not outputs or "ids" not in about:
        return ()
    for name in ("ids", "side", "legend_ids"):
        if name in about and about[name].dtype.kind not in "iu":
            raise InputError(f"{path.name}, rcforc/metadata/{name}", str(about[name].dtype), "whole numbers")
    numbers = about["ids"].astype(int)
    sides = about.get("side", np.zeros(numbers.size)).astype(bool)
    if sides.size != numbers.size:
        raise InputError("FILE", str(path), "a side for each contact in rcforc/metadata")
    time = _table(path, outputs, ("time",), 1)[:, 0, 0]
    force = _table(path, outputs, FORCES, numbers.size)
    mass = _table(path, outputs, ("mass",), numbers.size) if "mass" in outputs[0] else np.zeros_like(force[:, :1])
    moment = _table(path, outputs, MOMENTS, numbers.size) if MOMENTS[0] in outputs[0] else None
    titles = _titles(about)
    return tuple(
        ContactForce(
            int(number),
            "B" if sides[k] else "A",
            titles.get(int(number), ""),
            time,
            force[:, :, k],
            mass[:, 0, k],
            None if moment is None else moment[:, :, k],
        )
        for k, number in enumerate(numbers)
    )


def _energies(path: Path, branch: Held) -> GlobalEnergies | None:
    branch.pop("metadata", None)
    outputs = _in_order(path, "glstat", branch)
    if not outputs:
        return None
    names = dict.fromkeys(
        name for output in outputs for name, values in output.items() if values.size and name != "time"
    )
    table = {}
    for name in names:
        columns = [output.get(name) for output in outputs]
        if all(values is None or values.dtype.kind in "if" for values in columns):
            sums = [None if values is None else float(values.sum(dtype=float)) for values in columns]
            _check_finite(path, f"glstat {name}", np.array([total for total in sums if total is not None]))
            table[_words(name)] = np.array([math.nan if total is None else total for total in sums])
    return GlobalEnergies(np.array([float(output["time"][0]) for output in outputs]), table)


def _in_order(path: Path, branch: str, folders: Held) -> list[dict[str, NDArray[Any]]]:
    """Return the outputs that have a time by their number, without those that a restart wrote again.

    A last one that lacks what all others have was cut off, and is left out.
    """
    outputs = [folders[name] for name in sorted(folders, key=number_of) if folders[name].get("time", _NONE).size == 1]
    if not outputs:
        return []
    time = np.array([float(output["time"][0]) for output in outputs])
    _check_finite(path, f"{branch} time", time)
    outputs = [output for output, keep in zip(outputs, last_pass(time), strict=True) if keep]
    if len(outputs) > 1 and not set.intersection(*map(set, outputs[:-1])) <= outputs[-1].keys():
        outputs.pop()
    return outputs


def _check_finite(path: Path, what: str, values: NDArray[Any]) -> None:
    if not np.isfinite(values).all():
        raise InputError(f"{path.name}, {what}", "NaN or infinity", "finite numbers", "the run blew up there")


def _table(path: Path, outputs: list[dict[str, NDArray[Any]]], names: tuple[str, ...], count: int) -> Array:
    """Return arrays of all outputs, (outputs, names, count); an output that lacks one is refused."""
    for output in outputs:
        for name in names:
            if output.get(name, _NONE).size != count:
                got = f"{output.get(name, _NONE).size} numbers"
                raise InputError(f"{path.name}, rcforc {name}", got, f"{count} in each output", "is the run whole?")
            _check_finite(path, f"rcforc {name}", output[name])
    return np.array([[output[name] for name in names] for output in outputs], float)


def _titles(about: dict[str, NDArray[Any]]) -> dict[int, str]:
    """Return the titles of contacts by number; all are as long as each other, 70 or 80 characters."""
    numbers, text = about.get("legend_ids", _NONE), about.get("legend", _NONE).tobytes()
    if not numbers.size:
        return {}
    each = len(text) // numbers.size
    pieces = (text[k * each : (k + 1) * each] for k in range(numbers.size))
    return {int(n): title_of(piece) for n, piece in zip(numbers, pieces, strict=True)}


def _words(name: str) -> str:
    """Return the name that an energy has in ``glstat``.

    Examples
    --------
    >>> _words("sliding_interface_energy"), _words("energy_ratio")
    ('sliding interface energy', 'total energy / initial energy')
    """
    return "total energy / initial energy" if name == "energy_ratio" else name.replace("_", " ")
