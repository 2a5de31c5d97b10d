"""The spectral solver against delay lines, closed forms of lossy rods, and the dispersion it is given."""

import dataclasses
import math

import numpy as np
import pytest
from scipy import special
from scipy.signal import fftconvolve

from strikewave.base.constants import material
from strikewave.waves import (
    BONDED,
    Branch,
    End,
    Impactor,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    round_bar,
    run_bar,
)
from strikewave.waves.dispersion import Rod, group_speed, phase_speed
from strikewave.waves.layers import LossFit
from strikewave.waves.spectral import SpectralStack, fit_loss

STEP = 1e-7
STEEL = material("65Mn")


def timed(name, impedance, steps):
    """Return a layer of so many steps of travel; unit density and area, so that Z = c."""
    return Layer(name, 1.0, impedance * impedance, 1.0, steps * STEP * impedance)


def bell(middle, width, step=STEP / 8, kind="force"):
    """Return a bell-shaped force of 1 N; it begins below 1e-13."""
    time = np.arange(0.0, 2.0 * middle, step)
    return Sampled(time, np.exp(-0.5 * ((time - middle) / width) ** 2), kind)


FIT = fit_loss(3e8, 0.3, 1e3, 1e5)
LOW, HIGH = timed("low", 3e3, 130), timed("high", 2e4, 210)
STACKS = {
    "bonded": Stack((LOW, HIGH, LOW), (BONDED, BONDED)),
    "compliant": Stack((LOW, HIGH), (Joint(2e9, damping=500.0),), End("matched")),
    "gasket": Stack((LOW, HIGH, LOW), (BONDED, Joint(FIT.stiffness, branches=FIT.branches)), End("rigid")),
    "point mass": Stack((LOW, HIGH), (Joint(mass=0.02),), End("mass", 0.05)),
    "hung mass": Stack((LOW, HIGH), (Joint(1e9, 100.0, attached=0.01),), End("oscillator", 0.02, 5e8, 200.0)),
    "spring": Stack((LOW, HIGH), (BONDED,), End("spring", 1e8)),
    "dashpot": Stack((LOW, HIGH), (BONDED,), End("dashpot", 7e3)),
}


@pytest.mark.parametrize("kind", ["force", "speed", "incident"])
@pytest.mark.parametrize("name", STACKS)
def test_the_spectrum_converges_to_the_delay_lines(name, kind):
    """Transits are whole steps, so that delay lines err by their joints alone; both errors are of second order."""
    load, taps = bell(40e-6, 5e-6, kind=kind), [Tap(0, 0.5), Tap(1, 1.0)]
    lines = run_bar(STACKS[name], load, taps, 4e-4, WantedError(step=STEP / 8))
    misses = []
    for halves in (1, 2):
        step = STEP / halves
        found = SpectralStack(STACKS[name], load, step, round(4e-4 / step) + 1).look([(0, 0.5), (1, 1.0)])
        every = 8 // halves
        pairs = (
            (found.force.T, lines.force[::every]),
            (found.velocity.T, lines.velocity[::every]),
            (found.acceleration.T, lines.acceleration[::every]),
        )
        misses.append([np.abs(a - b).max() / np.abs(b).max() for a, b in pairs])
    # one step of rounding in a bell of 50 steps: F'' dt^2/4 = 1e-4, three times that for the acceleration
    assert max(misses[0][:2]) < 4e-4
    assert misses[0][2] < 1.2e-3
    # 4 less what the delay lines themselves miss at an eighth of the step
    assert np.array(misses[0]) / misses[1] == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize(("shape", "of"), [("sine-squared", 3), ("half-sine", 2), ("trapezoid", 2)])
