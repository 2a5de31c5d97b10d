"""A machine as tables and as a state at its begin: every setting in its place, noses on their circles, what is launched."""

import cmath
import dataclasses
import math

import numpy as np
import pytest

from strikewave.contact import Contact
from strikewave.contact._chain_kernels import AHEAD, BEHIND, GRAVITY, MASS, OPEN, PUSHING, SLIDING, SLIDING_BACK, SPEED
from strikewave.contact._law_kernels import DAMPING, EXPONENT, OFFSET, PRELOAD, SLOWEST, SPOT, STIFFNESS
from strikewave.machines._kernels import CARRIED, FEEDING, HELD, SETTINGS, WAITING, place_bases
from strikewave.machines._layout import layout, layout_of
from strikewave.machines.drive import Feed, angle_at_valve_signal, expected_time, speed_after_wait
from strikewave.machines.machine import (
    BEFORE_TOUCH,
    Arm,
    Launch,
    Machine,
    Striker,
    Strikers,
    energy,
    machine_links,
    machine_system,
    modes_at,
    start_state,
)
from strikewave.machines.spans import Rebounds

from .uneven import DISC, FEED, OBJECT, STRIKERS, circle, uneven

pytestmark = pytest.mark.usefixtures("interpreted")


def settings_of(machine):
    return dict(zip(SETTINGS, machine_system(machine).settings.tolist(), strict=True))


def launched(striker=None, **launch):
    """Return a machine of one striker that is launched."""
    one = striker or Striker(1.3, 0.0, 0.0, Contact(5.0e9, 1.2, 0.2))
    return Machine(Strikers((one,), 0.3), OBJECT, Launch(**launch))


ON_ARM = Striker(1.3, 5.0e6, 110.0, Contact(5.0e9, 1.2, 0.2))


def test_nose_first_touches_where_its_circle_crosses_the_face_and_leaves_at_its_edge():
    """R (cos(p - a) - cos a) = -q; approach is the slope of that; R (sin(p - a) + sin a) = b/2 behind."""
    for angle, width in ((0.3, 0.16), (1.2, 0.05), (0.5 * math.pi, 0.01)):
        drive = uneven(drive={"blow_angle": angle, "face_width": width}).drive
        touch = 0.21 * (cmath.exp(1j * (drive.first_touch - angle)) - cmath.exp(-1j * angle))
        assert touch.real == pytest.approx(-5.5e-3, rel=1e-12)
        assert drive.first_touch < 0.0
        speed = 76.0 * 0.21 * (1j * cmath.exp(1j * (drive.first_touch - angle))).real
        assert drive.nominal_approach == pytest.approx(speed, rel=1e-12)
        leaves = 0.21 * (cmath.exp(1j * (drive.leaves - angle)) - cmath.exp(-1j * angle))
        assert leaves.imag == pytest.approx(0.5 * width, rel=1e-12)
    assert uneven(drive={"blow_angle": 0.0}).drive.leaves == 0.0
    assert uneven(drive={"face_width": math.inf}).drive.leaves == 0.0
    # a face wider than the circle is left where the nose turns back across: a quarter of a turn on
    assert uneven(drive={"face_width": 1.3}).drive.leaves == pytest.approx(0.3 + 0.5 * math.pi, rel=1e-15)
    assert uneven().nominal_approach == uneven().drive.nominal_approach


def test_machine_says_what_it_is_made_of():
    machine = uneven()
    assert machine.strikers.mass == pytest.approx(1.1, rel=1e-15)
    assert machine.strikers.first is STRIKERS[0]
    assert machine.pitch == pytest.approx(2.0 * math.pi / 3.0, rel=1e-15)
    assert (machine.radius, machine.engagement) == (0.21, 5.5e-3)
    assert machine.with_feed(blows=7).drive.feed == dataclasses.replace(FEED, blows=7)
    flies = launched(striker_speed=3.0, object_speed=-2.0)
    assert (flies.nominal_approach, flies.engagement, flies.radius, flies.rebounds) == (5.0, 0.0, 1.0, None)
    swings = launched(ON_ARM, arm=Arm(2.0, 0.7, 5.0, 11.0), rebounds=Rebounds(2))
    assert (swings.nominal_approach, swings.radius, swings.rebounds) == (3.5, 0.7, Rebounds(2))
    with pytest.raises(ValueError, match="has no drive"):
        _ = flies.drive


