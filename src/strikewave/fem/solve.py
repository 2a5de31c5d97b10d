"""Run a model with central differences, blow after blow, or bring its bodies to rest; SI.

Forces are those at t_n, the velocity that at t_(n+1/2), the position that at t_(n+1).
Each interval of the histories is cut into equal steps below the critical one, so that its end is met exactly. Order
within a step: elements, gravity, ties, loads, boundaries, contact, walls, ties and boundaries again, rigid parts; then
nodes move.

Vibration of bodies taken away by kinetic relaxation, until they are in static equilibrium; SI.

Bodies without outer loads vibrate about their state of rest. Whenever the kinetic energy of a body passes a maximum,
where it is nearest to equilibrium, its velocities are set to zero; what is left is a smaller vibration, and so on
(dynamic relaxation with kinetic damping). It takes no coefficient of damping, and changes nothing in the bodies but
what the vibration itself would.

A small maximum may be that of a fast vibration, while a slow one has only begun. A body rests when its kinetic energy
stays below the wanted one, with nothing set to zero, as long as the longest rise to a maximum before; and as long as a
wave takes there and back.

Sources: P. A. Cundall 1976, Explicit finite-difference methods in geomechanics, Numerical Methods in Engineering,
Proc. EF Conference, Blacksburg, 132-150; M. R. Barnes 1999, International Journal of Space Structures 14, 89-104.

One blow after another: what the material remembers at the end of one is where the next begins; SI.

Between two blows of a machine lie many milliseconds. In that time

1. what drives and presses the bodies is gone, what strikes is away, and vibration dies out
   (`strikewave.fem.solve`); contacts of parts that have the same velocity in the case stay closed;
2. each body goes back to where it began, as one rigid body and only along what boundaries leave it
   (`strikewave.fem.bodies`); one with a rigid part so that this stands exactly there;
3. where bodies touch that were moved, they come to rest once more.

Then all get the velocities of the model, time and curves begin at 0, and the energy balance with what residual
stresses hold. Plastic strain, back stress, temperature, shape and residual stress are kept. What would stand deeper in
what it strikes than before the first blow begins so much farther away, against its velocity; any other overlap is let
out without a force, as before a first blow (`strikewave.fem.contact`).
"""

from __future__ import annotations

import dataclasses
import time as clock
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputErrors
from strikewave.fem.bodies import Body, bodies_of, way_back
from strikewave.fem.device.devices import Device
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import TINY, Array
from strikewave.fem.model import Controls, Driven, Model, NonReflecting, Pressure, faults, stays
from strikewave.fem.quality import check_mesh
from strikewave.fem.restart import kept_blows, path_of_blow, put_back, read_restart, state_of, write_restart
from strikewave.fem.run import FemRun, FieldFrame, Rest

MOST_MAXIMA = 300  # each takes a share of the vibration; bodies that come to rest at all do so within some tens
"""Maxima of a body after which it is taken as it is."""


class Settled(NamedTuple):
    """Record of bodies that came to rest: maxima of all bodies, steps, largest kinetic energy that was left, J."""

    maxima: int
    steps: int
    kinetic: float


class _Watch:
    """Kinetic energies of bodies from step to step: where each passes a maximum, and since when it is small."""

    def __init__(self, engine: Engine, bodies: Sequence[Body], wanted: float) -> None:
        self.wanted = wanted / len(bodies)
        self.owner = np.zeros(len(engine.x), np.int64)
        for number, body in enumerate(bodies):
            self.owner[body.nodes] = number
        self.energy, self.left = np.zeros(len(bodies)), np.zeros(len(bodies))
        self.maxima, self.rise, self.small = np.zeros((3, len(bodies)), np.int64)
        self.longest = np.array([_crossing_steps(engine, body) for body in bodies])

    def passed(self, now: Array) -> NDArray[np.bool_]:
        """Take the energies after a step, J; return the mask of the bodies at a maximum that is not small."""
        large = now > self.wanted  # maxima of what is left when a body rests are no maxima of its vibration
        passed = large & (now < self.energy)
        self.maxima += passed
        self.rise += 1
        self.longest = np.where(passed, np.maximum(self.longest, self.rise), self.longest)
        self.rise[passed] = 0
        self.small = np.where(large, 0, self.small + 1)
        self.left = np.where(self.small > 1, np.maximum(self.left, now), now)
        self.energy = np.where(passed, 0.0, now)  # the next energy rises from rest: it is no maximum at once
        return passed

    @property
    def over(self) -> bool:
        """True if every body rests, or has passed as many maxima as it may."""
        return bool(np.all((self.small > self.longest) | (self.maxima >= MOST_MAXIMA)))


