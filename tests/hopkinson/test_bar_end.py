"""An accelerometer on a bar end: closed forms for free end and rigid disk, waves in an elastic one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.hopkinson import Bar, bar_end
from strikewave.hopkinson.bar_end import _moved, compare_sensor, elastic_disk, free_end, rigid_disk
from strikewave.waves import Layer

BAR = Bar(2700.0, 70e9, 0.02, 1.0)
STEP = 1e-7
TIME = STEP * np.arange(2000)
PULSE = 4e-4 * np.sin(np.pi * np.clip(TIME / 80e-6, 0.0, 1.0)) ** 2


def test_free_end_moves_twice_as_fast_as_the_wave():
    """v = 2 c e; a by central differences, whose error is step^2/6 times the third derivative."""
    motion = free_end(PULSE, STEP, BAR)
    assert motion.velocity == pytest.approx(2.0 * BAR.speed * PULSE, rel=1e-15)
    w = 2.0 * np.pi / 80e-6
    inside = TIME < 79e-6
    exact = 2.0 * BAR.speed * 4e-4 * 0.5 * w * np.sin(w * TIME)
    bound = BAR.speed * 4e-4 * w**3 * STEP**2 / 6.0
    assert np.abs(motion.acceleration - exact)[inside][1:].max() <= bound * (1 + 1e-6)


@pytest.mark.parametrize("mass", [1e-3, 0.05, 1.0])
def test_rigid_disk_under_a_sine_squared_pulse(mass):
    """m dv/dt = 2 F - Z v has the closed form of a first-order low-pass; straight samples err by step^2 F''/8."""
    w, tau = 2.0 * np.pi / 80e-6, mass / BAR.impedance
    inside = TIME <= 80e-6
    t = TIME[inside]
    gain = 1.0 / (1.0 + (w * tau) ** 2)
    steady = 0.5 * (1.0 - gain * (np.cos(w * t) + w * tau * np.sin(w * t)))
    exact = 2.0 * BAR.speed * 4e-4 * (steady - 0.5 * (1.0 - gain) * np.exp(-t / tau))
    motion = rigid_disk(PULSE, STEP, BAR, mass)
    bound = 2.0 * BAR.speed * 4e-4 * (w * STEP) ** 2 / 16.0
    assert np.abs(motion.velocity[inside] - exact).max() < 1.01 * bound
    assert motion.force == pytest.approx(mass * motion.acceleration, rel=1e-14)


def test_rigid_disk_transfer_in_frequency():
    """2/(1 + s m/Z) of F/Z at s = i w: amplitude and phase of the steady state, 1e-6."""
    mass, frequency = 0.02, 20e3
    w = 2.0 * math.pi * frequency
    time = STEP * np.arange(40_000)
    motion = rigid_disk(1e-4 * np.sin(w * time), STEP, BAR, mass)
    late = time > 30.0 * mass / BAR.impedance + 1e-3
    basis = np.column_stack([np.sin(w * time[late]), np.cos(w * time[late])])
    inphase, across = np.linalg.lstsq(basis, motion.velocity[late], rcond=None)[0]
    transfer = 2.0 * BAR.speed * 1e-4 / (1.0 + 1j * w * mass / BAR.impedance)
    assert inphase + 1j * across == pytest.approx(transfer, rel=3e-5)  # (w step)^2/12 = 1.3e-5 of straight samples


@pytest.mark.parametrize("ratio", [0.02, 0.01, 0.005])
def test_an_elastic_disk_becomes_rigid_as_its_transit_shrinks(ratio):
    """The delay between faces and ringing go with the square of transit over pulse: velocity within (2 ratio)^2."""
    transit = ratio * 80e-6
    mass = 0.02
    speed = 0.005 / transit
    density = mass / (BAR.area * 0.005)
    disk = Layer("disk", density, density * speed**2, BAR.area, 0.005)
    soft, hard = elastic_disk(PULSE, STEP, BAR, disk), rigid_disk(PULSE, STEP, BAR, mass)
    assert np.abs(soft.velocity - hard.velocity).max() / hard.velocity.max() < (4.0 * ratio) ** 2 + 2e-5


def test_a_disk_of_the_bar_itself_is_a_free_end_one_transit_later():
    """The same material and area: v = 2 c e after the transit of the disk, to the step of the delay lines."""
    disk = Layer("disk", BAR.density, BAR.modulus, BAR.area, 40 * STEP * BAR.speed)
    motion = elastic_disk(PULSE, STEP, BAR, disk)
    late = np.interp(TIME - 40 * STEP, TIME, 2.0 * BAR.speed * PULSE, left=0.0)
    assert np.abs(motion.velocity - late).max() < 1e-5 * late.max()
    inside = (TIME > 1e-6) & (TIME < 3.9e-6)
    assert motion.force[inside] == pytest.approx((BAR.stiffness * PULSE)[inside], rel=1e-6, abs=1e-2)


@given(st.floats(0.1, 10.0), st.floats(-20.0, 20.0), st.sampled_from([1.0, -1.0]))
def test_sensitivity_and_delay_of_a_sensor_are_found(gain, samples, sign):
    """A reading that is the reference times a gain and later by any part of a step: 1e-3 of a step, 1e-6 of the gain."""
    t = np.arange(1500.0)

    def pulse(at):
        return np.exp(-(((at - 600.0) / 60.0) ** 2)) * np.sin(at / 40.0)

    found = compare_sensor(sign * gain * pulse(t - samples), pulse(t), 1e-6)
    assert found.delay == pytest.approx(samples * 1e-6, abs=2e-9)
    assert found.sensitivity == pytest.approx(sign * gain, rel=1e-5)


@pytest.mark.parametrize("bad", [[], [1.0], [np.nan, 1.0], [[1.0, 2.0]]])
def test_histories_that_are_none_are_refused(bad):
    with pytest.raises(ValueError, match="history"):
        free_end(bad, STEP, BAR)
    with pytest.raises(ValueError, match="history"):
        rigid_disk(bad, STEP, BAR, 1.0)
    with pytest.raises(ValueError, match=r"history|same"):
        compare_sensor(bad, [1.0, 2.0], STEP)


def test_a_disk_without_mass_is_refused():
    with pytest.raises(ValueError, match="mass"):
        rigid_disk(PULSE, STEP, BAR, 0.0)


@pytest.mark.parametrize("transit", [9.6, 26.4])
@pytest.mark.parametrize("mass", [0.0, 0.01])
def test_an_elastic_disk_with_a_sensor_against_its_line_in_laplace(transit, mass):
    """Zin = Zd (ZL + Zd tanh sT)/(Zd + ZL tanh sT), ZL = s m, F = 2 Fi Zin/(Zin + Zb): shifted transform, 1e-5."""
    bar, size, shift = Bar(2700.0, 70e9, 0.02, 1.0), 1 << 16, 2000.0
    speed = math.sqrt(210e9 / 7800.0)
    disk = Layer("disk", 7800.0, 210e9, 0.5 * bar.area, transit * STEP * speed)
    s = shift + 2j * np.pi * np.fft.rfftfreq(size, STEP)
    force = bar.stiffness * np.fft.rfft(PULSE * np.exp(-shift * TIME), size)
    tanh, zd, zl = np.tanh(s * disk.transit), disk.impedance, s * mass
    zin = zd * (zl + zd * tanh) / (zd + zl * tanh)
    face = 2.0 * force * zin / (zin + bar.impedance)
    outer = face / zin * np.cosh(s * disk.transit) - face / zd * np.sinh(s * disk.transit)
    exact = np.fft.irfft(outer, size)[:2000] * np.exp(shift * TIME)
    found = elastic_disk(PULSE, STEP, bar, disk, mass).velocity
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()


@pytest.mark.parametrize("gain", [3.0, -3.0])
@pytest.mark.parametrize("second", [0.999, 1.001])
@pytest.mark.parametrize("first", [1.0, -1.0])
def test_the_ratio_of_peaks_compares_the_same_lobe(gain, second, first):
    """Two lobes, the second of the other sign: which is larger in the reading by a hair does not turn the ratio."""
    t = np.linspace(0.0, 1.0, 1001)
    one, other = np.exp(-(((t - 0.4) / 0.05) ** 2)), np.exp(-(((t - 0.7) / 0.05) ** 2))
    found = compare_sensor(first * gain * (one - second * other), first * (one - 0.5 * other), 1e-3)
    assert found.peak_ratio == pytest.approx(gain, rel=2e-3)


def test_a_ramp_goes_through_an_elastic_disk_of_the_bar_itself_to_its_last_sample():
    """v = 2 c e one transit later, and its slope; the force on the disk is E A e until the face outside answers."""
    disk = Layer("disk", BAR.density, BAR.modulus, BAR.area, 80 * STEP * BAR.speed)
    ramp = 1e-6 * np.arange(300.0)
    motion = elastic_disk(ramp, STEP, BAR, disk)
    late = 2.0 * BAR.speed * 1e-6 * np.maximum(np.arange(300) - 80, 0)
    assert motion.velocity == pytest.approx(late, abs=1e-8 * late[-1])
    assert motion.acceleration[82:] == pytest.approx(2.0 * BAR.speed * 1e-6 / STEP, rel=1e-6)
    # the wave back from the outer face, free, takes away what came two transits before
    force = BAR.stiffness * 1e-6 * (np.arange(300) - np.maximum(np.arange(300) - 160, 0))
    assert motion.force == pytest.approx(force, abs=1e-8 * force[-1])


def test_readings_at_the_ends_of_a_record_are_moved_as_whole_samples():
    """One sample each: the only overlap is at the end of the correlation, where there is no parabola."""
    first, last = np.array([2.0, 0.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 1.0])
    early = compare_sensor(first, last, 0.5)
    assert (early.sensitivity, early.peak_ratio, early.delay) == pytest.approx((2.0, 2.0, -1.5))
    assert early.residual == pytest.approx(0.0, abs=1e-12)
    late = compare_sensor(-last, first, 0.5)
    assert (late.sensitivity, late.peak_ratio, late.delay) == pytest.approx((-0.5, -0.5, 1.5))


def test_what_a_reading_has_besides_is_its_residual():
    """A second pulse far off, of 3/4 of the first: a residual of 3/5; a silent side is refused."""
    t = np.arange(2000.0)
    one, other = np.exp(-(((t - 500.0) / 40.0) ** 2)), np.exp(-(((t - 1500.0) / 40.0) ** 2))
    found = compare_sensor(2.0 * (one + 0.75 * other), one, 1e-6)
    assert (found.sensitivity, found.peak_ratio) == pytest.approx((2.0, 2.0), rel=1e-9)
    assert found.residual == pytest.approx(0.6, rel=1e-9)
    assert found.delay == pytest.approx(0.0, abs=1e-15)
    for reading, reference in ((0.0 * one, one), (one, 0.0 * one), (one[1:], one)):
        with pytest.raises(ValueError, match="the same number of samples, and not all zero"):
            compare_sensor(reading, reference, 1e-6)
    for step in (0.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="a step above zero"):
            free_end(one, step, BAR)
    assert np.array_equal(free_end([0.0, 1.0], 1.0, BAR).force, [0.0, 0.0])


@pytest.mark.parametrize("rate", [2e-7, 0.99e-4, 1.01e-4, 0.3, 5.0])
def test_a_heavy_or_a_light_disk_follows_a_ramp_in_closed_form(rate):
    """v = s (t - tau + tau exp(-t/tau)), s = 2 c de/dt: exact for straight samples, whatever step over tau."""
    tau = STEP / rate
    motion = rigid_disk(1e-6 * np.arange(400.0), STEP, BAR, tau * BAR.impedance)
    t, slope = STEP * np.arange(400), 2.0 * BAR.speed * 1e-6 / STEP
    exact = slope * tau * (t / tau + np.expm1(-t / tau))
    # the difference loses what t/tau lacks to 1
    assert motion.velocity == pytest.approx(exact, rel=1e-9, abs=1e-12 * slope * tau)
    assert motion.velocity[0] == 0.0
    assert motion.acceleration == pytest.approx(slope * -np.expm1(-t / tau), rel=1e-9, abs=1e-12 * slope)


@pytest.mark.parametrize(("transit", "steps"), [(5.0, 20), (26.4, 27), (31.0, 31), (20.0 + 1e-9, 20)])
def test_a_disk_is_crossed_in_twenty_steps_at_least_and_in_a_whole_number(monkeypatch, transit, steps):
    """Of the record's step where that makes more; rounding adds none."""
    asked, plain = [], bar_end.run_bar
    monkeypatch.setattr(bar_end, "run_bar", lambda *a: (asked.append(a), plain(*a))[1])
    disk = Layer("disk", BAR.density, BAR.modulus, BAR.area, transit * STEP * BAR.speed)
    elastic_disk(PULSE[:60], STEP, BAR, disk)
    stack, load, taps, end, wanted = asked[0]
    assert wanted.step == pytest.approx(disk.transit / steps, rel=1e-12)
    # the bar before it is longer than the record, and the run ends with it
    assert stack.layers[0].transit == pytest.approx(1.01 * 60 * STEP, rel=1e-12)
    assert end == pytest.approx(stack.layers[0].transit + 59 * STEP, rel=1e-12)
    assert [(tap.layer, tap.position) for tap in taps] == [(1, 0.0), (1, 1.0)]
    assert load.values == pytest.approx(BAR.stiffness * PULSE[:60], rel=1e-15)


