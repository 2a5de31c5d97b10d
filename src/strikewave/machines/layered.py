"""The struck object as a stack of layers: between blows two bodies on a frame, in a blow the whole stack.

During a blow the contact law acts on the first face of the stack, its waves run, and spring, damper and
stop hold its end. Once all is quiet the parts before and behind the frame go on as the two bodies of
`StruckObject`, with their momentum and mean place, the frame bent no more than the stack's energy allows; the
energy still ringing is let go and counted as lost.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._chain_kernels import (
    DAMPING,
    EXPONENT,
    MASS,
    OFFSET,
    OPEN,
    PLACE,
    PRELOAD,
    SLOWEST,
    SPEED,
    STIFFNESS,
    Links,
)
from strikewave.contact.chain import first_modes, stored_energy
from strikewave.contact.motion import State
from strikewave.errors import IntegrationError
from strikewave.machines import _stack_kernels
from strikewave.machines._kernels import RotarySystem, place_bases
from strikewave.machines._stack_kernels import COLUMNS, CROWDED, ENDLESS, Blow, Supports
from strikewave.machines.spans import Places, StackSpan
from strikewave.machines.struck_object import StruckObject
from strikewave.waves import _kernels as waves
from strikewave.waves._impact_kernels import Law
from strikewave.waves._kernels import ELASTIC, LOST, RESISTANCE, Recording, Tables
from strikewave.waves._kernels import MASS as POINT_MASS
from strikewave.waves._kernels import State as Waves
from strikewave.waves.layers import Stack
from strikewave.waves.transit import Grid, choose_grid, field_nodes, grid_of, nearest_nodes, state_at_rest, tables_of

Array = NDArray[np.float64]

SETTLE = 0.5e-3
"""Time after the last release for which a stack is followed, s."""
SAMPLE_STEP = 0.1e-6
"""Spacing of what is kept of a blow, s."""
FIELD_STEP = 1e-6
"""Spacing of the x-t field, s."""
LONGEST_BLOW = 10e-3
"""A blow in touch for longer than this is refused, s."""
MISMATCH = 1e-4
LARGEST_STEP, SMALLEST_STEP = 40e-9, 20e-9
"""Wanted mismatch of the transits, and steps to try, s."""
_MOST_TOUCHES, _MOST_SWITCHES = 64, 16


@dataclass(frozen=True)
class LayeredObject:
    """A stack that is struck.

    Parameters
    ----------
    stack : Stack
        Its end is free: spring, damper and stop of the object hold it.
    first_of_assembly : int
        Index of the first layer that belongs to the assembly; the joint before it is the frame.
    grid : Grid
        How it is stepped.
    taps : tuple of (int, float), optional
        Where it is watched: layer, and fraction of it from its struck side.
    """

    stack: Stack
    first_of_assembly: int
    grid: Grid
    taps: tuple[tuple[int, float], ...] = ()

    @property
    def nose_mass(self) -> float:
        """Mass of layers and point masses before the frame, kg."""
        k = self.first_of_assembly
        return sum(x.mass for x in self.stack.layers[:k]) + sum(x.mass for x in self.stack.joints[: k - 1])

    @property
    def assembly_mass(self) -> float:
        """Mass of what follows the frame, kg."""
        k = self.first_of_assembly
        return sum(x.mass for x in self.stack.layers[k:]) + sum(x.mass for x in self.stack.joints[k:])

    @property
    def frame_damping(self) -> float:
        """Damping of the frame's joint, N s/m."""
        return self.stack.joints[self.first_of_assembly - 1].damping

    @property
    def frame_stiffness(self) -> float:
        """Stiffness between the means of the two parts, N/m: the frame's joint and the bars beside it in series.

        In a part of mass m that the frame pushes, the force falls with the mass q that it has passed,
        f = F (1 - q/m); compliances are mean displacements over F.
        """
        k, layers, joints = self.first_of_assembly, self.stack.layers, self.stack.joints
        before = [(layers[i], joints[i - 1] if i else None) for i in range(k - 1, -1, -1)]
        behind = [(layers[i], joints[i] if i < len(joints) else None) for i in range(k, len(layers))]
        compliance = 1.0 / joints[k - 1].stiffness
        for part, mass in ((before, self.nose_mass), (behind, self.assembly_mass)):
            passed = shortened = 0.0
            for layer, joint in part:
                share, left = layer.mass / mass, 1.0 - passed / mass
                bend = layer.length / (layer.modulus * layer.area)
                compliance += share * (shortened + bend * (left / 2.0 - share / 6.0))
                shortened += bend * (left - share / 2.0)
                passed += layer.mass
                if joint is not None:
                    compliance += joint.mass / mass * shortened
                    passed += joint.mass
                    shortened += (1.0 - passed / mass) / joint.stiffness
        return 1.0 / compliance


