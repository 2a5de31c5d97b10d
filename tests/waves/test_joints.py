"""Joints that swing, press nonlinearly, open and close, against ordinary differential equations of endless bars.

Waves in endless bars turn into resistances: a bar of impedance Z that sends the wave P pushes with 2 P - Z v.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.contact import Contact
from strikewave.contact.law import Damper, PressureCap
from strikewave.waves import (
    BONDED,
    End,
    Impactor,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    _kernels,
    run_bar,
)
from strikewave.waves.transit import empty_averages, grid_of, state_at_rest, tables_of

STEP = 1e-7
Z1, Z2 = 8e3, 5e3


def timed(name, impedance, steps=200):
    return Layer(name, 1.0, impedance * impedance, 1.0, steps * STEP * impedance)


def between_endless_bars(joint):
    """A joint between two bars whose other ends send nothing back."""
    return Stack((timed("before", Z1), timed("after", Z2)), (joint,), End("matched"))


def incident(load, duration, step):
    """Run a joint under an incident wave; force before and behind it and speeds, from the wave's arrival."""

    def run(joint):
        taps = [Tap(0, 1.0), Tap(1, 0.0)]
        done = run_bar(between_endless_bars(joint), load, taps, duration + 200 * STEP, WantedError(step=step))
        first = round(200 * STEP / step)
        return done, done.force[first:], done.velocity[first:]

    return run


PULSE = LoadPulse("sine-squared", 2e4, 60e-6, kind="incident")


