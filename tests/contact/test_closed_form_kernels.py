"""The closed form of an impact as plain functions: its parts against mpmath, its moments against scipy's integrator."""

import itertools
import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from strikewave.contact._kernels import (
    all_moments,
    distance_at,
    duration_integral,
    factors,
    from_begin,
    from_end,
    history,
    impact,
    impacts,
    log_rest,
    loss_of_span,
    moments,
    peak_rate,
    phi,
    polynomial,
    rate_at,
    restitution_of_span,
    restitutions,
    span_of_factor,
    span_of_restitution,
    stretch_integral,
    time_unit,
)

from .interpreted import interpret

KERNELS = (
    all_moments, distance_at, duration_integral, factors, from_begin, from_end, history, impact, impacts, log_rest,
    loss_of_span, moments, peak_rate, phi, polynomial, rate_at, restitution_of_span, restitutions, span_of_factor,
    span_of_restitution, stretch_integral, time_unit,
)  # fmt: skip
"""What is tried here."""


@pytest.fixture
def kernels(monkeypatch):
    return interpret(monkeypatch, KERNELS)


def test_polynomials_series_and_what_is_left_of_exponential_and_logarithm(kernels):
    assert kernels.polynomial(np.array([2.0, -3.0, 5.0]), 4.0) == 2.0 * 16 - 12 + 5
    with mpmath.workdps(40):
        for x in (-4.0, -0.36, -0.34, 1e-7, 0.34, 0.36, 2.5):
            exact = mpmath.expm1(mpmath.mpf(x)) - mpmath.mpf(x)
            assert kernels.phi(x) == pytest.approx(float(exact), rel=2e-15, abs=0.0)
        for y in (-0.7, -0.081, -0.079, 1e-7, 0.079, 0.081, 3.0):
            exact = mpmath.mpf(y) - mpmath.log1p(mpmath.mpf(y))
            assert kernels.log_rest(y) == pytest.approx(float(exact), rel=4e-15, abs=0.0)


def lost(span):
    """1 - e = [L - 2 + (L + 2) exp(-L)]/(L - 1 + exp(-L))."""
    decay = mpmath.exp(-span)
    return (span - 2 + (span + 2) * decay) / (span - 1 + decay)


@pytest.mark.parametrize("span", [1e-13, 1e-6, 5e-4, 0.02, 0.49, 0.51, 0.99, 1.01, 3.0, 40.0])
def test_a_span_has_its_loss_and_factor_and_both_lead_back_to_it(kernels, span):
    with mpmath.workdps(60):
        loss, slope = lost(mpmath.mpf(span)), mpmath.diff(lost, mpmath.mpf(span), h=mpmath.mpf("1e-20"))
        chi = span / float(2 - loss)
    found = kernels.loss_of_span(span)
    assert found[0] == pytest.approx(float(loss), rel=2e-14, abs=0.0)
    # 1/3 below 1e-3; beyond, the closed form of a slope loses the square of the span
    assert found[1] == pytest.approx(float(slope), rel=3e-4 if span < 1e-3 else 1e-15 + 1e-14 / span**2)
    assert kernels.restitution_of_span(span) == pytest.approx(float(1 - loss), rel=1e-14)
    assert kernels.span_of_factor(chi) == pytest.approx(span, rel=3e-15)
    if span > 1e-6:  # 1 - e has no digits below
        assert kernels.span_of_restitution(float(1 - loss)) == pytest.approx(span, rel=1e-15 + 3e-16 / span)
    out, back = np.empty(2), np.empty(2)
    kernels.restitutions(np.array([chi, 0.3]), out)
    kernels.factors(out, back)
    assert back == pytest.approx([chi, 0.3], rel=3e-16 / span + 1e-14)


def test_spans_at_both_ends_of_the_restitution(kernels):
    assert kernels.span_of_restitution(1.0) == kernels.span_of_factor(0.0) == kernels.span_of_factor(-1.0) == 0.0
    # L -> 1 + 1/e for e -> 0, exp(-L) off
    assert kernels.span_of_restitution(1e-3) == pytest.approx(1001.0, rel=1e-15)
    assert kernels.span_of_factor(1e5) == pytest.approx(1e5 + 1.0, rel=1e-9)


