"""The kernels of the machine as they are written: circles, Lagrange's equation, drive, feed, switches, edges."""

import cmath
import math

import numpy as np
import pytest

from strikewave.contact._chain_kernels import ACCELERATION, FORCE, OPEN, PLACE, PUSHING, SLIDING, SPEED
from strikewave.contact._integrator import CONTINUE, RESTART, STOP
from strikewave.contact.motion import MotionState
from strikewave.machines import _kernels
from strikewave.machines._kernels import (
    ACROSS,
    ALONG,
    ASIDE,
    BELT_STIFFNESS,
    CARRIED,
    FEED_TIMES,
    FEEDING,
    FIRST,
    FULL_TORQUE,
    HALF_FACE,
    HELD,
    INERTIA,
    NO_TORQUE,
    PITCH,
    REGULATED,
    RELEASED,
    RETRACTING,
    RIPPLE,
    RIPPLE_ORDER,
    RIPPLE_PHASE,
    SECOND,
    SETTINGS,
    STOP_AT_TOUCH,
    STROKE,
    WAITING,
    WEIGHT_MOMENT,
    bend_of,
    carriage,
    cross_edge,
    drive_torque,
    face_of,
    flight_switches,
    has_sliding,
    larger,
    machine_forces,
    machine_rates,
    machine_switch,
    machine_switches,
    nose_motion,
    own_switch,
    own_switches,
    place_bases,
    side_force,
    side_force_of,
    sliding_arm,
    stroke_places,
    stroke_profile,
    turning_inertia,
    wanted_torque,
)
from strikewave.machines._layout import APEX_SWITCH, FEED_SWITCH, FULL_TORQUE_SWITCH, NO_TORQUE_SWITCH, layout_of
from strikewave.machines.fast_run import train_tables
from strikewave.machines.machine import energy, machine_system

from .uneven import THETA, TURNING, circle, uneven

pytestmark = pytest.mark.usefixtures("interpreted")


def moving(machine, feed=HELD, since=0.013, drive=REGULATED):
    """Return a machine's tables and a state in which the third striker pushes, the stop too, and the rail slides."""
    system = machine_system(machine)
    at = layout_of(system)
    y, mode, memory = np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), np.zeros(at.memories)
    memory[at.growths], memory[at.approaches] = 1.0, np.arange(1, len(system.chain.joins) + 1)
    t = 0.7
    memory[at.feed_start], memory[at.next_apex] = t - since, THETA + 0.2
    mode[at.feed], mode[at.drive], mode[at.on_face] = feed, drive, 1
    y[at.angle], y[at.turntable_speed], y[at.belt_twist], y[at.motor_speed] = THETA, TURNING, 0.013, 73.0
    place_bases(system, t, y, mode, memory)
    place, speed = system.chain.bases[PLACE], system.chain.bases[SPEED]
    y[at.positions][:3] = place[:3] + np.array([1e-5, -3e-5, 7e-5])
    y[at.speeds][:3] = speed[:3] + np.array([0.3, -0.7, 1.9])
    y[at.positions][3] = y[2] - 9e-5  # the nose
    y[at.positions][4] = y[3] + 4e-5
    y[at.speeds][3:] = 2.3, 3.7
    mode[at.mounts] = mode[at.frame] = mode[at.support] = mode[at.stop] = PUSHING
    mode[at.contacts] = OPEN, OPEN, PUSHING
    mode[at.rail] = SLIDING
    return system, at, t, y, mode, memory


def test_stroke_stands_still_before_and_after_its_time():
    out = np.empty(5)
    stroke_places(np.array([-0.3, 0.0, 0.41, 1.0, 1.7]), 0.3, 0.2, out)
    assert out[[0, 1, 3, 4]] == pytest.approx([0.0, 0.0, 1.0, 1.0], abs=1e-16)
    assert out[2] == stroke_profile(0.41, 0.3, 0.2)[0]
    assert out[2] == pytest.approx((0.41 - 0.15) / 0.75, rel=1e-15)  # at the top speed since half the rise


