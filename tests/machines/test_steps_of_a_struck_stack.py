"""The steps of a blow on a stack as they are written: what every history is the integral of, and what is booked."""

import cmath
import dataclasses
import math

import numpy as np
import pytest

from strikewave.base.errors import IntegrationError
from strikewave.contact._chain_kernels import OPEN, PLACE, PUSHING, SLIDING, SPEED
from strikewave.contact._law_kernels import STIFFNESS
from strikewave.contact.motion import MotionState
from strikewave.machines import _stack_kernels as column
from strikewave.machines import strike as one_blow
from strikewave.machines._kernels import (
    FEEDING,
    FULL_TORQUE,
    HALF_FACE,
    HELD,
    HOLD,
    RETRACTING,
    STROKE,
    carriage,
    machine_rates,
    place_bases,
    sliding_arm,
    turning_inertia,
)
from strikewave.machines._layout import APEX_SWITCH, FEED_SWITCH, FULL_TORQUE_SWITCH, layout_of
from strikewave.machines._stack_kernels import (
    Supports,
    another_touches,
    follow,
    hold,
    move_machine,
    rub,
    rub_face,
    slip_off,
    switch_machine,
)
from strikewave.machines.machine import energy, machine_system
from strikewave.machines.strike import _ease, _end_force, _settle_in, _Strike, _supports, strike
from strikewave.machines.struck_object import LayeredObject, machine_grid
from strikewave.waves import Branch, Joint, Layer, Stack
from strikewave.waves._kernels import END_BETA, END_RESISTANCE, END_SIGMA, advance, arriving_at_face, force_and_velocity
from strikewave.waves._kernels import momentum as waves_momentum
from strikewave.waves._press_kernels import CLOSED, CONTACT_SIZE, COUNT, DEPTH, LOST, QUIET
from strikewave.waves._press_kernels import FORCE as CONTACT_FORCE
from strikewave.waves._press_kernels import POWER as POWER_LOST
from strikewave.waves.transit import state_at_rest, tables_of

from .uneven import OBJECT, THETA, TURNING, circle, uneven

pytestmark = pytest.mark.usefixtures("interpreted")
KERNELS = follow, rub
"""Which are run by others here."""
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


def about_to_strike(stack=STACK, feed=HELD, since=0.2, angle=THETA, **changes):
    """Return what `strike` takes: the third striker touches a stack at rest or on the way with its carriage."""
    layered = LayeredObject(stack, 2, machine_grid(stack, STEP), ((0, 0.5), (2, 0.3), (2, 0.0), (3, 1.0)))
    names = ("nose_mass", "assembly_mass", "frame_damping", "frame_stiffness")
    parts = {name: getattr(layered, name) for name in names}
    changes["struck"] = parts | changes.get("struck", {})
    machine = dataclasses.replace(uneven(**changes), layered=layered)
    system = machine_system(machine)
    at = layout_of(system)
    y, mode, memory = np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), np.zeros(at.memories)
    memory[at.growths] = 1.0
    t = 0.7
    memory[at.feed_start], memory[at.next_apex] = t - since, angle + 0.2
    mode[at.feed], mode[at.on_face] = feed, 1
    y[at.turntable] = angle, TURNING, 0.013, 73.0
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
    assert gained == pytest.approx(driven - dragged - rubbed - booked[at.dissipated].sum() + fed, abs=1e-4)
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
    coarse, end = strike(layered, struck, system, start, field=True)
    assert end.time == pytest.approx(coarse.end, rel=1e-15)
    assert coarse.step == pytest.approx(3 * STEP, rel=1e-12)
    assert fine.step == STEP
    n = len(coarse.history)
    same = min(n, len(fine.history[::3]))
    assert n - same <= 1  # it is looked whether all is quiet at kept steps alone
    assert np.array_equal(coarse.history[:same], fine.history[::3][:same])
    assert np.array_equal(coarse.taps.force[:same], fine.taps.force[::3][:same])
    assert coarse.momentum_error < 1e-12
    # at a tap what is felt is what its speed changes by, of the last step half
    for span in (fine, coarse):
        for tap, begin in ((0, 0.9), (1, 0.7), (2, 0.7), (3, 0.7)):
            _, moving, felt = span.tap(tap)
            gained = span.step * (felt - G)[:-1].sum() + 0.5 * span.step * (felt - G)[-1]
            time = span.step * (len(felt) - 1)
            assert moving[-1] - begin - G * time == pytest.approx(gained, abs=1e-9)
    # the push on the assembly is an average about a kept step that falls in lines to its neighbours, and loses nothing
    push = fine.taps.force[:, 2] - fine.taps.force[:, 3]
    hat = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9.0
    means = np.convolve(push, hat, "same")[::3]
    found = layered.assembly_mass * (coarse.rigid_acceleration - G)
    assert found[1 : same - 1] == pytest.approx(means[1 : same - 1], rel=1e-9)
    assert found[0] == pytest.approx((3.0 * push[0] + 4.0 * push[1] + 2.0 * push[2]) / 9.0, rel=1e-9)