def test_both_solvers_agree_to_one_percent_of_peak(shape, of):
    """At their own steps: gasket with loss, a mass, unequal materials; accelerations where the load has no corner."""
    parts = (("65Mn", 0.05), ("2A12", 0.03), ("65Mn", 0.08))
    layers = tuple(round_bar(f"{k}", material(name), length, 0.03) for k, (name, length) in enumerate(parts))
    stack = Stack(layers, (Joint(FIT.stiffness, branches=FIT.branches), Joint(mass=0.02)))
    load, taps = LoadPulse(shape, 2e4, 100e-6), [Tap(1, 0.5), Tap(2, 1.0)]
    lines = run_bar(stack, load, taps, 5e-4, WantedError(method="delay lines"))
    spectral = run_bar(stack, load, taps, 5e-4, WantedError(method="spectral"))
    for name in ("force", "velocity", "acceleration")[:of]:
        ours = np.array([np.interp(lines.time, spectral.time, x) for x in getattr(spectral, name).T]).T
        assert np.abs(ours - getattr(lines, name)).max() < 0.01 * np.abs(getattr(lines, name)).max()


def maxwell_bar(relaxation, length=2.0):
    """A matched bar whose modulus is that of one Maxwell branch: 5000 m/s for fast changes, none for slow ones."""
    loss = LossFit(0.0, (Branch(1.0, relaxation),), 0.0, (0.0, math.inf))
    return Stack((Layer("bar", 1000.0, 2.5e10, 1e-4, length, 0.01, loss=loss),), (), End("matched"))


def test_maxwell_bar_follows_the_telegraph_equation():
    """An endless Maxwell bar has sqrt(s^2 + s/tau) x/c in the exponent: a front exp(-x/(2 c tau)) and a Bessel tail.

    The kernel is delta(t - t0) exp(-t0/(2 tau)) + exp(-t/(2 tau)) t0/(2 tau) I1(r)/(t^2 - t0^2)^(1/2), r = (t^2 -
    t0^2)^(1/2)/(2 tau) (Doetsch, table of transforms). It is laid over the load by the trapezoidal rule.
    """
    tau, x, step = 60e-6, 0.9, 2.5e-8
    load = bell(40e-6, 6e-6, step)
    steps = 20001
    found = SpectralStack(maxwell_bar(tau), load, step, steps).look([(0, x / 2.0)]).force[0]
    time = step * np.arange(steps)
    t0 = x / 5000.0
    after = time - t0
    root = np.sqrt(np.maximum(time**2 - t0**2, 0.0))
    tail = np.where(
        after >= -1e-12,
        np.exp(-time / (2 * tau)) * t0 / (2 * tau) * special.i1(root / (2 * tau)) / np.where(root > 0, root, 1.0),
        0.0,
    )
    first = round(t0 / step)
    tail[first] = math.exp(-t0 / (2 * tau)) * t0 / (2 * tau) / (4 * tau)  # I1(r)/r -> 1/2
    weights = tail.copy()
    weights[first] *= 0.5
    pulse = load.at(time)
    expected = fftconvolve(pulse, weights)[:steps] * step + math.exp(-t0 / (2 * tau)) * load.at(after)
    # what is left is the rounding of the load over a step, (step/width)^2/4, and the trapezoidal rule
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_nothing_arrives_before_the_fastest_wave():
    """Loss is causal: at the speed of fast changes, ahead of the front of a load that begins with a jump in slope."""
    fit = fit_loss(1.0, 0.3, 1e3, 1e5)
    stiffest = fit.stiffness + sum(branch.stiffness for branch in fit.branches)
    bar = Layer("bar", 1000.0, 2.5e10, 1e-4, 2.0, 0.01, loss=fit)
    step, x = 1e-7, 1.0
    found = SpectralStack(Stack((bar,), (), End("matched")), LoadPulse("sine-squared", 1.0, 50e-6), step, 6000).look(
        [(0, x / 2)]
    )
    arrival = x / (5000.0 * math.sqrt(stiffest))
    ahead = step * np.arange(6000) < arrival - 2 * step
    assert ahead.sum() > 1000
    assert np.abs(found.force[0][ahead]).max() < 1e-6 * found.force[0].max()


