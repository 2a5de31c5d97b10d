"""Very many layers, very unequal ones, very thin ones, very short pulses: right, or refused in words."""

import math
import tracemalloc

import numpy as np
import pytest

from strikewave.waves import BONDED, End, Joint, Layer, LoadPulse, Stack, Tap, WantedError, run_bar


def timed(name, impedance, transit, **more):
    return Layer(name, 1.0, impedance * impedance, 1.0, transit * impedance, **more)


PULSE = LoadPulse("sine-squared", 1e3, 20e-6)


@pytest.mark.verify
def test_ten_thousand_layers_are_an_effective_medium():
    """A long pulse in layers of two impedances runs as in a bar of their mean compliance and mass.

    c = L/(sum l/(E A) sum rho A l)^(1/2); the layers are 1/500 of the pulse, whose dispersion is of second order.
    """
    count, transit = 10_000, 2e-7
    stack = Stack(
        tuple(timed(f"{k}", (1e4, 3e4)[k % 2], transit) for k in range(count)), (BONDED,) * (count - 1), End("matched")
    )
    compliance = sum(layer.length / (layer.modulus * layer.area) for layer in stack.layers[: count // 2])
    mass = sum(layer.mass for layer in stack.layers[: count // 2])
    load = LoadPulse("sine-squared", 1e3, 100e-6, kind="incident")
    run = run_bar(stack, load, [Tap(count // 2, 0.0)], 2.5e-3, WantedError(step=transit, method="delay lines"))
    force = run.force[:, 0]
    assert run.time[np.argmax(force)] == pytest.approx(50e-6 + math.sqrt(compliance * mass), rel=1e-3)
    assert run.momentum_error < 1e-10
    effective = math.sqrt(mass / compliance)
    assert force.max() == pytest.approx(1e3 * 2 * effective / (effective + 1e4), rel=0.01)


@pytest.mark.verify
def test_many_layers_without_a_common_step_go_to_the_spectrum():
    """Three hundred random layers keep the wanted errors; delay lines in reach cannot."""
    rng = np.random.default_rng(1)
    layers = tuple(timed(f"{k}", 10 ** rng.uniform(3, 5), 10 ** rng.uniform(-7, -6)) for k in range(300))
    stack = Stack(layers, (BONDED,) * 299)
    run = run_bar(stack, PULSE, [Tap(299, 1.0)], 4e-4)
    assert set(run.grid.counts) == {0}
    assert run.relative_bound[0] < 1e-3
    assert run.relative_bound[1] < 1e-2


@pytest.mark.parametrize("ratio", [1e-8, 1e8])
@pytest.mark.parametrize("method", ["delay lines", "spectral"])
def test_impedances_a_hundred_million_apart(ratio, method):
    """Force behind the first interface 2 Z2/(Z1 + Z2), before any echo; to 1e-9 of what is there."""
    stack = Stack((timed("a", 1e4, 20e-6), timed("b", 1e4 * ratio, 30e-6)), (BONDED,))
    run = run_bar(stack, PULSE, [Tap(1, 0.5)], 50e-6, WantedError(step=1e-7, method=method))
    expected = 2 * ratio / (1 + ratio) * PULSE.at(run.time - 35e-6)
    # the spectral solver rounds the load over a step: (pi step/T)^2/2 of it; its window leaves 1e-8 of what is larger
    miss = 1e-9 if method == "delay lines" else 2e-4
    largest = max(1e3 * 2 * ratio / (1 + ratio), 1e3 if method == "spectral" else 0.0)
    assert np.abs(run.force[:, 0] - expected).max() < miss * largest


@pytest.mark.parametrize("transit", [1e-10, 1e-12, 1e-13])
def test_a_thin_layer_is_a_compliant_joint(transit):
    """A film a million and more times thinner than its neighbours: EA/l, to its own mass beside theirs.

    Thinner films lose digits as their exp(-s t) rounds to 1: 1e-6 of the velocity at 1e-14 s, 1e-5 at 1e-15 s.
    """
    stack = Stack(
        (timed("a", 1e4, 1e-4), timed("film", 1e3 * transit / 1e-6, transit), timed("c", 1e4, 1e-4)), (BONDED, BONDED)
    )
    film = stack.layers[1]
    joint = Joint(film.modulus * film.area / film.length)
    spring = Stack((stack.layers[0], stack.layers[2]), (joint,))
    run = run_bar(stack, PULSE, [Tap(2, 0.5)], 4e-4)
    other = run_bar(spring, PULSE, [Tap(1, 0.5)], 4e-4, WantedError(step=run.grid.step, method="spectral"))
    rows = min(len(run.time), len(other.time))
    largest = np.abs(other.velocity).max()
    assert np.abs(run.velocity[:rows] - other.velocity[:rows]).max() < 1e-6 * largest
    assert run.relative_bound[0] < 1e-3


@pytest.mark.parametrize(
    ("stack", "load", "wanted", "words"),
    [
        (
            Stack((timed("a", 1e4, 1e-4), timed("film", 2e3, 1e-13)), (Joint(unilateral=True),)),
            PULSE,
            WantedError(),
            "film is too thin.*compliant joint of",
        ),
        (
            Stack((timed("a", 1e4, 1e-4),)),
            LoadPulse("half-sine", 1e3, 1e-9),
            WantedError(step=1e-7),
            "too long for a load",
        ),
        (Stack((timed("a", 1e4, 1e-4),)), LoadPulse("half-sine", 1e3, 1e-9), WantedError(), "samples"),
        (Stack((timed("a", 1e4, 1e-4),)), PULSE, WantedError(step=1e-13), "nodes"),
        (Stack((timed("a", 1e4, 1e-4),)), PULSE, WantedError(step=1e-11), "samples"),
        (
            Stack(
                tuple(
                    timed("a", 1e4, 1e-7, poissons_ratio=0.3, dispersion="pochhammer-chree", diameter=0.01 + 1e-6 * k)
                    for k in range(10_000)
                ),
                (BONDED,) * 9999,
            ),
            PULSE,
            WantedError(),
            "10000 of them different.*too many",
        ),
        (Stack((timed("a", 1e4, 1e-4),)), PULSE, WantedError(step=1e-10, method="spectral"), "samples"),
    ],
)
def test_what_would_not_fit_is_refused_before_memory_is_taken(stack, load, wanted, words):
    tracemalloc.start()
    with pytest.raises(ValueError, match=words):
        run_bar(stack, load, [Tap(0, 0.5)], 1e-3, wanted)
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()