def test_field_of_a_blow_reaches_from_the_struck_face_to_the_held_end(blow):
    fine = blow[4]
    times, force = fine.field()
    assert times[:3] == pytest.approx([0.0, 3 * STEP, 6 * STEP])
    assert fine.field_position[0] == 0.0
    assert fine.field_position[-1] == pytest.approx(sum(x.length for x in STACK.layers), rel=1e-12)
    assert np.array_equal(force[:, -1], fine.taps.force[::3, 3][: len(force)])
    assert len(force) == (len(fine.history) - 1) // 3 + 1
    assert force[1:, 0] == pytest.approx(fine.history[3::3, column.CONTACT_FORCE], rel=1e-9)


# the end


SUPPORTS = Supports(41e3, 390.0, 23.0, -5.5e-3, 2.1e5, 190.0, 3.7e-3, 31.0, 47.0)


def held(place, wave, carriage_place=1e-4, carried=-0.4, frame=0.9, arriving=70.0, **changes):
    """Hold the end of a stack over a step; return the force on it, its speed in the frame, and of spring and rail."""
    supports = SUPPORTS._replace(**changes)
    grid = machine_grid(STACK, STEP)
    tables, state = tables_of(STACK, grid), state_at_rest(STACK, grid)
    last = len(STACK.layers) - 1
    begin, nodes = tables.start[last], tables.nodes[last]
    state.place[last] = 2
    state.forward[begin : begin + nodes] = arriving * np.arange(1, nodes + 1)
    tables.end[[END_BETA, END_SIGMA]] = 0.3
    spring, friction = hold(supports, tables, state, place, frame, wave, carriage_place, carried)
    force = advance(tables, state, 0.0)
    _, speed = force_and_velocity(tables, state, last, nodes - 1)
    return force, speed, spring, friction, tables, frame - carried


@pytest.mark.parametrize("sticking", [0.0, 5e-3, 47.0])
@pytest.mark.parametrize(("arriving", "frame"), [(70.0, 0.9), (-900.0, 0.9), (-40.0, -1.1)])
@pytest.mark.parametrize("place", [-4.1e-3, -1.1e-3])
def test_end_of_a_stack_balances_what_holds_it(place, arriving, frame, sticking):
    """Spring, damper, stop and rail at its new speed; the stop by how deep it is and how fast it is pressed."""
    sliding = min(sticking, 31.0)
    force, speed, spring, friction, tables, rate = held(
        place, 0.2, arriving=arriving, frame=frame, sliding=sliding, sticking=sticking
    )
    total = 390.0 + 41e3 * (place - 1e-4 + 5.5e-3) + 23.0 * (rate + speed)
    assert spring == pytest.approx(total - 23.0 * speed, rel=1e-13)
    deep = 1e-4 - place - 3.7e-3
    stop = 2.1e5 * deep - 190.0 * (rate + speed) if deep > 0.0 and 2.1e5 * deep > 190.0 * (rate + 0.2) else 0.0
    assert (deep > 0.0) == (place < -3e-3)
    assert force == pytest.approx(total - stop + friction, rel=1e-12)
    assert friction == math.copysign(sliding, rate + speed)
    # what holds it holds no energy of its own
    assert (tables.end[END_BETA], tables.end[END_SIGMA]) == (0.0, 0.0)
    assert tables.end[END_RESISTANCE] == pytest.approx(23.0 + (190.0 if stop else 0.0), rel=1e-15)


