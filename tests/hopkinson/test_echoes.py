"""A bar calibrated by its echoes: delay lines, a dispersive and lossy bar made in frequency, records that cannot do."""

import math

import numpy as np
import pytest

from strikewave.errors import InputError
from strikewave.hopkinson import Bar, Trace
from strikewave.hopkinson.echoes import calibrate_bar
from strikewave.waves import End, Layer, Pulse, Stack, Tap, Wanted, run_bar
from strikewave.waves.dispersion import wave_number

STEP = 1e-7


def echoes_of(bar, trips=6, loss=0.0, dispersive=True, way="towards", width=8e-6):
    """Return the strain at the gauge of a free bar: each pass a Gaussian carried its way by the transform."""
    near, far = 2.0 * bar.gauge_distance, 2.0 * (bar.length - bar.gauge_distance)
    first, second = (near, far) if way == "towards" else (far, near)
    size = int(2 * trips * (near + far) / bar.speed / STEP)
    time = STEP * np.arange(size)
    pulse = np.exp(-(((time - 100e-6) / width) ** 2))
    w = 2.0 * np.pi * np.fft.rfftfreq(size, STEP)
    k = np.asarray(wave_number(w, bar.rod, "pochhammer-chree" if dispersive else "none"))
    total, way_gone, spectrum = np.zeros(w.size, complex), 0.0, np.fft.rfft(pulse)
    for n in range(2 * trips):
        total += (-1.0) ** n * spectrum * np.exp(-(1j * k + loss) * way_gone)
        way_gone += first if n % 2 == 0 else second
    kept = int(trips * (near + far) / bar.speed / STEP)  # the rest holds what wraps around
    return Trace(1e-3 * np.fft.irfft(total, size)[:kept], STEP)


@pytest.mark.parametrize("way", ["towards", "away"])
@pytest.mark.parametrize("skip", [0, 1, 2])
def test_speed_length_and_loss_of_a_dispersive_bar(rng, way, skip):
    """Made with 5000 m/s, 2.0 m, 0.05 Np/m, a gauge at 0.8 m, searched from 5100 m/s with the length unknown.

    Phase and amplitude are exact but for tails that leave their window and noise of 1e-3: 2e-4 and 2 % of the loss.
    """
    bar = Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)
    trace = echoes_of(bar, loss=0.05, way=way)
    trace = Trace(trace.strain + 1e-6 * rng.standard_normal(trace.strain.size), STEP)
    found = calibrate_bar(trace, Bar(8000.0, 8000.0 * 5100.0**2, 0.02, 0.8), way, skip)
    assert found.speed.value == pytest.approx(5000.0, rel=2e-4)
    assert found.length.value == pytest.approx(2.0, rel=2e-4)
    assert found.attenuation.value == pytest.approx(0.05, rel=0.02)
    strong = found.frequency < 40e3
    assert found.phase_speed[strong] == pytest.approx(found.theory_speed[strong], rel=1e-3)


def test_dispersion_is_taken_off_the_speed():
    """Taken as plain, the same bar seems slower: the pulse's own frequencies run below c0."""
    bar = Bar(8000.0, 2e11, 0.04, 0.8, 0.29, 2.0)
    trace = echoes_of(bar, width=12e-6)
    plain = calibrate_bar(trace, bar, theory="none").speed.value
    proper = calibrate_bar(trace, bar).speed.value
    assert proper == pytest.approx(5000.0, rel=2e-4)
    assert plain < proper - 2.0


def test_echoes_of_delay_lines():
    """A free bar in delay lines: whole transits, no loss, no dispersion: speed to 1e-6, loss below 1e-6 Np/m.

    The bar is loaded at its end, 8000 steps long with the gauge 3000 steps before the far end.
    """
    speed = 5000.0
    layer = Layer("bar", 8000.0, 8000.0 * speed**2, 1e-4, 8000 * STEP * speed)
    load = Pulse("sine-squared", 1000.0, 60e-6)
    run = run_bar(Stack((layer,), (), End("free")), load, [Tap(0, 0.625)], 8e-3, Wanted(step=STEP))
    strain = run.force[:, 0] / (layer.modulus * layer.area)
    bar = Bar(8000.0, 8000.0 * (1.02 * speed) ** 2, 0.0113, 3000 * STEP * speed, 0.29)
    found = calibrate_bar(Trace(strain, STEP), bar, "towards", theory="none")
    assert found.speed.value == pytest.approx(speed, rel=1e-6)
    assert found.length.value == pytest.approx(layer.length, rel=1e-6)
    assert abs(found.attenuation.value) < 1e-6
    assert found.times[::2] - found.times[0] == pytest.approx(1.6e-3 * np.arange(found.times[::2].size), abs=1e-9)


def test_a_known_length_gives_more_pairs():
    bar = Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)
    trace = echoes_of(bar)
    known = calibrate_bar(trace, bar)
    unknown = calibrate_bar(trace, Bar(8000.0, 2e11, 0.02, 0.8))
    assert known.speed.values > unknown.speed.values
    assert known.length == (2.0, pytest.approx(math.nan, nan_ok=True), 0)
    assert known.speed.value == pytest.approx(5000.0, rel=2e-4)


def test_one_pulse_alone_or_noise_is_refused(rng):
    bar = Bar(8000.0, 2e11, 0.02, 0.8)
    time = STEP * np.arange(4000)
    one = np.exp(-(((time - 300e-6) / 8e-6) ** 2)) + 1e-4 * rng.standard_normal(time.size)
    with pytest.raises(InputError):
        calibrate_bar(Trace(one, STEP), bar)
    with pytest.raises(InputError):
        calibrate_bar(Trace(rng.standard_normal(4000), STEP), bar)
    with pytest.raises(InputError, match="towards"):
        calibrate_bar(Trace(one, STEP), bar, way="sideways")
    with pytest.raises(InputError, match="passes"):
        calibrate_bar(echoes_of(Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)), bar, skip=50)
