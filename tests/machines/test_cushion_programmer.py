"""Drop tables on cushions: the pulses of closed forms, sets that stay from blow to blow, wear, and what is refused."""

import math
from itertools import pairwise

import pytest

from strikewave import load_case, run_case
from strikewave.analyses.by_tables import check_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputError
from strikewave.cases.case import dump_case, parse_case
from strikewave.contact import solve_impact
from strikewave.contact.cushions import Pad, crush, cushion_material, elastomer
from strikewave.machines import blows, run_machine

CASE, G = "iec-60068-2-27-rubber", 9.80665
RIGID = ["striker.mass=1e6 kg", "object.frame_stiffness=1e10 N/m", "object.nose_mass=0.1 kg"]
"""A table that hardly bends on a base that hardly moves: 1e-4 of either."""
CRUSH = ["contact.cushion.material=EPS 22", "contact.cushion.diameter=0.5 m", "contact.cushion.thickness=100 mm"]


def changed(*changes):
    return load_case(CASE, [*changes])


def test_the_programmer_is_the_rubber_of_the_table():
    """The contact is that of Gent & Lindley's pad; the blow that of two free bodies, 1e-3 for weight and frame."""
    case = changed()
    row = cushion_material("natural rubber 65 IRHD")
    pad = elastomer(Pad(math.pi * 0.05**2, 0.0252), **row.properties)
    machine = build_machine(case)
    contact = machine.strikers.first.contact
    assert (contact.form, contact.stiffness, contact.limit) == (pad.form, pytest.approx(pad.stiffness), pad.limit)
    solution = run_case(case)
    blow = solution.blows[0]
    free = solve_impact(contact, 20.0, 2000.0, blow.approach_speed)
    # the pad bears the weight too, which a sensor zeroed in the fall reads
    assert blow.rigid_peak - G == pytest.approx(float(free.peak_force) / 20.0, rel=3e-3)
    assert blow.restitution == pytest.approx(0.75, abs=2e-3)
    assert blow.rigid_peak / G == pytest.approx(100.0, rel=1e-3)  # fitted to it, rounded to 0.1 mm
    assert not [notice for notice in solution.warnings if notice.broken]
    notice = next(notice for notice in solution.warnings if notice.code == "cushion")
    assert notice.value == pytest.approx(blow.indentation / 0.0252, rel=1e-12)
    assert "gives back 56" in notice.message
    assert {"contact.cushion.thickness", "contact.cushion.diameter"} <= set(case.values())
    assert case.fitted_fields() == ["contact.cushion.thickness"]


@pytest.mark.parametrize("n", [1.0, 2.5])
def test_a_power_cushion_on_a_rigid_table_is_the_closed_form(n):
    """Peak K d^n with d = ((n+1) m v^2/(2 K))^(1/(n+1)); the weight adds to the work of the pad, the frame takes 5e-4."""
    text = dump_case(changed(*RIGID, "contact.restitution=1"))
    power = f'law = "power"\nstress = "20 MPa"\nexponent = {n}'
    machine = build_machine(parse_case(text.replace('material = "natural rubber 65 IRHD"', power)))
    run = run_machine(machine)
    (blow,) = blows(run)
    k = 20e6 * math.pi * 0.05**2 / 0.0252**n
    # with the weight: K d^(n+1)/(n+1) = m v^2/2 + m g d, by a few fixed-point steps
    d = 0.0
    for _ in range(50):
        d = ((n + 1) / k * (0.5 * 20.0 * blow.approach_speed**2 + 20.0 * G * d)) ** (1 / (n + 1))
    assert blow.indentation == pytest.approx(d, rel=5e-4)
    assert blow.peak_force == pytest.approx(k * d**n, rel=5e-4)
    assert run.energy_error < 1e-6


