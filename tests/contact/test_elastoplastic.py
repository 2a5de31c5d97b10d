"""Elastic-plastic contacts: closed forms of Thornton and of the line, unloading, what stays, and the next blow."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from strikewave.base.constants import material
from strikewave.contact import (
    Chain,
    ChainContact,
    Contact,
    Geometry,
    PressureCap,
    contact_modulus,
    exact,
    hertz,
    impact_history,
    johnson,
    line_cap,
    line_yield_pressure,
    palmgren,
    point_cap,
    point_yield_pressure,
    simulate,
    slow_force,
    solve_impact,
    thornton_restitution,
    yield_speed,
)
from strikewave.contact.elastoplastic import LARGEST_PRESSURE, cap_law_of, cap_of, first_yield, spot_after

STEEL = material("65Mn")
MODULUS = contact_modulus(STEEL, STEEL)
RADIUS, LENGTH, PRESSURE = 0.01, 0.04, 1.2e9
SPHERE = hertz(STEEL, STEEL, RADIUS).contact(cap=point_cap(STEEL, STEEL, RADIUS, math.inf, PRESSURE))
LINE_CAP = line_cap(STEEL, STEEL, RADIUS, math.inf, LENGTH, PRESSURE)
LINES = {
    "palmgren": palmgren(STEEL, STEEL, LENGTH).contact(cap=LINE_CAP),
    "johnson": johnson(STEEL, STEEL, RADIUS, math.inf, LENGTH, datum_depth=0.03).contact(cap=LINE_CAP),
}
NUMBERS = (
    *("restitution", "max_indentation", "peak_force", "duration", "energy_lost", "deepest", "residual_indentation"),
    *("flattening", "peak_time", "turning_time"),
)
EVERY = {"thornton": SPHERE, **LINES}


def test_thornton_1997_yield_load_depth_and_speed():
    """d_y = (pi p/2E*)^2 R, F_y = (2/3) pi p R d_y, v_y = 3.194 sqrt(p^5 R^3/(E*^4 m)) to its four digits."""
    depth = (math.pi * PRESSURE / (2 * MODULUS)) ** 2 * RADIUS
    load = 2 / 3 * math.pi * PRESSURE * RADIUS * depth
    assert float(SPHERE.cap.yield_load) == pytest.approx(load, rel=1e-12)
    assert float(slow_force(SPHERE, depth)) == pytest.approx(load, rel=1e-12)
    speed = 3.194 * math.sqrt(PRESSURE**5 * RADIUS**3 / (MODULUS**4 * 0.03))
    assert float(yield_speed(SPHERE, 0.03)) == pytest.approx(speed, rel=1e-4)


def test_thornton_1997_loads_on_a_straight_line():
    """F = F_y + pi p R (d - d_y) beyond yield."""
    yield_depth = (math.pi * PRESSURE / (2 * MODULUS)) ** 2 * RADIUS
    d = yield_depth * np.array([1.0, 2.0, 10.0, 100.0])
    expected = float(SPHERE.cap.yield_load) + math.pi * PRESSURE * RADIUS * (d - yield_depth)
    assert slow_force(SPHERE, d) == pytest.approx(expected, rel=1e-12)


def test_thornton_1997_unloads_on_the_radius_that_has_flattened():
    """F = (4/3) E* sqrt(R_p) (d - d_r)^1.5 with R_p = R F_e/F, F_e = (4/3) E* sqrt(R) D^1.5, and d_r from F(D) = F."""
    deepest = 50e-6
    force = float(slow_force(SPHERE, deepest))
    elastic = 4 / 3 * MODULUS * math.sqrt(RADIUS) * deepest**1.5
    k = 4 / 3 * MODULUS * math.sqrt(RADIUS * elastic / force)
    left = deepest - (force / k) ** (2 / 3)
    d = np.linspace(0, deepest, 41)
    assert slow_force(SPHERE, d, deepest) == pytest.approx(
        k * np.maximum(d - left, 0) ** 1.5, rel=1e-9, abs=1e-9 * force
    )


@pytest.mark.parametrize("ratio", [1.01, 1.5, 5.0, 20.0, 200.0])
def test_thornton_1997_restitution_comes_out_of_the_motion(ratio):
    """e(v/v_y) in closed form; the integrator's 1e-7, below v_y exactly 1."""
    speed = ratio * float(yield_speed(SPHERE, 0.03))
    blow = solve_impact(SPHERE, 0.03, np.inf, speed)
    assert float(blow.restitution) == pytest.approx(float(thornton_restitution(ratio)), rel=2e-7)
    slow = solve_impact(SPHERE, 0.03, np.inf, 0.99 * speed / ratio)
    assert float(slow.restitution) == pytest.approx(1.0, abs=2e-8)
    assert float(slow.residual_indentation) == 0.0


