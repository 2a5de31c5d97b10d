"""What a sensor and a recorder make of a pulse: resonance, range, filter, instants, bits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.sensors import (
    Mounting,
    Recorder,
    Sensor,
    accelerometer,
    accelerometers,
    oscilloscope,
    output,
    read,
    storage_recorder,
)
from strikewave.signal.filters import low_pass

G = 9.80665
STEP = 1e-7


def half_sine(duration, size=4001):
    t = np.arange(size) * STEP
    return np.where(t < duration, np.sin(np.pi * t / duration), 0.0)


@given(st.integers(0, 50), st.integers(1, 40))
def test_ideal_sensor_returns_the_surface_at_the_instants(seed, every):
    surface = np.random.default_rng(seed).normal(size=500)
    reading = read(Sensor(), Recorder(), surface, STEP, start=1.0)
    assert np.array_equal(reading.values, surface)
    assert not reading.clipped
    assert reading.peak_before_clip == np.max(np.abs(surface))
    assert reading.quantum == 0.0
    sampled = read(Sensor(), Recorder(sampling_rate=1.0 / (every * STEP)), surface, STEP, start=1.0)
    # instants hit the samples to round-off, and the history changes by a few units between samples
    assert np.allclose(sampled.values, surface[::every], atol=1e-9)
    assert np.allclose(sampled.time, 1.0 + np.arange(sampled.time.size) * every * STEP, atol=1e-15)


@given(st.floats(0.0, 0.999))
def test_instants_between_samples_lie_on_the_chord(phase):
    ramp = 3.0 + 2e6 * np.arange(1001) * STEP
    reading = read(Sensor(), Recorder(sampling_rate=77e3), ramp, STEP, start=-2.0, sample_phase=phase)
    assert reading.time[0] == pytest.approx(-2.0 + phase / 77e3, abs=1e-15)
    assert np.allclose(reading.values, 3.0 + 2e6 * (reading.time + 2.0), atol=1e-8)  # round-off of the time
    assert reading.time[-1] <= -2.0 + 1000 * STEP < reading.time[-1] + 1.0 / 77e3


@pytest.mark.parametrize("periods", [0.7, 1.2, 3.0, 10.0])
def test_peak_of_a_half_sine_read_by_a_resonance(periods):
    # undamped: extremes where sin W t = -(sin w t turned), w t + W t = 2 pi n, height sin(W t) / (1 - W/w)
    resonance, duration = 50e3, periods / 50e3
    W, w = math.pi / duration, 2.0 * math.pi * resonance
    times = 2.0 * math.pi * np.arange(1, 50) / (w + W)
    expected = np.max(np.sin(W * times[times < duration])) / (1.0 - W / w)
    steps = 2000
    t = np.arange(steps + 1) * duration / steps
    reading = read(Sensor(resonance=resonance, quality=math.inf), Recorder(), np.sin(W * t), duration / steps)
    # the nearest sample lies within half a step: (w h)^2/8 = 1.2e-4 at ten periods to the pulse
    assert np.max(reading.values) == pytest.approx(expected, rel=2e-4)


def test_resonance_far_above_the_pulse_follows_the_quality_and_the_square_of_the_ratio():
    # slow limit of y'' + (w/Q) y' + w^2 y = w^2 a at the peak of a half-sine: y = a (1 + (W/w)^2)
    duration, resonance = 200e-6, 350e3
    ratio = math.pi / duration / (2.0 * math.pi * resonance)
    t = np.arange(20001) * 1e-8
    got = np.max(output(Sensor(resonance=resonance, quality=0.5), np.sin(math.pi * t / duration), 1e-8))
    # critical damping: magnification 1/(1 + r^2) = 1 - r^2, r = 0.007; transients have died
    assert got == pytest.approx(1.0 - ratio**2, abs=5e-8)


@given(st.floats(0.1, 3.0), st.integers(0, 20))
def test_nothing_read_lies_beyond_the_range(share, seed):
    surface = np.random.default_rng(seed).normal(size=800) * 1e4
    sensor = Sensor(range=share * 1e4, resonance=60e3, quality=20.0)
    reading = read(sensor, Recorder(sampling_rate=1e6, cutoff=2e5, bits=8), surface, STEP)
    assert np.max(np.abs(reading.values)) <= sensor.range
    assert reading.sensor_clipped == (np.max(np.abs(output(sensor, surface, STEP))) > sensor.range)
    assert reading.peak_before_clip == np.max(np.abs(output(sensor, surface, STEP)))


def test_the_peak_that_a_range_cut_is_kept():
    pulse = 9707.0 * G * half_sine(100e-6)
    reading = read(Sensor(range=5000.0 * G), Recorder(), pulse, STEP)
    assert reading.sensor_clipped
    assert not reading.recorder_clipped
    assert np.max(reading.values) == 5000.0 * G
    assert reading.peak_before_clip == pytest.approx(9707.0 * G, rel=1e-12)


def test_a_filter_hides_that_the_sensor_went_beyond_its_range_but_the_reading_tells():
    # ringing at 100 kHz beyond the range, and nothing of it in the record
    t = np.arange(4001) * STEP
    surface = 100.0 * np.sin(2.0 * math.pi * 100e3 * t)
    reading = read(Sensor(range=80.0), Recorder(sampling_rate=100e3, cutoff=10e3), surface, STEP)
    assert np.max(np.abs(reading.values)) < 40.0
    assert reading.sensor_clipped
    assert reading.clipped


@pytest.mark.parametrize(("missing", "count"), [(0.9e-6, 11), (1.1e-6, 10), (0.9, 10), (1.0 + 1.1e-6, 9)])
def test_an_instant_a_millionth_of_an_interval_behind_the_end_counts(missing, count):
    """Ten intervals less a share of one."""
    assert read(Sensor(), Recorder(sampling_rate=1.0), np.zeros(11), 1.0 - 0.1 * missing).time.size == count


def test_what_lasted_for_long_is_not_answered():
    """A ramp that leaves g: undamped, a resonance reads g + t - sin(w t)/w, at 1 per second."""
    sensor, time = Sensor(resonance=0.4, quality=math.inf), 0.1 * np.arange(60)
    found = read(sensor, Recorder(), 9.8 + time, 0.1, steady=True)
    w = 2.0 * math.pi * 0.4
    assert found.values == pytest.approx(9.8 + time - np.sin(w * time) / w, rel=1e-12)
    slow = read(Sensor(), Recorder(cutoff=0.5), 9.8 + time, 0.1, steady=True).values
    assert slow == pytest.approx(9.8 + read(Sensor(), Recorder(cutoff=0.5), time, 0.1).values, rel=1e-12)
    # from rest the first second reads less than it felt
    assert read(sensor, Recorder(), 9.8 + time, 0.1).values[0] == 0.0


def test_recorder_clips_at_its_own_full_scale():
    reading = read(Sensor(range=200.0), Recorder(full_scale=50.0), 100.0 * half_sine(100e-6), STEP)
    assert np.max(reading.values) == 50.0
    assert (reading.sensor_clipped, reading.recorder_clipped) == (False, True)


@given(st.integers(2, 24), st.floats(1.0, 1e6), st.integers(0, 20))
def test_bits_err_by_at_most_half_a_step(bits, full_scale, seed):
    surface = np.random.default_rng(seed).uniform(-1.0, 1.0, 300) * full_scale
    surface[:3] = 0.0, full_scale, -full_scale
    reading = read(Sensor(range=full_scale), Recorder(bits=bits), surface, STEP)
    assert reading.quantum == pytest.approx(2.0 * full_scale / (2**bits - 2), rel=1e-14)
    assert np.max(np.abs(reading.values - surface)) <= 0.5 * reading.quantum * (1 + 1e-9)
    assert tuple(reading.values[:3]) == (0.0, full_scale, -full_scale)
    codes = reading.values / reading.quantum
    assert np.allclose(codes, np.rint(codes), atol=1e-6)
    assert np.unique(np.rint(codes)).size <= 2**bits - 1
    assert not reading.clipped


def test_zero_shift_is_added_before_the_range():
    reading = read(Sensor(range=90.0, zero_shift=-30.0), Recorder(), 100.0 * half_sine(100e-6), STEP)
    assert np.max(reading.values) == pytest.approx(70.0, rel=1e-9)
    assert reading.values[-1] == -30.0
    assert not reading.clipped


def test_anti_alias_filter_is_the_causal_one_at_the_step_of_the_history():
    pulse = half_sine(100e-6)
    reading = read(Sensor(), Recorder(cutoff=20e3, order=4), pulse, STEP)
    assert np.array_equal(reading.values, low_pass(pulse, STEP, 20e3, 4))


def test_presets_are_what_they_say():
    pulse = 5000.0 * G * half_sine(150e-6)
    sensor = accelerometer("Endevco 7270A-20K").mounted()
    slow, fast = read(sensor, storage_recorder(), pulse, STEP), read(sensor, oscilloscope(), pulse, STEP)
    assert slow.time[1] - slow.time[0] == pytest.approx(1e-5)
    assert fast.time[1] - fast.time[0] == pytest.approx(1e-7)
    assert slow.quantum == pytest.approx(2 * 20000 * G / 4094)
    assert fast.quantum == pytest.approx(2 * 20000 * G / 254)
    assert storage_recorder(1e5).full_scale == 1e5
    # four poles: 12 dB... 4 x 12.04 dB lower at four times the cutoff, where 80 kHz folds back to 20 kHz
    t = np.arange(20001) * STEP
    folded = read(Sensor(range=1.0), storage_recorder(), np.sin(2 * math.pi * 80e3 * t), STEP)
    assert np.max(np.abs(folded.values[100:])) <= 10 ** (-48.0 / 20.0) + folded.quantum


@pytest.mark.parametrize("row", accelerometers().values(), ids=lambda row: row.name)
def test_every_accelerometer_is_possible_and_names_its_source(row):
    assert 1e3 * G < row.range < 1e6 * G
    whole = [pytest.approx(round(row.range / unit, -3), rel=1e-5) for unit in (G, 1.0)]  # the makers' units
    assert row.range / G == whole[0] or row.range == whole[1]
    assert 1e4 < row.resonance < 2e6
    assert 0.5 <= row.quality <= 1000
    assert row.kind in ("piezoresistive", "piezoelectric")
    sensor = row.mounted()
    assert (sensor.name, sensor.range, sensor.resonance) == (row.name, row.range, row.resonance)


def test_unknown_accelerometer_names_the_nearest():
    with pytest.raises(InputError, match='did you mean "Endevco 7270A-60K"'):
        accelerometer("endevco 7270-60k")


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Sensor(resonance=0.0), "resonance"),
        (lambda: Sensor(quality=-1.0), "quality"),
        (lambda: Sensor(range=math.nan), "range"),
        (lambda: Sensor(zero_shift=math.inf), "zero shift"),
        (lambda: Recorder(sampling_rate=0.0), "sampling_rate"),
        (lambda: Recorder(cutoff=-1.0), "cutoff"),
        (lambda: Recorder(full_scale=0.0), "full_scale"),
        (lambda: Recorder(bits=1), "bits"),
        (lambda: Recorder(bits=33), "from 2 to 32, got 33"),
        (lambda: Recorder(order=0), "order"),
        (lambda: Recorder(order=13), "from 1 to 12, got 13"),
        (lambda: read(Sensor(), Recorder(bits=8), [1.0], STEP), "full scale"),
        (lambda: read(Sensor(), Recorder(cutoff=5e6), [1.0, 2.0], STEP), "half the sampling rate"),
        (lambda: read(Sensor(), Recorder(), [1.0], STEP, sample_phase=1.0), "phase"),
        (lambda: read(Sensor(), Recorder(sampling_rate=1e5), [1.0, 2.0], STEP, sample_phase=0.5), "first instant"),
        (lambda: read(Sensor(), Recorder(), [1.0, math.nan], STEP), "finite"),
    ],
)
def test_bad_values_are_refused_in_words(make, word):
    with pytest.raises(ValueError, match=word):
        make()


def test_an_accelerometer_from_memory_is_reported_with_what_the_case_does_not_give_itself():
    from strikewave import load_case, run_case
    from strikewave.cases.stack_of_case import sensor_notices

    case = load_case("li-ma-2019-fig5", ["feed.blows=1"])
    sensor = case.sensor[0].model_copy(update={"model": "PCB 350C02", "range": None})

    def with_sensor(**changes):
        return case.model_copy(update={"sensor": (sensor.model_copy(update=changes),)})

    (notice,) = sensor_notices(with_sensor())
    assert notice.severity == "info"
    assert "range of sensor direct (PCB 350C02)" in notice.message  # the case gives the resonance
    (notice,) = sensor_notices(with_sensor(resonance=None))
    assert "range and resonance" in notice.message
    assert not list(sensor_notices(with_sensor(range=case.sensor[0].range)))
    assert not list(sensor_notices(with_sensor(model="Bruel & Kjaer 8309")))  # quoted
    assert "sensor-from-memory" in [notice.code for notice in run_case(with_sensor()).notices]


def test_small_values_and_the_most_bits_and_poles_are_taken():
    assert Recorder(order=1).order == 1
    assert Recorder(1e-3, 1e-3, 12, 32, 1e-3).full_scale == Sensor(resonance=1e-3, quality=1e-3, range=1e-3).range


def test_a_sensor_of_unknown_quality_magnifies_by_about_30_db():
    assert 20.0 * math.log10(Sensor().quality) == pytest.approx(30.0, abs=0.5)
    assert accelerometer("pcb 350c02").quality == Sensor().quality
    assert accelerometer("PCB 350C02") is accelerometer("pcb 350c02")


SOFT = Sensor(mounting=Mounting((), 5e-3, 5e-3 * (2.0 * math.pi * 2e4) ** 2, 300.0), resonance=5e4, quality=3.0)


def test_a_steady_surface_is_read_as_if_it_had_been_so_for_ever():
    """Gravity in a fall: beside the same record after 1 ms of it, in which all that answers has died down to e^-60."""
    surface = -G + np.concatenate([[0.0], 1e3 * half_sine(50e-6, 1500)])
    recorder = Recorder(sampling_rate=1e6, cutoff=1e5)
    got = read(SOFT, recorder, surface, STEP, steady=True)
    long = read(SOFT, recorder, np.concatenate([np.full(10_000, -G), surface]), STEP)
    assert got.values == pytest.approx(long.values[1000:], abs=1e-8)
    assert got.values[0] == pytest.approx(-G, rel=1e-12)
    assert got.peak_before_clip == pytest.approx(np.max(np.abs(output(SOFT, surface + G, STEP) - G)), rel=1e-12)


def test_a_shifted_zero_is_added_before_range_and_filter():
    surface = 100.0 * half_sine(100e-6)
    plain, shifted = (read(Sensor(range=110.0, zero_shift=z), Recorder(), surface, STEP) for z in (0.0, 20.0))
    assert shifted.values == pytest.approx(np.minimum(plain.values + 20.0, 110.0), rel=1e-14)
    assert (shifted.sensor_clipped, plain.sensor_clipped) == (True, False)
    assert shifted.peak_before_clip == pytest.approx(120.0, rel=1e-12)
    low = read(Sensor(range=10.0, zero_shift=-15.0), Recorder(), surface, STEP)
    assert (low.values.min(), low.values.max()) == (-10.0, 10.0)


def test_an_instant_at_the_very_end_counts():
    """Ten intervals of the recorder in ten of the history, which rounding may lay behind its end."""
    for step in (1e-7, 3e-6, 0.7e-5, 1.0 / 3.0):
        got = read(Sensor(), Recorder(sampling_rate=1.0 / step), np.arange(11.0), step)
        assert got.values == pytest.approx(np.arange(11.0), abs=1e-6)
