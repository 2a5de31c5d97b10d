"""A channel of a record: its times, its name, the coupling that is taken off it, and the budget of its blows."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import reading
from strikewave.records import reading as readings
from strikewave.records.baseline import LocalBaseline
from strikewave.records.calibration import ChannelCalibration
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.reading import ChannelReading, FileReading, Request, read_file
from strikewave.records.record import Channel, Record
from strikewave.records.tail import TailModel
from strikewave.signal.filters import ac_coupled

STEP, START = 1e-3, 2.0


def blow(first, last, peak=4.0, **more):
    begin, end = START + STEP * first, START + STEP * last
    smooth = SmoothPulse(peak, begin, end - begin, 0.5, 1.0)
    one = RecordedPulse(
        *(smooth.time, peak, 0.0, smooth.width(), smooth.area(), math.nan, 0.5, 0.0, smooth, "record", begin, end),
        LocalBaseline(0.0, 0.0, 0.1, 0.0, 40, 10),
    )
    return dataclasses.replace(one, **more)


def channel_of(values, **more):
    return Channel("board", np.asarray(values, dtype=float), STEP, START, "m/s^2", **more)


def reading_of(*pulses, findings=(), name="board", number=1):
    channel = dataclasses.replace(channel_of(np.zeros(900)), name=name)
    return ChannelReading(channel, number, pulses, tuple(findings), ChannelCalibration())


def test_times_of_a_channel():
    channel = channel_of(np.zeros(5))
    assert channel.time.tolist() == [2.0, 2.001, 2.002, 2.003, 2.004]
    assert (channel.duration, channel.sampling_rate) == (pytest.approx(4e-3), pytest.approx(1000.0))


def test_a_channel_that_is_not_there_is_refused_with_those_there_are():
    names = ["board", "frame", *(f"more {k}" for k in range(3, 50))]
    record = Record("a.csv", "text", tuple(Channel(name, np.zeros(2)) for name in names))
    with pytest.raises(InputError, match="did you mean") as refused:
        record.channel("bord")
    assert "more 40" not in str(refused.value)
    with pytest.raises(InputError, match="1 board, 2 frame") as refused:
        record.channel("77")
    assert "40 more 40" in str(refused.value)
    assert "41 more 41" not in str(refused.value)
    assert "from 1 to 49" in str(refused.value)
    assert record.keys["2"] == record.keys["frame"] == 1
    twice = Record("a.csv", "text", (Channel("x", np.zeros(2), unit="g"), Channel("x", np.ones(2), unit="g")))
    assert twice.keys == {"1": 0, "2": 1, "x": 0, "x [g]": 0, "x (g)": 0}
    assert [one.name for one in record.only([2, "board"]).channels] == ["frame", "board"]
    assert record.only([]) is record


def test_ac_coupling_of_a_stated_time_constant_or_the_one_found_is_taken_off():
    clean = np.zeros(900)
    clean[100:120] = 5.0 * np.sin(np.pi * np.arange(20) / 20.0)
    channel = channel_of(ac_coupled(clean, STEP, 0.15))
    examined = BlowRecord(channel.values, STEP, START, pulses=(blow(100, 120, 5.0, offset=0.0),))
    for model, wanted in ((None, 0.15), (TailModel("ac-coupling", -0.1, math.nan, 0.15, 2e-3), "auto")):
        vars(examined).update(tail=model)
        found, said = readings._without_coupling(channel, examined, wanted)
        assert found.values == pytest.approx(clean, abs=1e-9)
        assert (said.value, said.severity) == (0.15, "good")
        assert "of 1.061\xa0Hz (tau = 150" in said.message
        assert ("+- 4\xa0ms" in said.message) is (wanted == "auto")
    for model in (None, TailModel("shift", 0.1)):
        vars(examined).update(tail=model)
        assert readings._without_coupling(channel, examined, "auto") == (channel, readings.NOT_COUPLED)


@pytest.mark.parametrize(("size", "short"), [(15, True), (16, False)])
def test_a_record_has_sixteen_samples(size, short):
    values = np.zeros(size)
    values[5] = 1.0
    [found] = read_file(Record("a", "text", (Channel("c", values, STEP),)), {}, Request()).channels
    assert ("too-short" in [one.code for one in found.findings]) is short


def test_a_budget_that_states_an_acceleration_is_for_accelerations():
    """Shares of the peak are for any channel."""
    share, amount = SimpleNamespace(name="gain", relative=True), SimpleNamespace(name="zero", relative=False)
    force = dataclasses.replace(reading_of(), channel=Channel("cell", np.zeros(3), STEP, unit="N"))
    for contributions, channel, allowed in (
        ([share], force, True),
        ([share, amount], force, False),
        ([share, amount], reading_of(), True),
    ):
        budget = SimpleNamespace(contributions=contributions)
        if allowed:
            reading.check_amounts(budget, channel)
        else:
            with pytest.raises(InputError, match="cell, N"):
                reading.check_amounts(budget, channel)


def test_of_each_channel_the_largest_blow_is_tried_by_draws(monkeypatch):
    """Over all files; the others are taken to scatter alike."""

    def state(channel, pulse, budget, trials=False):
        return (
            SimpleNamespace(alike=lambda other: (pulse.peak, other.peak), peak=pulse.peak)
            if not trials
            else SimpleNamespace(peak=pulse.peak, tried=True)
        )

    monkeypatch.setattr(reading, "blow_uncertainty", state)
    files = [
        FileReading(
            "a", "text", (reading_of(blow(1, 2, 3.0), blow(3, 4, -5.0)), reading_of(blow(1, 2, 1.0), number=2))
        ),
        FileReading(
            "b", "text", (reading_of(blow(1, 2, 4.0)), reading_of(blow(1, 2, -2.0), blow(3, 4, 1.5), number=2))
        ),
        FileReading("c", "text", (reading_of(),)),
    ]
    found = reading.with_budget(files, SimpleNamespace(contributions=[]))
    tried = [[[getattr(one, "tried", one) for one in each.uncertainties] for each in file.channels] for file in found]
    assert tried == [[[(3.0, -5.0), True], [(1.0, -2.0)]], [[(4.0, -5.0)], [True, (1.5, -2.0)]], [[]]]


def test_blows_of_a_zero_that_steps_stand_above_both_of_its_levels():
    """A half-sine of 100 from 1000 to 1050, in noise: the zero steps by 40 long after it, before it, or in its fall."""
    place = np.arange(3000.0)
    values = 100.0 * np.sin(np.pi * np.clip((place - 1000.0) / 50.0, 0.0, 1.0))
    values += 0.1 * np.random.default_rng(5).normal(size=3000)
    for at, offset in ((2000, 0.0), (600, 40.0), (1040, 0.0)):
        [pulse] = readings._blows(channel_of(values + 40.0 * (place >= at)))
        assert pulse.peak == pytest.approx(100.0, abs=0.5)
        assert pulse.time == pytest.approx(START + 1.025, abs=2e-3)
        if at != 600:
            assert pulse.offset == pytest.approx(offset, abs=0.1)
        if at != 1040:
            assert pulse.width == pytest.approx(0.0468, abs=5e-4)
