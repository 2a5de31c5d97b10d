"""A nose that slides across the face: side impulse, torque on the turntable, heat, in closed form and by quadrature."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson

from strikewave import load_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputError
from strikewave.contact import Contact
from strikewave.machines import blows, run_machine
from strikewave.machines.spans import StackSpan

ONE = (
    *("feed.blows=1", "machine.speed_gain=1e-6 N m s/rad", "machine.drag=0 N m s/rad", "machine.inertia=1 kg m^2"),
    *("striker.mount_stiffness=1e11", "striker.mount_damping=0", "feed.release_delay=1 ms", "feed.retract_time=5 ms"),
)
"""Noses on the circle itself, on a light turntable that nothing drives."""
STRIKES = {
    "cam": ("machine.engagement=5 mm",),
    "oblique": (
        *("machine.blow_angle=30 deg", "machine.face_width=60 mm", "machine.engagement=1 mm", "feed.stroke=60 mm"),
        "machine.speed=200 rpm",
    ),
    "path": (
        *("machine.blow_angle=90 deg", "machine.face_width=10 mm", "machine.engagement=0.1 mm", "feed.stroke=60 mm"),
        "machine.speed=200 rpm",
    ),
}


def machine_of(*changes):
    return build_machine(load_case("li-ma-2019", changes))


def from_apex(run, angle):
    """Angle of the nearest nose from where R cos u is largest."""
    pitch = run.machine.pitch
    return (angle + 0.5 * pitch) % pitch - 0.5 * pitch - run.machine.drive.blow_angle


def followed(run):
    """Times, what the machine does, and the angle u, finely over each contact of a blow, which has no switch inside."""
    for begin, end in run.contacts()[:, :2]:
        times = np.linspace(begin, np.nextafter(end, begin), 20001)
        moments = run.sample(times)
        yield times, moments, from_apex(run, moments.turntable_angle)


def angular_momentum(run, time):
    """Of turntable and strikers about the axis, kg m^2/s: each striker's own motion along the blow, all else rigid."""
    span = run.span_at(time)
    at, system = span.layout, span.motion.system
    y, total = span.motion.sample(np.array([time]))[0][0], run.machine.drive.turntable.inertia
    total *= y[at.turntable_speed]
    for i, striker in enumerate(run.machine.strikers.each):
        first = -run.machine.radius * math.sin(y[at.angle] - math.atan2(system.seats[i, 1], system.seats[i, 0]))
        total += striker.mass * first * (y[at.speeds][i] - first * y[at.turntable_speed])
    return total


# one blow of bodies


@pytest.mark.verify
@pytest.mark.parametrize("name", STRIKES)
@pytest.mark.parametrize(("friction", "damping"), [(0.3, 0.0), (0.0, 40.0), (0.2, 20.0)])
def test_turntable_loses_radius_times_impulse_vector(name, friction, damping):
    """dL = R x dP: the normal impulse at the arm R sin u, the side impulse at the arm R cos u, summed over the blow.

    The law is written here once more; the forces are summed by Simpson's rule over what the run samples, the momentum
    comes from the integrated speeds. To 5e-5: a sample is that share of a contact,
    and the mount of 100 GN/m is bent by up to 1 um, on arms from 1 to 200 mm.
    """
    machine = machine_of(*ONE, *STRIKES[name], f"contact.friction={friction}", f"contact.sliding_damping={damping}")
    run = run_machine(machine)
    found, radius = blows(run)[0], machine.radius
    torque = side = heat = 0.0
    for times, moments, u in followed(run):
        sliding = radius * np.cos(u) * moments.turntable_speed
        pushing = moments.contact_force > 0.0
        pushing[0] = True  # from here on, though its force begins at 0
        drag = np.sign(sliding) * friction * moments.contact_force + damping * sliding * pushing
        torque += simpson(radius * np.sin(u) * moments.contact_force - radius * np.cos(u) * drag, x=times)
        side += simpson(drag, x=times)
        heat += simpson(drag * sliding, x=times)
    begin, end = run.contacts()[0, 0], run.contacts()[-1, 1]
    lost = angular_momentum(run, end) - angular_momentum(run, begin)
    assert torque == pytest.approx(lost, rel=5e-5)
    assert found.side_impulse == pytest.approx(side, rel=5e-5)
    assert found.friction_heat == pytest.approx(heat, rel=5e-5)
    assert run.energy_error < 1e-8
    assert found.momentum_error < 1e-8


@pytest.mark.verify
def test_side_impulse_of_one_way_sliding_is_friction_times_normal_impulse():
    for friction in (0.05, 0.3, 1.0):
        run = run_machine(machine_of(*ONE, f"contact.friction={friction}"))
        found = blows(run)[0]
        assert found.side_impulse == pytest.approx(friction * found.contact_impulse, rel=1e-12)
        assert found.side_force == pytest.approx(friction * found.peak_force, rel=1e-12)


def test_nose_along_the_path_drags_forth_and_back():
    """Before the strike position R cos u is below 0, behind it above: the side force changes sign there and nowhere else."""
    run = run_machine(machine_of(*ONE, *STRIKES["path"], "contact.friction=0.4"))
    ways = []
    for _, moments, u in followed(run):
        inside = moments.contact_force > 0.0
        ways += [np.sign(moments.side_force[inside])]
        assert np.array_equal(ways[-1], np.sign(np.cos(u[inside])))
    assert set(np.concatenate(ways)) == {-1.0, 1.0}


