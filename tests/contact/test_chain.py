"""The integrator against closed forms, an independent scipy model, and the laws of mechanics."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.contact import Chain, ChainContact, Contact, Spring, Stop, exact, simulate, solve_impact
from strikewave.contact._dop853 import A, B, C
from strikewave.contact.dampers import cut_off_damping_ratio, cut_off_restitution


def two_bodies(contact, m1, m2, speed, duration, tolerance):
    chain = Chain({"striker": m1, "object": m2}, links=[ChainContact("striker", "object", contact)])
    return simulate(chain, {}, {"striker": speed}, duration, tolerance)


def test_dop853_order_conditions():
    """The quadrature conditions of order 8 and the row sums (Hairer, Norsett & Wanner, section II.1)."""
    for q in range(1, 9):
        assert B @ C[:12] ** (q - 1) == pytest.approx(1 / q, rel=1e-13)
    assert np.allclose(A.sum(axis=1), C, rtol=0, atol=2e-15)


@given(
    n=st.floats(1.0, 2.0),
    e=st.floats(0.05, 1.0),
    m1=st.floats(1e-3, 1e2),
    m2=st.floats(1e-3, 1e2),
    stiffness=st.floats(1e6, 1e12),
    speed=st.floats(1e-2, 1e2),
)
def test_integrator_meets_the_closed_form(n, e, m1, m2, stiffness, speed):
    """1e-7 at a tolerance of 1e-8, twice that at worst: random masses, speeds, restitution, stiffness and exponent."""
    contact = Contact(stiffness, n, exact(e))
    closed = solve_impact(contact, m1, m2, speed)
    duration = float(closed.duration)
    motion = two_bodies(contact, m1, m2, speed, 1.5 * duration, 1e-8)
    begin, end, approach = motion.contacts(0)[0]
    assert approach == pytest.approx(speed, rel=1e-12)
    assert end - begin == pytest.approx(duration, rel=1e-7)
    after = motion.speeds(1.5 * duration)
    assert (after[1] - after[0]) / speed == pytest.approx(e, rel=2e-7, abs=1e-8)
    # at the largest indentation the closing speed is zero: find it on the dense output
    low, high = 0.0, end
    for _ in range(80):
        middle = 0.5 * (low + high)
        v = motion.speeds(middle)
        low, high = (middle, high) if v[0] > v[1] else (low, middle)
    x = motion.positions(low)
    assert x[0] - x[1] == pytest.approx(float(closed.max_indentation), rel=1e-7)
    # no sample exceeds the closed form's peak force, and it is reached
    forces = motion.forces(np.linspace(0, duration, 4001))[:, 0]
    assert forces.max() <= float(closed.peak_force) * (1 + 1e-7)
    assert forces.max() == pytest.approx(float(closed.peak_force), rel=1e-3 if e < 0.2 else 1e-5)
    assert m1 * after[0] + m2 * after[1] == pytest.approx(m1 * speed, rel=1e-12)
    assert motion.dissipated()[0] == pytest.approx(float(closed.energy_lost), rel=1e-6, abs=1e-7 * m1 * speed**2)


def test_error_follows_the_tolerance():
    """The restitution's error falls at least as fast as the tolerance's power 0.8, over five decades."""
    contact = Contact(4.7e9, 1.5, exact(0.6))
    duration = 1.5 * float(solve_impact(contact, 0.2, 0.459, 20.0).duration)
    tolerances = np.array([1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10])
    errors = []
    for tolerance in tolerances:
        v = two_bodies(contact, 0.2, 0.459, 20.0, duration, tolerance).speeds(duration)
        errors.append(abs((v[1] - v[0]) / 20.0 / 0.6 - 1.0))
    rate = np.polyfit(np.log10(tolerances), np.log10(np.maximum(errors, 1e-15)), 1)[0]
    assert rate > 0.8, f"rate {rate:.2f}, errors {errors}"


def scipy_chain(masses, kf, cf, contact, speed, duration):
    """An independent model of striker, nose, frame and assembly: force clipped at zero, no event location."""
    m1, mn, ma = masses
    k, n, chi = contact

    def rates(_, y):
        x1, xn, xa, v1, vn, va = y
        d, rate = x1 - xn, v1 - vn
        force = max(k * max(d, 0.0) ** n * (1 + chi * rate / speed), 0.0)
        frame = kf * (xn - xa) + cf * (vn - va)
        return [v1, vn, va, -force / m1, (force - frame) / mn, frame / ma]

    solved = solve_ivp(
        rates,
        (0, duration),
        [0, 0, 0, speed, 0, 0],
        method="DOP853",
        rtol=1e-10,
        atol=1e-13,
        max_step=duration / 4000,
        dense_output=True,
    )
    t = np.linspace(0, duration, 40001)
    y = solved.sol(t)
    return (kf * (y[1] - y[2]) + cf * (y[4] - y[5])) / ma


@pytest.mark.verify
@given(
    m1=st.floats(0.05, 5.0),
    mn=st.floats(0.03, 0.2),
    ma=st.floats(0.2, 2.0),
    kf=st.floats(1e7, 3e8),
    e=st.floats(0.3, 1.0),
    speed=st.floats(0.5, 20.0),
)
def test_rigid_peak_against_an_independent_scipy_chain(m1, mn, ma, kf, e, speed):
    """Within 0.1 %, where no re-contact is faster than the first contact.

    The independent model keeps the first approach speed for re-contacts, and so do we with ``slowest_approach``; the
    frame may throw a light nose back faster than that, and then the two laws differ.
    """
    cf = 0.05 * 2 * math.sqrt(kf * mn)
    stiffness, exponent, chi = 4.7e9, 10 / 9, float(exact(e))
    duration = 1.2 * math.pi * math.sqrt(ma / kf)
    chain = Chain(
        {"striker": m1, "nose": mn, "assembly": ma},
        links=[
            ChainContact("striker", "nose", Contact(stiffness, exponent, chi), slowest_approach=speed),
            Spring("nose", "assembly", kf, cf),
        ],
    )
    motion = simulate(chain, {}, {"striker": speed}, duration)
    assume((motion.contacts(0)[:, 2] <= speed).all())
    expected = scipy_chain((m1, mn, ma), kf, cf, (stiffness, exponent, chi), speed, duration).max()
    peak = motion.forces(np.linspace(0, duration, 40001))[:, 1].max() / ma
    assert peak == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("asked", [0.05, 0.1353, 0.3, 0.6, 0.95])
def test_stop_gives_its_restitution_and_never_pulls(asked):
    mass, stiffness = 0.459, 2e5
    damping = 2 * cut_off_damping_ratio(asked) * math.sqrt(stiffness * mass)
    chain = Chain({"object": mass}, bases={"wall": 0.0}, links=[Stop("object", "wall", stiffness, damping)])
    duration = 6 * math.sqrt(mass / stiffness) * max(1.0, cut_off_damping_ratio(asked))
    motion = simulate(chain, {}, {"object": 3.0}, duration)
    assert -motion.speeds(duration)[0] / 3.0 == pytest.approx(asked, rel=1e-7)
    assert motion.forces(np.linspace(0, duration, 2001)).min() >= 0.0


@pytest.mark.verify
@given(st.floats(0.0, 5.0))
def test_cut_off_restitution_against_its_time_integral(zeta):
    """Integrate m x'' + c x' + k x = 0 with unit constants until the force is zero; compare speeds."""
    solved = solve_ivp(
        lambda _, y: [y[1], -y[0] - 2 * zeta * y[1]],
        (0, 60),
        [0.0, 1.0],
        rtol=1e-11,
        atol=1e-14,
        events=[lambda t, y: (y[0] + 2 * zeta * y[1]) if t > 1e-9 else 1.0],
    )
    times, speeds = solved.t_events[0], solved.y_events[0]
    assert times.size
    assert -speeds[0][1] == pytest.approx(cut_off_restitution(zeta), rel=1e-6)


