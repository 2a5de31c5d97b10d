"""Cushions against closed forms, independent quadrature and an independent integrator; what stays, and wear."""

import inspect
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from strikewave.base.citations import CHECKED, QUOTED
from strikewave.base.errors import InputError, IntegrationError
from strikewave.contact import (
    Contact,
    Damper,
    HardeningContact,
    LogarithmicContact,
    exact,
    impact_history,
    slow_force,
    solve_impact,
)
from strikewave.contact.cushions import (
    Cushion,
    Pad,
    Wear,
    balance_of,
    carried,
    crush,
    cushion_law,
    cushion_laws,
    cushion_material,
    cushion_materials,
    elastomer,
    felt,
    foam,
    linear,
    power,
    repeated_blows,
    retardation_of,
    retarded,
    solid_strain,
    tangent,
)
from strikewave.contact.damping import cut_off_restitution
from strikewave.contact.law import PressureCap, check, check_end, indentation_under

AREA, THICKNESS, MASS, SPEED = 2e-3, 0.02, 3.0, 2.0
PAD = Pad(AREA, THICKNESS)
PROPERTIES = {
    "linear": {"modulus": 5e6},
    "power": {"stress": 20e6, "exponent": 2.5},
    "felt": {"stress": 20e6, "exponent": 2.5, "retardation": 0.0},
    "tangent": {"modulus": 2e6, "limit_strain": 0.8},
    "elastomer": {"modulus": 2e6, "compression_factor": 0.54},
    "foam": {"modulus": 5e6, "plateau": 0.25e6, "densification": 0.8},
    "crush": {"modulus": 50e6, "plateau": 0.25e6, "densification": 0.8},
}
STRAINS = np.array([1e-9, 1e-4, 0.004, 0.02, 0.06, 0.2, 0.4, 0.6, 0.75])


def stress(law, x):
    """The stress of each law at a strain, written down anew from its equation."""
    p = PROPERTIES[law]
    if law == "linear":
        return p["modulus"] * x
    if law in ("power", "felt"):
        return p["stress"] * x ** p["exponent"]
    if law == "tangent":
        end = p["limit_strain"]
        return 2 * p["modulus"] * end / math.pi * math.tan(math.pi * x / (2 * end))
    if law == "elastomer":
        shape = AREA / (2 * math.sqrt(math.pi * AREA) * THICKNESS)  # loaded area over that of the rim of the disc
        apparent = p["modulus"] * (1 + 2 * p["compression_factor"] * shape**2)
        return apparent / 3 * ((1 - x) ** -2 - (1 - x))
    end = p["densification"]
    if x < p["plateau"] / p["modulus"]:
        return p["modulus"] * x
    if x < end * (1 - 1 / 2.3):
        return p["plateau"]
    return p["plateau"] / 2.3 * end / (end - x)


def made(law, **changes):
    return cushion_law(law).function(PAD, **{**PROPERTIES[law], **changes})


@pytest.mark.parametrize("law", PROPERTIES)
def test_force_is_area_times_the_stress_of_the_law(law):
    """To rounding; at the smallest strain the neo-Hookean difference itself keeps only seven digits."""
    expected = [AREA * stress(law, float(x)) for x in STRAINS]
    assert slow_force(made(law), STRAINS * THICKNESS) == pytest.approx(
        expected, rel=2e-7 if law == "elastomer" else 1e-12
    )


@pytest.mark.parametrize("law", PROPERTIES)
def test_what_a_cushion_stores_is_the_integral_of_its_force(law):
    """Kinetic energy at the turning point, by quadrature of the stress; the integrator's 1e-7."""
    blow = solve_impact(made(law), MASS, math.inf, SPEED)
    p = PROPERTIES[law]
    corners = [p["plateau"] / p["modulus"], p["densification"] * (1 - 1 / 2.3)] if "plateau" in p else None
    deep = float(blow.max_indentation) / THICKNESS
    work = AREA * THICKNESS * quad(lambda x: stress(law, x), 0, deep, points=corners, epsabs=1e-13, limit=200)[0]
    assert work == pytest.approx(0.5 * MASS * SPEED**2, rel=1e-6)
    balance = balance_of(blow)
    assert float(balance.returned + balance.lost) == pytest.approx(float(balance.taken), rel=1e-12)
    if law != "crush":
        assert float(balance.stored) == pytest.approx(float(balance.taken), rel=1e-6)
        assert float(balance.lost) == pytest.approx(0.0, abs=1e-6 * float(balance.taken))
        assert float(balance.set) == 0.0


