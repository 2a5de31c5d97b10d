"""Checks of a channel that answers, part by part: records and responses made by hand, each bound from both sides."""

import math

import numpy as np
import pytest

from strikewave.records.contacts import MAD_TO_SIGMA, sample_noise
from strikewave.records.health import blows, disturbances, examine, limits, sampled_record, zero
from strikewave.records.health.sampled_record import ResponseRecord
from strikewave.records.health_notice import OF_RESPONSES, RESPONSE_FIGURES, Check, Fault
from strikewave.records.response import FEWEST, BaseBlow, FreeDecay, MeasuredResponse, Mode, measure_responses
from strikewave.records.thresholds import OfNoise

STEP, START = 2.0**-10, 3.0
"""A step of about 1 ms that a double holds, so that places are exact."""


def mode(frequency=20.0, damping=0.02, amplitude=5.0):
    known = {"frequency": frequency, "damping": damping, "amplitude": amplitude}
    return Mode(**known, frequency_uncertainty=0.0, damping_uncertainty=0.0)


def response(**how):
    known = {
        "blow": 1, "peak": 10.0, "time": START + 150 * STEP, "delay": 0.0, "base_peak": 5.0, "ratio": 2.0, "begin": START + 120 * STEP,
        "duration": 80 * STEP, "rms": 4.0, "modes": (mode(),), "zero": 0.0, "decay": FreeDecay(START + 160 * STEP, START + 300 * STEP),
    }  # fmt: skip
    return MeasuredResponse(**{**known, **how})


def blow(place, peak=5.0):
    return BaseBlow(START + place * STEP, START + (place + 5) * STEP, START + (place + 10) * STEP, peak)


def record(values, *responses, places=(100,), base=None):
    return ResponseRecord(
        np.asarray(values, float), STEP, START, "N", [blow(place) for place in places], responses or (response(),), base
    )


FLAT = np.zeros(500)
SHIFTED = (zero.drift_before_response, zero.ac_coupling_of_response, zero.shift_after_response)


# What was measured


def test_what_is_known_of_a_response():
    values = np.r_[np.tile([0.5, -0.5, 0.0], 40)[:100], np.zeros(400)]
    one = record(values, response(peak=-7.0, zero=2.0), response(blow=2, peak=4.0), places=(100, 300))
    assert (one.largest.peak, one.peak, one.first) == (-7.0, 4.0, 100)
    assert one.above[:3].tolist() == [-1.5, -2.5, -2.0]
    assert (one.span(one.responses[0]), one.span(one.responses[1])) == ((100, 300), (300, 500))
    assert one.period == 1.0 / 20.0
    assert one.resolution == 0.5


def test_the_noise_of_a_response_is_that_before_its_blow():
    """Its median magnitude, or a step of the converter over root twelve; where too little lies before, white noise."""
    values = np.r_[np.tile([0.6, -0.6, 0.6, -0.6, 0.1], 20), np.zeros(400)]
    assert record(values).noise == pytest.approx(MAD_TO_SIGMA * 0.6)
    quiet = np.r_[np.zeros(100), np.tile([0.0, 3.0], 200)]
    assert record(quiet).noise == pytest.approx(3.0 / math.sqrt(12.0))
    assert record(values, places=(FEWEST - 1,)).noise == sample_noise(values)
    assert record(values, places=(FEWEST,)).noise != sample_noise(values)
    assert record(np.r_[0.0, 1e-12, 5.0, np.zeros(497)]).resolution == 5.0 - 1e-12
    assert record(FLAT).resolution == 0.0


def test_the_period_without_a_mode_is_that_of_the_crossings():
    """Four crossings in eighty steps: two swings, of forty steps each."""
    values = FLAT - 1.0
    values[130:150] = values[160:190] = 1.0
    assert record(values, response(modes=())).period == pytest.approx(40.0 * STEP)
    assert record(FLAT, response(modes=())).period == pytest.approx(160.0 * STEP)
    assert record(FLAT, response(modes=(), duration=0.0)).period == pytest.approx(2.0 * STEP)