@pytest.mark.parametrize("fed", [True, False])
def test_carriage_goes_its_stroke_in_its_time(fed):
    """Its speed and acceleration are slopes of its place, by central differences; beyond its end it stands."""
    settings = machine_system(uneven()).settings
    phase, time = (FEEDING, 0.031) if fed else (RETRACTING, 0.027)
    stroke = 0.0203
    for u in (0.1, 0.3, 0.55, 0.7, 0.95):
        h = 1e-6 * time
        (low, slow, _), (_, v, a), (high, fast, _) = (carriage(settings, phase, u * time + k * h) for k in (-1, 0, 1))
        assert v == pytest.approx((high - low) / (2 * h), rel=1e-8)
        assert a == pytest.approx((fast - slow) / (2 * h), rel=1e-6, abs=1e-6)
        assert (v < 0.0) == fed
    begin, end = (stroke, 0.0) if fed else (0.0, stroke)
    assert carriage(settings, phase, 0.0)[0] == pytest.approx(begin, abs=1e-17)
    for since in (time, 1.3 * time):
        assert carriage(settings, phase, since) == pytest.approx((end, 0.0, 0.0), abs=1e-12)
    # 0.55 of the time is spent at the speed that the way asks for: way over time over 1 - (0.45 + 0.35)/2
    for u in (0.4501, 0.5, 0.6499):
        assert abs(carriage(settings, phase, u * time)[1]) == pytest.approx(stroke / time / 0.6, rel=1e-14)
    for u in (0.4499, 0.6501):  # and less as the square of what is left
        assert abs(carriage(settings, phase, u * time)[1]) == pytest.approx(stroke / time / 0.6, rel=1e-6)


@pytest.mark.parametrize("phase", [WAITING, HELD, RELEASED])
def test_carriage_stands_out_before_it_is_fed_and_in_after(phase):
    settings = machine_system(uneven()).settings
    assert carriage(settings, phase, 0.01) == ((0.0203 if phase == WAITING else 0.0), 0.0, 0.0)


def test_controller_asks_for_the_drag_and_more_where_it_is_slow():
    settings = machine_system(uneven()).settings
    assert wanted_torque(settings, 76.0) == pytest.approx(0.023 * 76.0, rel=1e-15)
    assert wanted_torque(settings, 74.0) == pytest.approx(0.023 * 76.0 + 38.0, rel=1e-15)
    assert drive_torque(settings, REGULATED, 0.3, 74.0) == wanted_torque(settings, 74.0)
    assert drive_torque(settings, FULL_TORQUE, 0.3, 74.0) == 41.0
    assert drive_torque(settings, NO_TORQUE, 0.3, 74.0) == 0.0


def test_ripple_is_the_torque_that_swings_the_speed_by_its_share():
    """I dw/dt with w = w0 (1 + r sin(n theta + phase)), where theta goes with w0."""
    disc = {"ripple": 0.013, "ripple_order": 3.0, "ripple_phase": 0.4, "belt_stiffness": math.inf}
    settings = machine_system(uneven(disc=disc)).settings
    assert settings[INERTIA] == 5.0  # the motor turns with the turntable on a rigid belt
    for theta in (0.0, 0.7, 2.1):
        h = 1e-5
        swing = [76.0 * (1.0 + 0.013 * math.sin(3.0 * (theta + k * h) + 0.4)) for k in (-1, 1)]
        slope = (swing[1] - swing[0]) / (2 * h) * 76.0
        added = drive_torque(settings, NO_TORQUE, theta, 70.0)
        assert added == pytest.approx(5.0 * slope, rel=1e-8)
        assert drive_torque(settings, FULL_TORQUE, theta, 70.0) == pytest.approx(41.0 + added, rel=1e-14)
        settings[RIPPLE] = 0.005
        assert drive_torque(settings, NO_TORQUE, theta, 70.0) == pytest.approx(added * 5 / 13, rel=1e-14)
        settings[RIPPLE] = 0.013


