"""One impact as plain functions: what the integrator is taught, peaks and turning points of given motions, whole blows."""

import functools
import itertools
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from strikewave.contact import Contact, Damper, HardeningContact, PressureCap, exact, solve_impact
from strikewave.contact import _pair_kernels as pairs
from strikewave.contact._chain_kernels import PUSHING, SLACK, YIELDING
from strikewave.contact._integrator import CONTINUE, STOP, empty_record
from strikewave.contact._law_kernels import depth_at_yield, flattening, residual, unyielding, yielding
from strikewave.contact._pair_kernels import (
    PairSystem,
    _force_within,
    _largest_force,
    _top_of_step,
    _turning,
    begin,
    cushion_depths_under,
    depths_at_yield,
    elastic_depths,
    energies,
    impacts,
    slopes_back,
    slow_forces,
    spots,
)
from strikewave.contact.elastoplastic import slow_force, spot_after, thornton_restitution, yield_speed
from strikewave.contact.law import rows, single

from .interpreted import integrate_plainly, interpret, taught

KERNELS = (
    _force_within, _largest_force, _top_of_step, _turning, begin, cushion_depths_under, depth_at_yield, depths_at_yield,
    elastic_depths, energies, flattening, impacts, residual, slopes_back, slow_forces, spots, unyielding, yielding,
)  # fmt: skip
"""What is tried here."""


@pytest.fixture
def kernels(monkeypatch):
    found = interpret(monkeypatch, KERNELS)
    integrate_plainly(monkeypatch, pairs, PairSystem)
    return found


CAPPED = Contact(3e5, 1.5, cap=PressureCap(200.0, "point"))
SPRING = single(Contact(9.0, 1.0))


def test_what_a_pair_is_taught_worked_by_hand(kernels):
    """F = 40 d^2 (1 + 0.5 d'/v0) on 5 kg: at d = 0.5, d' = 3 and v0 = 2 17.5 N; left at once, or with a memory."""
    of = taught(pairs, PairSystem)
    system = PairSystem(single(Contact(40.0, 2.0, 0.5)), 5.0, 0.001)
    y, mode, memory = np.array([0.5, 3.0]), np.array([PUSHING]), np.array([2.0, 0.0, 1.0])
    dy, out, g = np.empty(2), np.empty(1), np.empty(3)
    of.derivatives(system, 0.0, y, mode, memory, dy)
    of.forces(system, 0.0, y, mode, memory, out)
    of.switches(system, 0.0, y, mode, memory, g)
    assert dy == pytest.approx([3.0, -3.5], rel=1e-15)
    assert out == pytest.approx([17.5], rel=1e-15)
    assert g == pytest.approx([0.5, 1.75, 1.0], rel=1e-15)
    # on the way back at most 0.7 of the time until they part, but no less than an instant; with a damper any time
    assert (
        of.horizon(system, 0.0, y, mode, memory)
        == of.horizon(system, 0.0, np.array([0.5, 0.0]), mode, memory)
        == math.inf
    )
    back = np.array([0.5, -4.0])
    assert of.horizon(system, 0.0, back, mode, memory) == pytest.approx(0.7 * 0.125, rel=1e-15)
    assert of.horizon(system, 0.0, np.array([1e-9, -4.0]), mode, memory) == 0.001
    sunk = np.array([2.0, 0.6, 1.25])  # by 0.12
    assert of.horizon(system, 0.0, back, mode, sunk) == pytest.approx(0.7 * 0.38 / 4, rel=1e-14)
    of.switches(system, 0.0, back, mode, sunk, g)
    assert g == pytest.approx([0.38, 0.0, 1.0], abs=1e-15)
    # 40 (1.25 d - 0.25 x 0.6)^2/1.25 and the same hysteresis
    of.derivatives(system, 0.0, y, mode, sunk, dy)
    of.forces(system, 0.0, y, mode, sunk, out)
    left = 40.0 * 0.475**2 / 1.25 * 1.75
    assert [dy[1], out[0]] == pytest.approx([-left / 5.0, left], rel=1e-14)
    capped = PairSystem(single(CAPPED), 5.0, 0.001)
    of.switches(capped, 0.0, y, np.array([YIELDING]), memory, g)
    assert list(g) == [1.0, 1.0, 3.0]
    of.switches(capped, 0.0, y, mode, np.array([2.0, 0.6, 1.25]), g)
    assert g == pytest.approx([0.38, 1.0, 0.1])
    damped = PairSystem(single(Contact(40.0, 2.0, damper=Damper(1e-3, 1.0))), 5.0, 0.001)
    assert of.horizon(damped, 0.0, back, mode, memory) == math.inf


