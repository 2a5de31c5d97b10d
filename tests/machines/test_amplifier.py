"""The stacked amplifier against closed forms, published numbers, and what any line of bodies must keep."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact import Contact
from strikewave.machines.amplifier import (
    BodyLine,
    SoftCollisions,
    chain_speed,
    collide,
    collide_softly,
    fastest_masses,
    gain_limit,
    gain_limit_of,
    next_speed,
    resting_ratio,
)
from strikewave.machines.launch import fall_speed

INF = math.inf


def line(masses, restitution, gaps, speeds, gravity=0.0):
    each = (restitution,) * len(gaps) if np.isscalar(restitution) else tuple(restitution)
    return BodyLine(tuple(masses), each, tuple(gaps), tuple(speeds), gravity)


def falling(masses, restitution, height=0.5, gap=1e-9, most=None):
    """Return bodies dropped together on a floor, followed until each has been struck from below once."""
    count = len(masses)
    start = line((INF, *masses), restitution, (height, *([gap] * (count - 1))), [0.0] * (count + 1), STANDARD_GRAVITY)
    return collide(start, most=most or count)


@st.composite
def lines(draw, floor=False, gravity=False):
    count = draw(st.integers(2, 5))
    number = lambda low, high, n: draw(st.lists(st.floats(low, high), min_size=n, max_size=n))  # noqa: E731
    masses, speeds = number(0.1, 10.0, count), [round(v, 9) for v in number(-5.0, 5.0, count)]
    if floor:
        masses[0], speeds[0] = INF, 0.0
    pull = draw(st.floats(1.0, 20.0)) if gravity else 0.0
    return line(masses, number(0.3, 1.0, count - 1), number(0.01, 1.0, count - 1), speeds, pull)


# --- what any line keeps ---


@pytest.mark.parametrize(("floor", "gravity"), [(False, False), (False, True), (True, False), (True, True)])
@given(data=st.data())
def test_balances_hold(floor, gravity, data):
    run = collide(data.draw(lines(floor, gravity)), most=300)
    # 300 collisions, each with some roundings, over the energy of the start: gravity alone brings many times that into
    # play, and bodies at rest on one another bounce until the last digit (2.2e-10 in the worst line seen)
    assert run.energy_error < 1e-9
    assert run.momentum_error < 1e-8  # what is left of the smallest bounces


@given(data=st.data())
def test_each_collision_keeps_momentum_and_loses_its_share(data):
    start = data.draw(lines())
    for c in collide(start).collisions:
        lower, upper = start.masses[c.pair : c.pair + 2]
        e, approach = start.restitutions[c.pair], c.before[0] - c.before[1]
        assert approach > 0.0
        moved = lower * (c.after[0] - c.before[0]) + upper * (c.after[1] - c.before[1])
        assert moved == pytest.approx(0.0, abs=1e-13 * c.impulse + 1e-14)
        if approach > 1e-6:
            assert c.after[1] - c.after[0] == pytest.approx(e * approach, rel=1e-12, abs=1e-14)
        kinetic = [0.5 * lower * v[0] ** 2 + 0.5 * upper * v[1] ** 2 for v in (c.before, c.after)]
        share = 0.5 * (1.0 - e**2) * lower * upper / (lower + upper) * approach**2
        assert kinetic[0] - kinetic[1] == pytest.approx(share, abs=1e-13 * max(kinetic) + 1e-14)


@given(data=st.data())
def test_bodies_never_pass_one_another_and_end_parting(data):
    start = data.draw(lines())
    run = collide(start)
    last = run.collisions[-1].time if run.collisions else 1.0
    times = np.linspace(0.0, 2.0 * last, 400)
    assert np.diff(run.positions(times), axis=1).min() > -1e-9  # 5 m/s over the times passed, rounded
    assert np.diff(run.final_speeds).min() >= -1e-8


@given(data=st.data(), drift=st.floats(-20.0, 20.0))
def test_a_moving_observer_sees_the_same_collisions(data, drift):
    start = data.draw(lines())
    run = collide(start)
    assume(run.words == ())
    moved = collide(line(start.masses, start.restitutions, start.gaps, [v + drift for v in start.speeds]))
    assert [c.pair for c in moved.collisions] == [c.pair for c in run.collisions]
    assert np.allclose(moved.final_speeds, run.final_speeds + drift, rtol=0, atol=1e-9)


@given(data=st.data())
def test_a_falling_observer_sees_the_same_collisions(data):
    """Gravity without a floor changes nothing between bodies."""
    start = data.draw(lines(gravity=True))
    free = collide(line(start.masses, start.restitutions, start.gaps, start.speeds))
    assume(free.words == ())
    run = collide(start)
    assert [c.pair for c in run.collisions] == [c.pair for c in free.collisions]
    for one, other in zip(run.collisions, free.collisions, strict=True):
        assert one.time == pytest.approx(other.time, rel=1e-7)
        assert one.before[0] - one.before[1] == pytest.approx(other.before[0] - other.before[1], abs=1e-7)


@given(data=st.data())
def test_numbering_from_the_other_end_changes_nothing(data):
    start = data.draw(lines())
    run = collide(start)
    assume(run.words == ())
    back = collide(
        line(start.masses[::-1], start.restitutions[::-1], start.gaps[::-1], [-v for v in start.speeds[::-1]])
    )
    last = len(start.gaps) - 1
    assert [last - c.pair for c in back.collisions] == [c.pair for c in run.collisions]
    assert np.allclose(-back.final_speeds[::-1], run.final_speeds, rtol=0, atol=1e-9)


@given(data=st.data(), scale=st.floats(1e-3, 1e3))
def test_only_mass_ratios_count(data, scale):
    start = data.draw(lines())
    run = collide(start)
    assume(run.words == ())
    heavier = collide(line([scale * m for m in start.masses], start.restitutions, start.gaps, start.speeds))
    assert np.allclose(heavier.final_speeds, run.final_speeds, rtol=0, atol=1e-9)


# --- order and number of collisions: published counts ---


@pytest.mark.parametrize(("power", "count"), [(0, 3), (1, 31), (2, 314), (3, 3141)])
def test_galperin_counts_the_digits_of_pi(power, count):
    """A wall, a body at rest and one 100^n times as heavy that comes: Galperin 2003."""
    run = collide(line((INF, 1.0, 100.0**power), 1.0, (1.0, 1.0), (0.0, 0.0, -1.0)))
    assert len(run.collisions) == count
    assert run.energy_error < 1e-12


@pytest.mark.parametrize(("heavy", "gain"), [(3 + 2 * 2**0.5, 1 + 2**0.5), (7 + 4 * 3**0.5, 2 + 3**0.5)])
def test_closed_tube_hands_over_all_energy(heavy, gain):
    """Masses and gains for 2 and 3 hits between a wall and a heavy body (fano.co.uk, Cannon)."""
    run = collide(line((heavy, 1.0, INF), 1.0, (1.0, 1.0), (1.0, 0.0, 0.0)))
    assert run.gain == pytest.approx(gain, rel=1e-14)
    stopped = [c.after[0] for c in run.collisions if c.pair == 0]
    assert min(abs(speed) for speed in stopped) < 1e-14


@given(masses=st.tuples(*[st.floats(0.05, 20.0)] * 3), gaps=st.tuples(*[st.floats(0.01, 1.0)] * 2))
def test_three_elastic_bodies_collide_as_often_as_their_wedge_unfolds(masses, gaps):
    """Bodies that come from afar: a straight line crosses the wedge floor(pi/a) or ceil(pi/a) times (Galperin 2003)."""
    a, b, c = masses
    wedge = math.acos(math.sqrt(a * c / ((a + b) * (b + c))))
    run = collide(line(masses, 1.0, gaps, (2.0, 0.3, -1.5)))
    assume(not any(collision.at_once for collision in run.collisions))
    assert len(run.collisions) in (math.floor(math.pi / wedge), math.ceil(math.pi / wedge))


@pytest.mark.parametrize("gaps", [(1.0, 0.9), (0.9, 1.0)])
def test_inelastic_collapse_begins_at_7_less_4_root_3(gaps):
    """Three equal bodies collide without end in a finite time below e = 0.0718 (McNamara & Young 1992).

    Just above it they still part, after so many collisions that what is left of their speeds is below any threshold.
    """
    limit = 7.0 - 4.0 * math.sqrt(3.0)
    below = collide(line((1.0,) * 3, limit - 5e-3, gaps, (1.0, 0.0, -1.0)))
    above = collide(line((1.0,) * 3, limit + 2e-2, gaps, (1.0, 0.0, -1.0)))
    assert any("ever smaller bounces" in word for word in below.words)
    assert np.ptp(below.final_speeds) == 0.0
    slow = [c for c in below.collisions if c.before[0] - c.before[1] < 1e-9 * 2.0]
    assert len(slow) <= 2  # the third body joins the two that rest on each other
    assert not any("ever smaller bounces" in word for word in above.words)
    assert np.all(np.diff(above.final_speeds) > 0.0)


def test_bouncing_ball_rests_after_its_series():
    """sqrt(2 h/g) (1 + e)/(1 - e); what is left out is 1e-9 of the first bounce."""
    run = collide(line((INF, 1.0), 0.8, (1.0,), (0.0, 0.0), STANDARD_GRAVITY))
    assert run.collisions[-1].time == pytest.approx(math.sqrt(2.0 / STANDARD_GRAVITY) * 9.0, rel=1e-8)
    assert run.words == (
        "ever smaller bounces bring to rest on a neighbour: body 2; those below 1e-09 of the speed scale are left out",
    )
    assert np.all(run.positions(100.0) == 0.0)
    assert run.energy_lost == pytest.approx(STANDARD_GRAVITY, rel=1e-14)


def test_a_stack_comes_to_rest_on_its_floor():
    run = collide(line((INF, 1.0, 2.0, 1.0), 0.5, (1.0, 0.1, 0.2), [0.0] * 4, STANDARD_GRAVITY))
    assert "body 2, 3, 4" in run.words[0]
    assert np.all(run.positions(10.0) == 0.0)
    assert np.all(run.speeds([5.0, 10.0]) == 0.0)
    assert run.energy_lost == pytest.approx(STANDARD_GRAVITY * (1.0 + 2.2 + 1.3), rel=1e-13)
    assert run.momentum_error < 1e-12


def test_secondary_collisions_are_found():
    """The first body strikes again a second one that the third has stopped; speeds by hand."""
    run = collide(line((4.0, 1.0, 3.0), 1.0, (0.1, 0.1), (1.0, 0.0, 0.0)))
    assert [c.pair for c in run.collisions] == [0, 1, 0, 1]
    speeds = [[0.6, 1.6], [-0.8, 0.8], [0.04, 1.44], [0.48, 1.12]]
    assert np.allclose([c.after for c in run.collisions], speeds, rtol=0, atol=1e-14)
    times = [0.1, 0.1 + 0.1 / 1.6]
    assert [c.time for c in run.collisions[:2]] == pytest.approx(times, rel=1e-14)
    assert run.gain == pytest.approx(1.12, rel=1e-14)


def test_the_top_pair_may_come_first():
    run = collide(line((1.0, 1.0, 1.0), 1.0, (1.0, 0.1), (1.0, 0.5, -0.5)))
    assert [c.pair for c in run.collisions] == [1, 0, 1]
    assert np.allclose(run.final_speeds, [-0.5, 0.5, 1.0], rtol=0, atol=1e-15)


def test_newtons_cradle_passes_on_what_comes():
    one = collide(line((1.0,) * 5, 1.0, (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 0.0)))
    assert one.final_speeds.tolist() == [0.0, 0.0, 0.0, 0.0, 1.0]
    two = collide(line((1.0,) * 5, 1.0, (0.0, 1.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0, 0.0)))
    assert two.final_speeds.tolist() == [0.0, 0.0, 0.0, 1.0, 1.0]
    assert "collisions while a third body touches: 4" in one.words[0]


@pytest.mark.parametrize(("gap", "speed"), [(0.1, 1.0), (0.3, 3.0)])
def test_collisions_at_once_are_taken_from_the_bottom(gap, speed):
    """The second of the two times, 0.3/3, is below 0.1 by a rounding; speeds by hand."""
    run = collide(line((1.0,) * 3, 0.5, (0.1, gap), (1.0, 0.0, -speed)))
    first, second = run.collisions[:2]
    assert (first.pair, second.pair) == (0, 1)
    assert first.at_once
    assert second.at_once
    assert first.after == pytest.approx((0.25, 0.75), rel=1e-14)
    pushed = 0.75 * (0.75 + speed)
    assert second.after == pytest.approx((0.75 - pushed, pushed - speed), rel=1e-13)


def test_endless_elastic_bounces_stop_at_the_most():
    run = collide(line((INF, 1.0), 1.0, (1.0,), (0.0, 0.0), STANDARD_GRAVITY), most=7)
    assert len(run.collisions) == 7
    assert run.words[0].startswith("stopped after 7 collisions")
    assert run.end == run.collisions[-1].time
    assert run.end == pytest.approx(13.0 * math.sqrt(2.0 / STANDARD_GRAVITY), rel=1e-14)
    with pytest.raises(ValueError, match="from 0 to the end"):
        run.positions(run.end * 1.01)


def test_nothing_happens_after_the_duration():
    start = line((1.0, 1.0, 1.0), 1.0, (1.0, 1.0), (1.0, 0.0, 0.0))
    assert len(collide(start, duration=1.5).collisions) == 1
    assert len(collide(start, duration=2.0).collisions) == 2


# --- gains ---


@given(masses=st.lists(st.floats(0.1, 10.0), min_size=2, max_size=5), e=st.floats(0.3, 1.0), speed=st.floats(0.1, 20.0))
def test_line_at_rest_against_its_closed_form(masses, e, speed):
    masses = sorted(masses, reverse=True)
    count = len(masses)
    run = collide(line(masses, e, [0.01] * (count - 1), [speed] + [0.0] * (count - 1)))
    firsts = [next(c for c in run.collisions if c.pair == k) for k in range(count - 1)]
    assert [c.time for c in firsts] == sorted(c.time for c in firsts)
    once = chain_speed(masses, e, speed)
    assert firsts[-1].after[1] == pytest.approx(once, rel=1e-12)
    assert run.gain >= once / speed * (1.0 - 1e-12)


def test_later_collisions_can_beat_the_closed_form():
    """Each struck once the last gets 1.058 823 5; the first strikes again what the second has left behind."""
    run = collide(line((2.0, 0.125, 0.125), 0.5, (0.01, 0.01), (1.0, 0.0, 0.0)))
    assert chain_speed((2.0, 0.125, 0.125), 0.5, 1.0) == pytest.approx(18 / 17, rel=1e-14)
    second = (24 / 17) * 0.25  # of the second body after its first blow
    first = 1.0 - (24 / 17) * 0.0625
    again = second + 1.5 * (first - second) * 16 / 17
    assert run.collisions[2].after[1] == pytest.approx(again, rel=1e-13)
    assert run.gain == pytest.approx(18 / 17 + 0.75 * (again - 18 / 17), rel=1e-13)


@given(ratios=st.lists(st.floats(0.01, 0.3), min_size=1, max_size=4), e=st.floats(0.5, 1.0))
def test_falling_line_against_its_closed_form(ratios, e):
    masses = np.cumprod([1.0, *ratios])
    run = falling(masses, e)
    u = float(fall_speed(0.5))
    wanted = chain_speed(list(masses), e, e * u, falling=u)
    assert run.gain == pytest.approx(wanted / u, rel=1e-7)  # gaps of 1 nm under gravity
    top = run.positions(run.end)[-1]
    assert top < 1e-7  # all within a wink


def test_two_and_three_falling_bodies_reach_9_and_49_times_the_height():
    """Walker 1988; the miss goes with the mass ratio."""
    for count, height in ((2, 9.0), (3, 49.0)):
        assert gain_limit(1.0, count, falling=True) ** 2 == height
        misses = []
        for ratio in (1e-3, 1e-4):
            run = falling([ratio**k for k in range(count)], 1.0)
            misses.append(1.0 - run.gain**2 / height)
        assert misses[0] / misses[1] == pytest.approx(10.0, rel=0.02)


@given(e=st.floats(0.0, 1.0), count=st.integers(1, 5))
def test_gain_limit_is_that_of_vanishing_mass_ratios(e, count):
    masses = [1e-12**k for k in range(count + 1)]
    assert chain_speed(masses, e, 1.0) == pytest.approx(gain_limit(e, count), rel=1e-11)
    struck = chain_speed(masses[:count], e, e, falling=1.0)
    assert struck == pytest.approx(gain_limit(e, count, falling=True), rel=1e-11, abs=1e-11)


@given(
    ends=st.tuples(st.floats(1.0, 100.0), st.floats(0.01, 0.9)),
    e=st.tuples(*[st.floats(0.3, 1.0)] * 3),
    u=st.sampled_from([0.0, 1.0]),
)
def test_geometric_masses_are_the_fastest(ends, e, u):
    """Against a search, also with unequal restitutions and falling bodies."""

    def slowness(logs):
        return -chain_speed([ends[0], *np.exp(logs), ends[1]], e, 1.0, u)

    best = fastest_masses(*ends, 4)
    found = minimize(
        slowness, np.log([2 * ends[1], ends[1]]), method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 0}
    )
    assert np.allclose(np.exp(found.x), best[1:3], rtol=1e-5)
    assert slowness(np.log(best[1:3])) <= found.fun + 1e-13


@given(e=st.floats(0.5, 1.0), u=st.floats(0.0, 1.0))
def test_resting_ratio_stops_what_strikes(e, u):
    mu = resting_ratio(1.0, e, u)
    run = collide(line((1.0, mu), e, (0.1,), (1.0, -u)))
    assert run.final_speeds[0] == pytest.approx(0.0, abs=1e-15)
    assert run.final_speeds[1] == pytest.approx(float(next_speed(1.0, mu, e, u)), rel=1e-13)


def test_elastic_falling_line_that_hands_over_everything():
    """Masses 1, 1/3, 1/6, 1/10: each ratio stops its striker, and the top leaves with 4 u (Rodgers et al. 2009)."""
    masses, speed = [1.0], 1.0
    for _ in range(3):
        ratio = resting_ratio(speed, 1.0, falling=1.0)
        speed = float(next_speed(speed, ratio, 1.0, falling=1.0))
        masses.append(masses[-1] * ratio)
    assert masses == pytest.approx([1.0, 1 / 3, 1 / 6, 1 / 10], rel=1e-14)
    run = falling(masses, 1.0)
    assert run.gain == pytest.approx(4.0, rel=1e-7)
    assert np.abs(run.speeds(run.end)[:-1]).max() < 1e-6


# --- contacts that take time ---


@pytest.mark.parametrize(("exponent", "rate"), [(1.0, 1 / 2), (1.5, 2 / 5)])
def test_stiff_contacts_come_to_the_pairs_as_their_duration(exponent, rate):
    """Under gravity the miss goes with the duration of the contacts, K^(-1/(n + 1))."""
    start = line((INF, 1.0, 0.25), 1.0, (0.5, 0.05), [0.0] * 3, STANDARD_GRAVITY)
    pairs = collide(start, duration=0.36).speeds(0.36)
    misses = []
    for stiffness in (1e8, 1e10, 1e12):
        soft = collide_softly(start, [Contact(stiffness, exponent)] * 2, 0.36)
        assert soft.overlap == 0.0
        misses.append(abs(soft.speeds[-1] - pairs[-1]))
    assert np.allclose(np.log10(np.array(misses[:-1]) / misses[1:]) / 2.0, rate, atol=1e-3)


def test_contacts_that_do_not_overlap_are_pairs():
    masses, gaps = (1.0, 0.5, 0.25), (0.0, 1e-3)
    start = line(masses, 1.0, gaps, (5.0, 0.0, 0.0))
    soft = collide_softly(start, [Contact(1e8, 1.0)] * 2, 0.01)
    assert soft.overlap == 0.0
    assert np.allclose(soft.speeds, collide(start).final_speeds, rtol=0, atol=1e-8)  # tolerance 1e-10 per step


def test_contacts_that_overlap_are_not_pairs():
    """The closer the bodies, the longer the overlap and the slower the last body."""
    last = []
    for gap in (1e-3, 3e-4, 1e-4, 0.0):
        soft = collide_softly(line((1.0, 0.5, 0.25), 1.0, (0.0, gap), (5.0, 0, 0)), [Contact(1e8, 1.0)] * 2, 0.01)
        last.append((soft.overlap, soft.speeds[-1]))
        assert np.array([1.0, 0.5, 0.25]) @ soft.speeds == pytest.approx(5.0, rel=1e-12)
    assert all(one[0] < other[0] and one[1] > other[1] for one, other in itertools.pairwise(last))


def test_stiffness_does_not_help_bodies_that_touch():
    """Three equal bodies with linear contacts: no K brings the cradle of the pairs; the two-phase solution by hand."""

    def first_contact(t):
        return 0.5 * (math.sin(t) + math.sin(3**0.5 * t) / 3**0.5)

    opens = brentq(first_contact, 2.0, 3.2, xtol=1e-15)
    both, apart = math.cos(opens), math.cos(3**0.5 * opens)
    closing = 0.5 * (both + apart), 0.5 * (both - apart)
    second = math.sin(opens) - first_contact(opens)  # from here this contact opens alone and keeps its energy
    first = (1.0 + 2.0 * closing[0] + closing[1]) / 3.0
    middle, last = first - closing[0], first - closing[0] - closing[1]
    parting = math.sqrt(closing[1] ** 2 + 2.0 * second**2)
    common = 0.5 * (middle + last)
    wanted = [first, common - 0.5 * parting, common + 0.5 * parting]
    for stiffness in (1e6, 1e9, 1e12):
        start = line((1.0,) * 3, 1.0, (0.0, 0.0), (1.0, 0.0, 0.0))
        soft = collide_softly(start, [Contact(stiffness, 1.0)] * 2, 0.1)
        assert np.allclose(soft.speeds, wanted, rtol=0, atol=1e-8)
        assert soft.overlap == pytest.approx(opens / math.sqrt(stiffness), rel=1e-7)
    assert wanted[0] < -0.1
    assert collide(start).final_speeds.tolist() == [0.0, 0.0, 1.0]


# --- refusals ---


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: BodyLine((1.0, 1.0), (1.0,), (0.1, 0.1), (0.0, 0.0)), "2 masses take 1 gaps, got 2"),
        (lambda: BodyLine((1.0,), (), (), (0.0,)), "two at least"),
        (lambda: line((1.0, INF, 1.0), 1.0, (1, 1), (0, 0, 0)), "a mass between the ends"),
        (lambda: line((INF, INF), 1.0, (1,), (0, 0)), "finite mass"),
        (lambda: line((1.0, math.nan), 1.0, (1,), (0, 0)), "a mass must be positive"),
        (lambda: line((1.0, 1.0), 1.1, (1,), (0, 0)), "within 0 to 1"),
        (lambda: line((1.0, 1.0), 1.0, (-1,), (0, 0)), "a gap"),
        (lambda: line((1.0, 1.0), 1.0, (1,), (0, INF)), "a speed must be finite"),
        (lambda: collide(line((1.0, 1.0), 1.0, (1,), (0, 0)), duration=0.0), "duration must be positive"),
        (lambda: collide_softly(line((1.0, 1.0), 1.0, (1,), (0, 0)), [], 1.0), "take 1 contacts, got 0"),
        (lambda: collide_softly(line((INF, 1.0), 1.0, (1,), (1, 0)), [Contact(1e6, 1.0)], 1.0), "must stand still"),
    ],
)
def test_refusals_name_the_number(call, words):
    with pytest.raises(ValueError, match=words):
        call()


# --- worked by hand ---

TEN = 10.0
"""Gravity of what is worked by hand, m/s^2."""


def bouncing():
    """A ball of 2 kg from 1.25 m at 10 m/s^2: half a second to 5 m/s; then 3 m/s and 0.6 s, 1.8 m/s and 0.36 s."""
    return collide(line((INF, 2.0), 0.6, (1.25,), (0.0, 0.0), TEN), duration=1.3)


def test_ball_is_where_its_parabolas_are():
    run = bouncing()
    assert [c.time for c in run.collisions] == pytest.approx([0.5, 1.1], rel=1e-14)
    times = [0.0, 0.25, 0.5, 0.7, 1.1, 1.3]
    places = [1.25, 1.25 - 0.3125, 0.0, 0.6 - 0.2, 0.0, 0.36 - 0.2]
    assert np.allclose(run.positions(times), [[0.0, x] for x in places], rtol=0, atol=1e-14)
    speeds = [0.0, -2.5, 3.0, 1.0, 1.8, -0.2]
    assert np.allclose(run.speeds(times), [[0.0, v] for v in speeds], rtol=0, atol=1e-13)
    assert run.positions(0.7).tolist() == pytest.approx([0.0, 0.4])
    assert run.final_speeds == pytest.approx([0.0, 1.8])
    assert run.end == 1.3
    with pytest.raises(ValueError, match="from 0 to the end"):
        run.positions(-1e-9)
    first, second = run.collisions
    assert (first.before, first.after) == ((0.0, pytest.approx(-5.0)), (0.0, pytest.approx(3.0)))
    assert (first.impulse, first.energy_lost, first.pair) == (pytest.approx(16.0), pytest.approx(16.0), 0)
    assert second.impulse == pytest.approx(2.0 * 4.8)
    assert run.energy_lost == pytest.approx(16.0 * 1.36)
    assert run.gain == pytest.approx(0.6)
    assert run.energy_error < 1e-14
    assert run.momentum_error < 1e-14
    assert run.words == ()


def test_two_free_bodies_keep_their_common_fall():
    """3 kg at 4 m/s, 0.5 m below 1 kg at -1 m/s: they meet after 0.1 s, and leave with 0.2 of 5 m/s."""
    run = collide(line((3.0, 1.0), 0.2, (0.5,), (4.0, -1.0), TEN))
    (met,) = run.collisions
    assert met.time == pytest.approx(0.1, rel=1e-14)
    assert met.before == pytest.approx((3.0, -2.0))
    assert met.after == pytest.approx((1.5, 2.5))
    assert met.impulse == pytest.approx(4.5)
    assert met.energy_lost == pytest.approx(0.5 * 0.75 * 25.0 * 0.96)
    assert run.positions(0.1) == pytest.approx([0.35, 0.35])
    assert run.positions([0.3])[0] == pytest.approx([0.35 + 0.3 - 0.2, 0.35 + 0.5 - 0.2])
    assert run.end == math.inf
    assert run.support == 0.0


def tampered(run, **last):
    return dataclasses.replace(run, _flights=(*run._flights[:-1], run._flights[-1]._replace(**last)))


def test_errors_are_what_the_balances_miss():
    """A speed of 1.8 m/s made 2 m/s, or a place 0.1 m higher, of 25 J and of 16 N s."""
    run = bouncing()
    faster = tampered(run, speeds=np.array([0.0, 2.0]))
    assert faster.energy_error == pytest.approx((4.0 - 3.24) / 25.0, rel=1e-12)
    assert faster.momentum_error == pytest.approx(0.4 / 16.0, rel=1e-12)
    assert tampered(run, places=np.array([0.0, 0.1])).energy_error == pytest.approx(2.0 / 25.0, rel=1e-12)
    assert dataclasses.replace(run, support=8.0).momentum_error == pytest.approx(0.5, rel=1e-12)
    still = collide(line((1.0, 1.0), 1.0, (1.0,), (0.0, 0.0)))
    assert (still.energy_error, still.momentum_error) == (0.0, 0.0)
    assert math.isnan(still.gain)
    # where there was no energy and no collision, by 1 J and 1 N s
    begun = dataclasses.replace(
        still, _flights=(still._flights[0], still._flights[0]._replace(speeds=np.array([0.0, 3.0])))
    )
    assert (begun.energy_error, begun.momentum_error) == pytest.approx((4.5, 3.0), rel=1e-15)


@pytest.mark.parametrize("gravity", [0.0, TEN])
@pytest.mark.parametrize("ends", [(INF, INF), (INF, 4.0), (4.0, INF)])
def test_floor_and_ceiling_take_part_in_the_momentum(ends, gravity):
    start = line((ends[0], 2.0, 3.0, ends[1]), 0.7, (0.3, 0.2, 0.05), (0.0, 4.0, -1.0, 0.0), gravity)
    run = collide(start, duration=0.5)
    assert {c.pair for c in run.collisions} >= {0, 1, 2}
    assert run.momentum_error < 1e-13
    assert run.energy_error < 1e-13
    up = sum(c.impulse for c in run.collisions if c.pair == 0 and ends[0] == INF)
    down = sum(c.impulse for c in run.collisions if c.pair == 2 and ends[1] == INF)
    finite = np.where(np.isfinite(start.masses), start.masses, 0.0)
    change = finite @ (run.final_speeds - start.speeds) + finite.sum() * gravity * run.collisions[-1].time
    assert change == pytest.approx(up - down, rel=1e-12)
    leaves = max(c.after[1] for c in run.collisions if c.pair == (1 if ends[1] == INF else 2))
    first = run.collisions[0].before
    assert run.gain == pytest.approx(leaves / (first[0] - first[1]), rel=1e-14)


def test_body_thrown_up_comes_back_to_what_rests_on_its_floor():
    """The wait of a gap that opens first: 2 v/g; and what rests bears its weight on the floor."""
    run = collide(line((INF, 3.0, 2.0), 0.5, (0.0, 0.0), (0.0, 0.0, 4.0), TEN), most=1)
    (met,) = run.collisions
    assert met.time == pytest.approx(0.8, rel=1e-14)
    assert (met.pair, met.at_once) == (1, True)
    assert met.before == pytest.approx((0.0, -4.0))
    assert run.support == pytest.approx(3.0 * 10.0 * 0.8, rel=1e-14)
    assert run.positions(0.4)[1:] == pytest.approx([0.0, 0.8])
    # one that flies with what is below it never meets it; one that rises faster than it can fall back neither
    assert collide(line((1.0, 1.0), 1.0, (0.1,), (2.0, 2.0), TEN)).collisions == ()
    assert collide(line((1.0, 1.0), 1.0, (0.1,), (2.0, 2.001))).collisions == ()
    # the ceiling that is just not reached, and just reached: v^2/(2 g) = 0.8 m
    for gap, count in ((0.801, 0), (0.799, 1)):
        up = collide(line((1.0, INF), 1.0, (gap,), (4.0, 0.0), TEN), duration=1.0)
        assert len(up.collisions) == count


def test_bodies_that_meet_together_are_told():
    """A gap of nothing that opens is none; one that stays is a touch; two that close at once are two."""
    apart = collide(line((1.0, 1.0, 1.0), 1.0, (0.1, 0.0), (1.0, 0.0, 0.5)), most=1)
    assert not apart.collisions[0].at_once
    together = collide(line((1.0, 1.0, 1.0), 1.0, (0.1, 0.0), (1.0, 0.0, 0.0)), most=1)
    assert together.collisions[0].at_once
    assert together.words[-1].startswith("collisions while a third body touches: 1;")
    both = collide(line((1.0,) * 4, 1.0, (0.1, 5.0, 0.1), (1.0, 0.0, 0.0, -1.0)), most=2)
    assert [c.pair for c in both.collisions] == [0, 2]
    assert not any(c.at_once for c in both.collisions)  # far from one another
    below = collide(line((1.0, 1.0, 1.0), 1.0, (0.0, 0.1), (0.0, 0.0, -1.0)), most=1)
    assert (below.collisions[0].pair, below.collisions[0].at_once) == (1, True)
    flight = collide(line((INF, 1.0, 1.0), 1.0, (1.25, 0.0), (0.0, 0.0, 0.0), TEN), most=1)
    assert (flight.collisions[0].pair, flight.collisions[0].at_once) == (0, True)


def test_slow_bodies_stay_together_with_their_momentum():
    """Below 1e-9 of the speed scale, here 10 m/s: two that meet so get the speed of both, with what touches them."""
    slow = 4e-9
    run = collide(line((1.0, 3.0, 2.0), 0.5, (1.0, 5.0), (slow, 0.0, 0.0)))
    assert run.words == ()  # the scale is the difference of the speeds
    for gap, joins in ((0.0, True), (0.1, False)):
        run = collide(line((1.0, 3.0, 2.0, 1.0), 0.5, (1e-9, gap, 1.0), (slow, 0.0, 0.0, 10.0)), duration=2.0)
        common = slow / 6.0 if joins else slow / 4.0
        assert run.final_speeds[:2] == pytest.approx([common] * 2, rel=1e-12)
        assert run.final_speeds[2] == pytest.approx(common if joins else 0.0, rel=1e-12)
        assert run.words[0].startswith("ever smaller bounces bring to rest on a neighbour: body 2; those below 1e-09")
    above = collide(line((1.0, 3.0, 2.0, 1.0), 0.5, (1e-9, 0.1, 1.0), (1.5e-8, 0.0, 0.0, 10.0)), duration=2.0)
    assert above.final_speeds[:2] == pytest.approx([1.5e-8 * (1.0 - 1.5 * 0.75), 1.5e-8 * 1.5 * 0.25], rel=1e-9)
    # one that comes to a wall is stopped by it
    wall = collide(line((2.0, INF), 0.5, (1e-9,), (slow, 0.0)), duration=2.0)
    assert wall.final_speeds.tolist() == pytest.approx([-0.5 * slow, 0.0])
    ceiling = collide(line((1.0, 2.0, INF), 0.5, (1.0, 1e-9), (-10.0, slow, 0.0)), duration=2.0)
    assert ceiling.final_speeds.tolist() == [-10.0, 0.0, 0.0]
    assert "body 2" in ceiling.words[0]
    assert ceiling.support == pytest.approx(-2.0 * slow + ceiling.collisions[0].impulse, abs=1e-20)
    floor = collide(line((INF, 3.0, 1.0), 0.5, (1e-9, 1.0), (0.0, -slow, 10.0)), duration=2.0)
    assert floor.final_speeds.tolist() == [0.0, 0.0, 10.0]
    assert floor.momentum_error < 1e-12


@pytest.mark.parametrize("drift", [0.0, 5.0])
@pytest.mark.parametrize("mirrored", [False, True])
def test_all_that_touch_slow_bodies_and_are_as_slow_go_with_them(mirrored, drift):
    """A body of 1 kg at 8e-9 m/s comes to 3, 2 and 2 kg in touch: an eighth of it for all; what leaves them does not."""
    slow = 8e-9

    def ended(masses, gaps, speeds, **options):
        speeds = [v + drift for v in speeds]
        if mirrored:
            masses, gaps, speeds = masses[::-1], gaps[::-1], [-v for v in speeds[::-1]]
        found = collide(line(masses, 0.5, gaps, speeds), duration=0.9, **options).final_speeds
        return (-found[::-1] if mirrored else found) - drift

    found = ended((1.0, 1.0, 3.0, 2.0, 2.0), (1.0, 1e-9, 0.0, 0.0), (-10.0, slow, 0.0, 0.0, 0.0))
    # of 5 m/s the last digit is 1e-15
    assert found == pytest.approx([-10.0, *[slow / 8.0] * 4], abs=3e-15)
    found = ended((3.0, 1.0, 2.0, 5.0), (1.0, 0.0, 0.0), (-10.0, slow, 0.0, 6.0), most=1)
    assert found == pytest.approx([-10.0, slow / 3.0, slow / 3.0, 6.0], abs=3e-15)


@pytest.mark.parametrize(("later", "at_once"), [(0.5e-12, True), (1.5e-12, False)])
def test_collisions_are_at_once_to_a_millionth_of_a_millionth_of_their_time(later, at_once):
    run = collide(line((1.0, 1.0, 1.0), 0.5, (0.1, 0.3 * (1.0 + later)), (1.0, 0.0, -3.0)), most=1)
    assert run.collisions[0].at_once == at_once


@pytest.mark.parametrize("masses", [(0.1, 0.3), (0.7, 1.1), (1.3, 0.9)])
def test_bodies_that_stick_have_one_speed_to_the_last_digit(masses):
    for speeds in ((0.1, -0.3), (1.7, 0.9), (3.3, -1.1)):
        (met,) = collide(line(masses, 0.0, (0.1,), speeds)).collisions
        assert met.after[0] == met.after[1]
        assert met.after[0] == pytest.approx(np.dot(masses, speeds) / sum(masses), rel=1e-14)
    (met,) = collide(line((2.0, INF), 0.0, (0.1,), (3.3, 0.0))).collisions
    assert met.after == (0.0, 0.0)


def test_body_that_leaves_its_ceiling_is_no_third_one():
    run = collide(line((1.0, 2.0, INF), 1.0, (0.8, 0.0), (4.0, 0.0, 0.0), TEN), most=1)
    (met,) = run.collisions
    assert (met.time, met.pair, met.at_once) == (pytest.approx(0.2), 0, False)


def test_collisions_may_be_followed_one_by_one():
    start = line((INF, 1.0), 1.0, (1.25,), (0.0, 0.0), TEN)
    one = collide(start, most=1)
    assert len(one.collisions) == 1
    assert one.words == ("stopped after 1 collisions, at 0.5 s: more follow",)
    assert (one.end, collide(start, duration=0.4).end) == (pytest.approx(0.5), 0.4)
    for wrong in ({"most": 0}, {"duration": 0.0}, {"duration": -1.0}, {"duration": math.nan}):
        with pytest.raises(ValueError, match="duration must be positive"):
            collide(start, **wrong)
    assert collide(start, duration=1e-9).collisions == ()


def test_speeds_by_hand():
    assert next_speed(3.0, 0.5, 0.25, 2.0) == pytest.approx(1.25 * 5.0 / 1.5 - 2.0)
    assert chain_speed([4.0, 2.0, 0.5], [0.5, 0.25], 3.0) == pytest.approx(1.25 / 1.25 * 1.5 / 1.5 * 3.0)
    falls = next_speed(float(next_speed(3.0, 0.5, 0.5, 2.0)), 0.25, 0.25, 2.0)
    assert chain_speed([4.0, 2.0, 0.5], [0.5, 0.25], 3.0, 2.0) == pytest.approx(float(falls))
    assert (gain_limit(0.5, 3), gain_limit(0.5, 3, falling=True)) == (3.375, 2.375)
    assert gain_limit_of([0.5, 0.25, 0.2]) == pytest.approx(1.25)
    assert fastest_masses(8.0, 0.125, 3).tolist() == pytest.approx([8.0, 1.0, 0.125])
    assert resting_ratio(3.0, 0.5, 2.0) == pytest.approx(3.0 / 4.5)
    for wrong in ((0.0, 1.0), (1.0, -1.0)):
        with pytest.raises(ValueError, match="masses of the ends"):
            fastest_masses(*wrong, 3)


def test_lines_are_refused_at_their_limits():
    for gap, speed, restitution, gravity in ((0.0, 0.0, 0.0, 0.0), (0.0, -3.0, 1.0, 9.8)):
        BodyLine((1.0, INF), (restitution,), (gap,), (speed, 0.0), gravity)
    for wrong in (
        {"masses": (0.0, 1.0)},
        {"restitutions": (-1e-9,)},
        {"restitutions": (1.0 + 1e-9,)},
        {"gaps": (-1e-9,)},
        {"gravity": -1e-9},
        {"speeds": (math.nan, 0.0)},
        {"speeds": (0.0,)},
        {"restitutions": (1.0, 1.0)},
        {"masses": (1.0, 1.0, 1.0)},
    ):
        values = {"masses": (1.0, 1.0), "restitutions": (1.0,), "gaps": (0.1,), "speeds": (0.0, 0.0), "gravity": 9.8}
        with pytest.raises(ValueError, match=r"mass|restitution|gap|gravity|speed"):
            BodyLine(**values | wrong)


def test_overlap_is_the_longest_common_time_of_neighbouring_contacts():
    contacts = (
        np.array([[1.0, 2.0, 0.0], [5.0, 5.5, 0.0]]),
        np.array([[1.7, 3.0, 0.0], [4.0, 5.2, 0.0]]),
        np.array([[2.6, 2.9, 0.0]]),
    )
    assert SoftCollisions(None, np.zeros(4), contacts).overlap == pytest.approx(0.3)
    assert SoftCollisions(None, np.zeros(4), (contacts[0], contacts[2])).overlap == 0.0
    assert SoftCollisions(None, np.zeros(3), contacts[1:]).overlap == pytest.approx(0.3)
    assert SoftCollisions(None, np.zeros(2), (contacts[0], np.empty((0, 3)))).overlap == 0.0


def test_soft_bodies_between_a_floor_and_a_ceiling_end_as_pairs():
    """3 kg between two walls 0.3 and 0.5 m off, at 4 m/s: it meets the one above after 0.125 s, the one below 0.2 s on."""
    start = line((INF, 3.0, INF), 1.0, (0.3, 0.5), (0.0, 4.0, 0.0))
    soft = collide_softly(start, [Contact(1e8, 1.0), Contact(2e8, 1.0)], 0.36)
    assert soft.speeds == pytest.approx([0.0, 4.0, 0.0], abs=1e-7)
    assert soft.contacts[1][0, 0] == pytest.approx(0.125, rel=1e-9)
    lasted = math.pi * math.sqrt(3.0 / 2e8)
    assert soft.contacts[1][0, 1] == pytest.approx(0.125 + lasted, rel=1e-7)
    assert soft.contacts[0][0, 0] == pytest.approx(0.325 + lasted, rel=1e-7)
    with pytest.raises(ValueError, match="must stand still"):
        collide_softly(line((INF, 3.0), 1.0, (0.3,), (1e-9, 0.0)), [Contact(1e8, 1.0)], 0.36)


def test_scale_of_speeds_is_that_of_their_differences_and_of_the_fall_through_all_gaps():
    """2 g of 5 m are 10 m/s: a ball 9e-9 m/s above its floor rests there, at 11e-9 m/s it bounces once."""
    for speed, rests in ((9e-9, True), (11e-9, False)):
        run = collide(line((INF, 1.0, 1.0), 0.5, (1e-20, 5.0), (0.0, -speed, 0.0), TEN), duration=1e-11)
        assert (run.final_speeds[1] == 0.0) == rests
