"""The steps of a blow on a stack as they are written: what every history is the integral of, and what is booked."""

import cmath
import dataclasses
import math

import numpy as np
import pytest

from strikewave.contact._chain_kernels import OPEN, PLACE, PUSHING, SLIDING, SPEED
from strikewave.contact.motion import MotionState
from strikewave.machines import _stack_kernels as column
from strikewave.machines import strike as one_blow
from strikewave.machines._kernels import FEEDING, FULL_TORQUE, HELD, carriage, place_bases
from strikewave.machines._layout import FULL_TORQUE_SWITCH, layout_of
from strikewave.machines.layered import LayeredObject, machine_grid
from strikewave.machines.machine import energy, machine_system
from strikewave.machines.strike import strike
from strikewave.waves import Branch, Joint, Layer, Stack

from .uneven import OBJECT, THETA, TURNING, circle, uneven

pytestmark = pytest.mark.usefixtures("interpreted")
STEP = 0.2e-6


def shorten(monkeypatch):
    """Follow a blow for no longer than it takes here, and keep every step of it."""
    monkeypatch.setattr(one_blow, "SETTLE", 3e-6)
    monkeypatch.setattr(one_blow, "SAMPLE_STEP", STEP)
    monkeypatch.setattr(one_blow, "FIELD_STEP", 3 * STEP)
    monkeypatch.setattr(one_blow, "LONGEST_BLOW", 120e-6)


def layer(name, mass, steps, density=7800.0, modulus=2.1e11):
    """Return a layer by its mass and its transit in steps."""
    length = steps * STEP * math.sqrt(modulus / density)
    return Layer(name, density, modulus, mass / density / length, length)


STACK = Stack(
    (layer("nose", 0.05, 4), layer("cap", 0.03, 3, 2700.0, 7e10), layer("body", 0.09, 7), layer("end", 0.04, 5)),
    (Joint(mass=0.011), Joint(9.1e7, 210.0, (Branch(3e7, 7e-6),)), Joint(2e8, 150.0)),
)


def about_to_strike(stack=STACK, feed=HELD, since=0.2, stiffness=None, **changes):
    """Return what `strike` takes: the third striker touches a stack at rest or on the way with its carriage."""
    layered = LayeredObject(stack, 2, machine_grid(stack, STEP), ((0, 0.5), (2, 0.3), (2, 0.0), (3, 1.0)))
    names = ("nose_mass", "assembly_mass", "frame_damping", "frame_stiffness")
    parts = {name: getattr(layered, name) for name in names}
    machine = dataclasses.replace(uneven(struck=parts, **changes), layered=layered)
    system = machine_system(machine)
    at = layout_of(system)
    y, mode, memory = np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), np.zeros(at.memories)
    memory[at.growths] = 1.0
    t = 0.7
    memory[at.feed_start], memory[at.next_apex] = t - since, THETA + 0.2
    mode[at.feed], mode[at.on_face] = feed, 1
    y[at.turntable] = THETA, TURNING, 0.013, 73.0
    place_bases(system, t, y, mode, memory)
    bases = system.chain.bases
    y[at.strikers] = bases[PLACE, :3] + np.array([1e-5, -3e-5, 7e-5])
    y[at.speeds][:3] = bases[SPEED, :3] + np.array([0.3, -0.7, 1.9])
    y[at.positions][3] = y[2]
    y[at.positions][4] = y[2] - 1.1e-6
    y[at.speeds][3:] = 0.9, 0.7
    y[at.energies] = np.arange(at.states)[at.energies]
    memory[2] = y[at.speeds][2] - 0.9
    mode[at.mounts] = mode[at.frame] = mode[at.support] = PUSHING
    mode[at.contacts] = OPEN, OPEN, PUSHING
    mode[at.rail] = SLIDING
    stop = float(bases[PLACE, 3] - y[at.positions][4] - system.chain.values[at.stop, 0])
    mode[at.stop] = PUSHING if stop > 0.0 else OPEN
    return layered, machine.struck, system, MotionState(t, y, mode, memory)


def integral(values, step=STEP):
    """Return the integral of a history by the trapezoidal rule from its begin to each of its samples."""
    return np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] + values[:-1]))])


