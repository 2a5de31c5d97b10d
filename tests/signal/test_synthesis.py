"""Base motions that have a spectrum: judged by another code of the spectrum, at rest at the end, and what cannot be."""

import math

import numpy as np
import pytest
from scipy import signal

from strikewave.signal.motion import motion
from strikewave.signal.srs import octaves
from strikewave.signal.synthesis import BASES, Component, matching_half_sine, synthesized


def maximax(values, step, frequencies, q):
    """Return a shock response spectrum by scipy's first-order hold, a second after the record included.

    Sources: none of ours. Samples are picked, so that a swing of n samples is (pi/n)^2/2 low at most.
    """
    out = []
    for frequency in frequencies:
        w, damping = 2.0 * math.pi * frequency, 0.5 / q
        system = ([2.0 * damping * w, w * w], [1.0, 2.0 * damping * w, w * w])
        numerator, denominator, _ = signal.cont2discrete(system, step, method="foh")
        padded = np.concatenate([values, np.zeros(math.ceil(1.5 / frequency / step))])
        out.append(np.max(np.abs(signal.lfilter(numerator.ravel(), denominator, padded))))
    return np.array(out)


PLATEAU = octaves(50.0, 3200.0, 6.0), lambda f: 1000.0 * np.minimum(f / 800.0, 1.0) ** 1.5
VALLEY = octaves(100.0, 1600.0, 6.0), lambda f: 200.0 * (0.6 + 0.4 * np.abs(np.log2(f / 400.0)))
STEEP = octaves(20.0, 640.0, 12.0), lambda f: 50.0 * (f / 20.0) ** 1.5


@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize(("f", "level"), [PLATEAU, VALLEY, STEEP])
def test_another_code_finds_the_spectrum_within_the_tolerance_of_mil_std_810h(basis, f, level):
    """-1.5 to +3 dB about a target 0.75 dB above nominal; wavelets at a sixth of an octave, where they hold it."""
    places = f[:: 2 if basis == "wavelets" and f is STEEP[0] else 1]
    found = synthesized(places, level(places) * 10.0 ** (0.75 / 20.0), 10.0, basis)
    decibels = 20.0 * np.log10(maximax(found.acceleration, found.step, f, 10.0) / level(f))
    assert decibels.min() > -1.5
    assert decibels.max() < 3.0


@pytest.mark.parametrize("basis", BASES)
def test_the_motion_ends_at_rest_where_it_began(basis):
    """Sums of straight lines vanish to rounding: 1e-6 of the largest is asked, and 1e-12 found."""
    f, level = PLATEAU
    found = synthesized(f, level(f), 10.0, basis)
    again = motion(found.acceleration, found.step)
    for values in (found.velocity, found.displacement, again.velocity, again.displacement):
        assert abs(values[-1]) < 1e-12 * np.abs(values).max()
    assert found.acceleration[0] == 0.0
    assert abs(found.acceleration[-1]) < 1e-12 * np.abs(found.acceleration).max()


def test_the_components_add_up_to_the_motion():
    """Up to where the fading begins, at 80 % of the motion."""
    f, level = PLATEAU
    found = synthesized(f, level(f))
    time = found.step * np.arange(round(0.8 * found.acceleration.size))
    total = sum(part.at(time) for part in (*found.components, *found.compensation))
    # components are left out where they have come down to 1.5e-8
    np.testing.assert_allclose(total, found.acceleration[: time.size], atol=1e-6 * np.abs(total).max())


def test_a_wavelet_leaves_no_velocity_and_no_displacement():
    """Irvine: an odd number of half-sines. Trapezoids over a smooth function that ends flat converge fast."""
    part = Component(100.0, 3.0, 0.002, math.nan, 5)
    time = np.linspace(0.0, 0.002 + 5 / 200.0, 200_001)
    moved = motion(part.at(time), float(time[1]))
    assert abs(moved.velocity[-1]) < 1e-8 * np.abs(moved.velocity).max()
    assert abs(moved.displacement[-1]) < 1e-6 * np.abs(moved.displacement).max()


def test_a_spectrum_that_no_motion_has_is_not_called_reached():
    """At high frequencies a spectrum is the peak of its motion: it cannot fall by 12 dB an octave."""
    f = octaves(100.0, 3200.0, 6.0)
    assert synthesized(f, 100.0 * (f / 100.0) ** -2.0).distance > 3.0


@pytest.mark.parametrize("q", [10.0, 25.0])
def test_the_half_sine_is_found_by_its_own_spectrum(q):
    """Limits of 0.1 % about it leave no other: peak and duration within that."""
    pulse = 300.0 * np.sin(np.pi * np.linspace(0.0, 1.0, 1001))
    f = octaves(10.0, 1000.0, 6.0)
    wanted = maximax(pulse, 6e-3 / 1000, f, q)
    found = matching_half_sine(f, 0.999 * wanted, 1.001 * wanted, q)
    assert found.peak == pytest.approx(300.0, rel=2e-3)
    assert found.duration == pytest.approx(6e-3, rel=2e-3)


@pytest.mark.parametrize(
    "arguments",
    [
        ([100.0], [1.0]),
        ([100.0, 50.0], [1.0, 1.0]),
        ([100.0, 200.0], [1.0, 0.0]),
        ([100.0, 200.0], [1.0, math.nan]),
        ([100.0, 200.0], [1.0, 1.0], 0.5),
        ([100.0, 200.0], [1.0, 1.0], 10.0, "cosines"),
        ([100.0, 200.0], [1.0, 1.0], 10.0, "wavelets", "maximax", 300.0),
    ],
)
def test_what_makes_no_sense_is_refused(arguments):
    with pytest.raises(ValueError, match=r"synthesis|levels|quality|basis|sampling"):
        synthesized(*arguments)