def test_end_that_sticks_goes_with_its_carriage():
    for place, arriving in ((-4.1e-3, 70.0), (-1.1e-3, -40.0)):
        _, speed, _, friction, _, rate = held(place, 0.2, arriving=arriving, sticking=1e6)
        assert rate + speed == pytest.approx(0.0, abs=1e-12)
        assert abs(friction) > 1000.0
        slides = held(place, 0.2, arriving=arriving, sticking=0.999 * abs(friction))[3]
        assert slides == math.copysign(31.0, friction)
        assert held(place, 0.2, arriving=arriving, sticking=1.001 * abs(friction))[3] == friction


@pytest.mark.parametrize(("wave", "pushes"), [(0.0, True), (-0.4, True), (5.0, False)])
def test_stop_lets_go_where_its_damper_would_pull(wave, pushes):
    """With the speed of a step ago: 2.1e5 deep = 105 N against 190 N s/m of 1.3 m/s and that."""
    *_, tables, _ = held(-5.6e-3, wave)
    assert tables.end[END_RESISTANCE] == pytest.approx(213.0 if pushes else 23.0)


def test_force_on_an_end_at_a_place_is_that_of_spring_damper_and_stop():
    """From the carriage; the stop takes no part in a pull."""
    for place, speed in ((-4.1e-3, 1.3), (-4.1e-3, 0.2), (-4.1e-3, -0.2), (-1.1e-3, 0.2)):
        deep = -place - 3.7e-3
        stop = max(2.1e5 * deep - 190.0 * speed, 0.0) if deep > 0.0 else 0.0
        expected = 390.0 + 41e3 * (place + 5.5e-3) + 23.0 * speed - stop
        assert _end_force(SUPPORTS, place, speed) == pytest.approx(expected, rel=1e-14)
    assert 2.1e5 * 4e-4 < 190.0 * 1.3
    system = about_to_strike()[2]
    supports = _supports(system)
    assert supports[:4] == (41e3, 390.0, 23.0, -5.5e-3)
    assert (supports.stop, supports.sliding, supports.sticking) == (2.1e5, 31.0, 47.0)
    damping = dataclasses.replace(OBJECT, nose_mass=0.091, assembly_mass=0.13).stop_damping
    assert supports.stop_damping == pytest.approx(damping, rel=1e-14)
    assert supports.stop_offset == pytest.approx(5.5e-3 - (390.0 - 0.221 * G) / 2.1e5, rel=1e-12)
    smooth = _supports(about_to_strike(struck={"friction": 0.0, "stiction": None})[2])
    assert (smooth.sliding, smooth.sticking) == (0.0, 0.0)


# single steps of the machine


def alone():
    """Return the machine without the object, as a blow moves it, and its layout."""
    layered, struck, system, start = about_to_strike()
    with_strikers = _Strike(layered, struck, system, start).strikers_alone()
    return with_strikers, layout_of(with_strikers[0])


