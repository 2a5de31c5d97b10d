"""Parts of the checks of health, on small examples worked by hand, each bound from both sides."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.records.baseline import LocalBaseline
from strikewave.records.correlation import alike_as_one
from strikewave.records.health import blows as blow_checks
from strikewave.records.health import examined, noise, sampling, train, zero
from strikewave.records.health.examined import Examined, SampledRecord
from strikewave.records.health.range import clipping, limits, shape
from strikewave.records.health.range.shape import BlowShape
from strikewave.records.health.response import range as response_range
from strikewave.records.health.response import zero as response_zero
from strikewave.records.health.ringing import _doubt_of_smooth, _swing_after, goes_back, larger_elsewhere
from strikewave.records.measuring import Rebound, RecordedPulse
from strikewave.records.smooth_pulse import PulseUncertainty, SmoothPulse

STEP, START = 1e-3, 2.0


def blow(first, last, peak=4.0, top=None, **more):
    """Return a half-sine between two samples, as it is measured."""
    begin, end = START + STEP * first, START + STEP * last
    smooth = SmoothPulse(peak, begin, end - begin, 0.5, 1.0)
    time = smooth.time if top is None else START + STEP * top
    one = RecordedPulse(
        *(time, peak, 0.0, smooth.width(), smooth.area(), math.nan, 0.0, 0.0, smooth, "record", begin, end),
        LocalBaseline(0.0, 0.0, 0.1, 0.0, 40, 10),
        step=STEP,
    )
    return dataclasses.replace(one, **more)


def record(values, *pulses, **more):
    return Examined(np.asarray(values, dtype=float), STEP, START, "m", tuple(pulses), **more)


def test_effects_of_a_level_under_a_half_sine():
    """A level of a tenth of the peak over a width of 0.936 T: 2 T / (pi sqrt(1 - 0.01)) of the width a peak of level,
    T level of the area 2 T peak / pi; from the peak on, half of both."""
    one = blow(100, 200)
    slope = 2.0 / (math.pi * math.sqrt(0.99)) / (1.0 - 2.0 * math.asin(0.1) / math.pi)
    found = examined.effects_of_level(one, 0.4)
    assert found["peak"] == pytest.approx(0.1)
    assert found["width"] == pytest.approx(0.1 * slope, rel=1e-4)
    assert found["velocity_change"] == pytest.approx(0.1 * math.pi / 2.0)
    after = examined.effects_of_level(one, 0.4, after_peak=True)
    assert (after["peak"], after["width"]) == (found["peak"], 0.5 * found["width"])
    assert after["velocity_change"] == 0.5 * found["velocity_change"]
    assert examined.effects_of_level(dataclasses.replace(one, width=math.nan), 0.4).keys() == {
        "peak",
        "velocity_change",
    }


def test_places_and_times_of_a_record_are_each_others_inverse():
    sampled = SampledRecord(np.zeros(50), STEP, START)
    assert [sampled.place(sampled.time(k)) for k in (0, 7, 49)] == [0, 7, 49]
    assert (sampled.place(0.0), sampled.place(9.0)) == (0, 49)


def test_the_next_blow_is_the_first_that_ends_later():
    first, second, third = blow(10, 20), blow(30, 40), blow(50, 60)
    seen = record(np.zeros(90), third, first, second)
    assert [seen.next_begin(one) for one in (first, second, third)] == [second.begin, third.begin, math.inf]


# clipping


def test_the_longest_run():
    assert clipping._longest_run(np.array([1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1], dtype=bool)) == (5, 7)
    assert clipping._longest_run(np.array([1, 1, 0], dtype=bool)) == (0, 1)
    assert clipping._longest_run(np.zeros(3, dtype=bool)) == (0, -1)


@pytest.mark.parametrize("middle", [10.0, 10.5])
def test_a_parabola_goes_on_above_where_it_was_cut(middle):
    values = 10.0 - 0.1 * (np.arange(21) - middle) ** 2
    assert clipping._cut_off(np.minimum(values, 9.5), 9.5) == pytest.approx(0.5)
    assert clipping._cut_off(np.minimum(values, 8.4), 8.4) == math.inf  # of more than six samples
    assert clipping._cut_off(np.minimum(values, 9.5)[:16], 9.5) == pytest.approx(0.5)
    assert clipping._cut_off(np.minimum(values, 9.5)[:15], 9.5) == math.inf


@pytest.mark.parametrize(
    ("at", "beside", "zero", "found"),
    [(9, 3, 0.0, 9), (9, 4, 0.0, 0), (8, 3, 0.0, 0), (9, 3, 96.9, 9), (9, 3, 97.0, 0), (3, 0, 0.0, 3), (2, 0, 0.0, 0)],
)
def test_a_rail_has_three_times_as_many_samples_as_the_two_steps_beside_it(at, beside, zero, found):
    """Steps of 1 up to 100: 99 and 98 lie beside it, 97 and 95 do not."""
    values = np.r_[
        np.zeros(9), 50.0, [97.0] * 7, 95.0, [99.0] * (beside // 2), [100.0] * at, [98.0] * (beside - beside // 2)
    ]
    if not beside:
        values = np.r_[np.zeros(9), 50.0, 97.0, 96.0, [100.0] * at, np.zeros(2)]
    assert clipping.rail(values, zero).size == found


# the shape of blows


def test_the_last_sample_below_a_level():
    heights = np.array([0.0, 0.1, 0.3, 0.2, 0.6, 1.0])
    assert shape._last_below(heights, np.array([0.05, 0.15, 0.25, 0.5, 0.7, 2.0])).tolist() == [0, 1, 3, 3, 4, 5]
    assert shape._last_below(heights + 1.0, np.array([0.5])).tolist() == [0]
    assert shape._to_both_sides(np.array([-2.0, 3.0])) == 2.0
    assert shape._to_both_sides(np.array([1.0, 3.0])) == -1.0


def half_sine(power=1.0, most=math.inf):
    u = np.clip((np.arange(900) - 300.0) / 200.0, 0.0, 1.0)
    return np.minimum(4.0 * np.sin(np.pi * u) ** power, most)


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0, 3.0])
def test_the_tip_of_a_power_of_a_sine(power):
    """Widths of tip and upper half in closed form; the power is told from the flanks."""
    seen = BlowShape(record(half_sine(power)), blow(300, 500))
    widths = [math.acos(share ** (1.0 / power)) for share in (0.9, 0.5)]
    assert seen.tip == pytest.approx(widths[0] / widths[1], abs=0.002)  # a polynomial follows it to 0.1 %
    assert seen.usual_tip == pytest.approx(widths[0] / widths[1], abs=0.002)
    assert seen.half_sine_of_flanks == pytest.approx(1.0 if power == 1.0 else seen.half_sine_of_flanks, abs=0.02)


@pytest.mark.parametrize("most", [3.2, 2.4])
def test_the_half_sine_of_the_flanks_of_a_clipped_one(most):
    seen = BlowShape(record(half_sine(1.0, most)), blow(300, 500, most))
    assert seen.half_sine_of_flanks == pytest.approx(4.0 / most, rel=0.03)  # widths of samples, 1 % each


def tent(rise, fall):
    return np.interp(np.arange(900.0), [300.0, 300.0 + rise, 300.0 + rise + fall], [0.0, 4.0, 0.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sides_of_a_tent(sign):
    """Slopes are those of the sides, to all digits: neither bends, and both go on to the peak."""
    seen = BlowShape(record(sign * tent(100, 50)), blow(300, 450, sign * 4.0, 400))
    for flank, halfway, slope in zip(seen.flanks, (-1, 1), (4.0 / (100 * STEP), 4.0 / (50 * STEP)), strict=True):
        assert flank.slope == pytest.approx(slope)
        assert flank.bend == pytest.approx(0.0, abs=1e-12)
        assert flank.goes_on == pytest.approx(1.0)
        assert seen.slope_halfway(halfway) == pytest.approx(slope)
    assert seen.side(1)[[0, -1]].tolist() == [0.0, 1.0]


def test_a_limit_bends_a_straight_side_before_its_tip():
    """Cut at 0.8 of the tip, with the time of the peak where it was: the side goes on to 1.25 of what is left."""
    seen = BlowShape(record(np.minimum(tent(100, 50), 3.2)), blow(300, 450, 3.2, 400))
    assert seen.flanks[0].goes_on == pytest.approx(1.25, rel=1e-6)
    assert limits._bent_off(seen) == pytest.approx(0.25, rel=1e-6)
    assert limits._bent_off(BlowShape(record(half_sine()), blow(300, 500))) == 0.0
    assert limits._bent_off(BlowShape(record(tent(100, 50)), blow(300, 450, 4.0, 400))) == 0.0


def test_what_swings_after_a_blow_to_both_sides():
    values = half_sine()
    values[520] = -0.5
    values[560] = 0.3
    one = blow(300, 500)
    assert BlowShape(record(values), one).swing_to_both_sides == pytest.approx(0.3 / 4.0)
    assert BlowShape(record(values), dataclasses.replace(one, noise=0.05)).swing_to_both_sides == pytest.approx(
        0.1 / 4.0
    )
    values[560] = 0.0
    values[500 + round(2.0 * one.width / STEP) + 2] = 0.9
    assert BlowShape(record(values), one).swing_to_both_sides == pytest.approx(0.0, abs=1e-12)


def test_noise_of_a_top_is_white_or_that_of_a_fifth_of_the_width():
    """Seven coefficients over the samples of the width, or the ripple if it is more."""
    one = blow(300, 500, noise=0.2)
    white = 0.2 * math.sqrt(7.0 / (one.width / STEP)) / 4.0
    assert BlowShape(record(half_sine()), one).noise_of_top == pytest.approx(white)
    rippled = dataclasses.replace(one, baseline=one.baseline._replace(ripple=0.4))
    assert BlowShape(record(half_sine()), rippled).noise_of_top == pytest.approx(0.1)


def test_tops_are_judged_together():
    shapes = [BlowShape(record(half_sine(power)), blow(300, 500, noise=0.2)) for power in (1.0, 2.0)]
    top = limits.top_of(shapes)
    assert top.sharpness == pytest.approx(np.mean([one.tip for one in shapes]))
    assert top.usual == pytest.approx(np.mean([one.usual_tip for one in shapes]))
    assert top.doubt == pytest.approx(1.8 * 3.0 * shapes[0].noise_of_top / math.sqrt(2.0))
    assert limits.top_of([]) is None


# ringing and sampling


def test_a_record_goes_back_by_its_deepest_fall():
    """Beyond six standard deviations of noise: by 0.96 on the way up, and 0.42, 0.34 and so on to 0.1 on the way down."""

    def of(values):
        seen = record(values)
        vars(seen).update(scatter=0.01)
        return goes_back(seen, blow(300, 450, 4.0, 400))

    values = tent(100, 50)
    values[380] -= 1.0
    values[430] += 0.5
    assert of(values) == (pytest.approx(0.90 / 4.0), pytest.approx(STEP * (0.96 + 1.3)))
    assert of(tent(100, 50)) == (0.0, 0.0)
    early = tent(100, 50)
    early[290] = 0.7  # within a quarter of a width before the foot
    assert of(early)[0] == pytest.approx(0.64 / 4.0)
    early[[290, 260]] = 0.0, 0.7
    assert of(early)[0] == 0.0


def test_the_doubt_of_a_smooth_pulse_is_the_swing_that_it_misses():
    """A swing of 0.05 root mean square: sqrt 2 of it on the peak, and A / (pi f) of an area of 2 T / pi."""
    one = blow(300, 500)
    one = dataclasses.replace(one, smooth=one.smooth._replace(misfit=0.05))
    found = _doubt_of_smooth(one, 40.0)
    amplitude = 0.05 * math.sqrt(2.0)
    slope = 2.0 / (math.pi * math.sqrt(0.99)) / (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert found["peak"] == pytest.approx(amplitude)
    assert found["width"] == pytest.approx(amplitude * slope, rel=6e-3)  # of two digits
    assert found["velocity_change"] == pytest.approx(amplitude / (math.pi * 40.0) / (2.0 / math.pi * 0.2))


@pytest.mark.parametrize(("place", "swing"), [(560, 0.4), (540, 0.0), (500 + 5 * 187 - 2, 0.4), (500 + 5 * 188, 0.0)])
def test_a_record_swings_from_a_quarter_of_a_width_after_a_blow_up_to_five(place, swing):
    values = np.zeros(2000)
    values[place] = 0.8
    assert _swing_after(record(values), blow(300, 500)) == swing
    assert _swing_after(record(values), blow(300, 500, noise=0.081)) == 0.0
    after = blow(900, 950)
    assert _swing_after(record(values, blow(300, 500), after), blow(300, 500)) == 0.0


def test_a_record_is_larger_elsewhere_by_five_noises():
    values = np.zeros(900)
    values[350] = 6.0  # in the blow
    one = blow(300, 500, noise=0.1)
    for height, seen in ((4.49, 0), (-4.51, 1)):
        values[501] = height
        assert len(larger_elsewhere(record(values, one))) == seen
    values[[500, 501]] = 9.0, 0.0
    assert larger_elsewhere(record(values, one)) == []
    assert larger_elsewhere(record(values)) == []


def test_what_stands_at_half_the_rate():
    """A spectrum that is flat, of a spike, stands there as high as anywhere; noise of a fourth of it hides it."""
    spike = np.zeros(256)
    spike[128] = 1.0
    assert sampling.folded_level(spike, 0.0) == pytest.approx(1.0)
    heard = np.hanning(256)[128] / math.sqrt(0.375 * 256)
    assert sampling.folded_level(spike, 0.24 * heard) is not None
    assert sampling.folded_level(spike, 0.26 * heard) is None
    assert sampling.folded_level(np.zeros(9), 0.0) is None
    t = np.arange(256)
    for share, seen in ((0.05, True), (0.03, False)):  # a line is spread over 20 of 129: rms of 0.25 of it
        values = np.cos(2.0 * np.pi * 20 / 256 * t) + share * np.cos(2.0 * np.pi * 120 / 256 * t)
        level = share * math.sqrt((1.0 + 0.25 + 0.25) / 20.0)
        found = sampling.folded_level(values, 0.0)
        assert (found is not None) is (level > 0.02)
        assert not seen or found is None or found == pytest.approx(level, rel=0.05)


# trains and blows


def test_rebounds_are_told_by_the_median_of_their_shares_and_lags():
    pulses = []
    for k, (share, lag) in enumerate(((0.2, 0.02), (0.3, 0.03), (0.5, 0.07))):
        one = blow(100 + 300 * k, 150 + 300 * k, -4.0)
        pulses.append(dataclasses.replace(one, rebounds=(Rebound(one.time + lag, -4.0 * share, -0.1),)))
    [notice] = train.rebounds(record(np.zeros(999), *pulses))
    assert notice.value == pytest.approx(0.3)
    assert "3 smaller contacts beside 3 of 3 blows, 30 % of the peak, 30\xa0ms after" in notice.message
    assert (notice.start, notice.end) == (pulses[0].time + 0.02, pulses[2].time + 0.07)
    [one] = train.rebounds(record(np.zeros(999), pulses[0]))
    assert "1 smaller contact beside the blow, 20 %" in one.message
    assert train.rebounds(record(np.zeros(999), blow(100, 150))) == []


def test_a_double_hit_has_both_its_blows():
    pulses = [blow(100, 110), blow(130, 140, 3.9), blow(700, 710, 4.1)]
    [notice] = train.double_hit(record(np.zeros(900), *pulses))
    assert notice.value == 1
    assert (notice.start, notice.end) == (pulses[0].begin, pulses[1].end)
    assert "of 4 m and 3.9 m, 30\xa0ms apart" in notice.message
    assert train.double_hit(record(np.zeros(900), pulses[0], pulses[2])) == []


def test_missing_blows_are_listed_three_and_counted():
    pulses = [blow(100 * k, 100 * k + 10) for k in (1, 2, 3, 4, 7, 8, 11)]
    [notice] = train.missing_blow(record(np.zeros(1200), *pulses))
    assert notice.value == 4
    assert "no blow at 2.505\xa0s, 2.605\xa0s, 2.905\xa0s and 1 more" in notice.message
    assert (notice.start, notice.end) == (pytest.approx(2.505), pytest.approx(3.005))
    assert "every 100\xa0ms" in notice.message


@pytest.mark.parametrize(("edge", "told"), [(0.39, []), (0.41, ["begins", "ends"])])
def test_a_part_of_another_blow_at_both_edges(edge, told):
    """A tenth of the peak at the edge, which is gone within a width."""
    values = np.zeros(3000)
    values[1400:1600] = half_sine()[300:500]
    values[:60] = values[-60:] = edge
    one = blow(1400, 1600)
    found = blow_checks.cut(record(values, one))
    assert [word for word in ("begins", "ends") if any(word in notice.message for notice in found)] == told
    if told:
        assert [notice.start for notice in found] == [START, pytest.approx(START + 2999 * STEP)]
        values[500] = values[-500] = 0.21  # within four widths it strays by more than half of that
        assert blow_checks.cut(record(values, one)) == []


# zero


def test_a_level_steps_at_a_place():
    values = np.r_[np.zeros(30), np.full(70, 2.0)]
    assert zero.level_step(values) == (30, 2.0)
    assert zero.level_step(-values) == (30, -2.0)
    assert zero.level_step(values[15:]) is None  # sixteen samples at least
    assert zero.level_step(values[14:]) == (16, 2.0)
    stray = 0.21 * np.tile([1.0, -1.0], 50)
    assert zero.level_step(values + stray) is None  # a tenth of the step
    assert zero.level_step(values + 0.19 / 0.21 * stray) is not None
    values[50] = 24.9
    assert zero.level_step(values) is not None  # 8 % of the span
    values[50] = 25.1
    assert zero.level_step(values) is None


def test_a_step_near_a_blow_is_within_a_length_of_it():
    seen = record(np.zeros(900), blow(300, 400))
    found = [zero._near_a_blow(seen, START + STEP * place) for place in (199, 201, 499, 501)]
    assert found == [False, True, True, False]


@pytest.mark.parametrize(
    ("level", "share", "severity"), [(0.19, 0.0475, None), (0.21, 0.0525, "good"), (2.1, 0.525, "suspect")]
)
def test_a_zero_far_off_is_noted_from_a_twentieth_of_the_peak_on(level, share, severity):
    one = blow(300, 500, offset=level)
    notices = zero.not_settled(record(np.zeros(900), one))
    assert [notice.severity for notice in notices] == ([] if severity is None else [severity])
    assert all(notice.value == level for notice in notices)


def test_a_velocity_drifts_by_what_the_record_stands_off():
    """A hundred widths after a blow of area 0.5: standing at c for 1800 samples makes 1.8 c."""
    one = blow(100, 120)
    for level, severity in ((0.49, None), (0.51, "good"), (1.99, "good"), (2.01, "suspect")):
        values = np.r_[np.zeros(120), np.full(1800, level * abs(one.velocity_change) / 1.8)]
        found = zero.velocity_drift(record(values, one))
        assert [notice.severity for notice in found] == ([] if severity is None else [severity])
        if found:
            assert found[0].value == pytest.approx(level * one.velocity_change, rel=1e-9)
    assert zero.velocity_drift(record(values[: 120 + 700], one)) == []  # less than 40 widths of 18.7


def test_blows_without_a_foot_are_held_against_the_record():
    one = blow(300, 500)
    values = half_sine() * 0.8
    [notice] = zero.no_foot(record(values, one))
    assert dict(notice.effects)["velocity_change"] == pytest.approx(0.25, rel=1e-3)
    assert zero.no_foot(record(values, dataclasses.replace(one, begin=one.begin - STEP))) == []
    assert zero.no_foot(record(values, dataclasses.replace(one, method="fit"))) == []


# noise


def test_effects_are_those_of_the_median_blow_on_the_smallest():
    """Doubts of 0.1, 0.2 and 0.4 of the peak's unit, under peaks of 4, 2 and 8: their median is a tenth of the smallest."""
    pulses = [
        blow(300 * k, 300 * k + 50, peak, uncertainty=PulseUncertainty(doubt, 0.0, 0.0))
        for k, (peak, doubt) in enumerate(((4.0, 0.1), (-2.0, 0.2), (8.0, 0.4)), start=1)
    ]
    found = noise._worst_effects(record(np.zeros(2000), *pulses))
    single = [noise._worst_effects(record(np.zeros(2000), one))["peak"] * abs(one.peak) for one in pulses]
    assert found["peak"] == pytest.approx(np.median(single) / 2.0)
    assert single[1] / single[0] == pytest.approx(2.0)
    assert single[2] / single[0] == pytest.approx(4.0)


