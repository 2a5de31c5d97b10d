"""Loads and the times in which they change, by hand and by numerical integrals, roots and slopes of their histories."""

import math

import numpy as np
import pytest
from scipy import integrate, optimize

from strikewave.contact import Contact
from strikewave.waves import BONDED, End, Impactor, Joint, Layer, LoadPulse, Sampled, Stack
from strikewave.waves.load import load_time, refuse_coarse, refuse_few_steps, resolved_period, shortest_time
from strikewave.waves.transit import from_within

PULSES = [
    LoadPulse("half-sine", 300.0, 2e-4),
    LoadPulse("sine-squared", -300.0, 2e-4),
    LoadPulse("rectangle", 300.0, 2e-4),
    LoadPulse("triangle", 300.0, 2e-4, 0.5e-4),
    LoadPulse("triangle", 300.0, 2e-4, 1.4e-4),
    LoadPulse("triangle", 300.0, 2e-4, 2e-4),
    LoadPulse("trapezoid", 300.0, 2e-4, 0.3e-4),
]


@pytest.mark.parametrize("pulse", PULSES, ids=lambda pulse: f"{pulse.shape} {pulse.rise:g}")
def test_integral_rise_and_slope_of_a_pulse_are_those_of_its_history(pulse):
    t = np.linspace(0.0, pulse.duration, 4001)[:-1]
    force = pulse.at(t)
    by_hand = integrate.quad(
        lambda x: float(pulse.at(np.array([x]))[0]),
        0.0,
        pulse.duration,
        points=[pulse.rise or 1e-4, pulse.duration - pulse.rise],
    )[0]
    assert pulse.impulse == pytest.approx(by_hand, rel=1e-9)
    assert np.abs(force).max() == pytest.approx(300.0, rel=1e-3)  # samples beside the peak of a triangle
    assert pulse.largest == 300.0
    assert pulse.at(np.array([-1e-9, pulse.duration, 3e-4])).tolist() == [0.0, 0.0, 0.0]
    if pulse.shape == "rectangle":
        assert (pulse.rise_time, pulse.steepest_time) == (0.0, pulse.duration)
        return
    peak = t[np.abs(force).argmax()]
    at = [
        optimize.brentq(lambda x, share=share: float(pulse.at(np.array([x]))[0]) / pulse.peak - share, 0.0, peak)
        for share in (0.1, 0.9)
    ]
    assert pulse.rise_time == pytest.approx(at[1] - at[0], rel=1e-9)
    steepest = np.abs(np.diff(force)).max() / (t[1] - t[0])
    assert pulse.steepest_time == pytest.approx(300.0 / steepest, rel=1e-5)  # chords of 1/4000 of a sine


def test_a_rise_that_is_not_given_is_half_a_triangle_and_a_quarter_of_a_trapezoid():
    assert [LoadPulse(shape, 1.0, 8.0).rise for shape in ("triangle", "trapezoid", "half-sine")] == [4.0, 2.0, 0.0]
    assert LoadPulse("trapezoid", 1.0, 8.0, 4.0).impulse == 4.0  # no flat top: a triangle
    assert LoadPulse("triangle", 1.0, 8.0, 0.01).rise == 0.01
    for shape, rise in (("triangle", 8.02), ("trapezoid", 4.02), ("triangle", -1.0)):
        with pytest.raises(ValueError, match="rise"):
            LoadPulse(shape, 1.0, 8.0, rise)
    for peak, duration in ((math.inf, 1.0), (1.0, 0.0), (1.0, math.inf), (math.nan, 1.0)):
        with pytest.raises(ValueError, match="finite peak"):
            LoadPulse("half-sine", peak, duration)