def test_strikers_alone_are_those_of_the_machine():
    (system, y, mode, memory), at = alone()
    _, _, whole, start = about_to_strike()
    assert y[at.positions].tolist() == start.y[:3].tolist()
    assert y[at.speeds].tolist() == start.y[5:8].tolist()
    assert y[at.turntable].tolist() == [THETA, TURNING, 0.013, 73.0]
    assert y[at.energies].tolist() == [0.0] * 7
    assert (mode[at.mounts].tolist(), mode[at.feed]) == ([PUSHING] * 3, HELD)
    assert memory[at.own_memory].tolist() == start.memory[layout_of(whole).own_memory].tolist()
    assert memory[at.growths].tolist() == [1.0] * 3
    assert system.chain.joins[:, 1:].tolist() == [[3, 0], [4, 1], [5, 2]]  # seats behind strikers
    assert system.chain.values[:, STIFFNESS].tolist() == [2e6, 3e6, 5e6]


def test_step_of_the_machine_is_the_trapezoidal_rule():
    """Against the mean of the rates at both ends; the push and the braking of this step last all of it."""
    (system, y, mode, memory), at = alone()
    dt, push, braked, t = 1e-7, np.array([30.0, 50.0, 70.0]), 1100.0, 0.7
    rates = np.zeros((2, y.size))
    machine_rates(system, t, y, mode, memory, rates[0])
    first, before = rates[0].copy(), y.copy()
    for k, push_of in enumerate(push):
        first[at.speeds][k] -= push_of / (0.9, 1.1, 1.3)[k]
    first[at.turntable_speed] -= braked
    move_machine(system, t + dt, dt, y, mode, memory, push, braked, rates)
    last = np.zeros(y.size)
    ends = before + dt * first
    ends[at.positions] = y[at.positions]
    ends[at.angle] = y[at.angle]
    machine_rates(system, t + dt, ends, mode, memory, last)
    after = last.copy()
    after[at.speeds] -= push / np.array([0.9, 1.1, 1.3])
    after[at.turntable_speed] -= braked
    means = before + 0.5 * dt * (first + after)
    assert y[at.speeds] == pytest.approx(means[at.speeds], rel=1e-14)
    assert y[at.positions] == pytest.approx(
        before[at.positions] + dt * before[at.speeds] + 0.5 * dt**2 * first[at.speeds], rel=1e-15
    )
    assert y[at.turntable_speed] == pytest.approx(means[at.turntable_speed], rel=1e-13)
    assert y[at.angle] == pytest.approx(THETA + dt * TURNING + 0.5 * dt**2 * first[at.turntable_speed], rel=1e-15)
    assert y[[at.belt_twist, at.motor_speed]] == pytest.approx(means[[at.belt_twist, at.motor_speed]], rel=1e-13)
    assert y[at.energies] == pytest.approx(before[at.energies] + 0.5 * dt * (first + last)[at.energies], rel=1e-12)
    assert rates[0].tolist() == last.tolist()


def test_striker_off_the_face_loses_what_its_contact_stores():
    law = about_to_strike()[2].chain.values[2]
    contact, touches = np.zeros(CONTACT_SIZE), np.zeros((3, 3))
    contact[[DEPTH, COUNT, CLOSED, LOST, QUIET]] = 3e-5, 2.0, 1.0, 0.25, 1e-6
    contact[[CONTACT_FORCE, POWER_LOST]] = 11.0, 13.0
    slip_off(law, contact, touches, 0.71, 2e-7)
    assert contact[LOST] == pytest.approx(0.25 + 5e9 * 3e-5**2.2 / 2.2, rel=1e-13)
    assert touches.tolist() == [[0.0] * 3, [0.0, 0.71, 0.0], [0.0] * 3]
    assert contact[[CONTACT_FORCE, CLOSED, POWER_LOST]].tolist() == [0.0, 0.0, 0.0]
    assert contact[QUIET] == pytest.approx(1.2e-6)
    slip_off(law, contact, touches, 0.72, 2e-7)  # and no more
    assert contact[LOST] == pytest.approx(0.25 + 5e9 * 3e-5**2.2 / 2.2, rel=1e-13)
    assert touches[1, 1] == 0.71
    assert contact[QUIET] == pytest.approx(1.4e-6)
    contact[CLOSED], contact[COUNT] = 1.0, 4.0  # beyond the table
    slip_off(law, contact, touches, 0.73, 2e-7)
    assert touches.sum() == 0.71