def settle(engine: Engine, bodies: Sequence[Body], wanted: float, most: int) -> Settled:
    """Bring bodies that begin without velocity to rest, to a kinetic energy ``wanted``, J, in ``most`` steps.

    The engine, of a model without velocities and loads, has been initialized.
    """
    watch, rigid = _Watch(engine, bodies, wanted), [body.nodes for body in engine.bodies]
    first = engine.steps
    while not watch.over and engine.steps - first < most and engine.goes_on:
        engine.dt_next = min(engine.dt_next, engine.model.controls.safety * engine.critical)
        engine.assemble_forces()
        engine.step()
        square = np.einsum("n,ni,ni->n", engine.own_mass, engine.v, engine.v)
        passed = watch.passed(np.asarray(0.5 * np.bincount(watch.owner, square, len(bodies)), float))
        if passed.any():
            engine.v[passed[watch.owner]] = 0.0
            for body, nodes in zip(engine.bodies, rigid, strict=True):
                if passed[watch.owner[nodes[0]]]:
                    body.velocity, body.spin = np.zeros(3), np.zeros(3)
    engine.v.fill(0.0)
    return Settled(int(watch.maxima.sum()), engine.steps - first, float(watch.left.sum()))


def _crossing_steps(engine: Engine, body: Body) -> int:
    """Return the steps that a wave takes through a body and back."""
    places = engine.model.mesh.points[body.nodes]
    slowest = min(engine.model.solids[part].wave_speed for part in body.parts)
    reach = 2.0 * float(np.linalg.norm(np.ptp(places, axis=0)))
    return int(np.ceil(reach / (slowest * engine.dt_next)))


REST = 1e-10  # elastic bodies then repeat peak and impulse within 1e-6, in one to three times the steps of a blow
"""Share of the energy in play of a blow that may be left as kinetic energy before the next."""
LONGEST = 20  # several times the usual one to three
"""Factor on the steps of a blow: the most that its bodies may take to rest."""
STEPS_BACK = 30  # few do on convex surfaces; each step of a round one in a dent finds another nearest face
"""Most steps back of what strikes; what is left then is let out without a force, and reported as an overlap."""
CLEAR = 1.01  # 1 would leave what rounding and the slope of a surface leave
"""Factor on the overlap by which it steps back."""
ROUNDING = 1e-9
"""Share of the size of a mesh below which an overlap is rounding."""
LOADS = Driven | Pressure | NonReflecting  # dashpots would push a vibrating body away
"""Boundaries that hold nothing at rest."""
State = Mapping[str, np.ndarray]


def next_blow(engine: Engine, energy: float, share: float = REST) -> Engine:
    """Return an engine that begins the next blow on the state at the end of one.

    ``energy``, J, was in play in that run; ``share`` of it may be left as kinetic energy.
    """
    model, bodies = engine.model, bodies_of_engine(engine)
    quiet_model, wanted, ended = quiet(model), share * energy, state_of(engine)
    resting = Engine(quiet_model, engine.pool)
    put_back(resting, {**state_of(resting), **_left_of(ended, resting)})
    resting.initialize()
    begun = _plastic(resting)
    most = LONGEST * engine.steps
    settled = [settle(resting, bodies, wanted, most)]
    _bring_back(resting, bodies)
    if quiet_model.contacts or quiet_model.walls:
        moved = Engine(quiet_model, engine.pool)
        _take_over(moved, resting, meet=True)
        settled.append(settle(moved, bodies, wanted, most))
        resting = moved
    following = engine.begun_anew()
    first = _depths(following)
    _take_over(following, resting, meet=False)
    following.blow = engine.blow + 1
    added_distance = _step_back(following, bodies, first)
    following.rest = Rest(
        maxima=sum(each.maxima for each in settled),
        steps=sum(each.steps for each in settled),
        kinetic_share=max(each.kinetic for each in settled) / max(energy, TINY),
        plastic_energy=_plastic(resting) - begun,
        added_distance=added_distance,
        overlap=max(_depths(following).values(), default=0.0),
        plastic_before=_plastic(resting) + (engine.rest.plastic_before if engine.rest else 0.0),
    )
    following.overlaps = []
    for elements in following.solid.kinds:
        elements.begin_balance()
    following.initialize()
    return following