def truncated_line(half_width):
    """The Hertz pressure of a line cut off at PRESSURE and summed up over the width, N: by quadrature."""
    whole = quad(
        lambda x: min(MODULUS / (2 * RADIUS) * math.sqrt(half_width**2 - x**2), PRESSURE),
        -half_width,
        half_width,
        points=[0],
        limit=200,
    )
    return LENGTH * whole[0]


@pytest.mark.parametrize("law", sorted(LINES))
@pytest.mark.parametrize("over", [0.5, 1.0, 1.3, 4.0, 100.0])
def test_line_law_is_the_hertz_pressure_cut_off_at_its_cap(law, over):
    """At the depth of the elastic force F_e the half width is sqrt(4 F_e R/(pi E* h)); the quadrature's 1e-7."""
    contact = LINES[law]
    elastic = over * float(LINE_CAP.yield_load)
    bare = johnson(STEEL, STEEL, RADIUS, math.inf, LENGTH, 0.03) if law == "johnson" else None
    depth = float(bare.indentation(elastic)) if bare else (elastic / contact.stiffness) ** (1 / contact.exponent)
    half_width = math.sqrt(4 * elastic * RADIUS / (math.pi * MODULUS * LENGTH))
    assert float(slow_force(contact, depth)) == pytest.approx(truncated_line(half_width), rel=1e-6)
    # the mean pressure rises from pi p/4 at yield and never reaches the cap
    mean = float(slow_force(contact, depth)) / (2 * half_width * LENGTH)
    assert mean < PRESSURE
    if over >= 1.0:
        assert mean >= math.pi / 4 * PRESSURE * (1 - 1e-12)
    if over == 100.0:
        assert mean > 0.99 * PRESSURE


def test_line_yield_of_65mn():
    """3.2, 6.5, 13 kN for 40 mm of 65Mn at nose radii of 5, 10, 20 mm, with p0 = 1.778 sigma_y (nu 0.288): printed digits."""
    pressure = line_yield_pressure(STEEL, 430e6)
    for radius, load in ((0.005, 3.2e3), (0.010, 6.5e3), (0.020, 13e3)):
        assert float(line_cap(STEEL, STEEL, radius, math.inf, LENGTH, pressure).yield_load) == pytest.approx(
            load, rel=0.02
        )


@pytest.mark.parametrize(("nu", "factor"), [(0.288, 1.778), (0.30, 1.79), (0.33, 1.828)])
def test_yield_pressure_of_a_line_against_its_stress_field(nu, factor):
    """Largest von Mises stress below a Hertz line (Johnson 1985, eq. 4.49); Green's fit holds it to 0.3 %."""

    class Body:
        youngs_modulus, poissons_ratio = 1.0, nu

    z = np.linspace(0.0, 3.0, 30001)
    root = np.sqrt(1 + z**2)
    along, down = -((1 + 2 * z**2) / root - 2 * z), -1 / root
    across = nu * (along + down)
    mises = np.sqrt(0.5 * ((along - down) ** 2 + (down - across) ** 2 + (across - along) ** 2))
    assert line_yield_pressure(Body(), 1.0) == pytest.approx(1 / mises.max(), rel=3e-3)
    assert line_yield_pressure(Body(), 1.0) == pytest.approx(factor, abs=6e-3)


@pytest.mark.parametrize("nu", [0.1, 0.288, 0.4])
def test_yield_pressure_of_a_sphere_against_its_stress_field(nu):
    """Largest von Mises stress on the axis below a Hertz point (Johnson 1985, eq. 3.45); Green's fit holds it to 0.1 %."""

    class Body:
        youngs_modulus, poissons_ratio = 1.0, nu

    z = np.linspace(1e-6, 3.0, 30001)
    radial = -(1 + nu) * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)
    mises = np.abs(radial + 1 / (1 + z**2))
    assert point_yield_pressure(Body(), 1.0) == pytest.approx(1 / mises.max(), rel=1e-3)


