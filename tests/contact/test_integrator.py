"""The integrator as plain functions: polynomials it follows exactly, scipy's steps, and switches at known times."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import DOP853

from strikewave.contact import _integrator
from strikewave.contact._integrator import (
    CONTINUE,
    END,
    FULL,
    RESTART,
    STOP,
    STOPPED,
    STUCK,
    Control,
    TakenStep,
    _dip,
    _fill_dense,
    _first_switch,
    _root,
    _take_step,
    advance,
    empty_record,
    evaluate,
    impulses,
    sample,
)

from .interpreted import TAUGHT, interpret

KERNELS = advance, evaluate, impulses, sample, _take_step, _fill_dense, _root, _dip, _first_switch
"""What is tried here."""


@pytest.fixture
def follow(monkeypatch):
    """Return what follows rates of a state from a time on, with switches, as plain functions."""
    kernels = interpret(monkeypatch, KERNELS)
    taught = {name: lambda system, *rest, name=name: getattr(system, name)(*rest) for name in TAUGHT}
    for name, function in taught.items():
        monkeypatch.setattr(_integrator, name, function)

    def start(
        rates, y, end, t=0.0, h=0.1, switches=None, switch=None, horizon=math.inf, tolerance=1e-8, rows=400, **limits
    ):
        y, count = np.array(y, dtype=float), len(switches(t, np.array(y, dtype=float), [0])) if switches else 0

        told = []

        def fill(t, y, mode, memory, dy):
            dy[:] = rates(t, y, mode) if limits.get("moded") else rates(t, y)

        def tell(t, y, mode, memory, g):
            told.append(t)
            g[:] = switches(t, y, mode) if switches else []

        system = SimpleNamespace(
            derivatives=fill,
            forces=lambda t, y, mode, memory, out: np.copyto(out, [t**3 + mode[0], y[0], memory[0]][: out.size]),
            switches=tell,
            horizon=lambda t, y, mode, memory: horizon,
            switch=switch,
        )
        mode, memory, record = np.zeros(2, np.int64), np.array([7.0, 3.0]), empty_record(rows, y.size, 2, 2)
        control = Control(
            tolerance,
            limits.get("scale", np.ones(y.size)),
            limits.get("first", 1e-3),
            limits.get("most", math.inf),
            end,
        )
        with np.errstate(invalid="ignore"):
            why, at, step, steps, events = kernels.advance(system, control, t, h, y, mode, memory, record, count)
        return SimpleNamespace(
            why=why, t=at, h=step, told=len(told), y=y, mode=mode, memory=memory, system=system, kernels=kernels, control=control,
            time=record.time[:steps], step=record.step[:steps], dense=record.dense[:steps], modes=record.mode[:steps],
            memories=record.memory[:steps], events=list(zip(record.event_time[:events], *record.event[:events].T, strict=True)),
            record=type(record)(*(column[:steps] for column in record[:5]), record.event_time[:events], record.event[:events]),
        )  # fmt: skip

    return start


def powers(count):
    """Rates (k + 1) t^k + k of so many states: t^(k + 1) + k t."""
    return lambda t, y: [(k + 1) * t**k + k for k in range(count)]


@pytest.mark.parametrize("count", [3, 7])
def test_polynomials_up_to_the_seventh_degree_are_followed_exactly_and_between_steps(follow, count):
    """One step over 1.25 from 0.5 on; few states and many are summed in loops of their own."""
    done = follow(powers(count), [0.5 ** (k + 1) + 0.5 * k for k in range(count)], 1.75, t=0.5, h=1.25, tolerance=1e9)
    assert (done.why, done.t, done.time.size) == (END, 1.75, 1)
    assert done.y == pytest.approx([1.75 ** (k + 1) + 1.75 * k for k in range(count)], rel=1e-13)
    out = np.empty(count)
    for x in (0.0, 0.13, 0.5, 0.81, 1.0):
        t = 0.5 + 1.25 * x
        done.kernels.evaluate(done.dense[0], x, out)
        assert out == pytest.approx([t ** (k + 1) + t * k for k in range(count)], rel=1e-13)


def rotor(t, y):
    """Two coupled states, and one that is driven in time."""
    return [-2.0 * y[1] + 0.1 * y[2], y[0] * (1.0 + 0.3 * y[1]), math.cos(3.0 * t) * y[0]]


def test_errors_and_steps_are_those_of_scipy(follow):
    """Of the states whose scale is above zero; scipy's rtol is 2e-14 at least, which moves the error by 1e-6."""
    scale = np.array([1.0, 0.0, 3.0])
    rejected = 0
    done = follow(rotor, [1.0, 0.5, -0.2], 3.0, t=0.3, h=0.02, scale=scale, tolerance=1e-6)
    # scipy counts the states without a scale too: the mean over three in place of two
    for j in range(done.time.size):
        t, h, state = done.time[j], done.step[j], done.dense[j, 0].copy()
        one = DOP853(rotor, t, state, 3.0, first_step=h, rtol=2.3e-14, atol=1e-6 * np.where(scale > 0, scale, 1e30))
        one.max_step = h
        y_new, k, work = np.empty(3), np.zeros((16, 3)), np.empty(3)
        k[0] = rotor(t, state)
        error = done.kernels._take_step(done.system, done.control, t, h, state, None, None, work, k, y_new)
        one.step()
        weights = np.array([1e-6, 1e30, 3e-6])
        expected = one._estimate_error_norm(one.K, h, weights) * math.sqrt(3 / 2)
        assert error == pytest.approx(expected, rel=1e-9)
        assert y_new == pytest.approx(one.y, rel=1e-14)
        k[0] = rotor(one.t, one.y)
        # the next step: 0.9 error^(-1/8), six times at most; one that is not good shrinks by the same rule
        following = h * min(6.0, 0.9 * error**-0.125)
        trial = done.kernels._take_step(done.system, done.control, one.t, following, one.y, None, None, work, k, y_new)
        following *= 1.0 if trial <= 1.0 else 0.9 * trial**-0.125
        rejected += trial > 1.0
        if j + 1 < done.time.size - 1:
            assert done.step[j + 1] == pytest.approx(following, rel=1e-9)
    assert rejected > 0
    assert done.t == 3.0
    assert done.step.sum() == pytest.approx(2.7, rel=1e-14)