def test_seats_run_on_circles_about_the_strike_position():
    """Place, slope and curvature over the angle are those of R exp(i u); across the blow too."""
    machine = uneven()
    system = machine_system(machine)
    at = layout_of(system)
    y, mode, memory = np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), np.zeros(at.memories)
    mode[at.feed], memory[at.feed_start] = FEEDING, 0.01
    y[at.angle], y[at.turntable_speed] = 1.7, 71.0
    place_bases(system, 0.022, y, mode, memory)
    bases = system.chain.bases
    for i in range(3):
        z = circle(machine, i, 1.7)
        turned = z + 0.21 * cmath.exp(-0.3j)  # from the axis
        assert (bases[PLACE, i], bases[ACROSS, i]) == pytest.approx((z.real, z.imag), abs=1e-15)
        assert bases[FIRST, i] == pytest.approx((1j * turned).real, abs=1e-15)
        assert bases[SECOND, i] == pytest.approx(-turned.real, abs=1e-15)
        assert bases[SPEED, i] == pytest.approx(71.0 * (1j * turned).real, abs=1e-13)
        assert sliding_arm(system, i) == pytest.approx((1j * turned).imag, abs=1e-15)
    assert bases[[PLACE, SPEED, ACCELERATION], 3] == pytest.approx(carriage(system.settings, FEEDING, 0.012))
    assert system.settings[[ALONG, ASIDE]] == pytest.approx([0.21 * math.cos(0.3), 0.21 * math.sin(0.3)])


@pytest.mark.parametrize(("friction", "damping", "slides"), [(1e-3, 0.0, True), (0.0, 1e-3, True), (0.0, 0.0, False)])
def test_nose_slides_with_the_least_friction(friction, damping, slides):
    settings = machine_system(uneven(strikers={"friction": friction, "sliding_damping": damping})).settings
    assert has_sliding(settings) == slides


def test_sliding_nose_drags_the_face_along_with_coulomb_and_viscous_force():
    settings = machine_system(uneven()).settings
    assert side_force(settings, 5e-3, 3.0) == pytest.approx(0.17 * 5e-3 + 6.9)
    assert side_force(settings, 100.0, 3.0) == pytest.approx(17.0 + 6.9)
    assert side_force(settings, 100.0, -3.0) == pytest.approx(-17.0 - 6.9)
    assert side_force(settings, 0.0, 3.0) == side_force(settings, -1.0, 3.0) == side_force(settings, 100.0, 0.0) == 0.0


@pytest.mark.parametrize(("friction", "damping"), [(0.17, 0.0), (0.0, 2.3), (0.0, 0.0)])
def test_either_friction_alone_drags_a_nose_that_pushes(friction, damping):
    machine = uneven(strikers={"friction": friction, "sliding_damping": damping})
    system, at, t, y, mode, memory = moving(machine)
    out = np.full(len(system.chain.joins) + 3, math.nan)
    machine_forces(system, t, y, mode, memory, out)
    arm = (1j * (circle(machine, 2, THETA) + 0.21 * cmath.exp(-0.3j))).imag
    assert out[at.contacts][2] > 1000.0
    assert out[-3:-1].tolist() == [0.0, 0.0]  # they are apart
    assert out[-1] == pytest.approx(friction * out[2] + damping * arm * TURNING, rel=1e-13)
    assert side_force_of(system, 2, y, mode, memory) == out[-1]