def test_settings_of_a_drive_stand_in_their_places():
    found = settings_of(uneven(disc={"ripple": 0.01, "ripple_order": 3.0, "ripple_phase": 0.4}))
    expected = {
        **{"inertia": 4.3, "drag": 0.023, "set_speed": 76.0, "gain": 19.0, "torque": 41.0, "ripple": 0.01},
        **{"ripple_order": 3.0, "ripple_phase": 0.4, "motor_inertia": 0.7, "belt_stiffness": 2100.0},
        **{"belt_damping": 1.3, "weight_moment": 0.0, "valve_delay": 0.011, "stroke": 0.0203, "stroke_time": 0.031},
        **{"acceleration": 0.45, "cushion": 0.35, "hold": 1e9, "release_delay": 0.0037, "retract_time": 0.027},
        **{"blows": 5.0, "stop_at_touch": 0.0, "along": 0.21 * math.cos(0.3), "across": 0.21 * math.sin(0.3)},
        **{"half_face": 0.08, "pitch": 2.0 * math.pi / 3.0, "contact_friction": 0.17, "sliding_damping": 2.3},
    }
    assert found == pytest.approx(expected, rel=1e-15)
    assert settings_of(uneven(disc={"belt_stiffness": math.inf}))["inertia"] == 5.0
    assert settings_of(uneven(feed={"hold": 0.4}))["hold"] == 0.4


def test_settings_of_a_launch_turn_nothing_and_end_with_the_time_asked_for():
    found = settings_of(launched(striker_speed=3.0, follow=0.02))
    nothing = ("drag", "set_speed", "gain", "torque", "ripple", "motor_inertia", "belt_damping", "stroke")
    assert [found[name] for name in (*nothing, "valve_delay", "release_delay", "weight_moment")] == [0.0] * 11
    assert found["hold"] == pytest.approx(0.02 + 10e-6, rel=1e-15)
    assert BEFORE_TOUCH == 10e-6
    assert (found["belt_stiffness"], found["half_face"], found["inertia"]) == (math.inf, math.inf, 1.0)
    assert (found["along"], found["across"], found["stop_at_touch"]) == (1.0, 0.0, 0.0)
    assert found["blows"] >= 1e5
    assert (found["acceleration"] + found["cushion"], found["stroke_time"], found["retract_time"]) == (1.0, 1.0, 1.0)
    swings = settings_of(launched(ON_ARM, arm=Arm(2.0, 0.7, 5.0, 11.0), rebounds=Rebounds()))
    assert [swings[name] for name in ("inertia", "weight_moment", "stop_at_touch", "across")] == [2.0, 11.0, 1.0, 0.7]
    assert swings["along"] == pytest.approx(0.0, abs=1e-16)