def test_steps_grow_sixfold_at_most_and_shrink_to_a_fifth_at_least(follow):
    still = follow(lambda t, y: [0.0], [1.0], 100.0, h=0.5)
    assert list(still.step[:3]) == [0.5, 3.0, 18.0]
    # nearly still: the error is above zero and yet allows more
    slow = follow(lambda t, y: [1e-9 * math.sin(9.0 * t)], [1.0], 2.0, h=1e-3)
    assert slow.step[1] == pytest.approx(6e-3, rel=1e-12)
    # a first step far too long is tried in fifths: 100, 20, 4 ..., until one is good
    stiff = follow(lambda t, y: [-1e4 * y[0]], [1.0], 1e9, h=100.0, tolerance=1e-6, rows=1)
    assert stiff.why == FULL
    fifths = math.log(100.0 / stiff.step[0], 5)
    assert stiff.step[0] < 2e-3
    assert 0 < fifths < 12
    for limited in ({"most": 0.25}, {"horizon": 0.25}):
        assert list(follow(lambda t, y: [0.0], [1.0], 1.0, h=0.5, **limited).step) == [0.25] * 4


def test_what_is_not_finite_is_tried_in_fifths_until_no_step_is_left(follow):
    """From 1 s on the rate is no number: steps reach there up to the last bits, then it is stuck."""
    tried = []

    def rates(t, y):
        tried.append(t)
        return [math.inf if t > 1.0 else 0.5]

    done = follow(rates, [2.0], 9.0, h=0.75)
    assert done.why == STUCK
    assert done.t == pytest.approx(1.0, abs=1e-14)
    assert done.y[0] == pytest.approx(2.5, abs=1e-14)
    assert done.step[:2] == pytest.approx([0.75, 4.5 / 5**2], rel=1e-12)