def test_what_other_values_change_of_figures():
    t = STEP * np.arange(600)
    swing = np.r_[np.zeros(100), 10.0 * np.exp(-8.0 * t[:500]) * np.sin(2.0 * np.pi * 20.0 * t[:500])]
    both = [blow(100)]
    one = ResponseRecord(swing, STEP, START, "N", both, measure_responses(swing, STEP, START, both))
    found = one.against(swing / 1.1)
    assert found["peak"] == pytest.approx(0.1)
    assert found["rms"] == pytest.approx(0.1)
    assert (found["duration"], found["delay"]) == (pytest.approx(0.0, abs=1e-12), 0.0)
    assert (found["frequency"], found["damping"]) == (pytest.approx(0.0, abs=1e-6), pytest.approx(0.0, abs=1e-6))
    late = one.against(np.r_[np.zeros(10), swing[:-10]])
    assert late["delay"] == pytest.approx(-10.0 * STEP / one.period, rel=1e-6)


def test_what_a_level_moves_of_figures():
    """A tent from 0 over 10 at 150 to 0 at 200, an effective span above 10 / 3: a level of 1 makes it ten samples longer or
    shorter, four tops within 2 of the peak lie up to ten samples away."""
    values = np.interp(np.arange(500.0), [100.0, 150.0, 200.0], [0.0, 10.0, 0.0])
    third = 2.0 / 3.0 * 100.0
    rms = math.sqrt(float(np.mean(values[117:184] ** 2)))
    one = record(values, response(duration=third * STEP, rms=rms, begin=START + (100.0 + 50.0 / 3.0) * STEP))
    found = one.moved_by(1.0)
    assert found["peak"] == pytest.approx(0.1)
    assert found["duration"] == pytest.approx((176 - 112) / third * 1.0 - 1.0, abs=0.2)
    shorter, longer = values[122:179], values[112:189]
    expected = max(abs(math.sqrt(float(np.mean(part**2))) / rms - 1.0) for part in (shorter, longer))
    assert found["rms"] == pytest.approx(expected, rel=0.02)
    assert found["duration"] == pytest.approx(max(abs(56.0 / third - 1.0), abs(76.0 / third - 1.0)), rel=0.02)
    assert found["delay"] == pytest.approx(9.0 * STEP / one.period)
    assert one.moved_by(0.05)["delay"] == 0.0
    silent = record(values, response(duration=0.0, rms=0.0))
    assert (silent.moved_by(1.0)["duration"], silent.moved_by(1.0)["rms"]) == (0.0, 0.0)
    assert (
        record(values, response(duration=0.0, rms=2.0)).moved_by(1.0)["rms"] == 0.5 * (0.5 / 2.0) ** 2
    )  # white noise adds its square
    assert sampled_record._above(np.array([0.0, 3.0, 1.0, 2.0, 0.0]), 1.0) == (1, 3)
    assert sampled_record._above(np.zeros(3), 1.0) == (0, 0)


def test_a_base_drives_each_mode():
    """A step of the base: the absolute acceleration of a mode without much damping swings about it up to twice."""
    base = np.r_[np.full(100, 2.0), np.full(400, 5.0)]
    one = record(FLAT, response(modes=(mode(8.0, 1e-4),)), base=base)
    columns = one.driven(450)
    assert columns.shape == (450, 2)
    assert columns[:, 0].tolist() == [0.0] * 100 + [3.0] * 350
    assert np.max(columns[:, 1]) == pytest.approx(6.0, rel=2e-2)
    assert np.argmax(columns[:, 1]) == pytest.approx(100 + 0.5 / (8.0 * STEP), abs=1.5)
    assert record(FLAT, response(modes=()), base=base).driven(450) is None
    assert record(FLAT).driven(450) is None
    assert record(FLAT, base=base[:-1]).driven(450) is None