NAMES = (
    *("CONTACT_FORCE", "FACE_PLACE", "NOSE_PLACE", "NOSE_SPEED", "ASSEMBLY_PLACE", "ASSEMBLY_SPEED", "TURNTABLE_ANGLE"),
    *("TURNTABLE_SPEED", "STRIKER_SPEED", "FACE_SPEED", "CONTACT_IMPULSE", "END_IMPULSE", "INDENTATION", "SIDE_FORCE"),
    *("SIDE_IMPULSE", "FRICTION_HEAT"),
)
G, FALL = 9.7, 0.17
"""Gravity along the blow, m/s^2, and the friction of a nose."""


def histories(span):
    """Return the columns of a history by their names, and its times after first touch."""
    columns = {name: span.history[:, getattr(column, name)] for name in NAMES}
    return columns, span.step * np.arange(len(span.history))


@pytest.fixture(scope="module", params=[(HELD, 0.2), (FEEDING, 0.02)], ids=["held", "fed"])
def blow(request, interpreting):
    """A blow on an object that is held, or on its way in with the carriage."""
    feed, since = request.param
    with pytest.MonkeyPatch.context() as patch:
        interpreting(patch, request.module)
        shorten(patch)
        layered, struck, system, start = about_to_strike(feed=feed, since=since)
        span, end = strike(layered, struck, system, start, field=True)
    return layered, struck, system, start, span, end


def test_histories_of_a_blow_are_integrals_of_one_another(blow):
    """By the trapezoidal rule, to rounding; each is told by what it stands for, not by the step that makes it."""
    layered, _, system, start, span, _ = blow
    h, t = histories(span)
    at = layout_of(system)
    x, v = start.y[at.positions], start.y[at.speeds]
    begins = {"FACE_PLACE": x[3], "NOSE_PLACE": x[3], "ASSEMBLY_PLACE": x[4], "TURNTABLE_ANGLE": THETA}
    begins |= {"CONTACT_IMPULSE": 0.0, "SIDE_IMPULSE": 0.0}
    for name, begin in begins.items():
        rate = {"CONTACT_IMPULSE": "CONTACT_FORCE", "SIDE_IMPULSE": "SIDE_FORCE"}.get(name, name[:-5] + "SPEED")
        rate = "TURNTABLE_SPEED" if name == "TURNTABLE_ANGLE" else rate
        # the turntable by its acceleration of a step ago, of which 1 % changes 1e-11 rad
        assert h[name] == pytest.approx(begin + integral(h[rate]), rel=1e-13, abs=1e-11 if "ANGLE" in name else 1e-14)
    assert (h["NOSE_SPEED"][0], h["ASSEMBLY_SPEED"][0], h["STRIKER_SPEED"][0]) == (v[3], v[4], v[2])
    # after a step in which what holds the end slows it
    slowed = 0.9 - STEP * span.tap(3)[0][0] / (0.091 + 0.13)
    assert h["FACE_SPEED"][0] == pytest.approx(slowed, abs=4e-5)  # less the rail, which comes with the step
    deep = integral(h["STRIKER_SPEED"] - h["FACE_SPEED"])
    assert h["INDENTATION"] == pytest.approx(np.maximum(deep, 0.0), abs=1e-17)
    # the faces of the assembly
    (force_in, _, _), (force_end, moving, _) = span.tap(2), span.tap(3)
    assert h["END_IMPULSE"] == pytest.approx(integral(force_end), abs=1e-15)
    nose = v[3] + G * t + (h["CONTACT_IMPULSE"] - integral(force_in)) / layered.nose_mass
    assert h["NOSE_SPEED"] == pytest.approx(nose, rel=1e-12)
    assembly = v[4] + G * t + integral(force_in - force_end) / layered.assembly_mass
    assert h["ASSEMBLY_SPEED"] == pytest.approx(assembly, rel=1e-12)
    assert span.rigid_acceleration == pytest.approx((force_in - force_end) / layered.assembly_mass + G, rel=1e-9)
    assert span.momentum_error < 1e-12
    assert moving[0] == pytest.approx(0.7, abs=2e-3)  # after the first step


