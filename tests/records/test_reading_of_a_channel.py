"""Parts of the reading of a channel: filters, holes, what is harmed, and what a whole body does, on blows put in."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import budgeted
from strikewave.records import reading as readings
from strikewave.records.baseline import LocalBaseline
from strikewave.records.calibration import Calibration
from strikewave.records.file_reading import read_file, repeats
from strikewave.records.health.examined import Examined
from strikewave.records.health_notice import FIGURES, HealthNotice
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading, Request
from strikewave.records.record import Channel, Record
from strikewave.records.rigid_pulse import RigidPulse
from strikewave.records.smooth_pulse import SmoothPulse
from strikewave.records.tail import TailModel
from strikewave.signal.coupling import ac_coupled
from strikewave.signal.filters import Filter, HighPass

STEP, START = 1e-3, 2.0


def blow(first, last, peak=4.0, **more):
    begin, end = START + STEP * first, START + STEP * last
    smooth = SmoothPulse(peak, begin, end - begin, 0.5, 1.0)
    one = RecordedPulse(
        *(smooth.time, peak, 0.0, smooth.width(), smooth.area(), math.nan, 0.5, 0.0, smooth, "record", begin, end),
        LocalBaseline(0.0, 0.0, 0.1, 0.0, 40, 10),
    )
    return dataclasses.replace(one, **more)


def rigid(peak):
    return RigidPulse(peak, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 4e3, 0.01, 0.01, "mode", SmoothPulse(1.0, 0.0, 1.0, 0.5, 1.0))


def channel_of(values, **more):
    return Channel("board", np.asarray(values, dtype=float), STEP, START, "m/s^2", **more)


def reading_of(*pulses, findings=(), name="board", number=1):
    channel = dataclasses.replace(channel_of(np.zeros(900)), name=name)
    return ChannelReading(channel, number, pulses, tuple(findings), Calibration())


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


@pytest.mark.parametrize(
    ("option", "cutoff", "allowed"),
    [
        ("filter", 0.51, True),
        ("filter", 0.49, False),
        ("filter", 499.0, True),
        ("filter", 500.0, False),
        ("high_pass", 0.51, True),
        ("high_pass", 0.49, False),
        ("high_pass", 500.0, False),
    ],
)
def test_a_cutoff_lies_between_half_a_period_a_record_and_half_the_rate(option, cutoff, allowed):
    """A record of 1 s between first and last sample, sampled at 1 kHz."""
    channel = channel_of(np.sin(0.3 * np.arange(1001)))
    one = Filter(cutoff) if option == "filter" else HighPass(cutoff)
    request = Request(**{option: one})
    if allowed:
        found = readings.filtered_channel(channel, request)
        assert found.values == pytest.approx(one.apply(channel.values, STEP))
    else:
        with pytest.raises(InputError, match=r"0\.5 Hz for board" if cutoff < 1.0 else "half the sampling rate"):
            readings.filtered_channel(channel, request)


def test_a_high_pass_leaves_a_share_of_a_velocity_change():
    """The least of all blows of the integral from begin to end, over that of each; below a half it is suspect."""
    values = np.zeros(900)
    values[100:151], values[300:351] = 2.0, -1.0
    for changes, left, severity in ((0.2, 0.51, "good"), (0.21, 0.4857, "suspect")):
        blows = [blow(100, 150, velocity_change=0.15), blow(300, 350, -1.0, velocity_change=-0.051 * changes / 0.102)]
        [found] = readings._lightened(HighPass(3.0), blows, channel_of(values))
        assert found.value == pytest.approx(min(0.102 / 0.15, 0.102 / changes), rel=1e-3)
        assert found.value == pytest.approx(left, rel=1e-2)
        assert found.severity == severity
    assert readings._lightened(HighPass(3.0), [], channel_of(values)) == []


@pytest.mark.parametrize(("left", "severity"), [(0.901, None), (0.899, "good"), (0.501, "good"), (0.499, "suspect")])
def test_a_filter_changes_the_peak_that_it_takes_most_off(left, severity):
    found = readings.filter_changes([4.0, -2.0, 0.0], [3.9, -2.0 * left, 0.0])
    assert [(one.severity, one.value) for one in found] == ([(severity, pytest.approx(left))] if severity else [])
    [fewer] = readings.filter_changes([4.0, 2.0, 1.0], [4.0])
    assert (fewer.severity, fewer.value) == ("suspect", -2)
    assert "1 of 3 blows" in fewer.message


def test_times_of_samples_that_are_no_numbers():
    values = np.arange(9.0)
    values[[2, 7]] = np.nan, np.inf
    assert readings.holes_of(channel_of(values)).tolist() == [2.002, 2.007]
    stamps = np.array([0.0, 1.0, 9.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
    assert readings.holes_of(channel_of(values, stamps=stamps)).tolist() == [7.0, 9.0]
    assert readings.holes_of(channel_of(np.zeros(3))).size == 0


@pytest.mark.parametrize(("holes", "count"), [([99, 151], 0), ([100, 130, 150], 3), ([99, 100], 1), ([150, 151], 1)])
def test_a_blow_that_lacks_samples_is_not_measured(holes, count):
    times = START + STEP * np.array(holes) + np.where(np.array(holes) > 125, -1e-9, 1e-9)
    found = readings._in_blows(times, [blow(10, 20), blow(100, 150)])
    assert [(one.value, one.severity, one.harms) for one in found] == ([(count, "bad", FIGURES)] if count else [])
    assert not found or (found[0].start, found[0].end) == (START + 0.1, START + 0.15)


def test_what_rings_of_a_whole_body_is_its_own_motion():
    rings = HealthNotice("ringing", "it rings", 0.3, harms=("peak",), effects=(("peak", 0.2),))
    other = HealthNotice("hum", "hum", 0.1)
    pulses = [
        blow(100, 150, rigid=rigid(3.0)),
        blow(300, 350, ringing_frequency=720.0),
        blow(500, 550, ringing_frequency=9.0),
    ]
    own, findings = readings._as_body_motion(pulses, [rings, other])
    assert all(pulse.rigid is None and pulse.split is None for pulse in own)
    assert (findings[0].severity, findings[0].harms, findings[0].effects) == ("good", (), ())
    assert "rings at 720\xa0Hz" in findings[0].message
    assert findings[1] is other
    slow = readings._as_body_motion(pulses[1:2], [rings])[1][0].message
    assert "720" in slow
    assert "swings after the blow" in readings._as_body_motion(pulses[:1], [rings])[1][0].message
    tiny = [blow(100, 150, ringing_frequency=0.005)]
    assert "rings at 0.005" in readings._as_body_motion(tiny, [rings])[1][0].message


def test_ac_coupling_of_a_stated_time_constant_or_the_one_found_is_taken_off():
    clean = np.zeros(900)
    clean[100:120] = 5.0 * np.sin(np.pi * np.arange(20) / 20.0)
    channel = channel_of(ac_coupled(clean, STEP, 0.15))
    examined = Examined(channel.values, STEP, START, pulses=(blow(100, 120, 5.0, offset=0.0),))
    for model, wanted in ((None, 0.15), (TailModel("ac-coupling", -0.1, math.nan, 0.15, 2e-3), "auto")):
        vars(examined).update(tail=model)
        found, [said] = readings._without_coupling(channel, examined, wanted)
        assert found.values == pytest.approx(clean, abs=1e-9)
        assert (said.value, said.severity) == (0.15, "good")
        assert "of 1.061 Hz (tau = 150" in said.message
        assert ("+- 4 ms" in said.message) is (wanted == "auto")
    for model in (None, TailModel("shift", 0.1)):
        vars(examined).update(tail=model)
        assert readings._without_coupling(channel, examined, "auto") == (channel, [readings.NOT_COUPLED])


def test_figures_of_a_reading_are_those_that_no_finding_harms():
    pulses = blow(100, 150, rigid=rigid(3.0)), blow(300, 350, 5.0), blow(500, 550, 6.0, width=math.nan)
    plain = reading_of(*pulses)
    assert plain.figures("peak") == [4.0, 5.0, 6.0]
    assert plain.figures("width") == [pulses[0].width, pulses[1].width]
    assert plain.figures("rigid_peak") == [4.0 if pulses[0].rigid is None else 3.0, 5.0, 6.0]
    ringing = HealthNotice("ringing", "", 0.1, harms=("peak",))
    rung = reading_of(*pulses, findings=[ringing])
    assert rung.figures("peak") == []
    assert rung.figures("width") == plain.figures("width")
    assert rung.figures("rigid_peak") == [3.0]
    assert reading_of(*pulses, findings=[HealthNotice("hum", "", 0.1, harms=("peak",))]).figures("rigid_peak") == []
    bad = HealthNotice("cut", "", 0.1, severity="bad")
    assert reading_of(*pulses, findings=[bad]).figures("width") == []
    assert plain.figures("interval") == pytest.approx([0.2, 0.2])
    assert plain.baseline == 0.5
    assert reading_of().baseline == 0.0
    assert (plain.status, rung.status, rung.with_finding(bad).status) == ("good", "suspect", "bad")


def test_a_file_tells_why_it_is_not_good_once_and_of_which_channels():
    """The worst first; more than four channels are counted."""
    hum, cut, fine = (
        HealthNotice("hum", "hum"),
        HealthNotice("cut", "cut", severity="bad"),
        HealthNotice("x", "x", severity="good"),
    )
    channels = [reading_of(findings=[hum, fine], name=f"c{k}", number=k) for k in range(1, 7)]
    file = FileReading(
        "a.csv", "text", (*channels, reading_of(findings=[cut], name="last", number=7)), (HealthNotice("file", "torn"),)
    )
    assert file.reasons[0] == "last: cut"
    assert file.reasons[1] == "torn"
    assert file.reasons[2].startswith("c1, c2, c3, c4")
    assert "c5" not in file.reasons[2]
    assert "2" in file.reasons[2].removeprefix("c1, c2, c3, c4")
    assert len(file.reasons) == 3
    assert (file.status, file.numbered(7).channel.name, file.numbered(8)) == ("bad", "last", None)
    assert FileReading("a.csv", "text", tuple(channels[:1])).reasons == ["hum"]


@pytest.mark.parametrize(("size", "short"), [(15, True), (16, False)])
def test_a_record_has_sixteen_samples(size, short):
    values = np.zeros(size)
    values[5] = 1.0
    [found] = read_file(Record("a", "text", (Channel("c", values, STEP),)), {}, Request()).channels
    assert ("too-short" in [one.code for one in found.findings]) is short


@pytest.mark.parametrize("later", [0.0, 40.0])
def test_blows_on_either_side_of_a_step_are_those_above_both_levels(later):
    """Of 100, before and after a shift of 300; and one that the shift comes with."""
    values = np.zeros(4000)
    for begin in (1000, 3000):
        values[begin : begin + 100] += 100.0 * np.sin(np.pi * np.arange(100) / 100.0)
    values[2000:] += 300.0
    channel = Channel("board", values, STEP, later)
    found = readings._blows(channel)
    assert [pulse.peak for pulse in found] == pytest.approx([100.0, 100.0], rel=0.01)
    assert [pulse.time for pulse in found] == pytest.approx([later + 1.05, later + 3.05], abs=2e-3)
    together = np.zeros(4000)
    together[2000:2100] = 1000.0 * np.sin(np.pi * np.arange(100) / 100.0)
    together[2050:] += 300.0
    [one] = readings._blows(Channel("board", together, STEP, later))
    assert one.time == pytest.approx(later + 2.05, abs=0.03)


def test_the_driving_channel_is_one_of_several_that_are_read():
    values = np.zeros(900)
    values[300:400] = np.sin(np.pi * np.arange(100) / 100.0)
    record = Record("a.csv", "text", tuple(Channel(name, values, STEP) for name in ("base", "top", "side")))
    with pytest.raises(InputError, match="add --channel base"):
        read_file(record, {}, Request(channels=("top", "side"), base="base"))
    with pytest.raises(InputError, match="name a channel that responds"):
        read_file(record, {}, Request(channels=("base",), base="base"))
    with pytest.raises(InputError, match="leave it out"):
        read_file(dataclasses.replace(record, channels=record.channels[:1]), {}, Request(base="1"))
    found = read_file(record, {}, Request(channels=("side", "base"), base="base"))
    assert [(one.channel.name, one.number, bool(one.responses)) for one in found.channels] == [
        ("side", 3, True),
        ("base", 1, False),
    ]
    [stated] = read_file(record, {"tpo": {"unit": "g"}}, Request(channels=("top",))).findings
    assert (stated.code, "did you mean" in stated.message) == ("calibration-unused", True)
    tables = {"2": {"unit": "g"}, "top": {"polarity": -1}, "all": {"unit": "m/s^2"}}
    [top] = read_file(record, tables, Request(channels=("top",))).channels
    assert float(np.min(top.channel.values)) == pytest.approx(-9.80665)


def test_repeats_are_called_by_what_their_names_have_in_common():
    channels = [
        reading_of(name=name, number=k) for k, name in enumerate(("run/shot 1", "run/shot 22", "other/shot_3"), 1)
    ]
    found = repeats(FileReading("a.csv", "text", tuple(channels)))
    assert [(one.path, one.channels[0].channel.name, one.channels[0].number) for one in found] == [
        ("a.csv: run/shot 1", "shot", 1),
        ("a.csv: run/shot 22", "shot", 1),
        ("a.csv: other/shot_3", "shot", 1),
    ]
    mixed = repeats(FileReading("a.csv", "text", (channels[0], reading_of(name="left"))))
    assert {one.channels[0].channel.name for one in mixed} == {"repeats"}


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
            budgeted.check_amounts(budget, channel)
        else:
            with pytest.raises(InputError, match="cell, N"):
                budgeted.check_amounts(budget, channel)


def test_of_each_channel_the_largest_blow_is_tried_by_draws(monkeypatch):
    """Over all files; the others are taken to scatter alike."""

    def state(channel, pulse, budget, trials=False):
        return (
            SimpleNamespace(alike=lambda other: (pulse.peak, other.peak), peak=pulse.peak)
            if not trials
            else SimpleNamespace(peak=pulse.peak, tried=True)
        )

    monkeypatch.setattr(budgeted, "blow_uncertainty", state)
    files = [
        FileReading(
            "a", "text", (reading_of(blow(1, 2, 3.0), blow(3, 4, -5.0)), reading_of(blow(1, 2, 1.0), number=2))
        ),
        FileReading(
            "b", "text", (reading_of(blow(1, 2, 4.0)), reading_of(blow(1, 2, -2.0), blow(3, 4, 1.5), number=2))
        ),
        FileReading("c", "text", (reading_of(),)),
    ]
    found = budgeted.with_budget(files, SimpleNamespace(contributions=[]))
    tried = [[[getattr(one, "tried", one) for one in each.uncertainties] for each in file.channels] for file in found]
    assert tried == [[[(3.0, -5.0), True], [(1.0, -2.0)]], [[(4.0, -5.0)], [True, (1.5, -2.0)]], [[]]]
