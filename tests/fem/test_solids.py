"""Points of a solid: J2 plasticity (Simo & Hughes 1998, ch. 2 and 3), Johnson & Cook 1983, Zerilli & Armstrong 1987."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave.base.errors import InputError
from strikewave.fem._layout import LANES
from strikewave.fem.solids import Bilinear, Elastic, JohnsonCook, ZerilliArmstrong, pressure, von_mises

from .driven import CUBE, XX, XY, YY, Points, elements, mesh_of, moved

E, NU, YIELD, TANGENT = 200e9, 0.3, 400e6, 10e9
ELASTIC = (7800.0, E, NU)
OFHC = {"A": 90e6, "B": 292e6, "n": 0.31, "C": 0.025, "m": 1.09, "melting_temperature": 1356.0}
"""OFHC copper, Johnson & Cook 1983, table 1."""
COPPER = (8960.0, 124e9, 0.34)
FACE_CENTRED = {"C0": 65e6, "C2": 890e6, "C3": 0.0028, "C4": 0.000115}
"""OFHC copper, Zerilli & Armstrong 1987."""
BODY_CENTRED = {"C0": 65e6, "C1": 1033e6, "C3": 0.00698, "C4": 0.000415, "C5": 266e6, "n": 0.289}
"""Of the size of an iron's: any numbers serve where a formula is checked."""


def bilinear(kinematic=0.0, tangent=TANGENT):
    return Bilinear(*ELASTIC, YIELD, tangent, kinematic)


def pulled(points, axial):
    """Add axial strain with free sides: the sideways strain at which the sideways stress vanishes, by the secant rule."""

    def at(sideways):
        tried = points.copy()
        tried.move(np.stack([axial, sideways, sideways, *(3 * [np.zeros(LANES)])], axis=1))
        return tried

    first, second = -NU * axial, -0.5 * axial
    before, after = at(first).stress[:, YY], at(second).stress[:, YY]
    for _ in range(20):
        slope = (after - before) / (second - first)
        first, before, second = second, after, second - after / slope
        after = at(second).stress[:, YY]
        if np.abs(after).max() < 1e-9 * YIELD:
            break
    return at(second)


def path(points, strains):
    """Pull to each of some strains in turn; return the axial stresses."""
    stresses, now = [], 0.0
    for strain in strains:
        points = pulled(points, np.full(LANES, strain - now))
        stresses.append(points.stress[0, XX])
        now = strain
    return np.array(stresses)


