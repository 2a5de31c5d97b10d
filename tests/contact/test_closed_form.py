"""The closed form of one impact against 30-digit values, published test spheres and independent quadrature."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from strikewave.contact import Contact, exact, li_ma_printed, reduced_mass, restitution, solve_impact
from strikewave.contact._kernels import _double_exponential


def span_to_thirty_digits(e):
    """L = chi (1 + e) from its definition, independently of the kernel: bisection at 40 digits."""
    with mpmath.workdps(45):
        asked = mpmath.mpf(e)
        low, high = mpmath.mpf("1e-12"), 10 + 2 / asked
        for _ in range(220):
            middle = (low + high) / 2
            decay = mpmath.exp(-middle)
            value = (1 - decay * (1 + middle)) / (middle - 1 + decay)
            low, high = (middle, high) if value > asked else (low, middle)
        return (low + high) / 2


@pytest.mark.parametrize("e", [0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999])
def test_exact_factor_against_thirty_digits(e):
    chi = span_to_thirty_digits(e) / (1 + mpmath.mpf(e))
    # a few rounding errors of a double
    assert float(exact(e)) == pytest.approx(float(chi), rel=2e-15)


@given(st.floats(0.001, 1.0))
def test_factor_and_restitution_are_inverse(e):
    assert float(restitution(exact(e))) == pytest.approx(e, rel=1e-14)


def test_factor_solves_the_printed_equation_of_the_phase_plane():
    # ln(1 + chi) - ln(1 - e chi) = chi (1 + e), the exit condition of F = K d^n (1 + chi d'/v0)
    # (below e = 0.2 the difference 1 - e chi loses the digits that the comparison needs)
    for e in (0.2, 0.5, 0.8, 0.95):
        chi = float(exact(e))
        assert math.log1p(chi) - math.log1p(-e * chi) == pytest.approx(chi * (1 + e), rel=1e-12)


@pytest.mark.parametrize(
    ("asked", "given_"), [(0.1, 0.0704), (0.3, 0.2591), (0.5, 0.4740), (0.7, 0.6861), (0.9, 0.8952)]
)
def test_li_ma_eq_24_misses_the_restitution_asked_for(asked, given_):
    assert float(restitution(li_ma_printed(asked))) == pytest.approx(given_, abs=5e-5)


def test_li_ma_eq_15_is_a_beta_function_and_not_three_tenths():
    exact_integral, _ = quad(lambda x: x ** (10 / 9) * math.sqrt(1 - x * x), 0, 1)
    assert exact_integral == pytest.approx(0.31098148596, abs=1e-10)
    # eq (24) follows from 3/10; the exact integral gives 1.523191 (1 - e)/e instead of 30/19
    assert 9 / 19 / exact_integral == pytest.approx(1.523191, abs=5e-7)
    assert float(li_ma_printed(0.5)) == pytest.approx(9 / 19 / 0.3, rel=1e-15)


def test_glass_and_limestone_spheres():
    """Elastic normal impact of two equal spheres, r 10 mm, each at 10 m/s: the Hertz solution of these materials.

    Materials of tests 1 and 2 of Chung & Ooi 2011 (Granular Matter 13, 643), computed with 30 digits.
    """
    for modulus, nu, density, depth, force, duration in (
        (48e9, 0.20, 2800.0, 274.11e-6, 10696.9, 40.339e-6),
        (20e9, 0.25, 2500.0, 368.30e-6, 7108.2, 54.201e-6),
    ):
        mass = density * 4 / 3 * math.pi * 0.01**3
        stiffness = 4 / 3 * modulus / (2 * (1 - nu**2)) * math.sqrt(0.005)
        blow = solve_impact(Contact(stiffness, 1.5), mass, mass, 20.0)
        # the printed digits
        assert float(blow.max_indentation) == pytest.approx(depth, rel=2e-5)
        assert float(blow.peak_force) == pytest.approx(force, rel=1e-5)
        assert float(blow.duration) == pytest.approx(duration, rel=2e-5)


def test_steel_sphere_on_half_space():
    mass = 7820 * 4 / 3 * math.pi * 0.01**3
    stiffness = 4 / 3 * 211e9 / (2 * (1 - 0.288**2)) * math.sqrt(0.01)
    assert stiffness == pytest.approx(1.53389e10, rel=1e-5)
    blow = solve_impact(Contact(stiffness, 1.5, exact(0.7)), mass, np.inf, 1.0)
    assert float(blow.max_indentation) == pytest.approx(20.480e-6, rel=3e-5)
    assert float(blow.duration) == pytest.approx(72.434e-6, rel=1e-5)
    assert float(blow.restitution) == pytest.approx(0.7, rel=1e-14)


@pytest.mark.parametrize(("exponent", "kappa"), [(10 / 9, 3.090488), (1.5, 2.943275)])
def test_elastic_duration_is_kappa_times_indentation_over_speed(exponent, kappa):
    blow = solve_impact(Contact(1e9, exponent), 1.0, np.inf, 2.0)
    computed = float(blow.duration * 2.0 / blow.max_indentation)
    assert computed == pytest.approx(kappa, abs=5e-7)
    # independent: 2 * integral of dx / sqrt(1 - x^(n+1)) with x = 1 - s^2
    independent, _ = quad(lambda s: 4 * s / math.sqrt(-math.expm1((exponent + 1) * math.log1p(-s * s))), 0, 1)
    assert computed == pytest.approx(independent, rel=1e-9)


def independent_duration(n, chi):
    """The duration in units of v0 m/(chi K) C^-n: time integral over y = chi d'/v0, by mpmath's own quadrature."""
    with mpmath.workdps(60):
        n, chi = mpmath.mpf(n), mpmath.mpf(chi)
        start = -1 - chi
        parting = mpmath.lambertw(start * mpmath.exp(start), 0).real  # y_e = e-chi root: 1 + y_e = -W0(...)
        span = mpmath.log(1 + chi) - mpmath.log(-parting)
        late = (1 + chi) * mpmath.exp(-span)
        power, p = -n / (n + 1), n + 1

        def first(z):
            w = z**p
            return (chi * -mpmath.expm1(-w) - (mpmath.expm1(-w) + w)) ** power * p * z ** (p - 1)

        def last(z):
            w = z**p
            return (w * (1 - late) - late * (mpmath.expm1(w) - w)) ** power * p * z ** (p - 1)

        middle, tiny = (span / 2) ** (1 / p), mpmath.mpf("1e-12")
        ends = tiny * p * (chi**power + (1 - late) ** power)
        cuts = [tiny, middle / 8, middle / 2, middle]
        return float(mpmath.quad(first, cuts) + mpmath.quad(last, cuts) + ends)


@pytest.mark.verify
@pytest.mark.parametrize("n", [1.0, 1.094, 10 / 9, 1.5, 2.0])
@pytest.mark.parametrize("e", [0.001, 0.1, 0.5, 0.99])
def test_duration_against_independent_quadrature(n, e):
    mass, stiffness, speed = 0.139, 4.7e9, 20.0
    chi = float(exact(e))
    depth = ((n + 1) * mass * speed**2 / (chi**2 * stiffness)) ** (1 / (n + 1))
    expected = speed * mass / (chi * stiffness) * depth**-n * independent_duration(n, chi)
    blow = solve_impact(Contact(stiffness, n, chi), mass, np.inf, speed)
    # the rule's stated error: 2e-11, and 1e-10 where e < 0.08
    assert float(blow.duration) == pytest.approx(expected, rel=1e-10)


@given(
    n=st.floats(1.0, 2.0),
    e=st.floats(0.01, 1.0),
    mass=st.floats(1e-6, 1e3),
    stiffness=st.floats(1e3, 1e14),
    speed=st.floats(1e-3, 1e3),
)
def test_largest_force_and_indentation_satisfy_the_law(n, e, mass, stiffness, speed):
    """Energy at the largest indentation, found by quadrature of v dv/dd along the phase plane."""
    chi = float(exact(e))
    blow = solve_impact(Contact(stiffness, n, chi), mass, np.inf, speed)
    # integral of y/(1 + y) from 0 to chi equals K d^(n+1) chi^2 / ((n+1) m v0^2)
    area, _ = quad(lambda y: y / (1 + y), 0, chi) if chi > 0 else (0.0, 0.0)
    scale = area / chi**2 if chi > 1e-6 else 0.5
    depth = ((n + 1) * mass * speed**2 / stiffness * scale) ** (1 / (n + 1))
    assert float(blow.max_indentation) == pytest.approx(depth, rel=1e-6)
    assert float(blow.peak_force) >= stiffness * float(blow.max_indentation) ** n * (1 - 1e-12)
    assert float(blow.energy_lost) == pytest.approx(0.5 * mass * speed**2 * (1 - e**2), rel=1e-9, abs=1e-300)


def test_paper_law_on_a_rigid_object_is_seven_times_too_short():
    """0.2 kg at an assumed 20 m/s on 0.459 kg: 28 to 30 us and 3.25e5 N, where the paper has 220 us and 19 685 N."""
    from strikewave.base.constants import material
    from strikewave.contact import palmgren

    steel = material("65Mn")
    law = palmgren(steel, steel, 0.04)
    assert law.stiffness == pytest.approx(4.68e9, rel=2e-3)
    assert float(reduced_mass(0.2, 0.459)) == pytest.approx(0.139, abs=5e-4)
    elastic = solve_impact(Contact(law.stiffness, law.exponent), 0.2, 0.459, 20.0)
    lossy = solve_impact(Contact(law.stiffness, law.exponent, exact(0.5)), 0.2, 0.459, 20.0)
    assert float(elastic.duration) * 1e6 == pytest.approx(28, abs=0.5)
    assert float(lossy.duration) * 1e6 == pytest.approx(30, abs=0.5)
    assert float(elastic.peak_force) == pytest.approx(3.25e5, rel=5e-3)
    assert float(lossy.peak_force) == pytest.approx(3.25e5, rel=5e-3)


@pytest.mark.parametrize(("mass", "stiffness", "speed"), [(0.459, 2.46e8, 2.9), (0.139279, 6.5e7, 9.5)])
def test_stiffness_that_the_measured_pulse_would_need(mass, stiffness, speed):
    """The paper's 19 685 N and 220 us need K = 2.46e8 at 2.9 m/s, or 6.5e7 at 9.5 m/s (printed digits)."""
    blow = solve_impact(Contact(stiffness, 10 / 9), mass, np.inf, speed)
    assert float(blow.peak_force) == pytest.approx(19685, rel=0.02)
    assert float(blow.duration) == pytest.approx(220e-6, rel=0.02)