def test_switches_of_a_pair_stop_it_or_change_its_mode(kernels):
    of = taught(pairs, PairSystem)
    y = np.array([0.5, 3.0])

    def change(law, k, before):
        mode, memory = np.array([before]), np.array([2.0, 0.1, 1.0])
        said = of.switch(PairSystem(single(law), 5.0, 0.0), k, 0.0, y, mode, memory)
        return said, mode[0], *memory[1:]

    damped, free = Contact(3e5, 1.5, damper=Damper(1e-3, 1.0)), Contact(3e5, 1.5, 0.5)
    for law in (free, damped, CAPPED):
        assert change(law, 0, PUSHING)[0] == STOP
    assert change(damped, 1, PUSHING)[0] == STOP
    assert change(free, 1, PUSHING) == (CONTINUE, SLACK, 0.1, 1.0)
    assert change(free, 1, SLACK) == (CONTINUE, PUSHING, 0.1, 1.0)
    assert change(CAPPED, 2, PUSHING) == (CONTINUE, YIELDING, 0.1, 1.0)
    assert change(CAPPED, 2, YIELDING) == (CONTINUE, PUSHING, 0.5, kernels.flattening(single(CAPPED), 0.5))


def looked_at(monkeypatch, work):
    """How often the dense output is evaluated in some work."""
    count, plain = [], pairs.evaluate
    monkeypatch.setattr(pairs, "evaluate", lambda *arguments: (count.append(1), plain(*arguments)))
    work()
    monkeypatch.setattr(pairs, "evaluate", plain)
    return len(count)


def motion_of(edges, place, rate, acceleration):
    """A record whose place and rate are the cubics through both ends of each step, with their slopes."""
    record = empty_record(len(edges) - 1, 2, 1, 3)
    record.dense[:] = 0.0
    record.mode[:], record.memory[:] = PUSHING, [1.0, 0.0, 1.0]
    for row, (a, b) in enumerate(itertools.pairwise(edges)):
        record.time[row], record.step[row] = a, b - a
        for i, (value, slope) in enumerate(((place, rate), (rate, acceleration))):
            delta, h = value(b) - value(a), b - a
            record.dense[row, :4, i] = value(a), delta, h * slope(a) - delta, 2 * delta - h * (slope(b) + slope(a))
    return record


@pytest.mark.parametrize(
    "edges", [(0.0, 1.7), (0.0, 1.2, 1.9), (0.0, 0.2, 0.5, 1.6), (0.0, 0.9, 1.04, 1.5), (0.0, 0.995, 2.0)]
)
@pytest.mark.parametrize("bend", [1.7, -0.25])
def test_largest_force_and_indentation_of_a_cubic_are_found_where_its_rate_is_zero(kernels, monkeypatch, edges, bend):
    """d = 2 t - 1.3 t^2 - b t^3 and F = 9 d: t from the quadratic; whichever step holds it, or begins highest."""
    turn = (math.sqrt(6.76 + 24 * bend) - 2.6) / (6 * bend)
    edges = [turn * edge for edge in edges]

    def place(t):
        return 2 * t - 1.3 * t**2 - bend * t**3

    def rate(t):
        return 2 - 2.6 * t - 3 * bend * t**2

    record = motion_of(edges, place, rate, lambda t: -2.6 - 6 * bend * t)
    steps, y = len(edges) - 1, np.empty(2)
    deepest, when = kernels._turning(record, steps, y)
    assert when == pytest.approx(turn, rel=1e-12)
    assert deepest == pytest.approx(place(turn), rel=1e-14)
    # regula falsi in the manner of Illinois: a dozen evaluations beside two for each step
    assert looked_at(monkeypatch, lambda: kernels._turning(record, steps, y)) <= 11 + 2 * steps
    system = PairSystem(SPRING, 5.0, 0.0)
    most, at = kernels._largest_force(system, record, steps, y)
    assert most == pytest.approx(9.0 * place(turn), rel=1e-11)  # five parabolas through a cubic
    # flat at its top: the square of the error of the time
    assert at == pytest.approx(turn, rel=1e-5)
    x = 0.3
    deep = place(edges[0] + x * (edges[1] - edges[0]))
    assert kernels._force_within(system, record, 0, x, y) == pytest.approx(9.0 * deep, rel=1e-13)
    record.memory[0] = [1.0, 0.1, 1.25]
    assert kernels._force_within(system, record, 0, x, y) == pytest.approx(9.0 * (deep - 0.02), rel=1e-13)