@pytest.mark.parametrize("rigid", [False, True])
@pytest.mark.parametrize("drive", [REGULATED, FULL_TORQUE, NO_TORQUE])
@pytest.mark.parametrize(("feed", "since"), [(FEEDING, 0.013), (HELD, 0.2), (RETRACTING, 0.008)])
def test_power_of_every_part_is_the_rate_of_the_energy(rigid, drive, feed, since):
    """Lagrange's equation keeps energy: its slope along the rates, by differences of fourth order, is what flows in and out.

    The energy is 12 kJ, of which rounding leaves some 1e-11 J over 1e-7 s; what flows is 3e5 W.
    """
    disc = {"belt_stiffness": math.inf} if rigid else {}
    machine = uneven(disc=disc | {"ripple": 0.0 if not rigid else 0.01})
    system, at, t, y, mode, memory = moving(machine, feed, since, drive)
    dy = np.full(at.states, math.nan)
    machine_rates(system, t, y, mode, memory, dy)
    h = 1e-7
    ends = [energy(system, MotionState(t + k * h, y + k * h * dy, mode, memory)) for k in (-2, -1, 1, 2)]
    driven, dragged, fed, rubbed = dy[at.of_drive]
    gains = driven - dragged - rubbed - dy[at.dissipated].sum() + fed
    assert np.dot(ends, [1.0, -8.0, 8.0, -1.0]) / (12 * h) == pytest.approx(gains, abs=1e-2)
    assert dy[at.positions].tolist() == y[at.speeds].tolist()
    assert dy[at.angle] == TURNING
    slip = 0.0 if rigid else 73.0 - TURNING
    assert dy[at.belt_twist] == slip
    assert dragged == pytest.approx(0.023 * TURNING**2 + 1.3 * slip**2, rel=1e-13)
    motor = TURNING if rigid else 73.0
    torque = drive_torque(system.settings, drive, THETA, motor)
    assert driven == pytest.approx(torque * motor, rel=1e-14, abs=0.0)
    belt = 2100.0 * 0.013 + 1.3 * slip
    assert dy[at.motor_speed] == pytest.approx(0.0 if rigid else (torque - belt) / 0.7, rel=1e-13, abs=0.0)
    place_bases(system, t, y, mode, memory)
    assert rubbed == pytest.approx(side_force_of(system, 2, y, mode, memory) * sliding_arm(system, 2) * TURNING)
    assert fed == pytest.approx(-system.chain.bases[FORCE, 3] * system.chain.bases[SPEED, 3], rel=1e-13)
    assert rubbed > 100.0
    if feed != HELD:
        assert abs(fed) > 10.0


def test_energy_is_that_of_strikers_that_turn_with_the_disc_across_and_move_by_themselves_along():
    """Inertia without the strikers, and each with its own speed along the blow and the disc's across it."""
    machine = uneven(strikers={"friction": 0.0, "sliding_damping": 0.0})
    system, at, t, y, mode, memory = moving(machine)
    place_bases(system, t, y, mode, memory)
    bodies = system.chain.bodies
    masses, inertia, radius = [0.9, 1.1, 1.3], 4.3, [0.2104, 0.2097, 0.2107]
    moving_energy = 0.5 * (inertia - sum(m * r * r for m, r in zip(masses, radius, strict=True))) * TURNING**2
    for i, m in enumerate(masses):
        across = (1j * (circle(machine, i, THETA) + 0.21 * cmath.exp(-0.3j))).imag * TURNING
        moving_energy += 0.5 * m * (across**2 + y[at.speeds][i] ** 2)
    moving_energy += 0.5 * 0.07 * 2.3**2 + 0.5 * 0.43 * 3.7**2 + 0.5 * 0.7 * 73.0**2
    assert bodies[:, CARRIED].tolist() == [*masses, 0.0, 0.0]
    first = system.chain.bases[FIRST, :3]
    assert turning_inertia(system) == pytest.approx(4.3 - np.dot(masses, first**2), rel=1e-14)
    x = y[at.positions]
    stored = 0.5 * 2100.0 * 0.013**2 + 0.5 * 9.1e7 * (x[3] - x[4]) ** 2
    stored += sum(0.5 * k * d * d for k, d in zip((2e6, 3e6, 5e6), (1e-5, -3e-5, 7e-5), strict=True))
    stored += 5.0e9 * (x[2] - x[3]) ** 2.2 / 2.2  # F = K d^1.2
    push = x[4] + 5.5e-3
    stored += 390.0 * push + 0.5 * 41e3 * push**2
    stop = -x[4] - 5.5e-3 + (390.0 - 0.5 * 9.7) / 2.1e5
    stored += 0.5 * 2.1e5 * max(stop, 0.0) ** 2
    height = -9.7 * (0.07 * x[3] + 0.43 * x[4])
    state = MotionState(t, y, mode, memory)
    assert energy(system, state) == pytest.approx(moving_energy + stored + height, abs=1e-10)
    system.settings[WEIGHT_MOMENT] = 37.0
    assert energy(system, state) == pytest.approx(moving_energy + stored + height - 37.0 * math.cos(THETA), abs=1e-10)


