"""Independent split-Hopkinson records: delay lines for bar, specimen and bar, and dispersive ones made in frequency."""

import math

import numpy as np

from strikewave.hopkinson import Bar, GaugeTrace, Specimen
from strikewave.waves import BONDED, End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar
from strikewave.waves.dispersion import wave_number

STEEL = {"density": 7800.0, "modulus": 210e9}
STEP = 1e-7
"""Every transit below is a whole number of these, so that delay lines carry the waves without error."""


def whole(transits, speed):
    """Return the length that a wave passes in so many steps."""
    return transits * STEP * speed


def bench(modulus=70e9, rise=10e-6, transits=20, diameter=0.012):
    """Return bars, elastic specimen and both traces of a test with a trapezoid of 500 N that lasts 100 us.

    The incident bar is 500 us long with its gauge 150 us before the specimen, the other gauge is 100 us behind it.
    """
    speed = math.sqrt(STEEL["modulus"] / STEEL["density"])
    bars = (
        Bar(**STEEL, diameter=0.02, gauge_distance=whole(1500, speed), length=whole(5000, speed)),
        Bar(**STEEL, diameter=0.02, gauge_distance=whole(1000, speed), length=whole(5000, speed)),
    )
    density = 2700.0
    specimen = Specimen(whole(transits, math.sqrt(modulus / density)), 0.25 * math.pi * diameter**2, density, modulus)
    layers = (
        Layer("incident", **STEEL, area=bars[0].area, length=bars[0].length),
        Layer("specimen", density, modulus, specimen.area, specimen.length),
        Layer("transmitted", **STEEL, area=bars[1].area, length=bars[1].length),
    )
    stack = Stack(layers, (BONDED, BONDED), End("matched"))
    taps = [Tap(0, 0.7), Tap(2, 0.2), Tap(1, 0.0), Tap(1, 1.0)]
    run = run_bar(stack, LoadPulse("trapezoid", 500.0, 100e-6, rise), taps, 900e-6, WantedError(step=STEP))
    traces = tuple(GaugeTrace(run.force[:, k] / bar.stiffness, STEP, -50e-6) for k, bar in enumerate(bars))
    return bars, specimen, traces, run


def travelled(values, step, distance, bar):
    """Return a wave after a distance in a dispersive bar, delay included, by the transform of the whole record."""
    w = 2.0 * np.pi * np.fft.rfftfreq(values.size, step)
    turn = np.exp(-1j * np.asarray(wave_number(w, bar.rod)) * distance)
    return np.fft.irfft(np.fft.rfft(values) * turn, values.size)


ALUMINIUM = {"density": 2700.0, "modulus": 70e9}


def sensor_bench(end=None, disk=None, duration=200e-6, gauge=0.5):
    """Return a bar, the strain at its gauge, and the acceleration of what stands on its end, by delay lines.

    The bar is 400 us long with its gauge in the middle; a sine-squared push of 7 kN for 200 us, a strain of 3.2e-4,
    takes a bare end to 3.2 m/s. Nothing here knows `strikewave.hopkinson.bar_end`.
    """
    speed = math.sqrt(ALUMINIUM["modulus"] / ALUMINIUM["density"])
    bar = Bar(**ALUMINIUM, diameter=0.02, gauge_distance=(1.0 - gauge) * whole(4000, speed), length=whole(4000, speed))
    layers = (Layer("bar", **ALUMINIUM, area=bar.area, length=bar.length), *([disk] if disk else []))
    stack = Stack(layers, (BONDED,) * (len(layers) - 1), end or End("free"))
    taps = [Tap(0, gauge), Tap(len(layers) - 1, 1.0)]
    run = run_bar(stack, LoadPulse("sine-squared", 7000.0, duration), taps, 1320e-6, WantedError(step=STEP))
    return bar, GaugeTrace(run.force[:, 0] / bar.stiffness, STEP), GaugeTrace(run.acceleration[:, 1], STEP), run
