"""Force laws of a contact one by one, as plain functions: slopes, energies, memories and inverses that belong together."""

import functools
import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from strikewave.contact._law_kernels import (
    COLUMNS,
    CRUSH,
    DAMPER,
    DAMPER_EXPONENT,
    DAMPING,
    ELASTOMER,
    EXPONENT,
    FORM,
    LIMIT,
    LINE,
    LOGARITHMIC,
    NEVER_PULLS,
    ON_APPROACH,
    PLATEAU,
    POINT,
    POWER,
    PULLS,
    RETARDED,
    SHAPE,
    SLOWEST,
    STIFFNESS,
    STYLE,
    TANGENT,
    YIELD_LOAD,
    base_energy,
    base_force,
    base_slope,
    capped,
    crushed,
    damper_force,
    depth_at_yield,
    elastic_depth,
    flattening,
    hysteresis,
    logarithm,
    push,
    residual,
    stored,
    unyielding,
    unyielding_force,
    yielding,
)

from .interpreted import interpret

KERNELS = (
    base_energy,
    base_force,
    base_slope,
    capped,
    crushed,
    damper_force,
    depth_at_yield,
    elastic_depth,
    flattening,
    hysteresis,
    logarithm,
    push,
    residual,
    stored,
    unyielding,
    unyielding_force,
    yielding,
)
"""What is tried here."""


def area(force, *cuts):
    """The integral of a force between cuts, to 1e-10."""
    return sum(quad(force, a, b, epsabs=0.0, epsrel=1e-10)[0] for a, b in itertools.pairwise(cuts))


@pytest.fixture
def kernels(monkeypatch):
    return interpret(monkeypatch, KERNELS)


def row(numbers):
    """A law as a row, without a cap where none is asked for."""
    law = np.zeros(COLUMNS)
    law[YIELD_LOAD] = math.inf
    for place, value in numbers.items():
        law[place] = value
    return law


POWER_LAW = row({FORM: POWER, STIFFNESS: 3e4, EXPONENT: 1.4})
LINE_LAW = row({FORM: LOGARITHMIC, STIFFNESS: 2e6, EXPONENT: 5e4})
TANGENT_LAW = row({FORM: TANGENT, STIFFNESS: 700.0, LIMIT: 0.03})
RUBBER = row({FORM: ELASTOMER, STIFFNESS: 900.0, LIMIT: 0.05})
FOAM = row({FORM: PLATEAU, STIFFNESS: 4e3, EXPONENT: 11.0, LIMIT: 0.02})
BASES = {
    "power": (POWER_LAW, (1e-4, 0.02, 1.3)),
    "line": (LINE_LAW, (1e-9, 1e-4, 8e-3)),
    "tangent": (TANGENT_LAW, (1e-3, 0.02, 0.0296, 0.0299, 0.04)),
    "rubber": (RUBBER, (1e-3, 0.03, 0.0494, 0.0499, 0.06)),
    # before its plateau from 2.75 mm on, on it, beyond 11.3 mm, and beyond 0.99 of its limit
    "foam": (FOAM, (1e-3, 0.007, 0.013, 0.0197, 0.0199, 0.025)),
}


@pytest.mark.parametrize("name", BASES)
def test_slope_and_energy_of_a_base_are_derivative_and_integral_of_its_force(kernels, name):
    law, depths = BASES[name]
    breaks = [0.0, 0.00275, 0.02 * (1 - 1 / 2.3), 0.99 * law[LIMIT]]
    for d in depths:
        h = 1e-5 * d
        by_difference = (kernels.base_force(law, d + h) - kernels.base_force(law, d - h)) / (2 * h)
        # the third derivative leaves 1e-10 of the slope times (d over the way to the limit)^2
        assert kernels.base_slope(law, d) == pytest.approx(by_difference, rel=1e-5, abs=1e-9 * law[STIFFNESS])
        cuts = sorted({0.0, d, *(cut for cut in breaks if 0.0 < cut < d)})
        work = area(lambda x: kernels.base_force(law, x), *cuts)
        assert kernels.base_energy(law, d) == pytest.approx(work, rel=1e-9, abs=0.0)
    for nothing in (0.0, -1e-4):
        assert kernels.base_force(law, nothing) == 0.0
        assert kernels.base_slope(law, nothing) == 0.0
        assert kernels.base_energy(law, nothing) == 0.0


def test_bases_bear_at_round_depths_what_their_formulas_say(kernels):
    """4 K at 2^2; tan 45 deg; w = 1/2, 1/w^2 - w = 7/2; the plateau and four times the force of its end."""
    square = row({FORM: POWER, STIFFNESS: 3.0, EXPONENT: 2.0})
    assert kernels.base_force(square, 2.0) == 12.0
    assert kernels.base_force(TANGENT_LAW, 0.015) == pytest.approx(2 * 700.0 * 0.03 / math.pi, rel=1e-14)
    assert kernels.base_force(RUBBER, 0.025) == pytest.approx(900.0 * 0.05 / 3 * 3.5, rel=1e-14)
    assert kernels.base_force(FOAM, 0.00274) == pytest.approx(10.96, rel=1e-14)
    assert kernels.base_force(FOAM, 0.00276) == kernels.base_force(FOAM, 0.0113) == 11.0
    # L/(L - d) over D = 2.3 at a tenth of the limit left
    assert kernels.base_force(FOAM, 0.018) == pytest.approx(11.0 * 10 / 2.3, rel=1e-13)
    # the cut at 0.99 of the limit, and straight on with that slope
    far = 11.0 * 100 / 2.3
    assert kernels.base_force(FOAM, 0.0198) == pytest.approx(far, rel=1e-12)
    assert kernels.base_force(FOAM, 0.0208) == pytest.approx(far + far * 100 / 0.02 * 1e-3, rel=1e-12)


