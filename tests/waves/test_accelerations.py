"""What is kept of an acceleration whose velocity jumps: its integral is the change of velocity, and readings converge."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.sensors import Sensor, output
from strikewave.waves import End, Joint, Layer, LoadPulse, Stack, Tap, WantedError, bar, run_bar
from strikewave.waves.transit import grid_of

STEP = 1e-7
SEEN = 1e-9
"""Share of the largest velocity: rounding of some thousand sums of a step each."""
ENDS = (End("free"), End("matched"), End("rigid"), End("mass", 0.05), End("dashpot", 3e3), End("spring", 5e7))
JOINTS = (Joint(), Joint(stiffness=4e8), Joint(unilateral=True), Joint(unilateral=True, gap=3e-6), Joint(mass=0.02))


@st.composite
def struck_stacks(draw):
    """Layers of whole steps, struck by a moving one or by a load that jumps."""
    count = draw(st.integers(1, 4))
    layers = []
    for k in range(count):
        transit = draw(st.integers(3, 60)) * STEP
        impedance = draw(st.sampled_from([3e3, 1.2e4, 2.9e4]))
        speed = 5.0 if k == 0 and draw(st.booleans()) else 0.0
        layers.append(layer(f"layer {k}", impedance, transit, speed))
    joints = tuple(draw(st.sampled_from(JOINTS)) for _ in layers[1:])
    size = 0.0 if layers[0].speed else 2e4
    load = LoadPulse(draw(st.sampled_from(["rectangle", "half-sine"])), size, draw(st.integers(20, 300)) * STEP)
    places = [Tap(draw(st.integers(0, count - 1)), draw(st.sampled_from([0.0, 1.0]))) for _ in range(2)]
    return Stack(tuple(layers), joints, draw(st.sampled_from(ENDS))), load, places


def layer(name, impedance, transit, speed=0.0):
    """A layer of 5 km/s and 7800 kg/m^3 with an impedance and a transit."""
    c, density = 5000.0, 7800.0
    return Layer(name, density, density * c * c, impedance / (density * c), c * transit, speed=speed)


def thinned(stack, load, places, every):
    """A run on steps of `STEP`, of which one in ``every`` is kept, as the chosen sampling does."""
    where = [(tap.layer, tap.position) for tap in places]
    sampling = bar._Sampling(every, 1e-5)
    return bar._run(stack, load, where, 400 * STEP, grid_of(stack, STEP), sampling)


@settings(max_examples=60)
@given(struck_stacks(), st.sampled_from([2, 3, 5, 8, 20]))
def test_the_integral_of_an_acceleration_is_the_change_of_velocity(struck, every):
    """Over any interval between kept samples, of velocities averaged with the hat of a sample at every step: to rounding.

    The reference is a run that keeps every step. Its velocities, straight between steps, are averaged here by their
    integral, which owes nothing to sums of the kernel.
    """
    stack, load, places = struck
    fine, run = thinned(stack, load, places, 1), thinned(stack, load, places, every)
    h = every * STEP
    still = np.array([stack.layers[tap.layer].speed for tap in places])
    place = np.vstack([np.zeros((1, 2)), np.cumsum(0.5 * STEP * (fine.velocity[1:] + fine.velocity[:-1]), axis=0)])
    place = np.vstack([-h * still, place[::every]])  # at rest one kept step before the load
    mean = np.diff(place, axis=0)[: len(run.time)] / h
    from_rest = np.vstack([np.zeros((1, 2)), run.acceleration])
    gained = np.cumsum(0.5 * h * (from_rest[1:] + from_rest[:-1]), axis=0)
    scale = SEEN * max(np.abs(fine.velocity).max(), 1e-3)
    inner = slice(1, len(mean) - 1)
    expected = 0.5 * (mean[1:-1] + mean[2:]) - still
    assert gained[inner][: len(expected)] == pytest.approx(expected, abs=scale)


def jumps_at_the_free_end(speed, striker, bar, until):
    """Times and sizes of the jumps at the free end of a bar that a striker of its impedance hits: method of images.

    The wave of v0/2 doubles at the end; the striker's free end ends it after twice its transit, and from then on it
    runs in the bar alone, where the face that the striker left is free: again after twice the transit of the bar.
    """
    arrivals = np.arange(bar, until, 2.0 * bar)
    return [(t, speed) for t in arrivals] + [(t + 2.0 * striker, -speed) for t in arrivals]


@pytest.mark.parametrize("every", [1, 4, 10])
def test_a_resonant_sensor_at_the_free_end_of_a_struck_bar(every):
    """A striker of 100 mm on a bar of 1 m at 5 m/s, 50 kHz, Q 30: sum of the impulse responses of the jumps.

    A sensor on velocity jumps dv at t_k reads w^2/w' sum dv exp(-z w t) sin(w' t), t since t_k, z = 1/(2 Q),
    w' = w sqrt(1 - z^2). The average with a hat of h lowers what rings by (pi f h)^2/3, 0.8 % at the longest of these;
    straight lines between samples take off as much again, and one step's average a little. Where a jump falls, the
    corner of the response is round over two samples, which are left out; what is left of it are the 1.3.
    """
    transit_s, transit_b, f, quality = 193 * STEP, 1925 * STEP, 50e3, 30.0
    stack = Stack((layer("striker", 1.2e4, transit_s, 5.0), layer("bar", 1.2e4, transit_b)), (Joint(unilateral=True),))
    load = LoadPulse("rectangle", 0.0, 1e-6)
    run = bar._run(stack, load, [(1, 1.0)], 1e-3, grid_of(stack, STEP), bar._Sampling(every, 1e-5))
    reading = output(Sensor(resonance=f, quality=quality), run.acceleration[:, 0], every * STEP)
    w, z = 2.0 * math.pi * f, 0.5 / quality
    damped, exact = w * math.sqrt(1.0 - z * z), np.zeros(run.time.size)
    for t, dv in jumps_at_the_free_end(5.0, transit_s, transit_b, 1e-3):
        # a jump between two steps is a straight line from one to the next: its middle
        since = np.maximum(run.time - (t - 0.5 * STEP), 0.0)
        ring = w * w / damped * np.exp(-z * w * since) * np.sin(damped * since)
        exact += dv * ring
    near = [
        np.abs(run.time - t) < 1.5 * every * STEP for t, _ in jumps_at_the_free_end(5.0, transit_s, transit_b, 1e-3)
    ]
    away = ~np.any(near, axis=0)
    loss = (math.pi * f * STEP) ** 2 * (2.0 * every**2 + 1.0) / 3.0
    assert np.abs(reading - exact)[away].max() < 1.3 * loss * np.abs(exact).max()
    assert np.abs(reading).max() == pytest.approx(np.abs(exact).max(), rel=1.3 * loss)


def test_a_chosen_run_resolves_what_listens():
    """Whatever its duration keeps, samples stand at most a fiftieth of the period of a sensor apart."""
    stack = Stack((layer("bar", 1.2e4, 2e-4),))
    load = LoadPulse("rectangle", 2e4, 1e-4)
    for period in (2e-5, 4e-6):
        run = run_bar(stack, load, [Tap(0, 1.0)], 0.02, WantedError(period=period))
        assert run.time[1] <= period / 50.0 * (1.0 + 1e-12)