def test_three_balls_pass_the_blow_on():
    """Equal elastic balls in a row, a gap between each: the last takes the whole speed (Newton's cradle)."""
    contact = Contact(1e9, 1.5)
    chain = Chain(
        {"a": 0.1, "b": 0.1, "c": 0.1},
        links=[ChainContact("a", "b", contact), ChainContact("b", "c", contact, offset=0.0)],
    )
    motion = simulate(chain, {"a": -1e-3, "b": 0.0, "c": 1e-3}, {"a": 1.0}, 4e-3, 1e-10)
    assert motion.speeds(4e-3) == pytest.approx([0.0, 0.0, 1.0], abs=1e-8)
    assert len(motion.contacts(0)) == len(motion.contacts(1)) == 1


def test_spring_mass_against_the_damped_oscillator():
    mass, k, zeta = 0.3, 5e4, 0.1
    w = math.sqrt(k / mass)
    chain = Chain(
        {"m": mass}, bases={"wall": 0.0}, links=[Spring("m", "wall", k, 2 * zeta * w * mass)], gravity=9.80665
    )
    t = np.linspace(0, 0.2, 501)
    motion = simulate(chain, {"m": 1e-3}, {}, 0.2)
    rest = mass * 9.80665 / k
    wd = w * math.sqrt(1 - zeta**2)
    expected = rest + (1e-3 - rest) * np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t))
    assert motion.positions(t)[:, 0] == pytest.approx(expected, abs=1e-11)


