"""Cushions between layers and under a striker, against ordinary differential equations of endless bars."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave import load_case, run_wave
from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case
from strikewave.cases.stack_of_case import build_stack
from strikewave.contact import HardeningContact
from strikewave.contact.cushions import Pad, crush, elastomer, foam, retarded, tangent
from strikewave.waves import End, Impactor, Joint, Layer, LoadPulse, Stack, Tap, WantedError, _kernels, run_bar
from strikewave.waves.transit import empty_averages, grid_of, nearest_nodes, state_at_rest, tables_of

STEP, Z1, Z2 = 1e-7, 8e3, 5e3
PULSE = LoadPulse("sine-squared", 2e4, 60e-6, kind="incident")
PAD = Pad(area=5e-4, thickness=2e-4)
LAWS = {
    "tangent": tangent(PAD, 4e7, 0.6),
    "elastomer": elastomer(PAD, 4e7, shape_factor=0.0),
    "foam": foam(PAD, 4e8, 1.2e7, 0.9),
}


def timed(name, impedance):
    return Layer(name, 1.0, impedance * impedance, 1.0, 200 * STEP * impedance)


def stack(joint):
    return Stack((timed("before", Z1), timed("after", Z2)), (joint,), End("matched"))


def force_and_slope(contact, d):
    """Force and slope of a cushion at depths, written down anew."""
    d, k, end = np.maximum(d, 0.0), contact.stiffness, contact.limit
    if contact.form == "tangent":
        a = math.pi / (2 * end)
        return k / a * np.tan(a * d), k / np.cos(a * d) ** 2
    if contact.form == "elastomer":
        w = 1 - d / end
        return k * end / 3 * (w**-2 - w), k / 3 * (2 * w**-3 + 1)
    plateau = contact.plateau
    dense = plateau / 2.3 * end / (end - d)
    force = np.where(d < plateau / k, k * d, np.where(d < end * (1 - 1 / 2.3), plateau, dense))
    return force, np.where(d < plateau / k, k, np.where(d < end * (1 - 1 / 2.3), 0.0, dense / (end - d)))


@pytest.mark.parametrize(
    ("law", "retardation"),
    [("tangent", 0.0), ("tangent", 2e-6), ("elastomer", 0.0), ("elastomer", 2e-6), ("foam", 0.0)],
)
def test_a_cushion_between_endless_bars(law, retardation):
    """d' = 2 P/Z1 - (1/Z1 + 1/Z2) f with f = F + T F' d' never below zero: second order in the step, first at corners."""
    bare, y = LAWS[law], 1 / Z1 + 1 / Z2

    def pushed(t, d):
        b = 2 * PULSE.at(t) / Z1
        force, slope = force_and_slope(bare, d)
        f = (force + retardation * slope * b) / (1 + retardation * slope * y)
        return np.where(d >= 0.0, np.maximum(f, 0.0), 0.0)

    misses = []
    for step in (STEP / 2, STEP / 4):
        joint = Joint(contact=retarded(bare, retardation) if retardation else bare)
        run = run_bar(stack(joint), PULSE, [Tap(1, 0.0)], 1.5e-4 + 200 * STEP, WantedError(step=step))
        times = step * np.arange(round(1.2e-4 / step) + 1)
        found = solve_ivp(
            lambda t, d: 2 * PULSE.at(t) / Z1 - y * pushed(t, d),
            (0, times[-1]),
            [0.0],
            "LSODA",
            times,
            rtol=1e-10,
            atol=1e-16,
            max_step=2e-7,
        )
        expected = pushed(times, found.y[0])
        first = round(200 * STEP / step)
        misses.append(np.abs(run.force[first : first + len(times), 0] - expected).max() / expected.max())
        assert expected.max() > 5e3
    smooth = law != "foam"
    assert misses[1] < (2e-4 if smooth else 2e-2)
    assert misses[0] / misses[1] > (3.0 if smooth and not retardation else 1.5)


@pytest.mark.parametrize(
    ("contact", "retardation"),
    [*((law, time) for law in LAWS.values() for time in (0.0, 2e-6)), (crush(PAD, 4e8, 1.2e7), 0.0)],
    ids=[*(f"{law}-{time}" for law in LAWS for time in (0.0, 2e-6)), "crush"],
)
def test_what_a_cushion_loses_is_missing_in_the_waves(contact, retardation):
    """Energy of the incident wave = of the waves that leave + lost in the joint, better with half the step."""
    joint = Joint(contact=retarded(contact, retardation) if retardation else contact)
    errors = []
    for step in (STEP, STEP / 2):
        bars = stack(joint)
        grid = grid_of(bars, step)
        tables, state = tables_of(bars, grid), state_at_rest(bars, grid)
        load = PULSE.at(step * np.arange(round(3e-4 / step)))
        nodes = nearest_nodes(grid, ((0, 0.0), (1, 1.0)))
        rows = load.size
        taken = _kernels.Recording(nodes, 1, np.zeros((rows, 2)), np.zeros((rows, 2)))
        none = _kernels.Recording(np.zeros((0, 2), np.int64), 1, np.zeros((1, 0)), np.zeros((1, 0)))
        extremes = _kernels.Extremes(np.zeros((0, 2), np.int64), 1, np.zeros(0), np.zeros(0))
        averages = empty_averages(none.nodes, none.nodes, 1, 1)
        _kernels.drive(tables, state, load, _kernels.INCIDENT, (taken, none), averages, extremes, np.zeros(6))
        into = float(np.sum(load**2)) * step / Z1
        back = float(np.sum((taken.force[:, 0] - load) ** 2)) * step / Z1
        on = float(np.sum(taken.force[:, 1] ** 2)) * step / Z2
        lost = float(state.joint[0, _kernels.LOST])
        errors.append(abs(into - back - on - lost) / into)
        assert (lost > 1e-3 * into) == bool(retardation or contact.cap is not None)
    assert errors[1] < 2e-3
    assert errors[1] < errors[0] or errors[0] < 1e-5