def machine_grid(stack: Stack, step: float | None = None) -> Grid:
    """Return the grid on which a stack is struck: the step asked for, or one that suits all transits."""
    return grid_of(stack, step) if step else choose_grid(stack, MISMATCH, LARGEST_STEP, SMALLEST_STEP)


def strike(
    layered: LayeredObject,
    struck: StruckObject,
    system: RotarySystem,
    start: State,
    strikers: int,
    field: bool = False,
) -> tuple[StackSpan, State]:
    """Follow one blow on a stack, from the state at first touch to the state once it has settled.

    Parameters
    ----------
    layered : LayeredObject
        What is struck.
    struck : StruckObject
        The same as bodies, with what supports it.
    system : RotarySystem
        The machine with these bodies.
    start : State
        Its state at first touch.
    strikers : int
        How many.
    field : bool, optional
        Whether to keep the x-t field.

    Raises
    ------
    IntegrationError
        If two strikers touch at once, or the contact lasts beyond `LONGEST_BLOW`.
    """
    place, grid, y = Places(strikers), layered.grid, start.y
    place_bases(system, start.time, y, start.mode, start.memory)
    striker = int(np.flatnonzero(start.mode[place.contacts] != OPEN)[0])
    x, v = y[: place.bodies], y[place.bodies : place.angle]
    masses = np.array([layered.nose_mass, layered.assembly_mass])
    speed = float(masses @ v[place.nose :] / masses.sum())
    supports = _supports(system, place)
    tables, waves_now = tables_of(layered.stack, grid), state_at_rest(layered.stack, grid)
    carriage, carriage_speed = float(system.bases[PLACE, strikers]), float(system.bases[SPEED, strikers])
    held = _end_force(supports, float(x[place.assembly]) - carriage, speed - carriage_speed)
    relative = v[place.nose :] - speed
    _settle_in(layered, tables, waves_now, held, relative)
    before = waves.momentum(tables, waves_now)
    ringing = -_let_go(system, place, start, tables, waves_now, (speed, float(x[place.assembly])), relative)

    every = max(1, round(SAMPLE_STEP / grid.step))
    rows = int(LONGEST_BLOW / grid.step / every) + 1
    history, touches, switches = np.zeros((rows, COLUMNS)), np.zeros((_MOST_TOUCHES, 3)), np.zeros((_MOST_SWITCHES, 2))
    nodes, field_position = nearest_nodes(grid, layered.taps), np.empty(0)
    watched, coarse = nodes[:0], every * max(1, round(FIELD_STEP / (every * grid.step)))
    if field:
        watched, field_position = field_nodes(layered.stack, grid)
    taps = Recording(nodes, every, np.zeros((rows, len(nodes))), np.zeros((rows, len(nodes), 3)))
    field_rows, places = rows * every // coarse + 1, len(watched)
    whole = Recording(watched, coarse, np.zeros((field_rows, places)), np.zeros((field_rows, places, 3)))
    for k, (layer, node) in enumerate(nodes):
        taps.velocity[0, k, 0] = waves.force_and_velocity(tables, waves_now, layer, node)[1]
    only = _strikers_only(system, strikers)
    ys = np.concatenate([x[:strikers], v[:strikers], y[place.angle : place.angle + 2], np.zeros(strikers + 3)])
    mode = np.concatenate([start.mode[place.mounts], start.mode[place.links :]])
    memory = np.concatenate([start.memory[place.mounts], start.memory[place.links :]])
    blow = Blow(
        striker=striker,
        approach=float(start.memory[striker]),
        time=start.time,
        speed=speed,
        gravity=struck.gravity,
        face=float(x[place.nose]),
        end=float(x[place.assembly]),
        first_of_assembly=layered.first_of_assembly,
        nose_mass=layered.nose_mass,
        assembly_mass=layered.assembly_mass,
        nose_speed=float(relative[0]),
        assembly_speed=float(relative[1]),
        settle=SETTLE,
        every=every,
    )
    why, steps, contacts, changed, u_end, net, energies = _stack_kernels.follow(
        tables,
        waves_now,
        _law(system, striker),
        (only, ys, mode, memory),
        supports,
        blow,
        (taps, whole),
        history,
        touches,
        switches,
    )
    if why == CROWDED:
        raise IntegrationError("two strikers touch the object at once: take fewer strikers, or less engagement")
    if why == ENDLESS:
        raise IntegrationError(
            f"a blow on the stack lasts longer than {LONGEST_BLOW * 1e3:g} ms: the contact or its mount is too soft"
        )
    kept = (steps - 1) // every + 1
    taps.velocity[kept - 1, :, 2] = 2.0 * taps.velocity[kept - 1, :, 1] - taps.velocity[kept - 1, :, 0]
    last, time = history[kept - 1], start.time + (steps - 1) * grid.step
    span = StackSpan(
        struck=struck,
        begin=start.time,
        step=every * grid.step,
        striker=striker,
        history=history[:kept].copy(),
        taps=Recording(taps.nodes, every, taps.force[:kept].copy(), taps.velocity[:kept].copy()),
        field_position=field_position,
        field_step=coarse * grid.step,
        field_force=whole.force[: (steps - 1) // coarse + 1].copy(),
        frame=(speed, struck.gravity),
        grid_step=grid.step,
        touches=touches[: min(contacts, _MOST_TOUCHES)],
        switched=switches[: min(changed, _MOST_SWITCHES)],
        momentum_error=float(
            abs(net - waves.momentum(tables, waves_now) + before) / last[_stack_kernels.CONTACT_IMPULSE]
        ),
    )

    end = State(time, y.copy(), start.mode.copy(), start.memory.copy())
    end.y[:strikers], end.y[place.bodies : place.bodies + strikers] = ys[:strikers], ys[strikers : 2 * strikers]
    end.y[place.nose], end.y[place.assembly] = last[_stack_kernels.NOSE_PLACE], last[_stack_kernels.ASSEMBLY_PLACE]
    end.y[place.bodies + place.nose] = last[_stack_kernels.NOSE_SPEED]
    end.y[place.bodies + place.assembly] = last[_stack_kernels.ASSEMBLY_SPEED]
    end.y[place.angle : place.angle + 2] = ys[2 * strikers : 2 * strikers + 2]
    end.mode[place.links :], end.memory[place.links :] = mode[strikers:], memory[strikers:]
    place_bases(system, time, end.y, end.mode, end.memory)

    lost_stop, lost_damper, lost, fed, push_ends = energies
    since = time - start.time
    frame = speed + struck.gravity * since
    fallen = (speed + 0.5 * struck.gravity * since) * since
    moved = np.array([last[_stack_kernels.NOSE_SPEED], last[_stack_kernels.ASSEMBLY_SPEED]]) - frame
    at_end = (frame, blow.end + fallen + u_end)
    left = _let_go(system, place, end, tables, waves_now, at_end, moved)
    if left < 0.0:
        _ease(system, place, end, -left)
        left = _let_go(system, place, end, tables, waves_now, at_end, moved)
    ringing += push_ends + left
    stands = np.concatenate([end.y[: place.bodies], system.bases[PLACE]])
    end.mode[: place.links] = first_modes(Links(system.joins, system.values), stands)
    end.mode[place.contacts] = OPEN
    at = place.energies
    end.y[at + striker] += lost
    end.y[at + strikers : at + 2 * strikers] += ys[2 * strikers + 2 : 3 * strikers + 2]
    end.y[at + place.frame] += ringing + float(waves_now.joint[:, LOST].sum())
    end.y[at + place.support] += lost_damper
    end.y[at + place.stop] += lost_stop
    end.y[at + place.links :] += ys[3 * strikers + 2 :]
    end.y[-1] += fed
    return span, end


def _ease(system: RotarySystem, place: Places, bodies: State, energy: float) -> None:
    """Take an energy out of the frame's bend, as far as there is any; the centre of mass stays.

    Parts that an open joint let fly apart stand farther from each other than the frame is bent.
    """
    masses = system.bodies[place.nose :, MASS]
    bend = bodies.y[place.nose] - bodies.y[place.assembly]
    kept = 1.0 - energy / (0.5 * system.values[place.frame, STIFFNESS] * bend**2) if bend else 0.0
    less = bend * (1.0 - math.sqrt(max(kept, 0.0)))
    bodies.y[place.nose] -= less * masses[1] / masses.sum()
    bodies.y[place.assembly] += less * masses[0] / masses.sum()


def _supports(system: RotarySystem, place: Places) -> Supports:
    """Return what holds the end, from the links of the machine."""
    spring, stop = system.values[place.support], system.values[place.stop]
    numbers = [*spring[[STIFFNESS, PRELOAD, DAMPING, OFFSET]], *stop[[STIFFNESS, DAMPING, OFFSET]]]
    return Supports(*(float(number) for number in numbers))


def _end_force(supports: Supports, place: float, speed: float) -> float:
    """Return the force of spring, damper and stop on an end at a place and speed from the carriage, N."""
    spring = supports.preload + supports.spring * (place - supports.rest) + supports.damper * speed
    deep = -place - supports.stop_offset
    stop = max(supports.stop * deep - supports.stop_damping * speed, 0.0) if deep > 0.0 else 0.0
    return spring - stop


def _law(system: RotarySystem, striker: int) -> Law:
    """Return the contact law of a striker."""
    value = system.values[striker]
    return Law(*(float(value[k]) for k in (STIFFNESS, EXPONENT, DAMPING, SLOWEST)))


def _strikers_only(system: RotarySystem, strikers: int) -> RotarySystem:
    """Return the machine with its strikers on their mounts alone; nodes are strikers, then bases."""
    mounts = slice(strikers, 2 * strikers)
    joins = system.joins[mounts].copy()
    joins[:, 1] -= np.where(joins[:, 1] >= strikers, 2, 0)
    joins[:, 2] -= np.where(joins[:, 2] >= strikers, 2, 0)
    return RotarySystem(
        system.bodies[:strikers].copy(), system.bases.copy(), joins, system.values[mounts].copy(), system.settings
    )


def _settle_in(layered: LayeredObject, tables: Tables, state: Waves, held: float, relative: Array) -> None:
    """Fill the waves of a stack that moves as two rigid parts while its end is held by a force.

    The force in a section is the share of the mass before it, f = held m(s)/m, so that the stack starts
    without ringing; across an open gap it would not hold together, and the stack starts free of force.
    """
    stack = layered.stack
    total, passed = layered.nose_mass + layered.assembly_mass, 0.0
    if any(joint.gap > 0.0 for joint in stack.joints):
        held = 0.0
    for i, layer in enumerate(stack.layers):
        v = float(relative[0 if i < layered.first_of_assembly else 1])
        nodes, begin = int(tables.nodes[i]), int(tables.start[i])
        place, z = int(state.place[i]), float(tables.impedance[i])
        share = (passed + layer.mass * np.arange(nodes) / (nodes - 1)) / total
        force = held * share
        ahead, behind = (place - np.arange(nodes)) % nodes, (place - np.arange(nodes)[::-1]) % nodes
        state.forward[begin + ahead] = 0.5 * (force + z * v)
        state.backward[begin + behind] = 0.5 * (force - z * v)
        passed += layer.mass
        if i < len(stack.joints):
            joint, f = stack.joints[i], held * passed / total
            if tables.joint_kind[i] == POINT_MASS:
                push = held * joint.mass / total
                state.joint[i, 0], state.joint[i, 1] = tables.joint_value[i, RESISTANCE] * v - push, v
            elif joint.gap == 0.0 and math.isfinite(joint.stiffness):
                state.joint[i, 0] = f / joint.stiffness
                if tables.joint_kind[i] == ELASTIC:
                    state.memory[i, 0] = f
            passed += joint.mass


def _let_go(
    system: RotarySystem,
    place: Places,
    bodies: State,
    tables: Tables,
    state: Waves,
    frame: tuple[float, float],
    relative: Array,
) -> float:
    """Return the energy of the object as a stack less that as two bodies, J.

    Both have the same momentum and the same height; they differ in ringing, and in where the end stands.
    """
    speed, end = frame
    masses = system.bodies[place.nose :, MASS]
    nodes = np.concatenate([bodies.y[: place.bodies], system.bases[PLACE]])
    of_object = [place.frame, place.support, place.stop]
    held = Links(system.joins[of_object], system.values[of_object])
    v = bodies.y[place.bodies + place.nose : place.angle]
    as_bodies = 0.5 * float(masses @ v**2) + stored_energy(held, nodes)
    nodes[place.assembly] = end
    end_held = Links(system.joins[of_object[1:]], system.values[of_object[1:]])
    moving = 0.5 * float(masses.sum()) * speed**2 + speed * float(masses @ relative)
    as_stack = waves.energy(tables, state) + moving + stored_energy(end_held, nodes)
    return as_stack - as_bodies
