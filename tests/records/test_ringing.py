"""Whether a record rings after a blow or in it, and at which frequency: spectra in closed form, each bound both sides."""

import math

import numpy as np
import pytest

from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.ringing import Stretch, ringing_of, spectrum_after, strongest_frequency, swings_after

STEP, WIDTH, BEGIN, END = 1e-4, 40.0, 100, 142
SMOOTH = SmoothPulse(10.0, BEGIN * STEP, 42.0 * STEP, 0.5, 1.0)


def stretch(after, misfit=0.0, noise=0.0, size=1000, within=None):
    """Return a half-sine of 10 with what follows its feet, from the sample after them on, or what is added in it."""
    values = SMOOTH.at(STEP * np.arange(size))
    values[END : END + after.size] += after[: max(size - END, 0)]
    if within is not None:
        values[BEGIN : BEGIN + within.size] += within
    return Stretch(values, STEP, BEGIN, END, WIDTH, SMOOTH._replace(misfit=misfit), noise)


def test_a_spectrum_is_that_of_what_fades_about_its_mean():
    """Lines of 8 n samples by the sum of exponentials; the later half of Hann's window."""
    values = np.array([4.0, 1.0, -2.0, 0.5, 3.0])
    frequencies, height = spectrum_after(values, 0.1)
    faded = (values - 1.3) * np.hanning(10)[5:]
    expected = [abs(np.sum(faded * np.exp(-2j * math.pi * k * np.arange(5) / 40))) for k in range(21)]
    assert frequencies == pytest.approx(np.arange(21) / 4.0)
    assert height == pytest.approx(np.array(expected), abs=1e-12)


def test_the_strongest_frequency_lies_above_a_lowest_one():
    """To a line of the padded spectrum, 1 / (8 n step), and the skirt of what lies below."""
    time = STEP * np.arange(400)
    values = 5.0 * np.exp(-time / 0.02) * np.sin(2.0 * math.pi * 300.0 * time) + np.sin(2.0 * math.pi * 1700.0 * time)
    line = 1.0 / (8 * 400 * STEP)
    assert strongest_frequency(values, STEP, 0.0) == pytest.approx(300.0, abs=2.0 * line)
    assert strongest_frequency(values, STEP, 900.0) == pytest.approx(1700.0, abs=line)
    assert math.isnan(strongest_frequency(values, STEP, 5001.0))
    assert strongest_frequency(np.tile([1.0, -1.0], 20), STEP, 5000.0) == 5000.0


@pytest.mark.parametrize(
    ("low", "high", "noise", "swings"),
    [(-0.2, 0.82, 0.0, True), (-0.2, 0.78, 0.0, False), (0.4, 1.42, 0.1, True), (-0.2, 0.82, 0.103, False)],
)
def test_a_record_swings_by_a_twentieth_of_the_peak_and_five_noises(low, high, noise, swings):
    """Half of what it spans within five widths."""
    after = np.full(200, 0.5 * (low + high))
    after[[3, 199]] = low, high
    assert swings_after(stretch(after, noise=noise)) is swings
    after[199] = low
    assert not swings_after(stretch(np.append(after, high), noise=noise))  # a sample later


def test_eight_samples_after_a_blow_are_enough():
    after = np.tile([2.0, -2.0], 100)
    for size, seen in ((END + 8, True), (END + 7, False)):
        short = stretch(after, size=size)
        assert swings_after(short) is seen
        assert math.isnan(ringing_of(short)) is not seen


def sine(frequency, amplitude=2.0, size=200):
    return amplitude * np.sin(2.0 * math.pi * frequency * STEP * np.arange(size))


def test_what_follows_a_blow_rings_from_three_tenths_of_a_swing_a_width_on():
    """Of a width of 4 ms: 75 Hz. Slower motion is none, however strong."""
    line = 1.0 / (8 * 200 * STEP)
    for frequency in (110.0, 400.0, 2100.0):
        assert ringing_of(stretch(sine(frequency))) == pytest.approx(frequency, abs=4.0 * line)
    both = sine(400.0, 1.0) + np.linspace(40.0, 0.0, 200)
    assert ringing_of(stretch(both)) >= 75.0
    late = np.zeros(700)
    late[200:] = 3.0  # beyond five widths
    assert math.isnan(ringing_of(stretch(late)))


@pytest.mark.parametrize(
    ("frequency", "misfit", "noise", "rings"),
    [
        (1200.0, 0.031, 0.0, True),
        (1200.0, 0.029, 0.0, False),
        (1200.0, 0.031, 0.205, True),
        (1200.0, 0.031, 0.208, False),
        (700.0, 0.031, 0.0, True),
        (560.0, 0.031, 0.0, False),
    ],
)
def test_ringing_in_a_blow_is_what_the_smooth_pulse_misses(frequency, misfit, noise, rings):
    """By 3 % of the peak and 1.5 noises; it swings 2.5 times in a width at least, 625 Hz, or it is the shape."""
    found = ringing_of(
        stretch(np.zeros(1), misfit, noise, within=sine(frequency, 0.9, 60) * np.exp(-np.arange(60) / 12.0))
    )
    assert math.isnan(found) is not rings
    if rings:
        assert found == pytest.approx(frequency, rel=0.05)  # a swing that dies out has a wide line