@pytest.mark.parametrize("name", sorted(EVERY))
@settings(max_examples=20)
@given(speed=st.floats(0.05, 20.0), mass=st.floats(0.01, 5.0), e=st.floats(0.3, 1.0))
def test_second_blow_on_the_same_spot_loses_less(name, speed, mass, e):
    """Equal blows: each loses less than the one before, flattens on, and leaves more; the energy is in the history."""
    cap = EVERY[name].cap
    base = EVERY[name]
    contact = type(base)(
        *([base.slope, base.load] if hasattr(base, "slope") else [base.stiffness, base.exponent]),
        float(exact(e)),
        cap=cap,
    )
    blows, deepest = [], 0.0
    for _ in range(3):
        blows.append(solve_impact(contact, mass, np.inf, speed, deepest))
        deepest = blows[-1].deepest
    lost = [float(blow.energy_lost) for blow in blows]
    spent = 0.5 * mass * speed**2
    assert lost[0] >= lost[1] - 1e-6 * spent
    assert lost[1] >= lost[2] - 1e-6 * spent
    left = [float(blow.residual_indentation) for blow in blows]
    assert left == sorted(left)
    assert [float(b.flattening) for b in blows] == sorted(float(b.flattening) for b in blows)
    if float(blows[0].flattening) > 1.05:
        assert lost[1] < lost[0]


@pytest.mark.parametrize("name", sorted(EVERY))
def test_work_of_the_contact_force_is_the_energy_lost(name):
    """Area of the force-indentation loop, by the trapezoidal rule on 20 001 samples: 1e-6 is its own error."""
    blow = solve_impact(EVERY[name], 0.1, np.inf, 3.0)
    history = impact_history(blow, np.linspace(0.0, float(blow.duration), 20001))
    area = np.trapezoid(history.force, history.indentation)
    assert area == pytest.approx(float(blow.energy_lost), rel=2e-6)
    assert history.force[-1] == pytest.approx(0.0, abs=1e-6 * float(blow.peak_force))
    assert history.indentation[-1] == pytest.approx(float(blow.residual_indentation), rel=1e-6)


@pytest.mark.parametrize("name", sorted(EVERY))
def test_chain_keeps_its_balance_and_its_memory(name):
    """Two bodies in a chain come out as by `solve_impact`; kinetic energy lost = energy booked in the link, to 1e-6."""
    blow = solve_impact(EVERY[name], 0.1, 0.3, 3.0)
    chain = Chain({"a": 0.1, "b": 0.3}, [ChainContact("a", "b", EVERY[name])])
    motion = simulate(chain, {}, {"a": 3.0}, 2 * float(blow.duration), tolerance=1e-9)
    v = motion.speeds(2 * float(blow.duration))
    assert v[1] - v[0] == pytest.approx(3.0 * float(blow.restitution), rel=1e-6)
    before, after = 0.5 * 0.1 * 9.0, 0.5 * (0.1 * v[0] ** 2 + 0.3 * v[1] ** 2)
    assert motion.dissipated()[0] == pytest.approx(before - after, rel=1e-6)
    assert motion.motion.end.memory[-2:] == pytest.approx([float(blow.deepest), float(blow.flattening)], rel=1e-6)


def test_contacts_of_one_spot_share_what_has_yielded_and_others_do_not():
    """Two strikers hit a wall one after the other; on the same spot the second finds the flattened one."""
    shared = []
    for spot in (1, 0):
        links = [ChainContact("first", "wall", SPHERE, spot=spot), ChainContact("second", "wall", SPHERE, spot=spot)]
        chain = Chain({"first": 0.1, "second": 0.1}, links, bases={"wall": 0.0})
        motion = simulate(chain, {"first": -1e-6, "second": -2e-3}, {"first": 3.0, "second": 3.0}, 1e-3)
        ends = motion.speeds(1e-3)
        shared.append(-ends / 3.0)
    once = solve_impact(SPHERE, 0.1, np.inf, 3.0)
    again = solve_impact(SPHERE, 0.1, np.inf, 3.0, once.deepest)
    assert shared[0] == pytest.approx([float(once.restitution), float(again.restitution)], rel=1e-6)
    assert shared[1] == pytest.approx([float(once.restitution)] * 2, rel=1e-6)