@given(st.integers(2, 5), st.randoms(use_true_random=False))
def test_random_chains_keep_momentum_and_energy(count, random):
    """Free chains of random bodies, springs and lossy contacts: momentum 1e-12, energy balance 1e-7.

    To the balance come ten local errors of losses, each 1e-9 of the energy that all bodies have at the highest speed:
    a contact whose force has ended loses what it stores as a power of its indentation, which ends with a kink.
    """
    names = [f"b{i}" for i in range(count)]
    masses = {name: 10 ** random.uniform(-2, 1) for name in names}
    links = []
    for behind, ahead in itertools.pairwise(names):
        if random.random() < 0.5:
            stiffness = 10 ** random.uniform(4, 8)
            links.append(Spring(behind, ahead, stiffness, random.uniform(0, 0.1) * math.sqrt(stiffness)))
        else:
            law = Contact(10 ** random.uniform(7, 10), random.uniform(1, 2), float(exact(random.uniform(0.2, 1))))
            links.append(ChainContact(behind, ahead, law, slowest_approach=0.1))
    chain = Chain(masses, links=links)
    speeds = {name: random.uniform(-5, 5) for name in names}
    motion = simulate(chain, {}, speeds, 2e-3)
    v = motion.speeds(2e-3)
    m = np.array(list(masses.values()))
    v0 = np.array([speeds[name] for name in names])
    scale = m @ np.abs(v0)
    assert m @ v == pytest.approx(m @ v0, abs=1e-12 * scale)
    from strikewave.contact.chain import link_arrays, stored_energy

    stored = stored_energy(link_arrays(links, names), motion.positions(2e-3))
    before = 0.5 * m @ v0**2
    error = 1e-7 * before + 1e-8 * 0.5 * m.sum() * np.max(np.abs(v0)) ** 2
    assert 0.5 * m @ v**2 + stored + motion.dissipated().sum() == pytest.approx(before, abs=error)
    assert np.all(motion.dissipated() >= -1e-9 * before)


@pytest.mark.parametrize("speed", np.linspace(4.4294, 4.62, 40))
def test_no_grazing_contact_is_missed(speed):
    """1 kg thrown at a ceiling 1 m above: it touches whenever v0^2 > 2 g h, however briefly beside the step."""
    gravity = -9.81
    chain = Chain(
        {"ball": 1.0},
        bases={"ceiling": 1.0},
        links=[ChainContact("ball", "ceiling", Contact(1e6, 1.5))],
        gravity=gravity,
    )
    motion = simulate(chain, {}, {"ball": speed}, duration=0.85)
    closing = speed**2 - 2 * 9.81
    assert len(motion.contacts(0)) == (1 if closing > 0 else 0)
    if closing > 0:
        assert motion.contacts(0)[0, 2] == pytest.approx(math.sqrt(closing), rel=1e-6)