def test_viscous_drag_alone_slows_the_turntable_by_its_closed_form():
    """J w' = -c R^2 cos^2 u w while a nose passes a face that gives way without force: from u0 to u1 the turntable
    loses (c R^2/J)[u/2 + sin(2 u)/4], and J (w0^2 - w1^2)/2 is heat. To 1e-5: what the
    noses of 1 kg swing on their mounts.
    """
    machine = machine_of(*ONE, "contact.sliding_damping=200 N s/m")
    light = [dataclasses.replace(s, contact=Contact(10.0, 1.0)) for s in machine.strikers.each]
    machine = dataclasses.replace(machine, strikers=dataclasses.replace(machine.strikers, each=tuple(light)))
    run = run_machine(machine)
    found = blows(run)[0]
    before, after = run.sample(run.contacts()[0, :2]).turntable_speed
    inertia, u = machine.drive.turntable.inertia, from_apex(run, run.sample(run.contacts()[0, :2]).turntable_angle)
    assert u == pytest.approx([-0.235, 0.235], abs=0.05)
    way = np.diff(0.5 * u + 0.25 * np.sin(2.0 * u))[0]
    assert before - after == pytest.approx(200.0 * 0.2**2 / inertia * way, rel=1e-5)
    assert found.friction_heat == pytest.approx(0.5 * inertia * (before**2 - after**2), rel=1e-5)
    assert before - after > 1.0


@pytest.mark.verify
@settings(max_examples=12)
@given(
    strike=st.sampled_from(sorted(STRIKES)),
    friction=st.floats(0.0, 2.0),
    damping=st.floats(0.0, 200.0),
    inertia=st.floats(0.5, 10.0),
    restitution=st.floats(0.2, 1.0),
    mount=st.floats(7.0, 9.5),
)
def test_balances_close_with_any_friction(strike, friction, damping, inertia, restitution, mount):
    """Energy and momentum as without friction; friction only heats, and drags with no more than its law allows."""
    machine = machine_of(
        *STRIKES[strike],
        *("feed.blows=1", f"machine.inertia={inertia} kg m^2", f"striker.mount_stiffness={10**mount}"),
        *(f"contact.friction={friction}", f"contact.sliding_damping={damping}", f"contact.restitution={restitution}"),
    )
    run = run_machine(machine)
    found = blows(run)[0]
    assert run.energy_error < 1e-8
    assert found.momentum_error < 1e-8
    fastest = machine.radius * found.turntable_speed * 1.001  # the drive may speed it up by less than that in a blow
    allowed = friction * found.peak_force + damping * fastest
    assert abs(found.side_force) <= allowed * (1.0 + 1e-9)
    assert 0.0 <= found.friction_heat <= abs(found.side_impulse) * fastest * 1.001 or strike == "path"


def test_no_friction_drags_and_heats_nothing():
    found = blows(run_machine(machine_of("feed.blows=2", "contact.friction=0")))
    assert [(blow.side_force, blow.side_impulse, blow.friction_heat) for blow in found] == [(0.0, 0.0, 0.0)] * 2


# a struck stack


@pytest.fixture(scope="module")
def struck_stack():
    changes = ["feed.blows=1", "contact.friction=0.4", "contact.sliding_damping=30 N s/m", "machine.inertia=2 kg m^2"]
    return run_machine(build_machine(load_case("li-ma-2019-fig5", changes)))


def test_struck_stack_keeps_its_balances_with_friction(struck_stack):
    found = blows(struck_stack)[0]
    assert struck_stack.energy_error < 1e-6
    assert found.momentum_error < 1e-6


def test_struck_stack_books_what_its_law_says(struck_stack):
    """Side impulse and heat of one blow from the kept forces; to 1e-3, the trapezoidal rule at 0.1 us on waves of a us."""
    span = next(span for span in struck_stack.spans if isinstance(span, StackSpan))
    machine, found = struck_stack.machine, blows(struck_stack)[0]
    times = span.begin + span.step * np.arange(len(span.history))
    moments = span.sample(times)
    u = from_apex(struck_stack, moments.turntable_angle)
    sliding = machine.radius * np.cos(u) * moments.turntable_speed
    drag = (0.4 * moments.contact_force + 30.0 * sliding) * (moments.contact_force > 0.0)
    assert np.abs(moments.side_force - drag).max() < 1e-9 * drag.max()
    assert found.side_impulse == pytest.approx(np.trapezoid(drag, times), rel=1e-3)
    assert found.friction_heat == pytest.approx(np.trapezoid(drag * sliding, times), rel=1e-3)


def test_struck_stack_slows_the_turntable_as_bodies_do():
    """A second blow's turntable speed and the first one's side impulse, stack against nose and assembly: the waves
    change the contact force by some per cent, its impulse and what it takes from the turntable by far less."""
    changes = ["feed.blows=1", "contact.friction=0.4"]
    stack = build_machine(load_case("li-ma-2019-fig5", changes))
    bodies = dataclasses.replace(stack, layered=None)
    found = []
    for machine in (stack, bodies):
        run = run_machine(machine)
        blow = blows(run)[0]
        begin, end = run.sample(np.array([blow.time, blow.time + 1e-3])).turntable_speed
        found.append((blow.side_impulse / blow.contact_impulse, (begin - end) / blow.contact_impulse))
    assert found[0][0] == pytest.approx(0.4, rel=1e-9)
    assert found[0] == pytest.approx(found[1], rel=1e-3)


# where no nose slides


@pytest.mark.parametrize("case", ["iso-16063-22-dropball", "mil-s-901d-hammer", "en-166-ball", "machete-13-teeth"])
@pytest.mark.parametrize("field", ["friction=0.1", "sliding_damping=1 N s/m"])
def test_friction_across_the_face_is_refused_where_nothing_slides(case, field):
    with pytest.raises(InputError, match=rf"^contact\.{field.split('=')[0]}: .*rotary.*remove it"):
        build_machine(load_case(case, [f"contact.{field}"]))
