"""The stress-wave route of Li & Ma 2019 against d'Alembert on a lattice, its own text, and mechanics."""

import itertools
import math
import random
from dataclasses import replace

import numpy as np
import pytest

from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.waves import Layer, round_bar
from strikewave.waves.li_ma import (
    ROUTES,
    Incident,
    Sandwich,
    acceleration,
    arrivals,
    incident_strain,
    mean_acceleration,
    strain,
    superposed,
    velocity,
)

PRINTED, CORRECTED = ROUTES
PEAK, WIDTH = 19.7e3, 220e-6  # N, s: the simulated contact force of the text
G = STANDARD_GRAVITY


def bar(impedance, length=1.0, speed=1.0):
    """A layer of given impedance: modulus Z c with area 1, or the like."""
    return Layer("bar", impedance / speed, impedance * speed, 1.0, length)


def sandwich(upper=2.0, specimen=1.0, lower=3.0, length=1.0):
    return Sandwich(bar(upper), bar(specimen, length), bar(lower))


def constant(level=1.0):
    return Incident(lambda t: level * np.ones_like(t), np.zeros_like)


def ramp(slope=1.0):
    return Incident(lambda t: slope * t, lambda t: slope * np.ones_like(t))


def half_sine(peak, width):
    inside = lambda t: (t >= 0) & (t <= width)  # noqa: E731
    return Incident(
        lambda t: np.where(inside(t), peak * np.sin(math.pi * t / width), 0.0),
        lambda t: np.where(inside(t), peak * math.pi / width * np.cos(math.pi * t / width), 0.0),
    )


def steel_sandwich(specimen_length=0.02):
    """65Mn / 45 steel / 65Mn, 30 mm round: the materials of the stress-wave experiment."""
    fixture = round_bar("fixture", material("65Mn"), 0.03, 0.03)
    return Sandwich(fixture, round_bar("sensor", material("45 steel"), specimen_length, 0.03), fixture)


# An independent solution: waves of force hop from cell to cell, one cell a step, and split at every face.


def lattice(stack, cells, force, steps, fixture_cells=(0, 0)):
    """Return force and velocity at the faces of the specimen's cells, a row a step.

    The incident wave stands ready in the upper fixture at the start, sample j in the j-th cell above
    interface I. Fixtures have free far ends; without a number of cells they are too long to be heard.
    """
    above, below = (number or len(force) + steps + 1 for number in fixture_cells)
    impedances = [stack.upper.impedance] * above + [stack.specimen.impedance] * cells + [stack.lower.impedance] * below
    down = [0.0] * len(impedances)
    up = [0.0] * len(impedances)
    for sample, value in enumerate(force):
        down[above - 1 - sample] = value
    forces, speeds = [], []
    for _ in range(steps):
        face_forces, face_speeds = [], []
        new_down, new_up = down[:], up[:]
        for face in range(len(impedances) - 1):
            left, right = impedances[face], impedances[face + 1]
            here = 2.0 * (right * down[face] + left * up[face + 1]) / (left + right)
            face_forces.append(here)
            face_speeds.append(2.0 * (down[face] - up[face + 1]) / (left + right))
            new_down[face + 1] = here - up[face + 1]
            new_up[face] = here - down[face]
        new_down[0], new_up[-1] = -up[0], -down[-1]
        down, up = new_down, new_up
        forces.append(face_forces[above - 1 : above + cells])
        speeds.append(face_speeds[above - 1 : above + cells])
    return np.array(forces), np.array(speeds)


CELLS, STEPS = 6, 60


def random_force(count=25):
    """Random samples, zero first, then zero from ``count`` on."""
    draw = random.Random(20190514)
    return [0.0] + [draw.uniform(-1.0, 1.0) for _ in range(count - 2)] + [0.0]


STACKS = [(2.0, 1.0, 3.0), (1.0, 5.0, 0.5), (0.5, 1.0, 1e-3), (7.0, 1.0, 1.0), (1.0, 1.0, 1.0), (0.02, 1.0, 50.0)]