@pytest.mark.parametrize("law", ["tangent", "elastomer"])
def test_a_striker_on_a_cushion_on_an_endless_bar(law):
    """m u' = -F, d' = u - F/Z: second order in the step."""
    contact, mass, speed = LAWS[law], 0.05, 3.0

    def rates(t, x):
        f = float(force_and_slope(contact, x[0])[0])
        return [x[1] - f / Z1, -f / mass]

    misses = []
    for step in (STEP, STEP / 2):
        bar = Stack((timed("bar", Z1),), (), End("matched"))
        run = run_bar(bar, Impactor(mass, speed, contact), [Tap(0, 0.0)], 6e-5, WantedError(step=step))
        times = step * np.arange(len(run.face_force) - 1)
        found = solve_ivp(rates, (0, times[-1]), [0.0, speed], "LSODA", times, rtol=1e-10, atol=1e-14)
        expected = force_and_slope(contact, found.y[0])[0]
        misses.append(np.abs(run.face_force[: len(times)] - expected).max() / expected.max())
    assert misses[1] < 1e-4
    assert misses[0] / misses[1] == pytest.approx(4.0, abs=0.5)


BAR = """
schema = 1
[[stack.layer]]
name = "upper"
material = "65Mn"
length = "50 mm"
diameter = "30 mm"
[[stack.layer]]
name = "lower"
material = "65Mn"
length = "50 mm"
diameter = "20 mm"
[[stack.joint]]
after = "upper"
kind = "cushion"
[stack.joint.cushion]
law = "tangent"
thickness = "2 mm"
modulus = "20 MPa"
limit_strain = 0.6
loss_factor = 0.2
loss_frequency = "2 kHz"
[load]
shape = "half-sine"
peak = "500 N"
duration = "300 us"
[solver]
duration = "1 ms"
"""


def test_a_case_puts_a_cushion_between_its_layers():
    """Of the area of the smaller neighbour, with the retardation eta/(2 pi f)."""
    case = parse_case(BAR)
    contact = build_stack(case).joints[0].contact
    area = math.pi * 0.01**2
    assert isinstance(contact, HardeningContact)
    assert contact.stiffness == pytest.approx(20e6 * area / 2e-3, rel=1e-12)
    assert contact.limit == pytest.approx(1.2e-3, rel=1e-12)
    assert contact.damper.coefficient == pytest.approx(0.2 / (2 * math.pi * 2e3), rel=1e-12)
    solution = run_wave(case)
    assert not [notice for notice in solution.warnings if notice.broken]
    assert "stack.joint.upper.cushion.modulus" in case.values()
    assert load_case("li-ma-2019-fig13-bar").contact is None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('law = "tangent"', 'law = "tangens"', 'stack.joint.upper.cushion.law: got "tangens".*did you mean "tangent"'),
        ('law = "tangent"', "", "stack.joint.upper.cushion.law: missing.*a cushion law, or a material"),
        ('law = "tangent"', 'material = "leed"', 'cushion.material: got "leed".*did you mean "lead"'),
        ("limit_strain = 0.6", "", "cushion.limit_strain: missing.*for the law tangent; add limit_strain = 0.8"),
        ("limit_strain = 0.6", "limit_strain = 1.6", "cushion.limit_strain: got 1.6.*at most 1"),
        ("loss_factor = 0.2", "", "cushion.loss_factor: missing.*beside loss_frequency"),
        ("loss_factor = 0.2", 'loss_factor = 0.2\nretardation = "1 us"', "cushion.retardation: got .*not both"),
        ("modulus = ", "exponent = 2\nmodulus = ", "cushion.exponent: got 2.*which takes modulus, limit_strain"),
        ("[stack.joint.cushion]", "[stack.joint.cushions]", 'cushions: unknown key.*did you mean "cushion"'),
        ('kind = "cushion"', 'kind = "cushion"\nstiffness = "1 kN/m"', "stiffness.*for a joint of kind cushion"),
        ('kind = "cushion"', 'kind = "bonded"', "cushion.*for a joint of kind bonded"),
    ],
)
def test_a_cushion_that_cannot_be_is_refused_with_its_field(old, new, words):
    with pytest.raises(InputError, match=words):
        build_stack(parse_case(BAR.replace(old, new, 1)))