@pytest.mark.verify
def test_a_crushing_programmer_keeps_its_set_over_its_rebounds():
    """Caught after three blows: the plateau bears no more, each blow that crushes adds to the set, the balance closes."""
    caught = ["machine.until=brake", "machine.brake_after=3"]
    case = changed(*RIGID, *CRUSH, *caught, "contact.restitution=1", "machine.height=1 m")
    machine = build_machine(case)
    run = run_machine(machine)
    found = blows(run)
    plateau = 135e3 * 0.25 * math.pi * 0.5**2
    speed = found[0].approach_speed
    pad = crush(Pad(0.25 * math.pi * 0.5**2, 0.1), 5e6, 135e3)
    free = solve_impact(pad, 20.0, math.inf, speed)
    assert found[0].peak_force == pytest.approx(plateau, rel=1e-6)
    # the weight works too, over the set
    work = 0.5 * 20.0 * speed**2 - plateau**2 / (2.0 * float(pad.stiffness)) + 20.0 * G * found[0].indentation
    assert found[0].residual_indentation == pytest.approx(work / plateau, rel=5e-4)
    assert found[0].restitution == pytest.approx(float(free.restitution), rel=0.02)
    sets = [blow.residual_indentation for blow in found]
    assert len(sets) == 3
    assert all(later >= earlier for earlier, later in pairwise(sets))
    assert run.energy_error < 1e-6


def test_blows_before_wear_the_pad():
    """h (1 - s)^N and E (1 + g)^N with the shape factor of what is left."""
    worn = ["contact.cushion.blows_before=10", "contact.cushion.settling=0.01", "contact.cushion.stiffening=0.02"]
    contact = build_machine(changed(*worn)).strikers.first.contact
    left = 0.0252 * 0.99**10
    pad = elastomer(Pad(math.pi * 0.05**2, left), 5.72e6 * 1.02**10, 0.54)
    assert contact.stiffness == pytest.approx(pad.stiffness, rel=1e-12)
    assert contact.limit == pytest.approx(left, rel=1e-12)


WRONG = [
    (["contact.cushion.thickness=0 mm"], "contact.cushion.thickness: got", "above 0 m"),
    (["contact.cushion.thicknes=1 mm"], "contact.cushion.thicknes: unknown key", 'did you mean "thickness"'),
    (["contact.cushion.area=10 cm^2"], "contact.cushion.area: got", "diameter or area, not both"),
    (["contact.cushion.plateau=1 MPa"], "contact.cushion.plateau: got", "none for the law elastomer"),
    (["contact.cushion.law=foam"], "contact.cushion.law: got", "elastomer, that of natural rubber 65 IRHD"),
    (["contact.law=palmgren"], "contact.law: got", '"cushion" where the case has [contact.cushion]'),
    (["contact.exponent=2"], "contact.exponent: got", "none for the law cushion"),
    (["contact.yield_pressure=1 GPa"], "contact.yield_pressure: got", "none for the law cushion"),
    (["contact.cushion.retardation=10 us"], "contact.restitution: got", "it loses energy in one way"),
    (
        ["contact.cushion.material=lead", "contact.cushion.densification=0.0001"],
        "contact.cushion: ",
        "limit of the crush",
    ),
]


@pytest.mark.parametrize(("changes", "field", "words"), WRONG)
def test_what_a_cushion_cannot_be_is_refused_with_its_field(changes, field, words):
    with pytest.raises(InputError) as caught:
        check_case(changed(*changes))
    assert str(caught.value).startswith(field)
    assert words in str(caught.value)


def test_a_pad_that_bottoms_out_ends_the_run_with_a_remedy():
    with pytest.raises(Exception, match="it bottoms out, its law ends at"):
        run_case(changed("machine.height=20 m", "contact.cushion.diameter=10 mm"))


def test_a_retarded_pad_loses_more_the_faster_it_is_pressed():
    """The loss of a retardation grows with the speed, where that of a restitution does not."""
    lossy = ["contact.restitution=1", "contact.cushion.loss_factor=0.3", "contact.cushion.loss_frequency=80 Hz"]
    (blow,) = blows(run_machine(build_machine(changed(*RIGID, *lossy))))
    contact = build_machine(changed(*lossy)).strikers.first.contact
    free = solve_impact(contact, 20.0, math.inf, blow.approach_speed)
    assert blow.restitution == pytest.approx(float(free.restitution), abs=0.01)
    assert 0.5 < blow.restitution < 0.8
