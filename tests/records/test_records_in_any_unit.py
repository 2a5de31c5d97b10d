"""What is read of a record is the same in any unit, with the other sign, and whenever the record began."""

from dataclasses import astuple

import numpy as np
import pytest

from strikewave.records import Channel, Record, Request, compare, find_pulses, read_file, summed
from strikewave.records.budget import Budget, Contribution
from strikewave.records.measured_uncertainty import blow_uncertainty
from strikewave.records.response import BaseBlow, measure_responses
from strikewave.records.two_sensors import paired_motion

STEP, SIZE = 1e-5, 3000
TIME = STEP * np.arange(SIZE)
NOISE = np.random.default_rng(5).normal(size=SIZE)
SINCE = np.maximum(TIME - 0.01, 0.0)


def half_sine(begin, length, height):
    u = (TIME - begin) / length
    return np.where((u > 0.0) & (u < 1.0), height * np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)


def coupled(values, constant):
    """Return values behind a high-pass of first order."""
    passed = np.zeros(SIZE)
    for k in range(1, SIZE):
        passed[k] = passed[k - 1] * np.exp(-STEP / constant) + values[k] - values[k - 1]
    return passed


ONE = half_sine(0.01, 5e-4, 100.0)
SWING = np.exp(-SINCE / 1e-3) * np.sin(2.0 * np.pi * 6e3 * SINCE)
RECORDS = {
    "plain": ONE + 7.0 + 0.1 * NOISE,
    "noisy": 0.1 * ONE + 1.6 * NOISE,
    "ringing": -ONE - 25.0 * SWING + 0.1 * NOISE,
    "clipped": np.minimum(ONE, 70.0),
    "train": sum(half_sine(4e-3 * k + 2e-3, 3e-4, 100.0) for k in range(6))
    + sum(half_sine(4e-3 * k + 3e-3, 3e-4, 30.0) for k in range(6))
    + 0.1 * NOISE,
    "coupled": coupled(ONE, 4e-3) + 0.05 * NOISE,
    "shifted": ONE + 5.0 * (TIME > 0.0102) + 0.1 * NOISE,
    "drifting": ONE + 30.0 * TIME / TIME[-1] + 0.1 * NOISE,
    "humming": ONE + 8.0 * np.sin(2.0 * np.pi * 50.0 * TIME) + 0.1 * NOISE,
    "empty": 3.0 + 0.1 * NOISE,
    "swinging": 50.0 * np.exp(-TIME / 5e-3) * np.cos(2.0 * np.pi * 900.0 * TIME) + 0.1 * NOISE,
}
CODES = {
    "plain": ["not-settled"],
    "noisy": ["noise", "noisy"],
    "ringing": ["ringing"],
    "clipped": ["clipped", "flat-top"],
    "train": ["rebound"],
    "coupled": ["ac-coupling"],
    "shifted": ["slew-rate", "zero-shift", "velocity-drift", "no-foot"],
    "drifting": ["velocity-drift", "drift", "not-settled"],
    "humming": ["hum", "velocity-drift"],
    "empty": ["no-pulse"],
    "swinging": ["not-settled", "no-pulse"],
}
SMALL = 2.0**-24
"""A power of two scales all numbers without rounding: nothing may differ at all."""


def read(values, start=0.0):
    [channel] = read_file(Record("a", "text", (Channel("c", values, STEP, start, "m/s^2"),)), {}, Request()).channels
    return [f for f in channel.findings if f.code != "polarity"], channel.pulses


