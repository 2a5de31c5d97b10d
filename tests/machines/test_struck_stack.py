"""A machine that strikes a stack: its limit of rigid parts, its balances, its table of blows, its errors."""

import dataclasses
import math
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave import load_case
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.observe import observe
from strikewave.base.errors import StrikewaveError
from strikewave.machines import _stack_kernels as column
from strikewave.machines import blows, run_machine
from strikewave.machines import run as machine_runs
from strikewave.machines import strike as one_blow
from strikewave.machines._layout import layout_of
from strikewave.machines.spans import StackSpan
from strikewave.machines.struck_object import LayeredObject, StruckObject, machine_grid
from strikewave.waves import BONDED, Branch, Joint, Layer, Stack

CASE = "li-ma-2019-fig5"


@pytest.fixture(scope="module")
def base():
    """The machine of a case with a stack, set to one blow."""
    return build_machine(load_case(CASE, ["feed.blows=1"]))


def with_stack(base, stack, first, step, taps=((0, 0.5),)):
    """Return a machine that strikes a stack whose assembly begins with a layer."""
    layered = LayeredObject(stack, first, machine_grid(stack, step), taps)
    names = ("nose_mass", "assembly_mass", "frame_stiffness", "frame_damping")
    struck = dataclasses.replace(base.struck, **{name: getattr(layered, name) for name in names})
    return dataclasses.replace(base, struck=struck, layered=layered)


def part(name, mass, transit, short=1.0):
    """Return a layer of steel's modulus by mass and transit; ``short`` scales its length, not its mass or modulus.

    Density goes with 1/short, the wave speed with its root: a transit of transit sqrt(short).
    """
    modulus, area = 211e9, 7e-4
    density = (mass / transit / area) ** 2 / modulus
    length = mass / (density * area)
    return Layer(name, density / short, modulus, area, length * short)


def stack_spans(run):
    return [span for span in run.spans if isinstance(span, StackSpan)]


# the limit of rigid parts


def test_stack_of_short_parts_is_nose_and_assembly_on_their_frame(base):
    """Lengths times s at the same mass and modulus: compliance goes with s, so does the difference, and at 1/256 it is gone.

    Contact force and rigid acceleration over time, and what the table of blows says, against the machine without
    a stack; to 1e-3 of the peak, which is what is left of 18 % after eight halvings.
    """
    frame = Joint(9e7, 200.0)
    masses = [0.06, 0.24, 0.18]
    struck = dataclasses.replace(
        base.struck, nose_mass=masses[0], assembly_mass=sum(masses[1:]), frame_stiffness=9e7, frame_damping=200.0
    )
    chain = run_machine(dataclasses.replace(base, struck=struck, layered=None))
    expected = blows(chain)[0]
    times = expected.time + np.arange(0.0, 400e-6, 1e-7)
    bodies = chain.sample(times)
    scales, errors = (1 / 4, 1 / 16, 1 / 64, 1 / 256), []
    for s in scales:
        # transits of 2, 8 and 12 us times sqrt(s) are whole steps throughout
        parts = [part(name, m, t, s) for name, m, t in zip("nab", masses, (2e-6, 8e-6, 12e-6), strict=True)]
        machine = with_stack(base, Stack(tuple(parts), (frame, BONDED)), 1, 12.5e-9)
        assert machine.layered.grid.mismatch < 1e-12
        assert (machine.struck.nose_mass, machine.struck.mass) == pytest.approx((0.06, 0.48), rel=1e-12)
        run = run_machine(machine)
        found, moments = blows(run)[0], run.sample(times)
        assert (found.kind, found.striker, found.contacts) == (expected.kind, expected.striker, expected.contacts)
        assert found.approach_speed == pytest.approx(expected.approach_speed, rel=1e-6)
        differences = [
            np.abs(moments.contact_force - bodies.contact_force).max() / bodies.contact_force.max(),
            np.abs(moments.rigid_acceleration - bodies.rigid_acceleration).max() / bodies.rigid_acceleration.max(),
            np.abs(moments.object_speed - bodies.object_speed).max() / np.abs(bodies.object_speed).max(),
        ]
        names = ("width", "contact_impulse", "velocity_change", "blow_velocity_change")
        differences += [abs(getattr(found, name) / getattr(expected, name) - 1.0) for name in names]
        errors.append(differences)
    rates = np.log(np.array(errors[:-1]) / errors[1:]) / math.log(4)
    # the mean of three fourfold steps; the smallest errors are near those of step and integrator
    assert rates.mean(axis=0) == pytest.approx(1.0, abs=0.1), rates
    assert max(errors[-1]) < 1e-3, errors[-1]
    assert found.peak_force == pytest.approx(expected.peak_force, rel=1e-3)
    assert found.rigid_peak == pytest.approx(expected.rigid_peak, rel=1e-3)
    assert found.largest_displacement == pytest.approx(expected.largest_displacement, rel=1e-3)