def solved(rates, start, duration, step):
    count = round(duration / step) + 1
    times = step * np.arange(count)
    found = solve_ivp(rates, (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-16, max_step=1e-6)
    return times, found.y


def test_a_mass_on_a_spring_between_endless_bars():
    """(Z1 + Z2) v = 2 P - g, g = k y + c (v - u), m u' = g; second order in the step."""
    m, k, c = 0.02, 4e8, 300.0

    def rates(t, x):
        y, u = x
        v = (2 * PULSE.at(t) - k * y + c * u) / (Z1 + Z2 + c)
        return [v - u, (k * y + c * (v - u)) / m]

    misses = []
    for step in (STEP, STEP / 2):
        _, force, velocity = incident(PULSE, 2e-4, step)(Joint(k, c, attached=m))
        times, (y, u) = solved(rates, [0.0, 0.0], 2e-4, step)
        v = (2 * PULSE.at(times) - k * y + c * u) / (Z1 + Z2 + c)
        behind = Z2 * v
        misses.append(
            [
                np.abs(velocity[: len(v), 0] - v).max() / np.abs(v).max(),
                np.abs(force[: len(v), 1] - behind).max() / behind.max(),
                np.abs(force[: len(v), 0] - force[: len(v), 1] - (k * y + c * (v - u))).max() / 2e4,
            ]
        )
    assert max(misses[0]) < 1e-4
    assert np.array(misses[0]) / misses[1] == pytest.approx(4.0, abs=0.1)


def test_a_mass_on_a_spring_at_the_end_of_a_bar():
    m, k, c = 0.05, 2e8, 150.0

    def rates(t, x):
        y, u = x
        v = (2 * PULSE.at(t) - k * y + c * u) / (Z1 + c)
        return [v - u, (k * y + c * (v - u)) / m]

    misses = []
    for step in (STEP, STEP / 2):
        stack = Stack((timed("bar", Z1),), (), End("oscillator", m, k, c))
        run = run_bar(stack, PULSE, [Tap(0, 1.0)], 2.2e-4, WantedError(step=step))
        times, (y, u) = solved(rates, [0.0, 0.0], 2e-4, step)
        v = (2 * PULSE.at(times) - k * y + c * u) / (Z1 + c)
        first = round(200 * STEP / step)
        misses.append(np.abs(run.velocity[first : first + len(v), 0] - v).max() / np.abs(v).max())
        assert run.momentum_error < 1e-12
    assert misses[0] < 1e-4
    assert misses[0] / misses[1] == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("preload", [0.0, 3e3])
def test_a_hertz_contact_between_endless_bars(preload):
    """d' = 2 P (1/Z1) - (1/Z1 + 1/Z2) f, f = K (d0 + d)^1.5 - preload; it opens, flies and lets nothing pass."""
    K, n = 4e12, 1.5
    d0 = (preload / K) ** (1 / n)
    load = Sampled(
        1e-6 * np.arange(101.0), 2e4 * np.sin(2 * np.pi * np.arange(101.0) / 100.0), "incident"
    )  # a push, then a pull

    def force_at(d):
        return K * np.maximum(d0 + d, 0.0) ** n - preload

    def rates(t, x):
        return [2 * load.at(np.array(t)) / Z1 - (1 / Z1 + 1 / Z2) * force_at(x[0])]

    misses = []
    for step in (STEP / 2, STEP / 4):
        done, force, _ = incident(load, 1.5e-4, step)(Joint(contact=Contact(K, n), preload=preload))
        times, (d,) = solved(rates, [0.0], 1.5e-4, step)
        misses.append(np.abs(force[: len(d), 1] - force_at(d)).max() / 2e4)
        apart = d0 + d < 0.0
        opened = times[np.flatnonzero(apart)[0]] + 200 * STEP
        assert done.events[0, 2] == 1.0
        assert done.events[0, 1] == pytest.approx(opened, abs=2 * step)
    assert misses[0] < 2e-4
    assert misses[0] / misses[1] == pytest.approx(4.0, abs=0.4)


def test_a_contact_with_a_gap_closes_when_the_gap_has_gone():
    """The face before runs at 2 P/Z1 until the gap is closed: its integral gives the time."""
    gap = 20e-6
    done, force, _ = incident(PULSE, 2e-4, STEP)(Joint(contact=Contact(4e12, 1.5), gap=gap))
    times = STEP * np.arange(2000)
    way = np.cumsum(2 * PULSE.at(times) / Z1) * STEP
    closes = times[np.flatnonzero(way > gap)[0]]
    assert done.events[0, 2] == 0.0
    assert done.events[0, 1] - 200 * STEP == pytest.approx(closes, abs=2 * STEP)
    assert np.all(force[: round(closes / STEP) - 2, 1] == 0.0)
    assert force[:, 1].max() > 1e4


def test_a_yielding_contact_keeps_what_has_yielded():
    """Two equal pulses: the first leaves a dent, the second presses less energy out of the same contact."""
    time = 1e-6 * np.arange(201.0)
    one = np.where(time < 80e-6, 3e4 * np.sin(np.pi * time / 80e-6) ** 2, 0.0)
    two = one + np.roll(one, 120)
    contact = Contact(4e12, 1.5, cap=PressureCap(5e3, "point"))
    lost = []
    for values in (one, two):
        stack = between_endless_bars(Joint(contact=contact))
        grid = grid_of(stack, STEP)
        tables, state = tables_of(stack, grid), state_at_rest(stack, grid)
        load = Sampled(time, values, "incident")
        history = load.at(STEP * np.arange(3000.0))
        nothing = _kernels.Recording(np.zeros((0, 2), np.int64), 1, np.zeros((1, 0)), np.zeros((1, 0)))
        extremes = _kernels.Extremes(np.zeros((0, 2), np.int64), 1, np.zeros(0), np.zeros(0))
        _kernels.drive(
            tables,
            state,
            history,
            2,
            (nothing, nothing),
            empty_averages(nothing.nodes, nothing.nodes, 1, 1),
            extremes,
            np.zeros(6),
        )
        lost.append(float(state.joint[0, _kernels.LOST]))
        deepest, growth = state.joint[0, _kernels.DEEPEST], state.joint[0, _kernels.GROWTH]
        assert growth > 1.0
        # apart at last: what is stored is gone, and all work has been lost
        assert state.joint[0, _kernels.WORK] == pytest.approx(lost[-1], rel=2e-3)
        assert state.joint[0, _kernels.COMPRESSION] == pytest.approx(deepest * (1 - 1 / growth), rel=1e-3)
    assert 0.0 < lost[1] - lost[0] < 0.2 * lost[0]


@pytest.mark.parametrize("preload", [2e3, 1e4])
def test_a_bolted_joint_opens_at_its_preload_and_closes_when_the_gap_has_gone(preload):
    """Equal bars, a pulling half-sine: it opens at F0 sin = preload; 2/Z times the rest integrates to the gap."""
    peak, duration = 2e4, 80e-6
    load = LoadPulse("half-sine", -peak, duration, kind="incident")
    stack = Stack((timed("before", Z1), timed("after", Z1)), (Joint(unilateral=True, preload=preload),), End("matched"))
    run = run_bar(stack, load, [Tap(1, 0.0)], 1e-3, WantedError(step=STEP))
    opens = math.asin(preload / peak) * duration / math.pi
    times = np.linspace(opens, 1e-3, 1_000_001)
    gap = np.cumsum(-load.at(times) - preload) * (times[1] - times[0])
    closes = times[np.flatnonzero(gap > 0)[-1]]
    arrival = 200 * STEP
    assert run.events[:, 2].tolist() == [1.0, 0.0]
    assert run.events[:, 1] == pytest.approx([arrival + opens, arrival + closes], abs=2.5 * STEP)
    assert run.force[:, 0].min() == -preload


def test_behind_an_incident_wave_lies_an_endless_bar():
    """A free end sends the wave back; at the first face it passes on, so that nothing comes a second time."""
    stack = Stack((timed("bar", Z1),))
    run = run_bar(stack, PULSE, [Tap(0, 1.0), Tap(0, 0.0)], 5e-4, WantedError(step=STEP))
    expected = PULSE.at(run.time) - PULSE.at(run.time - 400 * STEP)
    assert run.face_force == pytest.approx(expected, abs=1e-8)
    assert run.velocity[:, 0] == pytest.approx(2 * PULSE.at(run.time - 200 * STEP) / Z1, abs=1e-12)


@given(st.floats(1e11, 1e13), st.floats(1.0, 2.0), st.floats(0.0, 1e4), st.floats(1e3, 4e4))
def test_a_nonlinear_contact_never_gives_out_energy(stiffness, exponent, preload, peak):
    """Of the energy of an incident wave no more is found in the waves that leave, in the contact and its bolt."""
    joint = Joint(contact=Contact(stiffness, exponent), preload=preload)
    load = LoadPulse("sine-squared", peak, 60e-6, kind="incident")
    run = run_bar(between_endless_bars(joint), load, [Tap(0, 0.0), Tap(1, 1.0)], 3e-4, WantedError(step=STEP))
    into = np.sum(load.at(run.time) ** 2) / Z1
    back = np.sum((run.force[:, 0] - load.at(run.time)) ** 2) / Z1
    on = np.sum(run.force[:, 1] ** 2) / Z2
    assert back + on <= into * (1 + 1e-3)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Joint(contact=Contact(1e9, 1.5, 0.3)), "restitution of 1"),
        (lambda: Joint(contact=Contact(1e9, 1.5, damper=Damper(1.0))), "damper"),
        (lambda: Joint(1e9, contact=Contact(1e9, 1.5)), "nothing else"),
        (lambda: Joint(contact=Contact(1e9, 1.5), gap=1e-6, preload=1.0), "no preload"),
        (lambda: Joint(contact=Contact(1e9, 1.5, cap=PressureCap(1e3, "point")), preload=2e3), "first yield"),
        (lambda: Joint(attached=0.1), "finite stiffness"),
        (lambda: Joint(1e9, attached=math.nan), "negative"),
        (lambda: End("oscillator", 0.1), "stiffness above zero"),
        (lambda: End("oscillator", 0.0, 1e6), "above zero"),
    ],
)
def test_joints_and_ends_that_cannot_be_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize(("coefficient", "exponent", "style"), [(200.0, 0.0, "never-pulls"), (3e6, 1.0, "on-approach")])
def test_a_striker_with_a_damper_on_an_endless_bar(coefficient, exponent, style):
    """m u' = -F, d' = u - F/Z, F = K d^1.5 + c d^p d' solved for F; second order in the step, first with a jump of F."""
    K, n, mass, speed = 2e10, 1.5, 0.05, 3.0

    def force_at(d, u):
        spring, c = K * np.maximum(d, 0.0) ** n, coefficient * np.maximum(d, 0.0) ** exponent
        damped = (spring + c * u) / (1 + c / Z1)
        if style == "on-approach":
            damped = np.where(u - damped / Z1 > 0.0, damped, spring)
        return np.maximum(damped, 0.0)

    def rates(t, x):
        f = float(force_at(x[0], x[1]))
        return [x[1] - f / Z1, -f / mass]

    misses = []
    for step in (STEP / 2, STEP / 4):
        contact = Contact(K, n, damper=Damper(coefficient, exponent, style))
        stack = Stack((timed("bar", Z1),), (), End("matched"))
        run = run_bar(stack, Impactor(mass, speed, contact), [Tap(0, 0.0)], 6e-5, WantedError(step=step))
        _, (d, u) = solved(rates, [0.0, speed], 6e-5, step)
        misses.append(np.abs(run.face_force[1 : len(d)] - force_at(d, u)[1:]).max() / force_at(d, u).max())
        assert run.momentum_error < 1e-12
        assert run.energy_lost > 0.0
    assert misses[0] < 1e-3
    assert misses[0] / misses[1] > 1.9


def test_a_damper_that_pulls_is_refused_where_waves_are():
    with pytest.raises(ValueError, match="never pulls"):
        run_bar(
            Stack((timed("bar", Z1),)),
            Impactor(0.1, 1.0, Contact(1e9, 1.0, damper=Damper(1.0, style="pulls"))),
            [Tap(0, 0.0)],
            1e-4,
        )


def test_a_striker_may_hit_a_stack_with_a_contact_inside():
    """Momentum closes to rounding although three contacts press at once."""
    stack = Stack(
        (timed("a", Z1), timed("b", Z2), timed("c", Z1)), (Joint(contact=Contact(4e12, 1.5), gap=1e-6), BONDED)
    )
    run = run_bar(stack, Impactor(0.05, 3.0, Contact(4e12, 1.5)), [Tap(2, 1.0)], 4e-4)
    assert run.momentum_error < 1e-12
    assert run.events[0, 2] == 0.0