def test_a_measured_load_by_hand():
    t, f = [5.0, 6.0, 8.0, 9.0], [0.0, -4.0, -10.0, 0.0]
    load = Sampled(np.array(t), np.array(f))
    assert load.time.tolist() == [0.0, 1.0, 3.0, 4.0]
    assert load.at(np.array([-0.1, 0.5, 2.0, 3.5, 4.1])).tolist() == [0.0, -2.0, -7.0, -5.0, 0.0]
    assert (load.largest, load.duration, load.steepest_time) == (10.0, 4.0, 1.0)
    # 10 % of the peak at 1/4 of the first part, 90 % at 5/6 of the second
    assert load.rise_time == pytest.approx(1.0 + 2.0 * 5.0 / 6.0 - 0.25, rel=1e-12)
    assert load_time(load) == 1.0


@pytest.mark.parametrize(
    ("values", "kind", "rise"),
    [
        ([2.0, 10.0, 0.0], "force", 0.0),  # begins with a jump
        ([2.0, 10.0, 10.0], "speed", 0.0),
        ([0.0, 10.0, 2.0], "force", 0.0),  # ends with one
        ([0.0, 10.0, 2.0], "speed", 0.8),  # the face keeps its speed
        ([0.0, -10.0, -2.0], "incident", 0.0),
        ([0.0, 10.0, 1.0], "force", 0.8),
        ([1.0, 10.0, 0.0], "speed", 8.0 / 9.0),  # a tenth itself is no jump
        ([0.0, 0.0, 0.0], "force", 0.0),
    ],
)
def test_a_measured_load_that_begins_or_ends_above_a_tenth_of_its_peak_jumps(values, kind, rise):
    load = Sampled(np.array([0.0, 1.0, 2.0]), np.array(values), kind)
    assert load.rise_time == pytest.approx(rise, rel=1e-12)
    assert load.at(np.array([2.5]))[0] == (values[-1] if kind == "speed" else 0.0)


def test_a_measured_load_that_never_changes_takes_its_whole_time():
    load = Sampled(np.array([1.0, 4.0]), np.array([7.0, 7.0]), "speed")
    assert (load.steepest_time, load.rise_time, load_time(load)) == (3.0, 0.0, 3.0)
    slow = Sampled(np.array([0.0, 2.0]), np.array([9.0, 10.0]))
    assert slow.steepest_time == 2.0  # ten times at its slope is longer than the load
    weak = Sampled(np.array([0.0, 1.0, 3.0]), np.array([0.0, 5e-3, 5e-3]))
    assert weak.steepest_time == 1.0


@pytest.mark.parametrize(
    ("time", "values"),
    [
        ([0.0], [1.0]),
        ([0.0, 1.0], [1.0, 2.0, 3.0]),
        ([0.0, 0.0], [1.0, 2.0]),
        ([0.0, math.nan], [1.0, 2.0]),
        ([0.0, 1.0], [1.0, math.inf]),
        ([[0.0, 1.0]], [[1.0, 2.0]]),
    ],
)
def test_a_measured_load_needs_rising_times_and_finite_values(time, values):
    with pytest.raises(ValueError, match="load"):
        Sampled(np.array(time), np.array(values))


@pytest.mark.parametrize("values", [(0.0, 1.0), (1.0, 0.0), (math.inf, 1.0), (1.0, math.inf), (-1.0, 1.0)])
def test_an_impactor_has_mass_and_speed(values):
    with pytest.raises(ValueError, match="impactor"):
        Impactor(*values)


def bar(z, length=1.0):
    return Layer("bar", 1.0, z * z, 1.0, length)


SLOW = LoadPulse("rectangle", 5.0, 1e6)