@pytest.mark.parametrize("law", [law for law in PROPERTIES if law != "crush"])
def test_the_motion_is_that_of_an_independent_integrator(law):
    """Duration and deepest compression with half the energy lost, against Radau with its own event."""
    chi, v = float(exact(math.sqrt(0.5))), SPEED
    blow = solve_impact(Cushion(law, PAD, PROPERTIES[law]).contact(restitution=math.sqrt(0.5)), MASS, math.inf, v)

    def rates(t, y):
        return [y[1], -AREA * stress(law, max(y[0], 0.0) / THICKNESS) * (1 + chi * y[1] / v) / MASS]

    def parts(t, y):
        return y[0] + 1e-15 * (y[1] > 0)

    def turns(t, y):
        return y[1]

    parts.terminal, parts.direction = True, -1
    motion = solve_ivp(rates, (0, 1), [0, v], "Radau", events=(parts, turns), rtol=1e-9, atol=1e-13, max_step=2e-4)
    # Radau steps over the corners of the foam, and the tail of a high power is flat
    assert float(blow.duration) == pytest.approx(motion.t_events[0][0], rel=2e-5)
    assert float(blow.max_indentation) == pytest.approx(motion.y_events[1][0][0], rel=2e-6)
    # the foam's corners cost the integrator a digit of its 1e-7
    assert float(blow.restitution) == pytest.approx(math.sqrt(0.5), abs=1e-6 if law == "foam" else 2e-7)


def test_linear_cushion_makes_half_a_sine():
    """Peak v sqrt(k m), duration pi sqrt(m/k), deepest v sqrt(m/k): closed form, to rounding."""
    k = 5e6 * AREA / THICKNESS
    blow = solve_impact(linear(PAD, 5e6), MASS, math.inf, SPEED)
    assert float(blow.peak_force) == pytest.approx(SPEED * math.sqrt(k * MASS), rel=1e-13)
    assert float(blow.duration) == pytest.approx(math.pi * math.sqrt(MASS / k), rel=1e-10)
    assert float(blow.max_indentation) == pytest.approx(SPEED * math.sqrt(MASS / k), rel=1e-13)


@pytest.mark.parametrize("n", [1.0, 1.5, 2.5, 4.0])
def test_power_cushion_has_peak_and_duration_in_closed_form(n):
    """d = ((n+1) m v^2/(2 K))^(1/(n+1)), T = 2 (d/v) I(n), I = int_0^1 (1 - u^(n+1))^(-1/2) du by quadrature."""
    k = 20e6 * AREA / THICKNESS**n
    blow = solve_impact(power(PAD, 20e6, n), MASS, math.inf, SPEED)
    deep = ((n + 1) * MASS * SPEED**2 / (2 * k)) ** (1 / (n + 1))
    # u = 1 - w^2 takes away the root at u = 1
    whole = quad(lambda w: 2 * w / math.sqrt(-math.expm1((n + 1) * math.log1p(-w * w))) if w else 0.0, 0, 1)[0]
    assert float(blow.max_indentation) == pytest.approx(deep, rel=1e-12)
    assert float(blow.peak_force) == pytest.approx(k * deep**n, rel=1e-12)
    assert float(blow.duration) == pytest.approx(2 * deep / SPEED * whole, rel=1e-8)