def test_stiffness_between_the_parts_is_that_of_a_quasi_static_push(base):
    """Frame and bars in series: a part of mass m pushed at its face is shortened, in the mean, by F l/(3 E A) each."""
    nose, assembly = part("nose", 0.06, 2e-6), part("assembly", 0.4, 9e-6)
    machine = with_stack(base, Stack((nose, assembly), (Joint(9e7),)), 1, 50e-9)
    compliance = 1 / 9e7 + sum(x.length / (3 * x.modulus * x.area) for x in (nose, assembly))
    assert machine.struck.frame_stiffness == pytest.approx(1 / compliance, rel=1e-12)
    # cut into bonded pieces it is the same bar
    pieces = [dataclasses.replace(assembly, length=assembly.length * share) for share in (0.2, 0.5, 0.3)]
    cut = with_stack(base, Stack((nose, *pieces), (Joint(9e7), BONDED, BONDED)), 1, 50e-9)
    assert cut.struck.frame_stiffness == pytest.approx(1 / compliance, rel=1e-12)


def mean_displacement(part, slices=2000):
    """Return how far a part moves on its face that the frame pushes with 1 N, in the mean of its mass, m: slice by slice.

    ``part`` holds from that face on a layer and the joint behind it; all of it is accelerated alike.
    """
    total = sum(layer.mass + (joint.mass if joint else 0.0) for layer, joint in part)
    passed = moved = mean = 0.0
    for layer, joint in part:
        for _ in range(slices):  # each half pushed by what is behind its middle
            m, length = layer.mass / slices, layer.length / slices
            force = 1.0 - (passed + 0.5 * m) / total
            step = force * length / (layer.modulus * layer.area)
            mean += m / total * (moved + 0.5 * step)
            moved, passed = moved + step, passed + m
        if joint is not None:
            mean, passed = mean + joint.mass / total * moved, passed + joint.mass
            moved += (1.0 - passed / total) / joint.stiffness
    return mean


def test_stiffness_of_uneven_parts_is_that_of_an_even_acceleration():
    """Parts of several layers, a point mass and compliant joints on both sides of the frame, by slices."""
    layers = [
        dataclasses.replace(part(name, m, t), modulus=e, area=a)
        for name, m, t, e, a in (
            ("a", 0.05, 3e-6, 2.1e11, 7e-4),
            ("b", 0.03, 2e-6, 7e10, 9e-4),
            ("c", 0.09, 5e-6, 1.1e11, 5e-4),
            ("d", 0.04, 4e-6, 3e10, 8e-4),
            ("e", 0.02, 1e-6, 4e9, 6e-4),
        )
    ]
    joints = (Joint(3e8, 70.0), Joint(9e7, 200.0), Joint(mass=0.013), Joint(2e8, 150.0))
    stack = Stack(tuple(layers), joints)
    layered = LayeredObject(stack, 2, machine_grid(stack, 50e-9))
    mass = [layer.mass for layer in layers]
    assert layered.nose_mass == pytest.approx(mass[0] + mass[1], rel=1e-14)
    assert layered.assembly_mass == pytest.approx(sum(mass[2:]) + 0.013, rel=1e-14)
    assert layered.frame_damping == 200.0
    before = [(layers[1], joints[0]), (layers[0], None)]
    behind = [(layers[2], joints[2]), (layers[3], joints[3]), (layers[4], None)]
    compliance = 1 / 9e7 + mean_displacement(before) + mean_displacement(behind)
    # the square of a slice
    assert layered.frame_stiffness == pytest.approx(1 / compliance, rel=1e-6)
    heavy = LayeredObject(Stack(tuple(layers), (Joint(mass=0.013), *joints[1:])), 2, layered.grid)
    assert heavy.nose_mass == pytest.approx(mass[0] + mass[1] + 0.013, rel=1e-14)
    last = LayeredObject(stack, 4, layered.grid)
    assert last.assembly_mass == mass[4]
    behind = 1 / 2e8 + mean_displacement([(layers[4], None)])
    nose = [(layers[3], joints[2]), (layers[2], joints[1]), (layers[1], joints[0]), (layers[0], None)]
    assert last.frame_stiffness == pytest.approx(1 / (behind + mean_displacement(nose)), rel=1e-6)


