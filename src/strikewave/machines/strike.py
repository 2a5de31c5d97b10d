"""One blow on a stack: from the bodies at first touch to waves, and back once all is quiet.

During a blow the contact law acts on the first face of the stack, its waves run, and spring, damper and
stop hold its end. Once all is quiet the parts before and behind the frame go on as the two bodies of
`StruckObject`, with their momentum and mean place, the frame bent no more than the stack's energy allows; the
energy still ringing is let go and counted as lost.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact._chain_kernels import (
    AHEAD,
    BEHIND,
    MASS,
    OPEN,
    PLACE,
    SLIDING_FORCE,
    SPEED,
    STICKING_FORCE,
    ChainTables,
    Links,
    remember,
)
from strikewave.contact._law_kernels import DAMPING, OFFSET, PRELOAD, STIFFNESS, YIELD_LOAD
from strikewave.contact.chain import stored_energy
from strikewave.contact.motion import MotionState
from strikewave.machines import _stack_kernels as column
from strikewave.machines._kernels import ACROSS, HALF_FACE, MachineSystem, place_bases
from strikewave.machines._layout import layout_of
from strikewave.machines._stack_kernels import COLUMNS, CROWDED, ENDLESS, BlowNotes, StackBlow, Supports, follow
from strikewave.machines.machine import modes_at, nodes_at
from strikewave.machines.spans import StackSpan, TapHistories
from strikewave.machines.struck_object import LayeredObject, StruckObject
from strikewave.waves import _kernels as waves
from strikewave.waves._kernels import ELASTIC, LOST, RESISTANCE, Averages, Recording, Tables
from strikewave.waves._kernels import MASS as POINT_MASS
from strikewave.waves._kernels import WaveState as Waves
from strikewave.waves.transit import (
    TimeGrid,
    empty_averages,
    field_nodes,
    from_within,
    mean_acceleration,
    nearest_nodes,
    state_at_rest,
    tables_of,
)

Array = NDArray[np.float64]

SETTLE = 0.5e-3  # chosen: a wave in steel runs 2.5 m meanwhile
"""Time after the last release for which a stack is followed, s."""
SAMPLE_STEP, FIELD_STEP = 0.1e-6, 1e-6  # chosen: 10 MHz, above any sensor's, and a picture
"""Spacing of the histories of a blow, and of its x-t field, s."""
LONGEST_BLOW = 10e-3  # chosen: a hundred times that of metal; its history takes 13 MB
"""Longest blow in touch, s."""
_MOST_TOUCHES, _MOST_SWITCHES = 64, 16  # chosen, far more than any has
"""Most touches and switches of a blow that are written down."""


def kept_step(grid: TimeGrid) -> float:
    """Return the spacing of the histories of a blow, s: whole steps, near `SAMPLE_STEP`."""
    return max(1, round(SAMPLE_STEP / grid.step)) * grid.step


def strike(
    layered: LayeredObject, struck: StruckObject, system: MachineSystem, start: MotionState, field: bool = False
) -> tuple[StackSpan, MotionState]:
    """Follow one blow on a stack, from the state at first touch to the state once it has settled.

    Parameters
    ----------
    layered : LayeredObject
        Layers of the struck object.
    struck : StruckObject
        The same as bodies, with what supports it.
    system : MachineSystem
        The machine with these bodies.
    start : MotionState
        State of the machine at first touch.
    field : bool, optional
        True to keep the x-t field.

    Raises
    ------
    IntegrationError
        If two strikers touch at once, or the contact lasts beyond `LONGEST_BLOW`.
    """
    going = _Strike(layered, struck, system, start)
    step = layered.grid.step
    every = round(kept_step(layered.grid) / step)
    rows = int(LONGEST_BLOW / step / every) + 1
    taps, field_rows, places = going.recordings(rows, every, field)
    averages = empty_averages(taps.nodes[:-2], taps.nodes[-2:], every, rows)
    still = np.array([waves.force_and_velocity(going.tables, going.waves, *node)[1] for node in taps.nodes[:-2]])
    history, touches, switches = np.zeros((rows, COLUMNS)), np.zeros((_MOST_TOUCHES, 3)), np.zeros((_MOST_SWITCHES, 2))
    notes = BlowNotes(history, touches, switches)
    machine, blow = going.strikers_alone(), going.blow(every)
    law, supports = system.chain.values[going.striker], going.supports
    why, steps, contacts, changed, u_end, net, energies, deepest = follow(
        going.tables, going.waves, law, machine, supports, blow, (taps, field_rows), averages, notes
    )
    if why == CROWDED:
        raise IntegrationError("two strikers touch the object at once: take fewer strikers, or less engagement")
    if why == ENDLESS:
        raise IntegrationError(
            f"a blow on the stack lasts longer than {LONGEST_BLOW * 1e3:g} ms: the contact or its mount is too soft"
        )
    samples = (steps - 1) // every + 1
    last = history[samples - 1]
    gained = waves.momentum(going.tables, going.waves) - going.momentum
    span = StackSpan(
        struck=struck,
        begin=start.time,
        step=every * step,
        striker=going.striker,
        history=history[:samples].copy(),
        taps=_tap_histories(taps, averages, still, samples, every * step),
        rigid_acceleration=_mean_push(taps, averages, samples) / layered.assembly_mass + struck.sensed_gravity,
        field_position=places,
        field_step=field_rows.every * step,
        field_force=field_rows.force[: (steps - 1) // field_rows.every + 1].copy(),
        frame=(going.speed, struck.gravity),
        touches=touches[: min(contacts, _MOST_TOUCHES)],
        switched=switches[: min(changed, _MOST_SWITCHES)],
        momentum_error=float(abs(net - gained) / last[column.CONTACT_IMPULSE]),
        yielded=float(deepest) if math.isfinite(law[YIELD_LOAD]) else 0.0,
        rubbed=float(start.y[layout_of(system).rubbed]),
    )
    end = going.state_after(start.time + (steps - 1) * step, last, machine)
    if math.isfinite(law[YIELD_LOAD]):
        remember(system.chain, going.striker, end.memory, deepest)
    going.settle_accounts(end, last, machine, u_end, energies)
    return span, end


Alone = tuple[MachineSystem, Array, NDArray[np.int64], Array]
"""The machine without the object: system, state, modes, memory."""


class _Strike:
    """One blow: the state at first touch, and the stack in its moving frame."""

    def __init__(self, layered: LayeredObject, struck: StruckObject, system: MachineSystem, start: MotionState) -> None:
        self.layered, self.struck, self.system, self.start = layered, struck, system, start
        self.layout = at = layout_of(system)
        place_bases(system, start.time, start.y, start.mode, start.memory)
        self.striker = int(np.flatnonzero(start.mode[at.contacts] != OPEN)[0])
        self.x, self.v = start.y[at.positions], start.y[at.speeds]
        masses = np.array([layered.nose_mass, layered.assembly_mass])
        self.speed = float(masses @ self.v[at.object] / masses.sum())
        self.relative = self.v[at.object] - self.speed
        self.supports = _supports(system)
        self.tables, self.waves = tables_of(layered.stack, layered.grid), state_at_rest(layered.stack, layered.grid)
        carriage, carriage_speed = (float(system.chain.bases[row, at.carriage]) for row in (PLACE, SPEED))
        end_force = _end_force(self.supports, float(self.x[at.assembly]) - carriage, self.speed - carriage_speed)
        _settle_in(layered, self.tables, self.waves, end_force, self.relative)
        self.momentum = waves.momentum(self.tables, self.waves)
        self.ringing = self._beyond_bodies(start, self.speed, float(self.x[at.assembly]), self.relative)

    def recordings(self, rows: int, every: int, field: bool) -> tuple[Recording, Recording, Array]:
        """Return empty recordings of taps and both faces of the assembly, and of the x-t field; its places, m."""
        grid = self.layered.grid
        assembly = ((self.layered.first_of_assembly, 0.0), (len(self.layered.stack.layers) - 1, 1.0))
        nodes = nearest_nodes(grid, (*self.layered.taps, *assembly))
        watched, places = field_nodes(self.layered.stack, grid) if field else (nodes[:0], np.empty(0))
        coarse = every * max(1, round(FIELD_STEP / (every * grid.step)))
        taps = Recording(nodes, every, np.zeros((rows, len(nodes))), np.zeros((rows, len(nodes))))
        size = rows * every // coarse + 1
        field_rows = Recording(watched, coarse, np.zeros((size, len(watched))), np.zeros((size, len(watched))))
        return taps, field_rows, places

    def strikers_alone(self) -> Alone:
        """Return the machine without the object: system, state, modes, memory."""
        machine, start, system = self.layout, self.start, _strikers_only(self.system)
        at = layout_of(system)
        y, mode, memory = np.zeros(at.states), np.empty(at.modes, dtype=np.int64), np.zeros(at.memories)
        y[at.positions], y[at.speeds] = self.x[machine.strikers], self.v[machine.strikers]
        y[at.turntable] = start.y[machine.turntable]
        mode[at.mounts], mode[at.own_modes] = start.mode[machine.mounts], start.mode[machine.own_modes]
        memory[at.approaches], memory[at.own_memory] = start.memory[machine.mounts], start.memory[machine.own_memory]
        memory[at.growths] = 1.0
        return system, y, mode, memory

    def blow(self, every: int) -> StackBlow:
        """Return the blow as the kernel takes it."""
        return StackBlow(
            striker=self.striker,
            approach=float(self.start.memory[self.striker]),
            time=self.start.time,
            speed=self.speed,
            gravity=self.struck.gravity,
            face=float(self.x[self.layout.nose]),
            end=float(self.x[self.layout.assembly]),
            first_of_assembly=self.layered.first_of_assembly,
            nose_mass=self.layered.nose_mass,
            assembly_mass=self.layered.assembly_mass,
            nose_speed=float(self.relative[0]),
            assembly_speed=float(self.relative[1]),
            settle=SETTLE,
            every=every,
            deepest=float(self.start.memory[self.layout.depths][self.striker]),
        )

    def state_after(self, time: float, last: Array, machine: Alone) -> MotionState:
        """Return the state of the machine with two bodies, its modes and energies still those of before."""
        at, (alone, moved, mode, memory) = self.layout, machine
        of = layout_of(alone)
        end = MotionState(time, self.start.y.copy(), self.start.mode.copy(), self.start.memory.copy())
        x, v = end.y[at.positions], end.y[at.speeds]
        x[at.strikers], v[at.strikers] = moved[of.positions], moved[of.speeds]
        x[at.nose], x[at.assembly] = last[column.NOSE_PLACE], last[column.ASSEMBLY_PLACE]
        v[at.nose], v[at.assembly] = last[column.NOSE_SPEED], last[column.ASSEMBLY_SPEED]
        end.y[at.turntable] = moved[of.turntable]
        end.mode[at.own_modes], end.memory[at.own_memory] = mode[of.own_modes], memory[of.own_memory]
        place_bases(self.system, time, end.y, end.mode, end.memory)
        half = self.system.settings[HALF_FACE]
        end.mode[at.on_face] = np.abs(self.system.chain.bases[ACROSS, at.strikers]) <= half
        return end

    def settle_accounts(
        self, end: MotionState, last: Array, machine: Alone, u_end: float, energies: tuple[float, ...]
    ) -> None:
        """Let the stack's ringing go, set the modes of the links, and book every energy of the blow."""
        at, gravity, (alone, moved, _, _) = self.layout, self.struck.gravity, machine
        lost_stop, lost_damper, lost_rail, lost, fed, push_ends = energies
        since = end.time - self.start.time
        frame = self.speed + gravity * since
        stands = float(self.x[at.assembly]) + (self.speed + 0.5 * gravity * since) * since + u_end
        relative = last[[column.NOSE_SPEED, column.ASSEMBLY_SPEED]] - frame
        left = self._beyond_bodies(end, frame, stands, relative)
        if left < 0.0:
            _ease(self.system, end, -left)
            left = self._beyond_bodies(end, frame, stands, relative)
        end.mode[at.link_modes] = modes_at(self.system, end.y, end.memory[at.depths])
        end.mode[at.contacts] = OPEN
        of, dissipated = layout_of(alone), end.y[at.dissipated]
        dissipated[at.contacts][self.striker] += lost
        dissipated[at.mounts] += moved[of.dissipated]
        dissipated[at.frame] += left + push_ends - self.ringing + float(self.waves.joint[:, LOST].sum())
        dissipated[at.support] += lost_damper
        dissipated[at.stop] += lost_stop
        if at.rubs:
            dissipated[at.rail] += lost_rail
        end.y[at.of_drive] += moved[of.of_drive]
        end.y[at.fed] += fed

    def _beyond_bodies(self, bodies: MotionState, speed: float, stands: float, relative: Array) -> float:
        """Return the energy of the object as a stack less that as two bodies, J.

        ``speed`` is that of the stack's frame, ``stands`` the place of its end, ``relative`` the speeds of nose and
        assembly in the frame. Both views have the same momentum and height; they differ in ringing, and in
        where the end stands.
        """
        at, chain = self.layout, self.system.chain
        masses = chain.bodies[at.object, MASS]
        of_object = [at.frame, at.support, at.stop]
        frame_too, supports = (Links(chain.joins[k], chain.values[k]) for k in (of_object, of_object[1:]))
        nodes = nodes_at(self.system, bodies.y)
        v = bodies.y[at.speeds][at.object]
        as_bodies = 0.5 * float(masses @ v**2) + stored_energy(frame_too, nodes)
        nodes[at.assembly] = stands
        moving = 0.5 * float(masses.sum()) * speed**2 + speed * float(masses @ relative)
        return waves.energy(self.tables, self.waves) + moving + stored_energy(supports, nodes) - as_bodies