def test_a_mode_is_driven_as_its_equation_of_motion_says():
    """Scipy's solution for a base that is straight between samples: s^2 + 2 z w s + w^2 against 2 z w s + w^2."""
    from scipy.signal import lsim

    base = np.r_[np.zeros(100), np.cumsum(np.random.default_rng(3).normal(size=150))]
    one = record(np.zeros(250), response(modes=(mode(30.0, 0.3), mode(70.0, 0.05))), base=base)
    columns = one.driven(240)
    assert columns[:, 0] == pytest.approx(base[:240])
    for column, (frequency, damping) in zip(columns.T[1:], ((30.0, 0.3), (70.0, 0.05)), strict=True):
        natural = 2.0 * math.pi * frequency / math.sqrt(1.0 - damping**2)
        numerator = [2.0 * damping * natural, natural**2]
        _, expected, _ = lsim((numerator, [1.0, *numerator]), base[:240], STEP * np.arange(240))
        assert column == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_what_only_makes_a_timing_uncertain_is_no_reason():
    for effects, severity, harms in (
        ({"delay": 0.06, "rms": 0.06}, "good", ("delay", "rms")), ({"peak": 0.06}, "suspect", ("peak", "ratio")), ({"peak": 0.04}, "good", ()),
    ):  # fmt: skip
        fault = Fault(3.0, start=7.0, effects=effects)
        [found] = Check("a", "suspect", OF_RESPONSES, lambda one, fault=fault: [fault], "b").notices(record(FLAT))
        assert (found.severity, found.harms, found.start, found.value) == (severity, harms, 7.0, 3.0)


# Sampling, hum and noise


@pytest.mark.parametrize("count", [3.0, 5.0, 6.0, 7.5, 12.0])
def test_the_top_of_a_sine_that_a_parabola_misses(count):
    """Sampled half a step beside its top, the worst place: by the parabola through the higher three where they are round."""
    phase = 2.0 * math.pi / count
    left, middle, right = math.cos(1.5 * phase), math.cos(0.5 * phase), math.cos(0.5 * phase)
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    tip = middle - 0.25 * (left - right) * shift
    round_ = left >= 0.5 * middle or count >= 6.0
    assert limits._missed(count) == pytest.approx(1.0 - (tip if round_ else middle), abs=1e-12)


@pytest.mark.parametrize(
    ("count", "amplitude", "found"), [(7.9, 5.0, True), (8.1, 5.0, False), (7.9, 2.1, True), (7.9, 1.9, False)]
)
def test_a_swing_of_fewer_than_eight_samples_is_told(count, amplitude, found):
    said = examine(
        record(FLAT, response(modes=(mode(1.0 / (count * STEP), amplitude=amplitude), mode(5.0)))),
        limits.few_samples_of_swing,
    )
    assert [(one.code, one.value) for one in said] == [("few-samples", pytest.approx(count))] * found
    if found:
        assert dict(said[0].effects)["peak"] == pytest.approx(-limits._missed(count))
        assert f"a swing of {1.0 / (count * STEP):.4g} Hz has {count:.1f} samples" in said[0].message


def test_a_spectrum_is_sought_about_the_onset(monkeypatch):
    seen = []

    def level(values, noise_):
        seen.append(values.tolist())
        return 0.25 if len(seen) < 3 else None

    monkeypatch.setattr(limits, "folded_level", level)
    values = np.arange(500.0)
    (said,) = examine(record(values), limits.aliased_response)
    assert seen[0] == [float(k) for k in range(300)]  # a window of 200, of its own length before it: only 100 there
    assert (said.value, said.harms) == (0.25, RESPONSE_FIGURES)
    examine(
        record(values, response(decay=FreeDecay(START, START + 100 * STEP)), places=(300,)), limits.aliased_response
    )
    assert seen[1] == [float(k) for k in range(300 - 2 * FEWEST, 300 + 2 * FEWEST)]
    assert examine(record(values), limits.aliased_response) == []


def test_hum_and_noise_are_told_from_a_share_of_the_peak_on(monkeypatch):
    spans = []
    for share, said in ((1.01, True), (0.99, False)):
        monkeypatch.setattr(
            disturbances, "hum_beside", lambda *a, s=share: spans.append(a[3]) or (50.0, s * OfNoise.NOTED_HUM * 10.0)
        )
        assert [one.value for one in examine(record(FLAT), disturbances.hum_of_response)] == [
            pytest.approx(share * OfNoise.NOTED_HUM * 10.0)
        ] * said
        scatter = share * OfNoise.NOTED * 10.0 / 2.0  # k = 2
        values = np.r_[np.tile([scatter, -scatter], 50) / MAD_TO_SIGMA, np.zeros(400)]
        values[150] = 10.0
        assert [
            one.value
            for one in examine(record(values, response(duration=0.0, rms=1e6)), disturbances.noise_of_response)
        ] == [pytest.approx(scatter)] * said
    assert spans[0] == [(START + 100 * STEP, START + 200 * STEP)]
    monkeypatch.setattr(disturbances, "hum_beside", lambda *a: None)
    assert examine(record(FLAT), disturbances.hum_of_response) == []


