"""Random stacks by both solvers: no energy out of nothing, reciprocity, and no matter when the load comes."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.contact import Contact
from strikewave.waves import BONDED, End, Joint, Layer, Sampled, Stack, Tap, WantedError, run_bar
from strikewave.waves.spectral import SpectralStack, fit_loss

STEP = 1e-7
LINEAR = ("bonded", "compliant", "damped", "gasket", "mass", "hung mass")
EVERY = (*LINEAR, "bolted", "gap", "contact")


def joint_of(draw, kind, before, after):
    y = 1 / before + 1 / after
    stiffness = 1 / (y * STEP * 10.0 ** draw(st.floats(0.5, 2.0)))
    damping = draw(st.floats(0.0, 2.0)) / y
    if kind == "gasket":
        fit = fit_loss(stiffness, draw(st.sampled_from([0.05, 0.3])), 1e4, 1e6)
        return Joint(fit.stiffness, branches=fit.branches)
    return {
        "bonded": BONDED,
        "compliant": Joint(stiffness),
        "damped": Joint(stiffness, damping),
        "mass": Joint(mass=STEP / y * 10.0 ** draw(st.floats(1.0, 2.5))),
        "hung mass": Joint(stiffness, damping, attached=(10 * STEP) ** 2 * stiffness * draw(st.floats(1.0, 50.0))),
        "bolted": Joint(unilateral=True, preload=draw(st.floats(0.0, 5e3))),
        "gap": Joint(stiffness, damping, unilateral=True, gap=draw(st.floats(0.0, 2e-6))),
        "contact": Joint(contact=Contact(4e12, 1.5), gap=draw(st.floats(0.0, 2e-6))),
    }[kind]


@st.composite
def stacks(draw, kinds, lossy=False):
    """Two to five layers of 40 to 400 steps between impedances of 1e3 and 1e5, ended without an echo."""
    count = draw(st.integers(2, 5))
    z = [10.0 ** draw(st.floats(3.0, 5.0)) for _ in range(count)]
    layers = []
    for k in range(count):
        layer = Layer(
            f"{k}",
            1.0,
            z[k] ** 2,
            1.0,
            draw(st.integers(40, 400)) * STEP * z[k],
            draw(st.floats(0.05, 1.0)) * z[k] * 1e-5,
        )
        if lossy:
            loss = fit_loss(1.0, draw(st.sampled_from([0.02, 0.2])), 1e4, 1e6) if draw(st.booleans()) else None
            theory = draw(st.sampled_from(["none", "love-rayleigh", "pochhammer-chree"]))
            layer = dataclasses.replace(layer, loss=loss, dispersion=theory, poissons_ratio=draw(st.floats(0.1, 0.5)))
        layers.append(layer)
    joints = tuple(joint_of(draw, draw(st.sampled_from(kinds)), a, b) for a, b in itertools.pairwise(z))
    return Stack(tuple(layers), joints, End("matched"))


def bell(width=4e-6, peak=1e4, wait=0.0):
    middle = 8.0 * width
    time = np.arange(0.0, wait + 2.0 * middle, STEP)
    return Sampled(time, peak * np.exp(-0.5 * ((time - wait - middle) / width) ** 2), "incident")


def energies(stack, load, face, end):
    """Energy that comes with an incident wave, goes back through the first face, and leaves at the end, J."""
    time = STEP * np.arange(face.size)
    wave = load.at(time)
    first, last = stack.layers[0].impedance, stack.layers[-1].impedance
    return [float(np.sum(x**2)) * STEP / z for x, z in ((wave, first), (face - wave, first), (end, last))]


@given(stacks(EVERY))
def test_delay_lines_give_out_no_more_than_went_in(stack):
    """Rigid joints, springs and gaskets keep it to rounding; nonlinear contacts to second order in the step."""
    load = bell()
    run = run_bar(stack, load, [Tap(0, 0.0)], 6e-4, WantedError(step=STEP, method="delay lines"))
    into, back, on = energies(stack, load, run.face_force, run.end_force)
    exact = all(joint.contact is None for joint in stack.joints)
    assert back + on <= into * (1 + (1e-12 if exact else 1e-4))


@settings(max_examples=25)
@given(stacks(LINEAR, lossy=True))
def test_the_spectrum_gives_out_no_more_than_went_in(stack):
    """Of each frequency: a stack between endless bars that hold no loss themselves.

    The first and last layer are without loss and dispersion, so that the energy of their waves is P^2/Z. The time
    of the run is the same for both, and what is on its way at the end only lowers what came out.
    """
    plain = {"loss": None, "dispersion": "none"}
    first, last = (dataclasses.replace(stack.layers[k], **plain) for k in (0, -1))
    stack = dataclasses.replace(stack, layers=(first, *stack.layers[1:-1], last))
    load = bell()
    spectrum = SpectralStack(stack, load, STEP, 6001)
    face, end, _ = spectrum.ends()
    # the solver rounds the load over a step, which takes (step/width)^2/2 of its energy
    into, back, on = energies(stack, load, face, end)
    assert back + on <= into * (1 + 1e-3)


@settings(max_examples=25)
@given(stacks(LINEAR, lossy=True))
def test_the_spectrum_is_reciprocal(stack):
    """Per root of the impedance, what goes through from the left goes through from the right."""
    mirrored = Stack(stack.layers[::-1], stack.joints[::-1], stack.end)
    passed = []
    for each in (stack, mirrored):
        spectrum = SpectralStack(each, bell(), STEP, 3001)
        z = [x.density * x.area * spectrum.s / g for x, g in ((each.layers[k], spectrum.travel(k)) for k in (0, -1))]
        _, _, ends, _ = spectrum._respond([])
        passed.append(ends[1] * np.sqrt(z[0] / z[1]))
    assert np.abs(passed[0] - passed[1]).max() < 1e-9 * np.abs(passed[0]).max()


@pytest.mark.verify
@given(stacks(LINEAR))
def test_delay_lines_are_reciprocal(stack):
    mirrored = Stack(stack.layers[::-1], stack.joints[::-1], stack.end)
    passed = []
    for each in (stack, mirrored):
        run = run_bar(each, bell(), [Tap(0, 0.0)], 3e-4, WantedError(step=STEP, method="delay lines"))
        passed.append(run.end_force * math.sqrt(each.layers[0].impedance / each.layers[-1].impedance))
    assert passed[0] == pytest.approx(passed[1], abs=1e-9 * 1e4)


@pytest.mark.verify
@given(stacks(EVERY), st.integers(1, 500))
def test_a_later_load_does_the_same_later(stack, steps):
    """Also where joints open: before the load nothing moves."""
    runs = [
        run_bar(stack, bell(wait=wait), [Tap(1, 0.5)], 2e-4 + wait, WantedError(step=STEP, method="delay lines"))
        for wait in (0.0, steps * STEP)
    ]
    rows = len(runs[0].time)
    for name in ("velocity", "acceleration"):
        now, later = (getattr(run, name)[:, 0] for run in runs)
        # the load itself is the same to rounding of its times only
        assert later[steps : steps + rows] == pytest.approx(now, abs=1e-6 * max(np.abs(now).max(), 1e-12))


@settings(max_examples=25)
@given(stacks(LINEAR, lossy=True), st.integers(1, 500))
def test_a_later_load_has_the_same_spectrum_later(stack, steps):
    now, later = (
        SpectralStack(stack, bell(wait=wait), STEP, 2500).look([(1, 0.5)]).velocity[0] for wait in (0.0, steps * STEP)
    )
    assert later[steps:] == pytest.approx(now[:-steps], abs=1e-7 * np.abs(now).max())


SCALED = ("bonded", "compliant", "damped", "mass", "hung mass", "bolted", "gap")


def on_scale(stack, size, area):
    """Return a stack whose lengths go by a size and whose areas by another factor; its materials stay."""
    layers = tuple(dataclasses.replace(x, length=size * x.length, area=area * x.area) for x in stack.layers)
    joints = tuple(
        dataclasses.replace(
            x,
            stiffness=x.stiffness * area / size,
            damping=x.damping * area,
            gap=x.gap * size,
            preload=x.preload * area,
            mass=x.mass * area * size,
            attached=x.attached * area * size,
        )
        for x in stack.joints
    )
    return Stack(layers, joints, stack.end)


@settings(max_examples=5)
@given(stacks(SCALED), st.floats(0.1, 10.0), st.floats(0.1, 10.0))
def test_a_stack_of_the_same_materials_moves_as_fast_and_as_much_longer(stack, size, area):
    """Times go with the lengths, forces with the areas, velocities stay; joints that open do so alike."""
    taps, load = [Tap(0, 0.3), Tap(1, 0.5)], bell()
    run = run_bar(stack, load, taps, 3e-4, WantedError(step=STEP, method="delay lines"))
    grown = Sampled(load.time * size, load.values * area, "incident")
    other = run_bar(
        on_scale(stack, size, area), grown, taps, 3e-4 * size, WantedError(step=STEP * size, method="delay lines")
    )
    rows = min(len(run.time), len(other.time))
    largest = np.abs(run.velocity).max()
    assert other.velocity[:rows] == pytest.approx(run.velocity[:rows], abs=1e-9 * largest)
    assert other.force[:rows] == pytest.approx(area * run.force[:rows], abs=1e-9 * area * np.abs(run.force).max())


@settings(max_examples=5)
@given(stacks(LINEAR))
def test_a_pull_does_the_opposite_of_a_push(stack):
    """Through joints that hold both ways, to the last digit."""
    load = bell()
    pull = Sampled(load.time, -load.values, "incident")
    push, pulled = (
        run_bar(stack, each, [Tap(1, 0.5)], 3e-4, WantedError(step=STEP, method="delay lines")) for each in (load, pull)
    )
    assert np.array_equal(push.velocity, -pulled.velocity)
    assert np.array_equal(push.force, -pulled.force)
