"""Run a model with central differences: forces at t_n, velocity at t_(n+1/2), position at t_(n+1); SI.

Each interval of the histories is cut into equal steps below the critical one, so that its end is met exactly. Order
within a step: elements, gravity, ties, loads, boundaries, contact, walls, ties and boundaries again, rigid parts; then
nodes move.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from strikewave.base.errors import InputErrors
from strikewave.fem.checks import faults
from strikewave.fem.device.devices import Device
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import TINY
from strikewave.fem.model import Controls, Model
from strikewave.fem.quality import check_mesh
from strikewave.fem.repeated_blows import next_blow
from strikewave.fem.restart import kept_blows, path_of_blow, read_restart, write_restart
from strikewave.fem.run import FemRun, FieldFrame

REPORT = 0.2
"""Seconds between two reports of progress: as often as a bar on a screen is seen to move, at no cost."""

EVERY = 10
"""Instants of the histories after which a run keeps its state: a tenth of a usual run is lost at most."""


class Progress(NamedTuple):
    """How far a run is: time and duration (s), steps done, time step (s), seconds since the start, element-steps/s."""

    time: float
    duration: float
    steps: int
    step: float
    seconds: float
    speed: float

    @property
    def left(self) -> float:
        """Seconds that are left at the rate so far."""
        return self.seconds * (self.duration / max(self.time, TINY) - 1.0)


class Writer(Protocol):
    """Takes frames as they come."""

    def add(self, frame: FieldFrame) -> None:
        """Take a frame."""


class Observer(Protocol):
    """Looks at a run at each instant of its histories."""

    def observe(self, engine: Engine, last: bool) -> None:
        """Look; ``last`` where the run ends here."""

    def state(self) -> Mapping[str, np.ndarray]:
        """Return what it has seen, to be kept with the state of the run."""

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take what it had seen of a run that goes on; raise ValueError for what it never wrote."""


class Checkpoint(NamedTuple):
    """Where a run keeps its state to go on from, and every how many instants of its histories."""

    path: Path
    every: int = EVERY


class RunOptions(NamedTuple):
    """What is asked of a run besides its histories.

    Attributes
    ----------
    frames : int
        Whole fields, equally spaced over the run, its end included; 0: none.
    writer : Writer or None
        Takes the frames; they stay in memory where there is none.
    later : callable or None
        Gives what takes the frames of a later blow, by its number.
    checkpoint : Checkpoint or None
    resume : Path or None
        File of a run that was interrupted.
    report : callable or None
        Called with a `Progress` now and then.
    observer : Observer or None
        Such as `strikewave.fem.snapshots.SnapshotRecorder`.
    device : Device or None
        Takes the steps, such as `strikewave.fem.device.devices.Cuda`; None: the processor.
    """

    frames: int = 0
    writer: Writer | None = None
    later: Callable[[int], Writer | None] | None = None
    checkpoint: Checkpoint | None = None
    resume: Path | None = None
    report: Callable[[Progress], None] | None = None
    observer: Observer | None = None
    device: Device | None = None


def solve(model: Model, options: RunOptions | None = None) -> FemRun:
    """Run a model to the end of its first blow; `solve_blows` goes on from there.

    A run whose energy breaks, whose step collapses or whose numbers overflow stops early; ``stopped`` has the
    reason. Where all parts are rigid a step is as long as the interval of the histories.

    Raises
    ------
    InputError
        If the model cannot be run, with all reasons that are known before the first step.

    Examples
    --------
    >>> from strikewave.fem.model import Controls
    >>> from strikewave.fem.mesh import TINY, Mesh
    >>> from strikewave.fem.solids import Elastic
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> mesh = Mesh(1e-3 * cube, np.arange(8, dtype=np.int32)[None], np.zeros(1, np.int32), ("cube",))
    >>> model = Model(mesh, {"cube": Elastic(7820.0, 211e9, 0.3)}, Controls(2e-6), velocity={"cube": (1.0, 0.0, 0.0)})
    >>> run = solve(model)
    >>> len(run.time), round(float(run.parts["cube"].displacement[-1, 0] * 1e6), 9)
    (3, 2.0)
    """
    return solve_blows(replace(model, controls=replace(model.controls, blows=1)), options)[0]


