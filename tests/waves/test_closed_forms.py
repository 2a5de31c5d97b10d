"""Stacks against closed forms, printed numbers, and independent solutions by scipy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.base.constants import material
from strikewave.contact import Contact
from strikewave.waves import (
    BONDED,
    Branch,
    End,
    Impactor,
    Joint,
    Layer,
    LoadPulse,
    Stack,
    Tap,
    WantedError,
    round_bar,
    run_bar,
)

STEEL, ALUMINIUM = material("65Mn"), material("2A12")
G = 9.80665
STEPS = (40e-9, 20e-9, 10e-9, 5e-9)
"""Each half the one before: the order of a scheme is the base-2 logarithm of how its error falls."""


def cut(name, matter, transit, diameter=0.03, speed=0.0):
    """Return a round bar by its transit time."""
    return round_bar(name, matter, transit * math.sqrt(matter.youngs_modulus / matter.density), diameter, speed)


def orders(errors):
    """Return by which power of the step the errors fall from one step to the next half."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


def assert_second_order(errors, last=0.1):
    """The trapezoidal rule is of second order: each halving of the step quarters the error."""
    found = orders(errors)
    assert abs(found[-1] - 2.0) < last, f"orders {found}, errors {errors}"


def test_speed_and_impedance_of_65mn():
    """5194.43 m/s and 4.0620e7 kg/(m^2 s), to the digits printed."""
    bar = round_bar("bar", STEEL, 0.1, 0.03)
    assert bar.bar_speed == pytest.approx(5194.43, abs=0.005)
    assert bar.impedance / bar.area == pytest.approx(4.0620e7, abs=500)


def test_force_at_an_interface_of_65mn_and_2a12():
    """Transmitted .51664 and reflected -.48336 of the incident force, to the digits printed; 1e-13 by the formula."""
    step = 1e-7
    stack = Stack((cut("steel", STEEL, 5e-6), cut("aluminium", ALUMINIUM, 5e-6)), (BONDED,), End("matched"))
    run = run_bar(stack, LoadPulse("rectangle", 1.0, 1e-3), [Tap(0, 0.5), Tap(1, 0.5)], 9.9e-6, WantedError(step=step))
    z1, z2 = (layer.impedance for layer in stack.layers)
    assert run.force[80, 0] - run.force[40, 0] == pytest.approx(-0.48336, abs=5e-6)
    assert run.force[80, 1] == pytest.approx(0.51664, abs=5e-6)
    assert run.force[80, 1] == pytest.approx(2 * z2 / (z1 + z2), rel=1e-13)
    assert run.force[80, 0] == pytest.approx(2 * z2 / (z1 + z2), rel=1e-13)
    assert run.force[40, 0] == 1.0


def test_force_rises_in_a_staircase_behind_a_soft_layer():
    """Steel, aluminium, steel: .766365 .945415 .987247 .997020 at t0, 3 t0, 5 t0, 7 t0, to the digits printed."""
    step, t0 = 1e-7, 4e-6
    layers = (cut("a", STEEL, 100e-6), cut("b", ALUMINIUM, t0), cut("c", STEEL, 2e-6))
    stack = Stack(layers, (BONDED, BONDED), End("matched"))
    run = run_bar(stack, LoadPulse("rectangle", 1.0, 1e-3), [Tap(1, 1.0)], 135e-6, WantedError(step=step))
    begin = 1000
    for n, expected in enumerate([0.766365, 0.945415, 0.987247, 0.997020]):
        tread = run.force[begin + (2 * n + 1) * 40 : begin + (2 * n + 3) * 40, 0]
        assert tread == pytest.approx(expected, abs=5e-7)
        assert np.ptp(tread) < 1e-13
    assert np.all(run.force[: begin + 40, 0] == 0.0)