@pytest.mark.parametrize(("chi", "e"), [(0.3, None), (1.7, None), (9.0, None)])
def test_height_and_rate_of_the_phase_plane_from_either_end(kernels, chi, e):
    """G(u) = Lambda + 1 + u - exp(u), y = exp(u) - 1, with u from ln(1 + chi) down to ln(1 - e chi), to fifty digits."""
    span = kernels.span_of_factor(chi)
    e = kernels.restitution_of_span(span)
    with mpmath.workdps(50):
        c = mpmath.mpf(chi)
        top, rest = mpmath.log1p(c), c - mpmath.log1p(c)
        end = top - mpmath.mpf(span)
        for share in (1e-6, 0.1, 0.45):
            w = mpmath.mpf(share) * mpmath.mpf(span)
            for released, u in ((False, top - w), (True, end + w)):
                height, y = rest + 1 + u - mpmath.exp(u), mpmath.expm1(u)
                found = kernels.from_end(chi, e, span, float(w)) if released else kernels.from_begin(chi, float(w))
                # rounding of span and e beside a small height
                assert found == pytest.approx(float(height), rel=1e-9, abs=1e-15 * chi)
                rate, push = kernels.rate_at(chi, e, span, float(w), released)
                assert rate == pytest.approx(float(y), rel=1e-10, abs=1e-13)
                assert push == pytest.approx(float(1 + y), rel=1e-12)


@pytest.mark.parametrize("n", [0.7, 1.5, 3.0])
@pytest.mark.parametrize("chi", [1e-6, 0.4, 30.0])
def test_the_largest_force_is_where_its_logarithm_turns(kernels, n, chi):
    with mpmath.workdps(40):
        a, left = mpmath.mpf(2 * n + 1) / (n + 1), mpmath.mpf(chi) - mpmath.log1p(chi)
        guess = min(float(left) * (n + 1) / n, chi)
        y = mpmath.findroot(lambda y: a * y - mpmath.log1p(y) - left, (guess / 2, guess))
    assert kernels.peak_rate(n, chi) == pytest.approx(float(y), rel=1e-14)


def by_steps(n, chi, K=3e6, m=0.2, v=5.0):
    """The motion by scipy's integrator: an interpolant of d and d', and its end where d falls through zero."""
    depth = (m * v * v / K) ** (1 / (n + 1))

    def out(t, y):
        return y[0] if t > 0 else 1.0

    out.terminal, out.direction = True, -1
    return solve_ivp(
        lambda t, y: [y[1], -K * max(y[0], 0.0) ** n * (1 + chi * y[1] / v) / m], (0.0, 60 * depth / v), [0.0, v],
        method="DOP853", events=out, rtol=1e-12, atol=[1e-14 * depth, 1e-13 * v], dense_output=True,
        max_step=depth / v / 20,
    )  # fmt: skip


@pytest.mark.parametrize(("n", "chi"), [(1.3, 0.6), (2.0, 3.0), (1.0, 0.05)])
def test_an_impact_its_moments_and_its_history_are_those_of_the_motion(kernels, n, chi):
    K, m, v = 3e6, 0.2, 5.0
    made = by_steps(n, chi)
    end, (last,) = made.t_events[0][0], made.y_events[0]
    e, deepest, force, duration = kernels.impact(K, n, chi, m, v)
    assert e == pytest.approx(-last[1] / v, rel=1e-9)
    assert duration == pytest.approx(end, rel=1e-9)
    peak, turned, released = kernels.moments(K, n, chi, m, v)
    assert released == pytest.approx(end, rel=1e-9)
    assert abs(made.sol(turned)[1]) < 1e-7 * v
    assert deepest == pytest.approx(made.sol(turned)[0], rel=1e-9)

    def pushed(t):
        d, rate = made.sol(t)
        return K * d**n * (1 + chi * rate / v)

    assert force == pytest.approx(pushed(peak), rel=1e-9)
    assert max(pushed(peak * 0.99), pushed(peak * 1.01)) < force
    times = end * np.array([0.0, 1e-3, 0.2, turned / end * 0.999, turned / end * 1.001, 0.8, 0.999])
    found = np.empty((3, 7))
    kernels.history(K, n, chi, m, v, times, found)
    expected = made.sol(times)
    assert found[0] == pytest.approx(expected[0], abs=1e-8 * deepest)
    assert found[1] == pytest.approx(expected[1], abs=1e-7 * v)
    assert found[2] == pytest.approx([pushed(t) if t else 0.0 for t in times], abs=1e-7 * force)
    beyond = np.empty((3, 1))
    kernels.history(K, n, chi, m, v, np.array([end * (1 + 1e-9)]), beyond)
    assert beyond[:, 0] == pytest.approx([0.0, -e * v, 0.0], abs=1e-6 * v)