def test_a_cap_that_is_never_reached_changes_nothing():
    bare = Contact(SPHERE.stiffness, 1.5, 0.4)
    high = Contact(SPHERE.stiffness, 1.5, 0.4, cap=PressureCap(1e9, "point"))
    one, other = solve_impact(bare, 0.1, 0.2, 2.0), solve_impact(high, 0.1, 0.2, 2.0)
    for name in ("restitution", "max_indentation", "peak_force", "duration", "peak_time", "turning_time"):
        assert float(getattr(other, name)) == pytest.approx(float(getattr(one, name)), rel=1e-6), name
    assert float(other.flattening) == 1.0


def test_unknown_shape_and_bad_loads_are_refused():
    with pytest.raises(ValueError, match="did you mean"):
        solve_impact(Contact(1e9, 1.5, cap=PressureCap(1.0, "pont")), 1, 1, 1)
    with pytest.raises(ValueError, match="yield load must be positive"):
        solve_impact(Contact(1e9, 1.5, cap=PressureCap(-1.0, "point")), 1, 1, 1)
    with pytest.raises(ValueError, match="does not yield"):
        yield_speed(Contact(1e9, 1.5), 1.0)


def test_arrays_of_laws_and_indentations_broadcast():
    several = Contact(1.5e10, 1.5, cap=PressureCap(np.array([300.0, 600.0]), "point"))
    d = np.array([[5e-6], [20e-6], [50e-6]])
    assert slow_force(several, d).shape == (3, 2)
    assert slow_force(several, 20e-6)[1] == slow_force(Contact(1.5e10, 1.5, cap=PressureCap(600.0, "point")), 20e-6)
    assert slow_force(Contact(np.full(100_000, 1e9), 1.5), [1e-6]).shape == (100_000,)
    assert yield_speed(several, 0.03).shape == (2,)


def test_where_one_law_is_wanted_several_are_refused():
    with pytest.raises(ValueError, match="one contact law is wanted here, got 2"):
        Chain({"a": 1.0, "b": 1.0}, [ChainContact("a", "b", Contact([1e9, 1e12], 1.5))])


def test_a_cap_beyond_the_end_of_a_logarithmic_law_is_refused():
    law = johnson(STEEL, STEEL, RADIUS, math.inf, LENGTH, 0.03)
    cap = line_cap(STEEL, STEEL, RADIUS, math.inf, LENGTH, 1e12)
    with pytest.raises(ValueError, match="below the end of the logarithmic law"):
        solve_impact(law.contact(cap=cap), 0.2, np.inf, 1.0)


def test_a_shared_spot_never_forgets_its_deepest_blow():
    """A hard and a soft blow overlap on one spot; the soft one unloads last and must not undo the hard one's depth."""
    links = [ChainContact("hard", "wall", SPHERE, spot=1), ChainContact("soft", "wall", SPHERE, spot=1)]
    chain = Chain({"hard": 0.1, "soft": 1.0}, links, bases={"wall": 0.0})
    motion = simulate(chain, {}, {"hard": 3.0, "soft": 0.5}, 2e-3)
    depths = np.concatenate([record.memory[:, -4:-2] for record in motion.motion.records()])
    assert np.all(np.diff(depths, axis=0) >= 0.0)
    assert motion.motion.end.memory[-4] == motion.motion.end.memory[-3] == depths.max()


@pytest.mark.parametrize("name", sorted(EVERY))
def test_stored_energy_of_a_pressed_spot_is_the_area_under_its_unloading(name):
    """A chain that starts pressed to 0.9 D: the body leaves with that energy, to 1e-6; nothing yields on."""
    from strikewave.contact.chain import link_arrays, stored_energy

    contact, mass = EVERY[name], 0.1
    deepest = 3.0 * float(solve_impact(contact, mass, np.inf, 3.0).max_indentation)
    d = np.linspace(0.0, 0.9 * deepest, 200_001)
    force = slow_force(contact, d, deepest)
    links = link_arrays([ChainContact("a", "b", contact)], ["a", "b"])
    stored = stored_energy(links, np.array([0.9 * deepest, 0.0]), np.array([deepest]))
    assert stored == pytest.approx(np.trapezoid(force, d), rel=1e-6)


