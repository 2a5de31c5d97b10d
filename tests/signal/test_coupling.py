"""AC coupling against closed forms, and its inverse against it."""

import math

import numpy as np
import pytest

from strikewave.signal.filters import ac_coupled, ac_uncoupled


@pytest.mark.parametrize("constant", [1e-5, 3e-4, 1e-2, 1.0])
def test_the_inverse_is_exact(constant, rng):
    """Trapezoids both ways: what is left is rounding, which the sum of 5 000 samples carries on."""
    values = np.concatenate([[0.0], rng.normal(size=5000)])
    assert np.max(np.abs(ac_uncoupled(ac_coupled(values, 1e-5, constant), 1e-5, constant) - values)) < 1e-10


def test_a_half_sine_is_undershot_as_in_closed_form():
    """x = sin(pi t / T): y = (w^2 tau^2 sin wt + w tau cos wt - w tau e^(-t/tau)) / (1 + w^2 tau^2) until T."""
    length, constant, step = 1e-3, 2e-3, 1e-6
    time = step * np.arange(6000)
    omega = math.pi / length
    clean = np.where(time < length, np.sin(omega * time), 0.0)
    a = omega * constant
    inside = (a**2 * np.sin(omega * time) + a * np.cos(omega * time) - a * np.exp(-time / constant)) / (1.0 + a**2)
    last = -a * (1.0 + math.exp(-length / constant)) / (1.0 + a**2)
    truth = np.where(time < length, inside, last * np.exp(-(time - length) / constant))
    coupled = ac_coupled(clean, step, constant)
    # lines between samples: (w h)^2 / 12 = 8e-7
    assert np.max(np.abs(coupled - truth)) < 2e-6


def test_the_area_of_pulse_and_undershoot_is_zero():
    """Nothing passes at frequency zero: after twenty time constants e^-20 of the area is left."""
    pulse = np.zeros(60_000)
    pulse[1000:2000] = np.sin(np.pi * (np.arange(1000) + 0.5) / 1000)
    coupled = ac_coupled(pulse, 1e-6, 2.5e-3)
    assert abs(np.sum(coupled)) < 1e-8 * np.sum(pulse)