def test_arrays_broadcast():
    blow = solve_impact(Contact(1e9, 1.5, exact(np.array([0.3, 0.6, 0.9]))), np.array([[0.1], [0.2]]), 1.0, 5.0)
    assert blow.peak_force.shape == (2, 3)
    single = solve_impact(Contact(1e9, 1.5, exact(0.6)), 0.2, 1.0, 5.0)
    assert blow.peak_force[1, 1] == single.peak_force


def test_elastic_limit_is_continuous():
    near = solve_impact(Contact(1e9, 1.3, 2e-9), 1.0, 1.0, 1.0)
    limit = solve_impact(Contact(1e9, 1.3, 0.0), 1.0, 1.0, 1.0)
    for name in ("max_indentation", "peak_force", "duration"):
        assert float(getattr(near, name)) == pytest.approx(float(getattr(limit, name)), rel=1e-8)


def test_very_plastic_limit_stays_finite():
    # chi = 1e5: e about 1e-5; the Lambert functions of the textbook form overflow long before
    blow = solve_impact(Contact(1e9, 1.5, 1e5), 1.0, np.inf, 1.0)
    assert float(blow.restitution) == pytest.approx(1e-5, rel=1e-3)
    assert np.isfinite(float(blow.peak_force))
    assert np.isfinite(float(blow.duration))