def bodies_of_engine(engine: Engine) -> list[Body]:
    """Return the bodies of a run, with the motions that all but driven sides leave them."""
    still = [hold for hold in engine.holds if hold.speed is None]
    return bodies_of(engine.model.mesh, engine.own_mass, engine.ties, still, engine.bodies)


def quiet(model: Model) -> Model:
    """Return a model between two blows: no velocity, load or dashpot, no contact of what was thrown at each other."""
    return dataclasses.replace(
        model,
        velocity={},
        gravity=(0.0, 0.0, 0.0),
        boundaries=tuple(each for each in model.boundaries if not isinstance(each, LOADS)),
        contacts=tuple(each for each in model.contacts if stays(model, (each.first, each.second))),
        walls=tuple(each for each in model.walls if stays(model, (each.side,))),
        sections=(),
        points=(),
    )


def _left_of(ended: State, engine: Engine) -> dict[str, np.ndarray]:
    """Return the state that bodies which come to rest in place keep of the end of a run."""
    places = {name for name in ended if name.startswith(("elements/", "contact/", "wall/"))}
    known = state_of(engine)
    left = {name: ended[name] for name in (places | set(_placed(ended)) | {"x"}) if name in known}
    return left | {"v": np.zeros_like(ended["v"])}


def _placed(state: State) -> State:
    """Return centres and rotations of the rigid parts of a state."""
    return {n: value for n, value in state.items() if n.startswith("body/") and n.endswith(("/centre", "/turned"))}


def _take_over(engine: Engine, other: Engine, meet: bool) -> None:
    """Give an engine that has not begun the shape and the elements of another."""
    state = state_of(other)
    left = {name: value for name, value in state.items() if name.startswith("elements/")}
    put_back(engine, {**state_of(engine), **left, **_placed(state), "x": other.x})
    engine.detect_contacts(engine.x)
    if meet:
        engine.initialize()


def _bring_back(engine: Engine, bodies: Sequence[Body]) -> None:
    """Move each body back to where it began, its stress with it."""
    mesh = engine.model.mesh
    turns = np.broadcast_to(np.eye(3), (engine.elements, 3, 3)).copy()
    for body in bodies:
        turn, shift = way_back(body, mesh.points, engine.x)
        _move(engine, body, turn, shift)
        turns[np.isin(mesh.hexahedra[:, 0], body.nodes)] = turn
    for elements in engine.solid.kinds:
        elements.turn(turns)


def _move(engine: Engine, body: Body, turn: Array, shift: Array) -> None:
    """Move a body by R x + t."""
    engine.x[body.nodes] = engine.x[body.nodes] @ turn.T + shift
    for rigid in engine.bodies:
        if rigid.nodes[0] in body.nodes:
            rigid.centre, rigid.turned = turn @ rigid.centre + shift, turn @ rigid.turned


def _step_back(engine: Engine, bodies: Sequence[Body], first: Mapping[str, float]) -> float:
    """Move what strikes back, against its velocity, until it is nowhere deeper in another than at first; return m."""
    moved = 0.0
    for _ in range(STEPS_BACK):
        before = moved
        for name, sides in engine.model.touching.items():
            moved += _clear(engine, bodies, sides, _depths(engine).get(name, 0.0) - first.get(name, 0.0))
        if moved == before:
            break
    return moved


def _clear(engine: Engine, bodies: Sequence[Body], sides: Sequence[str], deep: float) -> float:
    """Move what strikes on two sides back by what it stands too deep; return m."""
    model = engine.model
    if deep <= ROUNDING * float(np.ptp(model.mesh.points, axis=0).max()) or stays(model, sides):
        return 0.0
    body = max((b for b in bodies if _in(b, sides)), key=lambda b: _speed(model, b))
    velocity = max((np.array(model.velocity.get(part, np.zeros(3))) for part in body.parts), key=np.linalg.norm)
    back = -CLEAR * deep / np.linalg.norm(velocity) * velocity
    _move(engine, body, np.eye(3), back)
    engine.detect_contacts(engine.x)
    return float(np.linalg.norm(back))


