"""A machine's contact yields and remembers: on the face, on each nose, and where the object is a stack."""

import math

import numpy as np
import pytest

from strikewave import load_case, run_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.constants import material
from strikewave.contact import Contact, PressureCap, exact, hertz, johnson, line_cap, palmgren, point_cap, solve_impact
from strikewave.machines import blows, run_machine
from strikewave.machines._stack_kernels import INDENTATION
from strikewave.machines.spans import StackSpan
from strikewave.waves import Impactor, Layer, Stack, Tap, WantedError, run_bar

YIELDS = "contact.yield_pressure=1.2 GPa"
STEEL = material("65Mn")


def run(name, *changes):
    return run_case(load_case(name, changes))


def column(solution, name):
    return np.array([getattr(blow, name) for blow in solution.blows])


@pytest.mark.parametrize("name", ["li-ma-2019", "li-ma-2019-fig13"])
def test_spot_of_the_face_yields_ever_less_from_blow_to_blow(name):
    solution = run(name, YIELDS)
    left, flat, stiffness = (
        column(solution, key) for key in ("residual_indentation", "flattening", "contact_stiffness")
    )
    for grown in (left, flat):
        assert np.all(np.diff(grown) >= -1e-15)
        assert grown[1] - grown[0] > grown[2] - grown[1] > grown[3] - grown[2]
    # the flattened spot is stiffer for the same load
    assert stiffness[-1] > stiffness[0]
    assert all(error < 1e-6 for error in solution.balance.values())


def test_what_stays_follows_from_the_deepest_indentation():
    """d_r = D (1 - 1/s), s = q/f(q), with D the largest indentation so far: sampled at 2 001 points a blow, 3e-5."""
    solution = run("li-ma-2019", YIELDS)
    law = palmgren(STEEL, STEEL, 0.04)
    load = float(line_cap(STEEL, STEEL, 0.01, math.inf, 0.04, 1.2e9).yield_load)
    deepest = np.maximum.accumulate(column(solution, "indentation"))
    q = law.stiffness * deepest**law.exponent / load
    s = q / (2 / math.pi * (q * np.arcsin(1 / np.sqrt(q)) + np.sqrt(q - 1)))
    assert column(solution, "flattening") == pytest.approx(s, rel=3e-5)
    assert column(solution, "residual_indentation") == pytest.approx(deepest * (1 - 1 / s), rel=1e-4)
    # where a blow goes deeper than all before, the way back begins with the slope of the elastic law at that depth
    slope = law.exponent * law.stiffness * deepest ** (law.exponent - 1)
    assert column(solution, "contact_stiffness")[:5] == pytest.approx(slope[:5], rel=1e-4)


def test_a_blow_on_a_stack_begins_at_the_dent_of_the_one_before():
    """First touch is where the spot's surface is: at the residual indentation of the blow before."""
    machine = build_machine(load_case("li-ma-2019-fig13", [YIELDS, "feed.blows=2"]))
    found = run_machine(machine)
    first, second = (span for span in found.spans if isinstance(span, StackSpan))
    left = blows(found)[0].residual_indentation
    assert first.history[0, INDENTATION] == 0.0
    assert second.history[0, INDENTATION] == pytest.approx(left, rel=1e-9)
    assert left > 1e-6


def test_each_nose_keeps_its_own_flat_where_noses_yield():
    """Four strikers: blows 1 to 4 find virgin noses, blow 5 the nose of blow 1."""
    solution = run("li-ma-2019", YIELDS, "contact.yields=nose")
    left = column(solution, "residual_indentation")
    # the second to fourth blow are equal but for the droop of the turntable
    assert left[1:4] == pytest.approx(left[1], rel=1e-2)
    assert left[4] > left[0]
    assert left[5] > left[1]


def test_without_a_yield_pressure_nothing_stays():
    solution = run("li-ma-2019")
    assert np.all(column(solution, "residual_indentation") == 0.0)
    assert np.all(column(solution, "flattening") == 1.0)


def test_restitution_of_a_blow_is_the_work_given_back():
    """An elastic contact gives all back, hysteresis takes some, yielding more."""
    elastic, lossy, yielding = (
        column(run("li-ma-2019", "feed.blows=1", *change), "restitution")[0]
        for change in (["contact.restitution=1"], [], [YIELDS])
    )
    assert elastic == pytest.approx(1.0, abs=1e-6)
    assert 0.5 < yielding < lossy < 1.0


@pytest.mark.verify
def test_a_yield_pressure_that_is_never_reached_changes_nothing():
    elastic, capped = run("li-ma-2019"), run("li-ma-2019", "contact.yield_pressure=900 GPa")
    for name in ("rigid_peak", "width", "peak_force", "indentation", "rebound_speed"):
        # steps end at other places: ten times the integrator's tolerance
        assert column(capped, name) == pytest.approx(column(elastic, name), rel=1e-7), name


@pytest.mark.verify
def test_yielding_contact_raises_no_yield_warning_and_names_its_source():
    elastic, yielding = run("li-ma-2019"), run("li-ma-2019", YIELDS)
    assert "contact-yield" in [notice.code for notice in elastic.warnings]
    assert "contact-yield" not in [notice.code for notice in yielding.warnings]
    assert "thornton-1997" in yielding.citations


def test_other_laws_say_what_comes_out_and_where_they_are_from():
    codes = {notice.code: notice for notice in run("li-ma-2019", "contact.damping=hu-guo").warnings}
    assert "from memory" in codes["law-from-memory"].message
    assert codes["restitution-differs"].limit == 0.7
    assert codes["restitution-differs"].value == pytest.approx(0.697, abs=5e-4)


CONTACTS = {
    "thornton": hertz(STEEL, STEEL, 0.01).contact(float(exact(0.8)), point_cap(STEEL, STEEL, 0.01, math.inf, 1e8)),
    "line": Contact(2e7, 10 / 9, cap=PressureCap(500.0, "line")),
    "johnson": johnson(STEEL, STEEL, 0.01, math.inf, 1e-4, 0.03).contact(float(exact(0.7))),
}


@pytest.mark.parametrize("name", sorted(CONTACTS))
def test_striker_on_a_short_bar_is_the_impact_of_two_bodies(name):
    """A free steel slice of 0.459 kg that a wave crosses in 40 ns, within a contact of 350 us and more.

    What the slice takes as waves falls with their ratio, and the step is 10 ns: 1e-4.
    """
    contact, mass, speed = CONTACTS[name], 0.2, 1.0
    thick = 40e-9 * math.sqrt(STEEL.youngs_modulus / STEEL.density)
    area = 0.459 / (STEEL.density * thick)
    stack = Stack((Layer("slice", STEEL.density, STEEL.youngs_modulus, area, thick),))
    blow = solve_impact(contact, mass, 0.459, speed)
    duration = float(blow.duration)
    bar = run_bar(stack, Impactor(mass, speed, contact), [Tap(0, 0.0)], 1.2 * duration, WantedError(step=1e-8))
    begin, end, approach = bar.touches[0]
    reduced = mass * 0.459 / (mass + 0.459)
    assert approach == pytest.approx(speed, rel=1e-9)
    assert end - begin == pytest.approx(duration, rel=1e-4)
    assert bar.impulse == pytest.approx(reduced * speed * (1 + float(blow.restitution)), rel=1e-4)
    assert bar.energy_lost == pytest.approx(float(blow.energy_lost), rel=1e-4)