@pytest.mark.parametrize(
    ("contact", "m1", "m2", "speed"),
    [
        (Contact(-1.0, 1.5), 1, 1, 1),
        (Contact(1e9, 0.0), 1, 1, 1),
        (Contact(1e9, 1.5, -0.1), 1, 1, 1),
        (Contact(1e9, 1.5), 0, 1, 1),
        (Contact(1e9, 1.5), np.inf, np.inf, 1),
        (Contact(1e9, 1.5), 1, 1, 0),
        (Contact(np.nan, 1.5), 1, 1, 1),
    ],
)
def test_impossible_impacts_are_refused(contact, m1, m2, speed):
    with pytest.raises(ValueError, match=r"must|within"):
        solve_impact(contact, m1, m2, speed)


@pytest.mark.parametrize("e", [0.0, -0.1, 1.01, np.nan])
def test_impossible_restitutions_are_refused(e):
    with pytest.raises(ValueError, match="0 < e <= 1"):
        exact(e)


@pytest.mark.parametrize(("n", "error"), [(0.1, 1e-9), (0.5, 1e-9), (3.0, 4e-9), (5.0, 1e-6), (10.0, 1e-4)])
def test_next_to_elastic_a_contact_of_any_exponent_is_symmetric_and_lasts_as_gamma_functions_say(n, error):
    """T = 2 sqrt(pi) G(1 + 1/(n+1))/G(1/(n+1) + 1/2) d/v; the ends of the rule, in closed form, grow with the exponent."""
    blow = solve_impact(Contact(1e9, n, 2e-9), 1.0, np.inf, 0.5)
    q = 1 / (n + 1)
    depth = ((n + 1) * 0.125 / 1e9) ** q
    lasts = 2 * math.sqrt(math.pi) * math.gamma(1 + q) / math.gamma(q + 0.5) * depth / 0.5
    # chi moves the moments by as much, and what the rule leaves of the ends is measured
    assert float(blow.duration) == pytest.approx(lasts, rel=error)
    assert float(blow.turning_time) == pytest.approx(lasts / 2, rel=error)
    assert float(blow.peak_time) == pytest.approx(lasts / 2, rel=max(error, 2e-8))


