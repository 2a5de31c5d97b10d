"""Damping laws: the restitution that comes out of each, against published tables, limits and an independent integral."""

import math
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED, SOURCES
from strikewave.base.errors import InputError, StrikewaveError, StrikewaveWarning
from strikewave.contact import damper_laws, damping_laws, exact, factor, registry, restitution, stiffness_laws

ESTIMATES = [name for name in damping_laws() if name != "exact"]


def given_to_thirty_digits(chi):
    """e of a factor chi from the exit condition ln(1 + chi) - ln(1 - e chi) = chi (1 + e), by mpmath."""
    with mpmath.workdps(40):
        chi = mpmath.mpf(chi)
        start = -(1 + chi) * mpmath.exp(-(1 + chi))
        return float((1 + mpmath.lambertw(start, 0).real) / chi)


@pytest.mark.parametrize(
    ("law", "asked", "comes_out"),
    [
        ("li-ma-printed", 0.3, 0.2591),
        ("li-ma-printed", 0.5, 0.4740),
        ("li-ma-printed", 0.7, 0.6861),
        ("li-ma-printed", 0.9, 0.8952),
        ("flores", 0.5, 0.4704),
        ("hunt-crossley", 0.5, 0.663),
        ("lankarani-nikravesh", 0.5, 0.725),
        ("hu-guo", 0.5, 0.4877),
        ("gonthier", 0.5, 0.4877),
        ("carvalho-martins", 0.5, 0.5002),
        ("gharib-hurmuzlu", 0.9, 0.567),
        ("gharib-hurmuzlu", 1.0, 0.5936),
    ],
)
def test_restitution_asked_and_given(law, asked, comes_out):
    """The digits of an independent computation of these laws."""
    digits = len(str(comes_out)) - 2
    assert round(float(restitution(factor(law, asked))), digits) == comes_out


@pytest.mark.parametrize("law", ESTIMATES)
@pytest.mark.parametrize("e", [0.05, 0.3, 0.5, 0.8, 0.99])
def test_what_comes_out_of_each_law_against_thirty_digits(law, e):
    chi = float(factor(law, e))
    # near e = 1 the double chi itself carries the rounding of 1 - e
    assert float(restitution(chi)) == pytest.approx(given_to_thirty_digits(chi), rel=1e-13)


@pytest.mark.parametrize("law", ESTIMATES)
def test_what_comes_out_of_each_law_against_the_motion_itself(law):
    """scipy integrates F = K d^n (1 + chi d'/v0) for n = 1.3: 1e-8, its tolerance."""
    chi = float(factor(law, 0.6))

    def rates(_, y):
        return [y[1], -(max(y[0], 0.0) ** 1.3) * (1 + chi * y[1])]

    def apart(t, y):
        return y[0] + (t == 0)

    apart.terminal, apart.direction = True, -1
    end = solve_ivp(rates, (0, 50), [0.0, 1.0], method="DOP853", rtol=1e-12, atol=1e-13, events=apart).y[1, -1]
    assert float(restitution(chi)) == pytest.approx(-end, rel=1e-8)


@pytest.mark.parametrize(
    "law", [name for name in ESTIMATES if name not in ("gharib-hurmuzlu", "lee-wang", "safaeifar-farshidianfar")]
)
def test_near_elastic_limit_is_three_halves_of_the_loss(law):
    """The exact factor begins as chi = 3 (1 - e)/2; estimates to 7 % (Flores has 8/5), but for Gonthier's, which has 2."""
    loss = 1e-6
    limit = 2.0 if law == "gonthier" else 1.5
    assert float(factor(law, 1 - loss)) / loss == pytest.approx(limit, rel=0.07)


def test_exact_factor_near_elastic_and_near_plastic():
    """chi -> 3 (1 - e)/2 and, with L = chi (1 + e) -> 1/e + ..., chi -> 1/e."""
    assert float(exact(1 - 1e-9)) == pytest.approx(1.5e-9, rel=1e-7)
    assert float(exact(1.0)) == 0.0
    assert float(exact(1e-8)) == pytest.approx(1e8, rel=1e-6)


@pytest.mark.parametrize("law", sorted(damping_laws()))
@given(e=st.floats(0.01, 1.0))
def test_factors_are_never_negative_and_fall_with_the_restitution(law, e):
    chi, above = (float(x) for x in factor(law, [e, min(1.0, e * 1.01)]))
    assert chi >= above >= 0.0


@pytest.mark.parametrize("law", sorted(damping_laws()))
@pytest.mark.parametrize("bad", [0.0, -0.2, 1.0001, math.nan, math.inf])
def test_restitution_out_of_range_is_refused_with_its_index(law, bad):
    with pytest.raises(ValueError, match=r"0 < e <= 1.* at index \(1, 0\)"):
        factor(law, [[0.5, 0.5], [bad, 0.5]])


