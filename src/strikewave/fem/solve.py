"""Run a model with central differences: forces at t_n, velocity at t_(n+1/2), position at t_(n+1); SI.

Each interval of the histories is cut into equal steps below the critical one, so that its end is met exactly. Order
within a step: elements, gravity, ties, loads, boundaries, contact, walls, ties and boundaries again, rigid parts; then
nodes move.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from strikewave.base.errors import InputErrors
from strikewave.fem.again import next_blow
from strikewave.fem.checks import faults
from strikewave.fem.engine import Engine
from strikewave.fem.model import Controls, Model
from strikewave.fem.quality import check_mesh
from strikewave.fem.restart import kept_blows, path_of_blow, read_restart, write_restart
from strikewave.fem.run import FemRun, Frame

REPORT = 0.2
"""Seconds between two reports of progress."""


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
        return self.seconds * (self.duration / max(self.time, 1e-300) - 1.0)


class Writer(Protocol):
    """Takes frames as they come."""

    def add(self, frame: Frame) -> None:
        """Take a frame."""


class Onlooker(Protocol):
    """Looks at a run at each instant of its histories."""

    def see(self, engine: Engine, last: bool) -> None:
        """Look; ``last`` where the run ends here."""


class Keep(NamedTuple):
    """Where a run keeps its state to go on from, and every how many instants of its histories."""

    path: Path
    every: int = 10


class Asked(NamedTuple):
    """What is asked of a run besides its histories.

    Attributes
    ----------
    frames : int
        Whole fields, equally spaced over the run, its end included; 0: none.
    writer : Writer or None
        Takes the frames; they stay in memory where there is none.
    later : callable or None
        Gives what takes the frames of a later blow, by its number.
    keep : Keep or None
    resume : Path or None
        File of a run that was interrupted.
    report : callable or None
        Called with a `Progress` now and then.
    film : Onlooker or None
        Such as `strikewave.fem.film.Film`.
    """

    frames: int = 0
    writer: Writer | None = None
    later: Callable[[int], Writer | None] | None = None
    keep: Keep | None = None
    resume: Path | None = None
    report: Callable[[Progress], None] | None = None
    film: Onlooker | None = None


def solve(model: Model, asked: Asked | None = None) -> FemRun:
    """Run a model to the end of its first blow; `solve_blows` goes on from there.

    A run whose energy breaks, whose step collapses or whose numbers end stops early and says so in ``stopped``. Where
    all parts are rigid a step is as long as the interval of the histories.

    Raises
    ------
    InputError, InputErrors
        If the model cannot be run, with all reasons that are known before the first step.

    Examples
    --------
    >>> from strikewave.fem.model import Controls
    >>> from strikewave.fem.mesh import Mesh
    >>> from strikewave.fem.solids import Elastic
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> mesh = Mesh(1e-3 * cube, np.arange(8, dtype=np.int32)[None], np.zeros(1, np.int32), ("cube",))
    >>> model = Model(mesh, {"cube": Elastic(7820.0, 211e9, 0.3)}, Controls(2e-6), velocity={"cube": (1.0, 0.0, 0.0)})
    >>> run = solve(model)
    >>> len(run.time), round(float(run.parts["cube"].displacement[-1, 0] * 1e6), 9)
    (3, 2.0)
    """
    return solve_blows(replace(model, controls=replace(model.controls, blows=1)), asked)[0]


def solve_blows(model: Model, asked: Asked | None = None) -> tuple[FemRun, ...]:
    """Run all blows of a model, each on what the one before left (`strikewave.fem.again`); none after one that stopped.

    Raises
    ------
    InputError, InputErrors
        As `solve`.
    """
    asked = asked or Asked()
    check_controls(model)
    check_mesh(model.mesh)
    threads, runs = model.controls.threads, list[FemRun]()
    resumed = kept_blows(asked.resume) if asked.resume is not None else {}
    with ThreadPoolExecutor(threads) as pool:
        engine = Engine(model, pool if threads > 1 else None)
        for blow in range(1, model.controls.blows + 1):
            if blow in resumed:
                engine = Engine(model, engine.pool)
                read_restart(resumed[blow], engine, blow)
            elif blow > 1:
                engine = next_blow(engine, runs[-1].energy_in_play)
            runs.append(_one_blow(engine, _of_blow(asked, blow, model.controls)))
            if runs[-1].stopped:
                break
    return tuple(runs)


def _one_blow(engine: Engine, asked: Asked) -> FemRun:
    """Run an engine to the end of its blow."""
    begun, instants = clock.perf_counter(), engine.model.controls.intervals
    wanted = set(np.linspace(0, instants, asked.frames).round().astype(int).tolist()) if asked.frames else set()
    frames: list[Frame] = []
    stopped = _follow(engine, instants, asked, wanted, frames, begun)
    return engine.result(clock.perf_counter() - begun, stopped, tuple(frames))


def _of_blow(asked: Asked, blow: int, controls: Controls) -> Asked:
    """Return what is asked of one of the blows: its own writer, its share of progress; only the first is filmed."""
    writer = asked.writer if blow == 1 else asked.later(blow) if asked.later else None
    report, span = asked.report, controls.intervals * controls.interval

    def told(seen: Progress) -> None:
        if report is not None:
            report(seen._replace(time=seen.time + (blow - 1) * span, duration=controls.blows * span))

    film = asked.film if blow == 1 else None
    return asked._replace(writer=writer, film=film, report=told if report and controls.blows > 1 else report)


def _follow(engine: Engine, instants: int, asked: Asked, wanted: set[int], frames: list[Frame], begun: float) -> str:
    """Run an engine instant by instant; return why it stopped early, or nothing."""
    shown, done = 0.0, engine.steps
    while True:
        instant = engine.instant
        engine.act()
        stopped = engine.record()
        if instant in wanted:
            (asked.writer.add if asked.writer else frames.append)(engine.frame())
        if asked.film is not None:
            asked.film.see(engine, last=bool(stopped) or instant == instants)
        now = clock.perf_counter() - begun
        if asked.report is not None and (now - shown > REPORT or instant == instants or stopped):
            shown = now
            speed = engine.elements * (engine.steps - done) / now
            asked.report(Progress(engine.time, instants * engine.interval, engine.steps, engine.ahead, now, speed))
        if stopped or instant == instants:
            return stopped
        engine.to_next_instant()
        if asked.keep is not None and engine.goes_on:
            if engine.instant % asked.keep.every == 0:
                write_restart(asked.keep.path, engine)
            if engine.instant == instants and engine.blow < engine.model.controls.blows:
                write_restart(path_of_blow(asked.keep.path, engine.blow), engine)


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
