"""Dispersion of a round bar: the Pochhammer-Chree equation in Bessel functions, its table and its limits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize, special

from strikewave.waves import dispersion
from strikewave.waves.dispersion import THEORIES, Rod, group_speed, phase_speed, wave_number

TABLE = {
    0.1: (0.998428, 0.997891, 0.997744, 0.996941),
    0.2: (0.993331, 0.991129, 0.990535, 0.987324),
    0.3: (0.983366, 0.978261, 0.976912, 0.969789),
    0.5: (0.934792, 0.921753, 0.918537, 0.902771),
    1.0: (0.693443, 0.689272, 0.688138, 0.682034),
    2.0: (0.589324, 0.586069, 0.585240, 0.581009),
}
"""c/c0 over d/Lambda for nu = .25, .29, .30, .35, from an independent root finder, given to six digits."""
RATIOS = (0.25, 0.29, 0.30, 0.35)


def characteristic(omega, ka, nu):
    """The determinant as Graff 1975 (8.2) writes it, with scipy's Bessel functions and square roots."""
    alpha = np.sqrt(omega**2 * (1 + nu) * (1 - 2 * nu) / (1 - nu) - ka**2 + 0j)
    beta = np.sqrt(2 * (1 + nu) * omega**2 - ka**2 + 0j)
    j0, j1 = (lambda z: special.jv(0, z)), (lambda z: special.jv(1, z))
    terms = (
        2 * alpha * (beta**2 + ka**2) * j1(alpha) * j1(beta),
        -((beta**2 - ka**2) ** 2) * j0(alpha) * j1(beta),
        -4 * ka**2 * alpha * beta * j1(alpha) * j0(beta),
    )
    return sum(terms) / sum(abs(term) for term in terms)


def lowest_root(ka, nu):
    """c/c0 of the lowest branch at a wave number: the first change of sign from below, by a dense scan."""
    s = math.sqrt(2 * (1 + nu))

    def value(ratio):
        beta = np.sqrt(2 * (1 + nu) * ratio**2 - 1 + 0j) * ka
        return (characteristic(ratio * ka, ka, nu) / beta * abs(beta)).real

    ratios = np.linspace(0.6, 2.2, 1000) / s
    values = np.array([value(ratio) for ratio in ratios])
    k = int(np.flatnonzero(values[1:] * values[:-1] < 0)[0])
    return optimize.brentq(value, ratios[k], ratios[k + 1], xtol=1e-13)


def test_pochhammer_chree_table():
    """To half a unit of its sixth digit."""
    for ratio, row in TABLE.items():
        for nu, published in zip(RATIOS, row, strict=True):
            assert float(phase_speed(ratio, nu)) == pytest.approx(published, abs=5.1e-7)


@pytest.mark.parametrize("nu", [-0.5, -0.1, 0.1, 0.25, 0.33, 0.45, 0.499])
@pytest.mark.parametrize("ka", [0.05, 0.7, 1.6, 3.0, 8.0])
def test_the_followed_root_is_the_lowest_one(nu, ka):
    assert float(phase_speed(ka / math.pi, nu)) == pytest.approx(lowest_root(ka, nu), rel=1e-10)


@pytest.mark.parametrize("nu", [0.05, 0.1, 0.29, 0.5, -0.7])
def test_the_root_solves_the_equation_of_graff(nu):
    """Also at complex frequencies; the determinant is scaled by the sum of its terms' magnitudes."""
    omega = np.concatenate([np.linspace(0.01, 12.0, 60) - 0.05j, np.linspace(0.01, 5.0, 20) * (1 - 0.1j)])
    k = wave_number(omega, Rod(1.0, 1.0, nu))
    assert np.abs(characteristic(omega, k, nu)).max() < 1e-11
    assert np.all(k.imag < 0.0)


def test_rayleigh_limit_of_long_waves():
    """c/c0 = 1 - (pi nu a/Lambda)^2: the rest is of fourth order."""
    rest = []
    for ratio in (0.02, 0.01):
        rayleigh = 1.0 - (math.pi * 0.29 * ratio / 2.0) ** 2
        rest.append(abs(float(phase_speed(ratio, 0.29)) - rayleigh))
    assert rest[0] < 1e-6
    assert math.log2(rest[0] / rest[1]) == pytest.approx(4.0, abs=0.05)


@pytest.mark.parametrize("nu", [0.1, 0.25, 0.35, 0.5])
def test_rayleigh_limit_of_short_waves(nu):
    """The root of (2 - x)^2 = 4 sqrt(1 - x) sqrt(1 - x k), x = (cR/c2)^2: the surface wave; the curvature falls off as 1/k."""
    k = (1 - 2 * nu) / (2 * (1 - nu))
    x = optimize.brentq(lambda x: (2 - x) ** 2 - 4 * math.sqrt(1 - x) * math.sqrt(1 - x * k), 0.5, 0.999)
    surface = math.sqrt(x / (2 * (1 + nu)))
    far = [abs(float(phase_speed(ratio, nu)) / surface - 1.0) for ratio in (50.0, 100.0)]
    assert far[1] < 1e-3
    assert far[0] / far[1] == pytest.approx(2.0, rel=0.1)