@pytest.mark.parametrize(("deep", "half", "found"), [(1e-6, 0.08, True), (-1e-6, 0.08, False), (1e-6, 0.06, False)])
def test_another_striker_touches_where_it_is_before_the_face_and_beyond_it(deep, half, found):
    (system, y, mode, memory), _ = alone()
    system.settings[HALF_FACE] = half
    place_bases(system, 0.7, y, mode, memory)
    assert another_touches(system, y, 2, y[0] - deep) == found
    assert not another_touches(system, y, 0, y[2] + 1e-9)
    assert another_touches(system, y, 0, y[2] - 1e-9)


def test_switches_of_the_machine_are_listed_as_they_come():
    (system, y, mode, memory), at = alone()
    g, switches = np.zeros(at.switches), np.zeros((2, 2))
    y[at.motor_speed] = 75.0  # 19 N m and the drag: within the limits
    place_bases(system, 0.7, y, mode, memory)
    mode[at.on_face] = 0, 1, 1  # the first one is at the edge: it touches nothing here, and is no matter
    assert switch_machine(system, 0.7, y, mode, memory, g, switches, 0) == 0
    assert mode[at.on_face].tolist() == [0, 1, 1]
    assert g[at.own_switches][at.edges][0] < 0.0
    memory[at.feed_start], mode[at.feed] = 0.7 - 0.0312, FEEDING
    y[at.angle] = memory[at.next_apex] + 1e-9
    assert switch_machine(system, 0.71, y, mode, memory, g, switches, 0) == 2
    assert switches.tolist() == [[FEED_SWITCH, 0.71], [APEX_SWITCH, 0.71]]
    assert mode[at.feed] == HELD
    y[at.motor_speed] = 90.0
    assert switch_machine(system, 0.72, y, mode, memory, g, switches, 2) == 3  # counted, but no room
    assert switches[:, 1].tolist() == [0.71, 0.71]
    # the end of the retraction, or of a machine without feed, ends the run: not here
    memory[at.feed_start], mode[at.feed] = 0.0, RETRACTING
    assert switch_machine(system, 0.73, y, mode, memory, g, switches, 0) == 0
    mode[at.feed], system.settings[STROKE], system.settings[HOLD] = HELD, 0.0, 0.1
    assert switch_machine(system, 0.73, y, mode, memory, g, switches, 0) == 0


def test_nose_that_slides_is_braked_half_a_step_before_and_half_a_step_after():
    (system, y, mode, memory), at = alone()
    place_bases(system, 0.7, y, mode, memory)
    arm, inertia = sliding_arm(system, 2), turning_inertia(system)
    side, half = np.array([100.0, 7.0, 900.0, 0.5]), 1e-4
    rub_face(system, 2, 1000.0, half, y, side)
    force = math.copysign(170.0, arm) + 2.3 * arm * TURNING
    slowed = TURNING + half * (7.0 - force * arm / inertia)
    assert y[at.turntable_speed] == pytest.approx(slowed, rel=1e-14)
    assert side == pytest.approx([force, force * arm / inertia, force * arm * slowed, 0.5 + half * (100.0 + force)])
    assert y[at.rubbed] == pytest.approx(half * (900.0 + force * arm * slowed), rel=1e-13)


# how a stack begins and ends