@pytest.mark.parametrize("n", [1.0, 2.5])
def test_power_cushion_goes_with_drop_height_thickness_and_area(n):
    """v^2 = 2 g H: peak as (H A^(1/n)/h)^(n/(n+1)), duration as H^((1-n)/(2(n+1))) (h^n/A)^(1/(n+1)): exact scaling."""
    base = solve_impact(power(PAD, 20e6, n), MASS, math.inf, SPEED)
    for higher, thicker, wider in [(2.0, 1.0, 1.0), (1.0, 4.0, 1.0), (1.0, 1.0, 3.0), (1.7, 0.3, 2.2)]:
        pad = Pad(AREA * wider, THICKNESS * thicker)
        blow = solve_impact(power(pad, 20e6, n), MASS, math.inf, SPEED * math.sqrt(higher))
        peak = (higher * wider ** (1 / n) / thicker) ** (n / (n + 1))
        lasts = higher ** ((1 - n) / (2 * (n + 1))) * (thicker**n / wider) ** (1 / (n + 1))
        assert float(blow.peak_force / base.peak_force) == pytest.approx(peak, rel=1e-12)
        assert float(blow.duration / base.duration) == pytest.approx(lasts, rel=1e-9)


@pytest.mark.parametrize("speed", [0.1, 2.0, 6.0])
def test_mindlin_1945_peak_of_tangent_elasticity(speed):
    """F = (2 k l/pi) sqrt(exp(pi^2 m v^2/(4 k l^2)) - 1); the integrator's 1e-7, in the exponent at the highest speed."""
    k, end = 2e6 * AREA / THICKNESS, 0.8 * THICKNESS
    blow = solve_impact(made("tangent"), 0.5, math.inf, speed)
    peak = 2 * k * end / math.pi * math.sqrt(math.expm1(math.pi**2 * 0.5 * speed**2 / (4 * k * end**2)))
    assert float(blow.peak_force) == pytest.approx(peak, rel=1e-6)


def test_elastomer_of_large_shape_factor_stiffens_as_gent_and_lindley():
    """E_a/E = 1 + 2 k S^2; faces that slip have none; at small strain Hooke's law."""
    disc = Pad(math.pi * 0.05**2, 0.0125)
    assert disc.shape_factor == pytest.approx(2.0, rel=1e-14)
    slip = elastomer(disc, 1e6, shape_factor=0.0)
    assert slip.stiffness == pytest.approx(1e6 * disc.area / disc.thickness, rel=1e-14)
    assert elastomer(disc, 1e6, 0.5).stiffness / slip.stiffness == pytest.approx(1 + 2 * 0.5 * 4, rel=1e-14)


def test_rigid_crush_has_plateau_duration_and_set_in_closed_form():
    """F = A P, T = m v/F, set = m v^2/(2 F): the elastic part leaves e^2 of energy and set, pi e/2 of the duration."""
    force = AREA * 1e6
    blow = solve_impact(crush(PAD, 1e12, 1e6), MASS, math.inf, SPEED)
    assert float(blow.peak_force) == pytest.approx(force, rel=1e-9)
    e = math.sqrt(force**2 * THICKNESS / (1e12 * AREA * MASS * SPEED**2))
    assert float(blow.duration) == pytest.approx(MASS * SPEED / force, rel=0.5 * math.pi * e * 1.01)
    assert float(blow.residual_indentation) == pytest.approx(MASS * SPEED**2 / (2 * force), rel=e**2 * 1.01)


def test_elastic_crush_gives_back_what_the_elastic_part_holds():
    """e^2 = F^2/(k m v^2), set = (m v^2/2 - F^2/(2 k))/F, deepest = set + F/k, with the times of its three parts."""
    k, force = 50e6 * AREA / THICKNESS, AREA * 1e6
    blow = solve_impact(crush(PAD, 50e6, 1e6), MASS, math.inf, SPEED)
    energy, held = 0.5 * MASS * SPEED**2, force**2 / (2 * k)
    assert float(blow.restitution) == pytest.approx(math.sqrt(held / energy), rel=1e-6)
    assert float(blow.residual_indentation) == pytest.approx((energy - held) / force, rel=1e-6)
    assert float(blow.max_indentation) == pytest.approx((energy - held) / force + force / k, rel=1e-6)
    assert float(balance_of(blow).stored) == pytest.approx(held, rel=1e-6)
    w = math.sqrt(k / MASS)
    rises = math.asin(force / (SPEED * math.sqrt(k * MASS))) / w
    lasts = rises + SPEED * math.cos(w * rises) * MASS / force + 0.5 * math.pi / w
    assert float(blow.duration) == pytest.approx(lasts, rel=1e-6)