def test_largest_force_at_an_end_of_a_step_is_that_of_the_end(kernels):
    system, y = PairSystem(SPRING, 5.0, 0.0), np.empty(2)
    for slope, at in ((2.0, 1.0), (-0.5, 0.0)):
        record = motion_of((0.0, 0.5), lambda t, s=slope: 1.0 + s * t, lambda t, s=slope: s, lambda t: 0.0)
        best, place = kernels._top_of_step(system, record, 0, y)
        assert (best, place) == (pytest.approx(9.0 * max(1.0, 1.0 + 0.5 * slope), rel=1e-15), at)


@pytest.mark.parametrize(("n", "e"), [(1.0, 0.6), (1.5, 1.0), (2.3, 0.35)])
def test_an_impact_by_steps_is_that_of_the_closed_form(kernels, n, e):
    """The kernel's own answers beside `solve_impact` without anything beyond the closed form, for two impacts."""
    contact, masses, speeds = Contact([2e6, 7e5], n, exact(e)), np.array([0.3, 2.0]), np.array([5.0, 0.7])
    out, record = np.empty((7, 2)), empty_record(100, 2, 1, 3)
    kernels.impacts(rows(contact, (2,)), masses, speeds, np.zeros(2), 1e-10, record, out)
    found = solve_impact(contact, masses, np.inf, speeds)
    assert found.method == "closed form"
    expected = [found.restitution, found.max_indentation, found.peak_force, found.duration]
    for row, values in zip(out[:4], expected, strict=True):
        assert row == pytest.approx(values, rel=3e-9)
    # times of flat tops
    assert out[4] == pytest.approx(found.peak_time, rel=3e-5)
    assert out[5] == pytest.approx(found.turning_time, rel=1e-8)
    assert list(out[6]) == [0.0, 0.0]


def test_a_spring_with_a_dashpot_rebounds_and_never_pulls(kernels):
    """zeta = 0.3, w = 100/s: the force k d + c d' is lost at e = exp(-zeta (pi - 2 asin zeta... )) by a root, see inside."""
    w, zeta, speed = 100.0, 0.3, 2.0
    contact = Contact(5.0 * w * w, 1.0, damper=Damper(2 * zeta * w * 5.0, 0.0))
    found = solve_impact(contact, 5.0, np.inf, speed, tolerance=1e-10)
    wd = w * math.sqrt(1 - zeta**2)

    def place(t):
        return speed / wd * math.exp(-zeta * w * t) * math.sin(wd * t)

    def rate(t):
        return speed * math.exp(-zeta * w * t) * (math.cos(wd * t) - zeta * w / wd * math.sin(wd * t))

    def force(t):
        return 5.0 * w * w * place(t) + 2 * zeta * w * 5.0 * rate(t)

    end = brentq(force, 0.5 * math.pi / wd, math.pi / wd)
    turn = math.atan2(wd, zeta * w) / wd
    assert float(found.duration) == pytest.approx(end, rel=1e-8)
    assert float(found.restitution) == pytest.approx(-rate(end) / speed, rel=1e-8)
    assert float(found.max_indentation) == pytest.approx(place(turn), rel=1e-8)
    assert float(found.turning_time) == pytest.approx(turn, rel=1e-7)
    times = np.linspace(0.0, end, 4001)
    forces = [force(t) for t in times]
    assert float(found.peak_force) == pytest.approx(max(forces), rel=1e-6)
    assert float(found.peak_time) == pytest.approx(times[int(np.argmax(forces))], abs=end / 3000)