def test_arm_is_drawn_down_by_the_moment_of_its_weight():
    machine = uneven()
    system, at, t, y, mode, memory = moving(machine)
    before, after = np.zeros(at.states), np.zeros(at.states)
    machine_rates(system, t, y, mode, memory, before)
    system.settings[WEIGHT_MOMENT] = 37.0
    machine_rates(system, t, y, mode, memory, after)
    slowed = (before - after)[at.turntable_speed] * turning_inertia(system)
    assert slowed == pytest.approx(37.0 * math.sin(THETA), rel=1e-9)
    assert np.flatnonzero(before != after).tolist() == [at.turntable_speed]


@pytest.mark.parametrize("rigid", [False, True])
def test_drive_switches_where_what_is_asked_for_passes_its_limits(rigid):
    system, at, t, y, mode, memory = moving(uneven(disc={"belt_stiffness": math.inf} if rigid else {}))
    g = np.full(at.switches, math.nan)[at.own_switches]
    y[at.motor_speed], y[at.turntable_speed] = (73.0, 75.0) if not rigid else (70.0, 73.0)
    asked = 0.023 * 76.0 + 19.0 * 3.0  # 58.7 N m of 41
    for drive, full, none in (
        (REGULATED, 41.0 - asked, asked),
        (FULL_TORQUE, asked - 41.0, 1.0),
        (NO_TORQUE, 1.0, -asked),
    ):
        mode[at.drive] = drive
        own_switches(system, t, y, mode, memory, g)
        assert (g[FULL_TORQUE_SWITCH], g[NO_TORQUE_SWITCH]) == pytest.approx((full, none), rel=1e-13)


def test_feed_apex_and_edges_switch_at_their_times_and_places():
    machine = uneven()
    system, at, t, y, mode, memory = moving(machine)
    g = np.full(at.switches, math.nan)[at.own_switches]
    times = {WAITING: 0.011, FEEDING: 0.031, HELD: 1e9, RELEASED: 0.0037, RETRACTING: 0.027}
    for phase, time in times.items():
        mode[at.feed] = phase
        mode[at.on_face] = [0, 1, 1] if phase == HELD else [1, 1, 0]
        place_bases(system, t, y, mode, memory)
        own_switches(system, t, y, mode, memory, g)
        assert g[FEED_SWITCH] == pytest.approx(time - 0.013, rel=1e-12)
        assert system.settings[FEED_TIMES[phase]] == time
        assert g[APEX_SWITCH] == pytest.approx(0.2, rel=1e-12)
        inside = np.array([0.08 - abs(circle(machine, i, THETA).imag) for i in range(3)])
        assert g[at.edges] == pytest.approx(inside * np.where(mode[at.on_face], 1.0, -1.0), abs=1e-15)
        assert (inside > 0.0).tolist() == [True, False, True]
    system.settings[HALF_FACE] = math.inf
    own_switches(system, t, y, mode, memory, g)
    assert g[at.edges].tolist() == [1.0, 1.0, -1.0]


def test_drive_goes_to_its_limit_and_back():
    system, at, t, y, mode, memory = moving(uneven())
    for which, limit in ((FULL_TORQUE_SWITCH, FULL_TORQUE), (NO_TORQUE_SWITCH, NO_TORQUE)):
        assert mode[at.drive] == REGULATED
        assert own_switch(system, which, t, y, mode, memory) == CONTINUE
        assert mode[at.drive] == limit
        assert own_switch(system, which, t, y, mode, memory) == CONTINUE
    assert mode[at.drive] == REGULATED