@pytest.mark.parametrize("n", [1.0, 1.5, 2.5])
def test_an_elastic_impact_and_one_that_hardly_loses_are_alike_and_have_gamma_functions(kernels, n):
    q = 1 / (n + 1)
    depth = ((n + 1) * 0.2 * 25.0 / (2 * 3e6)) ** q
    lasts = 2 * math.sqrt(math.pi) * math.gamma(1 + q) / math.gamma(q + 0.5) * depth / 5.0
    for chi, error in ((0.0, 1e-14), (9e-10, 1e-14), (1.1e-9, 5e-9)):
        found = kernels.impact(3e6, n, chi, 0.2, 5.0)
        assert found == pytest.approx((1 - 2 * chi / 3, depth, 3e6 * depth**n, lasts), rel=error)
    peak, turned, end = kernels.moments(3e6, n, 0.0, 0.2, 5.0)
    assert (turned, end) == pytest.approx((lasts / 2, lasts), rel=4e-9)
    # a top is flat to the root of rounding
    assert peak == pytest.approx(lasts / 2, rel=1e-5)


@pytest.mark.parametrize("chi", [0.5, 6.0, 40.0])
@pytest.mark.parametrize("released", [False, True])
def test_a_place_is_where_the_integral_from_its_end_has_a_value(kernels, chi, released):
    """int G^(-n/(n+1)) from an end to w by quad in w^(1/(n+1)), in which it begins straight; and back to w."""
    n, span = 1.5, kernels.span_of_factor(chi)
    e, turn = kernels.restitution_of_span(span), math.log1p(chi)
    far = span - turn if released else turn

    def height(w):
        return kernels.from_end(chi, e, span, w) if released else kernels.from_begin(chi, w)

    for share in (1e-4, 0.3, 0.95):
        w = share * far
        root = w**0.4
        expected = quad(lambda z: height(z**2.5) ** -0.6 * 2.5 * z**1.5, 1e-9 * root, root, epsrel=1e-12, epsabs=0)[0]
        expected += 2.5 * (1e-9 * root) * (e * chi if released else chi) ** -0.6
        assert kernels.stretch_integral(n, chi, e, w, released) == pytest.approx(expected, rel=2e-10)
        assert kernels.distance_at(n, chi, e, expected, far, released) == pytest.approx(w, rel=1e-8)
    both = kernels.stretch_integral(n, chi, e, turn, False) + kernels.stretch_integral(n, chi, e, span - turn, True)
    # beyond a span of 12 the rule has more nodes
    assert kernels.duration_integral(n, chi, e, span) == pytest.approx(both, rel=1e-9)


def test_a_unit_of_time_and_several_impacts_each_of_its_own(kernels):
    """K -> k, m, v: t = v m/(chi K) C^-n with C^(n+1) = (n + 1) m v^2/(chi^2 K): 2 m v^2/(chi^2 K) = 4, C = 2 for n = 1."""
    assert kernels.time_unit(2.0, 1.0, 0.5, 1.0, 1.0) == pytest.approx(1.0 / 1.0 / 2.0, rel=1e-14)
    laws = [
        np.array(row) for row in ((3e6, 2e5, 1e4), (1.5, 1.0, 2.0), (0.4, 0.0, 3.0), (0.2, 3.0, 1.0), (5.0, 1.0, 0.3))
    ]
    out, times = np.empty((4, 3)), np.empty((2, 3))
    kernels.impacts(*laws, out)
    kernels.all_moments(*laws, times)
    for i, row in enumerate(zip(*laws, strict=True)):
        assert tuple(out[:, i]) == kernels.impact(*row)
        assert tuple(times[:, i]) == kernels.moments(*row)[:2]
    assert len({round(value, 9) for value in itertools.chain(*out[:3])}) == 9