def test_a_blow_that_yields_has_the_restitution_of_its_closed_form_and_leaves_a_spot(kernels):
    """Thornton's sphere at 5 times its yield speed; a second blow at the same speed reaches as deep and loses nothing."""
    mass = 0.4
    speed = 5.0 * float(yield_speed(CAPPED, mass))
    first = solve_impact(CAPPED, mass, np.inf, speed, tolerance=1e-10)
    assert float(first.restitution) == pytest.approx(float(thornton_restitution(5.0)), rel=1e-8)
    assert float(first.deepest) == pytest.approx(float(first.max_indentation), rel=1e-9)
    law = single(CAPPED)
    s = kernels.flattening(law, float(first.deepest))
    assert float(first.flattening) == s > 1.0
    assert float(first.residual_indentation) == kernels.residual(float(first.deepest), s)
    second = solve_impact(CAPPED, mass, np.inf, speed * float(first.restitution), first.deepest, tolerance=1e-10)
    assert float(second.restitution) == pytest.approx(1.0, rel=1e-8)
    assert float(second.max_indentation) == pytest.approx(float(first.deepest), rel=1e-8)
    assert float(second.deepest) == float(first.deepest)
    slow = solve_impact(CAPPED, mass, np.inf, 0.19 * speed, tolerance=1e-10)
    assert (float(slow.deepest), float(slow.flattening)) == (0.0, 1.0)
    # of a spot left by itself, and pressed slowly
    deepest = float(first.deepest)
    assert spot_after(CAPPED, 0.9 * deepest, deepest) == (
        pytest.approx(kernels.unyielding(law, 0.9 * deepest, deepest, s)[1]), float(first.residual_indentation), s,
    )  # fmt: skip
    start = kernels.depth_at_yield(law)
    back = functools.partial(kernels.unyielding, law)
    assert slow_force(CAPPED, [0.5 * start, 2.0 * start, 0.9 * deepest], [0.0, 0.0, deepest]) == pytest.approx(
        [3e5 * (0.5 * start) ** 1.5, kernels.yielding(law, 2.0 * start)[0], back(0.9 * deepest, deepest, s)[0]],
        rel=1e-13,
    )


def test_each_of_several_laws_has_depths_and_energies_of_its_own(kernels):
    """200 N over 3e5 and 50 N over 2e6 N/m^1.5; a cushion of 700 N/m up to 20 mm bears 2 k L/pi tan(pi d/(2 L))."""
    laws = np.array(
        [single(CAPPED), single(Contact(2e6, 1.5, cap=PressureCap(50.0, "point"))), single(Contact(3e5, 1.5))]
    )
    out, depths = np.empty(3), np.array([(200.0 / 3e5) ** (2 / 3), (50.0 / 2e6) ** (2 / 3), 0.0])
    kernels.depths_at_yield(laws, out)
    assert out == pytest.approx(depths, rel=1e-14)
    deep = np.array([0.01, 0.002, 0.003])
    kernels.energies(laws, deep, depths, out)
    alone = np.empty(3)
    for i in range(3):
        kernels.energies(laws[i : i + 1], deep[i : i + 1], depths[i : i + 1], alone[i : i + 1])
    assert list(out) == list(alone)
    assert out[2] == pytest.approx(3e5 / 2.5 * 0.003**2.5, rel=1e-14)
    kernels.elastic_depths(laws, np.array([1.0, 2.0, 3.0]), out)
    assert out == pytest.approx((2.5 * np.array([1.0, 2.0, 3.0]) / laws[:, 1]) ** 0.4, rel=1e-14)
    pads = [HardeningContact("tangent", 700.0, 0.02), HardeningContact("tangent", 300.0, 0.05)]
    forces = np.array([90.0, 2.0])
    kernels.cushion_depths_under(np.array([single(pad) for pad in pads]), forces, out[:2])
    expected = [
        2 * L / math.pi * math.atan(math.pi * F / (2 * k * L)) for k, L, F in ((700.0, 0.02, 90.0), (300.0, 0.05, 2.0))
    ]
    assert out[:2] == pytest.approx(expected, rel=1e-13)


