"""The fast run of the rotary machine: rigid between blows, whole bodies within them, and the blows as a table.

Between two blows nothing of what rings in frame and mounts is left that the blows could see, yet it holds a full
run (`strikewave.machines.rotary.run_rotary`) to steps of some 50 us. Here the object is one body and the strikers
ride on their steady circles until the next touch; see `_quick_kernels`.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact._integrator import Control, empty_record
from strikewave.contact.law import elastic_indentation
from strikewave.machines import _note_kernels as column
from strikewave.machines import _quick_kernels as kernels
from strikewave.machines._kernels import BASE_ROWS, LAYERED, ON_FACE, OWN_STATES, RotarySystem
from strikewave.machines._note_kernels import Notes
from strikewave.machines._quick_kernels import CoastSystem, Machine, Part, Riders, Train
from strikewave.machines.blows import DOUBLE_SHARE, GLANCING_SHARE
from strikewave.machines.feed import expected_time
from strikewave.machines.machine import RotaryMachine, places_of, rotary_system, start_state

Array = NDArray[np.float64]

QUIET_SHARE = 1e-2
"""A blow is over once the frame rings with this share of the energy of an object as fast as the nominal approach."""
STIFFEST_STOP = 1e-2
"""Largest square of the object's frequency on spring and stop over that of its frame."""
_SPARE_ROWS, _MOST_SAMPLES, _MOST_CONTACTS = 40, 8192, 64

WHY = {
    kernels.STUCK: "the motion could not be followed: a stiffness, damping or mass is extreme",
    kernels.AT_EDGE: "a striker met the edge of the face",
    kernels.CROWDED: "another striker touched while a blow still rang",
    kernels.TOO_MANY: "far more blows than wanted",
    kernels.LATE: "it took three times as long as expected: the turntable stalls",
}
"""Why a run failed, in words."""


@dataclass(frozen=True)
class QuickBlow:
    """One pass of one striker, all its contacts included, as `strikewave.machines.Blow`; SI, NaN where missed.

    Attributes
    ----------
    index, kind, striker, time, contacts, approach_speed, rigid_peak, width, velocity_change, turntable_speed
        As of a `Blow`.
    impulse : float
        Of the contacts.
    face_place, face_speed : float
        Of the struck face at first touch; its place at the apex where missed.
    angle : float
        Of the turntable at first touch, less that at which the striker stands in the strike position.
    retreat : float
        As of a `Blow`.
    stop_force : float
        Largest force of the stop until the next pass.
    """

    index: int
    kind: str
    striker: int
    time: float
    contacts: int
    approach_speed: float
    rigid_peak: float
    width: float
    velocity_change: float
    impulse: float
    face_place: float
    face_speed: float
    angle: float
    retreat: float
    stop_force: float
    turntable_speed: float


@dataclass(frozen=True, eq=False)
class QuickRun:
    """A fast run.

    Attributes
    ----------
    machine : RotaryMachine
        What ran, with its own feed.
    table : ndarray
        One row a pass, columns as `_quick_kernels` names them.
    end : float
        Time of the end, s.
    let_go : float
        Energy that still rang when blows were taken as over, J.
    energy_error : float
        Energy that the ledger misses, what was let go counted as lost, over the energy that flowed.
    steps : (int, int)
        Steps taken between blows and in blows.
    """

    machine: RotaryMachine
    table: Array
    end: float
    let_go: float
    energy_error: float
    steps: tuple[int, int]

    @property
    def kinds(self) -> list[str]:
        """full, glancing, double or missed, as in `strikewave.machines.Blow`."""
        return _kinds(self.machine, self.table)

    @property
    def blows(self) -> tuple[QuickBlow, ...]:
        """The passes in order of time, missed ones among them."""
        found = []
        for index, (kind, row) in enumerate(zip(self.kinds, self.table, strict=True), start=1):
            values = {name: float(row[k]) for name, k in _COLUMNS.items()}
            striker, contacts = int(row[column.STRIKER]) + 1, int(row[column.CONTACTS])
            found.append(QuickBlow(index=index, kind=kind, striker=striker, contacts=contacts, **values))
        return tuple(found)

    def column(self, name: str) -> Array:
        """Return one quantity of every pass, by the name that `QuickBlow` has for it."""
        return np.asarray(self.table[:, _COLUMNS[name]])


