"""Bonded stacks on whole steps against a lattice of its own: arrays shifted by one node a step.

Where every transit is a whole number of steps the method of characteristics is exact, so the only
difference between two ways to compute it is rounding.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.waves import BONDED, End, Impactor, Layer, LoadPulse, Sampled, Stack, Tap, WantedError, run_bar

STEP = 1e-7
ROUNDING = 1e-12
"""A wave takes about ten roundings of 1e-16 at each interface, and some hundred of these in the longest runs; every
one is relative to the largest force about, so velocities are measured by that force over their layer's impedance."""


def whole_step_stack(impedances, counts, end, speeds=None):
    """Return layers of unit density times area: Z = c, and a length of so many steps."""
    speeds = speeds or [0.0] * len(counts)
    layers = tuple(
        # rho = 1, A = 1: Z = c = sqrt(E)
        Layer(f"{k}", 1.0, z * z, 1.0, n * STEP * z, speed=v)
        for k, (z, n, v) in enumerate(zip(impedances, counts, speeds, strict=True))
    )
    return Stack(layers, (BONDED,) * (len(layers) - 1), End(end))


def shifted_lattice(impedances, counts, end, face, by_speed, places, speeds=None):
    """Follow a bonded stack: forces and velocities at (layer, node) for each step, and the force on the first face.

    ``right[k][j]`` and ``left[k][j]`` are the waves at node j of layer k. A step shifts ``right`` up and ``left``
    down by one node; the nodes that the shift leaves empty get what interfaces, face and end send.
    """
    z = np.asarray(impedances, dtype=float)
    speeds = np.zeros(len(counts)) if speeds is None else np.asarray(speeds)
    right = [np.full(n + 1, 0.5 * zk * v) for n, zk, v in zip(counts, z, speeds, strict=True)]
    left = [np.full(n + 1, -0.5 * zk * v) for n, zk, v in zip(counts, z, speeds, strict=True)]
    force, velocity = np.empty((len(face), len(places))), np.empty((len(face), len(places)))
    pushed = np.empty(len(face))
    for n, given_value in enumerate(face):
        right = [np.concatenate([[math.nan], wave[:-1]]) for wave in right]
        left = [np.concatenate([wave[1:], [math.nan]]) for wave in left]
        right[0][0] = given_value * z[0] + left[0][0] if by_speed else given_value - left[0][0]
        pushed[n] = right[0][0] + left[0][0]
        for k in range(len(counts) - 1):
            common = 2.0 * (z[k + 1] * right[k][-1] + z[k] * left[k + 1][0]) / (z[k] + z[k + 1])
            left[k][-1], right[k + 1][0] = common - right[k][-1], common - left[k + 1][0]
        left[-1][-1] = {"free": -1.0, "matched": 0.0, "rigid": 1.0}[end] * right[-1][-1]
        for j, (k, node) in enumerate(places):
            force[n, j] = right[k][node] + left[k][node]
            velocity[n, j] = (right[k][node] - left[k][node]) / z[k]
    return force, velocity, pushed


@st.composite
def cases(draw):
    """Random stacks of 2 to 6 layers with impedances over two decades, an end, nodes to look at, and a load."""
    count = draw(st.integers(2, 6))
    counts = draw(st.lists(st.integers(1, 40), min_size=count, max_size=count))
    logs = draw(st.lists(st.floats(0.0, 2.0), min_size=count, max_size=count))
    impedances = [1e3 * 10.0**x for x in logs]
    end = draw(st.sampled_from(["free", "matched", "rigid"]))
    places = []
    for _ in range(draw(st.integers(1, 4))):
        k = draw(st.integers(0, count - 1))
        places.append((k, draw(st.integers(0, counts[k]))))
    steps = draw(st.integers(2, 400))
    kind = draw(st.sampled_from(["half-sine", "sine-squared", "rectangle", "triangle", "trapezoid", "force", "speed"]))
    length = draw(st.integers(2, 300)) * STEP
    if kind in ("force", "speed"):
        values = draw(st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=12))
        scale = 1e4 if kind == "force" else 5.0
        load = Sampled(np.linspace(0.0, length, len(values)), scale * np.array(values), kind)
    else:
        load = LoadPulse(kind, draw(st.floats(-1e5, 1e5)), length)
    return impedances, counts, end, places, steps, load


def close_to_lattice(run, impedances, places, force, velocity, pushed):
    peak = max(np.abs(force).max(), np.abs(pushed).max(), 1e-300)
    z = np.array([impedances[k] for k, _ in places])
    peak = max(peak, np.abs(velocity * z).max())
    rows = len(run.time)
    assert np.abs(run.force - force[:rows]).max() <= ROUNDING * peak
    assert (np.abs(run.velocity - velocity[:rows]) * z).max() <= ROUNDING * peak
    assert np.abs(run.face_force - pushed[:rows]).max() <= ROUNDING * peak
    # the acceleration is the difference of two velocities, over two steps
    central = (velocity[2:] - velocity[:-2]) / (2.0 * STEP)
    difference = np.abs(run.acceleration[1:] - central[: rows - 1]) * z * STEP
    assert difference.max(initial=0.0) <= ROUNDING * peak
    return peak