def test_force_of_a_blow_is_that_of_its_law_and_of_friction(blow):
    """F = K d^n (1 + chi d'/v0), which never pulls; (mu F + c |s'|) across; the mount gives the striker its momentum."""
    _, _, _, start, span, _ = blow
    h, t = histories(span)
    machine = uneven()
    rate = h["STRIKER_SPEED"] - h["FACE_SPEED"]
    force = 5.0e9 * h["INDENTATION"] ** 1.2 * np.maximum(1.0 + 0.2 * rate / start.memory[2], 0.0)
    assert h["CONTACT_FORCE"] == pytest.approx(force, rel=1e-9, abs=1e-6)
    ((begin, release, approach),) = span.touches
    assert begin == 0.7
    assert approach == pytest.approx(start.memory[2], abs=0.0)
    assert abs(release - 0.7 - t[np.flatnonzero(h["INDENTATION"])[-1]]) < STEP
    z = np.array([circle(machine, 2, angle) + 0.21 * cmath.exp(-0.3j) for angle in h["TURNTABLE_ANGLE"]])
    arm = (1j * z).imag
    sliding = arm * h["TURNTABLE_SPEED"]
    side = np.where(force > 0.0, 0.17 * force * np.sign(sliding) + 2.3 * sliding, 0.0)
    # the speed is that before half a step of braking, 1e-6 of it
    assert h["SIDE_FORCE"] == pytest.approx(side, rel=1e-5)
    heat = integral(h["SIDE_FORCE"] * sliding)
    assert h["FRICTION_HEAT"] == pytest.approx(heat, abs=1e-9)
    place = z.real - 0.21 * math.cos(0.3) - start.y[2]
    mount = 5e6 * (place - integral(h["STRIKER_SPEED"]))
    mount += 110.0 * ((1j * z).real * h["TURNTABLE_SPEED"] - h["STRIKER_SPEED"])
    momentum = 1.3 * (h["STRIKER_SPEED"] - h["STRIKER_SPEED"][0])
    # second order in the step
    assert momentum == pytest.approx(integral(mount) - h["CONTACT_IMPULSE"], abs=1e-6)


def test_end_is_held_by_spring_damper_stop_and_rail(blow):
    """Their force on the last node, and the energy that each takes or gives; the carriage stands or comes."""
    _, _, system, start, span, end = blow
    at = layout_of(system)
    force, moving, _ = span.tap(3)
    t = span.step * np.arange(len(force))
    feed = start.mode[at.feed]
    going = np.array([carriage(system.settings, feed, start.time + x - start.memory[at.feed_start])[:2] for x in t])
    place = start.y[at.positions][4] + integral(moving) - going[:, 0]
    rate = moving - going[:, 1]
    spring = 390.0 + 41e3 * (place + 5.5e-3)
    deep = -place - 5.5e-3 + (390.0 - 0.22 * G) / 2.1e5
    damping = dataclasses.replace(OBJECT, nose_mass=0.091, assembly_mass=0.13).stop_damping
    stop = np.where(deep > 0.0, np.maximum(2.1e5 * deep - damping * rate, 0.0), 0.0)
    assert deep.min() > 0.0
    rail = 31.0 * np.sign(rate)
    # the end's place is that of a step ago moved on: 3 um a step would be 0.1 N
    slides = np.abs(rate) > 0.1
    slides &= (stop > 0.0) | (np.roll(stop, 1) == 0.0)  # the stop lets go a step late
    assert slides.mean() > 0.9
    assert force[slides] == pytest.approx((spring + 23.0 * rate + rail - stop)[slides], abs=0.05)
    booked = (end.y - start.y)[at.dissipated]
    assert booked[at.support] == pytest.approx(integral(23.0 * rate**2)[-1], rel=1e-6)
    assert booked[at.rail] == pytest.approx(integral(rail * rate)[-1], rel=1e-6)
    assert booked[at.stop] == pytest.approx(integral((2.1e5 * deep - stop) * rate)[-1], rel=1e-3)
    assert (end.y - start.y)[at.fed] == pytest.approx(-integral(force * going[:, 1])[-1], rel=1e-9)
    assert booked[at.contacts][:2].tolist() == [0.0, 0.0]
    h, _ = histories(span)
    taken = integral(h["CONTACT_FORCE"] * (h["STRIKER_SPEED"] - h["FACE_SPEED"]))[-1]
    assert booked[2] == pytest.approx(taken, rel=1e-3)


