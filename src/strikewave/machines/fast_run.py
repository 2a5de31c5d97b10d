"""The fast run of the rotary machine: rigid between blows, whole bodies within them, and the blows as a table.

Between two blows nothing of what rings in frame and mounts is left that the blows could see, yet it holds a full
run (`strikewave.machines.run.run_machine`) to steps of some 50 us. Here the object is one body and the strikers
ride on their steady circles until the next touch; see `_train_kernels`.
"""

from __future__ import annotations

import math
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.compiling import await_kernel, compiled_beside
from strikewave.base.errors import IntegrationError
from strikewave.contact._chain_kernels import AHEAD, BEHIND, MASS, ChainTables
from strikewave.contact._integrator import Control, empty_record
from strikewave.contact.law import elastic_indentation
from strikewave.machines import _kernels, _pass_kernels, _train_kernels
from strikewave.machines import _pass_kernels as column
from strikewave.machines import _train_kernels as kernels
from strikewave.machines._kernels import BASE_ROWS, STOP_AT_TOUCH, MachineSystem
from strikewave.machines._layout import OBJECT, layout_of
from strikewave.machines._pass_kernels import PassTable
from strikewave.machines._train_kernels import MountedStrikers, Part, Train, TrainTables
from strikewave.machines.blows import DOUBLE_SHARE, GLANCING_SHARE
from strikewave.machines.drive import expected_time
from strikewave.machines.machine import Machine, machine_system, start_state

Array = NDArray[np.float64]

QUIET_SHARE = 1e-2
"""Share of the energy of an object as fast as the nominal approach that the frame still rings with when a blow is over
(chosen: a tenth of the amplitude)."""
STIFFEST_STOP = 1e-2  # chosen: it swings ten times more slowly than the frame rings, so that it counts as one body
"""Largest square of the object's frequency on spring and stop over that of its frame."""
# Chosen, far more than any has; samples and contacts beyond are not written down, and a table that is full ends the
# run with a reason.
_SPARE_ROWS, _MOST_SAMPLES, _MOST_CONTACTS = 40, 8192, 64
"""Rows for passes beyond the wanted blows, samples and contacts of a blow."""

WHY = {
    kernels.STUCK: "the motion could not be followed: a stiffness, damping or mass is extreme",
    kernels.AT_EDGE: "a striker met the edge of the face",
    kernels.CROWDED: "another striker touched while a blow still rang",
    kernels.TOO_MANY: "far more blows than wanted",
    kernels.LATE: "it took three times as long as expected: the turntable stalls",
}
"""Reason in words for each code of a run that failed."""


@dataclass(frozen=True)
class TrainBlow:
    """One pass of one striker, all its contacts included; SI, NaN where missed. Names of a `Blow` mean the same."""

    index: int
    kind: str
    striker: int
    time: float
    contacts: int
    approach_speed: float
    rigid_peak: float
    width: float
    velocity_change: float
    blow_velocity_change: float
    impulse: float
    contact_impulse: float
    """As of a `Blow`."""
    face_place: float
    """Place of the struck face at first touch; at the apex where missed."""
    face_speed: float
    """Speed of the struck face at first touch."""
    angle: float
    """Angle of the turntable at first touch, less that at which the striker stands in the strike position."""
    largest_displacement: float
    """As of a `Blow`."""
    stop_force: float
    """Largest force of the stop until the next pass."""
    turntable_speed: float
    """As of a `Blow`."""


