"""An accelerometer on a bar end beside its gauge: records by delay lines and by transforms, noise, limits of theory."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.signal import TransferFunction, lsim

from strikewave.analyses.hopkinson.bar_end import (
    Bench,
    Standing,
    bar_layer,
    compare_at_end,
    slope_error,
    theory_bandwidth,
)
from strikewave.base.errors import InputError
from strikewave.hopkinson import GaugeTrace
from strikewave.waves import End, Layer, Stack
from strikewave.waves.limits import rise_in_diameters

from .bench import STEP, sensor_bench, travelled, whole

STEEL_SPEED = math.sqrt(210e9 / 7800.0)
DISK = Layer("disk", 7800.0, 210e9, 3.8e-4, whole(20, STEEL_SPEED))
"""A steel disk of 10.4 mm whose transit is a whole number of steps of the delay lines."""


@pytest.fixture(scope="module")
def bare():
    """Bar, strain and acceleration of a bare end."""
    return sensor_bench()[:3]


def at_bandwidth(bar, strain, sensor, standing=None, bandwidth=40e3, theory="none"):
    return compare_at_end(strain, sensor, Bench(bar, standing or Standing(), theory), bandwidth)


@pytest.mark.parametrize(
    ("end", "disk", "standing", "error"),
    [
        (End("free"), None, Standing(), 1e-6),
        (End("mass", 0.03), None, Standing(0.03), 1e-5),
        (End("free"), DISK, Standing(0.0, DISK), 1e-6),
        (End("mass", 0.01), DISK, Standing(0.01, DISK), 1e-6),
    ],
    ids=["bare end", "rigid disk", "elastic disk", "sensor on an elastic disk"],
)
def test_the_reference_is_what_delay_lines_say(end, disk, standing, error):
    """Ratio of slopes, peaks and velocities 1, no delay, nothing left, and both waves agree.

    Exact but for rounding and cubics; a mass meets the steps of the delay lines: 1e-7 s of its 7e-6 s, squared. Disks
    are followed by the same delay lines, so that these rows show clocks and signs alone; transforms check them below.
    """
    found = at_bandwidth(*sensor_bench(end, disk)[:3], standing)
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=error)
    assert found.peaks[1] / found.peaks[0] == pytest.approx(1.0, abs=2.0 * error)
    assert found.velocities[1] / found.velocities[0] == pytest.approx(1.0, abs=10.0 * error)
    assert abs(found.agreement.delay) < 1e-3 * error
    assert found.agreement.residual < 20.0 * error
    assert found.reflected_misfit < 20.0 * error


@pytest.mark.parametrize("mass", [0.0, 0.01])
def test_an_elastic_disk_against_its_transfer_function(mass):
    """The outer face of a disk with a mass on it, by transfer matrices, from a sine-squared wave at the gauge.

    With kL the phase over the disk, Zd and Zb the impedances of disk and bar: v = 2 c e/[cos kL - (w m/Zd) sin kL +
    i ((Zd/Zb) sin kL + (w m/Zb) cos kL)]; the force on the bar is i (Zd sin kL + w m cos kL) v. 2e-5: steps of the
    delay lines, 1e-7 s, at the mass.
    """
    bar = sensor_bench()[0]
    size = 40_000
    w = 2.0 * np.pi * np.fft.rfftfreq(size, STEP)
    time = STEP * np.arange(size)
    gauge = 3e-4 * np.sin(np.pi * np.clip((time - 200e-6) / 200e-6, 0.0, 1.0)) ** 2
    end = np.fft.rfft(gauge) * np.exp(-1j * w * bar.delay)
    cosine, sine = np.cos(w * DISK.transit), np.sin(w * DISK.transit)
    push = 1j * (DISK.impedance * sine + w * mass * cosine)
    velocity = 2.0 * bar.speed * end / (cosine - w * mass / DISK.impedance * sine + push / bar.impedance)
    back = (push * velocity / bar.stiffness - end) * np.exp(-1j * w * bar.delay)
    strain = GaugeTrace((gauge + np.fft.irfft(back, size))[:12_000], STEP)
    sensor = GaugeTrace(np.fft.irfft(1j * w * velocity, size)[:12_000], STEP)
    found = at_bandwidth(bar, strain, sensor, Standing(mass, DISK))
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=2e-5)
    assert found.peaks[1] / found.peaks[0] == pytest.approx(1.0, abs=2e-5)
    assert abs(found.agreement.delay) < 1e-9
    assert found.agreement.residual < 1e-4
    assert found.reflected_misfit < 1e-4


def test_velocity_of_a_bare_end_is_the_closed_form(bare):
    """2 F/Z of a sine-squared force of 7 kN, which 40 kHz leaves as it is to 1e-5 (its width is eight periods)."""
    found = at_bandwidth(*bare)
    assert found.velocities[0] == pytest.approx(2.0 * 7000.0 / bare[0].impedance, rel=1e-4)


def test_gain_sign_and_delay_of_a_sensor_are_found(bare):
    """A reading of -0.8 of the acceleration, 3 us late, on a clock of 0.4 us that begins elsewhere, with an offset."""
    bar, strain, sensor = bare
    late = np.interp(sensor.time - 3e-6, sensor.time, sensor.strain)[137::4]
    found = at_bandwidth(bar, strain, GaugeTrace(-0.8 * late + 250.0, 4 * STEP, 137 * STEP))
    assert found.agreement.sensitivity == pytest.approx(-0.8, rel=1e-4)
    assert found.agreement.delay == pytest.approx(3e-6, abs=2e-9)
    assert found.peaks[1] / found.peaks[0] == pytest.approx(-0.8, rel=1e-3)
    assert found.correlation == pytest.approx(-1.0, abs=1e-5)


def test_a_sensor_with_a_resonance_is_late_by_its_damping(bare):
    """w^2/(s^2 + 2 z w s + w^2) delays slow pulses by 2 z/w, and gains about (w_p/w)^2 (1 - 2 z^2): 150 kHz, z = 0.6.

    The pulse swings at 5 kHz: the delay's next term is of (5/150)^2.
    """
    bar, strain, sensor = bare
    w, damping = 2.0 * math.pi * 150e3, 0.6
    _, read, _ = lsim(TransferFunction([w**2], [1.0, 2.0 * damping * w, w**2]), sensor.strain, sensor.time)
    found = at_bandwidth(bar, strain, GaugeTrace(read, STEP))
    assert found.agreement.delay == pytest.approx(2.0 * damping / w, rel=5e-3)
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=2.0 * (5.0 / 150.0) ** 2)


def test_a_dispersive_bar_is_corrected(bare):
    """The wave runs on along a Pochhammer-Chree bar by the transform of its whole record, and the end turns it over.

    A trapezoid that rises in 30 us over 1 m of 20 mm aluminium: uncorrected, the front is late by (f d/c0)^2.
    """
    bar = bare[0]
    time = STEP * np.arange(40_000)
    gauge = np.interp(time, [200e-6, 230e-6, 330e-6, 360e-6], [0.0, 3e-4, 3e-4, 0.0])
    end = travelled(gauge, STEP, bar.gauge_distance, bar)
    strain = GaugeTrace((gauge - travelled(end, STEP, bar.gauge_distance, bar))[:11_000], STEP)
    sensor = GaugeTrace(np.gradient(2.0 * bar.speed * end, STEP)[:11_000], STEP)
    corrected, plain = (at_bandwidth(bar, strain, sensor, theory=t) for t in ("pochhammer-chree", "none"))
    assert corrected.agreement.residual < 1e-3  # a corner's slow tail, cut by the window
    assert corrected.agreement.sensitivity == pytest.approx(1.0, abs=1e-5)
    assert abs(corrected.agreement.delay) < 1e-10
    assert corrected.reflected_misfit < 1e-4
    assert plain.agreement.residual > 10.0 * corrected.agreement.residual
    assert plain.agreement.delay > 2e-7


def test_a_wrong_mass_is_told_by_the_reflected_wave():
    """30 gram stand there, 10 are stated: the reference reads 2 % too much, and the reflected wave misses by more."""
    found = at_bandwidth(*sensor_bench(End("mass", 0.03))[:3], Standing(0.01))
    assert found.agreement.sensitivity < 0.985
    assert found.reflected_misfit > 0.05


@pytest.mark.verify
@pytest.mark.parametrize(("strain_noise", "sensor_noise"), [(3e-6, 500.0), (1e-7, 5000.0)])
def test_scatter_of_the_sensitivity_is_what_repeated_noise_makes(bare, rng, strain_noise, sensor_noise):
    """White noise on gauge and sensor, 40 draws: mean slope within its bias, scatter within a factor 1.6.

    The standard deviation of 40 draws is known to 11 %; the estimate rests on some six numbers a pulse amounts to,
    and its own correction for them, n/(n - 2), is as wide as 1.5.
    """
    bar, strain, sensor = bare
    draws = [
        at_bandwidth(
            bar,
            GaugeTrace(strain.strain + strain_noise * rng.standard_normal(strain.strain.size), STEP),
            GaugeTrace(sensor.strain + sensor_noise * rng.standard_normal(sensor.strain.size), STEP),
        )
        for _ in range(40)
    ]
    slopes = np.array([draw.agreement.sensitivity for draw in draws])
    told = math.sqrt(np.mean([draw.scatter**2 for draw in draws]))
    assert 1.0 / 1.6 < told / slopes.std(ddof=1) < 1.6
    bias = draws[0].bias
    assert abs(slopes.mean() - 1.0 + bias) < 0.3 * bias + 3.0 * slopes.std(ddof=1) / math.sqrt(40)
    assert draws[0].reading_noise == pytest.approx(sensor_noise * math.sqrt(2.0 * STEP * 40e3), rel=0.05)


def test_slope_error_of_white_noise_is_the_textbook_one(rng):
    """sigma/sqrt(sum x^2), in the root mean square of 200 draws, within its own correction for few numbers."""
    t = np.arange(3000.0)
    x = np.exp(-(((t - 1500.0) / 60.0) ** 2)) * np.sin((t - 1500.0) / 20.0)
    told = [slope_error(3.0 * x + 0.05 * rng.standard_normal(t.size), x) for _ in range(200)]
    white = 0.05 / math.sqrt(x @ x) / 3.0
    assert 0.95 < math.sqrt(np.mean(np.square(told))) / white < 1.3


@pytest.mark.parametrize("standing", [Standing(), Standing(0.3)])
def test_power_of_the_bar_speed(bare, standing):
    """At a constant density a bare end moves with c; what a heavy mass gets is the force, with c^2, in between."""
    found = at_bandwidth(*bare, standing)
    assert 1.0 - 1e-6 < found.speed_power < 2.0
    assert (found.speed_power == pytest.approx(1.0, abs=1e-9)) == (standing.mass == 0.0)


def test_bandwidth_that_is_chosen(bare, rng):
    """The lowest of theory, noise and sampling, each where it binds."""
    bar, strain, sensor = bare
    sampled = at_bandwidth(*bare, bandwidth=None).bandwidth
    assert (sampled.value, sampled.reason) == (pytest.approx(0.1 / STEP), "sampling")
    noisy = GaugeTrace(strain.strain + 3e-6 * rng.standard_normal(strain.strain.size), STEP)
    found = at_bandwidth(bar, noisy, sensor, bandwidth=None).bandwidth
    assert found.reason == "noise"
    assert found.value == found.noise < 80e3
    steep = at_bandwidth(*sensor_bench(duration=30e-6)[:3], bandwidth=None)
    layer = bar_layer(bar)
    assert steep.bandwidth.reason == "one-dimensional theory"
    assert steep.bandwidth.value == pytest.approx(theory_bandwidth(steep.pulses.rise, (layer,)), rel=1e-12)
    assert rise_in_diameters(Stack((layer,)), steep.pulses.rise, steep.bandwidth.value)[0] == pytest.approx(5.0)


def test_a_steep_pulse_keeps_its_slope_at_the_bandwidth_of_theory():
    """Both are low-passed alike: the same sensitivity at 18 kHz of a pulse whose own band is five times that."""
    found = at_bandwidth(*sensor_bench(duration=30e-6)[:3], bandwidth=None)
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("bandwidth", [1.0, 2.6e6, 1e9])
def test_bandwidths_that_do_not_fit_are_refused(bare, bandwidth):
    with pytest.raises(InputError, match=r"solver\.bandwidth"):
        at_bandwidth(*bare, bandwidth=bandwidth)


def test_records_that_cannot_be_compared_are_told(bare, rng):
    bar, strain, sensor = bare
    for cut in (
        GaugeTrace(sensor.strain[5000:], STEP, 5000 * STEP),
        GaugeTrace(sensor.strain[:6000], STEP),
        GaugeTrace(sensor.strain, STEP, 1.0),
    ):
        with pytest.raises(InputError, match="one clock"):
            at_bandwidth(bar, strain, cut)
    with pytest.raises(InputError, match="noise alone"):
        at_bandwidth(bar, strain, GaugeTrace(np.full(sensor.strain.size, 0.3), STEP))
    with pytest.raises(InputError, match="noise alone"):
        at_bandwidth(bar, strain, GaugeTrace(0.3 + 0.01 * rng.standard_normal(sensor.strain.size), STEP))
    with pytest.raises(InputError, match="record"):
        at_bandwidth(bar, GaugeTrace(strain.strain[:5000], STEP), sensor)
    thin = Layer("disk", 7800.0, 210e9, 3.8e-4, 1e-9)
    with pytest.raises(InputError, match="disk"):
        at_bandwidth(*bare, Standing(0.0, thin))


def test_a_gauge_near_the_struck_end_keeps_its_window():
    """The far end's echo comes 200 us after the reflected pulse begins: it ends what both waves say, nothing else.

    A period of the low-pass ahead of the echo, 1e-4 of it is left at most.
    """
    bar, strain, sensor, _ = sensor_bench(gauge=0.25)
    found = at_bandwidth(bar, strain, sensor)
    assert found.pulses.duration == pytest.approx(2.0 * bar.delay, abs=2 * STEP)
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=1e-6)
    told = np.isfinite(found.both_waves)
    assert found.time[told][-1] == pytest.approx(200e-6 - 1.0 / 40e3, abs=1e-6)
    assert found.reflected_misfit < 1e-4


def test_an_echo_that_comes_too_soon_leaves_both_waves_unknown(bare):
    """The struck end 3 us of way behind the gauge: the reflected wave is never alone there, the reference is as it was."""
    bar, strain, sensor = bare
    found = at_bandwidth(dataclasses.replace(bar, length=1.016 * bar.gauge_distance), strain, sensor)
    assert math.isnan(found.reflected_misfit)
    assert found.agreement.sensitivity == pytest.approx(1.0, abs=1e-6)
