"""The integrator against closed forms, an independent scipy model, and the laws of mechanics."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import DOP853, solve_ivp

from strikewave.base.errors import IntegrationError
from strikewave.contact import (
    Chain,
    ChainContact,
    Contact,
    Damper,
    Friction,
    PressureCap,
    Spring,
    Stop,
    Vibration,
    exact,
    simulate,
    solve_impact,
)
from strikewave.contact import motion as motions
from strikewave.contact._chain_kernels import (
    OPEN,
    PUSHING,
    SLIDING,
    SLIDING_BACK,
    STICKING,
    YIELDING,
    let_go,
    link_of,
    never_touches,
)
from strikewave.contact._integrator import A, B, C
from strikewave.contact.chain import (
    _longest_step,
    _speed_scale,
    compressions,
    first_depths,
    first_modes,
    link_arrays,
    shortest_time,
    stored_energy,
)
from strikewave.contact.damping import cut_off_damping_ratio, cut_off_restitution


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


def test_initial_overlap_of_two_that_move_takes_the_speed_at_which_they_close():
    """5 and 3 m/s close at 2: K d^n (1 + 0.5 x 2/2), one base that shakes counts with its speed."""
    links = [ChainContact("a", "b", Contact(4e4, 2.0, 0.5)), ChainContact("table", "a", Contact(6e4, 2.0, 0.5))]
    shaken = {"table": Vibration(0.03, 0.02, 400.0)}  # 8 m/s at first
    motion = simulate(Chain({"a": 2.0, "b": 3.0}, links, shaken), {"a": 0.01}, {"a": 5.0, "b": 3.0}, 1e-4)
    assert motion.forces(0.0) == pytest.approx([1.5 * 4.0, 1.5 * 24.0], rel=1e-12)
    assert motion.contacts(0)[0] == pytest.approx([0.0, 1e-4, 2.0], rel=1e-14)
    assert motion.contacts(1)[0, 2] == pytest.approx(3.0, rel=1e-15)


def test_samples_come_in_any_order_and_only_from_within():
    chain = Chain({"m": 1.0}, bases={"wall": 0.0}, links=[Spring("m", "wall", 1e4)])
    motion = simulate(chain, {"m": 1e-3}, {}, duration=1.0)
    t = np.array([0.9, 0.1, 0.5])
    assert np.array_equal(motion.positions(t), motion.positions(np.sort(t))[[2, 0, 1]])
    for outside in (-0.1, 1.1, math.nan, [0.5, 1.1], [-0.1, 0.5]):
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


def of_every_kind():
    """Links of two bodies and a wall: nodes a, b, wall."""
    capped = Contact(1e9, 1.5, cap=PressureCap(1e3, "point"))
    return [
        Spring("a", "b", 100.0, 3.0, preload=5.0, offset=0.1),
        Stop("a", "b", 200.0, 1.0, offset=0.2),
        ChainContact("b", "wall", Contact(3e3, 2.0), offset=-0.5),
        ChainContact("a", "wall", capped),
        Friction("a", "b", 2.0),
    ]


def test_compressions_and_what_links_store_worked_by_hand():
    """d = x_a - x_b - offset; spring P d + k d^2/2 either way, stop and contact only where pressed, friction nothing."""
    links = link_arrays(of_every_kind(), ["a", "b", "wall"])
    nodes = np.array([0.5, 0.1, 0.4])
    assert compressions(links, nodes) == pytest.approx([0.3, 0.2, 0.2, 0.1, 0.4], rel=1e-14)
    elastic = Contact(1e9, 1.5)
    apart = link_arrays([*of_every_kind()[:3], ChainContact("a", "wall", elastic)], ["a", "b", "wall"])
    # 5 x 0.3 + 50 x 0.09, 100 x 0.04, 1e3 x 0.008, 4e8 x 0.1^2.5
    parts = [6.0, 4.0, 8.0, 4e8 * 0.1**2.5]
    assert stored_energy(apart, nodes) == pytest.approx(sum(parts), rel=1e-14)
    mode = np.array([PUSHING, PUSHING, OPEN, PUSHING])
    assert stored_energy(apart, nodes, mode=mode) == pytest.approx(sum(parts) - 8.0, rel=1e-14)
    # apart: d = -0.5, -0.6, -0.3, -0.4
    assert stored_energy(apart, np.array([0.0, 0.4, 1.2 - 0.8])) == pytest.approx(-2.5 + 12.5 + 3e3 / 3 * 0.5**3)


def test_first_depths_and_modes_of_every_kind():
    links = link_arrays(of_every_kind(), ["a", "b", "wall"])
    assert first_depths(links) == pytest.approx([0.0, 0.0, 0.0, (1e3 / 1e9) ** (2 / 3), 0.0], rel=1e-14)
    near, far = np.array([0.5, 0.1, 0.4]), np.array([0.0, 0.4, 1.2])
    assert list(first_modes(links, near)) == [PUSHING, PUSHING, PUSHING, PUSHING, STICKING]
    assert list(first_modes(links, far)) == [PUSHING, OPEN, OPEN, OPEN, STICKING]
    ways = [first_modes(links, near, speeds=np.array([v, 1.0, 0.0]))[4] for v in (2.0, 1.0, 0.5)]
    assert ways == [SLIDING, STICKING, SLIDING_BACK]
    # a spot that has yielded to 2 mm begins where it has sunk, D (1 - 1/s) with F_e/F = s
    from strikewave.contact.elastoplastic import spot_after

    left = spot_after(of_every_kind()[3].contact, 1e-3, 2e-3).residual_indentation
    for d, mode in ((0.99 * left, OPEN), (1.01 * left, PUSHING)):
        found = first_modes(links, np.array([d, 1.0, 0.0]), deepest=np.array([0.0, 0.0, 0.0, 2e-3, 0.0]))
        assert found[3] == mode


def test_time_and_speed_scales_of_a_chain_worked_by_hand():
    """sqrt(m/k) with the reduced mass, d_max/v0 of a contact, 1/rate of a base; speeds from all that can give some."""
    spring = Chain({"a": 2.0, "b": 3.0}, [Spring("a", "b", 120.0)])
    assert shortest_time(spring, 1.0) == pytest.approx(0.1, rel=1e-14)
    held = Chain({"a": 2.0}, [Stop("a", "wall", 200.0), Friction("a", "wall", 1.0)], {"wall": 0.0})
    assert shortest_time(held, 1.0) == pytest.approx(0.1, rel=1e-14)
    blow = Chain({"a": 2.0}, [ChainContact("a", "wall", Contact(800.0, 1.0))], {"wall": 0.0})
    assert shortest_time(blow, 7.0) == pytest.approx(0.05, rel=1e-14)
    shaken = Chain({"a": 2.0}, [Spring("a", "table", 0.0)], {"table": Vibration(0.0, 1e-3, -50.0)})
    assert shortest_time(shaken, 1.0) == pytest.approx(0.02, rel=1e-14)
    assert shortest_time(Chain({"a": 2.0}, [Spring("a", "wall", 0.0)], {"wall": 0.0}), 1.0) == 1.0
    # at least eight steps a period of the fastest base
    assert _longest_step(shaken, 1.0) == pytest.approx(2 * math.pi / 50.0 / 8, rel=1e-14)
    assert _longest_step(shaken, 1e-4) == 1e-4
    assert _longest_step(spring, 0.7) == 0.7
    tide = Chain({"a": 2.0}, [Spring("a", "table", 1.0)], {"table": Vibration(0.0, 1.0, 5e-3)})
    assert _longest_step(tide, 1e3) == pytest.approx(2 * math.pi / 5e-3 / 8, rel=1e-14)

    def scale(chain, x, v):
        links = link_arrays(chain.links, chain.nodes)
        return _speed_scale(chain, links, np.array(x), np.array(v))

    # the larger of speeds and their differences
    assert scale(spring, [0.0, 0.0], [-3.0, 1.0]) == 4.0
    assert scale(spring, [0.0, 0.0], [3.0, 1.0]) == 3.0
    # stored 120 x 0.5^2/2 J in 5 kg
    assert scale(spring, [0.5, 0.0], [0.0, 0.0]) == pytest.approx(math.sqrt(6.0), rel=1e-14)
    assert scale(shaken, [0.0, 0.0], [0.0]) == pytest.approx(0.05, rel=1e-14)
    two = {"slow": Vibration(0.0, 2e-3, -20.0), "fast": Vibration(0.0, -1e-3, 50.0)}
    for bases in (two, dict(reversed(two.items()))):
        both = Chain({"a": 2.0}, [Spring("a", "slow", 0.0)], bases)
        assert scale(both, [0.0, 0.0, 0.0], [0.0]) == pytest.approx(0.05, rel=1e-14)
        assert _longest_step(both, 1.0) == pytest.approx(2 * math.pi / 50.0 / 8, rel=1e-14)
    assert scale(spring, [0.0, 0.0], [0.0, 0.0]) == 1e-6
    # gravity over the widest gap, 0.5 m; a preload over a millimetre
    fall = Chain({"a": 2.0}, [Spring("a", "wall", 0.0)], {"wall": 0.0}, gravity=-9.0)
    assert scale(fall, [-0.5, 0.0], [0.0]) == pytest.approx(3.0, rel=1e-14)
    pushed = Chain({"a": 2.0}, [Spring("a", "wall", 0.0, preload=-4.0)], {"wall": 0.0})
    assert scale(pushed, [0.0, 0.0], [0.0]) == pytest.approx(math.sqrt(2 * 4.0 * 1e-3 / 2.0), rel=1e-14)
    for preloads in ((-4.0, 3.0), (3.0, -4.0)):
        links = [Spring("a", "wall", 0.0, preload=preload) for preload in preloads]
        many = Chain({"a": 2.0}, [*links, Stop("a", "wall", 1.0)], {"wall": 0.0})
        assert scale(many, [0.0, 0.0], [0.0]) == pytest.approx(math.sqrt(4e-3), rel=1e-14)


def test_a_spring_with_preload_and_offset_rests_where_it_bears_the_weight():
    """Base behind: x = x_base + (m g + P + k s)/k - ...: P + k (x_base - x - s) + m g = 0, and forces say so."""
    links = [Spring("post", "m", 1e4, 40.0, preload=3.0, offset=0.02)]
    chain = Chain({"m": 0.5}, links, {"post": 0.3}, gravity=-9.0)
    rest = 0.3 - 0.02 + (3.0 - 0.5 * 9.0) / 1e4
    still = simulate(chain, {"m": rest}, {}, 0.5)
    # 1e-9 a step of the speed that 4.5 N give in a millimetre, over some hundred steps
    assert still.positions(0.4)[0] == pytest.approx(rest, abs=1e-7)
    assert still.forces(0.4)[0] == pytest.approx(4.5, abs=1e-3)
    # let go from elsewhere: F = P + k d + c d' all the time, and the loss is the energy that goes
    motion = simulate(chain, {"m": rest + 1e-3}, {}, 0.05)
    t = np.linspace(0.0, 0.05, 7)
    d = 0.3 - motion.positions(t)[:, 0] - 0.02
    assert motion.forces(t)[:, 0] == pytest.approx(3.0 + 1e4 * d - 40.0 * motion.speeds(t)[:, 0], rel=1e-12)
    left = 0.5 * 0.5 * motion.speeds(0.05)[0] ** 2 + 0.5 * 1e4 * (motion.positions(0.05)[0] - rest) ** 2
    assert motion.dissipated()[0] == pytest.approx(5e-3 - left, rel=1e-7)


def test_a_stop_pushes_from_its_offset_on_and_lets_go():
    """Half a sine from d = 0: contact of pi sqrt(m/k) from the time of touch, peak v sqrt(k m)."""
    chain = Chain({"m": 2.0}, [Stop("m", "wall", 800.0, offset=-0.3)], {"wall": 1.0})
    motion = simulate(chain, {"m": 0.5}, {"m": 2.0}, 0.4)
    ((begin, end, speed),) = motion.contacts(0)
    assert (begin, end, speed) == pytest.approx((0.1, 0.1 + math.pi / 20.0, 2.0), rel=1e-9)
    assert motion.forces(0.1 + math.pi / 40.0)[0] == pytest.approx(80.0, rel=1e-8)
    assert motion.forces([0.05, 0.39])[:, 0] == pytest.approx([0.0, 0.0])
    assert motion.motion.impulses(begin, end)[0] == pytest.approx(8.0, rel=1e-8)


def test_impulses_between_two_switches_are_changes_of_momentum():
    """Two blows of a ball between walls: m (v + v e) of each, and nothing while it flies."""
    contact = Contact(1e8, 1.5, exact(0.8))
    links = [ChainContact("ball", "right", contact), ChainContact("left", "ball", contact)]
    chain = Chain({"ball": 0.5}, links, {"left": -0.01, "right": 0.01})
    motion = simulate(chain, {}, {"ball": 2.0}, 0.03)
    (right,), (left,) = motion.contacts(0), motion.contacts(1)
    # approach speeds: 2, and 0.8 of it
    assert [right[2], left[2]] == pytest.approx([2.0, 1.6], rel=1e-7)
    assert motion.motion.impulses(right[0], right[1]) == pytest.approx([0.5 * 2.0 * 1.8, 0.0], rel=1e-7)
    assert motion.motion.impulses(left[0], left[1]) == pytest.approx([0.0, 0.5 * 1.6 * 1.8], rel=1e-7)
    assert motion.motion.impulses(right[1], left[0]) == pytest.approx([0.0, 0.0], abs=1e-15)


def test_a_contact_with_a_damper_in_a_chain_whose_base_stands_behind():
    """Kelvin-Voigt that pulls: exp(-pi zeta/sqrt(1 - zeta^2)) of the speed, pi/w of the time, towards a wall behind."""
    m, k, zeta = 0.3, 1e6, 0.2
    w0 = math.sqrt(k / m)
    contact = Contact(k, 1.0, damper=Damper(2 * zeta * m * w0, 0.0, "pulls"))
    chain = Chain({"m": m}, [ChainContact("wall", "m", contact)], {"wall": 0.0})
    motion = simulate(chain, {"m": 1e-3}, {"m": -2.0}, 0.01)
    ((begin, end, speed),) = motion.contacts(0)
    w = w0 * math.sqrt(1 - zeta**2)
    assert (begin, end - begin, speed) == pytest.approx((5e-4, math.pi / w, 2.0), rel=1e-8)
    assert motion.speeds(0.01)[0] == pytest.approx(2.0 * math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2)), rel=1e-8)


def steps_of(motion):
    """Times, steps and states at the begin of each step."""
    parts = [(r.time, r.step, r.dense[:, 0]) for r in motion.motion.records()]
    return [np.concatenate(column) for column in zip(*parts, strict=True)]


def test_steps_are_those_of_the_dop853_of_scipy():
    """The same estimate of the error and the same choice of steps, once the first ones have grown: equal to 1e-6."""
    k = 4.0
    chain = Chain({"m": 1.0}, [Spring("m", "wall", k, 0.4)], {"wall": 0.0})
    tolerance, speed = 1e-7, 2.0
    motion = simulate(chain, {"m": 0.5}, {"m": speed}, 12.0, tolerance)
    time, step, states = steps_of(motion)
    first = int(np.argmax(step > 0.05))
    # scales of `simulate`: speed and its way in sqrt(m/k), energies of bodies at that speed
    links = link_arrays(chain.links, chain.nodes)
    scale = _speed_scale(chain, links, np.array([0.5, 0.0]), np.array([speed]))
    atol = tolerance * np.array([scale * 0.5, scale, 0.5 * speed**2 + 0.5 * scale**2])
    solver = DOP853(
        lambda _, y: [y[1], -k * y[0] - 0.4 * y[1], 0.4 * y[1] ** 2],
        time[first], states[first], 12.0, first_step=step[first], rtol=2.3e-14, atol=atol,
    )  # fmt: skip
    for j in range(first, first + 8):
        solver.step()
        assert solver.t_old == pytest.approx(time[j], rel=1e-6)
        assert solver.step_size == pytest.approx(step[j], rel=1e-6)
        # rtol of scipy is 2.3e-7 of the tolerance, and cannot be zero
        assert states[j + 1] == pytest.approx(solver.y, abs=1e-6)


def test_a_long_motion_comes_out_equal_to_the_bit_where_its_steps_are_found_again(monkeypatch):
    """Some 1 400 steps of an undamped spring in stretches of 512; what is not kept is followed anew."""
    chain = Chain({"m": 1.0}, [Spring("m", "wall", 1e4)], {"wall": 0.0})
    times = np.linspace(0.0, 6.0, 23)
    asked = []
    kept = simulate(chain, {"m": 1e-3}, {"m": 0.1}, 6.0, 1e-11)
    steps = steps_of(kept)
    assert steps[0].size > 1024
    assert len(list(kept.motion.records())) == steps[0].size // 512 + 1
    assert steps[0][1:] == pytest.approx(np.cumsum(steps[1])[:-1], rel=1e-12)
    x, v = kept.positions(times)[:, 0], kept.speeds(times)[:, 0]
    assert x == pytest.approx(1e-3 * np.cos(100 * times) + 1e-3 * np.sin(100 * times), abs=1e-11)
    assert v == pytest.approx(0.1 * np.cos(100 * times) - 0.1 * np.sin(100 * times), abs=1e-9)
    monkeypatch.setattr(motions, "_KEPT_BYTES", 0)
    monkeypatch.setattr(motions, "_RECENT", 1)
    short = motions.integrate(
        kept.motion.system, motions.MotionState(0.0, steps[2][0].copy(), np.array([PUSHING]), np.array([0.0, 0.0, 1.0])),
        kept.motion._control, (1, 3), asked.append,
    )  # fmt: skip
    assert asked[-1] == 6.0
    assert len(asked) == len(list(kept.motion.records()))
    assert np.array_equal(short.sample(times)[0][:, 0], x)
    assert np.array_equal(short.sample(times[::-1])[0][::-1, 0], x)
    assert short.nbytes < 0.7 * kept.motion.nbytes
    # impulse over the whole is the change of momentum
    assert short.impulses(0.0, 6.0)[0] == pytest.approx(0.1 - v[-1], abs=1e-11)
    # rounding beyond both ends is taken, more is not
    assert np.array_equal(short.sample(6.0 * (1 + 5e-10))[0], short.sample(6.0)[0])
    for outside in (-6.0 * 2e-9, 6.0 * (1 + 2e-9)):
        with pytest.raises(ValueError, match="within the motion"):
            short.sample(outside)
    monkeypatch.setattr(motions, "_MOST_STEPS", 600)
    with pytest.raises(IntegrationError, match="more than 6e\\+02 steps"):
        simulate(chain, {"m": 1e-3}, {"m": 0.1}, 6.0, 1e-11)


def test_what_a_motion_keeps_is_counted_in_bytes():
    """One step: time, step, 8 x 3 of dense output, mode, 3 of memory, no switch; with impulses 8 more."""
    motion = simulate(Chain({"m": 1.0}, [Spring("m", "wall", 1.0)], {"wall": 0.0}), {}, {"m": 1.0}, 1e-3, 1e-2).motion
    steps = next(motion.records()).time.size
    kept = 8 * steps * (1 + 1 + 24 + 1 + 3)
    (stretch,) = motion._kept
    assert stretch.nbytes == kept
    # one state of three numbers, a mode and three memories at its begin; modes and memories as they change
    assert motion.nbytes == kept + 8 * (3 + 1 + 3) + 8 * (1 + 1 + 3)
    motion.impulses(0.0, 1e-3)
    assert stretch.nbytes == kept + 8 * steps


def test_a_contact_that_is_let_go_loses_what_it_stores_and_remembers_how_deep_it_was():
    contact = Contact(1e9, 1.5, cap=PressureCap(1e3, "point"))
    links = [
        Spring("a", "b", 5.0),
        ChainContact("a", "wall", contact, spot=1),
        ChainContact("b", "wall", contact, spot=1),
    ]
    chain = Chain({"a": 1.0, "b": 2.0}, links, {"wall": 0.5})
    system = simulate(chain, {}, {}, 1e-3).motion.system
    y, depth = np.array([0.502, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), float(first_depths(link_arrays(links, chain.nodes))[1])
    for mode_before, deepest in ((PUSHING, depth), (YIELDING, 0.002)):
        mode, memory = np.array([PUSHING, mode_before, OPEN]), np.array([0.0] * 3 + [0.0, depth, depth] + [1.0] * 3)
        lost = let_go(system.chain, 1, y, mode, memory)
        assert list(mode) == [PUSHING, OPEN, OPEN]
        assert memory[4] == memory[5] == pytest.approx(deepest, rel=1e-12)
        assert lost == pytest.approx(
            stored_energy(link_arrays(links[1:2], chain.nodes), np.array([0.502, 0.0, 0.5]), np.array([0.002])),
            rel=1e-12,
        )
    g = np.full(9, -1.0)
    never_touches(2, g)
    assert list(g) == [-1.0] * 6 + [1.0] + [-1.0] * 2
    assert [link_of(k) for k in (0, 2, 3, 8)] == [0, 0, 1, 2]


def test_impulse_from_a_shaken_base_is_the_change_of_momentum():
    """A mass on a spring whose base shakes at 1.7 of its frequency: the force at the instants of the quadrature."""
    table = Vibration(0.2, 1e-3, 170.0, 0.4)
    chain = Chain({"m": 0.5}, [Spring("table", "m", 5e3)], {"table": table})
    motion = simulate(chain, {"m": 0.2}, {}, 0.05)
    v = motion.speeds(0.05)[0]
    # x'' = w^2 (a sin(W t + p) - x), by hand
    w, shaken, a = 100.0, 170.0, 1e-3 / (1 - 1.7**2)
    c, s = -a * math.sin(0.4), -a * 1.7 * math.cos(0.4)
    expected = w * (s * math.cos(5.0) - c * math.sin(5.0)) + a * shaken * math.cos(shaken * 0.05 + 0.4)
    assert v == pytest.approx(expected, rel=1e-7)
    assert motion.motion.impulses(0.0, 0.05)[0] == pytest.approx(0.5 * v, rel=1e-7)


def test_the_first_of_two_switches_within_a_step_is_taken_first():
    """Two balls of one speed before walls 1 nm farther from one than from the other: each touches when it is there."""
    contact = Contact(1e9, 1.5)
    for nearer in (0, 1):
        gaps = [1e-3 + 1e-9, 1e-3 + 1e-9]
        gaps[nearer] = 1e-3
        links = [ChainContact("a", "left", contact), ChainContact("b", "right", contact)]
        chain = Chain({"a": 1.0, "b": 1.0}, links, {"left": gaps[0], "right": gaps[1]})
        motion = simulate(chain, {}, {"a": 1.0, "b": 1.0}, 1.1e-3)
        begins = [motion.contacts(k)[0, 0] for k in range(2)]
        assert begins == pytest.approx(gaps, abs=1e-14)