@pytest.mark.parametrize("nu", [0.25, 0.29, 0.30, 0.35])
def test_waves_run_at_the_speeds_of_the_pochhammer_chree_table(nu):
    """Phase between two places of an endless bar against c/c0 over d/Lambda, to half a digit of the table."""
    table = {
        0.25: (0.998428, 0.983366),
        0.29: (0.997891, 0.978261),
        0.30: (0.997744, 0.976912),
        0.35: (0.996941, 0.969789),
    }
    diameter, c0, step, steps = 0.02, 5000.0, 2e-7, 8192
    bar = Layer("bar", 8000.0, 2e11, 1e-4, 2.0, diameter, poissons_ratio=nu, dispersion="pochhammer-chree")
    found = SpectralStack(Stack((bar,), (), End("matched")), bell(30e-6, 2.5e-6, step), step, steps).look(
        [(0, 0.25), (0, 0.5)]
    )
    for ratio, expected in zip((0.1, 0.3), table[nu], strict=True):
        frequency = ratio / diameter * expected * c0
        turn = np.exp(-2j * np.pi * frequency * step * np.arange(steps))
        near, far = found.force @ turn
        travel = 0.5 * 2 * np.pi * ratio / diameter  # k x of the table
        assert abs(np.angle(far / near * np.exp(1j * travel))) < 1e-6 * travel
        assert abs(far / near) == pytest.approx(1.0, abs=1e-6)


def test_a_tone_burst_runs_at_the_group_speed():
    """Middle of the envelope of forty waves between two places: the packet widens, but its middle keeps dw/dk."""
    rod, frequency, step, steps = Rod(0.01, 5000.0, 0.29), 80e3, 2e-7, 16384
    time = np.arange(0.0, 1.2e-3, step)
    burst = Sampled(time, np.exp(-0.5 * ((time - 6e-4) / 1e-4) ** 2) * np.sin(2 * np.pi * frequency * time))
    bar = Layer("bar", 8000.0, 2e11, 1e-4, 4.0, 0.02, poissons_ratio=0.29, dispersion="pochhammer-chree")
    found = SpectralStack(Stack((bar,), (), End("matched")), burst, step, steps).look([(0, 0.0), (0, 0.5)])
    t = step * np.arange(steps)
    near, far = (np.sum(t * x**2) / np.sum(x**2) for x in found.force)
    speed = 2.0 / (far - near)
    assert speed == pytest.approx(float(group_speed(2 * np.pi * frequency, rod)), rel=2e-4)
    assert speed < 0.95 * 5000.0 * float(phase_speed(0.02 * frequency / 4850.0, 0.29))


def test_love_rayleigh_and_pochhammer_chree_agree_for_long_waves():
    """A bell of 60 us in a bar of 20 mm: both are Rayleigh's correction, their difference of fourth order."""
    runs = []
    for theory in ("none", "love-rayleigh", "pochhammer-chree"):
        bar = Layer("bar", 8000.0, 2e11, 1e-4, 0.5, 0.02, poissons_ratio=0.29, dispersion=theory)
        runs.append(SpectralStack(Stack((bar,)), bell(100e-6, 15e-6), 4e-7, 5000).look([(0, 1.0)]).velocity[0])
    none, love, chree = runs
    assert np.abs(love - chree).max() < 0.02 * np.abs(none - chree).max()


def test_a_lossless_bar_rings_on_to_the_end():
    """Half a hundred round trips between free ends: the window lets nothing wrap around, and nothing dies."""
    bar = timed("bar", 5e3, 100)
    load = bell(20e-6, 2.5e-6)
    spectrum = SpectralStack(Stack((bar,)), load, STEP, 10001)
    lines = run_bar(Stack((bar,)), load, [Tap(0, 1.0)], 1e-3, WantedError(step=STEP))
    found = spectrum.look([(0, 1.0)])
    # a bell of 25 steps, rounded over one: 4e-4; nothing grows over 50 round trips
    assert np.abs(found.velocity[0] - lines.velocity[:, 0]).max() < 6e-4 * np.abs(lines.velocity).max()