def test_set_grows_by_equal_steps_until_the_crush_densifies():
    """Each equal blow adds (m v^2/2 - F^2/(2 k))/F while the plateau lasts; then less, at more force."""
    k, force = 50e6 * AREA / THICKNESS, AREA * 0.25e6
    step = (0.5 * 0.5 * SPEED**2 - force**2 / (2 * k)) / force
    pad = Cushion("crush", PAD, PROPERTIES["crush"])
    blows = repeated_blows(pad, 0.5, SPEED, 12)
    sets = np.array([float(blow.residual_indentation) for blow in blows])
    plateau_ends = 0.8 * THICKNESS * (1 - 1 / 2.3)
    on = [k for k, blow in enumerate(blows) if float(blow.max_indentation) < plateau_ends]
    assert len(on) == 4
    assert sets[on] == pytest.approx(step * (np.array(on) + 1), rel=1e-6)
    assert np.all(np.diff(sets) > 0)
    assert np.all(np.diff(sets, 2)[4:] < 0)
    peaks = np.array([float(blow.peak_force) for blow in blows])
    assert peaks[on] == pytest.approx(force, rel=1e-9)
    assert np.all(np.diff(peaks)[len(on) :] > 0)
    # a lighter blow stays below what has crushed: elastic, and the set stays
    light = solve_impact(
        pad.contact(), 0.5, math.inf, 0.5 * force / math.sqrt(k * 0.5), deepest=float(blows[2].deepest)
    )
    assert float(light.restitution) == pytest.approx(1.0, abs=1e-7)
    assert float(light.residual_indentation) == pytest.approx(sets[2], rel=1e-12)


def test_crush_densifies_no_steeper_than_it_unloads():
    """Where (P/D) L/(L - x)^2 reaches E the force goes on with E, and the set stays as it is."""
    p, end = PROPERTIES["crush"], 0.8
    last = end - math.sqrt(p["plateau"] * end / (2.3 * p["modulus"]))
    law, d = made("crush"), np.array([last, last + 0.01, last + 0.02]) * THICKNESS
    force = slow_force(law, d)
    assert np.diff(force) == pytest.approx(p["modulus"] * AREA * 0.01, rel=1e-9)
    sets = [deep - f * THICKNESS / (p["modulus"] * AREA) for deep, f in zip(d, force, strict=True)]
    assert sets == pytest.approx([sets[0]] * 3, rel=1e-9)


@pytest.mark.parametrize("loss", [0.05, 0.3, 1.0])
def test_retarded_linear_cushion_is_a_spring_with_a_dashpot(loss):
    """F = k d + k T d' never pulls: zeta = w T/2, e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)) (Schwager & Poschel)."""
    natural = math.sqrt(5e6 * AREA / THICKNESS / MASS)
    retardation = retardation_of(loss, natural / (2 * math.pi))
    blow = solve_impact(retarded(linear(PAD, 5e6), retardation), MASS, math.inf, SPEED)
    assert float(blow.restitution) == pytest.approx(float(cut_off_restitution(0.5 * loss)), rel=1e-6)


@pytest.mark.parametrize("law", ["tangent", "elastomer", "foam"])
def test_retardation_loses_the_work_of_its_part(law):
    """Energy lost = int T F'(d) d'^2 dt, by quadrature along the motion, to 1e-5 of the blow's (the foam's jumps)."""
    contact = retarded(made(law), 2e-5)
    blow = solve_impact(contact, MASS, math.inf, SPEED)
    history = impact_history(blow, np.linspace(0, float(blow.duration), 20001))
    elastic = slow_force(made(law), history.indentation)
    lost = np.trapezoid((history.force - elastic) * history.rate, history.time)
    # what the cushion still holds where its force is lost stays in it
    lost += held(made(law), history.indentation[-1])
    energy = 0.5 * MASS * SPEED**2
    assert float(blow.energy_lost) == pytest.approx(lost, abs=1e-5 * energy)
    assert 1e-3 * energy < float(blow.energy_lost) < energy