@pytest.mark.parametrize(
    ("n", "e", "lasts", "error"),
    [
        (1.0, 0.5, 3.285325452938822, 2e-11),
        (1.5, 0.5, 3.6035605840461358, 2e-11),
        (2.0, 0.1, 7.519804996862562, 2e-11),
        (1.5, 0.02, 15.448082540041721, 1e-10),
        (3.0, 0.3, 4.818199866588878, 4e-9),
        (6.0, 0.6, 3.4939828342973613, 5e-6),
    ],
)
def test_durations_by_mpmath(n, e, lasts, error):
    """`independent_duration` with K = m = v0 = 1; the error of the rule, which grows beyond n = 2."""
    blow = solve_impact(Contact(1.0, n, exact(e)), 1.0, np.inf, 1.0)
    assert float(blow.duration) == pytest.approx(lasts, rel=error)
    # K -> k, m, v: T = (m v^(1-n)/K)^(1/(n+1)) T(1, 1, 1)
    other = solve_impact(Contact(3e6, n, exact(e)), 0.2, np.inf, 5.0)
    assert float(other.duration) == pytest.approx(lasts * (0.2 * 5.0 ** (1 - n) / 3e6) ** (1 / (n + 1)), rel=error)


def test_double_exponential_rule_integrates_roots_at_both_ends():
    """Takahasi & Mori 1974: int x^(-1/2) dx = 2 and int 1 dx = 1 over 0 to 1, the tail in closed form 2 sqrt(tail)."""
    for nodes in (40, 72):
        near, weight, tail = _double_exponential(nodes)
        assert weight.sum() == pytest.approx(1.0, rel=1e-14)
        assert near == pytest.approx(near[::-1], rel=1e-12)
        first = (
            weight[: nodes // 2] @ near[: nodes // 2] ** -0.5 + weight[nodes // 2 :] @ (1 - near[nodes // 2 :]) ** -0.5
        )
        assert first == pytest.approx(2.0, rel=1e-12)
        # the ends lie half a step beyond the last node: x^(-0.99), of which they are half
        rest = 100.0 * tail**0.01
        powers = weight[: nodes // 2] @ near[: nodes // 2] ** -0.99 + weight[nodes // 2 :] @ (
            (1 - near[nodes // 2 :]) ** -0.99
        )
        assert powers + rest == pytest.approx(100.0, rel=2e-2)