def test_too_little_before_a_blow_is_told():
    assert examine(record(FLAT, places=(FEWEST,)), disturbances.short_before_response) == []
    (said,) = examine(record(FLAT, places=(FEWEST - 1,)), disturbances.short_before_response)
    assert (said.value, said.severity, said.end) == (FEWEST - 1, "good", START + (FEWEST - 1) * STEP)


# No answer, cut off


@pytest.mark.parametrize(
    ("before", "scatter", "peak", "found"),
    [(5.1, 0.0, 10.0, True), (4.9, 0.0, 10.0, False), (1.0, 1.3, 10.0, True), (1.0, 1.2, 10.0, False)],
)
def test_an_answer_is_twice_what_comes_before_and_eight_times_its_noise(before, scatter, peak, found):
    values = np.r_[np.tile([scatter, -scatter], 50) / MAD_TO_SIGMA, np.zeros(400)]
    values[7], values[400] = before, 1e-3  # so that no converter has large steps
    said = examine(record(values, response(peak=peak)), blows.no_answer)
    assert [(one.code, one.value, one.severity) for one in said] == [("no-response", peak, "bad")] * found


@pytest.mark.parametrize(("highest", "early"), [(4.9, True), (5.1, False)])
def test_a_channel_that_does_more_before_its_blow_comes_early(highest, early):
    values = FLAT.copy()
    values[60] = -10.0

    def words(values, highest, places=(100,)):
        found = examine(record(values, response(peak=highest), places=places), blows.early)
        return found[0].message if found else ""

    said = words(values, highest)
    assert bool(said) is early
    if early:
        assert (
            f"reaches 10 N {1e3 * 45 * STEP:.3g}\xa0ms before the peak of the blow of the base, and 4.9 N after the blow"
            in said
        )
    assert "peak of the first blow" in words(values, highest, places=(100, 300))  # whatever comes after the next one
    assert words(1e-4 * values, 1e-4 * highest, places=(100, 300)) != ""
    assert words(values, 1.0, places=(0,)) == ""
    for scatter, early_ in ((1.3, False), (1.17, True)):  # ten is eight times the second, not the first
        loud = np.tile([scatter, -scatter], 250) / MAD_TO_SIGMA
        loud[60] = -10.0
        assert bool(words(loud, 1.0)) is early_


def test_a_response_is_cut_within_half_a_swing_of_its_end():
    """Half of 51.2 samples and one more; the message says which comes, and of how many."""
    for rest, found in ((26.5, True), (26.7, False)):
        one = response(begin=START + 300 * STEP, duration=(200.0 - rest) * STEP)
        said = examine(record(FLAT, one), blows.cut_response)
        assert [(f.code, f.value, f.harms) for f in said] == [
            ("cut", pytest.approx(one.begin + one.duration), ("duration", "rms"))
        ] * found
    at_end = response(begin=START + 300 * STEP, duration=190 * STEP)
    assert "the record ends before" in examine(record(FLAT, at_end), blows.cut_response)[0].message
    first = response(begin=START + 120 * STEP, duration=170 * STEP)
    (said,) = examine(
        record(FLAT, first, response(blow=2, begin=START + 310 * STEP, duration=20 * STEP), places=(100, 300)),
        blows.cut_response,
    )
    assert "the next blow comes before" in said.message
    assert "(1 of 2 responses)" in said.message


# Range


@pytest.mark.parametrize(("step", "found"), [(0.41, True), (0.39, False)])
def test_steps_of_the_converter_are_told_from_a_twenty_fifth_of_the_peak(step, found):
    values = FLAT.copy()
    values[150:155] = step * np.array([1.0, 3.0, 20.0, 3.0, 1.0])
    said = examine(record(values), limits.coarse)
    assert [(one.code, one.value) for one in said] == [("coarse", pytest.approx(step))] * found