def held(contact, depth):
    """What a cushion stores at a depth, by quadrature."""
    return quad(lambda d: float(slow_force(contact, d)), 0, depth)[0]


def test_felt_loses_more_at_higher_speed():
    """Its retardation goes as d^(n-1) d': n = 2.5 shortens the contact with the speed (Stulov 2004)."""
    pad = felt(PAD, 20e6, 2.5, 2e-5)
    e = [float(solve_impact(pad, MASS, math.inf, v).restitution) for v in (0.5, 1.0, 2.0, 4.0)]
    assert all(slow > fast for slow, fast in pairwise(e))
    assert made("felt") == made("power")


@pytest.mark.parametrize("law", ["tangent", "elastomer", "foam"])
def test_a_cushion_that_bottoms_out_is_refused(law):
    with pytest.raises(IntegrationError, match="bottoms out: take a thicker or larger one"):
        solve_impact(made(law), 500.0, math.inf, 20.0)
    contact = made(law)
    check_end(contact, 0.98 * float(contact.limit))
    with pytest.raises(IntegrationError, match="it bottoms out, its law ends at"):
        check_end(contact, float(contact.limit))


@pytest.mark.parametrize("law", ["tangent", "elastomer", "foam"])
@pytest.mark.parametrize("force", [1e-3, 40.0, 501.0, 4e3])
def test_depth_under_a_force_is_that_at_which_the_law_bears_it(law, force):
    depth = indentation_under(made(law), force)
    assert depth == pytest.approx(
        THICKNESS * brentq(lambda x: AREA * stress(law, x) - force, 0, 0.79, xtol=1e-15), rel=1e-8
    )


def test_wear_shortens_and_stiffens_by_its_shares():
    """h (1 - s)^N and E (1 + g)^N: duration of a linear cushion as sqrt((1 - s)/(1 + g)) a blow."""
    worn = Cushion("linear", PAD, {"modulus": 5e6}, Wear(settling=0.02, stiffening=0.03))
    blows = repeated_blows(worn, MASS, SPEED, 5)
    lasts = np.array([float(blow.duration) for blow in blows])
    assert lasts[1:] / lasts[:-1] == pytest.approx(np.full(4, math.sqrt(0.98 / 1.03)), rel=1e-9)
    assert worn.after(0) == worn
    assert made("crush") == Cushion("crush", PAD, PROPERTIES["crush"]).contact()


LENGTHS = st.floats(0.01, 100.0)


@settings(derandomize=True, max_examples=40, deadline=None)
@given(law=st.sampled_from(sorted(PROPERTIES)), metre=LENGTHS, second=LENGTHS, kilogram=LENGTHS)
def test_no_law_knows_units(law, metre, second, kilogram):
    """Other units of length, time and mass change peak, duration and set by their powers alone; 2e-6 of the integrator."""
    pascal = kilogram / (metre * second**2)
    properties = {
        key: value * (pascal if key in ("modulus", "stress", "plateau") else 1.0)
        for key, value in PROPERTIES[law].items()
    }
    other = cushion_law(law).function(Pad(AREA * metre**2, THICKNESS * metre), **properties)
    here = solve_impact(made(law), MASS, math.inf, SPEED)
    there = solve_impact(other, MASS * kilogram, math.inf, SPEED * metre / second)
    assert float(there.restitution) == pytest.approx(float(here.restitution), rel=2e-6)
    assert float(there.peak_force) == pytest.approx(float(here.peak_force) * pascal * metre**2, rel=2e-6)
    assert float(there.duration) == pytest.approx(float(here.duration) * second, rel=2e-6)
    assert float(there.residual_indentation) == pytest.approx(float(here.residual_indentation) * metre, rel=2e-6)


