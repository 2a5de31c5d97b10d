"""Sensors where they sit: what a reading is read for, by hand, and what is told of it."""

import math

import numpy as np
import pytest

from strikewave.sensors import Gasket, Mounting, Reading, Recorder, Sensor
from strikewave.sensors.trial import (
    SensorChannel,
    SensorPulse,
    channel_notices,
    sensor_pulse,
    sensor_sources,
    settling_time,
    shortest_period,
    still_on,
)
from strikewave.signal.filters import low_pass

BUFFER = Mounting((Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3),), 5e-3)


def channel(sensor=None, recorder=None):
    return SensorChannel(sensor or Sensor(), None, recorder or Recorder())


def reading(values, step=0.5, clipped=False):
    values = np.array(values, dtype=float)
    return Reading(step * np.arange(values.size), values, False, clipped, 0.0, 0.0)


def test_the_shortest_period_is_that_of_the_highest_resonance_or_of_200_khz_through_a_buffer():
    slow, fast, buffered = (channel(s) for s in (Sensor(resonance=1e4), Sensor(resonance=4e5), Sensor(mounting=BUFFER)))
    assert shortest_period([slow, channel(), fast]) == pytest.approx(2.5e-6, rel=1e-15)
    assert shortest_period([slow, buffered]) == pytest.approx(5e-6, rel=1e-15)
    assert shortest_period([fast, buffered]) == pytest.approx(2.5e-6, rel=1e-15)
    assert shortest_period([channel()]) == shortest_period([]) == math.inf


def test_the_filter_of_a_recorder_has_answered_a_blow_when_it_has_settled():
    """To a step of four poles: within a hundredth of it from then on, and not yet at half that time.

    Of its largest answer to an impulse 1.33 % are left, to the digits printed.
    """
    step, cutoff = 1e-7, 20e3
    answer = np.abs(1.0 - low_pass(np.ones(4000), step, cutoff, 4))
    kick = np.abs(np.diff(answer))
    settled = settling_time(channel(recorder=Recorder(cutoff=cutoff)))
    assert settled == pytest.approx(2.0 / cutoff, rel=1e-15)
    place = round(settled / step)
    assert answer[place:].max() < 0.01 < answer[place // 2 :].max()
    assert kick[place:].max() / kick.max() == pytest.approx(0.0133, abs=5e-5)


PULSE = [0.0, 40.0, 100.0, 40.0, *[30.0] * 92, 30.0, 30.0, 15.0, -15.0]
"""A hundred samples, of which the last two, 2 %, ring about zero."""


@pytest.mark.parametrize(
    ("values", "at_rest", "on"),
    [
        (PULSE, 0.0, False),
        ([*PULSE[:-2], 30.0, 30.0], 0.0, True),
        ([*PULSE[:-2], 30.0, 30.0], 29.0, False),  # at rest it reads that
        ([0.0, 100.0, 50.0, 5.0], 0.0, False),  # few samples: the last one
        ([0.0, 100.0, 50.0, 9.9], 0.0, False),
        ([0.0, 100.0, 50.0, 10.1], 0.0, True),
        ([0.0, -100.0, -9.9], 0.0, False),
        ([0.0, -100.0, -20.0], 0.0, True),
        ([0.0, -100.0, -20.0], -19.0, False),
        ([50.0, 0.0, 100.0, 50.0], 0.0, False),  # as it began
        ([0.05, 0.1, 0.0101], 5.0, True),
        ([0.0, 100.0, 50.0], -50.0, True),
        ([], 0.0, False),
    ],
)
def test_a_reading_is_still_on_where_it_ends_a_tenth_of_its_peak_from_every_level(values, at_rest, on):
    assert still_on(reading(values), at_rest) is on


def test_sources_are_those_of_the_models_that_take_part():
    plain = channel(Sensor("plain"))
    assert sensor_sources([]) == sensor_sources([plain, plain]) == []
    assert sensor_sources([plain, channel(Sensor(resonance=1e5))]) == ["smallwood-1981", "van-loan-1978"]
    assert sensor_sources([plain, channel(Sensor(mounting=BUFFER))])[2:] == ["patera-1984", "emmerich-korn-1987"]


@pytest.mark.parametrize(
    ("values", "peak", "width"),
    [
        ([0.0, 100.0, 0.0], 100.0, 0.9),  # 0.9 of a step to either side
        ([0.0, 0.0, 2e-3, 0.0], 2e-3, 0.9),
        ([0.0, 100.0, 0.0, -300.0], -300.0, 0.9),
        ([-1.0, -2.0, -1.0], -2.0, math.nan),
        ([1.0, 3.0], 3.0, math.nan),
        ([7.0], 7.0, math.nan),
        ([], math.nan, math.nan),
    ],
)
def test_a_reading_has_its_largest_value_and_its_width_at_a_tenth(values, peak, width):
    found = sensor_pulse(reading(values))
    assert (found.peak, found.width) == pytest.approx((peak, width), rel=1e-14, nan_ok=True)
    assert not found.clipped
    assert sensor_pulse(reading([0.0, 1.0, 0.0], clipped=True)).clipped
    later = sensor_pulse(reading(values)._replace(time=7.0 + reading(values).time))
    assert (later.peak, later.width) == pytest.approx((peak, width), rel=1e-12, nan_ok=True)


def test_notices_tell_what_clips_what_is_missed_and_what_is_heavy():
    one, two = SensorPulse(5.0, 1.0, True), SensorPulse(math.nan, math.nan, False)
    cut = channel(Sensor("cut", range=8.0), Recorder(sampling_rate=2e3))
    free = channel(Sensor("free", mounting=Mounting((), 0.021, 1e6)))
    light = channel(Sensor("light", mounting=Mounting((), 0.019, 1e6)))
    calm = SensorPulse(5.0, 1.0, False)
    pulses = [
        {"cut": one, "free": calm, "light": calm},
        {"cut": two, "free": one, "light": calm},
        {"cut": two, "free": calm, "light": calm},
    ]
    found = channel_notices([cut, free, light], pulses, 1.0)
    told = [(notice.code, notice.value, notice.limit) for notice in found]
    assert told == [
        ("sensor-clipped", 1.0, 8.0),
        ("recorder-slow", 2e3, 0.0),
        ("sensor-clipped", 1.0, 0.0),  # by its recorder: it has no range
        ("heavy-sensor", 0.021, 0.02),
    ]
    assert "clips in 1 of 3 pulses" in found[0].message
    assert "no sample in 2 of 3 pulses" in found[1].message
    assert channel_notices([light], [{"light": calm}], 2.0) == ()