def test_steps_of_a_stack_are_20_to_40_ns_and_whole_to_one_in_ten_thousand():
    """Transits of 1 us and 1.3 us are whole at 33.3 ns, two of 1 us at 40 ns."""
    for ratio, counts in ((1.3, (30, 39)), (1.0, (25, 25))):
        stack = Stack((part("a", 0.06, 0.9999e-6), part("b", 0.06, ratio * 0.9999e-6)), (BONDED,))
        assert machine_grid(stack).counts == counts
    asked = machine_grid(stack, 0.1e-6)
    assert (asked.step, asked.counts) == (0.1e-6, (10, 10))
    short = Stack((part("a", 0.06, 21e-9), part("b", 0.06, 42e-9)), (BONDED,))
    assert machine_grid(short).counts == (1, 2)


def test_frame_swings_and_stop_throws_back_as_two_bodies_do():
    """Nose and assembly against each other, and the whole object on a damped stop until its force is gone."""
    struck = StruckObject(0.07, 0.43, 9.1e7, 210.0, 41e3, 390.0, 23.0, 2.1e5, 0.55, 9.7)
    swing = math.sqrt(9.1e7 / 0.07 + 9.1e7 / 0.43)
    assert 2.0 * math.pi * struck.frame_frequency == pytest.approx(swing, rel=1e-14)

    def gone(_, y):
        return 2.1e5 * y[0] + struck.stop_damping * y[1] + 1e-9

    gone.terminal, gone.direction = True, -1.0
    rates = lambda _, y: [y[1], -(2.1e5 * y[0] + struck.stop_damping * y[1]) / 0.5]  # noqa: E731
    end = solve_ivp(rates, (0.0, 0.1), [0.0, 1.0], events=gone, rtol=1e-10, atol=1e-14).y_events[0][0]
    assert end[1] == pytest.approx(-0.55, rel=1e-7)
    assert struck.mass == pytest.approx(0.5)
    assert struck.stop_compression * 2.1e5 == pytest.approx(390.0 - 0.5 * 9.7)
    assert struck.rail.holds == 0.0
    assert not struck.rubs
    assert dataclasses.replace(struck, friction=5e-3).rubs
    assert len(struck.links(-5e-3)) == 3
    free = dataclasses.replace(struck, stop_stiffness=0.0)
    assert free.stop_compression == 0.0
    assert free.links(-5e-3)[2].offset > 1e3  # nowhere
    assert struck.links(-5e-3)[2].offset == pytest.approx(5e-3 - struck.stop_compression)
    assert dataclasses.replace(struck, stop_restitution=1.0).stop_damping == pytest.approx(0.0, abs=1e-9)


