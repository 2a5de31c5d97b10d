"""Dampers F = K d^n + c d^p d': the restitution that comes out, against closed forms and published numbers."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.base.errors import IntegrationError
from strikewave.contact import (
    Chain,
    ChainContact,
    Contact,
    Damper,
    Stiffness,
    damper_laws,
    hertz,
    simulate,
    solve_impact,
)
from strikewave.contact.damping import (
    approach_restitution,
    cut_off_damping_ratio,
    cut_off_restitution,
    damper_of_ratio,
    kuwabara_kono,
    logarithmic_damping_ratio,
    pulling_restitution,
)

CLOSED = {"pulls": pulling_restitution, "never-pulls": cut_off_restitution, "on-approach": approach_restitution}


@pytest.mark.parametrize("style", sorted(CLOSED))
@settings(max_examples=25)
@given(n=st.floats(1.0, 2.0), zeta=st.floats(0.01, 0.7), mass=st.floats(1e-2, 1e2), speed=st.floats(0.1, 50.0))
def test_restitution_depends_on_the_damping_ratio_alone(style, n, zeta, mass, speed):
    """c = zeta sqrt(2 (n+1) m K), p = (n-1)/2: one curve a style whatever n, mass and speed; the integrator to 1e-7."""
    stiffness = Stiffness(1e9, n)
    damper = damper_of_ratio(stiffness, mass, zeta, style)
    blow = solve_impact(stiffness.contact(damper=damper), mass, np.inf, speed)
    assert float(blow.restitution) == pytest.approx(float(CLOSED[style](zeta)), rel=3e-7)


@pytest.mark.parametrize(("zeta", "e"), [(0.1, 0.74408), (0.2, 0.57174), (0.5, 0.29844)])
def test_schwager_poschel_2007_eq_21(zeta, e):
    """e = exp{-(zeta/w) [pi - atan2(2 zeta w, 1 - 2 zeta^2)]} with w = sqrt(1 - zeta^2), as printed, to its digits."""
    w = math.sqrt(1 - zeta**2)
    printed = math.exp(-zeta / w * (math.pi - math.atan2(2 * zeta * w, 1 - 2 * zeta**2)))
    # the angle of the print is 2 asin(zeta), so that pi - angle = 2 arccos(zeta)
    assert float(cut_off_restitution(zeta)) == pytest.approx(printed, rel=1e-14)
    assert float(cut_off_restitution(zeta)) == pytest.approx(e, abs=5e-6)


def test_cut_off_is_continuous_through_critical_damping_and_falls_as_one_over_four_zeta_squared():
    near = cut_off_restitution([1 - 1e-8, 1.0, 1 + 1e-8])
    assert near == pytest.approx(math.exp(-2), rel=1e-7)
    assert float(cut_off_restitution(1e4)) == pytest.approx(1 / (4 * 1e8), rel=1e-6)


@given(st.floats(0.001, 1.0))
def test_ratios_and_restitutions_are_inverse(e):
    assert float(cut_off_restitution(cut_off_damping_ratio(e))) == pytest.approx(e, rel=1e-12)
    assert float(pulling_restitution(logarithmic_damping_ratio(e))) == pytest.approx(e, rel=1e-12)


def particle(modulus, nu):
    class Body:
        youngs_modulus, poissons_ratio = modulus, nu

    return Body()


def test_tsuji_gives_the_rebound_of_a_published_example():
    """Spheres of 4 mm, 2500 kg/m^3, E 1 MPa, nu 0.4, +-1 m/s, e 0.8: the LAMMPS example rebounds at 0.79999999 m/s."""
    body, radius = particle(1e6, 0.4), 2e-3
    stiffness = hertz(body, body, radius, radius)
    ball = 2500 * 4 / 3 * math.pi * radius**3
    tsuji = damper_laws()["tsuji"]
    blow = solve_impact(stiffness.contact(damper=tsuji.function(stiffness, ball / 2, 0.8)), ball, ball, 2.0)
    # the integrator's 1e-7, and what the example prints
    assert float(blow.restitution) == pytest.approx(0.8, rel=2e-7)


def pade_of_muller_poschel(s):
    """Muller & Poschel 2011, arXiv:1102.5247: e of Kuwabara-Kono spheres cut off at F = 0, s^2 = (3/2) A (rho/m)^(2/5) v^(1/5)."""
    above = 1 + s * (1.07232 + s * (0.574198 + s * 0.141552))
    below = 1 + s * (1.07232 + s * (1.72765 + s * (1.37842 + s * (1.19449 + s * (0.467273 + s * 0.235585)))))
    return above / below


@pytest.mark.parametrize(
    ("speed", "pulled", "cut"),
    [(0.1, 0.80865, 0.81162), (0.3, 0.76828, 0.77305), (1.0, 0.71617, 0.72406), (3.0, 0.66100, 0.67323)],
)
def test_kuwabara_kono_falls_with_speed_as_published(speed, pulled, cut):
    """Two spheres r 10 mm, 2500 kg/m^3, E 0.1 GPa, nu 0.3, A = 50 us: Pade of Muller & Poschel, and the end at d = 0.

    ``pulled`` and ``cut`` were integrated independently; 0.809 and 0.661 are in print. Pade coefficients carry six digits.
    """
    body, radius = particle(1e8, 0.3), 10e-3
    ball = 2500 * 4 / 3 * math.pi * radius**3
    stiffness, mass = hertz(body, body, radius, radius), ball / 2
    damper = kuwabara_kono(stiffness, mass, 50e-6)
    blow = solve_impact(stiffness.contact(damper=damper), ball, ball, speed)
    x = 1.5 * 50e-6 * (stiffness.stiffness / mass) ** 0.4 * speed**0.2
    assert float(blow.restitution) == pytest.approx(pade_of_muller_poschel(math.sqrt(x)), abs=2e-5)
    assert float(blow.restitution) == pytest.approx(cut, abs=6e-6)
    pulling = Damper(damper.coefficient, damper.exponent, "pulls")
    assert float(solve_impact(stiffness.contact(damper=pulling), ball, ball, speed).restitution) == pytest.approx(
        pulled, abs=6e-6
    )


@pytest.mark.parametrize("law", [name for name, law in damper_laws().items() if law.given is not None])
@pytest.mark.parametrize("e", [0.2, 0.5, 0.9])
def test_every_law_of_a_damper_gives_what_it_says(law, e):
    made = damper_laws()[law]
    n = made.exponent or 1.5
    stiffness = Stiffness(1e9, n)
    blow = solve_impact(stiffness.contact(damper=made.function(stiffness, 0.3, e)), 0.3, np.inf, 4.0)
    assert float(blow.restitution) == pytest.approx(float(made.given(e, n)), rel=3e-7)
    if "gives the restitution" in made.function.__doc__ or law in ("kelvin-voigt", "tsuji", "tsuji-cut-off"):
        assert float(blow.restitution) == pytest.approx(e, rel=3e-7)


def test_linear_laws_refuse_another_exponent():
    with pytest.raises(ValueError, match="must be 1"):
        damper_laws()["kelvin-voigt"].function(Stiffness(1e9, 1.5), 1.0, 0.5)


def test_a_damper_beside_hysteresis_is_refused():
    with pytest.raises(ValueError, match="not both"):
        solve_impact(Contact(1e9, 1.5, 0.5, damper=Damper(1.0)), 1.0, 1.0, 1.0)


def test_energy_of_a_linear_damper_is_that_of_the_damped_oscillator():
    """Kelvin-Voigt: d = (v0/w) exp(-zeta w0 t) sin(w t) gives duration pi/w and peak indentation in closed form."""
    k, m, v, zeta = 1e8, 0.4, 3.0, 0.3
    w0 = math.sqrt(k / m)
    w = w0 * math.sqrt(1 - zeta**2)
    stiffness = Stiffness(k, 1.0)
    blow = solve_impact(stiffness.contact(damper=damper_of_ratio(stiffness, m, zeta, "pulls")), m, np.inf, v)
    turn = math.acos(zeta) / w
    assert float(blow.duration) == pytest.approx(math.pi / w, rel=1e-7)
    assert float(blow.turning_time) == pytest.approx(turn, rel=1e-6)
    assert float(blow.max_indentation) == pytest.approx(
        v / w * math.exp(-zeta * w0 * turn) * math.sin(w * turn), rel=1e-7
    )
    assert float(blow.energy_lost) == pytest.approx(
        0.5 * m * v**2 * -math.expm1(-2 * math.pi * zeta * w0 / w), rel=1e-6
    )


@pytest.mark.parametrize("zeta", [1.0, 2.0, 5.0])
def test_a_pulling_damper_beyond_critical_never_lets_go(zeta):
    stiffness = Stiffness(1e8, 1.0)
    with pytest.raises(IntegrationError, match="never part"):
        solve_impact(stiffness.contact(damper=damper_of_ratio(stiffness, 1.0, zeta, "pulls")), 1.0, np.inf, 1.0)


def test_a_chain_with_a_damper_that_jumps_at_touch_meets_the_impact():
    """Kelvin-Voigt pushes with c v0 at first touch: the chain restarts there, to 1e-7."""
    stiffness = Stiffness(1e8, 1.0)
    contact = stiffness.contact(damper=damper_of_ratio(stiffness, 0.3, 0.3, "never-pulls"))
    blow = solve_impact(contact, 0.3, np.inf, 4.0)
    chain = Chain({"a": 0.3}, [ChainContact("a", "wall", contact)], bases={"wall": 0.0})
    motion = simulate(chain, {"a": -1e-4}, {"a": 4.0}, 1e-4 / 4.0 + 2 * float(blow.duration), tolerance=1e-9)
    assert -motion.speeds(motion.motion.end.time)[0] / 4.0 == pytest.approx(float(blow.restitution), rel=2e-7)
    # it ends where the force is gone, 2 arccos(zeta)/w, not where the indentation is
    w = math.sqrt(1e8 / 0.3 * (1 - 0.3**2))
    assert float(blow.duration) == pytest.approx(2 * math.acos(0.3) / w, rel=1e-6)


def test_jankowski_2006_at_a_half_and_at_both_ends():
    """xi = 13.5 sqrt(5)/(9 pi + 16) at e = 1/2; near 1 its law gives e itself, near 0 zeta e = 9/16 (n = 3/2)."""
    stiffness = Stiffness(1e8, 1.5)
    half = damper_laws()["jankowski"].function(stiffness, 0.04, 0.5)
    # c = 2 xi sqrt(m K), p = 1/4
    assert float(half.coefficient) == pytest.approx(2 * 13.5 * math.sqrt(5) / (9 * math.pi + 16) * 2e3, rel=1e-14)
    assert (half.exponent, half.style) == (0.25, "on-approach")
    given_ = damper_laws()["jankowski"].given
    # the next order of 1 - e
    assert float(given_(1 - 1e-6, 1.5)) == pytest.approx(1 - 1e-6, abs=1e-11)
    nearly_dead = damper_laws()["jankowski"].function(stiffness, 0.04, 1e-9)
    assert float(nearly_dead.coefficient) == pytest.approx(9 / 16 * 1e9 * math.sqrt(5) * 2e3, rel=1e-8)


@pytest.mark.parametrize("zeta", [0.05, 0.4, 0.97, 1.03, 2.5, 30.0])
def test_decay_to_turning_and_its_slope_by_mpmath(zeta):
    """arccos(zeta)/sqrt(1 - zeta^2) is one analytic function through zeta = 1, real on both sides."""
    from strikewave.contact.damping import _decay_and_slope

    def decay(z):
        return mpmath.re(z * mpmath.acos(z) / mpmath.sqrt(1 - z * z))

    with mpmath.workdps(30):
        value, slope = float(decay(mpmath.mpf(zeta))), float(mpmath.diff(decay, zeta))
    # near 1 both lose the digits of 1 - zeta
    assert [float(x) for x in _decay_and_slope(np.array(zeta))] == pytest.approx([value, slope], rel=1e-12)


def test_decay_to_turning_at_critical_damping_is_one_with_slope_two_thirds():
    from strikewave.contact.damping import _decay_and_slope

    assert [float(x) for x in _decay_and_slope(np.array(1.0))] == [1.0, pytest.approx(2 / 3, rel=1e-15)]


def test_anagnostopoulos_1988_cut_off_gives_the_published_half():
    """0.5 asked for comes out as 0.5503 where the linear damper never pulls."""
    law = damper_laws()["anagnostopoulos"]
    assert float(law.given(0.5, 1.0)) == pytest.approx(0.5503, abs=5e-5)


def test_a_damper_close_to_critical_lets_go_as_late_as_its_closed_form_says():
    """pi/w of a damper that may pull, zeta = 0.97: four times the undamped duration, and a rebound of 4e-6."""
    zeta, w0 = 0.97, math.sqrt(1e8 / 0.4)
    stiffness = Stiffness(1e8, 1.0)
    blow = solve_impact(stiffness.contact(damper=damper_of_ratio(stiffness, 0.4, zeta, "pulls")), 0.4, np.inf, 3.0)
    # 1e-7 of the speed at first touch is 1e-2 of that at the end, which lasts 1e-4 of the duration
    assert float(blow.duration) == pytest.approx(math.pi / (w0 * math.sqrt(1 - zeta**2)), rel=1e-5)