def _tap_histories(taps: Recording, averages: Averages, still: Array, samples: int, step: float) -> TapHistories:
    """Return the histories of the taps; the stack stood ``still`` (velocities, m/s) before first touch."""
    force, velocity = taps.force[:samples, : still.size].copy(), taps.velocity[:samples, : still.size].copy()
    means = averages.velocity[: samples - 1]
    last = 2.0 * (velocity[-1] - means[-1]) / step
    return TapHistories(force, velocity, np.vstack([mean_acceleration(means, still, step), last]))


def _mean_push(taps: Recording, averages: Averages, samples: int) -> Array:
    """Return the average force on the assembly about each kept step, N: the last two nodes are its faces."""
    force, means = taps.force[:samples, -2:], averages.force[:samples]
    for end in (0, -1):
        means[end] = from_within(means[end], force[end], averages.every)
    return np.asarray(means[:, 0] - means[:, 1])


def _ease(system: MachineSystem, bodies: MotionState, energy: float) -> None:
    """Take an energy out of the frame's bend, as far as there is any; the centre of mass stays.

    Parts that an open joint let fly apart stand farther from each other than the frame is bent.
    """
    at, chain = layout_of(system), system.chain
    masses, x = chain.bodies[at.object, MASS], bodies.y[at.positions]
    bend = x[at.nose] - x[at.assembly]
    remaining = 1.0 - energy / (0.5 * chain.values[at.frame, STIFFNESS] * bend**2) if bend else 0.0
    less = bend * (1.0 - math.sqrt(max(remaining, 0.0)))
    x[at.nose] -= less * masses[1] / masses.sum()
    x[at.assembly] += less * masses[0] / masses.sum()