def test_bonded_cut_changes_nothing(base):
    """A layer cut in two bonded halves is the same bar: every history to rounding of a chain of contacts."""
    nose, assembly, frame = part("nose", 0.06, 2e-6), part("assembly", 0.4, 9e-6), Joint(9e7, 200.0)
    halves = [dataclasses.replace(assembly, name=name, length=0.5 * assembly.length) for name in "ab"]
    one = run_machine(with_stack(base, Stack((nose, assembly), (frame,)), 1, 50e-9, ((1, 1.0),)))
    two = run_machine(with_stack(base, Stack((nose, *halves), (frame, BONDED)), 1, 50e-9, ((2, 1.0),)))
    (first,), (second,) = stack_spans(one), stack_spans(two)
    scale = np.abs(first.history).max(axis=0)
    assert first.history.shape == second.history.shape
    assert np.all(np.abs(first.history - second.history).max(axis=0) <= 1e-9 * scale)
    for a, b in zip(first.tap(0), second.tap(0), strict=True):
        assert a == pytest.approx(b, abs=1e-9 * np.abs(first.tap(0)[2]).max())


# the step


def test_halving_the_step_keeps_the_peaks():
    """Of total, wave and rigid acceleration, contact force and sensors: each by less than 1 %.

    The largest wave has a neighbour of the other sign nearly as high, so magnitudes are compared.
    """
    seen = [
        observe(load_case(CASE, ["feed.blows=1", *step])) for step in ([], ["solver.step=14 ns"], ["solver.step=7 ns"])
    ]
    own = seen[0].run.machine.layered.grid.step
    assert 25e-9 < own < 40e-9
    finest = seen[-1]
    for coarse in seen[:-1]:
        for name in ("wave_peak", "total_peak"):
            found, expected = getattr(coarse.readings[0], name), getattr(finest.readings[0], name)
            assert abs(found) == pytest.approx(abs(expected), rel=1e-2), name
        for name in ("rigid_peak", "peak_force", "width", "velocity_change"):
            assert getattr(coarse.blows[0], name) == pytest.approx(getattr(finest.blows[0], name), rel=2e-3), name
        for name, pulse in coarse.readings[0].sensors.items():
            assert pulse.peak == pytest.approx(finest.readings[0].sensors[name].peak, rel=1e-2), name


# balances

FRAMES = ("bonded", "compliant", "gasket", "bolted", "soft bolted")
JOINTS = (*FRAMES, "gap", "soft gap", "mass")


@st.composite
def struck_stacks(draw):
    """Return a random stack that a machine may strike, the first layer of its assembly, and the steps of its transits."""
    count = draw(st.integers(2, 4))
    first = draw(st.integers(1, count - 1))
    layers = tuple(part(f"{k}", draw(st.floats(0.04, 0.25)), draw(st.integers(20, 200)) * 5e-8) for k in range(count))
    joints = []
    for k in range(count - 1):
        kind = draw(st.sampled_from(FRAMES if k == first - 1 else JOINTS))
        stiffness = 10.0 ** draw(st.floats(7.5, 9.5))
        damping = draw(st.floats(0.0, 0.1)) * math.sqrt(0.1 * stiffness)
        branch = Branch(stiffness * draw(st.floats(0.1, 2.0)), 10.0 ** draw(st.floats(-6.0, -4.0)))
        preload, gap = draw(st.floats(1e3, 2e4)), draw(st.floats(0.0, 5e-6))
        joints.append(
            {
                "bonded": BONDED,
                "compliant": Joint(stiffness, damping),
                "gasket": Joint(stiffness, damping, (branch,)),
                "bolted": Joint(unilateral=True, preload=preload),
                "soft bolted": Joint(stiffness, damping, unilateral=True, preload=preload),
                "gap": Joint(unilateral=True, gap=gap),
                "soft gap": Joint(stiffness, damping, unilateral=True, gap=gap),
                "mass": Joint(mass=draw(st.floats(0.005, 0.05))),
            }[kind]
        )
    return Stack(layers, tuple(joints)), first


@pytest.mark.verify
@settings(max_examples=25)
@given(drawn=struck_stacks())
def test_balances_hold_whatever_the_stack(base, drawn):
    """Energy to 1e-6 of what flowed, which is what steps of 50 ns leave; momentum to 1e-9, which is rounding."""
    stack, first = drawn
    run = run_machine(with_stack(base, stack, first, 50e-9))
    assert run.energy_error < 1e-6
    assert stack_spans(run)
    for span in stack_spans(run):
        assert span.momentum_error < 1e-9
    for blow in blows(run):
        assert blow.kind == "missed" or blow.momentum_error < 1e-9


