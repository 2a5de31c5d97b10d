"""`solve_impact` and its histories: integrator against closed form, energy, arrays, limits and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import betainc

from strikewave.base.errors import IntegrationError
from strikewave.contact import (
    Chain,
    ChainContact,
    Contact,
    Damper,
    HardeningContact,
    LogarithmicContact,
    PressureCap,
    Stiffness,
    exact,
    impact_history,
    restitution,
    simulate,
    solve_impact,
)
from strikewave.contact.damping import named_contact
from strikewave.contact.law import (
    check_end,
    elastic_indentation,
    indentation_under,
    not_negative,
    positive,
    single,
    striking_law,
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
    for times in ([-1e-6], [0.0, 1.0], [2e-6, 1e-6], [0.0, 1.005 * float(single.duration)]):
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
    assert 1.0 - float(blow.restitution) == pytest.approx(6e-10, rel=1e-6, abs=0.0)
    assert float(blow.energy_lost) == pytest.approx(6e-10, rel=1e-6, abs=0.0)


def test_one_law_in_arrays_of_one_is_the_law_of_its_numbers_and_two_are_refused():
    plain = single(Contact(3e9, 1.25, 0.5, cap=PressureCap(20.0, "point")))
    for shape in ((1,), (1, 1)):
        arrays = (np.full(shape, x) for x in (3e9, 1.25, 0.5))
        assert np.array_equal(single(Contact(*arrays, cap=PressureCap(np.full(shape, 20.0), "point"))), plain)
    for wrong in (Contact([1e9, 2e9], 1.5), Contact(np.empty(0), 1.5)):
        with pytest.raises(ValueError, match=r"one contact law is wanted here, got [02]"):
            single(wrong)


@pytest.mark.parametrize("n", [1.0, 1.5, 3.0])
def test_indentation_without_losses_holds_the_energy_and_bears_its_force(n):
    """K d^(n+1)/(n+1) = m v^2/2, d = (F/K)^(1/n)."""
    depth = elastic_indentation(Contact(2e9, n), mass=0.3, speed=5.0)
    assert 2e9 * depth ** (n + 1) / (n + 1) == pytest.approx(0.5 * 0.3 * 25.0, rel=1e-13)
    assert indentation_under(Contact(2e9, n), 2e9 * depth**n) == pytest.approx(depth, rel=1e-13)


def area(contact, depth):
    """The energy of a logarithmic law up to a depth, by quadrature over its force."""
    slope, load = contact.slope, contact.load
    force = brentq(
        lambda f: f / slope * math.log(load / f) - depth, 1e-12 * load, load / math.e, xtol=1e-18, rtol=1e-15
    )
    return force * depth - quad(lambda f: f / slope * math.log(load / f), 0.0, force, epsabs=0.0, epsrel=1e-12)[0]


@pytest.mark.parametrize("energy", [1e-9, 1e-3, 0.03])
def test_logarithmic_law_reaches_the_depth_that_holds_an_energy(energy):
    contact = LogarithmicContact(1e10, 1e5)
    depth = elastic_indentation(contact, 2.0 * energy, 1.0)
    assert area(contact, depth) == pytest.approx(energy, rel=1e-9)


def test_logarithmic_law_ends_at_its_load_over_e():
    contact = LogarithmicContact(1e10, 1e5)
    end = 1e-5 / math.e
    assert float(contact.end_depth) == pytest.approx(end, rel=1e-15)
    assert indentation_under(contact, 1e3) == pytest.approx(1e-7 * math.log(100.0), rel=1e-14)
    assert indentation_under(contact, 1e5 / math.e) == indentation_under(contact, 1e6) == pytest.approx(end, rel=1e-14)
    # beyond the energy of its end, B^2/(4 G e^2), there is no deeper
    assert elastic_indentation(contact, 2.0, 1.0) == pytest.approx(end, rel=1e-14)
    check_end(contact, 0.9999 * end)
    check_end(Contact(1e9, 1.5), 1.0)
    with pytest.raises(IntegrationError, match=r"0\.003679 mm|beyond the end of its logarithmic law"):
        check_end(contact, end)


def test_cushions_reach_the_depth_that_holds_an_energy():
    """tangent: W = (4 k L^2/pi^2) ln(1/cos(pi d/2L)); a plateau without densification: P d - P^2/(2 k)."""
    k, limit, depth = 2e5, 0.01, 0.007
    energy = 4 * k * limit**2 / math.pi**2 * -math.log(math.cos(math.pi * depth / (2 * limit)))
    assert elastic_indentation(HardeningContact("tangent", k, limit), 2 * energy, 1.0) == pytest.approx(
        depth, rel=1e-12
    )
    flat = HardeningContact("plateau", k, math.inf, plateau=100.0)
    assert elastic_indentation(flat, 2 * (100.0 * depth - 0.025), 1.0) == pytest.approx(depth, rel=1e-12)
    assert elastic_indentation(flat, 2 * 0.5 * k * 1e-8, 1.0) == pytest.approx(1e-4, rel=1e-12)
    # the elastomer by quadrature
    rubber = HardeningContact("elastomer", k, limit)
    work = quad(lambda d: k * limit / 3 * ((1 - d / limit) ** -2 - (1 - d / limit)), 0.0, depth)[0]
    assert elastic_indentation(rubber, 2 * work, 1.0) == pytest.approx(depth, rel=1e-10)
    assert float(rubber.end_depth) == pytest.approx(0.0099, rel=1e-14)


def test_a_striker_takes_any_damper_but_one_that_pulls():
    assert np.array_equal(striking_law(Contact(1e9, 1.5, 0.5)), single(Contact(1e9, 1.5, 0.5)))
    for style in ("never-pulls", "on-approach", "retarded"):
        assert np.any(striking_law(Contact(1e9, 1.5, damper=Damper(2.0, 0.25, style))) == 2.0)
    assert striking_law(Contact(1e9, 1.5, damper=Damper(0.0, style="pulls"))) is not None
    with pytest.raises(ValueError, match="a damper that never pulls"):
        striking_law(Contact(1e9, 1.5, damper=Damper(1.0, style="pulls")))


def test_numbers_at_the_edges_of_what_a_law_takes():
    for n in (0.1, 10.0):
        assert float(solve_impact(Contact(1e9, n), 1.0, 1.0, 1.0).restitution) == pytest.approx(1.0)
    for n in (0.0999, 10.001):
        with pytest.raises(ValueError, match=r"within 0\.1 to 10"):
            solve_impact(Contact(1e9, n), 1.0, 1.0, 1.0)
    assert float(not_negative("x", 0.0)) == 0.0
    assert float(positive("x", 5e-324)) == 5e-324
    for check, wrong in ((not_negative, [-1.0, math.inf, math.nan]), (positive, [0.0, math.inf, math.nan])):
        for x in wrong:
            with pytest.raises(ValueError, match="x must be"):
                check("x", x)
    # the yield load of a logarithmic law lies below B/e
    solve_impact(LogarithmicContact(1e10, 1e5, cap=PressureCap(0.999e5 / math.e, "line")), 1.0, np.inf, 1e-3)
    with pytest.raises(ValueError, match="below the end of the logarithmic law"):
        solve_impact(LogarithmicContact(1e10, 1e5, cap=PressureCap(1.001e5 / math.e, "line")), 1.0, np.inf, 1e-3)


def test_an_impact_says_which_restitution_it_missed_most():
    stiffness = Stiffness(1e9, 1.5)
    assert solve_impact(Contact(1e9, 1.5, 0.7), 1.0, 1.0, 1.0).words == ()
    assert solve_impact(named_contact(stiffness, "exact", [0.2, 0.9]), 1.0, 1.0, 1.0).words == ()
    asked = [0.9, 0.5, 0.7]  # flores gives 0.8945, 0.4704, 0.6816
    (said,) = solve_impact(named_contact(stiffness, "flores", asked), 1.0, 1.0, 1.0).words
    assert said == "the damping law flores gives e = 0.4704, not the 0.5 asked for; exact gives it"
    cap = PressureCap(10.0, "point")
    (said,) = solve_impact(named_contact(stiffness, "exact", 0.5, cap), 1.0, 1.0, 1.0).words
    assert said.startswith("the contact yields: e = 0.")
    assert said.endswith("not the 0.5 asked for of exact alone")


def test_history_without_times_goes_in_501_steps_from_touch_to_release():
    for contact in (Contact(1e9, 1.5, 0.4), by_steps(Contact(1e9, 1.5, 0.4))):
        blow = solve_impact(contact, 0.5, 0.5, 2.0)
        history = impact_history(blow)
        assert history.method == blow.method
        assert history.time == pytest.approx(np.linspace(0.0, float(blow.duration), 501), rel=1e-14)
        assert (history.rate[0], history.indentation[0]) == (pytest.approx(2.0, rel=1e-12), 0.0)
        assert history.rate[-1] == pytest.approx(-2.0 * float(blow.restitution), rel=1e-6)
        # force = reduced mass times the slope of the rate, by differences of 0.2 % of the contact
        slope = -0.25 * np.gradient(history.rate, history.time)
        assert history.force[5:-5] == pytest.approx(slope[5:-5], abs=1e-4 * float(blow.peak_force))
        assert np.gradient(history.indentation, history.time)[5:-5] == pytest.approx(history.rate[5:-5], abs=1e-3)


def test_arrays_of_impacts_hold_each_what_one_alone_holds():
    """All numbers and times of each, to the bit, in closed form and by steps."""
    k, n, chi = np.array([1e9, 2e9, 5e9]), np.array([1.0, 1.5, 1.2]), np.array([0.0, 0.3, 2.0])
    mass, speed = np.array([0.5, 0.1, 0.2]), np.array([1.0, 3.0, 2.0])
    for law in (Contact, lambda *row: by_steps(Contact(*row))):
        several = solve_impact(law(k, n, chi), mass, np.inf, speed)
        for i in range(3):
            one = solve_impact(law(k[i], n[i], chi[i]), mass[i], np.inf, speed[i])
            for name in NUMBERS:
                assert float(getattr(several, name)[i]) == float(getattr(one, name)), name
    assert restitution(chi) == pytest.approx([float(restitution(x)) for x in chi], rel=1e-15)
    assert exact([0.3, 0.5, 0.9]) == pytest.approx([float(exact(e)) for e in (0.3, 0.5, 0.9)], rel=1e-15)