def solve_blows(model: Model, options: RunOptions | None = None) -> tuple[FemRun, ...]:
    """Run all blows of a model, each on the state that the one before left; none after one that stopped.

    See `strikewave.fem.repeated_blows`.

    Raises
    ------
    InputError
        As `solve`.
    """
    options = options or RunOptions()
    check_controls(model)
    check_mesh(model.mesh)
    threads, runs = model.controls.threads, list[FemRun]()
    resumed = kept_blows(options.resume) if options.resume is not None else {}
    with ThreadPoolExecutor(threads) as pool:
        engine = _engine(model, pool if threads > 1 else None, options.device)
        for blow in range(1, model.controls.blows + 1):
            if blow in resumed:
                engine = _engine(model, engine.pool, options.device)
                observer = options.observer if blow == 1 else None
                read_restart(resumed[blow], engine, blow, observer.restore if observer else None)
            elif blow > 1:
                engine = next_blow(engine, runs[-1].energy_in_play)
            runs.append(_one_blow(engine, _of_blow(options, blow, model.controls)))
            if runs[-1].stopped:
                break
    return tuple(runs)


def _engine(model: Model, pool: ThreadPoolExecutor | None, device: Device | None) -> Engine:
    if device is None:
        return Engine(model, pool)
    from strikewave.fem.device.engine import DeviceEngine

    return DeviceEngine(model, device)


def _one_blow(engine: Engine, options: RunOptions) -> FemRun:
    """Run an engine to the end of its blow."""
    begun, instants = clock.perf_counter(), engine.model.controls.intervals
    wanted = set(frame_instants(engine.model.controls, options.frames))
    frames: list[FieldFrame] = []
    stopped = _follow(engine, instants, options, wanted, frames, begun)
    return engine.result(clock.perf_counter() - begun, stopped, tuple(frames))


def frame_instants(controls: Controls, frames: int) -> list[int]:
    """Return the instants of the histories at which whole fields are kept.

    Examples
    --------
    >>> frame_instants(Controls(4e-6, 0.5e-6), 3)
    [0, 4, 8]
    """
    return sorted(set(np.linspace(0, controls.intervals, frames).round().astype(int).tolist())) if frames else []


def _of_blow(options: RunOptions, blow: int, controls: Controls) -> RunOptions:
    """Return what is asked of one of the blows: its own writer, its share of progress; only the first is filmed."""
    writer = options.writer if blow == 1 else options.later(blow) if options.later else None
    report, span = options.report, controls.intervals * controls.interval

    def report_all(progress: Progress) -> None:
        if report is not None:
            report(progress._replace(time=progress.time + (blow - 1) * span, duration=controls.blows * span))

    observer = options.observer if blow == 1 else None
    return options._replace(
        writer=writer, observer=observer, report=report_all if report and controls.blows > 1 else report
    )


def _follow(
    engine: Engine, instants: int, options: RunOptions, wanted: set[int], frames: list[FieldFrame], begun: float
) -> str:
    """Run an engine instant by instant; return why it stopped early, or nothing."""
    shown, done = 0.0, engine.steps
    while True:
        instant = engine.instant
        engine.assemble_forces()
        stopped = engine.record()
        if instant in wanted:
            (options.writer.add if options.writer else frames.append)(engine.frame())
        if options.observer is not None:
            options.observer.observe(engine, last=bool(stopped) or instant == instants)
        now = clock.perf_counter() - begun
        if options.report is not None and (now - shown > REPORT or instant == instants or stopped):
            shown = now
            speed = engine.elements * (engine.steps - done) / now
            options.report(Progress(engine.time, instants * engine.interval, engine.steps, engine.dt_next, now, speed))
        if stopped or instant == instants:
            return stopped
        engine.to_next_instant()
        if options.checkpoint is not None and engine.goes_on:
            if engine.instant % options.checkpoint.every == 0:
                write_restart(options.checkpoint.path, engine, _seen(options))
            if engine.instant == instants and engine.blow < engine.model.controls.blows:
                write_restart(path_of_blow(options.checkpoint.path, engine.blow), engine, _seen(options))


def _seen(options: RunOptions) -> Mapping[str, np.ndarray]:
    """Return what is kept of the observer of a run."""
    return {} if options.observer is None else options.observer.state()


def check_controls(model: Model) -> int:
    """Check what can be checked before anything is built; return the number of intervals.

    Raises
    ------
    InputErrors
        With one line for each thing that is wrong.
    """
    lines = [str(fault) for fault in faults(model)]
    if lines:
        raise InputErrors(lines)
    return model.controls.intervals