@pytest.mark.parametrize(
    ("near", "far", "found"),
    [(6.1, 0.0, False), (5.9, 0.0, False), (4.4, 0.0, True), (4.6, 0.0, False), (5.9, 6.0, True), (6.1, 6.0, False)],
)
def test_a_spike_stands_off_the_cubic_through_its_neighbours(near, far, found):
    """A top of 10 between two neighbours each: (4 (a + b) - (c + d)) / 6 is more than 4 below it."""
    values = FLAT.copy()
    values[148:153] = far, near, 10.0, near, far
    values[400] = 1e-3  # so that no converter has large steps
    said = examine(record(values), limits.spike)
    assert [(one.code, one.value) for one in said] == [("spike", 10.0)] * found
    assert examine(record(values, response(time=START + 1 * STEP)), limits.spike) == []
    assert examine(record(values, response(time=START + 498 * STEP)), limits.spike) == []


def test_a_rail_on_either_side_is_clipped():
    values = 10.0 * np.sin(2.0 * np.pi * np.arange(500) / 50.0)
    for sign in (1.0, -1.0):
        cut = np.minimum(sign * values, 7.0) * sign
        (said,) = examine(record(cut), limits.clipped_response)
        assert (said.value, said.severity) == (7.0 * sign, "bad")
        at = np.flatnonzero(cut == 7.0 * sign)
        assert (said.start, said.end) == (pytest.approx(START + at[0] * STEP), pytest.approx(START + at[-1] * STEP))
        assert f"for {at.size * STEP * 1e6:.4g} us" in said.message
    assert examine(record(values * np.exp(-np.arange(500) / 300.0)), limits.clipped_response) == []


@pytest.mark.parametrize(("clip", "found"), [(0.98, False), (0.85, True)])
def test_tops_flatter_than_those_of_a_sine_are_told(clip, found):
    """Cut to a share of it: flat for 1 - 2 asin(share) / pi of a half swing beyond what a sine is within 2 %."""
    t = np.arange(500.0)
    swing = np.where(t >= 100, np.sin(2.0 * np.pi * (t - 100) / 50.0), 0.0)
    soft = np.clip(swing, -clip, clip) * 10.0
    said = examine(record(soft, response(peak=10.0 * clip)), limits.saturated)
    assert [one.code for one in said] == ["flat-top"] * found
    assert examine(record(10.0 * swing), limits.saturated) == []


def test_a_slope_that_stays_is_a_slew_rate():
    """A triangle of 48 samples rises at one slope; a sine does not."""
    t = np.arange(500.0)
    triangle = np.where(t >= 100, np.interp((t - 100) % 48.0, [0.0, 12.0, 36.0, 48.0], [0.0, 10.0, -10.0, 0.0]), 0.0)
    sine = np.where(t >= 100, 10.0 * np.sin(2.0 * np.pi * (t - 100) / 48.0), 0.0)
    period = (mode(1.0 / (48.0 * STEP)),)
    assert [one.code for one in examine(record(triangle, response(modes=period)), limits.slew_limited)] == ["slew-rate"]
    assert examine(record(sine, response(modes=period)), limits.slew_limited) == []
    assert (
        examine(record(triangle[:112], response(modes=period)), limits.slew_limited) == []
    )  # four lags of three samples
    assert len(examine(record(triangle[:113], response(modes=period)), limits.slew_limited)) == 1
    assert examine(record(FLAT, response(modes=period)), limits.slew_limited) == []


# Zero


@pytest.mark.parametrize(
    ("level", "severity"), [(0.49, None), (0.51, "good"), (4.9, "good"), (5.1, "suspect"), (-5.1, "suspect")]
)
def test_a_zero_is_told_from_a_twentieth_of_the_peak_on(level, severity):
    said = examine(record(FLAT, response(zero=level)), zero.offset_of_response)
    assert [(one.code, one.value, one.severity) for one in said] == (
        [("not-settled", level, severity)] if severity else []
    )


def test_of_figures_that_jump_the_larger_effect_counts():
    found = zero._larger(
        {"peak": 0.5, "delay": -0.3, "rms": 0.1}, {"peak": 0.9, "delay": 0.2, "duration": 0.4, "rms": -0.2}
    )
    assert found == {"peak": 0.5, "delay": -0.3, "rms": -0.2, "duration": 0.4}


def drifting(slope, behind=1.0, size=500, scatter=1e-3):
    """Before the blow at 100 a straight line with white noise; behind the last decay, at 300, a share of where it leads."""
    values = scatter * np.random.default_rng(4).normal(size=size)
    values[:100] += slope * (np.arange(100) - 49.5)
    values[300:] += behind * slope * (np.arange(300, size) - 49.5)
    return values