def test_bodies_seats_and_links_stand_in_their_order():
    machine = uneven(struck={"friction": 31.0, "stiction": 47.0})
    links, names = machine_links(machine)
    assert names == [
        "striker 1",
        "striker 2",
        "striker 3",
        "nose",
        "assembly",
        "seat 1",
        "seat 2",
        "seat 3",
        "carriage",
    ]
    assert len(links) == 10
    system = machine_system(machine)
    chain = system.chain
    assert chain.bodies[:, MASS].tolist() == [0.9, 1.1, 1.3, 0.07, 0.43]
    assert chain.bodies[:, GRAVITY].tolist() == [0.0, 0.0, 0.0, 9.7, 9.7]
    assert chain.bodies[:, CARRIED].tolist() == [0.9, 1.1, 1.3, 0.0, 0.0]
    for i, one in enumerate(STRIKERS):
        stands = 2.0 * math.pi / 3.0 * i + 0.3 - one.angle_error
        assert system.seats[i] == pytest.approx([math.cos(stands), math.sin(stands), 0.21 + one.reach_error], abs=1e-15)
        contact, mount = chain.values[i], chain.values[3 + i]
        assert contact[[STIFFNESS, EXPONENT, DAMPING]].tolist() == [
            one.contact.stiffness,
            one.contact.exponent,
            one.contact.hysteresis_factor,
        ]
        assert (contact[SLOWEST], contact[SPOT]) == (0.3, 1.0)
        assert mount[[STIFFNESS, DAMPING]].tolist() == [one.mount_stiffness, one.mount_damping]
    joins = chain.joins[:, [BEHIND, AHEAD]].tolist()
    assert joins == [[0, 3], [1, 3], [2, 3], [5, 0], [6, 1], [7, 2], [3, 4], [4, 8], [8, 4], [4, 8]]
    frame, support, stop = chain.values[6:9]
    assert frame[[STIFFNESS, DAMPING]].tolist() == [9.1e7, 210.0]
    assert support[[STIFFNESS, DAMPING, PRELOAD, OFFSET]].tolist() == [41e3, 23.0, 390.0, -5.5e-3]
    # the stop is pressed by the preload less the weight where the assembly rests
    assert stop[STIFFNESS] * (5.5e-3 - stop[OFFSET]) == pytest.approx(390.0 - 0.5 * 9.7, rel=1e-12)
    apart = machine_system(uneven(strikers={"same_spot": False})).chain.values
    assert apart[:3, SPOT].tolist() == [0.0, 0.0, 0.0]


def test_striker_that_flies_feels_gravity_and_is_carried_by_nobody():
    bodies = machine_system(launched(striker_speed=3.0, striker_gravity=9.8)).chain.bodies
    assert bodies[0].tolist() == [1.3, 9.8, 0.0]
    bodies = machine_system(launched(ON_ARM, arm=Arm(2.0, 0.7, 5.0, 11.0), striker_gravity=9.8)).chain.bodies
    assert bodies[0].tolist() == [1.3, 0.0, 1.3]


def test_machine_waits_for_its_valve_with_noses_on_their_circles():
    disc = {"ripple": 0.01, "ripple_order": 3.0, "ripple_phase": 0.4}
    machine = uneven(disc=disc, feed={"wait": 0.2, "arrival": 0.2})
    system = machine_system(machine)
    at, (t, y, mode, memory) = layout_of(system), start_state(machine, system)
    leaves, pitch = machine.drive.leaves, machine.pitch
    assert (t, mode[at.feed], mode[at.drive], mode[at.passes], mode[at.touched]) == (0.0, WAITING, 0, 0, 0)
    angle = (0.2 * pitch - 76.0 * 0.042) % pitch + leaves
    assert y[at.angle] == pytest.approx(angle, rel=1e-13)
    assert memory[at.next_apex] == pytest.approx(pitch + leaves, rel=1e-15)
    speed = speed_after_wait(machine.drive.turntable, 0.2) + 76.0 * 0.01 * math.sin(3.0 * angle + 0.4)
    assert (y[at.turntable_speed], y[at.motor_speed]) == pytest.approx((speed, speed), rel=1e-14)
    assert 2100.0 * y[at.belt_twist] == pytest.approx(0.023 * speed, rel=1e-13)
    for i, one in enumerate(STRIKERS):
        reach = (0.21 + one.reach_error) / (1.0 - one.mass * speed**2 / one.mount_stiffness)
        z = circle(machine, i, angle, reach)
        turned = z + 0.21 * cmath.exp(-0.3j)
        assert y[at.positions][i] == pytest.approx(z.real, abs=1e-14)
        assert y[at.speeds][i] == pytest.approx(speed * (1j * turned).real, rel=1e-11)
    x = y[at.positions]
    assert x[at.assembly] == pytest.approx(-5.5e-3 + 0.0203, rel=1e-14)
    assert 9.1e7 * (x[at.nose] - x[at.assembly]) == pytest.approx(0.07 * 9.7, rel=1e-9)
    assert y[at.speeds][3:].tolist() == [0.0, 0.0]
    across = np.array([abs(circle(machine, i, angle).imag) for i in range(3)])
    assert mode[at.on_face].tolist() == (across <= 0.08).astype(int).tolist()
    assert 0 < mode[at.on_face].sum() < 3
    assert mode[at.contacts].tolist() == [OPEN] * 3
    assert mode[at.mounts].tolist() == [PUSHING] * 3
    assert mode[[at.frame, at.support, at.stop, at.rail]].tolist() == [PUSHING, PUSHING, PUSHING, 0]
    assert memory[at.growths].tolist() == [1.0] * 10
    rigid = uneven(disc=disc | {"belt_stiffness": math.inf})
    assert start_state(rigid, machine_system(rigid)).y[at.belt_twist] == 0.0