@pytest.mark.parametrize(("peak", "severity"), [(5.7, "good"), (5.5, "suspect")])
def test_a_noisy_blow_is_suspect_below_15_db(peak, severity):
    one = blow(300, 500, -peak, method="fit", noise=1.0)
    [notice] = noise.noisy(record(np.zeros(900), one))
    assert notice.value == pytest.approx(20.0 * math.log10(peak))
    assert notice.severity == severity
    assert noise.noisy(record(np.zeros(900), dataclasses.replace(one, method="record"))) == []


# responses


def test_a_fit_explains_what_is_no_chance():
    """Five standard errors, of as many values as count: rest^2 / n."""
    rest = 0.1 * (-1.0) ** np.arange(100)
    squares = float(rest @ rest)
    assert alike_as_one(rest, 0.99) == 1.0
    for share, explained in ((1.01, True), (0.99, False)):
        before = squares + share * 25.0 * squares / 100
        assert response_zero._explains((before, rest, rest), (squares, rest, rest)) is explained


@pytest.mark.parametrize(("share", "flat"), [(0.55, True), (0.98, False)])
def test_flat_tops_of_a_swing(share, flat):
    """A sine cut at a share of its height is flat for 1 - 2 asin(share) / pi of its half swings."""
    t = np.arange(1000) + 0.5
    values = np.clip(np.sin(2.0 * np.pi * t / 100), -share, share)
    found = response_range._flat(values, 0.0)
    assert (found is not None) is flat
    if flat:
        assert found[0] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(0.98 * share), abs=0.03)  # two samples of 50
        assert found[1] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(0.98), rel=1e-9)
    noisy = response_range._flat(values, 0.05 * share)
    if flat:
        assert noisy[1] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(1.0 - 0.22), rel=1e-9)
    assert response_range._flat(np.zeros(9), 0.0) is None