@settings(derandomize=True, max_examples=40, deadline=None)
@given(law=st.sampled_from(sorted(PROPERTIES)), share=st.floats(0.3, 1.0), more=st.floats(1.01, 1.5))
def test_a_harder_blow_presses_deeper_with_no_less_force_and_a_thicker_cushion_is_softer(law, share, more):
    slow, fast = (solve_impact(made(law), MASS, math.inf, v) for v in (share * SPEED, share * more * SPEED))
    assert float(fast.max_indentation) > float(slow.max_indentation)
    assert float(fast.peak_force) >= float(slow.peak_force) * (1 - 1e-9)
    thick = cushion_law(law).function(Pad(AREA, more * THICKNESS), **PROPERTIES[law])
    softer = solve_impact(thick, MASS, math.inf, share * SPEED)
    assert float(softer.peak_force) <= float(slow.peak_force) * (1 + 1e-9)
    assert float(softer.duration) >= float(slow.duration) * (1 - 1e-9)


@pytest.mark.parametrize("law", ["linear", "tangent", "elastomer"])
def test_a_mass_on_a_cushion_of_a_surface_that_is_struck_is_an_impact_at_its_speed(law):
    """A short kick of the surface to the speed v: peak and compression of the impact at v, to the kick's 0.1 % of it."""
    contact, speed, step = made(law), 1.0, 1e-5
    lasts = float(solve_impact(contact, MASS, math.inf, speed).duration)
    kick = np.zeros(round(0.6 * lasts / step))
    kick[1] = speed / step
    motion = carried(contact, MASS, kick, step)
    blow = solve_impact(contact, MASS, math.inf, speed)
    assert motion.acceleration.max() == pytest.approx(float(blow.peak_force) / MASS, rel=1e-3)
    assert motion.compression.max() == pytest.approx(float(blow.max_indentation), rel=1e-3)


def test_a_carried_mass_on_a_retarded_cushion_is_a_damped_oscillator():
    """A swing of the surface about a push that never lets go: the transmissibility of a spring with dashpot k T."""
    k, retardation, step = 5e6 * AREA / THICKNESS, 1.5e-3, 1e-4
    w = 0.7 * math.sqrt(k / MASS)
    times = step * np.arange(round(10 * math.pi / w / step))
    push, swing = 100.0, 20.0
    motion = carried(retarded(linear(PAD, 5e6), retardation), MASS, push + swing * np.sin(w * times), step)
    lost = 1j * w * retardation
    ratio = abs((1 + lost) / (1 + lost - (w**2) * MASS / k))
    last = motion.acceleration[times > 8 * math.pi / w]
    # sampled 90 times a period, and straight between: 1e-3 of the swing
    assert 0.5 * np.ptp(last) == pytest.approx(ratio * swing, rel=3e-3)
    assert motion.acceleration.min() >= 0.0


def test_a_carried_mass_takes_no_set_and_no_hysteresis():
    for contact in (made("crush"), Cushion("linear", PAD, {"modulus": 5e6}).contact(restitution=0.5)):
        with pytest.raises(ValueError, match="a cushion that comes back, without hysteresis"):
            carried(contact, MASS, [0.0, 1.0], 1e-5)
    with pytest.raises(IntegrationError, match="it bottoms out"):
        carried(made("tangent"), 500.0, np.full(2000, 1e4), 1e-5)
    assert np.all(carried(made("tangent"), MASS, np.zeros(5), 1e-5).compression == 0.0)