def test_a_line_before_a_blow_is_one_of_least_squares():
    values = drifting(2e-3)
    level, slope = zero._line_before(record(values))
    by_hand = np.polyfit(np.arange(100) - 49.5, values[:100], 1)
    assert (slope, level) == (pytest.approx(by_hand[0]), pytest.approx(by_hand[1]))
    for behind, found in ((1.0, True), (0.52, True), (0.48, False), (1.48, True), (1.52, False), (-1.0, False)):
        assert (zero._line_before(record(drifting(2e-3, behind))) is not None) is found
    assert zero._line_before(record(drifting(1e-5))) is None  # noise
    assert zero._line_before(record(drifting(2e-3)[100 - 2 * FEWEST + 1 :], places=(2 * FEWEST - 1,))) is None
    short = drifting(2e-3, 0.0, 300 + 2 * FEWEST - 1)
    assert zero._line_before(record(short)) is not None  # too little behind it to tell
    assert zero._line_before(record(np.r_[short, 0.0])) is None


def test_a_drift_before_a_blow_is_told_from_a_hundredth_of_the_peak_on():
    """Over the length of the record, 499 steps."""
    for share, found in ((1.1, True), (0.9, False)):
        values = drifting(share * 0.01 * 10.0 / 499.0, scatter=1e-5)
        values[150] = 10.0
        both = [blow(100)]
        one = ResponseRecord(values, STEP, START, "N", both, [response(modes=())])
        said = [f for f in examine(one, *SHIFTED) if f.code == "drift"]
        assert [f.value for f in said] == [pytest.approx(share * 0.1, rel=1e-2)] * found


def decaying(level=0.0, decay=0.0, constant=0.1):
    """A swing of 20 Hz from 100 on; the zero behind it."""
    t = STEP * np.arange(900)
    since = np.maximum(t - 100 * STEP, 0.0)
    swing = np.where(t >= 100 * STEP, 10.0 * np.exp(-6.0 * since) * np.sin(2.0 * np.pi * 20.0 * since), 0.0)
    behind = np.where(t >= 100 * STEP, level + decay * np.exp(-since / constant), 0.0)
    return swing + behind + 1e-4 * np.random.default_rng(2).normal(size=900)


def test_the_zero_behind_a_blow_is_found_beside_the_modes():
    def found(values):
        both = [blow(100)]
        one = ResponseRecord(values, STEP, START, "N", both, measure_responses(values, STEP, START, both))
        return one, zero._zero_after(one, one.above)

    one, after = found(decaying(0.5))
    begin, level, decay, constant = after
    assert begin == one.place(one.responses[-1].decay.begin)
    assert level + decay == pytest.approx(0.5, abs=0.02)
    assert constant > 0.3 * one.period
    assert found(decaying())[1] is None or abs(found(decaying())[1][1]) < 0.01
    said = examine(found(decaying(0.5))[0], *SHIFTED)
    assert [f.code for f in said] == ["zero-shift"]
    assert said[0].value == pytest.approx(0.5, abs=0.02)
    assert said[0].start == blow(100).end
    assert [f.code for f in examine(found(decaying(0.05))[0], *SHIFTED)] == []  # a two-hundredth of the peak


def test_a_free_decay_is_thinned_and_has_two_waves_a_mode(monkeypatch):
    monkeypatch.setattr(zero, "MOST_LOOKED_AT", 50)
    values = np.arange(500.0)
    known = mode()
    last = 1.0 / (
        0.02 * 2.0 * math.pi * 20.0 / math.sqrt(1.0 - 0.02**2)
    )  # damped frequency over root(1 - d^2) is the natural one
    assert known.decay_time == pytest.approx(last)
    part = zero._free_decay(record(values, response(modes=(known,))), values)
    assert (part.begin, part.values.tolist()) == (160, values[160:500:6].tolist())
    assert part.since[:2].tolist() == [0.0, 6.0 * STEP]
    assert part.swinging[:, 0] == pytest.approx(np.exp(-part.since / last) * np.cos(2.0 * np.pi * 20.0 * part.since))
    assert part.swinging[:, 1] == pytest.approx(np.exp(-part.since / last) * np.sin(2.0 * np.pi * 20.0 * part.since))
    exact = 3.0 * part.swinging[:, 0] - 2.0 * part.swinging[:, 1] + 0.5 + 0.7 * np.exp(-part.since / 0.1)
    squares, found, rest = part._replace(values=exact).decayed(0.1)
    assert found == pytest.approx([3.0, -2.0, 0.5, 0.7])
    assert (squares, np.max(np.abs(rest))) == (pytest.approx(0.0, abs=1e-18), pytest.approx(0.0, abs=1e-9))
    assert zero._free_decay(record(values[: 160 + 2 * FEWEST], response(modes=())), values).swinging.shape[1] == 0
    assert zero._free_decay(record(values[: 160 + 2 * FEWEST - 1]), values) is None


