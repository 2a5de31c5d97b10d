"""Coulomb friction with sticking, and bases that shake: closed forms of textbooks, located switches, their rate."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.contact import Chain, ChainContact, Contact, Friction, Spring, Vibration, simulate
from strikewave.contact.damping import factor

G = 9.81


def on_spring(stiffness, sliding, sticking=None, mass=1.0):
    links = [Spring("block", "wall", stiffness), Friction("block", "wall", sliding, sticking)]
    return Chain({"block": mass}, links, {"wall": 0.0})


@given(
    stiffness=st.floats(10.0, 1e5), mass=st.floats(0.01, 50.0), share=st.floats(0.03, 0.7), begins=st.floats(1e-4, 0.5)
)
def test_block_on_a_spring_loses_twice_the_dead_band_a_swing(stiffness, mass, share, begins):
    """Den Hartog, Mechanical Vibrations: each half swing loses 2 F/k, and it stops where |x| <= F/k first holds."""
    sliding = share * stiffness * begins
    half = math.pi * math.sqrt(mass / stiffness)
    left, swings = begins, 0
    while abs(left) > sliding / stiffness:
        left = -(left - math.copysign(2.0 * sliding / stiffness, left))
        swings += 1
    # at the very edge of the dead band rounding decides whether it moves once more
    near = [abs(begins * (1 - 2 * share * n)) / (sliding / stiffness) for n in range(40)]
    if min(abs(r - 1.0) for r in near) < 1e-6:
        return
    motion = simulate(on_spring(stiffness, sliding, mass=mass), {"block": begins}, {}, (swings + 0.5) * half)
    stands = motion.positions(swings * half + 0.25 * half)[0]
    # the tolerance of a step is 1e-9 of the swing's scale; some tens of steps a swing
    assert stands == pytest.approx(left, abs=1e-6 * begins)
    assert motion.speeds((swings + 0.4) * half)[0] == pytest.approx(0.0, abs=1e-9)
    lost = motion.dissipated()[1]
    assert lost == pytest.approx(0.5 * stiffness * (begins**2 - left**2), rel=1e-7)


@given(sliding=st.floats(0.5, 8.0), speed=st.floats(0.1, 20.0), mass=st.floats(0.1, 10.0))
def test_slider_stops_after_v_squared_over_twice_the_deceleration(sliding, speed, mass):
    chain = Chain({"block": mass}, [Friction("block", "floor", sliding)], {"floor": 0.0})
    time = mass * speed / sliding
    motion = simulate(chain, {}, {"block": speed}, 1.5 * time)
    assert motion.positions(1.2 * time)[0] == pytest.approx(0.5 * mass * speed**2 / sliding, rel=1e-9)
    assert motion.speeds(1.2 * time)[0] == 0.0


@pytest.mark.parametrize(("sticking", "moves"), [(9.0, True), (9.8 * 1.001, False)])
def test_block_on_a_slope_slides_only_beyond_the_sticking_force(sticking, moves):
    """Gravity pulls 1 kg with 9.8 N along the slope; once it moves the sliding force, 4 N, is against it."""
    chain = Chain({"block": 1.0}, [Friction("block", "slope", 4.0, sticking)], {"slope": 0.0}, gravity=9.8)
    motion = simulate(chain, {}, {}, 1.0)
    expected = 5.8 if moves else 0.0
    assert motion.speeds(1.0)[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert motion.forces(0.9)[0] == pytest.approx(4.0 if moves else 9.8, rel=1e-12)


def test_two_sliding_bodies_come_to_their_common_speed():
    chain = Chain({"a": 2.0, "b": 3.0}, [Friction("a", "b", 6.0)])
    motion = simulate(chain, {}, {"a": 5.0}, 3.0)
    # closing at 5 m/s, decelerated by 6/2 + 6/3 m/s^2: after 1 s at 2 m/s both
    assert motion.speeds(0.5) == pytest.approx([3.5, 1.0], rel=1e-10)
    assert motion.speeds(2.0) == pytest.approx([2.0, 2.0], rel=1e-10)
    assert motion.dissipated()[0] == pytest.approx(0.5 * (2 * 3 / 5) * 25, rel=1e-10)


def test_block_on_a_shaking_table_sticks_below_its_friction_and_slips_above():
    """It sticks while a w^2 stays below F/m; beyond, it first slips at the phase where a w^2 |sin| = F/m."""
    w, a, m = 30.0, 2e-3, 1.5
    table = Vibration(0.0, a, w)
    held = simulate(
        Chain({"block": m}, [Friction("block", "table", 1.01 * m * a * w**2)], {"table": table}),
        {},
        {"block": a * w},
        0.5,
    )
    times = np.linspace(0.0, 0.5, 101)
    assert held.positions(times)[:, 0] == pytest.approx(a * np.sin(w * times), abs=1e-8 * a)  # some 10 steps
    share = 0.6
    slips = simulate(
        Chain({"block": m}, [Friction("block", "table", share * m * a * w**2)], {"table": table}),
        {},
        {"block": a * w},
        0.5,
    )
    first = math.asin(share) / w
    assert slips.speeds(0.999 * first)[0] == pytest.approx(a * w * math.cos(w * 0.999 * first), rel=1e-9)
    # then it decelerates at the constant rate share a w^2 until the table's speed meets it again
    later = first + 0.02
    expected = a * w * math.cos(w * first) - share * a * w**2 * 0.02
    assert slips.speeds(later)[0] == pytest.approx(expected, rel=1e-8)


def test_time_of_sticking_converges_with_the_tolerance():
    """The end of the last swing of a block on a spring, pi sqrt(m/k) a swing: the error falls with the tolerance."""
    chain, half = on_spring(400.0, 2.0), math.pi * math.sqrt(1.0 / 400.0)
    errors = []
    for tolerance in (1e-4, 1e-6, 1e-8):
        motion = simulate(chain, {"block": 0.033}, {}, 5.0 * half, tolerance)
        switched = motion.motion.switched
        stuck = switched.time[switched.which == 3][-1]  # the only switch of the second link
        errors.append(abs(stuck / half - round(stuck / half)))
    assert errors[2] < 1e-8
    assert errors[1] < 0.1 * errors[0] or errors[1] < 1e-10
    assert errors[2] < 0.1 * errors[1] or errors[2] < 1e-10


def bouncing(e, vibration, stiffness=1e12):
    """A ball of 1 kg above a plate; the contact is 40 um deep and lasts some 40 us."""
    contact = Contact(stiffness, 1.5, float(factor("exact", e)))
    return Chain({"ball": 1.0}, [ChainContact("plate", "ball", contact)], {"plate": vibration}, gravity=-G)


def test_ball_on_a_fixed_plate_rises_by_e_squared_each_time():
    """Heights h e^(2n); the way of the contact, 40 um, and its weight are felt by 5e-4 of them."""
    e, height = 0.8, 0.5
    motion = simulate(bouncing(e, 0.0), {"ball": height}, {}, 2.5)
    fall = math.sqrt(2.0 * height / G)
    tops = [fall * (1.0 + 2.0 * sum(e**k for k in range(1, n)) + e**n) for n in (1, 2, 3)]
    assert motion.positions(np.array(tops))[:, 0] == pytest.approx(
        [height * e**2, height * e**4, height * e**6], rel=1e-3
    )


@pytest.mark.parametrize("periods", [1, 2])
def test_ball_on_a_vibrating_plate_stays_on_its_period_one_orbit(periods):
    """Holmes 1982 (J. Sound Vib. 84, 173): it leaves with g T/2 once every n periods T/n of the plate.

    Newton's law gives the plate's speed at the blow, u = (1 - e)/(1 + e) g T/2, and so its phase. The stable one of
    the two phases has the plate rising and slowing down.
    """
    e, w = 0.7, 2.0 * math.pi * 40.0
    flight = periods * 2.0 * math.pi / w
    needed = (1.0 - e) / (1.0 + e) * 0.5 * G * flight
    amplitude = 1.15 * needed / w
    phase = math.acos(needed / (amplitude * w))
    plate = Vibration(0.0, amplitude, w, phase)
    chain = bouncing(e, plate, stiffness=1e11)
    begins = amplitude * math.sin(phase)
    motion = simulate(chain, {"ball": begins}, {"ball": 0.5 * G * flight}, 40.5 * flight)
    blows = motion.contacts(0)
    blows = blows[blows[:, 0] > 0.1 * flight]
    intervals = np.diff(blows[:, 0])
    # the contact takes 2e-3 of the flight: it begins off the orbit of a real contact by that, and draws near it
    assert len(blows) == 40
    assert intervals == pytest.approx(flight, rel=1e-2)
    assert intervals[-10:] == pytest.approx(flight, rel=1e-5)
    assert blows[-10:, 2] == pytest.approx(0.5 * G * flight + needed, rel=5e-3)


def test_impact_oscillator_keeps_the_analytic_period_one_orbit():
    """Shaw & Holmes 1983 (J. Sound Vib. 90, 129): a mass on a shaken spring before a rigid stop, one blow a period.

    Between blows x = C cos w0 t + S sin w0 t + A cos(w t + p); x = gap and v+ = -e v- at both ends of a period are
    three linear equations for C, S and v once p is chosen, and the fourth fixes p.
    """
    from scipy.optimize import brentq

    m, k, e, w, shake, gap = 1.0, 100.0, 0.6, 26.0, 4e-3, 0.0
    w0, period = 10.0, 2.0 * math.pi / 26.0
    forced = shake * w0**2 / (w0**2 - w**2)

    def orbit(p):
        c0, s0 = math.cos(w0 * period), math.sin(w0 * period)
        # unknown C, S, u = speed before the blow
        a = np.array([[1.0, 0.0, 0.0], [c0, s0, 0.0], [0.0, w0, e]])
        b = np.array([gap - forced * math.cos(p)] * 2 + [forced * w * math.sin(p)])
        c, s, u = np.linalg.solve(a, b)
        return c, s, u, -c * w0 * s0 + s * w0 * c0 - forced * w * math.sin(p) - u

    phases = np.linspace(0.0, 2.0 * math.pi, 400)
    values = [orbit(p)[3] for p in phases]
    roots = [
        brentq(lambda p: orbit(p)[3], a, b)
        for a, b, fa, fb in zip(phases[:-1], phases[1:], values[:-1], values[1:], strict=True)
        if fa * fb < 0.0
    ]
    found = [(p, orbit(p)) for p in roots if orbit(p)[2] > 0.0]
    assert found
    p, (_, _, u, _) = found[0]
    contact = Contact(1e10, 1.5, float(factor("exact", e)))
    # x is positive towards the stop at 0; the spring hangs on a base that shakes by `shake` cos(w t + p)
    base = Vibration(0.0, shake, w, p + 0.5 * math.pi)
    links = [Spring("base", "mass", k), ChainContact("mass", "stop", contact)]
    chain = Chain({"mass": m}, links, {"base": base, "stop": gap})
    motion = simulate(chain, {"mass": gap}, {"mass": -e * u}, 8.5 * period)
    blows = motion.contacts(1)
    blows = blows[blows[:, 0] > 0.1 * period]
    assert np.diff(blows[:, 0])[:4] == pytest.approx(period, rel=5e-3)
    assert blows[:4, 2] == pytest.approx(u, rel=1e-2)


def test_wrong_friction_is_refused():
    with pytest.raises(ValueError, match="sliding <= sticking"):
        Chain({"a": 1.0}, [Friction("a", "floor", 5.0, 4.0)], {"floor": 0.0})
    with pytest.raises(ValueError, match="one friction link at most"):
        Chain({"a": 1.0}, [Friction("a", "floor", 5.0), Friction("a", "wall", 4.0)], {"floor": 0.0, "wall": 1.0})
