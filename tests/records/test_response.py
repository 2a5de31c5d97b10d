"""Response channels: closed forms of decaying sines and exponentials."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records.reading import Request, read_file
from strikewave.records.record import Channel, Record
from strikewave.records.response import decaying_modes, effective_span, measure_response, swings

STEP = 5e-6
TIME = STEP * np.arange(6000)


def swing(frequency, damping, amplitude, phase=0.0):
    omega = 2.0 * math.pi * frequency
    decay = omega * damping / math.sqrt(1.0 - damping**2)
    return amplitude * np.exp(-decay * TIME) * np.cos(omega * TIME + phase)


@settings(max_examples=20, deadline=None)
@given(st.floats(300.0, 1500.0), st.floats(1.8, 4.0), st.floats(0.01, 0.06), st.floats(-3.0, 3.0))
def test_a_sum_of_two_decaying_sines_gives_back_frequencies_and_damping(frequency, ratio, damping, phase):
    """A sum of exponentials is a pencil's own model: what is left, below 1 %, is the thinning's filter."""
    values = swing(frequency, damping, 100.0, phase) + swing(ratio * frequency, damping, 70.0)
    modes = sorted(decaying_modes(values, STEP))
    assert [mode.frequency for mode in modes] == pytest.approx([frequency, ratio * frequency], rel=0.01)
    assert [mode.damping for mode in modes] == pytest.approx([damping, damping], rel=0.1)


def test_noise_stays_within_a_few_stated_uncertainties(rng):
    """2 % of white noise: frequency within 1 %, damping within 20 % of itself."""
    values = swing(900.0, 0.03, 100.0) + 2.0 * rng.normal(size=TIME.size)
    mode = decaying_modes(values[:3000], STEP)[0]
    assert mode.frequency == pytest.approx(900.0, rel=0.01)
    assert mode.damping == pytest.approx(0.03, rel=0.2)
    assert mode.frequency_uncertainty < 9.0


@given(st.floats(1.5, 20.0))
def test_effective_duration_of_an_exponential(decays):
    """|x| falls to 10 % at tau ln 10; lines between samples of tau/200 miss that by less than a sample."""
    values = np.r_[np.zeros(50), np.exp(-np.arange(int(200 * 2.5 * decays)) / 200.0)]
    first, last = effective_span(values)
    assert 49.0 < first <= 50.0
    assert last - 50.0 == pytest.approx(200.0 * math.log(10.0), abs=1.0)


def test_a_response_beside_its_base():
    late = np.r_[np.zeros(1000), swing(900.0, 0.03, -300.0)] + 7.0
    found = measure_response(late, STEP, 0.0, (0.004, 0.0045, 1000.0))
    assert (found.peak, found.ratio) == pytest.approx((-300.0, 0.3), rel=1e-6)
    assert found.delay == pytest.approx(1000 * STEP - 0.0045, abs=1e-9)
    assert found.modes[0].amplitude == pytest.approx(300.0, rel=0.02)


def test_a_blow_with_ringing_does_not_swing_about_zero():
    half_sine = np.where(TIME < 4e-3, 100.0 * np.sin(np.pi * TIME / 4e-3), 0.0)
    assert not swings(half_sine)
    assert not swings(half_sine + swing(2000.0, 0.02, 40.0))
    assert swings(swing(900.0, 0.03, 300.0))


def file_of(request):
    half_sine = np.where(abs(TIME - 6.5e-3) < 0.5e-3, 1000.0 * np.cos(np.pi * (TIME - 6.5e-3) / 1e-3), 0.0)
    late = np.roll(swing(900.0, 0.03, -300.0, 1.5), 1300) * (TIME >= 1300 * STEP)
    noise = np.random.default_rng(3).normal(size=(2, TIME.size))
    channels = Channel("frame", half_sine + noise[0], STEP, unit="g"), Channel("board", late + noise[1], STEP, unit="g")
    return read_file(Record("a.csv", "text", channels), {}, request)


def test_the_named_base_makes_the_other_channel_a_response():
    frame, board = file_of(Request(base="frame")).channels
    assert frame.pulses
    assert frame.response is None
    assert not board.pulses
    assert board.status == "good"
    assert board.response.modes[0].frequency == pytest.approx(900.0, rel=0.01)


def test_without_a_base_a_swinging_channel_is_told_and_not_good():
    frame, board = file_of(Request()).channels
    assert "response" not in [finding.code for finding in frame.findings]
    [told] = [finding for finding in board.findings if finding.code == "response"]
    assert "--base 1" in told.message
    assert board.status != "good"
    assert board.figures("peak") == []


def test_a_base_that_the_file_lacks_is_refused():
    with pytest.raises(InputError, match="--base"):
        file_of(Request(base="wall"))
