"""`solve_impact` and its histories: integrator against closed form, energy, arrays, limits and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import betainc

from strikewave.base.errors import IntegrationError
from strikewave.contact import (
    Chain,
    ChainContact,
    Contact,
    Damper,
    LogarithmicContact,
    PressureCap,
    exact,
    impact_history,
    restitution,
    simulate,
    solve_impact,
)
from strikewave.waves import Impactor, Layer, Stack, Tap, WantedError, run_bar

NUMBERS = ("restitution", "max_indentation", "peak_force", "duration", "energy_lost", "peak_time", "turning_time")


def by_steps(contact):
    """The same law with a cap that is never reached, which the closed form does not cover."""
    return Contact(contact.stiffness, contact.exponent, contact.hysteresis_factor, cap=PressureCap(1e30, "point"))


@settings(max_examples=60)
@given(
    n=st.floats(1.0, 2.0),
    e=st.floats(0.05, 1.0),
    mass=st.floats(1e-3, 1e2),
    stiffness=st.floats(1e6, 1e12),
    speed=st.floats(1e-2, 1e2),
)
@example(n=1.890625, e=1.0, mass=1.0, stiffness=1e6, speed=1.0)  # the peak lies in the last hundredth of a step
def test_integrator_meets_the_closed_form(n, e, mass, stiffness, speed):
    """1e-7 at a tolerance of 1e-8: restitution, indentation, force, duration; times of flat tops to the root of that."""
    contact = Contact(stiffness, n, exact(e))
    closed, stepped = solve_impact(contact, mass, np.inf, speed), solve_impact(by_steps(contact), mass, np.inf, speed)
    assert (closed.method, stepped.method) == ("closed form", "integrator")
    for name in NUMBERS:
        tolerance = {"energy_lost": 2e-7, "peak_time": 3e-4, "turning_time": 1e-6}.get(name, 1e-7)
        scale = 0.5 * mass * speed**2 if name == "energy_lost" else float(getattr(closed, name))
        assert float(getattr(stepped, name)) == pytest.approx(float(getattr(closed, name)), abs=tolerance * scale), name


@pytest.mark.parametrize("n", [1.0, 1.094, 10 / 9, 1.5, 2.0])
@pytest.mark.parametrize("e", [0.001, 0.05, 0.5, 0.9, 0.999, 1.0])
def test_history_keeps_energy_and_momentum_to_1e_9(n, e):
    """Work of the force between any two moments is the change of kinetic energy; its impulse that of momentum."""
    mass, speed = 0.139, 20.0
    blow = solve_impact(Contact(4.7e9, n, exact(e)), mass, np.inf, speed)
    turn, end = float(blow.turning_time), float(blow.duration)
    # Gauss-Legendre in s = (t/turn)^(1/3) and the like: the force begins as t^n and, for small e, ends slowly
    nodes, weights = np.polynomial.legendre.leggauss(60)
    for begin, stop in ((0.0, turn), (turn, end)):
        s = 0.5 * (nodes + 1.0)
        share = s**3 if begin == 0.0 else 1.0 - (1.0 - s) ** 3
        slope = 3 * s**2 if begin == 0.0 else 3 * (1.0 - s) ** 2
        t = begin + (stop - begin) * share
        h = impact_history(blow, t)
        impulse = float(np.sum(0.5 * weights * slope * (stop - begin) * h.force))
        work = float(np.sum(0.5 * weights * slope * (stop - begin) * h.force * h.rate))
        v = speed if begin == 0.0 else float(blow.restitution) * speed
        if e < 0.05 and begin > 0.0:
            continue  # the force is gone long before the release: sampled in the next test
        assert impulse == pytest.approx(mass * v, rel=1e-9)
        assert abs(work) == pytest.approx(0.5 * mass * v**2, rel=1e-9)
    assert float(blow.energy_lost) == pytest.approx(0.5 * mass * speed**2 * (1 - e) * (1 + e), rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("e", [0.001, 0.003, 0.02])
def test_very_lossy_history_is_finite_and_ends_where_it_should(e):
    blow = solve_impact(Contact(4.7e9, 1.5, exact(e)), 0.1, np.inf, 5.0)
    h = impact_history(blow)
    for row in (h.indentation, h.rate, h.force):
        assert np.all(np.isfinite(row))
    assert h.rate[0] == pytest.approx(5.0, rel=1e-12)
    assert h.rate[-1] == pytest.approx(-5.0 * e, rel=1e-9)
    assert h.indentation[-1] == pytest.approx(0.0, abs=1e-9 * float(blow.max_indentation))
    assert h.force.min() >= 0.0


@pytest.mark.parametrize("n", [1.0, 10 / 9, 1.5, 2.0])
def test_elastic_history_is_an_incomplete_beta_function(n):
    """x = (d/d_max)^(n+1): t = turn I(x; 1/(n+1), 1/2), v = v0 sqrt(1 - x)."""
    blow = solve_impact(Contact(1e9, n), 0.3, np.inf, 2.0)
    h = impact_history(blow, np.linspace(0.0, float(blow.turning_time), 60))
    x = np.minimum((h.indentation / float(blow.max_indentation)) ** (n + 1), 1.0)
    assert betainc(1 / (n + 1), 0.5, x) == pytest.approx(h.time / float(blow.turning_time), abs=1e-6)
    # sqrt(1 - x) has half the digits at the top
    assert h.rate == pytest.approx(2.0 * np.sqrt(1 - x), abs=4e-6)
    # away from the top, where the inverse of the beta function loses half the digits
    early = x < 0.9
    assert betainc(1 / (n + 1), 0.5, x[early]) == pytest.approx(h.time[early] / float(blow.turning_time), rel=1e-9)


@given(n=st.floats(1.0, 2.0), e=st.floats(0.05, 0.999))
def test_peak_of_the_history_is_the_peak_force_at_its_time(n, e):
    blow = solve_impact(Contact(2e9, n, exact(e)), 0.2, 0.5, 7.0)
    at = float(blow.peak_time)
    step = 1e-3 * float(blow.duration)
    h = impact_history(blow, [max(at - step, 0.0), at, at + step])
    assert h.force[1] == pytest.approx(float(blow.peak_force), rel=1e-10)
    assert h.force[1] >= max(h.force[0], h.force[2])
    turn = impact_history(blow, [float(blow.turning_time)])
    assert turn.rate[0] == pytest.approx(0.0, abs=1e-7)
    assert turn.indentation[0] == pytest.approx(float(blow.max_indentation), rel=1e-10)


@pytest.mark.parametrize("e", [0.2, 0.6, 1.0])
def test_restitution_of_a_logarithmic_law_is_that_of_its_factor(e):
    """The phase plane separates for every elastic force, so chi alone decides: the integrator to 1e-7."""
    blow = solve_impact(LogarithmicContact(1.4e10, 6e8, exact(e)), 0.2, np.inf, 3.0)
    assert float(blow.restitution) == pytest.approx(e, rel=2e-7)


def test_logarithmic_law_stores_what_its_area_says():
    """Elastic: m v0^2/2 = int_0^D F dd with d = (F/G) ln(B/F), by quadrature over F."""
    slope, load, mass, speed = 1.4e10, 6e8, 0.2, 3.0
    blow = solve_impact(LogarithmicContact(slope, load), mass, np.inf, speed)
    force = float(blow.peak_force)
    area, _ = quad(lambda f: f / slope * (math.log(load / f) - 1.0), 0.0, force)
    assert area == pytest.approx(0.5 * mass * speed**2, rel=1e-7)
    assert float(blow.max_indentation) == pytest.approx(force / slope * math.log(load / force), rel=1e-7)


def test_logarithmic_law_beyond_its_end_is_refused_in_words():
    with pytest.raises(IntegrationError, match=r"index 1 presses .* beyond the end of the logarithmic law"):
        solve_impact(LogarithmicContact(1e10, 1e5), 1.0, np.inf, [0.01, 100.0])


@pytest.mark.verify
def test_a_million_impacts_in_one_call():
    speeds = np.linspace(0.1, 50.0, 1_000_000)
    blow = solve_impact(Contact(1e9, 1.5, exact(0.6)), 0.2, 0.5, speeds)
    assert blow.peak_force.shape == (1_000_000,)
    assert np.ptp(blow.restitution) == 0.0
    # F ~ v^(2n/(n+1)), T ~ v^-((n-1)/(n+1)): dimensions
    assert blow.peak_force[-1] / blow.peak_force[0] == pytest.approx(500 ** (3 / 2.5), rel=1e-12)
    assert blow.duration[-1] / blow.duration[0] == pytest.approx(500 ** (-0.5 / 2.5), rel=1e-12)


def test_arrays_of_plastic_impacts_broadcast():
    contact = Contact(1.5e10, 1.5, cap=PressureCap(np.array([[300.0], [600.0]]), "point"))
    blow = solve_impact(contact, 0.03, np.inf, np.array([0.5, 1.0, 2.0]))
    assert blow.restitution.shape == blow.peak_time.shape == blow.flattening.shape == (2, 3)
    single = solve_impact(Contact(1.5e10, 1.5, cap=PressureCap(600.0, "point")), 0.03, np.inf, 2.0)
    assert blow.restitution[1, 2] == single.restitution
    assert np.all(np.diff(blow.restitution, axis=1) < 0.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"stiffness": [1e9, 0.0, 1e9]}, r"stiffness must be positive and finite, got 0.0 at index 1"),
        ({"stiffness": [1e9, 1e9, np.nan]}, r"stiffness must be positive and finite, got nan at index 2"),
        ({"stiffness": 0.0}, r"stiffness must be positive and finite, got 0.0$"),
        ({"exponent": [[1.5], [0.0]]}, r"exponent must be within 0.1 to 10, got 0.0 at index \(1, 0\)"),
        ({"factor": [0.1, -0.1]}, r"hysteresis factor must be finite and >= 0, got -0.1 at index 1"),
        ({"mass1": [1.0, np.nan]}, r"first mass must be positive, got nan at index 1"),
        ({"mass2": [1.0, 0.0]}, r"second mass must be positive, got 0.0 at index 1"),
        (
            {"mass1": np.inf, "mass2": [1.0, np.inf]},
            r"second mass must be finite where the first is not, got inf at index 1",
        ),
        ({"speed": 0.0}, r"approach speed must be .* never meet, got 0.0"),
        ({"speed": [3.0, -3.0]}, r"approach speed must be .* never meet, got -3.0 at index 1"),
        ({"speed": [3.0, np.inf]}, r"approach speed must be .* got inf at index 1"),
        ({"deepest": -1e-6}, r"depth yielded before must be finite and >= 0"),
    ],
)
def test_one_bad_entry_is_named_with_its_index(change, words):
    given = {
        "stiffness": 1e9,
        "exponent": 1.5,
        "factor": 0.2,
        "mass1": 1.0,
        "mass2": 2.0,
        "speed": 3.0,
        "deepest": 0.0,
    } | change
    contact = Contact(given["stiffness"], given["exponent"], given["factor"])
    with pytest.raises(ValueError, match=words):
        solve_impact(contact, given["mass1"], given["mass2"], given["speed"], given["deepest"])


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="broadcast"):
        solve_impact(Contact([1e9, 2e9], 1.5), 1.0, 1.0, [1.0, 2.0, 3.0])


def test_history_wants_one_impact_and_times_within_it():
    blow = solve_impact(Contact(1e9, 1.5), 1.0, 1.0, [1.0, 2.0])
    with pytest.raises(ValueError, match="one impact, got 2"):
        impact_history(blow)
    single = solve_impact(Contact(1e9, 1.5), 1.0, 1.0, 1.0)
    for times in ([-1e-6], [0.0, 1.0], [2e-6, 1e-6]):
        with pytest.raises(ValueError, match="ascend within the contact"):
            impact_history(single, times)


def test_limits_of_the_restitution():
    """e -> 1: nothing lost; e -> 0: all, and the bodies stay together ever longer."""
    near = solve_impact(Contact(1e9, 1.5, exact([1 - 1e-12, 1.0])), 1.0, np.inf, 1.0)
    for name in ("max_indentation", "peak_force", "duration", "peak_time", "turning_time"):
        values = getattr(near, name)
        assert values[0] == pytest.approx(values[1], rel=1e-6), name
    assert near.energy_lost[1] == 0.0
    dead = solve_impact(Contact(1e9, 1.5, exact([1e-2, 1e-3, 1e-4])), 1.0, np.inf, 1.0)
    assert float(restitution(exact(1e-4))) == pytest.approx(1e-4, rel=1e-12)
    assert dead.energy_lost == pytest.approx(0.5 * (1 - np.array([1e-2, 1e-3, 1e-4]) ** 2), rel=1e-12)
    assert np.all(np.diff(dead.duration) > 0.0)


def test_extreme_impacts_are_refused_in_words_and_end():
    contact = Contact(1e9, 1.5, cap=PressureCap(1.0, "line"))
    with pytest.raises(ValueError, match=r"m v0\^2 lies within"):
        solve_impact(contact, 1e150, 1e150, 1e150)
    with pytest.raises(IntegrationError, match=r"index 1 of .* kg at .* could not be followed"):
        solve_impact(Contact(1e9, 1.5, damper=Damper([1.0, 1e30], 0.25)), 1.0, 1.0, 1.0)


def test_a_linear_damper_pushes_from_first_touch():
    """Kelvin-Voigt: F(0) = c v0."""
    blow = solve_impact(Contact(1e8, 1.0, damper=Damper(2e3)), 0.5, np.inf, 3.0)
    history = impact_history(blow)
    assert history.force[0] == pytest.approx(2e3 * 3.0, rel=1e-12)
    assert float(blow.peak_force) >= 2e3 * 3.0


def test_chains_and_bars_refuse_what_presses_beyond_a_logarithmic_law():
    contact = LogarithmicContact(1e10, 1e5)
    with pytest.raises(IntegrationError, match="beyond the end of its logarithmic law"):
        simulate(Chain({"a": 1.0, "b": 1.0}, [ChainContact("a", "b", contact)]), {}, {"a": 100.0}, 1e-3)
    bar = Stack((Layer("bar", 7820.0, 211e9, 1e-3, 0.5),))
    with pytest.raises(IntegrationError, match="beyond the end of its logarithmic law"):
        run_bar(bar, Impactor(0.2, 5.0, LogarithmicContact(1e10, 1e4)), [Tap(0, 0.0)], 1e-4, WantedError(step=1e-8))
    # a blow between the end and ten times it
    with pytest.raises(IntegrationError, match="beyond the end"):
        solve_impact(contact, 1.0, np.inf, 1.2 * math.sqrt(2 * 1e5**2 / (4 * 1e10 * math.e**2)))


def test_next_to_elastic_loses_what_its_factor_says():
    """1 - e = 2 chi/3 to first order."""
    blow = solve_impact(Contact(1e9, 1.5, 9e-10), 1.0, np.inf, 1.0)
    assert 1.0 - float(blow.restitution) == pytest.approx(6e-10, rel=1e-6)
    assert float(blow.energy_lost) == pytest.approx(6e-10, rel=1e-6)
