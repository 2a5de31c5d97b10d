"""Compile the kernels of the fast run beside a full run, which compiles the integrator that both share."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

import numpy as np

from strikewave.base.compile_beside import await_kernel, compiled_beside
from strikewave.contact._chain_kernels import ChainTables
from strikewave.contact._integrator import Control, empty_record
from strikewave.machines import _kernels, _pass_kernels, _train_kernels
from strikewave.machines._kernels import MachineSystem
from strikewave.machines._train_kernels import MountedStrikers, Part, Train, TrainTables
from strikewave.machines.fast_train import empty_passes


def fast_run_beside() -> AbstractContextManager[None]:
    """Return what compiles the fast run in a second process while a full run goes on within."""
    return compiled_beside("run_train", f"{__name__}:{compile_fast_run.__name__}")


def compile_fast_run() -> None:
    """Compile the fast run: first the switches, which the full run needs later, then its own kernels, then the whole.

    The whole waits until the full run has compiled the integrator.

    Types are those of the smallest tables; no machine is built. Were one wrong, the kernel would be compiled when it
    is called; a test holds them against those of the fast run.
    """
    table, line, count = np.zeros((1, 1)), np.zeros(1), np.zeros(1, dtype=np.int64)
    system = MachineSystem(ChainTables(table, table, count.reshape(1, 1), table), table, line)
    part, passes = Part(line, count, line, empty_record(1, 1, 1, 1)), empty_passes(1)
    mounted, train = MountedStrikers(table, table, table, line, line, line), Train(0.0, 0.0, 0, 0.0, 0)
    control = Control(0.0, line, 0.0, 0.0, 0.0)
    own = (
        (_kernels.machine_switches, (system, 0.0, line, count, line, line)),
        (_kernels.machine_switch, (system, 0, 0.0, line, count, line)),
        (_train_kernels.rigid_energy, (system, 0.0, part)),
        (_train_kernels.begin_blow, (system, system, mounted, part, part, 0.0)),
        (_train_kernels.end_blow, (system, system, mounted, part, part, 0.0)),
        (_train_kernels.ringing, (system, system, part, 0.0)),
        (_train_kernels.crowded, (system, system, part, 0)),
        (_pass_kernels.open_row, (system, system, part, part, passes, 0.0)),
        (_pass_kernels.note_blow, (system, system, part, passes, 0, line)),
        (_pass_kernels.measure_row, (passes,)),
        (_pass_kernels.note_flight, (system, part, passes, 0, line)),
        (_pass_kernels.missed_row, (system, part, passes, 0.0, 0.0)),
        (_pass_kernels.repeats, (table, 0, 0.0, 0)),
    )
    for kernel, arguments in own:
        _compile(kernel, arguments)
    await_kernel("_integrator.advance")
    whole = TrainTables(system, system, mounted), part, part, (control, control), train, passes
    _compile(_train_kernels.run_train, whole)


def _compile(kernel: Any, arguments: tuple[Any, ...]) -> None:
    from numba import typeof

    kernel.compile(tuple(typeof(argument) for argument in arguments))