def test_energy_of_a_blow_is_booked(blow):
    """Of 8 J that come in, to the square of a step over the shortest swing."""
    _, _, system, start, _, end = blow
    at = layout_of(system)
    gained = energy(system, end) - energy(system, start)
    booked = end.y - start.y
    driven, dragged, fed, rubbed = booked[at.of_drive]
    assert gained == pytest.approx(driven - dragged - rubbed - booked[at.dissipated].sum() + fed, abs=2e-4)
    assert booked[at.frame] > 5e-3


def test_machine_goes_on_as_two_bodies_where_the_blow_ends(blow):
    _, _, system, start, span, end = blow
    at = layout_of(system)
    h, t = histories(span)
    assert end.time == pytest.approx(0.7 + t[-1], rel=1e-15)
    assert span.end == end.time
    x, v = end.y[at.positions], end.y[at.speeds]
    # the frame is bent no more than there is energy for; the centre stays
    bend, open_bend = x[3] - x[4], h["NOSE_PLACE"][-1] - h["ASSEMBLY_PLACE"][-1]
    assert 0.0 <= bend <= open_bend
    centre = 0.091 * h["NOSE_PLACE"][-1] + 0.13 * h["ASSEMBLY_PLACE"][-1]
    assert 0.091 * x[3] + 0.13 * x[4] == pytest.approx(centre, rel=1e-14)
    assert (v[3], v[4], v[2]) == tuple(h[f"{name}_SPEED"][-1] for name in ("NOSE", "ASSEMBLY", "STRIKER"))
    assert (end.y[at.angle], end.y[at.turntable_speed]) == (h["TURNTABLE_ANGLE"][-1], h["TURNTABLE_SPEED"][-1])
    assert end.y[at.rubbed] - start.y[at.rubbed] == pytest.approx(h["FRICTION_HEAT"][-1], rel=1e-13)
    assert span.rubbed == start.y[at.rubbed]
    assert x[2] == pytest.approx(start.y[2] + integral(h["STRIKER_SPEED"])[-1], abs=1e-9)
    assert end.mode[at.contacts].tolist() == [OPEN] * 3
    assert end.mode[at.mounts].tolist() == [PUSHING] * 3
    assert end.mode[at.on_face].tolist() == [1, 0, 1]
    # at once the controller asks for more than there is, 19 (76 - 73) N m
    assert (end.mode[at.drive], end.mode[at.feed]) == (FULL_TORQUE, start.mode[at.feed])
    assert span.switched.tolist() == [[FULL_TORQUE_SWITCH, 0.7]]
    assert end.memory[at.own_memory].tolist() == start.memory[at.own_memory].tolist()
    assert (end.mode[at.stop], end.mode[at.rail]) == (PUSHING, SLIDING)


def test_coarser_table_keeps_every_third_of_the_same_steps(blow, monkeypatch):
    layered, struck, system, start, fine, _ = blow
    shorten(monkeypatch)
    monkeypatch.setattr(one_blow, "SAMPLE_STEP", 3.4 * STEP)
    coarse, _ = strike(layered, struck, system, start, field=True)
    assert coarse.step == pytest.approx(3 * STEP, rel=1e-12)
    assert fine.step == STEP
    n = len(coarse.history)
    same = min(n, len(fine.history[::3]))
    assert n - same <= 1  # it is looked whether all is quiet at kept steps alone
    assert np.array_equal(coarse.history[:same], fine.history[::3][:same])
    assert np.array_equal(coarse.taps.force[:same], fine.taps.force[::3][:same])
    assert coarse.momentum_error < 1e-12


def test_field_of_a_blow_reaches_from_the_struck_face_to_the_held_end(blow):
    fine = blow[4]
    times, force = fine.field()
    assert times[:3] == pytest.approx([0.0, 3 * STEP, 6 * STEP])
    assert fine.field_position[0] == 0.0
    assert fine.field_position[-1] == pytest.approx(sum(x.length for x in STACK.layers), rel=1e-12)
    assert np.array_equal(force[:, -1], fine.taps.force[::3, 3][: len(force)])
    assert len(force) == (len(fine.history) - 1) // 3 + 1
    assert force[1:, 0] == pytest.approx(fine.history[3::3, column.CONTACT_FORCE], rel=1e-9)