@pytest.mark.parametrize("share", [1e-12, 1e-5, 0.2, 0.9, 0.996])
def test_logarithmic_law_is_the_root_of_its_equation_and_ends_where_it_says(kernels, share):
    """d = (F/G) ln(B/F) with F = G d/w, up to the end at d = B/(G e), beyond which w = 1."""
    d = share * LINE_LAW[EXPONENT] / LINE_LAW[STIFFNESS] / math.e
    force = kernels.base_force(LINE_LAW, d)
    # near the end the force grows with the root of what is left: its last bits are lost there
    found = force / LINE_LAW[STIFFNESS] * math.log(LINE_LAW[EXPONENT] / force)
    assert found == pytest.approx(d, rel=1e-14)
    assert kernels.logarithm(LINE_LAW, d) > 1.0
    end = LINE_LAW[EXPONENT] / LINE_LAW[STIFFNESS] / math.e
    assert kernels.logarithm(LINE_LAW, 1.0001 * end) == 1.0


@pytest.mark.parametrize("name", BASES)
def test_depth_of_an_energy_holds_it(kernels, name):
    law, depths = BASES[name]
    for d in depths:
        energy = kernels.base_energy(law, d)
        assert kernels.elastic_depth(law, energy) == pytest.approx(d, rel=1e-12)
    if name == "line":
        end = 5e4 / 2e6 / math.e
        for more in (1.0, 2.0):
            assert kernels.elastic_depth(law, more * kernels.base_energy(law, end)) == end


def test_a_crushed_cushion_densifies_as_its_plateau_does_until_it_is_as_steep_as_at_first_touch(kernels):
    """Force over the plateau, depth over that at yield: 4e3 N/m, 11 N, 20 mm are a limit of 7.27 of them."""
    crush = row({FORM: POWER, STIFFNESS: 4e3, EXPONENT: 1.0, YIELD_LOAD: 11.0, SHAPE: CRUSH, LIMIT: 0.02})
    at_yield = 11.0 / 4e3
    limit = 0.02 / at_yield
    last = limit - math.sqrt(limit / 2.3)  # where r^2 = D L
    for q in (1.0, 2.0, 0.5653 * limit, 0.57 * limit, 0.5 * (last + 0.565 * limit), 0.999 * last):
        f, slope = kernels.crushed(crush, q)
        assert kernels.capped(crush, q) == (f, slope)
        assert f == pytest.approx(kernels.base_force(FOAM, q * at_yield) / 11.0, rel=1e-12)
        if q > 1.0:
            assert slope == pytest.approx(kernels.base_slope(FOAM, q * at_yield) / 4e3, rel=1e-12)
    end, steep = kernels.crushed(crush, last)
    assert steep == pytest.approx(1.0, rel=1e-12)
    assert kernels.crushed(crush, last + 3.0) == (pytest.approx(end + 3.0, rel=1e-13), 1.0)


def test_caps_of_point_and_line_worked_by_hand(kernels):
    """Elastic force of 8 and 4 yield loads: 3/2 x 4 - 1/2; asin 1/2 = 30 deg; both begin at 1 with slope 1."""
    point, line = row({SHAPE: POINT}), row({SHAPE: LINE})
    assert kernels.capped(point, 8.0) == (pytest.approx(5.5, rel=1e-14), pytest.approx(0.5, rel=1e-14))
    assert kernels.capped(line, 4.0) == (
        pytest.approx(4 / 3 + 2 * math.sqrt(3) / math.pi, rel=1e-14),
        pytest.approx(1 / 3, rel=1e-14),
    )
    for law in (point, line):
        assert kernels.capped(law, 1.0) == (pytest.approx(1.0), pytest.approx(1.0))


def yielding_law(shape, base=None):
    law = (row({FORM: POWER, STIFFNESS: 2e5, EXPONENT: 1.5}) if base is None else base).copy()
    law[YIELD_LOAD], law[SHAPE], law[LIMIT] = 40.0, shape, 0.02 if shape == CRUSH else 0.0
    return law


CAPPED = {
    "point": yielding_law(POINT),
    "line": yielding_law(LINE, LINE_LAW),
    "crush": yielding_law(CRUSH, row({FORM: POWER, STIFFNESS: 1e4, EXPONENT: 1.0})),
}


