"""The dual-mass shock amplifier: momentum exchange in closed form, two masses by another integrator, and its case."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave import load_case, run_case
from strikewave.analyses.by_tables import check_case
from strikewave.analyses.machine.build import release
from strikewave.base.errors import InputErrors
from strikewave.contact import Contact
from strikewave.contact.damping import cut_off_damping_ratio
from strikewave.machines.amplifier import DualMass, next_speed, second_impact
from strikewave.machines.launch import linear_shaper

CASE = "dual-mass-amplifier"
G = 9.80665
V = 3.0


def masses(second=2.0, e1=1.0, e2=1.0, cushion=1e-3, damping=0.0, gap=12e-3):
    """Return a table of 20 kg with cushions that do next to nothing, and a pad far stiffer than the shaper."""
    reduced = 20.0 * second / (20.0 + second)
    return DualMass(20.0, second, gap, cushion, damping, 5e7, e1, linear_shaper(1e10, reduced, e2))


@pytest.mark.parametrize("second", [0.02, 2.0, 20.0])
@pytest.mark.parametrize("e1", [0.4, 1.0])
@pytest.mark.parametrize("e2", [0.5, 1.0])
def test_masses_exchange_their_momentum_as_two_bodies_do(second, e1, e2):
    """Closing with (1 + e1) v, the second mass leaves with (1 + e2)(1 + e1) v/(1 + m/M) - v."""
    impact = second_impact(masses(second, e1, e2), V, gravity=0.0)
    # 1e-6: cushions of 1e-3 N/m; the law of the shaper gives its restitution to the integrator's 1e-9
    assert impact.table == pytest.approx(e1 * V, rel=1e-6)
    assert impact.second == pytest.approx(-V, rel=1e-6)
    leaves = (1.0 + e2) * (1.0 + e1) * V / (1.0 + second / 20.0) - V
    assert impact.gain * V == pytest.approx(leaves, rel=1e-6)
    assert impact.gain * V == pytest.approx(float(next_speed(e1 * V, second / 20.0, e2, falling=V)), rel=1e-6)


def test_a_light_elastic_mass_goes_three_times_as_fast_as_it_fell():
    assert second_impact(masses(second=1e-3), V, gravity=0.0).gain == pytest.approx(3.0, rel=2e-4)


@pytest.mark.parametrize("e1", [0.3, 1.0])
@pytest.mark.parametrize("cushion", [1e3, 5e4])
@pytest.mark.parametrize("gap", [3e-3, 15e-3])
def test_the_way_to_the_second_impact_is_that_of_two_masses(e1, cushion, gap):
    """Both masses, shaper with its damper cut off in tension, cushions and weight, by DOP853 of scipy."""
    one = masses(e1=e1, cushion=cushion, damping=80.0, gap=gap)
    impact = second_impact(one, V)
    damper = 2.0 * float(cut_off_damping_ratio(e1)) * math.sqrt(one.shaper_stiffness * one.table)

    def rates(_, y):
        x, z, u, w = y
        shaper = max(-one.shaper_stiffness * x - damper * u, 0.0) if x < 0.0 else 0.0
        cushion_force = one.cushion_stiffness * (x - z + gap) + one.cushion_damping * (u - w)
        return [u, w, (shaper - cushion_force) / one.table - G, cushion_force / one.second - G]

    def meets(_, y):
        return y[1] - y[0]

    meets.terminal = True
    found = solve_ivp(rates, (0.0, 0.1), [0.0, gap, -V, -V], events=meets, rtol=1e-10, atol=1e-12, max_step=2e-6)
    # 1e-6: scipy steps of 2 us over the corners of the shaper, which it does not locate
    assert impact.time == pytest.approx(found.t_events[0][0], rel=1e-6)
    assert impact.table == pytest.approx(found.y_events[0][0][2], rel=1e-5, abs=1e-5)
    assert impact.second == pytest.approx(found.y_events[0][0][3], rel=1e-6)
    assert impact.cushion_force == pytest.approx(cushion * gap + 80.0 * (impact.table - impact.second), rel=1e-9)


def test_a_second_mass_that_never_comes_is_refused():
    with pytest.raises(ValueError, match="does not meet the table within 1 s"):
        second_impact(masses(gap=5.0), V)


def test_the_case_is_followed_from_the_speeds_of_its_way():
    case = load_case(CASE)
    start, solution = release(case), run_case(case)
    (blow,) = solution.blows
    v = math.sqrt(2.0 * G * 0.5)
    # 5 %: cushions of 20 kN/m, closed by 10 mm, and weight slow the closing of the gap
    assert start.striker - start.object == pytest.approx(1.5 * v, rel=0.05)
    assert blow.approach_speed == pytest.approx(start.striker - start.object, rel=1e-6)
    assert blow.restitution == pytest.approx(0.8, rel=0.02)  # of the pad; the frame takes a part
    assert 2.0 * blow.blow_velocity_change == pytest.approx(blow.contact_impulse, rel=1e-3)  # weight for 100 us besides
    # 2 %: the pad between rigid masses; here the frame of the fixture takes a part
    assert start.object + blow.blow_velocity_change == pytest.approx(start.gain * v, rel=0.02)
    assert solution.balance["energy_error"] < 1e-6
    assert solution.balance["momentum_error"] < 1e-6
    assert solution.launch["gain"] == pytest.approx(start.gain, rel=1e-12)
    assert not solution.broken


def test_speeds_just_before_touch_are_those_of_free_fall():
    """The run begins 10 us before first touch; both masses fall alike until then, so they close evenly."""
    case = load_case(CASE)
    solution = run_case(case)
    data = solution.data
    before = data["time"].values < 9e-6
    speed = data["assembly_speed"].values[before]
    assert np.allclose(np.diff(speed), -G * 1e-6, rtol=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("machine.gap=0 mm", "machine.gap"),
        ("machine.shaper_restitution=1.2", "machine.shaper_restitution"),
        ("striker.mount_stiffness=1e8 N/m", "flies"),
        ("object.gravity=1 m/s^2", "falls alike"),
    ],
)
def test_what_does_not_fit_is_refused(change, words):
    with pytest.raises(InputErrors) as caught:
        check_case(load_case(CASE, [change]))
    assert words in str(caught.value)


def test_a_table_still_on_its_shaper_is_reported():
    near = run_case(load_case(CASE, ["machine.gap=1 mm"]))
    assert "table-on-shaper" in [notice.code for notice in near.notices]
    assert "table-on-shaper" not in [notice.code for notice in run_case(load_case(CASE)).notices]


def test_the_pad_may_be_any_law():
    assert second_impact(masses()._replace(pad=Contact(1e10, 1.5, hysteresis_factor=0.3)), V).gain > 1.0