@pytest.mark.parametrize(
    ("joint", "end", "time"),
    [
        (BONDED, End("free"), 1e6 / 20.0),
        (Joint(mass=30.0), End("free"), 30.0 / (2.0 + 4.0)),
        (Joint(mass=5e-3), End("free"), 5e-3 / (2.0 + 4.0)),
        (Joint(stiffness=4.0, attached=4e-3), End("free"), math.sqrt(1e-3)),
        (Joint(stiffness=3.0), End("free"), 1.0 / (3.0 * 0.75)),
        (Joint(stiffness=4.0, attached=100.0), End("free"), 5.0),
        (Joint(unilateral=True), End("free"), 1e6 / 20.0),
        (Joint(stiffness=3.0, unilateral=True), End("free"), 1.0 / 2.25),
        (BONDED, End("mass", 12.0), 3.0),
        (BONDED, End("spring", 16.0), 0.25),
        (BONDED, End("dashpot", 16.0), 1e6 / 20.0),
        (BONDED, End("oscillator", 18.0, 2.0), 3.0),
        (Joint(mass=30.0), End("spring", 16.0), 0.25),
        # 5 N on k d: d/F = 1/k, over the sum of the mobilities
        (Joint(contact=Contact(8.0, 1.0)), End("free"), 1.0 / 8.0 / 0.75),
    ],
)
def test_relaxation_of_joints_and_ends_by_hand(joint, end, time):
    """Behind layers of 2 and 4 N s/m; twenty of them may be covered by what 50 steps resolve."""
    stack = Stack((bar(2.0), bar(4.0)), (joint,), end)
    assert shortest_time(stack, SLOW) == pytest.approx(20.0 * time, rel=1e-12)


def test_a_quadratic_contact_is_pressed_in_the_time_of_its_largest_force():
    """d = sqrt(F/k): F is that of the load, or Z v under a speed, Z v0 under a striker, for which d/v0 counts too."""
    joint = Joint(contact=Contact(8.0, 2.0))
    stack = Stack((bar(2.0), bar(4.0)), (joint,), End("free"))

    def time(force):
        return 20.0 * math.sqrt(force / 8.0) / force / 0.75

    assert shortest_time(stack, LoadPulse("rectangle", 32.0, 1e6)) == pytest.approx(time(32.0), rel=1e-12)
    still = Sampled(np.array([0.0, 1e6]), np.array([16.0, 16.0]), "speed")
    assert shortest_time(stack, still) == pytest.approx(time(32.0), rel=1e-12)
    assert shortest_time(stack, LoadPulse("rectangle", 0.0, 1e6)) == pytest.approx(time(1.0), rel=1e-12)
    lone = Stack((bar(2.0),))
    assert shortest_time(lone, Impactor(6.0, 4.0)) == 3.0
    assert shortest_time(lone, Impactor(6.0, 4.0, Contact(2.0, 2.0))) == pytest.approx(0.5, rel=1e-12)
    soft = Impactor(6.0, 16.0, Contact(1e-9, 2.0))
    assert shortest_time(stack, soft) == pytest.approx(time(32.0), rel=1e-12)


def test_a_load_and_a_run_last_two_steps_at_least():
    refuse_coarse(LoadPulse("rectangle", 5.0, 1.0), 0.5)
    refuse_coarse(LoadPulse("rectangle", 0.0, 1.0), 9.0)
    refuse_few_steps(0.5, 1.0)
    with pytest.raises(ValueError, match="too long for a load"):
        refuse_coarse(LoadPulse("rectangle", 5e-3, 1.0), 0.501)
    with pytest.raises(ValueError, match=r"below 0\.5 s"):
        refuse_coarse(LoadPulse("rectangle", 5.0, 1.0), 0.501)
    with pytest.raises(ValueError, match=r"below 0\.5 s"):
        refuse_few_steps(0.501, 1.0)


def test_a_period_is_resolved_as_far_as_four_million_samples_go():
    assert resolved_period(0.5, 1.0, 2, 50.0) == 0.5
    assert resolved_period(1e-9, 8.0, 3, 50.0) == pytest.approx(50.0 * 24.0 / 4e6, rel=1e-15)


@pytest.mark.parametrize("every", [1, 2, 5])
def test_a_constant_force_is_its_own_average_within_the_run(every):
    """The hat at the first step has half its weight, and half a step, within the run: (1 + 1/every)/2."""
    hat = sum(1.0 - k / every for k in range(every)) / every
    assert from_within(np.array([3.0 * hat]), np.array([3.0]), every) == pytest.approx(3.0, rel=1e-15)