def _in(body: Body, sides: Sequence[str]) -> bool:
    return any((side.rpartition(".")[0] or side) in body.parts for side in sides)


def _speed(model: Model, body: Body) -> float:
    return max(float(np.linalg.norm(model.velocity.get(part, (0.0, 0.0, 0.0)))) for part in body.parts)


def _depths(engine: Engine) -> dict[str, float]:
    """Return the deepest overlap of each contact and wall that has one, m."""
    return {each.contact: each.deepest for each in engine.overlaps}


def _plastic(engine: Engine) -> float:
    return float(engine.solid.work()[1])


REPORT = 0.2  # as often as a bar on a screen is seen to move, at no cost
"""Seconds between two reports of progress."""

EVERY = 10  # a tenth of a usual run is lost at most
"""Instants of the histories after which a run keeps its state."""


class Progress(NamedTuple):
    """Progress of a run: time and duration (s), steps done, time step (s), seconds since the start, element-steps/s."""

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
        """Return its state, to be kept with that of the run."""

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take up the state of a run that goes on; raise ValueError for one that it never wrote."""


class Checkpoint(NamedTuple):
    """File in which a run keeps its state to go on from, and the instants of its histories between two."""

    path: Path
    every: int = EVERY


class RunOptions(NamedTuple):
    """Options of a run besides its histories."""

    frames: int = 0
    """Whole fields, equally spaced over the run, its end included; 0: none."""
    writer: Writer | None = None
    """Writer of the frames; they stay in memory where there is none."""
    later: Callable[[int], Writer | None] | None = None
    """Function that gives the writer of a later blow, by its number."""
    checkpoint: Checkpoint | None = None
    """File that keeps the state; None: none."""
    resume: Path | None = None
    """File of a run that was interrupted."""
    report: Callable[[Progress], None] | None = None
    """Function called with a `Progress` now and then."""
    observer: Observer | None = None
    """Such as `strikewave.fem.snapshots.SnapshotRecorder`."""
    device: Device | None = None
    """Device that takes the steps, such as `strikewave.fem.device.devices.Cuda`; None: the processor."""


def solve(model: Model, options: RunOptions | None = None) -> FemRun:
    """Run a model to the end of its first blow; `solve_blows` goes on from there.

    A run whose energy breaks, whose step collapses or whose numbers overflow stops early; ``stopped`` has the
    reason. Where all parts are rigid a step is as long as the interval of the histories.
    """
    return solve_blows(replace(model, controls=replace(model.controls, blows=1)), options)[0]


def solve_blows(model: Model, options: RunOptions | None = None) -> tuple[FemRun, ...]:
    """Run all blows of a model, each on the state that the one before left; none after one that stopped.

    See `strikewave.fem.solve`.
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
    """Return the instants of the histories at which whole fields are kept."""
    return sorted(set(np.linspace(0, controls.intervals, frames).round().astype(int).tolist())) if frames else []


def _of_blow(options: RunOptions, blow: int, controls: Controls) -> RunOptions:
    """Return the options of one of the blows: its own writer, its share of progress; only the first is filmed."""
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
        # Here the forces of the instant are not found yet: a run that goes on begins its loop with them.
        if options.checkpoint is not None and engine.goes_on:
            if engine.instant % options.checkpoint.every == 0:
                write_restart(options.checkpoint.path, engine, _seen(options))
            if engine.instant == instants and engine.blow < engine.model.controls.blows:
                write_restart(path_of_blow(options.checkpoint.path, engine.blow), engine, _seen(options))


def _seen(options: RunOptions) -> Mapping[str, np.ndarray]:
    """Return the state of the observer of a run, or nothing."""
    return {} if options.observer is None else options.observer.state()


def check_controls(model: Model) -> int:
    """Check what can be checked before anything is built; return the number of intervals."""
    lines = [str(fault) for fault in faults(model)]
    if lines:
        raise InputErrors(lines)
    return model.controls.intervals