@pytest.mark.parametrize("name", CAPPED)
def test_what_yields_has_its_slope_its_energy_and_its_way_back(kernels, name):
    """At the depth D: F' by differences; the rate of what comes back; and the way back begins at F with area W."""
    law = CAPPED[name]
    first, back = kernels.depth_at_yield(law), functools.partial(kernels.unyielding_force, law)
    assert kernels.base_force(law, first) == pytest.approx(40.0, rel=1e-13)
    for times in (1.001, 1.7, 3.5):
        d = times * first
        force, rise, storing = kernels.yielding(law, d)
        h = 1e-6 * d
        pair = [kernels.yielding(law, d + side * h)[0] for side in (-1, 1)]
        assert rise == pytest.approx((pair[1] - pair[0]) / (2 * h), rel=1e-4, abs=1e-6 * force / d)
        kept = [kernels.stored(law, d + side * h, 0.0) for side in (-1, 1)]
        assert storing == pytest.approx((kept[1] - kept[0]) / (2 * h), abs=1e-6 * force)
        s = kernels.flattening(law, d)
        assert s == pytest.approx(kernels.base_force(law, d) / force, rel=1e-14)
        left = kernels.residual(d, s)
        assert kernels.unyielding(law, d, d, s)[0] == pytest.approx(force, rel=1e-13)
        assert abs(kernels.unyielding_force(law, left, d, s)) < 1e-9 * force
        for x in (left + 0.3 * (d - left), left + 0.9 * (d - left)):
            here, slope = kernels.unyielding(law, x, d, s)
            assert here == kernels.unyielding_force(law, x, d, s)
            pair = [kernels.unyielding_force(law, x + side * h, d, s) for side in (-1, 1)]
            assert slope == pytest.approx((pair[1] - pair[0]) / (2 * h), rel=1e-5)
            work = area(functools.partial(back, deepest=d, s=s), left, x)
            assert kernels.stored(law, x, d) == pytest.approx(work, rel=1e-8, abs=0.0)
    # nothing has yielded before the yield load: the elastic slope, and a radius as before
    assert kernels.flattening(law, 0.99 * first) == 1.0
    force, rise, _ = kernels.yielding(law, 0.5 * first)
    assert force == pytest.approx(40.0, rel=1e-12)
    assert rise == pytest.approx(kernels.base_slope(law, 0.5 * first) * kernels.capped(law, 1.0)[1], rel=1e-12)


def test_spots_that_have_flattened_worked_by_hand(kernels):
    """s = 8/5.5 at eight yield loads; of D = 3 and s = 1.5 one third of D stays."""
    law = yielding_law(POINT)
    deep = (8 * 40.0 / 2e5) ** (2 / 3)
    assert kernels.flattening(law, deep) == pytest.approx(8 / 5.5, rel=1e-13)
    assert kernels.residual(3.0, 1.5) == pytest.approx(1.0, rel=1e-15)
    assert kernels.depth_at_yield(POWER_LAW) == 0.0


def test_hysteresis_and_dampers_worked_by_hand(kernels):
    law = row({FORM: POWER, STIFFNESS: 10.0, EXPONENT: 2.0, DAMPING: 0.5, SLOWEST: 0.1})
    # 1 + chi d'/v0, v0 no less than the slowest approach
    assert kernels.hysteresis(law, 3.0, 2.0) == kernels.push(law, 7.0, 3.0, 2.0) == 1.75
    assert kernels.hysteresis(law, -3.0, 0.01) == -14.0
    assert kernels.damper_force(law, 1.0, 3.0) == 0.0
    damped = row({FORM: POWER, STIFFNESS: 10.0, EXPONENT: 2.0, DAMPER: 7.0, DAMPER_EXPONENT: 3.0, STYLE: NEVER_PULLS})
    # c d^p d' = 7 x 8 x 3 beside K d^2 = 40
    assert kernels.damper_force(damped, 2.0, 3.0) == 168.0
    assert kernels.damper_force(damped, 2.0, -3.0) == -168.0
    assert kernels.damper_force(damped, -2.0, 3.0) == 0.0
    assert kernels.push(damped, 2.0, -3.0, 9.0) == pytest.approx(1 - 168 / 40, rel=1e-15)
    damped[STYLE] = ON_APPROACH
    assert (kernels.damper_force(damped, 2.0, 3.0), kernels.damper_force(damped, 2.0, -3.0)) == (168.0, 0.0)
    assert kernels.damper_force(damped, 2.0, 0.0) == 0.0
    damped[STYLE] = RETARDED
    # c F' d' = 7 x 40 x 3
    assert kernels.damper_force(damped, 2.0, 3.0) == 840.0
    assert kernels.push(damped, 2.0, 3.0, 9.0) == pytest.approx(1 + 840 / 40, rel=1e-15)
    damped[STYLE] = PULLS
    assert kernels.push(damped, 2.0, -300.0, 9.0) == 1.0
    # a linear damper at first touch acts on a depth of nearly nothing
    damped[STYLE], damped[DAMPER_EXPONENT] = NEVER_PULLS, 0.0
    assert kernels.damper_force(damped, 0.0, 3.0) == 21.0
    assert kernels.push(damped, 0.0, -1.0, 9.0) < -1e50