def figures(pulse):
    """Return figures in the unit of the record with and without a sign, those in other units, and times."""
    base, rigid = pulse.baseline, pulse.rigid
    scaled = [pulse.peak, pulse.velocity_change, pulse.offset, pulse.rigid_peak, pulse.split_peak]
    scaled += [base.level, base.slope, *(one.peak for one in pulse.rebounds), pulse.smooth.peak]
    sizes = [pulse.noise, base.wander, base.ripple, pulse.uncertainty.peak, pulse.uncertainty.velocity_change]
    other = [
        pulse.rise,
        pulse.width,
        pulse.ringing_frequency,
        pulse.rigid_width,
        pulse.split_width,
        pulse.methods_apart,
    ]
    other += [pulse.uncertainty.width, base.alike, *(pulse.smooth[2:] if rigid is None else rigid[8:10])]
    times = [pulse.time, pulse.begin, pulse.end, *(one.time for one in pulse.rebounds)]
    return [np.array(part) for part in (scaled, sizes, other, times)]


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_in_a_small_unit_is_the_same(name):
    found, pulses = read(RECORDS[name])
    assert [one.code for one in found] == CODES[name]
    small, others = read(SMALL * RECORDS[name])
    for one, other in zip(found, small, strict=True):
        assert (one.code, one.severity, one.harms, one.effects) == (
            other.code, other.severity, other.harms, other.effects,
        )  # fmt: skip
        np.testing.assert_equal((other.start, other.end), (one.start, one.end))
    for pulse, other in zip(pulses, others, strict=True):
        assert (other.method, len(other.rebounds)) == (pulse.method, len(pulse.rebounds))
        for factor, one, of_other in zip((SMALL, SMALL, 1.0, 1.0), figures(pulse), figures(other), strict=True):
            np.testing.assert_array_equal(of_other, factor * one)


@pytest.mark.parametrize("name", ["plain", "noisy", "clipped", "train", "coupled", "shifted", "drifting", "swinging"])
def test_a_record_turned_round_that_began_later_is_the_same(name):
    """Eight seconds later, which costs four digits of a time."""
    found, pulses = read(RECORDS[name])
    turned, others = read(-RECORDS[name], 8.0)
    assert [(one.code, one.severity, one.harms) for one in turned] == [
        (one.code, one.severity, one.harms) for one in found
    ]
    for one, other in zip(found, turned, strict=True):
        np.testing.assert_allclose((other.start, other.end), (one.start + 8.0, one.end + 8.0), atol=1e-9)
    for pulse, other in zip(pulses, others, strict=True):
        scaled, sizes, same, times = zip(figures(pulse), figures(other), strict=True)
        for sign, (one, of_other) in ((-1.0, scaled), (1.0, sizes), (1.0, same)):
            np.testing.assert_allclose(of_other, sign * one, rtol=1e-5, atol=1e-9)
        np.testing.assert_allclose(times[1], times[0] + 8.0, rtol=0.0, atol=1e-9)


ANSWER = 60.0 * np.exp(-SINCE / 3e-3) * np.sin(2.0 * np.pi * 900.0 * SINCE) * (TIME > 0.01) + 0.05 * NOISE[::-1]
ANSWERS = {
    "plain": (ANSWER, []),
    "on a level": (ANSWER + 20.0, ["not-settled"]),
    "shifted": (ANSWER + 4.0 * (TIME > 0.0105), ["zero-shift"]),
    "drifting": (ANSWER + 30.0 * TIME / TIME[-1], ["drift", "noise", "cut", "not-settled"]),
    "humming": (ANSWER + 4.0 * np.sin(2.0 * np.pi * 50.0 * TIME), ["noise", "not-settled"]),
    "clipped": (np.clip(ANSWER, -30.0, 30.0), ["clipped", "clipped", "flat-top", "noise"]),
    "silent": (0.05 * NOISE[::-1], ["no-response"]),
}


@pytest.mark.parametrize("name", ANSWERS)
def test_a_response_in_a_small_unit_is_the_same(name):
    values, codes = ANSWERS[name]

    def answered(scale):
        channels = [Channel(c, scale * v, STEP, 0.0, "m/s^2") for c, v in (("base", ONE + 0.1 * NOISE), ("c", values))]
        return read_file(Record("a", "text", tuple(channels)), {}, Request(base="base")).channels[1]

    one, small = answered(1.0), answered(SMALL)
    assert [f.code for f in one.findings] == codes
    assert [(f.code, f.severity, f.harms) for f in small.findings] == [
        (f.code, f.severity, f.harms) for f in one.findings
    ]
    for found, other in zip(one.responses, small.responses, strict=True):
        for figure in ("peak", "rms", "zero", "base_peak"):
            assert getattr(other, figure) == SMALL * getattr(found, figure)
        for figure in ("time", "delay", "ratio", "begin", "duration", "decay"):
            assert getattr(other, figure) == getattr(found, figure)
        for mode, of_other in zip(found.modes, other.modes, strict=True):
            np.testing.assert_allclose(
                astuple(of_other), np.array(astuple(mode)) * [1.0, 1.0, SMALL, 1.0, 1.0], rtol=1e-9
            )