def test_nose_beyond_a_parked_object_touches_only_before_its_face():
    """With so short a stroke all noses reach beyond the face; only those before it are in touch."""
    machine = uneven(feed={"stroke": -0.6, "arrival": 0.2})
    system = machine_system(machine)
    at, start = layout_of(system), start_state(machine, system)
    before = start.mode[at.on_face].astype(bool)
    assert start.mode[at.contacts].tolist() == np.where(before, PUSHING, OPEN).tolist()
    assert 0 < before.sum() < 3


@pytest.mark.parametrize(("speed", "object_speed"), [(3.0, -2.0), (3.0, 0.0), (0.0, -2.0)])
def test_what_is_launched_flies_10_us_before_it_touches(speed, object_speed):
    machine = launched(striker_speed=speed, object_speed=object_speed)
    system = machine_system(machine)
    at, (t, y, mode, memory) = layout_of(system), start_state(machine, system)
    x, v = y[at.positions], y[at.speeds]
    sag = 0.07 * 9.7 / 9.1e7 if object_speed == 0.0 else 0.0  # what rests is bent by its weight
    assert x == pytest.approx([-speed * 1e-5, -object_speed * 1e-5 + sag, -object_speed * 1e-5], abs=1e-18)
    assert v.tolist() == [speed, object_speed, object_speed]
    assert y[at.turntable].tolist() == [0.0] * 4
    assert (t, mode[at.feed], mode[at.on_face].tolist(), memory[at.next_apex]) == (0.0, HELD, [1], 1e9)
    assert mode[at.contacts].tolist() == [OPEN]
    # the rail slides with what moves, and sticks where nothing does
    assert mode[at.rail] == (SLIDING_BACK if object_speed < 0.0 else 0)
    assert memory[at.feed_start] == 0.0


def test_arm_is_launched_on_its_circle():
    machine = launched(ON_ARM, arm=Arm(2.0, 0.7, 5.0, 11.0))
    system = machine_system(machine)
    at, (_, y, mode, _) = layout_of(system), start_state(machine, system)
    assert (y[at.angle], y[at.turntable_speed]) == (-5.0 * 1e-5, 5.0)
    assert y[0] == pytest.approx(0.7 * math.sin(-5e-5), rel=1e-9)
    assert y[at.speeds][0] == pytest.approx(3.5 * math.cos(5e-5), rel=1e-12)
    assert mode[at.mounts].tolist() == [PUSHING]


def test_rail_slides_as_the_assembly_goes_on_the_carriage():
    machine = uneven()
    system = machine_system(machine)
    at, (_, y, mode, memory) = layout_of(system), start_state(machine, system)
    mode[at.feed], memory[at.feed_start] = FEEDING, 0.0
    place_bases(system, 0.015, y, mode, memory)
    carried = system.chain.bases[SPEED, 3]
    assert -1.2 < carried < -0.9
    for speed, way in ((carried + 0.05, SLIDING), (carried - 0.05, SLIDING_BACK), (carried, 0)):
        y[at.speeds][at.assembly] = speed
        assert modes_at(system, y)[at.rail] == way


def test_energy_of_a_rigid_belt_is_that_of_the_disc():
    machine = uneven(disc={"belt_stiffness": math.inf})
    system = machine_system(machine)
    at, state = layout_of(system), start_state(machine, system)
    before = energy(system, state)
    state.y[[at.belt_twist, at.motor_speed]] = 0.3, 99.0
    assert energy(system, state) == before


# the layout