def test_love_rayleigh_agrees_with_rayleigh_and_is_close_for_long_waves():
    rod = Rod(0.01, 5000.0, 0.29)
    k = 2 * math.pi / 0.2 * np.array([1.0, 2.0, 3.0])  # d/Lambda 0.1, 0.2, 0.3
    w = 5000.0 * k / np.sqrt(1 + 0.5 * (0.29 * 0.01 * k) ** 2)
    assert wave_number(w, rod, "love-rayleigh") == pytest.approx(k, rel=1e-12)
    assert w / k / 5000.0 == pytest.approx(phase_speed([0.1, 0.2, 0.3], 0.29), rel=4e-3)


def test_love_rayleigh_waves_die_above_their_limit():
    rod = Rod(0.01, 5000.0, 0.29)
    limit = math.sqrt(2) * 5000.0 / (0.29 * 0.01)
    k = wave_number([-1.5 * limit, 1.5 * limit], rod, "love-rayleigh")
    assert k.real == pytest.approx(0.0, abs=1e-9 * abs(k[0]))
    assert np.all(k.imag < 0.0)


def test_group_speed_is_the_slope_of_the_branch():
    """Central differences, second order in the step: 1e-6 at a step of 1e-3."""
    rod = Rod(1.0, 1.0, 0.29)
    w = np.linspace(0.2, 6.0, 30)
    slope = 2e-3 / (wave_number(w + 1e-3, rod) - wave_number(w - 1e-3, rod)).real
    assert group_speed(w, rod) == pytest.approx(slope, rel=2e-5)


@given(st.floats(-0.9, 0.5), st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=8), st.sampled_from(THEORIES))
def test_wave_numbers_are_odd_in_frequency_and_in_any_order(nu, frequencies, theory):
    w = np.array(frequencies) - 0.05j
    k = wave_number(w, Rod(1.0, 1.0, nu), theory)
    assert wave_number(-np.conj(w), Rod(1.0, 1.0, nu), theory) == pytest.approx(-np.conj(k), rel=1e-9, abs=1e-12)
    assert wave_number(w[::-1], Rod(1.0, 1.0, nu), theory)[::-1] == pytest.approx(k, rel=1e-7, abs=1e-12)


def test_no_dispersion_without_poissons_ratio():
    w = np.linspace(0.0, 1e6, 5)
    assert np.array_equal(wave_number(w, Rod(0.01, 5000.0, 0.0)).real, w / 5000.0)
    assert np.array_equal(wave_number(w, Rod(0.01, 5000.0, 0.3), "none").real, w / 5000.0)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: wave_number(1.0, Rod(1.0, 1.0, 0.3), "pochhammer"), "pochhammer-chree"),
        (lambda: wave_number(1.0, Rod(0.0, 1.0, 0.3)), "radius"),
        (lambda: wave_number(math.nan, Rod(1.0, 1.0, 0.3)), "finite"),
        (lambda: wave_number(1.0, Rod(1.0, 1.0, 0.51)), "0.5"),
        (lambda: phase_speed(-0.1, 0.3), "zero or above"),
        (lambda: phase_speed(0.1, -1.0), "-1"),
    ],
)
def test_what_makes_no_sense_is_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()


@pytest.mark.parametrize("omega", [1e3, 1e4 - 5j])
def test_very_short_waves_are_surface_waves(omega):
    """At a thousand and ten thousand radii per wave the curvature no longer counts: 1/(4 k a) at most of the speed."""
    nu = 0.29
    k = (1 - 2 * nu) / (2 * (1 - nu))
    x = optimize.brentq(lambda x: (2 - x) ** 2 - 4 * math.sqrt(1 - x) * math.sqrt(1 - x * k), 0.5, 0.999)
    speed = omega / wave_number(omega, Rod(1.0, 1.0, nu))
    assert abs(speed / math.sqrt(x / (2 * (1 + nu))) - 1.0) < 0.25 / min(abs(omega), 2000.0)


def test_a_bar_of_ten_metres_at_megahertz_is_followed_in_no_time():
    """A diameter typed in the wrong unit: 30 000 radii a wave."""
    k = wave_number(np.linspace(0.0, 2e7, 5000) - 10j, Rod(5.0, 5000.0, 0.29))
    assert np.all(np.isfinite(k))


@pytest.mark.parametrize("nu", [0.03, 0.08, -0.05, 0.49])
def test_a_far_frequency_alone_is_reached_on_the_lowest_branch(nu):
    """At 3 and 30 radii a wave from rest, where two modes nearly touch on the way: the wave that its wavelength has too."""
    for omega in (3.0, 30.0):
        k = wave_number(omega, Rod(1.0, 1.0, nu))
        assert k.imag == 0.0
        assert float(phase_speed(k.real / math.pi, nu)) == pytest.approx(omega / k.real, rel=1e-9)
    k = wave_number(3.0, Rod(1.0, 1.0, nu)).real
    assert 3.0 / k == pytest.approx(lowest_root(k, nu), rel=1e-9)
    both = wave_number([30.0, 3.0], Rod(1.0, 1.0, nu))
    assert both.real == pytest.approx([float(wave_number(w, Rod(1.0, 1.0, nu)).real) for w in (30.0, 3.0)], rel=1e-12)