@pytest.mark.parametrize(
    ("level", "decay", "coupled", "code"),
    [
        (0.0, 0.099, True, None), (0.0, 0.101, True, "ac-coupling"), (0.29, 1.0, True, "ac-coupling"), (0.31, 1.0, True, "zero-shift"),
        (-0.29, 1.0, True, "ac-coupling"), (0.0, 1.0, False, "zero-shift"), (0.5, -1.5, True, "zero-shift"), (0.4, 0.0, True, "zero-shift"),
    ],
)  # fmt: skip
def test_a_zero_that_decays_is_coupled_or_has_shifted(monkeypatch, level, decay, coupled, code):
    """From a hundredth of the peak on; what is taken off grows from the blow at 100 to the decay at 160."""
    seen = []
    monkeypatch.setattr(ResponseRecord, "against", lambda self, values: seen.append(values) or {"peak": -0.01})
    monkeypatch.setattr(zero, "_is_coupled", lambda *args: coupled)
    one = ResponseRecord(FLAT, STEP, START, "N", [blow(100)], [response()])
    monkeypatch.setattr(zero, "_zero_after", lambda one, above: (160, level, decay, 0.05))
    said = examine(one, *SHIFTED)
    assert [f.code for f in said] == ([code] if code else [])
    if code == "ac-coupling":
        assert (said[0].value, said[0].start) == (0.05, blow(100).end)
    elif code:
        start, later = level + decay, level + decay * math.exp(-140.0 * STEP / 0.05)
        assert said[0].value == pytest.approx(start)
        assert seen[0][[100, 130, 160, 300]] == pytest.approx([0.0, -0.5 * start, -start, -later])
        assert dict(said[0].effects)["peak"] == pytest.approx(
            max(abs(level + decay * math.exp(-since * STEP / 0.05)) for since in (0, 339)) / 10.0
        )
        assert ("comes back with a time constant of 50 ms" in said[0].message) is bool(decay)


@pytest.mark.parametrize(("left", "coupled"), [(0.59, True), (-0.59, True), (0.61, False), (-0.61, False)])
def test_what_ac_coupling_leaves_of_a_decay_is_less_than_three_tenths(monkeypatch, left, coupled):
    class Part:
        values = np.zeros(3)

        def beside(self, column):
            return 0.0, np.array([9.0, left]), None

    monkeypatch.setattr(zero, "_free_decay", lambda one, above: Part())
    assert zero._is_coupled(record(FLAT), FLAT, -2.0, 0.1) is coupled
    monkeypatch.setattr(zero, "_free_decay", lambda one, above: None)
    assert zero._is_coupled(record(FLAT), FLAT, -2.0, 0.1) is False


def test_level_decay_and_constant_of_a_zero_come_back():
    known = mode()
    since = STEP * np.arange(340)
    swing = np.exp(since * (-1.0 / known.decay_time + 2j * np.pi * 20.0))
    values = np.r_[np.zeros(160), 3.0 * swing.real - 2.0 * swing.imag + 0.5 + 0.7 * np.exp(-since / 0.06)]
    one = record(values, response(modes=(known,)))
    assert zero._zero_after(one, values) == pytest.approx((160, 0.5, 0.7, 0.06), rel=1e-3)
    level = np.r_[np.zeros(160), 3.0 * swing.real + 0.5]
    begin, at, decay, _ = zero._zero_after(one, level + 1e-6 * np.sin(np.arange(500.0) ** 2))
    assert (begin, at + decay) == (160, pytest.approx(0.5, rel=1e-3))