def test_feed_goes_through_its_phases_and_ends_with_the_retraction():
    system, at, t, y, mode, memory = moving(uneven(), feed=WAITING)
    for k, phase in enumerate((FEEDING, HELD, RELEASED, RETRACTING)):
        assert own_switch(system, FEED_SWITCH, t + k, y, mode, memory) == CONTINUE
        assert (mode[at.feed], memory[at.feed_start]) == (phase, t + k)
    assert own_switch(system, FEED_SWITCH, t + 9.0, y, mode, memory) == STOP
    assert (mode[at.feed], memory[at.feed_start]) == (RETRACTING, t + 3)
    # a machine without a feed ends with the hold
    mode[at.feed], system.settings[STROKE] = HELD, 0.0
    assert own_switch(system, FEED_SWITCH, t, y, mode, memory) == STOP


@pytest.mark.parametrize(
    ("feed", "touched", "counts"), [(HELD, 0, 1), (HELD, 1, 1), (FEEDING, 1, 1), (FEEDING, 0, 0), (RETRACTING, 0, 0)]
)
def test_pass_counts_where_the_object_is_held_or_was_touched(feed, touched, counts):
    system, at, t, y, mode, memory = moving(uneven(), feed=feed)
    mode[at.passes], mode[at.touched] = 2, touched
    begun = memory[at.feed_start]
    assert own_switch(system, APEX_SWITCH, t, y, mode, memory) == CONTINUE
    assert (mode[at.passes], mode[at.touched], mode[at.feed]) == (2 + counts, 0, feed)
    assert memory[at.next_apex] == pytest.approx(THETA + 0.2 + 2.0 * math.pi / 3.0, rel=1e-15)
    assert memory[at.feed_start] == begun


def test_apex_of_the_last_pass_releases_the_object():
    system, at, t, y, mode, memory = moving(uneven())
    for done, phase in ((3, HELD), (4, RELEASED)):
        mode[at.passes] = done
        own_switch(system, APEX_SWITCH, t, y, mode, memory)
        assert mode[at.feed] == phase
    assert memory[at.feed_start] == t
    mode[at.feed], mode[at.passes] = FEEDING, 9  # not there yet
    own_switch(system, APEX_SWITCH, t, y, mode, memory)
    assert mode[at.feed] == FEEDING


def test_striker_leaves_the_face_and_what_it_stores_is_lost():
    machine = uneven()
    system, at, t, y, mode, memory = moving(machine)
    first, last = at.own_switches.start + at.edges.start, at.own_switches.start + at.edges.start + 2
    code = machine_switch(system, first, t, y, mode, memory)
    assert (code, mode[at.on_face].tolist()) == (CONTINUE, [0, 1, 1])
    d = y[2] - y[3]
    mode[at.on_face] = 1, 0, 1
    assert machine_switch(system, last, t, y, mode, memory) == RESTART
    assert (mode[at.on_face].tolist(), mode[at.contacts].tolist()) == ([1, 0, 0], [OPEN, OPEN, OPEN])
    lost = y[at.dissipated]
    assert lost[2] == pytest.approx(5.0e9 * d**2.2 / 2.2, rel=1e-13)
    assert np.count_nonzero(lost) == 1
    assert mode[at.edge] == 0


@pytest.mark.parametrize("deep", [-1e-7, 1e-7])
def test_striker_that_comes_behind_the_face_meets_its_edge(deep):
    """What has yielded leaves the face that much farther back: D (1 - 1/s)."""
    system, at, _, y, mode, memory = moving(uneven())
    mode[at.on_face], mode[at.contacts] = 0, OPEN
    memory[at.depths][1], memory[at.growths][1] = 6e-5, 1.5
    y[1] = y[3] + 2e-5 + deep
    code = cross_edge(system, 1, y, mode, memory)
    assert mode[at.on_face].tolist() == [0, 1, 0]
    assert (code, mode[at.edge]) == ((STOP, 2) if deep > 0.0 else (CONTINUE, 0))