def test_resting_contact_settles_where_weight_and_stiffness_balance():
    chain = Chain(
        {"ball": 1.0}, bases={"floor": 0.0}, links=[ChainContact("ball", "floor", Contact(1e9, 1.5, 2.0))], gravity=9.81
    )
    motion = simulate(chain, {}, {}, duration=0.5)
    assert motion.positions(0.5)[0] == pytest.approx((9.81 / 1e9) ** (2 / 3), rel=1e-3)


def test_ball_dropped_from_rest_keeps_the_restitution():
    """Dropped 1 m on an exact contact of e = 0.6, it rises to e^2 of the height (static sag left out)."""
    chain = Chain(
        {"ball": 1.0},
        bases={"floor": 1.0},
        links=[ChainContact("ball", "floor", Contact(1e9, 1.5, exact(0.6)))],
        gravity=9.81,
    )
    motion = simulate(chain, {}, {}, duration=0.8)
    t = np.linspace(0.46, 0.8, 4001)
    assert 1 - motion.positions(t).min() == pytest.approx(0.36, rel=2e-3)


def test_initial_overlap_takes_the_speed_it_has():
    chain = Chain({"a": 1.0, "b": 1.0}, links=[ChainContact("a", "b", Contact(1e9, 1.0, exact(0.5)))])
    motion = simulate(chain, {"a": 1e-6}, {"a": 1.0}, duration=1e-3)
    assert motion.forces(0.0)[0] == pytest.approx(1e3 * (1 + float(exact(0.5))), rel=1e-9)
    assert motion.contacts(0)[0, 2] == 1.0


def test_samples_come_in_any_order_and_only_from_within():
    chain = Chain({"m": 1.0}, bases={"wall": 0.0}, links=[Spring("m", "wall", 1e4)])
    motion = simulate(chain, {"m": 1e-3}, {}, duration=1.0)
    t = np.array([0.9, 0.1, 0.5])
    assert np.array_equal(motion.positions(t), motion.positions(np.sort(t))[[2, 0, 1]])
    for outside in (-0.1, 1.1, math.nan):
        with pytest.raises(ValueError, match="within the motion"):
            motion.positions(outside)
    for duration in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="must end"):
            simulate(chain, {"m": 1e-3}, {}, duration)


@pytest.mark.parametrize(
    ("bodies", "bases", "links"),
    [
        ({"a": 1.0}, {"a": 0.0}, []),
        ({"a": 1.0}, {"p": 0.0, "q": 0.0}, [Spring("p", "q", 1.0)]),
        ({"a": 1.0}, {}, [Spring("a", "a", 1.0)]),
        ({"a": 1.0, "b": 1.0}, {}, [Stop("a", "b", -1.0)]),
        ({"a": 1.0, "b": 1.0}, {}, [ChainContact("a", "b", Contact(1e9, 1.5, -1.0))]),
        ({}, {"p": 0.0}, []),
    ],
)
def test_links_that_make_no_sense_are_refused(bodies, bases, links):
    with pytest.raises(ValueError, match=r"node|link"):
        Chain(bodies, links, bases)


def test_unknown_body_at_the_start_is_refused():
    chain = Chain({"a": 1.0, "b": 1.0}, links=[Spring("a", "b", 1.0)])
    with pytest.raises(ValueError, match="no body 'bb'"):
        simulate(chain, {"bb": 0.1}, {}, 1.0)


def test_impossible_chains_are_refused():
    with pytest.raises(ValueError, match="positive and finite"):
        Chain({"a": 0.0}, links=[])
    with pytest.raises(ValueError, match='did you mean "striker"'):
        Chain({"striker": 1.0, "object": 1.0}, links=[ChainContact("strker", "object", Contact(1e9, 1.5))])