def test_a_drift_is_carried_to_the_end_of_the_response(monkeypatch):
    """From the middle of what lies before the blow to the end of the effective duration: 150 samples."""
    values = drifting(2e-3)
    reaches = []
    monkeypatch.setattr(ResponseRecord, "against", lambda self, values: {"peak": 0.0})
    monkeypatch.setattr(
        ResponseRecord,
        "moved_by",
        lambda self, reach: reaches.append(reach) or dict.fromkeys(sampled_record.JUMPING, 0.0),
    )
    monkeypatch.setattr(zero, "_zero_after", lambda one, above: None)
    one = ResponseRecord(values, STEP, START, "N", [blow(100)], [response(modes=())])
    assert [f.code for f in examine(one, *SHIFTED)] == ["drift"]
    assert reaches == [pytest.approx(150.0 * abs(zero._line_before(one)[1]))]


@pytest.mark.parametrize(("limit", "found"), [(0.9, True), (0.99, False), (1.0, False)])
def test_tops_lower_than_the_modes_make_them_are_compressed(monkeypatch, limit, found):
    """What stays below six tenths of the peak is as the modes make it; above, a share of that."""
    t = np.arange(400.0)
    template = 10.0 * np.sin(2.0 * np.pi * t / 50.0)
    values = np.r_[np.zeros(100), np.where(np.abs(template) < 6.0, template, limit * template)]
    ends = []
    monkeypatch.setattr(
        ResponseRecord, "driven", lambda self, end: ends.append(end) or np.r_[np.zeros(100), template][:end, None]
    )
    said = examine(record(values, response(peak=10.0 * limit)), limits.compressed)
    assert ends == [301]
    assert [(f.code, f.value, f.harms) for f in said] == (
        [("flat-top", pytest.approx(1.0 - limit, abs=2e-3), RESPONSE_FIGURES)] if found else []
    )
    assert [dict(f.effects)["peak"] for f in said] == [-f.value for f in said]
    monkeypatch.setattr(ResponseRecord, "driven", lambda self, end: None)
    assert examine(record(values), limits.compressed) == []


@pytest.mark.parametrize(("stray", "found"), [(0.0, True), (0.05, True), (0.15, False)])
def test_tops_of_modes_that_are_not_known_are_not_compressed(monkeypatch, stray, found):
    """Six hundredths lower; the modes must miss half as much again of all samples as of the lower ones."""
    t = np.arange(400.0)
    template = 10.0 * np.sin(2.0 * np.pi * t / 50.0)
    values = np.where(np.abs(template) < 6.0, template + stray * (-1.0) ** t, 0.94 * template)
    monkeypatch.setattr(ResponseRecord, "driven", lambda self, end: np.r_[np.zeros(100), template][:end, None])
    assert bool(examine(record(np.r_[np.zeros(100), values], response(peak=9.4)), limits.compressed)) is found


def test_noise_that_only_makes_a_timing_uncertain_is_told(monkeypatch):
    for effects, said in (({"delay": 0.06}, True), ({"duration": 0.04}, False), ({"rms": 0.06}, True)):
        monkeypatch.setattr(
            ResponseRecord,
            "moved_by",
            lambda self, reach, e=effects: dict.fromkeys(("peak", "rms", "delay", "duration"), 0.0) | e,
        )
        assert bool(examine(record(FLAT), disturbances.noise_of_response)) is said


def test_hum_is_sought_beside_what_each_blow_does(monkeypatch):
    """From the begin of its own blow to the end of its effective duration; it is noted from a hundredth of the peak on."""
    spans = []
    heard = {"amplitude": 0.11}

    def beside(values, step, start, blows):
        spans.append((step, start, blows))
        return 50.0, heard["amplitude"]

    monkeypatch.setattr(disturbances, "hum_beside", beside)
    answers = [response(blow=1), response(blow=3, begin=START + 350 * STEP, duration=30 * STEP)]
    one = record(FLAT, *answers, places=(100, 200, 320))
    [found] = examine(one, disturbances.hum_of_response)
    assert (found.code, found.value) == ("hum", 0.11)
    assert spans == [
        (STEP, START, [(START + 100 * STEP, START + 200 * STEP), (START + 320 * STEP, START + 380 * STEP)])
    ]
    heard["amplitude"] = 0.09
    assert examine(one, disturbances.hum_of_response) == []