def test_what_no_cushion_can_be_is_refused():
    with pytest.raises(ValueError, match="the thickness of a cushion must be above zero"):
        Pad(1e-3, 0.0)
    with pytest.raises(ValueError, match=r"the limit strain must be above 0 and at most 1, got 1\.2"):
        tangent(PAD, 1e6, 1.2)
    with pytest.raises(ValueError, match="the limit must be beyond the begin of the plateau"):
        solve_impact(foam(PAD, 1e6, 0.5e6, 0.6), MASS, math.inf, SPEED)
    with pytest.raises(ValueError, match=r"the limit of the crush must be at least 2\.3 times"):
        solve_impact(crush(PAD, 1e6, 0.5e6, 0.6), MASS, math.inf, SPEED)
    with pytest.raises(ValueError, match="a retardation is for a cushion that comes back"):
        retarded(made("crush"), 1e-5)
    with pytest.raises(ValueError, match="shape and compression factor must not be negative"):
        elastomer(PAD, 1e6, shape_factor=-1.0)
    with pytest.raises(ValueError, match="settling below 1"):
        Wear(settling=1.0)
    with pytest.raises(InputError, match='did you mean "tangent"'):
        cushion_law("tangens")
    with pytest.raises(InputError, match='did you mean "lead"'):
        cushion_material("leed")
    with pytest.raises(ValueError, match="is not known"):
        solve_impact(HardeningContact("cubic", 1e6, 0.01), MASS, math.inf, SPEED)


def test_every_row_of_the_table_has_properties_of_its_law_and_a_source():
    for row in cushion_materials().values():
        law = cushion_law(row.law)
        assert set(row.properties) <= {*law.needs, *law.options}
        assert all(value > 0.0 for value in row.properties.values())
        assert row.source
        assert row.note
        assert row.status in (CHECKED, QUOTED)
        assert (row.status == QUOTED) == ("as quoted" in row.source)


def test_every_law_says_what_it_needs():
    for law in cushion_laws().values():
        names = list(inspect.signature(law.function).parameters)
        assert names == ["pad", *law.needs, *law.options]
        assert (law.status == QUOTED) == bool(law.seen), law.name


def test_a_mass_carried_by_a_ramp_follows_its_closed_form():
    """a = r t on a spring: d = (r/w^2)(t - sin(w t)/w), and the mass has w^2 d; a jump gives A (1 - cos w t)."""
    w = math.sqrt(5e6 * AREA / THICKNESS / MASS)
    step, rise = 1e-4, 3e4
    t = step * np.arange(200)
    ramp = carried(linear(PAD, 5e6), MASS, rise * t, step)
    d = rise / w**2 * (t - np.sin(w * t) / w)
    # 1e-8 a step
    assert ramp.compression == pytest.approx(d, abs=1e-6 * d[-1])
    assert ramp.acceleration == pytest.approx(w**2 * d, abs=1e-6 * w**2 * d[-1])
    jump = carried(linear(PAD, 5e6), MASS, np.full(200, 50.0), step)
    assert jump.acceleration == pytest.approx(50.0 * (1 - np.cos(w * t)), abs=1e-4)


def test_a_mass_flies_where_the_surface_falls_back_and_is_caught_by_the_same_law():
    """A kick of speed v: half a sine, then flight at 2 v; pulled back as fast, the surface never holds it."""
    w = math.sqrt(5e6 * AREA / THICKNESS / MASS)
    step = 1e-5
    kick = np.zeros(4000)
    kick[2000:2002] = 0.5 / step  # late, so that a step across it would miss it
    motion = carried(linear(PAD, 5e6), MASS, kick, step)
    t = step * np.arange(4000) - 2000.5 * step
    on = (t > 2 * step) & (t < math.pi / w)
    assert motion.compression[on] == pytest.approx(np.sin(w * t[on]) / w, abs=1e-4 / w)
    assert np.all(motion.acceleration[t > 1.01 * math.pi / w] == 0.0)
    assert np.all(motion.compression[t > 1.01 * math.pi / w] == 0.0)
    assert np.all(motion.compression[:2000] == 0.0)
    for short in ([7.0], np.zeros(3)):
        assert np.array_equal(carried(linear(PAD, 5e6), MASS, short, step), np.zeros((2, len(short))))