@dataclass(frozen=True, eq=False)
class FastTrain:
    """A fast run."""

    machine: Machine
    """Machine that ran, with its own feed."""
    table: Array
    """One row a pass, columns as `_train_kernels` names them."""
    end: float
    """Time of the end, s."""
    let_go: float
    """Energy that still rang when blows were taken as over, J."""
    energy_error: float
    """Energy that the balance misses, with the energy let go as lost, over the energy that flowed."""
    steps: tuple[int, int]
    """Steps taken between blows and in blows."""

    @property
    def kinds(self) -> list[str]:
        """full, glancing, double or missed, as in `strikewave.machines.Blow`."""
        return _kinds(self.machine, self.table)

    @property
    def blows(self) -> tuple[TrainBlow, ...]:
        """The passes in order of time, missed ones among them."""
        listed = []
        for index, (kind, row) in enumerate(zip(self.kinds, self.table, strict=True), start=1):
            values = {name: float(row[k]) for name, k in _COLUMNS.items()}
            striker, contacts = int(row[column.STRIKER]) + 1, int(row[column.CONTACTS])
            values["impulse"] = self.machine.struck.mass * values["blow_velocity_change"]
            listed.append(TrainBlow(index=index, kind=kind, striker=striker, contacts=contacts, **values))
        return tuple(listed)

    def column(self, name: str) -> Array:
        """Return one quantity of every pass, by the name that `TrainBlow` has for it."""
        return np.asarray(self.table[:, _COLUMNS[name]])


_COLUMNS = {
    "time": column.TIME,
    "approach_speed": column.APPROACH,
    "rigid_peak": column.PEAK,
    "width": column.WIDTH,
    "velocity_change": column.VELOCITY_CHANGE,
    "blow_velocity_change": column.BLOW_CHANGE,
    "contact_impulse": column.BLOW_IMPULSE,
    "face_place": column.FACE,
    "face_speed": column.FACE_SPEED,
    "angle": column.ANGLE,
    "largest_displacement": column.LARGEST_DISPLACEMENT,
    "stop_force": column.STOP_FORCE,
    "turntable_speed": column.DISC_SPEED,
}


def _finished(machine: Machine, noted: Array) -> Array:
    """Return the table of blows: a double one ends with its last release, a missed one has the distance of its face."""
    table = noted.copy()
    kinds = np.array(_kinds(machine, table), dtype=object)
    double, missed = kinds == "double", kinds == "missed"
    table[double, column.BLOW_CHANGE] = table[double, column.LAST_CHANGE]
    table[double, column.BLOW_IMPULSE] = table[double, column.IMPULSE]
    table[missed, column.LARGEST_DISPLACEMENT] = table[missed, column.FACE] + machine.engagement
    return table


def _kinds(machine: Machine, table: Array) -> list[str]:
    """Return the kind of each pass, by the rules of `strikewave.machines.blows._kind`."""
    kinds = [
        (table[:, column.CONTACTS] == 0.0, "missed"),
        (table[:, column.APPROACH] < GLANCING_SHARE * machine.nominal_approach, "glancing"),
        (table[:, column.LATER] > DOUBLE_SHARE * table[:, column.IMPULSE], "double"),
    ]
    return np.select([rows for rows, _ in kinds], [name for _, name in kinds], "full").tolist()


def why_not(machine: Machine) -> str:
    """Return the reason in words against a fast run of a machine; nothing where it may run fast.

    The object counts as one body between blows: on spring and stop it must swing far more slowly than its frame
    rings, (k + k_stop)/M over k_frame M/(m_nose m_assembly) at most `STIFFEST_STOP`.
    """
    struck = machine.struck
    if machine.launch is not None:
        return "the machine strikes once, without a turntable that turns on"
    if machine.layered is not None:
        return "the object is a stack of layers, in which waves run"
    reduced = struck.nose_mass * struck.assembly_mass / struck.mass
    ratio = (struck.spring + struck.stop_stiffness) / struck.mass * reduced / struck.frame_stiffness
    if ratio > STIFFEST_STOP:
        return (
            f"on spring and stop the object swings at {math.sqrt(ratio):.2g} of its frame's frequency: "
            f"at most {math.sqrt(STIFFEST_STOP):g}, or it is no single body"
        )
    return ""