_COLUMNS = {
    "time": column.TIME,
    "approach_speed": column.APPROACH,
    "rigid_peak": column.PEAK,
    "width": column.WIDTH,
    "velocity_change": column.VELOCITY_CHANGE,
    "impulse": column.IMPULSE,
    "face_place": column.FACE,
    "face_speed": column.FACE_SPEED,
    "angle": column.ANGLE,
    "retreat": column.RETREAT,
    "stop_force": column.STOP_FORCE,
    "turntable_speed": column.DISC_SPEED,
}


def _finished(machine: RotaryMachine, noted: Array) -> Array:
    """Return the table of blows: a double one ends with its last release, a missed one has how far the face was off."""
    table = noted.copy()
    kinds = np.array(_kinds(machine, table), dtype=object)
    double, missed = kinds == "double", kinds == "missed"
    table[double, column.VELOCITY_CHANGE] = table[double, column.LAST_CHANGE]
    table[missed, column.RETREAT] = table[missed, column.FACE] + machine.engagement
    return table


def _kinds(machine: RotaryMachine, table: Array) -> list[str]:
    limit = GLANCING_SHARE * machine.nominal_approach
    return [_kind(row, limit) for row in table]


def _kind(row: Array, limit: float) -> str:
    """Return what a pass is, given the approach speed below which it is glancing."""
    if row[column.CONTACTS] == 0.0:
        return "missed"
    if row[column.APPROACH] < limit:
        return "glancing"
    return "double" if row[column.LATER] > DOUBLE_SHARE * row[column.IMPULSE] else "full"


def why_not(machine: RotaryMachine) -> str:
    """Return in words why a machine must not be run fast; nothing where it may.

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


def quick_run(
    machine: RotaryMachine,
    blows: int | None = None,
    tolerance: float = 1e-6,
    quiet: float = QUIET_SHARE,
    repeats: float = 0.0,
    least: int = 0,
) -> QuickRun:
    """Run a machine fast, from the valve signal to the end of the retraction.

    Parameters
    ----------
    machine : RotaryMachine
        What to run.
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
    asked = machine
    if blows is not None:
        machine = dataclasses.replace(machine, feed=dataclasses.replace(machine.feed, blows=blows, hold=math.inf))
    tables, going, struck = quick_tables(machine)
    notes = empty_notes(machine.feed.blows + _SPARE_ROWS)
    approach = machine.nominal_approach
    train = Train(quiet, 0.5 * machine.struck.mass * approach**2, 0 if blows is None else blows, repeats, least)
    before = _energy(machine, tables, going, 0.0)
    why, end = kernels.run_train(tables, going, struck, controls(machine, tolerance, going, struck), train, notes)
    if why != kernels.DONE:
        raise IntegrationError(f"at {end:.4g} s {WHY[why]}")
    gained = _energy(machine, tables, going, end) - before
    lost = float(notes.numbers[column.LET_GO])
    energies = going.y[2 + OWN_STATES :]
    dissipated = np.concatenate([energies[:-3], struck.y[6 + OWN_STATES : 9 + OWN_STATES]])
    driven, dragged, fed = energies[-3:]
    flowed = abs(driven) + dragged + np.abs(dissipated).sum() + abs(lost)
    missing = gained - (driven - dragged - dissipated.sum() - lost + fed)
    table = _finished(machine, notes.table[: notes.counts[column.ROWS_USED]])
    steps = int(notes.counts[column.COAST_STEPS]), int(notes.counts[column.BLOW_STEPS])
    return QuickRun(asked, table, float(end), lost, float(abs(missing) / flowed), steps)


def _energy(machine: RotaryMachine, tables: Machine, going: Part, time: float) -> float:
    """Return the energy of object, turntable, belt and motor, J."""
    energy, disc, y = float(kernels.rigid_energy(tables.coast, time, going)), machine.turntable, going.y
    if not disc.rigid_belt:
        energy += 0.5 * disc.belt_stiffness * float(y[4]) ** 2 + 0.5 * disc.motor_inertia * float(y[5]) ** 2
    return energy


def empty_notes(rows: int) -> Notes:
    """Return notes with room for so many passes."""
    counts = np.zeros(column.COUNTS, dtype=np.int64)
    counts[column.CURRENT] = -1
    samples, contacts = np.empty((2, _MOST_SAMPLES)), np.empty((_MOST_CONTACTS, 4))
    return Notes(np.full((rows, column.BLOW_COLUMNS), np.nan), samples, contacts, counts, np.zeros(column.NUMBERS))