@pytest.mark.parametrize("name", sorted(EVERY))
def test_slope_on_the_way_back_is_the_derivative_of_the_force(name):
    contact, deepest = EVERY[name], 40e-6
    step = 1e-10
    for d in (25e-6, 39e-6):
        slope = (slow_force(contact, d + step, deepest) - slow_force(contact, d - step, deepest)) / (2 * step)
        assert spot_after(contact, d, deepest).stiffness == pytest.approx(float(slope), rel=1e-5)


def test_spot_that_a_blow_leaves_has_the_numbers_of_thornton_1997():
    """R_p/R = F_e/F, d_r = D (1 - R/R_p) and slope (3/2) K sqrt(R_p/R) sqrt(d - d_r), F_e = K D^1.5, F on the straight line."""
    deepest, k = 50e-6, 4 / 3 * MODULUS * math.sqrt(RADIUS)
    yields = (math.pi * PRESSURE / (2 * MODULUS)) ** 2 * RADIUS
    force = math.pi * PRESSURE * RADIUS * (deepest - yields / 3)
    flat = k * deepest**1.5 / force
    left = deepest * (1 - 1 / flat)
    pressed = 0.5 * (left + deepest)
    spot = spot_after(SPHERE, pressed, deepest)
    assert spot.flattening == pytest.approx(flat, rel=1e-12)
    assert spot.residual_indentation == pytest.approx(left, rel=1e-12)
    assert spot.stiffness == pytest.approx(1.5 * k * math.sqrt(flat * (pressed - left)), rel=1e-12)
    bare = spot_after(Contact(1e9, 2.0), 1e-6, 0.0)
    assert bare == (pytest.approx(2e3, rel=1e-13), 0.0, 1.0)


def test_green_2005_factors_of_first_yield_at_a_quarter_and_a_tenth():
    """Of a line 1/(1 - 2 nu) up to nu = 0.1938, where the stress on the surface decides; polynomials by hand at 1/4."""

    class Body:
        youngs_modulus, poissons_ratio = 1.0, 0.1

    assert line_yield_pressure(Body(), 3.0) == pytest.approx(3.75, rel=1e-14)
    Body.poissons_ratio = 0.1938
    assert line_yield_pressure(Body(), 1.0) == pytest.approx(1 / (1 - 2 * 0.1938), rel=1e-14)
    Body.poissons_ratio = 0.25
    assert line_yield_pressure(Body(), 2.0) == pytest.approx(2 * 1.726125, rel=1e-14)
    assert point_yield_pressure(Body(), 2.0) == pytest.approx(2 * 1.554295625, rel=1e-14)


def test_first_yield_is_that_of_the_weaker_body_in_the_shape_of_the_contact():
    soft, hard = material("45 steel"), material("17-4PH")
    sphere, line = Geometry(RADIUS), Geometry(RADIUS, length=LENGTH)
    for geometry, pressure_of, cap in (
        (sphere, point_yield_pressure, lambda p: point_cap(soft, hard, RADIUS, math.inf, p)),
        (line, line_yield_pressure, lambda p: line_cap(soft, hard, RADIUS, math.inf, LENGTH, p)),
    ):
        pressure = min(pressure_of(body, body.yield_strength) for body in (soft, hard))
        assert pressure == pressure_of(soft, soft.yield_strength)
        for pair in ((soft, hard), (hard, soft)):
            found = first_yield(*pair, geometry)
            assert found.pressure == pressure
            assert found.load == pytest.approx(float(cap(pressure).yield_load), rel=1e-14)
    # where one strength alone is known it decides; without any, or without a radius, there is none
    assert first_yield(soft, material("rubber"), sphere).pressure == point_yield_pressure(soft, soft.yield_strength)
    assert first_yield(material("rubber"), material("rubber"), sphere) is None
    assert first_yield(soft, hard, Geometry(length=LENGTH)) is None