def test_radius_and_bar_speed_set_the_scale_of_a_wave():
    """A bar three times as thick and half as fast at a sixth of the frequency: a third of the wave number, half the speed."""
    thin, thick = Rod(0.01, 5000.0, 0.29), Rod(0.03, 2500.0, 0.29)
    w = np.array([[3e5, 9e5], [1.2e6, -2e6]])
    for theory in THEORIES:
        assert wave_number(w / 6.0, thick, theory) == pytest.approx(wave_number(w, thin, theory) / 3.0, rel=1e-12)
    assert group_speed(w / 6.0, thick) == pytest.approx(0.5 * group_speed(w, thin), rel=1e-9)
    assert group_speed(0.0, thick) == pytest.approx(2500.0, rel=1e-14)
    assert group_speed(w[1], thin)[1] == pytest.approx(float(group_speed(2e6, thin)), rel=1e-9)


@pytest.mark.parametrize("theory", THEORIES)
def test_a_bar_that_loses_energy_is_one_of_a_complex_speed(theory):
    """G = i k: with c0 (1 + i d)^(1/2) the wave number is that of a bar as much faster at a frequency as much lower."""
    rod, c = Rod(0.01, 5000.0, 0.29), 5000.0 * np.sqrt(1.0 + 0.1j)
    w = 4e5 - 2e3j
    found = wave_number(w, rod, theory, c)
    # k a is a function of w a/c0 alone
    assert found == pytest.approx(wave_number(w * 5000.0 / c, rod, theory), rel=1e-10)
    assert found.imag < 0.0


def test_beyond_the_shortest_wave_the_speed_stays(monkeypatch):
    """W a/c0 of 2000 at most is followed, in the order of frequencies, with mirrored ones; signs and places come back."""
    followed = []

    def follow(omega, s, r):
        followed.append((omega.tolist(), s, r))
        return omega.astype(complex) / 1e3, omega

    monkeypatch.setattr(dispersion, "follow_frequency", follow)
    w = np.array([[4001.0, -300.0], [100.0 - 20.0j, 9e6]])
    found = wave_number(w, Rod(2.0, 4.0, 0.25))
    assert followed[0][0] == pytest.approx([50.0 - 10.0j, 150.0, 2000.0, 2000.0], rel=1e-14)
    assert followed[0][1:] == pytest.approx((2.5, 1.25 * 0.5 / 0.75), rel=1e-14)
    ratio = np.array([[2.0, 0.15], [0.05 - 0.01j, 2.0]])
    assert found == pytest.approx(w / 4.0 * np.sqrt(ratio), rel=1e-12)
    wave_number(-50.0 - 7.0j, Rod(2.0, 4.0, 0.25))
    assert followed[1][0] == pytest.approx([25.0 - 3.5j], rel=1e-14)


@pytest.mark.parametrize("theory", THEORIES)
def test_small_rods_of_small_ratios_are_taken_and_others_refused(theory):
    wave_number(1.0, Rod(1e-3, 1e-3, 1e-3), theory)
    wave_number(1.0, Rod(1e-3, 1e-3, -0.99), theory)
    for rod in (
        Rod(1.0, 0.0, 0.3),
        Rod(-1.0, 1.0, 0.3),
        Rod(math.inf, 1.0, 0.3),
        Rod(1.0, math.inf, 0.3),
        Rod(1.0, 1.0, -1.0),
    ):
        with pytest.raises(ValueError, match=r"radius and bar speed|ratio lies above -1"):
            wave_number(1.0, rod, theory)
    for bad in ([1.0, math.nan], [math.inf, 1.0]):
        with pytest.raises(ValueError, match="finite"):
            wave_number(bad, Rod(1.0, 1.0, 0.3), theory)


@pytest.mark.parametrize("bad", [[0.1, -0.1], [0.1, math.nan], [math.inf, 0.1]])
def test_one_wavelength_that_cannot_be_refuses_all(bad):
    with pytest.raises(ValueError, match="zero or above"):
        phase_speed(bad, 0.3)


def test_wavelengths_may_come_in_any_order_and_shape():
    ratios = np.array([[0.5, 0.1], [0.0, 0.3]])
    found = phase_speed(ratios, 0.29)
    assert found[1, 0] == 1.0
    assert found.ravel() == pytest.approx([TABLE[0.5][1], TABLE[0.1][1], 1.0, TABLE[0.3][1]], abs=5.1e-7)


def test_frequencies_may_lie_as_close_as_they_like():
    """K of four frequencies a billionth apart, and of the same one twice: a straight line of the slope 1/c_g."""
    rod, w = Rod(1.0, 1.0, 0.29), 3.0 + 1e-9 * np.array([0.0, 1.0, 1.0, 2.0, 5.0])
    k = wave_number(w, rod).real
    assert k == pytest.approx(k[0] + (w - 3.0) / float(group_speed(3.0, rod)), rel=1e-13)