@pytest.mark.parametrize("factor", [SMALL, 1.0 / SMALL])
@pytest.mark.parametrize("name", ["noisy", "ringing", "train", "shifted"])
def test_a_record_of_a_recorder_so_much_faster_or_slower_is_the_same(name, factor):
    """Steps times a power of two: times and areas are as many times as large, frequencies smaller, all else is the same."""
    found, fast = (find_pulses(RECORDS[name], times * STEP) for times in (1.0, factor))
    for pulse, other in zip(found, fast, strict=True):
        for figure in ("peak", "offset", "noise", "rigid_peak", "split_peak", "baseline"):
            np.testing.assert_equal(getattr(other, figure), getattr(pulse, figure))
        for figure in ("time", "rise", "width", "velocity_change", "begin", "end", "rigid_width", "split_width"):
            np.testing.assert_allclose(getattr(other, figure), factor * getattr(pulse, figure), rtol=1e-9)
        np.testing.assert_allclose(other.ringing_frequency, pulse.ringing_frequency / factor, rtol=1e-9)
        expected = np.array(astuple(pulse.uncertainty)) * [1.0, factor, factor]
        np.testing.assert_allclose(astuple(other.uncertainty), expected, rtol=1e-6)
        np.testing.assert_allclose(other.methods_apart, pulse.methods_apart, rtol=1e-6)
        np.testing.assert_allclose(
            [(one.time, one.peak) for one in other.rebounds],
            [(factor * one.time, one.peak) for one in pulse.rebounds],
            rtol=1e-9,
        )


@pytest.mark.parametrize("factor", [SMALL, 1.0 / SMALL])
def test_a_response_of_a_recorder_so_much_faster_or_slower_is_the_same(factor):
    """A swing that decays in noise, from its own begin; the root mean square is that of its samples."""

    def measured(times):
        step = times * STEP
        [found] = measure_responses(ANSWER, step, 0.0, [BaseBlow(1000 * step, 1025 * step, 1050 * step, 100.0)])
        return found

    one, other = measured(1.0), measured(factor)
    assert (other.peak, other.ratio, other.zero) == (one.peak, one.ratio, one.zero)
    assert other.rms == pytest.approx(one.rms, rel=1e-9)
    for figure in ("time", "delay", "begin", "duration"):
        assert getattr(other, figure) == pytest.approx(factor * getattr(one, figure), rel=1e-9, abs=0.0)
    assert astuple(other.decay) == pytest.approx(factor * np.array(astuple(one.decay)), rel=1e-9, abs=0.0)
    scales = np.array([1.0 / factor, 1.0, 1.0, 1.0 / factor, 1.0])
    assert len(one.modes) == len(other.modes) == 1
    np.testing.assert_allclose(astuple(other.modes[0]), scales * astuple(one.modes[0]), rtol=1e-6)


def test_two_sensors_in_a_small_unit_and_a_faster_recorder_do_the_same():
    """Half of a swing in each against the other, and the second two steps later."""
    first = ONE + 2.0 * SWING + 0.1 * NOISE
    second = np.roll(0.95 * ONE, 2) - 2.0 * SWING + 0.1 * NOISE[::-1]
    one, small, fast, slow = (
        paired_motion(scale * first, scale * second, quick * STEP, find_pulses(scale * first, quick * STEP))
        for scale, quick in ((1.0, 1.0), (SMALL, 1.0), (1.0, SMALL), (1.0, 1.0 / SMALL))
    )
    for other, scale, quick in ((small, SMALL, 1.0), (fast, 1.0, SMALL), (slow, 1.0, 1.0 / SMALL)):
        assert (other.blows, other.one_body, other.leads) == (one.blows, one.one_body, one.leads)
        for figure in ("delay", "delay_uncertainty", "peak_lag"):
            assert getattr(other, figure) == pytest.approx(quick * getattr(one, figure), rel=1e-6, abs=0.0)
        for figure in ("gain", "gain_uncertainty", "explained", "differential_share"):
            assert getattr(other, figure) == pytest.approx(getattr(one, figure), rel=1e-6)
        for figure in ("common_uncertainty", "differential_peak", "differential_in_band"):
            assert getattr(other, figure) == pytest.approx(scale * getattr(one, figure), rel=1e-6, abs=0.0)
        np.testing.assert_allclose(other.transfer.trusted, np.array(one.transfer.trusted) / quick, rtol=1e-9)
        np.testing.assert_allclose(other.transfer.h1, one.transfer.h1, rtol=1e-6)