def run_and_book_the_frame(machine):
    """Return a run and the energy that each of its blows books as lost in the object, J."""
    booked = []

    def strike(layered, struck, system, start, **others):
        span, end = one_blow.strike(layered, struck, system, start, **others)
        at = layout_of(system)
        booked.append((end.y - start.y)[at.dissipated][at.frame])
        return span, end

    with mock.patch.object(machine_runs, "strike", strike):
        return run_machine(machine), booked


@pytest.mark.verify
@settings(max_examples=25)
@given(drawn=struck_stacks())
def test_object_never_gains_energy_by_a_blow_of_its_own(base, drawn):
    """What joints lose and what still rings when nose and assembly go on as bodies: never less than nothing.

    Supports hold the end of the stack, and the mean of the assembly between blows: the preload over some 3 um.
    """
    stack, first = drawn
    run, booked = run_and_book_the_frame(with_stack(base, stack, first, 50e-9))
    assert len(booked) == len(stack_spans(run))
    between = 3e-6 * run.machine.struck.preload
    for energy in booked:
        assert energy > -max(between, 1e-3 * 0.5 * run.machine.struck.mass * run.machine.nominal_approach**2)


def test_parts_thrown_apart_do_not_bend_the_frame(base):
    """A nose of three loose parts is spread by the blow; as a bend of the frame that would hold more than the blow's energy."""
    loose = Joint(2e9, 1e3, unilateral=True, gap=2e-6)
    parts = [
        part(name, m, t) for name, m, t in zip("nmka", (0.06, 0.1, 0.1, 0.2), (2e-6, 5e-6, 5e-6, 6e-6), strict=True)
    ]
    machine = with_stack(base, Stack(tuple(parts), (loose, loose, BONDED)), 3, 50e-9)
    run, booked = run_and_book_the_frame(machine)
    (span,) = stack_spans(run)
    last = span.history[-1]
    spread = abs(last[column.NOSE_PLACE] - last[column.ASSEMBLY_PLACE])
    bent = 0.5 * machine.struck.frame_stiffness * spread**2
    moving = 0.5 * machine.struck.mass * last[column.ASSEMBLY_SPEED] ** 2
    assert bent > moving
    assert booked[0] >= 0.0
    assert run.energy_error < 1e-6
    # as bodies they ring on with no more than what moved them: F = sqrt(2 K E) at most
    times = span.end + np.linspace(1e-9, 1e-3, 5001)
    after = np.abs(run.sample(times).rigid_acceleration).max()
    kinetic = 0.5 * 0.46 * base.nominal_approach**2
    assert after * machine.struck.assembly_mass < math.sqrt(2 * machine.struck.frame_stiffness * kinetic)


STACKS = {
    "compliant frame": Stack((part("n", 0.06, 2e-6), part("a", 0.4, 8e-6)), (Joint(3e8, 300.0),)),
    "bonded frame": Stack((part("n", 0.06, 2e-6), part("a", 0.4, 8e-6)), (BONDED,)),
    # light: thrown back onto its stop and struck again and again
    "light, compliant": Stack((part("n", 0.06, 2e-6), part("a", 0.06, 8e-6)), (Joint(3e8, 300.0),)),
    "light, bonded": Stack((part("n", 0.06, 2e-6), part("a", 0.2, 8e-6)), (BONDED,)),
    "gasket and gap": Stack(
        (part("n", 0.06, 2e-6), part("a", 0.2, 8e-6), part("b", 0.2, 6e-6)),
        (Joint(2e8, 100.0, (Branch(2e8, 5e-6),)), Joint(2e9, 1e3, unilateral=True, gap=2e-6)),
    ),
    "bolted": Stack(
        (part("n", 0.06, 2e-6), part("a", 0.2, 8e-6), part("b", 0.2, 6e-6)),
        (Joint(2e8, 100.0), Joint(2e9, 1e3, unilateral=True, preload=2e3)),
    ),
}