def test_unknown_law_is_refused_with_the_nearest():
    with pytest.raises(InputError, match='did you mean "flores"'):
        factor("flors", 0.5)


def test_every_law_states_equation_range_status_and_source():
    for law in [*damping_laws().values(), *damper_laws().values(), *stiffness_laws().values()]:
        assert law.equation, law.name
        assert law.limits, law.name
        assert law.status in (CHECKED, QUOTED, FROM_MEMORY), law.name
        assert (law.status == QUOTED) == bool(law.seen), law.name
        assert law.source in SOURCES, law.name
        assert law.function.__doc__.strip(), law.name
    memory = {name for name, law in damping_laws().items() if law.status == "from memory"}
    assert memory == {"gharib-hurmuzlu", "hu-guo", "safaeifar-farshidianfar"}


def test_li_ma_corrected_has_the_exact_integral():
    """1.523191 (1 - e)/e: B(19/18, 3/2)/2 in place of 3/10."""
    assert float(factor("li-ma-corrected", 0.5)) == pytest.approx(1.523191, abs=5e-7)


def test_arrays_keep_their_shape():
    assert np.shape(factor("flores", np.full((2, 3), 0.5))) == (2, 3)


@pytest.mark.parametrize(
    ("law", "half", "four_fifths"),
    [
        ("hunt-crossley", 3 / 4, 3 / 10),
        ("herbert-mcwhannell", 1.0, 5 / 14),
        ("lee-wang", 3 / 8, 3 / 20),
        ("lankarani-nikravesh", 9 / 16, 27 / 100),
        ("gonthier", 3 / 2, 9 / 20),
        ("zhiying-qishao", 9 / 16 * math.e, 27 / 100 * math.exp(2 / 5)),
        ("flores", 8 / 5, 2 / 5),
        ("gharib-hurmuzlu", 2.0, 5 / 4),
        ("hu-guo", 3 / 2, 3 / 8),
        ("carvalho-martins", 63 / 44, 153 / 410),
        ("safaeifar-farshidianfar", 5 / 4, 5 / 16),
        ("li-ma-printed", 30 / 19, 15 / 38),
    ],
)
def test_factors_at_a_half_and_four_fifths_are_fractions_worked_by_hand(law, half, four_fifths):
    assert factor(law, [0.5, 0.8]) == pytest.approx([half, four_fifths], rel=1e-14)


def test_li_ma_corrected_is_the_printed_law_with_the_integral_by_quadrature():
    integral, _ = quad(lambda x: x ** (10 / 9) * math.sqrt(1 - x * x), 0, 1, epsabs=1e-13)
    # quad's own 1e-10 at the root's end
    assert factor("li-ma-corrected", [0.25, 0.8]) == pytest.approx([27 / 19 / integral, 9 / 76 / integral], rel=1e-9)


def test_laws_of_installed_packages_stand_beside_ours_and_wrong_ones_are_left_out(monkeypatch):
    """A law of the kind is added, ours are kept; one of another kind, what is no law, and what fails is told."""
    good = registry.DampingLaw("mine", lambda e: 2.0 - e, "chi = 2 - e", "any e", QUOTED, "a book")
    ours = registry.DampingLaw("exact", lambda e: 9.0, "", "", QUOTED, "")
    words = registry.DampingLaw("words", lambda e: "much", "", "", QUOTED, "")
    other = registry.DamperLaw("damper", lambda *a: None, "", "", QUOTED, "")
    named_alike = type("DampingLaw", (), {"name": "no law"})()

    def failing():
        raise SystemExit("no licence")

    found = {"mine": good, "exact": ours, "words": words, "damper": other, "alike": named_alike}
    points = [SimpleNamespace(name=name, load=lambda law=law: law) for name, law in found.items()]
    points.append(SimpleNamespace(name="failing", load=failing))
    before = damping_laws()
    monkeypatch.setattr(registry, "entry_points", lambda group: points if group == "strikewave.damping_laws" else [])
    registry._added.cache_clear()
    try:
        with pytest.warns(StrikewaveWarning) as told:
            laws = damping_laws()
    finally:
        registry._added.cache_clear()
    assert set(laws) - set(before) == {"mine", "words"}
    assert laws["mine"].function(0.5) == 1.5
    assert laws["mine"].reference == "a book"
    assert laws["exact"] is before["exact"]
    with pytest.raises(StrikewaveError, match="'words' of an installed package gives"):
        laws["words"].function(0.5)
    said = " ".join(str(one.message) for one in told)
    assert all(f"{name!r}" in said or name in said for name in ("damper", "alike", "failing"))
    assert "it is a DamperLaw, not a DampingLaw" in said
    assert "SystemExit: no licence" in said
