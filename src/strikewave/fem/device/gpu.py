"""An NVIDIA GPU, by numba-cuda."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import cuda

from strikewave.base.errors import InputError
from strikewave.fem._layout import SCRATCH

THREADS = 128  # a whole number of warps; few, so that threads of 255 registers still fill half a processor
"""Threads of a block."""


class Cuda:
    """The first GPU; ``stored`` as in `strikewave.fem.device.devices.Device`."""

    def __init__(self, stored: type[np.floating[Any]] = np.float64) -> None:
        if not cuda.is_available():
            hint = "run it without --device, on the processor"
            raise InputError("--device", "cuda", "a machine with an NVIDIA GPU and its driver", hint)
        self.stored = stored
        self.kernels: dict[Any, Any] = {}
        self._least = cuda.reduce(lesser)

    def put(self, array: np.ndarray) -> Any:
        """Return a copy of an array there."""
        return cuda.to_device(np.ascontiguousarray(array))

    def get(self, array: Any) -> np.ndarray:
        """Return a copy of it here."""
        return np.asarray(array.copy_to_host())

    def each(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, *arguments) for every i below count, in any order."""
        self._launch(kernel_of, body, count, arguments)

    def each_with_scratch(self, body: Callable[..., None], count: int, *arguments: Any) -> None:
        """Call body(i, scratch, *arguments), each with a scratch of its own."""
        self._launch(scratch_kernel_of, body, count, arguments)

    def _launch(self, build: Callable[..., Any], body: Any, count: int, arguments: tuple[Any, ...]) -> None:
        if body not in self.kernels:
            self.kernels[body] = cuda.jit(build(body))
        if count:
            self.kernels[body][-(-count // THREADS), THREADS](count, arguments)

    def least(self, array: Any) -> float:
        """Return the least of some numbers."""
        return float(self._least(array, init=np.inf))


def kernel_of(body: Any) -> Callable[[int, tuple[Any, ...]], None]:
    """Return the function of a kernel whose threads call a body with an index each."""

    def run(count: int, arguments: tuple[Any, ...]) -> None:
        i = cuda.grid(1)  # type: ignore[call-arg, var-annotated]
        if i < count:
            body(i, *arguments)

    return run


def scratch_kernel_of(body: Any) -> Callable[[int, tuple[Any, ...]], None]:
    """Return such a function with a scratch, which the compiler keeps in registers."""

    def run(count: int, arguments: tuple[Any, ...]) -> None:
        i = cuda.grid(1)  # type: ignore[call-arg, var-annotated]
        if i < count:
            scratch = cuda.local.array(SCRATCH, np.float64)
            body(i, scratch, *arguments)

    return run


def lesser(a: float, b: float) -> float:
    """Return the lesser of two numbers."""
    return min(a, b)