@pytest.mark.parametrize("gap", [0.0, 1e-6])
def test_stack_that_nobody_strikes_goes_on_without_ringing(gap):
    """Under a constant force on its end every force stays as it is, the share of the mass before it; across an open gap
    the stack begins free of force."""
    joints = STACK.joints if gap == 0.0 else (*STACK.joints[:2], Joint(2e8, 150.0, unilateral=True, gap=gap))
    stack = Stack(STACK.layers, joints)
    layered = LayeredObject(stack, 2, machine_grid(stack, STEP))
    tables, state = tables_of(stack, layered.grid), state_at_rest(stack, layered.grid)
    _settle_in(layered, tables, state, 500.0, np.array([0.3, 0.3]))
    places = [(i, k) for i in range(4) for k in range(tables.nodes[i])]
    before = np.array([force_and_velocity(tables, state, *one) for one in places])
    passed = np.array([0.0, 0.05 + 0.011, 0.091, 0.181])
    masses = np.array([0.05, 0.03, 0.09, 0.04])
    share = [(passed[i] + masses[i] * k / (tables.nodes[i] - 1)) / 0.221 for i, k in places]
    assert before[:, 0] == pytest.approx(np.array(share) * (500.0 if gap == 0.0 else 0.0), abs=1e-10)
    assert before[:, 1] == pytest.approx(0.3, abs=1e-12)
    assert waves_momentum(tables, state) == pytest.approx(0.221 * 0.3, rel=1e-3)  # the waves hold half a step's push
    if gap == 0.0:
        tables.end[:] = 0.0
        tables.end[0] = 1.0  # a given force
        for step in range(1, 30):
            state.end[0] = 500.0
            face = -arriving_at_face(tables, state)
            assert advance(tables, state, face) == 500.0
            now = np.array([force_and_velocity(tables, state, *one) for one in places])
            assert now[:, 0] == pytest.approx(before[:, 0], abs=1e-8)
            # all of it is slowed as one body
            assert now[:, 1] == pytest.approx(0.3 - step * STEP * 500.0 / 0.221, abs=1e-8)


def test_parts_of_a_stack_begin_each_at_its_own_speed():
    layered = LayeredObject(STACK, 2, machine_grid(STACK, STEP))
    tables, state = tables_of(STACK, layered.grid), state_at_rest(STACK, layered.grid)
    _settle_in(layered, tables, state, 0.0, np.array([0.3, -0.2]))
    speeds = [force_and_velocity(tables, state, i, 1)[1] for i in range(4)]
    assert speeds == pytest.approx([0.3, 0.3, -0.2, -0.2], rel=1e-14)
    assert waves_momentum(tables, state) == pytest.approx(0.091 * 0.3 - 0.13 * 0.2, rel=1e-13)


@pytest.mark.parametrize(("energy", "left"), [(1e-4, None), (5e-4, 0.0)])
def test_frame_is_eased_by_an_energy_about_its_centre_of_mass(energy, left):
    """A bend of 3 um holds 4e-4 J; more than it holds straightens it."""
    system = about_to_strike()[2]
    at = layout_of(system)
    y = np.zeros(at.states)
    y[at.positions][3:] = -4e-3 + 3e-6, -4e-3
    stiffness = system.chain.values[at.frame, STIFFNESS]
    held_there = 0.5 * stiffness * 9e-12
    assert 1e-4 < held_there < 5e-4
    bodies = MotionState(0.0, y, np.zeros(1, dtype=np.int64), np.zeros(1))
    centre = 0.091 * y[3] + 0.13 * y[4]
    _ease(system, bodies, energy)
    bend = y[3] - y[4]
    expected = math.sqrt(2.0 * (held_there - energy) / stiffness) if left is None else left
    assert bend == pytest.approx(expected, rel=1e-9, abs=1e-18)
    assert 0.091 * y[3] + 0.13 * y[4] == pytest.approx(centre, rel=1e-14)
    y[3] = y[4]
    _ease(system, bodies, energy)  # nothing to take
    assert y[3] == y[4]


def test_kept_steps_are_whole_ones_near_a_tenth_of_a_microsecond():
    for step, kept in ((30e-9, 90e-9), (41e-9, 82e-9), (70e-9, 70e-9), (0.2e-6, 0.2e-6)):
        grid = machine_grid(STACK, STEP)
        assert one_blow.kept_step(dataclasses.replace(grid, step=step)) == pytest.approx(kept, rel=1e-12)