def test_switches_are_found_where_they_fall_and_change_what_they_say(follow):
    """t - 0.37 changes sign and the rate turns; the next at 0.9 begins anew with a small step, the last one stops."""
    log = []

    def switch(k, t, y, mode, memory):
        log.append((k, t, y.copy(), mode.copy()))
        mode[0] += 1
        memory[0] = 10.0 * t
        return {1: CONTINUE, 2: RESTART, 3: STOP}[mode[0]]

    def switches(t, y, mode):
        falls = [0.37 - t, 0.9 - t**3 * 0.9 / 0.9**3, 1.6 - t]
        return [falls[k] if mode[0] == k else 1.0 for k in range(3)]

    done = follow(
        lambda t, y, mode: [[2.0, 5.0, -1.0, 0.0][mode[0]], 1.0], [0.0, 5.0], 4.0, h=0.7, switches=switches, switch=switch,
        first=0.01, moded=True,
    )  # fmt: skip
    assert done.why == STOPPED
    assert [k for k, *_ in log] == [0, 1, 2]
    assert [at for _, at, *_ in log] == pytest.approx([0.37, 0.9, 1.6], abs=1e-14)
    assert done.t == done.events[-1][0]
    assert [y for at, _, y, _ in log for y in y] == pytest.approx([0.74, 5.37, 3.39, 5.9, 2.69, 6.6], rel=1e-13)
    # switches by their time, place and the steps before them; modes and memories of each step
    assert [at for at, *_ in done.events] == pytest.approx([0.37, 0.9, 1.6], abs=1e-14)
    assert [k for _, k, _ in done.events] == [0, 1, 2]
    for n, (at, _, before) in enumerate(done.events):
        assert done.time[before - 1] + done.step[before - 1] == pytest.approx(at, rel=1e-14)
        later = np.arange(done.time.size) >= before
        assert np.all(done.modes[later, 0] > n)
        assert np.all(done.modes[~later, 0] <= n)
        assert done.memories[before - 1, 0] == pytest.approx(7.0 if not n else 10.0 * done.events[n - 1][0])
    assert np.all(done.memories[:, 1] == 3.0)
    assert np.all(done.modes[:, 1] == 0)
    # after the second a step of 0.01, then six times that
    begins = done.events[1][2]
    assert done.step[begins : begins + 2] == pytest.approx([0.01, 0.06], rel=1e-12)
    # a switch that goes on leaves the step as it was
    assert done.step[done.events[0][2]] == pytest.approx(0.9 - 0.37, rel=1e-12)


def test_the_first_of_several_switches_is_taken_whatever_their_order(follow):
    for one, two in ((0.31, 0.35), (0.35, 0.31), (0.2, 0.95)):
        done = follow(
            lambda t, y: [1.0], [0.0], 2.0, h=1.0,
            switches=lambda t, y, mode, one=one, two=two: [two - t, one - t], switch=lambda *_: STOP,
        )  # fmt: skip
        assert done.t == pytest.approx(min(one, two), abs=1e-15)
        assert done.events[0][1] == (0 if two < one else 1)


@pytest.mark.parametrize("at", [0.05, 0.2, 0.3, 0.45, 0.62, 0.8])
@pytest.mark.parametrize("width", [0.1, 0.01])
def test_a_dip_between_two_samples_is_seen_from_either_side(follow, at, width):
    """(t - a)^2 - w^2 is below zero for 2 w around a, and falls through zero at a - w; samples lie 0.25 apart."""
    if at <= width:
        return
    done = follow(
        lambda t, y: [1.0], [0.0], 1.0, h=1.0,
        switches=lambda t, y, mode: [1.0, (y[0] - at) ** 2 - width**2], switch=lambda *_: STOP,
    )  # fmt: skip
    assert done.why == STOPPED
    assert done.t == pytest.approx(at - width, abs=1e-13)
    assert done.events[0][1] == 1


@pytest.mark.parametrize(("lowest", "looked"), [(0.98, True), (1.02, False)])
@pytest.mark.parametrize("place", [-1.6, -1.2, -0.7, -0.4])
def test_a_dip_is_looked_for_where_the_parabola_falls_to_a_quarter_of_its_samples(follow, lowest, looked, place):
    """Samples at -2, -1 and 0 of 5 (s - s0)^2 + q, q so many quarters of the least of them; there is a dip where one looks."""
    done = follow(lambda t, y: [1.0], [0.0], 1.0, h=1.0)
    away = np.array([-2.0, -1.0, 0.0]) - place
    least = 5.0 * np.min(away**2)
    q = lowest * 0.25 / (1.0 - lowest * 0.25) * least
    rows = [np.array([9.0, 5.0 * one**2 + q]) for one in away]
    at = 2.0 + 0.5 * (3 + place) / 4
    done.system.switches = lambda t, y, mode, memory, g: np.copyto(g, [9.0, abs(t - at) - 1e-8])
    step, scratch = TakenStep(2.0, 0.5, done.dense[0], None, None), (np.empty(1), np.empty(2))
    found = done.kernels._dip(done.system, step, 3, *rows, *scratch)
    assert found == ((1, pytest.approx((at - 1e-8 - 2.0) / 0.5, abs=1e-14)) if looked else (-1, 1.0))
    # a hill has none, nor what is below zero at a sample
    for other in ([np.array([9.0, 20.0 - one[1]]) for one in rows], [-rows[0], *rows[1:]]):
        assert done.kernels._dip(done.system, step, 3, *other, *scratch) == (-1, 1.0)


