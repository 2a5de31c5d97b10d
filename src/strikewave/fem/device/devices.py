"""Devices that run a body, one call for each index: a GPU, or a loop here."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from strikewave.base.errors import InputError, MissingPackageError
from strikewave.fem._layout import SCRATCH

MIXED = "cuda-mixed"
NAMES = ("cuda", MIXED)
"""Devices that can be asked for: a GPU, and one whose elements keep single numbers (`Device`)."""


class Device(Protocol):
    """A device that holds arrays and calls a compiled body for each index."""

    stored: type[np.floating[Any]]  # most of the bytes of a step; all that is calculated is double
    """Type of the numbers that elements store: constants, state and forces on their corners."""

    def put(self, array: np.ndarray) -> Any:
        """Return a copy of an array there."""

    def get(self, array: Any) -> np.ndarray:
        """Return a copy of it here."""

    def each(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, *arguments) for every i below count, in any order."""

    def each_with_scratch(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, scratch, *arguments), each with a scratch of its own."""

    def least(self, array: Any) -> float:
        """Return the least of some numbers."""


class Loop:
    """The device of tests: the same bodies, one index after another, on arrays here."""

    def __init__(self, stored: type[np.floating[Any]] = np.float64) -> None:
        self.stored, self.scratch = stored, np.zeros(SCRATCH)

    def put(self, array: np.ndarray) -> np.ndarray:
        """Return a copy of an array."""
        return np.array(array)

    def get(self, array: np.ndarray) -> np.ndarray:
        """Return a copy of it."""
        return np.array(array)

    def each(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, *arguments) for every i below count."""
        for i in range(count):
            body(i, *arguments)

    def each_with_scratch(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, scratch, *arguments) with one scratch for all."""
        self.each(body, count, self.scratch, *arguments)

    def least(self, array: np.ndarray) -> float:
        """Return the least of some numbers."""
        return float(array.min())


@functools.cache
def device_named(name: str) -> Device:
    """Return a device, the same in each call: it holds what was compiled for it."""
    if name not in NAMES:
        raise InputError("--device", name, " or ".join(NAMES))
    try:
        from strikewave.fem.device.gpu import Cuda
    except ImportError:
        raise MissingPackageError(f"--device {name}", "numba-cuda", "gpu") from None
    return Cuda(np.float32 if name == MIXED else np.float64)