def test_free_bar_under_a_step_of_force():
    """70 mm of steel, 30 mm thick, 19.685 kN: 1.371 m/s each 26.95 us at the far end, half a step at the loaded one."""
    bar = round_bar("bar", STEEL, 0.07, 0.03)
    step = bar.transit / 100
    run = run_bar(
        Stack((bar,)),
        LoadPulse("rectangle", 19685.0, 1.0),
        [Tap(0, 0.0), Tap(0, 1.0)],
        20 * bar.transit * (1 + 1e-9),
        WantedError(step=step),
    )
    assert 2 * bar.transit == pytest.approx(26.95e-6, abs=0.005e-6)
    jump = 2 * 19685.0 / bar.impedance
    assert jump == pytest.approx(1.371, abs=5e-4)
    n = np.arange(len(run.time))
    # the far end moves first after one transit, and again after each two; the loaded end by half a step at once
    assert run.velocity[:, 1] == pytest.approx(jump * ((n + 100) // 200), abs=1e-12)
    assert run.velocity[:, 0] == pytest.approx(jump * (n // 200 + 0.5), abs=1e-12)
    mean = (run.velocity[1900, 1] - run.velocity[100, 1]) / (1800 * step)
    assert mean / G == pytest.approx(5188, abs=0.5)
    assert mean == pytest.approx(19685.0 / bar.mass, rel=1e-12)
    assert run.momentum == pytest.approx(19685.0 * step * (len(n) + 1), rel=1e-12)


def test_rigid_striker_on_a_matched_bar():
    """0.2 kg at 5 m/s on a steel bar of 20 mm: 63 806 N, falling with 15.67 us; second order in the step."""
    bar = round_bar("bar", STEEL, 0.1, 0.02)
    stack, decay = Stack((bar,), end=End("matched")), 0.2 / bar.impedance
    assert decay == pytest.approx(15.67e-6, abs=0.005e-6)
    assert 5.0 * bar.impedance == pytest.approx(63806, abs=0.5)
    errors = []
    for step in STEPS:
        run = run_bar(stack, Impactor(0.2, 5.0), [Tap(0, 0.0)], 5 * decay, WantedError(step=step))
        assert run.face_force[0] == pytest.approx(5.0 * bar.impedance, rel=1e-14)
        errors.append(np.abs(run.face_force / (5.0 * bar.impedance) - np.exp(-run.time / decay)).max())
    assert_second_order(errors, 0.01)
    # (dt/decay)^2/12 of t/decay exp(-t/decay), whose maximum is 1/e
    assert errors[-1] == pytest.approx((STEPS[-1] / decay) ** 2 / 12 / math.e, rel=1e-2)


@pytest.mark.parametrize(("thick", "thin"), [(0.03, 0.02), (0.02, 0.02), (0.04, 0.01)])
def test_thick_striker_bar_pushes_in_steps(thick, thin):
    """F_n = v0 Zs Zb/(Zs+Zb) [(Zs-Zb)/(Zs+Zb)]^n, a new one each 2 Ls/cs; equal bars part after the first."""
    count, steps, v0 = 50, 900, 7.0
    striker, bar = cut("striker", STEEL, count * 1e-7, thick, v0), cut("bar", STEEL, 100e-7, thin)
    stack = Stack((striker, bar), (Joint(unilateral=True),), End("matched"))
    run = run_bar(stack, LoadPulse("rectangle", 0.0, 1.0), [Tap(1, 0.0)], steps * 1e-7, WantedError(step=1e-7))
    zs, zb = striker.impedance, bar.impedance
    n = np.arange(steps + 1) // (2 * count)
    ratio = 0.0 if thick == thin else (zs - zb) / (zs + zb)
    expected = v0 * zs * zb / (zs + zb) * ratio**n
    # rounding of some twenty operations
    assert run.force[:, 0] == pytest.approx(expected, abs=1e-13 * expected[0])


def test_thin_striker_bar_opens_after_its_first_wave():
    """Zs < Zb: one rectangle of 2 Ls/cs, then the striker flies back at v0 (Zs - Zb)/(Zs + Zb) and nothing more."""
    count, steps, v0 = 50, 900, 7.0
    striker, bar = cut("striker", STEEL, count * 1e-7, 0.015, v0), cut("bar", STEEL, 100e-7, 0.03)
    stack = Stack((striker, bar), (Joint(unilateral=True),), End("matched"))
    taps = [Tap(1, 0.0), Tap(0, 0.5)]
    run = run_bar(stack, LoadPulse("rectangle", 0.0, 1.0), taps, steps * 1e-7, WantedError(step=1e-7))
    zs, zb = striker.impedance, bar.impedance
    force = v0 * zs * zb / (zs + zb)
    assert run.force[: 2 * count, 0] == pytest.approx(force, rel=1e-13)
    assert np.all(run.force[2 * count :, 0] == 0.0)
    back = run.velocity[2 * count + count // 2 :, 1]
    assert back == pytest.approx(v0 * (zs - zb) / (zs + zb), rel=1e-12)


@pytest.mark.parametrize("beta", [0.05, 0.3, 0.6, 1.0, 1.7])
def test_stress_gets_uniform_in_a_short_layer(beta):
    """alpha_k = 2 beta (1-beta)^(k-1)/[(1+beta)^k - (1-beta)^(k-1)] within transit k; 2 while the wave enters.

    The difference of the face that the wave has left and the one it runs to, over their mean.
    """
    count, step = 20, 1e-7
    bar = cut("incident bar", STEEL, 400e-7)
    short = Layer("specimen", bar.density, bar.modulus, bar.area * beta, count * step * bar.bar_speed)
    stack = Stack((bar, short, bar), (BONDED, BONDED), End("matched"))
    run = run_bar(stack, LoadPulse("rectangle", 1.0, 1.0), [Tap(1, 0.0), Tap(1, 1.0)], 780e-7, WantedError(step=step))
    arrived = 400
    for k in range(1, 15):
        middle = arrived + round((k - 0.5) * count)
        left, ahead = run.force[middle][:: 1 if k % 2 else -1]
        alpha = (left - ahead) / (0.5 * (left + ahead))
        expected = 2 * beta * (1 - beta) ** (k - 1) / ((1 + beta) ** k - (1 - beta) ** (k - 1))
        # a difference of two forces of order 1
        assert alpha == pytest.approx(expected, abs=1e-13 / left)


# what closes a bar, under an incident wave P(t): x' = A x + B P, forces and speeds = C x + D P

PEAK, DURATION, TRANSIT = 1e4, 40e-6, 30e-6
BAR, BEHIND = cut("bar", STEEL, TRANSIT), cut("behind", ALUMINIUM, 4e-6, 0.02)
Z1, Z2 = BAR.impedance, BEHIND.impedance
Y = 1 / Z1 + 1 / Z2


def linear_answer(system, load, t):
    """Return C x + D P of x' = A x + B P from rest in closed form, for P = PEAK (1 - cos wt)/2 or PEAK from time 0.

    A constant part, a part that turns at w, and the free decay that makes x(0) = 0; behind the pulse only decay,
    and nothing before time 0.
    """
    a, b, c, d = (np.asarray(part, dtype=float) for part in system)
    w = 2 * math.pi / DURATION
    smooth = load == "sine-squared"
    steady = np.linalg.solve(a, -b) * PEAK * (0.5 if smooth else 1.0)
    turning = np.linalg.solve(1j * w * np.eye(len(a)) - a, b) * PEAK * (-0.5 if smooth else 0.0)

    # the free decay in the directions in which it is one exponential each; real rates, none equal
    rates, ways = np.linalg.eig(a)

    def decay(state, time):
        return (ways * np.linalg.solve(ways, state)) @ np.exp(np.multiply.outer(rates, time))

    def driven(time):
        forced = steady[:, None] + np.multiply.outer(turning, np.exp(1j * w * time)).real
        return forced - decay(steady + turning.real, time)

    x = driven(np.clip(t, 0.0, DURATION if smooth else None))
    if smooth:
        late = t > DURATION
        x[:, late] = decay(driven(np.array([DURATION]))[:, 0], t[late] - DURATION)
    assert np.isrealobj(x)
    if smooth:
        pulse = np.where((t > 0) & (t < DURATION), np.sin(math.pi * t / DURATION) ** 2, 0.0)
    else:
        pulse = np.where(t >= 0.0, 1.0, 0.0)
    return x.T @ c.T + PEAK * pulse[:, None] * d


def end_mass(m):
    """M v' = f, f = 2 P - Z v: with a step the force falls as 2 P exp(-Z t/m)."""
    return [[-Z1 / m]], [2 / m], [[-Z1], [1.0]], [2.0, 0.0]


def end_spring(k):
    """F' = k v, v = (2 P - f)/Z: with a step the force rises as 2 P [1 - exp(-k t/Z)]."""
    return [[-k / Z1]], [2 * k / Z1], [[1.0], [-1 / Z1]], [0.0, 2 / Z1]


def joint(k, damping=0.0, branches=()):
    """F = k x + c x' + sum w, w' = k_j x' - w/tau, x' = 2 P/Z1 - Y f; rows: force, speed before, speed behind."""
    share = 1 / (1 + damping * Y)
    size = 1 + len(branches)
    held = np.array([k, *[1.0] * len(branches)])  # what the state itself pushes with
    rate_x, rate_p = -Y * share * held, share * 2 / Z1
    a = np.zeros((size, size))
    a[0] = rate_x
    b = np.zeros(size)
    b[0] = rate_p
    for j, (stiffness, tau) in enumerate(branches, start=1):
        a[j], b[j] = stiffness * rate_x, stiffness * rate_p
        a[j, j] -= 1 / tau
    force, force_p = held + damping * rate_x, damping * rate_p
    return a, b, [force, -force / Z1, force / Z2], [force_p, (2 - force_p) / Z1, force_p / Z2]


def point_mass(m):
    """M v' = 2 P - (Z1 + Z2) v; rows: force before, force behind, speed."""
    return [[-(Z1 + Z2) / m]], [2 / m], [[-Z1], [Z2], [1.0]], [2.0, 0.0, 0.0]


BEFORE, AFTER = Tap(0, 1.0), Tap(1, 0.0)
BRANCHES = ((3e9, 1.5e-6), (1.2e9, 9e-6))
ELEMENTS = {
    "mass at the end": (Stack((BAR,), end=End("mass", 0.1)), end_mass(0.1), ["force 0", "speed 0"]),
    "spring at the end": (Stack((BAR,), end=End("spring", 4e9)), end_spring(4e9), ["force 0", "speed 0"]),
    "compliant joint": (
        Stack((BAR, BEHIND), (Joint(1.5e9),), End("matched")),
        joint(1.5e9),
        ["force 1", "speed 0", "speed 1"],
    ),
    "compliant joint with damping": (
        Stack((BAR, BEHIND), (Joint(1.5e9, 4e3),), End("matched")),
        joint(1.5e9, 4e3),
        ["force 0", "speed 0", "speed 1"],
    ),
    "gasket": (
        Stack((BAR, BEHIND), (Joint(8e8, branches=tuple(Branch(*x) for x in BRANCHES)),), End("matched")),
        joint(8e8, 0.0, BRANCHES),
        ["force 1", "speed 0", "speed 1"],
    ),
    "gasket with damping": (
        Stack((BAR, BEHIND), (Joint(8e8, 3e3, tuple(Branch(*x) for x in BRANCHES)),), End("matched")),
        joint(8e8, 3e3, BRANCHES),
        ["force 1", "speed 0", "speed 1"],
    ),
    "point mass": (
        Stack((BAR, BEHIND), (Joint(mass=0.08),), End("matched")),
        point_mass(0.08),
        ["force 0", "force 1", "speed 0"],
    ),
    "compliant joint that could open": (
        Stack((BAR, BEHIND), (Joint(1.5e9, 4e3, unilateral=True, preload=1e6),), End("matched")),
        joint(1.5e9, 4e3),
        ["force 0", "speed 0", "speed 1"],
    ),
}


def response_errors(name, load, shift):
    """Return the largest error over the peak of each output, for each step; times of the closed form are shifted."""
    stack, system, outputs = ELEMENTS[name]
    taps = [BEFORE, AFTER][: len(stack.layers)]
    errors = []
    for step in STEPS:
        # the reflection is thrown back by the loaded face, and returns after three transits
        run = run_bar(
            stack, LoadPulse(load, PEAK, DURATION if load != "rectangle" else 1.0), taps, 88e-6, WantedError(step=step)
        )
        assert run.grid.mismatch < 1e-12  # whole steps: what is left is the trapezoidal rule
        keep = slice(round(TRANSIT / step), None, round(STEPS[0] / step))
        since = step * np.arange(len(run.time))[: len(run.time) - round(TRANSIT / step)][:: round(STEPS[0] / step)]
        expected = linear_answer(system, load, since + shift * step)
        found = {"force": run.force, "speed": run.velocity}
        columns = [found[kind][keep, int(k)] for kind, k in (output.split() for output in outputs)]
        errors.append([np.abs(x - y).max() / np.abs(y).max() for x, y in zip(columns, expected.T, strict=True)])
    return np.array(errors)


@pytest.mark.parametrize("name", ELEMENTS)
def test_elements_under_a_smooth_wave(name):
    """Forces and speeds against the closed form of the linear system: second order, 5e-8 of the peak at 5 ns.

    The trapezoidal rule's error is about (w dt)^2/12 = 5e-8 for the w = 2 pi/40 us of the wave.
    """
    errors = response_errors(name, "sine-squared", 0.0)
    for column in errors.T:
        assert_second_order(column, 0.001)
    assert errors[-1].max() < 5e-8, errors[-1]


@pytest.mark.parametrize("name", ELEMENTS)
def test_elements_under_a_step(name):
    """The exponentials of a step of force: first order, second once the step counts as half a step earlier.

    The trapezoidal rule takes a load as straight between samples, so a jump from one sample to the next has its
    middle half a step before the sample that first shows it.
    """
    plain, shifted = response_errors(name, "rectangle", 0.0), response_errors(name, "rectangle", 0.5)
    for first, second in zip(plain.T, shifted.T, strict=True):
        assert abs(orders(first)[-1] - 1.0) < 0.02, f"orders {orders(first)}, errors {first}"
        assert_second_order(second, 0.02)


def test_reference_of_the_elements_is_the_exponentials():
    """What the two tests above compare with: 2 P exp(-Z t/m), 2 P [1 - exp(-k t/Z)], 2 P/(Z1 Y) [1 - exp(-k Y t)]."""
    t = np.linspace(0.0, 50e-6, 11)
    mass, spring, held = (
        linear_answer(system, "rectangle", t)[:, 0] / (2 * PEAK)
        for system in (end_mass(0.1), end_spring(4e9), joint(1.5e9))
    )
    assert mass == pytest.approx(np.exp(-Z1 * t / 0.1), abs=1e-13)
    assert spring == pytest.approx(1 - np.exp(-4e9 * t / Z1), abs=1e-13)
    assert held == pytest.approx((1 - np.exp(-1.5e9 * Y * t)) / (Z1 * Y), abs=1e-13)
    # a Maxwell branch that never relaxes is one more spring
    assert linear_answer(joint(1e9, 0.0, ((5e8, 1e6),)), "rectangle", t)[:, 0] / (2 * PEAK) == pytest.approx(
        held, abs=1e-9
    )


@pytest.mark.verify
@given(st.floats(0.01, 100.0))
def test_dashpot_answers_at_once(ratio):
    """Force 2 P c/(c + Z), speed 2 P/(c + Z), reflected P (c - Z)/(c + Z): no memory, so exact to rounding."""
    damping, step = ratio * Z1, 1e-7
    stack = Stack((cut("bar", STEEL, 50 * step),), end=End("dashpot", damping))
    pulse = LoadPulse("half-sine", PEAK, 60 * step)
    run = run_bar(stack, pulse, [Tap(0, 1.0), Tap(0, 0.0)], 149 * step, WantedError(step=step))
    arrived = pulse.at(run.time - 50 * step)
    assert run.force[:, 0] == pytest.approx(2 * damping / (damping + Z1) * arrived, abs=1e-12 * PEAK)
    assert run.velocity[:, 0] == pytest.approx(2 / (damping + Z1) * arrived, abs=1e-12 * PEAK / Z1)
    back = (damping - Z1) / (damping + Z1) * pulse.at(run.time - 100 * step)
    # at the loaded face f = P + M is given, so that Z v = f - 2 M
    expected = (pulse.at(run.time) - 2 * back) / Z1
    assert run.velocity[:, 1] == pytest.approx(expected, abs=1e-11 * PEAK / Z1)


# a striker with a contact law


def contact_force(law, speed, d, v, z, wave):
    """Return F = K d^n (1 + chi d'/v0), d' = v - (F - 2 M)/Z solved for F; never below zero."""
    k, n, chi = law
    spring = k * max(d, 0.0) ** n
    return max(spring * (1 + chi * (v + 2 * wave / z) / speed) / (1 + spring * chi / (z * speed)), 0.0)


def scipy_striker(law, mass, speed, z, transit, t):
    """Follow a striker on a bar with a free far end by steps of a delay differential equation; return its force.

    The backward wave at the face is M(t) = -P(t - 2 T), P = F - M, known from the interval before; an infinite T
    is a matched bar.
    """
    period = min(2 * transit, 1.01 * t[-1])
    pieces = []

    def backward(k, s):
        return 0.0 if k == 0 else -forward(k - 1, s)

    def forward(k, s):
        d, v = pieces[k](s)
        m = backward(k, s)
        return contact_force(law, speed, d, v, z, m) - m

    force, state = np.zeros(len(t)), [0.0, speed]
    for k in range(math.ceil(t[-1] / period - 1e-9)):

        def rates(s, y, k=k):
            m = backward(k, s)
            f = contact_force(law, speed, y[0], y[1], z, m)
            return [y[1] - (f - 2 * m) / z, -f / mass]

        # the reflected wave has a corner where the contact lets go: short steps see it
        solved = solve_ivp(
            rates,
            (0, period),
            state,
            method="DOP853",
            rtol=1e-10,
            atol=[1e-18, 1e-12],
            dense_output=True,
            max_step=period / 100,
        )
        pieces.append(solved.sol)
        state = solved.y[:, -1]
        for i in np.flatnonzero((t >= k * period) & (t < (k + 1) * period)):
            s = t[i] - k * period
            m = backward(k, s)
            force[i] = contact_force(law, speed, *solved.sol(s), z, m)
    return force


@pytest.mark.verify
@pytest.mark.parametrize(
    ("mass", "law"),
    [(0.1, (4.7e9, 10 / 9, 0.0)), (0.1, (4.7e9, 10 / 9, 0.6)), (0.1, (5e10, 1.5, 0.8)), (1.0, (2e11, 1.5, 0.0))],
    ids=["elastic line", "lossy line", "lossy point", "heavy striker"],
)
@pytest.mark.parametrize("length", ["endless", "short"])
def test_contact_law_on_a_bar(mass, law, length):
    """A striker at 4 m/s against scipy: second order, at 5 ns a few 1e-7 of the peak force.

    On a short free bar the waves come back several times while the contact lasts.
    The order is not met to the last digit: a release lies anywhere within its step.
    """
    speed, until = 4.0, 60e-6
    bar = cut("bar", STEEL, 4e-6)
    stack = Stack((bar,), end=End("matched" if length == "endless" else "free"))
    times = STEPS[0] * np.arange(round(until / STEPS[0]))
    expected = scipy_striker(law, mass, speed, bar.impedance, math.inf if length == "endless" else 4e-6, times)
    errors = []
    for step in STEPS:
        run = run_bar(stack, Impactor(mass, speed, Contact(*law)), [Tap(0, 0.0)], until, WantedError(step=step))
        assert run.grid.mismatch < 1e-12
        found = run.face_force[:: round(STEPS[0] / step)][: len(times)]
        errors.append(np.abs(found - expected).max() / expected.max())
    assert_second_order(errors, 0.05)
    assert errors[-1] < 2e-7, errors
    ends = times[np.flatnonzero(expected)[-1]]
    if ends < times[-1]:
        assert ends <= run.touches[-1, 1] <= ends + STEPS[0]