@pytest.mark.parametrize("kinematic", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_uniaxial_stress_follows_the_bilinear_curve(kinematic, sign):
    """Radial return is exact on a straight path with linear hardening: the tolerance is that of the secant rule."""
    first = YIELD / E
    strains = sign * first * np.array([0.5, 0.9, 1.3, 2.0, 7.0, 20.0])
    size = np.abs(strains)
    expected = sign * np.where(size < first, E * size, YIELD + TANGENT * (size - first))
    np.testing.assert_allclose(path(Points(bilinear(kinematic)), strains), expected, rtol=1e-9)


@pytest.mark.parametrize("kinematic", [0.0, 0.4, 1.0])
def test_bauschinger_reverse_yield_lies_twice_the_radius_below(kinematic):
    """Yield comes back at sigma_1 - 2 (sigma_y + (1 - k) H p): for k = 1 at sigma_1 - 2 sigma_y, for k = 0 at -sigma_1."""
    solid = bilinear(kinematic)
    top = 10.0 * YIELD / E
    peak = YIELD + TANGENT * (top - YIELD / E)
    p = top - peak / E
    width = 2.0 * (YIELD + (1.0 - kinematic) * solid.plastic_modulus * p) / E
    back = np.array([0.3, 0.99, 1.2, 3.0]) * width
    expected = np.where(back < width, peak - E * back, peak - E * width - TANGENT * (back - width))
    np.testing.assert_allclose(path(Points(solid), [top, *(top - back)])[1:], expected, rtol=1e-8, atol=1e-9 * YIELD)


def test_shear_yields_at_sigma_y_over_root_3_and_hardens_by_g_h_over_3g_h():
    solid, points = bilinear(), Points(bilinear())
    shear, hardening = solid.shear_modulus, solid.plastic_modulus
    first = YIELD / np.sqrt(3.0) / shear
    points.move([0, 0, 0, 0.5 * 4.0 * first, 0, 0])
    expected = YIELD / np.sqrt(3.0) + shear * hardening / (3.0 * shear + hardening) * 3.0 * first
    assert points.stress[0, XY] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("kinematic", [0.0, 0.4, 1.0])
def test_consistency_flow_and_works_on_any_path(rng, kinematic):
    """|sigma - alpha| = sigma_y + (1 - k) H p where it yields, the volume stays elastic, internal = elastic + plastic."""
    solid, points = bilinear(kinematic), Points(bilinear(kinematic))
    widening = (1.0 - kinematic) * solid.plastic_modulus
    bulk, shear = solid.bulk_modulus, solid.shear_modulus
    swollen, internal, plastic, flowed = np.zeros(LANES), np.zeros(LANES), np.zeros(LANES), np.zeros(LANES)
    for _ in range(60):
        strain = rng.standard_normal((LANES, 6)) * 1.0 * YIELD / E
        old, p = points.stress.copy(), points.plastic_strain.copy()
        points.move(strain)
        stress, limit = points.stress, YIELD + widening * points.plastic_strain
        shifted = stress - points.back_stress
        yielded = points.plastic_strain > p
        np.testing.assert_allclose(von_mises(shifted)[yielded], limit[yielded], rtol=1e-12)
        assert (von_mises(shifted) <= limit * (1.0 + 1e-12)).all()
        swollen += strain[:, :3].sum(axis=1)
        np.testing.assert_allclose(stress[:, :3].sum(axis=1), 3.0 * bulk * swollen, rtol=1e-10, atol=1e-6)
        internal += points.work
        plastic += points.plastic_work
        change = stress - old
        mean = change[:, :3].sum(axis=1, keepdims=True) / 3.0
        elastic = change / (2.0 * shear)
        elastic[:, :3] += mean * (1.0 / (3.0 * bulk) - 1.0 / (2.0 * shear))
        twice = np.array([1, 1, 1, 2, 2, 2])
        flowed += np.sum(twice * 0.5 * (stress + old) * (strain - elastic), axis=1)
    assert yielded.any()
    stored = von_mises(stress) ** 2 / (6.0 * shear) + (stress[:, :3].sum(axis=1) / 3.0) ** 2 / (2.0 * bulk)
    np.testing.assert_allclose(internal, stored + plastic, rtol=1e-12)
    np.testing.assert_allclose(plastic, flowed, rtol=1e-9)


def test_plastic_work_of_a_bar_is_sigma_y_p_and_half_h_p_squared():
    """A step ends just at yield, so that the rule of the mean stress is exact."""
    points, plastic, now = Points(bilinear()), 0.0, 0.0
    for strain in YIELD / E * np.array([1.0, 3.0, 10.0]):
        points = pulled(points, np.full(LANES, strain - now))
        plastic, now = plastic + points.plastic_work[0], strain
    p = points.plastic_strain[0]
    assert p == pytest.approx(now - points.stress[0, XX] / E, rel=1e-9)
    assert plastic == pytest.approx(YIELD * p + 0.5 * bilinear().plastic_modulus * p**2, rel=1e-8)


def test_bent_path_converges_to_the_rate_equations_by_the_first_order():
    """From pure tension at yield the strain rate turns to shear; the rate equations are integrated by DOP853.

    Radial return is the backward Euler rule: the error halves with the step.
    """
    solid = bilinear(kinematic=0.3)
    shear, hardening, moving = solid.shear_modulus, solid.plastic_modulus, 0.3 * solid.plastic_modulus
    twice = np.array([1, 1, 1, 2, 2, 2])
    begin = YIELD / (2.0 * shear) * np.array([2, -1, -1, 0, 0, 0]) / 3.0
    length = 4.0 * YIELD / E

    def rate_of_strain(t):
        return length * (
            np.cos(1.4 * t) * np.array([1, -0.5, -0.5, 0, 0, 0]) + np.sin(1.4 * t) * np.array([0, 0, 0, 1, 0, 0])
        )

    def rates(t, y):
        n = y[:6] - y[6:]
        n = n / np.sqrt(np.sum(twice * n * n))
        flow = np.sum(twice * n * rate_of_strain(t)) / (1.0 + hardening / (3.0 * shear))
        return np.concatenate([2.0 * shear * (rate_of_strain(t) - flow * n), 2.0 / 3.0 * moving * flow * n])

    exact = solve_ivp(rates, (0.0, 1.0), [*(2.0 * shear * begin), *np.zeros(6)], "DOP853", rtol=1e-12, atol=1e-3).y[
        :, -1
    ]
    errors = []
    for steps in (20, 40, 80, 160):
        points = Points(solid)
        points.move(begin)
        for k in range(steps):
            a, b = 1.4 * k / steps, 1.4 * (k + 1) / steps
            straight, across = (np.sin(b) - np.sin(a)) / 1.4, (np.cos(a) - np.cos(b)) / 1.4
            points.move(length * np.array([straight, -0.5 * straight, -0.5 * straight, across, 0, 0]))
        errors.append(np.abs(points.stress[0] - exact[:6]).max() / YIELD)
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[-1] < 3e-3
    np.testing.assert_allclose(orders, 1.0, atol=0.1)


# Johnson & Cook


def flow_stress(solid, p, rate, warm):
    """The formula, written from the paper."""
    softening = 1.0 - (warm / (solid.melting_temperature - solid.room_temperature)) ** solid.m
    fast = 1.0 + solid.C * np.log(np.maximum(rate / solid.reference_rate, 1.0))
    return (solid.A + solid.B * p**solid.n) * fast * softening


@pytest.mark.parametrize("step", [1e3, 1.0, 1e-3, 1e-6, 1e-9])
def test_flow_stress_is_the_published_formula_over_strain_rate_and_temperature(step):
    """Strains from 1e-3 to 3 in steps of five lengths, which gives rates from 1e-6 to 1e9 /s, 0 to 1058 K above room.

    1e-9: the increment is found to 1e-12 of itself at least, and the stress is the trial stress less 3 G dp.
    """
    solid, points = JohnsonCook(*COPPER, **OFHC), Points(JohnsonCook(*COPPER, **OFHC))
    points.heat[:] = warm = np.tile([0.0, 10.0, 500.0, 1058.0], LANES // 4)
    points.plastic_strain[:] = np.repeat([0.0, 1e-6, 1e-3, 0.01, 0.05, 0.3, 1.0, 3.0], LANES // 8)
    for length in (0.1, 5e-3, 0.01, 2e-4, 1.0):
        before = points.plastic_strain.copy()
        points.move([0, 0, 0, length, 0, 0], step)
        dp = points.plastic_strain - before
        flowing = dp > 0.0
        expected = flow_stress(solid, points.plastic_strain, dp / step, warm)
        np.testing.assert_allclose(von_mises(points.stress)[flowing], expected[flowing], rtol=1e-9)
        assert (von_mises(points.stress) <= expected * (1.0 + 1e-9)).all()
        assert flowing.sum() > LANES // 2


def test_copper_at_a_strain_of_a_tenth_flows_at_233_mpa():
    """90 + 292 0.1^0.31 = 233.0 MPa at the reference rate and room temperature."""
    solid, points = JohnsonCook(*COPPER, **OFHC), Points(JohnsonCook(*COPPER, **OFHC))
    points.plastic_strain[:] = 0.1
    points.move([0, 0, 0, 1.001 * 233.02e6 / (2.0 * np.sqrt(3.0) * solid.shear_modulus), 0, 0], 1e6)
    assert points.plastic_strain[0] > 0.1
    assert von_mises(points.stress[0]) / 1e6 == pytest.approx(90.0 + 292.0 * 0.1**0.31, rel=1e-5)
    assert von_mises(points.stress[0]) / 1e6 == pytest.approx(233.0, abs=0.05)


def test_molten_solid_bears_no_shear():
    points = Points(JohnsonCook(*COPPER, **OFHC))
    points.move([1e-3, -1e-3, 0, 2e-3, 0, 0], 1e-6)
    points.heat[:] = 1356.0 - 293.0
    points.move([1e-3, 2e-3, 0, 2e-3, 0, 0], 1e-6)
    assert np.abs(von_mises(points.stress)).max() < 1e-6
    assert points.stress[0, :3].sum() == pytest.approx(3.0 * Elastic(*COPPER).bulk_modulus * 3e-3, rel=1e-12)


def johnson_cook_speed(solid, q, p, warm):
    """The rate of plastic strain at which the formula gives the stress q, /s."""
    still = flow_stress(solid, p, 1.0, warm)
    return np.exp(min((q / still - 1.0) / solid.C, 40.0)) if q > still else 0.0


def face_centred_speed(solid, q, p, warm):
    """The same of Zerilli & Armstrong's, C1 = C5 = 0: a power law of the stress above C0."""
    if q <= solid.C0:
        return 0.0
    temperature = solid.room_temperature + warm
    activation = np.log((q - solid.C0) / (solid.C2 * np.sqrt(p))) / temperature + solid.C3
    return np.exp(min(activation / solid.C4, 40.0)) if activation > 0.0 else 0.0


@pytest.mark.parametrize(
    ("solid", "speed"),
    [
        (JohnsonCook(*COPPER, **OFHC, specific_heat=383.0), johnson_cook_speed),
        (ZerilliArmstrong(*COPPER, **FACE_CENTRED, specific_heat=383.0), face_centred_speed),
    ],
    ids=["johnson-cook", "zerilli-armstrong"],
)
def test_plastic_work_heats_the_solid_as_its_rate_equations_say(solid, speed):
    """Copper sheared at 1e4 /s (equivalent) to a strain of 0.5: stress and temperature by LSODA."""
    heating = solid.heat_fraction / (solid.density * solid.specific_heat)
    rate, end = 1e4, 0.5

    def rates(t, y):
        q, p, warm = y[0], max(y[1], 1e-12), max(y[2], 0.0)
        flowing = speed(solid, q, p, warm)
        return [3.0 * solid.shear_modulus * (rate - flowing), flowing, heating * q * flowing]

    begin = [65e6, 1e-9, 0.0]
    exact = solve_ivp(rates, (0.0, end / rate), begin, "LSODA", rtol=1e-9, atol=[1.0, 1e-12, 1e-7]).y[:, -1]
    errors = []
    for steps in (400, 800, 1600):
        points = Points(solid)
        points.move([0, 0, 0, 65e6 / (2.0 * np.sqrt(3.0) * solid.shear_modulus), 0, 0], 1.0)
        plastic = 0.0
        for _ in range(steps):
            points.move([0, 0, 0, 0.5 * np.sqrt(3.0) * end / steps, 0, 0], end / rate / steps)
            plastic += points.plastic_work[0]
        assert points.heat[0] == pytest.approx(heating * plastic, rel=1e-12)
        errors.append([abs(von_mises(points.stress[0]) / exact[0] - 1.0), abs(points.heat[0] / exact[2] - 1.0)])
    stress, warmth = np.transpose(errors)
    assert stress[-1] < 2e-4
    np.testing.assert_allclose(np.log2(stress[:-1] / stress[1:]), 1.0, atol=0.1)
    assert warmth.max() < 1.2e-4


# Zerilli & Armstrong


@pytest.mark.parametrize("constants", [FACE_CENTRED, BODY_CENTRED], ids=["face-centred", "body-centred"])
@pytest.mark.parametrize("step", [1e3, 1e-3, 1e-6, 1e-9])
def test_flow_stress_is_zerilli_and_armstrongs_formula(step, constants):
    """Strains from 1e-6 to 3 at rates from 1e-6 to 1e9 /s, 293 to 1351 K; as exact as Johnson and Cook's."""
    solid = ZerilliArmstrong(*COPPER, **constants)
    points = Points(solid)
    points.heat[:] = warm = np.tile([0.0, 10.0, 500.0, 1058.0], LANES // 4)
    points.plastic_strain[:] = np.repeat([0.0, 1e-6, 1e-3, 0.01, 0.05, 0.3, 1.0, 3.0], LANES // 8)
    for length in (0.1, 5e-3, 0.01, 2e-4, 1.0):
        before = points.plastic_strain.copy()
        points.move([0, 0, 0, length, 0, 0], step)
        p, temperature = points.plastic_strain, 293.0 + warm
        dp = p - before
        active = np.exp(temperature * (solid.C4 * np.log(np.maximum(dp / step, 1.0)) - solid.C3))
        expected = solid.C0 + (solid.C1 + solid.C2 * np.sqrt(p)) * active + solid.C5 * p**solid.n
        flowing = dp > 0.0
        np.testing.assert_allclose(von_mises(points.stress)[flowing], expected[flowing], rtol=1e-9)
        assert (von_mises(points.stress) <= expected * (1.0 + 1e-9)).all()
        assert flowing.sum() > LANES // 2


def test_a_preheated_bar_begins_as_hot_as_it_is_said():
    """Elements of a preheated solid yield at the stress of points of that temperature."""
    solid = JohnsonCook(*COPPER, **OFHC, preheat=400.0)
    found, points = elements(mesh_of(CUBE, np.arange(8)[None]), solid), Points(solid)
    points.heat[:] = 400.0
    sheared = CUBE + 0.02 * np.outer(CUBE[:, 1], [1.0, 0.0, 0.0])
    moved(found, CUBE, sheared, 1e-4)
    points.move([0, 0, 0, 0.01, 0, 0], 1e-4)
    assert von_mises(found.cell_values(1)[0][0]) == pytest.approx(von_mises(points.stress[0]), rel=1e-3)
    assert von_mises(points.stress[0]) < 0.8 * flow_stress(solid, points.plastic_strain[0], 100.0, 0.0)


def test_johnson_cook_without_rate_and_heat_is_the_bilinear_solid(rng):
    """n = 1, C = 0: the same steps give the same stress."""
    plastic = bilinear().plastic_modulus
    first, second = Points(bilinear()), Points(JohnsonCook(*ELASTIC, A=YIELD, B=plastic, n=1.0))
    for _ in range(30):
        strain = rng.standard_normal((LANES, 6)) * YIELD / E
        first.move(strain, 1e-6)
        second.move(strain, 1e-6)
        np.testing.assert_allclose(second.stress, first.stress, rtol=1e-9, atol=1e-9 * YIELD)


# Moduli, strengths and ranges


@pytest.mark.parametrize("ratio", [0.0, 0.12, 0.31, 0.49])
def test_moduli_of_an_isotropic_solid_belong_together(ratio):
    """Identities of elasticity with two other moduli each (Landau & Lifshitz, Theory of Elasticity, section 5)."""
    solid = Elastic(7300.0, 190e9, ratio)
    bulk, shear = solid.bulk_modulus, solid.shear_modulus
    assert 9.0 * bulk * shear / (3.0 * bulk + shear) == pytest.approx(190e9, rel=1e-14)
    assert (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear) == pytest.approx(ratio, abs=1e-14)
    wave = 190e9 * (1.0 - ratio) / ((1.0 + ratio) * (1.0 - 2.0 * ratio))
    assert solid.wave_modulus == pytest.approx(wave, rel=1e-13)
    assert solid.wave_speed == pytest.approx(math.sqrt(wave / 7300.0), rel=1e-13)
    assert solid.strength == math.inf
    hard = Bilinear(7300.0, 190e9, ratio, 500e6, 7e9)
    assert 1.0 / (1.0 / 190e9 + 1.0 / hard.plastic_modulus) == pytest.approx(7e9, rel=1e-13)
    assert hard.strength == 500e6


def test_strengths_of_heated_solids_are_their_flow_stress_at_a_strain_of_one():
    """At room temperature and the reference rate: A + B, and C0 + (C1 + C2) exp(-C3 T) + C5 with exp(-0.6)."""
    assert JohnsonCook(*COPPER, **OFHC).strength == 382e6
    solid = ZerilliArmstrong(*COPPER, C0=10e6, C1=200e6, C2=300e6, C3=0.002, C5=7e6, room_temperature=300.0)
    assert solid.strength == pytest.approx((17.0 + 500.0 * 0.548811636094) * 1e6, rel=1e-12)


ALLOWED = [
    (Elastic, (1.0, 1.0, 0.0), {}, {"poissons_ratio": 0.499}),
    (Bilinear, ELASTIC, {"yield_strength": 1e6}, {"tangent_modulus": 0.0, "kinematic": 1.0}),
    (JohnsonCook, COPPER, OFHC, {"B": 0.0, "C": 0.0, "heat_fraction": 0.0, "preheat": 0.0}),
    (ZerilliArmstrong, COPPER, {"C0": 0.0, "C1": 1.0}, {"C2": 0.0, "n": 0.009, "reference_rate": 0.009}),
]
REFUSED = [
    (Elastic, (0.0, 1.0, 0.3), {}, "density"),
    (Elastic, (1.0, math.inf, 0.3), {}, "youngs_modulus"),
    (Elastic, (1.0, 0.0, 0.3), {}, "youngs_modulus"),
    (Elastic, (1.0, 1.0, -0.005), {}, "poissons_ratio"),
    (Elastic, (1.0, 1.0, 0.5), {}, "poissons_ratio"),
    (Bilinear, ELASTIC, {"yield_strength": 0.0}, "yield_strength"),
    (Bilinear, ELASTIC, {"tangent_modulus": -0.005}, "tangent_modulus"),
    (Bilinear, ELASTIC, {"tangent_modulus": E}, "tangent_modulus"),
    (Bilinear, ELASTIC, {"kinematic": 1.005}, "kinematic"),
    (Bilinear, ELASTIC, {"kinematic": -0.005}, "kinematic"),
    *(
        (JohnsonCook, COPPER, OFHC | {name: 0.0}, name)
        for name in ("A", "n", "m", "reference_rate", "room_temperature")
    ),
    *((JohnsonCook, COPPER, OFHC | {name: -0.005}, name) for name in ("B", "C", "heat_fraction", "preheat")),
    (JohnsonCook, COPPER, OFHC | {"specific_heat": 0.0}, "specific_heat"),
    (JohnsonCook, COPPER, OFHC | {"melting_temperature": 293.0}, "melting_temperature"),
    *((ZerilliArmstrong, COPPER, FACE_CENTRED | {f"C{k}": -0.005}, f"C{k}") for k in range(6)),
    (ZerilliArmstrong, COPPER, FACE_CENTRED | {"n": 0.0}, "n"),
    (ZerilliArmstrong, COPPER, {"C0": 0.0, "C2": 1e6}, "C0"),
]


@pytest.mark.parametrize(("law", "first", "rest", "field"), REFUSED)
def test_a_solid_out_of_range_is_refused_by_name(law, first, rest, field):
    with pytest.raises(InputError) as error:
        law(*first, **rest)
    assert error.value.field == field


@pytest.mark.parametrize(("law", "first", "rest", "edge"), ALLOWED)
def test_numbers_at_the_ends_of_their_ranges_are_taken(law, first, rest, edge):
    first = (*first[:2], edge["poissons_ratio"]) if "poissons_ratio" in edge else first
    solid = law(*first, **(rest | {name: value for name, value in edge.items() if name != "poissons_ratio"}))
    assert all(getattr(solid, name) == value for name, value in edge.items())


def test_von_mises_stress_and_pressure_are_those_of_the_principal_stresses(rng):
    stress = rng.uniform(-1.0, 1.0, (5, 4, 6))
    a, b, c = np.moveaxis(np.linalg.eigvalsh(stress[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]), -1, 0)
    expected = np.sqrt(0.5 * ((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2))
    np.testing.assert_allclose(von_mises(stress), expected, rtol=1e-12)
    np.testing.assert_allclose(pressure(stress), -(a + b + c) / 3.0, atol=1e-14)