def test_link_that_switches_is_the_machine_s_where_it_touches():
    """A first touch counts the pass; it stops the run where a stack is struck. Other links go on."""
    system, at, t, y, mode, memory = moving(uneven())
    y[0] = y[3] + 1e-6
    assert machine_switch(system, 0, t, y, mode, memory) == RESTART
    assert (mode[0], mode[at.touched], memory[0]) == (PUSHING, 1, y[at.speeds][0] - 2.3)
    assert machine_switch(system, 0, t, y, mode, memory) == CONTINUE  # and apart again
    mode[at.touched] = 0
    system.settings[STOP_AT_TOUCH] = 1e-3  # any number but 0
    assert machine_switch(system, 0, t, y, mode, memory) == STOP
    assert mode[at.touched] == 1
    mode[at.touched], mode[at.stop] = 0, OPEN
    assert machine_switch(system, 3 * at.stop, t, y, mode, memory) == RESTART
    assert (mode[at.touched], mode[at.stop]) == (0, PUSHING)


def test_switches_of_what_is_off_the_face_never_touch():
    system, at, t, y, mode, memory = moving(uneven())
    y[:2] = y[3] - np.array([3e-6, 5e-6])
    g = np.full(at.switches, math.nan)
    for on_face, expected in (([1, 1, 1], [3e-6, 5e-6]), ([1, 0, 1], [3e-6, 1.0]), ([0, 1, 1], [1.0, 5e-6])):
        mode[at.on_face] = on_face
        machine_switches(system, t, y, mode, memory, g)
        assert g[[0, 3]] == pytest.approx(expected, rel=1e-9)
        assert g[6] == pytest.approx(9e-5, rel=1e-9)  # how deep the third one is
    own = np.full(g.size, math.nan)[at.own_switches]
    own_switches(system, t, y, mode, memory, own)
    assert g[at.own_switches].tolist() == own.tolist()


# strikers that ride on their circles, before an object in free flight


def flying(machine):
    """Return the tables of free flight, and a state in which the third striker is just before the face."""
    tables, going, _ = train_tables(machine)
    system, at = tables.flight, layout_of(tables.flight)
    y, mode, memory = going.y, going.mode, going.memory
    y[at.angle], y[at.turntable_speed] = THETA, TURNING
    y[at.positions], y[at.speeds] = -1.8e-3, 0.9
    mode[at.feed], mode[at.on_face], mode[at.rail] = HELD, [1, 1, 1], SLIDING
    memory[at.next_apex], memory[at.feed_start] = THETA + 0.3, 0.5
    return system, at, 0.7, y, mode, memory


def test_rider_is_held_on_its_larger_circle_by_its_mount():
    """k (r - R) = m w^2 r."""
    for m, k, w in ((0.9, 2e6, 71.0), (1.3, 3e4, 80.0)):
        r = 0.21 * larger(w, m / k)
        assert k * (r - 0.21) == pytest.approx(m * w * w * r, rel=1e-9)


def test_nose_that_rides_goes_round_its_larger_circle():
    machine = uneven()
    system, *_ = flying(machine)
    for i, (m, k) in enumerate(((0.9, 2e6), (1.1, 3e6), (1.3, 5e6))):
        reach = (0.21 + machine.strikers.each[i].reach_error) / (1.0 - m * 71.0**2 / k)
        place, speed, across = nose_motion(system, i, 1.7, 71.0)
        h = 1e-6
        low, z, high = (circle(machine, i, 1.7 + k * h, reach) for k in (-1, 0, 1))
        assert place == pytest.approx(z.real, abs=1e-14)
        assert speed == pytest.approx(71.0 * (high - low).real / (2 * h), rel=1e-8)
        assert across == pytest.approx(circle(machine, i, 1.7).imag, abs=1e-14)  # the turntable guides it across


def test_frame_bends_as_what_it_accelerates_wants():
    """It pushes the nose with m (g - a); the centre of mass of nose and assembly goes with the object."""
    system, at, t, y, mode, memory = flying(uneven())
    assert bend_of(system.settings, 3.0) == pytest.approx(0.07 * (9.7 - 3.0) / 9.1e7, rel=1e-14)
    assert bend_of(system.settings, 9.7) == 0.0
    place_bases(system, t, y, mode, memory)
    pressed = -1.8e-3 + 5.5e-3
    support = 390.0 + 41e3 * pressed + 23.0 * 0.9
    mode[at.stop] = OPEN
    a = 9.7 - support / 0.5
    face = face_of(system, y, mode, memory)
    bend = 0.07 * (9.7 - a) / 9.1e7
    centre = 0.14 * face + 0.86 * (face - bend)
    assert bend > 1e-7
    assert centre == pytest.approx(-1.8e-3 + 0.14 * 0.07 * 9.7 / 9.1e7, abs=1e-17)