def _supports(system: MachineSystem) -> Supports:
    """Return the supports of the end, from the links of the machine."""
    at, values = layout_of(system), system.chain.values
    spring, stop = values[at.support], values[at.stop]
    rail = values[at.rail, [SLIDING_FORCE, STICKING_FORCE]] if at.rubs else (0.0, 0.0)
    numbers = [*spring[[STIFFNESS, PRELOAD, DAMPING, OFFSET]], *stop[[STIFFNESS, DAMPING, OFFSET]], *rail]
    return Supports(*(float(number) for number in numbers))


def _end_force(supports: Supports, place: float, speed: float) -> float:
    """Return the force of spring, damper and stop on an end at a place and speed from the carriage, N."""
    spring = supports.preload + supports.spring * (place - supports.rest) + supports.damper * speed
    deep = -place - supports.stop_offset
    stop = max(supports.stop * deep - supports.stop_damping * speed, 0.0) if deep > 0.0 else 0.0
    return spring - stop


def _strikers_only(system: MachineSystem) -> MachineSystem:
    """Return the machine with its strikers on their mounts alone; nodes are strikers, then bases."""
    at, chain = layout_of(system), system.chain
    bodies, joins = chain.bodies[at.strikers].copy(), chain.joins[at.mounts].copy()
    nodes = joins[:, [BEHIND, AHEAD]]
    joins[:, [BEHIND, AHEAD]] = np.where(nodes >= len(bodies), nodes - (len(chain.bodies) - len(bodies)), nodes)
    alone = ChainTables(bodies, chain.bases.copy(), joins, chain.values[at.mounts].copy())
    return MachineSystem(alone, system.seats, system.settings)