def test_caps_have_the_shape_of_the_geometry_and_the_law_of_their_shape():
    point, line = (cap_of(STEEL, STEEL, Geometry(RADIUS, length=h), PRESSURE) for h in (None, LENGTH))
    assert point == point_cap(STEEL, STEEL, RADIUS, math.inf, PRESSURE)
    assert line == LINE_CAP
    assert (cap_law_of(point).name, cap_law_of(line).name) == ("thornton", "line")
    # 4.1 of Johnson 1985: F = pi R h p^2/E*
    assert float(line.yield_load) == pytest.approx(math.pi * RADIUS * LENGTH * PRESSURE**2 / MODULUS, rel=1e-14)
    with pytest.raises(ValueError, match="radii"):
        cap_of(STEEL, STEEL, Geometry(length=LENGTH), PRESSURE)
    assert float(point_cap(STEEL, STEEL, RADIUS, math.inf, LARGEST_PRESSURE).yield_load) > 0.0
    for wrong in (0.0, 1.001e15, math.nan):
        with pytest.raises(ValueError, match=r"positive and at most 1e\+15 Pa"):
            point_cap(STEEL, STEEL, RADIUS, math.inf, wrong)


def test_yield_speed_of_a_line_is_that_at_which_the_rebound_begins_to_lose():
    for contact in LINES.values():
        speed = float(yield_speed(contact, 0.1))
        assert float(solve_impact(contact, 0.1, np.inf, 0.999 * speed).residual_indentation) == 0.0
        assert float(solve_impact(contact, 0.1, np.inf, 1.001 * speed).residual_indentation) > 0.0


def test_energy_lost_of_a_sphere_is_that_of_the_closed_form_at_the_depth_it_reached():
    """W = int F over loading - that of Hertz unloading (2/5) F (D - d_r); the integrator's 1e-7."""
    blow = solve_impact(SPHERE, 0.1, np.inf, 3.0)
    deep = float(blow.max_indentation)
    yields = (math.pi * PRESSURE / (2 * MODULUS)) ** 2 * RADIUS
    load = float(SPHERE.cap.yield_load)
    force = load + math.pi * PRESSURE * RADIUS * (deep - yields)
    work = 0.4 * load * yields + 0.5 * (load + force) * (deep - yields)
    assert work == pytest.approx(0.5 * 0.1 * 9.0, rel=1e-6)
    assert float(blow.peak_force) == pytest.approx(force, rel=1e-7)
    back = 0.4 * force * (deep - float(blow.residual_indentation))
    assert float(blow.energy_lost) == pytest.approx(work - back, rel=1e-6)
    assert float(blow.deepest) == pytest.approx(deep, rel=1e-9)


def test_arrays_of_spots_hold_each_what_one_alone_holds():
    """Several depths and laws in one call: residual, flattening, force and yield speed of each row."""
    loads, speeds = np.array([300.0, 450.0, 600.0]), np.array([1.0, 3.0, 2.0])
    several = solve_impact(Contact(1.5e10, 1.5, 0.1, cap=PressureCap(loads, "point")), 0.03, np.inf, speeds)
    apart = yield_speed(Contact(1.5e10, 1.5, cap=PressureCap(loads, "point")), [0.1, 0.2, 0.3])
    for k, (load, speed) in enumerate(zip(loads, speeds, strict=True)):
        law = Contact(1.5e10, 1.5, 0.1, cap=PressureCap(load, "point"))
        one = solve_impact(law, 0.03, np.inf, speed)
        for name in NUMBERS:
            assert float(getattr(several, name)[k]) == float(getattr(one, name)), name
        assert apart[k] == pytest.approx(float(yield_speed(law, 0.1 * (k + 1))), rel=1e-15)


def test_thornton_1997_restitution_begins_at_the_speed_of_yield_and_ends_as_its_quarter_power():
    """1 up to v_y, below beyond; far beyond (6 sqrt(3)/5)^(1/2) [s/(2 sqrt(6/5))]^(1/4)."""
    assert thornton_restitution([0.0, 0.5, 1.0]) == pytest.approx([1.0, 1.0, 1.0], rel=1e-15)
    assert 0.999 < float(thornton_restitution(1.001)) < 1.0
    far = math.sqrt(1.2 * math.sqrt(3)) * (1e-8 / (2 * math.sqrt(1.2))) ** 0.25
    assert float(thornton_restitution(1e8)) == pytest.approx(far, rel=1e-7)