def fast_train(
    machine: Machine,
    blows: int | None = None,
    tolerance: float = 1e-6,
    quiet: float = QUIET_SHARE,
    repeats: float = 0.0,
    least: int = 0,
) -> FastTrain:
    """Run a machine fast, from the valve signal to the end of the retraction.

    Parameters
    ----------
    machine : Machine
        Machine to run.
    blows : int, optional
        Stop after so many passes, whatever the feed's own number and hold, without the retraction.
    tolerance : float, optional
        Local error of a step, over the scales of one contact in a blow and over the engagement between blows.
    quiet : float, optional
        Share of ringing energy at which a blow is over.
    repeats : float, optional
        Stop once blows repeat within this tolerance of approach speed and angle; 0 never stops.
    least : int, optional
        Blows before which repeats are not looked for.

    Raises
    ------
    ValueError
        If the machine must not be run fast (`why_not`), or its drive cannot hold the speed.
    IntegrationError
        If the run fails; in words, why.
    """
    reason = why_not(machine)
    if reason:
        raise ValueError(reason)
    own = machine
    if blows is not None:
        machine = machine.with_feed(blows=blows, hold=math.inf)
    tables, going, struck = train_tables(machine)
    passes = empty_passes(machine.drive.feed.blows + _SPARE_ROWS)
    approach = machine.nominal_approach
    train = Train(quiet, 0.5 * machine.struck.mass * approach**2, 0 if blows is None else blows, repeats, least)
    before = _energy(machine, tables, going, 0.0)
    why, end = kernels.run_train(tables, going, struck, controls(machine, tolerance, tables), train, passes)
    if why != kernels.DONE:
        raise IntegrationError(f"at {end:.4g} s {WHY[why]}")
    gained = _energy(machine, tables, going, end) - before
    lost = float(passes.numbers[column.LET_GO])
    circling, at = layout_of(tables.flight), layout_of(tables.blow)
    of_blow = struck.y[at.dissipated]
    dissipated = np.concatenate(
        [going.y[circling.dissipated], of_blow[at.contacts], of_blow[at.mounts], of_blow[at.frame : at.support]]
    )
    driven, dragged, fed, rubbed = going.y[circling.of_drive]
    flowed = abs(driven) + dragged + rubbed + np.abs(dissipated).sum() + abs(lost)
    missing = gained - (driven - dragged - rubbed - dissipated.sum() - lost + fed)
    table = _finished(machine, passes.table[: passes.counts[column.ROWS_USED]])
    steps = int(passes.counts[column.FLIGHT_STEPS]), int(passes.counts[column.BLOW_STEPS])
    return FastTrain(own, table, float(end), lost, float(abs(missing) / flowed), steps)


def _energy(machine: Machine, tables: TrainTables, going: Part, time: float) -> float:
    """Return the energy of object, turntable, belt and motor, J."""
    energy, disc = float(kernels.rigid_energy(tables.flight, time, going)), machine.drive.turntable
    if not disc.rigid_belt:
        at = layout_of(tables.flight)
        twist, motor = float(going.y[at.belt_twist]), float(going.y[at.motor_speed])
        energy += 0.5 * disc.belt_stiffness * twist**2 + 0.5 * disc.motor_inertia * motor**2
    return energy


def empty_passes(rows: int) -> PassTable:
    """Return passes with room for so many passes."""
    counts = np.zeros(column.COUNTS, dtype=np.int64)
    counts[column.CURRENT] = -1
    samples, contacts = np.empty((3, _MOST_SAMPLES)), np.empty((_MOST_CONTACTS, 4))
    return PassTable(np.full((rows, column.BLOW_COLUMNS), np.nan), samples, contacts, counts, np.zeros(column.NUMBERS))


def controls(machine: Machine, tolerance: float, tables: TrainTables) -> tuple[Control, Control]:
    """Return the controls of the integrator in free flight and in a blow."""
    approach, radius, q = machine.nominal_approach, machine.radius, machine.engagement
    depth = elastic_indentation(machine.strikers.first.contact, machine.struck.nose_mass, approach)
    pitch_time = machine.pitch / machine.drive.turntable.speed
    end = 3.0 * expected_time(machine.drive.feed, pitch_time)

    def scaled(system: MachineSystem, place: float) -> Array:
        at = layout_of(system)
        scale = np.zeros(at.states)
        scale[at.positions], scale[at.speeds] = place, approach
        scale[[at.angle, at.belt_twist]] = place / radius
        scale[[at.turntable_speed, at.motor_speed]] = approach / radius
        return scale

    flight = Control(tolerance, scaled(tables.flight, q), 5e-3 * pitch_time, 0.1 * pitch_time, end)
    blow = Control(tolerance, scaled(tables.blow, depth), 2e-3 * depth / approach, 0.02 * pitch_time, end)
    return flight, blow