@pytest.mark.parametrize("name", STACKS)
def test_momentum_is_the_impulse(name):
    for load in (bell(40e-6, 5e-6), LoadPulse("rectangle", 1.0, 30e-6)):
        run = run_bar(STACKS[name], load, [Tap(0, 0.5)], 3e-4, WantedError(step=STEP, method="spectral"))
        assert run.momentum_error < 1e-9
        ends = np.trapezoid(run.face_force - run.end_force, run.time)
        largest = max(abs(run.impulse), abs(run.end_impulse))
        assert run.impulse - run.end_impulse == pytest.approx(ends, abs=5e-3 * largest)


def test_the_default_run_keeps_its_own_error_estimate():
    """A run by the default errors against one at a fortieth of its step: off by no more than it says."""
    bar = round_bar("bar", STEEL, 0.2, 0.03)
    stack = Stack((dataclasses.replace(bar, dispersion="pochhammer-chree"),))
    load, taps = LoadPulse("sine-squared", 2e4, 60e-6), [Tap(0, 0.5), Tap(0, 1.0)]
    run = run_bar(stack, load, taps, 3e-4)
    fine = run_bar(stack, load, taps, 3e-4, WantedError(step=run.grid.step / 10))
    rows = len(run.time)
    for name, bound in (("velocity", run.bound.velocity), ("acceleration", run.bound.acceleration)):
        miss = np.abs(getattr(run, name) - getattr(fine, name)[::10][:rows]).max()
        assert miss < bound


@pytest.mark.parametrize(
    ("stack", "load", "words"),
    [
        (Stack((LOW, HIGH), (Joint(unilateral=True),)), bell(2e-5, 4e-6), "can open"),
        (Stack((timed("low", 3e3, 130),)), Impactor(0.2, 5.0), "striker"),
        (Stack((dataclasses.replace(LOW, speed=1.0), HIGH), (BONDED,)), bell(2e-5, 4e-6), "comes with a speed"),
    ],
)
def test_what_is_not_linear_is_refused_with_what_to_do(stack, load, words):
    with pytest.raises(ValueError, match=words + ".*incident wave"):
        run_bar(stack, load, [Tap(0, 0.5)], 1e-4, WantedError(method="spectral"))


def test_delay_lines_refuse_layers_with_loss_or_dispersion():
    lossy = dataclasses.replace(LOW, loss=fit_loss(1.0, 0.1, 1e3, 1e5))
    with pytest.raises(ValueError, match=r"low loses energy.*spectral"):
        run_bar(Stack((lossy,)), bell(2e-5, 4e-6), [Tap(0, 0.5)], 1e-4, WantedError(method="delay lines"))
    with pytest.raises(ValueError, match="Poisson's ratio"):
        dataclasses.replace(LOW, dispersion="love-rayleigh")


def test_the_field_of_many_steps_is_looked_at_at_fewer_places(monkeypatch):
    def run():
        return run_bar(
            STACKS["bonded"], bell(1e-5, 2e-6), [Tap(1, 0.5)], 6e-5, WantedError(step=STEP, method="spectral")
        )

    whole = run()
    monkeypatch.setattr("strikewave.waves.bar._FIELD_VALUES", 20 * len(whole.time))
    sparse = run()
    assert 20 <= len(sparse.field_position) <= 20 + len(STACKS["bonded"].layers) < len(whole.field_position)
    ends = [0, -1]
    np.testing.assert_array_equal(sparse.field_force[:, ends], whole.field_force[:, ends])
    np.testing.assert_array_equal(sparse.velocity, whole.velocity)