def test_wear_and_properties_of_a_pad_are_products_worked_by_hand():
    wear = Wear(settling=0.1, stiffening=0.5)
    assert (wear.thickness_left(3), wear.stiffened(3)) == pytest.approx((0.729, 3.375), rel=1e-14)
    assert (Wear().thickness_left(7), Wear().stiffened(7)) == (1.0, 1.0)
    pad = Cushion("foam", PAD, PROPERTIES["foam"], wear).after(2)
    assert (pad.pad.area, pad.pad.thickness) == (AREA, pytest.approx(0.81 * THICKNESS, rel=1e-14))
    # stresses stiffen, strains do not
    assert pad.properties == {
        "modulus": pytest.approx(11.25e6, rel=1e-14),
        "plateau": pytest.approx(0.5625e6, rel=1e-14),
        "densification": 0.8,
    }
    assert solid_strain(0.25) == pytest.approx(0.65, rel=1e-14)
    assert retardation_of(0.5, 10.0) == pytest.approx(1 / (40 * math.pi), rel=1e-14)
    lossy = Cushion("linear", PAD, {"modulus": 5e6}, retardation=1e-4).contact()
    assert (lossy.damper, lossy.hysteresis_factor) == (Damper(1e-4, style="retarded"), 0.0)
    assert Cushion("linear", PAD, {"modulus": 5e6}).contact("flores", 0.5).hysteresis_factor == pytest.approx(1.6)


def test_what_a_crush_without_end_holds_and_keeps():
    """Set + F/k = deepest; taken = stored + lost, and what comes back is what is stored."""
    balance = balance_of(solve_impact(crush(PAD, 50e6, 1e6), [MASS, 2 * MASS], math.inf, [SPEED, 1.5]))
    held = (AREA * 1e6) ** 2 / (2 * 50e6 * AREA / THICKNESS)
    assert balance.taken == pytest.approx([6.0, 6.75], rel=1e-14)
    assert balance.stored == pytest.approx([held, held], rel=1e-6)
    assert balance.returned == pytest.approx([held, held], rel=1e-5)
    assert balance.lost == pytest.approx([6.0 - held, 6.75 - held], rel=1e-6)
    assert balance.set == pytest.approx((np.array([6.0, 6.75]) - held) / (AREA * 1e6), rel=1e-6)


def test_edges_of_what_a_pad_can_be_are_taken():
    assert float(tangent(PAD, 1e6, 1.0).limit) == THICKNESS
    assert elastomer(PAD, 1e6, compression_factor=0.0).stiffness == pytest.approx(1e6 * AREA / THICKNESS, rel=1e-14)
    slightly = elastomer(PAD, 1e6, compression_factor=0.005, shape_factor=0.005)
    assert slightly.stiffness == pytest.approx(1e6 * AREA / THICKNESS * (1 + 0.01 * 25e-6), rel=1e-13)
    assert foam(PAD, 1e6, 1e4, 1e-2 + 1e-2).limit == pytest.approx(4e-4, rel=1e-14)
    assert Wear(settling=0.999).thickness_left(1) == pytest.approx(1e-3)
    for area, thickness in ((0.0, 1.0), (math.inf, 1.0), (1.0, -1.0), (1.0, math.nan)):
        with pytest.raises(ValueError, match="of a cushion must be above zero and finite"):
            Pad(area, thickness)
    for wrong in (
        lambda: linear(PAD, 0.0),
        lambda: power(PAD, 1e6, math.inf),
        lambda: foam(PAD, 1e6, -1.0, 0.5),
        lambda: foam(PAD, 1e6, 1e4, 0.0),
        lambda: crush(PAD, 1e6, 1e4, 1.01),
        lambda: elastomer(PAD, 1e6, -0.1),
        lambda: elastomer(PAD, 1e6, 1.0, math.inf),
        lambda: Wear(settling=-0.1),
        lambda: Wear(stiffening=-0.1),
        lambda: Wear(stiffening=math.inf),
        lambda: retarded(LogarithmicContact(1e9, 1e5), 1e-5),
        lambda: retarded(retarded(linear(PAD, 1e6), 1e-5), 1e-5),
        lambda: check(Contact([1e6, 1e6], [1.0, 1.5], cap=PressureCap(1e2, "crush"))),
    ):
        with pytest.raises(ValueError, match=r"must|a cushion"):
            wrong()