def test_rider_touches_where_its_nose_comes_to_the_face():
    machine = uneven()
    system, at, t, y, mode, memory = flying(machine)
    left = np.array([2e-5, 3e-5, 5e-5])
    system.seats[:, 4] = left
    place_bases(system, t, y, mode, memory)
    face = face_of(system, y, mode, memory)
    g = np.full(at.switches, math.nan)
    mode[at.on_face] = 1, 0, 1
    machine_switches(system, t, y, mode, memory, g)
    own = g[at.own_switches]
    expected = [face + left[i] - nose_motion(system, i, THETA, TURNING)[0] for i in range(3)]
    expected[1] = 1.0
    assert own[at.touches] == pytest.approx(expected, abs=1e-16)
    inside = np.array([0.08 - abs(circle(machine, i, THETA).imag) for i in range(3)])
    assert own[at.edges] == pytest.approx(inside * [1.0, -1.0, 1.0], abs=1e-15)
    system.settings[HALF_FACE] = math.inf
    flight_switches(system, y, mode, memory, own)
    assert own[at.edges].tolist() == [1.0, 1.0, 1.0]


def test_touch_of_a_rider_stops_and_is_named():
    system, at, t, y, mode, memory = flying(uneven())
    own = at.own_switches.start
    assert machine_switch(system, own + at.touches.start + 1, t, y, mode, memory) == STOP
    assert (mode[at.touched], mode[at.touching]) == (1, 1)
    assert machine_switch(system, own + at.touches.start + 2, t, y, mode, memory) == STOP
    assert mode[at.touching] == 2
    assert machine_switch(system, own + APEX_SWITCH, t, y, mode, memory) == STOP
    assert memory[at.next_apex] == pytest.approx(THETA + 0.3 + 2.0 * math.pi / 3.0)
    assert machine_switch(system, own + FULL_TORQUE_SWITCH, t, y, mode, memory) == CONTINUE
    assert mode[at.drive] == FULL_TORQUE


@pytest.mark.parametrize("deep", [-1e-7, 1e-7])
def test_rider_comes_before_the_face_or_meets_its_edge(deep):
    system, at, t, y, mode, memory = flying(uneven())
    system.seats[1, 4] = 4e-5
    place_bases(system, t, y, mode, memory)
    for _ in range(3):  # the spring of 41 kN/m bends the frame too, by 6e-5 of the way
        off = nose_motion(system, 1, THETA, TURNING)[0] - face_of(system, y, mode, memory)
        y[at.positions] += off - 4e-5 - deep
    edge = at.own_switches.start + at.edges.start + 1
    mode[at.on_face] = 1, 0, 1
    code = machine_switch(system, edge, t, y, mode, memory)
    assert mode[at.on_face].tolist() == [1, 1, 1]
    assert (code, mode[at.edge]) == ((STOP, 2) if deep > 0.0 else (CONTINUE, 0))
    mode[at.edge] = 0
    assert machine_switch(system, edge, t, y, mode, memory) == CONTINUE
    assert (mode[at.on_face].tolist(), mode[at.edge]) == ([1, 0, 1], 0)


def test_settings_are_named_in_their_order():
    places = [
        getattr(_kernels, "ASIDE" if n == "across" else "ACCELERATE" if n == "acceleration" else n.upper())
        for n in SETTINGS
    ]
    assert places == list(range(len(SETTINGS)))
    assert (RIPPLE, RIPPLE_ORDER, RIPPLE_PHASE, PITCH, BELT_STIFFNESS) == (5, 6, 7, 25, 9)