def test_two_strikers_at_once_and_a_blow_without_end_are_refused(monkeypatch):
    shorten(monkeypatch)
    layered, struck, system, start = about_to_strike()
    crowd = start.y.copy()
    crowd[0] = crowd[3] + 1e-3
    with pytest.raises(IntegrationError, match="two strikers touch"):
        strike(layered, struck, system, start._replace(y=crowd))
    monkeypatch.setattr(one_blow, "LONGEST_BLOW", 20e-6)
    with pytest.raises(IntegrationError, match=r"longer than 0\.02 ms"):
        strike(layered, struck, system, start)


def test_blow_is_followed_half_a_ms_after_its_last_release_and_10_ms_at_most(monkeypatch):
    class Asked(Exception):  # noqa: N818
        pass

    def fine(tables, state, law, machine, supports, blow, recordings, *_):
        assert recordings[1].every == blow.every == 1
        raise Asked

    with monkeypatch.context() as patch, pytest.raises(Asked):
        patch.setattr(one_blow, "follow", fine)
        patch.setattr(one_blow, "FIELD_STEP", 0.4 * STEP)  # no finer than what is kept
        strike(*about_to_strike(), field=True)

    def asked(tables, state, law, machine, supports, blow, recordings, averages, notes):
        history = notes.history
        assert blow.settle == 0.5e-3
        assert (len(history) - 1) * blow.every * tables.step == pytest.approx(10e-3, rel=1e-12)
        assert len(recordings[0].force) == len(history)
        assert len(recordings[1].force) == len(history) * blow.every // recordings[1].every + 1
        assert recordings[1].every * tables.step == pytest.approx(1e-6, rel=1e-12)
        raise Asked

    monkeypatch.setattr(one_blow, "follow", asked)
    with pytest.raises(Asked):
        strike(*about_to_strike(), field=True)


def test_blow_ends_where_its_striker_leaves_the_face(monkeypatch):
    """Behind the strike position the nose goes out at 15 m/s: off a face that ends 0.3 mm on after 20 us."""
    shorten(monkeypatch)
    layered, struck, system, start = about_to_strike(angle=4.2)
    out, across = circle(uneven(), 2, 4.2).imag, sliding_arm(system, 2) * TURNING
    assert out > 0.0
    assert across > 10.0
    system.settings[HALF_FACE] = out + across * 20e-6
    span, end = strike(layered, struck, system, start)
    h, t = histories(span)
    assert np.all(h["CONTACT_FORCE"][t > 20e-6 + STEP] == 0.0)
    assert h["CONTACT_FORCE"][(t < 20e-6 - STEP) & (t > 1e-6)].min() > 500.0
    assert span.touches[0, 1] == pytest.approx(0.7 + 20e-6, abs=STEP)
    at = layout_of(system)
    assert end.mode[at.on_face][2] == 0
    assert (end.y - start.y)[at.dissipated][2] > 1.0  # what was stored is lost
    gained, booked = energy(system, end) - energy(system, start), end.y - start.y
    driven, dragged, fed, rubbed = booked[at.of_drive]
    assert gained == pytest.approx(driven - dragged - rubbed - booked[at.dissipated].sum() + fed, abs=5e-3)


def test_momentum_that_the_waves_miss_is_told_over_the_impulse_of_the_contact(monkeypatch):
    shorten(monkeypatch)
    gained = iter((3.0, 3.2))
    monkeypatch.setattr(one_blow.waves, "momentum", lambda *_: next(gained))
    span, _ = strike(*about_to_strike())
    got = STEP * (span.history[:, column.CONTACT_FORCE] - span.taps.force[:, 3]).sum()
    assert span.momentum_error == pytest.approx(abs(got - 0.2) / span.history[-1, column.CONTACT_IMPULSE], rel=1e-6)