def test_no_switch_is_seen_where_a_dip_stays_above_zero(follow):
    for lowest, told in ((1e-3, 7), (0.2, 5)):
        done = follow(
            lambda t, y: [1.0], [0.0], 1.0, h=1.0, switches=lambda t, y, mode, low=lowest: [(t - 0.6) ** 2 + low]
        )
        assert (done.why, done.events) == (END, [])
        # at the begin of the step and four times in it; the deeper one is looked at from two sets of samples
        assert done.told == told


def test_two_switches_that_switch_each_other_are_given_up_after_a_hundred(follow):
    """What falls below zero at 0.5 and stays: no time passes any more. At a sample of the step it is found there too."""
    count = []

    def switch(k, t, y, mode, memory):
        count.append(t)
        return CONTINUE

    done = follow(lambda t, y: [1.0], [0.0], 2.0, h=1.0, switches=lambda t, y, mode: [0.5 - t], switch=switch)
    assert done.why == STUCK
    assert done.t == pytest.approx(0.5)
    assert len(count) in (101, 102)  # the one that was found in a step, and a hundred without


def test_a_full_record_hands_on_where_it_stands(follow):
    done = follow(lambda t, y: [1.0], [0.0], 2.0, h=0.01, rows=3, most=0.05)
    assert (done.why, done.time.size) == (FULL, 3)
    assert [done.t, done.y[0]] == pytest.approx([0.11, 0.11])
    assert done.h == pytest.approx(0.3)
    # switches fill it too: three at one instant
    done = follow(
        lambda t, y: [1.0], [0.0], 2.0, h=0.5, rows=3, switches=lambda t, y, mode: [0.2 - t] * 3, switch=lambda *_: CONTINUE
    )  # fmt: skip
    assert (done.why, len(done.events)) == (FULL, 3)


def test_samples_and_impulses_of_a_record_are_those_of_its_polynomials(follow):
    """y = t^2 from 0.5 on, forces t^3 + mode, y and memory: steps of 1/16, 1/4 (five) and 3/16, and times beyond both ends."""
    done = follow(lambda t, y: [2.0 * t], [0.25], 2.0, t=0.5, h=0.0625, most=0.25)
    edges = np.array([0.5, 0.5625, 0.8125, 1.0625, 1.3125, 1.5625, 1.8125, 2.0])
    assert [*done.time, 2.0] == pytest.approx(edges, rel=1e-15)
    done.modes[3:, 0], done.memories[3:, 0] = 2, 3.0
    record = done.record._replace(mode=done.modes, memory=done.memories)
    times = np.array([0.4, 0.5, 0.55, 0.5625, 1.0624, 1.0625, 1.9, 2.0, 2.5])
    states, forces = np.empty((9, 1)), np.empty((9, 3))
    done.kernels.sample(done.system, record, times, states, forces)
    t = np.clip(times, 0.5, 2.0)
    assert states[:, 0] == pytest.approx(t**2, rel=1e-14)
    later = times >= 1.0625
    assert forces == pytest.approx(np.column_stack([t**3 + 2 * later, t**2, np.where(later, 3.0, 7.0)]), rel=1e-13)
    out = np.empty((7, 3))
    done.kernels.impulses(done.system, record, out)
    second = np.arange(7) >= 3
    assert out[:, 0] == pytest.approx(np.diff(edges**4) / 4 + 2 * np.diff(edges) * second, rel=1e-13)
    assert out[:, 1] == pytest.approx(np.diff(edges**3) / 3, rel=1e-13)
    assert out[:, 2] == pytest.approx(np.diff(edges) * np.where(second, 3.0, 7.0), rel=1e-13)