def test_several_blows_on_spots_that_have_yielded_are_each_that_of_its_own(kernels):
    """Two laws, masses, speeds and depths, in one call and one by one, to the bit; slowly pressed too."""
    laws = np.array([single(CAPPED), single(Contact(2e6, 1.5, cap=PressureCap(50.0, "point")))])
    numbers = np.array([0.3, 2.0]), np.array([5.0, 0.2]), np.array([0.0, 0.004])
    out, alone, record = np.empty((7, 2)), np.empty((7, 1)), empty_record(200, 2, 1, 3)
    kernels.impacts(laws, *numbers, 1e-8, record, out)
    for i in range(2):
        kernels.impacts(laws[i : i + 1], *(one[i : i + 1] for one in numbers), 1e-8, record, alone)
        assert list(alone[:, 0]) == list(out[:, i])
    # the first yields, the second is elastic on what it has
    assert out[6] == pytest.approx([out[1, 0], 0.004], rel=1e-9)
    assert out[0, 0] < 0.99
    assert out[0, 1] == pytest.approx(1.0, rel=1e-6)
    d, deepest, forces, force = np.array([0.01, 0.0035]), np.array([0.02, 0.004]), np.empty(2), np.empty(1)
    kernels.slow_forces(laws, d, deepest, forces)
    for i in range(2):
        kernels.slow_forces(laws[i : i + 1], d[i : i + 1], deepest[i : i + 1], force)
        assert forces[i] == force[0] > 0.0


def test_several_spots_each_have_their_own_slope_and_set(kernels):
    laws = np.array([single(CAPPED), single(Contact(2e6, 1.5, cap=PressureCap(50.0, "point")))])
    deep, d, left, flat, slope = np.array([0.02, 0.004]), np.array([0.019, 0.0035]), *np.empty((3, 2))
    kernels.spots(laws, deep, left, flat)
    kernels.slopes_back(laws, d, deep, slope)
    for i in range(2):
        s = kernels.flattening(laws[i], deep[i])
        assert (left[i], flat[i]) == (kernels.residual(deep[i], s), s)
        assert slope[i] == kernels.unyielding(laws[i], d[i], deep[i], s)[1]


@pytest.mark.parametrize(("damped", "share"), [(False, 0.01), (True, 0.002)])
def test_a_blow_is_alike_in_units_of_any_size_and_begins_with_a_hundredth_of_its_way(kernels, damped, share):
    """3 kg on 2e-12 N/m, or 2e5; the first step is 0.01 d/v, a fifth of that with a damper."""
    answers = []
    for stiffness in (2e-12, 2e5):
        w, record, out = math.sqrt(stiffness / 3.0), empty_record(100, 2, 1, 3), np.empty((7, 1))
        law = single(Contact(stiffness, 1.0, damper=Damper(0.3 * w, 0.0) if damped else None))
        kernels.impacts(law[None], np.array([3.0]), np.array([0.7]), np.zeros(1), 1e-8, record, out)
        assert record.step[0] == pytest.approx(share / w, rel=1e-12)
        answers.append(out[:, 0] * [1.0, w, 1 / w, w, w, w, 1.0])
    # the time of a flat top: the root of rounding
    assert answers[0] == pytest.approx(answers[1], rel=1e-7)


def test_bodies_that_stay_together_have_no_answer(kernels):
    """A dashpot that pulls: critical damping never parts, and one just below parts with exp(-zeta pi/sqrt(1 - zeta^2))."""
    for zeta, parts in ((0.98, True), (1.0, False)):
        law, out = single(Contact(100.0, 1.0, damper=Damper(20.0 * zeta, 0.0, "pulls"))), np.empty((7, 1))
        kernels.impacts(law[None], np.ones(1), np.ones(1), np.zeros(1), 1e-10, empty_record(400, 2, 1, 3), out)
        assert np.isfinite(out).all() == parts
        if parts:
            assert out[0, 0] == pytest.approx(math.exp(-zeta * math.pi / math.sqrt(1 - zeta**2)), rel=1e-3)
