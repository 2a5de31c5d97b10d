"""Spin-up and braking against the integrated equation of motion."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.machines import Turntable
from strikewave.machines.drive import braking_time, speed_after_wait, spin_up_time

DISC = {"inertia": 4.0, "radius": 0.2, "speed": 76.4}


@given(torque=st.floats(10, 100), gain=st.floats(1, 100), drag=st.floats(0, 0.1))
def test_spin_up_against_the_equation_of_motion(torque, gain, drag):
    disc = Turntable(**DISC, torque=torque, speed_gain=gain, drag=drag, brake=30.0)
    time = spin_up_time(disc)

    def rate(_, y):
        wanted = drag * disc.speed + gain * (disc.speed - y[0])
        return [(min(max(wanted, 0.0), torque) - drag * y[0]) / disc.inertia]

    solved = solve_ivp(rate, (0, time), [0.0], rtol=1e-10, atol=1e-12, max_step=time / 200)
    assert solved.y[0, -1] == pytest.approx(disc.speed * (1 - 1e-4), rel=1e-6)


@given(drag=st.floats(0, 1), brake=st.floats(1, 100))
def test_braking_against_the_equation_of_motion(drag, brake):
    disc = Turntable(**DISC, torque=100.0, speed_gain=20.0, drag=drag, brake=brake)
    time = braking_time(disc, disc.speed)
    solved = solve_ivp(lambda _, y: [-(brake + drag * y[0]) / disc.inertia], (0, time), [disc.speed], rtol=1e-10)
    assert solved.y[0, -1] == pytest.approx(0.0, abs=1e-6)


def test_waiting_ends_at_the_set_speed():
    disc = Turntable(**DISC, torque=40.0, speed_gain=20.0, drag=0.02, brake=30.0)
    assert speed_after_wait(disc, 0.0) == pytest.approx(disc.speed * (1 - 1e-4), rel=1e-15)
    assert math.isclose(speed_after_wait(disc, 100.0), disc.speed, rel_tol=1e-15)


def test_drive_that_cannot_hold_the_speed_is_refused():
    with pytest.raises(ValueError, match="cannot hold"):
        spin_up_time(Turntable(**DISC, torque=1.0, speed_gain=20.0, drag=0.5, brake=30.0))


def test_a_turntable_speeds_up_evenly_and_then_in_halves():
    """40 N m on 4 kg m2: 0.8 s to 8 rad/s, where 20 N m s/rad ask for less; then the rest halves every 0.2 ln 2 s."""
    disc = Turntable(3.0, 0.2, 10.0, torque=40.0, speed_gain=20.0, drag=0.0, brake=8.0, motor_inertia=1.0)
    assert spin_up_time(disc, 0.2 / 2**10) == pytest.approx(0.8 + 10 * 0.2 * math.log(2.0), rel=1e-12)
    assert speed_after_wait(disc, 0.2 * math.log(2.0), 0.2) == pytest.approx(9.0, rel=1e-12)
    assert braking_time(disc, 8.0) == pytest.approx(4.0, rel=1e-12)
    assert spin_up_time(disc, 0.5) == pytest.approx(0.8, rel=1e-12)  # there before the controller asks for less
    dragged = Turntable(4.0, 0.2, 10.0, torque=40.0, speed_gain=20.0, drag=2.0, brake=4.0)
    # 9 rad/s at w' = 10 - w/2, then the rate (20 + 2)/4 for the last tenth, halved
    assert spin_up_time(dragged, 0.05) == pytest.approx(2.0 * math.log(20.0 / 11.0) + math.log(2.0) / 5.5, rel=1e-12)
    assert braking_time(dragged, 2.0) == pytest.approx(2.0 * math.log(2.0), rel=1e-12)


def test_little_drag_takes_little_from_a_spin_up_and_a_braking():
    """By first order x/2 of what the drag takes at the end, x, also across the switch to the closed form without it."""
    for x in (1e-8, 1e-10, 1e-12):
        disc = Turntable(4.0, 0.2, 10.0, torque=40.0, speed_gain=1e15, drag=4.0 * x, brake=8.0)
        assert spin_up_time(disc, 1e-6) == pytest.approx(1.0 + 0.5 * x, rel=1e-12)
        assert braking_time(disc, 2.0) == pytest.approx(1.0 - 0.5 * x, rel=1e-12)
    assert disc.rigid_belt
    assert not Turntable(4.0, 0.2, 10.0, 40.0, 20.0, 0.0, 8.0, belt_stiffness=1e9).rigid_belt


def test_spin_up_ends_at_the_tolerance_and_a_drive_that_just_holds_is_refused():
    """Where the controller asks for less from the begin there is no full torque: ln 2 by 40/(20 + 0) for each half."""
    disc = Turntable(40.0, 0.2, 1.0, torque=40.0, speed_gain=20.0, drag=0.0, brake=8.0)
    assert spin_up_time(disc, 0.25) == pytest.approx(2.0 * 2.0 * math.log(2.0), rel=1e-12)
    assert spin_up_time(disc) == pytest.approx(2.0 * math.log(1e4), rel=1e-12)
    assert speed_after_wait(disc, 2.0) == pytest.approx(1.0 - 1e-4 / math.e, rel=1e-14)
    for drag, refused in ((3.9999, False), (4.0, True)):
        held = Turntable(4.0, 0.2, 10.0, torque=40.0, speed_gain=20.0, drag=drag, brake=8.0)
        if refused:
            with pytest.raises(ValueError, match="cannot hold"):
                spin_up_time(held)
        else:
            assert spin_up_time(held) > 1.0