@pytest.mark.verify
@pytest.mark.parametrize("name", STACKS)
def test_energy_balance_closes_with_the_step(base, name):
    """Second order: the trapezoidal rule everywhere. Between blows the integrator adds its own 1e-10."""
    errors = []
    for step in (100e-9, 50e-9, 25e-9):
        errors.append(run_machine(with_stack(base, STACKS[name], 1, step), tolerance=1e-11).energy_error)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.25), f"orders {orders}, errors {errors}"
    assert errors[-1] < 5e-8, errors


# the table of blows


@pytest.mark.parametrize("name", STACKS)
def test_blow_is_force_impulse_and_momentum_at_once(base, name):
    """The table's impulse is mass times velocity change of the blow, and the integral of the force that the history shows."""
    run = run_machine(with_stack(base, STACKS[name], 1, 25e-9))
    mass = run.machine.struck.mass
    found = blows(run)
    assert any(blow.kind != "missed" for blow in found)
    for blow in found:
        if blow.kind == "missed":
            continue
        assert blow.impulse == pytest.approx(mass * blow.blow_velocity_change, abs=1e-9 * blow.contact_impulse)
        assert blow.impulse == pytest.approx(blow.contact_impulse + blow.support_impulse, rel=1e-12)
    for span in stack_spans(run):
        history, step = span.history, span.step
        force = history[:, column.CONTACT_FORCE]
        entered = history[:, column.CONTACT_IMPULSE]
        assert force.min() >= 0.0
        assert np.all(np.diff(entered) >= 0.0)
        # samples of 0.1 us against each step: the trapezoidal rule on a pulse of some 20 us
        assert step * (force.sum() - 0.5 * (force[0] + force[-1])) == pytest.approx(entered[-1], rel=1e-3)
        # masses times speeds gain what went in, less what went through the end, and the weight
        gained = sum(
            m * (history[:, c] - history[0, c])
            for m, c in ((span.struck.nose_mass, column.NOSE_SPEED), (span.struck.assembly_mass, column.ASSEMBLY_SPEED))
        )
        weight = mass * span.struck.gravity * step * np.arange(len(history))
        assert gained == pytest.approx(entered - history[:, column.END_IMPULSE] + weight, abs=1e-11 * entered[-1])
        # rigid acceleration is the rate of the assembly's speed: over all to rounding, between samples by their average
        rate = span.rigid_acceleration
        speed = history[0, column.ASSEMBLY_SPEED] + step * np.concatenate(
            [[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))]
        )
        change = np.ptp(history[:, column.ASSEMBLY_SPEED])
        assert np.abs(speed - history[:, column.ASSEMBLY_SPEED]).max() < 5e-3 * change
        assert speed[-1] == pytest.approx(history[-1, column.ASSEMBLY_SPEED], abs=1e-9 * change)


@pytest.mark.parametrize("gap", [0.0, 2e-6, 20e-6])
def test_the_integral_of_the_acceleration_at_a_tap_is_its_change_of_speed(base, gap):
    """Where a gap closes the speed jumps; from one sample before first touch on, to what rest is not quite still."""
    stack = Stack(
        (part("n", 0.06, 2e-6), part("a", 0.2, 8e-6), part("b", 0.2, 6e-6)),
        (Joint(9e7, 200.0), Joint(unilateral=True, gap=gap)),
    )
    run = run_machine(with_stack(base, stack, 1, 12.5e-9, ((1, 1.0), (2, 0.0), (2, 1.0))))
    (span,) = stack_spans(run)
    for k in range(3):
        _, speed, acceleration = span.tap(k)
        gained = span.step * (acceleration.sum() - 0.5 * acceleration[-1])
        assert gained == pytest.approx(speed[-1] - speed[0], abs=1e-3 * np.ptp(speed))