def train_tables(machine: Machine) -> tuple[TrainTables, Part, Part]:
    """Return a machine as the tables that the kernels take, and its two parts at the valve signal."""
    full, struck = machine_system(machine), machine.struck
    at, chain, start = layout_of(full), full.chain, start_state(machine, full)
    full.settings[STOP_AT_TOUCH] = 0.0
    nodes, links = np.arange(len(chain.bodies) + chain.bases.shape[1]), np.arange(len(chain.joins))
    of_bodies, of_bases = nodes[: len(chain.bodies)], nodes[len(chain.bodies) :]
    carriage, supports = of_bases[at.carriage], links[at.support :]
    bodies = np.r_[of_bodies[at.strikers][0], of_bodies[at.object]]
    of_blow = np.r_[links[at.contacts][0], links[at.mounts][0], links[at.frame], supports]
    in_blow = [*bodies, of_bases[0], carriage]
    blow = MachineSystem(_part_of(chain, chain.bodies[bodies], of_blow, in_blow), full.seats[:1].copy(), full.settings)
    masses = chain.bodies[at.strikers, MASS]
    stretches = masses / np.array([s.mount_stiffness for s in machine.strikers.each])
    frame = struck.nose_mass, struck.frame_stiffness, struck.gravity, struck.nose_mass / struck.mass
    flight = MachineSystem(
        _part_of(chain, np.array([[struck.mass, struck.gravity, 0.0]]), supports, [at.assembly, carriage]),
        np.column_stack([full.seats, stretches, np.zeros(machine.strikers.count)]),
        np.r_[full.settings, frame],
    )
    mounted = MountedStrikers(
        chain.values[at.contacts].copy(),
        chain.values[at.mounts].copy(),
        full.seats,
        masses.copy(),
        start.memory[at.depths][at.contacts].copy(),
        np.ones(machine.strikers.count),
    )
    going, circling = _at_rest(flight), layout_of(flight)
    going.y[circling.positions][OBJECT] = start.y[at.positions][at.assembly]
    going.y[circling.turntable] = start.y[at.turntable]
    going.mode[circling.held_modes], going.mode[circling.on_face] = start.mode[at.held_modes], start.mode[at.on_face]
    going.memory[circling.own_memory] = start.memory[at.own_memory]
    return TrainTables(flight, blow, mounted), going, _at_rest(blow)


def _part_of(chain: ChainTables, bodies: Array, links: NDArray[np.int64], nodes: list[int]) -> ChainTables:
    """Return some links of a chain between other bodies and bases, with the remaining nodes in their new order."""
    joins = chain.joins[links].copy()
    for end in (BEHIND, AHEAD):
        joins[:, end] = [nodes.index(node) for node in joins[:, end]]
    return ChainTables(bodies, np.zeros((BASE_ROWS, len(nodes) - len(bodies))), joins, chain.values[links].copy())


def _at_rest(system: MachineSystem) -> Part:
    """Return a part at rest, its spots not yielded: their radius has grown by 1."""
    at = layout_of(system)
    memory = np.zeros(at.memories)
    memory[at.growths] = 1.0
    record = empty_record(kernels.RECORD_ROWS, at.states, at.modes, at.memories)
    return Part(np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), memory, record)


def fast_run_beside() -> AbstractContextManager[None]:
    """Return the context that compiles the fast run in a second process while a full run goes on within."""
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
    parts = (
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
    for kernel, arguments in parts:
        _compile(kernel, arguments)
    await_kernel("_integrator.advance")
    all_tables = TrainTables(system, system, mounted), part, part, (control, control), train, passes
    _compile(_train_kernels.run_train, all_tables)


def _compile(kernel: Any, arguments: tuple[Any, ...]) -> None:
    from numba import typeof

    kernel.compile(tuple(typeof(argument) for argument in arguments))