def test_a_reading_is_moved_between_samples_by_a_cubic_and_is_zero_before_its_begin():
    cubes = np.arange(6.0) ** 3
    assert _moved(cubes, 0.5) == pytest.approx([0.0, *(np.arange(5) + 0.5) ** 3], rel=1e-12)
    assert _moved(cubes, -1.25) == pytest.approx([*(np.arange(4) + 1.25) ** 3, 0.0, 0.0], rel=1e-12)
    assert _moved(cubes, 0.0) == pytest.approx(cubes, abs=1e-12)


@pytest.mark.parametrize(("place", "top"), [(2, 5), (11, 1), (0, 10)])
def test_a_delay_lies_at_the_vertex_of_three_correlations(place, top):
    """A reference of one sample: the reading is its own correlation, 3, 8, 7 about its top; vertex 1/3 later.

    The second and the last but one of all correlations have neighbours too.
    """
    one, reading = np.zeros(12), np.zeros(12)
    one[place], reading[top - 1 : top + 2] = 1.0, [3.0, 8.0, 7.0]
    vertex = top + 0.5 * (3.0 - 7.0) / (3.0 - 16.0 + 7.0)
    for sign in (1.0, -1.0):
        assert compare_sensor(sign * reading, one, 0.5).delay == pytest.approx(0.5 * (vertex - place), rel=1e-12)