@pytest.mark.parametrize("impedances", STACKS)
def test_corrected_route_is_the_lattice_solution(impedances):
    """Force and velocity at every face of the specimen, ten transits long.

    1e-14 of the largest: some 60 sums of rounding at each side, and the slope of the curve between
    samples times the rounding of a delay.
    """
    stack = sandwich(*impedances, length=CELLS / 4)
    step = stack.transit / CELLS
    samples = random_force()
    incident = incident_strain(np.arange(len(samples)) * step, samples, stack.upper)
    forces, speeds = lattice(stack, CELLS, samples, STEPS)
    stiffness = stack.specimen.modulus * stack.specimen.area
    for face in range(CELLS + 1):
        times = (np.arange(STEPS) - face) * step
        arguments = stack, incident, face / CELLS, times, CORRECTED
        assert stiffness * strain(*arguments) == pytest.approx(forces[:, face], abs=1e-14 * np.abs(forces).max())
        assert velocity(*arguments) == pytest.approx(speeds[:, face], abs=1e-14 * np.abs(speeds).max())


def test_printed_route_is_not_the_lattice_solution():
    """The check above can tell the two routes apart."""
    stack = sandwich(length=CELLS / 4)
    step = stack.transit / CELLS
    samples = random_force()
    incident = incident_strain(np.arange(len(samples)) * step, samples, stack.upper)
    forces, _ = lattice(stack, CELLS, samples, STEPS)
    found = stack.specimen.modulus * strain(stack, incident, 0.5, (np.arange(STEPS) - CELLS // 2) * step, PRINTED)
    assert np.abs(found - forces[:, CELLS // 2]).max() > 0.3


@pytest.mark.parametrize("impedances", STACKS)
def test_corrected_route_fits_both_fixtures(impedances):
    """At I: F + Z1 v = 2 F_i, at II: F = Z2 v; so no energy is lost: what comes in goes back or on."""
    stack = sandwich(*impedances)
    incident = half_sine(1.0, 2.5)
    times = np.linspace(0.01, 9.99, 500)
    top, bottom = (stack, incident, 0.0, times, CORRECTED), (stack, incident, 1.0, times - stack.transit, CORRECTED)
    arriving = stack.upper.modulus * incident.strain(times)
    force, speed = stack.specimen.modulus * strain(*top), velocity(*top)
    tolerance = 1e-13 * max(impedances)  # sums of at most twenty terms
    assert force + stack.upper.impedance * speed == pytest.approx(2 * arriving, abs=tolerance)
    assert stack.specimen.modulus * strain(*bottom) == pytest.approx(
        stack.lower.impedance * velocity(*bottom), abs=tolerance
    )


def test_energy_of_the_incident_wave_goes_back_up_and_on_down():
    """int F^2/Z dt: incident = reflected + transmitted. Tails after 40 t0 are q^20 ~ 1e-16 here."""
    stack = sandwich(2.0, 1.0, 3.0)
    samples = random_force()
    incident = incident_strain(np.arange(len(samples)) / 4.0, samples, stack.upper)
    times = np.arange(0, 4 * 60) / 4.0  # on whole steps the sum of squares stands for the integral
    arriving = stack.upper.modulus * incident.strain(times)
    back = stack.specimen.modulus * strain(stack, incident, 0.0, times, CORRECTED) - arriving
    on = stack.specimen.modulus * strain(stack, incident, 1.0, times - 1.0, CORRECTED)
    assert np.sum(back**2) / 2.0 + np.sum(on**2) / 3.0 == pytest.approx(np.sum(arriving**2) / 2.0, rel=1e-13)


@pytest.mark.parametrize("route", ROUTES)
def test_acceleration_is_the_rate_of_the_velocity(route):
    """Gauss over each step is exact: the rate is a parabola between samples, delays are whole steps."""
    stack = sandwich(length=CELLS / 4)
    step = stack.transit / CELLS
    samples = random_force()
    incident = incident_strain(np.arange(len(samples)) * step, samples, stack.upper)
    start = np.arange(STEPS) * step
    # two places, clear of the corners, exact to the cubic
    places = [start + step * (0.5 + side / math.sqrt(12.0)) for side in (-1.0, 1.0)]
    gained = 0.5 * step * sum(acceleration(stack, incident, 0.5, t, route) for t in places)
    speeds = velocity(stack, incident, 0.5, np.append(start, STEPS * step), route)
    assert gained == pytest.approx(np.diff(speeds), abs=1e-12)


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("transfers", [1, 2, 3, 4, None])
def test_mean_acceleration_is_the_average_over_the_sections(route, transfers):
    """The closed form against Gauss's rule over x, 40 points a piece; pieces end where a front stands."""
    stack = sandwich(2.0, 1.0, 3.0, length=0.75)
    incident = half_sine(1.0, 2.3)
    for time in (0.31, 0.62, 0.93, 1.7, 3.1, 5.5):
        fronts = [(sign * (time - start) / 0.75) % 1.0 for start in (0.0, 2.3) for sign in (1.0, -1.0)]
        edges = sorted({0.0, 1.0, *fronts})
        nodes, weights = np.polynomial.legendre.leggauss(40)
        total = 0.0
        for low, high in itertools.pairwise(edges):
            for node, weight in zip(nodes, weights, strict=True):
                x = low + 0.5 * (high - low) * (node + 1.0)
                here = acceleration(stack, incident, x, time - 0.75 * x, route, transfers)
                total += 0.5 * (high - low) * weight * float(here)
        found = float(mean_acceleration(stack, incident, time, route, transfers))
        assert found == pytest.approx(total, abs=1e-12)


def test_corrected_mean_acceleration_is_newtons_law():
    """(F(0) - F(l))/m with the forces of the lattice."""
    stack = sandwich(1.0, 5.0, 0.5, length=CELLS / 4)
    step = stack.transit / CELLS
    samples = random_force()
    incident = incident_strain(np.arange(len(samples)) * step, samples, stack.upper)
    forces, _ = lattice(stack, CELLS, samples, STEPS)
    found = mean_acceleration(stack, incident, np.arange(STEPS) * step, CORRECTED)
    assert found == pytest.approx((forces[:, 0] - forces[:, -1]) / stack.specimen.mass, abs=1e-12)


def test_total_of_rigid_and_wave_counts_the_rigid_motion_twice():
    """Newton's law for the specimen gives its rigid acceleration; the mean of the wave is the same already."""
    stack, times = sandwich(), np.linspace(0.05, 6.0, 50)
    incident = half_sine(1.0, 4.0)
    top, bottom = (strain(stack, incident, x, times - x * stack.transit, CORRECTED) for x in (0.0, 1.0))
    rigid = stack.specimen.modulus * (top - bottom) / stack.specimen.mass
    wave = mean_acceleration(stack, incident, times, CORRECTED)
    assert superposed(rigid, wave) == pytest.approx(2.0 * wave, abs=1e-14)


# The findings, one test each.


def test_echo_comes_back_after_two_transits_not_one():
    """At x = l/2 waves arrive at 0, 1, 2, 3, 4 t0; printed 0, 0.5, 1.5, 2.5, 3.5 t0."""
    stack = sandwich()
    assert [wave.transits for wave in arrivals(stack, 0.5, 5, CORRECTED)] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert [wave.transits for wave in arrivals(stack, 0.5, 5, PRINTED)] == [0.0, 0.5, 1.5, 2.5, 3.5]
    forces, _ = lattice(stack, 2, [1.0], 12)  # a spike one step long, two steps a transit
    heard = np.flatnonzero(np.abs(forces[:, 1]) > 0) - 1
    assert list(heard[:5] / 2) == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_amplitudes_and_steady_state_are_right():
    """Wave by wave both routes carry the same strain; at rest 2 F_i Z2/(Z1 + Z2), whatever the specimen."""
    stack = sandwich(2.0, 1.0, 3.0)
    for k in range(1, 9):
        printed, exact = ([wave.strain for wave in arrivals(stack, 0.3, k, route)] for route in ROUTES)
        assert printed == pytest.approx(exact, rel=1e-14)
    for route in ROUTES:
        # q = -1/6: after 50 transits the rest is below rounding
        settled = strain(stack, constant(0.5), 0.3, 50.0, route)
        assert stack.specimen.modulus * settled == pytest.approx(2.0 * (2.0 * 0.5) * 3.0 / (2.0 + 3.0), rel=1e-14)


@pytest.mark.parametrize(
    ("area", "strains", "printed", "exact"), [(1e-30, 0.0, 0.0, 2.0), (1e30, 2.0, 2.0, 0.0)], ids=["free", "rigid"]
)
def test_backward_wave_moves_against_the_blow(area, strains, printed, exact):
    """Velocity over that of the wave coming in: at a free end 0 printed, 2 exact, at a rigid wall 2 and 0.

    Tight to nothing: with such an area F_II rounds to exactly -1 or 1.
    """
    stack = sandwich()
    stack = replace(stack, lower=replace(stack.lower, area=area))
    incoming = stack.gamma * stack.specimen.bar_speed
    for route, expected in zip(ROUTES, (printed, exact), strict=True):
        assert velocity(stack, constant(), 1.0, 0.5, route, 2) == expected * incoming
        assert acceleration(stack, ramp(), 1.0, 0.5, route, 2) == expected * incoming
        assert strain(stack, constant(), 1.0, 0.5, route, 2) == strains * stack.gamma


def test_slow_pulse_is_overstated_by_the_impedance_ratio():
    """A long ramp of incident strain: (40) settles at Z2/Ze times the exact c (R' - L')."""
    stack = sandwich(2.0, 1.0, 3.0)
    printed, exact = (acceleration(stack, ramp(), 0.4, 60.0, route) for route in ROUTES)
    assert printed / exact == pytest.approx(3.0, rel=1e-14)
    # exact: the joint behind moves with the force on it, 2 Z1 v_i/(Z1 + Z2) for an incident velocity v_i
    assert exact == pytest.approx(2.0 * 2.0 / (2.0 + 3.0) * stack.upper.bar_speed, rel=1e-14)


def test_stress_stands_for_strain_in_28():
    """With eps_i the force carries over, Ee Ae eps = T_I F_i; with sigma_i it is E1 times that, and not a strain."""
    stack = Sandwich(bar(2.0, speed=3.0), bar(1.0, speed=0.7), bar(1.0))
    incident = 1e-3
    through = 2.0 * stack.specimen.impedance / (stack.upper.impedance + stack.specimen.impedance)
    asked = through * stack.upper.modulus * incident
    found = strain(stack, constant(incident), 0.5, 0.1, PRINTED)
    assert stack.specimen.modulus * found == pytest.approx(asked, rel=1e-14)
    with_stress = stack.gamma * stack.upper.modulus * incident
    assert stack.specimen.modulus * with_stress == pytest.approx(stack.upper.modulus * asked, rel=1e-14)


def printed_36(stack, incident, x, time, *, with_s=True, by_lower_limits=False):
    """Eq (36) letter by letter at one time: the window gives k, k the sums; powers complex where halves come."""
    t0, rest = stack.transit, (1.0 - x) * stack.transit
    if time <= 0.0:
        return 0.0
    k = 1 if time <= rest else next(k for k in range(2, 999) if rest + (k - 2) * t0 < time <= rest + (k - 1) * t0)
    one, two = complex(-stack.first_reflection), complex(stack.second_reflection)

    def eps(at):
        return float(incident.strain(np.array(at))) if at > 0.0 else 0.0

    def beside(low):
        """The values of n: the list beside the sums, cut at the limit below, or that limit alone by twos."""
        listed = range(3, k + 1, 2) if k % 2 else range(2, k + 1, 2)
        return range(low, k + 1, 2) if by_lower_limits else [n for n in listed if n >= low]

    total = complex(eps(time))
    if k > 1 and k % 2:
        for n in beside(3):
            total += one ** ((n - 1) / 2) * two ** ((n - 1) / 2) * eps(time - rest - (n - 2) * t0)
        for n in beside(2):
            total += one ** ((n - 3) / 2) * two ** ((n - 1) / 2) * eps(time - rest - (n - 3) * t0)
    elif k > 1:
        s = (0.0 if k == 2 else 1.0) if with_s else 1.0
        for n in beside(3):
            total += s * one ** ((n - 2) / 2) * two ** ((n - 2) / 2) * eps(time - rest - (n - 3) * t0)
        for n in beside(2):
            total += one ** ((n - 2) / 2) * two ** (n / 2) * eps(time - rest - (n - 2) * t0)
    return stack.gamma * total


@pytest.mark.parametrize("x", [0.0, 0.3, 1.0])
def test_printed_route_is_36_window_by_window(x):
    """Windows in k, n by twos to k: the route and the letters of the text agree to rounding, up to k = 13."""
    stack, incident = sandwich(2.0, 1.0, 3.0), half_sine(1.0, 20.0)
    for time in np.linspace(-0.4, 11.57, 140):
        letters = printed_36(stack, incident, x, float(time))
        assert letters == pytest.approx(complex(strain(stack, incident, x, time, PRINTED)), abs=1e-14)


def test_correction_factor_s_changes_nothing():
    """Without S(k) the sums are the same for every k, k = 2 included."""
    stack, incident = sandwich(2.0, 1.0, 3.0), half_sine(1.0, 20.0)
    for time in np.linspace(0.05, 7.95, 60):
        arguments = stack, incident, 0.4, float(time)
        assert printed_36(*arguments, with_s=False) == printed_36(*arguments)


def test_lower_limits_alone_fail():
    """By "n = 3" and "n = 2" alone the powers turn to halves: k = 3 hears a wave before the first, as a worked case.

    -F_I = 1/3, F_II = 1/2. k = 3, second sum from n = 2: (1/3)^(-1/2) (1/2)^(1/2), t0 ahead of the echo,
    in place of 1/2. k = 4, first sum from n = 3: (1/6)^(1/2) in place of 1/6 at n = 4.
    """
    stack, incident = sandwich(2.0, 1.0, 3.0), constant()
    right = {3: 1 + 1 / 2 + 1 / 6, 4: 1 + 1 / 2 + 1 / 6 + 1 / 12}
    wrong = {3: 1 + 1 / 6 + math.sqrt(3 / 2), 4: 1 + math.sqrt(1 / 6) + 1 / 2 + 1 / 12}
    for k, time in ((3, 2.1), (4, 3.1)):  # in the k-th window at x = l/2
        assert printed_36(stack, incident, 0.5, time) == pytest.approx(stack.gamma * right[k], rel=1e-14)
        alone = printed_36(stack, incident, 0.5, time, by_lower_limits=True)
        assert alone == pytest.approx(stack.gamma * wrong[k], rel=1e-14)


def test_every_term_carries_gamma():
    """(34) closes the bracket of gamma before its last term; the text of (36) and the corrected route do not."""
    stack = sandwich(2.0, 1.0, 3.0)
    q = -stack.first_reflection * stack.second_reflection
    as_34 = stack.gamma * (1.0 + stack.second_reflection) + q
    for route in ROUTES:
        found = strain(stack, constant(), 0.5, 3.5, route, transfers=3)
        assert found - as_34 == pytest.approx((stack.gamma - 1.0) * q, rel=1e-13)
        assert abs(found - as_34) > 0.05


def test_a_30_mm_part_sends_its_own_echo_after_11_6_microseconds():
    """2 x 30 mm at 5194 m/s: twenty times in the 252 us of the pulse; printed to three digits."""
    stack = steel_sandwich()
    echo = stack.valid_until(1.0)
    assert echo == pytest.approx(2 * 0.03 / math.sqrt(211e9 / 7820), rel=1e-15)
    assert round(echo * 1e6, 1) == 11.6
    assert 252e-6 / echo > 20


@pytest.mark.parametrize(("above", "below"), [(20, 0), (0, 7), (9, 4), (5, 3)])
def test_endless_fixtures_hold_until_the_first_echo_from_a_far_end(above, below):
    """Finite against endless fixtures on the lattice: they part at the very step that valid_until names."""
    force, cells = [0.3, 0.7, 0.2], 6
    stack = Sandwich(bar(2.0, above or 999), bar(1.0, cells), bar(3.0, below or 999))
    endless, _ = lattice(stack, cells, force, 70)
    finite, _ = lattice(stack, cells, force, 70, (above, below))
    for face in (0, 2, 6):
        parted = np.flatnonzero(np.abs(endless[:, face] - finite[:, face]) > 1e-9)[0] - face
        assert parted == round(stack.valid_until(face / cells))


def test_the_experiment_of_the_text_has_no_reflections_to_speak_of():
    """65Mn / 45 steel / 65Mn of equal area: F_II = 2.3e-4, so (36) is right there to 2.3e-4, and (40) to twice that.

    (40) is wrong by the sign of the echo: Z2/Ze - 1 = 2 F_II/(1 - F_II).
    """
    stack = steel_sandwich()
    assert stack.second_reflection == pytest.approx(2.3e-4, abs=0.05e-4)  # two printed digits
    assert stack.first_reflection == pytest.approx(-stack.second_reflection, rel=1e-12)
    incident = half_sine(1e-3, WIDTH)
    times = np.linspace(1e-7, WIDTH, 4000)
    for quantity, within in ((strain, 1.0), (acceleration, 2.0)):
        printed, exact = (quantity(stack, incident, 0.5, times, route) for route in ROUTES)
        # the shares of the sum are one plus F_II and smaller; 1.001 leaves room for them
        worst = np.abs(printed - exact).max() / np.abs(exact).max()
        assert worst <= 1.001 * within * stack.second_reflection
        if quantity is acceleration:
            assert worst > 1.5 * stack.second_reflection


def test_smooth_pulse_gives_a_thousand_g_not_twenty_thousand():
    """Half-sine 19.7 kN, 220 us into a 65Mn bar of 30 mm: pi F/(T Z) = 1000 g forward, twice that at a free end."""
    part = round_bar("bar", material("65Mn"), 0.1, 0.03)
    forward = math.pi * PEAK / (WIDTH * part.impedance) / G
    assert forward == pytest.approx(1000.0, rel=5e-3)  # "about 1000 g"
    incident = half_sine(PEAK / (part.modulus * part.area), WIDTH)
    endless = Sandwich(part, part, part)
    free = Sandwich(part, part, replace(part, area=1e-30))
    # just after the front the cosine of the rate is one to rounding
    assert acceleration(endless, incident, 1.0, 1e-15, CORRECTED) / G == pytest.approx(forward, rel=1e-14)
    assert acceleration(free, incident, 1.0, 1e-15, CORRECTED) / G == pytest.approx(2 * forward, rel=1e-14)


def test_measured_peak_needs_a_rise_of_microseconds():
    """21 910 g in that forward wave: pi F/(2 a Z) = 5.0 us for a cosine rise, F/(a Z) = 3.2 us for a linear one."""
    part = round_bar("bar", material("65Mn"), 0.1, 0.03)
    linear = PEAK / (21910 * G * part.impedance)
    cosine = 0.5 * math.pi * linear
    assert round(cosine * 1e6, 1) == 5.0
    assert round(linear * 1e6, 1) == 3.2
    level = PEAK / (part.modulus * part.area)
    rises = {
        linear: Incident(lambda t: level * t / linear, lambda t: level / linear * np.ones_like(t)),
        cosine: Incident(
            lambda t: 0.5 * level * (1 - np.cos(math.pi * t / cosine)),
            lambda t: 0.5 * level * math.pi / cosine * np.sin(math.pi * t / cosine),
        ),
    }
    for rise, incident in rises.items():
        found = acceleration(Sandwich(part, part, part), incident, 0.5, 0.5 * rise, CORRECTED)
        assert found / G == pytest.approx(21910, rel=1e-13)


def test_wave_peak_is_five_times_the_rigid_one_not_four():
    """21 909.89 g over 4 151.25 g."""
    assert round(21909.89 / 4151.25, 2) == 5.28


# Its parts.


@pytest.mark.parametrize("route", ROUTES)
def test_transfers_leave_later_waves_out(route):
    stack = sandwich()
    for k in range(1, 7):
        expected = sum(wave.strain for wave in arrivals(stack, 0.3, k, route))
        assert strain(stack, constant(), 0.3, 50.0, route, k) == pytest.approx(expected, rel=1e-14)
    everything = strain(stack, constant(), 0.3, 5.2, route)
    assert everything == pytest.approx(strain(stack, constant(), 0.3, 5.2, route, 99), rel=1e-15)


def test_incident_wave_of_a_sampled_force():
    """Through the samples, zero outside, never above them; the rate integrates back to the strain."""
    part = round_bar("bar", material("2A12"), 0.1, 0.02)
    times = np.linspace(0.0, WIDTH, 45)
    force = PEAK * np.sin(math.pi * times / WIDTH)
    wave = incident_strain(times, force, part)
    assert wave.strain(times) * part.modulus * part.area == pytest.approx(force, rel=1e-14, abs=1e-12)
    outside = np.array([-1e-9, 1.01 * WIDTH])
    assert not wave.strain(outside).any()
    assert not wave.rate(outside).any()
    fine = np.linspace(0.0, WIDTH, 44 * 8 + 1)
    assert wave.strain(fine).max() <= wave.strain(times).max() * (1 + 1e-15)
    middle = 0.5 * (fine[1:] + fine[:-1])
    simpson = (wave.rate(fine[1:]) + wave.rate(fine[:-1]) + 4 * wave.rate(middle)) * np.diff(fine) / 6
    # exact for the parabola that the rate of a cubic is
    assert simpson == pytest.approx(np.diff(wave.strain(fine)), abs=1e-17)


def test_nothing_is_felt_before_the_wave_comes():
    """Nor is the history asked: this one has no past."""

    def past(t):
        assert (t >= 0.0).all()
        return np.ones_like(t)

    stack, incident = sandwich(), Incident(past, past)
    before = np.array([-3.0, -1e-9, 0.0])
    for route in ROUTES:
        for quantity in (strain, velocity, acceleration):
            assert not quantity(stack, incident, 0.5, before, route).any()
        assert not mean_acceleration(stack, incident, before, route).any()


def test_unknown_route_names_the_routes_and_the_nearest():
    with pytest.raises(ValueError, match=r'"as printed" or "corrected".*did you mean "corrected"\?'):
        strain(sandwich(), constant(), 0.5, 1.0, "correct")


def test_impossible_sections_and_transfers_are_refused():
    with pytest.raises(ValueError, match="position"):
        strain(sandwich(), constant(), 1.01, 1.0, CORRECTED)
    with pytest.raises(ValueError, match="transfer"):
        strain(sandwich(), constant(), 0.5, 1.0, CORRECTED, 0)


def test_a_force_that_begins_and_ends_with_a_jump_is_there_at_both_ends_and_not_beyond():
    """From 5 N to 7 N, of a monotone curve between: its rate is not negative."""
    part = bar(3.0)
    wave = incident_strain([2.0, 3.0, 5.0], [5.0, 5.5, 7.0], part)
    times = np.array([2.0 - 1e-9, 2.0, 3.0, 5.0, 5.0 + 1e-9])
    assert part.modulus * wave.strain(times) == pytest.approx([0.0, 5.0, 5.5, 7.0, 0.0], rel=1e-14)
    rates = wave.rate(times)
    assert rates[[0, 4]].tolist() == [0.0, 0.0]
    assert np.all(rates[1:4] > 0.0)