def budget(quick):
    """Return a budget of all that changes a record, for a recorder so much faster."""
    return Budget((
        Contribution("sensitivity", "s", 0.02), Contribution("linearity", "l", 0.01), Contribution("clock", "c", 0.001),
        Contribution("response", "r", 1.0, tolerances=((10.0 / quick, 0.01), (9e3 / quick, 0.05))),
        Contribution("resonance", "m", 1.0, frequency=2e4 / quick, quality=30.0),
        Contribution("filter", "f", 0.05, frequency=1e4 / quick, order=4.0),
        Contribution("offset", "o", 0.01, "rectangular"), Contribution("drift", "d", 0.02), Contribution("noise", "n", 0.01),
        Contribution("coupling", "a", 1.0, time_constant=0.05 * quick),
    ))  # fmt: skip


@pytest.mark.parametrize("name", ["plain", "train"])
def test_a_budget_of_a_small_unit_and_of_a_faster_recorder_is_the_same(name):
    def found(scale, quick):
        channel = Channel("c", scale * RECORDS[name], quick * STEP, 0.0, "m/s^2")
        pulse = find_pulses(channel.values, channel.step)[0]
        return blow_uncertainty(channel, pulse, budget(quick)).figures

    one = found(1.0, 1.0)
    for scale, quick in ((SMALL, 1.0), (1.0, SMALL), (1.0, 1.0 / SMALL)):
        other = found(scale, quick)
        for figure, factor in (("peak", scale), ("width", quick), ("velocity_change", scale * quick)):
            assert other[figure].standard == pytest.approx(factor * one[figure].standard, rel=1e-6, abs=0.0)
            assert [row.name for row in other[figure].contributions] == [row.name for row in one[figure].contributions]
            assert [row.share for row in other[figure].contributions] == pytest.approx(
                [row.share for row in one[figure].contributions], rel=1e-5, abs=1e-9
            )


def test_a_campaign_in_a_small_unit_is_the_same():
    """Ten files: one at another gain, one turned round, one that is a copy, one with an outlier, one cut short."""
    sizes = [1.0, 1.01, 0.99, 1.015, 0.985, 10.0, -1.005, 1.002, 1.15]
    shots = [size * ONE + 0.1 * np.roll(NOISE, 7 * k) for k, size in enumerate(sizes)]
    shots += [shots[2], shots[1][:2500]]

    def found(scale):
        records = [Record(f"{k}", "text", (Channel("c", scale * v, STEP, 0.0, "m/s^2"),)) for k, v in enumerate(shots)]
        files = compare([read_file(one, {}, Request()) for one in records])
        return [[(f.code, f.severity, f.harms) for f in file.channels[0].findings] for file in files], summed(files)

    (told, one), (same, small) = found(1.0), found(SMALL)
    assert told == same
    assert [[code for code, _, _ in file] for file in told] == [
        [], [], [], [], [], ["gain-differs"], ["polarity", "polarity-differs"], [], ["outlier", "outlier"], ["copy"], ["truncated"],
    ]  # fmt: skip
    assert one.statistics.keys() == small.statistics.keys()
    assert [(a.path, a.figure, a.ratio) for a in one.outliers] == [(a.path, a.figure, a.ratio) for a in small.outliers]
    for figure, factor in (("peak", SMALL), ("velocity_change", SMALL), ("width", 1.0)):
        ours, theirs = one.statistics[figure], small.statistics[figure]
        assert (theirs.n, theirs.cv, theirs.robust_cv) == (
            ours.n,
            pytest.approx(ours.cv),
            pytest.approx(ours.robust_cv),
        )
        assert (theirs.mean, theirs.low, theirs.high) == pytest.approx(
            (factor * ours.mean, factor * ours.low, factor * ours.high), rel=1e-9, abs=0.0
        )
    assert one.statistics["peak"].mean == pytest.approx(100.0, rel=0.01)