def test_taps_see_the_mean_of_the_layer_they_are_in(base):
    """Total acceleration at many places of the assembly, averaged over its mass, is its rigid acceleration."""
    stack = STACKS["compliant frame"]
    places = tuple((1, (k + 0.5) / 40) for k in range(40))
    run = run_machine(with_stack(base, stack, 1, 25e-9, places))
    (span,) = stack_spans(run)
    mean = np.mean([span.tap(k)[1] for k in range(40)], axis=0)
    speed = span.history[:, column.ASSEMBLY_SPEED]
    # the midpoint rule on waves of some 20 us in a bar of 8 us
    assert np.abs(mean - speed).max() < 1e-3 * np.ptp(speed)


def test_open_gap_leaves_the_last_part_behind(base):
    """A part behind a gap that does not close in the blow: no force in it but that of its own support."""
    stack = Stack(
        (part("n", 0.06, 2e-6), part("a", 0.2, 8e-6), part("b", 0.2, 6e-6)),
        (Joint(2e8, 100.0), Joint(unilateral=True, gap=0.5)),
    )
    run = run_machine(with_stack(base, stack, 1, 50e-9, ((2, 0.0), (2, 1.0), (1, 1.0))))
    span = stack_spans(run)[0]
    assert np.all(span.taps.force[:, 0] == 0.0)
    assert np.abs(span.taps.force[:, 2]).max() < 1e-9 * span.history[:, column.CONTACT_FORCE].max()
    assert span.tap(2)[1].max() > 1.0


# errors


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (['object.assembly=""'], r"object\.assembly: got .*; allowed: the first layer of the part that carries"),
        (["object.assembly=nose"], r'object\.assembly: got "nose"; allowed: .*not the struck one; choose from'),
        (["object.assembly=fixtur"], r'object\.assembly: got "fixtur".*did you mean "fixture"\?'),
        (["stack.end.kind=matched"], r'stack\.end\.kind: got "matched"; allowed: free'),
        (["stack.end.kind=rigid"], r'stack\.end\.kind: got "rigid"; allowed: free'),
        (["object.mass=0.459 kg"], r'object\.mass: got "0.459 kg"; allowed: none of mass, .*; remove it'),
        (["object.nose_mass=60 gram"], r"object\.nose_mass: got .*; remove it"),
        (["object.frame_stiffness=90 MN/m"], r"object\.frame_stiffness: got .*; remove it"),
        (["object.frame_damping=200 N s/m"], r"object\.frame_damping: got .*; remove it"),
        (["feed.blows=101"], r"feed\.blows: got 101; allowed: at most 100 where the object is a stack"),
        (["stack.layer.nose.speed=1 m/s"], r"stack\.layer\.nose\.speed: got .*; allowed: no speed of its own"),
        (["solver.step=1e-10"], r"solver\.step: got .*; allowed: 1 to 1000 ns where a machine strikes a stack"),
        (["solver.step=5 us"], r"solver\.step: got .*; allowed: 1 to 1000 ns where a machine strikes a stack"),
        (["solver.bandwidth=1 GHz"], r"solver\.bandwidth: got .*; allowed: 1 kHz to .* MHz"),
        (["sensor.direct.cutoff=1 GHz"], r"sensor\.direct\.cutoff: got .*; allowed: below .* MHz"),
        (["solver.route=corrected"], r"tap\.sensors\.layer: got \"specimen\"; allowed: a layer between two others"),
    ],
)
def test_stack_that_cannot_be_struck_is_refused_in_one_line(changes, line):
    with pytest.raises(StrikewaveError, match=f"^{line}") as error:
        observe(load_case(CASE, changes))
    assert "\n" not in str(error.value)


def test_hundred_blows_are_allowed():
    assert build_machine(load_case(CASE, ["feed.blows=100"])).drive.feed.blows == 100


def test_frame_that_could_fall_apart_is_refused():
    """A frame that only pushes does not hold nose and assembly together between blows."""
    changes = ["stack.joint.nose.kind=unilateral"]
    with pytest.raises(StrikewaveError, match=r"^stack\.joint\.nose\.kind: got .*allowed: a joint that holds"):
        build_machine(load_case(CASE, changes))
    held = build_machine(load_case(CASE, [*changes, "stack.joint.nose.preload=10 kN"]))
    assert held.layered.stack.joints[0].preload == 1e4