def controls(machine: RotaryMachine, tolerance: float, going: Part, struck: Part) -> tuple[Control, Control]:
    """Return how to integrate what coasts and a blow."""
    approach, radius, q = machine.nominal_approach, machine.turntable.radius, machine.engagement
    depth = elastic_indentation(machine.strikers.first.contact, machine.struck.nose_mass, approach)
    pitch_time = machine.pitch / machine.turntable.speed
    end = 3.0 * expected_time(machine.feed, pitch_time)

    def scaled(states: int, bodies: int, place: float) -> Array:
        scale = np.zeros(states)
        scale[:bodies], scale[bodies : 2 * bodies] = place, approach
        own = scale[2 * bodies : 2 * bodies + OWN_STATES]
        own[::2], own[1::2] = place / radius, approach / radius
        return scale

    coast = Control(tolerance, scaled(going.y.size, 1, q), 5e-3 * pitch_time, 0.1 * pitch_time, end)
    blow = Control(tolerance, scaled(struck.y.size, 3, depth), 2e-3 * depth / approach, 0.02 * pitch_time, end)
    return coast, blow


def quick_tables(machine: RotaryMachine) -> tuple[Machine, Part, Part]:
    """Return a machine as the tables that the kernels take, and its two parts at the valve signal."""
    full, place, struck = rotary_system(machine), places_of(machine), machine.struck
    start, count = start_state(machine, full), machine.strikers.count
    full.settings[LAYERED] = 0.0
    held = slice(place.support, place.links)
    of_blow = np.r_[0, count, place.frame : place.links]
    nodes = {0: 0, place.nose: 1, place.assembly: 2, place.bodies: 3, place.bodies + count: 4}
    blow = RotarySystem(
        full.bodies[[0, place.nose, place.assembly]],
        np.zeros((BASE_ROWS, 2)),
        _renamed(full.joins[of_blow], nodes),
        full.values[of_blow],
        full.seats[:1].copy(),
        full.settings,
    )
    stretches = full.bodies[:count, 0] / np.array([s.mount_stiffness for s in machine.strikers.each])
    frame = np.array([struck.nose_mass, struck.frame_stiffness, struck.gravity, struck.nose_mass / struck.mass])
    coast = CoastSystem(
        np.array([[struck.mass, struck.gravity, 0.0]]),
        np.zeros((BASE_ROWS, 1)),
        _renamed(full.joins[held], {place.assembly: 0, place.bodies + count: 1}),
        full.values[held].copy(),
        np.zeros((0, 3)),
        full.settings,
        np.column_stack([full.seats, stretches]),
        np.zeros(count),
        frame,
    )
    riders = Riders(
        full.values[place.contacts].copy(),
        full.values[place.mounts].copy(),
        full.seats,
        full.bodies[:count, 0].copy(),
        start.memory[place.depths][:count].copy(),
        np.ones(count),
    )
    going = _part(1, len(coast.joins), count + 1)
    going.y[0] = start.y[place.assembly]
    going.y[2 : 2 + OWN_STATES] = start.y[place.angle : place.energies]
    going.mode[:-1] = start.mode[place.support :]
    going.memory[len(coast.joins) : len(coast.joins) + 2] = start.memory[place.own_memory]
    return Machine(coast, blow, riders), going, _part(3, len(blow.joins), 1)


def _renamed(joins: NDArray[np.int64], nodes: dict[int, int]) -> NDArray[np.int64]:
    """Return joins with other numbers for their nodes."""
    return np.array([[kind, nodes[int(behind)], nodes[int(ahead)]] for kind, behind, ahead in joins], dtype=np.int64)


def _part(bodies: int, links: int, more_modes: int) -> Part:
    """Return a part of so many bodies and links at rest; what has not yielded has not grown."""
    states, modes, memories = 2 * bodies + OWN_STATES + links + 3, links + ON_FACE + more_modes, 3 * links + 2
    memory = np.zeros(memories)
    memory[-links:] = 1.0
    record = empty_record(kernels.RECORD_ROWS, states, modes, memories)
    return Part(np.zeros(states), np.zeros(modes, dtype=np.int64), memory, record)