def _settle_in(layered: LayeredObject, tables: Tables, state: Waves, end_force: float, relative: Array) -> None:
    """Fill the waves of a stack that moves as two rigid parts while its end is held by a force.

    The force in a section is the share of the mass before it, f = end_force m(s)/m, so that the stack starts
    without ringing; across an open gap it would not hold together, and the stack starts free of force.
    """
    stack = layered.stack
    total, passed = layered.nose_mass + layered.assembly_mass, 0.0
    if any(joint.gap > 0.0 for joint in stack.joints):
        end_force = 0.0
    for i, layer in enumerate(stack.layers):
        v = float(relative[0 if i < layered.first_of_assembly else 1])
        nodes, begin = int(tables.nodes[i]), int(tables.start[i])
        place, z = int(state.place[i]), float(tables.impedance[i])
        share = (passed + layer.mass * np.arange(nodes) / (nodes - 1)) / total
        force = end_force * share
        ahead, behind = (place - np.arange(nodes)) % nodes, (place - np.arange(nodes)[::-1]) % nodes
        state.forward[begin + ahead] = 0.5 * (force + z * v)
        state.backward[begin + behind] = 0.5 * (force - z * v)
        passed += layer.mass
        if i < len(stack.joints):
            joint, f = stack.joints[i], end_force * passed / total
            if tables.joint_kind[i] == POINT_MASS:
                push = end_force * joint.mass / total
                state.joint[i, 0], state.joint[i, 1] = tables.joint_value[i, RESISTANCE] * v - push, v
            elif joint.gap == 0.0 and math.isfinite(joint.stiffness):
                state.joint[i, 0] = f / joint.stiffness
                if tables.joint_kind[i] == ELASTIC:
                    state.memory[i, 0] = f
            passed += joint.mass
