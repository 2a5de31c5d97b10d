"""Exact answers between samples: closed forms of the mass on a spring, and an independent integrator."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.sensors.response import IDENTITY, LinearSystem, respond, seismic, series


@pytest.mark.parametrize("step", [1e-8, 1e-6, 3.7e-5])  # 1/1000, 1/10 and 3.7 periods
@pytest.mark.parametrize("damping_ratio", [0.0, 0.05, 0.999999, 1.0, 3.0])
def test_step_response_at_any_step(step, damping_ratio):
    f, zeta = 100e3, damping_ratio
    w = 2.0 * math.pi * f
    t = np.arange(700) * step
    got = respond(seismic(f, math.inf if zeta == 0.0 else 0.5 / zeta), np.ones(t.size), step)
    if zeta == 1.0:
        expected = 1.0 - np.exp(-w * t) * (1.0 + w * t)
    else:
        root = np.sqrt(complex(zeta**2 - 1.0))
        s1, s2 = w * (-zeta + root), w * (-zeta - root)
        expected = 1.0 - ((s2 * np.exp(s1 * t) - s1 * np.exp(s2 * t)) / (s2 - s1)).real
    # the closed form itself cancels where the two roots are 3e-3 apart; phase round-off grows with w t
    assert np.allclose(got, expected, atol=1e-10)


@pytest.mark.parametrize("step", [1e-7, 2.3e-5])
def test_ramp_is_exact_because_it_is_linear(step):
    f = 100e3
    w = 2.0 * math.pi * f
    t = np.arange(500) * step
    got = respond(seismic(f, math.inf), t, step)
    assert np.allclose(got, t - np.sin(w * t) / w, atol=1e-11 * t[-1])


def test_half_sine_response_in_closed_form():
    # (sin W t - r sin w t) / (1 - r^2) within the pulse, r = W/w; undamped
    f, T = 60e3, 100e-6
    w, W = 2.0 * math.pi * f, math.pi / T
    r = W / w
    t = np.linspace(0.0, T, 20001)
    got = respond(seismic(f, math.inf), np.sin(W * t), t[1])
    expected = (np.sin(W * t) - r * np.sin(w * t)) / (1.0 - r * r)
    # chords lie (W h)^2/8 = 3e-9 below the sine
    assert np.allclose(got, expected, atol=1e-8)


@pytest.mark.verify
@given(st.floats(0.2, 200.0), st.integers(0, 10))
def test_agrees_with_an_integrator_on_random_chords(quality, seed):
    f, step = 80e3, 2e-6
    w = 2.0 * math.pi * f
    values = np.random.default_rng(seed).normal(size=40)
    times = np.arange(values.size) * step
    got = respond(seismic(f, quality), values, step)
    state, expected = np.zeros(2), [0.0]
    for n in range(values.size - 1):  # from corner to corner, so that the integrator sees no kink

        def rates(t, y, n=n):
            a = values[n] + (values[n + 1] - values[n]) * (t - times[n]) / step
            return [y[1], w * w * (a - y[0]) - w / quality * y[1]]

        state = solve_ivp(rates, (times[n], times[n + 1]), state, method="DOP853", rtol=1e-11, atol=1e-9).y[:, -1]
        expected.append(state[0])
    assert np.allclose(got, expected, atol=1e-8)


@given(st.integers(2, 40))
def test_coarse_steps_lose_nothing_of_a_piecewise_linear_input(many):
    corners = np.random.default_rng(many).normal(size=30)
    fine = np.interp(np.arange(29 * many + 1) / many, np.arange(30), corners)
    system = series(seismic(90e3, 3.0), seismic(400e3, 30.0))
    coarse_step = 2e-5  # eight periods of the faster one
    coarse = respond(system, corners, coarse_step)
    assert np.allclose(coarse, respond(system, fine, coarse_step / many)[::many], atol=1e-11)


@pytest.mark.parametrize("size", [1, 2, 255, 256, 257, 1000])
def test_blocks_are_seamless(size):
    # the plain recursion x_(n+1) = e^(-h) x_n + .. of x' = -x + u with u = n h, whose answer is t - 1 + e^-t
    decay = LinearSystem(np.array([[-1.0]]), np.array([1.0]), np.array([1.0]), 0.0)
    t = np.arange(size) * 0.01
    assert np.allclose(respond(decay, t, 0.01), t - 1.0 + np.exp(-t), atol=1e-13)


def test_causal_to_the_last_bit():
    values = np.sin(np.arange(1000) / 20.0)
    later = values.copy()
    later[700:] = 9.0
    system = seismic(50e3, 10.0)
    # outputs of one block come from one product, whose zeros round nothing away but may be summed in another order
    assert np.allclose(respond(system, values, 1e-6)[:700], respond(system, later, 1e-6)[:700], atol=1e-14)


def test_identity_and_infinite_resonance_change_nothing():
    values = np.random.default_rng(1).normal(size=100)
    assert np.array_equal(respond(IDENTITY, values, 1e-6), values)
    assert np.array_equal(respond(seismic(math.inf, 1.0), values, 1e-6), values)


@pytest.mark.parametrize(
    ("values", "step", "word"),
    [([[1.0]], 1e-6, "one history"), ([], 1e-6, "one history"), ([math.inf], 1e-6, "finite"), ([1.0], -1.0, "step")],
)
def test_bad_histories_are_refused_in_words(values, step, word):
    with pytest.raises(ValueError, match=word):
        respond(IDENTITY, values, step)


def test_a_slow_resonance_of_low_quality_answers_like_any():
    """5 mHz, Q = 5e-3: z = 100; of a step 1 - (s2 exp(s1 t) - s1 exp(s2 t))/(s2 - s1)."""
    w, z, t = 2.0 * math.pi * 5e-3, 100.0, 50.0 * np.arange(40)
    s1, s2 = w * (-z + math.sqrt(z * z - 1.0)), w * (-z - math.sqrt(z * z - 1.0))
    expected = 1.0 - (s2 * np.exp(s1 * t) - s1 * np.exp(s2 * t)) / (s2 - s1)
    assert respond(seismic(5e-3, 5e-3), np.ones(40), 50.0) == pytest.approx(expected, abs=1e-12)


def test_bad_resonance_is_refused_in_words():
    with pytest.raises(ValueError, match="resonance and quality"):
        seismic(0.0, 1.0)


def test_the_transfer_function_in_series_is_the_product_of_both():
    """c (s - A)^-1 b + d at four places, of systems with and without a direct way, and of plain factors."""

    def transfer(one, s):
        return one.c @ np.linalg.solve(s * np.eye(one.b.size) - one.A, one.b.astype(complex)) + one.d

    rng = np.random.default_rng(6)
    systems = [LinearSystem(rng.normal(size=(n, n)), *rng.normal(size=(2, n)), d) for n, d in ((2, 0.7), (3, -1.3))]
    systems += [LinearSystem(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 2.5)]
    for first in systems:
        for second in systems:
            for s in (3.0, 2j, -1.0 + 4j, 5.0 - 2j):
                wanted = transfer(first, s) * transfer(second, s)
                assert transfer(series(first, second), s) == pytest.approx(wanted, rel=1e-10)


def test_a_direct_way_adds_its_share_of_the_input():
    decay = LinearSystem(np.array([[-1.0]]), np.array([1.0]), np.array([1.0]), 0.5)
    t = np.arange(600) * 0.01
    assert np.allclose(respond(decay, 1.0 + t, 0.01), t + 0.5 * (1.0 + t), atol=1e-13)
    assert respond(LinearSystem(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 2.5), t, 0.01) == pytest.approx(2.5 * t)