@pytest.mark.parametrize(("strikers", "rail"), [(3, True), (1, False)])
def test_parts_of_a_machine_lie_one_behind_the_other(strikers, rail):
    """Nothing is left out and nothing shared: of the state, the modes, the memory and the switch functions."""
    links = 2 * strikers + 3 + rail
    at = layout(strikers + 2, links, strikers, strikers)
    count = strikers + 2

    def tiles(size, *parts):
        covered = [k for part in parts for k in (range(part.start, part.stop) if isinstance(part, slice) else [part])]
        assert covered == list(range(size))

    tiles(count, at.strikers, at.object)
    assert (at.nose, at.assembly, at.carriage) == (strikers, strikers + 1, strikers)
    tiles(links, at.contacts, at.mounts, at.frame, at.support, at.stop, *([at.rail] if rail else []))
    assert (at.contacts.stop, at.rubs) == (strikers, rail)
    tiles(at.states, at.positions, at.speeds, at.turntable, at.dissipated, at.of_drive)
    assert [at.angle, at.turntable_speed, at.belt_twist, at.motor_speed] == list(range(2 * count, 2 * count + 4))
    assert [at.driven, at.dragged, at.fed, at.rubbed] == list(range(at.of_drive.start, at.states))
    assert at.states == 2 * count + 4 + links + 4
    assert (at.energies, at.energies.stop) == (slice(at.dissipated.start, at.states), at.states)
    assert at.held_energies == slice(at.dissipated.start + at.support, at.states)
    tiles(at.modes, at.link_modes, at.drive, at.feed, at.passes, at.touched, at.edge, at.on_face)
    assert at.own_modes == slice(links, at.modes)
    assert at.held_modes == slice(at.support, at.on_face.start)
    tiles(at.memories, at.approaches, at.feed_start, at.next_apex, at.depths, at.growths)
    assert at.own_memory == slice(links, links + 2)
    tiles(at.switches, at.link_switches, at.own_switches)
    assert at.link_switches.stop == 3 * links
    tiles(4 + strikers, 0, 1, 2, 3, at.touches, at.edges)
    assert (at.touches, at.edges) == (slice(4, 4), slice(4, 4 + strikers))


def test_layouts_of_a_fast_run_and_of_strikers_alone():
    flight = layout(1, 3, 0, 4)
    assert (flight.support, flight.stop, flight.rail, flight.rubs, flight.carriage) == (0, 1, 2, True, 0)
    assert (flight.object, flight.strikers) == (slice(0, 1), slice(0, 0))
    assert (flight.touches, flight.edges, flight.switches) == (slice(4, 8), slice(8, 12), 9 + 12)
    assert (flight.on_face, flight.touching, flight.modes) == (slice(8, 12), 12, 13)
    alone = layout(3, 3, 3, 3)
    assert (alone.contacts, alone.mounts, alone.support) == (slice(0, 0), slice(0, 3), 3)
    assert (alone.touches, alone.edges, alone.modes) == (slice(4, 4), slice(4, 7), 3 + 5 + 3)


# the feed


@pytest.mark.parametrize("speed", [5.0, 76.0])
def test_stroke_ends_its_share_of_a_pitch_after_an_apex(speed):
    pitch = 2.0 * math.pi / 3.0
    angle = angle_at_valve_signal(FEED, speed, pitch)
    assert 0.0 <= angle < pitch
    assert (angle + speed * (0.011 + 0.031)) % pitch == pytest.approx(0.72 * pitch, rel=1e-12)


def test_feed_is_fastest_in_the_middle_of_its_stroke():
    """Over the rise and the fall it goes half as fast in the mean."""
    assert FEED.fastest * 0.031 * (1.0 - 0.5 * (0.45 + 0.35)) == pytest.approx(0.0203, rel=1e-15)


def test_expected_time_is_the_way_and_a_pass_more_than_wanted_or_the_hold():
    way = 0.011 + 0.031 + 0.0037 + 0.027
    assert expected_time(FEED, 0.02) == pytest.approx(way + 6 * 0.02, rel=1e-15)
    assert expected_time(dataclasses.replace(FEED, hold=0.05), 0.02) == pytest.approx(way + 0.05, rel=1e-15)
    assert isinstance(FEED, Feed)
    assert DISC.turning == 5.0