@given(cases())
def test_waves_are_those_of_a_shifted_lattice(case):
    """Force and velocity at every tap and step to 1e-12 of the peak."""
    impedances, counts, end, places, steps, load = case
    stack = whole_step_stack(impedances, counts, end)
    taps = [Tap(k, node / counts[k]) for k, node in places]
    run = run_bar(stack, load, taps, steps * STEP, WantedError(step=STEP))
    assert run.grid.counts == tuple(counts)
    assert run.time == pytest.approx(STEP * np.arange(steps + 1), rel=1e-15)
    # a step more, for the last acceleration
    face = load.at(STEP * np.arange(steps + 2.0))
    by_speed = isinstance(load, Sampled) and load.kind == "speed"
    found = shifted_lattice(impedances, counts, end, face, by_speed, places)
    close_to_lattice(run, impedances, places, *found)


@given(cases(), st.lists(st.floats(-5.0, 5.0), min_size=6, max_size=6))
def test_layers_with_speeds_are_those_of_a_shifted_lattice(case, speeds):
    """Each layer comes with a speed of its own, bonded at time 0: the waves of that impact, to 1e-12 of the peak."""
    impedances, counts, end, places, steps, load = case
    speeds = speeds[: len(counts)]
    stack = whole_step_stack(impedances, counts, end, speeds)
    taps = [Tap(k, node / counts[k]) for k, node in places]
    run = run_bar(stack, load, taps, steps * STEP, WantedError(step=STEP))
    face = load.at(STEP * np.arange(steps + 2.0))
    by_speed = isinstance(load, Sampled) and load.kind == "speed"
    found = shifted_lattice(impedances, counts, end, face, by_speed, places, speeds)
    close_to_lattice(run, impedances, places, *found)


@given(cases(), st.floats(1e-4, 1.0), st.floats(0.1, 20.0))
def test_rigid_striker_on_a_shifted_lattice(case, mass, speed):
    """The force that a rigid striker gave, put on the lattice, moves its face as the striker moves while they touch.

    Newton's law of the striker by the trapezoidal rule, from the lattice's own face velocity: to 1e-12 of the speed
    where both push throughout, so the load is long enough only until the first loss of contact.
    """
    impedances, counts, end, places, steps, _ = case
    stack = whole_step_stack(impedances, counts, end)
    taps = [Tap(k, node / counts[k]) for k, node in [*places, (0, 0)]]
    run = run_bar(stack, Impactor(mass, speed), taps, steps * STEP, WantedError(step=STEP))
    force, velocity, pushed = shifted_lattice(impedances, counts, end, run.face_force, False, [*places, (0, 0)])
    assert np.abs(run.force - force).max() <= ROUNDING * np.abs(pushed).max()
    touching = run.face_force > 0.0
    last = int(np.argmin(touching)) if not touching.all() else len(touching)
    lost = STEP * np.concatenate([[0.0], np.cumsum(0.5 * (pushed[1:] + pushed[:-1]))]) / mass
    assert np.abs(speed - lost[:last] - velocity[:last, -1]).max() <= ROUNDING * speed * steps
    assert pushed[0] == pytest.approx(impedances[0] * speed, rel=1e-15)


def test_lattice_itself_meets_the_jump_conditions():
    """What the lattice is trusted for: equal force and velocity on both sides of an interface, f = P + M at the face."""
    z, counts = [1e4, 3e4, 5e3], [4, 7, 5]
    face = np.where(np.arange(60) < 25, 1e3, 0.0)
    places = [(0, 4), (1, 0), (1, 7), (2, 0), (2, 5)]
    force, velocity, pushed = shifted_lattice(z, counts, "rigid", face, False, places)
    assert force[:, 0] == pytest.approx(force[:, 1], abs=1e-9)
    assert force[:, 2] == pytest.approx(force[:, 3], abs=1e-9)
    assert velocity[:, 0] == pytest.approx(velocity[:, 1], abs=1e-12)
    assert velocity[:, 2] == pytest.approx(velocity[:, 3], abs=1e-12)
    assert velocity[:, 4] == pytest.approx(0.0, abs=1e-15)
    assert pushed == pytest.approx(face, abs=1e-9)
    # first arrival at the wall: both transmissions, doubled
    arrival = sum(counts)
    assert np.abs(force[:arrival, 4]).max() == 0.0
    assert force[arrival, 4] == pytest.approx(1e3 * (2 * 3 / 4) * (2 * 0.5 / 3.5) * 2)
